"""What all figures share: the style, widths and the place of the legend."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager
from pathlib import Path

from matplotlib import rc_context
from matplotlib.artist import Artist
from matplotlib.figure import Figure

STYLE = Path(__file__).parent / "style.mplstyle"
COLUMN, PAGE = 3.5, 7.0
"""Width of a column and of a page in inches."""


def in_style() -> AbstractContextManager[None]:
    """The style of the study, and nothing of the user's, for figures made and saved inside the context."""
    return rc_context(fname=STYLE)


def legend(figure: Figure, handles: Sequence[Artist], columns: int, side: str = "lower") -> None:
    """A legend under (or, with ``side`` "upper", over) the axes, outside them."""
    figure.legend(handles=handles, loc=f"outside {side} center", ncols=columns)
