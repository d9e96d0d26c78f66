"""How many time steps a measurement takes."""

from __future__ import annotations

import math

from manufactured.case import Case


def paced_steps(pace: float, T: float, level: int) -> int:
    """pace · T · n^{2/3} steps, slower than 1/h.

    A scheme of order 3/2 (midpoint with velocity kinks) then has a time error of the order h, one
    of order 2 an error of order h^{4/3}.
    """
    return math.ceil(pace * T * level ** (2 / 3))


def steps_for(case: Case, level: int) -> int:
    """The same for the pace of a case."""
    return paced_steps(case.pace, case.solution.body.T, level)


def even_steps(case: Case, level: int) -> int:
    """An even number of steps of the size of h, shorter where more happens in time."""
    return 2 * round(min(max(1.0, case.pace / 2), 4.0) * case.solution.body.T * level / 2)
