"""What a command does to directories, disks, data and terminals that are not as one would wish."""

from __future__ import annotations

import errno
import io
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pandas as pd
import pytest

from convergence_orders.printing import printable
from study.bound import bounded
from study.cli import run
from study.cli.main import CLOSED, INTERRUPTED, main
from study.cli.options import RESUMED, STARTS_AGAIN, parser
from study.ledger.datafiles import made_by
from study.ledger.files import StoreError, UsageError, write_text, write_whole
from study.ledger.verdict import FAILS, row
from study.ledger.window import at_most
from study.present.outcome import write_junit
from study.run.executor import Processes
from study.run.plan import Plan
from study.run.provenance import commit, provenance, read_provenance
from study.run.store import Store
from study.run.tasks import TaskStore
from study.statements.korn import Korn
from study.statements.shared.scope import Scope

COARSE = ["--steps", "2", "--refine", "0", "--shorter", "1"]
COMMANDS = ["run --case full-contact --levels 2 4 8", "check", "tables", "figures", "report"]
COMMANDS += ["faults --case full-contact", "seeds --seeds 1"]


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


def test_figures_of_other_data_do_not_overwrite_the_files_of_somebody_else(made: Path, tmp_path, told) -> None:
    command = f"figures --data {made}/results --only orders --format svg --jobs 1 --out".split()
    for _ in range(2):
        told(*command, str(tmp_path / "new"), code=0)
    write_text(tmp_path / "mine" / "figures" / "orders.svg", "mine")
    assert "orders.svg was not written by a study" in told(*command, str(tmp_path / "mine"))
    assert list(everything(tmp_path / "mine").values()) == [b"mine"]


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
    ("store", "command", "folder"),
    [(Store, *OWNED[0]), (TaskStore, *OWNED[2]), (Store, ["run", "--case", "full-contact", "--levels", "2", "4"], "")],
    ids=["bound", "export", "run"],
)
def test_two_commands_on_one_directory_are_refused_by_name_until_the_first_one_ends(
    store, command, folder: str, tmp_path, told
) -> None:
    with Processes(1) as other:
        other.submit(hold, store(tmp_path / folder)).result()
        said = told(*command, "--out", str(tmp_path))
        if store is Store:
            with pytest.raises(StoreError, match="another run works on"), Store(tmp_path / folder).steady():
                pass
    assert f"another run works on {tmp_path / folder}: wait until it ends, or give another directory with" in said
    with store(tmp_path / folder).locked():
        pass


def test_a_command_may_lock_a_directory_twice_and_an_export_removes_its_lock(tmp_path: Path) -> None:
    store = TaskStore(tmp_path)
    with store.locked(), store.locked():
        assert store.lock.exists()
    with store.locked():
        pass
    assert list(tmp_path.iterdir()) == []


def test_the_record_of_a_run_names_the_commit_and_whether_the_code_was_changed_since(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("study.run.provenance.ROOT", tmp_path)
    assert commit() == {"commit": "", "clean": False}
    write_text(tmp_path / "study" / "a.py", "")
    git = ["git", "-C", str(tmp_path), "-c", "user.name=a", "-c", "user.email=a@b"]
    for words in (["init", "-q"], ["add", "."], ["commit", "-qm", "first"]):
        subprocess.run([*git, *words], check=True)
    head = subprocess.run([*git, "rev-parse", "HEAD"], check=True, capture_output=True, text=True).stdout.strip()
    write_text(tmp_path / "results" / "rates.csv", "")
    assert commit() == {"commit": head, "clean": True}
    write_text(tmp_path / "study" / "a.py", "changed")
    assert commit() == {"commit": head, "clean": False}


@pytest.mark.parametrize(
    ("command", "said"),
    [
        *((command, RESUMED) for command in ("run", "bound ramp", "faults")),
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


ASLEEP = """
import sys, time
from study.run.executor import Processes
with Processes(2) as executor:
    job = executor.submit(time.sleep, 60)
    while not job.running():
        time.sleep(0.01)
    print("started", flush=True)
    job.result()
"""


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signal that a test could send")
@pytest.mark.parametrize("times", [1, 3])
@pytest.mark.parametrize("to_all", [True, False])
def test_ctrl_c_ends_all_processes_at_once_however_often_it_is_pressed(to_all: bool, times: int) -> None:
    command = [sys.executable, "-c", ASLEEP]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == b"started\n"
        for _ in range(times):
            with suppress(ProcessLookupError):
                (os.killpg if to_all else os.kill)(process.pid, signal.SIGINT)
            time.sleep(0.05)
        try:
            process.communicate(timeout=10)  # The pipes are open until the last worker has ended.
        finally:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
    assert process.returncode == -signal.SIGINT


@pytest.mark.parametrize("command", ["rates {} --expected 2", "figures --out {}", "compare {} {}", "bound {}"])
def test_an_empty_name_is_refused(command: str, tmp_path: Path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("", " "):
        with pytest.raises(SystemExit, match="2"):
            main([name if word == "{}" else word for word in command.split()])
        assert "got an empty text, expected a name" in capsys.readouterr().err
    assert [*tmp_path.iterdir()] == []


ESCAPES = "L2\x1bc\x9b1m\u202e"
"""A name that would clear a terminal, change its colour and turn the direction of the text."""


@pytest.mark.parametrize("output", [[], ["--json"], ["--values"], ["--columns", "none"]])
def test_names_of_columns_cannot_command_the_terminal(output: list[str], tmp_path: Path, capsys) -> None:
    (tmp_path / "t.csv").write_text(f"h,{ESCAPES}\n.4,.16\n.2,.04\n.1,.01\n", encoding="utf-8")
    main(["rates", str(tmp_path / "t.csv"), *output])
    printed = capsys.readouterr()
    main(["rates", str(tmp_path / ESCAPES)])
    assert r"\u001bc\u009b1m\u202e" in capsys.readouterr().err
    assert printed.out + printed.err == printable(printed.out + printed.err) != ""
    if output == ["--json"]:
        json.loads(printed.out)


def test_reports_with_control_characters_are_well_formed(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text(f"h,{ESCAPES}\n.4,.16\n.2,.04\n.1,.01\n", encoding="utf-8")
    files = {form: tmp_path / f"report.{form}" for form in ("junit", "markdown")}
    options = [word for form, file in files.items() for word in (f"--{form}", str(file))]
    main(["rates", str(tmp_path / "t.csv"), "--expected", "2", *options])
    files["checks"] = tmp_path / "checks.xml"
    write_junit(files["checks"], [row(Korn(), "order", "a", at_most(1.0), (0.5, (0.5, 0.5), FAILS), ESCAPES)])
    for form, file in files.items():
        text = file.read_text(encoding="utf-8")
        assert text == printable(text)
        assert r"L2\u001bc" in text
        if form != "markdown":
            ElementTree.parse(file)


def test_a_window_system_that_matplotlib_does_not_know_is_not_used(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("h,e\n.4,.16\n.2,.04\n.1,.01\n")
    words = [sys.executable, "-m", "study", "rates", str(tmp_path / "t.csv"), "--plot", str(tmp_path / "p.png")]
    subprocess.run(words, env=os.environ | {"MPLBACKEND": "nonsense"}, check=True, stdout=subprocess.DEVNULL)
    assert (tmp_path / "p.png").read_bytes().startswith(b"\x89PNG")


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


WORDS = [("error", "small"), ("error", "nan"), ("order", "steep"), ("error", "")]


@pytest.mark.parametrize(
    ("command", "column", "word"),
    [*(("check", *cell) for cell in WORDS), *((command, *WORDS[0]) for command in ("tables", "figures", "report"))],
)
def test_a_word_in_place_of_a_number_is_named_by_file_line_and_column(command, column, word, own: Path, told) -> None:
    path = own / "data" / "rates.csv"
    table = pd.read_csv(path, dtype=str, keep_default_na=False)
    table.loc[2, column] = word
    table.to_csv(path, index=False)
    said = told(command, "--out", str(own))
    assert f"{path}, line 4, column {column}: found {word!r}, expected a number" in said
    assert f"--levels 8 16 32 --out {own}`" in said


def test_a_plain_run_in_a_fresh_clone_leaves_the_committed_results_alone(tmp_path, told, monkeypatch) -> None:
    def measured(plan: Any, store: Any, *pools: Any) -> Any:
        raise UsageError(f"it would write in {store.directory}")

    write_text(tmp_path / "results" / "data" / "provenance.json", "{}")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("study.cli.run.measure", measured)
    monkeypatch.setattr("study.run.plan.Plan.check", lambda *_: None)
    assert told("run") == "study: it would write in results/quick\n"
    assert (tmp_path / "results" / "data" / "provenance.json").read_text() == "{}"


def test_no_more_processes_are_started_than_there_is_work(tmp_path, told, monkeypatch) -> None:
    started: list[int] = []

    def counted(jobs: int) -> Processes:
        started.append(jobs)
        raise UsageError("here they would start")

    monkeypatch.setattr("study.cli.run.Processes", counted)
    small = ["--case", "full-contact", "--levels", "2", "4", "8", "--out", str(tmp_path)]
    told("run", *small, "--jobs", "1024")
    told("run", *small, "--jobs", "2")
    assert 2 < started[0] < 40
    assert started[1] == 2


SLIVER = """
from manufactured import *
body = polygon([(0, 0), (3, 0), (3, 0.001), (0, 0.001)], [Kind.CONTACT, Kind.LOADED, Kind.LOADED, Kind.CLAMPED])
law = KelvinVoigt(isotropic(1, 1), isotropic(1, 1), "law")
mine = Data.formulas(body, law, f0=(0, 0))
"""


def test_what_would_take_for_ever_is_refused_at_once(tmp_path: Path, told) -> None:
    path = write_text(tmp_path / "sliver.py", SLIVER)
    assert "so thin that rounding errors hide" in told("bound", f"{path}:mine", "--out", str(tmp_path / "out"))
    out = ["--out", str(tmp_path / "out")]
    for command in (
        "run --case full-contact --step 1e-12",
        "bound ramp --steps 10000000",
        "export full-contact --mode march --steps 10000000",
    ):
        assert "time steps were asked for, but at most 1e+06 are allowed" in told(*command.split(), *out)
    for command in (
        "run --case full-contact --levels 8 16 99999",
        "bound ramp --levels 8 99999",
        f"certify {SQUARE} --family one-diagonal --levels 8 99999",
        "show full-contact --level 99999",
        "export full-contact --levels 99999",
    ):
        said = told(*command.split(), *out)
        assert re.search(r"99999 needs about \d+\.\d GiB of memory, .* are available; take coarser levels", said), said
    assert not (tmp_path / "out").exists()


WRITERS = ["run --case full-contact --levels 2 4 8", "faults --case full-contact", "seeds", "bound ramp --levels 2"]
WRITERS += ["show corner", "export corner --levels 4"]
NAMES = [*WRITERS, "tables", "figures", "report"]
FULL = "the disk is full ({}); free space there, or give a directory on another disk with --out"
READ_ONLY = "Read-only file system; give a directory you may write with --out"


@pytest.mark.parametrize(
    ("command", "code", "says"),
    [
        *(
            pytest.param(command, errno.ENOSPC, FULL.format(os.strerror(errno.ENOSPC)), marks=marks)
            for command in NAMES
            # The others start processes, solve or draw before they write as these do.
            for marks in [() if command.split()[0] in ("run", "export", "tables") else pytest.mark.slow]
        ),
        ("tables", errno.EDQUOT, FULL.format(os.strerror(errno.EDQUOT))),
        ("tables", errno.EROFS, READ_ONLY),
    ],
    ids=lambda value: str(value).split()[0],
)
def test_a_disk_that_cannot_be_written_is_named_by_every_command(
    command: str, code: int, says: str, request, tmp_path, told, monkeypatch
) -> None:
    def unwritable(*_: object) -> None:
        raise OSError(code, os.strerror(code))

    out = tmp_path / "out" if command in WRITERS else request.getfixturevalue("own")
    monkeypatch.setattr("os.replace", unwritable)
    said = told(*command.split(), "--out", str(out))
    assert "cannot write" in said
    assert says in said


def wrapped(part: Path) -> None:
    """As a library that meets a full disk again while it cleans up."""
    try:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    except OSError:
        raise ValueError("cannot close the archive") from None


def test_a_full_disk_behind_another_error_is_called_a_full_disk(tmp_path) -> None:
    with pytest.raises(StoreError, match="the disk is full"):
        write_whole(tmp_path / "file", wrapped)
    assert [*tmp_path.iterdir()] == []


@pytest.mark.parametrize(
    ("command", "code", "says"),
    [
        pytest.param("cases", 0, "full-contact", marks=pytest.mark.slow),  # compiles SymPy without docstrings
        pytest.param("rates examples/errors.csv", 0, "converges with order", marks=pytest.mark.slow),
        pytest.param("compare results results", 0, "identical", marks=pytest.mark.slow),
        ("check", 2, "study: python -OO removes docstrings, and pyamg, which this command needs, cannot be imported"),
    ],
)
def test_python_without_docstrings_runs_a_command_or_ends_with_a_sentence(command: str, code: int, says: str) -> None:
    study = [sys.executable, "-OO", "-m", "study", *command.split()]
    done = subprocess.run(study, cwd=Path(__file__).parents[2], capture_output=True, text=True, check=False)
    assert done.returncode == code
    assert says in done.stdout + done.stderr
    assert "Traceback" not in done.stderr


SHOWN = ["cases", "check --out results", "tables --out results", "report --out results", "compare results results"]
SHOWN += ["run --case {}/pocket.py:pocket --levels 8 16 32 --out results"]


@pytest.mark.slow
def test_what_is_printed_fits_80_columns_and_ends_with_a_summary(made: Path, tmp_path, capsys, monkeypatch) -> None:
    shutil.copytree(made / "results", tmp_path / "results", ignore=shutil.ignore_patterns("figures"))
    figures = sorted(path.relative_to(made) for path in (made / "results" / "figures").iterdir())
    monkeypatch.setattr("study.cli.common.draw_figures", lambda *arguments: figures)
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.chdir(tmp_path)
    printed = ""
    for shown in SHOWN:
        assert main(shown.format(made).split()) == 0
        printed = capsys.readouterr().out
        assert [line for line in printed.splitlines() if len(line) > 80] == []
    last = printed.strip().splitlines()
    counted = r"(\d+) hold, 0 fail, 0 undecided, 0 missed"
    concluded = r"no statement was contradicted, \1 checks confirmed their claims; observed orders .*\."
    assert re.search(rf"{counted}.* Conclusion: {concluded}$", " ".join(last))
    assert sum("written: " in line for line in last) == 1
    assert len(last) < 64, "a screen and the reported rows of the case"
