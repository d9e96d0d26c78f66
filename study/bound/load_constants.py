"""Constants of a body: ∫_Ω g·v ≤ C_Ω ‖g‖_H ‖v‖_V and ∫_{Γ2} g·v ≤ C_Γ ‖g‖_{L²(Γ2)} ‖v‖_V for all v ∈ V.

On a coarse mesh let P be the projection onto the polynomials of degree 1 on cells, or on the edges of Γ2. P g is
balanced by a composite stress τ with τν = 0 on Γ3, so that ∫ P g·v = (τ, ε(v))_Q ≤ ‖τ‖_{A⁻¹} ‖v‖_V, and the least
‖τ‖²_{A⁻¹} is at most λ ‖P g‖², λ an eigenvalue of a matrix of the size of the mesh. The rest is orthogonal to the
polynomials of degree 1 on every cell or edge, where ``study.stresses.oscillation`` has constants C_T and C_e. Hence

    C_Ω² ≤ λ + max_T C_T²,     C_Γ² ≤ λ_Γ + max_e C_e².

No inequality of Korn's or constant from the literature enters; the eigenvalues are computed in floating point numbers.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.linalg import eigh

from manufactured.body import Body, Kind
from manufactured.law import Linear
from manufactured.tensors import Array
from study.fem.mesh import FAMILIES
from study.stresses.composite import thirds
from study.stresses.hybrid import Equilibrium
from study.stresses.loads import Loads
from study.stresses.oscillation import cell_constants, loaded_sides
from study.stresses.stress_space import StressSpace

LEVEL = 2
"""Level of the coarse mesh; on finer ones C_Ω falls by a few per cent and C_Γ changes by as much."""
DEGREE = 2
"""Degree of stresses that balance linear loads."""


@dataclass(frozen=True)
class LoadConstants:
    """C_Ω and C_Γ, 0 without Γ2."""

    volume: float
    surface: float


@lru_cache(maxsize=16)
def load_constants(body: Body, A: Linear) -> LoadConstants:
    """C_Ω and C_Γ for a homogeneous A."""
    family = next(family for family in FAMILIES if family.serves(body))
    space = StressSpace(family(body, LEVEL), body, DEGREE)
    compliance = np.linalg.inv(A.matrix)
    equilibrium = Equilibrium(space, compliance)
    inside = _eigenvalue(equilibrium, list(_forces(space)), np.kron(_cell_mass(space), np.eye(2)))
    volume = inside + cell_constants(space.map, compliance, 1).max() ** 2
    sides = [constants for *_, constants in loaded_sides(space, compliance)]
    if not any(constants.size for constants in sides):
        return LoadConstants(float(np.sqrt(volume)), 0.0)
    edges = np.concatenate([mine for _, mine in space.on(Kind.LOADED)])
    mass = np.kron(np.kron(np.diag(space.lengths[edges]), (np.ones((2, 2)) + np.eye(2)) / 6), np.eye(2))
    surface = _eigenvalue(equilibrium, list(_tractions(space, edges)), mass) + np.concatenate(sides).max() ** 2
    return LoadConstants(float(np.sqrt(volume)), float(np.sqrt(surface)))


def _eigenvalue(equilibrium: Equilibrium, loads: list[Loads], mass: Array) -> float:
    """The largest λ of min ‖τ‖²_{A⁻¹} against ‖load‖²."""
    space = equilibrium.space
    stresses = np.array([equilibrium.balance(load).values for load in loads])
    weighted = np.einsum("IJ,nJcq,cq->nIcq", equilibrium.compliance, stresses, space.weights, optimize=True)
    energy = weighted.reshape(len(loads), -1) @ stresses.reshape(len(loads), -1).T
    return float(eigh((energy + energy.T) / 2, mass, eigvals_only=True)[-1])


def _cell_mass(space: StressSpace) -> Array:
    """∫ λ_i λ_j on all cells."""
    return np.kron(np.diag(space.volumes), (np.ones((3, 3)) + np.eye(3)) / 12)


def _forces(space: StressSpace) -> Iterator[Loads]:
    """The functions λ_i e_d of the cells, whose coefficients are their values at the vertices of thirds."""
    values = np.moveaxis(thirds(np.eye(3)), 2, 1)
    surface = np.zeros((len(space.lengths), DEGREE + 1, 2))
    for cell in range(space.cells):
        for i in range(3):
            for direction in range(2):
                force = np.zeros((space.cells, 3, 3, 2))
                force[cell, :, :, direction] = values[i]
                yield Loads(force, surface)


def _tractions(space: StressSpace, edges: Array) -> Iterator[Loads]:
    """The functions of the edges that are 1 at one end and 0 at the other, in each direction."""
    force = np.zeros((space.cells, 3, 3, 2))
    for edge in edges:
        for values in ((1.0, 0.5, 0.0), (0.0, 0.5, 1.0)):
            for direction in range(2):
                surface = np.zeros((len(space.lengths), DEGREE + 1, 2))
                surface[edge, :, direction] = values
                yield Loads(force, surface)
