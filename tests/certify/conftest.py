"""The problems of the examples, and a small certificate of one of them."""

from __future__ import annotations

import copy
import importlib.util
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from manufactured import Data
from study.bound.trajectory import Refined
from study.certify import certified, checker
from study.certify.certified import Making
from study.fem.mesh import OneDiagonal
from study.solve.tableau import MIDPOINT

PROBLEMS = Path(__file__).parents[2] / "examples" / "certificates" / "problems.py"


@pytest.fixture(scope="session")
def problem() -> Callable[[str], Data]:
    spec = importlib.util.spec_from_file_location("problems", PROBLEMS)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    made: dict[str, Data] = {}
    return lambda name: made.setdefault(name, getattr(module, name)())


@pytest.fixture(scope="session", autouse=True)
def constants_of_a_coarse_mesh() -> Iterator[None]:
    """The semidefinite programme is most of what a small certificate costs."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(certified, "CONSTANTS_LEVEL", 3)
        yield


@pytest.fixture(scope="session")
def made(problem: Callable[[str], Data], constants_of_a_coarse_mesh: None) -> Any:
    return Making(problem("square"), OneDiagonal(), MIDPOINT, Refined(0, 1)).certificate(2, 2)


@pytest.fixture
def certificate(made: Any) -> Any:
    """The square on eight cells in two steps, to be changed at will."""
    return copy.deepcopy(made)


@pytest.fixture(scope="session")
def plain(made: Any) -> checker.Found:
    """What it proves."""
    return checker.verified(made)
