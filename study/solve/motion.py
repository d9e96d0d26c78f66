"""The numerical solution of one problem by BDF2: displacement, velocity, stress and contact at every time node.

The scheme replaces u̇(t_n) by a difference quotient δu_n. The stress in equilibrium at t_n is therefore

    σ_n = A ε(δu_n) + G ε(u_n),   (σ_n, ε(v))_Q + λ_n·Nv = F(t_n)·v  for all v ∈ V^h,

and it is constant on every cell.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from manufactured.exact import ExactSolution
from manufactured.tensors import Array, Tensors, identity
from study.fem.error_norm import ErrorNorm
from study.fem.mesh import MeshFamily
from study.fem.space import Space, on_cells
from study.solve.evolution import SemiDiscrete, velocities
from study.solve.tableau import BDF2


@dataclass(frozen=True, eq=False)
class Frame:
    """The numerical solution of a contact problem at one time node t_n.

    Attributes:
        time: the time t_n.
        u, velocity: the displacement u_n and the velocity δu_n, (dofs,).
        stress: the stress σ_n on the cells in Mandel form, (D, cells).
        normal: the normal displacement minus the initial gap at the contact vertices, N u_n − g ≤ 0, (m,).
        multipliers: the nodal contact forces λ_n, (m,).
    """

    time: float
    u: Array
    velocity: Array
    stress: Tensors
    normal: Array
    multipliers: Array


@dataclass(frozen=True, eq=False)
class Motion:
    """The numerical solution, on one mesh, of the problem to which an exact solution belongs.

    Attributes:
        solution: the exact solution, which gives the data.
        family, level: the name of the mesh family, and the level of the mesh.
        space: the space V^h.
        frames: the solution at the time nodes t_0, t_1, …. At t_0 the contact forces are set to 0.
    """

    solution: ExactSolution
    family: str
    level: int
    space: Space
    frames: list[Frame]

    @classmethod
    def of(
        cls,
        solution: ExactSolution,
        family: MeshFamily,
        level: int,
        steps: int,
        notify: Callable[[], object] = lambda: None,
    ) -> Motion:
        """Solve the problem to which an exact solution belongs, and return the numerical solution.

        Args:
            solution: the exact solution, which gives the data.
            family: the mesh family.
            level: the level of the mesh.
            steps: the number of time steps.
            notify: a function that is called after each of the steps + 1 frames, to show progress.

        Raises:
            MeshError: the mesh does not fit the body at this level.
        """
        space = Space(family(solution.body, level), solution.body)
        problem = SemiDiscrete.of_exact(ErrorNorm(solution, space))
        cells = on_cells(space, solution.law)
        found = []
        for state, velocity in velocities(problem, BDF2, steps):
            stress = cells.stress(space.strain(velocity), space.strain(state.u))
            normal = problem.N @ state.u - problem.gap
            found.append(Frame(state.time, state.u, velocity, stress, normal, state.multipliers))
            notify()
        return cls(solution, family.name, level, space, found)


def von_mises(stress: Tensors) -> Array:
    """Return the von Mises stress √(3/2) |dev σ| of stresses σ, (D, ...) → (...).

    The deviator is dev σ = σ − (tr σ/d) I in dimension d. The plane problem has no σ_33. This formula corresponds to
    σ_33 = (σ_11 + σ_22)/2, so that the deviator is the one of plane tensors, which the convex sets of the law (3.3)
    use. The value is then (√3/2) ((σ_11 − σ_22)² + 4 σ_12²)^½, the smallest for any σ_33.
    """
    dim = {3: 2, 6: 3}[len(stress)]
    unit = identity(dim)
    trace = np.tensordot(unit, stress, axes=1)
    deviator = stress - np.multiply.outer(unit / dim, trace)
    return np.asarray(np.sqrt(1.5 * np.sum(deviator**2, axis=0)))
