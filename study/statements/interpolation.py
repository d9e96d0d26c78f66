"""Interpolation in V, (5.23), and on the pieces of Γ3, (5.24).

For v(t) = u(t) at fixed times and for a smooth field that vanishes on Γ1,

    ‖v − Π^h v‖_V = O(h)  for v ∈ H²(Ω)^d,      ‖v_ν − (Π^h v)_ν‖_{L²(Γ3,i)} = O(h²)  for v_ν ∈ H²(Γ3,i).

Both are sharp for piecewise linear functions, so orders are judged from both sides. (5.24) is printed with h, not h²:
the proof of Prop. 5.4 takes its root in (5.42) and so needs h². Traces with w ~ s_+^α at a front lie in H^τ for
τ < α + 1/2, and have the order min(2, α + 1/2).
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pandas as pd

from manufactured.body import Body, Kind, Part
from manufactured.exact import ExactSolution, Face
from study.fem.error_norm import DEGREE, FACET_POINTS, ErrorNorm, rules
from study.fem.mesh import Graded, Shaken
from study.fem.naming import resolve
from study.fem.quadrature import facet_rule
from study.fem.space import Space
from study.ledger.criterion import (
    ENOUGH,
    Criterion,
    Measured,
    Observation,
    Rule,
    between_levels,
    by_case,
    consecutive,
    order,
    weighted,
)
from study.ledger.verdict import Verdict
from study.ledger.window import around
from study.statements.boundary import Field, planes, strain, vanishing, waves
from study.statements.shared.base import SEED, ListedNumbers, Setting, with_h
from study.statements.shared.meshes import BODIES_WITH_LAWS, CELLS, EVERY, named, place, space_of, split_random

TIMES = (0.23, 0.61)
"""Fractions of T between the events of all cases."""
RAISED = 2
"""Additional degrees of cell rules and points on facets, since kinks cross cells and facets."""
ROUND_OFF = 1e-10
"""Relative errors smaller than this are rounding: traces that are zero or linear have no error with an order."""
TRACES = (
    "full-contact",
    "fixed-front-on-vertex",
    "advance-recede",
    "rotated",
    "corner",
    "contact-at-clamp",
    "hexagon",
    "cube-disc",
    "cube-two-faces",
    "natural-front",
    "rough-trace",
    "moving-rough",
    "cube-rough",
    "rough-1.75",
    "rough-2",
    "rough-2.25",
    "re-entrant",
    "junction",
    "softening",
)
"""One case for every pair of a body and a regularity of the trace on Γ3."""
ROOM = 0.15
"""Tolerance for orders: fronts cut cells at different places on each level, and meshes that are not nested differ by
chance."""


SMOOTH = "a smooth field"
FIELDS = {"smooth": SMOOTH, **{f"u-{fraction}": f"u({fraction:g} T)" for fraction in TIMES}}
"""Key of a row ↦ name of its v."""
REGULARITY = "τ"
"""Column: v_ν ∈ H^s(Γ3,i) for s < τ, from the exponents of the case."""


def at(fraction: float) -> str:
    """Return the name of u at a fraction of T."""
    return FIELDS[f"u-{fraction}"]


def size_of(face: int) -> str:
    """Return the column of the mesh size on Γ3,i."""
    return f"size of Γ3,{face}"


def trace_of(v: str, face: int) -> str:
    """Return the column of the error of v_ν on Γ3,i."""
    return f"{v} on Γ3,{face}"


def smooth(body: Body) -> Field:
    """Return waves times the distance to Γ1, a field in V."""
    return vanishing(waves(body, np.random.default_rng(SEED)), planes(body, Kind.CLAMPED))


# (5.23).


class InterpolationInV(ListedNumbers):
    """Orders of ‖v − Π^h v‖_V, for the cases with u(t) ∈ H² on each cell.

    On random meshes the order of two coarse levels depends on which cells lie where v bends. There one order of all
    levels is judged, with the numbers of cells as weights.
    """

    label = "(5.23)"
    claim = "‖v − Π^h v‖_V ≤ c h |v|_{H²}"

    def places(self, full: bool) -> list[Setting]:
        if not full:
            return place(named("no-contact", "advance-recede"), EVERY, (8, 16, 32))
        cases = [case for case in named(*BODIES_WITH_LAWS) if case.regularity.smoothness > 1]
        # Graded meshes have cells smaller than h at singular points.
        return [s for s in place(cases, EVERY, (8, 16, 32), (8, 12, 16)) if s.family != Graded().name]

    def measure(self, setting: Setting) -> dict[str, float]:
        space, solution = space_of(setting), resolve(setting.case).solution
        v_norm = ErrorNorm(solution, space, RAISED)
        samples = {at(fraction): v_norm.sample(fraction * solution.body.T) for fraction in TIMES}
        found = {name: v_norm.distance(sample, sample.interpolant) for name, sample in samples.items()}
        return with_h(space.h, {**found, SMOOTH: distance_in_V(solution, space, smooth(space.body))})

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        by_cells = around(1.0, ROOM, "least squares, weighted by the number of cells")
        found = []
        for case, groups in by_case(rows):
            random, others = split_random(groups)
            for key, v in FIELDS.items():
                quantity = f"order of ‖v − Π^h v‖_V, v = {v}"
                if others:
                    rule = consecutive(key, f"{quantity}, level by level", around(1.0, ROOM), v)
                    found.append(rule.verdict(self, case, others))
                if random:
                    rule = weighted(f"{key}-random", f"{quantity}, random meshes, fitted", by_cells, v, CELLS)
                    found.append(rule.verdict(self, case, random))
        return found


def distance_in_V(solution: ExactSolution, space: Space, field: Field) -> float:
    """Return ‖v − Π^h v‖_V for a field v that is analytic in x."""
    interpolant, total = space.strain(space.interpolate(field(space.mesh.p))), 0.0
    for rule in rules(solution, space.mesh, DEGREE + RAISED):
        difference = strain(field, rule.points) - interpolant[:, rule.cells, None]
        viscous = solution.law.A.at(rule.points)(difference)
        total += float(np.einsum("Inq,Inq,nq->", viscous, difference, rule.weights))
    return float(np.sqrt(total))


# (5.24).


class InterpolationOnContact(ListedNumbers):
    """Orders of ‖v_ν − (Π^h v)_ν‖_{L²(Γ3,i)}, where v_ν is not linear."""

    label = "(5.24)"
    claim = "‖v_ν − Π^h v_ν‖_{L²(Γ3,i)} ≤ c h² |v_ν|_{H²(Γ3,i)}, printed with h"

    def places(self, full: bool) -> list[Setting]:
        # The squared error is Σ_e |e|⁵ |w''|²/120 over edges, and few edges make most of it. Where their lengths are
        # random, as on shaken meshes, orders scatter by 0.3 from seed to seed.
        traces, without = named(*(TRACES if full else ("advance-recede", "rough-2"))), (Graded().name, Shaken().name)
        return [s for s in place(traces, EVERY, (16, 32, 64), (8, 16, 24)) if s.family not in without]

    def measure(self, setting: Setting) -> dict[str, float]:
        space, case = space_of(setting), resolve(setting.case)
        found = {REGULARITY: case.regularity.trace}
        for i, face in enumerate(case.solution.faces, start=1):
            found[size_of(i)] = induced_size(space, face.part)
            found |= {trace_of(name, i): error for name, error in on_face(case.solution, space, face).items()}
        return with_h(space.h, found)

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        found = []
        for case, groups in by_case(rows):
            columns = {str(column) for table in groups.values() for column in table}
            tau = min(float(table[REGULARITY].min()) for table in groups.values())
            found += [
                on_trace(key, v, face, math.inf if v == SMOOTH else tau).verdict(self, case, groups)
                for key, v in FIELDS.items()
                for face in range(1, len(columns))
                if {size_of(face), trace_of(v, face)} <= columns
            ]
        return found


def on_trace(key: str, v: str, face: int, tau: float) -> Rule:
    """Return the criterion of a trace: order 2 is claimed for τ > 2, min(2, τ) is predicted for the others."""
    key, name = f"{key}-face-{face}", trace_of(v, face)
    quantity = f"order of ‖v_ν − Π^h v_ν‖, v = {name}"
    if tau >= 2.5:
        return in_induced_size(consecutive(key, f"{quantity}, level by level", around(2.0, ROOM), name), face)
    if tau > 2:
        # The error in the cell of the front, where w'' is not bounded, depends on where the front cuts the cell.
        over_two = between_levels(key, f"{quantity}, over two refinements", around(2.0, ROOM), name, 2, ENOUGH)
        return in_induced_size(over_two, face)
    criterion = in_induced_size(order(key, f"{quantity}, fitted", around(tau, 0.3), name), face)
    return Observation(criterion, "the trace is not in H², so that (5.24) does not apply")


def in_induced_size(criterion: Criterion, face: int) -> Criterion:
    """Return the criterion with the mesh size on Γ3,i for h."""

    def measure(table: pd.DataFrame) -> Measured | None:
        return criterion.measure(table.assign(h=table[size_of(face)]))

    return replace(criterion, measure=measure, columns=(*criterion.columns, size_of(face)))


def induced_size(space: Space, part: Part) -> float:
    """Return the mesh size on a part, ((d − 1)! |Γ3,i| / number of facets)^{1/(d−1)}.

    Unstructured meshes divide each part into a whole number of facets, so it is not quite proportional to h.
    """
    along = space.dim - 1
    return float((math.factorial(along) * part.measure / len(space.facets(part))) ** (1 / along))


def on_face(solution: ExactSolution, space: Space, face: Face) -> dict[str, float]:
    """Return ‖v_ν − (Π^h v)_ν‖_{L²(Γ3,i)} for each v whose trace is not linear."""
    mesh, facets = space.mesh, space.facets(face.part)
    rule = facet_rule(mesh, facets, face.part, face.rough, FACET_POINTS + RAISED)
    x, vertices = face.part.point(rule.s), mesh.p[:, mesh.facets[:, facets]]
    exact, nodes, field = solution.at(x), solution.at(vertices), smooth(space.body)
    times = {at(fraction): fraction * solution.body.T for fraction in TIMES}
    pairs = {name: (exact.displacement(time), nodes.displacement(time)) for name, time in times.items()}
    found = {}
    for name, (values, nodal) in {**pairs, SMOOTH: (field(x), field(vertices))}.items():
        trace, corners = (np.tensordot(face.part.normal, v, axes=1) for v in (values, nodal))
        difference = trace - np.einsum("an,anq->nq", corners, rule.shapes)
        error = float(np.sqrt(np.sum(difference**2 * rule.weights)))
        if error > ROUND_OFF * float(np.sqrt(np.sum(trace**2 * rule.weights))):
            found[name] = error
    return found
