"""Fingerprints of the rules by which checks are judged: tolerance window, levels and statistic.

The false-alarm rate is counted on random seeds that were drawn after the last change of a rule. A change is detected by
its effect on artificial data. All measured numbers are replaced by pseudo-random numbers that depend only on the names
of the file, the row and the column, and these numbers are judged. The fingerprint is a hash of the resulting verdict
(text, window, values) and of the levels of the measurements. So a new window, level or statistic changes the
fingerprint of its check and of no other check. Code that is rewritten with the same effect changes nothing.
"""

import hashlib
from pathlib import Path

import numpy as np
import pandas as pd

from study.ledger.datafiles import CsvFile, read_csv
from study.ledger.seeds import RowKey, fingerprint
from study.ledger.verdict import UNCLAIMED, Verdict
from study.run.judgement import PREDICTED, data_files, judge_statement, predicted
from study.run.plan import Plan
from study.statements import STATEMENTS
from study.statements.shared.base import LISTED, Statement

NOT_MEASURED = {"h", "k"}
"""Columns of numbers that are given, not measured: mesh size and time step. They are not replaced."""
SCATTER = 0.2
"""Largest change of the logarithm of an artificial number. So ratios and observed orders differ from row to row."""
ALL = "all cases"
"""Stands in place of the name of a case in checks that concern all cases."""


def rules(directory: Path, plan: Plan) -> dict[RowKey, str]:
    """Return for each check the fingerprint of the rule by which it is judged.

    Parameters:
        directory: the directory with the data of ``plan``.
        plan: the plan that was measured.
    """
    cases = read_csv(directory, "cases.csv", PREDICTED)
    files = [file for file in data_files() if isinstance(file, CsvFile)]
    tables = {file: predicted(probe(file, file.read(directory)), cases) for file in files}
    fingerprints = {}
    for statement in STATEMENTS:
        if isinstance(statement.file, CsvFile):
            settings = _settings(plan, statement)
            for verdict in judge_statement(statement, tables[statement.file]):
                if verdict.verdict not in UNCLAIMED:
                    measured = sorted(text for case, text in settings if verdict.case in (case, ALL))
                    fingerprints[row_of(verdict)] = fingerprint([_rule(verdict), measured])
    return fingerprints


def _rule(verdict: Verdict) -> list[str]:
    """Return the texts and numbers of a verdict on pseudo-random data, without the name of the mesh family.

    The name contains the seed. Numbers have six digits, which are the same on all machines.
    """
    quantity = verdict.quantity.removesuffix(f", {verdict.family} meshes")
    numbers = verdict.observed, verdict.low, verdict.high, verdict.window_low, verdict.window_high
    return [*row_of(verdict), quantity, verdict.expected, verdict.verdict, *(f"{number:.6g}" for number in numbers)]


def row_of(verdict: Verdict) -> RowKey:
    """Return label, key and case of a check, which together identify it on the meshes of every random seed."""
    return verdict.label, verdict.key, verdict.case


def probe(file: CsvFile, table: pd.DataFrame) -> pd.DataFrame:
    """Return a table of measurements with pseudo-random numbers in place of the measured ones.

    The numbers are about as large as the mesh size h, and depend only on the names of the file, the row and the column.

    Parameters:
        file: the data file, with its name and key columns.
        table: the measured table.
    """
    artificial = table.copy()
    key = table[[name for name in file.key if name != "family"]].astype(str).agg(" ".join, axis=1)
    if file == LISTED:
        key += " " + table["quantity"]
    size = table["h"].to_numpy() if "h" in table else np.ones(len(table))
    for column in table.columns:
        if column not in {*file.key, *NOT_MEASURED} and pd.api.types.is_float_dtype(table[column]):
            hashes = [hashlib.sha256(f"{file.name} {row} {column}".encode()).hexdigest() for row in key]
            # The first eight hexadecimal digits of each hash give a number between −1 and 1.
            chance = np.array([int(digits[:8], 16) / 2**31 - 1 for digits in hashes])
            artificial[column] = size * np.exp(SCATTER * chance)
    return artificial


def _settings(plan: Plan, statement: Statement) -> list[tuple[str, str]]:
    """Return the measurements that are used to judge a statement.

    Returns:
        One pair for each measurement: the case, and level and other parameters as text.
    """
    own = [job for job in plan.jobs if job.statement.file == statement.file]
    if statement.file == LISTED:
        own = [job for job in own if job.statement.label == statement.label]
    hidden = {"case", "family"}
    return [
        (job.setting.case, repr(sorted((k, v) for k, v in vars(job.setting).items() if k not in hidden))) for job in own
    ]
