"""What all figures share: style, widths, texts and legend; and how one is drawn and saved with its caption."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Iterable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_pdf import FigureCanvasPdf
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from study.ledger.datafiles import DataError
from study.ledger.files import write_text, write_whole
from study.ledger.garbage import uncollected
from study.present.latex import encode

STYLE = Path(__file__).parent / "style.mplstyle"
COLUMN, PAGE = 3.5, 7.0
"""Width of a column and of a page in inches."""


def in_style() -> AbstractContextManager[None]:
    """The style of the study, and nothing of the user's, for figures made and saved inside the context."""
    return rc_context(fname=STYLE)


def legend(figure: Figure, handles: Sequence[Artist], columns: int, side: str = "lower") -> None:
    """A legend under (or, with ``side`` "upper", over) the axes, outside them."""
    figure.legend(handles=handles, loc=f"outside {side} center", ncols=columns)


def entry(label: str, **style: Any) -> Line2D:
    """A line of the legend."""
    return Line2D([], [], label=label, **style)


def dots(label: str, **style: Any) -> Line2D:
    """Markers of the legend, round unless the style has others."""
    return entry(label, **{"ls": "", "marker": "o", **style})


def mathtext(text: str) -> str:
    """Mathematics between dollar signs, the rest as it stands."""
    pieces = re.split(r"\\\((.*?)\\\)", encode(text))
    prose = [re.sub(r"\\([&%_#{}])", r"\1", piece.replace(r"\textasciitilde{}", "~")) for piece in pieces[::2]]
    # Of the commands of LaTeX that are in use, this one is unknown to Matplotlib; the character is known.
    formulas = [f"${piece}$".replace(r"\surd", "√") for piece in pieces[1::2]]
    return "".join(piece for pair in zip(prose, [*formulas, ""], strict=True) for piece in pair)


_ANONYMOUS: dict[str, dict[str, None]] = {
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None},
}

Progress = Callable[[int, int, str], None]
"""Called after each figure with how many are done, how many there are, and its name."""
Spread = Callable[..., Iterable[list[Path]]]
"""``map``, or the ``map`` of an executor, which draws several figures at a time."""


@dataclass(frozen=True)
class Drawing:
    """A figure that can be drawn from data alone: the name of its files, how it is drawn, its caption."""

    name: str
    draw: Callable[[], Figure]
    caption: str


def draw_figures(
    directory: Path,
    chosen: Callable[[Path], list[Drawing]],
    spread: Spread = map,
    progress: Progress = lambda done, total, name: None,
) -> list[Path]:
    """Draw figures into ``directory/figures`` as pdf, png and svg with their captions in a txt; returns the files.

    ``chosen`` says which: ``drawings`` are all of the directory, ``overview`` those over all cases.

    Raises:
        DataError: a data file is missing or damaged; nothing is drawn then.
    """
    found = chosen(directory)
    written: list[Path] = []
    for done, paths in enumerate(spread(partial(draw_one, directory / "figures"), found), start=1):
        written += paths
        progress(done, len(found), found[done - 1].name)
    return written


def draw_one(directory: Path, drawing: Drawing) -> list[Path]:
    """Draw one figure in the style of the study and save it as pdf, png and svg, and its caption in lines.

    Raises:
        DataError: a name from the data would write the figure into another directory.
    """
    if set(drawing.name) & {"/", "\\", "\0"}:
        raise DataError(
            f"the figure {drawing.name!r} cannot be written, as its name contains a path separator or NUL: the data "
            "were edited or damaged"
        )
    # The many small objects of a figure all live until it is saved: looking for garbage before finds nothing.
    with in_style(), uncollected():
        written = _save(drawing.draw(), directory, drawing.name)
    return [*written, write_text(directory / f"{drawing.name}.txt", caption_text(drawing))]


def caption_text(drawing: Drawing) -> str:
    """Returns the text of the file with the caption of a figure."""
    return textwrap.fill(drawing.caption, 100) + "\n"


def _save(figure: Figure, directory: Path, name: str) -> list[Path]:
    """Write ``directory/name`` as pdf, png and svg, without dates or versions in them.

    The layout is found once, on the canvas that draws the png, so that texts measured for it are not measured
    again; each file is then drawn once, by the canvas of its format (``Figure.savefig`` lays out and draws twice).
    """
    raster = FigureCanvasAgg(figure)
    layout = figure.get_layout_engine()
    assert layout is not None
    layout.execute(figure)
    figure.set_layout_engine("none")
    vector = {"pdf": FigureCanvasPdf(figure).print_pdf, "svg": FigureCanvasSVG(figure).print_svg}
    # A name may hold dots of its own (rough-1.75), so a suffix is appended, not replaced.
    return [
        write_whole(directory / f"{name}.{form}", partial(draw, metadata=_ANONYMOUS[form]))
        for form, draw in {"png": raster.print_png, **vector}.items()
    ]
