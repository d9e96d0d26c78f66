"""What cannot be bounded, refused with the reason."""

from __future__ import annotations

import numpy as np
from skfem import Mesh

from manufactured.case import Case
from manufactured.data import Data

ON_VERTEX = 1e-9
"""Distance, relative to the cell, up to which a line on which the material changes counts as meeting a vertex."""


class BoundError(ValueError):
    """No bound can be given for the data."""


def refuse_solids(data: Data) -> None:
    """Raise BoundError unless the body is plane."""
    if data.body.dim != 2:
        raise BoundError(
            f"the bound rests on composite triangles, the body has dimension {data.body.dim}; give a plane body"
        )


def refuse_jumps_in_cells(data: Data, mesh: Mesh) -> None:
    """Raise BoundError unless A and G are smooth in every cell, as integrals of strains and stresses assume."""
    for direction, offset in data.law.steps:
        distance = (np.array(direction) @ mesh.p - offset)[mesh.t]
        near = ON_VERTEX * np.ptp(distance, axis=0)
        if ((distance.min(axis=0) < -near) & (distance.max(axis=0) > near)).any():
            raise BoundError(
                f"A or G jumps across the line {direction}·x = {offset:g}, which runs through cells of the mesh; "
                "list it as an interface of the body, so that meshes follow it, or take a level that meets it"
            )


def check_force(case: Case | None) -> None:
    """Raise BoundError if f_0 ∉ L²(Ω)²: its oscillation is infinite, and no composite stress balances it."""
    if case is not None and not case.regularity.force_in_L2:
        raise BoundError(
            f"case {case.name}: {case.regularity} has f_0 ∉ L²(Ω)², and the bound needs stresses with Div σ = −P f_0; "
            "take a case with f_0 in L²"
        )
