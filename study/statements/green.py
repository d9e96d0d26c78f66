"""Green's formula (2.14) for the exact stress against all v ∈ V^h.

With (2.2), (2.4) and σ_τ = 0 on Γ3, and since v = 0 on Γ1, it says that two functionals on V^h are one:

    (σ, ε(v))_Q − ∫_{Γ3} σ_ν v_ν = (f_0, v)_H + (f_2, v)_{L²(Γ2)}.

The left side is ``Gauge.load`` and needs no derivative of σ, the right side is ``load_from_forces``, term by
term. Their distance is measured in the dual norm of V^h, ‖F‖² = FᵀM⁻¹F, relative to the **smallest** of the
four terms that is not zero: a term left out, or of the wrong sign, gives 1 or 2, whatever the sizes of the
others. What is left must be quadrature. Where f_0 is smooth off straight lines that cut cells, that is round-off.

Where f_0 jumps inside cells, along the curve on which the material begins to yield, the cylinder over a
front in 3D or where a front has turned, a rule with q points across a cell misses some h^d/q in each of the
h^{1−d} cells that are crossed. Against shape functions of V^h this is a density of size h/q on the curve, so
the defect is at most O(h/q), in the mean less, as the errors have random signs; from one mesh to the next it
scatters by factors of two to ten, so that no order in h can be judged on a few levels. Two things are judged
instead: the defect is a tenth of the smallest term at most, so that every term must be there, and it shrinks
with h/q, as a coefficient that is some per cent off would not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from manufactured.body import Kind
from manufactured.case import Case
from manufactured.catalogue import catalogue
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.factor import UNIFORM
from manufactured.law import Linear
from manufactured.tensors import Array
from study.fem.gauge import DEGREE, SOLID_DEGREE, Gauge
from study.fem.independent import work_of_body_force, work_on
from study.fem.space import Space
from study.naming import resolve
from study.solve.factor import Factor
from study.statements.base import Setting
from study.statements.eigen import unloaded
from study.statements.places import FIRST, named, place, space_of
from study.statements.tally import Criterion, Measured, finest, judge, with_h
from study.verdict import Verdict, Window

TIMES = (0.3, 0.7)
"""Fractions of T."""
RULES = {
    2: {"coarse rule": 4, "middle rule": 8, "fine rule": 16},
    3: {"coarse rule": 4, "middle rule": 6, "fine rule": 8},
}
"""Degrees of cell rules, by dimension."""

SMOOTH = Window(0.0, 1e-10, "≤ 1e-10 with the fine rule: f_0 is smooth off straight lines")
KINKED = Window(0.0, 0.1, "≤ 0.1 with the fine rule: f_0 jumps along curves, a term left out gives 1")
SHRINKING = Window(0.0, 0.5, "≤ 1/2: h/q is divided by 7 in the plane and by 3 in space")
"""From the coarse rule on the coarsest mesh to the fine rule on the finest, points of a cell move closer by 3.5 in the
plane and 1.5 in space, cells by 2; the defect falls by as much and more, up to its scatter."""
ROUND_OFF = 1e-12
"""What cannot shrink any more."""


@dataclass(frozen=True)
class Green:
    """The two sides as functionals on V^h, for the cases with Div σ ∈ H."""

    label: str = "(2.14)"
    claim: str = "(σ, ε(v))_Q + (Div σ, v)_H = ∫_Γ σν·v"

    def settings(self, full: bool) -> list[Setting]:
        if full:
            return place([case for case in catalogue() if square_integrable(case)], FIRST, (8, 16), (6, 12))
        cases = named("full-contact", "no-contact", "fixed-front-off-vertex", "advance-recede", "yield-and-release")
        return place(cases, FIRST, (4, 8))

    def measure(self, setting: Setting) -> dict[str, float]:
        space, case = space_of(setting), resolve(setting.case)
        smooth = {"smooth": float(smooth_off_lines(case))}
        return with_h(space.h, {**defects(case.solution, space), **smooth})

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        smooth = set(rows.loc[(rows["quantity"] == "smooth") & (rows["value"] == 1), "case"])
        first, second = rows[rows["case"].isin(smooth)], rows[~rows["case"].isin(smooth)]
        return judge(self, first, [remaining(SMOOTH)]) + judge(self, second, [remaining(KINKED), shrinking()])


def remaining(window: Window) -> Criterion:
    """The defect with the fine rule on the finest level."""
    return finest("defect as a functional on V^h / smallest term", window, "fine rule")


def shrinking() -> Criterion:
    """The defect with the fine rule on the finest level over that with the coarse one on the coarsest."""

    def measure(table: pd.DataFrame) -> Measured:
        first, last = max(table["coarse rule"].iloc[0], ROUND_OFF), max(table["fine rule"].iloc[-1], ROUND_OFF)
        return last / first, (last / first, last / first)

    return Criterion(
        "defect, fine rule on finest level over coarse rule on coarsest",
        SHRINKING,
        measure,
        ("coarse rule", "fine rule"),
        2,
    )


def defects(solution: ExactSolution, space: Space) -> dict[str, float]:
    """For each rule the largest distance of the two sides over the times, relative to their smallest term."""
    riesz = Factor(unloaded(space, solution.law).M)

    def norm(F: Array) -> float:
        return float(np.sqrt(F @ riesz(F)))

    found = dict.fromkeys(RULES[space.dim], 0.0)
    for time in (fraction * solution.body.T for fraction in TIMES):
        cut = cut_at_fronts(solution, time)
        for name, degree in RULES[space.dim].items():
            load = Gauge(cut, space, degree - (DEGREE if space.dim == 2 else SOLID_DEGREE)).load(time)
            contact, loaded = (work_on(kind, cut, space, time) for kind in (Kind.CONTACT, Kind.LOADED))
            body = work_of_body_force(cut, space, time, degree)
            sizes = [norm(term) for term in (load + contact, contact, body, loaded)]
            found[name] = max(found[name], norm(load - body - loaded) / smallest(sizes))
    return found


def smallest(sizes: Sequence[float]) -> float:
    """The smallest that is not zero up to rounding."""
    return min(size for size in sizes if size > ROUND_OFF * max(sizes))


def square_integrable(case: Case) -> bool:
    """Whether Div σ(t) ∈ H: from ε(u̇(t)) ∈ H¹."""
    return case.regularity.rate_smoothness > 1


def smooth_off_lines(case: Case) -> bool:
    """Whether all kinks of f_0 are known straight lines at all times.

    A front that moves leaves kinks where it turned, a nonlinear G where the material begins to yield.
    """
    law, faces = case.solution.law, case.solution.faces
    homogeneous = law.A.factor is UNIFORM and isinstance(law.G, Linear) and law.G.factor is UNIFORM
    return homogeneous and not case.regularity.moving and all(isinstance(face, ContactFace) for face in faces)


def cut_at_fronts(solution: ExactSolution, time: float) -> ExactSolution:
    """The solution with the fronts of one time among the places where rules cut cells.

    Only for one face in the plane without other such places: cells are cut along one line.
    """
    face, *others = solution.faces
    if solution.body.dim > 2 or others or solution.rough or not isinstance(face, ContactFace):
        return solution
    return replace(solution, faces=(replace(face, rough=fronts(face, time)),))


def fronts(face: ContactFace, time: float) -> tuple[float, ...]:
    """The zeros of ψ(·, t) inside a face of one dimension."""

    def level(s: Array) -> Array:
        return face.level_jet(np.atleast_1d(s)[None], time)[0,]

    # An irregular grid, so that no front lies on it.
    grid = face.part.measure * np.linspace(0, 1, 1000) ** 1.01
    signs = np.sign(np.broadcast_to(level(grid), grid.shape))
    changes = np.flatnonzero(signs[:-1] * signs[1:] < 0)
    return tuple(float(brentq(lambda s: float(level(s)[0]), grid[i], grid[i + 1], xtol=1e-15)) for i in changes)
