"""The matrix fault × case × check of ``faults.csv``: its summary, and the rules that it must satisfy."""

import pandas as pd

INVISIBLE_SHARE = 1e-6
"""A fault is invisible in a case if it changes the discrete solution by less than this fraction of the error."""
ALONE = r"(?:^|; )(?!Thm 4\.2)."
"""Pattern of lists of failing checks with another check than the comparison with Problem 3.2 (Theorem 4.2).

The comparison notices any fault that the other formulation does not have."""


def summary(matrix: pd.DataFrame) -> pd.DataFrame:
    """Return for each fault and size in how many cases it occurs, is noticed, and is invisible.

    Parameters:
        matrix: the table ``faults.csv``.
    """
    by_error = matrix["by_error"] != ""
    rows = matrix.assign(
        errors=by_error,
        any_check=by_error | (matrix["by_others"] != ""),
        invisible=matrix["distance"] < INVISIBLE_SHARE * matrix["error"],
    )
    grouped = rows.groupby(["equation", "fault", "size"], sort=False)
    counts = grouped[["errors", "any_check", "invisible"]].sum()
    return counts.assign(cases=grouped.size()).reset_index()


def missed(matrix: pd.DataFrame) -> dict[str, str]:
    """Return the faults that are not noticed as the rules demand: name ↦ where, "in the plane" or "in space" or both.

    By the order or the size of the error, every fault must be noticed at its smallest size in two plane cases. In space
    only the largest size is tried, because the meshes are coarser, and must be noticed in one case. For a fault at
    single vertices or cells, or of contact forces only, any check but the comparison with Problem 3.2 may notice it.

    Parameters:
        matrix: the table ``faults.csv``.
    """
    lacking = {}
    alone = matrix["by_others"].str.contains(ALONE)
    for fault, rows in matrix.groupby("fault", sort=False):
        size = rows["size"].abs()
        noticed = (rows["by_error"] != "") | (rows["single"] == 1) & alone[rows.index]
        plane = noticed[(rows["dim"] == 2) & (size == size.min())]
        solid = noticed[(rows["dim"] == 3) & (size == size.max())]
        places = {
            "in the plane": plane.sum() < min(2, len(plane)),
            "in space": len(solid) > 0 and not solid.any(),
        }
        if any(places.values()):
            lacking[str(fault)] = " and ".join(place for place, lacks in places.items() if lacks)
    return lacking


def in_words(lacking: dict[str, str]) -> str:
    """Return the result of ``missed`` as a text."""
    return "; ".join(f"{fault}, {where}" for fault, where in lacking.items()) or "none"
