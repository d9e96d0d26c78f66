"""Time schemes for M u̇ + G(u) + N_{K^h}(u) ∋ F with the constraint at the new time, given by their weights.

A step of size k computes u_n from

    M δu_n + G(θ u_n + (1 − θ) u_{n−1}) + N_{K^h}(u_n) ∋ F(t_{n−1+θ}),     δu_n = (w u_n − Σ_{j≥1} w_j u_{n−j})/k.

Multistep schemes have too few earlier values at first and start with a one-step scheme. The problem defines how a step
is solved: ``study.solve.evolution`` for Problem 5.1, ``study.stresses.hybrid`` for Problem 3.2.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import reduce
from operator import add, sub
from typing import Protocol, TypeVar

from manufactured.tensors import Array
from study.solve.steps import longest_step, require_unique, step_size

S = TypeVar("S")


class TimeProblem(Protocol[S]):
    """A problem in time on [0, T] whose states at the time nodes have the type S."""

    @property
    def T(self) -> float: ...

    def initial(self) -> S:
        """Return the state at t_0."""
        ...

    def stepper(self, scheme: Tableau, k: float) -> Callable[[int, Sequence[S]], S]:
        """Return the function (n, previous states) ↦ state at t_n = n k."""
        ...


@dataclass(frozen=True)
class Tableau:
    """A time scheme, given by its weights.

    Attributes:
        name: for tables and the command line.
        order: the order in k for solutions that are smooth in time.
        newest: w, the weight of u_n in δu_n.
        past: (w_1, w_2, …).
        theta: θ, the relative time in the step at which G and F are evaluated.
        starting: the scheme of the first steps, None for a one-step scheme.
        kept: number of earlier states that a step gets; a nonlinear law extrapolates its first guess from all of them.
    """

    name: str
    order: float
    newest: float
    past: tuple[float, ...]
    theta: float = 1.0
    starting: Tableau | None = None
    kept: int = 3

    def known(self, before: Sequence[Array]) -> Array:
        """Return the sum Σ_{j≥1} w_j u_{n−j} from (…, u_{n−2}, u_{n−1})."""
        return reduce(add, (w * u for w, u in zip(self.past, reversed(before), strict=False)))

    def rate(self, u: Array, before: Sequence[Array], k: float) -> Array:
        """Return the difference quotient δu_n from u_n and (…, u_{n−2}, u_{n−1})."""
        return reduce(sub, (w * v for w, v in zip(self.past, reversed(before), strict=False)), self.newest * u) / k

    def of_step(self, n: int) -> Tableau:
        """Return the scheme for the step to t_n: this scheme, or the starting scheme as long as values are missing."""
        return self.starting if self.starting and n < len(self.past) else self

    def balanced(self, n: int, k: float) -> float:
        """Return the time t_{n−1+θ} at which forces are in balance in the step to t_n."""
        # For θ = ½ this equals the knots of a spline through the nodes to the last bit.
        return (1 - self.theta) * ((n - 1) * k) + self.theta * (n * k)

    def longest(self, growth: float) -> float:
        """Return ``longest_step`` of all steps, including the first ones."""
        mine = longest_step(growth, self.newest, self.theta)
        return min(mine, self.starting.longest(growth)) if self.starting else mine

    def require_unique(self, k: float, growth: float) -> None:
        """Refuse a step that may have several solutions.

        Raises:
            StepsError: the message gives the permitted length of steps.
        """
        require_unique(self.name, k, growth, self.longest(growth))

    def march(self, problem: TimeProblem[S], steps: int) -> Iterator[S]:
        """Yield the states at t_0, t_1, …, t_steps = T.

        Raises:
            StepsError: fewer than one step.
        """
        k = step_size(problem.T, steps)
        before = [problem.initial()]
        yield before[0]
        scheme: Tableau | None = None
        for n in range(1, steps + 1):
            if self.of_step(n) is not scheme:
                scheme = self.of_step(n)
                step = problem.stepper(scheme, k)
            before = [*before, step(n, before)][-self.kept :]
            yield before[-1]


BACKWARD_EULER = Tableau("backward-euler", 1.0, 1.0, (1.0,))
"""Backward Euler: M (u_n − u_{n−1})/k + G(u_n) + N_{K^h}(u_n) ∋ F(t_n)."""

MIDPOINT = Tableau("midpoint", 2.0, 1.0, (1.0,), theta=0.5)
"""The midpoint scheme: M (u_n − u_{n−1})/k + G((u_n + u_{n−1})/2) + N_{K^h}(u_n) ∋ F(t_{n−1/2}).

The order is 2 as long as no vertex comes into contact, and 1 if this relieves a neighbour in contact
(``statements.landings``).
"""

BDF2 = Tableau("bdf2", 2.0, 1.5, (2.0, -0.5), starting=BACKWARD_EULER, kept=2)
"""Second-order BDF: M (3u_n − 4u_{n−1} + u_{n−2})/(2k) + G(u_n) + N_{K^h}(u_n) ∋ F(t_n), first step backward Euler."""

SCHEMES = (BACKWARD_EULER, BDF2, MIDPOINT)
