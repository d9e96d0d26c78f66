"""Which contact solver is used on a space, by its dimension and size, and to what residual."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import scipy.sparse as sps

from manufactured.tensors import Points
from study.fem.space import Space
from study.solve.multigrid import Multigrid
from study.solve.signorini import ContactSolver, Signorini

FACTORED = {2: math.inf, 3: 120_000}
"""Unknowns up to which S is factorised, by dimension. In the plane L has O(n log n) entries, and a level takes more
than ten times as long by multigrid (`make bench-growth` has both). In space it has O(n^{4/3}) entries, made by O(n²)
operations: at about the limit multigrid takes as long, and a third of the memory."""
ROUNDING = 1e-10
"""Relative residual that a factorisation may leave."""
SHARE = 0.01
"""Error that multigrid may leave, relative to the discretisation error, by the estimate in ``residual``."""


def residual(dim: int, dofs: int) -> float:
    """The relative residual ‖S u + Nᵀλ − b‖/‖b‖ asked of the contact solver for so many unknowns.

    A residual ρ leaves at most cond(S)^{1/2} ρ of the solution in the norm of S, and cond(S)^{1/2} grows like 1/h, h
    in units of the body; the discretisation error is of order h. With ρ = ϑ h², h = (d/dofs)^{1/d}, the former is
    at most ϑ times the latter, up to constants that tests measure.
    """
    return ROUNDING if dofs <= FACTORED[dim] else 2 * aim(dim, dofs)


def aim(dim: int, dofs: int) -> float:
    """The relative residual at which multigrid stops: half of what is asked, so that rounding does not decide."""
    return SHARE / 2 * (dim / dofs) ** (2 / dim)


def contact_solver(space: Space) -> Callable[[sps.csc_array, sps.csr_array], ContactSolver]:
    """(S, N) ↦ the contact solver for matrices on a space."""
    if space.dofs <= FACTORED[space.dim]:
        return Signorini
    return partial(Multigrid, x=free_vertices(space), tolerance=aim(space.dim, space.dofs))


def free_vertices(space: Space) -> Points:
    """The vertices off Γ1, in the order of the unknowns, (d, n_dofs/d)."""
    return space.mesh.p[:, space.free[:: space.dim] // space.dim]
