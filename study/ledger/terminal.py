"""How wide what is printed may be."""

from __future__ import annotations

import shutil

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
