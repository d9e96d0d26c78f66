"""The errors in ``rates.csv`` and the solution of Problem 5.1, computed once more in another way.

Relations between reported errors are loose: an error that is wrong by five per cent has the same order. So the coarsest
rows of ``rates.csv`` are computed again: ``recomputed_solver`` solves the same discrete problems with other quadrature,
assembly and solvers. Its errors are compared with the errors in ``rates.csv``, its trajectory with the trajectory of
the study. A defect of the load, of a modulus, of the start or of the time steps changes a trajectory to first order,
an error only to second order.

**Predicted.** ``ErrorNorm`` integrates by rules of degree 4 with points moved along the face, the second solver by
rules of degree 10. Rows of ``rates.csv`` bound the effect of quadrature by 2 %, by the triangle inequality; both
rules cut the same cells, and their difference is much smaller. Predicted: errors agree within 0.5 %, and the
discrete errors, a few times smaller, within 1 %. Trajectories differ by the load alone, whose relative
quadrature error is a power of h smaller than the error of the solution, 2e-3; nodal forces are differences of large
terms, 1 %. Π^h u_0 has no quadrature.

With the same load, forms of polynomials on cells and the same discrete problem are left. Both solvers stop at 1e-12 of
the solution, there are some tens of steps, and the forces of a step are differences that lose a digit or two, so
trajectories and forces agree to 1e-9. These rows notice a modulus, a start or a force that is wrong by as little.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd

from manufactured.tensors import Array
from study.fem.naming import resolve
from study.ledger.criterion import Criterion, Measured, among, largest
from study.ledger.datafiles import CsvFile, DataFile, Row
from study.ledger.window import Window, around, at_most, positive_at_most
from study.solve.tableau import MIDPOINT
from study.statements.prop_5_4 import RATES, RateSetting
from study.statements.recomputed_solver import PlainProblem, Trajectory
from study.statements.shared import estimates
from study.statements.shared.base import REPORTED, Statement
from study.statements.shared.experiment import Experiment
from study.statements.shared.meshes import is_random
from study.statements.shared.scope import Scope

ERRORS = "error", "interpolation_error", "discrete_error"
"""Maxima over the nodes in time of the norms in V of u − u^h, u − Π^h u and Π^h u − u^h, by the second solver."""
GAPS = "start", "displacement", "multipliers"
"""Relative differences of both solvers: ‖u_0 − ũ_0‖_V, max_n ‖u_n − ũ_n‖_V, and of all λ_n in the Euclidean norm."""
SAME_LOAD = "displacement_same_load", "multipliers_same_load"
"""The last two with the load of the study in both solvers, so that only forms, contact and steps differ."""
RECOMPUTED = CsvFile("recomputed.csv", RATES.key, (*RATES.key, "h", *ERRORS, *GAPS, *SAME_LOAD))
TINY = 1e-12
"""A start is zero if its norm is at most this part of the largest ‖ũ_n‖_V."""


def recompute(setup: Experiment) -> dict[str, float]:
    """Return the columns of ``recomputed.csv`` from ERRORS on, by the midpoint rule with twice the steps."""
    plain = PlainProblem(setup.solution, setup.space.mesh)
    own_load, same_load = plain.trajectories(2 * setup.steps, plain.load, setup.problem.load)
    return errors(plain, own_load) | gaps(setup, plain, own_load, same_load)


def errors(plain: PlainProblem, trajectory: Trajectory) -> dict[str, float]:
    """Return the ERRORS of a trajectory."""
    found = []
    for time, u, _ in trajectory:
        interpolant = plain.interpolant(time)
        found.append([*plain.distance(time, u, interpolant), *plain.norms((interpolant - u)[:, None])])
    return dict(zip(ERRORS, map(float, np.max(found, axis=0)), strict=True))


def gaps(setup: Experiment, plain: PlainProblem, own_load: Trajectory, same_load: Trajectory) -> dict[str, float]:
    """Return GAPS and SAME_LOAD between an experiment and the trajectories of the second solver with both loads."""
    states = [(s.time, s.u, s.multipliers) for s in setup.scheme.march(setup.problem, 2 * setup.steps)]
    norms = plain.norms(np.stack([u for _, u, _ in own_load], axis=1))
    forces = euclidean_norm(multipliers for *_, multipliers in own_load)
    sizes = max(norms[0], TINY * norms.max()), norms.max(), forces
    gaps_own, gaps_same = differences(plain, states, own_load), differences(plain, states, same_load)
    found = zip((*GAPS, *SAME_LOAD), (*gaps_own, *gaps_same[1:]), (*sizes, *sizes[1:]), strict=True)
    return {name: float(gap / size if size else gap > 0) for name, gap, size in found}


def differences(plain: PlainProblem, states: Trajectory, trajectory: Trajectory) -> tuple[float, float, float]:
    """Return ‖u_0 − ũ_0‖_V, max_n ‖u_n − ũ_n‖_V, and the difference of all λ_n in the Euclidean norm."""
    pairs = list(zip(states, trajectory, strict=True))
    missing = plain.norms(np.stack([ours - u for (_, ours, _), (_, u, _) in pairs], axis=1))
    return missing[0], missing.max(), euclidean_norm(ours - forces for (*_, ours), (*_, forces) in pairs)


def euclidean_norm(vectors: Iterable[Array]) -> float:
    """Return the Euclidean norm of several vectors as one."""
    return math.sqrt(sum(float(np.sum(each**2)) for each in vectors))


def ratio(column: str, norm: str, window: Window) -> Criterion:
    """Return the criterion for an error in ``rates.csv`` over the same error computed again, on every level."""
    reported = f"{column}{REPORTED}"

    def measure(group: pd.DataFrame) -> Measured:
        values = (group[reported] / group[column]).to_numpy()
        return among(window.worst(list(values)), values)

    quantity = f"{norm} in rates.csv / computed again"
    return Criterion(column.replace("_", "-"), quantity, window, measure, (column, reported))


SAME = around(1, 0.005, "quadrature")
FORCES = "|λ − λ̃| / |λ̃| over all steps"
DISPLACEMENTS = "max_n ‖u^h_n − ũ^h_n‖_V / max_n ‖ũ^h_n‖_V"
ALIKE = "both with the load of u^h"
STOPPED = positive_at_most(1e-9, "of ‖u^h‖_V, tolerance of both solvers")
STOPPED_FORCES = at_most(1e-9, "of λ, tolerance of both solvers")
TRAJECTORIES = (
    largest("start", "‖u^h_0 − ũ^h_0‖_V / ‖ũ^h_0‖_V", at_most(1e-10, "of ‖Π^h u_0‖_V, only rounding"), "start"),
    largest("displacement", DISPLACEMENTS, at_most(2e-3, "of ‖u^h‖_V, quadrature of the load"), "displacement"),
    largest("multipliers", FORCES, at_most(0.01, "of λ, quadrature of the load"), "multipliers"),
    largest("displacement-same-load", f"{DISPLACEMENTS}, {ALIKE}", STOPPED, "displacement_same_load"),
    largest("multipliers-same-load", f"{FORCES}, {ALIKE}", STOPPED_FORCES, "multipliers_same_load"),
)
NARROW = ("travelling-patch",)
"""Cases with a patch that is two or three cells wide on the coarsest meshes."""


class Recomputed(Statement):
    """Three errors and two trajectories, over all mesh families of a case, by the midpoint rule."""

    label = "computed again"
    claim = "the errors in rates.csv, computed again from Problem 5.1 with other quadrature, assembly and solvers"
    file = RECOMPUTED
    joined_file = RATES
    rules = (
        ratio("error", "‖u − u^h‖_V", SAME),
        ratio("interpolation_error", "‖u − Π^h u‖_V", SAME),
        ratio("discrete_error", "‖Π^h u − u^h‖_V", around(1, 0.01, "quadrature, also of the load")),
        *TRAJECTORIES,
    )

    def settings(self, scope: Scope) -> list[RateSetting]:
        """The coarsest level of every case on all its mesh families in the study.

        Cases of Proposition 5.3 and cases with a narrow patch are left out on random meshes. There the size of the
        cells at a singularity or below the patch, which is random, decides how exact quadrature is, and the rows would
        judge chance and not the solvers.
        """
        return [
            RateSetting(reference, family.name, level, scope.scheme, scope.steps(case, level))
            for reference, case in zip(scope.cases, scope.resolved(), strict=True)
            if scope.scheme == MIDPOINT.name
            for family in scope.families_of(case)
            if not (is_random(family.name) and (case.proposition == "Prop. 5.3" or case.name in NARROW))
            for level in scope.levels_of(case).all[:1]
        ]

    def measure(self, setting: RateSetting) -> dict[str, float]:
        setup = Experiment.at(setting, MIDPOINT, setting.steps)
        return {"h": setup.space.h, **recompute(setup)}

    def records(self, setting: RateSetting, found: Mapping[str, Any]) -> Iterator[tuple[DataFile, Row]]:
        """The row, with the key of the row of ``rates.csv``."""
        case = resolve(setting.case).name
        yield self.file, {**{name: getattr(setting, name) for name in self.file.key}, "case": case, **found}

    def cost(self, setting: RateSetting) -> float:
        cells = setting.level**setting.dim * estimates.cells(setting.family)
        return float(cells * setting.steps) * (120 if setting.dim == 2 else 600)

    def memory(self, setting: RateSetting) -> float:
        return estimates.SMALL if setting.dim == 2 else estimates.SOLID

    def steps(self, setting: RateSetting) -> int:
        return setting.steps
