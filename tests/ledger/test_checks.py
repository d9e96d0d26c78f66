"""From the levels of mesh families to a verdict: what is taken of them, and a window that tells wrong from unclear."""

import math
from dataclasses import replace
from types import SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest

from study.ledger import quantities
from study.ledger.check import MIN_LEVELS, Check
from study.ledger.verdict import (
    FAILS,
    HOLDS,
    MISSED,
    REPORTED,
    UNDECIDED,
    CheckKind,
    agreement,
    exit_code,
)
from study.ledger.window import Window, around, at_least, at_most, between, position
from study.present.outcome import write_junit

LEVELS = (8, 16, 32, 64)


def levels(values, count=4):
    return pd.DataFrame({"h": 1 / np.array(LEVELS), "e": np.broadcast_to(values, len(LEVELS))}).head(count)


def check(value, window, levels=1, **options):
    return Check("key", "a quantity", value, window, CheckKind.CLAIM, levels, **options)


def judged(check, *families):
    claim = SimpleNamespace(label="(0.0)", claim="a claim")
    return check.verdict(claim, "a", {str(i): family for i, family in enumerate(families)})


FIRST = 1 / np.array(LEVELS)
ABOUT_1 = around(1, 0.1)
ORDERS = {
    "level by level": quantities.level_by_level("e"),
    "over two refinements": quantities.over_refinements("e", 2),
    "fitted": quantities.fitted("e"),
    "extrapolated": quantities.extrapolated("e"),
}


@pytest.mark.parametrize("name", ORDERS)
def test_orders_are_those_of_powers_and_need_three_levels_and_positive_errors(name):
    order = check(ORDERS[name], ABOUT_1, MIN_LEVELS)
    found = judged(order, levels(FIRST))
    assert found.verdict == HOLDS
    assert found.observed == pytest.approx(1)
    assert judged(order, levels(FIRST**2)).verdict == FAILS
    few = judged(order, levels(FIRST, 2))
    assert few.verdict == UNDECIDED
    assert few.expected.endswith("undecided, because the check needs 3 levels, and has 2")
    for bad in (0.0, -1.0, math.nan):
        errors = FIRST.copy()
        errors[-1] = bad
        found = judged(order, levels(errors))
        assert found.verdict == FAILS
        assert math.isnan(found.observed)


def test_if_only_the_finest_level_decides_others_outside_the_window_leave_it_undecided():
    by_level = ORDERS["level by level"]
    errors = levels([2 / 8, 1 / 16, 1 / 32, 1 / 64])
    found = judged(check(by_level, ABOUT_1, MIN_LEVELS, finest=True), errors)
    assert found.observed == 1
    assert found.low == 1
    assert found.high == pytest.approx(2)
    assert found.verdict == UNDECIDED
    assert judged(check(by_level, ABOUT_1, MIN_LEVELS), errors).verdict == FAILS


@pytest.mark.parametrize("correction", [-0.5, 0.5, 2.0])
def test_the_extrapolated_order_is_free_of_corrections_of_first_order(correction):
    """log e = log h + c h: consecutive orders differ from 1 by c h times a constant, which extrapolation removes."""
    errors = levels(FIRST * np.exp(correction * FIRST))
    for name, verdict in (("extrapolated", HOLDS), ("level by level", FAILS)):
        assert judged(check(ORDERS[name], around(1, 1e-9), MIN_LEVELS), errors).verdict == verdict
    limit_above_zero = levels(FIRST + 0.01)
    assert judged(check(ORDERS["extrapolated"], ABOUT_1, MIN_LEVELS), limit_above_zero).verdict == FAILS


@pytest.mark.parametrize(
    ("value", "window", "observed"),
    [
        ("e", at_most(5), 4.0),
        ("e", around(3, 2), 1.0),
        ("e", at_least(0), 1.0),
        (quantities.change("e"), at_most(5), 0.5),
        (quantities.change("e", since=-2), at_most(5), 2 / 3),
        (quantities.finest_quotient("e", "h"), at_most(128), 128.0),
        ("e", Window(), 4.0),
    ],
)
def test_what_is_taken_of_the_levels(value, window, observed):
    """In a window with two ends the value farthest from its middle decides, otherwise the worst one."""
    numbers = [4.0, 1.0, 3.0, 2.0]
    found = judged(check(value, window), levels(numbers))
    assert found.verdict == HOLDS
    assert found.observed == pytest.approx(observed)
    assert judged(check(value, window), levels([*numbers[:3], math.nan])).verdict == FAILS


def test_one_family_that_cannot_tell_leaves_all_undecided_and_one_that_fails_is_shown():
    largest = check("e", at_most(1))
    assert judged(largest, levels(0.5), levels(0.7)).observed == 0.7
    found = judged(largest, levels(0.5), levels(2.0))
    assert found.verdict == FAILS
    assert found.observed == 2.0
    assert found.low == 0.5
    assert found.high == 2.0
    found = judged(largest, levels(0.5), levels(0.5).drop(columns="e"))
    assert found.verdict == UNDECIDED
    assert found.low == -math.inf
    assert found.high == math.inf
    assert judged(largest).verdict == UNDECIDED
    nothing = check(lambda table: np.array([]), at_most(1))
    assert judged(nothing, levels(0.5)).verdict == UNDECIDED, "no level has the quantity"


# Windows.


def in_window(window, value, low, high):
    return judged(check(lambda _: np.array([low, high, value]), window, finest=True), levels(1.0))


@pytest.mark.parametrize(
    ("value", "low", "high", "verdict"),
    [
        (1.0, 0.95, 1.05, HOLDS),
        (1.0, 0.5, 1.5, UNDECIDED),
        (1.2, 1.15, 1.25, FAILS),
        (math.nan, 1.0, 1.0, FAILS),
        (1.0, math.nan, 1.0, UNDECIDED),
    ],
)
def test_a_window_distinguishes_wrong_from_unclear(value, low, high, verdict):
    assert in_window(around(1, 0.1), value, low, high).verdict == verdict


def test_a_window_writes_its_own_text():
    assert between(1.5, 2, 0.15, 0.2).text == "1.35 … 2.2, predicted 1.5 … 2"
    assert around(0.5444837, 0.15, "reason").text == "0.544 ± 0.15: reason"


def observed(window, value):
    return judged(check(lambda _: value, window, if_missed="nobody knows"), levels(1.0))


def test_a_prediction_without_a_claim_is_reported_and_missed_if_it_was_wrong():
    for value, outcome, verdict in ((1.0, "met", REPORTED), (1.2, "wrong", MISSED), (math.nan, "undecided", REPORTED)):
        row = observed(around(1, 0.1), value)
        assert row.verdict == verdict
        assert row.expected == f"predicted 1 ± 0.1 ({outcome}); no claim, because nobody knows"
        assert agreement(pd.Series(vars(row))) == outcome
    assert observed(Window(), math.nan).verdict == REPORTED, "without a prediction none is missed"


@pytest.mark.parametrize(
    ("verdicts", "code"),
    {(HOLDS, REPORTED, MISSED): 0, (HOLDS, UNDECIDED): 3, (FAILS, UNDECIDED, HOLDS): 1, (): 3}.items(),
)
def test_a_failure_goes_before_an_undecided_row_a_missed_prediction_is_none_and_junit_says_the_same(
    verdicts, code, tmp_path
):
    row = in_window(around(1, 0.1), 1.0, 0.95, 1.05)
    rows = [replace(row, verdict=verdict) for verdict in verdicts]
    assert exit_code(rows) == code
    write_junit(tmp_path / "a.xml", rows)
    suite = ElementTree.parse(tmp_path / "a.xml").getroot()
    assert (int(suite.get("failures", "")) > 0) == bool([*suite.iter("failure")]) == (code == 1)


def test_zero_is_infinitely_far_outside_a_window_with_a_positive_lower_end_only():
    assert position(0.0, 0.5, math.inf) == math.inf
