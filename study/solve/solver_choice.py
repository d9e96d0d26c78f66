"""Choice of the contact solver for a space, by its dimension and number of unknowns, and the permitted residual."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

from study.fem.space import Displacements
from study.solve.multigrid import Multigrid
from study.solve.signorini import ContactSolver, Signorini

FACTORED = {2: math.inf, 3: 15_000}
"""Largest number of unknowns for which S is factorised, by dimension. In 2D L has O(n log n) entries, and multigrid
takes ten times as long. In 3D L has O(n^{4/3}) entries and takes O(n²) operations."""
ROUNDING = 1e-10
"""Relative residual permitted after a factorisation."""
SHARE = 0.01
"""Error of multigrid, relative to the discretisation error, that the estimate in ``residual`` permits."""


def contact_solver(space: Displacements) -> Callable[..., ContactSolver]:
    """Return the function from S, N and optionally the initial gap to the contact solver for a space."""
    if space.dofs <= FACTORED[space.dim]:
        return partial(Signorini, x=space.free_points)
    return partial(Multigrid, x=space.free_points, tolerance=multigrid_tolerance(space.dim, space.dofs))


def multigrid_tolerance(dim: int, dofs: int) -> float:
    """Return the relative residual at which multigrid stops: half of the permitted one, as a margin for rounding."""
    return SHARE / 2 * (dim / dofs) ** (2 / dim)


def residual(dim: int, dofs: int) -> float:
    """Return the largest permitted relative residual ‖S u + Nᵀλ − b‖/‖b‖ of the contact solver.

    A residual ρ gives a relative error of at most cond(S)^{1/2} ρ in the norm of S, and cond(S)^{1/2} grows like 1/h, h
    in units of the body; the discretisation error is of order h. With ρ = ϑ h², h = (d/dofs)^{1/d}, the error of the
    solver is at most ϑ times the discretisation error, up to constants that tests measure.
    """
    return ROUNDING if dofs <= FACTORED[dim] else 2 * multigrid_tolerance(dim, dofs)
