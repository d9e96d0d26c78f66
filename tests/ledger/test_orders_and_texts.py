"""Observed orders; rounded bounds are bounds; labels say which numbers of the paper they are about."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study.ledger.numbered import NUMBERED, named
from study.ledger.orders import RatesError, extrapolated_order, fit, limit, orders
from study.ledger.text import down, interval, power_of_ten, up

H = 1 / np.array([8.0, 16, 32, 64, 128])


@given(st.floats(0.1, 4), st.floats(1e-3, 1e3))
def test_a_pure_power_has_its_exponent_as_every_order_and_as_the_fit(p: float, c: float) -> None:
    assert np.allclose(orders(H, c * H**p), p)
    assert fit(H, c * H**p) == pytest.approx(p)
    assert extrapolated_order(H, c * H**p) == pytest.approx(p)


@given(st.floats(0.2, 2), st.floats(0, 1))
def test_the_limit_of_a_sequence_is_found_relative_to_its_finest_errors(p: float, rest: float) -> None:
    """Zero for a pure power; a positive limit is not underestimated by the geometric means over two levels."""
    assert limit(H, 3 * H**p, p) == pytest.approx(0, abs=1e-9)
    finest = np.sqrt(np.prod((rest + 3 * H**p)[-2:]))
    assert limit(H, rest + 3 * H**p, p) >= rest / finest - 1e-9


def test_a_constant_that_alternates_from_level_to_level_leaves_no_limit() -> None:
    e = H**0.5 * np.where(np.arange(len(H)) % 2, 1.0, 1.3)
    assert limit(H, e, 0.5) == pytest.approx(0, abs=1e-9)


def test_orders_need_decreasing_sizes_and_positive_errors() -> None:
    for h in (H[::-1], np.minimum(H, H[1])):
        with pytest.raises(RatesError, match="must decrease"):
            orders(h, H)
    for bad in (0.0, -1.0, np.nan):
        with pytest.raises(RatesError, match="positive and finite"):
            orders(H, np.where(np.arange(5) == 2, bad, H))


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


def test_there_are_a_hundred_and_six_formulas_and_eleven_statements() -> None:
    assert len(set(NUMBERED)) == len(NUMBERED) == 18 + 15 + 30 + 43 + 11
    assert NUMBERED[0], NUMBERED[-1] == ("(2.1)", "Prop. 5.4")


@pytest.mark.parametrize(
    ("text", "numbers"),
    [
        ("(3.9)–(3.11), (4.14), (4.15)", ["(3.10)", "(3.11)", "(3.9)", "(4.14)", "(4.15)"]),
        ("Thm 4.1, 5.2", ["Thm 4.1", "Thm 5.2"]),
        ("Thm 4.2, own space", ["Thm 4.2"]),
        ("Problem 5.1, (5.2), (5.3)", ["(5.2)", "(5.3)", "Problem 5.1"]),
        *(("beyond: O(h + k)", []), ("Π^h", [])),
    ],
)
def test_ranges_and_lists_of_numbers_are_understood(text: str, numbers: list[str]) -> None:
    assert sorted(named(text)) == numbers


def test_a_range_ends_in_its_section() -> None:
    with pytest.raises(ValueError, match="write a range for each"):
        named("(4.28)–(5.3)")
