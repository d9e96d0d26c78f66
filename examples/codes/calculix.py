"""CalculiX: face-to-face penalty contact with a meshed foundation, by files.

Plane strain elements CPE3; the foundation is a held slab below each face, of as many segments as the face has edges.
Loads are made small (SMALL), as contact follows the deformed geometry. g = C_νννν. Displacements come back with seven
digits, which bounds what can be seen. Fields of the input are cut after 20 characters. Its mortar contact refuses plane
elements, whose nodes are tied when they are expanded, and is not driven here.
"""

from __future__ import annotations

import re
import subprocess
import tempfile
from functools import partial
from pathlib import Path

import numpy as np
from common import MARGIN, CannotExpressError, forces, normal_modulus, slab, young
from contact_judge import Task

CODE = "CalculiX"
SMALL = 1e-4


def _version() -> str:
    found = subprocess.run(["ccx", "-v"], capture_output=True, text=True, check=False).stdout
    return (re.findall(r"[Vv]ersion\s*([\d.]+)", found) or ["?"])[0]


VERSION = _version()


def deck(task: Task, load: np.ndarray, behaviour: str) -> str:
    """The input."""
    E, nu = young(task)
    numbered = [(i, k, c) for i, c in enumerate(task.cells.tolist(), start=1) for k in range(3)]
    edges = {frozenset((c[k], c[(k + 1) % 3])): (i, k + 1) for i, k, c in numbered}
    points, cells, surfaces, held = [task.vertices], [task.cells], [], []
    for i, piece in enumerate(task.data["contact"]):
        faces = [edges[frozenset(facet)] for facet in piece["facets"]]
        corners = np.unique(piece["facets"])
        segments = int(len(faces) * (1 + 2 * MARGIN))
        vertices, triangles = slab(task.vertices[corners], np.array(piece["normal"]), segments)
        start, first = sum(map(len, points)), sum(map(len, cells)) + 1
        points.append(vertices)
        cells.append(triangles + start)
        held += range(start + 1, start + len(vertices) + 1)
        surfaces += [f"*SURFACE, NAME=SLAVE{i}", *(f"{e}, S{k}" for e, k in faces)]
        surfaces += [f"*SURFACE, NAME=MASTER{i}", *(f"{first + k}, S1" for k in range(segments))]
        surfaces += ["*CONTACT PAIR, INTERACTION=RIGID, TYPE=SURFACE TO SURFACE", f"SLAVE{i}, MASTER{i}"]
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{i}, {x:.13g}, {y:.13g}" for i, (x, y) in enumerate(np.concatenate(points), start=1)]
    lines.append("*ELEMENT, TYPE=CPE3, ELSET=EALL")
    lines += [f"{i}, {', '.join(map(str, cell))}" for i, cell in enumerate(np.concatenate(cells) + 1, start=1)]
    lines += ["*NSET, NSET=BODY, GENERATE", f"1, {len(task.vertices)}, 1"]
    lines += ["*MATERIAL, NAME=M", "*ELASTIC", f"{E:.13g}, {nu:.13g}", "*SOLID SECTION, ELSET=EALL, MATERIAL=M", "1."]
    lines += ["*SURFACE INTERACTION, NAME=RIGID", *behaviour.splitlines(), *surfaces]
    lines += ["*BOUNDARY", *(f"{i}, 1, 2" for i in [*(task.clamped + 1), *held])]
    lines += ["*STEP, INC=200", "*STATIC", "1., 1.", "*CLOAD"]
    lines += [f"{i}, {axis + 1}, {x:.12e}" for i, b in enumerate(load, start=1) for axis, x in enumerate(b) if x]
    lines += ["*NODE PRINT, NSET=BODY", "U", "*END STEP"]
    return "\n".join(lines) + "\n"


def make(behaviour: str, factor: float, scaled: bool, task: Task):
    """step(b, s0) ↦ u, one run of the program for each."""
    if task.dim != 2:
        raise CannotExpressError("this adapter is for the plane")
    young(task)
    K = factor * normal_modulus(task) / (task.data["h"] if scaled else 1)

    def step(load: np.ndarray, stress: np.ndarray) -> np.ndarray:
        with tempfile.TemporaryDirectory() as name:
            text = deck(task, SMALL * forces(task, load, stress), behaviour.format(K=K))
            (Path(name) / "task.inp").write_text(text)
            done = subprocess.run(["ccx", "-i", "task"], cwd=name, capture_output=True, text=True, check=False)
            found = (Path(name) / "task.dat").read_text() if (Path(name) / "task.dat").exists() else ""
            values = re.findall(r"^\s*(\d+)\s+(\S+E\S+)\s+(\S+E\S+)\s+\S+$", found, re.MULTILINE)
            step.solves += len(re.findall(r"^ iteration", done.stdout, re.MULTILINE))
        u = np.full_like(task.vertices, np.nan)
        for number, x, y in values:
            u[int(number) - 1] = float(x), float(y)
        return u / SMALL

    step.solves = 0
    return step


LINEAR = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{K:.6g}, 1e-12"
HARD = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD"
VARIANTS = {
    "surface to surface, LINEAR 10 g/h": partial(make, LINEAR, 10, True),
    "surface to surface, LINEAR 10 g": partial(make, LINEAR, 10, False),
    "surface to surface, HARD": partial(make, HARD, 1, False),
}
FINEST = dict.fromkeys(VARIANTS, 32)
