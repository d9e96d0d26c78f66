"""Tasks read back give our own errors, and every class of the judge has an answer that it is given to."""

from __future__ import annotations

import gzip
import json
import lzma
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import contact_judge as judge
import faults
import numpy as np
import pytest
import this_study as ours

from study.cli.main import main
from study.fem.mesh import OneDiagonal
from study.fem.naming import family_named, resolve
from study.run.tasks import frozen, march, plain, with_foundation, write_task
from study.solve.tableau import MIDPOINT
from study.statements.shared.experiment import Experiment
from study.statements.shared.tasks import FROZEN_TIMES, Task

CODES = Path(__file__).parents[2] / "examples" / "codes"
LEVELS = 4, 8, 16


def read(data: dict[str, Any]) -> Any:
    return judge.Task(f"{data['case']}-{data['level']}-{data['scale']}", json.loads(json.dumps(plain(data))))


def exported(case: str = "advance-recede", family: str = "one-diagonal", level: int = 8) -> Task:
    return Task(resolve(case), family_named(family), level)


@pytest.fixture(scope="module")
def tasks() -> list[Any]:
    return [read(frozen(exported(level=n), (0.15, 0.55))) for n in LEVELS]


Make = Callable[[Any], Callable[[np.ndarray, np.ndarray], np.ndarray]]


def judged(tasks: list[Any], make: Make) -> Any:
    (found,) = judge.assess(tasks, {task.name: judge.answer(task, make) for task in tasks})
    return found


def test_tasks_read_back_give_our_own_errors(tasks: list[Any]) -> None:
    for task, n in zip(tasks, LEVELS, strict=True):
        mine = exported(level=n)
        found = judge.measure(task, np.array([one["reference"] for one in task.data["judge"]]))
        errors = [mine.v_norm.distance(mine.v_norm.sample(t), mine.static(t)) for t in (0.15, 0.55)]
        assert found.error == pytest.approx(max(errors), rel=1e-12)
        apart = [
            np.linalg.norm(mine.v_norm.sample(t).interpolant - mine.space.interpolate(np.array(one["displacement"]).T))
            for t, one in zip((0.15, 0.55), task.data["judge"], strict=True)
        ]
        assert max(apart) < 1e-11


def test_our_own_solver_on_the_exported_data_is_exact_for_p1(tasks: Any) -> None:
    found = judged(tasks, ours.make)
    assert found.verdict == "exact for P1"
    assert max(one.distance / one.best for one in found.errors) < 1e-10
    assert max(one.tangential for one in found.errors) < 1e-12
    assert max(one.penetration for one in found.errors) < 1e-12


@pytest.mark.parametrize(
    "task",
    [
        *((case, "shaken", 8) for case in ("corner", "rotated", "anisotropic", "layered", "lift-and-land")),
        ("cube-disc", "one-diagonal", 4),
    ],
    ids=lambda task: task[0],
)
def test_our_own_solver_is_exact_with_two_faces_other_laws_layers_and_in_space(task: tuple[str, str, int]) -> None:
    found = judged([read(frozen(exported(*task), (0.15, 0.9)))], ours.make)
    assert found.verdict == "exact for P1"
    assert found.errors[0].tangential < 1e-11


def test_a_march_is_the_midpoint_rule() -> None:
    task = read(march(exported(), 6))
    found = judged([task], ours.make)
    assert found.verdict == "exact for P1"
    solution = resolve("advance-recede").solution
    setup = Experiment.of(solution, OneDiagonal(), 8, MIDPOINT, 6)
    states = list(MIDPOINT.march(setup.problem, 6))[1:]
    errors = [setup.v_norm.distance(setup.v_norm.sample(state.time), state.u) for state in states]
    assert found.errors[0].error == pytest.approx(max(errors), rel=1e-11)
    assert found.errors[0].pressure < 0.2


def test_springs_as_stiff_as_cells_are_consistent_of_order_one(tasks: Any) -> None:
    found = judged(tasks, faults.springs(lambda task: 30 / task.data["h"]))
    assert found.verdict == "consistent"
    assert found.order_of_distance == pytest.approx(1, abs=0.3)


def test_springs_that_no_mesh_makes_stiffer_stagnate_and_their_order_in_v_does_not_see_it(tasks: Any) -> None:
    found = judged(tasks, faults.springs(lambda task: 30.0))
    assert found.verdict == "stagnates"
    assert judged(tasks[:1], faults.springs(lambda task: 30.0)).verdict == "undecided", "one mesh shows no order"
    assert abs(found.order_in_v - 1) < 0.15
    assert found.errors[-1].pressure > 5 * found.errors[-1].best_pressure


def doctored(change: Callable[[Any, np.ndarray], np.ndarray]) -> Make:
    def make(task: Any) -> Any:
        step = ours.make(task)
        return lambda load, stress: change(task, step(load, stress))

    return make


@pytest.mark.parametrize(
    "change",
    [lambda task, u: u * np.nan, lambda task, u: 3 * u, lambda task, u: u * (1 + 0.01 / task.data["h"])],
    ids=["no number", "three times as large", "worse on every mesh"],
)
def test_what_is_far_or_grows_is_wrong(tasks: Any, change: Any) -> None:
    assert judged(tasks, doctored(change)).verdict == "wrong"


def test_contact_forgotten_is_seen_by_the_pressure_and_the_penetration(tasks: Any) -> None:
    found = judged(tasks, faults.springs(lambda task: 0.0))
    assert found.verdict == "wrong"
    assert found.errors[-1].penetration > 0.1
    assert found.errors[-1].pressure == pytest.approx(1, abs=1e-6)
    assert found.errors[-1].resultant == pytest.approx(1, abs=1e-6)


def errors(shares: list[float], pressure: list[float], tangential: float = 0.0) -> list[Any]:
    """Errors with distances of some shares of a discretisation error h, on meshes h = 1, ½, ¼ …"""
    h = [0.5**k for k in range(len(shares))]
    rows = zip(h, shares, pressure, strict=True)
    return [judge.Errors(k, k, k, share * k, p, 0.01 * k, 0.0, 0.0, tangential) for k, share, p in rows]


def classed(found: list[Any]) -> str:
    return str(judge.classify([one.best for one in found], found))


def test_what_grows_from_nothing_to_next_to_nothing_stagnates_and_is_not_wrong() -> None:
    """Springs like 1/h² at points of quadrature, on shaken meshes: 2e-5 of the error, then 1.6e-4."""
    p = [0.04, 0.02, 0.01]
    assert classed(errors([2e-5, 1.6e-4, 1e-3], p)) == "stagnates"
    assert classed(errors([2e-5, 1.6e-4, 3.2e-4], p)) == "stagnates"
    assert classed(errors([2e-5, 1.6e-4], p[:2])) == "undecided"
    assert classed(errors([1e-3, 5e-3, 3e-2], p)) == "wrong"


def test_a_constant_part_behind_one_that_falls_fast_needs_a_third_mesh() -> None:
    """A penalty that is not scaled, 1000 g on merging patches: distances with orders 1.6 and 0.0."""
    distances, p = [1.61, 0.5, 0.486], [0.15, 0.1, 0.05]
    shares = [d * 2**k for k, d in enumerate(distances)]
    assert classed(errors(shares[:2], p[:2])) == "undecided"
    assert classed(errors(shares, p)) == "stagnates"
    assert classed(errors([0.08, 0.013, 0.003], p)) == "consistent"


def test_a_pressure_that_falls_as_that_of_k_h_does_is_no_reason_to_stagnate() -> None:
    """Advance-recede on shaken meshes with n = 16, 32, 64: the last order of the solution in K^h itself is 0.44."""
    h, best = [1.0, 0.5, 0.25], [0.01772, 0.006998, 0.005141]

    def found(p: list[float]) -> str:
        rows = zip(h, p, best, strict=True)
        return str(judge.classify(h, [judge.Errors(k, k, k, 0.1 * k, one, b, 0, 0, 0) for k, one, b in rows]))

    assert np.log2(best[1] / best[2]) < judge.PRESSURE_FALLS
    assert found([2 * one for one in best]) == "consistent"
    assert found([0.04, 0.02, 0.018]) == "stagnates"


def test_a_vertex_that_is_not_held_is_named_and_its_pressure_falls_too_slowly(tasks: Any) -> None:
    found = judged(tasks, faults.misread(faults.without(0.25)))
    assert found.verdict == "stagnates"
    assert found.order_of_distance > judge.FALLS
    assert found.order_of_pressure == pytest.approx(0.5, abs=0.1)
    (vertex,) = found.errors[-1].idle
    assert tasks[-1].vertices[vertex] == pytest.approx([0.25, 0])
    assert f"carry next to nothing: 1 ({vertex})" in judge.table([found])


def test_a_vertex_that_no_step_presses_is_not_judged_and_the_table_says_how_many(tasks: Any) -> None:
    found = judged(tasks, faults.misread(faults.without(1.0)))
    assert found.verdict == "exact for P1"
    pressed, free, count = found.tested
    assert max(pressed, free) < count
    assert f"{pressed}/{count}" in judge.table([found])


def test_full_contact_presses_all_vertices_and_frees_none() -> None:
    case = [read(frozen(exported("full-contact", level=n), (0.15, 0.55, 0.9))) for n in LEVELS]
    assert judge.tested(case[-1]) == (17, 0, 17)
    assert judged(case, faults.misread(faults.without(1.0))).errors[-1].idle
    assert judged(case, faults.tied).verdict == "exact for P1"


def test_the_class_and_the_line_about_forces_agree() -> None:
    p = [0.04, 0.02, 0.01]
    for tangential, verdict, said in ((5e-4, "consistent", False), (0.02, "consistent", True), (0.2, "wrong", False)):
        found = errors([0.1, 0.05, 0.025], p, tangential)
        h = [one.best for one in found]
        reached, last = (1, 1, 1), [1.0, 1.0, 1.0, 1.0]
        one = judge.Judgement("c", "f", "frozen", [1, 2, 4], found, *judge.judged(h, found), reached, *last, np.nan)
        assert one.verdict == verdict
        assert any("where none may be" in note for note in judge.notes(one)) == said
    assert "other equations" in one.why


def test_a_consistent_code_with_a_pressure_many_times_that_of_k_h_does_not_pass_without_a_word() -> None:
    found = errors([0.1, 0.05, 0.025], [0.3, 0.15, 0.075])
    why = judge.judged([1, 0.5, 0.25], found)
    one = judge.Judgement("c", "f", "frozen", [1, 2, 4], found, *why, (1, 1, 1), 1.0, 1.0, 1.0, 1.0, np.nan)
    assert one.verdict == "consistent"
    assert "30 times the error of the solution in K^h" in judge.table([one])


def test_other_equations_leave_forces_where_none_may_be(tasks: Any) -> None:
    task = tasks[1]
    without = judge.answer(task, lambda task: lambda load, stress: ours.make(task)(load, 0 * stress))
    assert judge.measure(task, without).tangential > 0.01


def test_two_scales_show_what_is_not_homogeneous() -> None:
    both = [read(frozen(exported(), (0.55,), scale)) for scale in (1.0, 1e-4)]
    assert judged(both, ours.make).invariance < 1e-10
    bent = judged(both, doctored(lambda task, u: u + 0.01 * u**2))
    assert bent.invariance > 1e-3


def test_the_foundation_lies_under_the_face_and_covers_it() -> None:
    for case in ("rotated", "corner"):
        data = with_foundation(frozen(exported(case), (0.55,)), 5)
        for piece, slab in zip(data["contact"], data["foundation"], strict=True):
            face = data["vertices"][np.unique(piece["facets"])]
            points = slab["vertices"]
            depth = (points - face[0]) @ piece["normal"]
            assert depth.min() == pytest.approx(0, abs=1e-12)
            corners = points[slab["cells"]]
            assert (np.linalg.det(corners[:, 1:] - corners[:, :1]) > 0).all()
            on = points[np.unique(slab["facets"])]
            assert np.ptp(on, axis=0).max() > np.ptp(face, axis=0).max()


def test_the_command_writes_the_same_bytes_again_and_their_sums(tmp_path: Path, capsys: Any) -> None:
    command = ["export", "full-contact", "--levels", "4", "--instants", "0.5", "--to", str(tmp_path)]
    assert main(command) == 0
    (first,) = tmp_path.glob("*.xz")
    before, sums = first.read_bytes(), (tmp_path / "SHA256SUMS").read_text()
    assert main(command) == 0
    assert (first.read_bytes(), (tmp_path / "SHA256SUMS").read_text()) == (before, sums)
    judge.read_tasks(tmp_path)
    first.write_bytes(before[:-1] + bytes([before[-1] ^ 1]))
    with pytest.raises(judge.TaskError, match="SHA256SUMS"):
        judge.read_tasks(tmp_path)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["yield-and-release"], "not linear"),
        (["full-contact", "--levels", "1"], "--levels"),
        (["full-contact", "--instants", "2"], "--instants"),
        (["full-contact", "--scale", "0"], "--scale"),
        (["full-contact", "--steps", "3"], "--steps"),
        (["full-contact", "--mode", "march", "--instants", "0.5"], "--instants"),
        (["full-contact", "--levels", "4", "--foundation", "0"], "--foundation"),
    ],
)
def test_what_cannot_be_exported_is_refused(options: list[str], message: str, tmp_path: Path, capsys: Any) -> None:
    assert main(["export", *options, "--to", str(tmp_path / "out")]) == 2
    assert message in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_line_of_the_sums_that_is_none_is_named(tmp_path: Path, capsys: Any) -> None:
    command = ["export", "full-contact", "--levels", "4", "--instants", "0.5", "--out", str(tmp_path)]
    assert main(command) == 0
    with (tmp_path / "SHA256SUMS").open("a") as sums:
        sums.write("mine\n")
    before = {path: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()}
    assert main([*command, "--scale", "2"]) == 2
    assert (
        "SHA256SUMS, line 2: found 'mine', expected a checksum and a file: remove the line" in capsys.readouterr().err
    )
    assert {path: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()} == before


def sizes(directory: Path, case: str, family: str) -> list[int]:
    """Bytes of the tasks of a case with the instants of the command, n = 8 and 16."""
    place = resolve(case)
    times = [place.solution.body.T * part for part in FROZEN_TIMES]
    tasks = [Task(place, family_named(family), n) for n in (8, 16)]
    return [write_task(directory, frozen(task, times)).stat().st_size for task in tasks]


SMALL = 100_000
"""Bytes of a task that another project may commit."""


def test_tasks_for_two_levels_are_small_enough_to_commit(tmp_path: Path) -> None:
    """On the mesh that takes the most room of those below."""
    assert max(sizes(tmp_path, "corner", "shaken")) <= SMALL


@pytest.mark.parametrize(("suffix", "pack"), [(".xz", lzma.compress), (".gz", gzip.compress), ("", bytes)])
def test_a_task_is_read_whatever_it_is_packed_by(suffix: str, pack: Callable[[bytes], bytes], tmp_path: Path) -> None:
    data = json.dumps(plain(frozen(exported(level=4), (0.55,)))).encode()
    path = tmp_path / f"one.json{suffix}"
    path.write_bytes(pack(data))
    (task,) = judge.read_tasks(tmp_path)
    assert (task.name, task.data) == ("one", json.loads(data))
    path.write_bytes(pack(data)[:-20])
    with pytest.raises(judge.TaskError, match=r"one\.json"):
        judge.read_tasks(tmp_path)


def test_the_judge_runs_as_a_command_with_numpy_alone(tmp_path: Path) -> None:
    """Nothing but NumPy can be imported: every other package of the environment is refused."""
    for n in (4, 8):
        write_task(tmp_path / "tasks", frozen(exported(level=n), (0.55,)))
    for task in judge.read_tasks(tmp_path / "tasks"):
        judge.write_answer(tmp_path / "answers", task, judge.answer(task, ours.make))
    alone = (
        "import sys\n"
        "class Only:\n"
        "    def find_spec(self, name, path=None, target=None):\n"
        "        if name.partition('.')[0] in ('scipy', 'sympy', 'skfem', 'study', 'manufactured', 'pandas'):\n"
        "            raise ModuleNotFoundError(name)\n"
        "sys.meta_path.insert(0, Only())\n"
        f"sys.path.insert(0, {str(CODES)!r})\n"
        "import contact_judge\n"
        "sys.exit(contact_judge.main())\n"
    )
    command = [sys.executable, "-c", alone, str(tmp_path / "tasks"), str(tmp_path / "answers")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "exact for P1" in done.stdout
    (path,) = (tmp_path / "answers").glob("*-8/u.txt")
    np.savetxt(path, 3 * np.loadtxt(path, ndmin=2))
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    path.unlink()
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "u.txt" in done.stderr


def test_a_march_can_be_done_from_unpacked_files_alone(tmp_path: Path) -> None:
    task = read(march(exported("anisotropic", level=4), 3))
    judge.unpack(task, tmp_path)

    def of(name: str) -> np.ndarray:
        return np.loadtxt(tmp_path / task.name / f"{name}.txt", ndmin=2)

    k, u, found, step = float(of("step")[0, 0]), of("start"), [], ours.make(task)
    A, G = (of(name).reshape(-1, 3, 3) for name in "AG")
    assert np.allclose(of("stiffness").reshape(-1, 3, 3), A / k + G / 2, rtol=1e-14)
    for n in range(1, task.count + 1):
        u = step(of(f"load_{n}"), np.einsum("cij,cj->ci", G / 2 - A / k, task.strain(u)))
        found.append(u)
    assert not list((tmp_path / task.name).glob("initial_stress*"))
    assert judged([task], lambda _: iter_step(found)).verdict == "exact for P1"


def iter_step(found: list[np.ndarray]) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """A step that gives what was computed before."""
    rest = iter(found)
    return lambda load, stress: next(rest)
