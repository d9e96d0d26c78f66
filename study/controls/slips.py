"""Mistakes in the code, made for the time of one measurement, and evidence that is replaced by nothing."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext
from dataclasses import dataclass
from functools import partial, reduce
from importlib import import_module
from typing import Any, TypeVar

from study.statements.prop_5_4.experiment import Experiment

S = TypeVar("S")


@dataclass(frozen=True)
class Slip:
    """While the mistake is made, a name means something else; what would be measured is passed on as it is.

    Attributes:
        module: where the name is looked up, "study.…".
        name: of a function or class there, or of something inside a class after a dot.
        by: the right one ↦ what stands in its place.
    """

    module: str
    name: str
    by: Callable[[Any], Any]

    def __call__(self, setup: S) -> S:
        return setup

    @contextmanager
    def made(self) -> Iterator[None]:
        """The time of the mistake."""
        *inside, last = self.name.split(".")
        place: Any = import_module(self.module)
        for name in inside:
            place = getattr(place, name)
        right = vars(place)[last]
        setattr(place, last, self.by(right))
        try:
            yield
        finally:
            setattr(place, last, right)


@dataclass(frozen=True)
class Together:
    """Several defects at once."""

    defects: tuple[Callable[[Any], Any], ...]

    def __call__(self, setup: Any) -> Any:
        return reduce(lambda changed, defect: defect(changed), self.defects, setup)

    @contextmanager
    def made(self) -> Iterator[None]:
        """Make all mistakes in the code among the defects."""
        with ExitStack() as stack:
            for defect in self.defects:
                stack.enter_context(made(defect))
            yield


def made(defect: Callable[[Any], Any]) -> AbstractContextManager[None]:
    """The time in which a defect is measured: that of a mistake in the code, nothing special for others."""
    return defect.made() if isinstance(defect, Slip | Together) else nullcontext()


@dataclass(frozen=True)
class Blinded:
    """A measurement whose evidence is replaced by exactly nothing.

    Attributes:
        quantities: the names of the numbers that are 0.
    """

    quantities: tuple[str, ...]

    def __call__(self, measure: Callable[[Any], Mapping[str, float]]) -> Callable[[Any], dict[str, float]]:
        return lambda setting: {**measure(setting), **dict.fromkeys(self.quantities, 0.0)}


def blinded(*quantities: str) -> Blinded:
    """The evidence of some names is nothing."""
    return Blinded(quantities)


@dataclass(frozen=True)
class Defective:
    """``Experiment`` for a module that makes its own: what it makes has a defect."""

    defect: Callable[[Experiment], Experiment]

    def of(self, *arguments: Any) -> Experiment:
        return self.defect(Experiment.of(*arguments))

    def at(self, *arguments: Any) -> Experiment:
        return self.defect(Experiment.at(*arguments))


def in_experiments_of(statement: str, defect: Callable[[Experiment], Experiment]) -> Slip:
    """A defect of every experiment that a module of ``study.statements`` makes."""
    return Slip(f"study.statements.{statement}", "Experiment", instead(Defective(defect)))


def always(value: Any) -> Callable[[Any], Callable[..., Any]]:
    """A function that looks at nothing."""
    return instead(partial(_constant, value))


def instead(other: Any) -> Callable[[Any], Any]:
    """Something else."""
    return partial(_instead, other)


def _instead(other: Any, right: Any) -> Any:
    return other


def _constant(value: Any, *arguments: Any, **options: Any) -> Any:
    return value
