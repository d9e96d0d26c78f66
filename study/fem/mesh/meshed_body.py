"""A body and its meshes: what a mesh family is, and the check that a mesh fits the parts of the body's boundary."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from skfem import Mesh

from manufactured.body import Body, Kind, Part
from manufactured.tensors import Array
from study.fem.mesh.geometry import cell_volumes, facet_measures

TOLERANCE = 1e-8
"""Relative to |Ω|^{1/d}, the distance from which a vertex counts as lying off a part; so for measures."""


class MeshError(ValueError):
    """A mesh does not fit the body."""


class MeshFamily(Protocol):
    """A regular family {T_h} of triangulations: whether it can mesh a body, and the mesh of level n, or MeshError."""

    @property
    def name(self) -> str: ...
    def serves(self, body: Body) -> bool: ...
    def __call__(self, body: Body, n: int) -> Mesh: ...


def require_plane(family: MeshFamily, body: Body) -> None:
    """MeshError unless the body is two-dimensional."""
    if body.dim != 2:
        raise MeshError(f"the family {family.name} meshes 2D bodies, got dimension {body.dim}; use one-diagonal")


@dataclass(frozen=True, eq=False)
class MeshedBody:
    """A body with a mesh."""

    mesh: Mesh
    body: Body

    @cached_property
    def parts(self) -> list[Array]:
        """Facets of each part of the body; MeshError if the mesh does not fit it."""
        return boundary_parts(self.mesh, self.body)

    def facets(self, part: Part) -> Array:
        return self.parts[self.body.parts.index(part)]

    def on(self, kind: Kind) -> list[tuple[Part, Array]]:
        """The parts of one kind with their facets."""
        return [(part, facets) for part, facets in zip(self.body.parts, self.parts, strict=True) if part.kind is kind]

    @property
    def cells(self) -> int:
        return int(self.mesh.t.shape[1])

    @cached_property
    def volumes(self) -> Array:
        """|T|, (cells,)."""
        return cell_volumes(self.mesh)


def boundary_parts(mesh: Mesh, body: Body) -> list[Array]:
    """The facets of the mesh on each part of the body, in the order of ``body.parts``.

    Raises:
        MeshError: a corner of a part is not a vertex, the facets do not cover a part exactly, or an interface is not
            a union of facets.
    """
    if mesh.dim() != body.dim:
        raise MeshError(f"a mesh of dimension {mesh.dim()} was given for a body of dimension {body.dim}")
    total = cell_volumes(mesh).sum()
    if abs(total - body.measure) > TOLERANCE * body.measure:
        what = "area" if body.dim == 2 else "volume"
        raise MeshError(
            f"the cells cover {total:.9g}, the body has the {what} {body.measure:.9g}: cells overlap or are missing"
        )
    length = body.measure ** (1 / body.dim)
    facets = mesh.boundary_facets()
    _check_vertices(mesh, facets, body, TOLERANCE * length)
    found = [_covering(mesh, facets, part, length) for part in body.parts]
    if sum(map(len, found)) != len(facets):
        raise MeshError(f"{len(facets) - sum(map(len, found))} boundary facets lie on no part of the body")
    for interface in body.interfaces:
        _covering(mesh, np.arange(mesh.facets.shape[1]), interface, length)
    return found


def _check_vertices(mesh: Mesh, facets: Array, body: Body, tolerance: float) -> None:
    """MeshError unless every corner of a part is a vertex on the boundary of the mesh."""
    border = mesh.p[:, np.unique(mesh.facets[:, facets])]
    mend = "take a level at which it is" + (", or the unstructured family" if body.dim == 2 else "")
    for vertex in body.vertices.T:
        distance = np.linalg.norm(border - vertex[:, None], axis=0).min()
        if distance > tolerance:
            raise MeshError(
                f"the boundary condition changes at {vertex.tolist()}, which is not a vertex of the mesh "
                f"(the nearest is {distance:.3g} away); {mend}"
            )


def _covering(mesh: Mesh, facets: Array, part: Part, length: float) -> Array:
    """Those of the given facets that lie on a part; MeshError if they do not cover it."""
    on = part.contains(mesh.p, TOLERANCE * length)
    mine = facets[on[mesh.facets[:, facets]].all(axis=0)]
    covered = facet_measures(mesh, mine).sum()
    if abs(covered - part.measure) > TOLERANCE * length ** (mesh.dim() - 1):
        what = "length" if mesh.dim() == 2 else "area"
        mend = (
            "take a level at which edges of the mesh follow it, or the unstructured family"
            if part.kind is Kind.INTERFACE
            else "the mesh is not one of this body, or its facets do not end where the part does"
        )
        raise MeshError(
            f"facets of total {what} {covered:.9g} lie on the part {part.kind.value} with the corners "
            f"{part.corners.T.tolist()}, whose {what} is {part.measure:.9g}: {mend}"
        )
    return mine
