"""How wide what is printed may be."""

from __future__ import annotations

import shutil
import textwrap

WIDTH = 110
"""Columns where nobody watches, and at most."""
NARROW = 80
"""Columns for which there is a narrower layout; terminals with fewer fold lines themselves."""


def width() -> int:
    """``WIDTH`` where the terminal has so many columns, else ``NARROW``."""
    return WIDTH if shutil.get_terminal_size((WIDTH, 24)).columns >= WIDTH else NARROW


def is_narrow() -> bool:
    """Whether the layout of ``NARROW`` columns is needed."""
    return width() == NARROW


def folded(text: str) -> str:
    """A line of text over as many lines as it takes, broken between words only, so that paths can be copied."""
    return textwrap.fill(text, width(), subsequent_indent="    ", break_long_words=False, break_on_hyphens=False)
