"""Relations between the columns of what other people's codes did that hold whatever they did."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pandas as pd

from study.ledger.codes import FOLDER, MARCHES, MESH, NOT_EXPRESSED, Codes
from study.ledger.datafiles import since_before
from study.run.relations import Breach, breaches

SHOWN = 2e-3
"""Relative room for what the three digits leave open that most columns have."""
STEEP = 0.02
"""What this leaves open of an order between two meshes with h and h/2."""


def same_best(codes: Codes, folder: str) -> Iterator[Breach]:
    """The error of the solution in K^h and that of its pressure belong to the mesh: all codes have the same."""
    errors = codes.errors
    for column in ("h", "best", "best_pressure"):
        first = errors.groupby(MESH)[column].transform("median")
        kept = abs(errors[column] - first) <= 2 * SHOWN * first
        wanted = first.map("{:.4g}, as in the rows of most other codes".format)
        yield from breaches(f"{folder}/errors.csv", errors, column, kept, wanted)


def triangle(codes: Codes, folder: str) -> Iterator[Breach]:
    """‖u − u^h‖_V and the same of the solution in K^h differ by no more than the distance of both."""
    errors = codes.errors
    room = SHOWN * (errors["best"] + errors["distance"])
    kept = abs(errors["error"] - errors["best"]) <= errors["distance"] + room
    wanted = errors["best"].map("{:.4g} up to the distance from the solution in K^h".format)
    yield from breaches(f"{folder}/errors.csv", errors, "error", kept, wanted)


ORDERS = {"order_in_v": "error", "order_of_distance": "distance", "order_of_pressure": "pressure"}


def orders(codes: Codes, folder: str) -> Iterator[Breach]:
    """Orders are those of the two finest meshes."""
    found = {number: _finest(mine) for number, mine in codes.errors.sort_values("level").groupby("series", sort=False)}
    classes = codes.classes
    for column, of in ORDERS.items():
        expected = pd.Series([found.get(number, {}).get(of, float("nan")) for number in classes["series"]], dtype=float)
        kept = ~(abs(classes[column] - expected) > STEEP)
        yield from breaches(f"{folder}/classes.csv", classes, column, kept, expected.map("{:.4g}".format))


def _finest(rows: pd.DataFrame) -> dict[str, float]:
    h = rows["h"].to_numpy()[-2:]
    return {of: float(since_before(h, rows[of].to_numpy()[-2:])[-1]) for of in ORDERS.values()}


def every_series(codes: Codes, folder: str) -> Iterator[Breach]:
    """A series has a class, and errors unless it cannot be expressed."""
    there, left_out = codes.classes["series"].isin(codes.errors["series"]), codes.classes["class"] == NOT_EXPRESSED
    wanted = there.map({True: "a class, as there are errors", False: f"{NOT_EXPRESSED}, as there are no errors"})
    yield from breaches(f"{folder}/classes.csv", codes.classes, "class", there != left_out, wanted)
    wanted = pd.Series("a series of classes.csv", codes.errors.index)
    yield from breaches(f"{folder}/errors.csv", codes.errors, "series", codes.errors["code"].notna(), wanted)


CODE_RELATIONS: tuple[Callable[[Codes, str], Iterator[Breach]], ...] = (same_best, triangle, orders, every_series)
FOLDERS = FOLDER, MARCHES
