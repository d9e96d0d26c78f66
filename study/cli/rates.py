"""``study rates``: computes the observed orders of any table of errors, and judges them."""

import argparse
import json
import math
import sys
import textwrap
from dataclasses import asdict
from functools import partial
from pathlib import Path

from study.cli.options import OK, USAGE
from study.ledger.files import StoreError, write_text, write_whole
from study.ledger.printable import printable
from study.orders import OrderError, observed_orders
from study.orders.columns import Options, Series, read_series
from study.orders.reading import MAX_BYTES
from study.orders.report import Judged, as_json, as_junit, as_markdown, as_text, exit_code, finite, plot
from study.orders.sequences import OrderResult, grid_convergence


def do_rates(options: argparse.Namespace) -> int:
    """Read tables of errors, and print the observed orders and the verdicts.

    Returns:
        0 if all orders hold or none is expected, 1 if one fails, 2 for bad input, 3 if one is undecided.
    """
    judging = {name: getattr(options, name) for name in ("expected", "at_least", "junit", "markdown", "plot")}
    given = [f"--{name.replace('_', '-')}" for name, value in judging.items() if value is not None]
    file = ""
    # ``refusals`` cannot handle these errors: it imports packages that the extra ``[orders]`` does not install.
    try:
        if options.values and given:
            raise OrderError(f"with --values the columns have no expected order: leave out {', '.join(given)}")
        columns = tuple(options.columns.split(",")) if options.columns else ()
        reading = Options(options.dim, options.size, options.ratio, columns, signed=options.values)
        file = f"{options.file}: "
        tables = read_series(_read(options.file), reading)
        judged = [] if options.values else _judged(tables, options)
        file = ""
        values = _values(tables, options.json) if options.values else ""
        if options.plot:
            write_whole(options.plot, partial(plot, judged, suffix=options.plot.suffix))
        if options.junit:
            write_text(options.junit, printable(as_junit(judged)))
        if options.markdown:
            write_text(options.markdown, printable(as_markdown(judged)))
    except (OrderError, StoreError) as error:
        print(f"study: {file}{error}", file=sys.stderr)
        return USAGE
    if options.values:
        print(values)
        return OK
    print(json.dumps(as_json(judged), indent=2, ensure_ascii=False) if options.json else as_text(judged))
    return exit_code(judged)


def _judged(tables: list[Series], options: argparse.Namespace) -> Judged:
    """Compute the observed order of every column of errors, and compare it with its expected order.

    The expected order of a column is looked up by its name and case, then by its name, then by its case. A part of a
    name will do if only one column contains it.
    """
    columns = {name for series in tables for name in series.errors}
    known = {key for series in tables for name in series.errors for key in _keys(series, name)}
    ignored = {name: kind for series in tables for name, kind in series.ignored.items()}

    def in_full(part: str) -> str:
        matching = [name for name in columns if part.lower() in name.lower()]
        return matching[0] if part not in known | ignored.keys() and len(matching) == 1 else part

    given = [
        wish if isinstance(wish, dict) else {} if wish is None else {"": wish}
        for wish in (options.expected, options.at_least)
    ]
    wishes = [{in_full(name): order for name, order in wish.items()} for wish in given]
    used: set[str] = set()

    def result(series: Series, name: str, errors: list[float]) -> OrderResult:
        keys = _keys(series, name)
        used.update(keys)
        expected, at_least = (next((wish[key] for key in keys if key in wish), None) for wish in wishes)
        return observed_orders(series.h, errors, expected, at_least, options.tolerance, keys[0], options.floor)

    judged = [(series, [result(series, *column) for column in series.errors.items()]) for series in tables]
    if unknown := {name for wish in wishes for name in wish} - used:
        names = ", ".join(result.name for _, results in judged for result in results)
        left = "".join(
            f"; {name} was left out ({ignored[name]}): name all columns of errors with --columns"
            for name in unknown & ignored.keys()
        )
        raise OrderError(
            f"an order is expected of {', '.join(sorted(unknown))}, but the columns of errors are {names}{left}"
        )
    return judged


def _keys(series: Series, name: str) -> tuple[str, str, str, str]:
    """Return the names by which the expected order of a column is looked up: with its case, alone, the case, and ""."""
    return f"{name} ({series.label})" if series.label else name, name, series.label, ""


def _values(tables: list[Series], as_json: bool) -> str:
    """Return the order, the extrapolated value and the grid convergence index of each column of values, as text.

    Parameters:
        tables: the tables, whose columns contain values of quantities instead of errors.
        as_json: whether the text is JSON.
    """
    found = {
        _keys(series, name)[0]: grid_convergence(series.h, values)
        for series in tables
        for name, values in series.errors.items()
    }
    if as_json:
        entries = [{"name": name} | asdict(result) for name, result in found.items()]
        return json.dumps(finite(entries), indent=2, ensure_ascii=False)
    lines = []
    for name, result in found.items():
        line = f"{name}: {result.kind}"
        if math.isfinite(result.order) and math.isfinite(result.extrapolated):
            line += f", order {result.order:.2f}, extrapolated {result.extrapolated:.6g}"
            line += f", GCI {result.index:.2%} on the finest mesh" if math.isfinite(result.index) else ""
        lines.append(line)
    for series in tables:
        words = series.recognised.replace("errors:", "values:", 1)
        lines += ["", *textwrap.wrap(words, 80, subsequent_indent="    ")]
    return "\n".join(lines)


def _read(file: Path) -> bytes:
    """Return the content of a file or a pipe, or of standard input if the name is ``-``."""
    if str(file) == "-":
        return sys.stdin.buffer.read(MAX_BYTES + 1)
    if file.is_dir():
        raise OrderError("it is a directory; expected a file with a table of errors")
    if not file.exists():
        raise OrderError("there is no file of this name")
    with file.open("rb") as stream:
        return stream.read(MAX_BYTES + 1)
