"""The witnesses of a certificate: the displacement ũ and the stress σ̃ of ``study.bound``, rounded to integers.

From these two fields the checker computes an error bound. Rounding must keep them admissible: the signs of ũ_ν and σ̃_ν
on the contact boundary Γ3 must be right exactly. The balance of forces need not be exact, because the checker adds the
effect of unbalanced loads to the bound.

σ̃ differs from the stress that ``study.bound`` uses in two ways. It balances the loads f̃ of the checker, not the
projected loads. And it is given by its tractions on the edges and by nine numbers for each cell, called inner numbers,
from which the checker makes a stress with exactly continuous tractions.
"""

import math
from collections import defaultdict
from collections.abc import Collection, Sequence
from fractions import Fraction

import numpy as np

from manufactured.tensors import Array, Tensors, basis
from study.bound.discretisation import Discretisation
from study.certify import checker
from study.certify.constants import reference_element
from study.certify.statement import Twins
from study.stresses.composite import bernstein
from study.stresses.hybrid import EquilibratedStress
from study.stresses.loads import Loads

FINE, COARSE = 38, 20
"""Numbers of binary digits of a stress, relative to the largest traction.

``FINE`` is for the numbers on which the balance of forces depends, ``COARSE`` for all others.
"""
DISPLACEMENT = 38
"""Number of binary digits of the displacement ũ, relative to its largest value."""
LOAD_BITS = 60
"""Number of binary digits to which the body forces here agree with the body forces of the checker."""
ON_EDGE = [Fraction(i, 3) for i in range(4)]
"""The relative positions on an edge at which the traction f_2 is interpolated by a cubic polynomial."""


def bits_below(size: float, digits: int) -> int:
    """Return the exponent b of a unit 2^{−b} that is about 2^{−digits} times a given size."""
    return max(digits - math.ceil(math.log2(size)), 1) if size > 0 else 1


def rounded(mesh: checker.Mesh, values: Array, bits: int) -> list[list[int]]:
    """Round displacements to integers over 2^bits that are exactly admissible: v = 0 on Γ1, and v·ν ≤ 0 on Γ3.

    Args:
        mesh: the mesh of the checker.
        values: for each time, the coefficients at the vertices, then at the edges, (times, vertices + edges, 2).
        bits: the number of binary digits behind the point.

    Returns:
        For each time the integers in one list, x and y in turn.
    """
    normals, clamped = defaultdict[int, set[checker.Vector]](set), set[int]()
    for edge, side in mesh.boundary.items():
        if side.kind == "clamped":
            clamped.update(mesh.nodes_of(edge))
        elif side.kind == "contact":
            for n in mesh.nodes_of(edge):
                normals[n].add(side.normal)
    found = np.round(values * 2.0**bits).astype(np.int64).tolist()
    for v in found:
        for n, of_node in normals.items():
            v[n] = admissible(v[n], of_node)
        for n in clamped:
            v[n] = [0, 0]
    return [[c for point in v for c in point] for v in found]


def admissible(value: Sequence[int], normals: Collection[checker.Vector]) -> list[int]:
    """Return an integer vector near ``value`` with value·N ≤ 0 for all normals N, none of which are opposite."""
    inward = -np.sum([np.array(N, dtype=float) / math.hypot(*N) for N in normals], axis=0)
    # A short vector (p, q) is sought, because a multiple of it is added.
    scale, p, q = 1, 0, 0
    while any(checker.dot((p, q), N) >= 0 for N in normals):
        (p, q), scale = (round(c) for c in scale * inward), 2 * scale
    steps = max(0, *(math.ceil(Fraction(checker.dot(value, N)) / -checker.dot((p, q), N)) for N in normals))
    return [value[0] + steps * p, value[1] + steps * q]


class StressEncoder:
    """Converts stresses of ``study.bound`` to integers for the checker, and loads of the checker to projected loads.

    Args:
        problem: the problem, as the checker reads it.
        twins: the mesh, in the checker and in scikit-fem.
        fine: the discretisation of ``study.bound`` on this mesh.
    """

    def __init__(self, problem: checker.Problem, twins: Twins, fine: Discretisation) -> None:
        space = fine.stresses
        self.problem, self.exact, self.twins, self.space = problem, twins.exact, twins, space
        element, self._free = reference_element()
        self.layout = checker.Stresses(self.exact, {"bits": 1, "coarse": 0}, checker.Element.of(element))
        self._loads = checker.Loads(problem, self.exact, LOAD_BITS)
        F = np.array([cell.F for cell in self.exact.cells], dtype=float).reshape(-1, 2, 2) / self.exact.h
        self._twice_area = np.linalg.det(F)
        self._adjugate = np.linalg.inv(F) * self._twice_area[:, None, None]
        self._fit = np.linalg.pinv(self._monomials(checker.CUBIC))
        # Every edge of the layout is a side of a cell, from its first to its second vertex counter-clockwise.
        sides = {(v[i - 2], v[i - 1]): (n, i) for n, v in enumerate(c.v for c in self.exact.cells) for i in range(3)}
        edges = [*self.layout.contact, *self.layout.loaded, *self.layout.free]
        self._loaded = slice(len(self.layout.contact), len(self.layout.contact) + len(self.layout.loaded))
        cells, places = np.array([sides[edge] for edge in edges]).T
        self._sides = twins.cells[cells], twins.corners[cells, places]
        self._edges = space.edges[self._sides]
        self._backward = space.mesh.facets[0, self._edges] != twins.nodes[[a for a, _ in edges]]
        self._normals = np.array([self.exact.along(edge) for edge in edges])[:, ::-1] * [1, -1] / self.exact.h

    def loads(self, a: Fraction, b: Fraction) -> list[Loads]:
        """Return the loads f̃ of the checker for a time interval [a, b], as three Bernstein coefficients in time."""
        first, middle, last = (self._surface(t) for t in (a, (a + b) / 2, b))
        surfaces = first, 2 * middle - (first + last) / 2, last
        controls = self._loads.controls(a, b)
        return [Loads(self._force(f), surface) for f, surface in zip(controls, surfaces, strict=True)]

    def _force(self, control: list[checker.Poly]) -> Array:
        """Return a body force of the checker as in ``Loads.force``."""
        found = np.zeros((self.space.cells, 3, 6, 2))
        numbers = self._loads.on_cells(control)
        if numbers:
            force = np.reshape(np.array(numbers, dtype=float), (-1, 6, 2)) / 2.0**LOAD_BITS
            values = self._monomials(checker.SQUARE) @ (force / self._twice_area[:, None, None])[:, None]
            found[self.twins.cells] = np.linalg.pinv(self.space.force_shapes.T) @ values
        return found

    def _monomials(self, exponents: list[tuple[int, int, int]]) -> Array:
        """Return monomials on the reference triangle of the checker at the quadrature points of scikit-fem.

        Axes: cell of the checker, subtriangle of scikit-fem, point, monomial.
        """
        _, X, Y = np.moveaxis(self.space.barycentric[self.twins.corners], 1, 0)
        return np.stack([X**i * Y**j for i, j, _ in exponents], axis=-1).reshape(len(X), 3, -1, len(exponents))

    def _surface(self, time: Fraction) -> Array:
        """Return the traction f_2 at a time as in ``Loads.surface``, interpolated on every loaded edge."""
        found = np.zeros((len(self.space.lengths), 4, 2))
        here = self._loaded
        for n, backward, edge in zip(self._edges[here], self._backward[here], self.layout.loaded, strict=True):
            p, q = (self.exact.place(v) for v in edge)
            for i, share in enumerate(reversed(ON_EDGE) if backward else ON_EDGE):
                place = [a + share * (b - a) for a, b in zip(p, q, strict=True)]
                found[n, i] = [value_of(f, (*place, time)) for f in self.exact.boundary[edge].load]
        x = np.array(ON_EDGE, dtype=float)
        return np.linalg.solve(bernstein(3, np.array([1 - x, x])).T, found)

    def tractions(self, stress: EquilibratedStress) -> Array:
        """Return the Bernstein coefficients of tractions |e|σν on the edges, (edges, 4, 2).

        Edges are in the order of ``checker.Stresses``: contact, loaded, free. ν points to the right of an edge.
        """
        cartesian = stress.tractions[self._sides] @ self.space.frames[self._edges]
        along = np.where(self._backward[:, None, None], cartesian[:, ::-1], cartesian)
        return along * self.space.lengths[self._edges, None, None]

    def inner(self, values: Tensors) -> Array:
        """Return the nine inner numbers of every cell of a stress, (cells, 9).

        They are those coefficients of the stress on the reference triangle that tractions and forces do not determine.

        Args:
            values: the stress at the quadrature points of the space, (3, cells, Q).
        """
        of_thirds = np.moveaxis(values[:, self.twins.cells], 0, -1).reshape(len(self._adjugate), 3, -1, 3)
        coefficients = self._fit @ of_thirds
        # The stress on the reference triangle is σ̂ = F⁻¹ σ F⁻ᵀ det F, and the checker multiplies it by det F.
        A, E = self._adjugate, basis(2)
        hat = np.einsum("cik,Ikl,cjl,ctnI->ctnij", A, E, A, coefficients, optimize=True)
        component, third, monomial = self._free.T
        row, column = np.array([[0, 0], [1, 1], [0, 1]])[component].T
        found: Array = hat[np.arange(len(hat))[:, None], self.twins.corners[:, third], monomial, row, column]
        return found * self.exact.h

    def integers(self, tractions: Array, inner: Array, bits: int, coarse: int) -> tuple[list[int], list[int]]:
        """Return the integers by which a certificate stores a stress: tractions, and inner numbers of the cells.

        The tractions are rounded such that σ̃_ν ≤ 0 holds exactly on Γ3.

        Args:
            tractions, inner: the stress, as the methods with these names return it.
            bits: the number of binary digits of the unit of tractions.
            coarse: the unit of the inner numbers, and of the last two of the four modes on an edge that is neither
                loaded nor in contact, is 2^coarse times larger.
        """
        contact, loaded, free = np.split(tractions, [self._loaded.start, self._loaded.stop])
        n = self._normals[: len(contact), None]
        pressed = np.minimum((contact * n).sum(axis=2) / (n * n).sum(axis=2), 0)
        modes = np.linalg.solve(np.array(checker.MODES).T, free) / 2.0 ** (coarse * (np.arange(4)[:, None] > 1))
        numbers = np.concatenate([part.ravel() for part in (pressed, loaded, modes)]) * 2.0**bits
        return [int(x) for x in np.round(numbers)], [int(x) for x in np.round(inner * 2.0 ** (bits - coarse)).ravel()]


def value_of(formula: list[checker.Term], place: tuple[Fraction, ...]) -> float:
    """Return the value of a formula of the checker at a point (x, y, t) in space and time."""
    terms = [term(*map(checker.constant, place)).plain() for term in formula]
    return float(sum((p.get((0, 0, 0), Fraction(0)) for p in terms if p is not None), Fraction(0)))
