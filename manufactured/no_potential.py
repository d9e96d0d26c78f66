"""A front that advances and recedes on a material whose elasticity has no potential and is not monotone.

The gap w, the contact pressure p, the slip z, the front c and the normal strain q at t = 0 are those of
``cases.softening``,

    w = 20 (1 + t) (x − c)_+^5,   p = 20 (c − x)_+³,   z = 4t sin(3x + 1/2),   c(t) = 7/24 + 15t(1 − t)/8,   q(0) = 0

on the bottom of the unit square. The viscosity is A τ = 2τ + (tr τ)/2 I, and the elasticity is G τ = τ − (3/2)(tr τ)
I + W τ with the skew part

    (W τ)_11 = 3√2 τ_12,   (W τ)_12 = −(3/√2) τ_11,   (W τ)_22 = 0.

W τ·τ = 0, so G has the same constant of monotonicity m = −2 as in ``softening``, and differences of solutions may grow
at the rate γ = 2/m_A = 1; κ = L_G/m_A = 2.03. G is not the derivative of a stored energy, because its matrix is not
symmetric. W maps ε_22 to 0, so the normal strain on Γ3 is the same as in ``softening``. It maps ε_11 = ∂_s z to a
shear stress, for which a shear strain on Γ3 makes up.

Predicted order 1: (5.36) holds as for ``softening``, and Prop. 5.4 requires only that G is Lipschitz.

The case is not in the catalogue, because some computations for cases of the catalogue need a symmetric G: Problem 3.2
on the strains of V^h, the energy balance, and the error bound.
"""

import numpy as np

from manufactured.case import Case
from manufactured.cases.softening import softening
from manufactured.law import KelvinVoigt, NonSymmetric, isotropic, isotropic_matrix
from manufactured.regularity import Regularity

NAME = "no-potential"
SKEW = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])
"""The rotation by a right angle of the first and third Mandel components, 11 and √2·12."""


def law_without_potential() -> KelvinVoigt:
    """Return the law ``cases.laws.softening_in_volume`` with three times the skew ``SKEW`` added to its G."""
    G = NonSymmetric(isotropic_matrix(0.5, -1.5) + 3 * SKEW)
    return KelvinVoigt(isotropic(1, 0.5), G, "linear, G softens in volume and has no potential")


def no_potential() -> Case:
    return Case(
        name=NAME,
        summary="front advances and recedes, G softens and has no potential",
        solution=softening(law_without_potential()),
        regularity=Regularity(gap=5, pressure=3, moving=True),
        order=1,
        reason="α = 5 > 7/2 and m = 3 > 3/2 give (5.36): order 1 by Prop. 5.4, G only Lipschitz",
        families=("one-diagonal",),
    )
