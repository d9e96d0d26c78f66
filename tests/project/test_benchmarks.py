"""Smoke test of the programs in `benchmarks/` on tiny problems; no timing is tested."""

from __future__ import annotations

import json
import platform
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from benchmarks import compare, curved, growth, parallel, ratios, report
from benchmarks.peers import problem as exchange
from study.solve.tableau import BACKWARD_EULER

PYTHON = "/usr/bin/python3"
SECONDS = {"factorisation": 1.0, "condensation": 0.5, "solve": 0.1, "level": 37.0}


def statistics(seconds: float) -> dict[str, float]:
    """Quartiles 20 % away from the median."""
    return {"median": seconds, "q1": 0.8 * seconds, "q3": 1.2 * seconds}


def benchmark(quantity: str, seconds: float, **more: object) -> dict[str, object]:
    """One benchmark in the form in which pytest-benchmark writes it."""
    place = {"quantity": quantity, "case": "c", "family": "f", "n": 8, "dofs": 144}
    return {"name": quantity, "stats": statistics(seconds) | {"rounds": 3}, "extra_info": place | more}


BENCHMARKS = [
    *(benchmark(*timing) for timing in SECONDS.items()),
    benchmark("step", 0.3, beside={"solve between steps": statistics(0.2)}),
]


def test_ratios_are_tabulated_and_a_ratio_that_grew_is_a_warning_and_no_failure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    table = ratios.table(BENCHMARKS)
    expected = {"contact step": 1.5, "condensation": 0.5, "level": 37 / (1 + 64 * 0.1)}
    for name, value in expected.items():
        (row,) = table[table["ratio"].str.startswith(name)].to_dict("records")
        assert (row["value"], row["low"]) == pytest.approx((value, value * 0.8 / 1.2))
        assert row["met"] == ("yes" if value <= row["goal"] else "no")
    (tmp_path / "timings.json").write_text(json.dumps({"benchmarks": BENCHMARKS}))
    for growth_of_ratio, warnings in ((1.24, 0), (1.26, len(table))):
        before = table.assign(value=table["value"] / growth_of_ratio)
        monkeypatch.setattr(ratios, "committed", lambda path, before=before: before)
        ratios.main(tmp_path / "timings.json", tmp_path)
        assert capsys.readouterr().out.count("WARNING: ") == warnings
    pd.testing.assert_frame_equal(pd.read_csv(tmp_path / "ratios.csv"), table, rtol=1e-5, check_dtype=False)


def test_tables_name_the_machine_but_no_host_and_no_path(tmp_path: Path) -> None:
    report.write(tmp_path, "one", pd.DataFrame({"a": [1.23456, np.nan]}), "One", ["A note."])
    assert "| 1.23 | | – |" in " ".join((tmp_path / "one.md").read_text().split())
    machine = json.loads((tmp_path / "machine.json").read_text())["one"]
    assert {"processor", "cores", "python", "numpy", "scipy", "blas"} <= machine.keys()
    for secret in (platform.node(), str(Path.home()), str(report.ROOT)):
        assert not any(secret in str(value) for value in machine.values())


@pytest.mark.parametrize("solver", ["direct", "multigrid"])
def test_a_level_of_the_growth_table_is_measured(solver: str) -> None:
    row = growth.Level("advance-recede", 4, solver).measure()
    assert [*row, "remark"] == growth.COLUMNS
    assert row["dofs"] == 40
    assert all(value > 0 for name, value in row.items() if name != "solver")
    dofs = np.array([1e3, 4e3, 16e3])
    assert growth.exponent(dofs, 3e-5 * dofs**1.17) == pytest.approx(1.17)


def test_two_processes_are_judged_by_time_and_by_equal_data() -> None:
    files = {"rates.csv": b"1\n", "claims.csv": b"2\n"}
    for seconds, others, met, identical in (
        (10.1, files, "no", "yes"),
        (9.9, files, "yes", "yes"),
        (9.9, files | {"rates.csv": b"1\r\n"}, "yes", "no"),
        (9.9, {"rates.csv": b"1\n"}, "yes", "no"),
    ):
        (row,) = parallel.table("--quick", (17.0, files), (seconds, others)).to_dict("records")
        assert (row["met"], row["identical"]) == (met, identical)


def test_programs_that_are_installed_solve_the_same_problem(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    problem = compare.export(8, tmp_path / "problem.npz")
    given = exchange.load(tmp_path / "problem.npz")
    assert abs(given.S - (problem.M / given.k + problem.reference)).max() < 1e-12 * abs(given.S).max()
    ours = compare.run(compare.OURS, tmp_path / "problem.npz", 60, PYTHON)
    states = list(BACKWARD_EULER.march(problem, compare.STEPS))[1:]
    assert compare.distance(problem.M, np.array([state.u for state in states]), ours.u) < 1e-12

    installed = [peer for peer in compare.PEERS if peer.installed(PYTHON)]
    assert {"scikit-fem, naive active set", "SciPy, condensed once", "Clarabel"} <= {peer.name for peer in installed}
    for peer in installed:
        line = compare.row(peer, [compare.run(peer, tmp_path / "problem.npz", 60, PYTHON)], [ours], problem, 8)
        assert (line["remark"], line["agreement"] <= compare.AGREEMENT, line["ratio"] > 0) == ("", True, True), line

    other = compare.Run(ours.u * (1 + 2 * compare.AGREEMENT), {"seconds": 1.0})
    line = compare.row(compare.PEERS[0], [other], [ours], problem, 8)
    assert (line["remark"], "ratio" in line) == ("disagrees: not compared", False)
    monkeypatch.setattr(compare, "HERE", tmp_path)
    for script, remark in (
        ("import time; time.sleep(60)", "stopped after 1 s"),
        ("exit('no memory')", "failed: no memory"),
    ):
        (tmp_path / "peer.py").write_text(script)
        failed = compare.run(compare.Peer("peer", "peer.py", ()), tmp_path / "problem.npz", 0.6, sys.executable)
        assert failed.remark == remark


def test_on_a_curved_face_exact_normals_give_the_smaller_distance_to_the_interpolant() -> None:
    coarse, fine = curved.errors(8, 0), curved.errors(16, 0)
    assert all(1.5 < before["error"] / after["error"] < 2.5 for before, after in zip(coarse, fine, strict=True))
    exact, averaged = fine
    assert exact["distance"] == 0 < averaged["distance"] < averaged["error"]
