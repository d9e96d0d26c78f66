"""The weights of the time schemes, and how many steps a mesh is given."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from manufactured import named
from study.fem.mesh import OneDiagonal
from study.fem.naming import resolve
from study.solve.steps import StepsError, rate_steps, stress_steps
from study.solve.tableau import SCHEMES, Tableau
from study.statements.shared.experiment import Experiment

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
