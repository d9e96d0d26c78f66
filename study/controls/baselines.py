"""Where a control is measured: the smallest sweep, or check of Theorem 4.2, that exposes its defect."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, Protocol, TypeVar

import numpy as np
import pandas as pd

from manufactured.body import Kind, polygon
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from study.fem.naming import family_named, resolve
from study.ledger.verdict import UNCLAIMED, Verdict
from study.solve.steps import rate_steps, stress_steps
from study.solve.tableau import MIDPOINT
from study.statements import thm_4_2_own_space as own
from study.statements.contact_force import ContactForce, measure_contact
from study.statements.from_rates import SizeOfInterpolation
from study.statements.initial_gap import InitialGap
from study.statements.prop_5_3 import Convergence
from study.statements.prop_5_4 import FirstOrder, measure
from study.statements.shared.base import ListedNumbers, Setting
from study.statements.shared.experiment import Experiment
from study.statements.thm_4_2 import SameMesh, Sides, StandsAlone, gaps, independence
from study.statements.thm_4_2_own_space import OwnSpace

S = TypeVar("S")


class Baseline(Protocol[S]):
    """A place of measurement: what would be measured there is an S, which a defect may change.

    Settings are compared by value, so that controls share their baseline.
    """

    def __str__(self) -> str: ...
    def __hash__(self) -> int: ...

    def verdicts(self, defect: Callable[[S], S]) -> list[Verdict]:
        """The rows of the ledger, had the study the defect."""
        ...


OF_RATES = FirstOrder(), Convergence(), SizeOfInterpolation(), InitialGap()


@dataclass(frozen=True)
class Sweep:
    """Prop. 5.3 or 5.4 for a case of the catalogue on a few levels of one mesh family.

    Attributes:
        case: its name.
        angle: by which the body is turned, in radians.
        families: names of the mesh families.
        levels: coarse to fine.
    """

    case: str
    angle: float = 0.0
    families: tuple[str, ...] = ("one-diagonal",)
    levels: tuple[int, ...] = (8, 16, 32)

    def __str__(self) -> str:
        turned = f" turned by {self.angle:g}" if self.angle else ""
        meshes = "" if self.families == Sweep.families else f" on {' and '.join(self.families)} meshes"
        return f"{self.case}{turned}{meshes}, n = {' '.join(map(str, self.levels))}"

    def verdicts(self, defect: Callable[[Experiment], Experiment]) -> list[Verdict]:
        case = resolve(self.case)
        solution = turned(case.solution, self.angle) if self.angle else case.solution
        rows = []
        for family, level in product(map(family_named, self.families), self.levels):
            steps = rate_steps(solution.body.T, level, case.pace)
            setup = defect(Experiment.of(solution, family, level, MIDPOINT, steps))
            rows.append(measure(setup).row(case.name, family.name, level))
        table = pd.DataFrame(rows).assign(claim=case.proposition, expected_order=case.order)
        found = [verdict for statement in OF_RATES for verdict in statement.judge(table)]
        return [verdict for verdict in found if verdict.verdict not in UNCLAIMED]


@dataclass(frozen=True)
class ContactSweep:
    """The contact force of a case of the catalogue on a few levels of one mesh family.

    Attributes:
        case: its name.
        family: name of the mesh family.
        levels: coarse to fine.
    """

    case: str
    family: str = "one-diagonal"
    levels: tuple[int, ...] = (8, 16, 32)

    def __str__(self) -> str:
        meshes = "" if self.family == ContactSweep.family else f" on {self.family} meshes"
        return f"contact force of {self.case}{meshes}, n = {' '.join(map(str, self.levels))}"

    def verdicts(self, defect: Callable[[Experiment], Experiment]) -> list[Verdict]:
        case, family = resolve(self.case), family_named(self.family)
        rows = []
        for level in self.levels:
            steps = stress_steps(case.solution.body.T, level, case.pace)
            setup = defect(Experiment.of(case.solution, family, level, MIDPOINT, steps))
            rows.append({"case": case.name, "family": family.name, "level": level, **measure_contact(setup)})
        return ContactForce().judge(pd.DataFrame(rows))


@dataclass(frozen=True)
class Equivalence:
    """Theorem 4.2 for a case of the catalogue on one mesh.

    Attributes:
        case: its name.
        family: name of the mesh family.
        level: n.
        steps: of backward Euler.
    """

    case: str
    family: str = "one-diagonal"
    level: int = 4
    steps: int = 8

    def __str__(self) -> str:
        return f"{self.case}, n = {self.level}"

    def verdicts(self, defect: Callable[[Sides], Sides]) -> list[Verdict]:
        sides = defect(Sides.of(resolve(self.case).solution, family_named(self.family), self.level))
        compared = sides.stresses(sides.displacements)
        agreement = gaps(sides.displacements, compared, self.steps)
        place = {"case": self.case, "family": self.family, "level": self.level, "h": compared.space.h}
        shown = pd.DataFrame(independence(sides, self.steps)._asdict().items(), columns=["quantity", "value"])
        return [
            *SameMesh().judge(pd.DataFrame([{**place, **agreement._asdict()}])),
            *StandsAlone().judge(shown.assign(**place)),
        ]


@dataclass(frozen=True)
class StressSweep:
    """Theorem 4.2 on its own stress space for a case of the catalogue on a few levels of one mesh family.

    Attributes:
        case: its name.
        family: name of the mesh family.
        levels: coarse to fine.
    """

    case: str
    family: str = "one-diagonal"
    levels: tuple[int, ...] = (8, 16)

    def __str__(self) -> str:
        return f"stresses of {self.case}, n = {' '.join(map(str, self.levels))}"

    def verdicts(self, defect: Callable[[own.StressExperiment], own.StressExperiment]) -> list[Verdict]:
        case, family = resolve(self.case), family_named(self.family)
        rows = []
        for level in self.levels:
            steps = stress_steps(case.solution.body.T, level, case.pace)
            setup = defect(own.StressExperiment.of(case.solution, family, level, steps))
            rows.append({"case": case.name, "family": family.name, "level": level, **own.measure(setup)})
        return [verdict for verdict in OwnSpace().judge(pd.DataFrame(rows)) if verdict.verdict not in UNCLAIMED]


Measure = Callable[[Setting], Mapping[str, Any]]
"""A place of measurement ↦ named numbers."""


@dataclass(frozen=True)
class Listing:
    """Another statement on the levels of one case and mesh family.

    Attributes:
        statement: whose numbers are listed one by one.
        case, family: their names.
        levels: coarse to fine.
    """

    statement: ListedNumbers
    case: str
    family: str
    levels: tuple[int, ...]

    def __str__(self) -> str:
        return f"{self.statement.label} for {self.case}, n = {' '.join(map(str, self.levels))}"

    def verdicts(self, defect: Callable[[Measure], Measure]) -> list[Verdict]:
        measure, rows = defect(self.statement.measure), []
        for setting in (Setting(self.case, self.family, level) for level in self.levels):
            rows += [row for _, row in self.statement.records(setting, measure(setting))]
        return [verdict for verdict in self.statement.judge(pd.DataFrame(rows)) if verdict.verdict not in UNCLAIMED]


def turned(solution: ExactSolution, angle: float) -> ExactSolution:
    """The same contact data on the body turned by an angle, for a plane body and an isotropic law."""
    body = solution.body
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    corners = [(float(x), float(y)) for x, y in (turn @ body.vertices).T]
    moved = polygon(corners, [part.kind for part in body.parts], body.T)
    lifted = [face for face in solution.faces if isinstance(face, ContactFace)]
    faces = zip(lifted, moved.of(Kind.CONTACT), strict=True)
    return ExactSolution(moved, solution.law, tuple(replace(face, part=part) for face, part in faces))
