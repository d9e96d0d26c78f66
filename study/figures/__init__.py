"""Figures from the data files; nothing is solved here.

``draw_figures`` draws all of them; each module has one small function per kind of figure.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from study.datafiles import DataError, read_csv, read_rates
from study.figures.body import draw_body
from study.figures.canvas import in_style, save, uncollected
from study.figures.convergence import draw_case, draw_overview
from study.figures.enclosure import draw_enclosure
from study.figures.pictures import Picture, read_pictures
from study.figures.profiles import draw_profiles
from study.figures.zone import draw_zone

__all__ = ["DataError", "draw_figures", "draw_one"]

Progress = Callable[[int, int, str], None]
"""Called after each figure with how many are done, how many there are, and its name."""


Spread = Callable[..., Iterable[list[Path]]]
"""``map``, or the ``map`` of an executor, which draws several figures at a time."""


def draw_figures(
    directory: Path, spread: Spread = map, progress: Progress = lambda done, total, name: None
) -> list[Path]:
    """Draw every figure into ``directory/figures`` as pdf, png and svg; returns the files.

    ``enclosure-CASE`` for every case with one; ``convergence-CASE`` for every case of ``rates.csv``, ``convergence``
    for all cases of Prop. 5.4 and ``convergence-prop-5-3`` for the rough ones; ``zone-CASE``, ``profiles-CASE`` and
    ``body-CASE`` for every file in ``pictures``.

    Raises:
        DataError: a data file is missing or damaged; nothing is drawn then.
    """
    rates = read_rates(directory)
    orders = _expected_orders(directory, rates)
    figures = [*_convergence(rates, orders), *_enclosures(directory), *_runs(read_pictures(directory))]
    names, draws = zip(*figures, strict=True)
    written: list[Path] = []
    for done, paths in enumerate(spread(partial(draw_one, directory / "figures"), names, draws), start=1):
        written += paths
        progress(done, len(names), names[done - 1])
    return written


def draw_one(directory: Path, name: str, draw: Callable[[], Figure]) -> list[Path]:
    """Draw one figure in the style of the study and save it as pdf, png and svg."""
    # The many small objects of a figure all live until it is saved: looking for garbage before finds nothing.
    with in_style(), uncollected():
        return save(draw(), directory, name)


def _expected_orders(directory: Path, rates: pd.DataFrame) -> dict[str, float]:
    """``expected_order`` of every case with a rate."""
    cases = read_csv(directory, "cases.csv", ("case", "expected_order"))
    orders = dict(zip(cases["case"], cases["expected_order"].astype(float), strict=True))
    unknown = sorted(set(rates["case"]) - set(orders))
    if unknown:
        path = directory / "data" / "cases.csv"
        raise DataError(
            f"{path} lacks the cases {', '.join(unknown)}: make it again with `study run --out {directory}`"
        )
    return orders


def _convergence(rates: pd.DataFrame, orders: dict[str, float]) -> Iterator[tuple[str, Callable[[], Figure]]]:
    """One figure per case and one overview per claim; a second time scheme would get its own, by its name."""
    several = rates["scheme"].nunique() > 1
    for scheme, of_scheme in rates.groupby("scheme", sort=False):
        suffix = f"-{scheme}" if several else ""
        for case, of_case in of_scheme.groupby("case", sort=False):
            yield f"convergence-{case}{suffix}", partial(draw_case, of_case, orders[str(case)])
        for claim, of_claim in of_scheme.groupby("claim", sort=False):
            yield _overview_name(str(claim)) + suffix, partial(draw_overview, of_claim, orders)


def _overview_name(claim: str) -> str:
    """convergence for Prop. 5.4, which is what the study is about, convergence-prop-5-3 and the like for others."""
    return (
        "convergence" if claim == "Prop. 5.4" else "convergence-" + re.sub(r"[^a-z0-9]+", "-", claim.lower()).strip("-")
    )


def _enclosures(directory: Path) -> Iterator[tuple[str, Callable[[], Figure]]]:
    """One figure for every case and mesh family with an enclosure, all levels in it."""
    columns = ("trajectory", "case", "family", "level", "time", "error", "distance", "bound")
    series = read_csv(directory, "enclosures.csv", columns)
    chosen = series[series["trajectory"] == "enclosure"]
    for (case, family), mine in chosen.groupby(["case", "family"], sort=False):
        yield f"enclosure-{case}", partial(draw_enclosure, mine, f"{case}, {family}")


def _runs(pictures: list[Picture]) -> Iterator[tuple[str, Callable[[], Figure]]]:
    for picture in pictures:
        yield f"zone-{picture.case}", partial(draw_zone, picture)
        yield f"profiles-{picture.case}", partial(draw_profiles, picture)
        yield f"body-{picture.case}", partial(draw_body, picture)
