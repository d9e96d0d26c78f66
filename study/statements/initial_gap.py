"""Beyond the paper: an initial gap g(s) ≥ 0 between the undeformed body and the foundation.

**The claim.** In the paper the undeformed body touches the foundation: K = {v : v_ν ≤ 0 on Γ3}. Here
K = {v : v_ν ≤ g on Γ3} with a smooth g that does not depend on time, and Problem 5.1 is solved in
K^h = {v ∈ V^h : v_ν ≤ g at the vertices of Γ3}. The paper claims nothing about this problem. This study claims
‖u − u^h‖_{L∞(0,T;V)} = O(h) for solutions with the regularity (5.36), and convergence for others.

**The reason.** Let d ∈ V be smooth with d_ν = g on Γ3. Then w = u − d satisfies w_ν ≤ 0 on Γ3, the condition of the
paper, and w^h = u^h − Π^h d satisfies it at the vertices. The function w solves the variational inequality of u with an
additional load, which belongs to −d. Moreover Π^h d − d = O(h) by (5.23). So the proof of Proposition 5.4 holds for w.
The window of the order was set before anything was measured.

**The measurement** is the same as for Proposition 5.4 (``prop_5_4.measure``), on all cases with an initial gap and all
mesh families that can mesh their bodies. The contact solver gets the values of g at the vertices.

**The judgement** uses the criteria of Proposition 5.4 and (5.23) if the solution satisfies (5.36), otherwise the
criteria of Proposition 5.3. If g is forgotten or has the wrong sign, the error does not fall with h
(``study.controls``).
"""

from manufactured.case import INITIAL_GAP
from study.ledger.check import Groups
from study.statements.from_rates import SizeOfInterpolation
from study.statements.prop_5_3 import Convergence
from study.statements.prop_5_4 import FirstOrder, Rates
from study.statements.shared.base import Judged
from study.statements.shared.meshes import value_of_case


class InitialGap(Rates):
    """Measures and judges the errors ‖u − u^h‖_V for the cases with an initial gap."""

    label = proposition = INITIAL_GAP
    claim = "‖u − u^h‖_{L∞(0,T;V)} = O(h) for K = {v : v_ν ≤ g on Γ3}; the paper has g = 0"
    initial_gap = True

    def checks_of(self, case: str, groups: Groups) -> Judged:
        smooth = value_of_case(groups, "expected_order") >= 1
        for statement in (FirstOrder(), SizeOfInterpolation()) if smooth else (Convergence(),):
            yield from statement.checks_of(case, groups)
