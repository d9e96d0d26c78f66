"""The bound and the enclosure: no error lies outside, whatever the case, the mesh, the scheme and the time.

That is a theorem, so one error outside refutes the implementation; and a wrong implementation has to put one outside.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np
import pytest
import sympy as sp
from sympy import Expr

from manufactured import Case, ExactSolution, KelvinVoigt, named, t, unit_square, x2
from manufactured.cases.laws import not_proportional
from manufactured.catalogue import NAMES
from manufactured.data import Data
from manufactured.tensors import Array
from study.bound import terms
from study.bound.bounded import check_problem
from study.bound.discretisation import Discretisation
from study.bound.enclosing import enclose, known_error
from study.bound.problem import BoundError
from study.bound.terms import Majorant
from study.bound.trajectory import Parabola, Refined, SmoothedInTime, Trajectory, compute, spline
from study.fem.mesh import FAMILIES, Graded, MeshFamily, OneDiagonal, Shaken, Unstructured
from study.fem.quadrature import Line, cell_rules
from study.solve.evolution import Scheme
from study.solve.tableau import MIDPOINT, SCHEMES
from study.statements.enclosure import eligible, measure, resolve_problem

GAPS = ("closing-gap", "parabolic-gap")
UNSERVED = ("moving-rough", "layered-unmet", "rough-1.75", "rough-2", "rough-2.25", *GAPS)
"""Cases to which the bound does not apply."""
BOUNDED = [name for name in NAMES if name not in UNSERVED and not name.startswith("cube")]
ROUNDING = 1e-9
"""Relative; errors in round-off are compared with bounds in round-off."""
TRAJECTORIES = [SmoothedInTime(), Refined(0, 2)]


# ---- the error, measured by another quadrature


def distance(discretisation: Discretisation, solution: ExactSolution) -> Callable[[float, Array], float]:
    """(t, v) ↦ ‖u(t) − v‖_V for v of degree 2."""
    lines = [Line(*line) for line in discretisation.data.lines]
    rules = cell_rules(discretisation.mesh, 8, lines, discretisation.data.points)
    fields, V = [(rule, solution.at(rule.points)) for rule in rules], discretisation.displacements

    def measured(time: float, v: Array) -> float:
        parts = [(rule, exact.strain(time) - V.strain_at(v, rule.cells, rule.points)) for rule, exact in fields]
        return math.sqrt(sum(np.vdot(solution.law.A.at(rule.points)(off), off * rule.weights) for rule, off in parts))

    return measured


def closest(case: Case, mesh, scheme: Scheme, steps: int, trajectory: Trajectory, seed: int = 0) -> float:
    """Assert that no error lies outside, at the knots and at a random time of every piece; the largest lower/error."""
    coarse = Discretisation(Data.of(case.solution), mesh)
    computed = compute(coarse, scheme, steps)
    error = known_error(case, computed)
    assert error is not None
    found = enclose(coarse, computed, trajectory, error)
    slack = ROUNDING * max(found.error.max(), found.upper.max())
    assert (found.lower <= found.error + slack).all()
    assert (found.error <= found.upper + slack).all()
    assert found.lowest - slack <= found.error.max() <= found.highest + slack

    fine = trajectory.discretisation(coarse)
    u_h, true, rng = computed.on(fine), distance(fine, case.solution), np.random.default_rng(seed)
    for piece, interval in zip(spline(trajectory.nodes(fine, computed)), found.intervals, strict=True):
        assert (piece.a, piece.b) == (interval.a, interval.b)
        assert interval.inside >= max(interval.at_a, interval.at_b) * (1 - 1e-12)
        for share, bound in ((rng.random(), interval.inside), (1.0, interval.at_b)):
            time = piece.a + share * (piece.b - piece.a)
            v, u = piece.at(time), computed.at(time)
            assert (fine.displacements.N @ v).max(initial=0.0) <= 1e-10
            assert true(time, v) <= bound + slack
            assert error(time, u) <= min(bound + fine.norm(v - u_h(time)), found.highest) + slack
    return float((found.lower / np.maximum(found.error, np.finfo(float).tiny)).max())


# ---- the main property


def turn(number: int) -> tuple[Case, MeshFamily, Scheme]:
    """A case with the families that mesh it and the schemes in turn; graded meshes where corners need them."""
    case = named(BOUNDED[number])
    serving = [family for family in FAMILIES if family.serves(case.solution.body)]
    graded = [family for family in serving if isinstance(family, Graded)]
    return case, (graded or serving)[number % len(graded or serving)], SCHEMES[number % len(SCHEMES)]


TURNS = [
    pytest.param(number, level, trajectory, id=f"{trajectory.name}-{name}-{level}", marks=marks)
    for number, name in enumerate(BOUNDED)
    # The boundary condition of *corner* changes at 3/4, which is no vertex of level 2.
    for level, trajectory in product((4, 8) if name == "corner" else (2, 4, 8), TRAJECTORIES)
    # A third of the cheaper cases, with both displacements in turn; the nightly job tries all.
    for quick in [level == 2 and number % 3 == 0 and trajectory is TRAJECTORIES[number % 2]]
    for marks in [() if quick and name not in ("hexagon", "merging-patches") else pytest.mark.slow]
]


@pytest.mark.parametrize(("number", "level", "trajectory"), TURNS)
def test_no_error_lies_outside(number: int, level: int, trajectory: Trajectory) -> None:
    case, family, scheme = turn(number)
    closest(case, family(case.solution.body, level), scheme, math.ceil(level * case.solution.body.T), trajectory)


def test_all_cases_families_and_schemes_have_their_turn() -> None:
    assert [name for name in NAMES if eligible(named(name)) and name not in GAPS] == BOUNDED
    _, families, schemes = zip(*map(turn, range(len(BOUNDED))), strict=True)
    assert (set(families), set(schemes)) == (set(FAMILIES), set(SCHEMES))


def test_a_refined_mesh_encloses_the_error_more_tightly() -> None:
    case = named("fixed-front-off-vertex")
    mesh = OneDiagonal()(case.solution.body, 3)
    plain, finer = (closest(case, mesh, MIDPOINT, 2, Refined(r, 2)) for r in (0, 1))
    assert plain < finer < 1


# ---- problems whose solution the spaces contain


@dataclass(frozen=True)
class Patch:
    """u = g(t) (0, w(x2)) with w of degree 2, w(1) = 0, in full contact or in none.

    Attributes:
        w: coefficients of 1, x2, x2².
    """

    name: str
    w: tuple[float, float, float]

    def coefficients(self, discretisation: Discretisation) -> Array:
        """(0, w) from its polar form at vertices and at the ends of edges."""
        y, (a, b, c) = discretisation.mesh.p[1], self.w
        (x, z) = np.hstack([[y, y], y[discretisation.mesh.facets]])
        polar = a + b * (x + z) / 2 + c * x * z
        return np.array([0 * polar, polar]).T.ravel()[discretisation.displacements.free]

    def data(self, g: Expr, law: KelvinVoigt) -> Data:
        """f_0, f_2 and u_0 from the law by hand: ε = ε_22 = g w'."""
        w = self.w[0] + self.w[1] * x2 + self.w[2] * x2**2
        A, G = law.A.matrix, law.G.matrix
        across, along = ((sp.diff(g, t) * A[1, i] + g * G[1, i]) * sp.diff(w, x2) for i in (0, 1))
        loads = {1: (across, 0), 3: (-across, 0)}
        return Data.formulas(unit_square(), law, (0, -sp.diff(along, x2)), loads, (0, w * g.subs(t, 0)))


PATCHES = [Patch("full contact", (0.0, -1.0, 1.0)), Patch("no contact", (1.0, 0.0, -1.0))]


@pytest.mark.parametrize("patch", PATCHES, ids=lambda patch: patch.name)
def test_the_bound_vanishes_for_a_solution_of_degree_2_in_space_and_time(patch: Patch) -> None:
    data = patch.data(1 + t + 3 * t**2 / 2, not_proportional())
    data.check()
    discretisation = Discretisation(data, Unstructured()(data.body, 3))
    v = patch.coefficients(discretisation)
    pieces = [
        Parabola(a, b, (1 + a + 1.5 * a * a) * v, (1 + (a + b) / 2 + 1.5 * a * b) * v, (1 + b + 1.5 * b * b) * v)
        for a, b in pairwise([0.0, 0.1, 0.15, 0.5, 1.0])
    ]
    intervals = [interval for _, interval in Majorant(discretisation)(pieces, 0.0)]
    size = discretisation.norm(pieces[-1].end)
    assert size > 1
    # Rounding of the products in c, some 1e-14 of ‖u‖², comes under a square root.
    assert intervals[-1].at_b <= 1e-6 * size
    assert max(interval.inside for interval in intervals) <= 1e-6 * size


# ---- the spline and u_h


def test_pieces_that_are_computed_together_have_the_bounds_that_they_have_one_by_one(monkeypatch) -> None:
    case, found = named("yield-and-release"), []
    for most in (1, 4):
        monkeypatch.setattr(terms, "LEAST", 1)
        monkeypatch.setattr(terms, "MOST", most)
        discretisation = Discretisation(Data.of(case.solution), Shaken()(case.solution.body, 2))
        found.append(enclose(discretisation, compute(discretisation, MIDPOINT, 5), SmoothedInTime()))
    one_by_one, together = found
    assert together.bound == pytest.approx(one_by_one.bound, rel=1e-9)
    assert together.between == pytest.approx(one_by_one.between, rel=1e-9)


# ---- rows and refusals


def test_what_cannot_be_bounded_is_refused() -> None:
    with pytest.raises(BoundError, match="initial gap, and the bound serves CONTACT sides"):
        check_problem(Data.of(named("closing-gap").solution), None, Refined(0, 1))
    with pytest.raises(BoundError, match=r"rough-1.75: .* f_0 ∉ L²"):
        measure(resolve_problem("rough-1.75"), OneDiagonal(), 4, MIDPOINT, 4, SmoothedInTime())
    with pytest.raises(BoundError, match="runs through cells of the mesh; list it as an interface"):
        Discretisation(Data.of(named("layered-unmet").solution), OneDiagonal()(unit_square(), 4))
    discretisation = Discretisation(Data.of(named("no-contact").solution), OneDiagonal()(unit_square(), 2))
    nodes = [(time, (1 + time) * np.ones(discretisation.displacements.dofs)) for time in (0.0, 0.25, 0.5)]
    nodes.append((1.0, 3 * nodes[-1][1]))
    with pytest.raises(BoundError, match="equally spaced in time"):
        list(Majorant(discretisation)(spline(nodes), 1.0))
