"""Statements without time: their pieces agree with independent ones, and each verdict can come out otherwise."""

from __future__ import annotations

from dataclasses import replace

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
from study.fem.quadrature import cell_rules
from study.fem.space import Space
from study.ledger.verdict import FAILS, HOLDS, MISSED, REPORTED, UNDECIDED
from study.statements import constraint, green, interpolation, lipschitz, residual
from study.statements.constitutive_law import ElasticityOperator, Viscosity
from study.statements.green import Green
from study.statements.hypercircle import Pair, frozen
from study.statements.interpolation import InterpolationInV, InterpolationOnContact
from study.statements.korn import Korn, Norms
from study.statements.lipschitz import Lipschitz
from study.statements.residual import Residual
from study.statements.shared import eigen
from study.statements.shared.base import Setting, grid
from study.statements.shared.meshes import space_of
from study.stresses.stress_space import StressSpace

SQUARE = unit_square()
H = 1 / np.array([8.0, 16.0, 32.0])


# Forms and eigenvalues.


@pytest.mark.parametrize("family", [OneDiagonal(), Shaken()], ids=lambda f: f.name)
def test_the_product_of_h1_is_that_of_functions_and_strains(family) -> None:
    space = Space(family(SQUARE, 5), SQUARE)
    v = np.random.default_rng(0).standard_normal(space.dofs)
    nodal, total = space.nodal(v), 0.0
    for rule in cell_rules(space.mesh, 2, ()):
        corners = space.mesh.t[:, rule.cells]
        weights = [
            np.linalg.solve(np.vstack([space.mesh.p[:, c], np.ones(3)]), np.vstack([x, np.ones(len(x[0]))]))
            for c, x in zip(corners.T, rule.points.swapaxes(0, 1), strict=True)
        ]
        values = np.einsum("dan,naq->dnq", nodal[:, corners], np.array(weights))
        total += np.sum(values**2 * rule.weights)
    total += np.sum(space.strain(v) ** 2 * space.volumes)
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


@pytest.mark.parametrize("defect", ["sign of contact work", "law"])
def test_green_s_formula_notices_a_wrong_term(monkeypatch, defect: str) -> None:
    work = green.work_of_body_force

    def of_another_material(solution, *rest):
        return work(replace(solution, law=KelvinVoigt(solution.law.G, isotropic(1, 3), "other")), *rest)

    if defect == "law":
        monkeypatch.setattr(green, "work_of_body_force", of_another_material)
    else:
        monkeypatch.setattr(green, "ErrorNorm", other_contact_work(-1.0)(green.ErrorNorm))
    rows = measured(Green(), grid(("full-contact", "yield-and-release"), ("one-diagonal",), (4,)))
    assert [verdict.verdict for verdict in Green().judge(rows)] == [FAILS, FAILS, FAILS]


def test_green_s_formula_notices_a_stress_whose_divergence_is_no_function() -> None:
    """α = 2: w''' and with it f_0 has a Dirac measure on the line of the front."""
    rows = measured(Green(), grid(("rough-2",), ("shaken",), (4,)))
    assert set(verdicts(Green(), rows).values()) == {FAILS}
    assert "rough-2" not in {setting.case for setting in Green().places(full=True)}


def test_fronts_are_where_the_level_changes_its_sign() -> None:
    for case, fronts in (("advance-recede", (0.25 + 2 * 0.7 * 0.3,)), ("full-contact", ())):
        (face,) = resolve(case).solution.faces
        assert face.fronts(0.7) == pytest.approx(fronts, abs=1e-14)


# (2.17), (3.6).


@pytest.mark.parametrize("values", [(0.3, 0.2, 0.21), (0.4, 0.2, 0.1), (1 / 3, 1 / 4, 1 / 5), (0.3, 0.25, np.nan)])
def test_eigenvalues_that_rise_or_tend_to_zero_fail(values) -> None:
    assert FAILS in verdicts(Korn(), invented({"smallest eigenvalue": values})).values()


def test_norms_that_are_not_equivalent_fail() -> None:
    weaker = {"lower bound": 1.01, "upper bound": 0.9, "smallest": 0.5 ** np.arange(3), "largest": 1.0}
    found = verdicts(Norms(), invented(weaker))
    assert found["lower"] == found["settled-smallest"] == FAILS


# (3.1)–(3.3).


@pytest.mark.parametrize(
    ("statement", "right", "key"),
    [
        (Viscosity(), {"ellipticity": 1.0, "bound": 1.0, "asymmetry": 0.0}, "ellipticity"),
        (Viscosity(), {"ellipticity": 1.0, "bound": 1.0, "asymmetry": 0.0}, "bound"),
        (ElasticityOperator(), {"quotient": 1.0, "monotonicity": 0.0, "at zero": 0.0}, "quotient"),
    ],
    ids=["m_A", "‖A‖", "L_G"],
)
@pytest.mark.parametrize(("quotient", "verdict"), [(1.0, HOLDS), (0.98, FAILS), (1.01, FAILS)])
def test_a_constant_of_a_law_is_a_bound_and_the_best_one(statement, right, key, quotient, verdict) -> None:
    found = verdicts(statement, invented({**right, key: quotient}, (8,)))
    assert found[{"quotient": "lipschitz"}.get(key, key)] == verdict
    assert FAILS not in verdicts(statement, invented(right, (8,))).values()


@pytest.mark.parametrize(("quantity", "key"), [("monotonicity", "monotonicity"), ("at zero", "at-zero")])
def test_an_elasticity_operator_is_held_to_its_monotonicity_and_its_stress_at_rest(quantity: str, key: str) -> None:
    wrong = {"quotient": 1.0, "monotonicity": 0.0, "at zero": 0.0, quantity: 1e-6}
    assert verdicts(ElasticityOperator(), invented(wrong, (8,)))[key] == FAILS


# (4.3), (5.5).


def test_the_search_alone_comes_near_the_largest_eigenvalue() -> None:
    space = Space(OneDiagonal()(SQUARE, 8), SQUARE)
    problem = eigen.unloaded(space, KelvinVoigt(isotropic(1, 0.5), isotropic(2, 3), ""))
    found = max(quotient for quotient, _ in lipschitz.quotients(space, problem))
    assert 0.97 < found / eigen.largest(problem.reference, problem.M) <= 1 + 1e-4


@pytest.mark.parametrize(
    ("column", "value"),
    [
        ("over the constant", 1.001),
        ("over the pointwise constant", 1.001),
        ("over the waves", 0.9),
        ("monotonicity", 1.001),
    ],
)
def test_each_bound_of_the_operator_can_fail_alone(column: str, value: float) -> None:
    good = {"over the constant": 0.995, "over the pointwise constant": 0.995, "over the waves": 1.1, "monotonicity": 0}
    assert set(verdicts(Lipschitz(), invented(good)).values()) == {HOLDS}
    assert sorted(verdicts(Lipschitz(), invented({**good, column: value})).values()) == [FAILS, HOLDS, HOLDS, HOLDS]


# K^h, Π^h.


def test_random_fields_are_admissible_and_touch_all_of_their_face() -> None:
    body = resolve("hexagon").solution.body
    rng = np.random.default_rng(0)
    for field in constraint.admissible(body, rng)[:5]:
        for part in body.of(Kind.CONTACT):
            normal = np.tensordot(part.normal, field(part.sample(rng, 200)), axes=1)
            assert normal.max() <= 1e-12 * abs(normal).max()
        assert all(abs(field(part.sample(rng, 50))).max() < 1e-12 for part in body.of(Kind.CLAMPED))


# (5.11).


def test_5_11_as_printed_contradicts_a_solution_of_5_1_and_5_3() -> None:
    """V = R², V^h = R × {0}, K = V, A = I, G = 0 and f constant: u = t f, u^h = t P f; with v^h = u^h."""
    f = np.array([1.0, 1.0])
    projected, t = f * [1, 0], 1.0
    u, approximate = t * f, t * projected
    left = (f - projected) @ (u - approximate)
    common = projected @ (approximate - u)
    assert left <= common - f @ (approximate - u)
    assert not left <= common - f @ (approximate - approximate)


# (5.40), (5.41).


def test_lift_and_land_presses_before_and_after_it_is_in_the_air() -> None:
    case = resolve("lift-and-land")
    space = space_of(Setting(case.name, "shaken", 4))
    pressed = [residual.terms(case.solution, space, time, residual.smooth_fields(space)).bound for time in green.TIMES]
    assert [bool(np.all(bound > 0)) for bound in pressed] == [True, False, True]


def test_where_nothing_touches_r_over_its_bound_is_left_out_or_undecided(monkeypatch) -> None:
    found = verdicts(Residual(), measured(Residual(), [Setting("no-contact", "shaken", 4)]))
    assert found == {"smooth": HOLDS, "remainder": HOLDS}
    monkeypatch.setattr(residual, "TIMES", (0.5,))  # In the air.
    found = verdicts(Residual(), measured(Residual(), [Setting("lift-and-land", "shaken", 4)]))
    assert found == {"smooth": HOLDS, "remainder": HOLDS, "bound": UNDECIDED}


# (5.23), (5.24).


@pytest.mark.parametrize(
    ("order", "verdict"), [(1.0, HOLDS), (0.8, FAILS), (1.2, FAILS), (2.0, FAILS), (np.nan, FAILS)]
)
def test_the_order_in_v_is_judged_from_both_sides(order: float, verdict: str) -> None:
    errors = dict.fromkeys(interpolation.FIELDS.values(), H**order)
    assert set(verdicts(InterpolationInV(), invented(errors)).values()) == {verdict}


@pytest.mark.parametrize(
    ("tau", "order", "verdict"),
    [
        (np.inf, 2.0, HOLDS),
        (np.inf, 1.0, FAILS),
        (np.inf, 2.5, FAILS),
        (2.25, 2.0, HOLDS),
        (2.25, 1.5, FAILS),
        (1.75, 1.7, REPORTED),
        (1.75, 1.0, MISSED),
    ],
)
def test_the_order_of_traces_is_two_where_it_is_claimed(tau: float, order: float, verdict: str) -> None:
    column = interpolation.TRACE.format(next(iter(interpolation.INSTANTS)), 1)
    rows = invented({interpolation.REGULARITY: tau, "size of Γ3,1": H, column: H**order})
    (found,) = InterpolationOnContact().judge(rows)
    assert found.verdict == verdict


def test_a_trace_that_is_zero_has_no_order_to_be_judged() -> None:
    rows = measured(InterpolationOnContact(), grid(("full-contact",), ("shaken",), (8, 16, 32)))
    assert list(verdicts(InterpolationOnContact(), rows)) == ["smooth-face-1"]


def test_the_distance_of_a_smooth_field_is_that_of_the_gauge() -> None:
    solution = resolve("no-contact").solution
    space = Space(Shaken()(solution.body, 6), solution.body)
    # The points of ErrorNorm share coordinates, which leaves its rules exact to a lower degree.
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
