"""The order of convergence that is proved for a case."""

from manufactured.case import Case


def proved_order(case: Case) -> float:
    """Return the largest order of ‖u − u^h‖_{L∞(0,T;V)} on uniform meshes that is proved for a case (a supremum).

    Two proofs give an order, and the larger one is returned. In 2D, u ∈ W^{1,1}(0,T;H^{1+s}) with 1/2 < s ≤ 1 gives the
    order s without an assumption on the trace of u (paper/trace.tex). The proof of Prop. 5.4 gives
    ``Regularity.proved_order``, which also depends on the trace u_ν ∈ H^τ(Γ3).
    """
    s, source = min(1.0, case.regularity.rate_smoothness), case.regularity.proved_order
    return max(s, source) if case.solution.body.dim == 2 and s > 0.5 else source
