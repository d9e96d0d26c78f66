"""Read the displacement of another program from a file: .npz, or any mesh format that meshio reads."""

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from zipfile import ZipFile, is_zipfile

import numpy as np

from manufactured.tensors import Array
from study.bound.problem import BoundError

ARRAYS = ("points", "triangles", "times", "u")
"""Names of the arrays in an .npz file with a displacement."""
OURS = {"p": "points", "t": "triangles"}
"""Names of the arrays for points and triangles in .npz files that ``study bound`` writes, and the usual names.

In these files the arrays are stored transposed.
"""
DISPLACEMENT_NAMES = ("u", "displacement", "displacements", "u_h", "uh", "disp")
"""Names, in lower case, by which the displacement is recognised among the fields of a mesh file."""
CELLS = {"triangle": (3,), "triangle6": (6,), "VTK_LAGRANGE_TRIANGLE": (3, 6)}
"""Types of cells that are read, and how many points they may have.

Lagrange triangles of VTK (type 69) of degree 1 and 2 number their points as the other two types.
"""
IGNORED = ("vertex", "line", "line3", "VTK_LAGRANGE_CURVE")
"""Types of cells that are ignored: mesh files often contain points and boundary edges besides the triangles."""


COUNTS = re.compile(rb"""NumberOf(?:Points|Cells)\s*=\s*["'](\d{1,20})["']""")
"""Pattern that finds the numbers of points and cells that a .vtu file states."""
XDMF = (".xdmf", ".xmf")
"""Endings of files that name HDF5 files with their data."""
UNPACKING_FACTOR, UNSUSPICIOUS = 100, 2**26
"""A file may unpack to at most this many times its size.

Files that unpack to at most 64 MiB (``UNSUSPICIOUS``) may have any ratio. The coordinates and displacements of a mesh
compress by a factor of 20 at most.
"""


@dataclass(frozen=True)
class Field:
    """A mesh, times and displacements that were read from a file.

    Attributes:
        points: the coordinates of the points, (n, 2) or (n, 3).
        triangles: for each cell the numbers of its points, (cells, 3) or (cells, 6).
        times: the times, (k,); None if the file has no times.
        u: the displacements of the points at the times, (k, n, 2) or (k, n, 3).
    """

    points: Array
    triangles: Array
    times: Array | None
    u: Array


def read(path: Path | str, name: str | None = None, step: int | None = None) -> Field:
    """Read a mesh, times and displacements from a file.

    Args:
        path: an .npz file with ``points``, ``triangles``, ``times`` and ``u``, or as ``study bound`` writes it; a .pvd
            file; an .xdmf file with a time series; or for a static problem a file with one mesh, such as .vtu.
        name: the name of the displacement field in a mesh file. By default this is a name in ``DISPLACEMENT_NAMES``, or
            the only field of vectors in the file.
        step: the number of the load step that is read, counted from 0, or from −1 backwards. By default all are read.

    Raises:
        BoundError: the file cannot be read, or has no displacement.
    """
    path = Path(path)
    if path.is_dir():
        raise BoundError(
            f"{path} is a directory: give the file in it that has the displacement, .npz, .pvd, .xdmf or .vtu"
        )
    if not path.is_file():
        raise BoundError(f"there is no file {path}")
    kind = path.suffix.lower()
    try:
        if kind == ".npz":
            field = _npz(path)
        else:
            meshes = {".pvd": _pvd, **dict.fromkeys(XDMF, _xdmf)}.get(kind, _single)
            field = _together(path, meshes(path), name)
        return field if step is None else _at_step(path, field, step)
    except (BoundError, MemoryError):
        raise
    except ImportError as error:
        raise BoundError(
            f"{path} needs the package {error.name}: install it (python -m pip install {error.name}), or write .npz"
        ) from error
    # A broken file may raise any error of NumPy, zipfile, zlib, h5py or meshio.
    except Exception as error:
        raise BoundError(f"{path} cannot be read: {type(error).__name__}: {error}") from error


def _at_step(path: Path, field: Field, step: int) -> Field:
    """Return the displacement of one load step, without times."""
    steps = field.u if field.u.ndim == 3 else field.u[None]
    count = len(steps)
    if not -count <= step < count:
        raise BoundError(f"{path} has {count} load steps: --step is 0 to {count - 1}, or -1 for the last, got {step}")
    return replace(field, times=None, u=steps[step])


def _npz(path: Path) -> Field:
    if not is_zipfile(path):
        raise BoundError(f"{path} is no .npz file: write it by numpy.savez, with the arrays {', '.join(ARRAYS)}")
    _refuse_packed(path)
    with np.load(path) as file:
        arrays = {OURS.get(key, key): file[key].T if key in OURS else file[key] for key in file.files}
        ours = "p" in file.files
    missing = [name for name in ("points", "triangles", "u") if name not in arrays]
    if missing:
        raise BoundError(f"{path} lacks {', '.join(missing)}; expected the arrays {', '.join(ARRAYS)}")
    u = arrays["u"].swapaxes(-1, -2) if ours else arrays["u"]
    return Field(arrays["points"], arrays["triangles"], arrays.get("times"), u)


def _refuse_packed(path: Path) -> None:
    """Raise BoundError, before anything is unpacked, if a zip file is encrypted or unpacks to very much."""
    with ZipFile(path) as packed:
        entries = packed.infolist()
    if any(entry.flag_bits & 1 for entry in entries):
        raise BoundError(f"{path} is encrypted: write it by numpy.savez, which does not encrypt")
    _refuse_larger(path, sum(entry.file_size for entry in entries))


def _refuse_larger(path: Path, total: int) -> None:
    """Raise BoundError if the content of a file, in bytes, is so large that the file was made to fill the memory."""
    size = path.stat().st_size
    if total > max(UNSUSPICIOUS, UNPACKING_FACTOR * size):
        raise BoundError(
            f"{path} has {size} bytes and unpacks to {total} bytes, more than {UNPACKING_FACTOR} times as many, as no "
            "displacement does: if it is one, write it without compression"
        )


def _refuse_packed_hdf(path: Path) -> None:
    """Raise BoundError, before anything is unpacked, if an HDF5 file unpacks to very much, or one of an .xdmf file."""
    import h5py  # type: ignore[import-untyped]  # Only files of this kind need it.

    files = {path}
    if path.suffix.lower() in XDMF:
        texts = [str(item.text).strip() for item in ET.parse(path).iterfind(".//DataItem[@Format='HDF']")]
        files = {path.parent / text.split(":")[0] for text in texts}
    for packed in files:
        sizes: list[int] = []
        with h5py.File(packed) as file:
            file.visititems(lambda _, item, sizes=sizes: sizes.append(getattr(item, "nbytes", 0)))
        _refuse_larger(packed, sum(sizes))


def _read_mesh(path: Path) -> Any:
    """Read a mesh file by meshio; raise BoundError if the format is unknown or the file is broken."""
    import meshio  # type: ignore[import-untyped]  # Only files of this kind need it.

    if not path.is_file():
        raise BoundError(f"there is no file {path}")
    kind = path.suffix.lower()
    if kind not in meshio.extension_to_filetypes:
        advice = "; docs/tutorials/bound.md converts .frd files" if kind == ".frd" else ""
        raise BoundError(
            f"{path} has a format that cannot be read: expected .npz, .pvd, .xdmf or a mesh format of meshio, such as "
            f".vtu, .vtk or .msh{advice}"
        )
    try:
        if kind == ".vtu":
            # Every point and every cell takes 8 bytes at least.
            _refuse_larger(path, 8 * sum(map(int, COUNTS.findall(path.read_bytes()))))
        if kind in (*XDMF, ".med", ".cgns", ".h5m", ".hmf"):
            _refuse_packed_hdf(path)
        return meshio.read(path)
    except (BoundError, ImportError, MemoryError):
        raise
    # For broken files meshio prints a message and raises SystemExit, or an error of the library that it uses.
    except (SystemExit, Exception) as error:
        raise BoundError(
            f"{path} is broken, incomplete or no unstructured grid, as VTK files with LINES or POLYGONS are: write it "
            f"again as an unstructured grid ({type(error).__name__}: {error})"
        ) from error


def _single(path: Path) -> Iterator[tuple[float | None, Any]]:
    yield None, _read_mesh(path)


def _pvd(path: Path) -> Iterator[tuple[float | None, Any]]:
    """Yield the times and meshes of a .pvd file."""
    for entry in ET.parse(path).getroot().iter("DataSet"):
        if not {"timestep", "file"} <= set(entry.attrib):
            raise BoundError(f"{path} has a DataSet without timestep or file: give both, one DataSet for each time")
        yield float(entry.attrib["timestep"]), _read_mesh(path.parent / entry.attrib["file"])


def _xdmf(path: Path) -> Iterator[tuple[float | None, Any]]:
    """Yield the times and meshes of an .xdmf file. Without a time series, yield its one mesh and the time None."""
    import meshio

    _refuse_packed_hdf(path)
    try:
        series = meshio.xdmf.TimeSeriesReader(path)
    except (meshio.ReadError, AttributeError, IndexError):
        yield None, _read_mesh(path)
        return
    with series as reader:
        points, cells = reader.read_points_cells()
        for step, grid in enumerate(reader.collection):
            # The reader of meshio takes the mesh of the first step for all steps.
            if {"Geometry", "Topology"} & {child.tag for child in grid}:
                reader.mesh_grid = grid
                points, cells = reader.read_points_cells()
            time, values, _ = reader.read_data(step)
            yield time, meshio.Mesh(points, cells, point_data=values)


def _together(path: Path, meshes: Iterable[tuple[float | None, Any]], name: str | None) -> Field:
    """Join the displacements at all times into one ``Field``; raise BoundError if the mesh changes in time."""
    first: Any = None
    times, values = [], []
    for time, mesh in meshes:
        triangles = _triangles(path, mesh)
        if first is None:
            first, first_triangles = mesh, triangles
            name = _displacement_name(path, mesh, name)
        same = np.array_equal(mesh.points, first.points, equal_nan=True)
        if not (same and np.array_equal(triangles, first_triangles)):
            raise BoundError(
                f"{path} has another mesh at t = {time} than before, with other points or other triangles, or in "
                "another order: give one mesh for all times"
            )
        if name not in mesh.point_data:
            raise BoundError(f"{path} has no field {name!r} at t = {time}: give the same field at all times")
        times.append(time)
        values.append(mesh.point_data[name])
    if first is None:
        raise BoundError(f"{path} lists no mesh")
    all_times = None if None in times else np.array(times, dtype=float)
    return Field(first.points, first_triangles, all_times, np.array(values))


def _triangles(path: Path, mesh: Any) -> Array:
    """Return the point numbers of the triangles in a mesh file: (cells, 3) if linear, (cells, 6) if quadratic."""
    blocks = [block for block in mesh.cells if block.type not in IGNORED]
    kinds = sorted({(block.type, block.data.shape[1]) for block in blocks})
    if len(kinds) != 1 or kinds[0][1] not in CELLS.get(kinds[0][0], ()):
        names = ", ".join(f"{kind} with {count} points" for kind, count in kinds) or "none"
        advice = ""
        if any(kind.startswith("quad") for kind, _ in kinds):
            advice = (
                ": a displacement on quadrilaterals is bilinear there, and another function if they are split into "
                "triangles, so compute again on triangles"
            )
        raise BoundError(
            f"{path} has cells of the kinds {names}, expected linear or quadratic triangles, with 3 or 6 points, alone"
            f"{advice}"
        )
    return np.concatenate([block.data for block in blocks])


def _displacement_name(path: Path, mesh: Any, name: str | None) -> str:
    """Return the name of the displacement field, which must have vectors with 2 or 3 components at the points."""
    vectors = [key for key, data in mesh.point_data.items() if np.ndim(data) == 2 and data.shape[1] in (2, 3)]
    chosen = [key for key in vectors if key == name or (name is None and key.lower() in DISPLACEMENT_NAMES)]
    if len(chosen) != 1 and name is None and len(vectors) == 1:
        chosen = vectors
    if len(chosen) == 1:
        return chosen[0]
    if not vectors:
        fields = ", ".join([*mesh.point_data, *mesh.cell_data]) or "none"
        raise BoundError(
            f"{path} has no vectors at points, only the fields {fields}: write the displacement as one field of "
            "vectors at the points"
        )
    raise BoundError(
        f"{path} does not have {name or 'one displacement'}: its vector fields at points are {', '.join(vectors)}; "
        "choose one with --field NAME"
    )
