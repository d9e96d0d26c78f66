"""A small finished run, which most commands start from."""

import os
import re
import shutil
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import pytest
from commands import study
from filelock import FileLock
from places import ROOT

from study.cli import check, present, run
from study.fem.naming import resolve
from study.ledger.files import write_text
from study.present.figures import drawings
from study.run.executor import GIB, Pool
from study.statements.shared.scope import Scope

TUTORIAL = ROOT / "docs/tutorials/own-case.md"
FAMILIES_OF = Scope.families_of


def two_families(scope, case):
    """Return the regular and the shaken meshes; all families of a case that has none of them."""
    families = FAMILIES_OF(scope, case)
    return [family for family in families if family.name in ("one-diagonal", "shaken")] or families


@contextmanager
def in_this_process(workers):
    """Takes the place of worker processes, which would import and compile all again; ``tests/run`` tests those."""
    with ThreadPoolExecutor(1) as executor:
        yield Pool([executor], 64 * GIB, 64 * GIB)


def shorten(patch):
    """Leave out of runs two mesh families."""
    for module in (run, check):
        patch.setattr(module, "local_pool", in_this_process)
    patch.setattr(present, "Processes", lambda workers: ThreadPoolExecutor(1))
    patch.setattr(Scope, "families_of", two_families)


@pytest.fixture(autouse=True)
def shortened(monkeypatch):
    shorten(monkeypatch)


def run_tutorial(directory):
    """Write the case of the tutorial into ``pocket.py`` and run it into ``results``, as a newcomer would."""
    directory.mkdir()
    code = re.findall(r":caption: pocket.py\n\n(.*?)```", TUTORIAL.read_text(encoding="utf-8"), re.DOTALL)[0]
    assert len(code.splitlines()) < 25
    (directory / "pocket.py").write_text(code, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        shorten(patch)
        # Drawing all figures takes most of the time, and tests/present draws them.
        patch.setattr(present, "drawings", lambda directory: drawings(directory)[:1])
        case = f"{directory}/pocket.py:pocket"
        assert study(f"run --case {case} --levels 8 16 32 --figures --out {directory}/results") == 0


@pytest.fixture(scope="session")
def made(tmp_path_factory):
    """A directory with ``pocket.py``, the case of the tutorial, and ``results``, a small run of that case.

    Of the processes of pytest-xdist the first makes the run, and each gets a copy of its own.
    """
    directory = tmp_path_factory.getbasetemp() / "tutorial"
    if "PYTEST_XDIST_WORKER" not in os.environ:
        run_tutorial(directory)
        return directory
    shared = directory.parents[1] / "tutorial"
    with FileLock(shared.with_suffix(".lock")):
        if not shared.exists():
            run_tutorial(directory)
            shutil.copytree(directory, shared)
            return directory
    return Path(shutil.copytree(shared, directory))


@pytest.fixture
def own(made, tmp_path):
    """The results of a copy of the small run, next to the file of its case; a test may edit both."""
    shutil.copytree(made, tmp_path, dirs_exist_ok=True, ignore=shutil.ignore_patterns("jobs", "figures"))
    resolve.cache_clear()
    return tmp_path / "results"


@pytest.fixture
def refusal_of_case(refused, tmp_path):
    """Runs the case ``mine`` of a file, which must be refused before anything is written; returns what is said."""

    def run(code):
        resolve.cache_clear()
        path = write_text(tmp_path / "mine.py", code)
        return refused(f"run --case {path}:mine --levels 8 16 32")

    return run
