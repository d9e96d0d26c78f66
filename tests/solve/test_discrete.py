"""The contact solve for dense matrices, and the time schemes on coarse meshes."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from unittest.mock import Mock

import numpy as np
import pytest
import scipy.sparse as sps
from hypothesis import given, settings
from hypothesis import strategies as st
from step_matrix import require_optimal

from manufactured import named, unit_square
from study.fem.mesh import FAMILIES, OneDiagonal, Shaken
from study.solve import signorini
from study.solve.evolution import EvolutionError
from study.solve.paths import furthest, path
from study.solve.signorini import Signorini
from study.solve.steps import rate_steps
from study.solve.tableau import BACKWARD_EULER, BDF2, MIDPOINT
from study.statements.shared.experiment import Experiment

FOR_SQUARES = [family for family in FAMILIES if family.serves(unit_square())]


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


@cache
def trajectory(name: str, scheme, steps: int):
    """Return a problem and its solution, computed once for all comparisons; tests only read it."""
    problem = Experiment.of(named(name).solution, Shaken(), 8, scheme, steps).problem
    return problem, path(problem, scheme, steps)


@pytest.mark.parametrize("name", ["advance-recede", pytest.param("yield-and-release", marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    ("scheme", "low", "high"), [(BACKWARD_EULER, 0.8, 1.2), (BDF2, 1.3, 2.2), (MIDPOINT, 1.4, 2.3)]
)
def test_a_scheme_converges_in_time_with_its_order(name: str, scheme, low: float, high: float) -> None:
    """Predicted: 1 for backward Euler; 2, falling to 3/2 where vertices change state, for the others."""
    problem, reference = trajectory(name, MIDPOINT, 320)
    errors = [furthest(problem, trajectory(name, scheme, n)[1], reference[:: 320 // n]) for n in (20, 80)]
    assert low <= np.log2(errors[0] / errors[1]) / 2 <= high


@pytest.mark.slow
def test_the_schemes_agree_on_one_trajectory() -> None:
    """Theorem 5.2: uniqueness, seen from three directions."""
    problem, u = trajectory("travelling-patch", MIDPOINT, 400)
    _, v = trajectory("travelling-patch", BDF2, 400)
    assert furthest(problem, u, v) < 2e-3 * furthest(problem, u, 0 * u)


@pytest.mark.parametrize("family", FOR_SQUARES, ids=lambda f: f.name)
@pytest.mark.parametrize("name", ["yield-and-release", pytest.param("yield-on-a-part", marks=pytest.mark.slow)])
def test_a_midpoint_step_of_a_nonlinear_law_takes_at_most_six_solves_on_the_coarsest_mesh_of_its_sweep(
    name: str, family
) -> None:
    """There steps are longest. Backward Euler and BDF2 take more: the share of G in a step is twice as large."""
    case = named(name)
    setup = Experiment.of(case.solution, family, 8, MIDPOINT, rate_steps(case.solution.body.T, 8, case.pace))
    solves = [state.iterations for state in setup.scheme.march(setup.problem, setup.steps)][1:]
    assert max(solves) <= 6


def test_a_fixed_point_that_does_not_settle_says_so() -> None:
    problem = Experiment.of(named("yield-and-release").solution, OneDiagonal(), 4, MIDPOINT, 4).problem
    stiff = replace(problem, remainder=lambda v: 50 * problem.M @ v)
    with pytest.raises(EvolutionError, match="take more steps"):
        list(MIDPOINT.march(stiff, 4))
