"""The Kelvin–Voigt law σ = A ε(u̇) + G ε(u), equation (2.1), with a viscosity A and an elasticity operator G.

A is a linear tensor that satisfies (3.1). G satisfies (3.2) and is one of the following:

* linear (``Linear``);
* the law (3.3), G(ε) = β (ε − P_K ε), with the projection P_K onto a closed convex set K of S^d with 0 ∈ K (``Yield``);
* the sum of a stress at rest, a linear operator and (3.3) (``Combined``);
* linear and not positive (``Indefinite``);
* linear and not symmetric, so without a potential (``NonSymmetric``).

A linear operator may vary in space through a scalar factor, C(x) = α(x) C. Tensors are Mandel vectors, (D, ...).
"""

from manufactured.law.kelvin_voigt import KelvinVoigt, PointLaw
from manufactured.law.linear_operator import Indefinite, Linear, NonSymmetric, Scaled, isotropic, isotropic_matrix
from manufactured.law.nonlinear import Combined, ConvexSet, DeviatoricBall, FrobeniusBall, Yield
from manufactured.law.operators import AtPoints, Elasticity, LawError

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
