"""Proposition 5.3: ‖u − u^h‖_{L∞(0,T;V)} → 0 for every solution, without an assumption on its regularity.

**The measurement** is the same as for Proposition 5.4 (``prop_5_4.measure``). The exact solutions violate the
regularity assumption (5.36) of that proposition: they have singular corners or fronts, interfaces that do not lie on
the mesh, or loads that are hardly continuous in time.

**The judgement.** The paper claims no order. Errors must fall from level to level, and in a fit e = e∞ + C h^s the
limit e∞ must be small. The observed order is compared with the order that the regularity predicts. It is computed over
two refinements, because the position of a resting front within its cell alternates between levels. On random meshes the
limit e∞ varies from seed to seed by up to a quarter of its window, so it is not judged there. On meshes graded towards
a corner the order must be 1.
"""

import math
from dataclasses import replace

from study.ledger.check import ENOUGH, Check, Groups, consequence, paper_claim
from study.ledger.orders import limit
from study.ledger.quantities import of_errors, over_refinements, ratios
from study.ledger.window import STEEPER, Window, around, at_most
from study.statements.prop_5_4 import EVIDENCE, SIZES, Rates
from study.statements.shared.base import Judged
from study.statements.shared.meshes import split, split_random, value_of_case

LEVELS = ENOUGH + 1
"""Smallest number of levels that gives two observed orders over two refinements each."""
LIMIT = at_most(0.1, "of the two finest errors, if s is the predicted order", low=-math.inf)
"""Window of the limit e∞, relative to the two finest errors.

Over two refinements an order s − δ instead of s has the same effect as a limit e∞/e = (1 − 4^{−δ})/(1 − 4^{−s}). For
s = 1/4 this window corresponds to δ = 0.02. Observed orders are not more accurate than this, because the position of a
front within its cell differs from level to level."""


NO_RATE = "over two refinements (no rate is claimed)"


class Convergence(Rates):
    """Judges Proposition 5.3 on exact solutions that violate the regularity assumption (5.36) of Proposition 5.4."""

    label = proposition = "Prop. 5.3"
    claim = "‖u − u^h‖_{L∞(0,T;V)} → 0"

    def checks_of(self, case: str, groups: Groups) -> Judged:
        expected = value_of_case(groups, "expected_order")
        (uniform, graded) = split(groups, lambda mesh: mesh.uniform)
        falling = at_most(0.999, "on every level")
        ratio = "ratio of consecutive errors"
        yield paper_claim("falling", ratio, ratios("error"), falling, levels=LEVELS), groups
        by_chance, others = split_random(uniform)
        steeper = f"s is {STEEPER:g} above the predicted order, the largest s that the check of the order allows"
        if others:
            yield _limit("limit", LIMIT, expected), others
            yield replace(_limit("limit-steeper", Window(), expected + STEEPER), if_missed=steeper), others
        if by_chance:
            unjudged = _limit("limit-random", Window(), expected)
            yield replace(unjudged, if_missed="the limit varies with the seed"), by_chance
        order = consequence(
            "order", "observed order", over_refinements("error", 2), around(expected, STEEPER, NO_RATE), levels=LEVELS
        )
        yield order, uniform
        if graded:
            of_graded = replace(order, key="order-graded", quantity="observed order on graded meshes")
            yield replace(of_graded, window=around(1.0, STEEPER, NO_RATE)), graded
        yield from ((criterion, groups) for criterion in (SIZES, *EVIDENCE))


def _limit(key: str, window: Window, expected: float) -> Check:
    """Return the check of the limit e∞ of the error for h → 0, which must be small.

    The limit is computed from the last four levels with the predicted order s. These levels cannot determine both the
    limit and the order, so another check judges the order.
    """
    quantity = "limit e∞ of the error e for h → 0, from e = e∞ + C h^s"
    value = of_errors("error", lambda h, error: limit(h, error, expected))
    return paper_claim(key, quantity, value, window, levels=LEVELS)
