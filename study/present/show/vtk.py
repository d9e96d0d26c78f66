"""Fields over time as files that ParaView opens: one VTU for every time, and a PVD that lists them."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import meshio  # type: ignore[import-untyped]
import numpy as np

from study.ledger.files import write_text, write_whole
from study.ledger.mesh_series import Array, MeshFields, MeshSeries

CELLS = {2: "triangle", 3: "tetra"}


def write_vtk(directory: Path, name: str, series: MeshSeries) -> list[Path]:
    """``name.pvd`` and ``name-000.vtu``, ``name-001.vtu``, …, for every time.

    Plane vectors get a third component 0; σ_33, which a plane problem does not have, is written as 0, too.
    """
    files = {}
    for number, fields in enumerate(series.fields):
        path = directory / f"{name}-{number:03d}.vtu"
        files[write_whole(path, partial(mesh_of(series, fields).write, file_format="vtu"))] = fields.time
    return [_write_pvd(directory / f"{name}.pvd", files), *files]


def mesh_of(series: MeshSeries, fields: MeshFields) -> meshio.Mesh:
    """The undeformed mesh with the fields of one time."""
    return meshio.Mesh(
        _padded(series.vertices),
        [(CELLS[len(series.vertices)], series.cells.T)],
        point_data={name: _padded(values) for name, values in fields.at_vertices.items()},
        cell_data={name: [_padded(values)] for name, values in fields.in_cells.items()},
    )


def _padded(values: Array) -> Array:
    """With components of space: scalars (n,), vectors (d, n) → (n, 3), matrices (d, d, n) → (n, 9), row by row."""
    components = values.shape[:-1]
    padded = np.pad(values, [*((0, 3 - d) for d in components), (0, 0)])
    return np.moveaxis(padded, -1, 0).reshape(values.shape[-1], -1) if components else values


def _write_pvd(path: Path, files: dict[Path, float]) -> Path:
    root = ElementTree.Element("VTKFile", type="Collection", version="0.1", byte_order="LittleEndian")
    collection = ElementTree.SubElement(root, "Collection")
    for file, time in files.items():
        entry: dict[str, Any] = {"timestep": f"{time:.12g}", "group": "", "part": "0", "file": file.name}
        ElementTree.SubElement(collection, "DataSet", entry)
    ElementTree.indent(root)
    return write_text(path, ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n")
