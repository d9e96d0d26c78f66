"""The normal strain q = ε_nn and the shear strain r = 2ε_sn on a contact face, for a given pressure p(s, t) = −σ_ν.

**Linear law** (``Memory``). If A and G do not couple the components nn and sn, only ε_nn is not zero on the face. Then
σ_ν = a q̇ + g q with a = A_nnnn, g = G_nnnn, and

    a q̇ + g q = −p,   q(s, 0) = q_0(s)
    q(s, t) = e^{−λt} q_0(s) − ∫_0^t e^{−λ(t−r)} p(s, r)/a dr,   λ = g/a.

In a heterogeneous body a and g are formulas of s with a constant ratio λ. After contact p = 0, and q decays like
e^{−λt}. The pressure is prescribed, not the strain, because a prescribed strain would give a tension, σ_ν > 0, where a
front recedes.

**Slip.** If the face also slips along itself by z(s, t), then ε_ss = ∂_s z, and the law needs the additional stress
l = A_nnss ∂_s ż + G_nnss ∂_s z: q is the solution of a q̇ + g q = −p − l. In 3D, ε_ss is the symmetric part of the 2 × 2
matrix ∇_s z, and A_nnss and G_nnss act on it.

**Coupled linear law** (``Coupled``). If A or G couples nn with sn, a shear r is needed for σ_τ = 0. With y = (q, r) and
the matrices 𝒜 and 𝒢 of moduli, 𝒜 ẏ + 𝒢 y = −(p, 0) − l, where l has one component of slip
stress for each of them. In the basis of eigenvectors these are d scalar equations.

**Law (3.3)** (``Prescribed``). The strain is prescribed for one interval of time after another, and the pressure
follows from the law. With slip, the law is evaluated at the full strain q n⊗n + ε_ss. Since ε_sn = 0, and since A is
isotropic and (3.3) with K = {|Pτ| ≤ r} gives a multiple of Pε, σ_τ = 0 for every slip. p ≥ 0 and p = 0 off the contact
zone are conditions on q and z: (3.3) has no effect while |Pε| ≤ r, and there a q̇ + A_nnss ∂_s ż = −p as for a linear
law. Slips with ∂_s z = 0, which move the face as a whole, change neither ε nor p.
"""

from manufactured.face_strain.hereditary import Coupled, Memory
from manufactured.face_strain.strain_on_face import (
    Components,
    FaceStrain,
    Prescribed,
    StrainAtPoints,
    relaxation_rate,
)

__all__ = ["Components", "Coupled", "FaceStrain", "Memory", "Prescribed", "StrainAtPoints", "relaxation_rate"]
