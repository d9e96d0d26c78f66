"""The check values of an independent prototype: advancing and receding front, backward Euler, k = 1/(2n)."""

from __future__ import annotations

import pytest

from manufactured import named
from study.fem.error_norm import ErrorNorm
from study.fem.mesh import OneDiagonal
from study.fem.space import Space
from study.solve.evolution import SemiDiscrete
from study.solve.tableau import BACKWARD_EULER

CASE = named("advance-recede")


@pytest.mark.parametrize(
    ("n", "error", "interpolation"),
    [
        (8, 6.977, 4.026),
        (16, 3.536, 2.030),
        pytest.param(32, 1.771, 1.017, marks=pytest.mark.slow),
        pytest.param(64, 0.8848, 0.5089, marks=pytest.mark.slow),
    ],
)
def test_errors_agree_with_an_independent_prototype_to_four_digits(n: int, error: float, interpolation: float) -> None:
    space = Space(OneDiagonal()(CASE.solution.body, n), CASE.solution.body)
    v_norm = ErrorNorm(CASE.solution, space, raised=2)
    problem = SemiDiscrete.of(space, CASE.solution.law, v_norm.load, v_norm.sample(0.0).interpolant)
    found, interpolated = [], []
    for state in BACKWARD_EULER.march(problem, 2 * n):
        sample = v_norm.sample(state.time)
        found.append(v_norm.distance(sample, state.u))
        interpolated.append(v_norm.distance(sample, sample.interpolant))
    assert float(f"{max(found):.4g}") == error
    assert float(f"{max(interpolated):.4g}") == interpolation
