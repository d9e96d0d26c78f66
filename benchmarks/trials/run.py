"""Bounds of errors tried, `make trials`: python -m trials.run

Rows that are kept in ``results/trials`` are not made again: to make all, remove the files.
"""

from __future__ import annotations

from benchmarks.trials import random_problems, stiff
from benchmarks.trials.record import OUT, PAGE, refresh


def main() -> None:
    refresh(PAGE, {"effectivity": stiff.summary(stiff.table(OUT))})
    refresh(PAGE, {"random-trials": random_problems.summary(random_problems.table(OUT))})


if __name__ == "__main__":
    main()
