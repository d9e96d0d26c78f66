"""``study check``: the verdicts on the data on disk."""

from __future__ import annotations

import argparse
from pathlib import Path

from study.cli.common import Commands, exit_code, out_option
from study.present.junit import write_junit
from study.present.terminal import ledger_text
from study.run.judgement import check as judge
from study.run.store import Store


def add(commands: Commands) -> None:
    """The command and its options."""
    check = commands.add_parser("check", help="judge the data on disk; nothing is solved")
    check.add_argument("--junit", type=Path, metavar="FILE", help="also write the verdicts as JUnit XML")
    out_option(check)
    check.set_defaults(command=do_check)


def do_check(options: argparse.Namespace) -> int:
    """``study check``."""
    with Store(options.out).steady():
        verdicts = judge(options.out)
    if options.junit:
        write_junit(options.junit, verdicts)
    print(ledger_text(options.out))
    return exit_code(verdicts)
