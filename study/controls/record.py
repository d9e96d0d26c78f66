"""The record of random seeds: the result of every check on the random meshes with each seed. Lines are only added.

A result is stored as the position of the checked value in its tolerance window. A position between −1 and 1 means that
the check holds; any other position is a false alarm.

``data/seeds/drawn.csv`` has one line for each seed, in the order in which the seeds were drawn: the seed, the part of
the checks that was measured, a hash of the rules of these checks, the number of judged checks and the number of false
alarms. The last two are −1 while the seed is being measured. A seed is recorded before anything is measured, so that a
seed with a bad result cannot be left out.

``data/seeds/places.csv.gz`` has one line for each check and each rule by which it was judged. A line has two characters
for each seed, in the order of ``drawn.csv``. They are two digits of base 64, which encode a position between −2 and 2
in steps of 1/1024. The characters ``..`` mean that the check was not judged by this rule on this seed. If the rule of a
check changes (window, levels or statistic), a new line begins, so that earlier seeds do not count.

All positions are recorded, not only their mean and deviation, because mean and deviation do not determine how often
large positions occur. A thousand checks and 150 seeds take 200 kB, compressed.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from string import ascii_letters, digits

import numpy as np
import pandas as pd

from manufactured.tensors import Array
from study.ledger.datafiles import DataError, read_table, table_text, write_csv
from study.ledger.files import write_packed
from study.ledger.verdict import HOLDS, Verdict, worst_value
from study.ledger.window import position

DIGITS = ascii_letters + digits + "+-"
NONE = ".."
"""The two characters that stand for a seed on which a check was not judged."""
ENCODED = re.compile(r"(?:\.\.|[a-zA-Z0-9+-]{2})*")
"""Matches encoded positions: two characters for each seed."""
START = ":"
"""A character before the encoded positions in a line, so that no program reads them as a number."""
NO_RULES = "-"
"""Stands for the hash of the rules of all checks while a seed is being measured."""
STEP = 1 / 1024
"""Resolution with which the position of a value in its tolerance window is stored."""
FURTHEST = 2.0
"""Largest absolute value of a stored position in a tolerance window; larger ones are cut off."""
RowKey = tuple[str, str, str]
"""The key of a check: (label, key, case)."""
Known = tuple[str, str, str, str]
"""The key of a line: label, key and case of a check, and the fingerprint of its rule."""
MADE = "study seeds"
DRAWN = ["seed", "part", "rules", "judged", "alarms"]
PLACES = ["label", "key", "case", "rule", "window_low", "window_high", "places"]


def place(verdict: Verdict) -> float:
    """Return the position of the value of a check in its tolerance window, for the record of random seeds.

    The position is −1 or 1 at an end of the window. It lies between −1 and 1 exactly if the check holds.
    """
    value = float(worst_value(pd.Series(asdict(verdict))))
    low, high = verdict.window_low, verdict.window_high
    found = 0.0 if not low < high or (low <= 0 and np.isinf(high)) else position(value, low, high)
    if verdict.verdict == HOLDS:
        return float(np.clip(found, -1, 1))
    # A check that does not hold is an alarm, even if its value is NaN or, for an undecided check, inside the window.
    # So its position is moved out of the window.
    beyond = np.nan_to_num(found, nan=FURTHEST)
    return float(np.copysign(np.clip(abs(beyond), 1 + 2 * STEP, FURTHEST), beyond))


def packed(value: float) -> str:
    """Return the two characters that encode the position of a value in its tolerance window."""
    number = min(round((value + FURTHEST) / STEP), len(DIGITS) ** 2 - 1)
    return DIGITS[number // len(DIGITS)] + DIGITS[number % len(DIGITS)]


def unpacked(text: str) -> Array:
    """Return the positions of values in a tolerance window that a text encodes, two characters for each seed.

    Returns:
        The positions, one for each seed; NaN for a seed on which the check was not judged.
    """
    pairs = [text[i : i + 2] for i in range(0, len(text), 2)]
    values = [np.nan if pair == NONE else DIGITS.index(pair[0]) * len(DIGITS) + DIGITS.index(pair[1]) for pair in pairs]
    return np.array(values) * STEP - FURTHEST


@dataclass(frozen=True)
class Draw:
    """A line of ``drawn.csv``: one random seed.

    Attributes:
        seed: the seed.
        part: WHOLE if all checks are measured on the meshes of this seed, LIGHT if only the cheap checks are.
        rules: hash of the rules of the judged checks.
        judged: number of judged checks; −1 while the seed is being measured.
        alarms: number of false alarms; −1 while the seed is being measured.
    """

    seed: int
    part: str
    rules: str = NO_RULES
    judged: int = -1
    alarms: int = -1


@dataclass(frozen=True)
class Line:
    """A line of ``places.csv.gz`` without the columns that identify the check: its results on all random seeds.

    Attributes:
        window_low, window_high: the ends of the tolerance window.
        places: two characters for each seed, which encode the position of the value in the window.
    """

    window_low: float
    window_high: float
    places: str = ""

    def at(self, position: int, value: float) -> Line:
        """Return the line with the result of one more seed; for earlier seeds without a result, ``..`` is filled in.

        Parameters:
            position: index of the seed.
            value: position of the value of the check in its tolerance window.
        """
        before = self.places[: 2 * position].ljust(2 * position, NONE[0])
        return replace(self, places=before + packed(value) + self.places[2 * position + 2 :])


@dataclass(frozen=True)
class Record:
    """The record of all random seeds.

    Attributes:
        draws: the seeds, in the order in which they were drawn.
        lines: (label, key and case of a check, fingerprint of the rule by which it was judged) ↦ the results of the
            check for all seeds.
    """

    draws: tuple[Draw, ...] = ()
    lines: Mapping[Known, Line] = field(default_factory=dict)

    @classmethod
    def read(cls, directory: Path) -> Record:
        """Return the record of random seeds in a result directory; it is empty if the directory has none.

        Raises:
            DataError: a file is damaged, or has results for more seeds than were drawn.
        """
        drawn, places = (directory / "data" / "seeds" / name for name in ("drawn.csv", "places.csv.gz"))
        if not drawn.is_file():
            return cls()
        table = read_table(drawn, DRAWN, MADE)
        draws = tuple(Draw(*row) for row in table[DRAWN].itertuples(index=False, name=None))
        lines = read_table(places, PLACES, MADE)[PLACES] if places.is_file() else pd.DataFrame(columns=PLACES)
        found: dict[Known, Line] = {}
        damaged: list[Known] = []
        for label, key, case, rule, low, high, packed_places in lines.itertuples(index=False, name=None):
            text = packed_places.removeprefix(START)
            if len(text) > 2 * len(draws) or not ENCODED.fullmatch(text):
                damaged.append((label, key, case, rule))
            found[label, key, case, rule] = Line(low, high, text.rstrip(NONE[0]))
        if damaged or len({draw.seed for draw in draws}) < len(draws) or len(found) < len(lines):
            what = " ".join(damaged[0]) if damaged else "a repeated seed or row"
            raise DataError(f"{places.parent} is damaged: {what}; restore it, because lines are only added to it")
        return cls(draws, found)

    def write(self, directory: Path) -> None:
        """Write ``places.csv.gz``, then ``drawn.csv``, so that no seed is marked as judged before its results exist."""
        # Every line is filled up to the number of all seeds. So a seed that is deleted from ``drawn.csv`` is noticed.
        wide = 2 * len(self.draws)
        known = [
            [*row, line.window_low, line.window_high, START + line.places.ljust(wide, NONE[0])]
            for row, line in self.lines.items()
        ]
        folder = directory / "data" / "seeds"
        write_packed(folder / "places.csv.gz", table_text(pd.DataFrame(known, columns=PLACES)))
        write_csv(folder / "drawn.csv", pd.DataFrame([asdict(draw) for draw in self.draws], columns=DRAWN))

    def drawn(self, seed: int, part: str) -> Record:
        """Return the record with a new seed that is measured next.

        Raises:
            DataError: the record already has this seed.
        """
        if any(draw.seed == seed for draw in self.draws):
            raise DataError(f"seed {seed} is already in the record, in which nothing is replaced: draw another seed")
        return replace(self, draws=(*self.draws, Draw(seed, part)))

    def pending(self) -> Draw | None:
        """Return the seed that was drawn but not yet judged; None if there is none."""
        return next((draw for draw in self.draws if draw.judged < 0), None)

    def judged(
        self, seed: int, verdicts: Sequence[Verdict], rules: Mapping[RowKey, str], claimed: Callable[[str], bool]
    ) -> Record:
        """Return the record with the results of the checks on one seed.

        Parameters:
            seed: a seed that was drawn and not yet judged.
            verdicts: the checks on the random meshes with this seed.
            rules: key of a check ↦ fingerprint of the rule by which it is judged.
            claimed: function that returns for the label of a check whether its false alarms are counted.

        Raises:
            DataError: the seed was already judged.
        """
        position = [draw.seed for draw in self.draws].index(seed)
        if self.draws[position].judged >= 0:
            raise DataError(f"seed {seed} was already judged, and nothing in the record is replaced")
        lines, alarms = dict(self.lines), 0
        for verdict in verdicts:
            row = verdict.label, verdict.key, verdict.case
            known = *row, rules[row]
            line = lines.get(known, Line(verdict.window_low, verdict.window_high))
            lines[known] = line.at(position, place(verdict))
            alarms += verdict.verdict != HOLDS and claimed(verdict.label)
        together = fingerprint(sorted((*row, rules[row]) for row in {(v.label, v.key, v.case) for v in verdicts}))
        draw = replace(self.draws[position], rules=together, judged=len(verdicts), alarms=alarms)
        return Record((*self.draws[:position], draw, *self.draws[position + 1 :]), lines)

    def agreement(self, seed: int, verdicts: Sequence[Verdict], rules: Mapping[RowKey, str]) -> tuple[int, int]:
        """Compare the recorded results of a seed with new verdicts on the same random meshes.

        Parameters:
            seed: the seed.
            verdicts: the new verdicts.
            rules: key of a check ↦ fingerprint of the rule by which it is judged now. Other rules in the record are
                ignored.

        Returns:
            The number of results that agree, and the number of results that differ.
        """
        position, same, other = [draw.seed for draw in self.draws].index(seed), 0, 0
        for verdict in verdicts:
            row = verdict.label, verdict.key, verdict.case
            line = self.lines.get((*row, rules[row]))
            places = unpacked(line.places[2 * position : 2 * position + 2]) if line else np.empty(0)
            if places.size and np.isfinite(places[0]):
                near = abs(places[0] - unpacked(packed(place(verdict)))[0]) <= STEP
                same, other = same + int(near), other + int(not near)
        return same, other


def fingerprint(content: object) -> str:
    """Return the letter r and nine hexadecimal digits of the SHA-256 of the text of an object."""
    return "r" + hashlib.sha256(repr(content).encode()).hexdigest()[:9]
