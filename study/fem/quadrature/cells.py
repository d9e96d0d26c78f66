"""Rules that cover every cell of a mesh once, with points that share coordinates along a contact face.

The cost of an exact solution is that of its formulas of (s, t). On a mesh without structure no two quadrature points
have the same s. Here they are moved to the lines s = jδ, with δ a power of two and 16 to 32 times smaller than the cell
(half of that where two faces share), so that cells have coordinates in common. Weights that change as little as
possible keep the rule exact for polynomials of the highest degree that so many weights allow, 2 for six points.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache, partial

import numpy as np
from skfem import Mesh

from manufactured.tensors import Array
from study.fem.mesh import barycentric_gradients, cell_volumes
from study.fem.quadrature.rough_cells import Line, Point, cut_rule, fan_rule, rough_cells
from study.fem.quadrature.rules import CellRule, placed, simplex_rule

BLOCK = 4096
"""Most ordinary cells in one rule, whose points fit a cache."""
SHIFT = 1 / 32
"""Most by which a barycentric coordinate of a point may change."""
TIE = 1e-9
"""Added to a binary logarithm before it is rounded down: equal cells get equal spacings in spite of rounding."""


def cell_rules(
    mesh: Mesh, degree: int, lines: Sequence[Line], points: Sequence[Point] = (), along: Sequence[Line] = ()
) -> list[CellRule]:
    """Rules that cover every cell once.

    Args:
        mesh: in 2D or, without lines and points, in 3D.
        degree: of the rule on ordinary cells, up to 19 in 2D, 8 in 3D; cells at a line or at a point have enough points
            for the same accuracy away from it.
        lines: where the integrand is rough.
        points: vertices of the mesh at which the integrand is singular.
        along: at most two lines, not parallel; points of ordinary cells get distances from them that many share.

    Raises:
        MeshError: from ``rough_cells``.
    """
    special = rough_cells(mesh, lines, points)
    made = [partial(cut_rule, mesh, line=line, degree=degree) for line in lines]
    made += [partial(fan_rule, mesh, point=point, degree=degree) for point in points]
    rules = [rule(cells=cells) for cells, rule in zip(special, made, strict=True) if cells.size]
    ordinary = np.ones(mesh.t.shape[1], dtype=bool)
    ordinary[np.concatenate([*special, np.empty(0, dtype=int)])] = False
    cells = np.flatnonzero(ordinary)
    barycentric, weights = simplex_rule(mesh.dim(), degree)
    volumes = cell_volumes(mesh)[:, None]
    gradients = barycentric_gradients(mesh) if along else None
    for block in (cells[start : start + BLOCK] for start in range(0, cells.size, BLOCK)):
        x, shares = placed(mesh.p, mesh.t[:, block], barycentric), weights
        if gradients is not None:
            x, shares = shared(mesh.p[:, mesh.t[:, block]], gradients[block], barycentric, weights, along)
        rules.append(CellRule(block, x, volumes[block] * shares))
    return rules


def shared(
    corners: Array, gradients: Array, barycentric: Array, weights: Array, lines: Sequence[Line]
) -> tuple[Array, Array]:
    """A rule on triangles whose points have few different distances from some lines: (2, n, q), (n, q) of sum 1.

    Args:
        corners: (2, 3, n).
        gradients: ∇λ_i, (n, 3, 2).
        barycentric, weights: the rule, (3, q) and (q,) of sum 1.
        lines: one or two, not parallel.
    """
    points = np.einsum("dvn,vq->dnq", corners, barycentric)
    moves = np.linalg.pinv(np.array([line.direction for line in lines])).T
    limit = min(SHIFT, float(barycentric.min()) / 2) / len(moves)
    new = np.broadcast_to(barycentric[:, None], (3, *points.shape[1:]))
    for line, move in zip(lines, moves, strict=True):
        slopes = gradients @ move
        # Moving by δ/2 changes λ_i by half of δ ∇λ_i·m.
        spacing = np.exp2(np.floor(np.log2(2 * limit / abs(slopes).max(axis=1)) + TIE))[:, None]
        along = np.einsum("d,dnq->nq", line.direction, points) - line.offset
        shift = np.rint(along / spacing) * spacing - along
        points = points + move[:, None, None] * shift
        new = new + slopes.T[..., None] * shift
    return points, weights + _correction(new, weights)


def _correction(barycentric: Array, weights: Array) -> Array:
    """The least change of weights, relative to them, that restores exactness at points (3, n, q): (n, q)."""
    degree = (math.isqrt(8 * len(weights) + 1) - 3) // 2
    monomials, integrals = _monomials(degree)
    products = np.ones((barycentric.shape[1], len(monomials), len(weights)))
    for lam, exponents in zip(barycentric, monomials.T, strict=True):
        powers = lam[:, None] ** np.arange(degree + 1)[:, None]
        products *= powers[:, exponents]
    missing = integrals - products @ weights
    multipliers = np.linalg.solve((products * weights) @ np.swapaxes(products, 1, 2), missing[..., None])
    return weights * (np.swapaxes(multipliers, 1, 2) @ products)[:, 0]


@lru_cache
def _monomials(degree: int) -> tuple[Array, Array]:
    """Exponents α of the λ^α with |α| = degree, which span the polynomials of a degree, and their means on T.

    ∫_T λ^α dx = 2|T| α!/(|α| + 2)!.
    """
    exponents = [(i, j, degree - i - j) for i in range(degree + 1) for j in range(degree + 1 - i)]
    means = [2 * math.prod(map(math.factorial, each)) / math.factorial(degree + 2) for each in exponents]
    return np.array(exponents), np.array(means)
