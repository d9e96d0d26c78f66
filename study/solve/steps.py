"""Time steps: their size, and how many of them a mesh of level n, h ~ 1/n, is given.

Both rules give pace · T · n^e steps, as few as make the error in time negligible beside the one in space.
"""

from __future__ import annotations

import math

from study.ledger.files import UsageError

PACE = 8.0
"""Steps per n^{2/3} and unit of time where a case does not ask for more."""


MOST = 1_000_000
"""Steps of one trajectory, beyond which a run would stand still for days."""


class StepsError(ValueError):
    """There is no time step."""


def step_size(T: float, steps: int) -> float:
    """k = T/steps.

    Raises:
        StepsError: fewer than one step.
    """
    if steps < 1:
        raise StepsError(f"{steps} steps cannot reach T = {T:g}; take one step or more")
    return T / steps


def longest_step(growth: float, newest: float = 1.0, theta: float = 1.0) -> float:
    """The k below which steps have one solution where differences may grow at a rate ω ≤ L_G/m_A, ∞ for ω = 0.

    (w/k) A + θ G is strongly monotone for θ k ω < w, so in particular for k L_G < m_A; w = θ = 1 is backward Euler.
    """
    return newest / (theta * growth) if growth else math.inf


def require_unique(scheme: str, k: float, growth: float, longest: float) -> None:
    """Refuse a step that need not have one solution, where differences may grow at a rate ω ≤ L_G/m_A.

    Raises:
        StepsError: k is ``longest`` or more; says which steps have one.
    """
    if k >= longest:
        raise StepsError(
            f"steps of {scheme} of size k = {k:.6g} need not have one solution: G is not monotone, so that "
            f"differences may grow at the rate {growth:.6g}; take k < {longest:.6g} (k < m_A/L_G always serves)"
        )


def require_steps(steps: int) -> None:
    """Refuse, before time is spent, more steps than anybody waits for.

    Raises:
        UsageError: says how many there are and how many there may be.
    """
    if steps > MOST:
        raise UsageError(f"{steps:.3g} time steps are asked for, at most {MOST:.0e} are taken; make them longer")


def rate_steps(T: float, level: int, pace: float = PACE) -> int:
    """⌈pace · T · n^{2/3}⌉, so that k ~ h^{2/3}, for errors of order h.

    A scheme of order 3/2 (midpoint where u̇ jumps) then has a time error of the order h, one of order 2 an error of
    order h^{4/3}.
    """
    return math.ceil(pace * T * level ** (2 / 3))


def stress_steps(T: float, level: int, pace: float = PACE) -> int:
    """About pace/2 · T · n steps, at least T · n and at most 4 T · n, so that k ~ h, for errors of order h².

    Their number is even: half as many steps show what the error in time contributes.
    """
    return 2 * round(min(max(1.0, pace / 2), 4.0) * T * level / 2)
