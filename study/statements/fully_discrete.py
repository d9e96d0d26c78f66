"""Beyond the paper: how the error of fully discrete schemes depends on the mesh size h and the time step k.

The paper calls estimates of this error an open problem. Let u_n^{hk} be the solution of a time scheme and u^h the
semi-discrete solution (Problem 5.1). Two errors are measured for many (h, k),

    e(h, k) = max_n ‖u(t_n) − u_n^{hk}‖_V,     d(h, k) = max_n ‖u^h(t_n) − u_n^{hk}‖_V

at the nodes t_n that belong to the time grids of all k, so that all maxima are over the same times. The predictions
were made before the measurement. A wrong prediction contradicts no claim, because the paper claims nothing:

* d = C k^q h^s with s = 0, so that d does not depend on h: the operator B^h is bounded uniformly in h, (5.5), so
  Problem 5.1 is not stiff;
* q = 1 for backward Euler, and q = 2 for BDF2 and the midpoint rule, but q = 3/2 where u̇^h jumps because vertices come
  into contact or leave it. No theory proves 3/2; ``landings`` shows that only order 1 may remain;
* e has the order 1 in h for the smallest k.
"""

import math
from collections.abc import Iterator

import numpy as np
import pandas as pd

from manufactured.tensors import Array
from study.ledger.check import ENOUGH, Check, consequence
from study.ledger.quantities import fitted
from study.ledger.window import around, between
from study.solve.evolution import Scheme
from study.solve.paths import path
from study.solve.tableau import MIDPOINT, SCHEMES
from study.statements.shared.base import ListedNumbers, Numbers, Setting, grid, with_h
from study.statements.shared.experiment import Experiment, with_cached_loads
from study.statements.shared.norms import maximum

COUNTS = (4, 8, 16, 32, 64, 128)
"""Numbers of time steps. They are small, so that the error in space does not hide the error in time."""
FINEST = 1024
"""Number of steps of the midpoint rule whose solution is used as the semi-discrete solution u^h."""
ASYMPTOTIC = COUNTS[2:]
"""Numbers of time steps from which the order in k of the error in time, d, is computed."""
SECOND = between(1.5, 2, 0.1, 0.1, "3/2 where vertices come into contact or leave it")
ORDERS = {"backward-euler": around(1, 0.1), "bdf2": SECOND, "midpoint": SECOND}


def checks_of_scheme(scheme: Scheme) -> Iterator[Check]:
    """Yield the checks of a time scheme: the orders of the error in time in k and in h, and of the error in h."""
    name = scheme.name
    in_time = "‖u^h − u^{hk}‖"

    def in_k(levels: pd.DataFrame) -> float:
        return power_law(levels, scheme)[0]

    def in_h(levels: pd.DataFrame) -> float:
        return power_law(levels, scheme)[1]

    of_error = fitted(f"{name} {COUNTS[-1]} e")
    for key, quantity, value, window in (
        ("time-in-k", f"order q of {in_time} in k", in_k, ORDERS[name]),
        ("time-in-h", f"order s of {in_time} in h", in_h, around(0, 0.1)),
        ("error-in-h", "order p of ‖u − u^{hk}‖ in h", of_error, around(1, 0.15)),
    ):
        key = f"{name}-{key}"
        quantity = f"{name}: {quantity}"
        yield consequence(
            key, quantity, value, window, levels=ENOUGH, if_missed="the paper leaves the fully discrete error open"
        )


def power_law(levels: pd.DataFrame, scheme: Scheme) -> Array:
    """Return the exponents (q, s) of the error in time, d = C k^q h^s, by least squares for the smaller steps."""
    columns = [f"{scheme.name} {count} d" for count in ASYMPTOTIC]
    d = levels[columns].to_numpy()
    h = levels["h"].to_numpy()
    log_k, log_h = np.meshgrid(-np.log(ASYMPTOTIC), np.log(h))
    unknowns = np.column_stack([log_k.ravel(), log_h.ravel(), np.ones(d.size)])
    solution, *_ = np.linalg.lstsq(unknowns, np.log(d).ravel(), rcond=None)
    return solution[:2]


class FullyDiscrete(ListedNumbers):
    """Measures the total error and the error in time of backward Euler, BDF2 and the midpoint rule."""

    label = "beyond: fully discrete"
    effort = 30
    claim = "the fully discrete error is of order p in h and q in k, which the paper leaves open"
    checks = tuple(check for scheme in SCHEMES for check in checks_of_scheme(scheme))
    # The quick study leaves this statement out: nothing is claimed, and every mesh needs a solution with 1024 steps.
    full = grid(("advance-recede", "yield-and-release"), ("shaken",), (6, 12, 24))

    def measure(self, setting: Setting) -> Numbers:
        setup = Experiment.at(setting, MIDPOINT, FINEST)
        v_norm = setup.v_norm
        M = setup.problem.M
        T = setup.problem.T
        common = min(COUNTS)
        problem = with_cached_loads(setup.problem, 12)
        reference = path(problem, MIDPOINT, FINEST)[:: FINEST // common]
        samples = [v_norm.sample(n * T / common) for n in range(common + 1)]
        measured: Numbers = {}
        for scheme in SCHEMES:
            for count in COUNTS:
                states = path(problem, scheme, count)[:: count // common]
                pairs = list(zip(reference - states, samples, states, strict=True))
                measured[f"{scheme.name} {count} e"] = maximum(v_norm.distance(sample, u) for _, sample, u in pairs)
                measured[f"{scheme.name} {count} d"] = maximum(math.sqrt(v @ (M @ v)) for v, _, _ in pairs)
        return with_h(setup.space.h, measured)
