"""How far both ways through Problem 5.1 may lie apart.

The gauge integrates by rules of degree 4 with points moved along the face, the plain way by degree 10. Rows of
``rates.csv`` bound what quadrature changes by 2 %, by the triangle inequality; both ways cut the same cells, and the
difference of two rules is far smaller. Predicted: errors within 0.5 %, and the difference of discrete solutions, a few
times smaller than these, within 1 %. Trajectories differ by the load alone, whose relative quadrature error is a power
of h smaller than that of the errors, 2e-3; nodal forces are differences of large terms, 1 %. Π^h u_0 has no quadrature.

With one load for both, forms of polynomials on cells and the same discrete problem are left: both solvers stop at 1e-12
of what they look for, steps number some tens and the forces of a step are differences that lose a digit or two, so that
trajectories and forces agree to 1e-9. This row sees a modulus, a start or a force that is wrong by as little.
"""

from __future__ import annotations

import pandas as pd

from study.ledger.criterion import Criterion, Measured
from study.ledger.measures import among, largest
from study.ledger.window import Window, above_nothing, around, at_most
from study.statements.recomputed.sweep import Again
from study.statements.shared.base import REPORTED

SAME = around(1, 0.005, "quadrature")
SAME_DISCRETE = around(1, 0.01, "quadrature of the load, too")
ROWS = {
    "error": ("‖u − u^h‖_V", SAME),
    "interpolation_error": ("‖u − Π^h u‖_V", SAME),
    "discrete_error": ("‖Π^h u − u^h‖_V", SAME_DISCRETE),
}
TRAJECTORY = at_most(2e-3, "of ‖u^h‖_V, quadrature of the load")
FORCES = at_most(0.01, "of λ, quadrature of the load")
STOPPED = above_nothing(1e-9, "of ‖u^h‖_V, where both solvers stop")
STOPPED_FORCES = at_most(1e-9, "of λ, where both solvers stop")
START = at_most(1e-10, "of ‖Π^h u_0‖_V, only rounding")


def ratio(column: str, norm: str, window: Window) -> Criterion:
    """A reported error over the one that was computed again, on every level."""
    reported = f"{column}{REPORTED}"

    def measure(group: pd.DataFrame) -> Measured:
        values = (group[reported] / group[column]).to_numpy()
        return among(window.worst(list(values)), values)

    quantity = f"{norm} in rates.csv / computed again"
    return Criterion(column.replace("_", "-"), quantity, window, measure, (column, reported))


TRAJECTORIES = (
    largest("start", "‖u^h_0 − ũ^h_0‖_V / ‖ũ^h_0‖_V", START, "start"),
    largest("displacement", "max_n ‖u^h_n − ũ^h_n‖_V / max_n ‖ũ^h_n‖_V", TRAJECTORY, "displacement"),
    largest("multipliers", "|λ − λ̃| / |λ̃| over all steps", FORCES, "multipliers"),
    largest(
        "displacement-same-load",
        "max_n ‖u^h_n − ũ^h_n‖_V / max_n ‖ũ^h_n‖_V, both with the load of u^h",
        STOPPED,
        "displacement_same_load",
    ),
    largest(
        "multipliers-same-load",
        "|λ − λ̃| / |λ̃| over all steps, both with the load of u^h",
        STOPPED_FORCES,
        "multipliers_same_load",
    ),
)


class Recomputed(Again):
    """Three errors and two trajectories, over all mesh families of a case."""

    label = "computed again"
    claim = "the errors of rates.csv and Problem 5.1 behind them, from other quadrature, assembly and solvers"
    rules = (*(ratio(column, *row) for column, row in ROWS.items()), *TRAJECTORIES)
