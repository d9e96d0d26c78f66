"""What exact solutions are made of: singular fields that rest or travel, layers, coupled strains, regularity."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from costly_cases import by_cost
from entrywise import near
from on_floor import on_floor
from sympy import Rational, cos, expand, sin

from manufactured import (
    Body,
    Case,
    CaseError,
    Factor,
    FormulaError,
    KelvinVoigt,
    Kind,
    Part,
    Regularity,
    SelfProofError,
    cutoff,
    isotropic,
    layered,
    named,
    pos,
    prove,
    s,
    t,
    x1,
    x2,
)
from manufactured.cases.laws import anisotropic, not_proportional
from manufactured.catalogue import NAMES
from manufactured.face_strain import Coupled
from manufactured.face_strain.strain_on_face import relaxation_rate
from manufactured.factor import layers
from manufactured.multiscale import multiscale, rollers
from manufactured.natural_motion import PLACE, natural_motion
from manufactured.proved import proved_order
from manufactured.self_proof import examine
from manufactured.singular import TravellingField
from manufactured.tensors import traction
from study.fem.error_norm import ErrorNorm
from study.fem.mesh import FAMILIES, Shaken
from study.fem.space import Space


def points(seed: int = 0, count: int = 50) -> np.ndarray:
    return np.random.default_rng(seed).uniform(0.05, 0.95, (2, count))


FIELDS = "displacement", "velocity", "strain", "strain_rate"
WITH_FORCES = *FIELDS, "strain_gradient", "stress", "body_force"


OTHERS: dict[str, Callable[[], Case]] = {
    "natural-motion": natural_motion,
    "trains": lambda: multiscale()[0],
    "roller": lambda: rollers(8)[0],
}


VARIABLE_DEPTH = "trains", "roller"


@pytest.mark.parametrize("name", by_cost([*NAMES, "natural-motion", *VARIABLE_DEPTH]))
def test_fields_at_many_times_are_those_at_each(name: str) -> None:
    """At points of which many share their coordinates along a face, as on a mesh; the times come last."""
    case = OTHERS[name]() if name in OTHERS else named(name)
    body = case.solution.body
    grid = np.round(8 * body.sample(np.random.default_rng(3), 200)) / 8 + 1e-3
    fields, times = case.solution.at(grid[:, body.contains(grid)]), body.T * np.array([0.0, 0.31, 0.64, 1.0])
    for of in (getattr(fields, quantity) for quantity in (FIELDS if name in VARIABLE_DEPTH else WITH_FORCES)):
        each, together = np.array([of(float(time)) for time in times]), np.moveaxis(of(times), -1, 0)
        assert near(together, each, rel=1e-12, abs=1e-12 * abs(each).max()), of.__name__


@pytest.mark.parametrize("name", ["junction", "natural-front"])
def test_williams_fields_need_no_force_where_nothing_cuts_them_off(name: str) -> None:
    """Div σ = 0 for the eigenfunctions; the cut-off of the natural front brings forces of its own."""
    solution = named(name).solution
    face = solution.faces[0]
    plain = replace(solution, faces=(replace(face, field=replace(face.field, depth=None)),))
    fields = plain.at(points())
    assert abs(fields.body_force(0.7)).max() < 1e-10 * abs(fields.stress(0.7)).max() / 0.05


def test_the_sides_of_the_re_entrant_corner_are_free_of_traction_near_it() -> None:
    """Where the cut-off is flat: at distances ≪ R."""
    (mode,) = named("re-entrant").solution.others
    r = np.array([1e-6, 1e-5])
    for along, normal in ((np.array([1.0, 0.0]), np.array([0.0, 1.0])), (np.array([0.0, 1.0]), np.array([1.0, 0.0]))):
        fields = mode.at(np.ones((2, 1)) + along[:, None] * r)
        stress = isotropic(1, 1)(fields.strain(1.0))
        assert abs(traction(stress, normal)).max() < 1e-6 * abs(stress).max()


def test_a_law_that_couples_nn_with_sn_needs_a_shear_on_the_face() -> None:
    (face,) = named("anisotropic").solution.faces
    assert isinstance(face.strain, Coupled)
    q, r = face.strain.at(np.linspace(0.1, 0.6, 7)[None])(0.8, False, 0)
    assert abs(r[0,]).max() > 0.05 * abs(q[0,]).max()
    plain = on_floor(not_proportional(), face.gap, face.strain.pressure, face.level)
    with pytest.raises(SelfProofError, match="σ_τ = 0"):
        prove(replace(plain, law=anisotropic()), "without the shear")


def test_the_landing_jumps_in_velocity_but_not_in_load() -> None:
    solution = named("lift-and-land").solution
    space = Space(Shaken()(solution.body, 6), solution.body)
    v_norm = ErrorNorm(solution, space)
    before, after = 0.7 - 1e-9, 0.7 + 1e-9
    fields = solution.at(points())
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


def test_a_body_that_no_family_can_mesh_is_refused_by_name() -> None:
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    kinds = [Kind.CONTACT, Kind.CLAMPED, Kind.LOADED, Kind.LOADED]
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    body = Body(tuple(Part(kind, corners[list(face)].T) for kind, face in zip(kinds, faces, strict=True)))
    assert not any(family.serves(body) for family in FAMILIES)


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


@pytest.mark.parametrize("power", [4, 6, 8])
def test_gap_and_pressure_have_the_exponents_of_the_label_at_the_front(power: int) -> None:
    c, r = float(PLACE.subs(t, 0.5)), 10.0**-power
    for sign, value, exponent in ((1, "gap", 1.5), (-1, "pressure", -0.5)):
        near, nearer = (getattr(CASE.solution.on(FACE, [[c + sign * d]]), value)(0.5)[0] for d in (r, r / 10))
        assert np.log10(near / nearer) == pytest.approx(exponent, abs=1e-3)


def test_forces_and_their_rates_are_square_integrable_at_the_front() -> None:
    """f_0 ~ r^{1/2} and its rate ~ r^{−1/2}: (3.4) as it is printed, while the stress is ~ r^{−1/2} itself."""
    c, angle = float(PLACE.subs(t, 0.5)), 0.7
    sizes = []
    for r in (1e-3, 1e-5):
        fields = CASE.solution.at([[c + r * np.cos(angle)], [r * np.sin(angle)]])
        rate = fields.body_force(0.5 + 1e-30j).imag / 1e-30
        sizes.append([np.linalg.norm(value) for value in (fields.body_force(0.5), rate, fields.stress(0.5))])
    assert np.log10(np.divide(*sizes)) / 2 == pytest.approx([0.5, -0.5, -0.5], abs=0.03)


def test_only_convergence_is_claimed_by_the_source_and_one_half_is_proved() -> None:
    found = CASE.regularity
    assert (found.smoothness, found.rate_smoothness, found.trace) == (1.5, 0.5, 2)
    assert CASE.proposition == "Prop. 5.3"
    assert proved_order(CASE) == 0.5
    assert str(found) == "r^1.5 on Γ3, moving"


def test_a_field_with_a_cut_off_of_the_distance_does_not_travel() -> None:
    field = FACE.field
    assert isinstance(field, TravellingField)
    with pytest.raises(ValueError, match="give `depth`, not `radial`"):
        TravellingField(replace(field.steady, depth=None, radial=cutoff().b), PLACE)
