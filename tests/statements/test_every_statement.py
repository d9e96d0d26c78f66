"""Every statement that lists its numbers: quick settings hold, each row can fail, and any part can be judged."""

import math
from dataclasses import replace
from importlib import import_module
from pkgutil import iter_modules

import pytest
from costly_cases import slow_unless
from measured_rows import quick_rows, verdicts

import study.statements
from study.ledger.files import UsageError
from study.ledger.verdict import FAILS, HOLDS, UNCLAIMED, UNDECIDED
from study.run.plan import quick
from study.statements.error_estimate import ErrorBounds, InterpolationInV, InterpolationOnContact
from study.statements.shared.base import Statement
from study.statements.shared.meshes import body_of, first_with_each, place, space_of
from study.statements.shared.scope import Levels
from study.statements.wellposed import BoundedVelocity, Dependence, Korn, NaturalConditions, OneTrajectory

EVOLUTION = OneTrajectory(), BoundedVelocity(), Dependence(), NaturalConditions(), ErrorBounds()
STATIC = Korn(), InterpolationInV(), InterpolationOnContact()
QUICK = Korn, OneTrajectory
"""Statements whose quick settings take less than a second."""


def each(*statements):
    items = [slow_unless(isinstance(one, QUICK), one, id=type(one).__name__) for one in statements]
    return pytest.mark.parametrize("statement", items)


@each(*STATIC, *EVOLUTION)
def test_two_cases_of_the_quick_settings_hold_and_each_case_is_judged_by_its_own_rows(statement):
    """The quick study has them all."""
    rows = quick_rows(statement)
    assert all(type(value) is float for value in rows["value"])
    found = statement.judge(rows)
    assert {verdict.case for verdict in found} == set(rows["case"])
    assert HOLDS in {verdict.verdict for verdict in found} <= {HOLDS, *UNCLAIMED}
    case = rows["case"].iloc[0]
    assert statement.judge(rows[rows["case"] == case]) == [verdict for verdict in found if verdict.case == case]
    assert statement.judge(rows.iloc[:0]) == []


@each(*STATIC, NaturalConditions(), ErrorBounds())
def test_one_level_decides_neither_orders_nor_changes(statement):
    rows = quick_rows(statement)
    found = verdicts(statement, rows[rows["level"] == rows["level"].min()]).values()
    assert UNDECIDED in found
    assert FAILS not in found


@each(*EVOLUTION)
def test_every_judged_row_can_fail_and_without_a_quantity_its_row_is_undecided(statement):
    rows = quick_rows(statement)
    for wrong in (math.nan, 5.0 * rows["level"] ** 3):
        assert set(verdicts(statement, rows.assign(value=wrong)).values()) - {*UNCLAIMED} == {FAILS}
    assert UNDECIDED in verdicts(statement, rows[rows["quantity"] == rows["quantity"].iloc[0]]).values()


def subclasses(cls):
    return {cls}.union(*map(subclasses, cls.__subclasses__()))


def test_every_statement_that_a_module_defines_has_its_place_in_the_ledger():
    for _, name, _ in iter_modules(study.statements.__path__, "study.statements."):
        import_module(name)
    defined = {one for one in subclasses(Statement) if one.__module__.startswith("study.") and hasattr(one, "label")}
    assert defined == {*study.statements.IN_ORDER}


def test_levels_are_moved_to_where_the_ends_of_parts_are_vertices():
    assert all(space_of(setting).dofs for setting in place(first_with_each(body_of), (5,), (2,), every_family=True))


# Studies that cannot be measured are refused before anything is solved.


ONE = replace(quick(), cases=("full-contact",))
SOFT = replace(quick(), cases=("full-contact", "softening"), scheme="backward-euler")


@pytest.mark.parametrize("scope", [ONE, SOFT, replace(ONE, k=1.0), replace(SOFT, k=0.25)])
def test_steps_up_to_the_final_time_and_short_enough_for_a_softening_law_are_accepted(scope):
    scope.check()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        *(({"k": k}, f"^the time step must be positive and at most T, got k = {k:g}") for k in (-0.1, 0.0, 1.01)),
        ({"k": 1.0}, r"^softening: .*backward-euler"),  # The problem of a step may have several solutions.
        *(
            ({kind: Levels(levels)}, message)
            for kind, levels, message in (
                ("plane", (), "got none"),
                ("rough", (1, 2), "got 1 2"),
                ("solid", (4, 4), "must increase"),
            )
        ),
    ],
    ids=str,
)
def test_impossible_time_steps_and_levels_are_refused(changes, message):
    with pytest.raises(UsageError, match=message):
        replace(SOFT, **changes).check()
