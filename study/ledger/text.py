"""Numbers and lines of text: decimal numbers rounded down or up so that they stay bounds, and the width of output."""

from __future__ import annotations

import math
import shutil
import textwrap
from collections.abc import Hashable
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal

import pandas as pd

WIDTH = 110
"""Columns of printed text: the most, and the default without a terminal."""
NARROW = 80
"""Columns of the narrow layout; terminals with fewer columns wrap lines themselves."""


def width() -> int:
    """Return ``WIDTH`` if the terminal has that many columns, else ``NARROW``."""
    return WIDTH if shutil.get_terminal_size((WIDTH, 24)).columns >= WIDTH else NARROW


def is_narrow() -> bool:
    """Return whether the narrow layout is needed."""
    return width() == NARROW


def folded(text: str) -> str:
    """Return a line of text wrapped between words only, so that paths can be copied."""
    return textwrap.fill(text, width(), subsequent_indent="    ", break_long_words=False, break_on_hyphens=False)


def down(value: float, digits: int) -> str:
    """Return a number rounded down to some significant digits."""
    return _rounded(value, digits, ROUND_FLOOR)


def up(value: float, digits: int) -> str:
    """Return a number rounded up to some significant digits."""
    return _rounded(value, digits, ROUND_CEILING)


def power_of_ten(value: float, least: float) -> float:
    """Return the least power of ten ≥ a number ≥ 0, at least ``least``; infinity and NaN are returned unchanged."""
    if not math.isfinite(value) or value <= least:
        return max(value, least)
    exponent = Decimal(value).adjusted()
    return float(f"1e{exponent}") if value <= float(f"1e{exponent}") else float(f"1e{exponent + 1}")


def below(value: float, decimals: int) -> str:
    """Return the shortest decimal form of a value, rounded down to some decimals."""
    return _quantized(value, decimals, ROUND_FLOOR)


def above(value: float, decimals: int) -> str:
    """Return the shortest decimal form of a value, rounded up to some decimals."""
    return _quantized(value, decimals, ROUND_CEILING)


def interval(low: float, high: float, digits: int) -> str:
    """Return [low, high] as text, rounded outwards."""
    return f"[{down(low, digits)}, {up(high, digits)}]"


def _rounded(value: float, digits: int, rounding: str) -> str:
    return f"{float(Context(prec=digits, rounding=rounding).create_decimal(Decimal(value))):.{digits}g}"


def _quantized(value: float, decimals: int, rounding: str) -> str:
    return str(Decimal(repr(float(value))).quantize(Decimal(1).scaleb(-decimals), rounding))


def significant(number: float) -> str:
    """Return four significant digits with trailing zeros: 0.05 → 0.05000, 1234.5 → 1234; zero is 0."""
    return f"{number:#.4g}".rstrip(".") if number else "0"


def cell(value: Hashable) -> str:
    """Return the text of one cell: words and whole numbers unchanged, other numbers with four significant digits."""
    if pd.isna(value):
        return ""
    text = str(value)
    try:
        number = float(text)
    except ValueError:
        return text
    return text if text.lstrip("+-").isdigit() else significant(number)
