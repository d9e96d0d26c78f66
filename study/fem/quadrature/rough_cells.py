"""Cells in which the integrand is not smooth, in 2D: which these are, and rules graded to a vertex or to a line."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from skfem import Mesh

from manufactured.tensors import Array
from study.fem.mesh import MeshError, cell_volumes
from study.fem.quadrature.rules import GRADING, TOUCHING, CellRule, duffy, gauss, placed

Point = tuple[float, ...]


@dataclass(frozen=True)
class Line:
    """{x : direction·x = offset}; MeshError unless the direction is a unit vector."""

    direction: tuple[float, ...]
    offset: float

    def __post_init__(self) -> None:
        length = float(np.linalg.norm(self.direction))
        if abs(length - 1) > TOUCHING:
            raise MeshError(
                f"the direction {self.direction} of a line has the length {length:.9g}, expected 1; "
                "divide it and the offset by its length"
            )

    @property
    def tangent(self) -> Array:
        """The direction turned by a right angle, (2,)."""
        return np.array([-self.direction[1], self.direction[0]])

    def __str__(self) -> str:
        terms = " + ".join(f"{c:.4g} x{i}" for i, c in enumerate(self.direction, start=1) if abs(c) > TOUCHING)
        return f"{{{terms} = {self.offset:.4g}}}"


def rough_cells(mesh: Mesh, lines: Sequence[Line], points: Sequence[Point]) -> list[Array]:
    """The cells at each line and then at each point, which need a rule of their own.

    Raises:
        MeshError: two lines or points meet one cell, a point is no vertex, or either is given in 3D.
    """
    names = [*map(str, lines), *(f"the point {tuple(point)}" for point in points)]
    if mesh.dim() != 2 and names:
        raise MeshError(
            f"cells are cut and graded in 2D only, this 3D solution is rough at {', '.join(names)}; take a contact "
            "face without `rough`, a material without `steps` and a solution without `singular`"
        )
    found = [_touching(mesh, line) for line in lines] + [_around(mesh, point) for point in points]
    owner = np.full(mesh.t.shape[1], -1)
    for i, cells in enumerate(found):
        taken = cells[owner[cells] >= 0]
        if taken.size:
            place = ", ".join(f"{x:.3g}" for x in mesh.p[:, mesh.t[:, taken[0]]].mean(axis=1))
            raise MeshError(
                f"the cell around ({place}) meets two lines or points at which the solution is rough, "
                f"{names[owner[taken[0]]]} and {names[i]}, and cells are cut for one only; take a finer level, or "
                "move them apart where they cross"
            )
        owner[cells] = i
    return found


def _touching(mesh: Mesh, line: Line) -> Array:
    """Cells that a line crosses, or touches at an edge or a vertex: the integrand is singular there, too."""
    distance = (np.array(line.direction) @ mesh.p - line.offset)[mesh.t]
    near = TOUCHING * (distance.max(axis=0) - distance.min(axis=0))
    return np.flatnonzero((distance.min(axis=0) <= near) & (distance.max(axis=0) >= -near))


def _around(mesh: Mesh, point: Point) -> Array:
    """Cells with a singular point as a vertex."""
    apart = np.linalg.norm(mesh.p - np.array(point)[:, None], axis=0)
    vertex = int(apart.argmin())
    here = np.flatnonzero((mesh.t == vertex).any(axis=0))
    if apart[vertex] > TOUCHING * np.sqrt(cell_volumes(mesh).sum()):
        raise MeshError(
            f"the solution is singular at {tuple(point)}, which is not a vertex of the mesh (the nearest is "
            f"{apart[vertex]:.3g} away); list it as a vertex of the body"
        )
    return here


def fan_rule(mesh: Mesh, cells: Array, point: Point, degree: int) -> CellRule:
    """Duffy's rule on cells with a vertex at a point, exact to the degree; r^{-1} is smooth along the rays."""
    simplices = mesh.t[:, cells]
    vertex = np.linalg.norm(mesh.p[:, simplices] - np.array(point)[:, None, None], axis=0).argmin(axis=0)
    simplices = np.take_along_axis(simplices, (vertex + np.arange(3)[:, None]) % 3, axis=0)
    barycentric, weights = duffy(GRADING * (degree + 2) // 2, degree + 8, GRADING)
    return CellRule(cells, placed(mesh.p, simplices, barycentric), cell_volumes(mesh)[cells, None] * weights)


def cut_rule(mesh: Mesh, cells: Array, line: Line, degree: int) -> CellRule:
    """Cells cut into slabs between the line and parallels to it through the vertices.

    In coordinates (s, r), s the signed distance from the line and r along it, with vertices sorted by s, a triangle
    lies between its longest edge in s and the two others. Gauss in r, and in s after the substitution s = c + L ξ^8
    with c the end of the slab that is nearer to the line.
    """
    frame = _Frame.of(mesh, cells, line)
    slabs = [frame.slab(*_graded(left, right, degree), degree) for left, right in pairwise(frame.ends([0.0]))]
    return frame.rule(cells, slabs)


def sliced_rules(mesh: Mesh, fronts: Sequence[Line], but: Array, degree: int) -> Iterator[CellRule]:
    """Rules for the cells that fronts meet, cut along them, but for some cells (n,).

    A cell that two fronts of one direction meet is cut along both, one where fronts of two faces cross along the first.
    """
    left = np.ones(mesh.t.shape[1], dtype=bool)
    left[but] = False
    for direction in dict.fromkeys(front.direction for front in fronts):
        parallel = [front for front in fronts if front.direction == direction]
        met = np.zeros((len(parallel), len(left)), dtype=bool)
        for mine, front in zip(met, parallel, strict=True):
            mine[_touching(mesh, front)] = True
        met &= left
        for pattern in np.unique(met[:, met.any(axis=0)], axis=1).T:
            cells = np.flatnonzero((met == pattern[:, None]).all(axis=0))
            here = [front for front, one in zip(parallel, pattern, strict=True) if one]
            yield sliced_rule(mesh, cells, here, degree)
        left &= ~met.any(axis=0)


def sliced_rule(mesh: Mesh, cells: Array, lines: Sequence[Line], degree: int) -> CellRule:
    """Cells cut as in ``cut_rule`` along parallel lines, for what is smooth up to each of them: Gauss in s, too."""
    frame = _Frame.of(mesh, cells, lines[0])
    ends = frame.ends([line.offset - lines[0].offset for line in lines])
    x, w = gauss(degree // 2 + 2)
    widths = np.diff(ends, axis=0)[..., None]
    slabs = [
        frame.slab(left[:, None] + width * x, width * w, degree) for left, width in zip(ends, widths, strict=False)
    ]
    return frame.rule(cells, slabs)


@dataclass(frozen=True, eq=False)
class _Frame:
    """Triangles in coordinates (s, r) from a line and along it, vertices sorted by s: (3, n) each."""

    line: Line
    s: Array
    r: Array

    @classmethod
    def of(cls, mesh: Mesh, cells: Array, line: Line) -> _Frame:
        corners = mesh.p[:, mesh.t[:, cells]]
        s = np.einsum("d,dvn->vn", np.array(line.direction), corners) - line.offset
        r = np.einsum("d,dvn->vn", line.tangent, corners)
        order = np.argsort(s, axis=0)
        return cls(line, np.take_along_axis(s, order, 0), np.take_along_axis(r, order, 0))

    def ends(self, parallels: Sequence[float]) -> Array:
        """Where slabs end: at vertices and at parallels to the line in some distances, (3 + parallels, n), sorted."""
        low, high = self.s[0], self.s[2]
        return np.sort(np.vstack([self.s, *(np.clip(np.full_like(low, s), low, high) for s in parallels)]), axis=0)

    def slab(self, x: Array, weights: Array, degree: int) -> tuple[Array, ...]:
        """Points s, r and weights, (n, q) each, on the part of the triangles that a rule (n, p) in s covers."""
        s, (eta, we) = self.s, gauss(degree // 2 + 2)
        long = self._chord(x, 0, 2)
        # The last point: the first of a graded rule lies on the end of the slab but for rounding.
        short = np.where(x[:, -1:] <= s[1][:, None], self._chord(x, 0, 1), self._chord(x, 1, 2))
        across = long[..., None] + (short - long)[..., None] * eta
        weights = (weights * abs(short - long))[..., None] * we
        return tuple(part.reshape(len(x), -1) for part in (np.repeat(x[..., None], len(eta), axis=2), across, weights))

    def rule(self, cells: Array, slabs: Sequence[tuple[Array, ...]]) -> CellRule:
        """The rule that some slabs make together."""
        s, r, weights = (np.concatenate(parts, axis=1) for parts in zip(*slabs, strict=True))
        normal, tangent = np.array(self.line.direction)[:, None, None], self.line.tangent[:, None, None]
        return CellRule(cells, normal * (s + self.line.offset) + tangent * r, weights)

    def _chord(self, x: Array, low: int, high: int) -> Array:
        """r on the edge from vertex low to vertex high at s = x, (n, q)."""
        s, r = self.s, self.r
        length = s[high] - s[low]
        slope = np.divide(r[high] - r[low], length, out=np.zeros_like(length), where=length > 0)
        return r[low][:, None] + slope[:, None] * (x - s[low][:, None])


def _graded(left: Array, right: Array, degree: int) -> tuple[Array, Array]:
    """A rule (n, q) on left < s < right, graded to the end that is nearer to s = 0."""
    xi, wx = gauss(degree + GRADING)
    near_left = abs(left) <= abs(right)
    near, far = np.where(near_left, left, right)[:, None], np.where(near_left, right, left)[:, None]
    return near + (far - near) * xi**GRADING, abs(far - near) * GRADING * xi ** (GRADING - 1) * wx
