"""Problem 3.2 in time on composite stresses: σ^h_n ∈ Σ^h(t_n), found without any displacement.

With ε̇ ≈ (w ε_n − η_n)/k, η_n = Σ_{j≥1} w_j ε_{n−j} (``study.solve.tableau``; backward Euler and BDF2), the law (2.1)
reads σ_n = C ε_n − (A/k) η_n, C = (w/k) A + G, and (3.12), (3.15) say that σ_n minimises over Σ^h(t_n)

    ½ (C⁻¹τ, τ)_Q + (C⁻¹ (A/k) η_n, τ)_Q,

after which ε_n = C⁻¹ (σ_n + (A/k) η_n) is kept at the quadrature points: a history of strains that are those of no
displacement u^h. That they are strains of a displacement in K is what Theorem 4.2 says in the limit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from manufactured.data import Data
from manufactured.law import KelvinVoigt, Linear
from manufactured.tensors import Array, Tensors
from study.solve.signorini import Signorini
from study.solve.tableau import Tableau
from study.stresses.hybrid import EquilibratedStress, Equilibrium
from study.stresses.loads import Loads
from study.stresses.projection import ProjectedLoads
from study.stresses.stress_space import StressSpace


class EquilibriumError(ValueError):
    """Problem 3.2 cannot be posed for a law or a scheme."""


@dataclass(frozen=True, eq=False)
class DualState:
    """One time node.

    Attributes:
        time: t_n.
        stress: σ^h_n with the multipliers of its equilibrium; not a number at t_0.
        strain: ε_n at the points, (3, cells, Q).
        loads: P f_0 and P f_2 at t_n.
    """

    time: float
    stress: EquilibratedStress
    strain: Tensors
    loads: Loads


def tensor_at(C: Linear, x: Array) -> Array:
    """C(x) in Mandel form: points (2, ...) → (..., 3, 3)."""
    return np.multiply.outer(C.factor(x), C.matrix)


def linear(law: KelvinVoigt) -> tuple[Linear, Linear]:
    """A and G of a linear law.

    Raises:
        EquilibriumError: G is not linear.
    """
    if not isinstance(law.G, Linear):
        raise EquilibriumError(f"Problem 3.2 is solved on composite stresses for linear G, not for {law.name}")
    return law.A, law.G


@dataclass(frozen=True, eq=False)
class StressEvolution:
    """Problem 3.2 in time on composite stresses.

    Attributes:
        data: A, G, f_0, f_2, u_0 and T.
        space: the stresses.
        solver: (S, N) ↦ the contact solve of one step.
    """

    data: Data
    space: StressSpace
    solver: type[Signorini] = Signorini

    @property
    def T(self) -> float:
        return self.data.body.T

    @cached_property
    def loads(self) -> ProjectedLoads:
        """t ↦ P f_0 and P f_2."""
        return ProjectedLoads(self.data, self.space)

    def initial(self) -> DualState:
        """ε(u_0); the schemes have no rate there, so the stress is not a number."""
        space = self.space
        strain, edges = self.data.initial(space.points), np.full((len(space.lengths), space.degree + 1, 2), np.nan)
        stress = EquilibratedStress(np.full_like(strain, np.nan), edges[space.edges], edges)
        return DualState(0.0, stress, strain, self.loads(0.0))

    def stepper(self, scheme: Tableau, k: float) -> _DualStep:
        """(n, the states before) ↦ the state at t_n.

        Raises:
            EquilibriumError: a law whose G is not linear, or a scheme that takes G at another time than t_n.
        """
        if scheme.theta != 1:
            raise EquilibriumError(f"Problem 3.2 is solved at t_n, which {scheme.name} does not do: take bdf2")
        return _DualStep(self, scheme, k)


class _DualStep:
    """The steps of one scheme with one k."""

    def __init__(self, problem: StressEvolution, scheme: Tableau, k: float) -> None:
        self.problem, self.scheme, self.k = problem, scheme, k
        A, G = linear(problem.data.law)
        self.viscous = tensor_at(A, problem.space.points) / k
        self.compliance = np.linalg.inv(scheme.newest * self.viscous + tensor_at(G, problem.space.points))
        self.equilibrium = Equilibrium(problem.space, self.compliance, problem.solver)

    def __call__(self, n: int, past: Sequence[DualState]) -> DualState:
        known = self.scheme.known([state.strain for state in past])
        rate = np.einsum("cqIJ,Jcq->Icq", self.viscous, known, optimize=True)
        released = np.einsum("cqIJ,Jcq->Icq", self.compliance, rate, optimize=True)
        loads = self.problem.loads(n * self.k)
        stress = self.equilibrium(loads, released)
        strain = released + np.einsum("cqIJ,Jcq->Icq", self.compliance, stress.values, optimize=True)
        return DualState(n * self.k, stress, strain, loads)
