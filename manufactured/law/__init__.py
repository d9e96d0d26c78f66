"""The Kelvin–Voigt law σ = A ε(u̇) + G ε(u), equation (2.1), and its two ingredients.

A is a viscosity tensor with (3.1), G an elasticity operator with (3.2): linear, the law (3.3)
G(ε) = β (ε − P_K ε) with a closed convex set K ∋ 0 of S^d, or the sum of a stress at rest, a linear operator and
(3.3). G need not be monotone (``Indefinite``, ``Combined``) or have a potential (``NonSymmetric``). A linear operator
may vary in space through a scalar factor, C(x) = α(x) C. Tensors are Mandel vectors (D, ...).
"""

from manufactured.law.combined import Combined
from manufactured.law.kelvin_voigt import KelvinVoigt, PointLaw
from manufactured.law.linear_operator import Indefinite, Linear, Scaled, isotropic, isotropic_matrix
from manufactured.law.nonsymmetric import NonSymmetric
from manufactured.law.operators import AtPoints, Elasticity, LawError
from manufactured.law.projection import ConvexSet, DeviatoricBall, FrobeniusBall, Yield

__all__ = [
    "AtPoints",
    "Combined",
    "ConvexSet",
    "DeviatoricBall",
    "Elasticity",
    "FrobeniusBall",
    "Indefinite",
    "KelvinVoigt",
    "LawError",
    "Linear",
    "NonSymmetric",
    "PointLaw",
    "Scaled",
    "Yield",
    "isotropic",
    "isotropic_matrix",
]
