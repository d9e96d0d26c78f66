"""V^h, K^h, Π^h, the contact solve and the time schemes."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from unittest.mock import Mock

import numpy as np
import pytest
import scipy.sparse as sps
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize
from skfem import Basis, BilinearForm, ElementTriP1, ElementVector
from skfem.helpers import ddot, sym_grad, trace

from manufactured import Kind, isotropic, named, polygon, unit_square
from study.fem.error_norm import ErrorNorm
from study.fem.independent import LeadingTerm, load_from_forces
from study.fem.mesh import FAMILIES, Graded, MeshError, OneDiagonal, Shaken, Unstructured
from study.fem.quadrature import Line, cell_rules
from study.fem.space import Space
from study.solve import signorini
from study.solve.evolution import EvolutionError
from study.solve.signorini import Signorini
from study.solve.steps import rate_steps
from study.solve.tableau import BACKWARD_EULER, BDF2, MIDPOINT
from study.statements.shared.experiment import Experiment

FOR_SQUARES = [family for family in FAMILIES if family.serves(unit_square())]
TURNED = polygon([(0, 0), (0.8, 0.6), (0.2, 1.4), (-0.6, 0.8)], [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.CONTACT])
PENTAGON = polygon(
    [(0, 0), (1, 0), (1.3, 0.7), (0.5, 1.2), (-0.2, 0.6)],
    [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED, Kind.CONTACT],
)
ANGLE = polygon(
    [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)],
    [Kind.CONTACT, Kind.LOADED, Kind.LOADED, Kind.LOADED, Kind.CLAMPED, Kind.LOADED],
    refine=[(1, 1), (0, 2)],
)
LAYERED = {
    name: polygon(
        [(0, 0), (1, 0), (1, 1), (0, 1)],
        [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED],
        refine=[(1, 1)],
        interfaces=interfaces,
    )
    for name, interfaces in (
        ("level", [((0, 0.25), (1, 0.25)), ((1, 0.5), (0, 0.5))]),
        ("slanted", [((0, 0.3), (1, 0.7))]),
        ("branching", [((0, 0.3), (1, 0.7)), ((0, 0.3), (1, 0.25)), ((0.2, 1), (1, 0.7))]),
    )
}


@pytest.mark.parametrize("family", FOR_SQUARES, ids=lambda f: f.name)
@pytest.mark.parametrize("body", [unit_square(), TURNED], ids=["square", "turned"])
def test_a_mesh_covers_the_body_and_its_parts_and_is_regular(family, body) -> None:
    for n in (4, 9):
        space = Space(family(body, n), body)
        assert space.volumes.sum() == pytest.approx(body.measure)
        corners = space.mesh.p[:, space.mesh.t]
        sides = [np.linalg.norm(corners[:, i] - corners[:, j], axis=0) for i, j in ((0, 1), (1, 2), (0, 2))]
        assert (4 * np.sqrt(3) * space.volumes / np.sum(np.square(sides), axis=0)).min() > 0.3


def test_unstructured_meshes_serve_any_polygon_and_structured_ones_refuse_it() -> None:
    assert Space(Unstructured()(PENTAGON, 8), PENTAGON).volumes.sum() == pytest.approx(PENTAGON.measure)
    with pytest.raises(MeshError, match="5 corners"):
        OneDiagonal()(PENTAGON, 8)


def test_a_mesh_that_crosses_an_interface_or_lacks_a_vertex_where_the_condition_changes_is_refused() -> None:
    with pytest.raises(MeshError, match="edges of the mesh follow it"):
        Space(OneDiagonal()(LAYERED["level"], 6), LAYERED["level"])
    kinds = [Kind.CONTACT, Kind.LOADED, Kind.LOADED, Kind.CLAMPED, Kind.LOADED]
    body = polygon([(0, 0), (0.3, 0), (1, 0), (1, 1), (0, 1)], kinds)
    with pytest.raises(MeshError, match="is not a vertex"):
        Space(OneDiagonal()(body, 8), body)
    assert Space(OneDiagonal()(body, 10), body).dofs > 0
    assert Space(Unstructured()(body, 8), body).dofs > 0


@pytest.mark.parametrize("family", FOR_SQUARES, ids=lambda f: f.name)
def test_the_matrix_of_a_form_is_the_one_scikit_fem_assembles(family) -> None:
    body, mu, lam = TURNED, 1.3, 0.7
    space = Space(family(body, 5), body)
    C = isotropic(mu, lam).matrix
    basis = Basis(space.mesh, ElementVector(ElementTriP1()))

    @BilinearForm
    def form(u, v, _):
        e, d = sym_grad(u), sym_grad(v)
        return 2 * mu * ddot(e, d) + lam * trace(e) * trace(d)

    expected = form.assemble(basis)[space.free][:, space.free]
    assert abs(space.form(C) - expected).max() < 1e-12 * abs(expected).max()


@pytest.mark.parametrize("family", FOR_SQUARES, ids=lambda f: f.name)
def test_the_normal_displacement_at_contact_vertices_is_v_dot_nu_on_every_piece(family) -> None:
    space = Space(family(TURNED, 6), TURNED)
    rng = np.random.default_rng(3)
    v = rng.normal(size=space.dofs)
    nodal = space.nodal(v)
    expected = np.concatenate([part.normal @ nodal[:, vertices] for part, vertices in space.contact])
    assert np.allclose(space.N @ v, expected)
    # The vertex between the two pieces of Γ3 carries both constraints.
    assert len(np.intersect1d(space.contact[0][1], space.contact[1][1])) == 1


@pytest.mark.parametrize("case", ["advance-recede", "travelling-patch", "yield-on-a-part", "rough-2"])
def test_the_interpolant_of_an_admissible_displacement_is_admissible(case: str) -> None:
    solution = named(case).solution
    space = Space(Shaken()(solution.body, 12), solution.body)
    v_norm = ErrorNorm(solution, space)
    for time in np.linspace(0, 1, 7):
        assert (space.N @ v_norm.sample(time).interpolant).max() <= 1e-14


def test_the_load_from_stresses_is_the_load_from_forces() -> None:
    """Green's formula (2.14): where f_0 is smooth the two assemblies agree to quadrature error."""
    for name in ("full-contact", "no-contact"):
        solution = named(name).solution
        for family in (OneDiagonal(), Shaken(), Unstructured()):
            v_norm = ErrorNorm(solution, Space(family(solution.body, 8), solution.body), raised=4)
            by_stress, by_force = (v_norm.load(0.7), load_from_forces(solution, v_norm.space, 0.7, v_norm.degree))
            assert abs(by_stress - by_force).max() < 1e-9 * abs(by_stress).max()


def test_the_two_loads_meet_under_refinement_where_the_force_is_only_bounded() -> None:
    solution = named("advance-recede").solution
    gaps = []
    for n in (8, 32):
        v_norm = ErrorNorm(solution, Space(Shaken()(solution.body, n), solution.body), raised=4)
        difference = v_norm.load(0.3) - load_from_forces(solution, v_norm.space, 0.3, v_norm.degree)
        gaps.append(abs(difference).max() / abs(v_norm.load(0.3)).max())
    assert gaps[1] < gaps[0] / 4


@pytest.mark.parametrize("exponent", [-0.5, 0.0, 0.5, 2.0])
def test_split_cells_integrate_powers_of_the_distance_to_a_line(exponent: float) -> None:
    """∫_Ω (x − c)_+^e (1 + y) over the unit square, c off all vertices."""
    mesh, c = Shaken()(unit_square(), 6), 1 / 3
    total, area = 0.0, 0.0
    for rule in cell_rules(mesh, 6, (Line((1.0, 0.0), c),)):
        x, y = rule.points
        # Evaluated as a NumPy mask, so that 0^(-1/2) never appears.
        values = np.where(x > c, np.where(x > c, x - c, 1.0) ** exponent, 0.0) * (1 + y)
        total += float(np.sum(values * rule.weights))
        area += float(rule.weights.sum())
    assert area == pytest.approx(1.0, rel=1e-12)
    # Away from the crossed cells the ordinary rule limits the accuracy.
    assert total == pytest.approx(1.5 * (1 - c) ** (exponent + 1) / (exponent + 1), rel=2e-4)


@pytest.mark.parametrize("exponent", [-0.5, 0.5, 2.0])
def test_a_line_may_have_any_direction(exponent: float) -> None:
    """∫_Ω (direction·x − c)_+^e over the unit square, against the integral over the slices direction·x = const."""
    direction, c = np.array([0.6, 0.8]), 0.55
    total = 0.0
    for rule in cell_rules(Shaken()(unit_square(), 6), 6, (Line((0.6, 0.8), c),)):
        depth = np.tensordot(direction, rule.points, axes=1) - c
        total += float(np.sum(np.where(depth > 0, np.where(depth > 0, depth, 1.0) ** exponent, 0.0) * rule.weights))
    # The slice at distance r from the origin has a length linear in r between r = 0, 0.6, 0.8 and 1.4.
    e, slices = exponent + 1, 0.0
    for low, high, at_low, at_high in ((c, 0.6, c / 0.48, 1.25), (0.6, 0.8, 1.25, 1.25), (0.8, 1.4, 1.25, 0.0)):
        slope = (at_high - at_low) / (high - low)
        start = at_low + slope * (c - low)
        powers = [(high - c) ** k - (low - c) ** k for k in (e, e + 1)]
        slices += start * powers[0] / e + slope * powers[1] / (e + 1)
    assert total == pytest.approx(slices, rel=1e-5)


@pytest.mark.parametrize("exponent", [-1.0, -0.9, 0.0, 1.0])
def test_cells_at_a_singular_point_integrate_powers_of_the_distance_to_it(exponent: float) -> None:
    """∫ r^e over the triangle (0,0), (1,0), (1,1) is ∫_0^{π/4} (cos θ)^{−e−2} dθ/(e+2); twice this for the square."""
    nodes, weights = np.polynomial.legendre.leggauss(30)
    exact = 2 * float(np.sum(weights * np.cos(np.pi / 8 * (nodes + 1)) ** (-exponent - 2))) * np.pi / 8 / (exponent + 2)
    (rule,) = cell_rules(OneDiagonal()(unit_square(), 1), 4, (), [(0.0, 0.0)])
    assert np.sum(np.hypot(*rule.points) ** exponent * rule.weights) == pytest.approx(exact, rel=1e-12)
    assert np.sum(np.prod(rule.points**2, axis=0) * rule.weights) == pytest.approx(1 / 9, rel=1e-12)
    # With ordinary cells around them, their degree limits the accuracy.
    rules = cell_rules(Unstructured()(unit_square(), 8), 6, (), [(0.0, 0.0)])
    total = sum(float(np.sum(np.hypot(*rule.points) ** exponent * rule.weights)) for rule in rules)
    assert total == pytest.approx(exact, rel=1e-5)


def test_rough_places_that_no_rule_serves_are_refused() -> None:
    with pytest.raises(MeshError, match="expected 1"):
        Line((1.0, 1.0), 0.5)
    mesh = OneDiagonal()(unit_square(), 4)
    with pytest.raises(MeshError, match="not a vertex of the mesh"):
        cell_rules(mesh, 4, (), [(0.3, 0.3)])
    with pytest.raises(MeshError, match="two lines or points"):
        cell_rules(mesh, 4, (Line((1.0, 0.0), 0.1),), [(0.0, 0.0)])
    with pytest.raises(MeshError, match="two lines or points"):
        cell_rules(mesh, 4, (Line((1.0, 0.0), 0.1), Line((0.0, 1.0), 0.1)))


def test_graded_meshes_shrink_towards_their_points_and_keep_the_boundary() -> None:
    """The cells at c have diameters of the order n^{-5/2}, those elsewhere 1/n."""
    nearest, largest = [], []
    for n in (16, 32, 64):
        space = Space(Graded()(ANGLE, n), ANGLE)
        assert space.volumes.sum() == pytest.approx(ANGLE.measure)
        assert space.mesh.t.shape[1] == Unstructured()(ANGLE, n).t.shape[1]
        distance = np.linalg.norm(space.mesh.p - 1, axis=0)
        nearest.append(np.sort(distance)[1])
        largest.append(np.sqrt(space.volumes.max()))
    assert np.allclose(np.log2(np.divide(nearest[:-1], nearest[1:])), 2.5, atol=0.25)
    assert np.allclose(np.log2(np.divide(largest[:-1], largest[1:])), 1, atol=0.2)


def test_graded_meshes_differ_from_unstructured_ones_near_their_points_only() -> None:
    plain, graded = Unstructured()(ANGLE, 16).p, Graded()(ANGLE, 16).p
    moved = abs(graded - plain).max(axis=0) > 0
    near = [np.linalg.norm(plain - np.array(c)[:, None], axis=0) < Graded().radius(ANGLE, c) for c in ANGLE.refine]
    assert (moved <= np.any(near, axis=0)).all()
    assert moved.any()
    with pytest.raises(MeshError, match="list points in `refine`"):
        Graded()(unit_square(), 8)


@pytest.mark.parametrize("name", ["level", "slanted", "branching"])
def test_every_family_that_serves_a_layered_body_respects_its_interfaces(name: str) -> None:
    body = LAYERED[name]
    served = [family for family in FAMILIES if family.serves(body)]
    assert [family.name for family in served] == [
        *(["one-diagonal", "criss-cross", "shaken"] if name == "level" else []),
        "unstructured",
        "graded",
    ]
    for family in served:
        for n in (4, 12, 24):
            space = Space(family(body, n), body)
            for interface in body.interfaces:
                sides = interface.coordinates(space.mesh.p[:, space.mesh.t])[1]
                assert (sides.max(axis=0) * sides.min(axis=0) > -1e-9 * space.volumes).all(), family.name


def test_shaken_vertices_slide_along_interfaces() -> None:
    plain, shaken = (family(LAYERED["level"], 8).p for family in (OneDiagonal(), Shaken()))
    on = np.flatnonzero(plain[1] == 0.25)[1:-1]
    assert len(on) == 7
    assert np.allclose(shaken[1, on], 0.25, rtol=0, atol=1e-15)
    assert (shaken[0, on] != plain[0, on]).all()


def test_the_predicted_interpolation_error_is_the_measured_one_for_quadratics() -> None:
    """The leading term is the whole error as h → 0: ratio 1 + O(h²) on a smooth case."""
    solution = named("full-contact").solution
    for family in FOR_SQUARES:
        v_norm = ErrorNorm(solution, Space(family(solution.body, 24), solution.body))
        sample = v_norm.sample(1.0)
        assert v_norm.distance(sample, sample.interpolant) == pytest.approx(
            LeadingTerm(solution, v_norm.space)(1.0), rel=3e-3
        )


@st.composite
def contact_problems(draw):
    n, m = draw(st.integers(2, 10)), draw(st.integers(1, 6))
    m = min(m, n)
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    root = rng.normal(size=(n, n))
    S = root @ root.T + np.eye(n)
    return S, rng.normal(size=(m, n)), 3 * rng.normal(size=n)


@given(contact_problems())
def test_the_contact_solve_satisfies_the_optimality_conditions_for_any_spd_matrix(problem) -> None:
    S, N, b = problem
    u, multipliers = Signorini(sps.csc_array(S), sps.csr_array(N))(b)
    assert np.allclose(S @ u + N.T @ multipliers, b, atol=1e-8)
    assert (N @ u).max() <= 1e-8
    assert multipliers.min() >= 0
    assert abs(multipliers * (N @ u)).max() <= 1e-7


@given(contact_problems())
def test_the_contact_solve_is_the_minimiser(problem) -> None:
    S, N, b = problem
    u, _ = Signorini(sps.csc_array(S), sps.csr_array(N))(b)
    constraints = [{"type": "ineq", "fun": lambda v: -N @ v, "jac": lambda v: -N}]
    other = minimize(
        lambda v: v @ S @ v / 2 - b @ v,
        np.zeros(len(b)),
        jac=lambda v: S @ v - b,
        constraints=constraints,
        method="SLSQP",
    )
    energy = u @ S @ u / 2 - b @ u
    assert energy <= other.fun + 1e-6 * max(1.0, abs(energy))


def test_a_cycling_active_set_is_finished_by_the_finite_method(monkeypatch: pytest.MonkeyPatch) -> None:
    """Being definite is not enough (F. E. Curtis, Z. Han, D. P. Robinson, Comput. Optim. Appl. 60 (2015) 311–341)."""
    finished = Mock(wraps=signorini.nnls)
    monkeypatch.setattr(signorini, "nnls", finished)
    S = np.array([[4.0, 5, -5], [5, 9, -5], [-5, -5, 7]])
    for times, b in enumerate(([-2.0, -1, 3], [2.0, 1, -3]), start=1):
        u, multipliers = Signorini(sps.csc_array(S), sps.csr_array(np.eye(3)))(np.array(b))
        assert finished.call_count == times
        assert u.max() <= 1e-12
        assert multipliers.min() >= 0
        assert np.allclose(S @ u + multipliers, b, atol=1e-12)
        assert abs(multipliers * u).max() <= 1e-12


def test_ill_conditioned_matrices_that_are_no_m_matrices_are_solved() -> None:
    rng = np.random.default_rng(5)
    for _ in range(200):
        root = rng.normal(size=(6, 6))
        S = root @ root.T + 1e-3 * np.eye(6)
        b = rng.normal(size=6)
        u, multipliers = Signorini(sps.csc_array(S), sps.csr_array(np.eye(6)))(b)
        assert u.max() <= 1e-8
        assert multipliers.min() >= 0
        assert np.allclose(S @ u + multipliers, b, atol=1e-7)
        assert abs(multipliers * u).max() <= 1e-7


@cache
def trajectory(case, scheme, steps: int, n: int = 8):
    """The problem and its trajectory, found once for all schemes that are compared with it; tests only read it."""
    problem = Experiment.of(case.solution, Shaken(), n, scheme, steps).problem
    return problem, np.array([state.u for state in scheme.march(problem, steps)])


@pytest.mark.parametrize("name", ["advance-recede", pytest.param("yield-and-release", marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    ("scheme", "low", "high"), [(BACKWARD_EULER, 0.8, 1.2), (BDF2, 1.3, 2.2), (MIDPOINT, 1.4, 2.3)]
)
def test_a_scheme_converges_in_time_with_its_order(name: str, scheme, low: float, high: float) -> None:
    """Predicted: 1 for backward Euler; 2, falling to 3/2 where vertices change state, for the others."""
    case = named(name)
    problem, reference = trajectory(case, MIDPOINT, 640)
    errors = []
    for steps in (20, 40, 80):
        _, u = trajectory(case, scheme, steps)
        difference = u - reference[:: 640 // steps]
        errors.append(max(np.sqrt(d @ (problem.M @ d)) for d in difference))
    order = np.log2(errors[0] / errors[-1]) / 2
    assert low <= order <= high


@pytest.mark.slow
def test_the_schemes_agree_on_one_trajectory() -> None:
    """Theorem 5.2: uniqueness, seen from three directions."""
    case = named("travelling-patch")
    problem, u = trajectory(case, MIDPOINT, 400)
    _, v = trajectory(case, BDF2, 400)
    size = max(np.sqrt(w @ (problem.M @ w)) for w in u)
    assert max(np.sqrt(d @ (problem.M @ d)) for d in u - v) < 2e-3 * size


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
