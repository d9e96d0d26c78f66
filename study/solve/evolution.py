"""Problem 5.1 in time: M u̇ + G(u) + N_{K^h}(u) ∋ F, constraint at the new time.

G is bounded relative to M uniformly in h, (5.5), so the system is not stiff: no step restriction
links k to h and one factorisation of (c/k) M + θ G_ref serves all steps with the same c. G_ref is the law's constant
reference tensor; what G differs from it is treated by a fixed point that contracts like
k ‖G − G_ref‖/m_A, and vanishes for a linear law.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy.sparse as sps

from manufactured.law import Elasticity, KelvinVoigt, Linear
from manufactured.tensors import Array
from study.fem.material import form, means
from study.fem.space import Space
from study.solve.fixed_point import FixedPointError, fixed_point
from study.solve.signorini import ContactSolver, Signorini
from study.solve.solver_choice import ROUNDING, contact_solver

FIXED_POINT = ROUNDING / 10
"""Relative distance in ‖·‖_M to the fixed point of a nonlinear law at which its iteration stops. The residual
that this leaves is measured in another norm and reaches five times as much in the sweeps: half of what is allowed."""
ITERATIONS = 60
TINY = 1e-150
"""Stands for zero in denominators; its square is still positive."""


class EvolutionError(RuntimeError):
    """A time step could not be solved."""


@dataclass(frozen=True, eq=False)
class SemiDiscrete:
    """Problem 5.1 on one mesh: M, G, N, F and u_0^h.

    Attributes:
        M: matrix of (·,·)_V on V^h, (n, n).
        reference: matrix of G_ref, (n, n).
        remainder: v ↦ (G ε(v) − G_ref ε(v), ε(·))_Q, (n,); None for a linear law.
        N: K^h = {v : Nv ≤ 0}, (m, n).
        load: t ↦ F(t), (n,).
        u0: u_0^h ∈ K^h, (n,).
        T: final time.
        solver: (S, N) ↦ the contact solve of one step.
    """

    M: sps.csc_array
    reference: sps.csc_array
    remainder: Callable[[Array], Array] | None
    N: sps.csr_array
    load: Callable[[float], Array]
    u0: Array
    T: float
    solver: Callable[[sps.csc_array, sps.csr_array], ContactSolver] = Signorini

    @classmethod
    def of(cls, space: Space, law: KelvinVoigt, load: Callable[[float], Array], u0: Array) -> SemiDiscrete:
        """The problem for a law, a load and a start on a space."""
        return cls(
            M=form(space, law.A),
            reference=form(space, law.G),
            remainder=None if isinstance(law.G, Linear) else _remainder(space, law.G),
            N=space.N,
            load=load,
            u0=u0,
            T=space.body.T,
            solver=contact_solver(space),
        )


def _remainder(space: Space, G: Elasticity) -> Callable[[Array], Array]:
    factor = means(space, G.factor)
    on_cells = G.scaled(factor)

    def remainder(v: Array) -> Array:
        strain = space.strain(v)
        return space.functional(on_cells(strain) - factor * (G.reference @ strain))

    return remainder


@dataclass(frozen=True, eq=False)
class State:
    """One time node of a trajectory.

    Attributes:
        time: t_n.
        u: u_n ∈ K^h, (n,).
        multipliers: λ_n ≥ 0, nodal contact forces, (m,).
        residual: the largest of ‖S u + Nᵀλ − b‖/‖b‖, (N u)_+ and |λ·N u| and λ_−, relative to the
            size of u and λ: zero for an exact contact solve.
        iterations: contact solves spent.
    """

    time: float
    u: Array
    multipliers: Array
    residual: float
    iterations: int


class Scheme(Protocol):
    """A time scheme: ``order`` in k for smooth solutions; ``march`` yields t_0, t_1, …, t_steps."""

    @property
    def name(self) -> str: ...
    @property
    def order(self) -> float: ...

    def march(self, problem: SemiDiscrete, steps: int) -> Iterator[State]: ...


class _ContactStep:
    """Solves c/k M u + G(θu + base) + N_{K^h}(u) ∋ rhs for one u, many times."""

    def __init__(self, problem: SemiDiscrete, mass: float, theta: float) -> None:
        self.problem, self.theta = problem, theta
        self.S = sps.csc_array(mass * problem.M + theta * problem.reference)
        self.solve = problem.solver(self.S, problem.N)

    def __call__(self, time: float, rhs: Array, base: Array, past: Sequence[Array]) -> State:
        """u at a time; a nonlinear law starts from what the last u at equal steps extrapolate to."""
        problem = self.problem
        constant = rhs - problem.reference @ base if base.any() else rhs
        remainder = problem.remainder
        if remainder is None:
            u, multipliers = self.solve(constant)
            return self._state(time, u, multipliers, constant, 1)
        multipliers = np.zeros(problem.N.shape[0])

        def image(v: Array) -> Array:
            nonlocal multipliers
            u, multipliers = self.solve(constant - remainder(self.theta * v + base))
            return u

        try:
            u, taken = fixed_point(image, _extrapolated(past), lambda w: problem.M @ w, FIXED_POINT, ITERATIONS)
        except FixedPointError as error:
            raise EvolutionError(
                f"step to t = {time:.6g}: {error}; it contracts like k L_G/m_A, so take more steps"
            ) from error
        b = constant - remainder(self.theta * u + base)
        return self._state(time, u, multipliers, b, taken)

    def _state(self, time: float, u: Array, multipliers: Array, b: Array, iterations: int) -> State:
        defect = self.S @ u + self.problem.N.T @ multipliers - b
        normal = self.problem.N @ u
        size = max(float(abs(u).max()), TINY)
        force = max(float(abs(multipliers).max(initial=0.0)), TINY)
        residual = max(
            float(np.linalg.norm(defect)) / max(float(np.linalg.norm(b)), TINY),
            float(normal.max(initial=0.0)) / size,
            float(-multipliers.min(initial=0.0)) / force,
            float(abs(normal * multipliers).max(initial=0.0)) / (size * force),
        )
        if not np.isfinite(residual):
            raise EvolutionError(f"the step to t = {time:.6g} produced values that are not finite")
        return State(time, u, multipliers, residual, iterations)


def step_size(problem: SemiDiscrete, steps: int) -> float:
    """k = T/steps.

    Raises:
        EvolutionError: k would exceed T.
    """
    if steps < 1:
        raise EvolutionError(f"{steps} steps would need k > T = {problem.T:g}; take one step or more")
    return problem.T / steps


def _start(problem: SemiDiscrete) -> State:
    return State(0.0, problem.u0, np.zeros(problem.N.shape[0]), 0.0, 0)


@dataclass(frozen=True)
class BackwardEuler:
    """M (u_n − u_{n−1})/k + G(u_n) + N_{K^h}(u_n) ∋ F(t_n)."""

    name: str = "backward-euler"
    order: float = 1.0

    def march(self, problem: SemiDiscrete, steps: int) -> Iterator[State]:
        yield from _theta_method(problem, steps, 1.0)


@dataclass(frozen=True)
class Midpoint:
    """M (u_n − u_{n−1})/k + G((u_n + u_{n−1})/2) + N_{K^h}(u_n) ∋ F(t_{n−1/2}).

    Order 2, falling to 1.5 in the maximum norm when vertices change between contact and release.
    """

    name: str = "midpoint"
    order: float = 2.0

    def march(self, problem: SemiDiscrete, steps: int) -> Iterator[State]:
        yield from _theta_method(problem, steps, 0.5)


def _theta_method(problem: SemiDiscrete, steps: int, theta: float) -> Iterator[State]:
    k = step_size(problem, steps)
    step = _ContactStep(problem, 1 / k, theta)
    state = _start(problem)
    yield state
    past = [state.u]
    for n in range(1, steps + 1):
        old = past[-1]
        rhs = problem.load((n - 1 + theta) * k) + problem.M @ (old / k)
        state = step(n * k, rhs, (1 - theta) * old, past)
        past = [*past[-2:], state.u]
        yield state


def _extrapolated(past: Sequence[Array]) -> Array:
    """The next value of the polynomial through the last three at equal steps, or as many as there are."""
    weights = {1: (1,), 2: (-1, 2), 3: (1, -3, 3)}[len(past)]
    return sum((weight * u for weight, u in zip(weights, past, strict=True)), np.zeros_like(past[0]))


@dataclass(frozen=True)
class BDF2:
    """M (3u_n − 4u_{n−1} + u_{n−2})/(2k) + G(u_n) + N_{K^h}(u_n) ∋ F(t_n), first step backward Euler."""

    name: str = "bdf2"
    order: float = 2.0

    def march(self, problem: SemiDiscrete, steps: int) -> Iterator[State]:
        k = step_size(problem, steps)
        zero = np.zeros_like(problem.u0)
        first = _ContactStep(problem, 1 / k, 1.0)
        older = _start(problem)
        yield older
        state = first(k, problem.load(k) + problem.M @ (older.u / k), zero, [older.u])
        yield state
        if steps == 1:
            return
        step = _ContactStep(problem, 1.5 / k, 1.0)
        for n in range(2, steps + 1):
            rhs = problem.load(n * k) + problem.M @ ((2 * state.u - 0.5 * older.u) / k)
            older, state = state, step(n * k, rhs, zero, [older.u, state.u])
            yield state


SCHEMES: tuple[Scheme, ...] = (BackwardEuler(), BDF2(), Midpoint())
