"""Checks: each computes a quantity from measurements and compares it with its tolerance window.

A check gives one row of the ledger for each case.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from math import isnan, nan
from typing import Any

import numpy as np
from pandas import DataFrame

from study.ledger.quantities import Array, RatesError, Value
from study.ledger.verdict import (
    FAILS,
    HOLDS,
    MISSED,
    NOWHERE,
    REPORTED,
    UNDECIDED,
    CheckKind,
    Named,
    Verdict,
    agreement,
    row,
)
from study.ledger.window import Window

Groups = dict[str, DataFrame]
"""Mesh family ↦ table of its levels, coarse to fine, with the columns level, h and the measured quantities."""
MIN_LEVELS = 3
"""Least number of levels for an observed order."""
ROUNDING_ROOM = 1e-9
"""Tolerance for rounding errors in bounds that hold exactly."""


@dataclass(frozen=True)
class Check:
    """A quantity that must lie in a tolerance window.

    Attributes:
        key: short name of the check.
        quantity: the quantity in words.
        value: computes the quantity from the levels of one mesh family; or the names of one or several columns, all
            values of which are judged.
        window: the tolerance window.
        kind: what the check tests.
        levels: the least number of levels; with fewer levels the check is undecided.
        finest: whether only the last value decides between *holds* and *fails*. If other values lie outside the window,
            the check is undecided.
        if_missed: empty if something is claimed; otherwise the reason why nothing is claimed. If there is a reason, the
            window is a prediction of this study, and a value outside it gives the verdict *missed*. Without a window
            the value is only reported.
    """

    key: str
    quantity: str
    value: Value | str | list[str]
    window: Window
    kind: CheckKind
    levels: int = 1
    finest: bool = False
    if_missed: str = ""

    def verdict(self, of: Named, case: str, groups: Groups, family: str = "") -> Verdict:
        """Judge the measurements of one case.

        Parameters:
            of: the statement, with its label and claim.
            case: name of the case.
            groups: mesh family ↦ table of its levels, coarse to fine.
            family: the mesh family, if the check is about one family only.
        """
        window = self.window
        values = [self._values(table) for table in groups.values()]
        fewest = min(map(len, groups.values()), default=0)
        observed = nan
        span = NOWHERE
        verdict = UNDECIDED
        if values and all(each.size for each in values):
            every = np.concatenate(values)
            decisive = [each[-1] if self.finest else window.worst(each.tolist()) for each in values]
            observed = window.worst(decisive)
            span = every.min(), every.max()
            if not window.contains(*decisive):
                verdict = FAILS
            elif window.contains(*every):
                verdict = HOLDS
        expected = window.text
        if fewest < self.levels:
            expected += f"; undecided, because the check needs {self.levels} levels, and has {fewest}"
        result = row(of, self.key, self.quantity, window, (observed, span, verdict), case, family, expected, self.kind)
        if self.if_missed:
            return self._without_claim(result)
        return result

    def _values(self, table: DataFrame) -> Array:
        """Return the values of one mesh family, (n,); none if levels or columns are missing, NaN without an order."""
        measured: Any = []
        if len(table) >= self.levels:
            try:
                measured = self.value(table) if callable(self.value) else table[self.value]
            except RatesError:
                measured = nan
            except KeyError:
                pass
        return np.asarray(measured, dtype=float).ravel()

    def _without_claim(self, judged: Verdict) -> Verdict:
        """Return the row of a check about which nothing is claimed: *missed* if a prediction is wrong."""
        if self.window == Window():
            return replace(judged, verdict=REPORTED, expected=f"no claim: {self.if_missed}")
        missed = judged.verdict == FAILS and not isnan(judged.observed)
        judged = replace(judged, verdict=MISSED if missed else REPORTED)
        text = f"predicted {self.window.text} ({agreement(judged)}); no claim, because {self.if_missed}"
        return replace(judged, expected=text)


paper_claim, consequence, accuracy, identity = (partial(Check, kind=kind) for kind in CheckKind)
"""Make checks of the four kinds; the arguments are the other fields of ``Check``."""


def by_family(rows: DataFrame) -> Groups:
    """Divide a table by mesh families, and return a dictionary: name of the family ↦ its rows, coarse to fine."""
    return {name: table.sort_values("h", ascending=False) for name, table in rows.groupby("family", sort=False)}


def by_case(rows: DataFrame) -> Iterator[tuple[str, Groups]]:
    """Divide a table by cases, and yield each case with its measurements on each mesh family.

    Parameters:
        rows: a table with one number in each row: columns case, family, level, h, quantity, value.

    Yields:
        Pairs (case, tables). The dictionary has for each mesh family a table with one row for each level and one column
        for each quantity.
    """
    for case, of_case in rows.groupby("case", sort=False):
        groups = {
            family: table.pivot(index=["level", "h"], columns="quantity", values="value").reset_index()
            for family, table in by_family(of_case).items()
        }
        yield case, groups
