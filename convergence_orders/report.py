"""Writes the observed orders of tables as text, JSON, Markdown, JUnit XML and as a plot."""

import importlib
import json
import math
import os
import textwrap
from dataclasses import asdict
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from .judging import Judged
from .orders import FAILS, HIGHER, HOLDS, SKIPPED, UNDECIDED, Array, OrderError, OrderResult
from .printing import printable


def exit_code(judged: Judged) -> int:
    """Return the exit code of the command.

    It is 1 if a verdict is *fails* or *higher*. Otherwise, it is 3 if a verdict is undecided or if all errors are zero,
    and 0 if not. Columns without an expectation are not judged.
    """
    verdicts = {result.verdict for result in results_of(judged) if result.expectation.judges}
    if verdicts & {FAILS, HIGHER}:
        return 1
    return 3 if UNDECIDED in verdicts or verdicts == {SKIPPED} else 0


def results_of(judged: Judged) -> list[OrderResult]:
    """Return the observed orders of all columns."""
    return [result for _, results in judged for result in results]


def wrapped(text: str) -> list[str]:
    """Return the lines of a paragraph, which are at most 80 characters long."""
    return textwrap.wrap(text, 80, subsequent_indent="    ")


def as_text(judged: Judged) -> str:
    """Return the text that the command prints.

    It has a conclusion for each column of errors. Then it has for each table how the table was read, and all orders.
    """
    lines: list[str] = []
    for result in results_of(judged):
        lines += wrapped(f"{result.name}: {result.conclusion}")
    for series, results in judged:
        lines += ["", *wrapped(series.caption), *wrapped(series.recognised("errors"))]
        for result in results:
            lines += ["", result.name, "             h        error    order"]
            orders = ["", *(f"{order:9.3f}" for order in result.orders)]
            for row in zip(result.h, result.errors, orders, strict=True):
                lines.append("  {:12.5g} {:12.5g}{}".format(*row))
    return "\n".join(lines)


def as_json(judged: Judged) -> str:
    """Return JSON with one object for each column of errors."""
    entries = []
    for series, results in judged:
        table = {key: getattr(series, key) for key in ("caption", "form", "label", "size", "ignored")}
        for result in results:
            entry = asdict(result)
            entries.append(entry | entry.pop("expectation") | {"table": table})
    return dumps(entries)


def dumps(entries: list[dict[str, Any]]) -> str:
    """Return entries as JSON, with null for numbers that are not finite."""
    finite = json.loads(json.dumps(entries), parse_constant=lambda name: None)
    return json.dumps(finite, indent=2, ensure_ascii=False)


def as_markdown(judged: Judged) -> str:
    """Return a Markdown table with the verdict on each column of errors, for example for the summary of a CI job."""
    rows = ["| column | verdict | behaviour of the errors |", "|---|---|---|"]
    for result in results_of(judged):
        words = result.conclusion.removeprefix(f"{result.verdict}: ")
        cells = [cell.replace("|", "\\|").replace("\n", " ") for cell in (result.name, result.verdict or "–", words)]
        rows.append(printable(f"| {' | '.join(cells)} |"))
    return "\n".join(rows) + "\n"


def as_junit(judged: Judged) -> str:
    """Return JUnit XML with one test case for each column of errors.

    An order that is lower or higher than expected is a failure, and so is an undecided verdict.
    """
    suite = ElementTree.Element("testsuite", name="convergence-orders")
    for result in results_of(judged):
        case = ElementTree.SubElement(suite, "testcase", classname="orders", name=printable(result.name))
        if result.verdict != HOLDS:
            outcome = "skipped" if result.verdict in (None, SKIPPED) else "failure"
            ElementTree.SubElement(case, outcome, message=printable(result.conclusion))
    suite.set("tests", str(len(suite)))
    suite.set("failures", str(len(suite.findall("*/failure"))))
    return ElementTree.tostring(suite, encoding="unicode", xml_declaration=True)


def plot(judged: Judged, file: Path) -> None:
    """Draw errors over mesh sizes, and for each column a dashed line with the expected order.

    Raises:
        OrderError: the name of the file does not end with .png, .svg or .pdf, or Matplotlib is not installed.
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
        # Matplotlib would read dollar signs in names as the start of a formula.
        label = f"{result.name}: order {result.order:.2f}".replace("$", r"\$")
        h, errors = np.array([result.h, result.errors])
        drawable = (errors > 0) & np.isfinite(errors)
        (line,) = axes.plot(h, np.where(drawable, errors, np.nan), "o-", label=label)
        order = result.expectation.expected or result.expectation.at_least
        if order and drawable.any():
            # The line is shifted below the last error, so that both are visible if they are parallel.
            last = np.flatnonzero(drawable)[-1]
            axes.plot(h, 0.6 * errors[last] * (h / h[last]) ** order, "--", color=line.get_color())
    for axis in (axes.xaxis, axes.yaxis):
        ticks = _ticks(*axis.get_view_interval())
        axis.set_ticks([], minor=True)
        axis.set_ticks(ticks, [f"{tick:.3g}" for tick in ticks])
    axes.legend(title="dashed: expected order, shifted")
    figure.savefig(file, dpi=150)


def _ticks(low: float, high: float) -> Array:
    """Return at least three numbers between two positive ones, round if possible; Matplotlib labels powers of ten."""
    powers = 10.0 ** np.arange(math.floor(math.log10(low)), math.log10(high) + 1)
    for digits in ((1,), (1, 3), (1, 2, 5), range(1, 10)):
        ticks = np.outer(powers, digits).ravel()
        ticks = ticks[(low <= ticks) & (ticks <= high)]
        if len(ticks) > 2:
            return ticks[:: math.ceil(len(ticks) / 8)]
    return np.geomspace(low, high, 3)
