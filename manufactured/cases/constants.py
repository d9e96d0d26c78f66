"""Constants that the arguments of a case multiply, so that others make the same kind of solution."""

from sympy import Expr, Integer

ONE: Expr = Integer(1)
"""The factor 1, which leaves a constant unchanged."""
