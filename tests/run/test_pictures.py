"""The picture of a solid: its surface and what happens on its contact faces, as solved, in little space."""

from __future__ import annotations

import json
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from manufactured.catalogue import NAMES
from study.fem.mesh import Skin
from study.fem.naming import resolve
from study.ledger.pictures import FINE_UNITS, UNITS
from study.present.picture import Picture
from study.solve.motion import Motion
from study.statements import pictures
from study.statements.pictures import record

Array = NDArray[np.float64]
SOLIDS = [
    pytest.param(name, marks=() if name == "cube-disc" else pytest.mark.slow)
    for name in NAMES
    if name.startswith("cube")
]
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
    space, frames = motion.space, motion.frames[::2]
    pressures = np.array([frame.multipliers for frame in frames]) / pictures.contact_weights(space)
    # Columns: the vertices of all contact faces, as the picture has them and as the space has them.
    drawn = np.hstack([picture.vertices[:, face.nodes] for face in picture.polygons])
    solved_at = np.hstack([space.mesh.p[:, vertices] for _, vertices in space.contact])
    order = abs(drawn[:, :, None] - solved_at[:, None]).max(axis=0).argmin(axis=1)
    assert sorted(order) == list(range(solved_at.shape[1]))
    np.testing.assert_allclose(drawn, solved_at[:, order], atol=1e-3)
    gaps = -np.array([frame.normal for frame in frames])
    for name, expected in (("gap", gaps), ("pressure", pressures)):
        shown = np.hstack([getattr(face, name) for face in picture.polygons])
        np.testing.assert_allclose(shown, expected[:, order], atol=0.51 * abs(shown).max() / FINE_UNITS)
    touching = np.hstack([face.touching for face in picture.polygons])
    np.testing.assert_array_equal(touching, pressures[:, order] > 0)
    for face, (part, _) in zip(picture.polygons, space.contact, strict=True):
        np.testing.assert_allclose(face.normal, part.normal)
        np.testing.assert_allclose(part.point(face.s), picture.vertices[:, face.nodes], atol=1e-3)
    largest = max(abs(space.nodal(frame.u)).max() for frame in frames)
    for instant in picture.shown:
        (frame,) = (frame for frame in motion.frames if frame.time == picture.times[instant])
        moved = space.nodal(frame.u)[:, Skin.of(space.mesh).vertices]
        # Three digits of the largest displacement at any time: a tenth of a pixel.
        np.testing.assert_allclose(picture.displacement[instant], moved, atol=0.51 * largest / UNITS)
