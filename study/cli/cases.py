"""``study cases``: lists the exact solutions."""

import argparse
import json
import textwrap

from manufactured.catalogue import catalogue
from study.cli.options import OK
from study.fem.naming import outside_the_catalogue
from study.ledger.text import width
from study.run.case_line import describe

INDENT = 4 * " "


def do_cases(options: argparse.Namespace) -> int:
    """Print the exact solutions of the catalogue; return 0."""
    lines = [describe(case) for case in catalogue()]
    if options.json:
        print(json.dumps(lines, indent=2))
        return OK
    for case in lines:
        print(f"{case['case']:<24}{case['dimension']}D  order {case['expected_order']:<6.3g}{case['statements']}")
        more = f"{case['summary']}; {case['regularity']}; law {case['law']}"
        print(textwrap.fill(more, width(), initial_indent=INDENT, subsequent_indent=INDENT))
    further = ", ".join(case.name for case in outside_the_catalogue())
    print(textwrap.fill(f"Further cases, which only single statements use: {further}", width()))
    return OK
