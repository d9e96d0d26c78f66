"""The contact force of Problem 5.1 against the exact pressure, and u^h_ν between the vertices of Γ3.

With the multipliers λ_n of the midpoint rule, nodal forces at t_{n−1/2}, Problem 5.1 reads

    (σ^h, ε(v))_Q + λ_n·Nv = (f, v)_V,   v ∈ V^h,    and exactly   (σ, ε(v))_Q + ∫_{Γ3} p v_ν = (f, v)_V.

So ⟨p − p^h, v_ν⟩ = ∫_{Γ3} p v_ν − λ_n·Nv is measured without the load and without a matrix of the problem: p is that
of the exact stress at points of the faces.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import scipy.sparse as sps

from manufactured.exact import ExactSolution, Face
from manufactured.tensors import Array
from study.fem.quadrature import facet_rule
from study.fem.space import Space
from study.solve.evolution import State
from study.solve.signorini import Signorini
from study.statements.prop_5_4.experiment import Experiment

POINTS, SOLID_POINTS = 20, 6
"""Gauss points on a facet, and in each direction of one in 3D; p has kinks inside facets."""
ERRORS = "pressure", "dual", "resultant"
SHARES = tuple(f"{name}_time_share" for name in ERRORS)
COLUMNS = ("case", "family", "level", "h", "steps", *ERRORS, *SHARES, "penetration", "pulling")
"""``contact.csv``: norms of L²(0,T) by the midpoints of the steps, relative to the same norm of the exact quantity.

    pressure: ‖p − p^h‖_{L²(Γ3)}; p^h is P1 on each piece Γ3,i and has the moments λ_n against P1.
    dual: sup ⟨p − p^h, v_ν⟩ / ‖v‖_V over v ∈ V^h.
    resultant: ⟨p − p^h, 1⟩ on each piece, in the Euclidean norm over the pieces.
    …_time_share: |error − error with half as many steps| / error.
    penetration: max over the nodes in time and points of Γ3 of (u^h_ν)_+, over max |u^h|.
    pulling: max_n (λ_n)_− / max_n |λ_n|.
"""


class PressedFace:
    """One piece Γ3,i at the points of a rule: p, the P1 functions φ_i of the rows of N on it, and u ↦ u_ν."""

    def __init__(self, solution: ExactSolution, space: Space, face: Face, vertices: Array) -> None:
        count = POINTS if space.dim == 2 else SOLID_POINTS
        rule = facet_rule(space.mesh, space.facets(face.part), face.part, face.rough, count)
        corners = np.broadcast_to(space.mesh.facets[:, rule.facets][..., None], rule.shapes.shape)
        places = np.broadcast_to(np.arange(rule.weights.size).reshape(rule.weights.shape), rule.shapes.shape)
        shape = rule.weights.size, space.mesh.p.shape[1]
        self.every = sps.csr_array((rule.shapes.ravel(), (places.ravel(), corners.ravel())), shape=shape)
        self.functions = self.every[:, vertices]
        self.weights, self.normal = rule.weights.ravel(), face.part.normal
        self.mass = (self.functions.T @ sps.diags_array(self.weights) @ self.functions).toarray()
        self._exact = solution.on(face, rule.s)

    def pressure(self, times: Array) -> Array:
        """p at the points, at n times, (points, n)."""
        return self._exact.pressure(times).reshape(-1, len(times))

    def moments(self, pressure: Array) -> Array:
        """∫ p φ_i, (m, n)."""
        return self.functions.T @ (self.weights[:, None] * pressure)

    def square(self, pressure: Array) -> Array:
        """‖p‖², (n,)."""
        return self.weights @ pressure**2

    def held(self, forces: Array) -> Array:
        """p^h at the points, which has the moments ``forces``, (m, n), against the φ_i."""
        return self.functions @ np.linalg.solve(self.mass, forces)

    def normal_trace(self, nodal: Array) -> Array:
        """u^h_ν at the points, from values at the vertices (d, vertices)."""
        return self.every @ (self.normal @ nodal)


@dataclass(frozen=True, eq=False)
class Forces:
    """Γ3 of an experiment: its pieces, their rows of N, and W = N M⁻¹ Nᵀ, by which sup y·Nv/‖v‖_V = (y·Wy)^½."""

    space: Space
    faces: Sequence[PressedFace]
    rows: Sequence[slice]
    W: Array

    @classmethod
    def of(cls, setup: Experiment) -> Forces:
        """From the exact solution and V^h alone."""
        space, ends = setup.space, np.cumsum([0, *(len(vertices) for _, vertices in setup.space.contact)])
        faces = [
            PressedFace(setup.solution, space, face, vertices)
            for face, (_, vertices) in zip(setup.solution.faces, space.contact, strict=True)
        ]
        rows = [slice(*pair) for pair in pairwise(ends)]
        return cls(space, faces, rows, Signorini(setup.problem.M, space.N, space.free_points).W)

    def squares(self, times: Array, multipliers: Array) -> tuple[Array, Array]:
        """The squares of ``ERRORS``, with λ (n, m), summed over n times, and those of the exact quantities, (3,)."""
        exact = [face.pressure(times) for face in self.faces]
        y = np.concatenate([face.moments(p) for face, p in zip(self.faces, exact, strict=True)])
        missing, parts = y - multipliers.T, list(zip(self.faces, exact, self.rows, strict=True))
        errors = sum(face.square(p - face.held(multipliers.T[rows])).sum() for face, p, rows in parts)
        sizes = sum(face.square(p).sum() for face, p, _ in parts)
        total, lost = (np.array([values[rows].sum(axis=0) for rows in self.rows]) for values in (y, missing))
        found = errors, np.vdot(missing, self.W @ missing), np.vdot(lost, lost)
        return np.array(found), np.array([sizes, np.vdot(y, self.W @ y), np.vdot(total, total)])

    def penetration(self, state: State) -> float:
        """max (u^h_ν)_+ over the points of Γ3."""
        nodal = self.space.nodal(state.u)
        return max(0.0, *(float(face.normal_trace(nodal).max()) for face in self.faces))


@dataclass(frozen=True, eq=False)
class Course:
    """A trajectory: the relative ``ERRORS`` in L²(0,T), (3,), and the two numbers that have to be zero."""

    errors: Array
    penetration: float
    pulling: float

    @classmethod
    def of(cls, setup: Experiment, forces: Forces, steps: int) -> Course:
        """The midpoint rule with so many steps."""
        k = setup.problem.T / steps
        multipliers = []
        inside, pulled, pressed, moved = 0.0, 0.0, 0.0, 0.0
        for state in setup.scheme.march(setup.problem, steps):
            inside = max(inside, forces.penetration(state))
            moved = max(moved, float(abs(state.u).max()))
            pulled = max(pulled, float(-state.multipliers.min()))
            pressed = max(pressed, float(abs(state.multipliers).max()))
            multipliers.append(state.multipliers)
        squares, sizes = forces.squares((np.arange(steps) + 0.5) * k, np.array(multipliers[1:]))
        return cls(np.sqrt(squares / sizes), inside / moved, pulled / pressed)


def measure_contact(setup: Experiment) -> dict[str, Any]:
    """The numbers of ``COLUMNS`` from ``h`` on; the scheme is the midpoint rule and the number of steps even."""
    forces = Forces.of(setup)
    fine, coarse = (Course.of(setup, forces, steps) for steps in (setup.steps, setup.steps // 2))
    shares = abs(fine.errors - coarse.errors) / fine.errors
    return {
        "h": setup.space.h,
        "steps": setup.steps,
        **dict(zip(ERRORS, map(float, fine.errors), strict=True)),
        **dict(zip(SHARES, map(float, shares), strict=True)),
        "penetration": fine.penetration,
        "pulling": fine.pulling,
    }
