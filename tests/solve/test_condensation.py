"""The contact solve: the condensation and the factorisation it rests on, against dense linear algebra."""

from __future__ import annotations

from dataclasses import replace
from unittest.mock import Mock

import numpy as np
import pytest
import scipy.sparse as sps
from hypothesis import given, settings
from hypothesis import strategies as st
from random_examples import COSTLY
from scipy.sparse.linalg import splu
from step_matrix import require_optimal, step_matrix

from manufactured import Kind, named, polygon, s
from study.fem.error_norm import gaps_at_vertices
from study.fem.mesh import CrissCross, Graded, MeshFamily, OneDiagonal, Shaken, Unstructured
from study.fem.space import Space, form
from study.solve import signorini
from study.solve.factorisation import Cholesky, nested_dissection
from study.solve.multigrid import Multigrid
from study.solve.signorini import Signorini

TURNED = polygon([(0, 0), (0.8, 0.6), (0.2, 1.4), (-0.6, 0.8)], [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.CONTACT])
"""A square with two slanted pieces of Γ3, which share a vertex and so the two unknowns there."""
SETTINGS: list[tuple[str, MeshFamily, int]] = [
    ("turned", Shaken(), 12),
    ("full-contact", CrissCross(), 8),
    ("anisotropic", Shaken(), 12),
    ("rotated", OneDiagonal(), 12),
    ("corner", OneDiagonal(), 12),
    ("hexagon", Unstructured(), 10),
    ("re-entrant", Graded(), 8),
    ("cube-two-faces", OneDiagonal(), 6),
]
Matrices = tuple[sps.csc_array, sps.csr_array]


@pytest.fixture(scope="module", params=SETTINGS, ids=lambda setting: f"{setting[0]}-{setting[1].name}")
def matrices(request) -> Matrices:
    """Return S of a time step and N."""
    name, family, n = request.param
    body = TURNED if name == "turned" else named(name).solution.body
    space = Space(family(body, n), body)
    return step_matrix("full-contact" if name == "turned" else name, space), space.N


def close(one, other, tolerance: float) -> bool:
    return bool(np.linalg.norm(one - other) <= tolerance * np.linalg.norm(other))


def test_the_factor_solves_and_the_compliance_is_n_s_inverse_n_transposed(matrices: Matrices) -> None:
    S, N = matrices
    b = np.random.default_rng(1).standard_normal(S.shape[0])
    dense = np.linalg.solve(S.toarray(), np.column_stack([b, N.T.toarray()]))
    assert close(Cholesky(S)(b), dense[:, 0], 1e-11)
    assert close(Signorini(S, N).W, N @ dense[:, 1:], 1e-12)


def test_the_condensed_solve_satisfies_the_optimality_conditions(matrices: Matrices) -> None:
    S, N = matrices
    solve = Signorini(S, N)
    for seed in range(4):
        b = S @ np.random.default_rng(seed).standard_normal(S.shape[0])
        solution = solve(b)
        require_optimal(S, N, b, solution, 1e-12, 1e-11)
        assert solution[1].any()


def test_without_a_constraint_or_an_active_one_the_solve_is_the_linear_one(matrices: Matrices) -> None:
    S, N = matrices
    b = S @ (-N.T @ np.ones(N.shape[0]))
    for some in (N, N[:0]):
        u, multipliers = Signorini(S, some)(b)
        assert multipliers.shape == (some.shape[0],)
        assert not multipliers.any()
        assert close(S @ u, b, 1e-12)


def test_several_right_sides_are_solved_as_each_of_them(matrices: Matrices) -> None:
    S, N = matrices
    together, one_by_one = Signorini(S, N), Signorini(S, N)
    several = np.random.default_rng(3).standard_normal((3, S.shape[0]))
    u, multipliers = together(several)
    alone = [one_by_one(b) for b in several]
    assert close(u, np.array([v for v, _ in alone]), 1e-12)
    assert close(multipliers, np.array([forces for _, forces in alone]), 1e-12)
    assert close(together.factor(several), np.array([together.factor(b) for b in several]), 1e-12)


def test_the_substitutions_and_the_trailing_block_belong_to_the_cholesky_factor(matrices: Matrices) -> None:
    """The trailing block of L is the factor of the Schur complement on the constrained unknowns."""
    S, N = matrices
    constrained = np.unique(N.nonzero()[1])
    factor = Cholesky(S, constrained)
    L = np.linalg.cholesky(S.toarray()[np.ix_(factor.order, factor.order)])
    b = np.random.default_rng(2).standard_normal(S.shape[0])
    assert close(factor.forward(b), np.linalg.solve(L, b[factor.order]), 1e-11)
    assert close(factor.backward(b)[factor.order], np.linalg.solve(L.T, b), 1e-11)
    assert (np.sort(factor.order[-len(constrained) :]) == constrained).all()
    assert close(factor.trailing, L[-len(constrained) :, -len(constrained) :], 1e-12)


@st.composite
def sparse_problems(draw) -> Matrices:
    """Any graph: with parts that nothing joins, unknowns without neighbours, vertices of high degree."""
    n, m = draw(st.integers(1, 400)), draw(st.integers(0, 5))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    entries = draw(st.integers(0, 3 * n))
    A = sps.csc_array((rng.normal(size=entries), rng.integers(0, n, (2, entries))), shape=(n, n))
    return sps.csc_array(A @ A.T + sps.eye_array(n)), sps.csr_array(rng.normal(size=(m, n)) * (rng.random(n) < 0.1))


@COSTLY
@given(sparse_problems())
def test_any_sparse_positive_definite_matrix_is_factorised(problem: Matrices) -> None:
    S, N = problem
    b = np.arange(S.shape[0]) + 1.0
    assert np.allclose(S @ Cholesky(S, np.unique(N.nonzero()[1]))(b), b, rtol=0, atol=1e-9 * len(b))
    assert np.allclose(Signorini(S, N).W, N @ np.linalg.solve(S.toarray(), N.T.toarray()), rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("name", "family", "n"),
    [
        ("full-contact", OneDiagonal(), 40),
        pytest.param("full-contact", CrissCross(), 48, marks=pytest.mark.slow),
        pytest.param("full-contact", Unstructured(), 64, marks=pytest.mark.slow),
        ("re-entrant", Graded(), 24),
        pytest.param("cube-two-faces", Shaken(), 12, marks=pytest.mark.slow),
    ],
)
def test_dissection_fills_about_as_little_as_minimum_degree(name: str, family: MeshFamily, n: int) -> None:
    """Entries of L in both orders."""
    solution = named(name).solution
    space = Space(family(solution.body, n), solution.body)
    S, options = form(space, solution.law.A), {"diag_pivot_thresh": 0, "options": {"SymmetricMode": True}}
    order = nested_dissection(S, space.free_points)
    assert (np.sort(order) == np.arange(S.shape[0])).all()
    ours = splu(sps.csc_matrix(S[order][:, order]), permc_spec="NATURAL", **options)
    other = splu(sps.csc_matrix(S), permc_spec="MMD_AT_PLUS_A", **options)
    assert ours.L.nnz <= 1.5 * other.L.nnz


def with_one_negative_pivot(place: int) -> np.ndarray:
    path = np.diag(np.full(399, -0.5), 1)
    return path + path.T + np.diag(np.where(np.arange(400) == place, -1.0, 2.0))


def test_a_matrix_without_positive_pivots_is_refused() -> None:
    """SuperLU would exchange rows, stop, or continue with a pivot that is negative or not a number."""
    small = [[[0.0, 1.0], [1.0, 0.0]], [[1.0, 1.0], [1.0, 1.0]], [[np.nan, 0], [0, 1.0]]]
    for entries in (*small, with_one_negative_pivot(0), with_one_negative_pivot(200)):
        with pytest.raises(np.linalg.LinAlgError, match="not positive definite"):
            Cholesky(sps.csc_array(np.array(entries)))


@st.composite
def contact_problems(draw):
    """Draw positive definite matrices, some of them nearly singular, which need not be M-matrices."""
    n, m = draw(st.integers(2, 10)), draw(st.integers(1, 6))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    root = rng.normal(size=(n, n))
    S = root @ root.T + draw(st.sampled_from([1.0, 1e-3])) * np.eye(n)
    N = draw(st.sampled_from([np.eye(n), rng.normal(size=(min(m, n), n))]))
    return sps.csc_array(S), sps.csr_array(N), 3 * rng.normal(size=n)


@settings(max_examples=100)
@given(contact_problems())
def test_the_contact_solve_satisfies_the_optimality_conditions_for_any_positive_definite_matrix(problem) -> None:
    S, N, b = problem
    require_optimal(S, N, b, Signorini(S, N)(b), 1e-8)


def test_a_cycling_active_set_is_finished_by_the_finite_method(monkeypatch: pytest.MonkeyPatch) -> None:
    """Being definite is not enough (F. E. Curtis, Z. Han, D. P. Robinson, Comput. Optim. Appl. 60 (2015) 311–341)."""
    finished = Mock(wraps=signorini.nnls)
    monkeypatch.setattr(signorini, "nnls", finished)
    S, N = sps.csc_array([[4.0, 5, -5], [5, 9, -5], [-5, -5, 7]]), sps.eye_array(3, format="csr")
    for times, b in enumerate(([-2.0, -1, 3], [2.0, 1, -3]), start=1):
        require_optimal(S, N, np.array(b), Signorini(S, N)(np.array(b)), 1e-12)
        assert finished.call_count == times


# With an initial gap, N u ≤ g


def test_the_solution_satisfies_complementarity_with_the_gap_and_multigrid_finds_the_same() -> None:
    """On a cube, for a load that closes some gaps and opens others."""
    solution = named("cube-bowl").solution
    space = Space(Shaken()(solution.body, 6), solution.body)
    S, N, gap, x = form(space, solution.law.A), space.N, gaps_at_vertices(solution, space), space.free_points
    b = S @ np.random.default_rng(1).standard_normal(space.dofs)
    u, forces = Signorini(S, N, x, gap)(b)
    left = gap - N @ u
    assert S @ u + N.T @ forces == pytest.approx(b, abs=1e-10 * abs(b).max())
    assert left.min() >= -1e-12
    assert forces.min() >= 0
    assert abs(forces * left).max() <= 1e-12 * forces.max()
    assert 0 < np.count_nonzero(forces) < len(gap)
    found, pressed = Multigrid(S, N, x, 1e-11, gap)(b)
    assert found == pytest.approx(u, abs=1e-7 * abs(u).max())
    assert pressed == pytest.approx(forces, abs=1e-6 * forces.max())
    assert ((gap - N @ found) >= -1e-12).all()


def test_every_face_has_its_own_gap_in_the_order_of_the_constraints() -> None:
    solution = named("hexagon").solution
    faces = tuple(replace(face, initial_gap=(i + 1) * s**2) for i, face in enumerate(solution.faces))
    space = Space(Unstructured()(solution.body, 8), solution.body)
    wanted = [
        (i + 1) * np.linalg.norm(space.mesh.p[:, vertex] - part.start) ** 2
        for i, (part, vertices) in enumerate(space.contact)
        for vertex in vertices
    ]
    assert gaps_at_vertices(replace(solution, faces=faces), space) == pytest.approx(wanted)
