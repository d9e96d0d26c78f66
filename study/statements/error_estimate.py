"""The error estimate of Problem 5.1 and its parts.

The formulas (5.20), (5.21) and (5.42) are bounds of the error. (5.23) and (5.24) are bounds of interpolation errors,
(5.27) is a bound of the residual. The remark after (5.35) is about the nodal interpolant of the initial displacement.
"""

import math
from dataclasses import replace
from itertools import product

import numpy as np

from manufactured.body import Body, Kind, Part
from manufactured.case import Case
from manufactured.contact import Face
from manufactured.exact import ExactSolution
from manufactured.law import KelvinVoigt, Linear
from manufactured.tensors import Array, Points, Tensors, dyad
from study.fem.error_norm import FACET_POINTS, ErrorNorm
from study.fem.mesh import Graded, Shaken
from study.fem.naming import resolve
from study.fem.quadrature import rule_on
from study.fem.space import Space, on_cells
from study.ledger.check import MIN_LEVELS, ROUNDING_ROOM, Groups, consequence, identity, paper_claim
from study.ledger.datafiles import Row
from study.ledger.quantities import (
    Value,
    change,
    finest,
    fit,
    fitted,
    level_by_level,
    of_errors,
    over_refinements,
)
from study.ledger.window import Window, around, at_least, at_most, positive_at_most
from study.solve.evolution import SemiDiscrete, norm, path
from study.solve.factorisation import Cholesky
from study.solve.steps import rate_steps
from study.solve.tableau import MIDPOINT
from study.statements.shared.base import (
    EVOLVING,
    SEED,
    SOFTENING,
    Experiment,
    Judged,
    ListedNumbers,
    Numbers,
    Records,
    Setting,
    grid,
    with_h,
)
from study.statements.shared.meshes import (
    CELL_POWER,
    body_of,
    first_with_each,
    law_of,
    named,
    place,
    posed,
    space_of,
    split,
)
from study.statements.shared.norms import (
    Energies,
    Field,
    displacement,
    dual_norm,
    midpoints,
    time_nodes,
    trace_error,
    unloaded,
)
from study.statements.thm_4_2 import beyond
from study.statements.wellposed import planes, strain, vanishing, waves

FIRST_SPIKES = 3
"""The smallest level j of the spikes of the counterexample ``NodalStart``.

For j ≥ 3 the radius 4^{−j} of a spike is small compared with the distance 2^{−j} between spikes.
"""
DIRECTION = np.array([0.0, 1.0])
"""The direction e_2 of the initial displacement of the counterexample ``NodalStart``."""


class NodalStart(ListedNumbers):
    """Measures the norm of the interpolant Π^h u_0, and a lower bound of its error, for the counterexample u_0.

    The remark after (5.35) is false in the plane: for u_0 ∈ V ∩ C(Ω̄), Π^h u_0 need not converge to u_0 in V.

    The paper says that (5.25), ‖u_0 − u_0^h‖_V → 0, holds for the nodal interpolant u_0^h = Π^h u_0 if u_0 is
    continuous. A counterexample on the unit square is u_0 = v e_2, on grids with n = 8, 16, 32, … cells along a side.
    The proof is in paper/false_remark.tex. The function v is

        v = Σ_{j≥3} a_j Σ_{c ∈ A_j} λ_j(|x − c|),   a_j = 2^{−j/2},   A_j = {2^{−j}(p, q) : p, q odd} ∩ Ω,

    and the spikes λ_j(r) = min{1, log(R_j/r)/4^j} for r < R_j = 4^{−j}, λ_j(r) = 0 for larger r. The sum converges
    uniformly and in H¹, and u_0 = 0 on the boundary, so that u_0 ∈ K ∩ C(Ω̄). On the grid with n = 2^i every point of
    A_j with j ≤ i is a vertex. So the interpolant has the value a_j there, although the spike is much narrower than a
    cell. ‖u_0‖_V has a bound in closed form and Π^h u_0 is known exactly, so ‖Π^h u_0‖_V − ‖u_0‖_V is a lower bound of
    ‖u_0 − Π^h u_0‖_V without quadrature.

    Predicted before measuring, with the Lamé constants μ, λ of A:

    * ‖Π^h u_0‖_V = ((3μ + λ)(n − 4))^{1/2} up to 5 %. The interpolants of the 4^{j−1} spikes of level j ≤ i are hat
      functions with disjoint supports. Each has the energy (6μ + 2λ) a_j², and Σ_j 2^{−j} 4^{j−1} = (n − 4)/2. Hats of
      different levels do not share an edge of the grid; spikes wider than a cell change values by 1/64 of a_j at most.
    * ‖Π^h u_0‖_V is at least (5 m_A n/16)^{1/2}, which is proved; the predicted value is about twice as large.
    * The lower bound of ‖u_0 − Π^h u_0‖_V grows from every level to the next. Its orders in h are between −1.5 and
      −1/2, since the constant ‖u_0‖_V is subtracted from a multiple of (n − 4)^{1/2}.
    * On the finest grid it is at least three times ‖u_0‖_V, the error of the start u_0^h = 0.
    """

    label = "beyond: nodal start"
    claim = "the remark after (5.35) is false: ‖u_0 − Π^h u_0‖_V grows like h^{−1/2} for a u_0 ∈ K ∩ C(Ω̄)"
    checks = (
        consequence(
            "size",
            "‖Π^h u_0‖_V / ((3μ + λ)(n − 4))^{1/2}",
            "size / predicted",
            around(1, 0.05, "spikes of u_0 interpolate to hat functions of known norm"),
        ),
        identity("proved", "(5 m_A n/16)^{1/2} / ‖Π^h u_0‖_V", "proved / size", positive_at_most(1.0, "proved")),
        consequence(
            "growth",
            "order in h of ‖Π^h u_0‖_V − ‖u_0‖_V ≤ ‖u_0 − Π^h u_0‖_V",
            level_by_level("error from below"),
            Window(-1.5, -0.5, "the error grows at least like h^{−1/2}; every consecutive order"),
            levels=MIN_LEVELS,
            finest=True,
        ),
        consequence(
            "worse",
            "(‖Π^h u_0‖_V − ‖u_0‖_V) / ‖u_0‖_V",
            finest("error / start at 0"),
            at_least(3.0, "Π^h u_0 is a worse start than u_0^h = 0; finest grid"),
        ),
    )
    quick = grid(("full-contact",), ("one-diagonal",), (8, 16, 32, 64))
    full = grid(("full-contact",), ("one-diagonal", "alternating"), (8, 16, 32, 64, 128))

    def measure(self, setting: Setting) -> Numbers:
        space, solution = posed(setting)
        A = solution.law.A
        # The grid has 2^i cells along a side. Spikes with j > i vanish at its vertices and do not change Π^h u_0.
        start = space.interpolate(np.multiply.outer(DIRECTION, spikes(space.mesh.p, setting.level.bit_length() - 1)))
        size = norm(unloaded(space, solution.law), start)
        bound = norm_of_start(A)
        hats = 2 * mean_energy(A) * (setting.level - 4)
        least = math.sqrt(5 * A.ellipticity * setting.level / 16)
        shares = {"size / predicted": size / math.sqrt(hats), "proved / size": least / size}
        errors = {"error from below": size - bound, "error / start at 0": (size - bound) / bound}
        return with_h(space.h, shares | errors)


def spikes(x: Points, last: int) -> Array:
    """Return the function v of ``NodalStart``, a sum of spikes, at the vertices of a grid.

    A spike of the level j has the radius 4^{−j}. Spikes of levels j > last are left out. They vanish at all vertices,
    because their radius is smaller than the distance of their centres from the vertices.

    Args:
        x: the vertices, (2, ...), with one value of v for each in the result, (...).
        last: the level of the grid, which has 2^last cells along a side.
    """
    total = np.zeros(x.shape[1:])
    for j in range(FIRST_SPIKES, last + 1):
        spacing = 2.0**-j
        # The ball around a spike lies in a square with sides 2^{1−j}, so only the nearest spike is non-zero at x.
        centres = spacing * (2 * np.floor(x / (2 * spacing)) + 1)
        r = np.linalg.norm(x - centres, axis=0)
        with np.errstate(divide="ignore"):
            total += 2 ** (-j / 2) * np.clip(np.log(4.0**-j / r) / 4**j, 0, 1)
    return total


def mean_energy(A: Linear) -> float:
    """Return the energy ∫ A ε(v e_2)·ε(v e_2) of a field v e_2 with a radial function v such that ∫ |∇v|² = 1.

    e_1 and e_2 are the Cartesian unit vectors. The energy is ½ Σ_i A d_i·d_i with d_i = sym(e_i ⊗ e_2), which is (3μ +
    λ)/2 for an isotropic A.
    """
    directions = np.array([dyad(axis, DIRECTION) for axis in np.eye(2)])
    return float(np.vdot(directions @ A.matrix, directions)) / 2


def norm_of_start(A: Linear) -> float:
    """Return an upper bound of the norm ‖u_0‖_V of the initial displacement of the counterexample in ``NodalStart``.

    It is the geometric series Σ_j a_j (4^{j−1} · 2π/4^j · ``mean_energy``)^{1/2} over the levels j of the spikes with
    the heights a_j.

    Args:
        A: the viscosity, which defines the norm.
    """
    return math.sqrt(math.pi / 2 * mean_energy(A)) * 2 ** (-FIRST_SPIKES / 2) / (1 - math.sqrt(0.5))


RAISED_FOR_KINKS = 2
"""How much the degree of quadrature rules on cells and the number of points on facets are raised.

More accurate rules are needed, because kinks of the solution cross cells and facets."""
NO_ERROR = 1e-10
"""Relative errors below this number count as round-off.

They occur if a trace is zero or linear, so that it has no interpolation error."""
ORDER_TOLERANCE = 0.15
"""Tolerance for observed orders.

They scatter, because fronts cut cells at different places on each level and the meshes are not nested."""

SMOOTH_FIELD = "a smooth field"
FUNCTIONS = {"u(0.23 T)": 0.23, "u(0.61 T)": 0.61}
"""The times t of the interpolated functions u(t), as fractions of T, by the names of these functions in columns.

In no case does contact begin or end at these times."""
INTERPOLATED = {"smooth": SMOOTH_FIELD, "u-0.23": "u(0.23 T)", "u-0.61": "u(0.61 T)"}
"""Names of the interpolated functions in columns, by the keys of the checks."""
REGULARITY = "τ"
"""Name of the column with the regularity τ of the normal trace: v_ν ∈ H^s(Γ3,i) on a contact face for all s < τ."""
FACE_SIZE, TRACE_ERROR = "size of Γ3,{}", "{} on Γ3,{}"
"""Names of the columns for one contact face: its mesh size, and the interpolation error of a trace on it."""


def smooth(body: Body) -> Field:
    """Return a smooth random displacement field that vanishes on the clamped boundary Γ1."""
    return vanishing(waves(body, np.random.default_rng(SEED)), planes(body, Kind.CLAMPED))


# (5.23): interpolation in V.


class InterpolationInV(ListedNumbers):
    """Measures the interpolation error ‖v − Π^h v‖_V for solutions in H² on each cell, and judges its order.

    The paper states for v ∈ V that

        ‖v − Π^h v‖_V = O(h)  for v ∈ H²(Ω)^d,      ‖v_ν − (Π^h v)_ν‖_{L²(Γ3,i)} = O(h²)  for v_ν ∈ H²(Γ3,i).

    (5.24), the second one, is printed with h instead of h². The proof of Prop. 5.4 takes the root of this error in
    (5.42), so it needs h².

    **Measured** are the errors for v = u(t) at fixed times, and for a smooth field v that vanishes on Γ1. This class
    judges the first one, ``InterpolationOnContact`` the second one.

    **Predicted**: both orders are sharp for piecewise linear functions, so the windows have two ends. If a gap behaves
    like s_+^α at a front, the trace lies in H^τ for τ < α + 1/2, and the predicted order on Γ3,i is min(2, α + 1/2). On
    random meshes the order from two coarse levels depends on the random size of the cells where v is strongly curved.
    Therefore on random meshes the order is fitted to all levels, with the numbers of cells as weights.
    """

    label = "(5.23)"
    claim = "‖v − Π^h v‖_V ≤ c h |v|_{H²}"

    def places(self, full: bool) -> list[Setting]:
        if not full:
            return place(named("advance-recede"), (8, 16, 32))
        cases = first_with_each(lambda case: (body_of(case), law_of(case), case.regularity.smoothness > 1))
        cases = [case for case in cases if case.regularity.smoothness > 1]
        # Graded meshes are left out: their cells at singular points are much smaller than h, which changes the order.
        return [s for s in place(cases, (8, 16, 32), (8, 12, 16), every_family=True) if s.family != Graded().name]

    def measure(self, setting: Setting) -> Numbers:
        space, solution = posed(setting)
        v_norm = ErrorNorm(solution, space, RAISED_FOR_KINKS)
        errors = {}
        for v, fraction in FUNCTIONS.items():
            sample = v_norm.sample(fraction * solution.body.T)
            errors[v] = v_norm.distance(sample, sample.interpolant)
        field = smooth(space.body)
        energies = Energies(solution, space, False, RAISED_FOR_KINKS)
        error = energies.distance(strain(field, energies.exact.x), space.interpolate(field(space.mesh.p)))
        return with_h(space.h, {**errors, SMOOTH_FIELD: error})

    def checks_of(self, case: str, groups: Groups) -> Judged:
        random, others = split(groups, "random")
        for key, v in INTERPOLATED.items():
            quantity = f"order of ‖v − Π^h v‖_V, v = {v}"
            if others:
                text = f"{quantity}, level by level"
                sharp = around(1.0, ORDER_TOLERANCE)
                yield paper_claim(key, text, level_by_level(v), sharp, levels=MIN_LEVELS, finest=True), others
            if random:
                text = f"{quantity}, random meshes, fitted"
                sharp = around(1.0, ORDER_TOLERANCE, "least squares, weighted by the number of cells")
                yield (
                    paper_claim(f"{key}-random", text, fitted(v, power=CELL_POWER), sharp, levels=MIN_LEVELS),
                    random,
                )


# (5.24): interpolation of normal traces on contact faces.


class InterpolationOnContact(ListedNumbers):
    """Measures the interpolation error of normal traces v_ν in L² on each contact face, and judges its order.

    Linear traces are left out, because they have no interpolation error.
    """

    label = "(5.24)"
    claim = "‖v_ν − Π^h v_ν‖_{L²(Γ3,i)} ≤ c h² |v_ν|_{H²(Γ3,i)}, printed with h"

    def places(self, full: bool) -> list[Setting]:
        if not full:
            return place(named("advance-recede"), (16, 32, 64))
        # Shaken meshes are left out: a few edges contribute most of the squared error Σ_e |e|⁵ |w''|²/120, so with
        # random lengths of edges the order varies by 0.3 from seed to seed.
        cases = first_with_each(lambda case: (body_of(case), case.regularity.trace))
        without = Graded().name, Shaken().name
        return [s for s in place(cases, (16, 32, 64), (16, 24, 32), every_family=True) if s.family not in without]

    def measure(self, setting: Setting) -> Numbers:
        space = space_of(setting)
        case = resolve(setting.case)
        numbers = {REGULARITY: case.regularity.trace}
        for i, face in enumerate(case.solution.faces, start=1):
            numbers[FACE_SIZE.format(i)] = induced_size(space, face.part)
            numbers |= {TRACE_ERROR.format(v, i): error for v, error in on_face(case.solution, space, face).items()}
        return with_h(space.h, numbers)

    def checks_of(self, case: str, groups: Groups) -> Judged:
        """Yield the criteria for the orders of interpolation on all contact faces, in the mesh size on the face.

        Let the normal trace lie in H^s for all s < τ. For τ > 2 the paper claims the order 2. Otherwise min(2, τ) is
        predicted.

        Args:
            case: the name of the case.
            groups: the measured tables by mesh family, with one row for each level.
        """
        columns = {str(column) for table in groups.values() for column in table}
        of_solution = min(float(table[REGULARITY].min()) for table in groups.values())
        for (name, v), face in product(INTERPOLATED.items(), range(1, len(columns))):
            key = f"{name}-face-{face}"
            column = TRACE_ERROR.format(v, face)
            size = FACE_SIZE.format(face)
            if not {size, column} <= columns:
                continue
            tau = math.inf if v == SMOOTH_FIELD else of_solution
            quantity = f"order of ‖v_ν − Π^h v_ν‖, v = {column}"
            if tau >= 2.5:
                text = "level by level"
                value = level_by_level(column)
            elif tau > 2:
                # Two refinements are judged together: the error in the cell of the front depends on where it is cut.
                text = "over two refinements"
                value = over_refinements(column, 2)
            else:
                text = "fitted"
                value = fitted(column)
            check = paper_claim(
                key,
                f"{quantity}, {text}",
                value,
                around(2.0, ORDER_TOLERANCE) if tau > 2 else around(tau, 0.3),
                levels=MIN_LEVELS,
                finest=tau >= 2.5,
                if_missed="" if tau > 2 else "the trace is not in H², so that (5.24) does not apply",
            )
            yield check, {family: table.assign(h=table[size]) for family, table in groups.items() if size in table}


def induced_size(space: Space, part: Part) -> float:
    """Return the mesh size on a boundary part Γ3,i, which follows from its measure and its number of facets.

    The mesh size is ((d − 1)! |Γ3,i| / number of facets)^{1/(d−1)} in dimension d. On unstructured meshes this size is
    not exactly proportional to h, because a part has a whole number of facets.

    Args:
        space: the space V^h, which has the mesh.
        part: the boundary part.
    """
    along = space.dim - 1
    return float((math.factorial(along) * part.measure / len(space.facets(part))) ** (1 / along))


def on_face(solution: ExactSolution, space: Space, face: Face) -> Numbers:
    """Return interpolation errors in L² of normal traces on one contact face, by the names of the functions.

    The functions are the exact displacement at the times in ``FUNCTIONS``, and a smooth field. Functions with a linear
    trace are left out, because they have no interpolation error.

    Args:
        solution: the exact solution.
        space: the space V^h, whose mesh gives the interpolant.
        face: the contact face.
    """
    rule = rule_on(space, face.part, FACET_POINTS + RAISED_FOR_KINKS, face.rough)
    fields = {v: displacement(solution, fraction * solution.body.T) for v, fraction in FUNCTIONS.items()}
    errors = {}
    for name, field in {**fields, SMOOTH_FIELD: smooth(space.body)}.items():
        difference, trace = trace_error(field, space, face.part, rule)
        error, size = (math.sqrt(np.sum(values**2 * rule.weights)) for values in (difference, trace))
        if error > NO_ERROR * size:
            errors[name] = error
    return errors


RESIDUAL_TIMES = 32
"""Number of times over which ``ResidualBound`` takes maxima of norms."""


class ResidualBound(ListedNumbers):
    """Compares the norm of the residual R of the exact solution, R(t; v) = (σ, ε(v))_Q − (f, v)_V, with its bound.

    The paper prints |R(s; v)| ≤ c (‖u‖_{W^{1,∞}(0,T;V)} + ‖f‖_{L∞(V)}) ‖v‖_V, (5.27), in which a term is missing. The
    complete bound, without an unknown constant c, is

        |R(s; v)| ≤ (‖u̇‖_{L∞(V)} + L ‖u‖_{L∞(V)} + ‖G(·, 0)‖_Q/√m_A + ‖f‖_{L∞(V)}) ‖v‖_V,     L = L_G/m_A.

    It follows from (5.13) term by term: |G ε(u)| ≤ |G(·, 0)| + L_G |ε(u)| and √m_A ‖ε(v)‖_Q ≤ ‖v‖_V. The paper leaves
    out G(·, 0), although (3.2) allows any G(·, 0) ∈ Q.

    **Measured** is the norm of R, divided by the bound, in two cases:

    * *Exact solutions.* R(s; ·) is computed from its definition as a functional on V^h, with ‖R(s)‖² = RᵀM⁻¹R. Its
      largest norm over the times is divided by the bound. ``double-well`` has a G(·, 0) that is not zero.
    * *A body at rest with a stress.* G is replaced by G(x, ε) − G(x, 0) + A ε(z) with z = −M⁻¹Nᵀμ and random μ > 0.
      There is no load and no initial displacement. Then R(s; v) = (A ε(z), ε(v))_Q, and u^h ≡ 0 solves Problem 5.1 if R
      ≥ 0 on K^h. This means that −R lies in the cone {Nᵀλ : λ ≥ 0}, which is measured as well. R is not zero, but
      the printed bound is zero for every c, because u^h and f are zero. So it is wrong.

    **Predicted**:

    * Exact solutions: quotients of 1/20 to 1/2. The bound is not attained, because the four norms are not attained
      together. R is the work of the contact force, which is as large as the load where contact carries the load.
    * A body at rest: the quotient of ‖R‖ = ‖z‖_V and ‖A ε(z)‖_Q/√m_A is at most 1. It is at least √(m_A/‖A‖), because
      ‖A ε‖_Q ≤ √‖A‖ ‖ε‖_V.

    **Found**: in ``advance-recede`` the quotient is only 0.009, because nearly all of the load bends the body away from
    the foundation. So the window for exact solutions has no lower end.
    """

    label = "(5.27)"
    claim = "|R(s; v)| ≤ c (‖u‖_{W^{1,∞}(0,T;V)} + ‖f‖_{L∞(0,T;V)} + ‖G(·, 0)‖_Q) ‖v‖_V, c and G(·, 0) explicit"
    checks = (
        paper_claim("bound", "max_s ‖R(s)‖ / the bound, exact solution", "bound", positive_at_most(1.0, "proved")),
        identity(
            "rest",
            "G(·, 0) = A ε(z): distance of −R from the contact forces / its size",
            "rest",
            positive_at_most(1e-10, "0 up to rounding: u^h ≡ 0 is the solution, although the printed bound is 0"),
        ),
        identity(
            "prestress",
            "G(·, 0) = A ε(z): ‖R‖ / (‖G(·, 0)‖_Q / √m_A)",
            "prestress",
            at_most(1 + ROUNDING_ROOM, "proved"),
        ),
        identity(
            "attained",
            "‖R‖ / (‖G(·, 0)‖_Q / √m_A) over √(m_A/‖A‖), its least possible value",
            "attained",
            Window(1 - ROUNDING_ROOM, np.inf, "over √(m_A/‖A‖)"),
        ),
    )
    quick = grid(("full-contact",), ("unstructured",), (8,))
    full = grid((*EVOLVING, "anisotropic", "hexagon", *SOFTENING), ("unstructured",), (8, 16))

    def measure(self, setting: Setting) -> Numbers:
        space, solution = posed(setting)
        problem = unloaded(space, solution.law)
        law = solution.law
        share = share_of_bound(Energies(solution, space), ErrorNorm(solution, space), problem, law)
        # The body at rest with the stress G(·, 0) = A ε(z).
        stress = prestress(space, problem, law)
        R = space.functional(stress)
        bound = np.sqrt(np.sum(space.volumes * stress**2) / law.A.ellipticity)
        of_bound = dual_norm(R, Cholesky(problem.M)) / bound
        least = np.sqrt(law.A.ellipticity / law.A.lipschitz)
        rest = beyond(-R, problem.N) / math.sqrt(R @ R)
        return with_h(space.h, {"bound": share, "rest": rest, "prestress": of_bound, "attained": of_bound / least})


def share_of_bound(energies: Energies, v_norm: ErrorNorm, problem: SemiDiscrete, law: KelvinVoigt) -> float:
    """Return the largest norm over time of the residual R, divided by the bound of ``ResidualBound``.

    The residual R(t; v) = (σ, ε(v))_Q − (f, v)_V of an exact solution, the work of the contact force, is taken as a
    functional on V^h.

    Args:
        energies: gives the exact solution and integrates over the body.
        v_norm: computes the load.
        problem: the semi-discrete problem, which has the matrix of the norm of V.
        law: the material law, which has the constants of the bound.
    """
    riesz = Cholesky(problem.M)
    exact = energies.exact
    rows = []
    for time in midpoints(v_norm.space.body.T, RESIDUAL_TIMES):
        strain = exact.strain(time)
        rate = exact.strain_rate(time)
        load = v_norm.load(time)
        residual = energies.functional(exact.law.stress(rate, strain)) - load
        of_functionals = dual_norm(np.array([residual, load]), riesz)
        rows.append([*of_functionals, energies.norm(rate), energies.norm(strain)])
    R, force, velocity, displacement = np.max(rows, axis=0)
    stress_at_zero = exact.law.G(0 * exact.strain(0.0))
    at_zero = np.sqrt(energies.work(stress_at_zero, stress_at_zero) / law.A.ellipticity)
    return float(R / (velocity + law.kappa * displacement + at_zero + force))


def prestress(space: Space, problem: SemiDiscrete, law: KelvinVoigt) -> Tensors:
    """Return the stress on the cells that random contact forces cause by the viscosity, (D, cells).

    It is A ε(z) with z = −M⁻¹Nᵀμ for random forces μ > 0, the constraint matrix N and the matrix M of (·,·)_V.

    Args:
        space: the space V^h.
        problem: the semi-discrete problem, which has M and N.
        law: the material law, which has A.
    """
    multipliers = np.random.default_rng(SEED).uniform(size=problem.N.shape[0])
    return on_cells(space, law).A(space.strain(-Cholesky(problem.M)(problem.N.T @ multipliers)))


NORM_INSTANTS = 64
"""Number of nodes of the midpoint rule by which ``ErrorBounds`` approximates norms in time."""
STRESS_ROUND_OFF = 1e-11
"""Relative tolerance for round-off: smaller contact pressures, compared with the size of the stresses, count as 0."""
BOTH_BOUNDS = "(5.21)", "(5.42)"
GROWTH_EXPONENTS = {bound: f"γ of {bound}" for bound in BOTH_BOUNDS}
"""Names of the columns with the exponents γ: (right side of the bound) / error is predicted to grow like h^{−γ}."""
RATE, TRACE = "‖η̇‖_{L²(0,T;V)}", "(‖σ_ν‖ ‖η_ν‖)^{1/2}"
"""Names of the columns with the terms of the bounds (5.21) and (5.42) that may be of lower order than the error.

η = u − Π^h u is the interpolation error of the exact solution.
"""
LOGARITHM = "τ = 2"
"""Name of the column that tells whether the bound (5.42) has a logarithmic factor.

It has one if the normal trace lies in H^s for all s < 2, but not in H² (τ = 2).
"""


class ErrorBounds(ListedNumbers):
    """Measures how far the bounds (5.21) and (5.42) exceed the error, with and without their constant c.

    (5.20)–(5.21) and (5.42): the error of the semi-discrete problem (Problem 5.1), compared with its bounds.

    The bounds are taken for v^h = Π^h u and u_0^h = Π^h u_0. The error is e = u − u^h, the interpolation error η = u −
    Π^h u. The right sides without constants are

        (5.21):  ‖η_0‖_V + ‖η̇‖_{L²(0,T;V)} + ‖R(·; −η)‖_{L¹(0,T)}^{1/2} + ‖e_0‖_V,
        (5.42):  the same sum, but the third term is (‖σ_ν‖_{L^∞(0,T;L²(Γ3))} ‖η_ν‖_{L¹(0,T;L²(Γ3))})^{1/2}.

    By (5.40) R(t; v) = ∫_{Γ3} σ_ν v_ν. The paper includes ‖σ_ν‖ in the constant c. Here ‖σ_ν‖ is part of the bound, so
    the second bound is larger than the first by (5.41). Two numbers are measured for each bound: right side / error
    under refinement, and error / (c · right side) with a constant c that is proved as follows.

    **The constant.** Let χ = Π^h u − u^h = e − η, and B the operator of (4.2). Then (5.12) says

        ½ d/dt ‖χ‖_V² ≤ −(η̇, χ)_V − (Bu − BΠ^h u, χ)_V − (BΠ^h u − Bu^h, χ)_V + |R(·; −η)|.

    By (4.3) the second product is at most L‖η‖_V ‖χ‖_V with L = L_G/m_A. The third is at most ω‖χ‖_V² with ω = max(−m,
    0)/m_A ≤ L, where m is the constant of monotonicity of G, which is 0 for monotone G. Gronwall's inequality in the
    form of Brézis, φ²/2 ≤ a²/2 + ∫ gφ ⇒ φ ≤ a + ∫ g, gives

        ‖χ(t)‖_V ≤ e^{ωT} ((‖χ_0‖_V² + 2‖R‖_{L¹})^{1/2} + ∫_0^T (‖η̇‖_V + L‖η‖_V)),

    From e = η + χ, ‖χ_0‖_V ≤ ‖e_0‖_V + ‖η_0‖_V and ‖η(s)‖_V ≤ ‖η_0‖_V + ∫_0^s ‖η̇‖_V, (5.17), it follows that

        ‖e‖_V ≤ e^{ωT} ((2 + LT) ‖η_0‖_V + ∫_0^T (2 + L(T − s)) ‖η̇(s)‖_V ds + ‖e_0‖_V + (2‖R‖_{L¹})^{1/2})
              ≤ c · (right side),   c = e^{ωT} max(2 + LT, ‖2 + L(T − ·)‖_{L²(0,T)}).

    This proof avoids (5.15) and (5.16), whose term 2‖e‖_V ‖η‖_V would make c twice as large. The bound still
    overestimates, because one constant serves several terms, and because L combines the largest slope of G with the
    smallest eigenvalue of A.

    **The ratio under refinement.** Let u(t) ∈ H^{1+s}, u̇(t) ∈ H^{1+s'} and u_ν ∈ H^τ(Γ3) (``manufactured.regularity``).
    The error has the order min(1, s). The right side has the order of its term of lowest order: min(1, s') from η̇ in
    both bounds, and in (5.42) also min(1, τ/2) from ‖η_ν‖^{1/2}. In (5.21) the contact term has at least the order of
    η̇, because only cells with a front contribute to ∫ σ_ν η_ν: elsewhere σ_ν = 0 or η_ν = 0. Let γ be the order of the
    error minus the order of the term:

    * γ = 0: the ratio does not change like a power of h.
    * γ > 0: the bound is of lower order than the error, and the ratio is **not** bounded. The term over the error grows
      like h^{−γ} (1/8 for ``rough-trace`` in (5.42), 1/4 for ``moving-rough`` in both). This exponent is judged: it
      must be nearer to γ than to 0 or 2γ. Smoother parts, of a relative size h^{1/2}, change γ on coarse meshes, and
      the place of a fixed front within its cell changes the term by a tenth. So the meshes are fine and structured, and
      a fixed front, which is at 2/5 of the side, lies at 2/5 of a cell on all of them. A moving front passes all
      positions in cells.
    * τ = 2, where ‖η_ν‖ ~ h² |log h|^{1/2} (``natural-front``): the term grows like |log h|^{1/4}, no power of h. A few
      meshes cannot distinguish it from a constant, so the change is reported and no bound is claimed.
    """

    label = "(5.20)–(5.21), (5.42)"
    claim = "‖u − u^h‖_{L∞(0,T;V)} ≤ c (‖u_0 − v_0^h‖_V + ‖u̇ − v̇^h‖_{L²(0,T;V)} + ‖R‖^{1/2}) + c ‖u_0 − u_0^h‖_V"
    quick = grid(("full-contact", "advance-recede"), ("shaken",), (6, 12, 24))
    full = (
        *grid((*EVOLVING, "rough-1.75"), ("one-diagonal",), (8, 16, 32)),
        *grid((*EVOLVING, "rough-1.75", *SOFTENING, "heterogeneous", "corner"), ("unstructured",), (8, 16, 32)),
        *grid(("natural-front", "rough-trace"), ("one-diagonal",), (16, 36, 81)),
        *grid(("moving-rough",), ("one-diagonal",), (64, 128, 256)),
    )

    def setup(self, setting: Setting) -> Experiment:
        case = resolve(setting.case)
        return Experiment.at(setting, MIDPOINT, rate_steps(case.solution.body.T, setting.level, case.pace))

    def measure(self, setup: Experiment) -> Numbers:
        return with_h(setup.space.h, sides(setup))

    def records(self, setting: Setting, found: Row) -> Records:
        """Yield the rows of ``statements.csv``, with the predictions for the case as further numbers."""
        return super().records(setting, {**found, **predicted(resolve(setting.case))})

    def checks_of(self, case: str, groups: Groups) -> Judged:
        """Yield two criteria for each of the bounds (5.21) and (5.42).

        The first one is error ≤ c · (right side). The second one is about the change of (right side) / error under
        refinement, and depends on the predicted exponent γ of the case: this quotient is predicted to grow like h^{−γ}.

        Args:
            case: the name of the case.
            groups: the measured tables by mesh family, with one row for each level.
        """
        (table, *_) = groups.values()
        names = *GROWTH_EXPONENTS.values(), LOGARITHM
        known = {name: table[name].iloc[0] if name in table else math.nan for name in names}
        for bound, column in GROWTH_EXPONENTS.items():
            number = bound.strip("()")
            gamma = known[column]
            quantity = f"right-hand side of {bound} / error: change under refinement"
            steady = consequence(
                f"steady-{number}",
                quantity,
                changing(bound, column),
                Window(0.7, 1.4, "over two refinements: the orders differ by less than 1/4"),
                levels=MIN_LEVELS,
            )
            if gamma > 0:
                term = RATE if gamma == known[GROWTH_EXPONENTS["(5.21)"]] else TRACE
                lower = f"{bound} is of lower order than the error: p in {term} / error ~ h^{{−p}}"
                window = around(gamma, gamma / 2, f"nearer to {gamma:g} than to 0 or {2 * gamma:g}")
                power = of_errors(term, lambda h, ratio: -fit(h, ratio))
                yield consequence(f"growth-{number}", lower, power, window, levels=MIN_LEVELS), groups
            elif bound == "(5.42)" and known[LOGARITHM] > 0:
                lower = f"{quantity}, of lower order by |log h|^{{1/4}}"
                yield replace(steady, quantity=lower, if_missed="a few levels cannot show a logarithm"), groups
            else:
                yield steady, groups
            share = f"error / (c · right side of {bound})"
            yield (
                paper_claim(
                    f"constant-{number}",
                    share,
                    f"{bound}, c",
                    positive_at_most(1.0, "with the constant c of the proof"),
                ),
                groups,
            )


def changing(bound: str, prediction: str) -> Value:
    """Return the function that computes bound/error on the finest level divided by bound/error on the coarsest level.

    It is for bounds of the same order as the error, for which about 1 is expected. The function maps a table with one
    row for each level to this number.

    Args:
        bound: the column with the quotient of the bound and the error.
        prediction: the column with the exponent γ for which bound/error is predicted to grow like h^{−γ}. Its values
            are not used, but without this column γ is unknown. The function then raises KeyError, so nothing is judged.
    """
    growth = change(bound)
    return lambda table: growth(table[[bound, prediction]])


def predicted(case: Case) -> Numbers:
    """Return the predictions for a case, by the names of columns.

    For each of the bounds (5.21) and (5.42), a column has the exponent γ for which bound / error is predicted to grow
    like h^{−γ}. One more column tells whether the bound (5.42) has a logarithmic factor.
    """
    regularity = case.regularity
    proved = {"(5.21)": regularity.rate_smoothness, "(5.42)": regularity.proved_order}
    growth = {column: max(case.order - proved[bound], 0.0) for bound, column in GROWTH_EXPONENTS.items()}
    return {**growth, LOGARITHM: float(regularity.trace == 2)}


def constant(law: KelvinVoigt, T: float) -> float:
    """Return the constant c of the error estimate that ``ErrorBounds`` proves: error ≤ c · (right side).

    Args:
        law: the material law.
        T: the final time.
    """
    L = law.kappa
    omega = law.growth
    on_rate = math.sqrt(4 * T + 2 * L * T**2 + L**2 * T**3 / 3)
    return math.exp(omega * T) * max(2 + L * T, on_rate)


def sides(setup: Experiment) -> Numbers:
    """Return two quotients for each of the bounds (5.21) and (5.42): (right side)/error and error/(c · right side).

    The right side contains no constant, and c is the constant that ``ErrorBounds`` proves.

    Args:
        setup: the experiment, whose problem is solved here.

    Returns:
        The quotients by the names of columns.
    """
    v_norm = setup.v_norm
    problem = setup.problem
    T = problem.T
    error = v_norm.largest(time_nodes(T, setup.steps), path(problem, setup.scheme, setup.steps))
    start = v_norm.sample(0.0)
    energies = Energies(setup.solution, setup.space, aligned=False)
    times = midpoints(T, NORM_INSTANTS)
    k = T / NORM_INSTANTS
    # The work of contact ∫ σ_ν (u_ν − Π^hu_ν) and the squared norms ∫ |u_ν − Π^hu_ν|² and ∫ |σ_ν|² over Γ3.
    integrals = np.zeros((3, NORM_INSTANTS))
    for face in setup.solution.faces:
        rule = rule_on(setup.space, face.part, FACET_POINTS, face.rough)
        exact = setup.solution.on(face, rule.s)
        eta, _ = trace_error(displacement(setup.solution, times), setup.space, face.part, rule)
        pressure = exact.pressure(times)
        pressure = np.where(abs(pressure) > STRESS_ROUND_OFF * exact.stress_scale(), pressure, 0.0)
        integrals += [np.tensordot(rule.weights, values, axes=2) for values in (pressure * eta, eta**2, pressure**2)]
    works, squares, pressures = integrals
    rate = math.sqrt(k * np.sum(energies.velocity_error(times) ** 2))
    common = v_norm.distance(start, start.interpolant) + rate + v_norm.distance(start, problem.u0)
    work = math.sqrt(k * np.sum(abs(works)))
    trace = math.sqrt(k * np.sum(np.sqrt(squares)) * np.sqrt(pressures).max())
    right = {"(5.21)": common + work, "(5.42)": common + trace}
    c = constant(setup.solution.law, T)
    return {
        **{name: value / error for name, value in {**right, RATE: rate, TRACE: trace}.items()},
        **{f"{name}, c": error / (c * value) for name, value in right.items()},
    }
