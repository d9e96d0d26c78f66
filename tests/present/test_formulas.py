"""No numbered formula of the paper is left out without a reason."""

from dataclasses import asdict

import pandas as pd
import pytest

from study.ledger.verdict import HOLDS, NO_ROW, NOT_TESTED, named
from study.statements import STATEMENTS
from study.statements.pictures import Pictures
from study.statements.unmeasured import ROW_TEXTS, Listed, WithoutRow

FORMULAS = {2: 18, 3: 15, 4: 30, 5: 43}
"""Section of the paper ↦ number of the last formula in this section."""
THEOREMS = (
    "Problem 2.1", "Thm 2.2", "Problem 3.1", "Problem 3.2", "Thm 4.1", "Thm 4.2", "Thm 4.3", "Problem 5.1", "Thm 5.2",
    "Prop. 5.3", "Prop. 5.4",
)  # fmt: skip
NUMBERED = (*(f"({section}.{n})" for section, last in FORMULAS.items() for n in range(1, last + 1)), *THEOREMS)
"""All numbered formulas in the order of the paper, then all numbered statements."""


@pytest.fixture(scope="module")
def claims():
    """One row for each statement that is measured, and all lines of the others."""
    rows = []
    for statement in STATEMENTS:
        if isinstance(statement, Listed):
            rows += [asdict(line) for line in statement.judge(pd.DataFrame())]
        elif not isinstance(statement, Pictures):
            rows.append({"label": statement.label, "statement": statement.claim, "verdict": HOLDS})
    return pd.DataFrame(rows)


def test_every_number_of_the_paper_has_checks_or_a_reason_why_it_has_none(claims):
    has_reason = claims["label"].isin((NO_ROW, NOT_TESTED))
    texts = {*claims["label"][~has_reason], *claims["case"][has_reason]}
    assert set().union(*map(named, texts)) == set(NUMBERED)


def test_labels_name_formulas_of_the_source_and_lines_without_a_row_those_that_have_none(claims):
    for label, rows in claims[claims["label"] != "slips"].groupby("label"):
        places = rows["case"] if label in (NO_ROW, NOT_TESTED) else [label]
        assert set().union(*map(named, places)) <= set(NUMBERED), label
    # What is not tested may be a part of what is; a reason why there is no row would be wrong.
    measured = set().union(*(named(label) for label in set(claims["label"]) - {NO_ROW, NOT_TESTED, "slips"}))
    reasons = {place for place, _, _ in ROW_TEXTS[WithoutRow.texts].values()}
    assert {place: named(place) & measured for place in reasons if named(place) & measured} == {}
