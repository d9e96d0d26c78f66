"""Tasks as keys and numbers: the content of the format ``contact-task`` (docs/reference/tasks.md)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from manufactured.body import Kind
from manufactured.law import Linear
from manufactured.tensors import Array
from study.fem.material import means
from study.fem.space import Space
from study.ledger.errors import UsageError
from study.run.foundation import slab
from study.statements.shared.tasks import Task

FORMAT, VERSION = "contact-task", 1
Data = dict[str, Any]


def frozen(task: Task, instants: Sequence[float], scale: float = 1.0) -> Data:
    """The static problems at some instants, with what answers are judged by."""
    require_instants(instants, task.solution.body.T)
    loads = [
        {
            "time": float(t),
            "load": scale * task.space.nodal(task.gauge.load(t)).T,
            "initial_stress": scale * task.initial_stress(t).T,
            "initial_traction": [scale * values for values in task.initial_tractions(t)],
            "traction": [scale * values for values in task.loads_on(t)],
        }
        for t in instants
    ]
    judge = [_judged(task, t, t, task.static(t)) for t in instants]
    return {**_head(task, "frozen", scale), "steps": loads, "judge": judge}


def require_instants(instants: Sequence[float], T: float) -> None:
    """Raise UsageError for instants outside [0, T], or none."""
    if not instants or min(instants) < 0 or max(instants) > T:
        raise UsageError(f"--instants must lie in [0, {T:g}], got {', '.join(f'{t:g}' for t in instants)}")


def require_scale(scale: float) -> None:
    """Raise UsageError for a factor of loads that is not positive."""
    if not 0 < scale < float("inf"):
        raise UsageError(f"--scale must be a positive number, got {scale:g}")


def march(task: Task, steps: int, scale: float = 1.0) -> Data:
    """The problem in time by the midpoint rule with equal steps, b at t_{n−1/2} and the answer at t_n."""
    problem, states = task.march(steps)
    k, judge, loads = problem.T / steps, [], []
    for n, state in enumerate(states):
        if n:
            load = scale * task.space.nodal(problem.load((n - 0.5) * k)).T
            loads.append({"time": state.time, "load": load})
            judge.append(_judged(task, state.time, (n - 0.5) * k, state.u))
    moved = scale * task.space.nodal(problem.u0).T
    return {**_head(task, "march", scale), "step": k, "start": moved, "steps": loads, "judge": judge}


def _judged(task: Task, time: float, balanced: float, reference: Array) -> Data:
    """What an answer at one time is judged by; contact forces are those at the time at which forces are balanced."""
    sample = task.gauge.sample(time)
    return {
        "time": float(time),
        "strain": sample.means.T,
        "rest": sample.oscillation,
        "displacement": task.space.nodal(sample.interpolant).T,
        "reference": task.space.nodal(reference).T,
        "pressure": task.pressures(balanced),
        "resultant": task.resultants(balanced),
    }


def _head(task: Task, mode: str, scale: float) -> Data:
    require_scale(scale)
    space, law = task.space, task.solution.law
    mesh, clamped = space.mesh, [space.vertices(part) for part, _ in space.on(Kind.CLAMPED)]
    numbers = {"A": law.A, "G": law.G}
    return {
        "format": FORMAT,
        "version": VERSION,
        "case": task.case.name,
        "family": task.family.name,
        "level": task.level,
        "mode": mode,
        "scale": scale,
        "h": space.h,
        "vertices": mesh.p.T,
        "cells": oriented(mesh.p, mesh.t).T,
        "clamped": np.unique(np.concatenate(clamped)),
        "contact": [
            {"normal": part.normal, "facets": mesh.facets[:, space.facets(part)].T, "vertices": vertices}
            for part, vertices in space.contact
        ],
        "loaded": [
            {"normal": part.normal, "facets": mesh.facets[:, facets].T} for part, facets in space.on(Kind.LOADED)
        ],
        "law": {name: _constants(space, tensor) for name, tensor in numbers.items()},
    }


def _constants(space: Space, tensor: Linear) -> Data:
    factor = means(space, tensor.factor)
    return {"matrix": tensor.matrix, "factor": 1.0 if np.ptp(factor) == 0 and factor[0] == 1 else factor}


def oriented(points: Array, cells: Array) -> Array:
    """The cells with positive volumes, (d + 1, cells)."""
    corners = points[:, cells]
    negative = np.linalg.det(np.moveaxis(corners[:, 1:] - corners[:, :1], 2, 0)) < 0
    found = cells.copy()
    found[-2:, negative] = found[:-3:-1, negative]
    return found


def with_foundation(data: Data, segments: int) -> Data:
    """The same with a meshed slab below each contact piece."""
    vertices = np.asarray(data["vertices"])
    pieces = [
        slab(vertices[np.unique(piece["facets"])], np.asarray(piece["normal"]), segments) for piece in data["contact"]
    ]
    return {**data, "foundation": pieces}
