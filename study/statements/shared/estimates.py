"""Upper estimates of the memory of a measurement from its number of unknowns.

The Python process with all imports and compiled formulas takes at most 384 MiB. Each unknown adds at most 16 KiB in
the plane and 64 KiB in space, for the matrix factor and the fields. These constants are rounded up, so that every
estimate is one to six times the measured memory.

The constants come from measured peaks of the resident memory with one thread, here in MiB beyond 384:

    displacement   plane n = 128: 139, criss-cross 275, shaken 417; n = 256: 827, shaken 1542; space n = 24: 1440,
                   shaken n = 12: 390, 18: 1220; by multigrid n = 36: 2250, 48: 4100, shaken 6300 and 15000
    equivalence    plane n = 32: 11, 64: 55; space n = 6: 18, 9: 79
    stress         n = 16: 39, 32: 207, 64: 868
    bound          of u_h alone n = 8: 69, 16: 239; with a mesh refined once n = 8: 183, 16: 465, 32: 1890, refined
                   twice n = 8: 390, 16: 1520; on an adapted mesh of 6756 cells 1450
    statements     at most 335, in space 1550
    task           three instants n = 128: 180; n steps n = 64: 310, 96: 1130; in space n = 18: 390
"""

from __future__ import annotations

MIB, KIB = 2.0**20, 2.0**10
BASE = 384 * MIB
PER_UNKNOWN = {2: 16 * KIB, 3: 64 * KIB}
"""Bytes for each unknown, by dimension."""
TEXT = {2: 1 * KIB, 3: 3 * KIB}
"""Bytes to write the numbers of one unknown at one time as text, by dimension."""
SMALL, SOLID = 736 * MIB, 2304 * MIB
"""Bytes for statements with meshes of fixed size, in the plane and in space."""
STRESSES = 18
"""Unknowns of the stress space in each square of a plane mesh, which has two cells."""


def cells(family: str) -> int:
    """Return the number of cells of a plane mesh divided by the number on a one-diagonal mesh."""
    return 2 if family == "criss-cross" else 1


def unknowns(dim: int, n: int, family: str) -> int:
    """Return the number of unknowns of a displacement at a level."""
    return dim * (n + 1) ** dim * (cells(family) if dim == 2 else 1)


def displacement(dim: int, n: int, family: str) -> float:
    """Return the bytes for Problem 5.1 at a level, or for Problem 3.2 on the strains of V^h."""
    return BASE + PER_UNKNOWN[dim] * unknowns(dim, n, family)


def statement(dim: int, n: int) -> float:
    """Return the bytes for a numbered statement at a level that it chooses itself."""
    return max(SMALL, displacement(dim, n, "shaken")) if dim == 2 else SOLID


def stress(n: int) -> float:
    """Return the bytes for Problem 3.2 on its own space."""
    return BASE + PER_UNKNOWN[2] * STRESSES * n**2


def bound(n: int, refinements: int, family: str) -> float:
    """Return the bytes for a bound: 80 unknowns in each square of the mesh of u_h, 32 in each of a refined mesh."""
    refined = 32 * 4**refinements if refinements else 0
    return BASE + PER_UNKNOWN[2] * cells(family) * n**2 * (80 + refined)


def adapted(cells: int) -> float:
    """Return the bytes for a bound from u_h alone on an adapted mesh with the given number of cells."""
    return BASE + PER_UNKNOWN[2] * STRESSES * cells


def task(dim: int, n: int, family: str, steps: int) -> float:
    """Return the bytes for writing a task with the given number of time steps."""
    return displacement(dim, n, family) + TEXT[dim] * unknowns(dim, n, family) * steps
