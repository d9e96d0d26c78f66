"""The exact contact zone of a face in the plane over time, and how far off the computed one is.

A zone is a union of intervals for every time. It changes its number of intervals in events: an interval appears or
disappears, two merge, or one splits.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from study.present.picture.faces import Array, FaceHistory, Polygon, Segment

Ends = tuple[float, float]
"""Of an interval."""
Intervals = Sequence[Ends]
Strand = list[tuple[float, float, float]]
"""One interval of a zone from event to event: (t, s0, s1) in increasing time."""


def misplaced_length(face: Segment, times: Array) -> Array:
    """|Z(t) Δ Z^h(t)|/h at the times after the first: the distances of all fronts in cells, added up, (times − 1,).

    Z^h is ``Segment.computed_zone``. The measure of the symmetric difference is defined through all events, and no
    node on the wrong side is overlooked. Clamped ends of a face, which have no node, do not count.
    """
    low, high = float(face.s.min()), float(face.s.max())
    differences = []
    for instant, time in list(enumerate(times))[1:]:
        exact = [(max(a, low), min(b, high)) for a, b in exact_zone(face, float(time)) if a < high and b > low]
        differences.append(_difference(exact, face.computed_zone(instant)))
    return np.array(differences) / face.spacing


def misplaced_nodes(face: Polygon) -> Array:
    """How many nodes are in contact outside of the exact zone or free inside, after the first time, (times − 1,)."""
    return np.asarray((face.touching != face.inside)[1:].sum(axis=1))


def outside(face: FaceHistory, times: Array) -> NDArray[np.bool_]:
    """When which nodes are in contact outside of the exact zone, after the first time, (times, nodes)."""
    if isinstance(face, Segment):
        zones = (exact_zone(face, float(time)) for time in times)
        inside = np.array([[any(a <= s <= b for a, b in zone) for s in face.s] for zone in zones])
    else:
        assert isinstance(face, Polygon)
        inside = face.inside
    found = face.touching & ~inside
    found[0] = False
    return np.asarray(found)


def exact_zone(face: Segment, time: float) -> list[Ends]:
    """The exact zone at a time, by linear interpolation between the times at which it is known."""
    pieces = strands(face.zone_times, face.zone)
    columns = [np.array(piece).T for piece in pieces if piece[0][0] <= time <= piece[-1][0]]
    return [(float(np.interp(time, t, left)), float(np.interp(time, t, right))) for t, left, right in columns]


def strands(times: Array, zone: Sequence[Intervals]) -> list[Strand]:
    """The strands of a zone; an event between two known times is taken to be half-way between them."""
    done: list[Strand] = []
    growing: list[Strand] = []
    for i, intervals in enumerate(zone):
        if i and _continues(zone[i - 1], intervals):
            for strand, (left, right) in zip(growing, intervals, strict=True):
                strand.append((float(times[i]), left, right))
            continue
        event = float(times[max(i - 1, 0)] + times[i]) / 2
        for strand, interval in zip(growing, zone[i - 1] if i else [], strict=True):
            strand.append((event, *_tip(interval, intervals, zone[max(i - 2, 0)])))
        done += growing
        before, after = zone[i - 1] if i else intervals, zone[min(i + 1, len(zone) - 1)]
        growing = [[(event, *_tip(own, before, after)), (float(times[i]), *own)] for own in intervals]
    return done + growing


def caps(pieces: Sequence[Strand]) -> list[tuple[float, float, float]]:
    """The parts of the boundary of a zone at constant t: (t, s0, s1) where only one strand begins or ends."""
    tips = [tip for piece in pieces for tip in (piece[0], piece[-1])]
    found = []
    for t in sorted({tip[0] for tip in tips}):
        here = [(left, right) for time, left, right in tips if time == t]
        for left, right in pairwise(sorted({end for interval in here for end in interval})):
            # Strands before an event do not overlap, nor do those after it: what two cover lies inside the zone.
            if sum(a <= left and right <= b for a, b in here) == 1:
                found.append((t, left, right))
    return found


def _tip(interval: Ends, across: Intervals, along: Intervals) -> Ends:
    """The end of a strand at an event, from the intervals beyond the event and those further along the strand.

    The whole interval where it meets another strand or begins at once over its whole length, otherwise its midpoint.
    """
    if any(_meet(interval, other) for other in across) or interval in along:
        return interval
    centre = sum(interval) / 2
    return centre, centre


def _meet(one: Ends, other: Ends) -> bool:
    return max(one[0], other[0]) <= min(one[1], other[1])


def _continues(before: Intervals, after: Intervals) -> bool:
    """Whether each interval goes on in the one of the same place."""
    return len(before) == len(after) and all(_meet(a, b) for a, b in zip(before, after, strict=True))


def _difference(one: Intervals, other: Intervals) -> float:
    """The length of the symmetric difference of two unions of intervals."""
    ends = sorted({end for interval in (*one, *other) for end in interval})
    pieces = [(b - a, (a + b) / 2) for a, b in pairwise(ends)]
    inside = [[any(a <= middle <= b for a, b in zone) for zone in (one, other)] for _, middle in pieces]
    return float(sum(length for (length, _), (here, there) in zip(pieces, inside, strict=True) if here != there))
