"""The contact solve: by condensation on a factorisation, and by multigrid, against dense linear algebra."""

from dataclasses import replace
from functools import cache
from unittest.mock import Mock

import numpy as np
import pytest
import scipy.sparse as sps
from bodies import TURNED
from costly_cases import slow
from hypothesis import given
from hypothesis import strategies as st
from measures import close
from numpy.testing import assert_allclose
from on_meshes import space_on
from random_examples import COSTLY, RANDOM
from scipy.sparse.linalg import LinearOperator, cg

from manufactured import named, s
from study.fem.error_norm import gaps_at_vertices
from study.fem.mesh import Graded, OneDiagonal, Shaken, Unstructured
from study.fem.space import form
from study.solve import factorisation, signorini
from study.solve.evolution import furthest, path
from study.solve.factorisation import Cholesky
from study.solve.multigrid import COARSEST, FACTORED, SHARE, Multigrid, MultigridError, contact_solver, residual
from study.solve.signorini import Signorini
from study.solve.tableau import MIDPOINT
from study.statements.shared.base import Experiment


def step_matrix(name, space):
    """Return 20 A + G, the matrix of a step of length 1/20 with the law of a case."""
    law = named(name).solution.law
    return sps.csc_array(20 * form(space, law.A) + form(space, law.G))


def require_optimal(S, N, b, solution, rest, exact=None, gap=0.0):
    """Require S u + Nᵀλ = b up to ``rest``, and N u ≤ g, λ ≥ 0 and λ·(N u − g) = 0 up to ``exact``, in relative terms.

    For a positive definite S these conditions have one solution (u, λ), if the rows of N are linearly independent.
    """
    u, multipliers = solution
    exact = rest if exact is None else exact
    open_by = gap - N @ u
    # If all unknowns are held at their bounds, u is zero up to rounding, so its size is not taken from u alone.
    size = max(abs(u).max(), abs(b).max() / abs(S).max())
    force = abs(multipliers).max(initial=0.0)
    assert np.linalg.norm(S @ u + N.T @ multipliers - b) <= rest * np.linalg.norm(b)
    assert open_by.min(initial=0.0) >= -exact * size
    assert multipliers.min(initial=0.0) >= 0
    assert abs(multipliers * open_by).max(initial=0.0) <= exact * size * force


@cache
def matrices(name, family, n):
    """S of a time step, N, and the free vertices."""
    body = TURNED if name == "turned" else named(name).solution.body
    space = space_on(body, n, family)
    return step_matrix("full-contact" if name == "turned" else name, space), space.N, space.free_points


def with_one_negative_pivot(place):
    path = np.diag(np.full(399, -0.5), 1)
    return path + path.T + np.diag(np.where(np.arange(400) == place, -1.0, 2.0))


def test_a_matrix_without_positive_pivots_is_refused():
    """SuperLU would exchange rows, stop, or continue with a pivot that is negative or not a number."""
    small = [[[0.0, 1.0], [1.0, 0.0]], [[1.0, 1.0], [1.0, 1.0]], [[np.nan, 0], [0, 1.0]]]
    for entries in (*small, with_one_negative_pivot(0), with_one_negative_pivot(200)):
        with pytest.raises(np.linalg.LinAlgError, match="not positive definite"):
            Cholesky(sps.csc_array(np.array(entries)))


def test_a_cycling_active_set_is_finished_by_the_finite_method(monkeypatch):
    """Being definite is not enough (F. E. Curtis, Z. Han, D. P. Robinson, Comput. Optim. Appl. 60 (2015) 311–341)."""
    finished = Mock(wraps=signorini.nnls)
    monkeypatch.setattr(signorini, "nnls", finished)
    S = sps.csc_array([[4.0, 5, -5], [5, 9, -5], [-5, -5, 7]])
    N = sps.eye_array(3, format="csr")
    for times, b in enumerate(([-2.0, -1, 3], [2.0, 1, -3]), start=1):
        require_optimal(S, N, np.array(b), Signorini(S, N)(np.array(b)), 1e-12)
        assert finished.call_count == times


# With an initial gap, N u ≤ g


def test_every_face_has_its_own_gap_in_the_order_of_the_constraints():
    solution = named("hexagon").solution
    faces = tuple(replace(face, initial_gap=(i + 1) * s**2) for i, face in enumerate(solution.faces))
    space = space_on(solution.body, 8, Unstructured())
    wanted = [
        i * np.linalg.norm(space.mesh.p[:, vertices].T - part.start, axis=1) ** 2
        for i, (part, vertices) in enumerate(space.contact, start=1)
    ]
    assert gaps_at_vertices(replace(solution, faces=faces), space) == pytest.approx(np.concatenate(wanted))


EXACT = 1e-10
"""A tolerance far below the discretisation error."""
LARGE = [
    ("turned", Shaken(), 24),
    ("anisotropic", Shaken(), 24),
    ("hexagon", Unstructured(), 16),
    ("re-entrant", Graded(), 16),
    ("cube-two-faces", OneDiagonal(), 6),
]
"""Meshes that are large enough for coarse levels."""


def disturbed(S, N):
    """Loads that press some vertices on the foundation and lift others, more and more of them."""
    rng = np.random.default_rng(5)
    smooth = S @ rng.standard_normal(S.shape[0])
    forces = N.T @ rng.standard_normal(N.shape[0])
    return [smooth + k * forces for k in range(3)]


@pytest.mark.parametrize(("name", "family", "level"), LARGE)
def test_the_optimality_conditions_hold_to_rounding_or_the_tolerance_from_any_start(name, family, level):
    """Multigrid starts from the solution for the load before."""
    S, N, x = matrices(name, family, level)
    assert S.shape[0] > COARSEST * len(x)
    iterative = [(Multigrid(S, N, x, tolerance), 1.001 * tolerance, 1e-14) for tolerance in (1e-3, EXACT)]
    for solve, rest, exact in ((Signorini(S, N), 1e-12, 1e-11), *iterative):
        for b in disturbed(S, N):
            solution = solve(b)
            require_optimal(S, N, b, solution, rest, exact)
            assert solution[1].any()


@pytest.mark.parametrize(
    ("name", "family", "levels"),
    [
        ("cube-disc", Shaken(), (3, 6)),
        slow("cube-two-faces", OneDiagonal(), (6, 9)),
        slow("yield-and-release", Shaken(), (16, 32)),
        slow("re-entrant", Graded(), (16, 32)),
    ],
)
def test_what_multigrid_leaves_is_a_fixed_share_of_the_discretisation_error(name, family, levels, monkeypatch):
    """In the norm of V over a trajectory, with the tolerance that a space of that size is given."""
    monkeypatch.setattr("study.solve.multigrid.FACTORED", {2: 0, 3: 0})
    solution = named(name).solution
    shares = []
    for n in levels:
        setup = Experiment.of(solution, family, n, MIDPOINT, 8)
        space = setup.space
        v_norm = setup.v_norm
        problem = setup.problem
        states = list(MIDPOINT.march(problem, 8))
        exact = path(replace(problem, solver=Signorini), MIDPOINT, 8)
        errors = [v_norm.distance(v_norm.sample(state.time), u) for state, u in zip(states, exact, strict=True)]
        shares.append(furthest(problem, np.array([state.u for state in states]), exact) / max(errors))
        assert max(state.residual() for state in states) <= residual(space.dim, space.dofs)
    assert 1e-9 < max(shares) <= SHARE
    assert shares[1] <= 2 * shares[0]


def iterations(name, n, every):
    """Return the number of conjugate gradient iterations from 1 to 1e-8 if one in ``every`` constraints is active."""
    body = named(name).solution.body
    space = space_on(body, n)
    solve = Multigrid(step_matrix(name, space), space.N, space.free_points, EXACT)
    solve.hold(np.arange(space.N.shape[0]) % every == 0 if every else np.zeros(space.N.shape[0], dtype=bool))
    b = solve.free * np.random.default_rng(2).standard_normal(space.dofs)
    count = []
    preconditioner = LinearOperator(solve.cut.shape, matvec=solve.cycle, dtype=float)
    cg(solve.cut, b, rtol=1e-8, M=preconditioner, callback=count.append)
    return len(count)


@pytest.mark.parametrize(("name", "n"), [("full-contact", 32), slow("cube-disc", 6)])
def test_iterations_grow_slowly_with_what_is_held_and_hardly_without(name, n):
    """Coarse matrices that know nothing of what is held cost up to h^{-1/2}."""
    assert iterations(name, 2 * n, None) <= 1.2 * iterations(name, n, None)
    for every in (3, 1):
        assert iterations(name, 2 * n, every) <= 2**0.5 * iterations(name, n, every)


def test_the_same_matrix_gives_the_same_solution_to_the_bit():
    """pyamg draws random numbers; nobody else's change."""
    S, N, x = matrices(*LARGE[0])
    b = disturbed(S, N)[1]
    found = []
    for seed in (3, 4):
        np.random.seed(seed)
        found.append(np.concatenate(Multigrid(S, N, x, 1e-6)(b)))
        drawn = np.random.random()
        np.random.seed(seed)
        assert drawn == np.random.random()
    assert np.array_equal(*found)


@pytest.mark.parametrize("seed", [33, 83, 122])
def test_active_sets_that_go_in_circles_are_broken_up(seed, monkeypatch):
    rng = np.random.default_rng(seed)
    root = rng.standard_normal((18, 9))
    normals = sps.diags_array(rng.choice([-1.0, 1.0], 18), format="csr")
    S = sps.csc_array(root @ root.T + 0.1 * np.eye(18))
    b = rng.standard_normal(18)
    x = rng.standard_normal((3, 6))
    require_optimal(S, normals, b, Multigrid(S, normals, x, EXACT)(b), 2 * EXACT, 1e-13)
    monkeypatch.setattr("study.solve.multigrid.PATIENCE", 1000)
    with pytest.raises(MultigridError):
        Multigrid(S, normals, x, EXACT)(b)


@st.composite
def problems(draw):
    """Any positive definite S, and some rows at some vertices in any directions."""
    d = draw(st.integers(2, 3))
    vertices = draw(st.integers(1, 2 * COARSEST))
    rng = draw(RANDOM)
    n = d * vertices
    root = sps.random_array((n, n), density=draw(st.floats(0, 1)) * min(1, 4 / n), rng=rng)
    share = draw(st.floats(0, 1))
    rows_at = []
    for held in rng.random(vertices) < share:
        rows = held * rng.integers(1, d + 1)
        directions = np.linalg.qr(rng.standard_normal((d, d)))[0][:rows]
        oblique = directions @ (np.eye(d) + 0.4 * np.triu(rng.random((d, d)), 1))
        rows_at.append(sps.csr_array(rng.uniform(0.1, 10, (rows, 1)) * oblique))
    N = sps.block_diag(rows_at, format="csr")
    return sps.csc_array(root @ root.T + 0.1 * sps.eye_array(n)), N, rng.standard_normal((d, vertices)), rng


@COSTLY
@given(problems())
def test_any_positive_definite_matrix_with_any_normals_and_gaps_is_served_by_both_solvers(problem):
    """S may have parts that nothing joins, unknowns without neighbours, and unknowns with many."""
    S, N, x, rng = problem
    gap = rng.random(N.shape[0])
    b = 3 * rng.standard_normal(S.shape[0])
    condensed = Signorini(S, N, x, gap)
    require_optimal(S, N, b, Multigrid(S, N, x, EXACT, gap)(b), 2 * EXACT, 1e-13, gap)
    require_optimal(S, N, b, condensed(b), 1e-8, gap=gap)
    assert close(S @ condensed.factor(b), b, 1e-9)
    expected = N @ np.linalg.solve(S.toarray(), N.T.toarray())
    assert_allclose(condensed.W, expected, rtol=0, atol=1e-9 * abs(expected).max(initial=0))


@pytest.mark.parametrize(
    ("N", "vertices", "message"),
    [
        ([[1.0, 0, 1, 0]], 2, "entries at 2 vertices"),
        ([[0.0, 0, 0, 0]], 2, "entries at 0 vertices"),
        ([[1.0, 2, 0, 0], [2.0, 4, 0, 0]], 2, "linearly dependent"),
        ([[1.0, 0, 0, 0], [0.0, 1, 0, 0], [1.0, 1, 0, 0]], 2, "linearly dependent"),
        ([[1.0, 0, 0, 0]], 3, "S has 4 unknowns, but 3 vertices in dimension 2 have 6"),
    ],
)
def test_constraints_of_another_form_and_other_vertices_are_refused(N, vertices, message):
    with pytest.raises(ValueError, match=message):
        Multigrid(sps.csc_array(np.eye(4)), sps.csr_array(N), np.zeros((2, vertices)), EXACT)


def test_a_tolerance_below_rounding_is_refused():
    S, N, x = matrices(*LARGE[0])
    with pytest.raises(MultigridError, match="so take a larger one"):
        Multigrid(S, N, x, 1e-20)(disturbed(S, N)[1])


def test_the_solver_is_chosen_by_size(monkeypatch):
    body = named("cube-disc").solution.body
    space = space_on(body, 4)
    S = step_matrix("cube-disc", space)
    assert isinstance(contact_solver(space)(S, space.N), Signorini)
    monkeypatch.setitem(FACTORED, 3, space.dofs - 1)
    assert isinstance(contact_solver(space)(S, space.N), Multigrid)


def test_a_matrix_with_more_entries_than_superlu_counts_is_refused(monkeypatch):
    """30 times the entries must be less than 2^31."""
    assert 30 * factorisation.MOST_ENTRIES < 2**31 <= 30 * (factorisation.MOST_ENTRIES + 1)
    monkeypatch.setattr(factorisation, "MOST_ENTRIES", 3)
    Cholesky(sps.csc_array(np.eye(3)))
    with pytest.raises(MemoryError):
        Cholesky(sps.csc_array(np.eye(4)))
