"""Rules that cover every cell of a mesh once."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from skfem import Mesh

from manufactured.tensors import Array
from study.fem.line import Line
from study.fem.mesh import barycentric_gradients, cell_volumes
from study.fem.quadrature.graded_rules import cut_rule, fan_rule
from study.fem.quadrature.reference_rules import placed, simplex_rule
from study.fem.quadrature.rules import CellRule
from study.fem.quadrature.sharing import shared
from study.fem.quadrature.singular_cells import rough_cells


def cell_rules(
    mesh: Mesh,
    degree: int,
    lines: Sequence[Line],
    points: Sequence[tuple[float, ...]] = (),
    along: Sequence[Line] = (),
    *,
    block: int = 4096,
) -> list[CellRule]:
    """Rules that cover every cell once, in blocks of cells that fit a cache.

    The degree is that of the rule on ordinary cells; cells at a line or at a point have enough points
    for the same accuracy away from it.

    Args:
        mesh: the mesh.
        degree: up to 8 in 3D, 19 in 2D.
        lines: where the integrand is rough, in 2D.
        points: vertices of the mesh at which the integrand is singular, in 2D.
        along: at most two lines, not parallel, in 2D; points of ordinary cells get distances from them that many share.
        block: most ordinary cells in one rule.

    Raises:
        MeshError: from ``rough_cells``.
    """
    special = rough_cells(mesh, lines, points)
    made = [partial(cut_rule, mesh, line=line, degree=degree) for line in lines]
    made += [partial(fan_rule, mesh, point=point, degree=degree) for point in points]
    rules = [rule(cells=cells) for cells, rule in zip(special, made, strict=True) if cells.size]
    ordinary = np.ones(mesh.t.shape[1], dtype=bool)
    ordinary[np.concatenate([*special, np.empty(0, dtype=int)])] = False
    return rules + _standard(mesh, np.flatnonzero(ordinary), degree, along, block)


def _standard(mesh: Mesh, cells: Array, degree: int, along: Sequence[Line], block: int) -> list[CellRule]:
    """The standard rule on ordinary cells."""
    barycentric, weights = simplex_rule(mesh.dim(), degree)
    volumes = cell_volumes(mesh)[:, None]
    blocks = [cells[start : start + block] for start in range(0, cells.size, block)]
    if not along:
        return [CellRule(b, placed(mesh.p, mesh.t[:, b], barycentric), volumes[b] * weights) for b in blocks]
    gradients = barycentric_gradients(mesh)
    found = []
    for b in blocks:
        points, shares = shared(mesh.p[:, mesh.t[:, b]], gradients[b], barycentric, weights, along)
        found.append(CellRule(b, points, volumes[b] * shares))
    return found
