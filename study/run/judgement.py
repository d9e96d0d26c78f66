"""The verdicts of a finished run, from its data files; nothing is solved."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

import pandas as pd

from manufactured.catalogue import catalogue
from study.ledger.datafiles import CsvFile, DataError, made_by, read_csv, write_csv
from study.ledger.verdict import Verdict
from study.run.collect import data_files
from study.run.measured import read_tables
from study.run.provenance import Complete, read_provenance
from study.statements import STATEMENTS
from study.statements.enclosure import BOUNDS, ENCLOSURES
from study.statements.own_cases import judge_own
from study.statements.prop_5_4 import RATES
from study.statements.shared.base import LISTED, REPORTED, Statement
from study.statements.unmeasured import Listed

PREDICTED = ["case", "expected_order", "proved_order", "twin"]


def judge(directory: Path) -> list[Verdict]:
    """Judge the data on disk and write ``claims.csv``; errors as ``verdicts``."""
    found = verdicts(directory)
    write_csv(claims_file(directory), claims(found))
    return found


def claims_file(directory: Path) -> Path:
    """``claims.csv`` of a run."""
    return directory / "data" / "claims.csv"


def claims(found: Sequence[Verdict]) -> pd.DataFrame:
    """The table of verdicts."""
    return pd.DataFrame([asdict(verdict) for verdict in found])


def verdicts(directory: Path) -> list[Verdict]:
    """Judge the data on disk; nothing is solved, and nothing written.

    Raises:
        UsageError: no data.
        StoreError, DataError: data of another format, missing or damaged.
    """
    planned = {tuple(key) for key in read_provenance(directory)["planned"]}
    tables = read_tables(directory)
    cases = read_csv(directory, "cases.csv", PREDICTED)
    _refuse_gaps(directory, tables, cases)
    found = set().union(*(file.keys(table) for file, table in tables.items()))
    judged = {file: predicted(table, cases) for file, table in tables.items()}
    judged |= {file: file.read(directory) for file in beside_runs()}
    rows = [Complete().judge(planned, found)]
    for statement in STATEMENTS:
        if isinstance(statement.file, CsvFile):
            rows += judge_statement(statement, beside(statement, judged))
    return with_reasons(rows, judged[RATES])


def predicted(table: pd.DataFrame, cases: pd.DataFrame) -> pd.DataFrame:
    """A table with what is predicted of its cases, and whether their exact solution is known."""
    new = [name for name in PREDICTED if name not in table or name == "case"]
    return table.merge(cases[new], on="case", how="left").assign(known=table["case"].isin(cases["case"]).to_numpy())


def beside(statement: Statement, tables: Mapping[CsvFile, pd.DataFrame]) -> pd.DataFrame:
    """The rows that a statement is judged by, with those of another file beside them where it compares both."""
    assert isinstance(statement.file, CsvFile)
    mine, key = tables[statement.file], list(statement.file.key)
    if statement.beside is None:
        return mine
    other = tables[statement.beside].set_index(key).add_suffix(REPORTED).reset_index()
    return mine.merge(other, on=key, how="left")


def beside_runs() -> set[CsvFile]:
    """The files that statements are compared with and no run makes."""
    return {statement.beside for statement in STATEMENTS if statement.beside} - set(data_files())


def with_reasons(verdicts: Sequence[Verdict], rates: pd.DataFrame) -> list[Verdict]:
    """The verdicts, where those on a user's own case fail only if the data contradict the statement."""
    own = {str(case): rows for case, rows in rates.groupby("case") if case not in {known.name for known in catalogue()}}
    judged = {case: iter(judge_own([v for v in verdicts if v.case == case], rows)) for case, rows in own.items()}
    return [next(judged[verdict.case]) if verdict.case in judged else verdict for verdict in verdicts]


def judge_statement(statement: Statement, rows: pd.DataFrame) -> list[Verdict]:
    """The verdicts of a statement that was measured, or that needs no measurement beside others."""
    of_all = statement.file != LISTED or isinstance(statement, Listed)
    mine = rows if of_all else rows[rows["label"] == statement.label]
    return statement.judge(mine) if len(mine) else []


def _refuse_gaps(directory: Path, tables: dict[CsvFile, pd.DataFrame], cases: pd.DataFrame) -> None:
    """Refuse measurements without their case, and bounds without their course in time."""
    again = f"make it with `{made_by(directory)}`"
    measured = {case for file, table in tables.items() if file.name in EVERY_CASE for case in table["case"]}
    if unknown := sorted(measured - set(cases["case"])):
        raise DataError(f"{directory}/data/cases.csv lacks {', '.join(unknown)}: {again}")
    bounds, courses = ({key[1:] for key in file.keys(tables[file])} for file in (BOUNDS, ENCLOSURES))
    if without := bounds - courses:
        raise DataError(f"{directory}/data/enclosures.csv lacks {' '.join(min(without))}: {again}")


EVERY_CASE = {statement.file.name for statement in STATEMENTS if statement.of_every_case}
