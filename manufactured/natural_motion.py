"""The natural front of frictionless contact, advancing on a viscoelastic body.

The gap w, the contact pressure p and the contact zone {ψ ≥ 0} with the front c are

    w = θ (κ + 1) (x − c)_+^{3/2},   p = 3 (2μ_A ∂_t + 2μ_G)(θ (c − x)_+^{1/2}),   ψ = c − x,   c(t) = 1/4 + 2t/5,

with θ(t) = 1/4 + t, on the bottom of the unit square. The elasticity is G = 2A. The displacement is the singular field
of ``cases.natural_front``, which moves with the front. Its derivative ∂_x also satisfies Div σ = 0 and the contact
conditions on both sides of the front. So u̇ ~ r^{1/2} and

    p = 3μ_A θ ċ (c − x)_+^{−1/2} + 6 (μ_A θ̇ + μ_G θ) (c − x)_+^{1/2}.

p is not bounded, and for ċ < 0 it would be negative. The body force f_0 is due to the cut-off only. Near the front
f_0 ~ r^{1/2} and ḟ_0 ~ r^{−1/2}, and the tractions f_2 are smooth, so (3.4) holds as it is printed.

Predicted order 1: u(t) ∈ H^{1+s} for s < 3/2, so that the interpolation error of u has order 1. But u̇(t) ∈ H^{1+s} for
s < 1/2 only, and p ∉ L²(Γ3). This violates both parts of (5.36), and the proof of Prop. 5.4 gives the order 1/2
only. The order 1, up to a logarithm, is proved in paper/fronts.tex. Before, it was predicted for the following reason.
The error ‖u̇ − Π^h u̇‖_V ~ h^{1/2} comes from the cells at the front. The front passes a cell in a time ~ h, so the
error that remains in the cell is ~ h^{3/2}. The errors of h^{−1} cells are independent, and their norm is ~ h, which is
the order of the interpolation error.
"""

from sympy import Expr, Rational

from manufactured.arguments import checked
from manufactured.case import Case
from manufactured.cases.natural_front import with_natural_front
from manufactured.regularity import Regularity
from manufactured.symbols import FormulaError, t

NAME = "natural-motion"
PLACE = Rational(1, 4) + Rational(2, 5) * t
"""The position c(t) of the contact front."""


@checked(FormulaError)
def natural_motion(place: Expr = PLACE) -> Case:
    """Return the case with the front c(t) = ``place``.

    The front must advance; otherwise the pressure is negative, and the self-proof fails.
    """
    return Case(
        name=NAME,
        summary="the natural front advances: w ~ r^{3/2}, p ~ r^{−1/2}",
        solution=with_natural_front(Rational(1, 4) + t, place, moving=True),
        regularity=Regularity(on_contact=1.5, moving=True),
        order=1,
        reason="u(t) ∈ H^{5/2−ε} ⊂ H², so interpolation has order 1; u̇(t) ∈ H^{3/2−ε}, and C h |log h| is proved",
        pace=4,
    )
