"""Judge a contact code on problems whose exact solutions are known. One file, NumPy alone: copy it.

    python contact_judge.py TASKS ANSWERS [--json]      errors and classes; exit 0 if all are exact or consistent
    python contact_judge.py --unpack TASKS DIR          the tasks as directories of text files

TASKS holds files *.json.xz in the format contact-task 1 (docs/reference/tasks.md), ANSWERS for the task NAME.json.xz a
file NAME/u.txt: a line for each step, with the displacements u_x u_y (u_z) of vertex after vertex, in the units of the
task. From Python, ``answer`` drives a code and ``assess`` judges it (docs/how-to/verify-a-contact-code.md).

Norms are ‖v‖_V = (A ε(v), ε(v))^½. The exact strain is known by its means ε̄ over the cells and by one number for each
step, ∫ A (ε − ε̄)·(ε − ε̄): the error of a function with strains constant on cells depends on nothing else.
"""

from __future__ import annotations

import argparse
import gzip
import hashlib
import json
import lzma
import sys
import zlib
from collections import defaultdict
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

EXACT = 1e-5
"""Distance from the solution in K^h, relative to the discretisation error, up to which a code is exact for P1: what
iterations are stopped at. A contact law that tends to the right one leaves more on meshes anybody uses."""
FALLS = 0.5
"""Order from which on a distance falls under refinement; with its negative it grows. Half of the order of the error."""
PRESSURE_FALLS = 2 / 3
"""Order from which on the error of the pressure falls, or that of the solution in K^h if it falls more slowly. A vertex
that is not held leaves an error on the size h of Γ3, whose norm in L² has the order ½, between .4 and .6 on shaken
meshes. The solution in K^h had .87 or more up to n = 32, but from one random mesh to the next, 32 to 64, down to .1."""
MESHES = 3
"""Meshes without which nothing is said of an order: on the first two, an error of quadrature that falls fast hides one
that does not."""
NEGLIGIBLE = 0.01
"""Distance relative to the discretisation error up to which one that grows is not wrong: the error changes by a
hundredth at most, and what is made of so little (quadrature, iterations) need not fall in every step."""
NO_CONTACT = 0.9
"""Relative error of the pressure from which on a code is wrong: no contact at all has 1."""
OTHER_EQUATIONS = 0.1
"""Part of the load that is left where no force may be, from which on a code is wrong: an elastic body of another
stiffness, say. Methods of Nitsche's kind leave up to some hundredths."""
FEW_FORCES = 1e-3
"""Part of the load from which on forces where none may be are mentioned."""
LARGE_PRESSURE = 3
"""Times the error of K^h from which on the pressure of a consistent code is mentioned."""
NEXT_TO_NOTHING = 0.1
"""Part of the force that the solution in K^h has at a vertex, up to which the vertex is idle, and part of the largest
pressure from which on it is asked."""
NECESSARY = 0.15
"""Distance of an order from that of the solution in K^h that is still the same."""
GOOD = "exact for P1", "consistent"
UNPACK = {".xz": lzma.decompress, ".gz": gzip.decompress}


class TaskError(ValueError):
    """A task or an answer cannot be read."""


class Task:
    """One problem on one mesh: static steps, one after the other, and what answers are judged by.

    Attributes:
        name: of the file.
        data: as it was read, arrays as lists.
        vertices, cells: (n, d), (cells, d + 1).
        stiffness: C of the static steps for every cell, Mandel, (cells, D, D): G, in a march A/k + G/2.
        clamped: numbers of the vertices at which u = 0.
        count: of steps.
    """

    def __init__(self, name: str, data: dict) -> None:
        if data.get("format") != "contact-task" or data.get("version") != 1:
            raise TaskError(f"{name} is {data.get('format')} {data.get('version')}, expected contact-task 1")
        self.name, self.data = name, data
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

    @classmethod
    def read(cls, path: Path) -> Task:
        """A task from NAME.json.xz, NAME.json.gz or NAME.json."""
        path = Path(path)
        packed = path.read_bytes()
        try:
            data = json.loads(UNPACK.get(path.suffix, bytes)(packed))
        except (OSError, EOFError, ValueError, lzma.LZMAError, zlib.error) as error:
            raise TaskError(f"{path} is no JSON: {error}") from error
        return cls(path.name.partition(".json")[0], data)

    @property
    def dim(self) -> int:
        return self.vertices.shape[1]

    def _tensor(self, constants: dict) -> np.ndarray:
        factor = np.broadcast_to(np.array(constants["factor"], float), len(self.cells))
        return factor[:, None, None] * np.array(constants["matrix"], float)

    def strain(self, u: np.ndarray) -> np.ndarray:
        """ε(u) on the cells, Mandel, (cells, D), from values at the vertices (n, d)."""
        gradient = np.einsum("cij,cik->cjk", u[self.cells], self.gradients)
        return np.stack([_weight(i, j) * (gradient[:, i, j] + gradient[:, j, i]) / 2 for i, j in pairs(self.dim)], 1)

    def internal(self, stress: np.ndarray) -> np.ndarray:
        """(σ, ε(φ_i e_j))_Q for stresses on the cells (cells, D), at the vertices (n, d)."""
        full = np.zeros((len(self.cells), self.dim, self.dim))
        for component, (i, j) in zip(stress.T, pairs(self.dim), strict=True):
            full[:, i, j] = full[:, j, i] = component / _weight(i, j)
        forces = np.einsum("c,cij,ckj->cki", self.volumes, full, self.gradients)
        found = np.zeros_like(self.vertices)
        np.add.at(found, self.cells, forces)
        return found

    def step(self, n: int, before: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(b, s_0) of step n: work of the loads (n, d), initial stress (cells, D); u of the step before in a march."""
        given = self.data["steps"][n]
        load = np.array(given["load"], float)
        if not self.marches:
            return load, np.array(given["initial_stress"], float)
        history = self.G / 2 - self.A / self.data["step"]
        return load, np.einsum("cij,cj->ci", history, self.strain(before))

    def start(self) -> np.ndarray:
        """u before the first step, (n, d); zero unless it marches."""
        return np.array(self.data["start"], float) if self.marches else np.zeros_like(self.vertices)

    def norm(self, strain: np.ndarray) -> float:
        """(Σ |T| A ε·ε)^½."""
        return float(np.sqrt(np.einsum("c,cij,ci,cj->", self.volumes, self.A, strain, strain)))

    def pieces(self) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """ν (d,), the constrained vertices (m,) and Σ ∫ φ_i (m,) of each piece of contact."""
        found = []
        for piece in self.data["contact"]:
            facets, normal = np.array(piece["facets"], int), np.array(piece["normal"], float)
            edges = self.vertices[facets[:, 1:]] - self.vertices[facets[:, :1]]
            gram = np.linalg.det(edges @ np.swapaxes(edges, 1, 2))
            share = np.sqrt(gram) / (1, 1, 2)[self.dim - 1] / self.dim
            mass = np.zeros(len(self.vertices))
            np.add.at(mass, facets, share[:, None])
            vertices = np.array(piece["vertices"], int)
            found.append((normal, vertices, mass[vertices]))
        return found


def pairs(dim: int) -> list[tuple[int, int]]:
    """Index pairs of Mandel components: 11, 22, 12 or 11, 22, 33, 23, 13, 12."""
    return [(0, 0), (1, 1), (0, 1)] if dim == 2 else [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]


def _weight(i: int, j: int) -> float:
    return 1.0 if i == j else float(np.sqrt(2))


def read_tasks(directory: Path) -> list[Task]:
    """All tasks of a directory, after a look at SHA256SUMS if there is one."""
    sums = Path(directory) / "SHA256SUMS"
    for line in sums.read_text().splitlines() if sums.exists() else []:
        wanted, name = line.split()
        if hashlib.sha256((Path(directory) / name).read_bytes()).hexdigest() != wanted:
            raise TaskError(f"{name} is not the file that SHA256SUMS stands for: export or copy it again")
    found = sorted(Path(directory).glob("*.json*"))
    if not found:
        raise TaskError(f"{directory} holds no *.json.xz")
    return [Task.read(path) for path in found]


def answer(task: Task, make, scale: float = 1.0) -> np.ndarray:
    """u of all steps, (steps, n, d), by a code: make(task) ↦ step, step(b, s0) ↦ u; all loads times ``scale``."""
    step, u, found = make(task), scale * task.start(), []
    for n in range(task.count):
        load, stress = task.step(n, u)
        if not task.marches:
            stress = scale * stress
        u = np.asarray(step(scale * load, stress), float)
        found.append(u / scale)
    return np.array(found)


def write_answer(directory: Path, task: Task, u: np.ndarray) -> None:
    """DIRECTORY/NAME/u.txt."""
    place = Path(directory) / task.name
    place.mkdir(parents=True, exist_ok=True)
    np.savetxt(place / "u.txt", u.reshape(len(u), -1), fmt="%.17g")


def read_answer(directory: Path, task: Task) -> np.ndarray:
    """The answer to a task, (steps, n, d)."""
    path = Path(directory) / task.name / "u.txt"
    shape = (task.count, *task.vertices.shape)
    try:
        found = np.loadtxt(path, ndmin=2)
    except (OSError, ValueError) as error:
        raise TaskError(f"there is no answer {path} that can be read: {error}") from error
    if found.size != np.prod(shape):
        raise TaskError(f"{path} has {found.size} numbers, expected {shape[0]} lines of {shape[1] * shape[2]}")
    return found.reshape(shape)


@dataclass(frozen=True)
class Errors:
    """What one answer leaves on one mesh, the largest over the steps.

    Attributes:
        error: ‖u − u^h‖_V; ``best`` the same of the solution in K^h.
        discrete: ‖Π^h u − u^h‖_V.
        distance: from the solution in K^h, in V.
        pressure: ‖p − p^h‖ in L²(Γ3) over the largest ‖p‖, p^h from what balances the nodes; ``best_pressure`` of K^h.
        penetration: largest u_ν over the largest |u|.
        resultant: largest |∫ p − Σ λ_i| over the largest ∫ p.
        tangential: largest force on Γ3 along it, and on nodes off Γ3 at all, over the largest load: other equations.
        idle: vertices on which the solution in K^h presses and this one does not, over all steps together.
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


def measure(task: Task, u: np.ndarray) -> Errors:
    """Judge the answer to one task, (steps, n, d)."""
    exact = [np.array(one["reference"], float) for one in task.data["judge"]]
    mine, theirs = _contact(task, u / task.scale), _contact(task, np.array(exact))
    rows = [_in_v(task, one, v / task.scale) for one, v in zip(task.data["judge"], u, strict=True)]
    error, best, discrete, distance = np.max(rows, axis=0) if np.isfinite(rows).all() else [np.inf] * 4
    numbers = map(float, (error, best, discrete, distance, mine[0], theirs[0], *mine[1:]))
    return Errors(*numbers, idle(task, u / task.scale, np.array(exact)))


def _in_v(task: Task, exact: dict, u: np.ndarray) -> list[float]:
    """‖u − u^h‖, the same for K^h, ‖Π^h u − u^h‖ and the distance, at one step."""
    means, reference = np.array(exact["strain"], float), np.array(exact["reference"], float)
    apart = [task.norm(means - task.strain(v)) for v in (u, reference)]
    nodes = [task.norm(task.strain(np.array(v, float) - u)) for v in (exact["displacement"], reference)]
    return [*np.sqrt(exact["rest"] + np.square(apart)), *nodes]


def balance(task: Task, u: np.ndarray) -> list[tuple[list[np.ndarray], np.ndarray, np.ndarray]]:
    """For each step λ_i at the vertices of each piece, what is still out of balance (n, d), and the load (n, d)."""
    pieces, before, found = task.pieces(), task.start() / task.scale, []
    for n, now in enumerate(u):
        load, stress = (part / task.scale for part in task.step(n, before * task.scale))
        elastic = np.einsum("cij,cj->ci", task.stiffness, task.strain(now))
        left = load - task.internal(elastic + stress)
        left[task.clamped] = 0
        forces = carried(left, pieces)
        for (normal, vertices, _), force in zip(pieces, forces, strict=True):
            left[vertices] -= force[:, None] * normal
        found.append((forces, left, load))
        before = now
    return found


def _contact(task: Task, u: np.ndarray) -> tuple[float, float, float, float]:
    """Pressure error, penetration, error of the resultant, what is out of balance; of displacements (steps, n, d)."""
    pieces, worst = task.pieces(), []
    for exact, now, (forces, left, load) in zip(task.data["judge"], u, balance(task, u), strict=True):
        p = [np.array(values, float) for values in exact["pressure"]]
        squares = [
            [mass @ (force / mass - values) ** 2, mass @ values**2]
            for (_, _, mass), force, values in zip(pieces, forces, p, strict=True)
        ]
        deepest = max((now[vertices] @ normal).max() for normal, vertices, _ in pieces)
        totals = np.array([force.sum() for force in forces]), np.array(exact["resultant"], float)
        sizes = [abs(totals[0] - totals[1]).max(), abs(totals[1]).max(), abs(left).max(), abs(load).max()]
        worst.append([*np.sqrt(np.sum(squares, axis=0)), max(deepest, 0), abs(now).max(), *sizes])
    most = np.max(worst, axis=0) if np.isfinite(worst).all() else np.full(8, np.inf)
    return tuple(float(a / max(b, 1e-300)) if np.isfinite(a) else np.inf for a, b in most.reshape(4, 2))


def idle(task: Task, u: np.ndarray, reference: np.ndarray) -> tuple[int, ...]:
    """Vertices that the reference presses, over all steps, and u next to nothing."""
    found, pieces = set(), task.pieces()
    totals = [
        [sum(step) for step in zip(*(forces for forces, *_ in balance(task, v)), strict=True)] for v in (u, reference)
    ]
    most = max((force / mass).max() for (_, _, mass), force in zip(pieces, totals[1], strict=True))
    for (_, vertices, mass), mine, theirs in zip(pieces, *totals, strict=True):
        asked = theirs / mass >= NEXT_TO_NOTHING * most
        found |= set(vertices[asked & (mine <= NEXT_TO_NOTHING * theirs)].tolist())
    return tuple(sorted(found)) if most > 0 else ()


def tested(task: Task) -> tuple[int, int, int]:
    """Constraints u_i·ν ≤ 0 that are in contact at some step, that are free at some step, and all of them."""
    pressed = free = count = 0
    for i, (normal, vertices, _) in enumerate(task.pieces()):
        p = np.array([one["pressure"][i] for one in task.data["judge"]], float)
        u = np.array([one["displacement"] for one in task.data["judge"]], float)
        pressed += int((p > 0).any(axis=0).sum())
        free += int((u[:, vertices] @ normal < -1e-9 * abs(u).max()).any(axis=0).sum())
        count += len(vertices)
    return pressed, free, count


def carried(forces: np.ndarray, pieces: list) -> list[np.ndarray]:
    """λ_i at the vertices of each piece from what is out of balance, (n, d): least squares where pieces meet."""
    normals = defaultdict(list)
    for number, (normal, vertices, _) in enumerate(pieces):
        for vertex in vertices:
            normals[int(vertex)].append((number, normal))
    shares = {v: np.linalg.pinv(np.array([n for _, n in on]).T) @ forces[v] for v, on in normals.items()}
    order = {v: {number: k for k, (number, _) in enumerate(on)} for v, on in normals.items()}
    return [
        np.array([shares[int(v)][order[int(v)][number]] for v in vertices])
        for number, (_, vertices, _) in enumerate(pieces)
    ]


def orders(h: list[float], errors: list[float]) -> list[float]:
    """The orders between neighbouring meshes; infinite where nothing is left."""
    pairs_of = zip(zip(h, errors, strict=True), zip(h[1:], errors[1:], strict=False), strict=False)
    return [float(np.log(a / b) / np.log(k / m)) if min(a, b) > 0 else float("inf") for (k, a), (m, b) in pairs_of]


def order(h: list[float], errors: list[float]) -> float:
    """The order between the last two meshes; nan from one mesh."""
    return orders(h, errors)[-1] if len(h) > 1 else float("nan")


@dataclass(frozen=True)
class Judgement:
    """A code on one case, mesh by mesh; orders between the last two meshes, ``order_of_best`` that of K^h.

    ``why`` has the numbers behind the verdict in words. ``tested`` has the constraints that are in contact at some step
    on the last mesh, those that are free at some step, and all: no answer says anything of the others.
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


def classify(h: list[float], errors: list[Errors]) -> str:
    """The class of a code from its errors, mesh by mesh.

    *exact for P1*: its distance from the solution in K^h is at most ``EXACT`` of the discretisation error.
    *consistent*: on ``MESHES`` meshes or more, the distance falls between the last two with an order of ``FALLS`` at
    least, and the error of the pressure with ``PRESSURE_FALLS``, or as that of K^h up to ``NECESSARY``.
    *wrong*: no numbers; or, from two meshes on, a distance that grows and is more than ``NEGLIGIBLE``, a pressure no
    better than none, or other equations.
    *stagnates*: anything else; *undecided* if there are fewer meshes.
    """
    return judged(h, errors)[0]


def judged(h: list[float], errors: list[Errors]) -> tuple[str, str]:
    """The class, and the numbers that decided."""
    shares, last = [one.distance / one.best for one in errors], errors[-1]
    if not np.isfinite(shares).all():
        return "wrong", "no numbers"
    if max(shares) <= EXACT:
        return "exact for P1", f"{max(shares):.0e} of the error"
    if len(h) < 2:
        return "undecided", f"one mesh, not exact: {shares[-1]:.1e} of the error"
    fall = orders(h, [one.distance for one in errors])
    if fall[-1] < -FALLS and shares[-1] > NEGLIGIBLE:
        return "wrong", f"grows with order {-fall[-1]:.1f}, {shares[-1]:.1e} of the error"
    if last.pressure >= NO_CONTACT:
        return "wrong", f"pressure no better than none, error {last.pressure:.2f}"
    if last.tangential >= OTHER_EQUATIONS:
        return "wrong", f"other equations, forces of {last.tangential:.2g} of the load where none may be"
    pressure, of_best = (order(h, [getattr(one, name) for one in errors]) for name in ("pressure", "best_pressure"))
    return _by_orders(fall, pressure, min(PRESSURE_FALLS, of_best - NECESSARY), shares[-1])


def _by_orders(fall: list[float], pressure: float, wanted: float, share: float) -> tuple[str, str]:
    """The class of what is neither exact nor wrong."""
    told = f"order {', '.join(f'{one:.1f}' for one in fall)}"
    if len(fall) + 1 < MESHES:
        return "undecided", f"{told} from {len(fall) + 1} meshes; {MESHES} are needed"
    if fall[-1] < FALLS:
        return "stagnates", f"at {share:.1e} of the error, {told}"
    if pressure < wanted:
        return "stagnates", f"in the pressure, order {pressure:.1f}"
    return "consistent", told


def assess(tasks: list[Task], answers: dict[str, np.ndarray]) -> list[Judgement]:
    """One judgement for each case, mesh family and mode, from answers by the names of their tasks.

    Where a task is there under two load scales, ``invariance`` is the largest distance between their answers, in V and
    relative to the discretisation error: zero for a code that knows small displacements only. nan with one scale.
    """
    groups = defaultdict(lambda: defaultdict(list))
    for task in tasks:
        data = task.data
        groups[data["case"], data["family"], data["mode"]][data["level"]].append(task)
    found = []
    for key, levels in groups.items():
        numbers = sorted(levels)
        h = [levels[n][0].data["h"] for n in numbers]
        errors = [measure(levels[n][0], answers[levels[n][0].name]) for n in numbers]
        apart = [_between(levels[n], answers, one.best) for n, one in zip(numbers, errors, strict=True)]
        last = [order(h, [getattr(one, name) for one in errors]) for name in ("error", "best", "distance", "pressure")]
        known = [value for value in apart if not np.isnan(value)]
        invariance = max(known, default=float("nan"))
        reached = tested(levels[numbers[-1]][0])
        found.append(Judgement(*key, numbers, errors, *judged(h, errors), reached, *last, invariance))
    return found


def _between(tasks: list[Task], answers: dict[str, np.ndarray], best: float) -> float:
    """The distance between answers to one task under two scales; nan for one."""
    if len(tasks) < 2:
        return float("nan")
    first, second = (answers[task.name] / task.scale for task in tasks[:2])
    return max(tasks[0].norm(tasks[0].strain(v)) for v in first - second) / best


def unpack(task: Task, directory: Path) -> None:
    """A task as text files, for programs that read no JSON: what the page on the format lists, without the judge's."""
    place = Path(directory) / task.name
    place.mkdir(parents=True, exist_ok=True)
    numbers = {"cells": task.cells, "clamped": task.clamped}
    for i, piece in enumerate(task.data["contact"], start=1):
        numbers |= {
            f"contact_{i}": np.array(piece["facets"], int),
            f"constrained_{i}": np.array(piece["vertices"], int),
        }
        np.savetxt(place / f"normal_{i}.txt", np.array([piece["normal"]]), fmt="%.17g")
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


def table(found: list[Judgement]) -> str:
    """What the judgements say, in lines; numbers are those of the last mesh."""
    head = f"{'case':<22}{'meshes':<13}{'mode':<7}{'n':<9}{'V order':>8}{'distance':>10}{'pressure':>10}{'of K^h':>8}"
    lines = [f"{head}{'pressed':>9}{'free':>8}  class"]
    for one in found:
        last, (pressed, free, count) = one.errors[-1], one.tested
        levels = " ".join(map(str, one.levels))
        numbers = (
            f"{one.order_in_v:8.2f}{last.distance / last.best:10.1e}{last.pressure:10.3f}{last.best_pressure:8.3f}"
        )
        reached = f"{f'{pressed}/{count}':>9}{f'{free}/{count}':>8}"
        what = f"{one.verdict} ({one.why})"
        lines += [f"{one.case:<22}{one.family:<13}{one.mode:<7}{levels:<9}{numbers}{reached}  {what}"]
        lines += [f"    {note}" for note in notes(one)]
    return "\n".join(lines)


def notes(one: Judgement) -> list[str]:
    """What the class does not say."""
    last, found = one.errors[-1], []
    if not np.isnan(one.invariance):
        found.append(f"load scales differ by {one.invariance:.1e} of the error")
    if abs(one.order_in_v - one.order_of_best) > NECESSARY:
        found.append("the order in V is not that of the solution in K^h, which is necessary")
    if last.idle:
        named = ", ".join(map(str, last.idle[:5])) + (", …" if len(last.idle) > 5 else "")
        found.append(f"vertices that are pressed and carry next to nothing: {len(last.idle)} ({named})")
    if one.verdict == "consistent" and last.pressure > LARGE_PRESSURE * last.best_pressure:
        found.append(
            f"the pressure has {last.pressure / last.best_pressure:.0f} times the error of the solution in K^h"
        )
    if FEW_FORCES < last.tangential < OTHER_EQUATIONS:
        found.append(
            f"forces of {last.tangential:.1e} of the load where none may be: terms inside the body (Nitsche), places "
            "of contact that move (smaller loads?), or equations that are not quite those of the task"
        )
    return found


def main() -> int:
    """The command; 0 all exact or consistent, 1 not, 2 nothing that can be judged."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tasks", type=Path, metavar="TASKS")
    parser.add_argument("answers", type=Path, metavar="ANSWERS")
    parser.add_argument("--unpack", action="store_true", help="write the tasks to ANSWERS as text files")
    parser.add_argument("--json", action="store_true", help="all numbers")
    options = parser.parse_args()
    try:
        tasks = read_tasks(options.tasks)
        if options.unpack:
            for task in tasks:
                unpack(task, options.answers)
            return 0
        found = assess(tasks, {task.name: read_answer(options.answers, task) for task in tasks})
    except TaskError as error:
        print(f"contact_judge: {error}", file=sys.stderr)
        return 2
    print(json.dumps([asdict(one) for one in found], indent=1) if options.json else table(found))
    return 0 if all(one.verdict in GOOD for one in found) else 1


if __name__ == "__main__":
    sys.exit(main())
