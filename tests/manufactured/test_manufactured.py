"""The continuous problem: contact data, initial gaps, labels and the self-proof of every case."""

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from bodies import LAW
from costly_cases import by_cost, slow
from hypothesis import given
from hypothesis import strategies as st
from on_floor import on_floor
from random_examples import COSTLY
from sympy import Abs, Heaviside, Integer, Rational, Symbol, floor, log, sin, sqrt, tan, tanh

from manufactured import (
    PARABOLA,
    Case,
    CaseError,
    FormulaError,
    FrobeniusBall,
    KelvinVoigt,
    LawError,
    Memory,
    Prescribed,
    Regularity,
    SelfProofError,
    Yield,
    cutoff,
    examine,
    isotropic,
    layered,
    named,
    pos,
    prove,
    s,
    t,
)
from manufactured.catalogue import NAMES
from manufactured.exact import FaceFields, Fields
from manufactured.self_proof import DEFECT_ROUND_OFF, Finding, worst


@pytest.mark.parametrize("name", by_cost(NAMES))
@pytest.mark.parametrize("seed", [0, slow(1)])
def test_every_case_satisfies_the_problem_to_round_off(name, seed):
    findings = examine(named(name).solution, seed)
    assert all(finding.passes for finding in findings), "\n".join(map(str, findings))
    assert max(finding.defect for finding in findings if finding.tolerance == DEFECT_ROUND_OFF) < 1e-10


def with_face(name="advance-recede", **changes):
    """The solution of a case with other contact data."""
    solution = named(name).solution
    (face,) = solution.faces
    return replace(solution, faces=(replace(face, **changes),))


def slipping(stress):
    """The strain of advance-recede with an additional stress from slip."""
    return Memory(PRESSURE, 3, 3, 1.0, slip_stress=stress)


SLIP = t * (1 + t) * sin(2 * s + 1)
C = Rational(1, 4) + 2 * t * (1 - t)
SHIFT = Rational(1, 50)
EARLY = Rational(3, 10)
GAP = 20 * pos(s - C, 4)
PRESSURE = 20 * pos(C - s, 2)
"""Gap and pressure of advance-recede, whose front is C."""
HALF = Rational(1, 2)


@pytest.mark.parametrize(
    ("changes", "condition"),
    [
        ({"gap": -GAP}, "u_ν ≤ g"),
        ({"gap": 20 * pos(s - C + Rational(1, 100), 4)}, "w = 0, so σ_ν w = 0, on the stated zone"),
        ({"gap": 20 * pos(s - C + SHIFT, 4), "level": C - s - SHIFT}, "p = 0, so σ_ν w = 0, off the stated zone"),
        ({"gap": GAP * (1 + pos(s - Rational(9, 10), 0))}, "w without jumps"),
        ({"strain": Memory(PRESSURE * (1 - 2500 * pos(t * (EARLY - t), 2)), 3, 3, 1.0)}, "σ_ν ≤ 0"),
        ({"strain": Memory(PRESSURE, 2.5, 7, 1.0)}, "p = −σ_ν"),
        ({"profile": cutoff(2.0)}, r"\(2.3\)"),
        # A slip z needs the stress A_nnss ∂_s ż + G_nnss ∂_s z, here ∂_s ż + ∂_s z, and must be continuous.
        ({"slip": (SLIP,), "strain": slipping(SLIP.diff(s, t))}, "p = −σ_ν"),
        ({"slip": (pos(s - HALF, 0),)}, "z_1 without jumps"),
        # Under a receding front a prescribed strain would pull. Therefore the pressure is prescribed.
        ({"strain": Prescribed(((1.0, -PRESSURE),))}, "σ_ν ≤ 0"),
    ],
)
def test_data_that_violate_a_condition_are_refused_by_name_place_and_size(changes, condition):
    with pytest.raises(SelfProofError, match=condition) as refusal:
        prove(with_face(**changes), "faulty")
    assert "relative defect" in str(refusal.value)
    assert "t = " in str(refusal.value)


def test_a_strain_that_jumps_and_jumps_back_is_refused():
    phases = ((0.3, -t), (0.6, -t - HALF), (1.0, -t))
    with pytest.raises(SelfProofError, match="∫u̇"):
        prove(with_face("full-contact", strain=Prescribed(phases)), "jumps")


@pytest.mark.parametrize(
    ("name", "label"),
    [
        # These labels promise more than the formulas.
        ("re-entrant", Regularity(gap=4, pressure=2, moving=True)),
        ("junction", Regularity(on_contact=1.0)),
        ("layered-unmet", Regularity()),
        # These labels promise less, so that a case of Prop. 5.4 could escape its rows and speak of (5.36).
        ("full-contact", Regularity(on_contact=1.5)),
        ("advance-recede", Regularity(gap=4, pressure=2, moving=True, corner=1.5)),
        ("natural-front", Regularity(on_contact=1.25)),
        ("rough-1.75", Regularity(gap=1.75, pressure=0.75, kink=True)),
    ],
)
def test_a_label_that_promises_more_or_less_than_the_formulas_is_refused(name, label):
    with pytest.raises(CaseError) as refusal:
        replace(named(name), regularity=label, order=label.order)
    correct = named(name).regularity
    assert f"labelled {label}, but its formulas say {correct}; correct the label to Regularity(" in str(refusal.value)


def labelled(gap, label, pressure=0, **initial):
    """A case with these formulas on the floor of the unit square; it need not prove itself."""
    law = KelvinVoigt(isotropic(1, 0.5), isotropic(0.5, 0), "linear, g = 1")
    return Case("mine", "", on_floor(law, gap, pressure, **initial), label, label.order, "the exponents")


eighths = st.integers(13, 40).map(lambda n: Rational(n, 8))


@COSTLY
@given(eighths, eighths, eighths, st.booleans())
def test_exactly_the_exponents_in_the_formulas_are_accepted_as_a_label(alpha, m, other, moving):
    c = Rational(1, 3) + (t / 4 if moving else 0)
    m = m if not moving else Integer(int(m) + 1)  # whose memory is known in closed form
    gap = (1 + t) * pos(s - c, alpha) / (1 + s)
    pressure = (1 + s) * pos(c - s, m)
    right = Regularity(float(alpha), float(m), moving)
    assert labelled(gap, right, pressure).regularity == right
    wrong = [replace(right, gap=float(other)), replace(right, pressure=float(other)), replace(right, moving=not moving)]
    for label in wrong:
        if label != right:
            with pytest.raises(CaseError, match=rf"α = {float(alpha):g}, m = {float(m):g}; correct the label"):
                labelled(gap, label, pressure)


FRONT = s - HALF


@pytest.mark.parametrize(
    ("gap", "alpha"),
    {
        pos(FRONT, 2) * pos(FRONT, Rational(5, 4)): 3.25,
        sqrt(pos(FRONT, 5)): 2.5,
        (1 + pos(FRONT, 3)) ** (3 * HALF): 3,
        pos(FRONT, 4) + pos(s - HALF / 2, 3): 3,
        pos(t * FRONT, 3): 3,
        pos(s, 2): np.inf,
        pos(1 + s, 5 * HALF): np.inf,
        pos(s, 5 * HALF): 2.5,
    }.items(),
)
def test_the_exponent_is_that_of_the_least_smooth_front_on_the_face(gap, alpha):
    """Of products their sum; a front beyond the face, or a natural power at an end of it, is none."""
    right = Regularity(gap=alpha)
    assert labelled(gap, right).regularity == right
    with pytest.raises(CaseError, match="correct the label"):
        labelled(gap, Regularity(gap=1.75))


def test_a_front_that_stays_and_is_rougher_than_a_moving_one_has_no_label():
    """(2.75, moving) would say u̇ ∈ H^{1+s} for s < 1/4 only, but u̇ ∈ H²."""
    gap = pos(s - HALF - t / 4, 4) + pos(s - HALF, Rational(11, 4))
    with pytest.raises(CaseError, match=r"stays with α = 2\.75 beside moving ones with α = 4.*one label cannot"):
        labelled(gap, Regularity(gap=2.75, moving=True))


@pytest.mark.parametrize(
    ("formula", "part"),
    {
        t * s ** Rational(7, 4): r"s\*\*\(7/4\)",
        (s + t) ** (5 * HALF): r"\(s \+ t\)\*\*\(5/2\)",
        ((s - Rational(3, 10)) ** 2 + (t - HALF) ** 2) ** (3 * HALF): r"\*\*\(3/2\)",
        1 + s**2 * log(s): r"log\(s\)",
        s**s: r"s\*\*s",
        pos(sqrt(s) - HALF, 4): r"sqrt\(s\)",
        pos(HALF - 1 / s, 4): "1/s",
        (t * pos(FRONT, 3) + (s - HALF) ** 2) ** (5 * HALF): r"\*\*\(5/2\)",
        floor(3 * s): r"floor\(3\*s\)",
        tan(2 * s): r"tan\(2\*s\)",
    }.items(),
)
def test_a_part_that_is_rough_on_the_face_and_no_truncated_power_is_refused(formula, part):
    """A label is compared with the exponents of pos(x, a), so nothing else may be rough, in gap or pressure."""
    with pytest.raises(CaseError, match=rf"{part} in .*not known to be smooth.*write .* as pos\(x, a\)"):
        labelled(formula, Regularity())


@pytest.mark.parametrize(
    "formula",
    [
        sqrt(1 + s * t),
        log(2 - s) * (s - HALF) ** 2,
        1 / (Rational(1, 4) + (s - t) ** 2),
        2**s,
        s**2.0,
        sin(20 * s) + tanh(s - HALF),
        (t + 1) ** (3 * HALF) + t ** (3 * HALF),
    ],
)
def test_powers_and_logarithms_that_are_smooth_on_the_face_are_accepted(formula):
    assert labelled(formula, Regularity()).proposition == "Prop. 5.4"


def with_gap(g, name="parabolic-gap"):
    return replace(named(name), solution=with_face(name, initial_gap=g))


NATURAL = r"natural-front of the catalogue.*SingularFace.*on_contact=1\.5"
NONLINEAR = KelvinVoigt(isotropic(1, 1), Yield(1.0, FrobeniusBall(1)), "(3.3)")


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: with_face(profile=cutoff(0.5, PARABOLA)), ValueError, "kink"),
        (
            lambda: replace(named("advance-recede").solution, faces=()),
            ValueError,
            "expected 1 contact faces, one for each part Γ3 of the body .*, got 0 contact faces",
        ),
        (lambda: on_floor(NONLINEAR, 0, 1), LawError, "prescribe the strain"),
        (lambda: with_face(gap=Symbol("x") * t), FormulaError, "has x"),
        (lambda: with_face(gap=Symbol("s") * t), FormulaError, "has s"),
        (lambda: with_face(gap=Heaviside(s - t)), FormulaError, "pos"),
        (lambda: with_face(gap=abs(s)), FormulaError, "pos"),
        (lambda: with_gap(s * t), FormulaError, "depends on t"),
        (lambda: with_gap(s - Rational(1, 3)), FormulaError, r"is -0\.3333 at s = 0, where .* penetrate"),
        (lambda: with_gap(pos(s - HALF, 1)), CaseError, "a front that stays with α = 1"),
        (lambda: with_gap(pos(s - HALF, Rational(9, 4))), CaseError, r"a front that stays with α = 2\.25"),
        (lambda: with_gap(sqrt(s)), CaseError, "not known to be smooth"),
        (lambda: labelled(Integer(0), Regularity(), 1 + s**s), CaseError, r"s\*\*s in .*not known to be smooth"),
        (lambda: on_floor(LAW, 0, 3 + s, slip=(s, s)), FormulaError, "has 2 components"),
        (lambda: on_floor(LAW, 0, 3 + s, slip=(Abs(s),)), FormulaError, "write fronts with pos"),
        (lambda: layered(1.0, 2.0, 1.0), ValueError, "to increase"),
        (lambda: Regularity(corner=0.0), ValueError, "λ > 0"),
        (lambda: Regularity(gap=1.5), ValueError, "α > 3/2"),
        *((partial(Regularity, gap=gap, pressure=0.5), ValueError, NATURAL) for gap in (2, 1.5)),
    ],
)
def test_contact_data_initial_gaps_and_exponents_that_define_no_solution_are_refused(make, error, message):
    with pytest.raises(error, match=message):
        make()


@pytest.mark.parametrize(
    ("stated", "message"),
    [
        ({"order": 0.5}, "got order=0.5, reason=''; derive"),
        ({"reason": "s < 1/2"}, "got order=None, reason='s < 1/2'; derive"),
        ({"order": 1.0, "reason": "s < 1/2"}, r"gives min\(1, s\) = 0.25"),
    ],
)
def test_a_case_needs_a_predicted_order_that_its_exponents_give_and_a_reason(stated, message):
    rough = named("rough-1.75")
    with pytest.raises(CaseError, match=message):
        Case("mine", "", rough.solution, rough.regularity, **stated)


def test_a_gap_that_is_open_where_contact_meets_the_clamp_is_no_solution():
    """u = 0 on Γ1, so g = w where Γ3 ends at Γ1."""
    with pytest.raises(SelfProofError, match=r"\(2\.3\)"):
        prove(with_gap(Rational(1, 10) + s, "contact-at-clamp").solution, "open")
    prove(with_gap(s**2, "contact-at-clamp").solution, "closed")


# Every condition of the self-proof can fail, and what is not a number fails it.


PATCH = named("travelling-patch").solution


def off_by_a_millionth(values):
    return (1 + 1e-6) * values


def no_number_at_one_point(values):
    damaged = np.array(values)
    damaged[..., 0] = math.nan
    return damaged


@pytest.mark.parametrize("damaged", [off_by_a_millionth, no_number_at_one_point])
@pytest.mark.parametrize(
    ("where", "name", "condition"),
    [
        (Fields, "body_force", r"(2.2) Div σ + f_0 = 0"),
        (Fields, "surface_load", r"(2.4) σν = f_2"),
        (Fields, "stress", r"(2.1) σ = Aε(u̇) + Gε(u)"),
        (Fields, "strain", r"(2.10) ε(u) = sym ∇u"),
        (Fields, "strain_rate", r"(2.10) ε(u̇) = sym ∇u̇"),
        (Fields, "velocity", r"(2.6) u̇ = ∂u/∂t"),
        (FaceFields, "gap", r"(2.5) w = g − u_ν"),
        (FaceFields, "stated_pressure", r"(2.5) p = −σ_ν"),
    ],
)
def test_a_damaged_field_violates_its_condition(monkeypatch, where, name, condition, damaged):
    right = getattr(where, name)
    monkeypatch.setattr(where, name, lambda *given, **options: damaged(right(*given, **options)))
    with pytest.raises(SelfProofError) as refusal:
        prove(PATCH, "a case")
    assert any(condition in finding.condition for finding in refusal.value.findings)


@pytest.mark.parametrize("defect", [math.nan, math.inf])
def test_what_is_no_number_passes_nothing(defect):
    assert not Finding("(2.2)", defect, 1e-9, (0.0,), 0.0).passes
    x = np.zeros((2, 2))
    time = np.zeros(1)
    for value, scale in ((defect, 1.0), (1e-8, defect)):
        assert not worst("(2.2)", x, time, np.array([[0.0, value]]), np.array([[scale, 1.0]])).passes
