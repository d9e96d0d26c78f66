"""``study rates``: orders of a published or foreign error table."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from study.cli.common import FAILED, OK, Commands
from study.ledger.published import as_json, as_text, read_table, report
from study.ledger.verdict import HOLDS


def add(commands: Commands) -> None:
    """The command and its options."""
    published = commands.add_parser("rates", help="orders of a published or foreign error table")
    published.add_argument("file", type=Path, metavar="FILE.csv", help="columns h or n, and one or more of errors")
    published.add_argument("--expected", type=float, metavar="P", help="judge the orders against this one")
    published.add_argument("--json", action="store_true", help="as JSON")
    published.set_defaults(command=do_rates)


def do_rates(options: argparse.Namespace) -> int:
    """``study rates``."""
    h, columns = read_table(options.file)
    found = [report(name, h, errors, options.expected) for name, errors in columns.items()]
    if options.json:
        print(json.dumps([as_json(column) for column in found], indent=2))
    else:
        print("\n".join(as_text(column) for column in found))
    return OK if all(column.verdict in (None, HOLDS) for column in found) else FAILED
