"""Statements without time: their pieces agree with independent ones, and each verdict can come out otherwise."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sps
from measured_rows import invented, measured, verdicts
from scipy.linalg import eigh

from manufactured import Kind, unit_square
from manufactured.law import DeviatoricBall, FrobeniusBall, KelvinVoigt, Linear, Scaled, Yield, isotropic
from study.controls import replacements as wrong
from study.controls.control import overridden
from study.fem.gauge import Gauge
from study.fem.mesh import OneDiagonal, Shaken
from study.fem.naming import resolve
from study.fem.quadrature import cell_rules
from study.fem.space import Space
from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED
from study.statements import constitutive_law, constraint, green, interpolation, lipschitz, residual
from study.statements.constitutive_law import ElasticityOperator, Projection, Viscosity
from study.statements.constraint import VertexConstraint
from study.statements.green import Green
from study.statements.interpolation import InterpolationInV, InterpolationOnContact
from study.statements.korn import Korn, Norms
from study.statements.lipschitz import Lipschitz
from study.statements.residual import Residual
from study.statements.shared import eigen
from study.statements.shared.base import ListedNumbers, Setting, grid
from study.statements.shared.places import space_of

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


def other_material(body_force: Callable[..., Any]) -> Callable[..., Any]:
    def work(solution, *rest):
        return body_force(replace(solution, law=KelvinVoigt(solution.law.G, isotropic(1, 3), "other")), *rest)

    return work


@pytest.mark.parametrize(
    ("name", "defect"),
    [
        ("Gauge", wrong.other_contact_work(-1.0)),
        ("work_of_body_force", other_material),
        ("work_of_body_force", wrong.times(0.0)),
        ("work_on", wrong.no_work_on_loaded),
    ],
    ids=["sign of contact work", "law", "without f_0", "without f_2"],
)
def test_green_s_formula_notices_a_wrong_term(monkeypatch, name, defect) -> None:
    monkeypatch.setattr(green, name, defect(getattr(green, name)))
    settings = grid(("full-contact", "yield-and-release"), ("one-diagonal",), (4,))
    assert [verdict.verdict for verdict in Green().judge(measured(Green(), settings))] == [FAILS, FAILS, FAILS]


def test_where_quadrature_is_rough_a_body_force_one_per_cent_off_does_not_fall(monkeypatch) -> None:
    monkeypatch.setattr(green, "work_of_body_force", wrong.times(1.01)(green.work_of_body_force))
    rows = measured(Green(), grid(("yield-and-release",), ("one-diagonal",), (4, 8)))
    assert verdicts(Green(), rows) == {"halved": HOLDS, "shrunk": FAILS}


def test_green_s_formula_notices_a_stress_whose_divergence_is_no_function() -> None:
    """α = 2: w''' and with it f_0 has a Dirac measure on the line of the front."""
    rows = measured(Green(), grid(("rough-2",), ("shaken",), (4, 8)))
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


@dataclass(frozen=True, eq=False)
class Stated(Linear):
    """A tensor that states other constants than its own, is not symmetric, or has a stress at rest."""

    shares: tuple[float, float, float] = (1.0, 1.0, 1.0)
    skew: float = 0.0
    prestress: tuple[float, ...] = (0.0, 0.0, 0.0)

    @property
    def ellipticity(self):
        return self.shares[0] * float(np.linalg.eigvalsh(self.matrix)[0])

    @property
    def lipschitz(self):
        return self.shares[1] * float(np.linalg.eigvalsh(self.matrix)[-1])

    @property
    def monotonicity(self):
        return self.shares[2] * float(np.linalg.eigvalsh(self.matrix)[0])

    def at(self, x):
        operator = Scaled(self.matrix + self.skew * np.diag([1.0, 1.0], 1))
        return wrong.Misstated(operator, wrong.result(lambda stress: stress + np.array(self.prestress)[:, None]))


def verdicts_with(monkeypatch, module, statement: ListedNumbers, A, G, level: int = 4) -> dict[str, str]:
    case = SimpleNamespace(solution=SimpleNamespace(law=KelvinVoigt(A, G, "doctored")))
    monkeypatch.setattr(module, "resolve", lambda name: case)
    return verdicts(statement, measured(statement, [Setting("full-contact", "one-diagonal", level)]))


ISOTROPIC = isotropic(1, 0.5)
MATRIX = ISOTROPIC.matrix


@pytest.mark.parametrize(
    ("statement", "tensor", "key", "verdict"),
    [
        (Viscosity(), Stated(MATRIX), "ellipticity", HOLDS),
        (Viscosity(), Stated(MATRIX / 10), "ellipticity", HOLDS),
        (Viscosity(), Stated(MATRIX, shares=(1.1, 1, 1)), "ellipticity", FAILS),
        (Viscosity(), Stated(MATRIX, shares=(0.9, 1, 1)), "ellipticity", REPORTED),
        (Viscosity(), Stated(MATRIX, shares=(1, 0.9, 1)), "bound", FAILS),
        (Viscosity(), Stated(MATRIX, shares=(1, 1.1, 1)), "bound", REPORTED),
        (Viscosity(), Stated(MATRIX, skew=0.1), "bound", FAILS),
        (Viscosity(), Stated(MATRIX, skew=10.0), "ellipticity", FAILS),
        (ElasticityOperator(), Stated(MATRIX), "lipschitz", HOLDS),
        (ElasticityOperator(), Stated(MATRIX, shares=(1, 0.99, 1)), "lipschitz", FAILS),
        (ElasticityOperator(), Stated(MATRIX, shares=(1, 1.1, 1)), "lipschitz", REPORTED),
        (ElasticityOperator(), Stated(MATRIX, shares=(1, 1, 1.01)), "monotonicity", FAILS),
        (ElasticityOperator(), Stated(MATRIX, prestress=(1.0, 1.0, 1.0)), "at-zero", FAILS),
        (ElasticityOperator(), Stated(MATRIX, prestress=(0.0, -1.0, 0.0)), "at-zero", FAILS),
    ],
)
def test_a_law_is_held_to_its_constants(monkeypatch, statement, tensor, key, verdict) -> None:
    laws = (tensor, ISOTROPIC) if isinstance(statement, Viscosity) else (ISOTROPIC, tensor)
    assert verdicts_with(monkeypatch, constitutive_law, statement, *laws)[key] == verdict


@pytest.mark.parametrize("ball", [FrobeniusBall(0.5), DeviatoricBall(0.3)], ids=["Frobenius", "deviatoric"])
@pytest.mark.parametrize(
    ("defect", "failing"),
    [
        ({}, None),
        ({"share": 0.5}, "membership"),
        ({"share": 1.5}, "nearest"),
        ({"share": -1.0}, "expansion"),
        ({"radius": 0.5}, "identity"),
    ],
)
def test_the_operator_of_a_yield_law_is_a_projection(monkeypatch, ball, defect, failing) -> None:
    monkeypatch.setattr(constitutive_law, "projection", wrong.returning(**defect)(constitutive_law.projection))
    found = verdicts_with(monkeypatch, constitutive_law, Projection(), ISOTROPIC, Yield(3.0, ball))
    assert found[failing] == FAILS if failing else set(found.values()) == {HOLDS}


# (4.3), (5.5).


def test_an_operator_steeper_than_its_law_says_is_noticed(monkeypatch) -> None:
    found = verdicts_with(monkeypatch, lipschitz, Lipschitz(), isotropic(1, 0), isotropic(2, 3), 8)
    assert set(found.values()) == {HOLDS}
    steeper = Stated(isotropic(2, 3).matrix, shares=(1, 0.9, 1))
    assert verdicts_with(monkeypatch, lipschitz, Lipschitz(), isotropic(1, 0), steeper, 8)["constant"] == FAILS


def test_the_search_alone_comes_near_the_largest_eigenvalue() -> None:
    space = Space(OneDiagonal()(SQUARE, 8), SQUARE)
    problem = eigen.unloaded(space, KelvinVoigt(ISOTROPIC, isotropic(2, 3), ""))
    found = max(quotient for quotient, _ in lipschitz.quotients(space, lipschitz.Operator(problem)))
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


def vertical_axis(space: Space) -> dict[str, Any]:
    """The vertical axis in place of ν."""
    ((_, vertices),) = space.contact
    rows = sps.lil_array((len(vertices), 2 * space.mesh.p.shape[1]))
    rows[np.arange(len(vertices)), 2 * vertices + 1] = -1
    return {"N": sps.csr_array(sps.csr_array(rows)[:, space.free])}


@pytest.mark.parametrize(
    ("change", "case", "failing"),
    [
        (lambda space: {}, "rotated", None),
        (wrong.inward, "full-contact", "members"),
        (vertical_axis, "rotated", "members"),
        (lambda space: {"N": space.N[1:]}, "full-contact", "members"),
        (wrong.off_contact, "full-contact", "strangers"),
    ],
    ids=["right", "inwards", "vertical", "a vertex of Γ3 is free", "a vertex off Γ3"],
)
def test_a_wrong_constraint_is_noticed(monkeypatch, change, case, failing) -> None:
    def changed(setting: Setting) -> Space:
        space = space_of(setting)
        return overridden(Space(space.mesh, space.body), **change(space))

    monkeypatch.setattr(constraint, "space_of", changed)
    found = verdicts(VertexConstraint(), measured(VertexConstraint(), [Setting(case, "shaken", 5)]))
    assert found[failing] == FAILS if failing else set(found.values()) == {HOLDS}


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


def factors(**changes: float) -> Callable[..., Any]:
    """Some terms of R are multiplied by factors."""
    return wrong.result(lambda found: replace(found, **{name: c * getattr(found, name) for name, c in changes.items()}))


def tangential_trace(terms: Callable[..., Any]) -> Callable[..., Any]:
    """v_τ in place of v_ν on Γ3."""

    def changed(solution, space, time, functions):
        turned = [replace(v, on=lambda part, rule, v=v: v.on(part, rule)[::-1]) for v in functions]
        right = terms(solution, space, time, functions)
        return replace(right, contact=terms(solution, space, time, turned).contact)

    return changed


@pytest.mark.parametrize("case", ["full-contact", "yield-and-release"])
@pytest.mark.parametrize(
    ("defect", "failing"),
    [
        (factors(), set()),
        (factors(body=0), {"smooth", "remainder", "bound"}),
        (factors(loaded=0), {"smooth", "remainder"}),
        (factors(loaded=-1), {"smooth", "remainder"}),
        (factors(contact=-1), {"smooth"}),
        (tangential_trace, {"smooth"}),
    ],
    ids=["right", "without f_0", "without f_2", "sign of f_2", "sign of σ_ν", "tangential trace"],
)
def test_a_wrong_residual_or_trace_is_noticed(monkeypatch, case, defect, failing) -> None:
    monkeypatch.setattr(residual, "terms", defect(residual.terms))
    found = verdicts(Residual(), measured(Residual(), [Setting(case, "shaken", 6)]))
    assert {key for key, verdict in found.items() if verdict == FAILS} >= failing
    assert bool(failing) == (FAILS in found.values())


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
        (1.75, 1.0, REPORTED),
    ],
)
def test_the_order_of_traces_is_two_where_it_is_claimed(tau: float, order: float, verdict: str) -> None:
    column = interpolation.trace_of(interpolation.at(interpolation.TIMES[0]), 1)
    rows = invented({interpolation.REGULARITY: tau, "size of Γ3,1": H, column: H**order})
    (found,) = InterpolationOnContact().judge(rows)
    assert found.verdict == verdict
    if verdict == REPORTED:
        assert ("differs" in found.expected) == (order == 1.0)


def test_a_trace_that_is_zero_has_no_order_to_be_judged() -> None:
    rows = measured(InterpolationOnContact(), grid(("full-contact",), ("shaken",), (8, 16, 32)))
    assert list(verdicts(InterpolationOnContact(), rows)) == ["smooth-face-1"]


def test_an_interpolant_that_is_too_large_has_no_order(monkeypatch) -> None:
    monkeypatch.setattr(Space, "interpolate", wrong.times(1.1)(Space.interpolate))
    rows = measured(InterpolationInV(), grid(("no-contact",), ("one-diagonal",), (8, 16, 32)))
    assert set(verdicts(InterpolationInV(), rows).values()) == {FAILS}


def test_the_distance_of_a_smooth_field_is_that_of_the_gauge() -> None:
    solution = resolve("no-contact").solution
    space = Space(Shaken()(solution.body, 6), solution.body)
    # The points of the gauge share coordinates, which leaves its rules exact to a lower degree.
    gauge = Gauge(solution, space, 4)
    sample = gauge.sample(0.5)
    found = interpolation.distance_in_V(solution, space, lambda x: solution.at(x).displacement(0.5))
    assert found == pytest.approx(gauge.distance(sample, sample.interpolant), rel=1e-7)
