"""From the levels of mesh families to a verdict: what is taken of them, and when they cannot tell."""

import math

import numpy as np
import pandas as pd
import pytest

from study.ledger.criterion import (
    SHARP,
    Criterion,
    between_levels,
    change,
    consecutive,
    every,
    extrapolated,
    finest,
    largest,
    order,
)
from study.ledger.datafiles import with_orders
from study.ledger.verdict import FAILS, HOLDS, UNDECIDED, Verdict
from study.ledger.window import around, at_most

LEVELS = (8, 16, 32, 64)


class Claim:
    """What a row takes from its statement."""

    label, claim = "(0.0)", "a claim"


def levels(values: object, count: int = len(LEVELS)) -> pd.DataFrame:
    """The coarsest levels of one family with values in the column e."""
    return pd.DataFrame({"h": 1 / np.array(LEVELS), "e": np.broadcast_to(values, len(LEVELS))}).head(count)


def judged(rule: Criterion, *families: pd.DataFrame) -> Verdict:
    return rule.verdict(Claim(), "a", {str(i): family for i, family in enumerate(families)})


FIRST = 1 / np.array(LEVELS)
ABOUT_1 = around(1, 0.1)
ORDERS = [
    consecutive("key", "order", ABOUT_1, "e"),
    between_levels("key", "order", ABOUT_1, "e", 2, 3),
    order("key", "order", ABOUT_1, "e"),
    extrapolated("key", "order", ABOUT_1, "e"),
]


@pytest.mark.parametrize("rule", ORDERS, ids=["consecutive", "between levels", "order", "extrapolated"])
def test_orders_are_those_of_powers_and_need_three_levels_and_positive_errors(rule: Criterion) -> None:
    found = judged(rule, levels(FIRST))
    assert (found.verdict, found.observed) == (HOLDS, pytest.approx(1))
    assert judged(rule, levels(FIRST**2)).verdict == FAILS
    assert judged(rule, levels(FIRST, 2)).verdict == UNDECIDED
    for bad in (0.0, -1.0, math.nan):
        errors = FIRST.copy()
        errors[-1] = bad
        found = judged(rule, levels(errors))
        assert (found.verdict, math.isnan(found.observed)) == (FAILS, True)


def test_every_consecutive_order_counts_and_the_finest_is_shown() -> None:
    found = judged(ORDERS[0], levels([2 / 8, 1 / 16, 1 / 32, 1 / 64]))
    assert (found.observed, found.low, found.high, found.verdict) == (1, 1, 2, UNDECIDED)


@pytest.mark.parametrize("correction", [-0.5, 0.5, 2.0])
def test_the_extrapolated_order_is_free_of_corrections_of_first_order(correction: float) -> None:
    """log e = log h + c h: consecutive orders differ from 1 by c h times a constant, which extrapolation removes."""
    errors = levels(FIRST * np.exp(correction * FIRST))
    for rule, verdict in ((extrapolated, HOLDS), (consecutive, FAILS)):
        assert judged(rule("key", "order", around(1, 1e-9), "e"), errors).verdict == verdict


def test_a_limit_above_zero_is_not_extrapolated_to_the_expected_order() -> None:
    assert judged(extrapolated("key", "order", ABOUT_1, "e"), levels(FIRST + 0.01)).verdict == FAILS


def test_an_order_may_be_that_of_the_last_levels_alone() -> None:
    errors = levels([5.0, 1 / 16, 1 / 32, 1 / 64])
    assert judged(order("key", "order", ABOUT_1, "e", last=3), errors).verdict == HOLDS
    assert judged(order("key", "order", ABOUT_1, "e"), errors).verdict == FAILS


@pytest.mark.parametrize(
    ("rule", "observed"),
    [
        (largest("key", "value", at_most(5), "e"), 4.0),
        (every("key", "value", around(3, 2), "e"), 1.0),
        (finest("key", "value", at_most(5), "e"), 2.0),
        (change("key", "value", at_most(5), "e"), 0.5),
    ],
    ids=["largest", "every", "finest", "change"],
)
def test_what_is_taken_of_the_levels(rule: Criterion, observed: float) -> None:
    values = [4.0, 1.0, 3.0, 2.0]
    found = judged(rule, levels(values))
    assert (found.verdict, found.observed) == (HOLDS, observed)
    assert judged(rule, levels([*values[:3], math.nan])).verdict == FAILS


def test_one_family_that_cannot_tell_leaves_all_undecided_and_one_that_fails_is_shown() -> None:
    rule = largest("key", "value", at_most(1), "e")
    assert judged(rule, levels(0.5), levels(0.7)).observed == 0.7
    found = judged(rule, levels(0.5), levels(2.0))
    assert (found.verdict, found.observed, found.low, found.high) == (FAILS, 2.0, 0.5, 2.0)
    found = judged(rule, levels(0.5), levels(0.5).drop(columns="e"))
    assert (found.verdict, found.low, found.high) == (UNDECIDED, -math.inf, math.inf)
    assert judged(rule).verdict == UNDECIDED


@pytest.mark.parametrize("quotient", [0.9, 1.01, math.nan])
def test_a_quotient_over_a_best_constant_must_be_one(quotient) -> None:
    rule = largest("key", "quotient", SHARP, "e")
    assert judged(rule, levels(1.0)).verdict == HOLDS
    assert judged(rule, levels(quotient)).verdict == FAILS


def test_the_column_of_orders_is_empty_where_there_are_none() -> None:
    errors = [1 / 8, 1 / 16, 0.0, 1 / 64]
    series = {"claim": "c", "case": "a", "family": "f", "scheme": "s", "level": LEVELS, "time_share": 0.0}
    table = with_orders(pd.DataFrame({**series, "h": 1 / np.array(LEVELS), "error": errors, "at": 0.0}))
    assert table["order"].tolist() == pytest.approx([math.nan, 1.0, math.nan, math.nan], nan_ok=True)
    assert list(table)[list(table).index("time_share") + 1] == "order"
