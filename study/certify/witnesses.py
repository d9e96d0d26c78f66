"""The witnesses of a certificate: what ``study.bound`` computes, rounded so that its signs hold exactly.

ũ and σ̃ are those of the bound, with two differences: the stress balances the loads f̃ of the checker, not projections,
and σ̃ is given by its tractions on edges and nine inner numbers a cell, from which the checker makes a stress
whose tractions are exactly continuous. Rounding need not respect more than signs: what is not balanced is paid for.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from manufactured.tensors import Array, Tensors
from study.bound.discretisation import Discretisation
from study.certify import checker
from study.certify.rational_mesh import Twins
from study.stresses.composite import SIDES
from study.stresses.loads import Loads

FINE, COARSE = 38, 20
"""Bits of the numbers on which balance rests, and of the others, relative to the largest traction."""
DISPLACEMENT = 38
"""Bits of ũ, relative to its largest value."""
EDGE_PLACES = np.array([[math.comb(3, i) * (n / 3) ** i * (1 - n / 3) ** (3 - i) for i in range(4)] for n in range(4)])
"""Values at 0, 1/3, 2/3, 1 from Bernstein coefficients of degree 3."""


def bits_below(size: float, digits: int) -> int:
    """b with 2^{−b} about 2^{−digits} times a size."""
    return max(digits - math.ceil(math.log2(size)), 1) if size > 0 else 1


@dataclass(frozen=True, eq=False)
class AdmissibleRounding:
    """Displacements as integers whose signs on Γ1 and Γ3 hold exactly."""

    problem: checker.Problem
    mesh: checker.Mesh
    bits: int

    def __call__(self, values: Array) -> list[int]:
        """(vertices and edges, 2) → integers over 2^bits."""
        found = np.round(values * 2.0**self.bits).astype(object)
        rounded = [[int(c) for c in row] for row in found]
        for n, normals in self._normals.items():
            rounded[n] = self._admissible(rounded[n], normals)
        return [c for row in rounded for c in row]

    @cached_property
    def _normals(self) -> dict[int, list[tuple[int, int]]]:
        """Integer normals at the numbers on Γ3, none at those on Γ1."""
        found: dict[int, list[tuple[int, int]]] = {}
        clamped = set()
        for edge, part in self.mesh.parts.items():
            numbers = (*edge, len(self.mesh.points) + self.mesh.numbers[edge])
            start, end = self.problem.sides[part]
            along = checker.minus(end, start)
            scale = math.lcm(along[0].denominator, along[1].denominator)
            x, y = (int(c * scale) for c in along)
            normal = y // math.gcd(x, y), -x // math.gcd(x, y)
            for n in numbers:
                if self.problem.kinds[part] == "clamped":
                    clamped.add(n)
                elif self.problem.kinds[part] == "contact" and normal not in found.setdefault(n, []):
                    found[n].append(normal)
        return found | {n: [] for n in clamped}

    @staticmethod
    def _admissible(value: list[int], normals: list[tuple[int, int]]) -> list[int]:
        """A nearby integer vector with value·N ≤ 0 for one or two normals; 0 without normals."""
        if not normals:
            return [0, 0]
        (x, y), *more = normals
        # Directions in which the one product, or the other, stays as it is.
        p, q = ((-y, x), (x, y)) if not more else ((-more[0][1], more[0][0]), (-y, x))
        a, b = np.linalg.solve(np.array([p, q], dtype=float).T, np.array(value, dtype=float))
        a, b = round(a), round(b)
        if not more:
            b = min(b, 0)
        else:
            a = _with_sign(a, p[0] * x + p[1] * y)
            b = _with_sign(b, q[0] * more[0][0] + q[1] * more[0][1])
        return [a * p[0] + b * q[0], a * p[1] + b * q[1]]


def _with_sign(a: int, product: int) -> int:
    """a, or 0 where a · product is positive."""
    return min(a, 0) if product > 0 else max(a, 0)


class StressEncoder:
    """Stresses of the study as tractions and inner numbers of the checker, and loads of the checker as the study's."""

    def __init__(self, problem: checker.Problem, twins: Twins, fine: Discretisation) -> None:
        self.problem, self.twins, self.fine = problem, twins, fine
        self.exact = twins.exact
        element = checker.element()
        self.rows = np.array(element.rows, dtype=float) / element.K
        self.squares = np.array(element.squares, dtype=float)
        self.sides = np.array(self.exact.sides)
        points = np.array(self.exact.points, dtype=float) / self.exact.denominator
        self.corners = points[np.array(self.exact.cells)]  # (cells, 3, 2)
        F = np.stack([self.corners[:, 1] - self.corners[:, 0], self.corners[:, 2] - self.corners[:, 0]], axis=2)
        self.F, self.J = F, np.linalg.det(F)
        self.adjugate = np.linalg.inv(F) * self.J[:, None, None]
        edges = np.array(self.exact.edges)
        along = points[edges[:, 1]] - points[edges[:, 0]]
        self.normals = np.stack([along[:, 1], -along[:, 0]], axis=1)
        self.lengths = np.linalg.norm(along, axis=1)
        cells = np.array(self.exact.cells)
        # Whether a side of a cell runs from its lower vertex to its higher one.
        self.forward = cells[:, [1, 2, 0]] < cells[:, [2, 0, 1]]
        kinds = [problem.kinds[self.exact.parts[e]] if e in self.exact.parts else "" for e in self.exact.edges]
        self.contact = np.array([kind == "contact" for kind in kinds])
        self.free = np.array([kind in ("", "clamped") for kind in kinds], dtype=bool)
        self.modes = np.array([[float(c) for c in row] for row in checker.legendre(checker.CUBICS)])
        self.to_orthogonal = np.array([[float(c) for c in row] for row in checker.orthogonal()[0]])

    def loads(self, load: checker.Load, bits: int) -> Loads:
        """f̃ as the study takes loads."""
        space, unit = self.fine.stresses, 2.0**bits
        force = np.zeros((space.cells, 3, 6, 2))
        if load.force:
            nodal = self.nodal(load, bits) / self.J[:, None, None]
            theirs = np.empty_like(nodal)
            cells = np.arange(len(nodal))[:, None]
            theirs[cells, self.twins.corners] = nodal[:, :3]
            theirs[cells, 3 + self.twins.corners] = nodal[:, 3:]
            force[self.twins.cells] = np.einsum("tan,cnd->ctad", _polar_forms(), theirs)
        surface = np.zeros((len(space.lengths), 4, 2))
        for e, values in load.traction.items():
            coefficients = np.linalg.solve(EDGE_PLACES, np.array(values, dtype=float).reshape(4, 2)) / unit
            mine = coefficients[::-1] if self.twins.turned[e] else coefficients
            surface[self.twins.edges[e]] = mine / self.lengths[e]
        return Loads(force, surface)

    def nodal(self, load: checker.Load, bits: int) -> Array:
        """Twice the area times f̃_0 at the nodes, (cells, 6, 2)."""
        if not load.force:
            return np.zeros((len(self.J), 6, 2))
        return np.array(load.force, dtype=float).reshape(-1, 6, 2) / 2.0**bits

    def numbers(self, found: tuple[Array, Array, Array], bits: int, coarse: int) -> tuple[list[int], list[int]]:
        """The integers of the certificate; those on Γ3 are of the right sign."""
        tractions, stress, load = found
        unit, low = 2.0**bits, 2.0**coarse
        n = self.normals[self.contact][:, None]
        tau = np.round(np.minimum((tractions[self.contact] * n).sum(axis=2) / (n * n).sum(axis=2), 0) * unit)
        modes = np.einsum("mi,eid->emd", self.modes, tractions)
        given = np.round(modes[self.free].reshape(-1, 8) * unit / np.where(np.arange(8) < 4, 1, low))
        rounded = modes.copy()
        rounded[self.free] = (given * np.where(np.arange(8) < 4, 1, low) / unit).reshape(-1, 4, 2)
        rounded[self.contact] = np.einsum("mi,ei,ed->emd", self.modes, tau / unit, self.normals[self.contact])
        inner = np.round(self.inner(stress, rounded, load) * unit / low)
        return [int(c) for c in (*tau.ravel(), *given.ravel())], [int(c) for c in inner.ravel()]

    def bernstein(self, values: Tensors) -> Array:
        """Values of a stress at the points of the study → (cells, 3 thirds, 10, 3) of Voigt's components."""
        coefficients = np.moveaxis(self.fine.stresses.coefficients(values).reshape(3, -1, 3, 10), 0, 3)
        coefficients = coefficients / np.array([1, 1, np.sqrt(2)])
        of_cells = coefficients[self.twins.cells]
        cells, found = np.arange(len(of_cells)), np.empty_like(of_cells)
        swap = [checker.CUBIC.index((b, a, c)) for a, b, c in checker.CUBIC]
        for third in range(3):
            local = self.twins.corners[:, third]
            mine = of_cells[cells, local]
            # Their third runs from SIDES[local][0]; ours from the next corner.
            first: Array = np.array([a for a, _ in SIDES])[local]
            turned = first != self.twins.corners[:, (third + 1) % 3]
            mine[turned] = mine[turned][:, swap]
            found[:, third] = mine
        return found

    def tractions(self, stress: Array) -> Array:
        """σN of the edges in Bernstein form from the lower vertex, (edges, 4, 2), means of both sides."""
        places = [checker.CUBIC.index((3 - i, i, 0)) for i in range(4)]
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

    def inner(self, stress: Array, modes: Array, load: Array) -> Array:
        """The nine inner numbers of each cell that are left of a stress when its tractions and loads are taken off.

        modes: σN in ``LEGENDRE`` (edges, 4, 2); load: twice the area times f̃ at the nodes, (cells, 6, 2).
        """
        signs = np.array([1.0, -1.0, 1.0, -1.0])[:, None]
        given = [
            np.where(self.forward[:, [i]][..., None], modes[self.sides[:, i]], -signs * modes[self.sides[:, i]])
            for i in range(3)
        ]
        t = np.einsum("cij,csnj->csni", self.adjugate, np.stack(given, axis=1)).reshape(len(stress), -1)
        g = np.einsum("cij,cnj->cni", self.adjugate, load).reshape(len(stress), -1)
        inputs = np.concatenate([t, g], axis=1)
        tensor = np.empty((*stress.shape[:-1], 2, 2))
        tensor[..., 0, 0], tensor[..., 1, 1] = stress[..., 0], stress[..., 1]
        tensor[..., 0, 1] = tensor[..., 1, 0] = stress[..., 2]
        # σ̂ det F = F⁻¹ σ F⁻ᵀ (det F)².
        X = np.einsum("cij,ctajk,clk->ctail", self.adjugate, tensor, self.adjugate, optimize=True)
        voigt = np.stack([X[..., 0, 0], X[..., 1, 1], X[..., 0, 1]])
        wanted = np.einsum("na,Icta->Ictn", self.to_orthogonal, voigt).reshape(3, len(stress), 30)
        left = (wanted - np.einsum("Inj,cj->Icn", self.rows[:, :, :36], inputs)) * self.exact.denominator
        weights = np.sqrt(self.squares)
        basis = (self.rows[:, :, 36:] * weights[None, :, None]).reshape(90, 9)
        return np.moveaxis(left * weights, 0, 1).reshape(len(stress), 90) @ np.linalg.pinv(basis).T


def _polar_forms() -> Array:
    """Bernstein coefficients of degree 2 on the thirds from six nodal values, (3 thirds, 6, 6)."""
    found = np.zeros((3, 6, 6))
    for third in range(3):
        vertices = [checker.CORNERS[(third + 1) % 3], checker.CORNERS[(third + 2) % 3], checker.CENTRE]
        for row, beta in enumerate(checker.SQUARE):
            p, q = (vertices[v] for v, count in enumerate(beta) for _ in range(count))
            middle = (p[0] + q[0]) / 2, (p[1] + q[1]) / 2
            for n, shape in enumerate(checker.nodal()):
                ends = checker.value(shape, p) + checker.value(shape, q)
                found[third, row, n] = float(2 * checker.value(shape, middle) - ends / 2)
    return found
