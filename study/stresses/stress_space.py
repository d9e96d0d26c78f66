"""The composite equilibrium stresses on the cells of a mesh.

On every cell, a stress is the sum of a stress with the required divergence (``lift``) and a stress with Div σ = 0
(``combined``). A stress is stored in two ways: by its values at the points of a quadrature rule, which integrates
products of two stresses exactly, and by the Bernstein coefficients of its tractions on the edges. On Γ3 and on rollers
tractions have normal and tangential components (ν, τ), elsewhere Cartesian ones.

**The composite equilibrium element** consists of symmetric piecewise polynomial stresses with continuous tractions. The
barycentre divides a triangle into three subtriangles (Alfeld split). Each of them has one side of the triangle, and the
barycentre is its third vertex. The element of degree k consists of the symmetric stresses that are polynomials of
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

import numpy as np
from scipy.linalg import null_space
from skfem import Mesh

from manufactured.body import Body, Kind
from manufactured.tensors import Array, Points, Tensors, basis
from study.fem.mesh import MeshedBody, MeshError, affine_maps, facet_measures, simplicial_mesh
from study.fem.quadrature import PointsAndWeights, bernstein, gauss, indices, simplex_rule

REFERENCE_CORNERS = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
"""Vertices of the reference triangle as columns, (2, 3)."""
SIDES = ((1, 2), (2, 0), (0, 1))
"""The two vertices of each side of the reference triangle; side i is opposite to vertex i.

The vertices of subtriangle i are the two vertices of side i and the barycentre.
"""


def interval_mass(degree: int, other: int) -> Array:
    """Return the integrals ∫_0^1 B_i B_j of the Bernstein polynomials B_i of one degree and B_j of another degree.

    Args:
        degree, other: the degrees of the B_i and of the B_j.

    Returns:
        The integrals, (degree + 1, other + 1).
    """
    x, weights = gauss((degree + other) // 2 + 1)
    barycentric = np.array([1 - x, x])
    return (bernstein(degree, barycentric) * weights) @ bernstein(other, barycentric).T


def triangle_mass(degree: int) -> Array:
    """Return the mean values on a triangle of the products of any two Bernstein polynomials of a degree.

    The shape is (polynomials, polynomials).
    """
    barycentric, weights = simplex_rule(2, 2 * degree)
    at = bernstein(degree, barycentric)
    return (at * weights) @ at.T


@dataclass(frozen=True)
class CompositeElement:
    """The composite equilibrium element of degree k ≥ 1 on the reference triangle, a finite element for stresses.

    The barycentre divides the triangle into three subtriangles. A stress is a polynomial of degree k on each of them,
    with continuous tractions. It is stored as the array of its Bernstein coefficients, (3, polynomials, 3). Axes: the
    subtriangles, the Bernstein polynomials of degree k on each of them (``polynomials`` in number), and the three
    Mandel components.

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

        The derivative ∂_j of Σ c_α B_α has the Bernstein coefficients k Σ_i c_{β+e_i} ∂_j λ_i, for multi-indices |β| =
        k − 1 and barycentric coordinates λ_i.
        """
        k = self.degree
        lower = indices(k - 1)
        upper = indices(k)
        matrix = np.zeros((3, len(lower), 2, 3, self.polynomials, 3))
        for third, vertices in enumerate(np.moveaxis(thirds(REFERENCE_CORNERS), 2, 0)):
            inverse = np.linalg.inv(np.vstack([np.ones(3), vertices]))
            for vertex, gradient in enumerate(inverse[:, 1:]):
                of_tensors = k * (basis(2) @ gradient).T
                for row, beta in enumerate(lower):
                    alpha = tuple(b + (i == vertex) for i, b in enumerate(beta))
                    matrix[third, row, :, third, upper.index(alpha)] += of_tensors
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
        traction = (basis(2) @ normal).T
        for row, ends in enumerate(indices(self.degree, 2)):
            alpha = [0, 0, 0]
            alpha[first], alpha[second] = ends
            matrix[row, :, third, polynomials.index(tuple(alpha))] = traction
        return matrix

    @cached_property
    def jumps(self) -> Array:
        """The matrix from a stress to the jumps of its traction across the three edges between the subtriangles.

        The stresses of the element are the ones without jumps. The shape is (equations; 3, polynomials, 3). Row axis:
        all coefficients of the jumps, 3 (k + 1) · 2. Column axes: subtriangle, Bernstein polynomial, Mandel component.
        """
        jumps = []
        for vertex, corner in enumerate(REFERENCE_CORNERS.T):
            along = corner - REFERENCE_CORNERS.mean(axis=1)
            sides = (vertex + 1) % 3, (vertex + 2) % 3
            left, right = (self._on_edge(i, SIDES[i].index(vertex), 2, along) for i in sides)
            jumps.append(left - right)
        return np.concatenate(jumps).reshape(-1, 3, self.polynomials, 3)

    @cached_property
    def tractions(self) -> Array:
        """The matrix from stresses σ̂ to their tractions on the sides ê of the triangle, times the length, |ê| σ̂ν̂.

        ν̂ is the outward normal. Tractions are in Bernstein form along ``SIDES``. The shape is (3, k + 1, 2; 3,
        polynomials, 3). Row axes: side, Bernstein coefficient, traction component. Column axes: subtriangle, Bernstein
        polynomial, Mandel component.
        """
        tractions = []
        for side, (a, b) in enumerate(SIDES):
            along = REFERENCE_CORNERS[:, b] - REFERENCE_CORNERS[:, a]
            tractions.append(self._on_edge(side, 0, 1, along))
        return np.array(tractions)

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
        divergence = self.divergence.reshape(-1, *self.jumps.shape[1:])
        return self._without(np.concatenate([self.jumps, divergence]))

    def _without(self, defects: Array) -> Array:
        """Return a basis of the stresses for which all given defects, (defects; 3, polynomials, 3), are zero."""
        stresses = null_space(defects.reshape(len(defects), -1))
        return stresses.reshape(*defects.shape[1:], -1)

    @cached_property
    def lift(self) -> Array:
        """The matrix from a vector field to the stress with this divergence and the least coefficients.

        Least means the least Euclidean norm. The shape is (3, polynomials, 3; 3, lower, 2). Row axes: subtriangle,
        Bernstein polynomial of degree k, Mandel component. Column axes: subtriangle, Bernstein polynomial of degree k −
        1, vector component.
        """
        divergence = np.tensordot(self.divergence, self.space, axes=3)
        inverse = np.linalg.pinv(divergence.reshape(-1, divergence.shape[-1]))
        return np.tensordot(self.space, inverse.reshape(-1, *divergence.shape[:3]), axes=1)


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
    """Return the matrices of the Piola transformations of stresses, (cells, 2, 2) → (cells, 3, 3).

    The transformation σ̂ ↦ F σ̂ Fᵀ / det F maps stresses from the reference triangle to a cell.

    Args:
        F: the matrices of the affine maps from the reference triangle to the cells.
    """
    E = basis(2)
    determinants = np.linalg.det(F)[:, None, None, None]
    pushed = np.einsum("cij,Jjk,clk->cJil", F, E, F) / determinants
    return np.einsum("Iil,cJil->cIJ", E, pushed)


def thirds(corners: Points) -> Points:
    """Return the vertices of the three subtriangles into which the barycentre divides each of several triangles.

    The shape is (2, 3, ...) → (2, 3, 3, ...). Axes of the argument: coordinate, vertex. Axes of the result: coordinate,
    vertex, subtriangle.
    """
    centre = corners.mean(axis=1, keepdims=True)
    vertices = np.concatenate([corners, centre], axis=1)
    return np.stack([vertices[:, [*side, 3]] for side in SIDES], axis=2)


def alfeld_split(mesh: Mesh) -> tuple[Mesh, Array]:
    """Divide every cell of a mesh into three subtriangles, each with one side of the cell and the barycentre.

    Returns:
        The mesh of all subtriangles, three consecutive ones for each cell, which sorts the vertices of its cells; and
        the numbers of the vertices of every subtriangle in the order of ``thirds``, (3, 3 · cells).
    """
    centres = mesh.p[:, mesh.t].mean(axis=1)
    numbers = mesh.p.shape[1] + np.arange(mesh.t.shape[1])
    vertices = np.vstack([mesh.t, numbers])
    cells = np.stack([vertices[[*side, 3]] for side in SIDES], axis=2).reshape(3, -1)
    return simplicial_mesh(np.hstack([mesh.p, centres]), cells), cells


LEAST_DEGREE = 4
"""Least degree of the quadrature rule on the subtriangles of a cell.

Errors of linear stresses are quadratic, so their squares are of degree 4.
"""
FACETS = (1, 2, 0)
"""For each side i of a cell, which is opposite to vertex i, the number of the facet in the mesh.

In the mesh, facet i of a cell joins its vertices i and i + 1 modulo 3.
"""


@dataclass(frozen=True, eq=False)
class StressSpace(MeshedBody):
    """Composite stresses of degree k on the cells x = F x̂ + b of a triangular mesh, x̂ in the reference triangle.

    Every cell is divided by its barycentre into three subtriangles. Letters in shapes: Q is the number of quadrature
    points in a cell (all three subtriangles together), p the number of basis functions with Div σ = 0 in a cell,
    n = k + 1 the number of Bernstein polynomials on an edge, ``polynomials`` and ``lower`` the numbers of Bernstein
    polynomials of degree k and k − 1 on a subtriangle.

    Raises:
        MeshError: the mesh does not consist of triangles, or does not fit the parts of the body.
    """

    mesh: Mesh
    body: Body
    degree: int = 1

    def __post_init__(self) -> None:
        if self.mesh.dim() != 2:
            raise MeshError(
                f"composite stresses are made for triangles, got a mesh of dimension {self.mesh.dim()}; take a 2D body"
            )
        self.parts  # refuse a mesh that does not fit before it is used  # noqa: B018

    @cached_property
    def map(self) -> Array:
        """The matrices F of the affine maps x = F x̂ + b from the reference triangle to the cells, (cells, 2, 2)."""
        return affine_maps(self.mesh.p, self.mesh.t)

    @cached_property
    def determinant(self) -> Array:
        """The determinants of the matrices F of the maps to the cells, negative for reflected cells, (cells,)."""
        return np.linalg.det(self.map)

    @cached_property
    def edges(self) -> Array:
        """For each of the three sides of every cell, the number of this edge in the mesh, (cells, 3)."""
        return self.mesh.t2f[list(FACETS)].T

    def edges_on(self, kind: Kind) -> Array:
        """Return the numbers of the edges on all boundary parts of one kind, such as ``Kind.CONTACT``, (e,).

        The array is empty if the body has no such part.
        """
        return np.concatenate([np.empty(0, dtype=np.int64), *(edges for _, edges in self.on(kind))])

    @cached_property
    def lengths(self) -> Array:
        """The lengths of the edges, (edges,)."""
        return facet_measures(self.mesh, np.s_[:])

    @cached_property
    def frames(self) -> Array:
        """The axes in which tractions on every edge are given, as rows, (edges, 2, 2).

        They are the normal and the tangent on the contact boundary and on rollers, and the Cartesian axes on all other
        edges.
        """
        axes = np.tile(np.eye(2), (len(self.lengths), 1, 1))
        for part, edges in (*self.on(Kind.CONTACT), *self.on(Kind.ROLLER)):
            axes[edges] = np.array([part.normal, part.tangent])
        return axes

    def boundary_tractions(self, edges: Array, tractions: Array) -> Array:
        """Return the tractions on given boundary edges with respect to the outward normal.

        Args:
            edges: numbers of boundary edges, (e,).
            tractions: Bernstein coefficients of tractions on the three sides of every cell, (..., cells, 3, n, 2). Last
                axes: cell, side, coefficient, component.

        Returns:
            The coefficients of the tractions on the given edges, (..., e, n, 2).
        """
        *several, _, _, n, d = tractions.shape
        on_edges = np.empty((*several, len(self.lengths), n, d))
        on_edges[..., self.edges, :, :] = tractions
        return on_edges[..., edges, :, :]

    @property
    def element(self) -> CompositeElement:
        return composite(self.degree)

    @cached_property
    def _piola(self) -> Array:
        """The Piola transformation from the reference triangle to every cell, in Mandel form, (cells, 3, 3)."""
        return piola(self.map)

    @cached_property
    def _rule(self) -> PointsAndWeights:
        """The quadrature rule on a subtriangle of a cell.

        Returns:
            The barycentric coordinates of the q points, (3, q), and the weights, which sum to 1, (q,).
        """
        return simplex_rule(2, max(LEAST_DEGREE, 2 * self.degree))

    @cached_property
    def _values(self) -> Array:
        """The matrix from Bernstein coefficients of a function to its values at the quadrature points of a cell.

        The shape is (Q, 3, polynomials). Axes: quadrature point, subtriangle, Bernstein polynomial.
        """
        at = bernstein(self.degree, self._rule[0]).T
        return np.kron(np.eye(3), at).reshape(-1, 3, self.element.polynomials)

    @cached_property
    def points(self) -> Points:
        """The quadrature points, (2, cells, Q), with Q points in the three subtriangles of every cell."""
        vertices = thirds(self.mesh.p[:, self.mesh.t])
        points = np.einsum("dvtc,vq->dctq", vertices, self._rule[0])
        return points.reshape(2, self.cells, -1)

    @cached_property
    def barycentric(self) -> Array:
        """The barycentric coordinates of the Q quadrature points of a cell with respect to the cell, (3, Q)."""
        coordinates = np.einsum("ivt,vq->itq", thirds(np.eye(3)), self._rule[0])
        return coordinates.reshape(3, -1)

    @cached_property
    def weights(self) -> Array:
        """The quadrature weights, (cells, Q), with Q points in every cell."""
        return np.multiply.outer(self.volumes, self.shares)

    @cached_property
    def _reference(self) -> Array:
        """The basis of stresses with Div σ̂ = 0 at the quadrature points of the reference triangle, (3 · Q, p)."""
        values = np.einsum("qta,taJp->Jqp", self._values, self.element.divergence_free)
        return values.reshape(-1, values.shape[-1])

    def gram(self, compliance: Array) -> Array:
        """Return the inner products ∫_T C⁻¹σ·τ of any two of the p basis functions with Div σ = 0, (cells, p, p).

        Args:
            compliance: the inverse stiffness C⁻¹ in Mandel form, (3, 3), or at the Q quadrature points of every cell T,
                (cells, Q, 3, 3).
        """
        # All cells have the same basis up to the Piola transformation, so the product of two large matrices suffices.
        piola = self._piola[:, None]
        reference = self._reference.reshape(3, self.weights.shape[1], -1)
        metric = piola.swapaxes(2, 3) @ compliance @ piola
        pulled = self.weights[..., None, None] * metric
        products = np.einsum("Iqa,Jqb->qIJab", reference, reference)
        p = reference.shape[-1]
        gram = pulled.reshape(self.cells, -1) @ products.reshape(-1, p * p)
        return gram.reshape(-1, p, p)

    @cached_property
    def shares(self) -> Array:
        """The quadrature weights of a cell divided by its area, (Q,). They are the same for all cells."""
        return np.tile(self._rule[1], 3) / 3

    def tested(self, values: Tensors) -> Array:
        """Return the integrals of a strain ε times each basis function σ with Div σ = 0 on every cell.

        Args:
            values: the strain ε at the quadrature points, (3, ..., cells, Q).

        Returns:
            The integrals ∫_T σ·ε for the p basis functions σ on every cell T, (..., cells, p).
        """
        onto_reference = self.volumes[:, None, None] * self._piola.swapaxes(1, 2)
        pulled = onto_reference @ np.moveaxis(values, 0, -2)
        weighted = np.tile(self.shares, 3)[:, None] * self._reference
        return pulled.reshape(*pulled.shape[:-2], -1) @ weighted

    def combined(self, coefficients: Array) -> Tensors:
        """Return stresses with Div σ = 0 at the quadrature points, from their coefficients in the basis.

        The shape is (..., cells, p) → (3, ..., cells, Q), with p basis functions and Q quadrature points in every cell.
        """
        return self._pushed(coefficients @ self._reference.T)

    def _pushed(self, reference: Array) -> Tensors:
        """Transform stresses from the reference triangle to the cells: (..., cells, 3 · Q) → (3, ..., cells, Q)."""
        components = reference.reshape(*reference.shape[:-1], 3, -1)
        return np.moveaxis(self._piola @ components, -2, 0)

    @cached_property
    def tractions(self) -> Array:
        """The tractions on the three sides of the cell of every basis function with Div σ = 0, (cells, 3, n, 2, p).

        Axes: cell, side, Bernstein coefficient, component, basis function.
        """
        on_reference = np.tensordot(self.element.tractions, self.element.divergence_free, axes=3)
        tractions = self._to_edges(np.moveaxis(on_reference, -1, 0)[:, None])
        return np.ascontiguousarray(np.moveaxis(tractions, 0, -1))

    @cached_property
    def _onto_edges(self) -> tuple[Array, Array]:
        """The transformation of tractions from the sides of the reference triangle to the edges of the mesh.

        Returns:
            The transposed matrices of |ê| σ̂ν̂ ↦ σν in the axes of the edges, (cells, 3, 2, 2); and whether the edge
            runs against the side of the cell, (cells, 3).
        """
        end_of_side = self.mesh.t[[b for _, b in SIDES]].T
        turned = self.mesh.facets[0, self.edges] == end_of_side
        # Reflected cells have inward normals on their sides, so the sign of the determinant is included.
        length = self.lengths[self.edges] * np.sign(self.determinant)[:, None]
        pushed = self.frames[self.edges] @ self.map[:, None]
        onto = pushed / length[..., None, None]
        return onto.swapaxes(2, 3), turned

    def _to_edges(self, reference: Array) -> Array:
        """Transform tractions |ê| σ̂ν̂ on the sides of the reference triangle to tractions σν on the edges.

        Both have the shape (..., cells, 3, n, 2).
        """
        onto, turned = self._onto_edges
        pushed: Array = reference @ onto
        pushed[..., turned, :, :] = pushed[..., turned, ::-1, :]
        return pushed

    def coefficients(self, values: Tensors) -> Array:
        """Return the Bernstein coefficients of stresses from their values at the quadrature points, (3, cells, Q).

        The result has the shape (3, 3 · cells, polynomials). Axes: Mandel component, subtriangle (three consecutive
        ones for each cell), Bernstein polynomial.
        """
        inverse = np.linalg.pinv(bernstein(self.degree, self._rule[0]))
        return values.reshape(3, 3 * self.cells, -1) @ inverse

    @cached_property
    def force_shapes(self) -> Array:
        """The values of the Bernstein polynomials of degree k − 1 at the q quadrature points of a subtriangle.

        Body forces that the stresses of degree k can balance are expanded in these polynomials. The shape is (lower,
        q).
        """
        return bernstein(self.degree - 1, self._rule[0])

    def lift(self, coefficients: Array) -> tuple[Tensors, Array]:
        """Return a stress σ that balances a piecewise polynomial body force P f_0 in every cell, Div σ + P f_0 = 0.

        Args:
            coefficients: Bernstein coefficients of P f_0, (..., cells, 3, lower, 2). Last axes: cell, subtriangle,
                Bernstein polynomial, component.

        Returns:
            The values of the stress, (3, ..., cells, Q), and the tractions on the three sides of the cells, (...,
            cells, 3, n, 2). The tractions need not be continuous across edges.
        """
        values, tractions = self._lifting
        several = coefficients.shape[:-3]
        divergence = coefficients.reshape(*several, -1, 2) @ self._pulled
        divergence = divergence.reshape(*several, -1)
        on_sides = (divergence @ tractions).reshape(*several, 3, -1, 2)
        return self._pushed(divergence @ values), self._to_edges(on_sides)

    @cached_property
    def _pulled(self) -> Array:
        """The transposed matrices −det F F⁻¹ from P f_0 to the divergence on the reference triangle, (cells, 2, 2)."""
        return -self.determinant[:, None, None] * np.linalg.inv(self.map).swapaxes(1, 2)

    @cached_property
    def _lifting(self) -> tuple[Array, Array]:
        """The stresses on the reference triangle that have a given divergence, for every coefficient of the divergence.

        Returns:
            The values of the stresses at the quadrature points, (3 · lower · 2, 3 · Q), and their tractions on the
            sides, (3 · lower · 2, 3 · n · 2). Row order, the same for both: subtriangle (3), Bernstein polynomial
            (lower), component (2). Column order of the values: Mandel component (3), quadrature point (Q). Column order
            of the tractions: side (3), Bernstein polynomial (n), component (2).
        """
        lift = self.element.lift
        lift = lift.reshape(*lift.shape[:3], -1)
        values = np.einsum("qta,taJr->rJq", self._values, lift)
        on_sides = np.tensordot(self.element.tractions, lift, axes=3)
        rows = len(values)
        return values.reshape(rows, -1), on_sides.reshape(-1, rows).T
