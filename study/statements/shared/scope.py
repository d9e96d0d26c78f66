"""The scope of a study: the cases, mesh families, levels and time scheme with which it runs."""

import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Self

from manufactured.case import Case
from study.fem.mesh import FAMILIES, MeshFamily
from study.fem.naming import choose, family_named, resolve
from study.ledger.files import UsageError
from study.solve.steps import StepsError, rate_steps, require_steps
from study.solve.tableau import SCHEMES

REGULAR = "one-diagonal", "unstructured"
"""Mesh families for statements that use one family for each case: the first that can mesh the body is used."""


ON_EVERY_FAMILY = ("advance-recede", "cube-disc")
"""The cases that the full study measures on every mesh family that can mesh their bodies."""


def serving(case: Case) -> list[MeshFamily]:
    """Return the mesh families that can mesh the body of a case, structured families first.

    Raises:
        UsageError: no family can mesh the body.
    """
    if found := [family for family in FAMILIES if family.serves(case.solution.body)]:
        return found
    raise UsageError(f"no mesh family can mesh the body of {case.name}: in 3D it has to be a parallelepiped")


def regular(case: Case) -> MeshFamily:
    """Return the mesh family for a case that is measured on one family only.

    It is the first family of ``REGULAR`` that can mesh the body.

    Raises:
        UsageError: no family can mesh the body.
    """
    served = {family.name: family for family in serving(case)}
    return next(served[name] for name in REGULAR if name in served)


@dataclass(frozen=True)
class Levels:
    """The refinement levels on which one kind of case is measured.

    Attributes:
        all: the levels on every mesh family.
        first: further, finer levels, which are used only on the mesh family that ``regular`` returns for a case.
    """

    all: tuple[int, ...]
    first: tuple[int, ...] = ()

    @property
    def on_regular(self) -> tuple[int, ...]:
        """The levels on the mesh family that ``regular`` returns for a case: ``all``, then ``first``."""
        return (*self.all, *self.first)


@dataclass(frozen=True)
class Scope:
    """What a study measures: cases, mesh families, levels and time scheme.

    Attributes:
        name: quick or full.
        cases: the cases, by their names in the catalogue or as FILE.py:NAME.
        plane, rough, solid: levels of the meshes for three kinds of cases: plane cases with the regularity (5.36) that
            Proposition 5.4 assumes, plane cases without it, whose orders need more levels, and cases in 3D.
        equivalence, solid_equivalence: levels in 2D and in 3D on which Theorem 4.2, the equivalence of the displacement
            problem and the stress problem, is tested.
        every_family: whether cases are measured on all mesh families that can mesh their bodies. Otherwise each case
            is measured on the families that it names, in the full study also on the family that ``regular`` returns.
        scheme: name of the time scheme.
        k: time step at every level; None for the numbers of steps that follow from the pace of each case (``steps``).
        statements: whether all statements are measured, or only those that are measured on every case.
        own: pairs (case name, levels) for single cases that have other levels than those above: cases that need finer
            meshes, or a user's case whose new levels are added to levels that a run has measured.
        command: the command that runs the study, shown in messages.
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
        """Whether this is the full study and not the quick one."""
        return self.name == "full"

    def of_the_paper(self) -> Self:
        """Return the scope without the cases that have an initial gap."""
        without_gap = [reference for reference in self.cases if not resolve(reference).solution.has_initial_gap]
        return replace(self, cases=tuple(without_gap))

    def on_families(self) -> Iterator[tuple[str, Case, MeshFamily]]:
        """Yield every case of the study with each of its mesh families, as (name of the case, case, mesh family)."""
        for reference, case in zip(self.cases, self.resolved(), strict=True):
            for family in self.families_of(case):
                yield reference, case, family

    def resolved(self) -> list[Case]:
        """Return the case objects for the names in ``cases``."""
        return [resolve(reference) for reference in self.cases]

    def check(self) -> None:
        """Check the levels, the time steps and the names of cases and meshes.

        Raises:
            UsageError: levels are below 2 or do not increase; the time step is longer than T, far too short, or so long
                that the problem of one step may have no or several solutions; two cases have the same name; or no
                family can mesh a body.
        """
        shortest = min(case.solution.body.T for case in self.resolved())
        if self.k is not None and not sys.float_info.min < self.k <= shortest:
            raise UsageError(f"the time step must be positive and at most T, got k = {self.k:g}")
        for levels in (kind.on_regular for kind in (self.plane, self.rough, self.solid)):
            if not levels or min(levels) < 2:
                raise UsageError(f"levels must be 2 or more, got {' '.join(map(str, levels)) or 'none'}")
            if list(levels) != sorted({*levels}):
                given = " ".join(map(str, levels))
                raise UsageError(f"levels must increase, got {given}; sort them and drop repetitions")
        names = [case.name for case in self.resolved()]
        if len(set(names)) < len(names):
            raise UsageError(f"two cases have the same name among {', '.join(names)}; rename one")
        scheme = choose("scheme", self.scheme, SCHEMES)
        for case in self.resolved():
            self.families_of(case)
            levels = self.levels_of(case).on_regular
            T = case.solution.body.T
            require_steps(self.steps(case, max(levels)))
            try:  # Long steps are refused: if the law softens, their problem may have no or several solutions.
                scheme.require_unique(T / self.steps(case, min(levels)), case.solution.law.growth)
            except StepsError as error:
                raise UsageError(f"{case.name}: {error}") from error

    def steps(self, case: Case, level: int) -> int:
        """Return the number of time steps for a case at a level.

        It is T/k, rounded, for the given time step k. If k is None, it is ⌈pace · T · n^{2/3}⌉ at the level n, with the
        attribute ``pace`` of the case.
        """
        T = case.solution.body.T
        return rate_steps(T, level, case.pace) if self.k is None else round(T / self.k)

    def families_of(self, case: Case) -> list[MeshFamily]:
        """Return the mesh families on which a case is measured.

        Raises:
            UsageError: the attribute ``families`` of the case names a family that does not exist or cannot mesh its
                body.
        """
        families = serving(case)
        if self.every_family or (self.full and case.name in ON_EVERY_FAMILY):
            return families
        named = [family_named(name) for name in case.families]
        for family in named:
            if not family.serves(case.solution.body):
                known = ", ".join(other.name for other in families)
                raise UsageError(f"{case.name}: {family.name} meshes cannot fit its body; name one of {known}")
        chosen = [*named, regular(case)] if self.full or not named else named
        return [family for family in families if family in chosen]

    def levels_on(self, case: Case, family: MeshFamily) -> tuple[int, ...]:
        """Return the levels of a case on a mesh family."""
        levels = self.levels_of(case)
        return levels.on_regular if family.name == regular(case).name else levels.all

    def levels_of(self, case: Case) -> Levels:
        """Return the levels of a case."""
        if levels := dict(self.own).get(case.name):
            return levels
        if case.solution.body.dim == 3:
            return self.solid
        return self.plane if case.regularity.satisfies_5_36 else self.rough
