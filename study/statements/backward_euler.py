"""Beyond the source: ‖u^h − û^{hk}‖_V = O(k) for backward Euler, with a constant that does not depend on the mesh.

With Proposition 5.4 this is ‖u − û^{hk}‖_V = O(h + k) for the fully discrete scheme, without a condition between h and
k. ``study.solve.gradient_flow`` has the theorem and its bounds, paper/time.tex its proof.

Predicted: both bounds hold for every mesh and every step, k ≫ h and k ≪ h. The order in k is 1, since u̇^h jumps at
landings and u is not smooth in time then. The constant is the constant of u^h, which converges, so it hardly changes
with the mesh. The bound from the data is several times too large: it counts the variation of the load twice, as
if the load always turned against the solution. The other bound was expected within a factor of three, and is within
3.3 to 30: it counts the variation of the load once, and where contact carries nearly all of the load, as in full
contact, u^h hardly sees it.

Between nodes, predicted for every k: linear interpolation leaves 1/2 of k/4 times the oscillation of u̇^h within a step
where u̇^h changes steadily (2/3 if four values of it are known in a step), all of it where u̇^h jumps in the middle, and
little where it jumps near an end. So the largest share over the steps is 1/5 to 1. For the midpoint rule, which is of
higher order at the nodes where velocities are smooth, this is most of the error between them.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pandas as pd

from study.ledger.criterion import ROUNDING, Criterion, Measured, among, change, every, largest, or_none
from study.ledger.orders import fit
from study.ledger.window import Window, around, positive_at_most
from study.solve.evolution import SemiDiscrete
from study.solve.gradient_flow import GradientFlow
from study.solve.paths import furthest, interpolated, last, oscillation, path
from study.solve.tableau import BACKWARD_EULER, MIDPOINT
from study.statements.shared.base import ListedNumbers, Setting, grid, with_h
from study.statements.shared.experiment import Experiment
from study.statements.shared.norms import maximum, minimum

COUNTS = (4, 8, 16, 32, 64, 128, 256)
"""Numbers of steps: six halvings of k, from k ≫ h to k ≪ h."""
FINEST = 1024
"""Steps of the midpoint rule whose solution is used for u^h."""
PROVED = positive_at_most(1.0, "proved in the article for every h and k")
UNIFORM = around(1, 0.1, "the constant does not depend on the mesh")
BETWEEN = Window(
    0.2, 1 + ROUNDING, "proved for every function; 1/2 … 2/3 for steady changes, 1 for a jump in the middle of a step"
)
IN_K = around(1, 0.1, "least squares over six halvings, every mesh")


LAST = COUNTS[-1]
INTERPOLATION = "error of linear interpolation of u^h in t / (k/4 · oscillation of u̇^h in a step)"
ALL_TIMES = "midpoint rule, all t: ‖u^h − û^{hk}‖ / (its largest at nodes + k/2 (‖u̇^h(0+)‖_V + Var f))"
CHANGE = f"change of u^h from {FINEST // 2} to {FINEST} steps / smallest error"


def columns(quantity: str) -> list[str]:
    """Return the columns of a quantity for all numbers of steps."""
    return [f"{count} {quantity}" for count in COUNTS]


def orders_in_k(levels: pd.DataFrame) -> Measured:
    """Return the order of the error in k on every mesh; the one on the finest is shown."""
    orders = np.array([fit(1 / np.array(COUNTS), row) for row in levels[columns("error")].to_numpy()])
    return among(orders[-1], orders)


class BackwardEuler(ListedNumbers):
    """Errors in time over both bounds, for tables of h and k."""

    label = "beyond: O(h + k)"
    effort = 60
    claim = "max_t ‖u^h − û^{hk}‖_V ≤ k (‖u̇^h(0+)‖_V/√2 + 2 Var f) for backward Euler, for every h"
    rules = (
        largest("data", "‖u^h − û^{hk}‖ / its bound by the data", PROVED, *columns("by data")),
        largest("solution", "‖u^h − û^{hk}‖ / its bound by U_n", PROVED, *columns("by solution")),
        largest("constant", "‖u^h − U_n‖ on (t_{n−1}, t_n] / its bound", PROVED, *columns("constant")),
        every("between", INTERPOLATION, BETWEEN, *columns("between")),
        largest("midpoint", ALL_TIMES, PROVED, *columns("midpoint")),
        Criterion("order", "order of ‖u^h − û^{hk}‖ in k", IN_K, or_none(orders_in_k), tuple(columns("error"))),
        change("uniform", f"‖u^h − û^{{hk}}‖ with {LAST} steps, finest mesh / coarsest mesh", UNIFORM, f"{LAST} error"),
        largest("reference", CHANGE, positive_at_most(0.1, "so it hardly changes the error"), "reference"),
    )
    quick = grid(("advance-recede",), ("shaken",), (4, 8, 16))
    full = grid(("full-contact", "advance-recede", "travelling-patch", "yield-and-release"), ("shaken",), (6, 12, 24))

    def measure(self, setting: Setting) -> dict[str, float]:
        setup = Experiment.at(setting, MIDPOINT, FINEST)
        return with_h(setup.space.h, errors_and_bounds(setup.problem))


def errors_and_bounds(problem: SemiDiscrete) -> dict[str, float]:
    """Return errors, and errors over their bounds, for all numbers of steps."""
    # Trajectories share most of their times, exactly, as they halve their steps.
    problem = replace(problem, load=lru_cache(maxsize=None)(problem.load))
    flow = GradientFlow(problem, np.array([problem.load(t) for t in problem.T * np.arange(FINEST + 1) / FINEST]))
    exact, half = path(problem, MIDPOINT, FINEST), path(problem, MIDPOINT, FINEST // 2)
    found: dict[str, float] = {}
    for count in COUNTS:
        k, nodes = problem.T / count, exact[:: FINEST // count]
        states, middle = path(problem, BACKWARD_EULER, count), path(problem, MIDPOINT, count)
        error = furthest(problem, exact, interpolated(states, FINEST))
        piecewise_constant = maximum(furthest(problem, exact, side) for side in last(states, FINEST))
        left_by_interpolation = furthest(problem, exact, interpolated(nodes, FINEST))
        midpoint, at_nodes = furthest(problem, exact, interpolated(middle, FINEST)), furthest(problem, nodes, middle)
        numbers = {
            "error": error,
            "by data": error / flow.a_priori(count),
            "by solution": error / flow.a_posteriori(states),
            "constant": piecewise_constant / flow.piecewise_constant(count),
            "between": left_by_interpolation / (k / 4 * oscillation(problem, exact, count)),
            "midpoint": midpoint / (at_nodes + k / 2 * flow.fastest),
        }
        found |= {f"{count} {name}": number for name, number in numbers.items()}
    found["reference"] = furthest(problem, exact[::2], half) / minimum(found[column] for column in columns("error"))
    return found
