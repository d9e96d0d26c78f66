"""A guaranteed bound holds for data that no sample sees; what cannot be enclosed is called estimated."""

import math

import numpy as np
import pytest
import sympy as sp
from bodies import LAW
from costly_cases import slow
from on_meshes import bounded_on, data_of, discretised_on
from sympy import Rational, exp, pi, sin

from benchmarks.trials.known import random_trial
from benchmarks.trials.random_problems import ENCLOSED, TIMES, outcome
from manufactured import (
    FrobeniusBall,
    KelvinVoigt,
    Linear,
    Yield,
    isotropic,
    polygon,
    pos,
    static,
    t,
    unit_square,
)
from manufactured.data import Data
from manufactured.factor import layers, x1, x2
from study.bound.enclosing import order_interval
from study.bound.remainders import ESTIMATED, GUARANTEED
from study.bound.trajectory import Refined

# ---- problems whose solutions are known and whose data are as rough as one likes


def enclosed(problem, level, steps):
    return bounded_on(problem, level, steps=steps, trajectory=Refined(0, 1)).enclosure


@pytest.mark.parametrize("seed", [1003, *(slow(seed) for seed in (4, 8, 11, *range(1000, 1010)) if seed != 1003)])
def test_no_error_lies_outside_for_random_data_that_samples_do_not_see(seed):
    trial = random_trial(seed)
    found = trial.bounded()
    assert found.enclosure.evidence.kind == GUARANTEED
    assert outcome(trial, found, np.random.default_rng(seed).random(TIMES))[0] == ENCLOSED


# ---- the two examples that a bound from samples got wrong


def spike(width):
    """A load that is concentrated at one point."""
    force = -10 / (pi * width**2) * t * exp(-((x1 - 0.37) ** 2 + (x2 - 0.41) ** 2) / width**2)
    return Data.formulas(unit_square(), LAW, f0=(0, force))


@pytest.mark.parametrize(
    ("data", "steps", "least", "place"),
    [
        (spike(Rational(5, 1000)), 4, 1.4, "near x = (0.4"),
        (Data.formulas(unit_square(), LAW, f0=(0, -100 * sin(64 * pi * t) ** 2)), 8, 3.2, ""),
    ],
)
def test_a_load_that_samples_do_not_see_is_enclosed_and_its_place_is_named(data, steps, least, place):
    enclosure = enclosed(data, 4, steps)
    assert enclosure.evidence.kind == GUARANTEED
    assert enclosure.highest > least
    assert f"f_0 is seen poorly {place}" in enclosure.evidence.poorly_seen


@pytest.mark.parametrize("condition", [x1 >= 2 / 3, x1 <= 2 / 3], ids=str)
def test_a_traction_that_changes_across_its_side_is_not_decided_by_rounding(condition):
    """On the side x1 = 2/3 the condition holds or not by the rounding of quadrature points."""
    body = polygon([(0, 0), (2 / 3, 0), (2 / 3, 1), (0, 1)], ["clamped", "loaded", "loaded", "loaded"])
    tractions = -1, sp.Piecewise((-1, condition), (0, True))
    norms = [enclosed(static(body, isotropic(1, 1), (1, 0), {1: (0, load)}), 2, 1).norm for load in tractions]
    lows, highs = zip(*norms, strict=True)
    assert max(lows) <= min(highs)


# ---- what is not guaranteed says so


SQUARE = unit_square()
ISOTROPIC = isotropic(1, 1)
LAYERS = Linear(ISOTROPIC.matrix, layers((1.0, 0.0), 0.5, 2.0))


def of_law(A, G):
    return Data.formulas(SQUARE, KelvinVoigt(A, G, "other"), f0=(0, 0))


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (data_of("full-contact"), "known at points and times only"),
        (Data.formulas(SQUARE, LAW, f0=(sp.atan(1 + x1), 0)), "atan"),
        (of_law(ISOTROPIC, Yield(1.0, FrobeniusBall(1.0))), "nonlinear G"),
        (of_law(LAYERS, ISOTROPIC), "varies in x"),
        (of_law(ISOTROPIC, LAYERS), "varies in x"),
        (Data.formulas(SQUARE, LAW, f0=(0, pos(x1 - 0.4, 1)), lines=(((1.0, 0.0), 0.4),)), "graded rules"),
    ],
)
def test_what_is_sampled_is_called_estimated_with_the_reason(data, reason):
    evidence = discretised_on(data, 4).sampling
    assert any(reason in one for one in evidence.reasons)


@pytest.mark.parametrize(("load", "missed"), [(pos(x1 - x2 - t / 3, 1), True), (t * x2, False)])
def test_a_kink_without_lines_is_guaranteed_by_a_lower_order_and_nothing_is_missed_of_polynomials(load, missed):
    enclosure = enclosed(Data.formulas(SQUARE, LAW, f0=(0, -5 * load)), 2, 2)
    assert enclosure.evidence.kind == GUARANTEED != ESTIMATED
    assert all((one.missed > 0) == missed for one in enclosure.intervals[1:])
    assert missed or enclosure.evidence.poorly_seen == ""


@pytest.mark.parametrize(
    ("coarse", "fine", "ratio", "order"),
    [
        ((0.0, 2.0), (0.5, 1.0), 1.0, (-math.inf, math.log(4))),
        ((1.0, 2.0), (0.0, 0.5), 1.0, (math.log(2), math.inf)),
    ],
)
def test_the_interval_of_an_order_follows_from_the_ends_of_those_of_the_errors(coarse, fine, ratio, order):
    assert order_interval(coarse, fine, ratio) == pytest.approx(order)
