"""The problems of the examples, and a small certificate of one of them.

``square-2.json.gz`` was written by ``study certify examples/certificates/problems.py:square --levels 2 --steps 2
--refine 0 --shorter 1 --family one-diagonal``, with the constants of a mesh of level 3. Tests of the checker read it
from the file, so that they do not depend on the program that makes certificates.
"""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import pytest

from study.certify import checker


@pytest.fixture(scope="session")
def made() -> Any:
    return checker.load(Path(__file__).parent / "square-2.json.gz")


@pytest.fixture
def certificate(made: Any) -> Any:
    """The square on eight cells in two steps, to be changed at will."""
    return copy.deepcopy(made)


@pytest.fixture(scope="session")
def plain(made: Any) -> checker.Enclosure:
    """What it proves."""
    return checker.verified(made)


@pytest.fixture(scope="session")
def computed_bounds() -> dict[str, float]:
    """What ``study bound`` computes for the problem, mesh and steps of the small certificate, to six digits.

    A test of ``study certify`` computes these numbers again; tests of the checker compare with them in no time.
    """
    return {"low": 0.003926112, "high": 0.275508060, "last": 0.138330852}
