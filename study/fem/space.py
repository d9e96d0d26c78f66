"""Finite element displacements that vanish on Γ1, and the bilinear forms of the law on them.

On rollers the normal component vanishes. If a displacement is prescribed on Γ1 or on rollers, it is added by
``Displacements.coefficients``; strains and forms are those of the free part.

``Displacements`` is the common base of degree 1 (``Space``, the V^h of the paper) and degree 2 (``Quadratic``).

A displacement v is stored as the vector of its free coefficients, (dofs,): d numbers for every scalar basis function
that does not belong to Γ1. Its strains are stored at the points of a quadrature rule that integrates products of two
strains exactly. All integrals therefore follow from one sparse matrix E, which maps coefficients to strains in Mandel
form, and from the weights w of the points:

    ε(v) = E v,   (C ε(u), ε(v))_Q = uᵀ Eᵀ diag(w C) E v,   (σ, ε(v))_Q = Eᵀ(w σ)·v.

**Degree 2.** Linear constraints make piecewise quadratic displacements on triangles admissible. On a cell, v = Σ_α c_α
B_α with the Bernstein polynomials B_α of degree 2: λ_i² for every vertex i and 2 λ_a λ_b for every edge (a, b). On the
contact boundary Γ3 the normal component v_ν is then a polynomial in Bernstein form with the coefficients ν·c. If all of
them are ≤ 0, so is v_ν. These are the constraints N v ≤ 0. (Values ≤ 0 at vertices and midpoints would not suffice.)
Not every admissible quadratic displacement satisfies them.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import prod

import numpy as np
import scipy.sparse as sps
from skfem import Mesh

from manufactured.body import Body, Kind, Part
from manufactured.factor import UNIFORM, Factor
from manufactured.law import Elasticity, KelvinVoigt, PointLaw
from manufactured.tensors import Array, Points, Tensors, Vectors, basis, mandel
from study.fem.mesh import MeshedBody, barycentric, barycentric_gradients
from study.fem.mesh import size as mesh_size
from study.fem.quadrature import Line, PointsAndWeights, cell_rules, placed, simplex_rule

COMPONENT = 1e-9
"""A component of a unit normal counts as 0 up to this number."""
FACTOR_DEGREE = 6
"""Degree of the quadrature rule for the mean of a material factor α on a cell. Cells are cut where α jumps."""


class Displacements(MeshedBody, ABC):
    """Base class of finite element displacements that vanish on the clamped boundary Γ1.

    Subclasses define the numbering of the scalar basis functions (``numbers``, ``numbers_on``), the quadrature weights
    (``weights``) and the strain matrix (``E``).
    """

    @property
    @abstractmethod
    def numbers(self) -> Array:
        """The numbers of the k scalar basis functions that belong to every cell, (k, cells)."""

    @abstractmethod
    def numbers_on(self, part: Part) -> Array:
        """Return the numbers of the basis functions that do not vanish on a boundary part, including its ends, (n,)."""

    @property
    @abstractmethod
    def weights(self) -> Array:
        """The weights w of the quadrature points, (cells,) if cells have one point, otherwise (cells, points)."""

    @property
    @abstractmethod
    def E(self) -> sps.csr_array:
        """The matrix from the coefficients of a displacement to its strains, (D · cells · points, dofs).

        The rows for the first of the D Mandel components (11) at all points come first, then the rows for 22, and so
        on.
        """

    @property
    def dim(self) -> int:
        return int(self.mesh.dim())

    @cached_property
    def count(self) -> int:
        """The number of scalar basis functions, including those on Γ1."""
        return int(self.numbers.max()) + 1

    @cached_property
    def free(self) -> Array:
        """Positions of the free coefficients, the unknowns, among all d · ``count`` coefficients, (dofs,)."""
        return np.flatnonzero(~self._held[0])

    @cached_property
    def _held(self) -> tuple[Array, Array]:
        """For all d · ``count`` coefficients whether they are fixed, and the prescribed values, 0 for free ones.

        Rollers are parallel to an axis, so that they fix one of the components.
        """
        fixed = np.zeros((self.count, self.dim), dtype=bool)
        values = np.zeros((self.count, self.dim))
        for kind in (Kind.CLAMPED, Kind.ROLLER):
            for part in self.body.of(kind):
                numbers = self.numbers_on(part)
                components = abs(part.normal) > 0.5 if kind is Kind.ROLLER else np.ones(self.dim, dtype=bool)
                where = np.ix_(numbers, components)
                fixed[where] = True
                prescribed = part.prescribed(self.nodes[:, numbers])
                values[where] = prescribed[components].T
        return fixed.ravel(), values.ravel()

    @property
    def prescribed(self) -> Array:
        """The coefficients of the prescribed displacement, (d · count,).

        They are the given values on Γ1 and on rollers, and 0 for free coefficients.
        """
        return self._held[1]

    @property
    def dofs(self) -> int:
        """The number of free coefficients, which is the number of unknowns."""
        return len(self.free)

    @property
    def nodes(self) -> Points:
        """The nodes of all scalar basis functions, including those on Γ1, (d, count)."""
        return self.mesh.p

    @property
    def free_points(self) -> Points:
        """The nodes of the free basis functions, in the order of the unknowns, (d, dofs/d).

        If the body has rollers, the node of every single unknown is listed instead, (d, dofs).
        """
        every = 1 if self.body.of(Kind.ROLLER) else self.dim
        return self.nodes[:, self.free[::every] // self.dim]

    def coefficients(self, v: Array) -> Array:
        """Return all coefficients of a displacement, including the prescribed ones: (dofs,) → (count, d)."""
        full = self.prescribed.copy()
        full[self.free] = v
        return full.reshape(-1, self.dim)

    def strain(self, v: Array) -> Tensors:
        """Return the strain of a displacement at the quadrature points.

        Args:
            v: the free coefficients of a displacement, (dofs,), or of n displacements, (dofs, n).

        Returns:
            The strain in Mandel form, (D, cells) or (D, cells, points). For n displacements there is one more axis, the
            last.
        """
        return (self.E @ v).reshape(-1, *self.weights.shape, *v.shape[1:])

    def functional(self, stress: Tensors) -> Array:
        """Return the virtual work (σ, ε(v))_Q of a stress σ for every basis function v.

        Args:
            stress: σ at the quadrature points, (D, cells, points), or its cell means if cells have one point, (D,
                cells).

        Returns:
            (dofs,).
        """
        return self.tested(self.weights * stress)

    def tested(self, integrals: Tensors) -> Array:
        """Return the virtual work (σ, ε(φ_i))_Q of a stress σ for every basis function φ_i, (dofs,).

        Args:
            integrals: the integrals of the stress σ over the cells, (D, cells), or quadrature weights times σ at the
                points, (D, cells, points). For n stresses there is one more axis, the last, and the result is (dofs,
                n).
        """
        several = integrals.shape[1 + self.weights.ndim :]
        return self._transposed @ integrals.reshape(-1, *several)

    @cached_property
    def _transposed(self) -> sps.csr_array:
        """The transposed strain matrix Eᵀ, stored by rows because every load vector is a product with it."""
        return sps.csr_array(self.E.T)

    def form(self, C: Array, factor: Array | float = 1.0) -> sps.csc_array:
        """Return the matrix of the bilinear form (α C ε(u), ε(v))_Q, (dofs, dofs).

        Args:
            C: a constant tensor in Mandel form, (D, D).
            factor: the material factor α at the quadrature points, shaped like ``weights``, or a number.
        """
        weighted = sps.kron(C, sps.diags_array((self.weights * factor).ravel()), format="csr")
        matrix = sps.csc_array(self._transposed @ (weighted @ self.E))
        return sps.csc_array((matrix + matrix.T) / 2)

    @cached_property
    def contact(self) -> list[tuple[Part, Array]]:
        """The free basis functions of every contact part, as pairs of the part and their numbers, (n,).

        If a function belongs to two parts with the same normal, it is listed for the first part only. The rows of the
        constraint matrix ``N`` have the same order.
        """
        held = self._held[0].reshape(-1, self.dim)
        contact: list[tuple[Part, Array]] = []
        for part in self.body.of(Kind.CONTACT):
            fixed = np.flatnonzero(held[:, abs(part.normal) > COMPONENT].all(axis=1))
            listed = [numbers for earlier, numbers in contact if np.allclose(earlier.normal, part.normal)]
            numbers = np.setdiff1d(self.numbers_on(part), np.concatenate([fixed, *listed]))
            contact.append((part, numbers))
        return contact

    @cached_property
    def N(self) -> sps.csr_array:
        """The constraint matrix, (m, dofs): N v contains the normal displacements of v on the contact boundary.

        More precisely, N v contains the normal components of the coefficients of v. Displacements with N v ≤ 0 are
        admissible. There is one row for each pair of a contact part and a basis function. So a function on two parts
        with different normals has two constraints.
        """
        return self.normal_components(self.contact)

    def normal_components(self, on: Sequence[tuple[Part, Array]]) -> sps.csr_array:
        """Return the matrix from displacements to the normal components of some of their coefficients, (Σ n, dofs).

        Args:
            on: pairs of a boundary part, whose normal is used, and the numbers of n basis functions, (n,).
        """
        # Bodies without contact have no normal, so the shape is given.
        normals = np.array([part.normal for part, numbers in on for _ in numbers]).reshape(-1, 1, self.dim)
        columns = np.array([number for _, numbers in on for number in numbers], dtype=np.int64)
        return sps.csr_array(self._rows(normals, columns[:, None])[:, self.free])

    def _matrix(self, values: Array, numbers: Array) -> sps.csr_array:
        """Return the matrix of ``_rows`` without stored zeros and without the columns for the clamped boundary Γ1."""
        full = self._rows(values, numbers)
        full.eliminate_zeros()
        return sps.csr_array(full[:, self.free])

    def _rows(self, values: Array, numbers: Array) -> sps.csr_array:
        """Return a sparse matrix that maps all coefficients, including those on Γ1, to linear combinations of them.

        Each row combines the coefficients of k basis functions. There is a row for each entry of the leading axes
        ``...`` of the arguments.

        Args:
            values: the factors of the d components of the k coefficients of a row, (..., k, d).
            numbers: the numbers of the k basis functions, (..., k).
        """
        # A product with a sparse matrix reads as many indices as values, so 32-bit indices are used where they suffice.
        index = sps.get_index_dtype(maxval=max(values.size, self.dim * self.count))
        of_numbers = self.dim * numbers[..., None] + np.arange(self.dim)
        columns = np.broadcast_to(of_numbers, values.shape).astype(index)
        starts = np.arange(0, values.size + 1, prod(values.shape[-2:]), dtype=index)
        shape = (len(starts) - 1, self.dim * self.count)
        return sps.csr_array((values.ravel(), columns.ravel(), starts), shape=shape)


@dataclass(frozen=True, eq=False)
class Space(Displacements):
    """The space V^h of Problem 5.1: continuous, piecewise linear displacements, given by their values at the vertices.

    The admissible displacements are K^h = {v : N v ≤ 0}. Strains are constant on every cell, so integrals need only the
    cell means of stresses and of material factors. ``N`` gives the normal displacements at the contact vertices.

    Raises:
        MeshError: the mesh does not fit the parts of the body.
    """

    mesh: Mesh
    body: Body

    def __post_init__(self) -> None:
        self.parts  # refuse a mesh that does not fit before it is used  # noqa: B018

    @cached_property
    def h(self) -> float:
        """The mesh size h, see ``study.fem.mesh.size``."""
        return mesh_size(self.mesh)

    @property
    def numbers(self) -> Array:
        return self.mesh.t

    def numbers_on(self, part: Part) -> Array:
        return self.vertices(part)

    def vertices(self, part: Part) -> Array:
        """Return the numbers of the vertices on a boundary part, including its ends, (n,)."""
        return np.unique(self.mesh.facets[:, self.facets(part)])

    @property
    def weights(self) -> Array:
        return self.volumes

    @cached_property
    def E(self) -> sps.csr_array:
        """The matrix from displacements to their strains, (D · cells, dofs), with the D Mandel components of a strain.

        For the basis function φ e_j with the hat function φ and the unit vector e_j, the component I of the strain is
        E_I : sym(e_j ⊗ ∇φ), where E_I is the I-th basis tensor.
        """
        gradients = barycentric_gradients(self.mesh)
        return self._matrix(np.einsum("Ijk,cik->Icij", basis(self.dim), gradients, optimize=True), self.numbers.T)

    def scatter(self, vertices: Array, values: Vectors) -> Vectors:
        """Add up vectors of cells or facets at their vertices; the result is (d, vertices).

        Args:
            vertices: the numbers of the k vertices of each of n cells or facets, (k, n).
            values: the vector that each of them contributes to each of its vertices, (d, k, n).
        """
        return np.array([np.bincount(vertices.ravel(), component.ravel(), self.count) for component in values])

    def interpolate(self, values: Vectors) -> Array:
        """Return the free coefficients of the nodal interpolant Π^h u of a function u.

        Args:
            values: the values of u at the vertices, (d, vertices), or (d, vertices, n) for n functions.

        Returns:
            The coefficients, (dofs,), or (dofs, n) for n functions.
        """
        return np.moveaxis(values, 0, 1).reshape(-1, *values.shape[2:])[self.free]

    def nodal(self, v: Array) -> Vectors:
        """Return the values of a displacement at all vertices, also the fixed ones on Γ1: (dofs,) → (d, vertices)."""
        return self.coefficients(v).T


def means(space: Space, factor: Factor) -> Array:
    """Return the mean of a material factor α on every cell, (cells,).

    Strains of the P1 space V^h are constant on cells. So with these means the integrals (α C ε(u), ε(v))_Q are exact
    for a constant tensor C and u, v ∈ V^h.
    """
    if factor is UNIFORM:
        return np.ones(len(space.volumes))
    integrals = np.empty(len(space.volumes))
    for rule in cell_rules(space.mesh, FACTOR_DEGREE, [Line(*step) for step in factor.steps]):
        integrals[rule.cells] = np.sum(factor(rule.points) * rule.weights, axis=1)
    return integrals / space.volumes


def form(space: Space, tensor: Elasticity) -> sps.csc_array:
    """Return the matrix of the bilinear form (α C ε(u), ε(v))_Q on the P1 space V^h, (dofs, dofs).

    Args:
        space: the space V^h.
        tensor: the operator ε ↦ α C ε with the constant tensor C and the material factor α. For a nonlinear law, C is
            its constant reference tensor.
    """
    return space.form(tensor.reference, means(space, tensor.factor))


def on_cells(space: Space, law: KelvinVoigt) -> PointLaw:
    """Return the material law with the cell means of its factors, as a function from cell strains to cell stresses.

    Strains of the P1 space and their stresses are constant on the cells, (D, cells) → (D, cells).
    """
    return law.scaled(means(space, law.A.factor), means(space, law.G.factor))


EDGES = ((0, 1), (1, 2), (0, 2))
"""The two vertices of each edge of a cell, in the order in which the mesh numbers the edges."""
FACTORS = (*((i, i, 1) for i in range(3)), *((a, b, 2) for a, b in EDGES))
"""The Bernstein polynomials c λ_a λ_b of degree 2 on a triangle, each as its numbers (a, b, c).

λ_0, λ_1, λ_2 are the barycentric coordinates. First come the polynomials of the vertices, then those of the edges.
"""


def nodes_of(mesh: Mesh) -> Points:
    """Return the nodes of degree 2 of a triangular mesh: its vertices, then the midpoints of its edges, (2, count)."""
    return np.hstack([mesh.p, mesh.p[:, mesh.facets].mean(axis=1)])


def numbers_of(mesh: Mesh) -> Array:
    """Return the numbers of the six nodes of degree 2 of every cell: its 3 vertices, then its 3 edges, (6, cells)."""
    return np.vstack([mesh.t, mesh.p.shape[1] + mesh.t2f])


class Quadratic(Displacements):
    """Displacements of degree 2 on a triangular mesh, with the Bernstein polynomials as basis functions.

    Every vertex and every edge has one coefficient vector; all vertices come first.
    """

    @cached_property
    def numbers(self) -> Array:
        """The numbers of the six basis functions of every cell, for its 3 vertices and then its 3 edges, (6, cells)."""
        return numbers_of(self.mesh)

    @property
    def nodes(self) -> Points:
        """The vertices, then the midpoints of the edges, (2, count)."""
        return nodes_of(self.mesh)

    def on_edges(self, edges: Array) -> Array:
        """Return the numbers of the three basis functions on each edge, (3, n): first vertex, edge, second vertex."""
        ends = self.mesh.facets[:, edges]
        return np.vstack([ends[0], self.mesh.p.shape[1] + edges, ends[1]])

    def numbers_on(self, part: Part) -> Array:
        return np.unique(self.on_edges(self.facets(part)))

    @cached_property
    def rule(self) -> PointsAndWeights:
        """The quadrature rule on a cell: barycentric coordinates of three points, (3, 3), and weights with sum 1."""
        return simplex_rule(2, 2)

    @cached_property
    def points(self) -> Array:
        """The quadrature points, (2, cells, 3)."""
        return placed(self.mesh.p, self.mesh.t, self.rule[0])

    @cached_property
    def weights(self) -> Array:
        """The quadrature weights |T|/3 at the three points of every cell T, (cells, 3)."""
        return np.outer(self.volumes, self.rule[1])

    @cached_property
    def E(self) -> sps.csr_array:
        return self.strains(self.rule[0])

    def shapes(self, barycentric: Array) -> Array:
        """Return the six basis functions of a cell at points given by barycentric coordinates, (3, q) → (6, q)."""
        return np.array([c * barycentric[a] * barycentric[b] for a, b, c in FACTORS])

    def gradients(self, barycentric: Array, cells: Array | slice = np.s_[:]) -> Array:
        """Return the gradients of the six basis functions of each of n cells at q points, (n, q, 6, 2).

        Args:
            barycentric: the barycentric coordinates of the points, (3, n, q); (3, 1, q) if all cells have the same.
            cells: numbers of cells, (n,); by default all cells.
        """
        slopes = np.moveaxis(barycentric_gradients(self.mesh)[cells], 1, 0)[:, :, None]
        at = barycentric[..., None]
        products = [c * (at[a] * slopes[b] + at[b] * slopes[a]) for a, b, c in FACTORS]
        return np.stack(products, axis=2)

    def strains(self, barycentric: Array) -> sps.csr_array:
        """Return the matrix from a displacement to its strain at q points of every cell, (3 · cells · q, dofs).

        Args:
            barycentric: the barycentric coordinates of the points, (3, q).
        """
        gradients = self.gradients(barycentric[:, None])
        values = np.einsum("Ijk,cqik->Icqij", basis(2), gradients, optimize=True)
        return self._matrix(values, self.numbers.T[:, None])

    def strain_at(self, v: Array, cells: Array, points: Points) -> Tensors:
        """Return the strain of a displacement at q points of each of the given cells.

        Args:
            v: the coefficients of the displacement, (dofs,).
            cells: numbers of cells, (n,).
            points: points in these cells, (2, n, q).

        Returns:
            Strains in Mandel form, (3, n, q).
        """
        local = self.coefficients(v)[self.numbers[:, cells]]
        at = barycentric(self.mesh.p, self.mesh.t[:, cells], points)
        gradients = self.gradients(at, cells)
        return mandel(np.einsum("inj,nqik->jknq", local, gradients))
