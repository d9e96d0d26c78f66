"""The guaranteed bound and the enclosure: no error outside, whatever the case, the mesh, the scheme and the time.

That is a theorem, so one error outside refutes the implementation; and a wrong implementation has to put one outside.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
import pytest
import scipy.sparse as sps
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse.linalg import splu
from sympy import Expr, Integer, Rational, binomial

from manufactured import (
    Case,
    ContactFace,
    ExactSolution,
    FrobeniusBall,
    KelvinVoigt,
    Kind,
    Linear,
    Prescribed,
    Regularity,
    Yield,
    catalogue,
    isotropic,
    pos,
    prove,
    s,
    t,
    unit_square,
    x2,
)
from manufactured.cases.laws import not_proportional
from manufactured.data import Data
from manufactured.tensors import Array, Points, Tensors
from study.bound.bounded import _intervals, levels
from study.bound.discretisation import Discretisation
from study.bound.enclosing import Enclosure, enclose, known_error, order
from study.bound.equilibration import Equilibration
from study.bound.majorant import Interval, Majorant
from study.bound.problem import BoundError
from study.bound.sampling import Evidence
from study.bound.trajectory import (
    DiscreteSolution,
    Parabola,
    Refined,
    SmoothedInTime,
    Trajectory,
    compute,
    prolongation,
    quadratic_problem,
    spline,
)
from study.fem.mesh import FAMILIES, CrissCross, Graded, MeshFamily, OneDiagonal, Shaken, Unstructured
from study.fem.quadrature import Line, cell_rules
from study.fem.space import Space
from study.solve.evolution import Scheme
from study.solve.tableau import BACKWARD_EULER, MIDPOINT, SCHEMES
from study.statements.enclosure.bound_rows import measure, posed
from study.statements.enclosure.courses import eligible
from study.stresses.bernstein import bernstein
from study.stresses.composite import SIDES, thirds

CASES = {case.name: case for case in catalogue()}
BOUNDED = [case for case in catalogue() if eligible(case)]
ROUNDING = 1e-9
"""Relative; errors in round-off are compared with bounds in round-off."""


# ---- measured independently


@dataclass(frozen=True)
class Distance:
    """‖u(t) − v‖_V for v of degree 2, by quadrature of its own."""

    discretisation: Discretisation
    solution: ExactSolution

    def __call__(self, time: float, v: Array) -> float:
        V, total = self.discretisation.displacements, 0.0
        for rule, exact in self.fields:
            difference = exact.strain(time) - V.strain_at(v, rule.cells, rule.points)
            stress = self.solution.law.A.at(rule.points)(difference)
            total += float(np.einsum("Inq,Inq,nq->", stress, difference, rule.weights))
        return math.sqrt(total)

    @property
    def fields(self):
        return _fields(self.discretisation, self.solution)


@lru_cache(maxsize=1)
def _fields(discretisation: Discretisation, solution: ExactSolution):
    lines = [Line(*line) for line in discretisation.data.lines]
    rules = cell_rules(discretisation.mesh, 8, lines, discretisation.data.points)
    return [(rule, solution.at(rule.points)) for rule in rules]


def retraced(
    coarse: Discretisation, computed: DiscreteSolution, trajectory: Trajectory
) -> tuple[Discretisation, list[Parabola]]:
    """The discretisation and the pieces of ũ once more."""
    fine = trajectory.discretisation(coarse)
    return fine, list(spline(trajectory.nodes(fine, computed)))


def closest(case: Case, mesh, scheme: Scheme, steps: int, trajectory: Trajectory, seed: int = 0) -> tuple[float, ...]:
    """Assert that no error lies outside, at the knots and at a random time of every piece.

    Returns the largest error/upper, lower/error and ‖u − ũ‖/y.
    """
    coarse = Discretisation(Data.of(case.solution), mesh)
    computed = compute(coarse, scheme, steps)
    error = known_error(case, computed)
    assert error is not None
    found = enclose(coarse, computed, trajectory, error)
    slack = ROUNDING * max(found.error.max(), found.upper.max())
    assert (found.lower <= found.error + slack).all()
    assert (found.error <= found.upper + slack).all()
    assert found.lowest - slack <= found.error.max() <= found.highest + slack

    fine, pieces = retraced(coarse, computed, trajectory)
    J, true, rng = prolongation(computed.space, fine), Distance(fine, case.solution), np.random.default_rng(seed)
    nearest = 0.0
    for piece, interval in zip(pieces, found.intervals, strict=True):
        assert (piece.a, piece.b) == (interval.a, interval.b)
        for share, bound in ((rng.random(), interval.inside), (1.0, interval.at_b)):
            time = piece.a + share * (piece.b - piece.a)
            v, u = piece.at(time), computed.at(time)
            assert (fine.displacements.N @ v).max(initial=0.0) <= 1e-10
            off = true(time, v)
            assert off <= bound + slack
            assert error(time, u) <= min(bound + fine.norm(v - J @ u), found.highest) + slack
            nearest = max(nearest, off / bound if bound > slack else 0.0)
    tiny = np.finfo(float).tiny
    return (
        float((found.error / np.maximum(found.upper, tiny)).max()),
        float((found.lower / np.maximum(found.error, tiny)).max()),
        nearest,
    )


# ---- the main property


def turns() -> Iterator[tuple[Case, MeshFamily, Scheme]]:
    """Every case with the families that mesh it and the schemes in turn; graded meshes where corners need them."""
    for number, case in enumerate(BOUNDED):
        serving = [family for family in FAMILIES if family.serves(case.solution.body)]
        graded = [family for family in serving if isinstance(family, Graded)]
        yield case, (graded or serving)[number % len(graded or serving)], SCHEMES[number % len(SCHEMES)]


TURNS = list(turns())
TRAJECTORIES = [SmoothedInTime(), Refined(0, 2)]
names = [f"{case.name}, {family.name}, {scheme.name}" for case, family, scheme in TURNS]


def steps_of(case: Case, level: int) -> int:
    return math.ceil(level * case.solution.body.T)


@pytest.mark.parametrize("trajectory", [SmoothedInTime(), Refined(1, 2)], ids=["u_h alone", "enclosure"])
def test_between_knots_the_distance_of_both_trajectories_is_bounded_within_three_times(trajectory: Trajectory) -> None:
    """The middle coefficient of a parabola p is 2 p(1/2) − (p(0) + p(1))/2, at most three times its largest value."""
    data = Data.of(CASES["advance-recede"].solution)
    coarse = Discretisation(data, OneDiagonal()(data.body, 3))
    computed = compute(coarse, MIDPOINT, 3)
    found, (fine, pieces) = enclose(coarse, computed, trajectory), retraced(coarse, computed, trajectory)
    J = prolongation(computed.space, fine)
    for piece, interval, between in zip(pieces, found.intervals, found.between, strict=True):
        times = np.linspace(piece.a, piece.b, 21)
        largest = max(fine.norm(piece.at(time) - J @ computed.at(time)) for time in times)
        assert largest - ROUNDING * found.highest <= between - interval.inside <= 3 * largest + ROUNDING * found.highest


@pytest.mark.parametrize(("case", "family", "scheme"), TURNS[::3], ids=names[::3])
@pytest.mark.parametrize("trajectory", TRAJECTORIES, ids=lambda trajectory: trajectory.name)
def test_no_error_lies_outside(case: Case, family: MeshFamily, scheme: Scheme, trajectory: Trajectory) -> None:
    closest(case, family(case.solution.body, 4), scheme, steps_of(case, 4), trajectory)


@pytest.mark.slow
@pytest.mark.parametrize("level", [4, 8])
@pytest.mark.parametrize(("case", "family", "scheme"), TURNS, ids=names)
@pytest.mark.parametrize("trajectory", TRAJECTORIES, ids=lambda trajectory: trajectory.name)
def test_no_error_lies_outside_for_any_case(case, family, scheme, trajectory, level: int) -> None:
    closest(case, family(case.solution.body, level), scheme, steps_of(case, level), trajectory)


def test_all_families_and_schemes_have_their_turn() -> None:
    assert {family for _, family, _ in TURNS} == set(FAMILIES)
    assert {scheme for _, _, scheme in TURNS[::3]} | {scheme for _, _, scheme in TURNS} == set(SCHEMES)
    assert len(TURNS) >= 20


def twentieths(low: int, high: int) -> st.SearchStrategy[Rational]:
    return st.integers(low, high).map(lambda number: Rational(number, 20))


def polynomial(coefficients: list[Expr]) -> Expr:
    """Σ c_i B_i(t): between the least and the largest c_i on [0, 1]."""
    n = len(coefficients) - 1
    return sum((c * binomial(n, i) * t**i * (1 - t) ** (n - i) for i, c in enumerate(coefficients)), Integer(0))


@st.composite
def tensors(draw) -> Linear:
    """Isotropic, or any symmetric positive definite one."""
    if draw(st.booleans()):
        mu, lam = draw(twentieths(5, 60)), draw(twentieths(-4, 80))
        return isotropic(float(mu), float(lam))
    B = np.array([float(draw(twentieths(-20, 20))) for _ in range(9)]).reshape(3, 3)
    C = B @ B.T + 0.3 * np.eye(3)
    return Linear((C + C.T) / 2)


@st.composite
def cases(draw) -> Case:
    """A front anywhere that moves or stays, full contact of a linear or yielding body, or none."""
    body = unit_square()
    (part,) = body.of(Kind.CONTACT)
    zone = draw(st.sampled_from(["moves", "moves", "moves", "stays", "full", "none", "yields"]))
    regularity, rough = Regularity(), ()
    amplitudes = st.lists(twentieths(1, 40), min_size=1, max_size=3).map(polynomial)
    # Never constant in time: of a solution that rests the self-proof compares rounding with rounding.
    strength, opening = 20 * (1 + t) * draw(amplitudes), 5 * (1 + t) * draw(amplitudes)
    bump = 1 + 4 * s * (1 - s)
    if zone == "yields":
        G = Yield(float(draw(twentieths(5, 80))), FrobeniusBall(float(draw(twentieths(1, 20)))))
        law = KelvinVoigt(isotropic(1, 0.5), G, "random (3.3)")
        strain = Prescribed(((body.T, -draw(twentieths(1, 40)) * t * bump),))
        face = ContactFace(part, Integer(0), strain, Integer(1))
    else:
        law = KelvinVoigt(draw(tensors()), draw(tensors()), "random")
        if zone == "full":
            gap, pressure, level = Integer(0), t * strength * bump, Integer(1)
        elif zone == "none":
            gap, pressure, level = opening * (1 + s), Integer(0), Integer(-1)
        else:
            count = 1 if zone == "stays" else draw(st.integers(2, 3))
            front = polynomial([draw(twentieths(3, 17)) for _ in range(count)])
            alpha, m = draw(st.integers(4, 5)), draw(st.integers(2, 3))
            level = draw(st.sampled_from([1, -1])) * (front - s)
            moving = sp.expand(front).has(t)
            level, rough = sp.expand(level), () if moving else (float(sp.expand(front)),)
            gap, pressure = opening * pos(-level, alpha), strength * pos(level, m)
            regularity = Regularity(gap=alpha, pressure=m, moving=moving)
        face = ContactFace.linear(part, law, body.T, gap, pressure, level, rough=rough)
    solution = ExactSolution(body, law, (face,))
    return Case("random", zone, solution, regularity, regularity.order, "exponents")


seeds = st.integers(0, 999)
families = st.one_of(
    st.just(OneDiagonal()),
    st.just(CrissCross()),
    seeds.map(lambda seed: Shaken(seed=seed)),
    seeds.map(lambda seed: Unstructured(seed=seed)),
)
trajectories = st.one_of(st.just(SmoothedInTime()), st.integers(1, 3).map(lambda shorter: Refined(0, shorter)))
random_examples = given(
    cases(), families, st.integers(3, 6), st.sampled_from(SCHEMES), st.integers(2, 6), trajectories, seeds
)


@settings(max_examples=8)
@random_examples
def test_no_error_lies_outside_for_random_cases(case, family, n, scheme, steps, trajectory, seed) -> None:
    prove(case.solution, case.name)
    closest(case, family(case.solution.body, n), scheme, steps, trajectory, seed)


@pytest.mark.slow
@settings(max_examples=30)
@random_examples
def test_no_error_lies_outside_for_many_random_cases(case, family, n, scheme, steps, trajectory, seed) -> None:
    prove(case.solution, case.name)
    closest(case, family(case.solution.body, n), scheme, steps, trajectory, seed)


def test_a_refined_mesh_encloses_the_error_more_tightly() -> None:
    case = CASES["fixed-front-off-vertex"]
    mesh = Unstructured()(case.solution.body, 4)
    plain, finer = (closest(case, mesh, MIDPOINT, 4, Refined(r, 2)) for r in (0, 1))
    assert plain[1] < finer[1] < 1


@dataclass(frozen=True)
class Anything:
    """Random functions of the cone, far from any solution."""

    seed: int
    name: str = "anything"

    def discretisation(self, coarse: Discretisation) -> Discretisation:
        return coarse

    def nodes(self, discretisation: Discretisation, computed: DiscreteSolution) -> Iterator[tuple[float, Array]]:
        rng, V = np.random.default_rng(self.seed), discretisation.displacements
        for time in np.linspace(0, computed.T, computed.steps + 1):
            v = rng.normal(size=V.dofs) * 0.1
            normal = V.N @ v
            yield float(time), v - V.N.T @ np.maximum(normal, 0)


@given(st.sampled_from(["advance-recede", "full-contact", "no-contact", "yield-on-a-part", "anisotropic"]), seeds)
@settings(max_examples=10)
def test_no_error_lies_outside_even_for_a_trajectory_that_has_nothing_to_do_with_the_solution(name, seed) -> None:
    case = CASES[name]
    closest(case, Shaken(seed=seed)(case.solution.body, 3), BACKWARD_EULER, 3, Anything(seed), seed)


# ---- defects that have to put an error outside


def outside(
    discretisation: Discretisation, case: Case, trajectory: Trajectory, computed: DiscreteSolution | None = None
) -> float:
    """The largest ‖u − ũ‖/y at the knots, which a correct bound leaves at 1 or below."""
    computed = computed or compute(discretisation, MIDPOINT, 6)
    found = enclose(discretisation, computed, trajectory, known_error(case, computed))
    fine, pieces = retraced(discretisation, computed, trajectory)
    true = Distance(fine, case.solution)
    errors = np.array([true(piece.b, piece.end) for piece in pieces])
    return float((errors / np.maximum(found.bound, 1e-300)).max())


def square_discretisation(case: Case, n: int = 6, **changes) -> Discretisation:
    data = replace(Data.of(case.solution), formulas_of=None, **changes)
    return Discretisation(data, OneDiagonal()(case.solution.body, n))


@pytest.mark.parametrize("trajectory", TRAJECTORIES, ids=lambda trajectory: trajectory.name)
@pytest.mark.parametrize("name", ["no-contact", "fixed-front-on-vertex", "advance-recede"])
def test_stresses_that_do_not_balance_f_2_are_caught(name: str, trajectory: Trajectory) -> None:
    """The load is left out of u_h and of the bound alike, so that they agree with each other."""
    case = CASES[name]
    without = square_discretisation(case, surface_load=lambda part, x: lambda time: np.zeros_like(x))
    assert outside(square_discretisation(case), case, trajectory) <= 1
    assert outside(without, case, trajectory) > 1.2


class WithoutResidual(Equilibration):
    def products(self, parts: Sequence[Array]) -> Array:
        return 0 * super().products(parts)


@pytest.mark.parametrize("name", ["full-contact", "advance-recede", "travelling-patch", "anisotropic"])
def test_a_bound_without_the_residual_is_caught(name: str, monkeypatch) -> None:
    case = CASES[name]
    discretisation = Discretisation(Data.of(case.solution), Unstructured()(case.solution.body, 4))
    assert outside(discretisation, case, SmoothedInTime()) <= 1
    monkeypatch.setattr("study.bound.majorant.Equilibration", WithoutResidual)
    assert outside(discretisation, case, SmoothedInTime()) > 1.2


@pytest.mark.parametrize("name", ["no-contact", "fixed-front-on-vertex", "load-w11"])
def test_twice_the_constant_of_monotonicity_is_caught(name: str) -> None:
    case = CASES[name]
    discretisation = square_discretisation(case)
    computed = compute(discretisation, MIDPOINT, 6)
    assert outside(discretisation, case, SmoothedInTime(), computed) <= 1
    discretisation.__dict__["moduli"] = replace(discretisation.moduli, values=2 * discretisation.moduli.values)
    assert outside(discretisation, case, SmoothedInTime(), computed) > 1.01


class Glued:
    """The contact solve of a body glued to the foundation: u_ν = 0, whichever way it pulls."""

    def __init__(self, S: sps.csc_array, N: sps.csr_array) -> None:
        self.rows = N.shape[0]
        self.solve = splu(sps.block_array([[S, N.T], [N, None]], format="csc"))

    def __call__(self, b: Array) -> tuple[Array, Array]:
        n = b.shape[-1]
        found = self.solve.solve(np.concatenate([b.T, np.zeros((self.rows, *b.shape[:-1]))])).T
        return found[..., :n], found[..., n:]


@dataclass(frozen=True)
class GluedTrajectory(Refined):
    def nodes(self, discretisation: Discretisation, computed: DiscreteSolution) -> Iterator[tuple[float, Array]]:
        problem = quadratic_problem(discretisation, np.zeros(discretisation.displacements.dofs))
        for state in MIDPOINT.march(replace(problem, solver=Glued), self.shorter * computed.steps):
            # Rounding must not leave the cone.
            yield state.time, state.u - discretisation.displacements.N.T @ (discretisation.displacements.N @ state.u)


def test_stresses_that_pull_at_the_foundation_are_caught() -> None:
    """A glued body is in K and its stress balances the load, but it pulls where the body would have left."""
    case = CASES["no-contact"]
    discretisation = square_discretisation(case)
    computed = compute(discretisation, MIDPOINT, 6)
    assert outside(discretisation, case, GluedTrajectory(0, 1), computed) <= 1
    # Moments m_ν = 0 in place of m_ν ≤ 0 are the multipliers of stresses with any σ_ν.
    pulling = Glued(discretisation.equilibrium.S, discretisation.equilibrium.N)
    pulling.factor = discretisation.equilibrium.solve.factor
    discretisation.equilibrium.solve = pulling
    assert outside(discretisation, case, GluedTrajectory(0, 1), computed) > 1.2


class WithoutContact(Discretisation):
    """A discretisation in which c is forgotten."""

    def normal_moments(self, v: Array) -> Array:
        return 0 * super().normal_moments(v)


def test_a_bound_without_the_contact_term_is_caught() -> None:
    """No load, u = 0; ũ = (0, t (1 − x2)) is held away from the foundation by a pressure: ρ = 0, c > 0."""
    law = KelvinVoigt(isotropic(1, 0), isotropic(1, 0), "without contraction")
    data = Data.formulas(unit_square(), law, f0=(0, 0))
    mesh = Unstructured()(data.body, 3)
    for kind, holds in ((Discretisation, True), (WithoutContact, False)):
        discretisation = kind(data, mesh)
        v = coefficients(discretisation, lambda x: np.array([0 * x[0], 1 - x[1]]), lambda x, y: 1 - (x[1] + y[1]) / 2)
        pieces = [Parabola(a, b, a * v, (a + b) / 2 * v, b * v) for a, b in pairwise(np.linspace(0, 1, 5))]
        found = [interval.at_b for _, interval in Majorant(discretisation)(pieces, 0.0)]
        errors = [discretisation.norm(piece.end) for piece in pieces]
        assert all(error <= bound for error, bound in zip(errors, found, strict=True)) == holds
        if not holds:
            assert max(found) < 1e-6 < min(errors)


# ---- problems whose solution the spaces contain


def coefficients(
    discretisation: Discretisation, value: Callable[[Points], Array], polar: Callable[[Array, Array], Array]
) -> Array:
    """(0, w) of degree 2 from its values at vertices and its polar form at the ends of edges."""
    mesh, V = discretisation.mesh, discretisation.displacements
    middle = polar(mesh.p[:, mesh.facets[0]], mesh.p[:, mesh.facets[1]])
    at_vertices = value(mesh.p)
    full = np.hstack([at_vertices, np.array([0 * middle, middle])])
    return full.T.ravel()[V.free]


@dataclass(frozen=True)
class Patch:
    """u = g(t) (0, w(x2)) with w of degree 2, w(1) = 0, in full contact or in none.

    Attributes:
        w: coefficients of 1, x2, x2².
    """

    name: str
    w: tuple[float, float, float]

    def value(self, x: Points) -> Array:
        return np.array([0 * x[0], self.w[0] + self.w[1] * x[1] + self.w[2] * x[1] ** 2])

    def polar(self, x: Points, y: Points) -> Array:
        return self.w[0] + self.w[1] * (x[1] + y[1]) / 2 + self.w[2] * x[1] * y[1]

    def data(self, g: Expr, law: KelvinVoigt) -> Data:
        """f_0, f_2 and u_0 from the law by hand: ε = ε_22 = g w'."""
        slope = self.w[1] + 2 * self.w[2] * x2
        A, G = law.A.matrix, law.G.matrix
        across, along = ((sp.diff(g, t) * A[1, i] + g * G[1, i]) * slope for i in (0, 1))
        displacement = (self.w[0] + self.w[1] * x2 + self.w[2] * x2**2) * g.subs(t, 0)
        force = (0, -sp.diff(along, x2))
        return Data.formulas(unit_square(), law, force, {1: (across, 0), 3: (-across, 0)}, (0, displacement))


PATCHES = [Patch("full contact", (0.0, -1.0, 1.0)), Patch("no contact", (1.0, 0.0, -1.0))]
ORTHOTROPIC = KelvinVoigt(
    Linear(np.array([[4.0, 0.5, 0.0], [0.5, 2.0, 0.0], [0.0, 0.0, 1.5]])),
    Linear(np.array([[3.0, 1.0, 0.0], [1.0, 6.0, 0.0], [0.0, 0.0, 2.0]])),
    "orthotropic",
)


@pytest.mark.parametrize("law", [not_proportional(), ORTHOTROPIC], ids=lambda law: law.name)
@pytest.mark.parametrize("patch", PATCHES, ids=lambda patch: patch.name)
def test_the_bound_vanishes_for_a_solution_of_degree_2_in_space_and_time(patch: Patch, law: KelvinVoigt) -> None:
    g = 1 + t + 3 * t**2 / 2
    data = patch.data(g, law)
    data.check()
    discretisation = Discretisation(data, Unstructured()(data.body, 3))
    v = coefficients(discretisation, patch.value, patch.polar)
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


@pytest.mark.parametrize("family", [OneDiagonal(), Unstructured()], ids=lambda family: family.name)
@pytest.mark.parametrize("patch", PATCHES, ids=lambda patch: patch.name)
def test_the_enclosure_is_the_error_itself_for_a_solution_of_degree_2_that_grows_linearly(patch, family) -> None:
    """From the data alone: Problem 5.1 in degree 2 finds the solution, and nothing is left to bound."""
    data = patch.data(1 + 2 * t, not_proportional())
    discretisation = Discretisation(data, family(data.body, 4))
    computed = compute(discretisation, BACKWARD_EULER, 3)
    found = enclose(discretisation, computed, Refined(0, 2))
    v, J = coefficients(discretisation, patch.value, patch.polar), prolongation(computed.space, discretisation)
    errors = [discretisation.norm((1 + 2 * time) * v - J @ computed.at(time)) for time in found.times]
    # The root of what rounding leaves of c.
    assert (found.upper - found.lower).max() <= 1e-5 * found.upper.max()
    assert found.upper == pytest.approx(errors, rel=1e-5)
    assert min(errors) > 0.01


# ---- the spline


@st.composite
def marches(draw) -> list[tuple[float, Array]]:
    lengths = draw(st.lists(st.floats(0.1, 2), min_size=1, max_size=6))
    times = np.concatenate([[0.0], np.cumsum(lengths)])
    rng = np.random.default_rng(draw(seeds))
    return [(float(time), rng.normal(size=4)) for time in times]


@given(marches(), st.lists(st.floats(0, 1), min_size=1, max_size=5))
def test_a_spline_is_continuous_with_its_velocity_and_starts_and_ends_in_its_nodes(nodes, shares) -> None:
    pieces = list(spline(nodes))
    assert len(pieces) == len(nodes)
    assert np.array_equal(pieces[0].at(nodes[0][0]), nodes[0][1])
    assert np.array_equal(pieces[-1].at(nodes[-1][0]), nodes[-1][1])
    assert (pieces[0].a, pieces[-1].b) == (nodes[0][0], nodes[-1][0])
    for (time, here), (later, there), piece in zip(nodes, nodes[1:], pieces, strict=False):
        assert piece.b == (time + later) / 2
        assert np.allclose(piece.end, (here + there) / 2)
    for left, right in pairwise(pieces):
        assert left.b == right.a
        assert np.array_equal(left.end, right.start)
    for piece in pieces:
        k = piece.b - piece.a
        assert np.allclose(piece.at(piece.a), piece.start)
        assert np.allclose(piece.at(piece.b), piece.end)
        for share in shares:
            time, step = piece.a + share * k, 1e-6 * k
            difference = (piece.at(time + step) - piece.at(time - step)) / (2 * step)
            rate = (1 - share) * piece.rate(end=False) + share * piece.rate(end=True)
            assert np.allclose(difference, rate, atol=1e-6 * (1 + abs(rate).max()))


@given(st.integers(2, 7), seeds)
def test_equal_steps_give_continuous_velocities_that_are_those_of_the_steps_at_their_middles(steps, seed) -> None:
    rng, k = np.random.default_rng(seed), 0.3
    nodes = [(k * j, rng.normal(size=3)) for j in range(steps + 1)]
    pieces = list(spline(nodes))
    for j, (left, right) in enumerate(pairwise(pieces)):
        expected = (nodes[j + 1][1] - nodes[j][1]) / k
        assert np.allclose(left.rate(end=True), expected)
        assert np.allclose(right.rate(end=False), expected)


@given(marches(), st.floats(0, 1))
def test_every_point_of_a_spline_is_a_convex_combination_of_nodes(nodes, share) -> None:
    """So the trajectory stays in every convex set that has the nodes, here in half-spaces."""
    rng = np.random.default_rng(0)
    for piece in spline(nodes):
        point = piece.at(piece.a + share * (piece.b - piece.a))
        for direction in rng.normal(size=(10, 4)):
            assert direction @ point <= max(direction @ node for _, node in nodes) + 1e-12
    # Nodes that are unit vectors show the weights themselves.
    units = np.eye(len(nodes))
    for piece in spline((time, unit) for (time, _), unit in zip(nodes, units, strict=True)):
        weights = piece.at(piece.a + share * (piece.b - piece.a))
        assert weights.min() >= 0
        assert weights.sum() == pytest.approx(1)


# ---- stresses at the knots


class Fitted:
    """The polynomials of degree 3 that a stress is on the thirds, from its values alone."""

    def __init__(self, discretisation: Discretisation, values: Tensors) -> None:
        space = discretisation.stresses
        self.mesh, self.centre = space.mesh, thirds(space.mesh.p[:, space.mesh.t])
        x = space.points.reshape(2, space.cells, 3, -1)
        y = values.reshape(3, space.cells, 3, -1)
        self.coefficients = np.empty((space.cells, 3, 10, 3))
        for cell, third in np.ndindex(space.cells, 3):
            basis = self.monomials(x[:, cell, third])[0]
            found, *_ = np.linalg.lstsq(basis.T, y[:, cell, third].T, rcond=None)
            assert np.allclose(basis.T @ found, y[:, cell, third].T, atol=1e-8 * abs(y).max())
            self.coefficients[cell, third] = found

    @staticmethod
    def monomials(x: Array) -> tuple[Array, Array, Array]:
        """x^i y^j with i + j ≤ 3, (10, n), and their derivatives."""
        powers = [(i, j) for i in range(4) for j in range(4 - i)]
        plain = np.array([x[0] ** i * x[1] ** j for i, j in powers])
        by_x = np.array([i * x[0] ** max(i - 1, 0) * x[1] ** j for i, j in powers])
        by_y = np.array([j * x[0] ** i * x[1] ** max(j - 1, 0) for i, j in powers])
        return plain, by_x, by_y

    def stress(self, cell: int, third: int, x: Array) -> Array:
        """(2, 2, n)."""
        a, b, c = self.coefficients[cell, third].T @ self.monomials(x)[0]
        return np.array([[a, c / np.sqrt(2)], [c / np.sqrt(2), b]])

    def divergence(self, cell: int, third: int, x: Array) -> Array:
        _, by_x, by_y = self.monomials(x)
        (ax, _, cx), (_, by, cy) = (self.coefficients[cell, third].T @ d for d in (by_x, by_y))
        return np.array([ax + cy / np.sqrt(2), cx / np.sqrt(2) + by])


@pytest.mark.parametrize("name", ["hexagon", "advance-recede", "anisotropic"])
def test_stresses_at_knots_balance_the_projected_loads_and_press(name: str) -> None:
    """Point by point from values alone: Div σ̃ = −P f_0, σ̃ν = P f_2 on Γ2, continuous σ̃ν, σ̃_τ = 0, σ̃_ν ≤ 0 on Γ3."""
    case = CASES[name]
    discretisation = Discretisation(Data.of(case.solution), Unstructured()(case.solution.body, 3))
    space = discretisation.stresses
    u, rate = (0.1 * np.random.default_rng(i).normal(size=discretisation.displacements.dofs) for i in (0, 1))
    (knot,) = Equilibration(discretisation).knots([0.37], u[None], rate[None])
    stress = knot.residual.values + knot.viscous + knot.elastic
    fitted, size = Fitted(discretisation, stress), abs(stress).max()
    force = np.einsum("ctad,aq->dctq", knot.snapshot.loads.force, space.force_shapes)
    x = space.points.reshape(2, space.cells, 3, -1)
    scale = size / np.sqrt(space.volumes.min())
    for cell, third in np.ndindex(space.cells, 3):
        divergence = fitted.divergence(cell, third, x[:, cell, third])
        assert np.allclose(divergence, -force[:, cell, third], atol=1e-7 * scale)

    places = np.array([0.1, 0.4, 0.8])
    tractions: dict[int, list[Array]] = {}
    mesh = space.mesh
    for cell, side in np.ndindex(space.cells, 3):
        edge = int(space.edges[cell, side])
        a, b = (mesh.p[:, mesh.facets[end, edge]] for end in (0, 1))
        assert {*mesh.facets[:, edge]} == {*mesh.t[list(SIDES[side]), cell]}
        along = (b - a) / np.linalg.norm(b - a)
        normal = np.array([along[1], -along[0]])
        point = a[:, None] + np.outer(b - a, places)
        tractions.setdefault(edge, []).append(np.einsum("ijn,j->in", fitted.stress(cell, side, point), normal))
    for pair in tractions.values():
        assert len(pair) == 1 or np.allclose(*pair, atol=1e-7 * size)
    shapes = bernstein(space.degree, np.array([1 - places, places]))
    rows = 0
    for part, edges in zip(discretisation.data.body.parts, space.parts, strict=True):
        for edge in edges:
            (traction,) = tractions[int(edge)]
            a, b = (mesh.p[:, mesh.facets[end, edge]] for end in (0, 1))
            outward = np.sign(part.normal @ np.array([(b - a)[1], -(b - a)[0]]))
            traction = outward * traction
            if part.kind is Kind.LOADED:
                expected = np.einsum("ai,an->in", knot.snapshot.loads.surface[edge], shapes)
                assert np.allclose(traction, expected, atol=1e-7 * size)
            if part.kind is Kind.CONTACT:
                assert part.tangent @ traction == pytest.approx(0, abs=1e-7 * size)
                assert (part.normal @ traction).max() <= 1e-7 * size
                assert np.allclose(part.normal @ traction, knot.residual.normal[rows] @ shapes, atol=1e-7 * size)
                rows += 1
    assert rows == len(knot.residual.normal) > 0
    assert knot.residual.normal.max() <= 1e-9 * size
    assert knot.residual.normal.min() < -1e-3 * size


@pytest.mark.parametrize("name", ["advance-recede", "heterogeneous", "yield-and-release"])
def test_pieces_that_are_taken_together_have_the_bounds_that_they_have_one_by_one(name: str, monkeypatch) -> None:
    case = CASES[name]
    found = []
    for most in (1, 3, 16):
        monkeypatch.setattr("study.bound.majorant.LEAST", 1)
        monkeypatch.setattr("study.bound.majorant.MOST", most)
        discretisation = Discretisation(Data.of(case.solution), Shaken()(case.solution.body, 4))
        found.append(enclose(discretisation, compute(discretisation, MIDPOINT, 8), SmoothedInTime()))
    one_by_one, *others = found
    for other in others:
        assert other.bound == pytest.approx(one_by_one.bound, rel=1e-9)
        assert other.between == pytest.approx(one_by_one.between, rel=1e-9)


# ---- what y is made of


@lru_cache
def intervals_of(name: str) -> tuple[Discretisation, tuple[Interval, ...]]:
    case = CASES[name]
    discretisation = Discretisation(Data.of(case.solution), Shaken()(case.solution.body, 4))
    computed = compute(discretisation, MIDPOINT, 4)
    return discretisation, enclose(discretisation, computed, SmoothedInTime()).intervals


@pytest.mark.parametrize("name", ["advance-recede", "full-contact", "no-contact", "yield-on-a-part"])
def test_nothing_is_added_but_what_is_on_record(name: str) -> None:
    discretisation, intervals = intervals_of(name)
    m = discretisation.moduli.values.min()
    for one in intervals:
        # Parts joined cell by cell are at most their sum.
        added = one.residual + one.oscillation + one.bending + one.unseen
        decayed = math.exp(-max(m, 0) * (one.b - one.a)) * one.at_a
        assert one.at_b <= (math.sqrt(decayed**2 + 2 * one.contact) + added) * (1 + 1e-9)
        assert one.inside >= max(one.at_a, one.at_b) * (1 - 1e-12)
        assert min(one.contact, one.residual, one.oscillation, one.bending, one.unseen) >= 0
    assert [one.b for one in intervals[:-1]] == [one.a for one in intervals[1:]]
    assert [one.at_b for one in intervals[:-1]] == [one.at_a for one in intervals[1:]]


# ---- orders


def made(h: float, lower: float, upper: float) -> Enclosure:
    """max_t ‖u − u_h‖_V ∈ [lower, upper]."""
    middle, radius = np.array([(lower + upper) / 2]), np.array([(upper - lower) / 2])
    one = np.ones(1)
    return Enclosure(h, one, middle, radius, math.nan * one, (), 0.0, 0 * one, upper * one, Evidence(()))


positive = st.floats(1e-3, 1e3)


@given(
    st.tuples(positive, positive, st.floats(0, 1)), st.tuples(positive, positive, st.floats(0, 1)), st.floats(1.1, 8)
)
def test_the_interval_of_the_order_has_the_order_of_all_errors_enclosed_and_is_reached(first, second, ratio) -> None:
    ends = [sorted(pair[:2]) for pair in (first, second)]
    coarse, fine = made(ratio, *ends[0]), made(1.0, *ends[1])
    low, high = order(coarse, fine)
    errors = [a + share * (b - a) for (a, b), (*_, share) in zip(ends, (first, second), strict=True)]
    observed = math.log(errors[0] / errors[1]) / math.log(ratio)
    assert low - 1e-6 <= observed <= high + 1e-6
    assert low == pytest.approx(math.log(ends[0][0] / ends[1][1]) / math.log(ratio), abs=1e-6)
    assert high == pytest.approx(math.log(ends[0][1] / ends[1][0]) / math.log(ratio), abs=1e-6)


def test_nothing_is_known_of_the_order_where_the_lower_bound_is_zero() -> None:
    assert order(made(2.0, 0.0, 1.0), made(1.0, 0.2, 0.4))[0] == -math.inf
    assert order(made(2.0, 0.5, 1.0), made(1.0, 0.0, 0.4))[1] == math.inf


def test_the_observed_order_lies_in_its_interval() -> None:
    case = CASES["full-contact"]
    found = [measure(posed(case.name), OneDiagonal(), n, MIDPOINT, 2 * n, Refined(0, 1))[1] for n in (4, 8)]
    low, high = order(*found)
    observed = math.log(found[0].error.max() / found[1].error.max()) / math.log(found[0].h / found[1].h)
    assert low <= observed <= high
    assert high - low < 0.65
    assert low < 1 < high


# ---- rows and refusals


def test_a_row_says_how_close_the_ends_came() -> None:
    case = CASES["advance-recede"]
    row, found = measure(posed(case.name), Shaken(), 4, MIDPOINT, 6, Refined(0, 2))
    assert row["error"] == found.error.max()
    assert row["above"] == pytest.approx((found.error / found.upper).max())
    assert row["below"] == pytest.approx((found.lower / found.error).max())
    late = found.times >= 0.5
    assert row["upper"] == pytest.approx((found.upper / found.error)[late].max())
    assert row["lowest"] <= row["error"] <= row["highest"]
    assert found.contains
    assert not replace(found, error=found.upper * 1.001).contains
    assert not replace(found, error=found.lower * 0.999).contains
    parts = row["residual"] + row["oscillation"] + row["bending"]
    assert parts > 0
    assert found.bound.max() <= parts + math.sqrt(2 * row["contact"]) + found.intervals[0].at_a


def test_a_case_whose_force_is_not_square_integrable_is_refused() -> None:
    with pytest.raises(BoundError, match=r"rough-1.75: .* f_0 ∉ L²"):
        measure(posed("rough-1.75"), OneDiagonal(), 4, MIDPOINT, 4, SmoothedInTime())


def test_displacements_computed_for_the_bound_are_admissible_and_linear_between_their_nodes() -> None:
    case = CASES["travelling-patch"]
    discretisation = Discretisation(Data.of(case.solution), Shaken()(case.solution.body, 5))
    for scheme in SCHEMES:
        computed = compute(discretisation, scheme, 4)
        assert isinstance(computed.space, Space)
        assert (computed.space.N @ computed.nodes.T).max() <= 1e-12
        for j in range(5):
            assert np.allclose(computed.at(j / 4), computed.nodes[j], atol=1e-9)
        assert np.allclose(computed.at(0.3), 0.8 * computed.nodes[1] + 0.2 * computed.nodes[2])


def test_a_heterogeneous_body_has_the_least_ratio_of_its_tensors() -> None:
    law = CASES["heterogeneous"].solution.law
    discretisation = Discretisation(Data.of(CASES["heterogeneous"].solution), Shaken()(unit_square(), 3))
    x = discretisation.stresses.points
    strains = np.random.default_rng(0).normal(size=(3, *x.shape[1:]))
    elastic = np.einsum("Icq,Icq->cq", law.G.at(x)(strains), strains)
    viscous = np.einsum("Icq,Icq->cq", law.A.at(x)(strains), strains)
    assert 0 < discretisation.moduli.values.min() <= (elastic / viscous).min()


def test_a_material_that_jumps_inside_cells_is_refused_by_its_line() -> None:
    case = next(case for case in catalogue() if case.name == "layered-unmet")
    with pytest.raises(BoundError, match="runs through cells of the mesh; list it as an interface"):
        Discretisation(Data.of(case.solution), OneDiagonal()(case.solution.body, 4))


def test_nodes_at_unequal_distances_are_refused() -> None:
    case = next(case for case in catalogue() if case.name == "no-contact")
    discretisation = Discretisation(Data.of(case.solution), OneDiagonal()(case.solution.body, 2))
    nodes = [(time, (1 + time) * np.ones(discretisation.displacements.dofs)) for time in (0.0, 0.25, 0.5)]
    nodes.append((1.0, 3 * nodes[-1][1]))
    with pytest.raises(BoundError, match="equally spaced in time"):
        list(Majorant(discretisation)(spline(nodes), 1.0))


def test_orders_are_enclosed_since_the_first_level_and_since_the_one_before() -> None:
    """E = (1, 1/2, 1/8) at h = (1, 1/2, 1/4): the order is 3/2 over all levels and 2 on the last pair."""
    ends = [(0.9, 1.1), (0.45, 0.55), (0.11, 0.14)]
    rest = {"dofs": 1, "error": math.nan, "plain": 1.0, "kind": "guaranteed"}
    rows = [
        {"level": 2**i, "h": 0.5**i, "steps": 2**i, "lowest": low, "highest": high, **rest}
        for i, (low, high) in enumerate(ends)
    ]
    table = levels(rows).set_index("level")
    for name, first in (("order", 0), ("pair", 1)):
        low, high = (math.log2(a / b) / (2 - first) for a, b in ((ends[first][0], 0.14), (ends[first][1], 0.11)))
        assert table.loc[4, [f"{name}_low", f"{name}_high"]].tolist() == pytest.approx([low, high])
    assert table.loc[1, ["order_low", "pair_low"]].isna().all()
    lines = _intervals(table.reset_index(), known=False)
    assert lines[0].split()[-10:] == ["order", "since", "level", "1", "in", "since", "the", "one", "before", "in"]
    assert lines[3].count("[") == 3
    assert lines[-1].endswith("with steps that follow the mesh")
    assert _intervals(table.reset_index().head(2).assign(steps=4), known=False)[-1].endswith("same steps on every mesh")
