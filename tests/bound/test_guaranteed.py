"""A guaranteed bound holds for data that no sample sees; what cannot be enclosed is called estimated."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse.linalg import eigsh
from skfem import BilinearForm, ElementTriP2, ElementVector, FacetBasis, InteriorBasis
from skfem.helpers import dot
from sympy import Expr, Rational, cos, exp, log, pi, sin, sqrt, tanh

from benchmarks.trials.known import Feature, Known, Trial, random_trial
from benchmarks.trials.random_problems import ENCLOSED, TIMES, outcome
from manufactured import FrobeniusBall, KelvinVoigt, Kind, Linear, Yield, catalogue, isotropic, pos, t, unit_square
from manufactured.body import Body
from manufactured.compiled import function
from manufactured.data import Data
from manufactured.factor import layers, x1, x2
from manufactured.problems import problems
from study.bound.bounded import BoundedSolution, bounded_solution
from study.bound.discretisation import Discretisation
from study.bound.enclosing import Enclosure, order_interval
from study.bound.load_constants import load_constants
from study.bound.ranges import Boxes
from study.bound.remainders import Regions
from study.bound.sampling import ESTIMATED, GUARANTEED
from study.bound.trajectory import Refined
from study.bound.univariate import RangeError, require_known
from study.fem.mesh import MeshFamily, OneDiagonal, Unstructured
from study.solve.tableau import MIDPOINT

LAW = KelvinVoigt(isotropic(1, 0.5), isotropic(2, 3), "linear")
GRID = OneDiagonal()
BALLISTIC = [{"pos": lambda x, a: np.where(x > 0, np.maximum(x, 1e-300) ** a, 0.0)}, "numpy"]


# ---- ranges


FORMULAS = [
    t * exp(-4 * (x1 - 0.3) ** 2 - 4 * (x2 - 0.4) ** 2),
    sin(3 * x1 * t) * cos(x2) / (1 + x1**2),
    pos(x1 - t, 3) * x2,
    pos(x1 - x2, Rational(5, 2)) - pos(t - x2, 0),
    sqrt(1 + x1 * x2) + (1 + x2) ** Rational(-3, 2),
    tanh(x1 - 2 * t) + x1 ** (1 + x2),
    x2**5 * log(2 + x1) + (x1 - Rational(1, 2)) ** 4,
    (1 - (x1 - t) ** 2) ** 3 / (2 + sin(9 * x2)) ** 2,
]


@pytest.mark.parametrize("formula", FORMULAS, ids=str)
@pytest.mark.parametrize("variables", [(x1, x2), (t,)], ids=["space", "time"])
def test_taylor_coefficients_lie_in_their_ranges(formula: Expr, variables: tuple[sp.Symbol, ...]) -> None:
    rng, count = np.random.default_rng(0), 40
    low = rng.random((3, count))
    high = low + np.geomspace(1e-3, 0.3, count)
    found = (boxes := Boxes(dict(zip((x1, x2, t), zip(low, high, strict=True), strict=True)), variables, 4))(formula)
    for term, key in enumerate(boxes.keys):
        derivative = formula
        for variable, times in zip(variables, key, strict=True):
            derivative = sp.diff(derivative, variable, times) / sp.factorial(times)
        values = sp.lambdify((x1, x2, t), derivative, modules=BALLISTIC)
        for _ in range(10):
            with np.errstate(over="ignore"):
                value = values(*(low + rng.random((3, count)) * (high - low))) * np.ones(count)
            slack = 1e-9 * abs(value) + 1e-12
            assert (found.low[term] - slack <= value).all()
            assert (value <= found.high[term] + slack).all()


def test_ranges_of_small_boxes_are_tight() -> None:
    low, high = np.array([0.4]), np.array([0.4 + 1e-6])
    found = Boxes({x1: (low, high), t: (low, high)}, (x1,), 4)(sin(3 * x1 * t) * exp(x1) / (1 + x1**2))
    assert (found.high - found.low).max() < 1e-3


def test_no_derivative_is_known_beyond_the_order_of_a_kink() -> None:
    low, high = np.array([0.0, 0.6]), np.array([1.0, 0.9])
    found = Boxes({x1: (low, high)}, (x1,), 4)(pos(x1 - Rational(1, 2), 2))
    assert np.isfinite(found.high[:3]).all()
    assert np.isinf(found.high[3:, 0]).all()
    assert np.isfinite(found.high[:, 1]).all()


def test_functions_without_ranges_are_named() -> None:
    low, high = np.zeros(1), np.ones(1)
    with pytest.raises(RangeError, match="gamma"):
        Boxes({x1: (low, high)}, (x1,), 2)(sp.gamma(1 + x1))


@pytest.mark.parametrize("part", [sp.gamma(1 + x1), sp.atan(x1 - x2), sp.floor(x1 + t)], ids=str)
def test_they_are_found_anywhere_in_a_formula_before_time_is_spent(part: Expr) -> None:
    for formula in FORMULAS:
        require_known(formula)
        with pytest.raises(RangeError, match=type(part).__name__):
            require_known(1 + x2 * sin(formula + part) ** 2)


def test_polynomials_of_degree_three_have_no_remainder_and_others_have_that_of_taylor() -> None:
    sides = {x1: (np.array([0.2]), np.array([0.4])), x2: (np.array([0.1]), np.array([0.3]))}
    region = Regions(sides)
    assert region.in_space([x1**3 - x1 * x2**2 + t**5], 0.0, 1.0) == 0
    assert region.in_space([x1**4], 0.0, 1.0) == pytest.approx(0.1**4)
    assert region.in_space([pos(x1 - Rational(3, 10), 1)], 0.0, 1.0) <= 0.1
    parabola, cubic = region.in_time([t**2 * x1, t**2], 0.0, 1.0)
    assert parabola == cubic == 0
    assert region.in_time([t**3], 0.0, 1.0)[0] > 0 == region.in_time([t**3], 0.0, 1.0)[1]


# ---- constants


@pytest.mark.parametrize("body", [unit_square(), *(problem.data.body for problem in problems())])
def test_constants_of_loads_are_above_those_of_any_displacements_and_close(body: Body) -> None:
    constants = load_constants(body, isotropic(1, 0.5))
    data = Data.formulas(body, LAW, f0=(0, 0))
    fine = Discretisation(data, Unstructured()(body, 8))
    V = fine.displacements
    for part, bound in ((None, constants.volume), (Kind.LOADED, constants.surface)):
        mass = squares(V, part)
        largest = math.sqrt(float(eigsh(mass, 1, fine.M, which="LA", return_eigenvectors=False)[0]))
        assert largest <= bound <= 1.5 * largest


def squares(V, part: Kind | None):
    """The matrix of (u, v)_H, or of (u, v)_{L²} on parts, in the free unknowns."""
    element = ElementVector(ElementTriP2())
    if part is None:
        basis = InteriorBasis(V.mesh, element)
    else:
        facets = np.concatenate([V.facets(one) for one in V.body.of(part)])
        basis = FacetBasis(V.mesh, element, facets=facets)
    full = BilinearForm(lambda u, v, w: dot(u, v)).assemble(basis)
    clamped = basis.get_dofs(np.concatenate([V.facets(one) for one in V.body.of(Kind.CLAMPED)])).all()
    free = np.setdiff1d(np.arange(full.shape[0]), clamped)
    return full[free][:, free]


# ---- problems whose solutions are known and whose data are as rough as one likes


def enclosed(problem: Data, level: int, steps: int, family: MeshFamily = GRID) -> tuple[BoundedSolution, Enclosure]:
    found = bounded_solution(problem, None, family, level, MIDPOINT, steps, Refined(0, 1))
    return found, found.enclosure


def assert_inside(trial: Trial, seed: int) -> None:
    found = trial.bounded()
    assert found.enclosure.evidence.kind == GUARANTEED
    assert outcome(trial, found, np.random.default_rng(seed).random(TIMES))[0] == ENCLOSED


@pytest.mark.parametrize("seed", [4, 8])
def test_no_error_lies_outside_for_random_data_that_samples_do_not_see(seed: int) -> None:
    assert_inside(random_trial(seed), seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(1000, 1010))
def test_no_error_lies_outside_for_more_random_data_than_are_on_record(seed: int) -> None:
    assert_inside(random_trial(seed), seed)


@pytest.mark.parametrize("seed", [2, 5])
def test_known_solutions_solve_their_problems(seed: int) -> None:
    """On Γ3, turned or not: u_ν ≤ 0, σ_ν ≤ 0, one of them 0, σ_τ = 0; u = 0 on Γ1."""
    known = random_trial(seed).known
    assert known.zone is not None
    (contact,), (clamped,) = known.body.of(Kind.CONTACT), known.body.of(Kind.CLAMPED)
    strain = function((x1, x2, t), [*known.strain, *(sp.diff(e, t) for e in known.strain)])
    u = function((x1, x2, t), known.u)
    for time in (0.0, 0.4, 1.0):
        x = contact.start[:, None] + np.linspace(0, 1, 201) * (contact.end - contact.start)[:, None]
        e = np.array([np.broadcast_to(value, x.shape[1:]) for value in strain(*x, time)])
        stress = known.law.A(e[3:]) + known.law.G(e[:3])
        a, b, c = stress[0], stress[1], stress[2] / math.sqrt(2)
        n = contact.normal
        traction = np.array([a * n[0] + c * n[1], c * n[0] + b * n[1]])
        size, pressure = abs(stress).max(), n @ traction
        opening = -n @ np.array(u(*x, time))
        assert abs(contact.tangent @ traction).max() < 1e-12 * size
        assert pressure.max() < 1e-12 * size
        assert pressure.min() < -1e-6 * size
        assert opening.min() > -1e-14
        assert opening.max() > 0
        assert abs(pressure * opening).max() < 1e-12 * size
        top = clamped.start[:, None] + np.linspace(0, 1, 21) * (clamped.end - clamped.start)[:, None]
        assert abs(np.array(u(*top, time))).max() < 1e-12


def test_bounds_without_remainders_put_such_errors_outside() -> None:
    feature = Feature((0.37, 0.41), 0.005, 0.0, 0.1, 1)
    trial = Trial(Known(LAW, (sp.Integer(0), t * feature.formula), (feature,)), 4, 2, OneDiagonal())
    assert_inside(trial, 0)
    blind = trial.bounded(replace(trial.known.data, formulas_of=None))
    assert blind.enclosure.evidence.kind == ESTIMATED
    assert trial.known.error(blind.computed, 1.0) > 1000 * blind.enclosure.highest


# ---- the two examples that a bound from samples got wrong


def spike(width: Expr) -> Data:
    """A load that is concentrated at one point."""
    force = -10 / (pi * width**2) * t * exp(-((x1 - 0.37) ** 2 + (x2 - 0.41) ** 2) / width**2)
    return Data.formulas(unit_square(), LAW, f0=(0, force))


@pytest.mark.parametrize(("width", "least"), [(Rational(5, 1000), 1.4), (Rational(1, 100), 1.64)])
def test_a_load_within_a_hundredth_of_a_cell_is_enclosed_and_its_place_is_named(width: Expr, least: float) -> None:
    _, enclosure = enclosed(spike(width), 4, 4)
    assert enclosure.evidence.kind == GUARANTEED
    assert enclosure.highest > least
    assert "f_0 is seen poorly near x = (0.4" in enclosure.evidence.poorly_seen


def test_a_load_that_vanishes_at_all_nodes_in_time_is_enclosed() -> None:
    _, enclosure = enclosed(Data.formulas(unit_square(), LAW, f0=(0, -100 * sin(64 * pi * t) ** 2)), 4, 8)
    assert enclosure.highest > 3.2
    assert "f_0 is seen poorly" in enclosure.evidence.poorly_seen


def test_remainders_of_smooth_data_fall_faster_than_the_error() -> None:
    data = Data.formulas(unit_square(), LAW, f0=(0, -10 * t * sin(2 * pi * x1) * x2))
    unseen = [sum(one.unseen for one in enclosed(data, n, n)[1].intervals) for n in (3, 6, 12)]
    assert unseen[0] / unseen[1] > 8
    assert unseen[1] / unseen[2] > 8
    assert enclosed(data, 12, 12)[1].evidence.poorly_seen == ""


# ---- what is not guaranteed says so


CASES = {case.name: case for case in catalogue()}
SQUARE = unit_square()


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (Data.of(CASES["full-contact"].solution), "known at points and times only"),
        (Data.formulas(SQUARE, LAW, f0=(sp.atan(1 + x1), 0)), "atan"),
        (
            Data.formulas(SQUARE, KelvinVoigt(isotropic(1, 1), Yield(1.0, FrobeniusBall(1.0)), "(3.3)"), f0=(0, 0)),
            "nonlinear G",
        ),
        (
            Data.formulas(
                SQUARE,
                KelvinVoigt(Linear(isotropic(1, 1).matrix, layers((1.0, 0.0), 0.5, 2.0)), isotropic(1, 1), "layers"),
                f0=(0, 0),
            ),
            "varies in x",
        ),
        (
            Data.formulas(
                SQUARE,
                KelvinVoigt(
                    isotropic(1, 1), Linear(isotropic(1, 1).matrix, layers((1.0, 0.0), 0.5, 2.0)), "layers of G"
                ),
                f0=(0, 0),
            ),
            "varies in x",
        ),
        (Data.formulas(SQUARE, LAW, f0=(0, pos(x1 - 0.4, 1)), lines=(((1.0, 0.0), 0.4),)), "graded rules"),
    ],
    ids=["values", "atan", "nonlinear", "layers", "layers of G", "lines"],
)
def test_what_is_sampled_is_called_estimated_with_the_reason(data: Data, reason: str) -> None:
    evidence = Discretisation(data, OneDiagonal()(data.body, 4)).sampling
    assert any(reason in one for one in evidence.reasons)


def test_a_kink_without_lines_is_guaranteed_by_a_lower_order() -> None:
    data = Data.formulas(SQUARE, LAW, f0=(0, -5 * pos(x1 - x2 - t / 3, 1)))
    _, enclosure = enclosed(data, 4, 4)
    assert enclosure.evidence.kind == GUARANTEED != ESTIMATED
    assert sum(one.unseen for one in enclosure.intervals) > 0


def test_a_wedge_with_a_rolling_load_is_guaranteed() -> None:
    (wedge,) = (problem.data for problem in problems() if problem.name == "ramp")
    sampled = Discretisation(wedge, Unstructured()(wedge.body, 2)).sampling
    assert sampled.reasons == ()


ERRORS = st.floats(1e-6, 1e3)
"""Of errors and of ends of their intervals."""
SHARES = st.floats(0, 1)


@given(st.tuples(ERRORS, ERRORS).map(sorted), st.tuples(ERRORS, ERRORS).map(sorted), SHARES, SHARES, st.floats(0.1, 3))
def test_an_order_lies_in_its_interval_wherever_the_errors_lie_in_theirs(
    coarse: list[float], fine: list[float], one: float, other: float, ratio: float
) -> None:
    low, high = order_interval((coarse[0], coarse[1]), (fine[0], fine[1]), ratio)
    errors = [a ** (1 - share) * b**share for (a, b), share in ((coarse, one), (fine, other))]
    assert low - 1e-9 <= math.log(errors[0] / errors[1]) / ratio <= high + 1e-9
    ends = math.log(coarse[0] / fine[1]) / ratio, math.log(coarse[1] / fine[0]) / ratio
    assert (low, high) == pytest.approx(ends), "no wider than that"


def test_errors_that_may_vanish_leave_an_order_open() -> None:
    assert order_interval((0.0, 2.0), (0.5, 1.0), 1.0) == pytest.approx((-math.inf, math.log(4)))
    assert order_interval((1.0, 2.0), (0.0, 0.5), 1.0) == pytest.approx((math.log(2), math.inf))
