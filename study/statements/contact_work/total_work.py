"""The work of contact over time, for given and for random vertices of Γ3."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from manufactured.body import Kind
from manufactured.exact import ExactSolution, Face
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
    """Vertices of every piece of Γ3 ↦ ∫_0^T R(t; Π^h u − u) dt, R = ∫_{Γ3} p Π^h w, by the midpoint rule in time.

    Many sets of vertices are taken at once: what an edge adds is known from sums over the points before its ends.
    """

    solution: ExactSolution

    @cached_property
    def moments(self) -> list[Array]:
        """Sums of p and of p s, with the weights in space and time, over the first points of every piece.

        (2, points + 1, instants).
        """
        T, found = self.solution.body.T, []
        for face in self.solution.faces:
            place, weights = self._rule(face)
            pressure = self.solution.on(face, place[None]).stated_pressure(midpoints(T, INSTANTS))
            weighted = pressure * (weights * T / INSTANTS)[:, None]
            sums = np.cumsum([weighted, weighted * place[:, None]], axis=1)
            found.append(np.concatenate([np.zeros((2, 1, INSTANTS)), sums], axis=1))
        return found

    def _rule(self, face: Face) -> tuple[Array, Array]:
        """Points and weights on a piece."""
        place, weights = FACE_RULE
        return face.part.measure * place, face.part.measure * weights

    def __call__(self, vertices: Sequence[Array]) -> Array:
        """Coordinates along the pieces, increasing, (..., vertices) → (...).

        From s_i to the next vertex, p Π^h w = p w(s_i) + p (s − s_i) w' with the slope w' of Π^h w.
        """
        total, times = np.zeros(np.shape(vertices[0])[:-1]), midpoints(self.solution.body.T, INSTANTS)
        for face, moments, s in zip(self.solution.faces, self.moments, vertices, strict=True):
            w = face.gap_jet(s[None, ..., None], times)[(0,)]
            slope = np.diff(w, axis=-2) / np.diff(s)[..., None]
            pressed, turned = np.diff(moments[:, np.searchsorted(self._rule(face)[0], s)], axis=-2)
            turned = turned - s[..., :-1, None] * pressed
            total += np.sum(pressed * w[..., :-1, :] + turned * slope, axis=(-1, -2))
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
    found = total([np.array(moved) for moved in zip(*(shaken(vertices, rng) for _ in range(DRAWS)), strict=True)])
    return {"mean work": math.sqrt(np.mean(found)), "spread": float(np.std(found) / np.mean(found))}
