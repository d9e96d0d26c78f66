"""Trajectories of Problem 5.1 as arrays, and distances between them."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from manufactured.tensors import Array
from study.solve.evolution import Scheme, SemiDiscrete


def path(problem: SemiDiscrete, scheme: Scheme, steps: int) -> Array:
    """Return the displacements u_0, …, u_steps, (steps + 1, n)."""
    return np.array([state.u for state in scheme.march(problem, steps)])


def interpolated(states: Array, steps: int) -> Array:
    """Return the piecewise linear interpolant at the nodes of a finer grid, (steps + 1, n).

    Args:
        steps: number of steps of the finer grid, a multiple of the number of steps of ``states``.
    """
    inner = steps // (len(states) - 1)
    part = np.arange(inner)[:, None] / inner
    pieces = [left + part * (right - left) for left, right in pairwise(states)]
    return np.vstack([*pieces, states[-1:]])


def last(states: Array, steps: int) -> tuple[Array, Array]:
    """Return the function with value U_n on (t_{n−1}, t_n] at the nodes of a finer grid, as left and right limits.

    Both arrays are (steps + 1, n).
    """
    ahead = np.repeat(states[1:], steps // (len(states) - 1), axis=0)
    return np.vstack([states[:1], ahead]), np.vstack([ahead, states[-1:]])


def oscillation(problem: SemiDiscrete, states: Array, steps: int) -> float:
    """Return the largest difference of velocities max_n sup ‖v̇(r) − v̇(s)‖_V, r and s in the same one of ``steps``
    steps.

    v is piecewise linear through the states.
    """
    inner = (len(states) - 1) // steps
    rates = np.diff(states, axis=0) * ((len(states) - 1) / problem.T)
    groups = rates.reshape(steps, inner, -1)
    products = np.einsum("nid,njd->nij", groups, (problem.M @ rates.T).T.reshape(groups.shape))
    squares = np.einsum("nii->ni", products)
    apart = squares[:, :, None] + squares[:, None] - 2 * products
    return math.sqrt(max(float(apart.max()), 0.0))


def furthest(problem: SemiDiscrete, one: Array, other: Array) -> float:
    """Return the largest distance max_n ‖v_n − w_n‖_V."""
    away = one - other
    return math.sqrt(np.sum(away * (problem.M @ away.T).T, axis=1).max())
