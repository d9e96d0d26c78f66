"""The command ``study bound --adapt``: refine mesh and time steps until the error bound is below a tolerance.

The error bound is computed from the displacement u_h alone. ``study.bound.terms`` divides it into contributions of the
cells and of the time steps, called shares. The cells with the largest shares are refined: the fewest cells whose shares
add up to half of the sum of all shares of cells. Red, green and blue refinement (C. Carstensen, Constr. Approx. 20
(2004) 549–564) leaves no hanging nodes and bounds the angles from below. If the time steps contribute more than a
quarter of the bound, all steps are halved.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from skfem import Mesh

from manufactured.case import Case
from manufactured.data import Data
from manufactured.tensors import Array
from study.bound.discretisation import Discretisation
from study.bound.enclosing import Enclosure, compute_static, enclose, enclose_static, known_error, relative
from study.bound.problem import BoundError
from study.bound.terms import Shares
from study.bound.trajectory import Computed, SmoothedInTime, compute
from study.fem.mesh import boundary_parts
from study.ledger.text import up
from study.solve.evolution import Scheme

PART = 0.5
"""Fraction that determines how many cells are refined.

The refined cells contribute together this fraction of the part of the error bound that is due to cells.
"""
SHARE_IN_TIME = 0.25
"""Time steps are halved if they contribute more than this fraction of the error bound.

If the cells contribute less than this fraction, the mesh is not refined.
"""


@dataclass(frozen=True, eq=False)
class Adapted:
    """The displacement u_h on one mesh, the bound of its error, and the contributions to the bound.

    Attributes:
        computed: the displacement u_h.
        enclosure: the lower and upper bounds of the error of u_h.
        shares: the contributions of the cells and of the time steps to the upper bound.
    """

    computed: Computed
    enclosure: Enclosure
    shares: Shares


@dataclass(frozen=True, eq=False)
class Stage:
    """The mesh and the number of time steps of one round of the adaptive refinement.

    Attributes:
        mesh: the mesh.
        steps: the number of time steps.
    """

    mesh: Mesh
    steps: int

    @property
    def cells(self) -> int:
        return int(self.mesh.t.shape[1])


@dataclass(frozen=True)
class Tolerance:
    """The tolerance for the error bound: a number, or a percentage of the norm max_t ‖u(t)‖_V of the solution.

    Attributes:
        number: the number or the percentage; for 5 % this is 5, not 0.05.
        percent: whether ``number`` is a percentage.
    """

    number: float
    percent: bool = False

    def reached(self, row: pd.Series) -> bool:
        """Return whether the error bound of a mesh, from its row of ``adaptive.csv``, is at most this tolerance."""
        return bool(row["percent" if self.percent else "bound"] <= self.number)

    def __str__(self) -> str:
        return f"{self.number:g} %" if self.percent else f"{self.number:g}"


def tolerance_from(text: str) -> Tolerance:
    """Convert a text such as ``0.2`` or ``5%`` to a tolerance.

    Raises:
        BoundError: the text is neither a positive number nor a percentage.
    """
    percent = text.strip().endswith("%")
    try:
        number = float(text.strip().removesuffix("%"))
    except ValueError:
        number = math.nan
    if not 0 < number < math.inf:
        raise BoundError(f"--adapt needs a tolerance that is a positive number, such as 0.2 or 5%, got {text!r}")
    return Tolerance(number, percent)


def adapted(data: Data, case: Case | None, stage: Stage, scheme: Scheme) -> Adapted:
    """Compute the displacement u_h on a given mesh, and bound its error from u_h alone.

    This is one round of the adaptive refinement. The mesh is not changed; ``next_stage`` chooses the next mesh.
    No second, more accurate displacement is computed.

    Args:
        data: the problem.
        case: the case if the exact solution is known, so that the true error is computed as well; otherwise None.
        stage: the mesh and the number of time steps.
        scheme: the time scheme.

    Returns:
        u_h, the bounds of its error, and the contributions of the cells and of the time steps to the upper bound.

    Raises:
        MeshError: the mesh does not fit the parts of the body.
    """
    boundary_parts(stage.mesh, data.body)
    discretisation = Discretisation(data, stage.mesh)
    if not data.in_time:
        computed = compute_static(discretisation)
        return Adapted(computed, *enclose_static(discretisation, computed, None))
    computed = compute(discretisation, scheme, stage.steps)
    enclosure = enclose(discretisation, computed, SmoothedInTime(), known_error(case, computed))
    return Adapted(computed, enclosure, enclosure.shares(discretisation.moduli))


def next_stage(stage: Stage, cells: Array, in_time: float) -> Stage:
    """Return the mesh and the number of time steps after one adaptive refinement.

    If the time steps contribute more than a quarter of the error bound, their number is doubled. If the cells
    contribute at least a quarter, the mesh is refined: the fewest cells that together contribute half of the part of
    all cells, and neighbours of these cells so that no hanging nodes arise. Both may happen at once.

    Args:
        stage: the present mesh and number of steps.
        cells: the contribution of each cell to the error bound, (cells,).
        in_time: the contribution of the time steps to the error bound.
    """
    part = in_time / (float(cells.sum()) + in_time)
    steps = 2 * stage.steps if part > SHARE_IN_TIME else stage.steps
    if part > 1 - SHARE_IN_TIME:
        return Stage(stage.mesh, steps)
    return Stage(stage.mesh.refined(marked(cells, PART)), steps)


def marked(shares: Array, part: float) -> Array:
    """Select the cells to refine: as few cells as possible whose contributions sum to a given fraction of the total.

    Args:
        shares: the contribution of each cell to the error bound, (cells,).
        part: the fraction, 0 < part ≤ 1. The sum over the selected cells is at least this fraction of the sum over all
            cells.

    Returns:
        The numbers of the selected cells in ascending order, (n,).

    Source: W. Dörfler, SIAM J. Numer. Anal. 33 (1996) 1106–1124.
    """
    order = np.argsort(-shares, kind="stable")
    sums = np.cumsum(shares[order])
    last = np.searchsorted(sums, part * sums[-1] * (1 - 1e-12))
    return np.sort(order[: last + 1])


def record(number: int, solution: Adapted) -> dict[str, Any]:
    """Return the results on one mesh as a dict.

    Args:
        number: the number of the mesh in the sequence of refinements.
        solution: the solution on this mesh and the bound of its error.

    Returns:
        ``row``: the row of ``adaptive.csv``; ``inside``: whether the error lies between its bounds, if the error is
        known; ``sentences``: texts that say whether the bound is guaranteed.
    """
    enclosure = solution.enclosure
    row = {
        "mesh": number,
        "cells": solution.computed.space.cells,
        "dofs": solution.computed.space.dofs,
        "steps": solution.computed.steps,
        "error": float(enclosure.error.max()),
        "bound": enclosure.highest,
        "percent": 100 * relative((enclosure.lowest, enclosure.highest), enclosure.norm)[1],
        "in_time": solution.shares.time / solution.shares.total,
        "kind": enclosure.evidence.kind,
    }
    return {"row": row, "inside": enclosure.contains, "sentences": list(enclosure.evidence.sentences)}


def table(rows: Sequence[dict[str, Any]]) -> pd.DataFrame:
    """Return the table ``adaptive.csv``, with one row for each mesh, from the rows that ``record`` returns.

    The column ``order`` compares each mesh with the previous one. For the bounds b, b' and the numbers N, N' of
    unknowns on the two meshes, it is log(b/b')/log(N'/N).
    """
    frame = pd.DataFrame(rows)
    unknowns = np.log(frame["dofs"]).diff()
    bounds = -np.log(frame["bound"]).diff()
    for name in ("bound", "percent"):
        frame[name] = [float(up(value, 9)) if value < math.inf else value for value in frame[name]]
    frame["in_time"] = frame["in_time"].round(4)
    frame.insert(len(frame.columns) - 1, "order", (bounds / unknowns.where(unknowns > 0)).round(3))
    return frame


def stage_file(directory: Path, number: int) -> Path:
    """Return the path of the file with the displacement on one mesh and the contributions of its cells to the bound.

    Args:
        directory: the result directory.
        number: the number of the mesh in the sequence of refinements.
    """
    return directory / f"adapted-{number}.npz"
