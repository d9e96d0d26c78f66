"""Tables and what is refused in them; messages; observed orders, rounded bounds and numbers of the paper as texts."""

import math
import os
import shutil
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study.ledger import schema
from study.ledger.compare import difference
from study.ledger.datafiles import CsvFile, DataError, read_checked, read_table
from study.ledger.files import StoreError, write_packed, write_text, write_whole
from study.ledger.quantities import RatesError, limit, orders
from study.ledger.text import down, interval, power_of_ten, up
from study.ledger.verdict import named


def fails(path):
    raise RuntimeError("a defect")


def test_only_a_full_disk_is_called_full(tmp_path, monkeypatch):
    with pytest.raises(RuntimeError, match="a defect"):
        write_whole(tmp_path / "a.csv", fails)
    monkeypatch.setattr(shutil, "disk_usage", lambda path: SimpleNamespace(free=0))
    with pytest.raises(StoreError, match="the disk is full"):
        write_whole(tmp_path / "a.csv", fails)


@pytest.mark.parametrize("write", [write_text, write_packed])
def test_a_pipe_receives_the_content_and_remains(write, tmp_path):
    write(tmp_path / "expected", "two\nlines\n")
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write(pipe, "two\nlines\n")
    assert os.read(reader, 1000) == (tmp_path / "expected").read_bytes()
    os.close(reader)
    assert pipe.is_fifo()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["expected", "pipe"]


@pytest.mark.parametrize("exists", [True, False])
def test_a_link_is_followed_and_remains(exists, tmp_path):
    (tmp_path / "there").mkdir()
    target = tmp_path / "there/a.csv"
    link = tmp_path / "link"
    second = tmp_path / "second"
    if exists:
        target.write_text("old")
    link.symlink_to(Path("there") / "a.csv")
    second.symlink_to(link)
    write_text(second, "new")
    assert link.is_symlink()
    assert second.is_symlink()
    assert target.read_text() == "new"
    assert [*target.parent.iterdir()] == [target]


def test_what_cannot_be_written_is_refused_and_left_alone(tmp_path, monkeypatch):
    loop = tmp_path / "loop"
    folder = tmp_path / "folder"
    kept = tmp_path / "kept"
    loop.symlink_to(loop)
    folder.mkdir()
    kept.write_text("old")
    with monkeypatch.context() as patch:
        patch.setattr(os, "access", lambda path, mode: False)  # Root may write every file.
        with pytest.raises(StoreError, match=r"cannot write .*kept: Permission denied"):
            write_text(kept, "new")
    for path, reason in ((loop, "symbolic links"), (folder, "directory"), (kept / "a", "Not a directory|File exists")):
        with pytest.raises(StoreError, match=f"cannot write {path}: .*{reason}"):
            write_text(path, "new")
    nowhere = tmp_path / "nowhere"
    nowhere.symlink_to("absent")
    with pytest.raises(StoreError, match="nowhere is a symbolic link to absent, which does not exist; make"):
        write_text(nowhere / "data/a.csv", "new")
    nowhere.unlink()
    assert loop.is_symlink()
    assert folder.is_dir()
    assert kept.read_text() == "old"
    assert len([*tmp_path.iterdir()]) == 3


def test_the_words_na_and_none_are_text_and_not_empty_cells(tmp_path):
    (tmp_path / "a.csv").write_text("label,h\nNA,1\nNone,2\n,3\n", encoding="utf-8")
    assert read_table(tmp_path / "a.csv", ["label", "h"], "study run")["label"].tolist() == ["NA", "None", ""]


@pytest.mark.parametrize(
    ("row", "said"),
    {
        "1,8,,0.5,x": "column h: found '', expected a number",
        "1,8,small,0.5,x": "column h: found 'small', expected a number",
        "1,8,0.125,,x": "",
        "1,8,0.125,0.5,": "",
        "1,4,0.25,1,x": "the row series 1, level 4 is also in line 2",
    }.items(),
)
def test_a_table_is_read_with_the_units_and_the_empty_cells_of_its_columns(row, said, tmp_path, monkeypatch):
    columns = schema.columns(
        "series | count | s\nlevel | count | n\nh | 1 | s\norder | 1 | o | if unknown\nword | text | w"
    )
    monkeypatch.setitem(schema.SCHEMA, "a.csv", schema.Table(("series", "level"), columns))
    path = tmp_path / "a.csv"
    path.write_text(f"series,level,h,order,word\n1,4,0.25,1,a\n{row}\n", encoding="utf-8")
    if said:
        with pytest.raises(DataError, match=f"a.csv, line 3.*{said}"):
            read_checked(path, "a.csv", "study run")
    else:
        assert len(read_checked(path, "a.csv", "study run")) == 2


def test_a_measured_column_that_is_not_described_is_refused(tmp_path):
    with pytest.raises(KeyError, match="describe colour in"):
        CsvFile("rates.csv").write(tmp_path, [{"colour": "red"}])


def test_rows_with_one_cell_too_many_are_refused_with_their_line(tmp_path, monkeypatch):
    """pandas takes their first cells for the names of the rows."""
    monkeypatch.setitem(
        schema.SCHEMA, "a.csv", schema.Table(("level",), schema.columns("level | count | n\nh | 1 | s"))
    )
    (tmp_path / "a.csv").write_text("level,h\n4,0.25,\n8,0.125,\n", encoding="utf-8")
    with pytest.raises(DataError, match="line 2, column h: found '', expected a number"):
        read_checked(tmp_path / "a.csv", "a.csv", "study run")


def test_the_first_difference_between_a_table_and_its_expected_text_is_told(tmp_path):
    path = tmp_path / "a.csv"
    close = frozenset({"x"})
    path.write_text("name,x\na,1.0000001\nb,2\n", encoding="utf-8")
    assert difference(path, "name,x\na,1\nb,2\n", close) is None
    assert difference(path, "name,x\na,1\nb,3\n", close) == f"{path}, line 3, column x: found '2', expected '3'"
    assert difference(path, "name,x\na,1\nb,\n", close) == f"{path}, line 3, column x: found '2', expected ''"
    path.write_text("name,x\n" + 100 * "a" + "b,2\n", encoding="utf-8")
    said = difference(path, "name,x\n" + 100 * "a" + "c,2\n", close)
    assert said == f"{path}, line 2, column name: found …'{30 * 'a'}b', expected …'{30 * 'a'}c'"
    for left in ("name,x\na,1", "name,x\na,1\n\n", "name,x\na\n"):
        path.write_text(left, encoding="utf-8")
        assert "nothing" in difference(path, "name,x\na,1\n", close)


# Observed orders, rounded bounds, and numbers of the paper.


H = 1 / np.array([8.0, 16, 32, 64, 128])


@given(st.floats(0.2, 2), st.floats(0, 1))
def test_the_limit_of_a_sequence_is_found_relative_to_its_finest_errors(p, rest):
    """Zero for a pure power; a positive limit is not underestimated by the geometric means over two levels."""
    assert limit(H, 3 * H**p, p) == pytest.approx(0, abs=1e-9)
    finest = np.sqrt(np.prod((rest + 3 * H**p)[-2:]))
    assert limit(H, rest + 3 * H**p, p) >= rest / finest - 1e-9


def test_orders_need_decreasing_sizes():
    for h in (H[::-1], np.minimum(H, H[1])):
        with pytest.raises(RatesError, match="must decrease"):
            orders(h, H)


@given(value=st.floats(-1e9, 1e9), digits=st.integers(1, 8))
def test_a_number_rounded_down_is_not_larger_and_one_rounded_up_not_smaller(value, digits):
    below = Fraction(down(value, digits))
    above = Fraction(up(value, digits))
    assert below <= Fraction(value) <= above
    assert above - below <= Fraction(10) ** (1 - digits) * max(abs(below), abs(above))


def test_an_interval_grows_and_has_no_crossed_ends():
    assert interval(0.857705, 1.02904, 4) == "[0.8577, 1.03]"
    assert interval(-0.12345, 0.25, 3) == "[-0.124, 0.25]"
    with pytest.raises(ValueError, match=r"from 0\.3252 to 0\.3071 has crossed ends"):
        interval(0.3252, 0.3071, 4)


@given(value=st.floats(1e-30, 1e30))
def test_a_power_of_ten_is_the_least_that_is_not_smaller(value):
    found = power_of_ten(value, 0.0)
    assert found == float(f"1e{round(math.log10(found))}")
    assert value <= found
    assert float(f"1e{round(math.log10(found)) - 1}") < value


def test_a_range_ends_in_its_section():
    with pytest.raises(ValueError, match="write a range for each"):
        named("(4.28)–(5.3)")
