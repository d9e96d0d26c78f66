"""Norms, work of stresses and of the contact force, matrices of forms on V^h, and their extreme eigenvalues.

In 2D the quadrature rules are the same as in ``ErrorNorm``.
"""

import math
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import scipy.sparse as sps
from scipy.sparse.linalg import eigsh
from skfem import Basis, Mesh
from skfem.models.poisson import mass as scalar_mass

from manufactured.body import Part
from manufactured.contact import Face
from manufactured.exact import ExactSolution, FaceFields
from manufactured.law import KelvinVoigt
from manufactured.tensors import Array, Points, Tensors, Vectors, size
from study.fem.error_norm import CELL_DEGREE, FACET_POINTS, rules
from study.fem.quadrature import FacetRule, QuadraturePoints, rule_on
from study.fem.space import Space
from study.solve.evolution import SemiDiscrete, VectorFunction
from study.statements.shared.base import SEED

Field = Callable[[Points], Vectors]
"""The type of a displacement field, a function of points: (d, ...) → (d, ...), or (d, ..., n) for n times."""


def midpoints(T: float, count: int) -> Array:
    """Return the nodes of the composite midpoint rule on (0, T), (count,). The weight of each node is T/count."""
    return (np.arange(count) + 0.5) * T / count


def time_nodes(T: float, steps: int) -> Array:
    """Return the time nodes t_n = nT/steps, n = 0, …, steps, (steps + 1,)."""
    return T * np.arange(steps + 1) / steps


def maximum(values: Iterable[float | np.floating[Any]]) -> float:
    """Return the largest value, or NaN if one value is NaN; Python's ``max`` would ignore a NaN unless it is first."""
    return float(np.max([*values]))


def minimum(values: Iterable[float | np.floating[Any]]) -> float:
    """Return the smallest value, or NaN if one value is NaN."""
    return float(np.min([*values]))


def dual_norm(functionals: Array, riesz: VectorFunction) -> Array:
    """Return the dual norms (FᵀM⁻¹F)^{1/2} of linear functionals v ↦ F·v on the P1 space V^h, (...).

    Args:
        functionals: the values F of each functional for the basis functions, (..., dofs).
        riesz: the function b ↦ M⁻¹b, with the matrix M of (·,·)_V.
    """
    return np.sqrt(np.maximum(np.sum(functionals * riesz(functionals), axis=-1), 0.0))


class Energies:
    """Computes inner products in V and the work of stresses on strains.

    In 2D, if ``aligned`` is true, ``ErrorNorm`` integrates the load with the same quadrature points. So the stress in a
    work and the stress in the load have the same quadrature error.

    Args:
        solution: the exact solution.
        space: the P1 displacement space V^h.
        aligned: whether quadrature points are moved so that many of them have the same coordinate along a contact face,
            as for ``ErrorNorm``. Exact solutions are then evaluated faster.
        raised: a number added to the degree of the quadrature rules.

    Attributes:
        exact: the exact solution at the quadrature points; its strains have the shape (D, points).
        cells: the cell of each quadrature point, (points,).
    """

    def __init__(self, solution: ExactSolution, space: Space, aligned: bool = True, raised: int = 0) -> None:
        points = QuadraturePoints.on_cells(rules(solution, space.mesh, CELL_DEGREE + raised, aligned))
        self.space = space
        self.weights = points.weights
        self.cells = points.sums
        self.exact = solution.at(points.x)
        self._nodes = solution.at(space.mesh.p)

    def work(self, stress: Tensors, strain: Tensors) -> float:
        """Return the work (σ, ε)_Q = ∫ σ·ε of a stress on a strain, both at the quadrature points, (D, points)."""
        return float(np.sum(stress * strain * self.weights))

    def functional(self, stress: Tensors) -> Array:
        """Return the work (σ, ε(v))_Q of a stress σ for all basis functions v of the P1 space V^h, (dofs,).

        Args:
            stress: σ at the quadrature points, (D, points).
        """
        return self.space.tested(self.integrals(stress))

    def integrals(self, stress: Tensors) -> Tensors:
        """Return the integrals of a stress over each cell, from its values at the points: (D, points) → (D, cells)."""
        count = len(self.space.volumes)
        return np.array([np.bincount(self.cells, self.weights * component, count) for component in stress])

    def norm(self, strain: Tensors) -> float:
        """Return the norm (A ε, ε)_Q^{1/2} of V for a strain at the quadrature points, (D, points)."""
        return math.sqrt(self.work(self.exact.law.A(strain), strain))

    def distance(self, strain: Tensors, v: Array) -> float:
        """Return the norm (A δ, δ)_Q^{1/2} of the difference δ = ε − ε(v) of two strains.

        Args:
            strain: the strain ε at the quadrature points, (D, points).
            v: a P1 displacement, (dofs,).
        """
        return self.norm(strain - self.space.strain(v)[:, self.cells])

    def velocity_norm(self, times: Array) -> Array:
        """Return the norm ‖u̇(t)‖_V of the exact velocity at n times, (n,)."""
        return np.array([self.norm(self.exact.strain_rate(time)) for time in times.tolist()])

    def velocity_error(self, times: Array) -> Array:
        """Return the interpolation error ‖u̇(t) − Π^h u̇(t)‖_V of the exact velocity at n times, (n,)."""
        errors = []
        for time in times.tolist():
            interpolant = self.space.interpolate(self._nodes.velocity(time))
            errors.append(self.distance(self.exact.strain_rate(time), interpolant))
        return np.array(errors)


class FacePoints:
    """Quadrature points on one contact face, with the exact solution and the hat functions of all vertices there.

    Args:
        solution: the exact solution.
        space: the P1 displacement space V^h.
        face: the contact face.
        count: the number of Gauss points on a facet in 2D, and in each direction of a facet in 3D.
        rough: coordinates along the face towards which quadrature points are graded.

    Attributes:
        weights: the quadrature weights, (points,).
        normal: the outer unit normal ν.
        hats: the values of the hat functions of all vertices of the mesh at the points, (points, vertices).
        exact: the exact solution at the points.
    """

    def __init__(self, solution: ExactSolution, space: Space, face: Face, count: int, rough: tuple[float, ...]) -> None:
        rule = rule_on(space, face.part, count, rough)
        self.weights = rule.weights.ravel()
        self.normal = face.part.normal
        self.hats = hat_functions(space.mesh, rule)
        self.exact = solution.on(face, rule.s)

    def moments(self, pressure: Array) -> Array:
        """Return the integrals ∫ p φ_i over the face for the hat functions φ_i of all vertices, (vertices,).

        Args:
            pressure: the values of p at the quadrature points, (points,).
        """
        return self.hats.T @ (self.weights * pressure.ravel())


def contact_load(
    solution: ExactSolution,
    space: Space,
    rough: tuple[float, ...],
    pressure: Callable[[FaceFields, float], Array] = FaceFields.pressure,
) -> Callable[[float], Array]:
    """Return the exact contact force as a load: a function from a time to a load vector, (dofs,).

    Its entries are ∫_{Γ3} σ_ν v_ν for the basis functions v of V^h. The normal stress σ_ν is minus the exact contact
    pressure.

    Args:
        solution: the exact solution.
        space: the P1 displacement space V^h.
        rough: coordinates along the contact faces towards which quadrature points are graded.
        pressure: the function that gives the exact contact pressure on a face at a time.
    """
    faces = [FacePoints(solution, space, face, FACET_POINTS, rough) for face in solution.faces]

    def load(time: float) -> Array:
        nodal = np.zeros_like(space.mesh.p)
        for face in faces:
            nodal -= np.multiply.outer(face.normal, face.moments(pressure(face.exact, time)))
        return space.interpolate(nodal)

    return load


def displacement(solution: ExactSolution, times: Array | float) -> Field:
    """Return the exact displacement at given times as a function of points.

    The function is (d, ...) → (d, ..., n) for n times, and (d, ...) → (d, ...) for one time.

    Args:
        solution: the exact solution.
        times: n times, (n,), or one time.
    """
    return lambda x: solution.at(x).displacement(times)


def trace_error(field: Field, space: Space, part: Part, rule: FacetRule) -> tuple[Array, Array]:
    """Return the interpolation error (Π^h v)_ν − v_ν of a normal trace, and v_ν, at the points of a rule on facets.

    The shape is (n, q, ...) each, for q points on each of n facets.

    Args:
        field: the field v, a function of points, (d, points) → (d, points, ...).
        space: the P1 displacement space V^h, in which Π^h interpolates.
        part: the boundary part with the normal ν.
        rule: the quadrature rule on facets of this part.
    """
    vertices = space.mesh.p[:, space.mesh.facets[:, rule.facets]]
    trace, corners = (np.tensordot(part.normal, field(x), axes=1) for x in (part.point(rule.s), vertices))
    return np.einsum("an...,anq->nq...", corners, rule.shapes) - trace, trace


def hat_functions(mesh: Mesh, rule: FacetRule) -> sps.csr_array:
    """Return the values of the hat functions of all vertices at the points of a rule on facets, (points, vertices)."""
    vertices = np.moveaxis(np.broadcast_to(mesh.facets[:, rule.facets, None], rule.shapes.shape), 0, -1)
    ends = np.arange(0, vertices.size + 1, mesh.dim())
    shape = rule.weights.size, mesh.p.shape[1]
    return sps.csr_array((np.moveaxis(rule.shapes, 0, -1).ravel(), vertices.ravel(), ends), shape=shape)


SMALLEST_TOLERANCE, LARGEST_TOLERANCE = 1e-9, 1e-4
"""Relative tolerances for the smallest and for the largest eigenvalue.

The largest eigenvalues lie in clusters, so their eigenvectors converge slowly. A loose tolerance suffices for them,
because the error of a Rayleigh quotient is about the square of the error of the eigenvector."""
LANCZOS = 40
"""Number of Lanczos vectors with which the largest eigenvalue is computed."""


def unloaded(space: Space, law: KelvinVoigt) -> SemiDiscrete:
    """Return the semi-discrete problem (Problem 5.1) with zero load and zero initial displacement.

    Only the matrices of this problem are used.

    Args:
        space: the space V^h.
        law: the material law, which gives the matrices.
    """
    return SemiDiscrete.of(space, law, lambda times: np.zeros((space.dofs, times.size)), np.zeros(space.dofs))


def strain_product(space: Space) -> sps.csc_array:
    """Return the matrix of the L² product of strains (ε(u), ε(v))_Q on the P1 space V^h, (dofs, dofs)."""
    return space.form(np.eye(size(space.dim)))


def mass(space: Space) -> sps.csc_array:
    """Return the mass matrix, that is, the matrix of the L² product (u, v)_H on V^h, (dofs, dofs)."""
    scalar = scalar_mass.assemble(Basis(space.mesh, space.mesh.elem()))
    vector = sps.csr_array(sps.kron(scalar, np.eye(space.dim)))
    return sps.csc_array(vector[space.free][:, space.free])


def h1_product(space: Space) -> sps.csc_array:
    """Return the matrix of the inner product (2.11) on V^h, (dofs, dofs).

    It is (u, v)_{H_1} = (u, v)_H + (ε(u), ε(v))_Q.
    """
    return sps.csc_array(mass(space) + strain_product(space))


def smallest(form: sps.csc_array, product: sps.csc_array) -> float:
    """Return the smallest Rayleigh quotient a(v, v)/b(v, v) of two bilinear forms a and b over v ∈ V^h.

    Args:
        form: the matrix of a, positive definite.
        product: the matrix of b, positive definite.
    """
    return _extreme_eigenvalue(form, product, sigma=0.0, tol=SMALLEST_TOLERANCE)


def largest(form: sps.csc_array, product: sps.csc_array) -> float:
    """Return the largest Rayleigh quotient a(v, v)/b(v, v) of two bilinear forms a and b over v ∈ V^h.

    Lanczos' method is used without a shift, because a shift at a supposed bound would hide eigenvalues far beyond it.

    Args:
        form: the matrix of a.
        product: the matrix of b, positive definite.
    """
    vectors = min(LANCZOS, form.shape[0])
    return _extreme_eigenvalue(form, product, which="LA", tol=LARGEST_TOLERANCE, ncv=vectors)


def _extreme_eigenvalue(form: sps.csc_array, product: sps.csc_array, **options: Any) -> float:
    start = np.random.default_rng(SEED).standard_normal(form.shape[0])
    return float(eigsh(form, 1, product, v0=start, return_eigenvectors=False, **options)[0])
