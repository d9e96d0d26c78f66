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
def test_undecided_rows_are_accepted_if_exactly_these_are_listed(tmp_path, verdict, lines, code, capsys) -> None:
    file = listed(tmp_path, HEAD + lines)
    assert code_of([replace(ROW, verdict=verdict)], file) == code
    differs = {(UNDECIDED, ""): "undecided but not listed", (HOLDS, LINE): "not undecided but listed"}
    row = f"this check is {differs.get((verdict, lines))} in {file}: (0.0), order, pocket, shaken\n"
    assert capsys.readouterr().err == (row if code == 3 else "")


def test_without_a_list_an_undecided_row_and_no_row_at_all_are_undecided() -> None:
    assert code_of([replace(ROW, verdict=UNDECIDED, observed=math.nan)], None) == 3
    assert code_of([], None) == 3


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEAD + "(0.0),order,pocket,shaken, \n", "line 2: the reason why the row is undecided is missing"),
        ("label,key\n", "has the columns label, key, expected label, key, case, family, reason"),
        ("", "cannot be read as CSV"),
        (None, "cannot be read as CSV"),
    ],
)
def test_a_list_without_reasons_or_columns_or_without_a_file_is_refused(tmp_path, text: str, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        code_of([ROW], tmp_path / "none.csv" if text is None else listed(tmp_path, text))
