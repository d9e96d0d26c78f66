"""``study compare``: shows in which verdicts and numbers two result directories differ, and by how much."""

import argparse
import json

from study.cli.options import FAILED, OK
from study.ledger.compare import Tolerance, as_text, compare
from study.run.store import Store


def do_compare(options: argparse.Namespace) -> int:
    """Compare two result directories and print the differences.

    Returns:
        0 if they agree within the tolerance, else 1.
    """
    tolerance = Tolerance(options.tolerance, options.absolute)
    with Store(options.old).steady(), Store(options.new).steady():
        comparison = compare(options.old, options.new, tolerance)
    print(json.dumps(comparison.as_json(), indent=2, allow_nan=False) if options.json else as_text(comparison))
    return FAILED if comparison.differs else OK
