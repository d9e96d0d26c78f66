"""Describes a case for ``cases.csv`` and ``study cases``.

The module imports no solvers, because importing them is slow.
"""

from typing import Any

from manufactured.case import Case
from manufactured.proved import proved_order


def describe(case: Case) -> dict[str, Any]:
    """Return the row of ``cases.csv`` for a case, as a dictionary: name of the column ↦ value."""
    motion = "moving" if case.regularity.moving else "no front" if case.regularity.gap == float("inf") else "fixed"
    return {
        "case": case.name,
        "summary": case.summary,
        "dimension": case.solution.body.dim,
        "law": case.solution.law.name,
        "zone": motion,
        "regularity": str(case.regularity),
        "expected_order": case.order,
        "proved_order": proved_order(case),
        "twin": case.twin,
        "statements": case.proposition if case.solution.has_initial_gap else f"{case.proposition}, Thm 4.2",
        "reason": case.reason,
    }
