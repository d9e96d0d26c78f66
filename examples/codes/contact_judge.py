"""Judge a contact code on problems whose exact solutions are known. One file that needs NumPy alone: copy it.

    python contact_judge.py TASKS ANSWERS [--tolerance X] [--json] [--junit FILE]      errors, classes and causes
    python contact_judge.py --unpack TASKS DIR                                         the tasks as text files

TASKS holds files *.json.xz in the format contact-task 2 or 1 (docs/reference/tasks.md), ANSWERS for the task
NAME.json.xz a file NAME/u.txt: one line for each step, with u_x u_y (u_z) of vertex after vertex, and optionally what
the code reports about contact. From Python, ``answer`` drives a code and ``assess`` judges it
(docs/how-to/verify-a-contact-code.md). Exit codes: 0 all series pass, 1 one fails, 2 usage or input, 3 undecided.
"""

from __future__ import annotations

import argparse
import copy
import gzip
import hashlib
import json
import lzma
import math
import re
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
"""Distance from the solution in K^h over the discretisation error up to which a code is exact for P1."""
FALLS, LEAST_FALL = 0.5, 0.2
"""Order from which on a distance falls, or grows: half of that of the error if this is below 1, but at least 0.2."""
PRESSURE_FALLS = 2 / 3
"""Order from which on the error of the pressure falls, unless that of the solution in K^h falls more slowly."""
MESHES = 3
"""Meshes without which nothing is said of an order: on two, what falls fast hides what does not fall."""
NEGLIGIBLE, NO_CONTACT = 0.01, 0.9
"""Part of the error up to which a distance may grow (quadrature, iterations); pressure error of about no contact, 1."""
OTHER_EQUATIONS, UNBALANCED, FEW_FORCES = 0.1, 0.3, 1e-3
"""Part of the load where no force may be, to be wrong on the last mesh, on a coarser mesh, and to be mentioned;
Nitsche's methods leave some hundredths."""
NEXT_TO_NOTHING = 0.1
"""Part of the force of the solution in K^h up to which a vertex is idle; part of the largest pressure to be asked."""
NECESSARY, LARGE_PRESSURE, LARGE_SHARE = 0.15, 3, 0.3
"""Distance of two orders that are the same; times the error of K^h from which on a pressure is mentioned; distance over
the error of K^h from which on it is mentioned."""
AGREES, NAMED, HINTED = 1e-6, 1e-3, 0.05
"""Relative difference up to which what a code reports agrees with its displacements: six digits in a text file; part of
the residual that a cause may leave to be most likely, and to be a hint."""
CERTAIN, LARGE_ON_CLAMP, FAR, SINGULAR = 1e-8, 0.3, 100, 1e6
"""Residual up to which a cause is certain. Over the largest displacement of the exact solution: u on Γ1 of order 1,
displacements that are wrong on every mesh, displacements that only a singular matrix gives."""
JUMP, FACTOR, PEAK = 6, 50, 0.1
"""Order and factor above which no distance falls from a large share of the error: the coarser mesh is then wrong. Share
above which this holds where the distance grew before; integral multipliers may be exact on some meshes, and 0.02 off on
others."""
METHODS, FITTED = ("springs", "facets"), ("units", "scaled", "offset", "tilt", "rigid")
"""Causes that may be consistent methods; causes with a number fitted to the answer, which may tend to the right one."""
EQUATIONS_HOLD, CONTACT_HOLDS = 1e-6, 1e-10
"""Forces over the load where none may be, and differences of contact forces over the largest, that need no cause."""
ROUGH, LARGEST_SOLVE = 1.0, 1500
"""‖ε(v)‖ h / ‖v‖ from which on a difference v changes from vertex to vertex (π h for the smoothest on a unit square);
components of u up to which the judge solves the contact problem itself, to try causes in the contact algorithm."""
HUGE = 1e100
"""Value from which on a number is no displacement; its square would still be finite."""
GOOD = EXACT_CLASS, CONSISTENT = "exact for P1", "consistent"
CLASSES = *GOOD, "undecided", "stagnates", "wrong"
"""All classes, the worst last."""
OPEN: dict[str, Callable] = {".xz": lzma.open, ".gz": gzip.open}
PACKING, UNSUSPICIOUS = 100, 2**28
"""A file may unpack to so many times its size. Files that unpack to at most 256 MiB may have any ratio."""
INVISIBLE = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\xad\u061c\u180e\u200b-\u200f\u2028-\u202e\u2060-\u206f\ud800-\udfff\ufeff"
    "\ufff9-\uffff\U000e0000-\U000e007f]"
)
"""Characters that command a terminal, are not seen or are not permitted in XML, as in ``study.ledger.printable``."""
NOT_TEXT = {b"\x93NUMPY": "a file of numpy.save", b"\xfd7zXZ": "packed with xz", b"\x1f\x8b": "packed with gzip"}
NOT_TEXT |= {b"PK\x03\x04": "a zip or npz file", b"BZh": "packed with bzip2", b"\x89HDF": "an HDF5 file"}
NOT_TEXT |= dict.fromkeys((b"\xff\xfe", b"\xfe\xff"), "text in UTF-16 (PowerShell writes it)")
"""First bytes of files that are not plain text."""
FORTRAN = re.compile(r"(?<=[\d.])[dD](?=[+-]?\d)")
"""The D of Fortran's exponents, 1.5D-03."""
REPORTS = "pressure", "forces", "status", "resultant"
ODD, ON_THE_MESH = "is multiplied by the factor", "on the mesh"
TOLERANCE = "tolerance"
"""Key of the cause that the solver stops too early."""


class TaskError(ValueError):
    """A task, an answer or an option cannot be used."""


class Task:
    """One problem on one mesh: static steps, one after the other, and what answers are judged by.

    Attributes:
        name: of the file.
        data: as it was read, arrays as lists; ``vertices`` (n, d), ``cells`` (cells, d + 1), ``dim`` is d.
        stiffness: C of the static steps for every cell, Mandel, (cells, D, D): G, in a march A/k + G/2.
        clamped: numbers of the vertices at which u = 0; ``count`` is the number of steps.

    Data that are no task raise TaskError, which names the key that is missing or has another shape.
    """

    def __init__(self, name: str, data: dict) -> None:
        if not isinstance(data, dict):
            raise TaskError(f"{name} holds a JSON {type(data).__name__}, expected a task (an object); remove the file")
        if data.get("format") != "contact-task" or data.get("version") not in (1, 2):
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
        self.dim = self.vertices.shape[1]
        laws = ((np.array(data["law"][name]["factor"], float), data["law"][name]["matrix"]) for name in "AG")
        tensors = (np.broadcast_to(f, len(self.cells))[:, None, None] * np.array(matrix, float) for f, matrix in laws)
        self.A, self.G = tensors
        self.stiffness = self.A / data["step"] + self.G / 2 if self.marches else self.G
        self.history = self.G / 2 - self.A / data["step"] if self.marches else 0 * self.G
        corners = self.vertices[self.cells]
        edges = np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2)
        self.volumes = np.linalg.det(edges) / (1, 1, 2, 6)[self.dim]
        inverse = np.linalg.inv(edges)
        self.gradients = np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1)
        full = np.einsum("ai,ckj->ijcka", np.eye(self.dim), self.gradients)
        self.strains = np.array([(full[i, j] + full[j, i]) / (2 if i == j else np.sqrt(2)) for i, j in pairs(self.dim)])

    def _check(self) -> None:
        """ValueError, which says what is wrong, unless numbers are finite and shapes fit each other."""
        n, strains = self.vertices.shape, (len(self.cells), self.G.shape[1])
        steps, judge = self.data["steps"], self.data["judge"]
        if not (self.volumes > 0).all() or min(self.cells.min(), self.clamped.min(initial=0)) < 0:
            raise ValueError(f"cell {int(np.argmin(self.volumes))} has no positive volume, or a number is negative")
        if not self.count or len(judge) != self.count or not self.scale > 0:
            raise ValueError(f"{self.count} steps, {len(judge)} objects to judge them by, and the scale {self.scale}")
        own = ([self.data], "start", n) if self.marches else (steps, "initial_stress", strains)
        shapes = {"displacement": n, "reference": n, "strain": strains, "rest": ()}
        for objects, key, shape in [(steps, "load", n), own, *((judge, *item) for item in shapes.items())]:
            values = np.array([one[key] for one in objects], float)
            if values.shape[1:] != shape or not np.isfinite(values).all():
                raise ValueError(f"{key!r} has the shape {values.shape[1:]} or no finite numbers, expected {shape}")
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
            data = json.loads(_content(path))
        except (OSError, EOFError, ValueError, lzma.LZMAError, zlib.error, RecursionError) as error:
            raise TaskError(f"{path} is no JSON: {error}") from error
        return cls(path.name.partition(".json")[0], data)

    def strain(self, u: np.ndarray) -> np.ndarray:
        """Return ε(u) on the cells, Mandel, (cells, D), from values at the vertices (n, d)."""
        return np.einsum("Dcka,cka->cD", self.strains, u[self.cells])

    def internal(self, stress: np.ndarray) -> np.ndarray:
        """Return (σ, ε(φ_i e_j))_Q for stresses on the cells (cells, D), at the vertices (n, d)."""
        total = np.zeros_like(self.vertices)
        np.add.at(total, self.cells, np.einsum("c,Dcka,cD->cka", self.volumes, self.strains, stress))
        return total

    def step(self, n: int, before: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (b, s_0) of step n: nodal forces (n, d) and initial stress (cells, D); ``before`` is u_{n−1}."""
        load = np.array(self.data["steps"][n]["load"], float)
        if not self.marches:
            return load, np.array(self.data["steps"][n]["initial_stress"], float)
        return load, np.einsum("cij,cj->ci", self.history, self.strain(before))

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
            edges, mass = self.vertices[facets[:, 1:]] - self.vertices[facets[:, :1]], np.zeros(len(self.vertices))
            sizes = np.sqrt(np.linalg.det(edges @ np.swapaxes(edges, 1, 2))) / (1, 1, 2)[self.dim - 1]
            np.add.at(mass, facets, sizes[:, None] / self.dim)
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

    def references(self) -> np.ndarray:
        """Return the solutions in K^h of all steps, (steps, n, d), for loads that are not scaled."""
        return np.array([one["reference"] for one in self.data["judge"]], float)

    def sums(self, forces: np.ndarray) -> np.ndarray:
        """Return the sum of forces at the constraints (steps, m) over each piece, (steps, pieces)."""
        ends = np.cumsum([len(piece["vertices"]) for piece in self.data["contact"]])[:-1]
        return np.array([part.sum(axis=1) for part in np.split(forces, ends, axis=1)]).T

    def gaps(self) -> list[np.ndarray]:
        """Return the initial gap at the vertices of each piece (m,), in the units of the task; zero without ``gap``."""
        return [np.broadcast_to(np.array(p.get("gap", 0.0), float), len(p["vertices"])) for p in self.data["contact"]]

    def scaled(self, factor: float) -> Task:
        """Return the task with gaps times ``factor``, which belongs to loads times ``factor``."""
        other, pieces = copy.copy(self), zip(self.data["contact"], self.gaps(), strict=True)
        contact = [piece | {"gap": (factor * gap).tolist()} for piece, gap in pieces]
        other.data = {**self.data, "contact": contact}
        return other


def pairs(dim: int) -> list[tuple[int, int]]:
    """Return the index pairs of Mandel components: 11, 22, 12 or 11, 22, 33, 23, 13, 12."""
    return [(0, 0), (1, 1), (0, 1)] if dim == 2 else [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]


def _content(path: Path) -> bytes:
    """Return the unpacked content of a file; ValueError if it is much larger than the file."""
    limit = max(UNSUSPICIOUS, PACKING * path.stat().st_size)
    with OPEN.get(path.suffix, open)(path, "rb") as file:
        data = file.read(limit + 1)
    if len(data) > limit:
        raise ValueError(f"it unpacks to more than {limit} bytes, {PACKING} times its size: export it again")
    return data


def printable(text: str) -> str:
    r"""Return a text with every control character as in JSON, such as \u001b for Escape."""
    return INVISIBLE.sub(lambda found: json.dumps(found[0])[1:-1], text)


def read_tasks(directory: Path) -> list[Task]:
    """Return all tasks of a directory; TaskError unless all are readable and as SHA256SUMS says, if it is there."""
    directory = Path(directory)
    if not directory.is_dir():
        raise TaskError(f"{directory} is no directory, expected one that `study export` has written")
    if (directory / "SHA256SUMS").exists():
        _check_sums(directory)
    paths = sorted(directory.glob("*.json*"))
    if not paths:
        raise TaskError(f"{directory} holds no *.json.xz; write them there with `study export CASE --out {directory}`")
    tasks = [Task.read(path) for path in paths]
    if len({task.name for task in tasks}) < len(tasks):
        raise TaskError(f"two files of {directory} have the same name but for .xz or .gz; remove one of them")
    return tasks


def _check_sums(directory: Path) -> None:
    path = directory / "SHA256SUMS"
    for number, line in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), 1):
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
        given = step(scale * load, stress if task.marches else scale * stress)
        u = as_array(given, task.vertices.shape, f"the result of step {n + 1} of {task.name}", "vertices, components")
        result.append(u / scale)
    return np.array(result)


def as_array(values: Any, shape: tuple[int, ...], what: str, axes: str) -> np.ndarray:
    """Return values as an array of floats; TaskError, which names ``what`` and its axes, if it has another shape."""
    try:
        array = np.asarray(values, float)
    except (TypeError, ValueError) as error:
        raise TaskError(f"{what} is no array of numbers ({error}), expected the shape {shape}: {axes}") from error
    if array.shape != shape:
        turned = "; it may be transposed" if array.shape[-2:] == shape[:-3:-1] and array.ndim == len(shape) else ""
        raise TaskError(f"{what} has the shape {array.shape}, expected {shape}: {axes}{turned}")
    return array


def write_answer(directory: Path, task: Task, u: np.ndarray, **reports: np.ndarray) -> None:
    """Write DIRECTORY/NAME/u.txt, and NAME/pressure.txt, forces.txt, status.txt, resultant.txt for ``reports``."""
    place = Path(directory) / task.name
    place.mkdir(parents=True, exist_ok=True)
    for name, values in {"u": u, **reports}.items():
        np.savetxt(place / f"{name}.txt", np.reshape(values, (len(u), -1)), fmt="%.17g")


def read_answer(directory: Path, task: Task) -> np.ndarray:
    """Return the displacements of an answer, (steps, n, d); TaskError if they cannot be read."""
    return _numbers(Path(directory) / task.name / "u.txt", (task.count, *task.vertices.shape))


def read_reports(directory: Path, task: Task) -> dict[str, np.ndarray]:
    """Return what the code itself reports: name in ``REPORTS`` ↦ (steps, values), for the files that are there."""
    sizes = dict.fromkeys(REPORTS, len(task.constraints()[0])) | {"resultant": len(task.data["contact"])}
    paths = {name: Path(directory) / task.name / f"{name}.txt" for name in REPORTS}
    return {name: _numbers(path, (task.count, sizes[name])) for name, path in paths.items() if path.exists()}


def _numbers(path: Path, shape: tuple[int, ...]) -> np.ndarray:
    """Return the numbers of a text file, which may be packed as FILE.xz or FILE.gz; TaskError if it holds others."""
    lines, count = shape[0], math.prod(shape[1:])
    expected = f"expected plain text: {_size(lines, count)} separated by blanks"
    packed = next((one for suffix in OPEN if (one := path.with_name(path.name + suffix)).exists()), path)
    try:
        data = _content(path if path.exists() else packed)
    except FileNotFoundError as error:
        raise TaskError(f"{path} is missing, {expected}; write it there") from error
    except (OSError, EOFError, ValueError, lzma.LZMAError, zlib.error) as error:
        why = getattr(error, "strerror", None) or error
        raise TaskError(f"{path} cannot be read ({why}), {expected}; write it again") from error
    if kind := next((words for start, words in NOT_TEXT.items() if data.startswith(start)), ""):
        raise TaskError(f"{path} is {kind}, {expected}; write it again (numpy.savetxt writes such files)")
    rows: dict[int, np.ndarray] = {}
    for number, line in enumerate(data.decode("utf-8-sig", errors="backslashreplace").splitlines(), 1):
        words = FORTRAN.sub("e", line.partition("#")[0]).split()
        try:
            rows |= {number: np.array(words, float)} if words else {}
        except ValueError as error:
            found, mend = _no_number(next((word for word in words if not _is_number(word)), words[0]))
            raise TaskError(f"{path}, line {number}: {found}, {expected}; {mend}") from error
    if not rows:
        raise TaskError(f"{path} has no numbers, {expected}; close the file before the program ends")
    sizes = [len(row) for row in rows.values()]
    usual = count if count in sizes else max(sizes, key=sizes.count)
    if others := [number for number, row in rows.items() if len(row) != usual]:
        what = f"line {others[0]} has {len(rows[others[0]])} numbers, other lines have {usual}"
        raise TaskError(f"{path}, {what}, {expected}; look for a number or a blank that is missing or too much")
    values = np.array(list(rows.values()))
    if values.size != np.prod(shape):
        raise TaskError(f"{path} has {_size(*values.shape)}, {expected}{_other_size(values, shape)}")
    return values.reshape(shape)


def _size(lines: int, count: int) -> str:
    return f"{lines} line{'s' * (lines != 1)} of {count} number{'s' * (count != 1)}"


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _no_number(word: str) -> tuple[str, str]:
    """Return a description of a word that is not a number, and how to mend it."""
    short = repr(word if len(word) < 30 else f"{word[:30]}…")
    if "*" in word:
        return f"{short} stands for a number that needs more room", "use a wider format, such as ES25.16 in Fortran"
    if ";" in word or word.count(",") > 1 or word.endswith(","):
        return f"{short} has commas or semicolons between the numbers", "write blanks in their place"
    if "," in word:
        return f"{short} has a comma", "write decimal points, and blanks between the numbers"
    return f"{short} is not a number", "leave it out, or begin lines of words with #"


def _other_size(values: np.ndarray, shape: tuple[int, ...]) -> str:
    """Return what another number of lines may mean."""
    (steps, *rest), rows = shape, len(values)
    if values.shape[1] == math.prod(rest) and rows == steps + 1:
        return "; leave out the line of the start, which is no step"
    if values.size * 2 == math.prod(shape) * 3 and rest[-1] == 2:
        return "; leave out u_z, the task is plane"
    return "; write one line for each step, with all its numbers"


@dataclass(frozen=True)
class Errors:
    """What one answer leaves on one mesh, the largest over the steps.

    Attributes:
        error: ‖u − u^h‖_V; ``best`` the same of the solution in K^h; ``discrete`` is ‖Π^h u − u^h‖_V.
        distance: from the solution in K^h, in V.
        pressure: ‖p − p^h‖ in L²(Γ3) over the largest ‖p‖, p^h from what balances the nodes; ``best_pressure`` of K^h.
        penetration: largest u_ν − gap on Γ3 over the largest |u|; on flat faces P1 is nowhere deeper than at vertices.
        resultant: largest |∫ p − Σ λ_i| over the largest ∫ p.
        tangential: largest force on Γ3 along it, and on nodes off Γ3 at all, over the largest load: other equations.
        idle: vertices on which the solution in K^h presses and this one does not, over all steps together.
        shift: (a |Ω|)^½ / L times the largest |u| on Γ1, a the mean of tr A / D, L the diameter: it sees rigid motions.
        on_clamp, at_vertices, from_best: largest |u| on Γ1, distance of vertex values from the exact ones, and from
            those of the solution in K^h, over its largest |u|.
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
    if not (abs(u) < HUGE).all():
        best = measure(task, task.scale * task.references()).best
        return Errors(np.inf, best, *[np.inf] * 7, shift=np.inf, on_clamp=np.inf, at_vertices=np.inf, from_best=np.inf)
    mine, best = (Equations(task, v) for v in (u / task.scale, task.references()))
    rows = np.array([errors_in_v(task, one, v) for one, v in zip(task.data["judge"], mine.u, strict=True)])
    values = np.max(rows, axis=0)
    pressure, *others = _contact(mine)
    numbers = (*values[:4], pressure, _contact(best)[0], *others)
    return Errors(*map(float, numbers), idle(mine, best), *map(float, values[4:]))


def errors_in_v(task: Task, exact: dict, u: np.ndarray) -> list[float]:
    """Return ‖u − u^h‖, the same for K^h, ‖Π^h u − u^h‖, the distance, and the differences of vertex values."""
    means, reference = np.array(exact["strain"], float), np.array(exact["reference"], float)
    interpolant = np.array(exact["displacement"], float)
    to_means = [task.norm(means - task.strain(v)) for v in (u, reference)]
    nodes = [task.norm(task.strain(v - u)) for v in (interpolant, reference)]
    largest = max(abs(task.references()).max(), 1e-300)
    values = [abs(v).max(initial=0) / largest for v in (u[task.clamped], u - interpolant, u - reference)]
    a = np.trace(task.A, axis1=1, axis2=2).mean() / task.A.shape[1]
    shift = np.sqrt(a * task.volumes.sum()) / np.linalg.norm(np.ptp(task.vertices, axis=0)) * largest * values[0]
    return [*np.sqrt(exact["rest"] + np.square(to_means)), *nodes, float(shift), *values]


def _contact(equations: Equations) -> list[float]:
    """Return pressure error, penetration, error of the resultant, forces out of balance; all relative."""
    task, lam, mass = equations.task, equations.lam, equations.task.constraints()[2]
    p, total = task.exact_pressures(), np.array([one["resultant"] for one in task.data["judge"]], float)
    deepest = max(0.0, equations.gap.max())
    for piece, (normal, vertices, _) in zip(task.data["contact"], task.pieces(), strict=True):
        on_clamp = np.setdiff1d(np.array(piece["facets"], int), vertices)
        deepest = max(deepest, (equations.u[:, on_clamp] @ normal).max(initial=0))
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
    """Judge what a code reports with its displacements: names in ``REPORTS`` ↦ values (steps, m or pieces).

    Each is compared with the nodal forces that balance u (steps, n, d); a pressure may also have up to
    ``LARGE_PRESSURE`` times their error, as there are several ways to recover it.
    """
    if unknown := set(reports) - set(REPORTS):
        raise TaskError(f"unknown report {', '.join(sorted(unknown))}, expected {', '.join(REPORTS)}")
    if not reports or not (abs(u) < HUGE).all():
        return []
    equations, result = Equations(task, u / task.scale), []
    lam, mass = equations.lam, task.constraints()[2]
    rights = {"forces": lam, "pressure": lam / mass, "resultant": task.sums(lam)}
    axes = {name: "steps, contact vertices" for name in REPORTS} | {"resultant": "steps, pieces of Γ3"}
    given = {
        name: as_array(values, rights.get(name, lam).shape, f"reported {name} of {task.name}", axes[name])
        for name, values in reports.items()
    }
    for name, wanted in rights.items():
        if name in given:
            result.append(Report(name, *_compare(task, name, given[name] / task.scale, wanted)))
    if "status" in given:
        status, vertices = given["status"] != 0, task.constraints()[0]
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
    if (apart := abs(mine - wanted).max() / largest) <= AGREES:
        return True, f"reported {name}: agrees with what balances the displacements, up to {apart:.0e}"
    factor, ends = float((mine * wanted).sum() / max((wanted**2).sum(), 1e-300)), np.ones_like(mass)
    ends[mass < 0.75 * np.median(mass)] = 0.5
    mistakes = [("has the reversed sign", -wanted), ("is that of the step before", np.roll(wanted, 1, axis=0))]
    mistakes.append((f"is {written(factor)} times the right one", factor * wanted))
    if name != "resultant":
        mistakes.append(("takes full areas at the ends of the face, where half are right", wanted * ends))
        mistakes.append(("takes half areas at the ends of the face twice", wanted / ends))
        mistakes.append(("is a force, expected force over area", wanted * mass))
        mistakes.append(("is a pressure, expected pressure times area", wanted / mass))
    if not np.isfinite(mine).all():
        return False, f"reported {name}: not all are numbers"
    best, text = min((abs(mine - guess).max() / largest, text) for text, guess in mistakes)
    cause = f"; it {text} (difference {best:.0e} with this)" if best <= NAMED * apart else ""
    if name == "pressure" and not cause:
        mine_error, error = (np.sqrt((p - task.exact_pressures()) ** 2 @ mass).max() for p in (mine, wanted))
        if mine_error <= LARGE_PRESSURE * error:
            return True, f"reported {name}: {mine_error / error:.2g} times the error of what balances the displacements"
    return False, f"reported {name}: differs by {apart:.2g} from what balances the displacements{cause}"


@dataclass(frozen=True)
class Cause:
    """A cause that was tried: residuals with and without it over ``of``. Keys ``group:variant`` name equal causes."""

    key: str
    sentence: str
    residual: float
    without: float
    of: str = "the load"

    @property
    def rank(self) -> float:
        """Part of the residual that is left; infinite where that is no number."""
        return self.residual / self.without if self.residual < np.inf and self.without > 0 else np.inf


@dataclass(frozen=True)
class Diagnosis:
    """Why an answer differs: a sentence, its most likely causes (group ↦ words), and whether they are certain."""

    sentence: str
    causes: dict[str, str] = field(default_factory=dict)
    certain: bool = False

    def is_fault(self, share: float) -> bool:
        """Return whether the causes are certain and no consistent method, for a distance ``share`` of the error."""
        fitted = any(key.startswith(FITTED) or ODD in words for key, words in self.causes.items())
        method = any(key.startswith(METHODS) for key in self.causes)
        return self.certain and not method and (share > NEGLIGIBLE or not fitted)


def diagnose(tasks: list[Task], answers: list[np.ndarray]) -> Diagnosis:
    """Return the most likely cause of a difference from the solutions in K^h.

    The first two tasks whose answers differ are used. Causes are tried one by one, in the equations inside the body or,
    if these hold, in the contact algorithm. A cause is named if it leaves at most ``NAMED`` of the residual on both
    meshes; causes that explain the answers equally well are all named.
    """
    task, u = tasks[0], answers[0]
    for one, values in zip(tasks, answers, strict=True):
        if not (abs(values) < HUGE).all():
            return _not_numbers(one, values)
    exact, u = task.references(), u / task.scale
    equations = Equations(task, u)
    if on_clamp := _not_held(equations, exact):
        return on_clamp
    causes = {cause.key: cause for cause in equations.tried()}
    if len(tasks) > 1:
        again = {cause.key: cause for cause in Equations(tasks[1], answers[1] / tasks[1].scale).tried()}
        same = [(cause, again.get(key)) for key, cause in causes.items()]
        causes = {one.key: max(one, two or one, key=lambda c: c.rank) for one, two in same if two or not again}
    if named := _name(list(causes.values())):
        return named
    return _solver_tolerance(equations, exact, max((one.without for one in causes.values()), default=np.inf))


def _not_numbers(task: Task, values: np.ndarray) -> Diagnosis:
    """Return the diagnosis of an answer with values that are not numbers or too large.

    If most values of a step are not numbers, the matrix is singular. Otherwise, the first such value is named.
    """
    bad = ~(abs(values) < HUGE)
    step, vertex, axis = (int(k) for k in np.argwhere(bad)[0])
    where = f"The answer to {task.name} is not a number in step {step + 1}"
    if np.isfinite(values[step]).mean() < 0.5:
        words = "the matrix is probably singular: the body is not held, or one constraint is imposed twice"
        words += " (for example by wrong normals at a corner)"
        return Diagnosis(f"{where}; {words}", {"nan": words})
    found = f"u_{'xyz'[axis]} of vertex {vertex} in step {step + 1} is {values[step, vertex, axis]:g}"
    count = f"{bad.sum()} of {bad.size} values that are not numbers or too large"
    return Diagnosis(f"The answer to {task.name} has {count}: {found}")


def _name(causes: list[Cause]) -> Diagnosis | None:
    """Return the best of some causes, and those that are as good; None if none explains the answer."""
    first = min(causes, key=lambda cause: cause.rank, default=None)
    if not first or max(first.rank, first.residual) > HINTED:
        return None
    equal = [one for one in causes if one.residual <= max(10 * first.residual, 1e-9) and one.rank <= HINTED]
    equal = [one for one in equal if ODD not in one.sentence] or equal
    groups = {one.key.partition(":")[0]: one.sentence for one in reversed(equal)}
    groups, likely = dict(list(reversed(groups.items()))[:3]), first.rank <= NAMED
    head = "Most likely" if likely else "Perhaps"
    if len(groups) > 1:
        head = "Equally likely, another case tells them apart" if likely else "Perhaps one of these"
    numbers = f"up to {first.residual:.0e} of {first.of}; the right equations, up to {first.without:.2g}"
    sentence = f"{head}: {'; or '.join(groups.values())} (equations with this fault reproduce the answer {numbers})"
    return Diagnosis(sentence, groups if likely else {}, likely and first.residual <= CERTAIN)


def _not_held(equations: Equations, exact: np.ndarray) -> Diagnosis | None:
    """Return the cause where u on Γ1 is not zero: a rigid motion, or components or vertices that are not held."""
    task, u, largest = equations.task, equations.u, abs(exact).max()
    on_clamp, size = abs(u[:, task.clamped]).max(axis=0) / largest, abs(u).max() / largest
    wrong = on_clamp > AGREES
    if not wrong.any():
        return None
    if explained := _name([_rigid_motion(task, u, exact), *_other_formats(equations, largest)]):
        return explained
    free = equations.left(equations.full)
    free[:, task.clamped] = wrong * equations.full[:, task.clamped]
    certain = size > SINGULAR or equations.size(free) <= CERTAIN
    vertices, components = wrong.any(axis=1), wrong.any(axis=0)
    zero, moved = (" and ".join(str(k + 1) for k in np.flatnonzero(c)) for c in (~components, components))
    count, first = vertices.sum(), task.clamped[vertices][0]
    at = f"at all {count} vertices" if vertices.all() else f"at {count} of {len(vertices)} vertices (first {first})"
    what = f"component {moved}" if zero else "u"
    where = f"component {zero} is zero and {what} is not," if zero else "u is not zero"
    sure, large = certain or bool(zero), certain or on_clamp.max() > NEGLIGIBLE
    held = ("not held" if sure else "perhaps not held") if large else "not held exactly (a penalty?)"
    words = f"{what} is {held}{'' if vertices.all() else ' at some vertices'}"
    words += "" if sure or not large else ", or the vertices are in another order"
    sentence = f"On Γ1 {where} {at} of n = {task.data['level']}: {words}"
    of = "the largest displacement of the exact solution"
    if size > SINGULAR:
        sentence += f". The matrix is singular or nearly so, displacements are up to {size:.0e} times {of}"
    else:
        sentence += f"; u on Γ1 is up to {on_clamp.max():.2g} of {of}"
    return Diagnosis(sentence, {f"clamp {what} {vertices.all()}": f"on Γ1 {words}"} if certain else {}, certain)


def _other_formats(equations: Equations, largest: float) -> Iterator[Cause]:
    """Yield the causes that the numbers of the answer stand for something else, so that u on Γ1 is not zero.

    ``largest`` is the largest displacement of the exact solution. In a march, the history may follow from the right
    displacements or from the numbers of the answer (as in ``answer``).
    """
    task, u = equations.task, equations.u
    by_component = u.reshape(task.count, task.dim, -1).swapaxes(1, 2)
    order = "the answer has all u_x before all u_y, expected vertex after vertex"
    places = "the answer has deformed coordinates, expected displacements"
    without = max(abs(u[:, task.clamped]).max() / largest, equations.size(equations.total))
    for key, sentence, other in (("order", order, by_component), ("places", places, u - task.vertices / task.scale)):
        held = abs(other[:, task.clamped]).max() / largest
        for history, before in (("right", None), ("answer", equations.before)):
            left = equations.size(equations.left(equations.forces(u=other, before=before)))
            yield Cause(f"{key}:{history}", sentence, float(max(held, left)), float(without))


def _rigid_motion(task: Task, u: np.ndarray, exact: np.ndarray) -> Cause:
    """Return the cause that the body is moved by the rigid motion that fits u on Γ1 best."""
    largest = abs(exact).max()
    axes, x = np.eye(task.dim), task.vertices
    turns = [(x[:, i : i + 1] * axes[j] - x[:, j : j + 1] * axes[i]) for i, j in pairs(task.dim)[task.dim :]]
    modes = [np.tile(axis, (len(x), 1)) for axis in axes] + turns
    columns = np.array([mode[task.clamped].ravel() for mode in modes]).T
    fits = np.linalg.lstsq(columns, u[:, task.clamped].reshape(len(u), -1).T, rcond=None)[0].T
    apart, without = (abs(v - exact).max() / largest for v in (u - np.tensordot(fits, modes, 1), u))
    fit = max(fits, key=lambda one: abs(one).max())
    by = f"by ({', '.join(f'{x:.3g}' for x in fit[: task.dim])}), turned by {abs(fit[task.dim :]).max().round(12):.2g}"
    of = "the largest displacement of the exact solution"
    return Cause("rigid", f"the body is moved rigidly {by}", apart, without, of)


class Equations:
    """Forces that an answer leaves where none may be, split into the terms of the equations.

    ``u`` are the displacements (steps, n, d), loads not scaled, ``before`` those of the step before; ``full`` are the
    forces out of balance, ``total`` without what Γ1 and contact faces may carry; ``lam`` and ``gap`` are nodal contact
    forces, least squares where faces meet, and u_ν − gap, (steps, m).
    """

    def __init__(self, task: Task, u: np.ndarray) -> None:
        self.task, self.u, self.first = task, u, task.start()[None] / task.scale
        self.before = np.concatenate([self.first, u[:-1]]) if task.marches else 0 * u
        self.strain, self.strain_before = self._strains(u), self._strains(self.before)
        self.load = np.array([np.array(one["load"], float) for one in task.data["steps"]]) / task.scale
        if task.marches:
            self.stress = _times(task.history, self.strain_before)
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
            before = np.concatenate([self.first, u[:-1]])
        strain = self.strain if u is None else self._strains(u)
        if stress is None:
            old = self.strain_before if before is None else self._strains(before)
            changed = self.task.marches and (H is not None or before is not None)
            stress = _times(self.task.history if H is None else H, old) if changed else self.stress
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
        inside = np.delete(self.total, self.on_contact, axis=1)
        return self.size(inside) <= max(EQUATIONS_HOLD, 1e-4 * self.size(self.total))

    def tried(self) -> Iterator[Cause]:
        """Return all causes that the forces out of balance leave possible."""
        if self.size(self.total) <= EQUATIONS_HOLD:
            return contact_causes(self)
        return self.tilted() if self.only_on_contact() else self.causes()

    def causes(self) -> Iterator[Cause]:
        """Yield every cause inside the body with its residual."""
        without, count = self.size(self.total), self.task.count
        for key, sentence, changed in (*self._other_laws(), *self._other_data()):
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
            times = written(1 / (factor or 1e-300))
            sentence = f"the displacements are {times} times the right ones (other units?)"
            sentence += "" if self.task.marches else f", or the stiffness is {written(factor)} times the right one"
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
            yield (
                "viscous",
                "the viscous stress A ε(u̇) (or 1/k)",
                -self.internal(_times(task.A / task.data["step"], rate)),
            )
            yield "elastic", "the elastic stress G ε(u)", -self.internal(_times(task.G, mean))
        else:
            yield "units", "", elastic
        normal = np.multiply.outer(~shear, ~shear) * C[:, :1, 1:2]
        yield "lambda", "λ of the stiffness", -self.internal(_times(normal, self.strain))
        yield "mu", "μ of the stiffness", -self.internal(_times(C - normal, self.strain))
        voigt = "the shear part of the stiffness (√2 of Mandel's or γ = 2ε of Voigt's components)"
        yield "shear:rows", voigt, -self.internal(_times(C, self.strain) * shear)
        yield "shear:columns", voigt, -self.internal(_times(C, self.strain * shear))
        for i, j in np.argwhere(np.triu(abs(C).max(axis=0) > 0)):
            entry = np.zeros_like(C)
            entry[:, i, j], entry[:, j, i] = C[:, i, j], C[:, j, i]
            words = f"the entry C_{i + 1}{j + 1} of the stiffness (Mandel)"
            group = f"shear:{i}{j}" if i == j >= task.dim else f"entry {i}{j}"
            yield group, voigt if i == j >= task.dim else words, -self.internal(_times(entry, self.strain))

    def _other_laws(self) -> Iterator[tuple[str, str, Any]]:
        """Yield other stiffnesses C, factors H of the old strain, and exchanged axes."""
        task = self.task
        A, G, C, D = task.A, task.G, task.stiffness, task.G.shape[1]
        plain = {name: np.broadcast_to(np.array(task.data["law"][name]["matrix"], float), C.shape) for name in "AG"}
        a, g = plain["A"], plain["G"]
        if task.marches:
            k, place = task.data["step"], "in place of the midpoint rule"
            yield "scheme", f"backward Euler is used {place}", {"C": A / k + G, "H": -A / k}
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
            yield "plane stress", "plane stress is used in place of plane strain", {"C": _plane_stress(C)}
        for i, by in enumerate((np.sqrt(2), np.sqrt(0.5), 2.0, 0.5)):
            w = np.where(np.arange(D) < task.dim, 1.0, by)
            words = f"rows and columns of shear in the stiffness are multiplied by {by:.4g} (Voigt for Mandel?)"
            yield f"shear:both {i}", words, {"C": C * np.multiply.outer(w, w)}
            strain = w * _times(C, w * self.strain)
            for k, old in enumerate((self.stress, _times(task.history, w * self.strain_before))[: 1 + task.marches]):
                words = f"the shear strain is multiplied by {by:.4g} in the stiffness and the initial stress together"
                yield f"strain:{i} {k}", words, self.load - self.internal(strain + w * old)
        for i, j in pairs(task.dim)[task.dim :]:
            new, of = {i: j, j: i}, {frozenset(pair): k for k, pair in enumerate(pairs(task.dim))}
            order = [of[frozenset((new.get(a, a), new.get(b, b)))] for a, b in pairs(task.dim)]
            name = f"axes {i + 1} and {j + 1} are exchanged in the"
            yield f"axes:{i}{j}", f"{name} stiffness", {"C": C[:, order][:, :, order]}
            yield f"axes of stress:{i}{j}", f"{name} initial stress or history", {"stress": self.stress[..., order]}

    def _other_data(self) -> Iterator[tuple[str, str, Any]]:
        """Yield loads, initial stresses and histories of another step, and what the displacements may stand for."""
        task, u = self.task, self.u
        for by, words in ((1, "of the step before"), (-1, "of the next step")):
            steps = np.clip(np.arange(task.count) - by, 0, task.count - 1)
            yield f"load {by}", f"the load {words} is used", self.full - self.load + self.load[steps]
            if not task.marches:
                yield f"stress {by}", f"the initial stress {words} is used", {"stress": self.stress[steps]}
        yield "components", "u_x and u_y are exchanged in the answer", {"u": u[..., [1, 0, 2][: task.dim]]}
        for axis in range(task.dim):
            yield f"sign {axis}", f"u_{'xyz'[axis]} has the reversed sign", {"u": u * (1 - 2 * np.eye(task.dim)[axis])}
        if task.count > 1:
            yield "increments", "the answer has increments, expected totals", {"u": np.cumsum(u, axis=0)}
        if task.marches:
            older = np.concatenate([self.before[:1], self.before[:-1]])
            yield "u_{n-2}", "the history is that of the step before last, u_{n-2}", {"before": older}
            whole = [*self.first]
            for middle in u:
                whole.append(2 * middle - whole[-1])
            yield "middle", "u at the middle of the step is written, not at its end", {"u": np.array(whole[1:])}

    def _in_one_step(self, n: int) -> Iterator[Cause]:
        """Yield causes that act in step n alone, the only one whose equations do not hold."""
        at, steps = f"in step {n + 1} alone", slice(n, n + 1)
        old = "the stress of the previous step (of `start` in step 1)" if self.task.marches else "the initial stress"
        yield self._multiplied("stress once", f"{at} {old}", -self.initial, steps)
        yield self._multiplied("load once", f"{at} the load", self.load, steps)
        if n and self.task.marches:
            before = np.concatenate([self.before[:n], self.before[n - 1 : n], self.before[n + 1 :]])
            words = f"{at} the history is that of the step before last (a repeated or failed step?)"
            yield Cause("u_{n-2} once", words, self.size(self.left(self.forces(before=before))), self.size(self.total))

    def tilted(self) -> Iterator[Cause]:
        """Yield the cause of forces along the contact face: friction, or normals that are tilted at some vertices."""
        along = abs(self.total[:, self.on_contact]).max(axis=2)
        wrong, left, angles = np.flatnonzero(along.max(axis=0) > 1e-4 * along.max()), 0.0, []
        for k in wrong:
            forces = self.full[:, self.on_contact[k]]
            axis = np.linalg.svd(forces)[2][0]
            left = max(left, float(abs(forces - np.outer(forces @ axis, axis)).max()))
            angles.append(np.arcsin(min(np.linalg.norm(self.project[k] @ axis), 1.0)))
        named = f"vertices {', '.join(map(str, self.on_contact[wrong][:5]))}"
        sentence = f"friction, or normals tilted by {min(angles):.3g} to {max(angles):.3g} at {named}"
        if len(wrong) == 1:
            sentence = f"the normal at {named} is tilted by {angles[0]:.3g}: contact acts along ±{np.round(axis, 3)}"
        if (along[:, wrong] > 1e-6 * along.max()).sum(axis=0).max() > 1:
            yield Cause("tilt", sentence, left / self.largest, self.size(self.total))


def _times(C: np.ndarray, strain: np.ndarray) -> np.ndarray:
    return np.einsum("cij,scj->sci", C, strain)


def _plane_stress(C: np.ndarray) -> np.ndarray:
    """Return the matrix of plane stress with the constants μ and λ of a matrix of plane strain."""
    mu, lam, result = C[:, 2, 2] / 2, C[:, 0, 1], C.copy()
    result[:, 0, 1] = result[:, 1, 0] = 2 * mu * lam / (lam + 2 * mu)
    result[:, 0, 0] = result[:, 1, 1] = 2 * mu + result[:, 0, 1]
    return result


def factor_words(factor: float) -> str:
    """Return what a factor means: 0 is missing, −1 has the reversed sign."""
    known = {0.0: "is missing", -1.0: "has the reversed sign", 2.0: "is counted twice", 0.5: "is halved"}
    known |= {2**0.5: "is multiplied by √2", 0.5**0.5: "is divided by √2"}
    return next((words for value, words in known.items() if abs(factor - value) < 1e-4), f"{ODD} {written(factor)}")


def written(factor: float) -> str:
    """Return a factor with four digits, or with as many as show two digits of its difference from 1."""
    apart = abs(abs(factor) - 1)
    return f"{factor:.{min(max(4, 2 - math.floor(math.log10(apart))), 15) if apart > 0 else 4}g}"


def _solver_tolerance(equations: Equations, exact: np.ndarray, contact: float) -> Diagnosis:
    """Return that the solver stopped early, for a small difference without structure in space; or that no cause fits.

    ``contact`` is the difference of the contact forces over the largest, where the equations inside the body hold.
    """
    task, apart = equations.task, equations.u - exact
    size, left = abs(apart).max() / abs(exact).max(), equations.size(equations.total)
    if left <= EQUATIONS_HOLD:
        if contact <= HINTED:
            differ = f"no other cause that was tried fits, and contact forces differ by {contact:.0e} of the largest"
            return Diagnosis(f"Perhaps: the iterations for contact stop too early: {differ}")
        return Diagnosis("No single cause that was tried explains it: the contact algorithm differs")
    unknown = Diagnosis(f"No single cause that was tried explains it: forces of {left:.2g} of the load are left")
    if size > 0.01 or equations.only_on_contact():
        return unknown
    share = np.bincount(task.cells.ravel(), np.repeat(task.volumes / (task.dim + 1), task.dim + 1))
    a = np.trace(task.A, axis1=1, axis2=2).mean() / task.A.shape[1]
    rough = [task.norm(task.strain(v)) / max(np.sqrt(a * share @ (v**2).sum(axis=1)), 1e-300) for v in apart]
    numbers = f"displacements differ by {size:.0e} of the largest, forces of {left:.0e} of the load are left everywhere"
    words = "the solver stops too early"
    if max(rough) * task.data["h"] > ROUGH:
        sentence = f"Most likely: {words}, at too large a tolerance: {numbers}, without pattern in space"
        return Diagnosis(sentence, {TOLERANCE: words})
    return Diagnosis(f"Perhaps: {words}: {numbers}") if left < 0.01 else unknown


class ContactProblem:
    """The contact problem of an answer on the contact faces: gap = free − W λ, with its history; ``right`` is its λ."""

    def __init__(self, equations: Equations) -> None:
        self.task = task = equations.task
        self.vertices, normals, self.mass, self.initial = task.constraints()
        d, n, m = task.dim, task.vertices.size, len(self.vertices)
        N = np.zeros((m, n))
        N[np.arange(m)[:, None], d * self.vertices[:, None] + np.arange(d)] = normals
        self.lam, self.gap = equations.lam, equations.gap
        unknown = np.setdiff1d(np.arange(n), np.add.outer(d * task.clamped, np.arange(d)))
        forces = (equations.load - equations.initial).reshape(task.count, -1)
        units = np.eye(n)[unknown].reshape(-1, *task.vertices.shape)
        forces_of = (task.internal(np.einsum("cij,cj->ci", task.stiffness, task.strain(one))) for one in units)
        K = np.array([one.ravel()[unknown] for one in forces_of])
        solved = np.linalg.solve(K, np.concatenate([N[:, unknown].T, forces[:, unknown].T], axis=1))
        self.W, self.free = N[:, unknown] @ solved[:, :m], (N[:, unknown] @ solved[:, m:]).T - self.initial
        self.right = self.each()
        self.largest = max(abs(self.right).max(), abs(self.lam).max(), 1e-300)
        self.pressed = self.lam > AGREES * self.largest

    def each(self, free: Any = None, starts: Any = None, **options: Any) -> np.ndarray:
        """Return λ of all steps, (steps, m), by ``active_set`` with its options and one start for each step."""
        free = self.free if free is None else free
        starts = [None] * len(free) if starts is None else starts
        return np.array([active_set(self.W, one, start, **options) for one, start in zip(free, starts, strict=True)])

    def named(self, rows: np.ndarray) -> str:
        """Return the number of some constraints and the first of their vertices."""
        first = ", ".join(map(str, self.vertices[rows][:5]))
        return f"{rows.sum()} vertices ({first}{', …' if rows.sum() > 5 else ''})"


def active_set(
    W: np.ndarray, free: np.ndarray, start: Any = None, updates: int = 60, release: bool = True, tied: Any = None
) -> np.ndarray:
    """Return λ ≥ 0 with gap = free − W λ ≤ 0 by a primal-dual active set; tied vertices are held and may pull."""
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
    without = abs(problem.lam - problem.right).max() / problem.largest
    for guesses in (_wrong_laws, _wrong_sets, _wrong_places) if without > CONTACT_HOLDS else ():
        for key, sentence, lam in guesses(problem):
            residual = float(abs(problem.lam - lam).max() / problem.largest)
            yield Cause(key, sentence, residual, float(without), "the largest contact force")


def _wrong_laws(problem: ContactProblem) -> Iterator[tuple[str, str, np.ndarray]]:
    """Yield contact that obeys another law at all vertices, or that of another step."""
    right, every = problem.right, np.ones(len(problem.mass), bool)
    yield "none", "contact is missing: no contact forces act", 0 * right
    yield "normals", "the normals are reversed: contact acts on the wrong side", -problem.each(-problem.free)
    yield "pull:tied", "contact pulls: u_ν = 0 on the whole face, no vertex lifts off", problem.each(tied=every)
    alike = "for each vertex, whatever its area (half at the ends)"
    for by in (0.5, 2.0):
        ends = np.where(problem.mass < 0.75 * np.median(problem.mass), by, 1.0)
        yield f"ends {by}", f"the contact forces at the ends of the face are {by:g} times the right ones", ends * right
    if problem.pressed.any():
        factor = float((problem.lam * right).sum() / max((right**2).sum(), 1e-300))
        words = f"the contact forces that act on the body are {written(factor)} times the right ones"
        yield "scaled", words, factor * right
        offset = float(np.median(problem.gap[problem.pressed]))
        words = f"contact is closed where u_ν − gap is {offset:.4g} (an offset or a tolerance), not 0"
        yield "offset", words, problem.each(problem.free - offset)
    for gap, pull in ((np.maximum(problem.gap, 0), ""), (problem.gap, " that also pull")):
        for area, words in ((problem.mass, "for each area"), (np.ones_like(problem.mass), alike)):
            k = float((problem.lam * area * gap).sum() / max(((area * gap) ** 2).sum(), 1e-300))
            sentence = f"contact is by springs{pull} (a penalty) of stiffness {k:.4g} {words}"
            yield f"springs {words}:{pull}", sentence, k * area * gap if k > 1e-9 else right
    areas = problem.each(problem.free + problem.initial - problem.mass / problem.task.scale)
    yield "gap areas", "the areas of the contact vertices are taken for the initial gaps", areas
    if problem.initial.any():
        for by, words in ((-1, "taken with the reversed sign"), (0, "forgotten"), (2, "counted twice")):
            free = problem.free + (1 - by) * problem.initial
            yield f"gap {by}", f"the initial gap is {words}", problem.each(free)
    if len(right) > 1:
        words = "contact is one step late: the contact"
        yield "late:forces", f"{words} forces are those of the step before", np.concatenate([0 * right[:1], right[:-1]])
        late = problem.each(starts=[problem.pressed[0], *(right[:-1] > 0)], updates=0)
        yield "late:vertices", f"{words} vertices are those of the step before", late
        only, first = np.arange(len(right))[:, None] == 0, [problem.pressed[0]] * len(right)
        yield "first:only", "contact acts in the first step only", only * right
        yield "first:missing", "contact is missing in the first step", ~only * right
        yield "first:forces", "the contact forces of the first step are kept in all steps", right[:1] + 0 * right
        kept = "the vertices in contact are found in the first step only and kept in all steps"
        yield "first:vertices", kept, problem.each(starts=first, updates=0)


def _wrong_sets(problem: ContactProblem) -> Iterator[tuple[str, str, np.ndarray]]:
    """Yield active sets that are never released, or not iterated to the end."""
    none = np.zeros(len(problem.mass), bool)
    pulls = "vertices in contact are never released, although their forces pull"
    yield "pull:iterations", pulls, problem.each(release=False)
    acted = np.logical_or.accumulate(abs(problem.lam) > AGREES * problem.largest, axis=0)
    yield "pull:steps", pulls, problem.each(starts=[none, *acted[:-1]], release=False)
    pulled = (problem.lam < -AGREES * problem.largest).any(axis=0)
    if pulled.any() and not pulled.all():
        words = f"contact pulls at {problem.named(pulled)}, which cannot lift off"
        yield "pull:some", words, problem.each(tied=pulled)
    starts = (("no vertex", none), ("all vertices", ~none), ("the vertices of the step before", None))
    for updates, times in ((1, "once"), (2, "twice"), (3, "three times")):
        for words, start in starts:
            before = [none, *problem.pressed[:-1]] if start is None else [start] * len(problem.lam)
            lam = problem.each(starts=before, updates=updates)
            sentence = f"the active set is updated only {times} in each step, starting from {words}"
            yield f"updates:{updates} {words}", sentence, lam


def _wrong_places(problem: ContactProblem) -> Iterator[tuple[str, str, np.ndarray]]:
    """Yield constraints that are missing at vertices, imposed on means over facets, or with averaged normals."""
    eye, unloaded = np.eye(len(problem.mass)), (abs(problem.lam) <= AGREES * problem.largest).all(axis=0)
    entered = (problem.gap > AGREES * abs(problem.gap).max()).any(axis=0)
    rows: list[tuple[str, str, np.ndarray]] = []
    if (forgotten := unloaded & entered).any() and not unloaded.all():
        words = f"the constraint is forgotten at {problem.named(forgotten)}"
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


def orders(h: list[float], errors: list[float]) -> list[float]:
    """Return the orders between neighbouring meshes; infinite where nothing is left."""
    steps = zip(h, h[1:], errors, errors[1:], strict=False)
    return [float(np.log(a / b) / np.log(k / m)) if min(a, b) > 0 else float("inf") for k, m, a, b in steps]


def order(h: list[float], errors: list[float]) -> float:
    """Return the order between the last two meshes; nan from one mesh."""
    return orders(h, errors)[-1] if len(h) > 1 else float("nan")


@dataclass(frozen=True)
class Judgement:
    """A code on one case, mesh by mesh; orders between the last two meshes, ``order_of_best`` that of K^h.

    ``why`` has the reason of the verdict, ``cause`` the most likely reason of a difference or "", ``causes`` its parts.
    ``tested`` says how many constraints of the exact solution are in contact at some step on the last mesh, are free at
    some step, and exist. ``invariance`` is the largest distance between answers under two load scales over the
    discretisation error, nan with one scale.
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
    causes: dict[str, str] = field(default_factory=dict)

    def outcome(self, tolerance: float = 0.0) -> str:
        """Return holds (class of ``GOOD``, or distance of at most ``tolerance`` on all meshes), fails or undecided."""
        within = max(one.share for one in self.errors) <= tolerance and self.verdict != "wrong"
        if not all(report.right for report in self.reports):
            return "fails"
        return "holds" if self.verdict in GOOD or within else "undecided" if self.verdict == "undecided" else "fails"


def classify(h: list[float], errors: list[Errors]) -> str:
    """Return the class of a code from its errors, mesh by mesh (docs/how-to/verify-a-contact-code.md)."""
    return judged(h, errors)[0]


def wrong_mesh(h: list[float], errors: list[Errors]) -> tuple[int, str] | None:
    """Return the index of the first mesh whose answer is far off, and the reason in words.

    The last mesh is not tested. The result is None if no answer is far off.
    """
    distances = [one.share * one.best for one in errors]
    fall = orders(h, distances)
    for k, one in enumerate(errors[:-1]):
        large = one.share > LARGE_SHARE
        peak = k > 0 and fall[k - 1] < -FALLS and one.share > PEAK
        falls = fall[k] > JUMP and distances[k] > FACTOR * distances[k + 1]
        if large and one.on_clamp > LARGE_ON_CLAMP:
            return k, f"u on Γ1 must be 0, it is up to {one.on_clamp:.1e} of the largest displacement"
        if one.from_best > FAR:
            return k, f"displacements are wrong by up to {one.from_best:.0e} times the largest of the exact solution"
        if large and one.tangential >= UNBALANCED:
            return k, f"forces of {one.tangential:.2g} of the load where none may be"
        if falls and (peak or large):
            return k, f"the distance is {one.share:.1e} of the error, on the next mesh {errors[k + 1].share:.1e}"
    return None


def judged(h: list[float], errors: list[Errors], levels: list[int] | None = None) -> tuple[str, str]:
    """Return the class, and the numbers that decided; a mesh is named by its level n, or without ``levels`` by h."""

    def mesh(k: int) -> str:
        return f"n = {levels[k]}" if levels else f"h = {h[k]:.3g}"

    shares, last = [one.share for one in errors], errors[-1]
    if not np.isfinite(shares).all():
        (bad, *others) = np.flatnonzero(~np.isfinite(shares))
        more = f" and on {len(others)} other meshes" if others else ""
        return "wrong", f"values are not numbers or too large {ON_THE_MESH} {mesh(int(bad))}{more}"
    if max(shares) <= EXACT and max(one.from_best for one in errors) <= 10 * EXACT:
        return EXACT_CLASS, f"{max(shares):.0e} of the error"
    falls = order(h, [one.on_clamp for one in errors]) >= FALLS and last.on_clamp < LARGE_ON_CLAMP
    if shares[-1] > NEGLIGIBLE and last.on_clamp > AGREES and not falls:
        at = f"{last.on_clamp:.1e} of the largest displacement of the exact solution"
        return "wrong", f"u on Γ1 must be 0, on the finest mesh it is up to {at}"
    if last.from_best > FAR:
        return "wrong", f"displacements are wrong by up to {last.from_best:.0e} times the largest of the exact solution"
    if len(h) < 2:
        return "undecided", f"one mesh, not exact: {shares[-1]:.1e} of the error"
    fall = orders(h, [one.share * one.best for one in errors])
    if fall[-1] < -FALLS and shares[-1] > NEGLIGIBLE:
        return "wrong", f"grows with order {-fall[-1]:.1f}, {shares[-1]:.1e} of the error"
    if last.pressure >= NO_CONTACT:
        return "wrong", f"pressure no better than none, error {last.pressure:.2f}"
    if last.tangential >= OTHER_EQUATIONS:
        return "wrong", f"other equations, forces of {last.tangential:.2g} of the load where none may be"
    if found := wrong_mesh(h, errors):
        return "wrong", f"{ON_THE_MESH} {mesh(found[0])} {found[1]}"
    pressure, of_best = (order(h, [getattr(one, name) for one in errors]) for name in ("pressure", "best_pressure"))
    needed = min(FALLS, max(order(h, [one.best for one in errors]) / 2, LEAST_FALL))
    told = f"order of the distance {', '.join(f'{round(one, 1) + 0.0:.1f}' for one in fall)}"
    if len(h) < MESHES:
        return "undecided", f"{told} from {len(h)} meshes; {MESHES} meshes are needed"
    if fall[-1] < needed and shares[-1] > EXACT:
        return "stagnates", f"at {shares[-1]:.1e} of the error, {told}"
    if pressure < min(PRESSURE_FALLS, of_best - NECESSARY):
        return "stagnates", f"in the pressure, order {pressure:.1f}"
    return CONSISTENT, told


def assess(
    tasks: list[Task], answers: dict[str, np.ndarray], reports: dict[str, dict[str, np.ndarray]] | None = None
) -> list[Judgement]:
    """Return one judgement for each case, mesh family and mode; TaskError if an answer is missing or of another shape.

    answers are names of tasks ↦ u, (steps, n, d); reports names of tasks ↦ what ``judge_reports`` takes.
    """
    groups: dict = defaultdict(lambda: defaultdict(list))
    answers = dict(answers)
    for task in tasks:
        data, shape = task.data, (task.count, *task.vertices.shape)
        axes, what = "steps, vertices, components", f"the answer to {task.name}"
        if task.name not in answers:
            raise TaskError(f"{what} is missing, expected {shape}: {axes}")
        answers[task.name] = as_array(answers[task.name], shape, what, axes)
        groups[data["case"], data["family"], data["mode"]][data["level"]].append(task)
    return [_judgement(key, levels, answers, reports or {}) for key, levels in groups.items()]


def _verdict(tasks: list[Task], answers: dict) -> tuple[list[Errors], str, str, Diagnosis]:
    """Return the errors on the meshes of one load scale, the class, its reason, and the cause of a difference."""
    h, levels = [task.data["h"] for task in tasks], [task.data["level"] for task in tasks]
    errors = [measure(task, answers[task.name]) for task in tasks]
    verdict, why = judged(h, errors, levels)
    differing = [task for task, one in zip(tasks, errors, strict=True) if not one.share <= EXACT]
    cause = diagnose(differing, [answers[task.name] for task in differing]) if differing else Diagnosis("")
    clamp = any(key.startswith("clamp") for key in cause.causes)
    if cause.is_fault(errors[-1].share) and (verdict in ("undecided", CONSISTENT) or clamp):
        verdict = "wrong"
    if verdict == "undecided" and TOLERANCE in cause.causes:
        why += "; first reduce the tolerance of the solver"
    if cause.certain and verdict == "wrong":
        why = "; or ".join(cause.causes.values()) + (f": {why}" if why.startswith(ON_THE_MESH) else "")
    return errors, verdict, why, cause


def _apart(tasks: list[Task], answers: dict, best: float) -> list[float]:
    """Return distances between answers to one problem under different load scales on one mesh, over the error best."""
    (first, *others), result = tasks, []
    for task in others:
        same = task.count == first.count and np.allclose(task.references(), first.references())
        if same and task.scale != first.scale:
            both = answers[first.name] / first.scale - answers[task.name] / task.scale
            result += [first.norm(first.strain(v)) / best for v in both]
    return result


def _judgement(key: tuple, levels: dict, answers: dict, reports: dict) -> Judgement:
    """Judge one case on one mesh family in one mode."""
    numbers, series = sorted(levels), defaultdict(list)
    for n in numbers:
        count: dict = defaultdict(int)
        for task in levels[n]:
            series[task.scale, count[task.scale]].append(task)
            count[task.scale] += 1
    found = [(tasks, *_verdict(tasks, answers)) for tasks in series.values()]
    decided = [one for one in found if one[2] != "undecided" or len(one[0]) == len(numbers)] or found
    first, errors, verdict, why, cause = max(decided, key=lambda one: CLASSES.index(one[2]))
    h = [task.data["h"] for task in first]
    best = {task.name: one.best for tasks, each, *_ in found for task, one in zip(tasks, each, strict=True)}
    apart = [one for n in numbers for one in _apart(levels[n], answers, best[levels[n][0].name])]
    invariance = max((one for one in apart if not np.isnan(one)), default=float("nan"))
    if len({scale for scale, _ in series}) > 1 and verdict != EXACT_CLASS:
        why += f", with the load scale {first[0].scale:g}"
    if verdict in (*GOOD, "undecided") and invariance > LARGE_SHARE:
        verdict, why = "wrong", f"answers under two load scales differ by {invariance:.1e} of the error"
    last = [order(h, [getattr(one, name) for one in errors]) for name in ("error", "best", "distance", "pressure")]
    every = [task for n in numbers for task in levels[n]]
    told = [one for task in every for one in judge_reports(task, answers[task.name], reports.get(task.name, {}))]
    own = tested(first[-1]), *last, invariance, cause.sentence, told, cause.causes
    return Judgement(*key, [task.data["level"] for task in first], errors, verdict, why, *own)


def unpack(task: Task, directory: Path) -> None:
    """Write a task as text files, for programs that read no JSON: what the page on the format lists."""
    place = Path(directory) / task.name
    place.mkdir(parents=True, exist_ok=True)
    files = {"cells": task.cells, "clamped": task.clamped, "vertices": task.vertices}
    pieces = zip(task.data["contact"], task.pieces(), task.gaps(), strict=True)
    for i, (piece, (normal, vertices, _), gap) in enumerate(pieces, start=1):
        files |= {f"contact_{i}": np.array(piece["facets"], int), f"gap_{i}": gap}
        files |= {f"constrained_{i}": vertices, f"normal_{i}": normal[None]}
    tensors = {"stiffness": task.stiffness} | ({"A": task.A, "G": task.G} if task.marches else {})
    files |= {name: one.reshape(len(task.cells), -1) for name, one in tensors.items()}
    if task.marches:
        files |= {"start": task.start(), "step": np.array([task.data["step"]])}
    for n in range(task.count):
        load, stress = task.step(n, task.start())
        files |= {f"load_{n + 1}": load} | ({} if task.marches else {f"initial_stress_{n + 1}": stress})
    for name, values in files.items():
        np.savetxt(place / f"{name}.txt", values, fmt="%d" if values.dtype.kind == "i" else "%.17g")


def table(judgements: list[Judgement], tolerance: float = 0.0) -> str:
    """Return what the judgements say, in lines; numbers are those of the last mesh."""
    head = f"{'case':<22}{'meshes':<13}{'mode':<7}{'n':<9}{'V order':>8}{'distance':>10}{'pressure':>10}{'of K^h':>8}"
    lines = [f"{head}{'exact pressed':>15}{'exact free':>12}  class"]
    for one in judgements:
        last, (pressed, free, count) = one.errors[-1], one.tested
        numbers = f"{one.order_in_v:8.2f}{last.share:10.1e}{last.pressure:10.3f}{last.best_pressure:8.3f}"
        levels = " ".join(map(str, one.levels))
        reached = f"{f'{pressed}/{count}':>15}{f'{free}/{count}':>12}"
        what = f"{one.verdict} ({one.why})"
        if one.verdict not in GOOD and one.outcome(tolerance) == "holds":
            what += f", passes: at most {tolerance:g} of the error"
        lines += [f"{one.case:<22}{one.family:<13}{one.mode:<7}{levels:<9}{numbers}{reached}  {what}"]
        lines += [f"    {note}" for note in notes(one)]
    return "\n".join([*lines, *summary(judgements)])


def summary(judgements: list[Judgement]) -> list[str]:
    """Return a line that names the cause that explains most cases; none for one case, or without such a cause."""
    keys = [key for one in judgements for key in one.causes]
    if len(judgements) < 2 or not keys:
        return []
    best = max(keys, key=keys.count)
    every = dict.fromkeys(one.causes[best] for one in judgements if best in one.causes)
    first, *others = every
    words = without_numbers(first) if others else first
    exact = dict.fromkeys(one.case for one in judgements if one.verdict == EXACT_CLASS)
    rest = [one for one in judgements if one.verdict != EXACT_CLASS and best not in one.causes]
    kinds = {without_numbers(one) for one in every}
    hinted = [one for one in rest if any(kind in without_numbers(one.cause) for kind in kinds)]
    perhaps = dict.fromkeys(one.case for one in hinted)
    other = dict.fromkeys(one.case for one in rest if one not in hinted)
    line = f"{keys.count(best)} of {len(judgements)} cases: {words}"
    line += f"; perhaps also {', '.join(perhaps)}" if perhaps else ""
    line += f"; {', '.join(exact)} cannot show it" if exact else ""
    return [line + (f"; it does not explain {', '.join(other)}" if other else "")]


def without_numbers(words: str) -> str:
    """Return the words of a cause without numbers of steps and vertices and without fitted numbers."""
    words = re.sub(r" \([^()]*(?<![\w.√])[-±]?\d[^()]*\)", "", words)
    words = re.sub(r"\d+ vertices", "some vertices", words)
    return re.sub(r"(?<![\w.√/{])[-±]?\d+(\.\d+)?(e[-+]?\d+)?(?![\w./}])", "…", words)


def notes(one: Judgement) -> list[str]:
    """Return what the class does not say: the most likely cause first."""
    last, unknown = one.errors[-1], one.verdict == CONSISTENT and one.cause.startswith("No single cause")
    causes = "; or ".join(one.causes.values())
    explained = one.verdict == "wrong" and causes and one.why.startswith(causes)
    lines = [one.cause.removeprefix(f"Most likely: {causes} ") if explained else one.cause]
    lines = lines if one.cause and not unknown else []
    if not np.isnan(one.invariance):
        lines.append(f"load scales differ by {one.invariance:.1e} of the error")
    told = [report.sentence for report in one.reports]
    if explained:
        return lines + list(dict.fromkeys(told))
    if abs(one.order_in_v - one.order_of_best) > NECESSARY:
        both = f"{one.order_in_v:.2f}, of the solution in K^h {one.order_of_best:.2f}"
        lines.append(f"the observed order of the error in V is {both}: a right code has the same order")
    if last.idle:
        named = ", ".join(map(str, last.idle[:5])) + (", …" if len(last.idle) > 5 else "")
        lines.append(f"vertices that are pressed and carry next to nothing: {len(last.idle)} ({named})")
    if one.verdict == CONSISTENT and last.share > LARGE_SHARE:
        lines.append(f"the distance tends to 0, but on the last mesh it is still {last.share:.0%} of the error")
    if one.verdict == CONSISTENT and last.pressure > LARGE_PRESSURE * last.best_pressure:
        times = last.pressure / last.best_pressure
        lines.append(f"the pressure has {times:.0f} times the error of the solution in K^h")
    if FEW_FORCES < last.tangential < OTHER_EQUATIONS:
        why = "terms inside the body (Nitsche), contact at deformed places (smaller loads?), or other equations"
        lines.append(f"forces of {last.tangential:.1e} of the load where none may be: {why}")
    if one.verdict not in GOOD and NEGLIGIBLE < last.penetration < np.inf:
        lines.append(f"the body enters the foundation by {last.penetration:.2g} of the answer's largest displacement")
    return lines + list(dict.fromkeys(told))


def as_json(judgements: list[Judgement], tolerance: float = 0.0) -> str:
    """Return all numbers as JSON (docs/reference/contact-verdict.schema.json); what is no number is null."""
    rows = [asdict(one) | {"outcome": one.outcome(tolerance)} for one in judgements]
    return json.dumps(json.loads(json.dumps(rows), parse_constant=lambda _: None), indent=1, allow_nan=False)


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
    return ElementTree.tostring(suite, encoding="unicode", xml_declaration=True) + "\n"


def main(arguments: list[str] | None = None) -> int:
    """Run the command; 0 all hold, 1 one fails, 2 usage or input, 3 one is undecided."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("tasks", type=Path, metavar="TASKS", help="directory of `study export`")
    parser.add_argument("answers", type=Path, metavar="ANSWERS", help="directory with NAME/u.txt for each task")
    parser.add_argument("--unpack", action="store_true", help="write the tasks to ANSWERS as text files")
    parser.add_argument("--tolerance", type=float, default=0.0, metavar="X", help="pass X of the discretisation error")
    parser.add_argument("--json", action="store_true", help="print all numbers as JSON")
    parser.add_argument("--junit", type=Path, metavar="FILE", help="also write the verdicts as JUnit XML")
    options = parser.parse_args(arguments)
    for stream in (one for one in (sys.stdout, sys.stderr) if hasattr(one, "reconfigure")):
        stream.reconfigure(errors="backslashreplace")  # A terminal in ASCII or cp1252 has no Γ.
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
            options.junit.write_text(printable(as_junit(judgements, options.tolerance)), encoding="utf-8")
    except (TaskError, OSError) as error:
        unreadable = isinstance(error, OSError) and f"cannot read or write {error.filename}: {error.strerror or error}"
        print(printable(f"contact_judge: {unreadable or error}"), file=sys.stderr)
        return 2
    text = as_json(judgements, options.tolerance) if options.json else table(judgements, options.tolerance)
    print(printable(text))
    outcomes = [one.outcome(options.tolerance) for one in judgements]
    return 1 if "fails" in outcomes else 3 if "undecided" in outcomes else 0


if __name__ == "__main__":
    sys.exit(main())
