"""Refuses problems in units for which double precision is too narrow.

A bound consists of roots of sums of squares, and squares overflow above 1e154 and vanish below 1e-162. If squares of
data underflow, a bound of 0 would be stated for an error that is not 0; if they overflow, infinity or no number at all
would be compared with others. The material, the body and the final time must have sizes between ``LEAST`` and
``MOST``. For them squares of the data and of residuals are normal numbers whenever the bound is ``SMALLEST`` or more,
so the bound shows whether squares have vanished.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from manufactured.data import Data, Expressions
from manufactured.law import Linear
from manufactured.tensors import Array
from study.bound.moduli import BoundError

LEAST, MOST = 1e-25, 1e25
SMALLEST, LARGEST = 1e-50, 1e100
"""Bounds of data that are not zero, and all quantities whose squares are summed, must lie between these numbers."""


def require_units(data: Data) -> None:
    """Refuse a material, a body or a final time of extreme size.

    Raises:
        BoundError: names the quantity and its value.
    """
    law, vertices = data.law, data.body.vertices
    sizes = {
        "the final time T": [data.body.T],
        "the size of the body": np.ptp(vertices, axis=1),
        "a modulus of A": [law.A.ellipticity, law.A.lipschitz],
    }
    if isinstance(law.G, Linear) and law.G.matrix.any():
        sizes["the largest entry of G"] = [abs(law.G.matrix).max()]
    for name, values in sizes.items():
        for value in values:
            if not LEAST <= value <= MOST:
                raise BoundError(
                    f"{name} is {value:.3g}; squares of such numbers overflow or vanish in double precision: state the "
                    f"problem in units in which it lies between {LEAST:g} and {MOST:g}"
                )


def require_finite(quantities: Mapping[str, Array | float]) -> None:
    """Refuse to state results that are infinite, not numbers, or so large that their squares overflow.

    Raises:
        BoundError: names the first such quantity.
    """
    for name, values in quantities.items():
        # A comparison with what is not a number is false.
        if not (np.abs(values) <= LARGEST).all():
            raise BoundError(
                f"{name} is not a finite number below {LARGEST:g}, so nothing can be bounded: large data overflow, and "
                "data that are unbounded near some point have no finite range; state the problem in units in which the "
                "data have moderate size, or give bounded data"
            )


def require_visible(data: Data, highest: float, seen: bool) -> None:
    """Refuse a bound so small that squares of data which are not zero may have vanished.

    Args:
        highest: the bound of the error at all times.
        seen: whether any sample of the data is not zero, for data that are not formulas.

    Raises:
        BoundError: states the bound.
    """
    formulas = data.formulas_of
    if isinstance(formulas, Expressions):
        loads = (component for _, load in formulas.loads for component in load)
        seen = any(component != 0 for component in (*formulas.force, *loads, *formulas.start))
    if seen and not highest >= SMALLEST:
        raise BoundError(
            f"the data are not zero, and the bound is {highest:.3g}, below {SMALLEST:g}: squares of numbers this small "
            "vanish in double precision; state the problem in units in which the data have moderate size"
        )
