"""Compares the present tolerance windows of the checks with earlier windows, and gives a reason for every change.

``results/history/windows.csv`` has the windows at the end of the first round of measurements, ``released.csv`` the
windows of the last release. ``python -m study.present.windows results`` writes the second file when a version is
released. An error is raised if a window changed or a check was removed and ``page/results.toml`` has no reason, so that
no window is widened unnoticed.
"""

import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from study.ledger.datafiles import DataError, read_claims, write_csv
from study.ledger.verdict import ROW_KEY, UNCLAIMED
from study.ledger.window import MIN_POSITIVE, Window
from study.present.notation import read_page

FIRST, RELEASED = "windows.csv", "released.csv"
"""Files in ``results/history`` with the windows at the end of the first round of measurements (commit 27a936c) and of
the last release.
"""
NOT_NOTHING = "a diagnostic must be positive: exactly 0 means that a quantity was compared with itself"
WHY: dict[tuple[str, str], str] = {
    (one["label"], key): one["reason"] for one in read_page("results")["changed"] for key in one["keys"]
}
"""Label and key of checks ↦ why their window changed. If only the lower end changed, from 0 to the smallest positive
value, the reason is ``NOT_NOTHING``."""


@dataclass(frozen=True)
class Change:
    """A change of a tolerance window, the same for several checks that have one label and one key.

    Attributes:
        label, key: label and key of the checks.
        before, today: the earlier and the present window as text; ``before`` is empty for new checks.
        why: the reason.
        rows: the number of these checks.
    """

    label: str
    key: str
    before: str
    today: str
    why: str
    rows: int


def earlier(directory: Path, name: str = FIRST) -> pd.DataFrame | None:
    """Return the earlier tolerance windows from a file in ``directory/history``; None if there is no such file.

    Returns:
        A table with a row for each check and the columns ``label``, ``key``, ``case``, ``family``, ``then_low`` and
        ``then_high``.
    """
    path = directory / "history" / name
    if not path.is_file():
        return None
    table = pd.read_csv(path, keep_default_na=False)
    places = table.assign(place=table.pop("cases").str.split(" ")).explode("place", ignore_index=True)
    ends = places.pop("place").str.replace("_", " ").str.partition("@")
    found = places.assign(case=ends[0], family=ends[2])
    return found.rename(columns={"low": "then_low", "high": "then_high"})


def release(directory: Path) -> Path:
    """Write the tolerance windows of a run into the file ``history/released.csv``, which ``earlier`` reads."""
    claims = read_claims(directory)
    claimed = claims[~claims["verdict"].isin(UNCLAIMED)].fillna({"family": ""})
    family = claimed["family"].where(claimed["family"] == "", "@" + claimed["family"])
    places = claimed.assign(cases=(claimed["case"] + family).str.replace(" ", "_"))
    columns = ["label", "key", "window_low", "window_high"]
    table = places.groupby(columns, sort=False, as_index=False)["cases"].agg(" ".join)
    named = table.rename(columns={"window_low": "low", "window_high": "high"})
    return write_csv(directory / "history" / RELEASED, named)


def changes(then: pd.DataFrame, claims: pd.DataFrame) -> list[Change]:
    """Return the tolerance windows that changed or disappeared, in the order of the earlier table.

    Parameters:
        then: the earlier windows, from ``earlier``.
        claims: the content of ``claims.csv``.

    Raises:
        DataError: a change has no reason.
    """
    both = then.merge(claims.fillna({"family": ""}), on=[*ROW_KEY], how="left", validate="one_to_one")
    found: Counter[tuple[str, str, str, str, str]] = Counter()
    for row in both.to_dict("records"):
        before, now = Window(row["then_low"], row["then_high"]), Window(row["window_low"], row["window_high"])
        gone = pd.isna(row["verdict"])
        claimed = not gone and row["verdict"] not in UNCLAIMED
        ends = [before.low, before.high], [now.low, now.high]
        if claimed and np.allclose(*ends, rtol=1e-9, atol=0, equal_nan=True):
            continue
        only_positive = claimed and before.low == 0 and now.low == MIN_POSITIVE and now.high == before.high
        why = NOT_NOTHING if only_positive else WHY.get((row["label"], row["key"]))
        if why is None:
            raise DataError(
                f"the window of {row['label']}, {row['key']} for {row['case']} was {before.text} before and is "
                f"{'gone' if gone else now.text}: say why in study/present/page/results.toml, "
                "[[changed]], or take it back"
            )
        today = "no longer there" if gone else now.text if claimed else "no claim"
        found[row["label"], row["key"], before.text, today, why] += 1
    return [Change(*change, rows) for change, rows in found.items()]


def added(then: pd.DataFrame, claims: pd.DataFrame) -> list[Change]:
    """Return the tolerance windows whose label and key occur in ``claims.csv`` but not in the earlier table."""
    known = set(then[["label", "key"]].itertuples(index=False, name=None))
    claimed = claims[~claims["verdict"].isin(UNCLAIMED)]
    found = []
    for (label, key), rows in claimed.groupby(["label", "key"], sort=False):
        if (label, key) not in known:
            numbers, _, why = str(rows["expected"].iloc[0]).partition(": ")
            found.append(Change(str(label), str(key), "", numbers, why, len(rows)))
    return found


if __name__ == "__main__":
    print(f"written: {release(Path(sys.argv[1]))}")
