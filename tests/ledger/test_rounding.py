"""Rounded bounds are bounds."""

from __future__ import annotations

from fractions import Fraction

from hypothesis import given
from hypothesis import strategies as st

from study.ledger.rounding import down, interval, up


@given(value=st.floats(-1e9, 1e9), digits=st.integers(1, 8))
def test_a_number_rounded_down_is_not_larger_and_one_rounded_up_not_smaller(value: float, digits: int) -> None:
    below, above = Fraction(down(value, digits)), Fraction(up(value, digits))
    assert below <= Fraction(value) <= above
    assert above - below <= Fraction(10) ** (1 - digits) * max(abs(below), abs(above))


def test_an_interval_grows() -> None:
    assert interval(0.857705, 1.02904, 4) == "[0.8577, 1.03]"
    assert interval(-0.12345, 0.25, 3) == "[-0.124, 0.25]"
