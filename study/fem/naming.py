"""Finds cases, problems and mesh families by the names that commands and data files use."""

import importlib.util
import re
import sys
from collections.abc import Sequence
from difflib import get_close_matches
from functools import lru_cache
from inspect import isfunction
from pathlib import Path
from traceback import extract_tb
from types import ModuleType
from typing import Any

from manufactured.case import Case, proved_order
from manufactured.cases.materials import no_potential
from manufactured.cases.rough import natural_motion
from manufactured.catalogue import NAMES, OTHER_NAMES, SUCCESSORS, advice, named
from manufactured.data import Data
from manufactured.multiscale import COARSEST_ROLLER, ROLLERS, multiscale, rollers
from manufactured.problems import problems
from study.fem.mesh import FAMILIES, Alternating, MeshFamily, Shaken
from study.ledger.files import Json, UsageError

SEED_DIGITS = 20
"""Largest number of digits of a seed, which is enough for 64 bits. File names contain the seed, so it must be short."""


def choose(kind: str, name: str, known: Sequence[Any]) -> Any:
    """Return the object with the given name.

    Args:
        kind: what the objects are, for the message, such as "mesh family".
        name: the name to look for.
        known: objects with an attribute ``name``.

    Raises:
        UsageError: no object has this name; the message lists the known names.
    """
    for item in known:
        if item.name == name:
            return item
    raise unknown(kind, name, [item.name for item in known])


def unknown(kind: str, name: str, names: Sequence[str]) -> UsageError:
    """Return the error for an unknown name; it suggests the most similar name and lists all names.

    Args:
        kind: what is named, for example "case".
        name: the unknown name.
        names: all known names.
    """
    near = get_close_matches(name, names, n=1)
    meant = f"did you mean {near[0]}? All" if near else "known"
    return UsageError(f"unknown {kind} {name!r}; {meant}: {', '.join(names)}")


def family_named(name: str) -> MeshFamily:
    """Return the mesh family with a name.

    The name "shaken-7" means shaken meshes with the random seed 7.

    Raises:
        UsageError: no mesh family has this name, or the seed has too many digits.
    """
    if seeded := re.fullmatch(r"shaken-(\d+)", name):
        if len(seeded[1]) > SEED_DIGITS:
            raise UsageError(
                f"the seed of shaken meshes has {len(seeded[1])} digits, at most {SEED_DIGITS} are allowed"
            )
        return Shaken(seed=int(seeded[1]), name=name)
    return choose("mesh family", name, (*FAMILIES, Alternating()))  # type: ignore[no-any-return]


@lru_cache
def resolve(reference: str) -> Case:
    """Return the case that a reference names.

    Args:
        reference: a name from the catalogue, or FILE.py:NAME, where NAME is a Case or a function that returns one.

    Raises:
        UsageError: there is no such case, or the file cannot be run.
    """
    found = _lookup(reference)
    if found is None:
        if reference in SUCCESSORS:
            raise UsageError(f"case {reference!r}: {advice(reference)}see study cases")
        raise unknown("case", reference, _case_names())
    if not isinstance(found, Case):
        raise UsageError(
            f"{reference} is a {type(found).__name__}, expected a manufactured.Case or a function that returns one"
        )
    return found


@lru_cache
def resolve_data(reference: str) -> tuple[str, Data, Case | None]:
    """Return the name of a problem, its data, and its case, which is None if the exact solution is unknown.

    Args:
        reference: a name from the catalogue or from ``manufactured.problems``; or FILE.py:NAME, where NAME is a
            ``manufactured.Data``, a Case, or a function that returns one.

    Raises:
        UsageError: there is no such problem, or the file cannot be run.
    """
    found = _lookup(reference)
    if found is None:
        found = next((problem.data for problem in problems() if problem.name == reference), None)
    if found is None:
        raise unknown("problem", reference, [*_case_names(), *(problem.name for problem in problems())])
    if isinstance(found, Case):
        return found.name, Data.of(found.solution), found
    if not isinstance(found, Data):
        raise UsageError(f"{reference} is a {type(found).__name__}, expected manufactured.Data or a manufactured.Case")
    return reference.rpartition(":")[2], found, None


def _lookup(reference: str) -> Any:
    """Return the object that FILE.py:NAME denotes, or the case with the given name; None if there is no such case."""
    if is_own(reference) or reference.endswith(".py"):
        return _from_file(reference)
    if reference in NAMES:
        return named(reference)
    return next((case for case in outside_the_catalogue(reference) if case.name == reference), None)


def outside_the_catalogue(name: str = "") -> tuple[Case, ...]:
    """Return the cases that commands know by name although they are not in the catalogue.

    Args:
        name: the name of a case. Roller cases, with a narrow contact patch that moves or that opens and closes, exist
            for every level of meshes. If ``name`` is the name of a roller case, the roller cases of its level are
            included.
    """
    rolling = re.fullmatch(rf"(?:{'|'.join(ROLLERS)})-(\d+)", name)
    level = int(rolling[1]) if rolling else 0
    return (*multiscale(), natural_motion(), no_potential(), *(rollers(level) if level >= COARSEST_ROLLER else ()))


def _case_names() -> list[str]:
    """Return the names of all cases except roller cases, of which there are some for every level."""
    return [*NAMES, *OTHER_NAMES]


def is_own(reference: str) -> bool:
    """Return whether a reference denotes a case in a file of the user, FILE.py:NAME, not a case of the catalogue."""
    return ":" in reference


def name_of(reference: str) -> str:
    """Return the name of a case in data files.

    For a reference FILE.py:NAME the attribute ``name`` of the case is returned, otherwise the reference itself.
    """
    return resolve(reference).name if is_own(reference) else reference


def absolute(reference: str) -> str:
    """Return FILE.py:NAME with the absolute path of the file; other references are returned unchanged."""
    file, colon, name = reference.rpartition(":")
    return f"{Path(file).resolve()}:{name}" if colon else reference


def _from_file(reference: str) -> Any:
    """Run a file and return its object NAME, or the result of NAME if it is a function."""
    file, _, name = reference.rpartition(":") if ":" in reference else (reference, "", "")
    path = Path(file).resolve()
    if not path.is_file():
        raise UsageError(f"{reference}: there is no file {file}")
    spec = importlib.util.spec_from_file_location(f"case_{path.stem}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    writes_none = sys.dont_write_bytecode
    sys.dont_write_bytecode = True  # so that no folder __pycache__ appears beside the file
    try:
        spec.loader.exec_module(module)
        if not hasattr(module, name):
            raise UsageError(_none_named(file, name, module))
        found = getattr(module, name)
        found = found() if callable(found) else found
        if found is None:
            raise UsageError(f"{reference} returned None, expected a manufactured.Case: add a return statement")
        return found
    except UsageError:
        raise
    except (Exception, SystemExit) as error:
        raise UsageError(
            f"the case {reference} cannot be read: running {file} raises {type(error).__name__}: {error}"
            f"{raised_at(error, path)}; correct the file"
        ) from error
    finally:
        sys.dont_write_bytecode = writes_none


def raised_at(error: BaseException, file: Path) -> str:
    """Return the line of a user's file at which an error was raised, as text such as " (FILE, line 3)".

    If the line calls a function of another file that raises the error, it is the line with this call. The text is empty
    if no line of the file had a part in the error.

    Args:
        error: the error, with its traceback.
        file: the absolute path of the user's file.
    """
    lines = [frame.lineno for frame in extract_tb(error.__traceback__) if frame.filename == str(file)]
    return f" ({file}, line {lines[-1]})" if lines else ""


def _none_named(file: str, name: str, module: ModuleType) -> str:
    """Return an error message for a name that a file does not define; it lists what the file defines."""
    own = {key: value for key, value in vars(module).items() if not key.startswith("_")}
    made = [key for key, value in own.items() if isinstance(value, Case | Data)]
    made += [key for key, value in own.items() if isfunction(value) and value.__module__ == module.__name__]
    lacks = f"{file} defines no {name!r}" if name else f"{file} is a file without the name of a case in it"
    return f"{lacks}; give {' or '.join(f'{file}:{key}' for key in made) or 'a file that defines a Case or Data'}"


def describe(case: Case) -> Json:
    """Return the row for a case in ``cases.csv``, the list of the cases of a study, as a dict: column ↦ value.

    The columns are the name, summary, dimension and law of the case, the motion of its contact zone, its regularity,
    the predicted and the proved order, its twin, the statements of the paper that apply, and the reason for the order.
    """
    motion = "moving" if case.regularity.moving else "no front" if case.regularity.gap == float("inf") else "fixed"
    return {
        "case": case.name,
        "summary": case.summary,
        "dimension": case.solution.body.dim,
        "law": case.solution.law.name,
        "zone": motion,
        "regularity": str(case.regularity),
        "expected_order": case.order,
        "proved_order": proved_order(case),
        "twin": case.twin,
        "statements": case.proposition if case.solution.has_initial_gap else f"{case.proposition}, Thm 4.2",
        "reason": case.reason,
    }
