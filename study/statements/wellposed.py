"""Theorems 2.2, 4.1 and 5.2: one solution, with a bounded velocity, that depends continuously on its data."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import islice, pairwise

import clarabel
import numpy as np
import pandas as pd
import scipy.sparse as sps
from scipy.linalg import cho_solve, cholesky, solve_triangular
from scipy.optimize import nnls

from manufactured.law import KelvinVoigt
from manufactured.tensors import Array
from study.fem.naming import family_named, resolve
from study.fem.space import Space
from study.ledger.criterion import judge
from study.ledger.measures import every, finest, largest
from study.ledger.verdict import Verdict
from study.ledger.window import Window, around, at_most
from study.solve.cholesky.factorisation import Cholesky
from study.solve.contact_step import FIXED_POINT, State
from study.solve.evolution import SemiDiscrete
from study.solve.interior_point import Tolerance, settings
from study.solve.signorini import Signorini
from study.solve.tableau import BACKWARD_EULER
from study.statements.prop_5_4.experiment import Experiment
from study.statements.shared.base import ListedNumbers, Setting, grid, with_h
from study.statements.shared.instants import Velocity

SEED = 2002
CASES = ("full-contact", "advance-recede", "travelling-patch", "yield-and-release", "yield-on-a-part")
FEW = ("advance-recede", "yield-on-a-part")
"""Linear law and law (3.3), for the quick study."""


def norm(problem: SemiDiscrete, v: Array) -> float:
    """‖v‖_V on V^h."""
    return math.sqrt(max(v @ (problem.M @ v), 0.0))


# Existence and uniqueness.

RIVALS_STEPS = 12
EXACTLY = at_most(1e-9, f"exact solvers, or a fixed point stopped at {FIXED_POINT:g} in every step")
INTERIOR = at_most(1e-7, "the root of the duality gap 1e-15 at which the interior point method stops")

UNIQUENESS = (
    largest("random-starts", "from random active sets", EXACTLY, "random starts"),
    largest("least-squares", "by Lawson and Hanson's method on the dual", EXACTLY, "least squares"),
    largest("fixed-point", "by a fixed point with all of G on the right", EXACTLY, "fixed point"),
    largest("interior-point", "by an interior point method on the whole programme", INTERIOR, "interior point"),
)


@dataclass(frozen=True)
class OneTrajectory(ListedNumbers):
    """max_n ‖u_n − v_n‖_V / max_n ‖u_n‖_V for trajectories found in different ways.

    Every step of backward Euler is: minimise ½ vᵀSv − bᵀv over K^h, S = M/k + G. It is solved by the
    condensed active set from its own last set and from random ones, by two methods that share no
    code with it, and with another splitting of G between the two sides.
    """

    label: str = "Thm 4.1, 5.2"
    claim: str = "there is one solution: different starts, solvers and splittings give one trajectory"

    def places(self, full: bool) -> list[Setting]:
        if not full:
            return grid(CASES, ("shaken",), (6,))
        planar = grid((*CASES, "heterogeneous", "corner"), ("unstructured",), (6, 12))
        return grid(CASES, ("one-diagonal",), (6, 12)) + planar + grid(("cube-disc",), ("shaken",), (3,))

    def measure(self, setting: Setting) -> dict[str, float]:
        solution = resolve(setting.case).solution
        setup = Experiment.of(solution, family_named(setting.family), setting.level, BACKWARD_EULER, RIVALS_STEPS)
        return with_h(setup.space.h, {name: apart(setup, rival) for name, rival in rivals(setup.problem).items()})

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        return judge(self, rows, UNIQUENESS)


def rivals(problem: SemiDiscrete) -> dict[str, SemiDiscrete]:
    """The same problem, to be solved in other ways."""
    whole = replace(problem, reference=0 * problem.reference, remainder=_whole(problem))
    return {
        "random starts": replace(problem, solver=RandomStarts),
        "least squares": replace(problem, solver=LeastSquares),
        "fixed point": whole,
        "interior point": replace(problem, solver=InteriorPoint),
    }


def _whole(problem: SemiDiscrete) -> Callable[[Array], Array]:
    """v ↦ (G ε(v), ε(·))_Q."""

    def elastic(v: Array) -> Array:
        force = problem.reference @ v
        return force if problem.remainder is None else force + problem.remainder(v)

    return elastic


def apart(setup: Experiment, other: SemiDiscrete) -> float:
    """max_n ‖u_n − v_n‖_V / max_n ‖u_n‖_V for the setup's problem and another one."""
    pairs = zip(setup.scheme.march(setup.problem, setup.steps), setup.scheme.march(other, setup.steps), strict=True)
    both = [(norm(setup.problem, u.u - v.u), norm(setup.problem, u.u)) for u, v in pairs]
    difference, size = np.max(both, axis=0)
    return float(difference / size)


class RandomStarts(Signorini):
    """The contact solve from a random active set, a new one every time."""

    def __init__(self, S: sps.csc_array, N: sps.csr_array) -> None:
        super().__init__(S, N)
        self.rng = np.random.default_rng(SEED)

    def __call__(self, b: Array) -> tuple[Array, Array]:
        self.active = self.rng.uniform(size=self.N.shape[0]) < self.rng.uniform()
        return super().__call__(b)


class LeastSquares:
    """The contact solve through its dual, min |L⁻¹(Nᵀλ − b)| over λ ≥ 0 with S = LLᵀ.

    Source: C. L. Lawson, R. J. Hanson, Solving Least Squares Problems, 1974, chapter 23.
    """

    def __init__(self, S: sps.csc_array, N: sps.csr_array) -> None:
        self.N = N
        self.L = cholesky(S.toarray(), lower=True)
        self.columns = solve_triangular(self.L, N.T.toarray(), lower=True)

    def __call__(self, b: Array) -> tuple[Array, Array]:
        """u ∈ K^h and λ ≥ 0."""
        multipliers, _ = nnls(self.columns, solve_triangular(self.L, b, lower=True))
        return cho_solve((self.L, True), b - self.N.T @ multipliers), multipliers


class InteriorPoint:
    """The contact solve as a quadratic programme in all unknowns, by Clarabel."""

    def __init__(self, S: sps.csc_array, N: sps.csr_array) -> None:
        self.m = N.shape[0]
        self.q = np.zeros(N.shape[1])
        cones = [clarabel.NonnegativeConeT(self.m)]
        self.unit = float(abs(S.diagonal()).max())
        P = sps.csc_matrix(sps.triu(S / self.unit))
        how = settings(aim=Tolerance(gap=1e-15, feasibility=1e-14), enough=Tolerance(gap=1e-11, feasibility=1e-11))
        self.solver = clarabel.DefaultSolver(P, self.q, sps.csc_matrix(N), np.zeros(self.m), cones, how)

    def __call__(self, b: Array) -> tuple[Array, Array]:
        """u ∈ K^h and λ ≥ 0."""
        size = float(np.linalg.norm(b)) or 1.0
        self.q[:] = -b / size
        self.solver.update(q=self.q)
        solution = self.solver.solve()
        return np.array(solution.x) * size / self.unit, np.array(solution.z) * size


# u ∈ W^{1,∞}(0,T;V).

STEPS = {"k": 24, "k/2": 48, "k/4": 96}
SUPREMUM_AT = 192
"""Intervals of the grid on which sup_t ‖u̇(t)‖_V is looked for; the finest grid for u^h, twice as fine."""
BOUNDED = Window(0.5, 1.5, "at every h and k")
LIMIT = around(1, 0.1, "u̇^h → u̇ and u̇ is continuous but for isolated times")

VELOCITY = (
    every("bounded", "max_n ‖δu_n‖_V / sup_t ‖u̇(t)‖_V, all k", BOUNDED, *STEPS),
    finest("limit", "max_n ‖δu_n‖_V / sup_t ‖u̇(t)‖_V, finest h and k", LIMIT, list(STEPS)[-1]),
)


@dataclass(frozen=True)
class BoundedVelocity(ListedNumbers):
    """max_n ‖δu_n‖_V / sup_t ‖u̇(t)‖_V, δu_n = (u_n − u_{n−1})/k, for halved k and refined h.

    For a start outside K^h it would grow like 1/k. That σ ∈ L^∞(0,T;Q) follows by (3.1) and (3.2).
    """

    label: str = "(4.1)"
    claim: str = "u ∈ W^{1,∞}(0,T;V), and u^h is in it uniformly in h and k"

    def places(self, full: bool) -> list[Setting]:
        if not full:
            return grid(FEW, ("shaken",), (8, 16))
        return grid((*CASES, "lift-and-land"), ("unstructured",), (8, 16, 32))

    def measure(self, setting: Setting) -> dict[str, float]:
        solution = resolve(setting.case).solution
        setup = Experiment.of(solution, family_named(setting.family), setting.level, BACKWARD_EULER, 1)
        velocity = Velocity(solution, setup.space)
        exact = max(velocity.norm(float(t)) for t in np.linspace(0, setup.problem.T, SUPREMUM_AT + 1))
        return with_h(setup.space.h, {k: fastest(setup.problem, steps) / exact for k, steps in STEPS.items()})

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        return judge(self, rows, VELOCITY)


def fastest(problem: SemiDiscrete, steps: int) -> float:
    """max_n ‖(u_n − u_{n−1})/k‖_V by backward Euler."""
    k = problem.T / steps
    return max(
        norm(problem, (after.u - before.u) / k) for before, after in pairwise(BACKWARD_EULER.march(problem, steps))
    )


# Continuous dependence on f and u_0.

SIZES = (0.1, 1.0, 10.0)
"""Sizes of the perturbations, relative to the data."""
NEVER = at_most(1 + 1e-7, f"room for fixed points stopped at {FIXED_POINT:g}")
SHARP = Window(0.5, 1 + 1e-7, "without contact it is at least e^{−ωk}/(1 + ωk), ωk ≤ 1/4")

DEPENDENCE = (
    largest("bound", "‖u − v‖_V / e^{ωt}(‖u_0 − v_0‖_V + ∫‖f − g‖_V), ω = L_G/m_A", NEVER, "bound"),
    largest("monotone", "‖u − v‖_V / (‖u_0 − v_0‖_V + ∫‖f − g‖_V), ω = 0, allowed by monotone G", NEVER, "monotone"),
    every(
        "first-step", "the same after one step, ω = L_G/m_A, f − g constant and off the contact", SHARP, "first step"
    ),
)


@dataclass(frozen=True, eq=False)
class Perturbation:
    """Other data: F(t) + cos(ωt) force in place of F(t), start ∈ K^h in place of u_0^h."""

    force: Array
    frequency: float
    start: Array

    def change(self, time: float) -> Array:
        """cos(ωt) force, (n_dofs,)."""
        return math.cos(self.frequency * time) * self.force


@dataclass(frozen=True)
class Dependence(ListedNumbers):
    """‖u(t) − v(t)‖_V ≤ e^{ωt} (‖u_0 − v_0‖_V + ∫_0^t ‖f − g‖_V ds) for the solutions of two data sets.

    ω makes A + ωI monotone in Theorem 2.2; for A = ∂ψ_K + B the source takes ω = L_G/m_A, (4.5). One
    step of backward Euler is the resolvent of A, so for monotone G the inequality holds for u_n and v_n
    too, with the sum k Σ ‖f(t_j) − g(t_j)‖_V for the integral, and even with ω = 0. ‖f − g‖_V is the norm
    of Riesz' representative in V^h, (FᵀM⁻¹F)^{1/2}.
    """

    label: str = "Thm 2.2"
    claim: str = "the solution depends continuously on f and u_0, with the rate ω = L_G/m_A"

    def places(self, full: bool) -> list[Setting]:
        if not full:
            return grid(FEW, ("unstructured",), (6,))
        planar = grid((*CASES, "heterogeneous", "corner"), ("unstructured",), (6, 12))
        return planar + grid(("cube-disc",), ("shaken",), (3,))

    def measure(self, setting: Setting) -> dict[str, float]:
        solution = resolve(setting.case).solution
        omega = growth(solution.law)
        steps = max(12, math.ceil(4 * omega * solution.body.T))
        setup = Experiment.of(solution, family_named(setting.family), setting.level, BACKWARD_EULER, steps)
        trajectory = list(setup.scheme.march(setup.problem, steps))
        others = perturbations(setup.problem, setup.space)
        found = np.array([quotients(setup.problem, trajectory, other) for other in others])
        damped = found * np.exp(-omega * np.array([state.time for state in trajectory[1:]]))
        return with_h(setup.space.h, {"bound": damped.max(), "monotone": found.max(), "first step": damped[0, 0]})

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        return judge(self, rows, DEPENDENCE)


def growth(law: KelvinVoigt) -> float:
    """ω = L_G/m_A, (4.3)–(4.5)."""
    return law.G.lipschitz / law.A.ellipticity


def quotients(problem: SemiDiscrete, trajectory: list[State], other: Perturbation) -> Array:
    """‖u_n − v_n‖_V / (‖u_0 − v_0‖_V + k Σ_{j ≤ n} ‖f(t_j) − g(t_j)‖_V) at n = 1, 2, …"""
    steps = len(trajectory) - 1
    riesz = Cholesky(problem.M)
    changed = replace(problem, load=lambda t: problem.load(t) + other.change(t), u0=other.start)
    bound = norm(problem, problem.u0 - other.start)
    found = []
    for u, v in zip(trajectory[1:], islice(BACKWARD_EULER.march(changed, steps), 1, None), strict=True):
        F = other.change(u.time)
        bound += problem.T / steps * math.sqrt(F @ riesz(F))
        found.append(norm(problem, u.u - v.u) / bound)
    return np.array(found)


def perturbations(problem: SemiDiscrete, space: Space) -> Iterator[Perturbation]:
    """Loads and starts of several sizes; the first is a constant load that by itself moves no vertex of Γ3 along ν."""
    rng = np.random.default_rng(SEED)
    riesz, onto = Cholesky(problem.M), Signorini(problem.M, problem.N)
    load = max(norm(problem, riesz(problem.load(float(t)))) for t in np.linspace(0, problem.T, 9))
    pressing = riesz(problem.N.T @ np.ones(problem.N.shape[0]))
    for relative in SIZES:
        fields = along_the_contact(problem, smooth(space, rng)), smooth(space, rng), pressing, -pressing
        for field, frequency in zip(fields, (0.0, 7.0, 7.0, 0.0), strict=True):
            force = problem.M @ field * (relative * load / norm(problem, field))
            yield Perturbation(force, frequency, problem.u0)
        field = smooth(space, rng)
        start, _ = onto(problem.M @ (problem.u0 + field * (relative * load / norm(problem, field))))
        yield Perturbation(np.zeros(space.dofs), 0.0, start)


def smooth(space: Space, rng: np.random.Generator) -> Array:
    """Π^h of a random sum of a few waves, zero on Γ1."""
    low, high = space.mesh.p.min(axis=1), space.mesh.p.max(axis=1)
    x = (space.mesh.p - low[:, None]) / (high - low)[:, None]
    waves = rng.uniform(-np.pi, np.pi, (4, space.dim)) @ x + rng.uniform(0, 2 * np.pi, (4, 1))
    return space.interpolate(rng.standard_normal((space.dim, 4)) @ np.cos(waves))


def along_the_contact(problem: SemiDiscrete, v: Array) -> Array:
    """v without its normal component at the vertices of Γ3."""
    N = problem.N.toarray()
    return v - np.linalg.pinv(N) @ (N @ v)
