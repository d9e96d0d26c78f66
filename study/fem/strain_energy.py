"""∫_Ω α C ε·ε dx of an exact strain, as a quadratic form in its amplitudes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import combinations

import numpy as np
import scipy.sparse as sps

from manufactured.modes import Modes
from manufactured.tensors import Array
from study.fem.moments import Amplitudes, strain_at_points

MANY = 4
"""The matrices of the quadratic form may take this many times the storage of the modes."""


def energy(modes: Sequence[Modes], weights: Array, C: Array) -> Callable[[Amplitudes], float]:
    """∫_Ω α C ε·ε dx.

    Where many points share a place along the face, matrices act on the amplitudes. Where hardly any do, these matrices
    would be many times as large as the modes, and the strain is summed point by point.

    Args:
        modes: the contributions to ε at the points.
        weights: quadrature weights times α, (n,).
        C: symmetric, Mandel (D, D).
    """
    size = sum(len(part.tensors) ** 2 * part.count for part in modes)
    by_place = size <= MANY * sum(part.shapes.size for part in modes)
    return (_ByPlace if by_place else _ByPoint)(modes, weights, C)


class _ByPoint:
    """Σ_p w_p C ε·ε."""

    def __init__(self, modes: Sequence[Modes], weights: Array, C: Array) -> None:
        self.modes, self.weights, self.C = modes, weights, C

    def __call__(self, amplitudes: Amplitudes) -> float:
        strain = strain_at_points(self.modes, amplitudes, len(self.weights))
        return float(np.einsum("In,In,n->", self.C @ strain, strain, self.weights))


class _ByPlace:
    """Quadratic forms in the amplitudes of one contribution, bilinear ones in those of two."""

    def __init__(self, modes: Sequence[Modes], weights: Array, C: Array) -> None:
        self._own = [_own(part, weights, C) for part in modes]
        self._mixed = [(i, j, _mixed(modes[i], modes[j], weights, C)) for i, j in combinations(range(len(modes)), 2)]

    def __call__(self, amplitudes: Amplitudes) -> float:
        own = sum(np.einsum("kj,klj,lj->", T, C, T) for T, C in zip(amplitudes, self._own, strict=True))
        mixed = sum(amplitudes[i].ravel() @ (C @ amplitudes[j].ravel()) for i, j, C in self._mixed)
        return float(own + 2 * mixed)


def _own(modes: Modes, weights: Array, C: Array) -> Array:
    """Σ_p w_p C E_k·E_l φ_k φ_l over the points of each place, (K, K, J): points of two places never meet."""
    found = np.zeros((len(modes.tensors), len(modes.tensors), modes.count))
    weights = weights[modes.points]
    for (k, l), product in np.ndenumerate(modes.tensors @ C @ modes.tensors.T):
        if product and k <= l:
            found[k, l] = np.bincount(modes.places, product * weights * modes.shapes[k] * modes.shapes[l], modes.count)
            found[l, k] = found[k, l]
    return found


def _mixed(one: Modes, other: Modes, weights: Array, C: Array) -> sps.csr_array:
    """The same for two contributions at the points that both reach, (K J, K' J')."""
    common, mine, others = np.intersect1d(one.points, other.points, assume_unique=True, return_indices=True)
    weights, j, jj = weights[common], one.places[mine], other.places[others]
    data, rows, columns = [np.empty(0)], [np.empty(0, dtype=int)], [np.empty(0, dtype=int)]
    for (k, l), product in np.ndenumerate(one.tensors @ C @ other.tensors.T):
        if product:
            data.append(product * weights * one.shapes[k, mine] * other.shapes[l, others])
            rows.append(j + k * one.count)
            columns.append(jj + l * other.count)
    shape = (len(one.tensors) * one.count, len(other.tensors) * other.count)
    return sps.csr_array((np.concatenate(data), (np.concatenate(rows), np.concatenate(columns))), shape=shape)
