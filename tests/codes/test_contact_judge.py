"""Tasks read back give our own errors, and every class of the judge has an answer that it is given to."""

import gzip
import json
import lzma
import subprocess
import sys
from dataclasses import replace
from itertools import product

import contact_judge as judge
import faults
import numpy as np
import pytest
import this_study as ours
from commands import study
from judged_codes import answers, at_one_time, exported, judged, read, task
from places import CODES
from tables import everything

from study.cli.export import frozen, with_foundation, write_task
from study.fem.mesh import OneDiagonal
from study.fem.naming import resolve
from study.solve.tableau import MIDPOINT
from study.statements.shared.base import Experiment
from study.statements.shared.tasks import FROZEN_TIMES

LEVELS = 4, 8, 16
TIMES = 0.15, 0.55


@pytest.fixture(scope="module")
def tasks():
    return [exported("advance-recede", n, times=TIMES) for n in LEVELS]


def test_tasks_read_back_give_our_own_errors(tasks):
    for one, n in zip(tasks, LEVELS, strict=True):
        mine = task("advance-recede", n)
        references = np.array([data["reference"] for data in one.data["judge"]])
        errors = [mine.v_norm.distance(mine.v_norm.sample(t), mine.static(t)) for t in TIMES]
        assert judge.measure(one, references).error == pytest.approx(max(errors), rel=1e-12)
        for t, data in zip(TIMES, one.data["judge"], strict=True):
            interpolant = mine.space.interpolate(np.array(data["displacement"]).T)
            assert np.linalg.norm(mine.v_norm.sample(t).interpolant - interpolant) < 1e-11


@pytest.mark.parametrize("case", ["corner", "rotated", "anisotropic", "layered", "parabolic-gap", "cube-disc"])
def test_our_own_solver_is_exact_with_two_faces_other_laws_layers_an_initial_gap_and_in_space(case):
    level, family = (3, "one-diagonal") if case == "cube-disc" else (4, "shaken")
    found = judged(ours.make, exported(case, level, family=family, times=(0.15, 0.9)))
    assert found.verdict == "exact for P1"
    (one,) = found.errors
    assert one.distance / one.best < 1e-10
    assert one.tangential < 1e-11
    assert one.penetration < 1e-12


def test_a_march_is_the_midpoint_rule():
    found = judged(ours.make, exported("advance-recede", steps=6))
    assert found.verdict == "exact for P1"
    setup = Experiment.of(resolve("advance-recede").solution, OneDiagonal(), 8, MIDPOINT, 6)
    states = list(MIDPOINT.march(setup.problem, 6))[1:]
    errors = [setup.v_norm.distance(setup.v_norm.sample(state.time), state.u) for state in states]
    assert found.errors[0].error == pytest.approx(max(errors), rel=1e-11)
    assert found.errors[0].pressure < 0.3


def test_springs_that_no_mesh_makes_stiffer_stagnate_and_their_order_in_v_does_not_see_it(tasks):
    found = judged(faults.springs(lambda task: 30.0), *tasks)
    assert found.verdict == "stagnates"
    assert judged(faults.springs(lambda task: 30.0), tasks[0]).verdict == "undecided", "one mesh shows no order"
    assert abs(found.order_in_v - 1) < 0.15
    assert found.errors[-1].pressure > 2 * found.errors[-1].best_pressure


ON_ONE_MESH = [lambda u: 1000 * u, lambda u: u / 2, lambda u: 0 * u, lambda u: u.swapaxes(1, 2).reshape(u.shape)]
"""In other units, half, zero, and written component by component."""


@pytest.mark.parametrize("code", ["exact", "springs"])
def test_an_answer_that_is_far_off_on_a_coarse_mesh_alone_is_wrong(tasks, code):
    right = answers(ours.make if code == "exact" else faults.springs(lambda task: 30 / task.data["h"]), tasks)
    assert judge.assess(tasks, right)[0].verdict in judge.GOOD
    for change, one in product(ON_ONE_MESH, tasks[:2]):
        (found,) = judge.assess(tasks, right | {one.name: change(right[one.name])})
        assert found.verdict == "wrong"
        assert f"n = {one.data['level']}" in found.why


def test_contact_forgotten_is_seen_by_the_pressure_and_the_penetration(tasks):
    found = judged(faults.springs(lambda task: 0.0), *tasks)
    last = found.errors[-1]
    assert found.verdict == "wrong"
    assert last.penetration > 0.1
    assert (last.pressure, last.resultant) == pytest.approx((1, 1), abs=1e-6)


# The class follows from the errors


def errors(shares, pressure, tangential=0.0):
    """Errors with distances of some shares of a discretisation error h, on meshes h = 1, ½, ¼ …"""
    rows = zip([0.5**k for k in range(len(shares))], shares, pressure, strict=True)
    return [judge.Errors(k, k, k, share * k, p, 0.01 * k, 0.0, 0.0, tangential) for k, share, p in rows]


FALLING = [0.04, 0.02, 0.01]
DISTANCES = [share * 2**k for k, share in enumerate((1.61, 0.5, 0.486))]
CLASSES = [
    # Springs like 1/h² at points of quadrature, on shaken meshes: 2e-5 of the error, then 1.6e-4.
    ([2e-5, 1.6e-4, 3.2e-4], FALLING, "stagnates"),
    ([2e-5, 1.6e-4], FALLING[:2], "undecided"),
    ([1e-3, 5e-3, 3e-2], FALLING, "wrong"),
    # A penalty that is not scaled, 1000 g on merging patches, has distances with orders 1.6 and 0.0: a constant part
    # behind one that falls fast needs a third mesh.
    (DISTANCES[:2], [0.15, 0.1], "undecided"),
    (DISTANCES, [0.15, 0.1, 0.05], "stagnates"),
    ([0.08, 0.013, 0.003], [0.15, 0.1, 0.05], "consistent"),
    # Integral multipliers in junction, with n = 4, 8, 16 and, on shaken meshes, n = 10, 12, 14: exact on some meshes.
    ([2e-2, 2e-12, 3e-12], FALLING, "consistent"),
    ([3e-12, 0.2, 6e-12], FALLING, "wrong"),
    ([0.5, 2e-12, 2e-12], FALLING, "wrong"),
]


@pytest.mark.parametrize(("shares", "pressure", "verdict"), CLASSES, ids=str)
def test_what_grows_from_nothing_or_stays_stagnates(shares, pressure, verdict):
    found = errors(shares, pressure)
    assert judge.classify([one.best for one in found], found) == verdict


def test_a_pressure_that_falls_as_that_of_k_h_does_is_no_reason_to_stagnate():
    """Advance-recede on shaken meshes with n = 16, 32, 64: the last order of the solution in K^h itself is 0.44."""
    h = [1.0, 0.5, 0.25]
    best = [0.01772, 0.006998, 0.005141]
    assert np.log2(best[1] / best[2]) < judge.PRESSURE_FALLS
    for p, verdict in (([2 * one for one in best], "consistent"), ([0.04, 0.02, 0.018], "stagnates")):
        rows = zip(h, p, best, strict=True)
        assert judge.classify(h, [judge.Errors(k, k, k, 0.1 * k, one, b, 0, 0, 0) for k, one, b in rows]) == verdict


def judgement(found):
    why = judge.judged([one.best for one in found], found)
    return judge.Judgement("c", "f", "frozen", 1.0, [1, 2, 4], found, *why, (1, 1, 1), 1.0, 1.0, 1.0, 1.0)


def test_forces_outside_the_contact_zone_are_at_least_undecided_and_a_class_says_on_how_many_meshes_it_rests():
    """Nitsche's methods leave forces at vertices of the cells at Γ3, which do not count as outside."""
    for outside, verdict in ((0.0, "consistent"), (2e-3, "undecided")):
        found = [replace(one, outside=outside) for one in errors([0.1, 0.05, 0.025], FALLING, 0.02)]
        one = judgement(found)
        assert one.verdict == verdict
        assert one.why.endswith("order of the distance 2.0, 2.0 on 3 meshes")
    assert "other equations" in judgement(errors([0.1, 0.05, 0.025], FALLING, 0.2)).why


def test_no_order_is_told_to_or_from_an_exact_mesh():
    assert (
        "order of the distance none to an exact mesh, none to" in judgement(errors([2e-2, 2e-12, 3e-12], FALLING)).why
    )
    assert (
        judgement(errors([0.02, 3e-12, 0.02], FALLING)).why
        == "on the mesh n = 4 the distance grows to 2.0e-02 of the error"
    )


def test_a_consistent_code_with_a_pressure_many_times_that_of_k_h_does_not_pass_without_a_word():
    one = judgement(errors([0.1, 0.05, 0.025], [0.3, 0.15, 0.075]))
    assert one.verdict == "consistent"
    assert "30 times the error of the solution in K^h" in judge.table([one])


# Vertices


def test_a_vertex_that_is_not_held_is_named_and_its_pressure_falls_too_slowly(tasks):
    found = judged(faults.misread(faults.without(0.25)), *tasks)
    assert found.verdict == "stagnates"
    assert found.order_of_distance > judge.FALLS
    assert found.order_of_pressure == pytest.approx(0.5, abs=0.1)
    assert (
        "n = 4: the forces balance; on Γ3, the body enters the foundation at 1 vertex (1 at (0.25, 0))" in found.where
    )


def test_a_vertex_that_no_step_presses_is_not_judged_and_the_table_says_how_many():
    found = judged(faults.misread(faults.without(1.0)), exported("parabolic-gap"))
    assert found.verdict == "exact for P1"
    pressed, free, count = found.tested
    assert max(pressed, free) < count
    assert f"{pressed}/{count}" in judge.table([found])


def test_full_contact_presses_all_vertices_and_frees_none():
    case = [exported("full-contact", n) for n in (4, 8)]
    assert judge.tested(case[-1]) == (9, 0, 9)
    assert "1 vertex (4 at (1, 0))" in judged(faults.misread(faults.without(1.0)), *case).where
    assert judged(faults.tied, *case).verdict == "exact for P1"


def test_other_equations_leave_forces_where_none_may_be(tasks):
    without = judge.answer(tasks[1], faults.other_stress(lambda stress: 0 * stress))
    assert judge.measure(tasks[1], without).tangential > 0.01


def test_each_load_scale_has_its_own_class_and_its_line_names_it():
    both = [exported("advance-recede", times=(0.55,), scale=scale) for scale in (1.0, 10.0)]
    found = {task.name: (task.scale == 1) * judge.answer(task, ours.make) for task in both}
    one, ten = judge.assess(both, found)
    assert one.verdict == "exact for P1"
    assert ten.verdict == "wrong"
    assert ten.name == "advance-recede × 10"
    assert "advance-recede × 10  " in judge.table([one, ten])
    with pytest.raises(judge.TaskError, match="has the case and the level of another task"):
        judge.assess([both[0], both[0]], found)


@pytest.mark.parametrize("case", ["rotated", "corner"])
def test_the_foundation_lies_under_the_face_and_covers_it(case):
    data = with_foundation(at_one_time(case, 8), 5)
    for piece, slab in zip(data["contact"], data["foundation"], strict=True):
        face = data["vertices"][np.unique(piece["facets"])]
        points = slab["vertices"]
        assert ((points - face[0]) @ piece["normal"]).min() == pytest.approx(0, abs=1e-12)
        corners = points[slab["cells"]]
        assert (np.linalg.det(corners[:, 1:] - corners[:, :1]) > 0).all()
        assert np.ptp(points[np.unique(slab["facets"])], axis=0).max() > np.ptp(face, axis=0).max()


@pytest.mark.parametrize("scale", [1.0, 10.0])
def test_a_task_has_the_gap_in_the_units_of_its_loads(scale):
    data = at_one_time("parabolic-gap", scale=scale)
    (piece,) = data["contact"]
    (again,) = read(data).scaled(3).gaps()
    x = np.array(data["vertices"])[piece["vertices"], 0]
    assert [piece["gap"], again / 3] == [pytest.approx(scale * 6 * (x - 0.4) ** 2)] * 2
    assert "gap" not in at_one_time("full-contact")["contact"][0]


# Files and commands

FILES = {
    "has no numbers": lambda text: "",
    "line 1, has 49 numbers": lambda text: text.split(" ", 1)[1],
    "has commas or semicolons between the numbers": lambda text: text.replace(" ", ","),
    "has a comma": lambda text: text.replace(".", ","),
    "line 1: 'ux' is not a number": lambda text: f"ux uy\n{text}",
    "'****' stands for a number that needs more room": lambda text: text.replace("\n", " ****\n"),
    "has 4 lines": lambda text: text.splitlines()[0] + "\n" + text,
    "is text in UTF-16": lambda text: text.encode("utf-16"),
    "is a file of numpy.save": lambda text: b"\x93NUMPY\x01\x00",
    "is packed with xz": lambda text: lzma.compress(text.encode()),
}


@pytest.mark.parametrize(("found", "change"), FILES.items())
def test_a_file_that_is_no_text_of_numbers_is_refused_with_what_was_found_and_expected(change, found, tmp_path):
    one = exported("layered", 4)
    judge.write_answer(tmp_path, one, 0.5 + np.zeros((3, *one.vertices.shape)))
    path = tmp_path / one.name / "u.txt"
    changed = change(path.read_text())
    path.write_bytes(changed if isinstance(changed, bytes) else changed.encode())
    with pytest.raises(judge.TaskError) as error:
        judge.read_answer(tmp_path, one)
    message = str(error.value).replace(str(tmp_path), "")
    assert found in message
    assert "expected plain text: for each step (3 in all) a line of 50 numbers separated by blanks; " in message
    assert len(message) < 250


def test_exponents_of_fortran_are_read(tmp_path):
    one = exported("layered", 4)
    u = np.linspace(-1e-7, 3e5, 150).reshape(3, *one.vertices.shape)
    judge.write_answer(tmp_path, one, u)
    path = tmp_path / one.name / "u.txt"
    path.write_text(path.read_text().replace("e", "D"))
    assert "D" in path.read_text()
    assert (judge.read_answer(tmp_path, one) == u).all()


def test_the_command_writes_the_same_bytes_again_and_their_sums_and_names_a_line_that_is_none(tmp_path, told):
    command = f"export full-contact --levels 4 --instants 0.5 --to {tmp_path}"
    assert study(command) == 0
    before = everything(tmp_path)
    assert study(command) == 0
    assert everything(tmp_path) == before
    judge.read_tasks(tmp_path)
    (task,) = tmp_path.glob("*.xz")
    task.write_bytes(before[task][:-1] + b"x")
    with (tmp_path / "SHA256SUMS").open("a") as sums:
        with pytest.raises(judge.TaskError, match="SHA256SUMS"):
            judge.read_tasks(tmp_path)
        sums.write("mine\n")
    before = everything(tmp_path)
    named = "SHA256SUMS, line 2: found 'mine', expected a checksum and a file: remove the line"
    assert named in told(f"{command} --scale 2")
    assert everything(tmp_path) == before


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("yield-and-release", "not linear"),
        ("full-contact --instants 2", "--instants"),
        ("full-contact --steps 3", "--steps"),
        ("full-contact --mode march --instants 0.5", "--instants"),
    ],
)
def test_what_cannot_be_exported_is_refused(options, message, refused):
    assert message in refused(f"export {options}")


def test_tasks_for_two_levels_are_small_enough_to_commit(tmp_path):
    """100 000 bytes is what another project may commit: on the mesh that takes the most room of those below."""
    times = [resolve("corner").solution.body.T * part for part in FROZEN_TIMES]
    path = write_task(tmp_path, frozen(task("corner", 16, "shaken"), times))
    assert path.stat().st_size <= 100_000


@pytest.mark.parametrize(("suffix", "pack"), [(".xz", lzma.compress), (".gz", gzip.compress), ("", bytes)])
def test_a_task_is_read_whatever_it_is_packed_by(suffix, pack, tmp_path):
    data = exported("advance-recede", 4, times=(0.55,)).data
    packed = pack(json.dumps(data).encode())
    path = tmp_path / f"one.json{suffix}"
    path.write_bytes(packed)
    (found,) = judge.read_tasks(tmp_path)
    assert found.name == "one"
    assert found.data == data
    path.write_bytes(packed[:-20])
    with pytest.raises(judge.TaskError, match=r"one\.json"):
        judge.read_tasks(tmp_path)


ALONE = (
    "import sys; sys.modules.update(dict.fromkeys(['scipy', 'sympy', 'skfem', 'study', 'manufactured', 'pandas'])); "
    "sys.path.insert(0, sys.argv.pop(1)); import contact_judge; sys.exit(contact_judge.main())"
)


def test_the_judge_runs_as_a_command_with_numpy_alone(tmp_path):
    """Nothing but NumPy can be imported: every other package of the environment is refused."""
    write_task(tmp_path / "tasks", at_one_time("advance-recede"))
    (one,) = judge.read_tasks(tmp_path / "tasks")
    u = judge.answer(one, ours.make)
    command = [sys.executable, "-c", ALONE, str(CODES), str(tmp_path / "tasks"), str(tmp_path / "answers")]
    for factor, code, said in ((1, 0, "exact for P1"), (3, 1, "wrong")):
        judge.write_answer(tmp_path / "answers", one, factor * u)
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert (done.returncode, said in done.stdout) == (code, True), done.stderr


def test_a_march_can_be_done_from_unpacked_files_alone(tmp_path):
    one = exported("anisotropic", 4, steps=3)
    judge.unpack(one, tmp_path)
    assert not list((tmp_path / one.name).glob("initial_stress*"))

    def of(name):
        return np.loadtxt(tmp_path / one.name / f"{name}.txt", ndmin=2)

    k = float(of("step")[0, 0])
    u = of("start")
    step = ours.make(one)
    A, G = (of(name).reshape(-1, 3, 3) for name in "AG")
    assert np.allclose(of("stiffness").reshape(-1, 3, 3), A / k + G / 2, rtol=1e-14)
    for n in range(one.count):
        load, stress = one.step(n, u)
        assert np.array_equal(of(f"load_{n + 1}"), load)
        assert np.allclose(np.einsum("cij,cj->ci", G / 2 - A / k, one.strain(u)), stress, rtol=0, atol=1e-12)
        u = step(load, stress)
