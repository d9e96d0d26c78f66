"""Statements about the evolution: their pieces are right, and each verdict can come out otherwise."""

import math

import numpy as np
import pytest
from measured_rows import invented, verdicts

from manufactured import named
from study.ledger.verdict import FAILS, HOLDS, MISSED
from study.solve.tableau import SCHEMES
from study.statements.error_estimate import BOTH_BOUNDS, RATE, TRACE, ErrorBounds, constant, predicted
from study.statements.time_steps import FEW_STEPS, FullyDiscrete

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
