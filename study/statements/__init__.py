"""The list of all statements that the study measures and judges, in the order of the paper.

Statements that go beyond the paper come last.
"""

from study.statements.advancing_front import AdvancingFront
from study.statements.backward_euler import BackwardEuler, JumpingLoad
from study.statements.boundary import NaturalConditions
from study.statements.contact_force import ContactForce
from study.statements.contact_work import WorkOfContact
from study.statements.edge_work import EdgeWork
from study.statements.enclosure import BoundedError, EnclosedError
from study.statements.error_bounds import ErrorBounds
from study.statements.from_rates import RegularityNeeded, SizeOfInterpolation
from study.statements.fully_discrete import FullyDiscrete
from study.statements.half_derivative import HalfDerivative, NodalErrors
from study.statements.initial_gap import InitialGap
from study.statements.interpolation import InterpolationInV, InterpolationOnContact
from study.statements.korn import Korn
from study.statements.landings import Landings
from study.statements.no_potential import NoPotential
from study.statements.nodal_start import NodalStart
from study.statements.norms_in_time import LoadInTime, TractionInTime
from study.statements.other_codes import OtherCodes
from study.statements.pictures import Pictures
from study.statements.prop_5_3 import Convergence
from study.statements.prop_5_4 import FirstOrder
from study.statements.recomputed import Recomputed
from study.statements.residual_bound import ResidualBound
from study.statements.rollers import Rollers
from study.statements.shared.base import Statement
from study.statements.solution_divergence import SolutionDivergence
from study.statements.thm_4_2 import SameMesh
from study.statements.thm_4_2_own_space import OwnSpace
from study.statements.uniqueness import OneStress, OneTrajectory
from study.statements.unmeasured import Misprints, Untested, WithoutRow
from study.statements.wellposed import BoundedVelocity, Dependence

STATEMENTS: tuple[Statement, ...] = (
    # The order is the order of the paper: first the problem, its data, existence and uniqueness.
    *(Korn(), Dependence(), SolutionDivergence(), LoadInTime(), BoundedVelocity(), OneTrajectory()),
    *(SameMesh(), OwnSpace(), OneStress(), TractionInTime(), NaturalConditions()),
    # Then the discretisation, the error estimate and convergence.
    *(ErrorBounds(), InterpolationInV(), SizeOfInterpolation(), InterpolationOnContact(), ResidualBound()),
    *(Convergence(), NodalStart(), FirstOrder(), RegularityNeeded()),
    # The paper does not compute contact forces; comparisons with other solvers and codes test the program.
    *(ContactForce(), Recomputed(), OtherCodes()),
    # Theorems and experiments of this study, which the paper does not have.
    *(EdgeWork(), WorkOfContact(), Rollers(), AdvancingFront(), HalfDerivative(), NodalErrors()),
    *(BackwardEuler(), JumpingLoad(), NoPotential(), FullyDiscrete()),
    *(Landings(), InitialGap(), BoundedError(), EnclosedError()),
    # Misprints, untested claims and pictures, which have no tolerance window.
    *(Misprints(), Untested(), WithoutRow(), Pictures()),
)
"""All statements. The commands measure them, and the ledger, the table of all checks, lists them in this order."""
