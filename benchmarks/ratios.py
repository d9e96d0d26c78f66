"""The table of ratios from the timings of pytest-benchmark, and warnings where one got worse.

    python -m benchmarks.ratios TIMINGS.json [DIRECTORY]

Seconds belong to a machine, ratios hardly: only these are compared with the committed table.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from benchmarks.level import STEPS
from benchmarks.report import RESULTS, committed, write

KEY = ["ratio", "case", "family", "n"]
WORSE = 1.2
"""A ratio that grew by more than this factor is reported."""
Timings = Mapping[str, Mapping[str, Any]]


@dataclass(frozen=True)
class Ratio:
    """Seconds of one quantity over those of others.

    Attributes:
        name: as in the table.
        over: the quantity.
        under: quantity ↦ how often.
        goal: what it should not exceed.
    """

    name: str
    over: str
    under: Mapping[str, int]
    goal: float

    def row(self, timings: Timings) -> dict[str, Any]:
        """The ratio of medians, and its range when both are at the ends of their quartiles."""

        def under(statistic: str) -> float:
            return float(sum(count * timings[quantity][statistic] for quantity, count in self.under.items()))

        over = timings[self.over]
        value = over["median"] / under("median")
        return {
            "ratio": self.name,
            "value": value,
            "low": over["q1"] / under("q3"),
            "high": over["q3"] / under("q1"),
            "goal": self.goal,
            "met": met(value, self.goal),
            "numerator_seconds": over["median"],
            "denominator_seconds": under("median"),
            "rounds": over["rounds"],
        }


@dataclass(frozen=True)
class Count:
    """A number that was counted, not timed: ``name`` in the table, ``of`` in the record, and its goal."""

    name: str
    of: str
    goal: float

    def row(self, value: float) -> dict[str, Any]:
        """The number as a ratio without spread."""
        same = dict.fromkeys(("value", "low", "high"), float(value))
        return {"ratio": self.name, **same, "goal": self.goal, "met": met(value, self.goal), "rounds": 1}


def met(value: float, goal: float) -> str:
    return "yes" if value <= goal else "no"


RATIOS = (
    Ratio("contact step / bare solve", "step", {"solve between steps": 1}, 1.3),
    Ratio(f"level / (factorisation + {STEPS} solves)", "level", {"factorisation": 1, "solve": STEPS}, 3.0),
    Ratio("quick study in one process / fixed work", "quick study", {"fixed work": 1}, 110.0),
    Ratio("factorisation / SuperLU's", "factorisation", {"library factorisation": 1}, 1.0),
    Ratio("bare solve / SuperLU's", "solve", {"library solve": 1}, 1.0),
    Ratio(
        f"level / SuperLU's (factorisation + {STEPS} solves)",
        "level",
        {"library factorisation": 1, "library solve": STEPS},
        3.0,
    ),
)
COUNTS = (
    Count("solves in the worst step, nonlinear law", "most_solves", 6.0),
    Count("factorisations per trajectory, nonlinear law", "factorisations", 1.0),
)


def table(benchmarks: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """One row per ratio and place, from the list ``benchmarks`` of a file of pytest-benchmark."""
    rows = []
    for place, timings in _by_place(benchmarks):
        rows += [{**place, **ratio.row(timings)} for ratio in RATIOS if {ratio.over, *ratio.under} <= timings.keys()]
        counted = timings.get("nonlinear", {})
        rows += [{**place, **count.row(counted[count.of])} for count in COUNTS if count.of in counted]
    found = pd.DataFrame(rows).sort_values(KEY, kind="stable", ignore_index=True)
    columns = [*KEY, *found.columns.difference(KEY, sort=False)]
    return found[columns]


def _by_place(benchmarks: Sequence[Mapping[str, Any]]) -> Iterator[tuple[dict[str, Any], dict[str, dict[str, Any]]]]:
    """Each place with quantity ↦ its statistics and counts; ``beside`` holds what was timed in turn with a quantity."""
    found: dict[tuple[Any, ...], dict[str, dict[str, Any]]] = {}
    for benchmark in benchmarks:
        info = benchmark["extra_info"]
        place = tuple(info[name] for name in ("case", "family", "n", "dofs"))
        timings = found.setdefault(place, {})
        timings |= {info["quantity"]: {**benchmark["stats"], **info}, **info.get("beside", {})}
    for place, timings in found.items():
        yield dict(zip(("case", "family", "n", "dofs"), place, strict=True)), timings


def regressions(new: pd.DataFrame, old: pd.DataFrame) -> list[str]:
    """A sentence for every ratio that is more than ``WORSE`` times what it was."""
    both = new.merge(old, on=KEY, suffixes=("", "_old"))
    worse = both[both["value"] > WORSE * both["value_old"]]
    return [
        f"{row['ratio']} of {row['case']} on {row['family']} meshes, n = {row['n']}: {row['value']:.3g}, "
        f"was {row['value_old']:.3g}"
        for row in worse.to_dict("records")
    ]


def main(timings: Path, directory: Path = RESULTS) -> None:
    """Write the table, show it, and warn; nothing here fails."""
    new = table(json.loads(timings.read_text(encoding="utf-8"))["benchmarks"])
    old = committed(RESULTS / "ratios.csv")
    notes = [
        "Medians; *low* and *high* from the quartiles of both timings. Contact steps and bare solves take turns. "
        f"A level is everything from the mesh to the error at each of {STEPS} midpoint steps, but for the compilation "
        "of the formulas (SymPy to functions), which a process does once for a case. A row of the "
        "study is more: two trajectories, one with twice the steps, and a check of its quadrature. SuperLU is SciPy's, "
        "in symmetric mode with a minimum degree order: a measure from outside.",
    ]
    write(directory, "ratios", new, "Ratios", notes)
    print((directory / "ratios.md").read_text(encoding="utf-8"))
    if old is None:
        print("no committed table to compare with")
        return
    for line in regressions(new, old):
        print(f"WARNING: {line}")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
