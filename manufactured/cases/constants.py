"""The default of the factors with which the arguments of a case multiply its constants, to make similar solutions."""

from sympy import Expr, Integer

ONE: Expr = Integer(1)
"""The factor 1, which leaves a constant unchanged."""
