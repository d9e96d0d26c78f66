"""Observed orders."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study.ledger.orders import RatesError, extrapolated_order, fit, limit, orders

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
    with pytest.raises(RatesError, match="must decrease"):
        orders(H[::-1], H)
    for bad in (0.0, -1.0, np.nan):
        with pytest.raises(RatesError, match="positive and finite"):
            orders(H, np.where(np.arange(5) == 2, bad, H))
