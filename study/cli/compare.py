"""``study compare``: which verdicts and numbers of two result directories differ, and by how much."""

from __future__ import annotations

import argparse
import json

from study.cli.exits import FAILED, OK
from study.cli.tolerance import tolerance_from
from study.ledger.compare import as_json, as_text, compare
from study.run.store import Store


def do_compare(options: argparse.Namespace) -> int:
    """``study compare``."""
    tolerance = tolerance_from(options)
    with Store(options.old).steady(), Store(options.new).steady():
        found = compare(options.old, options.new, tolerance)
    if options.json:
        print(json.dumps(as_json(found), indent=2, allow_nan=False))
    else:
        print(as_text(found))
    return FAILED if found.differs else OK
