"""Problem 3.2 in time on composite stresses: σ^h_n ∈ Σ^h(t_n), computed without any displacement.

With ε̇ ≈ (w ε_n − η_n)/k, η_n = Σ_{j≥1} w_j ε_{n−j} (``study.solve.tableau``; backward Euler and BDF2), the law (2.1)
reads σ_n = C ε_n − (A/k) η_n, C = (w/k) A + G. By (3.12) and (3.15), σ_n minimises over Σ^h(t_n)

    ½ (C⁻¹τ, τ)_Q + (C⁻¹ (A/k) η_n, τ)_Q.

Then ε_n = C⁻¹ (σ_n + (A/k) η_n) is stored at the quadrature points. These strains are not the strains of a displacement
u^h. By Theorem 4.2 they become strains of a displacement in K in the limit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from manufactured.data import Data
from manufactured.factor import UNIFORM
from manufactured.law import Linear
from manufactured.tensors import Array, Tensors
from study.solve.signorini import Signorini
from study.solve.tableau import Tableau
from study.stresses.hybrid import EquilibratedStress, Equilibrium, act
from study.stresses.loads import Loads, ProjectedLoads
from study.stresses.stress_space import StressSpace


class EquilibriumError(ValueError):
    """Raised if Problem 3.2 cannot be posed for a law or a scheme."""


@dataclass(frozen=True, eq=False)
class DualState:
    """The solution of Problem 3.2 at one time node.

    Attributes:
        time: t_n.
        stress: σ^h_n with the multipliers of its equilibrium; NaN at t_0.
        strain: ε_n at the points, (3, cells, Q).
        loads: P f_0 and P f_2 at t_n.
    """

    time: float
    stress: EquilibratedStress
    strain: Tensors
    loads: Loads


def tensor_at(C: Linear, x: Array) -> Array:
    """Return C(x) in Mandel form: points (2, ...) → (..., 3, 3), or (3, 3) for a homogeneous material."""
    return C.matrix if C.factor is UNIFORM else np.multiply.outer(C.factor(x), C.matrix)


@dataclass(frozen=True, eq=False)
class StressEvolution:
    """Problem 3.2 in time: the data A, G, f_0, f_2, u_0 and T, the stress space, and the contact solver of one step.

    ``raised`` is added to the degree of the quadrature rule for f_0.
    """

    data: Data
    space: StressSpace
    solver: type[Signorini] = Signorini
    raised: int = 0

    @property
    def T(self) -> float:
        return self.data.body.T

    @cached_property
    def loads(self) -> ProjectedLoads:
        return ProjectedLoads(self.data, self.space, self.raised)

    def initial(self) -> DualState:
        """Return the initial state with ε(u_0); its stress is NaN, because the schemes have no rate at t_0."""
        space = self.space
        strain, edges = self.data.initial(space.points), np.full((len(space.lengths), space.degree + 1, 2), np.nan)
        stress = EquilibratedStress(np.full_like(strain, np.nan), edges[space.edges], edges)
        return DualState(0.0, stress, strain, self.loads(0.0))

    def stepper(self, scheme: Tableau, k: float) -> Callable[[int, Sequence[DualState]], DualState]:
        """Return the function (n, previous states) ↦ state at t_n.

        Raises:
            EquilibriumError: the scheme evaluates G at another time than t_n, or G is not linear.
            StepsError: a step of this length may have several solutions, because G is not monotone.
        """
        law, points = self.data.law, self.space.points
        if scheme.theta != 1:
            raise EquilibriumError(f"Problem 3.2 is solved at t_n, which {scheme.name} does not do: take bdf2")
        if not isinstance(law.G, Linear):
            raise EquilibriumError(f"Problem 3.2 is solved on composite stresses for linear G, not for {law.name}")
        scheme.require_unique(k, law.growth)
        viscous = tensor_at(law.A, points) / k
        compliance = np.linalg.inv(scheme.newest * viscous + tensor_at(law.G, points))
        memory = compliance @ viscous
        equilibrium = Equilibrium(self.space, compliance, self.solver)

        def step(n: int, past: Sequence[DualState]) -> DualState:
            known = scheme.known([state.strain for state in past])
            released = act(memory, known)
            loads = self.loads(n * k)
            stress = equilibrium(loads, released)
            strain = released + act(compliance, stress.values)
            return DualState(n * k, stress, strain, loads)

        return step
