"""Rows of the ledger that test a proved relation between computed numbers.

Such a row fails only if the code is wrong: the relation holds on every mesh and for every solution. It is no evidence
for a claim about convergence. A row with a predicted lower end and a proved upper end is not listed, as it can miss
its lower end.
"""

from __future__ import annotations

THEOREMS: dict[str, tuple[str, ...]] = {
    "Thm 2.2": ("bound", "monotone"),
    "Thm 2.2, (4.4)": ("bound",),
    "(3.3)": ("expansion", "membership"),
    "(3.6)": ("lower", "upper"),
    "Thm 4.2": ("displacement", "stress"),
    "(4.3), (5.5)": ("constant", "pointwise", "monotonicity"),
    "(5.20)–(5.21), (5.42)": ("constant-5.21", "constant-5.42"),
    "(5.21), T and L_G/m_A": ("bound", "time"),
    "(5.27)": ("bound", "prestress", "attained"),
    "Prop. 5.3": ("parallelogram",),
    "Prop. 5.4": ("parallelogram",),
    "(5.40), (5.41)": ("bound",),
    "beyond: nodal start": ("proved",),
    "beyond: work on edges": ("solution", "all", "constant"),
    "beyond: rollers": ("bound",),
    "beyond: O(h + k)": ("data", "solution", "constant", "midpoint"),
    "beyond: O(h + k), no potential": ("data-equal", "data-unequal", "solution-equal", "solution-unequal"),
    "beyond: landings": ("backward-euler-two", "midpoint-two"),
    "bound": ("above",),
    "enclosure": ("above", "below"),
}
"""Label ↦ keys of inequalities, and of the parallelogram law."""
EXACT_QUOTIENTS: dict[str, tuple[str, ...]] = {
    "(3.1)": ("ellipticity", "bound"),
    "(3.2)": ("lipschitz",),
    "Thm 4.2": ("alone-displacement", "alone-stress"),
    "(4.12)": ("bounded", "unbounded"),
}
"""Label ↦ keys of quotients that are 1 by linear algebra or by quadrature of the exact solution alone. Their windows
are wider than rounding, and no discretisation enters them."""


def is_theorem(label: str, key: str) -> bool:
    """Return whether the rows with this label and key test a proved relation."""
    return key in THEOREMS.get(label, ())


def is_exact_quotient(label: str, key: str) -> bool:
    """Return whether the rows with this label and key compare a number with itself, computed in another way."""
    return key in EXACT_QUOTIENTS.get(label, ())
