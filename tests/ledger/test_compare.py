"""Two result directories: what differs is found wherever it stands, and nothing else is."""

from __future__ import annotations

import csv
import json
import math
import random
import re
import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study.cli.main import main
from study.ledger.compare import Comparison, Tolerance, as_json, as_text, compare
from study.ledger.compare.differences import compare_tables
from study.ledger.compare.directories import DIFFERS, IDENTICAL, LEFT_OUT, WITHIN, FileDifference
from study.ledger.compare.matching import TABLES, TableKind
from study.ledger.compare.reading import ReadTable
from study.ledger.datafiles import DataError
from study.ledger.packing import Packed

RESULTS = Path(__file__).parents[2] / "results"
PICTURES = ("cube-disc.json", "full-contact.json")
"""One in space, one in the plane."""


@pytest.fixture
def old(tmp_path: Path) -> Path:
    """The committed tables and two pictures."""
    (tmp_path / "old" / "data" / "pictures").mkdir(parents=True)
    for path in [*(RESULTS / "data").glob("*.csv"), *(RESULTS / "data" / "pictures" / name for name in PICTURES)]:
        shutil.copy(path, tmp_path / "old" / path.relative_to(RESULTS))
    return tmp_path / "old"


@pytest.fixture
def new(old: Path) -> Path:
    """The same, to be changed."""
    return Path(shutil.copytree(old, old.with_name("new")))


def change(directory: Path, name: str, how: Callable[[pd.DataFrame], pd.DataFrame | None]) -> None:
    """Edit a table in place, or replace it by what ``how`` returns."""
    path = directory / "data" / name
    table = pd.read_csv(path, dtype=str, keep_default_na=False)
    changed = how(table)
    (table if changed is None else changed).to_csv(path, index=False, lineterminator="\n")


def scaled(name: str, column: str, row: int, factor: float) -> Callable[[Path], None]:
    def one(table: pd.DataFrame) -> None:
        table.loc[row, column] = repr(float(table.loc[row, column]) * factor)

    return lambda directory: change(directory, name, one)


def written(name: str, column: str, row: int, text: str) -> Callable[[Path], None]:
    def one(table: pd.DataFrame) -> None:
        table.loc[row, column] = text

    return lambda directory: change(directory, name, one)


def file_of(found: Comparison, name: str) -> FileDifference:
    (file,) = [file for file in found.files if file.name == name]
    return file


def compared(old: Path, new: Path, relative: float = 1e-12, absolute: float = 0.0) -> Comparison:
    """The comparison, after a look at both ways of presenting it."""
    found = compare(old, new, Tolerance(relative, absolute))
    assert max(map(len, as_text(found).splitlines())) <= 80
    assert json.loads(json.dumps(as_json(found), allow_nan=False))["differs"] == found.differs
    return found


# What is the same.


def test_the_committed_results_are_identical_to_themselves_to_the_byte_in_no_time() -> None:
    start = time.process_time()
    found = compared(RESULTS, RESULTS)
    assert time.process_time() - start < 3
    assert not found.differs
    assert found.count(IDENTICAL) == len(found.files) >= len(TABLES)
    assert "rates.csv: identical bytes" in as_text(found)


def test_every_number_of_every_file_is_read_and_none_of_the_words(old: Path, new: Path) -> None:
    """All that is written with a decimal point is changed a little; all of it is found, and nothing is lost."""
    noise, changed = random.Random(0), 0
    for path in (new / "data").glob("*.csv"):
        rows = list(csv.reader(path.open(newline="", encoding="utf-8")))
        for row in rows[1:]:
            for i, cell in enumerate(row):
                if re.fullmatch(r"-?\d+\.\d+(e[+-]\d+)?", cell):
                    row[i] = repr(float(cell) * (1 + noise.uniform(1e-14, 1e-13)))
                    changed += 1
        csv.writer(path.open("w", newline="", encoding="utf-8"), lineterminator="\n").writerows(rows)
    found = compared(old, new)
    assert not found.differs
    assert {file.state for file in found.files if file.name.endswith(".csv")} == {WITHIN}
    tables = [file.found for file in found.files if file.found]
    assert sum(column.differing for table in tables for column in table.columns) == changed
    assert compared(old, new, 1e-14).differs


def test_rows_in_another_order_are_the_same_rows(old: Path, new: Path) -> None:
    for name in set(TABLES) - {"enclosures.csv"}:
        change(new, name, lambda table: table[::-1])
    found = compared(old, new)
    assert not found.differs
    assert {file.found.columns for file in found.files if file.found} == {()}


def test_nothing_is_written_but_the_lock_of_a_directory(old: Path, new: Path, capsys) -> None:
    before = {path for path in old.parent.rglob("*") if path.name != ".lock"}
    assert main(["compare", str(old), str(new)]) == 0
    assert {path for path in old.parent.rglob("*") if path.name != ".lock"} == before


# Numbers.


def test_a_number_changed_by_1e_13_is_told_and_is_no_difference(old: Path, new: Path) -> None:
    scaled("rates.csv", "error", 5, 1 + 1e-13)(new)
    found = compared(old, new)
    (column,) = file_of(found, "rates.csv").found.columns
    assert (column.name, column.differing, column.beyond) == ("error", 1, 0)
    assert column.largest.relative == pytest.approx(1e-13, rel=1e-2)
    assert not found.differs
    assert "1 within 1e-12, 0 differ" in as_text(found)


def test_a_number_changed_by_1e_3_is_a_difference_told_with_its_row_and_both_values(old: Path, new: Path) -> None:
    scaled("rates.csv", "error", 0, 1 + 1e-3)(new)
    found = compared(old, new)
    (column,) = file_of(found, "rates.csv").found.columns
    assert (column.differing, column.beyond) == (1, 1)
    assert column.largest.row == {
        "claim": "Prop. 5.4", "case": "full-contact", "family": "one-diagonal", "scheme": "midpoint", "level": "8"
    }  # fmt: skip
    text = " ".join(as_text(found).split())
    assert "Prop. 5.4, full-contact, one-diagonal, midpoint, 8: 0.741072476259 → 0.741813548735" in text
    assert text.endswith("11 identical to the byte, 0 within 1e-12, 1 differ")
    assert not compared(old, new, 1e-2).differs


def test_the_largest_difference_is_shown_of_those_beyond_the_tolerance(old: Path, new: Path) -> None:
    """Gaps at round-off differ most in relation to their size, and count for nothing."""
    scaled("equivalence.csv", "stress_gap", 0, 3)(new)
    assert compared(old, new).differs
    found = compared(old, new, absolute=1e-12)
    (column,) = file_of(found, "equivalence.csv").found.columns
    assert not found.differs
    assert (column.differing, column.beyond, column.by_absolute) == (1, 0, 1)
    assert "1 equal by --absolute alone" in as_text(found)
    written("equivalence.csv", "stress_gap", 1, "2e-12")(new)
    (column,) = file_of(compared(old, new, absolute=1e-12), "equivalence.csv").found.columns
    assert (column.differing, column.beyond, column.by_absolute) == (2, 1, 1)
    assert column.largest.new == "2e-12"


@pytest.mark.parametrize(
    ("a", "b", "equal"),
    [
        (1.0, 1.0 + 1e-3, False),
        (1000.0, 1000.0 + 0.09, True),
        (-1.0, 1.0, False),
        (0.0, 1e-6, True),
        (0.0, 1.1e-6, False),
        (1e308, -1e308, False),
        (math.inf, 1.0, False),
        (math.nan, 1.0, False),
    ],
)
def test_numbers_are_equal_within_an_absolute_and_a_relative_part(a: float, b: float, equal: bool) -> None:
    tolerance = Tolerance(relative=1e-4, absolute=1e-6)
    assert tolerance.equates(np.array([a]), np.array([b])) == tolerance.equates(np.array([b]), np.array([a])) == equal


@pytest.mark.parametrize(
    ("before", "after", "differs"),
    [("", "", 0), ("nan", "", 0), ("inf", "inf", 0), ("0.0", "-0.0", 0), ("", "1.5", 1), ("inf", "-inf", 1)]
    + [("inf", "1.5", 1), ("nan", "inf", 1)],
)
@pytest.mark.parametrize("relative", [0, 1e-12, 1e9])
def test_nan_is_nan_and_infinite_is_infinite_whatever_the_tolerance(
    old: Path, new: Path, before: str, after: str, differs: int, relative: float
) -> None:
    written("rates.csv", "order", 3, before)(old)
    written("rates.csv", "order", 3, after)(new)
    found = compared(old, new, relative)
    assert found.differs == differs
    file = file_of(found, "rates.csv")
    assert [column.largest.relative for column in (file.found.columns if file.found else ())] == [math.inf] * differs


def test_whole_numbers_have_no_tolerance(old: Path, new: Path) -> None:
    change(new, "rates.csv", lambda table: table.assign(steps=[f"{int(n) + 1}" for n in table["steps"]]))
    found = compared(old, new, relative=0.9, absolute=10)
    (column,) = file_of(found, "rates.csv").found.columns
    assert (column.name, column.beyond) == ("steps", column.cells)
    assert found.differs


# Words.


def test_a_changed_verdict_comes_first_in_words(old: Path, new: Path) -> None:
    claims = pd.read_csv(old / "data" / "claims.csv")
    where = (claims["case"] == "advance-recede") & (claims["quantity"] == "order of the error, level by level")
    written("claims.csv", "verdict", int(np.flatnonzero(where)[0]), "fails")(new)
    found = compared(old, new, 1)
    assert found.differs
    head, line = as_text(found).splitlines()[:2]
    assert head == "verdicts: 1 changed"
    assert line.strip() == "Prop. 5.4, advance-recede, order of the error, level by level: holds → fails"


def test_of_many_changed_verdicts_twenty_are_shown_and_the_others_counted(old: Path, new: Path) -> None:
    change(new, "claims.csv", lambda table: table.assign(verdict="undecided"))
    found = compared(old, new)
    text = as_text(found)
    assert text.startswith(f"verdicts: {len(found.verdicts)} changed")
    assert text.count("→ undecided") == 20 + 1, "and the first of its column"
    assert f"and {len(found.verdicts) - 20} more" in text
    assert len(as_json(found)["verdicts"]) == len(found.verdicts)


@pytest.mark.parametrize(("name", "column"), [("cases.csv", "twin"), ("controls.csv", "caught"), ("cases.csv", "zone")])
def test_words_that_name_or_judge_are_numbers_of_a_kind(old: Path, new: Path, name: str, column: str) -> None:
    written(name, column, 2, "other")(new)
    assert compared(old, new, 1e9).differs


@pytest.mark.parametrize(
    ("name", "column"),
    [("cases.csv", "summary"), ("cases.csv", "regularity"), ("controls.csv", "what"), ("claims.csv", "statement")],
)
def test_words_for_readers_are_told_and_are_no_difference(old: Path, new: Path, name: str, column: str) -> None:
    change(new, name, lambda table: table.assign(**{column: "in other words"}))
    found = compared(old, new, 0)
    assert not found.differs
    words = file_of(found, name).found.words
    assert {word.new for word in words} == {"in other words"}
    assert f"words changed: {column} in {sum(word.rows for word in words)} rows" in as_text(found)


# Rows and files.


def test_a_row_that_is_missing_is_named_on_whichever_side(old: Path, new: Path) -> None:
    case = pd.read_csv(old / "data" / "statements.csv")["case"][7]
    change(new, "statements.csv", lambda table: table.drop(index=7))
    for first, second, side in ((old, new, "OLD"), (new, old, "NEW")):
        found = compared(first, second, 1e9)
        file = file_of(found, "statements.csv")
        assert file.state == DIFFERS
        (row,) = file.found.only_old + file.found.only_new
        assert row["case"] == case
        assert f"1 row only in {side}" in as_text(found)


def test_rows_over_time_are_matched_by_their_place(old: Path, new: Path) -> None:
    scaled("enclosures.csv", "time", 1, 1 + 1e-9)(new)
    found = compared(old, new, 1e-8)
    (column,) = file_of(found, "enclosures.csv").found.columns
    assert not found.differs
    assert column.largest.row["line"] == "3"
    change(new, "enclosures.csv", lambda table: table.drop(index=15))
    assert len(file_of(compared(old, new), "enclosures.csv").found.only_old) == 1


def test_a_file_in_one_directory_only_is_a_difference(old: Path, new: Path) -> None:
    (new / "data" / "stresses.csv").unlink()
    (old / "data" / "pictures" / PICTURES[0]).unlink()
    found = compared(old, new)
    assert [(file.name, file.only) for file in found.files if file.state == DIFFERS] == [
        ("stresses.csv", "OLD"),
        (f"pictures/{PICTURES[0]}", "NEW"),
    ]
    (old / "data" / "stresses.csv").unlink()
    assert "stresses.csv" not in {file.name for file in compared(old, new).files}


@pytest.mark.parametrize("name", ["controls.csv", "seeds.csv"])
def test_what_a_command_of_its_own_writes_may_be_missing(old: Path, new: Path, name: str) -> None:
    (new / "data" / name).unlink()
    found = compared(old, new)
    assert not found.differs
    assert file_of(found, name).state == LEFT_OUT
    assert f"`study {name.removesuffix('.csv')}` writes it, not compared" in as_text(found)
    assert "1 left out" in as_text(found)


def test_a_column_in_one_directory_only_is_a_difference(old: Path, new: Path) -> None:
    change(new, "stresses.csv", lambda table: table.drop(columns="strain"))
    for first, second, side in ((old, new, "OLD"), (new, old, "NEW")):
        found = compared(first, second)
        assert found.differs
        assert f"columns only in {side}: strain" in as_text(found)


def test_a_table_that_is_not_known_is_compared_line_by_line(old: Path, new: Path) -> None:
    for directory, value in ((old, "1.5"), (new, "1.6")):
        (directory / "data" / "further.csv").write_text(f"name,value\na,1\na,{value}\nb,2\n")
    (column,) = file_of(compared(old, new), "further.csv").found.columns
    assert (column.name, column.differing, column.largest.row) == ("value", 1, {"line": "3"})
    assert not compared(old, new, 0.1).differs


# Rows whose words changed.


def keyed(table: pd.DataFrame) -> pd.DataFrame:
    """A ledger of a later version."""
    return table.assign(key=[f"row-{i}" for i in table.index], family="", window_low="0.85", window_high="1.15")


def reworded(table: pd.DataFrame) -> None:
    table.loc[[3, 900], "quantity"] = ["an order in other words", "another quantity in other words"]


def test_a_ledger_without_keys_finds_renamed_rows_by_their_numbers(old: Path, new: Path) -> None:
    change(new, "claims.csv", keyed)
    change(new, "claims.csv", reworded)
    for first, second in ((old, new), (new, old)):
        found = compared(first, second, 0)
        assert not found.differs
        claims = file_of(found, "claims.csv").found
        assert len(claims.renamed) == 2
        assert set(claims.later) == {"key", "family", "window_low", "window_high"}
        assert "2 rows renamed: found by their numbers alone" in as_text(found)
    (told,) = [file["found"]["renamed"] for file in as_json(found)["files"] if file["name"] == "claims.csv"]
    assert {before["quantity"] for before, _ in told} == {
        "an order in other words",
        "another quantity in other words",
    }


def test_a_renamed_row_with_another_verdict_is_found_and_differs(old: Path, new: Path) -> None:
    change(new, "claims.csv", reworded)
    written("claims.csv", "verdict", 3, "undecided")(new)
    found = compared(old, new)
    assert [(cell.old, cell.new) for cell in found.verdicts] == [("holds", "undecided")]


def test_a_renamed_row_with_another_number_is_in_one_directory_only(old: Path, new: Path) -> None:
    change(new, "claims.csv", reworded)
    scaled("claims.csv", "observed", 3, 1 + 1e-6)(new)
    claims = file_of(compared(old, new), "claims.csv").found
    assert (len(claims.renamed), len(claims.only_old), len(claims.only_new)) == (1, 1, 1)


def test_where_both_ledgers_have_keys_these_identify_a_verdict(old: Path, new: Path) -> None:
    for directory in (old, new):
        change(directory, "claims.csv", keyed)
    change(new, "claims.csv", reworded)
    scaled("claims.csv", "observed", 3, 1 + 1e-6)(new)
    claims = file_of(compared(old, new), "claims.csv").found
    assert (claims.renamed, claims.only_old, [column.name for column in claims.columns]) == ((), (), ["observed"])
    assert claims.columns[0].largest.row["key"] == "row-3"
    assert {word.column for word in claims.words} == {"quantity"}


# Pictures.


def repaint(directory: Path, name: str, how: Callable[[dict[str, Any]], None]) -> None:
    path = directory / "data" / "pictures" / name
    picture = json.loads(path.read_text())
    how(picture)
    path.write_text(json.dumps(picture) + "\n")


def test_a_picture_with_spaces_is_the_same_picture(old: Path, new: Path) -> None:
    repaint(new, PICTURES[0], lambda picture: None)
    found = compared(old, new, 0)
    assert file_of(found, f"pictures/{PICTURES[0]}").state == WITHIN


def test_a_number_in_a_picture_is_named_by_its_place(old: Path, new: Path) -> None:
    repaint(new, PICTURES[1], lambda picture: picture["faces"][0]["gap"][2].__setitem__(4, 9.5))
    (column,) = file_of(compared(old, new), f"pictures/{PICTURES[1]}").found.columns
    assert (column.differing, column.largest.row, column.largest.new) == (1, {"place": "faces[0].gap[2][4]"}, "9.5")


def test_packed_numbers_are_compared_unpacked(old: Path, new: Path) -> None:
    def move(picture: dict[str, Any]) -> None:
        packed = Packed.read(picture["displacement"])
        packed.multiples[3, 1, 20] += 1
        picture["displacement"] = packed.record()

    repaint(new, PICTURES[0], move)
    (column,) = file_of(compared(old, new), f"pictures/{PICTURES[0]}").found.columns
    assert (column.differing, column.largest.row) == (1, {"place": "displacement[3][1][20]"})


def test_a_list_of_another_length_and_another_word_in_a_picture_are_differences(old: Path, new: Path) -> None:
    repaint(new, PICTURES[0], lambda picture: picture["times"].pop())
    repaint(new, PICTURES[1], lambda picture: picture.update(family="shaken", level=25))
    found = compared(old, new, 1)
    first, second = (file_of(found, f"pictures/{name}").found for name in PICTURES)
    assert [row["place"] for row in (*first.only_old, *first.only_new)] == ["times", "times"]
    assert [(column.name, column.beyond, column.largest.new) for column in second.columns] == [
        ("words", 1, '"shaken"'),
        ("numbers", 1, "25"),
    ]


# What is no data.


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda d: (d / "rates.csv").write_bytes((d / "rates.csv").read_bytes()[:5000]), r"rates.csv is truncated"),
        (lambda d: (d / "rates.csv").write_bytes(b""), r"rates.csv is truncated"),
        (lambda d: (d / "rates.csv").write_bytes(b"\n"), r"rates.csv lacks the columns claim, case"),
        (
            lambda d: (d / "cases.csv").write_bytes(b'case,summary\na,"b\n'),
            r"cases.csv is not a table .*end of data",
        ),
        (lambda d: (d / "cases.csv").write_bytes(b"case\n\xff\n"), r"cases.csv is not a table .*utf-8"),
        (lambda d: (d / "cases.csv").write_bytes(b"case,law\na,b\nc\n"), r"cases.csv, line 3: 1 entries, expected 2"),
        (lambda d: (d / "cases.csv").write_bytes(b"case,law,law\na,b,c\n"), r"has the columns law twice"),
        (
            lambda d: (d / "pictures" / PICTURES[0]).write_text('{"a": ['),
            r"json is not a picture \(Expecting",
        ),
        (
            lambda d: (d / "pictures" / PICTURES[0]).write_text('{"a": {"unit": 1, "shape": [2], "changes": "x"}}'),
            rf"{PICTURES[0]} is not a picture",
        ),
    ],
)
def test_a_damaged_file_is_refused_by_name_with_how_to_mend_it(old: Path, new: Path, damage, message: str) -> None:
    damage(new / "data")
    for first, second in ((old, new), (new, old)):
        with pytest.raises(DataError, match=message) as caught:
            compare(first, second, Tolerance())
        assert f"`study run --out {new}`" in str(caught.value)


def test_a_truncated_table_is_refused_even_if_both_are(old: Path, new: Path) -> None:
    for directory in (old, new):
        (directory / "data" / "rates.csv").write_text("claim,case")
    with pytest.raises(DataError, match="truncated"):
        compare(old, new, Tolerance())


def test_a_row_that_is_there_twice_is_refused_with_its_key_and_both_lines(old: Path, new: Path) -> None:
    change(new, "rates.csv", lambda table: pd.concat([table, table.iloc[[4]]]))
    lines = len((new / "data" / "rates.csv").read_text().splitlines())
    with pytest.raises(DataError, match=rf"rates.csv, line {lines}: claim = Prop. 5.4.* stands in line 6 already"):
        compare(old, new, Tolerance())


def test_a_word_where_a_number_should_be_is_refused_with_its_line(old: Path, new: Path) -> None:
    written("stresses.csv", "strain", 2, "small")(new)
    for first, second in ((old, new), (new, old)):
        with pytest.raises(DataError, match=r"stresses.csv, line 4: strain is 'small', expected a number"):
            compare(first, second, Tolerance())


# The command.


def test_exit_codes_tell_equal_from_different_from_unusable(old: Path, new: Path, capsys) -> None:
    both = ["compare", str(old), str(new)]
    assert main(both) == 0
    scaled("bounds.csv", "upper", 1, 1 + 1e-6)(new)
    assert main(both) == 1
    assert main([*both, "--tolerance", "1e-5"]) == 0
    assert main([*both, "--absolute", "1"]) == 0
    capsys.readouterr()
    assert main(["compare", str(old), str(new / "data")]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert re.match(rf"study: {new}/data has no data/\*.csv, expected a directory of results: give ", printed.err)
    assert main(["compare", str(old / "none"), str(new)]) == 2
    assert "none is not a directory, expected" in capsys.readouterr().err


@pytest.mark.parametrize("option", ["--tolerance", "--absolute"])
@pytest.mark.parametrize("value", ["nan", "inf", "-1"])
def test_a_tolerance_that_is_none_is_refused(old: Path, capsys, option: str, value: str) -> None:
    assert main(["compare", str(old), str(old), option, value]) == 2
    assert f"{option} must be a number, 0 or more, got {value}" in capsys.readouterr().err
    with pytest.raises(SystemExit) as left:
        main(["compare", str(old), str(old), option, "little"])
    assert left.value.code == 2
    assert "'little'" in capsys.readouterr().err


def test_json_says_what_the_text_says(old: Path, new: Path, capsys) -> None:
    written("rates.csv", "order", 3, "")(new)
    written("claims.csv", "verdict", 0, "fails")(new)
    assert main(["compare", str(old), str(new), "--json"]) == 1
    told = json.loads(capsys.readouterr().out)
    assert told["differs"] is True
    assert told["states"] == {"identical": 10, "within": 0, "differs": 2, "left out": 0}
    assert told["tolerance"] == {"relative": 1e-12, "absolute": 0.0}
    assert [(cell["row"]["label"], cell["old"], cell["new"]) for cell in told["verdicts"]] == [
        ("data", "holds", "fails")
    ]
    (order,) = next(file for file in told["files"] if file["name"] == "rates.csv")["found"]["columns"]
    assert (order["name"], order["beyond"], order["largest"]["new"], order["largest"]["relative"]) == (
        ("order", 1, "", None)
    )


# The relation.

CELLS = st.sampled_from(["1.5", "1.5000000000000002", "1.50000001", "-1.5", "0", "3e-14", "", "nan", "inf", "-inf"])
ROWS = st.lists(st.tuples(st.sampled_from("ab"), st.sampled_from(["p", "q"]), CELLS, CELLS), max_size=5)
CLAIM = TableKind(("case", "quantity"), repeated=True, numbers=("observed",))


def table(rows: list[tuple[str, ...]]) -> ReadTable:
    names = ("case", "quantity", "observed", "low")
    return ReadTable(
        Path("t.csv"), {name: [row[i] for row in rows] for i, name in enumerate(names)}, [*range(len(rows))]
    )


@given(ROWS, ROWS, st.sampled_from([Tolerance(), Tolerance(1e-6), Tolerance(0, 1e-12), Tolerance(0, 0)]))
def test_the_relation_is_symmetric_and_reflexive(a, b, tolerance: Tolerance) -> None:
    there, back = (compare_tables(CLAIM, table(x), table(y), tolerance) for x, y in ((a, b), (b, a)))
    assert there.differs == back.differs
    assert (there.rows, len(there.only_old), len(there.renamed)) == (back.rows, len(back.only_new), len(back.renamed))
    assert [(c.name, c.differing, c.beyond) for c in there.columns] == [
        (c.name, c.differing, c.beyond) for c in back.columns
    ]
    assert not compare_tables(CLAIM, table(a), table(a), tolerance).differs
