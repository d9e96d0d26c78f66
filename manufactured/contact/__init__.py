"""Exact contact by lifting: makes a displacement in the body from the gap and the pressure on a face.

Near a flat piece of Γ3 let s be coordinates along the face, y the distance from it into the body, and n = −ν. Given are
an initial gap g(s) ≥ 0, the remaining gap w(s, t) = g − u_ν ≥ 0 and a pressure p(s, t) = −σ_ν ≥ 0 with w p = 0. Let
(q, r) be the strain on the face that p produces (``manufactured.face_strain``). The displacement is

    u_s = −y ∇_s (w − g) φ(y/ℓ) + y r φ(y/ℓ),     u_n = (w − g + y q) φ(y/ℓ),

with a polynomial φ on [0, 1], which is zero beyond 1, and φ(0) = 1, φ'(0) = 0, φ(1) = 0. Other functions of y with the
same values and slopes at y = 0 may replace it (``manufactured.profile``).

On y = 0: u_n = w − g, u_s = 0, ε_ss = 0, 2ε_sn = −∇_s (w − g) + r + ∇_s (w − g) = r, ε_nn = q, so σ_τ = 0
and σ_ν = −p. So the contact conditions hold exactly for every contact zone. The displacement vanishes for y ≥ ℓ, so
(2.3) holds if Γ1 is at the depth ℓ.

In the paper g = 0, and the contact conditions are (2.5). For g ≠ 0, which the paper does not treat, they are u_ν ≤ g,
σ_ν ≤ 0, σ_ν (u_ν − g) = 0 and σ_τ = 0.
"""

from manufactured.contact.contact_face import ContactFace

__all__ = ["ContactFace"]
