"""(3.9)–(3.11), (4.14), (4.15): the stress of a solution is admissible, and its work equals the work of the load.

The paper states this for the exact solution. Here it is tested for the discrete solution of backward Euler, for which
the statements hold exactly, so their violations must be round-off. The stress at time t_n is σ_n = A ε(δu_n) + G ε(u_n)
with δu_n = (u_n − u_{n−1})/k. It is computed from the strains of the cells, not from the residual of the contact
solver.
"""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from scipy.optimize import nnls

from manufactured.law import AtPoints
from manufactured.tensors import Array, Tensors
from study.fem.space import Space, on_cells
from study.ledger.criterion import largest
from study.ledger.window import at_most, positive_at_most
from study.solve.evolution import FIXED_POINT, SemiDiscrete
from study.solve.factorisation import Cholesky
from study.solve.tableau import BACKWARD_EULER
from study.statements.shared.base import EVOLVING, SEED, ListedNumbers, Setting, grid, with_h
from study.statements.shared.experiment import Experiment
from study.statements.shared.norms import maximum
from study.statements.thm_4_2 import beyond

STEPS = 12
SAMPLES = 8
"""Number of random admissible displacements, and of random admissible stresses, at every time step."""

_BY_WHAT = f"rounding errors; for the law (3.3) also a fixed-point iteration that stops at {FIXED_POINT:g}"
ROUND_OFF, ROUNDED = at_most(1e-10, _BY_WHAT), positive_at_most(1e-10, _BY_WHAT)
"""Tolerance windows for inequalities and for equations.

The violation of an inequality may be exactly 0; the violation of an equation between sums has round-off."""
CONE = "(4.15): distance of F − Eᵀσ_n from the cone of contact forces {Nᵀλ : λ ≥ 0}"


class Admissibility(ListedNumbers):
    """Measures how far the discrete solution violates admissibility, the work equation and both inequalities.

    These are σ_n ∈ Σ^h(t_n), (σ_n, ε(u_n)) = (f_n, u_n), and the variational inequalities (3.10) and (3.11).
    """

    label = "(3.9)–(3.11), (4.14), (4.15)"
    claim = "σ(t) ∈ Σ(t) and (σ(t), ε(u(t)))_Q = (f(t), u(t))_V"
    rules = (
        largest("membership", "(3.10): violation of u_n ∈ K^h", ROUND_OFF, "membership"),
        largest("cone", CONE, ROUNDED, "distance"),
        largest("work", "(4.14): |(σ_n, ε(u_n))_Q − (f_n, u_n)_V|", ROUNDED, "work"),
        largest("displacements", "(3.10): violation of the inequality for random v ∈ K^h", ROUND_OFF, "displacements"),
        largest("stresses", "(3.11): violation of the inequality for random τ ∈ Σ^h(t_n)", ROUND_OFF, "stresses"),
    )
    quick = grid(EVOLVING, ("shaken",), (8,))
    full = (
        *grid(EVOLVING, ("one-diagonal", "criss-cross", "shaken"), (8, 16, 32)),
        *grid((*EVOLVING, "heterogeneous", "corner", "hexagon"), ("unstructured",), (8, 16)),
        *grid(("cube-disc", "cube-two-faces"), ("shaken",), (3,)),
    )

    def measure(self, setting: Setting) -> dict[str, float]:
        setup = Experiment.at(setting, BACKWARD_EULER, STEPS)
        return with_h(setup.space.h, largest_violations(setup))


def largest_violations(setup: Experiment) -> dict[str, float]:
    """Return how far backward Euler violates the statements (3.10), (3.11), (4.14) and (4.15).

    For each condition the result is its largest violation over all time steps, divided by the largest term in it.
    """
    space, problem = setup.space, setup.problem
    cells, k, root = on_cells(space, setup.solution.law), problem.T / setup.steps, np.sqrt(space.volumes)
    rivals = Rivals(space, problem, cells.A, np.random.default_rng(SEED))
    worst, sizes = np.zeros(5), np.full(5, np.finfo(float).tiny)
    for before, state in pairwise(setup.scheme.march(problem, setup.steps)):
        strain = space.strain(state.u)
        stress = cells.stress((strain - space.strain(before.u)) / k, strain)
        load = problem.load(state.time)
        defect = load - space.functional(stress)
        work = float(np.linalg.norm(root * strain)) * float(np.linalg.norm(root * stress))
        # The inequalities (3.10) and (3.11) have such signs here that positive values are violations.
        against_v = [defect @ (v - state.u) for v in rivals.displacements(state.u)]
        against_tau = [float(np.sum(space.volumes * (stress - tau) * strain)) for tau in rivals.stresses(load)]
        now = [
            (problem.N @ state.u).max(initial=0.0),
            beyond(defect, problem.N),
            abs(defect @ state.u),
            maximum((*against_v, 0.0)),
            maximum((*against_tau, 0.0)),
        ]
        size = [abs(state.u).max(), np.linalg.norm(load), work, work, work]
        worst, sizes = np.maximum(worst, now), np.maximum(sizes, size)
    return dict(zip(("membership", "distance", "work", "displacements", "stresses"), worst / sizes, strict=True))


class Rivals:
    """Makes random admissible displacements and stresses without using the contact solver.

    Args:
        space: the P1 displacement space V^h.
        problem: the semi-discrete problem.
        A: the viscosity on the cells.
        rng: the random generator.
    """

    def __init__(self, space: Space, problem: SemiDiscrete, A: AtPoints, rng: np.random.Generator) -> None:
        self.space, self.problem, self.A, self.rng = space, problem, A, rng
        self.riesz = Cholesky(problem.M)

    def displacements(self, u: Array) -> Iterator[Array]:
        """Yield random displacements that satisfy the contact constraint.

        They are projections onto K^h of random points at distances up to |u| from u.
        """
        N, size = self.problem.N, float(np.linalg.norm(u))
        for _ in range(SAMPLES):
            direction = self.rng.standard_normal(len(u))
            v = u + self.rng.uniform() * size * direction / np.linalg.norm(direction)
            # By Moreau's theorem, the projection of v onto K^h is v minus its projection onto the cone {Nᵀλ : λ ≥ 0}.
            touched = np.unique(N.indices)
            multipliers, _ = nnls(N[:, touched].T.toarray(), v[touched])
            yield v - N.T @ multipliers

    def stresses(self, load: Array) -> Iterator[Tensors]:
        """Yield random admissible stresses A ε(w) + ρ ∈ Σ^h(t) for the load vector F.

        The displacement w solves (w, v)_V = F·v − λ·Nv with random contact forces λ ≥ 0. The stress ρ is random with
        (ρ, ε(v))_Q = 0 for all v ∈ V^h.
        """
        space, N = self.space, self.problem.N
        for _ in range(SAMPLES):
            multipliers = self.rng.uniform(size=N.shape[0]) * np.linalg.norm(load) / np.sqrt(N.shape[0])
            w = self.riesz(load - N.T @ multipliers)
            stress = self.A(space.strain(w))
            other = self.rng.standard_normal(stress.shape) * abs(stress).max()
            yield stress + other - self.A(space.strain(self.riesz(space.functional(other))))
