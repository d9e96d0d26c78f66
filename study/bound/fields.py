"""Read the displacement of another program from a file: .npz, or any mesh format that meshio reads."""

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from manufactured.tensors import Array
from study.bound.problem import BoundError

ARRAYS = ("points", "triangles", "times", "u")
"""Names of the arrays in an .npz file with a displacement."""
OURS = {"p": "points", "t": "triangles"}
"""Other names of these arrays, in files that ``study bound`` writes. There the arrays are stored transposed."""
DISPLACEMENT = ("u", "displacement", "displacements", "u_h", "uh", "disp")
"""Names, in lower case, by which the displacement is recognised among the fields of a mesh file."""
CELLS = {"triangle": 3, "triangle6": 6}
IGNORED = ("vertex", "line", "line3")
"""Types of cells that are ignored: mesh files often contain points and boundary edges besides the triangles."""


@dataclass(frozen=True)
class Field:
    """The mesh, times and displacements from a file. If the file has no times, ``times`` is None.

    The arrays have the shapes that ``study.bound.given.given`` describes.
    """

    points: Array
    triangles: Array
    times: Array | None
    u: Array


def read(path: Path | str, name: str | None = None) -> Field:
    """Read a mesh, times and displacements from a file.

    Args:
        path: an .npz file with ``points``, ``triangles``, ``times`` and ``u``, or as ``study bound`` writes it; a .pvd
            file; an .xdmf file with a time series; or for a static problem a file with one mesh, such as .vtu.
        name: the name of the displacement field in a mesh file. By default this is a name in ``DISPLACEMENT``, or the
            only vector field.

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
            return _npz(path)
        if kind == ".pvd":
            entries = [entry.attrib for entry in ET.parse(path).getroot().iter("DataSet")]
            files = ((float(entry["timestep"]), _meshio().read(path.parent / entry["file"])) for entry in entries)
            return _together(path, files, name)
        if kind in (".xdmf", ".xmf"):
            return _together(path, _xdmf(path), name)
        return _together(path, [(None, _meshio().read(path))], name)
    except (OSError, ValueError, KeyError, ET.ParseError, BadZipFile, SystemExit) as error:
        if isinstance(error, BoundError):
            raise
        raise BoundError(f"{path} cannot be read: {type(error).__name__}: {error}") from error
    except ImportError as error:
        raise BoundError(f"{path} needs the package {error.name}: install it, or write .npz") from error


def _npz(path: Path) -> Field:
    with np.load(path) as file:
        arrays = {OURS.get(key, key): file[key].T if key in OURS else file[key] for key in file.files}
        ours = "p" in file.files
    missing = [key for key in ("points", "triangles", "u") if key not in arrays]
    if missing:
        raise BoundError(f"{path} lacks {', '.join(missing)}; expected the arrays {', '.join(ARRAYS)}")
    u = arrays["u"].swapaxes(-1, -2) if ours else arrays["u"]
    return Field(arrays["points"], arrays["triangles"], arrays.get("times"), u)


def _meshio() -> Any:
    import meshio  # type: ignore[import-untyped]  # Only files of this kind need it.

    return meshio


def _xdmf(path: Path) -> Iterator[tuple[float | None, Any]]:
    """Yield the times and meshes of an .xdmf file. Without a time series, yield its one mesh and the time None."""
    meshio = _meshio()
    try:
        series = meshio.xdmf.TimeSeriesReader(path)
    except (meshio.ReadError, AttributeError, IndexError):
        yield None, meshio.read(path)
        return
    with series as reader:
        points, cells = reader.read_points_cells()
        for step in range(reader.num_steps):
            time, values, _ = reader.read_data(step)
            yield time, meshio.Mesh(points, cells, point_data=values)


def _together(path: Path, meshes: Iterable[tuple[float | None, Any]], name: str | None) -> Field:
    """Join the displacements at all times into one ``Field``; raise BoundError if the mesh changes in time."""
    first: Any = None
    times, values = [], []
    for time, mesh in meshes:
        first = first or mesh
        if mesh.points.shape != first.points.shape or not np.array_equal(mesh.points, first.points):
            raise BoundError(f"{path} has another mesh at t = {time} than before; give one mesh for all times")
        times.append(time)
        values.append(_vector(path, mesh, name))
    if first is None:
        raise BoundError(f"{path} lists no mesh")
    all_times = None if None in times else np.array(times, dtype=float)
    return Field(first.points, _triangles(path, first), all_times, np.array(values))


def _triangles(path: Path, mesh: Any) -> Array:
    """Return the point numbers of the triangles in a mesh file: (cells, 3) if linear, (cells, 6) if quadratic."""
    blocks = [block for block in mesh.cells if block.type not in IGNORED]
    kinds = sorted({block.type for block in blocks})
    if len(kinds) != 1 or kinds[0] not in CELLS:
        raise BoundError(
            f"{path} has cells of the kinds {', '.join(kinds) or 'none'}, expected triangle (linear) or triangle6 "
            "(quadratic) alone"
        )
    return np.concatenate([block.data for block in blocks])


def _vector(path: Path, mesh: Any, name: str | None) -> Array:
    """Find the displacement field of a mesh by its name and return its values at the points, (points, 2 or 3)."""
    vectors = {key: data for key, data in mesh.point_data.items() if np.ndim(data) == 2 and data.shape[1] in (2, 3)}
    known = [key for key in vectors if key.lower() in DISPLACEMENT]
    chosen = [name] if name is not None else known if len(known) == 1 else list(vectors)
    if len(chosen) != 1 or chosen[0] not in vectors:
        wanted = f"the field {name!r}" if name is not None else "one displacement"
        raise BoundError(
            f"{path} does not have {wanted}: its vector fields at points are {', '.join(vectors) or 'none'}; choose "
            "one with --field NAME"
        )
    return np.asarray(vectors[chosen[0]], dtype=float)
