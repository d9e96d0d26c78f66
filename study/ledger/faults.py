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


def missed(matrix: pd.DataFrame) -> list[str]:
    """Return the faults that are not noticed as the rules demand.

    At its smallest size, every fault must be noticed by the order or the size of the error in two plane cases, and in
    one case in space if it can occur there. A fault at single vertices must be noticed by any check in two cases.

    Parameters:
        matrix: the table ``faults.csv``.
    """
    lacking = []
    for fault, rows in matrix.groupby("fault", sort=False):
        smallest = rows[rows["size"].abs() == rows["size"].abs().min()]
        noticed = smallest["by_error"] != ""
        if smallest["single"].all():
            noticed |= smallest["by_others"] != ""
        plane, solid = smallest["dim"] == 2, smallest["dim"] == 3
        if (noticed & plane).sum() < min(2, plane.sum()):
            lacking.append(f"{fault}, in the plane")
        if solid.any() and not (noticed & solid).any():
            lacking.append(f"{fault}, in space")
    return lacking
