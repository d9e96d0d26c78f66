"""The pieces of work of a run, each a small picklable value with a key, a cost and a result."""

from __future__ import annotations

import hashlib
import importlib.util
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields, is_dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import sympy as sp

from manufactured.case import Case
from manufactured.catalogue import catalogue
from study.equivalence import compare
from study.fem.mesh import FAMILIES, MeshFamily
from study.pictures import picture
from study.solve.evolution import SCHEMES, Scheme
from study.sweep import measure_case

METHOD = 2
"""To be raised with every change of the code that changes numbers: older results are then computed anew.
A test measures small levels again and compares."""


class UsageError(ValueError):
    """A command was given something it cannot use."""


def choose(kind: str, name: str, known: Sequence[Any]) -> Any:
    """The object with a name.

    Raises:
        UsageError: there is none; lists those there are.
    """
    for item in known:
        if item.name == name:
            return item
    raise UsageError(f"unknown {kind} {name!r}; known: {', '.join(item.name for item in known)}")


def family_named(name: str) -> MeshFamily:
    """The mesh family with a name; UsageError if there is none."""
    return choose("mesh family", name, FAMILIES)  # type: ignore[no-any-return]


@lru_cache
def resolve(reference: str) -> Case:
    """The case behind a catalogue name or FILE.py:NAME, where NAME is a Case or a function making one.

    Raises:
        UsageError: no such case, file or name, or it is not a case.
    """
    if ":" not in reference:
        return choose("case", reference, catalogue())  # type: ignore[no-any-return]
    file, _, name = reference.rpartition(":")
    path = Path(file).resolve()
    if not path.is_file():
        raise UsageError(f"{reference}: there is no file {file}")
    spec = importlib.util.spec_from_file_location(f"case_{path.stem}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    try:
        spec.loader.exec_module(module)
        if not hasattr(module, name):
            raise UsageError(f"{reference}: {file} defines no {name!r}")
        found = getattr(module, name)
        case = found() if callable(found) else found
    except UsageError:
        raise
    except (Exception, SystemExit) as error:
        raise UsageError(f"{reference} cannot be made: {type(error).__name__}: {error}") from error
    if not isinstance(case, Case):
        raise UsageError(f"{reference} is a {type(case).__name__}, expected a manufactured.Case")
    return case


def fingerprint(*settings: object) -> str:
    """A short hash of everything a result depends on: exact solution and settings, by value."""
    return hashlib.sha256(repr([METHOD, *map(_by_value, settings)]).encode()).hexdigest()[:16]


def _by_value(item: object) -> object:
    """Frozen dataclasses as their fields, formulas as text, arrays as lists, all the way down."""
    if is_dataclass(item) and not isinstance(item, type):
        return [type(item).__name__, *(_by_value(getattr(item, field.name)) for field in fields(item) if field.init)]
    if isinstance(item, tuple | list):
        return [_by_value(entry) for entry in item]
    if isinstance(item, np.ndarray):
        return item.tolist()
    if isinstance(item, sp.Basic):
        return sp.srepr(item)
    return repr(item)


class Job(Protocol):
    """A piece of work. ``cost`` is proportional to its expected time."""

    @property
    def key(self) -> str: ...
    @property
    def cost(self) -> float: ...

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
        return float(self.level**2 * self.steps) * (2 if self.family == "criss-cross" else 1)

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
        return 200.0 * self.level**2 * self.steps / 16

    def fingerprint(self) -> str:
        return fingerprint(resolve(self.case).solution, family_named(self.family), self.level, self.steps)

    def run(self) -> dict[str, Any]:
        return asdict(compare(resolve(self.case), family_named(self.family), self.level, self.steps))


@dataclass(frozen=True)
class PictureJob:
    """The data of a case's figures."""

    case: str

    @property
    def key(self) -> str:
        return f"picture__{resolve(self.case).name}"

    @property
    def cost(self) -> float:
        return 30_000.0

    def fingerprint(self) -> str:
        return fingerprint(resolve(self.case).solution, "picture")

    def run(self) -> dict[str, Any]:
        return picture(resolve(self.case))
