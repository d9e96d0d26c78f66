"""Wrong errors in rates.csv are caught by the numbers that are computed again."""

from __future__ import annotations

from functools import lru_cache

import pandas as pd
import pytest

from study.fem.naming import family_named, resolve
from study.ledger.datafiles import CsvFile
from study.ledger.verdict import FAILS, HOLDS
from study.run.judgement import joined
from study.solve.steps import rate_steps
from study.solve.tableau import MIDPOINT
from study.statements.prop_5_4 import RATES, measure
from study.statements.recomputed import Recomputed, recompute
from study.statements.shared.experiment import Experiment

CASES = "full-contact", "yield-and-release", "corner", "natural-front"
LEVEL = 8


@lru_cache
def setup_of(case: str) -> Experiment:
    known = resolve(case)
    steps = rate_steps(known.solution.body.T, LEVEL, known.pace)
    return Experiment.of(known.solution, family_named("one-diagonal"), LEVEL, MIDPOINT, steps)


@lru_cache
def small_run(case: str) -> dict[CsvFile, pd.DataFrame]:
    """Both data files of one case on one mesh."""
    setup = setup_of(case)
    row = measure(setup).row(case, "one-diagonal", LEVEL)
    again = {name: row[name] for name in ("case", "family", "scheme", "level", "h")} | recompute(setup)
    return {RATES: pd.DataFrame([row]), Recomputed.file: pd.DataFrame([again])}


def verdicts(tables: dict[CsvFile, pd.DataFrame]) -> dict[str, str]:
    rows = joined(Recomputed(), tables)
    return {verdict.key: verdict.verdict for verdict in Recomputed().judge(rows)}


@pytest.mark.parametrize("case", CASES)
def test_both_ways_agree(case: str) -> None:
    assert set(verdicts(small_run(case)).values()) == {HOLDS}


FACTORS = [("error", 1.01), ("error", 0.99), ("discrete_error", 0.95), ("discrete_error", 1.05)]
FACTORS += [("interpolation_error", 0.99), ("interpolation_error", 1.01)]


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize(("column", "factor"), FACTORS)
def test_a_reported_size_that_is_wrong_by_a_factor_is_caught(case: str, column: str, factor: float) -> None:
    tables = small_run(case)
    tampered = tables[RATES].assign(**{column: factor * tables[RATES][column]})
    found = verdicts({**tables, RATES: tampered})
    assert {key for key, verdict in found.items() if verdict == FAILS} == {column.replace("_", "-")}


def test_a_row_that_was_not_reported_fails() -> None:
    tables = small_run("full-contact")
    assert verdicts({**tables, RATES: tables[RATES].iloc[:0]})["error"] == FAILS
