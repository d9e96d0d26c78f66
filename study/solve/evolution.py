"""Problem 5.1, continuous in time on one mesh: M u̇ + G(u) + N_{K^h}(u) ∋ F.

K^h = {v : N v ≤ g} has the initial gap g at the vertices of Γ3, which is 0 in the paper. G is bounded relative to M
uniformly in h, (5.5), so the system is not stiff, and the step k need not be small relative to h.

One time step of Problem 5.1 is (w/k) M u + G(θu + (1 − θ)u_{n−1}) + N_{K^h}(u) ∋ b for u = u_n.

S = (w/k) M + θ G_ref is factorised once for all steps with the same w/k. G_ref is the constant reference tensor of the
law. The difference between G and G_ref is treated by a fixed-point iteration, which contracts like k ‖G − G_ref‖/m_A. A
linear law needs no iteration.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial, reduce
from operator import add
from typing import Protocol

import numpy as np
import scipy.sparse as sps

from manufactured.law import Elasticity, KelvinVoigt, Linear
from manufactured.tensors import Array, mapped
from study.fem.space import Displacements, Space, form, means
from study.solve.fixed_point import FixedPointError, fixed_point
from study.solve.signorini import ContactSolver, Signorini
from study.solve.solver_choice import ROUNDING, contact_solver
from study.solve.steps import step_size
from study.solve.tableau import Tableau


@dataclass(frozen=True, eq=False)
class SemiDiscrete:
    """Problem 5.1 on one mesh: M, G, N, F and u_0^h.

    Attributes:
        M: matrix of (·,·)_V on V^h, (n, n).
        reference: matrix of G_ref, (n, n).
        remainder: v ↦ (G ε(v) − G_ref ε(v), ε(·))_Q, (n,); None for a linear law.
        N: K^h = {v : Nv ≤ g}, (m, n).
        load: t ↦ F(t), (n,).
        u0: u_0^h ∈ K^h, (n,).
        T: final time.
        solver: function from S and N to the contact solver of one step; an initial gap is passed as ``gap=g``.
        growth: max(−m, 0)/m_A of the law, 0 for a monotone G; it limits the length of steps.
        gap: the initial gap g ≥ 0 at the contact vertices, (m,), or the number 0 as in the paper.
    """

    M: sps.csc_array
    reference: sps.csc_array
    remainder: Callable[[Array], Array] | None
    N: sps.csr_array
    load: Callable[[float], Array]
    u0: Array
    T: float
    solver: Callable[..., ContactSolver] = Signorini
    growth: float = 0.0
    gap: Array | float = 0.0

    @classmethod
    def of(
        cls,
        space: Space,
        law: KelvinVoigt,
        load: Callable[[float], Array],
        u0: Array,
        gap: Array | float = 0.0,
    ) -> SemiDiscrete:
        """Return the problem on a space for a law, a load, an initial value and an initial gap."""
        factor = means(space, law.G.factor)
        return cls(
            M=form(space, law.A),
            reference=space.form(law.G.reference, factor),
            remainder=remainder(space, law.G, factor),
            N=space.N,
            load=load,
            u0=u0,
            T=space.body.T,
            solver=contact_solver(space),
            growth=law.growth,
            gap=gap,
        )

    def contact(self, S: sps.csc_array) -> ContactSolver:
        """Return the contact solver in K^h for a matrix."""
        return self.solver(S, self.N, gap=self.gap) if np.any(self.gap) else self.solver(S, self.N)

    def initial(self) -> State:
        """Return the initial state u_0^h with zero contact forces, which are unknown at t_0."""
        return State(0.0, self.u0, np.zeros(self.N.shape[0]), 0, lambda: 0.0)

    def elastic(self, v: Array) -> Array:
        """Return the functional (G ε(v), ε(·))_Q, (n,)."""
        linear: Array = self.reference @ v
        return linear if self.remainder is None else linear + self.remainder(v)

    def stepper(self, scheme: Tableau, k: float) -> ContactStep:
        """Return the function (n, previous states) ↦ state at t_n."""
        return ContactStep(self, scheme, k)


def remainder(space: Displacements, G: Elasticity, factor: Array) -> Callable[[Array], Array] | None:
    """Return the function ``SemiDiscrete.remainder`` for G with the factor at the points where strains are stored."""
    if isinstance(G, Linear):
        return None
    at_points = G.scaled(factor)

    def difference(v: Array) -> Array:
        strain = space.strain(v)
        return space.functional(at_points(strain) - factor * mapped(G.reference, strain))

    return difference


def velocities(problem: SemiDiscrete, scheme: Tableau, steps: int) -> Iterator[tuple[State, Array]]:
    """Yield the states at t_0, …, t_steps with velocities δu_n; δu_0, which the scheme does not define, is set to
    δu_1."""
    k = step_size(problem.T, steps)
    states = scheme.march(problem, steps)
    first = next(states)
    before = [first.u]
    for n, state in enumerate(states, start=1):
        velocity = scheme.of_step(n).rate(state.u, before, k)
        if n == 1:
            yield first, velocity
        yield state, velocity
        before = [*before, state.u][-scheme.kept :]


class Scheme(Protocol):
    """A time scheme for Problem 5.1: a ``Tableau``, or another class with these methods."""

    @property
    def name(self) -> str: ...
    @property
    def order(self) -> float: ...

    def march(self, problem: SemiDiscrete, steps: int) -> Iterator[State]:
        """Yield the states at t_0, t_1, …, t_steps."""
        ...


FIXED_POINT = ROUNDING / 10
"""Relative distance in ‖·‖_M to the fixed point of a nonlinear law at which its iteration stops. The residual is
measured in another norm and was up to five times as large in the parameter sweeps, half of the permitted residual."""
ITERATIONS = 60
TINY = 1e-150
"""Replaces zero in denominators; its square is still positive."""


class EvolutionError(RuntimeError):
    """Raised if a time step could not be solved."""


@dataclass(frozen=True, eq=False)
class State:
    """The solution of Problem 5.1 at one time node.

    Attributes:
        time: t_n.
        u: u_n ∈ K^h, (n,).
        multipliers: λ_n ≥ 0, nodal contact forces, (m,).
        iterations: number of contact solves.
        residual: function that returns the largest of ‖S u + Nᵀλ − b‖/‖b‖, (N u − g)_+, |λ·(N u − g)| and λ_−, relative
            to
            the size of u and λ: zero for an exact contact solve. It is a function because computing it takes as long as
            a
            step on a coarse mesh.
    """

    time: float
    u: Array
    multipliers: Array
    iterations: int
    residual: Callable[[], float]


class ContactStep:
    """The time steps of one scheme with one step size k.

    Attributes:
        S: the matrix that is factorised.
        known: the matrices w_j M/k that multiply u_{n−1}, u_{n−2}, … on the right-hand side; (1 − θ) G_ref is
            subtracted from the first.

    Raises:
        StepsError: a step of this length may have several solutions, because G is not monotone.
    """

    def __init__(self, problem: SemiDiscrete, scheme: Tableau, k: float) -> None:
        scheme.require_unique(k, problem.growth)
        self.problem, self.scheme, self.k = problem, scheme, k
        self.S = sps.csc_array(scheme.newest / k * problem.M + scheme.theta * problem.reference)
        self.solve, self.forces = problem.contact(self.S), problem.N.T
        self.known = [sps.csc_array(weight / k * problem.M) for weight in scheme.past]
        if scheme.theta < 1:
            self.known[0] = sps.csc_array(self.known[0] - (1 - scheme.theta) * problem.reference)

    def __call__(self, n: int, past: Sequence[State]) -> State:
        """Return the state at t_n.

        Raises:
            EvolutionError: the iteration of a nonlinear law did not converge, or values are not finite.
        """
        before = [state.u for state in past]
        load = self.problem.load(self.scheme.balanced(n, self.k))
        b = reduce(add, (matrix @ u for matrix, u in zip(self.known, reversed(before), strict=False)), load)
        if self.problem.remainder is None:
            return self._state(n * self.k, *self.solve(b), b, 1)
        return self._nonlinear(n * self.k, b, before, self.problem.remainder)

    def _nonlinear(
        self, time: float, constant: Array, before: Sequence[Array], remainder: Callable[[Array], Array]
    ) -> State:
        """Return the fixed point of v ↦ u with S u + Nᵀλ = constant − remainder(θv + (1 − θ) u_{n−1})."""
        problem, theta = self.problem, self.scheme.theta
        base = (1 - theta) * before[-1]
        multipliers = np.zeros(problem.N.shape[0])

        def image(v: Array) -> Array:
            nonlocal multipliers
            u, multipliers = self.solve(constant - remainder(theta * v + base))
            return u

        try:
            u, taken = fixed_point(image, _extrapolated(before), lambda w: problem.M @ w, FIXED_POINT, ITERATIONS)
        except FixedPointError as error:
            raise EvolutionError(
                f"step to t = {time:.6g}: {error}; it contracts like k L_G/m_A, so take more steps"
            ) from error
        return self._state(time, u, multipliers, constant - remainder(theta * u + base), taken)

    def _state(self, time: float, u: Array, multipliers: Array, b: Array, iterations: int) -> State:
        # A sum is finite only if all of its terms are, so one test suffices.
        if not math.isfinite(u.sum() + multipliers.sum()):
            raise EvolutionError(f"the step to t = {time:.6g} produced values that are not finite")
        return State(time, u, multipliers, iterations, partial(self._residual, u, multipliers, b))

    def _residual(self, u: Array, multipliers: Array, b: Array) -> float:
        """Return the residual that ``State`` describes."""
        defect = self.S @ u + self.forces @ multipliers - b
        normal = self.problem.N @ u - self.problem.gap
        size, force = _largest(u), _largest(multipliers)
        parts = (
            math.sqrt(defect @ defect) / max(math.sqrt(b @ b), TINY),
            float(normal.max(initial=0.0)) / size,
            float(-multipliers.min(initial=0.0)) / force,
            float(abs(normal * multipliers).max(initial=0.0)) / (size * force),
        )
        # NumPy's maximum is NaN if any value is; Python's max may hide a NaN.
        return float(np.max(parts))


def _largest(v: Array) -> float:
    """Return the largest absolute value, or TINY for a zero vector."""
    return max(float(v.max(initial=0.0)), -float(v.min(initial=0.0)), TINY)


def _extrapolated(before: Sequence[Array]) -> Array:
    """Return the next value of the polynomial through the last states at equal steps, at most three."""
    weights = {1: (1,), 2: (-1, 2), 3: (1, -3, 3)}[len(before)]
    return sum((weight * u for weight, u in zip(weights, before, strict=True)), np.zeros_like(before[0]))
