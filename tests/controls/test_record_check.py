"""``study check`` notices every line of the record of seeds and of its table that was deleted, added or changed."""

from __future__ import annotations

import gzip
import shutil
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

from study.controls import alarms
from study.controls.alarms import compare_record, tally
from study.controls.record import Record
from study.ledger.datafiles import DataError

RESULTS = Path(__file__).parents[2] / "results"
TABLE, DRAWN, PLACES = "seeds.csv", "seeds/drawn.csv", "seeds/places.csv.gz"
Change = Callable[[list[str]], list[str]]


@pytest.fixture(autouse=True)
def counted_once(committed: Record, counted: pd.DataFrame, monkeypatch) -> None:
    """The table of the committed record is not counted again where the record itself was not changed."""
    monkeypatch.setattr(alarms, "tally", lambda record: counted if record == committed else tally(record))


@pytest.fixture
def record(tmp_path: Path) -> Path:
    """A copy of the committed record and its table."""
    (tmp_path / "data").mkdir()
    shutil.copy(RESULTS / "data" / TABLE, tmp_path / "data")
    shutil.copytree(RESULTS / "data" / "seeds", tmp_path / "data" / "seeds")
    return tmp_path


def without(line: int) -> Change:
    return lambda lines: [text for number, text in enumerate(lines) if number != line % len(lines)]


def changed(line: int, change: Callable[[str], str]) -> Change:
    return lambda lines: [*lines[:line], change(lines[line]), *lines[line + 1 :]]


def one_alarm_more(text: str) -> str:
    *start, alarms = text.rstrip("\n").split(",")
    return ",".join([*start, f"{int(alarms) + 1}\n"])


TAMPERED: dict[str, tuple[str, Change]] = {
    **{f"line {n} of the table deleted": (TABLE, without(n)) for n in (1, -1)},
    **{f"line {n} of the seeds deleted": (DRAWN, without(n)) for n in (80, -2, -1)},
    **{f"line {n} of the places deleted": (PLACES, without(n)) for n in (700, -1)},
    "a line of the table twice": (TABLE, lambda lines: [*lines, lines[-1]]),
    "a number of the table": (TABLE, changed(1, lambda text: text.replace(",100,0,", ",101,0,"))),
    "a seed twice": (DRAWN, lambda lines: [*lines[:-1], lines[5], lines[-1]]),
    "an alarm more": (DRAWN, changed(71, one_alarm_more)),
    "another part": (DRAWN, changed(5, lambda text: text.replace("whole", "light"))),
}


def test_the_committed_record_agrees_with_its_table(record: Path) -> None:
    assert {path.name for path in compare_record(record)} == {"seeds.csv", "drawn.csv", "places.csv.gz"}


@pytest.mark.parametrize("name", TAMPERED)
def test_a_change_is_refused(name: str, record: Path) -> None:
    file, change = TAMPERED[name]
    path = record / "data" / file
    content = path.read_bytes()
    packed = path.suffix == ".gz"
    lines = (gzip.decompress(content) if packed else content).decode().splitlines(keepends=True)
    assert change(lines) != lines
    text = "".join(change(lines)).encode()
    path.write_bytes(gzip.compress(text) if packed else text)
    with pytest.raises(DataError, match="seeds"):
        compare_record(record)


@pytest.mark.parametrize("file", [TABLE, DRAWN, PLACES])
def test_a_missing_file_is_refused(file: str, record: Path) -> None:
    (record / "data" / file).unlink()
    with pytest.raises(DataError, match=f"{Path(file).name} is missing"):
        compare_record(record)


def test_a_run_without_seeds_has_nothing_to_compare(tmp_path: Path) -> None:
    assert compare_record(tmp_path) == set()
