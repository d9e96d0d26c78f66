"""Time steps: their size, and how many are taken on a mesh of level n, h ~ 1/n.

Both rules give pace · T · n^e steps, just enough for the time error to be negligible relative to the error in space.
"""

from __future__ import annotations

import math

from study.ledger.files import UsageError

PACE = 8.0
"""Steps per n^{2/3} and unit of time, unless a case requires more."""


MOST = 1_000_000
"""Largest number of steps of one trajectory; more would take days."""


class StepsError(ValueError):
    """Raised if a number or length of time steps is not permitted."""


def step_size(T: float, steps: int) -> float:
    """Return the step size k = T/steps.

    Raises:
        StepsError: fewer than one step.
    """
    if steps < 1:
        raise StepsError(f"{steps} steps cannot reach T = {T:g}; take one step or more")
    return T / steps


def longest_step(growth: float, newest: float = 1.0, theta: float = 1.0) -> float:
    """Return the k below which a step has a unique solution; ∞ if ``growth`` is 0.

    Differences of solutions may grow at the rate ω = ``growth`` ≤ L_G/m_A. (w/k) A + θ G is strongly monotone for θ k ω
    < w, in particular for k L_G < m_A; w = θ = 1 is backward Euler.
    """
    return newest / (theta * growth) if growth else math.inf


def require_unique(scheme: str, k: float, growth: float, longest: float) -> None:
    """Refuse a step that may have several solutions, because differences may grow at a rate ω ≤ L_G/m_A.

    Raises:
        StepsError: k is ``longest`` or more; the message gives the permitted length.
    """
    if k >= longest:
        raise StepsError(
            f"steps of {scheme} of size k = {k:.6g} need not have one solution: G is not monotone, so that "
            f"differences may grow at the rate {growth:.6g}; take k < {longest:.6g} (k < m_A/L_G always serves)"
        )


def require_steps(steps: int) -> None:
    """Refuse a number of steps that would take days, before time is spent.

    Raises:
        UsageError: the message gives the number of steps and the largest permitted number.
    """
    if steps > MOST:
        raise UsageError(f"{steps:.3g} time steps are asked for, at most {MOST:.0e} are taken; make them longer")


def rate_steps(T: float, level: int, pace: float = PACE) -> int:
    """Return the number of steps ⌈pace · T · n^{2/3}⌉, so that k ~ h^{2/3}, for errors of order h.

    A scheme of order 3/2 (midpoint if u̇ jumps) then has a time error of order h, and a scheme of order 2 one of order
    h^{4/3}.
    """
    return math.ceil(pace * T * level ** (2 / 3))


def stress_steps(T: float, level: int, pace: float = PACE) -> int:
    """Return about pace/2 · T · n steps, at least T · n and at most 4 T · n, so that k ~ h, for errors of order h².

    The number is even, because a solution with half as many steps shows the time share of the error.
    """
    return 2 * round(min(max(1.0, pace / 2), 4.0) * T * level / 2)
