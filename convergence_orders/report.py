"""Writes the observed orders of tables as text, JSON, Markdown, JUnit XML and as a plot."""

import importlib
import math
import os
import textwrap
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from .columns import Series
from .judging import Judged
from .orders import FAILS, HIGHER, SKIPPED, UNDECIDED, OrderError, OrderResult
from .printing import printable

MOST_ROWS, MOST_COLUMNS = 24, 20
"""Largest numbers of rows of a column, and of columns and tables, that the report shows."""


def exit_code(judged: Judged) -> int:
    """Return the exit code of the command.

    It is 1 if a verdict is *fails* or *higher*. Otherwise, it is 3 if a verdict is undecided, and 0 if not. Columns
    without an expectation are not judged.
    """
    results = [result for _, results in judged for result in results if result.expectation.judges]
    verdicts = {result.verdict for result in results} - {SKIPPED}
    if verdicts & {FAILS, HIGHER}:
        return 1
    return 3 if UNDECIDED in verdicts or (results and not verdicts) else 0


def results_of(judged: Judged) -> list[OrderResult]:
    """Return the observed orders of all columns."""
    return [result for _, results in judged for result in results]


def as_text(judged: Judged) -> str:
    """Return the text that the command prints.

    It has a conclusion for each column of errors. Then it has for each table how the table was read, and all orders.
    """
    lines: list[str] = []
    every = results_of(judged)
    for result in every[:MOST_COLUMNS]:
        lines += textwrap.wrap(f"{result.name}: {result.conclusion}", 80, subsequent_indent="    ")
    if len(every) > MOST_COLUMNS:
        counts = Counter(result.verdict or result.kind for result in every)
        lines.append(f"all {len(every)} columns: " + ", ".join(f"{n} {word}" for word, n in counts.items()))
    for series, results in judged[:MOST_COLUMNS]:
        lines += ["", *textwrap.wrap(series.caption, 80), *recognised(series)]
        for result in results[:MOST_COLUMNS]:
            lines += ["", result.name[:80], *_rows(result)]
    return "\n".join(lines)


def recognised(series: Series) -> list[str]:
    """Return lines that say how a table was read."""
    words = textwrap.shorten(series.recognised, 800, placeholder=" …")
    return textwrap.wrap(words, 80, subsequent_indent="    ")


def _rows(result: OrderResult) -> list[str]:
    """Return lines with the mesh sizes, errors and orders of a column.

    Of a long column, only the first and the last rows are returned.
    """
    orders = ("", *(f"{order:.3f}" for order in result.orders))
    rows = [f"  {h:12.5g} {e:12.5g} {p:>8}".rstrip() for h, e, p in zip(result.h, result.errors, orders, strict=True)]
    if len(rows) > MOST_ROWS:
        rows[4 : 4 - MOST_ROWS] = [f"  … {len(rows) - MOST_ROWS} rows left out"]
    return [f"  {'h':>12} {'error':>12} {'order':>8}", *rows]


def as_json(judged: Judged) -> list[dict[str, Any]]:
    """Return one dictionary for each column of errors; numbers that are not finite become None."""
    entries = []
    for series, results in judged:
        table = {key: getattr(series, key) for key in ("caption", "form", "label", "size", "ignored")}
        for result in results:
            entry = asdict(result)
            entries.append(finite(entry | entry.pop("expectation") | {"table": table}))
    return entries


def finite(value: Any) -> Any:
    """Return nested data with None in place of numbers that are not finite, which JSON cannot write."""
    if isinstance(value, dict):
        return {key: finite(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [finite(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def as_markdown(judged: Judged) -> str:
    """Return a Markdown table with the verdict on each column of errors, for example for the summary of a CI job."""
    rows = ["| column | verdict | behaviour of the errors |", "|---|---|---|"]
    for result in results_of(judged):
        words = result.conclusion.removeprefix(f"{result.verdict}: ")
        cells = [printable(cell).replace("|", "\\|") for cell in (result.name, result.verdict or "–", words)]
        rows.append("| " + " | ".join(cells).replace("\n", " ") + " |")
    return "\n".join(rows) + "\n"


def as_junit(judged: Judged) -> str:
    """Return JUnit XML with one test case for each column of errors.

    An order that is lower or higher than expected is a failure, and so is an undecided verdict.
    """
    every = results_of(judged)
    failed = [result for result in every if result.verdict in (FAILS, HIGHER, UNDECIDED)]
    suite = ElementTree.Element(
        "testsuite", name="convergence-orders", tests=str(len(every)), failures=str(len(failed))
    )
    for result in every:
        case = ElementTree.SubElement(suite, "testcase", classname="orders", name=printable(result.name))
        if result in failed:
            ElementTree.SubElement(case, "failure", message=printable(result.conclusion))
        elif result.verdict in (None, SKIPPED):
            ElementTree.SubElement(case, "skipped", message=printable(result.conclusion))
    return ElementTree.tostring(suite, encoding="unicode", xml_declaration=True)


def plot(judged: Judged, file: Path) -> None:
    """Draw errors over mesh sizes, with two lines for each column: the fitted order and the expected order.

    Parameters:
        judged: the tables and the observed orders of their columns.
        file: the file, whose name ends with .png, .svg or .pdf.

    Raises:
        OrderError: the name of the file has another ending, or Matplotlib is not installed.
    """
    if file.suffix.lower() not in (".png", ".svg", ".pdf"):
        raise OrderError(f"--plot {file}: expected a name that ends with .png, .svg or .pdf")
    # All plots are files. Matplotlib cannot be imported if this variable names a window system it does not know.
    os.environ.pop("MPLBACKEND", None)
    try:
        figures = importlib.import_module("matplotlib.figure")
    except ImportError:
        raise OrderError("--plot needs Matplotlib: python -m pip install matplotlib") from None
    figure = figures.Figure(figsize=(6.4, 4.4), layout="constrained")
    axes = figure.add_subplot(xscale="log", yscale="log", ylabel="error")
    axes.set_xlabel("time step Δt" if all(series.size.startswith("Δt") for series, _ in judged) else "mesh size h")
    for k, result in enumerate(results_of(judged)[:MOST_COLUMNS]):
        h, errors, colour = np.array(result.h), np.array(result.errors), f"C{k % 10}"
        positive = (errors > 0) & np.isfinite(errors)
        # Matplotlib would read dollar signs in names as the start of a formula.
        label = f"{result.name}: order {result.order:.2f}".replace("$", r"\$")
        axes.plot(h[positive], errors[positive], "os^Dv"[k % 5], color=colour, markersize=5, label=label)
        if not math.isfinite(result.order):
            continue
        judged_rows = slice(result.first, result.last)
        scaled = h[judged_rows] / np.exp(np.log(h[judged_rows]).mean())
        centre = np.exp(np.log(errors[judged_rows]).mean())
        axes.plot(h[judged_rows], centre * scaled**result.order, color=colour, linewidth=1.2)
        if wanted := result.expectation.expected or result.expectation.at_least:
            # The expected line is shifted below the errors, so that both lines are visible if they are parallel.
            axes.plot(h[judged_rows], 0.6 * centre * scaled**wanted, "--", color=colour, linewidth=1)
    axes.grid(True, color="0.9")
    axes.legend(title="dashed: expected order, shifted", fontsize=8, frameon=False)
    figure.savefig(file, dpi=150)
