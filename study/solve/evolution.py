"""Problem 5.1, continuous in time on one mesh: M u̇ + G(u) + N_{K^h}(u) ∋ F.

G is bounded relative to M uniformly in h, (5.5), so the system is not stiff: no step restriction links k to h.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy.sparse as sps

from manufactured.law import Elasticity, KelvinVoigt, Linear
from manufactured.tensors import Array
from study.fem.material import form, means
from study.fem.space import Space
from study.solve.contact_step import ContactStep, State
from study.solve.signorini import ContactSolver, Signorini
from study.solve.solver_choice import contact_solver
from study.solve.steps import step_size
from study.solve.tableau import Tableau


@dataclass(frozen=True, eq=False)
class SemiDiscrete:
    """Problem 5.1 on one mesh: M, G, N, F and u_0^h.

    Attributes:
        M: matrix of (·,·)_V on V^h, (n, n).
        reference: matrix of G_ref, (n, n).
        remainder: v ↦ (G ε(v) − G_ref ε(v), ε(·))_Q, (n,); None for a linear law.
        N: K^h = {v : Nv ≤ 0}, (m, n).
        load: t ↦ F(t), (n,).
        u0: u_0^h ∈ K^h, (n,).
        T: final time.
        solver: (S, N) ↦ the contact solve of one step.
    """

    M: sps.csc_array
    reference: sps.csc_array
    remainder: Callable[[Array], Array] | None
    N: sps.csr_array
    load: Callable[[float], Array]
    u0: Array
    T: float
    solver: Callable[[sps.csc_array, sps.csr_array], ContactSolver] = Signorini

    @classmethod
    def of(cls, space: Space, law: KelvinVoigt, load: Callable[[float], Array], u0: Array) -> SemiDiscrete:
        """The problem for a law, a load and a start on a space."""
        return cls(
            M=form(space, law.A),
            reference=form(space, law.G),
            remainder=None if isinstance(law.G, Linear) else _remainder(space, law.G),
            N=space.N,
            load=load,
            u0=u0,
            T=space.body.T,
            solver=contact_solver(space),
        )

    def initial(self) -> State:
        """u_0^h; no contact force is known there."""
        return State(0.0, self.u0, np.zeros(self.N.shape[0]), 0.0, 0)

    def stepper(self, scheme: Tableau, k: float) -> ContactStep:
        """(n, the states before) ↦ the state at t_n."""
        return ContactStep(self, scheme, k)


def _remainder(space: Space, G: Elasticity) -> Callable[[Array], Array]:
    factor = means(space, G.factor)
    on_cells = G.scaled(factor)

    def remainder(v: Array) -> Array:
        strain = space.strain(v)
        return space.functional(on_cells(strain) - factor * (G.reference @ strain))

    return remainder


def velocities(problem: SemiDiscrete, scheme: Tableau, steps: int) -> Iterator[tuple[State, Array]]:
    """The states at t_0, …, t_steps with δu_n; δu_0, of which the scheme knows nothing, is δu_1."""
    k = step_size(problem.T, steps)
    states = scheme.march(problem, steps)
    first = next(states)
    before = [first.u]
    for n, state in enumerate(states, start=1):
        velocity = scheme.of_step(n).rate(state.u, before, k)
        if n == 1:
            yield first, velocity
        yield state, velocity
        before = [*before, state.u][-scheme.kept :]


class Scheme(Protocol):
    """A way to march through Problem 5.1: a ``Tableau``, or what stands in for one."""

    @property
    def name(self) -> str: ...
    @property
    def order(self) -> float: ...

    def march(self, problem: SemiDiscrete, steps: int) -> Iterator[State]:
        """The states at t_0, t_1, …, t_steps."""
        ...
