"""Beyond the source: the work of contact where there is contact at every scale.

The term of (5.21) that distinguishes contact from a linear problem, ‖R(·; Π^h u − u)‖^{1/2}_{L¹(0,T)}, is of the order
1 for u ∈ W^{1,1}(0,T;H²), whatever the trace does (``edge_work``); for a fixed u it is even o(h). In the cases of the
catalogue with a few smooth fronts it is 1e-6 … 1e-3 of the error, and nothing can be seen of it (natural-front has
0.03, rough-trace 0.1). Here it is measured for the cases of ``manufactured.multiscale``, whose contact zones
have details of the size of h on every mesh:

* ``work``: ‖R(·; Π^h u − u)‖^{1/2}_{L¹(0,T)}, R = ∫_{Γ3} p Π^h w as p w = 0;
* ``error``: max_t ‖u − u^h‖_V;
* ``excess``: max_t ‖u^h − u^h_lin‖_V, u^h_lin the solution of the linear problem for p given as a traction, which does
  not know of contact: what contact costs.

Integrals are those of a mesh that is refined until its cells are a third of the depth of every lifting.

**Predicted.** On grids all edges are alike, ℓ halves with h, and every train is cut at the same places of its waves, so
that R/h² is the sum over the trains of one function of ℓ/h. It stays constant, and the root has the order 1, as long as
there are trains of all widths h/2 … 4h, for 32 ≤ n ≤ 128: ± 0.15 there, and lower before. Where vertices are random,
each edge is cut elsewhere. Between four and sixteen edges lie on the train that counts most, and R_E varies between
them as much as it is large, so that single orders may be off by 0.5: they are reported. If that is the reason, the mean
of R over random vertices has the order of grids, and its relative standard deviation falls like n^{−1/2}: claimed.
Unstructured meshes have equal edges on each piece, whose number does not double: they cut the waves elsewhere on every
level, all in the same way, and the work may nearly vanish on one of them (seen: orders −2.5 … 1.2, shares from 0.011).

Of the error and the excess no order is predicted. A train is resolved from h < ℓ/10 on, so that the error has hardly
begun to fall where R has; on grids work / error is to be above 1/50, twenty times what smooth
fronts have.
"""
