"""The spaces on one mesh for the bound: displacements of degree 2, stresses of degree 3, and the data of the problem.

Problems that cannot be bounded on the mesh are refused.
"""

from __future__ import annotations

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
from study.fem.quadratic import Quadratic
from study.stresses.composite import interval_mass
from study.stresses.hybrid import EquilibratedStress, Equilibrium
from study.stresses.loads import Loads, ProjectedLoads, Snapshot
from study.stresses.oscillation import Oscillation
from study.stresses.stress_space import StressSpace

LEAST_TIMES, CACHED_NUMBERS = 40, 1 << 23
"""The data of at least ``LEAST_TIMES`` times are cached, and of more times up to ``CACHED_NUMBERS`` stored numbers."""
DEGREE = 3
"""Degree of stresses. The projection P f_0 then has degree 2, so that it contains the rigid motions of the cells."""
GRAM = interval_mass(2, DEGREE)
"""Integrals ∫_0^1 B_i B_j of Bernstein polynomials of displacements and of stresses, (3, n)."""
ON_VERTEX = 1e-9
"""Distance, relative to the cell, up to which a line of discontinuity of the material counts as meeting a vertex."""


@dataclass(frozen=True, eq=False)
class Discretisation:
    """Spaces and matrices on one mesh.

    Raises:
        BoundError: the body is not plane; T, the body or the law has an extreme size; A or G jumps inside a cell; or
            the law has no usable monotonicity constant.
    """

    data: Data
    mesh: Mesh

    def __post_init__(self) -> None:
        refuse_solids(self.data)
        refuse_initial_gap(self.data)
        require_units(self.data)
        refuse_jumps_in_cells(self.data, self.mesh)
        self.moduli  # noqa: B018

    @cached_property
    def moduli(self) -> Moduli:
        """The moduli of G relative to A, which decide how the bound grows in time."""
        return moduli(self.data.law)

    @cached_property
    def displacements(self) -> Quadratic:
        """The displacements of degree 2."""
        return Quadratic(self.mesh, self.data.body)

    @cached_property
    def stresses(self) -> StressSpace:
        """The composite stresses of degree 3."""
        return StressSpace(self.mesh, self.data.body, DEGREE)

    @cached_property
    def inverse_viscosity(self) -> Array:
        """The factor 1/α of A⁻¹ at the quadrature points of the stresses, (cells, Q)."""
        return 1 / self.data.law.A.factor(self.stresses.points)

    @cached_property
    def equilibrium(self) -> Equilibrium:
        """The minimisation of the residual over Σ^h, in the norm of ``Moduli.compliance``."""
        compliance = self.moduli.compliance(self.data.body.T)
        if self.data.law.A.factor is not UNIFORM:
            compliance = np.multiply.outer(self.inverse_viscosity, compliance)
        return Equilibrium(self.stresses, compliance)

    @cached_property
    def snapshot(self) -> Callable[[float], Snapshot]:
        """Function from a time to the data at that time, cached because loads and bounds use the same times."""
        # One snapshot stores about as many numbers as there are quadrature points.
        times = max(LEAST_TIMES, CACHED_NUMBERS // self.stresses.weights.size)
        return lru_cache(maxsize=times)(ProjectedLoads(self.data, self.stresses).at)

    @cached_property
    def oscillation(self) -> Oscillation:
        """Bounds of f − P f on each cell in the dual norm."""
        A = self.data.law.A
        return Oscillation(self.stresses, np.linalg.inv(A.matrix), A.factor.low)

    @cached_property
    def sampling(self) -> Sampling:
        """Decides whether the bound is guaranteed, and bounds how much the data can differ from their samples."""
        return Sampling(self.data, self.stresses)

    def load(self, time: float) -> Array:
        """Return the projected load (P f_0, v)_H + (P f_2, v)_{L²(Γ2)} at a time for the basis functions v, (dofs,)."""
        return self.functional(self.snapshot(time).loads)

    def functional(self, loads: Loads) -> Array:
        """Return (P f_0, v)_H + (P f_2, v)_{L²(Γ2)} for the basis functions v and given projected loads, (dofs,)."""
        space, V = self.stresses, self.displacements
        force = space.volumes[:, None, None] * (self._moments @ loads.force.reshape(space.cells, -1, 2))
        places, moments = [V.numbers.T.ravel()], [force.reshape(-1, 2)]
        for _, edges in space.on(Kind.LOADED):
            along = np.einsum("ij,njd,n->ind", GRAM, loads.surface[edges], space.lengths[edges])
            places.append(V.on_edges(edges).ravel())
            moments.append(along.reshape(-1, 2))
        where, values = np.concatenate(places), np.concatenate(moments)
        return np.array([np.bincount(where, each, V.count) for each in values.T]).T.ravel()[V.free]

    @cached_property
    def _moments(self) -> Array:
        """Integrals ∫ B_β b_α/|T| of basis functions of displacements and of P f_0, (6, 3 thirds · lower)."""
        space = self.stresses
        thirds = np.kron(np.eye(3), space.force_shapes)
        return self.displacements.shapes(space.barycentric) * space.shares @ thirds.T

    @cached_property
    def M(self) -> sps.csc_array:
        """The matrix of the inner product (·,·)_V."""
        return self.displacements.form(self.data.law.A.matrix, self.data.law.A.factor(self.displacements.points))

    def norm(self, v: Array) -> Any:
        """Return the norm ‖v‖_V, (..., dofs) → (...)."""
        return np.sqrt(np.maximum(np.einsum("...i,...i->...", v, (self.M @ v.T).T), 0.0))

    @cached_property
    def _strains(self) -> sps.csr_array:
        """The matrix from v to ε(v) at the vertices of the cells; on a cell ε(v) is linear."""
        return self.displacements.strains(np.eye(3))

    def strain(self, v: Array) -> Tensors:
        """Return ε(v) at the quadrature points of the stresses, (..., dofs) → (3, ..., cells, Q)."""
        corners = (self._strains @ v.T).reshape(3, self.stresses.cells, 3, *reversed(v.shape[:-1]))
        found: Tensors = np.ascontiguousarray(np.moveaxis(corners, (1, 2), (-2, -1))) @ self.stresses.barycentric
        return found

    @cached_property
    def _law(self) -> tuple[Callable[[Tensors], Tensors], Callable[[Tensors], Tensors]]:
        """The operators A and G at the quadrature points of the stresses."""
        law, points = self.data.law, self.stresses.points
        return law.A.at(points), law.G.at(points)

    def viscous(self, rate: Array) -> Tensors:
        """Return Aε(rate) at the quadrature points of the stresses, (..., dofs) → (3, ..., cells, Q)."""
        return self._law[0](self.strain(rate))

    def elastic(self, u: Array) -> Tensors:
        """Return Gε(u) at the quadrature points of the stresses, (..., dofs) → (3, ..., cells, Q)."""
        return self._law[1](self.strain(u))

    def nearest_stress(self, loads: Loads, target: Tensors, u: Array) -> EquilibratedStress:
        """Return the stress σ̃ that minimises ‖σ̃ − target‖² + 2 ∫_{Γ3} σ̃_ν u_ν among the stresses that balance the
        loads.

        ``Moduli.compliance`` defines the norm. The ``values`` of the result are σ̃ − target.

        Args:
            loads: at one time or several times.
            target: Aε(ũ̇) + Gε(ũ), (3, ..., cells, Q).
            u: ũ ∈ K, (..., dofs).
        """
        return self.equilibrium.nearest(loads, target, self.normal_moments(u))

    @cached_property
    def cells_at_contact(self) -> Array:
        """The number of the cell at each edge of Γ3, (edges of Γ3,)."""
        edges = [edges for _, edges in self.stresses.on(Kind.CONTACT)]
        return np.asarray(self.stresses.mesh.f2t[0, np.concatenate(edges)])

    def normal_moments(self, v: Array) -> Array:
        """Return the integrals ∫_e v_ν B_i on the edges of Γ3, (..., dofs) → (..., edges of Γ3, n)."""
        found: Array = (self._normal_moments @ v.reshape(-1, v.shape[-1]).T).T
        return found.reshape(*v.shape[:-1], -1, DEGREE + 1)

    @cached_property
    def _normal_moments(self) -> sps.csr_array:
        """The matrix of ``normal_moments``, with the edges of Γ3 and then i as row index."""
        on = self.stresses.on(Kind.CONTACT)
        traces = self.displacements.normal_components(
            [(part, self.displacements.on_edges(edges).T.ravel()) for part, edges in on]
        )
        lengths = self.stresses.lengths[np.concatenate([edges for _, edges in on])]
        return sps.csr_array(sps.kron(sps.diags_array(lengths), GRAM.T) @ traces)


def refuse_solids(data: Data) -> None:
    """Raise BoundError unless the body is plane."""
    if data.body.dim != 2:
        raise BoundError(
            f"the bound rests on composite triangles, the body has dimension {data.body.dim}; give a plane body"
        )


def refuse_initial_gap(data: Data) -> None:
    """Raise BoundError unless the body touches the foundation from the start."""
    if data.has_initial_gap:
        raise BoundError(
            "the bound rests on σ_ν u_ν = 0 on Γ3 and on u_ν ≤ 0, the problem has an initial gap; give a problem "
            "without one"
        )


def refuse_jumps_in_cells(data: Data, mesh: Mesh) -> None:
    """Raise BoundError if A or G jumps inside a cell, because integrals over cells assume smooth coefficients."""
    for direction, offset in data.law.steps:
        distance = (np.array(direction) @ mesh.p - offset)[mesh.t]
        near = ON_VERTEX * np.ptp(distance, axis=0)
        if ((distance.min(axis=0) < -near) & (distance.max(axis=0) > near)).any():
            raise BoundError(
                f"A or G jumps across the line {direction}·x = {offset:g}, which runs through cells of the mesh; "
                "list it as an interface of the body, so that meshes follow it, or take a level that meets it"
            )


def check_force(case: Case | None) -> None:
    """Raise BoundError if f_0 ∉ L²(Ω)²: its oscillation is then infinite, and no composite stress balances it."""
    if case is not None and not case.regularity.force_in_L2:
        raise BoundError(
            f"case {case.name}: {case.regularity} has f_0 ∉ L²(Ω)², and the bound needs stresses with Div σ = −P f_0; "
            "take a case with f_0 in L²"
        )
