"""Quadrature on the facets of one part of the boundary."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from skfem import Mesh

from manufactured.body import Part
from manufactured.tensors import Array
from study.fem.mesh import MeshError, facet_measures
from study.fem.quadrature.rough_cells import TOUCHING
from study.fem.quadrature.rules import GRADING, duffy, gauss, placed


@dataclass(frozen=True, eq=False)
class FacetRule:
    """Quadrature on the facets of one part.

    Attributes:
        facets: indices (n,).
        s: local coordinates of the points along the part, (d−1, n, q).
        shapes: values of the P1 functions of the facet's vertices, (d, n, q).
        weights: (n, q).
    """

    facets: Array
    s: Array
    shapes: Array
    weights: Array


def facet_rule(mesh: Mesh, facets: Array, part: Part, rough: tuple[float, ...], points: int) -> FacetRule:
    """A rule on each facet, exact to the degree 2 points − 2 at least.

    In 2D Gauss's rule on both sides of the coordinates ``rough`` and graded to them.

    Raises:
        MeshError: rough coordinates are given in 3D.
    """
    if mesh.dim() == 2:
        return _segment_rule(mesh, facets, part, rough, points)
    if rough:
        raise MeshError(f"facets are cut in 2D only, got the rough coordinates {rough} on a face of a 3D body")
    barycentric, weights = duffy(points, points)
    s, _ = part.coordinates(placed(mesh.p, mesh.facets[:, facets], barycentric))
    return FacetRule(
        facets,
        s,
        np.repeat(barycentric[:, None], len(facets), axis=1),
        np.multiply.outer(facet_measures(mesh, facets), weights),
    )


def _segment_rule(mesh: Mesh, facets: Array, part: Part, rough: tuple[float, ...], points: int) -> FacetRule:
    ends = np.stack([part.coordinates(mesh.p[:, v])[0][0] for v in mesh.facets[:, facets]])
    low, high = ends.min(axis=0), ends.max(axis=0)
    nodes = np.sort(np.vstack([low, high, *[np.clip(np.full_like(low, c), low, high) for c in rough]]), axis=0)
    xi, w = gauss(points)
    s, weights = [], []
    for left, right in pairwise(nodes):
        graded = [_close(end, rough, high - low)[:, None] for end in (left, right)]
        length = (right - left)[:, None]
        power = np.where(graded[0] | graded[1], GRADING, 1)
        local, jacobian = xi**power, power * xi ** (power - 1.0) * w
        local = np.where(graded[1] & ~graded[0], 1 - local, local)
        s.append(left[:, None] + length * local)
        weights.append(length * jacobian)
    place = np.concatenate(s, axis=1)
    first = (ends[1][:, None] - place) / (ends[1] - ends[0])[:, None]
    return FacetRule(facets, place[None], np.stack([first, 1 - first]), np.concatenate(weights, axis=1))


def _close(s: Array, rough: tuple[float, ...], length: Array) -> Array:
    """Which coordinates lie at a rough one, up to rounding."""
    return np.any([abs(s - c) <= TOUCHING * length for c in rough] or [np.zeros(s.shape, dtype=bool)], axis=0)
