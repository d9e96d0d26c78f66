"""Problems in other units: the bounds follow the units, or the problem is refused by a sentence. None is NaN or 0."""

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from bodies import SIDES
from on_meshes import bounded_on, space_on
from sympy import Float, Rational, exp

from manufactured import Data, KelvinVoigt, Linear, isotropic_matrix, named, polygon, t
from manufactured.factor import x1, x2
from study.bound.bounded import BoundedSolution, check_bound
from study.bound.problem import BoundError
from study.bound.trajectory import Refined
from study.cli.common import REFUSALS
from study.fem.error_norm import ErrorNorm, NormError
from study.fem.mesh import OneDiagonal


def problem(length=1.0, time=1.0, A=1.0, G=1.0, f0=1.0, f2=1.0, u0=1.0):
    """The same formulas in x/length and t/time, with data and moduli multiplied by numbers."""
    body = polygon([(0, 0), (length, 0), (length, length), (0, length)], SIDES, T=time)
    law = KelvinVoigt(Linear(A * isotropic_matrix(1, 0.5)), Linear(G * isotropic_matrix(2, 3)), "scaled")
    X1, X2, T = (x / Float(scale) for x, scale in ((x1, length), (x2, length), (t, time)))
    force = 0, Float(f0) * (X1 - T) * (1 + exp(X2))
    start = 0, Float(u0) * X2**2 * (1 - X2) * (1 + X1) / 10
    return Data.formulas(body, law, force, {1: (-Float(f2) * T * X2, 0)}, start)


def bounded(data):
    check_bound(data, OneDiagonal(), [2], 2, Refined(0, 1))
    return bounded_on(data, 2, trajectory=Refined(0, 1)).enclosure


@lru_cache
def unscaled():
    return bounded(problem())


@pytest.mark.parametrize("size", [1e-20, 1e20])
@pytest.mark.parametrize("unit", ["force", "length", "time", "all"])
def test_bounds_follow_the_units(unit, size):
    """With u = U û(x/L, t/T) and A of the unit F: f_0 = F U/(T L²), f_2 = F U/(T L), ‖u‖_V = √F U in the plane."""
    L, T = (size if unit in (name, "all") else 1.0 for name in ("length", "time"))
    F = size if unit == "force" else 1.0
    found = bounded(problem(length=L, time=T, A=F, G=F / T, f0=F / T / L**2, f2=F / T / L))
    expected = unscaled()
    for name in ("lowest", "highest", "upper", "lower"):
        assert getattr(found, name) == pytest.approx(math.sqrt(F) * getattr(expected, name))


NONE = {"f0": 0.0, "f2": 0.0, "u0": 0.0}


@pytest.mark.parametrize(
    "sizes",
    [
        *({name: value} for name, value in {"f0": 1e160, "f2": 1e200, "u0": 1e180}.items()),
        *({name: size} for name in ("A", "G") for size in (1e150, 1e-150)),
        *({name: size} for name in ("time", "length") for size in (1e100, 1e-100)),
        *(NONE | {name: 1e-170} for name in NONE),
        {name: 1e-170 for name in NONE},
        NONE | {"f0": 1e-310},
        {"A": 1e-90, "G": 1e-90, "f0": 1e-90, "f2": 1e-90},
    ],
    ids=str,
)
def test_extreme_sizes_are_refused_by_a_sentence(sizes):
    with pytest.raises(REFUSALS, match=r"units|number|finite"):
        bounded(problem(**sizes))


def test_a_bound_whose_square_is_too_small_for_a_number_is_raised_to_the_least_bound():
    """u_0 = 0 and f_0 ~ t³⁰⁰, so bounds at early times are far below 1e-50 although no datum is zero."""
    usual = problem()
    found = bounded(Data.formulas(usual.body, usual.law, (0, t**300 * (1 + x1)), {}, (0, 0)))
    assert found.highest > 1e-3
    assert found.bound.min() == 1e-50


def test_data_that_are_zero_have_the_bound_zero():
    found = bounded(problem(**NONE))
    assert found.highest == 0
    assert not found.upper.any()


@pytest.mark.parametrize(
    "force",
    [
        Float("1e300") * exp(-((x1 - Rational(37, 100)) ** 2 + (x2 - Rational(41, 100)) ** 2) * 10**8),
        (x1**2) ** Rational(-1, 10),
    ],
    ids=["a peak that no sample sees, and its range does", "no finite range"],
)
def test_data_whose_ranges_are_not_finite_are_refused(force):
    data = problem()
    with pytest.raises(BoundError, match="not a finite number"):
        bounded(Data.formulas(data.body, data.law, (0, force)))


@pytest.mark.parametrize("name", ["distance", "bound", "between", "start", "error"])
@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_no_enclosure_is_made_of_what_is_no_number(name, value):
    found = replace(unscaled(), error=np.zeros(3))
    values = getattr(found, name)
    changed = value if name == "start" else np.where(np.arange(np.size(values)) == 1, value, values)
    with pytest.raises(BoundError, match="not a finite number"):
        replace(found, **{name: changed})


def test_no_interval_has_crossed_ends():
    found = unscaled()
    for crossed in ({"bound": found.bound * [1, -1, 1]}, {"norm": found.norm[::-1]}):
        with pytest.raises(BoundError, match="crossed ends"):
            replace(found, **crossed)
    contradiction = BoundedSolution(None, found, replace(found, distance=found.distance + 2 * found.highest))
    with pytest.raises(BoundError, match="crossed ends"):
        print(contradiction.error)


@pytest.mark.parametrize("value", [math.nan, math.inf, 1e200])
def test_an_error_that_is_no_number_is_not_measured(value):
    solution = named("full-contact").solution
    v_norm = ErrorNorm(solution, space_on(solution.body, 2))
    with pytest.raises(NormError, match="moderate size"), np.errstate(all="ignore"):
        v_norm.distance(v_norm.sample(0.5), np.full(v_norm.space.dofs, value))
    assert issubclass(NormError, REFUSALS)
