"""The fixed point of a contraction: how far it is, and that the last image belongs to it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study.solve.fixed_point import MEMORY, FixedPointError, fixed_point


def euclidean(w):
    return w


@given(seed=st.integers(0, 10**6), contraction=st.floats(0.01, 0.8), size=st.integers(1, 12))
def test_what_is_returned_is_an_image_as_near_to_the_fixed_point_as_was_asked(seed, contraction, size) -> None:
    rng = np.random.default_rng(seed)
    matrix = rng.normal(size=(size, size))
    matrix *= contraction / np.linalg.norm(matrix, 2)
    shift = rng.normal(size=size)
    images = []

    def image(v):
        images.append(matrix @ v + shift)
        return images[-1]

    found, taken = fixed_point(image, np.zeros(size), euclidean, 1e-9, 200)
    exact = np.linalg.solve(np.eye(size) - matrix, shift)
    # ρ is seen along the way only, so that the distance may be some times larger than asked for.
    assert np.linalg.norm(found - exact) <= 100 * 1e-9 * np.linalg.norm(exact)
    assert found is images[-1]
    assert taken == len(images)


@given(
    diagonal=st.lists(st.floats(0, 0.8), min_size=1, max_size=6),
    sizes=st.lists(st.floats(-8, 0), min_size=6, max_size=6),
)
def test_parts_of_very_different_size_and_contraction_do_not_end_it_early(diagonal, sizes) -> None:
    """The slow part may be a millionth of the rest, and the first quotients see the rest only."""
    slope = np.array(diagonal)
    shift = 10 ** np.array(sizes[: len(diagonal)])
    found, _ = fixed_point(lambda v: slope * v + shift, np.zeros(len(slope)), euclidean, 1e-9, 200)
    exact = shift / (1 - slope)
    assert np.linalg.norm(found - exact) <= 1000 * 1e-9 * np.linalg.norm(exact)


@given(seed=st.integers(0, 10**6), size=st.integers(1, MEMORY))
def test_an_affine_map_in_as_many_dimensions_as_are_remembered_takes_two_images_more(seed, size) -> None:
    """One more image than dimensions makes as many differences; they show the fixed point, and its image ends it."""
    rng = np.random.default_rng(seed)
    turned = np.linalg.qr(rng.normal(size=(size, size)))[0]
    matrix = turned @ np.diag(np.linspace(0.2, 0.7, size)) @ turned.T
    shift = rng.normal(size=size)
    found, taken = fixed_point(lambda v: matrix @ v + shift, np.zeros(size), euclidean, 1e-8, 50)
    np.testing.assert_allclose(found, np.linalg.solve(np.eye(size) - matrix, shift), atol=1e-7)
    assert taken <= size + 2


def test_a_start_at_the_fixed_point_takes_one_image_and_what_does_not_settle_or_is_no_number_is_refused() -> None:
    assert fixed_point(lambda v: v, np.ones(3), euclidean, 1e-12, 5)[1] == 1
    with pytest.raises(FixedPointError, match="did not converge in 7 steps"):
        fixed_point(lambda v: np.cos(3 * v) * 5 + v[::-1], np.array([0.1, 0.7]), euclidean, 1e-12, 7)
    with pytest.raises(FixedPointError, match="image 1 is not finite"):
        fixed_point(lambda v: v * np.nan, np.ones(2), euclidean, 1e-12, 7)
