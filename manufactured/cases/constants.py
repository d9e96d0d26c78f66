"""Constants of the cases; arguments of a case multiply them, so that similar solutions can be made."""

from sympy import Expr, Integer

ONE: Expr = Integer(1)
"""The factor 1, which leaves a constant unchanged."""
