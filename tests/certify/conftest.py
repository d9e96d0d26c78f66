"""The problems of the examples, and a small certificate of one of them.

``square-2.json.gz`` was written by ``study certify examples/certificates/problems.py:square --levels 2 --steps 2
--refine 0 --shorter 1 --family one-diagonal``, with the constants of a mesh of level 3. Tests of the checker read it
from the file, so that they do not depend on the program that makes certificates.
"""

import copy
from pathlib import Path

import pytest

from study.certify import checker


@pytest.fixture(scope="session")
def made():
    return checker.load(Path(__file__).parent / "square-2.json.gz")


@pytest.fixture
def certificate(made):
    """The square on eight cells in two steps, to be changed at will."""
    return copy.deepcopy(made)


@pytest.fixture(scope="session")
def plain(made):
    return checker.verified(made)
