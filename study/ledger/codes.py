"""Errors of contact codes by other people on problems with known exact solutions: ``errors.csv`` and ``classes.csv``.

``make codes`` runs the codes that are installed and writes the two files into the folders ``FOLDER`` and ``MARCHES`` of
a result directory. The statement ``OtherCodes`` compares the errors in these files with errors that this study
measures.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, nan
from pathlib import Path

import pandas as pd
from pandas import DataFrame, Series

from study.ledger.datafiles import CsvFile, DataError, line, read_checked, refuse_repeated

KEY = ["code", "version", "variant"]
CODE_SERIES = ["code", "variant", "case", "family"]
MESH_KEY = ["case", "family", "level"]
NOT_EXPRESSED = "not expressed"
GRADES = ("exact for P1", "consistent", "stagnates", "wrong", "undecided")
MADE = "make codes"
AGAIN = f"make it again with `{MADE}`"
FOLDER = "codes"
MARCHES = "codes/march"
"""Folders of a result directory with the results on static problems, and on problems in time."""
FROZEN = "frozen"
MARCH = "march"


@dataclass(frozen=True)
class Codes:
    """The results of all contact codes by other people.

    A *series* is one code with fixed parameters (``variant``) on the meshes of one case and mesh family.

    Attributes:
        errors: one row for each series and mesh, in the order of the file, with the names that identify the series.
        classes: one row for each series: how well the code solves the problem (one of ``GRADES``), and observed orders.
    """

    errors: DataFrame
    classes: DataFrame

    @classmethod
    def read(cls, directory: Path, folder: str = FOLDER) -> Codes | None:
        """Return the results in a folder of a result directory; None if there is no such folder.

        Raises:
            DataError: a file is missing, lacks a column, has text in a column of numbers, or repeats a row.
        """
        place = directory / folder
        if not place.is_dir():
            return None
        errors, classes = (read_checked(place / name, f"codes/{name}", MADE) for name in ("errors.csv", "classes.csv"))
        refuse_repeated(place / "classes.csv", classes, CODE_SERIES, AGAIN)
        if (unknown := ~errors.series.isin(classes.series)).any():
            row = unknown.argmax()
            where = f"{place / 'errors.csv'}, line {line(row)}, column series"
            found = f"found {errors.series.iloc[row]}, expected a series of classes.csv"
            raise DataError(f"{where}: {found}; {AGAIN}")
        return cls(errors.merge(classes[["series", *CODE_SERIES]], on="series"), classes)

    def series(self) -> DataFrame:
        """Return one row for each series that its code can compute: its class, and two quotients on the finest mesh.

        A series is one code with fixed parameters on the meshes of one case and mesh family. Series whose problem the
        code cannot represent (class NOT_EXPRESSED) are left out.

        The columns of the quotients are:

        * ``share``: the distance of the code's displacement from the finite-element solution with exact contact
          constraints, divided by the error of this solution.
        * ``excess``: the error of the code's contact pressure, divided by the error of the pressure of this solution.
        """
        finest = self.errors.sort_values("level", kind="stable").groupby(CODE_SERIES, sort=False).tail(1)
        judged = self.classes[self.classes["class"] != NOT_EXPRESSED]
        finest_rows = judged.merge(finest, on=["series", *CODE_SERIES], validate="one_to_one")
        share = finest_rows.distance / finest_rows.best
        excess = finest_rows.pressure / finest_rows.best_pressure
        return finest_rows.assign(share=share, excess=excess).replace([inf, -inf], nan)

    def rows(self) -> DataFrame:
        """Return a table with one row for each code with fixed parameters, over all cases and mesh families.

        Its columns are ``KEY``; ``classes``, the number of series in each class as text; ``order_low`` and
        ``order_high``, the smallest and the largest observed order of the displacement in the energy norm; and the
        largest ``share``, ``excess`` (see ``series``) and ``invariance`` (change of the result if all loads are
        scaled).
        """
        rows = (
            self.series()
            .groupby(KEY, sort=False)
            .agg(
                classes=("class", _counted_grades),
                order_low=("order_in_v", "min"),
                order_high=("order_in_v", "max"),
                share=("share", "max"),
                excess=("excess", "max"),
                invariance=("invariance", "max"),
            )
        )
        return rows.reset_index()


def _counted_grades(classes: Series) -> str:
    counts = classes.value_counts()
    return ", ".join(f"{grade} ({counts[grade]})" for grade in GRADES if grade in counts)


@dataclass(frozen=True)
class OtherErrors(CsvFile):
    """Where a statement finds the errors of other codes, which it compares with errors that it measures itself.

    ``read`` returns them as one table, as for any ``CsvFile``.

    Attributes:
        label: label of the statement. It fills the column ``label``, a part of the key by which the rows are joined
            with the rows that the statement measures.
    """

    label: str = ""
    key = ("label", *MESH_KEY)
    columns = ["label", *MESH_KEY, "mode", "code", "version", "variant", "class", "error", "distance"]

    def read(self, directory: Path) -> DataFrame:
        """Return the errors of all codes in one table with the columns ``mode`` and ``label``; empty without data.

        The column ``mode`` is FROZEN for static problems and MARCH for problems in time. If a code cannot represent a
        problem, it has a row of NaN for each mesh on which other codes were run.
        """
        found = []
        for mode, folder in ((FROZEN, FOLDER), (MARCH, MARCHES)):
            if codes := Codes.read(directory, folder):
                told = codes.classes[[*CODE_SERIES, "version", "class"]]
                meshes = codes.errors[MESH_KEY].drop_duplicates()
                left_out = told[told["class"] == NOT_EXPRESSED].merge(meshes, on=MESH_KEY[:2])
                both = pd.concat([codes.errors.merge(told, on=CODE_SERIES, how="left"), left_out], ignore_index=True)
                found.append(both.assign(mode=mode, label=self.label))
        return pd.concat(found, ignore_index=True)[self.columns] if found else DataFrame(columns=self.columns)
