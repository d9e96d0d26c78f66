"""With which orders the contact force should converge, and whether it does.

For a load that is exact, ⟨p − p^h, v_ν⟩ = (σ^h − σ, ε(v))_Q for every v ∈ V^h. Predicted in L²(0,T), with k ~ h:

* **dual norm**: sup over v ∈ V^h of the right side, which sees of σ^h − σ = Aε(u̇^h − u̇) + Gε(u^h − u) only what is not
  orthogonal to V^h: the order of ‖Π^h u − u^h‖_V, from the same cancellation. 3/2 to 2 on one-diagonal meshes, from
  1 to 2 on others. Nothing faster is possible, as p^h is piecewise linear and a front cuts cells.
* **L²(Γ3)**: take v with the trace of a function on Γ3, and zero at all other vertices. It lives in the cells along Γ3,
  which hold O(h^{3/2}) of ‖σ − σ^h‖_Q for solutions with ε(u) ∈ W^{1,∞}, and ‖v‖_V ≤ c h^{−1/2} ‖v_ν‖: order 1, as
  far as nothing cancels, and half an order less than the dual norm, by the inverse inequality, where it does: 1 to 3/2.
* **resultant**: v with v_ν = 1 on a piece is one of the v of the dual norm, and a smooth one: (σ^h − σ, ε(v − Π^h v))
  is of order 2 by the argument of Aubin and Nitsche, where the zone is known. A moving front is known up to a cell,
  which costs what is pressed there; no less than the order of the dual norm, and at coarse levels more than 2 is seen
  where a patch is a few cells wide: one-sided.

On random meshes ‖p − p^h‖_{L²(Γ3)} is the error of the few edges that happen to be long where p bends. In a pilot on
ten of them its logarithm scattered by 0.2 on every level, n = 8, 16, 32, and its order by 0.18 about 1.16: reported
there. The dual norm, a sum over cells, scattered by half of that about 1.51, and is judged.

u^h_ν is linear between vertices, u^h ∈ K^h: u^h_ν ≤ 0 at every point of straight faces, up to rounding, and λ ≥ 0.

Where the whole face lands with a velocity p jumps in time; one step of every scheme has the mean of both sides, and the
error in L²(0,T) is of order 1/2 in k, times a factor that depends on where in its step the jump is. It is reported.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import pandas as pd

from study.ledger.criterion import Groups, Observation, Rule, by_family
from study.ledger.measures import finest, largest, order
from study.ledger.verdict import Verdict
from study.ledger.window import Window, around, at_least, at_most, between
from study.statements.contact_force.measure import SHARES
from study.statements.contact_force.sweep import PressureSweep
from study.statements.shared.random_meshes import apart

SUPERCLOSE = between(1.5, 2, 0.2, 0.2, "as the discrete error, on one-diagonal meshes")
OTHERS = between(1, 2, 0.15, 0.2, "as the discrete error, on other meshes")
STRIP = between(1, 1.5, 0.15, 0.7, "the cells along Γ3; piecewise linears have 2 at most")
RESULTANT = at_least(1, "order of the dual norm; 2 where the zone is known")
SIZE = at_most(0.05, "of the exact one, on the finest level")
TIME = at_most(0.5, "of each error, by half as many steps")
"""Not for the resultant: time steps can only spoil an order that has to be large, and on symmetric meshes the part of
its error that is due to space may vanish."""
ROUND_OFF = at_most(1e-10, "straight faces and P1: only rounding")
ONE_DIAGONAL = "one-diagonal"
LANDS = "lift-and-land"
"""The case whose pressure jumps in time."""
NO_ORDER = "p jumps in time, and the error is that of the step with the jump"
JUMP = around(0.5, 0.2, "k^{1/2}")
PRESSURE = order("order-pressure", "order of ‖p − p^h‖_{L²(Γ3)}", STRIP, "pressure")
OF_CHANCE = replace(PRESSURE, key="order-pressure-random", quantity=f"{PRESSURE.quantity}, random meshes")
FEW_EDGES = "on random meshes it hangs on the few edges that happen to be long where p bends"
NORMS = (
    order("order-resultant", "order of the resultant on each face", RESULTANT, "resultant"),
    finest("resultant", "error of the resultant on each face", SIZE, "resultant"),
    largest("time-share", "time shares of both norms", TIME, *SHARES[:2]),
)
EXACT = (
    largest("penetration", "max (u^h_ν)_+ between vertices / max |u^h|", ROUND_OFF, "penetration"),
    largest("pulling", "max λ_− / max |λ|", ROUND_OFF, "pulling"),
)
"""Rows of every case."""


class ContactForce(PressureSweep):
    """Rows for each case over its mesh families, from ``contact.csv``."""

    label = "contact force"
    claim = "−σ^h_ν → p on Γ3, and u^h_ν ≤ 0 between vertices, for the solutions of Proposition 5.4"

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        cases = [(str(case), by_family(mine)) for case, mine in rows.groupby("case", sort=False)]
        return [rule.verdict(self, case, chosen) for case, groups in cases for rule, chosen in rules_of(case, groups)]


def rules_of(case: str, groups: Groups) -> Iterator[tuple[Rule, Groups]]:
    """What is judged of a case, and on which mesh families."""
    norms = [(rule, groups) for rule in NORMS]
    chance, others = apart(groups)
    if others:
        norms.append((PRESSURE, others))
    if chance:
        yield Observation(OF_CHANCE, FEW_EDGES), chance
    for chosen, window, name in ((True, SUPERCLOSE, "superclose"), (False, OTHERS, "other families")):
        if mine := {family: levels for family, levels in groups.items() if (family == ONE_DIAGONAL) is chosen}:
            quantity = f"order of sup ⟨p − p^h, v_ν⟩ / ‖v‖_V over V^h, {name}"
            norms.append((order(f"order-dual-{name.split()[0]}", quantity, window, "dual"), mine))
    for rule, mine in norms:
        jump = JUMP if rule.key.startswith("order") else Window()
        yield Observation(replace(rule, window=jump), NO_ORDER) if case == LANDS else rule, mine
    for rule in EXACT:
        yield rule, groups
