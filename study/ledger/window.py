"""Tolerance windows: the intervals in which measured numbers must lie, fixed before the measurement."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite, isinf

import numpy as np

MIN_POSITIVE = 1e-20
"""The smallest diagnostic that counts as positive. If a quantity is computed in two ways, the results differ at
least by rounding, about 1e-16 of the quantity. So a difference of exactly 0 means that a quantity was compared with
itself."""
SMALL_END = 1e-3
"""If the lower end of a window is less than this fraction of the upper end, only the upper end is regarded."""
STEEPER = 0.15
"""Half the width of the tolerance window for the observed order of a solution that is not smooth enough for the
propositions of the paper (assumption (5.36))."""


@dataclass(frozen=True)
class Window:
    """A tolerance window: the interval [low, high] in which a quantity must lie.

    Attributes:
        low, high: the ends. If ``low`` is 0, −∞ or far below ``high``, only large values are bad.
        why: words that follow the ends in ``text``: their reason, such as "every consecutive order", or what the value
            is a fraction of, such as "of the value on the finest level".
        predicted: the smallest and the largest predicted value, if the window extends beyond them on both sides.
    """

    low: float = -inf
    high: float = inf
    why: str = ""
    predicted: tuple[float, float] | None = None

    @property
    def text(self) -> str:
        """The window in words, such as ``1 ± 0.15: every consecutive order``."""
        low = shown(self.low)
        high = shown(self.high)
        if self.predicted:
            least, largest = self.predicted
            middle = " … ".join(dict.fromkeys(map(shown, self.predicted)))
            below = f"{least - self.low:.3g}"
            above = f"{self.high - largest:.3g}"
            numbers = f"{middle} ± {below}" if below == above else f"{low} … {high}, predicted {middle}"
        elif isinf(self.high):
            numbers = f"≥ {low}"
        elif self.low == MIN_POSITIVE:
            numbers = f"> 0 and ≤ {high}"
        elif self.low == 0 or isinf(self.low):
            numbers = f"≤ {high}"
        else:
            numbers = f"{low} … {high}"
        return f"{numbers}: {self.why}" if self.why else numbers

    def contains(self, *values: float) -> bool:
        """Return whether all values lie in the window; NaN lies in no window."""
        return all(self.low <= value <= self.high for value in values)

    def worst(self, values: Sequence[float]) -> float:
        """Return the worst of some values.

        In a window with two ends, the worst value is the one farthest from the middle. If only large values are bad, it
        is the largest one; if only small values are bad, the smallest one. NaN is worse than any number.
        """
        if isinf(self.high) and isfinite(self.low):
            distances = [-value for value in values]
        elif is_two_sided(self.low, self.high) or self.predicted:
            distances = [abs(value - (self.low + self.high) / 2) for value in values]
        else:
            distances = list(values)
        return values[int(np.argmax(np.nan_to_num(distances, nan=inf)))]


def is_two_sided(low: float, high: float) -> bool:
    """Return whether values can come near both ends of the window [low, high].

    They cannot if an end is infinite, or if the lower end is 0 or negligible next to the upper end.
    """
    return isfinite(low) and isfinite(high) and not 0 <= low <= SMALL_END * high


def position(value: float, low: float, high: float) -> float:
    """Return the position of a value in the window [low, high], whose ends have the positions −1 and 1.

    If only one end of the window is a limit (``is_two_sided`` is false), this end has the position 1. Then the position
    is the value divided by the upper end or, if the upper end is ∞, the lower end divided by the value.

    Parameters:
        value: the value.
        low, high: the ends of the window; ``high`` may be ∞.
    """
    if isinf(high):
        return low / value if value > 0 else inf
    return (2 * value - low - high) / (high - low) if is_two_sided(low, high) else value / high


def at_most(high: float, why: str = "", low: float = 0.0) -> Window:
    """Return the tolerance window of values up to ``high``.

    Parameters:
        high: the upper end.
        why: the reason for the end.
        low: the lower end. Quantities that may be negative need −∞.
    """
    return Window(low, high, why)


def positive_at_most(high: float, why: str = "") -> Window:
    """Return the tolerance window of values up to ``high`` that are positive: at least ``MIN_POSITIVE``."""
    return Window(MIN_POSITIVE, high, why)


def at_least(low: float, why: str = "") -> Window:
    """Return the tolerance window of values that are at least ``low``; ``why`` is the reason for this limit."""
    return Window(low, inf, why)


def around(predicted: float, room: float, why: str = "") -> Window:
    """Return the tolerance window from ``predicted`` − ``room`` to ``predicted`` + ``room``.

    Parameters:
        predicted: the predicted value.
        room: the largest accepted difference from it.
        why: the reason for the window.
    """
    return between(predicted, predicted, room, room, why)


def between(least: float, largest: float, below: float, above: float, why: str = "") -> Window:
    """Return the tolerance window around an interval of predictions, from least − below to largest + above.

    Parameters:
        least, largest: the smallest and the largest predicted value.
        below, above: the accepted differences below and above this interval.
        why: the reason for the window.
    """
    return Window(least - below, largest + above, why, (least, largest))


def shown(number: float) -> str:
    """Return a number as text with three significant digits.

    If they differ from the number by less than 1e-4 of it, the difference follows: 1.000000001 becomes ``1 + 1e-9``.
    """
    text = f"{number:.3g}"
    rest = number - float(text) if isfinite(number) else 0.0
    if number and 0 < abs(rest) < 1e-4 * abs(number):
        text += f" {'+' if rest > 0 else '−'} {abs(rest):.1g}"
    return text.replace("e-0", "e-").replace("e+0", "e")
