"""K^h = V^h ∩ K is what the vertices say, and Π^h takes continuous functions of K into it (around (5.23)).

The code has K^h as {v : Nv ≤ 0}. What K is, v_ν ≤ 0 on all of Γ3 and v = 0 on Γ1, is asked here of points between the
vertices, with the normals of the body's parts and facets found by their place; N only makes members (Nv ≤ 0, the
extreme rays among them) and strangers (one (Nv)_i > 0).
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from manufactured.body import Body, Kind, Part
from manufactured.catalogue import catalogue
from manufactured.exact import ExactSolution
from manufactured.tensors import Array, Points, Vectors
from study.fem.naming import resolve
from study.fem.space import Space
from study.ledger.measures import every, largest
from study.ledger.window import Window, at_most
from study.statements.boundary import Field, distances, planes, waves
from study.statements.shared.base import SEED, ListedNumbers, Setting, with_h
from study.statements.shared.meshes import BODIES, EVERY, IRREGULAR, named, place, space_of

SAMPLES = 40
"""Random members, extreme rays, strangers and smooth fields."""
INSTANTS = 33
"""Times at which the exact solution is interpolated."""
INSIDE, CORNER = 24, 0.95
"""Random points on each facet, beside one near each of its vertices with this barycentric coordinate."""
TOLERANCE = 1e-8
"""Distance below which a vertex lies on a part of the boundary."""
NEVER = at_most(1e-12, "never positive but for rounding", low=-math.inf)
SEEN = Window(0.5, 1.0, "of that at the vertex")
"""With v_ν = 1 at a vertex and v_ν ≥ −1 at the others the points near it have 2 · 0.95 − 1 = 0.9 at least."""
CLAMPED = at_most(1e-12, "0 but for rounding")


class VertexConstraint(ListedNumbers):
    """The largest v_ν on Γ3 of members of K^h, the smallest of strangers, once for each body."""

    label = "K^h"
    claim = "v ∈ V^h lies in K if and only if v_ν ≤ 0 at the vertices of Γ3"
    rules = (
        largest("members", "Nv ≤ 0 ⇒ v_ν ≤ 0 on Γ3", NEVER, "members"),
        every("strangers", "(Nv)_i > 0 ⇒ v_ν > 0 somewhere on Γ3", SEEN, "strangers"),
    )

    def places(self, full: bool) -> list[Setting]:
        bodies = named(*BODIES)
        return place(bodies, EVERY, (8, 16), (2, 4)) if full else place(bodies, IRREGULAR, (8,), (2,))

    def measure(self, setting: Setting) -> dict[str, float]:
        space, rng = space_of(setting), np.random.default_rng(SEED)
        trace = NormalTrace(space)
        inside = max(trace.highest(v) / abs(v).max() for v in members(space, rng))
        outside = min(trace.highest(v) for v in strangers(space, rng))
        return with_h(space.h, {"members": inside, "strangers": outside})


class Interpolant(ListedNumbers):
    """The largest v_ν on Γ3 of Π^h v, for v = u(t) at many times and for random smooth v ∈ K."""

    label = "Π^h"
    claim = "Π^h v ∈ K^h for v ∈ K ∩ C(Ω̄)"
    rules = (
        largest("exact", "Π^h u(t): v_ν on Γ3 and Nv", NEVER, "exact"),
        largest("clamped", "|u(t)| on Γ1", CLAMPED, "clamped"),
        largest("smooth", "Π^h v for random v ∈ K ∩ C(Ω̄): v_ν on Γ3 and Nv", NEVER, "smooth"),
    )

    def places(self, full: bool) -> list[Setting]:
        return place(catalogue(), EVERY, (8, 16), (2, 4)) if full else place(named(*BODIES), IRREGULAR, (8,), (2,))

    def measure(self, setting: Setting) -> dict[str, float]:
        space, solution = space_of(setting), resolve(setting.case).solution
        trace, fields = NormalTrace(space), admissible(space.body, np.random.default_rng(SEED))
        smooth = max(interpolated(trace, field) for field in fields)
        return with_h(space.h, {"smooth": smooth, **over_time(trace, solution)})


class NormalTrace:
    """v_ν on Γ3 for v ∈ V^h, at points between the vertices."""

    def __init__(self, space: Space) -> None:
        self.space = space
        dim, rng, rest = space.dim, np.random.default_rng(SEED), (1 - CORNER) / (space.dim - 1)
        near = np.full((dim, dim), rest) + np.eye(dim) * (CORNER - rest)
        self.barycentric = np.hstack([near, rng.dirichlet(np.ones(dim), INSIDE).T])
        self.facets = [(part.normal, self._on(part)) for part in space.body.of(Kind.CONTACT)]

    def _on(self, part: Part) -> Array:
        """The vertices of the boundary facets on a part, (d, n)."""
        mesh = self.space.mesh
        ends = mesh.facets[:, mesh.boundary_facets()]
        return ends[:, part.contains(mesh.p, TOLERANCE)[ends].all(axis=0)]

    def highest(self, v: Array) -> float:
        """The largest v_ν over the points."""
        nodal = self.space.nodal(v)
        values = [np.tensordot(normal, nodal[:, facets], axes=1).T @ self.barycentric for normal, facets in self.facets]
        return float(max(value.max() for value in values))


def with_trace(space: Space, v: Array, values: Array) -> Array:
    """The function nearest to v, in the nodal values, with Nv = values."""
    N = space.N
    return v + N.T @ np.linalg.solve((N @ N.T).toarray(), values - N @ v)


def members(space: Space, rng: np.random.Generator) -> Iterator[Array]:
    """Random members of {v : Nv ≤ 0}, with many of its constraints active, and extreme rays of it."""
    count = space.N.shape[0]
    for _ in range(SAMPLES):
        yield with_trace(space, rng.standard_normal(space.dofs), np.minimum(rng.standard_normal(count), 0.0))
    for i in rng.permutation(count)[:SAMPLES]:
        yield with_trace(space, rng.standard_normal(space.dofs), -np.eye(count)[i])


def strangers(space: Space, rng: np.random.Generator) -> Iterator[Array]:
    """Functions with (Nv)_i = 1 for one i and −1 ≤ (Nv)_j ≤ 0 for all others."""
    count = space.N.shape[0]
    for i in rng.permutation(count)[:SAMPLES]:
        values = -rng.uniform(size=count)
        values[i] = 1.0
        yield with_trace(space, rng.standard_normal(space.dofs), values)


def violation(trace: NormalTrace, v: Array) -> float:
    """The largest v_ν on Γ3 or (Nv)_i."""
    return max(trace.highest(v), float((trace.space.N @ v).max()))


def over_time(trace: NormalTrace, solution: ExactSolution) -> dict[str, float]:
    """The largest violation of Π^h u(t), and |u(t)| on Γ1, over the times and relative to |u|."""
    space, fields = trace.space, solution.at(trace.space.mesh.p)
    fixed = np.unique(np.concatenate([space.vertices(part) for part in space.body.of(Kind.CLAMPED)]))
    values = [fields.displacement(float(time)) for time in np.linspace(0, solution.body.T, INSTANTS)]
    size = max(float(abs(nodal).max()) for nodal in values)
    return {
        "exact": max(violation(trace, space.interpolate(nodal)) for nodal in values) / size,
        "clamped": max(float(abs(nodal[:, fixed]).max()) for nodal in values) / size,
    }


def interpolated(trace: NormalTrace, field: Field) -> float:
    """The violation of Π^h v, relative to |v|."""
    nodal = field(trace.space.mesh.p)
    return violation(trace, trace.space.interpolate(nodal)) / float(abs(nodal).max())


def admissible(body: Body, rng: np.random.Generator) -> list[Field]:
    """Random smooth v ∈ K, with δ_1, δ_3, δ_i the squared distances to Γ1, to Γ3 and to Γ3 without Γ3,i:

    v = δ_1 (δ_3 w + Σ_i δ_i (w_i − (w_i)_ν ν − b_i² ν)),   so that v_ν = −δ_1 δ_i b_i² on Γ3,i.
    """
    clamped, contact = planes(body, Kind.CLAMPED), planes(body, Kind.CONTACT)

    def squared(x: Points, parts: list[Part]) -> Array:
        return distances(x, parts) ** 2

    def field() -> Field:
        inner, pieces = waves(body, rng), [(part, waves(body, rng), waves(body, rng)) for part in contact]

        def v(x: Points) -> Vectors:
            total = squared(x, contact) * inner(x)
            for part, along, pressed in pieces:
                others = [other for other in contact if other is not part]
                free, depth = along(x), pressed(x)[0] ** 2
                normal = np.tensordot(part.normal, free, axes=1) + depth
                total = total + squared(x, others) * (free - np.multiply.outer(part.normal, normal))
            return squared(x, clamped) * total

        return v

    return [field() for _ in range(SAMPLES)]
