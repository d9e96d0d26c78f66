"""The composite equilibrium element: symmetric piecewise polynomial stresses with continuous tractions on a triangle.

The barycentre divides a triangle into three subtriangles (Alfeld split). Each of them has one side of the triangle, and
the barycentre is its third vertex. The element of degree k consists of the symmetric stresses that are polynomials of
degree k on every subtriangle and whose tractions σν are continuous across the three inner edges. Two properties make it
useful. Div maps it onto all vector fields that are polynomials of degree k − 1 on every subtriangle. And the tractions
on the three sides can be any polynomials of degree k in equilibrium with the divergence, so elements can be joined with
continuous tractions. k = 1 gives the element of Johnson and Mercier with 15 degrees of freedom, k ≥ 2 the elements of
Arnold, Douglas and Gupta.

Polynomials are written in Bernstein form, Σ c_α B_α with B_α(λ) = |α|!/α! λ^α in the barycentric coordinates λ of a
subtriangle. The restriction to an edge then needs only the coefficients of the edge, and a polynomial with coefficients
≤ 0 is ≤ 0. On another triangle x = F x̂ + b the stresses are the Piola transforms of the stresses σ̂ on the reference
triangle,

    σ = F σ̂ Fᵀ / det F,     Div σ = F Div σ̂ / det F,     |e| σν = |ê| F σ̂ν̂     (outward normals, ê ↦ e).

The transform preserves symmetry, continuity of tractions and Div σ = 0, so one reference element suffices.

Sources: C. Johnson, B. Mercier, Some equilibrium finite element methods for two-dimensional elasticity problems, Numer.
Math. 30 (1978) 103–116; D. N. Arnold, J. Douglas, C. P. Gupta, A family of higher order mixed finite element methods
for plane elasticity, Numer. Math. 45 (1984) 1–22.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import factorial, prod

import numpy as np
from scipy.linalg import null_space
from skfem import Mesh, MeshTri

from manufactured.tensors import Array, Points, basis
from study.fem.quadrature import gauss, simplex_rule

CORNERS = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
"""Vertices of the reference triangle as columns, (2, 3)."""
SIDES = ((1, 2), (2, 0), (0, 1))
"""The two vertices of each side of the reference triangle; side i is opposite to vertex i.

The vertices of subtriangle i are the two vertices of side i and the barycentre.
"""


def indices(degree: int, variables: int = 3) -> list[tuple[int, ...]]:
    """Return the multi-indices α ≥ 0 with |α| = degree, which number the Bernstein polynomials of this degree.

    They are tuples of integers, in descending lexicographic order.
    """
    if variables == 1:
        return [(degree,)]
    return [(first, *rest) for first in range(degree, -1, -1) for rest in indices(degree - first, variables - 1)]


def bernstein(degree: int, barycentric: Array) -> Array:
    """Return the values of all Bernstein polynomials of a degree at points, in the order of ``indices``.

    Args:
        degree: the degree of the polynomials.
        barycentric: barycentric coordinates of the points, (v, ...), with v = 2 on an edge and 3 on a triangle.

    Returns:
        The values, (polynomials, ...).
    """

    def polynomial(alpha: tuple[int, ...]) -> Array:
        powers = (x**a for x, a in zip(barycentric, alpha, strict=True))
        return factorial(degree) / prod(map(factorial, alpha)) * prod(powers)

    return np.array([polynomial(alpha) for alpha in indices(degree, len(barycentric))])


def interval_mass(degree: int, other: int) -> Array:
    """Return the integrals ∫_0^1 B_i B_j of the Bernstein polynomials B_i of one degree and B_j of another degree.

    The shape is (degree + 1, other + 1).
    """
    x, weights = gauss((degree + other) // 2 + 1)
    first, second = (bernstein(k, np.array([1 - x, x])) for k in (degree, other))
    return (first * weights) @ second.T


def triangle_mass(degree: int) -> Array:
    """Return the mean values on a triangle of the products of two Bernstein polynomials, (polynomials, polynomials)."""
    barycentric, weights = simplex_rule(2, 2 * degree)
    at = bernstein(degree, barycentric)
    return (at * weights) @ at.T


@dataclass(frozen=True)
class CompositeElement:
    """The composite equilibrium element of degree k ≥ 1 on the reference triangle.

    A stress is stored as the array of its Bernstein coefficients, (3, polynomials, 3). Axes: the three subtriangles,
    the Bernstein polynomials of degree k on each of them (``polynomials`` in number), and the three Mandel components.

    A vector field of degree k − 1, such as a divergence, is stored as an array (3, lower, 2). Axes: the subtriangles,
    the Bernstein polynomials of degree k − 1 (``lower`` in number), and the two components.

    The shape of a matrix lists first the axes of the result (rows) and then, after a semicolon, the axes of the
    argument (columns).
    """

    degree: int

    @property
    def polynomials(self) -> int:
        """The number of Bernstein polynomials of degree k on a subtriangle."""
        return len(indices(self.degree))

    @cached_property
    def divergence(self) -> Array:
        """The matrix from a stress to its divergence, in Bernstein form of degree k − 1.

        The shape is (3, lower, 2; 3, polynomials, 3). Row axes: subtriangle, Bernstein polynomial of degree k − 1,
        vector component. Column axes: subtriangle, Bernstein polynomial of degree k, Mandel component.

        The derivative ∂_j of Σ c_α B_α has the coefficients k Σ_i c_{β+e_i} ∂_j λ_i.
        """
        k = self.degree
        lower = indices(self.degree - 1)
        upper = indices(k)
        matrix = np.zeros((3, len(lower), 2, 3, self.polynomials, 3))
        for third, vertices in enumerate(np.moveaxis(thirds(CORNERS), 2, 0)):
            slopes = np.linalg.inv(np.vstack([np.ones(3), vertices]))[:, 1:]
            for vertex, gradient in enumerate(slopes):
                for row, beta in enumerate(lower):
                    alpha = tuple(b + (i == vertex) for i, b in enumerate(beta))
                    matrix[third, row, :, third, upper.index(alpha)] += k * np.einsum("Iij,j->iI", basis(2), gradient)
        return matrix

    def _on_edge(self, third: int, first: int, second: int, along: Array) -> Array:
        """Return the matrix from a stress to its traction |e| σν on an edge e of a subtriangle, in Bernstein form.

        Args:
            third: the number of the subtriangle.
            first, second: the numbers of the vertices of the edge within the subtriangle, from 0 to 2.
            along: the vector from the first to the second vertex, (2,).

        Returns:
            The matrix, (k + 1, 2; 3, polynomials, 3). Row axes: Bernstein coefficient, traction component. Column axes:
            subtriangle, Bernstein polynomial, Mandel component.
        """
        polynomials = indices(self.degree)
        matrix = np.zeros((self.degree + 1, 2, 3, self.polynomials, 3))
        normal = np.array([along[1], -along[0]])
        for step in range(self.degree + 1):
            alpha = [0, 0, 0]
            alpha[first], alpha[second] = self.degree - step, step
            matrix[step, :, third, polynomials.index(tuple(alpha))] = np.einsum("Iij,j->iI", basis(2), normal)
        return matrix

    @cached_property
    def jumps(self) -> Array:
        """The matrix from a stress to the jumps of its traction across the three inner edges.

        The stresses of the element are the stresses without jumps. The shape is (equations; 3, polynomials, 3). Row
        axis: all coefficients of the jumps, 3 (k + 1) · 2. Column axes: subtriangle, Bernstein polynomial, Mandel
        component.
        """
        rows = []
        for vertex in range(3):
            along = CORNERS[:, vertex] - CORNERS.mean(axis=1)
            beside = ((vertex + 1) % 3, 1.0), ((vertex + 2) % 3, -1.0)
            rows.append(sum(sign * self._on_edge(i, SIDES[i].index(vertex), 2, along) for i, sign in beside))
        return np.concatenate(rows).reshape(-1, 3, self.polynomials, 3)

    @cached_property
    def tractions(self) -> Array:
        """The matrix from stresses to their tractions |ê| σ̂ν̂ on the sides, in Bernstein form along ``SIDES``.

        The shape is (3, k + 1, 2; 3, polynomials, 3). Row axes: side, Bernstein coefficient, traction component. Column
        axes: subtriangle, Bernstein polynomial, Mandel component.
        """
        return np.array([self._on_edge(i, 0, 1, CORNERS[:, b] - CORNERS[:, a]) for i, (a, b) in enumerate(SIDES)])

    @cached_property
    def space(self) -> Array:
        """A basis of the stresses of the element, with orthonormal coefficient vectors.

        The shape is (3, polynomials, 3; dimension). Row axes: subtriangle, Bernstein polynomial, Mandel component.
        Column axis: number of the basis stress.
        """
        return self._without(self.jumps)

    @cached_property
    def divergence_free(self) -> Array:
        """A basis of the stresses of the element with Div σ̂ = 0, with orthonormal coefficient vectors.

        The shape is (3, polynomials, 3; dimension). Row axes: subtriangle, Bernstein polynomial, Mandel component.
        Column axis: number of the basis stress.
        """
        return self._without(np.concatenate([self.jumps, self.divergence.reshape(-1, *self.jumps.shape[1:])]))

    def _without(self, defects: Array) -> Array:
        """Return a basis of the stresses for which all given defects, (defects; 3, polynomials, 3), are zero."""
        return null_space(defects.reshape(len(defects), -1)).reshape(3, self.polynomials, 3, -1)

    @cached_property
    def lift(self) -> Array:
        """The matrix from a divergence to the stress of the element with this divergence and the least coefficients.

        Least means the least Euclidean norm. The shape is (3, polynomials, 3; 3, lower, 2). Row axes: subtriangle,
        Bernstein polynomial of degree k, Mandel component. Column axes: subtriangle, Bernstein polynomial of degree
        k − 1, vector component.
        """
        space = self.space.reshape(-1, self.space.shape[-1])
        inverse = space @ np.linalg.pinv(self.divergence.reshape(-1, len(space)) @ space)
        return inverse.reshape(*self.space.shape[:-1], *self.divergence.shape[:3])


@lru_cache
def composite(degree: int) -> CompositeElement:
    """Return the composite equilibrium element of a degree, which is made once for each degree.

    Raises:
        ValueError: degree < 1.
    """
    if degree < 1:
        raise ValueError(f"a composite element needs a degree of 1 or more, got {degree}")
    return CompositeElement(degree)


def piola(F: Array) -> Array:
    """Return the matrices of the Piola transformations σ̂ ↦ F σ̂ Fᵀ / det F, (cells, 2, 2) → (cells, 3, 3)."""
    E = basis(2)
    pushed = np.einsum("cij,Jjk,clk->cJil", F, E, F) / np.linalg.det(F)[:, None, None, None]
    return np.einsum("Iil,cJil->cIJ", E, pushed)


def thirds(corners: Points) -> Points:
    """Return the vertices of the three subtriangles into which the barycentre divides each of several triangles.

    The shape is (2, 3, ...) → (2, 3, 3, ...). Axes of the argument: coordinate, vertex. Axes of the result: coordinate,
    vertex, subtriangle.
    """
    centre = corners.mean(axis=1)
    return np.stack([np.stack([corners[:, a], corners[:, b], centre], axis=1) for a, b in SIDES], axis=2)


def alfeld_split(mesh: Mesh) -> tuple[Mesh, Points]:
    """Divide every cell of a mesh into three subtriangles, each with one side of the cell and the barycentre.

    Returns:
        The mesh of all subtriangles, three consecutive ones for each cell; and the coordinates of their vertices,
        (2, 3, 3 · cells). Axes: coordinate, vertex, subtriangle.
    """
    vertices = np.vstack([mesh.t, mesh.p.shape[1] + np.arange(mesh.t.shape[1])])
    cells = np.stack([vertices[[a, b, 3]] for a, b in SIDES], axis=2).reshape(3, -1)
    points = np.hstack([mesh.p, mesh.p[:, mesh.t].mean(axis=1)])
    return MeshTri(points, np.ascontiguousarray(cells)), points[:, cells]


def barycentric(corners: Points, x: Points) -> Array:
    """Return the barycentric coordinates of q points in each of n triangles.

    Args:
        corners: the vertices of the triangles, (2, 3, n).
        x: the points, (2, n, q).

    Returns:
        The barycentric coordinates, (3, n, q).
    """
    edges = np.moveaxis(corners[:, :2] - corners[:, 2:], 2, 0)
    first = np.einsum("nvd,dnq->vnq", np.linalg.inv(edges), x - corners[:, 2][..., None])
    return np.concatenate([first, 1 - first.sum(axis=0, keepdims=True)])
