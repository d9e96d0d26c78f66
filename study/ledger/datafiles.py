"""What presentation needs from the disk: data files read with clear errors."""

from __future__ import annotations

from collections.abc import Collection
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from study.ledger.files import write_text
from study.ledger.orders import RatesError, orders

VERDICTS = ("holds", "reported", "undecided", "fails")
"""From best to worst."""

SERIES = ["claim", "case", "family", "scheme"]
RATES = [*SERIES, "level", "h", "dofs", "steps", "error", "order", "at", "interpolation_error", "discrete_error"]
RATES += ["time_share"]
SEEDS = ["label", "case", "seeds", "alarms", "claimed"]
LEDGER = ["label", "statement", "case", "quantity", "expected", "observed", "low", "high", "verdict"]
TEXT = {
    *SERIES,
    "label",
    "statement",
    "quantity",
    "verdict",
    "form",
    "summary",
    "law",
    "zone",
    "regularity",
    "statements",
    "reason",
    "twin",
    "trajectory",
}
"""Columns that hold words even where they look like numbers or are empty."""


class DataError(ValueError):
    """A data file is missing or is not what ``study run`` writes."""


def read_csv(directory: Path, name: str, columns: Collection[str]) -> pd.DataFrame:
    """The table ``directory/data/name`` with at least the given columns; empty text is "".

    Raises:
        DataError: there is no such file, it is not a table, it ends within a line, or it lacks a column.
    """
    path = directory / "data" / name
    if not path.is_file():
        raise DataError(f"{path} is missing: make it with `study run --out {directory}`")
    try:
        frame = pd.read_csv(path, dtype=dict.fromkeys(TEXT, str))
    except (pd.errors.EmptyDataError, pd.errors.ParserError, UnicodeDecodeError) as error:
        raise DataError(f"{path} is not a table ({error}): make it again with `study run --out {directory}`") from error
    if not path.read_bytes().endswith(b"\n"):
        raise DataError(
            f"{path} is truncated, its last line has no end: make it again with `study run --out {directory}`"
        )
    lacking = [column for column in columns if column not in frame]
    if lacking:
        raise DataError(
            f"{path} lacks the columns {', '.join(lacking)}: make it again with `study run --out {directory}`"
        )
    return frame.fillna(dict.fromkeys([name for name in frame if name in TEXT], ""))


def write_csv(path: Path, table: pd.DataFrame) -> None:
    """Write a data file whole or not at all: 12 digits, Unix line ends."""
    write_text(path, table.to_csv(index=False, float_format="%.12g", lineterminator="\n"))


def read_rates(directory: Path) -> pd.DataFrame:
    """``rates.csv`` with the levels of every series in order and a column ``discrete_order``."""
    rates = read_csv(directory, "rates.csv", RATES)
    series = [frame.sort_values("level") for _, frame in rates.groupby(SERIES, sort=False)]
    rates = pd.concat(series, ignore_index=True) if series else rates
    found = [_orders(frame["h"].to_numpy(), frame["discrete_error"].to_numpy()) for frame in series]
    return rates.assign(discrete_order=np.concatenate(found) if found else [])


def with_order(series: pd.DataFrame, column: str) -> pd.DataFrame:
    """The levels of a series in order with the consecutive orders of a column as ``order``."""
    ordered = series.sort_values("level")
    return ordered.assign(order=_orders(ordered["h"].to_numpy(), ordered[column].to_numpy()))


def caught(controls: pd.DataFrame) -> tuple[int, int]:
    """How many defects in ``controls.csv`` were caught, and how many were injected; a setting has no entry."""
    injected = controls[controls["caught"] != ""]
    return int((injected["caught"] == "yes").sum()), len(injected)


class Alarms(NamedTuple):
    """How many rows are claimed on other random meshes, on how many seeds, verdicts, and how many do not hold."""

    rows: int
    seeds: int
    verdicts: int
    alarms: int


def raised(seeds: pd.DataFrame) -> Alarms:
    """The sums over the claimed rows of ``seeds.csv``."""
    claimed = seeds[seeds["claimed"] == "yes"]
    numbers = claimed["seeds"].max(), claimed["seeds"].sum(), claimed["alarms"].sum()
    return Alarms(len(claimed), *map(int, numbers))


def read_claims(directory: Path) -> pd.DataFrame:
    """``claims.csv``, in which every verdict is one that is known."""
    claims = read_csv(directory, "claims.csv", LEDGER)
    unknown = sorted(set(claims["verdict"]) - set(VERDICTS))
    if unknown:
        raise DataError(f"{directory / 'data' / 'claims.csv'}: verdicts {unknown}, known are {', '.join(VERDICTS)}")
    return claims


def _orders(h: NDArray[np.float64], error: NDArray[np.float64]) -> NDArray[np.float64]:
    """Consecutive orders, NaN for the first level and wherever an error is not positive and so has none."""
    found = np.full(len(h), np.nan)
    for i in range(1, len(h)):
        with suppress(RatesError):
            (found[i],) = orders(h[i - 1 : i + 1], error[i - 1 : i + 1])
    return found
