"""A case: an exact solution with the order that is predicted for it, and why."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.profile import ZERO
from manufactured.regularity import Regularity, read_off
from manufactured.singular import SingularFace


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
        faces = self.solution.faces
        lifted = [face for face in faces if not isinstance(face, SingularFace)]
        alpha, m, moving = read_off([face.gap for face in lifted], [face.exponents_in for face in lifted])
        if any(isinstance(face, ContactFace) and face.profile.e is not ZERO for face in lifted):
            # u_s ~ ∇_s q, as regular as ∇_s w is for α = m + 1.
            alpha = min(alpha, m + 1)
        singular = [face for face in faces if isinstance(face, SingularFace)]
        trace, traction, _ = read_off([face.gap for face in singular], [face.exponents_in for face in singular])
        label = self.regularity
        too_smooth = label.gap > alpha or label.pressure > m or label.on_contact > min(trace, traction + 1)
        if too_smooth or (moving and not label.moving):
            raise CaseError(
                f"case {self.name}: labelled {label}, but its formulas have α = {alpha:g}, m = {m:g}"
                f"{' of a moving front' if moving else ''}, r^{min(trace, traction + 1):g} on Γ3; correct the label"
            )

    @property
    def proposition(self) -> str:
        """The numbered statement whose hypotheses the case satisfies."""
        return self.regularity.proposition
