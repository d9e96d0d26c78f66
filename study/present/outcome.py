"""The printed texts of the commands: results of a run, bounds of errors, and verdicts as JUnit XML."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from math import ceil, inf, isinf, isnan
from pathlib import Path
from textwrap import fill, wrap
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import numpy as np
import pandas as pd
from pandas import DataFrame, Series
from tabulate import tabulate

from convergence_orders.printing import printable
from convergence_orders.tables import shorten
from study.ledger.check import by_family
from study.ledger.datafiles import SERIES, by_claim, count_kinds, count_verdicts, expected_orders, read_rates
from study.ledger.files import Json, write_text
from study.ledger.quantities import RatesError, orders
from study.ledger.text import cell, down, interval, is_narrow, outwards, significant, up, width
from study.ledger.verdict import (
    BECAUSE,
    FAILS,
    HOLDS,
    MISSED,
    REPORTED,
    UNDECIDED,
    VERDICTS,
    Verdicts,
)
from study.present.templates import ENVIRONMENT, read_page

SENTENCES: dict[str, str] = read_page("texts")["printed"]
"""Name of a printed sentence ↦ its template."""
Orders = Mapping[str, float]
"""Case ↦ order."""
MOST_DETAILED_CASES = 3
"""If a run has at most this number of cases, its reported numbers without a claim are printed, too."""


def rates_text(directory: Path) -> str:
    """Return the table of errors that ``study run`` prints, with a row for each case and mesh family of ``rates.csv``.

    A row has the finest level n and its error, the order of the discrete error between the two finest levels, the
    largest share of the time discretisation on all levels in per cent, the predicted order of the error, and the
    observed orders from level to level. The first orders are left out if the terminal is not wide enough.
    """
    rates = read_rates(directory)
    predicted = expected_orders(directory, rates)
    predicted_head, words = ("pred.", (11, 12, 14)) if is_narrow() else ("predicted", (22, 13, 25))
    head = ("case", "meshes", "n", "error", "disc. order", "time %", predicted_head, "orders level by level")
    widths = (*words[:2], 5, 9, 5, 5, len(predicted_head), words[2])
    lines: list[str] = []
    for claim, of_claim in rates.groupby("claim", sort=False):
        rows = [
            _rates_row(series, predicted, (words[2] + 1) // 5) for _, series in of_claim.groupby(SERIES, sort=False)
        ]
        lines += [claim, _aligned(head, rows, widths, numbers=slice(2, 7)), ""]
    return "\n".join(lines)


def finest_orders(rates: DataFrame, refinements: int) -> dict[str, float]:
    """Return mesh family ↦ observed order of the error between the finest mesh and a coarser mesh.

    A contact front that does not move, or a jump of the material, may lie at 1/3 of a side of the body, inside cells
    (the cases rough-1.75 and layered-unmet). With two refinements, which multiply n by 4, it has the same position in
    its cells of both meshes, because 4n/3 and n/3 have the same fractional part.

    Parameters:
        rates: rows of ``rates.csv`` of one case. Families with a single level, or with errors that have no order, are
            left out.
        refinements: the number of refinements between the two meshes; less if there are fewer levels.
    """
    by_name = {}
    for family, rows in by_family(rates).items():
        ends = rows.tail(refinements + 1).iloc[[0, -1]]
        if len(rows) > 1:
            with suppress(RatesError):
                by_name[family] = orders(ends.h, ends.error)[0]
    return by_name


def order_differences(rates: DataFrame, expected: Orders, refinements: int = 2) -> DataFrame:
    """Return the predicted and observed orders of the error and their differences, a row for each case and mesh family.

    Meshes that are graded towards a singularity are left out, because the predictions are for quasi-uniform meshes.

    Parameters:
        rates: rows of ``rates.csv``.
        expected: case ↦ predicted order.
        refinements: the number of refinements over which orders are observed, as for ``finest_orders``.

    Returns:
        A table with the columns ``case``, ``family``, ``predicted``, ``observed`` and ``difference``.
    """
    points = [
        (case, family, expected[case], order)
        for case, rows in rates.groupby("case", sort=False)
        for family, order in finest_orders(rows, refinements).items()
        if family != "graded"
    ]
    table = DataFrame(points, columns=["case", "family", "predicted", "observed"])
    return table.assign(difference=table.observed - table.predicted)


def orders_text(directory: Path) -> str:
    """Return a text on the differences between the observed and the predicted orders of the error in all cases.

    The differences are those of ``order_differences``. Without observed orders the text is empty.
    """
    rates = read_rates(directory)
    differences = order_differences(rates, expected_orders(directory, rates))["difference"]
    if differences.empty:
        return ""
    ends = outwards(differences.min(), differences.max())
    return f"observed orders of the error over two refinements differ from the predicted ones by {ends}"


def ledger_text(claims: DataFrame, orders: str = "") -> str:
    """Return the ledger as ``study run`` prints it: statements with their verdicts, failed checks, and a summary.

    There is a row for each statement with the number of cases and the number of checks with each verdict. Then all
    checks that do not hold are listed. Reported numbers, about which nothing is claimed, are listed only if there are
    at most ``MOST_DETAILED_CASES`` cases.

    Parameters:
        claims: the content of ``claims.csv``.
        orders: the text of ``orders_text``, which is added to the conclusion.
    """
    rows = [
        [label, claim, judged["case"].nunique(), *(number or "" for number in count_verdicts(judged).values())]
        for label, claim, judged in by_claim(claims)
    ]
    words = (11, 17) if is_narrow() else (22, 36)
    lines = [_aligned(("statement", "", "cases", *VERDICTS), rows, (*words, 5, 5, 8, 6, 9, 5), numbers=slice(2, 8)), ""]
    few = claims.case.nunique() <= MOST_DETAILED_CASES
    for verdict in (*([REPORTED] if few else []), MISSED, UNDECIDED, FAILS):
        for row in claims[claims.verdict == verdict].itertuples():
            expected, _, why = row.expected.partition(BECAUSE)
            observed = observed_text(row.observed, row.low, row.high)
            where = row.label, row.case
            text = printed("check", row=row, where=where, expected=expected, why=why, observed=observed)
            lines += _wrapped(text, indent="    ")
    count = count_verdicts(claims)
    kinds = count_kinds(claims)
    lines += _wrapped(printed("counts", total=len(claims), count=count))
    lines += _wrapped(printed("kinds", kinds=kinds)) if count[HOLDS] else []
    lines += _wrapped(printed("conclusion", count=count, orders=orders))
    return "\n".join(lines) + "\n"


def printed(name: str, **values: object) -> str:
    """Return the sentence that a template of ``page/texts.toml``, [printed], makes from values."""
    return ENVIRONMENT.from_string(SENTENCES[name]).render(values)


def _wrapped(text: str, indent: str = "") -> list[str]:
    return wrap(text, width(), subsequent_indent=indent, break_on_hyphens=False)


def write_junit(path: Path, verdicts: Verdicts) -> None:
    """Write verdicts into a JUnit XML file, as one test case each.

    The verdict *fails* is a failure. The verdicts *undecided*, *missed* (a prediction of this study was wrong) and
    *reported* (nothing is claimed) are skipped tests.
    """
    suite = Element("testsuite", name="ledger", tests=str(len(verdicts)))
    for verdict in verdicts:
        name = f"{verdict.label}.{verdict.case}"
        case = SubElement(suite, "testcase", classname=name, name=verdict.quantity)
        if verdict.verdict != HOLDS:
            observed = observed_text(verdict.observed, verdict.low, verdict.high)
            message = f"expected {verdict.expected}, observed {observed}"
            SubElement(case, "failure" if verdict.verdict == FAILS else "skipped", message=message)
    for total, tag in (("failures", "failure"), ("skipped", "skipped")):
        suite.set(total, str(len(suite.findall(f"*/{tag}"))))
    indent(suite)
    write_text(path, printable(tostring(suite, encoding="unicode", xml_declaration=True) + "\n"))


def observed_text(observed: float, low: float, high: float) -> str:
    """Return an observed value with its range as text, for example "0.98 in [0.93, 1.06]" or "at most 0.3".

    Parameters:
        observed: the value; NaN if nothing was measured.
        low, high: the smallest and the largest of the judged values. If one is infinite, only the other one is given.
    """
    if isnan(observed):
        return "no number"
    if isinf(low) and isinf(high):
        return cell(observed)
    if isinf(low):
        return f"at most {cell(high)}"
    return f"at least {cell(low)}" if isinf(high) else f"{cell(observed)} in [{cell(low)}, {cell(high)}]"


def _rates_row(series: DataFrame, predicted: Orders, shown: int) -> list[object]:
    """Return the cells of a row of ``rates_text``.

    Parameters:
        series: the rows of ``rates.csv`` of one case and mesh family, from coarse to fine.
        predicted: case ↦ predicted order.
        shown: the largest number of orders.
    """
    finest = series.iloc[-1]
    orders = [f"{order:.2f}" for order in series.order.dropna()]
    return [
        finest.case,
        finest.family,
        finest.level,
        significant(finest.error),
        "" if pd.isna(finest.discrete_order) else f"{finest.discrete_order:.2f}",
        f"{100 * series.time_share.max():.2f}",
        f"{predicted[finest.case]:.3g}",
        " ".join(["…"] * (len(orders) > shown) + orders[-shown:]),
    ]


def _aligned(head: Sequence[str], rows: Sequence[Sequence[object]], widths: Sequence[int], numbers: slice) -> str:
    """Return a table as text.

    Parameters:
        head: the headings.
        rows: the cells.
        widths: the widths at which the cells of each column are folded.
        numbers: the columns that are aligned to the right.
    """
    sides = ["left"] * len(head)
    sides[numbers] = ["right"] * len(sides[numbers])
    return tabulate([head, *rows], tablefmt="plain", disable_numparse=True, maxcolwidths=[*widths], colalign=sides)


# Bounds of errors.

SHOWN_TIMES = 8
"""The printed table shows the error at no more than this number of times."""
SHOWN = 4
PERCENT = 3
ENERGY = 6
"""Numbers of significant digits in printed texts: of error bounds, of error bounds in per cent, and of energies."""
upper = partial(up, digits=SHOWN)
lower = partial(down, digits=SHOWN)
ERROR = "{:.4g}".format
NORM = {True: "‖u(t) − u_h(t)‖_V", False: "‖u − u_h‖_G"}
"""Whether a problem is in time ↦ the error in its norm; for static problems this is the energy norm."""
MEANING = {
    True: "norm: ‖v‖_V² = ∫ Aε(v)·ε(v), weighted by the viscosity A",
    False: "norm: ‖v‖_G² = ∫ Gε(v)·ε(v), weighted by the elasticity G (energy norm)",
}
"""Whether a problem is in time ↦ the definition of the norm."""
NAME_WIDTH = 20
"""Width, in characters, of the column with file names in the printed table."""


def bounds_text(
    name: str,
    table: DataFrame,
    over_time: DataFrame,
    sentences: Sequence[str],
    in_time: bool,
    names: Sequence[str],
) -> str:
    """Return the printed text: the interval of the error, whether it is guaranteed, and one line for each mesh.

    Args:
        name: the name of the problem.
        table: the table ``levels.csv``, a row for each mesh.
        over_time: the table ``enclosure.csv``, a row for each time on the finest mesh.
        sentences: texts that say whether the bounds are guaranteed.
        in_time: whether the problem is in time, and not static.
        names: for each row of the table, the name of the file with its displacement; empty if rows are named by their
            levels.
    """
    known = table.error.notna().all()
    last = table.iloc[-1]
    size = "max ‖u(t)‖_V" if in_time else "‖u‖_G"
    share = f"% of u: per cent of {size}, which lies in {interval(last.norm_low, last.norm_high, SHOWN)}"
    if not in_time:
        energy = interval(last.norm_low**2, last.norm_high**2, ENERGY)
        share += f"; its square, the energy, lies in {energy}"
    lines = [f"{name}: {NORM[in_time]} enclosed, {'exact solution known' if known else 'solution unknown'}"]
    lines += [*(fill(sentence, width()) for sentence in (*sentences, MEANING[in_time], share)), ""]
    # A static problem has one time only, and the last table already shows its enclosure.
    over = [*_over_time(over_time, names[-1] if names else ""), ""] if in_time else []
    return "\n".join([*lines, *over, *_intervals(table, known, in_time, names)])


def worst_tenth(squares: Sequence[float]) -> str:
    """Return a sentence on how much the worst tenth of the triangles contributes to ‖ũ − u_h‖².

    This is the squared distance of the computed displacement u_h from a more accurate displacement ũ.

    Args:
        squares: ‖ũ − u_h‖² on every triangle.
    """
    share = sum(sorted(squares)[-ceil(len(squares) / 10) :]) / sum(squares)
    return f"the worst tenth of the triangles has {100 * share:.0f} % of ‖ũ − u_h‖², as cells.png shows"


def adaptive_text(
    name: str, rows: DataFrame, tolerance: str, stopped: str, sentences: Sequence[str], in_time: bool = True
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
    percents = [f"{upper(percent)} %" if percent < inf else "∞" for percent in rows.percent]
    bounds = [*rows.bound.map(upper)]
    known = rows.error.notna().all()
    reached = f"{bounds[-1]}, {percents[-1]} of u," if tolerance.endswith("%") else bounds[-1]
    found = [f"{name}: {'max ' * in_time}{NORM[in_time]} ≤ {reached} {sign} {tolerance}, the tolerance {end}"]
    found += [*(fill(sentence, width()) for sentence in sentences), ""]
    columns = {
        "mesh": rows["mesh"],
        "  cells": rows["cells"],
        "unknowns": rows.dofs,
        " steps": rows.steps if in_time else None,
        "     bound": bounds,
        "   % of u": percents,
        " order": _texts(rows.order, "{:.2f}".format, ""),
        " in time": (100 * rows.in_time).map("{:.1f} %".format) if in_time else None,
        "     error": rows.error.map(ERROR) if known else None,
    }
    found += aligned(columns)
    notes = "% of u: the bound over the least value that the norm of u can have", MEANING[in_time]
    return [*found, "", *notes, "order: of the bound in unknowns; 1/2 is the best possible for P1"]


def aligned(columns: Json) -> list[str]:
    """Return the lines of a table whose cells are aligned on the right, below heads that are as wide as their column.

    Args:
        columns: the cells of each column, by its head; blanks in front of a head make the column wider. A column that
            is None is left out.
    """
    table = DataFrame(columns).dropna(axis="columns").astype(str)
    return [line.rstrip() for line in table.to_string(index=False).splitlines()]


def _over_time(over_time: DataFrame, name: str) -> list[str]:
    """Return lines with the interval of the error on the finest level, at up to ``SHOWN_TIMES`` times."""
    rows = over_time.iloc[np.unique(np.linspace(0, len(over_time) - 1, SHOWN_TIMES).round().astype(int))]
    ratios = rows.upper / rows.lower.where(rows.lower > 0)
    columns = {
        "      t": rows.time.map("{:.4f}".format),
        "    lower": rows.lower.map(lower),
        "    error": _texts(rows.error, ERROR, "unknown"),
        "    upper": rows.upper.map(upper),
        "         % of u": _within(rows, "percent_low", "percent_high", PERCENT),
        "upper/lower": _texts(ratios, "{:.3f}".format, "∞"),
        "from u_h alone": _plain(rows),
    }
    return [name or f"level {rows.level.iloc[0]}", *aligned(columns)]


def _intervals(table: DataFrame, known: bool, in_time: bool = True, names: Sequence[str] = ()) -> list[str]:
    """Return lines with the interval of the error on each mesh, then lines with the intervals of the orders.

    Names of more than ``NAME_WIDTH`` characters are cut, so that a line has at most 80 characters.
    """
    labels = [shorten(name, NAME_WIDTH) for name in names or map(str, table.level)]
    kind = "file" if names else "level"
    kind = f"{kind:>{max(len(kind), *map(len, labels))}}"
    error = "       max error in" if in_time else "           error in"
    columns = {
        kind: labels,
        error: _within(table, "lowest", "highest"),
        "         % of u": _within(table, "percent_low", "percent_high", PERCENT),
        "    error": table.error.map(ERROR) if known else None,
        "from u_h alone": _plain(table),
    }
    lines = aligned(columns)
    if not table.order_low.notna().any():
        return lines
    orders = {f"order since {labels[0]}": "order"} | ({"since the mesh before": "pair"} if len(table) > 2 else {})
    columns = {kind: labels[1:]}
    for head, name in orders.items():
        columns[f"{head:>19}"] = _within(table[1:], f"{name}_low", f"{name}_high")
    lines += ["", *aligned(columns)]
    if in_time:
        steps = "the same steps on every mesh" if table.steps.nunique() == 1 else "steps that follow the mesh"
        lines += ["", f"orders of the fully discrete u_h, with {steps}"]
    return lines


def _texts(numbers: Series, text: Callable[[float], str], unknown: str) -> list[str]:
    return [unknown if isnan(number) else text(number) for number in numbers]


def _plain(rows: DataFrame) -> list[str]:
    return _texts(rows.plain, upper, "left out")


def _within(rows: DataFrame, low: str, high: str, digits: int = SHOWN) -> list[str]:
    """Return the intervals between two columns as texts, rounded outwards; the text is empty if an end is unknown."""
    ends = zip(rows[low], rows[high], strict=True)
    return ["" if isnan(least) else interval(least, most, digits) for least, most in ends]
