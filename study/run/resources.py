"""How much memory there is, and the refusal of what needs more."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import psutil

from study.ledger.errors import UsageError

GIB = 2.0**30


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
