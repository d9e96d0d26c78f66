"""What ``data/pictures/CASE.json`` holds: one run in space and time, computed and exact."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from study.datafiles import DataError, read_csv
from study.packing import Packed

Array = NDArray[np.float64]
CONTACT = 1e-8
"""A node counts as in contact where the pressure exceeds this fraction of its maximum."""


@dataclass(frozen=True, eq=False)
class Shape:
    """The body at one time: the displacement of every vertex, (2, vertices), the von Mises stress, (cells,)."""

    time: float
    displacement: Array
    von_mises: Array


@dataclass(frozen=True, eq=False)
class Energy:
    """The balance of energy, (times,) each: stored, what the rest has summed to since t = 0, and the defect.

    The defect, stored − stored(0) + dissipated + contact − work, is zero without discretisation in time.
    """

    times: Array
    stored: Array
    dissipated: Array
    contact: Array
    work: Array
    defect: Array

    @classmethod
    def of(cls, record: Mapping[str, Any]) -> Energy:
        """From the entry ``energy``."""
        return cls(**{field.name: np.array(record[field.name], dtype=float) for field in fields(cls)})


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
        arrays = ("normal", "s", "x", "gap", "gap_exact", "pressure", "pressure_exact")
        zone = record["zone_exact"]
        return cls(
            number=int(record["face"]),
            **{field: np.array(record[field], dtype=float) for field in arrays},
            zone_times=np.array(zone["times"], dtype=float),
            zone=[[(float(a), float(b)) for a, b in intervals] for intervals in zone["intervals"]],
        )

    @property
    def touching(self) -> NDArray[np.bool_]:
        """Where and when a node is in contact, (times, nodes)."""
        return np.asarray(self.pressure > CONTACT * self.pressure.max(initial=0.0))

    @property
    def spacing(self) -> float:
        """The mean distance of neighbouring nodes, the length of a cell."""
        return float(np.ptp(self.s)) / (len(self.s) - 1)

    def computed_zone(self, instant: int) -> list[tuple[float, float]]:
        """Where nodes in contact are the nearest ones: intervals from midpoint to midpoint."""
        middle = (self.s[1:] + self.s[:-1]) / 2
        ends = np.concatenate([self.s[:1], middle, self.s[-1:]])
        change = np.flatnonzero(np.diff(self.touching[instant], prepend=False, append=False))
        return [(float(ends[a]), float(ends[b])) for a, b in zip(change[::2], change[1::2], strict=True)]

    def point(self, s: Array) -> Array:
        """The points at positions s, (2, ...)."""
        return np.array([np.interp(s, self.s, component) for component in self.x])


@dataclass(frozen=True, eq=False)
class Picture:
    """One run: the mesh, some deformed shapes, the faces and the energy in time."""

    case: str
    family: str
    level: int
    times: Array
    vertices: Array
    cells: NDArray[np.int64]
    shapes: list[Shape]
    faces: list[Face]
    energy: Energy

    @classmethod
    def of(cls, record: Mapping[str, Any]) -> Picture:
        """From what ``study.pictures.picture`` returns."""
        times, von_mises = np.array(record["times"], dtype=float), Packed.read(record["von_mises"]).values
        return cls(
            case=str(record["case"]),
            family=str(record["family"]),
            level=int(record["level"]),
            times=times,
            vertices=np.array(record["vertices"], dtype=float),
            cells=np.array(record["cells"], dtype=np.int64),
            shapes=[
                Shape(
                    time=float(shape["time"]),
                    displacement=np.array(shape["displacement"], dtype=float),
                    von_mises=von_mises[np.argmin(abs(times - shape["time"]))],
                )
                for shape in record["shapes"]
            ],
            faces=[Face.of(face) for face in record["faces"]],
            energy=Energy.of(record["energy"]),
        )

    @classmethod
    def read(cls, path: Path) -> Picture:
        """The picture in a file.

        Raises:
            DataError: the file is not what ``study run`` writes.
        """
        try:
            return cls.of(json.loads(path.read_text(encoding="utf-8")))
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


def name(face: Face, picture: Picture) -> str:
    """Γ3, or Γ3,i where there are several pieces, for captions."""
    return f"Γ3,{face.number}" if len(picture.faces) > 1 else "Γ3"


def place(picture: Picture) -> str:
    """Case and mesh for captions."""
    return f"{picture.case}, {picture.family} mesh with n = {picture.level}"
