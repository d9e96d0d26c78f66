"""Exact contact by lifting Cauchy data: gap + pressure on a face → displacement in the body.

Near a flat piece of Γ3 use s along the face, y = distance into the body, n = −ν. Given an initial gap
g(s) ≥ 0, a gap w(s, t) ≥ 0 (= g − u_ν, what is left of it) and a pressure p(s, t) ≥ 0 (= −σ_ν) with
w p = 0, let (q, r) be the strain on the face that p produces (``manufactured.face_strain``) and

    u_s = −y ∇_s (w − g) φ(y/ℓ) + y r φ(y/ℓ),     u_n = (w − g + y q) φ(y/ℓ),

with a polynomial φ on [0, 1], zero beyond, φ(0) = 1, φ'(0) = 0, φ(1) = 0, or other functions of y
with the same values and slopes at y = 0 (``manufactured.profile``).

On y = 0: u_n = w − g, u_s = 0, ε_ss = 0, 2ε_sn = −∇_s (w − g) + r + ∇_s (w − g) = r, ε_nn = q, so σ_τ = 0
and σ_ν = −p: the contact conditions hold exactly, whatever the zone. The solution vanishes from depth ℓ on, so
(2.3) holds on a Γ1 at that depth.

The paper has g = 0, where the conditions are (2.5). Beyond the paper, for g ≠ 0, they are u_ν ≤ g, σ_ν ≤ 0,
σ_ν (u_ν − g) = 0 and σ_τ = 0.
"""

from manufactured.contact.contact_face import ContactFace

__all__ = ["ContactFace"]
