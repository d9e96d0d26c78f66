"""What the figures and the report of a case need from one solved problem: contact history, motion and stress."""

from __future__ import annotations

from typing import Any

import numpy as np

from manufactured.case import Case
from manufactured.exact import ExactSolution
from manufactured.tensors import Array
from study.fem.mesh import Unstructured, facet_measures
from study.fem.space import Space
from study.motion import Motion, balance, von_mises
from study.packing import Packed

FORM = 2
"""To be raised whenever a picture holds more or other things: older ones are then made anew."""
FAMILY = Unstructured()
LEVEL = 24
STEPS = 64
EVERY = 4
SHAPES = (0.25, 0.5, 1.0)
FINE = 400


def picture(case: Case) -> dict[str, Any]:
    """Contact gap and pressure, displacement and stress over time, and the deformed mesh at three times.

    The computed pressure at a vertex is its contact force over the integral of its shape function.
    ``displacement`` (times, 2, vertices) and ``von_mises`` (times, cells) are packed.
    """
    return record(case.name, Motion.of(case.solution, FAMILY, LEVEL, STEPS), EVERY)


def record(name: str, motion: Motion, every: int) -> dict[str, Any]:
    """The picture of a motion in the plane, with one of ``every`` frames."""
    solution, space, found = motion.solution, motion.space, motion.frames
    shown = found[::every]
    times = np.array([frame.time for frame in shown])
    displacement = np.array([space.nodal(frame.u) for frame in shown])
    normal = np.array([frame.normal for frame in shown])
    pressure = np.array([frame.multipliers for frame in shown]) / contact_weights(space)
    instants = [round(share * (len(shown) - 1)) for share in SHAPES]
    return {
        "case": name,
        "family": motion.family,
        "level": motion.level,
        "times": _short(times),
        "vertices": _short(space.mesh.p),
        "cells": space.mesh.t.tolist(),
        "shapes": [{"time": times[n], "displacement": _short(displacement[n])} for n in instants],
        "displacement": Packed.of(displacement).record(),
        "von_mises": Packed.of(np.array([von_mises(frame.stress) for frame in shown])).record(),
        "energy": {name: _short(values) for name, values in balance(found).items()},
        "faces": _faces(solution, space, times, normal, pressure),
    }


def contact_weights(space: Space) -> Array:
    """∫ φ_z of the shape function of each contact vertex over the pieces with its normal, (m,)."""
    weights = []
    for part, vertices in space.contact:
        aligned = [other for other, _ in space.contact if np.allclose(other.normal, part.normal)]
        facets = np.concatenate([space.facets(other) for other in aligned])
        ends = space.mesh.facets[:, facets]
        shares = np.tile(facet_measures(space.mesh, facets) / space.dim, (space.dim, 1))
        weights.append(space.scatter(ends, shares[None])[0, vertices])
    return np.concatenate(weights)


def _faces(solution: ExactSolution, space: Space, times: Array, normal: Array, pressure: Array) -> list[dict[str, Any]]:
    faces, start = [], 0
    for i, (face, (part, vertices)) in enumerate(zip(solution.faces, space.contact, strict=True), start=1):
        columns = slice(start, start + len(vertices))
        start += len(vertices)
        s = part.coordinates(space.mesh.p[:, vertices])[0]
        order = np.argsort(s[0])
        s = s[:, order]
        exact = solution.on(face, s)
        fine = np.linspace(0, part.measure, FINE + 1)[None]
        on_fine = solution.on(face, fine)
        instants = np.linspace(0, solution.body.T, 101)
        faces.append(
            {
                "face": i,
                "normal": part.normal.tolist(),
                "s": _short(s[0]),
                "x": _short(part.point(s)),
                "gap": _short(-normal[:, columns][:, order]),
                "gap_exact": _short(np.array([exact.gap(t) for t in times])),
                "pressure": _short(pressure[:, columns][:, order]),
                "pressure_exact": _short(np.array([exact.pressure(t) for t in times])),
                "zone_exact": {
                    "times": _short(instants),
                    "intervals": [_intervals(fine[0], on_fine.level(t)) for t in instants],
                },
            }
        )
    return faces


def _intervals(s: Array, level: Array) -> list[list[float]]:
    """Where ψ ≥ 0 on a face, by linear interpolation between fine points."""
    inside = level >= 0
    if not inside.any():
        return []
    crossing = np.flatnonzero(inside[1:] != inside[:-1])
    jump = level[crossing + 1] - level[crossing]
    roots = s[crossing] - level[crossing] * (s[crossing + 1] - s[crossing]) / jump
    ends = [*([s[0]] if inside[0] else []), *roots, *([s[-1]] if inside[-1] else [])]
    return [_short(np.array(pair)) for pair in zip(ends[::2], ends[1::2], strict=True)]


def _short(values: Array) -> Any:
    """Four significant digits: what a figure can show."""
    return np.vectorize(lambda v: float(f"{v:.4g}"))(values).tolist()
