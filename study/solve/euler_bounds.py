"""Error bounds for backward Euler with steps of variable size; Problem 5.1 need not be a gradient flow.

The semi-discrete problem (Problem 5.1) is u̇ + Bu + N_K(u) ∋ f in V^h with ‖Bv − Bw‖ ≤ κ ‖v − w‖ and
(Bv − Bw, v − w) ≥ −γ ‖v − w‖², 0 ≤ γ ≤ κ, in the norm and inner product of V. N_K is the normal cone of the admissible
set. Backward Euler on 0 = t_0 < … < t_N = T with k_n = t_n − t_{n−1}, k = max k_n and γk < 1 gives U_n,
δ_n = (U_n − U_{n−1})/k_n and ξ_n = f(t_n) − BU_n − δ_n ∈ N_K(U_n). Let û be the piecewise linear interpolant of the
U_n, V = Var f, z = u̇(0+), F_n = ∫_{t_{n−1}}^{t_n} ‖f(t) − f(t_n)‖ dt and P = Π_n (1 − γk_n)^{−1}. Then max_t
‖u(t) − û(t)‖ is at most

    (Σ_n e^{2γ(T − t_{n−1})} k_n² (ξ_n, δ_n))^{1/2} + Σ_n e^{γ(T − t_{n−1})} (F_n + κ k_n² ‖δ_n‖/2)
        ≤ kP/(1 − γk) · ((1/√2 + κT/2) ‖z‖ + (2 + κT/2) V).

The first bound needs the computed solution, the second only the data; both hold on every mesh. The proof is in
paper/time.tex.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from manufactured.tensors import Array
from study.solve.evolution import ContactStep, SemiDiscrete
from study.solve.gradient_flow import GradientFlow
from study.solve.tableau import BACKWARD_EULER


def backward_euler(problem: SemiDiscrete, times: Sequence[float]) -> Array:
    """Solve the semi-discrete problem by backward Euler with steps of variable size.

    Args:
        problem: the semi-discrete problem on a mesh, with n unknowns.
        times: the times t_0 = 0, …, t_N.

    Returns:
        The displacements U_0, …, U_N, (N + 1, n).

    Raises:
        StepsError: a step is so long that it may have several solutions.
    """
    end = times[0]
    held = replace(problem, load=lambda _: problem.load(end))
    states = [problem.initial()]
    steps = dict[float, ContactStep]()
    for begin, end in pairwise(times):
        # Step sizes are rounded, so that steps of equal size share one factorisation.
        k = round(end - begin, 12)
        if k not in steps:
            steps[k] = ContactStep(held, BACKWARD_EULER, k)
        states.append(steps[k](1, states[-1:]))
    return np.array([state.u for state in states])


@dataclass(frozen=True, eq=False)
class EulerBounds:
    """Computes error bounds for backward Euler on one mesh; the docstring of the module states both.

    Attributes:
        flow: the problem with its loads on a fine grid in time, from which the total variation of the loads follows.
        kappa: the Lipschitz constant κ of the elasticity in ‖·‖_V, for example L_G/m_A.
        growth: the largest rate γ at which two solutions can move apart, at most κ; 0 if G is monotone.
    """

    flow: GradientFlow
    kappa: float
    growth: float

    def by_data(self, nodes: Array) -> float:
        """Return the error bound that needs only the data, for steps between given nodes of the fine grid.

        Args:
            nodes: the indices of t_0, …, t_N in the grid, (N + 1,).
        """
        steps = np.diff(nodes * self.flow.interval)
        half = self.kappa * self.flow.problem.T / 2
        longest = float(steps.max())
        product = float(np.prod(1 / (1 - self.growth * steps)))
        terms = (1 / math.sqrt(2) + half) * self.flow.first + (2 + half) * self.flow.variation
        return longest * product / (1 - self.growth * longest) * terms

    def by_solution(self, nodes: Array, states: Array) -> float:
        """Return the error bound that is computed from the solution by backward Euler.

        Args:
            nodes: the indices of t_0, …, t_N in the fine grid, (N + 1,).
            states: the displacements U_0, …, U_N, (N + 1, n).
        """
        problem = self.flow.problem
        steps = np.diff(nodes * self.flow.interval)
        rates = np.diff(states, axis=0) / steps[:, None]
        viscous = (problem.M @ rates.T).T
        elastic = np.array([problem.elastic(u) for u in states[1:]])
        work = np.sum((self.flow.loads[nodes[1:]] - elastic - viscous) * rates, axis=1)
        speeds = np.sqrt(np.sum(viscous * rates, axis=1))
        growth = np.exp(self.growth * (problem.T - nodes[:-1] * self.flow.interval))
        root = math.sqrt(max(float(np.sum((growth * steps) ** 2 * work)), 0.0))
        return root + float(np.sum(growth * (self.flow.delays(nodes) + self.kappa * steps**2 * speeds / 2)))
