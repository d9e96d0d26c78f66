"""The data files of a run: columns and keys, reading with errors that name file, line and column, writing."""

from __future__ import annotations

import gzip
import json
import shlex
import zlib
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from study.ledger.chance import promise_verdict
from study.ledger.files import write_text
from study.ledger.orders import RatesError, orders
from study.ledger.verdict import HOLDS, KINDS, VERDICTS, Verdict, kind

SERIES = ["claim", "case", "family", "scheme"]
RATES = [*SERIES, "level", "h", "dofs", "steps", "error", "order", "at", "interpolation_error", "discrete_error"]
RATES += ["time_share", "predicted_interpolation"]
SEEDS = ["label", "key", "case", "since", "seeds", "alarms", "rate_low", "rate_high", "rate_tail", "claimed"]
ALL_ROWS = "all claimed rows"
"""The label of the lines of ``seeds.csv`` about all claimed rows together."""
LEDGER = [field.name for field in fields(Verdict)]
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
    "key",
    "expected",
    "defect",
    "what",
    "setting",
    "caught",
    "claimed",
    "seen_by",
    "levels",
    "noticed_by",
    "rule",
    "part",
    "tail",
    "code",
    "version",
    "variant",
    "class",
}
"""Columns of text, even if a cell looks like a number or is empty."""


COMMANDS = {"controls.csv": "study controls", "seeds.csv": "study seeds"}
"""Commands that write data files which ``study run`` does not write."""


NO_TABLE = pd.errors.EmptyDataError, pd.errors.ParserError, UnicodeDecodeError, gzip.BadGzipFile, EOFError, zlib.error
"""Errors of pandas and gzip for a file that is no table."""


class DataError(ValueError):
    """A data file is missing or is not what ``study run`` writes."""


def read_csv(directory: Path, name: str, columns: Collection[str]) -> pd.DataFrame:
    """Return the table ``directory/data/name`` of a run.

    Raises:
        DataError: as ``read_table``, or a column of numbers has words; the message names file, line and column.
    """
    command, path = COMMANDS.get(name), directory / "data" / name
    again = f"{command} --out {directory}" if command else made_by(directory)
    frame = read_table(path, columns, again)
    numbers = [column for column in columns if column not in TEXT]
    refuse_words(path, frame, numbers, f"make it again with `{again}`", empty=True)
    return frame


def made_by(directory: Path) -> str:
    """Return the command that made a directory, from its provenance; ``study run`` without one."""
    try:
        content = json.loads((directory / "data" / "provenance.json").read_text(encoding="utf-8"))
        plain = "study run --full" if content.get("plan") == "full" else "study run"
        command = str(content.get("scope", {}).get("command", plain))
    except (OSError, ValueError, AttributeError):
        command = "study run"
    return f"{command} --out {shlex.quote(str(directory))}"


def read_table(path: Path, columns: Collection[str], command: str) -> pd.DataFrame:
    """Return the table that a command has written to a path, with at least some columns; empty text is "".

    A path that ends in ``.gz`` is uncompressed first.

    Raises:
        DataError: there is no such file, it is not a table, it ends within a line, or it lacks a column.
    """
    if not path.is_file():
        raise DataError(f"{path} is missing: make it with `{command}`")
    again = f"make it again with `{command}`"
    try:
        # Only empty cells are NaN: no command writes the word "nan".
        kinds = dict.fromkeys(TEXT, str)
        content = path.read_bytes()
        content = gzip.decompress(content) if path.suffix == ".gz" else content
        frame = pd.read_csv(BytesIO(content), dtype=kinds, keep_default_na=False, na_values=[""], low_memory=False)  # type: ignore[arg-type]
    except NO_TABLE as error:
        raise DataError(f"{path} is not a table ({error}): {again}") from error
    if not content.endswith(b"\n"):
        raise DataError(f"{path} is truncated, its last line has no end: {again}")
    if lacking := [column for column in columns if column not in frame]:
        raise DataError(f"{path} lacks the columns {', '.join(lacking)}: {again}")
    return frame.fillna(dict.fromkeys([name for name in frame if name in TEXT], ""))


def line(row: int) -> int:
    """Return the line of a data file that holds a row; rows are counted from 0."""
    return row + 2


def refuse_words(path: Path, table: pd.DataFrame, columns: Collection[str], mend: str, empty: bool = False) -> None:
    """Raise DataError, with line and column, if a column has a cell that is no number; ``empty`` allows empty cells."""
    for column in columns:
        wrong = pd.to_numeric(table[column], errors="coerce").isna().to_numpy()
        if empty:
            wrong = wrong & table[column].notna().to_numpy()
        if wrong.any():
            row = int(wrong.argmax())
            stands = pd.read_csv(path, dtype=str, keep_default_na=False)[column].iloc[row]
            raise DataError(f"{path}, line {line(row)}, column {column}: stands {stands!r}, expected a number; {mend}")


def refuse_repeated(path: Path, table: pd.DataFrame, key: Sequence[str], mend: str) -> None:
    """Raise DataError, with both lines, if two rows have the same key."""
    if (again := table.duplicated([*key]).to_numpy()).any():
        row = int(again.argmax())
        first = int((table[[*key]] == table[[*key]].iloc[row]).all(axis=1).to_numpy().argmax())
        names = ", ".join(f"{name} {table[name].iloc[row]}" for name in key)
        raise DataError(
            f"{path}, line {line(row)}: the row {names} stands in line {line(first)} already, expected once; {mend}"
        )


def write_csv(path: Path, table: pd.DataFrame) -> None:
    """Write a data file whole or not at all: 12 digits, Unix line ends."""
    write_text(path, table_text(table))


def table_text(table: pd.DataFrame) -> str:
    """Return the text of a data file."""
    return str(table.to_csv(index=False, float_format="%.12g", lineterminator="\n"))


Row = Mapping[str, Any]


class DataFile(Protocol):
    """A file or folder of measurements: its name, and the columns that tell its rows apart."""

    @property
    def name(self) -> str: ...
    @property
    def key(self) -> tuple[str, ...]: ...

    def write(self, data: Path, rows: Sequence[Row]) -> list[Path]: ...


@dataclass(frozen=True)
class CsvFile:
    """A table of measurements.

    Attributes:
        name: of the file in ``data``.
        key: the columns that tell its rows apart.
        columns: all measured columns.
        derive: adds columns that are computed from the others.
    """

    name: str
    key: tuple[str, ...]
    columns: tuple[str, ...]
    derive: Callable[[pd.DataFrame], pd.DataFrame] = pd.DataFrame.copy

    def write(self, data: Path, rows: Sequence[Row]) -> list[Path]:
        """Write the whole table; returns its path."""
        write_csv(data / self.name, self.derive(pd.DataFrame(rows, columns=list(self.columns))))
        return [data / self.name]

    def read(self, directory: Path) -> pd.DataFrame:
        """Return the table in ``directory/data``; raises DataError like ``read_csv``."""
        return read_csv(directory, self.name, self.columns)

    def keys(self, table: pd.DataFrame) -> set[tuple[str, ...]]:
        """Return (name of the file, key of the row, …) of all rows, as text."""
        return {(self.name, *row) for row in table[list(self.key)].astype(str).itertuples(index=False, name=None)}


@dataclass(frozen=True)
class JsonFiles:
    """A folder with a file for every measurement, named after the only column of its key."""

    name: str
    key: tuple[str, ...]

    def write(self, data: Path, rows: Sequence[Row]) -> list[Path]:
        """Write a file for each row, without spaces after separators (a tenth of its size); returns the paths."""
        texts = {row[self.key[0]]: json.dumps(row, separators=(",", ":")) + "\n" for row in rows}
        return [write_text(data / self.name / f"{name}.json", text) for name, text in texts.items()]


def read_rates(directory: Path) -> pd.DataFrame:
    """Return ``rates.csv`` with the levels of each series in order and a column ``discrete_order``."""
    rates = read_csv(directory, "rates.csv", RATES)
    path, again = directory / "data" / "rates.csv", f"make it again with `{made_by(directory)}`"
    # Figures cannot show infinite errors.
    finite = rates.replace([np.inf, -np.inf], np.nan)
    refuse_words(path, finite, [column for column in RATES if column not in {*TEXT, "order"}], again)
    refuse_repeated(path, rates, [*SERIES, "level"], again)
    series = [frame.sort_values("level") for _, frame in rates.groupby(SERIES, sort=False)]
    rates = pd.concat(series, ignore_index=True) if series else rates
    return rates.assign(discrete_order=in_series(rates, "discrete_error"))


def with_order(series: pd.DataFrame, column: str) -> pd.DataFrame:
    """Return the levels of a series in order, with the observed orders of a column as ``order``."""
    ordered = series.sort_values("level")
    return ordered.assign(order=since_before(ordered["h"].to_numpy(), ordered[column].to_numpy()))


def count_caught(controls: pd.DataFrame) -> tuple[int, int]:
    """Return how many defects in ``controls.csv`` were caught, and how many were injected."""
    injected = controls[controls["caught"] != ""]
    return int((injected["caught"] == "yes").sum()), len(injected)


class AlarmSummary(NamedTuple):
    """Verdicts of all claimed rows on other random meshes.

    Attributes:
        rows: number of claimed rows.
        seeds, red: number of seeds on which all rows were measured, and of those on which some row did not hold.
        low, high: confidence interval of red/seeds at 95 %.
        by_tail: upper estimate of the rate from the tails of the distributions of all rows.
        light_seeds, light_red: number of all seeds, and of those on which a row that is measured on all did not hold.
        verdict: whether the false-alarm rate is at most the promised one, by the count of seeds alone.
    """

    rows: int
    seeds: int
    red: int
    low: float
    high: float
    by_tail: float
    light_seeds: int
    light_red: int
    verdict: str


def alarm_summary(seeds: pd.DataFrame) -> AlarmSummary:
    """Return the summary of all claimed rows in ``seeds.csv``; DataError if it has no such lines."""
    together = seeds[seeds["label"] == ALL_ROWS].set_index("key")
    if not {"every", "light"} <= set(together.index):
        raise DataError("seeds.csv has no lines about all claimed rows: make it again with `study seeds`")
    every, light = together.loc["every"], together.loc["light"]
    low, high, by_tail = (float(every[name]) for name in ("rate_low", "rate_high", "rate_tail"))
    rows = int((seeds["claimed"] == "yes").sum()) - len(together)
    counts = (int(line[name]) for line in (every, light) for name in ("seeds", "alarms"))
    whole, red, on_each, light_red = counts
    return AlarmSummary(rows, whole, red, low, high, by_tail, on_each, light_red, promise_verdict(low, high))


def read_claims(directory: Path) -> pd.DataFrame:
    """Return ``claims.csv``; DataError if it has an unknown verdict."""
    claims = read_csv(directory, "claims.csv", LEDGER)
    unknown = sorted(set(claims["verdict"]) - set(VERDICTS))
    if unknown:
        raise DataError(f"{directory / 'data' / 'claims.csv'}: verdicts {unknown}, known are {', '.join(VERDICTS)}")
    return claims


def count_verdicts(claims: pd.DataFrame) -> dict[str, int]:
    """Return verdict ↦ number of rows of the ledger."""
    return {verdict: int((claims["verdict"] == verdict).sum()) for verdict in VERDICTS}


def count_kinds(claims: pd.DataFrame) -> dict[str, int]:
    """Return kind of evidence ↦ number of rows of the ledger that hold."""
    kinds = claims[claims["verdict"] == HOLDS].apply(kind, axis=1)
    return {name: int((kinds == name).sum()) for name in KINDS}


def by_claim(claims: pd.DataFrame) -> Iterator[tuple[str, str, pd.DataFrame]]:
    """Yield (label, claim, rows) of each statement in the order of the ledger; a label may have several claims."""
    for (label, claim), rows in claims.groupby(["label", "statement"], sort=False):
        yield str(label), str(claim), rows


def with_orders(table: pd.DataFrame) -> pd.DataFrame:
    """Return a table with the observed order of its errors in the column ``order``, after the time share."""
    found = table.copy()
    found.insert(table.columns.tolist().index("time_share") + 1, "order", in_series(table, "error"))
    return found


def in_series(table: pd.DataFrame, column: str) -> pd.Series:
    """Return the observed orders of a column between each level and the level before, in each series."""
    found = pd.Series(np.nan, table.index)
    for _, group in table.groupby(SERIES, sort=False):
        found[group.index] = since_before(group["h"].to_numpy(), group[column].to_numpy())
    return found


def since_before(h: NDArray[np.float64], error: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the observed order between each level and the one before; NaN for the first, and without an order."""
    found = np.full(len(h), np.nan)
    for i in range(1, len(h)):
        with suppress(RatesError):
            found[i] = orders(h[i - 1 : i + 1], error[i - 1 : i + 1])[0]
    return found
