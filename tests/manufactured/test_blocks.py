"""Formulas at many points and times."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from manufactured.symbols import BLOCK, Jet, pos, s, t


@pytest.mark.parametrize("shape", [(3 * BLOCK + 7,), (BLOCK, 3), (5, BLOCK)], ids=["points", "few times", "many times"])
@pytest.mark.parametrize("times", ["one", "each", "own"])
def test_values_that_are_found_in_blocks_are_those_found_together(shape: tuple[int, ...], times: str) -> None:
    """Points at one time, at times that all have in common, and at times of their own."""
    rng = np.random.default_rng(4)
    places = rng.random((1, shape[0], *(1,) * (len(shape) - 1)))
    when = {"one": 0.3, "each": rng.random(shape[1:] or shape), "own": rng.random(shape)}[times]
    jet = Jet(pos(s - t**2 / 3, 3) * sp.exp(-t) + sp.sin(2 * s) + t)
    whole = jet._at(places, when, 2)
    for index, values in jet(places, when, 2).items():
        assert values.shape == np.broadcast_shapes(places.shape[1:], np.shape(when))
        assert np.array_equal(values, whole[index])
