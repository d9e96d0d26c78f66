"""A mesh with fields on it over time, as a run hands them over to be written for other programs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


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
