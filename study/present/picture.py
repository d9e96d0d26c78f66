"""The data of figures of one run: displacements, stresses, gaps and pressures over time, from ``data/pictures``."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from copy import copy
from dataclasses import dataclass, fields
from json import loads
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from pandas import DataFrame

from study.ledger.datafiles import DataError, made_by, read_csv, read_uncompressed
from study.ledger.files import Json
from study.ledger.pictures import Array, Facets, Numbers, Packed

Bools = NDArray[np.bool_]
ZONE_SAMPLES = 10_001
"""The number of positions along a face at which exact and computed contact zones are compared."""
Interval = tuple[float, float]
CONTACT_SHARE = 1e-8
"""A node is in contact if its pressure exceeds this fraction of the largest pressure on the face."""


@dataclass(frozen=True, eq=False)
class FaceHistory:
    """Gap and pressure at the nodes of a contact face Γ3,i over time, computed and exact.

    Attributes:
        times: the times, (times,).
        number: the index i of the face.
        normal: the outward unit normal ν, (d,).
        s: coordinates of the nodes along the face, (nodes,) in 2D and (2, nodes) in 3D.
        x: coordinates of the nodes in space, (d, nodes).
        gap, gap_exact: the gap −u_ν, (times, nodes).
        pressure, pressure_exact: the contact pressure −σ_ν, (times, nodes).
    """

    times: Array
    number: int
    normal: Array
    s: Array
    x: Array
    gap: Array
    gap_exact: Array
    pressure: Array
    pressure_exact: Array

    @property
    def touching(self) -> Bools:
        """Whether each node is in contact at each time, (times, nodes)."""
        return self.pressure > CONTACT_SHARE * self.pressure.max(initial=0.0)

    @property
    def inside(self) -> Bools:
        """Whether each node is in the exact contact zone at each time, (times, nodes)."""
        raise NotImplementedError

    @property
    def outside(self) -> Bools:
        """Whether each node is in contact outside the exact zone at each time, (times, nodes).

        At the first time, at which nothing has been solved, all entries are false.
        """
        found = self.touching & ~self.inside
        found[0] = False
        return found


@dataclass(frozen=True, eq=False)
class Segment(FaceHistory):
    """A contact face of a body in 2D.

    Attributes:
        zone_times: the times at which the exact contact zone is known.
        zone: the intervals [s0, s1] of the exact contact zone at each of these times.
        line: positions along the face, at and between the nodes, (points,).
        line_gap, line_pressure: exact gap and exact pressure at these positions, (times, points).
    """

    zone_times: Array
    zone: list[list[Interval]]
    line: Array
    line_gap: Array
    line_pressure: Array

    @property
    def inside(self) -> Bools:
        """Whether each node is in the exact contact zone at each time, (times, nodes)."""
        return self.in_exact_zone(self.s)

    def in_exact_zone(self, s: Array) -> Bools:
        """Return whether positions along the face are in the exact contact zone at each time, (times, positions)."""
        return self.depth(map(self.exact_zone, self.times), s) >= 0

    def computed_zone(self, instant: int) -> list[Interval]:
        """Return the computed contact zone at the time with the index ``instant``, as intervals.

        The zone contains the points of the face whose nearest node is in contact.
        """
        middle = (self.s[1:] + self.s[:-1]) / 2
        ends = np.concatenate([self.s[:1], middle, self.s[-1:]])
        change = np.flatnonzero(np.diff(self.touching[instant], prepend=False, append=False))
        return list(zip(ends[change[::2]], ends[change[1::2]], strict=True))

    def exact_zone(self, time: float) -> list[Interval]:
        """Return the intervals of the exact contact zone at a time.

        Between the times at which the zone is known, the ends of the intervals are interpolated linearly. If intervals
        appear, vanish, merge or split there, the zone at the nearer time is returned.
        """
        late = max(1, int(np.searchsorted(self.zone_times, time)))
        before, after = self.zone[late - 1 : late + 1]
        start, end = self.zone_times[late - 1 : late + 1]
        share = (time - start) / (end - start)
        if len(before) != len(after):
            return before if share < 0.5 else after
        ends = (1 - share) * np.array(before) + share * np.array(after)
        return [(left, right) for left, right in ends]

    def depth(self, zones: Iterable[Sequence[Interval]], s: Array) -> Array:
        """Return how far positions lie inside contact zones, (zones, positions); outside, values are negative.

        The depth is the distance to the nearest end of the zone. Ends of a zone that are ends of the face do not count.
        If a zone is empty, its values are minus infinity.

        Parameters:
            zones: the intervals of each zone.
            s: positions along the face, (positions,).
        """
        depths = []
        for zone in zones:
            depth = np.full(len(s), -inf)
            for left, right in zone:
                from_left = s - left if left > s.min() else inf
                from_right = right - s if right < s.max() else inf
                depth = np.maximum(depth, np.minimum(from_left, from_right))
            depths.append(depth)
        return np.array(depths)


@dataclass(frozen=True, eq=False)
class Polygon(FaceHistory):
    """A contact face of a body in 3D.

    Attributes:
        facets: the triangles whose corners are all nodes. Vertices on Γ1 are not nodes, so triangles with such a corner
            are left out.
        nodes: the vertex numbers of the nodes in the mesh, (nodes,).
        level: the level function ψ at the nodes and at the midpoints of the edges between them, (times, nodes + edges);
            the exact contact zone is the set where ψ ≥ 0.
    """

    facets: Facets
    nodes: Numbers
    level: Array

    @property
    def inside(self) -> Bools:
        """Whether each node is in the exact contact zone at each time, (times, nodes)."""
        return self.level[:, : len(self.nodes)] >= 0


class Picture:
    """The data of one run: mesh, displacement, stress, contact and contact faces over time.

    Parameters:
        record: the content of the JSON file of the run.

    Attributes:
        case, family, level: the case, the mesh family and the level of the mesh.
        times: all times, (times,).
        vertices: coordinates of the vertices, (d, vertices).
        cells: vertex numbers of the triangles, (3, cells): of the mesh in 2D; in 3D of the surface of the mesh,
            counter-clockwise seen from outside.
        displacement: displacements of the vertices, (times, d, vertices).
        von_mises: von Mises stresses of the cells, (times, cells).
        shown: the indices of the times at which figures show the body.
        faces: the contact faces.
        heading, place: the case, the mesh family and the level, as a title with TeX formulas, and as text for captions.

    Raises:
        KeyError, TypeError, ValueError: the content was not written by ``study run``, or the shapes of the
            displacements or stresses do not agree with the mesh.
    """

    def __init__(self, record: Json) -> None:
        self.case = str(record["case"])
        self.family = record["family"]
        self.level = int(record["level"])
        names = ("times", "vertices", "displacement", "von_mises")
        self.times, self.vertices, self.displacement, self.von_mises = (read_values(record[name]) for name in names)
        self.cells = np.array(record["cells"], dtype=np.int64)
        count = len(self.times)
        sizes = (self.displacement, (count, *self.vertices.shape)), (self.von_mises, (count, self.cells.shape[1]))
        for values, expected in sizes:
            if values.shape != expected:
                raise ValueError(f"shape {values.shape}, expected {expected}")
        plane = len(self.vertices) == 2
        self.shown: Sequence[int] = [int(np.argmin(abs(self.times - time))) for time in record["shapes"]]
        self.faces = [_face(face, self.times, self.cells, plane) for face in record["faces"]]
        self.heading = f"{self.case} ({self.family}, $n={self.level}$)"
        self.place = f"{self.case}, {self.family} mesh with n = {self.level}"

    @property
    def segments(self) -> list[Segment]:
        """The contact faces of a body in 2D; empty in 3D."""
        return [face for face in self.faces if isinstance(face, Segment)]

    @property
    def polygons(self) -> list[Polygon]:
        """The contact faces of a body in 3D; empty in 2D."""
        return [face for face in self.faces if isinstance(face, Polygon)]

    @property
    def on_faces(self) -> DataFrame:
        """Gap and pressure, computed and exact, with one row for each time and node of a contact face."""
        tables = []
        for face in self.faces:
            columns = {"time": np.repeat(face.times, face.x.shape[1]), "face": face.number}
            columns |= {f"x{i}": np.tile(x, len(face.times)) for i, x in enumerate(face.x, start=1)}
            for name in ("gap", "gap_exact", "pressure", "pressure_exact"):
                columns[name] = getattr(face, name).ravel()
            tables.append(DataFrame(columns))
        return pd.concat(tables)

    def showing(self, instants: Sequence[int]) -> Picture:
        """Return the data for figures that show the body at the times with these indices."""
        found = copy(self)
        found.shown = instants
        return found

    def at_every(self, step: int) -> Picture:
        """Return the data for figures that show the body at every ``step``-th time, from the first time on."""
        return self.showing(range(0, len(self.times), step))

    def clock(self, instant: int) -> str:
        """Return the time with the index ``instant`` as a title, with TeX formulas."""
        return f"$t={self.times[instant]:.3g}$"

    @property
    def times_shown(self) -> str:
        """The times at which figures show the body, as text for captions."""
        return ", ".join(f"{time:.3g}" for time in self.times[self.shown])

    @property
    def names(self) -> str:
        """The names of all contact faces as text for captions."""
        return ", ".join(map(self.name, self.faces))

    def name(self, face: FaceHistory) -> str:
        """Return the name of a contact face for captions: Γ3, or Γ3,i if the body has several contact faces."""
        return f"Γ3,{face.number}" if len(self.faces) > 1 else "Γ3"

    def symbol(self, face: FaceHistory) -> str:
        """Return the name of a contact face as a TeX formula."""
        return rf"$\Gamma_{{3,{face.number}}}$" if len(self.faces) > 1 else r"$\Gamma_3$"


def read_values(entry: Any) -> Array:
    """Return the array in an entry of a JSON file, which is a list of numbers or has the form of ``Packed.record``."""
    return Packed.read(entry).values if isinstance(entry, dict) else np.array(entry, dtype=float)


def _face(record: Json, times: Array, cells: Numbers, plane: bool) -> FaceHistory:
    """Return a contact face from its entry in the JSON file of a run.

    Parameters:
        record: the entry.
        times: the times, (times,).
        cells: the triangles of the mesh or of its surface, as in ``Picture``.
        plane: whether the body is two-dimensional.
    """
    names = [field.name for field in fields(FaceHistory) if field.name not in ("times", "number")]
    common: Json = {name: read_values(record[name]) for name in names}
    common |= {"times": times, "number": record["face"]}
    if not plane:
        nodes = np.array(record["nodes"], dtype=np.int64)
        level = read_values(record["level_exact"])
        return Polygon(**common, facets=Facets.between(nodes, cells), nodes=nodes, level=level)
    zone = record["zone_exact"]
    line = record["line"]
    return Segment(
        **common,
        zone_times=read_values(zone["times"]),
        zone=[[(float(a), float(b)) for a, b in intervals] for intervals in zone["intervals"]],
        line=read_values(line["s"]),
        line_gap=read_values(line["gap"]),
        line_pressure=read_values(line["pressure"]),
    )


def picture_path(directory: Path, case: str) -> Path:
    """Return the path of the JSON file with the data for figures of a case, in a result directory."""
    return directory / "data" / "pictures" / f"{case}.json.gz"


def read_record(path: Path) -> Json:
    """Return the content of a compressed JSON file; raises ValueError if the file is damaged."""
    return loads(read_uncompressed(path))


def read_picture(directory: Path, case: str) -> Picture:
    """Return the data for figures of a case from the file in ``data/pictures`` of a result directory.

    Raises:
        DataError: the file is missing or damaged, or an older version wrote it without displacements over time.
    """
    path = picture_path(directory, case)
    if not path.is_file():
        raise DataError(f"{path} is missing: make it with `{made_by(directory)}`")
    try:
        return Picture(read_record(path))
    except (KeyError, TypeError, ValueError) as error:
        raise DataError(
            f"{path} is not a picture with displacement and von_mises over time ({error!r}): if an older version wrote "
            "it, make it again with the same `study run`"
        ) from error


def read_pictures(directory: Path) -> list[Picture]:
    """Return the data for figures of all cases of a result directory, in the order of ``cases.csv``.

    Cases without a file in ``data/pictures`` are left out; files of cases that are not in ``cases.csv`` are ignored.

    Raises:
        DataError: the folder ``data/pictures`` is missing, or a file in it is damaged.
    """
    folder = picture_path(directory, "").parent
    if not folder.is_dir():
        raise DataError(f"{folder} is missing: make it with `{made_by(directory)}`")
    names = read_csv(directory, "cases.csv")["case"]
    return [read_picture(directory, name) for name in names if picture_path(directory, name).is_file()]


def misplaced_length(face: Segment) -> Array:
    """Return the error of the computed contact zone of a face in 2D at all times after the first, (times − 1,).

    The error is the length of the symmetric difference of the exact zone and of ``Segment.computed_zone``, divided by
    the length of a cell: the sum of the errors of all fronts, in cells. It is also defined at times when intervals of
    the zone appear, vanish, merge or split. A clamped end of a face, which is not a node, is left out. Lengths are
    sampled at ``ZONE_SAMPLES`` positions.
    """
    s = np.linspace(face.s.min(), face.s.max(), ZONE_SAMPLES)
    nearest = abs(s[:, None] - face.s).argmin(axis=1)
    wrong = face.in_exact_zone(s) != face.touching[:, nearest]
    return wrong[1:].mean(axis=1) * (len(face.s) - 1)
