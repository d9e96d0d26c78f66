"""What all figures share: the style, the look of a mesh family, captions, and saving."""

from __future__ import annotations

import gc
import textwrap
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path

from matplotlib import rc_context
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_pdf import FigureCanvasPdf
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from study.ledger.files import write_text, write_whole

STYLE = Path(__file__).parent / "style.mplstyle"
_ANONYMOUS: dict[str, dict[str, None]] = {
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None},
}
COLUMN, PAGE = 3.5, 7.0
"""Width of a column and of a page in inches."""

# Okabe and Ito, Color Universal Design (2008); their yellow is too light for lines.
BLUE, VERMILLION, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#CC79A7"
ORANGE, SKY, BLACK = "#E69F00", "#56B4E9", "#000000"
GREY = "#8C8C8C"


@dataclass(frozen=True)
class Drawing:
    """A figure that can be drawn from data alone.

    Attributes:
        name: the name of its files.
        draw: makes the figure, in the style of the study (``in_style``).
        caption: says what is shown and what to see, with numbers from the same data.
    """

    name: str
    draw: Callable[[], Figure]
    caption: Callable[[], str]


@dataclass(frozen=True)
class Look:
    """Colour and marker of a mesh family, the same in every figure."""

    colour: str
    marker: str


_KNOWN = {
    "one-diagonal": Look(BLUE, "o"),
    "criss-cross": Look(VERMILLION, "s"),
    "shaken": Look(GREEN, "^"),
    "unstructured": Look(PURPLE, "D"),
    "graded": Look(ORANGE, "v"),
}
_SPARE = (Look(SKY, "P"), Look(BLACK, "X"), Look(GREY, "h"))


def looks(families: Iterable[str]) -> dict[str, Look]:
    """The look of each family; families without one of their own get spare ones in alphabetical order."""
    names = set(families)
    known = {name: look for name, look in _KNOWN.items() if name in names}
    return known | dict(zip(sorted(names - set(known)), cycle(_SPARE), strict=False))


def legend(figure: Figure, handles: Sequence[Artist], columns: int, side: str = "lower") -> None:
    """A legend under (or, with ``side`` "upper", over) the axes, outside them."""
    figure.legend(handles=handles, loc=f"outside {side} center", ncols=columns)


def save_caption(drawing: Drawing, directory: Path) -> Path:
    """Write ``directory/name.txt``: the caption in lines of 100 characters."""
    return write_text(directory / f"{drawing.name}.txt", textwrap.fill(drawing.caption(), 100) + "\n")


def save(figure: Figure, directory: Path, name: str) -> list[Path]:
    """Write ``directory/name`` as pdf, png and svg, without dates or versions in them.

    The layout is found once, on the canvas that draws the png, so that texts measured for it are not measured
    again; each file is then drawn once, by the canvas of its format (``Figure.savefig`` lays out and draws twice).
    """
    raster = FigureCanvasAgg(figure)
    layout = figure.get_layout_engine()
    assert layout is not None
    layout.execute(figure)
    figure.set_layout_engine("none")
    written = {
        "png": raster.print_png,
        "pdf": FigureCanvasPdf(figure).print_pdf,
        "svg": FigureCanvasSVG(figure).print_svg,
    }

    def write(form: str) -> Path:
        # A name may hold dots of its own (rough-1.75), so a suffix is appended, not replaced.
        path = directory / f"{name}.{form}"
        return write_whole(path, lambda part: written[form](part, metadata=_ANONYMOUS[form]))

    return [write(form) for form in written]


@contextmanager
def uncollected() -> Iterator[None]:
    """No search for cyclic garbage inside the context; it is made up for at the next chance afterwards."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


def in_style() -> AbstractContextManager[None]:
    """The style of the study, and nothing of the user's, for figures made and saved inside the context."""
    return rc_context(fname=STYLE)
