"""Checks the docstring of a case: formulas first, then the predicted order with its reason."""

import re
from fractions import Fraction

from manufactured.case import INITIAL_GAP

FORMULAS = ("w =", "p =", "ψ =")
PREDICTION = re.compile(r"^Predicted order ([\d./]+)[^:]*: (.+?)(?=\n\n|\Z)", re.MULTILINE | re.DOTALL)
REASON = {"Prop. 5.4": "(5.36)", "Prop. 5.3": "H^{1+s}", INITIAL_GAP: "(5.36)"}


def missing_parts(docstring, case):
    """Returns what is missing of gap, pressure, zone and slip, and then of the predicted order and its reason."""
    text = (docstring or "").strip()
    found = PREDICTION.search(text)
    formulas = text[: found.start()] if found else text
    slips = any(getattr(face, "slip", ()) for face in case.solution.faces)
    missing = [
        part
        for part in (*FORMULAS, *["z ="] * slips)
        if not re.search(rf"^    .*{re.escape(part)}", formulas, re.MULTILINE)
    ]
    # An order that is no simple fraction is stated with four digits.
    if found is None or abs(float(Fraction(found[1])) - case.order) > 5e-5:
        return [*missing, f"Predicted order {case.order:.4g}: …"]
    return missing if REASON[case.proposition] in found[2] else [*missing, REASON[case.proposition]]
