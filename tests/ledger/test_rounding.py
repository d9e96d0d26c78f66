"""Rounded bounds are bounds."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from study.ledger.text import down, interval, power_of_ten, up


@given(value=st.floats(-1e9, 1e9), digits=st.integers(1, 8))
def test_a_number_rounded_down_is_not_larger_and_one_rounded_up_not_smaller(value: float, digits: int) -> None:
    below, above = Fraction(down(value, digits)), Fraction(up(value, digits))
    assert below <= Fraction(value) <= above
    assert above - below <= Fraction(10) ** (1 - digits) * max(abs(below), abs(above))


def test_an_interval_grows() -> None:
    assert interval(0.857705, 1.02904, 4) == "[0.8577, 1.03]"
    assert interval(-0.12345, 0.25, 3) == "[-0.124, 0.25]"


@given(value=st.floats(1e-30, 1e30))
def test_a_power_of_ten_is_the_least_that_is_not_smaller(value: float) -> None:
    found = power_of_ten(value, 0.0)
    assert found == float(f"1e{round(math.log10(found))}")
    assert value <= found
    assert float(f"1e{round(math.log10(found)) - 1}") < value


@pytest.mark.parametrize(
    ("value", "found"), [(0.0, 1e-9), (1e-9, 1e-9), (1.1e-9, 1e-8), (1e-5, 1e-5), (3.0, 10.0), (math.inf, math.inf)]
)
def test_a_power_of_ten_has_a_least_value(value: float, found: float) -> None:
    assert power_of_ten(value, 1e-9) == found
    assert math.isnan(power_of_ten(math.nan, 1e-9))
