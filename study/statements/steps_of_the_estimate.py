"""(5.11)–(5.19): the inequalities between Problem 5.1 and the estimate (5.21), with their constants, at single times.

With e = u − u^h, η = u − v^h, L = L_G/m_A and v^h = Π^h u, where (5.14) is read with L for its L_G (the ledger's
slips), Young's inequality and (5.17) make of it

    (5.14)  ‖e(t)‖² ≤ ‖e_0‖² + 2∫(ė, η)_V + 2L∫‖e‖ ‖η‖ + 2L∫‖e‖² + 2∫|R(·; −η)|,
    (5.15)  ∫(ė, η)_V = (e(t), η(t))_V − (e_0, η_0)_V − ∫(e, η̇)_V,
    (5.16)  ‖e(t)‖² ≤ 4‖η(t)‖² + 4‖e_0‖² + 2‖η_0‖² + (2 + 6L)∫‖e‖² + 2L∫‖η‖² + 2∫‖η̇‖² + 4∫|R|,
    (5.18)  ‖η(t)‖² ≤ 2‖η_0‖² + 2t∫‖η̇‖²   and   ∫‖η‖² ≤ 2t‖η_0‖² + t²∫‖η̇‖²,
    (5.19)  ‖e(t)‖² ≤ 4‖e_0‖² + (10 + 4Lt)‖η_0‖² + (2 + 6L)∫‖e‖² + (2 + 8t + 2Lt²)∫‖η̇‖² + 4∫|R|,

integrals over (0, t). R(t; v) = ∫_{Γ3} σ_ν v_ν, (5.40), is compared with its definition (5.13) in ``residual``.

**(5.12), at the nodes of backward Euler.** Of u^h it uses (5.3) at one time alone, which u_n satisfies with δu_n for
u̇^h, whatever the step. The right side less the left is what (5.1) with v = u^h and (5.3) with v^h leave,

    −λ·N v^h + ∫_{Γ3} σ_ν u^h_ν ≥ 0,

λ the multipliers of the step: an equation, which fails where a side is too large as where it is too small. It is asked
of v^h = Π^h u, of v^h = 0 and of random members of K^h, which make (5.12) what it is: for any v^h ∈ K^h. Predicted:
round-off, as u^h is solved with the stress at the points at which the terms are summed. For law (3.3) what the fixed
point leaves of (5.3), some 1e-11 of u, is seen beside products with e, some h of u: 1e-9. The first window, 1e-10, had
forgotten that.

**The others, along the midpoint rule,** from t = T/32 to T, with two points of Gauss in every step. Predicted for the
largest share of the left in the right: e is about η (``superclose``), and with a time scale of T

* (5.14): 1/(1 + 4Lt) for errors that stay, which is 0.6 … 0.8 at t = T/32 for L = 5 … 2, and 0.8 … 0.98 for errors
  that grow from zero like t or t²;
* (5.15): an equation, but for k² = 1e-4 of the terms where u̇ or u̇^h jumps within a step. With one point for a step,
  as at first, errors that grow from zero left 0.015 after six steps;
* (5.16): at most 1/4, from ‖η(t)‖² alone; 0.03 … 0.15 with the rest;
* (5.18): up to 1, attained where η_0 = ∫η̇; 1/2 where η grows from zero;
* (5.19): ‖η_0‖² or t∫‖η̇‖² count ten times: 0.01 … 0.1.

Shares below a third of that would say that terms are counted which the proof does not have. ∫‖e‖² on the right lets
wrong u^h pass at late times: one whose error grows like t, and is not of η's size, has the share 3/((2 + 6L) t) in
(5.16) and (5.19), more than 1 before t = 3/(2 + 6L) alone, which is why early times are among those that are looked at.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from manufactured.tensors import Array
from study.fem.quadrature.rules import gauss
from study.ledger.measures import largest
from study.ledger.window import Window, above_nothing, at_most
from study.solve.evolution import FIXED_POINT, SemiDiscrete, State
from study.solve.tableau import BACKWARD_EULER, MIDPOINT
from study.statements.constraint import with_trace
from study.statements.shared.base import EVOLVING, SEED, SOFTENING, ListedNumbers, Setting, grid, with_h
from study.statements.shared.experiment import Experiment
from study.statements.shared.norms import ContactWork, Energies

NODES = 12
"""Steps of backward Euler, at the end of each of which (5.12) is asked."""
MEMBERS = 2
"""Random members of K^h at each of them."""
STEPS = 96
"""Steps of the midpoint rule."""
INSTANTS = (3, 6, 12, 24, 48, 72, 96)
"""The steps at the end of which both sides are compared."""
POINTS = 2
"""Points of Gauss in each of them."""

_BY_WHAT = f"round-off, and for law (3.3) a fixed point stopped at {FIXED_POINT:g} of u beside products with e"
NEVER, EQUAL = at_most(1e-8, _BY_WHAT, low=-np.inf), above_nothing(1e-8, _BY_WHAT)
BY_PARTS = above_nothing(0.003, "two points of Gauss leave k² ~ 1e-4 of the terms where velocities jump")
INTEGRATED = Window(0.2, 1.0, "proved; at T/32 errors that stay leave 1/(1 + L T/8)")
YOUNG = Window(0.01, 1.0, "proved; 0.03 … 0.15 for e like η")
IN_TIME = Window(0.1, 1.0, "proved; 1/2 where η grows from zero")
TOGETHER = Window(0.003, 1.0, "proved; 0.01 … 0.1 for e like η")


class StepsOfTheEstimate(ListedNumbers):
    """Left over right side of each inequality, and both sides of the equations in them."""

    label = "(5.11)–(5.16), (5.18), (5.19)"
    claim = "‖u(t) − u^h(t)‖_V² ≤ what (5.12), (5.14), (5.16) and (5.19) say, at every t and with their constants"
    rules = (
        largest("5.12", "(left − right side of (5.12)) / its terms, any v^h ∈ K^h", NEVER, "violation"),
        largest("slack-5.12", "(5.12): |right − left − work of contact| / terms", EQUAL, "slack"),
        largest("5.14", "left / right side of (5.14), t ≥ T/32", INTEGRATED, "5.14"),
        largest("5.15", "|left − right side of (5.15)| / largest term", BY_PARTS, "5.15"),
        largest("5.16", "left / right side of (5.16)", YOUNG, "5.16"),
        largest("5.18", "left / right sides of (5.18)", IN_TIME, "5.18"),
        largest("5.19", "left / right side of (5.19)", TOGETHER, "5.19"),
    )
    quick = grid(("advance-recede",), ("unstructured",), (8,))
    full = grid((*EVOLVING, "lift-and-land", "anisotropic", "hexagon", *SOFTENING), ("unstructured",), (8, 16))

    def measure(self, setting: Setting) -> dict[str, float]:
        setup = Experiment.at(setting, MIDPOINT, STEPS)
        return with_h(setup.space.h, {**at_nodes(setup), **over_time(setup)})


# (5.12).


def at_nodes(setup: Experiment) -> dict[str, float]:
    """The largest violation of (5.12), and defect of its slack, relative to the terms of (5.12)."""
    energies, pressed = Energies(setup.solution, setup.space), ContactWork(setup.solution, setup.space)
    rng, k = np.random.default_rng(SEED), setup.problem.T / NODES
    found = []
    for before, state in pairwise(BACKWARD_EULER.march(setup.problem, NODES)):
        terms = Terms(energies, pressed, state, (state.u - before.u) / k)
        for v in members(setup, energies.interpolant(state.time), rng):
            left, right = terms.left, terms.right(v)
            slack, size = sum(right) - left, abs(left) + sum(map(abs, right))
            contact = pressed(state.u, state.time) - work_of_multipliers(setup.problem, state, v)
            found.append((-slack / size, abs(slack - contact) / size))
    return dict(zip(("violation", "slack"), np.max(found, axis=0), strict=True))


def members(setup: Experiment, interpolant: Array, rng: np.random.Generator) -> Iterator[Array]:
    """Π^h u, 0 and random members of K^h of its size."""
    yield from (interpolant, 0 * interpolant)
    size = abs(interpolant).max()
    for _ in range(MEMBERS):
        nodal, normal = rng.standard_normal(setup.space.dofs), rng.standard_normal(setup.space.N.shape[0])
        yield size * with_trace(setup.space, nodal, np.minimum(normal, 0.0))


def work_of_multipliers(problem: SemiDiscrete, state: State, v: Array) -> float:
    """λ·N v."""
    return float(state.multipliers @ (problem.N @ v))


class Terms:
    """The terms of (5.12) at one time for u^h and its velocity.

    Attributes:
        left: ½ d/ds ‖u − u^h‖_V².
    """

    def __init__(self, energies: Energies, pressed: ContactWork, state: State, velocity: Array) -> None:
        self.energies, self.pressed, self.time = energies, pressed, state.time
        exact, own = energies.exact, energies.strain(state.u)
        self.strain, self.gap = exact.strain(state.time), exact.strain(state.time) - own
        self.viscous = exact.law.A(energies.strain(velocity) - exact.strain_rate(state.time))
        self.elastic = exact.law.G(own) - exact.law.G(self.strain)
        self.left = -energies.work(self.viscous, self.gap)

    def right(self, v: Array) -> tuple[float, float, float, float]:
        """The four terms on the right for v^h; R(·; u) = 0 by (2.5)."""
        along, work = self.energies.strain(v) - self.strain, self.energies.work
        terms = work(self.viscous, along), work(self.elastic, along), work(self.elastic, self.gap)
        return (*terms, self.pressed(v, self.time))


# (5.14)–(5.19).


@dataclass(frozen=True)
class Course:
    """What the inequalities are made of at one time; the first group in V, the second integrals from 0 to t.

    Attributes:
        time: t.
        e, eta: ‖e(t)‖², ‖η(t)‖².
        both: (e(t), η(t))_V.
        integrals: of (ė, η)_V, (e, η̇)_V, ‖e‖ ‖η‖, ‖e‖², ‖η‖², ‖η̇‖² and |R(·; −η)|, by these names.
    """

    time: float
    e: float
    eta: float
    both: float
    integrals: Mapping[str, float]


INTEGRANDS = "ė η", "e η̇", "|e| |η|", "e²", "η²", "η̇²", "|R|"


def over_time(setup: Experiment) -> dict[str, float]:
    """The largest share of the left side in the right one over the instants, for each inequality."""
    start, *later = courses(setup)
    L = setup.solution.law.kappa
    return dict(
        zip(("5.14", "5.15", "5.16", "5.18", "5.19"), np.max([shares(start, c, L) for c in later], 0), strict=True)
    )


def shares(start: Course, now: Course, L: float) -> tuple[float, float, float, float, float]:
    """Left over right side of (5.14), (5.16), (5.18) and (5.19); second, the defect of (5.15) over its largest term."""
    t, e0, eta0 = now.time, start.e, start.eta
    rate, parts, mixed, e, eta, eta_rate, R = (now.integrals[name] for name in INTEGRANDS)
    by_parts = now.both, -start.both, -parts
    after_young = 4 * now.eta + 4 * e0 + 2 * eta0 + (2 + 6 * L) * e + 2 * L * eta + 2 * eta_rate + 4 * R
    together = 4 * e0 + (10 + 4 * L * t) * eta0 + (2 + 6 * L) * e + (2 + 8 * t + 2 * L * t**2) * eta_rate + 4 * R
    return (
        share(now.e, e0 + 2 * (rate + L * mixed + L * e + R)),
        abs(rate - sum(by_parts)) / max(map(abs, (rate, *by_parts))),
        share(now.e, after_young),
        max(share(now.eta, 2 * eta0 + 2 * t * eta_rate), share(eta, 2 * t * eta0 + t**2 * eta_rate)),
        share(now.e, together),
    )


def share(left: float, right: float) -> float:
    """left/right, infinite where a right side that cannot be negative is."""
    return left / right if right > 0 else np.inf


def courses(setup: Experiment) -> list[Course]:
    """The start and the instants."""
    energies, pressed = Energies(setup.solution, setup.space), ContactWork(setup.solution, setup.space)
    k, found, total = setup.problem.T / STEPS, [], np.zeros(len(INTEGRANDS))
    for n, (before, state) in enumerate(pairwise(MIDPOINT.march(setup.problem, STEPS)), start=1):
        if n == 1:
            found.append(course(energies, before, total))
        total = total + k * sum(
            weight * integrands(energies, pressed, before, state, part)
            for part, weight in zip(*gauss(POINTS), strict=True)
        )
        if n in INSTANTS:
            found.append(course(energies, state, total))
    return found


def course(energies: Energies, state: State, total: Array) -> Course:
    """The norms at a node."""
    exact = energies.exact.strain(state.time)
    e, eta = exact - energies.strain(state.u), exact - energies.strain(energies.interpolant(state.time))
    squared, errors, both = energies.product(e, e), energies.product(eta, eta), energies.product(e, eta)
    return Course(state.time, squared, errors, both, dict(zip(INTEGRANDS, total, strict=True)))


def integrands(energies: Energies, pressed: ContactWork, before: State, state: State, part: float) -> Array:
    """The integrands at a part of a step, for u^h linear in between, (7,)."""
    k = state.time - before.time
    time = before.time + part * k
    strain, rate = energies.exact.strain(time), energies.exact.strain_rate(time)
    nodal = energies.interpolant(time)
    e = strain - energies.strain(before.u + part * (state.u - before.u))
    e_rate = rate - energies.strain((state.u - before.u) / k)
    eta, eta_rate = strain - energies.strain(nodal), rate - energies.strain(energies.interpolated_rate(time))
    product = energies.product
    squares = [product(field, field) for field in (e, eta, eta_rate)]
    mixed = np.sqrt(squares[0] * squares[1])
    return np.array([product(e_rate, eta), product(e, eta_rate), mixed, *squares, abs(pressed(nodal, time))])
