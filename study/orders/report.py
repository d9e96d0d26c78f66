"""Writes the results of ``study rates`` as text, JSON, Markdown, JUnit XML and as a plot."""

import importlib
import math
import textwrap
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from .columns import Series
from .sequences import FAILS, HIGHER, SKIPPED, UNDECIDED, OrderError, OrderResult

MOST_ROWS, MOST_COLUMNS = 24, 20
"""Largest numbers of rows of a column, and of columns and tables, that the report shows."""
Judged = list[tuple[Series, list[OrderResult]]]
"""List of pairs: a table, and the observed orders of its columns of errors."""


def exit_code(judged: Judged) -> int:
    """Return the exit code of ``study rates``.

    It is 1 if an observed order is lower or higher than expected. Otherwise, it is 3 if the verdict on an order is
    undecided, and 0 if not. Columns without an expected order are not judged.
    """
    results = [result for _, results in judged for result in results if result.expectation.window]
    verdicts = {result.verdict for result in results} - {SKIPPED}
    if verdicts & {FAILS, HIGHER}:
        return 1
    return 3 if UNDECIDED in verdicts or (results and not verdicts) else 0


def as_text(judged: Judged) -> str:
    """Return the text that ``study rates`` prints.

    It has a conclusion for each column of errors. Then it has for each table how the table was read, and all orders.
    """
    lines: list[str] = []
    every = [result for _, results in judged for result in results]
    for result in every[:MOST_COLUMNS]:
        lines += textwrap.wrap(f"{result.name}: {result.conclusion}", 80, subsequent_indent="    ")
    if len(every) > MOST_COLUMNS:
        counts = Counter(result.verdict or result.kind for result in every)
        lines.append(f"all {len(every)} columns: " + ", ".join(f"{n} {word}" for word, n in counts.items()))
    for series, results in judged[:MOST_COLUMNS]:
        words = textwrap.shorten(series.recognised, 800, placeholder=" …")
        lines += ["", *textwrap.wrap(series.caption, 80), *textwrap.wrap(words, 80, subsequent_indent="    ")]
        for result in results[:MOST_COLUMNS]:
            lines += ["", result.name[:80], *_rows(result)]
    return "\n".join(lines)


def _rows(result: OrderResult) -> list[str]:
    """Return lines with the mesh sizes, errors and orders of a column.

    Of a long column, only the first and the last rows are returned.
    """
    orders = ("", *(f"{order:.3f}" for order in result.orders))
    rows = [f"  {h:12.5g} {e:12.5g} {p:>8}" for h, e, p in zip(result.h, result.errors, orders, strict=True)]
    if len(rows) > MOST_ROWS:
        rows[4 : 4 - MOST_ROWS] = [f"  … {len(rows) - MOST_ROWS} rows left out"]
    return [f"  {'h':>12} {'error':>12} {'order':>8}", *(row.rstrip() for row in rows)]


def as_json(judged: Judged) -> list[dict[str, Any]]:
    """Return one dictionary for each column of errors, in the format of docs/reference/rates.schema.json.

    Numbers that are not finite become None.
    """
    found = []
    for series, results in judged:
        table = {key: getattr(series, key) for key in ("caption", "form", "label", "size", "ignored")}
        for result in results:
            entry = asdict(result)
            found.append(finite(entry | entry.pop("expectation") | {"table": table}))
    return found


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
    for result in (result for _, results in judged for result in results):
        words = result.conclusion.removeprefix(f"{result.verdict}: ")
        cells = (result.name, result.verdict or "–", words)
        rows.append("| " + " | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in cells) + " |")
    return "\n".join(rows) + "\n"


def as_junit(judged: Judged) -> str:
    """Return JUnit XML with one test case for each column of errors.

    An order that is lower or higher than expected is a failure, and so is an undecided verdict.
    """
    every = [result for _, results in judged for result in results]
    failed = [result for result in every if result.verdict in (FAILS, HIGHER, UNDECIDED)]
    suite = ElementTree.Element("testsuite", name="study rates", tests=str(len(every)), failures=str(len(failed)))
    for result in every:
        case = ElementTree.SubElement(suite, "testcase", classname="orders", name=result.name)
        if result in failed:
            ElementTree.SubElement(case, "failure", message=result.conclusion)
        elif result.verdict in (None, SKIPPED):
            ElementTree.SubElement(case, "skipped", message=result.conclusion)
    return ElementTree.tostring(suite, encoding="unicode", xml_declaration=True)


def plot(judged: Judged, file: Path, suffix: str) -> None:
    """Draw errors over mesh sizes, with two lines for each column: the fitted order and the expected order.

    Parameters:
        judged: the tables and the observed orders of their columns.
        file: the file that is written.
        suffix: the format: .png, .svg or .pdf.

    Raises:
        OrderError: there is no such format, or Matplotlib is not installed.
    """
    if suffix.lower() not in (".png", ".svg", ".pdf"):
        raise OrderError(f"--plot: got the ending {suffix!r}, expected a name that ends with .png, .svg or .pdf")
    try:
        figures = importlib.import_module("matplotlib.figure")
    except ImportError:
        raise OrderError("--plot needs Matplotlib: python -m pip install matplotlib") from None
    figure = figures.Figure(figsize=(6.4, 4.4), layout="constrained")
    axes = figure.add_subplot(xscale="log", yscale="log", ylabel="error")
    axes.set_xlabel("time step Δt" if all(series.size.startswith("Δt") for series, _ in judged) else "mesh size h")
    drawn = [result for _, results in judged for result in results if any(0 < e < math.inf for e in result.errors)]
    for k, result in enumerate(drawn[:MOST_COLUMNS]):
        h, errors, colour = np.array(result.h), np.array(result.errors), f"C{k % 10}"
        positive = (errors > 0) & np.isfinite(errors)
        # Matplotlib would read dollar signs in names as the start of a formula.
        label = f"{result.name}: order {result.order:.2f}".replace("$", r"\$")
        axes.plot(h[positive], errors[positive], "os^Dv"[k % 5], color=colour, markersize=5, label=label)
        if not math.isfinite(result.order):
            continue
        used = h[result.first : result.last]
        scaled = used / np.exp(np.log(used).mean())
        centre = np.exp(np.log(errors[result.first : result.last]).mean())
        axes.plot(used, centre * scaled**result.order, color=colour, linewidth=1.2)
        wanted = result.expectation.expected or result.expectation.at_least
        if wanted:
            # The expected line is shifted below the errors, so that both lines are visible if they are parallel.
            axes.plot(used, 0.6 * centre * scaled**wanted, "--", color=colour, linewidth=1)
    if any(result.expectation.window for result in drawn):
        axes.plot([], [], "--", color="0.45", linewidth=1, label="expected order, shifted")
    sizes = sorted({size for result in drawn for size in result.h})
    if 1 < len(sizes) <= 10:
        axes.set_xticks(sizes, [f"{size:.3g}" for size in sizes], fontsize=8)
        axes.minorticks_off()
    axes.grid(True, color="0.9")
    if drawn:
        axes.legend(fontsize=8, frameon=False)
    figure.savefig(file, dpi=150, format=suffix[1:].lower())
