"""The plan of a run: a list of jobs, each of which measures one statement of the paper or of this study.

A job has a statement and a setting: the case, mesh family, level, and further parameters such as the time scheme. A
plan is checked before anything is computed. This module also defines which cases and levels the quick and the full
study have.
"""

from __future__ import annotations

import re
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from manufactured.body import Body
from manufactured.case import Case
from manufactured.catalogue import NAMES
from manufactured.law import NonSymmetric
from study.fem.mesh import MeshError, boundary_parts
from study.fem.naming import family_named, name_of, resolve
from study.fem.quadrature import Line, rough_cells
from study.ledger.datafiles import CsvFile, Key
from study.ledger.files import UsageError
from study.run.fingerprint import fingerprint
from study.statements import STATEMENTS
from study.statements.shared.base import Setting, Statement
from study.statements.shared.scope import Levels, Scope

HEADLINE = "advance-recede"
"""The case of which the README shows the errors."""
OVERHEAD = 0.3e6
"""Time in µs that is added to the expected computing time of each job: the time for meshes, matrices and compiled
formulas, which does not grow with the number of cells and steps."""


Result = Mapping[str, Any]
"""The result of a job: the measured numbers by their names."""


@dataclass(frozen=True)
class Job:
    """One measurement: a statement of the paper or of this study, and the case and mesh on which it is measured.

    Jobs are small, so that they can be sent to other processes.
    """

    statement: Statement
    setting: Setting

    @property
    def identity(self) -> Key:
        """The texts that identify the job: the name of its data file, then its values in the key columns."""
        known = {"label": self.statement.label, "case": name_of(self.setting.case)}
        key = (str(known.get(column) or getattr(self.setting, column)) for column in self.statement.file.key)
        return self.statement.file.name, *key

    @property
    def key(self) -> str:
        """The name of the file in which the result is stored, without the ending."""
        kind, *key = (re.sub(r"[^\w.]+", "-", part).strip("-") for part in self.identity)
        return "__".join([kind.removesuffix(".csv"), *(f"{part:0>5}" if part.isdigit() else part for part in key)])

    @property
    def case(self) -> str:
        """The name of the case in the catalogue, or FILE.py:NAME."""
        return str(self.setting.case)

    @property
    def cost(self) -> float:
        """The expected computing time in µs."""
        return OVERHEAD + self.statement.cost(self.setting)

    @property
    def memory(self) -> float:
        """The estimated largest memory of the process that runs this job, in bytes."""
        return self.statement.memory(self.setting)

    def fingerprint(self) -> str:
        """Return the cache key of the result of this job."""
        return fingerprint(self.statement, self.setting)

    def run(self) -> Result:
        """Measure, and return the measured numbers by their names."""
        return self.statement.run(self.setting)


Jobs = Sequence[Job]


def check_own(reference: str) -> None:
    """Check that the statements about every case can be tested on a user's case, and that its name is not taken.

    Parameters:
        reference: FILE.py:NAME, or a name in the catalogue, which is always accepted.

    Raises:
        UsageError: G is not symmetric, or the case has the name of a case of the catalogue.
    """
    if reference in NAMES:
        return
    case = resolve(reference)
    if isinstance(case.solution.law.G, NonSymmetric):
        raise UsageError(
            f"{reference}: G is not symmetric, so Problem 3.2 and the stored energy are not defined; give a "
            "symmetric G, or test the case in Python by manufactured.prove"
        )
    if case.name in NAMES:
        raise UsageError(f"{reference} has the name {case.name} of a case of the catalogue; give it another name")


@dataclass(frozen=True)
class Plan:
    """The jobs of a run.

    Attributes:
        scope: the cases, mesh families, levels and time scheme of the run.
        jobs: the jobs.
    """

    scope: Scope
    jobs: tuple[Job, ...]

    @classmethod
    def of(cls, scope: Scope) -> Plan:
        """Return the plan with the jobs of all statements for the cases, mesh families and levels of a scope."""
        statements = [
            statement
            for statement in STATEMENTS
            if scope.statements or statement.of_every_case or statement.of_own_cases
        ]
        jobs = [Job(statement, setting) for statement in statements for setting in statement.planned(scope)]
        return cls(scope, tuple(jobs))

    def stages(self) -> list[list[Job]]:
        """Return the jobs in groups that run one after the other.

        A study of all statements begins with the case of which the README shows the errors.
        """
        first = [job for job in self.jobs if job.case == HEADLINE and job.statement.of_every_case]
        if not (self.scope.statements and first):
            return [list(self.jobs)]
        return [first, [job for job in self.jobs if job not in first]]

    def keys(self) -> list[Key]:
        """Return the sorted identities of all jobs whose results are rows of tables. Pictures are left out."""
        return sorted(job.identity for job in self.jobs if isinstance(job.statement.file, CsvFile))

    def check(self) -> None:
        """Check before a run that all cases can be measured on all levels, and that every mesh fits its body.

        Raises:
            UsageError: the levels or the time scheme cannot be used, or a case of a user cannot be measured.
            MeshError: a mesh does not fit the boundary parts of a body, or there is no quadrature rule for a cell in
                which the solution is not smooth.
        """
        self.scope.check()
        self._check_meshes()
        for reference in self.scope.cases:
            check_own(reference)

    def _check_meshes(self) -> None:
        """Check that every mesh fits its body and the lines along which a solution is not smooth.

        Only meshes of statements that are measured for every case are checked. Other statements choose meshes that are
        known to fit. Each mesh is made once for all cases on bodies of the same shape.

        Raises:
            MeshError: a mesh does not fit.
        """
        groups: dict[tuple[Hashable, str, int], list[Case]] = {}
        for setting in (job.setting for job in self.jobs if job.statement.of_every_case):
            case = resolve(setting.case)
            groups.setdefault((shape(case.solution.body), setting.family, setting.level), []).append(case)
        for (_, family, level), cases in groups.items():
            case = cases[0]
            try:
                mesh = family_named(family)(case.solution.body, level)
                boundary_parts(mesh, case.solution.body)
                for case in cases:
                    rough_cells(mesh, [Line(*line) for line in case.solution.rough], case.solution.singular)
            except MeshError as error:
                raise MeshError(f"{case.name}, {family}, level {level}: {error}") from error


def shape(body: Body) -> Hashable:
    """Return a value that is equal for bodies with the same boundary parts and interfaces, and so the same meshes."""
    return tuple((part.kind, *part.corners.ravel()) for part in (*body.parts, *body.interfaces))


NARROW_CASES = ("merging-patches", "layered")
"""Cases whose contact zones or layers are only three or four cells wide with n = 8. There the observed order depends on
the mesh, so these cases begin with a finer level. In the full study, cases in 3D begin with n = 9 for the same reason.
With n = 6, a contact zone in the form of a disc is three cells wide, and on one random mesh in twenty the observed
order would lie outside its window. The quick study has only one-diagonal meshes in 3D."""


FINER_CASES = ("advance-recede", "yield-and-release", "yield-on-a-part", "corner", "hexagon")
"""Plane cases that the quick study measures on finer meshes than others.

On coarser meshes the errors of the first three cases no longer notice some deliberate faults. The boundary condition of
``corner`` changes at a quarter of a side, where the mesh with n = 6 has no vertex. On the hexagon with n = 6, the loads
by two quadrature rules differ by more than the window of the second solver.
"""
COVER = (
    *("full-contact", "advance-recede", "load-w11", "yield-and-release", "yield-on-a-part", "anisotropic"),
    *("heterogeneous", "layered", "corner", "hexagon", "cube-disc", "cube-two-faces", "natural-front", "junction"),
    *("softening", "closing-gap", "parabolic-gap"),
)
"""The cases of the quick study. Together they notice every deliberate fault as ``study.ledger.controls.missed``
demands: smooth solutions with linear laws, the law (3.3), coupled and varying moduli, several faces, space, rough
solutions, a law that softens, and initial gaps."""


PLANE_LEVELS = Levels((8, 16, 32))
"""The levels of plane cases that are measured alone or on random meshes. The windows of orders were set on them."""


def quick() -> Scope:
    """Return the scope of the quick study: all statements, one mesh family for each case.

    The quick study takes less than a minute on two cores.
    """
    return Scope(
        name="quick",
        cases=COVER,
        plane=Levels((6, 12, 24)),
        rough=Levels((8, 16, 32, 64)),
        solid=Levels((6, 9, 12)),
        equivalence=(4, 8),
        solid_equivalence=(3,),
        every_family=False,
        own=(
            *((name, Levels((16, 24, 36))) for name in NARROW_CASES),
            *((name, PLANE_LEVELS) for name in FINER_CASES),
        ),
    )


def full() -> Scope:
    """Return the scope of the full study, which takes 20 to 30 minutes: all cases, more meshes."""
    return replace(
        quick(),
        plane=Levels((8, 16, 32, 64)),
        rough=Levels((8, 16, 32, 64, 128)),
        solid=Levels((9, 12, 18)),
        equivalence=(4, 8, 16),
        solid_equivalence=(3, 6),
        name="full",
        cases=NAMES,
        own=(
            *((name, Levels((16, 32, 64))) for name in NARROW_CASES),
            ("advance-recede", Levels((8, 16, 32, 64), (128, 256))),
            ("cube-disc", Levels((9, 12, 18), (24,))),
        ),
    )
