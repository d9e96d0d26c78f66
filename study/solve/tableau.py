"""Time schemes for M u̇ + G(u) + N_{K^h}(u) ∋ F, given by their weights.

The constraint is imposed at the new time. A step of size k computes u_n from

    M δu_n + G(θ u_n + (1 − θ) u_{n−1}) + N_{K^h}(u_n) ∋ F(t_{n−1+θ}),     δu_n = (w u_n − Σ_{j≥1} w_j u_{n−j})/k.

A multistep scheme has too few earlier values at first, so its first steps use a one-step scheme. How a step is solved
is defined by the problem: ``study.solve.evolution`` for Problem 5.1, ``study.stresses.hybrid`` for Problem 3.2.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import reduce
from operator import add
from typing import Any, Protocol, TypeVar

from manufactured.tensors import Array
from study.solve.steps import longest_step, require_unique, step_size

StateT = TypeVar("StateT")


class TimeProblem(Protocol[StateT]):
    """The interface of problems on [0, T] that a time scheme solves; StateT is the type of a state at a time node."""

    @property
    def T(self) -> float: ...

    def initial(self) -> StateT:
        """Return the state at the initial time t_0."""
        ...

    def stepper(self, scheme: Tableau, k: float) -> Callable[[int, Sequence[StateT]], StateT]:
        """Return the function that computes the state at t_n = n k from n and the previous states."""
        ...


@dataclass(frozen=True)
class Tableau:
    """A time scheme for M u̇ + G(u) + N_K(u) ∋ F, given by its weights.

    A step of size k computes u_n from M δu_n + G(θ u_n + (1 − θ) u_{n−1}) + N_K(u_n) ∋ F(t_{n−1+θ}), with the
    difference quotient δu_n = (w u_n − Σ_{j≥1} w_j u_{n−j})/k. N_K is the normal cone of the admissible set.

    Attributes:
        name: the name in tables and on the command line.
        order: the order in k for solutions that are smooth in time.
        newest: the weight w of u_n in the difference quotient.
        past: the weights (w_1, w_2, …) of the earlier values u_{n−1}, u_{n−2}, ….
        theta: the number θ; elastic forces and loads are evaluated at t_{n−1+θ}.
        starting: the scheme of the first steps of a multistep scheme; None for a one-step scheme.
        kept: the number of earlier states that a step gets. The first guess for a nonlinear law is extrapolated from
            all of them.
    """

    name: str
    order: float
    newest: float
    past: tuple[float, ...]
    theta: float = 1.0
    starting: Tableau | None = None
    kept: int = 3

    def known(self, before: Sequence[Array]) -> Array:
        """Return Σ_{j≥1} w_j u_{n−j}, the part of the difference quotient from earlier values with the weights w_j.

        Args:
            before: the earlier values in the order of time, (…, u_{n−2}, u_{n−1}).
        """
        return reduce(add, (w * u for w, u in zip(self.past, reversed(before), strict=False)))

    def rate(self, u: Array, before: Sequence[Array], k: float) -> Array:
        """Return the velocity δu_n, the difference quotient of the scheme.

        Args:
            u: the value u_n.
            before: the earlier values in the order of time, (…, u_{n−2}, u_{n−1}).
            k: the step size.
        """
        return (self.newest * u - self.known(before)) / k

    def of_step(self, n: int) -> Tableau:
        """Return the scheme that is used for the step to t_n.

        Args:
            n: the number of the step. The first steps of a multistep scheme, for which earlier values are missing, use
                the scheme ``starting``.
        """
        return self.starting if self.starting and n < len(self.past) else self

    def balanced(self, n: Array | int, k: float) -> Any:
        """Return the time t_{n−1+θ} = (n − 1 + θ) k at which the forces are in equilibrium in the step to t_n."""
        # The formula is chosen such that, for θ = ½, it gives exactly the same numbers as the knots of splines in
        # ``study.bound``.
        return (1 - self.theta) * ((n - 1) * k) + self.theta * (n * k)

    def longest(self, growth: float) -> float:
        """Return the step size below which every step has a unique solution, including the first steps.

        Args:
            growth: the largest rate at which differences of solutions can grow (``study.solve.steps.longest_step``).
        """
        mine = longest_step(growth, self.newest, self.theta)
        return min(mine, self.starting.longest(growth)) if self.starting else mine

    def require_unique(self, k: float, growth: float) -> None:
        """Refuse a step size k for which a time step may have several solutions.

        Raises:
            StepsError: k is too large for ``growth``, the largest rate at which differences of solutions can grow; the
                message gives the permitted size.
        """
        require_unique(self.name, k, growth, self.longest(growth))

    def march(self, problem: TimeProblem[StateT], steps: int) -> Iterator[StateT]:
        """Solve a problem by this time scheme with equal steps and yield its states at t_0, t_1, …, t_steps = T.

        Args:
            problem: the problem on [0, T].
            steps: the number of time steps.

        Raises:
            StepsError: there is less than one step.
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
"""Backward Euler: M (u_n − u_{n−1})/k + G(u_n) + N_K(u_n) ∋ F(t_n), with the normal cone N_K of the admissible set."""

MIDPOINT = Tableau("midpoint", 2.0, 1.0, (1.0,), theta=0.5)
"""The midpoint scheme: M (u_n − u_{n−1})/k + G((u_n + u_{n−1})/2) + N_K(u_n) ∋ F(t_{n−1/2}).

N_K is the normal cone of the admissible set. The order is 2 as long as no vertex comes into contact. If a vertex comes
into contact and thereby relieves a neighbour in contact, the order is 1 (``study.statements.time_steps``).
"""

BDF2 = Tableau("bdf2", 2.0, 1.5, (2.0, -0.5), starting=BACKWARD_EULER, kept=2)
"""The backward difference formula of order 2: M (3u_n − 4u_{n−1} + u_{n−2})/(2k) + G(u_n) + N_K(u_n) ∋ F(t_n).

N_K is the normal cone of the admissible set. The first step is a step of backward Euler.
"""

SCHEMES = (BACKWARD_EULER, BDF2, MIDPOINT)
