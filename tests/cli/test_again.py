"""``study check --again N`` measures a random sample of the rows again and compares them."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest

from study.ledger.datafiles import write_csv
from study.run.check import LEAST_COST, draw_jobs, expected_seconds, planned_jobs

ALL = "1000"


@pytest.fixture
def checked(told) -> Callable[..., str]:
    """``study check`` in one process, with further options."""
    return partial(told, "check", "--jobs", "1")


@pytest.mark.slow
def test_rows_measured_again_agree_and_the_seed_is_printed(own: Path, checked) -> None:
    before = {path: path.read_bytes() for path in own.rglob("*.csv")}
    said = checked("--again", "2", "--out", str(own), code=0)
    seed = re.search(r"measured again: 2 of (\d+) measurements, drawn with --seed (\d+)", " ".join(said.split()))
    assert seed
    assert "all numbers agree within 1e-05 relative + 1e-09" in said
    assert f"drawn with --seed {seed[2]}," in checked("--again", "2", "--seed", seed[2], "--out", str(own), code=0)
    assert {path: path.read_bytes() for path in own.rglob("*.csv")} == before


def test_rows_that_were_changed_are_noticed(own: Path, checked, monkeypatch) -> None:
    """No relation between columns shows these changes, in the first rows. Only their measurements are repeated."""
    changes = {"rates.csv": ("quadrature_change", 1.001), "equivalence.csv": ("steps", 2.0)}
    jobs = planned_jobs(own)
    first = [next(job for job in jobs if job.statement.file.name == file) for file in changes]
    monkeypatch.setattr("study.cli.check.draw_jobs", lambda jobs, count, seed: first)
    for file, (column, factor) in changes.items():
        path = own / "data" / file
        table = pd.read_csv(path, dtype=str, keep_default_na=False)
        table.loc[0, column] = f"{factor * float(table.loc[0, column]):.12g}"
        write_csv(path, table)
    said = checked("--again", ALL, "--out", str(own), code=1)
    for file, (column, _) in changes.items():
        assert f"{file}: differs" in said
        assert re.search(rf"{column}: 1 of \d+ differ, 1 beyond tolerance", said)
    assert "was changed after the run that wrote it" in checked("--out", str(own), code=2)


def test_a_case_whose_file_is_gone_cannot_be_measured_again(own: Path, checked) -> None:
    (own.parent / "pocket.py").unlink()
    said = checked("--again", "1", "--out", str(own), code=2)
    assert "--again needs the files of all cases; the files of pocket no longer exist" in said


def test_a_seed_without_rows_to_draw_is_refused(checked) -> None:
    assert "--seed chooses the rows of --again: give --again N with it" in checked("--seed", "1")


def test_a_sample_is_repeated_by_its_seed_and_its_expected_time_is_bounded() -> None:
    jobs: list[Any] = [SimpleNamespace(cost=1e6 * second) for second in np.geomspace(0.01, 300, 500)]
    drawn = [draw_jobs(jobs, 5, seed) for seed in range(400)]
    assert drawn[3] == draw_jobs(jobs, 5, 3)
    assert drawn[3] != drawn[4]
    assert all(len({job.cost for job in sample}) == 5 for sample in drawn)
    costs = np.maximum([job.cost for job in jobs], LEAST_COST)
    bound = 5 * len(jobs) / (1 / costs).sum() / 1e6
    mean = np.mean([expected_seconds(sample) for sample in drawn])
    assert 0.6 * bound < mean < 1.6 * bound < 0.16 * 5 * costs.mean() / 1e6
    assert len(draw_jobs(jobs, 10**6, 0)) == len(jobs)


def test_every_measurement_with_rows_in_a_table_can_be_drawn(own: Path) -> None:
    jobs = planned_jobs(own)
    assert {job.statement.file.name for job in jobs} == {"rates.csv", "equivalence.csv", "contact.csv"}
    assert {job.key for job in draw_jobs(jobs, len(jobs), 1)} == {job.key for job in jobs}
