"""The plan of a run: its jobs, each of which measures one statement in one setting, checked before time is spent."""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from manufactured.case import Case
from manufactured.catalogue import catalogue
from manufactured.self_proof import Finding, SelfProofError, examine
from study.fem.mesh import MeshError, boundary_parts
from study.fem.naming import family_named, name_of, resolve
from study.fem.quadrature import Line, rough_cells
from study.ledger.datafiles import CsvFile, DataFile, Row
from study.ledger.files import UsageError
from study.run.fingerprint import fingerprint
from study.statements import STATEMENTS
from study.statements.shared.base import Setting, Statement
from study.statements.shared.scope import SLOW, Levels, Scope


@dataclass(frozen=True)
class Job:
    """One statement, measured in one setting; small enough to be sent to other processes."""

    statement: Statement
    setting: Setting

    @property
    def identity(self) -> tuple[str, ...]:
        """The name of the data file and the key of the rows that this job writes, as text."""
        known = {"label": self.statement.label, "case": name_of(self.setting.case)}
        key = (str(known.get(column) or getattr(self.setting, column)) for column in self.statement.file.key)
        return self.statement.file.name, *key

    @property
    def key(self) -> str:
        """The name of the file with the result."""
        kind, *key = (re.sub(r"[^\w.]+", "-", part).strip("-") for part in self.identity)
        return "__".join([kind.removesuffix(".csv"), *(f"{part:0>5}" if part.isdigit() else part for part in key)])

    @property
    def cost(self) -> float:
        """Expected time in µs; decides the order of the jobs."""
        return self.statement.cost(self.setting)

    @property
    def memory(self) -> float:
        """Bytes of memory that the process of this job takes at most."""
        return self.statement.memory(self.setting)

    def fingerprint(self) -> str:
        """Return the cache key of the result."""
        return fingerprint(self.statement, self.setting)

    def run(self) -> Mapping[str, Any]:
        """Measure; returns numbers by their names."""
        return self.statement.measure(self.setting)

    def records(self, result: Mapping[str, Any]) -> Iterator[tuple[DataFile, Row]]:
        """Yield (data file, row) for each row that follows from the result."""
        return self.statement.records(self.setting, result)


@dataclass(frozen=True)
class Plan:
    """The jobs of a study, from its scope: cases, mesh families, levels and time scheme."""

    scope: Scope
    jobs: tuple[Job, ...]

    @classmethod
    def of(cls, scope: Scope) -> Plan:
        """Return the jobs of all statements that measure something in a scope."""
        statements = [
            statement
            for statement in STATEMENTS
            if scope.statements or statement.of_every_case or statement.of_own_cases
        ]
        jobs = [Job(statement, setting) for statement in statements for setting in statement.planned(scope)]
        return cls(scope, tuple(jobs))

    def keys(self) -> list[tuple[str, ...]]:
        """Return (file name, key of the row, …) of all rows of the tables, sorted."""
        return sorted(job.identity for job in self.jobs if isinstance(job.statement.file, CsvFile))

    def check(self, spread: Callable[..., Iterable[Any]] = map) -> None:
        """Refuse a plan that cannot be run, before time is spent; ``spread`` maps a function over cases.

        Raises:
            UsageError: the scope is refused by ``Scope.check``, or a user's case has the name of a catalogue case.
            SelfProofError: a case is not an exact solution.
            MeshError: a mesh does not fit the boundary parts of a body, or no cell rule serves the places where a
                solution is rough.
        """
        self.scope.check()
        # Solids first: they take longest, and the last of them would be waited for alone.
        cases = sorted(self.scope.cases, key=lambda reference: -resolve(reference).solution.body.dim)
        findings = spread(violations, cases)
        # Now, while other processes check the solutions.
        self._check_meshes()
        for reference, violated in zip(cases, findings, strict=True):
            if violated:
                raise SelfProofError(f"case {resolve(reference).name}", violated)
        # Results are told apart by the names of cases.
        known = {case.name for case in catalogue()}
        for reference in self.scope.cases:
            if reference not in known and (name := resolve(reference).name) in known:
                raise UsageError(f"{reference} is called {name}, as a case of the catalogue is; give it another name")

    def _check_meshes(self) -> None:
        """Refuse meshes that do not fit a body, or whose cells do not fit the lines where a solution is rough."""
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
        """Yield (case, mesh family, level) of the statements about every case; all others choose meshes that fit."""
        for job in self.jobs:
            if job.statement.of_every_case:
                yield resolve(job.setting.case), job.setting.family, job.setting.level


def violations(reference: str) -> list[Finding]:
    """Return the conditions that the exact solution of a case violates."""
    return [finding for finding in examine(resolve(reference).solution) if not finding.passes]


NARROW = ("merging-patches", "layered")
"""Cases with contact zones or layers that are three or four cells wide at n = 8: there the observed order depends on
the mesh, so these cases start at a finer level. Solids start at n = 9 for the same reason: at n = 6 a disc is three
cells wide, and the observed order misses its tolerance window on one random mesh in twenty."""
FINEST = ("fixed-front-off-vertex", "advance-recede")
"""Cases that are measured on one more level."""


def quick() -> Scope:
    """Return the scope of the quick study, a minute: enough levels for every verdict, one mesh family for each case."""
    return Scope(
        name="quick",
        cases=tuple(case.name for case in catalogue() if case.name not in SLOW),
        plane=Levels((8, 16, 32)),
        rough=Levels((8, 16, 32, 64)),
        solid=Levels((9, 12, 15)),
        equivalence=(4, 8),
        solid_equivalence=(3,),
        every_family=False,
        own=tuple((name, Levels((16, 24, 36))) for name in NARROW),
    )


def full() -> Scope:
    """Return the scope of the full study, half an hour: the levels of the committed results."""
    return replace(
        quick(),
        plane=Levels((8, 16, 32, 64), (128,)),
        rough=Levels((8, 16, 32, 64, 128)),
        solid=Levels((9, 12, 18), (24,)),
        equivalence=(4, 8, 16),
        solid_equivalence=(3, 6),
        every_family=True,
        name="full",
        cases=tuple(case.name for case in catalogue()),
        own=(
            ("long-time", Levels((8, 16, 32), (64,))),
            ("cube-rough", Levels((9, 12, 18, 24))),
            *((name, Levels((16, 32, 64), (128,))) for name in NARROW),
            *((name, Levels((8, 16, 32, 64), (128, 256))) for name in FINEST),
        ),
    )
