"""The record of random seeds: for each seed, the position of every check in its window. Nothing in it is replaced.

``data/seeds/drawn.csv`` has one line for each seed, in the order in which the seeds were drawn: the seed, the part of
the plan that was measured, a hash of the rules, the number of judged checks and the number of alarms. The last two are
−1 while the seed is being measured. A seed is recorded before anything is measured, so that a seed with a bad result
cannot be left out.

``data/seeds/places.csv.gz`` has one line for each check and each rule that judged it, with two characters for each seed
in the same order. The characters are two digits of base 64, which encode a position between −2 and 2 in steps of
1/1024. ``..`` means that this rule did not judge this seed. If the position lies between −1 and 1, the check holds;
otherwise it raises an alarm. If the rule changes (window, levels or statistic), a new line begins, so that seeds before
the change do not count.

All positions are recorded, not only their mean and deviation, because these do not determine the tail of the
distribution. A thousand checks and 150 seeds take 200 kB, compressed.
"""

from __future__ import annotations

import hashlib
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
from study.ledger.window import SMALL

DIGITS = ascii_letters + digits + "+-"
NONE = ".."
"""The two characters for a seed that was not judged."""
START = ":"
"""The character before the positions in a line, so that no program reads them as a number."""
NO_RULES = "-"
"""The hash of the rules while a seed is being measured."""
STEP = 1 / 1024
"""The resolution of positions."""
FURTHEST = 2.0
"""The largest absolute value of a recorded position."""
RowKey = tuple[str, str, str]
"""The key of a check: (label, key, case)."""
Known = tuple[str, str, str, str]
"""The key of a line: (label, key, case, rule)."""
MADE = "study seeds"
DRAWN = ["seed", "part", "rules", "judged", "alarms"]
PLACES = ["label", "key", "case", "rule", "window_low", "window_high", "places"]


def place(verdict: Verdict) -> float:
    """Return the position of a check in its window; it lies between −1 and 1 exactly if the check holds."""
    judged = float(worst_value(pd.Series(asdict(verdict))))
    low, high, value = verdict.window_low, verdict.window_high, judged
    if not low < high or (low <= 0 and np.isinf(high)):
        found = 0.0
    elif np.isinf(high):
        found = low / value if value > 0 else FURTHEST
    else:
        found = (2 * value - low - high) / (high - low) if two_sided(low, high) else value / high
    if verdict.verdict == HOLDS:
        return float(np.clip(found, -1, 1))
    # A value of NaN is an alarm, and so is an undecided check, even if its value lies inside the window.
    beyond = np.nan_to_num(found, nan=FURTHEST)
    return float(np.copysign(np.clip(abs(beyond), 1 + 2 * STEP, FURTHEST), beyond))


def two_sided(low: float, high: float) -> bool:
    """Return whether values in the window [low, high] can come near both ends."""
    return bool(np.isfinite([low, high]).all() and not 0 <= low <= SMALL * high)


def packed(value: float) -> str:
    """Return the two digits that encode a position."""
    number = min(round((value + FURTHEST) / STEP), len(DIGITS) ** 2 - 1)
    return DIGITS[number // len(DIGITS)] + DIGITS[number % len(DIGITS)]


def unpacked(text: str) -> Array:
    """Return the positions that a text encodes, (seeds,); NaN for seeds that were not judged."""
    pairs = [text[i : i + 2] for i in range(0, len(text), 2)]
    values = [np.nan if pair == NONE else DIGITS.index(pair[0]) * len(DIGITS) + DIGITS.index(pair[1]) for pair in pairs]
    return np.array(values) * STEP - FURTHEST


@dataclass(frozen=True)
class Draw:
    """A line of ``drawn.csv``: one seed.

    Attributes:
        seed: the seed.
        part: the part of the plan that is measured, WHOLE or LIGHT of ``study.controls.seeded``.
        rules: hash of the rules of all checks.
        judged, alarms: numbers of judged checks and of alarms; −1 while the seed is being measured.
    """

    seed: int
    part: str
    rules: str = NO_RULES
    judged: int = -1
    alarms: int = -1


@dataclass(frozen=True)
class Line:
    """A line of ``places.csv.gz`` without its key: the window, and two characters for each seed."""

    window_low: float
    window_high: float
    places: str = ""

    def at(self, position: int, value: float) -> Line:
        """Return the line with the position of one more seed; missing positions before it become ``..``.

        Parameters:
            position: the index of the seed.
            value: the position of the check in its window.
        """
        before = self.places[: 2 * position].ljust(2 * position, NONE[0])
        return replace(self, places=before + packed(value) + self.places[2 * position + 2 :])


@dataclass(frozen=True)
class Record:
    """The record of all seeds.

    Attributes:
        draws: the seeds, in the order in which they were drawn.
        lines: (label, key, case, rule) ↦ the positions of a check that was judged by this rule.
    """

    draws: tuple[Draw, ...] = ()
    lines: Mapping[Known, Line] = field(default_factory=dict)

    @classmethod
    def read(cls, directory: Path) -> Record:
        """Return the record of a result directory; it is empty if the directory has none.

        Raises:
            DataError: a file is damaged, or its lines do not fit the seeds.
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
            damaged += [] if _sound(text, len(draws)) else [(label, key, case, rule)]
            found[label, key, case, rule] = Line(low, high, text.rstrip(NONE[0]))
        if damaged or len({draw.seed for draw in draws}) < len(draws) or len(found) < len(lines):
            what = " ".join(damaged[0]) if damaged else "a repeated seed or row"
            raise DataError(f"{places.parent} is damaged: {what}; restore it, because lines are only added to it")
        return cls(draws, found)

    def write(self, directory: Path) -> None:
        """Write ``places.csv.gz``, then ``drawn.csv``, so that no seed counts as judged before its positions exist."""
        # All lines have the characters of all seeds, so that a seed that is missing in ``drawn.csv`` is noticed.
        wide = 2 * len(self.draws)
        known = [
            [*row, line.window_low, line.window_high, START + line.places.ljust(wide, NONE[0])]
            for row, line in self.lines.items()
        ]
        folder = directory / "data" / "seeds"
        write_packed(folder / "places.csv.gz", table_text(pd.DataFrame(known, columns=PLACES)))
        write_csv(folder / "drawn.csv", pd.DataFrame([asdict(draw) for draw in self.draws], columns=DRAWN))

    def drawn(self, seed: int, part: str) -> Record:
        """Return the record with a new seed, which is measured next; raises DataError if the record has the seed."""
        if any(draw.seed == seed for draw in self.draws):
            raise DataError(f"seed {seed} is already in the record, in which nothing is replaced: draw another seed")
        return replace(self, draws=(*self.draws, Draw(seed, part)))

    def pending(self) -> Draw | None:
        """Return the seed that was drawn but not judged; None if there is none."""
        return next((draw for draw in self.draws if draw.judged < 0), None)

    def judged(
        self, seed: int, verdicts: Sequence[Verdict], rules: Mapping[RowKey, str], claimed: Callable[[str], bool]
    ) -> Record:
        """Return the record with the verdicts on a seed.

        Parameters:
            seed: a seed that was drawn and not judged.
            verdicts: the checks on the meshes of this seed.
            rules: key of a check ↦ fingerprint of its rule.
            claimed: function that returns for a label whether alarms of its checks are counted.

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
        """Compare the recorded positions of a seed with new verdicts by the same rules.

        Returns:
            The number of positions that agree, and the number of those that differ.
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


def _sound(places: str, seeds: int) -> bool:
    """Return whether a text encodes the positions of at most ``seeds`` seeds."""
    pairs = [places[i : i + 2] for i in range(0, len(places), 2)]
    return len(pairs) <= seeds and all(pair == NONE or (len(pair) == 2 and set(pair) <= set(DIGITS)) for pair in pairs)
