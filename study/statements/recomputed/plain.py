"""Problem 5.1 once more, by the plainest means: what ``study.fem`` and ``study.solve`` do is done here in another way.

In common with them are the exact solution, the mesh, and where cells are cut for quadrature. Gradients come from
inverse matrices of coordinates, integrals are sums over the points of a finer rule, strain by strain, without modes,
means or an oscillation, and the law acts at these points: in every iteration, or once for a matrix if it is linear. A
step of the midpoint rule

    M (u_n − u_{n−1})/k + (Gε((u_n + u_{n−1})/2), ε(·))_Q + Nᵀλ_n = F(t_{n−1/2})

is a fixed point in u_n, for a linear law too, with a factorisation of M by SuperLU and the method of Lawson and Hanson
for the multipliers, once those of the last iteration no longer say which are positive.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np
import scipy.sparse as sps
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import nnls
from scipy.sparse.linalg import splu
from skfem import Mesh

from manufactured.body import Kind, Part
from manufactured.exact import ExactSolution, Face
from manufactured.law import Linear
from manufactured.tensors import Array, Tensors, dyad, mandel
from study.fem.gauge import rules
from study.fem.quadrature import FacetRule, facet_rule

DEGREE, SOLID_DEGREE = 10, 6
"""Degrees of the cell rule in 2D and in 3D, where the gauge has 4 and 2."""
POINTS, SOLID_POINTS = 20, 6
"""Gauss points on a facet of Γ3, and in each direction of one in 3D."""
SETTLED, ITERATIONS = 1e-12, 100
"""Relative change at which the fixed point is found, and how many may be needed."""
ON = 1e-9
"""Distance from a part, relative to that of the farthest vertices, up to which a vertex lies on it."""
Course = Sequence[tuple[float, Array, Array]]
"""(t_n, ũ_n, λ̃_n)."""


class PlainProblem:
    """V^h with its problem on one mesh.

    Attributes:
        free: the positions of the unknowns among the values at all vertices, in the order vertex by vertex, (n,).
        M: (A ε(u), ε(v))_Q, (n, n).
        N: v ↦ v_ν at the vertices of each piece of Γ3 off Γ1, one row for each normal, (m, n).
    """

    def __init__(self, solution: ExactSolution, mesh: Mesh) -> None:
        self.solution, self.mesh, self.dim = solution, mesh, int(mesh.dim())
        room = ON * float(np.ptp(mesh.p))
        fixed = np.any([part.contains(mesh.p, room) for part in solution.body.of(Kind.CLAMPED)], axis=0)
        self.free = np.flatnonzero(np.repeat(~fixed, self.dim))
        self.numbers = np.full(fixed.size * self.dim, -1)
        self.numbers[self.free] = np.arange(self.free.size)
        on = [np.flatnonzero(face.part.contains(mesh.p, room)) for face in solution.faces]
        self._set_points([self._facet_rule(face, vertices) for face, vertices in zip(solution.faces, on, strict=True)])
        self._set_forms()
        self._set_contact(on)

    def _facet_rule(self, face: Face, on: Array) -> FacetRule:
        """For the facets of the boundary with all vertices on a face."""
        facets = self.mesh.boundary_facets()
        facets = facets[np.isin(self.mesh.facets[:, facets], on).all(axis=0)]
        return facet_rule(self.mesh, facets, face.part, face.rough, POINTS if self.dim == 2 else SOLID_POINTS)

    def _set_points(self, on: list[FacetRule]) -> None:
        """The law at the points in cells, the exact solution at these and then at those on the pieces of Γ3."""
        found = rules(self.solution, self.mesh, DEGREE if self.dim == 2 else SOLID_DEGREE)
        self.cell = np.concatenate([np.repeat(rule.cells, rule.weights.shape[1]) for rule in found])
        self.weights = np.concatenate([rule.weights.ravel() for rule in found])
        within = self.cell, np.arange(self.cell.size)
        self.sums = sps.csr_array((self.weights, within), shape=(self.mesh.t.shape[1], self.cell.size))
        parts = [face.part for face in self.solution.faces]
        inside = np.concatenate([rule.points.reshape(self.dim, -1) for rule in found], axis=1)
        on_faces = [part.point(rule.s).reshape(self.dim, -1) for part, rule in zip(parts, on, strict=True)]
        self.exact = self.solution.at(np.concatenate([inside, *on_faces], axis=1))
        self.law, self.at_vertices = self.solution.law.at(inside), self.solution.at(self.mesh.p)
        ends = self.cell.size + np.cumsum([0, *(rule.weights.size for rule in on)])
        forces = [self._pressed(part, rule) for part, rule in zip(parts, on, strict=True)]
        self.faces = list(zip(map(slice, ends, ends[1:]), forces, strict=False))

    def _pressed(self, part: Part, rule: FacetRule) -> sps.csr_array:
        """∫ p v_ν over a piece of Γ3 with p = −σ_ν, from σ at the points of its rule, (n, D points)."""
        forces = np.multiply.outer(part.normal, rule.shapes * rule.weights)
        positions = np.add.outer(np.arange(self.dim), self.dim * self.mesh.facets[:, rule.facets, None])
        points = np.arange(rule.weights.size).reshape(rule.weights.shape)
        at = tuple(np.broadcast_to(axis, forces.shape).ravel() for axis in (positions, points))
        nodal = sps.csr_array((forces.ravel(), at), shape=(self.numbers.size, points.size))
        return sps.kron(-dyad(part.normal, part.normal)[None], nodal[self.free], format="csr")

    def _set_forms(self) -> None:
        """Strains of the local functions φ_i e_j, (cells, D, (d + 1) d), and matrices of A and of a linear G."""
        corners = np.moveaxis(self.mesh.p[:, self.mesh.t], -1, 0).swapaxes(1, 2)
        slopes = np.linalg.inv(np.insert(corners, 0, 1.0, axis=2))[:, 1:]
        jacobians = np.einsum("jk,cli->jlcik", np.eye(self.dim), slopes)
        self.strains = np.moveaxis(mandel(jacobians), 0, 1).reshape(len(slopes), -1, (self.dim + 1) * self.dim)
        self.local = (self.dim * self.mesh.t.T[..., None] + np.arange(self.dim)).reshape(len(slopes), -1)
        self.M = self._form(self.law.A)
        self._solve = splu(self.M, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}).solve
        self.elastic = self._form(self.law.G).__matmul__ if isinstance(self.solution.law.G, Linear) else self._resisted

    def _form(self, law: Callable[[Tensors], Tensors]) -> sps.csc_array:
        """(Cε(u), ε(v))_Q with a linear law C at the points, (n, n)."""
        columns = [self._tested(law(each[self.cell].T)) for each in np.moveaxis(self.strains, 2, 0)]
        local = np.stack(columns, axis=2)
        rows, cols = (np.broadcast_to(axis, local.shape) for axis in (self.local[..., None], self.local[:, None]))
        size = self.numbers.size
        full = sps.csc_array((local.ravel(), (rows.ravel(), cols.ravel())), shape=(size, size))
        return sps.csc_array(full[self.free][:, self.free])

    def _resisted(self, functions: Array) -> Array:
        """(Gε(v), ε(·))_Q for every column v, (n, c)."""
        return np.stack([self.work(self.law.G(self.strain(v))) for v in functions.T], axis=1)

    def _tested(self, stress: Tensors) -> Array:
        """∫_T σ·ε(φ) for the functions of each cell, from σ at the points, (cells, (d + 1) d)."""
        means = np.array([self.sums @ row for row in stress])
        return np.einsum("Ic,cIk->ck", means, self.strains)

    def work(self, stress: Tensors) -> Array:
        """(σ, ε(·))_Q, (n,)."""
        return np.bincount(self.local.ravel(), self._tested(stress).ravel(), self.numbers.size)[self.free]

    def strain(self, v: Array) -> Tensors:
        """ε(v) at the points, (D, points)."""
        full = np.zeros(self.numbers.size)
        full[self.free] = v
        return np.take(np.einsum("cIk,ck->Ic", self.strains, full[self.local]), self.cell, axis=1)

    def _set_contact(self, on: list[Array]) -> None:
        """N, M⁻¹Nᵀ, Q = NM⁻¹Nᵀ and R with RᵀR = Q."""
        normals: list[Array] = []
        at: list[int] = []
        for face, vertices in zip(self.solution.faces, on, strict=True):
            known = [
                vertex for vertex, normal in zip(at, normals, strict=True) if np.allclose(normal, face.part.normal)
            ]
            new = [int(v) for v in vertices if self.numbers[self.dim * v] >= 0 and v not in known]
            at, normals = [*at, *new], [*normals, *[face.part.normal] * len(new)]
        columns = self.numbers[self.dim * np.array(at)[:, None] + np.arange(self.dim)]
        rows = np.repeat(np.arange(len(at)), self.dim)
        self.N = sps.csr_array((np.ravel(normals), (rows, columns.ravel())), shape=(len(at), self.free.size))
        self._response = self._solve(self.N.T.toarray())
        self._normal = self.N @ self._response
        self._root = cholesky(self._normal)

    def load(self, time: float) -> Array:
        """(σ, ε(v))_Q + ∫_{Γ3} p v_ν, (n,)."""
        stress = self.exact.stress(time)
        pressed = [forces @ stress[:, points].ravel() for points, forces in self.faces]
        return np.sum([self.work(stress[:, : self.cell.size]), *pressed], axis=0)

    def interpolant(self, time: float) -> Array:
        """Π^h u(t), (n,)."""
        return self.at_vertices.displacement(time).T.ravel()[self.free]

    def contact(self, b: Array, k: float, last: Array) -> tuple[Array, Array]:
        """(u, λ) with M u/k + Nᵀλ = b, N u ≤ 0, λ ≥ 0, λ·N u = 0 for every column b, from λ of the last iteration."""
        freely = self._solve(b)
        pairs = zip((self.N @ freely).T, last.T > 0, strict=True)
        multipliers = np.stack([self._multipliers(entering, positive) for entering, positive in pairs], axis=1)
        return k * (freely - self._response @ multipliers), multipliers

    def _multipliers(self, entering: Array, positive: Array) -> Array:
        """λ ≥ 0 with Qλ ≥ b, λ·(Qλ − b) = 0 for Q = NM⁻¹Nᵀ: those that are positive first, if they are, else all."""
        found = np.zeros(len(entering))
        found[positive] = np.linalg.solve(self._normal[positive][:, positive], entering[positive])
        if (found[positive] > 0).all() and (self._normal @ found >= entering)[~positive].all():
            return found
        return np.asarray(nnls(self._root, solve_triangular(self._root, entering, trans="T"))[0])

    def courses(self, steps: int, *loads: Callable[[float], Array]) -> list[Course]:
        """(t_n, u_n, λ_n) of ``march``, for each load."""
        states = list(self.march(steps, loads))
        return [[(time, u[:, c], multipliers[:, c]) for time, u, multipliers in states] for c in range(len(loads))]

    def march(self, steps: int, loads: Sequence[Callable[[float], Array]]) -> Iterator[tuple[float, Array, Array]]:
        """(t_n, u_n, λ_n), (n, c) and (m, c), of the midpoint rule from Π^h u_0 with loads F, side by side; λ_0 = 0."""
        k, u = self.solution.body.T / steps, np.tile(self.interpolant(0.0)[:, None], len(loads))
        guess, multipliers = u, np.zeros((self.N.shape[0], len(loads)))
        yield 0.0, u, multipliers
        for n in range(1, steps + 1):
            b = np.stack([load((n - 0.5) * k) for load in loads], axis=1) + self.M @ u / k
            before = u
            for _ in range(ITERATIONS):
                u, multipliers = self.contact(b - self.elastic((guess + before) / 2), k, multipliers)
                changes, sizes = self.norms(np.hstack([u - guess, u])).reshape(2, -1)
                if (changes <= SETTLED * sizes).all():
                    break
                guess = u
            guess = 2 * u - before
            yield n * k, u, multipliers

    def norms(self, functions: Array) -> Array:
        """‖v‖_V on V^h, (n, c) → (c,)."""
        return np.sqrt(np.einsum("nc,nc->c", functions, self.M @ functions))

    def distance(self, time: float, *functions: Array) -> list[float]:
        """‖u(t) − v‖_V for some v ∈ V^h, point by point."""
        exact = self.exact.strain(time)[:, : self.cell.size]
        missing = [exact - self.strain(v) for v in functions]
        return [float(np.sqrt(np.einsum("Ip,Ip->p", self.law.A(each), each) @ self.weights)) for each in missing]
