"""Constants of the law and of the body for the error bound, and refusal of problems that cannot be bounded.

**Moduli of the law** are numbers g_i and directions v_i with (Gε₁ − Gε₂)·(ε₁ − ε₂) ≥ Σ_i g_i (Av_i·(ε₁ − ε₂))². The v_i
are orthonormal in A, so that A(ε)·ε = Σ_i (Av_i·ε)² and A⁻¹τ·τ = Σ_i (v_i·τ)². For linear G they are the eigenvectors
of A⁻¹G. For other G all g_i are the monotonicity constant m.

**Constants of the body** satisfy ∫_Ω g·v ≤ C_Ω ‖g‖_H ‖v‖_V and ∫_{Γ2} g·v ≤ C_Γ ‖g‖_{L²(Γ2)} ‖v‖_V for all v ∈ V. On a
coarse mesh let P be the projection onto the polynomials of degree 1 on cells, or on the edges of Γ2. A composite stress
τ with τν = 0 on Γ3 balances P g, so that ∫ P g·v = (τ, ε(v))_Q ≤ ‖τ‖_{A⁻¹} ‖v‖_V. The least ‖τ‖²_{A⁻¹} is at most
λ ‖P g‖², where λ is an eigenvalue of a matrix of the size of the mesh. The remainder g − P g is orthogonal to the
polynomials of degree 1 on every cell or edge, for which ``study.stresses.oscillation`` has constants C_T and C_e. Hence

    C_Ω² ≤ λ + max_T C_T²,     C_Γ² ≤ λ_Γ + max_e C_e².

Neither a Korn inequality nor a constant from the literature is used. The eigenvalues are computed in floating point.

**Units.** A bound is computed from square roots of sums of squares, and squares overflow above 1e154 and underflow
below 1e-162. If squares of data underflowed, a bound of 0 would be stated for an error that is not 0. If they
overflowed, infinity or NaN would be compared with numbers. So the material, the body and the final time must have sizes
between ``LEAST_DATUM`` and ``MOST_DATUM``. Then squares of data and of residuals are normal numbers whenever the bound
is at least ``SMALLEST_BOUND``.
"""

import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.linalg import eigh

from manufactured.body import Body, Kind
from manufactured.data import Data
from manufactured.law import KelvinVoigt, Linear
from manufactured.tensors import Array
from study.fem.mesh import FAMILIES, MeshError
from study.stresses.hybrid import Equilibrium
from study.stresses.loads import Loads
from study.stresses.oscillation import cell_constants, loaded_sides
from study.stresses.stress_space import StressSpace, thirds

LEAST_DATUM, MOST_DATUM = 1e-25, 1e25
SMALLEST_BOUND, LARGEST_BOUND = 1e-50, 1e100
"""The error bound, if it is not 0, and all quantities whose squares are summed must lie between these numbers."""
LEVELS_OF_CONSTANTS = (2, 3, 4, 6, 8)
"""Levels of the coarse mesh on which the constants of ``load_constants`` are computed.

The first level at which the mesh fits the body is taken. On finer meshes the constants change by a few per cent only.
"""
DEGREE_OF_CONSTANTS = 2
"""Degree of the polynomial stresses that balance linear loads when ``load_constants`` are computed."""


class BoundError(ValueError):
    """Raised if no error bound can be computed for a problem."""


def place(x: Array) -> str:
    """Return the coordinates of a point, (d,), as text for messages, such as "(0.5, 1)"."""
    return f"({', '.join(f'{c:.4g}' for c in np.ravel(x))})"


@dataclass(frozen=True, eq=False)
class Moduli:
    """The moduli g_i of the elasticity G relative to the viscosity A, with directions v_i in the space of strains.

    They satisfy (Gε₁ − Gε₂)·(ε₁ − ε₂) ≥ Σ_i g_i (Av_i·(ε₁ − ε₂))² for all strains, and the v_i are orthonormal in A.
    For linear G they are the eigenvalues and eigenvectors of A⁻¹G. For other G, all g_i are the same monotonicity
    constant.

    Attributes:
        values: the moduli g_i in ascending order, (directions,).
        directions: the directions v_i in Mandel form as columns, (D, directions).
    """

    values: Array
    directions: Array

    def decay(self, k: float) -> float:
        """Return e^{−mk}, the factor by which the bound of an earlier error changes over a time step.

        m is the smallest of the moduli g_i of G relative to A. If it is negative, which means that G is not monotone,
        the factor is greater than 1.

        Args:
            k: the length of the time step.
        """
        return float(np.exp(-self.values.min() * k))

    def weights(self, time: float) -> Array:
        """Return for every direction v_i its weight w_i in the norm of residuals of the material law, (directions,).

        The weight is w_i = T/(1 + 2 T max(g_i, 0)) with the modulus g_i and the final time T. Let ρ_i be the part of
        the residual in the direction v_i. In a time step the square of the error bound increases, to first order, by a
        multiple of Σ_i |ρ_i|²/(g_i + β): a large g_i makes the increase small, because the elasticity compensates a
        part of the residual. A negative g_i compensates nothing and counts as 0. The number β ≥ 0 is optimised in each
        step. The weights are fixed: w_i is half of 1/(g_i + β) for β = 1/(2T).

        Args:
            time: the final time T.
        """
        return np.asarray(time / (1 + 2 * time * np.maximum(self.values, 0.0)))

    def compliance(self, time: float) -> Array:
        """Return the matrix Σ_i w_i v_i v_iᵀ of the norm in which residuals of the material law are minimised, (D, D).

        The residual is a stress in equilibrium with the loads minus the stress that the law gives for a displacement.
        The stress in equilibrium is chosen to make it small in this norm. The w_i are the weights of the directions v_i
        (``weights``), through which the norm depends on the final time T. The matrix is in Mandel form.

        Args:
            time: the final time T.
        """
        return (self.directions * self.weights(time)) @ self.directions.T


def moduli(law: KelvinVoigt) -> Moduli:
    """Return the moduli of the elasticity G of a law relative to its viscosity A.

    Raises:
        BoundError: G has no finite monotonicity constant.
    """
    A = law.A
    G = law.G
    if not np.isfinite(G.monotonicity):
        raise BoundError(
            f"{law.name}: G has the monotonicity constant {G.monotonicity}; the bound needs a finite "
            "one, −L_G if nothing better is known"
        )
    if isinstance(G, Linear):
        values, directions = eigh(G.matrix, A.matrix)
        if G.factor is not A.factor:
            damped = G.factor.low / A.factor.high
            grows = G.factor.high / A.factor.low
            values *= np.where(values >= 0, damped, grows)
        return Moduli(values, directions)
    m = G.monotonicity / (A.lipschitz if G.monotonicity >= 0 else A.ellipticity)
    _, directions = eigh(A.matrix, A.matrix)
    return Moduli(np.full(len(directions), m), directions)


@dataclass(frozen=True)
class LoadConstants:
    """Constants that bound the work of loads: ∫_Ω g·v ≤ C_Ω ‖g‖_H ‖v‖_V and ∫_{Γ2} g·v ≤ C_Γ ‖g‖_{L²(Γ2)} ‖v‖_V.

    Attributes:
        volume: the constant C_Ω for the body force.
        surface: the constant C_Γ for the traction on Γ2; 0 if Γ2 is empty.
    """

    volume: float
    surface: float


@lru_cache(maxsize=16)
def load_constants(body: Body, A: Linear) -> LoadConstants:
    """Return constants with ∫_Ω g·v ≤ C_Ω ‖g‖_H ‖v‖_V and ∫_{Γ2} g·v ≤ C_Γ ‖g‖_{L²(Γ2)} ‖v‖_V for all displacements v.

    They bound the work of body forces and of tractions; ‖v‖_V = (A ε(v), ε(v))_Q^½.

    Args:
        body: the body.
        A: the viscosity, the same at all points.
    """
    space = _coarse_stresses(body)
    compliance = np.linalg.inv(A.matrix)
    equilibrium = Equilibrium(space, compliance)
    of_cells = cell_constants(space.map, compliance, 1)
    volume = _largest_ratio(equilibrium, *_linear_forces(space)) + of_cells.max() ** 2
    edges = space.edges_on(Kind.LOADED)
    if not edges.size:
        return LoadConstants(math.sqrt(volume), 0.0)
    of_sides = np.concatenate([constants for *_, constants in loaded_sides(space, compliance)])
    surface = _largest_ratio(equilibrium, *_linear_tractions(space, edges)) + of_sides.max() ** 2
    return LoadConstants(math.sqrt(volume), math.sqrt(surface))


def _linear_forces(space: StressSpace) -> tuple[Loads, Array]:
    """Return a basis of the body forces that are linear on every cell, and the integrals of products of any two."""
    # The forces are given by their values at the vertices of the thirds of cells.
    hats = np.moveaxis(thirds(np.eye(3)), 2, 1)
    force = np.einsum("kc,itv,de->kidctve", np.eye(space.cells), hats, np.eye(2))
    force = force.reshape(-1, space.cells, 3, 3, 2)
    surface = np.zeros((len(force), len(space.lengths), DEGREE_OF_CONSTANTS + 1, 2))
    of_hats = (1 + np.eye(3)) / 12
    return Loads(force, surface), np.kron(np.diag(space.volumes), np.kron(of_hats, np.eye(2)))


def _linear_tractions(space: StressSpace, edges: Array) -> tuple[Loads, Array]:
    """Return a basis of the tractions that are linear on given edges, and the integrals of products of any two."""
    count = len(space.lengths)
    # The Bernstein coefficients of the functions that are 1 at one end and 0 at the other.
    hats = np.array([[1, 0.5, 0], [0, 0.5, 1]])
    surface = np.einsum("ke,in,df->kidenf", np.eye(count)[edges], hats, np.eye(2))
    surface = surface.reshape(-1, count, DEGREE_OF_CONSTANTS + 1, 2)
    force = np.zeros((len(surface), space.cells, 3, 3, 2))
    of_hats = (1 + np.eye(2)) / 6
    return Loads(force, surface), np.kron(np.diag(space.lengths[edges]), np.kron(of_hats, np.eye(2)))


def _coarse_stresses(body: Body) -> StressSpace:
    """Return stresses on the coarsest mesh that fits the body; next to holes the coarsest ones may not."""
    family = next(family for family in FAMILIES if family.serves(body))
    for level in LEVELS_OF_CONSTANTS:
        with suppress(MeshError):
            return StressSpace(family(body, level), body, DEGREE_OF_CONSTANTS)
    raise BoundError(
        f"no mesh of level {LEVELS_OF_CONSTANTS[-1]} or coarser fits the body, so the work of loads cannot be bounded: "
        "leave out small holes, or give loads that are polynomials of degree 3"
    )


def _largest_ratio(equilibrium: Equilibrium, loads: Loads, mass: Array) -> float:
    """Return the largest ratio λ = min_τ ‖τ‖²_{A⁻¹}/‖load‖² of all loads in a space; the stresses τ balance the load.

    Args:
        equilibrium: finds the stress with the smallest norm.
        loads: a basis of the loads.
        mass: the integrals of products of two loads of the basis.
    """
    stresses = equilibrium.balance(loads).values
    weighted = np.einsum("IJ,Jncq,cq->Incq", equilibrium.compliance, stresses, equilibrium.space.weights, optimize=True)
    energy = np.einsum("Incq,Imcq->nm", weighted, stresses, optimize=True)
    ratios = eigh((energy + energy.T) / 2, mass, eigvals_only=True)
    return float(ratios[-1])


def require_units(data: Data) -> None:
    """Refuse a material, a body or a final time of extreme size, because squares would overflow or underflow.

    Args:
        data: the problem.

    Raises:
        BoundError: a quantity is too large or too small; the message names it and its value.
    """
    A = data.law.A
    G = data.law.G
    sizes = {
        "the final time T": [data.body.T],
        "the size of the body": np.ptp(data.body.vertices, axis=1),
        "a modulus of A": [A.ellipticity, A.lipschitz],
    }
    if isinstance(G, Linear) and G.matrix.any():
        sizes["the largest entry of G"] = [abs(G.matrix).max()]
    for name, values in sizes.items():
        for value in values:
            if not LEAST_DATUM <= value <= MOST_DATUM:
                raise BoundError(
                    f"{name} is {value:.3g}; squares of such numbers overflow or vanish in double precision: state the "
                    f"problem in units in which it lies between {LEAST_DATUM:g} and {MOST_DATUM:g}"
                )


def require_finite(quantities: Mapping[str, Array | float]) -> None:
    """Refuse quantities that are infinite, NaN, or so large that their squares overflow.

    Args:
        quantities: the values of each quantity, by its name.

    Raises:
        BoundError: there is such a quantity; the message names the first one.
    """
    for name, values in quantities.items():
        # Every comparison with NaN is false, so the condition is written such that NaN is refused as well.
        if not (np.abs(values) <= LARGEST_BOUND).all():
            raise BoundError(
                f"{name} is not a finite number below {LARGEST_BOUND:g}, so nothing can be bounded: large data "
                "overflow, and data that are unbounded near some point have no finite range; state the problem in "
                "units in which the data have moderate size, or give bounded data"
            )


def require_ordered(low: Array | float, high: Array | float) -> None:
    """Refuse intervals whose lower end is above the upper end: their bounds contradict each other.

    Args:
        low, high: the lower and the upper ends of the intervals.

    Raises:
        BoundError: a lower end is above its upper end.
    """
    if np.any(np.greater(low, high)):
        raise BoundError(f"the interval from {low} to {high} has crossed ends: this is a defect of the program")


def require_visible(highest: float, nonzero: bool) -> None:
    """Refuse an error bound so small that squares of nonzero data may have underflowed to 0.

    Args:
        highest: the error bound.
        nonzero: whether any sample of the loads, of u_0 or of u_h is nonzero.

    Raises:
        BoundError: the bound is too small; the message states it.
    """
    if not nonzero:
        return
    if not math.isfinite(highest):
        raise BoundError(
            f"the bound is {highest}: squares of displacements or data overflow in double precision; check them, and "
            "state the problem in units in which they have moderate size"
        )
    if highest < SMALLEST_BOUND:
        raise BoundError(
            f"the data are not zero, and the bound is {highest:.3g}, below {SMALLEST_BOUND:g}: squares of numbers this "
            "small vanish in double precision; state the problem in units in which the data have moderate size"
        )
