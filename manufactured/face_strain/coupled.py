"""(q, r) of a linear law that couples nn with sn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import sympy as sp

from manufactured.face_strain.hereditary import Memory
from manufactured.face_strain.strain_on_face import Components, StrainAtPoints
from manufactured.tensors import Array


@dataclass(frozen=True, eq=False)
class Coupled:
    """(q, r) of a linear law that couples nn with sn: y = Σ_i x_i η_i over the modes of 𝒜 ẏ + 𝒢 y = (−p, 0).

    With XᵀAX = I and 𝒢 x_i = λ_i 𝒜 x_i, each scalar equation
    η̇_i + λ_i η_i = −(x_i)_0 p is solved by a ``Memory``.

    Attributes:
        pressure: p(s, t).
        modes: the memories of the η_i.
        vectors: the x_i as columns, (d, d).
    """

    pressure: sp.Expr
    modes: tuple[Memory, ...]
    vectors: Array

    @classmethod
    def of(
        cls,
        pressure: sp.Expr,
        viscous: Array,
        elastic: Array,
        scale: sp.Expr,
        T: float,
        variables: tuple[sp.Symbol, ...],
    ) -> Coupled:
        """Return (q, r) for the blocks 𝒜 and 𝒢, (d, d), both times ``scale``, with elastic equilibrium at t = 0."""
        inverse = np.linalg.inv(np.linalg.cholesky(viscous))
        rates, basis = np.linalg.eigh(inverse @ elastic @ inverse.T)
        vectors = inverse.T @ basis
        modes = tuple(
            Memory(sp.Float(x) * pressure, scale, float(rate) * scale, T, variables=variables)
            for rate, x in zip(rates, vectors[0], strict=True)
        )
        return cls(pressure, modes, vectors)

    @property
    def formula(self) -> sp.Expr:
        """The pressure."""
        return self.pressure

    def at(self, points: Array) -> StrainAtPoints:
        modes = [mode.at(points) for mode in self.modes]

        def strain(time: Array | complex, rate: bool, order: int) -> Components:
            found = [mode(time, rate, order) for mode in modes]
            return tuple(
                {index: sum(x * v[index] for x, (v,) in zip(row, found, strict=True)) for index in found[0][0]}
                for row in self.vectors
            )

        return strain
