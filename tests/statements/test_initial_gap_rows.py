"""The rows about cases with an initial gap are those of Propositions 5.3 and 5.4, and fail as these do."""

import numpy as np
import pandas as pd
import pytest
from test_propositions import prop_5_3, prop_5_4, table

from manufactured.case import INITIAL_GAP
from study.ledger.verdict import FAILS, Verdict
from study.statements.initial_gap import InitialGap

LEVELS = (8, 16, 32, 64)
WRONG = [
    *(("error", np.full(len(LEVELS), 0.1)), ("discrete_error", 3.0), ("time_share", 0.5), ("discrete_time_share", 0.9)),
    *(("residual", 1.0), ("clamped", 0.1), ("parallelogram", 0.1), ("quadrature_change", 0.1)),
    *(("initial_error", 5.0), ("predicted_interpolation", 1.0)),
]


def measured(order: float, **changes: object) -> pd.DataFrame:
    """Rows of a solid on several families, whose errors have an order; the last column says what is predicted."""
    families = ("one-diagonal", "criss-cross", "shaken")
    each = [table(order, LEVELS, INITIAL_GAP, family=family, **changes) for family in families]
    return pd.concat(each).assign(dim=3, expected_order=1.0)


def pairs(found: list[Verdict]) -> list[tuple[str, str]]:
    return [(verdict.key, verdict.verdict) for verdict in found]


def test_every_row_about_an_initial_gap_can_fail() -> None:
    keys = {key for key, _ in pairs(InitialGap().judge(measured(1.0)))}
    wrong = [measured(0.5), *(measured(1.0, **{column: value}) for column, value in WRONG)]
    assert {key for rows in wrong for key, verdict in pairs(InitialGap().judge(rows)) if verdict == FAILS} == keys


@pytest.mark.parametrize(
    ("order", "claim", "verdicts"),
    [(1.0, "Prop. 5.4", prop_5_4), (0.5, "Prop. 5.3", prop_5_3)],
    ids=["smooth", "rough"],
)
def test_a_case_has_the_verdicts_of_the_proposition_about_its_regularity(order: float, claim: str, verdicts) -> None:
    rows = measured(order).assign(expected_order=order)
    found = InitialGap().judge(rows)
    assert pairs(found) == pairs(verdicts(rows.assign(claim=claim), order))
    assert {row.label for row in found} == {INITIAL_GAP}
    assert InitialGap().judge(rows.assign(claim=claim)) == []
