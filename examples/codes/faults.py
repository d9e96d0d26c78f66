"""Faults put into an adapter on purpose, and which case shows them: the table of faults.md.

    python faults.py TASKS        tasks of the cases, exported with the levels 8 16

Every answer is by a right solver with one fault, so that nothing but the fault is judged. The last line of the table
has the smallest set of cases that shows every fault, computed by trying all sets.
"""

from __future__ import annotations

import copy
import sys
from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np
import scipy.sparse as sps
import this_study
from contact_judge import SINGULAR, Task, active_set, answer, errors_in_v, read_tasks
from scipy.sparse.linalg import splu, spsolve

CASES = (
    *("layered", "anisotropic", "rotated", "corner", "junction", "parabolic-gap"),
    *("contact-at-clamp", "lift-and-land", "full-contact", "advance-recede"),
)
"""In the order in which ``covering`` prefers them: first those with a feature that no other has."""
SEEN = 1e-4
"""Distance over the discretisation error from which on a fault is seen."""


@dataclass(frozen=True)
class Fault:
    """A fault of an adapter: its name, make(task) of the faulty adapter, and words of the cause the judge should name.

    Without words, the judge need not find the cause.
    """

    name: str
    make: Callable[[Task], Callable[[np.ndarray, np.ndarray], np.ndarray]]
    cause: str = ""


def misread(change: Callable[[Task], dict]) -> Callable:
    """An adapter that takes another stiffness or other vertices for those of the task."""

    def make(task: Task):
        other = copy.copy(task)
        for name, value in change(task).items():
            setattr(other, name, value)
        return this_study.make(other)

    return make


def gap_times(factor: float) -> Callable:
    """An adapter that takes another multiple of the initial gap."""
    return misread(lambda task: {"gaps": lambda: [factor * gap for gap in task.gaps()]})


def other_stress(change: Callable[[np.ndarray], np.ndarray]) -> Callable:
    """An adapter that takes another initial stress, Mandel (cells, D)."""

    def make(task: Task):
        step = this_study.make(task)
        return lambda load, stress: step(load, change(stress))

    return make


def balance_with(change: Callable[[Task, np.ndarray], np.ndarray]) -> Callable:
    """An adapter that takes another load: change(task, load)."""

    def make(task: Task):
        step = this_study.make(task)
        return lambda load, stress: step(change(task, load), stress)

    return make


def _load_lost(task: Task, load: np.ndarray) -> np.ndarray:
    """The load without that of a vertex in the middle of Γ2."""
    loaded = np.unique([v for part in task.data["loaded"] for facet in part["facets"] for v in facet])
    held = np.concatenate([task.clamped, *(vertices for _, vertices, _ in task.pieces())])
    free = np.setdiff1d(loaded, held)
    return np.where(np.arange(len(load))[:, None] == free[len(free) // 2], 0, load)


def _pressure_before_contact(task: Task, load: np.ndarray) -> np.ndarray:
    """The load with a hundredth of the largest load, for each area, against the contact face."""
    result = load.copy()
    for normal, vertices, mass in task.pieces():
        result[vertices] -= 0.01 * abs(load).max() * np.multiply.outer(mass / mass.max(), normal)
    return result


def _cell_left_out(task: Task) -> dict:
    """Cells without the one nearest to the middle of the body."""
    middle = np.linalg.norm(task.vertices[task.cells].mean(axis=1) - task.vertices.mean(axis=0), axis=1).argmin()
    return {"volumes": np.where(np.arange(len(task.cells)) == middle, 0, task.volumes)}


def _forces_not_added_up(task: Task):
    """The last cell at a vertex overwrites the forces of the initial stress of the others."""
    step = this_study.make(task)

    def overwritten(load: np.ndarray, stress: np.ndarray) -> np.ndarray:
        forces = np.zeros_like(load)
        forces[task.cells] = task.in_cells(stress)
        return step(load - forces, 0 * stress)

    return overwritten


def _gap_shifted(task: Task) -> dict:
    return {"gaps": lambda: [np.roll(gap, 1) for gap in task.gaps()]}


def _gap_reversed(task: Task) -> dict:
    return {"gaps": lambda: [gap[::-1] for gap in task.gaps()]}


def _coordinates_rounded(task: Task):
    return this_study.make(task.moved(np.round(task.vertices, 2)) or task)


def _no_slip(task: Task):
    """u along the face is held at 0 where the right contact forces act."""
    free = _free(task)
    K, N, right_step = this_study.stiffness(task)[free][:, free], this_study.normals(task), this_study.make(task)
    gap = np.concatenate(task.gaps())

    def step(load: np.ndarray, stress: np.ndarray) -> np.ndarray:
        b = (load - task.internal(stress)).ravel()
        forces = b - this_study.stiffness(task) @ right_step(load, stress).ravel()
        held = N @ forces > 1e-9 * abs(b).max()
        along = [row for v in np.unique(N[held].indices // 2) for row in ([2 * v], [2 * v + 1])]
        rows = np.zeros((len(along), len(b)))
        rows[np.arange(len(along)), np.ravel(along).astype(int)] = 1
        wanted = rows @ (N[held].T @ gap[held]) if len(along) else np.zeros(0)
        R = rows[:, free]
        S = np.block([[K.toarray(), R.T], [R, np.zeros((len(R), len(R)))]])
        u = np.zeros(len(b))
        u[free] = np.linalg.solve(S, np.append(b[free], wanted))[: len(free)]
        return u.reshape(-1, 2)

    return step


def _vertex_duplicated(task: Task):
    """The cells to the right of the vertex in the middle use a copy of it, which moves on its own (a crack)."""
    middle = np.linalg.norm(task.vertices - task.vertices.mean(axis=0), axis=1).argmin()
    right = task.vertices[task.cells].mean(axis=1)[:, :1] > task.vertices[middle, 0]
    other = copy.copy(task)
    other.vertices = np.concatenate([task.vertices, task.vertices[[middle]]])
    other.cells = np.where((task.cells == middle) & right, len(task.vertices), task.cells)
    step = this_study.make(other)
    return lambda load, stress: step(np.concatenate([load, 0 * load[:1]]), stress)[:-1]


def along_the_face(law: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]) -> Callable:
    """Forces along the contact face: law(slip, contact forces, areas), by fixed-point iteration."""

    def make(task: Task):
        step = this_study.make(task)

        def solve(load: np.ndarray, stress: np.ndarray) -> np.ndarray:
            u, along = step(load, stress), np.zeros_like(load)
            for _ in range(60):
                elastic = np.einsum("cij,cj->ci", task.stiffness, task.strain(u))
                forces, before = load - task.internal(elastic + stress), along
                along = np.zeros_like(load)
                for normal, vertices, area in task.pieces():
                    tangent = np.array([-normal[1], normal[0]])
                    force = law(u[vertices] @ tangent, (forces + before)[vertices] @ normal, area)
                    along[vertices] += np.multiply.outer(force, tangent)
                u = step(load + along, stress)
            return u

        return solve

    return make


def _propped(task: Task):
    """u·n is held at 0 at a vertex in the middle of Γ2, as if another face were found to be in contact there."""
    loaded = task.data["loaded"][0]
    held = np.concatenate([task.clamped, *(vertices for _, vertices, _ in task.pieces())])
    free = np.setdiff1d(loaded["facets"], held)
    piece = {"normal": loaded["normal"], "facets": loaded["facets"], "vertices": [int(free[len(free) // 2])]}
    other = copy.copy(task)
    other.data = {**task.data, "contact": [*task.data["contact"], piece]}
    return tied_last(other)


def tied_last(task: Task):
    """The right contact, and u_ν = 0 at the last constraint."""

    def solve(W: np.ndarray, free: np.ndarray, memory: dict) -> np.ndarray:
        return active_set(W, free, tied=np.arange(len(free)) == len(free) - 1)

    return in_contact(solve)(task)


def _barrier(W: np.ndarray, free: np.ndarray, memory: dict) -> np.ndarray:
    """λ = 1e-3 / distance, by Newton's method from far away."""
    distance = abs(free).max() + abs(free)
    for _ in range(200):
        left = distance + free - 1e-3 * W @ (1 / distance)
        step = np.linalg.solve(np.eye(len(free)) + 1e-3 * W / distance**2, -left)
        distance = np.maximum(distance + step, distance / 2)
    return 1e-3 / distance


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
        kept, gap = (values[np.sort(held)].tolist() for values in (np.array(first["vertices"]), task.gaps()[0]))
        return {"data": {**task.data, "contact": [{**first, "vertices": kept, "gap": gap}, *others]}}

    return change


def springs(stiffness: Callable[[Task], float]) -> Callable:
    """A foundation of springs at the vertices, force for length and area, by active sets."""

    def make(task: Task):
        K, N, free = this_study.stiffness(task), this_study.normals(task), _free(task)
        k, gap = stiffness(task) * np.concatenate([mass for *_, mass in task.pieces()]), np.concatenate(task.gaps())

        def step(load: np.ndarray, stress: np.ndarray) -> np.ndarray:
            b, u, held = (load - task.internal(stress)).ravel(), np.zeros(task.vertices.size), np.ones(len(k))
            for _ in range(30):
                S = sps.csc_array(K + N.T @ sps.diags_array(held * k) @ N)
                u[free] = spsolve(S[free][:, free], (b + N.T @ (held * k * gap))[free])
                before, held = held, 1.0 * (N @ u > gap)
                if (before == held).all():
                    break
            return u.reshape(-1, task.dim)

        return step

    return make


def tied(task: Task):
    """u_ν = g at all constrained vertices, with the initial gap g: no lift-off."""
    free = _free(task)
    K, N = this_study.stiffness(task)[free][:, free], this_study.normals(task)[:, free]
    S = sps.csc_array(sps.block_array([[K, N.T], [N, None]]))

    def step(load: np.ndarray, stress: np.ndarray) -> np.ndarray:
        u, b = np.zeros(task.vertices.size), (load - task.internal(stress)).ravel()[free]
        u[free] = spsolve(S, np.append(b, np.concatenate(task.gaps())))[: len(free)]
        return u.reshape(-1, task.dim)

    return step


def first_component_held(task: Task):
    """Hold only the first component on Γ1, with the right contact; without contact the matrix may be singular."""
    free = np.setdiff1d(np.arange(task.vertices.size), task.dim * task.clamped)
    K, N = (matrix[:, free].toarray() for matrix in (this_study.stiffness(task)[free], this_study.normals(task)))
    gap = np.concatenate(task.gaps())

    def step(load: np.ndarray, stress: np.ndarray) -> np.ndarray:
        b, u, held = (load - task.internal(stress)).ravel()[free], np.zeros(task.vertices.size), np.ones(len(N), bool)
        for _ in range(60):
            rows, force = N[held], np.zeros(len(N))
            S = np.block([[K, rows.T], [rows, np.zeros((len(rows), len(rows)))]])
            u[free], force[held] = np.split(np.linalg.solve(S, np.append(b, gap[held])), [len(b)])
            before, held = held, force + abs(K).max() * (N @ u[free] - gap) > 0
            if (before == held).all():
                break
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


def in_contact(solve: Callable, normals: Callable = this_study.normals, rows: Callable | None = None) -> Callable:
    """An adapter with another contact algorithm: λ = solve(W, free, memory), free = u_ν − g without contact forces.

    ``normals`` gives the matrix v ↦ v_i·ν, and ``rows`` what it is multiplied by from the left. ``memory`` is a dict
    that lasts from step to step.
    """

    def make(task: Task):
        free, N = _free(task), normals(task)
        by = sps.eye_array(N.shape[0]) if rows is None else sps.csr_array(rows(task))
        N, gap = sps.csr_array(by @ N)[:, free], by @ np.concatenate(task.gaps())
        K, memory = splu(sps.csc_array(this_study.stiffness(task)[free][:, free])), {}
        compliance = K.solve(N.toarray().T)

        def step(load: np.ndarray, stress: np.ndarray) -> np.ndarray:
            u, alone = np.zeros(task.vertices.size), K.solve((load - task.internal(stress)).ravel()[free])
            u[free] = alone - compliance @ solve(N @ compliance, N @ alone - gap, memory)
            return u.reshape(-1, task.dim)

        return step

    return make


def right(W: np.ndarray, free: np.ndarray, memory: dict) -> np.ndarray:
    """λ of the right contact problem."""
    return active_set(W, free)


def late(W: np.ndarray, free: np.ndarray, memory: dict) -> np.ndarray:
    """λ at the vertices that were in contact in the step before."""
    held = memory.get("held", np.zeros(len(free), bool))
    memory["held"] = active_set(W, free) > 0
    return active_set(W, free, held, updates=0)


def _first_step_only(W: np.ndarray, free: np.ndarray, memory: dict) -> np.ndarray:
    """λ of the right contact problem in the first step, 0 in all others."""
    first = not memory
    memory["solved"] = True
    return active_set(W, free) if first else 0 * free


def changed(change: Callable[[Task, np.ndarray, dict], np.ndarray]) -> Callable:
    """An adapter that writes something else than its displacements: change(task, u, memory)."""

    def make(task: Task):
        step, memory = this_study.make(task), {}
        return lambda load, stress: change(task, step(load, stress), memory)

    return make


def _last_step_not_solved(task: Task, u: np.ndarray, memory: dict) -> np.ndarray:
    memory["steps"] = [*memory.get("steps", []), u]
    return memory["steps"][task.count - 2] if len(memory["steps"]) == task.count else u


def _step_before(task: Task, u: np.ndarray, memory: dict) -> np.ndarray:
    before = memory.get("u", np.zeros_like(u))
    memory["u"] = u
    return before


def _noise(task: Task, u: np.ndarray, memory: dict) -> np.ndarray:
    noise = np.random.default_rng(7).uniform(-1, 1, u.shape)
    noise[task.clamped] = 0
    return u + 1e-4 * abs(u).max() * noise


def tilted(angle: float) -> Callable:
    """The normal at the first vertex of each piece turned by an angle."""

    def normals(task: Task) -> sps.csr_array:
        N, row = this_study.normals(task).tolil(), 0
        for normal, vertices, _ in task.pieces():
            turned = np.cos(angle) * normal + np.sin(angle) * np.array([-normal[1], normal[0]])
            N[row, 2 * vertices[0] : 2 * vertices[0] + 2] = turned
            row += len(vertices)
        return sps.csr_array(N)

    return normals


def _along_axis(task: Task) -> dict:
    """Normals rounded to the nearest axis."""
    contact = [{**piece, "normal": np.round(piece["normal"]).tolist()} for piece in task.data["contact"]]
    return {"data": {**task.data, "contact": contact}}


def _facet_means(task: Task) -> np.ndarray:
    """Rows that take the mean over each facet of the constraints at its vertices."""
    rows, first = [], 0
    count = sum(len(vertices) for _, vertices, _ in task.pieces())
    for piece, (_, vertices, _) in zip(task.data["contact"], task.pieces(), strict=True):
        for facet in piece["facets"]:
            on = first + np.flatnonzero(np.isin(vertices, facet))
            rows.append(np.isin(np.arange(count), on) / len(facet))
        first += len(vertices)
    return np.array(rows)


def _corner_means(task: Task) -> np.ndarray:
    """Rows that add the constraints of different pieces at one vertex."""
    vertices = np.concatenate([vertices for _, vertices, _ in task.pieces()])
    return (np.unique(vertices)[:, None] == vertices).astype(float)


def entries(*changes: tuple[int, int, float]) -> Callable[[Task], dict]:
    """The stiffness with entries (i, j) and (j, i), Mandel, multiplied by a factor."""

    def change(task: Task) -> dict:
        C = task.stiffness.copy()
        for i, j, by in changes:
            C[:, i, j] *= by
            C[:, j, i] = C[:, i, j]
        return {"stiffness": C}

    return change


def wrong_shear_strain(by: float) -> Callable:
    """An adapter whose strain has shear multiplied, in the stiffness and in the initial stress."""

    def make(task: Task):
        other = copy.copy(task)
        other.stiffness = _shear(_shear(task.stiffness, by).swapaxes(1, 2), by)
        step = this_study.make(other)
        return lambda load, stress: step(load, _shear(stress, by))

    return make


def _plane_stress(task: Task) -> dict:
    C = task.stiffness.copy()
    mu, lam = C[:, 2, 2] / 2, C[:, 0, 1].copy()
    C[:, 0, 1] = C[:, 1, 0] = 2 * mu * lam / (lam + 2 * mu)
    C[:, 0, 0] = C[:, 1, 1] = 2 * mu + C[:, 0, 1]
    return {"stiffness": C}


def _equal_springs(task: Task):
    """Springs of the same stiffness at all vertices, half areas at the ends forgotten."""
    other = copy.copy(task)
    pieces = [(normal, vertices, np.full(len(mass), task.data["h"])) for normal, vertices, mass in task.pieces()]
    other.pieces = lambda: pieces
    return springs(lambda task: 100 / task.data["h"])(other)


STRESS, SHEAR = "the initial stress", "the shear p"
FAULTS = (
    Fault("initial stress forgotten", other_stress(lambda s: 0 * s), f"{STRESS} is missing"),
    Fault("initial stress with the other sign", other_stress(lambda s: -s), f"{STRESS} has the reversed sign"),
    Fault("initial stress not divided by √2 in shear", other_stress(lambda s: _shear(s, np.sqrt(2))), SHEAR),
    Fault("stiffness divided by √2 twice in shear", misread(_voigt_for_mandel), "shear"),
    Fault("shear strain √2 times too large", wrong_shear_strain(np.sqrt(2)), "the shear strain is multiplied by 1.414"),
    Fault("*A* in place of *G*", misread(lambda task: {"stiffness": task.A}), "A is used in place of G"),
    Fault(
        "`factor` forgotten",
        misread(lambda task: {"stiffness": 0 * task.G + task.data["law"]["G"]["matrix"]}),
        "`factor` of the law is forgotten",
    ),
    Fault("plane stress for plane strain", misread(_plane_stress), "plane stress"),
    Fault(
        "axes 1 and 2 exchanged in the stiffness",
        misread(lambda task: {"stiffness": task.stiffness[:, [1, 0, 2]][:, :, [1, 0, 2]]}),
        "axes 1 and 2 are exchanged",
    ),
    Fault("coupling $C_{12}$ halved", misread(entries((0, 1, 0.5)))),
    Fault("coupling with shear of the other sign", misread(entries((0, 2, -1.0), (1, 2, -1.0)))),
    Fault("ν pointing into the body", misread(inward), "normals are reversed"),
    Fault("ν rounded to an axis", misread(_along_axis), "normals are tilted"),
    Fault("ν at the first vertex turned by 0.1", in_contact(right, tilted(0.1)), "normals are tilted"),
    Fault("ν averaged at a corner", in_contact(right, rows=_corner_means), "normals of faces that meet are averaged"),
    Fault("no lift-off, $u_\\nu = 0$", tied, "contact pulls"),
    Fault("a vertex inside forgotten", misread(without(0.25)), "is forgotten at"),
    Fault("the vertex at the end forgotten", misread(without(1.0)), "is forgotten at"),
    Fault("the vertex next to Γ1 forgotten", misread(without(0.0)), "is forgotten at"),
    Fault("every second vertex only", misread(without(None)), "is forgotten at"),
    Fault("vertices never released", in_contact(lambda W, g, _: active_set(W, g, release=False)), "never released"),
    Fault("active set updated once", in_contact(lambda W, g, _: active_set(W, g, updates=1)), "updated only once"),
    Fault("contact one step late", in_contact(late), "contact is one step late"),
    Fault("contact in the first step only", in_contact(_first_step_only), "contact acts in the first step only"),
    Fault("contact forces halved", in_contact(lambda W, g, _: 0.5 * active_set(W, g)), "0.5 times the right"),
    Fault("contact forces 1 % too large", in_contact(lambda W, g, _: 1.01 * active_set(W, g)), "1.01 times the right"),
    Fault("mean gap of each facet", in_contact(right, rows=_facet_means), "mean gap of each facet"),
    Fault("initial gap forgotten", gap_times(0.0), "the initial gap is missing"),
    Fault("initial gap with the other sign", gap_times(-1.0), "the initial gap has the reversed sign"),
    Fault(
        "areas of vertices taken for the initial gap",
        misread(lambda task: {"gaps": lambda: [mass for *_, mass in task.pieces()]}),
        "the areas of the contact vertices are taken",
    ),
    Fault("initial gap shifted by one vertex", misread(_gap_shifted), "the initial gaps are shifted by one vertex"),
    Fault("initial gaps in the reversed order", misread(_gap_reversed), "the initial gaps are in the reversed order"),
    Fault("initial gap 10 % too small", gap_times(0.9), "the initial gap is multiplied by the factor 0.9"),
    Fault(
        "contact forces at the next vertex",
        in_contact(lambda W, g, _: np.roll(active_set(W, g), 1)),
        "each contact force acts at the next vertex",
    ),
    Fault("no slip in contact", _no_slip, "no slip"),
    Fault("a pressure on Γ3 before contact", balance_with(_pressure_before_contact), "where the gap is open, too"),
    Fault("friction", along_the_face(lambda slip, lam, area: -1e-3 * lam * np.sign(slip)), "friction acts in contact"),
    Fault("a tangential penalty", along_the_face(lambda slip, lam, area: -0.3 * area * slip), "(a tangential penalty)"),
    Fault(
        "friction that does not depend on the pressure",
        along_the_face(lambda slip, lam, area: -1e-3 * area * (lam > 1e-9) * np.sign(slip)),
        "whatever the contact force",
    ),
    Fault(
        "a tangential penalty in contact",
        along_the_face(lambda slip, lam, area: -0.3 * area * (lam > 1e-9) * slip),
        "springs act along the face in contact",
    ),
    Fault("a logarithmic barrier", in_contact(_barrier), "force times distance is 0.001"),
    Fault("a vertex of Γ2 held", _propped, "u is held at 0 along the forces at 1 vertex"),
    Fault("a vertex duplicated", _vertex_duplicated, "is duplicated (a crack)"),
    Fault("a cell left out", misread(_cell_left_out), "the contribution of 1 cell"),
    Fault("the load lost at a vertex of Γ2", balance_with(_load_lost), "the load at 1 vertex"),
    Fault(
        "initial stress of the cell before", other_stress(lambda s: np.roll(s, 1, 0)), "stress or history of the cell"
    ),
    Fault(
        "initial stress of other sign in every second cell",
        other_stress(lambda s: s * np.where(np.arange(len(s)) % 2, -1, 1)[:, None]),
        "cells",
    ),
    Fault("forces of cells not added up", _forces_not_added_up, "are not added up"),
    Fault("coordinates with 2 decimals", _coordinates_rounded, "coordinates of the mesh are rounded to 2 decimals"),
    Fault("springs of 30, not scaled with *h*", springs(lambda task: 30.0), "springs"),
    Fault("equal springs at all vertices", _equal_springs, "whatever its area"),
    Fault(
        "Γ1 held in the first component only",
        first_component_held,
        "component 2 is not held",
    ),
    Fault(
        "only every second vertex on Γ1 held",
        misread(lambda task: {"clamped": task.clamped[::2]}),
        "is not held at some vertices",
    ),
    Fault("the body moved by 0.01", changed(lambda task, u, _: u + 0.01), "the whole body is moved"),
    Fault("u of the step before written", changed(_step_before), "step before are written"),
    Fault(
        "all u_x written before all u_y",
        changed(lambda task, u, _: u.T.reshape(u.shape)),
        "the answer has all u_x before all u_y",
    ),
    Fault(
        "deformed coordinates written",
        changed(lambda task, u, _: u + task.vertices),
        "the answer has deformed coordinates",
    ),
    Fault("u with 4 decimals", changed(lambda task, u, _: np.round(u, 4)), "are written with 4 decimals"),
    Fault("last step not solved", changed(_last_step_not_solved), "are a copy of another step"),
    Fault("u in other units", changed(lambda task, u, _: 1000 * u), "1000 times the right ones"),
    Fault("solver stopped at $10^{-4}$", changed(_noise), "solver stops too early"),
)


def distance(task: Task, fault: Fault) -> float:
    """Distance of the faulty answer to one task over the discretisation error."""
    judge, u = task.data["judge"], answer(task, fault.make) / task.scale
    _, best, _, apart, shift, *_ = np.max([errors_in_v(task, one, v) for one, v in zip(judge, u, strict=True)], axis=0)
    return float(np.hypot(apart, shift) / best)


def covering(seen: dict[str, set[str]]) -> tuple[str, ...]:
    """The smallest set of cases that shows every fault that some case shows; the first in the given order.

    Args:
        seen: case ↦ the faults that it shows.
    """
    every = set().union(*seen.values())
    sets = (cases for size in range(len(seen) + 1) for cases in combinations(seen, size))
    return next(cases for cases in sets if set().union(*(seen[case] for case in cases)) == every)


def table(tasks: dict[str, Task]) -> list[str]:
    """The lines of the table: a row for each fault, a column for the task of each case, and the covering set."""
    cells = {case: {fault.name: distance(task, fault) for fault in FAULTS} for case, task in tasks.items()}
    seen = {case: {name for name, value in column.items() if value > SEEN} for case, column in cells.items()}
    head = ["fault", *(f"*{case}*" for case in tasks)]
    rows = [[fault.name, *(_cell(cells[case][fault.name]) for case in tasks)] for fault in FAULTS]
    lines = [f"| {' | '.join(row)} |" for row in (head, ["---"] * len(head), *rows)]
    return [*lines, "", f"Smallest set of cases that shows every fault: {', '.join(covering(seen))}."]


def _cell(value: float) -> str:
    """Return the text of a distance; one that only a singular matrix gives has no reproducible digits."""
    return "singular" if value > SINGULAR else f"{value:.0e}" if value > SEEN else "–"


if __name__ == "__main__":
    tasks = sorted(read_tasks(Path(sys.argv[1])), key=lambda one: one.data["level"])
    print("\n".join(table({case: next(task for task in tasks if task.data["case"] == case) for case in CASES})))
