"""Computes the data for the figures and the report page of a case: contact over time, deformation and stress."""

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from manufactured.body import Body
from manufactured.contact import Face
from manufactured.exact import ExactSolution
from manufactured.tensors import Array
from study.fem.mesh import MeshFamily, OneDiagonal, Skin, Unstructured, facet_measures
from study.fem.naming import family_named, resolve
from study.fem.space import Space
from study.ledger.datafiles import JsonFiles
from study.ledger.pictures import FINE_UNITS, Facets, Packed, short
from study.solve.motion import Motion, von_mises
from study.statements.shared import estimates
from study.statements.shared.base import Numbers, Setting, Statement
from study.statements.shared.meshes import fits
from study.statements.shared.scope import Scope

FAMILY = Unstructured()
LEVEL = 20
PICTURE_STEPS = 64
SOLID_FAMILY = OneDiagonal()
SOLID_LEVEL = 9
SOLID_STEPS = 32
PICTURE_INTERVALS = 16
"""Number of time intervals in the pictures of a case. The data are written at the ends of the intervals."""
SHAPES = (0.25, 0.5, 1.0)
"""Times at which the deformed mesh is shown, as fractions of the final time T."""
FACE_INTERVALS, LINE = 400, 80
"""Number of intervals along a contact face in 2D, for the exact contact zone and for curves of gap and pressure."""
ZONE_HALVINGS = 10
"""Number of bisections that locate the time at which connected parts of the exact contact zone appear or merge."""


def mesh_for(body: Body) -> tuple[MeshFamily, int]:
    """Return the mesh family and the level for the pictures of a body.

    In 3D the edges of the boundary parts must lie on the grid. The levels from ``SOLID_LEVEL`` to 2 ``SOLID_LEVEL`` − 1
    are tried, and the first one with this property is returned. If no level has it, ``SOLID_LEVEL`` is returned, and
    meshing raises an error.
    """
    if body.dim == 2:
        return FAMILY, LEVEL
    levels = range(SOLID_LEVEL, 2 * SOLID_LEVEL)
    return SOLID_FAMILY, next((n for n in levels if fits(SOLID_FAMILY, body, n)), SOLID_LEVEL)


def record(name: str, motion: Motion, every: int) -> Numbers:
    """Return the data for the figures and the report page of a computed solution, as a dictionary.

    The computed pressure at a vertex is its contact force divided by the integral of its shape function over Γ3.

    Args:
        name: the name of the case.
        motion: the computed solution.
        every: the data are taken from every ``every``-th time step.

    Returns:
        The figures show the triangles of the mesh, in 3D the triangles of the surface of the body. ``vertices`` are the
        coordinates of their corners, (d, vertices), and ``cells`` are these triangles, as indices into ``vertices``,
        (3, cells). ``displacement`` (times, d, vertices) and ``von_mises``, the von Mises stress (times, cells), are
        compressed. ``times`` are the times of these data, and ``shapes`` the times at which the deformed mesh is shown.

        ``faces`` has one dictionary for each contact face, with the coordinates ``s`` of its contact vertices along the
        face, and ``gap``, ``pressure`` and the exact values ``gap_exact``, ``pressure_exact`` at these vertices over
        time. In 2D these are written as numbers, ``zone_exact`` has the ends of the exact contact zone, and ``line``
        has exact values at evenly spaced points, compressed. In 3D all values are compressed, and ``nodes`` are the
        indices of the contact vertices in ``vertices``. ``level_exact`` is the level function ψ at these vertices and
        at the midpoints between them; the exact zone is {ψ ≥ 0}.
    """
    solution = motion.solution
    space = motion.space
    shown = motion.frames[::every]
    skin = Skin.of(space.mesh)
    times = np.array([frame.time for frame in shown])
    displacement = np.array([space.nodal(frame.u)[:, skin.vertices] for frame in shown])
    normal = np.array([frame.normal for frame in shown])
    pressure = np.array([frame.multipliers for frame in shown]) / contact_weights(space)
    instants = [round(share * (len(shown) - 1)) for share in SHAPES]
    return {
        "case": name,
        "family": motion.family,
        "level": motion.level,
        "times": short(times),
        "vertices": short(space.mesh.p[:, skin.vertices]),
        "cells": skin.triangles.tolist(),
        "shapes": short(times[instants]),
        "displacement": Packed.of(displacement).record(),
        "von_mises": Packed.of(np.array([von_mises(frame.stress)[skin.cells] for frame in shown])).record(),
        "faces": list(faces(solution, space, skin, times, normal, pressure)),
    }


def contact_weights(space: Space) -> Array:
    """Return the integral over the contact boundary of the hat function of each contact vertex, (m,).

    A vertex between two contact faces with different normals has one integral for each face.
    """
    weights = []
    for part, vertices in space.contact:
        aligned = [other for other, _ in space.contact if np.allclose(other.normal, part.normal)]
        facets = np.concatenate([space.facets(other) for other in aligned])
        ends = space.mesh.facets[:, facets]
        shares = np.tile(facet_measures(space.mesh, facets) / space.dim, (space.dim, 1))
        weights.append(space.scatter(ends, shares[None])[0, vertices])
    return np.concatenate(weights)


def faces(
    solution: ExactSolution, space: Space, skin: Skin, times: Array, normal: Array, pressure: Array
) -> Iterator[Numbers]:
    """Yield for each contact face the dictionary of data for the figures that ``record`` describes.

    Args:
        solution: the exact solution.
        space: the space V^h.
        skin: the triangles that the figures show.
        times: the times, (times,).
        normal: the normal displacement minus the initial gap at the m contact vertices, (times, m).
        pressure: the computed contact pressure at the contact vertices, (times, m).
    """
    plane = space.dim == 2
    start = 0
    write: Callable[[Array], Any] = short if plane else packed
    for i, (face, (part, vertices)) in enumerate(zip(solution.faces, space.contact, strict=True), start=1):
        s = part.coordinates(space.mesh.p[:, vertices])[0]
        order = np.argsort(s[0])
        s = s[:, order]
        columns = start + order
        nodes = np.searchsorted(skin.vertices, vertices[order])
        start += len(vertices)
        exact = solution.on(face, s)
        data = {
            "face": i,
            "normal": part.normal.tolist(),
            "s": short(s[0] if plane else s),
            "x": short(part.point(s)),
            "gap": write(-normal[:, columns]),
            "gap_exact": write(exact.gap(times).T),
            "pressure": write(pressure[:, columns]),
            "pressure_exact": write(exact.pressure(times).T),
        }
        if plane:
            yield {**data, **exact_zone_and_lines(solution, face, s, times)}
        else:
            between = solution.on(face, Facets.between(nodes, skin.triangles).refined(s))
            yield {**data, "level_exact": packed(between.level(times).T), "nodes": nodes.tolist()}


def exact_zone_and_lines(solution: ExactSolution, face: Face, s: Array, times: Array) -> Numbers:
    """Return the exact contact zone of a contact face in 2D over time, and the curves of exact gap and pressure.

    The zone is given at evenly spaced times and at times near which its connected parts appear, merge or vanish. The
    curves end at the first and the last contact vertex, because the pressure may be unbounded where Γ3 meets Γ1.

    Args:
        solution: the exact solution.
        face: the contact face.
        s: the coordinates of the contact vertices along the face, an array of any shape.
        times: the times of the curves, (times,).

    Returns:
        The entries "zone_exact", with times and for each time the intervals of contact, and "line", with coordinates s
        and the values of gap and pressure there at each time.
    """
    fine = np.linspace(0, face.part.measure, FACE_INTERVALS + 1)
    line = np.linspace(s.min(), s.max(), LINE + 1)
    level = solution.on(face, fine[None]).level
    exact = solution.on(face, line[None])
    instants = np.linspace(0, solution.body.T, 101).tolist()
    zone = {t: intervals(fine, level(t)) for t in instants}
    for before, after in pairwise(instants):
        for _ in range(ZONE_HALVINGS if len(zone[before]) != len(zone[after]) else 0):
            middle = (before + after) / 2
            zone[middle] = intervals(fine, level(middle))
            before, after = (middle, after) if len(zone[middle]) == len(zone[before]) else (before, middle)
    shown = {round(t, 7): zone[t] for t in sorted(zone)}
    return {
        "zone_exact": {"times": list(shown), "intervals": list(shown.values())},
        "line": {"s": short(line), "gap": packed(exact.gap(times).T), "pressure": packed(exact.pressure(times).T)},
    }


def packed(values: Array) -> Numbers:
    """Return the values of a function at points over time as a compressed entry of a picture file.

    The values are rounded to 1/32 000 of the largest absolute value.

    Args:
        values: the values, (times, points).

    Returns:
        A dictionary with the entries "unit", "shape" and "changes" (``Packed.record``), which ``Packed.read`` reads.
    """
    return Packed.of(values, FINE_UNITS).record()


def intervals(s: Array, level: Array) -> list[list[float]]:
    """Return the parts of a contact face in contact, as intervals [begin, end] of the coordinate s.

    The face is in contact where the level function is ψ ≥ 0. ψ is interpolated linearly between the points.

    Args:
        s: the coordinates of the points, (points,).
        level: the values of ψ at the points, (points,).
    """
    inside = level >= 0
    crossing = np.flatnonzero(np.diff(inside))
    roots = s[crossing] - level[crossing] * np.diff(s)[crossing] / np.diff(level)[crossing]
    ends = np.concatenate([s[:1][inside[:1]], roots, s[-1:][inside[-1:]]])
    return [short(pair) for pair in ends.reshape(-1, 2)]


class Pictures(Statement):
    """Writes the data for the figures and the report page of every case; nothing is claimed or judged."""

    label = "pictures"
    claim = "what the figures show of a case"
    file = JsonFiles("pictures", ("case",))
    of_every_case = True
    initial_gap = True

    def settings(self, scope: Scope) -> list[Setting]:
        """Return one setting for every case, with the mesh that its pictures show."""
        meshes = [mesh_for(resolve(reference).solution.body) for reference in scope.cases]
        return [Setting(case, family.name, level) for case, (family, level) in zip(scope.cases, meshes, strict=True)]

    def measure(self, setting: Setting) -> Numbers:
        case = resolve(setting.case)
        steps = PICTURE_STEPS if setting.dim == 2 else SOLID_STEPS
        motion = Motion.of(case.solution, family_named(setting.family), setting.level, steps)
        return record(case.name, motion, steps // PICTURE_INTERVALS)

    def cost(self, setting: Setting) -> float:
        """Return the expected run time in µs, which is half a second for every case."""
        return 500_000.0

    def memory(self, setting: Setting) -> float:
        return estimates.SMALL_MEMORY
