"""P f_0 where f_0 jumps along fronts that move."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from skfem import MeshTri

from manufactured.data import Data, no_fronts
from manufactured.exact import ExactSolution
from manufactured.tensors import Array, full
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


def fluxes(solution: ExactSolution, corners: Array, fronts: list[float], time: float) -> Array:
    """∮ σν along n triangles (2, 3, n), whose sides are cut at the fronts, the lines of constant x_1: (2, n)."""
    x, w = np.polynomial.legendre.leggauss(12)
    ends = np.roll(corners, -1, axis=1)
    along = ends - corners
    with np.errstate(divide="ignore"):
        crossings = [(front - corners[0]) / along[0] for front in fronts]
    cuts = np.sort([0 * along[0], *np.clip(crossings, 0, 1), 0 * along[0] + 1], axis=0)[..., None]
    places = (cuts[:-1] + np.diff(cuts, axis=0) * (1 + x) / 2)[None]
    stress = solution.at(corners[:, None, ..., None] + along[:, None, ..., None] * places).stress(time)
    normals = np.array([along[1], -along[0]]) * np.sign(np.linalg.det(np.moveaxis(along[:, :2], 2, 0)))
    return np.einsum("ijpvnq,jvn,pvn,q->in", full(stress), normals, np.diff(cuts, axis=0)[..., 0], w / 2)


@pytest.mark.parametrize(
    ("family", "time", "count"),
    [(OneDiagonal(), 0.1, 4), (Shaken(seed=3), 0.28, 2), (Shaken(seed=3), 0.1, 4), (OneDiagonal(), 0.5, 2)],
)
def test_the_mean_of_f0_is_the_flux_of_the_stress_on_cells_that_moving_fronts_cross(
    family: MeshFamily, time: float, count: int
) -> None:
    solution = resolve("merging-patches").solution
    space, data = StressSpace(family(solution.body, 6), solution.body), Data.of(solution)
    thirds, corners = alfeld_split(space.mesh)
    fronts = [offset for _, offset in solution.fronts(time)]
    assert len(fronts) == count
    expected = -fluxes(solution, corners, fronts, time).T

    def error(data: Data) -> float:
        means = ProjectedLoads(data, space, raised=10)(time).force.reshape(-1, 2)
        return float(abs(means * cell_volumes(thirds)[:, None] - expected).max() / abs(expected).max())

    # A rule of high degree, so that what is smooth is exact but for its last digits.
    assert error(data) < 1e-4
    assert error(replace(data, fronts=no_fronts)) > 100 * error(data)


@pytest.mark.parametrize(
    ("name", "degree"), [("advance-recede", 1), ("corner", 2), ("heterogeneous", 1), ("layered", 2), ("re-entrant", 1)]
)
def test_loads_from_modes_are_those_evaluated_point_by_point(name: str, degree: int) -> None:
    solution = resolve(name).solution
    family = next(family for family in FAMILIES if family.serves(solution.body))
    space, data = StressSpace(family(solution.body, 4), solution.body, degree), Data.of(solution)
    told, other = ProjectedLoads(data, space), ProjectedLoads(replace(data, force_modes=None, formulas_of=None), space)
    for time in (0.4 * solution.body.T, solution.body.T):
        found, expected = told(time), other(time)
        assert abs(found.force - expected.force).max() <= 1e-12 * abs(expected.force).max()
        np.testing.assert_allclose(told.at(time).loads.surface, expected.surface, rtol=1e-12, atol=1e-12)
        left, right = told.at(time).left_out, other.at(time).left_out
        for name in ("low_order", "high_order", "on_edges"):
            np.testing.assert_allclose(getattr(left, name), getattr(right, name), rtol=1e-9, atol=1e-12)
