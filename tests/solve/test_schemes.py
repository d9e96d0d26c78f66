"""The time schemes: weights, numbers of steps, orders, bounds of backward Euler, and the fixed point in a step."""

import math
from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sps
from changed import problems
from hypothesis import given, settings
from hypothesis import strategies as st
from measures import close
from on_meshes import space_on
from random_examples import RANDOM

from manufactured import named, unit_square
from manufactured.law import Indefinite, KelvinVoigt, isotropic, isotropic_matrix
from study.fem.mesh import OneDiagonal
from study.fem.naming import resolve
from study.solve.evolution import EvolutionError, FixedPointError, SemiDiscrete, fixed_point, furthest, path
from study.solve.gradient_flow import EulerBounds, backward_euler
from study.solve.steps import StepsError, rate_steps, stress_steps
from study.solve.tableau import BACKWARD_EULER, BDF2, MIDPOINT, SCHEMES
from study.statements.shared.base import Experiment, Setting
from study.statements.thm_4_2 import StressExperiment

K = 0.1
with_every_scheme = pytest.mark.parametrize("scheme", SCHEMES)


@with_every_scheme
def test_a_scheme_differentiates_polynomials_of_its_order_exactly_where_it_takes_the_load(scheme):
    times = K * np.arange(-len(scheme.past), 1)
    at = K * (scheme.theta - 1)
    for degree in range(int(scheme.order) + 2):
        before = [np.array([t**degree]) for t in times[:-1]]
        wrong = abs(scheme.rate(np.array([times[-1] ** degree]), before, K)[0] - degree * at ** max(degree - 1, 0))
        assert (wrong < 1e-12) == (degree <= scheme.order)


def test_steps_grow_with_level_and_pace_and_those_of_stresses_are_even():
    assert [rate_steps(1.0, n) for n in (8, 27, 64)] == [32, 72, 128]
    assert [stress_steps(1.0, n) for n in (8, 16)] == [32, 64]
    assert stress_steps(1e-3, 4) == 2
    assert [stress_steps(0.5, 16, pace) for pace in (1.0, 4.0, 100.0)] == [8, 16, 32]
    assert all(stress_steps(T, n, 5.0) % 2 == 0 for T in (0.3, 1.0) for n in range(2, 40))


@with_every_scheme
def test_a_march_has_a_step_or_more_and_asks_for_loads_at_the_times_that_its_scheme_says(scheme):
    setup = Experiment.of(named("full-contact").solution, OneDiagonal(), 4, scheme, 7)
    with pytest.raises(StepsError, match="one step or more"):
        next(scheme.march(setup.problem, 0))
    asked = []

    def load(times):
        asked.extend(times)
        return np.asarray(setup.problem.load(times))

    assert len([*scheme.march(replace(setup.problem, load=load), 7)]) == 8
    k = setup.problem.T / 7
    assert np.unique(asked) == pytest.approx([(n - 1 + scheme.theta) * k for n in range(1, 8)], rel=1e-15)


@pytest.mark.parametrize("case", ["advance-recede", "yield-on-a-part", "parabolic-gap"])
@with_every_scheme
def test_every_step_balances_forces_as_its_scheme_says(scheme, case):
    """M δu_n + G(θ u_n + (1 − θ) u_{n−1}) + Nᵀλ_n = F, the first steps by the scheme that takes them."""
    setup = Experiment.of(resolve(case).solution, OneDiagonal(), 6, scheme, 9)
    problem = setup.problem
    k = setup.problem.T / 9
    states = [*scheme.march(problem, 9)]
    for n in range(1, 10):
        taken = scheme.of_step(n)
        u = states[n].u
        before = [state.u for state in states[:n]]
        between = taken.theta * u + (1 - taken.theta) * before[-1]
        load = problem.load(taken.balanced(n, k))
        inner = problem.M @ taken.rate(u, before, k) + problem.elastic(between)
        assert close(inner + problem.N.T @ states[n].multipliers, load, 1e-9)
        assert states[n].residual() < 1e-9


BODY = unit_square()
SPACE = space_on(BODY, 4)
EVEN = KelvinVoigt(isotropic(1, 0), Indefinite(isotropic_matrix(-2, 0)), "G = −2A")


def unloaded(law):
    return SemiDiscrete.of(SPACE, law, lambda t: np.zeros((SPACE.dofs, t.size)), np.zeros(SPACE.dofs))


def least(problem, scheme, k):
    """The least eigenvalue of (w/k) M + θ G."""
    S = scheme.newest / k * problem.M + scheme.theta * problem.reference
    return float(np.linalg.eigvalsh(S.toarray())[0])


@pytest.mark.parametrize("scheme", [BACKWARD_EULER, MIDPOINT])
def test_where_g_is_a_multiple_of_a_no_longer_step_would_do(scheme):
    problem = unloaded(EVEN)
    longest = scheme.longest(EVEN.growth)
    assert longest == pytest.approx(scheme.newest / scheme.theta / 2)
    assert least(problem, scheme, 0.999 * longest) > 0 > least(problem, scheme, 1.001 * longest)


@with_every_scheme
def test_every_step_serves_a_monotone_law_and_steps_below_m_a_over_l_g_serve_every_law(scheme):
    assert scheme.longest(named("yield-on-a-part").solution.law.growth) == math.inf
    for name in ("softening", "double-well"):
        law = named(name).solution.law
        scheme.require_unique(0.999 * law.A.ellipticity / law.G.lipschitz, law.growth)
    # The first step of BDF2 is a step of backward Euler, which must be shorter than the other ones.
    assert BDF2.longest(2.0) == BACKWARD_EULER.longest(2.0) == 0.5 < BDF2.newest / 2.0


@with_every_scheme
def test_longer_steps_are_refused_before_anything_is_factorised(monkeypatch, scheme):
    def never(S, N):
        raise AssertionError("a matrix was factorised")

    problem = replace(unloaded(EVEN), T=10 * scheme.longest(EVEN.growth), solver=never)
    with pytest.raises(StepsError, match=r"need not have one solution: G is not monotone.*rate 2; take k < "):
        list(scheme.march(problem, 10))
    with pytest.raises(AssertionError, match="factorised"):
        list(scheme.march(problem, 11))


def test_longer_steps_of_the_stress_problems_are_refused_too():
    solution = named("softening").solution
    _, stresses = problems(solution, OneDiagonal(), 4)
    with pytest.raises(StepsError, match="one solution"):
        list(stresses.march(1))
    experiment = StressExperiment.at(Setting("softening", "one-diagonal", 4), 2)
    with pytest.raises(StepsError, match="one solution"):
        list(replace(experiment, steps=1).march())


def test_a_fixed_point_that_does_not_settle_says_so():
    problem = Experiment.of(named("yield-and-release").solution, OneDiagonal(), 4, MIDPOINT, 4).problem
    stiff = replace(problem, remainder=lambda v: 50 * problem.M @ v)
    with pytest.raises(EvolutionError, match="take more steps"):
        list(MIDPOINT.march(stiff, 4))


@pytest.mark.parametrize(
    ("u", "forces", "load", "expected"),
    [
        ((0.0, 0.0), (0.0, 0.0), (3.0, 4.0), 1.0),
        ((2.0, 0.0), (0.0, 0.0), (0.0, 0.0), 0.875),
        ((0.25, 0.25), (-0.5, 1.0), (0.0, 0.0), 0.5),
        ((-1.75, 0.25), (0.5, 1.0), (0.0, 0.0), 1 / 1.75),
    ],
    ids=["equilibrium", "penetration", "tension", "complementarity"],
)
def test_each_part_of_the_residual_of_a_step_has_its_value(u, forces, load, expected):
    """On two vertices with the gap 1/4; all other parts are 0."""
    M = sps.csc_array(np.eye(2))
    C = sps.csc_array((2, 2))
    N = sps.csr_array(np.eye(2))
    problem = SemiDiscrete(M, C, None, N, np.zeros_like, np.zeros(2), 1.0, gap=np.full(2, 0.25))
    step = problem.stepper(MIDPOINT, 0.5)
    v, multipliers, load = np.array([u, forces, load])
    b = step.S @ v + step.forces @ multipliers + load
    assert step._residual(v, multipliers, b) == pytest.approx(expected)


FINE = 256
"""Intervals of the grid in time, and steps of the reference."""


def random_problem(rng):
    """M u̇ + C u + N_K(u) ∋ F with C neither symmetric nor monotone, a load with a jump, κ and γ."""
    root = rng.standard_normal((3, 3))
    M = root @ root.T + 0.3 * np.eye(3)
    L = np.linalg.cholesky(M)
    B = rng.standard_normal((3, 3))
    kappa = rng.uniform(0.2, 3)
    B *= kappa / np.linalg.norm(B, 2)
    gamma = float(max(0.0, -np.linalg.eigvalsh(B + B.T)[0] / 2))
    C = L @ B @ L.T
    symmetric = (C + C.T) / 2
    N = -sps.eye_array(3, format="csr")
    amplitude = rng.standard_normal((3, 3))
    frequency = rng.uniform(0, 12)
    jump = rng.uniform(0.1, 0.9)

    def load(t):
        return amplitude.T @ [np.ones(t.size), np.sin(frequency * t), 2.0 * (t > jump)]

    u0 = np.where(rng.random(3) < 0.5, 0.0, rng.random(3))
    problem = SemiDiscrete(
        sps.csc_array(M), sps.csc_array(symmetric), (C - symmetric).__matmul__, N, load, u0, 1.0, growth=gamma
    )
    return problem, kappa, gamma


@settings(max_examples=6, deadline=None)
@given(RANDOM)
def test_both_bounds_hold_for_steps_of_any_size_and_the_one_with_the_solution_is_the_smaller(rng):
    problem, kappa, gamma = random_problem(rng)
    grid = np.arange(FINE + 1)
    exact = path(problem, BACKWARD_EULER, FINE)
    bounds = EulerBounds(problem, problem.load(grid / FINE).T, kappa, gamma)
    room = bounds.by_data(grid)
    for count in (6, 12, 32):
        inner = np.sort(rng.choice(np.arange(1, FINE), count - 1, replace=False))
        nodes = np.concatenate([[0], inner, [FINE]])
        if max(np.diff(nodes)) / FINE * kappa >= 0.9:
            continue
        states = backward_euler(problem, nodes / FINE)
        bound = bounds.by_solution(nodes, states)
        linear = np.array([np.interp(grid, nodes, component) for component in states.T]).T
        assert furthest(problem, exact, linear) <= bound + room
        assert bound <= bounds.by_data(nodes) * (1 + 1e-9)


def test_the_bound_from_data_alone_has_the_value_computed_by_hand():
    """M = 4 and f jumps from 8 to 12, so that ‖z‖_V = 4 and Var f = 2."""
    C = sps.csc_array((1, 1))
    N = sps.csr_array([[-1.0]])
    M = sps.csc_array([[4.0]])
    u0 = np.zeros(1)
    problem = SemiDiscrete(M, C, np.zeros_like, N, lambda times: np.full((1, times.size), 8.0), u0, 1.0)
    bounds = EulerBounds(problem, np.array([[8.0], [8.0], [12.0]]))
    nodes = np.linspace(0, 2, 9)
    assert bounds.by_data(nodes) == pytest.approx((4 / math.sqrt(2) + 2 * 2) / 8)
    assert bounds.piecewise_constant(nodes) == pytest.approx(bounds.by_data(nodes) + (4 + 2) / 8)


def euclidean(w):
    return w


@given(rng=RANDOM, contraction=st.floats(0.01, 0.8), size=st.integers(1, 12))
def test_what_is_returned_is_an_image_as_near_to_the_fixed_point_as_was_asked(rng, contraction, size):
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


def test_a_start_at_the_fixed_point_takes_one_image_and_what_does_not_settle_or_is_no_number_is_refused():
    assert fixed_point(lambda v: v, np.ones(3), euclidean, 1e-12, 5)[1] == 1
    with pytest.raises(FixedPointError, match="did not converge in 7 steps"):
        fixed_point(lambda v: np.cos(3 * v) * 5 + v[::-1], np.array([0.1, 0.7]), euclidean, 1e-12, 7)
    with pytest.raises(FixedPointError, match="image 1 is not finite"):
        fixed_point(lambda v: v * np.nan, np.ones(2), euclidean, 1e-12, 7)
