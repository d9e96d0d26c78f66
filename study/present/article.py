"""LaTeX tables for the papers in ``paper/``, and LaTeX macros for all measured numbers in their text.

The tables and macros are made from the data files of a full run and written to ``article/``. The cells of tables are
plain text, which ``encode`` turns into LaTeX.
"""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import pandas as pd

from study.ledger.codes import Codes
from study.ledger.controls import summary
from study.ledger.datafiles import by_claim, count_kinds, count_verdicts
from study.ledger.files import write_text
from study.ledger.text import above, below, down, up
from study.ledger.verdict import (
    FAILS,
    HOLDS,
    MISSED,
    REPORTED,
    UNCLAIMED,
    UNDECIDED,
    agreement,
    window_share,
    worst_value,
)
from study.present.notation import encode, folding, read_page, tabular
from study.present.tables import TABLES
from study.present.templates import EVIDENCE_TITLES, MISPRINTS, FullRun, context, evidence, render

TEXTS = read_page("article")
"""Titles of groups of statements, and headings and columns of tables."""
GROUPS: dict[str, list[str]] = {EVIDENCE_TITLES.get(title, title): begins for title, begins in TEXTS["groups"].items()}
"""Title of a group of statements ↦ the beginnings of the labels of these statements."""
BEYOND = "beyond the source"
TOTAL = "all"
"""The first cell of a last row that adds up the others; a line separates it from them."""
DISCRETE = ("time-in-k", "time-in-h", "error-in-h")
"""Suffixes of the keys of the checks of each fully discrete scheme."""
MARKS = {"met": "", "undecided": "*", "wrong": "†"}
"""Whether a prediction was met ↦ its mark in the table of fully discrete errors."""
PlainRows = list[list[str]]
"""The cells of a table, row by row, as plain text."""


def write_tables(directory: Path) -> list[Path]:
    """Write all tables into ``directory/tables`` and, for a full run, the LaTeX files for the papers.

    Raises:
        DataError: a data file is missing or lacks a column; then nothing is written.
    """
    return [write_text(path, text) for path, text in texts(directory).items()]


def texts(directory: Path) -> dict[Path, str]:
    """Return path ↦ text of the files that ``write_tables`` writes; raises the same errors."""
    by_path: dict[Path, str] = {}
    for table in [make(directory) for make in TABLES]:
        by_path |= table.texts(directory / "tables") if table else {}
    return by_path | article(directory)


def article(directory: Path) -> dict[Path, str]:
    """Return the texts of the LaTeX files for the papers, by their paths in ``directory/article``.

    If the directory does not contain a full run, the result is empty.

    Raises:
        DataError: the data lack a row that a paper names.
    """
    data = FullRun.read(directory)
    if data is None:
        return {}
    by_name = {"numbers": render("numbers.tex.j2", context(data)), "ledger": ledger(data)}
    for make in (accounts, verdicts, slips, smooth, rough, stresses, enclosures, discrete, catalogue, codes, faults):
        by_name[make.__name__] = latex(make.__name__, make(data))
    return {directory / "article" / f"{name}.tex": text for name, text in by_name.items()}


def latex(name: str, rows: PlainRows) -> str:
    """Return a LaTeX table with the headings and columns of ``page/article.toml`` and the given cells."""
    layout = TEXTS["tables"][name]
    columns = [folding(column) if isinstance(column, float) else column for column in layout["columns"]]
    cells = [[encode(cell) for cell in row] for row in rows]
    if rows and rows[-1][0] == TOTAL:
        cells[-1][0] = rf"\midrule {TOTAL}"
    return tabular(layout["headings"], "".join(columns), cells)


# Tables of checks


def group_of(label: str) -> str:
    """Return the title of the group of statements to which a label belongs.

    If several beginnings in ``GROUPS`` match the label, the longest decides; if none matches, the group is ``BEYOND``.
    """
    matches = [(len(begin), title) for title, begins in GROUPS.items() for begin in begins if label.startswith(begin)]
    return max(matches)[1] if matches else BEYOND


def verdicts(data: FullRun) -> PlainRows:
    """Return the numbers of checks with each verdict, a row for each group of statements and for all.

    The checks that hold are counted by the kind of their evidence.
    """
    groups, body = data.claims["label"].map(group_of), []
    for title in (*GROUPS, BEYOND, TOTAL):
        rows = data.claims if title == TOTAL else data.claims[groups == title]
        count = count_verdicts(rows)
        counts = *count_kinds(rows).values(), count[FAILS] + count[UNDECIDED], count[MISSED], count[REPORTED]
        body.append([title, *map(str, counts)])
    return body


def accounts(data: FullRun) -> PlainRows:
    """Return the numbers of checks, of checks that hold, and of those that fail or are undecided, by evidence."""
    names, body = data.claims.apply(evidence, axis=1), []
    for name, title in (EVIDENCE_TITLES | {TOTAL: TOTAL}).items():
        rows = data.claims if name == TOTAL else data.claims[names == name]
        count = count_verdicts(rows)
        judged = [str(count[HOLDS]), str(count[FAILS] + count[UNDECIDED])]
        is_judged = name == TOTAL or not rows["verdict"].isin(UNCLAIMED).all()
        body.append([title, str(len(rows)), *(judged if is_judged else ["–", "–"])])
    return body


def ledger(data: FullRun) -> str:
    """Return LaTeX tables with a line for each statement: its verdicts, and its check with the smallest margin.

    This is the check whose value uses the largest share of its tolerance window. Each group of statements has a
    separate table, which is not broken over pages.
    """
    bodies: dict[str, PlainRows] = {title: [] for title in (*GROUPS, BEYOND)}
    for label, claim, rows in by_claim(data.claims):
        count, judged = count_verdicts(rows), rows[~rows["verdict"].isin(UNCLAIMED)]
        counts = count[HOLDS], count[FAILS] + count[UNDECIDED], count[MISSED], count[REPORTED]
        shares = judged.apply(window_share, axis=1).dropna() if len(judged) else pd.Series(dtype=float)
        nearest = ["–", ""]
        if len(shares):
            row = judged.loc[shares.idxmax()]
            nearest = [f"{row['quantity']} ({row['case']})", f"{three_digits(worst_value(row))}; {window_ends(row)}"]
        bodies[group_of(label)].append([label, claim, *map(str, counts), *nearest])
    heading = r"\par\medskip\noindent\textbf{{{}}}\par\nobreak\smallskip\noindent" + "\n"
    return "".join(heading.format(encode(title)) + latex("ledger", body) for title, body in bodies.items())


def window_ends(row: pd.Series) -> str:
    """Return a tolerance window as text: an interval; one inequality if an end is infinite or the lower end is 0."""
    low, high = (f"{float(row[name]):.4g}" for name in ("window_low", "window_high"))
    if low in ("0", "-inf"):
        return f"≤ {high}"
    return f"≥ {low}" if high == "inf" else f"[{low}, {high}]"


def slips(data: FullRun) -> PlainRows:
    """Return the misprints in the source: place, printed text, corrected text."""
    rows = data.claims.loc[data.claims["label"] == MISPRINTS, ["case", "quantity", "expected"]]
    return [[str(cell).removeprefix("read: ") for cell in row] for row in rows.to_numpy()]


def faults(data: FullRun) -> PlainRows:
    """Return the deliberate faults: in how many cases they are noticed, and are invisible."""
    rows = summary(data.faults)[["equation", "fault", "size", "cases", "errors", "any_check", "invisible"]]
    return [[equation, fault, f"{size:g}", *map(str, counts)] for equation, fault, size, *counts in rows.to_numpy()]


# Tables of results


def catalogue(data: FullRun) -> PlainRows:
    """Return the exact solutions with their names, summaries and laws."""
    laws = data.cases["law"].str.removeprefix("linear, ")
    return data.cases.assign(law=laws)[["case", "summary", "law"]].to_numpy().tolist()


def cases_of(data: FullRun, label: str) -> Iterator[tuple[str, list[str], Callable[..., str]]]:
    """Yield for each case of a proposition its name, its name with its regularity, and a function of its checks.

    The function has a label, a key and columns of checks as parameters; it returns the values in these columns with two
    decimals, or a dash if there is no such check.
    """
    for case in data.rates.loc[data.rates["claim"] == label, "case"].unique():
        regularity = data.cases.loc[case, "regularity"].replace("strain with a jump inside cells", "jump inside cells")
        rows = data.claims[data.claims["case"] == case]

        def measured(label: str, key: str, *columns: str, rows: pd.DataFrame = rows, scale: float = 1) -> str:
            chosen = rows[(rows["label"] == label) & (rows["key"] == key)]
            return decimals(scale * chosen.iloc[0][list(columns)]) if len(chosen) else "–"

        yield case, [case, regularity.replace(" front, ", ", ")], measured


def three_digits(value: float) -> str:
    """Return a number with three significant digits, zeros included."""
    return f"{value:#.3g}".rstrip(".")


def decimals(values: Sequence[float]) -> str:
    """Return values with two decimals and a dash between them; equal values once."""
    return "–".join(dict.fromkeys(f"{value:.2f}" for value in values))


def smooth(data: FullRun) -> PlainRows:
    """Return the table of Proposition 5.4 with a row for each case.

    A row has the finest level, the observed orders of the error and of the discrete error, the size of the discrete
    error relative to the error, and the share of the time discretisation in per cent.
    """
    label, body = "Prop. 5.4", []
    finest = data.rates[data.rates["claim"] == label].groupby("case")["level"].max()
    keys = "order", "order-extrapolated", "discrete-order-superclose", "discrete-order-others"
    for case, begin, measured in cases_of(data, label):
        orders = [measured(label, key, "low", "high") for key in keys]
        share = measured(label, "discrete-share", "observed")
        time = measured(label, "time-share", "observed", scale=100)
        body.append([*begin, str(finest[case]), *orders, share, time])
    return body


def rough(data: FullRun) -> PlainRows:
    """Return the table of Proposition 5.3 with a row for each case.

    A row has the order that the regularity of the solution predicts, the order that the proof of Proposition 5.4 gives
    for this regularity, and the observations.
    """
    label, body = "Prop. 5.3", []
    for case, begin, measured in cases_of(data, label):
        orders = [f"{data.cases.loc[case, name]:.3g}" for name in ("expected_order", "proved_order")]
        order, graded = measured("(5.36)", "order", "low", "high"), measured(label, "order-graded", "observed")
        ratio, limit = measured(label, "falling", "high"), measured(label, "limit", "high")
        body.append([*begin, *orders, order, graded, ratio, limit])
    return body


def stresses(data: FullRun) -> PlainRows:
    """Return the checks of Theorem 4.2 with a separate finite element space for stresses.

    There is a row for each case and mesh family, except shaken meshes.
    """
    rows = data.claims[(data.claims["label"] == "Thm 4.2, own space") & (data.claims["family"] != "shaken")]
    body = []
    for (case, family), part in rows.groupby(["case", "family"], sort=False):
        by_key, cells = part.set_index("key"), []
        for key in ("order-stress", "order-displacement", "order-pressure", "order-primal_stress", "growth"):
            cells.append(three_digits(by_key.loc[key, "observed"]))
            cells += [window_ends(by_key.loc[key])] * (key in ("order-stress", "order-displacement"))
        body.append([str(case), str(family), *cells])
    return body


def enclosures(data: FullRun) -> PlainRows:
    """Return two-sided bounds of the error, for all cases that were measured on three or more levels.

    The ends of the bounds are rounded outwards. The error is empty for problems without a known exact solution.
    """
    roundings = {"lowest": down, "error": None, "highest": up, "upper": up, "lower": down}
    rows, body = data.bounds[data.bounds["trajectory"] == "enclosure"], []
    for row in rows.groupby("case", sort=False).filter(lambda of_case: len(of_case) > 2).to_dict("records"):
        cells = [row["case"], row["family"], str(row["level"]), three_digits(row["h"])]
        for name, rounding in roundings.items():
            value = float(rounding(row[name], 4)) if rounding and pd.notna(row[name]) else row[name]
            cells.append("–" if pd.isna(value) else f"{value:#.4g}")
        body.append(cells)
    return body


def discrete(data: FullRun) -> PlainRows:
    """Return the observed orders of the fully discrete error for each case and time scheme.

    Undecided predictions are marked with * and wrong predictions with †.
    """
    rows = data.claims[data.claims["label"] == "beyond: fully discrete"]
    body = []
    for case, part in rows.groupby("case", sort=False):
        by_key, first = part.set_index("key"), f"-{DISCRETE[0]}"
        for scheme in (key.removesuffix(first) for key in by_key.index if key.endswith(first)):
            checks = [by_key.loc[f"{scheme}-{key}"] for key in DISCRETE]
            orders = [decimals(check[["low", "high"]]) + MARKS[agreement(check)] for check in checks]
            body.append([str(case), scheme, *orders])
    return body


def codes(data: FullRun) -> PlainRows:
    """Return other people's contact codes without the effect of scaling; no rows if their results are missing."""
    return [row[:-1] for row in contact_codes(data.codes)] if data.codes else []


def contact_codes(results: Codes) -> PlainRows:
    """Return other people's contact codes, a row for each code and its parameters.

    A row says how the errors behave on finer meshes (the class, and the number of series of meshes with this class),
    and has the range of orders, rounded outwards, and the worst distance, pressure error and effect of scaling.
    """
    return [
        [
            f"{row['code']} {row['version']}",
            str(row["variant"]),
            str(row["classes"]),
            f"{below(row['order_low'], 2)} to {above(row['order_high'], 2)}",
            *(up(row[name], digits) for name, digits in {"share": 2, "excess": 3, "invariance": 2}.items()),
        ]
        for row in results.rows().to_dict("records")
    ]
