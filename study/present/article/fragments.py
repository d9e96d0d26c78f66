"""What ``paper/`` takes from the data files: its tables and the macros for every measured number in its text.

Written to ``article/`` and only for a full run with its controls, which is what the article is about.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import pandas as pd

from study.ledger.datafiles import DataError, by_claim, count_verdicts
from study.ledger.margin import agreement, used, worst
from study.ledger.rounding import down, up
from study.ledger.verdict import HOLDS, REPORTED
from study.present.article.numbers import DISCRETE, macros
from study.present.article.source import FullRun
from study.present.latex import encode, encode_letters, folding, longtable, prose, tabular


def _nearest(value: float, digits: int) -> str:
    return f"{value:.{digits}g}"


ROUNDED = 1e-6
"""A defect that is seen however small it is: the start has to be Π^h u_0 up to rounding."""
ENDS = {"lowest": down, "error": _nearest, "highest": up, "upper": up, "lower": down}
"""How the columns of an enclosure are rounded: outwards."""


def article(directory: Path) -> dict[Path, str]:
    """The files under ``directory/article`` with the macros and tables of the article; none for a run that is not full.

    Raises:
        DataError: the data lack a row that the article speaks of.
    """
    data = FullRun.read(directory)
    if data is None:
        return {}
    tables = (ledger, catalogue, smooth, rough, stresses, enclosures, discrete, slips, codes, sensitivity)
    texts = {"numbers": macros(data)} | {make.__name__: make(data) for make in tables}
    return {directory / "article" / f"{name}.tex": text for name, text in texts.items()}


def ledger(data: FullRun) -> str:
    """One row per statement: how many verdicts of each kind, and the one that uses most of its window."""
    body = [_statement(*statement) for statement in by_claim(data.claims)]
    label, statement, quantity = (folding(width) for width in (0.11, 0.215, 0.265))
    headings = ["no.", "what it says", "hold", "not", "rep.", "row nearest to the end of its window", "seen", "window"]
    return longtable(headings, [label, statement, "r", "r", "r", quantity, "r", "l"], [("", body)])


def _statement(label: str, claim: str, rows: pd.DataFrame) -> list[str]:
    count, judged = count_verdicts(rows), rows[rows["verdict"] != REPORTED]
    counts = count[HOLDS], len(judged) - count[HOLDS], count[REPORTED]
    shares = judged.apply(used, axis=1).dropna() if len(judged) else pd.Series(dtype=float)
    nearest = ["--", "", ""]
    if len(shares):
        row = judged.loc[shares.idxmax()]
        where = f"{encode_letters(str(row['quantity']))} ({prose(str(row['case']))})"
        nearest = [where, _number(worst(row)), window_ends(row)]
    return [encode_letters(label), encode_letters(claim), *map(str, counts), *nearest]


def catalogue(data: FullRun) -> str:
    """The exact solutions: name, what the zone does, law."""
    laws = data.cases["law"].str.removeprefix("linear, ")
    facts = zip(data.cases["case"], data.cases["summary"], laws, strict=True)
    body = [[prose(case), encode_letters(summary), encode_letters(law)] for case, summary, law in facts]
    return tabular(["case", "what it does", "law (linear but for (3.3))"], f"l{folding(0.5)}{folding(0.27)}", body)


def smooth(data: FullRun) -> str:
    """Prop. 5.4, one row per case: orders of the error and of the discrete error, finest level, time share."""
    keys = {
        "order": _range,
        "order-fitted": _signed("observed"),
        "discrete-order-superclose": _range,
        "discrete-order-others": _range,
        "discrete-share": _signed("observed"),
        "time-share": _percent,
    }
    headings = ["case", "regularity", r"\(n\)", "orders", "fitted", "superclose", "other", "share", r"time, \%"]
    body = []
    for case, rows in data.rates[data.rates["claim"] == "Prop. 5.4"].groupby("case", sort=False):
        found = [_cell(data, "Prop. 5.4", key, str(case), form) for key, form in keys.items()]
        body.append([prose(str(case)), _regularity(data, str(case)), str(rows["level"].max()), *found])
    return tabular(headings, "llrrrrrrr", body)


def rough(data: FullRun) -> str:
    """Prop. 5.3, one row per case: the predicted order, what the proof of 5.4 gives, and what is seen."""
    seen = (
        ("(5.36)", "order", _range),
        ("Prop. 5.3", "order-graded", _signed("observed")),
        ("Prop. 5.3", "falling", _signed("high")),
        ("Prop. 5.3", "limit", _signed("high")),
    )
    body = []
    for case in data.rates.loc[data.rates["claim"] == "Prop. 5.3", "case"].drop_duplicates():
        fact = data.cases.loc[case]
        orders = [f"{fact[name]:.3g}" for name in ("expected_order", "proved_order")]
        found = [_cell(data, label, key, case, form) for label, key, form in seen]
        body.append([prose(case), _regularity(data, case), *orders, *found])
    headings = ["case", "regularity", "predicted", "proved", "seen", "graded", "ratio", r"\(e_\infty/e\)"]
    return tabular(headings, "llrrrrrr", body)


def stresses(data: FullRun) -> str:
    """Theorem 4.2 on a stress space of its own, one row per case and family but shaken ones: orders and windows."""
    label = "Thm 4.2, own space"
    rows = data.claims[(data.claims["label"] == label) & (data.claims["family"] != "shaken")]
    body = []
    for (case, family), part in rows.groupby(["case", "family"], sort=False):
        by_key = part.set_index("key")
        found = []
        for key in ("order-stress", "order-displacement"):
            found += [_number(by_key.loc[key, "observed"]), window_ends(by_key.loc[key])]
        found += [_number(by_key.loc[key, "observed"]) for key in ("order-pressure", "order-primal_stress", "growth")]
        body.append([prose(str(case)), prose(str(family)), *found])
    headings = ["case", "meshes", r"\(\sigma^h\)", "window", "multipliers", "window", "pressure"]
    headings += [r"\(\sigma(u^h)\)", "growth"]
    return tabular(headings, "llrlrlrrr", body)


def enclosures(data: FullRun) -> str:
    """The enclosures on three levels: of a case with an exact solution, and of problems without one.

    Ends are rounded outwards.
    """
    rows = data.bounds[data.bounds["trajectory"] == "enclosure"]
    deep = [str(case) for case, part in rows.groupby("case", sort=False) if len(part) > 2]
    body = [
        [prose(str(row["case"])), prose(str(row["family"])), str(row["level"]), _number(row["h"])]
        + ["--" if pd.isna(row[name]) else _number(row[name], rounded, 4) for name, rounded in ENDS.items()]
        for _, row in rows[rows["case"].isin(deep)].iterrows()
    ]
    headings = ["problem", "meshes", *(rf"\({name}\)" for name in "nh"), "lower end", "error", "upper end"]
    return tabular([*headings, "upper/error", "lower/error"], "llrrrrrrr", body)


def discrete(data: FullRun) -> str:
    """The fully discrete error, one row per case and scheme: 95 % intervals of orders, marked where they miss."""
    rows = data.claims[data.claims["label"] == "beyond: fully discrete"]
    body = []
    for case, part in rows.groupby("case", sort=False):
        by_key, first = part.set_index("key"), f"-{DISCRETE[0]}"
        for scheme in (key.removesuffix(first) for key in by_key.index if key.endswith(first)):
            cells = [_marked(by_key.loc[f"{scheme}-{key}"]) for key in DISCRETE]
            body.append([prose(str(case)), prose(scheme), *cells])
    headings = ["case", "scheme", r"\(q\) of \(d\)", r"\(s\) of \(d\)", r"\(p\) of \(e\)", r"\(q\) of \(e\)", "misfit"]
    return tabular(headings, "llrrrrr", body)


def _marked(row: pd.Series) -> str:
    """The interval with * for undecided and † for a prediction that was wrong."""
    if pd.isna(row["observed"]):
        return "--"
    interval = rf"\([{row['low']:.2f}, {row['high']:.2f}]\)" if row["low"] < row["high"] else _range(row)
    mark = {"agrees": "", "undecided": "*", "differs": r"\dagger"}[agreement(row)]
    return interval + (rf"\rlap{{\(^{{{mark}}}\)}}" if mark else "")


def slips(data: FullRun) -> str:
    """The slips in the text of the source: place, what is printed, how it has to be read."""
    rows = data.claims[data.claims["label"] == "slips"]
    body = [
        [encode_letters(str(row[name]).removeprefix("read: ")) for name in ("case", "quantity", "expected")]
        for _, row in rows.iterrows()
    ]
    headings = ["place", "printed", "how it is read here, and why"]
    return tabular(headings, "".join(folding(width) for width in (0.14, 0.3, 0.5)), body)


def codes(data: FullRun) -> str:
    """Other people's contact codes with their parameters, one row each; nothing where there are no data."""
    rows = [] if data.codes is None else data.codes.rows().to_dict("records")
    body = [
        [prose(f"{row['code']} {row['version']}"), encode_letters(str(row["variant"])), prose(str(row["classes"]))]
        + [
            f"{row['order_low']:.2f}--{row['order_high']:.2f}",
            *(_number(row[name], up) for name in ("share", "excess")),
        ]
        for row in rows
    ]
    headings = ["code", "parameters", "class (series)", "order", r"\(d/e\)", r"\(e_p\)"]
    return tabular(headings, "".join(folding(width) for width in (0.17, 0.25, 0.22)) + "rrr", body)


def sensitivity(data: FullRun) -> str:
    """The smallest defects in per cent that turn a row red on every mesh family; nothing where there are no data."""
    if data.sensitivity is None:
        return tabular(["case"], "l", [])
    largest = data.sensitivity.groupby(["case", "defect"], sort=False)["amount"].max().unstack("defect")
    largest = largest[[name for name in data.sensitivity["defect"].unique() if largest[name].min() > ROUNDED]]
    body = [[prose(str(case)), *(_number(100 * amount, up, 2) for amount in row)] for case, row in largest.iterrows()]
    return tabular(["case", *map(encode, largest.columns)], "l" + "r" * largest.shape[1], body)


def _cell(data: FullRun, label: str, key: str, case: str, form: Callable[[pd.Series], str]) -> str:
    """One cell from the first such row of the ledger; a dash where the case has none."""
    try:
        return form(data.rows(label, key, case).iloc[0])
    except DataError:
        return "--"


def _range(row: pd.Series) -> str:
    low, high = _signed("low")(row), _signed("high")(row)
    return low if low == high else f"{low}--{high}"


def _percent(row: pd.Series) -> str:
    return f"{100 * row['observed']:.2f}"


def _signed(column: str) -> Callable[[pd.Series], str]:
    """Two decimals of a column of a row, as mathematics where they are negative."""

    def form(row: pd.Series) -> str:
        text = f"{row[column]:.2f}"
        return rf"\({text}\)" if text.startswith("-") else text

    return form


def _regularity(data: FullRun, case: str) -> str:
    """The exponents of a case, short enough for a column."""
    text = str(data.cases.loc[case, "regularity"])
    short = text.replace("strain with a jump inside cells", "jump inside cells").replace(" front, ", ", ")
    return encode_letters(short)


def _number(value: float, rounded: Callable[[float, int], str] = _nearest, digits: int = 3) -> str:
    """A measured number to some significant digits."""
    return encode(f"{float(rounded(value, digits)):#.{digits}g}".rstrip("."))


def window_ends(row: pd.Series) -> str:
    """The ends of a window as mathematics; a low end of 0 or −∞ says nothing."""
    ends = float(row["window_low"]), float(row["window_high"])
    low, high = (encode(f"{end:.4g}").strip(r"\()").removeprefix(r"1\cdot ") for end in ends)
    if ends[0] == 0 or math.isinf(ends[0]):
        return rf"\(\leq {high}\)"
    return rf"\(\geq {low}\)" if math.isinf(ends[1]) else rf"\([{low}, {high}]\)"
