"""Exact solutions with an initial gap: u_ν ≤ g on Γ3, w = g − u_ν."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from costly_cases import by_cost

from manufactured import Case, ContactFace, ExactSolution, FormulaError, named, pos, prove, s, t
from manufactured.case import INITIAL_GAP, CaseError
from manufactured.self_proof import SelfProofError

CASES = ("closing-gap", "parabolic-gap", "cube-bowl")


def with_gap(g: sp.Expr) -> Case:
    """The case *parabolic-gap* with another initial gap."""
    case = named("parabolic-gap")
    (face,) = case.solution.faces
    assert isinstance(face, ContactFace)
    return replace(case, solution=replace(case.solution, faces=(replace(face, initial_gap=g),)))


@pytest.mark.parametrize("name", by_cost(CASES))
def test_the_normal_displacement_is_the_initial_gap_minus_the_gap_that_is_left(name: str) -> None:
    solution = named(name).solution
    (face,) = solution.faces
    x = face.part.sample(np.random.default_rng(3), 50)
    on = solution.on(face, face.part.coordinates(x)[0])
    for time in (0.0, 0.4, 1.0):
        normal = face.part.normal @ solution.at(x).displacement(time)
        assert normal == pytest.approx(on.initial_gap() - on.gap(time), abs=1e-13)
    assert on.initial_gap().max() > 0.1


@pytest.mark.parametrize("name", CASES)
def test_no_statement_of_the_paper_is_about_them(name: str) -> None:
    assert named(name).proposition == INITIAL_GAP


def test_a_gap_of_zero_is_the_paper() -> None:
    assert with_gap(sp.Integer(0)).proposition == "Prop. 5.4"


@pytest.mark.parametrize(
    ("g", "message"),
    [
        (s * t, "depends on t"),
        (s - sp.Rational(1, 3), r"is -0\.3333 at s = 0, where .* penetrate"),
        (abs(s - sp.Rational(1, 2)), "write fronts with pos"),
        (sp.Symbol("x"), "has x"),
    ],
)
def test_an_initial_gap_that_is_none_is_refused(g: sp.Expr, message: str) -> None:
    with pytest.raises(FormulaError, match=message):
        with_gap(g)


@pytest.mark.parametrize(
    ("g", "message"),
    [
        (pos(s - sp.Rational(1, 2), 1), "a front that stays with α = 1"),
        (pos(s - sp.Rational(1, 2), sp.Rational(9, 4)), r"a front that stays with α = 2\.25"),
        (sp.sqrt(s), "not known to be smooth"),
    ],
)
def test_the_fronts_of_the_initial_gap_are_among_those_that_the_label_states(g: sp.Expr, message: str) -> None:
    with pytest.raises(CaseError, match=message):
        with_gap(g)


def test_a_gap_that_is_open_where_contact_meets_the_clamp_is_no_solution() -> None:
    """u = 0 on Γ1, so g = w where Γ3 ends at Γ1."""
    case = named("contact-at-clamp")
    (face,) = case.solution.faces
    assert isinstance(face, ContactFace)

    def above(g: sp.Expr) -> ExactSolution:
        return replace(case.solution, faces=(replace(face, initial_gap=g),))

    with pytest.raises(SelfProofError, match=r"\(2\.3\)"):
        prove(above(sp.Rational(1, 10) + s), "open")
    prove(above(s**2), "closed")
