"""Beyond the source: the fully discrete error in h and k, for which it says that estimates are open.

With u_n^{hk} of a time scheme and u^h of Problem 5.1 two errors are measured over tables of (h, k):

    e(h, k) = max_n ‖u(t_n) − u_n^{hk}‖_V,     d(h, k) = max_n ‖u^h(t_n) − u_n^{hk}‖_V

over the nodes t_n that all grids of a table have in common, so that every entry is a maximum over the same times.
Predicted before measuring:

* e² = (C_h h^p)² + (C_k k^q)² with p = 1, rather than e = C_h h^p + C_k k^q: e is nearly all interpolation error,
  which is nearly orthogonal in V to V^h, where the error in time lies;
* d = C k^q h^s with s = 0: B^h is bounded uniformly in h, (5.5), so that Problem 5.1 is not stiff, no scheme sees h;
* q = 1 for backward Euler; q = 2 for BDF2 and the midpoint rule, 3/2 where u̇^h jumps because vertices change contact.
  For 3/2 there is no theory: ``statements.landings`` shows that 1 may be left.
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
from scipy.special import stdtrit

from manufactured.tensors import Array
from study.ledger.criterion import Criterion, Measure, Measured, Observation, Rule
from study.ledger.measures import ENOUGH, exactly
from study.ledger.orders import CONFIDENCE
from study.ledger.window import Window, around, at_most, between
from study.solve.evolution import Scheme
from study.solve.tableau import MIDPOINT, SCHEMES
from study.statements.shared.base import ListedNumbers, Setting, grid, with_h
from study.statements.shared.experiment import Experiment

COUNTS = (4, 8, 16, 32, 64, 128)
"""Time steps of the tables: so few that the error in time is seen beside that in space."""
FINEST = 1024
"""Steps of the midpoint rule that stands for u^h."""
ASYMPTOTIC = COUNTS[2:]
"""Steps from which the order of d is read."""
VISIBLE = 0.5
"""An order in k is read from e only if d is this part of it for two numbers of steps."""
SECOND = between(1.5, 2, 0.1, 0.1, "3/2 where vertices change contact")
ORDERS = {"backward-euler": around(1, 0.1), "bdf2": SECOND, "midpoint": SECOND}
IN_H = around(1, 0.15)
OPEN = "the source leaves it open (no number: not to be seen; undecided: a wide interval)"


@dataclass(frozen=True)
class ParameterFit:
    """Parameters of a least-squares fit with half widths of their Student intervals at 95 %.

    ``misfit`` is the root mean square of the residuals.
    """

    values: Array
    half: Array
    misfit: float

    @classmethod
    def of(cls, residuals: Callable[[Array], Array], start: Array) -> ParameterFit:
        """min Σ r_i² from a start; intervals from the Jacobian at the minimum."""
        found = least_squares(residuals, start, method="lm", x_scale="jac")
        freedom = len(found.fun) - len(start)
        variance = 2 * found.cost / freedom
        spread = np.sqrt(variance * np.diag(np.linalg.pinv(found.jac.T @ found.jac)))
        return cls(found.x, float(stdtrit(freedom, (1 + CONFIDENCE) / 2)) * spread, float(np.sqrt(variance)))

    def parameter(self, i: int) -> Measured:
        """(value, interval) of parameter i."""
        value, half = float(self.values[i]), float(self.half[i])
        return value, (value - half, value + half)


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
    """The errors of one scheme on the levels of one mesh family, coarse to fine, with columns as in ``columns``."""

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
        """(log C, q, s) of d = C k^q h^s."""
        h, k, d = self.entries("d", ASYMPTOTIC)
        start = np.array([0.0, 1.0, 0.0])
        return ParameterFit.of(lambda x: x[0] + x[1] * np.log(k) + x[2] * np.log(h) - np.log(d), start)

    def jointly(self, power: float = 2.0) -> ParameterFit:
        """(log C_h, p, log C_k, q) of e^r = (C_h h^p)^r + (C_k k^q)^r for a power r, started from the fit of d."""
        h, k, e = self.entries("e", COUNTS)

        def residuals(x: Array) -> Array:
            parts = np.logaddexp(power * (x[0] + x[1] * np.log(h)), power * (x[2] + x[3] * np.log(k)))
            return parts / power - np.log(e)

        finest, time = int(np.argmin(e)), self.in_time().values
        return ParameterFit.of(residuals, np.array([np.log(e[finest] / h[finest]), 1.0, time[0], time[1]]))

    def order_in_k(self, power: float = 2.0) -> Measured | None:
        """q of the fit of e; none where the error in time is not seen."""
        return self.jointly(power).parameter(3) if self.visible() else None

    def misfits(self) -> Measured:
        """Misfit of the root of the sum of squares over that of the sum."""
        return exactly(self.jointly().misfit / self.jointly(1.0).misfit)


def lines(scheme: Scheme) -> Iterator[Rule]:
    """What is reported of a scheme."""
    order, needs = ORDERS[scheme.name], tuple(columns(scheme, "e", COUNTS) + columns(scheme, "d", COUNTS))
    in_time, error, fitted = "‖u^h − u^{hk}‖", "‖u − u^{hk}‖", "C_h h^p + C_k k^q fitted to ‖u − u^{hk}‖"
    found: list[tuple[str, str, Window, Callable[[ErrorTable], Measured | None]]] = [
        ("time-in-k", f"order q of {in_time} in k", order, lambda table: table.in_time().parameter(1)),
        ("time-in-h", f"order s of {in_time} in h", around(0, 0.1), lambda table: table.in_time().parameter(2)),
        ("error-in-h", f"order p of {error} in h", IN_H, lambda table: table.jointly().parameter(1)),
        ("error-in-k", f"order q of {error} in k", order, lambda table: table.order_in_k()),
        ("misfit", "misfit of the root of squares / misfit of C_h h^p + C_k k^q", at_most(1.0), ErrorTable.misfits),
        ("sum-in-h", f"order p of {fitted}", IN_H, lambda table: table.jointly(1.0).parameter(1)),
        ("sum-in-k", f"order q of {fitted}", order, lambda table: table.order_in_k(1.0)),
    ]
    for key, quantity, window, of in found:
        named = f"{scheme.name}-{key}", f"{scheme.name}: {quantity}"
        yield Observation(Criterion(*named, window, on(scheme, of), needs, ENOUGH), OPEN)


def on(scheme: Scheme, of: Callable[[ErrorTable], Measured | None]) -> Measure:
    """What a table of a scheme says, if it is usable."""

    def measure(group: pd.DataFrame) -> Measured | None:
        table = ErrorTable(scheme, group)
        return of(table) if table.usable() else None

    return measure


class FullyDiscrete(ListedNumbers):
    """e(h, k) and d(h, k) for backward Euler, BDF2 and the midpoint rule."""

    label = "beyond: fully discrete"
    effort = 30
    claim = "the fully discrete error is of order p in h and q in k, open in the source"
    rules = tuple(line for scheme in SCHEMES for line in lines(scheme))
    # Nothing is judged here, and every table needs a solution in a thousand steps: left to the full study.
    full = grid(("full-contact", "advance-recede", "travelling-patch", "yield-and-release"), ("shaken",), (6, 12, 24))

    def measure(self, setting: Setting) -> dict[str, float]:
        setup = Experiment.at(setting, MIDPOINT, FINEST)
        return with_h(setup.space.h, dict(errors(setup)))
