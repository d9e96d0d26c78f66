"""Let one contact code march through a problem on several meshes, in the Python that has this code.

    python march.py ADAPTER TASKS OUT

ADAPTER is a module of examples/codes. TASKS has the marches that judge_codes.py writes. OUT gets one displacement file
for each method and mesh, as ``study bound --displacement`` reads it.
"""

from __future__ import annotations

import copy
import importlib
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from types import ModuleType

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "codes"))
from common import normal_modulus
from contact_judge import Task, answer, read_tasks


def fixed(stiffness: float, method: Callable, task: Task):
    """The step of a penalty method with a stiffness that depends neither on the mesh nor on the time step.

    Args:
        stiffness: in multiples of G_νννν.
        method: (factor, scaled, task) ↦ step, the stiffness being factor times C_νννν, C = A/k + G/2.
    """
    elastic = copy.copy(task)
    elastic.stiffness = task.G
    return method(stiffness * normal_modulus(elastic) / normal_modulus(task), False, task)


def off_the_clamp(task: Task) -> Task:
    """Return the task without the edges of Γ3 at clamped vertices, whose multipliers have no equation in Kratos.

    Multipliers are dual to nodal displacements, so that the conditions at the other vertices stay the same.
    """
    clamped, found = set(task.clamped.tolist()), copy.copy(task)
    pieces = [
        piece | {"facets": [facet for facet in piece["facets"] if not clamped & set(facet)]}
        for piece in task.data["contact"]
    ]
    found.data = task.data | {"contact": pieces}
    return found


def methods(adapter: str, module: ModuleType) -> dict[str, Callable]:
    """Return the methods of a code by the names in the table: one that is meant to be right, and a fixed penalty."""
    known = module.VARIANTS
    if adapter == "getfem_contact":
        penalty = lambda factor, scaled, task: module.make(partial(module.penalty, factor, scaled), task)  # noqa: E731
        return {
            "nodal augmented Lagrangian": known["nodal augmented Lagrangian, r = g"],
            "Nitsche, θ = 0": known["Nitsche θ = 0, γ0 = 25 g"],
            "penalty 10 g, fixed": partial(fixed, 10, penalty),
        }
    if adapter == "ngsolve_penalty":
        return {
            "penalty 10 g/h": known["ContactBoundary, penalty 10 g/h"],
            "penalty 10 g, fixed": partial(fixed, 10, module.boundary_term),
            "penalty g, fixed": partial(fixed, 1, module.boundary_term),
        }
    if adapter == "kratos_mortar":
        mortar = known["ALM mortar, foundation as fine as the face"]
        return {"augmented Lagrangian, mortar": lambda task: mortar(off_the_clamp(task))}
    if adapter == "calculix":
        return {
            "penalty 10 g/h": known["surface to surface, LINEAR 10 g/h"],
            "penalty 10 g, fixed": partial(fixed, 10, partial(module.make, module.LINEAR)),
        }
    return {"active set": next(iter(known.values()))}


def main(adapter: str, directory: str, out: str) -> None:
    """Write the files."""
    module = importlib.import_module(adapter)
    for task in read_tasks(Path(directory)):
        times = np.array([0.0, *(step["time"] for step in task.data["steps"])])
        for method, make in methods(adapter, module).items():
            path = Path(out) / f"{adapter}-{task.data['level']}-{list(methods(adapter, module)).index(method)}.npz"
            if path.exists():
                continue
            u = np.concatenate([[task.start()], answer(task, make)])
            name = np.array([module.CODE, module.VERSION, method])
            np.savez(path, points=task.vertices, triangles=task.cells, times=times, u=u, name=name)
            print(f"{module.CODE}, {method}, n = {task.data['level']}", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
