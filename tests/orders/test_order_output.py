"""Exit codes, outputs and plots of ``study rates``; tables that are written and read back; the library."""

import itertools
import json
import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest
from commands import study
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from schemas import schema
from table_forms import FORMS, joined, markdown

from convergence_orders import OrderError, assert_order, check_orders, observed_orders
from convergence_orders.columns import Options, read_series
from convergence_orders.orders import consecutive_orders, grid_convergence
from study.bound.enclosing import order_interval

H = np.array([0.5, 0.25, 0.125, 0.0625])
SQUARES = H**2
GOOD = [1, 0.25, 0.0625, 0.015625]
LOW = [1, 0.5, 0.25, 0.125]
BENT = [1, 0.5, 0.3, 0.08]
ZERO = [0, 0, 0, 0]
SCHEMA = schema("rates")


def table(**columns):
    return pd.DataFrame({"h": H} | columns).to_csv(index=False)


CONTRADICTING = "--expected 2 --at-least 1", "--values --expected 1", "--values --plot p.png"
MEANINGLESS = "--expected -2", "--tolerance 0", "--dim 4", "--ratio 1", "--ratio 2", "--columns z", "--plot p.bmp"


SERIES = {"good": GOOD, "low": LOW, "bent": BENT, "zero": ZERO, "negative": [1, -1, 1, 1]}
CODES = {
    "good": 0,
    "good --expected 1": 1,
    "bent --expected 2": 3,
    "low,bent --expected 2": 1,
    "low,bent --expected low=1": 0,
    "good,zero --expected 2": 0,
    "zero --expected 2": 3,
    "low,bent --expected other=1": 2,
    "negative --expected 2": 2,
    "negative --values": 0,
    **{f"low {options}": 2 for options in (*CONTRADICTING, *MEANINGLESS)},
}
"""Series of errors in a table and options ↦ the exit code."""


@pytest.mark.parametrize("command", CODES)
def test_exit_codes_are_ordered_2_1_3_0(command, tmp_path, told):
    """Options that contradict each other or have no meaning are errors of use, as those of ``study rates`` show."""
    names, _, options = command.partition(" ")
    path = tmp_path / "t.csv"
    code = CODES[command]
    path.write_text(table(**{name: SERIES[name] for name in names.split(",")}))
    assert told(f"rates {path} {options}", code).startswith("study rates: ") == (code == 2)


@pytest.mark.parametrize(
    ("expected", "code"),
    {"e, max=1,L2(0,T;H1)=2": 0, "L2(0,T;H1)=2,e, max=1": 0, "L2(0,T;H1) = 1": 1, "p = 1=2": 0}.items(),
)
def test_names_with_commas_and_equal_signs_can_be_expected(expected, code, rates):
    numbers = "\n.4,.4,.4,.4\n.2,.1,.2,.1\n.1,.025,.1,.025\n"
    rates('h,"L2(0,T;H1)","e, max",p = 1' + numbers, f"--expected '{expected}'", code)


@pytest.mark.parametrize("expected", ["e, max", "2,1", "two", "e, max=1,2", ""])
def test_an_expectation_that_is_not_understood_is_answered_with_an_example(expected, told):
    said = told(f"rates t.csv --expected '{expected}'")
    assert f"got '{expected}', expected a number such as 2, or names such as L2=2,H1=1" in said


def test_json_has_the_documented_schema(capsys):
    read = 0
    for file in sorted((Path(__file__).parent / "cases").glob("*.*")):
        code = study(f"rates {file} --json --dim 2 --expected 2")
        output = capsys.readouterr().out
        if code != 2:
            read += 1
            entries = json.loads(output, parse_constant=pytest.fail)
            assert entries, file
            SCHEMA.validate(entries)
            assert not SCHEMA.is_valid([entries[0] | {"verdict": "?", "more": 1}]), file
    assert read > 20


def test_junit_and_markdown_say_what_the_terminal_says(tmp_path, rates):
    columns = {"good": GOOD, "|low|": LOW, "bent": BENT, "zero": ZERO}
    said = rates(table(**columns), f"--expected 2 --junit {tmp_path}/j.xml --markdown {tmp_path}/m.md", 1)
    suite = ElementTree.parse(tmp_path / "j.xml").getroot()
    assert {case.get("name"): [child.tag for child in case] for case in suite} == {
        "good": [], "|low|": ["failure"], "bent": ["failure"], "zero": ["skipped"],
    }  # fmt: skip
    assert suite.get("tests") == "4"
    assert suite.get("failures") == "2"
    lines = (tmp_path / "m.md").read_text(encoding="utf-8").splitlines()
    assert len(lines) == 6
    assert lines[3].startswith(r"| \|low\| | fails | converges with order 1.00")
    assert "|low|: fails: converges with order 1.00" in said


@pytest.mark.parametrize(("ending", "start"), {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}.items())
def test_a_plot_is_drawn_whatever_the_errors_do(ending, start, tmp_path, rates):
    columns = {"L2": GOOD, "$\\rho^{": LOW, "inf": ZERO, "some": [1, 0.1, 0, 0], "nan": [1, "nan", 0.1, 0.2]}
    path = tmp_path / f"p.{ending}"
    rates(table(**columns), f"--expected 2 --plot {path}", 1)
    content = path.read_bytes()
    assert content.startswith(start)
    assert ending != "svg" or len(re.findall(rb"<!-- [\d.e+-]+ -->", content)) >= 6, "three labelled ticks on both axes"


NUMBER = st.floats(1e-12, 1e3).map(lambda value: float(f"{value:.6g}"))
TABLES = arrays(float, st.tuples(st.integers(3, 6), st.integers(2, 4)), elements=NUMBER)
"""A mesh in each row, with its size in the first column and errors in the others."""


def decimal_commas(cells):
    return joined(";")([[cell.replace(".", ",") for cell in row] for row in cells])


def with_orders(cells):
    orders = ["EOC", "-", *["1.0"] * (len(cells) - 2)]
    sizes, *errors = zip(*cells, strict=True)
    pairs = [sizes, *(column for error in errors for column in (error, orders))]
    return markdown([[*row] for row in zip(*pairs, strict=True)])


@pytest.mark.parametrize("form", [*FORMS, decimal_commas, with_orders])
@given(drawn=TABLES)
def test_a_table_that_is_written_reads_back_the_same(form, drawn):
    drawn[:, 0].sort()
    h, *errors = drawn.T
    assume((h[1:] > 1.0001 * h[:-1]).all())
    names = ["h", *(f"err{k}" for k in range(len(errors)))]
    # 1.234e3 as 1.234 and three digits would be read as thousands with decimal commas: an exponent tells.
    cells = [[f"{value:.5e}" for value in row] for row in drawn]
    (series,) = read_series(form([names, *cells]), Options())
    assert series.h == pytest.approx(h)
    assert list(series.errors) == names[1:]
    for found, expected in zip(series.errors.values(), errors, strict=True):
        assert found == pytest.approx(expected)


# The library, with the worked examples of Celik et al. (2008).


@pytest.mark.parametrize(
    ("cells", "values", "kind", "order", "extrapolated", "index"),
    [
        ((18000, 8000, 4500), (6.063, 5.972, 5.863), "monotone", 1.53, 6.1685, 0.022),
        ((18000, 4500, 980), (6.0042, 5.9624, 6.0909), "oscillating", 1.51, 6.0269, 0.005),
    ],
)
def test_the_grid_convergence_index_is_the_published_one(cells, values, kind, order, extrapolated, index):
    found = grid_convergence(np.array(cells) ** -0.5, values)
    assert found.kind == kind
    assert found.order == pytest.approx(order, abs=0.01)
    assert found.extrapolated == pytest.approx(extrapolated, abs=1e-3)
    assert found.index == pytest.approx(index, abs=6e-4)
    assert grid_convergence([4, 2, 1], [1.0, 1.1, 1.5]).kind == "diverging"
    assert grid_convergence([4, 2, 1], [1.0, 1.1, 1.1]).kind == "equal values"
    # The differences are rounding.
    fine = np.array([1.0002, 1.0001, 1.0])
    assert grid_convergence(fine, 1 + 1e-9 * fine**2).kind == "undecided"


FINE = 0.5 ** np.arange(1, 8)
STAGNATING = [1, 0.25, 0.0625, 0.0156, 0.0039, 1e-4, 1e-4, 1e-4]


def test_errors_with_a_floor_fail_unless_it_is_permitted():
    for errors in (FINE**2 + 1e-4, FINE[2:] ** 2 + 1e-4):
        for wish in ({"expected": 2}, {"at_least": 0.4}):
            found = observed_orders(FINE[-len(errors) :], errors, **wish)
            assert found.verdict == "fails"
            assert "tends to 0.0001, not to 0" in found.sentence
    for errors, floors in ((FINE**2 + 1e-4, (0.9e-4, 1.1e-4)), (STAGNATING, (1e-5, 1e-3))):
        h = 0.5 ** np.arange(len(errors))
        assert [observed_orders(h, errors, 2, floor=floor).verdict for floor in floors] == ["fails", "holds"]


def test_names_with_terminal_escapes_are_printed_without_them(tmp_path, rates):
    for options, code in (("", 0), (f"--markdown {tmp_path}/m --junit {tmp_path}/j", 0), ("--columns \x1b[2J", 2)):
        printed = rates("h,e\x1b]0;x\u202e\n4,0.4\n2,0.2\n1,0.1\n", f"--at-least 0.9 {options}", code)
        assert not set(printed) & set("\x1b\u202e")
    ElementTree.parse(tmp_path / "j")
    assert "\x1b" not in (tmp_path / "m").read_text()


def test_a_broken_solver_fails_the_assertion():
    assert assert_order(H, SQUARES, expected=2).order == pytest.approx(2)
    with pytest.raises(AssertionError, match="fails"):
        assert_order(H, H, expected=2)


@pytest.mark.parametrize(
    ("orders", "wish", "verdict"),
    [
        ([0.19] * 3, 0.25, "holds"),
        ([0.19] * 3, 1, "fails"),
        ([0.1, -0.01, -0.01, -0.01], 0.1, "fails"),
        ([-2, 0.19, 0.19, 0.19], 0.25, "fails"),
        ([0.19] * 3, None, None),
    ],
)
def test_errors_with_a_small_order_stagnate_unless_it_is_expected(orders, wish, verdict):
    errors = 2.0 ** -np.cumsum([0, *orders])
    found = observed_orders(2.0 ** -np.arange(len(errors)), errors, wish)
    assert found.verdict == verdict
    assert (found.kind in ("stagnates", "grows")) == (verdict != "holds")


def test_columns_of_pandas_or_of_a_dictionary_are_judged_or_refused_by_name():
    frame = pd.DataFrame({"h": H, "L2": SQUARES, "note": ["fine"] * 4})
    assert check_orders("h", frame, 2)["L2"].verdict == check_orders(H, frame["L2"], {"L2": 2})["L2"].verdict == "holds"
    numbered = {1: H, 2: SQUARES}
    for errors in (numbered, pd.DataFrame(numbered)):
        assert {found.verdict for found in check_orders(H, errors, {1: 1, 2: 2}).values()} == {"holds"}
        assert check_orders(H, errors, at_least={2: 1.9})["1"].verdict is None
    for arguments, said in (
        (("hh", frame, 2), "hh: there is no such column; there are h, L2, note"),
        ((H, numbered, {3: 1}), "an order is expected of 3, but the columns of errors are 1, 2"),
        (([2, 1], [4.0, 1.0]), "for one list use observed_orders"),
        (([2, 1], np.ones((2, 2))), "for one list use observed_orders"),
    ):
        with pytest.raises(OrderError, match=said):
            check_orders(*arguments)


@pytest.mark.parametrize(
    ("h", "errors", "wish", "said"),
    [
        (H, 1j * SQUARES, 2, "u must be real numbers .*, got complex numbers; give absolute values"),
        (H, (e for e in SQUARES), 2, "u must be real numbers in a list or an array, got generator"),
        (map(float, H), SQUARES, 2, "h must be .* a list or an array, got map"),
        (H, ["1", "diverged", "1", "1"], 2, "u must be real numbers .*, got list: .*'diverged'"),
        (H, [10**400, 3, 2, 1], 2, "u must be real numbers .*, got list: int too large"),
        (H, [[1, 2], [3]], 2, "u must be real numbers .*, got list: "),
        (np.ma.masked_less(H, 0.1), SQUARES, 2, "mesh sizes must be positive and finite, got .*nan"),
        (H, SQUARES, "2", "expected must be one positive number, got '2'"),
        (H, SQUARES, -2, "expected must be one positive number, got -2"),
    ],
)
def test_what_is_no_number_is_refused_in_words(h, errors, wish, said):
    with pytest.raises(OrderError, match=said):
        observed_orders(h, errors, wish, name="u")


CELLS = "; or is h the number n of cells? Then give h = 1/n"


@pytest.mark.parametrize(
    ("h", "order", "said"),
    [
        ([4, 8, 16, 32], 2, True),
        ([4, 8], 2, True),
        ([4, 8, 16, 32], -2, False),
        ([1, 2, 4, 8], 2, False),
    ],
)
def test_numbers_of_cells_given_as_mesh_sizes_are_told(h, order, said):
    found = observed_orders(h, np.array(h, dtype=float) ** -order, expected=2)
    assert (CELLS in found.conclusion) == said
    assert (found.verdict == "holds") == (order < 0)


@pytest.mark.parametrize(
    ("options", "code", "said"),
    [
        ("--expected 2", 2, "give --dim 1 if h counts cells along a side, or --in h"),
        ("--expected 2 --dim 1", 0, "e: holds"),
        ("--expected 2 --in h", 1, CELLS),
    ],
)
def test_a_column_h_that_may_have_numbers_of_cells_asks_what_it_has(options, code, said, rates):
    assert said in rates("h,e\n4,1\n8,.25\n16,.0625\n32,.015625\n", options, code)


@pytest.mark.parametrize("p", [0.25, 0.5, 1, 1.5, 2, 3, 4, 6])
def test_the_order_of_values_is_found_for_every_ratio_of_meshes(p):
    for h in itertools.combinations([0.4, 0.3, 0.2, 0.15, 0.1, 0.08, 0.05, 0.01], 3):
        for limit, factor in ((1.0, 1.0), (3.0, -1.0)):
            found = grid_convergence(h, limit + factor * np.array(h) ** p)
            assert found.kind == "monotone"
            assert found.order == pytest.approx(p, rel=1e-4)
            assert found.extrapolated == pytest.approx(limit)


@given(order=st.floats(0.1, 6), digits=st.integers(1, 6))
def test_the_order_of_rounded_errors_is_known_as_an_interval_with_the_exact_order(order, digits):
    """An error with some decimals is known up to half a unit of the last one."""
    h = np.array([4.0, 2.0])
    unit = 10.0**-digits
    rounded = np.round(h**order, digits)
    low, high = order_interval(*np.transpose([rounded - unit / 2, rounded + unit / 2]), np.log(2))
    (found,) = consecutive_orders(h, rounded)
    assert low - 1e-9 <= order <= high + 1e-9
    assert low < found < high < low + 3 * unit


@pytest.mark.parametrize("term", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("order", [0.5, 1.0, 2.0, 4.0])
def test_a_term_of_higher_order_is_no_floor(order, term):
    for factor in (-0.5, 0.5, 3.0):
        found = observed_orders(FINE, FINE**order * (1 + factor * FINE**term), order)
        assert found.verdict != "fails"
        assert "tends to" not in found.sentence
    for n in (np.array([8, 16, 32, 64]), np.array([9, 17, 33, 65])):
        assert "tends to" not in observed_orders(1 / n, 7.3 / (n - 1), 1).sentence
