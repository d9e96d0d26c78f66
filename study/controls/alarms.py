"""How often the ledger is red by chance, from the record of seeds: row by row and for all that is claimed.

A row is judged by the seeds that were drawn since the last change to its rule, levels or window; seeds before it stay
in the record and do not count. ``data/seeds.csv`` has a line for each row, and two in front for all claimed rows
together: ``every`` counts seeds that were measured whole, ``light`` all seeds with the rows that are measured on each
of them. Both begin anew with the last change to any of their rows, and ``every`` when a row leaves the ledger, too: a
row that was given up for its alarms would take them away from seeds that had shown them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from tabulate import tabulate

from manufactured.tensors import Array
from study.controls.record import Line, Record, RowKey, two_sided, unpacked
from study.controls.seeded import LIGHT, WHOLE, claimed
from study.ledger.chance import PROMISE, interval, tail
from study.ledger.datafiles import ALL_ROWS, alarm_summary, write_csv

COLUMNS = ["label", "key", "case", "rule", "part", "claimed", "since", "seeds"]
COLUMNS += ["alarms", "rate_low", "rate_high", "lowest", "highest", "tail", "fit", "rate_tail"]
"""``seeds.csv``: what the row is; the number of the first seed that counts and how many do; what was found: alarms with
the interval of their rate at 95 %, the extreme places in the window, and the model of the tail with the p-value of its
test and the rate that follows."""
NAMED = PROMISE / 10
"""A row whose tail alone takes so much of what is promised for all rows is named."""
FOLDED = [25, 14]
"""Columns for row and case, so that a line has 80."""


@dataclass(frozen=True)
class Seen:
    """A row with the places that count.

    Attributes:
        key: (label, key, case).
        rule: the fingerprint of the rule.
        places: on every seed that was drawn, not a number where it was not judged by this rule, (seeds,).
        both: whether both ends of its window are ends.
    """

    key: RowKey
    rule: str
    places: Array
    both: bool

    @classmethod
    def of(cls, record: Record) -> list[Seen]:
        """The rows of a record, each by the rule that judged it last.

        A row that the last whole seed, which has all of them, and those after it do not have is one that is no longer
        in the ledger.
        """
        latest: dict[RowKey, tuple[str, Line]] = {}
        for (*row, rule), line in record.lines.items():
            key = (row[0], row[1], row[2])
            if key not in latest or len(line.places) > len(latest[key][1].places):
                latest[key] = rule, line
        wide = 2 * len(record.draws)
        found = [
            cls(key, rule, unpacked(line.places.ljust(wide, ".")), two_sided(line.window_low, line.window_high))
            for key, (rule, line) in latest.items()
        ]
        return [row for row in found if np.isfinite(row.places[newest(record) :]).any()]

    @property
    def claimed(self) -> bool:
        return claimed(self.key[0])

    def line(self, part: str) -> dict[str, object]:
        """Its line of ``seeds.csv``; ``part`` is the least part of the plan that has it."""
        where = np.flatnonzero(np.isfinite(self.places))
        places = self.places[where]
        alarms = int((abs(places) > 1).sum())
        low, high = interval(alarms, len(places))
        model = tail(places, self.both)
        known = (*self.key, self.rule, part, "yes" if self.claimed else "no", int(where[0]) + 1, len(places))
        found = alarms, low, high, float(places.min()), float(places.max()), model.model, model.fit, model.rate
        return dict(zip(COLUMNS, (*known, *found), strict=True))


def newest(record: Record) -> int:
    """The place among the seeds of the last one that was judged whole, 0 if none was."""
    return max((n for n, draw in enumerate(record.draws) if draw.part == WHOLE and draw.judged >= 0), default=0)


def tally(record: Record) -> pd.DataFrame:
    """The lines of ``seeds.csv``: those of all rows together, then one for each row."""
    rows = Seen.of(record)
    whole = np.array([draw.part == WHOLE for draw in record.draws])
    in_force = np.array([draw.rules == record.draws[newest(record)].rules for draw in record.draws])
    on_each = [bool(np.isfinite(row.places[~whole]).any()) for row in rows]
    parts = [LIGHT if light else WHOLE for light in on_each]
    table = pd.DataFrame([row.line(part) for row, part in zip(rows, parts, strict=True)], columns=COLUMNS)
    places = np.array([row.places for row in rows])
    mine = (table["claimed"] == "yes").to_numpy()
    light = mine & np.array(on_each)
    every = _together("every", table[mine], np.where(whole & in_force, places[mine], math.nan))
    of_light = _together("light", table[light], places[light])
    return pd.concat([pd.DataFrame([every, of_light], columns=COLUMNS), table], ignore_index=True)


def _together(key: str, rows: pd.DataFrame, places: Array) -> dict[str, object]:
    """On how many of the seeds that judged all of some rows one or more raised an alarm; tails are summed.

    ``places`` has shape (rows, seeds).
    """
    counted = np.flatnonzero(np.isfinite(places).all(axis=0)) if len(places) else np.empty(0, dtype=int)
    places, judged = places[:, counted], len(counted)
    since = int(counted[0]) + 1 if judged else 0
    red = int((abs(places) > 1).any(axis=0).sum())
    low, high = interval(red, judged)
    ends = (float(np.nanmin(places)), float(np.nanmax(places))) if judged else (math.nan, math.nan)
    # A row without a model, or rows that were on no seed yet, may do anything.
    rate = float(rows["rate_tail"].sum(skipna=False)) if judged else math.nan
    known = ALL_ROWS, key, f"{len(rows)} rows", "", "", "yes", since, judged
    return dict(zip(COLUMNS, (*known, red, low, high, *ends, "sum", math.nan, rate), strict=True))


def newer(table: pd.DataFrame) -> pd.DataFrame:
    """The claimed rows whose rule is newer than the first seed that rows of their part were judged on."""
    first = table.groupby("part")["since"].transform("min")
    return table[(table["claimed"] == "yes") & (table["label"] != ALL_ROWS) & (table["since"] > first)]


def verdict(table: pd.DataFrame) -> str:
    """Whether the promise is kept for all claimed rows."""
    return alarm_summary(table).verdict


def text(table: pd.DataFrame) -> str:
    """The rates of all rows together, every alarm, and the rows whose tails take much of what is promised."""
    ledger, rows = table[table["label"] == ALL_ROWS], table[table["label"] != ALL_ROWS]
    lines = [
        (one.key, one.case, one.seeds, one.alarms, f"{one.rate_low:.2%} … {one.rate_high:.2%}", _tails(one.rate_tail))
        for one in ledger.itertuples()
    ]
    named = rows[(rows["alarms"] > 0) | ((rows["rate_tail"] > NAMED) & (rows["claimed"] == "yes"))]
    weak = [
        (f"{one.label}, {one.key}", one.case, _of(one.alarms, one.seeds), one.tail, f"{one.rate_tail:.1g}", one.claimed)
        for one in named.sort_values("rate_tail", ascending=False).itertuples()
    ]
    return "\n".join(
        [
            tabulate(lines, ["seeds with", "", "seeds", "red", "rate, 95 %", "by the tails"], "simple"),
            "",
            tabulate(weak, ["row", "case", "alarms", "tail", "rate", "claimed"], "simple", maxcolwidths=FOLDED),
            "",
            f"{len(newer(table))} rows have a rule that is newer than the first seed: seeds count since then",
            f"at most {PROMISE:.0%} of fresh seeds may turn the ledger red: {verdict(table)}",
        ]
    )


def _of(some: object, every: object) -> str:
    return f"{some} of {every}"


def _tails(rate: float) -> str:
    return "unknown" if math.isnan(rate) else f"{rate:.2%}"


def write_seeds(directory: Path, table: pd.DataFrame) -> Path:
    """``data/seeds.csv``."""
    path = directory / "data" / "seeds.csv"
    write_csv(path, table)
    return path
