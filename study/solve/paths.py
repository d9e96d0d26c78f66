"""Numerical solutions as arrays of displacements at equidistant times, and distances between such solutions."""

import math
from itertools import pairwise

import numpy as np

from manufactured.tensors import Array
from study.solve.evolution import Scheme, SemiDiscrete


def path(problem: SemiDiscrete, scheme: Scheme, steps: int) -> Array:
    """Solve the semi-discrete problem and return the displacements u_0, …, u_steps, (steps + 1, n)."""
    return np.array([state.u for state in scheme.march(problem, steps)])


def interpolated(states: Array, steps: int) -> Array:
    """Interpolate displacements linearly to a finer time grid, (steps + 1, n).

    Args:
        states: displacements at the nodes of the coarse grid, (N + 1, n).
        steps: the number of steps of the finer grid, a multiple of N.
    """
    inner = steps // (len(states) - 1)
    part = np.arange(inner)[:, None] / inner
    pieces = [left + part * (right - left) for left, right in pairwise(states)]
    return np.vstack([*pieces, states[-1:]])


def last(states: Array, steps: int) -> tuple[Array, Array]:
    """Evaluate the piecewise constant function that is U_n on (t_{n−1}, t_n], at the nodes of a finer time grid.

    Args:
        states: the displacements U_0, …, U_N, (N + 1, n).
        steps: the number of steps of the finer grid, a multiple of N.

    Returns:
        The left and the right limits at the nodes of the finer grid, (steps + 1, n) each.
    """
    ahead = np.repeat(states[1:], steps // (len(states) - 1), axis=0)
    left = np.vstack([states[:1], ahead])
    right = np.vstack([ahead, states[-1:]])
    return left, right


def oscillation(problem: SemiDiscrete, states: Array, steps: int) -> float:
    """Return the largest difference ‖v̇(r) − v̇(s)‖_V of the velocities of a solution within one time step.

    Args:
        problem: gives the norm of V and the final time.
        states: the displacements v at equidistant times, (N + 1, n); v is linear between them.
        steps: the number of time steps into which [0, T] is divided, a divisor of N.
    """
    inner = (len(states) - 1) // steps
    rates = np.diff(states, axis=0) * ((len(states) - 1) / problem.T)
    groups = rates.reshape(steps, inner, -1)
    weighted = (problem.M @ rates.T).T.reshape(groups.shape)
    products = np.einsum("nid,njd->nij", groups, weighted)
    squares = np.einsum("nii->ni", products)
    apart = squares[:, :, None] + squares[:, None] - 2 * products
    return math.sqrt(max(float(apart.max()), 0.0))


def furthest(problem: SemiDiscrete, one: Array, other: Array) -> float:
    """Return the largest distance max_n ‖v_n − w_n‖_V of two solutions at the same times, (steps + 1, n) each."""
    away = one - other
    weighted = (problem.M @ away.T).T
    squares = np.sum(away * weighted, axis=1)
    return math.sqrt(squares.max())
