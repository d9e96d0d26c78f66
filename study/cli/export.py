"""``study export``: writes contact problems as files for other codes.

The format of the files is described in docs/reference/tasks.md.
"""

import lzma
from argparse import Namespace
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from hashlib import sha256
from json import dumps
from math import ceil, inf, log10
from pathlib import Path
from typing import Any

import numpy as np

from manufactured.body import Kind
from manufactured.case import Case
from manufactured.self_proof import prove
from manufactured.tensors import Array
from study.cli.options import OK
from study.fem.mesh import MeshError, boundary_parts, determinants
from study.fem.naming import family_named, resolve
from study.fem.space import means
from study.ledger.files import Json, StoreError, UsageError, write_text, write_whole
from study.run.executor import require
from study.run.plan import quick
from study.run.store import Store
from study.solve.steps import require_steps
from study.statements.shared import estimates
from study.statements.shared.meshes import fits
from study.statements.shared.tasks import FROZEN_TIMES, Task

MOST_LEVELS = 12
"""Levels next to the one that was asked for that are tried if its mesh does not fit the body."""


def do_export(options: Namespace) -> int:
    """Write the contact problem of each case, with its solution, into a file for each mesh family and level; return 0.

    By default, each case is written on the mesh families on which the quick study measures it.
    """
    cases = [resolve(name) for name in options.case]
    if repeated := {case.name for case in cases if [other.name for other in cases].count(case.name) > 1}:
        raise UsageError(f"two cases have the name {', '.join(sorted(repeated))}; give each case once")
    wanted = []
    for case in cases:
        _check(options, case)
        families = [family_named(name) for name in options.family] if options.family else quick().families_of(case)
        wanted += [Task(case, family, level) for family in families for level in options.levels]
    marches = options.mode == "march"
    for task in wanted:
        steps = options.steps or task.level if marches else len(options.instants or FROZEN_TIMES)
        need = estimates.task(task.solution.body.dim, task.level, task.family.name, steps)
        require(f"level {task.level}", need)
        _require_mesh(task)
    for case in cases:
        prove(case.solution, f"case {case.name}")
    with TaskStore(options.out).locked():
        for task in wanted:
            # A ``Task`` keeps its mesh and factorisations. A new one for each file frees the memory of the one before.
            fresh = replace(task)
            if marches:
                data = march(fresh, options.steps or task.level, options.scale)
            else:
                data = frozen(fresh, _instants(options, task.case), options.scale)
            if options.foundation is not None:
                data = with_foundation(data, options.foundation)
            path = write_task(options.out, data)
            print(f"{path}  {path.stat().st_size / 1000:.1f} kB")
    return OK


def _require_mesh(task: Task) -> None:
    """Raise UsageError, which names the case and levels that would do, unless the mesh fits the body."""
    body = task.solution.body
    try:
        boundary_parts(task.family(body, task.level), body)
    except MeshError as error:
        near = sorted(range(1, 2 * task.level), key=lambda level: abs(level - task.level))[:MOST_LEVELS]
        fit = [str(level) for level in near if fits(task.family, body, level)][:3]
        mend = f"; levels that would do: {', '.join(fit)}" if fit else ""
        where = f"case {task.case.name} on {task.family.name} meshes of level {task.level}"
        raise UsageError(f"{where}: {error}{mend}") from error


def _instants(options: Namespace, case: Case) -> list[float]:
    return options.instants or [case.solution.body.T * part for part in FROZEN_TIMES]


def _check(options: Namespace, case: Case) -> None:
    """Raise UsageError for options that cannot be used, before anything is written."""
    if options.mode == "march" and options.instants:
        raise UsageError("--instants belong to --mode frozen; for --mode march give the number of --steps")
    if options.mode == "frozen" and options.steps is not None:
        raise UsageError("--steps belong to --mode march; for --mode frozen give --instants")
    if options.steps is not None:
        require_steps(options.steps)
    instants = _instants(options, case)
    T = case.solution.body.T
    if min(instants) < 0 or max(instants) > T:
        raise UsageError(f"--instants must lie in [0, {T:g}], got {', '.join(f'{t:g}' for t in instants)}")
    if options.foundation is not None and case.solution.body.dim != 2:
        raise UsageError("--foundation meshes foundations in the plane only; leave it out for a body in space")


# The content of the files.

TASK_FORMAT = "contact-task"
TASK_VERSION = 2
FOUNDATION_MARGIN = 0.25
FOUNDATION_DEPTH = 0.25
"""The length by which the mesh of a foundation extends beyond its contact face on each side, and its thickness. Both
are relative to the length of the face."""
TASK_SUMS = "SHA256SUMS"
ARRAY_DIGITS = 13
"""Significant digits of the largest number of an array. Smaller numbers have as many decimal places."""
FINER_ARRAYS = {"reference": 14}
"""Name of an array ↦ number of digits, if it needs more than ``ARRAY_DIGITS``. Distances from the reference
displacement may
be zero, and their rounding errors grow like 1/h."""


def frozen(task: Task, instants: Sequence[float], scale: float = 1.0) -> Json:
    """Return the data of a file with static problems, one for each of some times.

    The exact solution of a static problem, with which answers are compared, is the solution of the case at its time,
    without the factor ``scale``.

    Parameters:
        task: case, mesh family and level.
        instants: the times, in [0, T].
        scale: factor of all loads and of the initial gap, positive.
    """
    loads = [
        dict(
            time=t,
            load=scale * task.space.nodal(task.v_norm.load(t)).T,
            initial_stress=scale * task.initial_stress(t).T,
            initial_traction=[scale * values for values in task.tractions(Kind.CONTACT, t)],
            traction=[scale * values for values in task.tractions(Kind.LOADED, t)],
        )
        for t in instants
    ]
    judge = [_judged(task, t, t, task.static(t)) for t in instants]
    return {**_head(task, "frozen", scale), "steps": loads, "judge": judge}


def march(task: Task, steps: int, scale: float = 1.0) -> Json:
    """Return the data of a file with a problem in time, for the midpoint rule with equal steps.

    Loads and contact pressures belong to the middle of each step, displacements to its end. The solutions, with which
    answers are compared, are written without the factor ``scale``.

    Parameters:
        task: case, mesh family and level.
        steps: number of time steps.
        scale: factor of all loads, of the initial gap and of the initial displacement, positive.
    """
    problem, states = task.march(steps)
    k = problem.T / steps
    judge = []
    loads = []
    for n, state in enumerate(states):
        if n:
            load = scale * task.space.nodal(problem.load((n - 0.5) * k)).T
            loads.append({"time": state.time, "load": load})
            judge.append(_judged(task, state.time, (n - 0.5) * k, state.u))
    moved = scale * task.space.nodal(problem.u0).T
    return {**_head(task, "march", scale), "step": k, "start": moved, "steps": loads, "judge": judge}


def _judged(task: Task, time: float, balanced: float, reference: Array) -> Json:
    """Return the exact and the reference solution with which the answer of a code at one time is compared.

    Parameters:
        task: case, mesh family and level.
        time: the time of the displacement.
        balanced: the time at which the time scheme balances forces; contact forces belong to this time.
        reference: the discrete solution, (n_dofs,).
    """
    sample = task.v_norm.sample(time)
    return dict(
        time=time,
        strain=sample.means.T,
        rest=sample.oscillation,
        displacement=task.space.nodal(sample.interpolant).T,
        reference=task.space.nodal(reference).T,
        pressure=task.pressures(balanced),
        resultant=task.resultants(balanced),
    )


def _head(task: Task, mode: str, scale: float) -> Json:
    space = task.space
    law = task.solution.law
    mesh = space.mesh
    clamped = [space.vertices(part) for part, _ in space.on(Kind.CLAMPED)]
    numbers: Json = {}
    counts = [len(vertices) for _, vertices in space.contact]
    gaps: list[Json] = [{} for _ in counts]
    if task.solution.has_initial_gap:
        gaps = [{"gap": scale * gap} for gap in np.split(task.gap, np.cumsum(counts)[:-1])]
    for name, tensor in (("A", law.A), ("G", law.G)):
        factor = means(space, tensor.factor)
        numbers[name] = {"matrix": tensor.matrix, "factor": 1.0 if np.all(factor == 1) else factor}
    return dict(
        format=TASK_FORMAT,
        version=TASK_VERSION,
        case=task.case.name,
        family=task.family.name,
        level=task.level,
        mode=mode,
        scale=scale,
        h=space.h,
        vertices=mesh.p.T,
        cells=oriented(mesh.p, mesh.t).T,
        clamped=np.unique(np.concatenate(clamped)),
        contact=[
            {"normal": part.normal, "facets": mesh.facets[:, space.facets(part)].T, "vertices": vertices} | gap
            for (part, vertices), gap in zip(space.contact, gaps, strict=True)
        ],
        loaded=[{"normal": part.normal, "facets": mesh.facets[:, facets].T} for part, facets in space.on(Kind.LOADED)],
        law=numbers,
    )


def oriented(points: Array, cells: Array) -> Array:
    """Return the cells with their vertices in such an order that all volumes are positive, (d + 1, cells).

    Parameters:
        points: coordinates of the vertices, (d, vertices).
        cells: vertex numbers, (d + 1, cells).
    """
    negative = determinants(points, cells) < 0
    turned = cells.copy()
    turned[-2:, negative] = turned[:-3:-1, negative]
    return turned


def with_foundation(data: Json, segments: int) -> Json:
    """Return the data of a problem in the plane with a mesh of the foundation below each contact face.

    Parameters:
        data: the data without foundations.
        segments: number of segments of each foundation, 1 or more.
    """
    vertices = np.asarray(data["vertices"])
    pieces = [
        slab(vertices[np.unique(piece["facets"])], np.asarray(piece["normal"]), segments) for piece in data["contact"]
    ]
    return {**data, "foundation": pieces}


def slab(face: Array, normal: Array, segments: int) -> Json:
    """Return a mesh of a rigid foundation below a straight contact face: equal segments with two triangles each.

    Parameters:
        face: vertices of the face, (n, 2).
        normal: unit normal that points out of the body and into the foundation, (2,).
        segments: number of segments on the side that touches the body. The foundation extends beyond the face.

    Returns:
        Arrays ``vertices`` (v, 2), ``cells`` (c, 3) and ``facets``, the segments towards the body, (s, 2).
    """
    # The direction of the face and the inward normal are right-handed axes.
    along = np.array([-normal[1], normal[0]])
    s = face @ along
    length = np.ptp(s)
    origin = face[s.argmin()] - FOUNDATION_MARGIN * length * along
    steps = np.linspace(0, (1 + 2 * FOUNDATION_MARGIN) * length, segments + 1)
    near = origin + np.multiply.outer(steps, along)
    first = np.arange(segments)
    far = near + FOUNDATION_DEPTH * length * normal
    count = segments + 1
    lower = np.stack([first, first + 1, first + count + 1], axis=1)
    upper = np.stack([first, first + count + 1, first + count], axis=1)
    vertices = np.concatenate([near, far])
    cells = oriented(vertices.T, np.concatenate([lower, upper]).T).T
    return {"vertices": vertices, "cells": cells, "facets": np.stack([first, first + 1], axis=1)}


@dataclass(frozen=True)
class TaskStore(Store):
    """A directory with files of contact problems and their checksums.

    People copy this directory, so the lock file is removed at the end.
    """

    written: tuple[str, ...] = (".",)

    @property
    def lock(self) -> Path:
        return self.directory / ".lock"

    @property
    def marks(self) -> tuple[Path, ...]:
        return self.lock, self.directory / TASK_SUMS

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Lock the directory as ``Store.locked`` does, and remove the lock file at the end."""
        with super().locked():
            try:
                yield
            finally:
                # On Windows, an open file cannot be removed, so the lock file remains there.
                with suppress(PermissionError):
                    self.lock.unlink(missing_ok=True)


def write_task(directory: Path, data: Json) -> Path:
    """Write a contact problem into a file NAME.json.xz, and its checksum into SHA256SUMS; return the path.

    Equal data give identical files.

    Raises:
        StoreError: the directory cannot be written, or SHA256SUMS has a malformed line.
    """
    scale = "" if data["scale"] == 1 else f"-times-{data['scale']:g}"
    stem = "{case}-{family}-{mode}-{level}".format_map(data)
    path = directory / f"{stem}{scale}.json.xz"
    packed = lzma.compress(dumps(plain(data), separators=(",", ":")).encode())
    sums = {}
    listed = directory / TASK_SUMS
    for number, line in enumerate(listed.read_text(encoding="utf-8").splitlines() if listed.exists() else [], 1):
        if len(parts := line.split()) != 2:
            raise StoreError(
                f"{listed}, line {number}: found {line!r}, expected a checksum and a file: remove the line"
            )
        sums[parts[1]] = parts[0]
    sums[path.name] = sha256(packed).hexdigest()
    write_whole(path, lambda part: part.write_bytes(packed))
    write_text(listed, "".join(f"{sums[name]}  {name}\n" for name in sorted(sums)))
    return path


def plain(value: Any, digits: int = ARRAY_DIGITS) -> Any:
    """Return nested data for JSON: arrays become lists of rounded numbers.

    The largest number of an array is rounded to ``digits`` significant digits. All other numbers of the array have the
    same number of decimal places.

    Parameters:
        value: the data: dicts and lists of arrays and of values that JSON can write.
        digits: the number of digits for an array, or for arrays in a list. It has no effect on arrays in a dict, which
            get the number that ``FINER_ARRAYS`` has for their key, or else ``ARRAY_DIGITS``.
    """
    if isinstance(value, dict):
        return {key: plain(one, FINER_ARRAYS.get(key, ARRAY_DIGITS)) for key, one in value.items()}
    if isinstance(value, list):
        return [plain(one, digits) for one in value]
    if not isinstance(value, np.ndarray):
        return value
    largest = abs(value).max(initial=0.0)
    if value.dtype.kind == "f" and 0 < largest < inf:
        return np.round(value, digits - ceil(log10(largest))).tolist()
    return value.tolist()
