"""The committed results are what the code gives: measured again at small levels, judged again, drawn."""

from __future__ import annotations

import shutil
from dataclasses import asdict
from pathlib import Path

import pandas as pd
import pytest

from manufactured import catalogue
from study.equivalence import compare
from study.fem.mesh import FAMILIES
from study.naming import resolve
from study.run import check
from study.solve.evolution import Midpoint
from study.sweep import measure_case
from study.verdict import HOLDS

RESULTS = Path(__file__).parents[1] / "results"
RATES = pd.read_csv(RESULTS / "data" / "rates.csv")
EQUIVALENCE = pd.read_csv(RESULTS / "data" / "equivalence.csv")
CASES = [case.name for case in catalogue()]
MEASURED = ["h", "error", "at", "interpolation_error", "discrete_error", "time_share", "predicted_interpolation"]


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("level", [8, pytest.param(32, marks=pytest.mark.slow)])
def test_rows_measured_again_agree_with_the_committed_ones(case: str, level: int) -> None:
    for family in FAMILIES:
        (committed,) = RATES.query(f"case == '{case}' and family == '{family.name}' and level == {level}").to_dict(
            "records"
        )
        again = asdict(measure_case(resolve(case), family, level, Midpoint(), int(committed["steps"])))
        assert again["dofs"] == committed["dofs"]
        for column in MEASURED:
            assert again[column] == pytest.approx(committed[column], rel=1e-5, abs=1e-9), (family.name, column)


@pytest.mark.parametrize("case", CASES)
def test_both_formulations_agree_again(case: str) -> None:
    row = compare(resolve(case), FAMILIES[2], 4, 8)
    assert row.h == pytest.approx(EQUIVALENCE.query(f"case == '{case}' and level == 4")["h"].iloc[0])
    assert max(row.displacement_gap, row.stress_gap, row.admissibility, row.energy_gap, row.membership) <= 1e-7


def test_the_committed_verdicts_follow_from_the_committed_data_and_all_hold(tmp_path: Path) -> None:
    shutil.copytree(RESULTS / "data", tmp_path / "data", ignore=shutil.ignore_patterns("jobs", "pictures"))
    verdicts = check(tmp_path)
    committed = pd.read_csv(RESULTS / "data" / "claims.csv")
    again = pd.read_csv(tmp_path / "data" / "claims.csv")
    pd.testing.assert_frame_equal(again, committed, rtol=1e-6)
    assert {v.verdict for v in verdicts} == {HOLDS}


def test_the_committed_run_reaches_level_256_for_every_case() -> None:
    assert (RATES.groupby("case")["level"].max() >= 256).all()
    assert set(RATES["case"]) == set(CASES)


def test_no_verdict_on_prop_5_4_rests_on_the_interpolant_of_the_start() -> None:
    """The supremum is attained after t = 0 in four cases at least, and the time share is small in all."""
    rows = RATES[RATES["claim"] == "Prop. 5.4"]
    later = (rows["initial_error"] < 0.99 * rows["error"]).groupby(rows["case"]).all()
    assert later.sum() >= 4
    assert rows["time_share"].max() <= 0.02


def test_every_table_and_figure_of_the_committed_run_is_there() -> None:
    for name in ("rates", "ledger", "equivalence"):
        assert {path.suffix for path in (RESULTS / "tables").glob(f"{name}.*")} == {".csv", ".md", ".tex"}
    kinds = ("convergence", "zone", "profiles", "body")
    for name in ("convergence", "convergence-prop-5-3", *(f"{kind}-{case}" for kind in kinds for case in CASES)):
        assert (RESULTS / "figures" / f"{name}.pdf").is_file(), name
    assert (RESULTS / "figures" / "convergence.svg").is_file()
