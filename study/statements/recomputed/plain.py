"""Problem 5.1 once more, by the plainest means: what ``study.fem`` and ``study.solve`` do is done here in another way.

In common with them are the exact solution, the mesh, and where cells are cut for quadrature. Gradients come from
inverse matrices of coordinates, integrals are sums over the points of a finer rule, strain by strain, without modes,
means or an oscillation, and the law acts at these points. A step of the midpoint rule

    M (u_n − u_{n−1})/k + (Gε((u_n + u_{n−1})/2), ε(·))_Q + Nᵀλ_n = F(t_{n−1/2})

is a fixed point in u_n, for a linear law too, with a factorisation of M by SuperLU and the method of Lawson and Hanson
for the multipliers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import scipy.sparse as sps
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import nnls
from scipy.sparse.linalg import splu
from skfem import Mesh

from manufactured.body import Kind
from manufactured.exact import ExactSolution
from manufactured.tensors import Array, Tensors, mandel
from study.fem.gauge import rules
from study.fem.quadrature import facet_rule

DEGREE, SOLID_DEGREE = 10, 6
"""Degrees of the cell rule in 2D and in 3D, where the gauge has 4 and 2."""
POINTS, SOLID_POINTS = 20, 6
"""Gauss points on a facet of Γ3, and in each direction of one in 3D."""
SETTLED, ITERATIONS = 1e-12, 100
"""Relative change at which the fixed point is found, and how many may be needed."""
ON = 1e-9
"""Distance from a part, relative to that of the farthest vertices, up to which a vertex lies on it."""


class PlainProblem:
    """V^h with its problem on one mesh.

    Attributes:
        free: the positions of the unknowns among the values at all vertices, in the order vertex by vertex, (n,).
        M: (A ε(u), ε(v))_Q, (n, n).
        N: v ↦ v_ν at the vertices of each piece of Γ3 off Γ1, one row for each normal, (m, n).
    """

    def __init__(self, solution: ExactSolution, mesh: Mesh) -> None:
        self.solution, self.mesh, self.dim = solution, mesh, int(mesh.dim())
        self._set_points(DEGREE if self.dim == 2 else SOLID_DEGREE)
        room = ON * float(np.ptp(mesh.p))
        fixed = np.any([part.contains(mesh.p, room) for part in solution.body.of(Kind.CLAMPED)], axis=0)
        self.free = np.flatnonzero(np.repeat(~fixed, self.dim))
        self.numbers = np.full(fixed.size * self.dim, -1)
        self.numbers[self.free] = np.arange(self.free.size)
        self._set_forms()
        self._set_contact(room)

    def _set_points(self, degree: int) -> None:
        found = rules(self.solution, self.mesh, degree)
        flat = [rule.points.reshape(self.dim, -1) for rule in found]
        self.cell = np.concatenate([np.repeat(rule.cells, rule.weights.shape[1]) for rule in found])
        self.weights = np.concatenate([rule.weights.ravel() for rule in found])
        within = self.cell, np.arange(self.cell.size)
        self.sums = sps.csr_array((self.weights, within), shape=(self.mesh.t.shape[1], self.cell.size))
        x = np.concatenate(flat, axis=1)
        self.exact, self.at_vertices = self.solution.at(x), self.solution.at(self.mesh.p)
        self.law = self.solution.law.at(x)

    def _set_forms(self) -> None:
        """Strains of the local functions φ_i e_j, (cells, D, (d + 1) d), and M."""
        corners = np.moveaxis(self.mesh.p[:, self.mesh.t], -1, 0).swapaxes(1, 2)
        slopes = np.linalg.inv(np.insert(corners, 0, 1.0, axis=2))[:, 1:]
        jacobians = np.einsum("jk,cli->jlcik", np.eye(self.dim), slopes)
        self.strains = np.moveaxis(mandel(jacobians), 0, 1).reshape(len(slopes), -1, (self.dim + 1) * self.dim)
        self.local = (self.dim * self.mesh.t.T[..., None] + np.arange(self.dim)).reshape(len(slopes), -1)
        columns = [self._tested(self.law.A(each[self.cell].T)) for each in np.moveaxis(self.strains, 2, 0)]
        local = np.stack(columns, axis=2)
        rows, cols = (np.broadcast_to(axis, local.shape) for axis in (self.local[..., None], self.local[:, None]))
        size = self.numbers.size
        full = sps.csc_array((local.ravel(), (rows.ravel(), cols.ravel())), shape=(size, size))
        self.M = sps.csc_array(full[self.free][:, self.free])
        self._solve = splu(self.M).solve

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

    def _set_contact(self, room: float) -> None:
        self.faces = []
        normals: list[Array] = []
        at: list[int] = []
        for face in self.solution.faces:
            on = np.flatnonzero(face.part.contains(self.mesh.p, room))
            facets = self.mesh.boundary_facets()
            facets = facets[np.isin(self.mesh.facets[:, facets], on).all(axis=0)]
            count = POINTS if self.dim == 2 else SOLID_POINTS
            rule = facet_rule(self.mesh, facets, face.part, face.rough, count)
            self.faces.append((face, rule, self.solution.on(face, rule.s)))
            known = [
                vertex for vertex, normal in zip(at, normals, strict=True) if np.allclose(normal, face.part.normal)
            ]
            new = [int(v) for v in on if self.numbers[self.dim * v] >= 0 and v not in known]
            at, normals = [*at, *new], [*normals, *[face.part.normal] * len(new)]
        columns = self.numbers[self.dim * np.array(at)[:, None] + np.arange(self.dim)]
        rows = np.repeat(np.arange(len(at)), self.dim)
        self.N = sps.csr_array((np.ravel(normals), (rows, columns.ravel())), shape=(len(at), self.free.size))
        self._response = self._solve(self.N.T.toarray())
        self._root = cholesky(self.N @ self._response, lower=True)

    def load(self, time: float) -> Array:
        """(σ, ε(v))_Q + ∫_{Γ3} p v_ν, (n,)."""
        nodal = np.zeros((self.mesh.p.shape[1], self.dim))
        for face, rule, exact in self.faces:
            for shape, vertices in zip(rule.shapes, self.mesh.facets[:, rule.facets], strict=True):
                forces = np.sum(exact.pressure(time) * shape * rule.weights, axis=-1)
                np.add.at(nodal, vertices, np.multiply.outer(forces, face.part.normal))
        return self.work(self.exact.stress(time)) + nodal.ravel()[self.free]

    def interpolant(self, time: float) -> Array:
        """Π^h u(t), (n,)."""
        return self.at_vertices.displacement(time).T.ravel()[self.free]

    def contact(self, b: Array, k: float) -> tuple[Array, Array]:
        """(u, λ) with M u/k + Nᵀλ = b, N u ≤ 0, λ ≥ 0, λ·N u = 0."""
        u = k * self._solve(b)
        multipliers, _ = nnls(self._root.T, solve_triangular(self._root, self.N @ u / k, lower=True))
        return u - k * (self._response @ multipliers), multipliers

    def march(self, steps: int, load: Callable[[float], Array]) -> Iterator[tuple[float, Array, Array]]:
        """(t_n, u_n, λ_n) of the midpoint rule from Π^h u_0 with a load F, (n,) at a time; λ_0 = 0."""
        k, u = self.solution.body.T / steps, self.interpolant(0.0)
        yield 0.0, u, np.zeros(self.N.shape[0])
        for n in range(1, steps + 1):
            b, before, guess = load((n - 0.5) * k) + self.M @ u / k, u, u
            for _ in range(ITERATIONS):
                u, multipliers = self.contact(b - self.work(self.law.G(self.strain((guess + before) / 2))), k)
                if self.norm(u - guess) <= SETTLED * self.norm(u):
                    break
                guess = u
            yield n * k, u, multipliers

    def norm(self, v: Array) -> float:
        """‖v‖_V on V^h."""
        return float(np.sqrt(v @ (self.M @ v)))

    def distance(self, time: float, *functions: Array) -> list[float]:
        """‖u(t) − v‖_V for some v ∈ V^h, point by point."""
        exact = self.exact.strain(time)
        missing = [exact - self.strain(v) for v in functions]
        return [float(np.sqrt(np.sum(self.law.A(each) * each * self.weights))) for each in missing]
