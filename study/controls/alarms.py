"""The false-alarm rate: on how many random meshes a check of the ledger fails although the program is correct.

The record of seeds has the results of all checks on random meshes, one mesh sequence for each seed. A seed counts for a
check if it was drawn after the last change of the rule of the check (tolerance window, levels, statistic). Earlier
seeds remain in the record but do not count.

A check is *claimed* if the study claims that it holds on random meshes. ``data/seeds.csv`` begins with two rows about
all claimed checks together; then it has one row for each check. The row ``every`` counts the seeds on which all checks
were measured. The row ``light`` counts all seeds, but only with the cheap checks, which are measured on each seed. Both
counts start again after a change of one of their checks. The count of ``every`` also starts again if a check is removed
from the ledger. Otherwise a false alarm could be hidden by removing the check.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from tabulate import tabulate

from manufactured.tensors import Array
from study.controls.record import Line, Record, RowKey, fingerprint, unpacked
from study.controls.seeded import LIGHT, WHOLE, claimed
from study.ledger.chance import PROMISE, interval, seeds_needed, tail
from study.ledger.compare import difference
from study.ledger.datafiles import ALL_ROWS, AlarmSummary, DataError, table_text
from study.ledger.window import is_two_sided

COLUMNS = ["label", "key", "case", "rule", "part", "claimed", "since", "seeds"]
COLUMNS += ["alarms", "rate_low", "rate_high", "lowest", "highest", "tail", "fit", "rate_tail"]
"""Columns of ``seeds.csv``: the check (label to claimed); the number of the first seed that counts for it, and the
number of such seeds; the number of false alarms with the 95 % interval of their rate; the lowest and the highest
position in the tolerance window; and the model of the distribution's tail, the p-value of its test and the rate that
follows from it."""
NAMED = PROMISE / 10
"""A check is printed if the rate that is extrapolated for it alone is more than a tenth of ``PROMISE``."""
FITTED = frozenset({"rate_low", "rate_high", "rate_tail", "fit"})
"""Columns of ``seeds.csv`` whose last digits depend on the machine, because they are computed by iteration."""
FOLDED = [25, 14]
"""Widths of the printed columns for the check and for the case, so that a line has at most 80 characters."""


@dataclass(frozen=True)
class CountedCheck:
    """A check, and for each seed of random meshes the position of its value in its tolerance window.

    Positions between −1 and 1 lie in the window; −1 and 1 are its ends.

    Attributes:
        key: label, key and case of the check.
        rule: hash of the rule of the check: its tolerance window, levels and statistic.
        places: the positions, one for each seed. A position is NaN if the check was not judged by this rule on the
            meshes of the seed.
        both: whether values can come near both ends of the window.
    """

    key: RowKey
    rule: str
    places: Array
    both: bool

    @classmethod
    def of(cls, record: Record) -> list[CountedCheck]:
        """Return the recorded checks that are still in the ledger (the table of all checks), each with its newest rule.

        A check is no longer in the ledger if it was not judged on the last seed with all checks, nor on a later seed.
        """
        latest: dict[RowKey, tuple[str, Line]] = {}
        for (*row, rule), line in record.lines.items():
            key = (row[0], row[1], row[2])
            if key not in latest or len(line.places) > len(latest[key][1].places):
                latest[key] = rule, line
        wide = 2 * len(record.draws)
        found = [
            cls(key, rule, unpacked(line.places.ljust(wide, ".")), is_two_sided(line.window_low, line.window_high))
            for key, (rule, line) in latest.items()
        ]
        return [row for row in found if np.isfinite(row.places[newest(record) :]).any()]

    def line(self, part: str) -> dict[str, object]:
        """Return the row of ``seeds.csv`` for this check: numbers of seeds and false alarms, and their rate.

        Parameters:
            part: LIGHT if the check is measured on each seed, WHOLE if it is only measured on every few seeds.
        """
        model = tail(self.places[np.isfinite(self.places)], self.both)
        known = *self.key, self.rule, part, "yes" if claimed(self.key[0]) else "no"
        return count_alarms(known, self.places[None, :], (model.model, model.fit, model.rate))


def count_alarms(known: tuple[str, ...], places: Array, model: tuple[str, float, float]) -> dict[str, object]:
    """Return a row of ``seeds.csv`` about one or several checks, from the seeds on which all of them were judged.

    A seed has a false alarm if at least one check fails.

    Parameters:
        known: the cells of the row that name the checks: its columns from ``label`` to ``claimed``.
        places: positions of the values in the tolerance windows, shape (number of checks, number of seeds).
        model: the model of the tail, the p-value of its test and the extrapolated rate. The rate of several checks is
            only known if there is a seed on which all of them were judged.
    """
    counted = np.flatnonzero(np.isfinite(places).all(axis=0)) if len(places) else np.empty(0, dtype=int)
    places, judged = places[:, counted], len(counted)
    alarms = int((abs(places) > 1).any(axis=0).sum())
    since = int(counted[0]) + 1 if judged else 0
    ends = (float(places.min()), float(places.max())) if judged else (math.nan, math.nan)
    *tested, rate = model
    found = since, judged, alarms, *interval(alarms, judged), *ends, *tested, rate if judged else math.nan
    return dict(zip(COLUMNS, (*known, *found), strict=True))


def newest(record: Record) -> int:
    """Return the index of the last seed on which all checks were judged; 0 if there is none."""
    return max((n for n, draw in enumerate(record.draws) if draw.part == WHOLE and draw.judged >= 0), default=0)


def tally(record: Record) -> pd.DataFrame:
    """Return the table ``seeds.csv``: two rows about all claimed checks together, one row for each single check."""
    rows = CountedCheck.of(record)
    whole = np.array([draw.part == WHOLE for draw in record.draws])
    in_force = np.array([draw.rules == record.draws[newest(record)].rules for draw in record.draws])
    on_each = [bool(np.isfinite(row.places[~whole]).any()) for row in rows]
    parts = [LIGHT if light else WHOLE for light in on_each]
    table = pd.DataFrame([row.line(part) for row, part in zip(rows, parts, strict=True)], columns=COLUMNS)
    places = np.array([row.places for row in rows])
    mine = (table["claimed"] == "yes").to_numpy()
    together, light, always = [], mine & np.array(on_each), np.ones_like(whole)
    for key, these, shown in (("every", mine, whole & in_force), ("light", light, always)):
        # The sum of the rates is unknown if the rate of one check is unknown.
        rate = float(table["rate_tail"][these].sum(skipna=False))
        known = ALL_ROWS, key, f"{these.sum()} rows", "", "", "yes"
        together.append(count_alarms(known, np.where(shown, places[these], math.nan), ("sum", math.nan, rate)))
    return pd.concat([pd.DataFrame(together, columns=COLUMNS), table], ignore_index=True)


def newer(table: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of ``seeds.csv`` for claimed checks whose rule was changed after the first seed.

    Cheap checks are measured on each seed, costly checks only on some. So the first seed of the cheap checks may differ
    from the first seed of the costly ones.
    """
    first = table.groupby("part")["since"].transform("min")
    return table[(table["claimed"] == "yes") & (table["label"] != ALL_ROWS) & (table["since"] > first)]


def text(table: pd.DataFrame) -> str:
    """Return the text that ``study seeds`` prints.

    It has the false-alarm rates of all checks together, the checks with false alarms or with a high extrapolated rate,
    and the verdict.
    """
    ledger, rows = table[table["label"] == ALL_ROWS], table[table["label"] != ALL_ROWS]
    lines = [
        (one.key, one.case, one.seeds, one.alarms, f"{one.rate_low:.2%} … {one.rate_high:.2%}")
        + ("unknown" if math.isnan(one.rate_tail) else f"{one.rate_tail:.2%}",)
        for one in ledger.itertuples()
    ]
    named = rows[(rows["alarms"] > 0) | ((rows["rate_tail"] > NAMED) & (rows["claimed"] == "yes"))]
    weak = [
        (f"{one.label}, {one.key}", one.case, f"{one.alarms} of {one.seeds}")
        + (one.tail, f"{one.rate_tail:.1g}", one.claimed)
        for one in named.sort_values("rate_tail", ascending=False, kind="stable").itertuples()
    ]
    return "\n".join(
        [
            tabulate(lines, ["checks", "", "seeds", "false alarms", "rate (95 %)", "rate by model"], "simple"),
            "",
            tabulate(weak, ["check", "case", "alarms", "tail", "rate", "claimed"], "simple", maxcolwidths=FOLDED),
            "",
            f"{len(newer(table))} checks were changed after the first seed; only later seeds count for them",
            f"at most {PROMISE:.0%} of new seeds may cause a false alarm: {AlarmSummary(table).verdict}",
            f"(judged by the count alone: {seeds_needed()} seeds without a false alarm are enough)",
        ]
    )


def compare_record(directory: Path) -> set[Path]:
    """Check that the files of the record of random seeds agree with each other; return the completely compared files.

    Every row of ``drawn.csv`` must have the number of checks, the number of false alarms and the rules that follow from
    ``places.csv.gz``. The table ``seeds.csv`` must follow from these two files.

    Raises:
        DataError: a line of ``seeds.csv``, ``drawn.csv`` or ``places.csv.gz`` is missing, was added or was changed.
    """
    table, folder = directory / "data" / "seeds.csv", directory / "data" / "seeds"
    drawn, places = folder / "drawn.csv", folder / "places.csv.gz"
    if not table.exists() and not drawn.exists() and not places.exists():
        return set()
    record = Record.read(directory)
    if not drawn.is_file() or (record.draws and not places.is_file()):
        missing = places if drawn.is_file() else drawn
        raise DataError(f"{missing} is missing: restore it, because lines are only added to it")
    _compare_counts(record, drawn, places)
    again = f"`study seeds --minutes 0 --out {directory}` makes it again from the record"
    if not any(draw.judged >= 0 for draw in record.draws):
        if table.exists():
            raise DataError(f"{table} has no record in {folder}: restore the record")
        return {places}
    if not table.is_file():
        raise DataError(f"{table} is missing: {again}")
    if found := difference(table, table_text(tally(record)), FITTED):
        raise DataError(f"{found}: {again}; restore the record, if that was changed")
    return {table, places}


def _compare_counts(record: Record, drawn: Path, places: Path) -> None:
    """Compare ``drawn.csv``, which counts the checks and alarms of each seed, with the results of single checks.

    Raises:
        DataError: a count does not follow from these results.
    """
    known = list(record.lines)
    wide = 2 * len(record.draws)
    values = np.array([unpacked(record.lines[row].places.ljust(wide, ".")) for row in known])
    values = values.reshape(len(known), len(record.draws))
    judged, beyond = np.isfinite(values), abs(values) > 1
    counts = np.array([claimed(row[0]) for row in known], dtype=bool)
    in_force = record.draws[newest(record)].rules if record.draws else ""
    for n, draw in enumerate(record.draws):
        rows, alarms = int(judged[:, n].sum()), int(beyond[counts, n].sum())
        rules = fingerprint(sorted(row for row, is_judged in zip(known, judged[:, n], strict=True) if is_judged))
        # Only alarms of claimed checks are counted. Which checks are claimed may have changed since an older seed, so
        # that only an upper limit of its alarms is known.
        alarms_agree = draw.alarms == alarms if draw.rules == in_force else draw.alarms <= int(beyond[:, n].sum())
        agrees = draw.judged == rows and draw.rules == rules and alarms_agree
        if not agrees and (rows or draw.judged >= 0):
            raise DataError(
                f"{drawn}, line {n + 2}: seed {draw.seed} has {draw.judged} rows, {draw.alarms} alarms and the rules "
                f"{draw.rules}, {places.name} has {rows} rows, {alarms} alarms and the rules {rules}: restore both "
                "files, because lines are only added to them"
            )
