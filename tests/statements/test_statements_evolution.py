"""Statements about the evolution: their pieces are right, and each verdict can come out otherwise."""

import math
from dataclasses import replace

import numpy as np
import pytest
from measured_rows import invented, verdicts

from manufactured import named
from study.ledger.verdict import FAILS, HOLDS, MISSED, REPORTED
from study.solve.tableau import BACKWARD_EULER, SCHEMES
from study.statements.error_estimate import BOTH_BOUNDS, RATE, TRACE, ErrorBounds, constant, predicted
from study.statements.shared.base import Experiment, Setting
from study.statements.time_steps import FEW_STEPS, FullyDiscrete
from study.statements.wellposed import fastest, perturbations, quotients


def setup(name, n, steps, family="shaken"):
    return Experiment.at(Setting(name, family, n), BACKWARD_EULER, steps)


# Theorem 2.2.


def test_a_start_outside_K_has_no_bounded_velocity():
    problem = setup("full-contact", 6, 1).problem
    outside = replace(problem, u0=problem.u0 + problem.N.T @ np.full(problem.N.shape[0], 1.0))
    assert fastest(problem, 96) < 1.2 * fastest(problem, 24)
    assert fastest(outside, 96) > 3 * fastest(outside, 24)


def test_growth_beyond_omega_exceeds_the_bound():
    found = setup("advance-recede", 4, 12)
    omega = found.solution.law.kappa
    problem = replace(found.problem, reference=-4 * omega * found.problem.M)
    trajectory = list(BACKWARD_EULER.march(problem, 12))
    damping = np.exp(-omega * np.array([state.time for state in trajectory[1:]]))
    quotient = [quotients(problem, trajectory, other) * damping for other in perturbations(problem, found.space)]
    assert np.max(quotient) > 1.1


# (5.20)–(5.21), (5.42).


def bounds_of(case, **terms):
    """Steady bounds, twice as large as the error with the constant of the proof."""
    steady = dict.fromkeys([*BOTH_BOUNDS, *(f"{bound}, c" for bound in BOTH_BOUNDS)], 0.5)
    return invented({**steady, **predicted(named(case)), **terms})


@pytest.mark.parametrize(("case", "term", "gamma"), [("rough-trace", TRACE, 1 / 8), ("moving-rough", RATE, 1 / 4)])
@pytest.mark.parametrize(("over_gamma", "verdict"), [(0, FAILS), (1, HOLDS), (2, FAILS)])
def test_a_bound_of_lower_order_must_be_lower_by_what_is_predicted(case, term, gamma, over_gamma, verdict):
    assert predicted(named(case))["γ of (5.42)"] == gamma
    found = verdicts(ErrorBounds(), bounds_of(case, **{term: np.array([8, 16, 32]) ** (over_gamma * gamma)}))
    assert found["growth-5.42"] == verdict
    assert "steady-5.42" not in found


def test_no_bound_is_claimed_where_the_ratio_carries_a_logarithm():
    found = ErrorBounds().judge(bounds_of("natural-front"))
    assert [(v.key, v.verdict) for v in found if "log h" in v.quantity] == [("steady-5.42", REPORTED)]


def test_the_constant_of_the_proof():
    law = named("advance-recede").solution.law  # L_G = 3, m_A = 2, monotone
    assert constant(law, 1.0) == pytest.approx(2 + 3 / 2)
    assert constant(law, 4.0) == pytest.approx(math.sqrt(16 + 48 + 48))


# Beyond the source.


def synthetic(**orders):
    """Tables of e = h and d = 3 k^q h^0."""
    values = {}
    for scheme in SCHEMES:
        for count in FEW_STEPS:
            values[f"{scheme.name} {count} d"] = 3 * count ** -orders[scheme.name]
            values[f"{scheme.name} {count} e"] = 1 / np.array([8.0, 16.0, 32.0])
    return invented(values)


def test_fits_recover_the_orders_and_compare_them_with_the_prediction():
    """The midpoint rule has the order 1 in these tables, where more is predicted."""
    orders = {"backward-euler": 1.0, "bdf2": 2.0, "midpoint": 1.0}
    found = {verdict.key: verdict for verdict in FullyDiscrete().judge(synthetic(**orders))}
    assert {key for key, verdict in found.items() if verdict.verdict == MISSED} == {"midpoint-time-in-k"}
    for name, q in orders.items():
        assert found[f"{name}-time-in-k"].observed == pytest.approx(q, abs=1e-6)
        assert found[f"{name}-time-in-h"].observed == pytest.approx(0, abs=1e-6)
        assert found[f"{name}-error-in-h"].observed == pytest.approx(1, abs=1e-6)
