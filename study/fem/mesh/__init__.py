"""Families of triangulations of a body of any dimension, and the check that a mesh fits the parts of its boundary.

A family turns a body and a level n into a mesh with about n cells along a side. No family knows where a contact zone
begins or ends. Every point at which the boundary condition changes must be a vertex (source, before (5.23)), and every
interface a union of facets; a mesh that violates this is refused.
"""

from study.fem.mesh.geometry import Skin, barycentric_gradients, cell_volumes, facet_measures, size, with_midpoints
from study.fem.mesh.meshed_body import MeshedBody, MeshError, MeshFamily, boundary_parts
from study.fem.mesh.structured import Alternating, CrissCross, OneDiagonal, Shaken
from study.fem.mesh.unstructured import Graded, Unstructured

FAMILIES: tuple[MeshFamily, ...] = (OneDiagonal(), CrissCross(), Shaken(), Unstructured(), Graded())
"""The mesh families of the study, each with its default parameters."""

__all__ = [
    "FAMILIES",
    "Alternating",
    "CrissCross",
    "Graded",
    "MeshError",
    "MeshFamily",
    "MeshedBody",
    "OneDiagonal",
    "Shaken",
    "Skin",
    "Unstructured",
    "barycentric_gradients",
    "boundary_parts",
    "cell_volumes",
    "facet_measures",
    "size",
    "with_midpoints",
]
