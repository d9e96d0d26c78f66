"""What exact solutions are made of: singular fields that rest or travel, layers, coupled strains, regularity."""

from dataclasses import replace

import numpy as np
import pytest
from bodies import CLAMPED, CONTACT, LOADED
from costly_cases import by_cost, slow
from numpy.testing import assert_allclose
from on_floor import on_floor
from sympy import Integer, Rational, cos, expand, sin

from manufactured import (
    ContactFace,
    DeviatoricBall,
    ExactSolution,
    Factor,
    FormulaError,
    FrobeniusBall,
    KelvinVoigt,
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
    prove,
    s,
    s1,
    s2,
    t,
    unit_square,
    x1,
    x2,
)
from manufactured.case import proved_order
from manufactured.cases.materials import anisotropic_law
from manufactured.cases.rough import MOVING_FRONT, natural_motion
from manufactured.cases.shared import not_proportional
from manufactured.catalogue import NAMES, catalogue
from manufactured.contact import VARIABLES
from manufactured.face_strain import Coupled, relaxation_rate
from manufactured.factor import layers
from manufactured.multiscale import StripFace, multiscale, rollers
from manufactured.self_proof import examine
from manufactured.singular import TravellingField
from manufactured.tensors import mandel, traction
from study.fem.naming import resolve

POINTS = np.random.default_rng(0).uniform(0.05, 0.95, (2, 50))


def violated(solution, **options):
    """The findings of the self-proof that do not pass."""
    return [finding for finding in examine(solution, **options) if not finding.passes]


FIELDS = "displacement", "velocity", "strain", "strain_rate"
WITH_FORCES = *FIELDS, "strain_gradient", "stress", "body_force"


VARIABLE_DEPTH = "trains", "roller-8"


@pytest.mark.parametrize("name", by_cost([*NAMES, "natural-motion", *VARIABLE_DEPTH]))
def test_fields_at_many_times_are_those_at_each(name, rng):
    """At points of which many share their coordinates along a face, as on a mesh; the times come last."""
    case = resolve(name)
    body = case.solution.body
    grid = np.round(8 * body.sample(rng, 200)) / 8 + 1e-3
    fields = case.solution.at(grid[:, body.contains(grid)])
    times = body.T * np.array([0.0, 0.31, 0.64, 1.0])
    for of in (getattr(fields, quantity) for quantity in (FIELDS if name in VARIABLE_DEPTH else WITH_FORCES)):
        each = np.array([of(float(time)) for time in times])
        together = np.moveaxis(of(times), -1, 0)
        assert_allclose(together, each, rtol=1e-12, atol=1e-12 * abs(each).max(), err_msg=of.__name__)


@pytest.mark.parametrize("name", ["junction", "natural-front"])
def test_williams_fields_need_no_force_where_nothing_cuts_them_off(name):
    """Div σ = 0 for the eigenfunctions; the cut-off of the natural front brings forces of its own."""
    solution = named(name).solution
    face = solution.faces[0]
    plain = replace(solution, faces=(replace(face, field=replace(face.field, depth=None)),))
    fields = plain.at(POINTS)
    assert abs(fields.body_force(0.7)).max() < 1e-10 * abs(fields.stress(0.7)).max() / 0.05


def test_a_law_that_couples_nn_with_sn_needs_a_shear_on_the_face():
    (face,) = named("anisotropic").solution.faces
    assert isinstance(face.strain, Coupled)
    plain = on_floor(not_proportional(), face.gap, face.strain.pressure, face.level)
    with pytest.raises(SelfProofError, match="σ_τ = 0"):
        prove(replace(plain, law=anisotropic_law()), "without the shear")


SLIP = {2: (t * (1 + t) * sin(2 * s + 1),), 3: (t * sin(s1 + 2 * s2), (1 + t**2) * cos(2 * s1 - s2))}
"""Slips z(s, t) along a contact face, by the dimension of the body."""


def with_slip(solution):
    """The solution for a linear law and one contact face, with the same gap and pressure and another slip."""
    (face,) = solution.faces
    law = solution.law
    body = solution.body
    data = face.part, law, body.T, face.gap, face.strain.pressure, face.level
    return replace(solution, faces=(ContactFace.linear(*data, slip=SLIP[body.dim]),))


def coupled(dim):
    """A law that couples every strain on a face with every other, with A and G not proportional."""
    size = dim * (dim + 1) // 2
    matrices = [np.eye(size) * 4 + np.cos(k + np.add.outer(*[np.arange(size) ** 2] * 2)) / 2 for k in range(2)]
    return KelvinVoigt(*map(Linear, matrices), "coupled")


def not_symmetric():
    """A law whose G has A_nnss ≠ A_ssnn, which does not couple normal strains with shear."""
    G = NonSymmetric([[3.0, 1.0, 0.0], [2.0, 5.0, 0.0], [0.0, 0.0, 2.0]])
    return KelvinVoigt(isotropic(1, 0.5), G, "not symmetric")


LAWS = {"rotated": coupled(2), "cube-disc": coupled(3), "advance-recede": not_symmetric()}
"""Laws that no case of the catalogue has, for the bodies and contact data of a case."""


@pytest.mark.parametrize("name", LAWS)
def test_a_face_slips_without_friction_under_laws_that_no_case_has(name, rng):
    slipping = with_slip(replace(named(name).solution, law=LAWS[name]))
    assert violated(slipping, points=4, times=2) == []
    (face,) = slipping.faces
    place = face.part.sample(rng, 9)
    u = face.part.frame[:, :-1].T @ slipping.at(place).displacement(0.7)
    z = [jet(face.part.coordinates(place)[0], 0.7)[(0,) * len(u)] for jet in face.jets[1:]]
    assert_allclose(u, z, atol=1e-12)


@pytest.mark.parametrize("dim", SLIP)
def test_on_a_face_whose_gap_and_normal_strain_rest_the_slip_may_move(dim):
    body = {2: unit_square(), 3: box()}[dim]
    (floor,) = body.of(CONTACT)
    strain = Prescribed(((1.0, Integer(-1)),), VARIABLES[dim])
    law = KelvinVoigt(isotropic(1, 0.5, dim), isotropic(1, 0.5, dim), "equal")
    face = ContactFace(floor, Integer(0), strain, Integer(1), slip=SLIP[dim])
    step = 1e-20
    at = ExactSolution(body, law, (face,)).at(floor.point(np.full((dim - 1, 1), 0.3)))
    assert_allclose(at.displacement(0.5 + 1j * step).imag / step, at.velocity(0.5), atol=1e-14)


@pytest.mark.parametrize("convex", [FrobeniusBall, DeviatoricBall])
@pytest.mark.parametrize("body", [unit_square(), box()], ids=["square", "cube"])
def test_under_the_law_3_3_the_whole_face_can_slip_while_it_is_pressed(convex, body):
    """The strain, to which ε_ss = sym ∇_s z belongs, leaves K; still σ_τ = 0, and p ≥ 0 follows from the law."""
    law = KelvinVoigt(isotropic(1, 0.5, body.dim), Yield(6.0, convex(0.5, body.dim)), "(3.3)")
    (floor,) = body.of(CONTACT)
    first = VARIABLES[body.dim][0]
    strain = Prescribed(((1.0, -5 * t * (2 + t + first)),), VARIABLES[body.dim])
    prove(ExactSolution(body, law, (ContactFace(floor, Integer(0), strain, Integer(1), slip=SLIP[body.dim]),)), "(3.3)")


def test_a_lifting_without_a_kink_at_an_interface_is_refused():
    factor = layers((0.0, 1.0), 0.5, 4.0)
    law = not_proportional(2, factor, factor)
    pressure = (3 + s) * (1 + t)
    prove(on_floor(law, 0, pressure, profile=layered(0.5, 4.0)), "right")
    for profile in (layered(0.5, 3.0), cutoff(1.0)):
        with pytest.raises(SelfProofError, match="σν continuous on"):
            prove(on_floor(law, 0, pressure, profile=profile), "wrong ratio, or no kink")


def test_a_relaxation_rate_is_a_number_where_factors_agree_along_the_face_and_is_refused_where_it_varies():
    factor = (1 + s / 2) * (2 + s)
    assert relaxation_rate(3 * expand(factor), factor) == 3
    assert relaxation_rate(sin(s) ** 2 + cos(s) ** 2, 2.0) == 0.5
    law = not_proportional(2, Factor(1 + x1, 1.0, 2.0), Factor(1 + 2 * x1, 1.0, 3.0))
    with pytest.raises(FormulaError, match="varies along the face"):
        on_floor(law, 0, 3 + s)


def test_bounds_of_a_factor_that_do_not_hold_are_found():
    law = KelvinVoigt(isotropic(1, 1, factor=Factor(1 + x2, 1.0, 1.5)), isotropic(1, 1), "wrong bounds")
    with pytest.raises(SelfProofError, match=r"\(3.1\) bounds of the factor"):
        prove(on_floor(law, 0, 3 + s), "wrong bounds")


@pytest.mark.parametrize(
    ("regularity", "order", "proved", "proposition"),
    [
        (Regularity(), 1, 1, "Prop. 5.4"),
        (Regularity(gap=4, pressure=2, moving=True), 1, 1, "Prop. 5.4"),
        (Regularity(gap=3.25, pressure=2, moving=True), 1, 0.75, "Prop. 5.3"),
        (Regularity(gap=3, pressure=2), 1, 1, "Prop. 5.4"),
        (Regularity(gap=2.25, pressure=1.25), 0.75, 0.75, "Prop. 5.3"),
        (Regularity(on_contact=1.5), 1, 1, "Prop. 5.3"),
        (Regularity(on_contact=1.25), 1, 0.875, "Prop. 5.3"),
        (Regularity(on_contact=0.5), 0.5, 0.25, "Prop. 5.3"),
        (Regularity(corner=0.5445), 0.5445, 0.5445, "Prop. 5.3"),
        (Regularity(kink=True), 0.5, 0.5, "Prop. 5.3"),
    ],
)
def test_exponents_say_what_to_expect_and_what_the_proof_gives(regularity, order, proved, proposition):
    assert regularity.order == pytest.approx(order)
    assert regularity.proved_order == pytest.approx(proved)
    assert regularity.proposition == proposition


CASE = natural_motion()
(FACE,) = CASE.solution.faces
RECEDING = natural_motion(Rational(7, 10) - 2 * t / 5)


def test_the_natural_front_that_advances_is_an_exact_solution_and_one_that_recedes_pulls():
    assert violated(CASE.solution) == []
    (finding,) = violated(RECEDING.solution)
    assert "σ_ν ≤ 0" in finding.condition


def test_a_field_with_a_cut_off_of_the_distance_does_not_travel():
    field = FACE.field
    assert isinstance(field, TravellingField)
    with pytest.raises(ValueError, match="give `depth`, not `radial`"):
        TravellingField(replace(field.steady, depth=None, radial=cutoff().b), MOVING_FRONT)


# One call gives all fields of a case; points, times and shapes beyond the body and [0, T] are refused.


@pytest.mark.parametrize("name", by_cost(NAMES))
def test_the_gradient_has_the_strain_as_its_symmetric_part_and_all_else_is_what_the_fields_say(name, rng):
    case = named(name)
    x = case.solution.body.sample(rng, 5)
    found = evaluate(case, x, 0.4)
    fields = case.solution.at(x)
    assert mandel(found.gradient) == pytest.approx(found.strain, abs=1e-11 * abs(found.gradient).max())
    for quantity in ("displacement", "velocity", "strain_rate", "stress", "body_force"):
        assert np.array_equal(getattr(found, quantity), getattr(fields, quantity)(0.4)), quantity
    (*_, part) = case.solution.body.of(LOADED)
    assert np.array_equal(found.surface_load(part), traction(found.stress, part.normal))


BRACKET = named("re-entrant").solution


@pytest.mark.parametrize("point", [(5, 5), (1.5, 1.5), (-1e-6, 0.5), (np.nan, 0.5), (np.inf, 0.5)])
def test_a_point_outside_the_body_is_refused_also_at_a_re_entrant_corner(point):
    with pytest.raises(ValueError, match=r"lies outside the body.*1 of 2 points.*\[0, 2\] × \[0, 2\]"):
        BRACKET.at(np.array([point, (0.5, 0.5)]).T)
    for by in (1e-12, 1e-30j):
        assert np.isfinite(BRACKET.at(BRACKET.body.vertices + by).displacement(0.5)).all(), "rounding and complex steps"


@pytest.mark.parametrize("time", [3, -0.1, 1 + 1e-6, np.nan])
def test_a_time_outside_the_interval_is_refused_alone_and_among_others(time):
    fields = BRACKET.at([[0.5], [0.5]])
    on_face = BRACKET.on(BRACKET.faces[0], [[0.5]])
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
def test_a_wrong_shape_says_which_shape_is_wanted(x, told):
    with pytest.raises(ValueError, match=told):
        BRACKET.at(x)
    with pytest.raises(ValueError, match=told):
        evaluate(BRACKET, x, 0.5)


# Cases with contact at many scales, and rollers, with details of the widths that they state.


def alone(case, j):
    """One train on a body no deeper than its lifting: random points of the unit square would hardly ever meet it."""
    face = case.solution.faces[j]
    assert isinstance(face, StripFace)
    length = face.part.measure
    depth = face.profile.depth
    corners = [(0.0, 0.0), (length, 0.0), (length, depth), (0.0, depth)]
    body = polygon(corners, [CONTACT, LOADED, CLAMPED, LOADED])
    return ExactSolution(body, case.solution.law, (replace(face, part=body.of(CONTACT)[0]),))


@pytest.mark.parametrize(
    ("number", "j"),
    [(0, 6), *(slow(*one) for one in ((0, 0), (1, 3), (1, 0), (0, 3), (1, 6)))],
)
def test_every_train_is_an_exact_solution(number, j):
    assert violated(alone(multiscale()[number], j)) == []


def test_theorems_raise_the_proved_order_only_of_a_rough_trace_and_of_a_junction():
    orders = {case.name: (proved_order(case), case.regularity.proved_order) for case in catalogue()}
    raised = {name: order for name, (order, source) in orders.items() if order > source}
    assert raised == pytest.approx({"rough-trace": 1, "junction": 0.5})
    assert proved_order(CASE) == pytest.approx(0.6)
    assert all(proved_order(case) <= case.order for case in catalogue())


HISTORY = "(2.6)"
"""Of the self-proof: u = u_0 + ∫ u̇ dt by a rule with 256 steps, too few for what passes a point within a time ℓ."""


@pytest.mark.parametrize("level", [8, slow(16), slow(64)])
@pytest.mark.parametrize("kind", [1, *(slow(kind) for kind in (0, 2, 3))])
def test_every_roller_is_an_exact_solution(kind, level):
    case = rollers(level)[kind]
    assert [finding for finding in violated(case.solution) if not finding.condition.startswith(HISTORY)] == []
