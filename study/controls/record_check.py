"""Check that the record of seeds, the counts in it and its table ``seeds.csv`` agree."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from study.controls.alarms import newest, tally
from study.controls.record import Record, fingerprint, unpacked
from study.controls.seeded import claimed
from study.ledger.compare import difference
from study.ledger.datafiles import DataError, table_text

FITTED = frozenset({"rate_low", "rate_high", "rate_tail", "fit"})
"""Columns of ``seeds.csv`` whose last digits depend on the machine, because they are computed by iteration."""


def compare_record(directory: Path) -> set[Path]:
    """Check that the record of seeds agrees with itself and with ``seeds.csv``; return the files that were compared.

    Every row of ``drawn.csv`` must have the number of checks, the number of alarms and the rules that follow from
    ``places.csv.gz``, and ``seeds.csv`` must be the table that follows from both.

    Raises:
        DataError: a line of one of the three files is missing, was added or was changed.
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
        return {drawn, places}
    if not table.is_file():
        raise DataError(f"{table} is missing: {again}")
    if found := difference(table, table_text(tally(record)), FITTED):
        raise DataError(f"{found}: {again}; restore the record, if that was changed")
    return {table, drawn, places}


def _compare_counts(record: Record, drawn: Path, places: Path) -> None:
    """Check that the counts of every seed in ``drawn.csv`` follow from its positions."""
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
        # The set of claimed labels may have changed; older seeds were counted with the labels of their time.
        alarms_agree = draw.alarms == alarms if draw.rules == in_force else draw.alarms <= int(beyond[:, n].sum())
        agrees = draw.judged == rows and draw.rules == rules and alarms_agree
        if not agrees and (rows or draw.judged >= 0):
            raise DataError(
                f"{drawn}, line {n + 2}: seed {draw.seed} has {draw.judged} rows, {draw.alarms} alarms and the rules "
                f"{draw.rules}, {places.name} has {rows} rows, {alarms} alarms and the rules {rules}: restore both "
                "files, because lines are only added to them"
            )
