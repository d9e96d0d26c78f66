"""Guaranteed bounds of ‖u(t) − u_h(t)‖_V for anybody's data, without the exact solution: the command ``study bound``.

``trajectory`` computes u_h and another ũ, differentiable in time, on a ``discretisation``.
``equilibration`` finds stresses, ``majorant`` the bound of ‖u − ũ‖_V, ``enclosing`` the two-sided bound of the error of
u_h. ``bounded`` does all of it for one level, prints and writes it; ``adaptive`` refines by the ``shares`` of a bound.
"""
