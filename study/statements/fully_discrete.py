"""Beyond the paper: how the error of fully discrete schemes depends on the mesh size h and the time step k.

The paper calls estimates of this error an open problem. Let u_n^{hk} be the solution of a time scheme and u^h the
semi-discrete solution (Problem 5.1). Two errors are measured for many (h, k),

    e(h, k) = max_n ‖u(t_n) − u_n^{hk}‖_V,     d(h, k) = max_n ‖u^h(t_n) − u_n^{hk}‖_V

at the nodes t_n that belong to the time grids of all k, so that all maxima are over the same times. The predictions
were made before the measurement. Results are reported without a verdict, because the paper claims nothing:

* e² = (C_h h^p)² + (C_k k^q)² with p = 1, rather than e = C_h h^p + C_k k^q. The reason is that the error in space is
  mainly interpolation error, which is nearly orthogonal in V to V^h, while the error in time lies in V^h;
* d = C k^q h^s with s = 0, so that d does not depend on h: the operator B^h is bounded uniformly in h, (5.5), so
  Problem 5.1 is not stiff;
* q = 1 for backward Euler, and q = 2 for BDF2 and the midpoint rule, but q = 3/2 where u̇^h jumps because vertices come
  into contact or leave it. No theory proves 3/2; ``landings`` shows that only order 1 may remain.
"""

import math
from collections.abc import Callable, Iterator

import numpy as np
import pandas as pd
from scipy.optimize import least_squares
from scipy.special import stdtrit

from manufactured.tensors import Array
from study.ledger.criterion import ENOUGH, Criterion, Measured, Observation, exactly
from study.ledger.window import around, at_most, between
from study.solve.evolution import Scheme
from study.solve.paths import path
from study.solve.tableau import MIDPOINT, SCHEMES
from study.statements.shared.base import ListedNumbers, Setting, grid, with_h
from study.statements.shared.experiment import Experiment, with_cached_loads
from study.statements.shared.norms import maximum

COUNTS = (4, 8, 16, 32, 64, 128)
"""Numbers of time steps. They are small, so that the error in space does not hide the error in time."""
FINEST = 1024
"""Number of steps of the midpoint rule whose solution is used as the semi-discrete solution u^h."""
ASYMPTOTIC = COUNTS[2:]
"""Numbers of time steps from which the order in k of the error in time, d, is computed."""
VISIBLE = 0.5
"""Smallest fraction of the error in time in the total error, d/e, at which an order in k is computed from e.

It must be reached for two numbers of steps."""
SECOND = between(1.5, 2, 0.1, 0.1, "3/2 where vertices come into contact or leave it")
ORDERS = {"backward-euler": around(1, 0.1), "bdf2": SECOND, "midpoint": SECOND}
CONFIDENCE = 0.95
"""Confidence level of the intervals of fitted parameters."""
IN_H = around(1, 0.15)
OPEN = "the paper leaves the fully discrete error open"
KEYS = "time-in-k", "time-in-h", "error-in-h", "error-in-k", "misfit", "sum-in-h", "sum-in-k"
"""The keys of the fitted quantities of each scheme, in the order in which ``observations`` yields them."""


def columns(scheme: Scheme, which: str) -> list[str]:
    """Return the names of the columns with an error of a scheme, one for each number of steps.

    Args:
        scheme: the time scheme.
        which: "e" for the total error, "d" for the error in time.
    """
    return [f"{scheme.name} {count} {which}" for count in COUNTS]


def observations(scheme: Scheme) -> Iterator[Observation]:
    """Yield the quantities that are reported for a scheme: observed orders in h and k, and the misfit of a fit."""
    order, needs = ORDERS[scheme.name], tuple(columns(scheme, "e") + columns(scheme, "d"))
    in_time, error, fitted = "‖u^h − u^{hk}‖", "‖u − u^{hk}‖", "C_h h^p + C_k k^q fitted to ‖u − u^{hk}‖"
    table = (
        (f"order q of {in_time} in k", order),
        (f"order s of {in_time} in h", around(0, 0.1)),
        (f"order p of {error} in h", IN_H),
        (f"order q of {error} in k", order),
        ("misfit of ((C_h h^p)² + (C_k k^q)²)^{1/2} / misfit of C_h h^p + C_k k^q", at_most(1.0)),
        (f"order p of {fitted}", IN_H),
        (f"order q of {fitted}", order),
    )
    for key, (quantity, window) in zip(KEYS, table, strict=True):

        def measure(levels: pd.DataFrame, key: str = key) -> Measured | None:
            e, d = (levels[columns(scheme, which)].to_numpy() for which in "ed")
            return fitted_orders(levels["h"].to_numpy(), e, d)[key]

        named = f"{scheme.name}-{key}", f"{scheme.name}: {quantity}"
        yield Observation(Criterion(*named, window, measure, needs, ENOUGH), OPEN)


class FullyDiscrete(ListedNumbers):
    """Measures the total error and the error in time of backward Euler, BDF2 and the midpoint rule."""

    label = "beyond: fully discrete"
    effort = 30
    claim = "the fully discrete error is of order p in h and q in k, which the paper leaves open"
    rules = tuple(rule for scheme in SCHEMES for rule in observations(scheme))
    # The quick study leaves this statement out: nothing is judged, and every mesh needs a solution with 1024 steps.
    full = grid(("full-contact", "advance-recede", "travelling-patch", "yield-and-release"), ("shaken",), (6, 12, 24))

    def measure(self, setting: Setting) -> dict[str, float]:
        setup = Experiment.at(setting, MIDPOINT, FINEST)
        v_norm, M, T, common = setup.v_norm, setup.problem.M, setup.problem.T, min(COUNTS)
        problem = with_cached_loads(setup.problem, 12)
        reference = path(problem, MIDPOINT, FINEST)[:: FINEST // common]
        samples = [v_norm.sample(n * T / common) for n in range(common + 1)]
        found: dict[str, float] = {}
        for scheme in SCHEMES:
            for count in COUNTS:
                states = path(problem, scheme, count)[:: count // common]
                pairs = list(zip(reference - states, samples, states, strict=True))
                found[f"{scheme.name} {count} e"] = maximum(v_norm.distance(sample, u) for _, sample, u in pairs)
                found[f"{scheme.name} {count} d"] = maximum(math.sqrt(v @ (M @ v)) for v, _, _ in pairs)
        return with_h(setup.space.h, found)


def fitted_orders(h: Array, e: Array, d: Array) -> dict[str, Measured | None]:
    """Fit the orders in h and k of the error in time and of the total error of one scheme, by least squares.

    The error in time is fitted by d = C k^q h^s for the smaller steps. The total error is fitted by
    e^r = (C_h h^p)^r + (C_k k^q)^r for r = 2 and r = 1. Its order in k is None if the error in space hides the error in
    time for nearly all steps.

    Args:
        h: the mesh sizes, from coarse to fine, (levels,).
        e, d: the total error and the error in time, (levels, numbers of steps).

    Returns:
        The fitted quantities by the keys in ``KEYS``; all None if an error is not positive.
    """
    if not all(np.isfinite(errors).all() and (errors > 0).all() for errors in (e, d)):
        return dict.fromkeys(KEYS)
    log_h, log_k, log_e = np.log(h)[:, None], -np.log(COUNTS), np.log(e)
    last_k, last_d = -np.log(ASYMPTOTIC), np.log(d[:, -len(ASYMPTOTIC) :])
    start = np.array([0.0, 1.0, 0.0])
    (C, q, s), _ = fit(lambda x: (x[0] + x[1] * last_k + x[2] * log_h - last_d).ravel(), start)

    def sum_of_powers(power: float) -> tuple[list[Measured], float]:
        """Fit e^r = (C_h h^p)^r + (C_k k^q)^r with r = power to the total error e.

        Start values are taken from the fit of the error in time.

        Returns:
            The parameters log C_h, p, log C_k, q, and the root mean square of the residuals.
        """

        def residuals(x: Array) -> Array:
            parts = np.logaddexp(power * (x[0] + x[1] * log_h), power * (x[2] + x[3] * log_k))
            return (parts / power - log_e).ravel()

        least = np.unravel_index(np.argmin(e), e.shape)
        return fit(residuals, np.array([log_e[least] - log_h[least[0], 0], 1.0, C[0], q[0]]))

    (squares, misfit), (sums, misfit_of_sums) = sum_of_powers(2.0), sum_of_powers(1.0)
    visible = int(np.sum(d[-1] / e[-1] >= VISIBLE)) >= 2
    found = q, s, squares[1], squares[3] if visible else None, exactly(misfit / misfit_of_sums)
    return dict(zip(KEYS, (*found, sums[1], sums[3] if visible else None), strict=True))


def fit(residuals: Callable[[Array], Array], start: Array) -> tuple[list[Measured], float]:
    """Return the parameters x that minimise a sum of squared residuals, with confidence intervals.

    Args:
        residuals: the function that returns the residuals for parameters x.
        start: the start values of the parameters.

    Returns:
        The parameters with Student intervals at 95 %, from the Jacobian at the minimum, and the root mean square
        residual.
    """
    found = least_squares(residuals, start, method="lm", x_scale="jac")
    freedom = len(found.fun) - len(start)
    variance = 2 * found.cost / freedom
    spread = np.sqrt(variance * np.diag(np.linalg.pinv(found.jac.T @ found.jac)))
    half = float(stdtrit(freedom, (1 + CONFIDENCE) / 2)) * spread
    parameters = [(x, (x - r, x + r)) for x, r in zip(found.x.tolist(), half.tolist(), strict=True)]
    return parameters, float(np.sqrt(variance))
