"""Tables of benchmarks, their warnings, and what peers are given; no timing is tested."""

from __future__ import annotations

import json
import platform
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import scipy.sparse as sps
from benchmarks import compare, growth, parallel, ratios, report
from benchmarks.level import DIRECT, Place, Watched, errors
from benchmarks.peers import problem as exchange

from study.fem.mesh import OneDiagonal
from study.fem.naming import resolve
from study.fem.space import Space
from study.solve.tableau import BACKWARD_EULER

SYSTEM = "/usr/bin/python3"
TIMINGS = {"factorisation": 1.0, "condensation": 0.5, "solve": 0.1, "level": 37.0}


def statistics(seconds: float) -> dict:
    """Quartiles 20 % off the median."""
    return {"median": seconds, "q1": 0.8 * seconds, "q3": 1.2 * seconds}


def record(quantity: str, seconds: float, **more: Any) -> dict:
    """One benchmark as pytest-benchmark writes it."""
    info = {"quantity": quantity, "case": "c", "family": "f", "n": 8, "dofs": 144, **more}
    return {"name": quantity, "stats": statistics(seconds) | {"rounds": 3}, "extra_info": info}


STEP = record("step", 0.3, beside={"solve between steps": statistics(0.2)})
BENCHMARKS = [*(record(*timing) for timing in TIMINGS.items()), STEP]


@pytest.fixture
def table() -> pd.DataFrame:
    return ratios.table(BENCHMARKS)


@pytest.mark.parametrize(
    ("name", "value", "met"),
    [("contact step", 1.5, "no"), ("condensation", 0.5, "yes"), ("level", 37 / (1 + 64 * 0.1), "no")],
)
def test_a_ratio_is_that_of_medians_and_knows_its_goal(table, name: str, value: float, met: str) -> None:
    (row,) = table[table["ratio"].str.startswith(name)].to_dict("records")
    assert row["value"] == pytest.approx(value)
    assert row["met"] == met
    assert row["low"] == pytest.approx(value * 0.8 / 1.2)
    assert row["high"] == pytest.approx(value * 1.2 / 0.8)


def test_a_ratio_whose_timings_are_missing_has_no_row() -> None:
    assert list(ratios.table([record("solve", 0.1), STEP])["ratio"]) == ["contact step / bare solve"]


def test_counts_of_a_nonlinear_law_are_rows_without_spread_and_the_worst_step_is_one() -> None:
    found = ratios.table([record("nonlinear", 2.0, most_solves=7, mean_solves=5.5, factorisations=1)])
    assert dict(zip(found["value"], found["met"], strict=True)) == {7.0: "no", 5.5: "yes", 1.0: "yes"}
    assert (found["low"] == found["high"]).all()


def test_a_ratio_that_grew_by_more_than_a_quarter_is_reported_and_no_other(table) -> None:
    assert ratios.regressions(table.assign(value=1.249 * table["value"]), table) == []
    assert ratios.regressions(table.assign(value=0.5 * table["value"]), table) == []
    worse = table.copy()
    worse.loc[0, "value"] *= 1.26
    (line,) = ratios.regressions(worse, table)
    assert line.startswith(f"{table.loc[0, 'ratio']} of c on f meshes, n = 8: ")


def test_a_place_that_was_not_measured_before_is_not_compared(table) -> None:
    assert ratios.regressions(table.assign(value=9 * table["value"]), table.assign(n=16)) == []


def test_the_warning_is_printed_and_does_not_fail(table, tmp_path: Path, monkeypatch, capsys) -> None:
    timings = tmp_path / "timings.json"
    timings.write_text(json.dumps({"benchmarks": BENCHMARKS}))
    monkeypatch.setattr(ratios, "committed", lambda path: table.assign(value=table["value"] / 2))
    ratios.main(timings, tmp_path)
    assert capsys.readouterr().out.count("WARNING: ") == len(table)
    pd.testing.assert_frame_equal(pd.read_csv(tmp_path / "ratios.csv"), table, rtol=1e-5, check_dtype=False)


def test_what_is_written_names_the_machine_but_not_the_host_or_a_place(table, tmp_path: Path) -> None:
    report.write(tmp_path, "one", table, "One", ["A note."])
    report.write(tmp_path, "other", table, "Other", [])
    machine = json.loads((tmp_path / "machine.json").read_text())
    assert list(machine) == ["one", "other"]
    assert {"processor", "cores", "python", "numpy", "scipy", "pyamg", "blas"} <= machine["one"].keys()
    assert machine["one"]["threads"] == 1, "tests are limited to it"
    values = [str(value) for value in machine["one"].values()]
    assert platform.node() not in values
    assert not any(str(Path.home()) in value or str(report.ROOT) in value for value in values)


def test_a_table_that_was_never_committed_is_none() -> None:
    assert report.committed(report.RESULTS / "never.csv") is None


def test_missing_numbers_are_dashes() -> None:
    shown = report.markdown(pd.DataFrame({"a": [1.23456, np.nan, 12345.6], "b": ["x", "", "z"]}))
    assert [line.split("|")[1].strip() for line in shown.splitlines()[2:]] == ["1.23", "–", "12346"]


def test_the_exponent_of_a_power_law_is_found() -> None:
    dofs = np.array([1e3, 4e3, 16e3])
    assert growth.exponent(dofs, 3e-5 * dofs**1.17) == pytest.approx(1.17)


def test_growth_is_judged_in_bytes_per_unknown_at_a_million_only() -> None:
    rows = [(512, 500_000, 1.0, 1e9), (1024, 2_000_000, 4.0, 6e9)]
    table = pd.DataFrame(rows, columns=["n", "dofs", "level_seconds", "peak_bytes"]).assign(dim=2, solver="direct")
    (large,) = growth.findings(table)
    assert "3000 bytes per unknown at 2000000 (goal: 3000)" in large
    assert "dofs^1.00 (goal: 1.1)" in large
    (small,) = growth.findings(table[:1])
    assert "goal" not in small


@pytest.mark.parametrize("solver", ["direct", "multigrid"])
def test_a_row_of_growth_has_the_columns_of_the_table(solver: str) -> None:
    row = growth.Level("advance-recede", 4, solver).measure()
    assert [*row, "remark"] == growth.COLUMNS
    assert row["dofs"] == 40
    assert row["step_over_solve"] == row["step_seconds"] / row["solve_seconds"]
    assert all(value > 0 for name, value in row.items() if name not in ("solver",))


@pytest.mark.parametrize(("seconds", "met"), [(10.1, "no"), (9.9, "yes")])
def test_a_run_with_two_processes_is_judged_by_its_time_and_its_data(seconds: float, met: str) -> None:
    files = {"rates.csv": b"1\n", "claims.csv": b"2\n"}
    (row,) = parallel.table("--quick", (17.0, files), (seconds, files)).to_dict("records")
    assert row["ratio"] == pytest.approx(17 / seconds)
    assert (row["met"], row["csv_files"], row["identical"]) == (met, 2, "yes")
    for other in (files | {"rates.csv": b"1\r\n"}, files | {"bounds.csv": b""}, {"rates.csv": b"1\n"}):
        assert len(parallel.differing(files, other)) == 1
        assert parallel.table("", (17.0, files), (10.0, other))["identical"].item() == "no"


def test_a_watched_solver_does_not_change_the_level() -> None:
    watched = Watched(DIRECT, 3)
    place = Place("advance-recede", "shaken", 8)
    assert errors(place.setup(watched, 8)) == errors(place.setup(steps=8))
    assert (watched.made, len(watched.rights)) == (1, 3)


def test_in_rotated_unknowns_the_constraints_are_bounds() -> None:
    body = resolve("rotated").solution.body
    N = Space(OneDiagonal()(body, 6), body).N
    R, bounded = compare.rotation(N)
    assert abs(R.T @ R - sps.eye_array(R.shape[0])).max() < 1e-14
    assert abs(N @ R - sps.eye_array(R.shape[0], format="csr")[bounded]).max() < 1e-14


def test_two_constraints_on_one_unknown_are_refused_as_bounds() -> None:
    with pytest.raises(ValueError, match="no unknown in common"):
        compare.rotation(sps.csr_array([[1.0, 0.0], [0.6, 0.8]]))


def test_oblique_constraints_are_refused_where_components_are_bounded() -> None:
    body = resolve("rotated").solution.body
    given = type("Given", (), {"N": sps.csr_matrix(Space(OneDiagonal()(body, 4), body).N)})
    with pytest.raises(ValueError, match="more than one entry"):
        exchange.bounds(given)


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    """A small level as peers get it, and the run of this study."""
    source = tmp_path_factory.mktemp("level") / "problem.npz"
    problem = compare.export(8, source)
    return source, problem, compare.run(compare.OURS, source, 60, SYSTEM)


def test_peers_are_given_the_problem_that_is_solved_here(exported) -> None:
    source, problem, ours = exported
    given = exchange.load(source)
    assert abs(given.S - (problem.M / given.k + problem.reference)).max() < 1e-12 * abs(given.S).max()
    states = list(BACKWARD_EULER.march(problem, compare.STEPS))[1:]
    assert compare.distance(problem.M, np.array([state.u for state in states]), ours.u) < 1e-12


@pytest.mark.parametrize("peer", compare.PEERS, ids=lambda peer: peer.name)
def test_a_peer_that_is_installed_agrees_in_the_norm_of_v(exported, peer: compare.Peer) -> None:
    source, problem, ours = exported
    if not peer.installed(SYSTEM):
        pytest.skip(f"{peer.name} is not installed")
    line = compare.row(peer, [compare.run(peer, source, 60, SYSTEM)], [ours], problem, 8)
    assert line["remark"] == ""
    assert line["agreement"] <= compare.AGREEMENT
    assert line["ratio"] > 0


def test_the_time_of_a_peer_that_disagrees_is_not_compared(exported) -> None:
    _, problem, ours = exported
    other = compare.Run(ours.u * (1 + 2 * compare.AGREEMENT), {"seconds": 1.0})
    line = compare.row(compare.PEERS[0], [other], [ours], problem, 8)
    assert line["agreement"] == pytest.approx(2 * compare.AGREEMENT, rel=1e-4)
    assert line["remark"] == "disagrees: not compared"
    assert "ratio" not in line


@pytest.mark.parametrize(
    ("script", "remark"),
    [("import time; time.sleep(60)", "stopped after 1 s"), ("raise SystemExit('no memory')", "failed: no memory")],
)
def test_a_peer_that_fails_or_is_too_slow_says_so(exported, tmp_path, monkeypatch, script: str, remark: str) -> None:
    source, _, _ = exported
    (tmp_path / "peer.py").write_text(script)
    monkeypatch.setattr(compare, "HERE", tmp_path)
    assert compare.run(compare.Peer("peer", "peer.py", ()), source, 0.6, sys.executable).remark == remark


def test_seconds_and_ratios_are_medians_of_turns_taken(exported) -> None:
    _, problem, ours = exported
    mine, theirs = ([compare.Run(ours.u, {"seconds": s}) for s in seconds] for seconds in ((1, 9, 2), (3, 18, 2)))
    line = compare.row(compare.PEERS[0], theirs, mine, problem, 8)
    assert (line["seconds"], line["slowest"], line["ratio"]) == (3, 18, 2)


def test_programs_take_turns_and_who_is_too_slow_is_not_asked_again(monkeypatch) -> None:
    quick, slow = (compare.Peer(name, "ours.py", ("study",)) for name in ("quick", "slow"))
    asked: list[str] = []

    def run(peer: compare.Peer, source: Path, limit: float, python: str) -> compare.Run:
        asked.append(peer.name)
        u = np.ones((1, len(exchange.load(source).u0)))
        return compare.Run(None, {}, "stopped after 1 s") if peer is slow else compare.Run(u, {"seconds": 1.0})

    monkeypatch.setattr(compare, "PEERS", (quick, slow))
    monkeypatch.setattr(compare, "run", run)
    lines = list(compare.compare([4, 8], 1, sys.executable, 2))
    assert asked == ["this study", "quick", "slow", *3 * ["this study", "quick"]]
    assert [line["remark"] for line in lines if line["peer"] == "slow"] == [
        "stopped after 1 s",
        "stopped after 1 s at n = 4",
    ]


def test_a_peer_that_is_missing_is_listed_as_not_installed(monkeypatch) -> None:
    monkeypatch.setattr(compare, "PEERS", (compare.Peer("nobody", "nobody.py", ("no_such_module",)),))
    ours, nobody = compare.compare([4], 60, SYSTEM, 1)
    assert ours["ratio"] == 1
    assert nobody["remark"] == "not installed"
