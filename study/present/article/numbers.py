"""Macros of LaTeX for the measured numbers in the text of the article, each a small formula on the data files.

Extremes are rounded outwards: a smallest value down, a largest up, so that no sentence says more than was seen.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import pandas as pd

from study.ledger.chance import PROMISE
from study.ledger.datafiles import by_claim, caught, count_verdicts, raised
from study.ledger.margin import agreement
from study.ledger.rounding import above, below
from study.present.article.source import FullRun
from study.present.latex import encode, prose

DISCRETE = ("time-in-k", "time-in-h", "error-in-h", "error-in-k", "misfit")
"""What is predicted of the fully discrete error, as the keys of rows end; the others are there for comparison."""


def macros(data: FullRun) -> str:
    """\\newcommand lines, sorted by nothing but their subject."""
    theory = _smooth, _rough, _equivalence, _bounds, _work, _rollers, _time, _laws, _beyond
    groups = (_ledger, _seeds, _plan, *theory, _made_with)
    lines = [rf"\newcommand{{\{name}}}{{{value}}}" for group in groups for name, value in group(data)]
    return "\n".join(["% Written by `study tables` from the data files; \\input before use.", *lines, ""])


Named = Iterator[tuple[str, str]]


def _ledger(data: FullRun) -> Named:
    """How many rows of the ledger hold, and how many defects were caught."""
    yield "ledgerRows", str(len(data.claims))
    yield "ledgerStatements", str(len(list(by_claim(data.claims))))
    counts = count_verdicts(data.claims)
    for verdict in ("holds", "fails", "undecided", "reported"):
        yield f"ledger{verdict.capitalize()}", str(counts[verdict])
    found, injected = caught(data.controls)
    yield "controls", str(injected)
    yield "controlsCaught", str(found)


def _seeds(data: FullRun) -> Named:
    """How often chance turned the ledger red on fresh random meshes, and how often the tails let one expect it."""
    found = raised(data.seeds)
    yield "seedRows", str(found.rows)
    yield "seeds", str(found.seeds)
    yield "seedRed", str(found.red)
    yield "seedsLight", str(found.light_seeds)
    yield "seedRedLight", str(found.light_red)
    yield "seedRateTail", "not known yet" if math.isnan(found.by_tail) else f"at most {_percent(found.by_tail)}"
    yield "seedPromise", _percent(PROMISE)


def _plan(data: FullRun) -> Named:
    """The size of the study."""
    plane = data.rates[data.rates["dim"] == 2]
    yield "caseCount", str(len(data.cases))
    for name, claim in (("casesSmooth", "Prop. 5.4"), ("casesRough", "Prop. 5.3")):
        yield name, str(data.rates.loc[data.rates["claim"] == claim, "case"].nunique())
    yield "casesSolid", str(int((data.cases["dimension"] == 3).sum()))
    yield "sweepRows", str(len(data.rates))
    yield "planned", str(len(data.provenance["planned"]))
    yield "levelCoarsest", str(int(plane["level"].min()))
    yield "levelFinest", str(int(plane["level"].max()))
    yield "levelSolid", str(int(data.rates.loc[data.rates["dim"] == 3, "level"].max()))
    yield "dofsMost", f"{int(data.rates['dofs'].max()):,}".replace(",", r"\,")
    yield "familyCount", str(plane.loc[plane["family"] != "graded", "family"].nunique())
    yield "dataMissing", f"{data.rows('data', 'missing')['observed'].max():.0f}"


def _smooth(data: FullRun) -> Named:
    """Prop. 5.4."""
    label = "Prop. 5.4"
    yield from _extremes("orderLevel", data.rows(label, "order"))
    fitted = data.rows(label, "order-fitted")["observed"]
    yield "orderFittedMin", below(fitted.min(), 2)
    yield "orderFittedMax", above(fitted.max(), 2)
    yield from _extremes("orderDiagonal", data.rows(label, "discrete-order-superclose"))
    yield from _extremes("orderOther", data.rows(label, "discrete-order-others"))
    yield from _extremes("pythagoras", data.rows(label, "size"))
    yield from _extremes("leadingTerm", data.rows("(5.23)", "leading-term"), 3)
    yield "shareDiscrete", _percent(data.rows(label, "discrete-share")["high"].max())
    yield "shareTimeDiscrete", _percent(data.rows(label, "discrete-time-share")["high"].max())
    yield "shareTime", _percent(data.rows(label, "time-share")["high"].max())
    yield "shareQuadrature", _percent(data.rows(label, "quadrature")["high"].max())
    sweeps = data.rates[data.rates["claim"] == label]
    # Laws with a fixed point in every step.
    yielding = sweeps["case"].isin(data.cases.loc[~data.cases["law"].str.startswith("linear"), "case"])
    yield "residualLinear", _power(sweeps.loc[~yielding, "residual"].max())
    yield "residualYield", _power(sweeps.loc[yielding, "residual"].max())
    yield "supremumLater", f"{data.rows(label, 'after-start')['observed'].iloc[0]:.0f}"


def _rough(data: FullRun) -> Named:
    """Prop. 5.3 and what (5.36) has to do with the order."""
    label = "Prop. 5.3"
    yield "ratioMost", above(data.rows(label, "falling")["high"].max(), 2)
    yield "limitMost", _percent(data.rows(label, "limit")["high"].max())
    yield "roughQuadrature", _percent(data.rows(label, "quadrature")["high"].max())
    yield from _extremes("graded", data.rows(label, "order-graded"))
    seen, proved = data.rows("(5.36)", "order"), data.cases["proved_order"]
    missing = seen[seen["case"].map(data.cases["expected_order"]) == 1]
    yield "missing", str(len(missing))
    yield from _extremes("missingSeen", missing)
    for name, case in (("natural", "natural-front"), ("trace", "rough-trace"), ("moving", "moving-rough")):
        yield from _extremes(f"{name}Seen", seen[seen["case"] == case])
    yield "movingProved", f"{proved['moving-rough']:g}"


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
    yield "agreeCases", str(data.equivalence["case"].nunique())
    yield "agreeProblems", str(len(data.equivalence))
    label = "Thm 4.2, own space"
    yield "ownCases", str(data.claims.loc[data.claims["label"] == label, "case"].nunique())
    yield "ownAdmissible", _power(data.rows(label, "admissible")["high"].max())
    yield from _extremes("ownBest", data.rows(label, "ratio"))
    frozen = data.rows("Prager–Synge", "guaranteed")
    yield "frozenMost", above(frozen["high"].max(), 3)


def _bounds(data: FullRun) -> Named:
    """The bound and the enclosures."""
    yield from _extremes("boundUpper", data.rows("bound", "upper"), 1)
    yield "boundCases", str(data.rows("bound", "above")["case"].nunique())
    yield "encloseUpperMax", above(data.rows("enclosure", "upper")["high"].max(), 2)
    computed = data.bounds[data.bounds["trajectory"] == "enclosure"]
    yield "encloseLeast", below(computed["lower"].min(), 2)
    yield "encloseRows", str(computed["error"].count())
    for name, case in (("ramp", "ramp"), ("bracket", "bracket"), ("check", "advance-recede")):
        yield from _extremes(f"{name}Order", data.rows("enclosure", "order", case))
    finest = computed[computed["case"] == "advance-recede"].sort_values("level").iloc[-1]
    yield "checkLevel", str(finest["level"])
    yield "checkUpper", above(finest["upper"], 2)
    yield "checkLower", below(finest["lower"], 2)


def _work(data: FullRun) -> Named:
    """The work of contact, on edges and altogether."""
    edges, label = "beyond: work on edges", "beyond: work of contact"
    for name, key in (("Solution", "solution"), ("All", "all")):
        yield f"edge{name}", above(data.rows(edges, key)["high"].max(), 2)
    for name, key in (
        ("Order", "order"),
        ("Mean", "order-mean"),
        ("Spread", "spread"),
        ("Irregular", "order-irregular"),
    ):
        yield from _extremes(f"work{name}", data.rows(label, key))
    for name in ("error", "excess"):
        yield from _extremes(f"work{name.capitalize()}", data.rows(label, name))
    shares = data.rows(label, "share")["observed"]
    yield "workShareLeast", below(shares.min(), 2)
    yield "workExcessMost", above(data.rows(label, "excess-share")["high"].max(), 2)


def _rollers(data: FullRun) -> Named:
    """What contact costs where a narrow patch rolls along Γ3, and the theorem's bound."""
    label = "beyond: rollers"
    for name, key in (("Equal", "order-equal"), ("Alternating", "order-alternating"), ("Standing", "order-standing")):
        yield from _extremes(f"rollers{name}", data.rows(label, key))
    yield from _extremes("rollersBest", data.rows(label, "best"))
    for name, key in (
        ("Shaken", "order-shaken"),
        ("Unstructured", "order-unstructured"),
        ("Scatter", "scatter"),
        ("StandingShaken", "order-standing-shaken"),
    ):
        (row,) = data.rows(label, key)["observed"]
        yield f"rollers{name}", f"{row:.2f}"
    yield "rollersBound", above(data.rows(label, "bound")["high"].max(), 2)
    yield "rollersTime", _percent(data.rows(label, "time")["high"].max())
    yield "rollersShareMost", above(data.rows(label, "share")["high"].max(), 2)


def _time(data: FullRun) -> Named:
    """Errors in time beside their bounds, and orders where many vertices land."""
    label = "beyond: O(h + k)"
    yield "timeByData", above(data.rows(label, "data")["high"].max(), 2)
    yield "timeBySolution", above(data.rows(label, "solution")["high"].max(), 2)
    yield from _extremes("timeOrder", data.rows(label, "order"))
    uniform = data.rows(label, "uniform")
    yield "timeGrowth", above(100 * (uniform[["low", "high"]] - 1).abs().max(axis=None), 0)
    for name, key in (("rollingMid", "midpoint-rolling"), ("rollingBdf", "bdf2-rolling"), ("ownMid", "midpoint-own")):
        yield from _extremes(name, data.rows("beyond: landings", key))


def _laws(data: FullRun) -> Named:
    """How fast solutions part where G softens, beside eigenvalues and the bound of Theorem 2.2."""
    label, soft, wells = "Thm 2.2, (4.4)", "softening", "double-well"
    rates = pd.concat([data.rows(label, key) for key in ("rate", "rate-even")])
    yield "lawsRate", _power((rates[["low", "high"]] - 1).abs().max(axis=None))
    yield "lawsEven", _power((data.rows(label, "bound-even")[["low", "high"]] - 1).abs().max(axis=None))
    yield "lawsBound", above(data.rows(label, "bound")["high"].max(), 3)
    for name, case in (("Soft", soft), ("Wells", wells)):
        (row,) = data.rows("(4.3), (5.5)", "monotonicity", case)["high"]
        yield f"lawsMonotone{name}", below(row, 3)
    constants = [data.rows("(5.20)–(5.21), (5.42)", "constant-5.21", case)["high"].max() for case in (soft, wells)]
    yield "lawsConstant", above(max(constants), 3)


def _beyond(data: FullRun) -> Named:
    """How many predictions about the fully discrete error came true, of those in the table."""
    claims = data.claims[data.claims["label"] == "beyond: fully discrete"]
    outcomes = claims[claims["key"].str.endswith(DISCRETE)].apply(agreement, axis=1)
    yield "discretePredictions", str(len(outcomes))
    for outcome in ("agrees", "undecided", "differs"):
        yield f"discrete{outcome.capitalize()}", str(int(outcomes.eq(outcome).sum()))
    others = claims[~claims["key"].str.endswith(DISCRETE)].apply(agreement, axis=1)
    yield "discreteSums", str(len(others))
    for outcome in ("agrees", "undecided", "differs"):
        yield f"discreteSums{outcome.capitalize()}", str(int(others.eq(outcome).sum()))
    label = "(5.20)–(5.21), (5.42)"
    constant = pd.concat([data.rows(label, key) for key in ("constant-5.21", "constant-5.42")])
    yield "roomLeast", below(1 / constant["high"].max(), 0)
    yield "roomMost", above(1 / constant["low"].min(), 0)


def _made_with(data: FullRun) -> Named:
    """The programs behind the committed data."""
    yield "withPython", prose(data.provenance["python"])
    packages = data.provenance["packages"]
    yield "withPackages", ", ".join(f"{prose(name)} {prose(packages[name])}" for name in packages)


def _extremes(name: str, rows: pd.DataFrame, digits: int = 2) -> Named:
    yield f"{name}Min", below(rows["low"].min(), digits)
    yield f"{name}Max", above(rows["high"].max(), digits)


def _upper(value: float) -> float:
    """Rounded up to two significant digits."""
    if value == 0:
        return 0.0
    return float(above(value, 1 - math.floor(math.log10(value))))


def _percent(value: float) -> str:
    return rf"{float(f'{_upper(100 * value):.2g}'):g}\,\%"


def _power(value: float) -> str:
    return encode(f"{_upper(value):.1e}") if value else "0"
