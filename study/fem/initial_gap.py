"""The initial gap of an exact solution at the contact vertices of a mesh."""

from __future__ import annotations

import numpy as np

from manufactured.exact import ExactSolution
from manufactured.tensors import Array
from study.fem.space import Space


def gaps_at_vertices(solution: ExactSolution, space: Space) -> Array | float:
    """Return g at the contact vertices in the order of the rows of ``space.N``, (m,); the number 0 as in the paper."""
    if not solution.has_initial_gap:
        return 0.0
    pieces = zip(solution.faces, space.contact, strict=True)
    places = [(face, part.coordinates(space.mesh.p[:, vertices])[0]) for face, (part, vertices) in pieces]
    return np.concatenate([solution.on(face, s).initial_gap() * np.ones(s.shape[1]) for face, s in places])
