"""Problem 3.2, whose unknown is the stress, on the strains of V^h, solved in steps by an interior-point method.

Stresses are constant on cells. The admissible stresses are (3.9) with V^h in place of V,

    Σ^h(t) = {τ : (τ, ε(v))_Q ≥ (f(t), v)_V for all v ∈ K^h},      K^h = {v : N v ≤ 0}.

By Farkas' lemma, τ ∈ Σ^h(t) if and only if Eᵀ W τ + Nᵀ λ = F(t) for some λ ≥ 0, where E maps nodal values to strains
and W contains the volumes |T|. A step of backward Euler minimises a convex potential over Σ^h(t_n).

The Lagrange multiplier of the equation Eᵀ W τ + Nᵀ λ = F is the displacement u_n. At the minimum ε_n = ε(u_n), N
u_n ≤ 0 and λ·N u_n = 0. None of this is imposed: the previous strain ε_{n−1} is computed from the stresses. That
u_n ∈ K^h solves Problem 3.1 is the statement of Theorem 4.2. The theorem can therefore be tested with this module,
which shares no code with the contact solver or the time schemes of Problem 3.1.

The potential of a step. A step maps the strain ε_n to the stress σ_n = A (ε_n − ε_{n−1})/k + G ε_n. By (3.12) and
(3.15), σ_n minimises over Σ^h(t_n) the potential Φ with the inverse of this map as its derivative, DΦ(σ_n) = ε_n:

* for linear G, with C = A/k + G:

      Φ(τ) = ½ (C⁻¹ τ, τ)_Q + (C⁻¹ (A/k) ε_{n−1}, τ)_Q;

* for the law (3.3), G ε = β (ε − P_K ε): the strain is the same in A and in G, so the potential is the infimal
  convolution over splittings τ = s₁ + s₂,

      Φ(s₁, s₂) = ½ k (A⁻¹ s₁, s₁)_Q + (s₁, ε_{n−1})_Q + |s₂|²_Q/(2β) + ∫_Ω h_K(s₂),

  where h_K, the support function of K = {|Pτ| ≤ r}, is r |s₂| on the range of the projector P and infinite elsewhere;

* for a sum of both, G ε = S + C ε + β (ε − P_K ε), with Ĉ = A/k + C positive and the strain
  r = Ĉ⁻¹((A/k) ε_{n−1} − S): as for (3.3), with Ĉ⁻¹ in place of k A⁻¹ and r in place of ε_{n−1}. The law (3.3) alone
  is the case C = 0, S = 0, in which Ĉ⁻¹ = k A⁻¹ and r = ε_{n−1}.

Every Φ is the integral of a density ½ Q y·y + g(ε_{n−1})·y, where y is an unknown on every cell that determines τ
there. For (3.3), a part (ρ, z) of y lies in the second-order cone ρ ≥ |z|.

Source of the solver: P. Goulart, Y. Chen, Clarabel: an interior-point solver for conic programs with quadratic
objectives, arXiv:2405.12762 (2024).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import clarabel
import numpy as np
import scipy.sparse as sps

from manufactured.law import Combined, KelvinVoigt, Linear, Yield
from manufactured.tensors import Array, Tensors
from study.fem.space import Space, means
from study.solve.steps import longest_step, require_unique, step_size

REFINEMENT = 1e-16
"""Tolerance of the linear systems in the solver.

It cannot be reached, so the systems are refined until rounding prevents further progress.
"""
SOLVED = (clarabel.SolverStatus.Solved, clarabel.SolverStatus.AlmostSolved)


class Accuracy(NamedTuple):
    """Tolerances of the interior-point solver.

    Attributes:
        gap: the tolerance for the duality gap, absolute or relative.
        feasibility: the tolerance for the residuals of the constraints.
    """

    gap: float
    feasibility: float


def settings(aim: Accuracy, enough: Accuracy) -> clarabel.DefaultSettings:
    """Return the settings with which the solver stops at a given accuracy.

    Args:
        aim: the accuracy at which the solver stops.
        enough: the accuracy that is accepted if rounding stops the solver before ``aim``.
    """
    found = clarabel.DefaultSettings()
    found.verbose = False
    # Presolve and chordal decomposition are switched off, because the solver could not take new data for the next time
    # step.
    found.presolve_enable = False
    found.chordal_decomposition_enable = False
    found.tol_gap_abs = found.tol_gap_rel = aim.gap
    found.tol_feas = aim.feasibility
    found.reduced_tol_gap_abs = found.reduced_tol_gap_rel = enough.gap
    found.reduced_tol_feas = enough.feasibility
    found.iterative_refinement_abstol = found.iterative_refinement_reltol = REFINEMENT
    return found


AIM = Accuracy(gap=1e-15, feasibility=1e-11)
"""The accuracy at which the solver should stop, as high as rounding permits.

It is needed where a vertex touches with almost no force: there the error is the square root of the duality gap.
"""
ACCEPTED = Accuracy(gap=1e-12, feasibility=1e-9)
"""The accuracy that is accepted if rounding stops the solver before AIM. No verdict depends on this value."""


class StressError(RuntimeError):
    """Raised if Problem 3.2 could not be solved, or if its potential is not known for a law."""


def _act(blocks: Array, values: Array) -> Array:
    """Multiply a vector by a matrix on every cell: (cells, p, r), (r, cells) → (p, cells)."""
    return np.einsum("cpr,rc->pc", blocks, values)


class Potential:
    """The convex potential that one step of backward Euler minimises in the stress problem (Problem 3.2).

    On every cell it is ½ Q y·y + g·y with an unknown y that determines the stress τ. The vector g depends on the
    previous strain. For linear elasticity G the unknown is the stress, y = τ, and Q is the matrix ``compliance``.

    For laws that contain (3.3), with the convex set K = {τ : |Pτ| ≤ r}, the stress is a sum τ = s₁ + s₂ with s₂ in the
    range of P. P is an orthogonal projector: the deviator for the cylinder of von Mises, the identity for a ball. Let
    the columns of R be an orthonormal basis of this range, so that s₂ = R z and |s₂| = |z|. The unknown is
    y = (s₁, ρ, z) with ρ ≥ |z|, and ρ = |z| at the minimum. Q is block diagonal: ``compliance`` for s₁, 0 for ρ, and
    1/β for z, with the stiffness β of (3.3).

    Args:
        space: the space V^h.
        law: the material law.
        k: the length of the step.

    Attributes:
        compliance: the inverse of A/k plus the linear part of G, (cells, D, D): the matrix from a stress to the strain
            that it adds in a step.
        quadratic: the matrix Q for y with p entries, (cells, p, p).
        stress: the matrix from y to the stress τ, (D, p).
        cone: the number of entries of (ρ, z), which are the last entries of y; 0 for linear G.
        radius: the radius r of K; 0 for linear G.

    Raises:
        StressError: G is neither linear, nor (3.3), nor a sum of both, so its potential is not known.
    """

    def __init__(self, space: Space, law: KelvinVoigt, k: float) -> None:
        A = law.A
        G = law.G
        match G:
            case Linear():
                elasticity = np.multiply.outer(means(space, G.factor), G.matrix)
                yielding = None
            case Yield():
                elasticity = np.zeros_like(A.matrix)
                yielding = G
            case Combined():
                elasticity = G.linear.matrix
                yielding = G.yielding
            case _:
                raise StressError(
                    "Problem 3.2 on the strains of V^h needs a law whose complementary potential is known: Linear, "
                    f"Yield or Combined, got {type(G).__name__}; take one of these, or solve Problem 3.1 only"
                )
        self._viscosity = np.multiply.outer(means(space, A.factor), A.matrix / k)
        self._at_rest = G.at_rest[:, None]
        compliance = np.linalg.inv(self._viscosity + elasticity)
        self.compliance = (compliance + compliance.swapaxes(1, 2)) / 2
        self.quadratic = self.compliance
        D = len(A.matrix)
        self.stress = np.eye(D)
        self.cone = 0
        self.radius = 0.0
        if yielding is not None:
            values, vectors = np.linalg.eigh(yielding.convex.projector)
            R = vectors[:, values > 0.5]
            self.cone = 1 + R.shape[1]
            self.radius = yielding.convex.radius
            self.stress = np.hstack([np.eye(D), np.zeros((D, 1)), R])
            self.quadratic = np.zeros((len(compliance), D + self.cone, D + self.cone))
            self.quadratic[:, :D, :D] = self.compliance
            self.quadratic[:, D + 1 :, D + 1 :] = np.eye(R.shape[1]) / yielding.beta

    def released(self, strain: Tensors) -> Tensors:
        """Return the strain at the end of a time step in which there is no stress.

        Args:
            strain: the strain at the start of the step, (D, cells).
        """
        return _act(self.compliance, _act(self._viscosity, strain) - self._at_rest)


@dataclass(frozen=True, eq=False)
class StressState:
    """The solution of the stress problem (Problem 3.2) at one time node t_n, computed by backward Euler.

    Attributes:
        time: the time t_n.
        stress: the admissible stress σ_n, (D, cells), with the D components of a symmetric tensor. At t_0 it is NaN,
            because backward Euler has no rate there.
        strain: the strain ε_n, computed by the law from σ_n and ε_{n−1}, (D, cells).
        u: the displacement u_n, which is the Lagrange multiplier of the equation of equilibrium, (dofs,).
        multipliers: the nodal contact forces λ_n ≥ 0, (m,); NaN at t_0.
        gap: the duality gap at which the solver stopped; 0 at t_0. For linear G it is −λ_n·N u_n ≥ 0, where N u ≤ 0 is
            the constraint of contact. It bounds the error of this step. Let C = A/k + G for a step of length k, and let
            σ*, ε*, λ*, u* solve the step exactly for the same ε_{n−1}. Then ‖σ_n − σ*‖² in the norm of C⁻¹ and
            ‖ε_n − ε*‖² in the norm of C are equal to −(λ_n − λ*)·N(u_n − u*). This is at most the gap, because
            λ*·N u* = 0, λ_n·N u* ≤ 0 and λ*·N u_n ≤ 0. For the law (3.3) the gap has a further term ≥ 0 on each cell.
    """

    time: float
    stress: Tensors
    strain: Tensors
    u: Array
    multipliers: Array
    gap: float


class Programme:
    """Minimises the potential of a time step (``Potential``) over the admissible stresses with the solver Clarabel.

    Calling the object with the time, the load vector and the previous strain solves one step. The solver is made once
    for all steps.

    The potential on a cell T is ½ Q y·y + g·y with an unknown y from which the stress follows, τ = H y. For laws that
    contain (3.3), the last entries (ρ, z) of y lie in the cone ρ ≥ |z|. With the volume |T| of the cell, x_T = √|T| y
    and q_T = √|T| g, the problem is

        min Σ_T ½ Q x_T·x_T + q_T·x_T   subject to   Σ_T B_Tᵀ x_T + Nᵀλ = F,   λ ≥ 0,   x_T in its cone.

    Here B_T = √|T| Hᵀ E_T, E_T is the matrix from displacements to the strain on T, N the constraint matrix, F the load
    vector, and λ are the contact forces. Because of the factor √|T|, Euclidean norms are L² norms on any mesh. Stresses
    are divided by a typical stress of the step, and strains by this stress times the norm of the compliance, so that
    the tolerances of the solver are relative.

    Args:
        space: the space V^h.
        potential: the potential of a step on the cells of this space.
    """

    def __init__(self, space: Space, potential: Potential) -> None:
        N = space.N
        cells = len(space.volumes)
        m = N.shape[0]
        D, p = potential.stress.shape
        self.dofs = space.dofs
        self.potential = potential
        self.root = np.sqrt(space.volumes)
        self.compliance = float(np.linalg.norm(potential.compliance, 2, axis=(1, 2)).max())

        by_cells = np.arange(D * cells).reshape(D, cells).T.ravel()
        B = sps.csr_array(sps.diags_array(np.repeat(self.root, D)) @ space.E[by_cells])
        every_cell = sps.eye_array(cells)
        balance = B.T @ sps.kron(every_cell, potential.stress, format="csr")
        in_cones = sps.kron(every_cell, np.eye(p)[p - potential.cone :])
        blocks = potential.quadratic / self.compliance
        of_cells = sps.csr_array(sps.bsr_array((blocks, np.arange(cells), np.arange(cells + 1))))
        hessian = sps.block_diag([of_cells, sps.csr_array((m, m))])
        # Clarabel expects the form: min ½ xᵀPx + qᵀx subject to Ax + s = b, with s in a product of cones.
        constraints = sps.block_array([[balance, N.T], [-in_cones, None], [None, -sps.eye_array(m)]])
        cones = [clarabel.ZeroConeT(space.dofs)]
        cones += [clarabel.SecondOrderConeT(potential.cone)] * (cells if potential.cone else 0)
        cones += [clarabel.NonnegativeConeT(m)]
        self.q = np.zeros(p * cells + m)
        self.b = np.zeros(constraints.shape[0])
        P = sps.csc_matrix(sps.triu(hessian))
        A = sps.csc_matrix(constraints)
        self.solver = clarabel.DefaultSolver(P, self.q, A, self.b, cones, settings(AIM, ACCEPTED))
        # If rounding stops the iteration before AIM, its last iterate is not its best one. So a second solver stops at
        # ACCEPTED.
        self.retry = partial(clarabel.DefaultSolver, P, self.q, A, self.b, cones, settings(ACCEPTED, ACCEPTED))

    def __call__(self, time: float, load: Array, old: Tensors) -> StressState:
        """Solve one time step and return the state at its end.

        Args:
            time: the time t_n.
            load: the load vector F(t_n), (dofs,).
            old: the previous strain ε_{n−1}, (D, cells).

        Raises:
            StressError: the solver failed.
        """
        cells = len(self.root)
        dofs = self.dofs
        potential = self.potential
        # The unit of stresses is a typical stress of the step, from the load and from the previous strain times C.
        of_strain = np.linalg.norm(self.root * old) / self.compliance
        unit = float(np.linalg.norm(load) + of_strain) or 1.0
        # The linear term of the potential is the released strain, followed by (r, 0) for the entries (ρ, z) of y.
        released = potential.released(old)
        rest = np.zeros((potential.cone, cells))
        rest[:1] = potential.radius
        slope = self.root * np.vstack([released, rest])
        self.q[: slope.size] = slope.T.ravel() / (unit * self.compliance)
        self.b[:dofs] = load / unit
        self.solver.update(q=self.q, b=self.b)
        solution = self.solver.solve()
        if solution.status not in SOLVED:
            solution = self.retry().solve()
        if solution.status not in SOLVED:
            raise StressError(
                f"the stress problem at t = {time:.6g} was not solved: {solution.status} after "
                f"{solution.iterations} iterations, with the residuals {solution.r_prim:.2g} and "
                f"{solution.r_dual:.2g}; use units in which displacements and loads have moderate size"
            )
        x, multipliers = np.split(unit * np.array(solution.x), [slope.size])
        u = -unit * self.compliance * np.array(solution.z[:dofs])
        y = x.reshape(cells, -1).T / self.root
        # The duality gap is the sum of products of slacks and multipliers. They lie in dual cones, so no term is
        # negative, and no digits cancel.
        gap = unit**2 * self.compliance * np.dot(solution.s, solution.z)
        strain = released + _act(potential.compliance, y[: len(old)])
        return StressState(time, potential.stress @ y, strain, u, multipliers, gap)


@dataclass(frozen=True, eq=False)
class StressProblem:
    """Problem 3.2, whose unknown is the stress, for stresses that are constant on each cell, like the strains of V^h.

    Attributes:
        space: the P1 space V^h.
        law: the material law.
        load: the function from a time to the load vector F(t), (dofs,).
        u0: the initial displacement u_0^h, (dofs,).
    """

    space: Space
    law: KelvinVoigt
    load: Callable[[float], Array]
    u0: Array

    def march(self, steps: int) -> Iterator[StressState]:
        """Solve Problem 3.2 by backward Euler and yield the states at t_0, t_1, …, t_steps.

        Raises:
            StepsError: there is less than one step, or a step is so long that it may have several solutions.
            StressError: the potential of the law is not known, or the solver failed.
        """
        k = step_size(self.space.body.T, steps)
        require_unique("backward Euler", k, self.law.growth, longest_step(self.law.growth))
        programme = Programme(self.space, Potential(self.space, self.law, k))
        strain = self.space.strain(self.u0)
        nan = np.full(self.space.N.shape[0], np.nan)
        yield StressState(0.0, np.full_like(strain, np.nan), strain, self.u0, nan, 0.0)
        for n in range(1, steps + 1):
            state = programme(n * k, self.load(n * k), strain)
            strain = state.strain
            yield state
