"""The Kelvin–Voigt law σ = A ε(u̇) + G ε(u), equation (2.1), with a viscosity A and an elasticity operator G.

A is a linear tensor that satisfies (3.1). G satisfies (3.2) and is one of the following:

* linear (``Linear``);
* the law (3.3), G(ε) = β (ε − P_K ε), with the projection P_K onto a closed convex set K of S^d with 0 ∈ K (``Yield``);
* the sum of a stress at rest, a linear operator and (3.3) (``Combined``);
* linear and not positive (``Indefinite``);
* linear and not symmetric, so without a potential (``NonSymmetric``).

A linear operator may vary in space through a scalar factor, C(x) = α(x) C. Tensors are Mandel vectors, (D, ...).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol, Self

import numpy as np

from manufactured.arguments import Dimension, Size, checked
from manufactured.factor import UNIFORM, Factor
from manufactured.tensors import Array, Hyperplane, Points, Tensors, dyad, identity, mapped, size

# Interfaces of constitutive operators: elasticity operators that satisfy (3.2), and operators at fixed points.


class LawError(ValueError):
    """Raised if a constitutive law violates (3.1) or (3.2), or cannot be used as required."""


class AtPoints(Protocol):
    """The interface of a constitutive operator at fixed points of the body, from strains to stresses.

    The operator is a tensor ε ↦ C(x) ε or an elasticity ε ↦ G(x, ε). Strains and stresses are Mandel vectors at the
    points, (D, ...).
    """

    def __call__(self, strain: Tensors) -> Tensors:
        """Return the stress C(x) ε or G(x, ε) at the points: (D, ...) → (D, ...)."""
        ...

    def derivative(self, strain: Tensors, direction: Tensors) -> Tensors:
        """Return the derivative of the stress with respect to the strain in a direction.

        It is used only where the derivative exists.

        Args:
            strain: the strain at which the derivative is taken, (D, ...).
            direction: the direction, a strain, (D, ...).
        """
        ...

    def gradient(self, strain: Callable[[], Tensors], change: Array) -> Array:
        """Return the derivatives ∂_j in space of the stress that a strain field ε(x) causes, (D, d, ...).

        Args:
            strain: a function that returns ε, (D, ...); it is called only if ε is needed.
            change: the derivatives ∂_j ε of the strain at the points, (D, d, ...).
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
        """Return the operator at points where its material factor has given values.

        Args:
            factor: the values of the factor, (...), for example the means of ``self.factor`` over cells. They replace
                the values of ``self.factor``.
        """
        ...


class Homogeneous:
    """Mixin for elasticity operators that are the same at all points of the body, with the material factor 1."""

    factor = UNIFORM

    def at(self, x: Points) -> Self:
        return self

    def scaled(self, factor: Array) -> Self:
        return self


# Linear operators τ ↦ α(x) C τ: viscosity A, (3.1), and linear elasticity G, (2.7).
#
# The matrix of ``NonSymmetric`` is not symmetric, so the operator is not the derivative of an energy.

MODULUS_ROUNDING = 1e-14
"""Relative size up to which a modulus on a contact face counts as 0, because the axes of the face are rounded."""


@dataclass(frozen=True, eq=False)
class MatrixOperator:
    """An operator ε ↦ α(x) C ε from strains to stresses.

    Attributes:
        matrix: the constant matrix C in Mandel form, (D, D).
        factor: the scalar material factor α(x), 1 by default.
    """

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
        """The stress of the operator ε ↦ α C ε for the strain 0, which is 0, (D,)."""
        return np.zeros(len(self.matrix))

    def __call__(self, strain: Tensors) -> Tensors:
        """Return the stress C ε for a strain, if the tensor is homogeneous: (D, ...) → (D, ...).

        Raises:
            LawError: the tensor is heterogeneous and needs points: use ``at`` or ``scaled``.
        """
        if self.factor is not UNIFORM:
            raise LawError("a heterogeneous tensor needs points: use at(x) or scaled(factors)")
        return mapped(self.matrix, strain)

    @cached_property
    def reference(self) -> Array:
        """The constant symmetric matrix that a solver uses instead of C: the symmetric part (C + Cᵀ)/2, (D, D)."""
        return (self.matrix + self.matrix.T) / 2

    @cached_property
    def eigenvalues(self) -> Array:
        """The eigenvalues of the symmetric part of the matrix C, without the factor α, increasing, (D,)."""
        return np.linalg.eigvalsh(self.reference)

    @property
    def monotonicity(self) -> float:
        """The monotonicity constant m of the operator G: ε ↦ α(x) C ε, with (G(a) − G(b))·(a − b) ≥ m |a − b|².

        It is the smallest eigenvalue of the symmetric part of C times a bound of the factor α on the body: the lower
        bound if the eigenvalue is positive, otherwise the upper bound. It is negative if the material softens.
        """
        least = float(self.eigenvalues[0])
        return least * (self.factor.low if least > 0 else self.factor.high)

    @property
    def lipschitz(self) -> float:
        """The Lipschitz constant of the operator ε ↦ α(x) C ε for a symmetric matrix C.

        It is the largest absolute eigenvalue of C times the upper bound of the factor α on the body.
        """
        return self.factor.high * float(abs(self.eigenvalues).max())

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

    @property
    def ellipticity(self) -> float:
        """The ellipticity constant of τ ↦ α(x) C τ, called m_A for a viscosity: the smallest eigenvalue on the body."""
        return self.monotonicity

    def normal_modulus(self, normal: Array) -> float:
        """Return the normal modulus C_nnnn = (n⊗n)·C(n⊗n) of the constant tensor C for a unit vector n.

        Args:
            normal: the vector n, (d,).
        """
        direction = dyad(normal, normal)
        return float(direction @ self.matrix @ direction)


def face_moduli(operator: MatrixOperator, frame: Array) -> Array:
    """Return the moduli d_a·C d_b of a linear operator C, for basis strains d_a and d_b on a contact face.

    They give the traction on the face that each possible strain causes. d_1, …, d_d are n⊗n and (n⊗t_i + t_i⊗n)/2 for
    the normal n and the tangents t_i. The other d_b are (t_i⊗t_j + t_j⊗t_i)/2, one for each derivative along t_j of the
    component along t_i of a slip, in 3D in the order (i, j) = (1, 1), (1, 2), (2, 1), (2, 2). So the second and the
    third of them are equal.

    Args:
        operator: the operator α(x) C with the matrix C in Mandel form. The moduli of C alone are returned, without the
            material factor α.
        frame: the tangents t_i and then the normal n as columns, (d, d).

    Returns:
        The moduli for a ≤ d and all b, (d, d + (d−1)²). Moduli of at most ``MODULUS_ROUNDING`` times the largest one,
        which are round-off, are replaced by 0.
    """
    *tangents, n = frame.T
    on_normal = [dyad(n, n), *(dyad(n, tangent) for tangent in tangents)]
    strains = np.array([*on_normal, *(dyad(a, b) for a in tangents for b in tangents)])
    moduli = np.array(on_normal) @ operator.matrix @ strains.T
    return np.where(abs(moduli) <= MODULUS_ROUNDING * abs(moduli).max(), 0.0, moduli)


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


@dataclass(frozen=True, eq=False)
class Scaled:
    """A linear operator ε ↦ α C ε at fixed points of the body, with the values of its material factor α there.

    Attributes:
        matrix: the constant tensor C in Mandel form, (D, D).
        factor: the values of α at the points, (...), or one number for all points.
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

    Args:
        mu, lam: the Lamé constants μ and λ.
        dim: the dimension d of the body, 2 or 3.
        factor: the material factor α(x), by default 1.

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


# Nonlinear elasticity operators: (3.3) and its sum with a linear operator and a stress at rest.
#
# (3.3) is G(ε) = β (ε − P_K ε), with the projection P_K onto a closed convex set. The sum G(ε) = S + C ε + β (ε − P_K
# ε) may be neither monotone nor zero at rest.


class ConvexSet(Protocol):
    """The interface of closed convex sets K = {τ : |Pτ| ≤ r} of symmetric tensors, with an orthogonal projector P.

    Attributes:
        dim: the dimension d of the tensors.
        radius: the number r.
        projector: the matrix of P in Mandel form, (D, D).
    """

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

    G is 0 inside K. Its Lipschitz constant is L_G = β, and it is monotone, but not strongly: m = 0. For K = {τ : |Pτ| ≤
    r} with an orthogonal projector P it is G(ε) = β (1 − r/|Pε|)_+ Pε.

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

        P is the projector of the convex set K = {τ : |Pτ| ≤ r}. G minus this matrix has the Lipschitz constant β/2,
        which is the least for any constant matrix.
        """
        return 0.5 * self.beta * self.convex.projector

    @property
    def at_rest(self) -> Tensors:
        """The stress G(0), which is 0 because the convex set K contains 0, (D,)."""
        return np.zeros(size(self.dim))

    def __call__(self, strain: Tensors) -> Tensors:
        part = mapped(self.convex.projector, strain)
        radius = self.convex.radius
        return self.beta * (1 - radius / np.maximum(_norm(part), radius)) * part

    def derivative(self, strain: Tensors, direction: Tensors) -> Tensors:
        part, change = (mapped(self.convex.projector, tensor) for tensor in (strain, direction))
        radius = self.convex.radius
        norm = np.maximum(_norm(part), radius)
        radial = radius * np.sum(part * change, axis=0) / norm**3
        return self.beta * np.where(norm > radius, (1 - radius / norm) * change + radial * part, 0.0)

    def gradient(self, strain: Callable[[], Tensors], change: Array) -> Array:
        at = strain()
        return np.stack([self.derivative(at, each) for each in np.moveaxis(change, 1, 0)], axis=1)

    def normal_response(self, normal: Array) -> tuple[float, float]:
        """Return two numbers (b, ρ) that describe the normal stress caused by a normal strain −Q n⊗n.

        The normal stress is G(−Q n⊗n)_nn = −b (Q − ρ)_+ for Q ≥ 0. For K = {τ : |Pτ| ≤ r} the numbers are b = β
        |P(n⊗n)|² and ρ = r/|P(n⊗n)|, the value of Q at which the strain leaves K.

        Args:
            normal: the unit vector n, (d,).
        """
        length = float(np.linalg.norm(self.convex.projector @ dyad(normal, normal)))
        return self.beta * length**2, self.convex.radius / length


@dataclass(frozen=True, eq=False)
@checked(LawError)
class Combined(Homogeneous):
    """The elasticity operator G(ε) = S + C ε + β (ε − P_K ε): a stress at rest, a linear operator and (3.3).

    P_K is the projection onto the convex set K. For K = {τ : |Pτ| ≤ r} with a projector P, the derivative of G is C
    inside K, tends to C + βP far from K, and always lies between the two. So the constant of monotonicity m is the
    smallest eigenvalue of C, and the Lipschitz constant L_G is the largest absolute eigenvalue of C and of C + βP. If C
    is not positive, G softens inside K and hardens outside if β is large enough.

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

        P is the projector of the convex set K = {τ : |Pτ| ≤ r}. G minus this matrix has the Lipschitz constant β/2.
        """
        return self.linear.matrix + self.yielding.reference

    @property
    def at_rest(self) -> Tensors:
        """The stress at rest S = G(0), (D,)."""
        return self.prestress

    def __call__(self, strain: Tensors) -> Tensors:
        return ((self.linear(strain) + self.yielding(strain)).T + self.prestress).T

    def derivative(self, strain: Tensors, direction: Tensors) -> Tensors:
        return self.linear(direction) + self.yielding.derivative(strain, direction)

    def gradient(self, strain: Callable[[], Tensors], change: Array) -> Array:
        return self.linear(change) + self.yielding.gradient(strain, change)

    def normal_response(self, normal: Array) -> tuple[float, float, float, float]:
        """Return four numbers (s, g, b, ρ) that describe the normal stress caused by a normal strain −Q n⊗n.

        The normal stress is G(−Q n⊗n)_nn = s − g Q − b (Q − ρ)_+ for Q ≥ 0. Here s is the normal stress at rest, g the
        normal modulus of the linear operator C, and b and ρ are the results of ``Yield.normal_response``.

        Args:
            normal: the unit vector n, (d,).
        """
        b, edge = self.yielding.normal_response(normal)
        return float(self.prestress @ dyad(normal, normal)), self.linear.normal_modulus(normal), b, edge


def _norm(tensors: Tensors) -> Array:
    # The square root is written out, because derivatives by the complex step need an analytic function, and
    # np.linalg.norm is none.
    return np.sqrt(np.sum(tensors * tensors, axis=0))


# The Kelvin–Voigt law (2.1), and the law at fixed points of a heterogeneous body.


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
        """The constant κ = L_G/m_A, Lipschitz constant of the elasticity over ellipticity constant of the viscosity.

        It bounds the rate at which two solutions can move apart. For every G, κ is a Lipschitz constant of the operator
        B in (4.3) and an admissible ω in (4.5).
        """
        return self.G.lipschitz / self.A.ellipticity

    @property
    def growth(self) -> float:
        """The largest rate at which differences of solutions may grow in time.

        It is max(−m, 0)/m_A with the monotonicity constant m of the elasticity G and the ellipticity constant m_A of
        the viscosity A. It is at most ``kappa``, and 0 if G is monotone.
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

        The law must be the same at all points; otherwise use ``at`` or ``scaled``.
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
        """Return the law at points where the material factors of A and of G have given values.

        Args:
            viscous, elastic: the values of the factors of A and of G, (...) each, for example their means over cells.
        """
        return PointLaw(self.A.scaled(viscous), self.G.scaled(elastic))


@dataclass(frozen=True)
class PointLaw:
    """A Kelvin–Voigt law at fixed points, with the values of its material factors there."""

    A: AtPoints
    G: AtPoints

    def stress(self, strain_rate: Tensors, strain: Tensors) -> Tensors:
        """Return the stress A ε̇ + G(ε) at the points: (D, ...), (D, ...) → (D, ...)."""
        return self.A(strain_rate) + self.G(strain)
