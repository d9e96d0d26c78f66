"""A window distinguishes wrong from unclear, and writes its own text from its numbers."""

import math
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study.ledger.criterion import Criterion, Observation
from study.ledger.datafiles import read_claims
from study.ledger.theorems import EXACT_QUOTIENTS, THEOREMS
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
    agreement,
    exit_code,
    is_of_the_paper,
    kind,
    window_share,
)
from study.ledger.window import Window, around, at_least, at_most, between, shown


class Claim:
    """What a row takes from its statement."""

    label, claim = "(0.0)", "a claim"


def judged(window: Window, value: float, low: float, high: float):
    criterion = Criterion("key", "a quantity", window, lambda _: (value, (low, high)), ())
    return criterion.verdict(Claim(), "a", {"shaken": pd.DataFrame({"h": [1.0]})})


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
    assert judged(around(1, 0.1), value, low, high).verdict == verdict


@pytest.mark.parametrize(
    ("window", "text"),
    [
        (around(1, 0.15, "every consecutive order"), "1 ± 0.15: every consecutive order"),
        (between(1.5, 2, 0.15, 0.2), "1.35 … 2.2, predicted 1.5 … 2"),
        (around(0.5444837, 0.15), "0.544 ± 0.15"),
        (at_most(0.02, "of the error"), "≤ 0.02: of the error"),
        (at_most(1 + 1e-9, low=-math.inf), "≤ 1 + 1e-9"),
        (at_most(1e-10), "≤ 1e-10"),
        (at_least(0.97), "≥ 0.97"),
        (Window(0.7, 1.4), "0.7 … 1.4"),
        (around(0, 0.1), "0 ± 0.1"),
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
    row = judged(around(1, 0.1), 1.0, 0.95, 1.05)
    assert row.identity == ("(0.0)", "key", "a", "")
    assert (row.window_low, row.window_high, row.expected) == (0.9, 1.1, "1 ± 0.1")


def observed(window: Window, value: float):
    criterion = Criterion("key", "a quantity", window, lambda _: (value, (value, value)), ())
    return Observation(criterion, "nobody knows").verdict(Claim(), "a", {"shaken": pd.DataFrame({"h": [1.0]})})


def test_a_prediction_without_a_claim_is_reported_and_missed_if_it_was_wrong() -> None:
    for value, outcome, verdict in ((1.0, "met", REPORTED), (1.2, "wrong", MISSED), (math.nan, "undecided", REPORTED)):
        row = observed(around(1, 0.1), value)
        assert row.verdict == verdict
        assert row.expected == f"predicted 1 ± 0.1 ({outcome}); no claim, because nobody knows"
        assert agreement(pd.Series(vars(row))) == outcome


def test_a_number_without_a_prediction_cannot_miss_it() -> None:
    assert observed(Window(), math.nan).verdict == REPORTED


@pytest.mark.parametrize(
    ("verdicts", "code"),
    [((HOLDS, REPORTED, MISSED), 0), ((HOLDS, UNDECIDED), 3), ((FAILS, UNDECIDED, HOLDS), 1), ((), 3)],
)
def test_a_failure_goes_before_an_undecided_row_and_a_missed_prediction_is_no_failure(verdicts, code: int) -> None:
    row = judged(around(1, 0.1), 1.0, 0.95, 1.05)
    assert exit_code([replace(row, verdict=verdict) for verdict in verdicts]) == code


@pytest.mark.parametrize(
    ("window", "label", "key", "expected"),
    [
        (around(1, 0.1), "(0.0)", "order", ORDER),
        (around(1, 0.1), "(0.0)", "size", SIZE),
        (at_most(0.02), "(0.0)", "quadrature", ONE_SIDED),
        (at_least(0.97), "(0.0)", "waves", ONE_SIDED),
        (at_most(1e-10), "(0.0)", "residual", IDENTITY),
        (at_most(1 + 1e-9, low=1 - 1e-9), "(0.0)", "equality", IDENTITY),
        (at_most(1e-12, low=-math.inf), "(0.0)", "sign", IDENTITY),
        (Window(-1.5, -0.5), "(0.0)", "order", ORDER),
        (at_most(1.0), "(3.6)", "upper", THEOREM),
        (at_most(1.0), "(3.1)", "bound", IDENTITY),
        (at_most(1.0), "Prop. 5.4", "parallelogram", THEOREM),
    ],
)
def test_evidence_has_a_kind_by_its_window_and_what_is_proved(window: Window, label, key, expected: str) -> None:
    row = replace(judged(window, 1.0, 1.0, 1.0), label=label, key=key, quantity="a quantity")
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
