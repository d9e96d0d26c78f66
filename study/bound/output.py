"""What ``study bound`` prints and writes: the bounds over time, a table of levels and the computed displacements."""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd

from manufactured.tensors import Array
from study.bound.bounded import BoundedSolution
from study.bound.enclosing import order
from study.ledger.files import write_text, write_whole
from study.ledger.rounding import down, interval, up

LINES = 8
"""Times in the printed table."""
DIGITS = 9
"""Decimals in files."""
SHOWN = 4
"""Significant digits of bounds in the printed table."""


def series(level: int, found: BoundedSolution) -> pd.DataFrame:
    """``enclosure.csv``: the bounds of one level, one row for each knot of ũ."""
    enclosure, plain = found.enclosure, found.plain
    frame = pd.DataFrame(
        {
            "level": level,
            "time": enclosure.times,
            "error": enclosure.error,
            "lower": enclosure.lower,
            "upper": enclosure.upper,
            "distance": enclosure.distance,
            "bound": enclosure.bound,
            "plain": plain.bound_at(enclosure.times),
        }
    )
    # Ends are rounded away from what they enclose.
    below, above = ["lower"], ["upper", "bound", "plain"]
    frame[below] = np.floor(frame[below] * 10**DIGITS) / 10**DIGITS
    frame[above] = np.ceil(frame[above] * 10**DIGITS) / 10**DIGITS
    return frame.round({name: DIGITS for name in ("time", "error", "distance")})


def levels(found: dict[int, BoundedSolution]) -> pd.DataFrame:
    """``levels.csv``: for each level intervals of max_t ‖u − u_h‖_V and of its observed order since the first level."""
    rows, first = [], next(iter(found.values())).enclosure
    for level, one in found.items():
        low, high = order(first, one.enclosure) if one.enclosure is not first else (math.nan, math.nan)
        rows.append(
            {
                "level": level,
                "h": one.enclosure.h,
                "dofs": one.computed.space.dofs,
                "steps": one.computed.steps,
                "error": one.enclosure.error.max(),
                "lowest": one.enclosure.lowest,
                "highest": one.enclosure.highest,
                "plain": one.plain.highest,
                "order_low": low,
                "order_high": high,
            }
        )
    return pd.DataFrame(rows)


def text(name: str, table: pd.DataFrame, over_time: pd.DataFrame) -> str:
    """What is printed, from the tables of ``levels`` and ``series``."""
    known = bool(table["error"].notna().all())
    lines = [f"{name}: ‖u(t) − u_h(t)‖_V enclosed, {'exact solution known' if known else 'solution unknown'}", ""]
    finest = over_time[over_time["level"] == over_time["level"].max()]
    places = np.unique(np.linspace(0, len(finest) - 1, LINES).round().astype(int))
    head = f"{'t':>8} {'lower':>10} {'error':>10} {'upper':>10} {'upper/lower':>12} {'from u_h alone':>15}"
    lines += [f"level {finest['level'].iloc[0]}", head]
    for row in finest.iloc[places].itertuples():
        error = f"{row.error:10.4g}" if known else f"{'unknown':>10}"
        ratio = f"{row.upper / row.lower:12.3f}" if row.lower > 0 else f"{'∞':>12}"
        ends = down(row.lower, SHOWN), up(row.upper, SHOWN), up(row.plain, SHOWN)
        lines.append(f"{row.time:8.4f} {ends[0]:>10} {error} {ends[1]:>10} {ratio} {ends[2]:>15}")
    lines += [
        "",
        f"{'level':>8} {'max error in':>24} {'error':>10} {'from u_h alone':>15}   order since the first level in",
    ]
    for row in table.itertuples():
        error = f"{row.error:10.4g}" if known else f"{'unknown':>10}"
        orders = "" if math.isnan(row.order_low) else interval(row.order_low, row.order_high, SHOWN)
        largest = interval(row.lowest, row.highest, SHOWN)
        lines.append(f"{row.level:8d} {largest:>24} {error} {up(row.plain, SHOWN):>15}   {orders}")
    return "\n".join(lines)


def write(
    directory: Path, table: pd.DataFrame, over_time: pd.DataFrame, found: dict[int, BoundedSolution]
) -> list[Path]:
    """levels.csv, enclosure.csv and trajectory-LEVEL.npz: the mesh, the times and the nodal values of u_h.

    The arrays of a trajectory are p (2, vertices), t (3, cells), times (steps + 1,), u (steps + 1, 2, vertices).
    """
    written = [
        write_text(directory / "levels.csv", table.to_csv(index=False)),
        write_text(directory / "enclosure.csv", over_time.to_csv(index=False)),
    ]
    for level, one in found.items():
        space = one.computed.space
        values = np.array([space.nodal(u) for u in one.computed.nodes])
        times = np.linspace(0, one.computed.T, len(values))
        content = {"p": space.mesh.p, "t": space.mesh.t, "times": times, "u": values}
        written.append(write_whole(directory / f"trajectory-{level}.npz", partial(_save, content=content)))
    return written


def _save(path: Path, content: dict[str, Array]) -> None:
    with path.open("wb") as file:
        np.savez_compressed(file, **content)  # type: ignore[arg-type]
