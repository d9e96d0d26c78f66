"""Estimates of the memory of a measurement.

Each estimate is a base plus a part that grows with the level n, mostly the factor of a matrix: n² log n numbers in 2D,
n⁴ in 3D, n³ with multigrid. Constants are rounded up from measured peaks of the resident size with one thread, here in
MiB beyond the base:

    displacement   n = 96: 81; n = 128: 139, criss-cross 275, unstructured 366, shaken 417; n = 256: 827, shaken 1542,
                   with two steps, so that few amplitudes are computed in advance;
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
"""Jobs of a fixed size in 2D."""
SOLID = 2304 * MIB
"""Jobs of a fixed size in 3D: functionals on cells halved twice."""
RESERVE, LARGE = 32 * MIB, 64
"""Reserve in 2D, in full from level LARGE on. The measured peaks contain it: they were taken when amplitudes were
computed in advance for blocks of times."""


def cells(family: str) -> int:
    """Return the number of cells of a plane mesh over the number with two triangles per square."""
    return 2 if family == "criss-cross" else 1


def displacement(dim: int, n: int, family: str) -> float:
    """Return the bytes for Problem 5.1 at a level."""
    # Congruent cells share most of their data.
    alike = family in ("one-diagonal", "criss-cross")
    if dim == 2:
        return BASE + RESERVE * min(1, n / LARGE) + (1.6 if alike else 3.2) * KIB * n**2 * log2(n) * cells(family)
    if dim * (n + 1) ** dim > FACTORED[dim]:
        return BASE + (50 if alike else 144) * KIB * n**3
    return BASE + (6 if alike else 21) * KIB * n**4


def equivalence(dim: int, n: int, family: str) -> float:
    """Return the bytes for Problem 3.2 on the strains of V^h, solved by an interior-point method."""
    return BASE + (4 * KIB * n**2 * log2(n) * cells(family) if dim == 2 else 18 * KIB * n**4)


def statement(dim: int, n: int) -> float:
    """Return the bytes for a statement at one of its own levels."""
    return max(SMALL, displacement(dim, n, "shaken")) if dim == 2 else SOLID


def stress(n: int) -> float:
    """Return the bytes for Problem 3.2 on its own space."""
    return BASE + 42 * KIB * n**2 * log2(n)


def bound(n: int, refinements: int, family: str) -> float:
    """Return the bytes for a bound of the error, with the mesh of u_h refined so many times."""
    return BASE + 40 * MIB + cells(family) * MIB * n**2 * (1 + 0.35 * 4**refinements * (refinements > 0))


def adapted(cells: int) -> float:
    """Return the bytes for a bound from u_h alone on an adapted mesh of so many cells."""
    return BASE + 40 * MIB + 0.3 * MIB * cells


def task(dim: int, n: int, family: str, steps: int) -> float:
    """Return the bytes for writing a task with so many steps: the solve, and its numbers as text."""
    return displacement(dim, n, family) + cells(family) * (1.5 if dim == 2 else 8) * KIB * n**dim * steps
