"""Which figures the data in a directory give."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from study.ledger.codes import Codes
from study.ledger.datafiles import DataError, made_by, read_csv, read_rates
from study.present.charts.chart import Chart
from study.present.charts.codes_chart import codes_chart
from study.present.charts.collapsed_chart import collapsed_chart
from study.present.charts.convergence_chart import convergence_chart, overview_chart
from study.present.charts.enclosure_chart import enclosure_chart, enclosure_charts
from study.present.charts.rollers_chart import rollers_chart
from study.present.charts.work_chart import work_chart
from study.present.figures.contact_lines import caption_zone, draw_zone
from study.present.figures.contact_maps import caption_fronts, caption_maps, draw_fronts, draw_maps
from study.present.figures.deformed_body import caption_body, draw_body
from study.present.figures.dot_plots import caption_effectivity, draw_effectivity
from study.present.figures.draw_chart import draw_chart, draw_grid
from study.present.figures.drawing import Drawing
from study.present.figures.energy import caption_energy, draw_energy
from study.present.figures.growth import caption_growth, draw_growth, read_growth
from study.present.figures.profiles import caption_profiles, draw_profiles
from study.present.figures.sketch import CAPTION, draw_sketch
from study.present.picture.picture import Picture, read_pictures


def drawings(directory: Path) -> list[Drawing]:
    """Every figure of the data in a directory, not drawn yet: those of ``overview``, and those of each case.

    ``convergence-CASE`` for every case of ``rates.csv``, ``enclosure-CASE`` where there is one, and ``zone-CASE``,
    ``profiles-CASE``, ``body-CASE`` and ``energy-CASE`` for every file in ``pictures``.

    Raises:
        DataError: a data file is missing or damaged.
    """
    found, rates = overview(directory), read_rates(directory)
    orders = _expected_orders(directory, rates)
    for suffix, of_scheme in _schemes(rates):
        for case, mine in of_scheme.groupby("case", sort=False):
            found.append(_chart(f"convergence-{case}{suffix}", convergence_chart(mine, orders[str(case)])))
    columns = ("trajectory", "case", "family", "level", "time", "error", "distance", "bound")
    for name, chart in enclosure_charts(read_csv(directory, "enclosures.csv", columns)):
        found.append(_chart(f"enclosure-{name}", chart))
    return found + [drawing for picture in read_pictures(directory) for drawing in _of_picture(picture)]


def overview(directory: Path) -> list[Drawing]:
    """The figures over all cases; DataError as in ``drawings``.

    ``problem``, a sketch; ``collapsed`` and ``convergence`` for those of Prop. 5.4 and ``convergence-prop-5-3`` for the
    rough ones; ``contact-work`` and ``rollers`` where they were measured; ``effectivity`` of ``bounds.csv``;
    ``growth`` of ``benchmarks/growth.csv`` and ``codes`` of ``codes/`` where they are.
    """
    found, rates = [], read_rates(directory)
    orders = _expected_orders(directory, rates)
    for suffix, of_scheme in _schemes(rates):
        # The largest first: it takes longest to draw, and nothing should wait for it alone.
        for claim, mine in sorted(of_scheme.groupby("claim"), key=lambda group: -len(group[1])):
            name = "" if claim == "Prop. 5.4" else "-" + re.sub(r"[^a-z0-9]+", "-", str(claim).lower()).strip("-")
            found.append(_chart(f"convergence{name}{suffix}", overview_chart(mine, orders), draw_grid))
        smooth = of_scheme[of_scheme["claim"] == "Prop. 5.4"]
        if len(smooth):
            found.append(_chart(f"collapsed{suffix}", collapsed_chart(smooth)))
    found += _of_statements(directory)
    bounds = read_csv(directory, "bounds.csv", ("case", "scheme", "trajectory", "level", "upper", "lower"))
    known = bounds[bounds["upper"].notna()]
    if len(known):
        found.append(Drawing("effectivity", partial(draw_effectivity, known), caption_effectivity(known)))
    growth = read_growth(directory)
    if growth is not None:
        found.append(Drawing("growth", partial(draw_growth, growth), caption_growth(growth)))
    codes = Codes.read(directory)
    if codes is not None:
        found.append(_chart("codes", codes_chart(codes)))
    return [*found, Drawing("problem", draw_sketch, CAPTION)]


def enclosure(name: str, series: pd.DataFrame, title: str) -> Drawing:
    """The enclosure of an error over time, ``enclosure_chart``."""
    return _chart(name, enclosure_chart(series, title))


def _of_statements(directory: Path) -> Iterator[Drawing]:
    """``work_chart`` and ``rollers_chart`` of a run; runs of own cases have no file of statements."""
    if not (directory / "data" / "statements.csv").is_file():
        return
    statements = read_csv(directory, "statements.csv", ("label", "case", "family", "level", "h", "quantity", "value"))
    if (work := work_chart(statements)) is not None:
        yield _chart("contact-work", work, draw_grid)
    if (rollers := rollers_chart(statements)) is not None:
        yield _chart("rollers", rollers)


def _chart(name: str, chart: Chart, draw: Callable[[Chart], Figure] = draw_chart) -> Drawing:
    return Drawing(name, partial(draw, chart), chart.caption)


def _expected_orders(directory: Path, rates: pd.DataFrame) -> dict[str, float]:
    """``expected_order`` of every case with a rate."""
    cases = read_csv(directory, "cases.csv", ("case", "expected_order"))
    orders = dict(zip(cases["case"], cases["expected_order"].astype(float), strict=True))
    if unknown := sorted(set(rates["case"]) - set(orders)):
        lacking = f"{directory / 'data' / 'cases.csv'} lacks the cases {', '.join(unknown)}"
        raise DataError(f"{lacking}: make it again with `{made_by(directory)}`")
    return orders


def _schemes(rates: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    """The rows of each time scheme, with what names of figures end with where there are several."""
    several = rates["scheme"].nunique() > 1
    for scheme, mine in rates.groupby("scheme", sort=False):
        yield f"-{scheme}" if several else "", mine


def _of_picture(picture: Picture) -> Iterator[Drawing]:
    """The figures of a picture; contact faces are lines in the plane and maps in space."""
    plane = {"zone": (draw_zone, caption_zone), "profiles": (draw_profiles, caption_profiles)}
    space = {"zone": (draw_fronts, caption_fronts), "profiles": (draw_maps, caption_maps)}
    everywhere = {"body": (draw_body, caption_body), "energy": (draw_energy, caption_energy)}
    for kind, (draw, caption) in (everywhere | (plane if picture.segments else space)).items():
        yield Drawing(f"{kind}-{picture.case}", partial(draw, picture), caption(picture))
