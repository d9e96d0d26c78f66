"""``study cases``: the exact solutions."""

from __future__ import annotations

import argparse
import json
import textwrap

from manufactured.catalogue import catalogue
from study.cli.common import OK
from study.ledger.terminal import width
from study.run.foreseen import describe

INDENT = 4 * " "


def do_cases(options: argparse.Namespace) -> int:
    """``study cases``."""
    found = [describe(case) for case in catalogue()]
    if options.json:
        print(json.dumps(found, indent=2))
        return OK
    for case in found:
        print(f"{case['case']:<24}{case['dimension']}D  order {case['expected_order']:<5g}{case['statements']}")
        more = f"{case['summary']}; {case['regularity']}; law {case['law']}"
        print(textwrap.fill(more, width(), initial_indent=INDENT, subsequent_indent=INDENT))
    return OK
