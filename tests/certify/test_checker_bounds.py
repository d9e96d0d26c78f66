"""Every inequality of the checker, on problems of one or two cells where the exact value is known in closed form."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction as Q
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from study.certify import checker
from study.certify.checker import CUBIC, Enclosure, Loads, Mesh, Piece, Problem, RefusedError, Stresses, X, Y

EXAMPLES = Path(__file__).parents[2] / "examples" / "certificates"
GRID = Q(1, 1 << checker.GRID)
ROWS = [["4", "1", "1/2"], ["1", "3", "1/4"], ["1/2", "1/4", "2"]]
UNIT = [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "1"]]


def load(*components: list[list[Any]]) -> list[list[Any]]:
    """Two components of a load without kinks, from monomials."""
    return [[[monomials, [], 0]] if monomials else [] for monomials in components]


PUSHED = {"1": load([["1", 0, 0, 0]], [])}


def stated(
    corners: list[list[Any]] = [[0, 0], [1, 0], [0, 1]],  # noqa: B006
    kinds: str = "clamped loaded clamped",
    loads: Any = PUSHED,
    A: Any = UNIT,
    **more: Any,
) -> dict[str, Any]:
    """A problem on a triangle, or on another polygon."""
    return {
        "vertices": [[str(c) for c in corner] for corner in corners],
        "kinds": kinds.split(),
        "T": "1",
        "A": A,
        "G": A,
        "force": [[], []],
        "loads": loads,
        "start": [[], []],
        **more,
    }


def mesh_of(corners: list[list[Any]], h: int = 1) -> dict[str, Any]:
    """The polygon cut into a fan of triangles from its first vertex."""
    n = len(corners)
    return {
        "denominator": h,
        "points": [[int(Q(c) * h) for c in corner] for corner in corners],
        "cells": [[0, i, i + 1] for i in range(1, n - 1)],
        "sides": [[i, (i + 1) % n] for i in range(n)],
    }


TRIANGLE = [[0, 0], [1, 0], [0, 1]]
QUADRANGLE = [[0, 0], [2, 0], [Q(3, 2), 1], [0, Q(3, 2)]]


@pytest.fixture(scope="module")
def element() -> checker.Element:
    return checker.Element.of(checker.load(EXAMPLES / "square-4.json.gz")["element"])


# The problem


@pytest.mark.parametrize(
    "corners",
    [
        [[0, 0], [2, 0], [1, 0], [1, 1]],
        [[0, 0], [2, 0], [-1, 0], [-1, 1]],
        [[0, 0], [2, 0], [2, 0], [0, 1]],
        [[0, 0], [2, 0], [0, 1], [0, 2]][::-1] + [[0, 0]],
        [[0, 0], [2, 0], [2, 2], [1, 0]],
        [[0, 0], [2, 0], [2, 2], [0, 2], [0, 0]],
        [[0, 0], [3, 0], [3, 3], [1, -1], [0, 3]],
        [[0, 0], [2, 0], [1, 0]],
    ],
    ids=str,
)
def test_polygons_that_touch_themselves_or_have_no_area_are_refused(corners: list[list[int]]) -> None:
    for n in range(len(corners)):
        turned = [*corners[n:], *corners[:n]]
        with pytest.raises(RefusedError, match=r"two sides of the polygon meet|counter-clockwise"):
            Problem(stated(turned, " ".join(["clamped"] * len(corners)), loads={}))


@pytest.mark.parametrize("A", [[["0"] * 3] * 3, [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "0"]]], ids=str)
def test_a_law_without_viscosity_in_some_direction_is_refused(A: Any) -> None:
    with pytest.raises(RefusedError, match="A is not symmetric and positive definite"):
        Problem(stated(A=A))


def test_polynomials_are_read() -> None:
    assert checker.polynomial([["1/2", 1, 2], ["3", 0, 1]]) == X * Y * Y * Q(1, 2) + Y * 3
    assert checker.polynomial([["1/2", 1, 2, 3]]) == X * Y * Y * checker.S * checker.S * checker.S * Q(1, 2)


def test_a_cell_without_area_is_refused() -> None:
    mesh = mesh_of(TRIANGLE, 2)
    mesh["points"].append([1, 1])
    mesh["cells"].append([2, 1, 3])
    mesh["sides"][1] = [1, 3, 2]
    with pytest.raises(RefusedError, match="a cell is not counter-clockwise"):
        Mesh.of(mesh, Problem(stated()))


def test_a_refined_mesh_is_the_same_body() -> None:
    mesh = Mesh.of(mesh_of(QUADRANGLE, 2), Problem(stated(QUADRANGLE, "clamped loaded contact clamped")))
    fine = mesh.refined()
    assert [fine.place(v) for v in range(4)] == [mesh.place(v) for v in range(4)]
    for (a, b), node in mesh.node.items():
        p, q = mesh.place(a), mesh.place(b)
        assert fine.place(node) == ((p[0] + q[0]) / 2, (p[1] + q[1]) / 2)
    assert (len(fine.cells), len(fine.boundary)) == (8, 8)
    assert [mesh.nodes_of(e) for e in ((0, 1), (3, 0))] == [(0, mesh.node[0, 1], 1), (3, mesh.node[0, 3], 0)]
    assert sum(Q(cell.det, fine.h**2) for cell in fine.cells) == sum(Q(cell.det, mesh.h**2) for cell in mesh.cells)
    assert all(cell.det > 0 for cell in fine.cells)


SLANTED = [[0, 0], [4, 0], [0, 3]]
STARTS = [
    # u_0 = x y (α, β) on a slanted foundation with the normal (3, 4).
    *(("contact", [[[str(c), 1, 1]] for c in u], "") for u in ((1, -1), (4, -3), (-4, 3))),
    *(
        ("contact", [[[str(c), 1, 1]] for c in u], "u_0ν ≤ 0 on Γ3 cannot be shown")
        for u in ((-1, 1), (5, -3), (4, -2))
    ),
    *(
        ("loaded", start, "u_0 does not vanish on Γ1")
        for start in ([[["1", 1, 0]], []], [[], [["1", 0, 1]]], [[["1", 0, 0], ["-1", 1, 0]], []])
    ),
]


@pytest.mark.parametrize(("kind", "start", "message"), STARTS, ids=str)
def test_the_start_does_not_enter_the_foundation_and_vanishes_on_the_wall(kind: str, start: Any, message: str) -> None:
    data = stated(SLANTED, f"clamped {kind} clamped", loads={}, start=start)
    if not message:
        assert Problem(data).twice_area == 12
    else:
        with pytest.raises(RefusedError, match=message):
            Problem(data)


def test_loads_have_their_parts() -> None:
    with pytest.raises(RefusedError, match="f_2 is given on part 0, which is not of Γ2"):
        Problem(stated(loads={"0": load([["1", 0, 0, 0]], [])}))
    problem = Problem(stated(loads={"1": [[[[["2", 1, 0, 0]], [["3", 0, 0, 1]], 2]], []]}))
    assert [len(side.load) for side in problem.sides] == [0, 2, 0]
    assert problem.sides[1].load == [[checker.Term(X * 2, checker.S * 3, 2)], []]


# Constants of the body


def constants_on_triangle(near: int, corner: int, mu: Q, kappa: Q, kinds: str = "clamped loaded clamped") -> Any:
    """Φ with Φ_111 = Φ_222 from −corner at the origin to −near on the hypotenuse, others 0, over 2^104.

    −Φ(ν, v, v) = near/√2 |v|² on the hypotenuse, div Φ = corner − near, and A⁻¹(Φv)·(Φv) is at most corner².
    """
    field = [[-corner, 0, 0, -corner], [-near, 0, 0, -near], [-near, 0, 0, -near]]
    data = {"mesh": mesh_of(TRIANGLE), "bits": 104, "field": field, "volume": str(mu), "surface": str(kappa)}
    loads = PUSHED if "loaded" in kinds else {}
    return checker.load_constants(data, Problem(stated(kinds=kinds, loads=loads)))


CORNER, SCALE = 1 << 102, 1 << 104
NEAR = int(checker.root(Q(2)) / 16 * SCALE)
"""The least integer above 2^104 √2/16."""
MU = Q(CORNER - NEAR, SCALE) - Q(CORNER, SCALE) ** 2


def test_constants_are_accepted_to_the_last_digit() -> None:
    volume, surface = constants_on_triangle(NEAR, CORNER, MU, Q(1, 16))
    assert volume**2 * MU > 1 > (volume - 2 * GRID) ** 2 * MU
    assert (surface - GRID) ** 2 / 16 <= 1 < surface**2 / 16


def test_constants_that_are_too_small_in_the_last_digit_are_refused() -> None:
    """√2 is rounded up: a load of κ √2 that Φ misses by less than 2^−104 is missed."""
    with pytest.raises(RefusedError, match="constant of forces"):
        constants_on_triangle(NEAR, CORNER, MU + Q(1, 2**200), Q(1, 16))
    with pytest.raises(RefusedError, match="constant of loads"):
        constants_on_triangle(NEAR - 1, CORNER, MU, Q(1, 16))
    assert Q(NEAR - 1, SCALE) ** 2 < 2 * Q(1, 16) ** 2 < Q(NEAR, SCALE) ** 2


def test_without_a_load_nothing_may_be_pulled() -> None:
    """On Γ3 −Φ(ν, v, v) ≥ 0 is enough; on Γ1 nothing is required."""
    kinds = "clamped contact clamped"
    mu = Q(1, 4) - Q(1, 16)
    volume, _ = constants_on_triangle(0, CORNER, mu, Q(1), kinds)
    assert (volume - GRID) ** 2 * mu <= 1 < volume**2 * mu
    with pytest.raises(RefusedError, match="constant of loads"):
        constants_on_triangle(-1, CORNER, mu, Q(1), kinds)


def eigenvalues(field: Any) -> tuple[float, float]:
    """The largest μ and κ that a field proves on the quadrangle, by numpy from the tensor Φ_ijk itself."""
    points = np.array(QUADRANGLE, dtype=float)
    phi = np.array([[[[one[i + j + k] for k in (0, 1)] for j in (0, 1)] for i in (0, 1)] for one in field]) / 64
    compliance = np.linalg.inv(np.array([[float(Q(x)) for x in row] for row in ROWS]))
    inside, outside = [], []
    for cell in ([0, 1, 2], [0, 2, 3]):
        slopes = np.linalg.inv(np.column_stack([np.ones(3), points[cell]]))[1:]  # ∂_i of the shape of vertex n
        divergence = np.einsum("in,nijk->jk", slopes, phi[cell])
        for v in cell:
            stresses = np.array([phi[v][k][[0, 1, 0], [0, 1, 1]] for k in (0, 1)])
            inside.append(np.linalg.eigvalsh(divergence - stresses @ compliance @ stresses.T)[0])
    x, y = points[2] - points[1]
    normal = np.array([y, -x]) / np.hypot(x, y)
    outside = [np.linalg.eigvalsh(-np.einsum("i,ijk", normal, phi[v]))[0] for v in (1, 2)]
    return min(inside), min(outside)


@pytest.mark.parametrize("seed", range(3))
def test_constants_of_tensor_fields_are_those_of_numpy(seed: int) -> None:
    rng = np.random.default_rng(seed)
    base = np.array([[-40 + 16 * x, 0, 0, -40 + 16 * y] for x, y in QUADRANGLE], dtype=float)
    field = [[int(c) for c in row] for row in np.round(base + rng.integers(-2, 3, (4, 4)))]
    mu, kappa = eigenvalues(field)
    assert mu > 0.01
    assert kappa > 0.01
    problem = Problem(stated(QUADRANGLE, "clamped loaded contact clamped", A=ROWS))

    def constants(mu: float, kappa: float) -> tuple[Q, Q]:
        numbers = {"volume": str(Q(mu)), "surface": str(Q(kappa))}
        return checker.load_constants({"mesh": mesh_of(QUADRANGLE, 2), "bits": 6, "field": field} | numbers, problem)

    found = constants(mu - 1e-9, kappa - 1e-9)
    assert [float(x) for x in found] == pytest.approx([mu**-0.5, kappa**-0.5], rel=1e-6)
    with pytest.raises(RefusedError, match="constant of forces"):
        constants(mu + 1e-9, kappa - 1e-9)
    with pytest.raises(RefusedError, match="constant of loads"):
        constants(mu - 1e-9, kappa + 1e-9)


# Loads


def loads_on(corners: list[list[Any]], h: int, bits: int, **more: Any) -> Loads:
    problem = Problem(stated(corners, " ".join(["clamped", "loaded"] + ["clamped"] * (len(corners) - 2)), **more))
    return Loads(problem, Mesh.of(mesh_of(corners, h), problem), bits)


def test_a_force_of_degree_2_is_missed_by_rounding_only() -> None:
    """Each of six coefficients of twice the area times f̃ is rounded to the nearest integer over 2^bits."""
    force = load([["1/3", 2, 0, 0], ["-1/7", 0, 1, 2]], [["1/5", 1, 1, 1]])
    loads = loads_on(QUADRANGLE, 4, 10, force=force)
    a, b = Q(1, 3), Q(2, 3)
    first, middle, last = loads.controls(a, b)
    assert first == [X * X * Q(1, 3) - Y * Q(1, 63), X * Y * Q(1, 15)]
    assert last == [X * X * Q(1, 3) - Y * Q(4, 63), X * Y * Q(2, 15)]
    assert middle == [X * X * Q(1, 3) - Y * Q(2, 63), X * Y * Q(1, 10)]
    squares = []
    for (cell, images), numbers in zip(loads.cells, loads.on_cells(last), strict=True):
        area = Q(cell.det, 16)
        for d in (0, 1):
            exact = last[d](*images) * area
            rounded = checker.Poly.of(zip(checker.SQUARE, (Q(x, 1 << 10) for x in numbers[d::2]), strict=True))
            rest = exact - rounded
            assert max(map(abs, rest.values())) <= Q(1, 2 << 10)
            squares.append(checker.on_triangle(rest * rest) / area)
    missed = loads.missed_inside(a, b)
    assert sum(squares) <= missed**2
    # The bound: six halves for every component, at every point of every cell.
    bound = sum(2 * Q(6, 2) ** 2 / 2 * Q(16, cell.det) for cell, _ in loads.cells) / (1 << 20)
    assert bound <= missed**2 <= bound * (1 + Q(1, 2**60))


K = Q(1, 2**12)
REST: dict[str, tuple[Any, Q]] = {
    "cubic in time": (load([["1", 0, 0, 3]], [["2", 0, 0, 3]]), 5 * K**6 / 840 / 2),
    "cubic in time and linear in space": (load([], [["1", 0, 1, 3]]), K**6 / 840 / 12),
    "cubic in space": (load([["1/4096", 3, 0, 0]], []), Q(1, 4096) ** 2 / 56),
    "cubic and of degree 2 in space": (load([["1", 2, 0, 0], ["1/4096", 3, 0, 0]], []), Q(1, 4096) ** 2 / 56),
    "mixed in space": (load([], [["1", 0, 2, 0], ["1", 1, 1, 0], ["1/4096", 1, 2, 0]]), Q(1, 4096) ** 2 * Q(48, 40320)),
    "cubic in space, quadratic in time": (load([["1", 2, 1, 2]], []), Q(4 * 2, math.factorial(8)) * 3 * Q(1, 4) ** 4),
}


@pytest.mark.parametrize("name", REST, ids=str)
def test_what_a_force_has_beyond_is_missed(name: str) -> None:
    """Mean squares in closed form: (t − a)(t − m)(t − b) has k^6/840, X^i Y^j has (2i)!(2j)!/(2i + 2j + 2)!."""
    force, square = REST[name]
    a, b = (Q(1, 4), Q(1, 4) + K)
    if "quadratic" in name:
        # ∫ x⁴ y² = 4! 2!/8!, times the mean of t⁴.
        square = Q(48, math.factorial(8)) * (b**5 - a**5) / (5 * K)
    loads = loads_on(TRIANGLE, 1, 300, force=force)
    missed = loads.missed_inside(a, b)
    assert square <= missed**2 <= square * (1 + Q(1, 2**15))


def test_rounding_of_a_force_counts_as_well_as_its_rest() -> None:
    a, b = Q(1, 4), Q(1, 4) + K
    exact, both = (loads_on(TRIANGLE, 1, 3, force=load([["1", 0, 0, n]], [])).missed_inside(a, b) for n in (2, 3))
    rest = checker.root(K**6 / 1680, above=False)
    assert exact > Q(1, 4)
    # The square of the rest is rounded up to the grid: a hundred thousandth of it.
    assert exact + rest <= both <= exact + rest * (1 + Q(1, 10**5))


def test_a_load_that_is_not_taken_up_is_missed() -> None:
    for value in (Q(1), Q(1000), Q(1, 3 * 2**40)):
        loads = loads_on(TRIANGLE, 1, 10, loads={"1": load([[str(value), 0, 0, 0]], [])})
        missed = loads.missed_outside(Q(0), Q(1), [{(1, 2): [(0, 0)] * 4}] * 3)
        assert 2 * value**4 <= missed**4 <= 2 * value**4 * (1 + Q(1, 2**14))


def test_the_length_of_a_side_is_not_rounded_away() -> None:
    """A traction that fits the length √2 to 2^−100 misses the load by as much, times the load.

    The load is so large that this is more than the roundings to the grid.
    """
    length, value = checker.root(Q(2), above=False), 10**24
    loads = loads_on(TRIANGLE, 1, 100, loads={"1": load([[str(value), 0, 0, 0]], [])})
    missed = loads.missed_outside(Q(0), Q(1), [{(1, 2): [(int(value * length / GRID), 0)] * 4}] * 3)
    root = checker.root(Q(2 << 200), above=False) / (1 << 100)  # √2 to 2^−200
    least = value * (root - length)
    assert least > 2**20 * checker.root(GRID)
    assert missed**4 * 2 >= least**4


def test_lengths_are_rounded_down() -> None:
    """A load 1 and, across it, a traction t have the mean square (2 + t²)/√2 on a side of length √2."""
    t = 10**6
    missed = loads_on(TRIANGLE, 1, 100).missed_outside(Q(0), Q(1), [{(1, 2): [(0, t << 100)] * 4}] * 3)
    assert (2 + t * t) ** 2 <= missed**4 * 2 <= (2 + t * t) ** 2 * (1 + Q(1, 2**60))


def test_a_load_that_is_taken_up_is_not_missed() -> None:
    """f_2 = (t² x, y) on a side of length 5, from its Bernstein coefficients; then one of these is moved."""
    a, b, h, bits = Q(1, 2), Q(1), 2, 10
    loads = loads_on(SLANTED, h, bits, loads={"1": load([["1", 1, 0, 2]], [["1", 0, 1, 0]])})
    times, unit = [a * a, a * b, b * b], 5 * h << bits
    given = [{(1, 2): [(int(unit * t * 4 * Q(3 - p, 3)), int(unit * p)) for p in range(4)]} for t in times]
    exact = [{(1, 2): [(unit * t * 4 * Q(3 - p, 3), Q(unit * p)) for p in range(4)]} for t in times]
    # Squares are rounded up to the grid, in each component.
    assert loads.missed_outside(a, b, exact) ** 2 <= 3 * GRID  # type: ignore[arg-type]
    assert 0 < float(loads.missed_outside(a, b, given)) < 5 / 2**bits
    for s, p, d in product(range(3), range(4), (0, 1)):
        moved = [{edge: list(values) for edge, values in one.items()} for one in exact]
        pair = list(moved[s][1, 2][p])
        pair[d] += unit
        moved[s][1, 2][p] = tuple(pair)  # type: ignore[assignment]
        # ∫ B_s² = C(2, s)²/C(4, 2s)/5, ∫ B_p² = C(3, p)²/C(6, 2p)/7, times the length.
        square = 5 * Q(math.comb(2, s) ** 2, 5 * math.comb(4, 2 * s)) * Q(math.comb(3, p) ** 2, 7 * math.comb(6, 2 * p))
        assert square <= loads.missed_outside(a, b, moved) ** 2 <= square * (1 + Q(1, 2**80))  # type: ignore[arg-type]


def test_squares_of_loads_are_rounded_up() -> None:
    """A load of 2^−45/3: its square is of the size of the grid."""
    value = Q(1, 3 * 2**45)
    loads = loads_on(SLANTED, 1, 10, loads={"1": load([[str(value), 0, 0, 0]], [[str(value), 0, 0, 0]])})
    missed = loads.missed_outside(Q(0), Q(1), [{(1, 2): [(0, 0)] * 4}] * 3)
    assert 10 * value**2 <= missed**2 <= 10 * value**2 + 4 * GRID


# Stresses


def stresses_on(corners: list[list[Any]], kinds: str, element: checker.Element, h: int = 1, **more: Any) -> Stresses:
    problem = Problem(stated(corners, kinds, **more))
    return Stresses(Mesh.of(mesh_of(corners, h), problem), {"bits": 1, "coarse": 2}, element)


ELEMENTS = [
    # A constant stress t ⊗ t on one third, t along its outer side: no traction outside, no divergence.
    ({(0, (0, 0, 0)): (1, 1, -1)}, "tractions inside the reference element jump"),
    # A constant stress times a hat function of the centre: tractions are right, divergences differ on thirds.
    (
        {(n, key): (int(x), 0, 0) for n, hat in enumerate((checker.ONE - X - Y, X, Y)) for key, x in hat.items()},
        "the reference element does not balance",
    ),
]


@pytest.mark.parametrize(("more", "message"), ELEMENTS, ids=["jumps of tractions", "jumps of the divergence"])
def test_an_element_with_jumps_inside_is_refused(more: Any, message: str) -> None:
    data = checker.load(EXAMPLES / "square-4.json.gz")["element"]
    for (third, key), stress in more.items():
        for component, x in enumerate(stress):
            data["columns"][40][30 * component + 10 * third + CUBIC.index(key)] += x
    with pytest.raises(RefusedError, match=message):
        checker.Element.of(data)


@pytest.mark.parametrize("place", range(4))
def test_a_stress_that_pulls_on_the_foundation_is_refused(place: int, element: checker.Element) -> None:
    stresses = stresses_on(TRIANGLE, "clamped contact clamped", element, loads={})
    numbers = [-2] * 4 + [0] * 16
    assert stresses.tractions(numbers)[1] == [[-2] * 4]
    numbers[place] = 1  # the mean of the four is a pressure
    with pytest.raises(RefusedError, match="σ̃_ν > 0"):
        stresses.tractions(numbers)
    for size in (19, 21):
        with pytest.raises(RefusedError, match="tractions have another size"):
            stresses.tractions([0] * size)


def test_sides_without_load_have_no_traction(element: checker.Element) -> None:
    stresses = stresses_on(TRIANGLE, "clamped loaded clamped", element, loads={})
    assert stresses.loaded == []
    assert stresses.tractions([0] * 16)[0][1, 2] == [(0, 0)] * 4


def no_stress(stresses: Stresses, force: list[list[int]]) -> tuple[Any, Q]:
    cells, edges = stresses.mesh.cells, stresses.mesh.edges
    zero = {e: [(0, 0)] * 4 for e in [*edges, *stresses.nothing]}
    return stresses.field(zero, [0] * 9 * len(cells), force)


def test_a_force_that_no_traction_balances_is_left(element: checker.Element) -> None:
    """Without tractions Div σ̃ is orthogonal to rigid motions, so that of f̃ = (6, −8) nothing is balanced."""
    stresses = stresses_on(QUADRANGLE, "clamped loaded contact clamped", element, 2)
    force = [[3 * c.det, -4 * c.det, *[0] * 10] for c in stresses.mesh.cells]
    field, left = no_stress(stresses, force)
    area = sum(Q(cell.det, 8) for cell in stresses.mesh.cells)
    assert 100 * area <= left**2 <= 100 * area * (1 + Q(1, 2**60))
    assert not any(any(one) for one in field)
    assert no_stress(stresses, []) == no_stress(stresses, [[0] * 12] * 2)
    with pytest.raises(RefusedError, match="inner numbers have another size"):
        stresses.field({}, [0] * 17, force)


def test_what_is_not_balanced_is_rounded_up(element: checker.Element) -> None:
    """With points over 2^20 the square of it is far below the grid before it is scaled."""
    h = 1 << 20
    stresses = stresses_on(TRIANGLE, "clamped loaded clamped", element, h)
    left = no_stress(stresses, [[1, *[0] * 11]])[1]
    value = Q(1, 2)  # over 2^bits; twice the area is 1
    assert value**2 / 2 <= left**2 <= (value**2 / 2) * 10**9
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(checker, "GRID", 0)
        assert no_stress(stresses, [[1, *[0] * 11]])[1] >= value * Q(1, 2)


def test_the_losses_of_all_cells_are_made_up_for(element: checker.Element, monkeypatch: pytest.MonkeyPatch) -> None:
    """Squares of 0.9 and 0.6 units of the grid, which are rounded down to 0 in both cells."""
    stresses = stresses_on(QUADRANGLE, "clamped loaded contact clamped", element, 1 << 20)
    cells, scale = stresses.mesh.cells, Q(1 << 20, stresses.unit) ** 2
    square = int(Q(9, 10) * 12 * min(cell.det for cell in cells) ** 3 * GRID)
    monkeypatch.setattr(checker, "linear_square", lambda _: square)
    exact = sum(Q(2 * square, 24 * cell.det**3) for cell in cells) * scale
    assert exact > Q(3, 2) * GRID * scale
    assert no_stress(stresses, [[1, *[0] * 11]] * 2)[1] ** 2 >= exact


# Displacements


def test_splines_have_their_knots_and_values() -> None:
    nodes = [[0], [12], [36], [20]]
    found = list(checker.pieces(nodes, Q(3)))
    assert [(p.a, p.b) for p in found] == [(Q(0), Q(1, 2)), (Q(1, 2), Q(3, 2)), (Q(3, 2), Q(5, 2)), (Q(5, 2), Q(3))]
    # Four times: the ends, the means of nodes, and nodes as control points; the outer pieces are straight.
    assert [[v[0] for v in p.values] for p in found] == [[0, 12, 24], [24, 48, 96], [96, 144, 112], [112, 96, 80]]
    assert found[0].steps == [[24], [24], [24]]
    assert found[1].steps == [[48], [72], [96]]
    assert [[v[0] for v in p.values] for p in checker.pieces([[0], [8]], Q(1))] == [[0, 8, 16], [16, 24, 32]]


def test_u_h_is_piecewise_linear_in_time() -> None:
    problem = Problem(stated(TRIANGLE, "clamped contact loaded", loads={}, T="3"))
    mesh = Mesh.of(mesh_of(TRIANGLE), problem)
    nodes = [[0.0] * 4 + [0.0, c] for c in (0.0, 0.0, 0.0, 0.0)]
    with pytest.raises(RefusedError, match="another size"):
        checker.Computed([[0.0] * 5, [0.0] * 6], mesh, 0, problem)
    for place in (0, 1, 2, 3):
        moved = [row[:place] + [0.5] + row[place + 1 :] for row in nodes]
        with pytest.raises(RefusedError, match="does not vanish on Γ1"):
            checker.Computed(moved, mesh, 0, problem)
    values = [[0.0] * 4 + [0.5 * n * n, -0.25 * n] for n in range(4)]
    computed = checker.Computed(values, mesh, 0, problem)
    for time in (Q(0), Q(1, 3), Q(1), Q(5, 2), Q(3)):
        v, over = computed.at(time)
        n, rest = min(int(time), 2), time - min(int(time), 2)
        x = [Q(c) / (over << computed.bits) for c in v[4:6]]
        assert x == [Q(n * n, 2) + rest * Q(2 * n + 1, 2), -time / 4]
    refined = checker.Computed(values, mesh, 2, problem)
    assert refined.at(Q(3))[0][4:6] == [4 * c for c in computed.at(Q(3))[0][4:6]]
    assert refined.bits == computed.bits + 2


@pytest.mark.parametrize("time", range(3))
def test_displacements_that_are_not_admissible_are_refused(time: int) -> None:
    """ũ on Γ1 (sides 0 and 3), and on Γ3 with the normal (1, 3), by each Bernstein coefficient."""
    certificate = object.__new__(checker.Certificate)
    mesh = Mesh.of(mesh_of(QUADRANGLE, 2), Problem(stated(QUADRANGLE, "clamped loaded contact clamped")))
    certificate.mesh = mesh
    walls = {n for edge in ((0, 1), (3, 0)) for n in mesh.nodes_of(edge)}
    slide = set(mesh.nodes_of((2, 3))) - walls
    for n, (x, y) in product(range(mesh.nodes), ((3, -1), (-3, 1), (4, -1), (-4, 1), (1, 0), (-1, 0), (0, 1), (0, -1))):
        certificate.nodes = [[0] * 2 * mesh.nodes for _ in range(3)]
        certificate.nodes[time][2 * n : 2 * n + 2] = [x, y]
        if n in walls or (n in slide and x + 3 * y > 0):
            with pytest.raises(RefusedError, match=r"Γ1|Γ3" if n in walls else "ũ_ν > 0 on Γ3"):
                certificate._check_membership()
        else:
            certificate._check_membership()
    certificate.nodes[time].pop()
    with pytest.raises(RefusedError, match="ũ has another size"):
        certificate._check_membership()


# The growth of the bound


def growth(m: Q = Q(2)) -> checker.Growth:
    problem = Problem(stated(A=[["5/2", "1/2", "0"], ["1/2", "5/2", "0"], ["0", "0", "1"]]))
    problem.G = [[x * 3 for x in row] for row in problem.A]
    return checker.Growth(problem, m)


ZERO = [[Q(0)] * 3 for _ in range(3)]


@pytest.mark.parametrize("y", [Q(1, 3), Q(1, 3 * 2**48), Q(1, 7 * 2**49)], ids=["third", "tiny", "tinier"])
def test_an_error_decays_no_faster_than_it_does(y: Q) -> None:
    k = Q(1, 8)
    at_b, inside = growth()(y, k, ZERO, Q(0), Q(0))
    # e^{−1/4} is 0.77880078…
    assert y * Q(77880078, 10**8) < at_b < y * Q(7789, 10**4) + 8 * GRID + Q(1, 2**99) / y
    assert y < inside < y + 8 * GRID + Q(1, 2**99) / y
    assert growth(Q(0))(y, k, ZERO, Q(0), Q(0))[0] > y


@pytest.mark.parametrize("contact", [Q(1, 3), Q(1, 3 * 2**97)], ids=["third", "tiny"])
def test_the_work_of_contact_counts_twice(contact: Q) -> None:
    for found in growth()(Q(0), Q(1, 8), ZERO, contact, Q(0)):
        assert 2 * contact < found**2 < 2 * contact * (1 + Q(1, 2**50)) + 4 * GRID


def test_what_is_not_balanced_is_added() -> None:
    for loads in (Q(1, 3), Q(1, 3 * 2**60)):
        for found in growth()(Q(0), Q(1, 8), ZERO, Q(0), loads):
            assert loads < found < loads + 4 * GRID


def exact_growth(A: Any, G: Any, m: float, y: float, k: float, M: Any, contact: float, loads: float) -> list[float]:
    """The least bounds of all θ and β, in floating point from eigenvalues."""
    found = []
    for theta in (0.0, m):
        H = G - theta * A
        h, v = np.linalg.eigh(np.linalg.solve(np.linalg.cholesky(A), H) @ np.linalg.inv(np.linalg.cholesky(A)).T)
        v = np.linalg.inv(np.linalg.cholesky(A)).T @ v
        rho = np.einsum("ij,ik,kj->j", v, M, v)
        decay, mean = math.exp(-2 * theta * k), k * (-math.expm1(-2 * theta * k) / (2 * theta * k) if theta else 1)
        beta = np.geomspace(1e-8, 1e8, 4001)[:, None]
        taken = 2 * contact + (h / (h + beta) ** 2 * rho).sum(axis=1) / 2
        second = np.sqrt(mean * (beta**2 / (h + beta) ** 2 * rho).sum(axis=1)) + loads
        found.append([(np.sqrt(factor * y * y + taken) + second).min() for factor in (decay, 1)])
    return [min(column) for column in zip(*found, strict=True)]


@pytest.mark.parametrize("grid", [3, 6, 30])
def test_bounds_are_no_less_than_the_best_ones_on_any_grid(grid: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """On coarse grids a sum, a root or a square that is rounded down would be seen."""
    monkeypatch.setattr(checker, "GRID", grid)
    rng = np.random.default_rng(grid)
    A = np.array([[2.5, 0.5, 0], [0.5, 2.5, 0], [0, 0, 1]])
    G = np.array([[7.0, 3, 0], [3, 7, 0], [0, 0, 2]])
    problem = Problem(stated(A=[[str(Q(x)) for x in row] for row in A]))
    problem.G = [[Q(x) for x in row] for row in G]
    unit = Q(1, 1 << grid)
    for _ in range(25):
        rho = rng.integers(-8, 9, (3, 2)) * 2.0 ** rng.integers(-4, 2)
        y, contact, loads = (float(x) / 64 for x in rng.integers(0, 128, 3))
        k = float(rng.choice([0.125, 1.0, 4.0]))
        M = rho @ rho.T
        exact = exact_growth(A, G, 1.5, y, k, M, contact, loads)
        given = [[Q(float(x)) for x in row] for row in M]
        found = checker.Growth(problem, Q(3, 2))(Q(y), Q(k), given, Q(contact), Q(loads))
        for bound, least in zip(found, exact, strict=True):
            assert least * (1 - 1e-6) - 1e-12 <= float(bound)
            if grid == 30:
                assert float(bound) <= least * (1 + 1e-2) + 8 * float(unit) ** 0.5


def test_damping_that_the_law_has_not_is_refused() -> None:
    with pytest.raises(RefusedError, match="m is negative"):
        growth(-GRID)
    with pytest.raises(RefusedError, match="not positive semidefinite"):
        growth(3 + GRID)
    growth(Q(3))


# The whole


@pytest.fixture(scope="module")
def bracket() -> checker.Certificate:
    return checker.Certificate(checker.load(EXAMPLES / "bracket-4.json.gz"))


def on_grid(grid: int, call: Callable[[], Any]) -> Any:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(checker, "GRID", grid)
        return call()


def piece_of(certificate: checker.Certificate) -> Piece:
    return list(checker.pieces(certificate.nodes, certificate.problem.T))[3]


def test_distances_are_rounded_outward(bracket: checker.Certificate) -> None:
    """Sums over cells on the grid 2^0, between which those on a grid of 2^−300 have to be."""
    pairs = [on_grid(grid, lambda: list(bracket._distances(piece_of(bracket)))) for grid in (0, 300)]
    for (low, high), (below, above) in zip(*pairs, strict=True):
        assert low < below < above < high
    assert all(0 < float(above - below) < 1e-90 for below, above in pairs[1])


def test_residuals_are_rounded_up(bracket: checker.Certificate) -> None:
    piece = piece_of(bracket)
    fields = [[[n * n % 17 - 8 for n in range(90)] for _ in bracket.mesh.cells]] * 3
    still = Piece(piece.a, piece.b, [[0] * 2 * bracket.mesh.nodes] * 3)
    for one in (piece, still):
        rough, fine = (on_grid(grid, lambda one=one: bracket._residual(one, fields)) for grid in (0, 300))
        assert checker.semidefinite(checker.combined(rough, fine, Q(-1)))
        assert rough[0][0] > fine[0][0]


def test_the_largest_loss_by_rounding_is_made_up_for(bracket: checker.Certificate, monkeypatch) -> None:
    """Entries that all lose nearly 1 to the floor lose a matrix whose eigenvalue is 3 for each cell."""
    monkeypatch.setattr(checker, "GRID", 0)
    cells = iter(bracket.mesh.cells)
    monkeypatch.setattr(checker, "congruent", lambda *_: [[next_of(cells)] * 3] * 3)
    monkeypatch.setattr(bracket, "_products", lambda _: None)

    def next_of(cells: Any) -> int:
        return int(next(cells).det ** 5 - 1)

    piece = piece_of(bracket)
    fields = [[[0] * 90 for _ in bracket.mesh.cells]] * 3
    rows = bracket._residual(piece, fields)
    k, n = piece.b - piece.a, len(bracket.mesh.cells)
    unit = rows[0][0] / (3 * n)
    assert unit > 0
    assert k > 0
    lost = sum(1 - Q(1, cell.det**5) for cell in bracket.mesh.cells) * unit
    assert checker.semidefinite([[rows[i][j] - lost for j in range(3)] for i in range(3)])


def test_the_start_is_rounded_up(bracket: checker.Certificate) -> None:
    rough, fine = (on_grid(grid, bracket._start) for grid in (30, 300))
    assert 0 < fine < rough < fine + Q(1, 10**4)


def test_on_a_coarse_grid_the_interval_is_wider(made: Any) -> None:
    rough, fine = (on_grid(grid, checker.Certificate(made).check) for grid in (40, 100))
    assert rough.low < fine.low < fine.high < rough.high
    assert rough.high - fine.high < Q(1, 1000)


def strain_on(mesh: Mesh, cell: checker.Cell, values: list[Q]) -> list[checker.Poly]:
    """ε_11, ε_22 and 2ε_12 of a displacement of degree 2 by its Bernstein coefficients, by the chain rule."""
    L = [checker.ONE - X - Y, X, Y]
    shapes = [p * p for p in L] + [L[i] * L[j] * 2 for i, j in ((1, 2), (2, 0), (0, 1))]
    u, v = (checker.total(p * values[2 * n + d] for p, n in zip(shapes, cell.nodes, strict=True)) for d in (0, 1))
    (a, b, c, d), scale = cell.F, Q(mesh.h, cell.det)
    u_x, v_x = ((p.slope(0) * d - p.slope(1) * c) * scale for p in (u, v))
    u_y, v_y = ((p.slope(1) * a - p.slope(0) * b) * scale for p in (u, v))
    return [u_x, v_y, u_y + v_x]


def energy(problem: Problem, mesh: Mesh, strains: list[list[checker.Poly]]) -> Q:
    """∫ Aε·ε of polynomials on cells."""
    return sum(
        (
            problem.A[i][j] * checker.on_triangle(e[i] * e[j]) * Q(cell.det, mesh.h**2)
            for cell, e in zip(mesh.cells, strains, strict=True)
            for i, j in product(range(3), repeat=2)
        ),
        Q(0),
    )


@pytest.mark.parametrize("name", ["bracket", "wedge", "bracket with few bits"])
def test_distances_are_integrals(name: str) -> None:
    """‖v − u_h(t)‖²_V with v = ũ's control point, u_h(t) from the doubles in the file; the wedge refines its mesh."""
    data = checker.load(EXAMPLES / f"{name.split()[0]}-4.json.gz")
    if "few" in name:
        data["computed"] = [[round(64 * x) / 64 for x in row] for row in data["computed"]]
    certificate = checker.Certificate(data)
    mesh, piece, time = certificate.mesh, piece_of(certificate), Q(5, 16)
    steps = len(data["computed"]) - 1
    n = int(time * steps)
    nodes = [[Q(x) for x in u] for u in data["computed"][n : n + 2]]
    share = time * steps - n
    u = [x + share * (y - x) for x, y in zip(*nodes, strict=True)]
    coarse = Mesh.of(data["mesh"], certificate.problem)
    for one in [coarse, coarse.refined()][: data["refinements"] + 1]:
        u = [*u, *((u[2 * a + d] + u[2 * b + d]) / 2 for a, b in one.edges for d in (0, 1))]
    w = [Q(x, 4 << certificate.bits) - y for x, y in zip(piece.values[1], u, strict=True)]
    exact = energy(certificate.problem, mesh, [strain_on(mesh, cell, w) for cell in mesh.cells])
    low, high = certificate._distance(piece.values[1], 2, time)
    assert low <= exact <= high <= low + Q(1, 2**80)


def test_the_distance_of_a_displacement_from_itself_is_not_above_0_and_not_below() -> None:
    data = checker.load(EXAMPLES / "bracket-4.json.gz")
    data["computed"] = [[0.0] * len(row) for row in data["computed"]]
    certificate = checker.Certificate(data)
    low, high = certificate._distance([0] * len(piece_of(certificate).values[1]), 2, Q(5, 16))
    assert low == 0 <= high <= Q(1, 2**80)


def start_on_two_cells() -> checker.Certificate:
    """A certificate in which both components of u_0 count."""
    certificate = object.__new__(checker.Certificate)
    problem = Problem(stated(QUADRANGLE, "loaded loaded clamped loaded", loads={}, A=ROWS, start=[[], []]))
    problem.start = [checker.polynomial(p) for p in ([["1", 2, 1], ["3", 0, 1]], [["2", 1, 1], ["-1", 0, 2]])]
    mesh = Mesh.of(mesh_of(QUADRANGLE, 2), problem)
    certificate.problem, certificate.mesh, certificate.bits = problem, mesh, 4
    certificate.nodes = [[n * n % 13 for n in range(2 * mesh.nodes)]]
    return certificate


@pytest.mark.parametrize("name", ["bracket", "two cells"])
def test_the_distance_of_the_start_is_an_integral(name: str, bracket: checker.Certificate) -> None:
    certificate = bracket if name == "bracket" else start_on_two_cells()
    mesh, (u, v) = certificate.mesh, certificate.problem.start
    exact = [u.slope(0), v.slope(1), u.slope(1) + v.slope(0)]
    values = [Q(x, 1 << certificate.bits) for x in certificate.nodes[0]]
    rest = [
        [e(*mesh.images(cell)) - p for e, p in zip(exact, strain_on(mesh, cell, values), strict=True)]
        for cell in mesh.cells
    ]
    square = energy(certificate.problem, mesh, rest)
    assert square <= certificate._start() ** 2 <= square + Q(1, 2**80)


def test_residuals_are_integrals(element: checker.Element) -> None:
    """∫∫ ρ ρᵀ with ρ = σ̃ − Aε(ũ̇) − Gε(ũ) from random coefficients, by products of polynomials on two cells."""
    rng = np.random.default_rng(11)
    certificate = object.__new__(checker.Certificate)
    problem = certificate.problem = Problem(stated(QUADRANGLE, "clamped loaded contact clamped", A=ROWS))
    problem.G = [[Q(x) for x in row] for row in ((7, 3, 1), (3, 6, 0), (1, 0, Q(5, 2)))]
    mesh = certificate.mesh = Mesh.of(mesh_of(QUADRANGLE, 2), problem)
    certificate.laws, certificate.over = checker.common([*problem.A, *problem.G])
    certificate.bits, certificate.element = 3, element
    certificate.stresses = Stresses(mesh, {"bits": 2, "coarse": 0}, element)
    values = rng.integers(-99, 99, (3, 2 * mesh.nodes)).tolist()
    piece = Piece(Q(1, 3), Q(2, 3), values)
    fields = rng.integers(-(10**5), 10**5, (3, 2, 90)).tolist()
    found = certificate._residual(piece, fields)
    shapes, k = checker.bernstein(2, checker.UNIT_S), Q(1, 3)
    wanted = [[Q(0)] * 3 for _ in range(3)]
    for n, cell in enumerate(mesh.cells):
        scaled = [[Q(x, 4 << 3) for x in row] for row in values]
        nodal = [strain_on(mesh, cell, row) for row in scaled]
        # The derivative of a quadratic Bernstein polynomial has the control values 2(c_1 − c_0)/k and 2(c_2 − c_1)/k.
        steps = [[(q - p) * (2 / k) for p, q in zip(nodal[i], nodal[i + 1], strict=True)] for i in (0, 1)]
        e = [checker.total(p[c] * s for p, s in zip(nodal, shapes, strict=True)) for c in range(3)]
        linear = checker.bernstein(1, checker.UNIT_S)
        rate = [checker.total(p[c] * s for p, s in zip(steps, linear, strict=True)) for c in range(3)]
        push, scale = checker.voigt(*cell.F), Q(mesh.h, certificate.stresses.unit * cell.det**2)
        for third in range(3):
            hat = []
            for c in range(3):
                start = 30 * c + 10 * third
                parts = [
                    checker.combination(checker.PLAIN, f[n][start : start + 10]) * shape
                    for f, shape in zip(fields, shapes, strict=True)
                ]
                hat.append(checker.total(parts))
            (p, q), (r, s) = checker.CORNERS[(third + 1) % 3], checker.CORNERS[(third + 2) % 3]
            place = [checker.ONE * o + X * (x - o) + Y * (Q(1, 3) - o) for o, x in ((p, r), (q, s))]
            rho = [
                (
                    checker.total(h * (x * scale) for h, x in zip(hat, push[i], strict=True))
                    - checker.total(d * x for d, x in zip(rate, problem.A[i], strict=True))
                    - checker.total(d * x for d, x in zip(e, problem.G[i], strict=True))
                )(*place)
                for i in range(3)
            ]
            for i, j in product(range(3), repeat=2):
                wanted[i][j] += k * checker.on_triangle(rho[i] * rho[j]) / 3 * Q(cell.det, mesh.h**2)
    rest = checker.combined(found, wanted, Q(-1))
    assert checker.semidefinite(rest)
    assert max(abs(x) for row in rest for x in row) < Q(1, 10**20)


def test_the_work_of_contact_is_not_negative(bracket: checker.Certificate) -> None:
    piece = piece_of(bracket)
    normals = [[[-1] * 4 for _ in bracket.stresses.contact]] * 3
    assert bracket._contact(piece, normals) > 0
    assert bracket._contact(piece, [[[0] * 4 for _ in bracket.stresses.contact]] * 3) == 0
    with pytest.raises(RefusedError, match="work of contact is negative"):
        bracket._contact(piece, [[[1] * 4 for _ in bracket.stresses.contact]] * 3)


def test_the_work_of_contact_is_an_integral() -> None:
    """∫∫ σ̃_ν ũ_ν on a slanted foundation, by a quadrature in space and time."""
    wedge = checker.Certificate(checker.load(EXAMPLES / "wedge-4.json.gz"))
    rng, piece = np.random.default_rng(7), piece_of(wedge)
    edges, mesh = wedge.stresses.contact, wedge.mesh
    normals = [[[-int(c) for c in rng.integers(0, 2**30, 4)] for _ in edges] for _ in range(3)]
    nodes, weights = np.polynomial.legendre.leggauss(6)
    s, w = (nodes + 1) / 2, weights / 2
    basis = [np.array([math.comb(n, i) * s**i * (1 - s) ** (n - i) for i in range(n + 1)]) for n in (2, 3)]
    total = 0.0
    for i, edge in enumerate(edges):
        x, y = (c / mesh.h for c in mesh.along(edge))
        n = [
            [piece.values[r][2 * v] * y - piece.values[r][2 * v + 1] * x for v in mesh.nodes_of(edge)] for r in range(3)
        ]
        u = np.einsum("rq,rt,qx->tx", np.array(n, dtype=float), basis[0], basis[0])
        tau = np.einsum("sp,st,px->tx", np.array([one[i] for one in normals], dtype=float), basis[0], basis[1])
        total += np.einsum("tx,tx,t,x->", u, tau, w, w)
    wanted = total * float(piece.b - piece.a) / 2.0 ** (wedge.stresses.bits + wedge.bits + 2)
    assert float(wedge._contact(piece, normals)) == pytest.approx(wanted, rel=1e-12)


def test_all_that_is_missed_is_added_with_its_constant(bracket: checker.Certificate, monkeypatch) -> None:
    """∫ of the loads that are missed: k (C_Ω (‖f_0 − f̃_0‖ + mean of ‖Div σ̃ + f̃_0‖) + C_Γ ‖f_2 − σ̃ν‖)."""
    left, given, times = [], [], []

    def field(self: Stresses, edges: Any, numbers: list[int], force: Any) -> Any:
        assert numbers == bracket.numbers[len(left)][1]
        left.append(Q(1 + len(left) ** 2))
        return [], left[-1]

    def growth(y: Q, k: Q, M: Any, contact: Q, loads: Q) -> tuple[Q, Q]:
        given.append((y, k, M, contact, loads))
        return Q(len(given)), Q(100)

    def outside(self: Loads, a: Q, b: Q, edges: Any) -> Q:
        n = 2 * len(times)
        assert list(edges) == [bracket.stresses.tractions(bracket.numbers[n + i][0])[0] for i in range(3)]
        times.append((a, b))
        return 1000 * b

    monkeypatch.setattr(Stresses, "field", field)
    monkeypatch.setattr(Loads, "missed_inside", lambda self, a, b: 10**6 * (a + b))
    monkeypatch.setattr(Loads, "missed_outside", outside)
    monkeypatch.setattr(bracket, "growth", growth)
    monkeypatch.setattr(bracket, "_residual", lambda piece, fields: ("M", piece.a))
    monkeypatch.setattr(bracket, "_contact", lambda piece, normals: ("contact", piece.a))
    assert bracket.check().last == len(given) == 9
    parts = list(checker.pieces(bracket.nodes, bracket.problem.T))
    assert times == [(piece.a, piece.b) for piece in parts]
    for j, (piece, (y, k, M, contact, loads)) in enumerate(zip(parts, given, strict=True)):
        assert (k, M, contact) == (piece.b - piece.a, ("M", piece.a), ("contact", piece.a))
        assert y == (j if j else checker.up(bracket._start()))
        inside = 10**6 * (piece.a + piece.b) + Q(sum(1 + n**2 for n in (2 * j, 2 * j + 1, 2 * j + 2)), 3)
        exact = k * (bracket.volume * inside + bracket.surface * 1000 * piece.b)
        assert exact <= loads < exact + GRID


DISTANCES = [
    # The largest inside a piece decides from above, the one at its end from below; the start counts, too.
    ([(4, 9), (16, 49), (16, 25)], (0, 1), 4 - 1, 7 + 2),
    ([(4, 9), (16, 49), (16, 25)], (0, 144), 4 - 1, 12),
    ([(49, 50), (1, 4), (0, 1)], (0, 1), 0, 2 + Q(7071067811865475, 10**15)),
]


@pytest.mark.parametrize(("pairs", "first", "low", "high"), DISTANCES, ids=str)
def test_an_interval_is_a_distance_more_or_less_a_bound(
    pairs: Any, first: Any, low: int, high: Q, bracket: checker.Certificate, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bracket, "growth", lambda *_: (Q(1), Q(2)))
    monkeypatch.setattr(bracket, "_residual", lambda *_: None)
    monkeypatch.setattr(bracket, "_contact", lambda *_: None)
    monkeypatch.setattr(bracket, "_distances", lambda _: [(Q(a), Q(b)) for a, b in pairs])

    def at_start(v: list[int], more: int, time: Q) -> tuple[Q, Q]:
        assert (v, more, time) == ([4 * x for x in bracket.nodes[0]], 2, 0)
        return Q(first[0]), Q(first[1])

    monkeypatch.setattr(bracket, "_distance", at_start)
    found = bracket.check()
    start = bracket._start() if first[1] == 144 else 0
    assert found.low == low
    assert high + start <= found.high < high + start + Q(1, 10**14)
    assert (found.cells, found.last) == (20, 1)
    assert 0 <= found.h**2 - Q(6, 20) <= Q(1, 2**98)


def test_a_bound_without_end_is_refused(bracket: checker.Certificate, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bracket, "growth", lambda *_: (Q(0), Q(10**100)))
    with pytest.raises(RefusedError, match="too large to be printed"):
        bracket.check()


def test_u_h_has_no_node_inside_half_a_piece(bracket: checker.Certificate, monkeypatch: pytest.MonkeyPatch) -> None:
    """Eight steps of u_h on [0, 1] and the ends of a piece: at nodes, in their middle, and elsewhere."""
    monkeypatch.setattr(bracket, "_distance", lambda *_: None)
    values = piece_of(bracket).values
    for a, b in ((Q(0), Q(1, 8)), (Q(1, 16), Q(3, 16)), (Q(3, 32), Q(5, 32)), (Q(7, 8), Q(1)), (Q(1, 8), Q(3, 8))):
        assert len(list(bracket._distances(Piece(a, b, values)))) == 5
    for a, b in ((Q(1, 16), Q(1, 4)), (Q(0), Q(3, 8)), (Q(1, 8) - GRID, Q(1, 8) + 2 * GRID)):
        with pytest.raises(RefusedError, match="u_h has a node inside"):
            list(bracket._distances(Piece(a, b, values)))


# Orders


def proved(cells: int, low: Any, high: Any) -> Enclosure:
    return Enclosure(cells, Q(1), Q(low), Q(high), Q(0))


ORDERS = [
    (proved(8, 1, 1), proved(32, "1/2", "1/2"), 1, 1),
    (proved(8, 1, 2), proved(32, "1/4", "1/2"), 1, 3),
    (proved(8, "1/4", "1/2"), proved(32, 1, 2), -3, -1),
    (proved(8, 1, 2), proved(32, 1, 2), -1, 1),
    (proved(8, 1, 1), proved(16, "1/8", "1/8"), 6, 6),
    (proved(1, 1, 1), proved(81, 3, 3), Q(-1, 2), Q(-1, 2)),
    (proved(1, 3, 3), proved(81, 1, 1), Q(1, 2), Q(1, 2)),
]


@pytest.mark.parametrize(("coarse", "fine", "low", "high"), ORDERS, ids=str)
def test_orders_are_enclosed(coarse: Enclosure, fine: Enclosure, low: int, high: int) -> None:
    span = checker.order(coarse, fine)
    assert span is not None
    assert low - Q(1, 2**55) < span[0] <= low
    assert high <= span[1] < high + Q(1, 2**55)


def test_no_order_without_two_meshes_and_positive_errors() -> None:
    one, two = proved(8, 1, 1), proved(32, 1, 1)
    assert checker.order(one, two) is not None
    assert checker.order(one, one) is checker.order(two, one) is None
    assert checker.order(proved(8, 0, 1), two) is checker.order(one, proved(32, 0, 1)) is None
    assert checker.order(proved(8, -1, 1), two) is checker.order(one, proved(32, -1, 1)) is None


@pytest.mark.parametrize(
    ("x", "above", "wanted"),
    [
        (Q(1, 3), False, "0.33333333"),
        (Q(1, 3), True, "0.33333334"),
        (Q(-1, 3), False, "-0.33333334"),
        (Q(-1, 3), True, "-0.33333333"),
        (Q(5, 4), False, "1.25000000"),
        (Q(5, 4), True, "1.25000000"),
        (Q(-1, 10**9), True, "0.00000000"),
        (Q(12), True, "12.00000000"),
    ],
)
def test_decimals_are_rounded_outward(x: Q, above: bool, wanted: str) -> None:
    assert checker.decimal(x, above) == wanted


def test_orders_are_printed_from_coarse_to_fine_whatever_comes_first(capsys, monkeypatch) -> None:
    """h is counted on the meshes; of equal meshes there is no order."""
    results = iter([proved(32, "1/2", "1/2"), proved(8, 1, 1), proved(8, 1, 1), proved(128, 0, 1)])
    monkeypatch.setattr(checker, "load", lambda path: {"problem": {"T": "1"}})
    monkeypatch.setattr(checker, "verified", lambda data: next(results))
    assert checker.main([str(EXAMPLES / "square-4.json.gz")] * 4) == 0
    lines = capsys.readouterr().out.splitlines()[8:]
    assert lines == [
        "no order from 8 to 8 cells: h is the same",
        "order from 8 to 32 cells in [0.9999, 1.0001]",
        "no order from 8 to 128 cells: an error may be 0",
        "order from 8 to 32 cells in [0.9999, 1.0001]",
        "no order from 8 to 128 cells: an error may be 0",
        "no order from 32 to 128 cells: an error may be 0",
        "the problem:",
        '    T: "1"',
    ]


def test_results_are_printed_outward(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    path = str(EXAMPLES / "square-4.json.gz")
    monkeypatch.setattr(checker, "load", lambda path: {"problem": {"T": "1"}})
    monkeypatch.setattr(checker, "verified", lambda data: Enclosure(3, Q(2, 3), Q(1, 3), Q(2, 3), Q(0)))
    assert checker.main([path]) == 0
    shown = f"{path}:\n    3 cells, h = 0.6666: max ‖u − u_h‖_V in [0.33333333, 0.66666667]\n"
    assert capsys.readouterr().out.startswith(shown)
