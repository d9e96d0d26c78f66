"""The verdicts of a finished run, from its data files; nothing is solved."""

from __future__ import annotations

from dataclasses import asdict, fields
from pathlib import Path

import pandas as pd

from study.fem.naming import resolve
from study.ledger.datafiles import DataError, read_csv, write_csv
from study.ledger.verdict import Verdict
from study.run.collect import BOUND_KEY, BOUNDS, ENCLOSURES, STATEMENT_COLUMNS, STATEMENT_KEY
from study.run.provenance import read_provenance
from study.statements import STATEMENTS, position
from study.statements.enclosure.claims import judge_bounds
from study.statements.prop_5_4.claims import complete, judge
from study.statements.prop_5_4.measure import Row
from study.statements.thm_4_2.predicted_orders import judge_stresses
from study.statements.thm_4_2.own_space import StressRow
from study.statements.thm_4_2.gaps import Gaps

RATE_KEY = ["case", "family", "scheme", "level"]
EQUIVALENCE_KEY = ["case", "family", "level"]


def check(directory: Path) -> list[Verdict]:
    """Judge the data on disk and write ``claims.csv``; nothing is solved.

    Raises:
        UsageError: no data.
        StoreError, DataError: data of another format, missing or damaged.
    """
    provenance = read_provenance(directory)
    rates = read_csv(directory, "rates.csv", [*RATE_KEY, *(field.name for field in fields(Row))])
    equivalence = read_csv(directory, "equivalence.csv", [*EQUIVALENCE_KEY, *Gaps._fields])
    stresses = read_csv(directory, "stresses.csv", [field.name for field in fields(StressRow)])
    statements = read_csv(directory, "statements.csv", STATEMENT_COLUMNS)
    bounds = read_csv(directory, "bounds.csv", BOUNDS)
    enclosures = read_csv(directory, "enclosures.csv", ENCLOSURES)
    cases = read_csv(directory, "cases.csv", ["case", "expected_order", "proved_order", "twin"])
    unknown = sorted({*rates["case"], *equivalence["case"]} - set(cases["case"]))
    if unknown:
        raise DataError(
            f"{directory}/data/cases.csv lacks {', '.join(unknown)}: make it with `study run --out {directory}`"
        )
    if without := keys(bounds, BOUND_KEY) - keys(enclosures, BOUND_KEY):
        lost = " ".join(min(without))
        raise DataError(f"{directory}/data/enclosures.csv lacks {lost}: make it with `study run --out {directory}`")
    found = keys(rates, RATE_KEY) | keys(equivalence, EQUIVALENCE_KEY)
    found |= keys(bounds, BOUND_KEY)
    found |= {(*key, "stress") for key in keys(stresses, EQUIVALENCE_KEY)}
    found |= {(*key, "statement") for key in keys(statements, STATEMENT_KEY)}
    planned = {tuple(key) for key in provenance["planned"]}
    verdicts = [complete(planned, found), *judge(rates, equivalence, cases), *judge_bounds(bounds, set(cases["case"]))]
    verdicts += judge_stresses(stresses, {case: resolve(case).regularity for case in stresses["case"].unique()})
    verdicts += judge_statements(statements)
    ordered = sorted(verdicts, key=lambda verdict: position(verdict.label))
    write_csv(directory / "data" / "claims.csv", pd.DataFrame([asdict(verdict) for verdict in ordered]))
    return ordered


def judge_statements(rows: pd.DataFrame) -> list[Verdict]:
    """The verdicts of every numbered statement that was measured, or that needs no measurement."""
    found: list[Verdict] = []
    for statement in STATEMENTS:
        mine = rows[rows["label"] == statement.label]
        if len(mine) or (len(rows) and not statement.settings(True)):
            found += statement.judge(mine)
    return found


def keys(table: pd.DataFrame, columns: list[str]) -> set[tuple[str, ...]]:
    """What identifies the rows of a table, as text."""
    return set(table[columns].astype(str).itertuples(index=False, name=None))
