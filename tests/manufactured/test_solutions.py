"""What exact solutions are made of: singular fields that rest or travel, layers, coupled strains, regularity."""

from dataclasses import replace

import numpy as np
import pytest
from costly_cases import by_cost
from on_floor import on_floor
from sympy import Abs, Integer, Rational, cos, expand, sin

from manufactured import (
    Body,
    Case,
    CaseError,
    ContactFace,
    DeviatoricBall,
    ExactSolution,
    Factor,
    FormulaError,
    FrobeniusBall,
    KelvinVoigt,
    Kind,
    Linear,
    NonSymmetric,
    Prescribed,
    Regularity,
    SelfProofError,
    Yield,
    box,
    cutoff,
    evaluate,
    isotropic,
    layered,
    named,
    polygon,
    pos,
    prove,
    s,
    s1,
    s2,
    t,
    unit_square,
    x1,
    x2,
)
from manufactured.cases.laws import anisotropic, not_proportional
from manufactured.catalogue import NAMES, catalogue
from manufactured.contact.contact_face import VARIABLES
from manufactured.contact.lifting_terms import strain_terms
from manufactured.face_strain import Coupled
from manufactured.face_strain.strain_on_face import relaxation_rate
from manufactured.factor import layers
from manufactured.multiscale import FadingFace, StripFace, multiscale, rollers
from manufactured.natural_motion import PLACE, natural_motion
from manufactured.proved import proved_order
from manufactured.self_proof import examine
from manufactured.singular import TravellingField
from manufactured.tensors import mandel, traction
from study.fem.error_norm import ErrorNorm
from study.fem.mesh import Shaken
from study.fem.naming import resolve
from study.fem.space import Space

POINTS = np.random.default_rng(0).uniform(0.05, 0.95, (2, 50))
FIELDS = "displacement", "velocity", "strain", "strain_rate"
WITH_FORCES = *FIELDS, "strain_gradient", "stress", "body_force"


VARIABLE_DEPTH = "trains", "roller-8"


@pytest.mark.parametrize("name", by_cost([*NAMES, "natural-motion", *VARIABLE_DEPTH]))
def test_fields_at_many_times_are_those_at_each(name: str) -> None:
    """At points of which many share their coordinates along a face, as on a mesh; the times come last."""
    case = resolve(name)
    body = case.solution.body
    grid = np.round(8 * body.sample(np.random.default_rng(3), 200)) / 8 + 1e-3
    fields, times = case.solution.at(grid[:, body.contains(grid)]), body.T * np.array([0.0, 0.31, 0.64, 1.0])
    for of in (getattr(fields, quantity) for quantity in (FIELDS if name in VARIABLE_DEPTH else WITH_FORCES)):
        each, together = np.array([of(float(time)) for time in times]), np.moveaxis(of(times), -1, 0)
        np.testing.assert_allclose(together, each, rtol=1e-12, atol=1e-12 * abs(each).max(), err_msg=of.__name__)


@pytest.mark.parametrize("name", ["junction", "natural-front"])
def test_williams_fields_need_no_force_where_nothing_cuts_them_off(name: str) -> None:
    """Div σ = 0 for the eigenfunctions; the cut-off of the natural front brings forces of its own."""
    solution = named(name).solution
    face = solution.faces[0]
    plain = replace(solution, faces=(replace(face, field=replace(face.field, depth=None)),))
    fields = plain.at(POINTS)
    assert abs(fields.body_force(0.7)).max() < 1e-10 * abs(fields.stress(0.7)).max() / 0.05


def test_the_sides_of_the_re_entrant_corner_are_free_of_traction_near_it() -> None:
    """Where the cut-off is flat: at distances ≪ R."""
    (mode,) = named("re-entrant").solution.others
    r = np.array([1e-6, 1e-5])
    for along, normal in ((np.array([1.0, 0.0]), np.array([0.0, 1.0])), (np.array([0.0, 1.0]), np.array([1.0, 0.0]))):
        fields = mode.at(np.ones((2, 1)) + along[:, None] * r)
        stress = isotropic(1, 0.5)(fields.strain(1.0))
        assert abs(traction(stress, normal)).max() < 1e-6 * abs(stress).max()


def test_a_law_that_couples_nn_with_sn_needs_a_shear_on_the_face() -> None:
    (face,) = named("anisotropic").solution.faces
    assert isinstance(face.strain, Coupled)
    q, r = face.strain.at(np.linspace(0.1, 0.6, 7)[None])(0.8, False, 0)
    assert abs(r[0,]).max() > 0.05 * abs(q[0,]).max()
    plain = on_floor(not_proportional(), face.gap, face.strain.pressure, face.level)
    with pytest.raises(SelfProofError, match="σ_τ = 0"):
        prove(replace(plain, law=anisotropic()), "without the shear")


SLIP = {2: (t * (1 + t) * sin(2 * s + 1),), 3: (t * sin(s1 + 2 * s2), (1 + t**2) * cos(2 * s1 - s2))}
"""Slips z(s, t) along a contact face, by the dimension of the body."""


def with_slip(solution: ExactSolution) -> ExactSolution:
    """The solution for a linear law and one contact face, with the same gap and pressure and another slip."""
    (face,), law, body = solution.faces, solution.law, solution.body
    data = face.part, law, body.T, face.gap, face.strain.pressure, face.level
    return replace(solution, faces=(ContactFace.linear(*data, slip=SLIP[body.dim]),))


def coupled(dim: int) -> KelvinVoigt:
    """A law that couples every strain on a face with every other, with A and G not proportional."""
    size = dim * (dim + 1) // 2
    matrices = [np.eye(size) * 4 + np.cos(k + np.add.outer(*[np.arange(size) ** 2] * 2)) / 2 for k in range(2)]
    return KelvinVoigt(*map(Linear, matrices), "coupled")


def not_symmetric() -> KelvinVoigt:
    """A law whose G has A_nnss ≠ A_ssnn, which does not couple normal strains with shear."""
    G = NonSymmetric(np.array([[3.0, 1.0, 0.0], [2.0, 5.0, 0.0], [0.0, 0.0, 2.0]]))
    return KelvinVoigt(isotropic(1, 0.5), G, "not symmetric")


LAWS = {"rotated": coupled(2), "cube-disc": coupled(3), "advance-recede": not_symmetric()}
"""Laws that no case of the catalogue has, for the bodies and contact data of a case."""


@pytest.mark.parametrize("name", LAWS)
def test_a_face_slips_without_friction_under_laws_that_no_case_has(name: str) -> None:
    slipping = with_slip(replace(named(name).solution, law=LAWS[name]))
    prove(slipping, name)
    (face,) = slipping.faces
    place = face.part.sample(np.random.default_rng(0), 9)
    u = face.part.frame[:, :-1].T @ slipping.at(place).displacement(0.7)
    z = [jet(face.part.coordinates(place)[0], 0.7)[(0,) * len(u)] for jet in face.jets[1:]]
    np.testing.assert_allclose(u, z, atol=1e-12)


def test_under_a_law_that_couples_strains_the_body_can_start_with_any_normal_strain() -> None:
    solution = on_floor(coupled(2), 0, 30 * (1 + t), initial=-s / 2, slip=SLIP[2])
    prove(solution, "initial strain")
    q, r = solution.faces[0].strain.at(np.array([[0.2, 0.8]]))(0.0, False, 0)
    np.testing.assert_allclose([q[0,], r[0,]], [[-0.1, -0.4], [0, 0]], atol=1e-12)


def test_the_stress_of_slip_in_the_face_and_the_slip_in_the_strain_are_needed(monkeypatch) -> None:
    """Under a law that couples ss with sn, where the slip also needs a shear for σ_τ = 0."""
    plane = with_slip(replace(named("advance-recede").solution, law=coupled(2)))
    (face,) = plane.faces
    half = [replace(mode, slip_stress=mode.slip_stress / 2) for mode in face.strain.modes]
    with pytest.raises(SelfProofError, match=r"(?s)σ_τ = 0.*p = −σ_ν"):
        prove(replace(plane, faces=(replace(face, strain=replace(face.strain, modes=tuple(half))),)), "half the stress")
    monkeypatch.setattr(
        "manufactured.contact.contact_face.strain_terms",
        lambda n, deep, tangential: strain_terms(n, deep, tuple(name for name in tangential if name != "f")),
    )
    with pytest.raises(SelfProofError, match=r"\(2.10\) ε\(u\) = sym ∇u"):
        prove(plane, "slip not in the strain")


@pytest.mark.parametrize("convex", [FrobeniusBall, DeviatoricBall])
@pytest.mark.parametrize("body", [unit_square(), box()], ids=["square", "cube"])
def test_under_the_law_3_3_the_whole_face_can_slip_while_it_is_pressed(convex: type, body: Body) -> None:
    """The strain, to which ε_ss = sym ∇_s z belongs, leaves K; still σ_τ = 0, and p ≥ 0 follows from the law."""
    law = KelvinVoigt(isotropic(1, 0.5, body.dim), Yield(6.0, convex(0.5, body.dim)), "(3.3)")
    (floor,) = body.of(Kind.CONTACT)
    first = VARIABLES[body.dim][0]
    strain = Prescribed(((1.0, -5 * t * (2 + t + first)),), VARIABLES[body.dim])
    prove(ExactSolution(body, law, (ContactFace(floor, Integer(0), strain, Integer(1), slip=SLIP[body.dim]),)), "(3.3)")


@pytest.mark.parametrize(("slip", "told"), [((s, s), "has 2 components"), ((Abs(s),), "write fronts with pos")])
def test_a_slip_with_a_wrong_number_of_components_or_with_a_kink_is_refused(slip: tuple, told: str) -> None:
    with pytest.raises(FormulaError, match=told):
        on_floor(not_proportional(), 0, 3 + s, slip=slip)


def test_a_front_of_the_slip_lowers_the_regularity() -> None:
    """With z ~ (s − c)_+³, ε_ss and with it q have the exponent 2 at the fixed front c."""
    solution = on_floor(not_proportional(), 0, 3 + s, slip=(t * pos(s - Rational(1, 3), 3),))
    Case("slip", "slips", solution, Regularity(pressure=2), order=1, reason="test")
    with pytest.raises(CaseError, match=r"Regularity\(pressure=2.0\)"):
        Case("slip", "slips", solution, Regularity(), order=1, reason="test")


def test_the_landing_jumps_in_velocity_but_not_in_load() -> None:
    solution = named("lift-and-land").solution
    space = Space(Shaken()(solution.body, 6), solution.body)
    v_norm = ErrorNorm(solution, space)
    before, after = 0.7 - 1e-9, 0.7 + 1e-9
    fields = solution.at(POINTS)
    jump = fields.velocity(after) - fields.velocity(before)
    assert abs(jump).max() > 0.5
    assert abs(v_norm.load(after) - v_norm.load(before)).max() < 1e-6 * abs(v_norm.load(after)).max()


def test_a_lifting_without_a_kink_at_an_interface_is_refused() -> None:
    factor = layers((0.0, 1.0), 0.5, 4.0)
    law, pressure = not_proportional(2, factor, factor), (3 + s) * (1 + t)
    prove(on_floor(law, 0, pressure, profile=layered(0.5, 4.0)), "right")
    for profile in (layered(0.5, 3.0), cutoff(1.0)):
        with pytest.raises(SelfProofError, match="σν continuous on"):
            prove(on_floor(law, 0, pressure, profile=profile), "wrong ratio, or no kink")


def test_a_relaxation_rate_is_a_number_where_factors_agree_along_the_face_and_is_refused_where_it_varies() -> None:
    factor = (1 + s / 2) * (2 + s)
    assert relaxation_rate(3 * expand(factor), factor) == 3
    assert relaxation_rate(sin(s) ** 2 + cos(s) ** 2, 2.0) == 0.5
    law = not_proportional(2, Factor(1 + x1, 1.0, 2.0), Factor(1 + 2 * x1, 1.0, 3.0))
    with pytest.raises(FormulaError, match="varies along the face"):
        on_floor(law, 0, 3 + s)


def test_bounds_of_a_factor_that_do_not_hold_are_found() -> None:
    law = KelvinVoigt(isotropic(1, 1, factor=Factor(1 + x2, 1.0, 1.5)), isotropic(1, 1), "wrong bounds")
    with pytest.raises(SelfProofError, match=r"\(3.1\) bounds of the factor"):
        prove(on_floor(law, 0, 3 + s), "wrong bounds")


def test_a_case_with_layers_needs_one_power_more_of_its_pressure() -> None:
    """u_s ~ ∇_s q in the upper layer: with m = 2 the stress σ_ss would jump across the moving front."""
    case = named("layered")
    (face,) = case.solution.faces
    rougher = replace(face, strain=replace(face.strain, pressure=150 * pos(Rational(1, 4) + t / 2 - s, 2)))
    with pytest.raises(CaseError, match="correct the label"):
        replace(case, solution=replace(case.solution, faces=(rougher,)), regularity=Regularity(4, 2, moving=True))


@pytest.mark.parametrize(
    ("regularity", "order", "proved", "proposition"),
    [
        (Regularity(), 1, 1, "Prop. 5.4"),
        (Regularity(gap=4, pressure=2, moving=True), 1, 1, "Prop. 5.4"),
        (Regularity(gap=3.25, pressure=2, moving=True), 1, 0.75, "Prop. 5.3"),
        (Regularity(gap=3, pressure=2, moving=True), 1, 0.5, "Prop. 5.3"),
        (Regularity(gap=3, pressure=2), 1, 1, "Prop. 5.4"),
        (Regularity(gap=2.25, pressure=1.25), 0.75, 0.75, "Prop. 5.3"),
        (Regularity(gap=2, pressure=1), 0.5, 0.5, "Prop. 5.3"),
        (Regularity(on_contact=1.5), 1, 1, "Prop. 5.3"),
        (Regularity(on_contact=1.25), 1, 0.875, "Prop. 5.3"),
        (Regularity(on_contact=0.5), 0.5, 0.25, "Prop. 5.3"),
        (Regularity(corner=0.5445), 0.5445, 0.5445, "Prop. 5.3"),
        (Regularity(kink=True), 0.5, 0.5, "Prop. 5.3"),
    ],
)
def test_exponents_say_what_to_expect_and_what_the_proof_gives(regularity, order, proved, proposition) -> None:
    assert regularity.order == pytest.approx(order)
    assert regularity.proved_order == pytest.approx(proved)
    assert regularity.proposition == proposition


NATURAL = r"natural-front of the catalogue.*SingularFace.*on_contact=1\.5"


@pytest.mark.parametrize(
    ("label", "message"),
    [
        ({"corner": 0.0}, "λ > 0"),
        ({"gap": 1.5}, "α > 3/2"),
        *(({"gap": gap, "pressure": 0.5}, NATURAL) for gap in (2, 1.5)),
    ],
)
def test_exponents_of_no_solution_in_h_1_or_of_no_contact_face_are_refused(label: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Regularity(**label)


def test_a_twin_is_the_same_body_in_another_position() -> None:
    """Or a case would be compared with itself: the same distances between corners, not the same corners."""
    twins = [case for case in map(named, NAMES) if case.twin]
    assert twins
    for case in twins:
        own, twin = (one.solution.body.vertices for one in (case, named(case.twin)))
        distances = [np.linalg.norm(corners[:, :, None] - corners[:, None], axis=0) for corners in (own, twin)]
        assert distances[0] == pytest.approx(distances[1])
        assert abs(own - twin).max() > 0.1


CASE = natural_motion()
(FACE,) = CASE.solution.faces
RECEDING = natural_motion(Rational(7, 10) - 2 * t / 5)


def test_the_natural_front_that_advances_is_an_exact_solution_and_one_that_recedes_pulls() -> None:
    assert [finding for finding in examine(CASE.solution) if not finding.passes] == []
    (finding,) = (finding for finding in examine(RECEDING.solution) if not finding.passes)
    assert "σ_ν ≤ 0" in finding.condition


def test_a_field_that_does_not_move_is_that_of_the_natural_front() -> None:
    resting, natural = natural_motion(Rational(2, 5)).solution, named("natural-front").solution
    x = np.array([[0.1, 0.41, 0.8], [0.2, 0.01, 0.6]])
    scale = (1 / 4 + 0.5) / (1 / 4 + 2 * 0.5)
    np.testing.assert_allclose(resting.at(x).displacement(0.5), scale * natural.at(x).displacement(0.5), rtol=1e-12)


def test_forces_and_their_rates_are_square_integrable_at_the_front() -> None:
    """f_0 ~ r^{1/2} and its rate ~ r^{−1/2}: (3.4) as it is printed, while the stress is ~ r^{−1/2} itself."""
    c, angle = float(PLACE.subs(t, 0.5)), 0.7
    sizes = []
    for r in (1e-3, 1e-5):
        fields = CASE.solution.at([[c + r * np.cos(angle)], [r * np.sin(angle)]])
        rate = fields.body_force(0.5 + 1e-30j).imag / 1e-30
        sizes.append([np.linalg.norm(value) for value in (fields.body_force(0.5), rate, fields.stress(0.5))])
    assert np.log10(np.divide(*sizes)) / 2 == pytest.approx([0.5, -0.5, -0.5], abs=0.03)


def test_a_field_with_a_cut_off_of_the_distance_does_not_travel() -> None:
    field = FACE.field
    assert isinstance(field, TravellingField)
    with pytest.raises(ValueError, match="give `depth`, not `radial`"):
        TravellingField(replace(field.steady, depth=None, radial=cutoff().b), PLACE)


# One call gives all fields of a case; points, times and shapes beyond the body and [0, T] are refused.


TIME = 0.4


@pytest.mark.parametrize("name", by_cost(NAMES))
def test_the_gradient_has_the_strain_as_its_symmetric_part_and_all_else_is_what_the_fields_say(name: str) -> None:
    case = named(name)
    body = case.solution.body
    x = body.sample(np.random.default_rng(5), 5)
    found, fields = evaluate(case, x, TIME), case.solution.at(x)
    size = abs(found.gradient).max()
    assert np.allclose(mandel(found.gradient), found.strain, rtol=0, atol=1e-11 * size)
    for quantity in ("displacement", "velocity", "strain_rate", "stress", "body_force"):
        assert np.array_equal(getattr(found, quantity), getattr(fields, quantity)(TIME)), quantity
    (*_, part) = body.of(Kind.LOADED)
    assert np.array_equal(found.surface_load(part), traction(found.stress, part.normal))


def test_the_gradient_is_the_difference_of_displacements() -> None:
    case, step = named("advance-recede"), 1e-6
    x = case.solution.body.sample(np.random.default_rng(5), 5)
    found = evaluate(case.solution, x, TIME).gradient
    for j in range(2):
        moved = [evaluate(case, x + sign * step * np.eye(2)[:, [j]], TIME).displacement for sign in (1, -1)]
        assert np.allclose(found[:, j], (moved[0] - moved[1]) / (2 * step), atol=1e-7)


BRACKET = named("re-entrant").solution


@pytest.mark.parametrize("point", [(5, 5), (1.5, 1.5), (-1e-6, 0.5), (np.nan, 0.5), (np.inf, 0.5)])
def test_a_point_outside_the_body_is_refused_also_at_a_re_entrant_corner(point: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match=r"lies outside the body.*1 of 2 points.*\[0, 2\] × \[0, 2\]"):
        BRACKET.at(np.array([point, (0.5, 0.5)]).T)
    for by in (1e-12, 1e-30j):
        assert np.isfinite(BRACKET.at(BRACKET.body.vertices + by).displacement(0.5)).all(), "rounding and complex steps"


@pytest.mark.parametrize("time", [3, -0.1, 1 + 1e-6, np.nan])
def test_a_time_outside_the_interval_is_refused_alone_and_among_others(time: float) -> None:
    fields, on_face = BRACKET.at([[0.5], [0.5]]), BRACKET.on(BRACKET.faces[0], [[0.5]])
    fields.displacement(1 + 1e-12)
    for field in (fields.displacement, fields.stress, fields.body_force, on_face.gap, on_face.pressure):
        for given in (time, np.array([0.5, time])):
            with pytest.raises(ValueError, match=r"lies outside \[0, 1\]"):
                field(given)


@pytest.mark.parametrize(
    ("x", "told"),
    [
        ([0, -0.4], r"shape \(2, n\).*got the shape \(2,\); write one point as \[\[0\], \[-0\.4\]\]"),
        (np.zeros((7, 2)), r"got the shape \(7, 2\); transpose it"),
        (np.zeros((3, 3)), r"got the shape \(3, 3\)"),
        (0.5, r"got the shape \(\)"),
        ([[0, 1], [0]], "rows of different lengths"),
    ],
)
def test_a_wrong_shape_says_which_shape_is_wanted(x: object, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        BRACKET.at(x)
    with pytest.raises(ValueError, match=told):
        evaluate(BRACKET, x, 0.5)


def test_an_initial_gap_given_as_the_gap_is_led_to_initial_gap() -> None:
    law = KelvinVoigt(isotropic(1, 0.5), isotropic(2, 3), "linear")
    zone = Rational(1, 16) - (s - Rational(1, 2)) ** 2
    solution = on_floor(law, (s - Rational(1, 2)) ** 2 / 2, 100 * t * pos(zone, 2), zone)
    advice = r"give it as `initial_gap` of ContactFace\.linear"
    with pytest.raises(CaseError, match=f"the pressure has a front and the gap has none.*{advice}"):
        Case("bowl", "initial gap", solution, Regularity(gap=2, pressure=2), order=1, reason="test")
    with pytest.raises(SelfProofError, match=f"(?s)on the stated zone.*{advice}"):
        prove(Case("bowl", "initial gap", solution, Regularity(pressure=2), order=1, reason="test").solution, "bowl")


# Cases with contact at many scales, and rollers, with details of the widths that they state.


def alone(case: Case, j: int) -> ExactSolution:
    """One train on a body no deeper than its lifting: random points of the unit square would hardly ever meet it."""
    face = case.solution.faces[j]
    assert isinstance(face, StripFace)
    length, depth = face.part.measure, face.profile.depth
    corners = [(0.0, 0.0), (length, 0.0), (length, depth), (0.0, depth)]
    body = polygon(corners, [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED])
    return ExactSolution(body, case.solution.law, (replace(face, part=body.of(Kind.CONTACT)[0]),))


@pytest.mark.parametrize(
    ("number", "j"),
    [(0, 6), *(pytest.param(*one, marks=pytest.mark.slow) for one in ((0, 0), (1, 3), (1, 0), (0, 3), (1, 6)))],
)
def test_every_train_is_an_exact_solution(number: int, j: int) -> None:
    assert [finding for finding in examine(alone(multiscale()[number], j)) if not finding.passes] == []


def test_every_train_has_twice_the_patches_of_the_one_before() -> None:
    for case in multiscale():
        counts = []
        for face in case.solution.faces:
            s = np.linspace(0, face.part.measure, 20_001)[1:-1]
            touching = face.level_jet(s[None], 0.5)[(0,)] >= 0
            counts.append(int(np.sum(touching[1:] & ~touching[:-1])))
        growth = np.divide(counts[3:], counts[2:-1])
        assert growth == pytest.approx(2, rel=0.2)


def test_a_lifting_does_not_reach_above_the_next_piece() -> None:
    solution = multiscale()[0].solution
    face = solution.faces[0]
    x = np.array([np.linspace(0, 1, 201), np.full(201, 1e-3)])
    u = face.at(x).displacement(1.0)
    assert np.abs(u[:, x[0] > 1 / 8]).max() == 0
    assert np.abs(u[:, x[0] < 1 / 8]).max() > 0


def test_theorems_raise_the_proved_order_only_of_a_rough_trace_and_of_a_junction() -> None:
    orders = {case.name: (proved_order(case), case.regularity.proved_order) for case in catalogue()}
    raised = {name: order for name, (order, source) in orders.items() if order > source}
    assert raised == pytest.approx({"rough-trace": 1, "junction": 0.5})
    assert proved_order(natural_motion()) == pytest.approx(0.6)
    assert all(proved_order(case) <= case.order for case in catalogue())


HISTORY = "(2.6)"
"""Of the self-proof: u = u_0 + ∫ u̇ dt by a rule with 256 steps, too few for what passes a point within a time ℓ."""


@pytest.mark.parametrize("level", [16, pytest.param(64, marks=pytest.mark.slow)])
@pytest.mark.parametrize("kind", [1, *(pytest.param(kind, marks=pytest.mark.slow) for kind in (0, 2, 3))])
def test_every_roller_is_an_exact_solution(kind: int, level: int) -> None:
    case = rollers(level)[kind]
    found = [finding for finding in examine(case.solution) if not finding.passes]
    assert [finding for finding in found if not finding.condition.startswith(HISTORY)] == []


@pytest.mark.slow
@pytest.mark.parametrize("kind", [0, 3])
def test_displacements_of_rollers_are_integrals_of_their_velocities(kind: int) -> None:
    solution = rollers(16)[kind].solution
    fields = solution.at(np.array([[0.2, 0.5, 0.55], [0.0, 0.03, 0.2]]))
    ends = np.linspace(0, solution.body.T, 3001)
    total = np.trapezoid([fields.velocity(time) for time in ends], ends, axis=0)
    change = fields.displacement(solution.body.T) - fields.displacement(0.0)
    assert total == pytest.approx(change, abs=1e-5 * abs(change).max())
    assert abs(change).max() > 1e-3


def test_a_roller_of_half_the_width_has_half_the_patch_and_leaves_the_same_strain_behind() -> None:
    wide, narrow = (rollers(level)[0].solution.faces[0] for level in (16, 32))
    s = np.linspace(0, 1, 40_001)[None]
    touching = [np.mean(face.level_jet(s, 0.35)[(0,)] >= 0) for face in (wide, narrow)]
    assert touching == pytest.approx([1 / 8, 1 / 16], abs=1e-3)
    assert isinstance(wide, FadingFace)
    assert isinstance(narrow, FadingFace)
    behind = np.array([[0.1, 0.2, 0.3]])
    left = [rollers(level)[0].solution.at(np.vstack([behind[0], 0 * behind[0]])).strain(0.35) for level in (16, 32)]
    assert left[0] == pytest.approx(left[1])
    assert left[0][1] == pytest.approx(-np.exp(behind[0] - 0.5))


def test_a_roller_fades_above_a_depth_that_grows_with_the_distance_from_it() -> None:
    solution = rollers(32)[0].solution
    under, behind = np.vstack([np.full(2, 0.47), [0.04, 0.05]]), np.vstack([np.full(2, 0.1), [0.27, 0.29]])
    for places in (under, behind):
        u = abs(solution.at(places).displacement(0.35)).max(axis=0)
        assert u[0] > 0
        assert u[1] == 0


def test_points_of_a_roller_that_share_a_place_along_the_face_have_the_fields_that_each_has_alone() -> None:
    solution = rollers(8)[0].solution
    grid = np.array(np.meshgrid(np.linspace(0, 1, 9), np.linspace(0, 0.6, 13), indexing="ij"))
    together = solution.at(grid)
    for i, x in enumerate(np.moveaxis(grid, 1, 0)):
        alone = solution.at(x)
        for name in ("displacement", "strain", "strain_rate", "strain_gradient"):
            here, own = getattr(together, name)(0.41), getattr(alone, name)(0.41)
            np.testing.assert_allclose(here[..., i, :], own, rtol=1e-13, atol=1e-13 * abs(here).max())
