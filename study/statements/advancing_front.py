"""Beyond the paper: convergence where a contact zone grows and the solution is as singular as contact theory predicts.

A *natural front* is the moving end of a frictionless contact zone, with a singularity that is not made smoother on
purpose. If the front advances, the solution violates the regularity assumption (5.36).

Near a front between contact and separation, elastic displacements of finite energy without forces behave like r^{1/2};
if they neither penetrate the foundation nor need tension, they behave like r^{3/2}. In σ = Aε(u̇) + Gε(u) the velocity
plays the role of the elastic displacement. Where the front c(t) moves, u ~ r^{3/2} gives u̇ ~ −ċ ∂_x u ~ r^{1/2} and
p ~ ċ r^{−1/2} for the contact pressure p. This p is positive if ċ > 0, but a tension if ċ < 0. So receding fronts are
expected to have gaps ~ r^{5/2} and p ~ r^{1/2}, which satisfies (5.36). paper/fronts.tex proves a part of this in the
proposition on moving fronts: no front has both a gap ~ r^{3/2} and a pressure in H^{1/2}.

The measured solution, ``manufactured.natural_motion``, is an advancing front in closed form; its forces f_0 and f_2
satisfy (3.4). **Predicted** are three orders:

* ‖u − u^h‖ ~ h, because u(t) ∈ H^{5/2−ε}. Theorem 4.1 and Proposition 5.3 apply. Proposition 5.4 does not apply; its
  proof gives the order 1/2. After the prediction the order 1, up to a logarithm, was proved (paper/fronts.tex).
* ‖u̇ − Π^h u̇‖_{L²(0,T;V)} ~ h^{1/2}. Observed orders are higher on coarse meshes, because smooth parts have order 1.
* The *excess* ‖u^h − u^h_lin‖ has an order between 1 and 3/2; the proof gives 1/2. Here u^h_lin solves the linear
  problem in which the exact normal stress σ_ν is a given traction. The front passes a cell in a time ~ h, during which
  velocities have an error of h^{1/2}. So an error of h^{3/2} remains in each of h^{−1} cells. If this error is the same
  in all cells, the sum is smooth and of order h^{3/2}; otherwise the sum is of order h.

The load is computed as (f_0, v) + (f_2, v)_{Γ2}, because f_0 is bounded, while the stress that ``ErrorNorm.load``
integrates is not.
"""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from manufactured.exact import ExactSolution
from manufactured.natural_motion import NAME
from manufactured.singular import SingularFace, TravellingField
from manufactured.tensors import Array
from study.fem.error_norm import ErrorNorm
from study.fem.independent import load_from_forces
from study.fem.naming import resolve
from study.fem.space import Space
from study.ledger import quantities
from study.ledger.check import ENOUGH, Check
from study.ledger.verdict import CheckKind
from study.ledger.window import STEEPER, around, between, positive_at_most
from study.solve.evolution import SemiDiscrete
from study.solve.factorisation import Cholesky
from study.solve.paths import furthest, path
from study.solve.tableau import MIDPOINT
from study.statements.shared.base import ListedNumbers, Setting, grid, with_h
from study.statements.shared.meshes import space_of
from study.statements.shared.norms import ContactWork, Velocity, dual_norm, maximum, midpoints

DEGREE, RAISED = 2, 6
"""Degree of the quadrature rule for f_0 on cells, and of a finer rule by which the quadrature error is estimated."""
PER_CELL = 2
"""Number of time steps for each cell along a side of the body.

The solution with twice as many steps is used as the semi-discrete solution u^h."""
INSTANTS, FEW = 32, 4
"""Number of times at which errors and velocities are measured, and number at which two quadratures are compared.

Errors are measured at about as many evenly spaced time nodes, or at all nodes if there are fewer."""
INTERPOLATION = around(1, STEEPER, "the order of the interpolation error; only 1/2 is proved")
SINGULAR = between(0.5, 0.5, STEEPER, 0.25, "order from the two finest levels; smooth parts of u̇ raise it")
TRAIL = between(1, 1.5, STEEPER, STEEPER, "3/2 if the front leaves the same error in every cell, 1 if not")
NEGLIGIBLE = positive_at_most(0.02, "negligible against the error")
FINER_QUADRATURE = "bound of the change of u^h under finer quadrature of f_0 / error"


class AdvancingFront(ListedNumbers):
    """Measures the error, the interpolation error of the velocity and the excess at an advancing natural front.

    The excess ‖u^h − u^h_lin‖_V is the part of the error that is due to contact: u^h_lin solves the linear problem in
    which the exact normal stress σ_ν is a given traction.
    """

    label = "beyond: advancing front"
    claim = "‖u − u^h‖ ~ h at an advancing natural front, where the order 1/2 is proved"
    outside_catalogue = True
    checks = (
        Check(
            "order",
            "order of ‖u − u^h‖ over two refinements",
            quantities.over_refinements("error", 2),
            INTERPOLATION,
            CheckKind.CONSEQUENCE,
            ENOUGH,
        ),
        Check(
            "rate",
            "order of ‖u̇ − Π^h u̇‖_{L²(0,T;V)}",
            quantities.fitted("rate", last=2),
            SINGULAR,
            CheckKind.CONSEQUENCE,
            ENOUGH,
        ),
        Check(
            "excess",
            "order of the excess ‖u^h − u^h_lin‖ over the linear problem",
            quantities.fitted("excess"),
            TRAIL,
            CheckKind.CONSEQUENCE,
            ENOUGH,
        ),
        Check(
            "time",
            "change of u^h with half the time step / error",
            quantities.values("time share"),
            NEGLIGIBLE,
            CheckKind.ACCURACY,
        ),
        Check("quadrature", FINER_QUADRATURE, quantities.values("quadrature"), NEGLIGIBLE, CheckKind.ACCURACY),
    )
    # No shaken meshes, because observed orders depend on the random size of the cells that the singular front passes.
    quick = grid((NAME,), ("unstructured",), (8, 16, 32))
    full = grid((NAME,), ("one-diagonal", "unstructured"), (8, 16, 32, 64))

    def cost(self, setting: Setting) -> float:
        """Return the expected run time in µs.

        The run time grows like n³ with the level n: there are n² cells, and the number of time steps is proportional
        to n.
        """
        return 100.0 * setting.level**3

    def measure(self, setting: Setting) -> dict[str, float]:
        space, solution, steps = space_of(setting), resolve(setting.case).solution, PER_CELL * setting.level
        v_norm = ErrorNorm(solution, space)
        load = lru_cache(maxsize=None)(lambda time: load_from_forces(solution, space, time, DEGREE))
        problem = SemiDiscrete.of(space, solution.law, load, v_norm.sample(0.0).interpolant)
        # Without rows of N there is no contact condition, so the exact σ_ν acts as a given traction in the load.
        linear = replace(problem, N=problem.N[:0], load=lambda time: load(time) + pressure_load(solution, space, time))
        coarse, fine = (path(problem, MIDPOINT, times * steps) for times in (1, 2))
        nodes = range(0, 2 * steps + 1, max(1, 2 * steps // INSTANTS))
        error = maximum(v_norm.distance(v_norm.sample(n * problem.T / (2 * steps)), fine[n]) for n in nodes)
        # A change δf of the load changes u^h by at most T max ‖δf‖_V, because the elasticity G is monotone.
        riesz, changes = Cholesky(problem.M), []
        for time in midpoints(problem.T, FEW):
            finer, coarser = (load_from_forces(solution, space, time, degree) for degree in (RAISED, DEGREE))
            changes.append(dual_norm(finer - coarser, riesz))
        rates = Velocity(solution, space).interpolation_error(midpoints(problem.T, INSTANTS))
        found = {
            "error": error,
            "rate": float(np.sqrt(problem.T * np.mean(rates**2))),
            "excess": furthest(problem, fine, path(linear, MIDPOINT, 2 * steps)),
            "time share": furthest(problem, fine[::2], coarse) / error,
            "quadrature": problem.T * maximum(changes) / error,
        }
        return with_h(space.h, found)


def pressure_load(solution: ExactSolution, space: Space, time: float) -> Array:
    """Return the exact contact force at one time as a load vector, v ↦ ∫_{Γ3} σ_ν v_ν, (dofs,).

    The quadrature points are graded towards the front, where σ_ν is singular.
    """
    (face,) = solution.faces
    assert isinstance(face, SingularFace)
    assert isinstance(face.field, TravellingField)
    return ContactWork(solution, space, (face.field.place_at(time),)).load(time)
