"""Which contact solver is used on a space, by its dimension and number of unknowns, and to what residual."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

from study.fem.space import Displacements
from study.solve.multigrid import Multigrid
from study.solve.signorini import ContactSolver, Signorini

FACTORED = {2: math.inf, 3: 15_000}
"""Largest number of unknowns for which S is factorised, by dimension. In the plane L has O(n log n) entries, and
multigrid takes ten times as long. In space L has O(n^{4/3}) entries and takes O(n²) operations."""
ROUNDING = 1e-10
"""Relative residual allowed after a factorisation."""
SHARE = 0.01
"""Error allowed to multigrid, relative to the discretisation error, by the estimate in ``residual``."""


def contact_solver(space: Displacements) -> Callable[..., ContactSolver]:
    """(S, N, gap=0) ↦ the contact solver for matrices on a space, chosen by its dimension and number of unknowns."""
    if space.dofs <= FACTORED[space.dim]:
        return partial(Signorini, x=space.free_points)
    return partial(Multigrid, x=space.free_points, tolerance=multigrid_tolerance(space.dim, space.dofs))


def multigrid_tolerance(dim: int, dofs: int) -> float:
    """The relative residual at which multigrid stops: half of the allowed one, so that rounding does not decide."""
    return SHARE / 2 * (dim / dofs) ** (2 / dim)


def residual(dim: int, dofs: int) -> float:
    """The largest relative residual ‖S u + Nᵀλ − b‖/‖b‖ allowed to the contact solver for so many unknowns.

    A residual ρ leaves at most cond(S)^{1/2} ρ of the solution in the norm of S, and cond(S)^{1/2} grows like 1/h, h
    in units of the body; the discretisation error is of order h. With ρ = ϑ h², h = (d/dofs)^{1/d}, the error of the
    solver is at most ϑ times the discretisation error, up to constants that tests measure.
    """
    return ROUNDING if dofs <= FACTORED[dim] else 2 * multigrid_tolerance(dim, dofs)
