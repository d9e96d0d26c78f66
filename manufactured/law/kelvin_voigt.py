"""The Kelvin–Voigt law (2.1)."""

from __future__ import annotations

from dataclasses import dataclass

from manufactured.law.linear_operator import Indefinite, Linear
from manufactured.law.operators import AtPoints, Elasticity, LawError
from manufactured.tensors import Array, Hyperplane, Points, Tensors


@dataclass(frozen=True, eq=False)
class KelvinVoigt:
    """σ = A ε̇ + G(ε), equation (2.1).

    >>> import numpy as np
    >>> from manufactured import isotropic
    >>> law = KelvinVoigt(isotropic(1, 1), isotropic(1, 2), "linear")
    >>> law.stress(np.array([1.0, 0, 0]), np.array([0, 1.0, 0])).tolist()  # (3, 1, 0) + (2, 4, 0)
    [5.0, 5.0, 0.0]

    Raises:
        LawError: A and G act on tensors of different dimension, or A has a type that does not guarantee ellipticity.
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
        """κ = L_G/m_A: a Lipschitz constant of B in (4.3), and an ω in (4.5) that is valid for every Lipschitz G."""
        return self.G.lipschitz / self.A.ellipticity

    @property
    def growth(self) -> float:
        """max(−m, 0)/m_A for the constant m of monotonicity of G: the rate at which differences of solutions may grow.

        At most ``kappa``; 0 where G is monotone.
        """
        return max(-self.G.monotonicity, 0.0) / self.A.ellipticity

    def require_dimension(self, dim: int) -> None:
        """Raise an error if a body or a boundary part has another dimension than the law.

        Raises:
            LawError: the law does not act in this dimension.
        """
        if self.dim != dim:
            raise LawError(
                f"the law {self.name} acts in dimension {self.dim}, the body has dimension {dim}; give its tensors "
                f"that dimension, such as isotropic(1, 0.5, dim={dim})"
            )

    def stress(self, strain_rate: Tensors, strain: Tensors) -> Tensors:
        """σ = A ε̇ + G(ε) of a homogeneous law: (D, ...), (D, ...) → (D, ...)."""
        return self.A(strain_rate) + self.G(strain)

    @property
    def steps(self) -> list[Hyperplane]:
        """Return the planes (direction, offset) across which A or G jumps, without repetition, in order."""
        return sorted({*self.A.factor.steps, *self.G.factor.steps})

    def at(self, x: Points) -> PointLaw:
        """The law at fixed points, (d, ...)."""
        return PointLaw(self.A.at(x), self.G.at(x))

    def scaled(self, viscous: Array, elastic: Array) -> PointLaw:
        """Return the law for given values of the factors of A and of G, each of shape (...)."""
        return PointLaw(self.A.scaled(viscous), self.G.scaled(elastic))


@dataclass(frozen=True)
class PointLaw:
    """A Kelvin–Voigt law at fixed points."""

    A: AtPoints
    G: AtPoints

    def stress(self, strain_rate: Tensors, strain: Tensors) -> Tensors:
        """σ = A ε̇ + G(ε): (D, ...), (D, ...) → (D, ...)."""
        return self.A(strain_rate) + self.G(strain)
