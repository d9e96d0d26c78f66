"""One call gives all fields of a case, which belong together; points, times and shapes beyond it are refused."""

import numpy as np
import pytest
from costly_cases import by_cost
from on_floor import on_floor
from sympy import Rational

from manufactured import (
    Case,
    CaseError,
    KelvinVoigt,
    Kind,
    Regularity,
    SelfProofError,
    evaluate,
    isotropic,
    named,
    pos,
    prove,
    s,
    t,
)
from manufactured.catalogue import NAMES
from manufactured.tensors import mandel, traction

TIME = 0.4


@pytest.mark.parametrize("name", by_cost(NAMES))
def test_the_gradient_has_the_strain_as_its_symmetric_part_and_all_else_is_what_the_fields_say(name: str) -> None:
    case = named(name)
    body = case.solution.body
    x = body.sample(np.random.default_rng(5), 5)
    found, fields = evaluate(case, x, TIME), case.solution.at(x)
    size = abs(found.gradient).max()
    assert np.allclose(mandel(found.gradient), found.strain, rtol=0, atol=1e-11 * size)
    for quantity in ("displacement", "velocity", "strain_rate", "stress", "body_force"):
        assert np.array_equal(getattr(found, quantity), getattr(fields, quantity)(TIME)), quantity
    (*_, part) = body.of(Kind.LOADED)
    assert np.array_equal(found.surface_load(part), traction(found.stress, part.normal))


def test_the_gradient_is_the_difference_of_displacements() -> None:
    case, step = named("advance-recede"), 1e-6
    x = case.solution.body.sample(np.random.default_rng(5), 5)
    found = evaluate(case.solution, x, TIME).gradient
    for j in range(2):
        moved = [evaluate(case, x + sign * step * np.eye(2)[:, [j]], TIME).displacement for sign in (1, -1)]
        assert np.allclose(found[:, j], (moved[0] - moved[1]) / (2 * step), atol=1e-7)


BRACKET = named("re-entrant").solution


@pytest.mark.parametrize("point", [(5, 5), (1.5, 1.5), (-1e-6, 0.5), (np.nan, 0.5), (np.inf, 0.5)])
def test_a_point_outside_the_body_is_refused_also_at_a_re_entrant_corner(point: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match=r"lies outside the body.*1 of 2 points.*\[0, 2\] × \[0, 2\]"):
        BRACKET.at(np.array([point, (0.5, 0.5)]).T)


def test_points_outside_by_rounding_and_complex_steps_are_accepted() -> None:
    corners = BRACKET.body.vertices
    for by in (1e-12, 1e-30j):
        assert np.isfinite(BRACKET.at(corners + by).displacement(0.5)).all()


@pytest.mark.parametrize("time", [3, -0.1, 1 + 1e-6, np.nan])
def test_a_time_outside_the_interval_is_refused_alone_and_among_others(time: float) -> None:
    fields, on_face = BRACKET.at([[0.5], [0.5]]), BRACKET.on(BRACKET.faces[0], [[0.5]])
    fields.displacement(1 + 1e-12)
    for field in (fields.displacement, fields.stress, fields.body_force, on_face.gap, on_face.pressure):
        for given in (time, np.array([0.5, time])):
            with pytest.raises(ValueError, match=r"lies outside \[0, 1\]"):
                field(given)


@pytest.mark.parametrize(
    ("x", "told"),
    [
        ([0, -0.4], r"shape \(2, n\).*got the shape \(2,\); write one point as \[\[0\], \[-0\.4\]\]"),
        (np.zeros((7, 2)), r"got the shape \(7, 2\); transpose it"),
        (np.zeros((3, 3)), r"got the shape \(3, 3\)"),
        (0.5, r"got the shape \(\)"),
        ([[0, 1], [0]], "rows of different lengths"),
    ],
)
def test_a_wrong_shape_says_which_shape_is_wanted(x: object, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        BRACKET.at(x)
    with pytest.raises(ValueError, match=told):
        evaluate(BRACKET, x, 0.5)


def test_an_initial_gap_given_as_the_gap_is_led_to_initial_gap() -> None:
    law = KelvinVoigt(isotropic(1, 0.5), isotropic(2, 3), "linear")
    zone = Rational(1, 16) - (s - Rational(1, 2)) ** 2
    solution = on_floor(law, (s - Rational(1, 2)) ** 2 / 2, 100 * t * pos(zone, 2), zone)
    advice = r"give it as `initial_gap` of ContactFace\.linear"
    with pytest.raises(CaseError, match=f"the pressure has a front and the gap has none.*{advice}"):
        Case("bowl", "initial gap", solution, Regularity(gap=2, pressure=2), order=1, reason="test")
    with pytest.raises(SelfProofError, match=f"(?s)on the stated zone.*{advice}"):
        prove(Case("bowl", "initial gap", solution, Regularity(pressure=2), order=1, reason="test").solution, "bowl")
