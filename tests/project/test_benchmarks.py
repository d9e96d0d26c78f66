"""Smoke test of the programs in `benchmarks/` on tiny problems; no timing is tested."""

import json
import platform
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from benchmarks import fine_levels, growth, report


def test_tables_name_the_machine_but_no_host_and_no_path(tmp_path):
    report.write(tmp_path, "one", pd.DataFrame({"a": [1.23456, np.nan]}), "One", ["A note."])
    assert "| 1.23 | | – |" in " ".join((tmp_path / "one.md").read_text().split())
    machine = json.loads((tmp_path / "machine.json").read_text())["one"]
    assert {"processor", "cores", "python", "numpy", "scipy", "blas"} <= machine.keys()
    for secret in (platform.node(), str(Path.home()), str(report.ROOT)):
        assert not any(secret in str(value) for value in machine.values())


@pytest.mark.parametrize("solver", ["direct", "multigrid"])
def test_a_level_of_the_growth_table_is_measured(solver):
    row = growth.Level("advance-recede", 4, solver).measure()
    assert [*row, "remark"] == growth.COLUMNS
    assert row["dofs"] == 40
    assert all(value > 0 for name, value in row.items() if name != "solver")
    dofs = np.array([1e3, 4e3, 16e3])
    assert growth.exponent(dofs, 3e-5 * dofs**1.17) == pytest.approx(1.17)


def test_nodal_errors_near_the_front_do_not_depend_on_the_quadrature(monkeypatch):
    measured = fine_levels.natural_front(16)
    monkeypatch.setattr(fine_levels, "EDGE_POINTS", 400)
    monkeypatch.setattr(fine_levels, "NEAR", 8.0)
    assert fine_levels.natural_front(16) == pytest.approx(measured, rel=1e-4)
