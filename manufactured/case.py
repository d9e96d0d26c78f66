"""A case: an exact solution with the order that is predicted for it, and why."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np

from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.profile import ZERO
from manufactured.regularity import Regularity, read_off
from manufactured.singular import SingularFace, SingularField, least_exponent
from manufactured.tensors import Array

FIXED = 2.5
"""m from which a fixed front in q, such as that of an elastic start, costs nothing in an upper layer."""


class CaseError(ValueError):
    """A case contradicts itself."""


@dataclass(frozen=True, eq=False)
class Case:
    """One entry of the catalogue.

    Attributes:
        name: identifier in commands, files and tables.
        summary: one line on what the zone does.
        solution: the exact solution.
        regularity: the exponents at its front.
        order: the predicted order of ‖u − u^h‖_{L∞(0,T;V)}.
        reason: regularity → order, in one sentence.
        pace: time steps per n^{2/3} at level n that make the time error negligible; faster zones
            need more, and every row of a rate table shows whether it was enough.
        twin: name of a case whose errors this one must have to round-off on structured meshes, or "".

    Raises:
        CaseError: the predicted order is missing or contradicts the exponents, or the name cannot
            be part of a file name.
    """

    name: str
    summary: str
    solution: ExactSolution
    regularity: Regularity
    order: float
    reason: str
    pace: float = 8.0
    twin: str = ""

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9._-]*", self.name):
            raise CaseError(f"case name {self.name!r}: use letters, digits, '.', '-' and '_' only")
        if self.order is None or not math.isfinite(self.order) or not self.reason:
            raise CaseError(f"case {self.name}: state the predicted order and the reason for it before measuring")
        if not (math.isfinite(self.pace) and self.pace > 0):
            raise CaseError(f"case {self.name}: the pace must be positive, got {self.pace}")
        self._compare_with_formulas()
        if abs(self.order - self.regularity.order) > 1e-12:
            raise CaseError(
                f"case {self.name}: predicted order {self.order}, but {self.regularity} "
                f"gives min(1, s) = {self.regularity.order:g}, u(t) ∈ H^(1+s) for s < {self.regularity.smoothness:g}; "
                "correct the label or the prediction"
            )

    def _compare_with_formulas(self) -> None:
        """The label must not promise more than the exponents in the formulas give."""
        solution, label = self.solution, self.regularity
        lifted = [face for face in solution.faces if isinstance(face, ContactFace)]
        alpha, m, moving = read_off([face.gap for face in lifted], [face.exponents_in for face in lifted])
        if any(face.profile.e is not ZERO for face in lifted):
            # u_s ~ ∇_s q: for a fixed front as regular as ∇_s w for α = m, for a moving one q̇ ~ p gives α = m + 1.
            alpha = min(alpha, m + 1 if moving and m > FIXED else m)
        on_contact = least_exponent(face.field for face in solution.faces if isinstance(face, SingularFace))
        corner = least_exponent(field for field in solution.others if isinstance(field, SingularField))
        drawn = {_plane(seam.normal, seam.start) for seam in solution.body.interfaces}
        unmet = any(
            _plane(np.array(direction), offset * np.array(direction)) not in drawn
            for direction, offset in solution.law.steps
        )
        found = {"α": (label.gap, alpha), "m": (label.pressure, m), "λ on Γ3": (label.on_contact, on_contact)}
        found["λ at corners"] = label.corner, corner
        wrong = [f"{name} = {value:g}" for name, (promised, value) in found.items() if promised > value * (1 + 1e-9)]
        wrong += ["a moving front"] * (moving and not label.moving)
        wrong += ["a jump of the material that meshes do not follow"] * (unmet and not label.kink)
        if wrong:
            raise CaseError(f"case {self.name}: labelled {label}, but it has {', '.join(wrong)}; correct the label")

    @property
    def proposition(self) -> str:
        """The numbered statement whose hypotheses the case satisfies."""
        return self.regularity.proposition


def _plane(normal: Array, point: Array) -> tuple[float, ...]:
    """A line or plane by its unit normal and offset, rounded, in one of its two orientations."""
    values = np.round([*normal, normal @ point], 9) + 0.0
    return tuple(float(v) for v in (values if tuple(values) > tuple(-values) else -values + 0.0))
