"""A fixed front at which the strain is continuous: w ~ r^{9/4}, p ~ r^{5/4}.

    w = 60 t (x − c)_+^{9/4} (1 − x)²,   p = 200 t (c − x)_+^{5/4} x²,   ψ = c − x,   c = 1/3,   q(0) = 0

on the unit square, A and G not proportional.

Predicted order 3/4: with α = 9/4 and m = 5/4, u(t) ∈ H^{1+s} for s < min(α − 3/2, m − 1/2) = 3/4, so interpolation has
that order. Prop. 5.3 gives no order.
"""

from functools import partial

from sympy import Rational

from manufactured.cases.rough_front import rough_front

case = partial(rough_front, Rational(9, 4))
