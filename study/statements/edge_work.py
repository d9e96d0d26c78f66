"""Beyond the source: the work of contact on every edge, the lemma behind Prop. 5.4 without regularity of the trace.

On an edge E of length h let N = {u_ν ≠ 0}, C = {u_ν = 0}, R_E = ∫_E σ_ν (Π^h u_ν − u_ν). Since σ_ν = 0 almost
everywhere on N, for all 0 < ϱ < 1 (the proof is in paper/trace.tex)

    |R_E| ≤ β h^{1+2ϱ} |σ_ν|_{ϱ,E} |u_ν'|_{ϱ,E},
    β = min{(2π)^{−1} (h/|N|)^{1/2}, 8^{−1/2} (h/|C|)^{1/2}} ≤ C_0 < 0.388.

The sum over edges gives |R| ≤ C_0 h^{2s} Σ_i |σ_ν|_{ϱ,Γ3,i} |u_ν'|_{ϱ,Γ3,i}, ϱ = s − 1/2. Two things are measured:

* R_E of exact solutions over its bound with ϱ = 1/2, on every edge with both N and C, at several times;
* the supremum of |∫_E λ Π w| over its bound, with the sets N and C of these edges divided into 64 panels, for **all** λ
  that vanish on N and all piecewise quadratic w that vanish on C. The functional has rank two, through the values of w
  at both ends, so the supremum is the root of the largest eigenvalue of a 2 × 2 matrix.

**Predicted.** Both are at most 1, as this is proved. Solutions stay far below, since nothing makes them extremal. The
first expression in β is the smaller one if |N| > 2h/(2 + π²); edges of both kinds must occur, or the row would say
less. A pressure that is larger by a constant, which no seminorm sees, and so does not vanish on N, must break the
bound.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from manufactured.exact import ExactSolution, Face
from manufactured.tensors import Array
from study.fem.naming import resolve
from study.fem.seminorm import FIRST, PANELS, SECOND, gram, seminorm
from study.fem.space import Space
from study.ledger.criterion import Criterion, Measured, exactly, largest
from study.ledger.verdict import Verdict
from study.ledger.window import at_least, at_most
from study.statements.shared.base import ListedNumbers, Setting, grid, with_h
from study.statements.shared.meshes import space_of
from study.statements.shared.norms import maximum
from study.statements.shared.scope import Scope

EQUAL = 2 / (2 + math.pi**2)
"""|N|/h at which both expressions in β are equal."""
C_0 = math.sqrt((2 + math.pi**2) / (8 * math.pi**2))
TIMES = 0.23, 0.5, 0.81
"""Fractions of T at which edges are looked at."""
CHANGES = 16
"""Edges with more changes of contact are left out, since 64 panels do not resolve them."""
EXPONENTS = 0.05, 0.25, 0.5
"""ϱ of the suprema: s = 0.55, 0.75, 1."""
WORK, OF_ALL, OVERALL = "R_E / bound", "supremum / bound", "R_E / (h² |σ_ν| |u_ν'|)"
BRANCHES = "edges by |N|", "edges by |C|"


class EdgeWork(ListedNumbers):
    """R_E of exact solutions, and suprema over all pressures and gaps, over their bound."""

    label = "beyond: work on edges"
    claim = "|R_E| ≤ C_0 h^{2s} |σ_ν|_{s−1/2,E} |u_ν'|_{s−1/2,E} on every edge of Γ3, C_0 < 0.388"
    quick = grid(("trains", "merging-patches"), ("one-diagonal",), (16, 32))
    full = (
        *grid(("trains", "breathing-trains"), ("one-diagonal", "unstructured"), (16, 32, 64)),
        *grid(("merging-patches", "natural-front", "rough-2.25"), ("one-diagonal", "unstructured"), (8, 16, 32, 64)),
    )
    rules = (
        largest("solution", "|R_E| / (β h² |σ_ν|_{1/2,E} |u_ν'|_{1/2,E}), largest", at_most(1.0, "proved"), WORK),
        largest(
            "all",
            "largest quotient for all σ_ν, u_ν' with these sets, s = 0.55, 0.75, 1",
            at_most(1.0, "proved"),
            OF_ALL,
        ),
        largest("constant", "|R_E| / (h² |σ_ν|_{1/2,E} |u_ν'|_{1/2,E}), largest", at_most(C_0, "proved"), OVERALL),
    )

    def settings(self, scope: Scope) -> Sequence[Setting]:
        """All settings in a study of the whole catalogue, to which the cases with trains do not belong."""
        return self.places(scope.full) if scope.whole else super().settings(scope)

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        table = rows.pivot_table(index=["case", "family", "level"], columns="quantity", values="value")
        return [*super().judge(rows), BOTH_KINDS.verdict(self, "all cases", {"all families": table})]

    def measure(self, setting: Setting) -> dict[str, float]:
        space, solution = space_of(setting), resolve(setting.case).solution
        found: dict[str, list[float]] = {name: [0.0] for name in (WORK, OF_ALL, OVERALL, *BRANCHES)}
        for edges in mixed_edges(solution, space):
            by_open_part = edges.open_part >= EQUAL
            found[WORK] += [*(edges.quotients / beta(edges.open_part))]
            found[OVERALL] += [*edges.quotients]
            found[OF_ALL] += [supremum(touching, rho) for touching in edges.touching for rho in EXPONENTS]
            found[BRANCHES[0]].append(float(np.sum(by_open_part)))
            found[BRANCHES[1]].append(float(np.sum(~by_open_part)))
        counts = {name: sum(found.pop(name)) for name in BRANCHES}
        return with_h(space.h, {**{name: maximum(values) for name, values in found.items()}, **counts})


def rarer_kind(group: pd.DataFrame) -> Measured:
    """Return on how many edges β takes its rarer expression, over all levels."""
    return exactly(group[list(BRANCHES)].to_numpy().sum(axis=0).min())


BOTH_KINDS = Criterion(
    "branches",
    "edges on which the rarer of the two bounds is the smaller one, |N| or |C|",
    at_least(1, "both bounds of the lemma are used"),
    rarer_kind,
    BRANCHES,
)


@dataclass(frozen=True, eq=False)
class Edges:
    """Edges with both N and C.

    Attributes:
        touching: whether the points of ``FIRST`` touch, (n, points).
        open_part: |N|/h, (n,).
        quotients: |R_E| / (h² |σ_ν|_{1/2,E} |u_ν'|_{1/2,E}), (n,).
    """

    touching: Array
    open_part: Array
    quotients: Array


def mixed_edges(solution: ExactSolution, space: Space) -> Iterator[Edges]:
    """Yield the edges of every piece of Γ3 with both N and C, at every time."""
    for face in solution.faces:
        corners = space.mesh.p[:, space.mesh.facets[:, space.facets(face.part)]]
        ends = np.sort(face.part.coordinates(corners)[0][0], axis=0)
        for time in (part * solution.body.T for part in TIMES):
            found = edges_at(solution, face, ends, time)
            if len(found.open_part):
                yield found


def edges_at(solution: ExactSolution, face: Face, ends: Array, time: float) -> Edges:
    """Select the edges between coordinates (2, n) with both N and C at one time.

    The quotients are computed on (0, 1). From there to an edge the seminorm |·|_{1/2} does not change, and R_E takes
    the factor h.
    """
    places = [ends[0][:, None] + (ends[1] - ends[0])[:, None] * x for x, _ in (FIRST, SECOND)]
    touching = face.level_jet(places[0][None], time)[(0,)] >= 0
    changes = np.sum(touching[:, 1:] != touching[:, :-1], axis=1)
    chosen = (changes >= 1) & (changes <= CHANGES)
    places, ends, touching = [s[chosen] for s in places], ends[:, chosen], touching[chosen]
    pressure = [solution.on(face, s[None]).stated_pressure(time) for s in places]
    slope = [face.gap_jet(s[None], time, 1)[(1,)] for s in places]
    nodal, h = face.gap_jet(ends[None], time)[(0,)], ends[1] - ends[0]
    interpolant = nodal[0][:, None] * (1 - FIRST[0]) + nodal[1][:, None] * FIRST[0]
    gap = face.gap_jet(places[0][None], time)[(0,)]
    work = h * (pressure[0] * (interpolant - gap) @ FIRST[1])
    quotients = abs(work) / (h**2 * seminorm(pressure[0], pressure[1], 0.5) * seminorm(slope[0], slope[1], 0.5))
    return Edges(touching, 1 - touching @ FIRST[1], quotients)


def beta(open_part: Array) -> Array:
    """Return β for |N|/h in (0, 1)."""
    return np.minimum(1 / np.sqrt(open_part) / (2 * np.pi), 1 / np.sqrt(8 * (1 - open_part)))


def supremum(touching: Array, rho: float) -> float:
    """Return sup |∫ λ Π w| / (|λ|_ϱ |w'|_ϱ) over its bound β on (0, 1), for contact at points of ``FIRST``.

    λ and w' are piecewise linear on the panels, λ = 0 on the panels of N and w' = 0 on the panels of C. The supremum is
    0 if λ or w' must vanish. In w = w(0) + ∫ w' only the panels of N at both ends count, since w = 0 at the panels of C
    next to them. Between panels of C, w' is free here although w has to return to 0: where N has inner parts this is an
    upper bound.
    """
    contact = touching.reshape(PANELS, -1).mean(axis=1) >= 0.5
    if contact.all() or not contact.any():
        return 0.0
    A, nodes = gram(PANELS, rho), np.linspace(0, 1, PANELS + 1)
    mass = np.where((nodes == 0) | (nodes == 1), 0.5, 1.0) / PANELS
    ends = np.flatnonzero(contact)[[0, -1]]
    at_start, at_end = nodes * PANELS <= ends[0], nodes * PANELS > ends[1]
    of_pressure = dual_products(A, with_all_panels(contact), mass * np.array([1 - nodes, nodes]))
    of_slope = dual_products(A, with_all_panels(~contact), mass * np.array([at_start, at_end]))
    largest_value = float(np.max(np.linalg.eigvals(of_pressure @ of_slope).real, initial=0.0))
    return math.sqrt(largest_value) / float(beta(np.array(1 - contact.mean())))


def with_all_panels(panels: Array) -> Array:
    """Return which nodes have all their panels among the given ones."""
    padded = np.concatenate([[True], panels, [True]])
    return np.asarray(padded[:-1] & padded[1:])


def dual_products(A: Array, free: Array, functionals: Array) -> Array:
    """Return f_i A^{-1} f_j of two functionals on the free nodes, (2, 2)."""
    if not free.any():
        return np.zeros((2, 2))
    chosen = functionals[:, free]
    return np.asarray(chosen @ np.linalg.solve(A[np.ix_(free, free)], chosen.T))
