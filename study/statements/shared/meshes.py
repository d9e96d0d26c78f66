"""Cases, mesh families and levels on which a statement is measured, and statistics that depend little on random meshes.

On a random mesh the error of one level is a random number e_n = C h^p (1 + δ_n), and an order from two levels scatters
by (δ_n² + δ_2n²)^½/log 2: a twentieth on 8 × 8 cells with a front, even if the theory is right. Two remedies lose
nothing:

* *Orders in the leading term of the error, not in h*, on shaken and on unstructured meshes. The error of
  Proposition 5.4 is the interpolation error up to a share that the ledger judges. Its leading term
  (Σ_T c_T h_T² ‖D²u‖²_T)^½ is computed from the cells of the mesh and the second derivatives of u, without a solve.
  Orders in the leading term do not depend on which cells happen to be large where u bends: in a pilot they scattered
  by less than half as much in most cases, down to a hundredth. Another row judges whether the leading term is of
  order h.
* *Weights.* A sum over N independent cells has the relative variance 1/N, up to a factor. By Gauss and Markov the best
  order in h is then the least squares one with the number of cells as weights (``ledger.measures.weighted``). In the
  pilot logarithms of stress errors scattered by 0.05, 0.015, 0.006 for n = 8, 16, 32: nearly all scatter of an order
  came from the coarsest mesh.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

from manufactured.body import Body
from manufactured.case import Case
from study.fem.mesh import MeshError, MeshFamily, Shaken, Unstructured, boundary_parts
from study.fem.naming import family_named, resolve
from study.fem.space import Space
from study.ledger.criterion import Groups
from study.statements.shared.base import Setting
from study.statements.shared.scope import serving

BODIES = (
    "full-contact",
    "rotated",
    "corner",
    "contact-at-clamp",
    "hexagon",
    "cube-disc",
    "cube-two-faces",
    "re-entrant",
    "junction",
)
"""One case for every body of the catalogue, with its Γ1."""
LAWS = (
    *("full-contact", "advance-recede", "lift-and-land", "yield-and-release", "yield-on-a-part", "anisotropic"),
    *("heterogeneous", "layered", "corner", "cube-disc", "cube-two-faces", "natural-front", "layered-unmet"),
    *("softening", "double-well"),
)
"""One case for every law of the catalogue."""
BODIES_WITH_LAWS = (
    *("full-contact", "advance-recede", "lift-and-land", "yield-and-release", "yield-on-a-part", "anisotropic"),
    *(
        "heterogeneous",
        "layered",
        "rotated",
        "corner",
        "contact-at-clamp",
        "hexagon",
        "cube-disc",
        "cube-two-faces",
        "natural-front",
    ),
    *("layered-unmet", "re-entrant", "junction", "softening", "double-well"),
)
"""One case for every pair of a body and a law of the catalogue."""
BODIES_WITH_VISCOSITIES = (
    *("full-contact", "advance-recede", "lift-and-land", "anisotropic", "heterogeneous", "layered", "rotated"),
    *(
        "corner",
        "contact-at-clamp",
        "hexagon",
        "cube-disc",
        "cube-two-faces",
        "layered-unmet",
        "re-entrant",
        "junction",
    ),
)
"""One case for every pair of a body and a tensor A of the catalogue."""
IRREGULAR = "graded", "unstructured", "shaken"
"""Instead of ``REGULAR`` if the mesh should have no symmetry: the first of these that can mesh the body is used."""
EVERY = ()
"""No preference: all families that can mesh the body."""
COARSEST = 16
"""Ends of parts lie on a grid coarser than this level."""


def named(*names: str) -> list[Case]:
    """Return cases of the catalogue."""
    return [resolve(name) for name in names]


def space_of(setting: Setting) -> Space:
    """Return V^h at a setting."""
    body = resolve(setting.case).solution.body
    return Space(family_named(setting.family)(body, setting.level), body)


def families(case: Case) -> list[str]:
    """Return the names of the families that can mesh the body of a case, structured ones first."""
    return [family.name for family in serving(case)]


def place(
    cases: Iterable[Case], preference: tuple[str, ...], levels: tuple[int, ...], levels_3d: tuple[int, ...] = ()
) -> list[Setting]:
    """Return settings for each case: one mesh family by preference, or every family, on the levels for its dimension.

    A level whose grid misses an end of a part is replaced by the next that does not.
    """
    found = []
    for case in cases:
        wanted = levels if case.solution.body.dim == 2 else levels_3d
        served = families(case)
        preferred = [name for name in preference if name in served][:1]
        for family in preferred or served:
            step = spacing(case.name, family)
            found += [Setting(case.name, family, n) for n in sorted({step * -(-level // step) for level in wanted})]
    return found


@lru_cache
def spacing(case: str, family: str) -> int:
    """Return the smallest number whose multiples are levels at which the family fits the body of a case."""
    kind, body = family_named(family), resolve(case).solution.body
    fitting = (level for level in range(2, COARSEST) if fits(kind, body, level))
    return 1 if fits(kind, body, 2) and fits(kind, body, 3) else next(fitting)


def fits(family: MeshFamily, body: Body, level: int) -> bool:
    """Return whether the mesh of a level fits the parts of a body."""
    try:
        boundary_parts(family(body, level), body)
    except MeshError:
        return False
    return True


CELLS, ALONG = 2, 1
"""A plane mesh has h⁻² cells, and h⁻¹ cells along a line."""
LEADING = "predicted_interpolation"
"""The column with the leading term of ‖u − Π^h u‖_V."""


def is_random(family: str) -> bool:
    """Return whether meshes of a family are shaken, with any seed."""
    return family.partition("-")[0] == Shaken().name


def split_random(groups: Groups) -> tuple[Groups, Groups]:
    """Return the groups of random meshes and the groups of all others."""
    random = {name: table for name, table in groups.items() if is_random(name)}
    return random, {name: table for name, table in groups.items() if name not in random}


def split_irregular(groups: Groups) -> tuple[Groups, Groups]:
    """Return the groups of meshes whose cells are not scaled copies of those of the next level, and all others."""
    irregular = {name: table for name, table in groups.items() if is_random(name) or name == Unstructured().name}
    return irregular, {name: table for name, table in groups.items() if name not in irregular}


def in_leading_term(groups: Groups) -> Groups:
    """Return groups in which h is replaced by the leading term of the interpolation error on irregular meshes."""
    irregular, others = split_irregular(groups)
    return others | {name: table.assign(h=table[LEADING]) for name, table in irregular.items()}
