"""The data of a full run, from which the tables and numbers of papers, README and documentation are made."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pandas as pd

from study.ledger.codes import MARCHES, Codes
from study.ledger.datafiles import DataError, read_claims, read_csv, read_rates
from study.ledger.seeds import FalseAlarms, SeedRecord

NAMED_CASES = {"advance-recede", "natural-front", "rough-trace", "moving-rough", "cube-disc"}
"""The cases that the papers name. If a run lacks one of them, the papers are not made from it."""


class FullRun:
    """The contents of the data files of a full run; ``cases`` is indexed by the names of the cases.

    ``codes`` has the results of other people's contact codes, and ``marches`` their results if they use the midpoint
    rule in time; both are None if their files are missing. ``faults`` is the matrix of deliberate faults.
    ``alarms`` has the false-alarm rate on random meshes.

    Parameters:
        directory: the result directory.
        provenance, cases: the contents of ``provenance.json`` and of ``cases.csv``.

    Raises:
        DataError: a file is missing or lacks a column.
    """

    def __init__(self, directory: Path, provenance: dict[str, Any], cases: pd.DataFrame) -> None:
        self.rates = read_rates(directory)
        self.claims = read_claims(directory)
        self.cases = cases.set_index("case", drop=False).rename_axis(None)
        self.bounds = read_csv(directory, "bounds.csv")
        self.equivalence = read_csv(directory, "equivalence.csv")
        self.faults = read_csv(directory, "faults.csv")
        self.alarms = FalseAlarms(SeedRecord.read(directory))
        self.provenance = provenance
        self.codes = Codes.read(directory)
        self.marches = Codes.read(directory, MARCHES)

    @classmethod
    def read(cls, directory: Path) -> FullRun | None:
        """Return the data of a result directory; None if it has no full run with deliberate faults and random meshes.

        Raises:
            DataError: a file is missing or lacks a column.
        """
        needed = [directory / "data" / name for name in ("provenance.json", "faults.csv", "seeds.csv")]
        if not all(path.is_file() for path in needed):
            return None
        made = json.loads(needed[0].read_text(encoding="utf-8"))
        cases = read_csv(directory, "cases.csv")
        is_full = made.get("plan") == "full" and set(cases["case"]) >= NAMED_CASES
        return cls(directory, made, cases) if is_full else None

    def rows(self, label: str, key: str, case: str | None = None) -> pd.DataFrame:
        """Return the rows of the ledger with a label and a key, of all cases or of one case.

        Raises:
            DataError: there are no such rows.
        """
        chosen = self.claims[(self.claims["label"] == label) & (self.claims["key"] == key)]
        chosen = chosen if case is None else chosen[chosen["case"] == case]
        if chosen.empty:
            raise DataError(
                f"claims.csv has no row {label}, {key}, {case or 'any case'}: make it with `study run --full`"
            )
        return chosen
