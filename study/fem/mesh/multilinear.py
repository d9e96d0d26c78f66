"""The map of the unit cube onto a convex quadrilateral or a parallelepiped that is linear in every coordinate."""

from __future__ import annotations

import numpy as np

from manufactured.body import Body, Part
from manufactured.tensors import Points
from study.fem.mesh import unit_grid
from study.fem.mesh.family import MeshError
from study.fem.mesh.segments import nearest, on_segment


def has_grids(body: Body) -> bool:
    """Whether a grid of the unit cube can be mapped onto the body so that its lines follow the interfaces."""
    images = _images(body)
    return images is not None and all(_is_grid_line(images, interface) for interface in body.interfaces)


def mapped(body: Body, reference: Points) -> Points:
    """Images of points of the unit cube, (d, ...) → (d, ...).

    Raises:
        MeshError: the body is neither a convex quadrilateral nor a parallelepiped.
    """
    images = _images(body)
    if images is None:
        wanted = "convex quadrilateral" if body.dim == 2 else "parallelepiped"
        mend = "use the unstructured family" if body.dim == 2 else "no family meshes other polyhedra"
        raise MeshError(f"a structured mesh needs a {wanted}, this body has {body.corners.shape[1]} corners; {mend}")
    shapes = np.ones((1, *reference.shape[1:]))
    for x in reference:
        shapes = np.concatenate([shapes * (1 - x), shapes * x])
    return images @ shapes


def _images(body: Body) -> Points | None:
    """Images (d, 2^d) of the corners of the unit cube, the first axis fastest; None if there is no such map."""
    return _quadrilateral(body) if body.dim == 2 else _parallelepiped(body)


def _quadrilateral(body: Body) -> Points | None:
    corners = body.corners
    if corners.shape[1] != 4:
        return None
    sides = np.roll(corners, -1, axis=1) - corners
    following = np.roll(sides, -1, axis=1)
    convex = (sides[0] * following[1] - sides[1] * following[0] > 0).all()
    return corners[:, [0, 1, 3, 2]] if convex else None


def _parallelepiped(body: Body) -> Points | None:
    corners, tolerance = body.corners, 1e-9 * float(np.ptp(body.vertices, axis=1).max())
    if corners.shape[1] != 8:
        return None
    first = corners[:, :1]
    normals = np.array([part.normal for part in body.parts if part.contains(first, tolerance)])
    normals = normals[np.sort(np.unique(np.round(normals, 9) + 0.0, axis=0, return_index=True)[1])]
    if len(normals) != 3:
        return None
    # An edge runs from the first corner to the only other one in the planes of two faces.
    off = abs(normals @ (corners - first)) > tolerance
    ends = [np.flatnonzero(~np.delete(off, k, axis=0).any(axis=0))[1:] for k in range(3)]
    if any(end.size != 1 for end in ends):
        return None
    edges = (corners - first)[:, [int(end[0]) for end in ends]]
    if np.linalg.det(edges) < 0:
        edges = edges[:, [1, 0, 2]]
    images = first + edges @ unit_grid.vertices(1, 3)
    return images if _fills(images, body, tolerance) else None


def _fills(images: Points, body: Body, tolerance: float) -> bool:
    """Whether a parallelepiped is the body."""
    apart = np.linalg.norm(images[:, :, None] - body.corners[:, None, :], axis=0)
    volume = np.linalg.det(images[:, [1, 2, 4]] - images[:, :1])
    return bool(apart.min(axis=1).max() <= tolerance and abs(volume - body.measure) <= 1e-9 * volume)


def _is_grid_line(images: Points, interface: Part) -> bool:
    """Whether an interface joins two opposite sides of a quadrilateral, dividing both in the same ratio."""
    for low, high in ((images[:, :2], images[:, 2:]), (images[:, ::2], images[:, 1::2])):
        for ends in (interface.corners, interface.corners[:, ::-1]):
            shares = [nearest(ends[:, [i]], side) for i, side in enumerate((low, high))]
            if abs(shares[0] - shares[1]) < 1e-9 and all(
                on_segment(ends[:, [i]], side) for i, side in enumerate((low, high))
            ):
                return True
    return False
