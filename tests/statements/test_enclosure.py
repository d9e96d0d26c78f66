"""Verdicts on bounds of errors: one error outside fails, and an interval for an order has to be narrow."""

from __future__ import annotations

import math

import pandas as pd
import pytest

from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED
from study.ledger.window import around
from study.statements.enclosure import (
    CHECKED,
    CHECKED_LEVEL,
    ROOM,
    UNPREDICTED,
    BoundedError,
    EnclosedError,
    judge_interval,
)


def bounds(trajectory: str, levels: tuple[int, ...] = (8, 16), case: str = "a", **changes) -> pd.DataFrame:
    """Rows of ``bounds.csv`` with errors of order 1, which the ends miss by one per cent."""
    rows = [
        {
            "trajectory": trajectory,
            "case": case,
            "family": "shaken",
            "scheme": "midpoint",
            "level": n,
            "h": 1 / n,
            "known": True,
            "expected_order": 1.0,
            "error": 1 / n,
            "lowest": 0.99 / n,
            "highest": 1.01 / n,
            "above": 0.99,
            "below": 0.99,
            "upper": 1.01,
            "lower": 0.99,
        }
        for n in levels
    ]
    return pd.DataFrame(rows).assign(**changes)


def verdicts(statement: BoundedError | EnclosedError, rows: pd.DataFrame) -> dict[str, str]:
    return {verdict.key: verdict.verdict for verdict in statement.judge(rows)}


def test_errors_inside_hold_and_the_distance_of_the_ends_is_reported() -> None:
    assert verdicts(BoundedError(), bounds("bound")) == {"above": HOLDS, "upper": REPORTED}
    expected = {"above": HOLDS, "below": HOLDS, "upper": REPORTED, "order": REPORTED}
    assert verdicts(EnclosedError(), bounds("enclosure")) == expected


def test_each_statement_is_judged_by_its_own_rows() -> None:
    both = pd.concat([bounds("bound", above=2.0), bounds("enclosure")])
    assert verdicts(BoundedError(), both)["above"] == FAILS
    assert verdicts(EnclosedError(), both)["above"] == HOLDS


@pytest.mark.parametrize("value", [1.0001, math.nan])
def test_one_error_outside_on_one_mesh_fails(value: float) -> None:
    assert verdicts(BoundedError(), bounds("bound", above=[0.9, value]))["above"] == FAILS
    for end in ("above", "below"):
        found = verdicts(EnclosedError(), bounds("enclosure", **{end: [value, 0.9]}))
        assert [key for key, verdict in found.items() if verdict == FAILS] == [end]


def test_ends_are_close_where_it_was_announced() -> None:
    rows = bounds("enclosure", (8, CHECKED_LEVEL), CHECKED)
    assert verdicts(EnclosedError(), rows)["tight-above"] == HOLDS
    wide = rows.assign(upper=[1.01, 1.2], lower=[0.99, 0.8])
    found = verdicts(EnclosedError(), wide)
    assert (found["tight-above"], found["tight-below"]) == (FAILS, FAILS)
    elsewhere = verdicts(EnclosedError(), rows.assign(upper=[1.2, 1.01], lower=[0.8, 0.99]))
    assert (elsewhere["tight-above"], elsewhere["tight-below"]) == (HOLDS, HOLDS)


def test_an_order_is_judged_where_nobody_knows_the_error() -> None:
    unknown = bounds("enclosure", known=False, error=math.nan, above=math.nan, below=math.nan)
    assert verdicts(EnclosedError(), unknown) == {"order": HOLDS}
    assert verdicts(EnclosedError(), unknown.assign(expected_order=1.5)) == {"order": FAILS}
    wide = unknown.assign(highest=1.2 * unknown["highest"])
    assert verdicts(EnclosedError(), wide) == {"order": UNDECIDED}
    assert verdicts(BoundedError(), unknown.assign(trajectory="bound")) == {}
    assert verdicts(EnclosedError(), unknown[:1]) == {}


def test_the_whole_interval_of_an_order_must_lie_in_the_window_of_every_other_order() -> None:
    window = around(1, ROOM)
    assert judge_interval((0.86, 1.14), window) == HOLDS
    assert judge_interval((0.84, 1.02), window) == UNDECIDED
    assert judge_interval((1.16, 1.2), window) == FAILS


def test_a_problem_without_a_known_solution_and_a_predicted_order_says_so() -> None:
    rows = bounds("enclosure", known=False, expected_order=math.nan, error=math.nan, above=math.nan, below=math.nan)
    (order,) = EnclosedError().judge(rows)
    assert (order.verdict, order.expected) == (REPORTED, UNPREDICTED)
