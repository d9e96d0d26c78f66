"""Exit codes, JSON, JUnit, Markdown and plots of ``study rates``; tables that are written and read back."""

import json
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st
from json_schema import faults_of

from study.cli.main import main
from study.orders.columns import Options, read_series

GOOD, LOW, BENT = [1, 0.25, 0.0625, 0.015625], [1, 0.5, 0.25, 0.125], [1, 0.5, 0.3, 0.08]
SCHEMA = json.loads((Path(__file__).parents[2] / "docs/reference/rates.schema.json").read_text(encoding="utf-8"))


def table(path: Path, **columns: list[float]) -> str:
    rows = zip([0.5, 0.25, 0.125, 0.0625], *columns.values(), strict=True)
    path.write_text("\n".join([",".join(["h", *columns]), *(",".join(map(str, row)) for row in rows)]))
    return str(path)


@pytest.mark.parametrize(
    ("columns", "options", "code"),
    [
        ({"a": GOOD}, [], 0),
        ({"a": LOW, "b": BENT}, [], 0),
        ({"a": GOOD}, ["--expected", "2"], 0),
        ({"a": LOW}, ["--expected", "2"], 1),
        ({"a": GOOD}, ["--expected", "1"], 1),
        ({"a": GOOD}, ["--at-least", "1"], 0),
        ({"a": BENT}, ["--expected", "2"], 3),
        ({"a": GOOD, "b": BENT}, ["--expected", "2"], 3),
        ({"a": LOW, "b": BENT}, ["--expected", "2"], 1),
        ({"a": LOW, "b": BENT}, ["--expected", "a=1"], 0),
        ({"a": GOOD, "b": [0, 0, 0, 0]}, ["--expected", "2"], 0),
        ({"b": [0, 0, 0, 0]}, ["--expected", "2"], 3),
        ({"a": LOW, "b": BENT}, ["--expected", "c=1"], 2),
        ({"a": LOW}, ["--expected", "2", "--at-least", "1"], 2),
        ({"a": LOW}, ["--expected", "-2"], 2),
        ({"a": LOW}, ["--tolerance", "0"], 2),
        ({"a": LOW}, ["--dim", "4"], 2),
        ({"a": LOW}, ["--ratio", "1"], 2),
        ({"a": LOW}, ["--columns", "z"], 2),
        ({"a": LOW}, ["--in", "z"], 2),
        ({"a": [1, -1, 1, 1]}, ["--expected", "2"], 2),
        ({"a": [1, -1, 1, 1]}, ["--values"], 0),
        ({"a": LOW}, ["--values", "--expected", "1"], 2),
        ({"a": LOW}, ["--values", "--plot", "p.png"], 2),
        ({"a": LOW}, ["--plot", "p.bmp"], 2),
    ],
)
def test_exit_codes_are_ordered_2_1_3_0(columns, options, code, tmp_path, capsys) -> None:
    assert main(["rates", table(tmp_path / "table.csv", **columns), *options]) == code
    captured = capsys.readouterr()
    assert bool(captured.err) == (code == 2)


NAMED = 'h,"L2(0,T;H1)","e, max",p = 1\n.4,.4,.4,.4\n.2,.1,.2,.1\n.1,.025,.1,.025\n'


@pytest.mark.parametrize(
    ("expected", "code"),
    [("e, max=1,L2(0,T;H1)=2", 0), ("L2(0,T;H1)=2,e, max=1", 0), ("L2(0,T;H1) = 1", 1), ("p = 1=2", 0)],
)
def test_names_with_commas_and_equal_signs_can_be_expected(expected: str, code: int, tmp_path) -> None:
    (tmp_path / "t.csv").write_text(NAMED)
    assert main(["rates", str(tmp_path / "t.csv"), "--expected", expected]) == code


@pytest.mark.parametrize("expected", ["e, max", "2,1", "two", "e, max=1,2", "2,e=1", ""])
def test_an_expectation_that_is_not_understood_is_answered_with_an_example(expected: str, capsys) -> None:
    with pytest.raises(SystemExit) as stop:
        main(["rates", "t.csv", "--expected", expected])
    assert stop.value.code == 2
    assert f"got '{expected}', expected a number such as 2, or names such as L2=2,H1=1" in capsys.readouterr().err


def test_json_has_the_documented_schema(capsys) -> None:
    read = 0
    for file in sorted((Path(__file__).parent / "cases").glob("*.*")):
        code = main(["rates", str(file), "--json", "--dim", "2", "--expected", "2"])
        output = capsys.readouterr().out
        if code != 2:
            read += 1
            entries = json.loads(output, parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))
            assert entries, file
            assert faults_of(entries, SCHEMA, SCHEMA) == [], file
            assert faults_of([entries[0] | {"verdict": "?", "more": 1}], SCHEMA, SCHEMA), file
    assert read > 20


def test_junit_and_markdown_say_what_the_terminal_says(tmp_path, capsys) -> None:
    file = table(tmp_path / "t.csv", **{"good": GOOD, "|low|": LOW, "bent": BENT, "zero": [0, 0, 0, 0]})
    outputs = ["--junit", str(tmp_path / "j.xml"), "--markdown", str(tmp_path / "m.md")]
    assert main(["rates", file, "--expected", "2", *outputs]) == 1
    suite = ElementTree.parse(tmp_path / "j.xml").getroot()
    assert {case.get("name"): [child.tag for child in case] for case in suite} == {
        "good": [], "|low|": ["failure"], "bent": ["failure"], "zero": ["skipped"],
    }  # fmt: skip
    assert (suite.get("tests"), suite.get("failures")) == ("4", "2")
    lines = (tmp_path / "m.md").read_text(encoding="utf-8").splitlines()
    assert len(lines) == 6
    assert lines[3].startswith(r"| \|low\| | fails | converges with order 1.00")
    assert "|low|: fails: converges with order 1.00" in capsys.readouterr().out


@pytest.mark.parametrize(("ending", "start"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_a_plot_is_drawn_whatever_the_errors_do(ending: str, start: bytes, tmp_path) -> None:
    columns = {"L2": GOOD, "$\\rho^{": LOW, "inf": [0, 0, 0, 0], "some": [1, 0.1, 0, 0], "nan": [1, "nan", 0.1, 0.2]}
    file = table(tmp_path / "t.csv", **columns)
    assert main(["rates", file, "--expected", "2", "--plot", str(tmp_path / f"p.{ending}")]) == 1
    assert (tmp_path / f"p.{ending}").read_bytes().startswith(start)


NUMBER = st.floats(1e-12, 1e3).map(lambda value: float(f"{value:.6g}"))
TABLES = st.integers(3, 6).flatmap(
    lambda n: st.tuples(
        st.lists(NUMBER, min_size=n, max_size=n, unique=True).filter(
            lambda h: all(a - b > 1e-4 * b for a, b in zip(sorted(h)[1:], sorted(h), strict=False))
        ),
        st.lists(st.lists(NUMBER, min_size=n, max_size=n), min_size=1, max_size=3),
    )
)


Cells = list[list[str]]
"""The names of the columns, and a list of cells for each mesh."""


def joined(sign: str, before: str = "", after: str = "") -> Callable[[Cells], str]:
    return lambda cells: "\n".join(f"{before}{sign.join(row)}{after}" for row in cells)


def markdown(cells: Cells) -> str:
    return joined(" | ", "| ", " |")([cells[0], ["---"] * len(cells[0]), *cells[1:]])


def with_orders(cells: Cells) -> str:
    columns = [[*column] for column in zip(*cells, strict=True)]
    orders = ["EOC", "-", *["1.0"] * (len(cells) - 2)]
    pairs = [columns[0], *(column for errors in columns[1:] for column in (errors, orders))]
    return markdown([[*row] for row in zip(*pairs, strict=True)])


FORMS: dict[str, Callable[[Cells], str]] = {
    "CSV": joined(","),
    "semicolons": joined(";"),
    "tabs": joined("\t"),
    "LaTeX": joined(" & ", after=r" \\"),
    "blanks": lambda cells: "\n".join("".join(f"{cell:>18}" for cell in row) for row in cells),
    "Markdown": markdown,
    "lists": lambda cells: "\n".join(f"{name} = [{', '.join(column)}]" for name, *column in zip(*cells, strict=True)),
    "name = value": lambda cells: "\n".join(
        f"{name} = {cell}" for row in cells[1:] for name, cell in zip(cells[0], row, strict=True)
    ),
    "transposed": lambda cells: joined("  ")([[*column] for column in zip(*cells, strict=True)]),
    "decimal commas": lambda cells: joined(";")([[cell.replace(".", ",") for cell in row] for row in cells]),
    "orders": with_orders,
}


@pytest.mark.parametrize("form", FORMS)
@given(drawn=TABLES)
def test_a_table_that_is_written_reads_back_the_same(form: str, drawn: tuple[list[float], list[list[float]]]) -> None:
    h, errors = drawn
    names = ["h", *(f"err{k}" for k in range(len(errors)))]
    # 1.234e3 as 1.234 and three digits would be read as thousands with decimal commas: an exponent tells.
    cells = [[f"{value:.5e}" for value in row] for row in zip(h, *errors, strict=True)]
    (series,) = read_series(FORMS[form]([names, *cells]), Options())
    assert series.h == pytest.approx(h)
    assert list(series.errors) == names[1:]
    for found, expected in zip(series.errors.values(), errors, strict=True):
        assert found == pytest.approx(expected)
