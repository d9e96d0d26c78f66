"""The worked examples of Celik et al. (2008), and the library."""

import numpy as np
import pytest
from scipy.stats import linregress, t

from study.orders import OrderError, assert_order, check_orders, observed_orders
from study.orders.sequences import fitted_order, grid_convergence


@pytest.mark.parametrize(
    ("cells", "values", "kind", "order", "extrapolated", "index"),
    [
        ((18000, 8000, 4500), (6.063, 5.972, 5.863), "monotone", 1.53, 6.1685, 0.022),
        ((18000, 4500, 980), (10.7880, 10.7250, 10.6050), "monotone", 0.75, 10.8801, 0.011),
        ((18000, 4500, 980), (6.0042, 5.9624, 6.0909), "oscillating", 1.51, 6.0269, 0.005),
    ],
)
def test_published_examples(cells, values, kind, order, extrapolated, index) -> None:
    found = grid_convergence(np.array(cells) ** -0.5, values)
    assert found.kind == kind
    assert found.order == pytest.approx(order, abs=0.01)
    assert found.extrapolated == pytest.approx(extrapolated, abs=1e-3)
    assert found.index == pytest.approx(index, abs=6e-4)


def test_values_that_diverge_and_values_that_are_equal() -> None:
    assert grid_convergence([4, 2, 1], [1.0, 1.1, 1.5]).kind == "diverging"
    assert grid_convergence([4, 2, 1], [1.0, 1.1, 1.1]).kind == "equal values"


def test_a_broken_solver_fails_the_assertion() -> None:
    h = [0.5, 0.25, 0.125, 0.0625]
    assert assert_order(h, np.square(h), expected=2).order == pytest.approx(2)
    with pytest.raises(AssertionError, match="fails"):
        assert_order(h, h, expected=2)
    found = check_orders(h, {"L2": np.square(h), "H1": h}, expected={"L2": 2, "H1": 1})
    assert [column.verdict for column in found.values()] == ["holds", "holds"]
    assert "<table>" in found["L2"]._repr_html_()


def test_errors_without_names_and_complex_errors_are_refused_in_words() -> None:
    for errors in ([4.0, 1.0], np.ones((2, 2))):
        with pytest.raises(OrderError, match="for one list use observed_orders"):
            check_orders([2, 1], errors)
    with pytest.raises(OrderError, match="complex numbers; give absolute values"):
        observed_orders([2, 1], np.array([4j, 1j]))


@pytest.mark.parametrize("levels", [3, 4, 7])
def test_the_interval_of_a_fitted_order_is_that_of_the_regression(levels: int) -> None:
    h = 2.0 ** -np.arange(levels)
    errors = h**1.5 * np.random.default_rng(levels).uniform(0.8, 1.2, levels)
    found = linregress(np.log(h), np.log(errors))
    half = t.ppf(0.975, levels - 2) * found.stderr
    assert fitted_order(h, errors) == pytest.approx((found.slope, found.slope - half, found.slope + half))
