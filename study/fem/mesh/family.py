"""What a mesh family is."""

from __future__ import annotations

from typing import Protocol

from skfem import Mesh

from manufactured.body import Body


class MeshError(ValueError):
    """A mesh does not fit the body."""


class MeshFamily(Protocol):
    """A regular family {T_h} of triangulations."""

    @property
    def name(self) -> str: ...

    def serves(self, body: Body) -> bool:
        """Whether the family can mesh a body."""
        ...

    def __call__(self, body: Body, n: int) -> Mesh:
        """The mesh of level n; MeshError if the family cannot mesh the body."""
        ...


def require_plane(family: MeshFamily, body: Body) -> None:
    """MeshError unless the body is two-dimensional."""
    if body.dim != 2:
        raise MeshError(f"the family {family.name} meshes 2D bodies, got dimension {body.dim}; use one-diagonal")
