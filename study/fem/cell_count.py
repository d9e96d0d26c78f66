"""How many cells a mesh has, and so its size h, without making the mesh.

h = (d! |Ω| / number of cells)^{1/d} (``mesh.size``), so a count is all that is needed: d! n^d simplices of the grid,
4 n² triangles with both diagonals. By Euler's formula a triangulation of a polygon has 2 V − B − 2 triangles, V points
of which B lie on the boundary, wherever the points are: unstructured meshes are counted before they are made, graded
ones are those with other points.
"""

from __future__ import annotations

from math import factorial

from manufactured.body import Body
from study.fem.mesh import CrissCross, Graded, MeshFamily, OneDiagonal, Shaken, Unstructured


def cell_count(family: MeshFamily, body: Body, n: int) -> int:
    """The number of cells of the mesh of a level."""
    if isinstance(family, OneDiagonal | Shaken):
        return factorial(body.dim) * n**body.dim
    if isinstance(family, CrissCross):
        return 4 * n**2
    if isinstance(family, Unstructured | Graded):
        boundary, *others = (Unstructured() if isinstance(family, Graded) else family).points(body, n)
        return int(boundary.shape[1] + 2 * sum(points.shape[1] for points in others) - 2)
    return int(family(body, n).t.shape[1])


def size_of(family: MeshFamily, body: Body, n: int) -> float:
    """h of the mesh of a level."""
    return float((factorial(body.dim) * body.measure / cell_count(family, body, n)) ** (1 / body.dim))
