"""Every statement that lists its numbers: quick settings hold, each row can fail, and any part can be judged."""

from __future__ import annotations

import math
from collections.abc import Iterable

import pytest
from measured_rows import quick_rows, verdicts

from manufactured import catalogue
from study.fem.naming import resolve
from study.ledger.verdict import FAILS, HOLDS, UNCLAIMED, UNDECIDED
from study.statements.admissibility import Admissibility
from study.statements.boundary import NaturalConditions
from study.statements.constitutive_law import ElasticityOperator, Projection, Viscosity
from study.statements.constraint import Interpolant, VertexConstraint
from study.statements.error_bounds import ErrorBounds
from study.statements.fully_discrete import FullyDiscrete
from study.statements.green import Green
from study.statements.interpolation import InterpolationInV, InterpolationOnContact
from study.statements.korn import Korn, Norms
from study.statements.lipschitz import Lipschitz
from study.statements.residual import Residual
from study.statements.shared.base import ListedNumbers
from study.statements.shared.meshes import EVERY, families, place, space_of
from study.statements.uniqueness import OneTrajectory
from study.statements.wellposed import BoundedVelocity, Dependence

EVOLUTION = (Admissibility(), OneTrajectory(), BoundedVelocity(), Dependence(), NaturalConditions(), ErrorBounds())
STATEMENTS: tuple[ListedNumbers, ...] = (
    *(Green(), Korn(), Viscosity(), ElasticityOperator(), Projection(), Norms(), Lipschitz(), VertexConstraint()),
    *(Interpolant(), InterpolationInV(), InterpolationOnContact(), Residual()),
    *EVOLUTION,
)
ONE_LEVEL_UNDECIDED = {
    Korn(): {"limit"},
    Norms(): {"settled-smallest", "settled-largest"},
    InterpolationInV(): {"smooth", "u-0.23", "u-0.61"},
    InterpolationOnContact(): {"smooth-face-1"},
    NaturalConditions(): {"loaded", "contact", "loaded-weakly", "tangential-weakly"},
    ErrorBounds(): {"steady-5.21", "steady-5.42"},
}
"""Rows that one level cannot decide: orders, and changes under refinement."""


def name(statement: ListedNumbers) -> str:
    return type(statement).__name__


DEAR = {Green(), BoundedVelocity(), Dependence(), ErrorBounds(), InterpolationInV(), NaturalConditions()}
"""Statements whose quick settings take two seconds and more."""


def each(statements: Iterable[ListedNumbers]) -> pytest.MarkDecorator:
    items = [pytest.param(one, id=name(one), marks=pytest.mark.slow if one in DEAR else ()) for one in statements]
    return pytest.mark.parametrize("statement", items)


@each(STATEMENTS)
def test_two_cases_of_the_quick_settings_hold(statement: ListedNumbers) -> None:
    """The quick study has them all."""
    rows = quick_rows(statement)
    assert all(type(value) is float for value in rows["value"])
    found = statement.judge(rows)
    assert {verdict.case for verdict in found} == set(rows["case"])
    assert HOLDS in {verdict.verdict for verdict in found} <= {HOLDS, *UNCLAIMED}
    assert {(verdict.label, verdict.statement) for verdict in found} == {(statement.label, statement.claim)}


@each(STATEMENTS)
def test_each_case_is_judged_by_its_own_rows_and_no_rows_give_no_verdict(statement: ListedNumbers) -> None:
    rows = quick_rows(statement)
    case = rows["case"].iloc[0]
    assert statement.judge(rows[rows["case"] == case]) == [v for v in statement.judge(rows) if v.case == case]
    assert statement.judge(rows.iloc[:0]) == []


@each(EVOLUTION)
def test_without_a_quantity_its_row_is_undecided(statement: ListedNumbers) -> None:
    rows = quick_rows(statement)
    assert UNDECIDED in verdicts(statement, rows[rows["quantity"] == rows["quantity"].iloc[0]]).values()


@each(ONE_LEVEL_UNDECIDED)
def test_one_level_decides_neither_orders_nor_changes(statement: ListedNumbers) -> None:
    rows = quick_rows(statement)
    found = statement.judge(rows[rows["level"] == rows["level"].min()])
    assert {verdict.key for verdict in found if verdict.verdict == UNDECIDED} >= ONE_LEVEL_UNDECIDED[statement]
    assert FAILS not in {verdict.verdict for verdict in found}


@each(EVOLUTION)
@pytest.mark.parametrize("wrong", ["large and growing", "not a number"])
def test_every_judged_row_can_fail(statement: ListedNumbers, wrong: str) -> None:
    rows = quick_rows(statement)
    rows = rows.assign(value=math.nan if wrong == "not a number" else 5.0 * rows["level"] ** 3)
    assert set(verdicts(statement, rows).values()) - {*UNCLAIMED} == {FAILS}


@pytest.mark.parametrize("statement", [*STATEMENTS, FullyDiscrete()], ids=name)
def test_settings_are_different_and_name_families_that_mesh_their_bodies(statement: ListedNumbers) -> None:
    for full in (False, True):
        settings = statement.places(full)
        assert len(set(settings)) == len(settings)
        assert all(setting.family in families(resolve(setting.case)) for setting in settings)
    assert settings


def test_levels_are_moved_to_where_the_ends_of_parts_are_vertices() -> None:
    for setting in place(catalogue(), EVERY, (5,), (2,)):
        assert space_of(setting).dofs > 0
