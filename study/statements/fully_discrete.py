"""Beyond the paper: the error of fully discrete schemes in h and k; the paper calls estimates of it an open problem.

Let u_n^{hk} be the solution of a time scheme and u^h the solution of Problem 5.1. For many (h, k) two errors are
measured,

    e(h, k) = max_n ‖u(t_n) − u_n^{hk}‖_V,     d(h, k) = max_n ‖u^h(t_n) − u_n^{hk}‖_V

at the nodes t_n that belong to the time grids of all k, so that all maxima are over the same times. Predicted before
measuring, and reported without a verdict, because the paper claims nothing:

* e² = (C_h h^p)² + (C_k k^q)² with p = 1, rather than e = C_h h^p + C_k k^q. The reason is that the error in space is
  mainly interpolation error, which is nearly orthogonal in V to V^h, while the error in time lies in V^h;
* d = C k^q h^s with s = 0: B^h is bounded uniformly in h, (5.5), so Problem 5.1 is not stiff and d does not depend on
  h;
* q = 1 for backward Euler; q = 2 for BDF2 and the midpoint rule, 3/2 where u̇^h jumps because vertices change contact.
  For 3/2 there is no theory: ``landings`` shows that only 1 may remain.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pandas as pd
from scipy.optimize import least_squares
from scipy.special import stdtrit

from manufactured.tensors import Array
from study.ledger.criterion import ENOUGH, Criterion, Measured, Observation, exactly, judge
from study.ledger.verdict import Verdict
from study.ledger.window import around, at_most, between
from study.solve.evolution import Scheme
from study.solve.paths import path
from study.solve.tableau import MIDPOINT, SCHEMES
from study.statements.shared.base import ListedNumbers, Setting, grid, with_h
from study.statements.shared.experiment import Experiment
from study.statements.shared.norms import maximum

COUNTS = (4, 8, 16, 32, 64, 128)
"""Numbers of time steps, so small that the error in time is not hidden by the error in space."""
FINEST = 1024
"""Number of steps of the midpoint rule whose solution stands for u^h."""
ASYMPTOTIC = COUNTS[2:]
"""Numbers of steps from which the order of d is computed."""
VISIBLE = 0.5
"""An order in k is computed from e only if d/e is at least this number for two numbers of steps."""
SECOND = between(1.5, 2, 0.1, 0.1, "3/2 where vertices come into contact or leave it")
ORDERS = {"backward-euler": around(1, 0.1), "bdf2": SECOND, "midpoint": SECOND}
CONFIDENCE = 0.95
"""Confidence level of the intervals of fitted parameters."""
IN_H = around(1, 0.15)
OPEN = "the paper leaves the fully discrete error open"
KEYS = "time-in-k", "time-in-h", "error-in-h", "error-in-k", "misfit", "sum-in-h", "sum-in-k"
"""The fitted quantities of each scheme."""


class FullyDiscrete(ListedNumbers):
    """Measures e(h, k) and d(h, k) for backward Euler, BDF2 and the midpoint rule."""

    label = "beyond: fully discrete"
    effort = 30
    claim = "the fully discrete error is of order p in h and q in k, which the paper leaves open"
    # Only in the full study: nothing is judged here, and every mesh needs a solution with 1024 time steps.
    full = grid(("full-contact", "advance-recede", "travelling-patch", "yield-and-release"), ("shaken",), (6, 12, 24))

    def measure(self, setting: Setting) -> dict[str, float]:
        setup = Experiment.at(setting, MIDPOINT, FINEST)
        v_norm, M, T, common = setup.v_norm, setup.problem.M, setup.problem.T, min(COUNTS)
        # Cached, because schemes and numbers of steps have most of their times in common.
        load = lru_cache(maxsize=None)(setup.problem.load)
        problem = replace(setup.problem, load=lambda t: load(round(t, 12)))
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

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        return judge(self, rows, [rule for scheme in SCHEMES for rule in observations(scheme)])


def columns(scheme: Scheme, which: str) -> list[str]:
    """Return the names of the columns with e or d ("which") of a scheme."""
    return [f"{scheme.name} {count} {which}" for count in COUNTS]


def observations(scheme: Scheme) -> Iterator[Observation]:
    """Yield the reported quantities of a scheme."""
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


def fitted_orders(h: Array, e: Array, d: Array) -> dict[str, Measured | None]:
    """Return the orders in h and k of both errors of one scheme on one mesh family, by least squares.

    d = C k^q h^s is fitted to the smaller steps. e^r = (C_h h^p)^r + (C_k k^q)^r is fitted for r = 2 and r = 1. The
    order in k is None if d is nearly everywhere hidden behind the error in space.

    Args:
        h: the mesh sizes, from coarse to fine, (levels,).
        e, d: both errors, (levels, numbers of steps).

    Returns:
        The parameters by the keys of ``observations``; all None if an error is not positive.
    """
    if not all(np.isfinite(errors).all() and (errors > 0).all() for errors in (e, d)):
        return dict.fromkeys(KEYS)
    log_h, log_k, log_e = np.log(h)[:, None], -np.log(COUNTS), np.log(e)
    last_k, last_d = -np.log(ASYMPTOTIC), np.log(d[:, -len(ASYMPTOTIC) :])
    start = np.array([0.0, 1.0, 0.0])
    (C, q, s), _ = fit(lambda x: (x[0] + x[1] * last_k + x[2] * log_h - last_d).ravel(), start)

    def sum_of_powers(power: float) -> tuple[list[Measured], float]:
        """Fit log C_h, p, log C_k and q to e, starting from the fit of d."""

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
    """Return the least-squares fit for residuals r(x).

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
