"""Proposition 5.3: ‖u − u^h‖_{L∞(0,T;V)} → 0, however rough the solution.

**Measured** as for Proposition 5.4 (``prop_5_4.measure``), on exact solutions that miss its regularity: singular
corners, fronts, interfaces that the mesh does not meet, loads that are hardly continuous in time.

**Judged.** No rate is claimed, so none is required: errors must fall from level to level, and a fit e = e∞ + C h^s must
exclude a positive limit e∞. The observed order is compared with the order that the regularity predicts. The place of a
resting front within its cell alternates between levels, so orders are taken over two refinements. On random meshes
levels differ by chance, too, and from one seed to the next the limit scatters by up to a quarter of its window: there
the other two criteria decide. Meshes graded towards a corner regain the order 1.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import pandas as pd

from study.ledger.criterion import (
    ENOUGH,
    Criterion,
    Groups,
    Measured,
    Observation,
    Rule,
    between_levels,
    by_family,
    exactly,
    greatest_ratio,
)
from study.ledger.orders import limit
from study.ledger.verdict import Verdict
from study.ledger.window import STEEPER, Window, around, at_most
from study.statements.from_rates import GRADED
from study.statements.prop_5_4 import EVIDENCE, SIZES, Rates
from study.statements.shared.meshes import split_random

LEVELS = ENOUGH + 1
"""Two refinements twice."""
LIMIT = at_most(0.1, "of the two finest errors, if s is the predicted order", low=-math.inf)
"""Over two refinements an order s − δ instead of s looks like e∞/e = (1 − 4^{−δ})/(1 − 4^{−s}): for s = 1/4
the window answers to δ = 0.02, as sharp as the place of a front within its cell lets orders be."""


class Convergence(Rates):
    """Proposition 5.3 on the exact solutions that miss (5.36)."""

    label = "Prop. 5.3"
    claim = "‖u − u^h‖_{L∞(0,T;V)} → 0"

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        found = []
        for case, mine in rows[rows["claim"] == self.label].groupby("case", sort=False):
            expected = float(mine["expected_order"].iloc[0])
            rules = rules_of(by_family(mine), expected)
            found += [criterion.verdict(self, str(case), groups) for criterion, groups in rules]
        return found


def rules_of(groups: Groups, expected: float) -> Iterator[tuple[Rule, Groups]]:
    """Yield the criteria for a case with a predicted order, each with the mesh families on which it is judged."""
    uniform = {name: group for name, group in groups.items() if name != GRADED}
    graded = {name: group for name, group in groups.items() if name == GRADED}
    falling = at_most(0.999, "on every level")
    yield greatest_ratio("falling", "ratio of consecutive errors", falling, "error", LEVELS), groups
    by_chance, others = split_random(uniform)
    steeper = f"s is {STEEPER:g} above the predicted order, the largest s that the row on orders allows"
    if others:
        yield _limit("limit", LIMIT, expected), others
        yield Observation(_limit("limit-steeper", Window(), expected + STEEPER), steeper), others
    if by_chance:
        yield Observation(_limit("limit-random", Window(), expected), "it varies from seed to seed"), by_chance
    yield _order("order", "order seen", expected), uniform
    if graded:
        yield _order("order-graded", "order seen on graded meshes", 1.0), graded
    for criterion in (SIZES, *EVIDENCE):
        yield criterion, groups


def _limit(key: str, window: Window, expected: float) -> Criterion:
    """Return the criterion for the limit, from the last four levels in pairs, if the order is the expected one.

    The limit depends on the order, which only the row on orders determines.
    """

    def measure(group: pd.DataFrame) -> Measured:
        return exactly(limit(group["h"].to_numpy(), group["error"].to_numpy(), expected))

    return Criterion(key, "limit e∞ of e = e∞ + C h^s", window, measure, ("error",), LEVELS)


def _order(key: str, quantity: str, expected: float) -> Criterion:
    window = around(expected, STEEPER, "over two refinements (no rate is claimed)")
    return between_levels(key, quantity, window, "error", 2, LEVELS)
