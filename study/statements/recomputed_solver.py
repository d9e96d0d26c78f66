"""A second, simple solver of the semi-discrete contact problem (Problem 5.1), for tests of the first solver.

The module ``recomputed`` compares both. They share only the exact solution, the mesh, and the lines along which cells
are cut for quadrature. Here gradients come from inverse matrices of coordinates. Integrals are sums over the points of
a finer quadrature rule, without the faster formulas of ``study.fem``. The law is evaluated at these points: in every
iteration, or once for the matrix if it is linear. A step of the midpoint rule

    M (u_n − u_{n−1})/k + (Gε((u_n + u_{n−1})/2), ε(·))_Q + Nᵀλ_n = F(t_{n−1/2})

is solved by a fixed-point iteration for u_n, also for a linear law, with a factorisation of M by SuperLU. The iteration
first assumes that the positive multipliers are the same as in the last iteration. If this gives no solution, the method
of Lawson and Hanson is used.
"""

import math
from collections.abc import Callable

import numpy as np
import scipy.sparse as sps
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import nnls
from scipy.sparse.linalg import splu
from skfem import Mesh

from manufactured.body import Kind
from manufactured.exact import ExactSolution
from manufactured.law import Linear
from manufactured.tensors import Array, Tensors, mandel
from study.fem.error_norm import rules
from study.fem.quadrature import facet_rule

DEGREE, SOLID_DEGREE = 10, 6
"""Degrees of the quadrature rule on cells in 2D and in 3D. The first solver uses the degrees 4 and 2."""
POINTS, SOLID_POINTS = 20, 6
"""Number of Gauss points on a contact facet in 2D, and in each direction of a facet in 3D."""
SETTLED, ITERATIONS = 1e-12, 100
"""Relative change at which the fixed-point iteration of a time step stops, and its largest number of iterations."""
ON = 1e-9
"""Relative tolerance for vertices on a boundary part.

A vertex lies on the part if its distance is below this number times the largest extent of the mesh."""
Trajectory = tuple[Array, Array]
"""A discrete solution at the time nodes: displacements u_n, (N + 1, n), and contact forces λ_n, (N + 1, m)."""


class PlainProblem:
    """The semi-discrete contact problem (Problem 5.1) with P1 elements on one mesh.

    Attributes:
        free: the indices of the n unknowns among the values at all vertices, which are ordered vertex by vertex, (n,).
        M: the matrix of the viscous form (A ε(u), ε(v))_Q, (n, n).
        N: the matrix that maps v to its normal displacements v_ν at the contact vertices that are not clamped, with one
            row for each vertex and normal, (m, n).
    """

    def __init__(self, solution: ExactSolution, mesh: Mesh) -> None:
        self.solution = solution
        self.mesh = mesh
        self.dim = int(mesh.dim())
        tolerance = ON * float(np.ptp(mesh.p))
        fixed = np.any([part.contains(mesh.p, tolerance) for part in solution.body.of(Kind.CLAMPED)], axis=0)
        self.free = np.flatnonzero(np.repeat(~fixed, self.dim))
        self.numbers = np.full(fixed.size * self.dim, -1)
        self.numbers[self.free] = np.arange(self.free.size)
        on = [np.flatnonzero(face.part.contains(mesh.p, tolerance)) for face in solution.faces]
        self._set_points(on)
        self._set_forms()
        # The matrices of the contact problem: N, M⁻¹Nᵀ, Q = NM⁻¹Nᵀ and R with RᵀR = Q. A vertex on two faces with equal
        # normals has one row.
        rows: dict[tuple[int, ...], Array] = {}
        for face, vertices in zip(self.solution.faces, on, strict=True):
            normal = face.part.normal
            for vertex in vertices[~fixed[vertices]]:
                rows[(vertex, *normal.round(9))] = normal
        columns = self.numbers[self.dim * np.array([vertex for vertex, *_ in rows])[:, None] + np.arange(self.dim)]
        numbers = np.repeat(np.arange(len(rows)), self.dim)
        entries = np.ravel([*rows.values()]), (numbers, columns.ravel())
        self.N = sps.csr_array(entries, shape=(len(rows), self.free.size))
        self._response = self._solve(self.N.T.toarray())
        self._normal = self.N @ self._response
        self._root = cholesky(self._normal)

    def _set_points(self, on: list[Array]) -> None:
        """Set the quadrature points in the cells and on Γ3, with the law and the exact solution at these points.

        The attribute ``faces`` has for each contact face its normal, the matrix that maps the pressure at its points to
        nodal forces, (vertices, points), and the exact solution at the points.

        Args:
            on: for each contact face, the indices of the vertices on it.
        """
        found = rules(self.solution, self.mesh, DEGREE if self.dim == 2 else SOLID_DEGREE)
        self.cell = np.concatenate([np.repeat(rule.cells, rule.weights.shape[1]) for rule in found])
        self.weights = np.concatenate([rule.weights.ravel() for rule in found])
        within = self.cell, np.arange(self.cell.size)
        self.sums = sps.csr_array((self.weights, within), shape=(self.mesh.t.shape[1], self.cell.size))
        points = np.concatenate([rule.points.reshape(self.dim, -1) for rule in found], axis=1)
        self.law = self.solution.law.at(points)
        self.exact = self.solution.at(points)
        self.at_vertices = self.solution.at(self.mesh.p)
        self.faces = []
        boundary = self.mesh.boundary_facets()
        for face, vertices in zip(self.solution.faces, on, strict=True):
            facets = boundary[np.isin(self.mesh.facets[:, boundary], vertices).all(axis=0)]
            count = POINTS if self.dim == 2 else SOLID_POINTS
            rule = facet_rule(self.mesh, facets, face.part, face.rough, count)
            shares = rule.shapes * rule.weights
            columns = np.arange(rule.weights.size).reshape(rule.weights.shape)
            at = (
                np.broadcast_to(axis, shares.shape).ravel()
                for axis in (self.mesh.facets[:, rule.facets, None], columns)
            )
            nodal = sps.csr_array((shares.ravel(), tuple(at)), shape=(self.mesh.p.shape[1], columns.size))
            self.faces.append((face.part.normal, nodal, self.solution.on(face, rule.s)))

    def _set_forms(self) -> None:
        """Set the strains of the basis functions in each cell, and the viscous and elastic forms.

        The strains of the basis functions φ_i e_j have the shape (cells, D, (d + 1) d). The attribute ``elastic`` is
        the function v ↦ (Gε(v), ε(·))_Q, (n,) → (n,).
        """
        corners = np.moveaxis(self.mesh.p[:, self.mesh.t], -1, 0).swapaxes(1, 2)
        gradients = np.linalg.inv(np.insert(corners, 0, 1.0, axis=2))[:, 1:]
        jacobians = np.einsum("jk,cli->jlcik", np.eye(self.dim), gradients)
        self.strains = np.moveaxis(mandel(jacobians), 0, 1).reshape(len(gradients), -1, (self.dim + 1) * self.dim)
        self.local = (self.dim * self.mesh.t.T[..., None] + np.arange(self.dim)).reshape(len(gradients), -1)
        self.M = self._form(self.law.A)
        self._solve = splu(self.M, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}).solve
        if isinstance(self.solution.law.G, Linear):
            self.elastic = self._form(self.law.G).__matmul__
        else:
            self.elastic = lambda v: self.work(self.law.G(self.strain(v)))

    def _form(self, law: Callable[[Tensors], Tensors]) -> sps.csc_array:
        """Return the matrix of the form (Cε(u), ε(v))_Q for a linear law C, (n, n)."""
        columns = [self._tested(law(each[self.cell].T)) for each in np.moveaxis(self.strains, 2, 0)]
        local = np.stack(columns, axis=2)
        rows, cols = (np.broadcast_to(axis, local.shape) for axis in (self.local[..., None], self.local[:, None]))
        size = self.numbers.size
        full = sps.csc_array((local.ravel(), (rows.ravel(), cols.ravel())), shape=(size, size))
        return sps.csc_array(full[self.free][:, self.free])

    def _tested(self, stress: Tensors) -> Array:
        """Return the integrals ∫_T σ·ε(φ) for the basis functions φ of each cell T, (cells, (d + 1) d).

        Args:
            stress: σ at the quadrature points in the cells, (D, points).
        """
        means = np.array([self.sums @ row for row in stress])
        return np.einsum("Ic,cIk->ck", means, self.strains)

    def work(self, stress: Tensors) -> Array:
        """Return the work of a stress on strains as a load vector, v ↦ (σ, ε(v))_Q, (n,).

        Args:
            stress: σ at the quadrature points in the cells, (D, points).
        """
        return np.bincount(self.local.ravel(), self._tested(stress).ravel(), self.numbers.size)[self.free]

    def strain(self, v: Array) -> Tensors:
        """Return the strain ε(v) at the quadrature points in the cells, (D, points)."""
        full = np.zeros(self.numbers.size)
        full[self.free] = v
        return np.take(np.einsum("cIk,ck->Ic", self.strains, full[self.local]), self.cell, axis=1)

    def load(self, time: float) -> Array:
        """Return the load vector at one time, from the exact stress and pressure, (n,).

        It is the functional v ↦ (σ, ε(v))_Q + ∫_{Γ3} p v_ν.
        """
        load = self.work(self.exact.stress(time))
        for normal, nodal, exact in self.faces:
            load += np.multiply.outer(nodal @ exact.pressure(time).ravel(), normal).ravel()[self.free]
        return load

    def interpolant(self, time: float) -> Array:
        """Return the nodal interpolant Π^h u(t) of the exact displacement, (n,)."""
        return self.at_vertices.displacement(time).T.ravel()[self.free]

    def contact(self, b: Array, k: float, last: Array) -> tuple[Array, Array]:
        """Solve the contact problem of one time step.

        The problem is M u/k + Nᵀλ = b, N u ≤ 0, λ ≥ 0, λ·N u = 0. With Q = NM⁻¹Nᵀ, λ solves a complementarity problem
        with Qλ ≥ NM⁻¹b. First it is solved with the assumption that the same multipliers are positive as in ``last``.
        If this gives no solution, the method of Lawson and Hanson is used.

        Args:
            b: the right-hand side, (n,).
            k: the time step.
            last: multipliers of an earlier solution, (m,).

        Returns:
            The displacement u, (n,), and the multipliers λ, (m,).
        """
        free = self._solve(b)
        positive = last > 0
        multipliers = np.zeros(len(last))
        entering = self.N @ free
        multipliers[positive] = np.linalg.solve(self._normal[positive][:, positive], entering[positive])
        if not ((multipliers[positive] > 0).all() and (self._normal @ multipliers >= entering)[~positive].all()):
            multipliers, _ = nnls(self._root, solve_triangular(self._root, entering, trans="T"))
        return k * (free - self._response @ multipliers), multipliers

    def trajectory(self, steps: int, load: Callable[[float], Array]) -> Trajectory:
        """Solve by the midpoint rule from the initial value Π^h u_0.

        Args:
            steps: the number of time steps.
            load: the function t ↦ F(t), (n,).

        Returns:
            The displacements and the contact forces at the time nodes. The contact forces at t = 0 are set to 0.
        """
        k = self.solution.body.T / steps
        u = self.interpolant(0.0)
        multipliers = np.zeros(self.N.shape[0])
        guess = u
        displacements = [u]
        forces = [multipliers]
        for n in range(steps):
            before = u
            b = load((n + 0.5) * k) + self.M @ u / k
            for _ in range(ITERATIONS):
                u, multipliers = self.contact(b - self.elastic((guess + before) / 2), k, multipliers)
                if self.norm(u - guess) <= SETTLED * self.norm(u):
                    break
                guess = u
            guess = 2 * u - before
            displacements.append(u)
            forces.append(multipliers)
        return np.array(displacements), np.array(forces)

    def norm(self, v: Array) -> float:
        """Return the norm ‖v‖_V of a P1 function v, (n,)."""
        return math.sqrt(v @ (self.M @ v))

    def distance(self, time: float, *functions: Array) -> list[float]:
        """Return the distance ‖u(t) − v‖_V of the exact displacement from each of several P1 functions v."""
        missing = [self.exact.strain(time) - self.strain(v) for v in functions]
        return [math.sqrt(np.sum(self.law.A(each) * each, axis=0) @ self.weights) for each in missing]
