"""``study cases``: the exact solutions."""

from __future__ import annotations

import argparse
import json

from manufactured.catalogue import catalogue
from study.cli.common import OK
from study.run.foreseen import describe


def do_cases(options: argparse.Namespace) -> int:
    """``study cases``."""
    found = [describe(case) for case in catalogue()]
    if options.json:
        print(json.dumps(found, indent=2))
        return OK
    for case in found:
        print(f"{case['case']:<24}{case['dimension']}D  order {case['expected_order']:<5g}{case['statements']}")
        print(f"    {case['summary']}; {case['regularity']}; law {case['law']}")
    return OK
