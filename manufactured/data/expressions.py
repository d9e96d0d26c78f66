"""The formulas of the data of a problem, for computations that need more than values at points."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp


@dataclass(frozen=True)
class Expressions:
    """The formulas of f_0, f_2 and u_0 in x1, x2 (x3) and t. Two instances are equal if their formulas are.

    Attributes:
        force: the components of f_0.
        loads: (number of a part of ``body.parts``, components of f_2 on it), by number; no load on the other parts.
        start: the components of u_0.
    """

    force: tuple[sp.Expr, ...]
    loads: tuple[tuple[int, tuple[sp.Expr, ...]], ...]
    start: tuple[sp.Expr, ...]
