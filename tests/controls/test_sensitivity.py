"""How small defects may be: found by halving, seen at first order."""

from __future__ import annotations

from functools import lru_cache

import pytest

from study.controls.sensitivity import CLOSE, LEAST, Place, lines
from study.controls.small_defects import DEFECTS, START, SmallDefect
from study.statements.shared.base import Setting


@lru_cache
def place() -> Place:
    return Place.of(Setting("advance-recede", "one-diagonal", 8))


LOADS = "load f", "surface load f_2", "body force f_0", "contact load", "time t"
"""Seen by the load that is integrated once more alone, with the quadrature of both ways between them."""


@pytest.mark.parametrize("defect", DEFECTS, ids=lambda defect: defect.name)
def test_a_millionth_is_seen_but_of_loads_of_which_two_per_cent_are(defect: SmallDefect) -> None:
    assert bool(place().failing(defect.apply(place().setup, 1e-6))) is (defect.name not in LOADS)
    if defect.name in LOADS:
        assert place().failing(defect.apply(place().setup, 0.02))


def test_the_smallest_defect_fails_and_one_a_little_smaller_or_none_does_not() -> None:
    assert place().failing(place().setup) == []
    defect = DEFECTS[0]
    amount, row = place().smallest(defect)
    assert row in place().failing(defect.apply(place().setup, amount))
    assert not place().failing(defect.apply(place().setup, amount / CLOSE**2))
    assert LEAST < amount < 0.01


def test_of_a_start_that_is_zero_nothing_can_be_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("study.controls.sensitivity.DEFECTS", (START,))
    assert lines(Setting("full-contact", "one-diagonal", 8)) == []
