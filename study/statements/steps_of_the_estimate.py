"""(5.11)–(5.19): the inequalities in the proof of the estimate (5.21), tested with their constants at single times.

Let e = u − u^h be the error, v^h = Π^h u, η = u − Π^h u and L = L_G/m_A. R(t; v) = ∫_{Γ3} σ_ν v_ν by (5.40);
``residual`` compares it with the definition (5.13). With Young's inequality and (5.17) the inequalities are

    (5.14)  ‖e(t)‖² ≤ ‖e_0‖² + 2∫(ė, η)_V + 2L∫‖e‖ ‖η‖ + 2L∫‖e‖² + 2∫|R(·; −η)|,
    (5.15)  ∫(ė, η)_V = (e(t), η(t))_V − (e_0, η_0)_V − ∫(e, η̇)_V,
    (5.16)  ‖e(t)‖² ≤ 4‖η(t)‖² + 4‖e_0‖² + 2‖η_0‖² + (2 + 6L)∫‖e‖² + 2L∫‖η‖² + 2∫‖η̇‖² + 4∫|R|,
    (5.18)  ‖η(t)‖² ≤ 2‖η_0‖² + 2t∫‖η̇‖²   and   ∫‖η‖² ≤ 2t‖η_0‖² + t²∫‖η̇‖²,
    (5.19)  ‖e(t)‖² ≤ 4‖e_0‖² + (10 + 4Lt)‖η_0‖² + (2 + 6L)∫‖e‖² + (2 + 8t + 2Lt²)∫‖η̇‖² + 4∫|R|,

where all integrals are over (0, t). In (5.14) the paper prints L_G for L (see the misprints in the ledger).

**(5.12), at the nodes of backward Euler.** The proof of (5.12) uses (5.3) for u^h at one time only. A step of backward
Euler satisfies (5.3) with δu_n for u̇^h, whatever its length, so (5.12) can be tested without an error in time. The
right side minus the left side of (5.12) is

    −λ·N v^h + ∫_{Γ3} σ_ν u^h_ν ≥ 0,

with the contact forces λ of the step: (5.1) with v = u^h and (5.3) with v^h leave these terms. The check "slack" tests
this equation, which fails whether a side is too large or too small. (5.12) is claimed for every v^h ∈ K^h, so v^h = Π^h
u, v^h = 0 and random members of K^h are used. Predicted: round-off, because the load of u^h is integrated with the
stress at the same points as the terms. For law (3.3) the fixed-point iteration leaves 1e-11 of u in (5.3), while
products with e are smaller than products with u by a factor h: 1e-9. The first window, 1e-10, ignored this.

**The other inequalities, along the midpoint rule,** from t = T/32 to T, with two Gauss points in every step. Predicted
for the largest ratio of the left to the right side, if e is about as large as η (``superclose``):

* (5.14): 1/(1 + 4Lt) for errors that are constant in time, which is 0.6 to 0.8 at t = T/32 for L = 5 to 2 and T = 1;
  0.8 to 0.98 for errors that grow from zero like t or t²;
* (5.15): it is an equation, so only the quadrature error remains: k² = 1e-4 of the terms where u̇ or u̇^h jumps within
  a step. With one Gauss point in a step, as at first, errors that grow from zero left 0.015 after six steps;
* (5.16): at most 1/4, from 4‖η(t)‖² alone; 0.03 to 0.15 with all terms;
* (5.18): up to 1, attained where η_0 = ∫η̇; 1/2 where η grows from zero;
* (5.19): 0.01 to 0.1, because ‖η_0‖² or t∫‖η̇‖² count about ten times.

If a ratio were below a third of these values, the measured sides would contain terms that the proof does not have.

Early times are included, because ∫‖e‖² on the right side hides a wrong u^h at late times: if e grows like t and is much
larger than η, the ratio is 3/((2 + 6L) t) in (5.16) and (5.19), which exceeds 1 only for t < 3/(2 + 6L).
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from manufactured.tensors import Array
from study.fem.quadrature import gauss
from study.ledger.criterion import largest
from study.ledger.window import Window, at_most, positive_at_most
from study.solve.evolution import FIXED_POINT, State
from study.solve.tableau import BACKWARD_EULER, MIDPOINT
from study.statements.constraint import with_trace
from study.statements.shared.base import EVOLVING, SEED, SOFTENING, ListedNumbers, Setting, grid, with_h
from study.statements.shared.experiment import Experiment
from study.statements.shared.norms import ContactWork, Energies, maximum

NODES = 12
"""Number of steps of backward Euler. The inequality (5.12) is tested at the end of each step."""
MEMBERS = 2
"""Number of random admissible displacements v^h ∈ K^h for which (5.12) is tested at each time."""
STEPS = 96
"""Number of steps of the midpoint rule. The inequalities after (5.12) are tested along its solution."""
INSTANTS = (3, 6, 12, 24, 48, 72, 96)
"""Numbers n of the time nodes t_n at which both sides of the inequalities after (5.12) are compared."""
POINTS = 2
"""Number of Gauss points in each time step for integrals over time."""

_BY_WHAT = f"rounding errors; for the law (3.3) also a fixed-point iteration that stops at {FIXED_POINT:g} of u"
NEVER, EQUAL = at_most(1e-8, _BY_WHAT, low=-np.inf), positive_at_most(1e-8, _BY_WHAT)
BY_PARTS = positive_at_most(0.003, "quadrature in time leaves an error k² ~ 1e-4 of the terms where velocities jump")
INTEGRATED = Window(0.2, 1.0, "1 is proved; a constant error gives 1/(1 + L T/8) at T/32")
YOUNG = Window(0.01, 1.0, "1 is proved; 0.03 to 0.15 if e behaves like η")
IN_TIME = Window(0.1, 1.0, "1 is proved; 1/2 where η grows from zero")
TOGETHER = Window(0.003, 1.0, "1 is proved; 0.01 to 0.1 if e behaves like η")


class StepsOfTheEstimate(ListedNumbers):
    """Measures the ratio left side / right side of each inequality in the proof, and the defects of its equations."""

    label = "(5.11)–(5.16), (5.18), (5.19)"
    claim = "the bounds (5.12), (5.14), (5.16) and (5.19) of ‖u(t) − u^h(t)‖_V² hold at every t, with their constants"
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


def at_nodes(setup: Experiment) -> dict[str, float]:
    """Return the largest violation of the inequality (5.12), and the largest error of its predicted slack.

    The slack is right side minus left side. The prediction is −λ·N v^h + ∫_{Γ3} σ_ν u^h_ν with the contact forces λ.
    Both results are relative to the terms of (5.12). The members v^h of K^h are Π^h u, 0 and random functions of the
    size of Π^h u.
    """
    energies, pressed = Energies(setup.solution, setup.space), ContactWork(setup.solution, setup.space)
    exact, work, N = energies.exact, energies.work, setup.problem.N
    rng, k = np.random.default_rng(SEED), setup.problem.T / NODES
    found = []
    for before, state in pairwise(BACKWARD_EULER.march(setup.problem, NODES)):
        time, strain, discrete = state.time, exact.strain(state.time), energies.strain(state.u)
        viscous = exact.law.A(energies.strain((state.u - before.u) / k) - exact.strain_rate(time))
        elastic = exact.law.G(discrete) - exact.law.G(strain)
        left = -work(viscous, strain - discrete)
        interpolant = energies.interpolant(time)
        members = [interpolant, 0 * interpolant]
        for _ in range(MEMBERS):
            nodal, normal = rng.standard_normal(setup.space.dofs), rng.standard_normal(setup.space.N.shape[0])
            members.append(abs(interpolant).max() * with_trace(setup.space, nodal, np.minimum(normal, 0.0)))
        for v in members:
            along = energies.strain(v) - strain
            # The fourth term is R(·; v) and not R(·; v − u), because R(·; u) = 0 by (2.5).
            right = work(viscous, along), work(elastic, along), work(elastic, strain - discrete), pressed(v, time)
            slack, size = sum(right) - left, abs(left) + sum(map(abs, right))
            contact = pressed(state.u, time) - float(state.multipliers @ (N @ v))
            found.append((-slack / size, abs(slack - contact) / size))
    return dict(zip(("violation", "slack"), np.max(found, axis=0), strict=True))


@dataclass(frozen=True)
class Course:
    """The terms of the inequalities (5.14)–(5.19) at one time t.

    Here e = u − u^h is the error and η = u − Π^h u the interpolation error.

    Attributes:
        time: the time t.
        e, eta: the squared norms ‖e(t)‖² and ‖η(t)‖² in V.
        both: the inner product (e(t), η(t))_V.
        integrals: the integrals of (ė, η)_V, (e, η̇)_V, ‖e‖ ‖η‖, ‖e‖², ‖η‖², ‖η̇‖² and |R(·; −η)| over (0, t), (7,).
    """

    time: float
    e: float
    eta: float
    both: float
    integrals: Array


def over_time(setup: Experiment) -> dict[str, float]:
    """Return for each of (5.14), (5.16), (5.18) and (5.19) the largest ratio left side / right side over ``INSTANTS``.

    For the equation (5.15) it is the largest defect divided by the largest term.
    """
    energies, pressed = Energies(setup.solution, setup.space), ContactWork(setup.solution, setup.space)
    exact, product, strain_of = energies.exact, energies.product, energies.strain
    k, courses, integrals = setup.problem.T / STEPS, [], np.zeros(7)
    for n, (before, state) in enumerate(pairwise(MIDPOINT.march(setup.problem, STEPS)), start=1):
        if n == 1:
            courses.append(course(energies, before, integrals))
        # The discrete solution is linear in time inside a step.
        discrete_rate = strain_of((state.u - before.u) / k)
        for part, weight in zip(*gauss(POINTS), strict=True):
            time = before.time + part * k
            strain, rate, nodal = exact.strain(time), exact.strain_rate(time), energies.interpolant(time)
            e, e_rate = strain - strain_of(before.u + part * (state.u - before.u)), rate - discrete_rate
            eta, eta_rate = strain - strain_of(nodal), rate - strain_of(energies.interpolated_rate(time))
            squares = [product(field, field) for field in (e, eta, eta_rate)]
            terms = product(e_rate, eta), product(e, eta_rate), np.sqrt(squares[0] * squares[1]), *squares
            integrals = integrals + k * weight * np.array([*terms, abs(pressed(nodal, time))])
        if n in INSTANTS:
            courses.append(course(energies, state, integrals))
    (start, *later), L = courses, setup.solution.law.kappa
    worst = np.max([shares(start, c, L) for c in later], 0)
    return dict(zip(("5.14", "5.15", "5.16", "5.18", "5.19"), worst, strict=True))


def course(energies: Energies, state: State, integrals: Array) -> Course:
    """Return the terms of the inequalities of the estimate at a time node.

    Args:
        energies: computes inner products.
        state: the discrete solution at the node.
        integrals: the integrals from 0 to the node, (7,).
    """
    exact, product = energies.exact.strain(state.time), energies.product
    e, eta = exact - energies.strain(state.u), exact - energies.strain(energies.interpolant(state.time))
    return Course(state.time, product(e, e), product(eta, eta), product(e, eta), integrals)


def shares(start: Course, now: Course, L: float) -> tuple[float, float, float, float, float]:
    """Return how the formulas (5.14), (5.15), (5.16), (5.18) and (5.19) are satisfied at one time.

    For the equation (5.15) it is the defect divided by the largest term, for the others left side / right side.

    Args:
        start, now: the terms at the times 0 and t.
        L: the Lipschitz constant L_G/m_A.
    """
    t, e0, eta0 = now.time, start.e, start.eta
    rate, parts, mixed, e, eta, eta_rate, R = now.integrals
    by_parts = now.both, -start.both, -parts
    after_young = 4 * now.eta + 4 * e0 + 2 * eta0 + (2 + 6 * L) * e + 2 * L * eta + 2 * eta_rate + 4 * R
    together = 4 * e0 + (10 + 4 * L * t) * eta0 + (2 + 6 * L) * e + (2 + 8 * t + 2 * L * t**2) * eta_rate + 4 * R
    return (
        ratio(now.e, e0 + 2 * (rate + L * mixed + L * e + R)),
        abs(rate - sum(by_parts)) / maximum(map(abs, (rate, *by_parts))),
        ratio(now.e, after_young),
        maximum((ratio(now.eta, 2 * eta0 + 2 * t * eta_rate), ratio(eta, 2 * t * eta0 + t**2 * eta_rate))),
        ratio(now.e, together),
    )


def ratio(left: float, right: float) -> float:
    """Return left / right, or infinity if the right side is not positive.

    A right side that is not positive violates every inequality.
    """
    return left / right if right > 0 else np.inf
