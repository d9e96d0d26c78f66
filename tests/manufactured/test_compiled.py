"""Formulas evaluated by NumPy."""

import numpy as np
import pytest
import sympy as sp

from manufactured.jet import Jet
from manufactured.symbols import pos, s, t

FRONT = sp.Rational(1, 2) + t * (1 - t) / 3 - s**2


@pytest.mark.parametrize("exponent", [2, 3, 7, 12, -1, -5, "1/2", "3/2", "9/8", "-1/2", "-25/8"])
def test_powers_and_their_derivatives_are_those_of_numpy(exponent: object) -> None:
    """Of a base and of its positive part, with their derivatives, which are powers of the same base."""
    a, places = sp.Rational(exponent), np.linspace(-1, 1, 101)[None]
    base = 2 + places[0] / 3 + 0.5
    plain = Jet((2 + s / 3 + t) ** a)(places, 0.5, 2)
    rates = [np.prod([float(a) - i for i in range(k)]) / 3**k for k in range(3)]
    for k, rate in enumerate(rates):
        np.testing.assert_allclose(plain[k,], rate * base ** float(a - k), rtol=1e-14)
    truncated = Jet(pos(s - t, a))(places, 0.25, 1)
    beyond = places[0] > 0.25
    for k in range(2):
        expected = 3**k * rates[k] * (places[0, beyond] - 0.25) ** float(a - k)
        np.testing.assert_allclose(truncated[k,][beyond], expected, rtol=1e-14)
        assert not truncated[k,][~beyond].any()


@pytest.mark.parametrize(
    "formula",
    [
        (1 + t) * pos(FRONT, 4) / (2 - FRONT) ** 2 + t * pos(-FRONT, 3),
        pos(FRONT - sp.Rational(1, 8), 5) * sp.exp(-FRONT) + pos(1 - pos(FRONT, 2), 3) * s,
        pos(sp.sin(3 * s) - t, 4) * (sp.sin(3 * s) - t),
        pos(2 * s - t, 3) / (1 + (2 * s - t) ** 2) ** sp.Rational(9, 8),
        sp.atan(3 * s) * 2 ** (s * t) + sp.sqrt(2) * sp.tan(s) - sp.tanh(s + t) ** 3,
    ],
    ids=["and its negative", "inside a front", "of one term", "linear", "without a front"],
)
def test_derivatives_of_functions_of_a_front_are_those_of_the_formula_in_place_and_time(formula: sp.Expr) -> None:
    places, time = np.linspace(0, 1, 41), 0.37
    found = Jet(formula).rate()(places[None], time, 2)
    plain = {"pos": lambda x, a: np.where(x > 0, abs(x) ** float(a), 0.0)}
    for k in range(3):
        exact = sp.lambdify((s, t), formula.diff(t, s, k), [plain, "numpy"])(places, time)
        np.testing.assert_allclose(found[k,], exact, rtol=1e-11, atol=1e-11 * abs(exact).max())
