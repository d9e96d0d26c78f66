"""What ``data/pictures/CASE.json`` holds: one run in space and time, computed and exact."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from study.ledger.datafiles import DataError, read_csv
from study.ledger.facets import Facets
from study.ledger.packing import Packed

Array = NDArray[np.float64]
CONTACT = 1e-8
"""A node counts as in contact where the pressure exceeds this fraction of its maximum."""


@dataclass(frozen=True, eq=False)
class Shape:
    """The body at one time: the displacement of every vertex, (d, vertices), the von Mises stress, (cells,)."""

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
    """One flat piece of Γ3.

    Attributes:
        number: i of Γ3,i.
        normal: ν, outward, (d,).
        s: positions of the nodes on the face, (nodes,) in the plane and (2, nodes) in space.
        x: the nodes, (d, nodes).
        gap, gap_exact: −u_ν, (times, nodes).
        pressure, pressure_exact: −σ_ν, (times, nodes).
    """

    number: int
    normal: Array
    s: Array
    x: Array
    gap: Array
    gap_exact: Array
    pressure: Array
    pressure_exact: Array

    @property
    def touching(self) -> NDArray[np.bool_]:
        """Where and when a node is in contact, (times, nodes)."""
        return np.asarray(self.pressure > CONTACT * self.pressure.max(initial=0.0))


@dataclass(frozen=True, eq=False)
class Segment(Face):
    """A piece of Γ3 in the plane.

    Attributes:
        zone_times: times at which the exact zone is known.
        zone: at each of them, the intervals [s0, s1] of the exact zone.
        line: positions for lines of exact values, (points,).
        line_gap, line_pressure: the exact values there, (times, points).
    """

    zone_times: Array
    zone: list[list[tuple[float, float]]]
    line: Array
    line_gap: Array
    line_pressure: Array

    @classmethod
    def of(cls, record: Mapping[str, Any]) -> Segment:
        """From one entry of ``faces``."""
        zone, line = record["zone_exact"], record["line"]
        return cls(
            **_of_every_face(record),
            zone_times=np.array(zone["times"], dtype=float),
            zone=[[(float(a), float(b)) for a, b in intervals] for intervals in zone["intervals"]],
            line=np.array(line["s"], dtype=float),
            line_gap=Packed.read(line["gap"]).values,
            line_pressure=Packed.read(line["pressure"]).values,
        )

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
class Polygon(Face):
    """A piece of Γ3 in space.

    Attributes:
        facets: the triangles between its nodes; those with a corner on Γ1, which is no node, are left out.
        nodes: which of the vertices of the picture the nodes are, (nodes,).
        level: ψ at the nodes and at the midpoints between them, (times, nodes + edges): the exact zone is {ψ ≥ 0}.
    """

    facets: Facets
    nodes: NDArray[np.int64]
    level: Array

    @classmethod
    def of(cls, record: Mapping[str, Any], cells: NDArray[np.int64]) -> Polygon:
        """From one entry of ``faces`` and the cells of the picture."""
        nodes = np.array(record["nodes"], dtype=np.int64)
        level = series(record["level_exact"])
        return cls(**_of_every_face(record), facets=Facets.between(nodes, cells), nodes=nodes, level=level)

    @property
    def inside(self) -> NDArray[np.bool_]:
        """Where and when a node is in the exact zone, (times, nodes)."""
        return np.asarray(self.level[:, : len(self.nodes)] >= 0)


def _of_every_face(record: Mapping[str, Any]) -> dict[str, Any]:
    names = [field.name for field in fields(Face)]
    return {"number": int(record["face"])} | {name: series(record[name]) for name in names if name != "number"}


def series(entry: Any) -> Array:
    """Values that are packed, or written as they are."""
    return Packed.read(entry).values if isinstance(entry, Mapping) else np.array(entry, dtype=float)


@dataclass(frozen=True, eq=False)
class Picture:
    """One run: the mesh, some deformed shapes, the faces and the energy in time.

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
    faces: list[Face]
    energy: Energy

    @classmethod
    def of(cls, record: Mapping[str, Any]) -> Picture:
        """From what ``study.statements.pictures.picture`` returns."""
        times, von_mises = np.array(record["times"], dtype=float), Packed.read(record["von_mises"]).values
        cells = np.array(record["cells"], dtype=np.int64)
        plane = len(record["vertices"]) == 2
        return cls(
            case=str(record["case"]),
            family=str(record["family"]),
            level=int(record["level"]),
            times=times,
            vertices=np.array(record["vertices"], dtype=float),
            cells=cells,
            shapes=[
                Shape(
                    time=float(shape["time"]),
                    displacement=series(shape["displacement"]),
                    von_mises=von_mises[np.argmin(abs(times - shape["time"]))],
                )
                for shape in record["shapes"]
            ],
            faces=[Segment.of(face) if plane else Polygon.of(face, cells) for face in record["faces"]],
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

    @property
    def segments(self) -> list[Segment]:
        """The faces of a body in the plane."""
        return [face for face in self.faces if isinstance(face, Segment)]

    @property
    def polygons(self) -> list[Polygon]:
        """The faces of a body in space."""
        return [face for face in self.faces if isinstance(face, Polygon)]

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


CHEAP = "where gap and pressure vanish to high order at a front, this costs next to nothing in the norm of V"
"""What to think of fronts that are off, in captions."""


def name(face: Face, picture: Picture) -> str:
    """Γ3, or Γ3,i where there are several pieces, for captions."""
    return f"Γ3,{face.number}" if len(picture.faces) > 1 else "Γ3"


def place(picture: Picture) -> str:
    """Case and mesh for captions."""
    return f"{picture.case}, {picture.family} mesh with n = {picture.level}"
