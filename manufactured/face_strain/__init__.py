"""The strain (q, r) on a contact face, q = ε_nn and r = 2ε_sn, from the pressure p(s, t) = −σ_ν.

Linear law: where it does not couple nn with sn, only ε_nn is not zero on the face, so
σ_ν = a q̇ + g q with a = A_nnnn, g = G_nnnn, and

    a q̇ + g q = −p,   q(s, 0) = q_0(s)
    q(s, t) = e^{−λt} q_0(s) − ∫_0^t e^{−λ(t−r)} p(s, r)/a dr,   λ = g/a.

In a heterogeneous body a and g are formulas of s with a constant ratio λ. A law that couples nn
with sn needs a shear r that keeps σ_τ = 0: with y = (q, r) and the blocks of moduli 𝒜, 𝒢,
𝒜 ẏ + 𝒢 y = (−p, 0). In the basis of its modes, this system splits into d scalar equations.

The pressure must be chosen first: a strain prescribed under a receding front would pull (σ_ν > 0).
After release p = 0 and q decays like e^{−λt}: the material remembers the contact.

Law (3.3): the strain is prescribed phase by phase and the pressure follows from the law.
"""

from manufactured.face_strain.coupled import Coupled
from manufactured.face_strain.hereditary import Memory
from manufactured.face_strain.prescribed import Prescribed
from manufactured.face_strain.strain_on_face import Components, FaceStrain, StrainAtPoints, relaxation_rate

__all__ = ["Components", "Coupled", "FaceStrain", "Memory", "Prescribed", "StrainAtPoints", "relaxation_rate"]
