"""Norms in time that must be finite: of the load, (3.8) and (5.9), and of the traction, (4.12).

The statements are f ∈ W^{1,1}(0,T;V) for the load f, and σν ∈ L^∞(0,T;L²(Γ)) for the traction on the whole boundary.
They are tested by computing the norm on finer and finer grids: a finite norm converges, an infinite norm grows.

**(3.8).** By (5.9) f^h(t) = M⁻¹F(t) is the projection of the load f(t) onto V^h. Its *variation* on a time grid is
Σ_i ‖f^h(t_i) − f^h(t_{i−1})‖_V. The variation grows if the grid is refined, by the triangle inequality. Predicted:

* The variation grows by at most 1 % from a grid to the next finer one, if the load changes its direction finitely
  often. If the variation were not bounded, it would grow by a power of 2.
* Four halvings of the intervals reduce the largest increment to 1/16 where ḟ is bounded. They reduce it to 1/2 for
  ``load-w11``, whose load behaves like (t − t_0)^{1/4}. If f jumped in time, the largest increment would not fall;
  bounded variation alone would permit such a jump. In ``lift-and-land`` u̇ and σ_ν jump, but the two jumps cancel in f.
* On finer meshes ‖f^h‖_{W^{1,1}} tends to the norm of f. The energy that the projection loses is of order h²: some per
  cent where a contact patch is three cells wide (n = 8, not judged for moving fronts), and a quarter of that on each
  finer mesh. From n = 16 on the norms agree within 5 %. If f were not in V, the norm would grow.

(3.8) does not hold for ``moving-rough``. There ε(u̇) ~ (s − c)^{1/4} near the front c, which moves. So u̇ has
increments of the size k^{3/4} in V, whose sum is not bounded, and so has f, which contains u̇. The case was judged at
first: its variation grew by 0.8, 1 and 1.3 % at n = 8, 16 and 32. Now it is only reported. Theorem 4.1 does not apply
to this load; u ∈ W^{1,∞}(0,T;V) is known because u was constructed.

**(4.12).** The norm of the exact traction on Γ is computed on finer and finer meshes, by quadrature rules that are not
adapted to singularities. Its maximum is taken over twice as many times as there are cells along a side. Predicted:

* The maximum converges for every case of Proposition 5.4.
* In ``junction`` the traction behaves like r^{−1/2} at the point where Γ1 meets Γ3. There the square of the norm grows
  like log 1/h, that is, by the same amount from mesh to mesh. (4.12) does not hold, and the paper does not claim it.
"""

import math
from itertools import pairwise
from types import MappingProxyType

import numpy as np
import pandas as pd

from manufactured.catalogue import catalogue
from study.fem.error_norm import FACET_POINTS, ErrorNorm
from study.fem.quadrature import facet_rule
from study.ledger.check import ENOUGH, ROUNDING, Groups, consequence, paper_claim
from study.ledger.quantities import change, values
from study.ledger.window import Window, around
from study.solve.factorisation import Cholesky
from study.statements.shared.base import EVOLVING, SOFTENING, Judged, ListedNumbers, Numbers, Setting, grid, with_h
from study.statements.shared.eigen import unloaded
from study.statements.shared.meshes import named, place, posed
from study.statements.shared.norms import dual_norm, maximum
from study.statements.shared.scope import REGULAR

# The load, f ∈ W^{1,1}(0,T;V).

INTERVALS = 512
COARSER = 16
"""Quotient of the lengths of long and short time intervals, over which increments of the load are compared."""
VARIATION = f"variation of f^h on {INTERVALS} intervals / on {INTERVALS // 2} intervals"
INCREMENTS = f"largest increment of f^h / largest increment over {COARSER} times as long intervals"
WITHOUT = "ε(ü) ~ (s − c)^{α−4} with α = 13/4 is not square integrable and f has no bounded variation in V"


class LoadInTime(ListedNumbers):
    """Measures the variation in time, the largest increment and the norm of the discrete load f^h."""

    label = "(3.8), (5.9)"
    claim = "f ∈ W^{1,1}(0,T;V), and f^h ∈ W^{1,1}(0,T;V^h) uniformly in h"
    checks = (
        paper_claim(
            "variation",
            VARIATION,
            values("variation"),
            Window(1 - ROUNDING, 1.01, "the variation cannot fall; without a bound it grows by a power of 2"),
        ),
        consequence(
            "increments",
            INCREMENTS,
            values("increments"),
            Window(1 / 32, 0.6, f"1/{COARSER} where ḟ is bounded, 1/2 for (t − t_0)^{{1/4}}, 1 for a jump"),
        ),
        paper_claim(
            "uniform",
            "‖f^h‖_{W^{1,1}(0,T;V)}, finest mesh / coarsest mesh",
            change("norm"),
            around(1, 0.05, "f^h tends to f"),
            levels=2,
        ),
    )
    not_judged = MappingProxyType({"moving-rough": WITHOUT})
    quick = grid(("load-w11",), ("unstructured",), (8, 16))
    full = grid(
        (*EVOLVING, "lift-and-land", "load-w11", "moving-rough", "hexagon", *SOFTENING), ("unstructured",), (16, 32)
    )

    def measure(self, setting: Setting) -> Numbers:
        space, solution = posed(setting)
        v_norm = ErrorNorm(solution, space)
        riesz = Cholesky(unloaded(space, solution.law).M)
        times = np.linspace(0, solution.body.T, INTERVALS + 1)
        loads = np.array([v_norm.load(float(t)) for t in times])
        # A finite norm shows in increments ‖f^h(t_i) − f^h(t_{i−1})‖_V that do not grow from grid to grid.
        fine, half, coarse = (
            np.array([dual_norm(after - before, riesz) for before, after in pairwise(loads[::step])])
            for step in (1, 2, COARSER)
        )
        size = np.mean([dual_norm(F, riesz) for F in loads]) * solution.body.T
        found = {"variation": fine.sum() / half.sum(), "increments": fine.max() / coarse.max()}
        return with_h(space.h, {**found, "norm": size + fine.sum()})


# The traction, σν ∈ L^∞(0,T;L²(Γ)).

UNBOUNDED = "junction"
"""The case whose traction σν is not square integrable on the boundary."""


def last_increments(levels: pd.DataFrame) -> float:
    """Return the last over the previous increment of max_t ‖σν‖² under refinement."""
    increments = np.diff(levels["norm"].to_numpy() ** 2)
    return float(increments[-1] / increments[-2])


class TractionInTime(ListedNumbers):
    """Measures the largest norm of the traction, max_t ‖σν‖_{L²(Γ)}.

    It must converge for the cases of Proposition 5.4, and must grow for one case with an unbounded traction.
    """

    label = "(4.12)"
    claim = "σν ∈ L^∞(0,T;L²(Γ)^d) for the solutions of Prop. 5.4"

    def places(self, full: bool) -> list[Setting]:
        cases = [case for case in catalogue() if case.proposition == "Prop. 5.4"] if full else named("advance-recede")
        return place([*cases, *named(UNBOUNDED)], REGULAR, (8, 16, 32), (2, 4, 8))

    def measure(self, setting: Setting) -> Numbers:
        space, solution = posed(setting)
        squares = []
        sides = []
        for part in space.body.parts:
            rule = facet_rule(space.mesh, space.facets(part), part, (), FACET_POINTS if space.dim == 2 else 2)
            sides.append((part, solution.at(part.point(rule.s)), rule.weights))
        for time in np.linspace(0, solution.body.T, 2 * setting.level + 1).tolist():
            squares.append(sum(np.sum(exact.surface_load(part, time) ** 2 * w) for part, exact, w in sides))
        return with_h(space.h, {"norm": math.sqrt(maximum(squares))})

    def checks_of(self, case: str, groups: Groups) -> Judged:
        return [
            (
                consequence(
                    "unbounded",
                    "σν ∉ L²(Γ): last / previous increment of max_t ‖σν‖²_{L²(Γ)} under refinement",
                    last_increments,
                    around(1, 0.1, "logarithmic growth: the increments of the square do not fall"),
                    levels=ENOUGH,
                )
                if case == UNBOUNDED
                else paper_claim(
                    "bounded",
                    "max_t ‖σν‖_{L²(Γ)}, finest mesh / next coarser mesh",
                    change("norm", since=-2),
                    around(1, 0.02, "the maximum has converged in space and time, which are refined together"),
                    levels=ENOUGH,
                ),
                groups,
            )
        ]
