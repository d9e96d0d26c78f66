"""No numbered formula of the paper is left out without a reason."""

from dataclasses import asdict

import pandas as pd
import pytest

from study.ledger.datafiles import DataError
from study.ledger.verdict import HOLDS, NO_ROW, NOT_TESTED, NUMBERED, named
from study.present.pages import numbered_lines
from study.statements import STATEMENTS
from study.statements.pictures import Pictures
from study.statements.unmeasured import ROW_TEXTS, Listed, WithoutRow


@pytest.fixture(scope="module")
def claims() -> pd.DataFrame:
    """One row for each statement that is measured, and all lines of the others."""
    rows = []
    for statement in STATEMENTS:
        if isinstance(statement, Listed):
            rows += [asdict(line) for line in statement.judge(pd.DataFrame())]
        elif not isinstance(statement, Pictures):
            rows.append({"label": statement.label, "statement": statement.claim, "verdict": HOLDS})
    return pd.DataFrame(rows)


def test_none_is_missing(claims: pd.DataFrame) -> None:
    """``numbered_lines`` raises an error for a missing number; the table has the order of the source."""
    lines = [numbers for numbers, _, _ in numbered_lines(claims)]
    first = [numbers.partition("–")[0] for numbers in lines]
    assert first == sorted(first, key=NUMBERED.index)
    assert named(", ".join(lines).replace("Problem 3.1–Problem 3.2", "Problem 3.1, 3.2")) == set(NUMBERED)
    without = claims[claims["label"] != "(5.27)"]
    with pytest.raises(DataError, match=r"neither rows nor a reason for \(5\.27\)"):
        list(numbered_lines(without))


def test_labels_name_formulas_of_the_source_and_lines_without_a_row_those_that_have_none(claims: pd.DataFrame) -> None:
    for label, rows in claims[claims["label"] != "slips"].groupby("label"):
        places = rows["case"] if label in (NO_ROW, NOT_TESTED) else [label]
        assert set().union(*map(named, places)) <= set(NUMBERED), label
    # What is not tested may be a part of what is; a reason why there is no row would be wrong.
    measured = set().union(*(named(label) for label in set(claims["label"]) - {NO_ROW, NOT_TESTED, "slips"}))
    reasons = {place for place, _, _ in ROW_TEXTS[WithoutRow.texts].values()}
    assert {place: named(place) & measured for place in reasons if named(place) & measured} == {}
