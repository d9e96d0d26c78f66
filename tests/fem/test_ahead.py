"""Blocks of times that are known before give what each time gives alone, and are found once."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from study.fem.ahead import RECENT, TIMES, Ahead, block_length

TOLD = st.lists(st.lists(st.integers(0, 60), min_size=1, unique=True).map(sorted), max_size=3)


@given(told=TOLD, asked=st.lists(st.integers(0, 60), max_size=40), length=st.integers(1, 7))
def test_whatever_is_foreseen_every_time_has_its_own_value(
    told: list[list[int]], asked: list[int], length: int
) -> None:
    ahead = Ahead[float](length)
    for times in told:
        ahead.foresee(np.array(times, dtype=float))
    assert [ahead(float(time), lambda times: [*(times**2)]) for time in asked] == [time**2 for time in asked]


@given(count=st.integers(1, 60), length=st.integers(1, 7), side_by_side=st.integers(1, RECENT))
def test_times_that_come_in_their_order_are_found_once_and_together(count: int, length: int, side_by_side: int) -> None:
    """Also where several sequences are asked for in turns."""
    found: list[int] = []

    def find(times: np.ndarray) -> list[float]:
        found.append(len(times))
        return [*times]

    ahead, sequences = Ahead[float](length), [np.arange(count) + 0.1 * i for i in range(side_by_side)]
    for times in sequences:
        ahead.foresee(times)
    assert [ahead(time, find) for together in zip(*sequences, strict=True) for time in together]
    assert sum(found) == count * side_by_side
    assert len(found) == -(-count // length) * side_by_side


@given(entries=st.integers(1, 10**9))
def test_a_block_has_a_time_at_least_and_no_more_than_stay_in_a_cache(entries: int) -> None:
    length = block_length(entries)
    assert 1 <= length <= TIMES
    assert length == 1 or length * entries <= 1 << 20
