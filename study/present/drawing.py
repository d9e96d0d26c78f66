"""Functions with which every figure is styled, labelled, drawn and saved with its caption."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Iterable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from cycler import cycler
from matplotlib import rc_context
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_pdf import FigureCanvasPdf
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from study.ledger.datafiles import DataError
from study.ledger.files import write_text, write_whole
from study.present.notation import encode
from study.present.palette import BLACK, COLOURS

STYLE = Path(__file__).parent / "style.mplstyle"
COLUMN, PAGE = 3.5, 7.0
"""Widths of a column and of a page in inches."""
_METADATA: dict[str, dict[str, None]] = {
    "png": {"Software": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
    "svg": {"Date": None, "Creator": None},
}
"""Dates and versions are left out, so that equal data give equal files."""

Progress = Callable[[int, int, str], None]
"""Function that is called after each figure with the number of finished figures, their total, and the name."""


@dataclass(frozen=True)
class Drawing:
    """A figure that is not drawn yet: the name of its files, the function that draws it, and its caption."""

    name: str
    draw: Callable[[], Figure]
    caption: str


def in_style() -> AbstractContextManager[None]:
    """Return a context in which Matplotlib uses the style of the study and ignores the user's settings."""
    return rc_context({"axes.prop_cycle": cycler(color=[*COLOURS, BLACK])}, fname=STYLE)


def legend(figure: Figure, handles: Sequence[Artist], columns: int, side: str = "lower") -> None:
    """Add a legend below the axes or, if ``side`` is "upper", above them."""
    figure.legend(handles=handles, loc=f"outside {side} center", ncols=columns)


def entry(label: str, **style: Any) -> Line2D:
    """Return a line for a legend."""
    return Line2D([], [], label=label, **style)


def dots(label: str, **style: Any) -> Line2D:
    """Return a marker for a legend, a circle unless the style says otherwise."""
    return entry(label, **{"ls": "", "marker": "o", **style})


def mathtext(text: str) -> str:
    """Return a text for Matplotlib, with its mathematics between dollar signs."""
    pieces = re.split(r"\\\((.*?)\\\)", encode(text))
    for i, piece in enumerate(pieces):
        if i % 2:
            # Matplotlib does not know \surd, but it knows the character.
            pieces[i] = f"${piece}$".replace(r"\surd", "√")
        else:
            pieces[i] = re.sub(r"\\([&%_#{}])", r"\1", piece.replace(r"\textasciitilde{}", "~"))
    return "".join(pieces)


def draw_figures(
    directory: Path,
    choose: Callable[[Path], list[Drawing]],
    run_map: Callable[..., Iterable[list[Path]]] = map,
    progress: Progress = lambda done, total, name: None,
) -> list[Path]:
    """Draw figures into ``directory/figures`` as pdf, png and svg, with captions in txt files; return the files.

    Parameters:
        directory: directory of a run.
        choose: returns the figures of a directory: ``drawings`` all of them, ``overview`` the figures over all cases.
        run_map: ``map``, or the ``map`` of an executor, which draws several figures at a time.
        progress: called after each figure.

    Raises:
        DataError: a data file is missing or damaged; then nothing is drawn.
    """
    chosen = choose(directory)
    written: list[Path] = []
    for done, paths in enumerate(run_map(partial(draw_one, directory / "figures"), chosen), start=1):
        written += paths
        progress(done, len(chosen), chosen[done - 1].name)
    return written


def draw_one(directory: Path, drawing: Drawing) -> list[Path]:
    """Draw one figure and save it as pdf, png and svg, and its caption as txt; return the files.

    Raises:
        DataError: a name from the data would write the figure into another directory.
    """
    if set(drawing.name) & {"/", "\\", "\0"}:
        raise DataError(
            f"the figure {drawing.name!r} cannot be written, as its name contains a path separator or NUL: the data "
            "were edited or damaged"
        )
    with in_style():
        figure = drawing.draw()
        png = FigureCanvasAgg(figure).print_png
        # The figure is laid out once and drawn once for each format; Figure.savefig would lay it out for each format.
        layout = figure.get_layout_engine()
        assert layout is not None
        layout.execute(figure)
        figure.set_layout_engine("none")
        printers = {"png": png, "pdf": FigureCanvasPdf(figure).print_pdf, "svg": FigureCanvasSVG(figure).print_svg}
        # A name may contain dots (rough-1.75), so the suffix is appended, not replaced.
        written = [
            write_whole(directory / f"{drawing.name}.{form}", partial(printers[form], metadata=metadata))
            for form, metadata in _METADATA.items()
        ]
    return [*written, write_text(directory / f"{drawing.name}.txt", caption_text(drawing))]


def caption_text(drawing: Drawing) -> str:
    """Return the text of the file with the caption of a figure."""
    return textwrap.fill(drawing.caption, 100) + "\n"
