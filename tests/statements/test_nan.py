"""A value that is not a number makes its row fail, wherever it stands among the values of which a maximum is taken.

Python's ``max`` and ``min`` hide NaN unless it comes first; pandas leaves it out.
"""

import ast
import math
import re
from pathlib import Path

import pandas as pd
import pytest

from study.fem import independent
from study.ledger import quantities
from study.ledger.check import Check
from study.ledger.verdict import FAILS, HOLDS, CheckKind
from study.ledger.window import at_most
from study.solve import evolution
from study.statements import prop_5_4
from study.statements.shared.norms import maximum, minimum

MEASURING = [*Path(prop_5_4.__file__).parent.rglob("*.py"), *(Path(one.__file__) for one in (evolution, independent))]
NAN = math.nan


@pytest.mark.parametrize("place", range(3))
def test_extremes_of_values_with_nan_are_nan(place: int) -> None:
    values = [1.0, 2.0, 3.0]
    assert (maximum(values), minimum(values)) == (3.0, 1.0)
    values[place] = NAN
    assert all(math.isnan(extreme(values)) for extreme in (maximum, minimum))


NOT_MEASURED = {
    "own_cases.py": "levels, and the room in a hint",
    "pictures.py": "drawn, not judged",
    "scope.py": "levels",
    "thm_4_2_own_space.py": "predicted orders",
    "interpolation.py: min((float(table[REGULARITY].min()) for table in groups.values()))": "predicted regularity",
    "error_bounds.py: max(2 + L * T, on_rate)": "constants of the law",
    "wellposed.py: max(12, math.ceil(4 * solution.law.kappa * solution.body.T))": "a number of steps",
    "advancing_front.py: max(1, 2 * steps // INSTANTS)": "a number of steps",
    "rollers.py: max(1, found.steps // SAMPLED_PARTS)": "a number of steps",
    "eigen.py: min(LANCZOS, len(start))": "a number of vectors",
    "fully_discrete.py: min(COUNTS)": "numbers of steps",
    "estimates.py: max(SMALL, displacement(dim, n, 'shaken'))": "memory",
    "prop_5_4.py: min(MORE * steps, 2 * experiment.steps)": "a number of steps",
    "recomputed.py: max(norms[0], TINY * norms.max())": "norms.max() is NaN where norms[0] is not",
}
"""Files and calls of ``max`` and ``min`` that no measured value can make NaN, and why."""


def is_constant(node: ast.expr) -> bool:
    """A number, a name in capitals, or the smallest positive float."""
    named = isinstance(node, ast.Name) and node.id.isupper()
    return named or isinstance(node, ast.Constant) or ast.unparse(node) == "np.finfo(float).tiny"


def test_measured_values_pass_neither_through_the_extremes_of_python_nor_through_those_that_leave_nan_out() -> None:
    """max(x, c) with a constant c returns NaN if x is; any other call may hide it."""
    assert not [path for path in MEASURING if re.search(r"\bnan(max|min)\b|skipna", path.read_text())]
    found = {
        f"{path.name}: {ast.unparse(call)}"
        for path in MEASURING
        if path.name not in NOT_MEASURED
        for call in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id in ("max", "min")
        if not (len(call.args) == 2 and is_constant(call.args[1]))
    }
    assert found == {name for name in NOT_MEASURED if ":" in name}


@pytest.mark.parametrize(("value", "verdict"), [(1.5, HOLDS), (NAN, FAILS)])
def test_a_range_with_nan_in_one_family_does_not_hold(value: float, verdict: str) -> None:
    check = Check("a", "a", quantities.values("value"), at_most(2.0), CheckKind.CLAIM)
    groups = {name: pd.DataFrame({"h": 1.0, "value": [1.0, last]}) for name, last in (("b", 1.0), ("c", value))}
    assert check.verdict(prop_5_4.FirstOrder(), "case", groups).verdict == verdict
