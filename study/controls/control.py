"""A negative control: a deliberate defect, the part of the study that it replaces, and the checks that must fail.

The functions in this file replace parts of the study: attributes of an object, or names in a module.
"""

from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from copy import copy
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import reduce
from importlib import import_module
from types import SimpleNamespace
from typing import Any
from unittest.mock import patch

from study.controls.baselines import Baseline

Replacement = Callable[[Any], Any]
"""Function that returns a wrong object, given the correct object."""


@dataclass(frozen=True, eq=False)
class Control:
    """One deliberate defect, and the checks that must notice it.

    Attributes:
        name: name of the defect.
        what: a description of the defect, in one line.
        setting: the case, the meshes and the statement with which the defect is measured.
        place: the part of the study that is replaced. With a colon it is a name in a module:
            "fem.error_norm:ErrorNorm.distance" in a module of ``study``, "green:work_on" in a module of
            ``study.statements``. Without a colon it is an attribute of the measured object, such as "problem.solver",
            or "" for the whole object.
        replacement: function that returns the wrong part, given the correct one.
        checks: the key (short name) of the check that must fail, or the keys of several checks that all must fail.
        others: further parts that are replaced at the same time, as pairs (place, replacement).
    """

    name: str
    what: str
    setting: Baseline[Any]
    place: str
    replacement: Replacement
    checks: str | tuple[str, ...]
    others: tuple[tuple[str, Replacement], ...] = ()

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys (short names) of the checks that must fail because of the defect."""
        return (self.checks,) if isinstance(self.checks, str) else self.checks

    @property
    def changes(self) -> tuple[tuple[str, Replacement], ...]:
        """All replacements of this defect, as pairs (place, replacement)."""
        return ((self.place, self.replacement), *self.others)

    def __call__(self, measured: Any) -> Any:
        """Return the measured object with the defect: some of its attributes are replaced."""
        inside = [change for change in self.changes if ":" not in change[0]]
        return reduce(lambda found, change: replaced(found, *change), inside, measured)


@contextmanager
def patched(changes: Iterable[tuple[str, Replacement]]) -> Iterator[None]:
    """Replace names in modules by wrong objects within a ``with`` block.

    Parameters:
        changes: pairs (place, replacement), as described in ``Control``. Places without a colon are skipped.
    """
    with ExitStack() as stack:
        for place, replacement in changes:
            module, colon, path = place.partition(":")
            if not colon:
                continue
            *inside, name = path.split(".")
            package = "study" if "." in module else "study.statements"
            owner = reduce(getattr, inside, import_module(f"{package}.{module}"))
            stack.enter_context(patch.object(owner, name, replacement(vars(owner)[name])))
        yield


def replaced(whole: Any, place: str, replacement: Replacement) -> Any:
    """Return a copy of an object with one attribute replaced.

    Parameters:
        whole: the object.
        place: name of the attribute, "load" for example; "problem.load" for the attribute ``load`` of the attribute
            ``problem``; "" for the object itself.
        replacement: function that returns the new value, given the old one.
    """
    if not place:
        return replacement(whole)
    name, _, rest = place.partition(".")
    value = replaced(getattr(whole, name), rest, replacement)
    if is_dataclass(whole) and not isinstance(whole, type) and name in {field.name for field in fields(whole)}:
        return replace(whole, **{name: value})
    return overridden(copy(whole), **{name: value})


def overridden(whole: Any, **attributes: Any) -> Any:
    """Set attributes or methods of an object, even if it is a frozen dataclass, and return the object."""
    vars(whole).update(attributes)
    return whole


def within(place: str, replacement: Replacement) -> Replacement:
    """Return a replacement of the class ``Experiment`` by one whose objects all have one wrong attribute.

    Parameters:
        place: name of the attribute, such as "problem.solver".
        replacement: function that returns the wrong attribute, given the correct one.
    """

    def changed(make: Callable[..., Any]) -> Callable[..., Any]:
        return lambda *given: replaced(make(*given), place, replacement)

    return lambda experiment: SimpleNamespace(of=changed(experiment.of), at=changed(experiment.at))
