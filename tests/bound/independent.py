"""A solver that shares no code with the study: another mesh generator, scikit-fem's P1 and P2, the θ scheme, NNLS.

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
from skfem import Basis, BilinearForm, ElementTriP1, ElementTriP2, ElementVector, FacetBasis, LinearForm, MeshTri
from skfem.helpers import dot, sym_grad

from manufactured import Data, Kind
from manufactured.tensors import Array

ELEMENTS = {1: ElementVector(ElementTriP1()), 2: ElementVector(ElementTriP2())}


def quadrilateral_mesh(corners: Array, n: int, rng: np.random.Generator) -> tuple[Array, Array]:
    """Return points (k, 2) and triangles (m, 3): Delaunay's triangulation of a shaken grid."""
    s, r = (each.ravel() for each in np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1)))
    inside = (s > 0) & (s < 1) & (r > 0) & (r < 1)
    s, r = (np.where(inside, each + rng.uniform(-0.25, 0.25, len(each)) / n, each) for each in (s, r))
    points = np.array([(1 - s) * (1 - r), s * (1 - r), s * r, (1 - s) * r]).T @ corners
    triangles = Delaunay(points).simplices
    a, b, c = (points[triangles[:, i]] for i in range(3))
    areas = abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    return points, triangles[areas > 1e-9]


def mandel(v) -> Array:
    """The strain ε(v) in Mandel's order."""
    e = sym_grad(v)
    return np.array([e[0, 0], e[1, 1], np.sqrt(2) * e[0, 1]])


@dataclass(frozen=True, eq=False)
class Solver:
    """Problem 2.1 on one mesh with P1 or P2."""

    data: Data
    grid: MeshTri
    degree: int

    @cached_property
    def basis(self) -> Basis:
        return Basis(self.grid, ELEMENTS[self.degree], intorder=4)

    @cached_property
    def mesh(self) -> tuple[Array, Array]:
        """Nodes (k, 2), and those of each triangle: the corners, then the midpoints of the sides 01, 12, 20."""
        corners, midpoints = self.grid.t.T, self.grid.p.shape[1] + self.grid.t2f.T
        return self.basis.doflocs[:, ::2].T, corners if self.degree == 1 else np.hstack([corners, midpoints])

    def form(self, C: Array) -> sps.csc_array:
        product = BilinearForm(lambda u, v, w: np.einsum("Icq,IJ,Jcq->cq", mandel(u), C, mandel(v)))
        return sps.csc_array(product.assemble(self.basis))

    def on(self, kind: Kind) -> list[tuple[Array, Array]]:
        """The nodes on each part of the boundary of a kind, and the normal of the part."""
        parts = self.data.body.of(kind)
        return [(np.flatnonzero(part.contains(self.mesh[0].T, 1e-9)), part.normal) for part in parts]

    @cached_property
    def free(self) -> Array:
        fixed = np.concatenate([nodes for nodes, _ in self.on(Kind.CLAMPED)])
        return np.setdiff1d(np.arange(self.basis.N), [2 * fixed, 2 * fixed + 1])

    @cached_property
    def normal(self) -> Array:
        """The matrix of u ↦ u_ν at the nodes of Γ3 off Γ1."""
        unit = np.eye(self.basis.N)
        rows = [n[0] * unit[2 * nodes] + n[1] * unit[2 * nodes + 1] for nodes, n in self.on(Kind.CONTACT)]
        return np.vstack([each[each[:, self.free].any(axis=1)] for each in rows])

    @cached_property
    def loaded(self) -> list[tuple]:
        """Each part of Γ2 with the functions on it."""
        inside = [(part, lambda x, part=part: part.contains(x, 1e-9)) for part in self.data.body.of(Kind.LOADED)]
        facets = [(part, self.grid.facets_satisfying(on_part, True)) for part, on_part in inside]
        return [(part, FacetBasis(self.grid, ELEMENTS[self.degree], facets=some, intorder=6)) for part, some in facets]

    def load(self, time: float) -> Array:
        work = LinearForm(lambda v, w: dot(self.data.body_force(np.asarray(w.x))(time), v)).assemble(self.basis)
        for part, basis in self.loaded:
            traction = self.data.surface_load(part, np.asarray(basis.global_coordinates()))(time)
            work = work + LinearForm(lambda v, w, traction=traction: dot(traction, v)).assemble(basis)
        return work

    def contact_solver(self, S: sps.csc_array):
        """b ↦ the minimiser of ½ uᵀSu − bᵀu with u = 0 on Γ1 and u_ν ≤ 0 at the nodes of Γ3."""
        factor, N = splu(sps.csc_array(S[self.free][:, self.free])), self.normal[:, self.free]
        Z = factor.solve(N.T.copy())
        L = np.linalg.cholesky(N @ Z)

        def solve(b: Array) -> Array:
            u = np.zeros(self.basis.N)
            loose = factor.solve(b[self.free])
            u[self.free] = loose - Z @ nnls(L.T, np.linalg.solve(L, N @ loose))[0]
            return u

        return solve

    def march(self, times: Array, theta: float) -> Array:
        """Return u at the times, (k, nodes, 2), by the θ scheme; 1: implicit Euler, ½: midpoint rule."""
        A, G = (self.form(tensor.matrix) for tensor in (self.data.law.A, self.data.law.G))
        u, solvers = [np.array(self.data.start(self.mesh[0].T)).T.ravel()], {}
        for before, after in pairwise(times):
            k = after - before
            key = round(k, 12)
            if key not in solvers:
                solvers[key] = self.contact_solver(A / k + theta * G)
            u.append(solvers[key](self.load(before + theta * k) + A @ u[-1] / k - (1 - theta) * (G @ u[-1])))
        return np.array(u).reshape(len(times), -1, 2)

    def static(self) -> Array:
        """Return u in equilibrium, (nodes, 2)."""
        return self.contact_solver(self.form(self.data.law.G.matrix))(self.load(0.0)).reshape(-1, 2)

    def at_nodes_of(self, fine: Solver, u: Array) -> Array:
        """Return u, (..., nodes, 2), at the nodes of a uniform refinement of the mesh."""
        nodes, cells = fine.mesh
        parents = np.arange(len(cells)) % len(self.mesh[1])
        X = self.basis.mapping.invF(np.moveaxis(nodes[cells], 2, 0), tind=parents)
        shapes = λ = np.array([1 - X[0] - X[1], *X])
        if self.degree == 2:
            shapes = np.concatenate([2 * λ**2 - λ, 4 * λ[[0, 1, 0]] * λ[[1, 2, 2]]])
        found = np.zeros((*u.shape[:-2], len(nodes), 2))
        found[..., cells, :] = np.einsum("icn,...cid->...cnd", shapes, u[..., self.mesh[1][parents], :])
        return found


def norms(matrix: sps.csc_array, v: Array) -> Array:
    """Return (vᵀ M v)^½ for nodal values (k, nodes, 2)."""
    flat = v.reshape(len(v), -1).T
    return np.sqrt(np.maximum((flat * (matrix @ flat)).sum(axis=0), 0.0))
