"""Beyond the source: how much of (5.36) holds at the natural front of frictionless contact while it advances.

Near a front between contact and separation, elastic displacements of finite energy without forces begin with r^{1/2};
those that neither penetrate nor pull begin with r^{3/2}. In σ = Aε(u̇) + Gε(u) the velocity plays the role of the
elastic displacement, and where the front moves it has one power less than u: for u ~ r^{3/2} it is
u̇ ~ −ċ ∂_x u ~ r^{1/2}, with p ~ ċ r^{−1/2}. This is a pressure where ċ > 0, and pulls where ċ < 0. So fronts that
recede are expected to have w ~ r^{5/2} and p ~ r^{1/2}, which satisfies (5.36). paper/fronts.tex proves a part of this,
in the proposition on moving fronts: none has w ~ r^{3/2} and a pressure in H^{1/2}.

``manufactured.natural_motion`` is an advancing front in closed form, with f_0 and f_2 as (3.4) requires. Predicted:

* ‖u − u^h‖ ~ h, as u(t) ∈ H^{5/2−ε}. Theorem 4.1 and Proposition 5.3 apply, 5.4 does not, and 1/2 is proved;
* ‖u̇ − Π^h u̇‖_{L²(0,T;V)} ~ h^{1/2}, approached from above, as smooth parts have the order 1;
* the *excess* ‖u^h − u^h_lin‖, where u^h_lin is the solution with σ_ν as a traction. The front passes a cell in a time
  ~ h, in which velocities are wrong by h^{1/2}, so an error of h^{3/2} remains in each of h^{−1} cells. If all cells
  keep the same error, it adds up like the smooth trail of a roller, to h^{3/2}; otherwise to h. The order is between
  both, where the proof has 1/2.

The load is (f_0, v) + (f_2, v)_{Γ2}: f_0 is bounded, while the stress that ``ErrorNorm.load`` would need is not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from manufactured.exact import ExactSolution
from manufactured.natural_motion import NAME
from manufactured.singular import SingularFace, TravellingField
from manufactured.tensors import Array
from study.fem.error_norm import FACET_POINTS, ErrorNorm
from study.fem.independent import load_from_forces
from study.fem.naming import resolve
from study.fem.quadrature import facet_rule
from study.fem.space import Space
from study.ledger.criterion import ENOUGH, between_levels, largest, order
from study.ledger.window import STEEPER, around, between, positive_at_most
from study.solve.evolution import SemiDiscrete
from study.solve.factorisation import Cholesky
from study.solve.paths import furthest, path
from study.solve.tableau import MIDPOINT
from study.statements.shared.base import ListedNumbers, Setting, grid, with_h
from study.statements.shared.meshes import space_of
from study.statements.shared.norms import Velocity, dual_norm, maximum, midpoints
from study.statements.shared.scope import Scope

DEGREE, RAISED = 2, 6
"""Degrees of the cell rule for f_0, and of the rule that it is compared with."""
PER_CELL = 2
"""Time steps for each cell along a side; twice as many give the solution used for u^h."""
INSTANTS, FEW = 32, 4
"""Numbers of times for errors and velocities, and for loads by the finer rule."""
INTERPOLATION = around(1, STEEPER, "the order of interpolation; 1/2 is proved")
SINGULAR = between(0.5, 0.5, STEEPER, 0.25, "from from the two finest levels; smooth parts of order 1 raise it")
TRAIL = between(1, 1.5, STEEPER, STEEPER, "1 if cells keep different parts, 3/2 if all keep the same")
NEGLIGIBLE = positive_at_most(0.02, "of the error")


class AdvancingFront(ListedNumbers):
    """Errors, velocities and excess at a natural front that advances."""

    label = "beyond: advancing front"
    claim = "‖u − u^h‖ ~ h at an advancing natural front, where the order 1/2 is proved"
    rules = (
        between_levels("order", "order of ‖u − u^h‖ over two refinements", INTERPOLATION, "error", 2, ENOUGH),
        order("rate", "order of ‖u̇ − Π^h u̇‖_{L²(0,T;V)}", SINGULAR, "rate", last=2),
        order("excess", "order of ‖u^h − u^h_lin‖", TRAIL, "excess"),
        largest("time", "time share", NEGLIGIBLE, "time share"),
        largest("quadrature", "change under finer quadrature of f_0", NEGLIGIBLE, "quadrature"),
    )
    # Not on random meshes: there chance decides in which cells a singular front lies, and orders of single levels
    # depend on it.
    quick = grid((NAME,), ("unstructured",), (8, 16, 32))
    full = grid((NAME,), ("one-diagonal", "unstructured"), (8, 16, 32, 64))

    def settings(self, scope: Scope) -> Sequence[Setting]:
        """All settings in a study of the whole catalogue, to which the case does not belong."""
        return self.places(scope.full) if scope.whole else []

    def cost(self, setting: Setting) -> float:
        """The number of time steps grows like the number of cells along a side."""
        return 100.0 * setting.level**3

    def measure(self, setting: Setting) -> dict[str, float]:
        space, solution, steps = space_of(setting), resolve(setting.case).solution, PER_CELL * setting.level
        v_norm = ErrorNorm(solution, space)
        load = lru_cache(maxsize=None)(lambda time: load_from_forces(solution, space, time, DEGREE))
        problem = SemiDiscrete.of(space, solution.law, load, v_norm.sample(0.0).interpolant)
        # Without the contact condition, and with σ_ν as a traction.
        linear = replace(problem, N=problem.N[:0], load=lambda time: load(time) + pressure_load(solution, space, time))
        coarse, fine = (path(problem, MIDPOINT, times * steps) for times in (1, 2))
        error = largest_error(v_norm, problem.T, fine)
        rates = Velocity(solution, space).interpolation_error(midpoints(problem.T, INSTANTS))
        found = {
            "error": error,
            "rate": float(np.sqrt(problem.T * np.mean(rates**2))),
            "excess": furthest(problem, fine, path(linear, MIDPOINT, 2 * steps)),
            "time share": furthest(problem, fine[::2], coarse) / error,
            "quadrature": effect_of_quadrature(solution, space, problem) / error,
        }
        return with_h(space.h, found)


def largest_error(v_norm: ErrorNorm, T: float, states: Array) -> float:
    """Return max ‖u − u^h‖_V over about as many nodes as there are instants."""
    steps = len(states) - 1
    nodes = range(0, steps + 1, max(1, steps // INSTANTS))
    return maximum(v_norm.distance(v_norm.sample(n * T / steps), states[n]) for n in nodes)


def effect_of_quadrature(solution: ExactSolution, space: Space, problem: SemiDiscrete) -> float:
    """Return T max ‖δf‖_V for the change δf of f by finer rules, which bounds the change of u^h since G is monotone."""
    riesz, changes = Cholesky(problem.M), []
    for time in midpoints(problem.T, FEW):
        finer, coarser = (load_from_forces(solution, space, time, degree) for degree in (RAISED, DEGREE))
        changes.append(dual_norm(finer - coarser, riesz))
    return problem.T * maximum(changes)


def pressure_load(solution: ExactSolution, space: Space, time: float) -> Array:
    """Return ∫_{Γ3} σ_ν v_ν at one time, by rules graded towards the front, (n_dofs,)."""
    (face,), mesh = solution.faces, space.mesh
    assert isinstance(face, SingularFace)
    assert isinstance(face.field, TravellingField)
    rule = facet_rule(mesh, space.facets(face.part), face.part, (face.field.place_at(time),), FACET_POINTS)
    pressure = solution.on(face, rule.s).pressure(time) * rule.weights
    moments = -np.multiply.outer(face.part.normal, np.einsum("nq,anq->an", pressure, rule.shapes))
    return space.interpolate(space.scatter(mesh.facets[:, rule.facets], moments))
