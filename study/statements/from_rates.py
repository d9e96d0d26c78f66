"""Two statements that need no measurement: they are judged from the errors in ``rates.csv``.

The modules ``prop_5_3`` and ``prop_5_4`` measure these errors. The statements are:

* (5.23), the interpolation error, for the cases of Proposition 5.4: it must agree with its leading term, which other
  code computes from second derivatives of u.
* (5.36), the regularity that Proposition 5.4 assumes: for cases without it, the observed order on uniform meshes is
  compared with the order that proofs give for their regularity (``manufactured.proved``). Predicted is that it is at
  least the proved order less 0.1: for junction 1/2, from the theorem on half a derivative in paper/velocity.tex; the
  proof of Proposition 5.4 gives 1/4 there.
"""

from dataclasses import replace

from study.ledger.check import ENOUGH, Groups, consequence
from study.ledger.quantities import finest_quotient, over_refinements
from study.ledger.window import Window, around, at_least
from study.statements.prop_5_4 import FromRates
from study.statements.shared.base import Judged
from study.statements.shared.meshes import LEADING, split, value_of_case

ROOM = 0.1
"""Observed orders approach the proved order from below, up to this number on these levels."""


class SizeOfInterpolation(FromRates):
    """Judges the interpolation error ‖u − Π^h u‖_V divided by its leading term, for the cases of Proposition 5.4."""

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


SEEN = consequence(
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
        reported = replace(SEEN, window=proved)
        enough = at_least(proved.low - ROOM, "the proved order, with room for coarse meshes")
        judged = replace(SEEN, key="order-proved", window=enough, if_missed="")
        return [(check, uniform) for check in ((reported, judged) if uniform else (reported,))]
