"""Everything the bound needs on one mesh: displacements of degree 2, stresses of degree 3, data, constants."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sps
from skfem import Mesh

from manufactured.body import Kind
from manufactured.data import Data
from manufactured.law import Linear
from manufactured.tensors import Array, Tensors
from study.fem.quadratic import Quadratic
from study.solve.evolution import SemiDiscrete
from study.stresses.composite import products
from study.stresses.hybrid import Equilibrium, Loads
from study.stresses.loads import ProjectedLoads, Snapshot
from study.stresses.oscillation import LeftOut
from study.stresses.space import StressSpace

KEPT = 8
STEP = 1e-9
"""Relative distance at which a line on which the material changes lies on a vertex."""
DEGREE = 3
"""Degree of stresses: P f_0 then has degree 2, rigid motions of the cells among them."""


class BoundError(ValueError):
    """No bound can be given for the data."""


def refuse_solids(data: Data) -> None:
    """Raise BoundError unless the body is plane."""
    if data.body.dim != 2:
        raise BoundError(
            f"the bound rests on composite triangles, the body has dimension {data.body.dim}; give a plane body"
        )


@dataclass(frozen=True, eq=False)
class Setting:
    """Spaces and matrices on one mesh.

    Raises:
        BoundError: the body is not plane, or the law has no usable monotonicity constant.
    """

    data: Data
    mesh: Mesh

    def __post_init__(self) -> None:
        refuse_solids(self.data)
        self._refuse_steps()
        self.monotonicity  # noqa: B018

    def _refuse_steps(self) -> None:
        """Integrals of strains and stresses rest on tensors that are smooth in every cell."""
        for direction, offset in self.data.law.steps:
            distance = (np.array(direction) @ self.mesh.p - offset)[self.mesh.t]
            near = STEP * np.ptp(distance, axis=0)
            if ((distance.min(axis=0) < -near) & (distance.max(axis=0) > near)).any():
                raise BoundError(
                    f"A or G jumps across the line {direction}·x = {offset:g}, which runs through cells of the mesh; "
                    "list it as an interface of the body, so that meshes follow it, or take a level that meets it"
                )

    @cached_property
    def displacements(self) -> Quadratic:
        return Quadratic(self.mesh, self.data.body)

    @cached_property
    def stresses(self) -> StressSpace:
        return StressSpace(self.mesh, self.data.body, DEGREE)

    @cached_property
    def loads(self) -> ProjectedLoads:
        return ProjectedLoads(self.data, self.stresses)

    def snapshot(self, time: float) -> Snapshot:
        """The data at a time; the last few are kept, because loads and bounds ask for the same times."""
        if time not in self._kept:
            while len(self._kept) >= KEPT:
                del self._kept[next(iter(self._kept))]
            self._kept[time] = self.loads.at(time)
        return self._kept[time]

    @cached_property
    def _kept(self) -> dict[float, Snapshot]:
        return {}

    @cached_property
    def equilibrium(self) -> Equilibrium:
        """min ½‖τ − ρ‖²_{A⁻¹} + … over Σ^h."""
        compliance = np.linalg.inv(self.data.law.A.matrix)
        return Equilibrium(self.stresses, self.inverse_viscosity[..., None, None] * compliance)

    @cached_property
    def inverse_viscosity(self) -> Array:
        """1/α of A at the points of the stresses, (cells, Q)."""
        return 1 / self.data.law.A.factor(self.stresses.points)

    @cached_property
    def monotonicity(self) -> float:
        """m with (G ε₁ − G ε₂)·(ε₁ − ε₂) ≥ m A(ε₁ − ε₂)·(ε₁ − ε₂).

        For a linear G the least eigenvalue of A⁻¹G; else from G's own constant and the bounds of A.

        Raises:
            BoundError: that constant is not finite.
        """
        A, G = self.data.law.A, self.data.law.G
        if not np.isfinite(G.monotonicity):
            raise BoundError(
                f"{self.data.law.name}: G has the monotonicity constant {G.monotonicity}; the bound needs a finite "
                "one, −L_G if nothing better is known"
            )
        if isinstance(G, Linear):
            least = float(np.linalg.eigvals(np.linalg.solve(A.matrix, G.matrix)).real.min())
            return least if G.factor is A.factor else least * G.factor.low / A.factor.high
        return G.monotonicity / (A.lipschitz if G.monotonicity >= 0 else A.ellipticity)

    # ---- displacements

    @cached_property
    def M(self) -> sps.csc_array:
        """The matrix of (·,·)_V."""
        return self.displacements.form(self.data.law.A.matrix, self.data.law.A.factor(self.displacements.points))

    def norm(self, v: Array) -> float:
        """‖v‖_V."""
        return float(np.sqrt(max(v @ (self.M @ v), 0.0)))

    @cached_property
    def at_points(self) -> sps.csr_array:
        """v ↦ ε(v) at the points of the stresses."""
        return self.displacements.strains(self.stresses.barycentric)

    def strain(self, v: Array) -> Tensors:
        """ε(v) at the points of the stresses, (3, cells, Q)."""
        return np.moveaxis((self.at_points @ v).reshape(self.stresses.cells, -1, 3), 2, 0)

    @cached_property
    def _values(self) -> sps.csr_array:
        """v ↦ v at the points of the stresses, transposed."""
        return sps.csr_array(self.displacements.shapes(self.stresses.barycentric).T)

    @cached_property
    def _gram(self) -> Array:
        """∫_0^1 B_i B_j for displacements and stresses, (3, n)."""
        return products(2, DEGREE)

    def functional(self, loads: Loads) -> Array:
        """(P f_0, v)_H + (P f_2, v)_{L²(Γ2)}, (dofs,)."""
        space, V = self.stresses, self.displacements
        force = np.moveaxis(space.weights * space.evaluate(loads.force), 0, 2)
        found = self._values @ force.ravel()
        full = np.zeros((V.count, 2))
        for _, edges in space.on(Kind.LOADED):
            moments = np.einsum("ij,njd,n->ind", self._gram, loads.surface[edges], space.lengths[edges])
            np.add.at(full, V.on_edges(edges), moments)
        return found + full.ravel()[V.free]

    def normal_moments(self, v: Array) -> Array:
        """∫_e v_ν B_i on the edges of Γ3, (edges of Γ3, n)."""
        coefficients = self.displacements.coefficients(v)
        found = []
        for part, edges in self.stresses.on(Kind.CONTACT):
            normal = coefficients[self.displacements.on_edges(edges)] @ part.normal
            found.append((self._gram.T @ normal).T * self.stresses.lengths[edges][:, None])
        return np.concatenate(found)

    def problem(self, load: Callable[[float], Array], u0: Array) -> SemiDiscrete:
        """Problem 5.1 on displacements of degree 2."""
        G, V = self.data.law.G, self.displacements
        factor = G.factor(V.points)
        at_points = G.scaled(factor)

        def remainder(v: Array) -> Array:
            strain = V.strain(v)
            return V.functional(at_points(strain) - factor * np.tensordot(G.reference, strain, axes=1))

        return SemiDiscrete(
            M=self.M,
            reference=V.form(G.reference, factor),
            remainder=None if isinstance(G, Linear) else remainder,
            N=V.N,
            load=load,
            u0=u0,
            T=self.data.body.T,
        )

    @cached_property
    def left_out(self) -> LeftOut:
        """What the projections of the data leave out, cell by cell, in the dual of V."""
        A = self.data.law.A
        return LeftOut(self.stresses, np.linalg.inv(A.matrix), A.factor.low)
