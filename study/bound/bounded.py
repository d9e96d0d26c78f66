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

from manufactured.body import Body, Kind
from manufactured.case import Case
from manufactured.data import Data
from manufactured.static import Static
from manufactured.tensors import Array
from study.bound.discretisation import Discretisation, refuse_initial_gap, refuse_solids
from study.bound.enclosing import Enclosure, enclose, known_error, order_interval
from study.bound.problem import BoundError, require_units
from study.bound.static import compute_static, enclose_static
from study.bound.trajectory import Computed, DiscreteSolution, Refined, SmoothedInTime, compute
from study.fem.mesh import FAMILIES, MeshFamily, boundary_parts
from study.ledger.files import write_text, write_whole
from study.ledger.text import down, interval, up, width
from study.solve.evolution import Scheme
from study.solve.steps import rate_steps, require_steps

LINES = 8
"""Number of times in the printed table."""
DIGITS = 9
"""Decimals in files."""
SHOWN, PERCENT = 4, 3
"""Significant digits of bounds, and of bounds in per cent, in the printed table."""
MOVING, STATIC = "‖u(t) − u_h(t)‖_V", "‖u − u_h‖_G"
"""The norm of an error that moves, and the energy norm of static elasticity, in the printed text."""
INSIDE = 1e-12
"""Penetration, relative to the largest displacement, that counts as rounding."""
SMALLER = 0.95
"""Largest ratio of two mesh sizes that have an order."""
ON_LINE = 1e-9
"""Distance, relative to the body, up to which a side lies on a line."""


@dataclass(frozen=True, eq=False)
class BoundedSolution:
    """u_h, the bound of its error from u_h alone, and the enclosure by a displacement closer to u.

    ``plain`` is None if u_h alone gives no bound; a sentence of ``remarks`` then says why.
    """

    computed: Computed
    plain: Enclosure | None
    enclosure: Enclosure
    remarks: tuple[str, ...] = ()

    @property
    def relative(self) -> tuple[float, float]:
        """An interval that contains max_t ‖u(t) − u_h(t)‖_V / max_t ‖u(t)‖_V, by the better of the two bounds."""
        both = [self.enclosure.relative, *([self.plain.relative] if self.plain else [])]
        return max(low for low, _ in both), min(high for _, high in both)


def norm_of(data: Data) -> str:
    """Return the norm in which errors are bounded, for texts: ``STATIC`` or ``MOVING``."""
    return STATIC if isinstance(data, Static) else MOVING


def steps_on(data: Data, level: int, wanted: int | None) -> int:
    """Return the number of time steps of u_h on a level: as wanted, or by the rule of the study; 1 without time."""
    return 1 if isinstance(data, Static) else wanted or rate_steps(data.body.T, level)


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
    check_problem(data, steps, refined)
    if not family.serves(data.body):
        served = ", ".join(known.name for known in FAMILIES if known.serves(data.body))
        raise BoundError(f"the family {family.name} does not mesh this body; take one of {served or 'none'}")
    for level in levels:
        boundary_parts(Discretisation(data, family(data.body, level)).mesh, data.body)


def check_problem(data: Data, steps: int | None, refined: Refined) -> None:
    """Refuse problems, steps and refinements for which no bound can be given on any mesh.

    Raises:
        BoundError: says which.
        LoadError: data to which no solution can belong.
    """
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
    refuse_initial_gap(data)
    require_units(data)
    data.check()


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
    if isinstance(data, Static):
        return bounded_static(discretisation, compute_static(discretisation), refined.refinements)
    computed = compute(discretisation, scheme, steps)
    error = known_error(case, computed)
    return BoundedSolution(
        computed,
        enclose(discretisation, computed, SmoothedInTime(), error),
        enclose(discretisation, computed, refined, error, progress),
    )


def bounded_static(coarse: Discretisation, computed: Computed, refinements: int) -> BoundedSolution:
    """Return both bounds of the error of a static displacement; from u_h alone only if it lies in K."""
    V, u_h = coarse.displacements, computed.on(coarse)(0.0)
    penetrates = float((V.N @ u_h).max(initial=0.0)) > INSIDE * float(abs(u_h).max())
    plain = None if penetrates else enclose_static(coarse, computed, None)[0]
    remarks = ("the bound from u_h alone is left out: u_h penetrates the foundation",) if penetrates else ()
    return BoundedSolution(computed, plain, enclose_static(coarse, computed, refinements)[0], remarks)


def series(level: int, found: BoundedSolution) -> pd.DataFrame:
    """Return the rows of ``enclosure.csv`` for one level: the bounds at each knot of ũ."""
    enclosure = found.enclosure
    columns = {name: getattr(enclosure, name) for name in ("error", "lower", "upper", "distance", "bound")}
    columns |= {"plain": found.plain.bound_at(enclosure.times) if found.plain else math.nan}
    size = enclosure.norm
    columns |= {"percent_low": 100 * enclosure.lower / size[1] if size[1] > 0 else 0.0}
    columns |= {"percent_high": 100 * enclosure.upper / size[0] if size[0] > 0 else math.inf}
    frame = pd.DataFrame({"level": level, "time": enclosure.times} | columns)
    # Ends are rounded outward.
    below, above = ["lower", "percent_low"], ["upper", "bound", "plain", "percent_high"]
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
        "dofs": found.computed.nodes.shape[1],
        "steps": len(found.computed.times) - 1,
        "error": float(enclosure.error.max()),
        "lowest": enclosure.lowest,
        "highest": enclosure.highest,
        "plain": found.plain.highest if found.plain else math.nan,
        "norm_low": enclosure.norm[0],
        "norm_high": enclosure.norm[1],
        "percent_low": 100 * found.relative[0],
        "percent_high": 100 * found.relative[1],
        "kind": enclosure.evidence.kind,
    }
    return {
        "row": row,
        "series": series(level, found).to_dict("list"),
        "inside": enclosure.contains and (found.plain is None or found.plain.contains),
        "sentences": [*enclosure.evidence.sentences, *found.remarks],
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
    """The interval of the order between two levels; NaN without a coarser mesh before."""
    if coarse is None or not fine["h"] < SMALLER * coarse["h"]:
        return math.nan, math.nan
    before, after = ((one["lowest"], one["highest"]) for one in (coarse, fine))
    return order_interval(before, after, math.log(coarse["h"] / fine["h"]))


def text(name: str, table: pd.DataFrame, over_time: pd.DataFrame, sentences: Sequence[str], norm: str = MOVING) -> str:
    """Return the printed text, from the tables of ``levels`` and ``series`` and the sentences on the evidence.

    Args:
        norm: the norm of the error, ``MOVING`` or ``STATIC``.
    """
    known = bool(table["error"].notna().all())
    last = table.iloc[-1]
    size = "‖u‖_G" if norm == STATIC else "max ‖u(t)‖_V"
    lines = [
        f"{name}: {norm} enclosed, {'exact solution known' if known else 'solution unknown'}",
        *(textwrap.fill(sentence, width()) for sentence in sentences),
        f"% of u: per cent of {size}, which lies in {interval(last['norm_low'], last['norm_high'], SHOWN)}",
        "",
    ]
    moving = norm != STATIC
    # A static problem has one time, whose line is in the last table as well.
    over = [*_over_time(over_time, known), ""] if moving else []
    return "\n".join([*lines, *over, *_intervals(table, known, moving)])


def _over_time(over_time: pd.DataFrame, known: bool) -> list[str]:
    """Lines with the enclosure at some times on the finest level."""
    finest = over_time[over_time["level"] == over_time["level"].max()]
    places = np.unique(np.linspace(0, len(finest) - 1, LINES).round().astype(int))
    head = f"{'t':>7} {'lower':>9} {'error':>9} {'upper':>9} {'% of u':>15} {'upper/lower':>11}"
    lines = [f"level {finest['level'].iloc[0]}", f"{head} {'from u_h alone':>14}"]
    for row in finest.iloc[places].itertuples():
        error = f"{row.error:9.4g}" if known else f"{'unknown':>9}"
        ratio = f"{row.upper / row.lower:11.3f}" if row.lower > 0 else f"{'∞':>11}"
        ends = f"{down(row.lower, SHOWN):>9} {error} {up(row.upper, SHOWN):>9}"
        percent = _percent(row.percent_low, row.percent_high)
        lines.append(f"{row.time:7.4f} {ends} {percent:>15} {ratio} {_plain(row.plain):>14}")
    return lines


def _intervals(table: pd.DataFrame, known: bool, moving: bool = True) -> list[str]:
    """Lines with the intervals of the error on each level, and of the orders since the first and the previous level."""
    several, since = len(table) > 2, f"order since {table['level'].iloc[0]}"
    largest = "max error in" if moving else "error in"
    head = f"{'level':>5} {largest:>19} {'% of u':>15} {'error':>7} {'from u_h alone':>14} {since:>15}"
    lines = [head + (f" {'since the one before':>20}" if several else "")]
    for row in table.itertuples():
        error = f"{row.error:.4g}" if known else "unknown"
        orders = _shown(row.order_low, row.order_high, 15)
        if several:
            orders += f" {_shown(row.pair_low, row.pair_high, 20)}"
        ends, percent = interval(row.lowest, row.highest, SHOWN), _percent(row.percent_low, row.percent_high)
        line = f"{row.level:5d} {ends:>19} {percent:>15} {error:>7} {_plain(row.plain):>14} {orders}"
        lines.append(line.rstrip())
    if len(table) > 1 and moving:
        steps = "the same steps on every mesh" if table["steps"].nunique() == 1 else "steps that follow the mesh"
        lines += ["", f"orders of the fully discrete u_h, with {steps}"]
    return lines


def _plain(bound: float) -> str:
    return "left out" if math.isnan(bound) else up(bound, SHOWN)


def _percent(low: float, high: float) -> str:
    return interval(low, high, PERCENT) if high < math.inf else f"[{down(low, PERCENT)}, ∞]"


def _shown(low: float, high: float, columns: int) -> str:
    return f"{'' if math.isnan(low) else interval(low, high, SHOWN):>{columns}}"


def contact_sentences(body: Body) -> list[str]:
    """Return a sentence on the foundation if the sides of Γ3 do not lie on one line."""
    sides = body.of(Kind.CONTACT)
    first, reach = sides[0], ON_LINE * float(np.ptp(body.vertices, axis=1).max())
    if all(abs(first.coordinates(side.corners)[1]).max() <= reach for side in sides):
        return []
    return [
        f"Γ3 has {len(sides)} sides that do not lie on one line. Each point of a side may not cross the line through "
        "that side: the sides touch a foundation of the shape of Γ3 (a curved one, if they follow a curve), not one "
        "flat floor"
    ]


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
    assert isinstance(found.computed, DiscreteSolution)
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
