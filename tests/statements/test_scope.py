"""Studies that cannot be measured are refused before anything is solved."""

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


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        *(({"k": k}, f"^the time step must be positive and at most T, got k = {k:g}") for k in (-0.1, 0.0, 1.01)),
        ({"k": 1.0}, r"^softening: .*backward-euler"),  # The problem of a step may have several solutions.
        *(
            ({kind: Levels(levels)}, message)
            for kind in ("plane", "rough", "solid")
            for levels, message in (
                ((), "got none"),
                ((1, 2), "got 1 2"),
                ((4, 4), "must increase"),
                ((8, 4), "increase"),
            )
        ),
    ],
    ids=str,
)
def test_impossible_time_steps_and_levels_are_refused(changes: dict[str, object], message: str) -> None:
    with pytest.raises(UsageError, match=message):
        replace(SOFT, **changes).check()
