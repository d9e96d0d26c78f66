"""Every formula of the data is served, or refused by a sentence: never a traceback, never a range that is too small."""

import math

import numpy as np
import pytest
import sympy as sp
from bodies import LAW
from numpy.testing import assert_allclose
from random_formulas import RandomFormula, exact
from scipy.interpolate import BarycentricInterpolator
from sympy import Float, Integer, Rational, exp, log, sin, sqrt, tanh

from manufactured import pos, t, unit_square
from manufactured.data import PIECEWISE, Data, LoadError, compiled, gradient, own_formula
from manufactured.factor import x1, x2
from manufactured.symbols import FormulaError
from study.bound.ranges import RANGE_OF_FUNCTION, Boxes, RangeError, _truncated, coefficients, require_known
from study.bound.remainders import CUBIC_FACTOR, PARABOLA_FACTOR, in_space, in_time

HALF = Rational(1, 2)
SERVED = {
    **{function.__name__: function for function in (*RANGE_OF_FUNCTION, sp.sinh, sp.cosh, sp.tan, sp.cot)},
    "sqrt": lambda x: sp.sqrt(1 + x**2),
    "inverse": lambda x: 1 / (2 + x**2),
    "power": lambda x: (1 + x**2) ** (1 + x2),
    "pos": lambda x: pos(x - HALF, 2),
    "step": lambda x: pos(x - HALF, 0),
    "Max": lambda x: sp.Max(0, x - HALF, x2),
    "Min": lambda x: sp.Min(x, HALF, t),
    "Abs": lambda x: sp.Abs(x - HALF),
    "sign": lambda x: sp.sign(x - HALF),
    "Heaviside": lambda x: sp.Heaviside(x - HALF),
    "Piecewise": lambda x: sp.Piecewise((x, (x < HALF) & (x2 > t)), (x**2, (x > 1) | ~(x2 < HALF)), (2, True)),
}
assert {function.__name__ for function in PIECEWISE} <= set(SERVED)
OTHERS = {
    "besselj": lambda x: sp.besselj(0, x),
    "Subs": lambda x: sp.Subs(sp.Symbol("k") + x, sp.Symbol("k"), x2),
    "Derivative": lambda x: sp.Derivative(x**2, x1),
    **{f.__name__: f for f in (sp.gamma, sp.atan, sp.asin, sp.erf, sp.floor, sp.DiracDelta, sp.zeta, sp.sec, sp.arg)},
}
INNER = ("sin", "Max", "tan", "gamma")
"""An entire function, one with kinks, one with poles, one that NumPy does not have."""


@pytest.mark.parametrize("outer", [*SERVED, *OTHERS])
def test_any_function_is_served_or_refused_by_a_sentence(outer):
    """A refusal by a sentence is an error of one of three kinds."""
    for inner in INNER:
        formula = (SERVED | OTHERS)[inner](x1 * t + x2 / 3 + Rational(1, 7))
        refused = ""
        try:
            formula = (SERVED | OTHERS)[outer](formula)
            data = Data.formulas(unit_square(), LAW, f0=(0, formula))
            data.check()
            assert np.isfinite(data.body_force(np.full((2, 3), 0.3))(0.5)).all()
            require_known(formula)
        except (FormulaError, LoadError, RangeError) as error:
            refused = str(error)
        assert not refused or len(refused) > 30
        assert not (refused and {outer, inner} <= set(SERVED)) or "is not finite at" in refused


@pytest.mark.parametrize("known", RANGE_OF_FUNCTION)
def test_ranges_of_taylor_coefficients_are_those_that_sampling_finds(known):
    """Neither too small nor too large: scaled by 0.9, or with the smaller end for the larger, they would differ."""
    x = sp.Symbol("x", real=True)
    terms = [sp.lambdify(x, sp.diff(known(x), x, order) / sp.factorial(order), "numpy") for order in range(5)]
    for ends in ((-0.7, 0.4), (0.3, 0.5), (1.1, 4.9), (-2.0, -1.8)):
        places = np.linspace(*ends, 20001)
        found = coefficients(known(x), np.transpose([ends]), 4)
        for (low, high), term in zip(found, terms, strict=True):
            with np.errstate(all="ignore"):
                values = term(places) * np.ones_like(places)
            if np.isfinite([low, high]).all():
                assert (low[0], high[0]) == pytest.approx((values.min(), values.max()), rel=1e-6, abs=1e-6), ends
            else:
                assert (~np.isfinite(values)).any() or abs(values).max() > 1e3, ends


@pytest.mark.parametrize(
    ("formula", "names"),
    {
        sp.DiracDelta(x1 - t): "DiracDelta",
        sp.sqrt(-2) * x1: "not a real",
        sp.oo * x1: "not a real",
        Integer(10) ** 400 * x1: "1.00E+400",
        Float("1e-330") * (1 + x1) ** 1000: "1.00E-330",
    }.items(),
)
def test_what_cannot_be_evaluated_is_refused_before_time_is_spent(formula, names):
    start = 0, sp.sympify(formula).subs(t, 0)
    for load in ({"f0": (0, formula)}, {"f0": (0, 0), "f2": {1: (formula, 0)}}, {"f0": (0, 0), "u0": start}):
        with pytest.raises(FormulaError) as error:
            Data.formulas(unit_square(), LAW, **load)
        assert names in str(error.value)


@pytest.mark.parametrize(
    ("formula", "message"),
    {
        sp.Piecewise((x1, sp.Eq(x1 > t, x2 > t)), (0, True)): "is no inequality",
        1 + x2 * sin(exp(x1) + sp.atan(x1 - x2)) ** 2: "atan",
        pos(x1, 1 + t): "exponent that is no number",
        sp.Integer(0) ** sp.Max(x1, 0): "zoo is no real number",
        sp.Integer(-2) ** x1: r"log\(2\) \+ I\*pi is no real number",
    }.items(),
)
def test_the_part_of_a_formula_that_has_no_range_is_named(formula, message):
    with pytest.raises(RangeError, match=message):
        require_known(formula)


def test_a_factor_that_overflows_or_underflows_in_the_ranges_does_not_hide_the_others():
    """e^y/(e^y + e^{−y}) is 1 for y of 800 or more, where e^y is infinite in double precision and e^{−y} is 0."""
    y = 400 * (2 + x1)
    one = (sp.exp(y) - sp.exp(-y)) / (sp.exp(y) + sp.exp(-y))
    box = {x1: (np.zeros(1), np.ones(1)), x2: (np.zeros(1), np.ones(1))}
    for factor in (one, sp.tanh(y), sp.sinh(y) / sp.cosh(y)):
        found = Boxes(box, (x1, x2), 4)(factor * sp.sin(3 * x2))
        assert found.values[0, 0] <= 1e-9
        assert found.values[1, 0] >= 1


# ---- random formulas with conditions, on boxes whose ends lie where conditions change

QUARTERS = np.array([(i, j) for i in range(4) for j in range(i + 1, 5)]) / 4
"""The ends of all intervals in [0, 1] that begin and end at multiples of 1/4, (intervals, 2)."""
NAMES = (x1, x2, t)
DEPTHS = (1, 1, 1, 2)


def places_in(low, high, rng):
    """Ends of boxes, at which conditions change, and points between them, all exact in binary, (6, 3, boxes)."""
    ends = np.where(rng.random((3, *low.shape)) < 1 / 2, low, high)
    return np.concatenate([ends, low + (high - low) * rng.integers(1, 8, size=(3, *low.shape)) / 8])


def exact_at(formula, places):
    """The exact values of a formula, (places, 3, boxes) → (places, boxes)."""
    return np.apply_along_axis(exact(formula), 1, places.astype(object))


def assert_random_formulas_agree(seed, count, depths=DEPTHS):
    """Ranges of values contain exact values, ranges of slopes bound differences, and NumPy gives the exact values."""
    random_formula = RandomFormula(seed)
    rng = np.random.default_rng(seed)
    unprinted = 0
    for number in range(count):
        formula = random_formula(depths[number % len(depths)])
        name = f"formula {number} of seed {seed}: {formula}"
        low, high = np.moveaxis(QUARTERS[rng.integers(len(QUARTERS), size=(3, 8))], 2, 0)
        places = places_in(low, high, rng)
        try:
            values = exact_at(formula, places)
        except TypeError:  # SymPy cannot print a few of its own nested conditions
            unprinted += 1
            continue
        found = Boxes(dict(zip(NAMES, zip(low, high, strict=True), strict=True)), NAMES, 1)(own_formula(formula))
        assert (found.values[0] <= values).all(), name
        assert (values <= found.values[1]).all(), name
        # The terms of order 1 are those of t, x2 and x1. Numbers instead of ∞ make 0 of their products with 0.
        slopes = np.minimum(found.largest[:0:-1], 1e300)
        changes = (slopes * abs(np.diff(places, axis=0))).sum(axis=1)
        assert (abs(np.diff(values, axis=0)) <= changes + 1e-12).all(), name
        if number % 8 == 0:  # SymPy takes longer to write a NumPy function than all others together
            x = np.moveaxis(places, 1, 0)
            try:
                (numerical,) = compiled([formula], 1, "f", NAMES)(x[:2], x[2])
            except FormulaError:  # NumPy refuses some deeply nested conditions
                continue
            assert (abs(numerical - values) <= 1e-9).all(), name
    assert unprinted <= count // 50


def test_ranges_contain_the_exact_values_of_random_formulas_also_where_conditions_change():
    assert_random_formulas_agree(seed=0, count=350)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(1, 6))
def test_ranges_contain_the_exact_values_of_thousands_of_nested_formulas(seed):
    assert_random_formulas_agree(seed, count=1000, depths=(2, 2, 3))


LARGE = Float("1e17")


@pytest.mark.parametrize(
    "formula",
    [
        sp.Piecewise((1, sp.Max(x1 + LARGE, 0) > LARGE), (0, True)),
        sp.Piecewise((1, 3 * sp.Max(x1 / 8, Rational(1, 10)) <= Rational(3, 10)), (0, True)),
        sp.Piecewise((1, sin(sp.Max(x1, 0) - sp.Max(x1, 0.5)) >= 0), (0, True)),
    ],
    ids=str,
)
def test_no_condition_is_decided_by_rounding(formula):
    """On [1/2, 3/4] each condition holds in exact arithmetic."""
    found = Boxes({x1: (np.array([0.5]), np.array([0.75]))}, (x1,), 0)(own_formula(formula))
    assert found.values[1] == 1


def test_numbers_that_cancel_do_not_change_what_numpy_computes():
    formula = sp.Piecewise((1, 1 + Float("1e-20") * x1 > 1), (0, True))
    assert compiled([formula], 1, "f", (x1, x2))(np.full((2, 1), 0.5)) == 1


@pytest.mark.parametrize(
    ("formula", "slopes"),
    [
        (sp.Max(x1, x1 + sp.Max(0, x1 - 0.5), x1 + sp.Max(0, x1 - 0.75)), (1, 2)),
        (sp.Min(x1, 0.5) + sp.Abs(sp.Max(x1, 0.5) - 0.5), (1, 1)),
        (sp.Heaviside(x1 - 0.5) * (x1 - 0.5) + x1 * sp.sign(x1 - 0.5), (-1, 2)),
    ],
)
def test_the_derivative_of_a_formula_with_kinks_is_that_of_the_branch(formula, slopes):
    """At x1 = 1/4 and x1 = 5/8."""
    found = compiled(gradient([formula], (x1,)), 1, "∇f", (x1, x2))(np.array([[0.25, 0.625], [0.0, 0.0]]))
    assert found.tolist() == [list(slopes)]


# ---- ranges of series


@pytest.mark.parametrize(
    "formula",
    [
        t * exp(-4 * (x1 - 0.3) ** 2 - 4 * (x2 - 0.4) ** 2),
        pos(x1 - x2, Rational(5, 2)) - pos(t - x2, 0),
        sqrt(1 + x1 * x2) + (1 + x2) ** Rational(-3, 2),
        tanh(x1 - 2 * t) + x1 ** (1 + x2),
        x2**5 * log(2 + x1) + (x1 - Rational(1, 2)) ** 4,
        sp.sinh(x1 * t) - sp.cosh(x2) * sp.tan(x1 - x2 * t) + sp.cot(1 + x2),
        (1 + x1**2) ** (x2 - t) / (2 + x1 * t),
    ],
    ids=str,
)
@pytest.mark.parametrize("variables", [(x1, x2), (t,)], ids=["space", "time"])
def test_taylor_coefficients_lie_in_their_ranges(formula, variables, rng):
    low_sides = rng.random((3, 40))
    sizes = np.geomspace(1e-3, 0.3, 40)
    boxes = Boxes(dict(zip(NAMES, zip(low_sides, low_sides + sizes, strict=True), strict=True)), variables, 4)
    found = boxes(formula)
    modules = [{"pos": lambda x, a: np.where(x > 0, np.maximum(x, 1e-300) ** a, 0.0)}, "numpy"]
    for key, low, high in zip(boxes.keys, *found.ends, strict=True):
        derivative = sp.diff(formula, *zip(variables, key, strict=True))
        values = sp.lambdify((x1, x2, t), derivative / math.prod(map(math.factorial, key)), modules)
        for _ in range(10):
            with np.errstate(over="ignore"):
                found_here = values(*low_sides + rng.random((3, 40)) * sizes) * np.ones(40)
            slack = 1e-9 * abs(found_here) + 1e-12
            assert (low - slack <= found_here).all(), key
            assert (found_here <= high + slack).all(), key


def test_a_negative_power_has_no_bound_on_a_box_that_begins_at_its_kink():
    low, high = _truncated(np.array([[0.0], [1.0]]), -0.5)
    assert low[0] == -np.inf
    assert high[0] == np.inf


def test_no_derivative_is_known_beyond_the_order_of_a_kink():
    low = np.array([0.0, 0.6])
    high = np.array([1.0, 0.9])
    found = Boxes({x1: (low, high)}, (x1,), 4)(pos(x1 - Rational(1, 2), 2))
    assert np.isfinite(found.ends[1, :3]).all()
    assert np.isinf(found.ends[1, 3:, 0]).all()
    assert np.isfinite(found.ends[1, :, 1]).all()


BOX = {x1: (np.array([0.2]), np.array([0.4])), x2: (np.array([0.1]), np.array([0.3]))}


def test_polynomials_of_degree_three_have_no_remainder_and_others_have_that_of_taylor():
    assert in_space(BOX, [x1**3 - x1 * x2**2 + t**5], 0.0, 1.0) == 0
    assert in_space(BOX, [x1**4], 0.0, 1.0) == pytest.approx(0.1**4)
    assert in_space(BOX, [pos(x1 - Rational(3, 10), 1)], 0.0, 1.0) <= 0.1
    parabola, cubic = in_time(BOX, [t**2 * x1, t**2], 0.0, 1.0)
    assert parabola == cubic == 0
    assert in_time(BOX, [t**3], 0.0, 1.0)[0] > 0 == in_time(BOX, [t**3], 0.0, 1.0)[1]


def test_the_remainder_of_a_vector_is_the_euclidean_norm_of_the_remainders_of_its_components():
    single = in_space(BOX, [x1**4], 0.0, 1.0), *in_time(BOX, [t**4], 0.0, 1.0)
    double = in_space(BOX, [3 * x1**4, 4 * x1**4], 0.0, 1.0), *in_time(BOX, [3 * t**4, 4 * t**4], 0.0, 1.0)
    assert_allclose(double, 5 * np.array(single))


@pytest.mark.parametrize(
    ("factor", "nodes"), [(PARABOLA_FACTOR, (0, 0.5, 1)), (CUBIC_FACTOR, (0, 0.25, 0.5, 1))], ids=str
)
def test_factors_of_interpolation_are_one_plus_lebesgue_constants(factor, nodes):
    x = np.linspace(0, 1, 10007)
    constant = sum(abs(BarycentricInterpolator(nodes, unit)(x)) for unit in np.eye(len(nodes))).max()
    assert 1 + constant <= factor <= 1 + 1.002 * constant


@pytest.mark.parametrize("end", [0.0, 0.5])
@pytest.mark.parametrize("change", [sp.Piecewise((-5, x1 <= Rational(1, 2)), (-1, True)), sp.Max(x1 - x2, 0)])
def test_what_changes_in_space_alone_has_no_error_of_interpolation_in_time(change, end):
    sides = {variable: (np.array([0.0]), np.array([1.0])) for variable in (x1, x2)}
    assert (in_time(sides, (change,), 0.0, end) == 0).all()
