"""Quadratic programmes with forces λ ≥ 0, solved from the active set that an interior point shows."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sps
from hypothesis import given
from hypothesis import strategies as st

from study.solve import active_set
from study.solve.active_set import ActiveSet, Optimum


def programme(seed: int, p: int = 12, dofs: int = 6, m: int = 4) -> tuple[ActiveSet, np.ndarray, Optimum]:
    """A programme, q, and a solution of it with strict complementarity, which determines F."""
    random = np.random.default_rng(seed)
    root = random.normal(size=(p, p))
    P = root @ root.T + np.eye(p)
    B = random.normal(size=(p, dofs))
    N = np.eye(m, dofs)
    held = random.random(m) < 0.5
    u = random.normal(size=dofs)
    u[:m] = np.where(held, 0.0, -random.uniform(0.1, 1, m))
    forces = np.where(held, random.uniform(0.1, 1, m), 0.0)
    q = random.normal(size=p)
    x = np.linalg.solve(P, B @ u - q)
    return ActiveSet(sps.csr_array(P), sps.csr_array(B), sps.csr_array(N)), q, Optimum(x, forces, u)


def load(quadratic: ActiveSet, solution: Optimum) -> np.ndarray:
    """F = Bᵀx + Nᵀλ."""
    return quadratic.B.T @ solution.x + quadratic.N.T @ solution.multipliers


def close(one: Optimum, other: Optimum) -> bool:
    return all(np.allclose(a, b, rtol=0, atol=1e-9) for a, b in zip(one, other, strict=True))


@given(st.integers(0, 10_000), st.integers(0, 15))
def test_the_solution_is_found_from_whatever_set_the_start_shows(seed: int, shown: int) -> None:
    quadratic, q, solution = programme(seed)
    signs = np.array([shown >> i & 1 for i in range(4)])
    start = Optimum(0 * solution.x, signs.astype(float), -np.eye(6)[:, :4] @ (1.0 - signs))
    found = quadratic(q, load(quadratic, solution), start)
    assert close(found, solution) or found is start  # sets may follow each other in a circle
    assert found is not start or shown != int(((solution.multipliers > 0) * 2 ** np.arange(4)).sum())


def test_where_force_and_gap_vanish_together_either_set_gives_the_solution() -> None:
    quadratic, q, solution = programme(3)
    u = solution.u.copy()
    u[:4] = [0.0, 0.0, -0.5, -0.2]
    x = np.linalg.solve(quadratic.P.toarray(), quadratic.B @ u - q)
    touching = Optimum(x, np.array([0.7, 0.0, 0.0, 0.0]), u)
    F = load(quadratic, touching)
    for error in (1e-7, -1e-7):
        near = touching._replace(multipliers=touching.multipliers + error * np.eye(4)[1])
        found = quadratic(q, F, near)
        assert found is not near
        assert close(found, touching)


def test_the_system_is_factored_once_for_steps_with_one_set(monkeypatch: pytest.MonkeyPatch) -> None:
    quadratic, q, solution = programme(5)
    calls = []
    splu = active_set.spla.splu
    monkeypatch.setattr(active_set.spla, "splu", lambda matrix: calls.append(1) or splu(matrix))
    F = load(quadratic, solution)
    for scale in (1.0, 2.0, 3.0):
        quadratic(scale * q, scale * F, solution)
    assert len(calls) == 1


def test_an_interior_point_is_kept_when_no_set_has_the_right_signs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(active_set, "SETS", 0)
    quadratic, q, solution = programme(7)
    assert quadratic(q, load(quadratic, solution), solution) is solution
