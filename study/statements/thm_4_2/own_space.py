"""Theorem 4.2 on a stress space of its own: with which orders the two formulations should meet, and whether they do.

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
from collections.abc import Iterator
from dataclasses import dataclass, replace

import pandas as pd

from manufactured.regularity import Regularity
from study.fem.mesh import Graded
from study.fem.naming import resolve
from study.ledger.criterion import Criterion, Observation, Rule
from study.ledger.measures import among, growth, largest, order, weighted
from study.ledger.verdict import Verdict
from study.ledger.window import Window, above_nothing, at_least, at_most, between
from study.statements.shared.random_meshes import ALONG, CELLS, is_random
from study.statements.thm_4_2.stress_sweep import Stresses

MARGIN, SMOOTH = 0.15, 0.3
"""Below a predicted order that is a singularity's; below 2, to which the boundary adds its own on coarse meshes."""
JUDGED, PAIR = 3, 2
"""Orders are taken over the last levels, up to so many; fewer levels than a pair have none."""
IN_CELLS = ("stress", "strain", "primal_stress")
"""Their errors are sums over all cells. Those of the pressure are sums over the edges on Γ3, those of multipliers are
largest along a front that moves: over as many cells as there are along a line."""
CHANCE = 0.3
"""Room beside it for an order on random meshes that comes from cells along a line: three standard deviations, of which
one was 0.03 … 0.19 in a pilot on shaken meshes, n = 8, 16, 32, that judged nothing. Orders of sums over
all cells scattered by 0.03 and need none. The windows without it are those of meshes with one diagonal."""
BOUNDED, BOUNDED_BY_CHANCE = at_most(1.25, "bounded"), at_most(1.35, "bounded; two deviations more for chance")
TIME = above_nothing(0.5, "by the order 3/2 in k what steps contribute is then ≤ 0.27 of the error")
RATIO = "‖σ − σ^h‖_Q / that of the best polynomials"
ADMISSIBLE = "σ^hν continuous, P f_2 on Γ2, σ_τ = 0 and σ_ν ≤ 0 on Γ3, strongly"
QUANTITIES = {
    "stress": "‖σ − σ^h‖_Q",
    "strain": "‖ε(u) − ε^h‖_Q for the strains that belong to σ^h",
    "pressure": "‖σ_ν − σ^h_ν‖_{L²(Γ3)}",
    "displacement": "multipliers − u on the edges",
    "primal_stress": "‖σ^h − (Aε(δu^h) + Gε(u^h))‖_Q",
    "primal_displacement": "multipliers − u^h on the edges",
}


class OwnSpace(Stresses):
    """One row for each quantity, case and mesh family."""

    label = "Thm 4.2, own space"
    claim = "Problem 3.2 on a conforming stress space of its own and Problem 3.1 meet"

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        found: list[Verdict] = []
        for (case, family), series in rows.groupby(["case", "family"], sort=False):
            levels = series.sort_values("h", ascending=False).assign(ratio=series["stress"] / series["best"])
            rules = rules_of(resolve(str(case)).regularity, str(family))
            found += [rule.verdict(self, str(case), {str(family): levels}, str(family)) for rule in rules]
        return found


def rules_of(regularity: Regularity, family: str) -> Iterator[Rule]:
    """What is judged of a solution on a mesh family."""
    for name, orders in predicted(regularity, family).items():
        parts = CELLS if name in IN_CELLS else ALONG
        window = orders.window(CHANCE if parts == ALONG and is_random(family) else 0.0)
        yield weighted(f"order-{name}", f"order of {QUANTITIES[name]}", window, name, parts, JUDGED, PAIR)
    # The finest one is shown.
    ratios = Criterion("ratio", RATIO, at_least(1), lambda of: among(of["ratio"].iloc[-1], of["ratio"]), ("ratio",))
    yield Observation(ratios, "the best polynomials are those of a larger space")
    quantity = f"growth of {RATIO}, coarsest to finest, fitted"
    bounded = BOUNDED_BY_CHANCE if is_random(family) else BOUNDED
    yield growth("growth", quantity, bounded, "ratio", CELLS, PAIR)
    yield largest("admissible", ADMISSIBLE, above_nothing(1e-9), "admissibility")
    yield largest("time-share", "share of steps and quadrature in ‖σ − σ^h‖_Q", TIME, "time_share")
    in_the_maximum = order("order-sup", "order of max_n ‖σ − σ^h‖_Q", Window(), "stress_sup", JUDGED, PAIR)
    yield Observation(in_the_maximum, "the maximum is where a front lies worst in its cell, by chance on every level")


@dataclass(frozen=True)
class Orders:
    """The lowest and the highest order that regularity and scheme let one expect."""

    low: float
    high: float

    def window(self, chance: float = 0.0) -> Window:
        """These orders with some room, and more of it for chance."""
        return between(self.low, self.high, (SMOOTH if self.low == 2 else MARGIN) + chance, 0.2 + chance)


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
    return {name: orders for name, orders in found.items() if orders.window().low > 0}


def _smoothness(regularity: Regularity, family: str) -> tuple[float, float]:
    """(s, s') for u(t) ∈ H^{1+s}, u̇(t) ∈ H^{1+s'}, as meshes of a family see them: graded ones s = eλ at r^λ."""
    if family != Graded().name:
        return regularity.smoothness, regularity.rate_smoothness
    away = replace(regularity, corner=math.inf, on_contact=math.inf)
    s = min(away.smoothness, Graded().exponent * min(regularity.corner, regularity.on_contact))
    return s, min(s, away.rate_smoothness)
