"""Stresses in equilibrium with the loads, computed without displacements.

``composite`` defines the stress element on a triangle and ``stress_space`` the space Σ^h of such stresses on a mesh.
``loads`` projects the loads onto those that these stresses can balance, and ``oscillation`` bounds the effect of this
projection. ``hybrid`` computes the stress of least complementary energy and, with it, Problem 3.2 in time.
"""
