"""The witnesses of a certificate: the displacement ũ and the stress σ̃ of ``study.bound``, rounded to integers.

From these two fields the checker computes an error bound. Rounding must keep them admissible: the signs of ũ_ν and σ̃_ν
on the contact boundary Γ3 must be right exactly. The balance of forces need not be exact, because the checker adds the
effect of unbalanced loads to the bound.

σ̃ differs from the stress that ``study.bound`` uses in two ways. It balances the loads f̃ of the checker, not the
projected loads. And it is given by its tractions on the edges and by nine numbers for each cell, called inner numbers,
from which the checker makes a stress with exactly continuous tractions.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property

import numpy as np

from manufactured.tensors import Array, Tensors
from study.bound.discretisation import Discretisation
from study.certify import checker
from study.certify.constants import GIVEN, INNER, bernstein, columns
from study.certify.statement import Twins
from study.stresses.composite import SIDES, indices
from study.stresses.loads import Loads

FINE, COARSE = 38, 20
"""Numbers of binary digits of a stress, relative to the largest traction.

``FINE`` is for the numbers on which the balance of forces depends, ``COARSE`` for all others.
"""
DISPLACEMENT = 38
"""Number of binary digits of the displacement ũ, relative to its largest value."""
EDGE_PLACES = np.array([[math.comb(3, i) * (n / 3) ** i * (1 - n / 3) ** (3 - i) for i in range(4)] for n in range(4)])
"""Matrix from the Bernstein coefficients of a cubic polynomial to its values at 0, 1/3, 2/3 and 1."""
CUBICS = indices(3)
"""The multi-indices of the cubic Bernstein polynomials on a subtriangle of a triangle."""
LOAD_BITS = 60
"""Number of binary digits to which the body forces here agree with the body forces of the checker."""
Edge = tuple[int, int]


def bits_below(size: float, digits: int) -> int:
    """Return the exponent b of a unit 2^{−b} that is about 2^{−digits} times a given size."""
    return max(digits - math.ceil(math.log2(size)), 1) if size > 0 else 1


@dataclass(frozen=True, eq=False)
class AdmissibleRounding:
    """Rounds displacements to integers over 2^bits that are exactly admissible: v = 0 on Γ1, and v·ν ≤ 0 on Γ3.

    Attributes:
        mesh: the mesh of the checker.
        bits: the number of binary digits behind the point.
    """

    mesh: checker.Mesh
    bits: int

    def __call__(self, values: Array) -> list[int]:
        """Return the rounded coefficients of a displacement as one list of integers, x and y in turn.

        Args:
            values: the coefficients at the vertices, then at the edges, (vertices + edges, 2).
        """
        found = np.round(values * 2.0**self.bits).astype(object)
        rounded = [[int(c) for c in row] for row in found]
        for n, normals in self._normals.items():
            rounded[n] = self._admissible(rounded[n], normals)
        return [c for row in rounded for c in row]

    @cached_property
    def _normals(self) -> dict[int, list[tuple[int, int]]]:
        """For each node on Γ3 or Γ1, the normals of Γ3 at this node as integer vectors; no normals at nodes on Γ1."""
        found: dict[int, list[tuple[int, int]]] = {}
        clamped = set()
        for edge, side in self.mesh.boundary.items():
            scale = math.lcm(*(c.denominator for c in side.normal))
            x, y = (int(c * scale) for c in side.normal)
            normal = x // math.gcd(x, y), y // math.gcd(x, y)
            for n in self.mesh.nodes_of(edge):
                if side.kind == "clamped":
                    clamped.add(n)
                elif side.kind == "contact" and normal not in found.setdefault(n, []):
                    found[n].append(normal)
        return found | {n: [] for n in clamped}

    @staticmethod
    def _admissible(value: list[int], normals: list[tuple[int, int]]) -> list[int]:
        """Return an integer vector near ``value`` with value·N ≤ 0 for one or two normals N.

        If there are no normals, the zero vector is returned.
        """
        if not normals:
            return [0, 0]
        x, y = normals[0]
        if len(normals) == 1:
            # The first direction runs along the side, and the second one is normal to it, so only the second factor has
            # a sign.
            p, q, signs = (-y, x), (x, y), (0, 1)
        else:
            # Each direction is orthogonal to one of the two normals, so each factor affects only one condition.
            (u, v) = normals[1]
            p, q = (-v, u), (-y, x)
            signs = p[0] * x + p[1] * y, q[0] * u + q[1] * v
        factors = np.linalg.solve(np.array([p, q], dtype=float).T, np.array(value, dtype=float))
        a, b = (
            round(factor) if not sign else min(round(factor), 0) if sign > 0 else max(round(factor), 0)
            for factor, sign in zip(factors, signs, strict=True)
        )
        return [a * p[0] + b * q[0], a * p[1] + b * q[1]]


@cache
def element() -> checker.Element:
    """Return the reference element of the stresses as the checker reads it."""
    return checker.Element.of(columns())


@dataclass(frozen=True)
class Load:
    """The loads f̃ of the checker at one time, in double precision.

    Attributes:
        force: twice the area of the cell times the body force f̃_0, as coefficients of six monomials, (cells, 6, 2).
        surface: the length of the edge times the traction f̃_2 on loaded edges, as four Bernstein coefficients of a
            cubic, (loaded edges, 4, 2).
    """

    force: Array
    surface: Array


class StressEncoder:
    """Converts stresses of ``study.bound`` to integers for the checker, and loads of the checker to projected loads.

    Args:
        problem: the problem, as the checker reads it.
        twins: the mesh, in the checker and in scikit-fem.
        fine: the discretisation of ``study.bound`` on this mesh.
    """

    def __init__(self, problem: checker.Problem, twins: Twins, fine: Discretisation) -> None:
        self.problem, self.twins, self.fine = problem, twins, fine
        self.exact = twins.exact
        self.layout = checker.Stresses(self.exact, {"bits": 1, "coarse": 0}, element())
        self.rows = np.array(element().rows, dtype=float).reshape(3, 30, 45) / element().over
        gram = np.array(element().gram, dtype=float).reshape(3, 10, 10) / element().unit
        self.roots = np.linalg.cholesky(gram)
        self.vertices = twins.triangles
        points = np.array(self.exact.points, dtype=float) / self.exact.h
        self.corners = points[self.vertices]  # shape (cells, 3, 2)
        F = np.stack([self.corners[:, 1] - self.corners[:, 0], self.corners[:, 2] - self.corners[:, 0]], axis=2)
        self.F, self.J = F, np.linalg.det(F)
        self.adjugate = np.linalg.inv(F) * self.J[:, None, None]
        edges = np.array(self.exact.edges)
        along = points[edges[:, 1]] - points[edges[:, 0]]
        self.normals = np.stack([along[:, 1], -along[:, 0]], axis=1)
        self.lengths = np.linalg.norm(along, axis=1)
        self.number = {edge: n for n, edge in enumerate(self.exact.edges)}
        self.sides = np.array([cell.nodes[3:] for cell in self.exact.cells]) - len(points)
        # Tractions are stored from the vertex of lower number on. These flags say whether a side of a cell runs that
        # way.
        self.forward = self.vertices[:, [1, 2, 0]] < self.vertices[:, [2, 0, 1]]
        self.to_monomials = np.array(
            [[[float(p.get(key, 0)) for p in bernstein(third)] for key in checker.CUBIC] for third in range(3)]
        )

    def loads(self, a: Fraction, b: Fraction) -> list[Load]:
        """Return the loads f̃ of the checker for a time interval [a, b], as three Bernstein coefficients in time."""
        controls = [self._exact.on_cells(control) for control in self._exact.controls(a, b)]
        inside = [
            np.array(found, dtype=float).reshape(-1, 6, 2) / 2.0**LOAD_BITS if found else np.zeros((len(self.J), 6, 2))
            for found in controls
        ]
        first, middle, last = (self._surface(t) for t in (a, (a + b) / 2, b))
        outside = [first, 2 * middle - (first + last) / 2, last]
        return [Load(f, g) for f, g in zip(inside, outside, strict=True)]

    @cached_property
    def _exact(self) -> checker.Loads:
        return checker.Loads(self.problem, self.exact, LOAD_BITS)

    def _surface(self, time: Fraction) -> Array:
        """Return the traction ``Load.surface`` at a time.

        On every loaded edge it is the cubic polynomial that interpolates |e| f_2 at the relative positions 0, 1/3, 2/3
        and 1.
        """
        found = np.zeros((len(self.layout.loaded), 4, 2))
        for n, edge in enumerate(self.layout.loaded):
            p, q = (self.exact.place(v) for v in edge)
            for i in range(4):
                place = [a + Fraction(i, 3) * (b - a) for a, b in zip(p, q, strict=True)]
                found[n, i] = [value_of(f, (*place, time)) for f in self.exact.boundary[edge].load]
            found[n] *= self.lengths[self.number[min(edge), max(edge)]]
        return np.linalg.solve(EDGE_PLACES, found)

    def study_loads(self, load: Load) -> Loads:
        """Convert loads of the checker to the class ``study.stresses.loads.Loads``."""
        space = self.fine.stresses
        nodal = np.einsum("nm,cmd->cnd", [_square(place) for place in PLACES], load.force) / self.J[:, None, None]
        theirs, force = np.empty_like(nodal), np.zeros((space.cells, 3, 6, 2))
        cells = np.arange(len(nodal))[:, None]
        theirs[cells, self.twins.corners] = nodal[:, :3]
        theirs[cells, 3 + self.twins.corners] = nodal[:, 3:]
        force[self.twins.cells] = np.einsum("tan,cnd->ctad", _polar_forms(), theirs)
        surface = np.zeros((len(space.lengths), 4, 2))
        for edge, values in zip(self.layout.loaded, load.surface, strict=True):
            e = self.number[min(edge), max(edge)]
            forward = self.twins.turned[e] == (edge[0] > edge[1])
            surface[self.twins.edges[e]] = (values if forward else values[::-1]) / self.lengths[e]
        return Loads(force, surface)

    def numbers(self, stress: Array, load: Load, bits: int, coarse: int) -> tuple[list[int], list[int]]:
        """Return the integers by which a certificate stores a stress: tractions, and inner numbers of the cells.

        The tractions are rounded such that σ̃_ν ≤ 0 holds exactly on Γ3.

        Args:
            stress: the stress in Bernstein form, as ``bernstein`` returns it.
            load: the load that it balances.
            bits: the number of binary digits of the unit of tractions.
            coarse: the unit of the inner numbers, and of the last two of the four modes on an edge that is neither
                loaded nor in contact, is 2^coarse times larger.
        """
        layout, T, unit = self.layout, self.tractions(stress), 2.0**bits
        n = np.array([self.exact.along(edge) for edge in layout.contact])[:, None, ::-1] * [1, -1] / self.exact.h
        mine, others = (self._flipped(T[self._numbers(edges)], edges) for edges in (layout.contact, layout.free))
        tau = np.round(np.minimum((mine * n).sum(axis=2) / (n * n).sum(axis=2), 0) * unit)
        loaded = np.round(load.surface * unit)
        modes, units = np.array(checker.MODES), unit / 2.0 ** (coarse * (np.arange(4)[:, None] > 1))
        free = np.round(np.linalg.solve(modes.T, others) * units)
        rounded = np.zeros_like(T)
        parts = ((layout.contact, tau[..., None] * n / unit), (layout.loaded, loaded / unit))
        for edges, values in (*parts, (layout.free, modes.T @ (free / units))):
            rounded[self._numbers(edges)] = self._flipped(values, edges)
        inner = np.round(self.inner(stress, rounded, load.force) * unit / 2.0**coarse)
        return [int(c) for part in (tau, loaded, free) for c in part.ravel()], [int(c) for c in inner.ravel()]

    def _numbers(self, edges: list[Edge]) -> list[int]:
        """Return the numbers of edges that are given by their two vertices, in any order."""
        return [self.number[min(edge), max(edge)] for edge in edges]

    @staticmethod
    def _flipped(values: Array, edges: list[Edge]) -> Array:
        """Reverse the direction of tractions on edges whose first vertex has the higher number."""
        flip = np.array([a > b for a, b in edges], dtype=bool)[:, None, None]
        return np.where(flip, -values[:, ::-1], values)

    def bernstein(self, values: Tensors) -> Array:
        """Return a stress in Bernstein form with Voigt's components, from its values at the quadrature points.

        The shape is (3, cells, Q) → (cells, 3, 10, 3). Axes of the result: cell in the order of the checker,
        subtriangle, Bernstein polynomial, component.
        """
        coefficients = np.moveaxis(self.fine.stresses.coefficients(values).reshape(3, -1, 3, 10), 0, 3)
        coefficients = coefficients / np.array([1, 1, np.sqrt(2)])
        of_cells = coefficients[self.twins.cells]
        cells, found = np.arange(len(of_cells)), np.empty_like(of_cells)
        swap = [CUBICS.index((b, a, c)) for a, b, c in CUBICS]
        for third in range(3):
            local = self.twins.corners[:, third]
            mine = of_cells[cells, local]
            # In ``study.stresses`` a subtriangle starts at the vertex SIDES[local][0], in the checker at the next
            # corner, so some are reversed.
            first: Array = np.array([a for a, _ in SIDES])[local]
            turned = first != self.twins.corners[:, (third + 1) % 3]
            mine[turned] = mine[turned][:, swap]
            found[:, third] = mine
        return found

    def tractions(self, stress: Array) -> Array:
        """Return the tractions of all edges in Bernstein form, (edges, 4, 2).

        Every edge runs from the vertex of lower number to the vertex of higher number. On an inner edge the result is
        the mean of the tractions of both cells.

        Args:
            stress: a result of ``bernstein``.
        """
        places = [CUBICS.index((3 - i, i, 0)) for i in range(4)]
        found, count = np.zeros((len(self.normals), 4, 2)), np.zeros(len(self.normals))
        for side in range(3):
            e, forward = self.sides[:, side], self.forward[:, side]
            s = stress[:, side][:, places]
            s = np.where(forward[:, None, None], s, s[:, ::-1])
            n = self.normals[e][:, None]
            T = np.stack(
                [s[..., 0] * n[..., 0] + s[..., 2] * n[..., 1], s[..., 2] * n[..., 0] + s[..., 1] * n[..., 1]], axis=2
            )
            np.add.at(found, e, T)
            np.add.at(count, e, 1)
        return found / count[:, None, None]

    def inner(self, stress: Array, T: Array, force: Array) -> Array:
        """Return the nine inner numbers of every cell, which with tractions and loads determine a stress, (cells, 9).

        The part of the stress that tractions and loads determine is subtracted. The inner numbers are the coordinates
        of the rest, by best approximation in L².

        Args:
            stress: a result of ``bernstein``.
            T: the tractions of the edges in Bernstein form, (edges, 4, 2).
            force: the body force, as in ``Load.force``, (cells, 6, 2).
        """
        given = [
            np.where(self.forward[:, i, None, None], T[self.sides[:, i]], -T[self.sides[:, i]][:, ::-1])
            for i in range(3)
        ]
        inputs = np.concatenate([*given, force], axis=1)
        pulled = np.einsum("cij,cnj->cni", self.adjugate, inputs).reshape(len(stress), -1)
        tensor = np.empty((*stress.shape[:-1], 2, 2))
        tensor[..., 0, 0], tensor[..., 1, 1] = stress[..., 0], stress[..., 1]
        tensor[..., 0, 1] = tensor[..., 1, 0] = stress[..., 2]
        # The inner numbers refer to the reference triangle, so the stresses are transformed: σ̂ det F = F⁻¹ σ F⁻ᵀ (det
        # F)².
        hat = np.einsum("cij,ctajk,clk->ctail", self.adjugate, tensor, self.adjugate, optimize=True)
        voigt = np.stack([hat[..., 0, 0], hat[..., 1, 1], hat[..., 0, 1]])
        wanted = np.einsum("tna,Icta->Ictn", self.to_monomials, voigt)
        rows = self.rows.reshape(3, 3, 10, 45)
        left = wanted - np.einsum("Itnj,cj->Ictn", rows[..., :GIVEN], pulled)
        # The Cholesky factors turn norms in L² into Euclidean lengths, so that least squares give the best
        # approximation.
        left = np.einsum("tnm,Ictn->cItm", self.roots, left).reshape(len(stress), 90) * self.exact.h
        basis = np.einsum("tnm,Itnj->Itmj", self.roots, rows[..., GIVEN:]).reshape(90, INNER)
        return left @ np.linalg.pinv(basis).T


def value_of(formula: list[checker.Term], place: tuple[Fraction, ...]) -> float:
    """Return the value of a formula of the checker at a point (x, y, t) in space and time."""
    terms = [term(*map(checker.constant, place)).plain() for term in formula]
    return float(sum((p.get((0, 0, 0), Fraction(0)) for p in terms if p is not None), Fraction(0)))


PLACES = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.5), (0.0, 0.5), (0.5, 0.0)]
"""The points at which a quadratic function is given.

They are the vertices of the reference triangle, then the midpoints of the opposite sides in the same order.
"""


def _square(place: tuple[float, float]) -> Array:
    """Return the values at a point of the six monomials of degree 2 or less."""
    return np.array([place[0] ** i * place[1] ** j for i, j, _ in checker.SQUARE])


def _polar_forms() -> Array:
    """Return matrices from six nodal values of a quadratic function to its Bernstein coefficients on subtriangles.

    The barycentre divides the triangle into three subtriangles. The shape is (3, 6, 6). Axes: subtriangle, Bernstein
    coefficient, nodal value. The coefficients are values of the polar form of the function.
    """
    found, to_monomials = np.zeros((3, 6, 6)), np.linalg.inv([_square(place) for place in PLACES])
    corners, centre = np.array(PLACES[:3]), np.array([1 / 3, 1 / 3])
    for third in range(3):
        vertices = [corners[(third + 1) % 3], corners[(third + 2) % 3], centre]
        for row, beta in enumerate(indices(2)):
            p, q = (vertices[v] for v, count in enumerate(beta) for _ in range(count))
            found[third, row] = (2 * _square((p + q) / 2) - (_square(p) + _square(q)) / 2) @ to_monomials
    return found
