"""A case: an exact solution, its regularity, the predicted order of convergence, and the reason for this order."""

import math
import re
from collections.abc import Iterable
from dataclasses import astuple, dataclass, fields, replace
from typing import Any

import numpy as np
import sympy as sp

from manufactured.arguments import checked
from manufactured.contact import ContactFace, Face
from manufactured.exact import ExactSolution
from manufactured.face_formula import FaceFormula, read_off
from manufactured.face_strain import Memory, Prescribed
from manufactured.profile import ZERO
from manufactured.regularity import Regularity
from manufactured.self_proof import INITIAL_GAP_ADVICE
from manufactured.singular import SingularFace, SingularField, TravellingField
from manufactured.symbols import t

FIXED = 2.5
"""A fixed contact front lowers the regularity only if the exponent of the strain there is at most this number.

Such fronts occur if the body starts in elastic equilibrium, since then the normal strain is q(0) = −p(0)/g, with the
contact pressure p and the normal modulus g of the elasticity.
"""
INITIAL_GAP = "beyond: initial gap"
"""The label of the statement on cases with an initial gap, which are beyond the paper."""
UNSTATED: Any = None
"""Default of ``Case.order``. A case whose order is not stated is refused."""


class CaseError(ValueError):
    """Raised if attributes of a case contradict each other, are missing or invalid, or if no case has a given name."""


@dataclass(frozen=True, eq=False)
@checked(CaseError)
class Case:
    """An exact solution with the order of convergence that is predicted for it, and the reason for this order.

    Attributes:
        name: the name in commands, files and tables.
        summary: one line on the motion of the contact zone.
        solution: the exact solution.
        regularity: the exponents of gap and pressure at the least smooth contact fronts; they must agree with the
            formulas of the solution.
        order: the predicted order of ‖u − u^h‖_{L∞(0,T;V)}.
        reason: why the regularity gives this order, in one sentence.
        pace: the number of time steps per unit of time, divided by n^{2/3} on the mesh of level n, which has about n
            cells along a side. Fast fronts need a larger pace. It is large enough if the time discretisation causes a
            small share of the error.
        twin: the name of another case whose errors on structured meshes must be equal to the errors of this case, up to
            round-off; "" if there is none.
        families: the names of the mesh families on which a quick run of the study measures this case. By default the
            case is measured on the first family that can mesh the body.

    Raises:
        CaseError: the exponents cannot be read off the formulas, the regularity or the predicted order contradicts
            them, the order or the reason is missing, the pace is not positive, or the name cannot be part of a file
            name.
    """

    name: str
    summary: str
    solution: ExactSolution
    regularity: Regularity
    order: float = UNSTATED
    reason: str = ""
    pace: float = 8.0
    twin: str = ""
    families: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9._-]{,99}", self.name):
            raise CaseError(
                f"case name {self.name!r}: begin with a letter or digit, and use at most 100 letters, digits, '.', '-' "
                "and '_'"
            )
        if self.order is None or not self.reason:
            raise CaseError(
                f"case {self.name}: a case needs an order predicted before it is measured, and the reason for it; got "
                f"order={self.order}, reason={self.reason!r}; derive the order from the exponents and state both, for "
                "example order=1, reason='α = 4 > 7/2 and m = 2 > 3/2 give (5.36)'"
            )
        if self.pace <= 0:
            raise CaseError(f"case {self.name}: the pace must be positive, got {self.pace}")
        self._compare_with_formulas()
        if abs(self.order - self.regularity.order) > 1e-12:
            raise CaseError(
                f"case {self.name}: predicted order {self.order}, but {self.regularity} "
                f"gives min(1, s) = {self.regularity.order:g}, u(t) ∈ H^(1+s) for s < {self.regularity.smoothness:g}; "
                "correct the label or the prediction"
            )

    def _compare_with_formulas(self) -> None:
        """Raise CaseError if the stated regularity differs from the regularity that the formulas have."""
        label, T = self.regularity, self.solution.body.T
        lifted = [face for face in self.solution.faces if not isinstance(face, SingularFace)]
        gaps = [formula for face in lifted for formula in _gap_formulas(face, T)]
        strains = [formula for face in lifted for formula in _strain_formulas(face, T)]
        if any(piece.formula.has(sp.nan, sp.zoo, sp.oo) for piece in (*gaps, *strains)):
            return  # Such formulas have no exponents; the self-proof reports the invalid values.
        try:
            found = self._found(*read_off(gaps, strains))
        except ValueError as error:
            raise CaseError(f"case {self.name}: {error}") from error
        if not all(math.isclose(stated, read) for stated, read in zip(astuple(label), astuple(found), strict=True)):
            stated = {f.name: getattr(found, f.name) for f in fields(found) if getattr(found, f.name) != f.default}
            remedy = (
                f"correct the label to Regularity({', '.join(f'{name}={value!r}' for name, value in stated.items())}), "
                "or the formulas"
            )
            if math.isinf(found.gap) and math.isfinite(label.gap) and math.isfinite(found.pressure):
                remedy = f"the pressure has a front and the gap has none. {INITIAL_GAP_ADVICE}"
            raise CaseError(f"case {self.name}: labelled {label}, but its formulas say {found}; {remedy}")

    def _found(self, alpha: float, m: float, moving: bool) -> Regularity:
        """Return the regularity of the solution according to its formulas.

        Args:
            alpha: the lowest exponent of the gap at a front.
            m: the lowest exponent of the pressure or of the strain at a front.
            moving: whether a front moves.
        """
        solution = self.solution
        if any(isinstance(face, ContactFace) and face.profile.e is not ZERO for face in solution.faces):
            # The displacement u_s contains the derivative ∇_s q of the strain q. So a fixed front of q with the
            # exponent m acts like a front of the gap with α = m. At a moving front q̇ ~ p, so q has the exponent m + 1.
            alpha = min(alpha, m + 1 if moving and m > FIXED else m)
        drawn = {_plane(seam.normal, float(seam.normal @ seam.start)) for seam in solution.body.interfaces}
        singular = [face.field for face in solution.faces if isinstance(face, SingularFace)]
        return Regularity(
            gap=alpha,
            pressure=m,
            moving=moving or any(isinstance(field, TravellingField) for field in singular),
            corner=_least(field for field in solution.others if isinstance(field, SingularField)),
            on_contact=_least(singular),
            kink=any(_plane(*step) not in drawn for step in solution.law.steps),
        )

    @property
    def proposition(self) -> str:
        """The label of the statement that applies to the case.

        It is a proposition of the paper, or ``INITIAL_GAP`` if the case has an initial gap, which the paper does not
        treat.
        """
        return INITIAL_GAP if self.solution.has_initial_gap else self.regularity.proposition


def _gap_formulas(face: Face, T: float) -> list[FaceFormula]:
    """Return the formula of the gap w, and of the initial gap g if it is not 0."""
    gap = FaceFormula(face.gap, face.part, face.variables, 0.0, T)
    # Kinks of the initial gap lower the regularity of u as fixed fronts of the gap do.
    return [gap] if face.initial_gap == 0 else [gap, replace(gap, formula=face.initial_gap, end=0.0)]


def _strain_formulas(face: Face, T: float) -> list[FaceFormula]:
    """Return the formulas that show how smooth the strain on a face is."""
    strain = getattr(face, "strain", None)
    # The formulas are kept separate, because fronts may cancel in their sum.
    if isinstance(strain, Prescribed):
        ends = [*(min(end, T) for end, _ in strain.phases[:-1]), T]
        phases = zip(strain.phases, [0.0, *ends], ends, strict=False)
        # The rate q̇ is included because p ~ a q̇ + g q, so at a moving front p has one power less than q.
        pieces = [(f, begin, end) for (_, q), begin, end in phases for f in (q, q.diff(t))]
    elif isinstance(strain, Memory):
        pieces = [(f, 0.0, T) for f in (strain.load, strain.initial) if f is not None]
    else:
        pieces = [(face.exponents_in, 0.0, T)]
    # At a front u_s ~ z is as smooth as y q, so an exponent of z or ż counts like an exponent of the strain.
    pieces += [(f, 0.0, T) for z in getattr(face, "slip", ()) for f in (z, z.diff(t))]
    return [FaceFormula(f, face.part, face.variables, begin, end) for f, begin, end in pieces]


def _least(fields: Iterable[SingularField | TravellingField]) -> float:
    """Return the smallest exponent λ of singular fields r^λ; infinity without fields."""
    return min((field.exponent for field in fields), default=math.inf)


def _plane(normal: Iterable[float], offset: float) -> tuple[float, ...]:
    """Return unit normal and offset of a line or plane, rounded, so that equal planes give equal results.

    The result is the same for both orientations of the normal.
    """
    values = np.round([*normal, offset], 9)
    # Adding 0 and subtracting from 0 turn −0 into 0.
    return max(tuple(0.0 + values), tuple(0.0 - values))


def proved_order(case: Case) -> float:
    """Return the largest order of ‖u − u^h‖_{L∞(0,T;V)} on uniform meshes that is proved for a case (a supremum).

    Several proofs give an order, and the largest one is returned. The proof of Prop. 5.4 gives
    ``Regularity.proved_order``, which also depends on the trace u_ν ∈ H^τ(Γ3). In 2D there are two theorems without an
    assumption on the trace of u:

    * u ∈ W^{1,1}(0,T;H^{1+r}) with 1/2 < r ≤ 1 gives the order r (paper/trace.tex).
    * u ∈ L²(0,T;H^{1+s}), u̇ ∈ L¹(0,T;H^{1+r}) with 0 < r ≤ s ≤ 1 and σ_ν ∈ L²(0,T;L^p(Γ3)) with p ≤ 2 give the order
      min(max(3s/5, r), (s + 1 − 1/p)/2), for loads of bounded variation in time (paper/velocity.tex).

    The theorem on natural fronts (paper/fronts.tex) is left out, because it depends on the speed of fronts and on the
    corners of the body.
    """
    regularity = case.regularity
    r, s = min(1.0, regularity.rate_smoothness), min(1.0, regularity.smoothness)
    source = regularity.proved_order
    if case.solution.body.dim != 2 or r <= 0:
        return source
    # Near a singular point on Γ3, σ_ν ~ r^{λ−1}, or r^{λ−2} if the point moves.
    inverse_p = max(0.5, 1 + regularity.moving - regularity.on_contact)
    half_derivative = min(max(0.6 * s, r), (s + 1 - inverse_p) / 2)
    return max(source, half_derivative, r if r > 0.5 else 0.0)
