"""Equilibrated stresses σ̃ close to Aε(ũ̇) + Gε(ũ), and the residual ρ = σ̃ − Aε(ũ̇) − Gε(ũ) of the law."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement

import numpy as np

from manufactured.tensors import Array, Tensors, mapped
from study.bound.discretisation import Discretisation
from study.stresses.loads import Loads, Snapshot, together


@dataclass(frozen=True, eq=False)
class LawResidual:
    """ρ of one time, or a coefficient of a parabola in time; several have an axis before that of cells and edges.

    Attributes:
        values: at the points of the stresses, (3, cells, Q).
        parts: the same as ``Equilibration.parts``, (directions, cells, Q).
        normal: Bernstein coefficients of σ̃_ν on Γ3, (edges of Γ3, n).
    """

    values: Tensors
    parts: Array
    normal: Array

    @property
    def each(self) -> list[LawResidual]:
        """Several one by one."""
        return [LawResidual(self.values[:, i], self.parts[:, i], normal) for i, normal in enumerate(self.normal)]


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
        self._directions = discretisation.moduli.directions.T
        self._roots = np.sqrt(stresses.weights * discretisation.inverse_viscosity)

    def elastic(self, u: Array) -> Tensors:
        """Gε(u) at the points of the stresses, (..., dofs) → (3, ..., cells, Q)."""
        return self._G(self.discretisation.strain(u))

    def parts(self, stress: Tensors) -> Array:
        """v_i·σ for the directions of ``study.bound.moduli``, times the roots of weights, (directions, ..., cells, Q).

        Sums of products of two of them over points are ∫_T (v_i·σ)(v_i·τ)/α, and those over directions, too, A⁻¹σ·τ.
        """
        found = mapped(self._directions, stress)
        found *= self._roots
        return found

    def products(self, parts: Sequence[Array]) -> Array:
        """These integrals of any two of n stresses, from their ``parts``, (n, n, directions, ..., cells)."""
        n = len(parts)
        found = np.empty((n, n, *parts[0].shape[:-1]))
        for a, b in combinations_with_replacement(range(n), 2):
            found[a, b] = found[b, a] = np.einsum("...q,...q->...", parts[a], parts[b])
        return found

    def residual(self, loads: Loads, target: Tensors, u: Array) -> LawResidual:
        """ρ for the σ̃ with the least ‖σ̃ − target‖² + 2 ∫_{Γ3} σ̃_ν u_ν among those that balance the loads.

        The norm is that of ``Moduli.compliance``; the target Aε(ũ̇) + Gε(ũ) is (3, cells, Q), u = ũ ∈ K is (dofs,).
        Several have an axis before that of cells, and before that of dofs.
        """
        discretisation = self.discretisation
        found = discretisation.equilibrium.nearest(loads, target, discretisation.normal_moments(u))
        return LawResidual(found.values, self.parts(found.values), -discretisation.equilibrium.pressure(found))

    def knots(self, times: Sequence[float], u: Array, rates: Array) -> list[Knot]:
        """The knots with ũ = u and ũ̇ = rate, (times, dofs) both."""
        snapshots = [self.discretisation.snapshot(time) for time in times]
        viscous, elastic = self._A(self.discretisation.strain(rates)), self.elastic(u)
        residuals = self.residual(together([at.loads for at in snapshots]), viscous + elastic, u).each
        return [
            Knot(snapshot, viscous[:, i], elastic[:, i], residual)
            for i, (snapshot, residual) in enumerate(zip(snapshots, residuals, strict=True))
        ]

    def unbalanced(self, loads: Loads) -> Array:
        """Bounds of ‖loads‖ in the dual of V: the least ‖τ‖_{A⁻¹} of stresses that balance them, τν = 0 on Γ3.

        For several loads, (n,).
        """
        stresses = self.discretisation.equilibrium.balance(loads).values
        return np.asarray(np.sqrt(self.products([self.parts(stresses)])[0, 0].sum(axis=(0, -1))))
