"""Beyond the paper: backward Euler has an error of O(h + k) even if the elasticity G has no potential.

The last paragraph of the paper leaves error estimates for fully discrete schemes open. ``backward_euler`` has an
estimate for an elasticity G with a convex potential. The theorem tested here assumes only (3.2), that G is Lipschitz.
With κ = L_G/m_A and steps of any size below 1/κ it says max_t ‖u^h − û^{hk}‖_V ≤ c k, where c does not depend on the
mesh. Here û^{hk} interpolates the values of backward Euler linearly in time. So by Prop. 5.4 the fully discrete error
is O(h + k). ``study.solve.euler_bounds`` has two bounds with all constants, one from the data and one from the computed
solution; paper/time.tex has the proof. The solver factorises the symmetric part of G. The skew part is treated by the
fixed-point iteration that also serves nonlinear laws.

Predicted before measuring, for levels 4, 8, 16, up to 256 steps, and an elasticity with κ = 1.78, γ = 1, T = 1:

* *Bounds.* Errors are below both bounds for every mesh and every step. Steps are equal or alternate between k and k/3.
  For a smooth load the bounds overestimate: with the factors e^{γT}, (1/√2 + κT/2) and (2 + κT/2) the bound from the
  data should be 10 to 100 times the error, and the bound from the solution 3 to 30 times.
* *The order in k is 1*, 1 ± 0.1 by least squares on every mesh, because u̇^h jumps when vertices come into contact.
  Moreover (1 − γk)^{−T/k} is larger than e^{γT} by the factor 1.16 for four steps, which raises the order over all
  halvings by a few hundredths.
* *The constant does not depend on the mesh*: the error with the shortest steps changes by less than ten per cent from
  the coarsest to the finest mesh, because the constant depends only on u^h, which converges.
* *The constant κT/2 is the best possible*: consider u̇ + Bu = 0 in the plane, where B is κ times the rotation by a
  right angle. The solution rotates, and the solution of backward Euler becomes shorter. Its error is
  ‖u_0‖ (1 − e^{−κ²kT/2}) up to higher orders, and the initial velocity has the norm κ‖u_0‖. So for k → 0 the error over
  the bound from the data is (κT/2)/(κT/2 + 1/√2). For κ = 10, T = 1 and 1000 steps the quotient is 0.876 · 0.975 =
  0.855; the window is 0.8 to 1.

Changes after the first measurement:

* The bound from the solution is less than 2.2 times the error, much better than predicted.
* The error with the shortest steps grows by 17 per cent from n = 4 to n = 16, since four cells do not resolve the gap;
  from n = 6 to n = 12 it grows by 5 per cent. Levels start at 6 since then; the window was not changed.
* No check noticed that the skew part of G was left out of the solver: it changed u^h by 8 per cent only. The skew part
  was made larger and turned, which changes u^h by 18 per cent (κ = 2.03 since then). The check of the error against
  the exact solution for k = T/(4n) was added; its window 1 ± 0.15 was set when errors for n ≤ 12 on shaken meshes were
  known.
* 64 steps are enough for all checks.
* Shaken meshes are no longer used, although all checks held on them: checks on random meshes must be repeated with
  fresh seeds, which would take hours.
"""

from itertools import product

import numpy as np
import scipy.sparse as sps
from scipy.interpolate import make_interp_spline

from manufactured.no_potential import NAME
from manufactured.tensors import Array
from study.ledger.check import ENOUGH, accuracy, consequence, identity
from study.ledger.quantities import Value, change, fitted, values
from study.ledger.window import Window, around, positive_at_most
from study.solve.euler_bounds import EulerBounds, backward_euler
from study.solve.evolution import SemiDiscrete
from study.solve.gradient_flow import GradientFlow
from study.solve.paths import furthest, path
from study.solve.tableau import BACKWARD_EULER, MIDPOINT
from study.statements.backward_euler import orders_in_k
from study.statements.shared.base import ListedNumbers, Numbers, Setting, grid, with_h
from study.statements.shared.experiment import Experiment, with_cached_loads
from study.statements.shared.norms import maximum, minimum

COUNTS = (4, 8, 16, 32, 64)
"""Numbers of time steps: four halvings of k, from k ≫ h to k ≪ h."""
FINEST = 256
"""Number of steps of the midpoint rule whose solution is used as the semi-discrete solution u^h."""
PER_CELL = 4
"""Number of time steps for each cell along a side, k = T/(4n), in the comparison with the exact solution."""
UNEQUAL = 3
"""Quotient of the lengths of a long and a short step in time grids with alternating steps."""
ROTATION, TURNS = 10.0, 1000
"""The test problem of a rotation in the plane: its angular velocity κ, and its number of time steps."""
PROVED = positive_at_most(1.0, "proved for every h and k")
IN_K = around(1, 0.1, "least squares over four halvings, every mesh")
ERROR = "‖u^h − û^{hk}‖"
SHORTEST = f"equal {COUNTS[-1]} error"
OF_BOUND = f"{ERROR} / its bound from the"
ORDER = f"order of {ERROR} in k"
HALF_STEPS = f"change of u^h from {FINEST // 2} to {FINEST} steps / smallest error"
KINDS = "equal", "unequal"


def partition(kind: str, count: int) -> Array:
    """Return a time grid with equal or alternating steps, as indices of nodes of the finest time grid, (count + 1,).

    Args:
        kind: "equal" or "unequal".
        count: the number of steps.
    """
    if kind == "equal":
        return np.arange(0, FINEST + 1, FINEST // count)
    pair = 2 * FINEST // count
    short = pair // (1 + UNEQUAL)
    return np.concatenate([[0], np.cumsum(np.tile([pair - short, short], count // 2))])


def at_all_steps(column: str) -> Value:
    """Return the function that gives a measured number, such as "equal error", for all numbers of time steps."""
    return values(*columns(column))


def in_k(kind: str) -> Value:
    """Return the function for the observed orders in the time step k, for equal or unequal steps."""
    return orders_in_k(COUNTS, columns(f"{kind} error"))


def columns(column: str) -> list[str]:
    """Return the names of the columns with a measured number for all numbers of time steps."""
    kind, what = column.split(" ", 1)
    return [f"{kind} {count} {what}" for count in COUNTS]


class NoPotential(ListedNumbers):
    """Measures errors of backward Euler, and their quotients with two bounds, for an elasticity without a potential."""

    label = "beyond: O(h + k), no potential"
    effort = 150
    claim = "max_t ‖u^h − û^{hk}‖_V ≤ c(κ, T, ‖u̇^h(0+)‖, Var f) k for backward Euler under (3.2) alone, for every h"
    outside_catalogue = True
    checks = (
        identity("data-equal", f"{OF_BOUND} data, equal steps", at_all_steps("equal by data"), PROVED),
        identity("data-unequal", f"{OF_BOUND} data, unequal steps", at_all_steps("unequal by data"), PROVED),
        identity("solution-equal", f"{OF_BOUND} solution, equal steps", at_all_steps("equal by solution"), PROVED),
        identity(
            "solution-unequal",
            f"{OF_BOUND} solution, unequal steps",
            at_all_steps("unequal by solution"),
            PROVED,
        ),
        consequence("order-equal", f"{ORDER}, equal steps", in_k("equal"), IN_K, finest=True),
        consequence("order-unequal", f"{ORDER}, unequal steps", in_k("unequal"), IN_K, finest=True),
        consequence(
            "uniform",
            f"{ERROR} with {COUNTS[-1]} steps, finest mesh / coarsest mesh",
            change(SHORTEST),
            around(1, 0.1, "the constant does not depend on the mesh"),
            levels=ENOUGH,
        ),
        consequence(
            "order-both",
            f"order of max_n ‖u − U_n‖ in h for k = T/({PER_CELL}n)",
            fitted("fully discrete"),
            around(1, 0.15, "least squares over all levels, k = T/(4n)"),
            levels=ENOUGH,
        ),
        consequence(
            "rotation",
            "error of a rotation in the plane / its bound from the data",
            values("rotation"),
            Window(0.8, 1.0, "0.855 predicted; a constant below 0.8 κT/2 would be too small"),
        ),
        accuracy(
            "reference",
            HALF_STEPS,
            values("reference"),
            positive_at_most(0.1, "so the reference solution hardly changes the error"),
        ),
    )
    quick = grid((NAME,), ("one-diagonal",), (6, 8, 12))
    full = grid((NAME,), ("one-diagonal", "unstructured"), (6, 12, 24))

    def measure(self, setting: Setting) -> Numbers:
        setup = Experiment.at(setting, MIDPOINT, FINEST)
        law = setup.solution.law
        problem = with_cached_loads(setup.problem)
        times = problem.T * np.arange(FINEST + 1) / FINEST
        flow = GradientFlow(problem, np.array([problem.load(t) for t in times.tolist()]))
        bounds = EulerBounds(flow, law.kappa, law.growth)
        exact = path(problem, MIDPOINT, FINEST)
        half = path(problem, MIDPOINT, FINEST // 2)
        found: Numbers = {}
        for kind, count in product(KINDS, COUNTS):
            nodes = partition(kind, count)
            states = backward_euler(problem, times[nodes].tolist())
            # Between its nodes, the solution is interpolated linearly in time.
            error = furthest(problem, exact, make_interp_spline(nodes, states, k=1)(np.arange(FINEST + 1)))
            found[f"{kind} {count} error"] = error
            found[f"{kind} {count} by data"] = error / bounds.by_data(nodes)
            found[f"{kind} {count} by solution"] = error / bounds.by_solution(nodes, states)
        smallest = minimum(found[f"{kind} {COUNTS[-1]} error"] for kind in KINDS)
        found["reference"] = furthest(problem, exact[::2], half) / smallest
        # Errors in time cannot show a wrong solver, so the error against the exact solution is measured for k ~ h.
        steps = PER_CELL * setting.level
        instants = (problem.T * np.arange(steps + 1) / steps).tolist()
        pairs = zip(instants, backward_euler(problem, instants), strict=True)
        found["fully discrete"] = maximum(setup.v_norm.distance(setup.v_norm.sample(t), u) for t, u in pairs)
        return with_h(setup.space.h, {**found, "rotation": rotating()})


def rotating() -> float:
    """Return the error of backward Euler divided by its bound, for a rotation in the plane.

    The problem is u̇ + Bu = 0, where B is κ times the rotation by a right angle.
    """
    turn = ROTATION * np.array([[0.0, 1.0], [-1.0, 0.0]])
    none = sps.csc_array((2, 2))
    start = np.array([1.0, 0.0])
    M = sps.csc_array(np.eye(2))
    problem = SemiDiscrete(M, none, turn.__matmul__, sps.csr_array((0, 2)), lambda t: np.zeros(2), start, 1.0)
    states = path(problem, BACKWARD_EULER, TURNS)
    angle = ROTATION * np.arange(TURNS + 1) / TURNS
    error = np.linalg.norm(states - np.stack([np.cos(angle), np.sin(angle)], axis=1), axis=1).max()
    flow = GradientFlow(problem, np.zeros((TURNS + 1, 2)))
    return float(error) / EulerBounds(flow, ROTATION, 0.0).by_data(np.arange(TURNS + 1))
