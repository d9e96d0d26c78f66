"""Three statements that need no measurement: they are judged from the errors in ``rates.csv``.

The modules ``prop_5_3`` and ``prop_5_4`` measure these errors. The statements are:

* (5.23), the interpolation error, for the cases of Proposition 5.4: it must agree with its leading term, which other
  code computes from second derivatives of u.
* (5.36), the regularity that Proposition 5.4 assumes: for cases without it, the observed order on uniform meshes is
  compared with the order that the proof gives for their regularity.
* Axes: a rotated body must have the same errors on rotated meshes.
"""

import pandas as pd

from study.fem.naming import family_named
from study.ledger.criterion import ENOUGH, Groups, Observation, Rule, between_levels, largest
from study.ledger.verdict import Verdict
from study.ledger.window import around, at_least, at_most
from study.statements.prop_5_4 import RATES, FromRates, over
from study.statements.shared.base import Statement
from study.statements.shared.meshes import LEADING, split, value_of_case

NEAR = around(1, 0.05, "on the finest level")


class SizeOfInterpolation(FromRates):
    """Judges the interpolation error ‖u − Π^h u‖_V divided by its leading term, for the cases of Proposition 5.4."""

    label = "(5.23)"
    claim = "‖v − Π^h v‖_V ≤ c h |v|_{H²}"
    proposition = "Prop. 5.4"
    rules = (over("leading-term", "‖u − Π^h u‖_V / leading term", NEAR, "interpolation_error", LEADING),)


class RegularityNeeded(FromRates):
    """Compares observed orders with proved orders, for solutions without the regularity (5.36).

    The result is reported and not judged, because the paper claims no order for these solutions.
    """

    label = "(5.36)"
    claim = "does Prop. 5.4 need the regularity (5.36) that it assumes?"
    proposition = "Prop. 5.3"

    def rules_of(self, case: str, groups: Groups) -> list[tuple[Rule, Groups]]:
        proved = at_least(value_of_case(groups, "proved_order"), "the order that the proof gives")
        seen = between_levels("order", "observed order on uniform meshes", proved, "error", 2, ENOUGH)
        uniform, _ = split(groups, lambda family: family.uniform)
        return [(Observation(seen, "the paper claims an order only under (5.36)"), uniform)]


SAME_MESH = ["family", "scheme", "level"]
DIFFERENCE = "relative difference of"
ROUND_OFF = at_most(1e-7, "rounding times the condition number of the matrices, of order h⁻², in a small difference")
CHANGES = (
    largest("errors", f"{DIFFERENCE} ‖u − u^h‖_V, ‖u − Π^h u‖_V", at_most(1e-10), "error", "interpolation_error"),
    largest("discrete-error", f"{DIFFERENCE} ‖Π^h u − u^h‖_V", ROUND_OFF, "discrete_error"),
)
"""Criteria for the relative differences between the errors of both bodies.

Differences may be exactly 0, because on most meshes all twelve digits in ``rates.csv`` agree for both bodies."""


class Turned(Statement):
    """Judges whether the errors of a case change if its body is rotated."""

    label = "axes"
    claim = "the results do not depend on the axes: a rotated body has the same errors"
    file = RATES
    rules = CHANGES

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        names, found = [name for rule in CHANGES for name in rule.columns], []
        turned = rows[rows["twin"].isin(rows["case"]) & (rows["twin"] != rows["case"])]
        for case, mine in turned.groupby("case", sort=False):
            twin = rows[rows["case"] == mine["twin"].iloc[0]][[*SAME_MESH, *names]]
            turned_mesh = mine["family"].map(lambda name: family_named(name).turns_with_body)
            pairs = mine[turned_mesh].merge(twin, on=SAME_MESH, suffixes=("", "_twin"))
            # Without a common mesh the columns are left out, so that the checks are undecided.
            compared = names if len(pairs) else []
            changes = pd.DataFrame({name: abs(pairs[name] / pairs[f"{name}_twin"] - 1) for name in compared})
            found += [rule.verdict(self, str(case), {"": changes}) for rule in self.rules]
        return found
