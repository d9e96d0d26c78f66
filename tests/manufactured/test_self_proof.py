"""Every condition of the self-proof can fail, and what is not a number fails it."""

import math
import re

import numpy as np
import pytest
from on_floor import on_floor
from sympy import Rational, cos, pi

from manufactured import SelfProofError, examine, named, prove
from manufactured.cases.laws import proportional
from manufactured.exact import ExactSolution, Fields
from manufactured.exact.solution import FaceFields
from manufactured.self_proof import interior
from manufactured.self_proof.contact_zone import _grid, signs
from manufactured.self_proof.finding import Finding, worst
from manufactured.symbols import pos, s, t

OFF = 1e-6
"""A relative defect that no condition may let pass."""
LAYERS, PATCH = named("layered-unmet").solution, named("travelling-patch").solution

SMALL_DEFECTS = [
    (Fields, "body_force", r"(2.2) Div σ + f_0 = 0"),
    (Fields, "surface_load", r"(2.4) σν = f_2"),
    (Fields, "stress", r"(2.1) σ = Aε(u̇) + Gε(u)"),
    (Fields, "strain", r"(2.10) ε(u) = sym ∇u"),
    (Fields, "strain_rate", r"(2.10) ε(u̇) = sym ∇u̇"),
    (Fields, "velocity", r"(2.6) u̇ = ∂u/∂t"),
    (FaceFields, "gap", r"(2.5) w = g − u_ν"),
    (FaceFields, "stated_pressure", r"(2.5) p = −σ_ν"),
]


def violated(solution: ExactSolution) -> str:
    """The conditions that are, in words."""
    with pytest.raises(SelfProofError) as refusal:
        prove(solution, "a case")
    return "\n".join(finding.condition for finding in refusal.value.findings)


@pytest.mark.parametrize(("name", "apart"), [("hexagon", 0.01), ("cube-disc", 0.03)])
def test_the_conditions_on_gamma_3_are_looked_at_all_along_it(name: str, apart: float) -> None:
    for face in named(name).solution.faces:
        points, (low, high) = _grid(face.part), (face.part.outline.min(axis=1), face.part.outline.max(axis=1))
        for places, a, b in zip(points, low, high, strict=True):
            assert np.diff(np.sort([a, *places, b])).max() <= apart * (b - a)


def off_by_a_millionth(values: np.ndarray) -> np.ndarray:
    return (1 + OFF) * values


def no_number_at_one_point(values: np.ndarray) -> np.ndarray:
    damaged = np.array(values)
    damaged[..., 0] = math.nan
    return damaged


@pytest.mark.parametrize("damaged", [off_by_a_millionth, no_number_at_one_point])
@pytest.mark.parametrize(("where", "name", "condition"), SMALL_DEFECTS, ids=lambda one: str(one).partition(") ")[0])
def test_a_damaged_field_violates_its_condition(monkeypatch, where, name, condition: str, damaged) -> None:
    right = getattr(where, name)
    monkeypatch.setattr(where, name, lambda *given, **options: damaged(right(*given, **options)))
    assert condition in violated(PATCH)


def test_each_numbered_condition_is_examined_where_it_has_something_to_say() -> None:
    numbers = {re.match(r"\([\d.]+\)", finding.condition)[0] for finding in examine(LAYERS)}
    assert numbers == {"(2.1)", "(2.2)", "(2.3)", "(2.4)", "(2.5)", "(2.6)", "(2.9)", "(2.10)", "(3.1)", "(3.2)"}
    said = [finding.condition for finding in examine(LAYERS)]
    for words in ("Div σ + f_0", "σν continuous", "u(t) = u_0 + ∫u̇ dt", "σ_τ = 0", "u_ν ≤ g", "σ_ν ≤ 0", "w > 0 off"):
        assert any(words in one for one in said), words


@pytest.mark.parametrize(("share", "passes"), [(1e-16, True), (1e-12, False)], ids=["rounding", "more"])
def test_where_nothing_is_pressed_a_pull_is_rounding_beside_the_stresses_on_the_face_or_a_violation(
    monkeypatch, share, passes
) -> None:
    right = FaceFields.pressure
    monkeypatch.setattr(FaceFields, "pressure", lambda on, time: right(on, time) - share * on.stress_scale())
    signs_of_p = [
        one for one in signs(named("no-contact").solution) if one.condition.startswith(("(2.5) σ_ν ≤ 0", "(2.5) p = 0"))
    ]
    assert [one.passes for one in signs_of_p] == 2 * [passes]


@pytest.mark.parametrize("defect", [math.nan, math.inf])
def test_what_is_no_number_passes_nothing(defect: float) -> None:
    assert not Finding("(2.2)", defect, 1e-9, (0.0,), 0.0).passes
    x, scale = np.zeros((2, 2)), np.ones((1, 2))
    assert not worst("(2.2)", x, np.zeros(1), np.array([[0.0, defect]]), scale).passes
    assert not worst("(2.2)", x, np.zeros(1), np.array([[0.0, 1e-8]]), np.array([[defect, 1.0]])).passes


def ten_periods() -> ExactSolution:
    """Contact that comes and goes ten times until T = 20."""
    c = Rational(1, 2) + cos(pi * t) / 4
    return on_floor(proportional(0.2), 20 * pos(s - c, 4), 20 * pos(c - s, 2), c - s, T=20.0)


def test_the_integral_of_the_velocity_is_fine_enough_for_a_long_time_and_hides_no_wrong_velocity(monkeypatch) -> None:
    solution, right = ten_periods(), Fields.velocity
    x = solution.body.sample(np.random.default_rng(0), 20)
    assert interior.history(solution, x).passes
    with monkeypatch.context() as patch:
        patch.setattr(interior, "MOST", interior.PANELS)
        assert not interior.history(solution, x).passes
    monkeypatch.setattr(Fields, "velocity", lambda fields, time: 1.001 * right(fields, time))
    assert not interior.history(solution, x).passes
