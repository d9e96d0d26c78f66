"""The work of contact over time, for given and for random vertices of Γ3."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from manufactured.body import Kind
from manufactured.exact import ExactSolution
from manufactured.tensors import Array
from study.fem.mesh import Shaken
from study.fem.seminorm import composite
from study.fem.space import Space
from study.statements.shared.base import SEED
from study.statements.shared.instants import midpoints

FACE_RULE = composite(512, 4)
"""On a piece of Γ3: ℓ is at least 1/64 of it."""
INSTANTS = 8
"""Nodes of the midpoint rule in time."""
DRAWS = 400
"""Random vertices on Γ3, for mean and spread."""


@dataclass(frozen=True, eq=False)
class TotalWork:
    """Vertices of every piece of Γ3 ↦ ∫_0^T R(t; Π^h u − u) dt, R = ∫_{Γ3} p Π^h w, by the midpoint rule in time."""

    solution: ExactSolution

    @cached_property
    def weighted(self) -> list[list[Array]]:
        """p times the weights in space and time, for every piece and instant."""
        T = self.solution.body.T
        found = []
        for face in self.solution.faces:
            exact = self.solution.on(face, face.part.measure * FACE_RULE[0][None])
            weights = FACE_RULE[1] * face.part.measure * T / INSTANTS
            found.append([exact.stated_pressure(time) * weights for time in midpoints(T, INSTANTS)])
        return found

    def __call__(self, vertices: Sequence[Array]) -> float:
        """Coordinates along the pieces, increasing."""
        total, times = 0.0, midpoints(self.solution.body.T, INSTANTS)
        for face, weighted, s in zip(self.solution.faces, self.weighted, vertices, strict=True):
            place = face.part.measure * FACE_RULE[0]
            for time, pressure in zip(times, weighted, strict=True):
                total += float(pressure @ np.interp(place, s, face.gap_jet(s[None], time)[(0,)]))
        return total


def vertices_on(space: Space) -> list[Array]:
    """The coordinates of the vertices on every piece of Γ3."""
    parts = space.body.of(Kind.CONTACT)
    return [np.sort(part.coordinates(space.mesh.p[:, space.vertices(part)])[0][0]) for part in parts]


def shaken(vertices: Sequence[Array], rng: np.random.Generator) -> list[Array]:
    """Equidistant vertices on every piece, moved as on shaken meshes, by up to a fifth of an edge; the ends stay."""
    moved = []
    for s in vertices:
        shift = rng.uniform(-1, 1, s.size) * Shaken().amplitude * (s[1] - s[0])
        shift[[0, -1]] = 0
        moved.append(s + shift)
    return moved


def by_chance(total: TotalWork, vertices: Sequence[Array]) -> dict[str, float]:
    """Mean and relative standard deviation of the work over random vertices."""
    rng = np.random.default_rng(SEED)
    found = [total(shaken(vertices, rng)) for _ in range(DRAWS)]
    return {"mean work": math.sqrt(np.mean(found)), "spread": float(np.std(found) / np.mean(found))}
