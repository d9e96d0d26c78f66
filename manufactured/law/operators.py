"""Interfaces of constitutive operators: elasticity operators with (3.2), and operators at fixed points of the body."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from manufactured.factor import Factor
from manufactured.tensors import Array, Points, Tensors


class LawError(ValueError):
    """Raised if a constitutive law violates (3.1) or (3.2), or cannot be used as required."""


class AtPoints(Protocol):
    """A constitutive operator at fixed points: tensors (D, ...) over these points."""

    def __call__(self, strain: Tensors) -> Tensors:
        """Return C(x) ε or G(x, ε): (D, ...) → (D, ...)."""
        ...

    def derivative(self, strain: Tensors, direction: Tensors) -> Tensors:
        """Return the derivative with respect to ε in a direction, where it exists: (D, ...), (D, ...) → (D, ...)."""
        ...

    def gradient(self, strain: Callable[[], Tensors], change: Array) -> Array:
        """Return the derivatives ∂_j of C(x) ε(x) or G(x, ε(x)), (D, d, ...).

        Args:
            strain: a function that returns ε, (D, ...); it is called only if ε is needed.
            change: the derivatives ∂_j ε, (D, d, ...).
        """
        ...


class Elasticity(Protocol):
    """An elasticity operator G : S^d → S^d with (3.2).

    Attributes:
        lipschitz: the Lipschitz constant L_G.
        monotonicity: a constant m with (G(a) − G(b))·(a − b) ≥ m |a − b|²; negative if G softens.
        reference: a constant symmetric matrix, (D, D), that a solver may use instead of the derivative of G; for a
            linear G it is the matrix of G.
        at_rest: the stress G(0), (D,).
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
    def at_rest(self) -> Tensors: ...

    @property
    def factor(self) -> Factor:
        """The scalar field α of α(x) G(ε)."""
        ...

    def __call__(self, strain: Tensors) -> Tensors:
        """Return G(ε) of a homogeneous operator: (D, ...) → (D, ...)."""
        ...

    def at(self, x: Points) -> AtPoints:
        """Return G at fixed points, (d, ...)."""
        ...

    def scaled(self, factor: Array) -> AtPoints:
        """Return α G for given values of α, (...), such as values of ``factor`` at points or means over cells."""
        ...
