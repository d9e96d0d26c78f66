"""Which contact solver serves a space, by its size: both solve the same problem to the same accuracy."""

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
"""Unknowns up to which S is factorised, by dimension. In the plane L has O(n log n) entries, and a step with it takes a
fraction of one with multigrid. In space it has O(n^{4/3}) entries, made by O(n²) operations: the limit is somewhat
below the n from which a trajectory takes less time by multigrid, since memory speaks for it before."""


def contact_solver(space: Space) -> Callable[[sps.csc_array, sps.csr_array], ContactSolver]:
    """(S, N) ↦ the contact solver for matrices on a space."""
    if space.dofs <= FACTORED[space.dim]:
        return Signorini
    return partial(Multigrid, x=free_vertices(space))


def free_vertices(space: Space) -> Points:
    """The vertices off Γ1, in the order of the unknowns, (d, n_dofs/d)."""
    return space.mesh.p[:, space.free[:: space.dim] // space.dim]
