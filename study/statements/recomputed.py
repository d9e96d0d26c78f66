"""Errors and discrete solutions agree with the results of a second, independent solver.

The criteria of Proposition 5.4 do not notice small mistakes: an error that is wrong by five per cent has the same
order. Therefore the rows of ``rates.csv`` on the coarsest meshes are computed again: ``recomputed_solver`` solves the
same discrete problems with other quadrature, assembly and solvers. Its errors are compared with ``rates.csv``, and its
trajectories, the discrete solutions over time, with the trajectories of the study. A wrong load, modulus, initial value
or time step changes a trajectory to first order, but an error only to second order.

**Predicted** are the following differences. ``ErrorNorm`` integrates by rules of degree 4 with points moved along the
face, the second solver by rules of degree 10. By the triangle inequality, checks of ``rates.csv`` bound the effect of
quadrature by 2 %. Both rules cut the same cells, so their difference is much smaller: errors agree within 0.5 %, and
the discrete errors, which are a few times smaller, within 1 %. Trajectories differ only because of the load. Its
relative quadrature error is smaller by a power of h than the error of the solution, so displacements agree within 2e-3.
Nodal forces are differences of large terms and agree within 1 %. The initial value Π^h u_0 needs no quadrature.

If the second solver uses the load of the study, both solve the same discrete problem with exact quadrature. Both
solvers stop at 1e-12 of the solution, there are some tens of steps, and nodal forces are differences that lose a digit
or two. So trajectories and forces agree to 1e-9. These checks notice relative defects of 1e-9 in a modulus, an initial
value or a force.
"""

from typing import Any

import numpy as np

from study.ledger.check import Check, accuracy
from study.ledger.datafiles import CsvFile
from study.ledger.quantities import quotients, values
from study.ledger.window import Window, around, at_most, positive_at_most
from study.solve.tableau import MIDPOINT
from study.statements.prop_5_4 import RATES, RateSetting
from study.statements.recomputed_solver import PlainProblem, Trajectory
from study.statements.shared import estimates
from study.statements.shared.base import REPORTED, Numbers, Statement
from study.statements.shared.experiment import Experiment
from study.statements.shared.norms import maximum
from study.statements.shared.scope import Scope

ERRORS = "error", "interpolation_error", "discrete_error"
"""Columns with the largest errors over the time nodes, by the second solver.

They are the norms in V of the error u − u^h, the interpolation error u − Π^h u and the discrete error Π^h u − u^h."""
GAPS = "displacement", "multipliers"
"""Columns with relative differences between both solvers.

They compare displacements at all times, in the norm of V, and nodal contact forces."""
SAME_LOAD = "displacement_same_load", "multipliers_same_load"
"""Columns with the differences of displacements and contact forces if both solvers use the load of the study."""
TINY = 1e-12
"""An initial displacement counts as zero if its norm is at most this number times the largest norm over time."""


def recompute(setup: Experiment) -> Numbers:
    """Solve an experiment again by the second solver, and return the measured columns of ``recomputed.csv``.

    Both solvers use half the time step of the experiment, because the study measures errors with half the time step.
    """
    plain = PlainProblem(setup.solution, setup.space.mesh)
    steps = 2 * setup.steps
    own_load, same_load = (plain.trajectory(steps, load) for load in (plain.load, setup.problem.load))
    errors = []
    for n, u in enumerate(own_load[0]):
        time = n * setup.problem.T / steps
        interpolant = plain.interpolant(time)
        errors.append([*plain.distance(time, u, interpolant), plain.norm(interpolant - u)])
    return dict(zip(ERRORS, np.max(errors, axis=0), strict=True)) | gaps(setup, plain, own_load, same_load)


def gaps(setup: Experiment, plain: PlainProblem, own_load: Trajectory, same_load: Trajectory) -> Numbers:
    """Return the relative differences between the study and the second solver, by the names of columns.

    The columns ``GAPS`` have the differences of initial values, displacements and contact forces. The columns
    ``SAME_LOAD`` have the differences of displacements and contact forces if both solvers use the load of the study.
    A difference of displacements is the largest norm in V over time. A difference of contact forces is the
    Euclidean norm over all times.

    Args:
        setup: the experiment of the study.
        plain: the problem of the second solver.
        own_load, same_load: the trajectories of the second solver with its own load and with the load of the study.
    """
    states = list(setup.march(2 * setup.steps))
    u, multipliers = (np.array([getattr(state, name) for state in states]) for name in ("u", "multipliers"))
    sizes = [plain.norm(v) for v in own_load[0]]
    size_of_forces = np.linalg.norm(own_load[1])
    # Both loads start from the same initial value.
    start = max(sizes[0], TINY * max(sizes))
    numbers: Numbers = {"start": quotient(plain.norm(u[0] - own_load[0][0]), start)}
    for (of_displacement, of_forces), (displacements, forces) in ((GAPS, own_load), (SAME_LOAD, same_load)):
        numbers[of_displacement] = maximum(map(plain.norm, u - displacements)) / maximum(sizes)
        numbers[of_forces] = quotient(np.linalg.norm(multipliers - forces), size_of_forces)
    return numbers


def quotient(difference: Any, size: Any) -> float:
    """Return a difference relative to a size; if the size is 0, whether there is a difference."""
    return float(difference / size if size else difference > 0)


def ratio(column: str, norm: str, window: Window) -> Check:
    """Return the criterion for the quotient (error in ``rates.csv``) / (recomputed error), on every level.

    Args:
        column: the column with the error, which is also the key of the check.
        norm: the formula of the error.
        window: the tolerance window.
    """
    reported = f"{column}{REPORTED}"

    quantity = f"{norm} in rates.csv / computed again"
    shares = quotients(reported, column)
    return accuracy(column.replace("_", "-"), quantity, shares, window)


SAME = around(1, 0.005, "quadrature")
FORCES = "|λ − λ̃| / |λ̃| over all steps"
DISPLACEMENTS = "max_n ‖u^h_n − ũ^h_n‖_V / max_n ‖ũ^h_n‖_V"
ALIKE = "both with the same load"
TRAJECTORIES = (
    accuracy(
        "start", "‖u^h_0 − ũ^h_0‖_V / ‖ũ^h_0‖_V", values("start"), at_most(1e-10, "of ‖Π^h u_0‖_V; only rounding")
    ),
    accuracy(
        "displacement",
        DISPLACEMENTS,
        values("displacement"),
        at_most(2e-3, "of ‖u^h‖_V; the load is integrated by two rules"),
    ),
    accuracy("multipliers", FORCES, values("multipliers"), at_most(0.01, "of λ; the load is integrated by two rules")),
    accuracy(
        "displacement-same-load",
        f"{DISPLACEMENTS}, {ALIKE}",
        values("displacement_same_load"),
        positive_at_most(1e-9, "of ‖u^h‖_V; tolerances of both solvers"),
    ),
    accuracy(
        "multipliers-same-load",
        f"{FORCES}, {ALIKE}",
        values("multipliers_same_load"),
        at_most(1e-9, "of λ; tolerances of both solvers"),
    ),
)
NARROW = ("travelling-patch",)
"""Cases whose contact patch is only two or three cells wide on the coarsest meshes."""


class Recomputed(Statement):
    """Compares errors, displacements and contact forces of the study with an independent computation."""

    label = "computed again"
    claim = "the errors in rates.csv, computed again from Problem 5.1 with other quadrature, assembly and solvers"
    file = CsvFile("recomputed.csv")
    joined_file = RATES
    per_step = 120.0, 600.0
    checks = (
        ratio("error", "‖u − u^h‖_V", SAME),
        ratio("interpolation_error", "‖u − Π^h u‖_V", SAME),
        ratio("discrete_error", "‖Π^h u − u^h‖_V", around(1, 0.01, "quadrature, also of the load")),
        *TRAJECTORIES,
    )

    def settings(self, scope: Scope) -> list[RateSetting]:
        """Return the settings: every case on all its mesh families in the study, on the coarsest level.

        On random meshes the cases of Proposition 5.3 and the cases with a narrow contact patch are left out: their
        quadrature error depends on the random size of the cells at the singularity or below the patch.
        """
        return [
            RateSetting(reference, family.name, level, scope.scheme, scope.steps(case, level))
            for reference, case, family in scope.on_families()
            if scope.scheme == MIDPOINT.name
            if not (family.random and (case.proposition == "Prop. 5.3" or case.name in NARROW))
            for level in scope.levels_of(case).all[:1]
        ]

    def setup(self, setting: RateSetting) -> Experiment:
        return Experiment.at(setting, MIDPOINT, setting.steps)

    def measure(self, setup: Experiment) -> Numbers:
        return {"h": setup.space.h, **recompute(setup)}

    def memory(self, setting: RateSetting) -> float:
        return estimates.SMALL if setting.dim == 2 else estimates.SOLID
