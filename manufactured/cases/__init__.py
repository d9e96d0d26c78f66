"""The cases of the catalogue: one file for each exact solution, named after it (``manufactured.catalogue``).

The docstring of a case states first its formulas: the gap w, the pressure p, the contact zone {ψ ≥ 0}, and on Γ3 the
normal strain q = ε_nn at t = 0 if it is prescribed; without it the body starts in elastic equilibrium. s or x is the
coordinate along Γ3, x_+^a is 0 for x ≤ 0, and a and g are the moduli A_nnnn and G_nnnn. Then follow the predicted order
and the reason for it: α and m are the exponents of w and p at the fronts (``manufactured.regularity``).

Several cases share the material laws of ``laws``, the fronts of ``advancing_front`` and ``rough_front``, the strain
under the law (3.3) of ``yielding``, and ``constants``.
"""
