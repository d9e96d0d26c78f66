"""Imports all public names of the package ``manufactured`` from the modules that define them."""

from manufactured.body import Body, BodyError, Kind, Part, box, polygon, unit_square
from manufactured.case import Case, CaseError
from manufactured.catalogue import catalogue, named
from manufactured.contact import ContactFace
from manufactured.data import Data, LoadError
from manufactured.evaluation import Evaluation, evaluate
from manufactured.exact import ExactSolution
from manufactured.face_strain import Memory, Prescribed
from manufactured.factor import Factor, x1, x2, x3
from manufactured.law import (
    Combined,
    DeviatoricBall,
    FrobeniusBall,
    Indefinite,
    KelvinVoigt,
    LawError,
    Linear,
    NonSymmetric,
    Yield,
    isotropic,
    isotropic_matrix,
)
from manufactured.profile import HERMITE, PARABOLA, QUARTIC, Profile, cutoff, layered, slab
from manufactured.regularity import Regularity
from manufactured.self_proof import SelfProofError, examine, prove
from manufactured.singular import Monomial, SingularFace, SingularField, TravellingField, kolosov
from manufactured.static import Static, plane_strain, plane_stress, static
from manufactured.symbols import FormulaError, pos, s, s1, s2, t

__all__ = [
    "HERMITE",
    "PARABOLA",
    "QUARTIC",
    "Body",
    "BodyError",
    "Case",
    "CaseError",
    "Combined",
    "ContactFace",
    "Data",
    "DeviatoricBall",
    "Evaluation",
    "ExactSolution",
    "Factor",
    "FormulaError",
    "FrobeniusBall",
    "Indefinite",
    "KelvinVoigt",
    "Kind",
    "LawError",
    "Linear",
    "LoadError",
    "Memory",
    "Monomial",
    "NonSymmetric",
    "Part",
    "Prescribed",
    "Profile",
    "Regularity",
    "SelfProofError",
    "SingularFace",
    "SingularField",
    "Static",
    "TravellingField",
    "Yield",
    "box",
    "catalogue",
    "cutoff",
    "evaluate",
    "examine",
    "isotropic",
    "isotropic_matrix",
    "kolosov",
    "layered",
    "named",
    "plane_strain",
    "plane_stress",
    "polygon",
    "pos",
    "prove",
    "s",
    "s1",
    "s2",
    "slab",
    "static",
    "t",
    "unit_square",
    "x1",
    "x2",
    "x3",
]
