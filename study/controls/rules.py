"""What a row of the ledger is judged by, as a fingerprint: its window, its levels, and what its rule makes of numbers.

Seeds count for a row only if they were drawn after the last change to it. So that this can be checked, the rule of a
row is known by what it does: all that was measured is replaced by numbers that depend on nothing but the names of the
file, the row and the column, near h times a factor of chance, and judged. Words, windows and values of the verdict and
the levels of its measurements are hashed. Another window, level or statistic gives another fingerprint of this row and
of no other; other code that says the same gives the same.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np
import pandas as pd

from study.controls.record import RowKey, fingerprint
from study.ledger.datafiles import CsvFile, read_csv
from study.ledger.verdict import REPORTED, Verdict
from study.run.judgement import PREDICTED, data_files, judge_statement, predicted
from study.run.plan import Plan
from study.statements import STATEMENTS
from study.statements.shared.base import LISTED, Statement

KEPT = {"h", "k"}
"""Columns of numbers that are not measured, beside those of the key of a file."""
SCATTER = 0.2
"""Of the logarithms of the numbers, so that ratios and orders differ from one row to the next."""
ALL = "all cases"
"""What stands for the case in rows about all."""


def rules(directory: Path, plan: Plan, whole: Plan) -> dict[RowKey, str]:
    """The fingerprints of the rows that are judged of the data of a plan in a directory.

    Rows about more than was measured, as those about all cases where the plan is a part of the whole, have none.
    """
    cases = read_csv(directory, "cases.csv", PREDICTED)
    files = [file for file in data_files() if isinstance(file, CsvFile)]
    tables = {file: predicted(probe(file, file.read(directory)), cases) for file in files}
    found = {}
    for statement in STATEMENTS:
        if isinstance(statement.file, CsvFile):
            measured, wanted = (_levels(some, statement) for some in (plan, whole))
            for verdict in judge_statement(statement, tables[statement.file]):
                of, all_of = (_of(verdict.case, levels) for levels in (measured, wanted))
                if of == all_of and verdict.verdict != REPORTED:
                    found[row_of(verdict)] = fingerprint([_said(verdict), of])
    return found


def row_of(verdict: Verdict) -> RowKey:
    """What a row is known by on the meshes of any seed."""
    return verdict.label, verdict.key, verdict.case


def probe(file: CsvFile, table: pd.DataFrame) -> pd.DataFrame:
    """The table with numbers made up in place of what was measured."""
    found = table.copy()
    key = table[[name for name in file.key if name != "family"]].astype(str).agg(" ".join, axis=1)
    if file == LISTED:
        key += " " + table["quantity"]
    size = table["h"].to_numpy() if "h" in table else np.ones(len(table))
    for column in table.columns:
        if column not in {*file.key, *KEPT} and pd.api.types.is_float_dtype(table[column]):
            chance = [_chance(f"{file.name} {row} {column}") for row in key]
            found[column] = size * np.exp(SCATTER * np.array(chance))
    return found


def _chance(name: str) -> float:
    """A number between −1 and 1 that depends on a name alone."""
    return int(hashlib.sha256(name.encode()).hexdigest()[:8], 16) / 2**31 - 1


def _said(verdict: Verdict) -> list[str]:
    """What a verdict says, without the name of the meshes; numbers with digits that no machine changes."""
    words = [*row_of(verdict), verdict.quantity.removesuffix(f", {verdict.family} meshes"), verdict.expected]
    numbers = verdict.observed, verdict.low, verdict.high, verdict.window_low, verdict.window_high
    return [*words, verdict.verdict, *(f"{number:.6g}" for number in numbers)]


def _levels(plan: Plan, statement: Statement) -> list[tuple[str, str]]:
    """(case, setting without case and meshes) of all measurements that a statement is judged by."""
    own = [job for job in plan.jobs if job.statement.file == statement.file]
    if statement.file == LISTED:
        own = [job for job in own if job.statement.label == statement.label]
    hidden = {"case", "family"}
    return [
        (job.setting.case, repr(sorted((k, v) for k, v in vars(job.setting).items() if k not in hidden))) for job in own
    ]


def _of(case: str, levels: list[tuple[str, str]]) -> list[str]:
    """The settings of a case, or of all."""
    return sorted(text for mine, text in levels if case in (mine, ALL))
