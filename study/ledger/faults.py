"""The matrix fault × case × check of ``faults.csv``: its summary, and the rules that it must satisfy."""

import pandas as pd

INVISIBLE = 1e-6
"""A fault is invisible in a case if it changes the discrete solution by less than this fraction of the error."""


def summary(matrix: pd.DataFrame) -> pd.DataFrame:
    """Return for each fault and size in how many cases it occurs, is noticed, and is invisible.

    Parameters:
        matrix: the table ``faults.csv``.
    """
    by_error = matrix["by_error"] != ""
    rows = matrix.assign(
        errors=by_error,
        any_check=by_error | (matrix["by_others"] != ""),
        invisible=matrix["distance"] < INVISIBLE * matrix["error"],
    )
    grouped = rows.groupby(["equation", "fault", "size"], sort=False)
    counts = grouped[["errors", "any_check", "invisible"]].sum()
    return counts.assign(cases=grouped.size()).reset_index()


def missed(matrix: pd.DataFrame) -> dict[str, str]:
    """Return the faults that are not noticed as the rules demand: name ↦ where, "in the plane" or "in space" or both.

    At its smallest size, every fault must be noticed by the order or the size of the error in two plane cases, and in
    one case in space if it can occur there. A fault at single vertices must be noticed by any check in two cases.

    Parameters:
        matrix: the table ``faults.csv``.
    """
    lacking = {}
    for fault, rows in matrix.groupby("fault", sort=False):
        smallest = rows[rows["size"].abs() == rows["size"].abs().min()]
        noticed = smallest["by_error"] != ""
        if smallest["single"].all():
            noticed |= smallest["by_others"] != ""
        plane, solid = smallest["dim"] == 2, smallest["dim"] == 3
        places = {
            "in the plane": (noticed & plane).sum() < min(2, plane.sum()),
            "in space": solid.any() and not (noticed & solid).any(),
        }
        if any(places.values()):
            lacking[str(fault)] = " and ".join(place for place, lacks in places.items() if lacks)
    return lacking


def in_words(lacking: dict[str, str]) -> str:
    """Return the result of ``missed`` as a text."""
    return "; ".join(f"{fault}, {where}" for fault, where in lacking.items()) or "none"
