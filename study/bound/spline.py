"""A trajectory ũ that is differentiable in time, from the nodes of any time scheme.

The nodes d_0, …, d_N ∈ K are the control points of a quadratic B-spline with knots at the midpoints of the steps,

    ũ(t_{j−1/2}) = (d_{j−1} + d_j)/2,    ũ̇(t_{j−1/2}) = (d_j − d_{j−1})/k,    ũ̇ linear in between,

and the straight line on the first and the last half step. All its points are convex combinations of nodes: ũ(t) ∈ K for
every t, however wrong the nodes are. At the knots ũ and ũ̇ are the value and the difference quotient of the midpoint
scheme.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from manufactured.tensors import Array


@dataclass(frozen=True, eq=False)
class Parabola:
    """ũ between two knots a < b: Bernstein coefficients (start, control, end) in time.

    Attributes:
        a, b: the knots.
        start, control, end: coefficients of ũ, (dofs,) each.
    """

    a: float
    b: float
    start: Array
    control: Array
    end: Array

    def at(self, time: float) -> Array:
        """ũ(t) for a ≤ t ≤ b."""
        x = (time - self.a) / (self.b - self.a)
        return (1 - x) ** 2 * self.start + 2 * x * (1 - x) * self.control + x**2 * self.end

    def rate(self, end: bool) -> Array:
        """ũ̇ at a or b."""
        difference = self.end - self.control if end else self.control - self.start
        return 2 * difference / (self.b - self.a)


def spline(nodes: Iterable[tuple[float, Array]]) -> Iterator[Parabola]:
    """The pieces of the quadratic B-spline with nodes (t_j, d_j), equally spaced in time, as control points."""
    iterator = iter(nodes)
    before, old = next(iterator)
    knot, point = before, old
    for time, new in iterator:
        middle, here = (before + time) / 2, (old + new) / 2
        # The first half step is a straight line: its control point lies between its ends.
        control = (point + here) / 2 if knot == before else old
        yield Parabola(knot, middle, point, control, here)
        before, old, knot, point = time, new, middle, here
    yield Parabola(knot, before, point, (point + old) / 2, old)
