"""Bounds of backward Euler without a potential, and fixed points of contractions, for problems with known answers."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.sparse as sps
from hypothesis import given, settings
from hypothesis import strategies as st

from study.solve.euler_bounds import EulerBounds, backward_euler
from study.solve.evolution import SemiDiscrete
from study.solve.fixed_point import MEMORY, FixedPointError, fixed_point
from study.solve.gradient_flow import GradientFlow
from study.solve.paths import path
from study.solve.tableau import BACKWARD_EULER

FINE = 256
"""Intervals of the grid in time, and steps of the reference."""


def random_problem(seed: int, n: int = 3) -> tuple[SemiDiscrete, float, float]:
    """M u̇ + C u + N_K(u) ∋ F with C neither symmetric nor monotone, a load with a jump, κ and γ."""
    rng = np.random.default_rng(seed)
    root = rng.standard_normal((n, n))
    M = root @ root.T + 0.3 * np.eye(n)
    L = np.linalg.cholesky(M)
    B = rng.standard_normal((n, n))
    B *= rng.uniform(0.2, 3) / np.linalg.norm(B, 2)
    kappa, gamma = np.linalg.norm(B, 2), max(0.0, -np.linalg.eigvalsh(B + B.T)[0] / 2)
    C = L @ B @ L.T
    symmetric, skew = (C + C.T) / 2, (C - C.T) / 2
    amplitude, frequency, jump = rng.standard_normal((3, n)), rng.uniform(0, 12), rng.uniform(0.1, 0.9)

    def load(t: float) -> np.ndarray:
        return amplitude[0] + amplitude[1] * math.sin(frequency * t) + 2 * amplitude[2] * (t > jump)

    u0 = np.where(rng.random(n) < 0.5, 0.0, rng.random(n))
    problem = SemiDiscrete(
        sps.csc_array(M), sps.csc_array(symmetric), skew.__matmul__, sps.csr_array(-np.eye(n)), load, u0, 1.0,
        growth=float(gamma),
    )  # fmt: skip
    return problem, float(kappa), float(gamma)


def bounds_of(problem: SemiDiscrete, kappa: float, gamma: float) -> EulerBounds:
    loads = np.array([problem.load(t) for t in np.arange(FINE + 1) / FINE])
    return EulerBounds(GradientFlow(problem, loads), kappa, gamma)


def largest_error(problem: SemiDiscrete, exact: np.ndarray, nodes: np.ndarray, states: np.ndarray) -> float:
    grid = np.arange(FINE + 1)
    away = exact - np.array([np.interp(grid, nodes, component) for component in states.T]).T
    return math.sqrt(np.sum(away * (problem.M @ away.T).T, axis=1).max())


@settings(max_examples=6, deadline=None)
@given(seed=st.integers(0, 2**32))
def test_both_bounds_hold_for_steps_of_any_size_and_the_one_with_the_solution_is_the_smaller(seed: int) -> None:
    problem, kappa, gamma = random_problem(seed)
    bounds, exact = bounds_of(problem, kappa, gamma), path(problem, BACKWARD_EULER, FINE)
    room = bounds.by_data(np.arange(FINE + 1))
    rng = np.random.default_rng(seed)
    for count in (6, 12, 32):
        inner = np.sort(rng.choice(np.arange(1, FINE), count - 1, replace=False))
        nodes = np.concatenate([[0], inner, [FINE]])
        if max(np.diff(nodes)) / FINE * kappa >= 0.9:
            continue
        states = backward_euler(problem, (nodes / FINE).tolist())
        bound = bounds.by_solution(nodes, states)
        assert largest_error(problem, exact, nodes, states) <= bound + room
        assert bound <= bounds.by_data(nodes) * (1 + 1e-9)


def test_equal_steps_are_those_of_the_scheme() -> None:
    problem, *_ = random_problem(5)
    states = backward_euler(problem, np.linspace(0, 1, 17).tolist())
    assert states == pytest.approx(path(problem, BACKWARD_EULER, 16), abs=1e-9)


@pytest.mark.parametrize(("kind", "gamma"), [("rotation", 0.0), ("growth", 2.0)])
def test_half_of_kappa_t_is_attained_for_short_steps(kind: str, gamma: float) -> None:
    """‖u(T) − U_N‖/k → e^{γT} κT/2 ‖z‖, part (iii) of the theorem."""
    kappa, start, one = 2.0, np.array([1.0, 0.0]), sps.csc_array(np.eye(2))
    turn = kappa * np.array([[0.0, 1.0], [-1.0, 0.0]])
    reference, rest = (0 * one, turn.__matmul__) if kind == "rotation" else (-kappa * one, None)
    problem = SemiDiscrete(one, reference, rest, sps.csr_array((0, 2)), lambda t: 0 * start, start, 1.0, growth=gamma)
    exact = np.array([math.cos(kappa), math.sin(kappa)]) if kind == "rotation" else math.exp(kappa) * start
    error = np.linalg.norm(path(problem, BACKWARD_EULER, 1024)[-1] - exact)
    assert error * 1024 == pytest.approx(math.exp(gamma) * kappa**2 / 2, rel=0.01)


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
