"""The cases of the catalogue, in modules by theme: a function for each exact solution, named after it.

The docstring of a case first states formulas on the contact boundary Γ3: the gap w, the contact pressure p, the contact
zone {ψ ≥ 0} and, if it is not 0, the slip z; in 3D z has two components. If the normal strain q = ε_nn at t = 0 is not
stated, it starts at rest, q̇ = 0; without slip the body then starts in elastic equilibrium. s or x is the coordinate
along Γ3, x_+^a is 0 for x ≤ 0, and a and g are the moduli A_nnnn and G_nnnn of viscosity and elasticity. Then follow
the predicted order and the reason for it. There α and m are the exponents of w and p at the contact fronts
(``manufactured.regularity``).

The modules are listed in ``manufactured.catalogue``. Laws, bodies and contact faces that several modules use are in
``shared``.
"""
