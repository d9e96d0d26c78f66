"""The interface of elasticity operators, (3.2), as functions of tensors and at fixed points of the body."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from manufactured.factor import Factor
from manufactured.tensors import Array, Points, Tensors


class LawError(ValueError):
    """A constitutive law violates (3.1) or (3.2)."""


class AtPoints(Protocol):
    """A constitutive operator at fixed points: tensors (D, ...) over these points."""

    def __call__(self, strain: Tensors) -> Tensors:
        """C(x) ε or G(x, ε): (D, ...) → (D, ...)."""
        ...

    def derivative(self, strain: Tensors, direction: Tensors) -> Tensors:
        """Return the derivative with respect to ε in a direction, where it exists: (D, ...), (D, ...) → (D, ...)."""
        ...

    def gradient(self, strain: Callable[[], Tensors], change: Array) -> Array:
        """Return ∂_j of C(x) ε(x) or G(x, ε(x)) for ∂_j ε = change, (D, d, ...); ``strain`` gives ε if it is needed."""
        ...


class Elasticity(Protocol):
    """G : S^d → S^d of (3.2).

    ``lipschitz`` is L_G; ``monotonicity`` a constant m with
    (G(a) − G(b))·(a − b) ≥ m |a − b|², negative where G softens; ``reference`` a constant symmetric matrix (D, D)
    that a solver may use instead of the derivative of G (for a linear G: G itself); ``at_rest`` is G(·, 0).
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
        """G(ε) of a homogeneous operator, (D, ...) → (D, ...)."""
        ...

    def at(self, x: Points) -> AtPoints:
        """G at fixed points, (d, ...)."""
        ...

    def scaled(self, factor: Array) -> AtPoints:
        """Return α G for given values of α, (...): those of ``factor`` at points, as in ``at``, or means over cells."""
        ...
