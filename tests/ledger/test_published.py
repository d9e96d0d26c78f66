"""``study rates``: published tables are read strictly and judged two-sided."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from study.cli.main import main


@pytest.fixture
def table(tmp_path: Path):
    def write(text: str) -> str:
        path = tmp_path / "table.csv"
        path.write_text(text)
        return str(path)

    return write


GOOD = "n,error\n8,6.977\n16,3.536\n32,1.771\n64,0.8848\n"


def test_orders_fit_range_and_verdict_of_a_table(table, capsys) -> None:
    assert main(["rates", table(GOOD), "--expected", "1", "--json"]) == 0
    (found,) = json.loads(capsys.readouterr().out)
    assert found["orders"] == pytest.approx([0.9805, 0.9976, 1.0011], abs=1e-3)
    assert found["low"] < found["order"] < found["high"]
    assert found["asymptotic_from"] == 1 / 8
    assert found["verdict"] == "holds"
    assert found["too_good"] == [None, None, None]


def test_the_terminal_shows_every_order_and_the_verdict(table, capsys) -> None:
    assert main(["rates", table(GOOD), "--expected", "2"]) == 1
    out = capsys.readouterr().out
    assert "0.998" in out
    assert "fails" in out


def test_the_asymptotic_range_begins_after_the_last_jump(table, capsys) -> None:
    main(["rates", table("h,e\n1,1\n.5,.9\n.25,.46\n.125,.23\n.0625,.114\n"), "--json"])
    (found,) = json.loads(capsys.readouterr().out)
    assert found["asymptotic_from"] == 0.5
    assert found["verdict"] is None


def test_orders_that_never_settle_are_undecided(table, capsys) -> None:
    assert main(["rates", table("h,e\n1,1\n.5,.9\n.25,.3\n"), "--expected", "1"]) == 1
    assert "undecided" in capsys.readouterr().out


JUMP = "h,e\n1,1\n.5,.5\n.25,.2\n.125,.101\n.0625,.05\n.03125,.0249\n"
"""Orders 1, 1.32, 0.99, 1.01, 1.01."""


@pytest.mark.parametrize("expected", [["--expected", "1"], []])
def test_each_order_too_good_to_be_true_is_flagged_and_no_other(table, capsys, expected) -> None:
    main(["rates", table(JUMP), *expected, "--json"])
    (found,) = json.loads(capsys.readouterr().out)
    assert [bool(why) for why in found["too_good"]] == [False, True, False, False, False]
    main(["rates", table(JUMP), *expected])
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[:3] for line in lines if line.endswith("  too good")] == [["0.25", "0.2", "1.322"]]
    assert sum("too good to be true?" in line for line in lines) == 1


def test_what_is_too_good_depends_on_what_was_expected(table, capsys) -> None:
    twice = table("h,e\n1,1\n.5,.26\n.25,.065\n")
    main(["rates", twice, "--expected", "1"])
    assert capsys.readouterr().out.count("  too good\n") == 2
    main(["rates", twice, "--expected", "2"])
    assert "too good" not in capsys.readouterr().out


def test_orders_that_are_all_equal_look_computed(table, capsys) -> None:
    main(["rates", table("h,e\n1,1\n.5,.25\n.25,.0625\n.125,.015625\n"), "--expected", "2"])
    out = capsys.readouterr().out
    assert out.count("  too good\n") == 3
    assert "equal to six digits" in out


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("h,error\n1,1\n1,.5\n", "line 3: h = 1 stands in line 2"),
        ("h,l2,h1\n1,1,1\n.5,.25,.5\n.25,.0625,0.50\n", "line 4: h1 = 0.5 stands in line 3"),
        ("h,error\n1,1\n.5,1\n", "remove the row if it was copied, or give more digits"),
        ("h,error\n1,0\n.5,.5\n", "line 2: error = 0"),
        ("# from a paper\n\nh,error\n1,1\n.5,-1\n", "line 5: error = -1"),
        ("h,error\n1,\n.5,.5\n", "line 2: the entry of error is missing"),
        ("h,error\n1,1\n.5\n", "line 3: 1 entries, expected 2"),
        ("h,error\n1,nan\n.5,1\n", "line 2: error = nan"),
        ("h,error\n1,abc\n.5,1\n", "line 2: the entry of error is 'abc'"),
        ("x,error\n1,1\n.5,1\n", "line 1: the header is x, error"),
        ("h,error\n1,1\n", "1 level"),
        ("", "is empty"),
    ],
)
def test_a_damaged_table_is_refused_with_the_line(table, capsys, text, words) -> None:
    assert main(["rates", table(text)]) == 2
    assert words in capsys.readouterr().err


def test_several_columns_of_errors_are_judged_each(table, capsys) -> None:
    assert main(["rates", table("h,l2,h1\n1,1,1\n.5,.26,.51\n.25,.066,.257\n"), "--json"]) == 0
    assert [column["name"] for column in json.loads(capsys.readouterr().out)] == ["l2", "h1"]


def test_a_missing_file_is_refused(capsys) -> None:
    assert main(["rates", "nowhere.csv"]) == 2
    assert "no file" in capsys.readouterr().err
