"""The elasticity operator (3.3), G(ε) = β (ε − P_K ε), with the projection P_K onto a closed convex set."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from manufactured.arguments import Dimension, Size, checked
from manufactured.factor import UNIFORM, Factor
from manufactured.law.operators import AtPoints, LawError
from manufactured.tensors import Array, Points, Tensors, dyad, identity, mapped, size


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
class Yield:
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

    def _norm(self, part: Tensors) -> Array:
        # The square root is written out, because derivatives by the complex step need an analytic function, and
        # np.linalg.norm is none.
        return np.sqrt(np.sum(part * part, axis=0))

    def __call__(self, strain: Tensors) -> Tensors:
        part = mapped(self.convex.projector, strain)
        radius = self.convex.radius
        return self.beta * (1 - radius / np.maximum(self._norm(part), radius)) * part

    def derivative(self, strain: Tensors, direction: Tensors) -> Tensors:
        part = mapped(self.convex.projector, strain)
        change = mapped(self.convex.projector, direction)
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

    def gradient(self, strain: Callable[[], Tensors], change: Array) -> Array:
        at = strain()
        return np.stack([self.derivative(at, each) for each in np.moveaxis(change, 1, 0)], axis=1)

    def normal_response(self, normal: Array) -> tuple[float, float]:
        """Return the response to a normal strain −Q n⊗n, as numbers (b, ρ).

        The normal stress is G(−Q n⊗n)_nn = −b (Q − ρ)_+ for Q ≥ 0, with b = β |P(n⊗n)|² and ρ = r/|P(n⊗n)|.
        """
        length = float(np.linalg.norm(self.convex.projector @ dyad(normal, normal)))
        return self.beta * length**2, self.convex.radius / length
