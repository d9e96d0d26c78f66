"""Equilibrated stresses σ̃ close to Aε(ũ̇) + Gε(ũ), and the residual ρ = σ̃ − Aε(ũ̇) − Gε(ũ) of the law."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from manufactured.tensors import Array, Tensors
from study.bound.discretisation import Discretisation
from study.stresses.loads import Loads, Snapshot


@dataclass(frozen=True, eq=False)
class LawResidual:
    """ρ at the points of the stresses, (3, cells, Q), and the Bernstein coefficients of σ̃_ν on Γ3, (edges of Γ3, n).

    Both are those of one time, or coefficients of a parabola in time.
    """

    values: Tensors
    normal: Array


@dataclass(frozen=True, eq=False)
class Knot:
    """What two pieces of ũ share: the data, Aε(ũ̇), Gε(ũ) and the residual at their common knot."""

    snapshot: Snapshot
    viscous: Tensors
    elastic: Tensors
    residual: LawResidual


class Equilibration:
    """Finds σ̃ on one mesh."""

    def __init__(self, discretisation: Discretisation) -> None:
        self.discretisation = discretisation
        data, stresses = discretisation.data, discretisation.stresses
        self._A, self._G = (law.at(stresses.points) for law in (data.law.A, data.law.G))
        self._compliance = discretisation.moduli.compliance(data.body.T)
        directions = discretisation.moduli.directions
        self._parts = np.einsum("Ii,Ji->iIJ", directions, directions)
        self._weights = stresses.weights * discretisation.inverse_viscosity

    def elastic(self, u: Array) -> Tensors:
        """Gε(u) at the points of the stresses, (dofs,) → (3, cells, Q)."""
        return self._G(self.discretisation.strain(u))

    def products(self, stress: Tensors, other: Tensors) -> Array:
        """∫_T (v_i·σ)(v_i·τ) on the cells for the directions of ``study.bound.moduli``, (directions, cells).

        Their sum is ∫_T A⁻¹σ·τ.
        """
        return np.einsum("iIJ,Jcq,Icq,cq->ic", self._parts, stress, other, self._weights, optimize=True)

    def residual(self, loads: Loads, target: Tensors, u: Array) -> LawResidual:
        """ρ for the σ̃ with the least ‖σ̃ − target‖² + 2 ∫_{Γ3} σ̃_ν u_ν among those that balance the loads.

        The norm is that of ``Moduli.compliance``; the target Aε(ũ̇) + Gε(ũ) is (3, cells, Q), u = ũ ∈ K is (dofs,).
        """
        discretisation = self.discretisation
        strain = -discretisation.inverse_viscosity * np.tensordot(self._compliance, target, axes=1)
        stress = discretisation.equilibrium(loads, strain, discretisation.normal_moments(u))
        return LawResidual(stress.values - target, -discretisation.equilibrium.pressure(stress))

    def knot(self, time: float, u: Array, rate: Array) -> Knot:
        """The knot with ũ = u and ũ̇ = rate."""
        snapshot = self.discretisation.snapshot(time)
        viscous, elastic = self._A(self.discretisation.strain(rate)), self.elastic(u)
        return Knot(snapshot, viscous, elastic, self.residual(snapshot.loads, viscous + elastic, u))

    def unbalanced(self, loads: Loads) -> float:
        """A bound of ‖loads‖ in the dual of V: the least ‖τ‖_{A⁻¹} of stresses that balance them, τν = 0 on Γ3."""
        stress = self.discretisation.equilibrium.balance(loads).values
        return float(np.sqrt(self.products(stress, stress).sum()))
