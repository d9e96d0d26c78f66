"""Controls of the other statements: a mistake in how each is measured, or a check that looks at nothing."""

from __future__ import annotations

from typing import Any

from study.controls import defects, inaccuracies, mistakes
from study.controls.baselines import Listing
from study.controls.control import Control
from study.controls.slips import Slip, blinded, in_experiments_of, instead
from study.solve.signorini import Signorini
from study.statements.admissibility import Admissibility
from study.statements.advancing_front import AdvancingFront
from study.statements.boundary import NaturalConditions
from study.statements.constitutive_law import ElasticityOperator, Projection, Viscosity
from study.statements.constraint import Interpolant, VertexConstraint
from study.statements.error_bounds import ErrorBounds
from study.statements.green import Green
from study.statements.growing_errors import GrowingErrors
from study.statements.hypercircle import Hypercircle
from study.statements.interpolation import InterpolationInV, InterpolationOnContact
from study.statements.korn import Korn, Norms
from study.statements.lipschitz import Lipschitz
from study.statements.norms_in_time import LoadInTime, TractionInTime
from study.statements.parting import Parting
from study.statements.residual import Residual
from study.statements.residual_bound import ResidualBound
from study.statements.resolvent import Resolvent
from study.statements.separation import Separation
from study.statements.shared import eigen
from study.statements.steps_of_the_estimate import StepsOfTheEstimate
from study.statements.superclose import Superclose
from study.statements.uniqueness import OneStress, OneTrajectory
from study.statements.wellposed import BoundedVelocity, Dependence

FULL, MOVING, YIELDING = "full-contact", "advance-recede", "yield-on-a-part"
KORN, NORMS = (Listing(statement, FULL, "one-diagonal", (4, 8, 16)) for statement in (Korn(), Norms()))
GREEN, KINKED = Listing(Green(), FULL, "one-diagonal", (4,)), Listing(Green(), MOVING, "one-diagonal", (4,))
VISCOSITY, ELASTICITY = (Listing(law, FULL, "one-diagonal", (4,)) for law in (Viscosity(), ElasticityOperator()))
PROJECTION = Listing(Projection(), YIELDING, "one-diagonal", (4,))
ADMISSIBLE = Listing(Admissibility(), MOVING, "shaken", (8,))
NATURAL = Listing(NaturalConditions(), MOVING, "shaken", (8, 16, 32))
HYPERCIRCLE = Listing(Hypercircle(), FULL, "shaken", (16,))
MEMBERS, INTERPOLANT = (
    Listing(VertexConstraint(), FULL, "shaken", (5,)),
    Listing(Interpolant(), "no-contact", "shaken", (5,)),
)
BOUNDS = Listing(ErrorBounds(), FULL, "shaken", (6, 12, 24))
IN_V = Listing(InterpolationInV(), MOVING, "one-diagonal", (8, 16, 32))
ON_CONTACT = Listing(InterpolationOnContact(), MOVING, "one-diagonal", (16, 32, 64))
FACES = Listing(InterpolationOnContact(), "hexagon", "unstructured", (16, 32, 64))
CLOSE = Listing(Superclose(), "full-contact", "one-diagonal", (8, 16, 32))
LINEAR, NONLINEAR = (Listing(Lipschitz(), case, "one-diagonal", (8, 16)) for case in (FULL, YIELDING))
RESIDUAL = Listing(Residual(), FULL, "shaken", (6,))
TRAJECTORY, ONE_STRESS = Listing(OneTrajectory(), MOVING, "shaken", (6,)), Listing(OneStress(), MOVING, "shaken", (4,))
VELOCITY = Listing(BoundedVelocity(), MOVING, "shaken", (8, 16))
DEPENDENCE = Listing(Dependence(), MOVING, "unstructured", (6,))
ESTIMATE, FROM_REST = (Listing(StepsOfTheEstimate(), case, "unstructured", (8,)) for case in (MOVING, "lift-and-land"))
APART = Listing(Separation(), FULL, "unstructured", (8,))
MONOTONE = Listing(Resolvent(), FULL, "unstructured", (8,))
LOADS = Listing(LoadInTime(), "lift-and-land", "unstructured", (4, 8))
TRACTION, LOGARITHM = (Listing(TractionInTime(), case, "one-diagonal", (8, 16, 32)) for case in (MOVING, "junction"))
AT_REST = Listing(ResidualBound(), FULL, "unstructured", (8,))
PARTING = Listing(Parting(), "softening", "shaken", (4,))
GROWING = Listing(GrowingErrors(), "softening", "unstructured", (4,))
ADVANCING = Listing(AdvancingFront(), "natural-motion", "unstructured", (6, 12, 24))
"""Every row holds without a defect, and the named row fails with it."""


SUPERCLOSE_LATE = in_experiments_of("superclose", defects.load_one_step_late)


UNWEIGHTED = Slip("study.statements.norms_in_time", "facet_rule", mistakes.unweighted)


def slip(module: str, name: str, by: Any) -> Slip:
    """In a module of ``study.statements``."""
    return Slip(f"study.statements.{module}", name, by)


STATEMENTS: tuple[Control[Any], ...] = (
    Control(
        "f_2 left out",
        "(f_2, v) left out of (2.14)",
        GREEN,
        slip("green", "work_on", mistakes.without_surface_load),
        "fine-rule",
    ),
    Control("blind: Green", "one side of (2.14) beside itself", GREEN, blinded("fine rule"), "fine-rule"),
    Control(
        "f_0 off by a third",
        "⅔ f_0 in (2.14)",
        KINKED,
        slip("green", "work_of_body_force", mistakes.times(2 / 3)),
        "halved",
    ),
    Control(
        "f_0 off by 2 %",
        "0.98 f_0 in (2.14)",
        KINKED,
        slip("green", "work_of_body_force", mistakes.times(0.98)),
        "shrunk",
    ),
    Control("clamped at points", "Γ1 two points", KORN, slip("korn", "space_of", mistakes.pinned), "limit"),
    Control(
        "wrong end",
        "the largest eigenvalue for the smallest",
        KORN,
        slip("korn", "smallest", instead(eigen.largest)),
        "falling",
    ),
    Control(
        "product of L²",
        "(·,·)_H for that of H_1",
        NORMS,
        slip("korn", "h1_product", instead(eigen.mass)),
        "settled-largest",
    ),
    Control("norm doubled", "2 (·,·)_V for (·,·)_V", NORMS, slip("korn", "largest", mistakes.times(2.0)), "upper"),
    Control(
        "sum over vertices",
        "Σ v·w over vertices for (v, w)_H",
        NORMS,
        slip("korn", "h1_product", mistakes.over_vertices),
        "settled-smallest",
    ),
    Control(
        "strains doubled",
        "2ε(u) for ε(u), as ∇u + ∇uᵀ",
        NORMS,
        slip("korn", "strain_product", mistakes.times(2.0)),
        "lower",
    ),
    Control(
        "shear halved",
        "ε_12 for √2 ε_12",
        VISCOSITY,
        slip("constitutive_law", "resolve", mistakes.OtherLaw("A", mistakes.engineering)),
        "ellipticity",
    ),
    Control(
        "A doubled",
        "2A for A",
        VISCOSITY,
        slip("constitutive_law", "resolve", mistakes.OtherLaw("A", mistakes.times(2.0))),
        "bound",
    ),
    Control(
        "G doubled",
        "2G for G",
        ELASTICITY,
        slip("constitutive_law", "resolve", mistakes.OtherLaw("G", mistakes.times(2.0))),
        "lipschitz",
    ),
    Control(
        "sign of G",
        "−G for G",
        ELASTICITY,
        slip("constitutive_law", "resolve", mistakes.OtherLaw("G", mistakes.times(-1.0))),
        "monotonicity",
    ),
    Control(
        "prestress",
        "G(ε) + 1 for G(ε)",
        ELASTICITY,
        slip("constitutive_law", "resolve", mistakes.OtherLaw("G", mistakes.prestressed)),
        "at-zero",
    ),
    Control(
        "half returned",
        "½ G for G of (3.3)",
        PROJECTION,
        slip("constitutive_law", "projection", mistakes.returning(share=0.5)),
        "membership",
    ),
    Control(
        "returned too far",
        "1.5 G for G of (3.3)",
        PROJECTION,
        slip("constitutive_law", "projection", mistakes.returning(share=1.5)),
        "nearest",
    ),
    Control(
        "pushed away",
        "−G for G of (3.3)",
        PROJECTION,
        slip("constitutive_law", "projection", mistakes.returning(share=-1.0)),
        "expansion",
    ),
    Control(
        "yield too early",
        "half the radius of K in (3.3)",
        PROJECTION,
        slip("constitutive_law", "projection", mistakes.returning(radius=0.5)),
        "identity",
    ),
    Control(
        "u_n without contact",
        "V^h for K^h",
        ADMISSIBLE,
        in_experiments_of("admissibility", inaccuracies.unconstrained),
        "membership",
    ),
    Control(
        "u_n held",
        "v_ν = 0 for v_ν ≤ 0",
        ADMISSIBLE,
        in_experiments_of("admissibility", defects.contact_two_sided),
        "displacements",
    ),
    Control(
        "u_n relaxed",
        "v_ν ≤ √h for v_ν ≤ 0",
        ADMISSIBLE,
        in_experiments_of("admissibility", defects.constraint_relaxed),
        "stresses",
    ),
    Control("blind: work", "(σ, ε(u)) beside itself", ADMISSIBLE, blinded("work"), "work"),
    Control("blind: cone", "no distance from the cone", ADMISSIBLE, blinded("distance"), "cone"),
    Control(
        "σ without A u̇",
        "Gε(u^h) for Aε(u̇^h) + Gε(u^h)",
        NATURAL,
        slip("boundary", "on_cells", mistakes.rate_left_out),
        "contact",
    ),
    Control(
        "end of the step",
        "σ half a step late",
        NATURAL,
        slip("boundary", "discrete_stresses", mistakes.at_the_end_of_the_step),
        "loaded-weakly",
    ),
    Control(
        "5 % of the load",
        "1.05 F for F",
        NATURAL,
        in_experiments_of("boundary", inaccuracies.load_slightly_too_large),
        "tangential-weakly",
    ),
    Control(
        "sign of f_2", "σν + f_2 for σν − f_2", NATURAL, slip("boundary", "traction", mistakes.times(-1.0)), "loaded"
    ),
    Control(
        "blind: Prager–Synge",
        "Cε(u^h) for a balanced σ^h",
        HYPERCIRCLE,
        slip("hypercircle", "Pair", mistakes.law_alone),
        "guaranteed",
    ),
    Control("normals inwards", "−ν for ν in N", MEMBERS, slip("constraint", "space_of", mistakes.outward), "members"),
    Control(
        "vertex off Γ3",
        "a constraint inside the body",
        MEMBERS,
        slip("constraint", "space_of", mistakes.one_more),
        "strangers",
    ),
    Control(
        "Π^h u on the other side",
        "−ν for ν in N",
        INTERPOLANT,
        slip("constraint", "space_of", mistakes.outward),
        "smooth",
    ),
    Control("sign of u", "−u for u", INTERPOLANT, slip("constraint", "over_time", mistakes.mirrored), "exact"),
    Control("Γ1 moved", "u + 10⁻⁶ for u", INTERPOLANT, slip("constraint", "over_time", mistakes.moved), "clamped"),
    Control(
        "bounds without contact",
        "V^h for K^h",
        BOUNDS,
        in_experiments_of("error_bounds", inaccuracies.unconstrained),
        "steady-5.21",
    ),
    Control(
        "bounds by springs",
        "a stiff foundation for v_ν ≤ 0",
        BOUNDS,
        in_experiments_of("error_bounds", inaccuracies.contact_by_springs),
        "steady-5.42",
    ),
    Control("blind: (5.21)", "an error of nothing", BOUNDS, blinded("(5.21), c"), "constant-5.21"),
    Control("blind: (5.42)", "an error of nothing", BOUNDS, blinded("(5.42), c"), "constant-5.42"),
    Control(
        "root forgotten",
        "‖·‖_V² for ‖·‖_V",
        IN_V,
        Slip("study.fem.gauge", "Gauge.distance", mistakes.squared),
        "u-0.61",
    ),
    Control(
        "interpolant late",
        "Π^h u(0.9 t) for Π^h u(t)",
        IN_V,
        Slip("study.fem.gauge", "Gauge.sample", mistakes.interpolant_late),
        "u-0.23",
    ),
    Control(
        "root of a smooth field",
        "‖·‖_V² for ‖·‖_V",
        IN_V,
        slip("interpolation", "distance_in_V", mistakes.squared),
        "smooth",
    ),
    Control(
        "area for length",
        "h² for h",
        ON_CONTACT,
        slip("interpolation", "induced_size", mistakes.squared),
        "smooth-face-1",
    ),
    Control(
        "(5.24) as printed",
        "an error of order h",
        ON_CONTACT,
        slip("interpolation", "on_face", mistakes.times_h(-1)),
        "u-0.23-face-1",
    ),
    Control(
        "root on Γ3",
        "‖·‖² for ‖·‖ in L²(Γ3)",
        ON_CONTACT,
        slip("interpolation", "on_face", mistakes.squared_each),
        "u-0.61-face-1",
    ),
    *(
        Control(f"{name}, on face {face}", what, FACES, slip("interpolation", where, by), f"{v}-face-{face}")
        for name, what, where, by, v, face in (
            ("area for length", "h² for h", "induced_size", mistakes.squared, "smooth", 2),
            ("(5.24) as printed", "an error of order h", "on_face", mistakes.times_h(-1), "u-0.23", 2),
            ("root on Γ3", "‖·‖² for ‖·‖ in L²(Γ3)", "on_face", mistakes.squared_each, "u-0.61", 2),
            ("lengths three times more", "h³ ‖·‖ for ‖·‖", "on_face", mistakes.times_h(3), "smooth", 3),
            ("lengths twice", "h ‖·‖ for ‖·‖", "on_face", mistakes.times_h(1), "u-0.23", 3),
            ("an error that stays", "‖·‖/h² for ‖·‖", "on_face", mistakes.times_h(-2), "u-0.61", 3),
        )
    ),
    Control("load late, k ~ h", "the load of the step before", CLOSE, SUPERCLOSE_LATE, "order"),
    Control(
        "few steps, k ~ h",
        "an eighth of the time steps",
        CLOSE,
        in_experiments_of("superclose", inaccuracies.few_steps),
        "time-share",
    ),
    Control(
        "k as it is",
        "as many steps on every mesh",
        CLOSE,
        slip("superclose", "Superclose.steps", mistakes.as_many_steps),
        "share-growth",
    ),
    Control("constant of B doubled", "2B for B", LINEAR, slip("lipschitz", "largest", mistakes.times(2.0)), "constant"),
    Control("κ halved", "½ κ for κ", LINEAR, slip("lipschitz", "pointwise", mistakes.halved_first), "pointwise"),
    Control(
        "sign of d",
        "(Bu − Bv, v − u)_V, not over ‖u − v‖²",
        LINEAR,
        slip("lipschitz", "Operator.compare", mistakes.opposite_work),
        "monotonicity",
    ),
    Control(
        "blind: search", "random pairs alone", NONLINEAR, slip("lipschitz", "quotients", mistakes.random_only), "waves"
    ),
    Control(
        "R without f_2",
        "(f_2, v) left out of R",
        RESIDUAL,
        slip("residual", "terms", mistakes.without("loaded")),
        "smooth",
    ),
    Control(
        "R without f_0",
        "(f_0, v) left out of R",
        RESIDUAL,
        slip("residual", "terms", mistakes.without("body")),
        "bound",
    ),
    Control("blind: remainder", "R beside itself", RESIDUAL, blinded("Π^hu − u"), "remainder"),
    Control(
        "one search",
        "a search that stops at once",
        TRAJECTORY,
        slip("uniqueness", "RandomStarts", instead(mistakes.OneSearch)),
        "random-starts",
    ),
    Control(
        "blind: least squares",
        "the solver beside itself",
        TRAJECTORY,
        slip("uniqueness", "rivals", mistakes.rival_is_the_run("least squares")),
        "least-squares",
    ),
    Control(
        "blind: interior point",
        "the solver beside itself",
        TRAJECTORY,
        slip("uniqueness", "rivals", mistakes.rival_is_the_run("interior point")),
        "interior-point",
    ),
    Control("blind: fixed point", "the same splitting", TRAJECTORY, blinded("fixed point"), "fixed-point"),
    Control(
        "one search for σ",
        "a search that stops at once",
        ONE_STRESS,
        slip("uniqueness", "RIVALS", mistakes.rival("random starts", mistakes.OneSearch)),
        "random-starts",
    ),
    Control(
        "blind: σ by least squares",
        "the solver beside itself",
        ONE_STRESS,
        slip("uniqueness", "RIVALS", mistakes.rival("least squares", Signorini)),
        "least-squares",
    ),
    Control(
        "blind: σ by interior point",
        "the solver beside itself",
        ONE_STRESS,
        slip("uniqueness", "RIVALS", mistakes.rival("interior point", Signorini)),
        "interior-point",
    ),
    Control(
        "start outside K",
        "u_0^h ∉ K^h",
        VELOCITY,
        in_experiments_of("wellposed", inaccuracies.start_outside),
        "bounded",
    ),
    Control(
        "velocity of two steps",
        "(u_n − u_{n−1})/2k for δu_n",
        VELOCITY,
        slip("wellposed", "fastest", mistakes.times(0.8)),
        "limit",
    ),
    Control(
        "quotients of squares",
        "half the change of the data",
        DEPENDENCE,
        slip("wellposed", "quotients", mistakes.times(2.0)),
        "monotone",
    ),
    Control(
        "ω left out", "growth that no law has", DEPENDENCE, slip("wellposed", "quotients", mistakes.times(1.5)), "bound"
    ),
    Control("blind: dependence", "a solution beside itself", DEPENDENCE, blinded("first step"), "first-step"),
    *(
        Control(f"{name}: ({key})", what, where, in_experiments_of("steps_of_the_estimate", defect), key)
        for name, what, where, defect, key in (
            ("contact held", "v_ν = 0 for v_ν ≤ 0", ESTIMATE, defects.contact_two_sided, "5.12"),
            (
                "multipliers",
                "1.2 λ beside the right u^h",
                ESTIMATE,
                defects.multipliers_a_fifth_too_large,
                "slack-5.12",
            ),
            ("load late", "the load of the step before", FROM_REST, defects.load_one_step_late, "5.14"),
            ("no contact", "V^h for K^h", FROM_REST, defects.contact_dropped, "5.16"),
            ("no work of contact", "its wrong sign in f", FROM_REST, defects.contact_work_sign_flipped, "5.19"),
        )
    ),
    Control(
        "0.9 Π^h u̇",
        "0.9 Π^h u̇ for Π^h u̇",
        ESTIMATE,
        slip("steps_of_the_estimate", "Energies.interpolated_rate", mistakes.times(0.9)),
        "5.15",
    ),
    Control(
        "no interpolant",
        "0 for Π^h u, but for its velocity",
        FROM_REST,
        slip("steps_of_the_estimate", "Energies.interpolant", mistakes.times(0.0)),
        "5.18",
    ),
    Control(
        "cut off", "v_ν cut off at vertices for P", APART, slip("separation", "projected", mistakes.cut_off), "cone"
    ),
    Control(
        "2A in τ̃",
        "2A ε(Pu − u) for A ε(Pu − u)",
        APART,
        slip("separation", "Separated.separating", mistakes.times(2.0)),
        "gap",
    ),
    Control(
        "reflected twice",
        "σ̃ − 2σ for 2σ − σ̃",
        APART,
        slip("separation", "reflected", mistakes.times(-1.0)),
        "stresses",
    ),
    Control("not reflected", "σ for 2σ − σ̃", APART, slip("separation", "reflected", mistakes.first_given), "refuted"),
    Control(
        "foundation pulls", "μ ≤ 0 in Nᵀμ", MONOTONE, slip("resolvent", "in_graph", mistakes.pulled), "normal-cone"
    ),
    Control(
        "2B",
        "2B for B",
        MONOTONE,
        Slip("study.solve.evolution", "SemiDiscrete.elastic", mistakes.times(2.0)),
        "monotone",
    ),
    Control(
        "J shrinks", "½ J for J", MONOTONE, slip("resolvent", "Inverse.__call__", mistakes.times(0.5)), "resolvent"
    ),
    Control("one image", "J w after one step", MONOTONE, slip("resolvent", "fixed_point", mistakes.one_image), "onto"),
    Control(
        "J expands",
        "3/2 J for J",
        MONOTONE,
        slip("resolvent", "Inverse.__call__", mistakes.times(1.5)),
        "resolvent-monotone",
    ),
    Control(
        "squares add up",
        "‖f(t_i) − f(t_{i−1})‖² for its root",
        LOADS,
        slip("norms_in_time", "dual_norm", mistakes.squared),
        "variation",
    ),
    Control(
        "load with a jump",
        "the work of contact with the wrong sign in f",
        LOADS,
        slip("norms_in_time", "Gauge", instead(defects.FlippedWork)),
        "increments",
    ),
    Control(
        "vector for functional",
        "|F| for ‖M⁻¹F‖_V",
        LOADS,
        slip("norms_in_time", "Cholesky", instead(mistakes.NoRepresenter)),
        "uniform",
    ),
    *(
        Control(f"no lengths: {key}", "sums over points for integrals on Γ", where, UNWEIGHTED, key)
        for where, key in ((TRACTION, "bounded"), (LOGARITHM, "unbounded"))
    ),
    Control(
        "σ four times in R",
        "4σ for σ in R",
        AT_REST,
        slip("residual_bound", "Energies.functional", mistakes.times(4.0)),
        "bound",
    ),
    Control("other sign of z", "−A ε(z)", AT_REST, slip("residual_bound", "prestress", mistakes.times(-1.0)), "rest"),
    *(
        Control(f"{factor:g} ‖R‖", f"{factor:g} ‖R‖ for ‖R‖", AT_REST, slip("residual_bound", "dual_norm", wrong), key)
        for factor, wrong, key in ((1.2, mistakes.times(1.2), "prestress"), (0.5, mistakes.times(0.5), "attained"))
    ),
    Control(
        "softening by a tenth",
        "1.1 G'(0) for G'(0), in the eigenvalue alone",
        PARTING,
        slip("parting", "derivative", mistakes.times(1.1)),
        "rate",
    ),
    Control(
        "backward Euler for midpoint",
        "growth by 1/(1 − z) for e^z",
        PARTING,
        slip("parting", "MIDPOINT", mistakes.by_backward_euler),
        "rate-even",
    ),
    Control(
        "growth a tenth too fast",
        "1.1 ‖u − v‖ for ‖u − v‖",
        PARTING,
        slip("parting", "quotients", mistakes.times(1.1)),
        "bound",
    ),
    Control(
        "growth a tenth too slow",
        "0.9 ‖u − v‖ for ‖u − v‖",
        PARTING,
        slip("parting", "quotients", mistakes.times(0.9)),
        "bound-even",
    ),
    Control(
        "f off by a tenth at a front",
        "0.9 f for f",
        ADVANCING,
        slip("advancing_front", "load_from_forces", mistakes.times(0.9)),
        "order",
    ),
    Control(
        "squares of velocities",
        "‖u̇ − Π^h u̇‖² for its root",
        ADVANCING,
        slip("advancing_front", "Velocity.interpolation_error", mistakes.squared),
        "rate",
    ),
    Control(
        "traction off by a tenth",
        "0.9 σ_ν for σ_ν in the linear problem",
        ADVANCING,
        slip("advancing_front", "Traction.__call__", mistakes.times(0.9)),
        "excess",
    ),
    Control(
        "blind: steps at a front",
        "one trajectory beside itself",
        ADVANCING,
        blinded("time share"),
        "time",
    ),
    Control(
        "blind: a rule beside itself",
        "the finer rule for f_0 is no finer",
        ADVANCING,
        slip("advancing_front", "RAISED", instead(2)),
        "quadrature",
    ),
    Control(
        "P_h off by a tenth",
        "1.1 P_h u for P_h u",
        GROWING,
        slip("growing_errors", "projection", mistakes.times(1.1)),
        "known",
    ),
    Control(
        "start without an error in V^h",
        "u_0^h = P_h u_0 for Π^h u_0",
        GROWING,
        in_experiments_of("growing_errors", defects.start_at_projection),
        "needed",
    ),
    *(
        Control(
            f"ten times the error: {key}", f"10 {error} for {error}", GROWING, slip(*where, mistakes.times(10.0)), key
        )
        for key, error, where in (
            ("bound", "‖u − u^h‖", ("growing_errors", "share")),
            ("time", "‖u^h − û^{hk}‖", ("growing_errors", "furthest")),
        )
    ),
)
