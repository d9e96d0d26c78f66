"""Tasks read back give our own errors, and every class of the judge has an answer that it is given to."""

from __future__ import annotations

import importlib
import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from study.cli.main import main
from study.fem.mesh import OneDiagonal
from study.fem.naming import family_named, resolve
from study.run.task_data import frozen, march, with_foundation
from study.run.task_files import plain, write_task
from study.solve.tableau import MIDPOINT
from study.statements.other_codes.tasks import Task
from study.statements.prop_5_4.experiment import Experiment

CODES = Path(__file__).parents[2] / "examples" / "codes"
LEVELS = 4, 8, 16


@pytest.fixture(scope="module")
def judge() -> ModuleType:
    sys.path.insert(0, str(CODES))
    return importlib.import_module("contact_judge")


@pytest.fixture(scope="module")
def ours(judge: ModuleType) -> ModuleType:
    return importlib.import_module("this_study")


def read(judge: ModuleType, data: dict[str, Any]) -> Any:
    return judge.Task(f"{data['case']}-{data['level']}-{data['scale']}", json.loads(json.dumps(plain(data))))


def exported(case: str = "advance-recede", family: str = "one-diagonal", level: int = 8) -> Task:
    return Task(resolve(case), family_named(family), level)


@pytest.fixture(scope="module")
def tasks(judge: ModuleType) -> list[Any]:
    return [read(judge, frozen(exported(level=n), (0.15, 0.55))) for n in LEVELS]


Make = Callable[[Any], Callable[[np.ndarray, np.ndarray], np.ndarray]]


def judged(judge: ModuleType, tasks: list[Any], make: Make) -> Any:
    (found,) = judge.assess(tasks, {task.name: judge.answer(task, make) for task in tasks})
    return found


def with_springs(ours: ModuleType, stiffness: Callable[[Any], float]) -> Make:
    """Springs in place of the foundation, so stiff, by active sets."""

    def make(task: Any) -> Any:
        K, free = ours.stiffness(task).toarray(), np.setdiff1d(np.arange(task.vertices.size), _fixed(task))
        ((normal, vertices, mass),) = task.pieces()

        def step(load: np.ndarray, stress: np.ndarray) -> np.ndarray:
            b, held, u = (load - task.internal(stress)).ravel(), np.ones(len(vertices), bool), None
            for _ in range(30):
                S, u = K.copy(), np.zeros(len(b))
                for vertex, weight in zip(vertices[held], mass[held], strict=True):
                    on = slice(2 * vertex, 2 * vertex + 2)
                    S[on, on] += stiffness(task) * weight * np.outer(normal, normal)
                u[free] = np.linalg.solve(S[np.ix_(free, free)], b[free])
                held = u.reshape(-1, 2)[vertices] @ normal > 0
            return u.reshape(-1, 2)

        return step

    return make


def _fixed(task: Any) -> np.ndarray:
    return np.add.outer(2 * task.clamped, [0, 1]).ravel()


def test_tasks_read_back_give_our_own_errors(judge: ModuleType, tasks: list[Any]) -> None:
    for task, n in zip(tasks, LEVELS, strict=True):
        mine = exported(level=n)
        found = judge.measure(task, np.array([one["reference"] for one in task.data["judge"]]))
        errors = [mine.gauge.distance(mine.gauge.sample(t), mine.static(t)) for t in (0.15, 0.55)]
        assert found.error == pytest.approx(max(errors), rel=1e-12)
        apart = [
            np.linalg.norm(mine.gauge.sample(t).interpolant - mine.space.interpolate(np.array(one["displacement"]).T))
            for t, one in zip((0.15, 0.55), task.data["judge"], strict=True)
        ]
        assert max(apart) < 1e-11


def test_our_own_solver_on_the_exported_data_is_exact_for_p1(judge: ModuleType, ours: ModuleType, tasks: Any) -> None:
    found = judged(judge, tasks, ours.make)
    assert found.verdict == "exact for P1"
    assert max(one.distance / one.best for one in found.errors) < 1e-10
    assert max(one.tangential for one in found.errors) < 1e-12
    assert max(one.penetration for one in found.errors) < 1e-12


@pytest.mark.parametrize("case", ["corner", "rotated", "anisotropic", "layered", "lift-and-land"])
def test_so_it_is_with_two_faces_other_laws_and_layers(judge: ModuleType, ours: ModuleType, case: str) -> None:
    task = read(judge, frozen(exported(case, "shaken"), (0.15, 0.9)))
    found = judged(judge, [task], ours.make)
    assert found.verdict == "exact for P1"
    assert found.errors[0].tangential < 1e-11


def test_a_march_is_the_midpoint_rule(judge: ModuleType, ours: ModuleType) -> None:
    task = read(judge, march(exported(), 6))
    found = judged(judge, [task], ours.make)
    assert found.verdict == "exact for P1"
    solution = resolve("advance-recede").solution
    setup = Experiment.of(solution, OneDiagonal(), 8, MIDPOINT, 6)
    states = list(MIDPOINT.march(setup.problem, 6))[1:]
    errors = [setup.gauge.distance(setup.gauge.sample(state.time), state.u) for state in states]
    assert found.errors[0].error == pytest.approx(max(errors), rel=1e-11)
    assert found.errors[0].pressure < 0.2


def test_a_cube_is_judged_like_a_square(judge: ModuleType, ours: ModuleType) -> None:
    task = read(judge, frozen(exported("cube-disc", level=4), (0.55,)))
    found = judged(judge, [task], ours.make)
    assert found.verdict == "exact for P1"
    assert found.errors[0].tangential < 1e-11


def test_springs_as_stiff_as_cells_are_consistent_of_order_one(judge: ModuleType, ours: ModuleType, tasks: Any) -> None:
    found = judged(judge, tasks, with_springs(ours, lambda task: 30 / task.data["h"]))
    assert found.verdict == "consistent"
    assert found.order_of_distance == pytest.approx(1, abs=0.3)


def test_springs_that_no_mesh_makes_stiffer_stagnate_and_their_order_in_v_does_not_see_it(
    judge: ModuleType, ours: ModuleType, tasks: Any
) -> None:
    found = judged(judge, tasks, with_springs(ours, lambda task: 30.0))
    assert found.verdict == "stagnates"
    assert abs(found.order_in_v - 1) < 0.15
    assert found.errors[-1].pressure > 5 * found.errors[-1].best_pressure


def doctored(ours: ModuleType, change: Callable[[Any, np.ndarray], np.ndarray]) -> Make:
    def make(task: Any) -> Any:
        step = ours.make(task)
        return lambda load, stress: change(task, step(load, stress))

    return make


@pytest.mark.parametrize(
    "change",
    [
        lambda task, u: u * np.nan,
        lambda task, u: 3 * u,
        lambda task, u: u * (1 + 0.01 / task.data["h"]),
    ],
    ids=["no number", "three times as large", "worse on every mesh"],
)
def test_what_is_far_or_grows_is_wrong(judge: ModuleType, ours: ModuleType, tasks: Any, change: Any) -> None:
    assert judged(judge, tasks, doctored(ours, change)).verdict == "wrong"


def test_one_mesh_says_nothing_of_an_order(judge: ModuleType, ours: ModuleType, tasks: Any) -> None:
    found = judged(judge, tasks[:1], doctored(ours, lambda task, u: 1.01 * u))
    assert found.verdict == "undecided"


def test_contact_forgotten_is_seen_by_the_pressure_and_the_penetration(judge: ModuleType, tasks: Any) -> None:
    ours = importlib.import_module("this_study")
    found = judged(judge, tasks, with_springs(ours, lambda task: 0.0))
    assert found.verdict == "wrong"
    assert found.errors[-1].penetration > 0.1
    assert found.errors[-1].pressure == pytest.approx(1, abs=1e-6)
    assert found.errors[-1].resultant == pytest.approx(1, abs=1e-6)


def test_other_equations_leave_forces_where_none_may_be(judge: ModuleType, ours: ModuleType, tasks: Any) -> None:
    task = tasks[1]
    without = judge.answer(task, lambda task: lambda load, stress: ours.make(task)(load, 0 * stress))
    assert judge.measure(task, without).tangential > 0.01


def test_two_scales_show_what_is_not_homogeneous(judge: ModuleType, ours: ModuleType) -> None:
    both = [read(judge, frozen(exported(), (0.55,), scale)) for scale in (1.0, 1e-4)]
    assert judged(judge, both, ours.make).invariance < 1e-10
    bent = judged(judge, both, doctored(ours, lambda task, u: u + 0.01 * u**2))
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


def test_the_command_writes_the_same_bytes_again_and_their_sums(tmp_path: Path, judge: ModuleType, capsys: Any) -> None:
    command = ["export", "full-contact", "--levels", "4", "--instants", "0.5", "--to", str(tmp_path)]
    assert main(command) == 0
    (first,) = tmp_path.glob("*.gz")
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
    assert "SHA256SUMS, line 2: stands 'mine', expected a sum and a file; remove the line" in capsys.readouterr().err
    assert {path: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()} == before


def test_tasks_for_two_levels_are_small_enough_to_commit(tmp_path: Path) -> None:
    sizes = [write_task(tmp_path, frozen(exported(level=n), (0.15, 0.55, 0.9))).stat().st_size for n in (8, 16)]
    assert max(sizes) <= 100_000


def test_the_judge_runs_as_a_command_with_numpy_alone(tmp_path: Path, judge: ModuleType, ours: ModuleType) -> None:
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


def test_unpacked_files_are_the_same_problem(tmp_path: Path, judge: ModuleType, tasks: list[Any]) -> None:
    judge.unpack(tasks[1], tmp_path)
    place = tmp_path / tasks[1].name
    load, stress = tasks[1].step(1, tasks[1].start())
    assert np.array_equal(np.loadtxt(place / "load_2.txt"), load)
    assert np.array_equal(np.loadtxt(place / "initial_stress_2.txt"), stress)
    assert np.array_equal(np.loadtxt(place / "constrained_1.txt"), tasks[1].pieces()[0][1])
