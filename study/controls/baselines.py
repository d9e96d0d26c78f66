"""The settings in which deliberate defects are measured: a case with a few coarse meshes, and the statements to judge.

In each setting, the study measures and judges as it does in a normal run.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from typing import Any, ClassVar, Protocol, TypeVar

import numpy as np
import pandas as pd

from manufactured.body import Kind, polygon
from manufactured.case import Case
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from study.fem.naming import family_named, resolve
from study.ledger.verdict import UNCLAIMED, Verdict
from study.run.judgement import joined
from study.solve.steps import rate_steps, stress_steps
from study.solve.tableau import MIDPOINT
from study.statements import thm_4_2_own_space as own
from study.statements.contact_force import ContactForce, measure_contact
from study.statements.enclosure import Bounds, BoundSetting, resolve_problem
from study.statements.enclosure import measure as bounded
from study.statements.from_rates import SizeOfInterpolation, Turned
from study.statements.initial_gap import InitialGap
from study.statements.prop_5_3 import Convergence
from study.statements.prop_5_4 import RATES, FirstOrder, measure
from study.statements.recomputed import Recomputed, recompute
from study.statements.shared.base import ListedNumbers, Setting
from study.statements.shared.experiment import Experiment
from study.statements.thm_4_2 import SameMesh, Sides, StandsAlone, gaps, independence
from study.statements.thm_4_2_own_space import OwnSpace

S = TypeVar("S")


class Baseline(Protocol[S]):
    """A setting in which deliberate defects are measured.

    S is the type of the object that is measured, such as an experiment; a defect changes this object. Settings are
    compared by value, so that defects with the same setting share the measurement without a defect.
    """

    def verdicts(self, defect: Callable[[S], S]) -> list[Verdict]:
        """Measure in this setting with a defect; return the checks about which the study or the paper claims something.

        Parameters:
            defect: function that returns the wrong object, given the correct one; the identity for no defect.
        """
        ...


Defect = Callable[[Experiment], Experiment]
OF_RATES = FirstOrder(), Convergence(), SizeOfInterpolation(), InitialGap()
"""The statements that are judged by rows of ``rates.csv``, which has the errors of displacements."""


Measure = Callable[[Any], Mapping[str, Any]]
"""Function that returns measured numbers by their names, given what is measured: an experiment, or a setting."""


class Titled:
    """A setting whose text is its title and its levels; {0} in the title is the setting."""

    TITLE: ClassVar[str]

    def __str__(self) -> str:
        levels = getattr(self, "levels", None) or (getattr(self, "level", ""),)
        return f"{self.TITLE.format(self)}, n = {' '.join(map(str, levels))}"


def experiment(case: Case, family: str, level: int) -> Experiment:
    """Return the experiment of the study for a case on one mesh: the contact problem with the midpoint rule in time."""
    steps = rate_steps(case.solution.body.T, level, case.pace)
    return Experiment.of(case.solution, family_named(family), level, MIDPOINT, steps)


def claimed(verdicts: list[Verdict]) -> list[Verdict]:
    """Return the checks of a list without the checks about which nothing is claimed."""
    return [verdict for verdict in verdicts if verdict.verdict not in UNCLAIMED]


@dataclass(frozen=True)
class Sweep:
    """The convergence of the displacement for one case on a few levels (Propositions 5.3 and 5.4).

    Attributes:
        case: name of the case.
        angle: angle in radians by which the body is turned.
        families: names of the mesh families.
        levels: numbers of cells along a side, coarse to fine.
    """

    case: str
    angle: float = 0.0
    families: tuple[str, ...] = ("one-diagonal",)
    levels: tuple[int, ...] = (8, 16, 32)

    def __str__(self) -> str:
        turned = f" turned by {self.angle:g}" if self.angle else ""
        meshes = "" if self.families == Sweep.families else f" on {' and '.join(self.families)} meshes"
        return f"{self.case}{turned}{meshes}, n = {' '.join(map(str, self.levels))}"

    def verdicts(self, defect: Defect) -> list[Verdict]:
        case = resolve(self.case)
        case = replace(case, solution=turned(case.solution, self.angle)) if self.angle else case
        rows = []
        for family, level in product(self.families, self.levels):
            rows.append(measure(defect(experiment(case, family, level))).row(case.name, family, level))
        table = pd.DataFrame(rows).assign(claim=case.proposition, expected_order=case.order)
        return claimed([verdict for statement in OF_RATES for verdict in statement.judge(table)])


@dataclass(frozen=True)
class OneFamily:
    """Measurements for one case on a few levels of one mesh family.

    Attributes:
        case: name of the case.
        family: name of the mesh family.
        levels: numbers of cells along a side, coarse to fine.
    """

    TITLE: ClassVar[str]
    case: str
    family: str = "one-diagonal"
    levels: tuple[int, ...] = (8, 16, 32)

    def __str__(self) -> str:
        meshes = "" if self.family == OneFamily.family else f" on {self.family} meshes"
        return f"{self.TITLE} of {self.case}{meshes}, n = {' '.join(map(str, self.levels))}"

    def measured(self, make: Callable[..., S], measure: Measure, defect: Callable[[S], S]) -> pd.DataFrame:
        """Return what is measured on all levels.

        Parameters:
            make: function that returns the experiment, given the solution, mesh family, level and number of time steps.
            measure: function that returns the measured numbers by their names, given the experiment.
            defect: as in ``Baseline.verdicts``.
        """
        case, family, rows = resolve(self.case), family_named(self.family), []
        for level in self.levels:
            steps = stress_steps(case.solution.body.T, level, case.pace)
            found = measure(defect(make(case.solution, family, level, steps=steps)))
            rows.append({"case": case.name, "family": family.name, "level": level, **found})
        return pd.DataFrame(rows)


class ContactSweep(OneFamily):
    """The convergence of the contact force for one case."""

    TITLE = "contact force"

    def verdicts(self, defect: Defect) -> list[Verdict]:
        make = partial(Experiment.of, scheme=MIDPOINT)
        return ContactForce().judge(self.measured(make, measure_contact, defect))


@dataclass(frozen=True)
class StressSweep(OneFamily):
    """The convergence of the stress formulation, solved without displacements, for one case (Theorem 4.2)."""

    TITLE = "stresses"
    levels: tuple[int, ...] = (8, 16)

    def verdicts(self, defect: Callable[[own.StressExperiment], own.StressExperiment]) -> list[Verdict]:
        return claimed(OwnSpace().judge(self.measured(own.StressExperiment.of, own.measure, defect)))


@dataclass(frozen=True)
class Equivalence(Titled):
    """The comparison of the displacement formulation with the stress formulation on one mesh (Theorem 4.2).

    Attributes:
        case: name of the case.
        family, level, steps: the mesh family, the number of cells along a side, and the number of steps of
            backward Euler.
    """

    TITLE = "{0.case}"
    family, level, steps = "one-diagonal", 4, 8
    case: str

    def verdicts(self, defect: Callable[[Sides], Sides]) -> list[Verdict]:
        sides = defect(Sides.of(resolve(self.case).solution, family_named(self.family), self.level))
        compared = sides.stresses(sides.displacements)
        agreement = gaps(sides.displacements, compared, self.steps)
        place = {"case": self.case, "family": self.family, "level": self.level, "h": compared.space.h}
        shown = pd.DataFrame(independence(sides, self.steps).items(), columns=["quantity", "value"])
        return [
            *SameMesh().judge(pd.DataFrame([{**place, **agreement._asdict()}])),
            *StandsAlone().judge(shown.assign(**place)),
        ]


@dataclass(frozen=True)
class Listing(Titled):
    """The measurement of any other statement for one case on a few levels of one mesh family.

    Attributes:
        statement: the statement; it measures a list of named numbers on each mesh.
        case, family: names of the case and of the mesh family.
        levels: numbers of cells along a side, coarse to fine.
    """

    TITLE = "{0.statement.label} for {0.case}"
    statement: ListedNumbers
    case: str
    family: str
    levels: tuple[int, ...]

    def verdicts(self, defect: Callable[[Measure], Measure]) -> list[Verdict]:
        measure, rows = defect(self.statement.measure), []
        for setting in (Setting(self.case, self.family, level) for level in self.levels):
            rows += [row for _, row in self.statement.records(setting, measure(setting))]
        return claimed(self.statement.judge(pd.DataFrame(rows)))


def turned(solution: ExactSolution, angle: float) -> ExactSolution:
    """Return an exact solution on a turned body, with the same contact pressure and gap on its faces.

    Parameters:
        solution: the solution on a body in the plane, with an isotropic law.
        angle: the angle in radians, counterclockwise.
    """
    body = solution.body
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    corners = [(float(x), float(y)) for x, y in (turn @ body.vertices).T]
    moved = polygon(corners, [part.kind for part in body.parts], body.T)
    lifted = [face for face in solution.faces if isinstance(face, ContactFace)]
    faces = zip(lifted, moved.of(Kind.CONTACT), strict=True)
    return ExactSolution(moved, solution.law, tuple(replace(face, part=part) for face, part in faces))


# Settings whose checks compare two results: on a rotated body, by a second solver, or an error bound with the error.


@dataclass(frozen=True)
class Twins(Titled):
    """The comparison of errors on a rotated body with errors on the same body without the rotation.

    Attributes:
        case: name of the case with the rotated body.
        levels: numbers of cells along a side, coarse to fine. Several are needed, because on one mesh the digits
            may agree by chance.
    """

    TITLE = "{0.case} and its twin"
    case: str
    levels: tuple[int, ...]

    def verdicts(self, defect: Defect) -> list[Verdict]:
        rows = []
        for name, level in product((self.case, resolve(self.case).twin), self.levels):
            setup = defect(experiment(resolve(name), "one-diagonal", level))
            rows.append({**measure(setup).row(name, "one-diagonal", level), "twin": resolve(name).twin})
        return Turned().judge(pd.DataFrame(rows))


@dataclass(frozen=True)
class TwoWays(Titled):
    """The comparison of errors on one mesh with the same errors computed by a second, independent solver.

    Attributes:
        case: name of the case.
        level: number of cells along a side.
    """

    TITLE = "{0.case} computed again"
    case: str
    level: int

    def verdicts(self, defect: Defect) -> list[Verdict]:
        setup = defect(experiment(resolve(self.case), "one-diagonal", self.level))
        line = measure(setup).row(self.case, "one-diagonal", self.level)
        again = {name: line[name] for name in (*RATES.key, "h")} | recompute(setup)
        tables = {RATES: pd.DataFrame([line]), Recomputed.file: pd.DataFrame([again])}
        return Recomputed().judge(joined(Recomputed(), tables))


@dataclass(frozen=True)
class Bounding:
    """The comparison of error bounds with errors for one case on a few meshes.

    Attributes:
        statement: the statement about bounds that is judged.
        settings: for each mesh the case, mesh family, level, time scheme and method of the bound.
    """

    statement: Bounds
    settings: tuple[BoundSetting, ...]

    def __str__(self) -> str:
        levels = " ".join(str(setting.level) for setting in self.settings)
        return f"{self.statement.label} for {self.settings[0].case}, n = {levels}"

    def verdicts(self, defect: Callable[[Any], Any]) -> list[Verdict]:
        rows = []
        for setting in self.settings:
            problem, steps = resolve_problem(setting.case), self.statement.steps(setting)
            row, _ = bounded(problem, family_named(setting.family), setting.level, MIDPOINT, steps, setting.by)
            rows.append({**row, "known": problem.case is not None})
        return claimed(self.statement.judge(pd.DataFrame(rows)))
