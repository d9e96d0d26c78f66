"""Interfaces of constitutive operators: elasticity operators that satisfy (3.2), and operators at fixed points."""

from collections.abc import Callable
from typing import Protocol, Self

from manufactured.factor import UNIFORM, Factor
from manufactured.tensors import Array, Points, Tensors


class LawError(ValueError):
    """Raised if a constitutive law violates (3.1) or (3.2), or cannot be used as required."""


class AtPoints(Protocol):
    """The interface of a constitutive operator at fixed points of the body; strains and stresses are (D, ...)."""

    def __call__(self, strain: Tensors) -> Tensors:
        """Return the stress C(x) ε or G(x, ε) at the points: (D, ...) → (D, ...)."""
        ...

    def derivative(self, strain: Tensors, direction: Tensors) -> Tensors:
        """Return the derivative of the stress with respect to the strain in a direction: (D, ...), (D, ...) → (D, ...).

        It is used only where the derivative exists.
        """
        ...

    def gradient(self, strain: Callable[[], Tensors], change: Array) -> Array:
        """Return the derivatives ∂_j in space of the stress C(x) ε(x) or G(x, ε(x)), (D, d, ...).

        Args:
            strain: a function that returns ε, (D, ...); it is called only if ε is needed.
            change: the derivatives ∂_j ε, (D, d, ...).
        """
        ...


class Elasticity(Protocol):
    """The interface of an elasticity operator G from strains to stresses that satisfies (3.2).

    Attributes:
        lipschitz: the Lipschitz constant L_G.
        monotonicity: a constant m with (G(a) − G(b))·(a − b) ≥ m |a − b|²; negative if G softens.
        reference: a constant symmetric matrix, (D, D), that a solver may use instead of the derivative of G. For a
            linear symmetric G it is the matrix of G.
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
        """The scalar factor α(x) by which G is multiplied at the point x."""
        ...

    def __call__(self, strain: Tensors) -> Tensors:
        """Return the stress G(ε) for a strain, if the operator is homogeneous: (D, ...) → (D, ...)."""
        ...

    def at(self, x: Points) -> AtPoints:
        """Return the operator at fixed points of the body, (d, ...)."""
        ...

    def scaled(self, factor: Array) -> AtPoints:
        """Return the operator α G for given values of α, (...), for example means of ``factor`` over cells."""
        ...


class Homogeneous:
    """The part of elasticity operators without a scalar factor: they are the same at all points."""

    factor = UNIFORM

    def at(self, x: Points) -> Self:
        return self

    def scaled(self, factor: Array) -> Self:
        return self
