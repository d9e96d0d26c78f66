"""Results of other people's contact codes on the exact solutions: ``codes/errors.csv`` and ``codes/classes.csv``.

``make codes`` writes these files where the codes are installed. They are read like the data of a run, and a statement
is judged by them together with its own measurements (``OtherErrors``).
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from study.ledger.datafiles import TEXT, CsvFile, read_table, refuse_repeated, refuse_words

KEY = ["code", "version", "variant"]
SERIES = ["code", "variant", "case", "family"]
MESH = ["case", "family", "level"]
ERRORS = ["series", "level", "h", "error", "best", "discrete", "distance", "pressure", "best_pressure", "penetration"]
ERRORS += ["resultant", "tangential"]
CLASSES = ["series", *SERIES, "version", "class", "order_in_v", "order_of_distance", "order_of_pressure", "invariance"]
NOT_EXPRESSED = "not expressed"
GRADES = ("exact for P1", "consistent", "stagnates", "wrong", "undecided")
MADE = "make codes"
AGAIN = f"make it again with `{MADE}`"
FOLDER, MARCHES = "codes", "codes/march"
"""Folders of static problems and of marches in time."""
FROZEN, MARCH = "frozen", "march"


@dataclass(frozen=True)
class Codes:
    """One row of ``errors`` for each code, its parameters, case and mesh; of ``classes`` for each series of meshes.

    Rows are in the order of the files, in which ``errors`` has the number of its series.
    """

    errors: pd.DataFrame
    classes: pd.DataFrame

    @classmethod
    def read(cls, directory: Path, folder: str = FOLDER) -> Codes | None:
        """Return the data in a directory of results; None if there are none.

        Raises:
            DataError: a file is missing, lacks a column, has no number where one belongs, or has a row twice.
        """
        place = directory / folder
        if not place.is_dir():
            return None
        errors = _table(place / "errors.csv", ERRORS, ["series", "level"])
        classes = _table(place / "classes.csv", CLASSES, ["series"], empty=True)
        refuse_repeated(place / "classes.csv", classes, SERIES, AGAIN)
        # Rows of an unknown series stay, with empty names.
        return cls(errors.merge(classes[["series", *SERIES]], on="series", how="left"), classes)

    def series(self) -> pd.DataFrame:
        """Return one row for each code, parameters, case and family: its class, and quotients on the finest mesh.

        ``share``: distance from the solution in K^h over the discretisation error. ``excess``: error of the pressure
        over the error of the pressure of the solution in K^h.
        """
        finest = self.errors.sort_values("level").groupby(SERIES, sort=False).tail(1)
        judged = self.classes[self.classes["class"] != NOT_EXPRESSED]
        found = judged.merge(finest, on=["series", *SERIES], validate="one_to_one")
        share, excess = found["distance"] / found["best"], found["pressure"] / found["best_pressure"]
        return found.assign(share=share, excess=excess).replace([np.inf, -np.inf], np.nan)

    def rows(self) -> pd.DataFrame:
        """Return one row for each code with its parameters: the classes of its series, and the worst quotients.

        Columns: the key, ``classes`` as text, ``order_low``, ``order_high`` in V, the largest ``share``, ``excess`` and
        ``invariance``.
        """
        found = []
        for key, mine in self.series().groupby(KEY, sort=False):
            counts = mine["class"].value_counts()
            text = ", ".join(f"{grade} ({counts[grade]})" for grade in GRADES if grade in counts)
            worst = mine[["share", "excess", "invariance"]].max().to_dict()
            orders = {"order_low": mine["order_in_v"].min(), "order_high": mine["order_in_v"].max()}
            found.append(dict(zip(KEY, key, strict=True)) | {"classes": text} | orders | worst)
        return pd.DataFrame(found)

    def on_meshes(self) -> pd.DataFrame:
        """Return ``errors`` with version and class, and a row of NaN for each mesh that a code cannot express."""
        told = self.classes[[*SERIES, "version", "class"]]
        meshes = self.errors[MESH].drop_duplicates()
        left_out = told[told["class"] == NOT_EXPRESSED].merge(meshes, on=MESH[:2])
        return pd.concat([self.errors.merge(told, on=SERIES, how="left"), left_out], ignore_index=True)


@dataclass(frozen=True)
class OtherErrors(CsvFile):
    """Errors of other codes as a file that a statement is compared with."""

    label: str = ""

    def read(self, directory: Path) -> pd.DataFrame:
        """Return ``Codes.on_meshes`` with the mode and the label of the statement; an empty table without such data."""
        there = {FROZEN: Codes.read(directory, FOLDER), MARCH: Codes.read(directory, MARCHES)}
        found = [codes.on_meshes().assign(mode=mode, label=self.label) for mode, codes in there.items() if codes]
        return pd.concat(found, ignore_index=True)[[*self.columns]] if found else pd.DataFrame(columns=[*self.columns])


def _table(path: Path, columns: list[str], key: list[str], empty: bool = False) -> pd.DataFrame:
    found = read_table(path, columns, MADE)
    refuse_words(path, found, [name for name in columns if name not in TEXT], AGAIN, empty=empty)
    refuse_repeated(path, found, key, AGAIN)
    return found
