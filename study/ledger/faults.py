"""The matrix fault × case × check of ``faults.csv``: its columns, its summary, and the rules that it must satisfy."""

import pandas as pd

COLUMNS = ["equation", "fault", "size", "single", "case", "dim", "distance", "error", "by_error", "by_others"]
"""The columns of ``faults.csv``, with one row for each fault, size and case.

    equation: the equation or condition of the paper that the fault violates.
    fault, size: the fault and its size δ.
    single: 1 if the fault concerns single vertices, otherwise 0.
    case, dim: the case and the dimension of its body.
    distance: S = max_t ‖u^h − u^h_δ‖_V on the finest level, where u^h_δ is the faulty discrete solution; empty if the
        faulty space has other unknowns, infinite if the faulty problem cannot be solved.
    error: the error ‖u − u^h‖_V without a fault on the finest level.
    by_error: the checks of the order and size of the error that fail with the fault.
    by_others: the other checks that fail.
"""
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
