"""Tables and figures show what is in the data files, need nothing else, and are written whole or not at all."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from committed import CASES, CORNER, ROUGH, SMOOTH, committed, copy_results, write_ledger
from matplotlib.mathtext import MathTextParser

from study.ledger.datafiles import DataError, read_claims, read_rates, read_uncompressed
from study.ledger.files import write_packed, write_text
from study.present import outcome
from study.present.drawing import draw_figures
from study.present.figures import drawings
from study.present.notation import encode
from study.present.outcome import observed_text, orders_text, rates_text
from study.present.tables import write_tables

ROOT = Path(__file__).parents[2]
NAMES = ("bounds", "equivalence", "ledger", "rates", "stresses")
"""Names of the tables that are written."""


def ledger_text(directory: Path) -> str:
    return outcome.ledger_text(read_claims(directory))


def draw_all(directory: Path) -> list[Path]:
    return draw_figures(directory, drawings)


def draw_some(directory: Path) -> list[Path]:
    """Draw every eighth figure."""
    return draw_figures(directory, lambda directory: drawings(directory)[::8])


@pytest.fixture(scope="module")
def tables(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A directory with data and tables; tests only read it."""
    directory = copy_results(tmp_path_factory.mktemp("results"), pictures=(CORNER,))
    write_ledger(directory)
    write_tables(directory)
    return directory


@pytest.fixture(scope="module")
def drawn(tables: Path) -> Path:
    """The same directory with figures."""
    draw_some(tables)
    return tables


@pytest.fixture
def data(tables: Path, tmp_path: Path) -> Path:
    """A directory with the same data only, to damage."""
    shutil.copytree(tables / "data", tmp_path / "data")
    return tmp_path


def files(directory: Path) -> list[str]:
    return sorted(path.name for path in directory.iterdir())


def replace(path: Path, old: str, new: str) -> None:
    write = write_packed if path.suffix == ".gz" else write_text
    write(path, read_uncompressed(path).decode().replace(old, new))


def test_tables_and_figures_are_written_in_every_format_and_nothing_is_left_over(drawn: Path) -> None:
    assert files(drawn / "tables") == [f"{name}.{form}" for name in NAMES for form in ("csv", "md", "tex")]
    names = ["problem", "collapsed", "orders", "convergence", "convergence-prop-5-3", "effectivity"]
    names += [f"convergence-{case}" for case in CASES]
    enclosed = committed("enclosures").query("trajectory == 'enclosure'")
    names += [f"enclosure-{case}" for case in enclosed["case"].unique()]
    names += [f"{kind}-{CORNER}" for kind in ("zone", "profiles", "body", "energy")]
    found = [drawing.name for drawing in drawings(drawn)]
    assert sorted(found) == sorted(names)
    forms = ("pdf", "png", "svg", "txt")
    assert files(drawn / "figures") == sorted(f"{name}.{form}" for name in found[::8] for form in forms)


@pytest.mark.slow
def test_a_second_run_gives_the_same_bytes_and_loads_no_solver(drawn: Path, data: Path) -> None:
    script = (
        "import sys, pathlib, study.present.figures, study.present.tables; d = pathlib.Path(sys.argv[1]);"
        "study.present.tables.write_tables(d);"
        "study.present.drawing.draw_figures(d, lambda d: study.present.figures.drawings(d)[::8]); print(*sys.modules)"
    )
    # Another process with another hash seed: an order taken from a set would show.
    environment = os.environ | {"PYTHONHASHSEED": "7", "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", script, str(data)]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    again = sorted([*(data / "figures").iterdir(), *(data / "tables").iterdir()])
    assert len(again) >= 3 * len(NAMES) + 4 * 2
    for path in again:
        assert path.read_bytes() == (drawn / path.parent.name / path.name).read_bytes(), path.name
    solvers = ("study.fem", "study.solve", "study.statements.prop_5_4", "manufactured", "skfem")
    assert not [name for name in run.stdout.split() if name.startswith(solvers)]


def test_tables_agree_with_the_data_to_four_digits(tables: Path) -> None:
    table, source = pd.read_csv(tables / "tables" / "rates.csv"), read_rates(tables)
    names = ["h", "error", "at", "interpolation_error", "discrete_error"]
    np.testing.assert_allclose(table[names], source[names], rtol=5e-4)
    np.testing.assert_allclose(table["time_share_percent"], 100 * source["time_share"], rtol=5e-4)
    np.testing.assert_allclose(table["order"], source["order"], atol=5e-4)
    assert (table[["case", "family", "level", "dofs"]] == source[["case", "family", "level", "dofs"]]).all(axis=None)


def test_orders_in_the_tables_are_those_of_the_errors(tables: Path) -> None:
    rates, stresses = (pd.read_csv(tables / "tables" / f"{name}.csv") for name in ("rates", "stresses"))
    exact = read_rates(tables)
    for (case, family), rows in rates.groupby(["case", "family"]):
        errors = exact[(exact["case"] == case) & (exact["family"] == family)]
        expected = np.diff(np.log(errors["discrete_error"])) / np.diff(np.log(errors["h"]))
        np.testing.assert_allclose(rows["discrete_order"], [np.nan, *expected], atol=6e-4)
    measured = pd.read_csv(tables / "data" / "stresses.csv").set_index(["case", "family", "level"])
    for (case, family), rows in stresses.groupby(["case", "family"]):
        assert rows["level"].is_monotonic_increasing
        errors = measured.loc[[(case, family, level) for level in rows["level"]]]
        expected = np.diff(np.log(errors["stress"])) / np.diff(np.log(errors["h"]))
        np.testing.assert_allclose(rows["order"], [np.nan, *expected], atol=6e-4)


@pytest.mark.parametrize("name", NAMES)
def test_markdown_shows_the_cells_of_the_csv_table(tables: Path, name: str) -> None:
    """Below the headings, which have those of its first columns."""
    cells = pd.read_csv(tables / "tables" / f"{name}.csv", dtype=str, keep_default_na=False)
    text = (tables / "tables" / f"{name}.md").read_text(encoding="utf-8")
    tables = [part.splitlines()[3:] for part in re.split(r"^## .*\n", text, flags=re.MULTILINE)[1:]]
    split = [
        [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for table in tables for line in table if line
    ]
    shown = [[re.sub(r"\\(.)", r"\1", cell) for cell in row] for row in split]
    assert sorted(shown) == sorted(cells.iloc[:, -len(shown[0]) :].to_numpy().tolist())
    headings = re.findall(r"^## (.*)$", re.sub(r"\\(.)", r"\1", text), re.MULTILINE)
    first = cells.iloc[:, : -len(shown[0])].drop_duplicates().to_numpy()
    assert headings == [", ".join(value for value in row if value) for row in first]


@pytest.mark.parametrize("name", NAMES)
def test_latex_is_well_formed(tables: Path, name: str) -> None:
    text = (tables / "tables" / f"{name}.tex").read_text(encoding="utf-8")
    assert text.isascii()
    bare = re.sub(r"\\[{}&%]", "", text)
    assert bare.count("{") == bare.count("}")
    assert "$" not in bare
    assert "%" not in bare.split("\n", 1)[1]
    cells = [line.count("&") for line in bare.splitlines() if line.endswith(r"\\")]
    assert len(set(cells)) == 1, "all rows have the same number of cells"
    parser = MathTextParser("path")
    for formula in re.findall(r"\\\((.*?)\\\)", text):
        parser.parse(f"${formula}$")


@pytest.mark.parametrize(
    ("text", "latex"),
    [
        ("‖u − u^h‖_{L∞(0,T;V)} = O(h)", r"\(\|u - u^{h}\|_{L^{\infty}(0,T;V)} = O(h)\)"),
        ("‖Π^h u − u^h‖_V", r"\(\|\Pi^{h} u - u^{h}\|_{V}\)"),
        ("‖u^h − u^h_lin‖_V of P_hu", r"\(\|u^{h} - u^{h}_{\mathrm{lin}}\|_{V}\) of \(P_{h}u\)"),
        ("order on Γ3,i, 5 % & more", r"order on \(\Gamma_{3,i}\), 5 \% \& more"),
        ("max_n ‖δu_n‖_V over (h,k)", r"\(\max_{n} \|\delta u_{n}\|_{V}\) over (h,k)"),
        ("σ̃ ∈ Σ(t), u̇ in H²", r"\(\tilde{\sigma} \in \Sigma(t), \dot{u}\) in \(H^{2}\)"),
        ("a gap of νh and snake_case", r"a gap of \(\nu h\) and snake\_case"),
        ("-1.234e-09", r"\(-1.234\cdot 10^{-9}\)"),
        ("-inf", r"\(-\infty\)"),
        ("☃ é", r"\texttt{U+2603} é"),
    ],
)
def test_unicode_becomes_mathematics(text: str, latex: str) -> None:
    assert encode(text) == latex


def test_the_rate_text_has_one_line_per_case_and_family(tables: Path) -> None:
    lines, rates = rates_text(tables).splitlines(), read_rates(tables)
    (line,) = (line for line in lines if line.startswith(SMOOTH) and "shaken" in line)
    series = rates[(rates["case"] == SMOOTH) & (rates["family"] == "shaken")]
    finest = series.iloc[-1]
    assert len([line for line in lines if line.startswith(CASES)]) == len(rates.groupby(["case", "family"]))
    assert line.split()[2:5] == [str(finest["level"]), f"{finest['error']:#.4g}", f"{finest['discrete_order']:.2f}"]
    assert line.split()[6] == "1", "the predicted order"
    assert line.split()[7:] == [f"{order:.2f}" for order in series["order"].dropna()][-len(line.split()[7:]) :]


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ((3.0, -np.inf, 3.2724), "at most 3.272"),
        ((3.0, 1.5, np.inf), "at least 1.500"),
        ((0.98, 0.97, 1.01), "0.9800 in [0.9700, 1.010]"),
        ((np.nan, -np.inf, np.inf), "no number"),
    ],
)
def test_a_range_with_one_end_is_a_bound(values: tuple[float, float, float], text: str) -> None:
    assert observed_text(*values) == text


def test_the_conclusion_says_how_far_observed_orders_are_from_the_predicted_ones(tables: Path) -> None:
    claims = read_claims(tables)
    last = outcome.ledger_text(claims, orders_text(tables)).replace("\n", " ").rpartition("Conclusion: ")[2]
    assert re.fullmatch(
        r"1 check contradicted a statement; observed orders of the error differ from the predicted ones by "
        r"-?\d\.\d\d to -?\d\.\d\d\. ",
        last,
    )


def test_reported_checks_are_printed_for_few_cases(data: Path) -> None:
    claims = read_claims(data)
    reported = claims.assign(verdict=claims["verdict"].where(claims.index != 0, "reported"))
    assert re.search(r"^reported: ", outcome.ledger_text(reported), re.MULTILINE)
    many = pd.concat([reported.assign(case=f"case {n}") for n in range(5)])
    assert not re.search(r"^reported: ", outcome.ledger_text(many), re.MULTILINE)


def test_the_ledger_text_counts_verdicts_by_statement_and_lists_what_does_not_hold(tables: Path) -> None:
    text = ledger_text(tables)
    assert re.search(r"^statement +cases +holds +reported +missed +undecided +fails$", text, re.MULTILINE)
    assert re.search(r"^Prop. 5.4 +‖u − u\^h‖.* [12] +[12] +1$", text, re.MULTILINE)
    listed = (
        "fails: Prop. 5.4, advance-recede: order, criss-cross: expected 1 ± 0.1, observed 0.7100 in [0.6500, 0.7800]"
    )
    assert listed in text.splitlines()
    assert "\nundecided: (3.1), (3.2): Γ3,i" in text
    assert "5 checks: 3 hold, 1 fail, 1 undecided, 0 missed (our own prediction was wrong), 0 reported" in text
    assert text.endswith("Conclusion: 1 check contradicted a statement.\n")


def test_the_ledger_text_has_a_line_for_every_claim_of_a_label(data: Path) -> None:
    path = data / "data" / "claims.csv"
    claims = pd.read_csv(path)
    claims.loc[1, "statement"] = "another claim about Prop. 5.4"
    claims.to_csv(path, index=False)
    text = ledger_text(data)
    assert re.search(r"^Prop. 5.4 +‖u − u\^h‖.* 2 +2$", text, re.MULTILINE)
    assert re.search(r"^Prop. 5.4 +another claim about Prop. 5.4 +1 +1$", text, re.MULTILINE)


def test_the_ledger_text_says_where_there_is_no_number(data: Path) -> None:
    replace(data / "data" / "claims.csv", "0.71,0.65,0.78", ",,")
    listed = "fails: Prop. 5.4, advance-recede: order, criss-cross: expected 1 ± 0.1, observed no number"
    assert listed in ledger_text(data).splitlines()


@pytest.mark.parametrize(
    ("present", "name"),
    [
        *(
            (write_tables, name)
            for name in ("rates.csv", "claims.csv", "equivalence.csv", "stresses.csv", "bounds.csv")
        ),
        *((draw_all, name) for name in ("rates.csv", "cases.csv", "pictures")),
        (rates_text, "rates.csv"),
        (ledger_text, "claims.csv"),
    ],
)
def test_a_missing_file_is_named_with_the_command_that_makes_it(
    data: Path, present: Callable[[Path], object], name: str
) -> None:
    missing = data / "data" / name
    shutil.rmtree(missing) if missing.is_dir() else missing.unlink()
    with pytest.raises(DataError, match=rf"{name} is missing.*study run"):
        present(data)
    assert files(data) == ["data"]


@pytest.mark.parametrize(
    ("name", "old", "new", "complaint"),
    [
        ("rates.csv", "discrete_error", "something", "lacks the columns discrete_error"),
        ("claims.csv", "undecided", "perhaps", "perhaps"),
        ("cases.csv", ROUGH, "smooth", f"lacks the cases {ROUGH}"),
        ("pictures/corner.json.gz", '"zone_exact"', '"zone"', "corner.json.gz is not a picture"),
        ("pictures/corner.json.gz", '"energy"', '"zone"', "corner.json.gz is not a picture"),
        ("bounds.csv", "upper", "something", "lacks the columns upper"),
    ],
)
def test_a_damaged_file_is_named(data: Path, name: str, old: str, new: str, complaint: str) -> None:
    replace(data / "data" / name, old, new)
    with pytest.raises(DataError, match=complaint):
        (write_tables if name == "claims.csv" else draw_all)(data)
    assert files(data) == ["data"]
