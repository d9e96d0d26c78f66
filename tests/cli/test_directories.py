"""What a command does to directories, disks, data and terminals that are not as one would wish."""

import errno
import json
import os
import re
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest
from commands import study
from places import CERTIFICATES, EXAMPLES
from tables import everything, texts

from study.bound import bounded
from study.cli import run
from study.cli.export import TaskStore
from study.cli.main import BROKEN_PIPE, INTERRUPTED
from study.cli.options import RESUMED, STARTS_AGAIN, parser
from study.ledger.files import StoreError, UsageError, write_text
from study.run.executor import Processes
from study.run.plan import Plan
from study.run.provenance import commit, provenance, read_provenance
from study.run.store import Store

COARSE = "--steps 2 --refine 0 --shorter 1"


@pytest.mark.parametrize(
    "command",
    [
        "run --case full-contact --levels 2 4 8",
        "check",
        "tables",
        "figures",
        "report",
        "faults --case full-contact",
        "seeds --seeds 1",
    ],
)
def test_files_that_the_study_did_not_write_are_never_overwritten(command, tmp_path, told):
    write_text(tmp_path / "data/rates.csv", "mine")
    write_text(tmp_path / "figures/convergence.png", "mine")
    before = everything(tmp_path)
    said = told(f"{command} --out {tmp_path}")
    assert "no finished run" in said or f"{tmp_path}/data/rates.csv was not written by a study" in said
    assert everything(tmp_path) == before


SQUARE = f"{CERTIFICATES}/problems.py:square"
OWNED = [
    (f"bound ramp --levels 4 {COARSE}", "ramp"),
    ("show full-contact", "full-contact"),
    ("export full-contact --levels 4", ""),
    (f"certify {SQUARE} --family one-diagonal --levels 2 {COARSE}", "square"),
]
"""Commands whose directory is theirs alone, and its name below ``--out``."""


@pytest.mark.parametrize(("command", "folder"), OWNED)
def test_a_folder_of_somebody_else_is_left_alone(command, folder, tmp_path, told):
    write_text(tmp_path / folder / "notes.txt", "mine")
    mine = tmp_path / folder / "notes.txt"
    assert f"{mine} was not written by a study" in told(f"{command} --out {tmp_path}")
    assert list(everything(tmp_path)) == [mine]


def test_a_bound_resumes_with_the_levels_that_are_not_done_and_removes_those_of_another_problem(
    tmp_path, capsys, monkeypatch
):
    asked = []
    original = bounded.bounded_solution

    def counted(*arguments):
        asked.append(arguments[3])
        return original(*arguments)

    monkeypatch.setattr(bounded, "bounded_solution", counted)
    monkeypatch.setattr("study.cli.bound.draw_one", lambda *_: [])
    command = f"bound ramp {COARSE} --out {tmp_path} --levels 2"
    for file, content in ((".lock", ""), ("problem.txt", "another problem"), ("../trajectory-9.npz", "")):
        write_text(tmp_path / "ramp/data" / file, content)
    assert study(command) == study(f"{command} 4") == 0
    printed, removed = capsys.readouterr()
    whole = everything(tmp_path)
    assert f"removed from {tmp_path}/ramp: results of other data" in removed
    assert tmp_path / "ramp/trajectory-9.npz" not in whole
    assert study(f"{command} 4") == 0
    assert capsys.readouterr().out.split("enclosed")[-1] == printed.split("enclosed")[-1]
    assert asked == [2, 4]
    assert everything(tmp_path) == whole
    (tmp_path / "ramp/trajectory-4.npz").unlink()
    assert study(f"{command} 4 --scheme bdf2") == 0
    assert asked == [2, 4, 2, 4]


HELD = []
"""Locks that a worker process holds until it ends."""


def hold(store):
    HELD.append(lock := store.locked())
    lock.__enter__()


@pytest.mark.parametrize(
    ("store", "command", "folder"),
    [(Store, *OWNED[0]), (TaskStore, *OWNED[2]), (Store, "run --case full-contact --levels 2 4", "")],
)
def test_two_commands_on_one_directory_are_refused_by_name_until_the_first_one_ends(
    store, command, folder, tmp_path, told
):
    with Processes(1) as other:
        other.submit(hold, store(tmp_path / folder)).result()
        said = told(f"{command} --out {tmp_path}")
        if store is Store:
            with pytest.raises(StoreError, match="another run works on"), Store(tmp_path / folder).steady():
                pass
    assert f"another run works on {tmp_path / folder}: wait until it ends, or give another directory with" in said
    with store(tmp_path / folder).locked():
        pass


def test_the_record_of_a_run_names_the_commit_and_whether_the_code_was_changed_since(tmp_path, monkeypatch):
    monkeypatch.setattr("study.run.provenance.ROOT", tmp_path)
    assert commit() == {"commit": "", "clean": False}
    write_text(tmp_path / "study/a.py", "")
    git = ["git", "-C", str(tmp_path), "-c", "user.name=a", "-c", "user.email=a@b"]
    for words in (["init", "-q"], ["add", "."], ["commit", "-qm", "first"]):
        subprocess.run([*git, *words], check=True)
    head = subprocess.run([*git, "rev-parse", "HEAD"], check=True, capture_output=True, text=True).stdout.strip()
    write_text(tmp_path / "results/rates.csv", "")
    assert commit() == {"commit": head, "clean": True}
    write_text(tmp_path / "study/a.py", "changed")
    assert commit() == {"commit": head, "clean": False}


@pytest.mark.parametrize(
    ("command", "said"),
    [
        *((command, RESUMED) for command in ("run", "bound ramp", "faults")),
        *((command, STARTS_AGAIN) for command in ("cases", "figures")),
    ],
)
def test_ctrl_c_says_what_is_true_of_the_command(command, said, tmp_path, told, monkeypatch):
    def stop(*_):
        raise KeyboardInterrupt

    # A command that is not stopped writes here, not into the committed results.
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("importlib.import_module", stop)
    assert told(command, code=INTERRUPTED) == f"study: interrupted; {said}\n"


ASLEEP = """
import signal, sys, time
signal.signal(signal.SIGINT, signal.default_int_handler)  # a suite that runs in the background ignores Ctrl-C
from study.run.executor import local_pool
with local_pool(2) as pool:
    job, _ = [executor.submit(time.sleep, 60) for executor in pool.executors]
    while not job.running():
        time.sleep(0.01)
    print("started", flush=True)
    job.result()
"""


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signal that a test could send")
@pytest.mark.parametrize(
    ("number", "times", "send"),
    [(signal.SIGINT, 1, os.kill), (signal.SIGINT, 3, os.killpg), (signal.SIGKILL, 1, os.kill)],
)
def test_ctrl_c_and_a_kill_end_all_processes_at_once_however_often_it_is_pressed(number, times, send):
    """Ctrl-C reaches the whole process group, ``kill`` one process; a killed process leaves no worker behind."""
    command = [sys.executable, "-c", ASLEEP]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True) as process:
        assert process.stdout.readline() == b"started\n"
        for _ in range(times):
            with suppress(ProcessLookupError):
                send(process.pid, number)
            time.sleep(0.05)
        try:
            process.communicate(timeout=10)  # The pipes are open until the last worker has ended.
        finally:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
    assert process.returncode == -number


@pytest.mark.parametrize("command", ["rates {} --expected 2", "figures --out {}", "compare {} {}", "bound {}"])
def test_an_empty_name_is_refused(command, tmp_path, monkeypatch, told):
    monkeypatch.chdir(tmp_path)
    for name in ("''", "' '"):
        assert "got an empty text, expected a name" in told(command.replace("{}", name))
    assert [*tmp_path.iterdir()] == []


ORDERS = f"convergence_orders {EXAMPLES}/errors.csv"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no /dev/full")
@pytest.mark.parametrize(
    ("command", "said"),
    {
        "study cases": r"study: cannot write the output: the disk is full \(No space left on device\); free space",
        ORDERS: "convergence-orders: cannot write the output: ",
        f"{ORDERS} --expected 1 --junit /dev/full": "convergence-orders: /dev/full: ",
    }.items(),
)
def test_a_full_disk_behind_the_output_is_said_in_words(command, said):
    words = [sys.executable, "-m", *command.split()]
    with open("/dev/full", "w") as full:
        done = subprocess.run(words, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 2
    assert re.fullmatch(f"{said}.*\n", done.stderr)


def test_a_reader_who_has_seen_enough_ends_the_command_without_a_word():
    words = [sys.executable, "-m", "study", "cases"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as command:
        command.stdout.close()
        assert command.stderr.read() == ""
    assert command.returncode == BROKEN_PIPE


def planned(tmp_path, *arguments):
    """The scope of a run, whose provenance is written as if it were finished."""
    options = parser().parse_args(["run", *arguments])
    scope = run.with_levels_of(tmp_path, run.scope_from_options(options))
    write_text(tmp_path / "data/provenance.json", json.dumps(provenance(Plan.of(scope), tmp_path)))
    return scope


def test_levels_can_be_added_to_a_directory(tmp_path, capsys):
    planned(tmp_path, "--case", "corner", "cube-disc")
    first = read_provenance(tmp_path)["planned"]
    scope = planned(tmp_path, "--case", "corner", "cube-disc", "--levels", "64")
    assert set(first) <= set(read_provenance(tmp_path)["planned"])
    assert dict(scope.own)["corner"].all == (8, 16, 32, 64)
    assert f"{tmp_path} has corner on the levels 8 16 32: 64 added" in capsys.readouterr().err
    shorter = planned(tmp_path / "other", "--case", "corner", "--levels", "8", "16")
    assert shorter.own == ()


@pytest.mark.parametrize(
    ("command", "column", "word"),
    [
        *(("check", "error", word) for word in ("small", "nan", "")),
        *((command, "order", "steep") for command in ("tables", "figures", "report")),
    ],
)
def test_a_word_in_place_of_a_number_is_named_by_file_line_and_column(command, column, word, own, told):
    path = own / "data/rates.csv"
    table = texts(path)
    table.loc[2, column] = word
    table.to_csv(path, index=False)
    said = told(f"{command} --out {own}")
    assert f"{path}, line 4, column {column}: found {word!r}, expected a number" in said
    assert f"--levels 8 16 32 --out {own}`" in said


def test_a_plain_run_in_a_fresh_clone_leaves_the_committed_results_alone(tmp_path, told, monkeypatch):
    def measured(plan, store, pool):
        raise UsageError(f"it would write in {store.directory}")

    write_text(tmp_path / "results/data/provenance.json", "{}")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("study.cli.run.measure", measured)
    monkeypatch.setattr("study.run.plan.Plan.check", lambda *_: None)
    monkeypatch.setattr("study.cli.run.prove", lambda *_: [])
    assert told("run") == "study: it would write in results/quick\n"
    assert (tmp_path / "results/data/provenance.json").read_text() == "{}"


SLIVER = """
from manufactured import *
body = polygon([(0, 0), (3, 0), (3, 0.001), (0, 0.001)], [Kind.CONTACT, Kind.LOADED, Kind.LOADED, Kind.CLAMPED])
law = KelvinVoigt(isotropic(1, 1), isotropic(1, 1), "law")
mine = Data.formulas(body, law, f0=(0, 0))
"""


def test_what_would_take_for_ever_is_refused_at_once(tmp_path, told, refused):
    path = write_text(tmp_path / "sliver.py", SLIVER)
    assert "so thin that rounding errors hide" in refused(f"bound {path}:mine")
    for command in ("run --levels", "run --jobs", "bound ramp --steps"):
        told(f"{command} {'9' * 400}")
    for command in (
        "run --case full-contact --step 1e-12",
        "bound ramp --steps 10000000",
        "export full-contact --mode march --steps 10000000",
    ):
        assert "time steps were asked for, but only 1 to 1e+06 are allowed" in refused(command)
    for command in (
        "run --case full-contact --levels 8 16 99999",
        "bound ramp --levels 8 99999",
        f"certify {SQUARE} --family one-diagonal --levels 8 99999",
        "show full-contact --level 99999",
        "export full-contact --levels 99999",
    ):
        said = refused(command)
        assert re.search(r"99999 needs about \d+\.\d GiB of memory, .* are available; take coarser levels", said), said


@pytest.mark.parametrize("command", ["run --case full-contact --levels 2 4 8", "export corner --levels 4", "tables"])
@pytest.mark.parametrize(
    ("code", "said"),
    {
        errno.ENOSPC: "the disk is full ({}); free space there, or give a directory on another disk with --out",
        errno.EDQUOT: "the disk is full ({}); free space there, or give a directory on another disk with --out",
        errno.EROFS: "{}; give a directory you may write with --out",
    }.items(),
)
def test_a_disk_that_cannot_be_written_is_named_by_every_command(command, code, said, own, out, told, monkeypatch):
    def unwritable(*_):
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr("os.replace", unwritable)
    directory = own if command == "tables" else out
    printed = told(f"{command} --out {directory}")
    assert "cannot write" in printed
    assert said.format(os.strerror(code)) in printed
