"""Beyond the source: what is left of (5.36) at the natural front of frictionless contact while it advances.

Beside a front between contact and separation the displacements of elasticity that have finite energy and need no
forces begin with r^{1/2}, those that neither penetrate nor pull with r^{3/2}. In σ = Aε(u̇) + Gε(u) the velocity takes
the part of the elastic displacement, and where the front moves it has one power less than u: for u ~ r^{3/2} it is
u̇ ~ −ċ ∂_x u ~ r^{1/2}, with p ~ ċ r^{−1/2}. That is a pressure where ċ > 0, and pulls where ċ < 0: fronts that recede
are expected to have w ~ r^{5/2} and p ~ r^{1/2}, which satisfies (5.36). What of this is proved is the proposition on
fronts that move in the supplement: none has w ~ r^{3/2} and a pressure in H^{1/2}.

``manufactured.natural_motion`` is an advancing front in closed form, with f_0 and f_2 as (3.4) wants them. Predicted:

* ‖u − u^h‖ ~ h, as u(t) ∈ H^{5/2−ε}; Theorem 4.1 and Proposition 5.3 apply, 5.4 does not, and 1/2 is proved;
* ‖u̇ − Π^h u̇‖_{L²(0,T;V)} ~ h^{1/2}, from above, as smooth parts have the order 1;
* the *excess* ‖u^h − u^h_lin‖, u^h_lin the solution with σ_ν as a traction: the front passes a cell in a time ~ h,
  in which velocities are wrong by h^{1/2}, so that each of h^{−1} cells keeps h^{3/2}. Cells that keep the same add up
  like the smooth trail of a roller, to h^{3/2}, others to h: between both, where the proof has 1/2.

The load is (f_0, v) + (f_2, v)_{Γ2}: f_0 is bounded, while the stress that ``Gauge.load`` would need is not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from manufactured.exact import ExactSolution
from manufactured.natural_motion import NAME
from manufactured.singular import SingularFace, TravellingField
from manufactured.tensors import Array
from study.fem.gauge import FACET_POINTS, Gauge
from study.fem.independent import load_from_forces
from study.fem.naming import resolve
from study.fem.quadrature import facet_rule
from study.fem.space import Space
from study.ledger.measures import ENOUGH, between_levels, largest, order
from study.ledger.window import STEEPER, above_nothing, around, between
from study.solve.evolution import SemiDiscrete
from study.solve.factorisation import Cholesky
from study.solve.paths import furthest, path
from study.solve.tableau import MIDPOINT
from study.statements.shared.base import ListedNumbers, Setting, grid, with_h
from study.statements.shared.meshes import space_of
from study.statements.shared.norms import Velocity, dual_norm, midpoints
from study.statements.shared.scope import Scope

DEGREE, RAISED = 2, 6
"""Of the cell rule for f_0, and of the one that it is compared with."""
PER_CELL = 2
"""Time steps to a cell along a side; twice as many stand for u^h."""
INSTANTS, FEW = 32, 4
"""Times at which errors and velocities are looked at, and loads by the finer rule."""
INTERPOLATION = around(1, STEEPER, "that of interpolation, where 1/2 is proved")
SINGULAR = between(0.5, 0.5, STEEPER, 0.25, "the two finest levels; smooth parts of order 1 raise it")
TRAIL = between(1, 1.5, STEEPER, STEEPER, "1 if cells keep parts of their own, 3/2 if all keep the same")
NEGLIGIBLE = above_nothing(0.02, "of the error")


class AdvancingFront(ListedNumbers):
    """Errors, velocities and excess at a natural front that advances."""

    label = "beyond: advancing front"
    claim = "‖u − u^h‖ ~ h at the natural front that advances, where 1/2 is proved"
    rules = (
        between_levels("order", "order of ‖u − u^h‖ over two refinements", INTERPOLATION, "error", 2, ENOUGH),
        order("rate", "order of ‖u̇ − Π^h u̇‖_{L²(0,T;V)}", SINGULAR, "rate", last=2),
        order("excess", "order of ‖u^h − u^h_lin‖", TRAIL, "excess"),
        largest("time", "time share", NEGLIGIBLE, "time share"),
        largest("quadrature", "change under finer quadrature of f_0", NEGLIGIBLE, "quadrature"),
    )
    # Not on random meshes: in which cells a singular front lies at the times that count is chance there, and orders of
    # single levels follow it.
    quick = grid((NAME,), ("unstructured",), (8, 16, 32))
    full = grid((NAME,), ("one-diagonal", "unstructured"), (8, 16, 32, 64))

    def settings(self, scope: Scope) -> Sequence[Setting]:
        """Those of a study of the whole catalogue, to which the case does not belong."""
        return self.places(scope.full) if scope.whole else []

    def cost(self, setting: Setting) -> float:
        """Time steps are as many as cells along a side."""
        return 100.0 * setting.level**3

    def measure(self, setting: Setting) -> dict[str, float]:
        space = space_of(setting)
        return with_h(space.h, Advance.on(resolve(setting.case).solution, space).numbers(PER_CELL * setting.level))


@dataclass(frozen=True, eq=False)
class Advance:
    """Problem 5.1 on one mesh, and the same without the condition of contact and with σ_ν as a traction."""

    solution: ExactSolution
    space: Space
    gauge: Gauge
    problem: SemiDiscrete
    linear: SemiDiscrete

    @classmethod
    def on(cls, solution: ExactSolution, space: Space) -> Advance:
        """Both problems, with one load and one start."""
        gauge = Gauge(solution, space)
        load = lru_cache(maxsize=None)(lambda time: load_from_forces(solution, space, time, DEGREE))
        problem = SemiDiscrete.of(space, solution.law, load, gauge.sample(0.0).interpolant)
        pressed = Traction(solution, space)
        linear = replace(problem, N=problem.N[:0], load=lambda time: load(time) + pressed(time))
        return cls(solution, space, gauge, problem, linear)

    def numbers(self, steps: int) -> dict[str, float]:
        """What is judged, from ``steps`` steps and twice as many."""
        coarse, fine = (path(self.problem, MIDPOINT, times * steps) for times in (1, 2))
        error = self.error(fine)
        return {
            "error": error,
            "rate": self.rate(),
            "excess": furthest(self.problem, fine, path(self.linear, MIDPOINT, 2 * steps)),
            "time share": furthest(self.problem, fine[::2], coarse) / error,
            "quadrature": self.left_out() / error,
        }

    def error(self, states: Array) -> float:
        """max ‖u − u^h‖_V over about as many nodes as there are instants."""
        steps, T = len(states) - 1, self.problem.T
        nodes = range(0, steps + 1, max(1, steps // INSTANTS))
        return max(self.gauge.distance(self.gauge.sample(n * T / steps), states[n]) for n in nodes)

    def rate(self) -> float:
        """‖u̇ − Π^h u̇‖_{L²(0,T;V)}."""
        velocity, T = Velocity(self.solution, self.space), self.problem.T
        return float(np.sqrt(T * np.mean(velocity.interpolation_error(midpoints(T, INSTANTS)) ** 2)))

    def left_out(self) -> float:
        """T max ‖δf‖_V for what finer rules add to f: no less than what they change u^h by, as G is monotone."""
        riesz, T = Cholesky(self.problem.M), self.problem.T

        def change(time: float) -> Array:
            finer = load_from_forces(self.solution, self.space, time, RAISED)
            return finer - load_from_forces(self.solution, self.space, time, DEGREE)

        return T * max(dual_norm(change(time), riesz) for time in midpoints(T, FEW))


@dataclass(frozen=True, eq=False)
class Traction:
    """t ↦ ∫_{Γ3} σ_ν v_ν, (n_dofs,), by rules that are graded to where the front is."""

    solution: ExactSolution
    space: Space

    def __call__(self, time: float) -> Array:
        (face,), mesh = self.solution.faces, self.space.mesh
        assert isinstance(face, SingularFace)
        assert isinstance(face.field, TravellingField)
        front = face.field.place_at(time)
        rule = facet_rule(mesh, self.space.facets(face.part), face.part, (front,), FACET_POINTS)
        pressure = self.solution.on(face, rule.s).pressure(time) * rule.weights
        moments = -np.multiply.outer(face.part.normal, np.einsum("nq,anq->an", pressure, rule.shapes))
        return self.space.interpolate(self.space.scatter(mesh.facets[:, rule.facets], moments))
