"""A fixed front at which the strain is continuous: gap and pressure behave like r^{9/4} and r^{5/4}.

The gap w, the contact pressure p, the contact zone {ψ ≥ 0} with the front c, and the normal strain q at t = 0 are

    w = 60 t (x − c)_+^{9/4} (1 − x)²,   p = 200 t (c − x)_+^{5/4} x²,   ψ = c − x,   c = 1/3,   q(0) = 0

on the bottom of the unit square. Viscosity A and elasticity G are not proportional.

Predicted order 3/4: the exponents of gap and pressure are α = 9/4 and m = 5/4. So u(t) ∈ H^{1+s} for
s < min(α − 3/2, m − 1/2) = 3/4, and interpolation has the order 3/4. Prop. 5.3 gives no order.
"""

from functools import partial

from sympy import Rational

from manufactured.cases.rough_front import rough_front

case = partial(rough_front, Rational(9, 4))
