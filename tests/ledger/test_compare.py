"""Two result directories: what differs is found wherever it stands, and nothing else is."""

import gzip
import json
import shutil
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from commands import study
from places import DATA, RESULTS
from tables import texts

from study.ledger.compare import Tolerance, as_text, compare
from study.ledger.datafiles import DataError, read_uncompressed
from study.ledger.files import write_packed
from study.ledger.pictures import Packed

FILES = [path.name for path in DATA.glob("*.csv")]
SPACE = "pictures/cube-disc.json"
PLANE = "pictures/full-contact.json"


@pytest.fixture(scope="module")
def committed(tmp_path_factory):
    """The committed data; of the largest tables only one case."""
    data = tmp_path_factory.mktemp("committed") / "data"
    (data / "pictures").mkdir(parents=True)
    for path in [*DATA.glob("*.csv"), *(DATA / f"{name}.gz" for name in (SPACE, PLANE))]:
        shutil.copy(path, data / path.relative_to(DATA))
    for name in ("statements.csv", "enclosures.csv"):
        change(data.parent, name, lambda table: table[table["case"] == "full-contact"])
    (data / ".lock").touch()
    return data.parent


@pytest.fixture
def old(committed, tmp_path):
    return Path(shutil.copytree(committed, tmp_path / "old"))


@pytest.fixture
def new(old):
    return Path(shutil.copytree(old, old.with_name("new")))


def change(directory, name, how):
    path = directory / "data" / name
    how(texts(path)).to_csv(path, index=False, lineterminator="\n")


def place(directory, name, **cells):
    """The first row with some cells."""
    table = texts(directory / "data" / name)
    return int(table.index[(table[list(cells)] == pd.Series(cells)).all(axis=1)][0])


def write(directory, name, column, row, text):
    change(directory, name, lambda table: table.assign(**{column: table[column].where(table.index != row, text)}))


def repaint(directory, name, how):
    path = directory / f"data/{name}.gz"
    picture = json.loads(read_uncompressed(path))
    how(picture)
    write_packed(path, json.dumps(picture) + "\n")


def compared(old, new, relative=1e-12, absolute=0.0):
    """The comparison, after a look at both ways of presenting it."""
    comparison = compare(old, new, Tolerance(relative, absolute))
    assert max(map(len, as_text(comparison).splitlines())) <= 80
    assert json.loads(json.dumps(comparison.as_json(), allow_nan=False))["differs"] == comparison.differs
    return comparison


def told(comparison, name):
    """Column ↦ number of cells that differ."""
    cells = comparison.cells
    return dict(cells[cells["file"] == name]["column"].value_counts())


def test_the_committed_results_are_identical_to_themselves_in_no_time():
    start = time.process_time()
    comparison = compared(RESULTS, RESULTS)
    assert time.process_time() - start < 1
    assert comparison.counts["identical"] == len(comparison.states) > len(FILES)


def test_rows_in_another_order_are_the_same_and_what_other_commands_write_may_be_missing(old, new):
    for name in set(FILES) - {"enclosures.csv"}:
        change(new, name, lambda table: table[::-1])
    repaint(new, SPACE, lambda picture: None)
    (new / "data/faults.csv").unlink()
    (old / "data/seeds.csv").unlink()
    comparison = compared(old, new, 0)
    assert comparison.counts == {"identical": 2, "within": len(FILES) - 2, "differs": 0, "left out": 2}
    assert comparison.cells.empty
    assert "faults.csv: left out" in as_text(comparison)


def test_a_number_beyond_the_tolerance_is_told_with_its_row_and_both_values(old, new):
    here = {"case": "full-contact", "family": "one-diagonal"}
    row = place(new, "rates.csv", **here, level="16")
    error = float(pd.read_csv(new / "data/rates.csv")["error"][row])
    write(new, "rates.csv", "error", row, f"{error * (1 + 1e-8):.12g}")
    second = 1 + place(new, "enclosures.csv", **here, trajectory="bound", scheme="backward-euler", level="8")
    write(new, "enclosures.csv", "time", second, "0.0937500009375")
    assert not compared(old, new, 1e-7).differs
    comparison = compared(old, new, 1e-9)
    assert told(comparison, "rates.csv") == {"error": 1}
    assert told(comparison, "enclosures.csv") == {"time": 1}
    assert list(comparison.cells["relative"]) == pytest.approx([1e-8, 1e-8], rel=1e-2)
    text = " ".join(as_text(comparison).split())
    assert f"full-contact, one-diagonal, midpoint, 16: {error:.12g} → {error * (1 + 1e-8):.12g}" in text
    assert "bound, full-contact, one-diagonal, backward-euler, 8, no. 2: 0.09375 → 0.0937500009375" in text
    assert text.endswith("2 differ, 0 left out")


def test_small_numbers_have_an_absolute_tolerance_and_whole_numbers_none(old, new):
    write(new, "equivalence.csv", "energy_gap", 0, "4e-15")
    assert compared(old, new).differs
    assert not compared(old, new, absolute=1e-12).differs
    change(new, "rates.csv", lambda table: table.assign(steps=[f"{int(n) + 1}" for n in table["steps"]]))
    rows = len(pd.read_csv(new / "data/rates.csv"))
    assert told(compared(old, new, relative=0.9, absolute=10), "rates.csv") == {"steps": rows}


@pytest.mark.parametrize(("now", "differs"), {"1e-07": False, "1e-06": True, "-1e-09": True}.items())
def test_numbers_decided_by_the_tolerance_of_a_solver_are_compared_by_magnitude(old, new, now, differs):
    for directory, value in ((old, "1e-09"), (new, now)):
        write(directory, "equivalence.csv", "displacement_gap", 0, value)
    assert compared(old, new).differs == differs


def test_changed_verdicts_come_first_in_words_and_in_json(old, new, capsys):
    write(new, "rates.csv", "order", 3, "")
    write(new, "claims.csv", "verdict", place(new, "claims.csv", label="Prop. 5.4", case="full-contact"), "fails")
    head, line = as_text(compared(old, new, 1)).splitlines()[:2]
    assert head == "verdicts: 1 changed"
    assert line.strip() == "Prop. 5.4, order, full-contact: holds → fails"
    assert study(f"compare {old} {new} --json") == 1
    said = json.loads(capsys.readouterr().out)
    assert said["counts"] == {"identical": 12, "within": 0, "differs": 2, "left out": 0}
    assert said["tolerance"] == {"relative": 1e-12, "absolute": 0.0}
    assert [(cell["old"], cell["new"]) for cell in said["verdicts"]] == [("holds", "fails")]
    assert [cell["relative"] for cell in said["differences"] if cell["file"] == "rates.csv"] == [None]


@pytest.mark.parametrize(
    ("column", "name", "differs"),
    [
        ("twin", "cases.csv", True),
        ("zone", "cases.csv", True),
        ("by_error", "faults.csv", True),
        ("summary", "cases.csv", False),
        ("equation", "faults.csv", False),
        ("statement", "claims.csv", False),
    ],
)
def test_words_that_name_or_judge_differ_and_words_for_readers_do_not(old, new, name, column, differs):
    write(new, name, column, 2, "other words")
    assert told(compared(old, new, 1e9), name) == ({column: 1} if differs else {})


def test_rows_columns_and_files_in_one_directory_only_are_differences_on_whichever_side(old, new):
    change(new, "statements.csv", lambda table: table.drop(index=7))
    change(new, "enclosures.csv", lambda table: table.drop(index=15))
    change(new, "bounds.csv", lambda table: table.drop(columns="upper"))
    for name in ("stresses.csv", f"{SPACE}.gz"):
        (new / "data" / name).unlink()
    for directory, value in ((old, "1.5"), (new, "1.6")):
        (directory / "data/unknown.csv").write_text(f"name,value\na,1\na,{value}\nb,2\n")
    for first, second in ((old, new), (new, old)):
        comparison = compared(first, second, 1e9)
        assert told(comparison, "statements.csv") == dict.fromkeys(
            ("label", "case", "family", "level", "h", "value"), 1
        )
        assert {*told(comparison, "bounds.csv")} == {"upper"}
        same = [name for name, state in comparison.states.items() if state == "differs"]
        assert sorted(same) == ["bounds.csv", "enclosures.csv", SPACE, "statements.csv", "stresses.csv"]
        assert comparison.states["unknown.csv"] == "within"
    assert "row, no. 2: 1.5 → 1.6" in as_text(compared(old, new))


def test_pictures_are_compared_number_by_number_also_where_these_are_packed(old, new):
    repaint(new, SPACE, lambda picture: picture["displacement"].update(unit=2 * picture["displacement"]["unit"]))
    unpacked = Packed.read(json.loads(read_uncompressed(old / f"data/{SPACE}.gz"))["displacement"]).values
    assert told(compared(old, new), SPACE) == {"value": np.count_nonzero(unpacked)}
    repaint(new, SPACE, lambda picture: picture["times"].pop())
    assert told(compared(old, new, 1), SPACE) == {"value": 1}
    repaint(new, PLANE, lambda picture: picture.update(family="shaken", level=25))
    repaint(new, PLANE, lambda picture: picture["faces"][0]["gap"][2].__setitem__(4, 9.5))
    cells = compared(old, new, 0.01).cells
    assert {*cells[cells["file"] == PLANE]["row"]} == {".family", ".level", ".faces[0].gap[2][4]"}


PACKED = b'{"a": {"unit": 1, "shape": [2], "changes": "x"}}'
"""Compressed without the time, which would give a test another name in every process of pytest-xdist."""


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("rates.csv", b"claim,case", "rates.csv is truncated"),
        ("rates.csv", b"claim\na\n", "rates.csv lacks the columns case, family"),
        (f"{SPACE}.gz", gzip.compress(b'{"a": [', mtime=0), r"json.gz is not a picture \(Expecting"),
        (f"{SPACE}.gz", gzip.compress(PACKED, mtime=0), "json.gz is not a picture"),
        (f"{SPACE}.gz", b'{"a": [', r"json.gz is damaged \(not a complete gzip file"),
    ],
)
def test_a_damaged_file_is_refused_by_name_with_how_to_mend_it(old, new, name, content, message):
    (new / "data" / name).write_bytes(content)
    truncated = not content.endswith(b"\n")
    for first, second in ((old, new), (new, old), *[(new, new)] * truncated):
        with pytest.raises(DataError, match=f"{message}.*`study run --out {new}`"):
            compare(first, second, Tolerance())


def test_exit_codes_tell_equal_from_different_and_nothing_is_written(old, new):
    upper = float(pd.read_csv(new / "data/bounds.csv")["upper"][0])
    write(new, "bounds.csv", "upper", 0, str(upper * (1 + 3e-6)))
    before = {*old.parent.rglob("*")}
    for options, code in (("", 1), ("--tolerance 1e-5", 0), ("--absolute 1", 0)):
        assert study(f"compare {old} {new} {options}") == code
    assert {*old.parent.rglob("*")} == before
