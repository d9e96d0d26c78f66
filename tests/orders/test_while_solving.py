"""Errors collected while a program solves; what Python judges is what the command judges."""

import json

import pandas as pd
import pytest

from convergence_orders import ConvergenceTable, OrderError, check_orders, observed_orders, refine_until_settled


def collected(order=2.0, meshes=4):
    table = ConvergenceTable()
    for n in [4 * 2**k for k in range(meshes)]:
        table.add(h=1 / n, dofs=n**2, L2=0.3 * n**-order, H1=0.7 / n, seconds=0.1 * n)
    return table


def test_a_table_of_errors_prints_orders_beside_the_errors_and_judges_them():
    table = collected()
    assert str(table).splitlines()[0].split() == ["h", "dofs", "L2", "order", "H1", "order", "seconds"]
    assert str(table).splitlines()[-1].split()[3:6] == ["2.00", "2.187e-02", "1.00"]
    assert [result.verdict for result in table.assert_order(L2=2, H1=1).values()] == ["holds", "holds"]
    with pytest.raises(AssertionError, match=r"(?s)L2: fails: converges with order 1.50.* dofs "):
        collected(1.5).assert_order(L2=2)
    assert table.assert_order(columns="L2", L2=2).keys() == {"L2"}
    with pytest.raises(OrderError, match="got no order"):
        table.assert_order()
    with pytest.raises(OrderError, match="a row with h, expected h, dofs"):
        table.add(h=1)


@pytest.mark.parametrize("form", ["to_markdown", "to_csv", "to_latex", "__str__"])
def test_every_written_table_is_read_back_with_the_same_orders(form, rates):
    found = json.loads(rates(getattr(collected(), form)(), "--expected L2=2,H1=1 --json"))
    assert {column["name"]: column["order"] for column in found} == pytest.approx({"L2": 2, "H1": 1}, abs=1e-3)


@pytest.mark.parametrize(
    ("tail", "budget", "verdicts", "meshes"),
    [
        (3, {}, ["holds"], 6),
        (3, {"most": 4}, ["undecided"], 4),
        (-1, {}, ["fails"], 4),
        (3, {"seconds": 0}, [], 1),
    ],
)
def test_refinement_ends_when_the_order_is_settled_or_the_budget_is_used(tail, budget, verdicts, meshes):
    """The error is h² + 3 h⁴, or of the order 1."""
    table = ConvergenceTable()
    results = refine_until_settled(
        lambda level: {"h": 0.5**level, "L2": 0.25**level + 3 * 16.0**-level if tail > 0 else 0.5**level},
        table,
        expected=2,
        **budget,
    )
    assert [result.verdict for result in results.values()] == verdicts
    assert len(table) == meshes


COLUMNS = """,h,cells,L2,EOC,reduction,seconds,note,p
0,0.5,4,1,,,0.1,coarse,0.3
1,0.25,16,0.25,2,4,0.4,,0.15
2,0.125,64,0.0625,2,4,1.6,,0.075
3,0.0625,256,0.0156,2,4,6.4,fine,0.0375
"""


def test_python_judges_the_columns_that_the_command_judges(tmp_path, rates):
    path = tmp_path / "t.csv"
    path.write_text(COLUMNS)
    frame = pd.read_csv(path, index_col=0).fillna({"note": ""})
    told = {column["name"]: column["verdict"] for column in json.loads(rates(path, "--at-least 0.9 --json"))}
    assert told == {"L2": "holds", "p": "holds"}
    for table in (frame.to_dict("list"), frame, pd.read_csv(path)):
        assert {name: result.verdict for name, result in check_orders("h", table, at_least=0.9).items()} == told


@pytest.mark.parametrize(("bound", "code"), {"2e-2": 0, "1e-2": 1, "L2=2e-2": 0}.items())
def test_the_error_on_the_finest_mesh_is_bounded(bound, code, rates):
    for order in ("", "--expected 2"):
        rates("h,L2\n.5,1\n.25,.25\n.125,.0625\n.0625,.0156\n", f"--max-error {bound} {order}", code)
    assert "0.0156" in observed_orders([4, 2, 1], [1, 0.1, 0.0156], max_error=0.01).conclusion


def test_a_table_is_judged_by_the_fixture(convergence_orders):
    assert convergence_orders.table(collected(), L2=2, H1=1)["L2"].verdict == "holds"
    with pytest.raises(pytest.fail.Exception, match="L2: fails"):
        convergence_orders.table(collected(1), L2=2)
