"""Writes the observed orders of tables as text, JSON, Markdown, JUnit XML and as a plot."""

import importlib
import math
import os
import textwrap
from dataclasses import asdict
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from .columns import Series
from .judging import Judged
from .orders import FAILS, HIGHER, SKIPPED, UNDECIDED, OrderError, OrderResult
from .printing import printable


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
    for result in results_of(judged):
        lines += textwrap.wrap(f"{result.name}: {result.conclusion}", 80, subsequent_indent="    ")
    for series, results in judged:
        lines += ["", *textwrap.wrap(series.caption, 80), *recognised(series)]
        for result in results:
            lines += ["", result.name[:80], f"  {'h':>12} {'error':>12} {'order':>8}"]
            orders = ("", *(f"{order:.3f}" for order in result.orders))
            for h, error, order in zip(result.h, result.errors, orders, strict=True):
                lines.append(f"  {h:12.5g} {error:12.5g} {order:>8}".rstrip())
    return "\n".join(lines)


def recognised(series: Series) -> list[str]:
    """Return lines that say how a table was read."""
    return textwrap.wrap(series.recognised, 80, subsequent_indent="    ")


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
    suite = ElementTree.Element("testsuite", name="convergence-orders")
    tags = dict.fromkeys((FAILS, HIGHER, UNDECIDED), "failure") | dict.fromkeys((None, SKIPPED), "skipped")
    for result in results_of(judged):
        case = ElementTree.SubElement(suite, "testcase", classname="orders", name=printable(result.name))
        if tag := tags.get(result.verdict):
            ElementTree.SubElement(case, tag, message=printable(result.conclusion))
    suite.set("tests", str(len(suite)))
    suite.set("failures", str(len(suite.findall("*/failure"))))
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
    figure = figures.Figure(layout="constrained")
    axes = figure.add_subplot(xscale="log", yscale="log", xlabel="mesh size h or time step", ylabel="error")
    for result in results_of(judged):
        shown = [(h, error) for h, error in zip(result.h, result.errors, strict=True) if 0 < error < math.inf]
        # Matplotlib would read dollar signs in names as the start of a formula.
        label = f"{result.name}: order {result.order:.2f}".replace("$", r"\$")
        (line,) = axes.plot([h for h, _ in shown], [error for _, error in shown], "o-", label=label)
        wanted = result.expectation.expected or result.expectation.at_least
        if wanted and shown:
            # The expected line is shifted below the errors, so that both lines are visible if they are parallel.
            finest, error = shown[-1]
            below = [0.6 * error * (h / finest) ** wanted for h in result.h]
            axes.plot(result.h, below, "--", color=line.get_color())
    for axis in (axes.xaxis, axes.yaxis):
        low, high = axis.get_view_interval()
        # Matplotlib labels powers of ten, of which a short axis may have none.
        texts = [f"{low * (high / low) ** part:.3g}" for part in (0.2, 0.4, 0.6, 0.8)]
        axis.set_ticks([], minor=True)
        axis.set_ticks(list(map(float, texts)), texts)
    axes.legend(title="dashed: expected order, shifted")
    figure.savefig(file, dpi=150)
