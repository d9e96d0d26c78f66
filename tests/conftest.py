"""Shared by all tests."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings
from threadpoolctl import threadpool_limits

# Machines differ in speed: a deadline would test the machine, not the mathematics.
settings.register_profile("study", deadline=None, max_examples=25, derandomize=True)
settings.load_profile("study")

# Formulas of tests stay in the clone, for the next run; `make clean` removes them.
os.environ["SIGNORINI_CACHE"] = str(Path(__file__).parents[1] / "build" / "formulas")

# What is printed is laid out for the terminal that the tests are watched in.
os.environ["COLUMNS"] = "110"


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """A process gets whole files, so that what they share is made once, and takes tests from others when it has none.

    Without pytest-xdist nobody asks.
    """
    from xdist.scheduler import WorkStealingScheduling

    return WorkStealingScheduling(config, log)


@pytest.fixture(autouse=True, scope="session")
def one_thread() -> Iterator[None]:
    """Tests run in parallel: the processes share the cores already."""
    with threadpool_limits(1):
        yield
