"""One run in space and time, computed and exact, as stored in ``data/pictures/CASE.json.gz``."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from study.ledger.datafiles import DataError, made_by, read_csv, read_uncompressed
from study.ledger.pictures import Facets, Packed

Array = NDArray[np.float64]
Interval = tuple[float, float]
CONTACT = 1e-8
"""A node counts as in contact if its pressure exceeds this fraction of the largest pressure on the face."""


@dataclass(frozen=True, eq=False)
class FaceHistory:
    """Gap and pressure on a face of Γ3 over time, computed and exact.

    Attributes:
        number: i of Γ3,i.
        normal: ν, outward, (d,).
        s: coordinates of the nodes on the face, (nodes,) in 2D and (2, nodes) in 3D.
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
    def contact_threshold(self) -> float:
        """The pressure above which a node counts as in contact."""
        return CONTACT * float(self.pressure.max(initial=0.0))

    @property
    def touching(self) -> NDArray[np.bool_]:
        """Whether a node is in contact, (times, nodes)."""
        return np.asarray(self.pressure > self.contact_threshold)


@dataclass(frozen=True, eq=False)
class Segment(FaceHistory):
    """A face of Γ3 in 2D.

    Attributes:
        zone_times: times at which the exact contact zone is known.
        zone: the intervals [s0, s1] of the exact zone at each of these times.
        line: positions, at and between the nodes, of ``line_gap`` and ``line_pressure``, (points,).
        line_gap, line_pressure: exact values, (times, points).
    """

    zone_times: Array
    zone: list[list[Interval]]
    line: Array
    line_gap: Array
    line_pressure: Array

    @property
    def spacing(self) -> float:
        """The mean distance of neighbouring nodes, which is the length of a cell."""
        return float(np.ptp(self.s)) / (len(self.s) - 1)

    def computed_zone(self, instant: int) -> list[Interval]:
        """Return the part of the face whose nearest node is in contact, as intervals between midpoints of nodes."""
        middle = (self.s[1:] + self.s[:-1]) / 2
        ends = np.concatenate([self.s[:1], middle, self.s[-1:]])
        change = np.flatnonzero(np.diff(self.touching[instant], prepend=False, append=False))
        return [(float(ends[a]), float(ends[b])) for a, b in zip(change[::2], change[1::2], strict=True)]

    def exact_zone(self, time: float) -> list[Interval]:
        """Return the exact zone at a time, linearly interpolated between the times at which it is known."""
        columns = [np.array(strand).T for strand in strands(self.zone_times, self.zone)]
        return [
            (float(np.interp(time, t, left)), float(np.interp(time, t, right)))
            for t, left, right in columns
            if t[0] <= time <= t[-1]
        ]

    def point(self, s: Array) -> Array:
        """Return the points at positions s, (2, ...)."""
        return np.array([np.interp(s, self.s, component) for component in self.x])


@dataclass(frozen=True, eq=False)
class Polygon(FaceHistory):
    """A face of Γ3 in 3D.

    Attributes:
        facets: the triangles between the nodes; triangles with a corner on Γ1, which is not a node, are left out.
        nodes: the indices of the nodes among the vertices of the picture, (nodes,).
        level: ψ at the nodes and at the midpoints between them, (times, nodes + edges); the exact zone is {ψ ≥ 0}.
    """

    facets: Facets
    nodes: NDArray[np.int64]
    level: Array

    @property
    def inside(self) -> NDArray[np.bool_]:
        """Whether a node is in the exact zone, (times, nodes)."""
        return np.asarray(self.level[:, : len(self.nodes)] >= 0)


@dataclass(frozen=True, eq=False)
class Shape:
    """The body at one time: the displacement of every vertex, (d, vertices), and the von Mises stress, (cells,)."""

    time: float
    displacement: Array
    von_mises: Array


@dataclass(frozen=True, eq=False)
class Energy:
    """The energy balance, (times,) each: the stored energy, and the other terms summed since t = 0.

    Without discretisation in time the defect, stored − stored(0) + dissipated + contact − work, would be zero.
    """

    times: Array
    stored: Array
    dissipated: Array
    contact: Array
    work: Array
    defect: Array


@dataclass(frozen=True, eq=False)
class Picture:
    """One run: the mesh, the deformed body at selected times, the faces of Γ3 and the energy over time.

    ``cells`` are the triangles of the mesh in 2D, or of its surface in 3D, counter-clockwise seen from outside, (3,
    cells).
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
        """Return the picture in a JSON file.

        Raises:
            KeyError, TypeError, ValueError: the content was not written by ``study run``.
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
            faces=[_face(face, cells, plane) for face in record["faces"]],
            energy=Energy(**{field.name: read_values(record["energy"][field.name]) for field in fields(Energy)}),
        )

    @property
    def segments(self) -> list[Segment]:
        """The faces of a 2D body."""
        return [face for face in self.faces if isinstance(face, Segment)]

    @property
    def polygons(self) -> list[Polygon]:
        """The faces of a 3D body."""
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
        """Return the index of the time node nearest to a time."""
        return int(np.argmin(abs(self.times - time)))

    @property
    def heading(self) -> str:
        """The case and its mesh, as TeX."""
        return f"{self.case} ({self.family}, $n={self.level}$)"

    @property
    def place(self) -> str:
        """The case and its mesh, for captions."""
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
        """Return Γ3, or Γ3,i if there are several faces, for captions."""
        return f"Γ3,{face.number}" if len(self.faces) > 1 else "Γ3"

    def symbol(self, face: FaceHistory) -> str:
        """Return the name of a face as TeX mathematics."""
        return rf"\Gamma_{{3,{face.number}}}" if len(self.faces) > 1 else r"\Gamma_3"


def read_values(entry: Any) -> Array:
    """Return an array from packed numbers, or from a list of numbers."""
    return Packed.read(entry).values if isinstance(entry, Mapping) else np.array(entry, dtype=float)


def _face(record: Mapping[str, Any], cells: NDArray[np.int64], plane: bool) -> FaceHistory:
    """Return a face from one entry of ``faces``."""
    names = [field.name for field in fields(FaceHistory) if field.name != "number"]
    common: dict[str, Any] = {"number": int(record["face"])} | {name: read_values(record[name]) for name in names}
    if not plane:
        nodes, level = np.array(record["nodes"], dtype=np.int64), read_values(record["level_exact"])
        return Polygon(**common, facets=Facets.between(nodes, cells), nodes=nodes, level=level)
    zone, line = record["zone_exact"], record["line"]
    return Segment(
        **common,
        zone_times=np.array(zone["times"], dtype=float),
        zone=[[(float(a), float(b)) for a, b in intervals] for intervals in zone["intervals"]],
        line=np.array(line["s"], dtype=float),
        line_gap=Packed.read(line["gap"]).values,
        line_pressure=Packed.read(line["pressure"]).values,
    )


def picture_path(directory: Path, case: str) -> Path:
    """Return the path of the picture of a case in a result directory."""
    return directory / "data" / "pictures" / f"{case}.json.gz"


def read_record(path: Path) -> dict[str, Any]:
    """Return the content of the file of a picture; raises ValueError if the file is damaged."""
    record: dict[str, Any] = json.loads(read_uncompressed(path))
    return record


def read_pictures(directory: Path) -> list[Picture]:
    """Return the pictures of the cases in ``cases.csv``, in their order there; files of other runs are ignored.

    Raises:
        DataError: there is no such directory, or a file in it is not a picture.
    """
    folder = directory / "data" / "pictures"
    if not folder.is_dir():
        raise DataError(f"{folder} is missing: make it with `{made_by(directory)}`")
    names = read_csv(directory, "cases.csv", ["case"])["case"]
    pictures = []
    for path in (picture_path(directory, name) for name in names):
        if path.is_file():
            try:
                pictures.append(Picture.of(read_record(path)))
            except (KeyError, TypeError, ValueError) as error:
                raise DataError(f"{path} is not a picture ({error!r}): make it again with `study run`") from error
    return pictures


def over_time(record: Mapping[str, Any]) -> tuple[Packed, Packed]:
    """Return the displacement of the vertices, (times, d, vertices), and the stress of the cells, (times, cells).

    Raises:
        KeyError, TypeError, ValueError: the file lacks them, or has them on another mesh.
    """
    times, vertices, cells = len(record["times"]), np.shape(record["vertices"]), np.shape(record["cells"])
    packed = Packed.read(record["displacement"]), Packed.read(record["von_mises"])
    for found, expected in zip(packed, ((times, *vertices), (times, cells[1])), strict=True):
        if found.multiples.shape != expected:
            raise ValueError(f"shape {found.multiples.shape}, expected {expected}")
    return packed


def with_every_shape(record: Mapping[str, Any]) -> Picture:
    """Return the picture with a shape at each of its times; raises the errors of ``over_time``."""
    picture, (displacement, von_mises) = Picture.of(record), over_time(record)
    every = zip(picture.times, displacement.values, von_mises.values, strict=True)
    return replace(picture, shapes=[Shape(float(time), u, stress) for time, u, stress in every])


# The exact contact zone in 2D over time.

Strand = list[tuple[float, float, float]]
"""One interval of a zone from event to event: (t, s0, s1) in increasing time.

At every time the zone is a union of intervals. Their number changes in events: an interval appears or disappears, two
intervals merge, or one splits.
"""


def misplaced_length(face: Segment, times: Array) -> Array:
    """Return |Z(t) Δ Z^h(t)|/h at the times after the first: the sum of the errors of all fronts in cells, (times −
    1,).

    Z^h is ``Segment.computed_zone``. The measure of the symmetric difference is defined even during events, and it
    includes every node on the wrong side. Clamped ends of a face, which have no node, do not count.
    """
    low, high = float(face.s.min()), float(face.s.max())
    lengths = []
    for instant in range(1, len(times)):
        exact = [(max(a, low), min(b, high)) for a, b in face.exact_zone(times[instant]) if a < high and b > low]
        zones = exact, face.computed_zone(instant)
        length = 0.0
        for a, b in pairwise(sorted({end for zone in zones for interval in zone for end in interval})):
            in_exact, in_computed = (any(left <= (a + b) / 2 <= right for left, right in zone) for zone in zones)
            length += (b - a) * (in_exact != in_computed)
        lengths.append(length)
    return np.array(lengths) / face.spacing


def misplaced_nodes(face: Polygon) -> Array:
    """Return how many nodes are in contact outside the exact zone or not in contact inside, after the first time."""
    return np.asarray((face.touching != face.inside)[1:].sum(axis=1))


def outside(face: FaceHistory, times: Array) -> NDArray[np.bool_]:
    """Return whether a node is in contact outside the exact zone, after the first time, (times, nodes)."""
    if isinstance(face, Segment):
        zones = map(face.exact_zone, times)
        inside = np.array([[any(a <= s <= b for a, b in zone) for s in face.s] for zone in zones])
    else:
        assert isinstance(face, Polygon)
        inside = face.inside
    found = face.touching & ~inside
    found[0] = False
    return np.asarray(found)


def strands(times: Array, zone: Sequence[Sequence[Interval]]) -> list[Strand]:
    """Return the strands of a zone; an event between two known times is assumed halfway between them."""
    done: list[Strand] = []
    growing: list[Strand] = []
    for i, intervals in enumerate(zone):
        before: Sequence[Interval] = zone[i - 1] if i else []
        if i and len(before) == len(intervals) and all(map(_meet, before, intervals)):
            for strand, (left, right) in zip(growing, intervals, strict=True):
                strand.append((float(times[i]), left, right))
            continue
        event = float(times[max(i - 1, 0)] + times[i]) / 2
        for strand, interval in zip(growing, before, strict=True):
            strand.append((event, *_tip(interval, intervals, zone[max(i - 2, 0)])))
        done += growing
        across, along = before if i else intervals, zone[min(i + 1, len(zone) - 1)]
        growing = [[(event, *_tip(own, across, along)), (float(times[i]), *own)] for own in intervals]
    return done + growing


def caps(pieces: Sequence[Strand]) -> list[tuple[float, float, float]]:
    """Return the boundary of a zone at constant t: (t, s0, s1) where a single strand begins or ends."""
    tips = [tip for piece in pieces for tip in (piece[0], piece[-1])]
    found = []
    for t in sorted({tip[0] for tip in tips}):
        here = [(left, right) for time, left, right in tips if time == t]
        for left, right in pairwise(sorted({end for interval in here for end in interval})):
            # No two strands on the same side of an event overlap, so an interval covered by two lies inside the zone.
            if sum(a <= left and right <= b for a, b in here) == 1:
                found.append((t, left, right))
    return found


def _tip(interval: Interval, across: Sequence[Interval], along: Sequence[Interval]) -> Interval:
    """Return the end of a strand at an event, from the intervals beyond the event and the intervals along the strand.

    The end is the whole interval if it meets another strand or appears at once over its whole length, else its
    midpoint.
    """
    if any(_meet(interval, other) for other in across) or interval in along:
        return interval
    centre = sum(interval) / 2
    return centre, centre


def _meet(one: Interval, other: Interval) -> bool:
    return max(one[0], other[0]) <= min(one[1], other[1])
