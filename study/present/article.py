"""LaTeX tables for the papers in ``paper/``, and LaTeX macros for all measured numbers in their text.

The tables and macros are made from the data files of a full run and written to ``article/``. Extreme values are rounded
outwards, a smallest value down and a largest value up, so that no sentence claims more than was measured.
"""

import math
from collections.abc import Callable, Sequence
from pathlib import Path

import pandas as pd

from study.ledger.datafiles import (
    DataError,
    by_claim,
    count_kinds,
    count_verdicts,
    planned_keys,
)
from study.ledger.faults import missed as lacking
from study.ledger.faults import summary
from study.ledger.numbered import NO_ROW, NOT_TESTED
from study.ledger.seeds import LARGEST_RATE
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
from study.ledger.window import STEEPER
from study.present.full_run import FullRun
from study.present.notation import encode, encode_letters, folding, prose, read_page, tabular

DISCRETE = ("time-in-k", "time-in-h", "error-in-h")
"""Suffixes of the keys of the checks of each fully discrete scheme."""
SOFTENING = "softening", "double-well"
"""Cases whose elasticity operator G softens."""
TEXTS = read_page("article")
"""Titles, definitions of numbers that summarise checks, and headings and columns of tables."""
ACCOUNTS: dict[str, str] = TEXTS["accounts"]
"""Name ↦ title of each kind of evidence (account). Every row of the ledger belongs to exactly one of them."""
GROUPS: dict[str, list[str]] = {ACCOUNTS.get(title, title): begins for title, begins in TEXTS["groups"].items()}
"""Title of a group of statements ↦ the beginnings of the labels of these statements."""
BEYOND = "beyond the source"


def article(directory: Path) -> dict[Path, str]:
    """Return the texts of the LaTeX files for the papers, by their paths in ``directory/article``.

    If the directory does not contain a full run, the result is empty.

    Raises:
        DataError: the data lack a row that a paper names.
    """
    data = FullRun.read(directory)
    if data is None:
        return {}
    about_checks, about_results = (accounts, verdicts, ledger, slips), (smooth, rough, stresses, enclosures, discrete)
    tables = *about_checks, *about_results, catalogue, codes, faults
    texts = {"numbers": macros(data)} | {make.__name__: make(data) for make in tables}
    return {directory / "article" / f"{name}.tex": text for name, text in texts.items()}


# Numbers in the papers and on the pages


def macros(data: FullRun) -> str:
    r"""Return one \\newcommand line for each measured number in the papers."""
    lines = [rf"\newcommand{{\{name}}}{{{value}}}" for name, value in numbers(data).items()]
    return "\n".join(["% Written by `study tables` from the data files; \\input before use.", *lines, ""])


def numbers(data: FullRun) -> dict[str, object]:
    """Return the numbers in the papers, name ↦ number; powers of ten, percentages and versions are LaTeX.

    Extreme values are rounded outwards.
    """
    about_checks = _counts_of_checks(data), _plan(data), of_checks(data, "numbers")
    return joined(*about_checks, _errors(data), _enclosures(data), _beyond(data), _discrete(data))


def joined(*parts: dict[str, object]) -> dict[str, object]:
    """Return the union of parts; ValueError if two of them define one name."""
    found: dict[str, object] = {}
    for part in parts:
        if twice := found.keys() & part.keys():
            raise ValueError(f"defined twice: {', '.join(sorted(twice))}")
        found |= part
    return found


def of_checks(data: FullRun, section: str) -> dict[str, object]:
    """Return the numbers that summarise checks, as a section of ``page/article.toml`` defines them.

    Parameters:
        data: the data of a full run.
        section: "numbers" for the numbers in the papers, "pages" for those that only the pages have.
    """
    found: dict[str, object] = {}
    for form, chosen in TEXTS[section].items():
        for name, of in chosen.items():
            rows = pd.concat([data.rows(of["label"], key, of.get("case")) for key in of["keys"]])
            rows = rows[rows["verdict"] == of["verdict"]] if "verdict" in of else rows
            values = FORMS[form](rows, of.get("digits", 2))
            found = joined(found, {name + end: text for end, text in values.items()})
    return found


FORMS: dict[str, Callable[[pd.DataFrame, int], dict[str, object]]] = {
    "range": lambda rows, digits: {"Min": below(rows["low"].min(), digits), "Max": above(rows["high"].max(), digits)},
    "least": lambda rows, digits: {"": below(rows["low"].min(), digits)},
    "most": lambda rows, digits: {"": above(rows["high"].max(), digits)},
    "percents": lambda rows, digits: {
        "Min": below(100 * rows["low"].min(), digits),
        "Max": above(100 * rows["high"].max(), digits),
    },
    "percent": lambda rows, digits: {"": _percent(rows["high"].max())},
    "power": lambda rows, digits: {"": _power(rows["high"].max())},
    "deviation": lambda rows, digits: {"": _power((rows[["low", "high"]] - 1).abs().max(axis=None))},
    "observed": lambda rows, digits: {"": f"{rows['observed'].item():.{digits}f}"},
    "cases": lambda rows, digits: {"": rows["case"].nunique()},
    "count": lambda rows, digits: {"": len(rows)},
}
"""Name of a form ↦ function of checks and a number of decimals that returns endings of a name ↦ numbers.

*range* is the smallest low end and the largest high end, *percents* both in per cent; *least* is the first of these
ends and *most* the second. *observed* is the only observed value, *cases* the number of cases and *count* the number of
checks. The others are LaTeX, rounded up to two significant digits whatever the number of decimals: *percent* and
*power* are the largest high end, *deviation* is the largest distance from 1.
"""


def _counts_of_checks(data: FullRun) -> dict[str, object]:
    """Return the numbers of verdicts, of noticed deliberate defects, and of false alarms on random meshes."""
    kinds, names = count_kinds(data.claims), data.claims.apply(account, axis=1)
    alarms, injected = data.alarms, data.faults["fault"].nunique()
    return {
        "ledgerRows": len(data.claims),
        "ledgerStatements": len(list(by_claim(data.claims))),
        **{f"ledger{verdict.capitalize()}": count for verdict, count in count_verdicts(data.claims).items()},
        **{f"kind{name.capitalize()}": count for name, count in kinds.items()},
        **{f"account{name.capitalize()}": (names == name).sum() for name in ACCOUNTS},
        "faults": injected,
        "faultsNoticed": injected - len(lacking(data.faults)),
        "seedRows": alarms.checks,
        "seeds": alarms.seeds,
        "seedRed": alarms.red,
        "seedRateMost": _percent(alarms.high),
        "seedPromise": _percent(LARGEST_RATE),
    }


def _plan(data: FullRun) -> dict[str, object]:
    """Return the numbers of cases, meshes, unknowns and planned measurements, and the versions of the libraries."""
    plane, solid = (data.rates[data.rates["dim"] == dim] for dim in (2, 3))
    cases = data.rates.groupby("claim")["case"].nunique()
    return {
        "casesSmooth": cases.get("Prop. 5.4", 0),
        "casesRough": cases.get("Prop. 5.3", 0),
        "caseCount": len(data.cases),
        "casesSolid": (data.cases["dimension"] == 3).sum(),
        "sweepRows": len(data.rates),
        "planned": len(planned_keys(data.provenance)),
        "levelCoarsest": plane["level"].min(),
        "levelFinest": plane["level"].max(),
        "levelSolid": solid["level"].max(),
        "dofsMost": f"{int(data.rates['dofs'].max()):,}".replace(",", r"\,"),
        "familyCount": plane.loc[plane["family"] != "graded", "family"].nunique(),
        "dataMissing": f"{data.rows('data', 'missing')['observed'].max():.0f}",
        "withPython": prose(data.provenance["python"]),
        "withPackages": prose(", ".join(f"{name} {number}" for name, number in data.provenance["packages"].items())),
    }


def _errors(data: FullRun) -> dict[str, object]:
    """Return further numbers for Propositions 5.3 and 5.4, the assumption (5.36) and Theorem 4.2."""
    sweeps = data.rates[data.rates["claim"] == "Prop. 5.4"]
    largest = data.equivalence.max(numeric_only=True)
    # Nonlinear laws need a fixed-point iteration in every step, which leaves a larger residual.
    yielding = sweeps["case"].isin(data.cases.loc[~data.cases["law"].str.startswith("linear"), "case"])
    plane = sweeps["dim"] == 2
    missing = without_5_36(data)
    return {
        "residualLinear": _power(sweeps.loc[~yielding & plane, "residual"].max()),
        "residualSolid": _power(sweeps.loc[~plane, "residual"].max()),
        "residualYield": _power(sweeps.loc[yielding, "residual"].max()),
        "steeper": f"{STEEPER:g}",
        "missing": len(missing),
        **{f"missingSeen{end}": text for end, text in FORMS["range"](missing, 2).items()},
        "movingProved": f"{data.cases.loc['moving-rough', 'proved_order']:g}",
        "agreeDisplacement": _power(largest["displacement_gap"]),
        "allowedDisplacement": _power(largest["displacement_bound"]),
        "agreeStress": _power(largest["stress_gap"]),
        "allowedStress": _power(largest["stress_bound"]),
        "agreeMembership": _power(largest["membership"]),
        "agreeCases": data.equivalence["case"].nunique(),
        "agreeProblems": len(data.equivalence),
    }


def without_5_36(data: FullRun) -> pd.DataFrame:
    """Return the observed orders, as checks, of the cases of order 1 that violate the assumption (5.36)."""
    seen = data.rows("(5.36)", "order")
    return seen[seen["case"].map(data.cases["expected_order"]) == 1]


def _enclosures(data: FullRun) -> dict[str, object]:
    """Return the numbers for two-sided bounds of the error (enclosures)."""
    computed = data.bounds[data.bounds["trajectory"] == "enclosure"]
    finest = computed[computed["case"] == "advance-recede"].sort_values("level").iloc[-1]
    return {
        "encloseLeast": below(computed["lower"].min(), 2),
        "encloseRows": computed["error"].count(),
        "encloseHalf": (computed["lower"] >= 0.5).sum(),
        "checkLevel": finest["level"],
        "checkUpper": above(finest["upper"], 2),
        "checkLower": below(finest["lower"], 2),
        "checkLowEnd": below(finest["lowest"], 4),
        "checkError": f"{finest['error']:.4f}",
        "checkHighEnd": above(finest["highest"], 4),
    }


def _beyond(data: FullRun) -> dict[str, object]:
    """Return further numbers for theorems of this study: time discretisation, nodal interpolants, softening laws.

    The numbers ``laws...`` are about an elasticity operator G that softens, with the constants of (4.3) and (5.21).
    """
    uniform, growth = data.rows("beyond: O(h + k)", "uniform"), data.rows("beyond: nodal start", "growth")
    constants = [data.rows("(5.20)–(5.21), (5.42)", "constant-5.21", case)["high"].max() for case in SOFTENING]
    return {
        "timeGrowth": above(100 * (uniform[["low", "high"]] - 1).abs().max(axis=None), 0),
        "startGrowth": below(-growth["high"].max(), 2),
        "lawsConstant": above(max(constants), 3),
    }


def _discrete(data: FullRun) -> dict[str, object]:
    """Return how many predictions about the error of the fully discrete scheme were met.

    The last two numbers say by which factors the constants of (5.21) and (5.42) are larger than necessary.
    """
    claims = data.claims[data.claims["label"] == "beyond: fully discrete"]
    outcomes = claims.apply(agreement, axis=1)
    found: dict[str, object] = {"discretePredictions": len(outcomes)}
    for outcome, end in (("met", "Agrees"), ("undecided", "Undecided"), ("wrong", "Differs")):
        found[f"discrete{end}"] = outcomes.eq(outcome).sum()
    label = "(5.20)–(5.21), (5.42)"
    constant = pd.concat([data.rows(label, key) for key in ("constant-5.21", "constant-5.42")])
    return found | {"roomLeast": below(1 / constant["high"].max(), 0), "roomMost": above(1 / constant["low"].min(), 0)}


def two_digits_up(value: float) -> float:
    """Return a value rounded up to two significant digits. A value with fewer digits, such as 1e-5, is unchanged."""
    return float(above(value, 1 - math.floor(math.log10(value)))) if value else 0.0


def _percent(value: float) -> str:
    return rf"{float(f'{two_digits_up(100 * value):.2g}'):g}\,\%"


def _power(value: float) -> str:
    return encode(f"{two_digits_up(value):.1e}") if value else "0"


# Tables


def group_of(label: str) -> str:
    """Return the title of the group of statements to which a label belongs.

    If several beginnings in ``GROUPS`` match the label, the longest decides; if none matches, the group is ``BEYOND``.
    """
    matches = [(len(begin), title) for title, begins in GROUPS.items() for begin in begins if label.startswith(begin)]
    return max(matches)[1] if matches else BEYOND


def verdicts(data: FullRun) -> str:
    """Return a LaTeX table with a line for each group of statements: the numbers of checks with each verdict.

    The checks that hold are counted by the kind of their evidence.
    """
    groups, body = data.claims["label"].map(group_of), []
    parts = {title: data.claims[groups == title] for title in (*GROUPS, BEYOND)} | {r"\midrule all": data.claims}
    for title, rows in parts.items():
        count = count_verdicts(rows)
        failing = len(rows) - count[HOLDS] - count[MISSED] - count[REPORTED]
        counts = *count_kinds(rows).values(), failing, count[MISSED], count[REPORTED]
        body.append([title, *map(str, counts)])
    return _table("verdicts", body)


def account(row: pd.Series) -> str:
    """Return the kind of evidence of a row of ``claims.csv``, as a key of ``ACCOUNTS``."""
    label, predicted = str(row["label"]), str(row["expected"]).startswith("predicted")
    if label in (NO_ROW, NOT_TESTED, "slips"):
        return "lines"
    if row["verdict"] in UNCLAIMED:
        return agreement(row) if predicted else "numbers"
    return str(row["kind"])


def accounts(data: FullRun) -> str:
    """Return a LaTeX table with a line for each kind of evidence in ``ACCOUNTS``, with the numbers of its checks.

    The columns are the number of checks, of checks that hold, and of checks that fail or are undecided.
    """
    names, body = data.claims.apply(account, axis=1), []
    for name, title in (ACCOUNTS | {"all": r"\midrule all"}).items():
        rows = data.claims if name == "all" else data.claims[names == name]
        count = count_verdicts(rows)
        judged = [str(count[HOLDS]), str(count[FAILS] + count[UNDECIDED])]
        unjudged = name in ("met", "undecided", "wrong", "numbers", "lines")
        body.append([title, str(len(rows)), *(["--", "--"] if unjudged else judged)])
    return _table("accounts", body)


def ledger(data: FullRun) -> str:
    """Return LaTeX tables with a line for each statement: its verdicts, and its check with the smallest margin.

    This is the check whose value uses the largest share of its tolerance window. Each group of statements has a
    separate table, which is not broken over pages.
    """
    bodies: dict[str, list[list[str]]] = {title: [] for title in (*GROUPS, BEYOND)}
    for label, claim, rows in by_claim(data.claims):
        count, judged = count_verdicts(rows), rows[~rows["verdict"].isin(UNCLAIMED)]
        counts = count[HOLDS], len(judged) - count[HOLDS], count[MISSED], count[REPORTED]
        shares = judged.apply(window_share, axis=1).dropna() if len(judged) else pd.Series(dtype=float)
        nearest = ["--", ""]
        if len(shares):
            row = judged.loc[shares.idxmax()]
            where = f"{encode_letters(str(row['quantity']))} ({prose(str(row['case']))})"
            nearest = [where, f"{_number(worst_value(row))}; {window_ends(row)}"]
        line = [encode_letters(label), encode_letters(claim), *map(str, counts), *nearest]
        bodies[group_of(label)].append(line)
    return "".join(
        f"\\par\\medskip\\noindent\\textbf{{{title}}}\\par\\nobreak\\smallskip\\noindent\n" + _table("ledger", body)
        for title, body in bodies.items()
    )


def catalogue(data: FullRun) -> str:
    """Return a LaTeX table of the exact solutions with their names, summaries and laws."""
    laws = data.cases["law"].str.removeprefix("linear, ")
    facts = zip(data.cases["case"], data.cases["summary"], laws, strict=True)
    body = [[prose(case), encode_letters(summary), encode_letters(law)] for case, summary, law in facts]
    return _table("catalogue", body)


def smooth(data: FullRun) -> str:
    """Return a LaTeX table of Proposition 5.4 with a line for each case.

    A line has the finest level, the observed orders of the error and of the discrete error, the size of the discrete
    error relative to the error, and the share of the time discretisation in per cent.
    """
    label, body = "Prop. 5.4", []
    orders = "order", "order-extrapolated", "discrete-order-superclose", "discrete-order-others"
    for case, rows in data.rates[data.rates["claim"] == label].groupby("case", sort=False):
        cells = [_cell(data, label, key, case, _range) for key in orders]
        cells.append(_cell(data, label, "discrete-share", case, lambda row: _decimals(row["observed"])))
        cells.append(_cell(data, label, "time-share", case, lambda row: f"{100 * row['observed']:.2f}"))
        body.append([prose(str(case)), _regularity(data, case), str(rows["level"].max()), *cells])
    return _table("smooth", body)


def rough(data: FullRun) -> str:
    """Return a LaTeX table of Proposition 5.3 with a line for each case.

    A line has the order that the regularity of the solution predicts, the order that the proof of Proposition 5.4 gives
    for this regularity, and the observations.
    """
    label, body = "Prop. 5.3", []
    for case in data.rates.loc[data.rates["claim"] == label, "case"].drop_duplicates():
        orders = [f"{data.cases.loc[case, name]:.3g}" for name in ("expected_order", "proved_order")]
        cells = [
            _cell(data, "(5.36)", "order", case, _range),
            _cell(data, label, "order-graded", case, lambda row: _decimals(row["observed"])),
            _cell(data, label, "falling", case, lambda row: _decimals(row["high"])),
            _cell(data, label, "limit", case, lambda row: _decimals(row["high"])),
        ]
        body.append([prose(case), _regularity(data, case), *orders, *cells])
    return _table("rough", body)


def stresses(data: FullRun) -> str:
    """Return a LaTeX table of the checks of Theorem 4.2 with a separate finite element space for stresses.

    There is a line for each case and mesh family, except shaken meshes.
    """
    rows = data.claims[(data.claims["label"] == "Thm 4.2, own space") & (data.claims["family"] != "shaken")]
    body = []
    for (case, family), part in rows.groupby(["case", "family"], sort=False):
        by_key, cells = part.set_index("key"), []
        for key in ("order-stress", "order-displacement"):
            cells += [_number(by_key.loc[key, "observed"]), window_ends(by_key.loc[key])]
        cells += [_number(by_key.loc[key, "observed"]) for key in ("order-pressure", "order-primal_stress", "growth")]
        body.append([prose(str(case)), prose(str(family)), *cells])
    return _table("stresses", body)


def enclosures(data: FullRun) -> str:
    """Return a LaTeX table of two-sided bounds of the error, for all cases that were measured on three or more levels.

    The ends of the bounds are rounded outwards. The error is empty for problems without a known exact solution.
    """
    roundings = {"lowest": down, "error": None, "highest": up, "upper": up, "lower": down}
    rows = data.bounds[data.bounds["trajectory"] == "enclosure"]
    deep = [str(case) for case, part in rows.groupby("case", sort=False) if len(part) > 2]
    body = [
        [prose(str(row["case"])), prose(str(row["family"])), str(row["level"]), _number(row["h"])]
        + ["--" if pd.isna(row[name]) else _number(row[name], rounding, 4) for name, rounding in roundings.items()]
        for _, row in rows[rows["case"].isin(deep)].iterrows()
    ]
    return _table("enclosures", body)


def discrete(data: FullRun) -> str:
    """Return a LaTeX table of the observed orders of the fully discrete error for each case and time scheme.

    Undecided predictions are marked with * and wrong predictions with †.
    """
    rows = data.claims[data.claims["label"] == "beyond: fully discrete"]
    body = []
    for case, part in rows.groupby("case", sort=False):
        by_key, first = part.set_index("key"), f"-{DISCRETE[0]}"
        for scheme in (key.removesuffix(first) for key in by_key.index if key.endswith(first)):
            cells = []
            for key in DISCRETE:
                row = by_key.loc[f"{scheme}-{key}"]
                mark = {"met": "", "undecided": "*", "wrong": r"\dagger"}[agreement(row)]
                marked = _range(row) + (rf"\rlap{{\(^{{{mark}}}\)}}" if mark else "")
                cells.append("--" if pd.isna(row["observed"]) else marked)
            body.append([prose(str(case)), prose(scheme), *cells])
    return _table("discrete", body)


def slips(data: FullRun) -> str:
    """Return a LaTeX table of the misprints in the source: place, printed text, corrected text."""
    rows = data.claims[data.claims["label"] == "slips"]
    body = [
        [encode_letters(str(row[name]).removeprefix("read: ")) for name in ("case", "quantity", "expected")]
        for _, row in rows.iterrows()
    ]
    return _table("slips", body)


def codes(data: FullRun) -> str:
    """Return a LaTeX table of other people's contact codes, a line for each code and its parameters.

    If the results of these codes are missing, the table has no lines.
    """
    body = [
        [
            prose(f"{row['code']} {row['version']}"),
            encode_letters(str(row["variant"])),
            prose(str(row["classes"])),
            f"{_decimals(row['order_low'])}--{_decimals(row['order_high'])}",
            *(_number(row[name], up) for name in ("share", "excess")),
        ]
        for row in (data.codes.rows().to_dict("records") if data.codes else [])
    ]
    return _table("codes", body)


def faults(data: FullRun) -> str:
    """Return a LaTeX table of the deliberate faults: in how many cases they are noticed, and are invisible."""
    rows = summary(data.faults)
    body = [
        [encode(f"{row['equation']}"), encode(str(row["fault"])), f"{row['size']:g}"]
        + [str(row[name]) for name in ("cases", "errors", "any_check", "invisible")]
        for _, row in rows.iterrows()
    ]
    head = ["violates", "fault", "size", "cases", "by errors", "by any check", "invisible"]
    return tabular(head, "llrrrrr", body)


def _table(name: str, body: Sequence[Sequence[str]]) -> str:
    """Return a LaTeX table with the headings and columns of ``page/article.toml`` and the given cells."""
    layout = TEXTS["tables"][name]
    columns = [folding(column) if isinstance(column, float) else column for column in layout["columns"]]
    return tabular(layout["headings"], "".join(columns), body)


def _cell(data: FullRun, label: str, key: str, case: object, write: Callable[[pd.Series], str]) -> str:
    """Return the text of a cell about the first check with a label and a key for a case; a dash if there is no check.

    ``write`` makes the text from the row of the check.
    """
    try:
        return write(data.rows(label, key, str(case)).iloc[0])
    except DataError:
        return "--"


def _decimals(value: float) -> str:
    return rf"\({value:.2f}\)" if f"{value:.2f}".startswith("-") else f"{value:.2f}"


def _range(row: pd.Series) -> str:
    low, high = _decimals(row["low"]), _decimals(row["high"])
    return low if low == high else f"{low}--{high}"


def _regularity(data: FullRun, case: object) -> str:
    """Return the regularity of the solution of a case, shortened for a narrow column."""
    text = str(data.cases.loc[str(case), "regularity"]).replace("strain with a jump inside cells", "jump inside cells")
    return encode_letters(text.replace(" front, ", ", "))


def _number(value: float, rounding: Callable[[float, int], str] | None = None, digits: int = 3) -> str:
    """Return a number as LaTeX, rounded to significant digits by ``up``, ``down`` or, by default, to the nearest."""
    rounded = rounding(value, digits) if rounding else f"{value:.{digits}g}"
    return encode(f"{float(rounded):#.{digits}g}".rstrip("."))


def window_ends(row: pd.Series) -> str:
    """Return a tolerance window as LaTeX: an interval; one inequality if an end is infinite or the lower end is 0."""
    ends = float(row["window_low"]), float(row["window_high"])
    low, high = (encode(f"{end:.4g}").strip(r"\()").removeprefix(r"1\cdot ") for end in ends)
    if ends[0] == 0 or math.isinf(ends[0]):
        return rf"\(\leq {high}\)"
    return rf"\(\geq {low}\)" if math.isinf(ends[1]) else rf"\([{low}, {high}]\)"
