"""Proposition 5.4: ‖u − u^h‖_{L∞(0,T;V)} = O(h).

**Measured** (``measure``). Problem 5.1 is solved for every exact solution that satisfies (5.36), on every mesh family
that serves its body, on finer and finer meshes. A row of ``rates.csv`` is one mesh: the largest error in time, those of
the interpolant Π^h u and of Π^h u − u^h, and what keeps the error from being that of something else: the shares of time
steps and quadrature, the residual of the contact solves, u^h on Γ1. ``experiment`` has all that a row is made of.

**Judged** (``judge``). Orders must be 1 from both sides, since (5.37) is sharp for piecewise linears, from level to
level and fitted. So must be the sizes, by three relations, of which the first shares no code with the errors:

* ‖u − Π^h u‖_V against its leading term, computed from second derivatives of u; judged as (5.23), ``from_rates``;
* (‖u − u^h‖² + ‖Π^h u − u^h‖²)^{1/2} / ‖u − Π^h u‖ = 1 within 10 %: were u^h the best approximation of u in V^h, this
  would be Pythagoras' theorem, and contact and memory disturb it little. It ties the error to the interpolation error;
* the parallelogram law of u − u^h and u − Π^h u at every time. It ties the error to u^h: that of Π^h u would pass the
  others, being nearly as large.

**Why the error of Π^h u − u^h beside it.** For piecewise linears the error is nearly all interpolation error, and its
largest value may come at t = 0, where nothing was solved. What the solver did is ‖Π^h u − u^h‖_V, with an order and a
share of its own.

``from_rates`` also compares bodies in different positions, and asks what becomes of the order without (5.36).
"""
