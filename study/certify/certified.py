"""Makes the certificate of one level, from the solution u_h and the more accurate displacement ũ of ``study bound``.

**The reference element** is the composite element of degree 3 on the reference triangle, with exact coefficients. The
unknowns are the 90 coefficients of a stress σ̂ and three coefficients of a rigid motion q̂. The equations say that
tractions are continuous inside and prescribed on the boundary, and that Div σ̂ − q̂ = −f̂. They are solved for all
prescribed data at once, by row reduction over the rational numbers.

**The constants of the loads** are C_Ω and C_Γ with ∫ g·v ≤ C_Ω ‖g‖ ‖v‖_V and ∫_{Γ2} g·v ≤ C_Γ ‖g‖ ‖v‖_V. A tensor field
Φ proves them as follows. For a totally symmetric Φ, continuous and linear on cells, and v = 0 on Γ1,

    ∫ (div Φ)(v, v) + 2 (Φv)·ε(v) = ∫_{Γ2 ∪ Γ3} Φ(ν, v, v),

since (Φv)·∇v = (Φv)·ε(v). With −2 (Φv)·ε(v) ≤ Aε(v)·ε(v) + A⁻¹(Φv)·(Φv) it follows that

    ‖v‖_V² ≥ ∫ div Φ(v, v) − A⁻¹(Φv)·(Φv) − ∫_{Γ2 ∪ Γ3} Φ(ν, v, v) ≥ μ ‖v‖² + κ ‖v‖²_{L²(Γ2)}

if the integrands are large enough. It suffices to check 2 × 2 matrices at vertices, because the quadratic term is
convex on a cell. Korn's inequality is not needed. The largest κ, with a fixed ratio μ/κ, is the solution of a
semidefinite programme. Its conditions are written with a Schur complement:

    ( div Φ − μ 1   Φᵀ )
    ( Φ             A  )  ⪰ 0     at every vertex of every cell.

**The witnesses** are the displacement ũ and the stress σ̃ of ``study.bound``, rounded to integers. From these two
fields the checker computes an error bound. Rounding must keep them admissible: the signs of ũ_ν and σ̃_ν on the contact
boundary Γ3 must be right exactly. The balance of forces need not be exact, because the checker adds the effect of
unbalanced loads to the bound.

σ̃ differs from the stress that ``study.bound`` uses in two ways. It balances the loads f̃ of the checker, not the
projected loads. And it is given by its tractions on the edges and by nine numbers for each cell, called inner numbers,
from which the checker makes a stress with exactly continuous tractions.
"""

import json
import math
from collections import defaultdict
from collections.abc import Callable, Collection, Iterator, Sequence
from fractions import Fraction
from functools import cache
from itertools import product
from pathlib import Path

import clarabel
import numpy as np
import scipy.sparse as sps
from numpy.typing import ArrayLike
from sympy import QQ
from sympy.polys.matrices import DomainMatrix

from manufactured.body import Kind
from manufactured.data import Data
from manufactured.tensors import Array, Tensors, basis
from study.bound.discretisation import Discretisation
from study.bound.problem import BoundError
from study.bound.trajectory import Refined, compute, spline
from study.certify import checker
from study.certify.checker import CENTRE, CORNERS, CUBIC, SQUARE, Poly, X, Y
from study.certify.statement import Twins, in_doubles, rational_mesh, statement
from study.fem.mesh import MeshFamily, Unstructured
from study.fem.quadrature import bernstein
from study.ledger.files import Json, write_packed
from study.solve.evolution import Scheme
from study.stresses.hybrid import EquilibratedStress
from study.stresses.loads import Loads

FINE_DIGITS, COARSE_DIGITS = 38, 20
"""Numbers of binary digits of a stress, relative to the largest traction.

``FINE_DIGITS`` is for the numbers on which the balance of forces depends, ``COARSE_DIGITS`` for all others.
"""
DISPLACEMENT_DIGITS = 38
"""Number of binary digits of the displacement ũ, relative to its largest value."""
LOAD_BITS = 60
"""Number of binary digits to which the body forces here agree with the body forces of the checker."""


def bits_below(size: float, digits: int) -> int:
    """Return the number b ≥ 1 of binary digits behind the point with which numbers are rounded.

    Numbers up to ``size`` then are integers of about ``digits`` binary digits, times 2^{−b}.

    Args:
        size: the largest absolute value of the numbers.
        digits: the number of binary digits of the largest integer.
    """
    if not size:
        return 1
    return max(digits - math.ceil(math.log2(size)), 1)


def rounded(mesh: checker.Mesh, values: Array, bits: int) -> Array:
    """Round displacements to integers over 2^bits that are exactly admissible: v = 0 on Γ1, and v·ν ≤ 0 on Γ3.

    Args:
        mesh: the mesh of the checker.
        values: for each time, the Bernstein coefficients at the vertices, then at the edges, (times, vertices + edges,
            2).
        bits: the number of binary digits behind the point.

    Returns:
        The integers at each time, x and y in turn, (times, 2 (vertices + edges)).
    """
    normals = defaultdict[int, set[checker.Vector]](set)
    clamped: list[int] = []
    for edge, side in mesh.boundary.items():
        nodes = mesh.nodes_of(edge)
        if side.kind == "clamped":
            clamped += nodes
        elif side.kind == "contact":
            for n in nodes:
                normals[n].add(side.normal)
    integers = np.round(values * 2.0**bits).astype(np.int64)
    for n, of_node in normals.items():
        integers[:, n] = [admissible(v, of_node) for v in integers[:, n].tolist()]
    integers[:, clamped] = 0
    return integers.reshape(len(integers), -1)


def admissible(value: Sequence[int], normals: Collection[checker.Vector]) -> list[int]:
    """Return an integer vector near a given one with value·N ≤ 0 for all given normals N.

    Args:
        value: the given vector, two integers.
        normals: the normals N of the contact sides that meet at a node, none of which are opposite.
    """
    units = [np.array(N, dtype=float) / math.hypot(*N) for N in normals]
    inward = -np.sum(units, axis=0)
    # A short vector (p, q) is sought, because a multiple of it is added.
    scale = 1
    p = 0
    q = 0
    while any(checker.dot((p, q), N) >= 0 for N in normals):
        p, q = (round(c) for c in scale * inward)
        scale *= 2
    steps = 0
    for N in normals:
        # N is a pair of fractions, so the quotient is exact.
        needed = checker.dot(value, N) / -checker.dot((p, q), N)
        steps = max(steps, math.ceil(needed))
    return [value[0] + steps * p, value[1] + steps * q]


class StressEncoder:
    """Converts stresses of ``study.bound`` to integers of a certificate.

    The stresses must balance the approximate loads f̃ of the checker. So ``loads`` converts these to the form in which
    ``study.bound`` computes stresses for given loads.

    Args:
        problem: the problem, as the checker reads it.
        twins: the mesh, in the checker and in scikit-fem.
        fine: the discretisation of ``study.bound`` on this mesh.
    """

    def __init__(self, problem: checker.Problem, twins: Twins, fine: Discretisation) -> None:
        exact = twins.exact
        space = fine.stresses
        self.problem = problem
        self.twins = twins
        self.space = space
        self._surface_load = fine.data.surface_load
        element, self._free = reference_element()
        self._loads = checker.Loads(problem, exact, LOAD_BITS)
        maps = np.array([cell.F for cell in exact.cells], dtype=float) / exact.h
        F = maps.reshape(-1, 2, 2)
        self._twice_area = np.linalg.det(F)
        self._adjugate = np.linalg.inv(F) * self._twice_area[:, None, None]
        self._fit = np.linalg.pinv(self._monomials(checker.CUBIC))
        # Every edge of the layout is a side of a cell, from its first to its second vertex counter-clockwise.
        sides = {}
        for number, cell in enumerate(exact.cells):
            for i in range(3):
                sides[cell.v[i - 2], cell.v[i - 1]] = number, i
        layout = checker.Stresses(exact, {"bits": 1, "coarse": 0}, checker.Element.of(element))
        edges = [*layout.contact, *layout.loaded, *layout.free]
        self._ends = np.cumsum([len(layout.contact), len(layout.loaded)])
        cells, places = np.array([sides[edge] for edge in edges]).T
        self._sides = twins.cells[cells], twins.corners[cells, places]
        self._edges = space.edges[self._sides]
        starts = twins.nodes[[start for start, _ in edges]]
        self._backward = space.mesh.facets[0, self._edges] != starts
        along = np.array([exact.along(edge) for edge in edges])
        self._normals = along[:, ::-1] * [1, -1] / exact.h

    def loads(self, a: Fraction, b: Fraction) -> list[Loads]:
        """Return the loads f̃ of the checker for a time interval [a, b], as three Bernstein coefficients in time."""
        first, middle, last = (self._surface(float(time)) for time in (a, (a + b) / 2, b))
        surfaces = first, 2 * middle - (first + last) / 2, last
        forces = map(self._force, self._loads.controls(a, b))
        return list(map(Loads, forces, surfaces))

    def _force(self, control: list[Poly]) -> Array:
        """Return a Bernstein coefficient in time of the body force of the checker as in ``Loads.force``."""
        coefficients = np.zeros((self.space.cells, 3, 6, 2))
        numbers = self._loads.on_cells(control)
        if numbers:
            force = np.array(numbers, dtype=float) / 2.0**LOAD_BITS
            force /= self._twice_area[:, None]
            values = self._monomials(checker.SQUARE) @ force.reshape(-1, 1, 6, 2)
            fit = np.linalg.pinv(self.space.force_shapes.T)
            coefficients[self.twins.cells] = fit @ values
        return coefficients

    def _monomials(self, exponents: list[tuple[int, int, int]]) -> Array:
        """Return monomials on the reference triangle of the checker at the quadrature points of scikit-fem.

        Axes: cell of the checker, subtriangle of scikit-fem, point, monomial.
        """
        _, X, Y = np.moveaxis(self.space.barycentric[self.twins.corners], 1, 0)
        monomials = np.stack([X**i * Y**j for i, j, _ in exponents], axis=-1)
        return monomials.reshape(len(X), 3, -1, len(exponents))

    def _surface(self, time: float) -> Array:
        """Return the traction f_2 at a time as in ``Loads.surface``, interpolated by a cubic on every loaded edge."""
        mesh = self.space.mesh
        x = np.linspace(0, 1, 4)
        values = np.zeros((len(self.space.lengths), 4, 2))
        for part, edges in self.space.on(Kind.LOADED):
            start, end = np.moveaxis(mesh.p[:, mesh.facets[:, edges]], 1, 0)
            points = start[..., None] + np.multiply.outer(end - start, x)
            f_2 = self._surface_load(part, points)
            values[edges] = np.moveaxis(f_2(time), 0, -1)
        return np.linalg.solve(bernstein(3, np.array([1 - x, x])).T, values)

    def tractions(self, stress: EquilibratedStress) -> Array:
        """Return the Bernstein coefficients of tractions |e|σν on the edges, (edges, 4, 2).

        Edges are in the order of ``checker.Stresses``: contact, loaded, free. ν points to the right of an edge.
        """
        space = self.space
        cartesian = stress.tractions[self._sides] @ space.frames[self._edges]
        cartesian[self._backward] = cartesian[self._backward, ::-1]
        return cartesian * space.lengths[self._edges, None, None]

    def inner(self, values: Tensors) -> Array:
        """Return the nine inner numbers of every cell of a stress, (cells, 9).

        They are those coefficients of the stress on the reference triangle that tractions and forces do not determine.

        Args:
            values: the stress at the quadrature points of the space, (3, cells, Q).
        """
        on_cells = np.moveaxis(values[:, self.twins.cells], 0, -1)
        coefficients = self._fit @ on_cells.reshape(len(on_cells), 3, -1, 3)
        # The stress on the reference triangle is σ̂ = F⁻¹ σ F⁻ᵀ det F, and the checker multiplies it by det F.
        A = self._adjugate
        E = basis(2)
        hat = np.einsum("cik,Ikl,cjl,ctnI->ctnij", A, E, A, coefficients, optimize=True)
        component, third, monomial = self._free.T
        row, column = np.array([[0, 0], [1, 1], [0, 1]])[component].T
        cells = np.arange(len(hat))[:, None]
        inner: Array = hat[cells, self.twins.corners[:, third], monomial, row, column]
        return inner * self.twins.exact.h

    def integers(self, tractions: Array, inner: Array, bits: int, coarse: int) -> tuple[Array, Array]:
        """Return the integers by which a certificate stores a stress: tractions, and inner numbers of the cells.

        The tractions are rounded such that σ̃_ν ≤ 0 holds exactly on Γ3.

        Args:
            tractions, inner: the stress, as the methods with these names return it.
            bits: the unit of tractions is 2^{−bits}.
            coarse: a larger unit, 2^{coarse − bits}, is used for the inner numbers, and on inner and clamped edges for
                the last two of the four polynomials ``checker.MODES`` of which the traction is a combination.

        Returns:
            The numbers of the tractions, in the order of ``checker.Stresses.tractions``: four for each edge of Γ3,
            eight for each other edge, in one row. And the inner numbers, (9 cells,).
        """
        contact, loaded, free = np.split(tractions, self._ends)
        n = self._normals[: len(contact), None]
        normal = (contact * n).sum(axis=2) / (n * n).sum(axis=2)
        pressed = np.minimum(normal, 0)
        modes = np.linalg.solve(np.array(checker.MODES).T, free)
        modes[:, 2:] /= 2.0**coarse
        numbers = np.concatenate([part.ravel() for part in (pressed, loaded, modes)])
        inner_numbers = inner.ravel() * 2.0 ** (bits - coarse)
        return np.round(numbers * 2.0**bits), np.round(inner_numbers)


INNER = 9
"""Number of free coefficients of a stress on the reference element."""
RIGID = ((checker.ONE, Poly()), (Poly(), checker.ONE), (Y * -1, X))
FIELD_BITS = 28
"""Number of binary digits of the tensor field Φ: it is rounded to multiples of 2^−FIELD_BITS."""
SEMIDEFINITE_MARGIN = 1e-6
"""Margin in every semidefinite condition, because neither the solver nor the rounding of Φ is exact."""
WITH_FORCE, WITHOUT_FORCE = Fraction(1), Fraction(1, 100)
"""The ratio μ/κ of the two constants that are maximised together, for problems with and without a body force f_0.

Without f_0, the constant C_Ω is needed for rounding errors only, so μ can be small.
"""
SLACKS = (1e-4, 1e-3, 1e-2, 0.1)
"""Fractions by which κ is reduced until the rounded field Φ proves it; they are tried in turn."""


# ---- the reference element: the stress for each prescribed traction and force


def _coefficients(tractions: list[Poly], divergences: list[Poly]) -> list[Fraction]:
    """Return the coefficients of 12 cubic polynomials on edges and of 6 polynomials of degree 2 on subtriangles."""
    zero = Fraction(0)
    on_edges = [p.get((n, 0, 0), zero) for p in tractions for n in range(4)]
    in_thirds = [p.get(key, zero) for p in divergences for key in SQUARE]
    return on_edges + in_thirds


def _of_stress(component: int, third: int, monomial: int) -> list[Fraction]:
    """Return the contributions to all equations of a stress of which one coefficient is 1 and all others are 0.

    The equations are for tractions on the boundary, jumps of tractions inside, and divergences on the subtriangles.
    """
    unit = np.zeros((3, 3, 10), dtype=int)
    unit[third, component, monomial] = 1
    stress = unit.tolist()
    outside = []
    jumps = []
    divergences = []
    for i in range(3):
        # A negative number counts from the end.
        outside += checker.tractions(stress[i], CORNERS[i - 2], CORNERS[i - 1])
        left = checker.tractions(stress[i - 2], CORNERS[i], CENTRE)
        right = checker.tractions(stress[i - 1], CORNERS[i], CENTRE)
        jumps += [p - q for p, q in zip(left, right, strict=True)]
        x, y, z = (checker.combination(checker.PLAIN, values) for values in stress[i])
        divergences.append(x.slope(0) + z.slope(1))
        divergences.append(z.slope(0) + y.slope(1))
    return _coefficients(outside + jumps, divergences)


@cache
def reference_element() -> tuple[Json, Array]:
    """Return the reference element as a certificate states it, and which coefficients of its stresses are free.

    The element has 45 degrees of freedom: 36 prescribed tractions and forces, and 9 free coefficients.

    Returns:
        First, a dict. For each degree of freedom, ``columns`` contains the 90 coefficients of the stress for which it
        is 1 and all others are 0, as numerators of the common denominator ``over``. Coefficients are numbered by
        component (3), subtriangle (3) and monomial (10). Second, for each free coefficient its component, subtriangle
        and monomial, (9, 3).
    """
    # Monomials of high degree are eliminated first: the columns are then ten times smaller, and low degrees stay free.
    places = product(range(3), range(3), range(10))
    unknowns = sorted(places, key=lambda place: -sum(CUBIC[place[2]]))
    no_tractions = [Poly()] * 12
    no_divergences = [Poly()] * 6
    columns = [_of_stress(*place) for place in unknowns]
    for motion in RIGID:
        columns.append(_coefficients(no_tractions, [p * -1 for p in motion] * 3))
    for side, p, d in product(range(3), checker.bernstein(3, X), (0, 1)):
        tractions = no_tractions.copy()
        tractions[2 * side + d] = p * -1
        columns.append(_coefficients(tractions, no_divergences))
    for key, d in product(SQUARE, (0, 1)):
        force = [Poly(), Poly()]
        force[d] = Poly({key: Fraction(1)})
        columns.append(_coefficients(no_tractions, force * 3))
    equations = [[x.as_integer_ratio() for x in row] for row in zip(*columns, strict=True)]
    null_space = DomainMatrix.from_list(equations, QQ).nullspace(divide_last=True)
    solutions = null_space.to_list()
    # In each solution, the last coefficient that is not 0 is the degree of freedom, which is 1.
    free = [max(n for n, x in enumerate(row) if x) for row in solutions[:INNER]]
    order = sorted(range(len(unknowns)), key=unknowns.__getitem__)
    stresses = [[Fraction(str(row[n])) for n in order] for row in solutions]
    prescribed_first = stresses[INNER:] + stresses[:INNER]
    numerators, over = checker.common(prescribed_first)
    return {"over": over, "columns": numerators}, np.array(unknowns)[free]


# ---- the constants of the loads, from a semidefinite programme


def constants(mesh: Json, problem: checker.Problem) -> Json:
    """Return the constants of the loads as a certificate states them: a mesh, a field Φ at its vertices, μ and κ.

    μ and κ stand for the constants C_Ω = μ^{−1/2} and C_Γ = κ^{−1/2} with ∫ g·v ≤ C_Ω ‖g‖ ‖v‖_V and ∫_{Γ2} g·v ≤
    C_Γ ‖g‖ ‖v‖_V for all g and all v ∈ V. The tensor field Φ proves them, as the top of this file explains.

    Args:
        mesh: the mesh for Φ, as a certificate states it.
        problem: the problem, as the checker reads it.

    Raises:
        BoundError: no tensor field was found that proves a constant.
    """
    exact = checker.Mesh.of(mesh, problem)
    inside = WITH_FORCE if any(problem.force) else WITHOUT_FORCE
    field, largest = _solve(exact, problem, float(inside))
    rounded = [[int(component) for component in row] for row in np.round(field * 2**FIELD_BITS)]
    for slack in SLACKS:
        kappa = Fraction(largest * (1 - slack)).limit_denominator(10**6)
        stated = {
            "mesh": mesh,
            "bits": FIELD_BITS,
            "field": rounded,
            "volume": str(kappa * inside),
            "surface": str(kappa),
        }
        try:
            checker.load_constants(stated, problem)
        except checker.RefusedError:
            continue
        return stated
    raise BoundError(
        "no constant of the loads could be proved for this body: the checker refused every rounded field Φ; the mesh "
        "of the body may have very flat cells, so avoid small angles and very short sides"
    )


def _solve(mesh: checker.Mesh, problem: checker.Problem, inside: float) -> tuple[Array, float]:
    """Solve the semidefinite programme for the tensor field Φ with the largest κ.

    Args:
        mesh: the mesh on which Φ is linear.
        problem: the problem.
        inside: the ratio μ/κ.

    Returns:
        The four independent components of Φ at the vertices, (vertices, 4), and κ.
    """
    unknowns = 4 * len(mesh.points) + 1
    *components, kappa = np.eye(unknowns)
    phi = np.reshape(components, (-1, 4, unknowns))
    # Clarabel expects the upper triangle of a matrix by columns, with off-diagonal entries multiplied by √2.
    rows = []
    right = []
    cones = []
    for linear, constant in (*_inside(mesh, problem, phi, inside * kappa), *_on_boundary(mesh, phi, kappa)):
        j, i = np.tril_indices(len(constant))
        scale = np.where(i == j, 1.0, np.sqrt(2))
        rows.append(sps.csr_matrix(-scale[:, None] * linear[i, j]))
        right.append(scale * constant[i, j])
        cones.append(clarabel.PSDTriangleConeT(len(constant)))
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    objective = np.zeros(unknowns)
    objective[-1] = -1.0
    matrix = sps.csc_matrix(sps.vstack(rows))
    quadratic = sps.csc_matrix((unknowns, unknowns))
    solver = clarabel.DefaultSolver(quadratic, objective, matrix, np.concatenate(right), cones, settings)
    *field, largest = solver.solve().x
    return np.reshape(field, (-1, 4)), largest


def _inside(mesh: checker.Mesh, problem: checker.Problem, phi: Array, mu: Array) -> Iterator[tuple[Array, Array]]:
    """Yield the conditions of the programme at the vertices of the cells, as linear functions of the unknowns.

    The unknowns are the values of Φ, then κ. Each condition is the upper triangle of the matrix with the Schur
    complement in the docstring of the module. It is a pair of coefficients, (5, 5, unknowns), and constants, (5, 5).

    Args:
        mesh: the mesh on which Φ is linear.
        problem: the problem.
        phi: the four components of Φ at each vertex, (vertices, 4, unknowns).
        mu: the constant μ, (unknowns,).
    """
    constant = -SEMIDEFINITE_MARGIN * np.eye(5)
    constant[2:, 2:] = np.array(problem.A, dtype=float)
    for cell in mesh.cells:
        a, b, c, d = (x * mesh.h / cell.det for x in cell.F)
        slopes = (c - d, b - a), (d, -b), (-c, a)
        divergence = -np.multiply.outer(np.eye(2), mu)
        for v, slope in zip(cell.v, slopes, strict=True):
            divergence += _contracted(phi[v], slope)
        for v in cell.v:
            block = np.zeros((5, 5, len(mu)))
            block[:2, :2] = divergence
            block[:2, 2:] = phi[v, ((0, 2, 1), (1, 3, 2))]  # rows: the stresses Φe_1 and Φe_2
            yield block, constant


def _on_boundary(mesh: checker.Mesh, phi: Array, kappa: Array) -> Iterator[tuple[Array, Array]]:
    """Yield the conditions of the programme at the ends of edges outside Γ1, in the same form as ``_inside``.

    The matrix is −Φ(ν), and on loaded edges −Φ(ν) − κ 1.
    """
    for edge, side in mesh.boundary.items():
        if side.kind == "clamped":
            continue
        normal = np.array(side.normal, dtype=float)
        normal /= np.linalg.norm(normal)
        for v in edge:
            block = -_contracted(phi[v], normal)
            if side.load:
                block -= np.multiply.outer(np.eye(2), kappa)
            yield block, -SEMIDEFINITE_MARGIN * np.eye(2)


def _contracted(components: Array, vector: ArrayLike) -> Array:
    """Return the matrix Φ·vector at a vertex from the components of Φ, (4, unknowns) → (2, 2, unknowns)."""
    p, q, r = (np.dot(vector, components[k : k + 2]) for k in range(3))
    return np.array([[p, q], [q, r]])


CONSTANTS_LEVEL = 12
"""Level of the mesh on which the constants C_Ω and C_Γ of the body are proved."""
BELOW, DAMPING = 1e-9, 32
"""How the monotonicity constant m that a certificate states is rounded.

It is reduced by the relative distance ``BELOW`` and then rounded down to ``DAMPING`` binary digits, so that round-off
does not make it larger than the true constant.
"""


def check_certifiable(data: Data) -> None:
    """Refuse a problem that the checker would refuse, before its certificate is computed.

    Raises:
        BoundError: the checker refuses the problem; the message gives its reason.
    """
    stated = statement(data)
    try:
        checker.conform(stated, checker.PROBLEM, "problem")
        checker.Problem(stated)
    except checker.RefusedError as refusal:
        raise BoundError(f"no certificate can be made of this problem: {refusal}") from refusal


def make_certificate(
    data: Data,
    family: MeshFamily,
    level: int,
    scheme: Scheme,
    steps: int,
    refined: Refined,
    progress: Callable[[float], object] = lambda time: None,
) -> Json:
    """Return a certificate of bounds of the largest error max ‖u − u_h‖_V on one level, as data that JSON can write.

    u_h is computed here. The certificate has u_h and what the checker needs to prove both bounds: a more accurate
    displacement ũ and its stress σ̃, rounded to integers, and the constants of the loads.

    Args:
        data: the problem.
        family, level: the mesh family and the level of the mesh of u_h.
        scheme, steps: the time scheme of u_h, and the number of its time steps.
        refined: how ũ is computed.
        progress: a function that is called with each time for which the stress is finished.
    """
    stated = statement(data)
    problem = checker.Problem(stated)
    mesh = rational_mesh(family(data.body, level), data.body)
    exact = checker.Mesh.of(mesh, problem)
    coarse = Discretisation(data, in_doubles(exact))
    u_h = compute(coarse, scheme, steps)
    fine = refined.discretisation(coarse)
    for _ in range(refined.refinements):
        exact = exact.refined()
    twins = Twins(fine.mesh, exact)
    nodes = list(refined.nodes(fine, u_h))
    u = np.array([fine.displacements.coefficients(node)[twins.nodes] for _, node in nodes])
    bits = bits_below(abs(u).max(), DISPLACEMENT_DIGITS)
    m = max(0.0, float(fine.moduli.values.min()))
    damping = Fraction(math.floor(m * (1 - BELOW) * 2**DAMPING), 2**DAMPING)
    mesh_of_constants = rational_mesh(Unstructured()(data.body, CONSTANTS_LEVEL), data.body)
    proved = constants(mesh_of_constants, problem)
    displacement = {"bits": bits, "nodes": differences(rounded(exact, u, bits))}
    encoder = StressEncoder(problem, twins, fine)
    stress = _rounded_stresses(encoder, fine, nodes, progress)
    return {
        "format": checker.FORMAT,
        "level": level,
        "problem": stated,
        "constants": proved,
        "m": str(damping),
        "mesh": mesh,
        "refinements": refined.refinements,
        "computed": u_h.nodes.tolist(),
        "element": reference_element()[0],
        "displacement": displacement,
        "stress": stress,
    }


def _rounded_stresses(
    encoder: StressEncoder, fine: Discretisation, nodes: list[tuple[float, Array]], progress: Callable[[float], object]
) -> Json:
    """Compute the stress σ̃ of a certificate at all times and round it to integers.

    Between two knots of the spline ũ, σ̃ is a parabola in time. It is stored at every knot, and by one control point
    between any two knots. The result is the entry "stress" of the certificate.

    Args:
        encoder: computes the loads, and the integers of a stress.
        fine: the discretisation on the mesh of ũ.
        nodes: the control points of the spline ũ, with their times.
        progress: a function that is called with each time for which the stress is finished.
    """

    def stress_at(load: Loads, u: Array, rate: Array) -> tuple[Array, Array]:
        target = fine.viscous(rate) + fine.elastic(u)
        stress = fine.nearest_stress(load, target, u)
        return encoder.tractions(stress), encoder.inner(stress.values + target)

    # The spline of the checker has the same knots, as fractions.
    exact_pieces = checker.pieces([[0]] * len(nodes), encoder.problem.T)
    stresses: list[tuple[Array, Array]] = []
    for piece, exact in zip(spline(nodes), exact_pieces, strict=True):
        start, middle, end = encoder.loads(exact.a, exact.b)
        first = piece.rate(end=False)
        last = piece.rate(end=True)
        if not stresses:  # the start of any other piece is the end of the piece before
            stresses.append(stress_at(start, piece.start, first))
        stresses.append(stress_at(middle, piece.control, (first + last) / 2))
        stresses.append(stress_at(end, piece.end, last))
        progress(piece.b)
    # All stresses are computed before any is rounded, because the unit of rounding depends on the largest one.
    largest = max(abs(tractions).max() for tractions, _ in stresses)
    bits = bits_below(largest, FINE_DIGITS)
    coarse = FINE_DIGITS - COARSE_DIGITS
    tractions, inner = zip(*(encoder.integers(*stress, bits, coarse) for stress in stresses), strict=True)
    return {"bits": bits, "coarse": coarse, "tractions": differences(tractions), "inner": differences(inner)}


def differences(rows: ArrayLike) -> list[list[int]]:
    """Return the second differences in time of whole numbers, which have fewer digits than the numbers.

    So the file of a certificate is smaller. The first row has the numbers at the first time. ``checker.summed`` is the
    inverse function.

    Args:
        rows: the numbers, one row for each time, (times, k).
    """
    # They become integers of Python, because 64 bits may be too few.
    integers = np.frompyfunc(int, 1, 1)(np.array(rows))
    first = np.diff(integers, axis=0, prepend=0)
    return np.diff(first, axis=0, prepend=0).tolist()


def write(path: Path, certificate: Json) -> Path:
    """Write a certificate to a file and return its path; equal certificates give identical files."""
    text = json.dumps(certificate, separators=(",", ":"))
    return write_packed(path, text)
