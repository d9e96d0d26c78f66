"""The observed order of an error of which only an interval is known."""

from __future__ import annotations

import math


def order_interval(coarse: tuple[float, float], fine: tuple[float, float], ratio: float) -> tuple[float, float]:
    """The interval of log(E/E')/ratio.

    Args:
        coarse, fine: intervals of E and E' ≥ 0 on two meshes of sizes h > h'.
        ratio: log(h/h').

    Returns:
        Its ends, infinite where a lower bound is 0.
    """
    low = math.log(coarse[0] / fine[1]) / ratio if coarse[0] > 0 else -math.inf
    high = math.log(coarse[1] / fine[0]) / ratio if fine[0] > 0 else math.inf
    return low, high
