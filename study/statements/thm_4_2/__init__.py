"""Theorem 4.2: Problems 3.1 and 3.2, in displacements and in stresses, have one solution.

**On one mesh** (measured in ``gaps``, judged in ``same_mesh``). Problem 3.2 on the stresses dual to the strains of
V^h is solved by a method that shares nothing with Problem 3.1 but matrix, load and time steps. Both may differ by what
the duality gap of that solver leaves, which is proved there; that the comparison sees a mistake in one of them is shown
by making one (``stands_alone``).

**On a stress space of its own** (measured in ``stress_errors`` and ``stress_sweep``, judged in ``own_space``). Problem
3.2 is solved on equilibrated stresses that know no displacement, and must converge to the same solution with the orders
that its regularity predicts.
"""
