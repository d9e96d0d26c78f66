"""Beyond the source: ‖u^h − û^{hk}‖_V = O(k) for backward Euler, with a constant that no mesh enters.

With Proposition 5.4 this is ‖u − û^{hk}‖_V = O(h + k) for the fully discrete scheme, without a condition between h and
k. The theorem with its bounds is in ``study.solve.gradient_flow``, its proof in the
supplement to the article.

Predicted: both bounds hold for every mesh and every step, k ≫ h and k ≪ h. The order in k is 1, as u̇^h jumps at
landings and u is not smooth in time then. The constant is that of u^h, which converges, so that it hardly changes with
the mesh. The bound from the data is several times too large: it counts three times what the load varies, as if it
always turned against the solution. The other was expected within a factor of three, and is within 3.3 … 30: it counts
what the load varies once, and where contact carries nearly all of the load, as in full contact, u^h hardly sees it.

Between nodes, predicted for every k: what linear interpolation leaves of u^h is 1/2 of k/4 times the oscillation of u̇^h
within a step where it changes steadily (2/3 if four values of it are known in a step), all of it where it jumps in the
middle, little where it jumps near an end, so that the largest share over the steps is 1/5 … 1. For the midpoint rule,
which is of higher order at the nodes where velocities are smooth, this is most of the error between them.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pandas as pd

from manufactured.tensors import Array
from study.ledger.criterion import Criterion, Measured
from study.ledger.measures import ROUNDING, among, change, every, largest, or_none
from study.ledger.orders import fit
from study.ledger.window import Window, above_nothing, around
from study.solve.evolution import SemiDiscrete
from study.solve.gradient_flow import GradientFlow
from study.solve.paths import furthest, interpolated, last, oscillation, path
from study.solve.tableau import BACKWARD_EULER, MIDPOINT
from study.statements.shared.base import ListedNumbers, Setting, grid, with_h
from study.statements.shared.experiment import Experiment

COUNTS = (4, 8, 16, 32, 64, 128, 256)
"""Steps: six halvings of k, from k ≫ h to k ≪ h."""
FINEST = 1024
"""Steps of the midpoint rule that stands for u^h."""
PROVED = above_nothing(1.0, "proved in the article for every h and k")
UNIFORM = around(1, 0.1, "no mesh enters the constant")
BETWEEN = Window(0.2, 1 + ROUNDING, "proved for every function; 1/2 … 2/3 for steady changes, 1 for a jump amid a step")
IN_K = around(1, 0.1, "least squares over six halvings, every mesh")


def orders_in_k(window: Window) -> Criterion:
    """The order of the error in k on every mesh."""
    columns = tuple(f"{count} error" for count in COUNTS)

    def measure(group: pd.DataFrame) -> Measured:
        k = 1 / np.array(COUNTS)
        found = np.array([fit(k, row).order for row in group[list(columns)].to_numpy()])
        return among(found[-1], found)

    return Criterion("order", "order of ‖u^h − û^{hk}‖ in k", window, or_none(measure), columns)


class BackwardEuler(ListedNumbers):
    """Errors in time beside both bounds, over tables of h and k."""

    label = "beyond: O(h + k)"
    effort = 60
    claim = "max_t ‖u^h − û^{hk}‖_V ≤ k (‖u̇^h(0+)‖_V/√2 + 3 Var f) for backward Euler, whatever h"
    rules = (
        largest("data", "‖u^h − û^{hk}‖ / its bound by the data", PROVED, *(f"{n} by data" for n in COUNTS)),
        largest("solution", "‖u^h − û^{hk}‖ / its bound by U_n", PROVED, *(f"{n} by solution" for n in COUNTS)),
        largest("constant", "‖u^h − U_n‖ on (t_{n−1}, t_n] / its bound", PROVED, *(f"{n} constant" for n in COUNTS)),
        every(
            "between",
            "what linear interpolation in t leaves of u^h / (k/4 · oscillation of u̇^h in a step)",
            BETWEEN,
            *(f"{n} between" for n in COUNTS),
        ),
        largest(
            "midpoint",
            "midpoint rule, all t: ‖u^h − û^{hk}‖ / (its largest at nodes + k/2 (‖u̇^h(0+)‖_V + Var f))",
            PROVED,
            *(f"{n} midpoint" for n in COUNTS),
        ),
        orders_in_k(IN_K),
        change(
            "uniform",
            f"‖u^h − û^{{hk}}‖ with {COUNTS[-1]} steps, finest mesh over coarsest",
            UNIFORM,
            f"{COUNTS[-1]} error",
        ),
        largest(
            "reference",
            f"change of u^h from {FINEST // 2} to {FINEST} steps / smallest error",
            above_nothing(0.1, "hardly matters beside it"),
            "reference",
        ),
    )
    quick = grid(("advance-recede",), ("shaken",), (4, 8, 16))
    full = grid(("full-contact", "advance-recede", "travelling-patch", "yield-and-release"), ("shaken",), (6, 12, 24))

    def measure(self, setting: Setting) -> dict[str, float]:
        setup = Experiment.at(setting, MIDPOINT, FINEST)
        return with_h(setup.space.h, dict(compared(setup.problem)))


def compared(problem: SemiDiscrete) -> dict[str, float]:
    """Errors, and what part they are of their bounds, for all numbers of steps."""
    # Trajectories share most of their times, exactly, as they halve their steps.
    problem = replace(problem, load=lru_cache(maxsize=None)(problem.load))
    flow = GradientFlow(problem, np.array([problem.load(t) for t in problem.T * np.arange(FINEST + 1) / FINEST]))
    exact, half = path(problem, MIDPOINT, FINEST), path(problem, MIDPOINT, FINEST // 2)
    found: dict[str, float] = {}
    for count in COUNTS:
        states = path(problem, BACKWARD_EULER, count)
        error = furthest(problem, exact, interpolated(states, FINEST))
        found[f"{count} error"] = error
        found[f"{count} by data"] = error / flow.a_priori(count)
        found[f"{count} by solution"] = error / flow.a_posteriori(states)
        found |= {f"{count} {name}": value for name, value in between_nodes(flow, exact, states).items()}
    found["reference"] = furthest(problem, exact[::2], half) / min(found[f"{count} error"] for count in COUNTS)
    return found


def between_nodes(flow: GradientFlow, exact: Array, states: Array) -> dict[str, float]:
    """The three shares for the number of steps of a trajectory of backward Euler, (N + 1, n)."""
    problem, count = flow.problem, len(states) - 1
    k, inner = problem.T / count, FINEST // count
    held = max(furthest(problem, exact, side) for side in last(states, FINEST))
    left = furthest(problem, exact, interpolated(exact[::inner], FINEST))
    middle = path(problem, MIDPOINT, count)
    error, at_nodes = furthest(problem, exact, interpolated(middle, FINEST)), furthest(problem, exact[::inner], middle)
    return {
        "constant": held / flow.piecewise_constant(count),
        "between": left / (k / 4 * oscillation(problem, exact, count)),
        "midpoint": error / (at_nodes + k / 2 * flow.fastest),
    }
