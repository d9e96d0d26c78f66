"""Green's formula (2.14) for the exact stress against all v ∈ V^h.

With (2.2), (2.4) and σ_τ = 0 on Γ3, and since v = 0 on Γ1, it says that two functionals on V^h are one:

    (σ, ε(v))_Q − ∫_{Γ3} σ_ν v_ν = (f_0, v)_H + (f_2, v)_{L²(Γ2)}.

The left side is ``Gauge.load`` and needs no derivative of σ, the right side is computed from the forces, term by term.
Their distance is measured in the dual norm of V^h, ‖F‖² = FᵀM⁻¹F, relative to the **smallest** of the four terms that
is not zero: a term left out, or of the wrong sign, gives 1 or 2, whatever the sizes of the others. What is left must be
quadrature. Where f_0 is smooth off straight lines that cut cells, that is round-off.

Where f_0 jumps inside cells, along the curve on which the material begins to yield, the cylinder over a front in 3D or
where a front has turned, a rule on cells of size η misses some η^d in each of the cells that are crossed. Two things
are judged, both with a **composite** rule, a rule of degree 4 on cells halved some times:

* the defect on cells halved often is a tenth of the smallest term at most, so that every term must be there;
* at fixed V^h the defect falls with the halvings. A function of V^h sees 2^{k(d−1)} of the crossed cells on its support
  after k of them, with errors of size 2^{−kd}: their sum falls like 2^{−k} if all have one sign and like 2^{−k(d+1)/2}
  if signs are random. By one halving it scatters more than that, so the window is taken over all, with a factor of two
  for the scatter. A coefficient that is some per cent off would not let it fall.

V^h is contained in the space on halved cells, so that functionals on that space are restricted to V^h by the values of
its functions in the new vertices.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pandas as pd
import scipy.sparse as sps

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
from study.fem.mesh import with_midpoints
from study.fem.naming import resolve
from study.fem.space import Space
from study.ledger.criterion import judge
from study.ledger.measures import finest, largest
from study.ledger.verdict import Verdict
from study.ledger.window import above_nothing
from study.solve.factorisation import Cholesky
from study.statements.shared.base import ListedNumbers, Setting, with_h
from study.statements.shared.eigen import unloaded
from study.statements.shared.meshes import named, place, space_of
from study.statements.shared.scope import REGULAR

TIMES = (0.23, 0.61, 0.79)
"""Fractions of T at which no case has an event (0.3 and 0.7 are where ``lift-and-land`` lifts and lands): before,
between and after those. The work of contact is 1/300 of the largest term or more, where it is not zero."""
FINE, COARSE = {2: 16, 3: 8}, 4
"""Degrees of the rules on the cells themselves, by dimension, and on halved cells."""
HALVINGS = {2: 3, 3: 2}
"""How often cells are halved, by dimension."""
SMOOTH = above_nothing(1e-10, "with the fine rule: f_0 is smooth off straight lines")
KINKED = above_nothing(0.1, "f_0 jumps along curves, a term left out gives 1")
SHRINKING = above_nothing(2.0, "times 2^{−k} for k halvings: 1 if all errors have one sign, 2 for their scatter")
ROUND_OFF = 1e-12
"""Defects and terms below it are rounding."""


class Green(ListedNumbers):
    """The two sides as functionals on V^h, for the cases with Div σ ∈ H."""

    label = "(2.14)"
    effort = 15
    claim = "(σ, ε(v))_Q + (Div σ, v)_H = ∫_Γ σν·v"

    def places(self, full: bool) -> list[Setting]:
        if full:
            return place([case for case in catalogue() if square_integrable(case)], REGULAR, (8, 16), (6,))
        cases = named("full-contact", "no-contact", "fixed-front-off-vertex", "advance-recede", "yield-and-release")
        return place(cases, REGULAR, (4, 8))

    def measure(self, setting: Setting) -> dict[str, float]:
        space, case = space_of(setting), resolve(setting.case)
        if smooth_off_lines(case):
            return with_h(space.h, {"fine rule": defect(case.solution, space, FINE[space.dim]), "smooth": 1.0})
        halvings = HALVINGS[space.dim]
        whole, halved = (defect(case.solution, space, COARSE, k) for k in (0, halvings))
        # What is round-off cannot shrink any more.
        shrunk = 2**halvings * (max(halved, ROUND_OFF) / max(whole, ROUND_OFF))
        return with_h(space.h, {"whole cells": whole, "halved cells": halved, "shrunk": shrunk, "smooth": 0.0})

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        smooth, kinked = by_smoothness(rows)
        return judge(self, smooth, [REMAINING]) + judge(self, kinked, [HALVED, SHRUNK])


REMAINING = finest("fine-rule", "defect as a functional on V^h / smallest term", SMOOTH, "fine rule")
HALVED = finest("halved", "defect as a functional on V^h / smallest term, cells halved", KINKED, "halved cells")
SHRUNK = largest(
    "shrunk", "2^k · defect on cells halved k times / defect on whole cells, same V^h", SHRINKING, "shrunk"
)


def by_smoothness(rows: pd.DataFrame) -> tuple[pd.DataFrame, pd.DataFrame]:
    """The rows of cases whose f_0 is smooth off lines, and those of the others."""
    smooth = rows["case"].isin(rows.loc[(rows["quantity"] == "smooth") & (rows["value"] == 1), "case"])
    return rows[smooth], rows[~smooth]


def defect(solution: ExactSolution, space: Space, degree: int, halvings: int = 0) -> float:
    """The largest distance of the two sides over the times, relative to their smallest term, in the norm of V^h'."""
    riesz = Cholesky(unloaded(space, solution.law).M)
    fine, prolong = halved(space, halvings)
    raised = degree - (DEGREE if space.dim == 2 else SOLID_DEGREE)
    # One for all times where nothing is cut.
    gauge = lru_cache(maxsize=1)(lambda cut: Gauge(cut, fine, raised))

    def norm(functional: Array) -> float:
        on_space = space.interpolate((prolong.T @ fine.nodal(functional).T).T)
        return float(np.sqrt(on_space @ riesz(on_space)))

    def relative(time: float) -> float:
        cut = cut_at_fronts(solution, time)
        load = gauge(cut).load(time)
        contact, loaded = (work_on(kind, cut, fine, time) for kind in (Kind.CONTACT, Kind.LOADED))
        body = work_of_body_force(cut, fine, time, degree)
        return norm(load - body - loaded) / smallest([norm(term) for term in (load + contact, contact, body, loaded)])

    return max(relative(fraction * solution.body.T) for fraction in TIMES)


def halved(space: Space, times: int) -> tuple[Space, sps.csr_array]:
    """The space on cells halved some times, and P1 functions as vertex values there, (vertices, vertices of V^h)."""
    mesh, prolong = space.mesh, sps.csr_array(sps.eye_array(space.mesh.p.shape[1]))
    for _ in range(times):
        prolong = sps.csr_array(with_midpoints(mesh) @ prolong)
        mesh = mesh.refined()
    return Space(mesh, space.body), prolong


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
    return replace(solution, faces=(replace(face, rough=face.fronts(time)),))
