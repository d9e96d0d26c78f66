"""The continuous start whose nodal interpolants do not converge."""

from __future__ import annotations

import math

import numpy as np
import pytest

from manufactured import isotropic
from study.statements.nodal_start import mean_energy, norm_of_start, spikes


def test_spikes_have_their_heights_at_odd_multiples_and_vanish_at_other_vertices() -> None:
    v = spikes(np.stack(np.meshgrid(np.arange(17), np.arange(17), indexing="ij")) / 16, 4)
    assert v[1::2, 1::2] == pytest.approx(1 / 4)
    assert v[2::4, 2::4] == pytest.approx(2**-1.5)
    assert v.sum() == pytest.approx(64 / 4 + 16 * 2**-1.5)


def test_a_spike_is_continuous_and_ends_at_its_radius() -> None:
    at = np.array([[1 / 8], [1 / 8]]) + np.array([[1.0], [0.0]]) * 4.0**-3 * np.array([0.0, 1e-6, 0.5, 1.0, 1.5])
    expected = [1, 6 * math.log(10) / 64, math.log(2) / 64, 0, 0]
    assert spikes(at, 3) == pytest.approx(2**-1.5 * np.array(expected), abs=1e-9)


def test_the_mean_energy_has_a_closed_form_and_the_bound_of_the_norm_is_the_sum_over_the_levels() -> None:
    A = isotropic(1.5, 0.7)
    assert mean_energy(A) == pytest.approx((3 * 1.5 + 0.7) / 2)
    terms = (math.sqrt(2**-j * 4 ** (j - 1) * 2 * math.pi / 4**j * mean_energy(A)) for j in range(3, 200))
    assert norm_of_start(A) == pytest.approx(sum(terms))
