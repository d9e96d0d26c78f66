"""``study cases``: the exact solutions."""

from __future__ import annotations

import argparse
import json
import textwrap

from manufactured.kept import kept
from study.cli.exits import OK
from study.ledger.terminal import width
from study.run.code import code_of_all

INDENT = 4 * " "


def do_cases(options: argparse.Namespace) -> int:
    """``study cases``."""
    text = kept(f"study cases, {code_of_all()}", _described)
    if options.json:
        print(text)
        return OK
    for case in json.loads(text):
        print(f"{case['case']:<24}{case['dimension']}D  order {case['expected_order']:<6.3g}{case['statements']}")
        more = f"{case['summary']}; {case['regularity']}; law {case['law']}"
        print(textwrap.fill(more, width(), initial_indent=INDENT, subsequent_indent=INDENT))
    return OK


def _described() -> str:
    """The lines of all cases; imported here is what takes seconds."""
    from manufactured.catalogue import catalogue
    from study.run.foreseen import describe

    return json.dumps([describe(case) for case in catalogue()], indent=2)
