"""Proposition 5.3: ‖u − u^h‖_{L∞(0,T;V)} → 0, however rough the solution.

**Measured** as for Proposition 5.4 (``prop_5_4.measure``), on exact solutions that miss its regularity: singular
corners, fronts, interfaces that the mesh does not meet, loads that are hardly continuous in time.

**Judged** (``convergence``). No rate is claimed, so none is asked for: errors fall from level to level, and a fit
e = e∞ + C h^s leaves no room for a positive limit e∞. The order seen is compared with the one that the regularity
predicts. The place of a front that rests within its cell alternates between levels, so orders are taken over two
refinements. Meshes graded towards a corner regain the order 1.
"""
