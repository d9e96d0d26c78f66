"""The semi-discrete problem (Problem 5.1) on one mesh, and its time steps.

It is the differential inclusion M u̇ + G(u) + N_{K^h}(u) ∋ F, where N_{K^h} is the normal cone of the admissible set
K^h = {v : N v ≤ g}. g is the initial gap at the vertices of Γ3, 0 in the paper. G is bounded relative to M uniformly in
h, (5.5), so the system is not stiff, and the step k need not be small relative to h.

A time step solves (w/k) M u + G(θu + (1 − θ)u_{n−1}) + N_{K^h}(u) ∋ b for u = u_n, with w and θ of the time scheme
(``study.solve.tableau``).

The matrix S = (w/k) M + θ G_ref is factorised once for all steps with the same w/k, where G_ref belongs to the constant
reference tensor of the law. For a nonlinear law, G − G_ref is treated by a fixed-point iteration, whose contraction
number is about k ‖G − G_ref‖/m_A. A linear law needs no iteration.

**The fixed-point iteration** u = g(v) for a contraction g has Anderson acceleration. Every evaluation of g maps an
iterate v, here called input, to its image g(v). The next input is a linear combination of the last images. Its factors
are chosen so that the residual f(v) = g(v) − v would be smallest if g were affine (D. G. Anderson, Iterative procedures
for nonlinear integral equations, J. ACM 12 (1965) 547–560).

**When to stop.** For a contraction number ρ of g, the distance from u to the fixed point is at most ρ/(1 − ρ) ‖u − v‖.
Two inputs and their images give a lower bound of ρ; the largest of these bounds so far is used as ρ. For ρ > 1/2 the
residual itself is compared with the tolerance. These are estimates: a caller that needs a guaranteed accuracy has to
measure the remaining error.

**Norm.** The norm is ‖w‖² = w·M w. Every vector w is stored together with M w, as an array (2, n). Sums and multiples
of such pairs are pairs, so each image needs one product with M only.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial, reduce
from operator import add
from typing import Any

import numpy as np
import scipy.sparse as sps
from scipy.interpolate import make_interp_spline

from manufactured.law import Elasticity, KelvinVoigt, Linear
from manufactured.tensors import Array, mapped
from study.fem.error_norm import ErrorNorm, gaps_at_vertices
from study.fem.quadrature import blocks
from study.fem.space import Displacements, Space, form, means
from study.solve.multigrid import DIRECT_RESIDUAL, contact_solver
from study.solve.signorini import ContactSolver, Signorini
from study.solve.steps import step_size
from study.solve.tableau import Tableau

VectorFunction = Callable[[Array], Array]
"""A function from a vector to a vector of the same length, (n,) → (n,)."""
SMALLEST_DIVISOR = 1e-150
"""Replaces zero in denominators. The square of this number is still positive."""
SEEN = 3
"""Least number of evaluations before the fixed-point iteration may stop.

They give two estimates of the contraction number.
"""
MEMORY = 3
"""Number of previous iterates that Anderson acceleration of the fixed-point iteration combines."""
CUTOFF = 1e-12
"""In the least squares of Anderson acceleration, smaller eigenvalues of the Gram matrix count as zero.

The number is relative to the largest eigenvalue.
"""


class FixedPointError(RuntimeError):
    """Raised if the fixed-point iteration did not converge."""


def fixed_point(
    image: VectorFunction, v: Array, dual: VectorFunction, tolerance: float, most: int
) -> tuple[Array, int]:
    """Return the fixed point of a contraction, and the number of evaluations of the contraction.

    Args:
        image: the contraction g, (n,) → (n,).
        v: the first input, (n,).
        dual: the function w ↦ M w with the matrix of the norm, ‖w‖² = w·M w.
        tolerance: the iteration stops at this estimated distance from the fixed point, relative to the norm of the
            result.
        most: the largest number of evaluations of g.

    Raises:
        FixedPointError: the iteration did not converge, or values are not finite.
    """

    def with_dual(w: Array) -> Array:
        return np.stack([w, dual(w)])

    u = image(v)
    residual = with_dual(u - v)
    contraction = 0.0
    if _finite(_norm(residual), 1) == 0:
        return u, 1
    whole = with_dual(u)
    memory: deque[tuple[Array, Array]] = deque(maxlen=MEMORY)
    for taken in range(2, most + 1):
        step = _accelerated(residual, memory)
        v = v + step[0]
        u = image(v)
        before = residual
        residual = with_dual(u - v)
        change = residual - before
        # The image of an input v is v plus its residual. So the image changes by the step of the input plus the change
        # of the residual.
        moved = step + change
        whole += moved
        left = _finite(_norm(residual), taken)
        contraction = max(contraction, _norm(moved) / max(_norm(step), SMALLEST_DIVISOR))
        # By the estimate of the distance, the residual may be (1 − ρ)/ρ times the tolerance. It is not required to be
        # smaller than the tolerance, because the estimate of ρ then depends on round-off.
        excess = max(1.0, (1 - contraction) / max(contraction, SMALLEST_DIVISOR))
        if left == 0 or (taken >= SEEN and left <= tolerance * excess * _norm(whole)):
            return u, taken
        memory.append((change, moved))
    raise FixedPointError(f"the fixed-point iteration did not converge in {most} steps")


def _norm(w: Array) -> float:
    """Return the norm (w·M w)^½ of a vector w that is stored together with M w, (2, n)."""
    return float(np.sqrt(max(w[0] @ w[1], 0.0)))


def _finite(size: float, taken: int) -> float:
    if not np.isfinite(size):
        raise FixedPointError(f"the fixed-point iteration did not converge: image {taken} is not finite")
    return size


def _accelerated(residual: Array, memory: Sequence[tuple[Array, Array]]) -> Array:
    """Return the step of Anderson acceleration, residual − Σ γ_i Δu_i, where the γ_i minimise ‖residual − Σ γ_i Δf_i‖.

    Each vector w is stored together with M w, as an array (2, n).

    Args:
        residual: the last residual, (2, n).
        memory: pairs of the differences Δf_i of successive residuals and Δu_i of successive images, (2, n) each.
    """
    if not memory:
        return residual
    changes, of_images = (np.array(parts) for parts in zip(*memory, strict=True))
    gram = changes[:, 0] @ changes[:, 1].T
    # The differences become much smaller from step to step, so the system is scaled to avoid ill-conditioning.
    sizes = np.sqrt(np.maximum(gram.diagonal(), SMALLEST_DIVISOR**2))
    slopes = changes[:, 1] @ residual[0] / sizes
    gamma = np.linalg.lstsq(gram / np.outer(sizes, sizes), slopes, rcond=CUTOFF)[0] / sizes
    return np.asarray(residual - np.tensordot(gamma, of_images, axes=1))


@dataclass(frozen=True, eq=False)
class SemiDiscrete:
    """The semi-discrete problem (Problem 5.1) in displacements on one mesh, with n unknowns and m constraints.

    Attributes:
        M: the matrix of the viscosity A, which is the inner product (·,·)_V on V^h, (n, n).
        reference: the matrix G_ref of the elasticity, (n, n); for a nonlinear law it belongs to a constant reference
            tensor.
        remainder: the function v ↦ (G ε(v) − G_ref ε(v), ε(·))_Q, (n,) → (n,); None for a law of the class ``Linear``.
        N: the constraint matrix, (m, n): displacements with N v ≤ g are admissible.
        load: the function from k times t to the load vectors F(t), (k,) → (n, k).
        u0: the initial value u_0^h ∈ K^h, (n,).
        T: the final time.
        solver: a function that makes the contact solver of one time step from the matrix S of the step and from N; an
            initial gap is passed as ``gap=g``.
        growth: the largest rate max(−μ, 0)/m_A at which two solutions can move apart, with the monotonicity constant μ
            of G and the ellipticity constant m_A of A; 0 for a monotone G. It limits the length of steps.
        gap: the initial gap g ≥ 0 at the contact vertices, (m,), or the number 0 as in the paper.
    """

    M: sps.csc_array
    reference: sps.csc_array
    remainder: VectorFunction | None
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
        """Return the semi-discrete problem (Problem 5.1) in the P1 space V^h for a law, a load and an initial value.

        Args:
            space: the space V^h.
            law: the material law.
            load, u0, gap: the load, the initial value u_0^h and the initial gap, as attributes of ``SemiDiscrete``.
        """
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

    @classmethod
    def of_exact(cls, v_norm: ErrorNorm) -> SemiDiscrete:
        """Return Problem 5.1 whose exact solution is known, with the discretisation of the paper.

        The discrete solution starts from the nodal interpolant u_0^h = Π^h u_0, imposes the contact constraint at the
        vertices of Γ3 (K^h = V^h ∩ K), and has the load (3.7). If the solution has an initial gap, the constraint
        includes it; the paper has no initial gap.

        Args:
            v_norm: gives the exact solution, the space V^h and the load.
        """
        space = v_norm.space
        solution = v_norm.solution
        gap = gaps_at_vertices(solution, space)
        return cls.of(space, solution.law, v_norm.load, v_norm.sample(0.0).interpolant, gap)

    def contact(self, S: sps.csc_array) -> ContactSolver:
        """Return the contact solver for a matrix S: a function from b, (n,), to the pair of u, (n,), and λ, (m,).

        u minimises ½ vᵀSv − bᵀv over the admissible displacements N v ≤ g, and λ are the nodal contact forces.

        Args:
            S: a symmetric positive definite matrix, (n, n).
        """
        return self.solver(S, self.N, gap=self.gap) if np.any(self.gap) else self.solver(S, self.N)

    def initial(self) -> State:
        """Return the state at t_0, with the displacement u_0^h.

        Contact forces are 0 there, because the time scheme does not define them at t_0.
        """
        return State(0.0, self.u0, np.zeros(self.N.shape[0]), 0, lambda: 0.0)

    def elastic(self, v: Array) -> Array:
        """Return the elastic forces (G ε(v), ε(φ_i))_Q of a displacement v for all basis functions φ_i, (n,) → (n,)."""
        linear: Array = self.reference @ v
        return linear if self.remainder is None else linear + self.remainder(v)

    def stepper(self, scheme: Tableau, k: float) -> ContactStep:
        """Return the function that computes the state at t_n from the number n and the previous states.

        Args:
            scheme: the time scheme.
            k: the size of the time steps, t_n = n k.
        """
        return ContactStep(self, scheme, k)


def remainder(space: Displacements, G: Elasticity, factor: Array) -> VectorFunction | None:
    """Return the elastic forces minus their part with a constant reference tensor, as a function of the displacement.

    The elasticity is G(x) = α(x) G_0 with a scalar function α, the material factor. The function is
    v ↦ (α (G_0 − G_ref) ε(v), ε(φ_i))_Q for all basis functions φ_i, where G_ref is the constant reference tensor of
    G_0. For ``Linear`` G it would be 0, and None is returned.

    Args:
        space: the finite element space.
        G: the elasticity.
        factor: the values of α at the quadrature points.
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

    The velocity δu_n, (dofs,), is the difference quotient of the time scheme. The scheme does not define δu_0, so δu_1
    is used for it.

    Args:
        problem: the semi-discrete problem.
        scheme: the time scheme.
        steps: the number of time steps.
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
FIXED_POINT = DIRECT_RESIDUAL / 10
"""The iteration for a nonlinear law stops at this relative distance from the fixed point, in the norm ‖·‖_V.

The residual of a state is measured in another norm. In all runs it was at most five times this value, half of what is
permitted.
"""
FIXED_POINT_ITERATIONS = 60
"""Largest number of iterations of a time step for a nonlinear law."""


class EvolutionError(RuntimeError):
    """Raised if a time step could not be solved, or gave values that are not finite."""


@dataclass(frozen=True, eq=False)
class State:
    """The solution of the semi-discrete problem at one time node t_n.

    Attributes:
        time: the time t_n.
        u: the displacement u_n ∈ K^h, (n,).
        multipliers: the nodal contact forces λ_n ≥ 0, (m,), which are Lagrange multipliers of N u ≤ g.
        iterations: the number of contact problems that were solved in this step.
        residual: a function that returns the residual of the step, which is 0 for an exact solution. For the contact
            problem S u + Nᵀλ = b, N u ≤ g of the step it is the largest of ‖S u + Nᵀλ − b‖/‖b‖, (N u − g)_+, |λ·(N u −
            g)| and λ_−, the last three relative to the size of u and λ. The residual is computed only on request,
            because that takes as long as a step on a coarse mesh.
    """

    time: float
    u: Array
    multipliers: Array
    iterations: int
    residual: Callable[[], float]


class ContactStep:
    """Computes time steps of the semi-discrete problem by one time scheme with one step size k.

    Calling the object with the number n of the step and the previous states returns the state at t_n = n k;
    ``solved`` does the same for a given time and load vector.

    Args:
        problem: the semi-discrete problem.
        scheme: the time scheme.
        k: the step size.

    Attributes:
        S: the matrix of the contact problem in each step, which is factorised once.
        known: the matrices that multiply the earlier displacements u_{n−1}, u_{n−2}, … on the right-hand side:
            w_1 M/k − (1 − θ) G_ref, w_2 M/k, …, with the weights w_j and the number θ of the scheme and the matrices M
            of the viscosity and G_ref of the elasticity.

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
        """Compute one time step to a given time and return the state there.

        Args:
            time: the time t_n.
            load: the load vector F(t_{n−1+θ}) of the step, with the number θ of the scheme, (n,). It is F(t_n) for
                backward Euler and BDF2, and F(t_{n−1/2}) for the midpoint scheme.
            past: the previous states, the last one at t_{n−1}.

        Raises:
            EvolutionError: the iteration for a nonlinear law did not converge, or values are not finite.
        """
        before = [state.u for state in past]
        b = reduce(add, (matrix @ u for matrix, u in zip(self.known, reversed(before), strict=False)), load)
        if self.problem.remainder is None:
            return self._state(time, *self.solve(b), b, 1)
        return self._nonlinear(time, b, before, self.problem.remainder)

    def _nonlinear(self, time: float, constant: Array, before: Sequence[Array], remainder: VectorFunction) -> State:
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
            u, taken = fixed_point(image, guess, lambda w: problem.M @ w, FIXED_POINT, FIXED_POINT_ITERATIONS)
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
        size, force = (max(float(abs(v).max(initial=0.0)), SMALLEST_DIVISOR) for v in (u, multipliers))
        parts = (
            math.sqrt(defect @ defect) / max(math.sqrt(b @ b), SMALLEST_DIVISOR),
            float(normal.max(initial=0.0)) / size,
            float(-multipliers.min(initial=0.0)) / force,
            float(abs(normal * multipliers).max(initial=0.0)) / (size * force),
        )
        # NumPy's maximum is NaN if any value is NaN, whereas Python's max may hide a NaN.
        return float(np.max(parts))


def norm(problem: SemiDiscrete, v: Array) -> Any:
    """Return the norm ‖v‖_V = (A ε(v), ε(v))_Q^{1/2} of discrete displacements v, with the viscosity A.

    Args:
        problem: the semi-discrete problem, which has the matrix of this norm.
        v: the unknowns of one displacement, (dofs,), or of several, (number, dofs).

    Returns:
        One norm, or the norms of several displacements, (number,).
    """
    squares = np.sum(v.T * (problem.M @ v.T), axis=0)
    return np.sqrt(abs(squares))


def histories(states: Iterable[State]) -> tuple[Array, Array]:
    """Return the displacements and the contact forces of several states as arrays, (states, n) and (states, m).

    n is the number of unknowns, and m the number of contact constraints.
    """
    u, multipliers = zip(*((state.u, state.multipliers) for state in states), strict=True)
    return np.array(u), np.array(multipliers)


def path(problem: SemiDiscrete, scheme: Scheme, steps: int) -> Array:
    """Solve the semi-discrete problem by a time scheme with ``steps`` equal steps of [0, T].

    Returns:
        The displacements u_0, …, u_steps, (steps + 1, n).
    """
    return np.array([state.u for state in scheme.march(problem, steps)])


def interpolated(states: Array, nodes: Array) -> Array:
    """Interpolate displacements linearly in time to a finer grid with M steps, (M + 1, n).

    Args:
        states: displacements at the nodes of the coarse grid, (N + 1, n).
        nodes: the indices of these nodes in the finer grid, from 0 to M, (N + 1,).
    """
    return np.asarray(make_interp_spline(nodes, states, k=1)(np.arange(nodes[-1] + 1)))


def last(states: Array, steps: int) -> tuple[Array, Array]:
    """Evaluate the piecewise constant function that is U_n on (t_{n−1}, t_n], at the nodes of a finer time grid.

    Args:
        states: the displacements U_0, …, U_N at equidistant times t_0, …, t_N, (N + 1, n).
        steps: the number of steps of the finer grid, a multiple of N.

    Returns:
        The left and the right limits at the nodes of the finer grid, (steps + 1, n) each.
    """
    ahead = np.repeat(states[1:], steps // (len(states) - 1), axis=0)
    left = np.vstack([states[:1], ahead])
    right = np.vstack([ahead, states[-1:]])
    return left, right


def oscillation(problem: SemiDiscrete, states: Array, steps: int) -> float:
    """Return the largest difference ‖v̇(r) − v̇(s)‖_V of velocities of a solution v at two times in one time step.

    Args:
        problem: gives the norm of V and the final time.
        states: the displacements v at equidistant times, (N + 1, n); v is linear between them.
        steps: the number of time steps into which [0, T] is divided, a divisor of N.
    """
    inner = (len(states) - 1) // steps
    rates = np.diff(states, axis=0) * ((len(states) - 1) / problem.T)
    groups = rates.reshape(steps, inner, -1)
    weighted = (problem.M @ rates.T).T.reshape(groups.shape)
    products = np.einsum("nid,njd->nij", groups, weighted)
    squares = np.einsum("nii->ni", products)
    apart = squares[:, :, None] + squares[:, None] - 2 * products
    return math.sqrt(max(float(apart.max()), 0.0))


def furthest(problem: SemiDiscrete, one: Array, other: Array) -> float:
    """Return the largest distance max_n ‖v_n − w_n‖_V of two solutions v and w at the same times.

    Args:
        problem: the semi-discrete problem, which gives the norm.
        one, other: the displacements v_n and w_n, (steps + 1, unknowns) each.
    """
    return float(norm(problem, one - other).max())
