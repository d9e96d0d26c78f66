"""The pieces of work of a run, each a small picklable value with a key, a cost and a result."""

from __future__ import annotations

import hashlib
import inspect
import re
import sys
from dataclasses import asdict, dataclass, fields, is_dataclass
from functools import cache
from typing import Any, Protocol

import numpy as np
import sympy as sp

from manufactured.case import Case
from manufactured.exact import ExactSolution
from study.fem.mesh import MeshFamily
from study.fem.naming import choose, family_named, resolve
from study.run import resources as memory
from study.run.pictures import FORM, picture
from study.run.versions import versions
from study.solve.evolution import Scheme
from study.solve.steps import stress_steps
from study.solve.tableau import SCHEMES
from study.statements import STATEMENTS
from study.statements.base import Setting, Statement
from study.statements.prop_5_4.sweep import measure_case
from study.statements.thm_4_2.own_space import Place, measure_stresses
from study.statements.thm_4_2.same_mesh import compare

METHOD = 8
"""To be raised with every change of the code that changes numbers: older results are then computed anew.
A test measures small levels again and compares."""


def fingerprint(*settings: object) -> str:
    """A short hash of everything a result depends on: exact solution and settings, by value, and versions."""
    return hashlib.sha256(repr([METHOD, versions(), *map(_by_value, settings)]).encode()).hexdigest()[:16]


def _by_value(item: object) -> object:
    """Frozen dataclasses as their fields, formulas as text, arrays as lists, all the way down."""
    if isinstance(item, ExactSolution):
        return _of_solution(item)
    if is_dataclass(item) and not isinstance(item, type):
        return _of_fields(item)
    if isinstance(item, tuple | list):
        return [_by_value(entry) for entry in item]
    if isinstance(item, np.ndarray):
        return item.tolist()
    if isinstance(item, sp.Basic):
        return sp.srepr(item)
    return repr(item)


def _of_fields(item: Any) -> list[object]:
    return [type(item).__name__, *(_by_value(getattr(item, field.name)) for field in fields(item) if field.init)]


# Most jobs share the solution of their case with others, and its formulas are long.
_of_solution = cache(_of_fields)


class Job(Protocol):
    """A piece of work. ``cost`` is its expected time in µs, ``memory`` the bytes its process takes at most."""

    @property
    def key(self) -> str: ...
    @property
    def cost(self) -> float: ...
    @property
    def memory(self) -> float: ...

    def fingerprint(self) -> str: ...
    def run(self) -> dict[str, Any]: ...


@dataclass(frozen=True)
class RateJob:
    """One row of ``rates.csv``."""

    case: str
    family: str
    scheme: str
    level: int
    steps: int

    @property
    def key(self) -> str:
        return f"rate__{resolve(self.case).name}__{self.family}__{self.scheme}__{self.level:05d}"

    @property
    def cost(self) -> float:
        dim = resolve(self.case).solution.body.dim
        # A cell in 3D costs more: more components, a denser factor.
        return float(self.level**dim * self.steps) * (7 if dim == 2 else 150) * memory.cells(self.family)

    @property
    def memory(self) -> float:
        return memory.displacement(resolve(self.case).solution.body.dim, self.level, self.family)

    def parts(self) -> tuple[Case, MeshFamily, Scheme]:
        return (
            resolve(self.case),
            family_named(self.family),
            choose("scheme", self.scheme, SCHEMES),
        )

    def fingerprint(self) -> str:
        case, family, scheme = self.parts()
        return fingerprint(case.solution, family, scheme, self.level, self.steps)

    def run(self) -> dict[str, Any]:
        case, family, scheme = self.parts()
        return asdict(measure_case(case, family, self.level, scheme, self.steps))


@dataclass(frozen=True)
class EquivalenceJob:
    """One row of ``equivalence.csv``."""

    case: str
    family: str
    level: int
    steps: int

    @property
    def key(self) -> str:
        return f"equivalence__{resolve(self.case).name}__{self.family}__{self.level:05d}"

    @property
    def cost(self) -> float:
        dim = resolve(self.case).solution.body.dim
        return float(self.level**dim * self.steps) * (70 if dim == 2 else 1000)

    @property
    def memory(self) -> float:
        return memory.equivalence(resolve(self.case).solution.body.dim, self.level, self.family)

    def fingerprint(self) -> str:
        return fingerprint(resolve(self.case).solution, family_named(self.family), self.level, self.steps)

    def run(self) -> dict[str, Any]:
        return asdict(compare(resolve(self.case), family_named(self.family), self.level, self.steps))


@dataclass(frozen=True)
class StressJob:
    """One row of ``stresses.csv``."""

    place: Place

    @property
    def key(self) -> str:
        return f"stress__{self.place.case}__{self.place.family}__{self.place.level:05d}"

    @property
    def cost(self) -> float:
        return 65.0 * self.place.level**2 * self._steps

    @property
    def memory(self) -> float:
        return memory.stress(self.place.level)

    @property
    def _steps(self) -> int:
        case = resolve(self.place.case)
        return stress_steps(case.solution.body.T, self.place.level, case.pace)

    def fingerprint(self) -> str:
        case, family = resolve(self.place.case), family_named(self.place.family)
        return fingerprint("stress", case.solution, family, self.place.level, self._steps)

    def run(self) -> dict[str, Any]:
        case, family = resolve(self.place.case), family_named(self.place.family)
        return asdict(measure_stresses(case, family, self.place.level, self._steps))


@dataclass(frozen=True)
class StatementJob:
    """What one numbered statement measures in one setting."""

    label: str
    setting: Setting

    @property
    def key(self) -> str:
        label = re.sub(r"[^A-Za-z0-9.]+", "-", self.label).strip("-")
        return f"statement__{label}__{self.setting.case}__{self.setting.family}__{self.setting.level:05d}"

    @property
    def cost(self) -> float:
        dim = resolve(self.setting.case).solution.body.dim
        return float(self.setting.level**2) * (230 if dim == 2 else 30_000)

    @property
    def memory(self) -> float:
        return memory.statement(resolve(self.setting.case).solution.body.dim, self.setting.level)

    def fingerprint(self) -> str:
        case, family = resolve(self.setting.case), family_named(self.setting.family)
        # A statement is measured anew whenever its own file changes: each is small.
        source = inspect.getsource(sys.modules[type(statement_labelled(self.label)).__module__])
        return fingerprint(self.label, source, case.solution, case.regularity, case.pace, family, self.setting)

    def run(self) -> dict[str, Any]:
        return {
            **asdict(self.setting),
            "label": self.label,
            "measured": statement_labelled(self.label).measure(self.setting),
        }


def statement_labelled(label: str) -> Statement:
    """The numbered statement with a label."""
    return next(statement for statement in STATEMENTS if statement.label == label)


@dataclass(frozen=True)
class PictureJob:
    """The data of a case's figures."""

    case: str

    @property
    def key(self) -> str:
        return f"picture__{resolve(self.case).name}"

    @property
    def cost(self) -> float:
        return 500_000.0

    @property
    def memory(self) -> float:
        return memory.SMALL

    def fingerprint(self) -> str:
        return fingerprint(resolve(self.case).solution, "picture", FORM)

    def run(self) -> dict[str, Any]:
        return picture(resolve(self.case))
