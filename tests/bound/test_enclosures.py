"""The bound and the enclosure: no error lies outside, whatever the case, the mesh, the scheme and the time.

That is a theorem, so one error outside refutes the implementation; and a wrong implementation has to put one outside.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise, product

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st
from loads import loads, stress
from on_meshes import data_of, discretised_on
from random_examples import RANDOM
from test_terms import quadratic

from manufactured import KelvinVoigt, Linear, named, t, unit_square, x2
from manufactured.cases.shared import not_proportional
from manufactured.catalogue import NAMES
from manufactured.data import Data
from study.bound import terms
from study.bound.bounded import check_problem, levels
from study.bound.discretisation import Discretisation
from study.bound.enclosing import enclose, known_error
from study.bound.problem import BoundError
from study.bound.terms import Majorant
from study.bound.trajectory import Parabola, Refined, SmoothedInTime, compute, spline
from study.fem.mesh import FAMILIES, Graded, OneDiagonal, Shaken, Unstructured
from study.fem.quadrature import Line, cell_rules
from study.fem.space import Space
from study.present.outcome import _intervals
from study.solve.tableau import MIDPOINT, SCHEMES
from study.statements.enclosure import eligible, measure, resolve_problem

GAPS = ("closing-gap", "parabolic-gap")
UNSERVED = ("moving-rough", "layered-unmet", "rough-1.75", *GAPS)
"""Cases to which the bound does not apply."""
BOUNDED = [name for name in NAMES if name not in UNSERVED and not name.startswith("cube")]
ROUNDING = 1e-9
"""Relative; errors in round-off are compared with bounds in round-off."""
TRAJECTORIES = [SmoothedInTime(), Refined(0, 2)]


# ---- the error, measured by another quadrature


def distance(discretisation, solution):
    """(t, v) ↦ ‖u(t) − v‖_V for v of degree 2."""
    lines = [Line(*line) for line in discretisation.data.lines]
    rules = cell_rules(discretisation.mesh, 8, lines, discretisation.data.points)
    fields = [(rule, solution.at(rule.points)) for rule in rules]
    V = discretisation.displacements

    def measured(time, v):
        parts = [(rule, exact.strain(time) - V.strain_at(v, rule.cells, rule.points)) for rule, exact in fields]
        return math.sqrt(sum(np.vdot(solution.law.A.at(rule.points)(off), off * rule.weights) for rule, off in parts))

    return measured


def closest(case, mesh, scheme, steps, trajectory):
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
    u_h = computed.on(fine)
    true = distance(fine, case.solution)
    rng = np.random.default_rng(0)
    for piece, interval in zip(spline(trajectory.nodes(fine, computed)), found.intervals, strict=True):
        assert piece.a == interval.a
        assert piece.b == interval.b
        assert interval.inside >= max(interval.at_a, interval.at_b) * (1 - 1e-12)
        for share, bound in ((rng.random(), interval.inside), (1.0, interval.at_b)):
            time = piece.a + share * (piece.b - piece.a)
            v = piece.at(time)
            u = computed.at(time)
            assert (fine.displacements.N @ v).max(initial=0.0) <= 1e-10
            assert true(time, v) <= bound + slack
            assert error(time, u) <= min(bound + fine.norm(v - u_h(time)), found.highest) + slack
    return float((found.lower / np.maximum(found.error, np.finfo(float).tiny)).max())


# ---- the main property


def turn(number):
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
def test_no_error_lies_outside(number, level, trajectory):
    case, family, scheme = turn(number)
    closest(case, family(case.solution.body, level), scheme, math.ceil(level * case.solution.body.T), trajectory)


def test_all_cases_families_and_schemes_have_their_turn():
    assert [name for name in NAMES if eligible(named(name)) and name not in GAPS] == BOUNDED
    _, families, schemes = zip(*map(turn, range(len(BOUNDED))), strict=True)
    assert set(families) == set(FAMILIES)
    assert set(schemes) == set(SCHEMES)


def test_a_refined_mesh_encloses_the_error_more_tightly():
    case = named("advance-recede")
    mesh = OneDiagonal()(case.solution.body, 3)
    plain, finer = (closest(case, mesh, MIDPOINT, 2, Refined(r, 2)) for r in (0, 1))
    assert plain < finer < 1


# ---- problems whose solution the spaces contain


ORTHOTROPIC = KelvinVoigt(
    Linear([[4.0, 0.5, 0.0], [0.5, 2.0, 0.0], [0.0, 0.0, 1.5]]),
    Linear([[3.0, 1.0, 0.0], [1.0, 6.0, 0.0], [0.0, 0.0, 2.0]]),
    "orthotropic",
)


@pytest.mark.parametrize("law", [not_proportional(), ORTHOTROPIC])
@pytest.mark.parametrize("coefficients", [(0, -1, 1), (1, 0, -1)], ids=["full contact", "no contact"])
def test_the_bound_vanishes_for_a_solution_of_degree_2_in_space_and_time(coefficients, law):
    """u = g(t) (0, w(x2)) with w(1) = 0, by the polar forms of g and of w, which has the coefficients of 1, x2, x2²."""
    constant, slope, curvature = coefficients

    def g(a, b):
        return 1 + (a + b) / 2 + 1.5 * a * b

    def w(y, z):
        return constant + slope * (y + z) / 2 + curvature * y * z

    u = g(t, t) * sp.Matrix([0, w(x2, x2)])
    body = unit_square()
    sigma = stress(law.A, u.diff(t)) + stress(law.G, u)
    data = Data.formulas(body, law, *loads(sigma, body), tuple(u.subs(t, 0)))
    data.check()
    discretisation = discretised_on(data, 3, Unstructured())
    v = quadratic(discretisation, w, 1, variable=1)
    knots = pairwise([0.0, 0.1, 0.15, 0.5, 1.0])
    pieces = [Parabola(a, b, g(a, a) * v, g(a, b) * v, g(b, b) * v) for a, b in knots]
    intervals = [interval for _, interval in Majorant(discretisation)(pieces, 0.0)]
    size = discretisation.norm(pieces[-1].end)
    assert size > 1
    # Rounding of the products in c, some 1e-14 of ‖u‖², comes under a square root.
    assert intervals[-1].at_b <= 1e-6 * size
    assert max(interval.inside for interval in intervals) <= 1e-6 * size


# ---- the spline and u_h


@given(st.lists(st.floats(0.1, 2), min_size=1, max_size=6), RANDOM)
def test_a_spline_is_continuous_with_its_velocity_and_starts_and_ends_in_its_nodes(lengths, rng):
    times = np.concatenate([[0.0], np.cumsum(lengths)])
    values = rng.normal(size=(len(times), 4))
    pieces = list(spline(zip(times, values, strict=True)))
    knots, points = (np.array([a[0], *(a[:-1] + a[1:]) / 2, a[-1]]) for a in (times, values))
    assert np.array_equal([(piece.a, piece.b) for piece in pieces], list(pairwise(knots)))
    assert np.allclose([(piece.start, piece.end) for piece in pieces], list(pairwise(points)))
    # With equal steps the velocity at inner knots is the difference quotient.
    for change, (left, right) in zip(np.diff(values, axis=0), pairwise(spline(enumerate(values))), strict=True):
        assert np.allclose([left.rate(end=True), right.rate(end=False)], change)


def test_displacements_computed_for_the_bound_are_admissible_and_linear_between_their_nodes():
    discretisation = discretised_on(data_of("travelling-patch"), 3, Shaken())
    for scheme in SCHEMES:
        computed = compute(discretisation, scheme, 4)
        N = Space(computed.mesh, computed.body).N
        assert (N @ computed.nodes[:, computed.space.free].T).max() <= 1e-12
        assert np.allclose(computed.at(0.3), 0.8 * computed.nodes[1] + 0.2 * computed.nodes[2])


def test_pieces_that_are_computed_together_have_the_bounds_that_they_have_one_by_one(monkeypatch):
    data = data_of("yield-and-release")
    found = []
    for most in (1, 4):
        monkeypatch.setattr(terms, "LEAST_INTERVALS", 1)
        monkeypatch.setattr(terms, "MOST_INTERVALS", most)
        discretisation = discretised_on(data, 2, Shaken())
        found.append(enclose(discretisation, compute(discretisation, MIDPOINT, 5), SmoothedInTime()))
    one_by_one, together = found
    assert together.bound == pytest.approx(one_by_one.bound, rel=1e-9)
    assert together.between == pytest.approx(one_by_one.between, rel=1e-9)


# ---- rows and refusals


def test_a_row_says_how_close_the_ends_came():
    row, found = measure(resolve_problem("advance-recede"), Shaken(), 3, MIDPOINT, 3, Refined(0, 2))
    late = (found.upper / found.error)[found.times >= 0.5]
    shares = {"above": found.error / found.upper, "below": found.lower / found.error, "upper": late}
    assert {name: row[name] for name in shares} == pytest.approx({name: share.max() for name, share in shares.items()})
    assert row["lowest"] <= found.error.max() == row["error"] <= row["highest"]
    others = found.error, 1.001 * found.upper, 0.999 * found.lower
    assert [replace(found, error=error).contains for error in others] == [True, False, False]
    parts = row["residual"] + row["oscillation"] + row["bending"]
    assert found.bound.max() - found.intervals[0].at_a - math.sqrt(2 * row["contact"]) <= parts > 0


def test_what_cannot_be_bounded_is_refused():
    with pytest.raises(BoundError, match="initial gap, and the bound serves CONTACT sides"):
        check_problem(data_of("closing-gap"), None, Refined(0, 1))
    with pytest.raises(BoundError, match=r"rough-1.75: .* f_0 ∉ L²"):
        measure(resolve_problem("rough-1.75"), OneDiagonal(), 4, MIDPOINT, 4, SmoothedInTime())
    with pytest.raises(BoundError, match="runs through cells of the mesh; list it as an interface"):
        discretised_on(data_of("layered-unmet"), 4)
    discretisation = discretised_on(data_of("no-contact"), 2)
    nodes = [(time, (1 + time) * np.ones(discretisation.displacements.dofs)) for time in (0.0, 0.25, 0.5)]
    nodes.append((1.0, 3 * nodes[-1][1]))
    with pytest.raises(BoundError, match="equally spaced in time"):
        list(Majorant(discretisation)(spline(nodes), 1.0))


ERRORS = {1: 1.0, 2: 0.5, 4: 0.125}
"""Level ↦ error."""


def test_orders_are_enclosed_since_the_first_level_and_since_the_previous_one():
    """E = (1, 1/2, 1/8) at h = (1, 1/2, 1/4), up to 1 ± 1/10: the order is 3/2 over all levels, 2 on the last pair."""
    rest = {"dofs": 1, "error": math.nan, "plain": 1.0, "percent_low": 1.0, "percent_high": 2.0, "kind": "guaranteed"}
    levels_of = [{"level": n, "h": 1 / n, "steps": n, "lowest": e / 1.1, "highest": 1.1 * e} for n, e in ERRORS.items()]
    table = levels([rest | each for each in levels_of]).set_index("level")
    for name, order, halvings in (("order", 1.5, 2), ("pair", 2, 1)):
        off = 2 * math.log2(1.1) / halvings
        assert table.loc[4, [f"{name}_low", f"{name}_high"]].tolist() == pytest.approx([order - off, order + off])
    assert table.loc[1, ["order_low", "pair_low"]].isna().all()
    lines = _intervals(table.reset_index(), known=False)
    assert [line.count("[") for line in lines] == [0, 2, 2, 2, 0, 0, 2, 2, 0, 0]
    assert max(map(len, lines)) <= 80
    assert lines[-1].endswith("with steps that follow the mesh")
    assert _intervals(table.reset_index().head(2).assign(steps=4), known=False)[-1].endswith("same steps on every mesh")
