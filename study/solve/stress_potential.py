"""The potential that the stress of Problem 3.2 minimises in a step of backward Euler.

By (3.12) and (3.15), σ_n minimises over Σ^h(t_n) the potential Φ whose derivative inverts the law of the step,
ε_n ↦ σ_n = A (ε_n − ε_{n−1})/k + G ε_n, so that DΦ(σ_n) = ε_n:

* linear G, with C = A/k + G:

      Φ(τ) = ½ (C⁻¹ τ, τ)_Q + (C⁻¹ (A/k) ε_{n−1}, τ)_Q;

* the law (3.3), G ε = β (ε − P_K ε): the strain is the same in A and in G, so the potential is the infimal
  convolution over splittings τ = s₁ + s₂,

      Φ(s₁, s₂) = ½ k (A⁻¹ s₁, s₁)_Q + (s₁, ε_{n−1})_Q + |s₂|²_Q/(2β) + ∫_Ω h_K(s₂),

  where h_K, the support function of K = {|Pτ| ≤ r}, is r |s₂| on the range of the projector P and infinite elsewhere;

* both together, G ε = S + C ε + β (ε − P_K ε), with Ĉ = A/k + C positive and the strain r = Ĉ⁻¹((A/k) ε_{n−1} − S):
  the same with Ĉ⁻¹ in place of k A⁻¹ and r in place of ε_{n−1}.

Both are integrals of densities ½ Q y·y + g(ε_{n−1})·y, y an unknown on every cell that determines τ there. For (3.3)
it has a part (ρ, z) in the second-order cone ρ ≥ |z|.
"""

from __future__ import annotations

import numpy as np

from manufactured.law import Combined, KelvinVoigt, Linear, Yield
from manufactured.tensors import Array, Tensors
from study.fem.material import means
from study.fem.space import Space


class StressError(RuntimeError):
    """Problem 3.2 could not be solved."""


class LinearPotential:
    """½ C⁻¹τ·τ + C⁻¹(A/k) ε_{n−1}·τ in the unknown y = τ, C = A/k + G with the means of A and G on the cells.

    Attributes:
        quadratic: Q of every cell, (cells, p, p).
        stress: y ↦ τ, (D, p).
        cone: number of entries of (ρ, z), the last ones of y.
    """

    cone = 0

    def __init__(self, space: Space, A: Linear, G: Linear, k: float) -> None:
        self.viscosity = np.multiply.outer(means(space, A.factor), A.matrix / k)
        self.quadratic = np.linalg.inv(self.viscosity + np.multiply.outer(means(space, G.factor), G.matrix))
        self.quadratic = (self.quadratic + self.quadratic.swapaxes(1, 2)) / 2
        self.stress = np.eye(len(A.matrix))

    def linear(self, strain: Tensors) -> Array:
        """g(ε_{n−1}), (p, cells)."""
        return _act(self.quadratic, _act(self.viscosity, strain))

    def strain(self, y: Array, old: Tensors) -> Tensors:
        """ε_n = C⁻¹ (σ_n + (A/k) ε_{n−1}), (D, cells)."""
        return _act(self.quadratic, y + _act(self.viscosity, old))


def _act(blocks: Array, values: Array) -> Array:
    """A matrix for every cell times a vector for every cell: (cells, p, r), (r, cells) → (p, cells)."""
    return np.einsum("cpr,rc->pc", blocks, values)


class YieldPotential:
    """½ k A⁻¹s₁·s₁ + s₁·ε_{n−1} + |z|²/(2β) + r ρ in the unknown y = (s₁, ρ, z), ρ ≥ |z|.

    z are the coordinates of s₂ in an orthonormal basis R of the range of P, so that |s₂| = |z|.
    Attributes as for ``LinearPotential``.
    """

    def __init__(self, space: Space, A: Linear, G: Yield, k: float) -> None:
        compliance = k * np.linalg.inv(A.matrix)
        self._with(np.multiply.outer(1 / means(space, A.factor), (compliance + compliance.T) / 2), G)

    def _with(self, compliance: Array, G: Yield) -> None:
        """The potential with k A⁻¹, or what takes its place, on every cell, (cells, D, D)."""
        values, vectors = np.linalg.eigh(G.convex.projector)
        R = vectors[:, values > 0.5]
        D, rank = R.shape
        self.compliance = compliance
        self.cone = 1 + rank
        self.quadratic = np.zeros((len(compliance), D + 1 + rank, D + 1 + rank))
        self.quadratic[:, :D, :D] = self.compliance
        self.quadratic[:, D + 1 :, D + 1 :] = np.eye(rank) / G.beta
        self.stress = np.hstack([np.eye(D), np.zeros((D, 1)), R])
        self.radius = G.convex.radius

    def released(self, strain: Tensors) -> Tensors:
        """The strain without stress from ε_{n−1}: itself, as G vanishes inside K, (D, cells)."""
        return strain

    def linear(self, strain: Tensors) -> Array:
        """g(ε_{n−1}) = (ε_{n−1}, r, 0), (p, cells)."""
        rest = np.zeros((self.cone, strain.shape[1]))
        rest[0] = self.radius
        return np.vstack([self.released(strain), rest])

    def strain(self, y: Array, old: Tensors) -> Tensors:
        """ε_n = ε_{n−1} + k A⁻¹ s₁, (D, cells)."""
        return self.released(old) + _act(self.compliance, y[: len(old)])


class CombinedPotential(YieldPotential):
    """½ Ĉ⁻¹s₁·s₁ + s₁·r + |z|²/(2β) + r_K ρ with Ĉ = A/k + C, r = Ĉ⁻¹((A/k) ε_{n−1} − S) and the radius r_K of K."""

    def __init__(self, space: Space, A: Linear, G: Combined, k: float) -> None:
        self.viscosity = np.multiply.outer(means(space, A.factor), A.matrix / k)
        compliance = np.linalg.inv(self.viscosity + G.linear.matrix)
        self.rest = G.at_rest[:, None]
        self._with((compliance + compliance.swapaxes(1, 2)) / 2, G.yielding)

    def released(self, strain: Tensors) -> Tensors:
        """r, (D, cells)."""
        return _act(self.compliance, _act(self.viscosity, strain) - self.rest)


def potential(space: Space, law: KelvinVoigt, k: float) -> LinearPotential | YieldPotential:
    """The potential of one backward Euler step of a law.

    Raises:
        StressError: the elasticity operator is neither linear nor (3.3) nor a sum of both: its potential is unknown.
    """
    if isinstance(law.G, Linear):
        return LinearPotential(space, law.A, law.G, k)
    if isinstance(law.G, Yield):
        return YieldPotential(space, law.A, law.G, k)
    if isinstance(law.G, Combined):
        return CombinedPotential(space, law.A, law.G, k)
    raise StressError(
        "Problem 3.2 needs a complementary potential, known for Linear, Yield and Combined, not for "
        f"{type(law.G).__name__}"
    )
