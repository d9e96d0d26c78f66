"""Numbered statements without time: the quick settings hold, and every verdict can come out otherwise."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
import scipy.sparse as sps
from scipy.linalg import eigh

from manufactured import Kind, catalogue, unit_square
from manufactured.law import DeviatoricBall, FrobeniusBall, KelvinVoigt, Linear, Scaled, Yield, isotropic
from study.fem.gauge import Gauge
from study.fem.mesh import OneDiagonal, Shaken
from study.fem.naming import resolve
from study.fem.quadrature import cell_rules
from study.fem.space import Space
from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED, Verdict
from study.statements import constitutive_law, constraint, green, interpolation, korn, lipschitz, residual
from study.statements.shared import eigen
from study.statements.shared.base import ListedNumbers, Setting
from study.statements.shared.meshes import EVERY, families, place, space_of

STATEMENTS: tuple[ListedNumbers, ...] = (
    green.Green(),
    korn.Korn(),
    constitutive_law.Viscosity(),
    constitutive_law.ElasticityOperator(),
    constitutive_law.Projection(),
    korn.Norms(),
    lipschitz.Lipschitz(),
    constraint.VertexConstraint(),
    constraint.Interpolant(),
    interpolation.InterpolationInV(),
    interpolation.InterpolationOnContact(),
    residual.Residual(),
)
SQUARE = unit_square()


def rows_of(statement: ListedNumbers, settings: list[Setting]) -> pd.DataFrame:
    """What a study would hand to ``judge``."""
    found = []
    for setting in settings:
        values = statement.measure(setting)
        assert all(type(value) is float for value in values.values())
        h = values.pop("h")
        where = {"case": setting.case, "family": setting.family, "level": setting.level, "h": h}
        found += [{**where, "quantity": name, "value": value} for name, value in values.items()]
    return pd.DataFrame(found)


@lru_cache
def quick(statement: ListedNumbers) -> pd.DataFrame:
    return rows_of(statement, statement.places(full=False))


def table(levels: tuple[int, ...] = (8, 16, 32), **columns) -> pd.DataFrame:
    """Doctored rows: one value, or one for each level, of each quantity."""
    rows = []
    for name, values in columns.items():
        for level, value in zip(levels, np.broadcast_to(values, len(levels)), strict=True):
            where = {"case": "a", "family": "one-diagonal", "level": level, "h": 1 / level}
            rows.append({**where, "quantity": name, "value": float(value)})
    return pd.DataFrame(rows)


def verdicts(found: list[Verdict]) -> dict[str, str]:
    return {verdict.key: verdict.verdict for verdict in found}


@pytest.mark.parametrize("statement", STATEMENTS, ids=lambda s: s.label)
def test_the_quick_settings_hold(statement: ListedNumbers) -> None:
    found = statement.judge(quick(statement))
    assert {verdict.case for verdict in found} == {setting.case for setting in statement.places(full=False)}
    assert HOLDS in {verdict.verdict for verdict in found} <= {HOLDS, REPORTED}
    assert {(verdict.label, verdict.statement) for verdict in found} == {(statement.label, statement.claim)}


@pytest.mark.parametrize("statement", STATEMENTS, ids=lambda s: s.label)
def test_any_part_of_the_settings_can_be_judged(statement: ListedNumbers) -> None:
    rows = quick(statement)
    case = rows["case"].iloc[0]
    assert statement.judge(rows[rows["case"] == case]) == [v for v in statement.judge(rows) if v.case == case]
    assert statement.judge(rows.iloc[:0]) == []


@pytest.mark.parametrize("statement", [STATEMENTS[i] for i in (1, 5, 9, 10)], ids=lambda s: s.label)
def test_one_level_is_too_few(statement: ListedNumbers) -> None:
    rows = quick(statement)
    found = statement.judge(rows[rows["level"] == rows["level"].min()])
    assert UNDECIDED in {verdict.verdict for verdict in found}
    assert FAILS not in {verdict.verdict for verdict in found}


@pytest.mark.parametrize("statement", STATEMENTS, ids=lambda s: s.label)
def test_settings_are_different_and_name_families_that_serve(statement: ListedNumbers) -> None:
    for full in (False, True):
        settings = statement.places(full)
        assert len(set(settings)) == len(settings) > 0
        assert all(setting.family in families(resolve(setting.case)) for setting in settings)


def test_levels_are_moved_to_where_the_ends_of_parts_are_vertices() -> None:
    for setting in place(catalogue(), EVERY, (5,), (2,)):
        assert space_of(setting).dofs > 0


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


def test_functionals_on_halved_cells_are_those_on_v_h() -> None:
    """(σ, ε(v))_Q of a constant stress does not see the halvings, in the plane and in space."""
    for case in ("full-contact", "cube-disc"):
        space = space_of(Setting(case, "one-diagonal", 2))
        fine, prolong = green.halved(space, 2)
        v = np.random.default_rng(0).standard_normal(space.dofs)
        on_fine = fine.interpolate((prolong @ space.nodal(v).T).T)
        form = (fine.strain(on_fine) * fine.volumes).sum(axis=1)
        assert form == pytest.approx((space.strain(v) * space.volumes).sum(axis=1), rel=1e-12)
        assert fine.mesh.p == pytest.approx((prolong @ space.mesh.p.T).T, abs=1e-14)


class Flipped(Gauge):
    """The contact work has the wrong sign."""

    def _contact_work(self, strains, rates):
        return -super()._contact_work(strains, rates)


def swapped(solution, *rest):
    """The forces of another material."""
    other = KelvinVoigt(solution.law.G, isotropic(1, 3), "other")
    return work_of_body_force(replace(solution, law=other), *rest)


def forgotten(*arguments):
    return 0 * work_of_body_force(*arguments)


def without_loads(kind, *rest):
    return work_on(kind, *rest) * (kind is not Kind.LOADED)


def slightly_off(*arguments):
    return 1.01 * work_of_body_force(*arguments)


work_of_body_force, work_on = green.work_of_body_force, green.work_on
REMAINING, FALLING = green.HALVED.key, green.SHRUNK.key


@pytest.mark.parametrize(
    ("name", "defect"),
    [
        ("Gauge", Flipped),
        ("work_of_body_force", swapped),
        ("work_of_body_force", forgotten),
        ("work_on", without_loads),
    ],
    ids=["contact work", "law", "f_0", "f_2"],
)
def test_green_s_formula_notices_a_wrong_term(monkeypatch, name, defect) -> None:
    monkeypatch.setattr(green, name, defect)
    settings = [Setting(case, "one-diagonal", n) for case in ("full-contact", "yield-and-release") for n in (4, 8)]
    found = green.Green().judge(rows_of(green.Green(), settings))
    assert [verdict.verdict for verdict in found] == [FAILS, FAILS, FAILS]


def test_where_quadrature_is_rough_a_body_force_one_per_cent_off_does_not_fall(monkeypatch) -> None:
    monkeypatch.setattr(green, "work_of_body_force", slightly_off)
    settings = [Setting("yield-and-release", "one-diagonal", n) for n in (4, 8)]
    found = verdicts(green.Green().judge(rows_of(green.Green(), settings)))
    assert found == {REMAINING: HOLDS, FALLING: FAILS}


def test_green_s_formula_notices_a_stress_whose_divergence_is_no_function() -> None:
    # α = 2: w''' and with it f_0 has a Dirac measure on the line of the front.
    found = green.Green().judge(rows_of(green.Green(), [Setting("rough-2", "shaken", n) for n in (4, 8)]))
    assert {verdict.verdict for verdict in found} == {FAILS}
    assert "rough-2" not in {setting.case for setting in green.Green().places(full=True)}


def test_fronts_are_where_the_level_changes_its_sign() -> None:
    (face,) = resolve("advance-recede").solution.faces
    assert face.fronts(0.7) == pytest.approx((0.25 + 2 * 0.7 * 0.3,), abs=1e-14)
    (face,) = resolve("full-contact").solution.faces
    assert face.fronts(0.7) == ()


# (2.17), (3.6).


class Pinned(Space):
    """Γ1 shrunk to two points: Korn's inequality fails."""

    @property
    def free(self):
        ends = [np.linalg.norm(self.mesh.p - np.array([[x], [1.0]]), axis=0).argmin() for x in (0.0, 1.0)]
        fixed = np.isin(np.arange(self.mesh.p.shape[1]), ends)
        return np.flatnonzero(np.repeat(~fixed, 2))


def test_a_body_held_at_points_has_no_korn_inequality(monkeypatch) -> None:
    monkeypatch.setattr(korn, "space_of", lambda s: Pinned(OneDiagonal()(SQUARE, s.level), SQUARE))
    settings = [Setting("full-contact", "one-diagonal", n) for n in (8, 16, 32)]
    falling, limit = korn.Korn().judge(rows_of(korn.Korn(), settings))
    assert (falling.verdict, limit.verdict) == (HOLDS, FAILS)
    assert 0.5 < limit.observed < 0.6


@pytest.mark.parametrize("values", [(0.3, 0.2, 0.21), (0.4, 0.2, 0.1), (1 / 3, 1 / 4, 1 / 5), (0.3, 0.25, np.nan)])
def test_eigenvalues_that_rise_or_tend_to_zero_fail(values) -> None:
    assert FAILS in verdicts(korn.Korn().judge(table(**{"smallest eigenvalue": values}))).values()


def test_norms_that_are_not_equivalent_fail(monkeypatch) -> None:
    monkeypatch.setattr(korn, "h1_product", eigen.mass)
    settings = [Setting("full-contact", "one-diagonal", n) for n in (4, 8, 16)]
    found = verdicts(korn.Norms().judge(rows_of(korn.Norms(), settings)))
    assert found["upper"] == FAILS
    assert found["settled-largest"] == FAILS
    weaker = {"lower bound": 1.01, "upper bound": 0.9, "smallest": 0.5 ** np.arange(3), "largest": 1.0}
    found = verdicts(korn.Norms().judge(table(**weaker)))
    assert found["lower"] == FAILS
    assert found["settled-smallest"] == FAILS


# (3.1)–(3.3).


@dataclass(frozen=True, eq=False)
class Stated(Linear):
    """A tensor with other constants than its own, or another tensor than it says."""

    shares: tuple[float, float, float] = (1.0, 1.0, 1.0)
    skew: float = 0.0

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
        return Scaled(self.matrix + self.skew * np.diag([1.0, 1.0], 1))


class Prestressed:
    """G(ε) plus a stress at rest that the law does not state."""

    def __init__(self, operator, more: tuple[float, ...]) -> None:
        self.operator, self.derivative, self.more = operator, operator.derivative, np.array(more)[:, None]

    def __call__(self, strain):
        return self.operator(strain) + self.more


@dataclass(frozen=True, eq=False)
class WithPrestress(Stated):
    more: tuple[float, ...] = (1.0, 1.0, 1.0)

    def at(self, x):
        return Prestressed(super().at(x), self.more)


def measured_with(monkeypatch, module, statement: ListedNumbers, A, G, level: int = 4) -> dict[str, str]:
    case = SimpleNamespace(solution=SimpleNamespace(law=KelvinVoigt(A, G, "doctored")))
    monkeypatch.setattr(module, "resolve", lambda name: case)
    return verdicts(statement.judge(rows_of(statement, [Setting("full-contact", "one-diagonal", level)])))


ISOTROPIC = isotropic(1, 0.5)
MATRIX = ISOTROPIC.matrix


@pytest.mark.parametrize(
    ("tensor", "key", "verdict"),
    [
        (Stated(MATRIX), "ellipticity", HOLDS),
        (Stated(MATRIX / 10), "ellipticity", HOLDS),
        (Stated(MATRIX, shares=(1.1, 1, 1)), "ellipticity", FAILS),
        (Stated(MATRIX, shares=(0.9, 1, 1)), "ellipticity", REPORTED),
        (Stated(MATRIX, shares=(1, 0.9, 1)), "bound", FAILS),
        (Stated(MATRIX, shares=(1, 1.1, 1)), "bound", REPORTED),
        (Stated(MATRIX, skew=0.1), "bound", FAILS),
        (Stated(MATRIX, skew=10.0), "ellipticity", FAILS),
    ],
)
def test_a_viscosity_is_held_to_its_constants(monkeypatch, tensor, key, verdict) -> None:
    assert measured_with(monkeypatch, constitutive_law, constitutive_law.Viscosity(), tensor, ISOTROPIC)[key] == verdict


@pytest.mark.parametrize(
    ("tensor", "key", "verdict"),
    [
        (Stated(MATRIX), "lipschitz", HOLDS),
        (Stated(MATRIX, shares=(1, 0.99, 1)), "lipschitz", FAILS),
        (Stated(MATRIX, shares=(1, 1.1, 1)), "lipschitz", REPORTED),
        (Stated(MATRIX, shares=(1, 1, 1.01)), "monotonicity", FAILS),
        (WithPrestress(MATRIX), "at-zero", FAILS),
        (WithPrestress(MATRIX, more=(0.0, -1.0, 0.0)), "at-zero", FAILS),
    ],
)
def test_an_elasticity_operator_is_held_to_its_constants(monkeypatch, tensor, key, verdict) -> None:
    found = measured_with(monkeypatch, constitutive_law, constitutive_law.ElasticityOperator(), ISOTROPIC, tensor)
    assert found[key] == verdict


class Returned(Yield):
    """ε ↦ c β (ε − P_r ε), r other than the radius of K."""

    share, radius = 1.0, 1.0

    def __call__(self, strain):
        ball = replace(self.convex, radius=self.convex.radius * self.radius)
        return self.share * Yield(self.beta, ball)(strain)


class Short(Returned):
    share = 0.5


class Far(Returned):
    share = 1.5


class Opposite(Returned):
    share = -1.0


class Narrow(Returned):
    radius = 0.5


@pytest.mark.parametrize("ball", [FrobeniusBall(0.5), DeviatoricBall(0.3)], ids=["Frobenius", "deviatoric"])
@pytest.mark.parametrize(
    ("kind", "failing"),
    [
        (Yield, None),
        (Short, "membership"),
        (Far, "nearest"),
        (Opposite, "expansion"),
        (Narrow, "identity"),
    ],
)
def test_the_operator_of_a_yield_law_is_a_projection(monkeypatch, ball, kind, failing) -> None:
    found = measured_with(monkeypatch, constitutive_law, constitutive_law.Projection(), ISOTROPIC, kind(3.0, ball))
    assert found[failing] == FAILS if failing else set(found.values()) == {HOLDS}


# (4.3), (5.5).


def test_an_operator_steeper_than_its_law_says_is_noticed(monkeypatch) -> None:
    found = measured_with(monkeypatch, lipschitz, lipschitz.Lipschitz(), isotropic(1, 0), isotropic(2, 3), 8)
    assert set(found.values()) == {HOLDS}
    steeper = Stated(isotropic(2, 3).matrix, shares=(1, 0.9, 1))
    found = measured_with(monkeypatch, lipschitz, lipschitz.Lipschitz(), isotropic(1, 0), steeper, 8)
    assert found["constant"] == FAILS


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
    assert set(verdicts(lipschitz.Lipschitz().judge(table(**good))).values()) == {HOLDS}
    found = verdicts(lipschitz.Lipschitz().judge(table(**{**good, column: value})))
    assert sorted(found.values()) == [FAILS, HOLDS, HOLDS, HOLDS]


# K^h, Π^h.


class Outward(Space):
    """v_ν ≥ 0 in place of v_ν ≤ 0."""

    @property
    def N(self):
        return -super().N


class Upright(Space):
    """The vertical axis in place of ν."""

    @property
    def N(self):
        ((_, vertices),) = self.contact
        rows = sps.lil_array((len(vertices), 2 * self.mesh.p.shape[1]))
        rows[np.arange(len(vertices)), 2 * vertices + 1] = -1
        return sps.csr_array(sps.csr_array(rows)[:, self.free])


class OneLess(Space):
    """A vertex of Γ3 without its constraint."""

    @property
    def N(self):
        return super().N[1:]


class OneMore(Space):
    """A constraint at a vertex that is not on Γ3."""

    @property
    def N(self):
        vertex = np.flatnonzero((self.mesh.p > 0.3).all(axis=0) & (self.mesh.p < 0.7).all(axis=0))[0]
        row = sps.csr_array(([1.0], ([0], [2 * vertex + 1])), shape=(1, 2 * self.mesh.p.shape[1]))[:, self.free]
        return sps.csr_array(sps.vstack([super().N, row]))


MEMBERS, STRANGERS = "members", "strangers"


@pytest.mark.parametrize(
    ("kind", "case", "failing"),
    [
        (Space, "rotated", None),
        (Outward, "full-contact", MEMBERS),
        (Upright, "rotated", MEMBERS),
        (OneLess, "full-contact", MEMBERS),
        (OneMore, "full-contact", STRANGERS),
    ],
)
def test_a_wrong_constraint_is_noticed(monkeypatch, kind, case, failing) -> None:
    body = resolve(case).solution.body
    monkeypatch.setattr(constraint, "space_of", lambda s: kind(Shaken()(body, s.level), body))
    statement = constraint.VertexConstraint()
    found = verdicts(statement.judge(rows_of(statement, [Setting(case, "shaken", 5)])))
    assert found[failing] == FAILS if failing else set(found.values()) == {HOLDS}


def test_interpolants_outside_of_the_set_of_the_code_are_noticed(monkeypatch) -> None:
    monkeypatch.setattr(constraint, "space_of", lambda s: Outward(Shaken()(SQUARE, s.level), SQUARE))
    statement = constraint.Interpolant()
    found = statement.judge(rows_of(statement, [Setting("no-contact", "shaken", 5)]))
    assert [verdict.verdict for verdict in found] == [FAILS, HOLDS, FAILS]


def test_a_solution_that_penetrates_or_moves_the_clamp_is_noticed() -> None:
    space = Space(Shaken()(SQUARE, 5), SQUARE)
    shifted = SimpleNamespace(
        body=SQUARE, at=lambda x: SimpleNamespace(displacement=lambda time: np.array([0 * x[0], 1e-6 - x[1]]))
    )
    found = constraint.over_time(constraint.NormalTrace(space), shifted)
    assert found["exact"] < 0 < found["clamped"]
    found = constraint.over_time(
        constraint.NormalTrace(space),
        SimpleNamespace(
            body=SQUARE, at=lambda x: SimpleNamespace(displacement=lambda time: np.array([x[0], x[1] - 1]))
        ),
    )
    assert found["exact"] > 0
    assert found["clamped"] > 0


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


EQUATION, SMALL, BOUND = (line.key for line in residual.lines(residual.KINKED, residual.KINKED))
plain = residual.terms


def without_body_force(*arguments):
    found = plain(*arguments)
    return replace(found, body=0 * found.body)


def without_surface_load(*arguments):
    found = plain(*arguments)
    return replace(found, loaded=0 * found.loaded)


def surface_load_flipped(*arguments):
    found = plain(*arguments)
    return replace(found, loaded=-found.loaded)


def contact_flipped(*arguments):
    found = plain(*arguments)
    return replace(found, contact=-found.contact)


def tangential_trace(solution, space, time, members):
    """v_τ in place of v_ν on Γ3."""
    return replace(plain(solution, space, time, members), contact=plain(solution, space, time, turned(members)).contact)


def turned(members):
    def on(member):
        return lambda part, rule: member.on(part, rule)[::-1]

    return [SimpleNamespace(inside=member.inside, on=on(member)) for member in members]


def test_no_case_has_an_event_at_the_times_of_green_s_formula() -> None:
    """lift-and-land presses before and after it is in the air."""
    case = resolve("lift-and-land")
    space = space_of(Setting(case.name, "shaken", 4))
    pressed = [residual.terms(case.solution, space, time, residual.smooth_fields(space)).bound for time in green.TIMES]
    assert [bool(np.all(bound > 0)) for bound in pressed] == [True, False, True]


def test_a_share_of_nothing_is_left_out_or_undecided(monkeypatch) -> None:
    statement = residual.Residual()
    found = verdicts(statement.judge(rows_of(statement, [Setting("no-contact", "shaken", 4)])))
    assert found == {EQUATION: HOLDS, SMALL: HOLDS}
    monkeypatch.setattr(residual, "TIMES", (0.5,))  # In the air.
    found = verdicts(statement.judge(rows_of(statement, [Setting("lift-and-land", "shaken", 4)])))
    assert found == {EQUATION: HOLDS, SMALL: HOLDS, BOUND: UNDECIDED}


@pytest.mark.parametrize("case", ["full-contact", "yield-and-release"])
@pytest.mark.parametrize(
    ("wrong", "failing"),
    [
        (plain, set()),
        (without_body_force, {EQUATION, SMALL, BOUND}),
        (without_surface_load, {EQUATION, SMALL}),
        (surface_load_flipped, {EQUATION, SMALL}),
        (contact_flipped, {EQUATION}),
        (tangential_trace, {EQUATION}),
    ],
)
def test_a_wrong_residual_or_trace_is_noticed(monkeypatch, case, wrong, failing) -> None:
    monkeypatch.setattr(residual, "terms", wrong)
    statement = residual.Residual()
    found = verdicts(statement.judge(rows_of(statement, [Setting(case, "shaken", 6)])))
    assert {key for key, verdict in found.items() if verdict == FAILS} >= failing
    assert bool(failing) == (FAILS in found.values())


# (5.23), (5.24).


@pytest.mark.parametrize(
    ("order", "verdict"), [(1.0, HOLDS), (0.8, FAILS), (1.2, FAILS), (2.0, FAILS), (np.nan, FAILS)]
)
def test_the_order_in_v_is_judged_from_both_sides(order: float, verdict: str) -> None:
    h = 1 / np.array([8.0, 16.0, 32.0])
    columns = dict.fromkeys([*map(interpolation.at, interpolation.TIMES), interpolation.SMOOTH], h**order)
    assert set(verdicts(interpolation.InterpolationInV().judge(table(**columns))).values()) == {verdict}


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
    h = 1 / np.array([8.0, 16.0, 32.0])
    name = interpolation.at(interpolation.TIMES[0])
    columns = {interpolation.REGULARITY: tau, "size of Γ3,1": h, interpolation.trace_of(name, 1): h**order}
    (found,) = interpolation.InterpolationOnContact().judge(table(**columns))
    assert found.verdict == verdict
    if verdict == REPORTED:
        assert ("differs" in found.expected) == (order == 1.0)


def test_a_trace_that_is_zero_has_no_order_to_be_judged() -> None:
    statement = interpolation.InterpolationOnContact()
    found = statement.judge(rows_of(statement, [Setting("full-contact", "shaken", n) for n in (8, 16, 32)]))
    assert [verdict.key for verdict in found] == ["smooth-face-1"]


class Stretched(Space):
    """Π^h v is a little too large."""

    def interpolate(self, values):
        return 1.1 * super().interpolate(values)


def test_an_interpolant_that_is_none_has_no_order(monkeypatch) -> None:
    body = resolve("no-contact").solution.body
    monkeypatch.setattr(interpolation, "space_of", lambda s: Stretched(OneDiagonal()(body, s.level), body))
    statement = interpolation.InterpolationInV()
    settings = [Setting("no-contact", "one-diagonal", n) for n in (8, 16, 32)]
    assert set(verdicts(statement.judge(rows_of(statement, settings))).values()) == {FAILS}


def test_the_distance_of_a_smooth_field_is_that_of_the_gauge() -> None:
    solution = resolve("no-contact").solution
    space = Space(Shaken()(solution.body, 6), solution.body)
    # The points of the gauge share coordinates, which leaves its rules exact to a lower degree.
    gauge = Gauge(solution, space, 4)
    sample = gauge.sample(0.5)

    found = interpolation.distance_in_V(solution, space, lambda x: solution.at(x).displacement(0.5))
    assert found == pytest.approx(gauge.distance(sample, sample.interpolant), rel=1e-7)
