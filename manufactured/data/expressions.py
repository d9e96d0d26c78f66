"""The formulas of the data of a problem, for computations that need more than values at points."""

from dataclasses import dataclass

import sympy as sp

from manufactured.arguments import checked
from manufactured.symbols import FormulaError


@dataclass(frozen=True)
@checked(FormulaError)
class Expressions:
    """Formulas of the body force f_0, the tractions f_2 and the initial displacement u_0 in x1, x2 (x3) and t.

    Two instances are equal if their formulas are equal.

    Attributes:
        force: the components of f_0.
        loads: pairs of the number of a part in ``body.parts`` and the components of f_2 on it, sorted by number. On
            other parts there is no load.
        start: the components of u_0.
    """

    force: tuple[sp.Expr, ...]
    loads: tuple[tuple[int, tuple[sp.Expr, ...]], ...]
    start: tuple[sp.Expr, ...]
