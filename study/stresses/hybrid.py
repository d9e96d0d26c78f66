"""The equilibrated stress of least complementary energy in Σ^h(t), by hybridisation.

Wanted is the minimiser of ½ (C⁻¹τ, τ)_Q + (ε*, τ)_Q over the composite stresses with

    Div τ + P f_0 = 0 in Ω,     τν = P f_2 on Γ2,     τ_τ = 0 and τ_ν ≤ 0 on Γ3,

which is (3.9) read strongly, with the projection P of ``study.stresses.loads``. P f_2 and τ_ν are polynomials of degree
k on edges; τ_ν ≤ 0 is asked of its Bernstein coefficients (for k = 1 the values at the ends). Tractions are joined by
multipliers: the moments m_{e,i} = ∫_e u B_i of a displacement of the edges, zero on Γ1. Eliminating the stresses cell
by cell leaves

    minimise ½ mᵀ S m − gᵀ m   with m_ν ≤ 0 on Γ3,      S = Σ_T R (C⁻¹ on Div τ = 0)⁻¹ Rᵀ,

R the tractions of the stresses with Div τ = 0. S is symmetric positive definite if meas Γ1 > 0. This has the form of
one step of Problem 5.1 and is solved by the same contact solver, whose multipliers are the coefficients of the pressure
−τ_ν.

Source of hybridisation: D. N. Arnold, F. Brezzi, Mixed and nonconforming finite element methods: implementation,
postprocessing and error estimates, RAIRO Modél. Math. Anal. Numér. 19 (1985) 7–32.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sps

from manufactured.body import Kind
from manufactured.tensors import Array, Tensors
from study.solve.signorini import Signorini
from study.stresses.loads import Loads
from study.stresses.stress_space import StressSpace


@dataclass(frozen=True, eq=False)
class EquilibratedStress:
    """An element of Σ^h.

    Attributes:
        values: at the points of the space, (3, cells, Q).
        tractions: σν of the cells on their edges in Bernstein form, in the axes of the edges, (cells, 3, n, 2).
        moments: the multipliers m = ∫_e u B_i, (edges, n, 2).
    """

    values: Tensors
    tractions: Array
    moments: Array


class Equilibrium:
    """min ½ (C⁻¹τ, τ)_Q + (ε*, τ)_Q over Σ^h, for many ε* and loads.

    Args:
        space: the stresses.
        compliance: C⁻¹ in Mandel form, (3, 3), or at the points, (cells, Q, 3, 3).
        solver: (S, N) ↦ the contact solve.
    """

    def __init__(self, space: StressSpace, compliance: Array, solver: type[Signorini] = Signorini) -> None:
        self.space, self.compliance = space, compliance
        cells, p = space.cells, space.basis.shape[-1]
        basis = space.basis.reshape(cells, -1, p)
        weighted = (space.weights[..., None, None] * (compliance @ space.basis)).reshape(basis.shape)
        self.stiffness = np.linalg.inv(basis.swapaxes(1, 2) @ weighted)
        # (cells, 3 sides · n · 2, p)
        self.R = space.tractions.reshape(cells, -1, p)
        self.RT = self.R.swapaxes(1, 2)
        self._number()
        local = self.R @ self.stiffness @ self.RT
        rows = np.broadcast_to(self.numbers[:, :, None], local.shape)
        places = rows.ravel(), rows.swapaxes(1, 2).ravel()
        full = sps.coo_array((local.ravel(), places), shape=(self.total, self.total)).tocsc()
        S = sps.csc_array(full[self.free][:, self.free])
        self.S = sps.csc_array((S + S.T) / 2)
        self.solve = solver(self.S, self.N)

    def _number(self) -> None:
        """Numbers of the unknown moments: edge by edge, polynomial by polynomial, two components."""
        space = self.space
        n, edges = space.degree + 1, space.mesh.facets.shape[1]
        self.total = 2 * n * edges
        self.numbers = (2 * n * space.edges[:, :, None] + np.arange(2 * n)).reshape(space.cells, -1)
        free = np.ones((edges, 2 * n), dtype=bool)
        for _, clamped in space.on(Kind.CLAMPED):
            free[clamped] = False
        self.free = np.flatnonzero(free.ravel())
        self.contact = np.concatenate([mine for _, mine in space.on(Kind.CONTACT)])
        normal = (2 * n * self.contact[:, None] + 2 * np.arange(n)).ravel()
        columns = np.searchsorted(self.free, normal)
        places = np.arange(len(columns)), columns
        self.N = sps.csr_array((np.ones(len(columns)), places), shape=(len(columns), len(self.free)))

    def __call__(self, loads: Loads, strain: Tensors, normal: Array | None = None) -> EquilibratedStress:
        """The minimiser.

        Args:
            loads: P f_0 and P f_2.
            strain: ε* at the points, (3, cells, Q).
            normal: the moments ∫_e v B_i ≤ 0 on the edges ``contact`` of a function v whose ∫_{Γ3} τ_ν v is added to
                the functional, (edges of Γ3, n).
        """
        lift, known, g = self._condense(loads, strain)
        shift = np.zeros(self.total)
        if normal is not None:
            shift[self.free] = self.N.T @ normal.ravel()
        v, _ = self.solve(g + self.S @ shift[self.free])
        m = np.zeros(self.total)
        m[self.free] = v
        return self._recover(lift, known, m, m - shift)

    def balance(self, loads: Loads) -> EquilibratedStress:
        """The stress of least (C⁻¹τ, τ)_Q that balances loads without contact, τν = 0 on Γ3."""
        lift, known, g = self._condense(loads, np.zeros((3, *self.space.weights.shape)))
        m = np.zeros(self.total)
        m[self.free] = self.solve.factor(g)
        return self._recover(lift, known, m, m)

    def _condense(self, loads: Loads, strain: Tensors) -> tuple[EquilibratedStress, Array, Array]:
        """Static condensation: the lifting τ_0 of P f_0, (C⁻¹τ_0 + ε*, ·)_Q on the basis, (cells, p), and g."""
        space = self.space
        values, tractions = space.lift(loads.force)
        known = space.tested(np.einsum("...IJ,J...->I...", self.compliance, values) + strain)
        of_lift = tractions.reshape(space.cells, -1) - _times(_times(known, self.stiffness), self.RT)
        g = loads.surface.ravel() - np.bincount(self.numbers.ravel(), of_lift.ravel(), self.total)
        return EquilibratedStress(values, tractions, np.empty(0)), known, g[self.free]

    def _recover(self, lift: EquilibratedStress, known: Array, m: Array, shifted: Array) -> EquilibratedStress:
        """The stress with the multipliers m, from what ``_condense`` found; ``shifted`` is m less the given moments."""
        space = self.space
        c = _times(_times(shifted[self.numbers], self.R) - known, self.stiffness)
        return EquilibratedStress(
            lift.values + space.combined(c),
            lift.tractions + _times(c, self.RT).reshape(lift.tractions.shape),
            m.reshape(-1, space.degree + 1, 2),
        )

    def pressure(self, stress: EquilibratedStress) -> Array:
        """Bernstein coefficients of −τ_ν ≥ 0 on the edges ``contact``, (edges of Γ3, n)."""
        return -self.space.boundary_tractions(self.contact, stress.tractions)[..., 0]


def _times(vectors: Array, matrices: Array) -> Array:
    """A row vector for every cell times a matrix for every cell: (cells, p), (cells, p, r) → (cells, r)."""
    return (vectors[:, None, :] @ matrices)[:, 0]
