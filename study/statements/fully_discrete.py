"""Beyond the source: the fully discrete error in h and k, for which it says that estimates are open.

With u_n^{hk} of a time scheme and u^h of Problem 5.1 two errors are measured over tables of (h, k):

    e(h, k) = max_n ‖u(t_n) − u_n^{hk}‖_V,     d(h, k) = max_n ‖u^h(t_n) − u_n^{hk}‖_V

over the nodes t_n that all grids of a table have in common, so that every entry is a maximum over the same times.
Predicted before measuring:

* e² = (C_h h^p)² + (C_k k^q)² with p = 1, rather than e = C_h h^p + C_k k^q: e is nearly all interpolation
  error, which is nearly orthogonal in V to V^h, where the error in time lies;
* d = C k^q h^s with s = 0: B^h is bounded uniformly in h, (5.5), so that the system of Problem 5.1 is not stiff
  and no scheme sees h;
* q = 1 for backward Euler; q = 2 for BDF2 and the midpoint rule, falling to 3/2 where u̇^h jumps because
  vertices change between contact and release.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import islice

import numpy as np
import pandas as pd
from scipy.optimize import least_squares
from scipy.stats import t as student

from manufactured.tensors import Array
from study.fem.naming import family_named, resolve
from study.ledger.criterion import Criterion, Measure, Measured, Observation, Rule, judge
from study.ledger.measures import ENOUGH
from study.ledger.orders import CONFIDENCE
from study.ledger.verdict import Verdict
from study.ledger.window import Window, around, at_most, between
from study.solve.evolution import Scheme
from study.solve.tableau import MIDPOINT, SCHEMES
from study.statements.prop_5_4.experiment import Experiment
from study.statements.shared.base import ListedNumbers, Setting, grid, with_h

COUNTS = (4, 8, 16, 32, 64, 128)
"""Time steps of the tables: so few that the error in time is seen beside that in space."""
FINEST = 1024
"""Steps of the midpoint rule that stands for u^h."""
ASYMPTOTIC = COUNTS[2:]
"""Steps from which the order of d is read."""
VISIBLE = 0.5
"""An order in k is read from e only if d is this part of it for two numbers of steps."""

FIRST = around(1, 0.1)
SECOND = between(1.5, 2, 0.1, 0.1, "3/2 where vertices change contact")
ORDERS = {"backward-euler": FIRST, "bdf2": SECOND, "midpoint": SECOND}
IN_H = around(1, 0.15)
NOT_STIFF = around(0, 0.1)
BETTER = at_most(1.0)
OPEN = "the source leaves it open (no number: not to be seen; undecided: a wide interval)"


@dataclass(frozen=True)
class ParameterFit:
    """Parameters of a least-squares fit.

    Attributes:
        values: the parameters.
        half: half widths of their Student intervals at 95 %.
        misfit: root mean square of the residuals.
    """

    values: Array
    half: Array
    misfit: float

    def parameter(self, i: int) -> Measured:
        """(value, interval) of parameter i."""
        value, half = float(self.values[i]), float(self.half[i])
        return value, (value - half, value + half)


def fit(residuals: Callable[[Array], Array], start: Array) -> ParameterFit:
    """min Σ r_i² from a start; intervals from the Jacobian at the minimum."""
    found = least_squares(residuals, start, method="lm", x_scale="jac")
    freedom = len(found.fun) - len(start)
    variance = 2 * found.cost / freedom
    spread = np.sqrt(variance * np.diag(np.linalg.pinv(found.jac.T @ found.jac)))
    return ParameterFit(found.x, float(student.ppf((1 + CONFIDENCE) / 2, freedom)) * spread, float(np.sqrt(variance)))


def time_fit(h: Array, k: Array, d: Array) -> ParameterFit:
    """(log C, q, s) of d = C k^q h^s."""
    return fit(lambda x: x[0] + x[1] * np.log(k) + x[2] * np.log(h) - np.log(d), np.array([0.0, 1.0, 0.0]))


def joint_fit(h: Array, k: Array, e: Array, time: ParameterFit, power: float) -> ParameterFit:
    """(log C_h, p, log C_k, q) of e^r = (C_h h^p)^r + (C_k k^q)^r for a given power r, started from the fit of d."""

    def residuals(x: Array) -> Array:
        parts = np.logaddexp(power * (x[0] + x[1] * np.log(h)), power * (x[2] + x[3] * np.log(k)))
        return parts / power - np.log(e)

    finest = int(np.argmin(e))
    return fit(residuals, np.array([np.log(e[finest] / h[finest]), 1.0, time.values[0], time.values[1]]))


@dataclass(frozen=True)
class FullyDiscrete(ListedNumbers):
    """e(h, k) and d(h, k) for backward Euler, BDF2 and the midpoint rule."""

    label: str = "beyond: fully discrete"
    claim: str = "the fully discrete error is of order p in h and q in k, open in the source"

    def places(self, full: bool) -> list[Setting]:
        # Nothing is judged here, and every table needs a solution in a thousand steps: left to the full study.
        cases = ("full-contact", "advance-recede", "travelling-patch", "yield-and-release") if full else ()
        return grid(cases, ("shaken",), (6, 12, 24))

    def measure(self, setting: Setting) -> dict[str, float]:
        solution = resolve(setting.case).solution
        setup = Experiment.of(solution, family_named(setting.family), setting.level, MIDPOINT, FINEST)
        return with_h(setup.space.h, dict(errors(setup)))

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        return judge(self, rows, LINES)


def errors(setup: Experiment) -> Iterator[tuple[str, float]]:
    """e and d of every scheme and number of steps, under the names of ``columns``."""
    gauge, M = setup.gauge, setup.problem.M
    # Schemes and grids share most of their times.
    load = lru_cache(maxsize=None)(setup.problem.load)
    problem = replace(setup.problem, load=lambda t: load(round(t, 12)))
    common = min(COUNTS)
    reference = [state.u for n, state in enumerate(MIDPOINT.march(problem, FINEST)) if n % (FINEST // common) == 0]
    samples = [gauge.sample(n * problem.T / common) for n in range(common + 1)]
    for scheme in SCHEMES:
        for count in COUNTS:
            at_common = islice(scheme.march(problem, count), 0, None, count // common)
            pairs = [(reference[n] - state.u, gauge.distance(samples[n], state.u)) for n, state in enumerate(at_common)]
            yield f"{scheme.name} {count} e", max(error for _, error in pairs)
            yield f"{scheme.name} {count} d", max(math.sqrt(v @ (M @ v)) for v, _ in pairs)


def columns(scheme: Scheme, which: str, counts: tuple[int, ...]) -> list[str]:
    """The columns of e or d of a scheme."""
    return [f"{scheme.name} {count} {which}" for count in counts]


@dataclass(frozen=True)
class ErrorTable:
    """The errors of one scheme on one mesh family.

    Attributes:
        scheme: the scheme.
        levels: rows are levels, coarse to fine, columns as in ``columns``.
    """

    scheme: Scheme
    levels: pd.DataFrame

    def entries(self, which: str, counts: tuple[int, ...]) -> tuple[Array, Array, Array]:
        """h, k/T and e or d of all entries."""
        h, k = np.meshgrid(self.levels["h"].to_numpy(), 1 / np.array(counts), indexing="ij")
        return h.ravel(), k.ravel(), self.levels[columns(self.scheme, which, counts)].to_numpy().ravel()

    def usable(self) -> bool:
        """Whether every error is positive and finite."""
        values = np.concatenate([self.entries(which, COUNTS)[2] for which in "ed"])
        return bool((np.isfinite(values) & (values > 0)).all())

    def visible(self) -> bool:
        """Whether the error in time can be seen in e."""
        shares = self.entries("d", COUNTS)[2] / self.entries("e", COUNTS)[2]
        return int(np.sum(shares[-len(COUNTS) :] >= VISIBLE)) >= 2

    def in_time(self) -> ParameterFit:
        """The fit of d."""
        return time_fit(*self.entries("d", ASYMPTOTIC))

    def jointly(self, power: float = 2.0) -> ParameterFit:
        """The fit of e."""
        return joint_fit(*self.entries("e", COUNTS), self.in_time(), power)

    def misfits(self) -> Measured:
        """Misfit of the root of the sum of squares over that of the sum."""
        value = self.jointly().misfit / self.jointly(1.0).misfit
        return value, (value, value)


def lines(scheme: Scheme) -> Iterator[Rule]:
    """What is reported for a scheme."""
    order, needs = ORDERS[scheme.name], tuple(columns(scheme, "e", COUNTS) + columns(scheme, "d", COUNTS))
    found: list[tuple[str, str, Window, Callable[[ErrorTable], Measured | None]]] = [
        ("time-in-k", "order q of ‖u^h − u^{hk}‖ in k", order, lambda table: table.in_time().parameter(1)),
        ("time-in-h", "order s of ‖u^h − u^{hk}‖ in h", NOT_STIFF, lambda table: table.in_time().parameter(2)),
        ("error-in-h", "order p of ‖u − u^{hk}‖ in h", IN_H, lambda table: table.jointly().parameter(1)),
        (
            "error-in-k",
            "order q of ‖u − u^{hk}‖ in k",
            order,
            lambda table: table.jointly().parameter(3) if table.visible() else None,
        ),
        ("misfit", "misfit of the root of squares / misfit of C_h h^p + C_k k^q", BETTER, ErrorTable.misfits),
        (
            "sum-in-h",
            "order p of C_h h^p + C_k k^q fitted to ‖u − u^{hk}‖",
            IN_H,
            lambda table: table.jointly(1.0).parameter(1),
        ),
        (
            "sum-in-k",
            "order q of C_h h^p + C_k k^q fitted to ‖u − u^{hk}‖",
            order,
            lambda table: table.jointly(1.0).parameter(3) if table.visible() else None,
        ),
    ]
    for key, quantity, window, of in found:
        yield Observation(
            Criterion(f"{scheme.name}-{key}", f"{scheme.name}: {quantity}", window, _on(scheme, of), needs, ENOUGH),
            OPEN,
        )


def _on(scheme: Scheme, of: Callable[[ErrorTable], Measured | None]) -> Measure:
    def measure(group: pd.DataFrame) -> Measured | None:
        table = ErrorTable(scheme, group)
        return of(table) if table.usable() else None

    return measure


LINES = tuple(line for scheme in SCHEMES for line in lines(scheme))
