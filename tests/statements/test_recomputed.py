"""Wrong errors in rates.csv are caught by the numbers that are computed again."""

from __future__ import annotations

from functools import lru_cache

import pandas as pd
import pytest

from study.fem.naming import resolve
from study.ledger.datafiles import CsvFile
from study.ledger.verdict import FAILS, HOLDS
from study.run.judgement import joined
from study.solve.steps import rate_steps
from study.solve.tableau import MIDPOINT
from study.statements.prop_5_4 import RATES, measure
from study.statements.recomputed import Recomputed, recompute
from study.statements.shared.base import Setting
from study.statements.shared.experiment import Experiment

CASES = "yield-and-release", "corner", "natural-front"


@lru_cache
def small_run(case: str) -> dict[CsvFile, pd.DataFrame]:
    """Both data files of one case on one mesh."""
    known, place = resolve(case), Setting(case, "one-diagonal", 8)
    setup = Experiment.at(place, MIDPOINT, rate_steps(known.solution.body.T, place.level, known.pace))
    row = measure(setup).row(case, place.family, place.level)
    again = {name: row[name] for name in ("case", "family", "scheme", "level", "h")} | recompute(setup)
    return {RATES: pd.DataFrame([row]), Recomputed.file: pd.DataFrame([again])}


def verdicts(tables: dict[CsvFile, pd.DataFrame]) -> dict[str, str]:
    return {verdict.key: verdict.verdict for verdict in Recomputed().judge(joined(Recomputed(), tables))}


@pytest.mark.parametrize("case", CASES)
def test_both_ways_agree_and_a_reported_size_that_is_wrong_by_a_factor_is_caught(case: str) -> None:
    tables = small_run(case)
    assert set(verdicts(tables).values()) == {HOLDS}
    for column, change in (("error", 0.01), ("interpolation_error", 0.01), ("discrete_error", 0.05)):
        for factor in (1 - change, 1 + change):
            found = verdicts({**tables, RATES: tables[RATES].assign(**{column: factor * tables[RATES][column]})})
            assert {key for key, verdict in found.items() if verdict == FAILS} == {column.replace("_", "-")}


def test_a_row_that_was_not_reported_fails() -> None:
    tables = small_run("corner")
    assert verdicts({**tables, RATES: tables[RATES].iloc[:0]})["error"] == FAILS
