"""The Kelvin–Voigt law σ = A ε(u̇) + G ε(u), equation (2.1), and its two ingredients.

A is a viscosity tensor with (3.1), G an elasticity operator with (3.2): linear, or the law (3.3)
G(ε) = β (ε − P_K ε) with a closed convex set K ∋ 0 of S^d. Linear ones may vary in space through a
scalar factor, C(x) = α(x) C. Tensors are Mandel vectors (D, ...).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from manufactured.factor import UNIFORM, Factor
from manufactured.tensors import Array, Points, Tensors, dyad, identity, size


class LawError(ValueError):
    """A constitutive law violates (3.1) or (3.2)."""


class AtPoints(Protocol):
    """A constitutive operator at fixed points: tensors (D, ...) over these points."""

    def __call__(self, strain: Tensors) -> Tensors:
        """C(x) ε or G(x, ε): (D, ...) → (D, ...)."""
        ...

    def derivative(self, strain: Tensors, direction: Tensors) -> Tensors:
        """Its derivative in ε where it exists: (D, ...), (D, ...) → (D, ...)."""
        ...

    def drift(self, strain: Tensors) -> Array | float:
        """Its derivatives in x_j at fixed ε, (D, d, ...); 0 for a homogeneous one."""
        ...


class Elasticity(Protocol):
    """G : S^d → S^d of (3.2).

    ``lipschitz`` is L_G; ``monotonicity`` a constant m with
    (G(a) − G(b))·(a − b) ≥ m |a − b|²; ``reference`` a constant symmetric matrix (D, D) that a
    solver may use in place of the derivative of G (for a linear G: G itself).
    """

    @property
    def dim(self) -> int: ...
    @property
    def lipschitz(self) -> float: ...
    @property
    def monotonicity(self) -> float: ...
    @property
    def reference(self) -> Array: ...

    @property
    def factor(self) -> Factor:
        """The scalar field α of α(x) G(ε)."""
        ...

    def __call__(self, strain: Tensors) -> Tensors:
        """G(ε) of a homogeneous operator, (D, ...) → (D, ...)."""
        ...

    def at(self, x: Points) -> AtPoints:
        """G at fixed points, (d, ...)."""
        ...

    def scaled(self, factor: Array) -> AtPoints:
        """α G for given values of α, (...): what ``at`` is for α = ``factor`` at points, or for its means on cells."""
        ...


@dataclass(frozen=True, eq=False)
class Linear:
    """τ ↦ α(x) C τ with a symmetric positive definite matrix C (D, D) in Mandel form and a factor α > 0.

    Serves as viscosity A, (3.1), and as linear elasticity G, (2.7).

    Raises:
        LawError: C is not square of size D(2) = 3 or D(3) = 6, not finite, not symmetric or not
            elliptic.
    """

    matrix: Array
    factor: Factor = UNIFORM

    def __post_init__(self) -> None:
        matrix = np.asarray(self.matrix, dtype=float)
        if matrix.shape not in ((3, 3), (6, 6)):
            raise LawError(f"a tensor needs a 3×3 (d=2) or 6×6 (d=3) Mandel matrix, got {matrix.shape}")
        if not np.isfinite(matrix).all():
            raise LawError(f"the tensor has entries that are not finite: {matrix.tolist()}")
        if not np.allclose(matrix, matrix.T, rtol=1e-12, atol=0):
            raise LawError("the tensor is not symmetric, but (3.1) needs Aσ·τ = σ·Aτ; symmetrise it")
        smallest = float(np.linalg.eigvalsh(matrix)[0])
        if smallest <= 0:
            raise LawError(
                f"the tensor is not elliptic: its smallest eigenvalue is {smallest:.6g}, but (3.1) "
                "needs m_A > 0; for an isotropic tensor take 2μ > 0 and 2μ + dλ > 0"
            )
        object.__setattr__(self, "matrix", matrix)

    @property
    def dim(self) -> int:
        return 2 if self.matrix.shape[0] == 3 else 3

    @cached_property
    def ellipticity(self) -> float:
        """m_A, the smallest eigenvalue of α C."""
        return self.factor.low * float(np.linalg.eigvalsh(self.matrix)[0])

    @cached_property
    def lipschitz(self) -> float:
        """L_G, the largest eigenvalue of α C."""
        return self.factor.high * float(np.linalg.eigvalsh(self.matrix)[-1])

    @property
    def monotonicity(self) -> float:
        return self.ellipticity

    @property
    def reference(self) -> Array:
        return self.matrix

    def normal_modulus(self, normal: Array) -> float:
        """C_nnnn = (n⊗n)·C(n⊗n), without the factor."""
        direction = dyad(normal, normal)
        return float(direction @ self.matrix @ direction)

    def __call__(self, strain: Tensors) -> Tensors:
        """C ε of a homogeneous tensor.

        Raises:
            LawError: the tensor is heterogeneous and needs points: use ``at`` or ``scaled``.
        """
        if self.factor is not UNIFORM:
            raise LawError("a heterogeneous tensor acts at points: use at(x) or scaled(factors)")
        return np.tensordot(self.matrix, strain, axes=1)

    def at(self, x: Points) -> AtPoints:
        if self.factor is UNIFORM:
            return Scaled(self.matrix)
        return Scaled(self.matrix, self.factor(x), self.factor.gradient(x))

    def scaled(self, factor: Array) -> AtPoints:
        return Scaled(self.matrix, factor)

    def face_block(self, frame: Array) -> Array:
        """Moduli between the strains a contact face can have, d_a·C d_b, (d, d).

        d_0 = n⊗n and d_i = (n⊗t_i + t_i⊗n)/2 for a frame with the columns (t_1, …, n).
        """
        n = frame[:, -1]
        directions = np.array([dyad(n, n), *(dyad(n, tangent) for tangent in frame[:, :-1].T)])
        return directions @ self.matrix @ directions.T


@dataclass(frozen=True, eq=False)
class Scaled:
    """ε ↦ α C ε at fixed points.

    Attributes:
        matrix: C, (D, D).
        factor: α, (...).
        slopes: ∂_j α, (d, ...).
    """

    matrix: Array
    factor: Array | float = 1.0
    slopes: Array | None = None

    def __call__(self, strain: Tensors) -> Tensors:
        product = np.tensordot(self.matrix, strain, axes=1)
        return product if isinstance(self.factor, float) else self.factor * product

    def derivative(self, strain: Tensors, direction: Tensors) -> Tensors:
        return self(direction)

    def drift(self, strain: Tensors) -> Array | float:
        if self.slopes is None:
            return 0.0
        return self.slopes * np.tensordot(self.matrix, strain, axes=1)[:, None]


def isotropic(mu: float, lam: float, dim: int = 2, factor: Factor = UNIFORM) -> Linear:
    """C τ = α(x) (2μ τ + λ (tr τ) I).

    Raises:
        LawError: not elliptic, that is 2μ ≤ 0 or 2μ + dλ ≤ 0.
    """
    unit = identity(dim)
    return Linear(2 * mu * np.eye(size(dim)) + lam * np.multiply.outer(unit, unit), factor)


class ConvexSet(Protocol):
    """A closed convex K ⊂ S^d, 0 ∈ K, that is {τ : |Pτ| ≤ r} for an orthogonal projector P."""

    @property
    def dim(self) -> int: ...
    @property
    def radius(self) -> float: ...
    @property
    def projector(self) -> Array: ...


@dataclass(frozen=True)
class FrobeniusBall:
    """K = {τ : |τ| ≤ r}."""

    radius: float
    dim: int = 2

    @property
    def projector(self) -> Array:
        return np.eye(size(self.dim))


@dataclass(frozen=True)
class DeviatoricBall:
    """K = {τ : |dev τ| ≤ r}, dev τ = τ − (tr τ / d) I: von Mises' cylinder."""

    radius: float
    dim: int = 2

    @property
    def projector(self) -> Array:
        unit = identity(self.dim)
        return np.eye(size(self.dim)) - np.multiply.outer(unit, unit) / self.dim


@dataclass(frozen=True, eq=False)
class Yield:
    """The elasticity operator of (3.3), G(ε) = β (ε − P_K ε), L_G = β, monotone with m = 0.

    For K = {|Pτ| ≤ r}: G(ε) = β (1 − r/|Pε|)_+ Pε.

    Raises:
        LawError: β ≤ 0 or r < 0 (0 ∈ K fails), or one of them is not finite.
    """

    beta: float
    convex: ConvexSet

    def __post_init__(self) -> None:
        if not (np.isfinite(self.beta) and self.beta > 0):
            raise LawError(f"(3.3) needs β > 0, got β = {self.beta}")
        if not (np.isfinite(self.convex.radius) and self.convex.radius > 0):
            raise LawError(f"(3.3) needs a radius r > 0 so that 0 lies in K, got r = {self.convex.radius}")

    @property
    def dim(self) -> int:
        return self.convex.dim

    @property
    def lipschitz(self) -> float:
        return self.beta

    @property
    def monotonicity(self) -> float:
        return 0.0

    @property
    def reference(self) -> Array:
        """(β/2) P: G minus this is Lipschitz with β/2 only, the best constant splitting."""
        return 0.5 * self.beta * self.convex.projector

    def _norm(self, part: Tensors) -> Array:
        # Not np.linalg.norm: complex-step derivatives need the analytic square root.
        return np.sqrt(np.sum(part * part, axis=0))

    def __call__(self, strain: Tensors) -> Tensors:
        part = np.tensordot(self.convex.projector, strain, axes=1)
        norm = self._norm(part)
        outside = norm.real > self.convex.radius
        return self.beta * np.where(outside, 1 - self.convex.radius / np.where(outside, norm, 1.0), 0.0) * part

    def derivative(self, strain: Tensors, direction: Tensors) -> Tensors:
        part = np.tensordot(self.convex.projector, strain, axes=1)
        change = np.tensordot(self.convex.projector, direction, axes=1)
        norm = self._norm(part)
        outside = norm > self.convex.radius
        norm = np.where(outside, norm, 1.0)
        radial = self.convex.radius * np.sum(part * change, axis=0) / norm**3
        return self.beta * np.where(outside, (1 - self.convex.radius / norm) * change + radial * part, 0.0)

    @property
    def factor(self) -> Factor:
        return UNIFORM

    def at(self, x: Points) -> AtPoints:
        return self

    def scaled(self, factor: Array) -> AtPoints:
        return self

    def drift(self, strain: Tensors) -> float:
        return 0.0

    def normal_response(self, normal: Array) -> tuple[float, float]:
        """(b, ρ) such that G(−Q n⊗n)_nn = −b (Q − ρ)_+ for Q ≥ 0: b = β |P(n⊗n)|², ρ = r/|P(n⊗n)|."""
        length = float(np.linalg.norm(self.convex.projector @ dyad(normal, normal)))
        return self.beta * length**2, self.convex.radius / length


@dataclass(frozen=True, eq=False)
class KelvinVoigt:
    """σ = A ε̇ + G(ε), equation (2.1).

    Raises:
        LawError: A and G act on tensors of different dimension.
    """

    A: Linear
    G: Elasticity
    name: str

    def __post_init__(self) -> None:
        if self.A.dim != self.G.dim:
            raise LawError(f"A acts in dimension {self.A.dim}, G in dimension {self.G.dim}; make them equal")

    @property
    def dim(self) -> int:
        return self.A.dim

    def stress(self, strain_rate: Tensors, strain: Tensors) -> Tensors:
        """σ = A ε̇ + G(ε) of a homogeneous law: (D, ...), (D, ...) → (D, ...)."""
        return self.A(strain_rate) + self.G(strain)

    @property
    def steps(self) -> list[tuple[tuple[float, ...], float]]:
        """The planes (direction, offset) across which A or G jumps, each once, in order."""
        return sorted({*self.A.factor.steps, *self.G.factor.steps})

    def at(self, x: Points) -> PointLaw:
        """The law at fixed points, (d, ...)."""
        return PointLaw(self.A.at(x), self.G.at(x))

    def scaled(self, viscous: Array, elastic: Array) -> PointLaw:
        """The law for given values of the factors of A and G, (...) each."""
        return PointLaw(self.A.scaled(viscous), self.G.scaled(elastic))


@dataclass(frozen=True)
class PointLaw:
    """A Kelvin–Voigt law at fixed points."""

    A: AtPoints
    G: AtPoints

    def stress(self, strain_rate: Tensors, strain: Tensors) -> Tensors:
        """σ = A ε̇ + G(ε): (D, ...), (D, ...) → (D, ...)."""
        return self.A(strain_rate) + self.G(strain)
