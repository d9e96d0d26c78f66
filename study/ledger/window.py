"""Where a measured number must lie, fixed before it is measured."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

SOMETHING = 1e-20
"""The least that evidence may show. Two computations in different arithmetic differ by 1e-16 of their size, or a few
powers of ten less where little of it happens to be seen; exactly nothing is what a thing leaves beside itself."""
SMALL = 1e-3
"""A low end below this part of the high end only asks that there be something."""
STEEPER = 0.15
"""Room for an order that is seen of a solution without (5.36)."""


@dataclass(frozen=True)
class Window:
    """[low, high] for a quantity; its text is made from its numbers.

    Attributes:
        low, high: the ends. A low end of 0 or −∞, or far below the high end, says that only large values are bad.
        why: the reason for these ends, or what they are relative to.
        predicted: the least and the largest predicted value, where the window is these with some room on both sides.
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
            return f"{middle} ± {below}" if below == above else f"{middle}, − {below} + {above}"
        if math.isinf(self.high):
            return f"≥ {shown(self.low)}"
        return f"{shown(self.low)} … {shown(self.high)}" if self.low > 0 else f"≤ {shown(self.high)}"

    def contains(self, *values: float) -> bool:
        """Whether all values lie inside; what is not a number does not."""
        return all(self.low <= value <= self.high for value in values)

    def worst(self, values: Sequence[float]) -> float:
        """The value that is farthest from where it should be: from the middle, or the largest or smallest one."""
        if math.isinf(self.high):
            distances = [-value for value in values]
        elif self.low > SMALL * self.high or self.predicted:
            distances = [abs(value - (self.low + self.high) / 2) for value in values]
        else:
            distances = list(values)
        return values[int(np.argmax(np.nan_to_num(distances, nan=np.inf)))]


def at_most(high: float, why: str = "", low: float = 0.0) -> Window:
    """Values up to ``high``; ``low`` is 0 for what cannot be negative, −∞ for what may be."""
    return Window(low, high, why)


def above_nothing(high: float, why: str = "") -> Window:
    """Values up to ``high`` of evidence that cannot be exactly nothing unless something was compared with itself."""
    return Window(SOMETHING, high, why)


def at_least(low: float, why: str = "") -> Window:
    """Values from ``low`` on."""
    return Window(low, math.inf, why)


def around(predicted: float, room: float, why: str = "") -> Window:
    """predicted ± room."""
    return Window(predicted - room, predicted + room, why, (predicted, predicted))


def between(least: float, largest: float, below: float, above: float, why: str = "") -> Window:
    """From the least predicted value less some room to the largest with some."""
    return Window(least - below, largest + above, why, (least, largest))


def shown(number: float) -> str:
    """Three significant digits, and what a bound leaves for rounding beside them: 0.544, 1e-10, 1 + 1e-9."""
    text = f"{number:.3g}"
    rest = number - float(text) if math.isfinite(number) else 0.0
    if number and 0 < abs(rest) < 1e-4 * abs(number):
        text += f" {'+' if rest > 0 else '−'} {abs(rest):.1g}"
    return text.replace("e-0", "e-").replace("e+0", "e")
