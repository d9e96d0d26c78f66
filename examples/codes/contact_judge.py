"""Judge a contact code on problems whose exact solutions are known. One file that needs NumPy alone: copy it.

    python contact_judge.py TASKS ANSWERS [--tolerance X] [--json] [--junit FILE]      errors, classes and causes
    python contact_judge.py --unpack TASKS DIR                                         the tasks as text files

TASKS is a directory of files *.json.xz in the format contact-task 2 or 1 (docs/reference/tasks.md). ANSWERS has for the
task NAME.json.xz a file NAME/u.txt: one line for each step, with the displacements u_x u_y (u_z) of vertex after
vertex, in the units of the task. Optional files beside it (pressure.txt, forces.txt, status.txt, resultant.txt) hold
what the code itself reports about contact. From Python, ``answer`` drives a code and ``assess`` judges it
(docs/how-to/verify-a-contact-code.md).

Exit codes: 0 every series passes, 1 one fails, 2 usage or input, 3 one is undecided.

Norms are ‖v‖_V = (A ε(v), ε(v))^½. The exact strain is known by its means ε̄ over the cells and by one number for each
step, ∫ A (ε − ε̄)·(ε − ε̄): the error of a function with strains constant on cells depends on nothing else.
"""

from __future__ import annotations

import argparse
import copy
import gzip
import hashlib
import json
import lzma
import math
import sys
import zlib
from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

EXACT = 1e-5
"""Distance from the solution in K^h, relative to the discretisation error, up to which a code is exact for P1: what
iterations are stopped at. A contact law that tends to the right one leaves more on meshes anybody uses."""
FALLS, LEAST_FALL = 0.5, 0.2
"""Order from which on a distance falls; with its negative it grows. Half of the order of the error: where the error has
the order 0.5, a distance falls from 0.25 on, and never below the second number."""
PRESSURE_FALLS = 2 / 3
"""Order from which on the error of the pressure falls, or that of the solution in K^h if it falls more slowly. A vertex
that is not held leaves an error on the size h of Γ3, whose norm in L² has the order ½, between .4 and .6 on shaken
meshes. The solution in K^h had .87 or more up to n = 32, but from one random mesh to the next, 32 to 64, down to .1."""
MESHES = 3
"""Meshes without which nothing is said of an order: on two, what falls fast hides what does not fall."""
NEGLIGIBLE = 0.01
"""Distance relative to the discretisation error up to which one that grows is not wrong: what is made of so little
(quadrature, iterations) need not fall in every step."""
NO_CONTACT = 0.9
"""Relative error of the pressure from which on a code is wrong: no contact at all has 1."""
OTHER_EQUATIONS, FEW_FORCES = 0.1, 1e-3
"""Part of the load that is left where no force may be, from which on a code is wrong (an elastic body of another
stiffness, say; methods of Nitsche's kind leave up to some hundredths), and from which on it is mentioned."""
LARGE_PRESSURE = 3
"""Times the error of K^h from which on the pressure of a consistent code is mentioned."""
NEXT_TO_NOTHING = 0.1
"""Part of the force that the solution in K^h has at a vertex, up to which the vertex is idle, and part of the largest
pressure from which on it is asked."""
NECESSARY = 0.15
"""Distance of an order from that of the solution in K^h that is still the same."""
AGREES = 1e-6
"""Relative difference up to which what a code reports agrees with its displacements: six digits in a text file."""
NAMED, HINTED = 1e-3, 0.05
"""Part of the residual that a cause may leave to be most likely, and to be a hint."""
EQUATIONS_HOLD, CONTACT_HOLDS = 1e-7, 1e-10
"""Forces relative to the load, where none may be, up to which the equations inside the body hold; and differences of
contact forces, relative to the largest, up to which no cause is looked for."""
ROUGH = 1.0
"""‖ε(v)‖ h / ‖v‖ from which on a difference v changes from vertex to vertex; π h for the smoothest on a unit square."""
LARGEST_SOLVE = 1500
"""Components of u up to which the judge solves the contact problem itself, to try causes in the contact algorithm."""
GOOD = EXACT_CLASS, CONSISTENT = "exact for P1", "consistent"
UNPACK = {".xz": lzma.decompress, ".gz": gzip.decompress}
VERSIONS = 1, 2
REPORTS = "pressure", "forces", "status", "resultant"


class TaskError(ValueError):
    """A task, an answer or an option cannot be used; the message says what was given and what was expected."""


class Task:
    """One problem on one mesh: static steps, one after the other, and what answers are judged by.

    Attributes:
        name: of the file.
        data: as it was read, arrays as lists.
        vertices, cells: (n, d), (cells, d + 1).
        stiffness: C of the static steps for every cell, Mandel, (cells, D, D): G, in a march A/k + G/2.
        clamped: numbers of the vertices at which u = 0.
        count: number of steps.

    Raises:
        TaskError: the data are no task, with the key that is missing or has another shape.
    """

    def __init__(self, name: str, data: dict) -> None:
        if not isinstance(data, dict):
            raise TaskError(f"{name} holds a JSON {type(data).__name__}, expected a task (an object); remove the file")
        if data.get("format") != "contact-task" or data.get("version") not in VERSIONS:
            given = f"{data.get('format')} {data.get('version')}"
            raise TaskError(f"{name} is {given}, expected contact-task 1 or 2; remove the file or export it again")
        self.name, self.data = name, data
        try:
            self._take(data)
            self._check()
        except KeyError as error:
            raise TaskError(f"{name} lacks the key {error}; export it again") from error
        except (AttributeError, IndexError, TypeError, ValueError) as error:
            raise TaskError(f"{name} is no task of contact-task {data['version']}: {error}") from error

    def _take(self, data: dict) -> None:
        self.vertices, self.cells = np.array(data["vertices"], float), np.array(data["cells"], int)
        self.clamped, self.scale = np.array(data["clamped"], int), float(data["scale"])
        self.marches, self.count = data["mode"] == "march", len(data["steps"])
        self.A, self.G = (self._tensor(data["law"][name]) for name in "AG")
        self.stiffness = self.A / data["step"] + self.G / 2 if self.marches else self.G
        corners = self.vertices[self.cells]
        edges = np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2)
        d = self.vertices.shape[1]
        self.volumes = np.linalg.det(edges) / (1, 1, 2, 6)[d]
        inverse = np.linalg.inv(edges)
        self.gradients = np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1)

    def _check(self) -> None:
        """ValueError, which says what is wrong, unless numbers are finite and shapes fit each other."""
        n, strains = self.vertices.shape, (len(self.cells), self.G.shape[1])
        steps, judge = self.data["steps"], self.data["judge"]
        if not (self.volumes > 0).all() or min(self.cells.min(), self.clamped.min(initial=0)) < 0:
            raise ValueError(f"cell {int(np.argmin(self.volumes))} has no positive volume, or a number is negative")
        if not self.count or len(judge) != self.count or not self.scale > 0:
            raise ValueError(f"{self.count} steps, {len(judge)} objects to judge them by, and the scale {self.scale}")
        wanted = [(steps, "load", n), (judge, "displacement", n), (judge, "reference", n), (judge, "strain", strains)]
        wanted += [
            (judge, "rest", ()),
            ([self.data], "start", n) if self.marches else (steps, "initial_stress", strains),
        ]
        for key, shape, values in (
            (key, shape, np.array(one[key], float)) for all_, key, shape in wanted for one in all_
        ):
            if values.shape != shape or not np.isfinite(values).all():
                raise ValueError(f"{key!r} has the shape {values.shape} or no finite numbers, expected {shape}")
        sizes = [len(vertices) for _, vertices, _ in self.pieces()]
        if not sizes or [len(gap) for gap in self.gaps()] != sizes or np.concatenate(self.gaps()).min() < 0:
            raise ValueError(f"'contact' needs pieces with as many gaps >= 0 as vertices, {sizes}")
        for one in judge:
            if [len(p) for p in one["pressure"]] != sizes or len(one["resultant"]) != len(sizes):
                raise ValueError(f"'pressure' and 'resultant' need one entry for each piece, of {sizes} vertices")

    @classmethod
    def read(cls, path: Path) -> Task:
        """Read a task from NAME.json.xz, NAME.json.gz or NAME.json."""
        path = Path(path)
        try:
            data = json.loads(UNPACK.get(path.suffix, bytes)(path.read_bytes()))
        except (OSError, EOFError, ValueError, lzma.LZMAError, zlib.error, RecursionError) as error:
            raise TaskError(f"{path} is no JSON: {error}") from error
        return cls(path.name.partition(".json")[0], data)

    @property
    def dim(self) -> int:
        """2 or 3."""
        return self.vertices.shape[1]

    def _tensor(self, constants: dict) -> np.ndarray:
        factor = np.broadcast_to(np.array(constants["factor"], float), len(self.cells))
        return factor[:, None, None] * np.array(constants["matrix"], float)

    def strain(self, u: np.ndarray) -> np.ndarray:
        """Return ε(u) on the cells, Mandel, (cells, D), from values at the vertices (n, d)."""
        gradient = np.einsum("cij,cik->cjk", u[self.cells], self.gradients)
        return np.stack([_weight(i, j) * (gradient[:, i, j] + gradient[:, j, i]) / 2 for i, j in pairs(self.dim)], 1)

    def internal(self, stress: np.ndarray) -> np.ndarray:
        """Return (σ, ε(φ_i e_j))_Q for stresses on the cells (cells, D), at the vertices (n, d)."""
        full = np.zeros((len(self.cells), self.dim, self.dim))
        for component, (i, j) in zip(stress.T, pairs(self.dim), strict=True):
            full[:, i, j] = full[:, j, i] = component / _weight(i, j)
        forces = np.einsum("c,cij,ckj->cki", self.volumes, full, self.gradients)
        total = np.zeros_like(self.vertices)
        np.add.at(total, self.cells, forces)
        return total

    def step(self, n: int, before: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (b, s_0) of step n: nodal forces (n, d) and initial stress (cells, D); ``before`` is u_{n−1}."""
        given = self.data["steps"][n]
        load = np.array(given["load"], float)
        if not self.marches:
            return load, np.array(given["initial_stress"], float)
        history = self.G / 2 - self.A / self.data["step"]
        return load, np.einsum("cij,cj->ci", history, self.strain(before))

    def start(self) -> np.ndarray:
        """Return u before the first step, (n, d); zero unless the task is a march."""
        return np.array(self.data["start"], float) if self.marches else np.zeros_like(self.vertices)

    def norm(self, strain: np.ndarray) -> float:
        """Return (Σ |T| A ε·ε)^½."""
        return float(np.sqrt(np.einsum("c,cij,ci,cj->", self.volumes, self.A, strain, strain)))

    def pieces(self) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Return ν (d,), the constrained vertices (m,) and Σ ∫ φ_i (m,) of each piece of contact."""
        result = []
        for piece in self.data["contact"]:
            facets, normal = np.array(piece["facets"], int), np.array(piece["normal"], float)
            mass = np.zeros(len(self.vertices))
            np.add.at(mass, facets, facet_sizes(self.vertices, facets)[:, None] / self.dim)
            vertices = np.array(piece["vertices"], int)
            result.append((normal, vertices, mass[vertices]))
        return result

    def constraints(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return vertex (m,), ν (m, d), Σ ∫ φ_i (m,) and gap over scale (m,) of all constraints, piece after piece."""
        pieces = self.pieces()
        normals = np.repeat([normal for normal, *_ in pieces], [len(vertices) for _, vertices, _ in pieces], axis=0)
        vertices, mass = (np.concatenate([piece[k] for piece in pieces]) for k in (1, 2))
        return vertices, normals, mass, np.concatenate(self.gaps()) / self.scale

    def distances(self, u: np.ndarray) -> np.ndarray:
        """Return u_ν − gap at the constraints, (steps, m), from displacements without the scale (steps, n, d)."""
        vertices, normals, _, gap = self.constraints()
        return np.einsum("smi,mi->sm", u[:, vertices], normals) - gap

    def exact_pressures(self) -> np.ndarray:
        """Return the exact pressure at the constraints, (steps, m)."""
        return np.array([np.concatenate([np.array(p, float) for p in one["pressure"]]) for one in self.data["judge"]])

    def sums(self, forces: np.ndarray) -> np.ndarray:
        """Return the sum of forces at the constraints (steps, m) over each piece, (steps, pieces)."""
        ends = np.cumsum([len(piece["vertices"]) for piece in self.data["contact"]])[:-1]
        return np.array([part.sum(axis=1) for part in np.split(forces, ends, axis=1)]).T

    def gaps(self) -> list[np.ndarray]:
        """Return the initial gap at the vertices of each piece (m,), in the units of the task; zero without ``gap``."""
        return [np.broadcast_to(np.array(p.get("gap", 0.0), float), len(p["vertices"])) for p in self.data["contact"]]

    def scaled(self, factor: float) -> Task:
        """Return the task with gaps times ``factor``, which belongs to loads times ``factor``."""
        other = copy.copy(self)
        pieces = zip(self.data["contact"], self.gaps(), strict=True)
        contact = [piece | {"gap": (factor * gap).tolist()} if gap.any() else piece for piece, gap in pieces]
        other.data = {**self.data, "contact": contact}
        return other


def pairs(dim: int) -> list[tuple[int, int]]:
    """Return the index pairs of Mandel components: 11, 22, 12 or 11, 22, 33, 23, 13, 12."""
    return [(0, 0), (1, 1), (0, 1)] if dim == 2 else [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]


def _weight(i: int, j: int) -> float:
    return 1.0 if i == j else float(np.sqrt(2))


def read_tasks(directory: Path) -> list[Task]:
    """Return all tasks of a directory; files are compared with SHA256SUMS if it is there.

    Raises:
        TaskError: there is no task, a file is no task, or SHA256SUMS has a bad line, a missing or a changed file.
    """
    directory = Path(directory)
    if not directory.is_dir():
        raise TaskError(f"{directory} is no directory, expected one that `study export` has written")
    if (directory / "SHA256SUMS").exists():
        _check_sums(directory)
    paths = sorted(directory.glob("*.json*"))
    if not paths:
        raise TaskError(f"{directory} holds no *.json.xz; write tasks there with `study export CASE --out {directory}`")
    tasks = [Task.read(path) for path in paths]
    for path, name in zip(paths[1:], (task.name for task in tasks), strict=False):
        if path.name.partition(".json")[0] == name:
            raise TaskError(f"two files of {directory} hold the task {name}; remove one of them")
    return tasks


def _check_sums(directory: Path) -> None:
    path = directory / "SHA256SUMS"
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, ValueError) as error:
        raise TaskError(f"{path} cannot be read: {error}; remove it or export the tasks again") from error
    for number, line in enumerate(lines, 1):
        parts = line.split(maxsplit=1)
        if len(parts) != 2:
            raise TaskError(f"{path}, line {number}: stands {line!r}, expected a sum and a file; remove the line")
        file = directory / parts[1].removeprefix("*")
        if not file.is_file():
            raise TaskError(f"{path} lists {file.name}, which is missing; copy it there again or remove line {number}")
        if hashlib.sha256(file.read_bytes()).hexdigest() != parts[0]:
            raise TaskError(f"{file.name} is not the file that SHA256SUMS stands for: export or copy it again")


def answer(task: Task, make: Callable, scale: float = 1.0) -> np.ndarray:
    """Return u of all steps (steps, n, d) by a code: make(task) ↦ step, step(b, s0) ↦ u; loads times ``scale``."""
    step, u, result = make(task.scaled(scale) if scale != 1 else task), scale * task.start(), []
    for n in range(task.count):
        load, stress = task.step(n, u)
        if not task.marches:
            stress = scale * stress
        u = np.asarray(step(scale * load, stress), float)
        result.append(u / scale)
    return np.array(result)


def write_answer(directory: Path, task: Task, u: np.ndarray, **reports: np.ndarray) -> None:
    """Write DIRECTORY/NAME/u.txt, and NAME/pressure.txt, forces.txt, status.txt, resultant.txt for ``reports``."""
    place = Path(directory) / task.name
    place.mkdir(parents=True, exist_ok=True)
    for name, values in {"u": u, **reports}.items():
        np.savetxt(place / f"{name}.txt", np.reshape(values, (len(u), -1)), fmt="%.17g")


def read_answer(directory: Path, task: Task) -> np.ndarray:
    """Return the displacements of an answer, (steps, n, d); TaskError if they cannot be read."""
    path = Path(directory) / task.name / "u.txt"
    return _numbers(path, task.count, task.vertices.size).reshape(task.count, *task.vertices.shape)


def read_reports(directory: Path, task: Task) -> dict[str, np.ndarray]:
    """Return what the code itself reports: name in ``REPORTS`` ↦ (steps, values), for the files that are there."""
    place, total = Path(directory) / task.name, sum(len(vertices) for _, vertices, _ in task.pieces())
    sizes = dict.fromkeys(REPORTS, total) | {"resultant": len(task.data["contact"])}
    there = {name: place / f"{name}.txt" for name in REPORTS if (place / f"{name}.txt").exists()}
    return {name: _numbers(path, task.count, sizes[name]) for name, path in there.items()}


def _numbers(path: Path, lines: int, columns: int) -> np.ndarray:
    try:
        values = np.loadtxt(path, ndmin=2)
    except (OSError, ValueError) as error:
        raise TaskError(f"there is no answer {path} that can be read: {error}") from error
    if values.size != lines * columns:
        raise TaskError(f"{path} has {values.size} numbers, expected {lines} lines of {columns}")
    return values.reshape(lines, columns)


@dataclass(frozen=True)
class Errors:
    """What one answer leaves on one mesh, the largest over the steps.

    Attributes:
        error: ‖u − u^h‖_V; ``best`` the same of the solution in K^h.
        discrete: ‖Π^h u − u^h‖_V.
        distance: from the solution in K^h, in V.
        pressure: ‖p − p^h‖ in L²(Γ3) over the largest ‖p‖, p^h from what balances the nodes; ``best_pressure`` of K^h.
        penetration: largest u_ν − gap on Γ3 over the largest |u|. With linear elements and flat faces it is as large
            at vertices as between them.
        resultant: largest |∫ p − Σ λ_i| over the largest ∫ p.
        tangential: largest force on Γ3 along it, and on nodes off Γ3 at all, over the largest load: other equations.
        idle: vertices on which the solution in K^h presses and this one does not, over all steps together.
        shift: (a |Ω|)^½ / L times the largest |u| on Γ1, a the mean of tr A / D and L the diameter of the body: with it
            the distance sees rigid motions, which have no strain.
        on_clamp: largest |u| on Γ1 over the largest |u| of the solution in K^h.
        at_vertices: largest |u − u^h| at a vertex, exact u, over the largest |u|; ``from_best`` from the K^h solution.
    """

    error: float
    best: float
    discrete: float
    distance: float
    pressure: float
    best_pressure: float
    penetration: float
    resultant: float
    tangential: float
    idle: tuple[int, ...] = ()
    shift: float = 0.0
    on_clamp: float = 0.0
    at_vertices: float = 0.0
    from_best: float = 0.0

    @property
    def share(self) -> float:
        """Distance from the solution in K^h, strains and values on Γ1, over the discretisation error."""
        return float(np.hypot(self.distance, self.shift) / self.best)


def measure(task: Task, u: np.ndarray) -> Errors:
    """Judge the answer to one task, (steps, n, d)."""
    if not np.isfinite(u).all():
        best = measure(task, task.scale * references(task)).best
        return Errors(np.inf, best, *[np.inf] * 7, shift=np.inf, on_clamp=np.inf, at_vertices=np.inf, from_best=np.inf)
    mine, best = (Equations(task, v) for v in (u / task.scale, references(task)))
    rows = np.array([_in_v(task, one, v) for one, v in zip(task.data["judge"], mine.u, strict=True)])
    values = np.max(rows, axis=0)
    pressure, *others = _contact(mine)
    numbers = (*values[:4], pressure, _contact(best)[0], *others)
    return Errors(*map(float, numbers), idle(mine, best), *map(float, values[4:]))


def references(task: Task) -> np.ndarray:
    """Return the solutions in K^h of all steps, (steps, n, d), for loads that are not scaled."""
    return np.array([one["reference"] for one in task.data["judge"]], float)


def _in_v(task: Task, exact: dict, u: np.ndarray) -> list[float]:
    """Return ‖u − u^h‖, the same for K^h, ‖Π^h u − u^h‖, the distance, and the differences of vertex values."""
    means, reference = np.array(exact["strain"], float), np.array(exact["reference"], float)
    interpolant = np.array(exact["displacement"], float)
    to_means = [task.norm(means - task.strain(v)) for v in (u, reference)]
    nodes = [task.norm(task.strain(v - u)) for v in (interpolant, reference)]
    largest = max(abs(references(task)).max(), 1e-300)
    values = [abs(v).max(initial=0) / largest for v in (u[task.clamped], u - interpolant, u - reference)]
    a = np.trace(task.A, axis1=1, axis2=2).mean() / task.A.shape[1]
    shift = np.sqrt(a * task.volumes.sum()) / np.linalg.norm(np.ptp(task.vertices, axis=0)) * largest * values[0]
    return [*np.sqrt(exact["rest"] + np.square(to_means)), *nodes, float(shift), *values]


def _contact(equations: Equations) -> list[float]:
    """Return pressure error, penetration, error of the resultant, forces out of balance; all relative."""
    task, lam, mass = equations.task, equations.lam, equations.task.constraints()[2]
    p, total = task.exact_pressures(), np.array([one["resultant"] for one in task.data["judge"]], float)
    on_clamp = [
        equations.u[:, np.setdiff1d(np.array(piece["facets"], int), vertices)] @ normal
        for piece, (normal, vertices, _) in zip(task.data["contact"], task.pieces(), strict=True)
    ]
    deepest = max(0.0, equations.gap.max(), *(gap.max(initial=0) for gap in on_clamp))
    errors = np.sqrt((lam / mass - p) ** 2 @ mass).max(), deepest, abs(task.sums(lam) - total).max()
    sizes = np.sqrt(p**2 @ mass).max(), abs(equations.u).max(), abs(total).max()
    return [float(a / max(b, 1e-300)) for a, b in zip(errors, sizes, strict=True)] + [equations.size(equations.total)]


def idle(mine: Equations, best: Equations) -> tuple[int, ...]:
    """Return the vertices that the solution in K^h presses, over all steps, and the answer next to nothing."""
    vertices, _, mass, _ = best.task.constraints()
    pressed, wanted = mine.lam.sum(axis=0), best.lam.sum(axis=0)
    asked = (wanted / mass >= NEXT_TO_NOTHING * (wanted / mass).max()) & (wanted.max() > 0)
    return tuple(sorted(set(vertices[asked & (pressed <= NEXT_TO_NOTHING * wanted)].tolist())))


def tested(task: Task) -> tuple[int, int, int]:
    """Return how many constraints are in contact at some step, how many are free at some step, and their number."""
    u = np.array([one["displacement"] for one in task.data["judge"]], float)
    free = task.distances(u) < -1e-9 * abs(u).max()
    p = task.exact_pressures()
    return int((p > 0).any(axis=0).sum()), int(free.any(axis=0).sum()), p.shape[1]


@dataclass(frozen=True)
class Report:
    """Judgement of what a code itself reports: its name, whether it is right, and a sentence."""

    name: str
    right: bool
    sentence: str


def judge_reports(task: Task, u: np.ndarray, reports: dict[str, np.ndarray]) -> list[Report]:
    """Judge reported pressures, nodal forces, contact status and resultants of one task.

    Args:
        task: the task.
        u: the displacements of the same answer, (steps, n, d).
        reports: names in ``REPORTS`` ↦ values (steps, m), m the vertices of all pieces, or the pieces for resultants.

    Each is compared with the nodal forces that balance u; a pressure passes as well if its error is at most
    ``LARGE_PRESSURE`` times that of these forces, since there are several ways to recover a pressure.
    """
    if unknown := set(reports) - set(REPORTS):
        raise TaskError(f"unknown report {', '.join(sorted(unknown))}, expected {', '.join(REPORTS)}")
    if not reports or not np.isfinite(u).all():
        return []
    equations, result = Equations(task, u / task.scale), []
    lam, mass = equations.lam, task.constraints()[2]
    for name, wanted in (("forces", lam), ("pressure", lam / mass), ("resultant", task.sums(lam))):
        if name in reports:
            mine = np.reshape(reports[name], wanted.shape) / task.scale
            result.append(Report(name, *_compare(task, name, mine, wanted)))
    if "status" in reports:
        status, vertices = np.reshape(reports["status"], lam.shape) != 0, task.constraints()[0]
        missed = ~status & (lam > AGREES * abs(lam).max())
        invented = status & (equations.gap < -AGREES * abs(equations.u).max())
        faults = []
        for wrong, words in ((missed, "no contact where a force acts"), (invented, "contact where a gap is open")):
            for step, row in np.argwhere(wrong)[:1]:
                faults.append(f"{words}, {wrong.sum()} times, first in step {step + 1} at vertex {vertices[row]}")
        sentence = "; ".join(faults) or "agrees with forces and gaps"
        result.append(Report("status", not faults, f"reported status: {sentence}"))
    return result


def _compare(task: Task, name: str, mine: np.ndarray, wanted: np.ndarray) -> tuple[bool, str]:
    """Return whether a report agrees with the balance of u, and the sentence with the simple mistake that fits."""
    largest, mass = max(abs(wanted).max(), 1e-300), task.constraints()[2]
    if not np.isfinite(mine).all():
        return False, f"reported {name}: not all are numbers"
    apart = abs(mine - wanted).max() / largest
    if apart <= AGREES:
        return True, f"reported {name}: agrees with what balances the displacements, up to {apart:.0e}"
    mistakes = [("has the reversed sign", -wanted), ("is that of the step before", np.roll(wanted, 1, axis=0))]
    factor = float((mine * wanted).sum() / max((wanted**2).sum(), 1e-300))
    mistakes.append((f"is {factor:.4g} times the right one", factor * wanted))
    if name != "resultant":
        ends = np.where(mass < 0.75 * np.median(mass), 0.5, 1.0)
        mistakes.append(("takes full areas at the ends of the face, where half are right", wanted * ends))
        mistakes.append(("takes half areas at the ends of the face twice", wanted / ends))
        other = ("is a force, expected force over area", wanted * mass)
        mistakes.append(other if name == "pressure" else ("is a pressure, expected pressure times area", wanted / mass))
    if name == "pressure":
        errors = [np.sqrt((p - task.exact_pressures()) ** 2 @ mass).max() for p in (mine, wanted)]
        if errors[0] <= LARGE_PRESSURE * errors[1]:
            return (
                True,
                f"reported {name}: {errors[0] / errors[1]:.2g} times the error of what balances the displacements",
            )
    best, text = min((abs(mine - guess).max() / largest, text) for text, guess in mistakes)
    cause = f"; it {text} (difference {best:.0e} with this)" if best <= NAMED * apart else ""
    return False, f"reported {name}: differs by {apart:.2g} from what balances the displacements{cause}"


@dataclass(frozen=True)
class Cause:
    """A cause that was tried: residuals with it and without it, relative. Keys ``group:variant`` name equal causes."""

    key: str
    sentence: str
    residual: float
    without: float

    @property
    def rank(self) -> float:
        """Part of the residual that is left; infinite where that is no number."""
        return self.residual / self.without if self.residual < np.inf and self.without > 0 else np.inf


def diagnose(tasks: list[Task], answers: list[np.ndarray]) -> str:
    """Return the most likely cause of a difference from the solutions in K^h as a sentence; "" if there is none.

    Args:
        tasks: tasks whose answers differ, from coarse to fine; the first two are used.
        answers: their answers, (steps, n, d).

    Causes are tried one by one: the equations inside the body with one term changed, then the contact algorithm with
    one part changed. A cause is named if it leaves at most ``NAMED`` of the residual on both meshes; causes that
    explain the answers equally well are all named, except factors without a meaning next to those with one.
    """
    task, u = tasks[0], answers[0]
    for one, values in zip(tasks, answers, strict=True):
        if not np.isfinite(values).all():
            step = int(np.argmin(np.isfinite(values).all(axis=(1, 2))))
            return (
                f"The answer to {one.name} is not a number in step {step + 1} of {one.count}: the solver failed there"
            )
    exact, u = references(task), u / task.scale
    if moved := _rigid_motion(task, u, exact):
        return moved
    equations = Equations(task, u)
    causes = {cause.key: cause for cause in _tried(equations)}
    if len(tasks) > 1:
        again = {cause.key: cause for cause in _tried(Equations(tasks[1], answers[1] / tasks[1].scale))}
        same = [(cause, again.get(key)) for key, cause in causes.items()]
        causes = {one.key: max(one, two or one, key=lambda c: c.rank) for one, two in same if two or not again}
    if named := _name(list(causes.values())):
        return named
    if digits := _few_digits(answers[0]):
        return f"Perhaps: {digits}, so that displacements differ by {abs(u - exact).max() / abs(exact).max():.0e}"
    return _solver_tolerance(equations, exact) or _unexplained(list(causes.values()), equations)


def _tried(equations: Equations) -> Iterator[Cause]:
    if equations.size(equations.total) <= EQUATIONS_HOLD:
        return contact_causes(equations)
    return equations.tilted() if equations.only_on_contact() else equations.causes()


def _name(causes: list[Cause]) -> str:
    """Return the sentence that names the best of some causes, and those that are as good."""
    first = min(causes, key=lambda cause: cause.rank, default=None)
    if not first or first.rank > HINTED:
        return ""
    equal = [one for one in causes if one.residual <= max(10 * first.residual, 1e-9) and one.rank <= HINTED]
    equal = [one for one in equal if ODD not in one.sentence] or equal
    groups = {one.key.partition(":")[0]: one.sentence for one in reversed(equal)}
    names, certain = list(reversed(groups.values()))[:3], first.rank <= NAMED
    numbers = f"(residual {first.residual:.0e} with it, {first.without:.2g} without)"
    if len(names) > 1:
        head = "Equally likely, another case tells them apart" if certain else "Perhaps one of these"
        return f"{head}: {'; or '.join(names)} {numbers}"
    return f"{'Most likely' if certain else 'Perhaps'}: {names[0]} {numbers}"


def _unexplained(causes: list[Cause], equations: Equations) -> str:
    """Return where forces are left, if no cause explains them."""
    none, size = "No single cause that was tried explains it", equations.size(equations.total)
    if size <= EQUATIONS_HOLD:
        return f"{none}: the equations inside the body hold, so look at the contact algorithm"
    place = "along the contact face" if equations.only_on_contact() else "inside the body or on other faces"
    return f"{none}: forces of {size:.2g} of the load are left {place}"


def _few_digits(u: np.ndarray) -> str:
    """Return what shows that the numbers of an answer have few digits; "" if they have not."""
    if (u == u.astype(np.float32)).all():
        return "the answer has single precision"
    sample = u.ravel()[:: max(1, u.size // 300)]
    few = (n for n in range(2, 9) if all(float(f"{x:.{n}g}") == x for x in sample))
    return "".join(f"the answer is written with {n} digits" for n in list(few)[:1])


def _rigid_motion(task: Task, u: np.ndarray, exact: np.ndarray) -> str:
    """Return the cause where u on Γ1 is not zero: a rigid motion of the body, or vertices that are not held."""
    largest = abs(exact).max()
    on_clamp = abs(u[:, task.clamped]).max(axis=(0, 2)) / largest
    if on_clamp.max() <= AGREES:
        return ""
    modes = [np.tile(e, (len(u[0]), 1)) for e in np.eye(task.dim)]
    for i, j in pairs(task.dim)[task.dim :]:
        turned = np.zeros_like(task.vertices)
        turned[:, i], turned[:, j] = -task.vertices[:, j], task.vertices[:, i]
        modes.append(turned)
    columns = np.array([mode[task.clamped].ravel() for mode in modes]).T
    fits = [np.linalg.lstsq(columns, v[task.clamped].ravel(), rcond=None)[0] for v in u]
    motion = np.array([np.tensordot(fit, modes, 1) for fit in fits])
    apart, without = (abs(v - exact).max() / largest for v in (u - motion, u))
    fit = max(fits, key=lambda one: abs(one).max())
    by = f"by ({', '.join(f'{x:.3g}' for x in fit[: task.dim])})"
    turn = f" and turned by {abs(fit[task.dim :]).max():.3g}" if abs(fit[task.dim :]).max() > 1e-9 * largest else ""
    named = _name([Cause("rigid", f"the body is moved rigidly {by}{turn}", apart, without)])
    free = task.clamped[on_clamp > AGREES]
    held = f"u is up to {on_clamp.max():.2g} of the largest displacement on Γ1, where it must be 0"
    return f"{named}; {held}" if named else f"{held} ({len(free)} vertices, first {free[0]})"


class Equations:
    """Forces that an answer leaves where none may be, split into the terms of the equations.

    Attributes:
        task, u: the task and the displacements (steps, n, d), loads not scaled; ``before`` are those of the last step.
        full: forces out of balance (steps, n, d); ``total`` is zero on Γ1 and without what contact faces may carry.
        lam, gap: nodal contact forces λ, least squares where faces meet, and u_ν − gap, (steps, m).
    """

    def __init__(self, task: Task, u: np.ndarray) -> None:
        self.task, self.u, self.before = task, u, self._before(task, u)
        self.strain, self.strain_before = self._strains(u), self._strains(self.before)
        self.load = np.array([np.array(one["load"], float) for one in task.data["steps"]]) / task.scale
        self.history = 0 * task.G
        if task.marches:
            self.k = float(task.data["step"])
            self.history = task.G / 2 - task.A / self.k
            self.stress = _times(self.history, self.strain_before)
        else:
            self.stress = np.array([one["initial_stress"] for one in task.data["steps"]], float) / task.scale
        vertices, normals, _, _ = task.constraints()
        self.on_contact, row = np.unique(vertices, return_inverse=True)
        self.project = np.zeros((len(self.on_contact), task.dim, task.dim))
        self.carry = np.zeros_like(normals)
        for k in range(len(self.on_contact)):
            inverse = np.linalg.pinv(normals[row == k])
            self.carry[row == k], self.project[k] = inverse.T, np.eye(task.dim) - inverse @ normals[row == k]
        self.largest = max(abs(self.load).max(), 1e-300)
        self.initial = self.internal(self.stress)
        self.full = self.forces()
        self.total = self.left(self.full)
        self.lam, self.gap = np.einsum("smi,mi->sm", self.full[:, vertices], self.carry), task.distances(u)

    @staticmethod
    def _before(task: Task, u: np.ndarray) -> np.ndarray:
        return np.concatenate([task.start()[None] / task.scale, u[:-1]]) if task.marches else 0 * u

    def _strains(self, u: np.ndarray) -> np.ndarray:
        return np.array([self.task.strain(v) for v in u])

    def internal(self, stress: np.ndarray) -> np.ndarray:
        """Return the forces of stresses (steps, cells, D), (steps, n, d)."""
        return np.array([self.task.internal(one) for one in stress])

    def forces(self, C: Any = None, H: Any = None, u: Any = None, before: Any = None, stress: Any = None) -> np.ndarray:
        """Return the forces out of balance (steps, n, d), with what is given in place of the right quantities.

        C is the stiffness, H the factor of the old strain, u and before the displacements, stress the initial stress.
        """
        if u is not None and before is None and self.task.marches:
            before = self._before(self.task, u)
        strain = self.strain if u is None else self._strains(u)
        if stress is None:
            old = self.strain_before if before is None else self._strains(before)
            changed = self.task.marches and (H is not None or before is not None)
            stress = _times(self.history if H is None else H, old) if changed else self.stress
        return self.load - self.internal(_times(self.task.stiffness if C is None else C, strain) + stress)

    def left(self, forces: np.ndarray) -> np.ndarray:
        """Return forces (steps, n, d) without those that Γ1 and the contact faces may carry."""
        result, at = forces.copy(), self.on_contact
        result[:, self.task.clamped] = 0
        result[:, at] = np.einsum("kij,skj->ski", self.project, result[:, at])
        return result

    def size(self, left: np.ndarray) -> float:
        """Return the largest force over the largest load."""
        return float(abs(left).max() / self.largest)

    def only_on_contact(self) -> bool:
        """Return whether forces are left along the contact faces alone."""
        inside = self.total.copy()
        inside[:, self.on_contact] = 0
        return self.size(inside) <= max(EQUATIONS_HOLD, 1e-4 * self.size(self.total))

    def causes(self) -> Iterator[Cause]:
        """Yield every cause inside the body with its residual."""
        without, count = self.size(self.total), self.task.count
        for key, sentence, changed in (*self._other_loads(), *self._other_laws(), *self._other_displacements()):
            forces = changed if isinstance(changed, np.ndarray) else self.forces(**changed)
            yield Cause(key, sentence, self.size(self.left(forces)), without)
        for key, words, forces in self._terms():
            yield self._multiplied(key, words, forces, slice(None))
        bad = np.flatnonzero(abs(self.total).max(axis=(1, 2)) > 1e-3 * abs(self.total).max())
        if len(bad) == 1 and count > 1:
            yield from self._in_one_step(int(bad[0]))
        if count > 1:
            late = self.left(self.forces(u=np.roll(self.u, -1, axis=0)))[:-1]
            yield Cause("late", "the displacements of the step before are written", self.size(late), without)

    def _multiplied(self, key: str, words: str, forces: np.ndarray, steps: slice) -> Cause:
        """Return the cause that one term, ``forces`` in the balance, is multiplied by the factor that fits best."""
        term = np.zeros_like(self.total)
        term[steps] = self.left(forces)[steps]
        norm = float((term**2).sum())
        factor = 1 - float((self.total * term).sum()) / norm if norm > 0 else 1.0
        sentence = f"{words} {factor_words(factor)}"
        if key == "units":
            sentence = f"the displacements are {1 / (factor or 1e-300):.4g} times the right ones (other units?){words}"
        return Cause(key, sentence, self.size(self.total + (factor - 1) * term), self.size(self.total))

    def _terms(self) -> Iterator[tuple[str, str, np.ndarray]]:
        """Yield the terms that may be multiplied by a factor, as they stand in the balance."""
        task, C, D = self.task, self.task.stiffness, self.task.G.shape[1]
        old = "the stress of the previous step" if task.marches else "the initial stress"
        shear = np.arange(D) >= task.dim
        elastic = -self.internal(_times(C, self.strain))
        yield "stress", old, -self.initial
        yield "load", "the load", self.load
        yield "stress shear", f"the shear part of {old}", -self.internal(self.stress * shear)
        if task.marches:
            yield "units", "", elastic - self.initial
            yield "stiffness", "the stiffness A/k + G/2", elastic
            rate, mean = self.strain - self.strain_before, (self.strain + self.strain_before) / 2
            yield "viscous", "the viscous stress A ε(u̇) (or 1/k)", -self.internal(_times(task.A / self.k, rate))
            yield "elastic", "the elastic stress G ε(u)", -self.internal(_times(task.G, mean))
            for name, H in (("viscous", -task.A / self.k), ("elastic", task.G / 2)):
                yield f"{name} history", f"the {name} part of {old}", -self.internal(_times(H, self.strain_before))
        else:
            yield "units", ", or the stiffness is too small by this factor", elastic
            yield "traction", "the traction on Γ2, whose work the load contains already,", self._traction()
        voigt = "the shear part of the stiffness (√2 of Mandel's or γ = 2ε of Voigt's components)"
        yield "shear:rows", voigt, -self.internal(_times(C, self.strain) * shear)
        yield "shear:columns", voigt, -self.internal(_times(C, self.strain * shear))
        for i, j in np.argwhere(np.triu(abs(C).max(axis=0) > 0)):
            entry = np.zeros_like(C)
            entry[:, i, j], entry[:, j, i] = C[:, i, j], C[:, j, i]
            words = f"the entry C_{i + 1}{j + 1} of the stiffness (Mandel)"
            group = f"shear:{i}{j}" if i == j >= task.dim else f"entry {i}{j}"
            yield group, voigt if i == j >= task.dim else words, -self.internal(_times(entry, self.strain))

    def _traction(self) -> np.ndarray:
        """Return the work of the tractions on Γ2 at the vertices, zero where a task has none."""
        task, result = self.task, np.zeros_like(self.load)
        for n, step in enumerate(task.data["steps"]):
            for part, values in zip(task.data.get("loaded", ()), step.get("traction", ()), strict=False):
                facets, t = np.array(part["facets"], int), np.array(values, float) / task.scale
                share = facet_sizes(task.vertices, facets) / task.dim / (task.dim + 1)
                np.add.at(result[n], facets, (t + t.sum(axis=1, keepdims=True)) * share[:, None, None])
        return result

    def _shifted(self, values: np.ndarray, by: int) -> np.ndarray:
        """Return the values of the step ``by`` steps earlier, of the first or last step at the ends."""
        return values[np.clip(np.arange(len(values)) - by, 0, len(values) - 1)]

    def _other_loads(self) -> Iterator[tuple[str, str, Any]]:
        """Yield loads and initial stresses of another step or with other axes."""
        for by, words in ((1, "of the step before"), (-1, "of the next step")):
            yield f"load {by}", f"the load {words} is used", self.full - self.load + self._shifted(self.load, by)
            if not self.task.marches:
                stress = self._shifted(self.stress, by)
                yield f"stress {by}", f"the initial stress {words} is used", {"stress": stress}
        if self.task.marches:
            older = np.concatenate([self.before[:1], self.before[:-1]])
            yield "u_{n-2}", "the history is that of the step before last, u_{n-2}", {"before": older}

    def _other_laws(self) -> Iterator[tuple[str, str, dict]]:
        """Yield other stiffnesses C, factors H of the old strain, and exchanged axes."""
        task = self.task
        A, G, C, D = task.A, task.G, task.stiffness, task.G.shape[1]
        plain = {name: np.broadcast_to(np.array(task.data["law"][name]["matrix"], float), C.shape) for name in "AG"}
        a, g = plain["A"], plain["G"]
        if task.marches:
            k, place = self.k, "in place of the midpoint rule"
            yield "scheme", f"backward Euler is used {place}", {"C": A / k + G, "H": -A / k}
            yield "explicit", f"the elastic stress is taken at the old time {place}", {"C": A / k, "H": G - A / k}
            yield "elastic law", "the viscous stress is missing: σ = G ε(u)", {"C": G, "H": 0 * G}
            yield "viscous law", "the elastic stress is missing: σ = A ε(u̇)", {"C": A / k, "H": -A / k}
            yield "A and G", "A and G are exchanged", {"C": G / k + A / 2, "H": A / 2 - G / k}
            for words, other in (("A/k", A / k), ("G", G), ("A/k + G", A / k + G)):
                yield f"C = {words}", f"{words} is used for A/k + G/2", {"C": other}
            yield "factor:C", "`factor` of the law is forgotten", {"C": a / k + g / 2}
            yield "factor:both", "`factor` of the law is forgotten", {"C": a / k + g / 2, "H": g / 2 - a / k}
        else:
            yield "A for G", "A is used in place of G", {"C": A}
            yield "A + G", "A + G is used in place of G", {"C": A + G}
            yield "factor", "`factor` of the law is forgotten", {"C": g}
        if task.dim == 2:
            for i, other in enumerate(_plane_stress(C)):
                yield f"plane stress:{i}", "plane stress is used in place of plane strain", {"C": other}
        for i, by in enumerate((np.sqrt(2), np.sqrt(0.5), 2.0, 0.5)):
            w = np.where(np.arange(D) < task.dim, 1.0, by)
            words = f"rows and columns of shear in the stiffness are multiplied by {by:.4g} (Voigt for Mandel?)"
            yield f"shear:both {i}", words, {"C": C * np.multiply.outer(w, w)}
        for i, j in pairs(task.dim)[task.dim :]:
            order = _exchanged(i, j, task.dim)
            name = f"axes {i + 1} and {j + 1} are exchanged in the"
            yield f"axes:{i}{j}", f"{name} stiffness", {"C": C[:, order][:, :, order]}
            yield f"axes of stress:{i}{j}", f"{name} initial stress or history", {"stress": self.stress[..., order]}

    def _other_displacements(self) -> Iterator[tuple[str, str, dict]]:
        """Yield the displacements that the answer may stand for."""
        task, u = self.task, self.u
        swapped = u[..., [1, 0, 2][: task.dim]]
        by_axis = u.reshape(task.count, task.dim, -1).swapaxes(1, 2)
        yield "components", "u_x and u_y are exchanged in the answer", {"u": swapped}
        yield "order", "the answer has all u_x before all u_y, expected vertex after vertex", {"u": by_axis}
        deformed = u - task.vertices / task.scale
        yield "places", "the answer has deformed coordinates, expected displacements", {"u": deformed}
        yield "numbers", "the answer begins with the last vertex, or skips one", {"u": np.roll(u, -1, axis=1)}
        if task.count > 1:
            yield "increments", "the answer has increments, expected totals", {"u": np.cumsum(u, axis=0)}
        if task.marches:
            whole = [task.start() / task.scale]
            for middle in u:
                whole.append(2 * middle - whole[-1])
            sentence = "u at the middle of the step is written, expected u at its end"
            yield "middle", sentence, {"u": np.array(whole[1:])}

    def _in_one_step(self, n: int) -> Iterator[Cause]:
        """Yield causes that act in step n alone, the only one whose equations do not hold."""
        at, old = f"in step {n + 1} alone", "the stress of the previous step"
        if n == 0 and self.task.marches:
            at, old = "in the first step", "the stress of `start`"
        yield self._multiplied(
            "stress once", f"{at} {old if self.task.marches else 'the initial stress'}", -self.initial, slice(n, n + 1)
        )
        yield self._multiplied("load once", f"{at} the load", self.load, slice(n, n + 1))
        if n and self.task.marches:
            before = self.before.copy()
            before[n] = self.before[n - 1]
            sentence = f"{at} the history is that of the step before last (a repeated or failed step?)"
            yield Cause(
                "u_{n-2} once", sentence, self.size(self.left(self.forces(before=before))), self.size(self.total)
            )

    def tilted(self) -> Iterator[Cause]:
        """Yield causes of forces along the contact face: friction, or normals that are tilted at some vertices."""
        at, along = self.on_contact, abs(self.total[:, self.on_contact]).max(axis=2)
        wrong = np.flatnonzero(along.max(axis=0) > 1e-4 * along.max())
        left, angles, axis = 0.0, [], np.zeros(self.task.dim)
        for k in wrong:
            forces = self.full[:, at[k]]
            direction = np.linalg.svd(forces)[2][0]
            left = max(left, abs(forces - np.outer(forces @ direction, direction)).max())
            cosine = np.linalg.norm(direction - self.project[k] @ direction)
            angles.append(float(np.arccos(min(cosine, 1.0))))
            axis = direction
        named = f"vertices {', '.join(map(str, at[wrong][:5]))}"
        sentence = (
            f"the normal at {named} is tilted by {max(angles):.3g}: contact acts along ±({axis[0]:.3g}, {axis[1]:.3g})"
        )
        if len(wrong) > 1:
            sentence = f"friction, or normals tilted by {min(angles):.3g} to {max(angles):.3g} at {named}"
        pressed = (along[:, wrong] > 1e-6 * along.max()).sum(axis=0).max(initial=0)
        if pressed > 1:
            yield Cause("tilt", sentence, left / self.largest, self.size(self.total))


def facet_sizes(vertices: np.ndarray, facets: np.ndarray) -> np.ndarray:
    """Return lengths or areas of facets, (facets,)."""
    edges = vertices[facets[:, 1:]] - vertices[facets[:, :1]]
    return np.sqrt(np.linalg.det(edges @ np.swapaxes(edges, 1, 2))) / (1, 1, 2)[facets.shape[1] - 1]


def _times(C: np.ndarray, strain: np.ndarray) -> np.ndarray:
    return np.einsum("cij,scj->sci", C, strain)


def _exchanged(a: int, b: int, dim: int) -> list[int]:
    """Return the order of Mandel components after the axes a and b are exchanged."""
    new, of = {a: b, b: a}, {frozenset(pair): k for k, pair in enumerate(pairs(dim))}
    return [of[frozenset((new.get(i, i), new.get(j, j)))] for i, j in pairs(dim)]


def _plane_stress(C: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return matrices of plane stress: from μ and λ of plane strain, and with σ_33 eliminated by the coupling C_12."""
    mu, lam = C[:, 2, 2] / 2, C[:, 0, 1]
    isotropic, reduced, less = C.copy(), C.copy(), lam**2 / (lam + 2 * mu)
    isotropic[:, 0, 1] = isotropic[:, 1, 0] = lam - less
    isotropic[:, 0, 0] = isotropic[:, 1, 1] = 2 * mu + lam - less
    reduced[:, :2, :2] -= less[:, None, None]
    return isotropic, reduced


ODD = "is multiplied by the factor"


def factor_words(factor: float) -> str:
    """Return what a factor means: 0 is missing, −1 has the reversed sign."""
    known = {0.0: "is missing", -1.0: "has the reversed sign", 2.0: "is counted twice", 0.5: "is halved"}
    known |= {np.sqrt(2): "is multiplied by √2", np.sqrt(0.5): "is divided by √2"}
    return next((words for value, words in known.items() if abs(factor - value) < 1e-4), f"{ODD} {factor:.4g}")


def _solver_tolerance(equations: Equations, exact: np.ndarray) -> str:
    """Return that the solver stopped early where a small difference has no structure in space; "" otherwise."""
    task, apart = equations.task, equations.u - exact
    size, left = abs(apart).max() / abs(exact).max(), equations.size(equations.total)
    if size > 0.01 or left <= EQUATIONS_HOLD or equations.only_on_contact():
        return ""
    share = np.bincount(task.cells.ravel(), np.repeat(task.volumes / (task.dim + 1), task.dim + 1))
    a = np.trace(task.A, axis1=1, axis2=2).mean() / task.A.shape[1]
    values = max(np.sqrt(a * (share @ (v**2).sum(axis=1))) for v in apart)
    rough = max(task.norm(task.strain(v)) for v in apart) / max(values, 1e-300) * task.data["h"]
    numbers = f"displacements differ by {size:.0e} of the largest, forces of {left:.0e} of the load are left everywhere"
    if rough > ROUGH:
        return (
            f"Most likely: the solver stops too early, its tolerance is too large: {numbers}, without pattern in space"
        )
    return f"Perhaps: the solver stops too early: {numbers}" if left < 0.01 else ""


class ContactProblem:
    """The contact problem of an answer, reduced to the contact faces: gap = free − W λ, from the answer's history.

    Attributes:
        lam, gap: λ and u_ν − gap of the answer at the constraints, (steps, m), loads not scaled.
        free: u_ν − gap without any contact force, (steps, m); ``W`` the compliance (m, m).
        right: λ of the right solution, (steps, m).
    """

    def __init__(self, equations: Equations) -> None:
        self.task = task = equations.task
        self.vertices, normals, self.mass, self.initial = task.constraints()
        d, n, m = task.dim, task.vertices.size, len(self.vertices)
        N = np.zeros((m, n))
        N[np.arange(m)[:, None], d * self.vertices[:, None] + np.arange(d)] = normals
        self.lam, self.gap = equations.lam, equations.gap
        unknown = np.setdiff1d(np.arange(n), np.add.outer(d * task.clamped, np.arange(d)))
        forces = (equations.load - equations.initial).reshape(task.count, -1)
        K = _dense_stiffness(task)[np.ix_(unknown, unknown)]
        solved = np.linalg.solve(K, np.concatenate([N[:, unknown].T, forces[:, unknown].T], axis=1))
        self.W, self.free = N[:, unknown] @ solved[:, :m], (N[:, unknown] @ solved[:, m:]).T - self.initial
        self.right = self.each()
        self.largest = max(abs(self.right).max(), abs(self.lam).max(), 1e-300)
        self.pressed = self.lam > 1e-9 * self.largest

    def each(self, free: Any = None, starts: Any = None, **options: Any) -> np.ndarray:
        """Return λ of all steps, (steps, m), by ``active_set`` with its options and one start for each step."""
        free = self.free if free is None else free
        starts = [None] * len(free) if starts is None else starts
        return np.array([active_set(self.W, one, start, **options) for one, start in zip(free, starts, strict=True)])

    def apart(self, lam: np.ndarray) -> float:
        """Return the largest difference between the forces of the answer and others, relative to the largest."""
        return float(abs(self.lam - lam).max() / self.largest)

    def named(self, rows: np.ndarray) -> str:
        """Return the number of some constraints and the first of their vertices."""
        first = ", ".join(map(str, self.vertices[rows][:5])) + (", …" if len(rows) > 5 else "")
        return f"{len(rows)} vertices ({first})" if len(rows) > 1 else f"vertex {first}"


def _dense_stiffness(task: Task) -> np.ndarray:
    """Return the matrix of (C ε(u), ε(v))_Q for all components of all vertices."""
    d, gradient = task.dim, np.zeros((len(task.cells), task.dim * (task.dim + 1), task.dim, task.dim))
    for axis in range(d):
        gradient[:, axis::d, axis, :] = task.gradients
    B = np.stack([_weight(i, j) * (gradient[..., i, j] + gradient[..., j, i]) / 2 for i, j in pairs(d)], 1)
    local = np.einsum("c,cIi,cIJ,cJj->cij", task.volumes, B, task.stiffness, B, optimize=True)
    dofs = (d * task.cells[:, :, None] + np.arange(d)).reshape(len(task.cells), -1)
    K = np.zeros((task.vertices.size, task.vertices.size))
    np.add.at(K, (dofs[:, :, None], dofs[:, None, :]), local)
    return K


def active_set(
    W: np.ndarray,
    free: np.ndarray,
    start: np.ndarray | None = None,
    updates: int = 60,
    release: bool = True,
    tied: np.ndarray | None = None,
) -> np.ndarray:
    """Return λ ≥ 0 with gap = free − W λ ≤ 0 by a primal-dual active set.

    It may begin from a set, stop after some updates, release no vertex, or tie some vertices, which may then pull.
    """
    tied = np.zeros(len(free), bool) if tied is None else tied
    held, scale = (tied if start is None else start | tied), 1 / max(abs(np.diag(W)).max(), 1e-300)
    for count in range(updates + 1):
        lam = np.zeros(len(free))
        lam[held] = np.linalg.lstsq(W[np.ix_(held, held)], free[held], rcond=None)[0]
        wanted = tied | (lam + scale * (free - W @ lam) > 1e-12 * scale * abs(free).max())
        wanted = wanted if release else wanted | held
        if (wanted == held).all() or count == updates:
            break
        held = wanted
    return lam


def contact_causes(equations: Equations) -> Iterator[Cause]:
    """Yield every cause in the contact algorithm with its residual, where the equations inside the body hold."""
    if equations.u[0].size > LARGEST_SOLVE:
        return
    problem = ContactProblem(equations)
    without = problem.apart(problem.right)
    if without <= CONTACT_HOLDS:
        return
    for guesses in (_wrong_laws, _wrong_sets, _wrong_places, _springs):
        for key, sentence, lam in guesses(problem):
            yield Cause(key, sentence, problem.apart(lam), without)


Guesses = Iterator[tuple[str, str, np.ndarray]]


def _wrong_laws(problem: ContactProblem) -> Guesses:
    """Yield contact that obeys another law at all vertices, or that of another step."""
    right, every = problem.right, np.ones(len(problem.mass), bool)
    yield "none", "contact is missing: no contact forces act", 0 * right
    yield "normals", "the normals are reversed: contact acts on the wrong side", -problem.each(-problem.free)
    yield "tied", "contact pulls: u_ν = 0 on the whole face, no vertex lifts off", problem.each(tied=every)
    factor = float((problem.lam * right).sum() / max((right**2).sum(), 1e-300))
    words = f"the contact forces that act on the body are {factor:.6g} times the right ones"
    yield "scaled", words, factor * right
    if problem.initial.any():
        for by, words in ((-1, "taken with the reversed sign"), (0, "forgotten"), (2, "counted twice")):
            free = problem.free + (1 - by) * problem.initial
            yield f"gap {by}", f"the initial gap is {words}", problem.each(free)
    if len(right) > 1:
        words = "contact is one step late: the contact"
        yield "late:forces", f"{words} forces are those of the step before", np.concatenate([0 * right[:1], right[:-1]])
        for key, first in (("none", ~every), ("own", problem.pressed[0])):
            late = problem.each(starts=[first, *(right[:-1] > 0)], updates=0)
            yield f"late:{key}", f"{words} vertices are those of the step before", late


def _wrong_sets(problem: ContactProblem) -> Guesses:
    """Yield active sets that are never released, or not iterated to the end."""
    none = np.zeros(len(problem.mass), bool)
    pulls = "vertices in contact are never released, although their forces pull"
    yield "release:iterations", pulls, problem.each(release=False)
    acted = np.logical_or.accumulate(abs(problem.lam) > 1e-9 * problem.largest, axis=0)
    yield "release:steps", pulls, problem.each(starts=[none, *acted[:-1]], release=False)
    pulled = (problem.lam < -1e-9 * problem.largest).any(axis=0)
    if pulled.any() and not pulled.all():
        words = f"contact pulls at {problem.named(np.flatnonzero(pulled))}, which cannot lift off"
        yield "release:some", words, problem.each(tied=pulled)
    starts = (("no vertex", none), ("all vertices", ~none), ("the vertices of the step before", None))
    for updates, times in ((1, "once"), (2, "twice"), (3, "three times")):
        for words, start in starts:
            before = [none, *problem.pressed[:-1]] if start is None else [start] * len(problem.lam)
            lam = problem.each(starts=before, updates=updates)
            sentence = f"the active set is updated only {times} in each step, starting from {words}"
            yield f"updates:{updates} {words}", sentence, lam


def _wrong_places(problem: ContactProblem) -> Guesses:
    """Yield constraints that are missing at vertices, imposed on means over facets, or with averaged normals."""
    eye, unloaded = np.eye(len(problem.mass)), (abs(problem.lam) <= 1e-9 * problem.largest).all(axis=0)
    entered = (problem.gap > 1e-9 * abs(problem.gap).max()).any(axis=0)
    rows: list[tuple[str, str, np.ndarray]] = []
    if (forgotten := unloaded & entered).any() and not unloaded.all():
        words = f"the constraint is forgotten at {problem.named(np.flatnonzero(forgotten))}"
        rows.append(("forgotten", words, eye[~forgotten]))
    means, first = [], 0
    for piece, (_, vertices, _) in zip(problem.task.data["contact"], problem.task.pieces(), strict=True):
        row_of = {int(v): first + k for k, v in enumerate(vertices)}
        means += [sum(eye[row_of[v]] for v in facet if v in row_of) / len(facet) for facet in piece["facets"]]
        first += len(vertices)
    words = "contact is imposed on the mean gap of each facet (facet midpoints), not at the vertices"
    rows.append(("facets", words, np.array([row for row in means if np.ndim(row)])))
    numbers, counts = np.unique(problem.vertices, return_counts=True)
    if len(corners := numbers[counts > 1]):
        alone = eye[~np.isin(problem.vertices, corners)]
        shared = [eye[problem.vertices == v].sum(axis=0) for v in corners]
        words = f"the normals of faces that meet are averaged (vertices {', '.join(map(str, corners[:5]))})"
        rows.append(("corner", words, np.concatenate([alone, shared])))
    for key, words, R in rows:
        W = R @ problem.W @ R.T
        yield key, words, np.array([active_set(W, R @ free) for free in problem.free]) @ R


def _springs(problem: ContactProblem) -> Guesses:
    """Yield forces of springs: stiffness times area, or the stiffness alone, times the gap where it is entered."""
    alike = "for each vertex, whatever its area (half at the ends)"
    for gap, pull in ((np.maximum(problem.gap, 0), ""), (problem.gap, " that also pull")):
        for area, words in ((problem.mass, "for each area"), (np.ones_like(problem.mass), alike)):
            k = float((problem.lam * area * gap).sum() / max(((area * gap) ** 2).sum(), 1e-300))
            sentence = f"contact is by springs{pull} (a penalty) of stiffness {k:.4g} {words}"
            yield f"springs{pull} {words}", sentence, k * area * gap


def orders(h: list[float], errors: list[float]) -> list[float]:
    """Return the orders between neighbouring meshes; infinite where nothing is left."""
    pairs_of = zip(zip(h, errors, strict=True), zip(h[1:], errors[1:], strict=False), strict=False)
    return [float(np.log(a / b) / np.log(k / m)) if min(a, b) > 0 else float("inf") for (k, a), (m, b) in pairs_of]


def order(h: list[float], errors: list[float]) -> float:
    """Return the order between the last two meshes; nan from one mesh."""
    return orders(h, errors)[-1] if len(h) > 1 else float("nan")


@dataclass(frozen=True)
class Judgement:
    """A code on one case, mesh by mesh; orders between the last two meshes, ``order_of_best`` that of K^h.

    ``why`` has the numbers behind the verdict in words, ``cause`` the most likely reason of a difference ("" if there
    is none), ``reports`` the judgements of what the code itself reports. ``tested`` has the constraints that are in
    contact at some step on the last mesh, those that are free at some step, and all: no answer says anything of the
    others.
    """

    case: str
    family: str
    mode: str
    levels: list[int]
    errors: list[Errors]
    verdict: str
    why: str
    tested: tuple[int, int, int]
    order_in_v: float
    order_of_best: float
    order_of_distance: float
    order_of_pressure: float
    invariance: float
    cause: str = ""
    reports: list[Report] = field(default_factory=list)

    def outcome(self, tolerance: float = 0.0) -> str:
        """Return holds, fails or undecided.

        A class of ``GOOD`` holds, and so does a distance of at most ``tolerance`` times the discretisation error on all
        meshes unless the class is *wrong*. A report of the code that is not right fails.
        """
        if not all(report.right for report in self.reports):
            return "fails"
        within = max(one.share for one in self.errors) <= tolerance and self.verdict != "wrong"
        if self.verdict in GOOD or within:
            return "holds"
        return "undecided" if self.verdict == "undecided" else "fails"


def classify(h: list[float], errors: list[Errors]) -> str:
    """Return the class of a code from its errors, mesh by mesh.

    The distance is that of strains and vertex values from the solution in K^h (``Errors.share``).

    *exact for P1*: the distance is at most ``EXACT`` of the discretisation error.
    *consistent*: on ``MESHES`` meshes or more, the distance falls between the last two with half the order of the
    error, at most ``FALLS``, and the error of the pressure with ``PRESSURE_FALLS``, or as that of K^h up to
    ``NECESSARY``.
    *wrong*: no numbers; a body that is not held on Γ1; or, from two meshes on, a distance that grows and is more than
    ``NEGLIGIBLE``, a pressure no better than none, or other equations.
    *stagnates*: anything else; *undecided* if there are fewer meshes.
    """
    return judged(h, errors)[0]


def judged(h: list[float], errors: list[Errors]) -> tuple[str, str]:
    """Return the class, and the numbers that decided."""
    shares, last = [one.share for one in errors], errors[-1]
    if not np.isfinite(shares).all():
        return "wrong", "no numbers"
    if max(shares) <= EXACT and max(one.from_best for one in errors) <= 10 * EXACT:
        return EXACT_CLASS, f"{max(shares):.0e} of the error"
    clamp = [one.on_clamp for one in errors]
    if shares[-1] > NEGLIGIBLE and last.on_clamp > AGREES and not order(h, clamp) >= FALLS:
        return "wrong", f"u on Γ1 is {last.on_clamp:.1e} of the largest displacement, where it must be 0"
    if len(h) < 2:
        return "undecided", f"one mesh, not exact: {shares[-1]:.1e} of the error"
    fall = orders(h, [one.share * one.best for one in errors])
    if fall[-1] < -FALLS and shares[-1] > NEGLIGIBLE:
        return "wrong", f"grows with order {-fall[-1]:.1f}, {shares[-1]:.1e} of the error"
    if last.pressure >= NO_CONTACT:
        return "wrong", f"pressure no better than none, error {last.pressure:.2f}"
    if last.tangential >= OTHER_EQUATIONS:
        return "wrong", f"other equations, forces of {last.tangential:.2g} of the load where none may be"
    pressure, of_best = (order(h, [getattr(one, name) for one in errors]) for name in ("pressure", "best_pressure"))
    needed = min(FALLS, max(order(h, [one.best for one in errors]) / 2, LEAST_FALL))
    return _by_orders(fall, needed, pressure, min(PRESSURE_FALLS, of_best - NECESSARY), shares[-1])


def _by_orders(fall: list[float], needed: float, pressure: float, wanted: float, share: float) -> tuple[str, str]:
    """Return the class of what is neither exact nor wrong."""
    told = f"order {', '.join(f'{one:.1f}' for one in fall)}"
    if len(fall) + 1 < MESHES:
        return "undecided", f"{told} from {len(fall) + 1} meshes; {MESHES} are needed"
    if fall[-1] < needed:
        return "stagnates", f"at {share:.1e} of the error, {told}"
    if pressure < wanted:
        return "stagnates", f"in the pressure, order {pressure:.1f}"
    return CONSISTENT, told


def assess(
    tasks: list[Task], answers: dict[str, np.ndarray], reports: dict[str, dict[str, np.ndarray]] | None = None
) -> list[Judgement]:
    """Return one judgement for each case, mesh family and mode.

    Args:
        tasks: the tasks.
        answers: name of a task ↦ u, (steps, n, d).
        reports: name of a task ↦ what the code itself reports, as ``judge_reports`` takes it; optional.

    Where a task is there under two load scales, ``invariance`` is the largest distance between their answers, in V and
    relative to the discretisation error: zero for a code that knows small displacements only. nan with one scale.

    Raises:
        TaskError: an answer is missing or has another shape.
    """
    groups: dict = defaultdict(lambda: defaultdict(list))
    for task in tasks:
        data, shape = task.data, (task.count, *task.vertices.shape)
        if task.name not in answers or np.shape(answers[task.name]) != shape:
            given = f"has the shape {np.shape(answers[task.name])}" if task.name in answers else "is missing"
            raise TaskError(f"the answer to {task.name} {given}, expected {shape}: steps, vertices, components")
        groups[data["case"], data["family"], data["mode"]][data["level"]].append(task)
    return [_judgement(key, levels, answers, reports or {}) for key, levels in groups.items()]


def _judgement(key: tuple, levels: dict, answers: dict, reports: dict) -> Judgement:
    """Judge one case on one mesh family in one mode."""
    numbers = sorted(levels)
    first = [levels[n][0] for n in numbers]
    h = [task.data["h"] for task in first]
    errors = [measure(task, np.asarray(answers[task.name], float)) for task in first]
    apart = [_between(levels[n], answers, one.best) for n, one in zip(numbers, errors, strict=True)]
    last = [order(h, [getattr(one, name) for one in errors]) for name in ("error", "best", "distance", "pressure")]
    known = [value for value in apart if not np.isnan(value)]
    verdict, why = judged(h, errors)
    differing = [task for task, one in zip(first, errors, strict=True) if not one.share <= EXACT]
    cause = diagnose(differing, [np.asarray(answers[task.name], float) for task in differing]) if differing else ""
    told = [
        report
        for n in numbers
        for task in levels[n]
        for report in judge_reports(task, np.asarray(answers[task.name], float), reports.get(task.name, {}))
    ]
    invariance = max(known, default=float("nan"))
    return Judgement(*key, numbers, errors, verdict, why, tested(first[-1]), *last, invariance, cause, told)


def _between(tasks: list[Task], answers: dict[str, np.ndarray], best: float) -> float:
    """Return the distance between answers to one task under two scales; nan for one."""
    if len(tasks) < 2:
        return float("nan")
    first, second = (answers[task.name] / task.scale for task in tasks[:2])
    return max(tasks[0].norm(tasks[0].strain(v)) for v in first - second) / best


def unpack(task: Task, directory: Path) -> None:
    """Write a task as text files, for programs that read no JSON: what the page on the format lists."""
    place = Path(directory) / task.name
    place.mkdir(parents=True, exist_ok=True)
    numbers = {"cells": task.cells, "clamped": task.clamped}
    for i, (piece, gap) in enumerate(zip(task.data["contact"], task.gaps(), strict=True), start=1):
        numbers |= {
            f"contact_{i}": np.array(piece["facets"], int),
            f"constrained_{i}": np.array(piece["vertices"], int),
        }
        np.savetxt(place / f"normal_{i}.txt", np.array([piece["normal"]]), fmt="%.17g")
        np.savetxt(place / f"gap_{i}.txt", gap, fmt="%.17g")
    for name, values in numbers.items():
        np.savetxt(place / f"{name}.txt", values, fmt="%d")
    tensors = {"stiffness": task.stiffness} | ({"A": task.A, "G": task.G} if task.marches else {})
    reals = {"vertices": task.vertices} | {name: one.reshape(len(task.cells), -1) for name, one in tensors.items()}
    if task.marches:
        reals |= {"start": task.start(), "step": np.array([task.data["step"]])}
    for n in range(task.count):
        load, stress = task.step(n, task.start())
        reals |= {f"load_{n + 1}": load} | ({} if task.marches else {f"initial_stress_{n + 1}": stress})
    for name, values in reals.items():
        np.savetxt(place / f"{name}.txt", values, fmt="%.17g")


def table(judgements: list[Judgement], tolerance: float = 0.0) -> str:
    """Return what the judgements say, in lines; numbers are those of the last mesh."""
    head = f"{'case':<22}{'meshes':<13}{'mode':<7}{'n':<9}{'V order':>8}{'distance':>10}{'pressure':>10}{'of K^h':>8}"
    lines = [f"{head}{'pressed':>9}{'free':>8}  class"]
    for one in judgements:
        last, (pressed, free, count) = one.errors[-1], one.tested
        levels = " ".join(map(str, one.levels))
        numbers = f"{one.order_in_v:8.2f}{last.share:10.1e}{last.pressure:10.3f}{last.best_pressure:8.3f}"
        reached = f"{f'{pressed}/{count}':>9}{f'{free}/{count}':>8}"
        what = f"{one.verdict} ({one.why})"
        if one.verdict not in GOOD and one.outcome(tolerance) == "holds":
            what += f", passes: at most {tolerance:g} of the error"
        lines += [f"{one.case:<22}{one.family:<13}{one.mode:<7}{levels:<9}{numbers}{reached}  {what}"]
        lines += [f"    {note}" for note in notes(one)]
    return "\n".join(lines)


def notes(one: Judgement) -> list[str]:
    """Return what the class does not say: the most likely cause first."""
    last, lines = one.errors[-1], [one.cause] if one.cause else []
    if not np.isnan(one.invariance):
        lines.append(f"load scales differ by {one.invariance:.1e} of the error")
    if abs(one.order_in_v - one.order_of_best) > NECESSARY:
        lines.append("the order in V is not that of the solution in K^h, which is necessary")
    if last.idle:
        named = ", ".join(map(str, last.idle[:5])) + (", …" if len(last.idle) > 5 else "")
        lines.append(f"vertices that are pressed and carry next to nothing: {len(last.idle)} ({named})")
    if one.verdict == CONSISTENT and last.pressure > LARGE_PRESSURE * last.best_pressure:
        lines.append(
            f"the pressure has {last.pressure / last.best_pressure:.0f} times the error of the solution in K^h"
        )
    if FEW_FORCES < last.tangential < OTHER_EQUATIONS:
        lines.append(
            f"forces of {last.tangential:.1e} of the load where none may be: terms inside the body (Nitsche), places "
            "of contact that move (smaller loads?), or equations that are not quite those of the task"
        )
    if one.verdict not in GOOD and NEGLIGIBLE < last.penetration < np.inf:
        lines.append(f"the body enters the foundation by {last.penetration:.2g} of the largest displacement")
    return lines + list(dict.fromkeys(report.sentence for report in one.reports))


def as_json(judgements: list[Judgement], tolerance: float = 0.0) -> str:
    """Return all numbers as JSON (docs/reference/contact-verdict.schema.json); what is no number is null."""

    def valid(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: valid(one) for key, one in value.items()}
        if isinstance(value, list | tuple):
            return [valid(one) for one in value]
        return None if isinstance(value, float) and not math.isfinite(value) else value

    rows = [valid(asdict(one)) | {"outcome": one.outcome(tolerance)} for one in judgements]
    return json.dumps(rows, indent=1, ensure_ascii=False, allow_nan=False)


def as_junit(judgements: list[Judgement], tolerance: float = 0.0) -> str:
    """Return JUnit XML: one test case for each judgement; undecided ones are failures."""
    outcomes = [one.outcome(tolerance) for one in judgements]
    failed = str(len(outcomes) - outcomes.count("holds"))
    suite = ElementTree.Element("testsuite", name="contact_judge", tests=str(len(outcomes)), failures=failed)
    for one, outcome in zip(judgements, outcomes, strict=True):
        name = f"{one.case}, {one.family}, {one.mode}, n = {' '.join(map(str, one.levels))}"
        case = ElementTree.SubElement(suite, "testcase", classname="contact_judge", name=name)
        text = "\n".join([f"{one.verdict} ({one.why})", *notes(one)])
        if outcome != "holds":
            ElementTree.SubElement(case, "failure", message=f"{outcome}: {one.verdict} ({one.why})").text = text
        else:
            ElementTree.SubElement(case, "system-out").text = text
    return ElementTree.tostring(suite, encoding="unicode", xml_declaration=True) + "\n"


def exit_code(outcomes: list[str]) -> int:
    """Return 1 if one fails, else 3 if one is undecided, else 0."""
    return 1 if "fails" in outcomes else 3 if "undecided" in outcomes else 0


def main(arguments: list[str] | None = None) -> int:
    """Run the command; 0 all hold, 1 one fails, 2 usage or input, 3 one is undecided."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("tasks", type=Path, metavar="TASKS", help="directory of `study export`")
    parser.add_argument("answers", type=Path, metavar="ANSWERS", help="directory with NAME/u.txt for each task")
    parser.add_argument("--unpack", action="store_true", help="write the tasks to ANSWERS as text files")
    within = "also pass a distance of X of the discretisation error on all meshes (default 0)"
    parser.add_argument("--tolerance", type=float, default=0.0, metavar="X", help=within)
    parser.add_argument("--json", action="store_true", help="print all numbers as JSON")
    parser.add_argument("--junit", type=Path, metavar="FILE", help="also write the verdicts as JUnit XML")
    options = parser.parse_args(arguments)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            # A terminal in ASCII or cp1252 has no Γ.
            stream.reconfigure(errors="backslashreplace")
    try:
        if not 0 <= options.tolerance < np.inf:
            raise TaskError(f"--tolerance must be a number of 0 or more, got {options.tolerance:g}")
        tasks = read_tasks(options.tasks)
        if options.unpack:
            for task in tasks:
                unpack(task, options.answers)
            return 0
        answers = {task.name: read_answer(options.answers, task) for task in tasks}
        with np.errstate(all="ignore"):
            judgements = assess(tasks, answers, {task.name: read_reports(options.answers, task) for task in tasks})
        if options.junit:
            options.junit.write_text(as_junit(judgements, options.tolerance), encoding="utf-8")
    except TaskError as error:
        print(f"contact_judge: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"contact_judge: cannot read or write {error.filename}: {error.strerror or error}", file=sys.stderr)
        return 2
    print(as_json(judgements, options.tolerance) if options.json else table(judgements, options.tolerance))
    return exit_code([one.outcome(options.tolerance) for one in judgements])


if __name__ == "__main__":
    sys.exit(main())
