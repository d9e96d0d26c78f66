"""Sums of an exact stress over the points of a quadrature, from the amplitudes of its strain."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from manufactured.law import Elasticity, KelvinVoigt, Linear
from manufactured.modes import Modes
from manufactured.tensors import Array, Tensors
from study.fem.moments import Amplitudes, QuadraturePoints, StrainSums, strain_at_points


class StressSums:
    """Σ w_p σ(x_p, t) for σ = A ε(u̇) + G ε(u), (2.1).

    Args:
        law: A = α C and G.
        modes: the contributions to ε at the points.
        points: which points are summed, with which weights.

    Attributes:
        viscous: Σ w_p α.
        strains: Σ w_p α ε.
    """

    def __init__(self, law: KelvinVoigt, modes: Sequence[Modes], points: QuadraturePoints) -> None:
        self.A, G = law.A, law.G
        viscous, elastic = (points.weights * tensor.factor(points.x) for tensor in (self.A, G))
        self.viscous = points.totals(viscous)
        self.strains = StrainSums(modes, points, viscous)
        self._response: Callable[[Amplitudes], Tensors]
        if isinstance(G, Linear):
            same = np.array_equal(viscous, elastic)
            self._response = _linear(G, self.strains if same else StrainSums(modes, points, elastic))
        else:
            self._response = _Pointwise(G, modes, points, elastic)

    def __call__(self, strains: Amplitudes, rates: Amplitudes) -> Tensors:
        """(D, sums) from the amplitudes of ε and ε̇ at one time."""
        return self.A.matrix @ self.strains(rates) + self._response(strains)


def _linear(G: Linear, sums: StrainSums) -> Callable[[Amplitudes], Tensors]:
    """Σ w_p G ε for a linear G: G of the sum of the strains."""
    return lambda strains: G.matrix @ sums(strains)


class _Pointwise:
    """Σ w_p G ε for a G that is evaluated at every point; the weights have the factor of G."""

    def __init__(self, G: Elasticity, modes: Sequence[Modes], points: QuadraturePoints, weights: Array) -> None:
        self.G, self.modes, self.points, self.weights = G, modes, points, weights

    def __call__(self, strains: Amplitudes) -> Tensors:
        strain = strain_at_points(self.modes, strains, len(self.weights))
        return np.array([self.points.totals(component * self.weights) for component in self.G(strain)])
