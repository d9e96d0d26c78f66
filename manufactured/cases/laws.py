"""Material laws that several cases share, and constants of isotropic tensors.

Below, a = A_nnnn and g = G_nnnn are the moduli of viscosity and elasticity for the normal strain on a contact face.
"""

import numpy as np
from sympy import Expr, Rational

from manufactured.factor import UNIFORM, Factor, layers
from manufactured.law import (
    Combined,
    FrobeniusBall,
    Indefinite,
    KelvinVoigt,
    Linear,
    Yield,
    isotropic,
    isotropic_matrix,
)
from manufactured.symbols import t
from manufactured.tensors import Array, rotation


def proportional(ratio: float = 1.0) -> KelvinVoigt:
    """Return an isotropic law whose elasticity is proportional to its viscosity.

    A τ = 2τ + (tr τ)/2 I and G = ``ratio`` · A.

    Args:
        ratio: the ratio G/A.
    """
    name = "linear, A = G" if ratio == 1 else f"linear, G = {ratio:g} A"
    return KelvinVoigt(isotropic(1, 0.5), isotropic(ratio, ratio / 2), name)


def not_proportional(dim: int = 2, viscous: Factor = UNIFORM, elastic: Factor = UNIFORM) -> KelvinVoigt:
    """Return an isotropic law whose viscosity and elasticity are not proportional.

    A τ = α (2τ + (tr τ)/2 I) and G τ = γ (4τ + 3 (tr τ) I); for α = γ = 1 the normal moduli are a = 5/2 and g = 7. A
    and G differ in size and in the ratio of shear to compression. A program that confuses A and G therefore gives wrong
    results for this law.

    Args:
        dim: 2 or 3.
        viscous, elastic: α and γ, scalar functions of the point.
    """
    name = "linear, A and G not proportional"
    return KelvinVoigt(
        isotropic(1, 0.5, dim, viscous),
        isotropic(2, 3, dim, elastic),
        name if viscous is UNIFORM and elastic is UNIFORM else f"{name}, heterogeneous",
    )


def two_layers(interface: float, ratio: float) -> KelvinVoigt:
    """Return the law of a body of two layers: ``not_proportional()`` times ``ratio`` where x_2 > ``interface``."""
    factor = layers((0.0, 1.0), interface, ratio)
    return not_proportional(2, factor, factor)


def softening_in_volume() -> KelvinVoigt:
    """Return a law whose elasticity G is positive in shear and negative in volume, so that the material softens.

    A τ = 2τ + (tr τ)/2 I and G τ = τ − (3/2)(tr τ) I; the normal moduli are a = 5/2 and g = −1/2.
    """
    return KelvinVoigt(isotropic(1, 0.5), Indefinite(isotropic_matrix(0.5, -1.5)), "linear, G softens in volume")


def softening_then_hardening() -> KelvinVoigt:
    """Return a prestressed law whose elasticity G softens inside K = {|τ| ≤ 2} and hardens outside.

    A τ = 2τ + (tr τ)/2 I with the normal modulus a = 5/2, and G ε = S − ε + 4 (ε − P_K ε) with S = e_1 ⊗ e_1.
    """
    softens = Indefinite(isotropic_matrix(-0.5, 0))
    G = Combined(np.array([1.0, 0.0, 0.0]), softens, Yield(4.0, FrobeniusBall(2.0)))
    return KelvinVoigt(isotropic(1, 0.5), G, "G softens, then hardens, with a stress at rest")


def lame(tensor: Linear) -> tuple[float, float]:
    """Return the Lamé constants (μ, λ) of an isotropic tensor."""
    return float(tensor.matrix[-1, -1]) / 2, float(tensor.matrix[0, 1])


def kolosov_constant(tensor: Linear) -> float:
    """Return Kolosov's constant κ = (λ + 3μ)/(λ + μ) of an isotropic tensor in the plane."""
    mu, lam = lame(tensor)
    return (lam + 3 * mu) / (lam + mu)


def shearing(law: KelvinVoigt, theta: Expr) -> Expr:
    """Return the factor 2μ_A θ̇ + 2μ_G θ, by which an elastic stress is multiplied to give the viscoelastic stress.

    A and G must be isotropic with the same Kolosov constant κ. If U is the displacement with the potentials Φ and Ψ
    (``singular.kolosov``), then the stress of θ(t) U is this factor times the stress that Φ and Ψ give.
    """
    assert isinstance(law.G, Linear)
    mu_A, mu_G = (Rational(lame(tensor)[0]) for tensor in (law.A, law.G))
    return 2 * mu_A * theta.diff(t) + 2 * mu_G * theta


def anisotropic() -> KelvinVoigt:
    """Return a law with orthotropic viscosity A and elasticity G that couples normal and shear strains on a face.

    The strains are coupled because the axes of A and G differ from each other and from the directions of the faces of
    the unit square.
    """
    A = _turned([[4.0, 0.5, 0.0], [0.5, 2.0, 0.0], [0.0, 0.0, 1.5]], 0.5)
    G = _turned([[3.0, 1.0, 0.0], [1.0, 6.0, 0.0], [0.0, 0.0, 2.0]], -0.3)
    return KelvinVoigt(Linear(A), Linear(G), "linear, A and G anisotropic")


def _turned(matrix: list[list[float]], angle: float) -> Array:
    """Return a tensor in Mandel form after a rotation of its axes."""
    turn = rotation(np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]))
    C = turn @ np.array(matrix) @ turn.T
    return (C + C.T) / 2


def without_contraction(dim: int = 2) -> KelvinVoigt:
    """Return a law that does not couple normal strains in different directions; A and G are orthotropic along the axes.

    The displacement of one contact face then does not change the pressure on a face at right angles, so two faces under
    pressure may meet at a corner.
    """
    shear = dim * (dim - 1) // 2
    A = np.diag([2.0, 3.0, 2.5][:dim] + [1.5, 2.0, 1.8][:shear])
    G = np.diag([5.0, 4.0, 6.0][:dim] + [3.0, 2.5, 4.0][:shear])
    return KelvinVoigt(Linear(A), Linear(G), "linear, orthotropic without contraction")
