"""Studies that cannot be measured are refused before anything is solved."""

from __future__ import annotations

from dataclasses import replace

import pytest

from study.ledger.files import UsageError
from study.run.plan import quick
from study.statements.shared.scope import Levels, Scope

ONE = replace(quick(), cases=("full-contact",))
SOFT = replace(quick(), cases=("full-contact", "softening"), scheme="backward-euler")


@pytest.mark.parametrize("scope", [ONE, SOFT, replace(ONE, k=1.0), replace(SOFT, k=0.25)], ids=["1", "2", "3", "4"])
def test_steps_up_to_the_final_time_and_short_enough_for_a_softening_law_are_accepted(scope: Scope) -> None:
    scope.check()


@pytest.mark.parametrize("k", [-0.1, 0.0, 1.01])
def test_time_steps_that_are_not_positive_or_longer_than_T_are_refused(k: float) -> None:
    with pytest.raises(UsageError, match=f"the time step must be positive and at most T, got k = {k:g}"):
        replace(ONE, k=k).check()


def test_a_step_of_a_softening_law_that_may_have_several_solutions_is_refused_with_the_name_of_the_case() -> None:
    with pytest.raises(UsageError, match=r"^softening: .*backward-euler"):
        replace(SOFT, k=1.0).check()


@pytest.mark.parametrize(
    ("levels", "message"),
    [((), "got none"), ((1, 2), "got 1 2"), ((4, 4), "levels must increase"), ((8, 4), "levels must increase")],
)
@pytest.mark.parametrize("kind", ["plane", "rough", "solid"])
def test_levels_below_two_or_not_increasing_are_refused(kind: str, levels: tuple[int, ...], message: str) -> None:
    with pytest.raises(UsageError, match=message):
        replace(ONE, **{kind: Levels(levels)}).check()
