"""Singular fields at a point of the boundary: corners, junctions of conditions, and the natural contact front.

With z = x + iy in axes at the point, a term is y^m Re(c z^β), m ∈ {0, 1}; every eigenfunction of plane
elasticity at a corner is a sum of such terms. In Kolosov's form, with Φ = a z^λ and Ψ = b z^λ,

    2μ (u_x + i u_y) = κ Φ − z conj(Φ') − conj(Ψ),      z conj(z^{λ−1}) = conj(z^λ) + 2iy conj(z^{λ−1}),

κ = (λ_L + 3μ)/(λ_L + μ) with Lamé's constants λ_L, μ in the plane.

Sources: M. L. Williams, Stress singularities resulting from various boundary conditions in angular
corners of plates in extension, J. Appl. Mech. 19 (1952) 526–528; N. I. Muskhelishvili, Some Basic
Problems of the Mathematical Theory of Elasticity, Noordhoff 1953, for the potentials.
"""

from manufactured.singular.monomials import Monomial, kolosov
from manufactured.singular.singular_face import SingularFace
from manufactured.singular.singular_field import SingularField, least_exponent
from manufactured.singular.travelling_field import TravellingField

__all__ = ["Monomial", "SingularFace", "SingularField", "TravellingField", "kolosov", "least_exponent"]
