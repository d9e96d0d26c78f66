"""The record of seeds that were drawn, and where every row of the ledger lay in its window: what is added to stays.

``data/seeds/drawn.csv`` has one line for each seed in the order in which they were drawn: the seed, the part of the
plan that was measured, the rules in force (a hash), rows judged and alarms; the last two are −1 while it is being
measured. A seed is entered when it is drawn, before anything is measured, so that none can be left out afterwards.

``data/seeds/places.csv.gz`` has one line for each row of the ledger and rule that it was judged by: two characters for
each seed, in the same order. They write the place in the window, −2 … 2, in 1/1024ths, two digits of base 64; ``..``
says that this seed was not judged by this rule. An alarm is a place beyond −1 … 1, of a row that holds one within. As a
rule of another row, window or level is another line, seeds that were judged before a change count for nothing after it.

All values are kept, and not their moments, as a tail is not known by moments. Two digits resolve a thousandth of half a
window. Packed, as most of the text is names and seeds that a row was not judged on, a thousand rows and 150 seeds take
200 kB.
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
"""For a seed that was not judged."""
START = ":"
"""Before the places of a line, so that no program takes them for a number."""
NO_RULES = "-"
STEP = 1 / 1024
FURTHEST = 2.0
RowKey = tuple[str, str, str]
"""(label, key, case)."""
Known = tuple[str, str, str, str]
"""(label, key, case, rule)."""
MADE = "study seeds"
DRAWN = ["seed", "part", "rules", "judged", "alarms"]
PLACES = ["label", "key", "case", "rule", "window_low", "window_high", "places"]


def place(verdict: Verdict) -> float:
    """Where a row lies in its window: beyond ±1 if and only if it does not hold; 0 for one without numbers."""
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
    # What is not a number, or undecided within its window, is an alarm as well.
    beyond = np.nan_to_num(found, nan=FURTHEST)
    return float(np.copysign(np.clip(abs(beyond), 1 + 2 * STEP, FURTHEST), beyond))


def two_sided(low: float, high: float) -> bool:
    """Whether both ends of a window are ends for what lies in it."""
    return bool(np.isfinite([low, high]).all() and not 0 <= low <= SMALL * high)


def packed(value: float) -> str:
    """Two digits for a place."""
    number = min(round((value + FURTHEST) / STEP), len(DIGITS) ** 2 - 1)
    return DIGITS[number // len(DIGITS)] + DIGITS[number % len(DIGITS)]


def unpacked(text: str) -> Array:
    """The places in a line, not a number where there is none, (seeds,)."""
    pairs = [text[i : i + 2] for i in range(0, len(text), 2)]
    values = [np.nan if pair == NONE else DIGITS.index(pair[0]) * len(DIGITS) + DIGITS.index(pair[1]) for pair in pairs]
    return np.array(values) * STEP - FURTHEST


@dataclass(frozen=True)
class Draw:
    """A line of ``drawn.csv``; ``judged`` is −1 while it is being measured."""

    seed: int
    part: str
    rules: str = NO_RULES
    judged: int = -1
    alarms: int = -1


@dataclass(frozen=True)
class Line:
    """A line of ``places.csv.gz``, without what it is known by: the window, and two characters for each seed."""

    window_low: float
    window_high: float
    places: str = ""

    def at(self, position: int, value: float) -> Line:
        """With the place on the seed at a position; places that lack before it are none."""
        before = self.places[: 2 * position].ljust(2 * position, NONE[0])
        return replace(self, places=before + packed(value) + self.places[2 * position + 2 :])


@dataclass(frozen=True)
class Record:
    """All seeds that were drawn, in order, and what was found: (label, key, case, rule) ↦ line."""

    draws: tuple[Draw, ...] = ()
    lines: Mapping[Known, Line] = field(default_factory=dict)

    @classmethod
    def read(cls, directory: Path) -> Record:
        """The record of a result directory, an empty one where there is none.

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
            what = " ".join(damaged[0]) if damaged else "a seed or a row that stands twice"
            raise DataError(f"{places.parent} is damaged: {what}; restore it, as it is only ever added to")
        return cls(draws, found)

    def write(self, directory: Path) -> None:
        """Both files; what is found of a seed stands in the first before the second says that it was judged."""
        # As many as there are seeds, so that a seed that is missing from the other file is noticed, judged or not.
        wide = 2 * len(self.draws)
        known = [
            [*row, line.window_low, line.window_high, START + line.places.ljust(wide, NONE[0])]
            for row, line in self.lines.items()
        ]
        folder = directory / "data" / "seeds"
        write_packed(folder / "places.csv.gz", table_text(pd.DataFrame(known, columns=PLACES)))
        write_csv(folder / "drawn.csv", pd.DataFrame([asdict(draw) for draw in self.draws], columns=DRAWN))

    def drawn(self, seed: int, part: str) -> Record:
        """With a seed that is to be measured."""
        if any(draw.seed == seed for draw in self.draws):
            raise DataError(f"seed {seed} is in the record already, and nothing in it is replaced: draw another one")
        return replace(self, draws=(*self.draws, Draw(seed, part)))

    def pending(self) -> Draw | None:
        """The seed that was drawn and not judged, if there is one."""
        return next((draw for draw in self.draws if draw.judged < 0), None)

    def judged(
        self, seed: int, verdicts: Sequence[Verdict], rules: Mapping[RowKey, str], claimed: Callable[[str], bool]
    ) -> Record:
        """With what was found on a seed that was drawn; the lines of other rules stay as they are.

        ``claimed`` says of a label whether an alarm of its rows counts.
        """
        position = [draw.seed for draw in self.draws].index(seed)
        if self.draws[position].judged >= 0:
            raise DataError(f"seed {seed} was judged already, and nothing in the record is replaced")
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
        """How many places of a seed are those of verdicts by the same rule, up to a step, and how many are not."""
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
    """A letter, so that it is no number, and nine hexadecimal digits of the SHA-256 of a text representation."""
    return "r" + hashlib.sha256(repr(content).encode()).hexdigest()[:9]


def _sound(places: str, seeds: int) -> bool:
    """Whether a line has two digits for each of at most so many seeds."""
    pairs = [places[i : i + 2] for i in range(0, len(places), 2)]
    return len(pairs) <= seeds and all(pair == NONE or (len(pair) == 2 and set(pair) <= set(DIGITS)) for pair in pairs)
