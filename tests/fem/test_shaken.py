"""Random meshes are random, everywhere and by as much as they say; no cell is degenerate or leaves the body."""

from itertools import product

import numpy as np
import pytest

from manufactured import Body, named, unit_square
from manufactured.body import box
from manufactured.exact.domain import require_inside
from manufactured.tensors import Array
from study.fem.mesh import FAMILIES, Alternating, OneDiagonal, Shaken, cell_volumes
from study.fem.quadrature import placed, simplex_rule
from study.statements.shared.meshes import fits, representing, spacing
from study.statements.shared.scope import serving

LEVEL = {2: 24, 3: 9}


def smallest_angle(corners: Array) -> float:
    """Of triangles (2, 3, n), in degrees."""
    sides = np.roll(corners, -1, axis=1) - corners
    lengths = np.linalg.norm(sides, axis=0)
    cosines = -np.sum(sides * np.roll(sides, 1, axis=1), axis=0) / (lengths * np.roll(lengths, 1, axis=0))
    return float(np.degrees(np.arccos(cosines.max())))


@pytest.mark.parametrize("body", [unit_square(), box()], ids=["square", "cube"])
def test_vertices_are_moved_evenly_up_to_the_amplitude_and_on_the_boundary_along_it(body: Body) -> None:
    """Uniform on ± a in each direction: the largest is close to a, the mean square a²/3, directions are independent."""
    n, dim = LEVEL[body.dim], body.dim
    plain, shaken = OneDiagonal()(body, n).p, Shaken()(body, n).p
    inside = ((plain > 0) & (plain < 1)).all(axis=0)
    moved = (shaken - plain)[:, inside] * n / (Shaken().amplitude * 2 / dim)
    assert (abs(moved).max(axis=1) <= 1 + 1e-12).all()
    assert (abs(moved).max(axis=1) > 0.98).all()
    assert np.mean(moved**2, axis=1) == pytest.approx(1 / 3, abs=6 / np.sqrt(moved.size))
    assert abs(np.corrcoef(moved) - np.eye(dim)).max() < 6 / np.sqrt(moved.shape[1])
    assert (abs(moved).max(axis=0) > 1e-3).all()
    for axis, side in product(range(body.dim), (0, 1)):
        on = plain[axis] == side
        assert abs(shaken[axis, on] - side).max() <= 1e-15
        others = np.delete((shaken - plain)[:, on], axis, axis=0) * n
        assert np.sqrt(np.mean(others**2)) > 0.3 * Shaken().amplitude


def test_two_levels_and_two_seeds_are_moved_otherwise() -> None:
    def shifts(family: Shaken, n: int) -> Array:
        """Return the shifts of the inner vertices of level 8, divided by the width of a cell."""
        moved = family(unit_square(), n).p - OneDiagonal()(unit_square(), n).p
        return n * moved.reshape(2, n + 1, n + 1)[:, :: n // 8, :: n // 8][:, 1:-1, 1:-1].ravel()

    for another in (shifts(Shaken(), 16), shifts(Shaken(seed=1), 8)):
        assert abs(np.corrcoef(shifts(Shaken(), 8), another)[0, 1]) < 0.5


SHAPES = (*(case.name for case in representing("body")), "layered")
"""Cases with the bodies of the catalogue, each once; one has interfaces."""


@pytest.mark.parametrize("name", SHAPES)
def test_no_cell_is_close_to_degenerate(name: str) -> None:
    """In 3D shaken simplices keep a fifth of their volume, in the plane angles stay away from 0."""
    body = named(name).solution.body
    for family in (family for family in FAMILIES if family.serves(body)):
        step = spacing(name, family.name)
        for n in (2 * step, 3 * step) if body.dim == 3 else [step * -(-n // step) for n in (8, 16)]:
            assert fits(family, body, n)
            mesh = family(body, n)
            volumes = cell_volumes(mesh)
            if body.dim == 3:
                assert volumes.min() > 0.2 * volumes.mean(), (family.name, n)
            else:
                assert smallest_angle(mesh.p[:, mesh.t]) > family.least_angle, (family.name, n)


@pytest.mark.parametrize("name", ["rotated", "hexagon", "re-entrant", "layered", "cube-two-faces"])
def test_vertices_and_points_of_quadrature_lie_in_the_body_whatever_rounding_does(name: str) -> None:
    case = named(name)
    body = case.solution.body
    barycentric, _ = simplex_rule(body.dim, 4)
    for family in serving(case):
        mesh = family(body, 7)
        require_inside(body, mesh.p)
        require_inside(body, placed(mesh.p, mesh.t, barycentric))
        require_inside(body, np.mean(mesh.p[:, mesh.facets], axis=1))


@pytest.mark.parametrize("n", [4, 5])
def test_alternating_diagonals_give_vertices_of_the_boundary_two_and_four_cells_in_turn(n: int) -> None:
    mesh = Alternating()(unit_square(), n)
    assert cell_volumes(mesh) == pytest.approx(0.5 / n**2)
    floor = np.flatnonzero(mesh.p[1] == 0)[1:-1]
    counts = np.bincount(mesh.t.ravel())[floor[np.argsort(mesh.p[0, floor])]]
    assert counts.tolist() == [(2, 4)[i % 2] for i in range(n - 1)]
