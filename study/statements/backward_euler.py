"""Beyond the paper: backward Euler has an error in time of O(k), with a constant that does not depend on the mesh.

This error is ‖u^h − û^{hk}‖_V. Here u^h is the semi-discrete solution, U_n are the values that backward Euler computes,
and û^{hk} is their linear interpolant in time. Together with Proposition 5.4 this gives ‖u − û^{hk}‖_V = O(h + k) for
the fully discrete scheme, without a condition on h and k. ``study.solve.gradient_flow`` states the theorem and its two
bounds, one from the data and one from the computed values U_n; paper/time.tex proves them.

**Predicted** for every mesh and every time step, from k ≫ h to k ≪ h:

* Errors are below both bounds.
* The order in k is 1. It is not higher, because the velocity u̇^h jumps whenever a vertex comes into contact.
* The constant hardly changes with the mesh, because it depends only on u^h, which converges.
* The bound from the data is several times too large, because it counts the variation of the load twice, as if the load
  always acted against the solution.
* The bound from the values U_n was expected to exceed the error by at most a factor of three. The observed factor is
  3.3 to 30. This bound counts the variation of the load, but where contact carries nearly all of the load, as in full
  contact, u^h hardly changes with the load.

**Between the time nodes** the error of linear interpolation is compared with k/4 times the oscillation of u̇^h within a
step. Predicted quotients are 1/2 where u̇^h changes steadily (2/3 if only four values of u̇^h are known in a step), 1
where u̇^h jumps in the middle of a step, and less where it jumps near an end of a step. So the largest quotient over
the steps is between 1/5 and 1. For the midpoint rule interpolation causes most of the error between the nodes, because
the rule is of higher order at the nodes where velocities are smooth.

**A load that jumps in time** has bounded variation, which is all that the theorem needs. The load of a case jumps at
T/2 by half of its final value. No exact solution is needed. Bounds and orders are predicted as above.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from manufactured.tensors import Array
from study.ledger import quantities
from study.ledger.check import ENOUGH, ROUNDING, Check
from study.ledger.orders import fit
from study.ledger.verdict import CheckKind
from study.ledger.window import Window, around, positive_at_most
from study.solve.gradient_flow import GradientFlow
from study.solve.paths import furthest, interpolated, last, oscillation, path
from study.solve.tableau import BACKWARD_EULER, MIDPOINT
from study.statements.shared.base import ListedNumbers, Setting, grid, with_h
from study.statements.shared.experiment import Experiment, with_cached_loads
from study.statements.shared.norms import maximum, minimum

COUNTS = (4, 8, 16, 32, 64, 128, 256)
"""Numbers of time steps: six halvings of k, from k ≫ h to k ≪ h."""
LAST = COUNTS[-1]
FINEST = 1024
"""Number of steps of the midpoint rule whose solution is used as the semi-discrete solution u^h."""
QUANTITIES = "error", "by data", "by solution", "constant", "between", "midpoint"
COLUMNS = {quantity: [f"{count} {quantity}" for count in COUNTS] for quantity in QUANTITIES}
"""Names of the columns with each quantity, one column for each number of time steps."""
PROVED = positive_at_most(1.0, "proved in the article for every h and k")
UNIFORM = around(1, 0.1, "the constant does not depend on the mesh")
BETWEEN = Window(
    0.2,
    1 + ROUNDING,
    "at most 1 is proved; predicted 1/2 to 2/3 if u̇^h changes steadily, 1 if it jumps in the middle of a step",
)
IN_K = around(1, 0.1, "least squares over six halvings of k, on every mesh")
SAME_SOLUTION = positive_at_most(0.1, "the reference solution hardly changes the error")
ERROR = "error in time of backward Euler, ‖u^h − û^{hk}‖_V"
ERROR_OF_CONSTANT = "error in time of the piecewise constant function with the value U_n on (t_{n−1}, t_n]"
INTERPOLATION = "error of u^h interpolated linearly between time nodes / (k/4 · largest change of u̇^h within a step)"
ALL_TIMES = "midpoint rule: error in time at all t / (largest error at the nodes + k/2 (‖u̇^h(0+)‖_V + Var f))"
CHANGE = f"change of the reference solution u^h from {FINEST // 2} to {FINEST} steps / smallest error in time"


def order_in_k(key: str, quantity: str, window: Window, counts: Sequence[int], columns: Sequence[str]) -> Check:
    """Return the check of the observed order of an error in the time step k.

    The orders on all meshes must lie in the window; the order on the finest mesh is displayed.

    Args:
        key, quantity, window: key, description and tolerance window of the check.
        counts: numbers of steps.
        columns: for each number of steps, the name of the column with the error.
    """

    def orders(levels: pd.DataFrame) -> Array:
        return np.array([fit(1 / np.array(counts), row) for row in levels[list(columns)].to_numpy()])

    return Check(key, quantity, orders, window, CheckKind.CONSEQUENCE, finest=True)


class BackwardEuler(ListedNumbers):
    """Measures errors of backward Euler in time, divided by each of their two bounds, for many h and k."""

    label = "beyond: O(h + k)"
    effort = 60
    claim = "max_t ‖u^h − û^{hk}‖_V ≤ k (‖u̇^h(0+)‖_V/√2 + 2 Var f) for backward Euler, for every h"
    checks = (
        Check(
            "data",
            f"{ERROR} / its bound from the data",
            quantities.values(*COLUMNS["by data"]),
            PROVED,
            CheckKind.IDENTITY,
        ),
        Check(
            "solution",
            f"{ERROR} / its bound from the computed values U_n",
            quantities.values(*COLUMNS["by solution"]),
            PROVED,
            CheckKind.IDENTITY,
        ),
        Check(
            "constant",
            f"{ERROR_OF_CONSTANT} / its bound",
            quantities.values(*COLUMNS["constant"]),
            PROVED,
            CheckKind.IDENTITY,
        ),
        Check("between", INTERPOLATION, quantities.values(*COLUMNS["between"]), BETWEEN, CheckKind.CONSEQUENCE),
        Check("midpoint", ALL_TIMES, quantities.values(*COLUMNS["midpoint"]), PROVED, CheckKind.IDENTITY),
        order_in_k("order", f"order in k of the {ERROR}", IN_K, COUNTS, COLUMNS["error"]),
        Check(
            "uniform",
            f"{ERROR} / its bound from the data, {LAST} steps: finest / coarsest mesh",
            quantities.change(f"{LAST} by data"),
            UNIFORM,
            CheckKind.CONSEQUENCE,
            ENOUGH,
        ),
        Check("reference", CHANGE, quantities.values("reference"), SAME_SOLUTION, CheckKind.ACCURACY),
    )
    quick = grid(("advance-recede",), ("shaken",), (4, 8, 16))
    full = grid(("full-contact", "advance-recede", "travelling-patch", "yield-and-release"), ("shaken",), (6, 12, 24))

    def setup(self, setting: Setting) -> Experiment:
        return Experiment.at(setting, MIDPOINT, FINEST)

    def measure(self, setup: Experiment) -> dict[str, float]:
        problem = with_cached_loads(setup.problem)
        flow = GradientFlow(problem, np.array([problem.load(t) for t in problem.T * np.arange(FINEST + 1) / FINEST]))
        exact, half = path(problem, MIDPOINT, FINEST), path(problem, MIDPOINT, FINEST // 2)
        found: dict[str, float] = {}
        for count in COUNTS:
            k, nodes = problem.T / count, exact[:: FINEST // count]
            states, middle = path(problem, BACKWARD_EULER, count), path(problem, MIDPOINT, count)
            lines = [interpolated(values, FINEST) for values in (states, nodes, middle)]
            error, of_interpolation, of_midpoint = (furthest(problem, exact, line) for line in lines)
            of_constant = maximum(furthest(problem, exact, side) for side in last(states, FINEST))
            bound_of_midpoint = furthest(problem, nodes, middle) + k / 2 * flow.fastest
            numbers = (
                error,
                error / flow.a_priori(count),
                error / flow.a_posteriori(states),
                of_constant / flow.piecewise_constant(count),
                of_interpolation / (k / 4 * oscillation(problem, exact, count)),
                of_midpoint / bound_of_midpoint,
            )
            found |= {f"{count} {name}": number for name, number in zip(QUANTITIES, numbers, strict=True)}
        found["reference"] = furthest(problem, exact[::2], half) / minimum(found[name] for name in COLUMNS["error"])
        return with_h(setup.space.h, found)


class JumpingLoad(BackwardEuler):
    """Measures the same numbers for a load that jumps in time."""

    label = "beyond: O(h + k), load with a jump"
    full = grid(("advance-recede",), ("shaken",), (6, 12, 24))

    def setup(self, setting: Setting) -> Experiment:
        setup = super().setup(setting)
        problem = setup.problem
        jump = problem.load(problem.T) / 2
        return replace(
            setup, problem=replace(problem, load=lambda time: problem.load(time) + (time >= problem.T / 2) * jump)
        )
