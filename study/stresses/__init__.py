"""Equilibrated stresses, found without displacements.

From bottom to top: ``bernstein`` polynomials, the ``composite`` element on the Alfeld split of a triangle; the
``stress_space`` Σ^h on a mesh; the ``loads`` it balances; the ``hybrid`` solver for the stress of least complementary
energy, and with it Problem 3.2 in time (``dual``). ``oscillation`` bounds what projected loads leave out.
"""
