"""Kratos, augmented Lagrangian mortar contact: a face that falls through a foundation of one long segment.

    build/codes-venv/bin/python examples/codes/kratos_search.py [DIR]

A strip of n squares, each cut into two triangles, is held on top and lies on a foundation of one segment, half as long
again. Equal forces press its lower vertices down. Where there is a foundation nothing moves: all depths are zero.
Printed are those of four squares, of five, and of five with a larger search factor. With five, both ends of the face
sink as deep as if the foundation held the vertices between them alone, and the solution is said to have converged. DIR
gets the input of this one.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
from contact_judge import Task
from kratos_mortar import SMALL, materials, mdpa, settings, solve

SEGMENTS = 1
WIDER = {"search_parameters": {"search_factor": 50.0}}


def strip(n: int) -> Task:
    """[0, 1] × [0, 1/n] with n + 1 vertices below, numbered first; E = 5/2, ν = 1/4."""
    below = np.arange(n)
    lower, upper = (
        np.stack(pair, 1) for pair in ((below, below + 1, below + n + 2), (below, below + n + 2, below + n + 1))
    )
    law = {"matrix": [[3, 1, 0], [1, 3, 0], [0, 0, 2]], "factor": 1.0}
    contact = {"normal": [0, -1], "facets": np.stack([below, below + 1], 1).tolist(), "vertices": list(range(n + 1))}
    data = {"format": "contact-task", "version": 1, "mode": "frozen", "scale": 1, "h": 1 / n, "steps": []}
    data |= {"vertices": [[i / n, j / n] for j in (0, 1) for i in range(n + 1)]}
    data |= {"cells": np.concatenate([lower, upper]).tolist(), "clamped": list(range(n + 1, 2 * n + 2))}
    return Task("strip", data | {"contact": [contact], "law": {"A": law, "G": law}})


def main(place: str = "") -> None:
    """Solve and print; write the input."""
    for n, options in ((4, {}), (5, {}), (5, WIDER)):
        task, load = strip(n), np.zeros((2 * n + 2, 2))
        load[: n + 1, 1] = -SMALL / n
        u, iterations = solve(task, load, "ALM", options, SEGMENTS)
        depth = " ".join(f"{abs(y):.4f}" for y in u[: n + 1, 1] / SMALL)
        print(f"{n} squares, {options or 'default search'}: depths {depth}, converged in {iterations} iterations")
        if place and n == 5 and not options:
            files = {"materials": materials(task), "parameters": settings(task, "ALM", options)}
            Path(place).mkdir(parents=True, exist_ok=True)
            (Path(place) / "task.mdpa").write_text(mdpa(task, SEGMENTS))
            for name, content in files.items():
                (Path(place) / f"{name}.json").write_text(json.dumps(content, indent=1))


if __name__ == "__main__":
    main(*sys.argv[1:])
