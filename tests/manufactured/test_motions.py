"""Fronts and pressures that move in any smooth way: entry, exit, and the strain that they leave behind."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_examples import COSTLY
from scipy.integrate import solve_ivp
from sympy import Rational, besselj, cos, exp, gamma, lambdify, pi, simplify, sin

from manufactured import (
    FormulaError,
    Memory,
    pos,
    s,
    t,
)
from manufactured.symbols import differentiate

PLACES = np.linspace(0.01, 0.99, 41)[None]
QUARTER = Rational(1, 4)
ADVANCE = QUARTER + 2 * t * (1 - t)
RETURN = Rational(3, 10) + Rational(7, 20) * sin(pi * t) ** 2
"""The motions of a front: a polynomial, and one that is none."""


@COSTLY
@given(*2 * [st.floats(0.05, 0.95)], *2 * [st.floats(0.1, 50)])
@pytest.mark.parametrize("pressure", [20 * pos(ADVANCE - s, 2) * (1 + t), 40 * pos(RETURN - s, 2) * cos(t)])
def test_the_strain_solves_its_differential_equation(pressure, place, time, a, g):
    """Against adaptive steps in time, for slow and fast decay, λ = g/a."""
    at_place = Memory(pressure, a, g, 1.0).at(np.array([[place]]))
    (strain,), (rate,) = (at_place(time, of_rate, 0) for of_rate in (False, True))
    p = lambdify(t, pressure.subs(s, place), [{"pos": lambda x, m: np.maximum(x, 0) ** m}, "numpy"])
    solved = solve_ivp(
        lambda r, e: -(p(r) + g * e) / a, (0, time), [-p(0.0) / g], method="Radau", rtol=1e-11, atol=1e-14
    )
    assert strain[(0,)] == pytest.approx(solved.y[:, -1], rel=1e-9, abs=1e-11)
    assert a * rate[(0,)][0] + g * strain[(0,)][0] == pytest.approx(-p(time), abs=1e-11)


@pytest.mark.parametrize(
    ("pressure", "message"),
    [
        (pos(sin(t) - s, 1), "integer m ≥ 2"),
        (gamma(t + 1) * pos(QUARTER - s, 2), "gamma of t.*of functions use exp"),
        (pos(QUARTER + sin(5000 * t) / 5 - s, 2), "turns so often"),
        (pos(QUARTER - s, 2) * (1 + sin(3000 * t)), "changes so fast in t"),
    ],
)
def test_a_pressure_whose_memory_is_not_known_or_that_is_too_fast_is_refused(pressure, message):
    with pytest.raises(FormulaError, match=message):
        Memory(pressure, 1.0, 1.0, 1.0).at(PLACES)(1.0, False, 0)


# Formulas evaluated by NumPy.


@pytest.mark.parametrize(
    "formula",
    [exp(s * t) / (2 + s), pos(s * t - 1, Rational(5, 2)) * sin(s), (2 + t) ** s, t * besselj(1, s)],
)
def test_derivatives_of_formulas_are_those_of_sympy(formula):
    assert simplify(differentiate(formula, (s, t), (2, 1)) - formula.diff(s, 2, t)) == 0
