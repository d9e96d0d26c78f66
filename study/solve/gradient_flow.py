"""Bounds of the error in time of backward Euler for Problem 5.1, independent of the mesh.

**Gradient flows.** If the elasticity operator B^h on V^h has a convex potential, the semi-discrete problem
(Problem 5.1) is u̇ + ∂φ(u) ∋ f in V^h with φ convex, infinite outside K^h. Let U_n be the solution of backward Euler
with N steps of size k, δU_n = (U_n − U_{n−1})/k, ξ_n = f(t_n) − δU_n ∈ ∂φ(U_n), and û the piecewise linear interpolant
of the U_n. Let z be the element of least norm of f(0) − ∂φ(u_0), used as δU_0. Then

    max_t ‖u^h − û‖_V ≤ F + k (Σ_n (ξ_n − ξ_{n−1}, δU_n)_V)^½ ≤ k (‖z‖_V/√2 + 2 Var f),

    F = Σ_n ∫_{t_{n−1}}^{t_n} ‖f(t_n) − f(t)‖_V dt ≤ k Var f.

The distance from U_n to û on (t_{n−1}, t_n] is at most k ‖δU_n‖_V ≤ k (‖z‖_V + Var f). For any scheme the error between
nodes follows from the interpolation error of u^h: if û is linear between its values at nodes,

    max_t ‖u^h − û‖_V ≤ max_n ‖u^h(t_n) − U_n‖_V + k/4 max_n osc_n u̇^h,   osc_n u̇^h ≤ 2 (‖z‖_V + Var f),

where osc_n is the largest difference of velocities within a step.

The proofs are in paper/time.tex. The first bound needs the computed solution, the second only the data; both are
independent of h. z is the initial velocity u̇^h(0+), which is the projection of f(0) − B^h u_0 onto the cone of
directions that K^h permits at u_0, and ‖z‖_V ≤ ‖f(0)‖_V + ‖B^h u_0‖_V.

**Steps of variable size, without a potential** (κ > 0). The semi-discrete problem (Problem 5.1) is
u̇ + Bu + N_K(u) ∋ f in V^h with ‖Bv − Bw‖ ≤ κ ‖v − w‖ and (Bv − Bw, v − w) ≥ −γ ‖v − w‖², 0 ≤ γ ≤ κ, in the norm and
inner product of V. N_K is the normal cone of the admissible set.
Backward Euler on 0 = t_0 < … < t_N = T with k_n = t_n − t_{n−1}, k = max k_n and γk < 1 gives U_n,
δ_n = (U_n − U_{n−1})/k_n and ξ_n = f(t_n) − BU_n − δ_n ∈ N_K(U_n). Let û be the piecewise linear interpolant of the
U_n, V = Var f, z = u̇(0+), F_n = ∫_{t_{n−1}}^{t_n} ‖f(t) − f(t_n)‖ dt and P = Π_n (1 − γk_n)^{−1}. Then max_t
‖u(t) − û(t)‖ is at most

    (Σ_n e^{2γ(T − t_{n−1})} k_n² (ξ_n, δ_n))^{1/2} + Σ_n e^{γ(T − t_{n−1})} (F_n + κ k_n² ‖δ_n‖/2)
        ≤ kP/(1 − γk) · ((1/√2 + κT/2) ‖z‖ + (2 + κT/2) V).

The first bound needs the computed solution, the second only the data; both hold on every mesh. The proof is in
paper/time.tex.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from manufactured.tensors import Array
from study.solve.evolution import ContactStep, SemiDiscrete, norm
from study.solve.factorisation import Cholesky
from study.solve.signorini import Signorini
from study.solve.tableau import BACKWARD_EULER

TOUCHING_AT_START = 1e-12
"""A vertex counts as in contact at t = 0 if its gap is at most this fraction of the largest initial displacement."""


@dataclass(frozen=True, eq=False)
class EulerBounds:
    """Computes bounds of the error in time of backward Euler on one mesh, max_t ‖u^h(t) − û(t)‖_V.

    u^h is the solution of the semi-discrete problem (Problem 5.1), and û interpolates the values U_n of backward Euler
    linearly in time. The constants in the bounds do not depend on the mesh size h.

    Attributes:
        problem: the semi-discrete problem, with n unknowns.
        loads: the load vectors at equidistant times t_0, …, t_m from 0 to T, the fine grid, (m + 1, n). The total
            variation of the load is computed on this grid.
        kappa: the Lipschitz constant κ in ‖·‖_V of an elasticity without a potential, for example L_G/m_A; 0 for an
            elasticity that is the derivative of a convex energy (a gradient flow).
        growth: the largest rate γ at which two solutions can move apart, at most κ; 0 if the elasticity is monotone.
    """

    problem: SemiDiscrete
    loads: Array
    kappa: float = 0.0
    growth: float = 0.0

    @cached_property
    def representers(self) -> Array:
        """The Riesz representers of the loads in V^h at the times of the grid, (m + 1, n)."""
        return Cholesky(self.problem.M)(self.loads)

    def distance(self, i: Array, j: Array) -> Array:
        """Return the distances ‖f(t_i) − f(t_j)‖_V of loads at k pairs of times of the fine grid, (k,).

        Args:
            i, j: the indices of the times in the grid, (k,) each.
        """
        between = self.loads[i] - self.loads[j]
        represented = self.representers[i] - self.representers[j]
        squares = np.sum(between * represented, axis=-1)
        return np.asarray(np.sqrt(np.maximum(squares, 0)))

    @cached_property
    def variation(self) -> float:
        """The total variation of the load f over the times of the fine grid, Σ_i ‖f(t_i) − f(t_{i−1})‖_V."""
        ends = np.arange(len(self.loads))
        return float(self.distance(ends[1:], ends[:-1]).sum())

    @cached_property
    def start(self) -> Array:
        """The initial velocity u̇^h(0+) of the semi-discrete solution, (n,)."""
        problem = self.problem
        u0 = problem.u0
        touching = problem.N @ u0 >= -TOUCHING_AT_START * abs(u0).max(initial=0.0)
        solver = Signorini(problem.M, problem.N[np.flatnonzero(touching)])
        return solver(self.loads[0] - problem.elastic(u0))[0]

    @property
    def interval(self) -> float:
        """The length T/m of an interval of the fine time grid, which has m intervals."""
        return self.problem.T / (len(self.loads) - 1)

    def delays(self, nodes: Array) -> Array:
        """Return for every time step of backward Euler an upper bound of ∫ ‖f(t_n) − f(t)‖_V dt over the step, (N,).

        f is the load, and t_n the end of the step. On every interval of the fine grid, the larger of the values at its
        ends is used. If a step consists of j intervals of the grid and the load is linear on the step, the result is 1
        + 1/j times the integral.

        Args:
            nodes: the indices of t_0 = 0, …, t_N = T in the fine grid, (N + 1,).
        """
        grid = np.arange(len(self.loads))
        ahead = np.repeat(nodes[1:], np.diff(nodes))
        of_starts = self.distance(ahead, grid[:-1])
        of_ends = self.distance(ahead, grid[1:])
        return np.add.reduceat(np.maximum(of_starts, of_ends), nodes[:-1]) * self.interval

    @cached_property
    def first(self) -> float:
        """The norm ‖u̇^h(0+)‖_V of the initial velocity of the semi-discrete solution."""
        return norm(self.problem, self.start)

    @property
    def fastest(self) -> float:
        """A bound of the speeds ‖u̇^h(t)‖_V of the semi-discrete solution and ‖(U_n − U_{n−1})/k‖_V of backward Euler.

        It is the initial speed ``first`` plus the total variation of the load.
        """
        return self.first + self.variation

    def by_data(self, nodes: Array) -> float:
        """Return the bound of the error of backward Euler that needs only the data, such as the variation of the load.

        Args:
            nodes: the indices of the time nodes t_0, …, t_N of backward Euler in the fine grid, (N + 1,). Every step
                must be shorter than 1/γ, where γ is ``growth``.
        """
        steps = np.diff(nodes * self.interval)
        half = self.kappa * self.problem.T / 2
        longest = float(steps.max())
        product = float(np.prod(1 / (1 - self.growth * steps)))
        factor = longest * product / (1 - self.growth * longest)
        of_start = (1 / math.sqrt(2) + half) * self.first
        of_load = (2 + half) * self.variation
        return factor * (of_start + of_load)

    def by_solution(self, nodes: Array, states: Array) -> float:
        """Return the bound of the error of backward Euler that is computed from its solution.

        Args:
            nodes: the indices of the time nodes t_0, …, t_N of backward Euler in the fine grid, (N + 1,).
            states: the displacements U_0, …, U_N, (N + 1, n).
        """
        problem = self.problem
        steps = np.diff(nodes * self.interval)
        rates = np.diff(states, axis=0) / steps[:, None]
        viscous = (problem.M @ rates.T).T
        elastic = np.array([problem.elastic(u) for u in states[1:]])
        contact_forces = self.loads[nodes[1:]] - elastic - viscous
        work = np.sum(contact_forces * rates, axis=1)
        remaining = problem.T - nodes[:-1] * self.interval
        growth = np.exp(self.growth * remaining)
        square = float(np.sum((growth * steps) ** 2 * work))
        of_elasticity = self.kappa * steps**2 * norm(problem, rates) / 2
        rest = float(np.sum(growth * (self.delays(nodes) + of_elasticity)))
        return math.sqrt(max(square, 0.0)) + rest

    def piecewise_constant(self, nodes: Array) -> float:
        """Return the error bound for the piecewise constant function that is U_n on (t_{n−1}, t_n].

        U_n are the values of backward Euler. The bound is ``by_data`` plus the longest time step times ``fastest``.

        Args:
            nodes: the indices of t_0, …, t_N in the fine grid, (N + 1,).
        """
        longest = self.interval * float(np.diff(nodes).max())
        return self.by_data(nodes) + longest * self.fastest

    def a_posteriori(self, states: Array) -> float:
        """Return the error bound from the solution of backward Euler, for a gradient flow and equal steps.

        It is F + k (Σ_n (ξ_n − ξ_{n−1}, δU_n)_V)^½ for the step k. F is the sum of ``delays``, δU_n = (U_n −
        U_{n−1})/k, and ξ_n = f(t_n) − δU_n with the load f.

        Args:
            states: the displacements U_0, …, U_N, (N + 1, n), where N divides the number of intervals of the fine grid.
        """
        steps = len(states) - 1
        k = self.problem.T / steps
        every = (len(self.loads) - 1) // steps
        rates = np.vstack([self.start, np.diff(states, axis=0) / k])
        forces = self.loads[::every] - (self.problem.M @ rates.T).T
        total = float(np.sum(np.diff(forces, axis=0) * rates[1:]))
        nodes = np.arange(0, len(self.loads), every)
        delay = float(self.delays(nodes).sum())
        return delay + k * math.sqrt(max(total, 0.0))


def backward_euler(problem: SemiDiscrete, times: Array) -> Array:
    """Solve the semi-discrete problem by backward Euler with steps of variable size.

    Args:
        problem: the semi-discrete problem on a mesh, with n unknowns.
        times: the times t_0 = 0, …, t_N, (N + 1,).

    Returns:
        The displacements U_0, …, U_N, (N + 1, n).

    Raises:
        StepsError: a step is so long that it may have several solutions.
    """
    states = [problem.initial()]
    steps = dict[float, ContactStep]()
    loads = problem.load(times[1:]).T
    for (begin, end), load in zip(pairwise(times), loads, strict=True):
        # Step sizes are rounded, so that steps of equal size share one factorisation.
        k = round(end - begin, 12)
        if k not in steps:
            steps[k] = ContactStep(problem, BACKWARD_EULER, k)
        states.append(steps[k].solved(end, load, states[-1:]))
    return np.array([state.u for state in states])
