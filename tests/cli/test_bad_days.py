"""Every command with input, data, disks and terminals that are not as one would wish: exit code and message."""

from __future__ import annotations

import errno
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pandas as pd
import pytest

from study.cli.main import WITHOUT_PYAMG, main
from study.cli.options import FAMILIES, SCHEMES
from study.ledger.files import StoreError, UsageError, write_text, write_whole
from study.run.executor import Processes

SQUARE = f"{Path(__file__).parents[2]}/examples/certificates/problems.py:square"


WORDS = [("error", "small"), ("error", "nan"), ("order", "steep"), ("error", "")]


@pytest.mark.parametrize(
    ("command", "column", "word"),
    [*(("check", *cell) for cell in WORDS), *((command, *WORDS[0]) for command in ("tables", "figures", "report"))],
)
def test_a_word_in_place_of_a_number_is_named_by_file_line_and_column(command, column, word, own: Path, told) -> None:
    path = spoil(own, column, word)
    said = told(command, "--out", str(own))
    assert f"{path}, line 4, column {column}: found {word!r}, expected a number" in said
    assert f"--levels 8 16 32 --out {own}`" in said


@pytest.mark.parametrize(
    ("word", "code", "said"), [("small", 2, "has 'small' as error, expected a number, in line 4"), ("nan", 1, "")]
)
def test_runs_are_compared_if_a_number_is_missing_but_not_if_it_is_a_word(word, code, said, made, own, told) -> None:
    spoil(own, "error", word)
    assert said in told("compare", str(made / "results"), str(own), code=code)


def spoil(directory: Path, column: str, word: str) -> Path:
    path = directory / "data" / "rates.csv"
    table = pd.read_csv(path, dtype=str, keep_default_na=False)
    table.loc[2, column] = word
    table.to_csv(path, index=False)
    return path


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
    told("run", *small, "--jobs", "9999")
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


WRITERS = ["run --case full-contact --levels 2 4 8", "controls", "seeds", "sensitivity", "bound ramp --levels 2"]
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


def failed(part: Path) -> None:
    """As a program that does not say why it failed."""
    raise subprocess.CalledProcessError(1, "ffmpeg")


def test_a_full_disk_behind_another_error_is_called_a_full_disk(tmp_path, monkeypatch) -> None:
    with pytest.raises(StoreError, match="the disk is full"):
        write_whole(tmp_path / "file", wrapped)
    with pytest.raises(subprocess.CalledProcessError):
        write_whole(tmp_path / "file", failed)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: SimpleNamespace(free=0))
    with pytest.raises(StoreError, match="the disk is full"):
        write_whole(tmp_path / "file", failed)
    assert [*tmp_path.iterdir()] == []


@pytest.mark.parametrize(
    ("command", "code", "says"),
    [
        pytest.param("cases", 0, "full-contact", marks=pytest.mark.slow),  # compiles SymPy without docstrings
        pytest.param("rates examples/errors.csv", 0, "converges with order", marks=pytest.mark.slow),
        ("check", 2, "study: python -OO removes docstrings, and pyamg, which this command needs, cannot be imported"),
    ],
)
def test_python_without_docstrings_runs_a_command_or_ends_with_a_sentence(command: str, code: int, says: str) -> None:
    study = [sys.executable, "-OO", "-m", "study", *command.split()]
    done = subprocess.run(study, cwd=Path(__file__).parents[2], capture_output=True, text=True, check=False)
    assert done.returncode == code
    assert says in done.stdout + done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.slow
def test_commands_that_python_without_docstrings_runs_do_not_import_pyamg() -> None:
    code = f"import sys, {', '.join(f'study.cli.{name}' for name in WITHOUT_PYAMG)}; print('pyamg' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


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


def test_help_names_schemes_and_families_in_80_columns_within_the_third_of_a_second() -> None:
    printed, seconds = "", []
    for _ in range(3):
        before = os.times()
        command = [sys.executable, "-m", "study", "--help"]
        done = subprocess.run(command, capture_output=True, text=True, check=True, env={**os.environ, "COLUMNS": "80"})
        after, printed = os.times(), done.stdout
        seconds.append(sum(after[2:4]) - sum(before[2:4]))
    # Of its processor: others may have the machine meanwhile.
    assert min(seconds) < 0.3
    words = set(printed.replace(",", " ").replace(".", " ").split())
    assert {*SCHEMES, *FAMILIES} <= words
    assert max(map(len, printed.splitlines())) <= 80
