"""The windows of the ledger that changed since the end of the first round, and why.

``results/history/windows.csv`` has the windows of the rows that were claimed then. A window that changed without a
reason in ``WHY``, or a row that is no longer claimed, is an error, so that no window is loosened unseen.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from study.ledger.datafiles import DataError
from study.ledger.verdict import REPORTED
from study.ledger.window import MIN_POSITIVE, Window

COMMIT = "27a936c"
"""The last commit of the first round."""
PLACE = ["label", "key", "case", "family"]
NOT_NOTHING = "evidence may not be exactly nothing: that of a thing beside itself is"
OWN_SPACE = "Thm 4.2, own space"
ELSEWHERE = "merging-patches and layered are measured on meshes that are not random"
BY_CHANCE = (
    "on shaken meshes standard deviations of a pilot are left for chance; the window of then is kept on meshes with "
    f"one diagonal, by a new row for each case, and {ELSEWHERE}"
)
OF_CELLS, OF_EDGES = ("stress", "strain", "primal_stress"), ("pressure", "displacement", "primal_displacement")
WHY: dict[tuple[str, str], str] = {
    (
        "Prop. 5.4",
        "start-share",
    ): "a largest error at t = 0, where nothing was solved, passed by an escape clause; now it "
    "fails, or is reported where ‖u − Π^h u‖_V is as large there",
    (
        "Prop. 5.4",
        "order-fitted",
    ): "the 95 % interval of the fit needed only to lie in 0 to 2, by a rule that no other row "
    "has; the order extrapolated to h → 0 takes its place, with the same window and the general rule",
    **{(OWN_SPACE, f"order-{name}"): ELSEWHERE for name in OF_CELLS},
    **{(OWN_SPACE, f"order-{name}"): BY_CHANCE for name in OF_EDGES},
    (OWN_SPACE, "growth"): BY_CHANCE,
    (OWN_SPACE, "admissible"): ELSEWHERE,
    (OWN_SPACE, "time-share"): "narrower, and of quadrature, too: f_0 is integrated by a finer rule in the companion",
}
"""The reasons by label and key, unless only the low end changed from 0 to the smallest positive value."""


@dataclass(frozen=True)
class Change:
    """A number of rows of one label and key with the same change of their window."""

    label: str
    key: str
    before: str
    today: str
    why: str
    rows: int


def earlier(directory: Path) -> pd.DataFrame | None:
    """Returns the rows that were claimed then: label, key, case, family, then_low, then_high; None without a record."""
    path = directory / "history" / "windows.csv"
    if not path.is_file():
        return None
    table = pd.read_csv(path, keep_default_na=False)
    places = table.assign(place=table.pop("cases").str.split(" ")).explode("place", ignore_index=True)
    ends = places.pop("place").str.replace("_", " ").str.partition("@")
    found = places.assign(case=ends[0], family=ends[2])
    return found.rename(columns={"low": "then_low", "high": "then_high"})


def changes(then: pd.DataFrame, claims: pd.DataFrame) -> list[Change]:
    """Returns the changes, in the order of the ledger; raises DataError if a change has no reason."""
    both = then.merge(claims.fillna({"family": ""}), on=PLACE, how="left", validate="one_to_one")
    return [Change(*found, rows) for found, rows in Counter(_differences(both)).items()]


def added(then: pd.DataFrame, claims: pd.DataFrame) -> list[Change]:
    """Returns labels and keys that are claimed today and were not known then."""
    known = set(then[["label", "key"]].itertuples(index=False, name=None))
    claimed = claims[claims["verdict"] != REPORTED]
    found = []
    for (label, key), rows in claimed.groupby(["label", "key"], sort=False):
        if (label, key) not in known:
            numbers, _, why = str(rows["expected"].iloc[0]).partition(": ")
            found.append(Change(str(label), str(key), "", numbers, why, len(rows)))
    return found


def _differences(rows: pd.DataFrame) -> Iterator[tuple[str, str, str, str, str]]:
    for row in rows.to_dict("records"):
        then = Window(row["then_low"], row["then_high"])
        now = Window(row["window_low"], row["window_high"])
        gone = pd.isna(row["verdict"])
        same = np.allclose([then.low, then.high], [now.low, now.high], rtol=1e-9, atol=0, equal_nan=True)
        if not gone and row["verdict"] != REPORTED and same:
            continue
        today = "no longer there" if gone else "reported" if row["verdict"] == REPORTED else now.text
        yield row["label"], row["key"], then.text, today, _why(row, then, None if gone else now)


def _why(row: dict[str, object], then: Window, now: Window | None) -> str:
    if now and row["verdict"] != REPORTED and then.low == 0 and now.low == MIN_POSITIVE and now.high == then.high:
        return NOT_NOTHING
    try:
        return WHY[str(row["label"]), str(row["key"])]
    except KeyError:
        raise DataError(
            f"the window of {row['label']}, {row['key']} for {row['case']} was {then.text} at {COMMIT} and is "
            f"{now.text if now else 'gone'}: say why in {__name__}.WHY, or take it back"
        ) from None
