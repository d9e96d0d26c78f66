"""A linear elasticity operator whose matrix is not symmetric, so the operator is not the derivative of an energy."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from manufactured.arguments import checked
from manufactured.factor import UNIFORM, Factor
from manufactured.law.linear_operator import Scaled, require_mandel
from manufactured.law.operators import AtPoints, LawError
from manufactured.tensors import Array, Points, Tensors, mapped


@dataclass(frozen=True, eq=False)
@checked(LawError)
class NonSymmetric:
    """The elasticity operator ε ↦ C ε for any matrix C in Mandel form, (D, D); C need not be symmetric or positive.

    (3.2) requires only that G is Lipschitz, which every C satisfies. If C is not symmetric, G has no potential, so that
    proofs and solvers that minimise an energy do not apply.

    >>> import numpy as np
    >>> G = NonSymmetric(np.array([[1.0, 2.0, 0.0], [-2.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
    >>> G.monotonicity, round(G.lipschitz, 6)  # 1 and √5
    (1.0, 2.236068)

    Raises:
        LawError: C is not a 3 × 3 or 6 × 6 matrix, or is not finite.
    """

    matrix: Array

    def __post_init__(self) -> None:
        require_mandel(self.matrix)

    @property
    def dim(self) -> int:
        return 2 if len(self.matrix) == 3 else 3

    @cached_property
    def lipschitz(self) -> float:
        """The Lipschitz constant L_G: the largest singular value of C."""
        return float(np.linalg.norm(self.matrix, 2))

    @cached_property
    def monotonicity(self) -> float:
        """The monotonicity constant m: the smallest eigenvalue of the symmetric part of C."""
        return float(np.linalg.eigvalsh(self.reference)[0])

    @cached_property
    def reference(self) -> Array:
        """The constant symmetric matrix that a solver uses instead of G: the symmetric part (C + Cᵀ)/2, (D, D)."""
        return (self.matrix + self.matrix.T) / 2

    @property
    def at_rest(self) -> Tensors:
        """The stress for the strain 0, which is 0, (D,)."""
        return np.zeros(len(self.matrix))

    @property
    def factor(self) -> Factor:
        return UNIFORM

    def __call__(self, strain: Tensors) -> Tensors:
        return mapped(self.matrix, strain)

    def at(self, x: Points) -> AtPoints:
        return Scaled(self.matrix)

    def scaled(self, factor: Array) -> AtPoints:
        return Scaled(self.matrix, factor)
