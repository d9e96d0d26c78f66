"""Exact solutions with an initial gap: u_ν ≤ g on Γ3, w = g − u_ν."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from costly_cases import by_cost

from manufactured import Case, ContactFace, FormulaError, named, pos, prove, s, t
from manufactured.case import INITIAL_GAP, CaseError
from manufactured.self_proof import SelfProofError

CASES = ("closing-gap", "parabolic-gap", "cube-bowl")
HALF = sp.Rational(1, 2)


def with_gap(g: sp.Expr, name: str = "parabolic-gap") -> Case:
    """A case with another initial gap."""
    case = named(name)
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


def test_no_statement_of_the_paper_is_about_a_gap_other_than_zero() -> None:
    assert {named(name).proposition for name in CASES} == {INITIAL_GAP}
    assert with_gap(sp.Integer(0)).proposition == "Prop. 5.4"


@pytest.mark.parametrize(
    ("g", "error", "message"),
    [
        (s * t, FormulaError, "depends on t"),
        (s - sp.Rational(1, 3), FormulaError, r"is -0\.3333 at s = 0, where .* penetrate"),
        (abs(s - HALF), FormulaError, "write fronts with pos"),
        (sp.Symbol("x"), FormulaError, "has x"),
        (pos(s - HALF, 1), CaseError, "a front that stays with α = 1"),
        (pos(s - HALF, sp.Rational(9, 4)), CaseError, r"a front that stays with α = 2\.25"),
        (sp.sqrt(s), CaseError, "not known to be smooth"),
    ],
)
def test_a_formula_that_is_no_gap_or_has_fronts_that_the_label_does_not_state_is_refused(g, error, message) -> None:
    with pytest.raises(error, match=message):
        with_gap(g)


def test_a_gap_that_is_open_where_contact_meets_the_clamp_is_no_solution() -> None:
    """u = 0 on Γ1, so g = w where Γ3 ends at Γ1."""
    with pytest.raises(SelfProofError, match=r"\(2\.3\)"):
        prove(with_gap(sp.Rational(1, 10) + s, "contact-at-clamp").solution, "open")
    prove(with_gap(s**2, "contact-at-clamp").solution, "closed")
