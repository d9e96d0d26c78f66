"""The matrix fault × case × check of ``faults.csv``, and the false-alarm rate on random meshes from ``seeds.csv``.

The false-alarm rate says on how many random meshes some check fails although the program is correct.

``data/seeds.csv`` is a record with one row for each seed, in the order in which the seeds were drawn. A seed is
recorded before anything is measured, so that a seed with a bad result cannot be left out. A seed counts only if its
checks had the same rules (quantities, tolerance windows, levels) as the checks of the last judged seed.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, log
from pathlib import Path
from typing import NamedTuple

import scipy  # loads ``scipy.stats`` at its first use, because importing it takes half a second
from pandas import DataFrame

from study.ledger.datafiles import DataError, read_csv, write_csv
from study.ledger.verdict import FAILS, HOLDS, UNDECIDED

INVISIBLE_SHARE = 1e-6
"""A fault is invisible in a case if it changes the discrete solution by less than this fraction of the error."""
ALONE = r"(?:^|; )(?!Thm 4\.2)."
"""Pattern of lists of failing checks with another check than the comparison with Problem 3.2 (Theorem 4.2).

The comparison notices any fault that the other formulation does not have."""


def summary(matrix: DataFrame) -> DataFrame:
    """Return a table with a row for each fault and size, which says in how many cases it is noticed.

    Parameters:
        matrix: the table ``faults.csv``.

    Returns:
        The columns ``equation``, ``fault`` and ``size``, and numbers of cases: ``errors``, where a check of the order
        or size of the error fails; ``any_check``, where some check fails; ``invisible``, where the fault changes the
        discrete solution by less than ``INVISIBLE_SHARE`` of the error; ``cases``, all in which it was measured.
    """
    by_error = matrix.by_error != ""
    rows = matrix.assign(
        errors=by_error,
        any_check=by_error | (matrix.by_others != ""),
        invisible=matrix.distance < INVISIBLE_SHARE * matrix.error,
    )
    grouped = rows.groupby(["equation", "fault", "size"], sort=False)
    counts = grouped[["errors", "any_check", "invisible"]].sum()
    return counts.assign(cases=grouped.size()).reset_index()


def missed(matrix: DataFrame) -> dict[str, str]:
    """Return the deliberate faults that checks do not notice as the rules demand.

    A check notices a fault in a case if it fails with the fault. The rules are:

    * Every fault of its smallest size must be noticed in two plane cases, or in the only one in which it was measured.
    * Every fault of its largest size must be noticed in one case in space, if it can occur there. Smaller sizes are
      not tried in space, because the meshes are coarser.
    * Only checks of the order or size of the error count. For faults of single vertices or cells, or of contact forces,
      other checks count, too, except the comparison with Problem 3.2.

    Parameters:
        matrix: the table ``faults.csv``.

    Returns:
        Name of the fault ↦ where it is not noticed: "in the plane", "in space" or "in the plane and in space".
    """
    lacking = {}
    alone = matrix.by_others.str.contains(ALONE)
    for fault, rows in matrix.groupby("fault", sort=False):
        size = rows["size"].abs()
        noticed = (rows.by_error != "") | (rows.single == 1) & alone[rows.index]
        plane = noticed[(rows.dim == 2) & (size == size.min())]
        solid = noticed[(rows.dim == 3) & (size == size.max())]
        places = {
            "in the plane": plane.sum() < min(2, len(plane)),
            "in space": len(solid) > 0 and not solid.any(),
        }
        if any(places.values()):
            lacking[fault] = " and ".join(place for place, lacks in places.items() if lacks)
    return lacking


def in_words(lacking: dict[str, str]) -> str:
    """Return as text which faults are not noticed where; "none" if there are none.

    Parameters:
        lacking: the result of ``missed``.
    """
    return "; ".join(f"{fault}, {where}" for fault, where in lacking.items()) or "none"


SEEDS_FILE = "seeds.csv"
CONFIDENCE = 0.95
LARGEST_RATE = 0.01
"""The largest permitted false-alarm rate: on which share of seeds at least one check may fail by chance."""


def interval(alarms: int, seeds: int) -> tuple[float, float]:
    """Return the 95 % confidence interval of a false-alarm rate by Clopper and Pearson.

    Parameters:
        alarms: number of seeds with a false alarm.
        seeds: number of all seeds; for 0 seeds the interval is (0, 1).
    """
    if seeds == 0:
        return 0.0, 1.0
    exact = scipy.stats.binomtest(alarms, seeds).proportion_ci(CONFIDENCE, method="exact")
    return exact.low, exact.high


def seeds_needed() -> int:
    """Return how many random seeds must all be without a false alarm.

    Their number shows, with the probability ``CONFIDENCE``, that the false-alarm rate is at most ``LARGEST_RATE``.
    """
    return ceil(log((1 - CONFIDENCE) / 2) / log(1 - LARGEST_RATE))


class Seed(NamedTuple):
    """A row of ``seeds.csv``.

    Attributes:
        seed: the number from which the random meshes are made.
        rules: hash of the quantities, tolerance windows and levels of all judged checks; "-" while the seed is being
            measured. A seed counts only if its hash is that of the seed that was judged last.
        judged: number of checks; −1 while the seed is being measured.
        alarms: number of checks that did not hold; −1 while the seed is being measured.
    """

    seed: int
    rules: str = "-"
    judged: int = -1
    alarms: int = -1


@dataclass(frozen=True)
class SeedRecord:
    """The record of all seeds, in the order in which they were drawn. Rows are added, never replaced."""

    rows: tuple[Seed, ...] = ()

    @classmethod
    def read(cls, directory: Path) -> SeedRecord:
        """Return the record in a result directory; it is empty if the directory has none.

        Raises:
            DataError: the file is damaged, repeats a seed, or has more alarms than checks.
        """
        path = directory / "data" / SEEDS_FILE
        if not path.is_file():
            return cls()
        try:
            table = read_csv(directory, SEEDS_FILE, Seed._fields)
        except DataError as error:
            raise DataError(f"{error}, or restore the file, because rows are only added to it") from error
        if (table.judged[:-1] < 0).any() or (table.alarms > table.judged).any():
            raise DataError(
                f"{path} has more alarms than checks, or an unfinished seed that is not the last one: restore the "
                "file, because rows are only added to it"
            )
        return cls(tuple(map(Seed._make, table[[*Seed._fields]].itertuples(index=False))))

    def write(self, directory: Path) -> Path:
        """Write the record into a result directory and return the path of the file."""
        return write_csv(directory / "data" / SEEDS_FILE, DataFrame(self.rows, columns=Seed._fields))

    def pending(self) -> Seed | None:
        """Return the seed that was drawn but not yet judged; None if there is none."""
        return next((row for row in self.rows if row.judged < 0), None)

    def drawn(self, seed: int) -> SeedRecord:
        """Return the record with a new seed, which is measured next."""
        return SeedRecord((*self.rows, Seed(seed)))

    def judged(self, rules: str, checks: int, alarms: int) -> SeedRecord:
        """Return the record with the result of the seed that was drawn last.

        Parameters:
            rules: hash of the rules of the checks, as in ``Seed``.
            checks: number of checks.
            alarms: number of checks that did not hold.

        Raises:
            DataError: the seed was already judged.
        """
        if (begun := self.pending()) is None:
            raise DataError("the last seed was already judged, and nothing in the record is replaced: draw a seed")
        return SeedRecord((*self.rows[:-1], Seed(begun.seed, rules, checks, alarms)))


class FalseAlarms:
    """The false-alarm rate of all checks on random meshes together.

    Attributes:
        checks: number of checks on each seed.
        seeds: number of seeds that count: those that are finished, with the same ``rules`` as the last finished one.
        red: number of these seeds on which at least one check did not hold.
        low, high: confidence interval of the false-alarm rate, whose estimate is red / seeds.
        verdict: whether the rate is at most ``LARGEST_RATE``: holds, fails or undecided.
    """

    def __init__(self, record: SeedRecord) -> None:
        finished = [row for row in record.rows if row.judged >= 0]
        counted = [row for row in finished if row.rules == finished[-1].rules]
        self.checks = counted[-1].judged if counted else 0
        self.seeds = len(counted)
        self.red = sum(row.alarms > 0 for row in counted)
        self.low, self.high = interval(self.red, self.seeds)
        self.verdict = HOLDS if self.high <= LARGEST_RATE else FAILS if self.low > LARGEST_RATE else UNDECIDED

    def text(self) -> str:
        """Return the text that ``study seeds`` prints."""
        return (
            f"{self.red} of {self.seeds} seeds raised a false alarm; each has {self.checks} checks\n"
            f"false-alarm rate with {CONFIDENCE:.0%} confidence: {self.low:.2%} to {self.high:.2%}\n"
            f"at most {LARGEST_RATE:.0%} is permitted: {self.verdict}\n"
            f"({seeds_needed()} seeds without a false alarm are enough)"
        )
