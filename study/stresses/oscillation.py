"""Data oscillation: a bound of the work of the loads that the projection P leaves out, f_0 − P f_0 and f_2 − P f_2.

**The inequality.** Let g ∈ L²(T)² be orthogonal to P_q(T)², the polynomials of degree q ≥ 1 on a triangle T, which
include the rigid motions. By Korn's inequality there is a smallest constant C_{T,q} with

    ∫_T g·v ≤ C_{T,q} ‖g‖_T ‖ε(v)‖_{A,T}   for all v ∈ H¹(T)².

For fixed shape and A the constant is proportional to the size of T.

**How the constant is bounded.** Divide T into four similar triangles T' of half the size, and let P' be the projection
onto P_q(T')² on each of them. P'g is still orthogonal to the rigid motions of T. So it is balanced by stresses τ with
τν = 0 on ∂T, and ∫ P'g·v = (τ, ε(v)). The smallest ‖τ‖_{A⁻¹} over composite stresses is at most √λ ‖P'g‖, where λ is an
eigenvalue of a small matrix. The rest g − P'g is orthogonal to every P_q(T')², and its constant is C_{T,q}/2. Hence

    C_{T,q}² ≤ λ + C_{T,q}²/4,   that is   C_{T,q}² ≤ 4λ/3.

The same argument holds for a load on one side e of T that is orthogonal to P1(e)². There T' are the halves of e, and
the constant grows like the square root of the size:  C_e² ≤ λ_e + C_e²/2,  that is  C_e² ≤ 2 λ_e.

**The eigenvalue.** λ is the smallest number with min ‖τ‖²_{A⁻¹} ≤ λ ‖load‖² for all loads. The loads are piecewise
polynomials on the divided triangle that are orthogonal to the polynomials of the whole triangle. The stresses τ are
composite stresses on the divided triangle with no other tractions on its boundary. λ is computed in floating point,
without an interval enclosure. No constant from the literature is used.

**The divided triangle.** The midpoints of its sides divide the reference triangle into four triangles, here called
children: child i < 3 is x = (x̂ + v_i)/2, the middle child is x = (v_0 + v_1 + v_2 − x̂)/2. With F = ±1/2 the Piola
transformation keeps coefficients, turns Div into ±2 Div and |ê| σν into ±1/2 |ê| σν.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.linalg import null_space

from manufactured.body import Kind
from manufactured.tensors import Array
from study.fem.quadrature import bernstein, indices, simplex_rule
from study.stresses.loads import LeftOut
from study.stresses.stress_space import (
    REFERENCE_CORNERS,
    SIDES,
    StressSpace,
    composite,
    interval_mass,
    piola,
    thirds,
    triangle_mass,
)

CELLS_AT_A_TIME = 256
"""Number of cells for which ``cell_constants`` are computed at a time, which limits the memory."""
CHILDREN = np.stack([*((np.eye(3) + vertex) / 2 for vertex in np.eye(3)), (1 - np.eye(3)) / 2])
"""The vertices of the four similar triangles of half the size into which a triangle is divided, (4, 3 vertices, 3).

They are given in barycentric coordinates of the triangle.
"""
DEPENDENT = 1e-9
"""Linear equations count as dependent if a singular value is below this fraction of the largest one."""


class DividedTriangle:
    """Matrices for stresses of degree k on the reference triangle, divided into four similar triangles.

    The four triangles of half the size are called children. On each child the stresses are composite stresses:
    polynomials of degree k on the three subtriangles into which its barycentre divides the child. The unknowns are the
    coefficients of the stresses on all children in the basis of ``CompositeElement``. Tractions may jump between
    children.

    Attributes:
        inner: the matrix from unknowns to the jumps of tractions across the three sides of the middle child,
            (equations, unknowns). The jumps are 0 if tractions are continuous.
        outer: the matrix from unknowns to the tractions |ê| σν on the boundary of the reference triangle, (3, 2 · (k +
            1) · 2, unknowns). The first axis is the side. Row order: half of the side (2), Bernstein coefficient (k +
            1), component (2). |ê| is the length of the half.
        divergence: the matrix from unknowns to the Bernstein coefficients of the divergence, (4 · 3 · coefficients · 2,
            unknowns). Row order: child (4), subtriangle (3), Bernstein polynomial of degree k − 1, component (2).
        values: the matrix from unknowns to the values of the stress in Mandel form at the points of a quadrature rule,
            (points, 3, unknowns).
        weights: the weights of the quadrature rule, (points,).
    """

    def __init__(self, degree: int) -> None:
        element = composite(degree)
        size = element.space.shape[-1]
        of_child = np.tensordot(element.tractions, element.space, axes=3) / 2
        jumps = np.zeros((*of_child.shape[:3], 4, size))
        outer = np.zeros((3, 2, degree + 1, 2, 4, size))
        for side, traction in enumerate(of_child):
            # The second traction is reversed, because the two children run through their common side in opposite
            # directions.
            jumps[side, :, :, side] = traction
            jumps[side, :, :, 3] = -traction[::-1]
            for half, child in enumerate(SIDES[side]):
                outer[side, half, :, :, child] = traction
        self.inner = jumps.reshape(-1, 4 * size)
        self.outer = outer.reshape(3, -1, 4 * size)
        divergence = np.tensordot(element.divergence, element.space, axes=3).reshape(-1, size)
        self.divergence = np.kron(np.diag([2.0, 2.0, 2.0, -2.0]), divergence)
        barycentric, weights = simplex_rule(2, 2 * degree)
        at_points = np.einsum("aq,taJp->tqJp", bernstein(degree, barycentric), element.space)
        values = np.einsum("cd,tqJp->ctqJdp", np.eye(4), at_points)
        self.values = values.reshape(-1, 3, 4 * size)
        self.weights = np.tile(weights / 24, 12)


def restriction(degree: int, corners: Array) -> Array:
    """Return the matrix that restricts a polynomial on a triangle to a smaller triangle in it.

    Args:
        degree: the degree of the polynomial.
        corners: barycentric coordinates of the vertices of the smaller triangle in the larger one, one row for each
            vertex, (3, 3).

    Returns:
        The matrix from Bernstein coefficients on the triangle to Bernstein coefficients on the smaller triangle,
        (polynomials, polynomials).
    """
    at = np.array(indices(degree)).T / degree
    inside = bernstein(degree, corners.T @ at)
    return np.linalg.solve(bernstein(degree, at).T, inside.T)


@dataclass(frozen=True, eq=False)
class BalancingStresses:
    """Stresses on the divided reference triangle that balance any of the loads in a space of dimension r.

    The first p of the stresses are a basis of those that balance the load 0. They are followed by one stress for each
    load of a basis of the loads.

    Attributes:
        p: the number p.
        products: the integrals ∫ σ_I σ'_J of the Mandel components of any two stresses σ, σ', (3, 3, p + r, p + r).
        gram: the integrals of the products of any two of the scalar loads, each of which is applied in both coordinate
            directions, (r/2, r/2).
    """

    p: int
    products: Array
    gram: Array

    @classmethod
    def of(cls, divided: DividedTriangle, zero: Array, balanced: Array, loads: Array, gram: Array) -> BalancingStresses:
        """Compute stresses on the divided triangle that balance given loads; some stress must balance each load.

        Args:
            divided: matrices for the stresses on the divided triangle.
            zero: a matrix Z with one row for each condition on the stresses, such as continuous tractions: Z w = 0 for
                the coefficients w of a stress, (conditions, unknowns).
            balanced: the matrix from w to the 2c coefficients of the load that the stress balances, two components for
                each of c polynomials in turn, (2c, unknowns).
            loads: the coefficients of r/2 scalar loads as columns, (c, r/2). Each scalar load is applied in both
                coordinate directions, which gives r loads.
            gram: the integrals of the products of any two of the scalar loads, (r/2, r/2).
        """
        admissible = null_space(zero, rcond=DEPENDENT)
        onto = balanced @ admissible
        free = admissible @ null_space(onto, rcond=DEPENDENT)
        lifts = admissible @ np.linalg.pinv(onto, rcond=DEPENDENT) @ np.kron(loads, np.eye(2))
        values = divided.values @ np.hstack([free, lifts])
        products = np.einsum("qIp,qJr,q->IJpr", values, values, divided.weights, optimize=True)
        return cls(free.shape[1], products, gram)

    def constants(self, F: Array, compliance: Array, scale: Array) -> Array:
        """Return for each triangle x = F x̂ + b the largest ratio ‖τ‖_{A⁻¹}/‖load‖ over all loads, (cells,).

        x̂ is in the reference triangle. For each load, τ is the stress with the least norm ‖τ‖_{A⁻¹} among the
        composite stresses on the divided triangle that balance it. A load d on the reference triangle becomes a
        multiple of F d on the triangle.

        Args:
            F: the matrices F, (cells, 2, 2).
            compliance: the inverse A⁻¹ of the viscosity in Mandel form, (3, 3) or (cells, 3, 3).
            scale: the number for each triangle with ‖load‖² = scale × ∫ |F d|², (cells,): 1/|det F| for body forces,
                and 1/|e| for tractions on a side of length |e|.
        """
        push = piola(F)
        areas = abs(np.linalg.det(F))[:, None, None]
        metric = areas * (push.swapaxes(1, 2) @ compliance @ push)
        energy = np.tensordot(metric, self.products, axes=2)
        free, lifts = np.split(energy, [self.p], axis=1)
        coupling = np.linalg.solve(free[..., : self.p], free[..., self.p :])
        least = lifts[..., self.p :] - lifts[..., : self.p] @ coupling
        of_loads = np.einsum("c,vw,cab->cvawb", scale, self.gram, F.swapaxes(1, 2) @ F)
        inverse = np.linalg.inv(np.linalg.cholesky(of_loads.reshape(least.shape)))
        ratios = np.linalg.eigvalsh(inverse @ least @ inverse.swapaxes(1, 2))
        return np.sqrt(ratios[:, -1])


@lru_cache
def balancing_in_cell(q: int) -> BalancingStresses:
    """Return stresses on the divided reference triangle that balance body forces and have no traction on its boundary.

    The forces are polynomials of degree q on each of the four small triangles, and orthogonal to the polynomials of
    degree q on the whole triangle.
    """
    divided = DividedTriangle(q + 1)
    mass = np.kron(np.eye(4), triangle_mass(q) / 8)
    on_children = np.vstack([restriction(q, corners) for corners in CHILDREN])
    rest = null_space(on_children.T @ mass, rcond=DEPENDENT)
    on_thirds = np.vstack([restriction(q, corners) for corners in thirds(np.eye(3)).T])
    loads = np.kron(np.eye(4), on_thirds) @ rest
    zero = np.vstack([divided.inner, *divided.outer])
    return BalancingStresses.of(divided, zero, divided.divergence, loads, rest.T @ mass @ rest)


@lru_cache
def balancing_on_side(side: int) -> BalancingStresses:
    """Return stresses that balance tractions on one side of the reference triangle, divided into four triangles.

    The tractions are linear on each half of the side and orthogonal to linear tractions on the whole side. The
    divergence of the stresses and their tractions on the other sides are 0.

    Args:
        side: the number of the side, which is opposite to the vertex with this number.
    """
    divided = DividedTriangle(2)
    zero = np.vstack([divided.inner, *np.delete(divided.outer, side, axis=0), divided.divergence])
    # This matrix converts end values to Bernstein coefficients of degree 2: a linear function with the end values c_0,
    # c_1 has the coefficients c_0, (c_0 + c_1)/2, c_1.
    raised = np.array([[1.0, 0.0], [0.5, 0.5], [0.0, 1.0]])
    # Functions are given by their end values on the two halves. The columns of ``rest`` are orthogonal to the linear
    # functions on the side.
    mass = np.kron(np.eye(2), interval_mass(1, 1) / 2)
    linear = raised[[0, 1, 1, 2]]
    rest = null_space(linear.T @ mass, rcond=DEPENDENT)
    loads = np.kron(np.eye(2), raised) @ rest
    gram = rest.T @ mass @ rest
    # |ê| t̂ on a half is the traction t̂ times half of the length of the side, so the traction on the side is twice |ê|
    # t̂, and squares are multiplied by 4.
    return BalancingStresses.of(divided, zero, divided.outer[side], loads, 4 * gram)


def cell_constants(F: Array, compliance: Array, q: int) -> Array:
    """Return for each triangle T a bound of the constant C with ∫_T g·v ≤ C ‖g‖_T ‖ε(v)‖_{A,T}, (cells,).

    The inequality holds for all displacements v and all body forces g that are orthogonal to the polynomials of degree
    q on T. ‖·‖_{A,T} is the energy norm of the viscosity A on T. The constant is computed once for cells that differ
    only by size, by a half turn, or by the order of their vertices.

    Args:
        F: the matrices F of the affine maps x = F x̂ + b from the reference triangle to the triangles, (cells, 2, 2).
        compliance: the inverse A⁻¹ of the viscosity in Mandel form, (3, 3).
        q: the degree of the polynomials to which body forces are orthogonal.
    """
    size = np.sqrt(abs(np.linalg.det(F)))
    # The vertices are sorted by the lengths of the opposite sides.
    corners = F @ REFERENCE_CORNERS
    sides = np.roll(corners, 1, axis=2) - np.roll(corners, -1, axis=2)
    opposite = np.linalg.norm(sides, axis=1)
    order = np.argsort(opposite, axis=1, kind="stable")
    corners = np.take_along_axis(corners, order[:, None], axis=2)
    maps = corners[:, :, 1:] - corners[:, :, :1]
    # The sign is chosen such that the largest entry is positive, which removes half turns.
    entries = maps.reshape(-1, 4) / size[:, None]
    largest = abs(entries).argmax(axis=1)
    signs = np.sign(np.take_along_axis(entries, largest[:, None], axis=1))
    shapes, shape_of_cell = np.unique(np.round(entries * signs, 12), axis=0, return_inverse=True)
    stresses = balancing_in_cell(q)
    constants = []
    count = max(1, len(shapes) // CELLS_AT_A_TIME)
    for block in np.array_split(shapes.reshape(-1, 2, 2), count):
        scale = 1 / abs(np.linalg.det(block))
        constants.append(stresses.constants(block, compliance, scale))
    return np.sqrt(4 / 3) * np.concatenate(constants)[shape_of_cell] * size


def side_constants(F: Array, compliance: Array, side: int) -> Array:
    """Return for one side e of each triangle T a bound of the constant C with ∫_e g·v ≤ C ‖g‖_e ‖ε(v)‖_{A,T}, (cells,).

    The inequality holds for all displacements v and all tractions g that are orthogonal to the linear functions on e.
    ‖·‖_{A,T} is the energy norm of the viscosity A on T.

    Args:
        F: the matrices F of the affine maps x = F x̂ + b from the reference triangle to the triangles, (cells, 2, 2).
        compliance: the inverse A⁻¹ of the viscosity in Mandel form, (3, 3).
        side: the number of the side, which is opposite to the vertex with this number.
    """
    start, end = REFERENCE_CORNERS.T[[*SIDES[side]]]
    lengths = np.linalg.norm(F @ (end - start), axis=1)
    return np.sqrt(2) * balancing_on_side(side).constants(F, compliance, 1 / lengths)


def loaded_sides(space: StressSpace, compliance: Array) -> list[tuple[Array, Array, Array]]:
    """Return the sides e of cells T on Γ2, each with a constant C_e such that ∫_e g·v ≤ C_e ‖g‖_e ‖ε(v)‖_{A,T}.

    The inequality holds for all displacements v and all tractions g that are orthogonal to the linear functions on e.
    ‖·‖_{A,T} is the energy norm of the viscosity A on T, and Γ2 the loaded boundary.

    Args:
        space: the composite stresses on the mesh.
        compliance: the inverse A⁻¹ of the viscosity in Mandel form, (3, 3).

    Returns:
        For each of the three side numbers: the cells with this side on Γ2, (n,); the edges there, (n,); and the
        constants of ``side_constants``, (n,).
    """
    loaded = space.edges_on(Kind.LOADED)
    sides = []
    for side, edges in enumerate(space.edges.T):
        cells = np.flatnonzero(np.isin(edges, loaded))
        sides.append((cells, edges[cells], side_constants(space.map[cells], compliance, side)))
    return sides


class Oscillation:
    """Computes the data oscillation η_T of every cell T, a bound of the work of loads that the projection leaves out.

    For the body force f_0, the traction f_2 and their projections P f_0, P f_2 onto piecewise polynomials, and for all
    displacements v,

        (f_0 − P f_0, v)_T + Σ_e (f_2 − P f_2, v)_e ≤ η_T ‖ε(v)‖_{A,T},

    where e are the sides of T on Γ2, and ‖·‖_{A,T} is the energy norm of the viscosity A on T. The oscillation is η_T =
    C_{T,k−1} ‖Π g‖_T + C_{T,k} ‖g − Π g‖_T + Σ_e C_e ‖f_2 − P f_2‖_e. Here k is the degree of the stresses that balance
    the projected loads, g = f_0 − P f_0, and Π g the projection of g onto the polynomials of degree k on T.
    ``cell_constants`` computes C_{T,k}, and ``side_constants`` computes C_e. Calling the object with the three norms
    (``LeftOut``) returns η_T, (cells,).

    Args:
        space: the composite stresses for which P is defined, of degree k ≥ 2.
        compliance: the inverse A⁻¹ of the viscosity without its material factor, in Mandel form, (3, 3).
        low: the smallest value of the material factor of A.
    """

    def __init__(self, space: StressSpace, compliance: Array, low: float = 1.0) -> None:
        # With the factor α ≥ ``low`` the inverse viscosity is at most the given one, divided by ``low``.
        compliance = compliance / low
        self._low, self._high = (cell_constants(space.map, compliance, space.degree + i) for i in (-1, 0))
        self._sides = loaded_sides(space, compliance)

    def __call__(self, left_out: LeftOut) -> Array:
        """Return the oscillation η_T of every cell, (cells,), from norms of the part of the loads that P leaves out."""
        total = self._low * left_out.low_order + self._high * left_out.high_order
        for cells, edges, constants in self._sides:
            total[cells] += constants * left_out.on_edges[edges]
        return total
