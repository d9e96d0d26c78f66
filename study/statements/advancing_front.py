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
  proof gives the order 1/2. After this prediction two theorems were proved, for polygons with the regularity (Reg) of
  paper/fronts.tex and loads of bounded variation in time: the error is at most C h |log h| for fronts that advance with
  a speed above a positive bound, as here, and at most C h^{9/10} |log h|^{3/5} for fronts of any speed.
* ‖u̇ − Π^h u̇‖_{L²(0,T;V)} ~ h^{1/2}. Observed orders are higher on coarse meshes, because smooth parts have order 1.
* The *excess* ‖u^h − u^h_lin‖ has an order between 1 and 3/2; the proof gives 1/2. Here u^h_lin solves the linear
  problem in which the exact normal stress σ_ν is a given traction. The front passes a cell in a time ~ h, during which
  velocities have an error of h^{1/2}. So an error of h^{3/2} remains in each of h^{−1} cells. If this error is the same
  in all cells, the sum is smooth and of order h^{3/2}; otherwise the sum is of order h.

**Predicted** for what the proofs of these theorems use, from a prototype with one diagonal and n ≤ 128. L is |log h|:

* *(local)* is ∫_0^T (Σ_a λ_a (P_hu)_ν(a))^+ dt, the work of the discrete contact forces λ_a on violations of the
  constraint by the projection P_hu. At most C h² L² is proved (last remark of paper/fronts.tex). The prototype has at
  most 0.001 h² L². At most 0.01 h² L² is demanded: with |(P_hu)_ν(a)| in place of (P_hu)_ν(a) it would be 0.05 to 0.16.
  Unstructured meshes, which the prototype did not have, were found to need up to 0.0044.
* *Pairing*, the largest |∫_0^t (u̇^h, D_h)_V ds| over t, where D_h is the interpolant of ∂_x(ζ_0 W^h) ν at the front and
  W^h = x (r² + h²)^{−1/4}. At most C L is proved (Lemma 2), because D_h travels and u̇^h has half a derivative in time;
  from ‖D_h‖_V alone it could grow like h^{−1/2}. The prototype grows by 0.24 to 0.29 whenever n is doubled. From
  n = 16 the increments must lie between 0.1 and 0.5: a bounded pairing falls below 0.1.
* *Half a derivative* of u̇^h in time: see ``half_derivative``, with the same windows.

The load is computed as (f_0, v) + (f_2, v)_{Γ2}, because f_0 is bounded, while the stress that ``ErrorNorm.load``
integrates is not.
"""

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np

from manufactured.exact import ExactSolution
from manufactured.natural_motion import NAME
from manufactured.tensors import Array
from study.fem.error_norm import ErrorNorm
from study.fem.independent import load_from_forces
from study.fem.space import Space
from study.ledger.check import ENOUGH, accuracy, consequence
from study.ledger.quantities import fitted, over_refinements, values
from study.ledger.window import STEEPER, Window, around, at_most, between, positive_at_most
from study.solve.evolution import SemiDiscrete
from study.solve.factorisation import Cholesky
from study.solve.paths import furthest, path
from study.solve.signorini import Signorini
from study.solve.tableau import MIDPOINT
from study.statements.half_derivative import HALF_DERIVATIVE, RADIUS, front_at, half_quotient
from study.statements.shared.base import ListedNumbers, Numbers, Setting, grid, with_h
from study.statements.shared.meshes import posed
from study.statements.shared.norms import ContactWork, Velocity, dual_norm, maximum, midpoints

DEGREE, RAISED = 2, 6
"""Degree of the quadrature rule for f_0 on cells, and of a finer rule by which the quadrature error is estimated."""
PER_CELL = 2
"""Number of time steps for each cell along a side of the body.

The solution with twice as many steps is used as the semi-discrete solution u^h."""
INSTANTS, FEW = 32, 4
"""Number of times at which errors and velocities are measured, and number at which two quadratures are compared.

Errors are measured at about as many evenly spaced time nodes, or at all nodes if there are fewer."""
INCREMENT = 1e-30
"""Imaginary increment with which a derivative is computed."""
FROM = 16
"""The level from which the growth of the pairing is judged."""
NEGLIGIBLE = positive_at_most(0.02, "negligible against the error")


class AdvancingFront(ListedNumbers):
    """Measures the error, the interpolation error of the velocity and the excess at an advancing natural front.

    The excess ‖u^h − u^h_lin‖_V is the part of the error that is due to contact: u^h_lin solves the linear problem in
    which the exact normal stress σ_ν is a given traction.
    """

    label = "beyond: advancing front"
    claim = "‖u − u^h‖ ~ h at a natural front that advances, where C h |log h| is proved"
    outside_catalogue = True
    checks = (
        consequence(
            "order",
            "order of ‖u − u^h‖ over two refinements",
            over_refinements("error", 2),
            around(1, STEEPER, "the order of the interpolation error; proved up to a logarithm"),
            levels=ENOUGH,
        ),
        consequence(
            "rate",
            "order of ‖u̇ − Π^h u̇‖_{L²(0,T;V)}",
            fitted("rate", last=2),
            between(0.5, 0.5, STEEPER, 0.25, "order from the two finest levels; smooth parts of u̇ raise it"),
            levels=ENOUGH,
        ),
        consequence(
            "excess",
            "order of the excess ‖u^h − u^h_lin‖ over the linear problem",
            fitted("excess"),
            between(1, 1.5, STEEPER, STEEPER, "3/2 if the front leaves the same error in every cell, 1 if not"),
            levels=ENOUGH,
        ),
        accuracy("time", "change of u^h with half the time step / error", values("time share"), NEGLIGIBLE),
        consequence(
            "local",
            "work of the contact forces on violations of the constraint by P_hu / (h |log h|)²",
            values("local"),
            at_most(0.01, "h² |log h|² is proved; 0.05 to 0.16 without cancellation"),
        ),
        consequence(
            "pairing",
            "increment of max_t |∫_0^t (u̇^h, D_h)_V ds| when n is doubled",
            lambda table: np.diff(table[table["level"] >= FROM]["pairing"].to_numpy()),
            Window(0.1, 0.5, "growth like log n; bounded or like a power of n is excluded"),
        ),
        *HALF_DERIVATIVE,
        accuracy(
            "quadrature",
            "bound of the change of u^h under finer quadrature of f_0 / error",
            values("quadrature"),
            NEGLIGIBLE,
        ),
    )
    # No shaken meshes, because observed orders depend on the random size of the cells that the singular front passes.
    quick = grid((NAME,), ("unstructured",), (8, 16, 32))
    full = grid((NAME,), ("one-diagonal", "unstructured"), (8, 16, 32, 64))

    def cost(self, setting: Setting) -> float:
        """Return the expected run time in µs.

        The run time grows like n³ with the level n: there are n² cells, and the number of time steps is proportional
        to n.
        """
        return 150.0 * setting.level**3

    def measure(self, setting: Setting) -> Numbers:
        space, solution = posed(setting)
        steps = PER_CELL * setting.level
        v_norm = ErrorNorm(solution, space)
        load = lru_cache(maxsize=None)(lambda time: load_from_forces(solution, space, time, DEGREE))
        problem = SemiDiscrete.of(space, solution.law, load, v_norm.sample(0.0).interpolant)
        # Without rows of N there is no contact condition, so the exact σ_ν acts as a given traction in the load.
        linear = replace(problem, N=problem.N[:0], load=lambda time: load(time) + pressure_load(solution, space, time))
        coarse = path(problem, MIDPOINT, steps)
        states = list(MIDPOINT.march(problem, 2 * steps))
        fine = np.array([state.u for state in states])
        forces = np.array([state.multipliers for state in states[1:]])
        nodes = range(0, 2 * steps + 1, max(1, 2 * steps // INSTANTS))
        error = maximum(v_norm.distance(v_norm.sample(n * problem.T / (2 * steps)), fine[n]) for n in nodes)
        # A change δf of the load changes u^h by at most T max ‖δf‖_V, because the elasticity G is monotone.
        riesz = Cholesky(problem.M)
        changes = []
        for time in midpoints(problem.T, FEW):
            finer, coarser = (load_from_forces(solution, space, time, degree) for degree in (RAISED, DEGREE))
            changes.append(dual_norm(finer - coarser, riesz))
        rates = Velocity(solution, space).interpolation_error(midpoints(problem.T, INSTANTS))
        found = {
            "error": error,
            "rate": math.sqrt(problem.T * np.mean(rates**2)),
            "excess": furthest(problem, fine, path(linear, MIDPOINT, 2 * steps)),
            "time share": furthest(problem, fine[::2], coarse) / error,
            "quadrature": problem.T * maximum(changes) / error,
            "local": violation(v_norm, problem, forces) / (space.h * math.log(space.h)) ** 2,
            "pairing": pairing(solution, space, problem.M @ np.diff(fine, axis=0).T),
            "half": half_quotient(problem, fine),
        }
        return with_h(space.h, found)


def pressure_load(solution: ExactSolution, space: Space, time: float) -> Array:
    """Return the exact contact force at one time as a load vector, v ↦ ∫_{Γ3} σ_ν v_ν, (dofs,).

    The quadrature points are graded towards the front, where σ_ν is singular.
    """
    return ContactWork(solution, space, (front_at(solution, time),)).load(time)


def violation(v_norm: ErrorNorm, problem: SemiDiscrete, forces: Array) -> float:
    """Return ∫_0^T (Σ_a λ_a (P_hu)_ν(a))^+ dt, where P_h is the projection onto V^h in (·,·)_V.

    Args:
        v_norm: gives the exact solution u.
        problem: the semi-discrete problem.
        forces: the contact forces λ in the middle of each time step, (steps, m).
    """
    project = Signorini(problem.M, problem.N)
    A = v_norm.A.matrix
    times = midpoints(problem.T, len(forces))
    functionals = np.array([v_norm.space.functional(A @ v_norm.means(time)) for time in times])
    works = np.sum(forces * project.gap(functionals), axis=1)
    return problem.T * float(np.mean(np.maximum(works, 0.0)))


def pairing(solution: ExactSolution, space: Space, momenta: Array) -> float:
    """Return the largest value of |∫_0^t (u̇^h, D_h)_V ds| over the time nodes t.

    Args:
        solution, space: the exact solution, which gives the front, and the space V^h.
        momenta: the functionals (u_n − u_{n−1}, ·)_V of the time steps, (dofs, steps).
    """
    (face,) = solution.faces
    (along,), into = face.part.coordinates(space.mesh.p)
    times = midpoints(space.body.T, momenta.shape[1])
    weights = [travelling_weight(along - front_at(solution, time), into, space.h) for time in times]
    fields = [space.interpolate(np.multiply.outer(face.part.normal, weight)) for weight in weights]
    return float(abs(np.cumsum(np.sum(np.array(fields) * momenta.T, axis=1))).max())


def travelling_weight(x: Array, y: Array, h: float) -> Array:
    """Return ∂_x(ζ_0 W^h) for W^h = x (x² + y² + h²)^{−1/4} and the cut-off ζ_0 = (1 − (x² + y²)/``RADIUS``²)_+^4."""
    z = x + INCREMENT * 1j
    inside = 1 - (z**2 + y**2) / RADIUS**2
    values = z * (z**2 + y**2 + h**2) ** -0.25 * inside**4
    # The imaginary part of f(x + iε) is ε f'(x) up to rounding.
    return np.where(inside.real > 0, values.imag / INCREMENT, 0.0)
