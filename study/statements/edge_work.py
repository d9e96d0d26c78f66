"""Beyond the paper: a bound of the work of contact on every edge, so that Prop. 5.4 needs no trace in H²(Γ3).

On an edge E of length h let N = {u_ν ≠ 0} be the part with a gap and C = {u_ν = 0} the part in contact, and let
R_E = ∫_E σ_ν (Π^h u_ν − u_ν) be the work of contact on E. Since σ_ν = 0 almost everywhere on N, for all 0 < ϱ < 1
(proof in paper/trace.tex)

    |R_E| ≤ β h^{1+2ϱ} |σ_ν|_{ϱ,E} |u_ν'|_{ϱ,E},
    β = min{(2π)^{−1} (h/|N|)^{1/2}, 8^{−1/2} (h/|C|)^{1/2}} ≤ C_0 < 0.388.

The sum over edges gives |R| ≤ C_0 h^{2s} Σ_i |σ_ν|_{ϱ,Γ3,i} |u_ν'|_{ϱ,Γ3,i} with ϱ = s − 1/2. **Measured** are

* the quotient |R_E| / bound with ϱ = 1/2 for exact solutions, at several times, on every edge on which neither N nor C
  is empty;
* the supremum of |∫_E λ Π w| divided by its bound over **all** λ that vanish on N and all piecewise quadratic w that
  vanish on C. The sets N and C belong to the same edges. Each edge is split into 64 equal panels, and each panel
  belongs to N or to C. The functional depends on w only through its values at both ends, so it has rank two, and the
  supremum is the root of the largest eigenvalue of a 2 × 2 matrix.

**Predicted**: both quotients are at most 1, because the bound is proved. For exact solutions they are far below 1,
because these are not extremal functions. The first expression in β is the smaller one if |N| > 2h/(2 + π²). Both kinds
of edges must occur, otherwise only one expression is tested. A deliberate defect adds a constant to the pressure. The
constant does not change the seminorm, but the pressure no longer vanishes on N, and the bound must fail.
"""

import math
from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
import pandas as pd

from manufactured.exact import ExactSolution
from manufactured.tensors import Array
from study.fem.seminorm import FIRST, PANELS, SECOND, gram, seminorm
from study.fem.space import Space
from study.ledger.check import accuracy, identity
from study.ledger.quantities import values
from study.ledger.verdict import Verdict
from study.ledger.window import at_least, at_most
from study.statements.shared.base import ListedNumbers, Numbers, Setting, grid, with_h
from study.statements.shared.meshes import posed
from study.statements.shared.norms import maximum
from study.statements.shared.scope import Scope

EQUAL = 2 / (2 + math.pi**2)
"""The fraction |N|/h of an edge with a gap at which both expressions for the constant β of the bound are equal."""
C_0 = math.sqrt((2 + math.pi**2) / (8 * math.pi**2))
TIMES = 0.23, 0.5, 0.81
"""Times at which edges are examined, as fractions of the final time T."""
CHANGES = 16
"""Largest number of changes between contact and gap on an edge; 64 panels do not resolve more."""
EXPONENTS = 0.05, 0.25, 0.5
"""The exponents ϱ = s − 1/2 for which suprema are computed, that is, s = 0.55, 0.75, 1."""
WORK = "R_E / bound"
OF_ALL = "supremum / bound"
OVERALL = "R_E / (h² |σ_ν| |u_ν'|)"
BRANCHES = "edges by |N|", "edges by |C|"
PROVED = at_most(1.0, "proved")


class EdgeWork(ListedNumbers):
    """Measures the work of contact |R_E| on edges, divided by its bound.

    The quotient is computed for exact solutions. For each of their edges its supremum over all pressures and gaps with
    the same contact zone is computed as well.
    """

    label = "beyond: work on edges"
    claim = "|R_E| ≤ C_0 h^{2s} |σ_ν|_{s−1/2,E} |u_ν'|_{s−1/2,E} on every edge of Γ3, C_0 < 0.388"
    quick = grid(("trains", "merging-patches"), ("one-diagonal",), (16, 32))
    full = (
        *grid(("trains", "breathing-trains"), ("one-diagonal", "unstructured"), (16, 32, 64)),
        *grid(("merging-patches", "natural-front", "rough-1.75"), ("one-diagonal", "unstructured"), (8, 16, 32, 64)),
    )
    checks = (
        identity("solution", "|R_E| / (β h² |σ_ν|_{1/2,E} |u_ν'|_{1/2,E}), largest", values(WORK), PROVED),
        identity(
            "all",
            "supremum of |R_E| / bound over all σ_ν, u_ν' with the same contact zone, s = 0.55, 0.75, 1",
            values(OF_ALL),
            PROVED,
        ),
        identity(
            "constant", "|R_E| / (h² |σ_ν|_{1/2,E} |u_ν'|_{1/2,E}), largest", values(OVERALL), at_most(C_0, "proved")
        ),
    )

    def settings(self, scope: Scope) -> Sequence[Setting]:
        """Return the settings of a study.

        A study of all statements also has the cases with wave trains, which are not part of the catalogue.
        """
        return self.places(scope.full) if scope.statements else super().settings(scope)

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        table = rows.pivot_table(index=["case", "family", "level"], columns="quantity", values="value")
        return [*super().judge(rows), BOTH_KINDS.verdict(self, "all cases", {"all families": table})]

    def measure(self, setting: Setting) -> Numbers:
        space, solution = posed(setting)
        found: dict[str, list[float]] = {name: [0.0] for name in (WORK, OF_ALL, OVERALL)}
        open_parts: list[float] = []
        for touching, open_part, quotients in mixed_edges(solution, space):
            found[WORK] += [*(quotients / beta(open_part))]
            found[OVERALL] += [*quotients]
            found[OF_ALL] += [supremum(of_edge, rho) for of_edge in touching for rho in EXPONENTS]
            open_parts += [*open_part]
        by_open_part = np.array(open_parts) >= EQUAL
        counts = np.sum(by_open_part), np.sum(~by_open_part)
        numbers: Numbers = {name: maximum(quotients) for name, quotients in found.items()}
        return with_h(space.h, numbers | dict(zip(BRANCHES, counts, strict=True)))


BOTH_KINDS = accuracy(
    "branches",
    "number of edges with β from |N|, and with β from |C|: the smaller number",
    lambda group: float(group[list(BRANCHES)].to_numpy().sum(axis=0).min()),
    at_least(1, "both expressions for β in the lemma are tested"),
)


def mixed_edges(solution: ExactSolution, space: Space) -> Iterator[tuple[Array, Array, Array]]:
    """Find the edges of Γ3 that have both contact and a gap, and return the work of contact on them.

    Each edge is mapped to the interval (0, 1). The map to an edge of length h multiplies R_E by h and leaves the
    seminorm |·|_{1/2} unchanged.

    Yields:
        For every contact face and every time, three arrays for the n edges that are found:

        * whether there is contact at the nodes ``FIRST`` of a quadrature rule on the edge, (n, nodes);
        * the fraction |N|/h of the edge with a gap, (n,);
        * the work over its bound without the factor β, |R_E| / (h² |σ_ν|_{1/2,E} |u_ν'|_{1/2,E}), (n,).
    """
    for face, part in product(solution.faces, TIMES):
        time = part * solution.body.T
        corners = space.mesh.p[:, space.mesh.facets[:, space.facets(face.part)]]
        ends = np.sort(face.part.coordinates(corners)[0][0], axis=0)
        places = [ends[0][:, None] + (ends[1] - ends[0])[:, None] * x for x, _ in (FIRST, SECOND)]
        touching = face.level_jet(places[0][None], time)[(0,)] >= 0
        changes = np.sum(touching[:, 1:] != touching[:, :-1], axis=1)
        chosen = (changes >= 1) & (changes <= CHANGES)
        if not chosen.any():
            continue
        places = [s[chosen] for s in places]
        ends = ends[:, chosen]
        touching = touching[chosen]
        pressure = [solution.on(face, s[None]).stated_pressure(time) for s in places]
        slope = [face.gap_jet(s[None], time, 1)[(1,)] for s in places]
        nodal = face.gap_jet(ends[None], time)[(0,)]
        h = ends[1] - ends[0]
        interpolant = nodal[0][:, None] * (1 - FIRST[0]) + nodal[1][:, None] * FIRST[0]
        gap = face.gap_jet(places[0][None], time)[(0,)]
        work = h * (pressure[0] * (interpolant - gap) @ FIRST[1])
        quotients = abs(work) / (h**2 * seminorm(pressure[0], pressure[1], 0.5) * seminorm(slope[0], slope[1], 0.5))
        yield touching, 1 - touching @ FIRST[1], quotients


def beta(open_part: Array) -> Array:
    """Return the constant β of the bound, given the fraction |N|/h of an edge with a gap, which is in (0, 1)."""
    return np.minimum(1 / np.sqrt(open_part) / (2 * np.pi), 1 / np.sqrt(8 * (1 - open_part)))


def supremum(touching: Array, rho: float) -> float:
    """Return the supremum of the work of contact on an edge over all pressures λ and gaps w, divided by its bound.

    The edge is mapped to the interval (0, 1). Then the result is sup |∫ λ Π w| / (|λ|_ϱ |w'|_ϱ), divided by β. The
    interval is split into ``PANELS`` equal panels, and each panel belongs to the part N with a gap or to the part C in
    contact. λ and w' are continuous and linear on each panel, with λ = 0 on N and w' = 0 on C. The result is 0 if λ or
    w' must vanish.

    The values of w at both ends of the edge follow from w' on the panels of N there, because w = 0 on the next panel of
    C. Between panels of C the integral of w' must be 0. This condition is ignored, so with a gap between panels of C
    the result is only an upper bound of the supremum.

    Args:
        touching: whether there is contact at the nodes ``FIRST`` of a quadrature rule on the edge, (nodes,).
        rho: the exponent ϱ of the seminorm.
    """
    contact = touching.reshape(PANELS, -1).mean(axis=1) >= 0.5
    if contact.all() or not contact.any():
        return 0.0
    A = gram(PANELS, rho)
    nodes = np.linspace(0, 1, PANELS + 1)
    mass = np.where((nodes == 0) | (nodes == 1), 0.5, 1.0) / PANELS
    ends = np.flatnonzero(contact)[[0, -1]]
    at_start = nodes * PANELS <= ends[0]
    at_end = nodes * PANELS > ends[1]
    of_pressure = dual_products(A, contact, mass * np.array([1 - nodes, nodes]))
    of_slope = dual_products(A, ~contact, mass * np.array([at_start, at_end]))
    largest_value = float(np.max(np.linalg.eigvals(of_pressure @ of_slope).real, initial=0.0))
    return math.sqrt(largest_value) / float(beta(np.array(1 - contact.mean())))


def dual_products(A: Array, panels: Array, functionals: Array) -> Array:
    """Return the matrix of products f_i · A⁻¹ f_j for two linear functionals f_1 and f_2, (2, 2).

    Nodal values may be non-zero only at the free nodes, that is, the ends of panels all of whose adjacent panels are
    marked. A, f_1 and f_2 are restricted to these nodes.

    Args:
        A: a symmetric matrix, (nodes, nodes).
        panels: whether each panel is marked, (panels,).
        functionals: the functionals, (2, nodes).
    """
    padded = np.concatenate([[True], panels, [True]])
    free = padded[:-1] & padded[1:]
    if not free.any():
        return np.zeros((2, 2))
    chosen = functionals[:, free]
    return np.asarray(chosen @ np.linalg.solve(A[np.ix_(free, free)], chosen.T))
