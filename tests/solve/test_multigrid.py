"""The contact solve by multigrid, against the exact one on a factorisation."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import scipy.sparse as sps
from hypothesis import given
from hypothesis import strategies as st
from random_examples import COSTLY
from scipy.sparse.linalg import LinearOperator, cg
from step_matrix import require_optimal, step_matrix

from manufactured import named
from study.fem.mesh import Graded, MeshFamily, OneDiagonal, Shaken, Unstructured
from study.fem.space import Space
from study.solve.multigrid import COARSEST, Multigrid, MultigridError, rigid_motions
from study.solve.paths import furthest, path
from study.solve.signorini import Signorini
from study.solve.solver_choice import FACTORED, SHARE, contact_solver, residual
from study.solve.tableau import MIDPOINT
from study.statements.shared.experiment import Experiment

EXACT = 1e-10
"""A tolerance far below the discretisation error."""
SETTINGS: list[tuple[str, MeshFamily, int]] = [
    ("anisotropic", Shaken(), 24),
    ("hexagon", Unstructured(), 16),
    ("re-entrant", Graded(), 16),
    ("cube-two-faces", OneDiagonal(), 6),
    ("full-contact", OneDiagonal(), 24),
    ("heterogeneous", Unstructured(), 24),
    ("rotated", OneDiagonal(), 24),
    ("cube-disc", Shaken(), 8),
]
QUICK = 4
"""The nightly job takes the others as well."""


def disturbed(S: sps.csc_array, N: sps.csr_array, count: int = 3) -> list:
    """Loads that press some vertices on the foundation and lift others, more and more of them."""
    rng = np.random.default_rng(5)
    smooth, forces = S @ rng.standard_normal(S.shape[0]), N.T @ rng.standard_normal(N.shape[0])
    return [smooth + k * forces for k in range(count)]


PARAMS = [
    pytest.param(one, id=f"{one[0]}-{one[1].name}", marks=() if i < QUICK else pytest.mark.slow)
    for i, one in enumerate(SETTINGS)
]


@cache
def matrices(name: str, family: MeshFamily, n: int):
    """S of a time step, large enough for coarse levels, N, and the free vertices."""
    body = named(name).solution.body
    space = Space(family(body, n), body)
    assert space.dofs > COARSEST * space.dim
    return step_matrix(name, space), space.N, space.free_points


@pytest.mark.parametrize("tolerance", [1e-3, EXACT])
@pytest.mark.parametrize("setting", PARAMS)
def test_the_optimality_conditions_hold_to_the_tolerance_from_any_start(setting, tolerance: float) -> None:
    """The solver starts from the solution for the load before."""
    S, N, x = matrices(*setting)
    solve = Multigrid(S, N, x, tolerance)
    for b in disturbed(S, N):
        solution = solve(b)
        require_optimal(S, N, b, solution, 1.001 * tolerance, 1e-14)
        assert solution[1].any()


@pytest.mark.parametrize(
    ("name", "family", "levels"),
    [
        ("cube-disc", Shaken(), (3, 6)),
        pytest.param("cube-two-faces", OneDiagonal(), (6, 9), marks=pytest.mark.slow),
        pytest.param("yield-and-release", Shaken(), (16, 32), marks=pytest.mark.slow),
        pytest.param("re-entrant", Graded(), (16, 32), marks=pytest.mark.slow),
    ],
)
def test_what_multigrid_leaves_is_a_fixed_share_of_the_discretisation_error(
    name: str, family: MeshFamily, levels: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the norm of V over a trajectory, with the tolerance that a space of that size is given."""
    monkeypatch.setattr("study.solve.solver_choice.FACTORED", {2: 0, 3: 0})
    solution, shares = named(name).solution, []
    for n in levels:
        setup = Experiment.of(solution, family, n, MIDPOINT, 8)
        space, v_norm, problem = setup.space, setup.v_norm, setup.problem
        states, exact = list(MIDPOINT.march(problem, 8)), path(replace(problem, solver=Signorini), MIDPOINT, 8)
        errors = [v_norm.distance(v_norm.sample(state.time), u) for state, u in zip(states, exact, strict=True)]
        shares.append(furthest(problem, np.array([state.u for state in states]), exact) / max(errors))
        assert max(state.residual() for state in states) <= residual(space.dim, space.dofs)
    assert 1e-9 < max(shares) <= SHARE
    assert shares[1] <= 2 * shares[0]


def iterations(name: str, n: int, every: int | None) -> int:
    """Return the number of conjugate gradient iterations from 1 to 1e-8 if one in ``every`` constraints is active."""
    body = named(name).solution.body
    space = Space(OneDiagonal()(body, n), body)
    solve = Multigrid(step_matrix(name, space), space.N, space.free_points, EXACT)
    solve.hold(np.arange(space.N.shape[0]) % every == 0 if every else np.zeros(space.N.shape[0], dtype=bool))
    b, count = solve.free * np.random.default_rng(2).standard_normal(space.dofs), []
    preconditioner = LinearOperator(solve.cut.shape, matvec=solve.cycle, dtype=float)
    cg(solve.cut, b, rtol=1e-8, M=preconditioner, callback=count.append)
    return len(count)


@pytest.mark.parametrize(("name", "n"), [("full-contact", 32), pytest.param("cube-disc", 6, marks=pytest.mark.slow)])
def test_iterations_grow_slowly_with_what_is_held_and_hardly_without(name: str, n: int) -> None:
    """Coarse matrices that know nothing of what is held cost up to h^{-1/2}."""
    assert iterations(name, 2 * n, None) <= 1.2 * iterations(name, n, None)
    for every in (3, 1):
        assert iterations(name, 2 * n, every) <= 2**0.5 * iterations(name, n, every)


@pytest.mark.parametrize("setting", PARAMS)
def test_the_cycle_is_symmetric_and_positive_on_what_is_free(setting) -> None:
    S, N, x = matrices(*setting)
    solve = Multigrid(S, N, x, EXACT)
    solve.hold(np.arange(N.shape[0]) % 2 == 0)
    r, s = solve.free * np.random.default_rng(1).standard_normal((2, S.shape[0]))
    assert r @ solve.cycle(s) == pytest.approx(s @ solve.cycle(r), rel=1e-10)
    assert r @ solve.cycle(r) > 0
    assert (solve.cycle(r)[solve.free == 0] == 0).all()


def test_the_same_matrix_gives_the_same_solution_to_the_bit() -> None:
    """pyamg draws random numbers; nobody else's change."""
    S, N, x = matrices(*SETTINGS[0])
    b = disturbed(S, N)[1]
    np.random.seed(3)
    first, drawn = Multigrid(S, N, x, 1e-6)(b), np.random.random()
    np.random.seed(4)
    assert np.array_equal(np.concatenate(first), np.concatenate(Multigrid(S, N, x, 1e-6)(b)))
    np.random.seed(3)
    assert drawn == np.random.random()


@pytest.mark.parametrize("seed", [33, 83, 122])
def test_active_sets_that_go_in_circles_are_broken_up(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(seed)
    root, normals = rng.standard_normal((18, 9)), sps.diags_array(rng.choice([-1.0, 1.0], 18), format="csr")
    S, b, x = sps.csc_array(root @ root.T + 0.1 * np.eye(18)), rng.standard_normal(18), rng.standard_normal((3, 6))
    require_optimal(S, normals, b, Multigrid(S, normals, x, EXACT)(b), 2 * EXACT, 1e-13)
    monkeypatch.setattr("study.solve.multigrid.PATIENCE", 1000)
    with pytest.raises(MultigridError):
        Multigrid(S, normals, x, EXACT)(b)


@st.composite
def problems(draw):
    """Any positive definite S, and some rows at some vertices in any directions."""
    d, vertices = draw(st.integers(2, 3)), draw(st.integers(1, 2 * COARSEST))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    n = d * vertices
    root = sps.random_array((n, n), density=draw(st.floats(0, 1)) * min(1, 4 / n), rng=rng)
    rows = []
    for vertex in rng.choice(vertices, draw(st.integers(0, vertices)), replace=False):
        directions = np.linalg.qr(rng.standard_normal((d, d)))[0][: rng.integers(1, d + 1)]
        for direction in directions @ (np.eye(d) + 0.4 * np.triu(rng.random((d, d)), 1)):
            row = np.zeros(n)
            row[d * vertex : d * vertex + d] = rng.uniform(0.1, 10) * direction
            rows.append(row)
    N = sps.csr_array(np.array(rows).reshape(-1, n))
    return sps.csc_array(root @ root.T + 0.1 * sps.eye_array(n)), N, rng.standard_normal((d, vertices)), rng


@COSTLY
@given(problems())
def test_any_positive_definite_matrix_with_any_normals_is_served(problem) -> None:
    S, N, x, rng = problem
    b = rng.standard_normal(S.shape[0])
    require_optimal(S, N, b, Multigrid(S, N, x, EXACT)(b), 2 * EXACT, 1e-13)


def test_rigid_motions_have_no_strain() -> None:
    body = named("cube-disc").solution.body
    space = Space(Shaken()(body, 3), body)
    motions = rigid_motions(space.mesh.p)
    assert motions.shape[1] == np.linalg.matrix_rank(motions) == 6
    inside = np.isin(space.mesh.t, space.free // 3).all(axis=0)
    assert inside.any()
    for motion in motions[space.free].T:
        assert abs(space.strain(motion)[:, inside]).max() < 1e-12


@pytest.mark.parametrize(
    ("N", "message"),
    [
        ([[1.0, 0, 1, 0]], "entries at 2 vertices"),
        ([[0.0, 0, 0, 0]], "entries at 0 vertices"),
        ([[1.0, 2, 0, 0], [2.0, 4, 0, 0]], "linearly dependent"),
        ([[1.0, 0, 0, 0], [0.0, 1, 0, 0], [1.0, 1, 0, 0]], "linearly dependent"),
    ],
)
def test_constraints_of_another_form_and_other_vertices_are_refused(N, message: str) -> None:
    one = sps.csc_array(np.eye(4))
    with pytest.raises(ValueError, match=message):
        Multigrid(one, sps.csr_array(np.array(N)), np.zeros((2, 2)), EXACT)
    with pytest.raises(ValueError, match="S has 4 unknowns, but 3 vertices in dimension 2 have 6"):
        Multigrid(one, sps.csr_array((0, 4)), np.zeros((2, 3)), EXACT)


def test_a_tolerance_below_rounding_is_refused() -> None:
    S, N, x = matrices(*SETTINGS[0])
    with pytest.raises(MultigridError, match="so take a larger one"):
        Multigrid(S, N, x, 1e-20)(disturbed(S, N)[1])


def test_the_solver_is_chosen_by_size(monkeypatch: pytest.MonkeyPatch) -> None:
    body = named("cube-disc").solution.body
    space = Space(OneDiagonal()(body, 4), body)
    S = step_matrix("cube-disc", space)
    assert isinstance(contact_solver(space)(S, space.N), Signorini)
    monkeypatch.setitem(FACTORED, 3, space.dofs - 1)
    assert isinstance(contact_solver(space)(S, space.N), Multigrid)
