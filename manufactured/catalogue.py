"""The catalogue of cases. Each case is made when it is first used."""

from __future__ import annotations

import re
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING

# SymPy is imported only for type checking, so that listing the names is fast.
if TYPE_CHECKING:
    from manufactured.case import Case

MODULES = {
    "full-contact": "plane",
    "no-contact": "plane",
    "advance-recede": "plane",
    "travelling-patch": "plane",
    "merging-patches": "plane",
    "lift-and-land": "plane",
    "load-w11": "plane",
    "yield-and-release": "materials",
    "yield-on-a-part": "materials",
    "anisotropic": "materials",
    "heterogeneous": "materials",
    "layered": "materials",
    "rotated": "plane",
    "corner": "plane",
    "contact-at-clamp": "plane",
    "hexagon": "plane",
    "cube-disc": "solid",
    "cube-two-faces": "solid",
    "natural-front": "rough",
    "rough-trace": "rough",
    "moving-rough": "rough",
    "layered-unmet": "rough",
    "rough-1.75": "rough",
    "re-entrant": "rough",
    "junction": "rough",
    "softening": "materials",
    "double-well": "materials",
    "closing-gap": "gaps",
    "parabolic-gap": "gaps",
    "cube-bowl": "gaps",
}
"""Each case ↦ the module of ``manufactured.cases`` with the function that makes it.

First come cases that satisfy the assumptions of Proposition 5.4, starting with simple contact zones; then cases that
are not smooth enough for it; then laws that soften; last initial gaps, which the paper does not treat.
"""

NAMES = tuple(MODULES)
"""The names of all cases."""

NATURAL_MOTION, NO_POTENTIAL = "natural-motion", "no-potential"
OTHER_NAMES = ("trains", "breathing-trains", NATURAL_MOTION, NO_POTENTIAL)
"""The names of cases that are not in the catalogue, because only single statements use them.

They have no entry in ``MODULES``; functions in other modules make them.
"""

SUCCESSORS = {
    "fixed-front-on-vertex": "full-contact",
    "fixed-front-off-vertex": "advance-recede",
    "long-time": "advance-recede",
    "rough-2": "rough-1.75",
    "rough-2.25": "rough-1.75",
    "cube-rough": "moving-rough",
}
"""Former cases ↦ the cases that take their place."""


def catalogue() -> tuple[Case, ...]:
    """Return all cases of the catalogue, in the order of ``MODULES``."""
    return tuple(named(name) for name in NAMES)


def named(name: str) -> Case:
    """Return the case with a name, without making the other cases.

    >>> case = named("rotated")
    >>> case.order, case.solution.body.dim, case.solution.law.dim
    (1, 2, 2)

    Raises:
        CaseError: no case has this name; the message lists all names.
    """
    if not isinstance(name, str) or name not in NAMES:
        from manufactured.case import CaseError

        raise CaseError(f"no case is called {name!r}; {advice(name)}there are {', '.join(NAMES)}")
    return _made(name)


def advice(name: object) -> str:
    """Return a text for messages that names the case which replaced a former case; "" for all other names.

    Args:
        name: the name that was looked for; no case needs to have it.
    """
    successor = SUCCESSORS.get(name) if isinstance(name, str) else None
    return f"it is gone, {successor} takes its place; " if successor else ""


@cache
def _made(name: str) -> Case:
    return getattr(import_module(f"manufactured.cases.{MODULES[name]}"), function_of(name))()


def function_of(name: str) -> str:
    """Return the name of the Python function that makes a case: its name with "_" in place of "-" and "."."""
    return re.sub("[-.]", "_", name)
