"""Data without a solution: what formulas become, what an exact solution gives, what is refused, and their names."""

from dataclasses import replace

import numpy as np
import pytest
from costly_cases import by_cost
from on_meshes import data_of, discretised_on
from sympy import Rational, Symbol, log, sqrt

from manufactured import (
    CaseError,
    FormulaError,
    FrobeniusBall,
    KelvinVoigt,
    Yield,
    box,
    isotropic,
    named,
    plane_stress,
    pos,
    static,
    t,
    unit_square,
    x1,
    x2,
)
from manufactured.cases.shared import not_proportional
from manufactured.catalogue import NAMES
from manufactured.data import Data, LoadError
from manufactured.problems import problems
from study.bound.bounded import check_bound
from study.bound.problem import BoundError
from study.bound.trajectory import Refined
from study.fem.mesh import OneDiagonal, Unstructured
from study.fem.naming import family_named, resolve_data
from study.ledger.files import UsageError

SQUARE = unit_square()
LAW = not_proportional()
RIGHT = 1
LEFT = 3
X = np.array([[0.0, 0.0], [0.2, 0.8]])


def data(f0=(0, 0), **others):
    return Data.formulas(SQUARE, LAW, f0=f0, **others)


def test_symbols_of_the_same_name_are_the_coordinates():
    """A derivative of x2² in another symbol that is called x2 would be 0."""
    expected = data((x1, x2 * t), u0=(0, x2 * (1 - x2)))
    y = Symbol("x2")
    symbols = data((Symbol("x1"), y * Symbol("t")), u0=(0, y * (1 - y)))
    assert symbols.formulas_of == expected.formulas_of
    assert np.array_equal(symbols.initial(X), expected.initial(X))


@pytest.mark.parametrize("name", [*by_cost(name for name in NAMES if not name.startswith("cube")), "problems"])
def test_no_exact_solution_of_a_plane_body_and_no_problem_is_refused(name):
    for found in [problem.data for problem in problems()] if name == "problems" else [data_of(name)]:
        found.check()


LOG = log(x1 - Rational(1, 2))


@pytest.mark.parametrize(
    ("message", "wrong"),
    {
        "f0 has 1 components, expected 2": {"f0": (x1,)},
        "f2 on part 1 has 1 components": {"f2": {RIGHT: (1,)}},
        "u0 has 3 components": {"u0": (0, 0, 0)},
        **{f"f0 has the symbols {y}; use x1, x2, t": {"f0": (Symbol(y), 0)} for y in ("y", "x3")},
        "u0 has the symbols t; use x1, x2$": {"u0": (0, t * x2)},
        "f2 on part 1 has the symbols s": {"f2": {RIGHT: (Symbol("s"), 0)}},
        **{rf"part {n}, but the LOADED parts .* \[1, 3\]": {"f2": {n: (1, 1)}} for n in (0, 2, 7, -1)},
        r"f0 has to be one number or .* such as \(0, -1\) .* got -1 of the type int": {"f0": -1},
        r"f2 has to be a dict .* of a LOADED side .* such as \{2: \(0, -4\)\}": {"f2": (0, -4)},
        r"f2\[1\] has to be one number or .* got -4": {"f2": {RIGHT: -4}},
        "got gap; there is no initial gap in data": {"gap": 0.05},
        r"f_0 is not finite at x = \[0\.[0-4].*at t = 0": {"f0": (LOG, 0)},
        r"f_2 is not finite at x = \[0\.0,": {"f2": {LEFT: (1 / x1, 0)}},
        r"ε\(u_0\) is not finite": {"u0": (0, sqrt(x1 - Rational(1, 2)) * (1 - x2))},
        "u_0 is 1 on a CLAMPED part, where it has to be 0": {"u0": (0, x2)},
        "u_0ν is 1 > 0 on a CONTACT part": {"u0": (0, x2 - 1)},
        "u_0ν is 0.00.* > 0 on a CONTACT part": {"u0": (0, pos(x1 - Rational(9, 10), 2) * (x2 - 1))},
    }.items(),
)
def test_formulas_that_are_no_data_or_to_which_no_solution_belongs_are_refused(wrong, message):
    with pytest.raises((FormulaError, LoadError), match=message):
        data(**wrong).check()


@pytest.mark.parametrize(
    ("loads", "message"),
    [
        ({"f0": (t, 0)}, "^f0 has the symbols t; use x1, x2$"),
        ({"f2": {RIGHT: (0, x1 + t)}}, "^f2 on part 1 has the symbols t; use x1, x2$"),
        ({"f0": (LOG, 0)}, r"^f_0 is not finite at x = \[[^=]*\], so no stress"),
    ],
)
def test_a_static_problem_has_the_solution_zero_without_loads_and_no_times(loads, message):
    def problem(**loads):
        return static(SQUARE, plane_stress(2.0, 0.3), **loads)

    problem().check()
    assert not problem().body_force(X)(0.0).any()
    assert not problem().surface_load(SQUARE.parts[RIGHT], X)(0.0).any()
    with pytest.raises((FormulaError, LoadError), match=message):
        problem(**loads).check()


def test_loads_of_a_wrong_shape_are_refused():
    plain = data()
    wrong = Data(SQUARE, LAW, lambda x: lambda time: np.zeros(2), plain.surface_load, plain.start, plain.initial)
    with pytest.raises(LoadError, match=r"f_0 has the shape \(2,\) at points \(2, 64\) at t = 0"):
        wrong.check()


@pytest.mark.parametrize("constant", [float("nan"), -float("inf")])
def test_a_law_without_a_usable_monotonicity_constant_is_refused_before_time_is_spent(constant):
    stating = type("Stating", (Yield,), {"monotonicity": constant})
    plain = Data.formulas(SQUARE, KelvinVoigt(isotropic(1, 1), stating(1.0, FrobeniusBall(1.0)), "my law"), f0=(0, 0))
    with pytest.raises(BoundError, match=r"my law: G has the monotonicity constant .*a finite one, −L_G"):
        discretised_on(plain, 2)
    with pytest.raises(BoundError, match="my law"):
        check_bound(plain, OneDiagonal(), [4], None, Refined())


def test_a_solid_is_refused_whatever_the_meshes():
    solid = Data.formulas(box(), not_proportional(3), f0=(0, 0, 0))
    for family in (OneDiagonal(), Unstructured()):
        with pytest.raises(BoundError, match="dimension 3; give a plane body"):
            check_bound(solid, family, [4], None, Refined())
    with pytest.raises(BoundError, match="dimension 3"):
        discretised_on(solid, 2)


def test_names_stand_for_cases_problems_and_users_data(tmp_path):
    mine = tmp_path / "mine.py"
    mine.write_text(
        "from manufactured import *\nfrom manufactured.data import Data\n"
        "law = KelvinVoigt(isotropic(1, 1), isotropic(1, 1), 'law')\n"
        "press = Data.formulas(unit_square(), law, f0=(0, -1))\n"
        "def made(): return press\n"
        "corner = named('corner')\n"
    )
    for path, name, known in (
        *(("", "advance-recede", True), ("", "ramp", False)),
        *((f"{mine}:", name, name == "corner") for name in ("press", "made", "corner")),
    ):
        found_name, found, case = resolve_data(path + name)
        assert found_name == name
        assert type(found) is Data
        assert (case is not None and found.formulas_of is case.solution and case.name == name) == known


# Names that cannot be part of a file name are refused.


UNUSABLE = ["../evil", "a\\b", "C:evil", "a\x00b", "a\x1b[2Jb", "a\ud800b", ".hidden", "x" * 101, "a b", "würfel", ""]


def test_an_endless_name_of_a_mesh_family_is_refused():
    assert family_named("shaken-7").name == "shaken-7"
    with pytest.raises(UsageError, match="has 1000 digits, at most 20 are allowed"):
        family_named("shaken-" + "9" * 1000)


@pytest.mark.parametrize("name", UNUSABLE, ids=ascii)
def test_unusable_names_of_cases_are_refused(name):
    with pytest.raises(CaseError, match="case name") as refused:
        replace(named("corner"), name=name)
    assert str(refused.value).isprintable()
