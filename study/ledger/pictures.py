"""Data of pictures: values over time with few digits, the facets of a contact face, and fields on a mesh over time."""

from __future__ import annotations

import zlib
from base64 import b64decode, b64encode
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]
STEPS = 999
"""Number of units in the largest value: three digits, a tenth of a pixel in a picture of a body."""
FINE = 32_000
"""Number of units for values that are read as numbers: as many as 16 bits hold."""


@dataclass(frozen=True, eq=False)
class Packed:
    """Values over time, rounded to multiples of a unit.

    Attributes:
        unit: the largest absolute value / steps; 1 if all values are zero.
        multiples: the values / unit, between −steps and steps, (times, ...).
    """

    unit: float
    multiples: NDArray[np.int16]

    @classmethod
    def of(cls, values: NDArray[np.float64], steps: int = STEPS) -> Packed:
        """Return values over time, (times, ...), rounded to units; ``steps`` is STEPS or FINE."""
        unit = float(f"{np.max(np.abs(values), initial=0.0) / steps:.6g}") or 1.0
        return cls(unit, np.round(values / unit).astype(np.int16))

    @property
    def values(self) -> NDArray[np.float64]:
        """The rounded values, (times, ...)."""
        return self.unit * self.multiples.astype(np.float64)

    def record(self) -> dict[str, Any]:
        """Return the content of a JSON file: differences in time, compressed, as base-64 text for the report page."""
        changes = np.diff(self.multiples, axis=0, prepend=np.int16(0)).astype("<i2")
        return {
            "unit": self.unit,
            "shape": list(changes.shape),
            "changes": b64encode(zlib.compress(changes.tobytes(), 9)).decode("ascii"),
        }

    @classmethod
    def read(cls, record: Mapping[str, Any]) -> Packed:
        """Return the values from the content of a JSON file.

        Raises:
            KeyError, TypeError, ValueError: the content is damaged.
        """
        try:
            content = zlib.decompress(b64decode(record["changes"], validate=True))
        except zlib.error as error:
            raise ValueError(str(error)) from error
        changes = np.frombuffer(content, dtype="<i2").reshape(record["shape"])
        return cls(float(record["unit"]), np.cumsum(changes, axis=0, dtype=np.int16))


def short(values: NDArray[np.float64]) -> Any:
    """Return nested lists of numbers with four significant digits, as many as a figure can show."""
    return np.vectorize(lambda v: float(f"{v:.4g}"), otypes=[float])(values).tolist()


@dataclass(frozen=True, eq=False)
class Facets:
    """The facets of a contact face in space: the triangles of a surface whose corners are all nodes of the face.

    The writer and the reader of a data file number them in the same way. A file lists the nodes of the face; the level
    function ψ of its exact contact zone is stored at the nodes and at the midpoints of the edges.

    Attributes:
        cells: their indices among the triangles of the surface, (k,).
        corners: indices into the nodes, (3, k).
        edges: the two ends of each edge, the lower first, in lexicographic order, (2, e).
        quarters: the four triangles into which the midpoints of its edges divide each of them, (3, 4k); midpoint i has
            the index (number of nodes) + i.
    """

    cells: Numbers
    corners: Numbers
    edges: Numbers
    quarters: Numbers

    @classmethod
    def between(cls, nodes: Numbers, surface: Numbers) -> Facets:
        """Return the triangles of a surface, (3, m), whose three vertices are all among the given nodes, (n,)."""
        number = np.full(surface.max() + 1, -1)
        number[nodes] = np.arange(len(nodes))
        cells = np.flatnonzero((number[surface] >= 0).all(axis=0))
        a, b, c = corners = number[surface[:, cells]]
        pairs = np.sort([[*b, *c, *a], [*c, *a, *b]], axis=0)
        edges, opposite = np.unique(pairs, axis=1, return_inverse=True)
        p, q, r = len(nodes) + opposite.reshape(3, -1)
        return cls(cells, corners, edges, np.hstack([[a, r, q], [b, p, r], [c, q, p], [p, q, r]]))

    def refined(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return values at the nodes, (..., n), followed by their means at the midpoints of edges, (..., n + e)."""
        return np.concatenate([values, values[..., self.edges].mean(axis=-2)], axis=-1)


@dataclass(frozen=True, eq=False)
class MeshFields:
    """Fields at one time.

    Attributes:
        time: t.
        at_vertices: name ↦ scalars, (vertices,), or vectors, (d, vertices); not a number where there is no value.
        in_cells: name ↦ scalars, (cells,), or matrices, (d, d, cells).
    """

    time: float
    at_vertices: dict[str, Array]
    in_cells: dict[str, Array]


@dataclass(frozen=True, eq=False)
class MeshSeries:
    """The vertices of a mesh, (d, vertices), the corners of its simplices, (d + 1, cells), and fields at some times."""

    vertices: Array
    cells: NDArray[np.int64]
    fields: Sequence[MeshFields]
