"""The Kelvin–Voigt law (2.1), and the law at fixed points of a heterogeneous body."""

from __future__ import annotations

from dataclasses import dataclass

from manufactured.arguments import checked
from manufactured.law.linear_operator import Indefinite, Linear
from manufactured.law.operators import AtPoints, Elasticity, LawError
from manufactured.tensors import Array, Hyperplane, Points, Tensors


@dataclass(frozen=True, eq=False)
@checked(LawError)
class KelvinVoigt:
    """The Kelvin–Voigt law σ = A ε̇ + G(ε), equation (2.1).

    Attributes:
        A: the viscosity.
        G: the elasticity operator.
        name: a description for tables and messages.

    >>> import numpy as np
    >>> from manufactured import isotropic
    >>> law = KelvinVoigt(isotropic(1, 1), isotropic(1, 2), "linear")
    >>> law.stress(np.array([1.0, 0, 0]), np.array([0, 1.0, 0])).tolist()  # (3, 1, 0) + (2, 4, 0)
    [5.0, 5.0, 0.0]

    Raises:
        LawError: A and G act on tensors of different dimension, or A is ``Indefinite``.
    """

    A: Linear
    G: Elasticity
    name: str

    def __post_init__(self) -> None:
        if self.A.dim != self.G.dim:
            raise LawError(
                f"A acts in dimension {self.A.dim}, but G in dimension {self.G.dim}; give tensors of the same dimension"
            )
        if isinstance(self.A, Indefinite):
            raise LawError("A is ``Indefinite``, but (3.1) needs m_A > 0: give a ``Linear`` A; only G may soften")

    @property
    def dim(self) -> int:
        return self.A.dim

    @property
    def kappa(self) -> float:
        """The constant κ = L_G/m_A, which bounds how fast two solutions can move apart.

        For every G, κ is a Lipschitz constant of the operator B in (4.3) and an admissible ω in (4.5).
        """
        return self.G.lipschitz / self.A.ellipticity

    @property
    def growth(self) -> float:
        """The rate at which differences of solutions may grow, max(−m, 0)/m_A with the monotonicity constant m of G.

        It is at most ``kappa``, and 0 if G is monotone.
        """
        return max(-self.G.monotonicity, 0.0) / self.A.ellipticity

    def require_dimension(self, dim: int) -> None:
        """Raise LawError if the law does not have the dimension of a body or boundary part."""
        if self.dim != dim:
            raise LawError(
                f"the law {self.name} acts in dimension {self.dim}, the body has dimension {dim}; give its tensors "
                f"that dimension, such as isotropic(1, 0.5, dim={dim})"
            )

    def stress(self, strain_rate: Tensors, strain: Tensors) -> Tensors:
        """Return the stress A ε̇ + G(ε) for a strain rate and a strain: (D, ...), (D, ...) → (D, ...).

        The law must be homogeneous.
        """
        return self.A(strain_rate) + self.G(strain)

    @property
    def steps(self) -> list[Hyperplane]:
        """The lines or planes (direction, offset) across which A or G jumps, sorted and without repetition."""
        return sorted({*self.A.factor.steps, *self.G.factor.steps})

    def at(self, x: Points) -> PointLaw:
        """Return the law at fixed points of the body, (d, ...)."""
        return PointLaw(self.A.at(x), self.G.at(x))

    def scaled(self, viscous: Array, elastic: Array) -> PointLaw:
        """Return the law for given values of the material factors of A and of G, each of shape (...)."""
        return PointLaw(self.A.scaled(viscous), self.G.scaled(elastic))


@dataclass(frozen=True)
class PointLaw:
    """A Kelvin–Voigt law at fixed points, with the values of its material factors there."""

    A: AtPoints
    G: AtPoints

    def stress(self, strain_rate: Tensors, strain: Tensors) -> Tensors:
        """Return the stress A ε̇ + G(ε) at the points: (D, ...), (D, ...) → (D, ...)."""
        return self.A(strain_rate) + self.G(strain)
