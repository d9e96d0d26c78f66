"""Decimal numbers that stay bounds: rounded down or up, not to nearest."""

from __future__ import annotations

import math
from collections.abc import Hashable
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal

import pandas as pd


def down(value: float, digits: int) -> str:
    """A number with so many significant digits that is not larger."""
    return _rounded(value, digits, ROUND_FLOOR)


def up(value: float, digits: int) -> str:
    """A number with so many significant digits that is not smaller."""
    return _rounded(value, digits, ROUND_CEILING)


def power_of_ten(value: float, least: float) -> float:
    """The least power of ten that is not smaller than a number ≥ 0, and at least ``least``; infinity and NaN stay."""
    if not math.isfinite(value) or value <= least:
        return max(value, least)
    exponent = Decimal(value).adjusted()
    return float(f"1e{exponent}") if value <= float(f"1e{exponent}") else float(f"1e{exponent + 1}")


def below(value: float, decimals: int) -> str:
    """A number with so many decimals that is not larger than what the shortest digits of a value say."""
    return _quantized(value, decimals, ROUND_FLOOR)


def above(value: float, decimals: int) -> str:
    """A number with so many decimals that is not smaller than what the shortest digits of a value say."""
    return _quantized(value, decimals, ROUND_CEILING)


def interval(low: float, high: float, digits: int) -> str:
    """[low, high], rounded outwards."""
    return f"[{down(low, digits)}, {up(high, digits)}]"


def _rounded(value: float, digits: int, rounding: str) -> str:
    return f"{float(Context(prec=digits, rounding=rounding).create_decimal(Decimal(value))):.{digits}g}"


def _quantized(value: float, decimals: int, rounding: str) -> str:
    return str(Decimal(repr(float(value))).quantize(Decimal(1).scaleb(-decimals), rounding))


def significant(number: float) -> str:
    """Four significant digits, trailing zeros kept: 0.05 → 0.05000, 1234.5 → 1234; zero is 0."""
    return f"{number:#.4g}".rstrip(".") if number else "0"


def cell(value: Hashable) -> str:
    """The text of one cell: whole numbers and words as they are, other numbers to four significant digits."""
    if pd.isna(value):
        return ""
    text = str(value)
    try:
        number = float(text)
    except ValueError:
        return text
    return text if text.lstrip("+-").isdigit() else significant(number)
