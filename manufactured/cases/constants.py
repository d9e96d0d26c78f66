"""Constants that the arguments of a case multiply, so that others make the same kind of solution."""

from sympy import Expr, Integer

ONE: Expr = Integer(1)
"""The factor that leaves a constant as it is."""
