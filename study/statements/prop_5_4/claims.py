"""Orders of convergence and the two formulations: measured quantity ↔ verdict, from the data on disk alone.

Orders are judged two-sided, since (5.37) is sharp for piecewise linears. So is the size of the
errors, through three relations; the first shares no code with what measures the errors:

* ‖u − Π^h u‖_V against its leading term computed from second derivatives of u (within 5 %);
* (‖u − u^h‖² + ‖Π^h u − u^h‖²)^{1/2} / ‖u − Π^h u‖ = 1 within 10 %: were u^h the best
  approximation of u in V^h, this would be Pythagoras' theorem, and contact and memory disturb it
  little. It ties the error to the interpolation error, which the first relation has fixed;
* the parallelogram law of u − u^h and u − Π^h u, at every time. It ties the error to u^h: that of Π^h u
  would pass the others, being nearly as large.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pandas as pd

from manufactured.tensors import Array
from study.ledger.orders import fit, limit, orders
from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED, Verdict, Window
from study.solve.solver_choice import residual

JUDGED = 3
"""Fewer levels leave an order undecided; fits look at one more of the finest ones."""


TIME_SHARE = Window(0.0, 0.02, "≤ 2 % of the error")
RESIDUAL = Window(0.0, 1.0, "≤ 1: 1e-10 of a factorisation, 0.01 h² of multigrid (study/solve/choice.py)")
CLAMPED = Window(0.0, 1e-10, "≤ 1e-10")
QUADRATURE = Window(0.0, 0.02, "≤ 2 % of the error")
SIZE = Window(0.9, 1.1, "1 ± 0.1 (Pythagoras)")
PREDICTED = Window(0.95, 1.05, "1 ± 0.05 of the leading term")
PARALLELOGRAM = Window(0.0, 1e-3, "≤ 1e-3: exact but for rounding and two quadratures of A's factor")
DISCRETE_TIME = Window(0.0, 0.3, "≤ 30 % of the discrete error")
DISCRETE_SHARE = Window(0.0, 0.6, "≤ 0.6 of the interpolation error: by Pythagoras both errors differ by ≤ 20 %")
AGREEMENT = Window(0.0, 1e-7, "≤ 1e-7 at every step")
ALLOWED = Window(0.0, 1.0, "≤ 1, proved (study/statements/thm_4_2/same_mesh.py)")
SHARP = Window(0.0, 1e-5, "≤ 1e-5: 32 steps, each the root of a gap of 1e-15, and norms 10 apart")
AXES = Window(0.0, 1e-10, "≤ 1e-10")
AXES_DISCRETE = Window(0.0, 1e-7, "≤ 1e-7: round-off times the condition, of order h⁻²")
SOLID = Window(0.9, 1.1, "1 ± 0.1")
ROUGH_ORDER = 0.15
GRADED, UNSTRUCTURED = "graded", "unstructured"
"""Families with a prediction of their own, or with meshes that depend on the axes."""
LATER = 0.99
LIMIT = Window(-math.inf, 0.1, "e∞ ≤ 10 % of the finest errors")
"""Over two refinements an order s − δ instead of s looks like e∞/e = (1 − 4^{−δ})/(1 − 4^{−s}): for s = 1/4
the window answers to δ = 0.02, as sharp as the place of a front within its cell lets orders be."""

NORMS = {"error": "‖u − u^h‖_V", "interpolation_error": "‖u − Π^h u‖_V", "discrete_error": "‖Π^h u − u^h‖_V"}

STATEMENTS = {
    "data": "every planned measurement is there",
    "Prop. 5.4": "‖u − u^h‖_{L∞(0,T;V)} = O(h)",
    "Prop. 5.3": "‖u − u^h‖_{L∞(0,T;V)} → 0",
    "(5.23)": "‖v − Π^h v‖_V ≤ c h |v|_{H²}",
    "(5.36)": "is the regularity that Prop. 5.4 asks for needed?",
    "axes": "nothing depends on the axes: a turned body has the errors of the unturned one",
    "Thm 4.2": "Problem 3.2 on the strains of V^h and Problem 3.1 have one solution",
}


def families(rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """The rows of each mesh family, coarse to fine."""
    return {str(name): group.sort_values("h", ascending=False) for name, group in rows.groupby("family", sort=False)}


Measure = Callable[[pd.DataFrame], tuple[float, tuple[float, float]]]
"""Rows of one family, coarse to fine ↦ (observed value, its range)."""


def _verdict(
    label: str, case: str, quantity: str, window: Window, groups: dict[str, pd.DataFrame], measure: Measure
) -> Verdict:
    values = [measure(group) for group in groups.values()]
    observed, low, high, verdict = window.judge([v for v, _ in values], [r for _, r in values])
    return Verdict(label, STATEMENTS[label], case, quantity, window.text, observed, low, high, verdict)


def _undecided(label: str, case: str, quantity: str, window: Window) -> Verdict:
    return Verdict(label, STATEMENTS[label], case, quantity, window.text, math.nan, -math.inf, math.inf, UNDECIDED)


def _order_verdict(
    label: str, case: str, quantity: str, window: Window, groups: dict[str, pd.DataFrame], measure: Measure
) -> Verdict:
    if min(len(group) for group in groups.values()) < JUDGED:
        return _undecided(label, case, quantity, window)
    return _verdict(label, case, quantity, window, groups, measure)


def consecutive(column: str) -> Measure:
    """Every consecutive order; observed is the finest."""

    def measure(group: pd.DataFrame) -> tuple[float, tuple[float, float]]:
        found = orders(group["h"].to_numpy(), group[column].to_numpy())
        return float(found[-1]), (float(found.min()), float(found.max()))

    return measure


def fitted(column: str) -> Measure:
    """Least-squares order over up to JUDGED + 1 finest levels with its 95 % interval."""

    def measure(group: pd.DataFrame) -> tuple[float, tuple[float, float]]:
        judged = group.tail(JUDGED + 1)
        line = fit(judged["h"].to_numpy(), judged[column].to_numpy())
        return line.order, (line.low, line.high)

    return measure


def finest(value: Callable[[pd.DataFrame], pd.Series]) -> Measure:
    """A quantity on the finest level."""

    def measure(group: pd.DataFrame) -> tuple[float, tuple[float, float]]:
        last = float(value(group).iloc[-1])
        return last, (last, last)

    return measure


def largest(column: str) -> Measure:
    """The largest value of a column over all levels."""

    def measure(group: pd.DataFrame) -> tuple[float, tuple[float, float]]:
        return _worst(group[column].to_numpy())

    return measure


def _residual(group: pd.DataFrame) -> tuple[float, tuple[float, float]]:
    """Residuals of the contact solves over what the solver of that size is asked for."""
    return _worst(np.array([row.residual / residual(row.dim, row.dofs) for row in group.itertuples()]))


def _worst(values: Array) -> tuple[float, tuple[float, float]]:
    """The largest of some values and their range; not a number if one of them is none, which no window contains."""
    low, high = float(np.min(values)), float(np.max(values))
    return high, (low, high)


def _size(group: pd.DataFrame) -> pd.Series:
    return np.hypot(group["error"], group["discrete_error"]) / group["interpolation_error"]  # type: ignore[no-any-return]


def prop_5_4(case: str, rows: pd.DataFrame, expected: float) -> list[Verdict]:
    """Order 1, two-sided, with everything that keeps the verdict from being vacuous."""
    label, groups = "Prop. 5.4", families(rows)
    order = Window(expected - 0.15, expected + 0.15, f"{expected:g} ± 0.15, every consecutive order")
    line = Window(expected - 0.1, expected + 0.1, f"{expected:g} ± 0.1, least squares; interval in (0, 2)")
    discrete = _discrete(label, case, groups)
    return [
        _order_verdict(label, case, "order of the error, level by level", order, groups, consecutive("error")),
        _fitted_verdict(label, case, line, groups),
        _verdict(label, case, "size of the error", SIZE, groups, finest(_size)),
        *discrete,
        _supremum(label, case, groups, discrete),
        _verdict(
            "(5.23)",
            case,
            "‖u − Π^h u‖_V / leading term",
            PREDICTED,
            groups,
            finest(lambda g: g["interpolation_error"] / g["predicted_interpolation"]),
        ),
        *_evidence(label, case, groups),
        *(_solid(label, case, groups) if int(rows["dim"].iloc[0]) == 3 else []),
    ]


def _solid(label: str, case: str, groups: dict[str, pd.DataFrame]) -> list[Verdict]:
    """In 3D, where few levels can be had, the finest pair alone must be nearer to 1."""
    return [
        _order_verdict(label, case, f"order of {name}, finest pair", SOLID, groups, last_order(column, 1))
        for name, column in (("the error", "error"), ("‖u − Π^h u‖_V", "interpolation_error"))
    ]


def last_order(column: str, refinements: int) -> Measure:
    """The order between the finest level and the one so many refinements before."""

    def measure(group: pd.DataFrame) -> tuple[float, tuple[float, float]]:
        judged = group.iloc[[-1 - refinements, -1]]
        value = float(orders(judged["h"].to_numpy(), judged[column].to_numpy())[0])
        return value, (value, value)

    return measure


def _fitted_verdict(label: str, case: str, window: Window, groups: dict[str, pd.DataFrame]) -> Verdict:
    """The fitted order must lie in the window, its interval must exclude order 0 and order 2."""
    quantity = "order of the error, fitted"
    if min(len(group) for group in groups.values()) < JUDGED:
        return _undecided(label, case, quantity, window)
    values = [fitted("error")(group) for group in groups.values()]
    observed, low, high, _ = window.judge([v for v, _ in values], [r for _, r in values])
    inside = all(window.low <= v <= window.high for v, _ in values)
    verdict = FAILS if not inside else HOLDS if low > 0 and high < 2 else UNDECIDED
    return Verdict(label, STATEMENTS[label], case, quantity, window.text, observed, low, high, verdict)


def _discrete(label: str, case: str, groups: dict[str, pd.DataFrame]) -> list[Verdict]:
    """‖Π^h u − u^h‖_V, what the solver did: its order, its share, and when the error is largest.

    On one-diagonal meshes neighbouring triangles form parallelograms and Π^h u − u^h is superclose,
    of order 3/2 (traction boundary) to 2; elsewhere it is at least of the order of the error. At
    most it is of order 2.
    """
    superclose = {name: group for name, group in groups.items() if name == "one-diagonal"}
    others = {name: group for name, group in groups.items() if name != "one-diagonal"}
    found = []
    for chosen, window in (
        (superclose, Window(1.3, 2.2, "3/2 … 2 on one-diagonal meshes (superclose), ± 0.2")),
        (others, Window(0.85, 2.2, "1 … 2 on other meshes, − 0.15 + 0.2")),
    ):
        if chosen:
            which = "superclose" if chosen is superclose else "other families"
            found.append(
                _order_verdict(
                    label, case, f"order of ‖Π^h u − u^h‖_V, {which}", window, chosen, _last_fit("discrete_error")
                )
            )
    share = finest(lambda g: g["discrete_error"] / g["interpolation_error"])
    return [
        *found,
        _verdict(label, case, "‖Π^h u − u^h‖_V / ‖u − Π^h u‖_V", DISCRETE_SHARE, groups, share),
        _verdict(label, case, "time share of ‖Π^h u − u^h‖_V", DISCRETE_TIME, groups, largest("discrete_time_share")),
    ]


def _supremum(label: str, case: str, groups: dict[str, pd.DataFrame], discrete: list[Verdict]) -> Verdict:
    """The largest error must come after t = 0, where it would be that of Π^h u_0 and nothing was solved.

    Where it sits at t = 0 the case says nothing but through its discrete error, which must then hold.
    """
    shares = np.array([np.max((group["initial_error"] / group["error"]).to_numpy()) for group in groups.values()])
    worst, (low, _) = _worst(shares)
    carried = all(verdict.verdict == HOLDS for verdict in discrete)
    return Verdict(
        label,
        STATEMENTS[label],
        case,
        "error at t = 0 / largest error",
        f"< {LATER:g}, or carried by ‖Π^h u − u^h‖_V",
        worst,
        low,
        worst,
        HOLDS if worst < LATER or (carried and worst <= 1) else FAILS,
    )


def _last_fit(column: str) -> Measure:
    """Least-squares order over the judged levels, without an interval."""

    def measure(group: pd.DataFrame) -> tuple[float, tuple[float, float]]:
        judged = group.tail(JUDGED)
        order = fit(judged["h"].to_numpy(), judged[column].to_numpy()).order
        return order, (order, order)

    return measure


def _evidence(label: str, case: str, groups: dict[str, pd.DataFrame]) -> list[Verdict]:
    """The error must be that of u^h; time discretisation, solver and quadrature must not matter."""
    law = "parallelogram law of u − u^h and u − Π^h u"
    return [
        _verdict(label, case, law, PARALLELOGRAM, groups, largest("parallelogram")),
        _verdict(label, case, "time share", TIME_SHARE, groups, largest("time_share")),
        _verdict(label, case, "residual of the contact solves / allowed", RESIDUAL, groups, _residual),
        _verdict(label, case, "u^h = 0 on Γ1", CLAMPED, groups, largest("clamped")),
        _verdict(label, case, "change under finer quadrature", QUADRATURE, groups, largest("quadrature_change")),
    ]


def prop_5_3(case: str, rows: pd.DataFrame, expected: float) -> list[Verdict]:
    """Errors fall level by level and leave no room for a positive limit; the order is seen, not claimed.

    The place of a fixed front within its cell alternates between levels, so orders are taken over two
    refinements. Meshes graded towards a corner regain the order 1.
    """
    label, groups = "Prop. 5.3", families(rows)
    uniform = {name: group for name, group in groups.items() if name != GRADED}
    graded = {name: group for name, group in groups.items() if name == GRADED}
    falling = Window(0.0, 0.999, "< 1 on every level")

    def ratio(group: pd.DataFrame) -> tuple[float, tuple[float, float]]:
        e = group["error"].to_numpy()
        ratios = e[1:] / e[:-1]
        return float(ratios.max()), (float(ratios.min()), float(ratios.max()))

    def remainder(group: pd.DataFrame) -> tuple[float, tuple[float, float]]:
        value = limit(group["h"].to_numpy(), group["error"].to_numpy(), expected)
        return value, (value, value)

    enough = min(len(group) for group in groups.values()) >= JUDGED + 1
    decide = _verdict if enough else lambda *a: _undecided(*a[:4])
    seen = [
        decide(label, case, quantity, _about(order), chosen, last_order("error", 2))
        for quantity, order, chosen in (("order seen", expected, uniform), ("order seen on graded meshes", 1.0, graded))
        if chosen
    ]
    return [
        decide(label, case, "ratio of consecutive errors", falling, groups, ratio),
        decide(label, case, "limit e∞ of e = e∞ + C h^s", LIMIT, uniform, remainder),
        *seen,
        _verdict(label, case, "size of the error", SIZE, groups, finest(_size)),
        *_evidence(label, case, groups),
    ]


def _about(order: float) -> Window:
    return Window(
        order - ROUGH_ORDER,
        order + ROUGH_ORDER,
        f"{order:.3g} ± {ROUGH_ORDER} over two refinements (no rate is claimed)",
    )


def beyond_5_36(case: str, rows: pd.DataFrame, proved: float) -> Verdict:
    """The order seen beside the one that the proof of Prop. 5.4 gives for a solution that misses (5.36)."""
    groups = {name: group for name, group in families(rows).items() if name != GRADED and len(group) >= JUDGED}
    found = [last_order("error", 2)(group)[0] for group in groups.values()]
    low, high = (min(found), max(found)) if found else (math.nan, math.nan)
    return Verdict(
        "(5.36)",
        STATEMENTS["(5.36)"],
        case,
        "order seen, on uniform meshes",
        f"the proof gives {proved:.3g}",
        low,
        low,
        high,
        REPORTED,
    )


def turned(case: str, rows: pd.DataFrame, twin: pd.DataFrame) -> list[Verdict]:
    """The largest relative differences of errors between a body and the same in another position, on equal meshes.

    ‖Π^h u − u^h‖_V is the small difference of two functions that rounding changes by the condition number of
    the matrices, of order h^{−2}.
    """
    key = ["family", "scheme", "level"]
    pairs = rows[~rows["family"].isin([UNSTRUCTURED, GRADED])].merge(twin, on=key, suffixes=("", "_twin"))
    found = []
    for window, names in ((AXES, ("error", "interpolation_error")), (AXES_DISCRETE, ("discrete_error",))):
        values = np.array([pairs[name] / pairs[f"{name}_twin"] - 1 for name in names])
        worst = float(np.max(abs(values))) if len(pairs) else math.nan
        verdict = UNDECIDED if not len(pairs) else HOLDS if worst <= window.high else FAILS
        quantity = f"relative difference of {', '.join(NORMS[name] for name in names)}"
        found.append(Verdict("axes", STATEMENTS["axes"], case, quantity, window.text, worst, 0.0, worst, verdict))
    return found


def theorem_4_2(case: str, rows: pd.DataFrame) -> list[Verdict]:
    """Agreement of the two formulations at every step, within what the duality gaps of the solver allow."""
    displacement, stress = rows["displacement_bound"], rows["stress_bound"]
    measured = [
        ("displacement of Problem 3.2 − 3.1 / what the gap allows", ALLOWED, rows["displacement_gap"] / displacement),
        ("stress of Problem 3.2 − 3.1 / what the gap allows", ALLOWED, rows["stress_gap"] / stress),
        ("what the gap allows / size of the solution", SHARP, np.maximum(displacement, stress)),
        ("σ^h ∈ Σ^h(t)", AGREEMENT, rows["admissibility"]),
        ("(σ, ε(u))_Q = (f, u)_V, (4.14)", AGREEMENT, rows["energy_gap"]),
        ("u ∈ K^h though never imposed", AGREEMENT, rows["membership"]),
    ]
    found = []
    for quantity, window, values in measured:
        worst, (low, _) = _worst(values.to_numpy())
        verdict = HOLDS if window.low <= worst <= window.high else FAILS
        statement = STATEMENTS["Thm 4.2"]
        found.append(Verdict("Thm 4.2", statement, case, quantity, window.text, worst, low, worst, verdict))
    return found


def supremum(rates: pd.DataFrame) -> Verdict:
    """Whether enough cases have their largest error after t = 0, where something was solved."""
    rows = rates[rates["claim"] == "Prop. 5.4"]
    later = (rows["initial_error"] < LATER * rows["error"]).groupby(rows["case"]).all()
    count = float(later.sum())
    return Verdict(
        "Prop. 5.4",
        STATEMENTS["Prop. 5.4"],
        "all cases",
        f"cases with the supremum after t = 0 (of {len(later)})",
        "≥ 4",
        count,
        count,
        count,
        HOLDS if count >= 4 else UNDECIDED,
    )


def complete(planned: set[tuple[str, ...]], found: set[tuple[str, ...]]) -> Verdict:
    """Whether the data are those of the plan: a missing family or level would make a verdict easier."""
    missing = sorted(planned - found)
    quantity = "rows of the plan that are missing" + (f", first {' '.join(missing[0])}" if missing else "")
    count = float(len(missing))
    return Verdict(
        "data",
        STATEMENTS["data"],
        "all cases",
        quantity,
        f"0 of {len(planned)}",
        count,
        count,
        count,
        UNDECIDED if missing else HOLDS,
    )


def judge(rates: pd.DataFrame, equivalence: pd.DataFrame, cases: pd.DataFrame) -> list[Verdict]:
    """Every verdict on orders and on the two formulations that the data allow; ``cases`` says what was predicted."""
    found: list[Verdict] = []
    predicted = cases.set_index("case")
    by_case = {str(case): rows for case, rows in rates.groupby("case", sort=False)}
    for case, rows in by_case.items():
        prediction = predicted.loc[case]
        if rows["claim"].iloc[0] == "Prop. 5.4":
            found += prop_5_4(case, rows, prediction["expected_order"])
        else:
            found += prop_5_3(case, rows, prediction["expected_order"])
            found.append(beyond_5_36(case, rows, prediction["proved_order"]))
        if prediction["twin"] in by_case:
            found += turned(case, rows, by_case[prediction["twin"]])
    if rates.loc[rates["claim"] == "Prop. 5.4", "case"].nunique() >= 4:
        found.append(supremum(rates))
    for case, rows in equivalence.groupby("case", sort=False):
        found += theorem_4_2(str(case), rows)
    return found
