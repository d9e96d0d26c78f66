"""Tables and figures show what is in the data files, need nothing else, and are written whole or not at all."""

import re
import shutil

import numpy as np
import pandas as pd
import pytest
from committed import CASES, CORNER, LEDGER, ROUGH, SMOOTH, copy_results
from matplotlib.mathtext import MathTextParser

from study.ledger.datafiles import DataError, read_claims, read_rates, read_uncompressed
from study.ledger.files import write_packed, write_text
from study.present.article import write_tables
from study.present.drawing import draw_one
from study.present.figures import drawings, overview
from study.present.outcome import ledger_text, observed_text, orders_text, rates_text
from study.present.picture import read_pictures
from study.present.templates import encode

NAMES = ("bounds", "equivalence", "ledger", "rates", "stresses")


@pytest.fixture(scope="module")
def tables(tmp_path_factory):
    """A directory with data and tables; tests only read it."""
    directory = copy_results(tmp_path_factory.mktemp("results"), pictures=(CORNER,))
    write_text(directory / "data/claims.csv", LEDGER)
    write_tables(directory)
    return directory


@pytest.fixture
def data(tables, tmp_path):
    shutil.copytree(tables / "data", tmp_path / "data")
    return tmp_path


def files(directory):
    return sorted(path.name for path in directory.iterdir())


def test_tables_and_figures_are_written_in_every_format_and_nothing_is_left_over(data):
    write_tables(data)
    for drawing in drawings(data)[::8]:
        draw_one(data / "figures", drawing)
    assert files(data / "tables") == [f"{name}.{form}" for name in NAMES for form in ("csv", "md", "tex")]
    known = [drawing.name for drawing in drawings(data)]
    assert {f"zone-{CORNER}", f"convergence-{ROUGH}", f"enclosure-{SMOOTH}", "convergence-prop-5-3"} <= {*known}
    forms = ("csv", "pdf", "png", "txt")
    assert files(data / "figures") == sorted(f"{name}.{form}" for name in known[::8] for form in forms)


@pytest.mark.parametrize("name", NAMES)
def test_latex_is_well_formed(tables, name):
    text = (tables / f"tables/{name}.tex").read_text(encoding="utf-8")
    bare = re.sub(r"\\[{}&%]", "", text.partition("\n")[2])
    assert text.isascii()
    assert not {"$", "%"} & set(bare)
    assert bare.count("{") == bare.count("}")
    assert len({line.count("&") for line in bare.splitlines() if line.endswith(r"\\")}) == 1
    for formula in set(re.findall(r"\\\((.*?)\\\)", text)):
        MathTextParser("path").parse(f"${formula}$")


@pytest.mark.parametrize(
    ("text", "latex"),
    {
        "‖u − u^h‖_{L∞(0,T;V)} = O(h)": r"\(\|u - u^{h}\|_{L^{\infty}(0,T;V)} = O(h)\)",
        "‖u^h − u^h_lin‖_V of P_hu": r"\(\|u^{h} - u^{h}_{\mathrm{lin}}\|_{V}\) of \(P_{h}u\)",
        "order on Γ3,i, 5 % & more": r"order on \(\Gamma_{3,i}\), 5 \% \& more",
        "max_n ‖δu_n‖_V over (h,k)": r"\(\max_{n} \|\delta u_{n}\|_{V}\) over \((h,k)\)",
        "≤ 1 + 1e-7; u̇^h and h": r"\(\leq 1 + 10^{-7}\); \(\dot{u}^{h}\) and \(h\)",
        "-0.05–1.2": r"\(-0.05\)--1.2",
        "σ̃ ∈ Σ(t), u̇ in H²": r"\(\tilde{\sigma} \in \Sigma(t), \dot{u}\) in \(H^{2}\)",
        "a gap of νh and snake_case": r"a gap of \(\nu h\) and snake\_case",
        "-1.234e-09": r"\(-1.234\cdot 10^{-9}\)",
        "☃ é": r"\texttt{U+2603} é",
    }.items(),
)
def test_unicode_becomes_mathematics(text, latex):
    assert encode(text) == latex


def test_the_rate_text_has_one_line_per_case_and_family(tables):
    lines = rates_text(tables).splitlines()
    rates = read_rates(tables)
    assert len([line for line in lines if line.startswith(CASES)]) == len(rates.groupby(["case", "family"]))
    (line,) = (line for line in lines if line.startswith(SMOOTH) and "shaken" in line)
    series = rates.query("case == @SMOOTH and family == 'shaken'")
    finest = series.iloc[-1]
    *_, before, last = series["order"]
    assert f"{finest['level']}  {finest['error']:#.4g}  {finest['discrete_order']:.2f}" in re.sub(" +", "  ", line)
    assert re.search(rf" 1 .*{before:.2f} {last:.2f}$", line), "the predicted order, then observed ones"


def test_a_range_with_one_end_is_a_bound():
    assert observed_text(3.0, -np.inf, 3.2724) == "at most 3.272"
    assert observed_text(3.0, 1.5, np.inf) == "at least 1.500"
    assert observed_text(0.98, 0.97, 1.01) == "0.9800 in [0.9700, 1.010]"
    assert observed_text(np.nan, -np.inf, np.inf) == "no number"


def test_the_conclusion_says_how_far_observed_orders_are_from_the_predicted_ones(tables):
    last = ledger_text(read_claims(tables), orders_text(tables)).replace("\n", " ").rpartition("Conclusion: ")[2]
    number = r"-?\d\.\d\d"
    differ = f"observed orders of the error over two refinements differ from the predicted ones by {number} to {number}"
    assert re.fullmatch(rf"1 check contradicted a statement; {differ}\. ", last)


def test_the_ledger_text_counts_verdicts_by_statement_and_lists_what_does_not_hold(tables):
    claims = read_claims(tables)
    text = ledger_text(claims)
    assert re.search(r"^statement +cases +holds +reported +missed +undecided +fails$", text, re.MULTILINE)
    assert re.search(r"^Prop. 5.4 +‖u − u\^h‖.* [12] +[12] +1$", text, re.MULTILINE)
    fails = "fails: Prop. 5.4, advance-recede: order, criss-cross: expected 1 ± 0.1, observed "
    assert f"{fails}0.7100 in [0.6500, 0.7800]" in text.splitlines()
    assert "\nundecided: (3.1), (3.2): Γ3,i" in text
    assert "5 checks: 3 hold, 1 fail, 1 undecided, 0 missed (our own prediction was wrong), 0 reported" in text
    assert text.endswith("Conclusion: 1 check contradicted a statement.\n")
    failing = claims["verdict"] == "fails"
    reported = claims.assign(verdict="reported")
    assert "\nreported: " in ledger_text(reported)
    many = pd.concat([reported.assign(case=f"case {n}") for n in range(5)])
    assert "\nreported: " not in ledger_text(many), "reported checks are printed for few cases"
    # A label with two claims has two lines.
    text = ledger_text(claims.assign(statement=claims["statement"].mask(failing, "another claim")))
    assert re.search(r"^Prop. 5.4 +‖u − u\^h‖.* 2 +2$", text, re.MULTILINE)
    assert re.search(r"^Prop. 5.4 +another claim +1 +1$", text, re.MULTILINE)


@pytest.mark.parametrize(
    ("present", "name"),
    {write_tables: "bounds.csv", overview: "cases.csv", read_pictures: "pictures", rates_text: "rates.csv"}.items(),
)
def test_a_missing_file_is_named_with_the_command_that_makes_it(data, present, name):
    (data / "data" / name).rename(data / "data/elsewhere")
    with pytest.raises(DataError, match=rf"{name} is missing.*study run"):
        present(data)
    assert files(data) == ["data"]


@pytest.mark.parametrize(
    ("present", "name", "old", "new", "complaint"),
    [
        (overview, "rates.csv", "discrete_error", "something", "lacks the columns discrete_error"),
        (write_tables, "claims.csv", "undecided", "perhaps", "perhaps"),
        (overview, "cases.csv", ROUGH, "smooth", f"lacks the cases {ROUGH}"),
        (read_pictures, "pictures/corner.json.gz", '"zone_exact"', '"zone"', "corner.json.gz is not a picture"),
    ],
)
def test_a_damaged_file_is_named(data, present, name, old, new, complaint):
    path = data / "data" / name
    write = write_packed if path.suffix == ".gz" else write_text
    write(path, read_uncompressed(path).decode().replace(old, new))
    with pytest.raises(DataError, match=complaint):
        present(data)
    assert files(data) == ["data"]
