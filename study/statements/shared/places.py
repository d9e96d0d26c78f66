"""Where statements are measured: cases of the catalogue, a mesh family that serves their bodies, levels."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

from manufactured.body import Body
from manufactured.case import Case
from study.fem.mesh import MeshError, MeshFamily, boundary_parts
from study.fem.naming import family_named, resolve
from study.fem.space import Space
from study.statements.shared.base import Setting
from study.statements.shared.scope import serving


def space_of(setting: Setting) -> Space:
    """V^h at a setting."""
    body = resolve(setting.case).solution.body
    return Space(family_named(setting.family)(body, setting.level), body)


def families(case: Case) -> list[str]:
    """Names of the families that can mesh the body of a case, structured ones first."""
    return [family.name for family in serving(case)]


COARSEST = 16
"""Ends of parts lie on a grid coarser than this."""
IRREGULAR = "graded", "unstructured", "shaken"
"""In place of ``REGULAR`` where the mesh should have no symmetry: the first of these that can mesh the body."""
EVERY = ()
"""No preference: all families that can mesh the body."""


def place(
    cases: Iterable[Case], preference: tuple[str, ...], levels: tuple[int, ...], levels_3d: tuple[int, ...] = ()
) -> list[Setting]:
    """Return settings for each case: one mesh family by preference, or every family, on the levels for its dimension.

    A level whose grid misses an end of a part is replaced by the next that does not.
    """
    found = []
    for case in cases:
        wanted = levels if case.solution.body.dim == 2 else levels_3d
        serving = families(case)
        preferred = [name for name in preference if name in serving][:1]
        for family in preferred or serving:
            step = spacing(case.name, family)
            found += [Setting(case.name, family, n) for n in sorted({step * -(-level // step) for level in wanted})]
    return found


@lru_cache
def spacing(case: str, family: str) -> int:
    """The smallest number whose multiples are levels at which the family fits the body of a case."""
    kind, body = family_named(family), resolve(case).solution.body
    fitting = (level for level in range(2, COARSEST) if fits(kind, body, level))
    return 1 if fits(kind, body, 2) and fits(kind, body, 3) else next(fitting)


def fits(family: MeshFamily, body: Body, level: int) -> bool:
    """Whether the mesh of a level fits the parts of a body."""
    try:
        boundary_parts(family(body, level), body)
    except MeshError:
        return False
    return True


BODIES = (
    "full-contact",
    "rotated",
    "corner",
    "hexagon",
    "cube-disc",
    "cube-two-faces",
    "re-entrant",
    "junction",
)
"""One case for every body of the catalogue, with its Γ1."""
LAWS = (
    "full-contact",
    "advance-recede",
    "lift-and-land",
    "yield-and-release",
    "yield-on-a-part",
    "anisotropic",
    "heterogeneous",
    "layered",
    "corner",
    "cube-disc",
    "cube-two-faces",
    "natural-front",
    "layered-unmet",
    "softening",
    "double-well",
)
"""One case for every law of the catalogue."""
BODIES_WITH_LAWS = (
    "full-contact",
    "advance-recede",
    "lift-and-land",
    "yield-and-release",
    "yield-on-a-part",
    "anisotropic",
    "heterogeneous",
    "layered",
    "rotated",
    "corner",
    "hexagon",
    "cube-disc",
    "cube-two-faces",
    "natural-front",
    "layered-unmet",
    "re-entrant",
    "junction",
    "softening",
    "double-well",
)
"""One case for every pair of a body and a law of the catalogue."""
BODIES_WITH_VISCOSITIES = (
    "full-contact",
    "advance-recede",
    "lift-and-land",
    "anisotropic",
    "heterogeneous",
    "layered",
    "rotated",
    "corner",
    "hexagon",
    "cube-disc",
    "cube-two-faces",
    "layered-unmet",
    "re-entrant",
    "junction",
)
"""One case for every pair of a body and a tensor A of the catalogue."""


def named(*names: str) -> list[Case]:
    """Cases of the catalogue."""
    return [resolve(name) for name in names]
