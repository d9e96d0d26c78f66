# ruff: noqa: E501, one line for each defect
"""All deliberate defects, in one table: each must make a named check of the study fail.

Each line of the table has the name and the description of a defect, the case and mesh on which it is measured, the part
of the study that is replaced (``Control.place``), the function of ``study.controls.replacements`` that returns the
wrong part, and the key of the check that must fail.

The second half of the table tests diagnostics, which are numbers that show how accurate a computation is. Suppose that
a residual ignores the sign of the contact forces, or that a maximum over time skips every second time. Such a
diagnostic is too small, and no tolerance window for a correct computation can reveal this. So the computation is made
inaccurate in one respect, for example at one time node. If the diagnostic ignores this node, its check holds, and the
defect is reported as not noticed.
"""

from typing import Any

from manufactured.data import no_fronts
from study.bound.trajectory import Refined, SmoothedInTime
from study.controls import replacements as wrong
from study.controls.baselines import Bounding, ContactSweep, Equivalence, Listing, StressSweep, Sweep, Twins, TwoWays
from study.controls.control import Control, within
from study.controls.small_defects import by_amount
from study.solve.interior_point import Accuracy
from study.solve.signorini import Signorini
from study.solve.tableau import BACKWARD_EULER
from study.statements import STATEMENTS
from study.statements.enclosure import BoundedError, EnclosedError, by_midpoint
from study.statements.shared import eigen
from study.statements.shared.base import ListedNumbers
from study.statements.thm_4_2 import Gaps

# Settings: cases and meshes on which defects are measured. Each is as small as possible. Without a defect all checks hold
# there, and with a defect the check fails that must notice it.

FULL, TURNED = Sweep("full-contact", levels=(4, 8, 16)), Sweep("full-contact", angle=0.3, levels=(4, 8, 16))
NONE, FIXED = Sweep("no-contact"), Sweep("fixed-front-off-vertex")
MOVING, MERGING = Sweep("advance-recede"), Sweep("merging-patches")
INITIAL_GAP = Sweep("parabolic-gap")
CROSSED, ROUGH = Sweep("advance-recede", families=("criss-cross",)), Sweep("rough-2", levels=(4, 8, 16, 32))
SOLID = Sweep("cube-two-faces", levels=(6, 9, 12))
CORNERED = Sweep("re-entrant", families=("unstructured", "graded"), levels=(8, 16, 32, 64))
PRESSED, PATCH = ContactSweep("full-contact"), ContactSweep("travelling-patch")
CROSSED_PATCH = ContactSweep("travelling-patch", "criss-cross")
BOTH, OWN = Equivalence("advance-recede"), StressSweep("natural-front")
OWN_MERGING = StressSweep("merging-patches", levels=(16, 32))
ROTATED, AGAIN = Twins("rotated", (8, 16)), TwoWays("advance-recede", 8)
BOUND = Bounding(BoundedError(), tuple(by_midpoint("advance-recede", "one-diagonal", (4,), SmoothedInTime())))
ENCLOSURE = Bounding(EnclosedError(), tuple(by_midpoint("advance-recede", "one-diagonal", (4,), Refined(0, 2))))


def on(statement: str, case: str, family: str, *levels: int) -> Listing:
    """Return the setting in which a statement is measured on some meshes.

    Args:
        statement: name of the class of the statement.
        case, family: names of the case and of the mesh family.
        levels: numbers of cells along a side, coarse to fine.
    """
    (listed,) = (one for one in STATEMENTS if type(one).__name__ == statement)
    assert isinstance(listed, ListedNumbers), statement
    return Listing(listed, case, family, levels)


KORN, NORMS = (on(statement, "full-contact", "one-diagonal", 4, 8, 16) for statement in ("Korn", "Norms"))
GREEN, KINKED = (on("Green", case, "one-diagonal", 4) for case in ("full-contact", "advance-recede"))
VISCOSITY, ELASTICITY = (on(law, "full-contact", "one-diagonal", 4) for law in ("Viscosity", "ElasticityOperator"))
PROJECTION = on("Projection", "yield-on-a-part", "one-diagonal", 4)
ADMISSIBLE = on("Admissibility", "advance-recede", "shaken", 8)
NATURAL = on("NaturalConditions", "advance-recede", "shaken", 8, 16, 32)
HYPERCIRCLE = on("Hypercircle", "full-contact", "shaken", 16)
MEMBERS, INTERPOLANT = on("VertexConstraint", "full-contact", "shaken", 5), on("Interpolant", "no-contact", "shaken", 5)
BOUNDS = on("ErrorBounds", "full-contact", "shaken", 6, 12, 24)
IN_V = on("InterpolationInV", "advance-recede", "one-diagonal", 8, 16, 32)
ON_CONTACT = on("InterpolationOnContact", "advance-recede", "one-diagonal", 16, 32, 64)
FACES = on("InterpolationOnContact", "hexagon", "unstructured", 16, 32, 64)
CLOSE = on("Superclose", "full-contact", "one-diagonal", 8, 16, 32)
LINEAR, NONLINEAR = (on("Lipschitz", case, "one-diagonal", 8, 16) for case in ("full-contact", "yield-on-a-part"))
RESIDUAL = on("Residual", "full-contact", "shaken", 6)
TRAJECTORY = on("OneTrajectory", "advance-recede", "shaken", 6)
ONE_STRESS = on("OneStress", "advance-recede", "shaken", 4)
VELOCITY = on("BoundedVelocity", "advance-recede", "shaken", 8, 16)
DEPENDENCE = on("Dependence", "advance-recede", "unstructured", 6)
ESTIMATE, FROM_REST = (
    on("StepsOfTheEstimate", case, "unstructured", 8) for case in ("advance-recede", "lift-and-land")
)
SEPARATION = on("Separation", "full-contact", "unstructured", 8)
MONOTONE = on("Resolvent", "full-contact", "unstructured", 8)
LOADS = on("LoadInTime", "lift-and-land", "unstructured", 4, 8)
TRACTION, LOGARITHM = (on("TractionInTime", case, "one-diagonal", 8, 16, 32) for case in ("advance-recede", "junction"))
AT_REST = on("ResidualBound", "full-contact", "unstructured", 8)
DIVERGENCE = on("SolutionDivergence", "softening", "shaken", 4)
GROWING = on("GrowingErrors", "softening", "unstructured", 4)
ADVANCING = on("AdvancingFront", "natural-motion", "unstructured", 6, 12, 24)
NO_POTENTIAL = on("NoPotential", "no-potential", "one-diagonal", 6, 8, 10)
NODAL_START = on("NodalStart", "full-contact", "one-diagonal", 8, 16, 32)

# Names of parts of the study that several defects replace, and keys of checks that several defects must make fail.

SOLVER, LOAD, START, DISTANCE = "problem.solver", "problem.load", "problem.u0", "v_norm.distance"
MEASURE, OWN_ERRORS = "statements.prop_5_4:Measurement", "statements.thm_4_2_own_space"
PLAIN, KNOWN_ERROR = "statements.recomputed_solver:PlainProblem", "statements.enclosure:known_error"
DISCRETE_ORDER = "discrete-order-superclose"
SAME_DISPLACEMENT, SAME_FORCES = "displacement-same-load", "multipliers-same-load"
NODES, MIDDLE = ("first", "odd", "even", "last"), ("odd", "even")
"""Time nodes at which the solution is made wrong. A diagnostic that skips the first or last node, or every second node,
misses one of these defects."""


def zero(right: Any) -> Any:
    """Deliberate defect: a number or an array, such as the initial displacement, is replaced by 0."""
    return 0 * right


def negative(right: Any) -> Any:
    """Deliberate defect: a number, an array or a matrix is multiplied by −1."""
    return -right


# fmt: off
CONTROLS: tuple[Control, ...] = (
    # Convergence (Propositions 5.3 and 5.4): defects of a computed solution, or of the measurement of its error.
    Control("contact dropped", "V^h instead of K^h", FULL, "problem", wrong.no_contact, "order"),
    Control("contact two-sided", "v_ν = 0 instead of v_ν ≤ 0", NONE, SOLVER, wrong.held, "order"),
    Control("contact relaxed", "v_ν ≤ √h instead of v_ν ≤ 0", FULL, "", wrong.constraint_relaxed, "order"),
    Control("contact work", "the work of contact has the wrong sign in the load (3.7)", MOVING, "", wrong.contact_work_times(-1.0), "order"),
    Control("normal flipped", "v_ν ≥ 0 instead of v_ν ≤ 0", MOVING, "problem.N", negative, "order"),
    Control("initial gap flipped", "v_ν ≤ −g instead of v_ν ≤ g", INITIAL_GAP, "problem.gap", negative,
            ("order", "order-extrapolated", "size", "discrete-order-superclose", "discrete-share")),
    Control("initial gap left out", "v_ν ≤ 0 instead of v_ν ≤ g", INITIAL_GAP, "problem.gap", zero, ("order", "order-extrapolated")),
    Control("normal along an axis", "the axis nearest to ν instead of ν", TURNED, "problem.N", wrong.nearest_axis, "order"),
    Control("one active set", "the contact solve stops after one iteration", MOVING, SOLVER, wrong.one_iteration, "residual"),
    Control("clamp short", "Γ1 ends one cell too early", FULL, "", wrong.clamp_one_cell_short, "clamped"),
    Control("viscosity dropped", "G(u) = F without A u̇", NONE, "scheme.march", wrong.no_viscosity, "order"),
    Control("elasticity dropped", "A u̇ = F without G(u)", NONE, "scheme.march", wrong.no_elasticity, "order"),
    Control("law swapped", "G u̇ + A u = F", NONE, "scheme.march", wrong.swapped, "order"),
    Control("load late", "the load of the previous time step", MOVING, "", wrong.load_late, DISCRETE_ORDER),
    Control("start at zero", "u_0^h = 0 instead of Π^h u_0", NONE, START, zero, "order"),
    Control("k like h", "backward Euler with time steps k ~ h, which are too long", MOVING, "", wrong.k_like_h, "time-share"),
    Control("norm of H¹", "(‖v‖² + ‖ε(v)‖²)^½ instead of ‖v‖_V", FIXED, "", wrong.norm_of_h1, "leading-term"),
    Control("norm of L²", "‖v‖ instead of ‖v‖_V", FIXED, "", wrong.norm_of_l2, "order"),
    Control("norm with G", "(G ε(v), ε(v))^½ instead of ‖v‖_V", FIXED, "", wrong.norm_with_elasticity, "leading-term"),
    Control("one-point quadrature", "the error is evaluated at the centres of cells only", FIXED, "", wrong.one_point_quadrature, "leading-term"),
    Control("sum of roots", "Σ_T ‖·‖_T instead of (Σ_T ‖·‖_T²)^½", FIXED, "", wrong.sum_of_roots, "order"),
    Control("final time only", "errors sampled at t = T only", MERGING, "scheme.march", wrong.last_state, "leading-term"),
    Control("baseline judged", "‖u − Π^h u‖_V instead of ‖u − u^h‖_V", FIXED, DISTANCE,
            lambda right: lambda sample, v: right(sample, sample.interpolant), "parallelogram"),
    Control("contact by springs", "a stiff foundation instead of v_ν ≤ 0", FULL, SOLVER, wrong.springs, "discrete-share"),
    Control("one time behind", "u^h(t − k) instead of u^h(t)", MOVING, "scheme.march", wrong.one_behind, "size"),
    Control("start at the end", "u_0^h = Π^h u(T) instead of Π^h u_0", NONE, "", wrong.start_at_the_end, "start-share"),
    Control("size of a mesh", "1/(n − 2) instead of 1/n", FULL, "space.h", lambda h: h / (1 - 2 * h), "order"),
    Control("few steps", "an eighth of the number of time steps", MOVING, "steps", wrong.an_eighth, "discrete-time-share"),
    Control("load too large", "1.1 F instead of F", CROSSED, LOAD, wrong.times(1.1), "discrete-order-others"),
    Control("energy for norm", "½‖·‖_V² instead of ‖·‖_V", NONE, DISTANCE, wrong.energy, "leading-term"),
    Control("rough: elasticity dropped", "A u̇ = F without G(u)", ROUGH, "scheme.march", wrong.no_elasticity, "falling"),
    Control("rough: start at the end", "u_0^h = Π^h u(T) instead of Π^h u_0", ROUGH, "", wrong.start_at_the_end, "falling"),
    Control("rough: law swapped", "G u̇ + A u = F", ROUGH, "scheme.march", wrong.swapped, "limit"),
    Control("rough: norm of L²", "‖v‖ instead of ‖v‖_V", ROUGH, "", wrong.norm_of_l2, "order"),
    Control("blind: companion", "the solution is compared with itself instead of the solution with the time step k", MOVING, "", wrong.companion_is_the_run, "time-share"),
    Control("blind: solver", "the residual of the contact solves is reported as 0", MOVING, "scheme.march", wrong.without_residual, "residual"),
    Control("blind: quadrature", "the quadrature rule is compared with itself instead of a finer rule", MOVING, f"{MEASURE}.quadrature_change", wrong.returns(0.0), "quadrature"),
    Control("blind: parallelogram", "the defect of the parallelogram law is reported as 0", MOVING, f"{MEASURE}.parallelogram", wrong.returns(0.0), "parallelogram"),
    Control("rough: contact two-sided", "v_ν = 0 instead of v_ν ≤ 0", ROUGH, SOLVER, wrong.held, "size"),
    Control("rough: clamp short", "Γ1 ends one cell too early", ROUGH, "", wrong.clamp_one_cell_short, "clamped"),
    Control("rough, blind: companion", "the solution is compared with itself instead of the solution with the time step k", ROUGH, "", wrong.companion_is_the_run, "time-share"),
    Control("rough, blind: solver", "the residual of the contact solves is reported as 0", ROUGH, "scheme.march", wrong.without_residual, "residual"),
    Control("rough, blind: quadrature", "the quadrature rule is compared with itself instead of a finer rule", ROUGH, f"{MEASURE}.quadrature_change", wrong.returns(0.0), "quadrature"),
    Control("rough, blind: parallelogram", "the defect of the parallelogram law is reported as 0", ROUGH, f"{MEASURE}.parallelogram", wrong.returns(0.0), "parallelogram"),
    Control("solid: contact dropped", "V^h instead of K^h", SOLID, "problem", wrong.no_contact, "order-finest"),
    Control("solid: energy for norm", "½‖·‖_V² instead of ‖·‖_V", SOLID, DISTANCE, wrong.energy, "interpolation-order-finest"),
    Control("not graded", "the meshes are not refined at the corner", CORNERED, "fem.mesh:Graded.__call__", wrong.ungraded, "order-graded"),
    # Defects of the contact force. The error of the displacement hardly shows them, so checks of the force must.
    Control("contact load", "1.2 ∫ σ_ν v_ν in (3.7)", PRESSED, "", wrong.contact_work_times(1.2), "resultant"),
    Control("contact in places", "v_ν ≤ 0 at every other vertex only", PRESSED, SOLVER, wrong.in_places, "penetration"),
    Control("force: elasticity dropped", "A u̇ = F without G(u)", PRESSED, "scheme.march", wrong.no_elasticity, "order-pressure"),
    Control("force: law swapped", "G u̇ + A u = F", PRESSED, "scheme.march", wrong.swapped, "order-resultant"),
    Control("multipliers", "1.2 λ instead of λ, with the correct u^h", PATCH, SOLVER, wrong.forces_times(1.2), "order-dual-superclose"),
    Control("multipliers on other meshes", "1.2 λ instead of λ, with the correct u^h", CROSSED_PATCH, SOLVER, wrong.forces_times(1.2), "order-dual-other"),
    Control("force: few steps", "an eighth of the number of time steps", CROSSED_PATCH, "steps", wrong.an_eighth, "time-share"),
    Control("contact pulls", "v_ν = 0 instead of v_ν ≤ 0", PATCH, SOLVER, wrong.held, "pulling"),
    # Theorem 4.2: defects of the comparison of the stress formulation with the displacement formulation.
    Control("stress from displacement", "the stress is computed from the solution of Problem 3.1", BOTH, "", wrong.stress_from_displacement, "alone-stress"),
    Control("stress without contact", "σ_ν = 0 instead of σ_ν ≤ 0", OWN, "solver", wrong.no_multipliers, "order-stress"),
    Control("stress law swapped", "A and G swapped in Problem 3.2", OWN, "", wrong.law_swapped, "order-strain"),
    Control("stress without memory", "the strains of earlier times are taken as 0", OWN, "scheme.past", wrong.replaced_by((0.0, 0.0)), "order-strain"),
    Control("stress without f_2", "σν = 0 instead of f_2 on Γ2", OWN, "data.surface_load", wrong.result(wrong.times(0.0)), ("order-stress", "order-sup")),
    Control("first step off", "u_1 is wrong by 1e-4, later steps are correct", BOTH, "", wrong.step_times("first", u=1.0001), "displacement"),
    Control("first stress off", "σ_1 is wrong by 1e-4, later steps are correct", BOTH, "", wrong.step_times("first", stress=1.0001), "stress"),
    Control("stopped early", "the solver stops at duality gaps of 1e-8 instead of 1e-15", BOTH, "solve.stress_problem:AIM", wrong.replaced_by(Accuracy(gap=1e-8, feasibility=1e-11)), "allowed"),
    Control("3.2: load late", "the load of the previous time step in Problem 3.2", BOTH, "", wrong.stress_load_late, "admissibility"),
    Control("3.2: work late", "u of the previous time step in the work", BOTH, "", wrong.displacement_late, "energy"),
    Control("3.2: contact with gaps", "v_ν ≤ 0 at every other vertex only, in Problem 3.2", BOTH, "", wrong.stress_gaps, "membership"),
    Control("blind: comparison", "the distance between the solutions of Problems 3.1 and 3.2 is reported as 0", BOTH, "statements.thm_4_2:gaps", wrong.returns(Gaps(*[0.0] * len(Gaps._fields))), "alone-displacement"),
    Control("blind: two problems", "the solution of Problem 3.1 is compared with itself", BOTH, "", wrong.compared_with_itself, "displacement"),
    Control("blind: companion of 3.2", "the solution is compared with itself instead of the solution with the time step 2k", OWN, f"{OWN_ERRORS}:StressExperiment.companion", wrong.every_other_state, "time-share"),
    Control("blind: admissibility", "violations of (2.4) and (2.5) are reported as 0", OWN, f"{OWN_ERRORS}:inadmissible", wrong.returns(0.0), "admissible"),
    Control("sign of the pressure", "σ_ν + σ^h_ν instead of σ_ν − σ^h_ν", OWN, f"{OWN_ERRORS}:Exact.pressure", lambda right: lambda exact, time, tractions: right(exact, time, -tractions), "order-pressure"),
    Control("sign of multipliers", "moments of −u instead of u", OWN, f"{OWN_ERRORS}:Exact.moments", wrong.times(-1.0), "order-displacement"),
    Control("sign of u^h", "moments of −u^h instead of u^h", OWN, f"{OWN_ERRORS}:Exact.moments_of", wrong.times(-1.0), "order-primal_displacement"),
    Control("3.1 without A", "Gε(u^h) instead of Aε(δu^h) + Gε(u^h)", OWN, f"{OWN_ERRORS}:velocities", wrong.without_viscosity, "order-primal_stress"),
    Control("fronts missed", "cells are not cut along fronts before f_0 is integrated, in Problem 3.2", OWN_MERGING, "data.fronts", wrong.replaced_by(no_fronts), "time-share"),
    Control("f_2 late", "f_2(t − k) instead of f_2(t)", OWN, "", wrong.surface_load_late, "growth"),
    # Other statements: a mistake in the measurement, or a quantity that is compared with itself.
    Control("f_2 left out", "(f_2, v) left out of (2.14)", GREEN, "green:work_on", wrong.no_work_on_loaded, "fine-rule"),
    Control("blind: Green", "one side of (2.14) is compared with itself", GREEN, "", wrong.zeroed("fine rule"), "fine-rule"),
    Control("f_0 off by a third", "⅔ f_0 in (2.14)", KINKED, "green:work_of_body_force", wrong.times(2 / 3), "halved"),
    Control("f_0 off by 2 %", "0.98 f_0 in (2.14)", KINKED, "green:work_of_body_force", wrong.times(0.98), "shrunk"),
    Control("clamped at points", "Γ1 consists of two points", KORN, "korn:space_of", wrong.space(wrong.pinned), "limit"),
    Control("wrong end", "the largest eigenvalue instead of the smallest", KORN, "korn:smallest", wrong.replaced_by(eigen.largest), "falling"),
    Control("product of L²", "(·,·)_H instead of the inner product of H_1", NORMS, "korn:h1_product", wrong.replaced_by(eigen.mass), "settled-largest"),
    Control("norm doubled", "2 (·,·)_V instead of (·,·)_V", NORMS, "korn:largest", wrong.times(2.0), "upper"),
    Control("sum over vertices", "Σ v·w over vertices instead of (v, w)_H", NORMS, "korn:h1_product", wrong.over_vertices, "settled-smallest"),
    Control("strains doubled", "∇u + ∇uᵀ instead of half of this sum", NORMS, "korn:strain_product", wrong.times(2.0), "lower"),
    Control("shear halved", "ε_12 instead of √2 ε_12", VISCOSITY, "constitutive_law:resolve", wrong.law("A", wrong.engineering_shear), "ellipticity"),
    Control("A doubled", "2A instead of A", VISCOSITY, "constitutive_law:resolve", wrong.law("A", wrong.times(2.0)), "bound"),
    Control("G doubled", "2G instead of G", ELASTICITY, "constitutive_law:resolve", wrong.law("G", wrong.times(2.0)), "lipschitz"),
    Control("sign of G", "−G instead of G", ELASTICITY, "constitutive_law:resolve", wrong.law("G", wrong.times(-1.0)), "monotonicity"),
    Control("prestress", "G(ε) + 1 instead of G(ε)", ELASTICITY, "constitutive_law:resolve", wrong.law("G", wrong.result(lambda stress: stress + 1)), "at-zero"),
    Control("half returned", "½ G instead of G of (3.3)", PROJECTION, "constitutive_law:projection", wrong.returning(share=0.5), "membership"),
    Control("returned too far", "1.5 G instead of G of (3.3)", PROJECTION, "constitutive_law:projection", wrong.returning(share=1.5), "nearest"),
    Control("pushed away", "−G instead of G of (3.3)", PROJECTION, "constitutive_law:projection", wrong.returning(share=-1.0), "expansion"),
    Control("yield too early", "half the radius of K in (3.3)", PROJECTION, "constitutive_law:projection", wrong.returning(radius=0.5), "identity"),
    Control("u_n without contact", "V^h instead of K^h", ADMISSIBLE, "admissibility:Experiment", within(SOLVER, wrong.freed), "membership"),
    Control("u_n held", "v_ν = 0 instead of v_ν ≤ 0", ADMISSIBLE, "admissibility:Experiment", within(SOLVER, wrong.held), "displacements"),
    Control("u_n relaxed", "v_ν ≤ √h instead of v_ν ≤ 0", ADMISSIBLE, "admissibility:Experiment", within("", wrong.constraint_relaxed), "stresses"),
    Control("blind: work", "(σ, ε(u)) is compared with itself", ADMISSIBLE, "", wrong.zeroed("work"), "work"),
    Control("blind: cone", "the distance from the cone is reported as 0", ADMISSIBLE, "", wrong.zeroed("distance"), "cone"),
    Control("σ without A u̇", "Gε(u^h) instead of Aε(u̇^h) + Gε(u^h)", NATURAL, "boundary:on_cells", wrong.no_rate, "contact"),
    Control("end of the step", "σ at the end of the time step instead of its middle", NATURAL, "boundary:discrete_stresses", wrong.half_a_step_late, "loaded-weakly"),
    Control("5 % of the load", "1.05 F instead of F", NATURAL, "boundary:Experiment", within(LOAD, wrong.times(1.05)), "tangential-weakly"),
    Control("sign of f_2", "σν + f_2 instead of σν − f_2", NATURAL, "boundary:traction", wrong.times(-1.0), "loaded"),
    Control("blind: Prager–Synge", "Cε(u^h) instead of a balanced σ^h", HYPERCIRCLE, "hypercircle:Pair", wrong.law_alone, "guaranteed"),
    Control("normals inwards", "−ν instead of ν in N", MEMBERS, "constraint:space_of", wrong.inward, "members"),
    Control("vertex off Γ3", "a constraint inside the body", MEMBERS, "constraint:space_of", wrong.space(wrong.off_contact), "strangers"),
    Control("Π^h u on the other side", "−ν instead of ν in N", INTERPOLANT, "constraint:space_of", wrong.inward, "smooth"),
    Control("sign of u", "−u instead of u", INTERPOLANT, "constraint:over_time", wrong.exact_displacement(negative), "exact"),
    Control("Γ1 moved", "u + 10⁻⁶ instead of u", INTERPOLANT, "constraint:over_time", wrong.exact_displacement(lambda u: u + 1e-6), "clamped"),
    Control("bounds without contact", "V^h instead of K^h", BOUNDS, "error_bounds:Experiment", within(SOLVER, wrong.freed), "steady-5.21"),
    Control("bounds by springs", "a stiff foundation instead of v_ν ≤ 0", BOUNDS, "error_bounds:Experiment", within(SOLVER, wrong.springs), "steady-5.42"),
    Control("blind: (5.21)", "the error is reported as 0", BOUNDS, "", wrong.zeroed("(5.21), c"), "constant-5.21"),
    Control("blind: (5.42)", "the error is reported as 0", BOUNDS, "", wrong.zeroed("(5.42), c"), "constant-5.42"),
    Control("root forgotten", "‖·‖_V² instead of ‖·‖_V", IN_V, "fem.error_norm:ErrorNorm.distance", wrong.squared, "u-0.61"),
    Control("interpolant late", "Π^h u(0.9 t) instead of Π^h u(t)", IN_V, "fem.error_norm:ErrorNorm.sample", wrong.interpolant_late, "u-0.23"),
    Control("root of a smooth field", "‖·‖_V² instead of ‖·‖_V", IN_V, "interpolation:distance_in_V", wrong.squared, "smooth"),
    Control("area for length", "h² instead of h", ON_CONTACT, "interpolation:induced_size", wrong.squared, "smooth-face-1"),
    Control("(5.24) as printed", "an error of order h", ON_CONTACT, "interpolation:on_face", wrong.times_h(-1), "u-0.23-face-1"),
    Control("root on Γ3", "‖·‖² instead of ‖·‖ in L²(Γ3)", ON_CONTACT, "interpolation:on_face", wrong.squared_each, "u-0.61-face-1"),
    Control("area for length, on face 2", "h² instead of h", FACES, "interpolation:induced_size", wrong.squared, "smooth-face-2"),
    Control("(5.24) as printed, on face 2", "an error of order h", FACES, "interpolation:on_face", wrong.times_h(-1), "u-0.23-face-2"),
    Control("root on Γ3, on face 2", "‖·‖² instead of ‖·‖ in L²(Γ3)", FACES, "interpolation:on_face", wrong.squared_each, "u-0.61-face-2"),
    Control("lengths three times more, on face 3", "h³ ‖·‖ instead of ‖·‖", FACES, "interpolation:on_face", wrong.times_h(3), "smooth-face-3"),
    Control("lengths twice, on face 3", "h ‖·‖ instead of ‖·‖", FACES, "interpolation:on_face", wrong.times_h(1), "u-0.23-face-3"),
    Control("an error that stays, on face 3", "‖·‖/h² instead of ‖·‖", FACES, "interpolation:on_face", wrong.times_h(-2), "u-0.61-face-3"),
    Control("load late, k ~ h", "the load of the previous time step", CLOSE, "superclose:Experiment", within("", wrong.load_late), "order"),
    Control("few steps, k ~ h", "an eighth of the number of time steps", CLOSE, "superclose:Experiment", within("steps", wrong.an_eighth), "time-share"),
    Control("k as it is", "the same number of time steps on every mesh", CLOSE, "superclose:Superclose.steps", wrong.returns(32), "share-growth"),
    Control("constant of B doubled", "2B instead of B", LINEAR, "lipschitz:largest", wrong.times(2.0), "constant"),
    Control("κ halved", "½ κ instead of κ", LINEAR, "lipschitz:pointwise", wrong.result(lambda found: (found[0] / 2, found[1])), "pointwise"),
    Control("sign of d", "(Bu − Bv, v − u)_V, not over ‖u − v‖²", LINEAR, "lipschitz:compare", wrong.opposite_work, "monotonicity"),
    Control("blind: search", "random pairs of strains, without the search that finds the worst pair", NONLINEAR, "lipschitz:quotients", wrong.random_only, "waves"),
    Control("R without f_2", "(f_2, v) left out of R", RESIDUAL, "residual:terms", wrong.without("loaded"), "smooth"),
    Control("R without f_0", "(f_0, v) left out of R", RESIDUAL, "residual:terms", wrong.without("body"), "bound"),
    Control("blind: remainder", "R is compared with itself", RESIDUAL, "", wrong.zeroed("Π^hu − u"), "remainder"),
    Control("one search", "the solver from random starting values stops at once", TRAJECTORY, "uniqueness:RandomStarts", wrong.replaced_by(wrong.RandomSearch), "random-starts"),
    Control("blind: least squares", "the solver is compared with itself", TRAJECTORY, "uniqueness:rivals", wrong.same_problem("least squares"), "least-squares"),
    Control("blind: interior point", "the solver is compared with itself", TRAJECTORY, "uniqueness:rivals", wrong.same_problem("interior point"), "interior-point"),
    Control("blind: fixed point", "the distance to the solution of the fixed-point iteration is reported as 0", TRAJECTORY, "", wrong.zeroed("fixed point"), "fixed-point"),
    Control("one search for σ", "the solver from random starting values stops at once", ONE_STRESS, "uniqueness:RIVALS", wrong.rival("random starts", wrong.RandomSearch), "random-starts"),
    Control("blind: σ by least squares", "the solver is compared with itself", ONE_STRESS, "uniqueness:RIVALS", wrong.rival("least squares", Signorini), "least-squares"),
    Control("blind: σ by interior point", "the solver is compared with itself", ONE_STRESS, "uniqueness:RIVALS", wrong.rival("interior point", Signorini), "interior-point"),
    Control("start outside K", "u_0^h ∉ K^h", VELOCITY, "wellposed:Experiment", within("problem", wrong.start_outside), "bounded"),
    Control("velocity of two steps", "(u_n − u_{n−1})/2k instead of δu_n", VELOCITY, "wellposed:fastest", wrong.times(0.8), "limit"),
    Control("quotients of squares", "half of the change of the data", DEPENDENCE, "wellposed:quotients", wrong.times(2.0), "monotone"),
    Control("ω left out", "distances of solutions that are 1.5 times as large", DEPENDENCE, "wellposed:quotients", wrong.times(1.5), "bound"),
    Control("blind: dependence", "a solution is compared with itself", DEPENDENCE, "", wrong.zeroed("first step"), "first-step"),
    Control("contact held: (5.12)", "v_ν = 0 instead of v_ν ≤ 0", ESTIMATE, "steps_of_the_estimate:Experiment", within(SOLVER, wrong.held), "5.12"),
    Control("multipliers: (slack-5.12)", "1.2 λ instead of λ, with the correct u^h", ESTIMATE, "steps_of_the_estimate:Experiment", within(SOLVER, wrong.forces_times(1.2)), "slack-5.12"),
    Control("load late: (5.14)", "the load of the previous time step", FROM_REST, "steps_of_the_estimate:Experiment", within("", wrong.load_late), "5.14"),
    Control("no contact: (5.16)", "V^h instead of K^h", FROM_REST, "steps_of_the_estimate:Experiment", within("problem", wrong.no_contact), "5.16"),
    Control("no work of contact: (5.19)", "the work of contact has the wrong sign in f", FROM_REST, "steps_of_the_estimate:Experiment", within("", wrong.contact_work_times(-1.0)), "5.19"),
    Control("0.9 Π^h u̇", "0.9 Π^h u̇ instead of Π^h u̇", ESTIMATE, "steps_of_the_estimate:Energies.interpolated_rate", wrong.times(0.9), "5.15"),
    Control("no interpolant", "0 instead of Π^h u, but its velocity is correct", FROM_REST, "steps_of_the_estimate:Energies.interpolant", wrong.times(0.0), "5.18"),
    Control("cut off", "v_ν is cut off at the vertices instead of projected by P", SEPARATION, "separation:projected", wrong.cut_off, "cone"),
    Control("2A in τ̃", "2A ε(Pu − u) instead of A ε(Pu − u)", SEPARATION, "separation:separating", wrong.times(2.0), "gap"),
    Control("reflected twice", "σ̃ − 2σ instead of 2σ − σ̃", SEPARATION, "separation:reflected", wrong.times(-1.0), "stresses"),
    Control("not reflected", "σ instead of 2σ − σ̃", SEPARATION, "separation:reflected", wrong.replaced_by(lambda *given: given[0]), "refuted"),
    Control("foundation pulls", "μ ≤ 0 in Nᵀμ", MONOTONE, "resolvent:in_graph", wrong.result(lambda pair: (pair[0], -pair[1])), "normal-cone"),
    Control("2B", "2B instead of B", MONOTONE, "solve.evolution:SemiDiscrete.elastic", wrong.times(2.0), "monotone"),
    Control("J shrinks", "½ J instead of J", MONOTONE, "resolvent:Inverse.__call__", wrong.times(0.5), "resolvent"),
    Control("one image", "J w after one step", MONOTONE, "resolvent:fixed_point", wrong.replaced_by(lambda image, v, *how: (image(v), 1)), "onto"),
    Control("J expands", "3/2 J instead of J", MONOTONE, "resolvent:Inverse.__call__", wrong.times(1.5), "resolvent-monotone"),
    Control("squares add up", "‖f(t_i) − f(t_{i−1})‖² instead of its root", LOADS, "norms_in_time:dual_norm", wrong.squared, "variation"),
    Control("load with a jump", "the work of contact has the wrong sign in f", LOADS, "norms_in_time:ErrorNorm", wrong.other_contact_work(-1.0), "increments"),
    Control("vector for functional", "|F| instead of ‖M⁻¹F‖_V", LOADS, "norms_in_time:Cholesky", wrong.replaced_by(lambda M: lambda F: F), "uniform"),
    Control("no lengths: bounded", "sums over points instead of integrals on Γ", TRACTION, "norms_in_time:facet_rule", wrong.unweighted, "bounded"),
    Control("no lengths: unbounded", "sums over points instead of integrals on Γ", LOGARITHM, "norms_in_time:facet_rule", wrong.unweighted, "unbounded"),
    Control("σ four times in R", "4σ instead of σ in R", AT_REST, "residual_bound:Energies.functional", wrong.times(4.0), "bound"),
    Control("other sign of z", "−A ε(z)", AT_REST, "residual_bound:prestress", wrong.times(-1.0), "rest"),
    Control("1.2 ‖R‖", "1.2 ‖R‖ instead of ‖R‖", AT_REST, "residual_bound:dual_norm", wrong.times(1.2), "prestress"),
    Control("0.5 ‖R‖", "0.5 ‖R‖ instead of ‖R‖", AT_REST, "residual_bound:dual_norm", wrong.times(0.5), "attained"),
    Control("softening by a tenth", "1.1 G'(0) instead of G'(0), in the eigenvalue only", DIVERGENCE, "solution_divergence:derivative", wrong.times(1.1), "rate"),
    Control("backward Euler for midpoint", "growth by 1/(1 − z) instead of e^z", DIVERGENCE, "solution_divergence:MIDPOINT", wrong.replaced_by(BACKWARD_EULER), "rate-even"),
    Control("growth a tenth too fast", "1.1 ‖u − v‖ instead of ‖u − v‖", DIVERGENCE, "solution_divergence:quotients", wrong.times(1.1), "bound"),
    Control("growth a tenth too slow", "0.9 ‖u − v‖ instead of ‖u − v‖", DIVERGENCE, "solution_divergence:quotients", wrong.times(0.9), "bound-even"),
    Control("f off by a tenth at a front", "0.9 f instead of f", ADVANCING, "advancing_front:load_from_forces", wrong.times(0.9), "order"),
    Control("squares of velocities", "‖u̇ − Π^h u̇‖² instead of its root", ADVANCING, "advancing_front:Velocity.interpolation_error", wrong.squared, "rate"),
    Control("traction off by a tenth", "0.9 σ_ν instead of σ_ν in the linear problem", ADVANCING, "advancing_front:pressure_load", wrong.times(0.9), "excess"),
    Control("blind: steps at a front", "a solution is compared with itself", ADVANCING, "", wrong.zeroed("time share"), "time"),
    Control("blind: a rule and itself", "the finer quadrature rule of f_0 is not finer", ADVANCING, "advancing_front:RAISED", wrong.replaced_by(2), "quadrature"),
    Control("P_h off by a tenth", "1.1 P_h u instead of P_h u", GROWING, "growing_errors:projection", wrong.times(1.1), "known"),
    Control("start without an error in V^h", "u_0^h = P_h u_0 instead of Π^h u_0", GROWING, "growing_errors:Experiment", within("", wrong.start_at_projection), "needed"),
    Control("ten times the error: bound", "10 ‖u − u^h‖ instead of ‖u − u^h‖", GROWING, "growing_errors:share", wrong.times(10.0), "bound"),
    Control("ten times the error: time", "10 ‖u^h − û^{hk}‖ instead of ‖u^h − û^{hk}‖", GROWING, "growing_errors:furthest", wrong.times(10.0), "time"),
    Control("no potential: error", "100 ‖u^h − û^{hk}‖ instead of ‖u^h − û^{hk}‖", NO_POTENTIAL, "no_potential:furthest", wrong.times(100.0), ("data-equal", "data-unequal", "solution-equal", "solution-unequal")),
    Control("no potential: skew part dropped", "the symmetric part of G instead of G", NO_POTENTIAL, "no_potential:Experiment", within("problem.remainder", wrong.replaced_by(None)), "order-both"),
    Control("no potential: load late", "the load at the time t − T/8 in backward Euler", NO_POTENTIAL, "no_potential:backward_euler", wrong.load_of_before, ("order-equal", "order-unequal")),
    Control("no potential: norm", "Euclidean norm of nodal values instead of ‖·‖_V", NO_POTENTIAL, "no_potential:furthest", wrong.norm_of_nodal_values, "uniform"),
    Control("no potential: κ halved", "κ/2 instead of κ in both bounds", NO_POTENTIAL, "no_potential:EulerBounds", wrong.constant_halved, "rotation"),
    Control("blind: reference of no potential", "the reference solution is compared with itself", NO_POTENTIAL, "no_potential:path", wrong.always_steps(256), "reference"),
    Control("nodal start: off the vertices", "v near the vertices instead of v at the vertices", NODAL_START, "nodal_start:spikes", wrong.near_vertices, ("size", "proved", "growth", "worse")),
    # Checks that compare two results: on a rotated body, by a second solver, and of an error bound with the error.
    Control("axes", "the axis nearest to ν instead of ν", ROTATED, "problem.N", wrong.nearest_axis, "discrete-error"),
    Control("width for length", "w ‖·‖_V with the width w along the first axis", ROTATED, "fem.error_norm:ErrorNorm.distance", wrong.times_width, "errors"),
    Control("error off by 1 %", "1.01 ‖u − u^h‖_V is reported", AGAIN, f"{MEASURE}.row", wrong.column_times("error", 1.01), "error"),
    Control("interpolation off by 1 %", "0.99 ‖u − Π^h u‖_V is reported", AGAIN, f"{MEASURE}.row", wrong.column_times("interpolation_error", 0.99), "interpolation-error"),
    Control("discrete error off by 2 %", "1.02 ‖Π^h u − u^h‖_V is reported", AGAIN, f"{MEASURE}.row", wrong.column_times("discrete_error", 1.02), "discrete-error"),
    Control("again: start at zero", "u_0^h = 0 instead of Π^h u_0", AGAIN, START, zero, "start"),
    Control("again: load", "1.05 F instead of F", AGAIN, LOAD, wrong.times(1.05), "displacement"),
    Control("again: multipliers", "1.2 λ instead of λ, with the correct u^h", AGAIN, SOLVER, wrong.forces_times(1.2), "multipliers"),
    Control("again: modulus", "λ of A larger by a millionth", AGAIN, "", by_amount("λ of A", 1e-6), SAME_DISPLACEMENT),
    Control("again: forces", "λ larger by a millionth with the right u^h", AGAIN, "", by_amount("contact force λ", 1e-6), SAME_FORCES),
    Control("bound without residual", "the residual of the material law is taken as 0", BOUND, "bound.terms:Majorant.products", wrong.times(0.0), "above"),
    Control("enclosure: half the norm", "½ ‖·‖_V instead of ‖·‖_V on V^h", ENCLOSURE, "bound.discretisation:Discretisation.norm", wrong.times(0.5), "above"),
    Control("enclosure: twice the norm", "2 ‖·‖_V instead of ‖·‖_V on V^h", ENCLOSURE, "bound.discretisation:Discretisation.norm", wrong.times(2.0), "below"),

    # Defects that a diagnostic must show, such as a wrong contact force at one time node.
    Control("residual: sign", "v_ν = 0: forces that pull, all else solved", MOVING, SOLVER, wrong.held, "residual"),
    Control("residual: complementarity", "forces where a gap is open, all else solved", MOVING, SOLVER, wrong.shifted_gap(-0.03), "residual"),
    Control("residual: gap", "v_ν ≤ 0 at every other vertex, all else solved", MOVING, SOLVER, wrong.in_places, "residual"),
    Control("residual: balance", "1.2 λ instead of λ, everything else is correct", MOVING, SOLVER, wrong.forces_times(1.2), "residual"),
    *(Control(f"residual: {which} step", f"1.5 λ instead of λ in the {which} step only", MOVING, "",
              wrong.in_one_step(wrong.forces_times(1.5), which, 2), "residual") for which in NODES),
    *(Control(f"supremum: {which} node", f"5 u^h instead of u^h at the {which} time step only", MOVING, "",
              wrong.state_off(which, 1, u=5.0), ("order", DISCRETE_ORDER)) for which in NODES),
    *(Control(f"supremum of interpolation: {which} node", f"5 Π^h u instead of Π^h u at the {which} time step only", MOVING, "",
              wrong.interpolant_off(which), "leading-term") for which in NODES),
    *(Control(f"time share: {which} node", f"0.9 u^h instead of u^h with the longer steps, at the {which} time step only", MOVING, "",
              wrong.state_off(which, 0, u=0.9), ("time-share", "discrete-time-share")) for which in NODES),
    *(Control(f"parallelogram: {factor:g} at the {which} node", f"{factor:g} ‖u − Π^h u‖_V at the {which} time step only", MOVING, "",
              wrong.interpolation_error_off(which, factor), "parallelogram") for which in MIDDLE for factor in (0.8, 1.2)),
    Control("quadrature: load", "1.05 f instead of f; the quadrature of the error is correct", MOVING, "", wrong.load_off(lambda t: 0.05), "quadrature"),
    Control("quadrature: early load", "1.004 f instead of f until T/10 only", MOVING, "", wrong.load_off(lambda t: 0.004 * (t < 0.1)), "quadrature"),
    Control("quadrature: error", "the quadrature rule of the error has one point; the rule of the load is correct", MOVING, "", wrong.one_point_quadrature, "quadrature"),
    Control("quadrature: degree", "quadrature rules of degree 1 instead of 4", MERGING, "fem.error_norm:DEGREE", wrong.replaced_by(1), "quadrature"),
    Control("ten defects at once", "diagnostics too small in ten ways, contact forces that pull, the load of the previous time step", MOVING, "solve.evolution:ContactStep._residual", wrong.balance_alone,
            ("order", "order-extrapolated", "size", DISCRETE_ORDER, "discrete-share"),
            # Each diagnostic ignores a part of the computation: some times, some conditions, or some errors.
            (("controls.baselines:measure", wrong.every_second_time), (f"{MEASURE}.parallelogram", wrong.at_the_last_time),
             (f"{MEASURE}.clamped", wrong.returns(1e-12)), (f"{MEASURE}.quadrature_change", wrong.returns(1e-9)),
             (SOLVER, wrong.held), ("", wrong.load_late))),
    *(Control(f"contact: {which} node", f"−u^h and −λ instead of u^h and λ at the {which} time step only", PATCH, "",
              wrong.state_off(which, 0, u=-1.0, multipliers=-1.0), ("penetration", "pulling")) for which in MIDDLE),
    Control("contact: share of the dual norm", "1.01 λ instead of λ with half as many steps", PATCH, "", wrong.coarse_forces(lambda forces: 1.01 * forces), "time-share"),
    Control("contact: share of the pressure", "λ with half as many steps is wrong by +1 % and −1 % in turns", PRESSED, "",
            wrong.coarse_forces(wrong.off_in_turns), "time-share"),
    *(Control(f"contact: time share, {which} node", f"30 λ instead of λ with half as many steps, at the {which} time step only", PATCH, "",
              wrong.state_off(which, -1, multipliers=30.0), "time-share") for which in MIDDLE),
    *(Control(f"3.2: {name}, {which} step", f"{what} in the {which} step only", BOTH, "", wrong.step_times(which, **off), checks)
      for which in NODES
      for name, what, off, checks in (
          ("stress", "σ larger by a thousandth", {"stress": 1.001}, ("stress", "admissibility", "energy")),
          ("displacement", "−u instead of u", {"u": -1.0}, ("displacement", "membership")),
          ("duality gap", "a gap 10¹⁴ times as large", {"gap": 1e14}, "allowed"))),
    *(Control(f"admissible: {kind}", f"a stress that {what} by a few thousandths, at one edge in one step", OWN,
              f"{OWN_ERRORS}:inadmissible", wrong.inadmissible_once(kind, call), "admissible")
      for call, kind, what in ((3, "jumps", "jumps between cells"), (4, "misses f_2", "misses f_2"),
                               (5, "tangential", "is tangential on Γ3"), (6, "pulls", "pulls on Γ3"))),
    Control("own space: time share", "5 σ instead of σ with half as many steps, in one step only", OWN, f"{OWN_ERRORS}:StressExperiment.companion", wrong.companion_off, "time-share"),
    *(Control(f"{name}: {which} step", f"{what} in the {which} step only", setting, f"{module}:Experiment",
              within("", wrong.in_one_step(solver, which, part)), checks)
      for name, what, setting, module, solver, part, checks in (
          ("u_n without contact", "V^h instead of K^h", ADMISSIBLE, "admissibility", wrong.freed, 1.0, "membership"),
          ("u_n held", "v_ν = 0 instead of v_ν ≤ 0", ADMISSIBLE, "admissibility", wrong.held, 1.0, ("cone", "displacements")),
          ("u_n pressed", "contact forces where the gap is open", ADMISSIBLE, "admissibility", wrong.shifted_gap(-0.03), 1.0, ("work", "displacements")),
          ("contact held", "v_ν = 0 instead of v_ν ≤ 0", ESTIMATE, "steps_of_the_estimate", wrong.held, 1 / 8, "5.12"),
          ("multipliers", "1.5 λ instead of λ", ESTIMATE, "steps_of_the_estimate", wrong.forces_times(1.5), 1 / 8, "slack-5.12"))
      for which in MIDDLE),
    *(Control(f"{name}: {which} node", f"{what} at the {which} time step only", setting, f"{module}:Experiment",
              within("", wrong.state_off(which, halvings, u=factor)), checks)
      for name, what, setting, module, halvings, factor, checks in (
          ("superclose", "10 u^h instead of u^h", CLOSE, "superclose", 0, 10.0, "order"),
          ("superclose: time share", "1.5 u^h instead of u^h with half as many steps,", CLOSE, "superclose", -1, 1.5, "time-share"),
          ("bounds", "1000 u^h instead of u^h", BOUNDS, "error_bounds", 0, 1e3, ("constant-5.21", "constant-5.42")))
      for which in MIDDLE),
    *(Control(f"other ways: {which} node", f"1.001 u^h instead of u^h from all other solvers, at the {which} time step only", TRAJECTORY,
              "uniqueness:Experiment", within("", wrong.rival_off(which)),
              ("random-starts", "least-squares", "fixed-point", "interior-point")) for which in MIDDLE),
    Control("other ways to σ: one step", "1.001 σ instead of σ from all other solvers, in one step only", ONE_STRESS, "uniqueness:stresses",
            wrong.rival_stress_off, ("random-starts", "least-squares", "interior-point")),
    *(Control(f"{name}: {which} node", f"10 u_n instead of u_n at the {which} time step only", setting, "wellposed:BACKWARD_EULER",
              wrong.displacement_off(which, right_first), checks)
      for which in MIDDLE
      for name, setting, right_first, checks in (
          ("velocity", VELOCITY, 0, ("bounded", "limit")), ("dependence", DEPENDENCE, 1, ("bound", "monotone")),
          ("growth", DIVERGENCE, 0, "bound"))),
    Control("backward Euler: one node", "100 u_n instead of u_n at one time step only", GROWING, "growing_errors:interpolated", wrong.row_times((), 129, 100.0), "time"),
    Control("one instant: e", "10⁶ ‖e‖² instead of ‖e‖² at the fourth instant only", ESTIMATE, "steps_of_the_estimate:course",
            wrong.in_calls(wrong.result(wrong.scaled(e=1e6)), 3), ("5.14", "5.16", "5.19")),
    Control("one instant: η", "10⁶ times the correct ‖η‖² and (e, η)_V at the fourth instant only", ESTIMATE, "steps_of_the_estimate:course",
            wrong.in_calls(wrong.result(wrong.scaled(eta=1e6, both=1e6)), 3), ("5.15", "5.18")),
    Control("one instant: σ^h", "10 σ^h instead of σ^h at the fifth instant only", NATURAL, "boundary:discrete_stresses",
            wrong.stress_off_at_an_instant, ("loaded", "contact", "loaded-weakly", "tangential-weakly")),
    *(Control(f"front: {name}", what, ADVANCING, f"advancing_front:{function}", by, key)
      for name, what, function, by, key in (
          ("error at one node", "3 u^h instead of u^h at one time step", "path", wrong.row_times((7,), 51, 3.0), "order"),
          ("excess at one node", "3 u^h_lin instead of u^h_lin at one time step", "path", wrong.row_times((2, 5, 8), 13, 3.0), "excess"),
          ("time share, odd node", "1.2 u^h instead of u^h with the longer steps, at one time step", "path", wrong.row_times((0,), 7, 1.2), "time"),
          ("time share, even node", "1.2 u^h instead of u^h with the longer steps, at one time step", "path", wrong.row_times((0,), 8, 1.2), "time"),
          ("load at one time", "1.1 times the integral of f by the coarse quadrature rule", "load_from_forces", wrong.body_load_off, "quadrature"))),
    *(Control(f"computed again: {name}, {which} node", f"{what} at the {which} time step only", AGAIN, "", wrong.state_off(which, 1, **off), checks)
      for which in MIDDLE
      for name, what, off, checks in (
          ("u", "1.1 u^h instead of u^h", {"u": 1.1}, ("displacement", SAME_DISPLACEMENT)),
          ("λ", "2 λ instead of λ", {"multipliers": 2.0}, ("multipliers", SAME_FORCES)))),
    Control("computed again: errors at one time", "errors a hundred times too large in the second computation", AGAIN, f"{PLAIN}.distance",
            wrong.at_time(33 / 64, lambda errors: [100 * error for error in errors]), ("error", "interpolation-error")),
    Control("computed again: Π^h u at one time", "10 Π^h u instead of Π^h u in the second computation", AGAIN, f"{PLAIN}.interpolant",
            wrong.at_time(33 / 64, lambda u: 10 * u), ("interpolation-error", "discrete-error")),
    *(Control(f"{name} at time {call}", f"{factor:g} times the exact error at one time", setting, KNOWN_ERROR, wrong.result(wrong.in_calls(wrong.times(factor), call)), key)
      for call in (5, 6)
      for name, setting, factor, key in (
          ("bound: error", BOUND, 1e3, "above"), ("enclosure: large error", ENCLOSURE, 1e3, "above"),
          ("enclosure: small error", ENCLOSURE, 1e-6, "below"))),
    Control("R without f_0 at one time", "(f_0, v) left out of R at the second time only", RESIDUAL, "residual:terms",
            wrong.in_calls(wrong.without("body"), 1), ("smooth", "remainder", "bound")),
    Control("sign of u at one time", "−u instead of u at T/2 only", INTERPOLANT, "constraint:over_time", wrong.exact_displacement(negative, 0.5), "exact"),
    Control("Γ1 moved at one time", "u + 10⁻⁴ instead of u at 15 T/32 only", INTERPOLANT, "constraint:over_time", wrong.exact_displacement(lambda u: u + 1e-4, 15 / 32), "clamped"),
    Control("R at one time", "100 R instead of R at one time only", AT_REST, "residual_bound:Energies.functional", wrong.in_calls(wrong.times(100.0), 5), "bound"),
    Control("load at one time", "100 ‖f(t_i) − f(t_{i−1})‖ in one interval alone", LOADS, "norms_in_time:dual_norm",
            wrong.in_calls(wrong.times(100.0), 30), ("variation", "increments")),
    Control("traction at one time", "10⁴ σν instead of σν at one time of the finest grid only", TRACTION, "norms_in_time:resolve",
            wrong.exact_solution("surface_load", 33 / 64, lambda load: 1e4 * load), "bounded"),
)
