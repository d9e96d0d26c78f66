"""The command ``study bound``: a displacement with bounds of its error on each level, tables, text and files."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from manufactured.case import Case
from manufactured.data import Data
from manufactured.tensors import Array
from study.bound.discretisation import Discretisation, refuse_solids
from study.bound.enclosing import Enclosure, enclose, known_error, order_interval
from study.bound.problem import BoundError, require_units
from study.bound.trajectory import DiscreteSolution, Refined, SmoothedInTime, compute
from study.fem.mesh import FAMILIES, MeshFamily, boundary_parts
from study.ledger.files import write_text, write_whole
from study.ledger.text import down, interval, up, width
from study.solve.evolution import Scheme
from study.solve.steps import require_steps

LINES = 8
"""Number of times in the printed table."""
DIGITS = 9
"""Decimals in files."""
SHOWN = 4
"""Significant digits of bounds in the printed table."""


@dataclass(frozen=True, eq=False)
class BoundedSolution:
    """u_h, the bound of its error from u_h alone, and the enclosure by a displacement closer to u."""

    computed: DiscreteSolution
    plain: Enclosure
    enclosure: Enclosure


def check_bound(data: Data, family: MeshFamily, levels: Sequence[int], steps: int | None, refined: Refined) -> None:
    """Refuse problems and options for which no bound can be given, before time is spent.

    Raises:
        BoundError: levels, steps or refinements that make no sense, T, a body or a law of extreme size, a family that
            does not serve the body, a body in 3D or a law without a usable monotonicity constant.
        LoadError: data to which no solution can belong.
        MeshError: a mesh does not fit the parts of the body.
    """
    if not levels or min(levels) < 2 or any(b <= a for a, b in pairwise(levels)):
        raise BoundError(f"levels must be 2 or more and increase, got {' '.join(map(str, levels)) or 'none'}")
    if steps is not None:
        if steps < 1:
            raise BoundError(f"--steps must be 1 or more, got {steps}")
        require_steps(steps * refined.shorter)
    if refined.refinements < 0 or refined.shorter < 1:
        raise BoundError(
            "ũ needs 0 or more refinements and 1 or more steps in one of u_h, "
            f"got {refined.refinements} and {refined.shorter}"
        )
    refuse_solids(data)
    require_units(data)
    data.check()
    if not family.serves(data.body):
        served = ", ".join(known.name for known in FAMILIES if known.serves(data.body))
        raise BoundError(f"the family {family.name} does not mesh this body; take one of {served or 'none'}")
    for level in levels:
        boundary_parts(Discretisation(data, family(data.body, level)).mesh, data.body)


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
    """Compute u_h and both bounds; ``progress`` is called with the times of the enclosure that are done."""
    discretisation = Discretisation(data, family(data.body, level))
    computed = compute(discretisation, scheme, steps)
    error = known_error(case, computed)
    return BoundedSolution(
        computed,
        enclose(discretisation, computed, SmoothedInTime(), error),
        enclose(discretisation, computed, refined, error, progress),
    )


def series(level: int, found: BoundedSolution) -> pd.DataFrame:
    """Return the rows of ``enclosure.csv`` for one level: the bounds at each knot of ũ."""
    enclosure = found.enclosure
    columns = {name: getattr(enclosure, name) for name in ("error", "lower", "upper", "distance", "bound")}
    columns |= {"plain": found.plain.bound_at(enclosure.times)}
    frame = pd.DataFrame({"level": level, "time": enclosure.times} | columns)
    # Ends are rounded outward.
    below, above = ["lower"], ["upper", "bound", "plain"]
    frame[below] = np.floor(frame[below] * 10**DIGITS) / 10**DIGITS
    frame[above] = np.ceil(frame[above] * 10**DIGITS) / 10**DIGITS
    return frame.round({name: DIGITS for name in ("time", "error", "distance")})


def record(level: int, found: BoundedSolution) -> dict[str, Any]:
    """Return the record of a level, from which tables and text are made.

    Keys: ``row`` of ``levels.csv`` without orders; ``series``, the level's part of ``enclosure.csv``; ``inside``,
    whether a known error lies inside; ``sentences`` on the evidence for the bounds.
    """
    enclosure = found.enclosure
    row = {
        "level": level,
        "h": enclosure.h,
        "dofs": found.computed.space.dofs,
        "steps": found.computed.steps,
        "error": float(enclosure.error.max()),
        "lowest": enclosure.lowest,
        "highest": enclosure.highest,
        "plain": found.plain.highest,
        "kind": enclosure.evidence.kind,
    }
    return {
        "row": row,
        "series": series(level, found).to_dict("list"),
        "inside": enclosure.contains and found.plain.contains,
        "sentences": list(enclosure.evidence.sentences),
    }


def levels(rows: Sequence[dict[str, Any]]) -> pd.DataFrame:
    """Return ``levels.csv``: for each level intervals of max_t ‖u − u_h‖_V and of two observed orders.

    ``order`` is the order since the first level, ``pair`` the order since the level before.
    """
    table = pd.DataFrame(rows)
    for name, earlier in (("order", [None] + [rows[0]] * (len(rows) - 1)), ("pair", [None, *rows[:-1]])):
        spans = [_order(coarse, fine) for coarse, fine in zip(earlier, rows, strict=True)]
        table[f"{name}_low"], table[f"{name}_high"] = zip(*spans, strict=True)
    return table[[name for name in table if name != "kind"] + ["kind"]]


def _order(coarse: dict[str, Any] | None, fine: dict[str, Any]) -> tuple[float, float]:
    """The interval of the order between two levels; NaN without a coarser level."""
    if coarse is None:
        return math.nan, math.nan
    before, after = ((one["lowest"], one["highest"]) for one in (coarse, fine))
    return order_interval(before, after, math.log(coarse["h"] / fine["h"]))


def text(name: str, table: pd.DataFrame, over_time: pd.DataFrame, sentences: Sequence[str]) -> str:
    """Return the printed text, from the tables of ``levels`` and ``series`` and the sentences on the evidence."""
    known = bool(table["error"].notna().all())
    lines = [
        f"{name}: ‖u(t) − u_h(t)‖_V enclosed, {'exact solution known' if known else 'solution unknown'}",
        *(textwrap.fill(sentence, width()) for sentence in sentences),
        "",
    ]
    finest = over_time[over_time["level"] == over_time["level"].max()]
    places = np.unique(np.linspace(0, len(finest) - 1, LINES).round().astype(int))
    head = f"{'t':>8} {'lower':>10} {'error':>10} {'upper':>10} {'upper/lower':>12} {'from u_h alone':>15}"
    lines += [f"level {finest['level'].iloc[0]}", head]
    for row in finest.iloc[places].itertuples():
        error = f"{row.error:10.4g}" if known else f"{'unknown':>10}"
        ratio = f"{row.upper / row.lower:12.3f}" if row.lower > 0 else f"{'∞':>12}"
        ends = down(row.lower, SHOWN), up(row.upper, SHOWN), up(row.plain, SHOWN)
        lines.append(f"{row.time:8.4f} {ends[0]:>10} {error} {ends[1]:>10} {ratio} {ends[2]:>15}")
    return "\n".join([*lines, "", *_intervals(table, known)])


def _intervals(table: pd.DataFrame, known: bool) -> list[str]:
    """Lines with the intervals of the error on each level, and of the orders since the first and the previous level."""
    several, since = len(table) > 2, f"since level {table['level'].iloc[0]} in"
    head = f"{'level':>6} {'max error in':>22} {'error':>9} {'from u_h alone':>15}  {f'order {since}':>22}"
    lines = [head + (f"  {'since the one before in':>24}" if several else "")]
    for row in table.itertuples():
        error = f"{row.error:.4g}" if known else "unknown"
        orders = _shown(row.order_low, row.order_high, 22)
        if several:
            orders += f"  {_shown(row.pair_low, row.pair_high, 24)}"
        largest = interval(row.lowest, row.highest, SHOWN)
        lines.append(f"{row.level:6d} {largest:>22} {error:>9} {up(row.plain, SHOWN):>15}  {orders}".rstrip())
    if len(table) > 1:
        steps = "the same steps on every mesh" if table["steps"].nunique() == 1 else "steps that follow the mesh"
        lines += ["", f"orders of the fully discrete u_h, with {steps}"]
    return lines


def _shown(low: float, high: float, columns: int) -> str:
    return f"{'' if math.isnan(low) else interval(low, high, SHOWN):>{columns}}"


def write(directory: Path, table: pd.DataFrame, over_time: pd.DataFrame) -> list[Path]:
    """Write levels.csv and enclosure.csv and return their paths."""
    return [
        write_text(directory / "levels.csv", table.to_csv(index=False)),
        write_text(directory / "enclosure.csv", over_time.to_csv(index=False)),
    ]


def trajectory_file(directory: Path, level: int) -> Path:
    """Return the path of the displacement of a level."""
    return directory / f"trajectory-{level}.npz"


def write_trajectory(directory: Path, level: int, found: BoundedSolution) -> Path:
    """Write the displacement of a level (``write_displacement``) and return the path."""
    return write_displacement(trajectory_file(directory, level), found.computed)


def write_displacement(path: Path, computed: DiscreteSolution, **more: Array) -> Path:
    """Write the mesh, the times and the nodal values of u_h, and more arrays; return the path.

    The arrays are p (2, vertices), t (3, cells), times (steps + 1,), u (steps + 1, 2, vertices).
    """
    space = computed.space
    values = np.array([space.nodal(u) for u in computed.nodes])
    times = np.linspace(0, computed.T, len(values))
    arrays = {"p": space.mesh.p, "t": space.mesh.t, "times": times, "u": values, **more}

    def save(path: Path) -> None:
        with path.open("wb") as file:
            np.savez_compressed(file, **arrays)  # type: ignore[arg-type]

    return write_whole(path, save)
