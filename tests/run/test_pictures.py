"""The picture of a solid: its surface and what happens on its contact faces, as solved, in little space."""

import json
from functools import cache

import numpy as np
import pytest
from costly_cases import slow_unless

from manufactured.catalogue import NAMES
from study.fem.mesh import Skin
from study.fem.naming import resolve
from study.ledger.pictures import FINE_UNITS, UNITS
from study.present.picture import Picture
from study.solve.motion import Motion
from study.statements import pictures
from study.statements.pictures import record

SOLIDS = [slow_unless(name == "cube-disc", name) for name in NAMES if name.startswith("cube")]
"""One solid is quick; the formulas of each take seconds to compile."""


@cache
def solved(case):
    """A motion on a coarse mesh, and its picture as a reader of the file has it."""
    motion = Motion.of(resolve(case).solution, pictures.SOLID_FAMILY, 3, 4)
    return motion, Picture(json.loads(json.dumps(record(case, motion, 2))))


def vectors(x, triangles):
    """Area times normal of triangles, (k, 3)."""
    a, b, c = (x[:, corner].T for corner in triangles)
    return np.cross(b - a, c - a) / 2


@pytest.mark.parametrize("case", SOLIDS)
def test_the_surface_of_a_solid_is_closed_and_seen_from_outside(case):
    """∫ ν = 0 and ∫ x·ν/3 = |Ω|."""
    motion, picture = solved(case)
    areas = vectors(picture.vertices, picture.cells)
    centres = picture.vertices[:, picture.cells].mean(axis=1).T
    np.testing.assert_allclose(areas.sum(axis=0), 0, atol=1e-3)
    assert np.sum(centres * areas) / 3 == pytest.approx(motion.solution.body.measure, rel=1e-3)


@pytest.mark.parametrize("case", SOLIDS)
def test_displacement_gap_and_pressure_are_those_of_the_motion_at_the_vertices(case):
    motion, picture = solved(case)
    space, start = motion.space, 0
    weights = pictures.contact_weights(space)
    for face, (part, vertices) in zip(picture.polygons, space.contact, strict=True):
        rows = slice(start, start + len(vertices))
        start += len(vertices)
        by_place = {tuple(np.round(x, 3)): i for i, x in enumerate(space.mesh.p[:, vertices].T)}
        order = [by_place[tuple(np.round(x, 3))] for x in picture.vertices[:, face.nodes].T]
        assert sorted(order) == list(range(len(vertices)))
        np.testing.assert_allclose(face.normal, part.normal)
        np.testing.assert_allclose(part.point(face.s), picture.vertices[:, face.nodes], atol=1e-3)
        for n, frame in enumerate(motion.frames[::2]):
            gap, pressure = -frame.normal[rows][order], (frame.multipliers / weights)[rows][order]
            np.testing.assert_allclose(face.gap[n], gap, atol=0.51 * abs(face.gap).max() / FINE_UNITS)
            np.testing.assert_allclose(face.pressure[n], pressure, atol=0.51 * abs(face.pressure).max() / FINE_UNITS)
            np.testing.assert_array_equal(face.touching[n], pressure > 0)
    largest = max(abs(space.nodal(frame.u)).max() for frame in motion.frames[::2])
    for instant in picture.shown:
        (frame,) = (frame for frame in motion.frames if frame.time == picture.times[instant])
        moved = space.nodal(frame.u)[:, Skin.of(space.mesh).vertices]
        # Three digits of the largest displacement at any time: a tenth of a pixel.
        np.testing.assert_allclose(picture.displacement[instant], moved, atol=0.51 * largest / UNITS)
