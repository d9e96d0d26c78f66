"""Proposition 5.3, and the other statements that are judged from the errors in ``rates.csv``.

They are (5.23), the size of the interpolation error; (5.36), the regularity that Proposition 5.4 assumes; and, beyond
the paper, bodies with an initial gap.
"""

import math
from dataclasses import replace

from manufactured.case import INITIAL_GAP
from study.ledger.check import ENOUGH, Check, Groups, consequence, paper_claim
from study.ledger.orders import limit
from study.ledger.quantities import (
    finest_quotient,
    of_errors,
    over_refinements,
    ratios,
)
from study.ledger.window import STEEPER, Window, around, at_least, at_most
from study.statements.prop_5_4 import EVIDENCE, SIZE_CHECK, FirstOrder, FromRates, Rates
from study.statements.shared.base import Judged
from study.statements.shared.meshes import (
    LEADING,
    split,
    split_random,
    value_of_case,
)

ROUGH_LEVELS = ENOUGH + 1
"""Smallest number of levels that gives two observed orders over two refinements each."""
ERROR_LIMIT = at_most(0.1, "of the two finest errors, if s is the predicted order", low=-math.inf)
"""Window of the limit e∞, relative to the two finest errors.

Over two refinements an order s − δ instead of s has the same effect as a limit e∞/e = (1 − 4^{−δ})/(1 − 4^{−s}). For
s = 1/4 this window corresponds to δ = 0.02. Observed orders are not more accurate than this, because the position of a
front within its cell differs from level to level."""


OVER_TWO_REFINEMENTS = "over two refinements (no rate is claimed)"


class Convergence(Rates):
    """Judges Proposition 5.3 on exact solutions that violate the regularity assumption (5.36) of Proposition 5.4.

    Proposition 5.3: ‖u − u^h‖_{L∞(0,T;V)} → 0 for every solution, without an assumption on its regularity.

    **The measurement** is the same as for Proposition 5.4 (``prop_5_4.measure``). The exact solutions violate the
    regularity assumption (5.36) of that proposition: they have singular corners or fronts, interfaces that do not lie
    on the mesh, or loads that are hardly continuous in time.

    **The judgement.** The paper claims no order. Errors must fall from level to level, and in a fit e = e∞ + C h^s the
    limit e∞ must be small. The observed order is compared with the order that the regularity predicts. It is computed
    over two refinements, because the position of a resting front within its cell alternates between levels. On random
    meshes the limit e∞ varies from seed to seed by up to a quarter of its window, so it is not judged there. On meshes
    graded towards a corner the order must be 1.
    """

    label = proposition = "Prop. 5.3"
    claim = "‖u − u^h‖_{L∞(0,T;V)} → 0"

    def checks_of(self, case: str, groups: Groups) -> Judged:
        expected = value_of_case(groups, "expected_order")
        (uniform, graded) = split(groups, lambda mesh: mesh.uniform)
        falling = at_most(0.999, "on every level")
        ratio = "ratio of consecutive errors"
        yield paper_claim("falling", ratio, ratios("error"), falling, levels=ROUGH_LEVELS), groups
        by_chance, others = split_random(uniform)
        steeper = f"s is {STEEPER:g} above the predicted order, the largest s that the check of the order allows"
        if others:
            yield _limit("limit", ERROR_LIMIT, expected), others
            yield replace(_limit("limit-steeper", Window(), expected + STEEPER), if_missed=steeper), others
        if by_chance:
            unjudged = _limit("limit-random", Window(), expected)
            yield replace(unjudged, if_missed="the limit varies with the seed"), by_chance
        order = consequence(
            "order",
            "observed order",
            over_refinements("error", 2),
            around(expected, STEEPER, OVER_TWO_REFINEMENTS),
            levels=ROUGH_LEVELS,
        )
        yield order, uniform
        if graded:
            of_graded = replace(order, key="order-graded", quantity="observed order on graded meshes")
            yield replace(of_graded, window=around(1.0, STEEPER, OVER_TWO_REFINEMENTS)), graded
        yield from ((criterion, groups) for criterion in (SIZE_CHECK, *EVIDENCE))


def _limit(key: str, window: Window, expected: float) -> Check:
    """Return the check of the limit e∞ of the error for h → 0, which must be small.

    The limit is computed from the last four levels with the predicted order s. These levels cannot determine both the
    limit and the order, so another check judges the order.
    """
    quantity = "limit e∞ of the error e for h → 0, from e = e∞ + C h^s"
    value = of_errors("error", lambda h, error: limit(h, error, expected))
    return paper_claim(key, quantity, value, window, levels=ROUGH_LEVELS)


PROVED_ORDER_TOLERANCE = 0.1
"""Observed orders approach the proved order from below, up to this number on these levels."""


class SizeOfInterpolation(FromRates):
    """Judges the interpolation error ‖u − Π^h u‖_V divided by its leading term, for the cases of Proposition 5.4.

    Two statements that need no measurement: they are judged from the errors in ``rates.csv``.

    The classes ``Convergence`` and ``FirstOrder`` measure these errors. The statements are:

    * (5.23), the interpolation error, for the cases of Proposition 5.4: it must agree with its leading term, which
      other code computes from second derivatives of u.
    * (5.36), the regularity that Proposition 5.4 assumes: for cases without it, the observed order on uniform meshes is
      compared with the order that proofs give for their regularity (``manufactured.proved``). Predicted is that it is
      at least the proved order less 0.1: for junction 1/2, from the theorem on half a derivative in paper/velocity.tex;
      the proof of Proposition 5.4 gives 1/4 there.
    """

    label = "(5.23)"
    claim = "‖v − Π^h v‖_V ≤ c h |v|_{H²}"
    proposition = "Prop. 5.4"
    checks = (
        consequence(
            "leading-term",
            "‖u − Π^h u‖_V / leading term",
            finest_quotient("interpolation_error", LEADING),
            around(1, 0.05, "on the finest level"),
        ),
    )


SEEN_ORDER = consequence(
    "order",
    "observed order on uniform meshes",
    over_refinements("error", 2),
    Window(),
    levels=ENOUGH,
    if_missed="the paper claims an order only under (5.36)",
)


class RegularityNeeded(FromRates):
    """Compares observed orders with proved orders, for solutions without the regularity (5.36).

    Whether the order is reached on these levels is reported and not judged, because the paper claims no order for these
    solutions. An order that misses a proved order by more than 0.1 fails.
    """

    label = "(5.36)"
    claim = "does Prop. 5.4 need the regularity (5.36) that it assumes?"
    proposition = "Prop. 5.3"

    def checks_of(self, case: str, groups: Groups) -> Judged:
        proved = at_least(value_of_case(groups, "proved_order"), "the order that the proof gives")
        uniform, _ = split(groups, lambda family: family.uniform)
        reported = replace(SEEN_ORDER, window=proved)
        enough = at_least(proved.low - PROVED_ORDER_TOLERANCE, "the proved order, with room for coarse meshes")
        judged = replace(SEEN_ORDER, key="order-proved", window=enough, if_missed="")
        return [(check, uniform) for check in ((reported, judged) if uniform else (reported,))]


class InitialGap(Rates):
    """Measures and judges the errors ‖u − u^h‖_V for the cases with an initial gap.

    Beyond the paper: an initial gap g(s) ≥ 0 between the undeformed body and the foundation.

    **The claim.** In the paper the undeformed body touches the foundation: K = {v : v_ν ≤ 0 on Γ3}. Here K = {v : v_ν ≤
    g on Γ3} with a smooth g that does not depend on time, and Problem 5.1 is solved in K^h = {v ∈ V^h : v_ν ≤ g at the
    vertices of Γ3}. The paper claims nothing about this problem. This study claims ‖u − u^h‖_{L∞(0,T;V)} = O(h) for
    solutions with the regularity (5.36), and convergence for others.

    **The reason.** Let d ∈ V be smooth with d_ν = g on Γ3. Then w = u − d satisfies w_ν ≤ 0 on Γ3, the condition of the
    paper, and w^h = u^h − Π^h d satisfies it at the vertices. The function w solves the variational inequality of u
    with an additional load, which belongs to −d. Moreover Π^h d − d = O(h) by (5.23). So the proof of Proposition 5.4
    holds for w. The window of the order was set before anything was measured.

    **The measurement** is the same as for Proposition 5.4 (``prop_5_4.measure``), on all cases with an initial gap and
    all mesh families that can mesh their bodies. The contact solver gets the values of g at the vertices.

    **The judgement** uses the criteria of Proposition 5.4 and (5.23) if the solution satisfies (5.36), otherwise the
    criteria of Proposition 5.3. If g is forgotten or has the wrong sign, the error does not fall with h
    (``study.controls``).
    """

    label = proposition = INITIAL_GAP
    claim = "‖u − u^h‖_{L∞(0,T;V)} = O(h) for K = {v : v_ν ≤ g on Γ3}; the paper has g = 0"
    initial_gap = True

    def checks_of(self, case: str, groups: Groups) -> Judged:
        smooth = value_of_case(groups, "expected_order") >= 1
        for statement in (FirstOrder(), SizeOfInterpolation()) if smooth else (Convergence(),):
            yield from statement.checks_of(case, groups)
