"""What a run computes: which cases, on which mesh families, at which levels."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

from manufactured.admissibility import Finding, SelfProofError, examine
from manufactured.case import Case
from manufactured.catalogue import catalogue
from study.fem.line import Line
from study.fem.mesh import FAMILIES, MeshError, MeshFamily, boundary_parts
from study.fem.naming import UsageError, family_named, resolve
from study.fem.quadrature import rough_cells
from study.run import pictures
from study.run.job import EquivalenceJob, Job, PictureJob, RateJob, StatementJob, StressJob
from study.solve.steps import rate_steps
from study.statements import STATEMENTS
from study.statements.enclosure.jobs import BoundJob
from study.statements.enclosure.plan import full_bounds, quick_bounds
from study.statements.thm_4_2.own_space import places


@dataclass(frozen=True)
class Levels:
    """The levels of a plan for one kind of case.

    Attributes:
        all: levels on every mesh family that is used.
        first: finer levels on the first family of a case only.
    """

    all: tuple[int, ...]
    first: tuple[int, ...] = ()

    def of(self, position: int) -> tuple[int, ...]:
        """The levels on the family at a position."""
        return self.all if position else (*self.all, *self.first)


@dataclass(frozen=True)
class Plan:
    """What a run computes.

    Attributes:
        cases: references, catalogue names or FILE.py:NAME.
        plane: levels for plane cases with (5.36).
        rough: levels for the others, whose orders need more of them.
        solid: levels in 3D.
        equivalence, solid_equivalence: levels of the check of Theorem 4.2, in 2D and 3D.
        every_family: whether cases are measured on all mesh families that serve them. Otherwise plane cases with (5.36)
            on one in turn, a twin on that of its twin, and others on the first, and on graded meshes beside it where
            a body has points to refine to.
        scheme: name of the time scheme.
        name: quick or full, for the provenance.
        k: time step at every level; without it each case's own.
        statements: whether the numbered statements are measured one by one, and Problem 3.2 on its own space, too.
        own: pairs (case, levels) of cases that have other levels.
    """

    cases: tuple[str, ...]
    plane: Levels
    rough: Levels
    solid: Levels
    equivalence: tuple[int, ...]
    solid_equivalence: tuple[int, ...]
    every_family: bool = True
    scheme: str = "midpoint"
    name: str = "quick"
    k: float | None = None
    statements: bool = True
    own: tuple[tuple[str, Levels], ...] = ()

    def resolved(self) -> list[Case]:
        return [resolve(reference) for reference in self.cases]

    def check_settings(self) -> None:
        """Refuse levels, steps and names that make no plan.

        Raises:
            UsageError: levels below 2, not increasing, a time step beyond T, two cases of one name, or a body
                that no mesh family serves.
        """
        if self.k is not None and not 0 < self.k <= min(case.solution.body.T for case in self.resolved()):
            raise UsageError(f"the time step must be positive and at most T, got k = {self.k:g}")
        for kind in (self.plane, self.rough, self.solid):
            levels = kind.of(0)
            if not levels or min(levels) < 2:
                raise UsageError(f"levels must be 2 or more, got {' '.join(map(str, levels)) or 'none'}")
            if any(b <= a for a, b in pairwise(levels)):
                raise UsageError(
                    f"levels must increase, got {' '.join(map(str, levels))}; sort them and drop repetitions"
                )
        names = [case.name for case in self.resolved()]
        if len(set(names)) < len(names):
            raise UsageError(f"two cases have the same name among {', '.join(names)}; rename one")
        for case in self.resolved():
            if not any(family.serves(case.solution.body) for family in FAMILIES):
                raise UsageError(
                    f"no mesh family can mesh the body of {case.name}: in 3D it has to be a parallelepiped"
                )

    def check(self, spread: Callable[..., Iterable[Any]] = map) -> None:
        """Refuse what cannot be run, before time is spent; ``spread`` maps a function over cases.

        Raises:
            UsageError: of ``check_settings``.
            SelfProofError: a case is not an exact solution.
            MeshError: a mesh does not fit the boundary parts of a body, or no cell rule serves the places where a
                solution is rough.
        """
        self.check_settings()
        # Those in space take longest: last, one of them would be waited for alone.
        cases = sorted(self.cases, key=lambda reference: -resolve(reference).solution.body.dim)
        found = spread(violations, cases)
        # Beside the proofs, where they run in other processes.
        self._check_meshes()
        for reference, failed in zip(cases, found, strict=True):
            if failed:
                raise SelfProofError(f"case {resolve(reference).name}", failed)

    def _check_meshes(self) -> None:
        """Every mesh must fit its body, and its cells the rough places of every solution that is measured on it."""
        groups: dict[Hashable, list[tuple[Case, str, int]]] = {}
        for case, family, level in self.meshes():
            body = case.solution.body
            shape = tuple((part.kind, *part.corners.ravel()) for part in (*body.parts, *body.interfaces))
            groups.setdefault((shape, family, level), []).append((case, family, level))
        for group in groups.values():
            case, family, level = group[0]
            try:
                mesh = family_named(family)(case.solution.body, level)
                boundary_parts(mesh, case.solution.body)
                for case, _, _ in group:
                    rough_cells(mesh, [Line(*line) for line in case.solution.rough], case.solution.singular)
            except MeshError as error:
                raise MeshError(f"{case.name}, {family}, level {level}: {error}") from error

    def meshes(self) -> Iterator[tuple[Case, str, int]]:
        """(case, mesh family, level) of every job; the numbered statements choose meshes that serve."""
        for job in self.jobs:
            if isinstance(job, RateJob | EquivalenceJob):
                yield resolve(job.case), job.family, job.level
            elif isinstance(job, StressJob):
                yield resolve(job.place.case), job.place.family, job.place.level
            elif isinstance(job, PictureJob):
                case = resolve(job.case)
                family, level = pictures.mesh_for(case.solution.body)
                yield case, family.name, level
            elif isinstance(job, BoundJob) and job.problem in self.cases:
                yield resolve(job.problem), job.family, job.level

    def steps(self, case: Case, level: int) -> int:
        """Time steps at a level: of the size asked for, or as many as the case's pace says."""
        T = case.solution.body.T
        return rate_steps(T, level, case.pace) if self.k is None else round(T / self.k)

    def keys(self) -> list[tuple[str, ...]]:
        """What identifies the rows of the data files, sorted."""
        found: list[tuple[str, ...]] = []
        for job in self.jobs:
            if isinstance(job, RateJob):
                found.append((resolve(job.case).name, job.family, job.scheme, str(job.level)))
            elif isinstance(job, EquivalenceJob):
                found.append((resolve(job.case).name, job.family, str(job.level)))
            elif isinstance(job, BoundJob):
                found.append((job.trajectory.name, job.problem, job.family, job.scheme, str(job.level)))
            elif isinstance(job, StressJob):
                found.append((job.place.case, job.place.family, str(job.place.level), "stress"))
            elif isinstance(job, StatementJob):
                found.append((job.label, job.setting.case, job.setting.family, str(job.setting.level), "statement"))
        return sorted(found)

    def families_of(self, case: Case) -> list[MeshFamily]:
        """The mesh families a case is measured on, graded ones where there are."""
        serving = [family for family in FAMILIES if family.serves(case.solution.body)]
        if self.every_family:
            return serving
        if case.solution.body.refine:
            return [serving[0], serving[-1]]
        # Where fronts may lie anywhere in a cell, as on random meshes, rough cases need finer levels.
        if case.solution.body.dim == 3 or not case.regularity.satisfies_5_36:
            return serving[:1]
        turn = [other.name for other in self.resolved()].index(case.twin or case.name)
        return [serving[turn % len(serving)]]

    def levels_of(self, case: Case) -> Levels:
        """The levels of a case."""
        for name, levels in self.own:
            if name == case.name:
                return levels
        if case.solution.body.dim == 3:
            return self.solid
        return self.plane if case.regularity.satisfies_5_36 else self.rough

    @cached_property
    def jobs(self) -> tuple[Job, ...]:
        """All jobs of the plan."""
        jobs: list[Job] = []
        for reference in self.cases:
            case = resolve(reference)
            families, levels = self.families_of(case), self.levels_of(case)
            jobs += [
                RateJob(reference, family.name, self.scheme, n, self.steps(case, n))
                for position, family in enumerate(families)
                for n in levels.of(position)
            ]
            plane = case.solution.body.dim == 2
            jobs += [
                EquivalenceJob(reference, family.name, n, 2 * n)
                for family in (families if self.every_family else families[:1])
                for n in (self.equivalence if plane else self.solid_equivalence)
            ]
        jobs += self.picture_jobs()
        statements = (*self.stress_jobs(), *self.statement_jobs(), *self.bound_jobs()) if self.statements else ()
        return (*jobs, *statements)

    def picture_jobs(self) -> list[Job]:
        """What the figures show of a case."""
        return [PictureJob(case) for case in self.cases]

    def stress_jobs(self) -> list[Job]:
        """Problem 3.2 on its own stress space, on the cases of the plan."""
        return [StressJob(place) for place in places(self.name == "full") if place.case in self.cases]

    def bound_jobs(self) -> list[BoundJob]:
        """The bounds of the errors of the cases of the plan."""
        return (full_bounds if self.name == "full" else quick_bounds)(self.resolved())

    def statement_jobs(self) -> list[Job]:
        """The measurements of numbered statements on the cases of the plan."""
        return [
            StatementJob(statement.label, setting)
            for statement in STATEMENTS
            for setting in statement.settings(self.name == "full")
            if setting.case in self.cases
        ]


def violations(reference: str) -> list[Finding]:
    """The conditions that the exact solution of a case violates."""
    return [finding for finding in examine(resolve(reference).solution) if not finding.passes]


NARROW = ("merging-patches", "layered")
"""Two patches of contact of three or four cells at n = 8, and a front above a layer of four: there orders depend on the
mesh and on the constants of a case, and these start where they do not. So do solids, at n = 9: a disc is three cells
wide at n = 6, and the fitted order misses its window on one random mesh in twenty."""
FINEST = ("fixed-front-off-vertex", "advance-recede")
"""Cases that are measured on one level more."""


def quick() -> Plan:
    """A minute's worth: enough levels for every verdict, a mesh family for each case."""
    return Plan(
        cases=tuple(case.name for case in catalogue()),
        plane=Levels((8, 16, 32)),
        rough=Levels((8, 16, 32, 64)),
        solid=Levels((9, 12, 15)),
        equivalence=(4, 8),
        solid_equivalence=(3,),
        every_family=False,
        own=tuple((name, Levels((16, 24, 36))) for name in NARROW),
    )


def full() -> Plan:
    """The levels of the committed results: half an hour."""
    return replace(
        quick(),
        plane=Levels((8, 16, 32, 64), (128,)),
        rough=Levels((8, 16, 32, 64, 128)),
        solid=Levels((9, 12, 18), (24,)),
        equivalence=(4, 8, 16),
        solid_equivalence=(3, 6),
        every_family=True,
        name="full",
        own=(
            *((name, Levels((16, 32, 64), (128,))) for name in NARROW),
            *((name, Levels((8, 16, 32, 64), (128, 256))) for name in FINEST),
        ),
    )
