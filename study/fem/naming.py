"""Names in commands and data files, and the objects they stand for."""

from __future__ import annotations

import importlib.util
import re
import sys
from collections.abc import Sequence
from difflib import get_close_matches
from functools import lru_cache
from inspect import isfunction
from pathlib import Path
from types import ModuleType
from typing import Any

from manufactured.case import Case
from manufactured.catalogue import NAMES, named
from manufactured.data import Data
from manufactured.file_names import file_name_fault
from manufactured.multiscale import COARSEST_ROLLER, ROLLERS, multiscale, rollers
from manufactured.natural_motion import natural_motion
from manufactured.no_potential import no_potential
from manufactured.problems import OpenProblem, problems
from study.fem.mesh import FAMILIES, Alternating, MeshFamily, Shaken
from study.ledger.files import UsageError

SEED_DIGITS = 20
"""Digits of a seed of 64 bits; the seed is part of file names."""
LONGEST_SHOWN = 120
"""Characters of a name that a message shows."""


def choose(kind: str, name: str, known: Sequence[Any]) -> Any:
    """The object with a name; UsageError, which lists those there are, if there is none."""
    for item in known:
        if item.name == name:
            return item
    raise unknown(kind, name, [item.name for item in known])


def unknown(kind: str, name: str, names: Sequence[str]) -> UsageError:
    """Return the refusal of a name that does not exist; it says the nearest name and lists all."""
    near = get_close_matches(name, names, n=1)
    meant = f"did you mean {near[0]}? All" if near else "known"
    return UsageError(f"unknown {kind} {name!r}; {meant}: {', '.join(names)}")


def family_named(name: str) -> MeshFamily:
    """The mesh family with a name, shaken-7 for shaken meshes with the seed 7; UsageError if there is none."""
    if seeded := re.fullmatch(r"shaken-(\d+)", name):
        if len(seeded[1]) > SEED_DIGITS:
            raise UsageError(
                f"the seed of shaken meshes has {len(seeded[1])} digits, at most {SEED_DIGITS} are allowed"
            )
        return Shaken(seed=int(seeded[1]), name=name)
    return choose("mesh family", name, (*FAMILIES, Alternating()))  # type: ignore[no-any-return]


@lru_cache
def resolve(reference: str) -> Case:
    """The case behind a catalogue name or FILE.py:NAME, NAME a Case or a function making one; UsageError if none is."""
    found = _from_file(reference) if _is_file(reference) else _case(reference)
    if found is None:
        raise unknown("case", reference, _case_names())
    if not isinstance(found, Case):
        raise UsageError(f"{reference} is a {type(found).__name__}, expected a manufactured.Case")
    return found


@lru_cache
def resolve_data(reference: str) -> tuple[str, Data, Case | None]:
    """Name, data and, where the solution is known, the case behind a name or FILE.py:NAME; UsageError if none are.

    NAME is a ``manufactured.Data``, a Case, or a function making one; names are those of the catalogue and of
    ``manufactured.problems``.
    """
    found = _from_file(reference) if _is_file(reference) else _case(reference)
    if found is None:
        found = next((problem for problem in problems() if problem.name == reference), None)
    if found is None:
        raise unknown("problem", reference, [*_case_names(), *(problem.name for problem in problems())])
    if isinstance(found, Case):
        return found.name, Data.of(found.solution), found
    data = found.data if isinstance(found, OpenProblem) else found
    if not isinstance(data, Data):
        raise UsageError(f"{reference} is a {type(found).__name__}, expected manufactured.Data or a manufactured.Case")
    name = found.name if isinstance(found, OpenProblem) else reference.rpartition(":")[2]
    if fault := file_name_fault(name):
        shown = name if len(name) <= LONGEST_SHOWN else name[:LONGEST_SHOWN] + "…"
        raise UsageError(f"the problem {shown!r} cannot be part of a file name, as {fault}: give it another name")
    return name, data, None


def _case(name: str) -> Case | None:
    """Return the case with this name, in the catalogue or outside it; None if there is none."""
    if name in NAMES:
        return named(name)
    return next((case for case in _outside_the_catalogue(name) if case.name == name), None)


def _outside_the_catalogue(name: str) -> tuple[Case, ...]:
    """Return the cases outside the catalogue. Rollers belong to one level each: those of the level in the name."""
    rolling = re.fullmatch(rf"(?:{'|'.join(ROLLERS)})-(\d+)", name)
    level = int(rolling[1]) if rolling else 0
    return (*multiscale(), natural_motion(), no_potential(), *(rollers(level) if level >= COARSEST_ROLLER else ()))


def _case_names() -> list[str]:
    """Return the names of all cases, without rollers, of which there is one for every level."""
    return [*NAMES, *(case.name for case in _outside_the_catalogue(""))]


def is_own(reference: str) -> bool:
    """Return whether a reference is FILE.py:NAME, a user's own case, and not a name of the catalogue."""
    return ":" in reference


def name_of(reference: str) -> str:
    """What a reference is called in data files: the name of the case in FILE.py:NAME, other names as they are."""
    return resolve(reference).name if is_own(reference) else reference


def absolute(reference: str) -> str:
    """FILE.py:NAME with the full path, which means the same in every directory; other names as they are."""
    file, colon, name = reference.rpartition(":")
    return f"{Path(file).resolve()}:{name}" if colon else reference


def _is_file(reference: str) -> bool:
    return ":" in reference or reference.endswith(".py")


def _from_file(reference: str) -> Any:
    """What FILE.py:NAME stands for; called if it is a function."""
    file, _, name = reference.rpartition(":") if ":" in reference else (reference, "", "")
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
            raise UsageError(_none_named(file, name, module))
        found = getattr(module, name)
        return found() if callable(found) else found
    except UsageError:
        raise
    except (Exception, SystemExit) as error:
        raise UsageError(f"{reference} cannot be made: {type(error).__name__}: {error}") from error


def _none_named(file: str, name: str, module: ModuleType) -> str:
    """What to give instead: cases, data and functions that the file itself defines."""
    own = {key: value for key, value in vars(module).items() if not key.startswith("_")}
    made = [key for key, value in own.items() if isinstance(value, Case | Data)]
    made += [key for key, value in own.items() if isfunction(value) and value.__module__ == module.__name__]
    lacks = f"{file} defines no {name!r}" if name else f"{file} stands for no case without a name"
    return f"{lacks}; give {' or '.join(f'{file}:{key}' for key in made) or 'a file that defines a Case or Data'}"
