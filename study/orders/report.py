"""Results as text, JSON, Markdown and JUnit XML."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence as Many
from dataclasses import asdict
from typing import Any
from xml.etree import ElementTree

from study.orders.columns import Series
from study.orders.sequences import FAILS, HIGHER, HOLDS, SKIPPED, UNDECIDED, Sequence

MOST_ROWS, MOST_COLUMNS = 24, 20
Found = tuple[Series, list[Sequence]]


def exit_code(found: Many[Found]) -> int:
    """0 holds or no expectation, 1 fails or higher than expected, 3 undecided."""
    verdicts = [column.verdict for _, columns in found for column in columns]
    if FAILS in verdicts or HIGHER in verdicts:
        return 1
    judged = [verdict for verdict in verdicts if verdict not in (None, SKIPPED)]
    asked = any(
        column.expected is not None or column.at_least is not None for _, columns in found for column in columns
    )
    return 3 if UNDECIDED in judged or (asked and not judged) else 0


def as_text(found: Many[Found]) -> str:
    """The conclusion, one line for each column; then what was recognised and all orders; 80 columns."""
    lines: list[str] = []
    every = [column for _, columns in found for column in columns]
    for column in every[:MOST_COLUMNS]:
        verdict = f"{column.verdict}: " if column.verdict else ""
        lines += textwrap.wrap(
            f"{column.name}: {verdict}{column.sentence}{_wanted(column)}", 80, subsequent_indent="    "
        )
    if len(every) > MOST_COLUMNS:
        counts = {
            word: sum(column.verdict == word for column in every) for word in (HOLDS, FAILS, HIGHER, UNDECIDED, SKIPPED)
        }
        lines.append(
            f"and {len(every) - MOST_COLUMNS} more columns; all: "
            + ", ".join(f"{n} {w}" for w, n in counts.items() if n)
        )
    for series, columns in found:
        lines += [
            "",
            *textwrap.wrap(series.caption, 80),
            *textwrap.wrap(_shortened(series), 80, subsequent_indent="    "),
        ]
        for column in columns[:MOST_COLUMNS]:
            lines += ["", column.name[:80], f"  {'h':>12} {'error':>12} {'order':>8}"]
            orders = ("", *(f"{order:.3f}" for order in column.orders))
            rows = [
                f"  {h:12.5g} {e:12.5g} {order:>8}" for h, e, order in zip(column.h, column.errors, orders, strict=True)
            ]
            skipped = [f"  … {len(rows) - MOST_ROWS} rows left out"] if len(rows) > MOST_ROWS else []
            lines += [*rows[:4], *skipped, *rows[4 - MOST_ROWS :]] if skipped else rows
    return "\n".join(lines)


def _shortened(series: Series) -> str:
    text = series.recognised
    return text if len(text) < 800 else text[:800] + " …"


def _wanted(column: Sequence) -> str:
    if column.at_least is not None:
        return f"; expected at least {column.at_least:g}"
    return "" if column.expected is None else f"; expected {column.expected:g} ± {column.tolerance:g}"


def as_json(found: Many[Found]) -> list[dict[str, Any]]:
    """One object for each column; numbers that do not exist are null. The schema is in docs/reference/commands.md."""
    result = []
    for series, columns in found:
        for column in columns:
            above = column.expected
            reasons = [
                f"above the expected {above:g} by more than {column.tolerance:g}"
                if above is not None
                and order > above + column.tolerance
                and column.kind in ("higher than expected", "converges")
                else None
                for order in column.orders
            ]
            judged = column.h[column.first] if column.last - column.first > 2 else None
            extra: dict[str, Any] = {"asymptotic_from": judged, "too_good": reasons}
            extra |= {
                "table": {
                    "caption": series.caption,
                    "form": series.form,
                    "size": series.size,
                    "ignored": series.ignored,
                }
            }
            result.append(_finite(asdict(column)) | extra)
    return result


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def as_markdown(found: Many[Found]) -> str:
    """A table for the summary of a CI job."""
    rows = ["| column | verdict | what the errors do |", "|---|---|---|"]
    for _, columns in found:
        for column in columns:
            cells = (column.name, column.verdict or "–", column.sentence + _wanted(column))
            rows.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(rows)


def as_junit(found: Many[Found]) -> str:
    """JUnit XML: one test case for each column; undecided and higher than expected are failures."""
    every = [column for _, columns in found for column in columns]
    failed = [column for column in every if column.verdict in (FAILS, HIGHER, UNDECIDED)]
    suite = ElementTree.Element("testsuite", name="study rates", tests=str(len(every)), failures=str(len(failed)))
    for column in every:
        case = ElementTree.SubElement(suite, "testcase", classname="orders", name=column.name)
        if column in failed:
            ElementTree.SubElement(case, "failure", message=f"{column.verdict}: {column.sentence}{_wanted(column)}")
        elif column.verdict in (None, SKIPPED):
            ElementTree.SubElement(case, "skipped", message=column.sentence)
    return ElementTree.tostring(suite, encoding="unicode", xml_declaration=True)
