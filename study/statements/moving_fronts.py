"""Beyond the paper: convergence at advancing natural fronts, and two lemmas with which its order is proved."""

import math
from dataclasses import replace
from functools import lru_cache, partial

import numpy as np
import pandas as pd

from manufactured.body import Kind
from manufactured.catalogue import NATURAL_MOTION
from manufactured.exact import ExactSolution
from manufactured.modes import at_each
from manufactured.singular import SingularFace, TravellingField
from manufactured.tensors import Array, Points, Tensors, Vectors, mandel
from study.fem.error_norm import ErrorNorm
from study.fem.independent import load_from_forces
from study.fem.mesh import barycentric_gradients
from study.fem.quadrature import gauss
from study.fem.space import Space, form
from study.ledger.check import MIN_LEVELS, Groups, accuracy, consequence, identity
from study.ledger.quantities import change, over_refinements
from study.ledger.window import STEEPER, Window, around, at_least, at_most, between, positive_at_most
from study.solve.evolution import SemiDiscrete, furthest, histories, norm, path
from study.solve.factorisation import Cholesky
from study.solve.gradient_flow import EulerBounds
from study.solve.signorini import Signorini
from study.solve.tableau import BACKWARD_EULER, MIDPOINT
from study.statements.shared.base import (
    Experiment,
    Judged,
    ListedNumbers,
    Numbers,
    Setting,
    check_of_order,
    grid,
    with_h,
)
from study.statements.shared.meshes import posed, split
from study.statements.shared.norms import Energies, Field, contact_load, dual_norm, maximum, midpoints, time_nodes
from study.statements.time_steps import PROVED_BELOW_1
from study.statements.work_of_contact import SEEDS

STEPS_PER_CELL = 4
"""Number of time steps for each cell along a side of the body, in ``HalfDerivative``."""
CUT_RADIUS = 0.2
"""Radius R of the cut-off (1 − r²/R²)_+^4 about the contact front, where r is the distance from the front."""
MIDDLE_TIME, SPEED, FRONTS = 0.625, 0.4, 8
"""The time at which the front is in the middle of Γ3, its speed, and the number of its positions in an edge."""
BEHIND = 3.0
"""Largest distance behind the contact front, in edges of the mesh, at which signed nodal errors are measured."""
GAUSS_POINTS = 20
"""Number of Gauss points on each edge of a cell."""

HALF_DERIVATIVE = (
    identity(
        "half",
        "mean of ‖u̇^h(t + τ) − u̇^h(t)‖² over τ < δ, integrated over t / (C_2 δ), largest over δ",
        "half",
        PROVED_BELOW_1,
    ),
    consequence(
        "half-growth",
        "the same quotient, finest / coarsest mesh",
        change("half"),
        at_most(1.25, "the constant does not depend on the mesh"),
        levels=MIN_LEVELS,
    ),
)


def half_quotient(problem: SemiDiscrete, states: Array) -> float:
    """Return the largest quotient of both sides of the bound of half a derivative in time of the discrete velocity.

    ``HalfDerivative`` states the bound: the mean over τ < δ of ∫ ‖u̇^h(t + τ) − u̇^h(t)‖² dt is at most C_2 δ. The
    quotient is largest over δ = 2k, 4k, 8k, … up to T/4, with the time step k. The integrals are exact for the velocity
    of the midpoint rule, which is constant in every step.

    Args:
        problem: the semi-discrete problem.
        states: the displacements that the midpoint rule computed, (steps + 1, dofs).
    """
    steps = len(states) - 1
    k = problem.T / steps
    velocities = np.diff(states, axis=0) / k
    middles = (states[1:] + states[:-1]) / 2
    loads = problem.load(MIDPOINT.balanced(np.arange(1, steps + 1), k)).T
    g = Cholesky(problem.M)(loads - [problem.elastic(u) for u in middles])
    speed = norm(problem, velocities).max()
    variation = norm(problem, np.diff(g, axis=0)).sum()
    constant = speed * (2 * variation + speed / 2 + norm(problem, g - velocities).max())
    # jumps[i, j] is the distance of the velocities in the steps i and j.
    jumps = np.array([norm(problem, velocities - velocity) for velocity in velocities])
    quotients = []
    for count in 2 ** np.arange(1, int(np.log2(steps / 4)) + 1):
        shifted = [np.sum(np.diagonal(jumps, shift)[: steps - count] ** 2) for shift in range(count + 1)]
        quotients.append(np.trapezoid(shifted) / count**2)
    return maximum(quotients) / constant


def euler_quotient(flow: EulerBounds, states: Array) -> float:
    """Return Σ_n ‖δ_n − δ_{n−1}‖_V² for velocities δ_n of backward Euler, divided by its bound in ``HalfDerivative``.

    δ_n = (U_n − U_{n−1})/k are difference quotients of the displacements U_n with the step k, and δ_0 is the initial
    velocity u̇^h(0+) of the semi-discrete solution.

    Args:
        flow: the problem, with its loads at the time nodes t_0, …, t_N and the Lipschitz constant κ = L_G/m_A.
        states: the displacements U_0, …, U_N, (N + 1, dofs).
    """
    rates = np.vstack([flow.start, np.diff(states, axis=0) / flow.interval])
    jumps = norm(flow.problem, np.diff(rates, axis=0))
    speeds = norm(flow.problem, rates[1:])
    growth = flow.kappa * flow.interval * speeds.sum()
    return float(jumps @ jumps / (flow.first**2 + 2 * speeds.max() * (flow.variation + growth)))


class HalfDerivative(ListedNumbers):
    """Measures half a derivative in time of the discrete velocity u̇^h, divided by its bound.

    Beyond the paper: u̇^h has half a derivative in time. This is a lemma in the proof of the order of the error at
    moving fronts (paper/velocity.tex).

    **The lemma.** Let f be the load, B the operator of (4.2), P_h the projection onto V^h in (·,·)_V, and g = P_h(f −
    Bu^h). In the norm of V let M = max ‖u̇^h‖, W = Var g, Ξ = max ‖g − u̇^h‖ and C_2 = 2MW + M²/2 + MΞ. The lemma says
    for 0 < δ < T/2

        1/δ ∫_0^δ ∫_0^{T−δ} ‖u̇^h(t + τ) − u̇^h(t)‖² dt dτ ≤ C_2 δ.

    For backward Euler a similar inequality holds for every time step k. With the difference quotients δ_n = (U_n −
    U_{n−1})/k of its values U_n, δ_0 = u̇^h(0+) and κ = L_G/m_A,

        Σ_n ‖δ_n − δ_{n−1}‖² ≤ ‖δ_0‖² + 2 max_n ‖δ_n‖ (Var f + κ Σ_n k ‖δ_n‖).

    **Measured** are the quotients of both sides: for the midpoint rule with the time step k = T/(4n) the largest
    quotient over δ = 2k, 4k, 8k, … up to T/4, and for backward Euler with the same step the quotient of the second
    inequality.

    **Predicted** before these programs existed, from prototypes: both quotients are at most 1, as proved. The quotient
    for the midpoint rule is about 0.13, the largest value of 84 small systems. It does not grow with n: its value on
    the finest mesh is at most 1.25 times its value on the coarsest mesh. If u̇^h did not have half a derivative in time
    uniformly in h, the quotient would grow like n.
    """

    label = "beyond: half a derivative"
    claim = "u̇^h has half a derivative in time, bounded independently of h, and so have velocities of backward Euler"
    effort = 10
    checks = (
        *HALF_DERIVATIVE,
        identity("euler", "backward Euler: Σ ‖δ_n − δ_{n−1}‖² / its bound", "euler", PROVED_BELOW_1),
    )
    quick = grid(("advance-recede",), ("one-diagonal",), (4, 8, 16))
    full = grid(("advance-recede", "travelling-patch", "yield-and-release"), ("one-diagonal",), (8, 16, 32))

    def setup(self, setting: Setting) -> Experiment:
        return Experiment.at(setting, MIDPOINT, STEPS_PER_CELL * setting.level)

    def measure(self, setup: Experiment) -> Numbers:
        problem = setup.solved or setup.problem
        steps = setup.steps
        flow = EulerBounds(problem, problem.load(time_nodes(problem.T, steps)).T, setup.solution.law.kappa)
        numbers = {
            "half": half_quotient(problem, path(problem, MIDPOINT, steps)),
            "euler": euler_quotient(flow, path(problem, BACKWARD_EULER, steps)),
        }
        return with_h(setup.space.h, numbers)


SIGN = consequence(
    "sign",
    "largest (P_hu_s)_ν / (θ h^{3/2}) at vertices in contact behind the front, over shaken meshes",
    lambda table: table["signed"].max(),
    at_least(0.01, "so the constraint is violated behind the front"),
)


class NodalErrors(ListedNumbers):
    """Measures nodal errors of the projection P_hu of the exact displacement u near an advancing natural front.

    Beyond the paper: a bound of these errors at the vertices of Γ3. It is a lemma in the proof of the order of the
    error at moving fronts (paper/fronts.tex).

    P_h is the projection onto V^h in (·,·)_V. The exact displacement u is an advancing natural front
    (``manufactured.cases.rough.natural_motion``): at the time t it is θ(t) times a field that is singular at the point
    x(t) of Γ3, the front. Only its part near the front is projected, u_s = ζ u with the cut-off ζ = (1 − r²/R²)_+^4,
    where r is the distance from the front and R = 1/5. The lemma says, with L = |log h|, for all vertices a of Γ3

        |(P_hu_s − Π^hu_s)_ν(a)| ≤ C h² L (h + |a − x(t)|)^{−1/2}.

    Two numbers are measured, each over eight positions of the front within an edge:

    * the largest C/θ, where C is the least number for which the inequality holds;
    * the largest signed error (P_hu_s)_ν(a)/(θ h^{3/2}) at vertices in contact, at most three edges behind the front.
      There u_ν = 0, so P_hu_s violates the contact constraint at a if the number is positive.

    **Predicted** before these programs existed, from prototypes:

    * C/θ ≤ 1.5 on all mesh families. The prototypes had 0.3 to 0.9 for n ≤ 128, and 0.9 to 2.2 for another cut-off that
      leaves more of u. C/θ may still rise slowly on finer meshes.
    * The signed error is at least 0.01 on at least one of eight shaken meshes. In a prototype without a cut-off it was
      −0.2 to 0.09 on single shaken meshes. So it is false in general that P_hu_s satisfies the contact constraint
      behind the front, which fine one-diagonal meshes suggest.
    """

    label = "beyond: nodal errors"
    claim = "|(P_hu_s − Π^hu_s)_ν(a)| ≤ C h² |log h| (h + |a − x(t)|)^{−1/2} on Γ3, with both signs on irregular meshes"
    outside_catalogue = True
    effort = 4
    # Random meshes stand only on a level above the quick study, so that repetitions with other seeds leave them out.
    quick = grid((NATURAL_MOTION,), ("one-diagonal",), (16,))
    full = (
        *grid((NATURAL_MOTION,), ("one-diagonal", "criss-cross", "alternating", "unstructured"), (16, 32, 64)),
        *grid((NATURAL_MOTION,), SEEDS, (32,)),
    )

    def measure(self, setting: Setting) -> Numbers:
        space, solution = posed(setting)
        (part,) = space.body.of(Kind.CONTACT)
        (_, vertices) = space.contact[0]
        A = solution.law.A
        h = space.h
        condensed = Signorini(form(space, A), space.N)
        corners = space.mesh.p[:, vertices]
        (s,) = part.coordinates(corners)[0]
        constants = []
        signed = []
        for time in MIDDLE_TIME + np.arange(FRONTS) / FRONTS * h / SPEED:
            behind = front_at(solution, time) - s
            near_front = partial(cut_solution, solution, time)
            projected = condensed.gap(space.functional(A.matrix @ means_from_edges(near_front, space)))
            error = (projected - part.normal @ near_front(corners)) / (time + 0.25)
            constants.append(abs(error * np.sqrt(h + abs(behind))).max())
            signed.append(error[(behind >= 0) & (behind <= BEHIND * h)].max())
        numbers = {"constant": maximum(constants) / (h**2 * abs(np.log(h))), "signed": maximum(signed) / h**1.5}
        return with_h(h, numbers)

    def checks_of(self, case: str, groups: Groups) -> Judged:
        """Yield two checks of nodal errors of the projection P_hu onto V^h near the front (``NodalErrors``).

        The first demands that C/θ, the constant in the bound of the nodal errors over the factor θ(t) of the solution,
        is at most 1.5 on all meshes. The second demands that on at least one random mesh (P_hu_s)_ν/(θ h^{3/2}) is at
        least 0.01 at a vertex in contact behind the front: this projected displacement penetrates the foundation.

        Args:
            case: the name of the case, which is not used.
            groups: the measured tables by mesh family, with one row for each level.
        """
        yield (
            consequence(
                "constant",
                "largest |(P_hu_s − Π^hu_s)_ν(a)| (h + |a − x|)^{1/2} / (θ h² |log h|)",
                "constant",
                at_most(1.5, "bounded on every mesh family"),
            ),
            groups,
        )
        random, _ = split(groups, "random")
        if random:
            yield SIGN, {SEEDS[0]: pd.concat(random.values())}


def front_at(solution: ExactSolution, time: float) -> float:
    """Return the coordinate c(t) of the contact front along the contact face at a time.

    Args:
        solution: the exact solution, with one contact face and one front.
        time: the time t.
    """
    (face,) = solution.faces
    assert isinstance(face, SingularFace)
    assert isinstance(face.field, TravellingField)
    return face.field.place_at(time)


def cut_solution(solution: ExactSolution, time: float, x: Points) -> Vectors:
    """Return the displacement near the front, u_s(x) = (1 − r²/R²)_+^4 u(x), at points, (2, points).

    u is the exact displacement, r the distance of x from the contact front, and R = ``CUT_RADIUS``.

    Args:
        solution: the exact solution, with one contact face and one front.
        time: the time.
        x: the points, (2, points).
    """
    place = solution.faces[0].part.point(np.array([[front_at(solution, time)]]))
    cut = np.maximum(1 - np.sum((x - place) ** 2, axis=0) / CUT_RADIUS**2, 0.0) ** 4
    return cut * solution.at(x).displacement(time)


def means_from_edges(
    displacement: Field, space: Space, cells: Array | slice = np.s_[:], points: int = GAUSS_POINTS
) -> Tensors:
    """Return the mean of the strain ε(u) on some cells, (D, n), from the displacement u on their edges.

    By the divergence theorem, ∫_T ∇u = Σ_e ν_e ⊗ ∫_e u for the edges e of a cell T with the normals ν_e. On the edge e
    opposite to vertex i with the hat function λ_i, |e| ν_e = −2|T| ∇λ_i. So the mean of ∇u is −2 Σ_i ∇λ_i ⊗ ū_i, where
    ū_i is the mean of u on this edge.

    Args:
        displacement: the displacement u, a function of points.
        space: the space V^h in 2D.
        cells: the numbers of the cells, (n,).
        points: number of Gauss points on each edge.
    """
    places, weights = gauss(points)
    corners = space.mesh.p[:, space.mesh.t[:, cells]]
    first = corners[:, [1, 2, 0]]
    second = corners[:, [2, 0, 1]]
    x = first[..., None] + (second - first)[..., None] * places
    means = displacement(x.reshape(2, -1)).reshape(x.shape) @ weights
    gradients = barycentric_gradients(space.mesh)[cells]
    return mandel(-2 * np.einsum("din,nij->djn", means, gradients))


FORCE_DEGREE, RAISED_FORCE_DEGREE = 2, 6
"""Degrees of the quadrature rule for the body force on cells, and of a finer rule that shows the quadrature error."""
FRONT_STEPS_PER_CELL = 2
"""Number of time steps for each cell along a side of the body, in ``AdvancingFront``.

The solution with twice as many steps is used as the semi-discrete solution u^h.
"""
ERROR_INSTANTS, FEW_INSTANTS = 32, 4
"""Number of times at which errors and velocities are measured, and number at which two quadratures are compared.

Errors are measured at about as many evenly spaced time nodes, or at all nodes if there are fewer."""
INCREMENT = 1e-30
"""Imaginary increment with which ``travelling_weight`` computes a derivative."""
FROM = 16
"""The level from which the growth of the quantity ``pairing`` is judged."""
NEGLIGIBLE_SHARE = positive_at_most(0.02, "negligible against the error")


class AdvancingFront(ListedNumbers):
    """Measures the error, the interpolation error of the velocity and the excess at an advancing natural front.

    Beyond the paper: the contact zone grows, and the solution is as singular as contact theory predicts. A *natural
    front* is the moving end of a frictionless contact zone, with a singularity that is not made smoother on purpose. If
    the front advances, the solution violates the regularity assumption (5.36).

    **The solution.** Near a front between contact and separation, elastic displacements of finite energy without forces
    behave like r^{1/2}. If they neither penetrate the foundation nor need tension, they behave like r^{3/2}. In σ =
    Aε(u̇) + Gε(u) the velocity plays the role of the elastic displacement. Where the front c(t) moves, u ~ r^{3/2}
    gives u̇ ~ −ċ ∂_x u ~ r^{1/2} and p ~ ċ r^{−1/2} for the contact pressure p. This p is positive if ċ > 0, but a
    tension if ċ < 0. So receding fronts are expected to have gaps ~ r^{5/2} and p ~ r^{1/2}, which satisfies (5.36). A
    part of this is proved (paper/fronts.tex, proposition on moving fronts): no front has both a gap ~ r^{3/2} and a
    pressure in H^{1/2}. The measured solution, ``manufactured.cases.rough.natural_motion``, is an advancing front in
    closed form; its forces f_0 and f_2 satisfy (3.4).

    **Measured and predicted** are three orders:

    * ‖u − u^h‖ ~ h, because u(t) ∈ H^{5/2−ε}. Theorem 4.1 and Proposition 5.3 apply. Proposition 5.4 does not apply;
      its proof gives the order 1/2.
    * ‖u̇ − Π^h u̇‖_{L²(0,T;V)} ~ h^{1/2}. Observed orders are higher on coarse meshes, because smooth parts have order
      1.
    * The *excess* ‖u^h − u^h_lin‖, the part of the error that is due to contact, has an order between 1 and 3/2; the
      proof gives 1/2. Here u^h_lin solves the linear problem in which the exact normal stress σ_ν is a given traction.
      The front passes a cell in a time ~ h, during which velocities have an error of h^{1/2}. So an error of the size
      h^{3/2} remains in each of h^{−1} cells. If these errors have independent signs, they add up to h^{3/2} h^{−1/2} =
      h. If they are the same in all cells, their sum is a smooth field of order h^{3/2}.

    After this prediction two theorems about the error ‖u − u^h‖ were proved. They hold for polygons with the regularity
    (Reg) of paper/fronts.tex and for loads of bounded variation in time. The error is at most C h |log h| if fronts
    advance with a speed above a positive bound, as here. It is at most C h^{9/10} |log h|^{3/5} for fronts of any
    speed.

    **Measured and predicted** for what the proofs of these theorems use, from a prototype with one diagonal and n ≤
    128. L is |log h|:

    * *(local)* is ∫_0^T (Σ_a λ_a (P_hu)_ν(a))^+ dt. It is the work of the discrete contact forces λ_a where P_hu
      violates the constraint; P_h is the projection onto V^h in (·,·)_V. At most C h² L² is proved (last remark of
      paper/fronts.tex). The prototype has at most 0.001 h² L². At most 0.01 h² L² is demanded: with |(P_hu)_ν(a)| in
      place of (P_hu)_ν(a) it would be 0.05 to 0.16.
    * *Pairing*, the largest |∫_0^t (u̇^h, D_h)_V ds| over t, is the term of the proof in which a singular field D_h
      travels with the front. D_h is the interpolant of ∂_x(ζ_0 W^h) ν, with W^h = x (r² + h²)^{−1/4} and a cut-off ζ_0
      that is 1 near the front. At most C L is proved (Lemma 2 of paper/fronts.tex), because D_h travels and u̇^h has
      half a derivative in time; from ‖D_h‖_V alone it could grow like h^{−1/2}. The prototype grows by 0.24 to 0.29
      whenever n is doubled. From n = 16 the increments must lie between 0.1 and 0.5: a bounded pairing falls below 0.1.
    * *Half a derivative* of u̇^h in time, with the windows of ``HalfDerivative``.

    **Found**: unstructured meshes, which the prototype did not have, need up to 0.0044 h² L² for *(local)*.

    The load is computed as (f_0, v) + (f_2, v)_{Γ2}, because f_0 is bounded, while the stress that ``ErrorNorm.load``
    integrates is not.
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
            levels=MIN_LEVELS,
        ),
        check_of_order(
            "rate",
            "order of ‖u̇ − Π^h u̇‖_{L²(0,T;V)}",
            "rate",
            between(0.5, 0.5, STEEPER, 0.25, "order from the two finest levels; smooth parts of u̇ raise it"),
            last=2,
        ),
        check_of_order(
            "excess",
            "order of the excess ‖u^h − u^h_lin‖ over the linear problem",
            "excess",
            between(1, 1.5, STEEPER, STEEPER, "3/2 if the front leaves the same error in every cell, 1 if not"),
        ),
        accuracy("time", "change of u^h with half the time step / error", "time share", NEGLIGIBLE_SHARE),
        consequence(
            "local",
            "work of the contact forces on violations of the constraint by P_hu / (h |log h|)²",
            "local",
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
            "quadrature",
            NEGLIGIBLE_SHARE,
        ),
    )
    # No shaken meshes, because observed orders depend on the random size of the cells that the singular front passes.
    quick = grid((NATURAL_MOTION,), ("unstructured",), (8, 16, 32))
    full = grid((NATURAL_MOTION,), ("one-diagonal", "unstructured"), (8, 16, 32, 64))

    def cost(self, setting: Setting) -> float:
        """Return the expected run time in µs.

        The run time grows like n³ with the level n: there are n² cells, and the number of time steps is proportional
        to n.
        """
        return 150.0 * setting.level**3

    def measure(self, setting: Setting) -> Numbers:
        space, solution = posed(setting)
        steps = FRONT_STEPS_PER_CELL * setting.level
        v_norm = ErrorNorm(solution, space)
        force = lru_cache(maxsize=None)(lambda time: load_from_forces(solution, space, time, FORCE_DEGREE))

        def pressed(time: float) -> Array:
            # The quadrature points are graded towards the front, where σ_ν is singular.
            return force(time) + contact_load(solution, space, (front_at(solution, time),))(time)

        problem = replace(SemiDiscrete.of_exact(v_norm), load=partial(at_each, of=force))
        # Without rows of N there is no contact condition, so the exact σ_ν acts as a given traction in the load.
        linear = replace(problem, N=problem.N[:0], load=partial(at_each, of=pressed))
        coarse = path(problem, MIDPOINT, steps)
        fine, forces = histories(MIDPOINT.march(problem, 2 * steps))
        nodes = np.arange(0, 2 * steps + 1, max(1, 2 * steps // ERROR_INSTANTS))
        error = v_norm.largest(nodes * problem.T / (2 * steps), fine[nodes])
        # A change δf of the load changes u^h by at most T max ‖δf‖_V, because the elasticity G is monotone.
        changes = [
            load_from_forces(solution, space, time, RAISED_FORCE_DEGREE) - force(time)
            for time in midpoints(problem.T, FEW_INSTANTS)
        ]
        rates = Energies(solution, space, aligned=False).velocity_error(midpoints(problem.T, ERROR_INSTANTS))
        numbers = {
            "error": error,
            "rate": math.sqrt(problem.T * np.mean(rates**2)),
            "excess": furthest(problem, fine, path(linear, MIDPOINT, 2 * steps)),
            "time share": furthest(problem, fine[::2], coarse) / error,
            "quadrature": problem.T * dual_norm(np.array(changes), Cholesky(problem.M)).max() / error,
            "local": violation(v_norm, problem, forces[1:]) / (space.h * math.log(space.h)) ** 2,
            "pairing": pairing(solution, space, problem.M @ np.diff(fine, axis=0).T),
            "half": half_quotient(problem, fine),
        }
        return with_h(space.h, numbers)


def violation(v_norm: ErrorNorm, problem: SemiDiscrete, forces: Array) -> float:
    """Return the work of the discrete contact forces where the projection P_hu violates the constraint, ∫_0^T w^+ dt.

    Here w = Σ_a λ_a (P_hu)_ν(a), with the forces λ_a at the contact vertices a. P_hu is the projection of the exact
    displacement u onto V^h in (·,·)_V.

    Args:
        v_norm: gives the exact solution u.
        problem: the semi-discrete problem.
        forces: the contact forces λ_a in the middle of each time step, (steps, m).
    """
    project = Signorini(problem.M, problem.N)
    A = v_norm.A.matrix
    times = midpoints(problem.T, len(forces))
    functionals = np.array([v_norm.space.functional(A @ sample.means) for sample in v_norm.samples(times)])
    works = np.sum(forces * project.gap(functionals), axis=1)
    return problem.T * float(np.mean(np.maximum(works, 0.0)))


def pairing(solution: ExactSolution, space: Space, momenta: Array) -> float:
    """Return the largest value over the time nodes t of |∫_0^t (u̇^h, D_h)_V ds|.

    u̇^h is the discrete velocity. D_h is the nodal interpolant of the field w ν in V^h, where ν is the normal of the
    contact face, and the function w (``travelling_weight``) is singular at the contact front and travels with it.

    Args:
        solution, space: the exact solution, which gives the front, and the space V^h.
        momenta: the functional v ↦ (u_n − u_{n−1}, v)_V of the displacements u_n, for each time step and all basis
            functions v, (dofs, steps).
    """
    (face,) = solution.faces
    (along,), into = face.part.coordinates(space.mesh.p)
    times = midpoints(space.body.T, momenta.shape[1])
    weights = [travelling_weight(along - front_at(solution, time), into, space.h) for time in times]
    fields = [space.interpolate(np.multiply.outer(face.part.normal, weight)) for weight in weights]
    return float(abs(np.cumsum(np.sum(np.array(fields) * momenta.T, axis=1))).max())


def travelling_weight(x: Array, y: Array, h: float) -> Array:
    """Return ∂_x(ζ_0 W^h), a function that is singular at x = y = 0 except for a regularisation of the size h.

    W^h = x (x² + y² + h²)^{−1/4}, and ζ_0 = (1 − (x² + y²)/``CUT_RADIUS``²)_+^4 is a cut-off.

    Args:
        x, y: the coordinates of points along the contact face, relative to the contact front, and into the body.
        h: the mesh size.
    """
    z = x + INCREMENT * 1j
    inside = 1 - (z**2 + y**2) / CUT_RADIUS**2
    values = z * (z**2 + y**2 + h**2) ** -0.25 * inside**4
    # The imaginary part of f(x + iε) is ε f'(x) up to rounding.
    return np.where(inside.real > 0, values.imag / INCREMENT, 0.0)
