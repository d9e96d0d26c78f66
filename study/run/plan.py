"""What a run computes: the jobs of a study, checked before time is spent."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

from manufactured.case import Case
from manufactured.catalogue import catalogue
from manufactured.self_proof import Finding, SelfProofError, examine
from study.fem.mesh import MeshError, boundary_parts
from study.fem.naming import family_named, resolve
from study.fem.quadrature import Line, rough_cells
from study.ledger.datafiles import CsvFile
from study.ledger.errors import UsageError
from study.run.job import Job
from study.statements import STATEMENTS
from study.statements.shared.scope import Levels, Scope


@dataclass(frozen=True)
class Plan:
    """What a run computes: the jobs of a study of some scope."""

    scope: Scope
    jobs: tuple[Job, ...]

    @classmethod
    def of(cls, scope: Scope) -> Plan:
        """Everything that the statements measure of a study."""
        chosen = [statement for statement in STATEMENTS if scope.statements or statement.of_every_case]
        return cls(
            scope, tuple(Job(statement, setting) for statement in chosen for setting in statement.settings(scope))
        )

    def keys(self) -> list[tuple[str, ...]]:
        """What identifies the rows of the tables of measurements, sorted."""
        return sorted(job.identity for job in self.jobs if isinstance(job.statement.file, CsvFile))

    def check(self, spread: Callable[..., Iterable[Any]] = map) -> None:
        """Refuse what cannot be run, before time is spent; ``spread`` maps a function over cases.

        Raises:
            UsageError: of ``Scope.check``.
            SelfProofError: a case is not an exact solution.
            UsageError: an own case has the name of one of the catalogue.
            MeshError: a mesh does not fit the boundary parts of a body, or no cell rule serves the places where a
                solution is rough.
        """
        self.scope.check()
        # Those in space take longest: last, one of them would be waited for alone.
        cases = sorted(self.scope.cases, key=lambda reference: -resolve(reference).solution.body.dim)
        found = spread(violations, cases)
        # Beside the proofs, where they run in other processes.
        self._check_meshes()
        for reference, failed in zip(cases, found, strict=True):
            if failed:
                raise SelfProofError(f"case {resolve(reference).name}", failed)
        self._check_names()

    def _check_names(self) -> None:
        """No own case may pass for one of the catalogue: they are judged, shown and compared by their names."""
        known = {case.name for case in catalogue()}
        for reference in self.scope.cases:
            if reference not in known and (name := resolve(reference).name) in known:
                raise UsageError(f"{reference} is called {name}, as a case of the catalogue is; give it another name")

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
        """(case, mesh family, level) of what is measured on every case; other statements choose meshes that serve."""
        for job in self.jobs:
            if job.statement.of_every_case:
                yield resolve(job.setting.case), job.setting.family, job.setting.level


def violations(reference: str) -> list[Finding]:
    """The conditions that the exact solution of a case violates."""
    return [finding for finding in examine(resolve(reference).solution) if not finding.passes]


NARROW = ("merging-patches", "layered")
"""Two patches of contact of three or four cells at n = 8, and a front above a layer of four: there orders depend on the
mesh and on the constants of a case, and these start where they do not. So do solids, at n = 9: a disc is three cells
wide at n = 6, and the fitted order misses its window on one random mesh in twenty."""
FINEST = ("fixed-front-off-vertex", "advance-recede")
"""Cases that are measured on one level more."""


def quick() -> Scope:
    """A minute's worth: enough levels for every verdict, a mesh family for each case."""
    return Scope(
        name="quick",
        cases=tuple(case.name for case in catalogue()),
        plane=Levels((8, 16, 32)),
        rough=Levels((8, 16, 32, 64)),
        solid=Levels((9, 12, 15)),
        equivalence=(4, 8),
        solid_equivalence=(3,),
        every_family=False,
        own=tuple((name, Levels((16, 24, 36))) for name in NARROW),
    )


def full() -> Scope:
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
