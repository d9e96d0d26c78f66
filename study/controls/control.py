"""One deliberate defect: what is wrong, where, and which row of the ledger must fail."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic

from study.controls.baselines import Baseline, S


@dataclass(frozen=True)
class Control(Generic[S]):
    """One deliberate defect.

    Attributes:
        name: of the defect.
        what: is wrong, in a line.
        setting: where it is measured.
        defect: turns what would be measured there into what is measured.
        caught_by: the key of the row that must fail, or of several rows that all must fail.
    """

    name: str
    what: str
    setting: Baseline[S]
    defect: Callable[[S], S]
    caught_by: str | tuple[str, ...]

    @property
    def rows(self) -> tuple[str, ...]:
        """The keys of the rows that must fail."""
        return (self.caught_by,) if isinstance(self.caught_by, str) else self.caught_by
