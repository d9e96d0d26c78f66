"""P f_0 where f_0 jumps along fronts that move."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from skfem import MeshTri

from manufactured.data import Data, no_fronts
from manufactured.exact import ExactSolution
from manufactured.tensors import Array, traction
from study.fem.mesh import FAMILIES, MeshFamily, OneDiagonal, Shaken, cell_volumes
from study.fem.naming import resolve
from study.fem.quadrature import Line, cut_rule, sliced_rule
from study.stresses.composite import alfeld_split
from study.stresses.loads import ProjectedLoads
from study.stresses.stress_space import StressSpace

coordinates = st.lists(st.floats(-1, 1), min_size=6, max_size=6).map(lambda x: np.reshape(x, (2, 3)))


@given(coordinates, st.floats(0, 2 * np.pi), st.floats(-1, 1), st.floats(-1, 1))
def test_cells_cut_along_two_parallel_lines_integrate_what_bends_at_both_exactly(
    corners: Array, angle: float, one: float, other: float
) -> None:
    if abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) < 1e-3:
        return
    mesh, cells = MeshTri(corners, np.array([[0], [1], [2]])), np.array([0])
    lines = [Line((np.cos(angle), np.sin(angle)), offset) for offset in (one, other)]
    both = sliced_rule(mesh, cells, lines, 4)

    def bent(x: Array, line: Line) -> Array:
        s, r = np.einsum("d,d...->...", line.direction, x) - line.offset, np.einsum("d,d...->...", line.tangent, x)
        return abs(s) * (1 + s) * (2 + r) + abs(s) ** 3

    expected = 0.0
    for line in lines:
        single = cut_rule(mesh, cells, line, 8)
        expected += float(np.sum(bent(single.points, line) * single.weights))
    found = sum(float(np.sum(bent(both.points, line) * both.weights)) for line in lines)
    assert found == pytest.approx(expected, abs=1e-12)


def flux(solution: ExactSolution, corners: Array, fronts: list[float], time: float) -> Array:
    """∮ σν along a triangle (2, 3), edges cut where x_1 is that of a front: (2,)."""
    x, w = np.polynomial.legendre.leggauss(12)
    total, turn = np.zeros(2), np.sign(np.linalg.det(corners[:, 1:] - corners[:, :1]))
    for a, b in zip(corners.T, np.roll(corners, -1, axis=1).T, strict=True):
        crossings = [(c - a[0]) / (b[0] - a[0]) for c in fronts if abs(b[0] - a[0]) > 1e-14]
        ends = np.sort([0.0, 1.0, *(c for c in crossings if 0 < c < 1)])
        normal = turn * np.array([b[1] - a[1], a[0] - b[0]])
        for left, right in pairwise(ends):
            places = a[:, None] + (b - a)[:, None] * (left + (right - left) * (1 + x) / 2)
            stress = solution.at(places).stress(time)
            total += traction(stress, normal) @ w * (right - left) / 2
    return total


@pytest.mark.parametrize("family", [OneDiagonal(), Shaken(seed=3)], ids=lambda family: family.name)
@pytest.mark.parametrize(("time", "count"), [(0.1, 4), (0.28, 2), (0.5, 2)])
def test_the_mean_of_f0_is_the_flux_of_the_stress_on_cells_that_moving_fronts_cross(
    family: MeshFamily, time: float, count: int
) -> None:
    solution = resolve("merging-patches").solution
    space, data = StressSpace(family(solution.body, 6), solution.body), Data.of(solution)
    thirds, corners = alfeld_split(space.mesh)
    fronts = [offset for _, offset in solution.fronts(time)]
    assert len(fronts) == count
    expected = np.array([-flux(solution, corners[:, :, n], fronts, time) for n in range(corners.shape[2])])

    def error(data: Data) -> float:
        means = ProjectedLoads(data, space, raised=10)(time).force.reshape(-1, 2)
        return float(abs(means * cell_volumes(thirds)[:, None] - expected).max() / abs(expected).max())

    # A rule of high degree, so that what is smooth is exact but for its last digits.
    assert error(data) < 1e-4
    assert error(replace(data, fronts=no_fronts)) > 100 * error(data)


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("name", ["advance-recede", "corner", "heterogeneous", "layered", "re-entrant"])
def test_loads_from_modes_are_those_evaluated_point_by_point(name: str, degree: int) -> None:
    solution = resolve(name).solution
    family = next(family for family in FAMILIES if family.serves(solution.body))
    space, data = StressSpace(family(solution.body, 4), solution.body, degree), Data.of(solution)
    told, other = ProjectedLoads(data, space), ProjectedLoads(replace(data, force_modes=None, formulas_of=None), space)
    times = solution.body.T * np.linspace(0, 1, 8)[1:]
    for time in times:
        found, expected = told(time), other(time)
        assert abs(found.force - expected.force).max() <= 1e-12 * abs(expected.force).max()
        assert np.array_equal(found.surface, expected.surface)
        assert told.at(time).loads.surface == pytest.approx(expected.surface, rel=1e-12, abs=1e-12)
        left, right = told.at(time).left_out, other.at(time).left_out
        for name in ("low_order", "high_order", "on_edges"):
            assert getattr(left, name) == pytest.approx(getattr(right, name), rel=1e-9, abs=1e-12)
