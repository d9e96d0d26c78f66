"""(4.1) and Theorem 2.2: velocities are bounded, and solutions depend continuously on load and initial displacement."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import islice, pairwise

import numpy as np

from manufactured.tensors import Array
from study.fem.naming import resolve
from study.fem.space import Space
from study.ledger.check import consequence, paper_claim
from study.ledger.quantities import finest, values
from study.ledger.window import Window, around, positive_at_most
from study.solve.evolution import FIXED_POINT, SemiDiscrete, State
from study.solve.factorisation import Cholesky
from study.solve.signorini import Signorini
from study.solve.tableau import BACKWARD_EULER
from study.statements.shared.base import EVOLVING, SEED, SOFTENING, ListedNumbers, Numbers, Setting, grid, with_h
from study.statements.shared.experiment import Experiment
from study.statements.shared.norms import Velocity, dual_norm, maximum, norm

FEW = ("advance-recede", "yield-on-a-part")
"""The cases of the quick study: one has a linear law, one the nonlinear law (3.3)."""

# (4.1): the velocity is bounded, u ∈ W^{1,∞}(0,T;V).

STEPS = {"k": 24, "k/2": 48, "k/4": 96}
SUPREMUM_AT = 192
"""Number of time intervals at whose ends the exact velocity is evaluated for its supremum over time.

It is twice the largest number of time steps of u^h."""


class BoundedVelocity(ListedNumbers):
    """Measures the largest discrete velocity divided by the largest exact velocity, for several k and h.

    The quotient is max_n ‖δu_n‖_V / sup_t ‖u̇(t)‖_V with δu_n = (u_n − u_{n−1})/k. For an initial value outside K^h it
    would grow like 1/k. If velocities are bounded, so are stresses, σ ∈ L^∞(0,T;Q), by (3.1) and (3.2).
    """

    label = "(4.1)"
    claim = "u^h ∈ W^{1,∞}(0,T;V) uniformly in h and k, for solutions with a bounded u̇"
    checks = (
        paper_claim(
            "bounded", "max_n ‖δu_n‖_V / sup_t ‖u̇(t)‖_V, all k", values(*STEPS), Window(0.5, 1.5, "for all h and k")
        ),
        consequence(
            "limit",
            "max_n ‖δu_n‖_V / sup_t ‖u̇(t)‖_V, finest h and k",
            finest(list(STEPS)[-1]),
            around(1, 0.1, "u̇^h → u̇, and u̇ is continuous except at isolated times"),
        ),
    )
    quick = grid(FEW, ("shaken",), (8, 16))
    full = grid((*EVOLVING, "lift-and-land", *SOFTENING), ("unstructured",), (8, 16, 32))

    def setup(self, setting: Setting) -> Experiment:
        return Experiment.at(setting, BACKWARD_EULER, 1)

    def measure(self, setup: Experiment) -> Numbers:
        velocity = Velocity(setup.solution, setup.space)
        exact = velocity.norm(np.linspace(0, setup.problem.T, SUPREMUM_AT + 1)).max()
        return with_h(setup.space.h, {k: fastest(setup.problem, steps) / exact for k, steps in STEPS.items()})


def fastest(problem: SemiDiscrete, steps: int) -> float:
    """Return the largest discrete velocity ‖(u_n − u_{n−1})/k‖_V of backward Euler over all steps."""
    k = problem.T / steps
    states = BACKWARD_EULER.march(problem, steps)
    return maximum(norm(problem, (after.u - before.u) / k) for before, after in pairwise(states))


# Theorem 2.2: continuous dependence on f and u_0.

SIZES = (0.1, 1.0, 10.0)
"""Sizes of the perturbations of load and initial displacement, relative to the data."""
NEVER = positive_at_most(1 + 1e-7, f"tolerance for fixed-point iterations that stop at {FIXED_POINT:g}")


@dataclass(frozen=True, eq=False)
class Perturbation:
    """Perturbed data of a contact problem: another load and another initial displacement.

    Attributes:
        force, frequency: the load F(t) is replaced by F(t) + cos(ωt) · force with the frequency ω.
        start: the initial displacement, which is in K^h.
    """

    force: Array
    frequency: float
    start: Array

    def change(self, time: float) -> Array:
        """Return the change of the load at one time, cos(ωt) · force, (dofs,)."""
        return math.cos(self.frequency * time) * self.force


class Dependence(ListedNumbers):
    """Tests how far apart two solutions can be whose loads f, g and initial displacements u_0, v_0 differ.

    Tested is the bound ‖u(t) − v(t)‖_V ≤ e^{ωt} (‖u_0 − v_0‖_V + ∫_0^t ‖f − g‖_V ds). In Theorem 2.2 the number ω makes
    A + ωI monotone; for A = ∂ψ_K + B the paper takes ω = L_G/m_A, (4.5). One step of backward Euler is the resolvent of
    A. So for monotone G the bound also holds for u_n and v_n, if the sum of k ‖f(t_j) − g(t_j)‖_V replaces the
    integral, and even with ω = 0. The norm ‖f − g‖_V is the dual norm (FᵀM⁻¹F)^{1/2} on V^h.
    """

    label = "Thm 2.2"
    claim = "u^h depends continuously on f and u_0, with the rate ω = L_G/m_A: what Thm 2.2 gives on V^h"
    checks = (
        paper_claim("bound", "‖u − v‖_V / e^{ωt}(‖u_0 − v_0‖_V + ∫‖f − g‖_V), ω = L_G/m_A", values("bound"), NEVER),
        paper_claim(
            "monotone",
            "‖u − v‖_V / (‖u_0 − v_0‖_V + ∫‖f − g‖_V), ω = 0, allowed by monotone G",
            values("monotone"),
            NEVER,
        ),
        consequence(
            "first-step",
            "‖u − v‖_V / its bound after one step, ω = L_G/m_A, f − g constant and not acting on the contact",
            values("first step"),
            Window(0.5, 1 + 1e-7, "without contact it is at least e^{−ωk}/(1 + ωk), ωk ≤ 1/4"),
        ),
    )
    quick = grid(FEW, ("unstructured",), (6,))
    full = (
        *grid((*EVOLVING, "heterogeneous", "corner"), ("unstructured",), (6, 12)),
        *grid(("cube-disc",), ("shaken",), (3,)),
    )

    def setup(self, setting: Setting) -> Experiment:
        solution = resolve(setting.case).solution
        return Experiment.at(setting, BACKWARD_EULER, max(12, math.ceil(4 * solution.law.kappa * solution.body.T)))

    def measure(self, setup: Experiment) -> Numbers:
        omega = setup.solution.law.kappa
        trajectory = list(setup.march(setup.steps))
        others = perturbations(setup.problem, setup.space)
        found = np.array([quotients(setup.problem, trajectory, other) for other in others])
        damped = found * np.exp(-omega * np.array([state.time for state in trajectory[1:]]))
        return with_h(setup.space.h, {"bound": damped.max(), "monotone": found.max(), "first step": damped[0, 0]})


def quotients(problem: SemiDiscrete, trajectory: list[State], other: Perturbation) -> Array:
    """Return the distance of two discrete solutions divided by the size of the perturbation, for each step, (steps,).

    The quotients are ‖u_n − v_n‖_V / (‖u_0 − v_0‖_V + k Σ_{j ≤ n} ‖f(t_j) − g(t_j)‖_V) for n = 1, 2, …

    Args:
        problem: the unperturbed problem.
        trajectory: its solution u_n by backward Euler.
        other: the perturbation.
    """
    steps = len(trajectory) - 1
    riesz = Cholesky(problem.M)
    changed = replace(problem, load=lambda t: problem.load(t) + other.change(t), u0=other.start)
    bound = norm(problem, problem.u0 - other.start)
    found = []
    for u, v in zip(trajectory[1:], islice(BACKWARD_EULER.march(changed, steps), 1, None), strict=True):
        bound += problem.T / steps * dual_norm(other.change(u.time), riesz)
        found.append(norm(problem, u.u - v.u) / bound)
    return np.array(found)


def perturbations(problem: SemiDiscrete, space: Space) -> Iterator[Perturbation]:
    """Yield perturbations of loads and initial values.

    The first perturbation is a constant load that moves no vertex of Γ3 along ν.
    """
    rng = np.random.default_rng(SEED)
    riesz = Cholesky(problem.M)
    onto = Signorini(problem.M, problem.N)
    load = maximum(norm(problem, riesz(problem.load(float(t)))) for t in np.linspace(0, problem.T, 9))
    pressing = riesz(problem.N.T @ np.ones(problem.N.shape[0]))
    for relative in SIZES:
        fields = along_the_contact(problem, smooth(space, rng)), smooth(space, rng), pressing, -pressing
        for field, frequency in zip(fields, (0.0, 7.0, 7.0, 0.0), strict=True):
            yield Perturbation(problem.M @ field * (relative * load / norm(problem, field)), frequency, problem.u0)
        field = smooth(space, rng)
        start, _ = onto(problem.M @ (problem.u0 + field * (relative * load / norm(problem, field))))
        yield Perturbation(np.zeros(space.dofs), 0.0, start)


def smooth(space: Space, rng: np.random.Generator) -> Array:
    """Return a random smooth displacement: the interpolant of a few waves, set to zero at the clamped vertices."""
    low = space.mesh.p.min(axis=1)
    high = space.mesh.p.max(axis=1)
    x = (space.mesh.p - low[:, None]) / (high - low)[:, None]
    waves = rng.uniform(-np.pi, np.pi, (4, space.dim)) @ x + rng.uniform(0, 2 * np.pi, (4, 1))
    return space.interpolate(rng.standard_normal((space.dim, 4)) @ np.cos(waves))


def along_the_contact(problem: SemiDiscrete, v: Array) -> Array:
    """Return a displacement v with its normal components at the vertices of Γ3 removed."""
    N = problem.N.toarray()
    return v - np.linalg.pinv(N) @ (N @ v)
