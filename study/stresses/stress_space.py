"""The composite equilibrium stresses on the cells of a mesh.

On every cell, a stress is the sum of a stress with the required divergence (``lift``) and a stress with Div σ = 0
(``combined``). A stress is stored in two ways: by its values at the points of a quadrature rule, which integrates
products of two stresses exactly, and by the Bernstein coefficients of its tractions on the edges. On Γ3 and on rollers
tractions have normal and tangential components (ν, τ), elsewhere Cartesian ones.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from skfem import Mesh

from manufactured.body import Body, Kind
from manufactured.tensors import Array, Points, Tensors
from study.fem.mesh import MeshedBody, MeshError
from study.fem.quadrature import PointsAndWeights, simplex_rule
from study.stresses.composite import SIDES, CompositeElement, bernstein, composite, piola, thirds

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
        """The matrices F of the affine maps from the reference triangle to the cells, (cells, 2, 2)."""
        corners = self.mesh.p[:, self.mesh.t]
        return np.moveaxis(corners[:, 1:] - corners[:, :1], 2, 0)

    @cached_property
    def determinant(self) -> Array:
        """The determinants of F, which are negative for reflected cells, (cells,)."""
        return np.linalg.det(self.map)

    @cached_property
    def edges(self) -> Array:
        """For each of the three sides of every cell, the number of this edge in the mesh, (cells, 3)."""
        return self.mesh.t2f[list(FACETS)].T

    def edges_on(self, kind: Kind) -> Array:
        """Return the numbers of the edges on all boundary parts of a kind, which may be none, (e,)."""
        return np.concatenate([np.empty(0, dtype=np.int64), *(edges for _, edges in self.on(kind))])

    @cached_property
    def lengths(self) -> Array:
        """The lengths of the edges, (edges,)."""
        ends = self.mesh.p[:, self.mesh.facets]
        return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=0)

    @cached_property
    def frames(self) -> Array:
        """The axes of tractions on every edge, as rows: (ν, τ) on Γ3 and rollers, else Cartesian, (edges, 2, 2)."""
        axes = np.tile(np.eye(2), (self.mesh.facets.shape[1], 1, 1))
        for part, edges in (*self.on(Kind.CONTACT), *self.on(Kind.ROLLER)):
            axes[edges] = np.array([part.normal, part.tangent])
        return axes

    def boundary_tractions(self, edges: Array, tractions: Array) -> Array:
        """Return the tractions on given boundary edges with respect to the outward normal.

        Args:
            edges: numbers of boundary edges, (e,).
            tractions: tractions on the three sides of every cell, (..., cells, 3, n, 2).

        Returns:
            The tractions on the given edges, (..., e, n, 2).
        """
        on_edges = np.empty((*tractions.shape[:-4], len(self.lengths), *tractions.shape[-2:]))
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
        return np.kron(np.eye(3), at).reshape(-1, 3, at.shape[1])

    @cached_property
    def points(self) -> Points:
        """The quadrature points, (2, cells, Q)."""
        vertices = thirds(self.mesh.p[:, self.mesh.t])
        return np.einsum("dvtc,vq->dctq", vertices, self._rule[0]).reshape(2, self.cells, -1)

    @cached_property
    def barycentric(self) -> Array:
        """The barycentric coordinates, with respect to the cell, of the quadrature points of a cell, (3, Q)."""
        return np.einsum("ivt,vq->itq", thirds(np.eye(3)), self._rule[0]).reshape(3, -1)

    @cached_property
    def weights(self) -> Array:
        """The quadrature weights, (cells, Q)."""
        return np.multiply.outer(self.volumes / 3, np.tile(self._rule[1], 3))

    @cached_property
    def _reference(self) -> Array:
        """The basis of stresses with Div σ̂ = 0 at the quadrature points of the reference triangle, (3 · Q, p)."""
        values = np.einsum("qta,taJp->Jqp", self._values, self.element.divergence_free)
        return values.reshape(-1, values.shape[-1])

    def gram(self, compliance: Array) -> Array:
        """Return the inner products ∫_T C⁻¹σ·τ of any two basis functions with Div σ = 0 on every cell, (cells, p, p).

        Args:
            compliance: the inverse stiffness C⁻¹ in Mandel form, (3, 3), or at the quadrature points, (cells, Q, 3, 3).
        """
        # All cells have the same basis up to the Piola transformation, so the product of two large matrices suffices.
        piola = self._piola[:, None]
        reference = self._reference.reshape(3, self.weights.shape[1], -1)
        pulled = self.weights[..., None, None] * (piola.swapaxes(2, 3) @ compliance @ piola)
        products = np.einsum("Iqa,Jqb->qIJab", reference, reference)
        p = reference.shape[-1]
        return (pulled.reshape(self.cells, -1) @ products.reshape(-1, p * p)).reshape(-1, p, p)

    @cached_property
    def shares(self) -> Array:
        """The quadrature weights of a cell divided by its area, which are the same for all cells, (Q,)."""
        return self.weights[0] / self.volumes[0]

    def tested(self, values: Tensors) -> Array:
        """Return the integrals of a strain ε times each basis function σ with Div σ = 0 on every cell.

        Args:
            values: the strain ε at the quadrature points, (3, ..., cells, Q).

        Returns:
            The integrals ∫_T σ·ε, (..., cells, p).
        """
        pulled = (self.volumes[:, None, None] * self._piola.swapaxes(1, 2)) @ np.moveaxis(values, 0, -2)
        return pulled.reshape(*pulled.shape[:-2], -1) @ (np.tile(self.shares, 3)[:, None] * self._reference)

    def combined(self, coefficients: Array) -> Tensors:
        """Return stresses with Div σ = 0 at the quadrature points, from their coefficients in the basis.

        The shape is (..., cells, p) → (3, ..., cells, Q).
        """
        return self._pushed(coefficients @ self._reference.T)

    def _pushed(self, reference: Array) -> Tensors:
        """Transform stresses from the reference triangle to the cells: (..., cells, 3 · Q) → (3, ..., cells, Q)."""
        return np.moveaxis(self._piola @ reference.reshape(*reference.shape[:-1], 3, -1), -2, 0)

    @cached_property
    def tractions(self) -> Array:
        """The tractions on the three sides of every basis function with Div σ = 0, (cells, 3, n, 2, p)."""
        reference = np.moveaxis(np.tensordot(self.element.tractions, self.element.divergence_free, axes=3), -1, 0)
        tractions = self._to_edges(
            np.broadcast_to(reference[:, None], (len(reference), self.cells, *reference.shape[1:]))
        )
        return np.ascontiguousarray(np.moveaxis(tractions, 0, -1))

    @cached_property
    def _onto_edges(self) -> tuple[Array, Array]:
        """The transformation of tractions from the sides of the reference triangle to the edges of the mesh.

        Returns:
            The transposed matrices of |ê| σ̂ν̂ ↦ σν in the axes of the edges, (cells, 3, 2, 2); and whether the edge
            runs against the side of the cell, (cells, 3).
        """
        a, b = (self.mesh.t[[side[end] for side in SIDES]].T for end in (0, 1))
        turned = (self.mesh.facets[0, self.edges] == b) & (self.mesh.facets[1, self.edges] == a)
        # Reflected cells have inward normals on their sides, so the sign of the determinant is included.
        length = self.lengths[self.edges] * np.sign(self.determinant)[:, None]
        return (self.frames[self.edges] @ self.map[:, None] / length[..., None, None]).swapaxes(2, 3), turned

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

        Projected forces are expanded in these polynomials. The shape is (lower, q).
        """
        return bernstein(self.degree - 1, self._rule[0])

    def lift(self, coefficients: Array) -> tuple[Tensors, Array]:
        """Return a stress that balances the projected body force in every cell, Div σ + P f_0 = 0.

        Args:
            coefficients: Bernstein coefficients of P f_0, (..., cells, 3, lower, 2). Last axes: cell, subtriangle,
                Bernstein polynomial, component.

        Returns:
            The values of the stress, (3, ..., cells, Q), and the tractions on the three sides of the cells, (...,
            cells, 3, n, 2). The tractions need not be continuous across edges.
        """
        values, tractions = self._lifting
        several = coefficients.shape[:-3]
        back = (coefficients.reshape(*several, -1, 2) @ self._pulled).reshape(*several, -1)
        of_sides = (back @ tractions).reshape(*several, 3, -1, 2)
        return self._pushed(back @ values), self._to_edges(of_sides)

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
        tractions = self.element.tractions
        rows = int(np.prod(lift.shape[3:]))
        values = np.einsum("qta,taJubi->ubiJq", self._values, lift)
        on_sides = np.tensordot(lift, tractions, axes=((0, 1, 2), (3, 4, 5)))
        return values.reshape(rows, -1), on_sides.reshape(rows, -1)
