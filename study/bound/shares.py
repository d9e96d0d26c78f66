"""Which cells, and how much the steps in time, have a share in a bound: what is to be refined.

A bound y is a sum over the pieces of ũ of what each adds, decayed until then. What a piece adds is shared out among

* the cells T, in the proportions of k (‖ρ‖_T + η_T)²/(Σ …)^{1/2} without that part of ρ which changes within the piece,
  of what contact adds on the sides of T on Γ3, and of what samples of the data miss in T;
* time, in the proportions of that part of ρ, of P f minus its parabola, and of what samples miss between times.

ρ is measured in the norm that stresses are balanced in (``Moduli.weights``). Shares add up to the bound; which of them
is called whose is a heuristic and no part of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from manufactured.tensors import Array


@dataclass(frozen=True, eq=False)
class Shares:
    """Non-negative parts of a bound: those of the cells, (cells,), and that of time."""

    cells: Array
    time: float

    @property
    def total(self) -> float:
        return float(self.cells.sum()) + self.time

    def __add__(self, other: Shares) -> Shares:
        return Shares(self.cells + other.cells, self.time + other.time)

    def __rmul__(self, factor: float) -> Shares:
        return Shares(factor * self.cells, factor * self.time)

    def of(self, total: float) -> Shares:
        """The same proportions of another total; all of it is that of time if there are none."""
        if self.total <= 0:
            return Shares(0 * self.cells, total)
        return total / self.total * self


def proportional(squares: Array) -> Array:
    """Parts of the root of a sum of squares, in their proportions."""
    return np.asarray(squares / max(np.sqrt(squares.sum()), np.finfo(float).tiny))


def part_that_changes(products: Array, squares: Array) -> Array:
    """The part of the mean squares of parabolas in time that is not that of their means, between 0 and 1.

    Args:
        products: of any two of their coefficients in Bernstein form, (3, 3, n).
        squares: the mean squares that follow from them, (n,).
    """
    # Every Bernstein polynomial of degree 2 has the mean 1/3.
    means = products.sum(axis=(0, 1)) / 9
    return np.clip(1 - np.divide(means, squares, out=np.ones_like(squares), where=squares > 0), 0.0, 1.0)


def marked(shares: Array, part: float) -> Array:
    """The fewest cells that together have a part 0 < θ ≤ 1 of all shares, (n,).

    Source: W. Dörfler, SIAM J. Numer. Anal. 33 (1996) 1106–1124.
    """
    order = np.argsort(-shares, kind="stable")
    sums = np.cumsum(shares[order])
    return np.sort(order[: int(np.searchsorted(sums, part * sums[-1] * (1 - 1e-12))) + 1])
