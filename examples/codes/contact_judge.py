"""Judge a contact code on problems whose exact solutions are known. One file that needs NumPy alone: copy it.

    python contact_judge.py TASKS ANSWERS [--only CASE …] [--tolerance X] [--plot FILE.svg] [--json] [--junit FILE]
    python contact_judge.py --unpack TASKS DIR

The first command prints errors, classes, where the equations are violated, and the cause if one explains it. The second
writes the tasks as text files.

TASKS holds files *.json.xz in the format contact-task 2 or 1 (docs/reference/tasks.md), ANSWERS for the task
NAME.json.xz a file NAME/u.txt: one line for each step, with u_x u_y (u_z) of vertex after vertex, and optionally what
the code reports about contact. From Python, ``answer`` drives a code and ``assess`` judges it
(docs/reference/tasks.md). Exit codes: 0 all series pass, 1 one fails, 2 usage or input, 3 undecided.
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
import signal
import sys
import zlib
from collections import defaultdict
from collections.abc import Callable
from dataclasses import asdict, dataclass, field, replace
from fnmatch import fnmatch
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

Array = np.ndarray
EXACT = 1e-5
"""Distance from the solution in K^h over the discretisation error up to which a code is exact for P1."""
FALLS = 0.5
LEAST_FALL = 0.2
"""Order from which on a distance falls, or grows: half of that of the error if this is below 1, but at least 0.2."""
PRESSURE_FALLS = 2 / 3
"""Order from which on the error of the pressure falls, unless that of the solution in K^h falls more slowly."""
MESHES = 3
"""Meshes without which nothing is said of an order: on two, what falls fast hides what does not fall."""
NEGLIGIBLE = 0.01
NO_CONTACT = 0.9
"""Part of the error up to which a distance may grow (quadrature, iterations); pressure error of about no contact, 1."""
OTHER_EQUATIONS = 0.1
UNBALANCED = 0.3
FEW_FORCES = 1e-3
"""Part of the load where no force may be, to be wrong on the last mesh, on a coarser mesh, and to be mentioned;
Nitsche's methods leave some hundredths."""
NECESSARY = 0.15
LARGE_PRESSURE = 3
LARGE_SHARE = 0.3
"""Distance of two orders that are the same; times the error of K^h from which on a pressure is mentioned; distance over
the error of K^h from which on it is mentioned."""
AGREES = 1e-6
NAMED = 1e-3
LARGEST_LEFT = 0.05
SEEN = 1e-3
"""Relative difference up to which what a code reports agrees with its displacements: six digits in a text file; part of
the residual that a cause may leave to be most likely; largest residual of such a cause over the load; part of the
largest force from which on forces remain at a vertex, and of the largest change of a factor for it not to be 1."""
CERTAIN = 1e-8
LARGE_ON_CLAMP = 0.3
FAR = 100
SINGULAR = 1e6
"""Residual up to which a cause is certain. Over the largest displacement of the exact solution: u on Γ1 of order 1,
displacements that are wrong on every mesh, displacements that only a singular matrix gives."""
JUMP = 6
FACTOR = 50
PEAK = 0.1
"""Order and factor above which no distance falls from a large share of the error: the coarser mesh is then wrong. Share
above which this holds where the distance grew before; integral multipliers may be exact on some meshes, and 0.02 off on
others."""
METHODS = "springs", "smooth", "barrier", "augmented", "facets", "digits"
FITTED = "units", "scaled", "offset", "tilt", "rigid", "coordinates"
"""Causes that may be consistent methods; causes with a number fitted to the answer, which may tend to the right one."""
EQUATIONS_HOLD = 1e-6
CONTACT_HOLDS = 1e-10
"""Forces over the load where none may be, and differences of contact forces over the largest, that need no cause."""
ROUGH = 0.5
SPREAD = 0.2
ROUNDED = 200
"""Largest force over C ‖v‖ h^(d−2) from which on a difference v changes from vertex to vertex (h² if it is smooth);
(Σ |r|)² / (n Σ r²) from which on forces r are spread over all n free unknowns (2/π for random ones); largest force over
the rounding of single precision, for it to be this rounding (0.8 to 3.7 were measured where the stiffness was
rounded, 6 to 130 where the solver was)."""
LARGEST_SOLVE = 1500
MOST_PARTS = 300
"""Components of u up to which the judge solves the contact problem itself, to try causes in the contact algorithm;
factors that are fitted at once."""
HUGE = 1e100
"""Value from which on a number is no displacement; its square would still be finite."""
GOOD = EXACT_CLASS, CONSISTENT = "exact for P1", "consistent"
OPEN: dict[str, Callable] = {".xz": lzma.open, ".gz": gzip.open}
PACKING = 100
UNSUSPICIOUS = 2**28
"""A file may unpack to so many times its size. Files that unpack to at most 256 MiB may have any ratio."""
INVISIBLE = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\xad\u061c\u180e\u200b-\u200f\u2028-\u202e\u2060-\u206f\ud800-\udfff\ufeff"
    "\ufff9-\uffff\U000e0000-\U000e007f]"
)
"""Characters that command a terminal, are not seen or may not stand in XML, as in ``convergence_orders.printing``."""
NO_NUMBER = (
    (
        r"\*",
        "stands for a number that needs more room, {expected}; use a wider format, such as ES25.16 in Fortran",
    ),
    (
        r";|,.*,|,$",
        "has commas or semicolons between the numbers, {expected}; write blanks in their place",
    ),
    (
        ",",
        "has a comma, {expected}; write decimal points, and blanks between the numbers",
    ),
    (
        "",
        "is not a number, {expected}; leave it out, or begin lines of words with #",
    ),
)
"""Patterns of words that are no numbers, and what to do about them."""
NOT_TEXT = {
    b"\x93NUMPY": "a file of numpy.save",
    b"\xfd7zXZ": "packed with xz",
    b"\x1f\x8b": "packed with gzip",
    b"PK\x03\x04": "a zip or npz file",
    b"BZh": "packed with bzip2",
    b"\x89HDF": "an HDF5 file",
    b"\xff\xfe": "text in UTF-16 (PowerShell writes it)",
    b"\xfe\xff": "text in UTF-16",
}
"""First bytes of files that are not plain text."""
FORTRAN = re.compile(r"(?<=[\d.])[dD](?=[+-]?\d)")
"""The D of Fortran's exponents, 1.5D-03."""
REPORTS = "pressure", "forces", "status", "resultant"
ODD = "is multiplied by the factor"
NAMES_OF_ONE = {"vertices": "vertex", "cells": "cell"}
OF_LARGEST = "the largest displacement of the exact solution"
TOLERANCE = "tolerance"
"""Key of the cause that the solver stops too early."""


class TaskError(ValueError):
    """A task, an answer or an option cannot be used."""


def floats(values):
    """Return values as an array of floats."""
    return np.array(values, float)


def peak(values):
    """Return the largest absolute value, at least 1e-300, by which one may divide."""
    return float(abs(values).max(initial=1e-300))


def at_ends(areas):
    """Return 1/2 for vertices of small areas, at the ends of a face, and 1 for others."""
    return np.where(areas < 0.75 * np.median(areas), 0.5, 1.0)


def whole(values):
    """Return values as an array of integers."""
    return np.array(values, int)


class Task:
    """One problem on one mesh: static steps, one after the other, and what answers are judged by.

    Attributes:
        name: of the file.
        data: as it was read, arrays as lists; ``vertices`` (n, d), ``cells`` (cells, d + 1), ``dim`` is d.
        stiffness: C of the static steps for every cell, Mandel, (cells, D, D): G, in a march A/k + G/2.
        clamped: numbers of the vertices at which u = 0; ``count`` is the number of steps.

    Data that are no task raise TaskError, which names the key that is missing or has another shape.
    """

    def __init__(self, name, data):
        if not isinstance(data, dict):
            raise TaskError(f"{name} holds a JSON {type(data).__name__}, expected a task (an object); remove the file")
        if data.get("format") != "contact-task" or data.get("version") not in (
            1,
            2,
        ):
            raise TaskError(
                f"{name} is {data.get('format')} {data.get('version')}, expected contact-task 1 or 2; remove the file "
                "or export it again"
            )
        self.name = name
        self.data = data
        try:
            self._take(data)
            self._check()
        except KeyError as error:
            raise TaskError(f"{name} lacks the key {error}; export it again") from error
        except (AttributeError, IndexError, TypeError, ValueError) as error:
            raise TaskError(f"{name} is no task of contact-task {data['version']}: {error}") from error

    def _take(self, data):
        self.vertices = floats(data["vertices"])
        self.cells = whole(data["cells"])
        self.clamped = whole(data["clamped"])
        self.scale = float(data["scale"])
        self.level = data["level"]
        self.h = data["h"]
        self.case = data["case"]
        self.marches = data["mode"] == "march"
        self.count = len(data["steps"])
        self.dim = self.vertices.shape[1]
        self.A = self.plain("A", factor=True)
        self.G = self.plain("G", factor=True)
        self.stiffness, self.history = self.laws(self.A, self.G)
        self._measure_cells()

    def _measure_cells(self):
        """Set volumes and gradients of the shape functions (cells, d + 1, d), and the strains of unit displacements."""
        corners = self.vertices[self.cells]
        edges = np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2)
        self.volumes = np.linalg.det(edges) / (1, 1, 2, 6)[self.dim]
        inverse = np.linalg.inv(edges)
        self.gradients = np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1)
        full = np.einsum("ai,ckj->ijcka", np.eye(self.dim), self.gradients)
        full = (full + full.swapaxes(0, 1)) / 2
        factors = np.where(self.shear(), np.sqrt(2), 1)
        self.strains = factors[:, None, None, None] * np.array([full[pair] for pair in pairs(self.dim)])

    def _check(self):
        """ValueError, which says what is wrong, unless numbers are finite and shapes fit each other."""
        if not self.count or not self.scale > 0:
            raise ValueError(f"{self.count} steps, and the scale {self.scale}")
        n = self.vertices.shape
        strains = (len(self.cells), self.G.shape[1])
        gap = self.constraints()[3]
        if not (self.volumes > 0).all() or min(self.cells.min(), self.clamped.min(initial=0), gap.min()) < 0:
            raise ValueError(f"cell {self.volumes.argmin()} has no positive volume, or a number is negative")
        rows = [one | other for one, other in zip(self.data["steps"], self.data["judge"], strict=True)]
        shapes = {
            "load": n,
            "displacement": n,
            "reference": n,
            "strain": strains,
            "rest": (),
        }
        shapes |= {"start": n} if self.marches else {"initial_stress": strains}
        shapes |= {"resultant": (len(self.contact),), "pressure": gap.shape}
        for key, shape in shapes.items():
            values = floats([np.concatenate(one[key]) if key == "pressure" else (self.data | one)[key] for one in rows])
            if values.shape[1:] != shape or not np.isfinite(values).all():
                raise ValueError(f"{key!r} has the shape {values.shape[1:]} or no finite numbers, expected {shape}")

    @property
    def contact(self):
        """The pieces of Γ3 as in the file."""
        return self.data["contact"]

    def plain(self, name, factor=False):
        """Return the tensor A or G of the cells, (cells, D, D), without or with its factor."""
        law = self.data["law"][name]
        factors = np.broadcast_to(floats(law["factor"]) if factor else 1.0, len(self.cells))
        return factors[:, None, None] * floats(law["matrix"])

    def laws(self, A, G):
        """Return the stiffness and the factor of the old strain: of the midpoint rule, or G and None."""
        if not self.marches:
            return G, None
        rate = A / self.data["step"]
        return rate + G / 2, G / 2 - rate

    def shear(self):
        """Return which of the D components of Mandel are shear."""
        return np.arange(len(pairs(self.dim))) >= self.dim

    @classmethod
    def read(cls, path):
        """Read a task from NAME.json.xz, NAME.json.gz or NAME.json."""
        path = Path(path)
        try:
            data = json.loads(_content(path))
        except (
            OSError,
            EOFError,
            ValueError,
            lzma.LZMAError,
            zlib.error,
            RecursionError,
        ) as error:
            raise TaskError(f"{path} is no JSON: {error}") from error
        return cls(path.name.partition(".json")[0], data)

    def strain(self, u):
        """Return ε(u) on the cells, Mandel, (…, cells, D), from values at the vertices (…, n, d)."""
        return np.einsum("Dcka,...cka->...cD", self.strains, u[..., self.cells, :])

    def in_cells(self, stress):
        """Return the forces of stresses (…, cells, D) at the vertices of each cell, (…, cells, d + 1, d)."""
        return np.einsum("c,Dcka,...cD->...cka", self.volumes, self.strains, stress)

    def internal(self, stress):
        """Return (σ, ε(φ_i e_j))_Q for stresses on the cells (…, cells, D), at the vertices (…, n, d)."""
        return self.assembled(self.in_cells(stress))

    def assembled(self, values):
        """Return values at the vertices of each cell, (…, cells, d + 1, d), added up at the vertices, (…, n, d)."""
        total = np.zeros((*values.shape[:-3], *self.vertices.shape))
        np.add.at(total, (..., self.cells, slice(None)), values)
        return total

    def given(self, key):
        """Return what the steps have under a key, for loads that are not scaled."""
        return floats([one[key] for one in self.data["steps"]]) / self.scale

    def judged_by(self, key):
        """Return what the steps are judged by under a key."""
        return floats([one[key] for one in self.data["judge"]])

    def step(self, n, before):
        """Return (b, s_0) of step n: nodal forces (n, d) and initial stress (cells, D); ``before`` is u_{n−1}."""
        one = self.data["steps"][n]
        if self.marches:
            return floats(one["load"]), np.einsum("cij,cj->ci", self.history, self.strain(before))
        return floats(one["load"]), floats(one["initial_stress"])

    def start(self):
        """Return u before the first step, (n, d); zero unless the task is a march."""
        return floats(self.data["start"]) if self.marches else np.zeros_like(self.vertices)

    def norm(self, strain):
        """Return (Σ |T| A ε·ε)^½."""
        return np.sqrt(np.einsum("c,cij,ci,cj->", self.volumes, self.A, strain, strain))

    def stiff(self):
        """Return the mean of tr A / D."""
        return np.trace(self.A, axis1=1, axis2=2).mean() / self.A.shape[1]

    def areas(self, facets):
        """Return lengths or areas of facets (facets, d)."""
        edges = self.vertices[facets[:, 1:]] - self.vertices[facets[:, :1]]
        return np.sqrt(np.linalg.det(edges @ np.swapaxes(edges, 1, 2))) / (1, 1, 2)[self.dim - 1]

    def pieces(self):
        """Return ν (d,), the constrained vertices (m,) and Σ ∫ φ_i (m,) of each piece of contact."""
        result = []
        for piece in self.contact:
            facets = whole(piece["facets"])
            vertices = whole(piece["vertices"])
            mass = np.zeros(len(self.vertices))
            np.add.at(mass, facets, self.areas(facets)[:, None] / self.dim)
            result.append((floats(piece["normal"]), vertices, mass[vertices]))
        return result

    def constraints(self):
        """Return vertex (m,), ν (m, d), Σ ∫ φ_i (m,) and gap over scale (m,) of all constraints, piece after piece."""
        pieces = [(vertices, np.tile(normal, (len(vertices), 1)), mass) for normal, vertices, mass in self.pieces()]
        vertices, normals, mass = (np.concatenate(one) for one in zip(*pieces, strict=True))
        return vertices, normals, mass, np.concatenate(self.gaps()) / self.scale

    def distances(self, u):
        """Return u_ν − gap at the constraints, (steps, m), from displacements without the scale (steps, n, d)."""
        vertices, normals, _, gap = self.constraints()
        return np.einsum("smi,mi->sm", u[:, vertices], normals) - gap

    def exact_pressures(self):
        """Return the exact pressure at the constraints, (steps, m)."""
        return floats([np.concatenate(one["pressure"]) for one in self.data["judge"]])

    def references(self):
        """Return the solutions in K^h of all steps, (steps, n, d), for loads that are not scaled."""
        return self.judged_by("reference")

    def by_piece(self, values):
        """Return values (…, m) at the constraints for each piece of contact."""
        ends = np.cumsum([len(piece["vertices"]) for piece in self.contact])
        return np.split(values, ends[:-1], axis=-1)

    def sums(self, forces):
        """Return the sum of forces at the constraints (steps, m) over each piece, (steps, pieces)."""
        return np.stack([part.sum(axis=1) for part in self.by_piece(forces)], axis=1)

    def gaps(self):
        """Return the initial gap at the vertices of each piece (m,), in the units of the task; zero without ``gap``."""
        pieces = self.contact
        return [np.broadcast_to(floats(piece.get("gap", 0)), len(piece["vertices"])) for piece in pieces]

    def moved(self, vertices):
        """Return the task with other vertices; False if they are the same, or if a cell has no volume."""
        other = copy.copy(self)
        other.vertices = vertices
        try:
            other._measure_cells()
        except np.linalg.LinAlgError:
            return False
        other.volumes = abs(other.volumes)
        return other if (vertices != self.vertices).any() else False

    def scaled(self, factor):
        """Return the task with gaps times ``factor``, which belongs to loads times ``factor``."""
        other = copy.copy(self)
        pieces = zip(self.contact, self.gaps(), strict=True)
        other.data = {
            **self.data,
            "contact": [piece | {"gap": (factor * gap).tolist()} for piece, gap in pieces],
        }
        return other


def pairs(dim):
    """Return the index pairs of Mandel components: 11, 22, 12 or 11, 22, 33, 23, 13, 12."""
    return [(0, 0), (1, 1), (0, 1)] if dim == 2 else [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]


def _content(path):
    """Return the unpacked content of a file; ValueError if it is much larger than the file."""
    limit = max(UNSUSPICIOUS, PACKING * path.stat().st_size)
    with OPEN.get(path.suffix, open)(path, "rb") as file:
        data = file.read(limit + 1)
    if len(data) > limit:
        raise ValueError(f"it unpacks to more than {limit} bytes, {PACKING} times its size: export it again")
    return data


def printable(text):
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


def _check_sums(directory):
    path = directory / "SHA256SUMS"
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
        digest, _, name = line.partition(" ")
        file = directory / (name.lstrip(" *") or "no file")
        if not file.is_file():
            raise TaskError(f"{path} has {line!r}, expected a sum and a file that is here; copy it, or remove the line")
        if hashlib.sha256(file.read_bytes()).hexdigest() != digest:
            raise TaskError(f"{file.name} is not the file that SHA256SUMS stands for: export or copy it again")


def answer(task: Task, make: Callable, scale: float = 1.0) -> Array:
    """Return u of all steps (steps, n, d) by a code: make(task) ↦ step, step(b, s0) ↦ u; loads times ``scale``."""
    step = make(task.scaled(scale))
    u = scale * task.start()
    result = []
    for n in range(task.count):
        load, stress = task.step(n, u)
        given = step(scale * load, stress if task.marches else scale * stress)
        u = as_array(
            given,
            task.vertices.shape,
            f"the result of step {n + 1} of {task.name}",
            "vertices, components",
        )
        result.append(u / scale)
    return np.array(result)


def as_array(values, shape, what, axes):
    """Return values as an array of floats; TaskError, which names ``what`` and its axes, if it has another shape."""
    try:
        array = np.asarray(values, float)
    except (TypeError, ValueError) as error:
        raise TaskError(f"{what} is no array of numbers ({error}), expected the shape {shape}: {axes}") from error
    if array.shape != shape:
        raise TaskError(f"{what} has the shape {array.shape}, expected {shape}: {axes}")
    return array


def write_answer(directory: Path, task: Task, u: Array, **reports: Array) -> None:
    """Write DIRECTORY/NAME/u.txt, and NAME/pressure.txt, forces.txt, status.txt, resultant.txt for ``reports``."""
    place = Path(directory) / task.name
    place.mkdir(parents=True, exist_ok=True)
    for name, values in {"u": u, **reports}.items():
        np.savetxt(place / f"{name}.txt", np.reshape(values, (len(u), -1)), fmt="%.17g")


def read_answer(directory, task):
    """Return the displacements of an answer, (steps, n, d); TaskError if they cannot be read."""
    return _numbers(
        Path(directory) / task.name / "u.txt",
        (task.count, *task.vertices.shape),
    )


def read_reports(directory, task):
    """Return what the code itself reports: name in ``REPORTS`` ↦ (steps, values), for the files that are there."""
    result = {}
    for name in REPORTS:
        path = Path(directory) / task.name / f"{name}.txt"
        size = len(task.contact) if name == "resultant" else len(task.constraints()[0])
        if path.exists():
            result[name] = _numbers(path, (task.count, size))
    return result


def _numbers(path, shape):
    """Return the numbers of a text file; TaskError if it holds others."""
    lines = shape[0]
    count = math.prod(shape[1:])
    expected = f"expected plain text: for each step ({lines} in all) a line of {count} numbers separated by blanks"
    rows = {}
    for number, line in enumerate(_text(path, expected).splitlines(), 1):
        words = FORTRAN.sub("e", line.partition("#")[0]).split()
        for word in words:
            if not _is_number(word):
                found = next(text for pattern, text in NO_NUMBER if re.search(pattern, word))
                raise TaskError(f"{path}, line {number}: {word[:30]!r} {found.format(expected=expected)}")
        if words:
            rows[number] = floats(words)
    if not rows:
        raise TaskError(f"{path} has no numbers, {expected}; close the file before the program ends")
    for number, row in rows.items():
        if len(row) != count:
            raise TaskError(
                f"{path}, line {number}, has {len(row)} numbers, {expected}; write one line for each step, with all "
                "its numbers; look for a number or a blank too much"
            )
    if len(rows) != lines:
        raise TaskError(f"{path} has {len(rows)} lines, {expected}; write one line for each step, none for the start")
    return floats(list(rows.values())).reshape(shape)


def _text(path, expected):
    """Return the text of a file."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise TaskError(
            f"{path} is missing or cannot be read ({error.strerror}), {expected}; write it there"
        ) from error
    for start, kind in NOT_TEXT.items():
        if data.startswith(start):
            raise TaskError(f"{path} is {kind}, {expected}; write it again (numpy.savetxt writes such files)")
    return data.decode("utf-8-sig", errors="backslashreplace")


def _is_number(word):
    try:
        float(word)
    except ValueError:
        return False
    return True


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
        shift: (a |Ω|)^½ / L times the largest |u| on Γ1, a the mean of tr A / D, L the diameter: it sees rigid motions.
        on_clamp, at_vertices, from_best: largest |u| on Γ1, distance of vertex values from the exact ones, and from
            those of the solution in K^h, over its largest |u|.
        outside: largest force that remains at vertices of no cell that touches Γ3, over the largest load.
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
    shift: float = 0.0
    on_clamp: float = 0.0
    at_vertices: float = 0.0
    from_best: float = 0.0
    outside: float = 0.0

    @property
    def share(self):
        """Distance from the solution in K^h, strains and values on Γ1, over the discretisation error."""
        return math.hypot(self.distance, self.shift) / max(self.best, 1e-300)


def measure(task: Task, u: Array) -> Errors:
    """Judge the answer to one task, (steps, n, d)."""
    if not (abs(u) < HUGE).all():
        return Errors(*[np.inf] * 14)
    mine = Equations(task, u / task.scale)
    best = Equations(task, task.references())
    rows = [errors_in_v(task, one, v) for one, v in zip(task.data["judge"], mine.u, strict=True)]
    values = np.max(rows, axis=0)
    pressure, *others = _contact(mine)
    outside = mine.size(mine.total[:, ~sets(mine)["in the cells at Γ3"]])
    numbers = (*values[:4], pressure, _contact(best)[0], *others)
    return Errors(*map(float, (*numbers, *values[4:], outside)))


def errors_in_v(task, exact, u):
    """Return ‖u − u^h‖, the same for K^h, ‖Π^h u − u^h‖, the distance, and the differences of vertex values."""
    means, reference, interpolant = (floats(exact[key]) for key in ("strain", "reference", "displacement"))
    to_means = [task.norm(means - task.strain(v)) for v in (u, reference)]
    nodes = [task.norm(task.strain(v - u)) for v in (interpolant, reference)]
    largest = peak(task.references())
    values = [peak(v) / largest for v in (u[task.clamped], u - interpolant, u - reference)]
    diameter = np.linalg.norm(np.ptp(task.vertices, axis=0))
    shift = np.sqrt(task.stiff() * task.volumes.sum()) / diameter * largest * values[0]
    return [
        *np.sqrt(exact["rest"] + np.square(to_means)),
        *nodes,
        shift,
        *values,
    ]


def _contact(equations):
    """Return pressure error, penetration, error of the resultant, forces out of balance; all relative."""
    task = equations.task
    lam = equations.lam
    mass = equations.area
    p = task.exact_pressures()
    total = task.judged_by("resultant")
    errors = (
        np.sqrt((lam / mass - p) ** 2 @ mass).max(),
        max(0.0, equations.gap.max()),
        peak(task.sums(lam) - total),
    )
    sizes = np.sqrt(p**2 @ mass).max(), peak(equations.u), peak(total)
    relative = [a / max(b, 1e-300) for a, b in zip(errors, sizes, strict=True)]
    return [*relative, equations.remains]


def tested(task):
    """Return how many constraints are in contact at some step, how many are free at some step, and their number."""
    u = task.judged_by("displacement")
    p = task.exact_pressures()
    free = task.distances(u) < -1e-9 * peak(u)
    return (
        int((p > 0).any(axis=0).sum()),
        int(free.any(axis=0).sum()),
        p.shape[1],
    )


@dataclass(frozen=True)
class Report:
    """Judgement of what a code itself reports: its name, whether it is right, and a sentence."""

    name: str
    right: bool
    sentence: str


def judge_reports(task: Task, u: Array, reports: dict[str, Array]) -> list[Report]:
    """Judge what a code reports with its displacements: names in ``REPORTS`` ↦ values (steps, m or pieces).

    Each is compared with the nodal forces that balance u (steps, n, d); a pressure may also have up to
    ``LARGE_PRESSURE`` times their error, as there are several ways to recover it.
    """
    if unknown := set(reports) - set(REPORTS):
        raise TaskError(f"unknown report {', '.join(sorted(unknown))}, expected {', '.join(REPORTS)}")
    if not reports or not (abs(u) < HUGE).all():
        return []
    e = Equations(task, u / task.scale)
    result = []
    rights = {
        "forces": e.lam,
        "pressure": e.lam / e.area,
        "resultant": task.sums(e.lam),
        "status": e.lam,
    }
    for name in (name for name in rights if name in reports):
        axes = "steps, pieces of Γ3" if name == "resultant" else "steps, contact vertices"
        given = as_array(
            reports[name],
            rights[name].shape,
            f"reported {name} of {task.name}",
            axes,
        )
        right, words = (
            _compare_status(e, given != 0)
            if name == "status"
            else _compare(task, name, given / task.scale, rights[name])
        )
        result.append(Report(name, right, f"n = {task.level}: reported {name}: {words}"))
    return result


def _compare_status(e, status):
    """Return whether a status agrees with forces and gaps, and the sentence."""
    faults = {
        "no contact where a force acts": ~status & (e.lam > AGREES * peak(e.lam)),
        "contact where a gap is open": status & (e.gap < -AGREES * peak(e.u)),
    }
    told = [f"{words}, {wrong.sum()} times" for words, wrong in faults.items() if wrong.any()]
    return not told, "; ".join(told) or "agrees with forces and gaps"


def _compare(task, name, mine, wanted):
    """Return whether a report agrees with the balance of u, and the sentence with the simple mistake that fits."""
    mass = task.constraints()[2]
    largest = peak(wanted)
    apart = peak(mine - wanted) / largest
    if apart <= AGREES:
        return (
            True,
            f"agrees with what balances the displacements, up to {apart:.0e}",
        )
    if not np.isfinite(mine).all():
        return False, "not all are numbers"
    factor = _factor(mine, wanted)
    mistakes = {
        factor_words(factor): factor * wanted,
    }
    if name != "resultant":
        ends = at_ends(mass)
        mistakes |= {
            "takes full areas at the ends of the face, where half are right": wanted * ends,
            "takes the area of one facet at each vertex, where two meet inside the face": 2 * wanted * ends,
            "is a force, expected force over area": wanted * mass,
            "is a pressure, expected pressure times area": wanted / mass,
        }
    best, text = min((peak(mine - guess) / largest, text) for text, guess in mistakes.items())
    if best <= NAMED * apart:
        return False, f"it {text} (the rest differs by {max(best, 1e-17):.0e})"
    mine_error, error = (np.sqrt((p - task.exact_pressures()) ** 2 @ mass).max() for p in (mine, wanted))
    if name == "pressure" and mine_error <= LARGE_PRESSURE * error:
        return (
            True,
            f"{mine_error / error:.2g} times the error of what balances the displacements",
        )
    return False, f"differs by {apart:.2g} from what balances the displacements"


@dataclass(frozen=True)
class Cause:
    """A cause that was tried.

    Attributes:
        key: ``group:variant``; of equally good causes, one of each group is named.
        sentence: what is wrong.
        residual: what is left if the cause is undone in the equations, or imitated in the answer; over the load, or for
            causes in the contact algorithm over the largest contact force.
        without: what is left otherwise.
        fitted: how many numbers without a meaning were fitted to the answer.
    """

    key: str
    sentence: str
    residual: float
    without: float
    fitted: int = 0

    @property
    def rank(self):
        """Part of the residual that is left; infinite where that is no number."""
        return self.residual / self.without if self.residual < np.inf and self.without > 0 else np.inf


@dataclass(frozen=True)
class Diagnosis:
    """Where the equations are violated, why, the most likely causes (group ↦ words), and whether they are certain."""

    sentence: str = ""
    causes: dict[str, str] = field(default_factory=dict)
    certain: bool = False
    where: str = ""

    def is_fault(self, share):
        """Return whether the causes are certain and no consistent method, for a distance ``share`` of the error."""
        method = any(key.startswith(METHODS) for key in self.causes)
        return self.certain and not method and (share > NEGLIGIBLE or not self.may_vanish())

    def may_vanish(self):
        """Return whether the effect of one of the causes may tend to 0 with h."""
        return any(key.startswith((*METHODS, *FITTED, TOLERANCE)) or ODD in self.causes[key] for key in self.causes)


def diagnose(tasks, answers):
    """Return where the first of some answers violates the equations, and the cause that the first two share."""
    for task, values in zip(tasks, answers, strict=True):
        if not (abs(values) < HUGE).all():
            return _not_numbers(task, values)
    first = Equations(tasks[0], answers[0] / tasks[0].scale)
    if on_clamp := _not_held(first):
        return on_clamp
    causes = list(tried(first))
    if len(tasks) > 1 and tasks[1].vertices.size <= LARGEST_SOLVE:
        again = {cause.key: cause for cause in tried(Equations(tasks[1], answers[1] / tasks[1].scale))}
        shared = [one for one in causes if one.key in again or one.key.endswith("in cells")]
        others = [replace(again.get(one.key, one), sentence=one.sentence) for one in shared]
        causes = [max(two, key=lambda cause: cause.rank) for two in zip(shared, others, strict=True)]
    found = _named(causes) or _perhaps(first)
    return replace(found, where=where(first))


def tried(equations):
    """Yield all causes that the forces out of balance leave possible."""
    yield from rounded_answers(equations)
    if equations.balanced:
        yield from contact_causes(equations)
    else:
        for causes in (
            undone,
            changed_answers,
            multiplied,
            added,
            supports,
            tilted,
            duplicated,
        ):
            yield from causes(equations)


def _not_numbers(task, values):
    """Return the diagnosis of an answer with values that are not numbers or too large; most of a step: singular."""
    bad = ~(abs(values) < HUGE)
    step, vertex, axis = np.argwhere(bad)[0]
    if np.isnan(values[step]).mean() > 0.5:
        words = "the matrix is probably singular: the body is not held, or one constraint is imposed twice"
        words += " (for example by wrong normals at a corner)"
        return Diagnosis(
            f"The answer to {task.name} is not a number in step {step + 1}; {words}",
            {"nan": words},
        )
    first = f"u_{'xyz'[axis]} of vertex {vertex} in step {step + 1} is {values[step, vertex, axis]:g}"
    return Diagnosis(f"The answer to {task.name} has values that are not numbers or too large ({bad.sum()}): {first}")


def _named(causes):
    """Return the causes that leave at most ``NAMED`` of the residual; None if there is none.

    Of causes that leave equally little, those with the fewest fitted numbers are named.
    """
    likely = [one for one in causes if one.rank <= NAMED and one.residual <= LARGEST_LEFT]
    if not likely:
        return None
    least = max(10 * min(one.residual for one in likely), CERTAIN)
    ranked = sorted(
        (one for one in likely if one.residual <= least),
        key=lambda one: (one.fitted, one.rank),
    )
    best = ranked[0]
    groups = {}
    for one in ranked:
        if one.fitted == best.fitted and len(groups) < 3:
            groups.setdefault(one.key.partition(":")[0], one.sentence)
    head = "Equally likely, another case tells them apart" if len(groups) > 1 else "Most likely"
    left = f"equations with this fault reproduce the answer up to {max(best.residual, 1e-17):.0e}"
    words = "; or ".join(groups.values())
    sentence = f"{head}: {words} ({left}; the right equations, up to {best.without:.2g})"
    return Diagnosis(sentence, groups, best.residual <= CERTAIN)


def _perhaps(e):
    """Return what a small residual suggests that is spread over all free unknowns, or over contact; or no cause."""
    task = e.task
    apart = peak(e.u - e.exact) / peak(e.exact)
    left = abs(e.total[:, ~e.held]).ravel()
    spread = left.sum() ** 2 / (left.size * (left**2).sum())
    stiffness = np.trace(task.stiffness, axis1=1, axis2=2).mean() / len(e.shear) * task.h ** (task.dim - 2)
    _, hover, enter = (mask.sum() for mask in contact_masks(e).values())
    size = left.max() / (stiffness * peak(e.exact))
    rounding = 2**24 * size
    if apart > NEGLIGIBLE:
        spread = 0
    if spread > SPREAD and 0.1 < rounding < ROUNDED:
        words = "the solver works in single precision, or stops as early"
        return Diagnosis(f"Perhaps: {words}: forces that remain are {rounding:.2g} times this rounding")
    if spread > SPREAD and not e.balanced and size > ROUGH * apart:
        words = "the solver stops too early, at too large a tolerance"
        why = f"displacements differ by {apart:.0e} of the largest, without pattern in space, at all free unknowns"
        return Diagnosis(f"Perhaps: {words}: {why}", {TOLERANCE: words})
    if e.balanced and enter and hover:
        words = "the iterations for contact stop too early, or the contact forces are not those of a law of the gap"
        return Diagnosis(f"Perhaps: {words}: some vertices penetrate, and forces act at others that hover")
    return Diagnosis("Not explained: no cause that was tried leaves a thousandth of this")


def _not_held(e):
    """Return the cause where u on Γ1 is not zero: another format, a moved body, or what is not held."""
    task = e.task
    wrong = e.on_clamp > AGREES
    if not wrong.any():
        return None
    if explained := _named([*changed_answers(e)]):
        return explained
    steps, vertices, components = (wrong.any(axis=axes) for axes in ((1, 2), (0, 2), (0, 1)))
    free = e.total.copy()
    free[:, task.clamped] = wrong.any(axis=0) * e.full[:, task.clamped]
    singular = peak(e.u) > SINGULAR * peak(e.exact)
    certain = singular or e.size(free) <= CERTAIN
    what = "u" if components.all() else f"component {' and '.join(map(str, np.flatnonzero(components) + 1))}"
    held = f"{what} is not held" if vertices.all() else f"{what} is not held at some vertices"
    words = held
    if singular:
        words = f"{held}, the matrix is singular or nearly so"
    elif not certain and e.on_clamp.max() <= NEGLIGIBLE:
        words = f"{what} is not held exactly (a penalty?)"
    elif not certain:
        words = f"perhaps {held}, or the vertices are in another order"
    at = counted(task.clamped[vertices], "vertices", task.vertices)
    much = f"up to {e.on_clamp.max():.2g} of {OF_LARGEST}"
    sentence = f"On Γ1 {what} is not zero at {at} of n = {task.level}, {_when(steps)}, but {much}: {words}"
    return Diagnosis(sentence, {f"clamp {held}": f"on Γ1 {held}"} if certain else {}, certain)


class Equations:
    """The equations of a task with an answer: stresses, and the forces that are out of balance.

    Attributes:
        u: displacements (steps, n, d), loads not scaled; ``before`` those of the step before.
        elastic: stresses C ε(u), (steps, cells, D); ``stress`` are the initial stresses.
        full: forces out of balance (steps, n, d); ``total`` without those that Γ1 and the contact faces may carry.
        lam: nodal contact forces (steps, m), least squares where faces meet; ``pressed`` says where they act, ``gap``
            is u_ν − gap.
        on_clamp: |u| on Γ1 (steps, vertices, d) over the largest displacement of the exact solution.
        bad: where forces remain, (n,) of bool; ``bad_steps`` (steps,) is when, ``when`` in words.
    """

    def __init__(self, task, u):
        self.task = task
        self.u = u
        self.static = not task.marches
        self.C = task.stiffness
        self.shear = task.shear()
        self.rate = task.A / task.data.get("step", 1)
        self.load = task.given("load")
        self.largest = peak(self.load)
        self.before = np.concatenate([task.start()[None] / task.scale, u[:-1]])
        self.strain = task.strain(u)
        self.strain_before = task.strain(self.before)
        self.elastic = _times(self.C, self.strain)
        self.stress = task.given("initial_stress") if self.static else _times(task.history, self.strain_before)
        self.old = "the initial stress" if self.static else "the stress of the previous step"
        self._face()
        self.full = self.load - task.internal(self.elastic + self.stress)
        self.total = self.left(self.full)
        self.remains = self.size(self.total)
        self.balanced = self.remains <= EQUATIONS_HOLD
        self.exact = task.references()
        self.on_clamp = abs(u[:, task.clamped]) / peak(self.exact)
        self.lam = np.einsum("smi,mi->sm", self.full[:, self.vertices], self.carry)
        self.pressed = abs(self.lam) > AGREES * peak(self.lam)
        self.gap = task.distances(u)
        sizes = np.linalg.norm(self.total, axis=2)
        self.acting = (sizes > SEEN * sizes.max()) & (sizes > 0)
        self.bad = self.acting.any(axis=0)
        self.bad_steps = self.acting.any(axis=1)
        self.when = _when(self.bad_steps)

    def _face(self):
        """Set ``keep`` (n, d, d), which takes what Γ1 and contact faces may carry from forces."""
        task = self.task
        n = len(self.task.vertices)
        self.vertices, normals, self.area, _ = task.constraints()
        self.rows = 1.0 * (self.vertices[:, None] == np.arange(n))
        self.face = self.rows.any(axis=0)
        self.held = np.isin(np.arange(n), task.clamped)
        self.keep = np.eye(task.dim) * ~self.held[:, None, None]
        self.carry = np.zeros_like(normals)
        for v in np.flatnonzero(self.face):
            inverse = np.linalg.pinv(normals[self.vertices == v])
            self.carry[self.vertices == v] = inverse.T
            self.keep[v] -= inverse @ normals[self.vertices == v]

    def stresses(self, C, H=None):
        """Return all stresses with another stiffness C, and perhaps another factor H of the old strain."""
        return _times(C, self.strain) + (self.stress if H is None else _times(H, self.strain_before))

    def left(self, forces):
        """Return forces (…, n, d) without those that Γ1 and the contact faces may carry."""
        return np.einsum("vij,...vj->...vi", self.keep, forces)

    def under(self, stress):
        """Return the forces out of balance with other stresses (steps, cells, D)."""
        return self.left(self.load - self.task.internal(stress))

    def size(self, left):
        """Return the largest force over the largest load."""
        return peak(left) / self.largest

    def shifted(self, values):
        """Return values of the step before; in the first step, its own."""
        return np.concatenate([values[:1], values[:-1]])


def _times(C, strain):
    return np.einsum("cij,scj->sci", C, strain)


# Where the equations are violated


def where(equations):
    """Return at which vertices, in which steps and along which axis forces remain, or the contact conditions fail."""
    task = equations.task
    bad = np.flatnonzero(equations.bad)
    n = f"n = {task.level}"
    if equations.balanced:
        faults = "; ".join(_contact_faults(equations)) or "the contact conditions hold up to 1e-6"
        return f"{n}: the forces balance; on Γ3, {faults}"
    much = f"forces of {equations.remains:.2g} of the load remain"
    at = f"at {len(bad)} of {len(task.vertices)} vertices ({_place(equations)})"
    return f"{n}: {much} {at}, {equations.when}{_axis(equations.total[:, bad])}: {listed(bad, task.vertices)}"


def point(x):
    """Return coordinates or components in words."""
    return f"({', '.join(f'{value + 0.0:.4g}' for value in x)})"


def listed(numbers, points):
    """Return at most five numbers with the coordinates of their points."""
    texts = [f"{k} at {point(points[k])}" for k in numbers[:5]]
    return ", ".join(texts) + (", …" if len(numbers) > 5 else "")


def counted(numbers, what, points):
    """Return the count of some vertices or cells, and at most five of them."""
    return f"{len(numbers)} {what if len(numbers) > 1 else NAMES_OF_ONE[what]} ({listed(numbers, points)})"


def _when(steps):
    """Return words for the steps (steps,) of bool."""
    numbers = [str(k + 1) for k in np.flatnonzero(steps)]
    if steps.all():
        return f"in all {len(steps)} steps" if len(steps) > 1 else "in the only step"
    if len(numbers) == 1:
        return f"in step {numbers[0]} alone"
    return f"in steps {', '.join(numbers[:5])}{', …' if len(numbers) > 5 else ''}"


def _axis(forces):
    """Return the axis along which all forces (..., d) act, in words; "" if there is none."""
    _, sizes, axes = np.linalg.svd(forces.reshape(-1, forces.shape[-1]), full_matrices=False)
    if sizes[1:].max(initial=0) > SEEN * sizes[0]:
        return ""
    axis = axes[0].round(6)
    return f", all along ±{point(axis if axis.sum() > 0 else -axis)}"


def sets(e):
    """Return sets of vertices (n,) of bool with their names."""
    task = e.task
    acting = e.pressed.any(axis=0) @ e.rows > 0
    trace = np.trace(task.stiffness, axis1=1, axis2=2)

    def of(vertices):
        return np.isin(np.arange(len(e.bad)), vertices)

    face, loaded = (of([facet for part in task.data[key] for facet in part["facets"]]) for key in ("contact", "loaded"))
    return {
        "on Γ3 where contact forces act": acting,
        "on Γ3 where no contact forces act": face & ~acting,
        "on Γ3": face,
        "on Γ2": loaded & ~face,
        "on Γ2 and its ends": loaded,
        "where materials meet": of(task.cells[trace > trace.min()]) & of(task.cells[trace < trace.max()]),
        "inside": ~face & ~loaded & ~e.held,
        "in the cells at Γ3": of(task.cells[face[task.cells].any(axis=1)]),
    }


def _place(equations):
    """Return in which set the vertices lie at which forces remain, and how many are inside, on Γ2 and on Γ3."""
    task = equations.task
    bad = equations.bad
    named = sets(equations)
    cells = np.flatnonzero(bad[task.cells].sum(axis=1) == bad.sum())
    if bad.sum() > task.dim and 0 < len(cells) <= 2:
        return f"of cell {' or '.join(map(str, cells))}"
    parts = [f"all {name}" for name, members in named.items() if members[bad].all() and 2 * bad.sum() < len(bad)][:1]
    if not parts:
        parts = [f"{n} {name}" for name in ("inside", "on Γ2", "on Γ3") if (n := (bad & named[name]).sum())]
    low = task.vertices[bad].min(axis=0)
    high = task.vertices[bad].max(axis=0)
    if bad.sum() > 5 and np.prod(high - low) < 0.5 * np.prod(np.ptp(task.vertices, axis=0)):
        parts.append(f"from {point(low)} to {point(high)}")
    return ", ".join(parts)


def contact_masks(equations):
    """Return where the contact conditions are violated, (steps, m) of bool, with words for it."""
    lam = equations.lam / peak(equations.lam)
    gap = equations.gap / peak(equations.u)
    return {
        "contact forces pull": lam < -AGREES,
        "contact forces act where the gap is open": (lam > AGREES) & (gap < -AGREES),
        "the body enters the foundation": gap > AGREES,
    }


def _contact_faults(equations):
    """Yield which contact condition is violated, where and when, and force over area against the gap."""
    masks = contact_masks(equations)
    for words, wrong in masks.items():
        if wrong.any():
            vertices = np.unique(equations.vertices[wrong.any(axis=0)])
            yield f"{words} at {counted(vertices, 'vertices', equations.task.vertices)}, {_when(wrong.any(axis=1))}"
    anywhere = np.logical_or.reduce(list(masks.values()))
    gaps = equations.gap[anywhere]
    pressures = (equations.lam / equations.area)[anywhere]
    if len(gaps):
        some = np.argsort(gaps)[:: 1 + len(gaps) // 6]
        yield "u_ν − gap ↦ force over area: " + ", ".join(f"{gaps[k]:.2g} ↦ {pressures[k]:.2g}" for k in some)


# Causes in the equations, in tables: key, sentence, and what is undone, which is False where it cannot be

STATIC: list = [
    ("A for G", "A is used in place of G", lambda e: e.stresses(e.task.A)),
    (
        "stress 1",
        "the initial stress of the step before is used",
        lambda e: e.elastic + e.shifted(e.stress),
    ),
]
MARCH: list = [
    (
        "elastic law",
        "the viscous stress is missing: σ = G ε(u)",
        lambda e: e.stresses(e.task.G, 0 * e.task.G),
    ),
    (
        "older",
        "{e.when} the history is that of the step before last (a repeated or failed step?)",
        lambda e: _older(e, e.bad_steps),
    ),
]
STRESSES: list = [
    (
        "factor",
        "`factor` of the law is forgotten",
        lambda e: e.stresses(*e.task.laws(e.task.plain("A"), e.task.plain("G"))),
    ),
    (
        "plane stress",
        "plane stress is used in place of plane strain",
        lambda e: e.task.dim == 2 and e.stresses(_plane_stress(e.C)),
    ),
    (
        "Lamé",
        "λ and μ are exchanged",
        lambda e: e.stresses(_isotropic(e.C[:, -1, -1] / 2, e.C[:, 0, 1], e.shear)),
    ),
    *(
        row
        for k, which in ((1, "the cell before"), (-1, "the next cell"))
        for row in (
            (
                f"{which}:C",
                f"each cell has the stiffness of {which}",
                lambda e, k=k: e.stresses(np.roll(e.C, k, 0)),
            ),
            (
                f"{which}:stress",
                f"each cell has the initial stress or history of {which}",
                lambda e, k=k: e.elastic + np.roll(e.stress, k, 1),
            ),
        )
    ),
]
"""What the stresses would be, (steps, cells, D)."""
LOADS: list = [
    (
        "load 1",
        "the load of the step before is used",
        lambda e: e.shifted(e.load),
    ),
    (
        "load next",
        "the load of the next step is used",
        lambda e: np.concatenate([e.load[1:], e.load[-1:]]),
    ),
    (
        "load mean",
        "the mean of the loads of this step and the step before is used",
        lambda e: (e.load + e.shifted(e.load)) / 2,
    ),
    (
        "repeated",
        "forces of cells at one vertex are not added up, the last cell overwrites the others (`f[dofs] += f_e` with "
        "repeated dofs): in {e.old}",
        lambda e: e.load + e.task.internal(e.stress) - _last_cell_only(e),
    ),
]
"""What the load would be, (steps, n, d)."""
ANSWERS: list = [
    (
        "components",
        "u_x and u_y are exchanged in the answer",
        lambda e: e.u[..., [1, 0, 2][: e.task.dim]],
    ),
    (
        "late",
        "the displacements of the step before are written",
        lambda e: np.concatenate([e.u[1:], e.exact[-1:]]),
    ),
    (
        "copy",
        "{e.when} the displacements are a copy of another step, or zero (a step that is not solved?)",
        lambda e: _without_copies(e),
    ),
    (
        "by component",
        "the answer has all u_x before all u_y, expected vertex after vertex",
        lambda e: e.u.reshape(len(e.u), e.task.dim, -1).swapaxes(1, 2),
    ),
    (
        "deformed",
        "the answer has deformed coordinates, expected displacements",
        lambda e: e.u - e.task.vertices / e.task.scale,
    ),
    (
        "rigid",
        "the whole body is moved: u on Γ1 is not 0 and the same at all vertices",
        lambda e: e.u - e.u[:, e.task.clamped].mean(axis=1, keepdims=True),
    ),
    *(
        (
            f"sorted:{last}",
            f"the vertices of the answer are in another order: sorted by coordinates, first by {last}",
            lambda e, k=k: e.u[:, np.argsort(np.lexsort(e.task.vertices.T[::k]))],
        )
        for k, last in ((1, "the last one"), (-1, "x"))
    ),
]
"""What the displacements would be, (steps, n, d)."""
OTHER_TASKS: list = [
    *(
        (
            f"coordinates:{k}",
            f"the coordinates of the mesh are rounded to {k} decimals",
            lambda e, k=k: e.task.moved(np.round(e.task.vertices, k)),
        )
        for k in range(1, 8)
    ),
    *(
        (
            f"mirrored:{axis}",
            f"the mesh is mirrored in {axis}, the loads are not",
            lambda e, k=k: e.task.moved(e.task.vertices * np.where(np.arange(e.task.dim) == k, -1, 1)),
        )
        for k, axis in enumerate("xyz")
    ),
]
"""What the task would be."""
ORDERS = {
    "102": "axes 1 and 2 are exchanged",
    "102435": "axes 1 and 2 are exchanged",
    "210543": "axes 1 and 3 are exchanged",
    "021354": "axes 2 and 3 are exchanged",
    "012354": "the components of shear have the order 23, 12, 13",
    "012435": "the components of shear have the order 13, 23, 12",
    "012453": "the components of shear have the order 13, 12, 23",
    "012534": "the components of shear have the order 12, 23, 13",
    "012543": "the components of shear have the order 12, 13, 23",
}
"""Orders of the components of tensors, Mandel, in the plane and in space."""


def undone(e):
    """Yield the causes of the tables of stresses, loads and tasks with what is left if they are undone."""
    tables = [
        (
            [
                *(STATIC if e.static else MARCH),
                *STRESSES,
                *_orders(e),
                *_voigt(e),
            ],
            e.under,
        ),
        (LOADS, lambda load: e.left(e.full - e.load + load)),
        (OTHER_TASKS, lambda task: Equations(task, e.u).total),
    ]
    for rows, left in tables:
        for key, sentence, undo in rows:
            changed = undo(e)
            if changed is not False:
                yield Cause(key, sentence.format(e=e), e.size(left(changed)), e.remains)


def changed_answers(e):
    """Yield the causes that the numbers of the answer stand for something else: forces and u on Γ1 that are left.

    The history of a march may follow from the right displacements, or from the numbers of the answer (as in
    ``answer``).
    """
    for key, sentence, change in ANSWERS:
        u = change(e)
        if u is not False:
            right = Equations(e.task, u)
            for history, stress in (
                ("right", right.stress),
                ("answer", e.stress),
            ):
                left = max(
                    e.size(right.under(right.elastic + stress)),
                    right.on_clamp.max(initial=0),
                )
                without = max(e.remains, e.on_clamp.max(initial=0))
                yield Cause(f"{key}:{history}", sentence.format(e=e), left, without)


def _orders(equations):
    """Yield rows for components of tensors in another order."""
    for digits, words in ORDERS.items():
        order = [int(digit) for digit in digits]
        if len(order) == len(equations.shear):
            yield (
                f"order:C{digits}",
                f"{words} in the stiffness",
                lambda e, o=order: e.stresses(e.C[:, o][:, :, o]),
            )
            yield (
                f"order:stress{digits}",
                f"{words} in the initial stress or history",
                lambda e, o=order: e.elastic + e.stress[..., o],
            )


def _voigt(equations):
    """Yield rows for factors of shear in the stiffness, or in the strain of stiffness and history."""
    for by in (np.sqrt(2), np.sqrt(0.5), 2.0, 0.5):
        w = np.where(equations.shear, by, 1.0)
        ww = w[:, None] * w
        words = f"rows and columns of shear in the stiffness are multiplied by {by:.4g} (Voigt for Mandel?)"
        yield f"shear:both {by}", words, lambda e, ww=ww: e.stresses(e.C * ww)
        words = f"the shear strain is multiplied by {by:.4g} in the stiffness and the initial stress together"
        yield (
            f"strain:{by} given",
            words,
            lambda e, w=w, ww=ww: _times(e.C * ww, e.strain) + w * e.stress,
        )


def _isotropic(lam, mu, shear):
    """Return the stiffness 2 μ I + λ e eᵀ of cells, Mandel."""
    normal = np.multiply.outer(~shear, ~shear)
    return 2 * mu[:, None, None] * np.eye(len(shear)) + lam[:, None, None] * normal


def _plane_stress(C):
    """Return the matrix of plane stress with the constants μ and λ of a matrix of plane strain."""
    lam = C[:, 0, 1]
    twice_mu = C[:, 2, 2]
    return _isotropic(twice_mu * lam / (lam + twice_mu), twice_mu / 2, np.arange(3) == 2)


def _older(equations, steps):
    """Return the stresses if some steps take the history of the step before."""
    old = equations.strain_before.copy()
    old[steps] = equations.shifted(old)[steps]
    return equations.elastic + _times(equations.task.history, old)


def _last_cell_only(equations):
    """Return the forces of the initial stress if the last cell at a vertex overwrites those of the others."""
    result = np.zeros_like(equations.u)
    for forces, of_cells in zip(result, equations.task.in_cells(equations.stress), strict=True):
        forces[equations.task.cells] = of_cells
    return result


def _diagonal(task):
    """Return the diagonal of the stiffness matrix, (n, d)."""
    return task.assembled(np.einsum("c,Dcka,cDE,Ecka->cka", task.volumes, task.strains, task.stiffness, task.strains))


def _without_copies(e):
    """Return the answer with the right displacements in steps that are a copy of the one before, or zero."""
    copies = (e.u == np.roll(e.u, 1, 0)).all(axis=(1, 2)) & (len(e.u) > 1) | (e.u == 0).all(axis=(1, 2))
    return np.where((copies & e.bad_steps)[:, None, None], e.exact, e.u)


# Terms of the equations that are multiplied by a factor: everywhere, in one step, in some cells, at some vertices

VOIGT = "the shear part of the stiffness (√2 of Mandel's or γ = 2ε of Voigt's components)"
UNITS = "the displacements are {inverse:.8g} times the right ones (other units?)"
TERMS: list = [
    ("stress", "{e.old}", lambda e: e.stress),
    ("stress shear", "the shear part of {e.old}", lambda e: e.stress * e.shear),
    ("lambda", "λ of the stiffness", lambda e: _lame_part(e)),
    ("mu", "μ of the stiffness", lambda e: e.elastic - _lame_part(e)),
    ("shear:rows", VOIGT, lambda e: e.elastic * e.shear),
    ("shear:columns", VOIGT, lambda e: _times(e.C, e.strain * e.shear)),
]
STATIC_TERMS: list = [
    (
        "units",
        UNITS + ", or the stiffness is {factor:.8g} times the right one",
        lambda e: e.elastic,
    ),
]
MARCH_TERMS: list = [
    ("units", UNITS, lambda e: e.elastic + e.stress),
    ("stiffness", "the stiffness A/k + G/2", lambda e: e.elastic),
    (
        "viscous",
        "the viscous stress A ε(u̇) (or 1/k)",
        lambda e: _times(e.rate, e.strain - e.strain_before),
    ),
    (
        "elastic",
        "the elastic stress G ε(u)",
        lambda e: _times(e.task.G, (e.strain + e.strain_before) / 2),
    ),
    (
        "theta",
        "θ = 1/2 of the time scheme (1 in backward Euler)",
        lambda e: _times(e.task.G, (e.strain - e.strain_before) / 2),
    ),
]
"""Stresses (steps, cells, D)."""
CELL_TERMS: list = [
    ("contribution in cells", "the contribution", lambda e: e.elastic + e.stress),
    ("material in cells", "the stiffness", lambda e: e.elastic),
    ("prestress in cells", "{e.old}", lambda e: e.stress),
]


def _lame_part(equations):
    """Return the stress λ tr ε(u) I, (steps, cells, D)."""
    lam = equations.C[:, 0, 1]
    return _times(_isotropic(lam, 0 * lam, equations.shear), equations.strain)


def multiplied(e):
    """Yield the causes that a term is multiplied by the factors that fit best."""
    count = e.task.count
    points = e.task.vertices
    steps = np.eye(count)[:, :, None, None]
    vertices = np.flatnonzero(e.bad)
    terms = [*TERMS, *(STATIC_TERMS if e.static else MARCH_TERMS)]
    forces = [(key, words, -e.task.internal(term(e))) for key, words, term in terms]
    forces.append(("diagonal", "the diagonal of the stiffness matrix", -_diagonal(e.task) * e.u))
    for key, words, force in (*forces, ("load", "the load", e.load)):
        yield from fitted(e, key, words, force[None])
        if key != "units":
            yield from fitted(e, f"{key} once", words, force * steps, lambda odd: f" {_when(odd)}", count - 1)
    if len(vertices) <= MOST_PARTS:
        loads = np.eye(len(points))[vertices][:, None, :, None] * e.load

        def at(odd):
            return f" at {counted(vertices[odd], 'vertices', points)}"

        yield from fitted(e, "load at vertices", "the load", loads, at, len(points) // 2)
    for key, words, term in CELL_TERMS:
        yield from _in_cells(e, key, words, term(e))


def _whole_cells(equations):
    """Return which cells have only vertices at which forces remain or may not be seen, and one of the former."""
    bad = equations.bad
    hidden = bad | equations.face | equations.held
    return hidden[equations.task.cells].all(axis=1) & bad[equations.task.cells].any(axis=1)


def _in_cells(equations, key, words, stress):
    """Yield the cause that a term is multiplied in some cells, of those at whose free vertices forces remain."""
    task = equations.task
    cells = np.flatnonzero(_whole_cells(equations))
    if not 0 < len(cells) <= MOST_PARTS:
        return
    parts = np.zeros((len(cells), *equations.u.shape))
    forces = task.in_cells(stress)[:, cells].transpose(1, 2, 0, 3)
    parts[np.arange(len(cells))[:, None], :, task.cells[cells]] = -forces
    middles = task.vertices[task.cells].mean(axis=1)

    def at(odd):
        return f" of {counted(cells[odd], 'cells', middles)}"

    yield from fitted(equations, key, words, parts, at, len(task.cells) * 2 // 3)


def fitted(e, key, words, parts, place=None, most=1):
    """Yield the cause that parts of the equations (k, steps, n, d) are multiplied by the factors that fit best.

    ``place`` gives words for the parts whose factors are not 1, of which there may be ``most``. With several parts,
    more equations than twice the factors are needed.
    """
    total = e.total.ravel()
    flat = e.left(parts).reshape(len(parts), -1)
    if not flat.any() or (place and flat.any(axis=0).sum() < 2 * len(parts)):
        return
    change = np.linalg.lstsq(flat.T, -total, rcond=None)[0]
    odd = abs(change) > SEEN * peak(change)
    if odd.sum() > most:
        return
    factors = 1 + change[odd]
    told = factor_words(factors.mean())
    if np.ptp(factors) > 1e-4 * peak(change):
        told = "is multiplied by different factors"
    sentence = words if words.startswith(UNITS) else f"{words}{place(odd) if place else ''} {told}"
    inverse = 1 / (factors[0] or 1e-300)
    sentence = sentence.format(e=e, factor=factors[0], inverse=inverse)
    numbers = (ODD in sentence) + (odd.sum() if place else 0)
    yield Cause(key, sentence, e.size(total + change @ flat), e.remains, fitted=numbers)


def factor_words(factor):
    """Return what a factor means: 0 is missing, −1 has the reversed sign."""
    known = {
        0.0: "is missing",
        -1.0: "has the reversed sign",
        2.0: "is counted twice",
        0.5: "is halved",
        2**0.5: "is multiplied by √2",
        0.5**0.5: "is divided by √2",
    }
    near = (words for value, words in known.items() if abs(factor - value) < 1e-4)
    return next(near, f"{ODD} {factor:.8g}")


# Forces that are in no equation

ALONG: list = [
    (
        "friction",
        "friction acts in contact, with the coefficient {c:.8g}",
        lambda e: e.lam,
    ),
    (
        "friction:bound",
        "friction of {c:.8g} for each area acts in contact, whatever the contact force",
        lambda e: e.pressed * e.area,
    ),
    (
        "tangential springs",
        "springs act along the contact face (a tangential penalty), of stiffness {c:.8g} for each area",
        lambda e: 0 * e.lam + e.area,
    ),
    (
        "tangential springs:contact",
        "springs act along the face in contact (a tangential penalty), of stiffness {c:.8g} for each area",
        lambda e: e.pressed * e.area,
    ),
]
"""Forces against the slip, (steps, m), up to a factor c: of this size for friction, else times the slip."""


def added(e):
    """Yield the causes that a positive multiple of forces acts that are in no equation."""
    traction = e.left(_traction(e))
    c = -_factor(e.total, traction)
    if c > 0:
        words = f"the traction on Γ2 is added {c:.8g} times to `load`, which already contains it"
        yield Cause("traction", words, e.size(e.total + c * traction), e.remains, fitted=1)
    moves = {"": e.u, ", against the change of u since the step before": e.u - e.before}
    for key, sentence, weights in ALONG:
        for against, move in moves.items():
            c, left = _resisted(e, weights(e) @ e.rows, move, key.startswith("friction"))
            if c > 0:
                yield Cause(
                    f"{key}:{against}",
                    sentence.format(c=c) + against,
                    e.size(left),
                    e.remains,
                    fitted=1 + bool(against),
                )


def _resisted(e, weight, move, friction):
    """Return c and the forces left without c weight against the slip, (steps, n) and (steps, n, d).

    Friction has the size c weight where a vertex slides, and at most this size where it stays.
    """
    slip = e.left(move) * e.face[:, None]
    size = np.linalg.norm(slip, axis=2)
    slides = size > AGREES * peak(e.u)
    per = weight * slides / np.maximum(size, 1e-300) if friction else weight
    along = per[..., None] * slip
    c = _factor(e.total, along)
    left = e.total - c * along
    if friction:
        stays = ~slides & e.face & (np.linalg.norm(e.total, axis=2) < c * (1 + NAMED) * weight)
        left[stays] = 0
    return c, left


def _factor(values, shape):
    """Return the factor of a shape that fits values best."""
    return (values * shape).sum() / max((shape**2).sum(), 1e-300)


def _traction(equations):
    """Return the nodal forces of the traction on Γ2, (steps, n, d); zero in a march, which has no traction."""
    task = equations.task
    result = np.zeros_like(equations.u)
    weights = (1 + np.eye(task.dim)) / (task.dim * (task.dim + 1))
    for forces, step in zip(result, task.data["steps"], strict=True):
        for part, values in zip(task.data["loaded"], step.get("traction", ()), strict=False):
            facets = whole(part["facets"])
            nodal = np.einsum("f,kl,fla->fka", task.areas(facets), weights, floats(values))
            np.add.at(forces, facets, nodal / task.scale)
    return result


def supports(e):
    """Yield the cause that u is held at 0 along the forces that remain, at each vertex and in each step of them."""
    bad = np.flatnonzero(e.bad)
    if 2 * len(bad) > len(e.bad):
        return
    sizes = np.linalg.norm(e.total, axis=2)
    at = counted(bad, "vertices", e.task.vertices)
    for key, held, u in (
        ("held", "is held at 0", e.u),
        ("held:stuck", "stays as in the step before", e.u - e.before),
    ):
        moved = abs((u * e.total).sum(axis=2)) / np.maximum(sizes, 1e-300)
        words = f"u {held} along the forces at {at}: a support, or other faces found to be in contact"
        if e.face[bad].all():
            words = f"no slip: u along the face {held} at {at}"
        yield Cause(key, words, moved[e.acting].max() / peak(e.u), e.remains, fitted=int(key != "held"))


def tilted(e):
    """Yield the cause that contact forces act along fixed axes that are not the normals, in two steps or more."""
    bad = np.flatnonzero(e.bad)
    if not e.face[bad].all() or e.acting.sum(axis=0).max() < 2:
        return
    _, sizes, axes = np.linalg.svd(e.full[:, bad].swapaxes(0, 1), full_matrices=False)
    left = sizes * (np.arange(sizes.shape[1]) >= e.rows.sum(axis=0)[bad, None])
    numbers = len(np.unique((axes[:, :1] * axes[:, 0, :, None]).round(4), axis=0))
    at = counted(bad, "vertices", e.task.vertices)
    words = f"normals are tilted (or there is friction) at {at}: along {point(axes[0, 0].round(6))} there"
    yield Cause("tilt", words, e.size(left), e.remains, fitted=numbers)


def duplicated(e):
    """Yield the cause that some cells at a vertex use a copy of it that moves on its own (a crack).

    Forces remain at vertices of these cells alone. At the vertex, the forces of these cells are missing; at the
    others, those that follow from the move of the copy.
    """
    task = e.task
    bad = np.flatnonzero(e.bad)
    forces = task.in_cells(e.elastic + e.stress)
    for v in bad:
        corner = task.cells == v
        some = corner.any(axis=1) & _whole_cells(e)
        total = e.total.copy()
        total[:, v] += (forces[:, some] * corner[some][:, :, None]).sum(axis=(1, 2))
        if np.isin(bad, task.cells[some]).all() and e.size(total[:, v]) <= NAMED * e.remains:
            moves = np.eye(task.dim)[:, None] * (np.arange(len(e.bad)) == v)[:, None]
            follow = e.left(task.internal(_times(e.C * some[:, None, None], task.strain(moves))))
            follow[:, v] = 0
            flat, follow = (values.reshape(len(values), -1) for values in (total, follow))
            left = e.size(flat - flat @ np.linalg.pinv(follow) @ follow)
            words = f"vertex {listed([v], task.vertices)} is duplicated (a crack), with a copy in {some.sum()} cells"
            yield Cause("duplicate", words, left, e.remains, fitted=1 + int(some.sum()))


def rounded_answers(equations):
    """Yield the causes that the displacements are rounded: to decimals, to digits, or to single precision."""
    scale = equations.task.scale
    given = equations.u * scale
    exact = equations.exact * scale
    units = {"in single precision": np.spacing(abs(exact).astype(np.float32))}
    for k in range(1, 10):
        units[f"with {k} decimals"] = 10.0**-k
        units[f"with {k + 1} digits"] = 10.0 ** (np.floor(np.log10(abs(exact) + 1e-30)) - k)
    for words, unit in units.items():
        left = max(
            (abs(given - exact) - unit / 2).max(),
            peak(given - np.round(given / unit) * unit),
        )
        sizes = left / peak(exact), peak(given - exact) / peak(exact)
        yield Cause(f"digits:{words}", f"the displacements are written {words}", *sizes)


# Causes in the contact algorithm, where the equations inside the body hold


class ContactProblem:
    """The contact problem of an answer on the contact faces: gap = free − W λ, with its history; ``right`` is its λ."""

    def __init__(self, equations):
        e = equations
        self.task = equations.task
        self.vertices, normals, self.area, self.initial = self.task.constraints()
        self.lam = e.lam
        self.gap = e.gap
        self.gap_before = -self.task.distances(e.before)
        unknown = np.flatnonzero(np.repeat(~e.held, self.task.dim))
        units = np.eye(self.task.vertices.size)[unknown].reshape(-1, *self.task.vertices.shape)
        K = e.task.internal(_times(e.C, e.task.strain(units))).reshape(len(unknown), -1)[:, unknown]
        N = (e.rows[:, :, None] * normals[:, None]).reshape(len(normals), -1)[:, unknown]
        forces = (e.load - e.task.internal(e.stress)).reshape(self.task.count, -1)[:, unknown]
        self.W, free = np.split(
            N @ np.linalg.solve(K, np.concatenate([N, forces]).T),
            [len(N)],
            axis=1,
        )
        self.free = free.T - self.initial
        self.right = self.each()
        self.largest = max(peak(self.right), peak(self.lam))
        self.small = AGREES * self.largest
        self.moved = AGREES * peak(e.u)
        self.pressed = self.lam > self.small
        self.first = np.arange(len(self.lam))[:, None] == 0
        self.ends = at_ends(self.area)

    def each(self, free=None, starts=None, **options):
        """Return λ of all steps, (steps, m), by ``active_set`` with its options and one start for each step."""
        free = self.free if free is None else free
        starts = [False] * len(free) if starts is None else starts
        return np.array([active_set(self.W, one, start, **options) for one, start in zip(free, starts, strict=True)])

    def with_gap(self, gap):
        """Return λ with another initial gap, (m,) or (steps, m)."""
        return self.each(self.free + self.initial - gap)

    def by_rows(self, rows):
        """Return λ with the constraints multiplied by rows from the left."""
        return np.array([active_set(rows @ self.W @ rows.T, rows @ free) for free in self.free]) @ rows

    def on_pieces(self, values, change):
        """Return values (…, m) at the constraints, changed on each piece of Γ3."""
        return np.concatenate([change(one) for one in self.task.by_piece(values)], axis=-1)

    def named(self, rows):
        """Return the number of some constraints and the first of their vertices, with coordinates."""
        return counted(self.vertices[rows], "vertices", self.task.vertices)


def active_set(W, free, start=False, updates=60, release=True, tied=False):
    """Return λ ≥ 0 with gap = free − W λ ≤ 0 by a primal-dual active set; tied vertices are held and may pull."""
    held = np.zeros(len(free), bool) | tied | start
    scale = 1 / peak(np.diag(W))
    for count in range(updates + 1):
        lam = np.zeros(len(free))
        lam[held] = np.linalg.lstsq(W[np.ix_(held, held)], free[held], rcond=None)[0]
        wanted = tied | (lam + scale * (free - W @ lam) > 1e-12 * scale * peak(free))
        wanted = wanted if release else wanted | held
        if (wanted == held).all() or count == updates:
            break
        held = wanted
    return lam


CONTACT: list = [
    (
        "none",
        "contact is missing: no contact forces act",
        lambda p: 0 * p.right,
    ),
    (
        "normals",
        "the normals are reversed: contact acts on the wrong side",
        lambda p: -p.each(-p.free),
    ),
    (
        "pull:tied",
        "contact pulls: u_ν = 0 on the whole face, no vertex lifts off",
        lambda p: p.each(tied=True),
    ),
    (
        "gap areas",
        "the areas of the contact vertices are taken for the initial gaps",
        lambda p: p.with_gap(p.area / p.task.scale),
    ),
    (
        "gap order",
        "the initial gaps are in the reversed order",
        lambda p: p.with_gap(p.on_pieces(p.initial, np.flip)),
    ),
    *(
        row
        for k in (1, -1)
        for row in (
            (
                f"gap shift:{k}",
                "the initial gaps are shifted by one vertex",
                lambda p, k=k: p.with_gap(p.on_pieces(p.initial, lambda gap: np.roll(gap, k))),
            ),
            (
                f"force shift:{k}",
                "each contact force acts at the next vertex of the list",
                lambda p, k=k: p.on_pieces(p.right, lambda lam: np.roll(lam, k, 1)),
            ),
        )
    ),
    (
        "gap middle",
        "contact closes the gap in the middle of the step, (u_n + u_{n−1})/2, not at its end",
        lambda p: p.with_gap(p.initial + p.gap_before),
    ),
    (
        "gap left",
        "the gap that the step before left is taken for the initial gap",
        lambda p: p.with_gap(p.gap_before),
    ),
    (
        "pull:iterations",
        "vertices in contact are never released, although their forces pull",
        lambda p: p.each(release=False),
    ),
    (
        "facets",
        "contact is imposed on the mean gap of each facet (facet midpoints), not at the vertices",
        lambda p: p.by_rows(_facet_means(p)),
    ),
    *(
        (
            f"updates:{updates} {start}",
            f"the active set is updated only {times} in each step, starting from {start}",
            lambda p, updates=updates, held=held: p.each(starts=held(p), updates=updates),
        )
        for updates, times in ((1, "once"), (2, "twice"), (3, "three times"))
        for start, held in (
            ("no vertex", lambda p: None),
            ("all vertices", lambda p: [True] * len(p.lam)),
            (
                "the vertices of the step before",
                lambda p: [False, *p.pressed[:-1]],
            ),
        )
    ),
]
"""What the contact forces would be, (steps, m)."""
CONTACT_IN_STEPS: list = [
    (
        "late:forces",
        "contact is one step late: the contact forces are those of the step before",
        lambda p: np.roll(p.right, 1, 0) * ~p.first,
    ),
    (
        "late:vertices",
        "contact is one step late: the contact vertices are those of the step before",
        lambda p: p.each(starts=[p.pressed[0], *(p.right[:-1] > 0)], updates=0),
    ),
    (
        "first:only",
        "contact acts in the first step only",
        lambda p: p.right * p.first,
    ),
    (
        "first:missing",
        "contact is missing in the first step",
        lambda p: p.right * ~p.first,
    ),
    (
        "first:forces",
        "the contact forces of the first step are kept in all steps",
        lambda p: p.right[:1] + 0 * p.right,
    ),
    (
        "first:vertices",
        "the vertices in contact are found in the first step only and kept in all steps",
        lambda p: p.each(starts=p.pressed[:1] | (0 * p.right > 0), updates=0),
    ),
]
"""The same for tasks with several steps."""


def contact_causes(equations):
    """Yield every cause in the contact algorithm with the difference of contact forces that it leaves."""
    if equations.u[0].size > LARGEST_SOLVE:
        return
    p = ContactProblem(equations)
    without = peak(p.lam - p.right) / p.largest
    if without <= CONTACT_HOLDS:
        return
    rows = CONTACT + CONTACT_IN_STEPS * (len(p.lam) > 1)
    guesses = ((key, sentence, undo(p), 0) for key, sentence, undo in rows)
    for key, sentence, lam, numbers in (
        *guesses,
        *_found_sets(p),
        *_fitted_contact(p),
        *_laws(p),
    ):
        yield Cause(key, sentence, peak(p.lam - lam) / p.largest, without, numbers)


def _facet_means(problem):
    """Return rows that take the mean over each facet of the constraints at its vertices."""
    rows = []
    numbers = problem.task.by_piece(np.arange(len(problem.area)))
    for piece, row in zip(problem.task.contact, numbers, strict=True):
        on = [np.isin(problem.vertices[row], facet) / len(facet) for facet in piece["facets"]]
        rows += [np.bincount(row, part, len(problem.area)) for part in on if part.any()]
    return np.array(rows)


def _found_sets(problem):
    """Yield causes at vertices that the answer shows: forgotten constraints, vertices that pull, averaged normals."""
    p = problem
    unloaded = (abs(p.lam) <= p.small).all(axis=0)
    forgotten = unloaded & (p.gap > p.moved).any(axis=0)
    if forgotten.any() and not unloaded.all():
        words = f"the constraint is forgotten at {p.named(forgotten)}"
        yield "forgotten", words, p.by_rows(np.eye(len(p.area))[~forgotten]), 0
    pulled = (p.lam < -p.small).any(axis=0)
    if pulled.any() and not pulled.all():
        words = f"contact pulls at {p.named(pulled)}, which cannot lift off"
        yield "pull:some", words, p.each(tied=pulled), 0
    same = p.vertices[:, None] == np.unique(p.vertices)
    corners = same.sum(axis=0) > 1
    if corners.any():
        words = f"the normals of faces that meet are averaged at {p.named(same[:, corners].argmax(axis=0))}"
        yield "corner", words, p.by_rows(1.0 * same.T), 0


def _fitted_contact(problem):
    """Yield causes with numbers that are fitted: a factor, smoothing, gaps, an offset, a pressure."""
    p = problem
    factor = _factor(p.lam, p.right)
    words = f"the contact forces that act on the body are {factor:.8g} times the right ones"
    yield "scaled", words, factor * p.right, 1
    means = _facet_means(p)
    near = means.T @ means
    spread = p.right @ near - p.right * near.sum(axis=0)
    words = "contact forces act in part at the neighbouring vertices (smoothing)"
    yield "smoothed", words, p.right + _factor(p.lam - p.right, spread) * spread, 1
    reached = (p.gap + p.initial).max(axis=0)
    touched = p.pressed.any(axis=0)
    factor = _factor(reached * touched, p.initial * touched)
    words = f"the initial gap {factor_words(factor)}"
    yield "gap", words, p.with_gap(factor * p.initial), int(ODD in words)
    odd = touched & (abs(reached - p.initial) > p.moved)
    if odd.any() and p.pressed.sum() >= 2 * touched.sum():
        words = f"the initial gap is another one at {p.named(odd)}"
        used = np.where(touched, reached, np.maximum(reached, p.initial))
        yield "gap:other", words, p.with_gap(used), odd.sum()
    if p.pressed.any():
        offset = np.median(p.gap[p.pressed])
        words = f"contact is closed where u_ν − gap is {offset:.4g} (an offset or a tolerance), not 0"
        yield "offset", words, p.each(p.free - offset), 1
    open_ = p.gap < -p.moved
    if (p.pressed & open_).any():
        pressures = (p.lam / p.area * open_).sum(axis=1) / np.maximum(open_.sum(axis=1), 1)
        words = f"a pressure of up to {pressures.max():.4g} acts on the contact face where the gap is open, too"
        before = np.multiply.outer(pressures, p.area)
        yield "pressure", words, before + p.each(p.free - before @ p.W), 1


LAWS: list = [
    (
        "springs",
        "contact is by springs (a penalty) of stiffness {k:.4g}",
        lambda g, s: np.maximum(g, 0),
    ),
    (
        "springs pull",
        "contact is by springs that also pull (a penalty) of stiffness {k:.4g}",
        lambda g, s: g,
    ),
    (
        "smooth springs",
        "contact is by springs of stiffness {k:.4g}, smoothed over {s:.3g}",
        lambda g, s: g + np.hypot(g, s),
    ),
    (
        "barrier inverse",
        "contact is by a barrier: force times distance is {k:.4g} (logarithmic barrier, interior point or smoothed "
        "complementarity that stops early)",
        lambda g, s: (g < 0) / np.where(g < 0, -g, 1),
    ),
    (
        "barrier",
        "contact is by a logarithmic barrier of stiffness {k:.4g} that acts from a distance of {s:.3g} on",
        lambda g, s: _barrier(np.where((g < 0) & (-g < s), -g, s), s),
    ),
]
"""Contact forces up to a factor k as functions of u_ν − gap and of a length s."""


def _barrier(d, s):
    return (d - s) ** 2 / d + 2 * (d - s) * np.log(d / s)


def _laws(problem):
    """Yield the causes that contact forces are functions of the gap, for each area, facet or vertex."""
    p = problem
    weights = {
        "for each area": p.area,
        "for each vertex, whatever its area (half at the ends)": np.ones_like(p.area),
        "for each facet and area of a vertex (counted twice inside the face)": p.area * p.ends,
    }
    lengths = peak(p.gap) * np.geomspace(1e-6, 10, 60)
    for per, weight in weights.items():
        for key, sentence, law in LAWS:
            numbers = 1 + ("{s" in sentence)
            k, s, lam = scanned(
                lambda s, weight=weight, law=law: weight * law(p.gap, s),
                p.lam,
                lengths,
            )
            if k > 0 and p.pressed.sum() > 2 * numbers:
                yield (
                    f"{key}:{per}",
                    f"{sentence.format(k=k, s=s)} {per}",
                    lam,
                    numbers,
                )


def scanned(shape, values, lengths):
    """Return k and s, and k shape(s), which is as close to values as possible, for lengths s and finer ones."""

    def apart(s):
        return peak(values - _factor(values, shape(s)) * shape(s))

    for _ in range(6):
        best = int(np.argmin([apart(s) for s in lengths]))
        s = lengths[best]
        lengths = np.geomspace(
            lengths[max(best - 1, 0)],
            lengths[min(best + 1, len(lengths) - 1)],
            21,
        )
    k = _factor(values, shape(s))
    return k, s, k * shape(s)


def orders(h, errors):
    """Return the orders between neighbouring meshes; infinite where nothing is left."""
    steps = zip(h, h[1:], errors, errors[1:], strict=False)
    return [float(np.log(a / b) / np.log(k / m)) if min(a, b) > 0 else float("inf") for k, m, a, b in steps]


def order(h, errors):
    """Return the order between the last two meshes; nan from one mesh."""
    return orders(h, errors)[-1] if len(h) > 1 else float("nan")


@dataclass(frozen=True)
class Judgement:
    """A code on one case, mesh by mesh; orders between the last two meshes, ``order_of_best`` that of K^h.

    ``why`` has the reason of the verdict, ``where`` says at which vertices and in which steps the equations are
    violated, ``cause`` is the most likely reason or "", ``causes`` its parts.
    ``tested`` says how many constraints of the exact solution are in contact at some step on the last mesh, are free at
    some step, and exist.
    """

    case: str
    family: str
    mode: str
    scale: float
    levels: list[int]
    errors: list[Errors]
    verdict: str
    why: str
    tested: tuple[int, int, int]
    order_in_v: float
    order_of_best: float
    order_of_distance: float
    order_of_pressure: float
    where: str = ""
    cause: str = ""
    reports: list[Report] = field(default_factory=list)
    causes: dict[str, str] = field(default_factory=dict)

    @property
    def name(self):
        """The case, and the load scale if it is not 1."""
        return f"{self.case} × {self.scale:g}" if self.scale != 1 else self.case

    def outcome(self, tolerance=0.0):
        """Return holds (class of ``GOOD``, or distance of at most ``tolerance`` on all meshes), fails or undecided."""
        within = max(one.share for one in self.errors) <= tolerance and self.verdict != "wrong"
        if not all(report.right for report in self.reports):
            return "fails"
        if self.verdict in GOOD or within:
            return "holds"
        return "undecided" if self.verdict == "undecided" else "fails"


def order_of(name, h, errors):
    """Return the order of an attribute of the errors between the last two meshes; nan from one mesh."""
    return order(h, [getattr(one, name) for one in errors])


def classify(h: list[float], errors: list[Errors]) -> str:
    """Return the class of a code from its errors, mesh by mesh (docs/reference/tasks.md)."""
    return judged(h, errors)[0]


def judged(h, errors, levels=None):
    """Return the class, and the numbers that decided; a mesh is named by its level, or without ``levels`` by 1 / h."""
    shares = [one.share for one in errors]
    last = errors[-1]
    meshes = [f"n = {n:g}" for n in levels or 1 / floats(h)]
    if max(shares) <= EXACT and max(one.from_best for one in errors) <= 10 * EXACT:
        return EXACT_CLASS, f"{max(shares):.0e} of the error"
    if reason := next(_far_off(h, errors, meshes), None):
        return "wrong", reason
    if len(h) < 2:
        return (
            "undecided",
            f"one mesh, not exact: {shares[-1]:.1e} of the error",
        )
    fall = orders(h, [one.share * one.best for one in errors])
    texts = [
        f"{k:.1f}" if min(two) > EXACT else "none to an exact mesh"
        for k, two in zip(fall, pairwise(shares), strict=True)
    ]
    told = f"order of the distance {', '.join(texts)} on {len(h)} meshes"
    if len(h) < MESHES:
        return "undecided", f"{told}; {MESHES} meshes are needed"
    needed = min(FALLS, max(order_of("best", h, errors) / 2, LEAST_FALL))
    if fall[-1] < needed and shares[-1] > EXACT:
        return "stagnates", f"at {shares[-1]:.1e} of the error, {told}"
    pressure = order_of("pressure", h, errors)
    of_best = order_of("best_pressure", h, errors)
    if pressure < min(PRESSURE_FALLS, of_best - NECESSARY):
        return "stagnates", f"in the pressure, order {pressure:.1f}"
    if last.outside > FEW_FORCES:
        return (
            "undecided",
            f"forces of {last.outside:.1e} of the load remain outside the cells at Γ3; {told}",
        )
    return CONSISTENT, told


def _far_off(h, errors, meshes):
    """Yield why an answer is far off, and on which mesh."""
    last = errors[-1]
    moved = [one.on_clamp for one in errors]
    distances = [one.share * one.best for one in errors]
    fall = [0.0, *orders(h, distances), 0.0]
    held = moved[-1] <= AGREES or (order(h, moved) >= FALLS and moved[-1] < LARGE_ON_CLAMP)
    for k, (one, mesh) in enumerate(zip(errors, meshes, strict=True)):
        final = one is last
        large = one.share > LARGE_SHARE and not final
        finest = final and len(h) > 1
        grows = fall[k] < -FALLS and one.share > (NEGLIGIBLE if finest else PEAK)
        drops = fall[k + 1] > JUMP and distances[k] > FACTOR * distances[k + 1]
        reasons = {
            "values are not numbers or too large": not one.share < np.inf,
            f"u on Γ1 must be 0, it is up to {one.on_clamp:.1e} of {OF_LARGEST}": (
                (large and one.on_clamp > LARGE_ON_CLAMP) or (final and one.share > NEGLIGIBLE and not held)
            ),
            f"displacements are wrong by {one.from_best:.0e} times {OF_LARGEST}": one.from_best > FAR,
            f"the distance grows to {one.share:.1e} of the error": grows and finest,
            f"the pressure is no better than none, error {one.pressure:.2f}": finest and one.pressure >= NO_CONTACT,
            f"other equations, forces of {one.tangential:.2g} of the load where none may be": (
                (large and one.tangential >= UNBALANCED) or (finest and one.tangential >= OTHER_EQUATIONS)
            ),
            f"the distance is {one.share:.1e} of the error, and much less on the next": drops and (large or grows),
        }
        yield from (f"on the mesh {mesh} {words}" for words, applies in reasons.items() if applies)


def assess(
    tasks: list[Task],
    answers: dict[str, Array],
    reports: dict[str, dict[str, Array]] | None = None,
) -> list[Judgement]:
    """Return one judgement for each case, mesh family, mode and load scale.

    answers are names of tasks ↦ u, (steps, n, d); reports names of tasks ↦ what ``judge_reports`` takes. TaskError if
    an answer is missing or of another shape, or if two tasks of one series have the same level.
    """
    groups: dict = defaultdict(dict)
    for task in sorted(tasks, key=lambda one: one.level):
        shape = (task.count, *task.vertices.shape)
        axes = "steps, vertices, components"
        u = as_array(answers.get(task.name), shape, f"the answer to {task.name}", axes)
        series = groups[task.case, task.data["family"], task.data["mode"], task.scale]
        if task.level in series:
            raise TaskError(f"{task.name} has the case and the level of another task; judge one of them alone")
        series[task.level] = task, u
    return [_judgement(key, *zip(*series.values(), strict=True), reports or {}) for key, series in groups.items()]


def _judgement(key, tasks, answers, reports):
    """Judge one case on one mesh family in one mode, under one load scale."""
    h = [task.h for task in tasks]
    levels = [task.level for task in tasks]
    errors = [measure(task, u) for task, u in zip(tasks, answers, strict=True)]
    verdict, why = judged(h, errors, levels)
    differing = [k for k, one in enumerate(errors) if not one.share <= EXACT]
    cause = diagnose([tasks[k] for k in differing], [answers[k] for k in differing]) if differing else Diagnosis()
    words = "; or ".join(cause.causes.values())
    if cause.is_fault(errors[-1].share) and verdict in (
        "undecided",
        CONSISTENT,
    ):
        verdict = "wrong"
        why = "the cause below is certain"
    if verdict == CONSISTENT and words and not cause.may_vanish():
        verdict = "undecided"
        why = f"{words}: fits better than a distance that vanishes, {why}"
    last = [order_of(name, h, errors) for name in ("error", "best", "distance", "pressure")]
    told = []
    for task, u in zip(tasks, answers, strict=True):
        told += judge_reports(task, u, reports.get(task.name, {}))
    return Judgement(
        *(*key, levels, errors, verdict, why, tested(tasks[-1]), *last),
        where=cause.where,
        cause=cause.sentence,
        reports=told,
        causes=cause.causes,
    )


def unpack(task, directory):
    """Write a task as text files, for programs that read no JSON: what the page on the format lists."""
    place = Path(directory) / task.name
    place.mkdir(parents=True, exist_ok=True)
    files = {
        "cells": task.cells,
        "clamped": task.clamped,
        "vertices": task.vertices,
        "stiffness": task.stiffness,
    }
    pieces = zip(task.contact, task.pieces(), task.gaps(), strict=True)
    for i, (piece, (normal, vertices, _), gap) in enumerate(pieces, start=1):
        files |= {f"contact_{i}": whole(piece["facets"]), f"gap_{i}": gap}
        files |= {f"constrained_{i}": vertices, f"normal_{i}": normal[None]}
    if task.marches:
        files |= {
            "A": task.A,
            "G": task.G,
            "start": task.start(),
            "step": floats([task.data["step"]]),
        }
    for n, one in enumerate(task.data["steps"], start=1):
        files |= {f"{key}_{n}": floats(one[key]) for key in ("load", "initial_stress") if key in one}
    for name, values in files.items():
        rows = values.reshape(len(values), -1)
        np.savetxt(
            place / f"{name}.txt",
            rows,
            fmt="%d" if values.dtype.kind == "i" else "%.17g",
        )


HEAD = (
    "case                  meshes       mode   n         V order  distance  pressure  of K^h"
    "  exact pressed  exact free  class"
)
ROW = "{:<22}{:<13}{:<7}{:<9}{:>8.2f}{:>10.1e}{:>10.3f}{:>8.3f}{:>15}{:>12}  {}"


def table(judgements, tolerance=0.0):
    """Return what the judgements say, in lines; numbers are those of the last mesh."""
    lines = [HEAD]
    for one in judgements:
        last = one.errors[-1]
        (pressed, free, count) = one.tested
        what = f"{one.verdict} ({one.why})"
        if one.verdict not in GOOD and one.outcome(tolerance) == "holds":
            what += f", passes: at most {tolerance:g} of the error"
        if wrong := {report.name: "" for report in one.reports if not report.right}:
            what += f", fails: wrong reported {', '.join(wrong)}"
        levels = " ".join(map(str, one.levels))
        sizes = one.order_in_v, last.share, last.pressure, last.best_pressure
        counts = f"{pressed}/{count}", f"{free}/{count}"
        lines.append(ROW.format(one.name, one.family, one.mode, levels, *sizes, *counts, what))
        lines += [f"    {note}" for note in notes(one)]
    return "\n".join([*lines, *summary(judgements)])


def summary(judgements):
    """Return a line that names the cause that explains most cases; none unless a cause explains two cases."""
    keys = [key for one in judgements for key in one.causes]
    if len(keys) == len(set(keys)):
        return []
    best = max(keys, key=keys.count)
    first, *_ = (one for one in judgements if best in one.causes)
    line = f"{keys.count(best)} of {len(judgements)} cases: {first.causes[best]} (so in {first.case})"
    exact = [one.case for one in judgements if one.verdict == EXACT_CLASS]
    return [line + (f"; {', '.join(exact)} cannot show it" if exact else "")]


def notes(one):
    """Return what the class does not say: first where the equations are violated, then the cause, then numbers."""
    lines = [
        one.where,
        one.cause,
        *_remarks(one, one.errors[-1]),
        *(report.sentence for report in one.reports),
    ]
    return [line for line in lines if line]


def _remarks(one, last):
    """Yield what is noteworthy in the numbers."""
    if abs(one.order_in_v - one.order_of_best) > NECESSARY:
        both = f"{one.order_in_v:.2f}, of the solution in K^h {one.order_of_best:.2f}"
        yield f"the observed order of the error in V is {both}: a right code has the same order"
    if one.verdict == CONSISTENT and last.share > LARGE_SHARE:
        yield f"the distance tends to 0, but on the last mesh it is still {last.share:.0%} of the error"
    if one.verdict == CONSISTENT and last.pressure > LARGE_PRESSURE * last.best_pressure:
        yield f"the pressure has {last.pressure / last.best_pressure:.0f} times the error of the solution in K^h"


def as_json(judgements, tolerance=0.0):
    """Return all numbers as JSON (docs/reference/contact-verdict.schema.json); what is no number is null."""
    rows = [asdict(one) | {"outcome": one.outcome(tolerance)} for one in judgements]
    numbers = json.loads(json.dumps(rows), parse_constant=lambda _: None)
    return json.dumps(numbers, indent=1, allow_nan=False)


def as_junit(judgements, tolerance=0.0):
    """Return JUnit XML: one test case for each judgement; undecided ones are failures."""
    suite = ElementTree.Element("testsuite", name="contact_judge", tests=str(len(judgements)))
    for one in judgements:
        outcome = one.outcome(tolerance)
        reason = f"{one.verdict} ({one.why})"
        name = f"{one.name}, {one.family}, {one.mode}, n = {' '.join(map(str, one.levels))}"
        case = ElementTree.SubElement(suite, "testcase", classname="contact_judge", name=name)
        if outcome != "holds":
            failure = ElementTree.SubElement(case, "failure", message=f"{outcome}: {reason}")
            failure.text = "\n".join([reason, *notes(one)])
    suite.set("failures", str(len(list(suite.iter("failure")))))
    return ElementTree.tostring(suite, encoding="unicode", xml_declaration=True) + "\n"


VIEW = floats([[1, 0], [0, -1], [0.4, -0.3]])
"""Coordinates in the picture of the axes x, y and z; in an SVG, the second one points down."""


def picture(tasks, answers):
    """Return an SVG of the answer farthest from the solution in K^h.

    It has the mesh, Γ3, and the forces that remain in the worst step, if they do not balance.
    """
    shares = {task: share for task in tasks if (share := measure(task, answers[task.name]).share) < np.inf}
    if not shares:
        raise TaskError("--plot has nothing to draw: there is no answer whose values are numbers")
    task = max(shares, key=shares.get)
    e = Equations(task, answers[task.name] / task.scale)
    view = VIEW[: task.dim]
    points = task.vertices @ view
    forces = e.total @ view
    at = 50 + 600 * (points - points.min(axis=0)) / np.ptp(points, axis=0).max()
    worst = abs(forces).max(axis=(1, 2)).argmax()
    marked = e.bad & (not e.balanced)
    ends = at + 60 * forces[worst] / peak(forces)
    drawn = [
        (at[task.cells], "#bbb", 1),
        (
            at[[facet for piece in task.contact for facet in piece["facets"]]],
            "#000",
            3,
        ),
        (np.stack([at, ends], axis=1)[marked], "#c00", 2),
        (at[marked][:, None], "#c00", 9),
    ]
    lines = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 700 700" fill="none" stroke-linecap="round">']
    for polygons, color, width in drawn:
        path = " ".join("M" + " L".join(f"{x:.1f},{y:.1f}" for x, y in polygon) + "Z" for polygon in polygons)
        lines.append(f'<path d="{path}" stroke="{color}" stroke-width="{width}"/>')
    return "\n".join([*lines, "</svg>\n"])


def options_of(arguments):
    """Return the options of the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    add = parser.add_argument
    add("tasks", type=Path, metavar="TASKS", help="directory of `study export`")
    add(
        "answers",
        type=Path,
        metavar="ANSWERS",
        help="directory with NAME/u.txt for each task",
    )
    add(
        "--unpack",
        action="store_true",
        help="write the tasks to ANSWERS as text files",
    )
    add(
        "--only",
        nargs="+",
        default=["*"],
        metavar="CASE",
        help="cases or tasks: corner or '*-8'",
    )
    add(
        "--tolerance",
        type=float,
        default=0.0,
        metavar="X",
        help="pass X of the discretisation error",
    )
    add(
        "--plot",
        type=Path,
        metavar="FILE.svg",
        help="draw the mesh with the forces that remain",
    )
    add("--json", action="store_true", help="print all numbers as JSON")
    add(
        "--junit",
        type=Path,
        metavar="FILE",
        help="also write the verdicts as JUnit XML",
    )
    return parser.parse_args(arguments)


def chosen(tasks, names):
    """Return the tasks whose case or name is one of some names or patterns; TaskError if a name is none."""
    result = {}
    for name in names:
        found = {task.name: task for task in tasks if fnmatch(task.name, name) or fnmatch(task.case, name)}
        if not found:
            cases = ", ".join(dict.fromkeys(task.case for task in tasks))
            raise TaskError(f"--only {name} is no case and no task; there are tasks of {cases}")
        result |= found
    return list(result.values())


def read_all(tasks, directory):
    """Return the tasks whose answers can be read, answers, reports, and why others cannot."""
    answers = {}
    reports = {}
    faults = []
    for task in tasks:
        try:
            reports[task.name] = read_reports(directory, task)
            answers[task.name] = read_answer(directory, task)
        except TaskError as error:
            faults.append(str(error))
    return (
        [task for task in tasks if task.name in answers],
        answers,
        reports,
        faults,
    )


def _run(options):
    """Do what the options say; return the outcomes and why answers cannot be read."""
    tolerance = options.tolerance
    if not 0 <= tolerance < np.inf:
        raise TaskError(f"--tolerance must be a number of 0 or more, got {tolerance:g}")
    tasks = chosen(read_tasks(options.tasks), options.only)
    if options.unpack:
        for task in tasks:
            unpack(task, options.answers)
        return [], []
    tasks, answers, reports, faults = read_all(tasks, options.answers)
    with np.errstate(all="ignore"):
        judgements = assess(tasks, answers, reports)
        if options.plot and tasks:
            options.plot.write_text(printable(picture(tasks, answers)), encoding="utf-8")
    if options.junit:
        options.junit.write_text(printable(as_junit(judgements, tolerance)), encoding="utf-8")
    if judgements:
        print(printable((as_json if options.json else table)(judgements, tolerance)))
    return [one.outcome(tolerance) for one in judgements], faults


def main(arguments=None):
    """Run the command; 0 all hold, 1 one fails, 2 usage or input, 3 one is undecided."""
    options = options_of(arguments)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")  # A terminal in ASCII or cp1252 has no Γ.
    try:
        outcomes, faults = _run(options)
    except (TaskError, OSError) as error:
        unreadable = isinstance(error, OSError) and f"cannot read or write {error.filename}: {error.strerror or error}"
        outcomes = []
        faults = [unreadable or error]
    for fault in faults:
        print(printable(f"contact_judge: {fault}"), file=sys.stderr)
    if faults:
        return 2
    return 1 if "fails" in outcomes else 3 if "undecided" in outcomes else 0


if __name__ == "__main__":
    if hasattr(signal, "SIGPIPE"):
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # A reader such as `head` may close the pipe.
    sys.exit(main())
