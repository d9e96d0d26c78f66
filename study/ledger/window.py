"""Tolerance windows: where a measured number has to lie, fixed before it is measured."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

MIN_POSITIVE = 1e-20
"""The least positive diagnostic. Two computations of one quantity differ by rounding, about 1e-16 of its size; a
diagnostic of exactly 0 means that a quantity was compared with itself."""
SMALL = 1e-3
"""A low end below this part of the high end only asks for a positive value."""
STEEPER = 0.15
"""Room for the observed order of a solution without (5.36)."""


@dataclass(frozen=True)
class Window:
    """The interval [low, high] for a quantity, with a text made from its numbers.

    Attributes:
        low, high: the ends. A low end of 0 or −∞, or far below the high end, says that only large values are bad.
        why: the reason for these ends, or what they are relative to.
        predicted: the least and the largest predicted value, if the window is their interval with room on both sides.
    """

    low: float = -math.inf
    high: float = math.inf
    why: str = ""
    predicted: tuple[float, float] | None = None

    @property
    def text(self) -> str:
        """The window in words, such as ``1 ± 0.15: every consecutive order``."""
        return f"{self._numbers()}: {self.why}" if self.why else self._numbers()

    def _numbers(self) -> str:
        if self.predicted:
            least, largest = self.predicted
            middle = shown(least) if least == largest else f"{shown(least)} … {shown(largest)}"
            below, above = f"{least - self.low:.3g}", f"{self.high - largest:.3g}"
            if below == above:
                return f"{middle} ± {below}"
            return f"{shown(self.low)} … {shown(self.high)}, predicted {middle}"
        if math.isinf(self.high):
            return f"≥ {shown(self.low)}"
        if self.low == MIN_POSITIVE:
            return f"> 0 and ≤ {shown(self.high)}"
        one_sided = self.low == 0 or math.isinf(self.low)
        return f"≤ {shown(self.high)}" if one_sided else f"{shown(self.low)} … {shown(self.high)}"

    def contains(self, *values: float) -> bool:
        """Return whether all values lie inside; NaN does not."""
        return all(self.low <= value <= self.high for value in values)

    def worst(self, values: Sequence[float]) -> float:
        """Return the worst value: the farthest from the middle, or the largest or smallest of a one-sided window."""
        if math.isinf(self.high):
            distances = [-value for value in values]
        elif self.low > SMALL * self.high or -math.inf < self.low < 0 or self.predicted:
            distances = [abs(value - (self.low + self.high) / 2) for value in values]
        else:
            distances = list(values)
        return values[int(np.argmax(np.nan_to_num(distances, nan=np.inf)))]


def at_most(high: float, why: str = "", low: float = 0.0) -> Window:
    """Return the window of values up to ``high``; ``low`` is 0 for quantities ≥ 0, −∞ for others."""
    return Window(low, high, why)


def positive_at_most(high: float, why: str = "") -> Window:
    """Return the window of positive values up to ``high``: 0 means that a quantity was compared with itself."""
    return Window(MIN_POSITIVE, high, why)


def at_least(low: float, why: str = "") -> Window:
    """Return the window of values from ``low`` on."""
    return Window(low, math.inf, why)


def around(predicted: float, room: float, why: str = "") -> Window:
    """Return the window predicted ± room."""
    return Window(predicted - room, predicted + room, why, (predicted, predicted))


def between(least: float, largest: float, below: float, above: float, why: str = "") -> Window:
    """Return the window from the least predicted value minus ``below`` to the largest plus ``above``."""
    return Window(least - below, largest + above, why, (least, largest))


def shown(number: float) -> str:
    """Return three significant digits, plus the room for rounding of a bound: 0.544, 1e-10, 1 + 1e-9."""
    text = f"{number:.3g}"
    rest = number - float(text) if math.isfinite(number) else 0.0
    if number and 0 < abs(rest) < 1e-4 * abs(number):
        text += f" {'+' if rest > 0 else '−'} {abs(rest):.1g}"
    return text.replace("e-0", "e-").replace("e+0", "e")
