"""A small finished run, which most commands start from."""

from __future__ import annotations

import fcntl
import os
import re
import shutil
from pathlib import Path

import pytest

from study.cli import run
from study.cli.main import main
from study.present.figures import drawings

TUTORIAL = Path(__file__).parents[2] / "docs" / "tutorials" / "own-case.md"


@pytest.fixture(scope="session")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A directory with a small run of the case in the tutorial, as a newcomer would make it.

    ``pocket.py`` is the file of the case, ``results`` the directory of the run.
    """
    directory: Path = tmp_path_factory.mktemp("user")
    base = tmp_path_factory.getbasetemp()
    # The run takes half a minute: of the processes of pytest-xdist one makes it, and each gets a copy.
    shared = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "one-run"
    shared.mkdir(exist_ok=True)
    with (shared / ".lock").open("a") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (shared / "finished").exists():
            run_tutorial(shared)
            (shared / "finished").touch()
    for name in ("pocket.py", "results"):
        copy = shutil.copytree if (shared / name).is_dir() else shutil.copy2
        copy(shared / name, directory / name)
    return directory


def run_tutorial(directory: Path) -> None:
    code = re.findall(r":caption: pocket.py\n\n(.*?)```", TUTORIAL.read_text(encoding="utf-8"), re.DOTALL)[0]
    assert len(code.splitlines()) < 25
    (directory / "pocket.py").write_text(code, encoding="utf-8")
    command = ["run", "--case", f"{directory}/pocket.py:pocket", "--levels", "8", "16", "32"]
    with pytest.MonkeyPatch.context() as patch:
        # Drawing all figures takes most of the time, and tests/present draws them.
        patch.setattr(run, "drawings", lambda directory: drawings(directory)[:2])
        assert main([*command, "--out", str(directory / "results")]) == 0
