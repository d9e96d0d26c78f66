"""What a numbered statement needs to stand in the ledger: where it is measured, what is measured, and when it holds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import pandas as pd

from study.ledger.verdict import Verdict


@dataclass(frozen=True, order=True)
class Setting:
    """One measurement: a case of the catalogue on one mesh.

    Attributes:
        case: name in the catalogue.
        family: name of the mesh family.
        level: n.
    """

    case: str
    family: str
    level: int


class Statement(Protocol):
    """A numbered statement of the source, or a question beyond it.

    ``label`` is its number, ``claim`` what it says in words. ``settings(full)`` lists where it is
    measured in the quick or the full study; ``measure`` gives named numbers for one of them, the
    mesh size among them as ``h``; ``judge`` turns the rows of all settings, a table with the columns
    case, family, level, h, quantity and value, into rows of the ledger, and solves nothing.
    """

    @property
    def label(self) -> str: ...
    @property
    def claim(self) -> str: ...

    def settings(self, full: bool) -> list[Setting]: ...
    def measure(self, setting: Setting) -> dict[str, float]: ...
    def judge(self, rows: pd.DataFrame) -> list[Verdict]: ...
