"""Text for the terminal and for tables: wraps lines, and rounds numbers so that bounds remain bounds."""

import shutil
from collections.abc import Hashable
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from functools import partial
from math import inf, isfinite
from textwrap import fill

import pandas as pd

WIDE = 110
"""Characters in a line of output on a wide terminal, and without a terminal."""
NARROW = 80
"""Characters in a line of output on a narrow terminal."""


def width() -> int:
    """Return the number of characters in a line of output: ``WIDE`` if the terminal is that wide, else ``NARROW``."""
    return WIDE if shutil.get_terminal_size((WIDE, 24)).columns >= WIDE else NARROW


def is_narrow() -> bool:
    """Return whether printed tables must fit into ``NARROW`` characters."""
    return width() == NARROW


def folded(text: str) -> str:
    """Return a text wrapped to the width of the output, between words only, so that paths can be copied."""
    return fill(text, width(), subsequent_indent="    ", break_long_words=False, break_on_hyphens=False)


def _significant(value: float, digits: int, rounding: str) -> str:
    return f"{float(Context(prec=digits, rounding=rounding).create_decimal(Decimal(value))):.{digits}g}"


down = partial(_significant, rounding=ROUND_FLOOR)
"""Return a number as text, rounded down to a number of significant digits; it remains a lower bound."""
up = partial(_significant, rounding=ROUND_CEILING)
"""Return a number as text, rounded up to a number of significant digits; it remains an upper bound."""


def power_of_ten(value: float, least: float) -> float:
    """Return the smallest power of ten that is at least ``value`` and at least ``least``.

    Infinity and NaN are returned unchanged.

    Parameters:
        value: a number ≥ 0, infinity or NaN.
        least: a power of ten.
    """
    if not isfinite(value) or value <= least:
        return max(value, least)
    exponent = Decimal(value).adjusted()
    lower = float(f"1e{exponent}")
    return lower if value <= lower else float(f"1e{exponent + 1}")


def _to_decimals(value: float, decimals: int, rounding: str) -> str:
    return str(Decimal(str(value)).quantize(Decimal(1).scaleb(-decimals), rounding))


below = partial(_to_decimals, rounding=ROUND_FLOOR)
"""Return a number as text, rounded down to a number of decimal places; it remains a lower bound."""
above = partial(_to_decimals, rounding=ROUND_CEILING)
"""Return a number as text, rounded up to a number of decimal places; it remains an upper bound."""


def outwards(low: float, high: float) -> str:
    """Return the range from low to high as text, rounded outwards to two decimals: "0.92 to 1.00"."""
    return f"{below(low, 2)} to {above(high, 2)}"


def interval(low: float, high: float, digits: int) -> str:
    """Return the interval [low, high] as text, with both ends rounded outwards to a number of significant digits."""
    if low > high:
        raise ValueError(f"the interval from {low:g} to {high:g} has crossed ends: this is a defect of the program")
    return f"[{down(low, digits)}, {up(high, digits) if high < inf else '∞'}]"


def significant(number: float) -> str:
    """Return a number as text with four significant digits, zeros included: 0.05000 for 0.05, 1234 for 1234.5."""
    return f"{number:#.4g}".rstrip(".") if number else "0"


def cell(value: Hashable) -> str:
    """Return the text of a table cell. Words and whole numbers are unchanged; other numbers get four digits."""
    if pd.isna(value):
        return ""
    text = str(value)
    try:
        number = float(text)
    except ValueError:
        return text
    return text if text.lstrip("+-").isdigit() else significant(number)
