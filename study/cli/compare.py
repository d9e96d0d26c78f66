"""``study compare``: which verdicts and numbers of two result directories differ, and by how much."""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path

from study.cli.common import FAILED, OK, Commands
from study.ledger.compare import Tolerance, as_json, as_text, compare
from study.ledger.errors import UsageError
from study.run.store import Store


def add(commands: Commands) -> None:
    """The command and its options."""
    purpose = "which numbers and verdicts of two result directories differ, and by how much"
    differ = commands.add_parser("compare", help=purpose)
    differ.add_argument("old", type=Path, metavar="OLD", help="directory of a run, its --out")
    differ.add_argument("new", type=Path, metavar="NEW", help="another one")
    relative = f"numbers a, b are equal if |a - b| <= Y + X max(|a|, |b|) (default {Tolerance.relative:g})"
    differ.add_argument("--tolerance", type=float, default=Tolerance.relative, metavar="X", help=relative)
    absolute = "(default 0) for numbers near round-off"
    differ.add_argument("--absolute", type=float, default=Tolerance.absolute, metavar="Y", help=absolute)
    differ.add_argument("--json", action="store_true", help="as JSON")
    differ.set_defaults(command=do_compare)


def do_compare(options: argparse.Namespace) -> int:
    """``study compare``."""
    for name in ("tolerance", "absolute"):
        if not 0 <= getattr(options, name) < math.inf:
            raise UsageError(f"--{name} must be a number, 0 or more, got {getattr(options, name):g}")
    with Store(options.old).steady(), Store(options.new).steady():
        found = compare(options.old, options.new, Tolerance(options.tolerance, options.absolute))
    if options.json:
        print(json.dumps(as_json(found), indent=2, ensure_ascii=False, allow_nan=False))
    else:
        print(as_text(found))
    return FAILED if found.differs else OK
