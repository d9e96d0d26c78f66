"""The inputs of ``paper/`` from the data files: its tables, and macros for every measured number in its text.

Written to ``article/``, and only for a full run with its controls, which is what the article is about. Extremes are
rounded outwards: a smallest value down, a largest value up, so that no sentence says more than was seen.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path

import pandas as pd

from study.ledger.chance import PROMISE
from study.ledger.datafiles import DataError, alarm_summary, by_claim, count_caught, count_kinds, count_verdicts
from study.ledger.text import above, below, down, up
from study.ledger.verdict import (
    HOLDS,
    IDENTITY,
    MISSED,
    ONE_SIDED,
    ORDER,
    REPORTED,
    SIZE,
    THEOREM,
    UNCLAIMED,
    VERDICTS,
    agreement,
    window_share,
    worst_value,
)
from study.ledger.window import STEEPER
from study.present.full_run import FullRun
from study.present.notation import encode, encode_letters, folding, longtable, prose, tabular

DISCRETE = ("time-in-k", "time-in-h", "error-in-h", "error-in-k", "misfit")
"""Ends of the keys of predictions about the fully discrete error; other rows are there for comparison."""
NEGLIGIBLE = 1e-6
"""A defect below this amount is seen however small it is: the start has to be Π^h u_0 up to rounding."""
Named = Iterator[tuple[str, object]]


def article(directory: Path) -> dict[Path, str]:
    """Returns path ↦ text of macros and tables under ``directory/article``; nothing for a run that is not full.

    Raises:
        DataError: the data lack a row that the article names.
    """
    data = FullRun.read(directory)
    if data is None:
        return {}
    tables = (ledger, catalogue, smooth, rough, stresses, enclosures, discrete, slips, codes, sensitivity)
    texts = {"numbers": macros(data)} | {make.__name__: make(data) for make in tables}
    return {directory / "article" / f"{name}.tex": text for name, text in texts.items()}


# Macros


def macros(data: FullRun) -> str:
    """Returns \\newcommand lines, grouped by subject."""
    theory = _smooth, _rough, _equivalence, _bounds, _contact, _time, _laws, _discrete
    groups = _ledger, _plan, *theory, _packages
    lines = [rf"\newcommand{{\{name}}}{{{value}}}" for group in groups for name, value in group(data)]
    return "\n".join(["% Written by `study tables` from the data files; \\input before use.", *lines, ""])


def _ledger(data: FullRun) -> Named:
    """Verdicts, caught defects, and false alarms on fresh random meshes."""
    yield "ledgerRows", len(data.claims)
    yield "ledgerStatements", len(list(by_claim(data.claims)))
    counts = count_verdicts(data.claims)
    for verdict in VERDICTS:
        yield f"ledger{verdict.capitalize()}", counts[verdict]
    kinds = count_kinds(data.claims)
    names = {ORDER: "Orders", SIZE: "Sizes", ONE_SIDED: "Bounds", THEOREM: "Theorems", IDENTITY: "Identities"}
    for one, name in names.items():
        yield f"kind{name}", kinds[one]
    found, injected = count_caught(data.controls)
    yield "controls", injected
    yield "controlsCaught", found
    alarms = alarm_summary(data.seeds)
    yield "seedRows", alarms.rows
    yield "seeds", alarms.seeds
    yield "seedRed", alarms.red
    yield "seedsLight", alarms.light_seeds
    yield "seedRedLight", alarms.light_red
    yield "seedRateTail", "not known yet" if math.isnan(alarms.by_tail) else f"at most {_percent(alarms.by_tail)}"
    yield "seedPromise", _percent(PROMISE)


def _plan(data: FullRun) -> Named:
    """The size of the study."""
    plane, solid = (data.rates[data.rates["dim"] == dim] for dim in (2, 3))
    yield "caseCount", len(data.cases)
    for name, claim in (("casesSmooth", "Prop. 5.4"), ("casesRough", "Prop. 5.3")):
        yield name, data.rates.loc[data.rates["claim"] == claim, "case"].nunique()
    yield "casesSolid", (data.cases["dimension"] == 3).sum()
    yield "sweepRows", len(data.rates)
    yield "planned", len(data.provenance["planned"])
    yield "levelCoarsest", plane["level"].min()
    yield "levelFinest", plane["level"].max()
    yield "levelSolid", solid["level"].max()
    yield "dofsMost", f"{int(data.rates['dofs'].max()):,}".replace(",", r"\,")
    yield "familyCount", plane.loc[plane["family"] != "graded", "family"].nunique()
    yield "dataMissing", f"{data.rows('data', 'missing')['observed'].max():.0f}"


def _smooth(data: FullRun) -> Named:
    """Proposition 5.4."""
    label = "Prop. 5.4"
    yield from _extremes("orderLevel", data.rows(label, "order"))
    extrapolated = data.rows(label, "order-extrapolated")
    yield "orderExtrapolatedMin", below(extrapolated["low"].min(), 2)
    yield "orderExtrapolatedMax", above(extrapolated["high"].max(), 2)
    yield from _extremes("orderDiagonal", data.rows(label, "discrete-order-superclose"))
    yield from _extremes("orderOther", data.rows(label, "discrete-order-others"))
    yield from _extremes("pythagoras", data.rows(label, "size"))
    yield from _extremes("leadingTerm", data.rows("(5.23)", "leading-term"), 3)
    yield "shareDiscrete", _percent(data.rows(label, "discrete-share")["high"].max())
    yield "shareTimeDiscrete", _percent(data.rows(label, "discrete-time-share")["high"].max())
    yield "shareTime", _percent(data.rows(label, "time-share")["high"].max())
    yield "shareQuadrature", _percent(data.rows(label, "quadrature")["high"].max())
    sweeps = data.rates[data.rates["claim"] == label]
    # Laws that are not linear need a fixed point in every step.
    yielding = sweeps["case"].isin(data.cases.loc[~data.cases["law"].str.startswith("linear"), "case"])
    yield "residualLinear", _power(sweeps.loc[~yielding, "residual"].max())
    yield "residualYield", _power(sweeps.loc[yielding, "residual"].max())
    yield "supremumLater", (data.rows(label, "start-share")["verdict"] == HOLDS).sum()


def _rough(data: FullRun) -> Named:
    """Proposition 5.3, and what (5.36) has to do with the order."""
    label = "Prop. 5.3"
    yield "ratioMost", _most(data, label, "falling")
    yield "limitMost", _percent(data.rows(label, "limit")["high"].max())
    yield "limitSteeper", _percent(data.rows(label, "limit-steeper")["high"].max())
    yield "steeper", f"{STEEPER:g}"
    yield "roughQuadrature", _percent(data.rows(label, "quadrature")["high"].max())
    yield from _extremes("graded", data.rows(label, "order-graded"))
    seen = data.rows("(5.36)", "order")
    missing = seen[seen["case"].map(data.cases["expected_order"]) == 1]
    yield "missing", len(missing)
    yield from _extremes("missingSeen", missing)
    for name, case in (("natural", "natural-front"), ("trace", "rough-trace"), ("moving", "moving-rough")):
        yield from _extremes(f"{name}Seen", seen[seen["case"] == case])
    yield "movingProved", f"{data.cases.loc['moving-rough', 'proved_order']:g}"


def _equivalence(data: FullRun) -> Named:
    """Theorem 4.2."""
    for name, column in (
        ("agreeDisplacement", "displacement_gap"),
        ("agreeStress", "stress_gap"),
        ("agreeMembership", "membership"),
        ("allowedDisplacement", "displacement_bound"),
        ("allowedStress", "stress_bound"),
    ):
        yield name, _power(data.equivalence[column].max())
    shares = (data.rows("Thm 4.2", what)["high"].max() for what in ("displacement", "stress"))
    yield "allowedShare", above(max(shares), 2)
    yield "agreeCases", data.equivalence["case"].nunique()
    yield "agreeProblems", len(data.equivalence)
    label = "Thm 4.2, own space"
    yield "ownCases", data.claims.loc[data.claims["label"] == label, "case"].nunique()
    yield "ownAdmissible", _power(data.rows(label, "admissible")["high"].max())
    yield from _extremes("ownBest", data.rows(label, "ratio"))
    yield "frozenMost", _most(data, "Prager–Synge", "guaranteed", 3)


def _bounds(data: FullRun) -> Named:
    """The bound and the enclosures."""
    yield from _extremes("boundUpper", data.rows("bound", "upper"), 1)
    yield "boundCases", data.rows("bound", "above")["case"].nunique()
    yield "encloseUpperMax", _most(data, "enclosure", "upper")
    computed = data.bounds[data.bounds["trajectory"] == "enclosure"]
    yield "encloseLeast", below(computed["lower"].min(), 2)
    yield "encloseRows", computed["error"].count()
    for name, case in (("ramp", "ramp"), ("bracket", "bracket"), ("check", "advance-recede")):
        yield from _extremes(f"{name}Order", data.rows("enclosure", "order", case))
    finest = computed[computed["case"] == "advance-recede"].sort_values("level").iloc[-1]
    yield "checkLevel", finest["level"]
    yield "checkUpper", above(finest["upper"], 2)
    yield "checkLower", below(finest["lower"], 2)


def _contact(data: FullRun) -> Named:
    """The work of contact, and what contact costs where a narrow patch rolls along Γ3."""
    for name, key in (("Solution", "solution"), ("All", "all")):
        yield f"edge{name}", _most(data, "beyond: work on edges", key)
    label = "beyond: work of contact"
    ranges = {"Order": "order", "Mean": "order-mean", "Spread": "spread", "Irregular": "order-irregular"}
    for name, key in (ranges | {"Error": "error", "Excess": "excess"}).items():
        yield from _extremes(f"work{name}", data.rows(label, key))
    yield "workShareLeast", below(data.rows(label, "share")["observed"].min(), 2)
    yield "workExcessMost", _most(data, label, "excess-share")
    label = "beyond: rollers"
    ranges = {"Equal": "order-equal", "Alternating": "order-alternating", "Standing": "order-standing", "Best": "best"}
    for name, key in ranges.items():
        yield from _extremes(f"rollers{name}", data.rows(label, key))
    values = {"Shaken": "order-shaken", "Unstructured": "order-unstructured", "Scatter": "scatter"}
    for name, key in (values | {"StandingShaken": "order-standing-shaken"}).items():
        (observed,) = data.rows(label, key)["observed"]
        yield f"rollers{name}", f"{observed:.2f}"
    yield "rollersBound", _most(data, label, "bound")
    yield "rollersTime", _percent(data.rows(label, "time")["high"].max())
    yield "rollersShareMost", _most(data, label, "share")


def _time(data: FullRun) -> Named:
    """Errors in time with their bounds, and orders where many vertices come into contact."""
    label = "beyond: O(h + k)"
    yield "timeByData", _most(data, label, "data")
    yield "timeBySolution", _most(data, label, "solution")
    yield from _extremes("timeOrder", data.rows(label, "order"))
    uniform = data.rows(label, "uniform")
    yield "timeGrowth", above(100 * (uniform[["low", "high"]] - 1).abs().max(axis=None), 0)
    for name, key in (("rollingMid", "midpoint-rolling"), ("rollingBdf", "bdf2-rolling"), ("ownMid", "midpoint-own")):
        yield from _extremes(name, data.rows("beyond: landings", key))


def _laws(data: FullRun) -> Named:
    """How fast solutions diverge where G softens, with eigenvalues and the bound of Theorem 2.2."""
    label, soft, wells = "Thm 2.2, (4.4)", "softening", "double-well"
    rates = pd.concat([data.rows(label, key) for key in ("rate", "rate-even")])
    yield "lawsRate", _power((rates[["low", "high"]] - 1).abs().max(axis=None))
    yield "lawsEven", _power((data.rows(label, "bound-even")[["low", "high"]] - 1).abs().max(axis=None))
    yield "lawsBound", _most(data, label, "bound", 3)
    for name, case in (("Soft", soft), ("Wells", wells)):
        (row,) = data.rows("(4.3), (5.5)", "monotonicity", case)["high"]
        yield f"lawsMonotone{name}", below(row, 3)
    constants = [data.rows("(5.20)–(5.21), (5.42)", "constant-5.21", case)["high"].max() for case in (soft, wells)]
    yield "lawsConstant", above(max(constants), 3)


def _discrete(data: FullRun) -> Named:
    """How many predictions about the fully discrete error agree, and the room in the constants."""
    claims = data.claims[data.claims["label"] == "beyond: fully discrete"]
    predicted = claims["key"].str.endswith(DISCRETE)
    for name, total, rows in (
        ("discrete", "discretePredictions", claims[predicted]),
        ("discreteSums", "discreteSums", claims[~predicted]),
    ):
        outcomes = rows.apply(agreement, axis=1)
        yield total, len(outcomes)
        for outcome, macro in (("met", "Agrees"), ("undecided", "Undecided"), ("wrong", "Differs")):
            yield f"{name}{macro}", outcomes.eq(outcome).sum()
    label = "(5.20)–(5.21), (5.42)"
    constant = pd.concat([data.rows(label, key) for key in ("constant-5.21", "constant-5.42")])
    yield "roomLeast", below(1 / constant["high"].max(), 0)
    yield "roomMost", above(1 / constant["low"].min(), 0)


def _packages(data: FullRun) -> Named:
    """The programs behind the committed data."""
    yield "withPython", prose(data.provenance["python"])
    packages = data.provenance["packages"]
    yield "withPackages", ", ".join(f"{prose(name)} {prose(packages[name])}" for name in packages)


def _extremes(name: str, rows: pd.DataFrame, digits: int = 2) -> Named:
    yield f"{name}Min", below(rows["low"].min(), digits)
    yield f"{name}Max", above(rows["high"].max(), digits)


def _most(data: FullRun, label: str, key: str, digits: int = 2) -> str:
    return above(data.rows(label, key)["high"].max(), digits)


def two_digits_up(value: float) -> float:
    """Returns a value rounded up to two significant digits; 1e-5 stays 1e-5."""
    return float(above(value, 1 - math.floor(math.log10(value)))) if value else 0.0


def _percent(value: float) -> str:
    return rf"{float(f'{two_digits_up(100 * value):.2g}'):g}\,\%"


def _power(value: float) -> str:
    return encode(f"{two_digits_up(value):.1e}") if value else "0"


# Tables


def ledger(data: FullRun) -> str:
    """Returns one row per statement: the number of verdicts of each kind, and the row that uses most of its window."""
    body = []
    for label, claim, rows in by_claim(data.claims):
        count, judged = count_verdicts(rows), rows[~rows["verdict"].isin(UNCLAIMED)]
        counts = count[HOLDS], len(judged) - count[HOLDS], count[MISSED], count[REPORTED]
        shares = judged.apply(window_share, axis=1).dropna() if len(judged) else pd.Series(dtype=float)
        nearest = ["--", "", ""]
        if len(shares):
            row = judged.loc[shares.idxmax()]
            where = f"{encode_letters(str(row['quantity']))} ({prose(str(row['case']))})"
            nearest = [where, _number(worst_value(row)), window_ends(row)]
        body.append([encode_letters(label), encode_letters(claim), *map(str, counts), *nearest])
    label, statement, quantity = (folding(width) for width in (0.11, 0.215, 0.265))
    counted = "hold", "not", "missed", "rep."
    headings = ["no.", "what it says", *counted, "row nearest to the end of its window", "seen", "window"]
    return longtable(headings, [label, statement, "r", "r", "r", "r", quantity, "r", "l"], [("", body)])


def catalogue(data: FullRun) -> str:
    """Returns the exact solutions: name, what the zone does, law."""
    laws = data.cases["law"].str.removeprefix("linear, ")
    facts = zip(data.cases["case"], data.cases["summary"], laws, strict=True)
    body = [[prose(case), encode_letters(summary), encode_letters(law)] for case, summary, law in facts]
    return tabular(["case", "what it does", "law (linear but for (3.3))"], f"l{folding(0.5)}{folding(0.27)}", body)


def smooth(data: FullRun) -> str:
    """Returns Prop. 5.4, one row per case: orders of the error and of the discrete error, finest level, time share."""
    label, body = "Prop. 5.4", []
    for case, rows in data.rates[data.rates["claim"] == label].groupby("case", sort=False):
        cells = [
            _cell(data, label, "order", case, _range),
            _cell(data, label, "order-extrapolated", case, _range),
            _cell(data, label, "discrete-order-superclose", case, _range),
            _cell(data, label, "discrete-order-others", case, _range),
            _cell(data, label, "discrete-share", case, _observed),
            _cell(data, label, "time-share", case, lambda row: f"{100 * row['observed']:.2f}"),
        ]
        body.append([prose(str(case)), _regularity(data, case), str(rows["level"].max()), *cells])
    headings = ["case", "regularity", r"\(n\)", "orders", "extrapolated", "superclose", "other", "share", r"time, \%"]
    return tabular(headings, "llrrrrrrr", body)


def rough(data: FullRun) -> str:
    """Returns Prop. 5.3, one row per case: the predicted order, the order that the proof of 5.4 gives, and the data."""
    label, body = "Prop. 5.3", []
    for case in data.rates.loc[data.rates["claim"] == label, "case"].drop_duplicates():
        orders = [f"{data.cases.loc[case, name]:.3g}" for name in ("expected_order", "proved_order")]
        cells = [
            _cell(data, "(5.36)", "order", case, _range),
            _cell(data, label, "order-graded", case, _observed),
            _cell(data, label, "falling", case, _high),
            _cell(data, label, "limit", case, _high),
        ]
        body.append([prose(case), _regularity(data, case), *orders, *cells])
    headings = ["case", "regularity", "predicted", "proved", "seen", "graded", "ratio", r"\(e_\infty/e\)"]
    return tabular(headings, "llrrrrrr", body)


def stresses(data: FullRun) -> str:
    """Returns Theorem 4.2 on its own stress space, a row per case and family that is not shaken: orders and windows."""
    rows = data.claims[(data.claims["label"] == "Thm 4.2, own space") & (data.claims["family"] != "shaken")]
    body = []
    for (case, family), part in rows.groupby(["case", "family"], sort=False):
        by_key, cells = part.set_index("key"), []
        for key in ("order-stress", "order-displacement"):
            cells += [_number(by_key.loc[key, "observed"]), window_ends(by_key.loc[key])]
        cells += [_number(by_key.loc[key, "observed"]) for key in ("order-pressure", "order-primal_stress", "growth")]
        body.append([prose(str(case)), prose(str(family)), *cells])
    headings = ["case", "meshes", r"\(\sigma^h\)", "window", "multipliers", "window", "pressure"]
    return tabular([*headings, r"\(\sigma(u^h)\)", "growth"], "llrlrlrrr", body)


def enclosures(data: FullRun) -> str:
    """Returns the enclosures on three levels: of a case with an exact solution, and of problems without one.

    Ends are rounded outwards.
    """
    roundings = {"lowest": down, "error": _nearest, "highest": up, "upper": up, "lower": down}
    rows = data.bounds[data.bounds["trajectory"] == "enclosure"]
    deep = [str(case) for case, part in rows.groupby("case", sort=False) if len(part) > 2]
    body = [
        [prose(str(row["case"])), prose(str(row["family"])), str(row["level"]), _number(row["h"])]
        + ["--" if pd.isna(row[name]) else _number(row[name], rounding, 4) for name, rounding in roundings.items()]
        for _, row in rows[rows["case"].isin(deep)].iterrows()
    ]
    headings = ["problem", "meshes", *(rf"\({name}\)" for name in "nh"), "lower end", "error", "upper end"]
    return tabular([*headings, "upper/error", "lower/error"], "llrrrrrrr", body)


def discrete(data: FullRun) -> str:
    """Returns the fully discrete error, a row per case and scheme: 95 % intervals of orders.

    Undecided predictions are marked with * and wrong ones with †.
    """
    rows = data.claims[data.claims["label"] == "beyond: fully discrete"]
    body = []
    for case, part in rows.groupby("case", sort=False):
        by_key, first = part.set_index("key"), f"-{DISCRETE[0]}"
        for scheme in (key.removesuffix(first) for key in by_key.index if key.endswith(first)):
            cells = []
            for key in DISCRETE:
                row = by_key.loc[f"{scheme}-{key}"]
                interval = rf"\([{row['low']:.2f}, {row['high']:.2f}]\)" if row["low"] < row["high"] else _range(row)
                mark = {"met": "", "undecided": "*", "wrong": r"\dagger"}[agreement(row)]
                marked = interval + (rf"\rlap{{\(^{{{mark}}}\)}}" if mark else "")
                cells.append("--" if pd.isna(row["observed"]) else marked)
            body.append([prose(str(case)), prose(scheme), *cells])
    headings = ["case", "scheme", r"\(q\) of \(d\)", r"\(s\) of \(d\)", r"\(p\) of \(e\)", r"\(q\) of \(e\)", "misfit"]
    return tabular(headings, "llrrrrr", body)


def slips(data: FullRun) -> str:
    """Returns the misprints in the source: place, what is printed, how it has to be read."""
    rows = data.claims[data.claims["label"] == "slips"]
    body = [
        [encode_letters(str(row[name]).removeprefix("read: ")) for name in ("case", "quantity", "expected")]
        for _, row in rows.iterrows()
    ]
    headings = ["place", "printed", "how it is read here, and why"]
    return tabular(headings, "".join(folding(width) for width in (0.14, 0.3, 0.5)), body)


def codes(data: FullRun) -> str:
    """Returns other people's contact codes with their parameters, a row each; no rows if there are no data."""
    body = [
        [
            prose(f"{row['code']} {row['version']}"),
            encode_letters(str(row["variant"])),
            prose(str(row["classes"])),
            f"{row['order_low']:.2f}--{row['order_high']:.2f}",
            *(_number(row[name], up) for name in ("share", "excess")),
        ]
        for row in (data.codes.rows().to_dict("records") if data.codes else [])
    ]
    headings = ["code", "parameters", "class (series)", "order", r"\(d/e\)", r"\(e_p\)"]
    return tabular(headings, "".join(folding(width) for width in (0.17, 0.25, 0.22)) + "rrr", body)


def sensitivity(data: FullRun) -> str:
    """Returns the smallest defects in per cent that a row sees on every mesh family; no rows without data."""
    if data.sensitivity is None:
        return tabular(["case"], "l", [])
    largest = data.sensitivity.groupby(["case", "defect"], sort=False)["amount"].max().unstack("defect")
    largest = largest[[name for name in data.sensitivity["defect"].unique() if largest[name].min() > NEGLIGIBLE]]
    body = [[prose(str(case)), *(_number(100 * amount, up, 2) for amount in row)] for case, row in largest.iterrows()]
    return tabular(["case", *map(encode, largest.columns)], "l" + "r" * largest.shape[1], body)


def _cell(data: FullRun, label: str, key: str, case: object, write: Callable[[pd.Series], str]) -> str:
    """Returns one cell from the first such row of the ledger; a dash if the case has none."""
    try:
        return write(data.rows(label, key, str(case)).iloc[0])
    except DataError:
        return "--"


def _decimals(value: float) -> str:
    return rf"\({value:.2f}\)" if f"{value:.2f}".startswith("-") else f"{value:.2f}"


def _observed(row: pd.Series) -> str:
    return _decimals(row["observed"])


def _high(row: pd.Series) -> str:
    return _decimals(row["high"])


def _range(row: pd.Series) -> str:
    low, high = _decimals(row["low"]), _decimals(row["high"])
    return low if low == high else f"{low}--{high}"


def _regularity(data: FullRun, case: object) -> str:
    """Returns the exponents of a case, short enough for a column."""
    text = str(data.cases.loc[str(case), "regularity"])
    return encode_letters(
        text.replace("strain with a jump inside cells", "jump inside cells").replace(" front, ", ", ")
    )


def _nearest(value: float, digits: int) -> str:
    return f"{value:.{digits}g}"


def _number(value: float, rounding: Callable[[float, int], str] = _nearest, digits: int = 3) -> str:
    """Returns a measured number with some significant digits."""
    return encode(f"{float(rounding(value, digits)):#.{digits}g}".rstrip("."))


def window_ends(row: pd.Series) -> str:
    """Returns the ends of a window as mathematics; a low end of 0 or −∞ is left out."""
    ends = float(row["window_low"]), float(row["window_high"])
    low, high = (encode(f"{end:.4g}").strip(r"\()").removeprefix(r"1\cdot ") for end in ends)
    if ends[0] == 0 or math.isinf(ends[0]):
        return rf"\(\leq {high}\)"
    return rf"\(\geq {low}\)" if math.isinf(ends[1]) else rf"\([{low}, {high}]\)"
