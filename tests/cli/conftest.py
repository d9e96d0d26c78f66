"""A small finished run, which most commands start from."""

from __future__ import annotations

import re
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
    code = re.findall(r":caption: pocket.py\n\n(.*?)```", TUTORIAL.read_text(encoding="utf-8"), re.DOTALL)[0]
    assert len(code.splitlines()) < 25
    (directory / "pocket.py").write_text(code, encoding="utf-8")
    command = ["run", "--case", f"{directory}/pocket.py:pocket", "--levels", "8", "16", "32"]
    with pytest.MonkeyPatch.context() as patch:
        # Drawing all figures takes most of the time, and tests/present draws them.
        patch.setattr(run, "drawings", lambda directory: drawings(directory)[:2])
        assert main([*command, "--out", str(directory / "results")]) == 0
    return directory
