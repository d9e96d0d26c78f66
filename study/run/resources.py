"""How much memory a job needs, by estimate, and how much there is.

The estimates are a base plus what grows with the level n, which is the factor of a matrix for the most part: n² log n
numbers in the plane, n⁴ in space, n³ where multigrid takes its place. Constants are rounded up from peaks of the
resident size with one thread, here in MiB beyond the base:

    displacement   n = 128: 140, shaken 290, criss-cross 280; n = 256: 560; n = 512: 2220;
                   in space n = 12: 60, 24: 1440, shaken n = 12: 390, 18: 1220; by multigrid n = 36: 2250, 48: 4100,
                   shaken 6300 and 15000, since no two cells share points of quadrature, 2500 and 5900 of it without
                   the finer quadrature of a row
    equivalence    n = 32: 11, 64: 55; in space n = 6: 18, 9: 79
    stress         n = 16: 39, 32: 170 … 207, 64: 868
    bound          of u_h alone n = 8: 25 … 69, 16: 239; with an enclosure on a mesh refined once n = 8: 183,
                   16: 465, 32: 1890, twice n = 8: 390, 16: 1520
    statements     at their fixed levels at most 335, in space 1550
"""

from __future__ import annotations

from collections.abc import Iterator
from math import log2
from pathlib import Path

import psutil

from study.fem.naming import UsageError
from study.solve.solver_choice import FACTORED

GIB = 2.0**30
MIB = 2.0**20
KIB = 2.0**10
BASE = 384 * MIB
"""An interpreter with everything imported takes 230, with formulas and compiled passes 290 to 350."""
SMALL = 736 * MIB
"""Jobs whose size is fixed."""
SOLID = 2304 * MIB
"""The same in space: functionals on cells halved twice."""


def cells(family: str) -> int:
    """Cells of a plane mesh, over those of one with two triangles per square."""
    return 2 if family == "criss-cross" else 1


def displacement(dim: int, n: int, family: str) -> float:
    """Bytes for Problem 5.1 at a level."""
    # Where all cells are alike, they share most of what is kept of them.
    alike = family == "one-diagonal"
    if dim == 2:
        return BASE + (1.8 if alike else 2.6) * KIB * n**2 * log2(n) * cells(family)
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


def require(what: str, need: float, room: float) -> None:
    """Refuse, before time is spent, what needs more bytes than there are.

    Raises:
        UsageError: says what is needed, and what there is.
    """
    if need > room:
        raise UsageError(
            f"{what} needs about {need / GIB:.1f} GiB of memory, {room / GIB:.1f} GiB are available; take coarser "
            "levels with --levels (--level of `study show`), free memory, or take a machine with more"
        )


def available(root: Path = Path("/")) -> float:
    """Bytes that can be used without swapping: free on the machine and below the limits of all control groups.

    Page cache that can be dropped counts as free in both. Linux tells the groups of this process and their limits in
    /proc and /sys under ``root``; other systems have none.
    """
    return min([float(psutil.virtual_memory().available), *_headroom(root)])


def _headroom(root: Path) -> Iterator[float]:
    """What is left in every control group with a limit that this process belongs to."""
    for directory, limit, usage, cache in _groups(root):
        statistics = _read(directory / "memory.stat").split()
        inactive = dict(zip(statistics[::2], statistics[1::2], strict=True)).get(cache, "0")
        maximum, used = _read(directory / limit).strip(), _read(directory / usage).strip()
        if maximum.isdigit() and used.isdigit():
            yield float(int(maximum) - int(used) + int(inactive))


def _groups(root: Path) -> Iterator[tuple[Path, str, str, str]]:
    """The directories of the groups, up to the topmost, with the names of limit, use and droppable cache."""
    mounted = root / "sys/fs/cgroup"
    for line in _read(root / "proc/self/cgroup").splitlines():
        _, controllers, path = line.split(":", 2)
        if controllers == "":
            top, names = mounted, ("memory.max", "memory.current", "inactive_file")
        elif "memory" in controllers.split(","):
            top, names = mounted / "memory", ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file")
        else:
            continue
        steps = Path(path.lstrip("/")).parts
        for depth in range(len(steps) + 1):
            yield top.joinpath(*steps[:depth]), *names


def _read(path: Path) -> str:
    """The text of a file; empty where there is none."""
    return path.read_text() if path.is_file() else ""
