"""How small defects may be: found by bisection, seen at first order."""

from __future__ import annotations

from functools import lru_cache

import pytest

from study.controls.sensitivity import CLOSE, LEAST, Place, lines
from study.controls.small_defects import DEFECTS, START
from study.statements.shared.base import Setting


@lru_cache
def place() -> Place:
    return Place.of(Setting("advance-recede", "one-diagonal", 8))


LOADS = "load f", "surface load f_2", "body force f_0", "contact load", "time t"
"""Seen only by the load that is integrated a second time, with a quadrature error between the two."""


@pytest.mark.parametrize("name", DEFECTS)
def test_a_millionth_is_seen_except_of_loads_of_which_two_per_cent_are(name: str) -> None:
    assert bool(place().failing(DEFECTS[name](place().setup, 1e-6))) is (name not in LOADS)
    if name in LOADS:
        assert place().failing(DEFECTS[name](place().setup, 0.02))


def test_the_smallest_defect_fails_and_one_a_little_smaller_or_none_does_not() -> None:
    assert place().failing(place().setup) == []
    load = DEFECTS["load f"]
    amount, row = place().smallest(load)
    assert row in place().failing(load(place().setup, amount))
    assert not place().failing(load(place().setup, amount / CLOSE**2))
    assert LEAST < amount < 0.01


def test_of_a_start_that_is_zero_nothing_can_be_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("study.controls.sensitivity.DEFECTS", {START: DEFECTS[START]})
    assert lines(Setting("full-contact", "one-diagonal", 8)) == []
