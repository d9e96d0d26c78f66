"""Shared by all tests."""

import gc
import os

import numpy as np
import pytest
from commands import study
from hypothesis import settings
from threadpoolctl import threadpool_limits

# Machines differ in speed: a deadline would test the machine, not the mathematics.
settings.register_profile("study", deadline=None, max_examples=12, derandomize=True)
# The nightly job sets HYPOTHESIS_PROFILE=nightly: more examples, and others each night.
settings.register_profile("nightly", deadline=None, max_examples=200)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "study"))

# What is printed is laid out for the terminal that the tests are watched in.
os.environ["COLUMNS"] = "110"


# What is imported, and made for parameters, stays to the end of a session. Searching all of it for cyclic garbage again
# and again takes a tenth of the time and finds nothing; what tests leave is looked for less often than by default.
gc.disable()


def pytest_collection_finish():
    """From here on tests run."""
    gc.freeze()
    gc.set_threshold(200_000, 20, 50)
    gc.enable()


def pytest_make_parametrize_id(val):
    """Parameters with a name, a key or a label are known by it."""
    for attribute in ("key", "name", "label"):
        if isinstance(known := getattr(val, attribute, None), str):
            return known
    return None


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """A process gets whole files, so that what they share is made once, and takes tests from others when it has none.

    Without pytest-xdist nobody asks.
    """
    from xdist.scheduler import WorkStealingScheduling

    return WorkStealingScheduling(config, log)


@pytest.fixture(autouse=True, scope="session")
def one_thread():
    """Tests run in parallel: the processes share the cores already."""
    with threadpool_limits(1):
        yield


@pytest.fixture
def rng():
    """Random numbers, which are the same for every test and in every run."""
    return np.random.default_rng(0)


@pytest.fixture
def out(tmp_path):
    """A directory that is not there."""
    return tmp_path / "out"


@pytest.fixture
def told(capsys):
    """Runs a command that must end with an exit code, 2 unless told otherwise; returns all that it printed."""

    def run(line, code=2):
        capsys.readouterr()
        assert study(line) == code
        printed = capsys.readouterr()
        assert "Traceback" not in printed.err
        return printed.out + printed.err

    return run


@pytest.fixture
def refused(told, out):
    """Runs a command that must be refused before anything is written; returns what it says."""

    def run(line):
        said = told(f"{line} --out {out}")
        assert not out.exists()
        return said

    return run
