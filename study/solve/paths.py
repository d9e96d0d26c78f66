"""Trajectories of Problem 5.1 as arrays, and how far apart they are."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from manufactured.tensors import Array
from study.solve.evolution import Scheme, SemiDiscrete


def path(problem: SemiDiscrete, scheme: Scheme, steps: int) -> Array:
    """u_0, …, u_steps, (steps + 1, n)."""
    return np.array([state.u for state in scheme.march(problem, steps)])


def interpolated(states: Array, steps: int) -> Array:
    """The piecewise linear interpolant at the nodes of more steps, a multiple, (steps + 1, n)."""
    inner = steps // (len(states) - 1)
    part = np.arange(inner)[:, None] / inner
    pieces = [left + part * (right - left) for left, right in pairwise(states)]
    return np.vstack([*pieces, states[-1:]])


def furthest(problem: SemiDiscrete, one: Array, other: Array) -> float:
    """max_n ‖v_n − w_n‖_V."""
    away = one - other
    return math.sqrt(np.sum(away * (problem.M @ away.T).T, axis=1).max())
