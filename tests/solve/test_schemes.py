"""The time schemes: their weights, numbers of steps, orders, and what each step satisfies."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from manufactured import named, unit_square
from manufactured.law import Indefinite, KelvinVoigt, isotropic, isotropic_matrix
from study.fem.error_norm import ErrorNorm
from study.fem.mesh import FAMILIES, OneDiagonal, Shaken
from study.fem.naming import resolve
from study.fem.space import Space
from study.run.plan import quick
from study.solve.evolution import EvolutionError, SemiDiscrete
from study.solve.paths import furthest, path
from study.solve.steps import StepsError, rate_steps, stress_steps
from study.solve.tableau import BACKWARD_EULER, BDF2, MIDPOINT, SCHEMES, Tableau
from study.statements.shared.base import Setting
from study.statements.shared.experiment import Experiment
from study.statements.thm_4_2 import problems
from study.statements.thm_4_2_own_space import StressExperiment

K = 0.1


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.name)
def test_a_scheme_differentiates_polynomials_of_its_order_exactly_where_it_takes_the_load(scheme: Tableau) -> None:
    times = K * np.arange(-len(scheme.past), 1)
    at = K * (scheme.theta - 1)
    for degree in range(int(scheme.order) + 2):
        before = [np.array([t**degree]) for t in times[:-1]]
        wrong = abs(scheme.rate(np.array([times[-1] ** degree]), before, K)[0] - degree * at ** max(degree - 1, 0))
        assert (wrong < 1e-12) == (degree <= scheme.order)


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.name)
def test_a_scheme_starts_with_steps_whose_past_is_there(scheme: Tableau) -> None:
    assert [len(scheme.of_step(n).past) <= n for n in range(1, 5)] == [True] * 4
    assert scheme.of_step(1) is (scheme.starting or scheme)
    assert scheme.of_step(len(scheme.past)) is scheme


def test_steps_grow_with_level_and_pace_and_those_of_stresses_are_even() -> None:
    assert [rate_steps(1.0, n) for n in (8, 27, 64)] == [32, 72, 128]
    assert [stress_steps(1.0, n) for n in (8, 16)] == [32, 64]
    assert [stress_steps(0.5, 16, pace) for pace in (1.0, 4.0, 100.0)] == [8, 16, 32]
    assert all(stress_steps(T, n, 5.0) % 2 == 0 for T in (0.3, 1.0) for n in range(2, 40))


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.name)
def test_a_march_has_a_step_or_more_and_asks_for_loads_at_the_times_that_its_scheme_says(scheme: Tableau) -> None:
    setup = Experiment.of(named("full-contact").solution, OneDiagonal(), 4, scheme, 7)
    with pytest.raises(StepsError, match="one step or more"):
        next(scheme.march(setup.problem, 0))
    asked = []

    def load(time: float) -> np.ndarray:
        asked.append(time)
        return np.asarray(setup.problem.load(time))

    assert len([*scheme.march(replace(setup.problem, load=load), 7)]) == 8
    k = setup.problem.T / 7
    assert asked == pytest.approx([(n - 1 + scheme.theta) * k for n in range(1, 8)], rel=1e-15)


@pytest.mark.parametrize("case", ["advance-recede", "yield-on-a-part"])
@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.name)
def test_every_step_balances_forces_as_its_scheme_says(scheme: Tableau, case: str) -> None:
    """M δu_n + G(θ u_n + (1 − θ) u_{n−1}) + Nᵀλ_n = F, the first steps by the scheme that takes them."""
    setup = Experiment.of(resolve(case).solution, OneDiagonal(), 6, scheme, 9)
    problem, k = setup.problem, setup.problem.T / 9
    states = [*scheme.march(problem, 9)]
    for n in range(1, 10):
        taken = scheme.of_step(n)
        u, before = states[n].u, [state.u for state in states[:n]]
        between = taken.theta * u + (1 - taken.theta) * before[-1]
        load = problem.load(taken.balanced(n, k))
        inner = problem.M @ taken.rate(u, before, k) + problem.elastic(between)
        assert abs(inner + problem.N.T @ states[n].multipliers - load).max() <= 1e-9 * abs(load).max()


BODY = unit_square()
SPACE = Space(OneDiagonal()(BODY, 4), BODY)
EVEN = KelvinVoigt(isotropic(1, 0), Indefinite(isotropic_matrix(-2, 0)), "G = −2A")


def unloaded(law: KelvinVoigt) -> SemiDiscrete:
    return SemiDiscrete.of(SPACE, law, lambda t: np.zeros(SPACE.dofs), np.zeros(SPACE.dofs))


def least(problem: SemiDiscrete, scheme, k: float) -> float:
    """The least eigenvalue of (w/k) M + θ G."""
    S = scheme.newest / k * problem.M + scheme.theta * problem.reference
    return float(np.linalg.eigvalsh(S.toarray())[0])


@pytest.mark.parametrize("scheme", [BACKWARD_EULER, MIDPOINT], ids=lambda scheme: scheme.name)
def test_where_g_is_a_multiple_of_a_no_longer_step_would_do(scheme) -> None:
    problem, longest = unloaded(EVEN), scheme.longest(EVEN.growth)
    assert longest == pytest.approx(scheme.newest / scheme.theta / 2)
    assert least(problem, scheme, 0.999 * longest) > 0 > least(problem, scheme, 1.001 * longest)


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.name)
def test_every_step_serves_a_monotone_law_and_steps_below_m_a_over_l_g_serve_every_law(scheme) -> None:
    assert scheme.longest(named("yield-on-a-part").solution.law.growth) == math.inf
    for name in ("softening", "double-well"):
        law = named(name).solution.law
        scheme.require_unique(0.999 * law.A.ellipticity / law.G.lipschitz, law.growth)
    # The first step of BDF2 is a step of backward Euler, which must be shorter than the other ones.
    assert BDF2.longest(2.0) == BACKWARD_EULER.longest(2.0) == 0.5 < BDF2.newest / 2.0


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: scheme.name)
def test_longer_steps_are_refused_before_anything_is_factorised(monkeypatch, scheme) -> None:
    def never(S, N):
        raise AssertionError("a matrix was factorised")

    problem = replace(unloaded(EVEN), T=10 * scheme.longest(EVEN.growth), solver=never)
    with pytest.raises(StepsError, match=r"need not have one solution: G is not monotone.*rate 2; take k < "):
        list(scheme.march(problem, 10))
    with pytest.raises(AssertionError, match="factorised"):
        list(scheme.march(problem, 11))


def test_longer_steps_of_the_stress_problems_are_refused_too() -> None:
    solution = named("softening").solution
    _, stresses = problems(solution, OneDiagonal(), 4)
    with pytest.raises(StepsError, match="one solution"):
        list(stresses.march(1))
    experiment = StressExperiment.at(Setting("softening", "one-diagonal", 4), 2)
    with pytest.raises(StepsError, match="one solution"):
        list(replace(experiment, steps=1).march())


def test_the_steps_of_the_study_are_short_enough() -> None:
    quick().check()


@pytest.mark.parametrize(("n", "error", "interpolation"), [(8, 6.977, 4.026), (16, 3.536, 2.030)])
def test_errors_agree_with_an_independent_prototype_to_four_digits(n: int, error: float, interpolation: float) -> None:
    """Of an advancing and receding front, with backward Euler and k = 1/(2n)."""
    solution = named("advance-recede").solution
    space = Space(OneDiagonal()(solution.body, n), solution.body)
    v_norm = ErrorNorm(solution, space, raised=2)
    problem = SemiDiscrete.of(space, solution.law, v_norm.load, v_norm.sample(0.0).interpolant)
    found, interpolated = [], []
    for state in BACKWARD_EULER.march(problem, 2 * n):
        sample = v_norm.sample(state.time)
        found.append(v_norm.distance(sample, state.u))
        interpolated.append(v_norm.distance(sample, sample.interpolant))
    assert float(f"{max(found):.4g}") == error
    assert float(f"{max(interpolated):.4g}") == interpolation


FOR_SQUARES = [family for family in FAMILIES if family.serves(unit_square())]


@cache
def trajectory(name: str, scheme, steps: int):
    """Return a problem and its solution, computed once for all comparisons; tests only read it."""
    problem = Experiment.of(named(name).solution, Shaken(), 8, scheme, steps).problem
    return problem, path(problem, scheme, steps)


@pytest.mark.parametrize("name", ["advance-recede", pytest.param("yield-and-release", marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    ("scheme", "low", "high"), [(BACKWARD_EULER, 0.8, 1.2), (BDF2, 1.3, 2.2), (MIDPOINT, 1.4, 2.3)]
)
def test_a_scheme_converges_in_time_with_its_order(name: str, scheme, low: float, high: float) -> None:
    """Predicted: 1 for backward Euler; 2, falling to 3/2 where vertices change state, for the others."""
    problem, reference = trajectory(name, MIDPOINT, 320)
    errors = [furthest(problem, trajectory(name, scheme, n)[1], reference[:: 320 // n]) for n in (20, 80)]
    assert low <= np.log2(errors[0] / errors[1]) / 2 <= high


@pytest.mark.parametrize("family", FOR_SQUARES, ids=lambda f: f.name)
def test_a_midpoint_step_of_a_nonlinear_law_takes_at_most_six_solves_on_the_coarsest_mesh_of_its_sweep(family) -> None:
    """There steps are longest. Backward Euler and BDF2 take more: the share of G in a step is twice as large."""
    case = named("yield-and-release")
    setup = Experiment.of(case.solution, family, 8, MIDPOINT, rate_steps(case.solution.body.T, 8, case.pace))
    solves = [state.iterations for state in setup.scheme.march(setup.problem, setup.steps)][1:]
    assert max(solves) <= 6


def test_a_fixed_point_that_does_not_settle_says_so() -> None:
    problem = Experiment.of(named("yield-and-release").solution, OneDiagonal(), 4, MIDPOINT, 4).problem
    stiff = replace(problem, remainder=lambda v: 50 * problem.M @ v)
    with pytest.raises(EvolutionError, match="take more steps"):
        list(MIDPOINT.march(stiff, 4))


def test_the_residual_of_a_step_knows_the_gap() -> None:
    setup = Experiment.of(named("parabolic-gap").solution, OneDiagonal(), 8, MIDPOINT, 4)
    assert max(state.residual() for state in setup.scheme.march(setup.problem, 4)) < 1e-10
    wrong = replace(setup.problem, gap=0.0)
    assert next(setup.scheme.march(wrong, 4)).u == pytest.approx(setup.problem.u0)
    step = setup.problem.stepper(MIDPOINT, 0.25)
    step.problem = wrong  # the residual of a correct step, with respect to the cone of the paper
    assert step(1, [setup.problem.initial()]).residual() > 1e-3
