"""``study compare``: shows in which verdicts and numbers two result directories differ, and by how much."""

from __future__ import annotations

import argparse
import json
import math

from study.cli.options import FAILED, OK
from study.ledger.compare import Tolerance, as_json, as_text, compare
from study.ledger.files import UsageError
from study.run.store import Store


def do_compare(options: argparse.Namespace) -> int:
    """Compare two result directories and print the differences.

    Returns:
        0 if they agree within the tolerance, else 1.
    """
    tolerance = tolerance_from(options)
    with Store(options.old).steady(), Store(options.new).steady():
        found = compare(options.old, options.new, tolerance)
    if options.json:
        print(json.dumps(as_json(found), indent=2, allow_nan=False))
    else:
        print(as_text(found))
    return FAILED if found.differs else OK


def tolerance_from(options: argparse.Namespace) -> Tolerance:
    """Return the tolerance from the options ``--tolerance`` and ``--absolute``.

    Raises:
        UsageError: one of them is negative or not finite.
    """
    for name in ("tolerance", "absolute"):
        if not 0 <= getattr(options, name) < math.inf:
            raise UsageError(f"--{name} must be a number, 0 or more, got {getattr(options, name):g}")
    return Tolerance(options.tolerance, options.absolute)
