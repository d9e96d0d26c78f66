"""A step of Problem 3.2 as a convex programme: the least potential Φ over the admissible stresses Σ^h(t)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import clarabel
import numpy as np
import scipy.sparse as sps

from manufactured.tensors import Array, Tensors
from study.fem.space import Space
from study.solve.interior_point import SOLVED, Accuracy, settings
from study.solve.stress_potential import LinearPotential, StressError, YieldPotential

AIM = Accuracy(gap=1e-15, feasibility=1e-11)
"""At the limit of the arithmetic: where a vertex touches with next to no force the error is the root of the gap."""
ENOUGH = Accuracy(gap=1e-12, feasibility=1e-9)
"""Where rounding stops the solver short of its aim. The verdict does not rest on it: it compares the two problems."""


@dataclass(frozen=True, eq=False)
class StressState:
    """One time node of Problem 3.2.

    Attributes:
        time: t_n.
        stress: σ_n ∈ Σ^h(t_n), (D, cells); not a number at t_0, where backward Euler has no rate.
        strain: ε_n, which the law gives for σ_n and ε_{n−1}, (D, cells).
        u: u_n, the multiplier of σ_n ∈ Σ^h(t_n), (n_dofs,).
        multipliers: λ_n ≥ 0, nodal contact forces, (m,); not a number at t_0.
        gap: the duality gap at which the solver stopped, 0 at t_0. With ε_n and u_n from the same
            ε_{n−1} it bounds ‖σ_n − σ*‖² in the norm of C⁻¹ and ‖ε_n − ε*‖² in that of C, σ* and ε* exact:
            for two points of the optimality conditions (P(x − x*), x − x*) = −(λ − λ*)·N(u − u*) ≤ −λ·Nu.
    """

    time: float
    stress: Tensors
    strain: Tensors
    u: Array
    multipliers: Array
    gap: float


class Programme:
    """min Φ over Σ^h(t), for many t.

    The unknown of a cell is scaled by √|T|, so that norms of Q are Euclidean norms, whatever the mesh: with
    x_T = √|T| y_T and q_T = √|T| g_T,

        min Σ_T ½ Q x_T·x_T + q_T·x_T   subject to   Bᵀ x + Nᵀλ = F,   λ ≥ 0,   x_T in its cone,

    B = (√|T| stressᵀ E)_T. Stresses are measured in units that make the data of the step of order one, strains in
    these units times the norm of the compliance (C⁻¹, or k A⁻¹ for law (3.3)); tolerances are then relative.
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
        # Clarabel: min ½ xᵀPx + qᵀx, Ax + s = b, s in a product of cones.
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
        # Where rounding stops the iteration short of AIM, its last iterate is not its best: then it aims at ENOUGH.
        self.retry = partial(solver, ENOUGH)

    def __call__(self, time: float, load: Array, old: Tensors) -> StressState:
        """σ_n, λ_n, u_n and ε_n at t_n from F(t_n) and ε_{n−1}.

        Raises:
            StressError: the solver did not solve it.
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
        # Slacks and their multipliers are both in their cones: no term is negative, none cancels.
        gap = unit**2 * self.compliance * float(np.dot(solution.s, solution.z))
        return StressState(time, self.potential.stress @ y, self.potential.strain(y, old), u, multipliers, gap)

    def unit(self, load: Array, old: Tensors) -> float:
        """The size of stresses in a step: of its load, and of the strain before times C."""
        size = float(np.linalg.norm(load)) + float(np.linalg.norm(self.root * old)) / self.compliance
        return size or 1.0
