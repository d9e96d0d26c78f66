"""The discrete contact constraint: a P1 function does not penetrate if it does not penetrate at the vertices of Γ3.

That is, v ∈ V^h lies in K if v_ν ≤ 0 at the vertices of Γ3. So Π^h v ∈ K^h for continuous v ∈ K (near (5.23)).

The solvers represent K^h = V^h ∩ K by {v : Nv ≤ 0}, where Nv are normal displacements at vertices. The test checks the
definition of K, v_ν ≤ 0 on all of Γ3 and v = 0 on Γ1, at points between the vertices. It takes normals and facets from
the geometry of the body. The matrix N only serves to make functions in K^h (Nv ≤ 0, including extreme rays of the cone)
and functions outside K^h (one (Nv)_i > 0). Linear functions attain their maximum at vertices, so no violation is
allowed.
"""

import math
from collections.abc import Iterator

import numpy as np

from manufactured.body import Body, Kind
from manufactured.catalogue import catalogue
from manufactured.exact import ExactSolution
from manufactured.tensors import Array, Points, Vectors
from study.fem.naming import resolve
from study.fem.space import Space
from study.ledger.criterion import every, largest
from study.ledger.window import Window, at_most
from study.statements.boundary import Field, distances, planes, waves
from study.statements.shared.base import SEED, ListedNumbers, Setting, with_h
from study.statements.shared.meshes import EVERY, IRREGULAR, place, representing, space_of
from study.statements.shared.norms import maximum, minimum

SAMPLES = 40
"""Number of test functions of each kind.

The kinds are random functions in K^h, extreme rays of K^h, functions outside K^h, and smooth fields."""
INSTANTS = 33
"""Number of times at which the exact solution is interpolated."""
INSIDE, CORNER = 24, 0.95
"""Number of random test points on each facet, and position of one more test point near each vertex of the facet.

The position is the barycentric coordinate with respect to the vertex."""
TOLERANCE = 1e-8
"""A vertex belongs to a part of the boundary if its distance from the part is below this number."""
NEVER = at_most(1e-12, "never positive, up to rounding", low=-math.inf)
SEEN = Window(0.5, 1.0, "of the value at the vertex")
"""Window of the largest v_ν for functions outside K^h, with v_ν = 1 at one vertex and v_ν ≥ −1 at all others.

At the test point near this vertex v_ν ≥ 2 · 0.95 − 1 = 0.9."""
CLAMPED = at_most(1e-12, "0 up to rounding")


class VertexConstraint(ListedNumbers):
    """Measures the largest normal displacement v_ν on Γ3, for P1 functions inside and outside the set K^h."""

    label = "K^h"
    claim = "v ∈ V^h lies in K if and only if v_ν ≤ 0 at the vertices of Γ3"
    rules = (
        largest("members", "largest v_ν on Γ3 for random v with v_ν ≤ 0 at the vertices", NEVER, "members"),
        every("strangers", "largest v_ν on Γ3 for v with v_ν > 0 at one vertex", SEEN, "strangers"),
    )

    def places(self, full: bool) -> list[Setting]:
        bodies = representing("body")
        return place(bodies, EVERY, (8, 16), (2, 4)) if full else place(bodies, IRREGULAR, (8,), (2,))

    def measure(self, setting: Setting) -> dict[str, float]:
        space, rng = space_of(setting), np.random.default_rng(SEED)
        trace = NormalTrace(space)
        inside = maximum(trace.highest(v) / abs(v).max() for v in members(space, rng))
        outside = minimum(trace.highest(v) for v in nonmembers(space, rng))
        return with_h(space.h, {"members": inside, "strangers": outside})


class Interpolant(ListedNumbers):
    """Measures whether nodal interpolants Π^h v penetrate the foundation.

    The functions v are exact solutions at many times and random smooth functions v ∈ K, which do not penetrate.
    """

    label = "Π^h"
    claim = "Π^h v ∈ K^h for v ∈ K ∩ C(Ω̄)"
    rules = (
        largest("exact", "largest v_ν on Γ3 for v = Π^h u(t)", NEVER, "exact"),
        largest("clamped", "|u(t)| on Γ1", CLAMPED, "clamped"),
        largest("smooth", "largest (Π^h v)_ν on Γ3 for random v ∈ K ∩ C(Ω̄)", NEVER, "smooth"),
    )

    def places(self, full: bool) -> list[Setting]:
        if full:
            return place(catalogue(), EVERY, (8, 16), (2, 4))
        return place(representing("body"), IRREGULAR, (8,), (2,))

    def measure(self, setting: Setting) -> dict[str, float]:
        space, solution = space_of(setting), resolve(setting.case).solution
        trace, fields = NormalTrace(space), admissible(space.body, np.random.default_rng(SEED))
        nodal = [field(space.mesh.p) for field in fields]
        smooth = maximum(violation(trace, space.interpolate(values)) / float(abs(values).max()) for values in nodal)
        return with_h(space.h, {"smooth": smooth, **over_time(trace, solution)})


class NormalTrace:
    """Evaluates the normal displacement v_ν of P1 functions at points of Γ3 between the vertices."""

    def __init__(self, space: Space) -> None:
        self.space = space
        dim, rng, rest = space.dim, np.random.default_rng(SEED), (1 - CORNER) / (space.dim - 1)
        near = np.full((dim, dim), rest) + np.eye(dim) * (CORNER - rest)
        self.barycentric = np.hstack([near, rng.dirichlet(np.ones(dim), INSIDE).T])
        mesh = space.mesh
        ends = mesh.facets[:, mesh.boundary_facets()]
        self.facets = [
            (part.normal, ends[:, part.contains(mesh.p, TOLERANCE)[ends].all(axis=0)])
            for part in space.body.of(Kind.CONTACT)
        ]

    def highest(self, v: Array) -> float:
        """Return the largest normal displacement v_ν over the test points on Γ3."""
        nodal = self.space.nodal(v)
        values = [np.tensordot(normal, nodal[:, facets], axes=1).T @ self.barycentric for normal, facets in self.facets]
        return maximum(value.max() for value in values)


def with_trace(space: Space, v: Array, values: Array) -> Array:
    """Return the P1 function nearest to v that has given normal displacements at the vertices of Γ3.

    Args:
        v: degrees of freedom, (dofs,).
        values: the normal displacements, (m,).
    """
    N = space.N
    return v + N.T @ np.linalg.solve((N @ N.T).toarray(), values - N @ v)


def members(space: Space, rng: np.random.Generator) -> Iterator[Array]:
    """Yield functions in K^h: random functions with many contact vertices, and extreme rays of the cone {Nv ≤ 0}."""
    count = space.N.shape[0]
    for _ in range(SAMPLES):
        yield with_trace(space, rng.standard_normal(space.dofs), np.minimum(rng.standard_normal(count), 0.0))
    for i in rng.permutation(count)[:SAMPLES]:
        yield with_trace(space, rng.standard_normal(space.dofs), -np.eye(count)[i])


def nonmembers(space: Space, rng: np.random.Generator) -> Iterator[Array]:
    """Yield functions outside K^h, with v_ν = 1 at one vertex of Γ3 and −1 ≤ v_ν ≤ 0 at all others."""
    count = space.N.shape[0]
    for i in rng.permutation(count)[:SAMPLES]:
        values = -rng.uniform(size=count)
        values[i] = 1.0
        yield with_trace(space, rng.standard_normal(space.dofs), values)


def violation(trace: NormalTrace, v: Array) -> float:
    """Return the largest normal displacement of a P1 function on Γ3, at the test points and at the vertices."""
    return maximum((trace.highest(v), (trace.space.N @ v).max()))


def over_time(trace: NormalTrace, solution: ExactSolution) -> dict[str, float]:
    """Return how far the exact solution u violates the contact constraint and the clamping, over many times.

    Measured are the penetration of the interpolant Π^h u(t) on Γ3, and |u(t)| on the clamped boundary Γ1, both relative
    to the largest |u|.
    """
    space, fields = trace.space, solution.at(trace.space.mesh.p)
    fixed = np.unique(np.concatenate([space.vertices(part) for part in space.body.of(Kind.CLAMPED)]))
    values = [fields.displacement(float(time)) for time in np.linspace(0, solution.body.T, INSTANTS)]
    size = maximum(abs(nodal).max() for nodal in values)
    return {
        "exact": maximum(violation(trace, space.interpolate(nodal)) for nodal in values) / size,
        "clamped": maximum(abs(nodal[:, fixed]).max() for nodal in values) / size,
    }


def admissible(body: Body, rng: np.random.Generator) -> list[Field]:
    """Return random smooth functions v ∈ K, which vanish on Γ1 and do not penetrate the foundation.

    Let δ_1, δ_3 and δ_i be products of squared distances from the planes of Γ1, of Γ3, and of Γ3 without its face Γ3,i.
    With random waves w, w_i and b_i,

        v = δ_1 (δ_3 w + Σ_i δ_i (w_i − (w_i)_ν ν − b_i² ν)),   so that v_ν = −δ_1 δ_i b_i² on Γ3,i.
    """
    clamped, contact = planes(body, Kind.CLAMPED), planes(body, Kind.CONTACT)

    def field() -> Field:
        inner, pieces = waves(body, rng), [(part, waves(body, rng), waves(body, rng)) for part in contact]

        def v(x: Points) -> Vectors:
            total = distances(x, contact) ** 2 * inner(x)
            for part, along, pressed in pieces:
                others = [other for other in contact if other is not part]
                free, depth = along(x), pressed(x)[0] ** 2
                normal = np.tensordot(part.normal, free, axes=1) + depth
                total = total + distances(x, others) ** 2 * (free - np.multiply.outer(part.normal, normal))
            return distances(x, clamped) ** 2 * total

        return v

    return [field() for _ in range(SAMPLES)]
