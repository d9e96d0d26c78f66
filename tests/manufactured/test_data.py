"""Data without a solution: what formulas become, what an exact solution gives, what is refused."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp
from costly_cases import by_cost

from manufactured import (
    Factor,
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
    x3,
)
from manufactured.cases.laws import not_proportional
from manufactured.catalogue import NAMES
from manufactured.data import Data, LoadError
from manufactured.problems import problems
from manufactured.tensors import mandel
from study.bound.bounded import check_bound
from study.bound.discretisation import Discretisation
from study.bound.problem import BoundError
from study.bound.trajectory import Refined
from study.fem.mesh import OneDiagonal, Unstructured
from study.fem.naming import resolve_data
from study.ledger.files import UsageError

SQUARE, LAW = unit_square(), not_proportional()
RIGHT, LEFT = 1, 3
U = (t * x1 * (1 - x2), (1 + t) * x2 * (x2 - 1) * (2 + x1))


def data(f0=(0, 0), f2=None, u0=None) -> Data:
    return Data.formulas(SQUARE, LAW, f0=f0, f2=f2, u0=u0)


# ---- formulas


def by_hand(u) -> tuple[sp.Matrix, sp.Matrix]:
    """Returns σ = Aε(u̇) + Gε(u) and −Div σ for ``LAW``, from 2μ ε + λ (tr ε) I alone."""

    def stress_of(mu, lam, u) -> sp.Matrix:
        gradient = sp.Matrix(2, 2, lambda i, j: sp.diff(u[i], (x1, x2)[j]))
        strain = (gradient + gradient.T) / 2
        return 2 * mu * strain + lam * strain.trace() * sp.eye(2)

    stress = stress_of(1, sp.Rational(1, 2), [sp.diff(v, t) for v in u]) + stress_of(2, 3, u)
    force = -sp.Matrix([sum(sp.diff(stress[i, j], (x1, x2)[j]) for j in range(2)) for i in range(2)])
    return stress, force


def test_formulas_have_their_values_at_every_place_and_time() -> None:
    stress, force = by_hand(U)
    loads = {RIGHT: tuple(stress[:, 0]), LEFT: tuple(-stress[:, 0])}
    found = data(tuple(force), loads, tuple(u.subs(t, 0) for u in U))
    found.check()
    rng = np.random.default_rng(0)
    x = rng.random((2, 4, 3))
    for time in (0.0, 0.3, 1.0):
        values = found.body_force(x)(time)
        assert values.shape == (2, 4, 3)
        for place in np.ndindex(4, 3):
            at = {x1: x[(0, *place)], x2: x[(1, *place)], t: time}
            assert np.allclose(values[(slice(None), *place)], [float(f.subs(at)) for f in force])
        for number, sign in ((RIGHT, 1), (LEFT, -1)):
            part = SQUARE.parts[number]
            y = part.sample(rng, 5)
            expected = [[float(sign * stress[i, 0].subs({x1: a, x2: b, t: time})) for a, b in y.T] for i in range(2)]
            assert np.allclose(found.surface_load(part, y)(time), expected)
    a, b = x
    assert np.allclose(found.start(x), [0 * a, b * (b - 1) * (2 + a)])
    gradient = np.array([[0 * a, 0 * a], [b * (b - 1), (2 * b - 1) * (2 + a)]])
    assert np.allclose(found.initial(x), mandel(gradient))


def test_the_data_of_an_exact_solution_are_those_of_its_formulas() -> None:
    """No front and a strain in closed form: full-contact written a second time, by its own displacement.

    q solves (5/2) q̇ + 7 q = −20 t (1 + 4 x (1 − x)), q(0) = 0, and u = (0, y (1 − y²) q).
    """
    case = named("full-contact")
    a, g = sp.Rational(5, 2), sp.Integer(7)
    memory = -20 * (t / g - a / g**2 * (1 - sp.exp(-g * t / a)))
    u = (sp.Integer(0), x2 * (1 - x2**2) * memory * (1 + 4 * x1 * (1 - x1)))
    stress, force = by_hand(u)
    second = data(tuple(force), {RIGHT: stress[:, 0], LEFT: -stress[:, 0]}, [v.subs(t, 0) for v in u])
    first, rng = Data.of(case.solution), np.random.default_rng(1)
    x = rng.random((2, 30))
    for time in (0.0, 0.4, 1.0):
        assert np.allclose(first.body_force(x)(time), second.body_force(x)(time), atol=1e-10)
        for number in (RIGHT, LEFT):
            part = SQUARE.parts[number]
            y = part.sample(rng, 10)
            own = case.solution.body.parts[number]
            assert np.allclose(first.surface_load(own, y)(time), second.surface_load(part, y)(time), atol=1e-10)
    assert np.allclose(first.start(x), second.start(x), atol=1e-12)
    assert np.allclose(first.initial(x), second.initial(x), atol=1e-12)


def test_symbols_of_the_same_name_and_texts_are_the_coordinates() -> None:
    """A derivative of x2² in another symbol that is called x2 would be 0."""
    expected = data((x1, x2 * t), u0=(0, x2 * (1 - x2)))
    x = np.random.default_rng(0).random((2, 6))
    y, time = sp.Symbol("x2"), sp.Symbol("t")
    for other in (data((sp.Symbol("x1"), y * time), u0=(0, y * (1 - y))), data(("x1", "x2*t"), u0=(0, "x2*(1 - x2)"))):
        assert np.array_equal(other.initial(x), expected.initial(x))
        assert np.array_equal(other.body_force(x)(0.7), expected.body_force(x)(0.7))
        assert other.formulas_of == expected.formulas_of


def test_parts_without_a_load_carry_none_and_start_is_zero_by_default() -> None:
    found, x = data(f2={RIGHT: (1, t)}), np.array([[0.0, 0.0], [0.2, 0.8]])
    assert abs(found.surface_load(SQUARE.parts[LEFT], x)(1.0)).max() == 0
    assert np.array_equal(found.surface_load(SQUARE.parts[RIGHT], x)(0.5), [[1, 1], [0.5, 0.5]])
    assert abs(found.start(x)).max() == abs(found.initial(x)).max() == 0


@pytest.mark.parametrize("name", by_cost(name for name in NAMES if not name.startswith("cube")))
def test_no_exact_solution_of_a_plane_body_is_refused(name: str) -> None:
    Data.of(named(name).solution).check()


def test_no_problem_without_an_exact_solution_is_refused() -> None:
    for problem in problems():
        problem.data.check()


# ---- refusals


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: data((x1,)), "f0 has 1 components, expected 2"),
        (lambda: data((0, 0, 0)), "f0 has 3 components"),
        (lambda: data(f2={RIGHT: (1,)}), "f2 on part 1 has 1 components"),
        (lambda: data(u0=(0, 0, 0)), "u0 has 3 components"),
        (lambda: data((sp.Symbol("y"), 0)), "f0 has the symbols y; use x1, x2, t"),
        (lambda: data((x3, 0)), "f0 has the symbols x3; use x1, x2, t"),
        (lambda: data(u0=(0, t * x2)), "u0 has the symbols t; use x1, x2$"),
        (lambda: data(f2={RIGHT: (sp.Symbol("s"), 0)}), "f2 on part 1 has the symbols s"),
        (lambda: data(f2={0: (1, 1)}), r"part 0, but the parts of Γ2 have the numbers \[1, 3\]"),
        (lambda: data(f2={2: (1, 1)}), r"part 2, but the parts of Γ2 have the numbers \[1, 3\]"),
        (lambda: data(f2={7: (1, 1)}), r"part 7, but"),
        (lambda: data(f2={-1: (1, 1)}), r"part -1, but"),
    ],
)
def test_formulas_that_say_nothing_or_too_much_are_refused(make, message: str) -> None:
    with pytest.raises(FormulaError, match=message):
        make()


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"f0": (sp.log(x1 - sp.Rational(1, 2)), 0)}, r"f_0 is not finite at x = \[0\.[0-4].*at t = 0"),
        ({"f0": (0, 1 / t)}, r"f_0 is not finite at x = .* at t = 0, so no stress can balance it"),
        ({"f0": (0, 1 / (1 - t))}, "f_0 is not finite at x = .* at t = 1"),
        ({"f2": {LEFT: (1 / x1, 0)}}, r"f_2 is not finite at x = \[0\.0,"),
        ({"u0": (0, sp.sqrt(x1 - sp.Rational(1, 2)) * (1 - x2))}, r"ε\(u_0\) is not finite"),
        ({"u0": (0, x2)}, r"u_0 is 1 on Γ1, where it has to vanish, \(2\.3\)"),
        ({"u0": (0, x2 - 1)}, r"u_0ν is 1 > 0 on Γ3: u_0 has to lie in K, \(3\.5\)"),
        ({"u0": (0, pos(x1 - sp.Rational(9, 10), 2) * (x2 - 1))}, "u_0ν is 0.00.* > 0 on Γ3"),
    ],
)
def test_data_that_no_solution_can_belong_to_are_refused(wrong, message: str) -> None:
    with pytest.raises(LoadError, match=message):
        data(**wrong).check()


def test_a_static_problem_without_loads_has_the_solution_zero() -> None:
    problem = static(SQUARE, plane_stress(2.0, 0.3))
    problem.check()
    x = np.array([[0.3], [0.6]])
    assert not problem.body_force(x)(0.0).any()
    assert not problem.surface_load(SQUARE.parts[RIGHT], x)(0.0).any()


@pytest.mark.parametrize(
    ("loads", "message"),
    [
        ({"f0": (t, 0)}, "^f0 has the symbols t; use x1, x2$"),
        ({"f2": {RIGHT: (0, x1 + t)}}, "^f2 on part 1 has the symbols t; use x1, x2$"),
        ({"f0": (sp.log(x1 - sp.Rational(1, 2)), 0)}, r"^f_0 is not finite at x = \[[^=]*\], so no stress"),
    ],
)
def test_messages_about_a_static_problem_name_no_times(loads, message: str) -> None:
    with pytest.raises((FormulaError, LoadError), match=message):
        static(SQUARE, plane_stress(2.0, 0.3), **loads).check()


def test_loads_of_a_wrong_shape_are_refused() -> None:
    plain = data()
    wrong = Data(SQUARE, LAW, lambda x: lambda time: np.zeros(2), plain.surface_load, plain.start, plain.initial)
    with pytest.raises(LoadError, match=r"f_0 has the shape \(2,\) at points \(2, 64\) at t = 0"):
        wrong.check()


class Unknown(Yield):
    """An operator that says nothing useful about its monotonicity."""

    constant = float("nan")

    @property
    def monotonicity(self) -> float:
        return self.constant


class Downwards(Unknown):
    constant = -float("inf")


@pytest.mark.parametrize("G", [Unknown, Downwards])
def test_a_law_without_a_usable_monotonicity_constant_is_refused_before_time_is_spent(G) -> None:
    law = KelvinVoigt(isotropic(1, 1), G(1.0, FrobeniusBall(1.0)), "my law")
    plain = Data.formulas(SQUARE, law, f0=(0, 0))
    with pytest.raises(BoundError, match=r"my law: G has the monotonicity constant .*a finite one, −L_G"):
        Discretisation(plain, OneDiagonal()(SQUARE, 2))
    with pytest.raises(BoundError, match="my law"):
        check_bound(plain, OneDiagonal(), [4], None, Refined())


class Falling(Unknown):
    constant = -2.0


def test_a_constant_that_is_not_the_least_eigenvalue_is_that_of_the_worse_end() -> None:
    """m A(a)·a ≤ (G a)·a for all a: below zero the least A counts, above the largest."""
    mesh, A = OneDiagonal()(SQUARE, 2), isotropic(1.0, 0.5)
    G = not_proportional().G

    def constant(G) -> float:
        return Discretisation(Data.formulas(SQUARE, KelvinVoigt(A, G, "law"), f0=(0, 0)), mesh).moduli.values.min()

    assert constant(Falling(1.0, FrobeniusBall(1.0))) == pytest.approx(-2.0 / A.ellipticity)
    assert constant(Yield(1.0, FrobeniusBall(1.0))) == 0
    m = constant(G)
    strains = np.random.default_rng(0).normal(size=(3, 2000))
    ratios = np.einsum("In,In->n", G(strains), strains) / np.einsum("In,In->n", A(strains), strains)
    assert m <= ratios.min() <= m * 1.01


def test_a_solid_is_refused_whatever_the_meshes() -> None:
    solid = Data.formulas(box(), not_proportional(3), f0=(0, 0, 0))
    for family in (OneDiagonal(), Unstructured()):
        with pytest.raises(BoundError, match="dimension 3; give a plane body"):
            check_bound(solid, family, [4], None, Refined())
    with pytest.raises(BoundError, match="dimension 3"):
        Discretisation(solid, OneDiagonal()(solid.body, 2))


# ---- names


def test_names_stand_for_cases_problems_and_users_data(tmp_path) -> None:
    name, found, case = resolve_data("advance-recede")
    assert name == case.name == "advance-recede"
    assert found.formulas_of is case.solution
    name, found, case = resolve_data("ramp")
    assert (name, case) == ("ramp", None)
    assert found.formulas_of == problems()[0].data.formulas_of
    (tmp_path / "mine.py").write_text(
        "from manufactured import *\nfrom manufactured.data import Data\n"
        "law = KelvinVoigt(isotropic(1, 1), isotropic(1, 1), 'law')\n"
        "press = Data.formulas(unit_square(), law, f0=(0, -1))\n"
        "def made(): return press\n"
        "case = named('corner')\n"
        "other = 3\n"
    )
    for reference in ("press", "made"):
        name, found, case = resolve_data(f"{tmp_path}/mine.py:{reference}")
        assert (name, case) == (reference, None)
        assert isinstance(found, Data)
    name, found, case = resolve_data(f"{tmp_path}/mine.py:case")
    assert name == case.name == "corner"
    with pytest.raises(UsageError, match=r"is a int, expected manufactured\.Data or"):
        resolve_data(f"{tmp_path}/mine.py:other")


def test_a_factor_beyond_its_stated_bounds_is_refused() -> None:
    """Constants rest on the bounds."""
    law = KelvinVoigt(isotropic(1, 1, factor=Factor(1 + 10 * x1, 11.0, 11.0)), isotropic(1, 1), "wrong bounds")
    with pytest.raises(LoadError, match=r"the factor of A takes values from .* stated bounds 11 and 11"):
        Data.formulas(unit_square(), law, f0=(0, 0)).check()
