"""The order of convergence that is proved for a case."""

from manufactured.case import Case


def proved_order(case: Case) -> float:
    """Return the largest order of ‖u − u^h‖_{L∞(0,T;V)} on uniform meshes that is proved for a case (a supremum).

    Several proofs give an order, and the largest one is returned. The proof of Prop. 5.4 gives
    ``Regularity.proved_order``, which also depends on the trace u_ν ∈ H^τ(Γ3). In 2D there are two theorems without an
    assumption on the trace of u:

    * u ∈ W^{1,1}(0,T;H^{1+r}) with 1/2 < r ≤ 1 gives the order r (paper/trace.tex).
    * u ∈ L²(0,T;H^{1+s}), u̇ ∈ L¹(0,T;H^{1+r}) with 0 < r ≤ s ≤ 1 and σ_ν ∈ L²(0,T;L^p(Γ3)) with p ≤ 2 give the order
      min(max(3s/5, r), (s + 1 − 1/p)/2), for loads of bounded variation in time (paper/velocity.tex).

    The theorem on natural fronts (paper/fronts.tex) is left out, because it depends on the speed of fronts and on the
    corners of the body.
    """
    regularity = case.regularity
    r, s = min(1.0, regularity.rate_smoothness), min(1.0, regularity.smoothness)
    source = regularity.proved_order
    if case.solution.body.dim != 2 or r <= 0:
        return source
    # Near a singular point on Γ3, σ_ν ~ r^{λ−1}, or r^{λ−2} if the point moves.
    inverse_p = max(0.5, 1 + regularity.moving - regularity.on_contact)
    half_derivative = min(max(0.6 * s, r), (s + 1 - inverse_p) / 2)
    return max(source, half_derivative, r if r > 0.5 else 0.0)
