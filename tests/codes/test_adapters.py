"""Adapters are driven as they are stated, ``make codes`` keeps what the judge says, and the command of the judge."""

import json
import lzma
import os
import shlex
import shutil
import subprocess
import sys
from dataclasses import fields
from types import SimpleNamespace
from xml.etree import ElementTree

import common
import contact_judge as judge
import drive
import numpy as np
import pytest
import run_codes
import this_study
from commands import study
from judged_codes import at_one_time, exported, judged, read, task
from places import CODES, RESULTS
from schemas import schema

from study.cli.export import frozen, march, with_foundation, write_task
from study.ledger.codes import FOLDER, MARCHES, Codes
from study.ledger.datafiles import DataError

KEY = ["code", "variant", "case", "family"]


@pytest.fixture(scope="module")
def directory(tmp_path_factory):
    place = tmp_path_factory.mktemp("tasks")
    for case, levels in (("corner", (4, 8)), ("cube-disc", (2, 3))):
        for n in levels:
            write_task(place, frozen(task(case, n), (0.15, 0.55)))
    return place


@pytest.mark.parametrize("adapter", ["this_study", "scikit_fem"])
def test_an_adapter_whose_code_is_here_is_exact_in_the_plane_and_in_space(adapter, directory, tmp_path):
    drive.main(adapter, str(directory), str(tmp_path))
    rows = json.loads((tmp_path / f"{adapter}.json").read_text())
    assert {(row["case"], row["verdict"]) for row in rows} == {(c, "exact for P1") for c in ("corner", "cube-disc")}
    assert max(row["invariance"] for row in rows) < 1e-10
    errors, classes = run_codes.table(rows)
    assert len(errors) == 4
    assert [row["class"] for row in classes] == ["exact for P1"] * 2


def test_a_task_that_a_code_cannot_express_is_named_with_the_reason(directory):
    tasks = judge.read_tasks(directory)

    def make(task):
        raise common.CannotExpressError("no springs in this code")

    row = drive.variant_on(make, tasks[:2])
    key = dict.fromkeys(("code", "version", "variant", "case", "family"), "x")
    errors, (left,) = run_codes.table([key | row])
    assert errors == []
    assert left["class"] == "not expressed"
    assert left["reason"] == "no springs in this code"


def test_a_variant_stops_at_its_finest_level_and_its_class_is_that_of_the_meshes_before(
    directory, tmp_path, monkeypatch
):
    (make,) = this_study.VARIANTS.values()
    two = SimpleNamespace(CODE="c", VERSION="1", VARIANTS={"slow": make, "quick": make}, FINEST={"slow": 4})
    monkeypatch.setitem(sys.modules, "two_variants", two)
    drive.main("two_variants", str(directory), str(tmp_path))
    rows = json.loads((tmp_path / "two_variants.json").read_text())
    levels = {(row["variant"], row["case"]): row["levels"] for row in rows}
    assert levels["slow", "corner"] == [4]
    assert levels["quick", "corner"] == [4, 8]
    assert levels["slow", "cube-disc"] == levels["quick", "cube-disc"] == [2, 3]


def test_a_class_that_is_not_the_committed_one_is_reported():
    _, committed = run_codes.read(RESULTS / "codes")
    rows = [dict(row) for row in committed]
    assert run_codes.differing(rows, committed) == []
    rows[0]["class"] = "wrong"
    (told,) = run_codes.differing(rows, committed)
    assert told.endswith("↦ wrong")


@pytest.mark.parametrize("folder", ["codes", "codes/march"])
def test_committed_files_are_what_their_rows_are_written_as(folder, tmp_path):
    run_codes.write(tmp_path, *run_codes.read(RESULTS / folder))
    for name in ("errors.csv", "classes.csv"):
        assert (tmp_path / name).read_text() == (RESULTS / folder / name).read_text()


@pytest.mark.parametrize(
    ("folder", "grades"),
    [(FOLDER, {"exact for P1", "consistent", "stagnates", "wrong"}), (MARCHES, {"exact for P1", "consistent"})],
)
def test_committed_classes_are_those_of_the_committed_errors(folder, grades):
    codes = Codes.read(RESULTS, folder)
    seen = set()
    classes = codes.classes.set_index(KEY)["class"]
    columns = [field.name for field in fields(judge.Errors) if field.name in codes.errors]
    for name, rows in codes.errors.sort_values("level").groupby(KEY):
        errors = [judge.Errors(**row) for row in rows[columns].to_dict("records")]
        assert classes[name] == judge.classify(list(rows["h"]), errors), name
        seen.add(classes[name])
    assert seen >= grades


def test_results_without_other_codes_have_none_and_half_a_table_is_refused(tmp_path):
    assert Codes.read(tmp_path) is None
    (tmp_path / "codes").mkdir()
    (tmp_path / "codes" / "errors.csv").write_text("code,version\na,1\n")
    with pytest.raises(DataError, match="make codes"):
        Codes.read(tmp_path)


@pytest.fixture(scope="module")
def packed(tmp_path_factory):
    """A directory with one task and SHA256SUMS."""
    place = tmp_path_factory.mktemp("packed")
    write_task(place, at_one_time("full-contact"))
    return place


@pytest.fixture
def place(packed, tmp_path):
    """A copy with the directory ``tasks``, and ``answers`` with the right answer."""
    shutil.copytree(packed, tmp_path / "tasks")
    (one,) = judge.read_tasks(tmp_path / "tasks")
    judge.write_answer(tmp_path / "answers", one, judge.answer(one, this_study.make))
    return tmp_path


def run(place, options=""):
    return judge.main(shlex.split(f"{place}/tasks {place}/answers {options}"))


def change_answer(place, change):
    (path,) = place.glob("answers/*/u.txt")
    np.savetxt(path, change(np.loadtxt(path, ndmin=2)))


def task_with(without="", **changes):
    """Replace the task by changed data, without one key, as JSON that is not packed."""

    def damage(place):
        unpacked_as_well(place)
        for path in (*place.glob("tasks/*.xz"), place / "tasks" / "SHA256SUMS"):
            path.unlink()
        (path,) = place.glob("tasks/*")
        data = json.loads(path.read_text()) | changes
        data.pop(without, None)
        path.write_text(json.dumps(data))

    return damage


def put(name, text, mode="w"):
    """Write another file of the tasks, or of the answer, or append to it."""

    def damage(place):
        with ((place if "/" in name else place / "tasks") / name).open(mode) as file:
            file.write(text)

    return damage


def unpacked_as_well(place):
    (path,) = place.glob("tasks/*.xz")
    path.with_suffix("").write_bytes(lzma.decompress(path.read_bytes()))


ANSWER = "answers/full-contact-one-diagonal-frozen-4"
DAMAGE = {
    "SHA256SUMS has 'mine'": put("SHA256SUMS", "mine\n", "a"),
    "expected a sum and a file that is here": lambda place: next(place.glob("tasks/*.xz")).unlink(),
    "holds no *.json.xz": lambda place: [path.unlink() for path in place.glob("tasks/*")],
    "a holds a JSON list": put("a.json", "[1, 2]"),
    "a.json is no JSON": put("a.json", "{"),
    "unpacks to more than": lambda place: (place / "tasks" / "a.json.xz").write_bytes(
        300 * lzma.compress(bytes(1 << 20))
    ),
    "same name": unpacked_as_well,
    "lacks the key 'clam": task_with(without="clamped"),
    "contact-task 3, expected contact-task 1 or 2": task_with(version=3),
    "is no task of contact-task": task_with(cells=[[0, 1, 999]]),
    "0 steps": task_with(steps=[], judge=[]),
    "the scale 0.0": task_with(scale=0),
    "is no task": task_with(contact=[]),
    "lacks the key 'G'": task_with(law={"A": {"matrix": [[1.0]], "factor": 1}}),
    "u.txt is missing or cannot be read": lambda place: next(place.glob("answers/*/u.txt")).unlink(),
    "u.txt, line 1, has 3 numbers, expected plain text: for each step (1 in all)": put(f"{ANSWER}/u.txt", "1 2 3"),
    "forces.txt, line 1, has 1 numbers, expected": put(f"{ANSWER}/forces.txt", "1"),
}


@pytest.mark.parametrize(("message", "damage"), DAMAGE.items())
def test_what_cannot_be_read_is_named_and_the_exit_code_is_2(damage, message, place, capsys):
    damage(place)
    assert run(place) == 2
    told = capsys.readouterr()
    assert message in told.err
    assert told.err.startswith("contact_judge: ")
    assert told.out == ""


@pytest.mark.parametrize("options", ["--tolerance -1", "--tolerance nan", "--junit /no/such/place/x.xml"])
def test_options_that_cannot_be_used_are_refused(options, place, capsys):
    assert run(place, options) == 2
    assert capsys.readouterr().err.startswith("contact_judge: ")


def test_one_missing_answer_does_not_stop_the_judge_and_a_subset_leaves_it_out(place, capsys):
    write_task(place / "tasks", at_one_time("layered"))
    assert run(place) == 2
    told = capsys.readouterr()
    assert "layered-one-diagonal-frozen-4/u.txt is missing" in told.err
    assert "exact for P1" in told.out
    assert run(place, "--only full-*") == run(place, "--only full-contact") == 0
    assert run(place, "--only corner") == 2
    assert "--only corner is no case and no task; there are tasks of full-contact, layered" in capsys.readouterr().err


@pytest.mark.parametrize(("factor", "remaining"), [(1.5, 20), (1, 0)])
def test_a_picture_has_the_mesh_and_the_forces_that_remain(factor, remaining, place, tmp_path):
    """Paths of the mesh, the contact face, arrows and dots."""
    change_answer(place, lambda u: factor * u)
    run(place, f"--plot {tmp_path}/a.svg")
    paths = ElementTree.parse(tmp_path / "a.svg").findall("{*}path")
    assert [path.get("d", "").count("M") for path in paths] == [32, 4, remaining, remaining]


def test_a_reader_who_closes_the_pipe_causes_no_traceback(place):
    judge_file = str(CODES / "contact_judge.py")
    command = [sys.executable, judge_file, str(place / "tasks"), str(place / "answers"), "--json"]
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, text=True, check=False)
    os.close(writer)
    assert done.stderr == ""


def test_exit_codes_and_tolerance(place, capsys):
    assert run(place) == 0
    change_answer(place, lambda u: 1.0001 * u)
    assert run(place) == 3
    assert run(place, "--tolerance 1e-9") == 3
    assert run(place, "--tolerance 0.5") == 0
    assert "passes: at most 0.5 of the error" in capsys.readouterr().out
    change_answer(place, lambda u: u + 1000)
    assert run(place, "--tolerance 1e9") == 1
    change_answer(place, lambda u: np.nan * u)
    assert run(place, "--tolerance 1e9") == 1


def test_a_series_that_fails_counts_more_than_one_that_is_undecided(place):
    write_task(place / "tasks", at_one_time("full-contact", family="criss-cross"))
    for one in judge.read_tasks(place / "tasks"):
        u = judge.answer(one, this_study.make)
        judge.write_answer(place / "answers", one, 1.001 * u if one.data["family"] == "criss-cross" else u + 1)
    assert run(place) == 1


@pytest.mark.parametrize("output", ["", "--json"])
def test_junit_has_a_case_for_each_series_and_no_control_characters(output, place, tmp_path, capsys):
    path = tmp_path / "a.xml"

    def suite(code):
        assert run(place, f"--junit {path} {output}") == code
        return ElementTree.parse(path).getroot()

    right = suite(0)
    assert right.get("tests") == "1"
    assert right.get("failures") == "0"
    change_answer(place, lambda u: 1.001 * u)
    (failure,) = suite(3).iter("failure")
    assert "undecided" in failure.get("message")
    assert "times the right ones" in failure.text
    task_with(case="a\x1bc")(place)
    (one,) = suite(3)
    assert one.get("name").startswith(r"a\u001bc")
    assert "\x1b" not in capsys.readouterr().out


def test_the_json_is_valid_and_fits_its_schema_even_without_numbers(place, capsys):
    for change in (lambda u: u, lambda u: np.nan * u):
        change_answer(place, change)
        run(place, "--json")
        rows = json.loads(capsys.readouterr().out, parse_constant=pytest.fail)
        schema("contact-verdict").validate(rows)
    assert not schema("contact-verdict").is_valid([rows[0] | {"verdict": "good"}])


@pytest.mark.parametrize("kind", ["frozen", "march", "foundation"])
def test_tasks_fit_their_schema(kind):
    data = march(task("corner", 4), 2) if kind == "march" else at_one_time("corner")
    data = read(with_foundation(data, 3) if kind == "foundation" else data).data
    assert data["version"] == 2
    schema("contact-task").validate(data)
    del data["contact"][0]["facets"]
    assert not schema("contact-task").is_valid(data)


def test_version_1_is_read_and_is_the_same_task():
    task = judge.Task("old", exported("corner", 4, times=(0.55,)).data | {"version": 1})
    assert judged(this_study.make, task).verdict == "exact for P1"


def test_the_command_exports_several_cases_on_the_families_of_the_quick_study(tmp_path, refused):
    assert study(f"export full-contact layered --levels 4 --instants 0.5 --out {tmp_path}") == 0
    names = {path.name for path in tmp_path.glob("*.xz")}
    assert names == {"full-contact-one-diagonal-frozen-4.json.xz", "layered-criss-cross-frozen-4.json.xz"}
    said = refused("export cube-two-faces --levels 4")
    assert said.startswith("study: case cube-two-faces on one-diagonal meshes of level 4: ")
    assert said.endswith("levels that would do: 3, 6\n")
    assert "give each case once" in refused("export full-contact full-contact")


@pytest.mark.parametrize(
    ("words", "change"),
    {
        "(1, 2, 25), expected (1, 25, 2): steps, vertices, components": lambda u: np.swapaxes(u, 1, 2),
        "has the shape (25, 2), expected (1, 25, 2)": lambda u: u[0],
        "is no array of numbers": lambda u: "many",
        "is no array of numbers (setting": lambda u: [[1.0], [1.0, 2.0]],
        "expected (1, 25, 2)": lambda u: None,
    }.items(),
)
def test_arrays_of_another_shape_are_refused_in_words(change, words, packed):
    (task,) = judge.read_tasks(packed)
    u = judge.answer(task, this_study.make)
    with pytest.raises(judge.TaskError) as refused:
        judge.assess([task], {task.name: change(u)})
    assert words in str(refused.value)
    assert str(refused.value).startswith(f"the answer to {task.name} ")
    with pytest.raises(judge.TaskError, match=r"the result of step 1 of .* expected"):
        judge.answer(task, lambda task: lambda load, stress: [change(u)])
    with pytest.raises(judge.TaskError, match=r"reported pressure of .*: steps, contact vertices"):
        judge.assess([task], {task.name: u}, {task.name: {"pressure": change(u)}})
