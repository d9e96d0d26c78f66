"""Beyond the paper: an initial gap g(s) ≥ 0 between the undeformed body and the foundation.

**Claimed.** In the paper the undeformed body touches the foundation: K = {v : v_ν ≤ 0 on Γ3}. Here
K = {v : v_ν ≤ g on Γ3} with a smooth g that does not depend on time, and Problem 5.1 is solved in
K^h = {v ∈ V^h : v_ν ≤ g at the vertices of Γ3}. The paper claims nothing about it. This study claims
‖u − u^h‖_{L∞(0,T;V)} = O(h) for solutions with (5.36), and convergence for others.

Why: w = u − d with a smooth d ∈ V, d_ν = g on Γ3, is in the cone of the paper, as is w^h = u^h − Π^h d. The
inequality for w is the one for u with the load of −d added, and Π^h d − d = O(h) by (5.23). So the proof of
Proposition 5.4 holds for w. The window of the order was set before anything was measured.

**Measured** as for Proposition 5.4 (``prop_5_4.measure``), on all cases with an initial gap and all mesh families that
can mesh their bodies. The exact solution is the lifting of w − g, and the contact solver gets g at the vertices.

**Judged** by the criteria of Proposition 5.4 and (5.23) if the solution satisfies (5.36), otherwise by the criteria of
Proposition 5.3. If g is forgotten or has the wrong sign, the error does not fall with h (``study.controls``).
"""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from manufactured.case import INITIAL_GAP
from study.ledger.criterion import Groups, Rule, by_family
from study.ledger.verdict import Verdict
from study.statements import prop_5_3, prop_5_4
from study.statements.from_rates import SizeOfInterpolation
from study.statements.prop_5_4 import Rates


class InitialGap(Rates):
    """Measures and judges errors for the cases with an initial gap."""

    label = INITIAL_GAP
    claim = "‖u − u^h‖_{L∞(0,T;V)} = O(h) for K = {v : v_ν ≤ g on Γ3}; the source has g = 0"
    initial_gap = True

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        mine = rows[rows["claim"] == self.label]
        return [
            rule.verdict(self, str(case), groups)
            for case, of_case in mine.groupby("case", sort=False)
            for rule, groups in rules_of(of_case)
        ]


def rules_of(rows: pd.DataFrame) -> Iterator[tuple[Rule, Groups]]:
    """Yield the criteria for the rows of one case, each with the rows of the mesh families on which it is judged."""
    groups, expected = by_family(rows), float(rows["expected_order"].iloc[0])
    if expected < 1:
        yield from prop_5_3.rules_of(groups, expected)
        return
    yield from prop_5_4.rules_of(rows, expected)
    for rule in SizeOfInterpolation.rules:
        yield rule, groups
