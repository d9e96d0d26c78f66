"""The picture of a solid: its surface and what happens on its contact faces, as solved, in little space."""

import json
from functools import cache

import numpy as np
import pytest
from costly_cases import slow_unless
from numpy.testing import assert_allclose
from scipy.spatial import KDTree

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
    assert_allclose(areas.sum(axis=0), 0, atol=1e-3)
    assert np.sum(centres * areas) / 3 == pytest.approx(motion.solution.body.measure, rel=1e-3)


@pytest.mark.parametrize("case", SOLIDS)
def test_displacement_gap_and_pressure_are_those_of_the_motion_at_the_vertices(case):
    motion, picture = solved(case)
    space = motion.space
    frames = motion.frames[::2]
    start = 0
    weights = pictures.contact_weights(space)
    for face, (part, vertices) in zip(picture.polygons, space.contact, strict=True):
        shown = picture.vertices[:, face.nodes]
        _, order = KDTree(space.mesh.p[:, vertices].T).query(shown.T)
        assert sorted(order) == list(range(len(vertices)))
        rows = start + order
        start += len(vertices)
        assert_allclose(face.normal, part.normal)
        assert_allclose(part.point(face.s), shown, atol=1e-3)
        gap, pressure = np.moveaxis([(-frame.normal, frame.multipliers / weights) for frame in frames], 1, 0)[..., rows]
        for found, expected in ((face.gap, gap), (face.pressure, pressure)):
            assert_allclose(found, expected, atol=0.51 * abs(found).max() / FINE_UNITS)
        np.testing.assert_array_equal(face.touching, pressure > 0)
    moved = np.array([space.nodal(frame.u) for frame in frames])
    # Three digits of the largest displacement at any time: a tenth of a pixel.
    tolerance = 0.51 * abs(moved).max() / UNITS
    at = np.searchsorted([frame.time for frame in frames], picture.times[picture.shown])
    expected = moved[at][..., Skin.of(space.mesh).vertices]
    assert_allclose(picture.displacement[picture.shown], expected, atol=tolerance)
