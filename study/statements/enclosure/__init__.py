"""Beyond the source: bounds of the error of the fully discrete scheme, without the exact solution.

**Measured** (``courses``, ``bound_rows``) by ``study.bound``: the error of a displacement u_h that a time scheme
computed, bounded from u_h itself ("bound"), and enclosed from both sides by a better trajectory ("enclosure"), at many
times.

**Judged** (``inside``). That no error lies outside is a theorem (``paper/bound.tex``) about a program that may be
wrong: a row fails when one sampled error of one mesh, scheme or time does. How close the ends are is a matter of
efficiency; it is judged where it was announced, on the check-value case, and reported elsewhere. Two enclosures enclose
an order of convergence, also where nobody knows the solution.
"""
