"""What ``data/pictures/CASE.json`` holds: one run in space and time, computed and exact."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from study.ledger.datafiles import DataError, made_by, read_csv
from study.ledger.packing import Packed
from study.present.picture.faces import Array, FaceHistory, Polygon, Segment, values


@dataclass(frozen=True, eq=False)
class Shape:
    """The body at one time: the displacement of every vertex, (d, vertices), and the von Mises stress, (cells,)."""

    time: float
    displacement: Array
    von_mises: Array


@dataclass(frozen=True, eq=False)
class Energy:
    """The balance of energy, (times,) each: the stored energy, and what the other terms have summed to since t = 0.

    The defect, stored − stored(0) + dissipated + contact − work, is zero without discretisation in time.
    """

    times: Array
    stored: Array
    dissipated: Array
    contact: Array
    work: Array
    defect: Array


@dataclass(frozen=True, eq=False)
class Picture:
    """One run: the mesh, the deformed body at some times, the faces of Γ3 and the energy over time.

    ``cells`` are triangles: those of the mesh in the plane, those of its surface in space, where their corners run
    counter-clockwise seen from outside.
    """

    case: str
    family: str
    level: int
    times: Array
    vertices: Array
    cells: NDArray[np.int64]
    shapes: list[Shape]
    faces: list[FaceHistory]
    energy: Energy

    @classmethod
    def of(cls, record: Mapping[str, Any]) -> Picture:
        """From the content of a file.

        Raises:
            KeyError, TypeError, ValueError: it is not what ``study run`` writes.
        """
        times = np.array(record["times"], dtype=float)
        displacement, von_mises = (Packed.read(record[name]).values for name in ("displacement", "von_mises"))
        shown = [int(np.argmin(abs(times - time))) for time in record["shapes"]]
        cells = np.array(record["cells"], dtype=np.int64)
        plane = len(record["vertices"]) == 2
        return cls(
            case=str(record["case"]),
            family=str(record["family"]),
            level=int(record["level"]),
            times=times,
            vertices=np.array(record["vertices"], dtype=float),
            cells=cells,
            shapes=[Shape(float(times[n]), displacement[n], von_mises[n]) for n in shown],
            faces=[Segment.of(face) if plane else Polygon.of(face, cells) for face in record["faces"]],
            energy=Energy(**{field.name: values(record["energy"][field.name]) for field in fields(Energy)}),
        )

    @property
    def segments(self) -> list[Segment]:
        """The faces of a body in the plane."""
        return [face for face in self.faces if isinstance(face, Segment)]

    @property
    def polygons(self) -> list[Polygon]:
        """The faces of a body in space."""
        return [face for face in self.faces if isinstance(face, Polygon)]

    @property
    def size(self) -> float:
        """The longest side of the box around the body."""
        return float(np.ptp(self.vertices, axis=1).max())

    @property
    def instants(self) -> list[int]:
        """The indices of the times of the shapes."""
        return [self.nearest(shape.time) for shape in self.shapes]

    def nearest(self, time: float) -> int:
        """The index of the time node nearest to a time."""
        return int(np.argmin(abs(self.times - time)))

    @property
    def heading(self) -> str:
        """The case and the mesh it was computed on, as TeX."""
        return f"{self.case} ({self.family}, $n={self.level}$)"

    @property
    def place(self) -> str:
        """The same for captions."""
        return f"{self.case}, {self.family} mesh with n = {self.level}"

    @property
    def times_shown(self) -> str:
        """The times of the shapes, for captions."""
        return ", ".join(f"{shape.time:.3g}" for shape in self.shapes)

    @property
    def names(self) -> str:
        """All faces, for captions."""
        return ", ".join(map(self.name, self.faces))

    def name(self, face: FaceHistory) -> str:
        """Γ3, or Γ3,i where there are several faces, for captions."""
        return f"Γ3,{face.number}" if len(self.faces) > 1 else "Γ3"

    def symbol(self, face: FaceHistory) -> str:
        """The same as TeX mathematics."""
        return rf"\Gamma_{{3,{face.number}}}" if len(self.faces) > 1 else r"\Gamma_3"


def read_pictures(directory: Path) -> list[Picture]:
    """The pictures of the cases of ``cases.csv``, in that order; files of other runs are left alone.

    Raises:
        DataError: there is no such directory, or a file in it is not a picture.
    """
    folder = directory / "data" / "pictures"
    if not folder.is_dir():
        raise DataError(f"{folder} is missing: make it with `{made_by(directory)}`")
    names = read_csv(directory, "cases.csv", ["case"])["case"]
    return [_read(path) for name in names if (path := folder / f"{name}.json").is_file()]


def _read(path: Path) -> Picture:
    try:
        return Picture.of(json.loads(path.read_text(encoding="utf-8")))
    except (KeyError, TypeError, ValueError) as error:
        raise DataError(f"{path} is not a picture ({error!r}): make it again with `study run`") from error


def over_time(record: Mapping[str, Any]) -> tuple[Packed, Packed]:
    """Displacement of the vertices, (times, d, vertices), and von Mises stress of the cells, (times, cells).

    Raises:
        KeyError, TypeError, ValueError: the content of the file lacks them, or has them on another mesh.
    """
    times, vertices, cells = len(record["times"]), np.shape(record["vertices"]), np.shape(record["cells"])
    return _packed(record["displacement"], (times, *vertices)), _packed(record["von_mises"], (times, cells[1]))


def with_every_shape(record: Mapping[str, Any]) -> Picture:
    """The picture with a shape at each of its times; errors as in ``over_time``."""
    picture, (displacement, von_mises) = Picture.of(record), over_time(record)
    every = zip(picture.times, displacement.values, von_mises.values, strict=True)
    return replace(picture, shapes=[Shape(float(time), u, stress) for time, u, stress in every])


def _packed(entry: Mapping[str, Any], shape: tuple[int, ...]) -> Packed:
    found = Packed.read(entry)
    if found.multiples.shape != shape:
        raise ValueError(f"shape {found.multiples.shape}, expected {shape}")
    return found
