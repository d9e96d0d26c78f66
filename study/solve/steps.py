"""Size and number of time steps.

Two rules (``rate_steps``, ``stress_steps``) give the number of steps on a mesh of level n, where h ~ 1/n. Both give
about pace · T · n^e steps, where ``pace`` is a factor and the exponent e depends on the rule. This is just enough for
the time error to be negligible relative to the error in space.
"""

import math

from study.ledger.files import UsageError

PACE = 8.0
"""Default number of time steps per unit of time, divided by n^{2/3} at level n."""
STEPS_LIMIT = 1_000_000
"""Largest number of steps of one solution. More would take days."""


class StepsError(ValueError):
    """Raised if a number or length of time steps is not permitted."""


def step_size(T: float, steps: int) -> float:
    """Return the step size k = T/steps.

    Raises:
        StepsError: there is less than one step.
    """
    if steps < 1:
        raise StepsError(f"the number of steps up to T = {T:g} is {steps}; take one step or more")
    return T / steps


def longest_step(growth: float, newest: float = 1.0, theta: float = 1.0) -> float:
    """Return the step size below which a time step has a unique solution; infinity if G is monotone.

    A step of size k has a unique solution if (w/k) A + θ G is strongly monotone, which holds for θ k ω < w.

    Args:
        growth: the largest rate ω ≤ L_G/m_A at which differences of solutions can grow; 0 for a monotone G.
        newest, theta: the numbers w and θ of the time scheme (``Tableau``). The defaults belong to backward Euler.
    """
    return newest / (theta * growth) if growth else math.inf


def require_unique(scheme: str, k: float, growth: float, longest: float) -> None:
    """Refuse a step size for which a time step may have several solutions.

    Args:
        scheme: the name of the time scheme, for the message.
        k: the step size.
        growth: the largest rate at which differences of solutions can grow, for the message.
        longest: the step size that must not be reached.

    Raises:
        StepsError: k is ``longest`` or more.
    """
    if k >= longest:
        raise StepsError(
            f"steps of {scheme} of size k = {k:.6g} need not have one solution: G is not monotone, so that "
            f"differences may grow at the rate {growth:.6g}; take k < {longest:.6g} (k < m_A/L_G always suffices)"
        )


def require_steps(steps: int) -> None:
    """Refuse a number of steps that would take days, or less than one step, before time is spent.

    Raises:
        UsageError: there is no step, or there are more than ``STEPS_LIMIT`` steps.
    """
    if not 1 <= steps <= STEPS_LIMIT:
        raise UsageError(f"{steps:.3g} time steps were asked for, but only 1 to {STEPS_LIMIT:.0e} are allowed")


def rate_steps(T: float, level: int, pace: float = PACE) -> int:
    """Return the number of time steps for an error in space of order h: ⌈pace · T · n^{2/3}⌉, so that k ~ h^{2/3}.

    The mesh has level n, and the factor ``pace`` scales the number of steps. The time error is then of order h for a
    scheme of order 3/2 (midpoint if u̇ jumps), and of order h^{4/3} for a scheme of order 2.
    """
    return math.ceil(pace * T * level ** (2 / 3))


def stress_steps(T: float, level: int, pace: float = PACE) -> int:
    """Return the number of time steps for an error in space of order h²: about pace/2 · T · n, so that k ~ h.

    The mesh has level n, and the factor ``pace`` scales the number of steps. The number lies between T · n and 4 · T ·
    n and is even and positive, because a solution with half as many steps is computed, too. The difference of both
    solutions shows which part of the error is due to time.
    """
    return 2 * max(round(min(max(1.0, pace / 2), 4.0) * T * level / 2), 1)
