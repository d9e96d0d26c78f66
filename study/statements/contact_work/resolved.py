"""V^h on a mesh with integrals by a finer one: errors in cases whose details are smaller than h."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import scipy.sparse as sps

from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.multiscale import FadingFace
from manufactured.tensors import Array, Points
from study.fem.gauge import FACET_POINTS, Gauge
from study.fem.quadrature import facet_rule
from study.fem.refining import inclusion_of, refined
from study.fem.space import Space
from study.solve.evolution import SemiDiscrete
from study.solve.tableau import MIDPOINT
from study.statements.shared.instants import norm

PARTS = 3
"""Cells to the depth of a lifting, for integrals."""


@dataclass(frozen=True, eq=False)
class Resolved:
    """V^h on a mesh, with integrals by another one that is refined where the exact solution has details.

    Attributes:
        gauge: on the refined mesh.
        inclusion: free values on the mesh → free values on the refined one.
    """

    solution: ExactSolution
    space: Space
    gauge: Gauge
    inclusion: sps.csr_array

    @classmethod
    def of(cls, solution: ExactSolution, space: Space) -> Resolved:
        """The pair of meshes."""
        mesh, nodal = refined(space.mesh, lambda corners: detail(solution, corners) / PARTS)
        fine = Space(mesh, space.body)
        return cls(solution, space, Gauge(solution, fine, along=()), inclusion_of(space, fine, nodal))

    def load(self, time: float) -> Array:
        """(f, ·)_V, (dofs,)."""
        return np.asarray(self.inclusion.T @ self.gauge.load(time))

    def distance(self, time: float, v: Array) -> float:
        """‖u(t) − v‖_V."""
        return self.gauge.distance(self.gauge.sample(time), self.inclusion @ v)


def detail(solution: ExactSolution, corners: Points) -> Array:
    """The least depth of a lifting that reaches into cells, (2, 3, cells) → (cells,)."""
    found = np.full(corners.shape[2:], math.inf)
    for face in solution.faces:
        assert isinstance(face, ContactFace | FadingFace)
        (along,), into = face.part.coordinates(corners)
        depth = face.least_depth if isinstance(face, FadingFace) else face.profile.depth
        met = (into.min(axis=0) < depth) & (along.max(axis=0) > 0) & (along.min(axis=0) < face.part.measure)
        found[met] = np.minimum(found[met], depth)
    return found


def pressing_on(at: Resolved) -> Callable[[float], Array]:
    """t ↦ ∫_{Γ3} p v_ν for v ∈ V^h, (dofs,)."""
    space, rules = at.gauge.space, []
    mesh = space.mesh
    for face in at.solution.faces:
        rule = facet_rule(mesh, space.facets(face.part), face.part, (), FACET_POINTS)
        exact = at.solution.on(face, rule.s)
        rules.append((face.part.normal, mesh.facets[:, rule.facets], rule.weights * rule.shapes, exact))

    def pressing(time: float) -> Array:
        nodal = np.zeros_like(mesh.p)
        for normal, corners, weights, exact in rules:
            moments = np.sum(exact.stated_pressure(time) * weights, axis=-1)
            nodal += np.multiply.outer(normal, np.bincount(corners.ravel(), moments.ravel(), space.count))
        return np.asarray(at.inclusion.T @ space.interpolate(nodal))

    return pressing


def distances(at: Resolved, steps: int) -> dict[str, float]:
    """The largest error and the largest excess over the linear problem at the time nodes."""
    solution, space = at.solution, at.space
    load, press = lru_cache(maxsize=None)(at.load), pressing_on(at)
    start = space.interpolate(solution.at(space.mesh.p).displacement(0.0))
    problem = SemiDiscrete.of(space, solution.law, load, start)
    linear = replace(problem, N=problem.N[:0], load=lambda time: load(time) - press(time))
    pairs = zip(MIDPOINT.march(problem, steps), MIDPOINT.march(linear, steps), strict=True)
    found = [(at.distance(state.time, state.u), norm(problem, state.u - free.u)) for state, free in pairs]
    error, excess = np.max(found, axis=0)
    return {"error": error, "excess": excess}
