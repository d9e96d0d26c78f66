"""The continuous problem: laws, bodies and exact solutions with prescribed contact zones.

Everything is dimensionless. Nothing here knows a mesh, so any discretisation can use it. A case is
built from a gap and a pressure, formulas of the coordinate ``s`` along a face and the time ``t``;
``pos(x, a)`` is the truncated power x_+^a.
"""

from manufactured.admissibility import SelfProofError, examine, prove
from manufactured.body import Body, BodyError, Kind, Part, polygon, unit_square
from manufactured.case import Case, CaseError
from manufactured.catalogue import catalogue
from manufactured.contact import HERMITE, PARABOLA, ContactFace
from manufactured.exact import ExactSolution
from manufactured.law import (
    DeviatoricBall,
    FrobeniusBall,
    KelvinVoigt,
    LawError,
    Linear,
    Yield,
    isotropic,
)
from manufactured.memory import Memory, Prescribed
from manufactured.regularity import Regularity
from manufactured.symbols import FormulaError, pos, s, t

__all__ = [
    "HERMITE",
    "PARABOLA",
    "Body",
    "BodyError",
    "Case",
    "CaseError",
    "ContactFace",
    "DeviatoricBall",
    "ExactSolution",
    "FormulaError",
    "FrobeniusBall",
    "KelvinVoigt",
    "Kind",
    "LawError",
    "Linear",
    "Memory",
    "Part",
    "Prescribed",
    "Regularity",
    "SelfProofError",
    "Yield",
    "catalogue",
    "examine",
    "isotropic",
    "polygon",
    "pos",
    "prove",
    "s",
    "t",
    "unit_square",
]
