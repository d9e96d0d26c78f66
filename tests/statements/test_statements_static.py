"""Statements without time: their pieces agree with independent ones, and each verdict can come out otherwise."""

import numpy as np
import pytest
from measured_rows import invented, measured, verdicts

from study.ledger.verdict import FAILS, HOLDS, MISSED, REPORTED
from study.statements import error_estimate
from study.statements.error_estimate import InterpolationInV, InterpolationOnContact
from study.statements.shared.base import grid
from study.statements.shared.norms import maximum, minimum
from study.statements.wellposed import Korn

H = 1 / np.array([8.0, 16.0, 32.0])


# (2.17).


def test_eigenvalues_that_rise_or_tend_to_zero_fail():
    for values in ((0.3, 0.2, 0.21), (0.4, 0.2, 0.1), (1 / 3, 1 / 4, 1 / 5), (0.3, 0.25, np.nan)):
        assert FAILS in verdicts(Korn(), invented({"smallest eigenvalue": values})).values(), values


# (5.23), (5.24).


@pytest.mark.parametrize(("family", "scatter"), [("one-diagonal", 1.0), ("shaken", 1.05)])
@pytest.mark.parametrize(("order", "verdict"), {1.0: HOLDS, 0.8: FAILS, 1.2: FAILS, 2.0: FAILS, np.nan: FAILS}.items())
def test_the_order_in_v_is_judged_from_both_sides(order, verdict, family, scatter):
    """On random meshes the scatter of the coarsest one hardly counts."""
    errors = dict.fromkeys(error_estimate.INTERPOLATED.values(), H**order * [scatter, 1, 1])
    assert set(verdicts(InterpolationInV(), invented(errors, family=family)).values()) == {verdict}


@pytest.mark.parametrize(
    ("tau", "order", "verdict"),
    [
        (np.inf, 2.0, HOLDS),
        (np.inf, 1.0, FAILS),
        (np.inf, 2.5, FAILS),
        (2.25, 2.0, HOLDS),
        (2.25, 1.5, FAILS),
        (1.75, 1.7, REPORTED),
        (1.75, 1.0, MISSED),
    ],
)
def test_the_order_of_traces_is_two_where_it_is_claimed(tau, order, verdict):
    column = error_estimate.TRACE_ERROR.format(next(iter(error_estimate.FUNCTIONS)), 1)
    rows = invented({error_estimate.REGULARITY: tau, "size of Γ3,1": H, column: H**order})
    assert {*verdicts(InterpolationOnContact(), rows).values()} == {verdict}


@pytest.mark.parametrize("place", range(3))
def test_extremes_of_values_with_nan_are_nan(place):
    """Python's ``max`` and ``min`` hide NaN unless it comes first; pandas leaves it out."""
    values = [1.0, 2.0, 3.0]
    assert maximum(values) == 3.0
    assert minimum(values) == 1.0
    values[place] = np.nan
    assert np.isnan([maximum(values), minimum(values)]).all()


def test_a_trace_that_is_zero_has_no_order_to_be_judged():
    rows = measured(InterpolationOnContact(), grid(("full-contact",), ("shaken",), (4, 8, 16)))
    assert list(verdicts(InterpolationOnContact(), rows)) == ["smooth-face-1"]
