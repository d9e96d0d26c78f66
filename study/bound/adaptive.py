"""``study bound --adapt``: meshes and steps in time that follow the shares of a bound until it is small enough.

Cells that together have half of what all cells have are refined (red, green and blue refinement after C. Carstensen,
Constr. Approx. 20 (2004) 549–564, which leaves no hanging nodes and angles bounded from below), all others stay; steps
in time are halved, all of them, where time has more than a quarter. The bound is that from u_h alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from skfem import Mesh, MeshTri

from manufactured.body import Kind
from manufactured.case import Case
from manufactured.data import Data
from manufactured.tensors import Array
from study.bound.discretisation import Discretisation
from study.bound.enclosing import Enclosure, enclose, known_error
from study.bound.moduli import BoundError
from study.bound.shares import Shares, marked
from study.bound.trajectory import DiscreteSolution, SmoothedInTime, compute
from study.fem.mesh import boundary_parts
from study.ledger.files import write_whole
from study.ledger.rounding import up
from study.solve.evolution import Scheme

PART = 0.5
"""Part of the shares of all cells that the refined ones have."""
IN_TIME = 0.25
"""Part that time has of the bound from which on steps are halved; where cells have no more, meshes stay as they are."""
TOUCHING = 1e-9
"""Opening, relative to the largest displacement, up to which a vertex of Γ3 counts as in contact."""
SHOWN = 4


@dataclass(frozen=True, eq=False)
class Adapted:
    """u_h on one mesh, the bound of its error and the shares of it."""

    mesh: Mesh
    computed: DiscreteSolution
    enclosure: Enclosure
    shares: Shares


@dataclass(frozen=True, eq=False)
class Stage:
    """What the next bound is computed with, as it is kept: vertices (2, n), cells (3, n), and the number of steps."""

    p: Array
    t: Array
    steps: int

    @property
    def mesh(self) -> Mesh:
        return MeshTri(np.ascontiguousarray(self.p), np.ascontiguousarray(self.t))

    @property
    def cells(self) -> int:
        return int(self.t.shape[1])


def check_tolerance(tolerance: float, most: int) -> None:
    """Refuse what no bound reaches.

    Raises:
        BoundError: the tolerance is no positive number, or no cells are allowed.
    """
    if not 0 < tolerance < math.inf:
        raise BoundError(f"--adapt needs a tolerance that is a positive number, got {tolerance:g}")
    if most < 1:
        raise BoundError(f"--cells must be 1 or more, got {most}")


def adapted(data: Data, case: Case | None, stage: Stage, scheme: Scheme) -> Adapted:
    """Compute u_h and the bound of its error from it alone.

    Raises:
        MeshError: the mesh does not fit the parts of the body.
    """
    mesh = stage.mesh
    boundary_parts(mesh, data.body)
    discretisation = Discretisation(data, mesh)
    computed = compute(discretisation, scheme, stage.steps)
    found = enclose(discretisation, computed, SmoothedInTime(), known_error(case, computed))
    return Adapted(mesh, computed, found, found.shares(discretisation.moduli))


def next_stage(stage: Stage, cells: Array, in_time: float) -> Stage:
    """The mesh and the steps that the shares ask for.

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


def record(number: int, found: Adapted) -> dict[str, Any]:
    """What is kept of a mesh beside its arrays: its ``row`` of ``adaptive.csv``, and what the bound rests on."""
    row = {
        "mesh": number,
        "cells": int(found.mesh.t.shape[1]),
        "dofs": found.computed.space.dofs,
        "steps": found.computed.steps,
        "error": float(found.enclosure.error.max()),
        "bound": found.enclosure.highest,
        "in_time": found.shares.time / found.shares.total,
        "kind": found.enclosure.evidence.kind,
    }
    inside = found.enclosure.contains
    return {"row": row, "inside": inside, "sentences": list(found.enclosure.evidence.sentences)}


def table(rows: Sequence[dict[str, Any]]) -> pd.DataFrame:
    """``adaptive.csv``: ``order`` is that of the bound in unknowns, log(b/b')/log(N'/N), since the mesh before."""
    found = pd.DataFrame(rows)
    unknowns, bounds = np.log(found["dofs"]).diff(), -np.log(found["bound"]).diff()
    orders = (bounds / unknowns.where(unknowns > 0)).round(3)
    found["bound"] = [float(up(bound, 9)) for bound in found["bound"]]
    found = found.assign(in_time=found["in_time"].round(4), order=orders)
    return found[[*(column for column in found if column != "kind" and column != "order"), "order", "kind"]]


def text(name: str, rows: pd.DataFrame, tolerance: float, stopped: str, sentences: Sequence[str]) -> list[str]:
    """What is printed: whether the tolerance is reached, on what that rests, and a line for each mesh."""
    last = rows.iloc[-1]
    sign, end = ("≤", "is reached") if not stopped else (">", f"is not reached: {stopped}")
    found = [f"{name}: max ‖u(t) − u_h(t)‖_V ≤ {up(last['bound'], SHOWN)} {sign} {tolerance:g}, the tolerance {end}"]
    found += [*sentences, ""]
    known = bool(rows["error"].notna().all())
    found.append(
        f"{'mesh':>4} {'cells':>7} {'unknowns':>8} {'steps':>6} {'bound':>10} {'order':>6} {'in time':>8}"
        + (f" {'error':>10}" if known else "")
    )
    for row in rows.itertuples():
        order = "" if math.isnan(row.order) else f"{row.order:.2f}"
        line = f"{row.mesh:4d} {row.cells:7d} {row.dofs:8d} {row.steps:6d} {up(row.bound, SHOWN):>10} {order:>6}"
        found.append(f"{line} {100 * row.in_time:6.1f} %" + (f" {row.error:10.4g}" if known else ""))
    return [*found, "", "orders are those of the bound in unknowns; 1/2 is the best there is for P1"]


def stage_file(directory: Path, number: int) -> Path:
    """Where a mesh with its displacement and the shares of its cells is."""
    return directory / f"adapted-{number}.npz"


def write_stage(directory: Path, number: int, found: Adapted) -> Path:
    """p (2, vertices), t (3, cells), times (steps + 1,), u (steps + 1, 2, vertices), shares (cells,) and in_time."""
    space = found.computed.space
    content = {
        "p": found.mesh.p,
        "t": found.mesh.t,
        "times": np.linspace(0, found.computed.T, found.computed.steps + 1),
        "u": np.array([space.nodal(u) for u in found.computed.nodes]),
        "shares": found.shares.cells,
        "in_time": np.array(found.shares.time),
    }
    return write_whole(stage_file(directory, number), partial(_save, content=content))


def _save(path: Path, content: dict[str, Array]) -> None:
    with path.open("wb") as file:
        np.savez_compressed(file, **content)  # type: ignore[arg-type]


def contact_edges(data: Data, mesh: Mesh, displacement: Array) -> tuple[Array, Array]:
    """The edges of Γ3, their ends (2, 2, n), and which of them are in contact at both ends, (n,).

    Args:
        displacement: at the vertices, (2, vertices).
    """
    ends, closed = [], []
    size = max(float(abs(displacement).max()), np.finfo(float).tiny)
    for part, facets in zip(data.body.parts, boundary_parts(mesh, data.body), strict=True):
        if part.kind is Kind.CONTACT:
            vertices = mesh.facets[:, facets]
            ends.append(mesh.p[:, vertices])
            opening = -np.einsum("d,den->en", part.normal, displacement[:, vertices])
            closed.append((opening <= TOUCHING * size).all(axis=0))
    return np.concatenate(ends, axis=2), np.concatenate(closed)
