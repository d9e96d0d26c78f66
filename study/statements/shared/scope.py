"""What a study is about: which cases, on which mesh families, at which levels."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from manufactured.case import Case
from manufactured.catalogue import catalogue
from study.fem.mesh import FAMILIES, MeshFamily
from study.fem.naming import choose, resolve
from study.ledger.errors import UsageError
from study.solve.steps import StepsError, rate_steps, require_steps
from study.solve.tableau import SCHEMES


def serving(case: Case) -> list[MeshFamily]:
    """The families that can mesh the body of a case, structured ones first; UsageError if there are none."""
    if found := [family for family in FAMILIES if family.serves(case.solution.body)]:
        return found
    raise UsageError(f"no mesh family can mesh the body of {case.name}: in 3D it has to be a parallelepiped")


@dataclass(frozen=True)
class Levels:
    """The levels for one kind of case: on every mesh family that is used, and finer ones on its first family only."""

    all: tuple[int, ...]
    first: tuple[int, ...] = ()

    def of(self, position: int) -> tuple[int, ...]:
        """The levels on the family at a position."""
        return self.all if position else (*self.all, *self.first)


@dataclass(frozen=True)
class Scope:
    """What a study is about.

    Attributes:
        name: quick or full.
        cases: references, catalogue names or FILE.py:NAME.
        plane, rough, solid: levels for plane cases with (5.36), for others, whose orders need more of them, and in 3D.
        equivalence, solid_equivalence: levels of Theorem 4.2 on one mesh, in 2D and 3D.
        every_family: whether cases are measured on all mesh families that serve them. Otherwise plane cases with (5.36)
            on one in turn, a twin on that of its twin, and others on the first, and on graded meshes beside it where
            a body has points to refine to.
        scheme: name of the time scheme.
        k: time step at every level; without it each case's own.
        statements: whether all statements are measured, or only those that are measured on every case.
        own: pairs (case, levels) of cases that have other levels.
        command: what is typed to have it measured, for messages.
    """

    name: str
    cases: tuple[str, ...]
    plane: Levels
    rough: Levels
    solid: Levels
    equivalence: tuple[int, ...]
    solid_equivalence: tuple[int, ...]
    every_family: bool = True
    scheme: str = "midpoint"
    k: float | None = None
    statements: bool = True
    own: tuple[tuple[str, Levels], ...] = ()
    command: str = "study run"

    @property
    def full(self) -> bool:
        """Whether it is the full study."""
        return self.name == "full"

    @property
    def whole(self) -> bool:
        """Whether every case of the catalogue is studied."""
        return {case.name for case in catalogue()} <= set(self.cases)

    def resolved(self) -> list[Case]:
        """The cases."""
        return [resolve(reference) for reference in self.cases]

    def check(self) -> None:
        """Refuse levels, steps and names that make no study.

        Raises:
            UsageError: levels below 2, not increasing, a time step beyond T, far too small or so long that it need not
                have one solution, two cases of one name, or a body that no mesh family serves.
        """
        if self.k is not None and not 0 < self.k <= min(case.solution.body.T for case in self.resolved()):
            raise UsageError(f"the time step must be positive and at most T, got k = {self.k:g}")
        for levels in (kind.of(0) for kind in (self.plane, self.rough, self.solid)):
            if not levels or min(levels) < 2:
                raise UsageError(f"levels must be 2 or more, got {' '.join(map(str, levels)) or 'none'}")
            if any(b <= a for a, b in pairwise(levels)):
                given = " ".join(map(str, levels))
                raise UsageError(f"levels must increase, got {given}; sort them and drop repetitions")
        names = [case.name for case in self.resolved()]
        if len(set(names)) < len(names):
            raise UsageError(f"two cases have the same name among {', '.join(names)}; rename one")
        for case in self.resolved():
            serving(case)
            require_steps(self.steps(case, max(self.levels_of(case).of(0))))
            self._require_unique(case)

    def _require_unique(self, case: Case) -> None:
        """Refuse time steps of a case whose law softens that need not have one solution."""
        solution = case.solution
        steps = self.steps(case, min(self.levels_of(case).of(0)))
        try:
            choose("scheme", self.scheme, SCHEMES).require_unique(solution.body.T / steps, solution.law.growth)
        except StepsError as error:
            raise UsageError(f"{case.name}: {error}") from error

    def steps(self, case: Case, level: int) -> int:
        """Time steps at a level: of the size asked for, or as many as the case's pace says."""
        T = case.solution.body.T
        return rate_steps(T, level, case.pace) if self.k is None else round(T / self.k)

    def families_of(self, case: Case) -> list[MeshFamily]:
        """The mesh families a case is measured on, graded ones where there are."""
        families = serving(case)
        if self.every_family:
            return families
        if case.solution.body.refine:
            return [families[0], families[-1]]
        # Where fronts may lie anywhere in a cell, as on random meshes, rough cases need finer levels.
        if case.solution.body.dim == 3 or not case.regularity.satisfies_5_36:
            return families[:1]
        turn = [other.name for other in self.resolved()].index(case.twin or case.name)
        return [families[turn % len(families)]]

    def levels_of(self, case: Case) -> Levels:
        """The levels of a case."""
        for name, levels in self.own:
            if name == case.name:
                return levels
        if case.solution.body.dim == 3:
            return self.solid
        return self.plane if case.regularity.satisfies_5_36 else self.rough
