"""Problem 3.2 on the strains of V^h: at every time a stress, computed as the solution of a convex programme.

Stresses are constant on cells. The admissible stresses, (3.9) with V^h for V, are

    Σ^h(t) = {τ : (τ, ε(v))_Q ≥ (f(t), v)_V for all v ∈ K^h},      K^h = {v : N v ≤ 0},

and by Farkas' lemma τ ∈ Σ^h(t) if and only if Eᵀ W τ + Nᵀ λ = F(t) for some λ ≥ 0, where E takes nodal values to
strains and W contains the volumes |T|. A step of backward Euler minimises a convex potential over Σ^h(t_n).

The Lagrange multiplier of the equation Eᵀ W τ + Nᵀ λ = F is u_n: stationarity in τ is ε_n = ε(u_n), stationarity in λ
is N u_n ≤ 0, λ·N u_n = 0. Neither is imposed here: the history ε_{n−1} is computed from the stresses, and Theorem 4.2
states that u_n ∈ K^h solves Problem 3.1. This module shares no code with the contact solver or time schemes of Problem
3.1.

The potential of a step. By (3.12) and (3.15), σ_n minimises over Σ^h(t_n) the potential Φ whose derivative is the
inverse of the law of the step, ε_n ↦ σ_n = A (ε_n − ε_{n−1})/k + G ε_n, so that DΦ(σ_n) = ε_n:

* for linear G, with C = A/k + G:

      Φ(τ) = ½ (C⁻¹ τ, τ)_Q + (C⁻¹ (A/k) ε_{n−1}, τ)_Q;

* for the law (3.3), G ε = β (ε − P_K ε): the strain is the same in A and in G, so the potential is the infimal
  convolution over splittings τ = s₁ + s₂,

      Φ(s₁, s₂) = ½ k (A⁻¹ s₁, s₁)_Q + (s₁, ε_{n−1})_Q + |s₂|²_Q/(2β) + ∫_Ω h_K(s₂),

  where h_K, the support function of K = {|Pτ| ≤ r}, is r |s₂| on the range of the projector P and infinite elsewhere;

* for a sum of both, G ε = S + C ε + β (ε − P_K ε), with Ĉ = A/k + C positive and the strain
  r = Ĉ⁻¹((A/k) ε_{n−1} − S): as for (3.3), with Ĉ⁻¹ for k A⁻¹ and r for ε_{n−1}.

All are integrals of densities ½ Q y·y + g(ε_{n−1})·y, where y is an unknown on every cell that determines τ there. For
(3.3) a part (ρ, z) of y lies in the second-order cone ρ ≥ |z|.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import clarabel
import numpy as np
import scipy.sparse as sps

from manufactured.law import Combined, KelvinVoigt, Linear, Yield
from manufactured.tensors import Array, Tensors
from study.fem.material import means
from study.fem.space import Space
from study.solve.interior_point import SOLVED, Accuracy, settings
from study.solve.steps import longest_step, require_unique, step_size

AIM = Accuracy(gap=1e-15, feasibility=1e-11)
"""As accurate as rounding permits: where a vertex touches with almost no force the error is the root of the gap."""
ENOUGH = Accuracy(gap=1e-12, feasibility=1e-9)
"""Accepted if rounding stops the solver before AIM; the verdict does not depend on this value."""


class StressError(RuntimeError):
    """Raised if Problem 3.2 could not be solved."""


class LinearPotential:
    """The potential ½ C⁻¹τ·τ + C⁻¹(A/k) ε_{n−1}·τ in the unknown y = τ, C = A/k + G with cell means of A and G.

    Attributes:
        quadratic: Q of every cell, (cells, p, p).
        stress: y ↦ τ, (D, p).
        cone: number of entries of (ρ, z), the last entries of y.
    """

    cone = 0

    def __init__(self, space: Space, A: Linear, G: Linear, k: float) -> None:
        self.viscosity = np.multiply.outer(means(space, A.factor), A.matrix / k)
        self.quadratic = np.linalg.inv(self.viscosity + np.multiply.outer(means(space, G.factor), G.matrix))
        self.quadratic = (self.quadratic + self.quadratic.swapaxes(1, 2)) / 2
        self.stress = np.eye(len(A.matrix))

    def linear(self, strain: Tensors) -> Array:
        """Return the linear term g(ε_{n−1}), (p, cells)."""
        return _act(self.quadratic, _act(self.viscosity, strain))

    def strain(self, y: Array, old: Tensors) -> Tensors:
        """Return the new strain ε_n = C⁻¹ (σ_n + (A/k) ε_{n−1}), (D, cells)."""
        return _act(self.quadratic, y + _act(self.viscosity, old))


def _act(blocks: Array, values: Array) -> Array:
    """Multiply a vector for every cell by a matrix for every cell: (cells, p, r), (r, cells) → (p, cells)."""
    return np.einsum("cpr,rc->pc", blocks, values)


class YieldPotential:
    """The potential ½ k A⁻¹s₁·s₁ + s₁·ε_{n−1} + |z|²/(2β) + r ρ in the unknown y = (s₁, ρ, z), ρ ≥ |z|.

    z are the coordinates of s₂ in an orthonormal basis R of the range of P, so that |s₂| = |z|. The attributes are
    those of ``LinearPotential``.
    """

    def __init__(self, space: Space, A: Linear, G: Yield, k: float) -> None:
        compliance = k * np.linalg.inv(A.matrix)
        self._with(np.multiply.outer(1 / means(space, A.factor), (compliance + compliance.T) / 2), G)

    def _with(self, compliance: Array, G: Yield) -> None:
        """Set the attributes, with k A⁻¹ or its replacement Ĉ⁻¹ on every cell as ``compliance``, (cells, D, D)."""
        values, vectors = np.linalg.eigh(G.convex.projector)
        R = vectors[:, values > 0.5]
        D, rank = R.shape
        self.compliance = compliance
        self.cone = 1 + rank
        self.quadratic = np.zeros((len(compliance), D + 1 + rank, D + 1 + rank))
        self.quadratic[:, :D, :D] = self.compliance
        self.quadratic[:, D + 1 :, D + 1 :] = np.eye(rank) / G.beta
        self.stress = np.hstack([np.eye(D), np.zeros((D, 1)), R])
        self.radius = G.convex.radius

    def released(self, strain: Tensors) -> Tensors:
        """Return the strain without stress, which is ε_{n−1} because G vanishes inside K, (D, cells)."""
        return strain

    def linear(self, strain: Tensors) -> Array:
        """Return the linear term g(ε_{n−1}) = (ε_{n−1}, r, 0), (p, cells)."""
        rest = np.zeros((self.cone, strain.shape[1]))
        rest[0] = self.radius
        return np.vstack([self.released(strain), rest])

    def strain(self, y: Array, old: Tensors) -> Tensors:
        """Return the new strain ε_n = ε_{n−1} + k A⁻¹ s₁, (D, cells)."""
        return self.released(old) + _act(self.compliance, y[: len(old)])


class CombinedPotential(YieldPotential):
    """The potential ½ Ĉ⁻¹s₁·s₁ + s₁·r + |z|²/(2β) + r_K ρ, with Ĉ = A/k + C and the radius r_K of K.

    The strain without stress is r = Ĉ⁻¹((A/k) ε_{n−1} − S).
    """

    def __init__(self, space: Space, A: Linear, G: Combined, k: float) -> None:
        self.viscosity = np.multiply.outer(means(space, A.factor), A.matrix / k)
        compliance = np.linalg.inv(self.viscosity + G.linear.matrix)
        self.rest = G.at_rest[:, None]
        self._with((compliance + compliance.swapaxes(1, 2)) / 2, G.yielding)

    def released(self, strain: Tensors) -> Tensors:
        """Return the strain r without stress, (D, cells)."""
        return _act(self.compliance, _act(self.viscosity, strain) - self.rest)


def potential(space: Space, law: KelvinVoigt, k: float) -> LinearPotential | YieldPotential:
    """Return the potential of one backward Euler step of a law.

    Raises:
        StressError: the elasticity operator is neither linear, nor (3.3), nor a sum of both: its potential is unknown.
    """
    if isinstance(law.G, Linear):
        return LinearPotential(space, law.A, law.G, k)
    if isinstance(law.G, Yield):
        return YieldPotential(space, law.A, law.G, k)
    if isinstance(law.G, Combined):
        return CombinedPotential(space, law.A, law.G, k)
    raise StressError(
        "Problem 3.2 needs a complementary potential, known for Linear, Yield and Combined, not for "
        f"{type(law.G).__name__}"
    )


@dataclass(frozen=True, eq=False)
class StressState:
    """The solution of Problem 3.2 at one time node.

    Attributes:
        time: t_n.
        stress: σ_n ∈ Σ^h(t_n), (D, cells); NaN at t_0, where backward Euler has no rate.
        strain: ε_n, from the law for σ_n and ε_{n−1}, (D, cells).
        u: u_n, the multiplier of σ_n ∈ Σ^h(t_n), (n_dofs,).
        multipliers: λ_n ≥ 0, nodal contact forces, (m,); NaN at t_0.
        gap: the duality gap at which the solver stopped, 0 at t_0. If ε_n and u_n have the same ε_{n−1}, it bounds
            ‖σ_n − σ*‖² in the norm of C⁻¹ and ‖ε_n − ε*‖² in the norm of C, where σ* and ε* are exact: for two points
            of the optimality conditions (P(x − x*), x − x*) = −(λ − λ*)·N(u − u*) ≤ −λ·Nu.
    """

    time: float
    stress: Tensors
    strain: Tensors
    u: Array
    multipliers: Array
    gap: float


class Programme:
    """The programme min Φ over Σ^h(t), for several t.

    The unknown of a cell is scaled by √|T|, so that norms of Q are Euclidean norms on any mesh: with x_T = √|T| y_T and
    q_T = √|T| g_T,

        min Σ_T ½ Q x_T·x_T + q_T·x_T   subject to   Bᵀ x + Nᵀλ = F,   λ ≥ 0,   x_T in its cone,

    B = (√|T| stressᵀ E)_T. Stresses are measured in units in which the data of the step are of order one, strains in
    these units times the norm of the compliance (C⁻¹, or k A⁻¹ for law (3.3)), so that tolerances are relative.
    """

    def __init__(self, space: Space, N: sps.csr_array, potential: LinearPotential | YieldPotential) -> None:
        cells, m = len(space.volumes), N.shape[0]
        D, p = potential.stress.shape
        self.dofs, self.potential = space.dofs, potential
        self.root = np.sqrt(space.volumes)
        self.compliance = float(np.linalg.norm(potential.quadratic[:, :D, :D], 2, axis=(1, 2)).max())

        def every_cell(matrix: Array) -> sps.csr_array:
            return sps.csr_array(sps.kron(sps.eye_array(cells), matrix))

        def cell_by_cell(blocks: Array) -> sps.csr_array:
            return sps.csr_array(sps.bsr_array((blocks, np.arange(cells), np.arange(cells + 1))))

        by_cells = np.arange(D * cells).reshape(D, cells).T.ravel()
        B = sps.csr_array(sps.diags_array(np.repeat(self.root, D)) @ space.E[by_cells])
        equilibrium = every_cell(potential.stress).T @ B
        in_cones = every_cell(np.eye(p)[p - potential.cone :])
        hessian = sps.block_diag([cell_by_cell(potential.quadratic / self.compliance), sps.csr_array((m, m))])
        # The form of Clarabel: min ½ xᵀPx + qᵀx, Ax + s = b, s in a product of cones.
        constraints = sps.block_array([[equilibrium.T, N.T], [-in_cones, None], [None, -sps.eye_array(m)]])
        cones = [clarabel.ZeroConeT(space.dofs)]
        cones += [clarabel.SecondOrderConeT(potential.cone)] * (cells if potential.cone else 0)
        cones += [clarabel.NonnegativeConeT(m)]
        self.q = np.zeros(p * cells + m)
        self.b = np.zeros(constraints.shape[0])
        P, A = sps.csc_matrix(sps.triu(hessian)), sps.csc_matrix(constraints)

        def solver(aim: Accuracy) -> clarabel.DefaultSolver:
            return clarabel.DefaultSolver(P, self.q, A, self.b, cones, settings(aim, ENOUGH))

        self.solver = solver(AIM)
        # If rounding stops the iteration before AIM, its last iterate is not its best, so ENOUGH is tried.
        self.retry = partial(solver, ENOUGH)

    def __call__(self, time: float, load: Array, old: Tensors) -> StressState:
        """Return σ_n, λ_n, u_n and ε_n at t_n from F(t_n) and ε_{n−1}.

        Raises:
            StressError: the solver failed.
        """
        cells, dofs = len(self.root), self.dofs
        unit = self.unit(load, old)
        slope = self.root * self.potential.linear(old)
        self.q[: slope.size] = slope.T.ravel() / (unit * self.compliance)
        self.b[:dofs] = load / unit
        self.solver.update(q=self.q, b=self.b)
        solution = self.solver.solve()
        if solution.status not in SOLVED:
            solution = self.retry().solve()
        if solution.status not in SOLVED:
            raise StressError(
                f"the stress problem at t = {time:.6g} was not solved: {solution.status} after "
                f"{solution.iterations} iterations, residuals {solution.r_prim:.2g} and {solution.r_dual:.2g}"
            )
        x, multipliers = np.split(unit * np.array(solution.x), [slope.size])
        u = -unit * self.compliance * np.array(solution.z[:dofs])
        y = x.reshape(cells, -1).T / self.root
        # Slacks and their multipliers lie in dual cones, so no term is negative and no cancellation occurs.
        gap = unit**2 * self.compliance * float(np.dot(solution.s, solution.z))
        return StressState(time, self.potential.stress @ y, self.potential.strain(y, old), u, multipliers, gap)

    def unit(self, load: Array, old: Tensors) -> float:
        """Return a typical stress of a step, from its load and from C times the previous strain."""
        size = float(np.linalg.norm(load)) + float(np.linalg.norm(self.root * old)) / self.compliance
        return size or 1.0


@dataclass(frozen=True, eq=False)
class StressProblem:
    """Problem 3.2 on the strains of one V^h: A and G, N (m, n_dofs) of K^h, t ↦ F(t) and u_0^h, (n_dofs,)."""

    space: Space
    law: KelvinVoigt
    N: sps.csr_array
    load: Callable[[float], Array]
    u0: Array

    @classmethod
    def of(cls, space: Space, law: KelvinVoigt, load: Callable[[float], Array], u0: Array) -> StressProblem:
        """Return the problem on a space for a law, a load and an initial value."""
        return cls(space, law, space.N, load, u0)

    def march(self, steps: int) -> Iterator[StressState]:
        """Yield the states of backward Euler at t_0, t_1, …, t_steps.

        Raises:
            StepsError: fewer than one step, or steps so long that they may have several solutions.
            StressError: the law has no known potential, or the solver failed.
        """
        k = step_size(self.space.body.T, steps)
        require_unique("backward Euler", k, self.law.growth, longest_step(self.law.growth))
        programme = Programme(self.space, self.N, potential(self.space, self.law, k))
        strain = self.space.strain(self.u0)
        nan = np.full(self.N.shape[0], np.nan)
        yield StressState(0.0, np.full_like(strain, np.nan), strain, self.u0, nan, 0.0)
        for n in range(1, steps + 1):
            state = programme(n * k, self.load(n * k), strain)
            strain = state.strain
            yield state
