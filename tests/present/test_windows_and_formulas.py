"""No window is loosened, no row given up and no formula left out without a reason that stands on the page."""

import shutil
from dataclasses import asdict
from pathlib import Path

import pandas as pd
import pytest
from committed import RESULTS

from study.ledger.datafiles import DataError, read_claims
from study.ledger.numbered import NO_ROW, NOT_TESTED, NUMBERED, named
from study.ledger.verdict import HOLDS, REPORTED
from study.ledger.window import MIN_POSITIVE
from study.present import windows
from study.present.pages import numbered_lines
from study.present.windows import FIRST, NOT_NOTHING, RELEASED, added, changes, earlier, release
from study.statements import STATEMENTS
from study.statements.pictures import Pictures
from study.statements.unmeasured import Listed, WithoutRow

CLAIMS = read_claims(RESULTS)
THEN = earlier(RESULTS)
ORDERS = CLAIMS["label"].eq("Prop. 5.4") & CLAIMS["key"].eq("order")


def edited(**values: object) -> pd.DataFrame:
    """The ledger with other values in the rows about the order of Proposition 5.4."""
    return CLAIMS.assign(**{column: CLAIMS[column].mask(ORDERS, value) for column, value in values.items()})


@pytest.mark.parametrize("file", [FIRST, RELEASED])
def test_every_change_of_the_committed_ledger_has_a_reason(file: str) -> None:
    """A window was changed? Say why in ``study/present/page/results.toml``; the page on windows lists it then."""
    assert len(THEN) == 1435
    assert not THEN.duplicated(["label", "key", "case", "family"]).any()
    assert THEN["case"].isin(CLAIMS["case"]).all()
    then = earlier(RESULTS, file)
    assert all(change.why for change in [*changes(then, CLAIMS), *(added(then, CLAIMS) if file == FIRST else [])])


def test_a_release_records_the_window_of_every_claimed_row(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    shutil.copy(RESULTS / "data" / "claims.csv", tmp_path / "data")
    release(tmp_path)
    assert changes(earlier(tmp_path, RELEASED), CLAIMS) == []
    with pytest.raises(DataError, match="say why"):
        changes(earlier(tmp_path, RELEASED), edited(window_high=1.2))


@pytest.mark.parametrize(
    "edit",
    [{"window_high": 1.2}, {"window_low": 0.95}, {"window_low": 0.0}, {"verdict": REPORTED}, {"key": "adjusted"}],
    ids=str,
)
def test_a_window_that_is_moved_or_a_row_that_is_given_up_needs_one(edit: dict[str, object]) -> None:
    with pytest.raises(DataError, match=r"the window of Prop\. 5\.4, order for .* was 0\.85 … 1\.15 before"):
        changes(THEN, edited(**edit))


def test_a_reason_is_shown_with_the_number_of_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(windows.WHY, ("Prop. 5.4", "order"), "the reason")
    found = changes(THEN, edited(window_high=1.2))
    (change,) = [one for one in found if (one.label, one.key) == ("Prop. 5.4", "order")]
    rows = (THEN["label"].eq("Prop. 5.4") & THEN["key"].eq("order")).sum()
    assert (change.before, change.today, change.why, change.rows) == ("0.85 … 1.15", "0.85 … 1.2", "the reason", rows)


def test_a_low_end_above_nothing_is_its_own_reason_and_no_other_change_of_the_same_row_is() -> None:
    row = {"label": "a", "key": "b", "case": "c", "family": "", "verdict": "holds", "window_low": MIN_POSITIVE}
    then = pd.DataFrame([row]).assign(then_low=0.0, then_high=1.0).drop(columns=["verdict", "window_low"])
    (change,) = changes(then, pd.DataFrame([{**row, "window_high": 1.0}]))
    assert change.why == NOT_NOTHING
    with pytest.raises(DataError):
        changes(then, pd.DataFrame([{**row, "window_high": 2.0}]))


# Every numbered formula and statement of the source has rows in the ledger, or a reason why it has none.


@pytest.fixture(scope="module")
def claims() -> pd.DataFrame:
    """One row for each statement that is measured, and all lines of the others."""
    rows = []
    for statement in STATEMENTS:
        if isinstance(statement, Listed):
            rows += [asdict(line) for line in statement.judge(pd.DataFrame())]
        elif not isinstance(statement, Pictures):
            rows.append({"label": statement.label, "statement": statement.claim, "verdict": HOLDS})
    return pd.DataFrame(rows)


def test_none_is_missing(claims: pd.DataFrame) -> None:
    """``numbered_lines`` raises an error for a missing number; the table has the order of the source."""
    lines = [numbers for numbers, _, _ in numbered_lines(claims)]
    first = [numbers.partition("–")[0] for numbers in lines]
    assert first == sorted(first, key=NUMBERED.index)
    assert named(", ".join(lines).replace("Problem 3.1–Problem 3.2", "Problem 3.1, 3.2")) == set(NUMBERED)
    without = claims[~claims["label"].str.contains(r"(5.11)", regex=False)]
    with pytest.raises(DataError, match=r"neither rows nor a reason for \(5\.11\), \(5\.12\), \(5\.13\)"):
        list(numbered_lines(without))


def test_labels_name_formulas_of_the_source_and_lines_without_a_row_those_that_have_none(claims: pd.DataFrame) -> None:
    for label, rows in claims[claims["label"] != "slips"].groupby("label"):
        places = rows["case"] if label in (NO_ROW, NOT_TESTED) else [label]
        assert set().union(*map(named, places)) <= set(NUMBERED), label
    # What is not tested may be a part of what is; a reason why there is no row would be wrong.
    measured = set().union(*(named(label) for label in set(claims["label"]) - {NO_ROW, NOT_TESTED, "slips"}))
    reasons = {place for _, place, _, _ in WithoutRow.lines}
    assert {place: named(place) & measured for place in reasons if named(place) & measured} == {}
