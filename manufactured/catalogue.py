"""The catalogue of cases. Each case is made when it is first used."""

from __future__ import annotations

import re
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING

# SymPy is imported only for type checking, so that listing the names is fast.
if TYPE_CHECKING:
    from manufactured.case import Case

NAMES = (
    "full-contact",
    "no-contact",
    "advance-recede",
    "travelling-patch",
    "merging-patches",
    "lift-and-land",
    "load-w11",
    "yield-and-release",
    "yield-on-a-part",
    "anisotropic",
    "heterogeneous",
    "layered",
    "rotated",
    "corner",
    "contact-at-clamp",
    "hexagon",
    "cube-disc",
    "cube-two-faces",
    "natural-front",
    "rough-trace",
    "moving-rough",
    "layered-unmet",
    "rough-1.75",
    "re-entrant",
    "junction",
    "softening",
    "double-well",
    "closing-gap",
    "parabolic-gap",
    "cube-bowl",
)
"""The names of all cases.

First come cases that satisfy the assumptions of Proposition 5.4, starting with simple contact zones; then cases that
are not smooth enough for it; then laws that soften; last initial gaps, which the paper does not treat. The case NAME is
made by the function ``case`` of ``manufactured/cases/NAME.py``, with ``_`` for ``-`` and ``.``.
"""

OTHER_NAMES = ("trains", "breathing-trains", "natural-motion", "no-potential")
"""The names of further cases, which only single statements use. They are made elsewhere in this package."""

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
    """Return all cases of the catalogue, in the order of the tuple ``NAMES``."""
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
    """Return which case took the place of a former case, as the beginning of a sentence; "" for other names."""
    successor = SUCCESSORS.get(name) if isinstance(name, str) else None
    return f"it is gone, {successor} takes its place; " if successor else ""


@cache
def _made(name: str) -> Case:
    return import_module(module_of(name)).case()


def module_of(name: str) -> str:
    """Return the name of the module that makes the case with a name."""
    return f"manufactured.cases.{re.sub('[-.]', '_', name)}"
