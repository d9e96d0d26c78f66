"""Fingerprints of the rules by which checks of the ledger are judged: window, levels and statistic.

Seeds count for a check only if they were drawn after the last change to its rule. A change is detected by its effect.
All measured numbers are replaced by pseudo-random numbers near h, which depend only on the names of the file, the row
and the column, and these are judged. The fingerprint is a hash of the words, windows and values of the verdict and of
the levels of its measurements. Another window, level or statistic changes the fingerprint of this check and of no other
check; a rewritten rule with the same effect does not.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np
import pandas as pd

from study.controls.record import RowKey, fingerprint
from study.ledger.datafiles import CsvFile, read_csv
from study.ledger.verdict import UNCLAIMED, Verdict
from study.run.judgement import PREDICTED, data_files, judge_statement, predicted
from study.run.plan import Plan
from study.statements import STATEMENTS
from study.statements.shared.base import LISTED, Statement

KEPT = {"h", "k"}
"""Columns of numbers that are not measured, in addition to the key of a file."""
SCATTER = 0.2
"""Scatter of the logarithms of the numbers, which makes ratios and orders differ from row to row."""
ALL = "all cases"
"""The case name of checks about all cases."""


def rules(directory: Path, plan: Plan, whole: Plan) -> dict[RowKey, str]:
    """Return the fingerprint of the rule of each check, for the data of a plan in a directory.

    A check that needs more than the plan measured is left out, such as a check about all cases if the plan has some of
    them.
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
                if of == all_of and verdict.verdict not in UNCLAIMED:
                    found[row_of(verdict)] = fingerprint([_said(verdict), of])
    return found


def row_of(verdict: Verdict) -> RowKey:
    """Return the key of a check, which does not depend on the seed."""
    return verdict.label, verdict.key, verdict.case


def probe(file: CsvFile, table: pd.DataFrame) -> pd.DataFrame:
    """Return a table with pseudo-random numbers instead of the measured ones."""
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
    """Return a number between −1 and 1 that depends only on a name."""
    return int(hashlib.sha256(name.encode()).hexdigest()[:8], 16) / 2**31 - 1


def _said(verdict: Verdict) -> list[str]:
    """Return the texts of a verdict without the mesh family; numbers have six digits, equal on all machines."""
    words = [*row_of(verdict), verdict.quantity.removesuffix(f", {verdict.family} meshes"), verdict.expected]
    numbers = verdict.observed, verdict.low, verdict.high, verdict.window_low, verdict.window_high
    return [*words, verdict.verdict, *(f"{number:.6g}" for number in numbers)]


def _levels(plan: Plan, statement: Statement) -> list[tuple[str, str]]:
    """Return pairs (case, setting without case and mesh family) of all measurements by which a statement is judged."""
    own = [job for job in plan.jobs if job.statement.file == statement.file]
    if statement.file == LISTED:
        own = [job for job in own if job.statement.label == statement.label]
    hidden = {"case", "family"}
    return [
        (job.setting.case, repr(sorted((k, v) for k, v in vars(job.setting).items() if k not in hidden))) for job in own
    ]


def _of(case: str, levels: list[tuple[str, str]]) -> list[str]:
    """Return the settings of a case, or of all cases."""
    return sorted(text for mine, text in levels if case in (mine, ALL))
