"""What a command does to directories, disks and terminals that are not as one would wish."""

from __future__ import annotations

import io
import json
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from study.bound import bounded
from study.cli import run
from study.cli.main import CLOSED, INTERRUPTED, main
from study.cli.options import RESUMED, STARTS_AGAIN, parser
from study.controls.baselines import Sweep
from study.controls.control import Control
from study.controls.run_controls import run_controls
from study.ledger.datafiles import made_by
from study.ledger.files import StoreError, write_text
from study.ledger.verdict import FAILS, HOLDS, Verdict, row
from study.ledger.window import at_most
from study.run.executor import Processes
from study.run.plan import Plan
from study.run.provenance import provenance, read_provenance
from study.run.store import Store
from study.run.tasks import TaskStore
from study.statements.green import Green
from study.statements.shared.scope import Scope

COARSE = ["--steps", "2", "--refine", "0", "--shorter", "1"]
COMMANDS = ["run --case full-contact --levels 2 4 8", "check", "tables", "figures", "report"]
COMMANDS += ["controls", "seeds --seeds 1", "sensitivity"]


def everything(directory: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in directory.rglob("*") if path.is_file()}


@pytest.mark.parametrize("command", COMMANDS)
def test_files_that_the_study_did_not_write_are_never_overwritten(command: str, tmp_path, told) -> None:
    write_text(tmp_path / "data" / "rates.csv", "mine")
    write_text(tmp_path / "figures" / "convergence.png", "mine")
    before = everything(tmp_path)
    said = told(*command.split(), "--out", str(tmp_path))
    assert "no finished run" in said or f"{tmp_path}/data/rates.csv was not written by a study" in said
    assert everything(tmp_path) == before


SQUARE = f"{Path(__file__).parents[2]}/examples/certificates/problems.py:square"
OWNED = [
    (["bound", "ramp", "--levels", "4", *COARSE], "ramp"),
    (["show", "full-contact"], "full-contact"),
    (["export", "full-contact", "--levels", "4"], ""),
    (["certify", SQUARE, "--family", "one-diagonal", "--levels", "2", *COARSE], "square"),
]
"""Commands whose directory is theirs alone, and its name below ``--out``."""


@pytest.mark.parametrize(("command", "folder"), OWNED, ids=["bound", "show", "export", "certify"])
def test_a_folder_of_somebody_else_is_left_alone(command: list[str], folder: str, tmp_path, told) -> None:
    write_text(tmp_path / folder / "notes.txt", "mine")
    mine = tmp_path / folder / "notes.txt"
    assert f"{mine} was not written by a study" in told(*command, "--out", str(tmp_path))
    assert list(everything(tmp_path)) == [mine]


def test_other_files_beside_those_of_the_study_are_no_hindrance(tmp_path: Path) -> None:
    write_text(tmp_path / "src" / "mine.py", "")
    write_text(tmp_path / "README.md", "")
    Store(tmp_path).check()
    with Store(tmp_path).locked():
        write_text(tmp_path / "data" / "rates.csv", "ours")
    Store(tmp_path).check()


def test_a_bound_resumes_with_the_levels_that_are_not_done(tmp_path, capsys, monkeypatch) -> None:
    asked: list[int] = []
    original = bounded.bounded_solution

    def counted(*arguments: Any) -> bounded.BoundedSolution:
        asked.append(arguments[3])
        return original(*arguments)

    monkeypatch.setattr(bounded, "bounded_solution", counted)
    monkeypatch.setattr("study.cli.bound.draw_one", lambda *_: [])
    command = ["bound", "ramp", *COARSE, "--out", str(tmp_path), "--levels", "2"]
    assert main(command) == main([*command, "4"]) == 0
    whole, printed = everything(tmp_path), capsys.readouterr().out
    assert main([*command, "4"]) == 0
    assert capsys.readouterr().out.split("enclosed")[-1] == printed.split("enclosed")[-1]
    assert (asked, everything(tmp_path)) == ([2, 4], whole)
    (tmp_path / "ramp" / "trajectory-4.npz").unlink()
    assert main([*command, "4", "--scheme", "bdf2"]) == 0
    assert asked == [2, 4, 2, 4]


HELD: list[Any] = []
"""Locks that a worker process holds until it ends."""


def hold(store: Store | TaskStore) -> None:
    HELD.append(lock := store.locked())
    lock.__enter__()


@pytest.mark.parametrize(
    ("store", "command", "folder"), [(Store, *OWNED[0]), (TaskStore, *OWNED[2])], ids=["bound", "export"]
)
def test_two_commands_on_one_directory_are_refused_by_name(store, command, folder: str, tmp_path, told) -> None:
    with Processes(1) as other:
        other.submit(hold, store(tmp_path / folder)).result()
        said = told(*command, "--out", str(tmp_path))
    assert f"another run works on {tmp_path / folder}: wait until it ends, or give another directory with" in said


def test_an_export_leaves_nothing_but_tasks_and_their_sums(tmp_path: Path) -> None:
    command = ["export", "full-contact", "--levels", "4", "--instants", "0.5", "--to", str(tmp_path / "tasks")]
    for scale in ("1", "2"):
        assert main([*command, "--scale", scale]) == 0
    names = "full-contact-one-diagonal-frozen-4.json.xz", "full-contact-one-diagonal-frozen-4-times-2.json.xz"
    assert {path.name for path in (tmp_path / "tasks").rglob("*")} == {*names, "SHA256SUMS"}


def test_a_lock_that_its_owner_has_removed_holds_nothing(tmp_path: Path) -> None:
    """Opened while one export worked, locked after it ended: a third one has a new file by then."""
    store = TaskStore(tmp_path)
    with store.lock.open("a") as opened_before:
        for change in (store.lock.unlink, store.lock.touch):
            change()
            with pytest.raises(StoreError, match="another run works on"):
                store._hold(opened_before)
    with store.locked():
        assert store.lock.exists()
    assert list(tmp_path.iterdir()) == []


def test_controls_resume_with_what_is_not_done(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def verdicts(self: Sweep, defect: Callable[[Any], Any]) -> list[Verdict]:
        with (Path(self.case) / "calls").open("a") as calls:
            calls.write(".")
        state = HOLDS if defect(1) == 1 else FAILS
        return [row(Green(), "order", "a", at_most(1.0), (0.5, (0.5, 0.5), state), "case")]

    monkeypatch.setattr(Sweep, "verdicts", verdicts)
    setting, store = Sweep(str(tmp_path)), Store(tmp_path / "out")
    controls = [Control(name, "what", setting, "", doubled, "order") for name in ("one", "two")]
    # Settings that are called alike are not mistaken for one another.
    twice = [*controls, Control("one", "what", replace(setting, families=("shaken",)), "", doubled, "order")]
    monkeypatch.setattr("study.controls.table.CONTROLS", twice)
    with Processes(1) as executor:
        first, again, whole = (
            run_controls(some, executor, store, lambda: None) for some in (controls[:1], controls, twice)
        )
    assert again[:2] == first
    assert [outcome.caught for outcome in again] == [None, True, True]
    assert len(whole) == 5
    assert (tmp_path / "calls").read_text() == "....."


def doubled(setup: Any) -> Any:
    return 2 * setup


@pytest.mark.parametrize(
    ("command", "said"),
    [
        *((command, RESUMED) for command in ("run", "bound ramp", "controls")),
        *((command, STARTS_AGAIN) for command in ("cases", "figures")),
    ],
)
def test_ctrl_c_says_what_is_true_of_the_command(command: str, said: str, tmp_path, told, monkeypatch) -> None:
    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    # A command that is not stopped writes here, not into the committed results.
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("importlib.import_module", stop)
    assert told(*command.split(), code=INTERRUPTED) == f"study: interrupted; {said}\n"


@pytest.mark.parametrize("encoding", ["ascii", "cp1252", "utf-8"])
@pytest.mark.parametrize("arguments", [["cases"], ["cases", "--json"], ["rates", "none.csv"]])
def test_an_output_with_few_letters_ends_no_command(encoding: str, arguments: list[str], monkeypatch) -> None:
    streams = [io.TextIOWrapper(io.BytesIO(), encoding=encoding) for _ in range(2)]
    monkeypatch.setattr("sys.stdout", streams[0])
    monkeypatch.setattr("sys.stderr", streams[1])
    assert main(arguments) == (2 if arguments[0] == "rates" else 0)
    for stream in streams:
        stream.flush()
    text = streams[0].buffer.getvalue().decode(encoding)  # type: ignore[attr-defined]
    if "--json" in arguments:
        assert any("Γ" in entry["summary"] for entry in json.loads(text))
    elif arguments == ["cases"]:
        assert ("\\u0393" in text) == (encoding != "utf-8")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no /dev/full")
def test_a_full_disk_behind_the_output_is_said_in_words() -> None:
    with open("/dev/full", "w") as full:
        done = subprocess.run([*STUDY, *RATES], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    said = "study: cannot write the output: the disk is full (No space left on device); free space there"
    assert (done.returncode, done.stderr.startswith(said), len(done.stderr.splitlines())) == (2, True, 1)


def test_a_reader_who_has_seen_enough_ends_the_command_without_a_word() -> None:
    with subprocess.Popen([*STUDY, *RATES], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as command:
        assert command.stdout and command.stderr  # noqa: PT018
        command.stdout.close()
        assert command.stderr.read() == ""
    assert command.returncode == CLOSED


STUDY = [sys.executable, "-m", "study"]
RATES = ["rates", str(Path(__file__).parents[2] / "examples" / "errors.csv")]
"""A command that prints, and needs no case."""


def planned(tmp_path: Path, *arguments: str) -> Scope:
    """The scope of a run, whose provenance is written as if it were finished."""
    options = parser().parse_args(["run", *arguments])
    scope = run.with_levels_of(tmp_path, run.scope_from_options(options))
    write_text(tmp_path / "data" / "provenance.json", json.dumps(provenance(Plan.of(scope), tmp_path)))
    return scope


def test_levels_can_be_added_to_a_directory(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    planned(tmp_path, "--case", "corner", "cube-disc")
    first = read_provenance(tmp_path)["planned"]
    scope = planned(tmp_path, "--case", "corner", "cube-disc", "--levels", "64")
    assert set(first) <= set(read_provenance(tmp_path)["planned"])
    assert dict(scope.own)["corner"].all == (8, 16, 32, 64)
    assert f"{tmp_path} has corner on the levels 8 16 32: 64 added" in capsys.readouterr().err
    shorter = planned(tmp_path / "other", "--case", "corner", "--levels", "8", "16")
    assert shorter.own == ()


def test_hints_for_repair_name_the_command_that_made_the_directory(tmp_path, told) -> None:
    planned(tmp_path, "--case", "corner", "--levels", "8", "16", "32", "--step", "0.1")
    line = f"study run --case corner --levels 8 16 32 --step 0.1 --out {tmp_path}"
    assert made_by(tmp_path) == line
    assert f".csv is missing: make it with `{line}`" in told("check", "--out", str(tmp_path))
    assert made_by(tmp_path / "none") == f"study run --out {tmp_path / 'none'}"
    write_text(tmp_path / "a b" / "data" / "provenance.json", json.dumps({"plan": "full"}))
    assert made_by(tmp_path / "a b") == f"study run --full --out '{tmp_path}/a b'"
