"""The command ``study bound``: compute a displacement and bounds of its error on each level; write tables."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from manufactured.body import Body, Kind
from manufactured.case import Case
from manufactured.data import Data
from manufactured.tensors import Array
from study.bound.discretisation import Discretisation, refuse_unserved
from study.bound.enclosing import (
    Enclosure,
    compute_static,
    enclose,
    enclose_static,
    known_error,
    order_interval,
    relative,
)
from study.bound.problem import BoundError, require_ordered
from study.bound.ranges import require_continuous_start
from study.bound.trajectory import Computed, Refined, SmoothedInTime, compute
from study.fem.mesh import FAMILIES, MeshFamily, boundary_parts
from study.ledger.files import write_text, write_whole
from study.solve.evolution import Scheme
from study.solve.steps import rate_steps, require_steps

WRITTEN_DECIMALS = 9
"""Number of decimals in the files that the command writes."""
INSIDE = 1e-12
"""Penetration of the foundation up to this fraction of the largest displacement counts as round-off."""
EQUAL = 1e-9
"""Time steps count as equal if their relative difference is at most this number."""
SMALLER = 0.95
"""An observed order is computed from two meshes only if the ratio of their mesh sizes, fine/coarse, is at most this."""
ON_LINE = 1e-9
"""A side of the body counts as lying on a line up to this distance, relative to the size of the body."""


@dataclass(frozen=True, eq=False)
class BoundedSolution:
    """A computed displacement u_h with two bounds of its error.

    Attributes:
        computed: the displacement u_h.
        plain: the bound that is computed from u_h alone; None if there is none.
        enclosure: the lower and upper bounds that are computed with the help of a second, more accurate displacement.
        remarks: sentences for the user, for example why ``plain`` is None.
    """

    computed: Computed
    plain: Enclosure | None
    enclosure: Enclosure
    remarks: tuple[str, ...] = ()

    @property
    def error(self) -> tuple[float, float]:
        """An interval that contains the largest error max_t ‖u(t) − u_h(t)‖_V of the displacement u_h.

        Each end of the interval is the sharper of the two bounds ``plain`` and ``enclosure``.
        """
        return self._sharpest(lambda bound: (bound.lowest, bound.highest))

    @property
    def norm(self) -> tuple[float, float]:
        """An interval that contains the norm max_t ‖u(t)‖_V of the exact solution u.

        Each end of the interval is the sharper of the two bounds ``plain`` and ``enclosure``.
        """
        return self._sharpest(lambda bound: bound.norm)

    def _sharpest(self, ends: Callable[[Enclosure], tuple[float, float]]) -> tuple[float, float]:
        """Return the intersection of the intervals that follow from both bounds; each of the intervals is valid."""
        lows, highs = zip(*(ends(bound) for bound in (self.enclosure, self.plain) if bound), strict=True)
        require_ordered(max(lows), min(highs))
        return max(lows), min(highs)

    @property
    def relative(self) -> tuple[float, float]:
        """An interval that contains the relative error max_t ‖u(t) − u_h(t)‖_V / max_t ‖u(t)‖_V of u_h."""
        return relative(self.error, self.norm)


def steps_on(data: Data, level: int, wanted: int | None) -> int:
    """Return the number of time steps of the computed displacement on the mesh of a level.

    Args:
        data: the problem. For a static problem the result is 1.
        level: the level of the mesh.
        wanted: the number that the user wants; None for the number that ``rate_steps`` gives for this level.
    """
    return (wanted or rate_steps(data.body.T, level)) if data.in_time else 1


def check_bound(data: Data, family: MeshFamily, levels: Sequence[int], steps: int | None, refined: Refined) -> None:
    """Refuse a problem or options for which no error bound can be computed, before time is spent.

    Args:
        data: the data of the problem.
        family: the mesh family.
        levels: the levels of the meshes, which must increase.
        steps: the number of time steps of u_h; None if it follows from the level.
        refined: how the mesh and the time steps are refined for the bound.

    Raises:
        BoundError: there are invalid levels, steps or refinements; T, a body or a law of extreme size; a mesh family
            that cannot mesh the body; a body in 3D; or a law without a usable monotonicity constant.
        LoadError: no solution can exist for the data.
        MeshError: a mesh does not fit the parts of the body.
    """
    if not levels or min(levels) < 2 or any(b <= a for a, b in pairwise(levels)):
        raise BoundError(f"levels must be 2 or more and increase, got {' '.join(map(str, levels))}")
    check_problem(data, steps, refined)
    if not family.serves(data.body):
        served = ", ".join(known.name for known in FAMILIES if known.serves(data.body))
        raise BoundError(f"the family {family.name} does not mesh this body; take one of {served or 'none'}")
    for level in levels:
        boundary_parts(Discretisation(data, family(data.body, level)).mesh, data.body)


def check_problem(data: Data, steps: int | None, refined: Refined) -> None:
    """Refuse a problem or a number of time steps for which no error bound can be computed on any mesh.

    Args:
        data: the data of the problem.
        steps: the number of time steps of u_h; None if it follows from the level.
        refined: how the mesh and the time steps are refined for the bound.

    Raises:
        BoundError: no bound can be computed; the message names the reason.
        LoadError: no solution can exist for the data.
    """
    if steps is not None:
        require_steps(steps * refined.shorter)
    refuse_unserved(data)
    data.check()
    require_continuous_start(data)


def bounded_solution(
    data: Data,
    case: Case | None,
    family: MeshFamily,
    level: int,
    scheme: Scheme,
    steps: int,
    refined: Refined,
    progress: Callable[[float], object] = lambda time: None,
) -> BoundedSolution:
    """Compute the displacement u_h on one level and both bounds of its error.

    Args:
        data: the problem.
        case: the case if the exact solution is known, otherwise None; the true error is then reported as well.
        family: the mesh family.
        level: the level of the mesh.
        scheme: the time scheme of u_h.
        steps: the number of time steps of u_h.
        refined: how the more accurate displacement ũ is computed.
        progress: a function that is called with each time up to which the enclosure is computed.
    """
    discretisation = Discretisation(data, family(data.body, level))
    computed = compute(discretisation, scheme, steps) if data.in_time else compute_static(discretisation)
    return both_bounds(discretisation, computed, refined, known_error(case, computed), progress)


def both_bounds(
    coarse: Discretisation,
    computed: Computed,
    refined: Refined,
    error: Callable[[float, Array], float] | None,
    progress: Callable[[float], object],
) -> BoundedSolution:
    """Return two bounds of the error of a displacement u_h: from u_h alone, and by a more accurate displacement ũ.

    Args:
        coarse: the problem and the mesh of u_h.
        computed: the displacement u_h.
        refined: how ũ is computed. For a static problem, ũ is the solution of degree 2 on the refined mesh.
        error: the function (t, u_h(t)) ↦ ‖u(t) − u_h(t)‖_V if the exact solution is known; it is not used for static
            problems.
        progress: a function that is called with each time up to which the enclosure is computed. For a static problem
            it is called with T/4 after the bound from u_h alone, and with T at the end.
    """
    T = coarse.data.body.T
    why = why_no_plain(coarse, computed)
    remarks = (f"the bound from u_h alone is left out: {why} (the interval does not need this bound)",) if why else ()
    try:
        if coarse.data.in_time:
            plain = None if why else enclose(coarse, computed, SmoothedInTime(), error)
            enclosure = enclose(coarse, computed, refined, error, progress)
        else:
            plain = None if why else enclose_static(coarse, computed, None)[0]
            progress(T / 4)
            enclosure, _ = enclose_static(coarse, computed, refined.refinements)
            progress(T)
    except np.linalg.LinAlgError as error_of_matrix:
        raise BoundError(
            "the mesh has triangles so thin that ũ cannot be computed in double precision: remove them"
        ) from error_of_matrix
    return BoundedSolution(computed, plain, enclosure, remarks)


def why_no_plain(coarse: Discretisation, computed: Computed) -> str:
    """Return the reason why no error bound can be computed from u_h alone; an empty text if it can be computed.

    Args:
        coarse: the problem on the mesh of u_h.
        computed: the displacement u_h.
    """
    steps = np.diff(computed.times)
    if abs(steps - steps.mean()).max() > EQUAL * steps.mean():
        return "its time steps are not equal"
    u_h = computed.on(coarse)
    normal = coarse.displacements.N @ np.array([u_h(time) for time in computed.times]).T
    if normal.max(initial=0.0) > INSIDE * abs(computed.nodes).max():
        return f"u_h {'penetrates' if computed.degree == 1 else 'of degree 2 may penetrate'} the foundation"
    return ""


def series(level: int, solution: BoundedSolution) -> pd.DataFrame:
    """Return the rows of ``enclosure.csv`` for one level: the bounds of the error at every time of the enclosure.

    Args:
        level: the level of the mesh.
        solution: the displacement u_h and the bounds of its error.
    """
    enclosure = solution.enclosure
    frame = pd.DataFrame({"level": level, "time": enclosure.times})
    for name in ("error", "lower", "distance", "bound"):
        frame[name] = getattr(enclosure, name)
    frame["plain"] = solution.plain.bound_at(enclosure.times) if solution.plain else math.nan
    frame["upper"] = np.fmin(enclosure.upper, frame["plain"])
    low, high = relative((frame["lower"], frame["upper"]), solution.norm)
    frame["percent_low"] = 100 * low
    frame["percent_high"] = 100 * high
    # Rounding outward, because the printed interval must contain the computed one.
    unit = 10**WRITTEN_DECIMALS
    below = ["lower", "percent_low"]
    above = ["upper", "bound", "plain", "percent_high"]
    frame[below] = np.floor(frame[below] * unit) / unit
    frame[above] = np.ceil(frame[above] * unit) / unit
    return frame.round(dict.fromkeys(("time", "error", "distance"), WRITTEN_DECIMALS))


def record(level: int, solution: BoundedSolution) -> dict[str, Any]:
    """Return the results on one level as a dict, from which tables and text are made.

    Args:
        level: the level of the mesh.
        solution: the displacement and the bounds of its error.

    Returns:
        ``row``: the row of ``levels.csv`` without orders; ``series``: the rows of ``enclosure.csv``; ``inside``:
        whether the error lies between its bounds, if the error is known; ``sentences``: texts that say whether the
        bounds are guaranteed; ``on_cells``: for static problems the squared distance ‖ũ − u_h‖² of u_h from the more
        accurate displacement ũ on every cell.
    """
    enclosure = solution.enclosure
    lowest, highest = solution.error
    norm_low, norm_high = solution.norm
    low, high = solution.relative
    row = {
        "level": level,
        "h": enclosure.h,
        "dofs": solution.computed.space.dofs,
        "steps": len(solution.computed.times) - 1,
        "error": float(enclosure.error.max()),
        "lowest": lowest,
        "highest": highest,
        "plain": solution.plain.highest if solution.plain else math.nan,
        "norm_low": norm_low,
        "norm_high": norm_high,
        "percent_low": 100 * low,
        "percent_high": 100 * high,
        "kind": enclosure.evidence.kind,
    }
    return {
        "row": row,
        "series": series(level, solution).to_dict("list"),
        "inside": enclosure.contains and (solution.plain is None or solution.plain.contains),
        "sentences": [*enclosure.evidence.sentences, *solution.remarks],
        "on_cells": enclosure.on_cells.tolist(),
    }


def levels(rows: Sequence[dict[str, Any]]) -> pd.DataFrame:
    """Return the table ``levels.csv``: for each level, intervals that contain the error and two observed orders.

    The columns ``order_…`` compare a level with the first one, the columns ``pair_…`` with the previous one. The error
    is the largest one over time. On the first level, and if a mesh is not finer than the mesh to compare with, the
    order is NaN.

    Args:
        rows: for each level, in the order of the levels, the entry "row" of the result of ``record``.
    """
    table = pd.DataFrame(rows)
    table[["order_low", "order_high"]] = [_order(rows[0], row) for row in rows]
    previous = [rows[0], *rows[:-1]]
    table[["pair_low", "pair_high"]] = list(map(_order, previous, rows))
    table["kind"] = table.pop("kind")  # the last column
    return table


def _order(coarse: dict[str, Any], fine: dict[str, Any]) -> tuple[float, float]:
    """Return the interval of the order between two meshes, from their rows; NaN if the second mesh is not finer."""
    if fine["h"] >= SMALLER * coarse["h"]:
        return math.nan, math.nan
    before = coarse["lowest"], coarse["highest"]
    after = fine["lowest"], fine["highest"]
    return order_interval(before, after, math.log(coarse["h"] / fine["h"]))


def contact_sentences(body: Body) -> list[str]:
    """Return a list with a sentence about the shape of the foundation if the contact boundary does not lie on one line.

    Otherwise the list is empty.

    Args:
        body: the body, which has the contact boundary.
    """
    sides = body.of(Kind.CONTACT)
    distances = [abs(sides[0].coordinates(side.corners)[1]).max() for side in sides]
    if max(distances, default=0.0) <= ON_LINE * body.extent:
        return []
    return [
        f"The {len(sides)} CONTACT sides do not lie on one line. Each point of a side may not cross the line through "
        "that side: the sides touch a foundation of their own shape (a curved one, if they follow a curve), not one "
        "flat floor"
    ]


def write(directory: Path, table: pd.DataFrame, over_time: pd.DataFrame) -> list[Path]:
    """Write the tables ``levels.csv`` and ``enclosure.csv`` to a directory, and return their paths.

    Args:
        directory: the directory.
        table: the table ``levels.csv`` with one row for each level, from ``levels``.
        over_time: the table ``enclosure.csv`` with one row for each level and time.
    """
    files = {"levels.csv": table, "enclosure.csv": over_time}
    return [write_text(directory / name, rows.to_csv(index=False)) for name, rows in files.items()]


def trajectory_file(directory: Path, level: int) -> Path:
    """Return the path of the file with the displacement u_h of a level."""
    return directory / f"trajectory-{level}.npz"


def write_displacement(path: Path, computed: Computed, **more: Array) -> Path:
    """Write the displacement u_h to an .npz file and return its path.

    The file contains the mesh, p (2, vertices) and t (3, cells), the times (steps + 1,), and the values at the
    vertices, u (steps + 1, 2, vertices).

    Args:
        path: the path of the file.
        computed: the displacement u_h.
        more: further arrays for the file, by their names.
    """
    mesh = computed.mesh
    arrays = {"p": mesh.p, "t": mesh.t, "times": computed.times, "u": computed.at_vertices, **more}

    def save(path: Path) -> None:
        with path.open("wb") as file:
            np.savez_compressed(file, **arrays)  # type: ignore[arg-type]

    return write_whole(path, save)
