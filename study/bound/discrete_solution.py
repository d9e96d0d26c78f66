"""u_h, the displacement whose error is bounded: Problem 5.1 on P1, linear in time between the nodes of a scheme."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from manufactured.tensors import Array
from study.bound.discretisation import Discretisation
from study.bound.embedding import prolongation
from study.fem.space import Space
from study.solve.evolution import Scheme, SemiDiscrete


@dataclass(frozen=True, eq=False)
class DiscreteSolution:
    """u_h.

    Attributes:
        space: V^h of P1.
        nodes: the values at equally spaced times from 0 to T, (steps + 1, n_dofs).
        T: final time.
    """

    space: Space
    nodes: Array
    T: float

    @property
    def steps(self) -> int:
        return len(self.nodes) - 1

    def at(self, time: float) -> Array:
        """u_h(t), (n_dofs,)."""
        place = time / self.T * self.steps
        # The time of a node belongs to the interval after it, also where rounding puts it before.
        low = min(int(place + 1e-9), self.steps - 1)
        share = place - low
        return (1 - share) * self.nodes[low] + share * self.nodes[low + 1]


def compute(discretisation: Discretisation, scheme: Scheme, steps: int) -> DiscreteSolution:
    """Problem 5.1 from the data alone, with the load (P f, ·)_V and u_0^h = Π^h u_0."""
    data = discretisation.data
    space = Space(discretisation.mesh, data.body)
    J = prolongation(space, discretisation)

    def load(time: float) -> Array:
        return J.T @ discretisation.load(time)

    problem = SemiDiscrete.of(space, data.law, load, space.interpolate(data.start(discretisation.mesh.p)))
    return DiscreteSolution(space, np.array([state.u for state in scheme.march(problem, steps)]), data.body.T)
