"""Verdicts on bounds of errors: one error outside fails, and an interval for an order has to be narrow."""

import math

import numpy as np
import pandas as pd
from measured_rows import verdicts

from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED
from study.statements import enclosure
from study.statements.enclosure import BoundedError, EnclosedError


def bounds(trajectory, levels=(8, 16), case="a", **changes):
    """Rows of ``bounds.csv`` with errors of order 1, which the ends miss by one per cent."""
    h = 1 / np.array(levels)
    rows = pd.DataFrame({"level": levels, "h": h, "error": h, "lowest": 0.99 * h, "highest": 1.01 * h})
    place = rows.assign(trajectory=trajectory, case=case, family="shaken", scheme="midpoint")
    return place.assign(known=True, expected_order=1.0, above=0.99, below=0.99, upper=1.01, lower=0.99).assign(
        **changes
    )


UNKNOWN = bounds("enclosure", known=False, error=math.nan, above=math.nan, below=math.nan)
"""Rows of a problem whose solution nobody knows."""


def test_errors_inside_hold_and_the_distance_of_the_ends_is_reported():
    assert verdicts(BoundedError(), bounds("bound")) == {"above": HOLDS, "upper": REPORTED}
    expected = {"above": HOLDS, "below": HOLDS, "upper": REPORTED, "order": REPORTED}
    assert verdicts(EnclosedError(), bounds("enclosure")) == expected
    both = pd.concat([bounds("bound", above=2.0), bounds("enclosure")])
    assert [verdicts(one, both)["above"] for one in (BoundedError(), EnclosedError())] == [FAILS, HOLDS]


def test_one_error_outside_on_one_mesh_fails():
    for value in (1.0001, math.nan):
        assert verdicts(BoundedError(), bounds("bound", above=[0.9, value]))["above"] == FAILS
        for end in ("above", "below"):
            found = verdicts(EnclosedError(), bounds("enclosure", **{end: [value, 0.9]}))
            assert [key for key, verdict in found.items() if verdict == FAILS] == [end]


def test_an_order_is_judged_where_nobody_knows_the_error():
    assert verdicts(EnclosedError(), UNKNOWN) == {"order": HOLDS}
    assert verdicts(EnclosedError(), UNKNOWN.assign(expected_order=1.5)) == {"order": FAILS}
    assert verdicts(EnclosedError(), UNKNOWN.assign(highest=1.2 * UNKNOWN["highest"])) == {"order": UNDECIDED}
    assert verdicts(BoundedError(), UNKNOWN.assign(trajectory="bound")) == verdicts(EnclosedError(), UNKNOWN[:1]) == {}
    (order,) = EnclosedError().judge(UNKNOWN.assign(expected_order=math.nan))
    assert order.verdict == REPORTED
    assert order.expected == enclosure.UNPREDICTED
