"""Verdicts on Problem 3.2 on its own stress space, from ``stresses.csv`` alone.

Predicted for u(t) ∈ H^{1+s}, u̇(t) ∈ H^{1+s'}, s' ≤ s (``manufactured.regularity``), in L²(0,T) and with k ~ h:

* ‖σ − σ^h‖_Q. σ^h and the interpolant of σ balance the same projected loads, so that their distance is that of
  interpolation but for what contact adds, which is no larger. σ carries ε(u̇): order r = min(2, s'). A front that moves
  gives σ kinks across a line: order 3/2 from the few cells on it, with a small constant, beside order 2 from all
  others, and any order between is seen. Corners r^λ have order λ on uniform meshes, min(2, eλ) on meshes graded with
  the exponent e.
* The same for the best polynomials on the thirds, so that the ratio of both must not grow. It is at least 1, as they
  are the best of a larger space; that holds by construction, and the ratio is reported.
* −σ^h_ν against p in L²(Γ3): by the inverse inequality on cells as thin as h half an order of the error on them may be
  lost. On them σ is as smooth as without corners off Γ3, of order r_Γ, which is r for λ = ∞ there. A corner off Γ3
  sends there no more than the global error r, a smooth one that loses nothing to thin cells. The interpolant has the
  best polynomials on edges: between min(r, r_Γ − 1/2) and 2. No claim where r_Γ − 1/2 is not a convergence.
* ε_n against ε(u): ε_n solves the law at every point, driven by σ^h: order r, but no more than BDF2 has in k, which is
  2, falling to 3/2 where u̇ jumps because edges change between contact and release.
* The multipliers against u: the product of two stress errors, min(2, 2s), or the order of BDF2 if that is less;
  at most 3.
* ‖σ^h − (Aε(δu^h) + Gε(u^h))‖_Q, stresses that are constant on cells: min(1, s'), 1 on graded meshes.
* The multipliers against u^h, which is as near to u in L² (Aubin, Nitsche): as against u, and at most 2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import pandas as pd

from manufactured.regularity import Regularity
from study.fem.mesh import Graded
from study.ledger.orders import fit
from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED, Verdict, Window

LABEL, CLAIM = "Thm 4.2, own space", "Problem 3.2 on a conforming stress space of its own and Problem 3.1 meet"
JUDGED = 3
"""Orders are taken over the last levels, up to so many."""
MARGIN, SMOOTH = 0.15, 0.3
"""Below a predicted order that is a singularity's; below 2, to which the boundary adds its own on coarse meshes."""
GROWTH = Window(0.0, 1.25, "≤ 1.25: bounded")
STRONGLY = Window(0.0, 1e-9, "≤ 1e-9")
TIME = Window(0.0, 1.0, "≤ 1: by the order 3/2 in k the error in time is then ≤ 0.55 of the error")
RATIO = "‖σ − σ^h‖_Q / that of the best polynomials"
UNCLAIMED = "no claim: the maximum is where a front lies worst in its cell, by chance on every level"
ADMISSIBLE = "σ^hν continuous, P f_2 on Γ2, σ_τ = 0 and σ_ν ≤ 0 on Γ3, strongly"
QUANTITIES = {
    "stress": "‖σ − σ^h‖_Q",
    "strain": "‖ε(u) − ε^h‖_Q for the strains that belong to σ^h",
    "pressure": "‖σ_ν − σ^h_ν‖_{L²(Γ3)}",
    "displacement": "multipliers − u on the edges",
    "primal_stress": "‖σ^h − (Aε(δu^h) + Gε(u^h))‖_Q",
    "primal_displacement": "multipliers − u^h on the edges",
}


@dataclass(frozen=True)
class Orders:
    """The lowest and the highest order that regularity and scheme let one expect."""

    low: float
    high: float

    @property
    def window(self) -> Window:
        below = SMOOTH if self.low == 2 else MARGIN
        text = f"{self.low:.3g}" if self.low == self.high else f"{self.low:.3g} … {self.high:.3g}"
        return Window(self.low - below, self.high + 0.2, f"{text}, − {below:g} + 0.2")


def predicted(regularity: Regularity, family: str) -> dict[str, Orders]:
    """The orders on a mesh family of every quantity that is claimed to converge."""
    s, rate = _smoothness(regularity, family)
    constant, r = min(1.0, rate), min(2.0, rate)
    _, at_contact = _smoothness(replace(regularity, corner=math.inf), family)
    pressure = Orders(min(r, at_contact - 0.5), 2.0)
    in_time = 1.5 if regularity.moving else 2.0
    moments = min(2 * s, in_time)
    found = {
        "stress": Orders(r, max(r, 2.0) if r >= 1 else r),
        "strain": Orders(min(r, in_time), 2.0 if r >= 1 else r),
        "pressure": pressure,
        "displacement": Orders(moments, 3.0),
        "primal_stress": Orders(constant, constant),
        "primal_displacement": Orders(moments, max(moments, 2.0)),
    }
    return {name: orders for name, orders in found.items() if orders.window.low > 0}


def _smoothness(regularity: Regularity, family: str) -> tuple[float, float]:
    """(s, s') for u(t) ∈ H^{1+s}, u̇(t) ∈ H^{1+s'}, as meshes of a family see them: graded ones s = eλ at r^λ."""
    if family != Graded().name:
        return regularity.smoothness, regularity.rate_smoothness
    away = replace(regularity, corner=math.inf, on_contact=math.inf)
    s = min(away.smoothness, Graded().exponent * min(regularity.corner, regularity.on_contact))
    return s, min(s, away.rate_smoothness)


def judge_stresses(rows: pd.DataFrame, cases: dict[str, Regularity]) -> list[Verdict]:
    """Every verdict that the rows allow, one row of the ledger for each quantity, case and mesh family."""
    found: list[Verdict] = []
    for (case, family), series in rows.groupby(["case", "family"], sort=False):
        ordered = series.sort_values("h", ascending=False)
        found += _series(str(case), str(family), ordered, predicted(cases[str(case)], str(family)))
    return found


def _series(case: str, family: str, rows: pd.DataFrame, orders: dict[str, Orders]) -> list[Verdict]:
    on = f", {family} meshes"
    found = [_order(case, f"order of {QUANTITIES[name]}{on}", rows, name, o.window) for name, o in orders.items()]
    ratio = rows["stress"] / rows["best"]
    growth = float(ratio.iloc[-1] / ratio.iloc[0])
    return [
        *found,
        Verdict(
            LABEL, CLAIM, case, f"{RATIO}{on}", "≥ 1 by construction", float(ratio.iloc[-1]), *_range(ratio), REPORTED
        ),
        _row(case, f"growth of {RATIO}, finest over coarsest{on}", GROWTH, growth, (growth, growth)),
        _row(case, f"{ADMISSIBLE}{on}", STRONGLY, float(rows["admissibility"].max()), _range(rows["admissibility"])),
        _row(case, f"time share of ‖σ − σ^h‖_Q{on}", TIME, float(rows["time_share"].max()), _range(rows["time_share"])),
        _reported(case, f"order of max_n ‖σ − σ^h‖_Q{on}", rows),
    ]


def _order(case: str, quantity: str, rows: pd.DataFrame, name: str, window: Window) -> Verdict:
    """The least-squares order of a column over the last levels; undecided on a single one."""
    judged = rows.tail(JUDGED)
    if len(judged) < 2:
        return Verdict(LABEL, CLAIM, case, quantity, window.text, math.nan, -math.inf, math.inf, UNDECIDED)
    order = fit(judged["h"].to_numpy(), judged[name].to_numpy()).order
    return _row(case, quantity, window, order, (order, order))


def _row(case: str, quantity: str, window: Window, observed: float, span: tuple[float, float]) -> Verdict:
    inside = window.low <= span[0] and span[1] <= window.high
    return Verdict(LABEL, CLAIM, case, quantity, window.text, observed, *span, HOLDS if inside else FAILS)


def _range(values: pd.Series) -> tuple[float, float]:
    return float(values.min()), float(values.max())


def _reported(case: str, quantity: str, rows: pd.DataFrame) -> Verdict:
    """The maximum over time is where a front lies worst within its cell, which changes from level to level."""
    if len(rows) < 2:
        return Verdict(LABEL, CLAIM, case, quantity, UNCLAIMED, math.nan, math.nan, math.nan, REPORTED)
    judged = rows.tail(JUDGED)
    order = fit(judged["h"].to_numpy(), judged["stress_sup"].to_numpy()).order
    return Verdict(LABEL, CLAIM, case, quantity, UNCLAIMED, order, order, order, REPORTED)
