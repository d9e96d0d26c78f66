"""Singular displacement fields at a corner, a junction of boundary conditions, or a natural contact front.

Every singular field of plane elasticity at such a point is a sum of terms y^m Re(c z^β) with m ∈ {0, 1}, where
z = x + iy in axes at the point. With Kolosov's potentials Φ = a z^λ and Ψ = b z^λ the displacement is given by

    2μ (u_x + i u_y) = κ Φ − z conj(Φ') − conj(Ψ),      z conj(z^{λ−1}) = conj(z^λ) + 2iy conj(z^{λ−1}),

where κ = (λ_L + 3μ)/(λ_L + μ) with the Lamé constants λ_L, μ in the plane.

Sources: M. L. Williams, Stress singularities resulting from various boundary conditions in angular corners of plates in
extension, J. Appl. Mech. 19 (1952) 526–528; N. I. Muskhelishvili, Some Basic Problems of the Mathematical Theory of
Elasticity, Noordhoff 1953, for the potentials.
"""

from manufactured.singular.singular_field import Monomial, SingularField, kolosov
from manufactured.singular.travelling_field import SingularFace, TravellingField

__all__ = ["Monomial", "SingularFace", "SingularField", "TravellingField", "kolosov"]
