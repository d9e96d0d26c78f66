"""The matrix of a time step, for tests of the contact solvers."""

from __future__ import annotations

import scipy.sparse as sps

from manufactured import named
from study.fem.space import Space, form


def step_matrix(name: str, space: Space) -> sps.csc_array:
    """Returns 20 A + G, the matrix of a step of length 1/20 with the law of a case."""
    law = named(name).solution.law
    return sps.csc_array(20 * form(space, law.A) + form(space, law.G))
