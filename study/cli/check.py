"""``study check``: whether data, verdicts, tables and the inputs of the article are what they must be."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from study.cli.exits import FAILED, OK
from study.ledger.datafiles import DataError, read_claims, table_text
from study.ledger.differing import NUMBERS, difference
from study.ledger.terminal import folded
from study.ledger.verdict import Verdict, all_pass
from study.present.outcome import ledger_text, write_junit
from study.present.tables import texts
from study.run.judgement import claims, claims_file, verdicts
from study.run.store import Store
from study.run.verification import verify


def do_check(options: argparse.Namespace) -> int:
    """``study check``: exit 0 all hold and stand as they would be written, 1 a verdict is no pass, 2 they do not."""
    with Store(options.out).steady():
        compared = verify(options.out)
        found = verdicts(options.out)
        if options.junit:
            write_junit(options.junit, found)
        print(ledger_text(claims(found)))
        if not all_pass(found):
            return FAILED
        print(folded(f"{compared}; {as_written(options.out, found)}"))
    return OK


def as_written(directory: Path, found: Sequence[Verdict]) -> str:
    """Compare verdicts, tables and inputs of the article on disk with what would be written now; says how many.

    Raises:
        DataError: names the first line that differs, both texts, and the command that mends it.
    """
    path, again = claims_file(directory), f"`study tables --out {directory}` writes it again"
    if not path.is_file():
        raise DataError(f"{path} is missing: {again}")
    _refuse(difference(path, table_text(claims(found)), frozenset(NUMBERS)), again)
    read_claims(directory)
    there = {file: text for file, text in texts(directory).items() if file.is_file()}
    for file, text in there.items():
        _refuse(difference(file, text), again)
    return f"{len(found)} verdicts and {len(there)} files of tables and article stand as they would be written"


def _refuse(found: str | None, mend: str) -> None:
    if found:
        raise DataError(f"{found}: {mend}")
