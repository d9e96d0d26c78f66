"""Random problems with known solutions: is an error ever outside of its bounds?

A trial is *enclosed* if at all knots and at some random times the error lies inside both bounds, *refused* if the
program says in words that it cannot bound it or that it only estimates it, *outside* otherwise. ``blind`` says where
the error lies for the same data known at samples only, with nothing added for what lies between them.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from benchmarks.trials.known import Trial, random_trial
from benchmarks.trials.record import made
from manufactured.data import LoadError
from manufactured.tensors import Array
from study.bound.bounded import BoundedSolution
from study.bound.problem import BoundError
from study.bound.remainders import GUARANTEED
from study.present.pages import markdown

COUNT, TIMES = 200, 3
"""Number of trials with bumps, and of trials with conditions; number of random times at which errors are tried."""
ROUNDING = 1e-6
"""Relative slack: of the quadrature of known errors, and of rounding."""
ENCLOSED, REFUSED, OUTSIDE = "enclosed", "refused", "outside"


def outcome(trial: Trial, found: BoundedSolution, times: Array) -> tuple[str, float]:
    """Whether the errors at the knots and at some times lie inside, and the largest of them."""
    known, enclosure, plain = trial.known, found.enclosure, found.plain
    errors = np.array([known.error(found.computed, time) for time in enclosure.times])
    others = np.array([known.error(found.computed, time) for time in times])
    inside = (enclosure.lower * (1 - ROUNDING) <= errors).all() and (errors <= enclosure.upper * (1 + ROUNDING)).all()
    every = np.concatenate([others, errors])
    highest = min(enclosure.highest, plain.highest) * (1 + ROUNDING)
    inside &= bool((every <= highest).all()) and every.max() >= enclosure.lowest * (1 - ROUNDING)
    return ENCLOSED if inside else OUTSIDE, float(every.max())


def row(seed: int) -> dict[str, Any]:
    """One trial."""
    trial = random_trial(seed, conditions=seed >= COUNT)
    known = trial.known
    features = {
        "level": trial.level,
        "steps": trial.steps,
        "family": trial.family.name,
        "slope": round(float(known.turn[1] / known.turn[0]), 2),
        "zone": int(known.zone is not None),
        "stiff": _short(np.linalg.norm(known.local.G.matrix) / np.linalg.norm(known.local.A.matrix)),
        # In cells, and in periods a step.
        "width": _short(min((one.width * trial.level for one in known.features), default=np.nan)),
        "periods": _short(max((one.frequency / trial.steps for one in known.features), default=np.nan)),
    }
    try:
        found = trial.bounded()
    except (BoundError, LoadError) as error:
        return features | {"error": np.nan, "low": np.nan, "high": np.nan, "blind": "", "outcome": f"refused: {error}"}
    times = np.random.default_rng(seed).random(TIMES)
    verdict, largest = outcome(trial, found, times)
    if found.enclosure.evidence.kind != GUARANTEED:
        verdict = REFUSED
    blind = trial.bounded(replace(known.data))  # a copy has no formulas
    ends = {"low": _short(found.enclosure.lowest), "high": _short(min(found.enclosure.highest, found.plain.highest))}
    return features | {"error": _short(largest), **ends, "blind": outcome(trial, blind, times)[0], "outcome": verdict}


def _short(x: float) -> float:
    return float(f"{x:.3g}")


def table(out: Path) -> pd.DataFrame:
    """``random.csv``."""
    return made(out / "random.csv", range(2 * COUNT), row)


SMALL, QUICK = 0.1, 1.0
"""Bumps that are narrower, in cells, and data that are quicker, in periods a step, are not seen by samples."""


def summary(found: pd.DataFrame) -> str:
    """How many trials of every kind there are and what became of them, in Markdown."""
    unseen, conditions = (found["width"] < SMALL) | (found["periods"] > QUICK), found["trial"] >= COUNT
    kinds = {
        "no bumps": found["width"].isna() & ~conditions,
        f"bumps of {SMALL:g} cells or more, at most {QUICK:g} period a step": found["width"].notna() & ~unseen,
        "smaller or quicker ones": unseen,
        "bands, kinks and jumps, written with conditions": conditions,
        "all": pd.Series(True, index=found.index),
        "of them on a slanted foundation": found["slope"] != 0,
        "of them with a zone of contact": found["zone"] == 1,
    }
    lines = []
    for name, which in kinds.items():
        mine = found[which]
        verdicts = [mine["outcome"] == ENCLOSED, mine["outcome"].str.startswith(REFUSED), mine["outcome"] == OUTSIDE]
        wide = (mine["high"] / mine["error"]).median()
        counts = [str(int(one.sum())) for one in (*verdicts, mine["blind"] == OUTSIDE)]
        lines.append([name, str(len(mine)), *counts, f"{wide:.2g}"])
    header = [
        "data",
        "problems",
        "enclosed",
        "refused",
        "outside",
        "outside by samples alone",
        "median of bound / error",
    ]
    return markdown(header, lines)
