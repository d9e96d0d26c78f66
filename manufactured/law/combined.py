"""An elasticity operator that is neither monotone nor zero at rest, G(ε) = S + C ε + β (ε − P_K ε)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from manufactured.arguments import checked
from manufactured.factor import UNIFORM, Factor
from manufactured.law.linear_operator import Linear
from manufactured.law.operators import AtPoints, LawError
from manufactured.law.projection import Yield
from manufactured.tensors import Array, Tensors, dyad


@dataclass(frozen=True, eq=False)
@checked(LawError)
class Combined:
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
    def _far(self) -> Array:
        """The limit C + βP of the derivative of G far from the convex set K, (D, D)."""
        return self.linear.matrix + self.yielding.beta * self.yielding.convex.projector

    @property
    def lipschitz(self) -> float:
        least, largest = np.linalg.eigvalsh(self.linear.matrix)[0], np.linalg.eigvalsh(self._far)[-1]
        return float(max(-least, largest))

    @property
    def monotonicity(self) -> float:
        return float(np.linalg.eigvalsh(self.linear.matrix)[0])

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

    @property
    def factor(self) -> Factor:
        return UNIFORM

    def __call__(self, strain: Tensors) -> Tensors:
        rest = self.prestress.reshape(-1, *[1] * (strain.ndim - 1))
        return rest + self.linear(strain) + self.yielding(strain)

    def derivative(self, strain: Tensors, direction: Tensors) -> Tensors:
        return self.linear(direction) + self.yielding.derivative(strain, direction)

    def at(self, x: Array) -> AtPoints:
        return self

    def scaled(self, factor: Array) -> AtPoints:
        return self

    def gradient(self, strain: Callable[[], Tensors], change: Array) -> Array:
        return self.linear(change) + self.yielding.gradient(strain, change)

    def normal_response(self, normal: Array) -> tuple[float, float, float, float]:
        """Return the response to a normal strain −Q n⊗n, as numbers (s, g, b, ρ).

        The normal stress is G(−Q n⊗n)_nn = s − g Q − b (Q − ρ)_+ for Q ≥ 0.
        """
        b, edge = self.yielding.normal_response(normal)
        return float(self.prestress @ dyad(normal, normal)), self.linear.normal_modulus(normal), b, edge
