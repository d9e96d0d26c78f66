"""Shared by the commands: progress, drawing, lists of files."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

from tqdm import tqdm

from study.ledger.files import UsageError
from study.present.figures import Drawing, draw_figures
from study.run.executor import Processes

Result = TypeVar("Result")


def check_jobs(jobs: int) -> None:
    """Raise UsageError for fewer than one process."""
    if jobs < 1:
        raise UsageError(f"--jobs must be 1 or more, got {jobs}")


def progress_bar(total: int) -> tqdm:
    """Return a progress bar on standard error, with fewer lines if that is no terminal."""
    pause = 0.5 if sys.stderr.isatty() else 10
    return tqdm(total=total, unit="", bar_format="{l_bar}{bar}| {elapsed}<{remaining}", mininterval=pause)


def with_progress(name: str, T: float, compute: Callable[[Callable[[float], object]], Result]) -> Result:
    """Return what is computed, with a progress bar of the times up to T that are done."""
    with progress_bar(100) as bar:
        bar.set_description(name)
        return compute(lambda time: bar.update(round(100 * time / T) - bar.n))


def draw(directory: Path, processes: Processes, chosen: Callable[[Path], list[Drawing]]) -> list[Path]:
    """Draw figures and show the progress; returns their files."""
    with progress_bar(0) as bar:

        def show(done: int, total: int, name: str) -> None:
            bar.total = total
            bar.set_description(f"figure {name}", refresh=False)
            bar.update()

        return draw_figures(directory, chosen, processes.map, show)


def listed(paths: Sequence[Path]) -> str:
    """Return files as text, three or more files of one kind and folder as one pattern."""
    kinds: dict[str, list[Path]] = {}
    for path in paths:
        kinds.setdefault(f"{path.parent}/*{path.suffix}", []).append(path)
    return ", ".join(f"{kind} ({len(of)})" if len(of) > 2 else ", ".join(map(str, of)) for kind, of in kinds.items())
