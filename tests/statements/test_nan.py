"""A value that is not a number makes its row fail, wherever it stands among the values of which a maximum is taken.

Python's ``max`` and ``min`` hide NaN unless it comes first; pandas leaves it out.
"""

import math

import pandas as pd
import pytest

from study.ledger.check import Check
from study.ledger.verdict import FAILS, HOLDS, CheckKind
from study.ledger.window import at_most
from study.statements import prop_5_4
from study.statements.shared.norms import maximum, minimum

NAN = math.nan


@pytest.mark.parametrize("place", range(3))
def test_extremes_of_values_with_nan_are_nan(place):
    values = [1.0, 2.0, 3.0]
    assert (maximum(values), minimum(values)) == (3.0, 1.0)
    values[place] = NAN
    assert all(math.isnan(extreme(values)) for extreme in (maximum, minimum))


@pytest.mark.parametrize(("value", "verdict"), [(1.5, HOLDS), (NAN, FAILS)])
def test_a_range_with_nan_in_one_family_does_not_hold(value, verdict):
    check = Check("a", "a", "value", at_most(2.0), CheckKind.CLAIM)
    groups = {name: pd.DataFrame({"h": 1.0, "value": [1.0, last]}) for name, last in (("b", 1.0), ("c", value))}
    assert check.verdict(prop_5_4.FirstOrder(), "case", groups).verdict == verdict
