"""Data for pictures: values over time with few digits, and the facets of a contact surface."""

from __future__ import annotations

import zlib
from base64 import b64decode, b64encode
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from study.ledger.files import Json

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]
UNITS = 999
"""Values for pictures are rounded to multiples of their largest value / 999: three digits, enough for a tenth of a
pixel."""
FINE_UNITS = 32_000
"""Values that are read as numbers are rounded to multiples of their largest value / 32 000, as fine as 16 bits
permit."""


@dataclass(frozen=True, eq=False)
class Packed:
    """Values over time that are rounded to multiples of a unit, so that files are short.

    Attributes:
        unit: the largest absolute value divided by a number of steps; 1 if all values are zero.
        multiples: the values divided by the unit, as whole numbers; the first axis is the time.
    """

    unit: float
    multiples: NDArray[np.int16]

    @classmethod
    def of(cls, values: Array, steps: int = UNITS) -> Packed:
        """Return values over time in rounded form.

        Parameters:
            values: the values; the first axis is the time.
            steps: number of units in the largest absolute value, for example UNITS or FINE_UNITS; at most 32 767.
        """
        unit = float(f"{abs(values).max(initial=0.0) / steps:.6g}") or 1.0
        return cls(unit, np.round(values / unit).astype(np.int16))

    @property
    def values(self) -> Array:
        """The rounded values; the first axis is the time."""
        return self.unit * self.multiples.astype(np.float64)

    def record(self) -> Json:
        """Return the rounded values as a dictionary that can be written as JSON; ``read`` reads it.

        The whole numbers are stored as differences from one time to the next, compressed by zlib, as base-64 text.
        """
        changes = np.diff(self.multiples, axis=0, prepend=np.int16(0)).astype("<i2")
        return {
            "unit": self.unit,
            "shape": changes.shape,
            "changes": b64encode(zlib.compress(changes.tobytes(), 9)).decode("ascii"),
        }

    @classmethod
    def read(cls, record: Json) -> Packed:
        """Return rounded values from a dictionary that ``record`` has returned.

        Raises:
            KeyError, TypeError, ValueError: the content is damaged.
        """
        try:
            content = zlib.decompress(b64decode(record["changes"], validate=True))
        except zlib.error as error:
            raise ValueError(str(error)) from error
        changes = np.frombuffer(content, dtype="<i2").reshape(record["shape"])
        return cls(float(record["unit"]), np.cumsum(changes, axis=0, dtype=np.int16))


def short(values: Array) -> Any:
    """Return an array as nested lists with numbers of four significant digits, which suffice for a figure."""
    return np.vectorize(lambda v: float(f"{v:.4g}"), otypes=[float])(values).tolist()


@dataclass(frozen=True, eq=False)
class Facets:
    """The facets of a contact face in 3D: the triangles of the surface mesh whose corners are all vertices of the face.

    A data file lists the vertices of the face, here called nodes. At the nodes and at the midpoints of edges, it stores
    a function that is positive in the exact contact zone. Writer and reader of the file use this class, so that both
    number the edges in the same way.

    Attributes:
        cells: indices of the k facets among the triangles of the surface, (k,).
        corners: corners of the facets as indices of nodes, (3, k).
        edges: both ends of each of the e edges, as indices of nodes, (2, e): the lower index first, edges in
            lexicographic order.
        quarters: corners of the four triangles into which the midpoints of the edges divide each facet, (3, 4k). The
            midpoint of edge i has the index (number of nodes) + i.
    """

    cells: Numbers
    corners: Numbers
    edges: Numbers
    quarters: Numbers

    @classmethod
    def between(cls, nodes: Numbers, surface: Numbers) -> Facets:
        """Return the facets of a contact face.

        Parameters:
            nodes: vertex numbers of the nodes of the face, (n,).
            surface: vertex numbers of the triangles of the surface, (3, m).
        """
        number = np.full(surface.max() + 1, -1)
        number[nodes] = np.arange(len(nodes))
        cells = np.flatnonzero((number[surface] >= 0).all(axis=0))
        a, b, c = corners = number[surface[:, cells]]
        pairs = np.sort([[*b, *c, *a], [*c, *a, *b]], axis=0)
        edges, opposite = np.unique(pairs, axis=1, return_inverse=True)
        p, q, r = len(nodes) + opposite.reshape(3, -1)
        return cls(cells, corners, edges, np.hstack([[a, r, q], [b, p, r], [c, q, p], [p, q, r]]))

    def refined(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return values at the nodes and at the midpoints of edges, where they are the mean of both ends.

        Parameters:
            values: values at the nodes, (..., n).

        Returns:
            The values at the nodes, then at the midpoints, (..., n + e).
        """
        return np.concatenate([values, values[..., self.edges].mean(axis=-2)], axis=-1)
