"""Errors collected while a program solves; what Python judges is what the command judges."""

import json

import pandas as pd
import pytest

from convergence_orders import ConvergenceTable, OrderError, check_orders, observed_orders, refine_until_settled
from convergence_orders.command import main


def collected(order: float = 2.0, meshes: int = 4) -> ConvergenceTable:
    table = ConvergenceTable()
    for n in [4 * 2**k for k in range(meshes)]:
        table.add(h=1 / n, dofs=n**2, L2=0.3 * n**-order, H1=0.7 / n, seconds=0.1 * n)
    return table


def test_a_table_of_errors_prints_orders_beside_the_errors_and_judges_them() -> None:
    table = collected()
    assert str(table).splitlines()[0].split() == ["h", "dofs", "L2", "order", "H1", "order", "seconds"]
    assert str(table).splitlines()[-1].split()[3:6] == ["2.00", "2.187e-02", "1.00"]
    assert {name: result.verdict for name, result in table.assert_order(L2=2, H1=1).items()} == {
        "L2": "holds", "H1": "holds",
    }  # fmt: skip
    with pytest.raises(AssertionError, match=r"(?s)L2: fails: converges with order 1.50.* dofs "):
        collected(1.5).assert_order(L2=2)
    assert collected().assert_order(columns="L2", L2=2).keys() == {"L2"}
    with pytest.raises(OrderError, match="got no order"):
        table.assert_order()
    with pytest.raises(OrderError, match="a row with h, expected h, dofs"):
        table.add(h=1)


@pytest.mark.parametrize("form", ["to_markdown", "to_csv", "to_latex", "__str__"])
def test_every_written_table_is_read_back_with_the_same_orders(form: str, tmp_path, capsys) -> None:
    (tmp_path / "t").write_text(getattr(collected(), form)())
    assert main([str(tmp_path / "t"), "--expected", "L2=2,H1=1", "--json"]) == 0
    columns = {column["name"]: column["order"] for column in json.loads(capsys.readouterr().out)}
    assert columns == pytest.approx({"L2": 2, "H1": 1}, abs=1e-3)


def test_refinement_ends_when_the_order_is_settled_or_the_budget_is_used() -> None:
    def rows(level: int) -> dict[str, float]:
        h = 0.5**level
        return {"h": h, "L2": h**2 + 3 * h**4}

    table = ConvergenceTable()
    (result,) = refine_until_settled(rows, table, expected=2).values()
    assert (result.verdict, len(table)) == ("holds", 6)
    table = ConvergenceTable()
    (result,) = refine_until_settled(rows, table, most=4, expected=2).values()
    assert (result.verdict, len(table)) == ("undecided", 4)
    (result,) = refine_until_settled(lambda level: {"h": 0.5**level, "L2": 0.5**level}, expected=2).values()
    assert (result.verdict, len(result.h)) == ("fails", 4)
    table = ConvergenceTable()
    assert (refine_until_settled(rows, table, seconds=0, expected=2), len(table)) == ({}, 1)


COLUMNS = {
    "h": [0.5, 0.25, 0.125, 0.0625],
    "cells": [4, 16, 64, 256],
    "L2": [1, 0.25, 0.0625, 0.0156],
    "EOC": [float("nan"), 2, 2, 2],
    "reduction": [float("nan"), 4, 4, 4],
    "seconds": [0.1, 0.4, 1.6, 6.4],
    "note": ["coarse", "", "", "fine"],
    "p": [0.3, 0.15, 0.075, 0.0375],
}


def test_python_judges_the_columns_that_the_command_judges(tmp_path, capsys) -> None:
    pd.DataFrame(COLUMNS).to_csv(tmp_path / "t.csv", index=False)
    main([str(tmp_path / "t.csv"), "--at-least", "0.9", "--json"])
    told = {column["name"]: column["verdict"] for column in json.loads(capsys.readouterr().out)}
    assert told == {"L2": "holds", "p": "holds"}
    for table in (COLUMNS, pd.DataFrame(COLUMNS)):
        assert {name: result.verdict for name, result in check_orders("h", table, at_least=0.9).items()} == told


@pytest.mark.parametrize(("bound", "code"), [("2e-2", 0), ("1e-2", 1), ("L2=2e-2", 0)])
def test_the_error_on_the_finest_mesh_is_bounded(bound: str, code: int, tmp_path) -> None:
    (tmp_path / "t.csv").write_text("h,L2\n.5,1\n.25,.25\n.125,.0625\n.0625,.0156\n")
    for order in ([], ["--expected", "2"]):
        assert main([str(tmp_path / "t.csv"), "--max-error", bound, *order]) == code
    assert observed_orders([2, 1], [2, 1], max_error=0.5).verdict == "fails"
    assert "0.0156" in observed_orders([4, 2, 1], [1, 0.1, 0.0156], max_error=0.01).conclusion


@pytest.mark.parametrize("header", ["degree,L2", "p,error", "polynomial degree,H1"])
def test_errors_against_the_degree_are_refused_by_name(header: str, tmp_path, capsys) -> None:
    (tmp_path / "t.csv").write_text(f"{header}\n1,1e-1\n2,1e-2\n3,1e-3\n4,1e-4\n")
    for options in ([], ["--in", header.split(",")[0]]):
        assert main([str(tmp_path / "t.csv"), "--expected", "2", *options]) == 2
        assert "(p-refinement)" in capsys.readouterr().err


@pytest.mark.parametrize("nested", [
    {"results": [{"h": h, "errors": {"L2": h**2}} for h in (0.5, 0.25, 0.125)]},
    {"run": {"h": [0.5, 0.25, 0.125], "errors": {"L2": [1, 0.25, 0.0625]}}},
])  # fmt: skip
def test_nested_json_is_read(nested, tmp_path, capsys) -> None:
    (tmp_path / "t.json").write_text(json.dumps(nested))
    assert main([str(tmp_path / "t.json"), "--expected", "2"]) == 0, capsys.readouterr().err
    assert "L2: holds" in capsys.readouterr().out


def test_every_list_of_sizes_in_json_begins_a_series(tmp_path, capsys) -> None:
    runs = {
        name: {"h": [0.5, 0.25, 0.125], "L2": errors} for name, errors in (("P1", [4, 1, 0.25]), ("P2", [8, 1, 0.125]))
    }
    (tmp_path / "t.json").write_text(json.dumps(runs))
    assert main([str(tmp_path / "t.json"), "--expected", "series 1=2,series 2=3"]) == 0, capsys.readouterr().err


def test_a_table_is_judged_by_the_fixture(convergence_orders) -> None:
    assert convergence_orders.table(collected(), L2=2, H1=1)["L2"].verdict == "holds"
    with pytest.raises(pytest.fail.Exception, match="L2: fails"):
        convergence_orders.table(collected(1), L2=2)
