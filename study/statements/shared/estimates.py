"""Upper estimates of the memory that measurements need, computed from the number of unknowns.

The Python process with all imports and compiled formulas takes at most 384 MiB. Each unknown adds at most 16 KiB in
the plane and 80 KiB in space, for the matrix factor and the fields. These constants are rounded up, so that every
estimate is one to six times the measured memory. Estimates for error bounds are one to two times the measured memory.

The constants come from measured peaks of the resident memory with one thread. The peaks minus 384 MiB were, in MiB:

    displacement   plane n = 128: 139, criss-cross 275, shaken 417; n = 256: 827, shaken 1542; space n = 24: 1440,
                   shaken n = 12: 390, 18: 1220; by multigrid n = 36: 2250, 48: 4100, shaken 6300 and 15000
    equivalence    plane n = 32: 11, 64: 55; space n = 6: 18, 9: 79
    stress         n = 16: 39, 32: 207, 64: 868
    bound          of u_h alone n = 8: 69, 16: 239; with a mesh refined once n = 8: 183, 16: 465, 32: 1890, refined
                   twice n = 8: 390, 16: 1520; on an adapted mesh of 6756 cells 1450; on given meshes of 438 cells 37,
                   1768: 122, 7102: 1104; refined once 438: 266, 1768: 1193, 3496: 2669, 7102: 5757
    statements     at most 335, in space 1550
    task           static problems at three times n = 128: 180; n time steps n = 64: 310, 96: 1130; in space n = 18: 390
"""

from study.fem.naming import family_named
from study.ledger.files import UsageError

MIB = 2.0**20
KIB = 2.0**10
BASE = 384 * MIB
PER_UNKNOWN = {2: 16 * KIB, 3: 80 * KIB}
"""Memory in bytes for each unknown, by the dimension of the body."""
TEXT_PER_UNKNOWN = {2: 1 * KIB, 3: 3 * KIB}
"""Bytes needed to write the values of one unknown at one time as text, by the dimension of the body."""
SMALL_MEMORY, SOLID_MEMORY = 736 * MIB, 2304 * MIB
"""Memory in bytes for statements whose meshes have a fixed size, in the plane and in space."""
BOUND_MEMORY, PER_BOUND_CELL = 96 * MIB, 260 * KIB
"""Memory in bytes for an error bound: on any mesh, and for each cell of the refined mesh."""
FACTORISED = 33_000
"""Largest number of cells on which the stresses of an error bound can be computed.

The Cholesky factor of their matrix has about 143 n log₂ n entries for n cells, more than SuperLU can factorise on
larger meshes.
"""
STRESSES = 18
"""Number of unknown stresses in each square of a plane mesh; a square has two cells."""


def cells(family: str) -> int:
    """Return how many times more cells a plane mesh of a family has than the one-diagonal mesh of the same level."""
    return family_named(family).density


def unknowns(dim: int, n: int, family: str) -> int:
    """Return the number of unknowns of a P1 displacement on a mesh.

    Args:
        dim: the dimension of the body.
        n: the level of the mesh.
        family: the name of the mesh family.
    """
    return dim * (n + 1) ** dim * (cells(family) if dim == 2 else 1)


def displacement(dim: int, n: int, family: str) -> float:
    """Return the memory in bytes for solving the displacement problem (Problem 5.1) on the mesh of level n of a family.

    The stress problem (Problem 3.2) on the strains of P1 displacements needs as much memory.

    Args:
        dim: the dimension of the body.
        n: the level of the mesh.
        family: the name of the mesh family.
    """
    return BASE + PER_UNKNOWN[dim] * unknowns(dim, n, family)


def statement(dim: int, n: int) -> float:
    """Return the memory in bytes for measuring a statement on a mesh of level n that the statement itself chooses."""
    return max(SMALL_MEMORY, displacement(dim, n, "shaken")) if dim == 2 else SOLID_MEMORY


def stress(n: int) -> float:
    """Return the memory in bytes for solving the stress problem (3.2) in a conforming stress space at level n."""
    return BASE + PER_UNKNOWN[2] * STRESSES * n**2


def triangles(n: int, family: str) -> int:
    """Return the number of cells of a plane mesh of a family at level n."""
    return 2 * cells(family) * n**2


def bound(cells: int, refinements: int) -> float:
    """Return the memory in bytes for an error bound of a displacement.

    Args:
        cells: the number of cells of the mesh of the displacement.
        refinements: how often this mesh is refined for the error bound.
    """
    return BASE + BOUND_MEMORY + PER_BOUND_CELL * cells * 4**refinements


def require_factorisation(cells: int, refinements: int) -> None:
    """Raise UsageError if the mesh for an error bound has too many cells for SuperLU, however much memory there is.

    Args:
        cells: the number of cells of the mesh of the displacement.
        refinements: how often this mesh is refined for the error bound.
    """
    refined = cells * 4**refinements
    if refined > FACTORISED:
        raise UsageError(
            f"an error bound on {cells} triangles with --refine {refinements} needs stresses on {refined} triangles, "
            f"and SciPy's SuperLU can factorise their matrix for at most about {FACTORISED}: take "
            + (f"--refine {refinements - 1}, or " if refinements else "")
            + f"a mesh of at most {FACTORISED // 4**refinements} triangles"
        )


def task(dim: int, n: int, family: str, steps: int) -> float:
    """Return the memory in bytes for writing a task: a contact problem with time steps, for other codes.

    Args:
        dim: the dimension of the body.
        n: the level of the mesh.
        family: the name of the mesh family.
        steps: the number of time steps.
    """
    return displacement(dim, n, family) + TEXT_PER_UNKNOWN[dim] * unknowns(dim, n, family) * steps
