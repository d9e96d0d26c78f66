"""LaTeX tables for the papers in ``paper/``, and LaTeX macros for all measured numbers in their text.

The tables and macros are made from the data files of a full run and written to ``article/``. The cells of tables are
plain text, which ``encode`` turns into LaTeX.
"""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from pandas import DataFrame, Series

from study.ledger.codes import Codes
from study.ledger.controls import summary
from study.ledger.datafiles import by_claim, count_kinds, count_verdicts
from study.ledger.files import Paths, write_text
from study.ledger.text import down, outwards, up
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
from study.present.tables import RUN_TABLES, TextFiles
from study.present.templates import (
    EVIDENCE_TITLES,
    MISPRINTS,
    FullRun,
    context,
    encode,
    evidence,
    folding,
    read_page,
    render,
)

ARTICLE_TEXTS = read_page("article")
"""Titles of groups of statements, and headings and columns of tables."""
GROUPS: dict[str, list[str]] = {
    EVIDENCE_TITLES.get(title, title): begins for title, begins in ARTICLE_TEXTS["groups"].items()
}
"""Title of a group of statements ↦ the beginnings of the labels of these statements."""
BEYOND = "beyond the source"
TOTAL = "all"
"""The first cell of a last row that adds up the others; a line separates it from them."""
DISCRETE = ("time-in-k", "time-in-h", "error-in-h")
"""Suffixes of the keys of the checks of each fully discrete scheme."""
MARKS = {"met": "", "undecided": "*", "wrong": "†"}
"""Whether a prediction was met ↦ its mark in the table of fully discrete errors."""
Rows = list[list[object]]
TextRows = list[list[str]]
"""The cells of a table, row by row."""


def write_tables(directory: Path) -> Paths:
    """Write all tables into ``directory/tables`` and, for a full run, the LaTeX files for the papers.

    Raises:
        DataError: a data file is missing or lacks a column; then nothing is written.
    """
    return [write_text(path, text) for path, text in texts(directory).items()]


def texts(directory: Path) -> TextFiles:
    """Return path ↦ text of the files that ``write_tables`` writes; raises the same errors."""
    by_path: TextFiles = {}
    for make in RUN_TABLES:
        if table := make(directory):
            by_path |= table.texts(directory / "tables")
    return by_path | article(directory)


def article(directory: Path) -> TextFiles:
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


def latex(name: str, rows: DataFrame | Sequence[Sequence[object]]) -> str:
    """Return a table of a paper as LaTeX, which needs the packages booktabs and array.

    Parameters:
        name: the name of the table in ``page/article.toml``, where its headings and columns are.
        rows: its cells; empty cells (NaN) get a dash.
    """
    texts = DataFrame(rows).fillna("–").astype(str).to_numpy().tolist()
    layout = ARTICLE_TEXTS["tables"][name]
    columns = [folding(column) if isinstance(column, float) else column for column in layout["columns"]]
    cells = DataFrame([map(encode, row) for row in texts], columns=layout["headings"])
    if texts and texts[-1][0] == TOTAL:
        cells.iloc[-1, 0] = rf"\midrule {TOTAL}"
    return cells.style.hide().to_latex(column_format=rf"@{{}}{''.join(columns)}@{{}}", hrules=True)


# Tables of checks


def group_of(label: str) -> str:
    """Return the title of the group of statements to which a label belongs.

    If several beginnings in ``GROUPS`` match the label, the longest decides; if none matches, the group is ``BEYOND``.
    """
    matches = [(len(begin), title) for title, begins in GROUPS.items() for begin in begins if label.startswith(begin)]
    return max(matches)[1] if matches else BEYOND


def by_group(claims: DataFrame, groups: Series, titles: Iterable[str]) -> Iterator[tuple[str, DataFrame]]:
    """Yield title and checks of each group, and at the end ``TOTAL`` and all checks.

    Parameters:
        claims: the table ``claims.csv``.
        groups: the title of the group of each check.
        titles: the titles of all groups.
    """
    for title in titles:
        yield title, claims[groups == title]
    yield TOTAL, claims


def verdicts(data: FullRun) -> Rows:
    """Return the numbers of checks with each verdict, with a row for each group of statements and one for all.

    A row has the title of the group, the numbers of checks that hold, one for each ``CheckKind``, and the
    ``numbers_of_others``.
    """
    groups = by_group(data.claims, data.claims.label.map(group_of), [*GROUPS, BEYOND])
    return [[title, *count_kinds(rows).values(), *numbers_of_others(rows)] for title, rows in groups]


def numbers_of_others(rows: DataFrame) -> list[int]:
    """Return three numbers of checks that do not hold: failed or undecided, wrong predictions, numbers without a claim.

    Parameters:
        rows: rows of ``claims.csv``.
    """
    count = count_verdicts(rows)
    return [count[FAILS] + count[UNDECIDED], count[MISSED], count[REPORTED]]


def accounts(data: FullRun) -> Rows:
    """Return the numbers of all checks, of checks that hold, and of checks that fail or are undecided.

    There is a row for each kind of evidence, which says what a check can show (a claim of the source, the accuracy of
    the computation, …; see ``evidence``), and a row for all checks. Without a claim, the last two numbers are dashes.
    """
    kinds = data.claims.apply(evidence, axis=1).map(EVIDENCE_TITLES)
    body: Rows = []
    for title, rows in by_group(data.claims, kinds, EVIDENCE_TITLES.values()):
        count = count_verdicts(rows)
        judged = [count[HOLDS], count[FAILS] + count[UNDECIDED]]
        body.append([title, len(rows), *(["–", "–"] if rows.verdict.isin(UNCLAIMED).all() else judged)])
    return body


def ledger(data: FullRun) -> str:
    """Return LaTeX tables with a line for each statement: its verdicts, and its check with the smallest margin.

    This is the check whose value uses the largest share of its tolerance window. Each group of statements has a
    separate table, which is not broken over pages.
    """
    bodies: dict[str, Rows] = {title: [] for title in (*GROUPS, BEYOND)}
    for label, claim, rows in by_claim(data.claims):
        judged = rows[~rows.verdict.isin(UNCLAIMED)]
        nearest = ["–", ""]
        shares = Series({at: window_share(row) for at, row in judged.iterrows()}, dtype=float).dropna()
        if len(shares):
            row = judged.loc[shares.idxmax()]
            nearest = [f"{row.quantity} ({row.case})", f"{three_digits(worst_value(row))}; {window_ends(row)}"]
        holds = (rows.verdict == HOLDS).sum()
        bodies[group_of(label)].append([label, claim, holds, *numbers_of_others(rows), *nearest])
    heading = r"\par\medskip\noindent\textbf{{{}}}\par\nobreak\smallskip\noindent" + "\n"
    return "".join(heading.format(encode(title)) + latex("ledger", body) for title, body in bodies.items())


def window_ends(row: Series) -> str:
    """Return a tolerance window as text: an interval; one inequality if an end is infinite or the lower end is 0."""
    low = f"{row.window_low:.4g}"
    high = f"{row.window_high:.4g}"
    if low in ("0", "-inf"):
        return f"≤ {high}"
    return f"≥ {low}" if high == "inf" else f"[{low}, {high}]"


def slips(data: FullRun) -> TextRows:
    """Return the misprints in the source: place, printed text, corrected text."""
    rows = data.labelled(MISPRINTS)[["case", "quantity", "expected"]]
    return rows.replace("^read: ", "", regex=True).to_numpy().tolist()


def faults(data: FullRun) -> DataFrame:
    """Return for each deliberate fault and size in how many cases it was measured, is noticed, and is invisible.

    The columns are those of ``summary``, which also says what *invisible* means.
    """
    rows = summary(data.faults)
    rows["size"] = rows["size"].map("{:g}".format)
    columns = ["equation", "fault", "size", "cases", "errors", "any_check", "invisible"]
    return rows[columns]


# Tables of results


def catalogue(data: FullRun) -> DataFrame:
    """Return a row for each exact solution: its name, summary and material law."""
    laws = data.cases.law.str.removeprefix("linear, ")
    return data.cases.assign(law=laws)[["case", "summary", "law"]]


def cases_of(data: FullRun, label: str) -> DataFrame:
    """Return the names and regularities of all cases that measure a proposition, indexed by the names.

    Parameters:
        data: the data of the run.
        label: the label of the proposition, such as "Prop. 5.4".
    """
    names = data.rates.loc[data.rates.claim == label, "case"].unique()
    shorter = {"strain with a jump inside cells": "jump inside cells", " front, ": ", "}
    return data.cases.loc[names, ["case", "regularity"]].replace({"regularity": shorter}, regex=True)


def measured(data: FullRun, label: str, key: str, *columns: str, scale: float = 1) -> Series:
    """Return case ↦ the results of one check as text with two decimals, such as "0.92–1.00" for a range.

    If a case has several rows of the check, for several mesh families, the first row is taken.

    Parameters:
        data: the data of the run.
        label, key: the label of the statement, and the short name of its check.
        columns: the columns of ``claims.csv`` with the results, such as "low" and "high". Equal results of several
            columns are written once, different ones with a dash between them.
        scale: factor of the results.
    """
    rows = data.labelled(label)
    rows = rows[rows.key == key].drop_duplicates("case").set_index("case")
    values = scale * rows[[*columns]].to_numpy()
    return Series([*map(decimals, values)], rows.index, dtype=object)


def three_digits(value: float) -> str:
    """Return a number with three significant digits, zeros included."""
    return f"{value:#.3g}".rstrip(".")


def decimals(values: Sequence[float]) -> str:
    """Return values with two decimals and a dash between them; equal values once."""
    return "–".join(dict.fromkeys(f"{value:.2f}" for value in values))


def smooth(data: FullRun) -> DataFrame:
    """Return the table of Proposition 5.4 with a row for each case.

    A row has the finest level, the observed orders of the error and of the discrete error, the size of the discrete
    error relative to the error, and the share of the time discretisation in per cent.
    """
    label = "Prop. 5.4"
    cells = cases_of(data, label)
    cells["level"] = data.rates[data.rates.claim == label].groupby("case")["level"].max().astype(str)
    for key in ("order", "order-extrapolated", "discrete-order-superclose", "discrete-order-others"):
        cells[key] = measured(data, label, key, "low", "high")
    cells["share"] = measured(data, label, "discrete-share", "observed")
    cells["time"] = measured(data, label, "time-share", "observed", scale=100)
    return cells


def rough(data: FullRun) -> DataFrame:
    """Return the table of Proposition 5.3 with a row for each case.

    A row has the order that the regularity of the solution predicts, the order that the proof of Proposition 5.4 gives
    for this regularity, and the observations.
    """
    label = "Prop. 5.3"
    cells = cases_of(data, label)
    for name in ("expected_order", "proved_order"):
        cells[name] = data.cases[name].map("{:.3g}".format)
    cells["order"] = measured(data, "(5.36)", "order", "low", "high")
    cells["graded"] = measured(data, label, "order-graded", "observed")
    cells["ratio"] = measured(data, label, "falling", "high")
    cells["limit"] = measured(data, label, "limit", "high")
    return cells


def stresses(data: FullRun) -> Rows:
    """Return the checks of Theorem 4.2 with a separate finite element space for stresses.

    There is a row for each case and mesh family, except shaken meshes.
    """
    rows = data.labelled("Thm 4.2, own space")
    body = []
    for (case, family), part in rows[rows.family != "shaken"].groupby(["case", "family"], sort=False):
        by_key = part.set_index("key")
        cells = []
        for key in ("order-stress", "order-displacement", "order-pressure", "order-primal_stress", "growth"):
            cells.append(three_digits(by_key.loc[key, "observed"]))
            cells += [window_ends(by_key.loc[key])] * (key in ("order-stress", "order-displacement"))
        body.append([case, family, *cells])
    return body


def enclosures(data: FullRun) -> DataFrame:
    """Return two-sided bounds of the error, for all cases that were measured on three or more levels.

    The ends of the bounds are rounded outwards. The error is empty for problems without a known exact solution.
    """
    rows = data.bounds[data.bounds.trajectory == "enclosure"]
    rows = rows.groupby("case", sort=False).filter(lambda of_case: len(of_case) > 2)
    cells = rows[["case", "family", "level"]].astype(str).assign(h=rows.h.map(three_digits))
    for name, rounding in {"lowest": down, "error": None, "highest": up, "upper": up, "lower": down}.items():
        values = rows[name].apply(rounding, digits=4).astype(float) if rounding else rows[name]
        cells[name] = values.map("{:#.4g}".format, na_action="ignore")
    return cells


def discrete(data: FullRun) -> DataFrame:
    """Return the observed orders of the fully discrete error for each case and time scheme.

    Undecided predictions are marked with * and wrong predictions with †.
    """
    rows = data.labelled("beyond: fully discrete")
    orders = rows[["low", "high"]].apply(decimals, axis=1) + rows.apply(agreement, axis=1).map(MARKS)
    names = rows.key.str.extract(f"(?P<scheme>.+)-(?P<order>{'|'.join(DISCRETE)})$")
    cells = names.assign(case=rows.case, cell=orders)
    table = cells.pivot_table("cell", ["case", "scheme"], "order", aggfunc="first", sort=False)
    return table[[*DISCRETE]].reset_index()


def codes(data: FullRun) -> TextRows:
    """Return the rows of ``contact_codes`` without the last column, the effect of scaled loads.

    There are no rows if the results of other people's contact codes are missing.
    """
    return [row[:-1] for row in contact_codes(data.codes)] if data.codes else []


def contact_codes(results: Codes) -> TextRows:
    """Return other people's contact codes, a row for each code and its parameters.

    A row says how the errors behave on finer meshes (the class, and the number of series of meshes with this class),
    and has the range of orders, rounded outwards, and the worst distance, pressure error and effect of scaling
    (change of the result if all loads are scaled).
    """
    return [
        [
            f"{row.code} {row.version}",
            row.variant,
            row.classes,
            outwards(row.order_low, row.order_high),
            up(row.share, 2),
            up(row.excess, 3),
            up(row.invariance, 2),
        ]
        for row in results.rows().itertuples()
    ]
