"""The data of Problem 2.1: body, law, forces f_0 and f_2, initial displacement u_0, and no solution.

What is computed from ``Data`` alone can serve a problem whose solution nobody knows. An exact solution gives its data
by ``Data.of``; formulas of x1, x2 and t by ``Data.formulas``.
"""

from manufactured.data.expressions import Expressions
from manufactured.data.problem_data import Data, ForceInTime, LoadError, no_fronts

__all__ = ["Data", "Expressions", "ForceInTime", "LoadError", "no_fronts"]
