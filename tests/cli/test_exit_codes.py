"""Exit codes: 0 no claim fails, 1 one fails, 2 bad usage or input, 3 undecided."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

from study.cli.common import code_of
from study.ledger.files import UsageError
from study.ledger.verdict import FAILS, HOLDS, MISSED, UNDECIDED, Verdict

HEAD = "label,key,case,family,reason\n"
ROW = Verdict("(0.0)", "a claim", "pocket", "an order", "1 ± 0.1", 1, 0.5, 1.5, HOLDS, "order", "shaken", 0.9, 1.1)
LINE = "(0.0),order,pocket,shaken,three levels leave the order open\n"


def listed(directory: Path, text: str) -> Path:
    file = directory / "undecided.csv"
    file.write_text(text, encoding="utf-8")
    return file


@pytest.mark.parametrize(
    ("verdict", "lines", "code"),
    [(HOLDS, "", 0), (MISSED, "", 0), (UNDECIDED, "", 3), (UNDECIDED, LINE, 0), (HOLDS, LINE, 3), (FAILS, LINE, 1)],
)
def test_undecided_rows_are_accepted_if_exactly_these_are_listed(tmp_path, verdict: str, lines: str, code: int) -> None:
    assert code_of([replace(ROW, verdict=verdict)], listed(tmp_path, HEAD + lines)) == code


def test_a_row_that_is_not_listed_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert code_of([replace(ROW, verdict=UNDECIDED)], listed(tmp_path, HEAD)) == 3
    assert "undecided but not listed in" in (said := capsys.readouterr().err)
    assert "(0.0), order, pocket, shaken" in said


def test_without_a_list_an_undecided_row_and_no_row_at_all_are_undecided() -> None:
    assert code_of([replace(ROW, verdict=UNDECIDED, observed=math.nan)], None) == 3
    assert code_of([], None) == 3


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEAD + "(0.0),order,pocket,shaken, \n", "line 2: the reason why the row is undecided is missing"),
        ("label,key\n", "has the columns label, key, expected label, key, case, family, reason"),
        ("", "cannot be read as CSV"),
    ],
)
def test_a_list_without_reasons_or_columns_is_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        code_of([ROW], listed(tmp_path, text))


def test_a_list_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="cannot be read as CSV"):
        code_of([ROW], tmp_path / "none.csv")
