"""``study rates``: observed orders of any table of errors."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict
from pathlib import Path

from study.cli.options import OK
from study.ledger.files import write_text
from study.orders import OrderError, observed_orders
from study.orders.columns import choose
from study.orders.reading import MAX_BYTES, read_tables
from study.orders.report import Found, as_json, as_junit, as_markdown, as_text, exit_code
from study.orders.values import GridConvergence, grid_convergence


def do_rates(options: argparse.Namespace) -> int:
    """Print observed orders or grid convergence indices; 1 if an expected order is missed."""
    expected, at_least = _wishes(options.expected), _wishes(options.at_least)
    columns = options.columns.split(",") if options.columns else None
    if options.dim is not None and not 1 <= options.dim <= 3:
        raise OrderError(f"--dim must be 1, 2 or 3, got {options.dim}")
    found: list[Found] = []
    indices: dict[str, GridConvergence] = {}
    if options.values and (expected or at_least):
        raise OrderError("--values has no errors to judge: leave out --expected and --at-least")
    try:
        for table in read_tables(_read(options.file)):
            series = choose(table, options.dim, options.size, options.ratio, columns, signed=options.values)
            if options.values:
                indices |= {name: grid_convergence(series.h, values) for name, values in series.errors.items()}
                continue
            reports = []
            for name, errors in series.errors.items():
                wanted, least = _of(expected, name), _of(at_least, name)
                reports.append(observed_orders(series.h, errors, wanted, least, options.tolerance, name))
            found.append((series, reports))
    except OrderError as error:
        raise OrderError(f"{options.file}: {error}") from None
    if options.values:
        print(_values(indices, options.json))
        return OK
    names = {column.name for _, reports in found for column in reports}
    for name in {*expected, *at_least} - {"", *names}:
        raise OrderError(f"an order is expected of {name}, but the columns of errors are {', '.join(sorted(names))}")
    print(json.dumps(as_json(found), indent=2) if options.json else as_text(found))
    if options.junit:
        write_text(options.junit, as_junit(found))
    if options.markdown:
        write_text(options.markdown, as_markdown(found) + "\n")
    return exit_code(found)


def _values(indices: dict[str, GridConvergence], as_json: bool) -> str:
    """Return order, extrapolated value and grid convergence index of each quantity as text."""
    if as_json:
        entries = [{"name": name} | asdict(found) for name, found in indices.items()]
        return json.dumps(
            [{key: None if value != value else value for key, value in e.items()} for e in entries], indent=2
        )
    lines = []
    for name, found in indices.items():
        line = f"{name}: {found.kind}"
        if found.extrapolated == found.extrapolated:
            line += f", order {found.order:.2f}, extrapolated {found.extrapolated:.6g}, GCI {found.index:.2%} on the finest mesh"  # noqa: E501
        lines.append(line)
    return "\n".join(lines)


def _read(file: Path) -> bytes:
    """Return the bytes of a file, of a pipe, or of standard input for ``-``."""
    if str(file) == "-":
        return sys.stdin.buffer.read(MAX_BYTES + 1)
    if file.is_dir():
        raise OrderError("it is a directory; expected a file with a table of errors")
    if not file.exists():
        raise OrderError("there is no file of this name")
    with file.open("rb") as stream:
        return stream.read(MAX_BYTES + 1)


def _wishes(wanted: float | dict[str, float] | None) -> dict[str, float]:
    """Return name ↦ order; the empty name stands for all columns."""
    return wanted if isinstance(wanted, dict) else {} if wanted is None else {"": wanted}


def _of(wishes: dict[str, float], name: str) -> float | None:
    return wishes.get(name, wishes.get(""))
