"""Tables and figures show what is in the data files, need nothing else, and are written whole or not at all."""

from __future__ import annotations

import ast
import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.mathtext import MathTextParser
from numpy.typing import NDArray

from study.fem.mesh import OneDiagonal
from study.fem.naming import resolve
from study.ledger.datafiles import DataError, read_claims, read_rates
from study.ledger.files import StoreError, write_text, write_whole
from study.ledger.packing import FINE, Packed
from study.present import outcome
from study.present.figures import draw_figures, drawings
from study.present.notation import encode
from study.present.outcome import rates_text
from study.present.tables import write_tables
from study.solve.motion import Motion
from study.statements.pictures import record

Array = NDArray[np.float64]
Present = Callable[[Path], object]


def ledger_text(directory: Path) -> str:
    return outcome.ledger_text(read_claims(directory))


Function = Callable[[Array, float], Array]
Side = tuple[tuple[float, float], Function, Function]
"""Inward normal of a side of the unit square, its gap w(s, t) and its pressure p(s, t)."""

STUDY = Path(__file__).parents[2] / "study"
SOURCES = sorted((STUDY / "present").rglob("*.py"))
SOLVERS = ("study.fem", "study.solve", "study.statements.prop_5_4", "manufactured", "skfem")

LEVELS = (8, 16, 32, 64)
FAMILIES = {"one-diagonal": (1.0, 1.9), "criss-cross": (0.72, 1.8), "shaken": (1.08, 1.15), "unstructured": (0.9, 1.1)}
"""Size of the error relative to the first, and order of the discrete error."""
CASES = {"advance-recede": (1.0, 28.0), "rough-1.75": (0.25, 1.4)}
"""Expected order and size of the error."""
SOLID = "cube-two-faces"


def rates(cases: dict[str, tuple[float, float]], levels: Sequence[int]) -> pd.DataFrame:
    """Errors of the size and order that the study sees, in the columns of ``rates.csv``."""
    n = np.array(levels, dtype=float)
    series = []
    for case, (order, size) in cases.items():
        for family, (factor, discrete) in FAMILIES.items():
            h = (0.7 if family == "criss-cross" else 1.0) / n
            error = factor * size * h**order * (1 + 0.8 * h)
            columns = {
                "claim": "Prop. 5.4" if order == 1 else "Prop. 5.3",
                "case": case,
                "family": family,
                "scheme": "midpoint",
                "dim": 2,
                "level": levels,
                "h": h,
                "dofs": (2 * n * (n + 1)).astype(int),
                "steps": np.ceil(8 * n ** (2 / 3)).astype(int),
                "error": error,
                "at": 0.4375,
                "interpolation_error": 0.9 * error,
                "discrete_error": 0.5 * factor * size * h ** (discrete * (1 + order) / 2),
                "time_share": 0.004 * n**0.2,
                "predicted_interpolation": factor * size * h**order,
                "order": [np.nan, *np.log(error[:-1] / error[1:]) / np.log(h[:-1] / h[1:])],
            }
            series.append(pd.DataFrame(columns))
    return pd.concat(series)


def claims() -> pd.DataFrame:
    """A ledger with every verdict, a statement without a case, and text that is hard on LaTeX and Markdown."""
    columns = ["label", "statement", "case", "quantity", "expected", "observed", "low", "high", "verdict"]
    columns += ["key", "family", "window_low", "window_high"]
    order = "‖u − u^h‖_{L∞(0,T;V)} = O(h)"
    long = "Γ3,i: eigenvalues of A" + 9 * ", and more"
    rows: list[list[object]] = [
        ["Prop. 5.4", order, "advance-recede", "order, shaken, 32 → 64", "1 ± 0.1", "0.98765", 0.95, 1.02, "holds"],
        ["Prop. 5.4", order, "advance-recede", "order, criss-cross", "1 ± 0.1", "0.71", 0.65, 0.78, "fails"],
        ["Prop. 5.4", order, "two_faces", "time |δ| in max_n e_n", "< 5 %", "0.0123", None, None, "holds"],
        ["(3.1), (3.2)", "m_A ε:ε ≤ Aε:ε & L_G", "", long, "≥ 2", "2.0", None, None, "undecided"],
        ["Thm 4.2", "σ̃ ∈ Σ(t) ⇔ u̇ solves Problem 3.1", "two_faces", "gap", "0", "1.2e-09", -np.inf, 1e-8, "holds"],
    ]
    identities: list[list[object]] = [
        ["order", "shaken", 0.9, 1.1],
        ["order", "criss-cross", 0.9, 1.1],
        ["time", "", 0.0, 0.05],
        ["least", "", 2.0, np.inf],
        ["gap", "", 0.0, 0.0],
    ]
    return pd.DataFrame([row + identity for row, identity in zip(rows, identities, strict=True)], columns=columns)


def draw_all(directory: Path) -> list[Path]:
    return draw_figures(directory, drawings)


def equivalence() -> pd.DataFrame:
    """Problem 3.2 against Problem 3.1 at solver tolerance and on the equilibrium space."""
    rows = [
        ["advance-recede", "strains of V^h", 8, 0.125, 32, 3.2e-9, 1.7e-9, 2e-12, -4e-12, 1e-11, 1e-7, 2e-7],
        ["advance-recede", "equilibrium triangles", 8, 0.125, 32, 0.21, 0.34, 0.0, 1.3e-3, 0.0, 0.5, 0.5],
    ]
    gaps = ["displacement_gap", "stress_gap", "admissibility", "energy_gap", "membership"]
    bounds = ["displacement_bound", "stress_bound"]
    return pd.DataFrame(rows, columns=["case", "form", "level", "h", "steps", *gaps, *bounds])


def stresses() -> pd.DataFrame:
    """Problem 3.2 on a stress space of its own."""
    columns = [
        "case",
        "family",
        "level",
        "h",
        "steps",
        "unknowns",
        "stress",
        "stress_sup",
        "best",
        "strain",
        "pressure",
    ]
    columns += ["displacement", "primal_stress", "primal_displacement", "admissibility", "time_share"]
    rows = [
        ["advance-recede", "shaken", n, 1 / n, 2 * n, 8 * n**2, *[1 / n**2] * 6, 1 / n, 2 / n**2, 1e-14, 0.1 / n]
        for n in (16, 8)
    ]
    return pd.DataFrame(rows, columns=columns)


def bounds() -> pd.DataFrame:
    """One enclosure."""
    names = ["trajectory", "case", "family", "scheme", "level", "lowest", "error", "highest", "upper", "lower"]
    row = ["enclosure", "advance-recede", "shaken", "midpoint", 8, 1.9, 2.0, 2.2, 1.1, 0.95, 0.01, 0.02, 0.003]
    return pd.DataFrame([row], columns=[*names, "residual", "oscillation", "contact"])


def enclosures() -> pd.DataFrame:
    """One enclosure over time."""
    times = np.linspace(0, 1, 9)
    columns = {"error": 2 - times / 2, "distance": 1.9 - times / 2, "bound": 0.2 + 0 * times}
    place = {"trajectory": "enclosure", "case": "advance-recede", "family": "shaken", "level": 8}
    return pd.DataFrame({"time": times, **columns}).assign(**place)


def picture(case: str, level: int, steps: int, sides: Sequence[Side]) -> dict[str, Any]:
    """A lifted displacement on the unit square with contact on some sides, in the form of ``pictures/CASE.json``."""
    grid, times = np.linspace(0, 1, level + 1), np.linspace(0, 1, steps + 1)
    x = np.array([values.ravel() for values in np.meshgrid(grid, grid)])
    a = np.add.outer(np.arange(level) * (level + 1), np.arange(level)).ravel()
    cells = np.hstack([[a, a + 1, a + level + 2], [a, a + level + 2, a + level + 1]])
    displacement = np.array([sum(lift(x, side, t) for side in sides) for t in times])
    return {
        "case": case,
        "family": "one-diagonal",
        "level": level,
        "times": times.tolist(),
        "vertices": x.tolist(),
        "cells": cells.tolist(),
        "shapes": [0.0, 0.5, 1.0],
        "displacement": Packed.of(displacement).record(),
        "faces": [contact_face(number, grid, times, side) for number, side in enumerate(sides, start=1)],
        "von_mises": Packed.of(np.multiply.outer(times, x[0, cells[0]])).record(),
        "energy": energy(times),
    }


@cache
def solid() -> str:
    """The picture of a cube on a coarse mesh; solved, as the surface of a body in space is tedious to write down."""
    return json.dumps(record(SOLID, Motion.of(resolve(SOLID).solution, OneDiagonal(), 3, 16), 1))


def energy(times: Array) -> dict[str, Any]:
    """A load of power 2t, of which half is stored; a thousandth of its work is lost."""
    half = times**2 / 2
    series = {"times": times, "stored": half, "dissipated": half, "contact": 0 * half, "work": 1.001 * times**2}
    return {name: values.tolist() for name, values in series.items()} | {"defect": (-0.001 * times**2).tolist()}


def lift(x: Array, side: Side, t: float) -> Array:
    """u_s = −y w' φ and u_n = (w − y p/3) φ, with the memory of the material left out."""
    normal, gap, pressure = np.array(side[0]), *side[1:]
    along = abs(normal[::-1])
    s, y = along @ x, normal @ x + (normal.sum() < 0)
    slope = (gap(s + 1e-5, t) - gap(s - 1e-5, t)) / 2e-5
    values = np.multiply.outer(normal, gap(s, t) - y * pressure(s, t) / 3) - np.multiply.outer(along, y * slope)
    return np.asarray(values * (1 - y) ** 2 * (1 + 2 * y))


def contact_face(number: int, s: Array, times: Array, side: Side) -> dict[str, Any]:
    """The entry of ``faces``; what is computed is the exact value with a small disturbance where there is contact."""
    normal, gap, pressure = np.array(side[0]), *side[1:]
    foot = float(normal.sum() < 0)
    exact = {"gap": np.array([gap(s, t) for t in times]), "pressure": np.array([pressure(s, t) for t in times])}
    fine = np.linspace(0, 1, 2001)
    instants = np.linspace(0, 1, 101)
    return {
        "face": number,
        "normal": (-normal).tolist(),
        "s": s.tolist(),
        "x": (np.multiply.outer(abs(normal[::-1]), s) + abs(normal)[:, None] * foot).tolist(),
        "gap": (exact["gap"] * 1.01).tolist(),
        "gap_exact": exact["gap"].tolist(),
        "pressure": (exact["pressure"] * (1 + 0.05 * np.sin(40 * s))).tolist(),
        "pressure_exact": exact["pressure"].tolist(),
        "line": {
            "s": fine[::20].tolist(),
            "gap": Packed.of(np.array([gap(fine[::20], t) for t in times]), FINE).record(),
            "pressure": Packed.of(np.array([pressure(fine[::20], t) for t in times]), FINE).record(),
        },
        "zone_exact": {"times": instants.tolist(), "intervals": [intervals(fine, gap(fine, t)) for t in instants]},
    }


def intervals(s: Array, gap: Array) -> list[list[float]]:
    """Where the gap vanishes."""
    edges = np.diff(np.concatenate([[0], (gap == 0).astype(int), [0]]))
    return [[float(s[a]), float(s[b - 1])] for a, b in zip(*(np.flatnonzero(edges == e) for e in (1, -1)), strict=True)]


def advancing(s: Array, t: float) -> Array:
    """s − c(t): the distance from a front that comes and goes."""
    return s - (0.25 + 2 * t * (1 - t))


def patches(s: Array, t: float) -> Array:
    """The distance from two patches that are born, meet and vanish."""
    return np.minimum(abs(s - 0.32), abs(s - 0.68)) - 1.1 * (t - 0.1) * (0.95 - t)


def side(normal: tuple[float, float], distance: Function) -> Side:
    """A side whose gap and pressure have the regularity of Prop. 5.4."""
    return normal, lambda s, t: 20 * distance(s, t).clip(0) ** 4, lambda s, t: 20 * (-distance(s, t)).clip(0) ** 2


BOTTOM, RIGHT = side((0.0, 1.0), advancing), side((-1.0, 0.0), patches)


def write_data(directory: Path, cases: dict[str, tuple[float, float]], levels: Sequence[int], level: int) -> Path:
    """All data files of a run; pictures at one level."""
    (directory / "data" / "pictures").mkdir(parents=True)
    frames = {
        "rates": rates(cases, levels),
        "claims": claims(),
        "equivalence": equivalence(),
        "stresses": stresses(),
        "bounds": bounds(),
        "enclosures": enclosures(),
    }
    listed = [{"case": case, "expected_order": order} for case, (order, _) in cases.items()]
    others = [{"case": case, "expected_order": 1.0} for case in ("two-faces", SOLID)]
    frames["cases"] = pd.DataFrame([*listed, *others])
    for name, frame in frames.items():
        frame.to_csv(directory / "data" / f"{name}.csv", index=False)
    steps = round(8 * level ** (2 / 3))
    for case, sides in {"advance-recede": [BOTTOM], "two-faces": [BOTTOM, RIGHT]}.items():
        plane = picture(case, level, steps, sides)
        (directory / "data" / "pictures" / f"{case}.json").write_text(json.dumps(plane))
    (directory / "data" / "pictures" / f"{SOLID}.json").write_text(solid())
    return directory


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A directory with data, tables and figures; tests only read it."""
    directory = write_data(tmp_path_factory.mktemp("results"), CASES, LEVELS, level=8)
    write_tables(directory)
    draw_figures(directory, drawings)
    return directory


@pytest.fixture
def data(drawn: Path, tmp_path: Path) -> Path:
    """A directory with the same data only, to spoil."""
    shutil.copytree(drawn / "data", tmp_path / "data")
    return tmp_path


def files(directory: Path) -> list[str]:
    return sorted(path.name for path in directory.iterdir())


def replace(path: Path, old: str, new: str) -> None:
    path.write_text(path.read_text(encoding="utf-8").replace(old, new), encoding="utf-8")


def test_every_table_is_written_in_three_formats_and_nothing_is_left_over(drawn: Path) -> None:
    expected = [
        f"{name}.{form}"
        for name in ("bounds", "equivalence", "ledger", "rates", "stresses")
        for form in ("csv", "md", "tex")
    ]
    assert files(drawn / "tables") == expected


def test_every_figure_is_written_in_three_formats_with_a_caption_and_nothing_is_left_over(drawn: Path) -> None:
    names = ["problem", "collapsed", "convergence", "convergence-prop-5-3", "effectivity", "enclosure-advance-recede"]
    names += [f"convergence-{case}" for case in CASES]
    kinds = ("zone", "profiles", "body", "energy")
    names += [f"{kind}-{case}" for kind in kinds for case in ("advance-recede", "two-faces", SOLID)]
    forms = ("pdf", "png", "svg", "txt")
    assert files(drawn / "figures") == sorted(f"{name}.{form}" for name in names for form in forms)


def test_a_second_run_gives_the_same_bytes_and_loads_no_solver(drawn: Path, data: Path) -> None:
    script = (
        "import sys, pathlib, study.present.figures, study.present.tables; d = pathlib.Path(sys.argv[1]);"
        "study.present.tables.write_tables(d);"
        "study.present.figures.draw_figures(d, study.present.figures.drawings); print(*sys.modules)"
    )
    # Another process with another hash seed: an order taken from a set would show.
    environment = os.environ | {"PYTHONHASHSEED": "7", "PYTHONPATH": str(STUDY.parent)}
    command = [sys.executable, "-c", script, str(data)]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    for path in sorted([*(drawn / "figures").iterdir(), *(drawn / "tables").iterdir()]):
        assert path.read_bytes() == (data / path.parent.name / path.name).read_bytes(), path.name
    assert not [name for name in run.stdout.split() if name.startswith(SOLVERS)]


@pytest.mark.parametrize("source", SOURCES, ids=lambda path: str(path.relative_to(STUDY)))
def test_presentation_imports_nothing_that_solves_or_judges(source: Path) -> None:
    nodes = list(ast.walk(ast.parse(source.read_text(encoding="utf-8"))))
    imported = [alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names]
    imported += [node.module or "" for node in nodes if isinstance(node, ast.ImportFrom)]
    of_ours = [name for name in imported if name.startswith(("study", "manufactured"))]
    assert [name for name in of_ours if not name.startswith(("study.ledger", "study.present"))] == []


def test_tables_agree_with_the_data_to_four_digits(drawn: Path) -> None:
    table, source = pd.read_csv(drawn / "tables" / "rates.csv"), read_rates(drawn)
    names = ["h", "error", "at", "interpolation_error", "discrete_error"]
    np.testing.assert_allclose(table[names], source[names], rtol=5e-4)
    np.testing.assert_allclose(table["time_share_percent"], 100 * source["time_share"], rtol=5e-4)
    np.testing.assert_allclose(table["order"], source["order"], atol=5e-4)
    assert (table[["case", "family", "level", "dofs"]] == source[["case", "family", "level", "dofs"]]).all(axis=None)


def test_the_discrete_order_is_that_of_the_discrete_error(drawn: Path) -> None:
    table = pd.read_csv(drawn / "tables" / "rates.csv")
    for (case, family), series in table.groupby(["case", "family"]):
        order = FAMILIES[str(family)][1] * (1 + CASES[str(case)][0]) / 2
        np.testing.assert_allclose(series["discrete_order"], [np.nan, *[order] * (len(LEVELS) - 1)], atol=6e-4)


def test_the_table_of_stresses_has_levels_in_order_with_their_orders(drawn: Path) -> None:
    table = pd.read_csv(drawn / "tables" / "stresses.csv")
    assert table["level"].tolist() == [8, 16]
    np.testing.assert_allclose(table["order"], [np.nan, 2.0])
    np.testing.assert_allclose(table["time_share_percent"], [1.25, 0.625])


@pytest.mark.parametrize("name", ["rates", "ledger", "equivalence", "stresses", "bounds"])
def test_markdown_shows_the_cells_of_the_csv_table(drawn: Path, name: str) -> None:
    """Below the headings, which have those of its first columns."""
    cells = pd.read_csv(drawn / "tables" / f"{name}.csv", dtype=str, keep_default_na=False)
    text = (drawn / "tables" / f"{name}.md").read_text(encoding="utf-8")
    tables = [part.splitlines()[3:] for part in re.split(r"^## .*\n", text, flags=re.MULTILINE)[1:]]
    split = [
        [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for table in tables for line in table if line
    ]
    shown = [[re.sub(r"\\(.)", r"\1", cell) for cell in row] for row in split]
    assert sorted(shown) == sorted(cells.iloc[:, -len(shown[0]) :].to_numpy().tolist())
    headings = re.findall(r"^## (.*)$", re.sub(r"\\(.)", r"\1", text), re.MULTILINE)
    first = cells.iloc[:, : -len(shown[0])].drop_duplicates().to_numpy()
    assert headings == [", ".join(value for value in row if value) for row in first]


@pytest.mark.parametrize("name", ["rates", "ledger", "equivalence", "stresses", "bounds"])
def test_latex_is_well_formed(drawn: Path, name: str) -> None:
    text = (drawn / "tables" / f"{name}.tex").read_text(encoding="utf-8")
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


def test_terminal_tables_fit_110_columns(drawn: Path, data: Path) -> None:
    name, path = "a-very-long-case-name-that-says-everything-there-is-to-say", data / "data" / "rates.csv"
    replace(path, "rough-1.75", name)
    second = pd.read_csv(path).assign(scheme="backward-euler")
    pd.concat([pd.read_csv(path), second]).to_csv(path, index=False)
    for text in (rates_text(drawn), ledger_text(drawn), rates_text(data)):
        assert max(map(len, text.splitlines())) <= 110


def test_terminal_tables_fit_a_terminal_of_80_columns(drawn: Path, data: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    path = data / "data" / "rates.csv"
    replace(path, "rough-1.75", "a-very-long-case-name-that-says-everything-there-is-to-say")
    second = pd.read_csv(path).assign(scheme="backward-euler")
    pd.concat([pd.read_csv(path), second]).to_csv(path, index=False)
    for text in (rates_text(drawn), ledger_text(drawn), rates_text(data)):
        assert max(map(len, text.splitlines())) <= 80
    assert re.search(r"^advance-.* shaken +64 .* 1\.07 1\.03 1\.02$", rates_text(drawn), re.MULTILINE)


def test_the_rate_text_has_one_line_per_case_and_family(drawn: Path) -> None:
    lines = rates_text(drawn).splitlines()
    (line,) = (line for line in lines if line.startswith("advance-recede") and "shaken" in line)
    finest = read_rates(drawn).query("case == 'advance-recede' and family == 'shaken'").iloc[-1]
    assert len([line for line in lines if line.startswith(tuple(CASES))]) == len(CASES) * len(FAMILIES)
    assert line.split()[2:5] == ["64", f"{finest['error']:#.4g}", f"{finest['discrete_order']:.2f}"]
    assert line.split()[6:] == ["1.07", "1.03", "1.02"]


def test_the_ledger_text_counts_verdicts_by_statement_and_lists_what_does_not_hold(drawn: Path) -> None:
    text = ledger_text(drawn)
    assert re.search(r"^statement +cases +holds +reported +undecided +fails$", text, re.MULTILINE)
    assert re.search(r"^Prop. 5.4 +‖u − u\^h‖.* [12] +[12] +1$", text, re.MULTILINE)
    listed = (
        "fails: Prop. 5.4, advance-recede: order, criss-cross: expected 1 ± 0.1, observed 0.7100 in [0.6500, 0.7800]"
    )
    assert listed in text.splitlines()
    assert "\nundecided: (3.1), (3.2): Γ3,i" in text
    assert text.endswith("5 rows: 3 hold, 1 fail, 1 undecided, 0 reported without a claim\n")


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
def test_a_missing_file_is_named_with_the_command_that_makes_it(data: Path, present: Present, name: str) -> None:
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
        ("cases.csv", "rough", "smooth", "lacks the cases rough-1.75"),
        ("pictures/two-faces.json", '"zone_exact"', '"zone"', "two-faces.json is not a picture"),
        ("pictures/two-faces.json", '"energy"', '"zone"', "two-faces.json is not a picture"),
        ("bounds.csv", "upper", "something", "lacks the columns upper"),
    ],
)
def test_a_damaged_file_is_named(data: Path, name: str, old: str, new: str, complaint: str) -> None:
    replace(data / "data" / name, old, new)
    with pytest.raises(DataError, match=complaint):
        (write_tables if name == "claims.csv" else draw_all)(data)
    assert files(data) == ["data"]


def test_a_file_is_written_whole_or_not_at_all(tmp_path: Path) -> None:
    def stumble(part: Path) -> None:
        part.write_text("half")
        raise OSError("disk full")

    path = write_text(tmp_path / "table.md", "whole")
    with pytest.raises(StoreError, match="disk full"):
        write_whole(path, stumble)
    assert files(tmp_path) == ["table.md"]
    assert path.read_text() == "whole"


def test_a_single_level_can_be_drawn(tmp_path: Path) -> None:
    directory = write_data(tmp_path, {"advance-recede": (1.0, 28.0)}, (16,), level=8)
    shutil.rmtree(directory / "data" / "pictures")
    (directory / "data" / "pictures").mkdir()
    names = (
        "problem",
        "collapsed",
        "convergence-advance-recede",
        "convergence",
        "effectivity",
        "enclosure-advance-recede",
    )
    assert {path.stem for path in draw_figures(directory, drawings)} == set(names)
