"""The order that is proved for a case: by Proposition 5.4's own proof, or without regularity of the trace."""

from __future__ import annotations

from manufactured.case import Case


def proved_order(case: Case) -> float:
    """Return the supremum of the orders of ‖u − u^h‖_{L∞(0,T;V)} that are proved on uniform meshes.

    In the plane u ∈ W^{1,1}(0,T;H^{1+s}) with 1/2 < s ≤ 1 gives the order s without an assumption on the trace (a
    theorem of the article). Elsewhere the proof of Prop. 5.4 gives the order (``regularity``); it also needs u_ν ∈ H^τ.
    """
    s, source = min(1.0, case.regularity.rate_smoothness), case.regularity.proved_order
    return max(s, source) if case.solution.body.dim == 2 and s > 0.5 else source
