"""The command ``study bound --adapt``: refine mesh and time steps until the error bound is below a tolerance.

The bound is computed from u_h alone. ``study.bound.terms`` divides it into shares of the cells and of time. The fewest
cells that together have half of all shares of cells are refined (red, green and blue refinement after C. Carstensen,
Constr. Approx. 20 (2004) 549–564, which leaves no hanging nodes and angles bounded from below). All time steps are
halved if the share of time is more than a quarter of the bound.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from skfem import Mesh, MeshTri

from manufactured.body import Kind
from manufactured.case import Case
from manufactured.data import Data
from manufactured.static import Static
from manufactured.tensors import Array
from study.bound.bounded import MEANING, MOVING, STATIC
from study.bound.discretisation import Discretisation
from study.bound.enclosing import Enclosure, enclose, known_error
from study.bound.problem import BoundError
from study.bound.static import compute_static, enclose_static
from study.bound.terms import Shares
from study.bound.trajectory import DiscreteSolution, SmoothedInTime, compute
from study.fem.mesh import boundary_parts
from study.ledger.text import up, width
from study.solve.evolution import Scheme

PART = 0.5
"""Fraction of the sum of all cell shares that the refined cells have together."""
IN_TIME = 0.25
"""Fraction of the bound due to time above which steps are halved; if cells have less, the mesh is not refined."""
TOUCHING = 1e-9
"""Gap, relative to the largest displacement, up to which a vertex of Γ3 counts as in contact."""
SHOWN = 4
"""Significant digits of bounds in the printed table."""


@dataclass(frozen=True, eq=False)
class Adapted:
    """The solution u_h on one mesh, the bound of its error, and what each cell contributes to the bound."""

    mesh: Mesh
    computed: DiscreteSolution
    enclosure: Enclosure
    shares: Shares


@dataclass(frozen=True, eq=False)
class Stage:
    """A mesh, by its vertices (2, n) and cells (3, n), and a number of time steps."""

    p: Array
    t: Array
    steps: int

    @property
    def mesh(self) -> Mesh:
        return MeshTri(np.ascontiguousarray(self.p), np.ascontiguousarray(self.t))

    @property
    def cells(self) -> int:
        return int(self.t.shape[1])


@dataclass(frozen=True)
class Tolerance:
    """The tolerance for the error bound: a number, or a percentage of max ‖u(t)‖_V.

    Raises:
        BoundError: the number is not positive.
    """

    number: float
    percent: bool = False

    def __post_init__(self) -> None:
        if not 0 < self.number < math.inf:
            raise BoundError(f"--adapt needs a tolerance that is a positive number, got {self.number:g}")

    def reached(self, row: pd.Series) -> bool:
        """Return whether the bound of a row of ``adaptive.csv`` is at most this tolerance."""
        return bool(row["percent" if self.percent else "bound"] <= self.number)

    def __str__(self) -> str:
        return f"{self.number:g} %" if self.percent else f"{self.number:g}"


def tolerance_from(text: str) -> Tolerance:
    """Return the tolerance that is written as text, such as ``0.2`` or ``5%``.

    Raises:
        BoundError: the text is not a tolerance.
    """
    percent = text.strip().endswith("%")
    try:
        number = float(text.strip().removesuffix("%"))
    except ValueError as error:
        raise BoundError(f"--adapt needs a tolerance such as 0.2 or 5%, got {text!r}") from error
    return Tolerance(number, percent)


def adapted(data: Data, case: Case | None, stage: Stage, scheme: Scheme) -> Adapted:
    """Compute u_h on a mesh and the bound of its error from u_h alone.

    Raises:
        MeshError: the mesh does not fit the parts of the body.
    """
    mesh = stage.mesh
    boundary_parts(mesh, data.body)
    discretisation = Discretisation(data, mesh)
    if isinstance(data, Static):
        static = compute_static(discretisation)
        return Adapted(mesh, static, *enclose_static(discretisation, static, None))
    computed = compute(discretisation, scheme, stage.steps)
    found = enclose(discretisation, computed, SmoothedInTime(), known_error(case, computed))
    return Adapted(mesh, computed, found, found.shares(discretisation.moduli))


def next_stage(stage: Stage, cells: Array, in_time: float) -> Stage:
    """Return the mesh and the number of steps after one refinement.

    Args:
        cells: shares of the cells, (cells,).
        in_time: the share of time.
    """
    part = in_time / (float(cells.sum()) + in_time)
    steps = stage.steps * (2 if part > IN_TIME else 1)
    if part > 1 - IN_TIME:
        return Stage(stage.p, stage.t, steps)
    mesh = stage.mesh.refined(marked(cells, PART))
    return Stage(mesh.p, mesh.t, steps)


def marked(shares: Array, part: float) -> Array:
    """Return the numbers of the fewest cells whose shares add up to a fraction 0 < part ≤ 1 of all shares, (n,).

    Source: W. Dörfler, SIAM J. Numer. Anal. 33 (1996) 1106–1124.
    """
    order = np.argsort(-shares, kind="stable")
    sums = np.cumsum(shares[order])
    return np.sort(order[: int(np.searchsorted(sums, part * sums[-1] * (1 - 1e-12))) + 1])


def record(number: int, found: Adapted) -> dict[str, Any]:
    """Return the results on one mesh as a dict.

    Keys: ``row`` of ``adaptive.csv``; ``inside``, whether a known error lies in the enclosure; ``sentences`` on the
    evidence for the bound.
    """
    enclosure = found.enclosure
    row = {
        "mesh": number,
        "cells": int(found.mesh.t.shape[1]),
        "dofs": found.computed.space.dofs,
        "steps": found.computed.steps,
        "error": float(enclosure.error.max()),
        "bound": enclosure.highest,
        "percent": 100 * enclosure.relative[1],
        "in_time": found.shares.time / found.shares.total,
        "kind": enclosure.evidence.kind,
    }
    return {"row": row, "inside": enclosure.contains, "sentences": list(enclosure.evidence.sentences)}


def table(rows: Sequence[dict[str, Any]]) -> pd.DataFrame:
    """Return the table ``adaptive.csv``, with one row for each mesh.

    The column ``order`` is the order log(b/b')/log(N'/N) of the bound b in the number of unknowns N.
    """
    found = pd.DataFrame(rows)
    unknowns, bounds = np.log(found["dofs"]).diff(), -np.log(found["bound"]).diff()
    found["bound"] = [float(up(bound, 9)) for bound in found["bound"]]
    found["percent"] = [float(up(percent, 9)) if percent < math.inf else percent for percent in found["percent"]]
    found["in_time"] = found["in_time"].round(4)
    found.insert(len(found.columns) - 1, "order", (bounds / unknowns.where(unknowns > 0)).round(3))
    return found


def text(
    name: str,
    rows: pd.DataFrame,
    tolerance: Tolerance,
    stopped: str,
    sentences: Sequence[str],
    norm: str = MOVING,
) -> list[str]:
    """Return the printed lines: whether the tolerance is reached, the evidence, and one line for each mesh.

    Args:
        stopped: why refinement ended before the tolerance was reached; empty if it was reached.
    """
    sign, end = ("≤", "is reached") if not stopped else (">", f"is not reached: {stopped}")
    percents = [f"{up(percent, SHOWN)} %" if percent < math.inf else "∞" for percent in rows["percent"]]
    bound, moving, known = up(rows["bound"].iloc[-1], SHOWN), norm != STATIC, bool(rows["error"].notna().all())
    reached = f"{bound}, {percents[-1]} of u," if tolerance.percent else bound
    found = [f"{name}: {'max ' * moving}{norm} ≤ {reached} {sign} {tolerance}, the tolerance {end}"]
    found += [*(textwrap.fill(sentence, width()) for sentence in sentences), ""]
    columns = {
        "mesh": rows["mesh"].astype(str),
        "  cells": rows["cells"].astype(str),
        "unknowns": rows["dofs"].astype(str),
        " steps": rows["steps"].astype(str) if moving else None,
        "     bound": [up(bound, SHOWN) for bound in rows["bound"]],
        "   % of u": percents,
        " order": ["" if math.isnan(order) else f"{order:.2f}" for order in rows["order"]],
        " in time": [f"{100 * share:.1f} %" for share in rows["in_time"]] if moving else None,
        "     error": [f"{error:.4g}" for error in rows["error"]] if known else None,
    }
    shown = {head: cells for head, cells in columns.items() if cells is not None}
    found.append(" ".join(shown))
    for cells in zip(*shown.values(), strict=True):
        found.append(" ".join(f"{cell:>{len(head)}}" for head, cell in zip(shown, cells, strict=True)).rstrip())
    notes = "% of u: the bound over the least value that the norm of u can have", MEANING[norm]
    return [*found, "", *notes, "order: of the bound in unknowns; 1/2 is the best possible for P1"]


def stage_file(directory: Path, number: int) -> Path:
    """Return the path of the file for one mesh, with its displacement and the shares of its cells."""
    return directory / f"adapted-{number}.npz"


def contact_edges(data: Data, mesh: Mesh, displacement: Array) -> tuple[Array, Array]:
    """Return the end points (2, 2, n) of the edges of Γ3, and which edges are in contact at both ends, (n,).

    Args:
        displacement: at the vertices, (2, vertices).
    """
    # The empty arrays serve bodies without contact.
    ends, closed = [np.empty((2, 2, 0))], [np.empty(0, dtype=bool)]
    size = max(float(abs(displacement).max()), np.finfo(float).tiny)
    for part, facets in zip(data.body.parts, boundary_parts(mesh, data.body), strict=True):
        if part.kind is Kind.CONTACT:
            vertices = mesh.facets[:, facets]
            ends.append(mesh.p[:, vertices])
            opening = -np.einsum("d,den->en", part.normal, displacement[:, vertices])
            closed.append((opening <= TOUCHING * size).all(axis=0))
    return np.concatenate(ends, axis=2), np.concatenate(closed)
