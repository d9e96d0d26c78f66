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
from study.certify.checker import Enclosure, Loads, Mesh, Problem, RefusedError, Stresses

EXAMPLES = Path(__file__).parents[2] / "examples" / "certificates"
GRID = Q(1, 1 << checker.GRID)
UNIT, STIFF = ([[a, "0", "0"], ["0", a, "0"], ["0", "0", a]] for a in "14")
TRIANGLE, SLANTED = [[0, 0], [1, 0], [0, 1]], [[0, 0], [4, 0], [0, 3]]
QUADRANGLE = [[0, 0], [2, 0], [Q(3, 2), 1], [0, Q(3, 2)]]
MIXED = "clamped loaded contact clamped"


def load(*components: list[list[Any]]) -> list[list[Any]]:
    """Two components of a load without kinks, from monomials."""
    return [[[monomials, [], 0]] if monomials else [] for monomials in components]


PUSHED = {"1": load([["1", 0, 0, 0]], [])}


def posed(
    corners: list[list[Any]], kinds: str, h: int = 1, loads: Any = PUSHED, A: Any = UNIT, **more: Any
) -> tuple[Problem, Mesh]:
    """A problem on a polygon, and its mesh: a fan of triangles from the first vertex, with points over h."""
    data: dict[str, Any] = {"T": "1", "G": A, "force": [[], []], "start": [[], []]}
    vertices = [[str(c) for c in corner] for corner in corners]
    problem = Problem(data | {"vertices": vertices, "kinds": kinds.split(), "loads": loads, "A": A} | more)
    return problem, Mesh.of(mesh_of(corners, h), problem)


def mesh_of(corners: list[list[Any]], h: int) -> dict[str, Any]:
    n = len(corners)
    return {
        "denominator": h,
        "points": [[int(Q(c) * h) for c in corner] for corner in corners],
        "cells": [[0, i, i + 1] for i in range(1, n - 1)],
        "sides": [[i, (i + 1) % n] for i in range(n)],
    }


@pytest.fixture(scope="module")
def element() -> checker.Element:
    return checker.Element.of(checker.load(EXAMPLES / "square-4.json.gz")["element"])


# The problem

POLYGONS = [[[0, 0], [2, 0], [1, 0], [1, 1]], [[0, 0], [2, 0], [2, 2], [1, 0]], [[0, 0], [2, 0], [1, 0]]]


@pytest.mark.parametrize("corners", POLYGONS, ids=str)
def test_polygons_that_touch_themselves_or_have_no_area_are_refused(corners: list[list[int]]) -> None:
    for n in range(len(corners)):
        with pytest.raises(RefusedError, match=r"two sides of the polygon meet|counter-clockwise"):
            posed([*corners[n:], *corners[:n]], " ".join(["clamped"] * len(corners)), loads={})


def test_the_start_does_not_enter_a_slanted_foundation() -> None:
    """u_0 = x y (a, b) on a foundation with the normal (3, 4)."""
    for a, b in ((1, -1), (4, -3), (-4, 3), (-1, 1), (5, -3), (4, -2)):
        start = [[[str(c), 1, 1]] for c in (a, b)]
        if 3 * a + 4 * b <= 0:
            posed(SLANTED, "clamped contact clamped", loads={}, start=start)
        else:
            with pytest.raises(RefusedError, match="u_0ν ≤ 0 on Γ3 cannot be shown"):
                posed(SLANTED, "clamped contact clamped", loads={}, start=start)


@pytest.mark.parametrize("start", [[[["1", 1, 0]], []], [[], [["1", 0, 1]]], [[["1", 0, 0], ["-1", 1, 0]], []]])
def test_the_start_vanishes_on_every_wall_in_both_components(start: Any) -> None:
    with pytest.raises(RefusedError, match="u_0 does not vanish on Γ1"):
        posed(SLANTED, "clamped loaded clamped", loads={}, start=start)


# Constants of the body

CORNER, SCALE = 1 << 102, 1 << 104
NEAR = int(checker.root(Q(2)) / 16 * SCALE)
"""The least integer above 2^104 √2/16."""
MU = Q(CORNER - NEAR, SCALE) - Q(CORNER, SCALE) ** 2 / 4


def constants(near: int, mu: Q, kappa: Q = Q(1, 16), kind: str = "loaded") -> tuple[Q, Q]:
    """Φ with Φ_111 = Φ_222 from −CORNER at the origin to −near on the hypotenuse, others 0, over 2^104.

    −Φ(ν, v, v) = near/√2 |v|² on the hypotenuse, div Φ = CORNER − near, and A⁻¹(Φv)·(Φv) is at most CORNER²/4.
    """
    field = [[-CORNER, 0, 0, -CORNER], [-near, 0, 0, -near], [-near, 0, 0, -near]]
    data = {"mesh": mesh_of(TRIANGLE, 1), "bits": 104, "field": field, "volume": str(mu), "surface": str(kappa)}
    problem, _ = posed(TRIANGLE, f"clamped {kind} clamped", loads=PUSHED if kind == "loaded" else {}, A=STIFF)
    return checker.load_constants(data, problem)


def test_constants_are_accepted_to_the_last_digit_and_refused_from_there_on() -> None:
    """√2 is rounded up: a load of κ √2 that Φ misses by less than 2^−104 is missed."""
    volume, surface = constants(NEAR, MU)
    assert volume**2 * MU > 1 > (volume - 2 * GRID) ** 2 * MU
    assert (surface - GRID) ** 2 / 16 <= 1 < surface**2 / 16
    with pytest.raises(RefusedError, match="constant of forces"):
        constants(NEAR, MU + Q(1, 2**200))
    with pytest.raises(RefusedError, match="constant of loads"):
        constants(NEAR - 1, MU)
    assert Q(NEAR - 1, SCALE) ** 2 < 2 * Q(1, 16) ** 2 < Q(NEAR, SCALE) ** 2


def test_on_the_foundation_a_field_must_not_pull_and_on_the_wall_nothing_is_required() -> None:
    mu = Q(1, 4) - Q(1, 64)
    volume, _ = constants(0, mu, Q(1), "contact")
    assert (volume - GRID) ** 2 * mu <= 1 < volume**2 * mu
    with pytest.raises(RefusedError, match="constant of loads"):
        constants(-1, mu, Q(1), "contact")


# Loads


def loads_on(corners: list[list[Any]], h: int, bits: int, **more: Any) -> Loads:
    return Loads(*posed(corners, " ".join(["clamped", "loaded", *["clamped"] * (len(corners) - 2)]), h, **more), bits)


K = Q(1, 2**12)
BEGIN, END = Q(1, 4), Q(1, 4) + K
REST: dict[str, tuple[Any, Q]] = {
    "cubic in time": (load([["1", 0, 0, 3]], [["2", 0, 0, 3]]), 5 * K**6 / 840 / 2),
    "cubic in space": (load([["1/4096", 3, 0, 0]], []), Q(1, 4096) ** 2 / 56),
    "mixed in space": (load([], [["1", 0, 2, 0], ["1", 1, 1, 0], ["1/4096", 1, 2, 0]]), Q(1, 4096) ** 2 * Q(48, 40320)),
    # ∫ x⁴ y² = 4! 2!/8!, times the mean of t⁴.
    "cubic in space, quadratic in time": (load([["1", 2, 1, 2]], []), Q(48, 40320) * (END**5 - BEGIN**5) / (5 * K)),
}


@pytest.mark.parametrize("name", REST, ids=str)
def test_what_a_force_has_beyond_is_missed(name: str) -> None:
    """Mean squares in closed form: (t − a)(t − m)(t − b) has k^6/840, X^i Y^j has (2i)!(2j)!/(2i + 2j + 2)!."""
    force, square = REST[name]
    missed, rough = (loads_on(TRIANGLE, 1, bits, force=force).missed_inside(BEGIN, END) for bits in (300, 3))
    assert square <= missed**2 <= square * (1 + Q(1, 2**15))
    assert 0 <= rough - missed - Q(3, 8) < 2 * GRID  # six coefficients of both components are rounded to eighths


def left(loads: Loads, traction: tuple[int, int] = (0, 0)) -> Q:
    """What a constant traction leaves of the loads on side 1."""
    return loads.missed_outside(Q(0), Q(1), [{(1, 2): [traction] * 4}] * 3)


def test_lengths_are_rounded_down() -> None:
    """A load 1 and, across it, a traction t have the mean square (2 + t²)/√2 on a side of length √2."""
    t = 10**6
    missed = left(loads_on(TRIANGLE, 1, 100), (0, t << 100))
    assert (2 + t * t) ** 2 <= missed**4 * 2 <= (2 + t * t) ** 2 * (1 + Q(1, 2**60))


def test_a_load_that_is_taken_up_is_not_missed_and_every_coefficient_counts() -> None:
    """f_2 = (t² x, y) on a side of length 5, from its Bernstein coefficients; then one of these is moved."""
    a, b, h, bits = Q(1, 2), Q(1), 2, 10
    loads = loads_on(SLANTED, h, bits, loads={"1": load([["1", 1, 0, 2]], [["1", 0, 1, 0]])})
    unit = 5 * h << bits
    exact = np.array([[[unit * t * 4 * Q(3 - p, 3), Q(unit * p)] for p in range(4)] for t in (a * a, a * b, b * b)])

    def missed(tractions: Any) -> Q:
        return loads.missed_outside(a, b, [{(1, 2): one.tolist()} for one in tractions])

    assert missed(exact) ** 2 <= 3 * GRID  # squares are rounded up to the grid, in each component
    assert 0 < float(missed(exact.astype(int).astype(object))) < 5 / 2**bits
    for s, p, d in product(range(3), range(4), (0, 1)):
        moved = exact.copy()
        moved[s, p, d] += unit
        # ∫ B_s² = C(2, s)²/C(4, 2s)/5, ∫ B_p² = C(3, p)²/C(6, 2p)/7, times the length.
        square = 5 * Q(math.comb(2, s) ** 2, 5 * math.comb(4, 2 * s)) * Q(math.comb(3, p) ** 2, 7 * math.comb(6, 2 * p))
        assert square <= missed(moved) ** 2 <= square * (1 + Q(1, 2**80))


# Stresses


def stresses_on(corners: list[list[Any]], kinds: str, element: checker.Element, h: int, **more: Any) -> Stresses:
    return Stresses(posed(corners, kinds, h, **more)[1], {"bits": 1, "coarse": 2}, element)


def test_a_stress_that_pulls_on_the_foundation_in_one_coefficient_is_refused(element: checker.Element) -> None:
    stresses = stresses_on(TRIANGLE, "clamped contact clamped", element, 1, loads={})
    assert stresses.tractions([-2] * 4 + [0] * 16)[1] == [[-2] * 4]
    for place in range(4):
        numbers = [-2] * 4 + [0] * 16
        numbers[place] = 1  # the mean of the four is a pressure
        with pytest.raises(RefusedError, match="σ̃_ν > 0"):
            stresses.tractions(numbers)


def no_stress(stresses: Stresses, force: list[list[int]]) -> tuple[Any, Q]:
    zero = {e: [(0, 0)] * 4 for e in [*stresses.mesh.edges, *stresses.nothing]}
    return stresses.field(zero, [0] * 9 * len(stresses.mesh.cells), force)


def test_a_force_that_no_traction_balances_is_left(element: checker.Element) -> None:
    """Without tractions Div σ̃ is orthogonal to rigid motions, so that of f̃ = (6, −8) nothing is balanced."""
    stresses = stresses_on(QUADRANGLE, MIXED, element, 2)
    field, unbalanced = no_stress(stresses, [[3 * c.det, -4 * c.det, *[0] * 10] for c in stresses.mesh.cells])
    area = sum(Q(cell.det, 8) for cell in stresses.mesh.cells)
    assert 100 * area <= unbalanced**2 <= 100 * area * (1 + Q(1, 2**60))
    assert not any(any(one) for one in field)
    assert no_stress(stresses, []) == no_stress(stresses, [[0] * 12] * 2)


# Displacements


def test_u_h_has_the_size_of_its_mesh_and_vanishes_on_the_wall() -> None:
    problem, mesh = posed(TRIANGLE, "clamped contact loaded", loads={})
    values = [[0.0] * 4 + [0.5 * n, -0.25 * n] for n in range(2)]
    for place in range(4):
        moved = [[*row[:place], 0.5, *row[place + 1 :]] for row in values]
        with pytest.raises(RefusedError, match="does not vanish on Γ1"):
            checker.Computed(moved, mesh, 0, problem)
    with pytest.raises(RefusedError, match="another size"):
        checker.Computed([values[0][1:], values[0]], mesh, 0, problem)


@pytest.mark.parametrize("time", range(3))
def test_displacements_that_are_not_admissible_are_refused(time: int) -> None:
    """ũ on Γ1 (sides 0 and 3), and on Γ3 with the normal (1, 3), by each Bernstein coefficient."""
    certificate = object.__new__(checker.Certificate)
    mesh = certificate.mesh = posed(QUADRANGLE, MIXED, 2)[1]
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


# The growth of the bound


def growth(m: Q) -> checker.Growth:
    A = [["5/2", "1/2", "0"], ["1/2", "5/2", "0"], ["0", "0", "1"]]
    problem, _ = posed(TRIANGLE, "clamped loaded clamped", A=A)
    problem.G = [[x * 3 for x in row] for row in problem.A]
    return checker.Growth(problem, m)


@pytest.mark.parametrize("seed", range(4))
def test_rounding_makes_a_bound_larger(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """On a coarse grid a sum, a root or a square that is rounded down would be seen."""
    rng, bounds = np.random.default_rng(seed), []
    rho = rng.integers(-8, 9, (3, 2))
    M = [[Q(int(x), 16) for x in row] for row in rho @ rho.T]
    y, contact, loads = (Q(int(x), 64) for x in rng.integers(1, 128, 3))
    for grid in (3, 6, 100):
        monkeypatch.setattr(checker, "GRID", grid)
        bounds.append(growth(Q(3, 2))(y, Q(1, 8), M, contact, loads))
    for coarse in bounds[:2]:
        assert all(rough >= fine for rough, fine in zip(coarse, bounds[2], strict=True))


def test_damping_that_the_law_has_not_is_refused() -> None:
    with pytest.raises(RefusedError, match="m is negative"):
        growth(-GRID)
    with pytest.raises(RefusedError, match="not positive semidefinite"):
        growth(3 + GRID)
    growth(Q(3))


# The whole


def on_grid(grid: int, call: Callable[[], Any]) -> Any:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(checker, "GRID", grid)
        return call()


def test_on_a_coarse_grid_the_interval_is_wider(made: Any) -> None:
    rough, fine = (on_grid(grid, checker.Certificate(made).check) for grid in (40, 100))
    assert rough.low < fine.low < fine.high < rough.high
    assert rough.high - fine.high < Q(1, 1000)


@pytest.mark.parametrize("name", ["f_0 that is not balanced", "f_0 that is not taken up", "f_2"])
def test_loads_that_are_missed_are_added_with_their_constant(name: str, certificate: Any, monkeypatch: Any) -> None:
    """The load t on a body of area 1 or a side of length 1 is added, which the stresses in the file do not balance."""
    one, problem = checker.Certificate(certificate), certificate["problem"]
    pieces = [(p.a, p.b) for p in checker.pieces(one.nodes, one.problem.T)]
    if name == "f_2":
        problem["loads"]["1"][0].append([[["1", 0, 0, 1]], [], 0])
        wanted = float(one.surface) * sum(float(b - a) * float((a * a + a * b + b * b) / 3) ** 0.5 for a, b in pieces)
    else:
        problem["force"][0].append([[["1", 0, 0, 1]], [], 0])
        wanted = float(one.volume) * float(one.problem.T**2) / 2
    other, found = checker.Certificate(certificate), []
    for each in (one, other):
        each.growth = lambda y, k, M, contact, loads: (y + loads, Q(0))  # type: ignore[assignment,method-assign]
        found.append(float(each.check().last))
    if name == "f_0 that is not taken up":
        monkeypatch.setattr(Loads, "missed_inside", lambda self, a, b: (a + b) / 2)
        found = [found[1], float(other.check().last)]
    assert found[1] - found[0] == pytest.approx(wanted, rel=1e-3)


def test_a_bound_without_end_is_refused(made: Any) -> None:
    certificate = checker.Certificate(made)
    certificate.growth = lambda *_: (Q(0), Q(10**100))  # type: ignore[assignment,method-assign]
    with pytest.raises(RefusedError, match="too large to be printed"):
        certificate.check()


# Orders


def proved(cells: int, low: Any, high: Any) -> Enclosure:
    return Enclosure(cells, Q(1), Q(low), Q(high), Q(0))


ORDERS = [
    (proved(8, 1, 1), proved(32, "1/2", "1/2"), 1, 1),
    (proved(8, 1, 2), proved(32, "1/4", "1/2"), 1, 3),
    (proved(8, "1/4", "1/2"), proved(32, 1, 2), -3, -1),
    (proved(1, 3, 3), proved(81, 1, 1), Q(1, 2), Q(1, 2)),
]


@pytest.mark.parametrize(("coarse", "fine", "low", "high"), ORDERS, ids=str)
def test_orders_are_enclosed(coarse: Enclosure, fine: Enclosure, low: int, high: int) -> None:
    span = checker.order(coarse, fine)
    assert span is not None
    assert low - Q(1, 2**55) < span[0] <= low
    assert high <= span[1] < high + Q(1, 2**55)


@pytest.mark.parametrize(("low", "fine_low"), [(0, 1), (1, 0)])
def test_no_order_is_proved_if_one_of_the_errors_may_be_zero(low: int, fine_low: int) -> None:
    assert checker.order(proved(8, low, 1), proved(32, fine_low, 1)) is None


def test_results_are_printed_outward_and_orders_from_coarse_to_fine_whatever_comes_first(capsys, monkeypatch) -> None:
    """h is counted on the meshes; of equal meshes, or if an error may be 0, there is no order."""
    last = Enclosure(128, Q(2, 3), Q(-1, 3), Q(2, 3), Q(0))
    results = iter([proved(32, "1/2", "1/2"), proved(8, 1, 1), proved(8, 0, 1), last])
    path = str(EXAMPLES / "square-4.json.gz")
    monkeypatch.setattr(checker, "load", lambda path: {"problem": {"T": "1"}})
    monkeypatch.setattr(checker, "verified", lambda data: next(results))
    assert checker.main([path] * 4) == 0
    assert capsys.readouterr().out.splitlines()[6:] == [
        f"{path}:",
        "    128 cells, h = 0.6666: max ‖u − u_h‖_V in [-0.33333334, 0.66666667]",
        "no order from 8 to 8 cells: h is the same",
        "order from 8 to 32 cells in [0.9999, 1.0001]",
        "no order from 8 to 128 cells: an error may be 0",
        "no order from 8 to 32 cells: an error may be 0",
        "no order from 8 to 128 cells: an error may be 0",
        "no order from 32 to 128 cells: an error may be 0",
        "the problem:",
        '    T: "1"',
    ]
