"""Statements without time: their pieces agree with independent ones, and each verdict can come out otherwise."""

import math

import numpy as np
import pytest
from measured_rows import invented, measured, verdicts
from scipy.linalg import eigh

from manufactured import Kind, unit_square
from manufactured.law import KelvinVoigt, isotropic
from study.controls.replacements import other_contact_work
from study.fem.error_norm import ErrorNorm
from study.fem.mesh import OneDiagonal, Shaken
from study.fem.naming import resolve
from study.fem.space import Space
from study.ledger.verdict import FAILS, HOLDS, MISSED, REPORTED, UNDECIDED
from study.statements import constraint, green, interpolation, lipschitz
from study.statements.constitutive_law import ElasticityOperator, Viscosity
from study.statements.green import Green
from study.statements.hypercircle import Pair, frozen
from study.statements.interpolation import InterpolationInV, InterpolationOnContact
from study.statements.korn import Korn
from study.statements.nodal_start import mean_energy, norm_of_start, spikes
from study.statements.residual import Residual
from study.statements.shared import eigen
from study.statements.shared.base import Setting, grid
from study.statements.shared.meshes import space_of
from study.stresses.stress_space import StressSpace

SQUARE = unit_square()
H = 1 / np.array([8.0, 16.0, 32.0])


# Forms and eigenvalues.


def test_the_product_of_h1_is_that_of_functions_and_strains() -> None:
    """∫ v² over a triangle T is |T|/12 (Σ v_i² + (Σ v_i)²) for a linear v with the values v_i at the corners."""
    space = Space(Shaken()(SQUARE, 5), SQUARE)
    v = np.random.default_rng(0).standard_normal(space.dofs)
    corners = space.nodal(v)[:, space.mesh.t]
    squares = ((corners**2).sum(axis=1) + corners.sum(axis=1) ** 2) / 12
    total = np.sum(squares * space.volumes) + np.sum(space.strain(v) ** 2 * space.volumes)
    assert v @ (eigen.h1_product(space) @ v) == pytest.approx(total, rel=1e-12)


def test_extreme_eigenvalues_are_those_of_a_dense_solver() -> None:
    space = Space(Shaken()(SQUARE, 4), SQUARE)
    form, product = space.form(isotropic(1, 3).matrix), eigen.h1_product(space)
    values = eigh(form.toarray(), product.toarray(), eigvals_only=True)
    assert eigen.smallest(form, product) == pytest.approx(values[0], rel=1e-9)
    assert eigen.largest(form, product) == pytest.approx(values[-1], rel=1e-6)


# (2.14).


@pytest.mark.parametrize("case", ["full-contact", "cube-disc"])
def test_functionals_on_halved_cells_are_those_on_v_h(case: str) -> None:
    """(σ, ε(v))_Q of a constant stress does not change with the halvings."""
    space = space_of(Setting(case, "one-diagonal", 2))
    fine, prolong = green.refined(space, 2)
    v = np.random.default_rng(0).standard_normal(space.dofs)
    on_fine = fine.interpolate((prolong @ space.nodal(v).T).T)
    form = (fine.strain(on_fine) * fine.volumes).sum(axis=1)
    assert form == pytest.approx((space.strain(v) * space.volumes).sum(axis=1), rel=1e-12)
    assert fine.mesh.p == pytest.approx((prolong @ space.mesh.p.T).T, abs=1e-14)


def test_green_s_formula_notices_the_wrong_sign_of_the_contact_work(monkeypatch) -> None:
    monkeypatch.setattr(green, "ErrorNorm", other_contact_work(-1.0)(green.ErrorNorm))
    rows = measured(Green(), grid(("full-contact", "yield-and-release"), ("one-diagonal",), (4,)))
    assert [verdict.verdict for verdict in Green().judge(rows)] == [FAILS, FAILS, FAILS]


def test_green_s_formula_notices_a_stress_whose_divergence_is_no_function() -> None:
    """α = 2: w''' and with it f_0 has a Dirac measure on the line of the front."""
    rows = measured(Green(), grid(("rough-2",), ("shaken",), (4,)))
    assert set(verdicts(Green(), rows).values()) == {FAILS}
    assert "rough-2" not in {setting.case for setting in Green().places(full=True)}


# (2.17), (3.1), (3.2), (4.3).


def test_eigenvalues_that_rise_or_tend_to_zero_fail() -> None:
    for values in ((0.3, 0.2, 0.21), (0.4, 0.2, 0.1), (1 / 3, 1 / 4, 1 / 5), (0.3, 0.25, np.nan)):
        assert FAILS in verdicts(Korn(), invented({"smallest eigenvalue": values})).values(), values


@pytest.mark.parametrize("column", ["ellipticity", "bound", "quotient"], ids=["m_A", "‖A‖", "L_G"])
@pytest.mark.parametrize(("quotient", "fails"), [(1.0, 0), (0.98, 1), (1.01, 1)])
def test_a_constant_of_a_law_is_a_bound_and_the_best_one(column: str, quotient: float, fails: int) -> None:
    right = {"quotient": 1.0, "monotonicity": 0.0, "at zero": 0.0, "ellipticity": 1.0, "bound": 1.0, "asymmetry": 0.0}
    rows = invented({**right, column: quotient}, (8,))
    found = verdicts(ElasticityOperator() if column == "quotient" else Viscosity(), rows)
    assert [*found.values()].count(FAILS) == fails


def test_the_search_alone_comes_near_the_largest_eigenvalue() -> None:
    space = Space(OneDiagonal()(SQUARE, 8), SQUARE)
    problem = eigen.unloaded(space, KelvinVoigt(isotropic(1, 0.5), isotropic(2, 3), ""))
    found = max(quotient for quotient, _ in lipschitz.quotients(space, problem))
    assert 0.97 < found / eigen.largest(problem.reference, problem.M) <= 1 + 1e-4


# K^h, Π^h.


def test_random_fields_are_admissible_and_touch_all_of_their_face() -> None:
    body, rng = resolve("hexagon").solution.body, np.random.default_rng(0)
    for field in constraint.admissible(body, rng)[:5]:
        for part in body.of(Kind.CONTACT):
            normal = np.tensordot(part.normal, field(part.sample(rng, 200)), axes=1)
            assert normal.max() <= 1e-12 * abs(normal).max()
        assert all(abs(field(part.sample(rng, 50))).max() < 1e-12 for part in body.of(Kind.CLAMPED))


# (5.40), (5.41).


def test_where_nothing_touches_r_over_its_bound_is_left_out_or_undecided(monkeypatch) -> None:
    monkeypatch.setattr(green, "TIMES", (0.5,))  # lift-and-land is in the air.
    for case, bound in (("no-contact", {}), ("lift-and-land", {"bound": UNDECIDED})):
        found = verdicts(Residual(), measured(Residual(), [Setting(case, "shaken", 4)]))
        assert found == {"smooth": HOLDS, "remainder": HOLDS, **bound}


# (5.23), (5.24).


@pytest.mark.parametrize(("family", "scatter"), [("one-diagonal", 1.0), ("shaken", 1.05)])
@pytest.mark.parametrize(
    ("order", "verdict"), [(1.0, HOLDS), (0.8, FAILS), (1.2, FAILS), (2.0, FAILS), (np.nan, FAILS)]
)
def test_the_order_in_v_is_judged_from_both_sides(order: float, verdict: str, family: str, scatter: float) -> None:
    """On random meshes the scatter of the coarsest one hardly counts."""
    errors = dict.fromkeys(interpolation.FIELDS.values(), H**order * [scatter, 1, 1])
    assert set(verdicts(InterpolationInV(), invented(errors, family=family)).values()) == {verdict}


@pytest.mark.parametrize(
    ("tau", "order", "verdict"),
    [
        *((np.inf, order, verdict) for order, verdict in ((2.0, HOLDS), (1.0, FAILS), (2.5, FAILS))),
        *((2.25, order, verdict) for order, verdict in ((2.0, HOLDS), (1.5, FAILS))),
        *((1.75, order, verdict) for order, verdict in ((1.7, REPORTED), (1.0, MISSED))),
    ],
)
def test_the_order_of_traces_is_two_where_it_is_claimed(tau: float, order: float, verdict: str) -> None:
    column = interpolation.TRACE.format(next(iter(interpolation.INSTANTS)), 1)
    rows = invented({interpolation.REGULARITY: tau, "size of Γ3,1": H, column: H**order})
    assert {*verdicts(InterpolationOnContact(), rows).values()} == {verdict}


def test_a_trace_that_is_zero_has_no_order_to_be_judged() -> None:
    rows = measured(InterpolationOnContact(), grid(("full-contact",), ("shaken",), (4, 8, 16)))
    assert list(verdicts(InterpolationOnContact(), rows)) == ["smooth-face-1"]


def test_the_distance_of_a_smooth_field_is_that_of_the_gauge() -> None:
    """The points of ErrorNorm share coordinates, which leaves its rules exact to a lower degree."""
    solution = resolve("no-contact").solution
    space = Space(Shaken()(solution.body, 6), solution.body)
    v_norm = ErrorNorm(solution, space, 4)
    sample = v_norm.sample(0.5)
    found = interpolation.distance_in_V(solution, space, lambda x: solution.at(x).displacement(0.5))
    assert found == pytest.approx(v_norm.distance(sample, sample.interpolant), rel=1e-7)


# The theorem of Prager and Synge.


def test_the_contact_term_of_the_bound_is_the_gap_times_the_contact_force() -> None:
    """For u^h_ν = −1 on Γ3 the term −∫ σ^h_ν u^h_ν of the bound is −∫ σ^h_ν, close to the exact contact force ∫ p."""
    solution = frozen(resolve("full-contact").solution)
    mesh = OneDiagonal()(solution.body, 8)
    space, (face,) = Space(mesh, solution.body), solution.faces
    apart = space.interpolate(-np.multiply.outer(face.part.normal, np.ones(mesh.p.shape[1])))
    pair = Pair(solution, StressSpace(mesh, solution.body, 3), space, apart)
    work = ((pair.bound - pair.oscillation) ** 2 - pair.oscillation**2 - pair.distance**2) / 2
    s = np.linspace(0, face.part.measure, 1001)
    assert work == pytest.approx(np.trapezoid(solution.on(face, s[None]).pressure(0.0), s), rel=1e-2)


# The continuous start whose nodal interpolants do not converge.


def test_spikes_have_their_heights_at_odd_multiples_and_vanish_at_other_vertices() -> None:
    v = spikes(np.stack(np.meshgrid(np.arange(17), np.arange(17), indexing="ij")) / 16, 4)
    assert v[1::2, 1::2] == pytest.approx(1 / 4)
    assert v[2::4, 2::4] == pytest.approx(2**-1.5)
    assert v.sum() == pytest.approx(64 / 4 + 16 * 2**-1.5)
    # A spike is continuous and ends at its radius.
    at = np.array([[1 / 8], [1 / 8]]) + np.array([[1.0], [0.0]]) * 4.0**-3 * np.array([0.0, 1e-6, 0.5, 1.0, 1.5])
    expected = [1, 6 * math.log(10) / 64, math.log(2) / 64, 0, 0]
    assert spikes(at, 3) == pytest.approx(2**-1.5 * np.array(expected), abs=1e-9)


def test_the_mean_energy_has_a_closed_form_and_the_bound_of_the_norm_is_the_sum_over_the_levels() -> None:
    A = isotropic(1.5, 0.7)
    assert mean_energy(A) == pytest.approx((3 * 1.5 + 0.7) / 2)
    terms = (math.sqrt(2**-j * 4 ** (j - 1) * 2 * math.pi / 4**j * mean_energy(A)) for j in range(3, 200))
    assert norm_of_start(A) == pytest.approx(sum(terms))
