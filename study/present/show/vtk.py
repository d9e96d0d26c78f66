"""A motion as files that ParaView opens: one VTU for every time, and a PVD that lists them."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import meshio  # type: ignore[import-untyped]
import numpy as np

from manufactured.tensors import Array, Tensors, full
from study.ledger.files import write_text, write_whole
from study.run.pictures import contact_weights
from study.solve.motion import Frame, Motion, von_mises

CELLS = {2: "triangle", 3: "tetra"}


def write_vtk(directory: Path, name: str, motion: Motion, every: int) -> list[Path]:
    """``name.pvd`` and ``name-000.vtu``, ``name-001.vtu``, …, for one of ``every`` frames.

    At the vertices: ``displacement``, ``velocity``, and on Γ3 ``gap`` and ``pressure`` (``gap_1``, ``gap_2``, … where
    Γ3 has several pieces), which are not numbers elsewhere. In the cells, where they are constant: ``stress``, nine
    components, and ``von_mises``. Plane vectors get a third component 0; σ_33, which a plane problem does not have,
    is written as 0, too.
    """
    weights = contact_weights(motion.space)
    files = {}
    for number, frame in enumerate(motion.frames[::every]):
        path = directory / f"{name}-{number:03d}.vtu"
        mesh = mesh_of(motion, frame, weights)
        files[write_whole(path, partial(mesh.write, file_format="vtu"))] = frame.time
    return [_write_pvd(directory / f"{name}.pvd", files), *files]


def mesh_of(motion: Motion, frame: Frame, weights: Array) -> meshio.Mesh:
    """The undeformed mesh with the fields of one frame; ``weights`` are those of ``contact_weights``."""
    space = motion.space
    vectors = {"displacement": space.nodal(frame.u), "velocity": space.nodal(frame.velocity)}
    contact = dict(_on_contact(motion, {"gap": -frame.normal, "pressure": frame.multipliers / weights}))
    return meshio.Mesh(
        _padded(space.mesh.p),
        [(CELLS[space.dim], space.mesh.t.T)],
        point_data={name: _padded(values) for name, values in vectors.items()} | contact,
        cell_data={"stress": [_nine(frame.stress)], "von_mises": [von_mises(frame.stress)]},
    )


def _on_contact(motion: Motion, values: dict[str, Array]) -> Iterator[tuple[str, Array]]:
    """Values at the rows of N as fields over all vertices, a field for each piece of Γ3."""
    pieces, start = motion.space.contact, 0
    for number, (_, vertices) in enumerate(pieces, start=1):
        rows = slice(start, start + len(vertices))
        start += len(vertices)
        for name, mine in values.items():
            field = np.full(motion.space.mesh.p.shape[1], np.nan)
            field[vertices] = mine[rows]
            yield name if len(pieces) == 1 else f"{name}_{number}", field


def _padded(vectors: Array) -> Array:
    """(d, n) → (n, 3)."""
    return np.pad(vectors.T, ((0, 0), (0, 3 - len(vectors))))


def _nine(stress: Tensors) -> Array:
    """(D, n) → (n, 9), row by row."""
    matrices = np.moveaxis(full(stress), -1, 0)
    missing = 3 - matrices.shape[1]
    return np.pad(matrices, ((0, 0), (0, missing), (0, missing))).reshape(-1, 9)


def _write_pvd(path: Path, files: dict[Path, float]) -> Path:
    root = ElementTree.Element("VTKFile", type="Collection", version="0.1", byte_order="LittleEndian")
    collection = ElementTree.SubElement(root, "Collection")
    for file, time in files.items():
        entry: dict[str, Any] = {"timestep": f"{time:.12g}", "group": "", "part": "0", "file": file.name}
        ElementTree.SubElement(collection, "DataSet", entry)
    ElementTree.indent(root)
    return write_text(path, ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n")
