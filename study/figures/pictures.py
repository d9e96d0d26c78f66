"""What ``data/pictures/CASE.json`` holds: one run in space and time, computed and exact."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from study.datafiles import DataError, read_csv

Array = NDArray[np.float64]
CONTACT = 1e-8
"""A node counts as in contact where the pressure exceeds this fraction of its maximum."""


@dataclass(frozen=True, eq=False)
class Shape:
    """The displacement of every vertex at one time, (2, vertices)."""

    time: float
    displacement: Array


@dataclass(frozen=True, eq=False)
class Face:
    """One straight piece of Γ3.

    Attributes:
        number: i of Γ3,i.
        normal: ν, outward, (2,).
        s: position along the face, (nodes,).
        x: the nodes, (2, nodes).
        gap, gap_exact: −u_ν, (times, nodes).
        pressure, pressure_exact: −σ_ν, (times, nodes).
        zone_times: times at which the exact zone is known.
        zone: at each of them, the intervals [s0, s1] of the exact zone.
    """

    number: int
    normal: Array
    s: Array
    x: Array
    gap: Array
    gap_exact: Array
    pressure: Array
    pressure_exact: Array
    zone_times: Array
    zone: list[list[tuple[float, float]]]

    @classmethod
    def of(cls, record: Mapping[str, Any]) -> Face:
        """From one entry of ``faces``."""
        fields = ("normal", "s", "x", "gap", "gap_exact", "pressure", "pressure_exact")
        zone = record["zone_exact"]
        return cls(
            number=int(record["face"]),
            **{field: np.array(record[field], dtype=float) for field in fields},
            zone_times=np.array(zone["times"], dtype=float),
            zone=[[(float(a), float(b)) for a, b in intervals] for intervals in zone["intervals"]],
        )

    @property
    def touching(self) -> NDArray[np.bool_]:
        """Where and when a node is in contact, (times, nodes)."""
        return np.asarray(self.pressure > CONTACT * self.pressure.max(initial=0.0))


@dataclass(frozen=True, eq=False)
class Picture:
    """One run: the mesh, three deformed shapes, and the faces in time."""

    case: str
    family: str
    level: int
    times: Array
    vertices: Array
    cells: NDArray[np.int64]
    shapes: list[Shape]
    faces: list[Face]

    @classmethod
    def read(cls, path: Path) -> Picture:
        """The picture in a file.

        Raises:
            DataError: the file is not what ``study run`` writes.
        """
        try:
            record = json.loads(path.read_text(encoding="utf-8"))
            return cls(
                case=str(record["case"]),
                family=str(record["family"]),
                level=int(record["level"]),
                times=np.array(record["times"], dtype=float),
                vertices=np.array(record["vertices"], dtype=float),
                cells=np.array(record["cells"], dtype=np.int64),
                shapes=[Shape(float(s["time"]), np.array(s["displacement"], dtype=float)) for s in record["shapes"]],
                faces=[Face.of(face) for face in record["faces"]],
            )
        except (KeyError, TypeError, ValueError) as error:
            raise DataError(f"{path} is not a picture ({error!r}): make it again with `study run`") from error

    def nearest(self, time: float) -> int:
        """The index of the time node nearest to a time."""
        return int(np.argmin(abs(self.times - time)))


def read_pictures(directory: Path) -> list[Picture]:
    """The pictures of the cases of ``cases.csv``, in that order; files of other runs are left alone.

    Raises:
        DataError: there is no such directory, or a file in it is not a picture.
    """
    folder = directory / "data" / "pictures"
    if not folder.is_dir():
        raise DataError(f"{folder} is missing: make it with `study run --out {directory}`")
    names = read_csv(directory, "cases.csv", ["case"])["case"]
    return [Picture.read(path) for name in names if (path := folder / f"{name}.json").is_file()]


def heading(picture: Picture) -> str:
    """The case and the mesh it was computed on."""
    return f"{picture.case} ({picture.family}, $n={picture.level}$)"


def symbol(face: Face, picture: Picture) -> str:
    """Γ3, or Γ3,i where there are several pieces, for use between dollar signs."""
    return rf"\Gamma_{{3,{face.number}}}" if len(picture.faces) > 1 else r"\Gamma_3"
