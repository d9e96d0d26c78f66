"""What tables contain, what is refused in them, and what messages say about differences and full disks."""

import shutil
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from study.ledger.codes import _table
from study.ledger.compare import Tolerance, as_text, compare, difference
from study.ledger.datafiles import ALL_ROWS, DataError, alarm_summary, read_table
from study.ledger.files import StoreError, write_whole
from study.ledger.text import cell


def fails(path: Path) -> None:
    raise RuntimeError("a defect")


def test_only_a_full_disk_is_called_full(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(RuntimeError, match="a defect"):
        write_whole(tmp_path / "a.csv", fails)
    monkeypatch.setattr(shutil, "disk_usage", lambda path: SimpleNamespace(free=0))
    with pytest.raises(StoreError, match="the disk is full"):
        write_whole(tmp_path / "a.csv", fails)


@pytest.mark.parametrize(
    ("value", "text"), [(np.nan, ""), (None, ""), (3, "3"), ("-3", "-3"), (0.05, "0.05000"), ("case", "case")]
)
def test_cells_of_tables_are_words_whole_numbers_or_four_digits(value: object, text: str) -> None:
    assert cell(value) == text


def test_the_words_na_and_none_are_text_and_not_empty_cells(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("label,h\nNA,1\nNone,2\n,3\n", encoding="utf-8")
    assert read_table(tmp_path / "a.csv", ["label", "h"], "study run")["label"].tolist() == ["NA", "None", ""]


def test_errors_of_other_codes_without_a_number_are_refused(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("code,distance\na,\n", encoding="utf-8")
    with pytest.raises(DataError, match="distance"):
        _table(tmp_path / "a.csv", ["code", "distance"], ["code"])


def test_the_summary_of_alarms_counts_claimed_checks_without_the_rows_about_all() -> None:
    both = {"label": ALL_ROWS, "claimed": "yes", "seeds": 10, "alarms": 0}
    rates = {"rate_low": 0.0, "rate_high": 0.3, "rate_tail": 0.1}
    rows = [{**both, "key": "every"}, {**both, "key": "light"}]
    rows += [{**both, "label": "(1.1)", "key": str(i), "claimed": "yes" if i < 3 else "no"} for i in range(5)]
    assert alarm_summary(pd.DataFrame(rows).assign(**rates)).rows == 3


def test_the_first_difference_between_a_table_and_its_expected_text_is_told(tmp_path: Path) -> None:
    path, close = tmp_path / "a.csv", frozenset({"x"})
    path.write_text("name,x\na,1.0000001\nb,2\n", encoding="utf-8")
    assert difference(path, "name,x\na,1\nb,2\n", close) is None
    assert difference(path, "name,x\na,1\nb,3\n", close) == f"{path}, line 3, column x: found '2', expected '3'"
    assert difference(path, "name,x\na,1\nb,\n", close) == f"{path}, line 3, column x: found '2', expected ''"
    path.write_text("name,x\n" + 100 * "a" + "b,2\n", encoding="utf-8")
    said = difference(path, "name,x\n" + 100 * "a" + "c,2\n", close)
    assert said == f"{path}, line 2, column name: found …'{30 * 'a'}b', expected …'{30 * 'a'}c'"


def written(directory: Path, **files: str) -> Path:
    for name, text in files.items():
        path = directory / "data" / name.replace("__", "/").replace("_", ".")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return directory


def test_the_report_names_every_column_of_a_table_that_differs(tmp_path: Path) -> None:
    """Of pictures it shows three differences only."""
    tables = {name: f"case,a,b,c,d\nx{4 * f',{name}'}\n" for name in "pq"}
    old, new = (written(tmp_path / name, cases_csv=text) for name, text in tables.items())
    text = as_text(compare(old, new, Tolerance()))
    assert [column for column in "abcd" if f"  {column}: 1 of 1 differ" in text] == [*"abcd"]


REPORT = """\
verdicts: none changed

cases.csv: differs
  rows only in OLD: 1
    c
  zone: 2 of 2 differ, 2 beyond tolerance
    a: p → q
same.csv: identical
pictures/: 1 identical

3 files: 2 identical, 0 within 1e-12 relative + 0, 1 differ, 0 left out"""


def test_the_report_of_a_comparison_is_known_word_for_word(tmp_path: Path) -> None:
    both = {"same_csv": "case,zone\na,b\n", "pictures__a_json": '{"level": 1}\n'}
    old = written(tmp_path / "old", cases_csv="case,zone\na,p\nb,p\nc,p\n", **both)
    new = written(tmp_path / "new", cases_csv="case,zone\na,q\nb,q\n", **both)
    assert as_text(compare(old, new, Tolerance())) == REPORT
