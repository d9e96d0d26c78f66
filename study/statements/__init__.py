"""The numbered statements that are measured one by one; those on orders of convergence are in ``claims``."""

from __future__ import annotations

from study.statements.admissibility import Admissibility
from study.statements.boundary import NaturalConditions
from study.statements.bounds import ErrorBounds
from study.statements.constraint import Interpolant, VertexConstraint
from study.statements.fully_discrete import FullyDiscrete
from study.statements.green import Green
from study.statements.hypercircle import Hypercircle
from study.statements.interpolation import InterpolationInV, InterpolationOnContact
from study.statements.korn import Korn
from study.statements.law import ElasticityOperator, Projection, Viscosity
from study.statements.lipschitz import Lipschitz
from study.statements.norms import Norms
from study.statements.residual import Residual
from study.statements.shared.base import Statement
from study.statements.slips import SLIPS
from study.statements.stress_uniqueness import OneStress
from study.statements.thm_4_2.stands_alone import StandsAlone
from study.statements.untested import UNTESTED
from study.statements.wellposed import BoundedVelocity, Dependence, OneTrajectory

STATEMENTS: tuple[Statement, ...] = (
    Green(),
    Korn(),
    Dependence(),
    Viscosity(),
    ElasticityOperator(),
    Projection(),
    Norms(),
    Admissibility(),
    BoundedVelocity(),
    OneTrajectory(),
    OneStress(),
    Lipschitz(),
    NaturalConditions(),
    StandsAlone(),
    Hypercircle(),
    VertexConstraint(),
    Interpolant(),
    ErrorBounds(),
    Residual(),
    InterpolationInV(),
    InterpolationOnContact(),
    FullyDiscrete(),
    SLIPS,
    UNTESTED,
)
"""In the order of the source."""

ORDERS = ("data", "Prop. 5.4", "Prop. 5.3", "axes", "(5.36)", "Thm 4.2", "Thm 4.2, own space", "bound", "enclosure")
"""The statements of ``claims``, which head the ledger."""


def position(label: str) -> int:
    """Where a label stands in the ledger."""
    labels = [*ORDERS, *(statement.label for statement in STATEMENTS)]
    return labels.index(label)
