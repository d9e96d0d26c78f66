"""The printed texts of ``study bound``: intervals of errors and orders, and whether they are guaranteed."""

import math
import textwrap
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
import pandas as pd

from study.ledger.text import down, interval, up, width

LINES = 8
"""The printed table shows the error at no more than this number of times."""
SHOWN, PERCENT, ENERGY = 4, 3, 6
"""Numbers of significant digits in printed texts: of error bounds, of error bounds in per cent, and of energies."""
NORM = {True: "‖u(t) − u_h(t)‖_V", False: "‖u − u_h‖_G"}
"""Whether a problem is in time ↦ the error in its norm; for static problems this is the energy norm."""
MEANING = {
    True: "norm: ‖v‖_V² = ∫ Aε(v)·ε(v), weighted by the viscosity A",
    False: "norm: ‖v‖_G² = ∫ Gε(v)·ε(v), weighted by the elasticity G (energy norm)",
}
"""Whether a problem is in time ↦ the definition of the norm."""
NAME = 20
"""Width, in characters, of the column with file names in the printed table."""


def text(
    name: str,
    table: pd.DataFrame,
    over_time: pd.DataFrame,
    sentences: Sequence[str],
    in_time: bool = True,
    names: Sequence[str] | None = None,
) -> str:
    """Return the printed text: the interval of the error, whether it is guaranteed, and one line for each mesh.

    Args:
        name: the name of the problem.
        table: the result of ``levels``.
        over_time: the results of ``series`` for all levels.
        sentences: texts that say whether the bounds are guaranteed.
        in_time: whether the problem is in time, and not static.
        names: for each row of the table, the name of the file with its displacement. By default rows are named by their
            levels.
    """
    known, last = table["error"].notna().all(), table.iloc[-1]
    size = "max ‖u(t)‖_V" if in_time else "‖u‖_G"
    share = f"% of u: per cent of {size}, which lies in {interval(last['norm_low'], last['norm_high'], SHOWN)}"
    if not in_time:
        energy = interval(last["norm_low"] ** 2, last["norm_high"] ** 2, ENERGY)
        share += f"; its square, the energy, lies in {energy}"
    lines = [f"{name}: {NORM[in_time]} enclosed, {'exact solution known' if known else 'solution unknown'}"]
    lines += [*(textwrap.fill(sentence, width()) for sentence in (*sentences, MEANING[in_time], share)), ""]
    # A static problem has one time only, and the last table already shows its enclosure.
    over = [*_over_time(over_time, known, names[-1] if names else ""), ""] if in_time else []
    return "\n".join([*lines, *over, *_intervals(table, known, in_time, names)])


def worst_tenth(squares: Sequence[float]) -> str:
    """Return a sentence on how much the worst tenth of the triangles contributes to ‖ũ − u_h‖².

    Args:
        squares: ‖ũ − u_h‖² on every triangle.
    """
    share = sum(sorted(squares)[-math.ceil(len(squares) / 10) :]) / sum(squares)
    return f"the worst tenth of the triangles has {100 * share:.0f} % of ‖ũ − u_h‖², as cells.png shows"


def adaptive_text(
    name: str, rows: pd.DataFrame, tolerance: str, stopped: str, sentences: Sequence[str], in_time: bool = True
) -> list[str]:
    """Return the printed lines: a verdict on the tolerance and on the bound, and one line for each mesh.

    The verdict says whether the tolerance is reached, and whether the bound is guaranteed.

    Args:
        name: the name of the problem.
        rows: the table ``adaptive.csv``.
        tolerance: the tolerance for the error bound, as text.
        stopped: why refinement ended before the tolerance was reached; empty if it was reached.
        sentences: texts that say whether the bound is guaranteed.
        in_time: whether the problem is in time, and not static.
    """
    sign, end = ("≤", "is reached") if not stopped else (">", f"is not reached: {stopped}")
    percents = [f"{up(percent, SHOWN)} %" if percent < math.inf else "∞" for percent in rows["percent"]]
    bound, known = up(rows["bound"].iloc[-1], SHOWN), rows["error"].notna().all()
    reached = f"{bound}, {percents[-1]} of u," if tolerance.endswith("%") else bound
    found = [f"{name}: {'max ' * in_time}{NORM[in_time]} ≤ {reached} {sign} {tolerance}, the tolerance {end}"]
    found += [*(textwrap.fill(sentence, width()) for sentence in sentences), ""]
    columns = {
        "mesh": rows["mesh"],
        "  cells": rows["cells"],
        "unknowns": rows["dofs"],
        " steps": rows["steps"] if in_time else None,
        "     bound": [up(bound, SHOWN) for bound in rows["bound"]],
        "   % of u": percents,
        " order": ["" if math.isnan(order) else f"{order:.2f}" for order in rows["order"]],
        " in time": [f"{100 * share:.1f} %" for share in rows["in_time"]] if in_time else None,
        "     error": [f"{error:.4g}" for error in rows["error"]] if known else None,
    }
    found += aligned({head: cells for head, cells in columns.items() if cells is not None})
    notes = "% of u: the bound over the least value that the norm of u can have", MEANING[in_time]
    return [*found, "", *notes, "order: of the bound in unknowns; 1/2 is the best possible for P1"]


def aligned(columns: Mapping[str, Iterable[object]]) -> list[str]:
    """Return the lines of a table whose cells are aligned on the right, below heads that are as wide as their column.

    Args:
        columns: the cells of each column, by its head; blanks in front of a head make the column wider.
    """
    widths = [len(head) for head in columns]
    lines = [columns, *zip(*columns.values(), strict=True)]
    return [" ".join(f"{cell:>{k}}" for k, cell in zip(widths, line, strict=True)).rstrip() for line in lines]


def _over_time(over_time: pd.DataFrame, known: bool, name: str) -> list[str]:
    """Return lines with the interval of the error on the finest level, at up to ``LINES`` times."""
    finest = over_time[over_time["level"] == over_time["level"].max()]
    rows = list(finest.iloc[np.unique(np.linspace(0, len(finest) - 1, LINES).round().astype(int))].itertuples())
    columns = {
        "      t": [f"{row.time:.4f}" for row in rows],
        "    lower": [down(row.lower, SHOWN) for row in rows],
        "    error": [f"{row.error:.4g}" if known else "unknown" for row in rows],
        "    upper": [up(row.upper, SHOWN) for row in rows],
        "         % of u": [_percent(row.percent_low, row.percent_high) for row in rows],
        "upper/lower": [f"{row.upper / row.lower:.3f}" if row.lower > 0 else "∞" for row in rows],
        "from u_h alone": [_plain(row.plain) for row in rows],
    }
    return [name or f"level {finest['level'].iloc[0]}", *aligned(columns)]


def _intervals(table: pd.DataFrame, known: bool, in_time: bool = True, names: Sequence[str] | None = None) -> list[str]:
    """Return lines with the interval of the error on each mesh, then lines with the intervals of the orders.

    Names of more than ``NAME`` characters are cut, so that a line has at most 80 characters.
    """
    labels = [one if len(one) <= NAME else f"{one[: NAME - 1]}…" for one in names or map(str, table["level"])]
    kind, rows = "file" if names else "level", list(table.itertuples())
    kind = f"{kind:>{max(len(kind), *map(len, labels))}}"
    columns = {
        kind: labels,
        "       max error in" if in_time else "           error in": [
            interval(row.lowest, row.highest, SHOWN) for row in rows
        ],
        "         % of u": [_percent(row.percent_low, row.percent_high) for row in rows],
    }
    columns |= {"    error": [f"{row.error:.4g}" for row in rows]} if known else {}
    lines = aligned(columns | {"from u_h alone": [_plain(row.plain) for row in rows]})
    if not table["order_low"].notna().any():
        return lines
    orders = {f"order since {labels[0]}": "order"} | ({"since the mesh before": "pair"} if len(table) > 2 else {})
    columns = {kind: labels[1:]}
    for head, name in orders.items():
        ends = zip(table[f"{name}_low"][1:], table[f"{name}_high"][1:], strict=True)
        columns[f"{head:>19}"] = ["" if math.isnan(low) else interval(low, high, SHOWN) for low, high in ends]
    lines += ["", *aligned(columns)]
    if in_time:
        steps = "the same steps on every mesh" if table["steps"].nunique() == 1 else "steps that follow the mesh"
        lines += ["", f"orders of the fully discrete u_h, with {steps}"]
    return lines


def _plain(bound: float) -> str:
    return "left out" if math.isnan(bound) else up(bound, SHOWN)


def _percent(low: float, high: float) -> str:
    return interval(low, high, PERCENT) if high < math.inf else f"[{down(low, PERCENT)}, ∞]"
