"""Nonlinear elasticity operators: (3.3) and its sum with a linear operator and a stress at rest.

(3.3) is G(ε) = β (ε − P_K ε), with the projection P_K onto a closed convex set. The sum G(ε) = S + C ε + β (ε − P_K ε)
may be neither monotone nor zero at rest.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from manufactured.arguments import Dimension, Size, checked
from manufactured.factor import UNIFORM
from manufactured.law.linear_operator import Linear
from manufactured.law.operators import Homogeneous, LawError
from manufactured.tensors import Array, Tensors, dyad, identity, mapped, size


class ConvexSet(Protocol):
    """The interface of closed convex sets K = {τ : |Pτ| ≤ r} of symmetric tensors; P is an orthogonal projector,
    (D, D)."""

    @property
    def dim(self) -> int: ...
    @property
    def radius(self) -> float: ...
    @property
    def projector(self) -> Array: ...


@dataclass(frozen=True)
@checked(LawError)
class FrobeniusBall:
    """The ball K = {τ : |τ| ≤ r} in the Frobenius norm."""

    radius: Size
    dim: Dimension = 2

    @cached_property
    def projector(self) -> Array:
        return np.eye(size(self.dim))


@dataclass(frozen=True)
@checked(LawError)
class DeviatoricBall:
    """The cylinder K = {τ : |dev τ| ≤ r} of von Mises, with dev τ = τ − (tr τ / d) I."""

    radius: Size
    dim: Dimension = 2

    @cached_property
    def projector(self) -> Array:
        unit = identity(self.dim)
        return np.eye(size(self.dim)) - np.multiply.outer(unit, unit) / self.dim


@dataclass(frozen=True, eq=False)
@checked(LawError)
class Yield(Homogeneous):
    """The elasticity operator (3.3), G(ε) = β (ε − P_K ε), where P_K is the projection onto a convex set K.

    G is 0 inside K. Its Lipschitz constant is L_G = β, and it is monotone, but not strongly: m = 0. For K = {|Pτ| ≤ r}
    it is G(ε) = β (1 − r/|Pε|)_+ Pε.

    Attributes:
        beta: the stiffness β.
        convex: the convex set K.

    Raises:
        LawError: β or r is not positive and finite.
    """

    beta: float
    convex: ConvexSet

    def __post_init__(self) -> None:
        if self.beta <= 0:
            raise LawError(f"(3.3) needs β > 0, got β = {self.beta}")
        if not 0 < self.convex.radius < np.inf:
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
        """The constant matrix (β/2) P that a solver uses instead of the derivative of G, (D, D).

        G minus this matrix has the Lipschitz constant β/2, which is the least for any constant matrix.
        """
        return 0.5 * self.beta * self.convex.projector

    @property
    def at_rest(self) -> Tensors:
        """The stress for the strain 0, which is 0 because K contains 0, (D,)."""
        return np.zeros(size(self.dim))

    def __call__(self, strain: Tensors) -> Tensors:
        part = mapped(self.convex.projector, strain)
        radius = self.convex.radius
        return self.beta * (1 - radius / np.maximum(_norm(part), radius)) * part

    def derivative(self, strain: Tensors, direction: Tensors) -> Tensors:
        part = mapped(self.convex.projector, strain)
        change = mapped(self.convex.projector, direction)
        norm = _norm(part)
        outside = norm > self.convex.radius
        norm = np.where(outside, norm, 1.0)
        radial = self.convex.radius * np.sum(part * change, axis=0) / norm**3
        return self.beta * np.where(outside, (1 - self.convex.radius / norm) * change + radial * part, 0.0)

    def gradient(self, strain: Callable[[], Tensors], change: Array) -> Array:
        at = strain()
        return np.stack([self.derivative(at, each) for each in np.moveaxis(change, 1, 0)], axis=1)

    def normal_response(self, normal: Array) -> tuple[float, float]:
        """Return the response to a normal strain −Q n⊗n, as numbers (b, ρ).

        The normal stress is G(−Q n⊗n)_nn = −b (Q − ρ)_+ for Q ≥ 0, with b = β |P(n⊗n)|² and ρ = r/|P(n⊗n)|.
        """
        length = float(np.linalg.norm(self.convex.projector @ dyad(normal, normal)))
        return self.beta * length**2, self.convex.radius / length


@dataclass(frozen=True, eq=False)
@checked(LawError)
class Combined(Homogeneous):
    """The elasticity operator G(ε) = S + C ε + β (ε − P_K ε): a stress at rest, a linear operator and the law (3.3).

    For K = {|Pτ| ≤ r}, the derivative of G is C inside K, tends to C + βP far from K, and always lies between the two.
    So the constant of monotonicity m is the smallest eigenvalue of C, and the Lipschitz constant L_G is the largest
    absolute eigenvalue of C and of C + βP. If C is not positive, G softens inside K and hardens outside if β is large
    enough.

    Attributes:
        prestress: the stress at rest S, (D,).
        linear: the linear operator C, which may be ``Indefinite``.
        yielding: the operator β (ε − P_K ε).

    Raises:
        LawError: S, C and K have different dimensions, S is not finite, or C varies in space.
    """

    prestress: Tensors
    linear: Linear
    yielding: Yield

    def __post_init__(self) -> None:
        shape = self.prestress.shape
        if self.linear.dim != self.yielding.dim or shape != (len(self.linear.matrix),):
            raise LawError(
                f"S has the shape {shape}, C acts in dimension {self.linear.dim} and K in dimension "
                f"{self.yielding.dim}; give a Mandel vector S, (3,) or (6,), and operators of the same dimension"
            )
        if self.linear.factor is not UNIFORM:
            raise LawError(
                "the linear part varies in space, but the part (3.3) cannot; give a linear part without factor"
            )

    @property
    def dim(self) -> int:
        return self.linear.dim

    @property
    def lipschitz(self) -> float:
        far = self.linear.matrix + self.yielding.beta * self.yielding.convex.projector
        return max(-self.monotonicity, float(np.linalg.eigvalsh(far)[-1]))

    @property
    def monotonicity(self) -> float:
        return self.linear.monotonicity

    @property
    def reference(self) -> Array:
        """The constant matrix C + (β/2) P that a solver uses instead of the derivative of G, (D, D).

        G minus this matrix has the Lipschitz constant β/2.
        """
        return self.linear.matrix + self.yielding.reference

    @property
    def at_rest(self) -> Tensors:
        """The stress at rest S, (D,)."""
        return self.prestress

    def __call__(self, strain: Tensors) -> Tensors:
        return ((self.linear(strain) + self.yielding(strain)).T + self.prestress).T

    def derivative(self, strain: Tensors, direction: Tensors) -> Tensors:
        return self.linear(direction) + self.yielding.derivative(strain, direction)

    def gradient(self, strain: Callable[[], Tensors], change: Array) -> Array:
        return self.linear(change) + self.yielding.gradient(strain, change)

    def normal_response(self, normal: Array) -> tuple[float, float, float, float]:
        """Return the response to a normal strain −Q n⊗n, as numbers (s, g, b, ρ).

        The normal stress is G(−Q n⊗n)_nn = s − g Q − b (Q − ρ)_+ for Q ≥ 0.
        """
        b, edge = self.yielding.normal_response(normal)
        return float(self.prestress @ dyad(normal, normal)), self.linear.normal_modulus(normal), b, edge


def _norm(tensors: Tensors) -> Array:
    # The square root is written out, because derivatives by the complex step need an analytic function, and
    # np.linalg.norm is none.
    return np.sqrt(np.sum(tensors * tensors, axis=0))
