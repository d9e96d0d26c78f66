"""All figures of a run: the table of figures, and the figures that the data of a result directory allow."""

import re
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from pandas import DataFrame

from study.ledger.codes import Codes
from study.ledger.datafiles import expected_orders, read_csv, read_rates
from study.ledger.files import Json, UsageError
from study.present.body import (
    draw_body,
    draw_fronts,
    draw_profiles,
    draw_sketch,
    draw_zone,
    values_of_body,
    values_of_fronts,
    values_of_profiles,
    values_of_zone,
)
from study.present.charts import (
    draw_adapted,
    draw_codes,
    draw_collapsed,
    draw_convergence,
    draw_enclosure,
    draw_faults,
    draw_orders,
    draw_overview,
    draw_rollers,
    draw_work,
    enclosed_series,
    roller_rows,
    values_of_adapted,
    values_of_codes,
    values_of_collapsed,
    values_of_convergence,
    values_of_enclosure,
    values_of_faults,
    values_of_orders,
    values_of_overview,
    values_of_rollers,
    values_of_work,
    work_rows,
)
from study.present.drawing import SHEET, Drawing, caption
from study.present.outcome import order_differences
from study.present.picture import Picture, read_pictures

FIGURES: dict[str, tuple[Callable[..., Figure], Callable[..., Json], str]] = {
    "problem": (draw_sketch, dict, "Sketch of a body on a rigid foundation"),
    "convergence": (
        draw_convergence,
        values_of_convergence,
        "errors against the mesh size, both logarithmic",
    ),
    "overview": (
        draw_overview,
        values_of_overview,
        "error of every case against the mesh size, both logarithmic",
    ),
    "orders": (
        draw_orders,
        values_of_orders,
        "observed order of convergence over the last two refinements against the predicted order, a point for each "
        "case and mesh family",
    ),
    "collapsed": (
        draw_collapsed,
        values_of_collapsed,
        "errors of all cases over their constants against the mesh size",
    ),
    "enclosure": (
        draw_enclosure,
        values_of_enclosure,
        "error over time between its bounds, logarithmic",
    ),
    "adaptive": (
        draw_adapted,
        values_of_adapted,
        "An adapted mesh, and the bound of the error over the unknowns",
    ),
    "contact-work": (
        draw_work,
        values_of_work,
        "work of contact, error and excess against the mesh size, all logarithmic",
    ),
    "rollers": (
        draw_rollers,
        values_of_rollers,
        "excess of contact over the linear problem against the mesh size, both logarithmic",
    ),
    "codes": (
        draw_codes,
        values_of_codes,
        "order in V and distance from the right solution against the error of the pressure, for all contact codes",
    ),
    "faults": (draw_faults, values_of_faults, "The matrix of deliberate faults"),
    "body": (draw_body, values_of_body, "The deformed body on its foundation, with stresses and contact"),
    "zone": (draw_zone, values_of_zone, "The contact zone in space and time, exact and computed"),
    "fronts": (draw_fronts, values_of_fronts, "Maps of the contact zone, exact and computed"),
    "profiles": (draw_profiles, values_of_profiles, "Gap and pressure along the contact boundary"),
}
"""Kind of figure ↦ the function that draws it, the function that returns the values in its caption, and what it shows.

Both functions have the same parameters. The kind is also the name of the template of the caption.
"""


def figure(kind: str, *data: Any, name: str = "", case: str = "", sheet: bool = False) -> Drawing:
    """Return a figure without drawing it.

    Parameters:
        kind: the kind of the figure, a key of ``FIGURES``.
        data: the arguments of the functions that draw the figure and return the values in its caption.
        name: the name of the files of the figure; by default the kind.
        case: the case or the problem that the figure shows; empty for figures over several cases.
        sheet: whether the figure has more axes than can be read on a slide.
    """
    draw, values, summary = FIGURES[kind]
    text = caption(kind, **values(*data))
    title = ": ".join(filter(None, (summary, case)))
    return Drawing(name or kind, partial(draw, *data), text, title, case, sheet, partial(_table, data))


def _table(data: Sequence[Any]) -> DataFrame | None:
    """Return the data of a figure as a table; None for a sketch."""
    for shown in data:
        if isinstance(shown, DataFrame):
            return shown
        if isinstance(shown, Codes):
            return shown.errors
        if isinstance(shown, Picture):
            return shown.on_faces
    return None


def drawings(directory: Path) -> list[Drawing]:
    """Return all figures of a result directory without drawing them: figures over all cases, and of each case.

    The figures over all cases are those of ``overview``. The figures of a case are

    * ``convergence-CASE``, if the case is in ``rates.csv``;
    * ``enclosure-CASE``, if its error has two-sided bounds;
    * if it has a file in ``pictures``: in 2D ``body-CASE``, ``zone-CASE`` and ``profiles-CASE``, in 3D ``body-CASE``
      and ``fronts-CASE``.

    Raises:
        DataError: a data file is missing or damaged.
    """
    figures = overview(directory)
    rates = read_rates(directory)
    orders = expected_orders(directory, rates)
    for case, rows in rates.groupby("case", sort=False):
        figures.append(figure("convergence", rows, orders[case], name=f"convergence-{case}", case=case))
    enclosures = read_csv(directory, "enclosures.csv", ("error", "distance", "bound"))
    for case, rows, title in enclosed_series(enclosures):
        figures.append(figure("enclosure", rows, title, name=f"enclosure-{case}", case=case))
    for picture in read_pictures(directory):
        # Contact faces are lines in 2D and surfaces in 3D.
        for kind in ("body", "zone", "profiles") if picture.segments else ("body", "fronts"):
            figures.append(figure(kind, picture, name=f"{kind}-{picture.case}", case=picture.case))
    return figures


def drawings_of(
    directory: Path, cases: Sequence[str] = (), names: Sequence[str] = (), slides: bool = False
) -> list[Drawing]:
    """Return the figures of some cases, with some names, or all figures, without drawing them.

    Parameters:
        directory: a result directory.
        cases: names of cases, whose figures are returned; empty for all figures.
        names: names of figures; if cases are given, too, only figures of these cases with these names are returned.
        slides: whether only figures that can be read on a slide are returned.

    Raises:
        UsageError: there is no figure of a case, or none with a name.
        DataError: a data file is missing or damaged.
    """
    # A figure with axes for each of many cases cannot be read on a slide.
    figures = [drawing for drawing in drawings(directory) if not (slides and drawing.sheet)]
    for option, kind, of, wanted in (("--case", "case", "case", cases), ("--only", "figure", "name", names)):
        known = dict.fromkeys(getattr(drawing, of) for drawing in figures if getattr(drawing, of))
        if unknown := [name for name in wanted if name not in known]:
            raise UsageError(f"{option} {unknown[0]}: {directory} has no such {kind}, only {', '.join(known)}")
        figures = [drawing for drawing in figures if not wanted or getattr(drawing, of) in wanted]
    return figures


def overview(directory: Path) -> list[Drawing]:
    """Return the figures over all cases of a result directory without drawing them.

    The figures are ``problem``, a sketch; ``collapsed``, ``orders`` and ``convergence`` for the cases of Prop. 5.4 and
    ``convergence-prop-5-3`` for the cases of Prop. 5.3; ``contact-work`` and ``rollers`` if they were measured;
    ``codes`` from ``codes/``, if it exists.

    Raises:
        DataError: a data file is missing or damaged.
    """
    figures = []
    rates = read_rates(directory)
    orders = expected_orders(directory, rates)
    # The largest figure comes first, because it takes longest to draw and would otherwise delay the end.
    for claim, rows in sorted(rates.groupby("claim"), key=lambda group: -len(group[1])):
        name = re.sub(r"[^a-z0-9]+", "-", f"convergence {claim}".lower()).strip("-").removesuffix("-prop-5-4")
        figures.append(figure("overview", rows, orders, name=name, sheet=rows.case.nunique() > SHEET))
    smooth = rates[rates.claim == "Prop. 5.4"]
    if len(smooth):
        figures.append(figure("collapsed", smooth))
    if len(order_differences(rates, orders)):
        figures.append(figure("orders", rates, orders))
    data = directory / "data"
    tables: dict[str, DataFrame] = {}
    # Runs of a user's own cases have no statements.csv.
    if (data / "statements.csv").is_file():
        statements = read_csv(directory, "statements.csv", ("h", "value"))
        tables |= {"contact-work": work_rows(statements), "rollers": roller_rows(statements)}
    if (data / "faults.csv").is_file():
        tables["faults"] = read_csv(directory, "faults.csv")
    figures += [figure(kind, table, sheet=kind == "faults") for kind, table in tables.items() if len(table)]
    if codes := Codes.read(directory):
        figures.append(figure("codes", codes))
    return [*figures, figure("problem")]
