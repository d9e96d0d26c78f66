"""The number 1, the default value of the factors by which constants in the formulas of a case can be multiplied."""

from sympy import Expr, Integer

ONE: Expr = Integer(1)
"""The factor 1, which leaves a constant unchanged."""
