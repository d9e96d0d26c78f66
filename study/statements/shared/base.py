"""Base classes of statements.

A statement is a claim of the paper or of this study. It is measured in several settings, each of which is a test case
on one mesh. Criteria compare the measured numbers with tolerance windows.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from manufactured.exact import ExactSolution
from study.fem.error_norm import ErrorNorm
from study.fem.mesh import MeshFamily
from study.fem.naming import family_named, name_of, resolve
from study.fem.space import Space
from study.ledger.check import MIN_LEVELS, Check, Groups, by_case, by_family, consequence
from study.ledger.datafiles import CsvFile, DataFile, Row
from study.ledger.quantities import fitted
from study.ledger.verdict import Verdict
from study.ledger.window import Window
from study.solve.evolution import Scheme, SemiDiscrete, State
from study.solve.steps import stress_steps
from study.solve.tableau import Tableau
from study.statements.shared import estimates
from study.statements.shared.scope import Scope


@dataclass(frozen=True, order=True)
class Setting:
    """A test case on one mesh.

    Attributes:
        case: the name of the case in the catalogue, or FILE.py:NAME for a case of a user.
        family: the name of the mesh family.
        level: the refinement level n of the mesh.
    """

    case: str
    family: str
    level: int

    @property
    def dim(self) -> int:
        """The dimension of the body, 2 or 3."""
        return resolve(self.case).solution.body.dim


JOINED_SUFFIX = "_reported"
"""Suffix of the names of the columns that come from the second data file, ``Statement.joined_file``."""


Numbers = dict[str, Any]
"""The type of measured numbers: a dict from their names to values."""
Records = Iterator[tuple[DataFile, Row]]
"""The type of the rows that a measurement adds to data files, each as a pair of the file and the row."""
ByCase = Iterable[tuple[str, Groups]]
"""The type of measurements by case: pairs of the name of a case and its tables of levels, by mesh family."""
Judged = Iterable[tuple[Check, Groups]]
"""The type of the checks of a case: pairs of a check and the tables of levels that it judges, by mesh family."""


class Statement:
    """A claim of the paper or of this study, with its measurement and its criteria.

    A subclass sets the attributes and overrides ``measure``. It does not override ``measure`` if the measurements of
    another statement suffice to judge it. By default each measurement is one row of the data file, and each criterion
    is applied to every case. Two instances of one class are equal.

    Attributes:
        label: the number of the formula or theorem in the paper, or a short name.
        claim: the claim in words.
        file: the data file with the rows from which the statement is judged.
        joined_file: a second data file or None. Its columns are added to the rows of ``file`` that have the same key,
            under the names ``NAME_reported``.
        checks: the criteria. By default each gives one verdict for every measured case, which is a row of the ledger,
            the table of all verdicts.
        quick, full: the settings of the quick and of the full study, from which ``settings`` chooses by default.
        of_every_case: whether the statement is measured on every case of a run, including the cases of users. A run of
            single cases measures only such statements, and those with ``of_own_cases``. ``settings`` must then return
            their settings.
        initial_gap: whether the statement is also measured on cases with an initial gap; the paper has no such gap.
        of_own_cases: whether the statement is measured on the cases of users, but only on some cases of the catalogue;
            ``settings`` must then return the settings for both.
        outside_catalogue: whether the cases of ``quick`` and ``full`` are missing in the catalogue. Such a statement is
            measured in studies of all statements, whatever their cases are.
        per_step: expected run time in µs for each cell and time step, in the plane and in space.
    """

    label: str
    claim: str
    file: DataFile
    joined_file: CsvFile | None = None
    checks: Sequence[Check] = ()
    quick: Sequence[Any] = ()
    full: Sequence[Any] = ()
    of_every_case: bool = False
    initial_gap: bool = False
    of_own_cases: bool = False
    outside_catalogue: bool = False
    per_step: tuple[float, float] = (0.0, 0.0)

    def planned(self, scope: Scope) -> Sequence[Any]:
        """Return the settings (case, mesh family, level) in which a study measures the statement.

        A study calls this method. It calls ``settings``, for a scope without the cases that have an initial gap unless
        the attribute ``initial_gap`` is set. Subclasses override ``settings`` or ``places``.

        Args:
            scope: the cases, mesh families and levels of the study.
        """
        return self.settings(scope if self.initial_gap else scope.of_the_paper())

    def places(self, full: bool) -> Sequence[Any]:
        """Return the settings of the full study if ``full`` is true, otherwise of the quick study, for all cases.

        A setting is a case with a mesh family and a level. ``settings`` chooses the cases of a study among them.
        A subclass overrides this method to compute the settings instead of giving ``quick`` and ``full``.
        """
        return self.full if full else self.quick

    def settings(self, scope: Scope) -> Sequence[Any]:
        """Return those settings from ``places`` whose case is one of the cases of the study.

        If the cases are not in the catalogue (``outside_catalogue``), all settings are returned in a study of all
        statements, otherwise none. A subclass overrides this method if its settings depend on the cases of the study.

        Args:
            scope: the cases, mesh families and levels of the study.
        """
        if self.outside_catalogue:
            return self.places(scope.full) if scope.statements else []
        return [setting for setting in self.places(scope.full) if setting.case in scope.cases]

    def setup(self, setting: Any) -> Any:
        """Return the argument of ``measure`` for a setting; by default the setting itself.

        It may be a discretised problem, of which a control replaces a part by a deliberate fault
        (``study.controls.faults``).
        """
        return setting

    def measure(self, setup: Any) -> Row:
        """Return the measured numbers, by their names.

        Args:
            setup: what is measured, as returned by ``setup``.
        """
        raise NotImplementedError(f"{type(self).__name__}: nothing is measured")

    def run(self, setting: Any) -> Row:
        """Return the measured numbers of one setting, by their names."""
        return self.measure(self.setup(setting))

    def records(self, setting: Any, found: Row) -> Records:
        """Yield the rows that one measurement adds to data files, each as a pair of the data file and the row.

        By default there is one row with the setting and the measured numbers.

        Args:
            setting: the setting of the measurement.
            found: the measured numbers, as returned by ``measure``.
        """
        yield self.file, {**vars(setting), "case": name_of(setting.case), **found}

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        """Compare the measured numbers with the criteria, and return one verdict for each check.

        Args:
            rows: the measured rows of the data file, with the predicted orders of their cases as further columns.
        """
        verdicts = []
        for case, groups in self.by_case(rows):
            verdicts += [check.verdict(self, case, judged) for check, judged in self.checks_of(case, groups)]
        return verdicts

    def by_case(self, rows: pd.DataFrame) -> ByCase:
        """Divide measured rows by case, and yield pairs of a case and its tables, one for each mesh family.

        The rows of a table belong to different levels.
        """
        return [(str(case), by_family(mine)) for case, mine in rows.groupby("case", sort=False)]

    def checks_of(self, case: str, groups: Groups) -> Judged:
        """Return the criteria for a case, each with the tables that it judges. By default ``checks`` judge all tables.

        Args:
            case: the name of the case.
            groups: the tables of this case by mesh family, with one row for each level.
        """
        return [(check, groups) for check in self.checks]

    def cost(self, setting: Any) -> float:
        """Return the expected run time of ``measure`` in µs.

        By default the time is proportional to the number of cells and to the number of time steps.
        """
        cells = setting.level**setting.dim * estimates.cells(setting.family)
        return float(cells * self.steps(setting)) * self.per_step[setting.dim - 2]

    def memory(self, setting: Any) -> float:
        """Return an upper estimate in bytes of the memory of the process that runs ``measure``.

        By default the result is the memory for solving the displacement problem (Problem 5.1).
        """
        return estimates.displacement(setting.dim, setting.level, setting.family)

    def steps(self, setting: Any) -> int:
        """Return the number of time steps, which is part of the cache key of the result.

        It is the number in the setting, or 0 if the setting has none because ``measure`` itself chooses the number.
        """
        return int(getattr(setting, "steps", 0))

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other)

    def __hash__(self) -> int:
        return hash(type(self))


def check_of_order(
    key: str, quantity: str, column: str, window: Window, last: int = 0, power: int = 0, if_missed: str = ""
) -> Check:
    """Return the check that the observed order of a column in h, fitted to several levels, lies in a window.

    Args:
        key, quantity: a short name of the check, and the quantity in words.
        column: the name of the column with errors.
        window: the window of the order.
        last: the number of finest levels that are used; 0 for all.
        power: the exponent in the weights h^−power of the levels in the fit; 0 for equal weights.
        if_missed: why nothing is claimed, or empty (``Check``).
    """
    order = fitted(column, last, power)
    return consequence(key, quantity, order, window, levels=MIN_LEVELS, if_missed=if_missed)


SEED = 2002
"""Seed of all random numbers in measurements, so that every run gives the same numbers."""
EVOLVING = ("full-contact", "advance-recede", "travelling-patch", "yield-and-release", "yield-on-a-part")
"""The names of the cases on which statements about solutions in time are measured.

Together they have linear laws, the nonlinear law (3.3) and moving fronts between contact and gap.
"""
SOFTENING = ("softening", "double-well")
"""Two cases with an elasticity operator G that softens: G is Lipschitz, as (3.2) requires, but not monotone.

G is linear in the first case and nonlinear in the second."""
LISTED = CsvFile("statements.csv")
"""The data file of most statements. It has one row for each measured number."""


class ListedNumbers(Statement):
    """A statement whose measured numbers have one row each in ``statements.csv``.

    Attributes:
        effort: run time of a measurement of the statement divided by the typical run time at the same level.
    """

    file: DataFile = LISTED
    effort: float = 1.0

    def records(self, setting: Setting, found: Row) -> Records:
        """Yield one row of ``statements.csv`` for every measured number except the mesh size, which is in every row."""
        common = {"label": self.label, **vars(setting), "h": found["h"]}
        for quantity, value in found.items():
            if quantity != "h":
                yield self.file, {**common, "quantity": quantity, "value": value}

    def by_case(self, rows: pd.DataFrame) -> ByCase:
        return by_case(rows)

    def cost(self, setting: Setting) -> float:
        """Return the expected run time of a measurement in µs, estimated from the level and the dimension."""
        return self.effort * float(setting.level**2) * (230 if setting.dim == 2 else 30_000)

    def memory(self, setting: Setting) -> float:
        """Return the memory of a measurement in bytes, estimated from the level and the dimension."""
        return estimates.statement(setting.dim, setting.level)


def steps_like_h(setting: Setting) -> int:
    """Return an even number of time steps, so that the time step is k ~ h for the mesh size h.

    It is about pace/2 · T · n at the level n, but at least T · n and at most 4 · T · n. The pace is an attribute of the
    case. By the rule to which its name belongs, ``rate_steps``, the number grows only like n^{2/3}.
    """
    case = resolve(setting.case)
    return stress_steps(case.solution.body.T, setting.level, case.pace)


def grid(cases: Sequence[str], families: Sequence[str], levels: Sequence[int]) -> list[Setting]:
    """Return the settings that combine every case with every mesh family and every level."""
    return [Setting(case, family, n) for case in cases for family in families for n in levels]


def with_h(h: float, values: Mapping[str, float]) -> Numbers:
    """Return measured numbers together with the mesh size h, as ``ListedNumbers.measure`` must return them.

    Args:
        h: the mesh size, which gets the key "h".
        values: the measured numbers by their names.
    """
    return {"h": h, **{name: float(value) for name, value in values.items()}}


@dataclass(frozen=True, eq=False)
class Experiment:
    """A problem whose exact solution is known, discretised in space (Problem 5.1) and in time.

    Deliberate faults replace one attribute by a wrong value.

    Attributes:
        solution: the exact solution. The data follow from it, and computed displacements are compared with it.
        space: the P1 displacement space V^h.
        v_norm: computes the load and the errors in the norm of V.
        problem: the right semi-discrete problem, in whose norm errors are measured.
        scheme, steps: time scheme and number of time steps.
        solved: the wrong semi-discrete problem that is solved, if a deliberate fault sets it; if None, ``problem`` is
            solved.
    """

    solution: ExactSolution
    space: Space
    v_norm: ErrorNorm
    problem: SemiDiscrete
    scheme: Scheme
    steps: int
    solved: SemiDiscrete | None = None

    def march(self, steps: int) -> Iterator[State]:
        """Solve the problem with time steps of length T/steps, and yield the states at the time nodes."""
        return self.scheme.march(self.solved or self.problem, steps)

    @classmethod
    def of(cls, solution: ExactSolution, family: MeshFamily, level: int, scheme: Tableau, steps: int) -> Experiment:
        """Return the discretisation of the paper for an exact solution, on one mesh with a time scheme.

        ``SemiDiscrete.of_exact`` describes the discretisation in space.

        Args:
            solution: the exact solution.
            family, level: the mesh family and the level of the mesh.
            scheme: the time scheme.
            steps: the number of time steps.
        """
        space = Space(family(solution.body, level), solution.body)
        v_norm = ErrorNorm(solution, space)
        return cls(solution, space, v_norm, SemiDiscrete.of_exact(v_norm), scheme, steps)

    @classmethod
    def at(cls, setting: Setting, scheme: Tableau, steps: int) -> Experiment:
        """Return the discretisation of the paper for the case and the mesh of a setting.

        Args:
            setting: the case, the mesh family and the level.
            scheme: the time scheme.
            steps: the number of time steps.
        """
        return cls.of(resolve(setting.case).solution, family_named(setting.family), setting.level, scheme, steps)
