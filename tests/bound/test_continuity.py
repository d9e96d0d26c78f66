"""An initial displacement that jumps is not in V: it is refused, however narrow its band is, and kinks are not."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from bodies import LAW
from sympy import Heaviside, Piecewise, Rational, sin

from manufactured import polygon, pos, unit_square
from manufactured.data import Data, LoadError
from manufactured.factor import x1, x2
from manufactured.symbols import FormulaError
from study.bound.bounded import check_problem
from study.bound.trajectory import Refined

CIRCLE = x1**2 + x2**2
BAND = sp.Max(0, 0.0005 - sp.Abs(x1 - 0.30033))
JUMPS = [
    sp.sign(x1 - x2),
    Piecewise((1, CIRCLE < 0.3), (0, True)),
    Piecewise((1, (sp.Max(x1 - 0.3302, 0) <= 0) & (sp.Max(0.3301 - x1, 0) <= 0)), (0, True)),
    sin(3 * x1) + x2 + Heaviside(x1 - 0.4) / 500_000,
    Heaviside(x1 - 0.5) * sp.Max(x2 - 0.9, 0),
    pos(x1 - 0.3, Rational(-1, 4)),
    1 / ((x1 - 0.3) ** 2 + (x2 - 0.4) ** 2),
    sp.atan(x1) * Heaviside(x1 - 0.3),
    sp.floor(3 * x1),
    sp.Integer(0) ** sp.Max(x1 - 0.3, 0),
]
CONTINUOUS = [
    sp.Integer(0),
    sp.Max(x1 - 0.3, 0) + sp.Abs(x1 - x2),
    Piecewise((1 - CIRCLE, CIRCLE < 1), (0, True)),
    (x1 - 0.3) * Heaviside(x1 - 0.3) + sin(x1 - x2) * sp.sign(x1 - x2),
    sp.Abs(x1 - Rational(1, 3)) ** Rational(6, 10),
    sp.tanh(10**6 * (x1 - 0.5)),
    Heaviside(x1),
    sp.atan(5 * x1),
]


def problem(start):
    return Data.formulas(unit_square(), LAW, f0=(0, 0), u0=((1 - x2) * start, 0))


def check(data):
    check_problem(data, None, Refined(0, 1))


@pytest.mark.parametrize("start", JUMPS, ids=str)
def test_an_initial_displacement_that_jumps_or_is_unbounded_is_refused_with_its_place(start):
    with pytest.raises((LoadError, FormulaError), match=r"u_0 jumps by|∇u0 (= .*floor|is nan)"):
        check(problem(start))


def test_a_jump_across_an_arm_that_is_thinner_than_the_boxes_is_found():
    arms = polygon([(0, 0), (1, 0), (1, 0.003), (0.003, 0.003), (0.003, 1), (0, 1)], ["clamped"] + 5 * ["loaded"])
    with pytest.raises(LoadError, match=r"u_0 jumps by about 0\.51"):
        check(Data.formulas(arms, LAW, (0, 0), u0=(x2 * Heaviside(x2 - 0.51), 0)))


@pytest.mark.parametrize(("start", "kind"), [((BAND, 0), "CLAMPED"), ((0, (x2 - 1) * BAND), "CONTACT")])
def test_a_narrow_band_that_violates_a_boundary_condition_is_found(start, kind):
    with pytest.raises(LoadError, match=f"u_0 violates the condition of a {kind} part by 0.0005 at"):
        check(Data.formulas(unit_square(), LAW, (0, 0), u0=start))


@pytest.mark.parametrize("start", CONTINUOUS, ids=str)
def test_an_initial_displacement_with_kinks_is_permitted(start):
    check(problem(start))


def test_a_jump_of_a_function_of_python_is_found_by_samples():
    data = replace(problem(sp.Integer(0)))
    check(data)
    jump = replace(data, start=lambda x: np.array([(1 - x[1]) * (x[0] > x[1]), 0 * x[0]]))
    with pytest.raises(LoadError, match=r"u_0 jumps by about (0\.98|1)"):
        check(jump)
