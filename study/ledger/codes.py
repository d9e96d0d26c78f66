"""What other people's contact codes did on the exact solutions: ``codes/errors.csv`` and ``codes/classes.csv``."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from study.ledger.datafiles import DataError

KEY = ["code", "version", "variant"]
SERIES = ["code", "variant", "case", "family"]
ERRORS = [*SERIES, "level", "h", "error", "best", "distance", "pressure", "best_pressure"]
CLASSES = [*SERIES, "version", "class", "order_in_v", "order_of_distance", "invariance"]
NOT_EXPRESSED = "not expressed"
GRADES = ("exact for P1", "consistent", "stagnates", "wrong", "undecided")


@dataclass(frozen=True)
class Codes:
    """One row of ``errors`` for each code, its parameters, case and mesh; of ``classes`` for each series of meshes."""

    errors: pd.DataFrame
    classes: pd.DataFrame

    @classmethod
    def read(cls, directory: Path) -> Codes | None:
        """The data of a directory of results, None where there are none.

        Raises:
            DataError: a file lacks a column.
        """
        place = directory / "codes"
        if not place.is_dir():
            return None
        return cls(_table(place / "errors.csv", ERRORS), _table(place / "classes.csv", CLASSES))

    def series(self) -> pd.DataFrame:
        """One row for each code, parameters, case and family: its class, and what is left on the finest mesh.

        ``share``: distance from the solution in K^h over the discretisation error. ``excess``: error of the pressure
        over that of K^h.
        """
        finest = self.errors.sort_values("level").groupby(SERIES, sort=False).tail(1)
        judged = self.classes[self.classes["class"] != NOT_EXPRESSED]
        found = judged.merge(finest, on=SERIES, validate="one_to_one")
        share, excess = found["distance"] / found["best"], found["pressure"] / found["best_pressure"]
        return found.assign(share=share, excess=excess).replace([np.inf, -np.inf], np.nan)

    def rows(self) -> pd.DataFrame:
        """One row for each code with its parameters: what classes it got on how many series, and the worst of each.

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


def _table(path: Path, columns: list[str]) -> pd.DataFrame:
    text = dict.fromkeys([*KEY, "case", "family", "class"], str)
    try:
        found = pd.read_csv(path, dtype=text)
    except (OSError, pd.errors.EmptyDataError, pd.errors.ParserError) as error:
        raise DataError(f"{path} cannot be read ({error}): make it with `make codes`") from error
    if lacking := [column for column in columns if column not in found]:
        raise DataError(f"{path} lacks the columns {', '.join(lacking)}: make it again with `make codes`")
    return found
