"""A solver that shares no code with the study: another mesh generator, P1 and P2, the θ scheme, contact by NNLS.

It takes ``Data`` of a convex quadrilateral with the sides Γ3, Γ2, Γ1, Γ2, and serves as the program of somebody else.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import scipy.sparse as sps
from scipy.optimize import nnls
from scipy.sparse.linalg import splu
from scipy.spatial import Delaunay

from manufactured import Data, Kind
from manufactured.tensors import Array

# The rule of degree 4 with six points, and Gauss's rule with four points on [0, 1].
A4, B4 = 0.445948490915965, 0.091576213509771
POINTS = np.array(
    [[1 - 2 * a, a, a] for a in (A4, B4)]
    + [[a, 1 - 2 * a, a] for a in (A4, B4)]
    + [[a, a, 1 - 2 * a] for a in (A4, B4)]
)
WEIGHTS = np.array([0.223381589678011, 0.109951743655322] * 3)
GAUSS, GAUSS_WEIGHTS = (np.polynomial.legendre.leggauss(4)[0] + 1) / 2, np.polynomial.legendre.leggauss(4)[1] / 2
SIDES = ((0, 1), (1, 2), (2, 0))


def quadrilateral_mesh(corners: Array, n: int, rng: np.random.Generator) -> tuple[Array, Array]:
    """Return points (k, 2) and triangles (m, 3): Delaunay's triangulation of a shaken grid."""
    s, r = (each.ravel() for each in np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1)))
    inside = (s > 0) & (s < 1) & (r > 0) & (r < 1)
    s, r = (np.where(inside, each + rng.uniform(-0.25, 0.25, len(each)) / n, each) for each in (s, r))
    weights = np.array([(1 - s) * (1 - r), s * (1 - r), s * r, (1 - s) * r])
    points = weights.T @ corners
    triangles = Delaunay(points).simplices
    a, b, c = (points[triangles[:, i]] for i in range(3))
    areas = abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    return points, triangles[areas > 1e-9]


def halved(points: Array, triangles: Array) -> tuple[Array, Array]:
    """Return the mesh with every triangle cut into four; children 4i, …, 4i + 3 belong to triangle i."""
    points, six = with_midpoints(points, triangles)
    a, b, c, ab, bc, ca = six.T
    children = np.stack([np.array(child).T for child in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))], axis=1)
    return points, children.reshape(-1, 3)


def with_midpoints(points: Array, triangles: Array) -> tuple[Array, Array]:
    """Return the points with midpoints of sides, and triangles of six nodes: corners, then midpoints of 01, 12, 20."""
    sides = np.sort(np.concatenate([triangles[:, side] for side in SIDES]), axis=1)
    unique, number = np.unique(sides, axis=0, return_inverse=True)
    return np.vstack([points, points[unique].mean(axis=1)]), np.hstack(
        [triangles, len(points) + number.reshape(3, -1).T]
    )


def shapes(degree: int, λ: Array) -> Array:
    """Values of the basis functions at barycentric points (q, 3), (q, 3 or 6)."""
    if degree == 1:
        return λ
    return np.hstack([2 * λ**2 - λ, np.stack([4 * λ[:, i] * λ[:, j] for i, j in SIDES], axis=1)])


def derivatives(degree: int, λ: Array) -> Array:
    """Derivatives of the basis functions with respect to the barycentric coordinates, (q, 3 or 6, 3)."""
    unit = np.broadcast_to(np.eye(3), (len(λ), 3, 3))
    if degree == 1:
        return unit
    of_sides = [4 * (λ[:, i, None] * unit[:, j] + λ[:, j, None] * unit[:, i]) for i, j in SIDES]
    return np.concatenate([(4 * λ - 1)[:, :, None] * unit, np.stack(of_sides, axis=1)], axis=1)


@dataclass(frozen=True, eq=False)
class Solver:
    """Problem 2.1 on one mesh with P1 or P2."""

    data: Data
    corners: Array
    triangles: Array
    degree: int

    @cached_property
    def mesh(self) -> tuple[Array, Array]:
        """Nodes and the nodes of the triangles."""
        return (self.corners, self.triangles) if self.degree == 1 else with_midpoints(self.corners, self.triangles)

    @cached_property
    def geometry(self) -> tuple[Array, Array]:
        """∇λ (cells, 3, 2) and areas."""
        a, b, c = (self.corners[self.triangles[:, i]] for i in range(3))
        J = np.stack([b - a, c - a], axis=2)
        inverse = np.linalg.inv(J)
        return np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1), abs(np.linalg.det(J)) / 2

    @cached_property
    def strains(self) -> Array:
        """ε in Mandel form of the basis functions at the points of the rule, (cells, q, 3, dofs of a cell)."""
        gradients = np.einsum("qnb,cbd->cqnd", derivatives(self.degree, POINTS), self.geometry[0])
        found = np.zeros((*gradients.shape[:2], 3, 2 * gradients.shape[2]))
        found[..., 0, 0::2], found[..., 1, 1::2] = gradients[..., 0], gradients[..., 1]
        found[..., 2, 0::2], found[..., 2, 1::2] = gradients[..., 1] / np.sqrt(2), gradients[..., 0] / np.sqrt(2)
        return found

    @cached_property
    def numbers(self) -> Array:
        cells = self.mesh[1]
        return np.stack([2 * cells, 2 * cells + 1], axis=2).reshape(len(cells), -1)

    def form(self, C: Array) -> sps.csc_array:
        local = np.einsum(
            "cqIi,IJ,cqJj,q,c->cij", self.strains, C, self.strains, WEIGHTS, self.geometry[1], optimize=True
        )
        rows = np.repeat(self.numbers, self.numbers.shape[1], axis=1).ravel()
        columns = np.tile(self.numbers, (1, self.numbers.shape[1])).ravel()
        return sps.csc_array((local.ravel(), (rows, columns)), shape=(self.count, self.count))

    @property
    def count(self) -> int:
        return 2 * len(self.mesh[0])

    def on(self, part) -> Array:
        return np.flatnonzero(part.contains(self.mesh[0].T, 1e-9))

    @cached_property
    def free(self) -> Array:
        fixed = np.concatenate([self.on(part) for part in self.data.body.of(Kind.CLAMPED)])
        return np.setdiff1d(np.arange(self.count), np.concatenate([2 * fixed, 2 * fixed + 1]))

    @cached_property
    def normal(self) -> sps.csr_array:
        """u ↦ u_ν at the nodes of Γ3 off Γ1."""
        rows = [np.zeros((0, self.count))]
        for part in self.data.body.of(Kind.CONTACT):
            for node in self.on(part):
                if 2 * node in set(self.free.tolist()):
                    row = np.zeros((1, self.count))
                    row[0, 2 * node : 2 * node + 2] = part.normal
                    rows.append(row)
        return sps.csr_array(np.vstack(rows))

    def load(self, time: float) -> Array:
        found = np.zeros(self.count)
        corners = self.corners[self.triangles]
        x = np.einsum("qb,cbd->dcq", POINTS, corners)
        force = self.data.body_force(x)(time)
        local = np.einsum("dcq,qn,q,c->cnd", force, shapes(self.degree, POINTS), WEIGHTS, self.geometry[1])
        np.add.at(found, self.numbers, local.reshape(len(local), -1))
        for part in self.data.body.of(Kind.LOADED):
            for i, j in SIDES:
                on = part.contains(corners[:, [i, j]].transpose(2, 0, 1), 1e-9).all(axis=1)
                if on.any():
                    λ = np.zeros((len(GAUSS), 3))
                    λ[:, i], λ[:, j] = 1 - GAUSS, GAUSS
                    x = np.einsum("qb,cbd->dcq", λ, corners[on])
                    length = np.linalg.norm(corners[on, i] - corners[on, j], axis=1)
                    traction = self.data.surface_load(part, x)(time)
                    local = np.einsum("dcq,qn,q,c->cnd", traction, shapes(self.degree, λ), GAUSS_WEIGHTS, length)
                    np.add.at(found, self.numbers[on], local.reshape(on.sum(), -1))
        return found

    def contact_solver(self, S: sps.csc_array):
        """b ↦ the minimiser of ½ uᵀSu − bᵀu with u = 0 on Γ1 and u_ν ≤ 0 at the nodes of Γ3."""
        factor, N = splu(sps.csc_array(S[self.free][:, self.free])), self.normal[:, self.free]
        Z = factor.solve(N.T.toarray())
        L = np.linalg.cholesky(N @ Z)

        def solve(b: Array) -> Array:
            u = np.zeros(self.count)
            loose = factor.solve(b[self.free])
            multipliers, _ = nnls(L.T, np.linalg.solve(L, N @ loose))
            u[self.free] = loose - Z @ multipliers
            return u

        return solve

    def march(self, times: Array, theta: float) -> Array:
        """Return u at the times, (k, nodes, 2), by the θ scheme; 1: implicit Euler, ½: midpoint rule."""
        A, G = (self.form(tensor.matrix) for tensor in (self.data.law.A, self.data.law.G))
        u = [np.array(self.data.start(self.mesh[0].T)).T.ravel()]
        solvers: dict[float, object] = {}
        for before, after in pairwise(times):
            k = after - before
            key = round(k, 12)
            if key not in solvers:
                solvers[key] = self.contact_solver(A / k + theta * G)
            b = self.load(before + theta * k) + A @ u[-1] / k - (1 - theta) * (G @ u[-1])
            u.append(solvers[key](b))
        return np.array(u).reshape(len(times), -1, 2)

    def static(self) -> Array:
        """Return u in equilibrium, (nodes, 2)."""
        return self.contact_solver(self.form(self.data.law.G.matrix))(self.load(0.0)).reshape(-1, 2)

    def at_nodes_of(self, fine: Solver, times_finer: int, u: Array) -> Array:
        """Return u, (..., nodes, 2), at the nodes of the mesh that ``halved`` gives after some turns."""
        nodes, cells = fine.mesh
        parents = np.repeat(np.arange(len(cells)) // 4**times_finer, cells.shape[1])
        flat = cells.ravel()
        corner = self.corners[self.triangles[parents, 0]]
        λ = np.einsum("nbd,nd->nb", self.geometry[0][parents], nodes[flat] - corner)
        λ[:, 0] += 1
        values = np.einsum("ni,...nid->...nd", shapes(self.degree, λ), u[..., self.mesh[1][parents], :])
        found = np.zeros((*u.shape[:-2], len(nodes), 2))
        found[..., flat, :] = values
        return found


def norms(matrix: sps.csc_array, v: Array) -> Array:
    """Return (vᵀ M v)^½ for nodal values (k, nodes, 2)."""
    flat = v.reshape(len(v), -1).T
    return np.sqrt(np.maximum((flat * (matrix @ flat)).sum(axis=0), 0.0))
