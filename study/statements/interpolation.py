"""Interpolation errors of P1 elements, in V (5.23) and on the contact faces (5.24).

The paper states for v ∈ V that

    ‖v − Π^h v‖_V = O(h)  for v ∈ H²(Ω)^d,      ‖v_ν − (Π^h v)_ν‖_{L²(Γ3,i)} = O(h²)  for v_ν ∈ H²(Γ3,i).

The orders are measured for v = u(t) at fixed times, and for a smooth field v that vanishes on Γ1. Both orders are sharp
for piecewise linear functions, so the windows have two ends. (5.24) is printed with h instead of h². The proof of Prop.
5.4 takes the root of this error in (5.42), so it needs h². If a gap behaves like s_+^α at a front, the trace lies in
H^τ for τ < α + 1/2, and the predicted order is min(2, α + 1/2).
"""

import math
from itertools import product

import numpy as np

from manufactured.body import Body, Kind, Part
from manufactured.exact import ExactSolution, Face
from study.fem.error_norm import DEGREE, FACET_POINTS, ErrorNorm, rules
from study.fem.mesh import Graded, Shaken
from study.fem.naming import resolve
from study.fem.quadrature import facet_rule
from study.fem.space import Space
from study.ledger.check import ENOUGH, Groups, paper_claim
from study.ledger.quantities import fitted, level_by_level, over_refinements
from study.ledger.window import around
from study.statements.boundary import Field, planes, strain, vanishing, waves
from study.statements.shared.base import SEED, Judged, ListedNumbers, Numbers, Setting, with_h
from study.statements.shared.meshes import (
    CELLS,
    EVERY,
    body_of,
    first_with_each,
    law_of,
    named,
    place,
    posed,
    space_of,
    split_random,
)
from study.statements.shared.scope import REGULAR

TIMES = (0.23, 0.61)
"""Times at which exact solutions are interpolated, as fractions of the final time T.

In no case does contact begin or end at these times."""
RAISED = 2
"""How much the degree of quadrature rules on cells and the number of points on facets are raised.

More accurate rules are needed, because kinks of the solution cross cells and facets."""
ROUND_OFF = 1e-10
"""Relative errors below this number count as round-off.

They occur if a trace is zero or linear, so that it has no interpolation error."""
ROOM = 0.15
"""Tolerance for observed orders.

They scatter, because fronts cut cells at different places on each level and the meshes are not nested."""

SMOOTH = "a smooth field"
INSTANTS = {f"u({fraction:g} T)": fraction for fraction in TIMES}
"""The times t of the interpolated functions u(t), as fractions of T, by the names of these functions in columns."""
FIELDS = {"smooth": SMOOTH, **{f"u-{fraction}": v for v, fraction in INSTANTS.items()}}
"""Names of the interpolated functions in columns, by the keys of the checks."""
REGULARITY = "τ"
"""Name of the column with the regularity τ of the trace: v_ν ∈ H^s(Γ3,i) for all s < τ."""
SIZE, TRACE = "size of Γ3,{}", "{} on Γ3,{}"
"""Names of the columns for one contact face: its mesh size, and the interpolation error of a trace on it."""


def smooth(body: Body) -> Field:
    """Return a smooth random displacement field that vanishes on the clamped boundary Γ1."""
    return vanishing(waves(body, np.random.default_rng(SEED)), planes(body, Kind.CLAMPED))


# (5.23): interpolation in V.


SHARP = around(1.0, ROOM)
"""Tolerance window of the order in V, which is 1 for piecewise linear functions."""


class InterpolationInV(ListedNumbers):
    """Measures the interpolation error ‖v − Π^h v‖_V for solutions in H² on each cell, and judges its order.

    On random meshes the order from two coarse levels depends on the random size of the cells where v is strongly
    curved. Therefore on random meshes the order is fitted to all levels, with the numbers of cells as weights.
    """

    label = "(5.23)"
    claim = "‖v − Π^h v‖_V ≤ c h |v|_{H²}"

    def places(self, full: bool) -> list[Setting]:
        if not full:
            return place(named("advance-recede"), REGULAR, (8, 16, 32))
        cases = first_with_each(lambda case: (body_of(case), law_of(case), case.regularity.smoothness > 1))
        cases = [case for case in cases if case.regularity.smoothness > 1]
        # Graded meshes are left out: their cells at singular points are much smaller than h, which changes the order.
        return [s for s in place(cases, EVERY, (8, 16, 32), (8, 12, 16)) if s.family != Graded().name]

    def measure(self, setting: Setting) -> Numbers:
        space, solution = posed(setting)
        v_norm = ErrorNorm(solution, space, RAISED)
        samples = {v: v_norm.sample(fraction * solution.body.T) for v, fraction in INSTANTS.items()}
        errors = {v: v_norm.distance(sample, sample.interpolant) for v, sample in samples.items()}
        return with_h(space.h, {**errors, SMOOTH: distance_in_V(solution, space, smooth(space.body))})

    def checks_of(self, case: str, groups: Groups) -> Judged:
        by_cells = around(1.0, ROOM, "least squares, weighted by the number of cells")
        random, others = split_random(groups)
        for key, v in FIELDS.items():
            quantity = f"order of ‖v − Π^h v‖_V, v = {v}"
            by_level = level_by_level(v)
            if others:
                check = paper_claim(key, f"{quantity}, level by level", by_level, SHARP, levels=ENOUGH, finest=True)
                yield check, others
            if random:
                quantity = f"{quantity}, random meshes, fitted"
                order = fitted(v, power=CELLS)
                yield paper_claim(f"{key}-random", quantity, order, by_cells, levels=ENOUGH), random


def distance_in_V(solution: ExactSolution, space: Space, field: Field) -> float:
    """Return the interpolation error ‖v − Π^h v‖_V of a smooth field v.

    Args:
        solution: the exact solution, whose viscosity defines the norm.
        space: the P1 space.
        field: the field, analytic in x.
    """
    interpolant = space.strain(space.interpolate(field(space.mesh.p)))
    total = 0.0
    for rule in rules(solution, space.mesh, DEGREE + RAISED):
        difference = strain(field, rule.points) - interpolant[:, rule.cells, None]
        viscous = solution.law.A.at(rule.points)(difference)
        total += np.einsum("Inq,Inq,nq->", viscous, difference, rule.weights)
    return math.sqrt(total)


# (5.24): interpolation of normal traces on contact faces.


class InterpolationOnContact(ListedNumbers):
    """Measures the interpolation error of normal traces v_ν in L² on each contact face, and judges its order.

    Linear traces are left out, because they have no interpolation error.
    """

    label = "(5.24)"
    claim = "‖v_ν − Π^h v_ν‖_{L²(Γ3,i)} ≤ c h² |v_ν|_{H²(Γ3,i)}, printed with h"

    def places(self, full: bool) -> list[Setting]:
        if not full:
            return place(named("advance-recede"), REGULAR, (16, 32, 64))
        # Shaken meshes are left out: a few edges contribute most of the squared error Σ_e |e|⁵ |w''|²/120, so with
        # random lengths of edges the order varies by 0.3 from seed to seed.
        cases = first_with_each(lambda case: (body_of(case), case.regularity.trace))
        without = Graded().name, Shaken().name
        return [s for s in place(cases, EVERY, (16, 32, 64), (16, 24, 32)) if s.family not in without]

    def measure(self, setting: Setting) -> Numbers:
        space = space_of(setting)
        case = resolve(setting.case)
        found = {REGULARITY: case.regularity.trace}
        for i, face in enumerate(case.solution.faces, start=1):
            found[SIZE.format(i)] = induced_size(space, face.part)
            found |= {TRACE.format(v, i): error for v, error in on_face(case.solution, space, face).items()}
        return with_h(space.h, found)

    def checks_of(self, case: str, groups: Groups) -> Judged:
        """Yield the criteria for the orders on all faces, in the mesh size on the face.

        For τ > 2 the paper claims the order 2. Otherwise min(2, τ) is predicted.
        """
        columns = {str(column) for table in groups.values() for column in table}
        of_solution = min(float(table[REGULARITY].min()) for table in groups.values())
        claimed = around(2.0, ROOM)
        for (name, v), face in product(FIELDS.items(), range(1, len(columns))):
            key = f"{name}-face-{face}"
            column = TRACE.format(v, face)
            size = SIZE.format(face)
            if not {size, column} <= columns:
                continue
            tau = math.inf if v == SMOOTH else of_solution
            quantity = f"order of ‖v_ν − Π^h v_ν‖, v = {column}"
            if tau >= 2.5:
                text = "level by level"
                value = level_by_level(column)
                window = claimed
            elif tau > 2:
                # Two refinements are judged together: the error in the cell of the front depends on where it is cut.
                text = "over two refinements"
                value = over_refinements(column, 2)
                window = claimed
            else:
                text = "fitted"
                value = fitted(column)
                window = around(tau, 0.3)
            unclaimed = "" if tau > 2 else "the trace is not in H², so that (5.24) does not apply"
            check = paper_claim(
                key, f"{quantity}, {text}", value, window, levels=ENOUGH, finest=tau >= 2.5, if_missed=unclaimed
            )
            yield check, {family: table.assign(h=table[size]) for family, table in groups.items() if size in table}


def induced_size(space: Space, part: Part) -> float:
    """Return the mesh size on a boundary part Γ3,i, which follows from its measure and its number of facets.

    The mesh size is ((d − 1)! |Γ3,i| / number of facets)^{1/(d−1)}. On unstructured meshes this size is not exactly
    proportional to h, because a part has a whole number of facets.
    """
    along = space.dim - 1
    return float((math.factorial(along) * part.measure / len(space.facets(part))) ** (1 / along))


def on_face(solution: ExactSolution, space: Space, face: Face) -> Numbers:
    """Return interpolation errors in L² of normal traces on one contact face, by the names of the functions.

    Functions with a linear trace are left out.
    """
    mesh = space.mesh
    facets = space.facets(face.part)
    rule = facet_rule(mesh, facets, face.part, face.rough, FACET_POINTS + RAISED)
    x = face.part.point(rule.s)
    vertices = mesh.p[:, mesh.facets[:, facets]]
    exact = solution.at(x)
    nodes = solution.at(vertices)
    field = smooth(space.body)
    times = {v: fraction * solution.body.T for v, fraction in INSTANTS.items()}
    pairs = {v: (exact.displacement(time), nodes.displacement(time)) for v, time in times.items()}
    found = {}
    for name, (inside, nodal) in {**pairs, SMOOTH: (field(x), field(vertices))}.items():
        trace, corners = (np.tensordot(face.part.normal, v, axes=1) for v in (inside, nodal))
        difference = trace - np.einsum("an,anq->nq", corners, rule.shapes)
        error, size = (math.sqrt(np.sum(values**2 * rule.weights)) for values in (difference, trace))
        if error > ROUND_OFF * size:
            found[name] = error
    return found
