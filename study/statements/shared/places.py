"""Where statements are measured: cases of the catalogue, a mesh family that serves their bodies, levels."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from functools import cache, lru_cache

from manufactured.body import Body
from manufactured.case import Case
from manufactured.catalogue import catalogue
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
FIRST, LAST, EVERY = slice(1), slice(-1, None), slice(None)
"""Which of the families that serve a body."""


def place(
    cases: Iterable[Case], chosen: slice, levels: tuple[int, ...], levels_3d: tuple[int, ...] = ()
) -> list[Setting]:
    """Each case on the chosen of the families that serve its body, on the levels for its dimension.

    A level whose grid misses an end of a part is replaced by the next that does not.
    """
    found = []
    for case in cases:
        wanted = levels if case.solution.body.dim == 2 else levels_3d
        for family in families(case)[chosen]:
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


def shape(case: Case) -> Hashable:
    """The same for cases with the same Ω and Γ1."""
    return tuple((part.kind, *part.corners.ravel()) for part in case.solution.body.parts)


@cache
def material(case: Case) -> tuple[str, str]:
    """The same for cases with the same law: A and G in words."""
    return repr(case.solution.law.A), repr(case.solution.law.G)


def different(*keys: Callable[[Case], Hashable]) -> list[Case]:
    """The first case of the catalogue for every value of some keys."""
    found: dict[Hashable, Case] = {}
    for case in catalogue():
        found.setdefault(tuple(key(case) for key in keys), case)
    return list(found.values())


def named(*names: str) -> list[Case]:
    """Cases of the catalogue."""
    return [resolve(name) for name in names]
