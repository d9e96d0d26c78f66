"""Student intervals of fitted parameters."""

from __future__ import annotations

import numpy as np
import pytest

from study.statements.fully_discrete import fit


def test_the_interval_of_a_fitted_mean_is_that_of_student() -> None:
    values = np.array([1.0, 2.0, 4.0, 5.0])
    ((mean, (low, high)),), _ = fit(lambda x: x[0] - values, np.zeros(1))
    half = 3.182446 * values.std(ddof=1) / 2
    assert (mean, low, high) == pytest.approx((3.0, 3 - half, 3 + half), rel=1e-5)
