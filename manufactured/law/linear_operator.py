"""Linear operators τ ↦ α(x) C τ: viscosity A, (3.1), and linear elasticity G, (2.7).

The matrix of ``NonSymmetric`` is not symmetric, so the operator is not the derivative of an energy.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from manufactured.arguments import Dimension, checked
from manufactured.factor import UNIFORM, Factor
from manufactured.law.operators import AtPoints, LawError
from manufactured.tensors import Array, Points, Tensors, dyad, identity, mapped, size

ROUNDED = 1e-14
"""Relative size up to which a modulus on a contact face counts as 0, because the axes of the face are rounded."""


@dataclass(frozen=True, eq=False)
class MatrixOperator:
    """An operator ε ↦ α C ε with a constant matrix C in Mandel form and a scalar factor α, 1 by default."""

    matrix: Array

    factor = UNIFORM

    def __post_init__(self) -> None:
        if self.matrix.shape not in ((3, 3), (6, 6)):
            raise LawError(f"a tensor needs a 3×3 (d=2) or 6×6 (d=3) Mandel matrix, got {self.matrix.shape}")

    @property
    def dim(self) -> int:
        return 2 if len(self.matrix) == 3 else 3

    @property
    def at_rest(self) -> Tensors:
        """The stress for the strain 0, which is 0, (D,)."""
        return np.zeros(len(self.matrix))

    def __call__(self, strain: Tensors) -> Tensors:
        """Return the stress C ε for a strain, if the tensor is homogeneous: (D, ...) → (D, ...).

        Raises:
            LawError: the tensor is heterogeneous and needs points: use ``at`` or ``scaled``.
        """
        if self.factor is not UNIFORM:
            raise LawError("a heterogeneous tensor needs points: use at(x) or scaled(factors)")
        return mapped(self.matrix, strain)

    def at(self, x: Points) -> AtPoints:
        if self.factor is UNIFORM:
            return Scaled(self.matrix)
        return Scaled(self.matrix, self.factor(x), self.factor.gradient(x))

    def scaled(self, factor: Array) -> AtPoints:
        return Scaled(self.matrix, factor)


@dataclass(frozen=True, eq=False)
@checked(LawError)
class Linear(MatrixOperator):
    """A linear elliptic operator τ ↦ α(x) C τ, used as viscosity A, (3.1), and as linear elasticity G, (2.7).

    Attributes:
        matrix: the constant tensor C in Mandel form, symmetric and positive definite, (D, D).
        factor: the scalar factor α > 0.

    Raises:
        LawError: C is not a 3 × 3 or 6 × 6 matrix, or is not finite, not symmetric or not elliptic.
    """

    factor: Factor = UNIFORM

    def __post_init__(self) -> None:
        self._require_symmetric()
        smallest = self.eigenvalues[0]
        if smallest <= 0:
            raise LawError(
                f"the tensor is not elliptic: its smallest eigenvalue is {smallest:.6g}, but (3.1) needs m_A > 0; for "
                "an isotropic tensor take 2μ > 0 and 2μ + dλ > 0. For an elasticity operator that softens use "
                "``Indefinite``. For a body without viscosity use static elasticity: ``static(body, G, f0, f2)``"
            )

    def _require_symmetric(self) -> None:
        super().__post_init__()
        if not np.allclose(self.matrix, self.matrix.T, rtol=1e-12, atol=0):
            raise LawError("the tensor is not symmetric, but (3.1) needs Aσ·τ = σ·Aτ; take (C + Cᵀ)/2")

    @cached_property
    def eigenvalues(self) -> Array:
        """The eigenvalues of C, increasing, (D,)."""
        return np.linalg.eigvalsh(self.matrix)

    @property
    def ellipticity(self) -> float:
        """The ellipticity constant: the smallest eigenvalue of α C on the body (m_A for a viscosity)."""
        return self.factor.low * float(self.eigenvalues[0])

    @property
    def lipschitz(self) -> float:
        """The Lipschitz constant: the largest eigenvalue of α C on the body (L_G for an elasticity)."""
        return self.factor.high * float(self.eigenvalues[-1])

    @property
    def monotonicity(self) -> float:
        return self.ellipticity

    @property
    def reference(self) -> Array:
        return self.matrix

    def normal_modulus(self, normal: Array) -> float:
        """Return the normal modulus C_nnnn = (n⊗n)·C(n⊗n) of the constant tensor for a unit vector n."""
        direction = dyad(normal, normal)
        return float(direction @ self.matrix @ direction)


def face_moduli(operator: MatrixOperator, frame: Array) -> Array:
    """Return the moduli d_a·C d_b of a linear operator, for the strains d_b that can occur on a contact face.

    d_1, …, d_d are n⊗n and (n⊗t_i + t_i⊗n)/2 for the normal n and the tangents t_i. The other d_b are
    (t_i⊗t_j + t_j⊗t_i)/2 for all pairs (i, j). They are caused by the derivative ∂_j of the slip in the direction t_i.

    Args:
        operator: the operator with the matrix C in Mandel form; its factor is left out.
        frame: the tangents t_i and then the normal n as columns, (d, d).

    Returns:
        The moduli for a ≤ d and all b, (d, d + (d−1)²), without round-off.
    """
    *tangents, n = frame.T
    on_normal = [dyad(n, n), *(dyad(n, tangent) for tangent in tangents)]
    strains = np.array([*on_normal, *(dyad(a, b) for a in tangents for b in tangents)])
    moduli = np.array(on_normal) @ operator.matrix @ strains.T
    return np.where(abs(moduli) <= ROUNDED * abs(moduli).max(), 0.0, moduli)


@dataclass(frozen=True, eq=False)
@checked(LawError)
class Indefinite(Linear):
    """A linear elasticity operator τ ↦ α(x) C τ with C symmetric but not positive, so that the material softens.

    Such an operator cannot be a viscosity. The paper requires in (2.7) that a linear G is symmetric and positive, but
    existence and error estimates need only (3.2), that G is Lipschitz.

    Raises:
        LawError: C is not a 3 × 3 or 6 × 6 matrix, or is not finite or not symmetric.
    """

    def __post_init__(self) -> None:
        self._require_symmetric()

    @property
    def ellipticity(self) -> float:
        """The monotonicity constant m: the smallest eigenvalue of α C on the body; it is negative if G softens."""
        least = float(self.eigenvalues[0])
        return least * (self.factor.low if least > 0 else self.factor.high)

    @property
    def lipschitz(self) -> float:
        """The Lipschitz constant L_G: the largest absolute eigenvalue of α C on the body."""
        return self.factor.high * float(abs(self.eigenvalues).max())


@dataclass(frozen=True, eq=False)
class Scaled:
    """A linear operator ε ↦ α C ε at fixed points of the body.

    Attributes:
        matrix: the constant tensor C, (D, D).
        factor: the values of α at the points, (...).
        slopes: the gradient ∂_j α at the points, (d, ...); None if α is constant.
    """

    matrix: Array
    factor: Array | float = 1.0
    slopes: Array | None = None

    def __call__(self, strain: Tensors) -> Tensors:
        product = mapped(self.matrix, strain)
        return product if isinstance(self.factor, float) else self.factor * product

    def derivative(self, strain: Tensors, direction: Tensors) -> Tensors:
        return self(direction)

    def gradient(self, strain: Callable[[], Tensors], change: Array) -> Array:
        found = self(change)
        if self.slopes is None:
            return found
        return found + self.slopes * mapped(self.matrix, strain())[:, None]


@checked(LawError)
def isotropic(mu: float, lam: float, dim: Dimension = 2, factor: Factor = UNIFORM) -> Linear:
    """Return the isotropic operator C τ = α(x) (2μ τ + λ (tr τ) I) with the Lamé constants μ and λ.

    >>> isotropic(1, 0.5).at(np.zeros((2, 1)))(np.array([[1.0], [0.0], [0.0]])).ravel().tolist()  # τ = e₁ ⊗ e₁
    [2.5, 0.5, 0.0]

    Raises:
        LawError: the operator is not elliptic, that is, 2μ ≤ 0 or 2μ + dλ ≤ 0.
    """
    return Linear(isotropic_matrix(mu, lam, dim), factor)


@checked(LawError)
def isotropic_matrix(mu: float, lam: float, dim: Dimension = 2) -> Array:
    """Return the matrix of τ ↦ 2μ τ + λ (tr τ) I in Mandel form, (D, D); the eigenvalues are 2μ and 2μ + dλ."""
    unit = identity(dim)
    return np.asarray(2 * mu * np.eye(size(dim)) + lam * np.multiply.outer(unit, unit))


@dataclass(frozen=True, eq=False)
@checked(LawError)
class NonSymmetric(MatrixOperator):
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
