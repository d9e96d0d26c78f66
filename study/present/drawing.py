"""The style of all figures, their legends and labels, and functions that draw figures and save them with captions."""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from itertools import cycle
from pathlib import Path
from textwrap import fill
from typing import Any

from cycler import cycler
from matplotlib import rc_context, rc_params_from_file, rcParams
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_pgf import LatexError
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from pandas import DataFrame

from manufactured.colours import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILLION
from study.ledger.datafiles import DataError
from study.ledger.files import Json, Paths, UsageError, write_text, write_whole
from study.present.templates import ENVIRONMENT, read_page

OUTLINE = "0.35"
RIM = "0.4"
FOUNDATION = "0.82"
FOUNDATION_EDGE = "0.25"
TRIANGLE = "0.93"
COLOURS = (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY)
"""Colours of the first, second, … line in a figure. The colours of the report page are in ``page/page.css``."""
RAMPS = {"stress": "YlGnBu", "pressure": "OrRd"}
"""Quantity ↦ colour map of Matplotlib, from zero to the largest value, of ColorBrewer (Harrower and Brewer 2003).

Larger values have darker colours, so that figures can be read in grey; small values leave the mesh visible.
"""
RunMap = Callable[..., Iterable[Any]]
"""``map``, or the method ``map`` of an executor, which makes several things at a time."""
Style = dict[str, Any]
"""Properties of a line, as Matplotlib names them."""
FAMILY_STYLES: dict[str, Style] = {
    "one-diagonal": dict(color=BLUE, marker="o"),
    "criss-cross": dict(color=VERMILLION, marker="s"),
    "shaken": dict(color=GREEN, marker="^"),
    "unstructured": dict(color=PURPLE, marker="D"),
    "graded": dict(color=ORANGE, marker="v"),
}
OTHER_STYLES: tuple[Style, ...] = tuple(dict(color=c, marker=m) for c, m in ((SKY, "P"), (BLACK, "X"), (GREY, "h")))
STYLES = Path(__file__).parent
"""The folder of the Matplotlib style files.

``style.mplstyle`` is for all figures; a file ``USE.mplstyle`` has entries that replace some of them for one use."""
CAPTIONS: dict[str, str] = read_page("captions")
"""Name of a caption ↦ its template."""
WHAT_TO_SEE = "What to see: "
"""The words in a caption that are followed by the main point of the figure."""
SHEET = 6
"""The largest number of subplots that can be read on a slide."""


@dataclass(frozen=True)
class Drawing:
    """A figure that can be drawn: the function that draws it, its file name and its texts.

    Attributes:
        name: the name of the files of the figure, without a suffix.
        draw: function that draws the figure.
        caption: the caption, which says what is drawn and, after the text ``WHAT_TO_SEE``, the main point with numbers.
        summary: the kind of the figure in a few words, for readers who cannot see it.
        case: the case that the figure shows; empty for figures over several cases.
        sheet: whether the figure has more subplots than can be read on a slide.
        table: function that returns the data of the figure; None for a sketch, which has none.
    """

    name: str
    draw: Callable[[], Figure]
    caption: str
    summary: str
    case: str = ""
    sheet: bool = False
    table: Callable[[], DataFrame | None] = lambda: None

    @property
    def alternative(self) -> str:
        """The text for readers who cannot see the figure: the kind of the figure, and its main point."""
        point = self.caption.partition(WHAT_TO_SEE)[2] or self.caption
        return f"{capitalized(self.summary)}. {capitalized(point)}"

    @property
    def headline(self) -> str:
        """The headline of a slide: the main point of the caption up to the first semicolon or full stop."""
        point = self.caption.partition(WHAT_TO_SEE)[2]
        return re.split(r"; |\.$|\. ", capitalized(point))[0]


def capitalized(text: str) -> str:
    """Return a text with a capital first letter; the other letters are unchanged."""
    return text[:1].upper() + text[1:]


@dataclass(frozen=True)
class Output:
    """The use, the formats and the style of saved figures.

    Attributes:
        use: what the figures are for, a key of ``FORMATS``.
        formats: the formats, as suffixes of files; if empty, the formats of the use are written.
        dpi: dots per inch of PNG files; if None, the style decides.
        style: a Matplotlib style file of the user, whose entries replace those of the study.
    """

    use: str = "article"
    formats: tuple[str, ...] = ()
    dpi: float | None = None
    style: Path | None = None

    @property
    def suffixes(self) -> tuple[str, ...]:
        """The formats that are written."""
        return self.formats or FORMATS[self.use]

    def folder(self, directory: Path) -> Path:
        """Return the folder of the figures of a run: ``figures`` for articles, ``figures/USE`` for other uses."""
        return directory / "figures" / ("" if self.use == "article" else self.use)


FORMATS = {"article": ("pdf", "png"), "slides": ("png",), "web": ("svg",)}
"""Use of figures ↦ the formats that are written unless the user asks for others."""
ALTERNATIVE = {"png": "Description", "pdf": "Subject", "svg": "Description"}
"""Format ↦ the entry of its metadata with the alternative text. The format pgf has no metadata."""
CHANGING = {"png": ["Software"], "pdf": ["CreationDate", "Creator", "Producer"], "svg": ["Date", "Creator"]}
"""Format ↦ metadata with dates and versions, which are left out, so that equal data give equal files."""
ARTICLE = Output()


@contextmanager
def in_style(output: Output = ARTICLE) -> Iterator[None]:
    """Let Matplotlib use the style of the study in a ``with`` block, and ignore the settings of the user's machine.

    Raises:
        UsageError: the style file of the user cannot be read, or has an entry that Matplotlib does not know.
    """
    with rc_context({"axes.prop_cycle": cycler(color=[*COLOURS, BLACK])}, fname=STYLES / "style.mplstyle"):
        own = STYLES / f"{output.use}.mplstyle"
        if own.is_file():
            rcParams.update(rc_params_from_file(own, use_default_template=False))
        if output.style:
            try:
                lines = output.style.read_text(encoding="utf-8").splitlines()
                keys = [line.partition("#")[0].partition(":")[0].strip() for line in lines]
                if unknown := [key for key in keys if key and key not in rcParams]:
                    raise ValueError(f"there is no entry {unknown[0]}")
                entries = rc_params_from_file(output.style, fail_on_error=True, use_default_template=False)
            except (OSError, ValueError) as error:
                raise UsageError(f"--style {output.style} is not a Matplotlib style file: {error}") from error
            rcParams.update(entries)
        if output.dpi:
            rcParams["figure.dpi"] = output.dpi
        yield


def family_styles(names: Iterable[str]) -> dict[str, Style]:
    """Return mesh family ↦ style. Families without an entry in ``FAMILY_STYLES`` get the styles ``OTHER_STYLES``."""
    present = set(names)
    known = {name: style for name, style in FAMILY_STYLES.items() if name in present}
    return known | dict(zip(sorted(present - set(known)), cycle(OTHER_STYLES), strict=False))


def column_width() -> float:
    """Return the width of a column of text in inches, which is the width ``figure.figsize`` in the style."""
    return rcParams["figure.figsize"][0]


def page_width() -> float:
    """Return the width of a page in inches: two columns of text; for slides one column."""
    return column_width() if is_slide() else 2 * column_width()


def is_slide() -> bool:
    """Return whether figures are drawn for slides, which is the case if ``figure.figsize`` is wider than 3 : 2.

    All figures for slides have this size, and their legends are on the right.
    """
    width, height = rcParams["figure.figsize"]
    return width > 1.5 * height


def legend(figure: Figure, handles: Sequence[Artist], columns: int, side: str = "lower", *, wide: bool = False) -> None:
    """Add a legend to a figure, outside of its axes.

    Parameters:
        handles: the entries.
        columns: the number of columns; a legend on the right has one column.
        side: "lower" for a legend below the axes, "upper" for a legend above them.
        wide: whether the axes need the whole width; on slides, the legend is on the right unless this is true.
    """
    if is_slide() and not wide:
        figure.legend(handles=[handle for handle in handles if str(handle.get_label()).strip()], loc="outside right")
    else:
        figure.legend(handles=handles, loc=f"outside {side} center", ncols=columns)


def entry(label: str, **style: Any) -> Line2D:
    """Return a legend entry that shows a line."""
    return Line2D([], [], label=label, **style)


def dots(label: str, **style: Any) -> Line2D:
    """Return a legend entry that shows a marker; the marker is a circle unless the style has another."""
    return entry(label, **dict(ls="", marker="o") | style)


def drawn_for_use(drawing: Drawing) -> Figure:
    """Return a figure in the current style. A slide has no caption, but a headline above the title of the figure."""
    figure = drawing.draw()
    if is_slide():
        figure.set_size_inches(rcParams["figure.figsize"])
        lines = [fill(drawing.headline, 76), figure.get_suptitle()]
        figure.suptitle("\n".join(filter(None, lines)))
    return figure


def draw_one(directory: Path, drawing: Drawing, output: Output = ARTICLE) -> Paths:
    """Draw one figure, save it in each format, its caption in a txt file, and its data in a csv file.

    Parameters:
        directory: the directory of the files.
        drawing: the figure.
        output: the file formats and the style, for example for the article.

    Returns:
        The paths of the files.

    Raises:
        DataError: a name from the data would write the figure into another directory.
    """
    name = drawing.name
    if set(name) & {"/", "\\", "\0"}:
        raise DataError(
            f"the figure {name!r} cannot be written, as its name contains a path separator or NUL: the data "
            "were edited or damaged"
        )
    with in_style(output):
        figure = drawn_for_use(drawing)
        FigureCanvasAgg(figure)
        # The figure is laid out once. With a layout engine, Figure.savefig would lay it out again for each format.
        layout = figure.get_layout_engine()
        assert layout is not None
        layout.execute(figure)
        figure.set_layout_engine("none")
        # A name may contain dots (rough-1.75), so the suffix is appended, not replaced.
        written = [
            write_whole(directory / f"{name}.{suffix}", partial(_save, figure, drawing, suffix))
            for suffix in output.suffixes
        ]
    written.append(write_text(directory / f"{name}.txt", caption_text(drawing)))
    if (table := drawing.table()) is not None:
        written.append(write_text(directory / f"{name}.csv", table.to_csv(index=False)))
    return written


def _save(figure: Figure, drawing: Drawing, suffix: str, path: Path) -> None:
    """Save a figure with its alternative text in the format ``suffix``."""
    options: Json = {}
    if suffix in ALTERNATIVE:
        texts = {"Title": drawing.name, ALTERNATIVE[suffix]: drawing.alternative}
        options["metadata"] = dict.fromkeys(CHANGING[suffix]) | texts
    try:
        figure.savefig(path, format=suffix, **options)
    except (RuntimeError, LatexError) as error:
        raise UsageError(f"--format pgf measures its texts with {rcParams['pgf.texsystem']}: {error}") from error


def caption(name: str, /, **values: object) -> str:
    """Return the text that the template of ``page/captions.toml`` with this name makes from values."""
    return ENVIRONMENT.from_string(CAPTIONS[name]).render(values)


def caption_text(drawing: Drawing) -> str:
    """Return the text of the file with the caption and the alternative text of a figure."""
    texts = drawing.caption, f"Alternative text: {drawing.alternative}"
    return "\n\n".join(fill(text, 100) for text in texts) + "\n"
