"""Rules on cells in which the integrand is not smooth, in 2D: graded to a vertex or to a line."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from skfem import Mesh

from manufactured.tensors import Array
from study.fem.line import Line
from study.fem.mesh import cell_volumes
from study.fem.quadrature.reference_rules import GRADING, duffy, gauss, placed
from study.fem.quadrature.rules import CellRule


def fan_rule(mesh: Mesh, cells: Array, point: tuple[float, ...], degree: int) -> CellRule:
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
    normal = np.array(line.direction)
    tangent = np.array([-normal[1], normal[0]])
    corners = mesh.p[:, mesh.t[:, cells]]
    s = np.einsum("d,dvn->vn", normal, corners) - line.offset
    r = np.einsum("d,dvn->vn", tangent, corners)
    order = np.argsort(s, axis=0)
    s, r = np.take_along_axis(s, order, 0), np.take_along_axis(r, order, 0)
    nodes = np.sort(np.vstack([s, np.clip(np.zeros_like(s[:1]), s[0], s[2])]), axis=0)
    slabs = [_slab(s, r, left, right, degree) for left, right in pairwise(nodes)]
    points = [
        normal[:, None, None, None] * (x + line.offset)[..., None] + tangent[:, None, None, None] * across
        for x, across, _ in slabs
    ]
    weights = [np.broadcast_to(w, across.shape) for _, across, w in slabs]
    return CellRule(
        cells,
        np.concatenate([p.reshape(2, len(cells), -1) for p in points], axis=2),
        np.concatenate([w.reshape(len(cells), -1) for w in weights], axis=1),
    )


def _slab(s: Array, r: Array, left: Array, right: Array, degree: int) -> tuple[Array, Array, Array]:
    """s (n, q), r (n, q, p) and weights (n, q, p) on the parts left < s < right of triangles, vertices (3, n) each."""

    def chord(x: Array, low: int, high: int) -> Array:
        """r on the edge from vertex low to vertex high at s = x, (n, q)."""
        length = s[high] - s[low]
        slope = np.divide(r[high] - r[low], length, out=np.zeros_like(length), where=length > 0)
        return r[low][:, None] + slope[:, None] * (x - s[low][:, None])

    (xi, wx), (eta, we) = gauss(degree + GRADING), gauss(degree // 2 + 2)
    near_left = abs(left) <= abs(right)
    near, far = np.where(near_left, left, right)[:, None], np.where(near_left, right, left)[:, None]
    x = near + (far - near) * xi**GRADING
    jacobian = abs(far - near) * GRADING * xi ** (GRADING - 1) * wx
    long = chord(x, 0, 2)
    middle = (left + right)[:, None] / 2
    short = np.where(middle <= s[1][:, None], chord(x, 0, 1), chord(x, 1, 2))
    across = long[..., None] + (short - long)[..., None] * eta
    return x, across, (jacobian * abs(short - long))[..., None] * we
