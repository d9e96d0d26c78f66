"""Exact solutions with contact: the displacement in the body is made from gap, pressure and slip on a contact face.

This construction is called lifting. Near a flat part of the contact boundary Γ3 let s be coordinates along the face, y
the distance from it into the body, and n = −ν. Given are an initial gap g(s) ≥ 0, the remaining gap
w(s, t) = g − u_ν ≥ 0, a pressure p(s, t) = −σ_ν ≥ 0 with w p = 0, and a slip z(s, t) = u_τ, which is 0 by default.
Let q = ε_nn and r = 2ε_sn be the strain on the face that p and z produce (``manufactured.face_strain``). The
displacement is

    u_s = z φ(y/ℓ) − y ∇_s (w − g) φ(y/ℓ) + y r φ(y/ℓ),     u_n = (w − g + y q) φ(y/ℓ),

with a depth ℓ and a polynomial φ on [0, 1] that satisfies φ(0) = 1, φ'(0) = 0 and φ(1) = 0; φ = 0 beyond 1. Other
functions of y with the same values and slopes at y = 0 may be used (``manufactured.profile``).

On the face y = 0, u_n = w − g, u_s = z, ε_ss = sym ∇_s z, ε_nn = q, and 2ε_sn = −∇_s (w − g) + r + ∇_s (w − g) = r.
By the choice of (q, r), σ_τ = 0 and σ_ν = −p. So the contact conditions hold exactly, for every contact zone. The
displacement vanishes for y ≥ ℓ, so (2.3) holds if Γ1 has at least this distance from the face.

Without slip, u also solves the problem of a perfectly rough foundation, to which the body is glued where it touches. So
only a case that slips while it is in contact shows whether a method has friction.

In the paper g = 0, and the contact conditions are (2.5). For g ≠ 0, which the paper does not treat, they are u_ν ≤ g,
σ_ν ≤ 0, σ_ν (u_ν − g) = 0 and σ_τ = 0.
"""

from manufactured.contact.contact_face import ContactFace
from manufactured.contact.stated_face import StatedFace

__all__ = ["ContactFace", "StatedFace"]
