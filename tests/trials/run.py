"""Bounds of errors tried on problems with known solutions, `make trials`: python -m trials.run"""

from __future__ import annotations

from trials import random_problems
from trials.record import OUT, PAGE, refresh


def main() -> None:
    refresh(PAGE, {"random-trials": random_problems.summary(random_problems.table(OUT))})


if __name__ == "__main__":
    main()
