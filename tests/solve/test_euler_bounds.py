"""Bounds of backward Euler without a potential, for problems whose exact constants are known."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.sparse as sps
from hypothesis import given, settings
from hypothesis import strategies as st

from study.solve.euler_bounds import EulerBounds, backward_euler
from study.solve.evolution import SemiDiscrete
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
