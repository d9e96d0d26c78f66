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

from study.ledger.check import ENOUGH, ROUNDING, accuracy, consequence, identity
from study.ledger.orders import fit
from study.ledger.quantities import Value, change, values
from study.ledger.window import Window, around, positive_at_most
from study.solve.gradient_flow import GradientFlow
from study.solve.paths import furthest, interpolated, last, oscillation, path
from study.solve.tableau import BACKWARD_EULER, MIDPOINT
from study.statements.shared.base import ListedNumbers, Numbers, Setting, grid, with_h
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
BETWEEN = Window(
    0.2,
    1 + ROUNDING,
    "at most 1 is proved; predicted 1/2 to 2/3 if u̇^h changes steadily, 1 if it jumps in the middle of a step",
)
IN_K = around(1, 0.1, "least squares over six halvings of k, on every mesh")
ERROR = "error in time of backward Euler, ‖u^h − û^{hk}‖_V"
ERROR_OF_CONSTANT = "error in time of the piecewise constant function with the value U_n on (t_{n−1}, t_n]"
CHANGE = f"change of the reference solution u^h from {FINEST // 2} to {FINEST} steps / smallest error in time"


def orders_in_k(counts: Sequence[int], columns: Sequence[str]) -> Value:
    """Return the function for the observed orders in the time step k on all levels, from columns with errors.

    Args:
        counts: numbers of steps.
        columns: for each number of steps, the name of the column with the error.
    """
    return lambda levels: np.array([fit(1 / np.array(counts), row) for row in levels[list(columns)].to_numpy()])


class BackwardEuler(ListedNumbers):
    """Measures errors of backward Euler in time, divided by each of their two bounds, for many h and k."""

    label = "beyond: O(h + k)"
    effort = 60
    claim = "max_t ‖u^h − û^{hk}‖_V ≤ k (‖u̇^h(0+)‖_V/√2 + 2 Var f) for backward Euler, for every h"
    checks = (
        identity("data", f"{ERROR} / its bound from the data", values(*COLUMNS["by data"]), PROVED),
        identity(
            "solution", f"{ERROR} / its bound from the computed values U_n", values(*COLUMNS["by solution"]), PROVED
        ),
        identity("constant", f"{ERROR_OF_CONSTANT} / its bound", values(*COLUMNS["constant"]), PROVED),
        consequence(
            "between",
            "error of u^h interpolated linearly between time nodes / (k/4 · largest change of u̇^h within a step)",
            values(*COLUMNS["between"]),
            BETWEEN,
        ),
        identity(
            "midpoint",
            "midpoint rule: error in time at all t / (largest error at the nodes + k/2 (‖u̇^h(0+)‖_V + Var f))",
            values(*COLUMNS["midpoint"]),
            PROVED,
        ),
        consequence("order", f"order in k of the {ERROR}", orders_in_k(COUNTS, COLUMNS["error"]), IN_K, finest=True),
        consequence(
            "uniform",
            f"{ERROR} / its bound from the data, {LAST} steps: finest / coarsest mesh",
            change(f"{LAST} by data"),
            around(1, 0.1, "the constant does not depend on the mesh"),
            levels=ENOUGH,
        ),
        accuracy(
            "reference",
            CHANGE,
            values("reference"),
            positive_at_most(0.1, "the reference solution hardly changes the error"),
        ),
    )
    quick = grid(("advance-recede",), ("shaken",), (4, 8, 16))
    full = grid(("full-contact", "advance-recede", "travelling-patch", "yield-and-release"), ("shaken",), (6, 12, 24))

    def setup(self, setting: Setting) -> Experiment:
        return Experiment.at(setting, MIDPOINT, FINEST)

    def measure(self, setup: Experiment) -> Numbers:
        problem = with_cached_loads(setup.problem)
        flow = GradientFlow(problem, np.array([problem.load(t) for t in problem.T * np.arange(FINEST + 1) / FINEST]))
        exact = path(problem, MIDPOINT, FINEST)
        half = path(problem, MIDPOINT, FINEST // 2)
        found: Numbers = {}
        for count in COUNTS:
            k = problem.T / count
            nodes = exact[:: FINEST // count]
            states = path(problem, BACKWARD_EULER, count)
            middle = path(problem, MIDPOINT, count)
            lines = [interpolated(values, FINEST) for values in (states, nodes, middle)]
            error, of_interpolation, of_midpoint = (furthest(problem, exact, line) for line in lines)
            of_constant = maximum(furthest(problem, exact, side) for side in last(states, FINEST))
            bound_of_midpoint = furthest(problem, nodes, middle) + k / 2 * flow.fastest
            found[f"{count} error"] = error
            found[f"{count} by data"] = error / flow.a_priori(count)
            found[f"{count} by solution"] = error / flow.a_posteriori(states)
            found[f"{count} constant"] = of_constant / flow.piecewise_constant(count)
            found[f"{count} between"] = of_interpolation / (k / 4 * oscillation(problem, exact, count))
            found[f"{count} midpoint"] = of_midpoint / bound_of_midpoint
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
        jumping = replace(problem, load=lambda time: problem.load(time) + (time >= problem.T / 2) * jump)
        return replace(setup, problem=jumping)
