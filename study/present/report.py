"""The report page: one HTML file with ledger, tables, charts and animated cases, made from the data files of a run."""

from base64 import b64encode
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from manufactured import colours
from study.ledger.datafiles import DataError, by_claim, count_verdicts, made_by, read_claims, read_csv, read_rates
from study.ledger.files import write_text
from study.ledger.pictures import Packed, short
from study.ledger.text import significant
from study.present.body import ARROW, THICKNESS, BodyScale, shade
from study.present.charts import Chart, Subplot, collapsed_chart, convergence_chart, enclosure_charts, finest_orders
from study.present.notation import read_page, typeset, typeset_svg
from study.present.outcome import conclusion, orders_text
from study.present.palette import RAMPS, family_styles
from study.present.picture import Array, FaceHistory, Picture, Polygon, Segment, picture_path, read_record
from study.present.tables import BOUNDS, EQUIVALENCE, FAULTS, LEDGER, RATES, STRESSES, Table, columns

CHECKS = ["case", "quantity", "expected", "observed", "low", "high", "verdict"]
HIGHEST_ORDER, STRIP = 1.5, 150
"""The largest order on the strip that shows the orders of a case, and the width of the strip in SVG units."""
SHOWN = 127
"""Displacements on the page are rounded to their largest value / 127, about a third of a pixel."""

TEXTS = read_page("texts")
"""Texts of the page: ``meanings``, verdict ↦ its meaning, and ``letters``, table or place ↦ symbol ↦ its meaning."""
PAGES = Environment(
    loader=PackageLoader("study.present", "page"), autoescape=True, undefined=StrictUndefined, trim_blocks=True
)
PAGES.policies["json.dumps_kwargs"] = {"separators": (",", ":"), "sort_keys": True}
PAGES.filters |= {"typeset": typeset, "typeset_svg": typeset_svg, "number": significant}


def write_report(directory: Path, provenance: dict[str, Any]) -> Path:
    """Write the report page ``directory/report.html`` from the files in ``directory/data``, and return its path.

    Parameters:
        directory: the directory of a run.
        provenance: the content of ``data/provenance.json``, which the command has read and checked.

    Raises:
        StoreError: the directory cannot be written.
        DataError: a data file is missing, damaged or written by an older version; then nothing is written.
    """
    claims, rates = read_claims(directory), read_rates(directory)
    smooth = rates[rates["claim"] == "Prop. 5.4"]
    judges = {label: list(statement["code"]) for label, statement in provenance.get("statements", {}).items()}
    # A statement with the code files that judge it and its checks. A label with two statements gives two groups.
    groups: list[dict[str, Any]] = [
        {"label": label, "says": says, "counts": count_verdicts(rows), "judges": judges.get(label, [])}
        | {"rows": rows[CHECKS].to_numpy().tolist()}
        for label, says, rows in by_claim(LEDGER.table(directory).cells)
    ]
    cases = case_pages(directory, claims, rates)
    page = PAGES.get_template("page.html").render(
        ramps=RAMPS,
        **TEXTS,
        counts=count_verdicts(claims),
        conclusion=conclusion(count_verdicts(claims), orders_text(directory)),
        # The page opens with the 2D case that has the most contact faces.
        shown=max(cases, key=lambda case: (len(case["film"]["view"]) == 2) * len(case["film"]["faces"])),
        collapsed=svg_chart(collapsed_chart(smooth)) if len(smooth) else "",
        rows=len(claims),
        groups=groups,
        labels=list(dict.fromkeys(group["label"] for group in groups)),
        # A row is about a case, or about a place in the paper.
        places=list(dict.fromkeys(row[0] for group in groups for row in group["rows"] if row[0])),
        cases=cases,
        names={case["name"] for case in cases},
        families=family_styles(rates["family"]),
        bounds=BOUNDS.table(directory),
        faults=FAULTS.table(directory) if FAULTS.is_measured(directory) else None,
        provenance=provenance,
        files=_files(directory),
    )
    return write_text(directory / "report.html", page + "\n")


def _files(directory: Path) -> Table:
    """Return the table of the data files from which the page is made, with their sizes and SHA-256 checksums."""
    data = directory / "data"
    paths = sorted([*data.glob("*.csv"), *data.glob("*.json"), *data.glob("pictures/*.json.gz")])
    contents = {path.relative_to(data).as_posix(): path.read_bytes() for path in paths}
    rows = [
        {"file": name, "size": significant(len(content) / 1000), "sha": sha256(content).hexdigest()}
        for name, content in contents.items()
    ]
    return Table("files", columns("files"), pd.DataFrame(rows))


def case_pages(directory: Path, claims: pd.DataFrame, rates: pd.DataFrame) -> list[dict[str, Any]]:
    """Return the texts, charts and tables of each case on the report page, in the order of ``cases.csv``.

    The entries of a case are

    * ``name``; ``facts``, the properties of the case; ``counts``, the number of checks with each verdict;
    * ``observed``: the smallest and the largest observed order as text;
    * ``strip``: a small picture that compares orders on a horizontal axis: the position of the predicted order, and for
      each mesh family the position of the observed order with a colour;
    * ``charts`` as HTML; ``film``, the data of the animation, from ``read_film``; ``tables`` with their captions.

    Parameters:
        directory: the directory of a run.
        claims, rates: the contents of ``claims.csv`` and ``rates.csv``.

    Raises:
        DataError: a data file is missing or damaged.
    """
    enclosures = read_csv(directory, "enclosures.csv")
    tables = [
        (RATES.table(directory), "Errors on every mesh", ["case", "claim"]),
        (STRESSES.table(directory), "The stress problem on its own space", ["case"]),
        (EQUIVALENCE.table(directory), "The stress problem on the strains of V^h", ["case"]),
        (BOUNDS.table(directory), "Bounds of the error", ["case"]),
    ]
    pages = []
    cases = read_csv(directory, "cases.csv")
    # No order is proved for some cases, which the template writes as an empty text.
    for fact in cases.replace({"proved_order": {np.nan: None}}).to_dict("records"):
        name, expected = fact["case"], float(fact["expected_order"])
        verdicts, errors, bounds = (frame[frame["case"] == name] for frame in (claims, rates, enclosures))
        found, styles = finest_orders(errors, refinements=2), family_styles(errors["family"])
        orders = sorted(found.values())
        charts = [convergence_chart(errors, expected)] if len(errors) else []
        charts += [chart for _, chart in enclosure_charts(bounds)]
        mine = [(caption, table.of_case(name, without)) for table, caption, without in tables]
        page = {
            "name": name,
            "facts": fact,
            "counts": count_verdicts(verdicts),
            "observed": " – ".join(dict.fromkeys(f"{order:.3f}" for order in orders[:1] + orders[-1:])),
            "strip": (_strip(expected), [(_strip(order), styles[family].colour) for family, order in found.items()]),
            "charts": list(map(svg_chart, charts)),
            "film": read_film(directory, name),
            "tables": [(caption, table) for caption, table in mine if table.rows],
        }
        pages.append(page)
    return pages


def _strip(order: float) -> float:
    return round(STRIP * min(max(order / HIGHEST_ORDER, 0.0), 1.0), 1)


def read_film(directory: Path, case: str) -> dict[str, Any]:
    """Return the data of the animation of a case, in the form that the script of the page reads.

    Entries that their names do not explain:

    * ``displacement``: displacements as multiples of ``unit``, in 8 bits and base64; for each time all x components,
      then all y components, then all z components;
    * ``shades``: for each time and cell 255 (τ/brightest)^½ with the von Mises stress τ, in 8 bits and base64;
    * ``magnification``: the factor of displacements;
    * ``size``: the longest side of the body; ``arrow`` and ``foundation`` are the lengths of the longest arrow and the
      thickness of the foundation as fractions of it;
    * ``room``: the limits of the drawing;
    * ``highest``, ``widest``: the largest pressure and the largest gap;
    * ``view``: the rows of the projection, two in 2D and three in 3D.

    Raises:
        DataError: the file of the case is missing or damaged, or an older version wrote it without displacements over
            time.
    """
    path = picture_path(directory, case)
    if not path.is_file():
        raise DataError(f"{path} is missing: make it with `{made_by(directory)}`")
    try:
        picture = Picture(read_record(path)).at_all_times()
    except (KeyError, TypeError, ValueError) as error:
        raise DataError(
            f"{path} holds no displacement and von_mises over time ({error!r}), which the report shows: if an older "
            "version wrote it, make it anew with the same `study run`"
        ) from error
    scale, displacement = BodyScale(picture), Packed.of(picture.displacement, SHOWN)
    shades = np.round(255 * shade(picture.von_mises / scale.stress)).astype(np.uint8)
    return {
        "times": picture.times.tolist(),
        "vertices": picture.vertices.tolist(),
        "cells": picture.cells.T.ravel().tolist(),
        "unit": displacement.unit,
        "displacement": b64encode(displacement.multiples.astype(np.int8).tobytes()).decode("ascii"),
        "shades": b64encode(shades.tobytes()).decode("ascii"),
        "brightest": scale.stress,
        "magnification": scale.magnification,
        "size": scale.size,
        "room": scale.limits.tolist(),
        "highest": scale.pressure,
        "widest": scale.gap,
        "arrow": ARROW,
        "foundation": THICKNESS,
        "view": scale.view.tolist(),
        "faces": list(map(_face, picture.faces)),
    }


def _face(face: FaceHistory) -> dict[str, Any]:
    """Return the data of a contact face in the form that the script of the page reads."""
    record = {name: short(getattr(face, name)) for name in ("s", "x", "gap", "pressure")}
    record |= {"face": face.number, "normal": face.normal.tolist(), "touches": face.contact_threshold}
    if isinstance(face, Segment):
        line = {"s": short(face.line), "gap": short(face.line_gap), "pressure": short(face.line_pressure)}
        return record | {"zone": {"times": face.zone_times.tolist(), "intervals": face.zone}, "line": line}
    assert isinstance(face, Polygon)
    record |= {name: short(getattr(face, name)) for name in ("gap_exact", "pressure_exact", "level")}
    record |= {"nodes": face.nodes.tolist(), "cells": face.facets.cells.tolist()}
    # The corners of each facet, edge or quarter, one after the other.
    parts = {"facets": face.facets.corners, "edges": face.facets.edges, "quarters": face.facets.quarters}
    return record | {name: corners.T.ravel().tolist() for name, corners in parts.items()}


# Charts as SVG, which is much smaller than SVG from Matplotlib: the page has about 50 charts in 6 MB.

LEFT, RIGHT, TOP, HEIGHTS, BETWEEN, BELOW = 58, 350, 10, (222, 120), 14, 38
"""In SVG units: the left, right and upper end of the subplots, their heights, and the space between and below them."""


def svg_chart(chart: Chart) -> Markup:
    """Return a chart as an HTML figure that contains an SVG image, the legend and the caption (``page/chart.html``)."""
    panels, top = [], TOP
    for subplot, height in zip(chart.subplots, HEIGHTS, strict=False):
        panels.append(_svg_shapes(subplot, top, top + height))
        top += height + BETWEEN
    template, ends = PAGES.get_template("chart.html"), {"left": LEFT, "right": RIGHT, "below": BELOW}
    return Markup(template.render(chart=chart, panels=panels, colours=colours, **ends) + "\n")


def _svg_shapes(subplot: Subplot, top: float, bottom: float) -> dict[str, Any]:
    """Return the ticks, lines, bands, triangle and curves of a subplot in SVG units, with the parameters.

    Parameters:
        subplot: the subplot.
        top, bottom: the vertical ends of the axes in SVG units.
    """

    def x_at(value: float) -> float:
        return round(LEFT + float(np.clip(subplot.x.position(value), -2, 3)) * (RIGHT - LEFT), 2)

    def y_at(value: float) -> float:
        return round(bottom + float(np.clip(subplot.y.position(value), -2, 3)) * (top - bottom), 2)

    def points(x: Array, y: Array) -> list[tuple[float, float]]:
        return [(x_at(a), y_at(b)) for a, b in zip(x, y, strict=True) if np.isfinite(b)]

    def path(places: list[tuple[float, float]]) -> str:
        return "M" + "L".join(f"{x:g},{y:g}" for x, y in places)

    curves = [(points(curve.x, curve.y), curve.style) for curve in subplot.curves]
    bands = [([*points(b.x, b.high), *reversed(points(b.x, b.low))], b.colour) for b in subplot.bands]
    return {
        "subplot": subplot,
        "top": top,
        "bottom": bottom,
        "x_ticks": [(x_at(value), label) for value, label in subplot.x.ticks()],
        "y_ticks": [(y_at(value), label) for value, label in subplot.y.ticks()],
        "rules": list(map(y_at, subplot.rules)),
        "bands": [(path(outline), colour) for outline, colour in bands],
        "triangle": points(*subplot.triangle.corners.T) if subplot.triangle else [],
        "curves": [(path(places), places, style) for places, style in curves],
    }
