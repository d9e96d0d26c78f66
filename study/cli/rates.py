"""``study rates``: orders of a published or foreign error table."""

from __future__ import annotations

import argparse
import json

from study.cli.exits import FAILED, OK
from study.ledger.published import as_json, as_text, read_table, report
from study.ledger.verdict import HOLDS


def do_rates(options: argparse.Namespace) -> int:
    """``study rates``."""
    h, columns = read_table(options.file)
    found = [report(name, h, errors, options.expected) for name, errors in columns.items()]
    if options.json:
        print(json.dumps([as_json(column) for column in found], indent=2))
    else:
        print("\n".join(as_text(column) for column in found))
    return OK if all(column.verdict in (None, HOLDS) for column in found) else FAILED
