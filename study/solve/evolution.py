"""The semi-discrete problem (Problem 5.1) on one mesh, and its time steps.

It is the differential inclusion M u̇ + G(u) + N_{K^h}(u) ∋ F, where N_{K^h} is the normal cone of the admissible set
K^h = {v : N v ≤ g}. g is the initial gap at the vertices of Γ3, 0 in the paper. G is bounded relative to M uniformly in
h, (5.5), so the system is not stiff, and the step k need not be small relative to h.

A time step solves (w/k) M u + G(θu + (1 − θ)u_{n−1}) + N_{K^h}(u) ∋ b for u = u_n, with w and θ of the time scheme
(``study.solve.tableau``).

The matrix S = (w/k) M + θ G_ref is factorised once for all steps with the same w/k, where G_ref belongs to the constant
reference tensor of the law. For a nonlinear law, G − G_ref is treated by a fixed-point iteration, whose contraction
number is about k ‖G − G_ref‖/m_A. A linear law needs no iteration.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial, reduce
from operator import add
from typing import Any

import numpy as np
import scipy.sparse as sps

from manufactured.law import Elasticity, KelvinVoigt, Linear
from manufactured.tensors import Array, mapped
from study.fem.moments import blocks
from study.fem.space import Displacements, Space, form, means
from study.solve.fixed_point import FixedPointError, fixed_point
from study.solve.signorini import ContactSolver, Signorini
from study.solve.solver_choice import ROUNDING, contact_solver
from study.solve.steps import step_size
from study.solve.tableau import Tableau


@dataclass(frozen=True, eq=False)
class SemiDiscrete:
    """The semi-discrete problem (Problem 5.1) on one mesh, with n unknowns and m constraints.

    Attributes:
        M: the matrix of the viscosity A, which is the inner product (·,·)_V on V^h, (n, n).
        reference: the matrix G_ref of the elasticity, (n, n); for a nonlinear law it belongs to a constant reference
            tensor.
        remainder: the function v ↦ (G ε(v) − G_ref ε(v), ε(·))_Q, (n,) → (n,); None for a linear law.
        N: the constraint matrix, (m, n): displacements with N v ≤ g are admissible.
        load: the function from m times t to the load vectors F(t), (m,) → (n, m).
        u0: the initial value u_0^h ∈ K^h, (n,).
        T: the final time.
        solver: a function that makes the contact solver of one step from S and N; an initial gap is passed as
            ``gap=g``.
        growth: the largest rate max(−m, 0)/m_A at which two solutions can move apart, where m is the monotonicity
            constant of G; 0 for a monotone G. It limits the length of steps.
        gap: the initial gap g ≥ 0 at the contact vertices, (m,), or the number 0 as in the paper.
    """

    M: sps.csc_array
    reference: sps.csc_array
    remainder: Callable[[Array], Array] | None
    N: sps.csr_array
    load: Callable[[Any], Array]
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
        load: Callable[[Any], Array],
        u0: Array,
        gap: Array | float = 0.0,
    ) -> SemiDiscrete:
        """Return Problem 5.1 on a space for a law, a load and an initial value; see ``SemiDiscrete``."""
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
        """Return the contact solver for a matrix S: a function of b that minimises ½ vᵀSv − bᵀv over K^h."""
        return self.solver(S, self.N, gap=self.gap) if np.any(self.gap) else self.solver(S, self.N)

    def initial(self) -> State:
        """Return the state at t_0, with the displacement u_0^h.

        Contact forces are 0 there, because the time scheme does not define them at t_0.
        """
        return State(0.0, self.u0, np.zeros(self.N.shape[0]), 0, lambda: 0.0)

    def elastic(self, v: Array) -> Array:
        """Return the vector of the elastic forces of a displacement v, (G ε(v), ε(·))_Q, (n,) → (n,)."""
        linear: Array = self.reference @ v
        return linear if self.remainder is None else linear + self.remainder(v)

    def stepper(self, scheme: Tableau, k: float) -> ContactStep:
        """Return the function that computes the state at t_n from n and the previous states, for steps of size k."""
        return ContactStep(self, scheme, k)


def remainder(space: Displacements, G: Elasticity, factor: Array) -> Callable[[Array], Array] | None:
    """Return the function ``SemiDiscrete.remainder``: the elastic forces of a displacement minus their linear part.

    Args:
        space: the finite element space.
        G: the elasticity; the result is None if it is linear.
        factor: the material factor α of G at the quadrature points.
    """
    if isinstance(G, Linear):
        return None
    at_points = G.scaled(factor)

    def difference(v: Array) -> Array:
        strain = space.strain(v)
        return space.functional(at_points(strain) - factor * mapped(G.reference, strain))

    return difference


def velocities(problem: SemiDiscrete, scheme: Tableau, steps: int) -> Iterator[tuple[State, Array]]:
    """Solve the problem and yield pairs of the state at t_n and the velocity δu_n, n = 0, …, steps.

    The velocity is the difference quotient of the scheme. The scheme does not define δu_0, so δu_1 is used for it.
    """
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


Scheme = Tableau
"""A time scheme for the semi-discrete problem."""
FIXED_POINT = ROUNDING / 10
"""The iteration for a nonlinear law stops at this relative distance from the fixed point, in the norm of M.

The residual of a state is measured in another norm. In all runs it was at most five times this value, half of what is
permitted.
"""
ITERATIONS = 60
"""Largest number of iterations of a time step for a nonlinear law."""
TINY = 1e-150
"""Replaces zero in denominators. Its square is still a positive number."""


class EvolutionError(RuntimeError):
    """Raised if a time step could not be solved, or gave values that are not finite."""


@dataclass(frozen=True, eq=False)
class State:
    """The solution of the semi-discrete problem at one time node t_n.

    Attributes:
        time: the time t_n.
        u: the displacement u_n ∈ K^h, (n,).
        multipliers: the nodal contact forces λ_n ≥ 0, (m,).
        iterations: the number of contact problems that were solved in this step.
        residual: a function that returns the residual of the step, which is 0 for an exact solution. It is the largest
            of ‖S u + Nᵀλ − b‖/‖b‖, (N u − g)_+, |λ·(N u − g)| and λ_−, the last three relative to the size of u and λ.
            It is computed only on request, because that takes as long as a step on a coarse mesh.
    """

    time: float
    u: Array
    multipliers: Array
    iterations: int
    residual: Callable[[], float]


class ContactStep:
    """Computes the time steps of one scheme with one step size k.

    Attributes:
        S: the matrix of the contact problem in each step, which is factorised once.
        known: the matrices that multiply the earlier displacements u_{n−1}, u_{n−2}, … on the right-hand side. They are
            w_j M/k; (1 − θ) G_ref is subtracted from the first.

    Raises:
        StepsError: G is not monotone, and a step of this length may have several solutions.
    """

    def __init__(self, problem: SemiDiscrete, scheme: Tableau, k: float) -> None:
        scheme.require_unique(k, problem.growth)
        self.problem = problem
        self.scheme = scheme
        self.k = k
        self.S = sps.csc_array(scheme.newest / k * problem.M + scheme.theta * problem.reference)
        self.solve = problem.contact(self.S)
        self.forces = problem.N.T
        self.known = [sps.csc_array(weight / k * problem.M) for weight in scheme.past]
        if scheme.theta < 1:
            self.known[0] = sps.csc_array(self.known[0] - (1 - scheme.theta) * problem.reference)
        times = scheme.balanced(np.arange(1, round(problem.T / k) + 1), k)
        self._blocks = parts = blocks(times, len(problem.u0))
        # The function does not refer to self: a circle would keep the factors in memory.
        self._loads = lru_cache(1)(lambda number: problem.load(parts[number]))

    def __call__(self, n: int, past: Sequence[State]) -> State:
        """Compute one time step and return the state at t_n.

        Args:
            n: the number of the step.
            past: the previous states, the last one at t_{n−1}.

        Raises:
            EvolutionError: the iteration for a nonlinear law did not converge, or values are not finite.
        """
        block, column = divmod(n - 1, len(self._blocks[0]))
        return self.solved(n * self.k, self._loads(block)[:, column], past)

    def solved(self, time: float, load: Array, past: Sequence[State]) -> State:
        """Compute one time step to a time with a given load vector, (n,); see ``__call__``."""
        before = [state.u for state in past]
        b = reduce(add, (matrix @ u for matrix, u in zip(self.known, reversed(before), strict=False)), load)
        if self.problem.remainder is None:
            return self._state(time, *self.solve(b), b, 1)
        return self._nonlinear(time, b, before, self.problem.remainder)

    def _nonlinear(
        self, time: float, constant: Array, before: Sequence[Array], remainder: Callable[[Array], Array]
    ) -> State:
        """Compute a time step for a nonlinear law by a fixed-point iteration.

        The displacement is the fixed point of the map v ↦ u that solves the contact problem with the equation

        S u + Nᵀλ = constant − remainder(θv + (1 − θ) u_{n−1}).
        """
        problem = self.problem
        theta = self.scheme.theta
        base = (1 - theta) * before[-1]
        multipliers = np.zeros(problem.N.shape[0])

        def image(v: Array) -> Array:
            nonlocal multipliers
            u, multipliers = self.solve(constant - remainder(theta * v + base))
            return u

        # The first guess is extrapolated from the last states (at most three) by a polynomial, which saves iterations.
        weights = {1: (1,), 2: (-1, 2), 3: (1, -3, 3)}[len(before)]
        guess = sum((weight * u for weight, u in zip(weights, before, strict=True)), np.zeros_like(base))
        try:
            u, taken = fixed_point(image, guess, lambda w: problem.M @ w, FIXED_POINT, ITERATIONS)
        except FixedPointError as error:
            raise EvolutionError(
                f"step to t = {time:.6g}: {error}; the contraction number is about k L_G/m_A, so take more steps"
            ) from error
        return self._state(time, u, multipliers, constant - remainder(theta * u + base), taken)

    def _state(self, time: float, u: Array, multipliers: Array, b: Array, iterations: int) -> State:
        # A sum is finite only if all of its terms are finite, so testing the sum suffices.
        if not math.isfinite(u.sum() + multipliers.sum()):
            raise EvolutionError(
                f"the step to t = {time:.6g} gave values that are not finite; check the loads, and use units in which "
                "displacements and forces have moderate size"
            )
        return State(time, u, multipliers, iterations, partial(self._residual, u, multipliers, b))

    def _residual(self, u: Array, multipliers: Array, b: Array) -> float:
        """Return the relative residual of a step, which the attribute ``State.residual`` describes."""
        defect = self.S @ u + self.forces @ multipliers - b
        normal = self.problem.N @ u - self.problem.gap
        size, force = (max(float(abs(v).max(initial=0.0)), TINY) for v in (u, multipliers))
        parts = (
            math.sqrt(defect @ defect) / max(math.sqrt(b @ b), TINY),
            float(normal.max(initial=0.0)) / size,
            float(-multipliers.min(initial=0.0)) / force,
            float(abs(normal * multipliers).max(initial=0.0)) / (size * force),
        )
        # NumPy's maximum is NaN if any value is NaN, whereas Python's max may hide a NaN.
        return float(np.max(parts))
