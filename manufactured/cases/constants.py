"""The factor 1, which the arguments of a case use as a default: other factors multiply constants of its formulas."""

from sympy import Expr, Integer

ONE: Expr = Integer(1)
"""The factor 1, which leaves a constant unchanged."""
