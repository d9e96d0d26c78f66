"""Beyond the paper: u̇^h has half a derivative in time, and how large the nodal errors of the projection P_h are.

Both statements are lemmas with which the order of the error at moving fronts is proved (paper/velocity.tex,
paper/fronts.tex). Here they are measured themselves.

**Half a derivative.** With g = P_h(f − Bu^h), ξ = g − u̇^h, M = max ‖u̇^h‖, W = Var g, Ξ = max ‖ξ‖ in the norm of V and
C_2 = 2MW + M²/2 + MΞ, the lemma says for 0 < δ < T/2

    1/δ ∫_0^δ ∫_0^{T−δ} ‖u̇^h(t + τ) − u̇^h(t)‖² dt dτ ≤ C_2 δ.

Measured is the largest quotient of both sides over δ = 2k, 4k, 8k, … up to T/4, for the midpoint rule with k = T/(4n).
Backward Euler has an exact counterpart for every step: with δ_0 = u̇^h(0+) and the difference quotients δ_n,

    Σ_n ‖δ_n − δ_{n−1}‖² ≤ ‖δ_0‖² + 2 max_n ‖δ_n‖ (Var f + κ Σ_n k ‖δ_n‖).

**Nodal errors.** u_s = ζ u is the part of an advancing natural front (``manufactured.natural_motion``) near the front,
cut off by ζ = (1 − r²/R²)_+^4 with R = 1/5. The lemma says, with L = |log h|, for all vertices a of Γ3

    |(P_hu_s − Π^hu_s)_ν(a)| ≤ C h² L (h + |a − x(t)|)^{−1/2}.

Measured are the largest C/θ over eight places of the front in an edge, and the largest signed error
(P_hu_s)_ν(a)/(θ h^{3/2}) at vertices in contact at most three edges behind the front. There u_ν = 0, so P_hu_s violates
the constraint where it is positive. θ(t) is the factor of the singular field.

**Predicted** before these programs existed, from prototypes:

* Both quotients are at most 1, as proved. The first is about 0.13 (largest of 84 small systems) and does not grow with
  n: finest / coarsest ≤ 1.25. If u̇^h had no bound in this norm, it would grow like n.
* C ≤ 1.5 on all mesh families: 0.3 to 0.9 for n ≤ 128, but 0.9 to 2.2 for a cut-off that keeps more of u. It may still
  rise slowly.
* The largest signed nodal error over eight shaken meshes is at least 0.01: in the prototype, which did not cut u off,
  single shaken meshes had −0.2 to 0.09. So an estimate by the sign, which fine meshes with one diagonal suggest, is
  false in general. It is a maximum over random meshes: on a single one either sign may occur.
"""

from collections.abc import Callable
from functools import partial

import numpy as np
import pandas as pd

from manufactured.body import Kind
from manufactured.exact import ExactSolution
from manufactured.natural_motion import NAME
from manufactured.singular import SingularFace, TravellingField
from manufactured.tensors import Array, Points, Tensors, Vectors, mandel
from study.fem.mesh import barycentric_gradients
from study.fem.quadrature import gauss
from study.fem.space import Space, form
from study.ledger.check import ENOUGH, Groups, consequence, identity
from study.ledger.quantities import change, values
from study.ledger.window import at_least, at_most
from study.solve.evolution import SemiDiscrete
from study.solve.factorisation import Cholesky
from study.solve.gradient_flow import GradientFlow
from study.solve.paths import path
from study.solve.signorini import Signorini
from study.solve.tableau import BACKWARD_EULER, MIDPOINT
from study.statements.backward_euler import PROVED
from study.statements.rollers import SEEDS
from study.statements.shared.base import Judged, ListedNumbers, Numbers, Setting, grid, with_h
from study.statements.shared.experiment import Experiment, with_cached_loads
from study.statements.shared.meshes import posed, split_random
from study.statements.shared.norms import maximum

STEPS_PER_CELL = 4
"""Number of time steps for each cell along a side of the body."""
RADIUS = 0.2
"""Radius R of the cut-off about the front."""
MIDDLE, SPEED, FRONTS = 0.625, 0.4, 8
"""The time at which the front is in the middle of Γ3, its speed, and the number of its places in an edge."""
BEHIND = 3.0
"""Largest distance behind the front, in edges, at which signed nodal errors are measured."""
GAUSS_POINTS = 20
"""Number of Gauss points on each edge of a cell."""

HALF_DERIVATIVE = (
    identity(
        "half",
        "mean of ‖u̇^h(t + τ) − u̇^h(t)‖² over τ < δ, integrated over t / (C_2 δ), largest over δ",
        values("half"),
        PROVED,
    ),
    consequence(
        "half-growth",
        "the same quotient, finest / coarsest mesh",
        change("half"),
        at_most(1.25, "the constant does not depend on the mesh"),
        levels=ENOUGH,
    ),
)


def half_quotient(problem: SemiDiscrete, states: Array) -> float:
    """Return the largest quotient of both sides of the lemma on half a derivative, over δ = 2k, 4k, 8k, … up to T/4.

    The integrals are exact for the velocity of the midpoint rule, which is constant in every step.

    Args:
        problem: the semi-discrete problem.
        states: the displacements that the midpoint rule computed, (steps + 1, dofs).
    """
    steps = len(states) - 1
    k = problem.T / steps
    velocities = np.diff(states, axis=0) / k
    middles = (states[1:] + states[:-1]) / 2
    forces = [problem.load(MIDPOINT.balanced(n, k)) - problem.elastic(u) for n, u in enumerate(middles, 1)]
    g = Cholesky(problem.M)(np.array(forces))
    speed = norms(problem, velocities).max()
    variation = norms(problem, np.diff(g, axis=0)).sum()
    constant = speed * (2 * variation + speed / 2 + norms(problem, g - velocities).max())
    # jumps[i, j] is the distance of the velocities in the steps i and j.
    jumps = np.array([norms(problem, velocities - velocity) for velocity in velocities])
    quotients = []
    for count in 2 ** np.arange(1, int(np.log2(steps / 4)) + 1):
        shifted = [np.sum(np.diagonal(jumps, shift)[: steps - count] ** 2) for shift in range(count + 1)]
        quotients.append(np.trapezoid(shifted) / count**2)
    return maximum(quotients) / constant


def norms(problem: SemiDiscrete, v: Array) -> Array:
    """Return the norms ‖v_n‖_V of n displacements (n, dofs)."""
    return np.sqrt(abs(np.sum(v.T * (problem.M @ v.T), axis=0)))


def euler_quotient(flow: GradientFlow, kappa: float, states: Array) -> float:
    """Return Σ ‖δ_n − δ_{n−1}‖² for backward Euler, divided by its bound.

    Args:
        flow: the problem, with its loads at t_0, …, t_N.
        kappa: L_G/m_A.
        states: the displacements U_0, …, U_N, (N + 1, dofs).
    """
    rates = np.vstack([flow.start, np.diff(states, axis=0) / flow.interval])
    jumps = norms(flow.problem, np.diff(rates, axis=0))
    speeds = norms(flow.problem, rates[1:])
    growth = kappa * flow.interval * speeds.sum()
    return float(jumps @ jumps / (flow.first**2 + 2 * speeds.max() * (flow.variation + growth)))


class HalfDerivative(ListedNumbers):
    """Measures half a derivative of the discrete velocity in time, over its bound."""

    label = "beyond: half a derivative"
    claim = "u̇^h has half a derivative in time, bounded independently of h, and so have velocities of backward Euler"
    effort = 10
    checks = (
        *HALF_DERIVATIVE,
        identity("euler", "backward Euler: Σ ‖δ_n − δ_{n−1}‖² / its bound", values("euler"), PROVED),
    )
    quick = grid(("advance-recede",), ("one-diagonal",), (4, 8, 16))
    full = grid(("advance-recede", "travelling-patch", "yield-and-release"), ("one-diagonal",), (8, 16, 32))

    def setup(self, setting: Setting) -> Experiment:
        return Experiment.at(setting, MIDPOINT, STEPS_PER_CELL * setting.level)

    def measure(self, setup: Experiment) -> Numbers:
        problem = with_cached_loads(setup.solved or setup.problem)
        steps = setup.steps
        loads = [problem.load(problem.T * n / steps) for n in range(steps + 1)]
        flow = GradientFlow(problem, np.array(loads))
        numbers = {
            "half": half_quotient(problem, path(problem, MIDPOINT, steps)),
            "euler": euler_quotient(flow, setup.solution.law.kappa, path(problem, BACKWARD_EULER, steps)),
        }
        return with_h(setup.space.h, numbers)


SIGN = consequence(
    "sign",
    "largest (P_hu_s)_ν / (θ h^{3/2}) at vertices in contact behind the front, over shaken meshes",
    lambda table: table["signed"].max(),
    at_least(0.01, "so the constraint is violated behind the front"),
)


class NodalErrors(ListedNumbers):
    """Measures nodal errors of the projection P_h near an advancing natural front."""

    label = "beyond: nodal errors"
    claim = "|(P_hu_s − Π^hu_s)_ν(a)| ≤ C h² |log h| (h + |a − x(t)|)^{−1/2} on Γ3, with both signs on irregular meshes"
    outside_catalogue = True
    effort = 4
    # Random meshes stand only on a level above the quick study, so that repetitions with other seeds leave them out.
    quick = grid((NAME,), ("one-diagonal",), (16,))
    full = (
        *grid((NAME,), ("one-diagonal", "criss-cross", "alternating", "unstructured"), (16, 32, 64)),
        *grid((NAME,), SEEDS, (32,)),
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
        for time in MIDDLE + np.arange(FRONTS) / FRONTS * h / SPEED:
            behind = front_at(solution, time) - s
            near_front = partial(cut_solution, solution, time)
            projected = condensed.gap(space.functional(A.matrix @ means_from_edges(near_front, space)))
            error = (projected - part.normal @ near_front(corners)) / (time + 0.25)
            constants.append(abs(error * np.sqrt(h + abs(behind))).max())
            signed.append(error[(behind >= 0) & (behind <= BEHIND * h)].max())
        numbers = {"constant": maximum(constants) / (h**2 * abs(np.log(h))), "signed": maximum(signed) / h**1.5}
        return with_h(h, numbers)

    def checks_of(self, case: str, groups: Groups) -> Judged:
        """Yield the check of the constant on all meshes, and that of the sign on all random meshes together."""
        yield (
            consequence(
                "constant",
                "largest |(P_hu_s − Π^hu_s)_ν(a)| (h + |a − x|)^{1/2} / (θ h² |log h|)",
                values("constant"),
                at_most(1.5, "bounded on every mesh family"),
            ),
            groups,
        )
        random, _ = split_random(groups)
        if random:
            yield SIGN, {SEEDS[0]: pd.concat(random.values())}


def front_at(solution: ExactSolution, time: float) -> float:
    """Return the place c(t) of the front along Γ3."""
    (face,) = solution.faces
    assert isinstance(face, SingularFace)
    assert isinstance(face.field, TravellingField)
    return face.field.place_at(time)


def cut_solution(solution: ExactSolution, time: float, x: Points) -> Vectors:
    """Return u_s(x) = (1 − r²/R²)_+^4 u(x), where r is the distance from the front, (2, points)."""
    place = solution.faces[0].part.point(np.array([[front_at(solution, time)]]))
    cut = np.maximum(1 - np.sum((x - place) ** 2, axis=0) / RADIUS**2, 0.0) ** 4
    return cut * solution.at(x).displacement(time)


def means_from_edges(
    displacement: Callable[[Points], Vectors], space: Space, cells: Array | slice = np.s_[:], points: int = GAUSS_POINTS
) -> Tensors:
    """Return the mean of the strain ε(u) on some cells, (D, n), from the displacement u on their edges.

    By the divergence theorem, ∫_T ∇u = Σ_e ν_e ⊗ ∫_e u. On the edge e opposite to vertex i, |e| ν_e = −2|T| ∇λ_i. So
    the mean of ∇u is −2 Σ_i ∇λ_i ⊗ ū_i, where ū_i is the mean of u on this edge.

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
