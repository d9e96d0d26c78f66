"""Predictions of this study that were wrong, and what was learned from each."""

from __future__ import annotations

import pandas as pd

from study.ledger.datafiles import DataError
from study.ledger.text import cell
from study.ledger.verdict import MISSED

LEARNED = {
    ("(3.8), (5.9)", "variation"): "The variation of the load had not settled on these levels: it still grows by 1 % "
    "per halving of the step, although a power of 2 was excluded.",
    ("(4.13)", "tangential"): "At moving fronts the tangential stress on Γ3 converges more slowly than the stress in "
    "the body; a vanishing first-order part needs symmetric cells along Γ3.",
    ("(5.36)", "order"): "The proved order is a limit. Observed orders approach it from below, so a window that starts "
    "exactly at it has no room for coarse meshes.",
    ("superclose", "time-share"): "Where the load is only W^{1,1} in time, the error in time falls more slowly than "
    "k^{3/2} and is not small against the discrete error.",
    ("superclose", "share-growth"): "As in the row above: the share of the error in time grows with refinement.",
    ("contact force", "order-resultant"): "Errors of the resultant have both signs and cancel by chance on a coarse "
    "irregular mesh. On a face that meets Γ1 the bound by the dual norm, which excludes low orders, does not hold.",
    ("beyond: work of contact", "order-irregular"): "On a single irregular mesh the order depends on where the fronts "
    "lie. Only means over many meshes are judged.",
    ("beyond: rollers", "best"): "The logarithm in the smoothness of the solution reduces the observed order by a "
    "third on these meshes, more than the prediction allowed.",
    ("beyond: rollers", "order-standing-shaken"): "The error comes from few vertices with different neighbourhoods; "
    "single orders vary from mesh to mesh. Means over meshes are judged instead.",
    ("beyond: fully discrete", "sum-in"): "A fit with four parameters separates the errors in space and in time badly "
    "if one of them is small. Orders of the pure error in time are judged instead (beyond: O(h + k)).",
    ("beyond: fully discrete", "bdf2-error-in-k"): "Each vertex that changes contact costs BDF2, a two-step scheme, "
    "more than a one-step scheme: the order falls below 3/2.",
}
"""Label of a check and a part of its key ↦ what was learned from the wrong prediction."""


def missed_rows(claims: pd.DataFrame) -> list[list[str]]:
    """Return a row of texts for each wrong prediction of this study.

    Returns:
        Rows with the statement, the case, the quantity, the prediction, the observation and what was learned.

    Raises:
        DataError: ``LEARNED`` lacks a wrong prediction.
    """
    lines = []
    for _, row in claims[claims["verdict"] == MISSED].iterrows():
        lessons = [text for (label, key), text in LEARNED.items() if label == row["label"] and key in row["key"]]
        if not lessons:
            raise DataError(
                f"the prediction of {row['label']}, {row['key']} for {row['case']} was missed: say in {__name__}."
                "LEARNED what was learned"
            )
        predicted = str(row["expected"]).removeprefix("predicted ").partition(" (wrong)")[0]
        lines.append([row["label"], row["case"], row["quantity"], predicted, cell(row["observed"]), lessons[0]])
    return lines
