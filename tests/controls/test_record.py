"""The record of seeds adds and never replaces, and ``study check`` notices every line that was changed."""

from __future__ import annotations

import gzip
import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from study.controls import alarms
from study.controls.alarms import compare_record, newer, tally, text
from study.controls.record import Record, packed, place, unpacked
from study.controls.seeded import LIGHT, WHOLE, claimed
from study.ledger.datafiles import DataError, alarm_summary
from study.ledger.verdict import FAILS, HOLDS, UNDECIDED, Verdict, row
from study.ledger.window import Window, around, at_least, at_most
from study.statements.prop_5_4 import FirstOrder

WINDOW = around(1, 0.1)
ROW = ("Prop. 5.4", "order", "advance-recede")


def judged(value: float, key: str = "order", window: Window = WINDOW, state: str = "") -> Verdict:
    verdict = state or (HOLDS if window.contains(value) else FAILS)
    return row(FirstOrder(), key, f"the {key}", window, (value, (value, value), verdict), "advance-recede", "shaken-7")


def after(values: list[float], rule: str = "a", record: Record | None = None, part: str = WHOLE) -> Record:
    """A record with so many more seeds."""
    record = record or Record()
    for value in values:
        seed = 100 + len(record.draws)
        record = record.drawn(seed, part).judged(seed, [judged(value)], {ROW: rule}, claimed)
    return record


@pytest.mark.parametrize(
    ("value", "window", "expected"),
    [
        (1.05, around(1, 0.1), 0.5),
        (0.9, around(1, 0.1), -1.0),
        (0.3, at_most(0.6), 0.5),
        (-0.05, at_most(0.1, low=-np.inf), -0.5),
        (8.0, at_least(4), 0.5),
        (3.0, at_least(0.0), 0.0),
    ],
)
def test_a_place_is_the_share_of_the_window_that_a_row_uses(value: float, window: Window, expected: float) -> None:
    assert place(judged(value, window=window)) == pytest.approx(expected, abs=1e-9)


def test_an_alarm_is_a_place_beyond_whatever_raised_it() -> None:
    assert place(judged(1.2)) == pytest.approx(2.0)
    assert place(judged(0.85)) == pytest.approx(-1.5)
    for value, state in ((float("nan"), FAILS), (1.0, UNDECIDED), (1.1 + 1e-9, FAILS)):
        assert abs(unpacked(packed(place(judged(value, state=state))))[0]) > 1


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    record = after([1.0, 1.05, 0.95, 1.2])
    record.write(tmp_path)
    again = Record.read(tmp_path)
    assert again == record
    (line,) = again.lines.values()
    assert unpacked(line.places) == pytest.approx([0, 0.5, -0.5, 2.0], abs=2e-3)
    assert [draw.alarms for draw in again.draws] == [0, 0, 0, 1]


def test_nothing_in_it_is_replaced() -> None:
    record = after([1.0, 1.05])
    with pytest.raises(DataError, match="seed 100 is already in the record"):
        record.drawn(100, LIGHT)
    with pytest.raises(DataError, match="seed 100 was already judged"):
        record.judged(100, [judged(1.0)], {ROW: "a"}, claimed)
    longer = after([0.9], record=record)
    (before,), (behind,) = record.lines.values(), longer.lines.values()
    assert behind.places.startswith(before.places)
    assert longer.draws[:2] == record.draws


def test_seeds_judged_by_another_rule_count_for_nothing() -> None:
    """Else a window could be widened until the seeds that were drawn before are quiet."""
    old = after([1.2] * 5 + [1.0] * 5)
    record = after([1.0] * 3, rule="b", record=old)
    table = tally(record)
    line = table[table["key"] == "order"].iloc[0]
    assert (line["rule"], line["seeds"], line["alarms"], line["since"]) == ("b", 3, 0, 11)
    assert alarm_summary(table).seeds == 3
    assert len(record.lines) == 2


def with_size(record: Record, value: float) -> Record:
    """The record with one more whole seed, on which the check "size" is judged for the first time."""
    rules = {ROW: "a", (ROW[0], "size", ROW[2]): "c"}
    return record.drawn(9, WHOLE).judged(9, [judged(1.0), judged(value, key="size")], rules, claimed)


def test_a_row_with_a_newer_rule_than_the_others_is_named() -> None:
    assert list(newer(tally(with_size(after([1.0, 1.01]), 1.0)))["key"]) == ["size"]


def test_rows_that_cost_little_are_counted_on_every_seed() -> None:
    found = alarm_summary(tally(with_size(after([1.0, 1.2, 1.0], part=LIGHT), 1.3)))
    assert (found.rows, found.seeds, found.red, found.light_seeds, found.light_red) == (2, 1, 1, 4, 1)
    assert found.verdict == "fails"


def test_a_seed_that_is_begun_is_in_the_record_and_counts_for_nothing(tmp_path: Path) -> None:
    record = after([1.0]).drawn(7, LIGHT)
    record.write(tmp_path)
    assert Record.read(tmp_path).pending() == record.draws[-1]
    assert alarm_summary(tally(record)).seeds == 1


def test_a_row_whose_tail_leaves_the_window_is_named() -> None:
    """No alarm has been seen, and one is to be expected on one seed in a hundred."""
    rng = np.random.default_rng(3)
    record = after(list(np.minimum(1.0 + rng.normal(0.06, 0.017, 60), 1.099)))
    table = tally(record)
    assert table["alarms"].sum() == 0
    assert re.search(r"^Prop. 5.4, order +advance-recede +0 of 60", text(table), re.MULTILINE)
    assert alarm_summary(table).by_tail > 1e-3


def with_line(change: Callable[[str], str]) -> Callable[[bytes], bytes]:
    """A change of the second line of a packed file."""

    def changed(packed: bytes) -> bytes:
        head, line = gzip.decompress(packed).decode().splitlines(keepends=True)
        return gzip.compress((head + change(line)).encode())

    return changed


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (with_line(lambda line: line.replace(line[-3:-1], "!!")), "is damaged"),
        (with_line(lambda line: line[:-1] + "aaaa\n"), "is damaged"),
        (with_line(lambda line: line[:-2] + "\n"), "is damaged"),
        (lambda packed: packed[:-9], r"places.csv.gz is not a table"),
        (lambda packed: b"label,key", r"places.csv.gz is not a table"),
    ],
)
def test_a_damaged_record_is_refused(tmp_path: Path, damage: Callable[[bytes], bytes], message: str) -> None:
    after([1.0, 1.05]).write(tmp_path)
    path = tmp_path / "data" / "seeds" / "places.csv.gz"
    path.write_bytes(damage(path.read_bytes()))
    with pytest.raises(DataError, match=message):
        Record.read(tmp_path)


def test_a_thousand_rows_and_a_hundred_and_fifty_seeds_take_less_than_250_kB(tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    record = after(list(rng.normal(1.0, 0.02, 150)))
    (line,) = record.lines.values()
    digits = [line.places[i : i + 2] for i in range(0, len(line.places), 2)]
    known = [("(3.9)–(3.11), (4.14)", "a-long-key", f"fixed-front-off-vertex {i}", "0123456789") for i in range(1000)]
    lines = {row: replace(line, places="".join(rng.permutation(digits))) for row in known}
    replace(record, lines=lines).write(tmp_path)
    assert sum(path.stat().st_size for path in (tmp_path / "data" / "seeds").iterdir()) < 250_000


RESULTS = Path(__file__).parents[2] / "results"
TABLE, DRAWN, PLACES = "seeds.csv", "seeds/drawn.csv", "seeds/places.csv.gz"
Change = Callable[[list[str]], list[str]]


@pytest.fixture
def copied(tmp_path: Path, committed: Record, counted: pd.DataFrame, monkeypatch) -> Path:
    """A copy of the committed record and its table, which is not counted again while the record is unchanged."""
    monkeypatch.setattr(alarms, "tally", lambda record: counted if record == committed else tally(record))
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
    "the last line of the table deleted": (TABLE, without(-1)),
    "a line of the seeds deleted": (DRAWN, without(80)),
    "the last line of the places deleted": (PLACES, without(-1)),
    "a line of the table twice": (TABLE, lambda lines: [*lines, lines[-1]]),
    "a number of the table": (TABLE, changed(1, lambda text: text.replace(",100,0,", ",101,0,"))),
    "a seed twice": (DRAWN, lambda lines: [*lines[:-1], lines[5], lines[-1]]),
    "an alarm more": (DRAWN, changed(71, one_alarm_more)),
    "another part": (DRAWN, changed(5, lambda text: text.replace("whole", "light"))),
}


def test_the_committed_record_agrees_with_its_table(copied: Path) -> None:
    assert {path.name for path in compare_record(copied)} == {"seeds.csv", "drawn.csv", "places.csv.gz"}


@pytest.mark.parametrize("name", TAMPERED)
def test_a_change_is_refused(name: str, copied: Path) -> None:
    file, change = TAMPERED[name]
    path = copied / "data" / file
    content = path.read_bytes()
    packed = path.suffix == ".gz"
    lines = (gzip.decompress(content) if packed else content).decode().splitlines(keepends=True)
    assert change(lines) != lines
    text = "".join(change(lines)).encode()
    path.write_bytes(gzip.compress(text) if packed else text)
    with pytest.raises(DataError, match="seeds"):
        compare_record(copied)


@pytest.mark.parametrize("file", [TABLE, DRAWN, PLACES])
def test_a_missing_file_is_refused(file: str, copied: Path) -> None:
    (copied / "data" / file).unlink()
    with pytest.raises(DataError, match=f"{Path(file).name} is missing"):
        compare_record(copied)


def test_a_run_without_seeds_has_nothing_to_compare(tmp_path: Path) -> None:
    assert compare_record(tmp_path) == set()
