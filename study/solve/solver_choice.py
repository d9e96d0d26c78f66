"""Chooses the contact solver for a space, direct or multigrid, and the largest residual that it may leave."""

import math
from collections.abc import Callable
from functools import partial

from study.fem.space import Displacements
from study.solve.multigrid import Multigrid
from study.solve.signorini import ContactSolver, Signorini

FACTORED = {2: math.inf, 3: 15_000}
"""The direct solver is used up to this number n of unknowns, by dimension.

In 2D its factor L has O(n log n) entries, and multigrid takes ten times as long. In 3D L has O(n^{4/3}) entries and
takes O(n²) operations.
"""
ROUNDING = 1e-10
"""Largest relative residual that the direct solver may leave."""
SHARE = 0.01
"""Permitted error of the multigrid solver, as a fraction of the discretisation error (see ``residual``)."""


def contact_solver(space: Displacements) -> Callable[..., ContactSolver]:
    """Return a function that makes contact solvers for a space: direct ones, or multigrid for large problems in space.

    It is called with the matrix S, the matrix N of the constraints and optionally ``gap=g``. The solver minimises
    ½ vᵀSv − bᵀv over N v ≤ g.
    """
    if space.dofs <= FACTORED[space.dim]:
        return partial(Signorini, x=space.free_points)
    return partial(Multigrid, x=space.free_points, tolerance=multigrid_tolerance(space.dim, space.dofs))


def multigrid_tolerance(dim: int, dofs: int) -> float:
    """Return the relative residual at which multigrid stops: half of the largest permitted one (``residual``)."""
    return SHARE / 2 * (dim / dofs) ** (2 / dim)


def residual(dim: int, dofs: int) -> float:
    """Return the largest permitted relative residual ‖S u + Nᵀλ − b‖/‖b‖ of the contact solver.

    For the direct solver this is ``ROUNDING``. For multigrid it is ϑ h² with ϑ = ``SHARE`` and h = (d/dofs)^{1/d}. The
    reason is that a relative residual ρ gives a relative error of at most cond(S)^{1/2} ρ in the norm of S, and
    cond(S)^{1/2} grows like 1/h. The solver's error is then at most about ϑ h, while the discretisation error is of
    order h. The constants are measured by tests.
    """
    return ROUNDING if dofs <= FACTORED[dim] else 2 * multigrid_tolerance(dim, dofs)
