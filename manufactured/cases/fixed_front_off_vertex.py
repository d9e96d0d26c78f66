"""A fixed contact zone as in ``fixed_front_on_vertex``, with its front inside a facet.

The gap w, the contact pressure p, the contact zone {ψ ≥ 0} with the front c, and the normal strain q at t = 0 are

    w = 10 t (x − c)_+³,   p = 400 t (c − x)_+²,   ψ = c − x,   c = 1/3,   q(0) = 0,   φ(y) = 1 − y²

on the bottom of the unit square, where the cut-off φ lets the displacement end at the top. Viscosity A and elasticity G
are not proportional.

Predicted order 1: the front is fixed. The exponents of gap and pressure at the front, α = 3 > 5/2 and m = 2 > 3/2, give
u ∈ W^{1,∞}(0,T;H²) and (5.36), so that Prop. 5.4 applies. The position of the front does not matter.

c = 1/3 is a vertex of no structured mesh with 2^k cells along a side.
"""

from dataclasses import replace

from sympy import Rational

from manufactured.case import Case
from manufactured.cases import fixed_front_on_vertex


def case() -> Case:
    return replace(
        fixed_front_on_vertex.case(),
        name="fixed-front-off-vertex",
        summary="zone [0, 1/3] that stays, front off the vertices",
        solution=fixed_front_on_vertex.at(Rational(1, 3)),
        families=("unstructured",),
    )
