"""Figures from the data files; nothing is solved here.

``drawings`` lists all of them, ``overview`` those over all cases; each module has one function that draws a kind of
figure from its data alone, and one that says in a caption what to see in it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from pathlib import Path

import pandas as pd

from study.ledger.datafiles import DataError, read_csv, read_rates
from study.present.figures.body import caption_body, draw_body
from study.present.figures.canvas import Drawing, in_style, save, save_caption, uncollected
from study.present.figures.convergence import caption_case, caption_overview, draw_case, draw_overview
from study.present.figures.defects import caption_defects, draw_defects
from study.present.figures.effectivity import caption_effectivity, draw_effectivity
from study.present.figures.enclosure import caption_enclosure, draw_enclosure
from study.present.figures.energy import caption_energy, draw_energy
from study.present.figures.growth import caption_growth, draw_growth, read_growth
from study.present.figures.maps import caption_fronts, caption_maps, draw_fronts, draw_maps
from study.present.figures.pictures import Picture, read_pictures
from study.present.figures.profiles import caption_profiles, draw_profiles
from study.present.figures.zone import caption_zone, draw_zone

__all__ = ["DataError", "Drawing", "draw_figures", "draw_one", "drawings", "enclosure", "overview"]

Progress = Callable[[int, int, str], None]
"""Called after each figure with how many are done, how many there are, and its name."""


Spread = Callable[..., Iterable[list[Path]]]
"""``map``, or the ``map`` of an executor, which draws several figures at a time."""


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
    """Draw one figure in the style of the study and save it as pdf, png and svg, with its caption."""
    # The many small objects of a figure all live until it is saved: looking for garbage before finds nothing.
    with in_style(), uncollected():
        return [*save(drawing.draw(), directory, drawing.name), save_caption(drawing, directory)]


def drawings(directory: Path) -> list[Drawing]:
    """Every figure of the data in a directory, not drawn yet.

    Those of ``overview``; ``convergence-CASE`` for every case of ``rates.csv``; ``enclosure-CASE`` for every case with
    one; ``zone-CASE``, ``profiles-CASE``, ``body-CASE`` and ``energy-CASE`` for every file in ``pictures``; the contact
    faces of solids are maps.

    Raises:
        DataError: a data file is missing or damaged.
    """
    rates = read_rates(directory)
    return [
        *overview(directory),
        *_convergence(rates, _expected_orders(directory, rates)),
        *_enclosures(directory),
        *_runs(read_pictures(directory)),
    ]


def overview(directory: Path) -> list[Drawing]:
    """The figures over all cases.

    ``convergence`` for those of Prop. 5.4 and ``convergence-prop-5-3`` for the rough ones; ``effectivity`` of
    ``bounds.csv``; ``defects`` of ``controls.csv`` and ``growth`` of ``benchmarks/growth.csv`` where they were
    measured.

    Raises:
        DataError: a data file is missing or damaged.
    """
    rates = read_rates(directory)
    return [
        *_convergences(rates, _expected_orders(directory, rates)),
        *_effectivity(directory),
        *_defects(directory),
        *_growth(directory),
    ]


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


def _schemes(rates: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    """The rows of each time scheme, with what names of figures end with where there are several."""
    several = rates["scheme"].nunique() > 1
    for scheme, mine in rates.groupby("scheme", sort=False):
        yield f"-{scheme}" if several else "", mine


def _convergence(rates: pd.DataFrame, orders: dict[str, float]) -> Iterator[Drawing]:
    """One figure per case."""
    for suffix, of_scheme in _schemes(rates):
        for case, mine in of_scheme.groupby("case", sort=False):
            order = orders[str(case)]
            yield Drawing(
                f"convergence-{case}{suffix}", partial(draw_case, mine, order), partial(caption_case, mine, order)
            )


def _convergences(rates: pd.DataFrame, orders: dict[str, float]) -> Iterator[Drawing]:
    """One figure per claim."""
    for suffix, of_scheme in _schemes(rates):
        for claim, mine in of_scheme.groupby("claim", sort=False):
            yield Drawing(
                _overview_name(str(claim)) + suffix,
                partial(draw_overview, mine, orders),
                partial(caption_overview, mine, orders),
            )


def _overview_name(claim: str) -> str:
    """convergence for Prop. 5.4, which is what the study is about, convergence-prop-5-3 and the like for others."""
    return (
        "convergence" if claim == "Prop. 5.4" else "convergence-" + re.sub(r"[^a-z0-9]+", "-", claim.lower()).strip("-")
    )


def _effectivity(directory: Path) -> Iterator[Drawing]:
    bounds = read_csv(directory, "bounds.csv", ("case", "scheme", "trajectory", "level", "upper", "lower"))
    if bounds["upper"].notna().any():
        yield Drawing("effectivity", partial(draw_effectivity, bounds), partial(caption_effectivity, bounds))


def _enclosures(directory: Path) -> Iterator[Drawing]:
    """For every case and mesh family with an enclosure one figure with all its levels."""
    columns = ("trajectory", "case", "family", "level", "time", "error", "distance", "bound")
    series = read_csv(directory, "enclosures.csv", columns)
    chosen = series[series["trajectory"] == "enclosure"]
    for (case, family), mine in chosen.groupby(["case", "family"], sort=False):
        yield enclosure(f"enclosure-{case}", mine, f"{case}, {family}")


def enclosure(name: str, series: pd.DataFrame, title: str) -> Drawing:
    """The enclosure of an error over time, ``draw_enclosure``."""
    return Drawing(name, partial(draw_enclosure, series, title), partial(caption_enclosure, series, title))


def _defects(directory: Path) -> Iterator[Drawing]:
    """The defects, where `study controls` has measured them."""
    if (directory / "data" / "controls.csv").is_file():
        controls = read_csv(directory, "controls.csv", ("defect", "what", "label", "quantity", "verdict", "caught"))
        yield Drawing("defects", partial(draw_defects, controls), partial(caption_defects, controls))


def _growth(directory: Path) -> Iterator[Drawing]:
    growth = read_growth(directory)
    if growth is not None:
        yield Drawing("growth", partial(draw_growth, growth), partial(caption_growth, growth))


def _runs(pictures: list[Picture]) -> Iterator[Drawing]:
    """The figures of every picture; contact faces are lines in the plane and maps in space."""
    everywhere = {"body": (draw_body, caption_body), "energy": (draw_energy, caption_energy)}
    plane = {"zone": (draw_zone, caption_zone), "profiles": (draw_profiles, caption_profiles)}
    space = {"zone": (draw_fronts, caption_fronts), "profiles": (draw_maps, caption_maps)}
    for picture in pictures:
        for kind, (draw, caption) in (everywhere | (plane if picture.segments else space)).items():
            yield Drawing(f"{kind}-{picture.case}", partial(draw, picture), partial(caption, picture))
