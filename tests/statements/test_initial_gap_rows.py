"""The rows about cases with an initial gap are those of Propositions 5.3 and 5.4, and fail as these do."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from test_propositions import table

from manufactured.case import INITIAL_GAP
from study.ledger.verdict import FAILS, Verdict
from study.statements.from_rates import SizeOfInterpolation
from study.statements.initial_gap import InitialGap
from study.statements.prop_5_3 import Convergence
from study.statements.prop_5_4 import FirstOrder

LEVELS = (8, 16, 32, 64)
FAMILIES = ("one-diagonal", "criss-cross", "shaken", "unstructured")


def measured(order: float, **changes: float) -> pd.DataFrame:
    """Rows of a solid on several families, whose errors have an order; the last column says what is predicted."""
    each = [table(order, LEVELS, INITIAL_GAP, family=family, **changes) for family in FAMILIES]
    return pd.concat(each).assign(dim=3, expected_order=1.0)


def failing(found: list[Verdict]) -> set[str]:
    return {verdict.key for verdict in found if verdict.verdict == FAILS}


WRONG = [
    *(("error", np.full(len(LEVELS), 0.1)), ("discrete_error", 3.0), ("time_share", 0.5), ("discrete_time_share", 0.9)),
    *(("residual", 1.0), ("clamped", 0.1), ("parallelogram", 0.1), ("quadrature_change", 0.1)),
    *(("initial_error", 5.0), ("predicted_interpolation", 1.0)),
]


def test_every_row_about_an_initial_gap_can_fail() -> None:
    keys = {verdict.key for verdict in InitialGap().judge(measured(1.0))}
    wrong = [measured(0.5), *(measured(1.0, **{column: value}) for column, value in WRONG)]
    assert set().union(*(failing(InitialGap().judge(rows)) for rows in wrong)) == keys


@pytest.mark.parametrize("changes", [{}, *({column: value} for column, value in WRONG)], ids=lambda one: "".join(one))
def test_a_smooth_solution_has_the_verdicts_of_proposition_5_4(changes: dict[str, object]) -> None:
    rows = measured(1.0, **changes)
    same = rows.assign(claim="Prop. 5.4")
    expected = [*FirstOrder().judge(same), *SizeOfInterpolation().judge(same)]
    found = InitialGap().judge(rows)
    assert [(row.key, row.verdict) for row in found] == [(row.key, row.verdict) for row in expected]
    assert {row.label for row in found} == {INITIAL_GAP}


def test_a_rough_solution_has_the_verdicts_of_proposition_5_3() -> None:
    rows = measured(0.5).assign(expected_order=0.5)
    expected = Convergence().judge(rows.assign(claim="Prop. 5.3"))
    assert [(row.key, row.verdict) for row in InitialGap().judge(rows)] == [(row.key, row.verdict) for row in expected]


def test_other_cases_have_no_row() -> None:
    assert InitialGap().judge(measured(1.0).assign(claim="Prop. 5.4")) == []
