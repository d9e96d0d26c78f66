"""The strain on a contact face for a linear law that couples normal and shear strains (components nn and sn)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import sympy as sp

from manufactured.arguments import checked
from manufactured.face_strain.hereditary import Memory
from manufactured.face_strain.strain_on_face import Components, StrainAtPoints
from manufactured.symbols import FormulaError
from manufactured.tensors import Array


@dataclass(frozen=True, eq=False)
@checked(FormulaError)
class Coupled:
    """The strain on a contact face for a linear law that couples the normal strain q with the shear strain r.

    y = (q, r) satisfies 𝒜 ẏ + 𝒢 y = −(p, 0) − l with the contact pressure p, the stress l that a slip of the face
    causes, and matrices 𝒜, 𝒢 of moduli. The solution is y = Σ_i x_i η_i with the eigenvectors x_i, for which
    𝒢 x_i = λ_i 𝒜 x_i and Xᵀ𝒜X = I. Each η_i is the solution of η̇_i + λ_i η_i = −x_i·((p, 0) + l), a scalar equation
    that ``Memory`` solves.

    Attributes:
        pressure: the formula of p(s, t).
        modes: the solutions η_i.
        vectors: the eigenvectors x_i as columns, (d, d).
    """

    pressure: sp.Expr
    modes: tuple[Memory, ...]
    vectors: Array

    @classmethod
    @checked(FormulaError)
    def of(
        cls,
        pressure: sp.Expr,
        slip_stress: tuple[sp.Expr, ...],
        viscous: Array,
        elastic: Array,
        scale: sp.Expr,
        T: float,
        initial: sp.Expr | None,
        variables: tuple[sp.Symbol, ...],
    ) -> Coupled:
        """Return the strain on a face.

        Args:
            pressure: the formula of the contact pressure p(s, t).
            slip_stress: the formulas of the d components of l(s, t).
            viscous, elastic: the matrices 𝒜 and 𝒢 of moduli without a common factor, (d, d) each.
            scale: the formula of the common factor.
            T: the final time.
            initial: the formula of q(s, 0), with r(s, 0) = 0; None for a start at rest, q̇ = ṙ = 0.
            variables: the coordinates along the face.
        """
        inverse = np.linalg.inv(np.linalg.cholesky(viscous))
        rates, basis = np.linalg.eigh(inverse @ elastic @ inverse.T)
        vectors = inverse.T @ basis
        modes = tuple(
            Memory(
                sp.Float(x[0]) * pressure,
                scale,
                float(rate) * scale,
                T,
                None if initial is None else float(viscous[0] @ x) * initial,
                variables,
                x @ np.array(slip_stress, dtype=object),
            )
            for rate, x in zip(rates, vectors.T, strict=True)
        )
        return cls(pressure, modes, vectors)

    @property
    def formula(self) -> sp.Expr:
        """The formula from whose truncated powers the smoothness of the strain is read off."""
        return self.pressure + sum(mode.formula for mode in self.modes)

    def at(self, points: Array) -> StrainAtPoints:
        modes = [mode.at(points) for mode in self.modes]

        def strain(time: Array | complex, rate: bool, order: int) -> Components:
            found = [mode(time, rate, order) for mode in modes]
            return tuple(
                {index: sum(x * v[index] for x, (v,) in zip(row, found, strict=True)) for index in found[0][0]}
                for row in self.vectors
            )

        return strain
