"""Stresses in equilibrium with the loads, computed without displacements.

``composite`` defines the stress element on a triangle and ``stress_space`` the stresses of this element on a mesh.
``loads`` projects the loads onto loads that these stresses can balance, and ``oscillation`` bounds the effect of this
projection. ``hybrid`` computes the stress of least complementary energy and, with it, solves Problem 3.2 in time.
"""
