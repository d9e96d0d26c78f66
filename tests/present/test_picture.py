"""What is computed from a picture before anything is drawn: contact zones, projection, magnification."""

from dataclasses import replace

import numpy as np
import pytest
from committed import SMOOTH, SOLID, copy_results

from study.present.body import DISPLACEMENT, magnification
from study.present.picture import Picture, Segment, caps, misplaced_length, read_pictures, strands


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> list[Picture]:
    return read_pictures(copy_results(tmp_path_factory.mktemp("results"), (SMOOTH, SOLID), (SMOOTH, SOLID)))


@pytest.fixture
def face(pictures: list[Picture]) -> Segment:
    """The contact face of a body in the plane, with vertices at equal distances, which the file rounds."""
    (face,) = pictures[0].segments
    return replace(face, s=np.linspace(0, 1, len(face.s)))


def test_two_patches_that_meet_are_three_strands() -> None:
    zone = [[], [(0.25, 0.25), (0.5, 0.75)], [(0.1, 0.4), (0.5, 0.8)], [(0.0, 0.9)], [(0.0, 0.9)], []]
    pieces = strands(np.arange(6.0), zone)
    births, merger, end = [(0.5, 0.25, 0.25), (0.5, 0.625, 0.625)], 2.5, (4.5, 0.0, 0.9)
    assert [piece[0] for piece in pieces] == [*births, (merger, 0.0, 0.9)]
    assert [piece[-1] for piece in pieces] == [(merger, 0.1, 0.4), (merger, 0.5, 0.8), end]
    assert caps(pieces) == [(merger, 0.0, 0.1), (merger, 0.4, 0.5), (merger, 0.8, 0.9), end]


def test_displacements_are_magnified_to_the_stated_share_of_the_body(pictures: list[Picture]) -> None:
    for shown in pictures:
        largest = np.linalg.norm(shown.displacement, axis=1).max()
        drawn = magnification(shown.vertices, shown.displacement) * largest
        assert 0.9 * DISPLACEMENT * shown.size < drawn <= DISPLACEMENT * shown.size
    assert magnification(shown.vertices, np.zeros_like(shown.displacement)) == 1


def test_a_computed_zone_that_is_exact_is_off_by_half_a_cell_and_fronts_three_cells_too_far_by_three(
    face: Segment,
) -> None:
    exact = misplaced_length(replace(face, pressure=face.pressure_exact))
    assert exact.max() <= 0.5 + 1e-6
    wide = replace(face, pressure=np.maximum(face.pressure_exact, np.roll(face.pressure_exact, 3, axis=1)))
    off = misplaced_length(wide) - exact
    assert off[:-1].max() <= 3 + 1e-6
    assert np.median(off) > 1.9


def test_a_zone_that_should_not_be_there_counts_with_its_length(face: Segment) -> None:
    pressure = np.zeros_like(face.pressure)
    empty = replace(face, zone=[[] for _ in face.zone_times], pressure=pressure)
    assert not misplaced_length(empty).any()
    assert not empty.outside.any()
    pressure[:, 2:5] = 1.0
    np.testing.assert_allclose(misplaced_length(empty), 3.0)
    # At the first time nothing has been solved.
    np.testing.assert_array_equal(empty.outside.sum(axis=1), [0, *[3] * (len(face.times) - 1)])


def test_the_exact_zone_between_known_times_lies_between(face: Segment) -> None:
    early, late = (face.zone[n][0][1] for n in (10, 11))
    ((_, front),) = face.exact_zone(float(face.zone_times[10:12].mean()))
    assert front == pytest.approx((early + late) / 2)
