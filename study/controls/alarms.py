"""The false-alarm rate: how often chance alone turns a row of the ledger red, from the record of seeds.

A row is judged by the seeds that were drawn since the last change to its rule, levels or window. Earlier seeds stay in
the record and do not count. ``data/seeds.csv`` has a line for each row, after two lines for all claimed rows together:
``every`` counts the seeds on which all rows were measured, ``light`` counts all seeds, with the cheap rows that are
measured on each of them. Both counts start again after the last change to one of their rows. ``every`` also starts
again when a row leaves the ledger: otherwise a row that was removed for its alarms would remove these alarms from the
record.
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
from study.ledger.chance import PROMISE, interval, seeds_needed, tail
from study.ledger.datafiles import ALL_ROWS, alarm_summary, write_csv

COLUMNS = ["label", "key", "case", "rule", "part", "claimed", "since", "seeds"]
COLUMNS += ["alarms", "rate_low", "rate_high", "lowest", "highest", "tail", "fit", "rate_tail"]
"""Columns of ``seeds.csv``: the row; the number of the first seed that counts, and how many seeds count; alarms with
the 95 % interval of their rate, the extreme places in the window, and the model of the tail with the p-value of its
test and the rate that follows from it."""
NAMED = PROMISE / 10
"""A row is listed if its tail alone gives a rate above a tenth of the rate that is promised for all rows."""
FOLDED = [25, 14]
"""Widths of the columns row and case that make a line 80 characters wide."""


@dataclass(frozen=True)
class Seen:
    """A row with its places in its window on the seeds that count.

    Attributes:
        key: (label, key, case).
        rule: the fingerprint of the rule.
        places: one for every seed that was drawn, (seeds,); NaN for seeds that this rule did not judge.
        both: whether its window is two-sided.
    """

    key: RowKey
    rule: str
    places: Array
    both: bool

    @classmethod
    def of(cls, record: Record) -> list[Seen]:
        """Return the rows of a record, each with the rule that judged it last.

        A row is no longer in the ledger if neither the last seed with all rows nor a later seed has it.
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
    """Return the position of the last seed on which all rows were judged; 0 without one."""
    return max((n for n, draw in enumerate(record.draws) if draw.part == WHOLE and draw.judged >= 0), default=0)


def tally(record: Record) -> pd.DataFrame:
    """Return the lines of ``seeds.csv``: two for all rows together, then one for each row."""
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
    """Return the line that counts the seeds on which one or more of some rows raised an alarm; tails are summed.

    ``places`` has shape (rows, seeds).
    """
    counted = np.flatnonzero(np.isfinite(places).all(axis=0)) if len(places) else np.empty(0, dtype=int)
    places, judged = places[:, counted], len(counted)
    since = int(counted[0]) + 1 if judged else 0
    red = int((abs(places) > 1).any(axis=0).sum())
    low, high = interval(red, judged)
    ends = (float(np.nanmin(places)), float(np.nanmax(places))) if judged else (math.nan, math.nan)
    # Without a model of a tail, or without a seed, nothing is known about the rate.
    rate = float(rows["rate_tail"].sum(skipna=False)) if judged else math.nan
    known = ALL_ROWS, key, f"{len(rows)} rows", "", "", "yes", since, judged
    return dict(zip(COLUMNS, (*known, red, low, high, *ends, "sum", math.nan, rate), strict=True))


def newer(table: pd.DataFrame) -> pd.DataFrame:
    """Return the claimed rows whose rule is newer than the first seed of their part of the plan."""
    first = table.groupby("part")["since"].transform("min")
    return table[(table["claimed"] == "yes") & (table["label"] != ALL_ROWS) & (table["since"] > first)]


def verdict(table: pd.DataFrame) -> str:
    """Return whether the promised false-alarm rate is met: holds, undecided or fails."""
    return alarm_summary(table).verdict


def text(table: pd.DataFrame) -> str:
    """Return a text with the rates of all rows together, every alarm, and the rows with large tails."""
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
            f"at most {PROMISE:.0%} of fresh seeds may turn the ledger red: {verdict(table)} by the count alone "
            f"({seeds_needed()} seeds without an alarm are enough; the tails judge nothing)",
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
