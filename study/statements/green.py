"""Green's formula (2.14) for the exact stress against all v ∈ V^h.

With (2.2), (2.4) and σ_τ = 0 on Γ3, and since v = 0 on Γ1, it says that two functionals on V^h are one:

    (σ, ε(v))_Q − ∫_{Γ3} σ_ν v_ν = (f_0, v)_H + (f_2, v)_{L²(Γ2)}.

The left side is ``Gauge.load`` and needs no derivative of σ, the right side is ``load_from_forces``. Their
distance is measured in the dual norm of V^h, ‖F‖² = FᵀM⁻¹F, relative to the first, for cell rules of
several degrees: what is left of it must be quadrature.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from manufactured.case import Case
from manufactured.catalogue import catalogue
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.factor import UNIFORM
from manufactured.law import Linear
from manufactured.tensors import Array
from study.fem.gauge import DEGREE, Gauge, rough_lines
from study.fem.independent import load_from_forces
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
KINKED = Window(0.0, 0.1, "≤ 0.1 with the fine rule: f_0 jumps along curves")
"""A rule with 8 points across a cell integrates a jump to some per cent of the cells that it crosses; a term that is
missing or has the wrong sign leaves a defect of order 1."""
SHRINKING = Window(0.0, 0.7, "≤ 0.7, geometric mean over the levels")
"""From the coarse to the fine rule the points of a cell move closer, by 3.5 in the plane and by 1.5 in space, and
errors at jumps fall by as much on the average, not on every mesh."""
ROUND_OFF = 1e-12
"""What cannot shrink any more."""


@dataclass(frozen=True)
class Green:
    """The two sides as functionals on V^h, for the cases with Div σ ∈ H."""

    label: str = "(2.14)"
    claim: str = "(σ, ε(v))_Q + (Div σ, v)_H = ∫_Γ σν·v"

    def settings(self, full: bool) -> list[Setting]:
        if full:
            return place([case for case in catalogue() if square_integrable(case)], FIRST, (8, 16), (2, 4))
        cases = named("full-contact", "no-contact", "fixed-front-off-vertex", "advance-recede", "yield-and-release")
        return place(cases, FIRST, (4, 8), (2,))

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
    return finest("defect as a functional on V^h", window, "fine rule")


def shrinking() -> Criterion:
    """The defect with the fine rule over that with the coarse one."""
    columns = "coarse rule", "fine rule"

    def measure(table: pd.DataFrame) -> Measured:
        coarse, fine = (np.maximum(table[name].to_numpy(), ROUND_OFF) for name in columns)
        mean = float(np.exp(np.mean(np.log(fine / coarse))))
        return mean, (mean, mean)

    return Criterion("defect, fine over coarse cell rule", SHRINKING, measure, columns)


def defects(solution: ExactSolution, space: Space) -> dict[str, float]:
    """For each rule the largest distance of the two sides over the times, relative to their size."""
    riesz = Factor(unloaded(space, solution.law).M)

    def norm(F: Array) -> float:
        return float(np.sqrt(F @ riesz(F)))

    found = dict.fromkeys(RULES[space.dim], 0.0)
    for time in (fraction * solution.body.T for fraction in TIMES):
        cut = cut_at_fronts(solution, time)
        for name, degree in RULES[space.dim].items():
            load = Gauge(cut, space, degree - DEGREE).load(time)
            defect = norm(load - load_from_forces(cut, space, time, degree)) / norm(load)
            found[name] = max(found[name], defect)
    return found


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
    if solution.body.dim > 2 or others or rough_lines(solution) or not isinstance(face, ContactFace):
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
