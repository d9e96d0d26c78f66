"""Equilibrated stresses, computed without displacements.

From bottom to top: ``bernstein`` polynomials; the ``composite`` element on the Alfeld split of a triangle; the
``stress_space`` Σ^h on a mesh; the ``loads`` that its stresses balance; the ``hybrid`` solver for the stress of least
complementary energy, and with it Problem 3.2 in time (``dual``). ``oscillation`` bounds the difference between the
loads and their projections.
"""
