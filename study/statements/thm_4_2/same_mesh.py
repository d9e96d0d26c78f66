"""Theorem 4.2 on one mesh: the two problems agree at every step, within what the duality gaps of the solver allow."""

from __future__ import annotations

import pandas as pd

from study.ledger.criterion import Criterion, Measured
from study.ledger.measures import greatest, largest
from study.ledger.window import above_nothing, at_most
from study.statements.thm_4_2.gaps import OnOneMesh

AGREEMENT = above_nothing(1e-7, "at every step")
INSIDE = at_most(1e-7, "at every step")
"""A displacement inside K^h violates nothing."""
SHARP = above_nothing(1e-5, "32 steps, each the root of a gap of 1e-15, and norms 10 apart")

BOUNDS = ("displacement_bound", "stress_bound")


def allowed(what: str) -> Criterion:
    """A gap over what the duality gaps allow for it, on every level."""
    gap, bound = columns = f"{what}_gap", f"{what}_bound"

    def measure(group: pd.DataFrame) -> Measured:
        return greatest((group[gap] / group[bound]).to_numpy())

    quantity = f"{what} of Problem 3.2 − 3.1 / what the gap allows"
    return Criterion(what, quantity, above_nothing(1.0, "proved"), measure, columns)


def sharp(group: pd.DataFrame) -> Measured:
    """What the duality gaps allow for both."""
    return greatest(group[list(BOUNDS)].to_numpy().max(axis=1))


class SameMesh(OnOneMesh):
    """The gaps over what is allowed, and what of Problem 3.2 is never imposed."""

    label = "Thm 4.2"
    claim = "Problem 3.2 on the strains of V^h and Problem 3.1 have one solution"
    rules = (
        allowed("displacement"),
        allowed("stress"),
        Criterion("allowed", "what the gap allows / size of the solution", SHARP, sharp, BOUNDS),
        largest("admissibility", "σ^h ∈ Σ^h(t)", AGREEMENT, "admissibility"),
        largest("energy", "(σ, ε(u))_Q = (f, u)_V, (4.14)", AGREEMENT, "energy_gap"),
        largest("membership", "u ∈ K^h though never imposed", INSIDE, "membership"),
    )
