"""The list of all statements that the study measures and judges, in the order of the paper.

Statements that go beyond the paper come last.
"""

from study.statements.contact_force import ContactForce
from study.statements.enclosure import BoundedError, EnclosedError
from study.statements.error_estimate import (
    ErrorBounds,
    InterpolationInV,
    InterpolationOnContact,
    NodalStart,
    ResidualBound,
)
from study.statements.moving_fronts import AdvancingFront, HalfDerivative, NodalErrors
from study.statements.other_solvers import OtherCodes, Recomputed
from study.statements.pictures import Pictures
from study.statements.prop_5_4 import Convergence, FirstOrder, InitialGap, RegularityNeeded, SizeOfInterpolation
from study.statements.shared.base import Statement
from study.statements.thm_4_2 import OwnSpace, SameMesh
from study.statements.time_steps import BackwardEuler, FullyDiscrete, JumpingLoad, Landings, NoPotential
from study.statements.unmeasured import Misprints, Untested, WithoutRow
from study.statements.wellposed import (
    BoundedVelocity,
    Dependence,
    Korn,
    LoadInTime,
    NaturalConditions,
    OneStress,
    OneTrajectory,
    SolutionDivergence,
    TractionInTime,
)
from study.statements.work_of_contact import EdgeWork, Rollers, WorkOfContact

IN_ORDER: tuple[type[Statement], ...] = (
    # The order is the order of the paper: first the problem, its data, existence and uniqueness.
    *(Korn, Dependence, SolutionDivergence, LoadInTime, BoundedVelocity, OneTrajectory),
    *(SameMesh, OwnSpace, OneStress, TractionInTime, NaturalConditions),
    # Then the discretisation, the error estimate and convergence.
    *(ErrorBounds, InterpolationInV, SizeOfInterpolation, InterpolationOnContact, ResidualBound),
    *(Convergence, NodalStart, FirstOrder, RegularityNeeded),
    # The paper does not compute contact forces; comparisons with other solvers and codes test the program.
    *(ContactForce, Recomputed, OtherCodes),
    # Theorems and experiments of this study, which the paper does not have.
    *(EdgeWork, WorkOfContact, Rollers, AdvancingFront, HalfDerivative, NodalErrors),
    *(BackwardEuler, JumpingLoad, NoPotential, FullyDiscrete),
    *(Landings, InitialGap, BoundedError, EnclosedError),
    # Misprints, untested claims and pictures, which have no tolerance window.
    *(Misprints, Untested, WithoutRow, Pictures),
)
STATEMENTS: tuple[Statement, ...] = tuple(statement() for statement in IN_ORDER)
"""All statements. The commands measure them, and the ledger, the table of all checks, lists them in this order."""
