"""The data of Problem 2.1: body, law, forces f_0 and f_2, and initial displacement u_0, without a solution.

A computation that uses only ``Data`` works for problems with unknown solutions. ``Data.of`` makes the data of an
exact solution, ``Data.formulas`` makes data from formulas of x1, x2 and t.
"""

from manufactured.data.compiled_formulas import Expressions
from manufactured.data.problem_data import Data, ForceInTime, LoadError, no_fronts

__all__ = ["Data", "Expressions", "ForceInTime", "LoadError", "no_fronts"]
