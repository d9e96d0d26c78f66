"""No window is loosened, and no row given up, without a reason that stands on the page."""

from __future__ import annotations

import shutil
from pathlib import Path

import pandas as pd
import pytest
from committed import RESULTS

from study.ledger.datafiles import DataError, read_claims
from study.ledger.verdict import REPORTED
from study.ledger.window import MIN_POSITIVE
from study.present import windows
from study.present.windows import FIRST, NOT_NOTHING, RELEASED, added, changes, earlier, release

CLAIMS = read_claims(RESULTS)
THEN = earlier(RESULTS)
ORDERS = CLAIMS["label"].eq("Prop. 5.4") & CLAIMS["key"].eq("order")


def edited(**values: object) -> pd.DataFrame:
    """The ledger with other values in the rows about the order of Proposition 5.4."""
    return CLAIMS.assign(**{column: CLAIMS[column].mask(ORDERS, value) for column, value in values.items()})


def test_all_rows_of_the_first_round_are_compared_each_once() -> None:
    assert len(THEN) == 1435
    assert not THEN.duplicated(["label", "key", "case", "family"]).any()
    assert THEN["case"].isin(CLAIMS["case"]).all()


@pytest.mark.parametrize("file", [FIRST, RELEASED])
def test_every_change_of_the_committed_ledger_has_a_reason(file: str) -> None:
    """A window was changed? Say why in ``study/present/page/results.toml``; the page on windows lists it then."""
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
