"""Equilibrated stresses, found without displacements.

From bottom to top: ``bernstein`` polynomials, the ``alfeld`` split and the ``composite`` element on it; the
``stress_space`` Σ^h on a ``triangulated_body``; ``loads`` and their ``projection``; the ``hybrid`` solver for the
stress of least complementary energy, and with it Problem 3.2 in time (``dual``). ``oscillation`` bounds what the
projection leaves out, with constants from ``balancing`` stresses on a ``divided_triangle``.
"""
