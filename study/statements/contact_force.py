"""The contact force −σ^h_ν converges to the contact pressure p, and u^h_ν ≤ 0 holds between the vertices of Γ3.

The paper claims nothing about the contact force. It is judged separately, because the order of the error in V hardly
depends on it. Where all of Γ3 is in contact, contact forces that are wrong by a fifth do not change u^h. Penalty
methods have the right order in V on coarse meshes, although their error stagnates later.

**Measured** for every case of Proposition 5.4 with contact. With the nodal contact forces λ_n at t_{n−1/2}, which are
the multipliers of the midpoint rule, Problem 5.1 reads

    (σ^h, ε(v))_Q + λ_n·Nv = (f, v)_V,   v ∈ V^h,    and exactly   (σ, ε(v))_Q + ∫_{Γ3} p v_ν = (f, v)_V.

So ⟨p − p^h, v_ν⟩ = ∫_{Γ3} p v_ν − λ_n·Nv is measured without the load and without a matrix of the problem, because p
comes from the exact stress at points of the faces.

**Predicted orders** in L²(0,T), with k ~ h. For an exact load, ⟨p − p^h, v_ν⟩ = (σ^h − σ, ε(v))_Q for every v ∈ V^h.

* **dual norm**: the supremum over v ∈ V^h of the right side, which depends only on the part of
  σ^h − σ = Aε(u̇^h − u̇) + Gε(u^h − u) that is not orthogonal to V^h. It has the order of ‖Π^h u − u^h‖_V, by the same
  cancellation: 3/2 to 2 on one-diagonal meshes, from 1 to 2 on others. No higher order is possible, because p^h is
  piecewise linear and a front cuts cells.
* **L²(Γ3)**: order 1 to 3/2. Take v with a given trace on Γ3 that vanishes at all vertices off Γ3. It is non-zero only
  in the cells along Γ3. These contain O(h^{3/2}) of ‖σ − σ^h‖_Q for ε(u) ∈ W^{1,∞}, and ‖v‖_V ≤ c h^{−1/2} ‖v_ν‖. This
  gives order 1 without cancellation. With cancellation, the inverse inequality gives half an order less than the order
  of the dual norm.
* **resultant**: at least the order of the dual norm, because v with v_ν = 1 on a piece of Γ3 is one of the v in the
  supremum. For such a smooth v, (σ^h − σ, ε(v − Π^h v)) is of order 2 by the argument of Aubin and Nitsche, if the
  contact zone is known. A moving front is known only up to one cell, which adds the pressure in that cell to the error.
  On coarse levels orders above 2 are observed where a contact patch is only a few cells wide, so the window has no
  upper end.

On random meshes ‖p − p^h‖_{L²(Γ3)} is dominated by the few edges that happen to be long where p is strongly curved. In
a pilot study on ten meshes its logarithm had a standard deviation of 0.2 on every level, n = 8, 16, 32, and its order
was 1.16 ± 0.18. Therefore this order is only reported there. The order of the dual norm, a sum over cells, was
1.51 ± 0.09, and is judged.

**Sign conditions**: u^h_ν is linear between vertices and u^h ∈ K^h, so u^h_ν ≤ 0 at every point of straight faces up to
round-off, and λ ≥ 0.

If the whole face comes into contact with a non-zero velocity, p jumps in time. In the step with the jump every scheme
returns a mean of the values before and after the jump. So the error in L²(0,T) is of order 1/2 in k, times a factor
that depends on the position of the jump within the step. This order is only reported.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pandas as pd
import scipy.sparse as sps
import sympy as sp

from manufactured.exact import ExactSolution, Face
from manufactured.tensors import Array
from study.fem.naming import is_own, name_of, resolve
from study.fem.quadrature import facet_rule
from study.fem.space import Space
from study.ledger.criterion import ENOUGH, Groups, Observation, Rule, by_family, finest, largest, order
from study.ledger.datafiles import CsvFile
from study.ledger.verdict import Verdict
from study.ledger.window import Window, around, at_least, at_most, between
from study.solve.signorini import Signorini
from study.solve.steps import stress_steps
from study.solve.tableau import MIDPOINT
from study.statements.shared import estimates
from study.statements.shared.base import EVOLVING, Setting, Statement
from study.statements.shared.experiment import Experiment
from study.statements.shared.meshes import split_random
from study.statements.shared.scope import Scope

ERRORS = "pressure", "dual", "resultant"
SHARES = tuple(f"{name}_time_share" for name in ERRORS)
COLUMNS = ("case", "family", "level", "h", "steps", *ERRORS, *SHARES, "penetration", "pulling", "clamped")
"""The columns of ``contact.csv``.

Norms in L²(0,T) are computed from the midpoints of the time steps, relative to the same norm of the exact quantity.

    pressure: ‖p − p^h‖_{L²(Γ3)}; p^h is P1 on each piece Γ3,i and has the moments λ_n against P1.
    dual: sup ⟨p − p^h, v_ν⟩ / ‖v‖_V over v ∈ V^h.
    resultant: ⟨p − p^h, 1⟩ on each piece, in the Euclidean norm over the pieces.
    …_time_share: |error − error with half as many steps| / error.
    penetration: max over the nodes in time and points of Γ3 of (u^h_ν)_+, over max |u^h|.
    pulling: max_n (λ_n)_− / max_n |λ_n|.
    clamped: the number of pieces of Γ3 that meet Γ1.
"""
CONTACT = CsvFile("contact.csv", ("case", "family", "level"), COLUMNS)
POINTS, SOLID_POINTS = 20, 6
"""Gauss points on a facet in 2D, and in each direction of a facet in 3D. Many are needed: p has kinks inside facets."""


class PressedFace:
    """One piece of Γ3 with quadrature points, the exact pressure at them, and the P1 functions of its vertices.

    Attributes:
        weights: the quadrature weights, (points,).
        normal: ν.
        every: the values of the P1 functions of all vertices of the mesh at the points, (points, vertices).
        functions: the values of the P1 functions φ_i of the vertices that have a row in N, (points, m).
        mass: ∫ φ_i φ_j, (m, m).
    """

    def __init__(self, solution: ExactSolution, space: Space, face: Face, vertices: Array) -> None:
        count = POINTS if space.dim == 2 else SOLID_POINTS
        rule = facet_rule(space.mesh, space.facets(face.part), face.part, face.rough, count)
        corners = np.broadcast_to(space.mesh.facets[:, rule.facets][..., None], rule.shapes.shape)
        places = np.broadcast_to(np.arange(rule.weights.size).reshape(rule.weights.shape), rule.shapes.shape)
        shape = rule.weights.size, space.mesh.p.shape[1]
        self.every = sps.csr_array((rule.shapes.ravel(), (places.ravel(), corners.ravel())), shape=shape)
        self.functions = self.every[:, vertices]
        self.weights, self.normal = rule.weights.ravel(), face.part.normal
        self.mass = (self.functions.T @ sps.diags_array(self.weights) @ self.functions).toarray()
        self._exact = solution.on(face, rule.s)

    def pressure(self, times: Array) -> Array:
        """Return the exact pressure p at the points, at n times, (points, n)."""
        return self._exact.pressure(times).reshape(-1, len(times))

    def moments(self, pressure: Array) -> Array:
        """Return ∫ p φ_i, (m, n), for n pressures at the points, (points, n)."""
        return self.functions.T @ (self.weights[:, None] * pressure)


class Forces:
    """Measures errors of nodal contact forces and the penetration between the vertices.

    Attributes:
        space: V^h.
        faces: the pieces of Γ3.
        rows: the rows of N that belong to each piece.
        clamped: the number of pieces that have a vertex on Γ1.
        W: the matrix N M⁻¹ Nᵀ, which gives the dual norm sup y·Nv/‖v‖_V = (y·Wy)^½, (m, m).
    """

    def __init__(self, setup: Experiment) -> None:
        self.space = space = setup.space
        ends = np.cumsum([0, *(len(vertices) for _, vertices in space.contact)])
        self.faces = [
            PressedFace(setup.solution, space, face, vertices)
            for face, (_, vertices) in zip(setup.solution.faces, space.contact, strict=True)
        ]
        self.rows = [slice(*pair) for pair in pairwise(ends)]
        # N has no rows for vertices on Γ1.
        corners = (np.unique(space.mesh.facets[:, space.facets(part)]) for part, _ in space.contact)
        self.clamped = sum(len(mine) > len(free) for mine, (_, free) in zip(corners, space.contact, strict=True))
        self.W = Signorini(setup.problem.M, space.N, space.free_points).W

    def squares(self, times: Array, multipliers: Array) -> tuple[Array, Array]:
        """Return the squared ERRORS and the squared exact norms, summed over n times, (3,) each.

        Args:
            multipliers: the nodal contact forces λ at the times, (n, m).
        """
        exact, errors, sizes = [], 0.0, 0.0
        for face, rows in zip(self.faces, self.rows, strict=True):
            p = face.pressure(times)
            # p^h is the P1 function with the moments λ.
            p_h = face.functions @ np.linalg.solve(face.mass, multipliers.T[rows])
            errors += float((face.weights @ (p - p_h) ** 2).sum())
            sizes += float((face.weights @ p**2).sum())
            exact.append(face.moments(p))
        y = np.concatenate(exact)
        missing = y - multipliers.T
        total, lost = (np.array([values[rows].sum(axis=0) for rows in self.rows]) for values in (y, missing))
        found = errors, np.vdot(missing, self.W @ missing), np.vdot(lost, lost)
        return np.array(found), np.array([sizes, np.vdot(y, self.W @ y), np.vdot(total, total)])

    def penetration(self, u: Array) -> float:
        """Return max (u_ν)_+ over the points of Γ3 for u ∈ V^h."""
        nodal = self.space.nodal(u)
        return float(np.max([0.0, *((face.every @ (face.normal @ nodal)).max() for face in self.faces)]))


def errors_in_time(setup: Experiment, forces: Forces, steps: int) -> tuple[Array, float, float]:
    """March with the midpoint rule and return the relative ERRORS in L²(0,T), (3,), penetration and pulling."""
    k, multipliers, extremes = setup.problem.T / steps, [], []
    for state in setup.scheme.march(setup.problem, steps):
        pulling = -state.multipliers.min(initial=0.0)
        extremes.append([forces.penetration(state.u), abs(state.u).max(), pulling, abs(state.multipliers).max()])
        multipliers.append(state.multipliers)
    # NumPy's maximum is NaN if one value is NaN; Python's max could hide it.
    inside, moved, pulled, pressed = np.max(extremes, axis=0)
    squares, sizes = forces.squares((np.arange(steps) + 0.5) * k, np.array(multipliers[1:]))
    return np.sqrt(squares / sizes), float(inside / moved), float(pulled / pressed)


def measure_contact(setup: Experiment) -> dict[str, Any]:
    """Return the columns of ``contact.csv`` from ``h`` on; the number of steps must be even."""
    forces = Forces(setup)
    errors, penetration, pulling = errors_in_time(setup, forces, setup.steps)
    coarse, *_ = errors_in_time(setup, forces, setup.steps // 2)
    shares = abs(errors - coarse) / errors
    return {
        "h": setup.space.h,
        "steps": setup.steps,
        **dict(zip(ERRORS, map(float, errors), strict=True)),
        **dict(zip(SHARES, map(float, shares), strict=True)),
        "penetration": penetration,
        "pulling": pulling,
        "clamped": forces.clamped,
    }


LANDS = "lift-and-land"
"""The case whose pressure jumps in time, so that no order of the force is claimed."""
NO_ORDER = "p jumps in time, and the error comes from the step with the jump"
JUMP = around(0.5, 0.2, "k^{1/2}")
NO_BOUND = "a face meets Γ1, so that the dual norm does not bound the error of the resultant"
"""The order of the resultant follows from the dual norm with v_ν = 1. But v = 0 on Γ1, so if a face meets Γ1, no v ∈ V
has v_ν = 1 on the whole face."""
STRIP = between(1, 1.5, 0.15, 0.7, "from the cells along Γ3; piecewise linear functions reach at most 2")
PRESSURE = order("order-pressure", "order of ‖p − p^h‖_{L²(Γ3)}", STRIP, "pressure")
OF_CHANCE = replace(PRESSURE, key="order-pressure-random", quantity=f"{PRESSURE.quantity}, random meshes")
FEW_EDGES = "on random meshes the pressure error depends on a few long edges where p has a kink"
SUPERCLOSE = between(1.5, 2, 0.2, 0.2, "the order of ‖Π^h u − u^h‖_V on one-diagonal meshes")
OTHERS = between(1, 2, 0.15, 0.2, "the order of ‖Π^h u − u^h‖_V on other meshes")
DUAL = "order of sup ⟨p − p^h, v_ν⟩ / ‖v‖_V over V^h"
DUAL_ORDERS = {
    True: order("order-dual-superclose", f"{DUAL}, superclose", SUPERCLOSE, "dual"),
    False: order("order-dual-other", f"{DUAL}, other families", OTHERS, "dual"),
}
"""On one-diagonal meshes (True) and on others."""
RESULTANT = at_least(1, "the order of the dual norm; 2 if the contact zone is known")
"""No upper end: the error of the resultant has a sign, parts of it may cancel, and its order may exceed 2."""
SIZE = at_most(0.05, "of the exact resultant, on the finest level")
TIME = at_most(0.5, "of each error; half as many steps show the error in time")
NORMS = (
    order("order-resultant", "order of the error of the contact resultant on each face", RESULTANT, "resultant"),
    finest("resultant", "error of the contact resultant on each face", SIZE, "resultant"),
    # The time share of the resultant is not judged: time steps can only lower its order, which has no upper end, and on
    # symmetric meshes its discretisation error in space may vanish.
    largest("time-share", "error in time / error, for both norms of p − p^h", TIME, *SHARES[:2]),
)
ROUND_OFF = at_most(1e-10, "only rounding, because faces are straight and elements linear")
EXACT = (
    largest("penetration", "max (u^h_ν)_+ between vertices / max |u^h|", ROUND_OFF, "penetration"),
    largest("pulling", "max λ_− / max |λ|", ROUND_OFF, "pulling"),
)


def rules_of(case: str, groups: Groups) -> Iterator[tuple[Rule, Groups]]:
    """Yield the criteria for a case, and the mesh families that each of them judges."""
    norms, clamped = [], any(table["clamped"].any() for table in groups.values())
    for rule in NORMS:
        if clamped and rule.key == "order-resultant":
            yield Observation(rule, NO_BOUND), groups
        else:
            norms.append((rule, groups))
    random, others = split_random(groups)
    if others:
        norms.append((PRESSURE, others))
    if random and case == LANDS:
        norms.append((OF_CHANCE, random))
    elif random:
        yield Observation(OF_CHANCE, FEW_EDGES), random
    for superclose, rule in DUAL_ORDERS.items():
        if mine := {name: table for name, table in groups.items() if (name == "one-diagonal") is superclose}:
            norms.append((rule, mine))
    for rule, mine in norms:
        jump = JUMP if rule.key.startswith("order") else Window()
        yield Observation(replace(rule, window=jump), NO_ORDER) if case == LANDS else rule, mine
    for rule in EXACT:
        yield rule, groups


def touches(solution: ExactSolution) -> bool:
    """Return whether there is contact at some time, according to the formulas of the faces."""
    return any(
        (face.pressure_jet is None or face.pressure_jet.expression != 0) and not sp.sympify(face.level).is_negative
        for face in solution.faces
    )


class ContactForce(Statement):
    """Measures errors of the contact force and violations of both sign conditions, by the midpoint rule with k ~ h."""

    label = "contact force"
    claim = "−σ^h_ν → p on Γ3, and u^h_ν ≤ 0 between vertices, for the solutions of Proposition 5.4"
    file = CONTACT
    of_own_cases = True

    def settings(self, scope: Scope) -> list[Setting]:
        """Return settings for the cases of Proposition 5.4 with contact.

        Cases of the catalogue are measured on the three finest levels that the study has on all their mesh families;
        the quick study takes only a selection of them. Cases of users are all measured, on all levels, so that finer
        levels can be added to a run.
        """
        return [
            Setting(reference, family.name, level)
            for reference, case in zip(scope.cases, scope.resolved(), strict=True)
            if is_own(reference) or (scope.statements and (scope.full or reference in EVOLVING))
            if case.proposition == "Prop. 5.4" and touches(case.solution)
            for family in scope.families_of(case)
            for level in scope.levels_of(case).all[0 if is_own(reference) else -ENOUGH :]
        ]

    def measure(self, setting: Setting) -> dict[str, Any]:
        setup = Experiment.at(setting, MIDPOINT, self.steps(setting))
        case = name_of(setting.case)
        return {"case": case, "family": setting.family, "level": setting.level, **measure_contact(setup)}

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        cases = [(str(case), by_family(mine)) for case, mine in rows.groupby("case", sort=False)]
        return [rule.verdict(self, case, chosen) for case, groups in cases for rule, chosen in rules_of(case, groups)]

    def cost(self, setting: Setting) -> float:
        cells = setting.level**setting.dim * estimates.cells(setting.family)
        return float(cells * self.steps(setting)) * (5 if setting.dim == 2 else 120)

    def memory(self, setting: Setting) -> float:
        return estimates.displacement(setting.dim, setting.level, setting.family)

    def steps(self, setting: Setting) -> int:
        """Return an even number of time steps with k ~ h."""
        case = resolve(setting.case)
        return stress_steps(case.solution.body.T, setting.level, case.pace)
