"""A fixed front at which the strain jumps: w ~ r², p ~ r.

    w = 60 t (x − c)_+² (1 − x)²,   p = 200 t (c − x)_+ x²,   ψ = c − x,   c = 1/3,   q(0) = 0

on the unit square, A and G not proportional.

Predicted order 1/2: with α = 2 and m = 1, u(t) ∈ H^{1+s} for s < min(α − 3/2, m − 1/2) = 1/2, so interpolation has that
order. Prop. 5.3 gives no order.
"""

from functools import partial

from sympy import Rational

from manufactured.cases.rough_front import rough_front

case = partial(rough_front, Rational(2))
