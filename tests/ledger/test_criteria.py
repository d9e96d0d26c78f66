"""From the levels of mesh families to a verdict: what is taken of them, and a window that tells wrong from unclear."""

import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from study.ledger.criterion import (
    Criterion,
    Observation,
    Rule,
    between_levels,
    change,
    consecutive,
    every,
    extrapolated,
    finest,
    largest,
    order,
)
from study.ledger.theorems import EXACT_QUOTIENTS, THEOREMS

from study.ledger.datafiles import read_claims, since_before, with_orders
from study.ledger.verdict import (
    CAN_FAIL,
    FAILS,
    HOLDS,
    IDENTITY,
    MISSED,
    ONE_SIDED,
    ORDER,
    REPORTED,
    SIZE,
    THEOREM,
    UNDECIDED,
    Verdict,
    agreement,
    exit_code,
    is_of_the_paper,
    kind,
    window_share,
)
from study.ledger.window import Window, around, at_least, at_most, between, position, shown

LEVELS = (8, 16, 32, 64)


def levels(values: object, count: int = len(LEVELS)) -> pd.DataFrame:
    return pd.DataFrame({"h": 1 / np.array(LEVELS), "e": np.broadcast_to(values, len(LEVELS))}).head(count)


def judged(rule: Rule, *families: pd.DataFrame) -> Verdict:
    claim = SimpleNamespace(label="(0.0)", claim="a claim")
    return rule.verdict(claim, "a", {str(i): family for i, family in enumerate(families)})


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
    errors = levels([5.0, 1 / 16, 1 / 32, 1 / 64])
    assert judged(order("key", "order", ABOUT_1, "e", last=3), errors).verdict == HOLDS, "of the last levels alone"
    assert judged(order("key", "order", ABOUT_1, "e"), errors).verdict == FAILS


@pytest.mark.parametrize("correction", [-0.5, 0.5, 2.0])
def test_the_extrapolated_order_is_free_of_corrections_of_first_order(correction: float) -> None:
    """log e = log h + c h: consecutive orders differ from 1 by c h times a constant, which extrapolation removes."""
    errors = levels(FIRST * np.exp(correction * FIRST))
    for rule, verdict in ((extrapolated, HOLDS), (consecutive, FAILS)):
        assert judged(rule("key", "order", around(1, 1e-9), "e"), errors).verdict == verdict
    limit_above_zero = levels(FIRST + 0.01)
    assert judged(extrapolated("key", "order", ABOUT_1, "e"), limit_above_zero).verdict == FAILS


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


def test_the_column_of_orders_is_empty_where_there_are_none() -> None:
    errors = [1 / 8, 1 / 16, 0.0, 1 / 64]
    series = {"claim": "c", "case": "a", "family": "f", "scheme": "s", "level": LEVELS, "time_share": 0.0}
    table = with_orders(pd.DataFrame({**series, "h": 1 / np.array(LEVELS), "error": errors, "at": 0.0}))
    assert table["order"].tolist() == pytest.approx([math.nan, 1.0, math.nan, math.nan], nan_ok=True)
    assert list(table)[list(table).index("time_share") + 1] == "order"
    assert np.isnan(since_before(np.array([0.1, 0.2]), np.array([1.0, 4.0]))).all(), "the second mesh is coarser"


# Windows.


def in_window(window: Window, value: float, low: float, high: float) -> Verdict:
    return judged(Criterion("key", "a quantity", window, lambda _: (value, (low, high)), ()), levels(1.0))


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
def test_a_window_distinguishes_wrong_from_unclear(value: float, low: float, high: float, verdict: str) -> None:
    assert in_window(around(1, 0.1), value, low, high).verdict == verdict


@pytest.mark.parametrize(
    ("window", "text"),
    [
        (around(1, 0.15, "every consecutive order"), "1 ± 0.15: every consecutive order"),
        (between(1.5, 2, 0.15, 0.2), "1.35 … 2.2, predicted 1.5 … 2"),
        (around(0.5444837, 0.15), "0.544 ± 0.15"),
        (at_most(0.02, "of the error"), "≤ 0.02: of the error"),
        (at_most(1 + 1e-9, low=-math.inf), "≤ 1 + 1e-9"),
        (at_least(0.97), "≥ 0.97"),
        (Window(0.7, 1.4), "0.7 … 1.4"),
        (Window(-1.5, -0.5), "-1.5 … -0.5"),
    ],
)
def test_a_window_writes_its_own_text(window: Window, text: str) -> None:
    assert window.text == text


@given(st.floats(min_value=1e-12, max_value=1e6))
def test_the_text_of_a_number_has_three_digits_of_it(number: float) -> None:
    first, _, rest = shown(number).partition(" ")
    assert float(first) == pytest.approx(number, rel=5.1e-3)
    assert not rest or float(first) == pytest.approx(number, rel=1e-4)


def test_a_row_is_known_by_label_key_case_and_family_and_carries_its_window() -> None:
    row = in_window(around(1, 0.1), 1.0, 0.95, 1.05)
    assert row.identity == ("(0.0)", "key", "a", "")
    assert (row.window_low, row.window_high, row.expected) == (0.9, 1.1, "1 ± 0.1")


def observed(window: Window, value: float) -> Verdict:
    criterion = Criterion("key", "a quantity", window, lambda _: (value, (value, value)), ())
    return judged(Observation(criterion, "nobody knows"), levels(1.0))


def test_a_prediction_without_a_claim_is_reported_and_missed_if_it_was_wrong() -> None:
    for value, outcome, verdict in ((1.0, "met", REPORTED), (1.2, "wrong", MISSED), (math.nan, "undecided", REPORTED)):
        row = observed(around(1, 0.1), value)
        assert row.verdict == verdict
        assert row.expected == f"predicted 1 ± 0.1 ({outcome}); no claim, because nobody knows"
        assert agreement(pd.Series(vars(row))) == outcome
    assert observed(Window(), math.nan).verdict == REPORTED, "without a prediction none is missed"


@pytest.mark.parametrize(
    ("verdicts", "code"),
    [((HOLDS, REPORTED, MISSED), 0), ((HOLDS, UNDECIDED), 3), ((FAILS, UNDECIDED, HOLDS), 1), ((), 3)],
)
def test_a_failure_goes_before_an_undecided_row_and_a_missed_prediction_is_no_failure(verdicts, code: int) -> None:
    row = in_window(around(1, 0.1), 1.0, 0.95, 1.05)
    assert exit_code([replace(row, verdict=verdict) for verdict in verdicts]) == code


@pytest.mark.parametrize(
    ("window", "label", "key", "expected"),
    [
        (around(1, 0.1), "(0.0)", "order", ORDER),
        (around(1, 0.1), "(0.0)", "size", SIZE),
        (at_most(0.02), "(0.0)", "quadrature", ONE_SIDED),
        (at_most(1e-10), "(0.0)", "residual", IDENTITY),
        (at_most(1 + 1e-9, low=1 - 1e-9), "(0.0)", "equality", IDENTITY),
        (Window(-1.5, -0.5), "(0.0)", "order", ORDER),
        (at_most(1.0), "(3.6)", "upper", THEOREM),
        (at_most(1.0), "(3.1)", "bound", IDENTITY),
        (at_most(1.0), "Prop. 5.4", "parallelogram", THEOREM),
    ],
)
def test_evidence_has_a_kind_by_its_window_and_what_is_proved(window: Window, label, key, expected: str) -> None:
    row = replace(in_window(window, 1.0, 1.0, 1.0), label=label, key=key, quantity="a quantity")
    assert kind(pd.Series(vars(row))) == expected
    assert (expected in CAN_FAIL) is (expected not in (THEOREM, IDENTITY))


def test_every_proved_relation_names_rows_of_the_committed_ledger() -> None:
    claims = read_claims(Path(__file__).parents[2] / "results")
    rows = set(claims[["label", "key"]].itertuples(index=False, name=None))
    listed = {(label, key) for table in (THEOREMS, EXACT_QUOTIENTS) for label, keys in table.items() for key in keys}
    assert listed <= rows


@pytest.mark.parametrize(("label", "paper"), [("Prop. 5.4", True), ("(4.4), (4.5), (5.6)", True), ("bound", False)])
def test_a_row_is_about_the_paper_if_its_label_has_a_number_of_the_paper(label: str, paper: bool) -> None:
    assert is_of_the_paper(label) is paper


@pytest.mark.parametrize(
    ("window", "values", "share"),
    [
        (around(1, 0.1), (1.0, 0.95, 1.0), 0.5),
        (at_most(0.02), (0.01, 0.0, 0.01), 0.5),
        (at_least(0.5), (1.0, 1.0, 2.0), 0.5),
        (around(1, 0.1), (1.05, 0.2, 1.9), 0.5),
        (around(1, 0.1), (1.3, 1.3, 1.3), math.nan),
        (at_least(0), (1.0, 0.0, 1.0), math.nan),
    ],
    ids=["two-sided", "upper end", "lower end", "judged by its value", "judged in another way", "any value"],
)
def test_the_share_of_a_window_that_a_row_which_holds_uses(window: Window, values: tuple, share: float) -> None:
    ends = {"window_low": window.low, "window_high": window.high, "verdict": HOLDS}
    row = pd.Series(dict(zip(("observed", "low", "high"), values, strict=True)) | ends)
    assert window_share(row) == pytest.approx(share, nan_ok=True)


def test_zero_is_infinitely_far_outside_a_window_with_a_positive_lower_end_only() -> None:
    assert position(0.0, 0.5, math.inf) == math.inf
