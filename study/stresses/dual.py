"""Problem 3.2 in time on composite stresses: σ^h_n ∈ Σ^h(t_n), found without any displacement.

With ε̇ ≈ (w ε_n − past)/k, for backward Euler (w = 1, past = ε_{n−1}) and BDF2 (w = 3/2, past = 2ε_{n−1} − ½ε_{n−2}),
the law (2.1) reads σ_n = C ε_n − (A/k) past, C = (w/k) A + G, and (3.12), (3.15) say that σ_n minimises over Σ^h(t_n)

    ½ (C⁻¹τ, τ)_Q + (C⁻¹ (A/k) past, τ)_Q,

after which ε_n = C⁻¹ (σ_n + (A/k) past) is kept at the points of the stresses: a history of strains that are nobody's
ε(u^h). That they are strains of a displacement in K is what Theorem 4.2 says in the limit.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from manufactured.data import Data
from manufactured.law import KelvinVoigt, Linear
from manufactured.tensors import Array, Tensors
from study.solve.signorini import Signorini
from study.stresses.hybrid import EquilibratedStress, Equilibrium, Loads
from study.stresses.loads import ProjectedLoads
from study.stresses.space import StressSpace


class EquilibriumError(ValueError):
    """Problem 3.2 cannot be posed for a law or a number of steps."""


@dataclass(frozen=True, eq=False)
class DualState:
    """One time node.

    Attributes:
        time: t_n, n ≥ 1.
        stress: σ^h_n with the multipliers of its equilibrium.
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


@dataclass(frozen=True)
class Multistep:
    """ε̇(t_n) ≈ (w ε_n − Σ_j past_j ε_{n−j})/k."""

    name: str
    w: float
    past: tuple[float, ...]


BACKWARD_EULER = Multistep("backward-euler", 1.0, (1.0,))
BDF2 = Multistep("bdf2", 1.5, (2.0, -0.5))


class _StressStep:
    def __init__(self, data: Data, space: StressSpace, scheme: Multistep, k: float, solver: type[Signorini]) -> None:
        A, G = linear(data.law)
        self.scheme = scheme
        self.viscous = tensor_at(A, space.points) / k
        self.compliance = np.linalg.inv(scheme.w * self.viscous + tensor_at(G, space.points))
        self.equilibrium = Equilibrium(space, self.compliance, solver)

    def __call__(self, time: float, loads: ProjectedLoads, history: list[Tensors]) -> DualState:
        past = sum(c * strain for c, strain in zip(self.scheme.past, reversed(history), strict=False))
        rate = np.einsum("cqIJ,Jcq->Icq", self.viscous, past, optimize=True)
        known = np.einsum("cqIJ,Jcq->Icq", self.compliance, rate, optimize=True)
        now = loads(time)
        stress = self.equilibrium(now, known)
        strain = known + np.einsum("cqIJ,Jcq->Icq", self.compliance, stress.values, optimize=True)
        return DualState(time, stress, strain, now)


def march(
    data: Data, space: StressSpace, scheme: Multistep, steps: int, solver: type[Signorini] = Signorini
) -> Iterator[DualState]:
    """The states at t_1, …, t_steps; a scheme with more than one past value starts with backward Euler.

    Raises:
        EquilibriumError: fewer than one step, or a law whose G is not linear.
    """
    if steps < 1:
        raise EquilibriumError(f"{steps} steps cannot reach T = {data.body.T:g}; take one step or more")
    k = data.body.T / steps
    loads = ProjectedLoads(data, space)
    history = [data.initial(space.points)]
    step = _StressStep(data, space, BACKWARD_EULER, k, solver)
    for n in range(1, steps + 1):
        if n == len(scheme.past) and scheme.past != step.scheme.past:
            step = _StressStep(data, space, scheme, k, solver)
        state = step(n * k, loads, history)
        history = [*history, state.strain][-len(scheme.past) :]
        yield state
