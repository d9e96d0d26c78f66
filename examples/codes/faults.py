"""Faults put into an adapter on purpose, and which case shows them: the table of docs/how-to/verify-a-contact-code.md.

    python faults.py TASKS        tasks of the cases, exported with the levels 8 16 32

Every answer is by the solver of this study from a task that is read wrongly, so that nothing but the fault is judged.
"""

from __future__ import annotations

import copy
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy.sparse as sps
import this_study
from contact_judge import Judgement, Task, answer, assess, read_tasks
from scipy.sparse.linalg import spsolve

CASES = "advance-recede", "layered", "anisotropic", "full-contact", "lift-and-land"
UNSEEN = "exact for P1"


@dataclass(frozen=True)
class Fault:
    """What an adapter does wrong: make(task), of a faulty adapter, and what of it."""

    name: str
    make: Callable[[Task], Callable[[np.ndarray, np.ndarray], np.ndarray]]


def misread(change: Callable[[Task], dict]) -> Callable:
    """An adapter that takes another stiffness or other vertices for those of the task."""

    def make(task: Task):
        other = copy.copy(task)
        for name, value in change(task).items():
            setattr(other, name, value)
        return this_study.make(other)

    return make


def other_stress(change: Callable[[np.ndarray], np.ndarray]) -> Callable:
    """An adapter that takes another initial stress, Mandel (cells, D)."""

    def make(task: Task):
        step = this_study.make(task)
        return lambda load, stress: step(load, change(stress))

    return make


def without(place: float | None) -> Callable[[Task], dict]:
    """The constraint forgotten at the vertex of the first piece nearest to a place in [0, 1] along it, None: at every
    second one."""

    def change(task: Task) -> dict:
        first, *others = task.data["contact"]
        facets = task.vertices[np.unique(first["facets"])]
        along = np.array([-first["normal"][1], first["normal"][0]])
        s = facets @ along
        at = (task.vertices[first["vertices"]] @ along - s.min()) / np.ptp(s)
        held = np.argsort(at)[::2] if place is None else np.delete(np.arange(len(at)), abs(at - place).argmin())
        kept = np.array(first["vertices"])[np.sort(held)]
        return {"data": {**task.data, "contact": [{**first, "vertices": kept.tolist()}, *others]}}

    return change


def springs(stiffness: Callable[[Task], float]) -> Callable:
    """A foundation of springs at the vertices, force for length and area, by active sets."""

    def make(task: Task):
        K, N, free = this_study.stiffness(task), this_study.normals(task), _free(task)
        k = stiffness(task) * np.concatenate([mass for *_, mass in task.pieces()])

        def step(load: np.ndarray, stress: np.ndarray) -> np.ndarray:
            b, u, held = (load - task.internal(stress)).ravel(), np.zeros(task.vertices.size), np.ones(len(k))
            for _ in range(30):
                S = sps.csc_array(K + N.T @ sps.diags_array(held * k) @ N)
                u[free] = spsolve(S[free][:, free], b[free])
                held = 1.0 * (N @ u > 0)
            return u.reshape(-1, task.dim)

        return step

    return make


def tied(task: Task):
    """u_ν = 0 at all constrained vertices: no lift-off."""
    free = _free(task)
    K, N = this_study.stiffness(task)[free][:, free], this_study.normals(task)[:, free]
    S = sps.csc_array(sps.block_array([[K, N.T], [N, None]]))

    def step(load: np.ndarray, stress: np.ndarray) -> np.ndarray:
        u, b = np.zeros(task.vertices.size), (load - task.internal(stress)).ravel()[free]
        u[free] = spsolve(S, np.append(b, np.zeros(len(N.indptr) - 1)))[: len(free)]
        return u.reshape(-1, task.dim)

    return step


def _free(task: Task) -> np.ndarray:
    fixed = np.add.outer(task.dim * task.clamped, np.arange(task.dim))
    return np.setdiff1d(np.arange(task.vertices.size), fixed)


def inward(task: Task) -> dict:
    """Normals that point into the body."""
    turned = [{**piece, "normal": [-x for x in piece["normal"]]} for piece in task.data["contact"]]
    return {"data": {**task.data, "contact": turned}}


def _shear(values: np.ndarray, by: float) -> np.ndarray:
    """Mandel components with those of shear multiplied."""
    d = {3: 2, 6: 3}[values.shape[-1]]
    return values * np.where(np.arange(values.shape[-1]) < d, 1.0, by)


def _voigt_for_mandel(task: Task) -> dict:
    once = _shear(task.stiffness, np.sqrt(0.5))
    return {"stiffness": _shear(once.swapaxes(1, 2), np.sqrt(0.5))}


FAULTS = (
    Fault("initial stress forgotten", other_stress(lambda s: 0 * s)),
    Fault("initial stress with the other sign", other_stress(lambda s: -s)),
    Fault("initial stress not divided by √2 in shear", other_stress(lambda s: _shear(s, np.sqrt(2)))),
    Fault("stiffness divided by √2 twice in shear", misread(_voigt_for_mandel)),
    Fault("*A* in place of *G*", misread(lambda task: {"stiffness": task.A})),
    Fault("`factor` forgotten", misread(lambda task: {"stiffness": 0 * task.G + task.data["law"]["G"]["matrix"]})),
    Fault("ν pointing into the body", misread(inward)),
    Fault("no lift-off, $u_\\nu = 0$", tied),
    Fault("a vertex inside forgotten", misread(without(0.25))),
    Fault("the vertex at the end forgotten", misread(without(1.0))),
    Fault("every second vertex only", misread(without(None))),
    Fault("springs of 30, not scaled with *h*", springs(lambda task: 30.0)),
)


def judged(tasks: list[Task], fault: Fault) -> Judgement:
    """The judgement of a fault on the meshes of one case."""
    (found,) = assess(tasks, {task.name: answer(task, fault.make) for task in tasks})
    return found


def cell(found: Judgement) -> str:
    """The class as it stands in the table."""
    if found.verdict == UNSEEN:
        return "not seen"
    share = found.errors[-1].distance / found.errors[-1].best
    return f"{found.verdict}, {share:.1g}" + (" †" if found.errors[-1].idle else "")


def table(groups: dict[str, list[Task]]) -> list[str]:
    """The lines of the table, a row for each fault and a column for each case."""
    head = ["fault", *(f"*{case}*" for case in groups)]
    rows = [[fault.name, *(cell(judged(tasks, fault)) for tasks in groups.values())] for fault in FAULTS]
    return [f"| {' | '.join(row)} |" for row in (head, ["---"] * len(head), *rows)]


if __name__ == "__main__":
    tasks = sorted(read_tasks(Path(sys.argv[1])), key=lambda one: one.data["level"])
    print("\n".join(table({case: [task for task in tasks if task.data["case"] == case] for case in CASES})))
