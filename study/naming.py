"""Names in commands and data files, and the objects they stand for."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

from manufactured.case import Case
from manufactured.catalogue import catalogue
from study.fem.mesh import FAMILIES, MeshFamily


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
