"""(5.13), (5.40), (5.41): the residual R from its definition, and as the integral over Γ3 that bounds it.

By (5.13) with (3.12) and (3.7)

    R(t; v) = (σ(t), ε(v))_Q − (f_0(t), v)_H − (f_2(t), v)_{L²(Γ2)},   v ∈ V,

which does not contain σ_ν on Γ3. Prop. 5.4 uses R(t; v) = ∫_{Γ3} σ_ν v_ν, (5.40), and the bound of this integral by the
Cauchy–Schwarz inequality, (5.41). Here R is computed from its definition, so both can fail. They are measured at the
times of ``green`` for

* smooth fields v that vanish on Γ1 and nowhere else: not in V^h, with v_ν of any sign on Γ3;
* v = Π^h u − u, which (5.42) needs: all terms are small, and R is much smaller than each.

The defect |R(t; v) − ∫_{Γ3} σ_ν v_ν| is relative to the smallest non-zero term of both sides. For v = Π^h u − u it is
relative to the smallest term of the definition, because σ_ν v_ν is nearly zero. So a missing term gives at least 1, and
a wrong sign at least 2. Only the quadrature error of the fine rules remains, so the windows are the windows of
``green``: round-off if f_0 is smooth except on lines along which cells are cut, a tenth if f_0 jumps along curves. For
v = Π^h u − u round-off is larger by 1/h, because (σ, ε(v))_Q = O(h²) is a sum of terms O(h).

The quotient of |R| and its bound is 0/0 if σ_ν = 0, so only times with σ_ν ≠ 0 are used. A case without contact at any
time has no row on (5.41), which is then 0 ≤ 0. The row is undecided if a case with contact has no contact at these
times.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from manufactured.body import Kind, Part
from manufactured.catalogue import catalogue
from manufactured.exact import ExactSolution
from manufactured.tensors import Array, Tensors, Vectors
from study.fem.error_norm import rules
from study.fem.mesh import barycentric
from study.fem.naming import resolve
from study.fem.quadrature import CellRule, FacetRule, facet_rule
from study.fem.space import Space
from study.ledger.criterion import Criterion, Measured, finest, greatest, judge
from study.ledger.verdict import Verdict
from study.ledger.window import Window, positive_at_most
from study.statements.boundary import planes, strain, vanishing, waves
from study.statements.green import (
    FINE,
    KINKED,
    ROUND_OFF,
    SMOOTH,
    TIMES,
    by_smoothness,
    cut_at_fronts,
    smallest_positive,
    smooth_off_lines,
    square_integrable,
)
from study.statements.shared.base import SEED, ListedNumbers, Setting, with_h
from study.statements.shared.meshes import IRREGULAR, named, place, space_of
from study.statements.shared.norms import maximum, midpoints
from study.statements.shared.scope import REGULAR

FIELDS = 3
"""Number of smooth fields v."""
POINTS = 20
"""Gauss points on a facet, exact to degree 39: p ~ (c − s)_+² on a facet graded to c has degree 31."""
INSTANTS = 64
"""Number of times at which contact is looked for."""
CANCELLING = positive_at_most(1e-8, "with the fine quadrature rule: 1/h times 1e-10 for a smooth f_0")
BOUND = positive_at_most(1 + 1e-9, "by the Cauchy–Schwarz inequality")


class Residual(ListedNumbers):
    """Compares R, computed by its definition, with the integral over Γ3 and with its bound; cases with f_0(t) ∈ H."""

    label = "(5.40), (5.41)"
    claim = "R(t; v) = ∫_{Γ3} σ_ν v_ν for v ∈ V; then |R(t; v)| ≤ ‖σ_ν‖ ‖v_ν‖ by the Cauchy–Schwarz inequality"

    def places(self, full: bool) -> list[Setting]:
        if full:
            cases = [case for case in catalogue() if square_integrable(case)]
            # In space the defect in cells that a front cuts depends on where it cuts them: by a factor of three on
            # random meshes of twelve cells.
            return place(cases, IRREGULAR, (8, 16)) + place(cases, REGULAR, (), (8, 15))
        return place(named("full-contact", "fixed-front-off-vertex", "yield-and-release"), IRREGULAR, (8,))

    def measure(self, setting: Setting) -> dict[str, float]:
        space, case = space_of(setting), resolve(setting.case)
        return with_h(space.h, {**defects(case.solution, space), "smooth": smooth_off_lines(case)})

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        smooth, kinked = by_smoothness(rows)
        found = judge(self, smooth, rules_for(SMOOTH, CANCELLING)) + judge(self, kinked, rules_for(KINKED, KINKED))
        measured = set(rows.loc[rows["quantity"] == "bound", "case"])
        return [verdict for verdict in found if verdict.key != SHARE.key or verdict.case in measured]


def share(group: pd.DataFrame) -> Measured | None:
    """Return the largest quotient of |R| and its bound; None if a level has no time with contact."""
    return greatest(group["bound"].to_numpy()) if group["bound"].notna().all() else None


SHARE = Criterion("bound", "|R(t; v)| / (‖σ_ν‖_{L²(Γ3)} ‖v_ν‖_{L²(Γ3)})", BOUND, share, ("bound",))


def rules_for(window: Window, cancelling: Window) -> tuple[Criterion, ...]:
    """Return the criteria of a case, with the windows for smooth v and for v = Π^h u − u."""
    return (
        finest("smooth", "|R(t; v) − ∫_{Γ3} σ_ν v_ν| / smallest term, smooth v", window, "smooth v"),
        finest("remainder", "|R(t; v) − ∫_{Γ3} σ_ν v_ν| / smallest term of R, v = Π^hu − u", cancelling, "Π^hu − u"),
        SHARE,
    )


def defects(solution: ExactSolution, space: Space) -> dict[str, float]:
    """Return the largest defects over the times, and the largest |R| / bound, which is NaN without contact."""
    found: dict[str, list[float]] = {"smooth v": [], "Π^hu − u": [], "bound": []}
    for time in (fraction * solution.body.T for fraction in TIMES):
        cut = cut_at_fronts(solution, time)
        R = terms(cut, space, time, [*smooth_fields(space), interpolation_error(cut, space, time)])
        found["bound"] += R.shares.tolist()
        for name, v, sizes in (
            ("smooth v", slice(FIELDS), (R.stress, R.body, R.loaded, R.contact)),
            ("Π^hu − u", slice(FIELDS, None), (R.stress, R.body, R.loaded)),
        ):
            defect = float(np.linalg.norm((R.residual - R.contact)[v]))
            found[name].append(defect / smallest_positive([float(np.linalg.norm(size[v])) for size in sizes]))
    if not touches(solution, space):
        del found["bound"]
    return {name: maximum(values) if values else math.nan for name, values in found.items()}


FunctionOfV = tuple[Callable[[CellRule], tuple[Vectors, Tensors]], Callable[[Part, FacetRule], Vectors]]
"""A function v ∈ V at one time, as two functions.

The first returns the values of v (d, cells, points) and the strains (D, cells, points) at the points of a cell rule.
The second returns the values of v at the points of a facet rule on a part of the boundary, (d, facets, points).
"""


def smooth_fields(space: Space) -> list[FunctionOfV]:
    """Return random waves that vanish on Γ1."""
    rng, clamped = np.random.default_rng(SEED), planes(space.body, Kind.CLAMPED)

    def wave() -> FunctionOfV:
        v = vanishing(waves(space.body, rng), clamped)
        return lambda rule: (v(rule.points), strain(v, rule.points)), lambda part, rule: v(part.point(rule.s))

    return [wave() for _ in range(FIELDS)]


def interpolation_error(solution: ExactSolution, space: Space, time: float) -> FunctionOfV:
    """Return v = Π^h u(t) − u(t)."""
    mesh, nodal = space.mesh, solution.at(space.mesh.p).displacement(time)
    strains = space.strain(space.interpolate(nodal))

    def inside(rule: CellRule) -> tuple[Vectors, Tensors]:
        exact, corners = solution.at(rule.points), nodal[:, mesh.t[:, rule.cells]]
        values = np.einsum("din,inq->dnq", corners, barycentric(mesh, rule.cells, rule.points))
        return values - exact.displacement(time), strains[:, rule.cells, None] - exact.strain(time)

    def on(part: Part, rule: FacetRule) -> Vectors:
        exact = solution.at(part.point(rule.s)).displacement(time)
        return np.einsum("dan,anq->dnq", nodal[:, mesh.facets[:, rule.facets]], rule.shapes) - exact

    return inside, on


@dataclass(frozen=True, eq=False)
class Terms:
    """The terms of R for several v, each of shape (v,).

    Attributes:
        stress: (σ, ε(v))_Q.
        body: (f_0, v)_H.
        loaded: (f_2, v)_{L²(Γ2)}.
        contact: ∫_{Γ3} σ_ν v_ν.
        bound: ‖σ_ν‖_{L²(Γ3)} ‖v_ν‖_{L²(Γ3)}.
    """

    stress: Array
    body: Array
    loaded: Array
    contact: Array
    bound: Array

    @property
    def residual(self) -> Array:
        """R(t; v) by its definition."""
        return self.stress - self.body - self.loaded

    @property
    def shares(self) -> Array:
        """Return |R| / bound for those v whose bound is not zero up to round-off; empty without contact."""
        given = ~(self.bound <= ROUND_OFF * np.linalg.norm(self.stress))
        return abs(self.residual[given]) / self.bound[given]


def terms(solution: ExactSolution, space: Space, time: float, functions: Sequence[FunctionOfV]) -> Terms:
    """Return the terms of R for several v, integrated by the fine rules."""
    stress, body, loaded, contact, square, pressed = np.zeros((6, len(functions)))
    for rule in rules(solution, space.mesh, FINE[space.dim]):
        exact = solution.at(rule.points)
        sigma, force = exact.stress(time) * rule.weights, exact.body_force(time) * rule.weights
        values = [inside(rule) for inside, _ in functions]
        stress += [np.vdot(sigma, strain_of_v) for _, strain_of_v in values]
        body += [np.vdot(force, v) for v, _ in values]
    for part in space.body.of(Kind.LOADED):
        edge = on_facets(space, part)
        load = solution.at(part.point(edge.s)).surface_load(part, time) * edge.weights
        loaded += [np.vdot(load, on(part, edge)) for _, on in functions]
    for face in solution.faces:
        edge = on_facets(space, face.part, face.rough)
        normal_stress = -solution.on(face, edge.s).pressure(time)
        traces = [np.tensordot(face.part.normal, on(face.part, edge), axes=1) for _, on in functions]
        contact += [np.sum(normal_stress * trace * edge.weights) for trace in traces]
        square += [np.sum(trace**2 * edge.weights) for trace in traces]
        pressed += np.sum(normal_stress**2 * edge.weights)
    return Terms(stress, body, loaded, contact, np.sqrt(square * pressed))


def touches(solution: ExactSolution, space: Space) -> bool:
    """Return whether σ_ν ≠ 0 anywhere on Γ3 at any of the instants."""
    for face in solution.faces:
        exact = solution.on(face, on_facets(space, face.part, face.rough).s)
        least = ROUND_OFF * exact.stress_scale()
        if any(np.any(abs(exact.pressure(time)) > least) for time in midpoints(solution.body.T, INSTANTS)):
            return True
    return False


def on_facets(space: Space, part: Part, rough: tuple[float, ...] = ()) -> FacetRule:
    """Return the fine rule on a part of the boundary."""
    return facet_rule(space.mesh, space.facets(part), part, rough, POINTS)
