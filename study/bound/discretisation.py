"""The finite element spaces on one mesh that the error bound needs: displacements of degree 2 and stresses of degree 3.

``Discretisation`` also evaluates the data of the problem on this mesh. It refuses problems for which no error bound can
be computed.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
import scipy.sparse as sps
from skfem import Mesh

from manufactured.body import Kind
from manufactured.case import Case
from manufactured.data import Data
from manufactured.factor import UNIFORM
from manufactured.tensors import Array, Tensors
from study.bound.problem import BoundError, Moduli, moduli, require_units
from study.bound.remainders import Sampling
from study.fem.space import Quadratic
from study.stresses.hybrid import EquilibratedStress, Equilibrium
from study.stresses.loads import Loads, ProjectedLoads, Snapshot
from study.stresses.oscillation import Oscillation
from study.stresses.stress_space import StressSpace, interval_mass

LEAST_TIMES, CACHED_NUMBERS = 40, 1 << 23
"""Limits of the cache of the data at single times.

At least ``LEAST_TIMES`` times are cached, and more as long as all arrays together have at most ``CACHED_NUMBERS``
numbers.
"""
STRESS_DEGREE = 3
"""Polynomial degree of the stresses. The projected force P f_0 then has degree 2, so it can be any rigid motion."""
GRAM = interval_mass(2, STRESS_DEGREE)
"""Integrals ∫_0^1 B_i B_j of the Bernstein polynomials of degree 2 (displacements) and 3 (stresses), (3, 4)."""
ON_VERTEX = 1e-9
"""Relative distance up to which a vertex counts as lying on a line of discontinuity of the material."""


@dataclass(frozen=True, eq=False)
class Discretisation:
    """The finite element spaces, matrices and data of a problem on one mesh, as the error bound needs them.

    Attributes:
        data: the problem.
        mesh: the mesh of triangles.

    Raises:
        BoundError: the body is not plane; there is an initial gap; the final time, the body or the law has an extreme
            size; the viscosity or the elasticity jumps inside a cell; or the law has no finite monotonicity constant.
    """

    data: Data
    mesh: Mesh

    def __post_init__(self) -> None:
        refuse_unserved(self.data)
        # The quadrature on cells assumes smooth coefficients.
        for direction, offset in self.data.law.steps:
            distance = (np.array(direction) @ self.mesh.p - offset)[self.mesh.t]
            near = ON_VERTEX * np.ptp(distance, axis=0)
            if ((distance.min(axis=0) < -near) & (distance.max(axis=0) > near)).any():
                raise BoundError(
                    f"A or G jumps across the line {direction}·x = {offset:g}, which runs through cells of the mesh; "
                    "list it as an interface of the body, so that meshes follow it, or take a level that meets it"
                )
        self.moduli  # an unusable law is refused here, before anything is computed  # noqa: B018

    @cached_property
    def moduli(self) -> Moduli:
        """The moduli of the elasticity G relative to the viscosity A; they decide how the error bound grows in time."""
        return moduli(self.data.law)

    @cached_property
    def displacements(self) -> Quadratic:
        return Quadratic(self.mesh, self.data.body)

    @cached_property
    def stresses(self) -> StressSpace:
        """The space of composite stresses of degree 3 on the mesh: polynomials on three subtriangles of every cell."""
        return StressSpace(self.mesh, self.data.body, STRESS_DEGREE)

    @cached_property
    def inverse_viscosity(self) -> Array:
        """The values 1/α at the Q quadrature points of every cell, (cells, Q), for the viscosity A(x) = α(x) A_0.

        α is a scalar function, the material factor, and A_0 a constant tensor.
        """
        return 1 / self.data.law.A.factor(self.stresses.points)

    @cached_property
    def compliance(self) -> Array:
        """The matrix W = Σ_i w_i v_i v_iᵀ of the norm in which distances of stresses are measured, (3, 3).

        The v_i are the directions of ``Moduli`` in Mandel form, and the w_i the weights for the final time T of the
        problem. The squared norm of a stress τ is ∫ Wτ·τ/α, with the factor 1/α of ``inverse_viscosity``.
        """
        return self.moduli.compliance(self.data.body.T)

    @cached_property
    def equilibrium(self) -> Equilibrium:
        """Solver for the stress that balances the loads and is nearest to a given stress.

        Distances are measured in the norm of ``compliance``.
        """
        compliance = self.compliance
        if self.data.law.A.factor is not UNIFORM:
            compliance = np.multiply.outer(self.inverse_viscosity, compliance)
        return Equilibrium(self.stresses, compliance)

    @cached_property
    def snapshot(self) -> Callable[[float], Snapshot]:
        """Function from a time to the projected loads, and norms of the part that the projection leaves out.

        Its results are cached, because the computed displacements and the bounds use the loads at the same times.
        """
        # The cache is limited by memory: the results at one time contain about as many numbers as there are quadrature
        # points.
        times = max(LEAST_TIMES, CACHED_NUMBERS // self.stresses.weights.size)
        return lru_cache(maxsize=times)(ProjectedLoads(self.data, self.stresses).at)

    @cached_property
    def oscillation(self) -> Oscillation:
        """Computes the data oscillation of each cell: a bound of the work of the loads that the projection leaves out.

        The projected loads are piecewise polynomials, which discrete stresses can balance.
        """
        A = self.data.law.A
        return Oscillation(self.stresses, np.linalg.inv(A.matrix), A.factor.low)

    @cached_property
    def sampling(self) -> Sampling:
        """Decides whether the error bound is guaranteed, and bounds the change of the data between sample points.

        The data are the loads and the initial displacement.
        """
        return Sampling(self.data, self.stresses)

    def load(self, time: float) -> Array:
        """Return the load vector (P f_0, v)_H + (P f_2, v)_{L²(Γ2)} at a time, for the basis functions v, (dofs,).

        P projects the body force f_0 and the traction f_2 onto piecewise polynomials.
        """
        loads = self.snapshot(time).loads
        space = self.stresses
        V = self.displacements
        edges = space.edges_on(Kind.LOADED)
        inside = space.volumes[:, None, None] * (self._moments @ loads.force.reshape(space.cells, -1, 2))
        outside = np.einsum("ij,njd,n->ind", GRAM, loads.surface[edges], space.lengths[edges])
        where = np.concatenate([V.numbers.T.ravel(), V.on_edges(edges).ravel()])
        values = np.concatenate([inside.reshape(-1, 2), outside.reshape(-1, 2)])
        sums = [np.bincount(where, component, V.count) for component in values.T]
        return np.column_stack(sums).ravel()[V.free]

    @cached_property
    def _moments(self) -> Array:
        """The means over a cell of products of a basis function of displacements and a basis function of P f_0.

        The shape is (6, 3 · lower). Row axis: the 6 basis functions of degree 2. Column axis: the subtriangles of the
        cell (3) and, for each of them, the ``lower`` Bernstein polynomials of P f_0.
        """
        space = self.stresses
        thirds = np.kron(np.eye(3), space.force_shapes)
        return self.displacements.shapes(space.barycentric) * space.shares @ thirds.T

    @cached_property
    def M(self) -> sps.csc_array:
        """The matrix of the inner product (u, v)_V = (Aε(u), ε(v))_Q with the viscosity A, (dofs, dofs)."""
        return self.displacements.form(self.data.law.A.matrix, self.data.law.A.factor(self.displacements.points))

    def norm(self, v: Array) -> Any:
        """Return the norms ‖v‖_V of displacements v, given by their coefficients, (..., dofs) → (...)."""
        return np.sqrt(np.maximum(np.einsum("...i,...i->...", v, (self.M @ v.T).T), 0.0))

    def products(self, *displacements: Array) -> Array:
        """Return the inner products (v_i, v_j)_V of any two of n displacements, (n, n).

        Args:
            displacements: the coefficients of the displacements v_i, (dofs,) each.
        """
        v = np.array(displacements)
        return np.asarray(v @ (self.M @ v.T))

    @cached_property
    def _strains(self) -> sps.csr_array:
        """The matrix from displacements to strains at the three vertices of every cell.

        Strains are linear on a cell, so these values determine them.
        """
        return self.displacements.strains(np.eye(3))

    def strain(self, v: Array) -> Tensors:
        """Return the strain ε(v) of displacements at the quadrature points, (..., dofs) → (3, ..., cells, Q).

        There are Q quadrature points in every cell, those of the composite stresses.
        """
        corners = (self._strains @ v.T).reshape(3, self.stresses.cells, 3, *reversed(v.shape[:-1]))
        corners = np.ascontiguousarray(np.moveaxis(corners, (1, 2), (-2, -1)))
        return np.asarray(corners @ self.stresses.barycentric)

    @cached_property
    def viscous(self) -> Callable[[Array], Tensors]:
        """Function from the coefficients of a velocity u̇ to its viscous stress Aε(u̇) at the quadrature points.

        The shape is (..., dofs) → (3, ..., cells, Q), with Q points in every cell.
        """
        A = self.data.law.A.at(self.stresses.points)
        return lambda rate: A(self.strain(rate))

    @cached_property
    def elastic(self) -> Callable[[Array], Tensors]:
        """Function from the coefficients of a displacement u to its elastic stress Gε(u) at the quadrature points.

        The shape is (..., dofs) → (3, ..., cells, Q), with Q points in every cell.
        """
        G = self.data.law.G.at(self.stresses.points)
        return lambda u: G(self.strain(u))

    def nearest_stress(self, loads: Loads, target: Tensors, u: Array) -> EquilibratedStress:
        """Return the stress σ̃ that balances the loads and is nearest to a given stress, in the norm of ``compliance``.

        Among all stresses that balance the loads, σ̃ minimises ‖σ̃ − target‖² + 2 ∫_{Γ3} σ̃_ν u_ν, where the second
        term is the work of the contact pressure. The attribute ``values`` of the result is the difference σ̃ − target.

        Args:
            loads: the projected loads at one time or at several times.
            target: the given stress at the quadrature points, Aε(u̇) + Gε(u), (3, ..., cells, Q).
            u: an admissible displacement u, (..., dofs).
        """
        return self.equilibrium.nearest(loads, target, self.normal_moments(u))

    def divided_at_contact(self, total: float, work: Array) -> Array:
        """Divide a number among the cells at the contact boundary Γ3 in proportion to the work on their edges.

        Args:
            total: the number.
            work: the work on every edge of Γ3, (edges of Γ3,). If it is 0 everywhere, the result is 0.

        Returns:
            The parts of all cells of the mesh, (cells,).
        """
        parts = total * work / max(work.sum(), np.finfo(float).tiny)
        cells = self.mesh.f2t[0, self.equilibrium.contact]
        return np.bincount(cells, parts, self.stresses.cells)

    def normal_moments(self, v: Array) -> Array:
        """Return the moments ∫_e v_ν B_i of the normal displacement v_ν on every edge e of the contact boundary Γ3.

        The B_i are the n = 4 Bernstein polynomials of degree 3.

        Args:
            v: the coefficients of the displacement, (..., dofs).

        Returns:
            The moments, (..., edges of Γ3, n).
        """
        moments = (self._normal_moments @ v.reshape(-1, v.shape[-1]).T).T
        return np.asarray(moments.reshape(*v.shape[:-1], -1, STRESS_DEGREE + 1))

    @cached_property
    def _normal_moments(self) -> sps.csr_array:
        """The matrix that ``normal_moments`` applies; its rows are ordered by edge e, then by polynomial B_i."""
        V = self.displacements
        on = self.stresses.on(Kind.CONTACT)
        traces = V.normal_components([(part, V.on_edges(edges).T.ravel()) for part, edges in on])
        lengths = self.stresses.lengths[self.equilibrium.contact]
        return sps.csr_array(sps.kron(sps.diags_array(lengths), GRAM.T) @ traces)


def refuse_unserved(data: Data) -> None:
    """Raise BoundError if the body is not plane, if there is an initial gap, or if a size is extreme.

    Displacements that are prescribed in a problem in time are refused, too.
    """
    if data.body.dim != 2:
        raise BoundError(
            f"the bound rests on composite triangles, the body has dimension {data.body.dim}; give a plane body"
        )

    if data.has_initial_gap:
        raise BoundError(
            "the problem has an initial gap, and the bound serves CONTACT sides that touch the foundation at the "
            "start: give a problem without a gap"
        )
    if data.in_time and data.body.is_moved:
        raise BoundError("displacements are prescribed in a problem in time, and only `static` problems serve them")
    require_units(data)


def check_force(case: Case | None) -> None:
    """Raise BoundError if the body force f_0 of a case is not square integrable.

    The error bound would be infinite, because no stress of the element can balance such a force.

    Args:
        case: the case, or None for a problem whose solution is unknown, which is not checked.
    """
    if case is not None and not case.regularity.force_in_L2:
        raise BoundError(
            f"case {case.name}: {case.regularity} has f_0 ∉ L²(Ω)², and the bound needs stresses with Div σ = −P f_0; "
            "take a case with f_0 in L²"
        )
