"""The committed record of seeds, and its table, which takes seconds to count; tests only read them."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from study.controls.alarms import tally
from study.controls.record import Record


@pytest.fixture(scope="session")
def committed() -> Record:
    return Record.read(Path(__file__).parents[2] / "results")


@pytest.fixture(scope="session")
def counted(committed: Record) -> pd.DataFrame:
    return tally(committed)
