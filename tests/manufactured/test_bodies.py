"""General bodies: turned axes, other sides, several contact faces, one long side, an end time other than 1."""

from dataclasses import replace

import numpy as np
import pytest
from bodies import LAW, LOADED, SIDES, SQUARE
from on_floor import on_floor
from sympy import pi, sin

from manufactured import (
    Body,
    BodyError,
    FormulaError,
    Kind,
    polygon,
    pos,
    s,
    t,
    unit_square,
)
from manufactured.body import Part
from manufactured.face_strain import front

PARTS = unit_square().parts


def square(**options):
    return polygon(SQUARE, SIDES, **options)


@pytest.mark.parametrize(
    ("message", "make"),
    {
        "not one of the vertices": lambda: square(refine=[(0.5, 0.5)]),
        "expected a point of the boundary": lambda: square(interfaces=[((0, 0.5), (0.8, 0.5))]),
        "touches its boundary": lambda: square(interfaces=[((0, 0.5), (0, 1))]),
        "cross": lambda: square(interfaces=[((0, 0.5), (1, 0.5)), ((0.5, 0), (0.5, 1))]),
        "final time": lambda: square(T=0),
        "three boundary parts": lambda: Body(PARTS[:2]),
        "but the next starts at": lambda: Body(PARTS[::-1]),
        "list every vertex once": lambda: polygon([(0, 0), (1, 0), (1, 0), (0, 1)], SIDES),
        "counter-clockwise": lambda: polygon(SQUARE[::-1], SIDES),
        "need 3 kinds, got 4": lambda: polygon(SQUARE[1:], SIDES),
        "lies inside": lambda: Body((replace(PARTS[0], kind=Kind.INTERFACE), *PARTS[1:])),
        "has the kind": lambda: Body(PARTS, interfaces=(PARTS[0],)),
    }.items(),
)
def test_a_body_that_is_none_or_that_no_mesh_could_serve_is_refused(make, message):
    with pytest.raises(BodyError, match=message):
        make()


TRIANGLE = np.array([[0.0, 1, 0], [0, 0, 1], [0, 0, 0]])


@pytest.mark.parametrize(
    "corners", [np.eye(2)[:, :1], TRIANGLE[:2], TRIANGLE[:, :2], np.arange(20.0).reshape(4, 5) ** 2]
)
def test_a_part_has_two_corners_in_the_plane_and_three_or_more_in_space(corners):
    assert [Part(LOADED, right).dim for right in (np.eye(2), TRIANGLE)] == [2, 3]
    with pytest.raises(BodyError, match="cannot have corners of the shape"):
        Part(LOADED, corners)


def test_the_sides_of_a_body_meet_up_to_rounding_of_its_size():
    scale = 1e-3
    first, *others = polygon(scale * np.array(SQUARE), SIDES).parts

    def with_end(moved):
        return Body((replace(first, corners=first.corners + [[0, 0], [0, scale * moved]]), *others))

    assert with_end(1e-13).measure == pytest.approx(scale**2)
    assert with_end(1e-13).vertices.shape == (2, 4)
    with pytest.raises(BodyError, match="but the next starts at"):
        with_end(1e-7)


def test_a_front_passes_each_point_at_its_own_times_and_missing_times_are_the_final_one():
    """ψ = sin(2πt) − s: twice at s = 1/2, once more at s = 0, never at s = 2."""
    passes = front(sin(2 * pi * t) - s, (s,)).passes(np.array([[0.5, 2.0, -0.5]]), 1.0)
    expected = [[1 / 12, 5 / 12], [1.0, 1.0], [7 / 12, 11 / 12]]
    assert pytest.approx(np.array(expected), abs=1e-12) == passes.T


def test_an_initial_gap_is_negative_nowhere_on_its_face_but_for_rounding():
    """It is least in the middle of the face, where neither end shows it."""

    def with_gap(least):
        return on_floor(LAW, t * pos(s - 0.5, 4), 0, initial_gap=(s - 0.5) ** 2 + least)

    assert with_gap(0.0).has_initial_gap
    assert with_gap(-1e-14).has_initial_gap
    with pytest.raises(FormulaError, match=r"initial gap .* is -1e-09 at s = 0\.5"):
        with_gap(-1e-9)


def test_both_ends_of_the_grid_on_a_part_lie_on_it_although_sums_are_rounded():
    """−1.9 + (0.1 − (−1.9)) is larger than 0.1."""
    part = Part(LOADED, np.array([[0, -1.9, -1.9, 0.1, 0.1], [0, 0.9, 1.1, 1.1, 0], [0] * 5]))
    places = part.grid(np.linspace(0, 1, 5))
    assert places.min(axis=1).tolist() == part.outline.min(axis=1).tolist()
    assert places.max(axis=1).tolist() == part.outline.max(axis=1).tolist()
