"""Choice of cases, mesh families and levels for a statement, and statistics that scatter little on random meshes.

On a random mesh the error at level n is a random number C h^p (1 + x_n). If x_n has the standard deviation δ_n, an
observed order from the levels n and 2n has the standard deviation (δ_n² + δ_2n²)^½/log 2, even if the theory is right.
On 8 × 8 cells with a contact front δ_n is about 1/20. Two remedies reduce this scatter without wider tolerance windows:

* *Orders in the leading term of the error instead of h*, on shaken and unstructured meshes. The error of
  Proposition 5.4 is nearly the interpolation error; another check tests this. The leading term
  (Σ_T c_T h_T² ‖D²u‖²_T)^½ is computed from the cells of the mesh and the second derivatives of u, without a solve.
  Orders in the leading term do not depend on which cells happen to be large where u is strongly curved. In a pilot
  study their scatter was less than half as large in most cases, and 100 times smaller in the best case. Another check
  tests whether the leading term is of order h.
* *Weights.* A sum over N independent cells has the relative variance 1/N, up to a factor. By the theorem of Gauss and
  Markov the best estimate of the order in h is then the least-squares fit with the numbers of cells as weights
  (``study.ledger.quantities.fit``). In the pilot study the logarithms of stress errors scattered by 0.05,
  0.015 and 0.006 for n = 8, 16 and 32, so nearly all scatter of an order came from the coarsest mesh.
"""

from collections.abc import Callable, Hashable, Iterable
from functools import lru_cache

from manufactured.body import Body
from manufactured.case import Case
from manufactured.catalogue import catalogue
from manufactured.exact import ExactSolution
from study.fem.mesh import MeshError, MeshFamily, boundary_parts
from study.fem.naming import family_named, resolve
from study.fem.space import Space
from study.ledger.check import Groups
from study.statements.shared.base import Setting
from study.statements.shared.scope import regular, serving

COARSEST_GRID = 16
"""Upper bound of the levels that are searched for a grid with the ends of all boundary parts among its vertices."""


def named(*names: str) -> list[Case]:
    """Return the cases of the catalogue with the given names."""
    return [resolve(name) for name in names]


def first_with_each(feature: Callable[[Case], Hashable]) -> list[Case]:
    """Return one case of the catalogue for each value of a feature: the first case that has this value.

    Args:
        feature: a function from a case to the value, such as its body or its law.
    """
    first: dict[Hashable, Case] = {}
    for case in catalogue():
        first.setdefault(feature(case), case)
    return list(first.values())


def body_of(case: Case) -> Hashable:
    """Return the boundary parts of the body of a case as a value that is equal for equal bodies."""
    return tuple((part.kind, *part.corners.ravel()) for part in case.solution.body.parts)


def law_of(case: Case) -> Hashable:
    """Return the moduli of the law of a case as a value that is equal for equal laws."""
    return repr(case.solution.law.A), repr(case.solution.law.G)


def space_of(setting: Setting) -> Space:
    """Return the P1 displacement space V^h for the case and the mesh of a setting."""
    body = resolve(setting.case).solution.body
    return Space(family_named(setting.family)(body, setting.level), body)


def posed(setting: Setting) -> tuple[Space, ExactSolution]:
    """Return the P1 displacement space V^h of a setting, and the exact solution of its case."""
    return space_of(setting), resolve(setting.case).solution


def place(
    cases: Iterable[Case], levels: tuple[int, ...], levels_3d: tuple[int, ...] = (), every_family: bool = False
) -> list[Setting]:
    """Return settings (case, mesh family, level) for given cases and levels.

    The ends of all boundary parts of a body must be vertices of the mesh. A level for which they are not is replaced by
    the next finer one for which they are.

    Args:
        cases: the cases.
        levels: the levels for plane bodies.
        levels_3d: the levels for bodies in space; by default cases in space get no setting.
        every_family: whether all mesh families that can mesh a body are used, and not only the one that ``regular``
            returns.
    """
    found = []
    for case in cases:
        wanted = levels if case.solution.body.dim == 2 else levels_3d
        for family in serving(case) if every_family else [regular(case)]:
            step = spacing(case.name, family.name)
            fitting = sorted({step * -(-level // step) for level in wanted})
            found += [Setting(case.name, family.name, n) for n in fitting]
    return found


@lru_cache
def spacing(case: str, family: str) -> int:
    """Return the smallest number s such that the meshes of levels s, 2s, 3s, … resolve the boundary parts of a body.

    A mesh resolves the boundary parts if their ends are vertices. ``case`` and ``family`` are names.
    """
    kind = family_named(family)
    body = resolve(case).solution.body
    fitting = (level for level in range(2, COARSEST_GRID) if fits(kind, body, level))
    return 1 if fits(kind, body, 2) and fits(kind, body, 3) else next(fitting)


def fits(family: MeshFamily, body: Body, level: int) -> bool:
    """Return whether the ends of all boundary parts of a body are vertices of the mesh of a level."""
    try:
        boundary_parts(family(body, level), body)
    except MeshError:
        return False
    return True


CELL_POWER, ALONG = 2, 1
"""Exponents p for which a plane mesh has about h^{−p} cells in total, and about h^{−p} cells along a line."""
LEADING = "predicted_interpolation"
"""The column with the leading term of the interpolation error ‖u − Π^h u‖_V."""


def is_random(family: str) -> bool:
    """Return whether the meshes of the mesh family with the given name are random."""
    return family_named(family).random


def value_of_case(groups: Groups, column: str) -> float:
    """Return the number in a column that is the same in all rows of a case, such as the predicted order.

    Args:
        groups: the tables of the case by mesh family.
        column: the name of the column.
    """
    return float(next(iter(groups.values()))[column].iloc[0])


def split(groups: Groups, feature: str) -> tuple[Groups, Groups]:
    """Split measurements by a feature of the mesh: return those on meshes with the feature, and all others.

    Args:
        groups: the measurements by mesh family.
        feature: the name of a Boolean attribute of the mesh families, which ``MeshFamily`` describes: random (vertices
            are moved at random), superclose (‖Π^h u − u^h‖ has a higher order than the error), irregular (cells of two
            levels are not scaled copies) or uniform (all cells have about the same size).
    """
    found = {name: table for name, table in groups.items() if getattr(family_named(name), feature)}
    return found, {name: table for name, table in groups.items() if name not in found}


def in_leading_term(groups: Groups) -> Groups:
    """Return measurements in which the leading term of the interpolation error replaces h on irregular meshes.

    The orders of these measurements are then orders in this leading term.

    Args:
        groups: the tables of one case by mesh family, with the columns "h" and ``LEADING``.
    """
    irregular, others = split(groups, "irregular")
    return others | {name: table.assign(h=table[LEADING]) for name, table in irregular.items()}
