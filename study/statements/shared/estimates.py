"""How much memory a measurement needs, by estimate.

The estimates are a base plus what grows with the level n, which is the factor of a matrix for the most part: n² log n
numbers in the plane, n⁴ in space, n³ where multigrid takes its place. Constants are rounded up from peaks of the
resident size with one thread, here in MiB beyond the base:

    displacement   n = 96: 81; n = 128: 139, criss-cross 275, unstructured 366, shaken 417; n = 256: 827, shaken 1542,
                   with two steps, so that hardly any amplitudes are kept ahead of their time;
                   in space n = 12: 60, 24: 1440, shaken n = 12: 390, 18: 1220; by multigrid n = 36: 2250, 48: 4100,
                   shaken 6300 and 15000, since no two cells share points of quadrature, 2500 and 5900 of it without
                   the finer quadrature of a row
    equivalence    n = 32: 11, 64: 55; in space n = 6: 18, 9: 79
    stress         n = 16: 39, 32: 170 … 207, 64: 868
    bound          of u_h alone n = 8: 25 … 69, 16: 239; with an enclosure on a mesh refined once n = 8: 183,
                   16: 465, 32: 1890, twice n = 8: 390, 16: 1520; on an adapted mesh of 6756 cells 1450
    statements     at their fixed levels at most 335, in space 1550
    task           frozen at three instants n = 128: 180; march of n steps n = 64: 310, 96: 1130; in space n = 18: 390
"""

from __future__ import annotations

from math import log2

from study.solve.solver_choice import FACTORED

MIB = 2.0**20
KIB = 2.0**10
BASE = 384 * MIB
"""An interpreter with everything imported takes 230, with formulas and compiled passes 290 to 350."""
SMALL = 736 * MIB
"""Jobs whose size is fixed."""
SOLID = 2304 * MIB
"""The same in space: functionals on cells halved twice."""
AHEAD, FULL = 32 * MIB, 64
"""Blocks of amplitudes at times to come in the plane, as large as they get from this level on."""


def cells(family: str) -> int:
    """Cells of a plane mesh, over those of one with two triangles per square."""
    return 2 if family == "criss-cross" else 1


def displacement(dim: int, n: int, family: str) -> float:
    """Bytes for Problem 5.1 at a level."""
    # Where all cells are alike, they share most of what is kept of them.
    alike = family in ("one-diagonal", "criss-cross")
    if dim == 2:
        return BASE + AHEAD * min(1, n / FULL) + (1.6 if alike else 3.2) * KIB * n**2 * log2(n) * cells(family)
    if dim * (n + 1) ** dim > FACTORED[dim]:
        return BASE + (50 if alike else 144) * KIB * n**3
    return BASE + (6 if alike else 21) * KIB * n**4


def equivalence(dim: int, n: int, family: str) -> float:
    """Bytes for Problem 3.2 on the strains of V^h, solved by an interior-point method."""
    return BASE + (4 * KIB * n**2 * log2(n) * cells(family) if dim == 2 else 18 * KIB * n**4)


def statement(dim: int, n: int) -> float:
    """Bytes for a numbered statement at a level, one of those that it chooses itself."""
    return max(SMALL, displacement(dim, n, "shaken")) if dim == 2 else SOLID


def stress(n: int) -> float:
    """Bytes for Problem 3.2 on its own space."""
    return BASE + 42 * KIB * n**2 * log2(n)


def bound(n: int, refinements: int, family: str) -> float:
    """Bytes for a bound of the error."""
    return BASE + 40 * MIB + cells(family) * MIB * n**2 * (1 + 0.35 * 4**refinements * (refinements > 0))


def adapted(cells: int) -> float:
    """Bytes for a bound from u_h alone on a mesh of so many cells."""
    return BASE + 40 * MIB + 0.3 * MIB * cells


def task(dim: int, n: int, family: str, steps: int) -> float:
    """Bytes for writing a task with so many steps: what is solved, and its numbers as text."""
    return displacement(dim, n, family) + cells(family) * (1.5 if dim == 2 else 8) * KIB * n**dim * steps
