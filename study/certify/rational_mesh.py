"""Meshes with rational vertices that tile a polygon exactly, and how those of scikit-fem compare with them.

A vertex inside moves to the nearest point of a lattice of width 2^{−b}, b from the size of cells; one on a part goes to
the point that divides the part in the nearest ratio with the denominator 2^b.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np
from scipy.spatial import cKDTree
from skfem import Mesh

from manufactured.body import Body
from manufactured.tensors import Array
from study.certify import checker
from study.certify.statement import corners, rational
from study.fem.mesh.geometry import determinants, simplicial_mesh, size

FINENESS = 64
"""How much finer than a cell the lattice is, at least."""


def rational_mesh(mesh: Mesh, body: Body) -> dict[str, Any]:
    """The mesh as a certificate states it: integers over one denominator, cells counter-clockwise."""
    bits = math.ceil(math.log2(FINENESS / size(mesh)))
    unit, sides = 1 << bits, corners(body)
    points = [(Fraction(round(x * unit), unit), Fraction(round(y * unit), unit)) for x, y in mesh.p.T.tolist()]
    tolerance, chains = 1e-7 * size(mesh), []
    for part, start, end in zip(body.parts, sides, [*sides[1:], sides[0]], strict=True):
        shares = {}
        for v in np.flatnonzero(part.contains(mesh.p, tolerance)).tolist():
            along = float(np.dot(mesh.p[:, v] - part.start, part.tangent)) / part.measure
            share = Fraction(round(along * unit), unit) if rational(along).denominator > unit else rational(along)
            points[v] = tuple(a + share * (b - a) for a, b in zip(start, end, strict=True))  # type: ignore[assignment]
            shares[v] = share
        chains.append(sorted(shares, key=lambda v, shares=shares: shares[v]))  # type: ignore[misc]
    denominator = math.lcm(*(c.denominator for point in points for c in point))
    cells = mesh.t.copy()
    turned = determinants(mesh.p, cells) < 0
    cells[1:, turned] = cells[:0:-1, turned]
    return {
        "denominator": denominator,
        "points": [[int(c * denominator) for c in point] for point in points],
        "cells": cells.T.tolist(),
        "sides": chains,
    }


def in_doubles(mesh: checker.Mesh) -> Mesh:
    """The same mesh for scikit-fem."""
    points = np.array([[float(c) for c in mesh.place(v)] for v in range(len(mesh.points))]).T
    return simplicial_mesh(points, np.array([cell.v for cell in mesh.cells]).T)


@dataclass(frozen=True, eq=False)
class Twins:
    """A mesh of scikit-fem and the same one of the checker, with other numbers."""

    skfem: Mesh
    exact: checker.Mesh

    @property
    def triangles(self) -> Array:
        """The vertices of the exact cells, (cells, 3)."""
        return np.array([cell.v for cell in self.exact.cells])

    @cached_property
    def vertices(self) -> Array:
        """The number of each exact vertex in scikit-fem."""
        points = np.array(self.exact.points, dtype=float) / self.exact.h
        return cKDTree(self.skfem.p.T).query(points)[1]

    @cached_property
    def edges(self) -> Array:
        """The number of each exact edge in scikit-fem."""
        known = {frozenset(ends): n for n, ends in enumerate(self.skfem.facets.T.tolist())}
        return np.array([known[frozenset(ends)] for ends in self.vertices[np.array(self.exact.edges)].tolist()])

    @cached_property
    def cells(self) -> Array:
        """The number of each exact cell in scikit-fem."""
        known = {frozenset(corners): n for n, corners in enumerate(self.skfem.t.T.tolist())}
        mine = self.vertices[self.triangles].tolist()
        return np.array([known[frozenset(corners)] for corners in mine])

    @cached_property
    def corners(self) -> Array:
        """The local number in scikit-fem of each corner of the exact cells, (cells, 3)."""
        theirs = self.skfem.t.T[self.cells]
        mine = self.vertices[self.triangles]
        return (theirs[:, None, :] == mine[:, :, None]).argmax(axis=2)

    @cached_property
    def turned(self) -> Array:
        """Whether the lower vertex of each exact edge is the second one in scikit-fem."""
        first = self.vertices[np.array(self.exact.edges)[:, 0]]
        return self.skfem.facets[0, self.edges] != first
