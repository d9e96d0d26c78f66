"""The equilibrated stress of least complementary energy in Σ^h(t), by hybridisation.

The minimiser of ½ (C⁻¹τ, τ)_Q + (ε*, τ)_Q over the composite stresses with

    Div τ + P f_0 = 0 in Ω,     τν = P f_2 on Γ2,     τ_τ = 0 and τ_ν ≤ 0 on Γ3

is computed. This is the strong form of (3.9), with the projection P of ``study.stresses.loads``. P f_2 and τ_ν are
polynomials of degree k on edges; τ_ν ≤ 0 is required of the Bernstein coefficients (for k = 1 the values at the ends).
Multipliers make the tractions continuous: the moments m_{e,i} = ∫_e u B_i of a displacement u of the edges, zero on Γ1.
Elimination of the stresses on each cell leaves the problem

    minimise ½ mᵀ S m − gᵀ m   with m_ν ≤ 0 on Γ3,      S = Σ_T R (C⁻¹ on Div τ = 0)⁻¹ Rᵀ,

where R gives the tractions of the stresses with Div τ = 0. S is symmetric positive definite if meas Γ1 > 0. The problem
has the form of one step of Problem 5.1 and is solved by the same contact solver, whose multipliers are the coefficients
of the pressure −τ_ν.

Source of hybridisation: D. N. Arnold, F. Brezzi, Mixed and nonconforming finite element methods: implementation,
postprocessing and error estimates, RAIRO Modél. Math. Anal. Numér. 19 (1985) 7–32.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sps

from manufactured.body import Kind
from manufactured.tensors import Array, Tensors, mapped
from study.solve.signorini import Signorini
from study.stresses.loads import Loads
from study.stresses.stress_space import StressSpace


@dataclass(frozen=True, eq=False)
class EquilibratedStress:
    """One element of Σ^h, or several with one more axis.

    Attributes:
        values: at the quadrature points of the space, (3, ..., cells, Q).
        tractions: σν of the cells on their edges in Bernstein form, in the axes of the edges, (..., cells, 3, n, 2).
        moments: the multipliers m = ∫_e u B_i, (..., edges, n, 2).
    """

    values: Tensors
    tractions: Array
    moments: Array


class Equilibrium:
    """Minimises ½ (C⁻¹τ, τ)_Q + (ε*, τ)_Q over Σ^h, for one pair or several pairs of ε* and loads.

    Several pairs have one axis ``...``; matrices that depend on the mesh are then read only once.

    Args:
        space: the stresses.
        compliance: C⁻¹ in Mandel form, (3, 3), or at the points, (cells, Q, 3, 3).
        solver: function from S, N and the points of the unknowns to the contact solver.
    """

    def __init__(self, space: StressSpace, compliance: Array, solver: type[Signorini] = Signorini) -> None:
        self.space, self.compliance = space, compliance
        stiffness = np.linalg.inv(space.gram(compliance))
        # shape (cells, 3 sides · n · 2, p)
        R = space.tractions.reshape(space.cells, -1, stiffness.shape[-1])
        # Coefficients c and tractions R c of stresses with Div τ = 0, from the right-hand side and from moments m
        # (Rᵀm).
        self._of_strains = np.concatenate([stiffness, stiffness @ R.swapaxes(1, 2)], axis=2)
        self._of_moments = R @ self._of_strains
        self._tractions = slice(stiffness.shape[-1], None)
        self._number()
        local = self._of_moments[..., self._tractions]
        rows = np.broadcast_to(self.numbers[:, :, None], local.shape)
        places = rows.ravel(), rows.swapaxes(1, 2).ravel()
        full = sps.coo_array((local.ravel(), places), shape=(self.total, self.total)).tocsc()
        S = sps.csc_array(full[self.free][:, self.free])
        self.S = sps.csc_array((S + S.T) / 2)
        self._at_contact = sps.csr_array(self.S)[self._normal]
        each = 2 * (space.degree + 1)
        midpoints = space.mesh.p[:, space.mesh.facets].mean(axis=1)
        self.solve = solver(self.S, self.N, midpoints[:, self.free[::each] // each])

    def _number(self) -> None:
        """Number the unknown moments: edge by edge, polynomial by polynomial, two components."""
        space = self.space
        n, edges = space.degree + 1, space.mesh.facets.shape[1]
        self.total = 2 * n * edges
        self.numbers = (2 * n * space.edges[:, :, None] + np.arange(2 * n)).reshape(space.cells, -1)
        free = np.ones((edges, 2 * n), dtype=bool)
        for _, clamped in space.on(Kind.CLAMPED):
            free[clamped] = False
        self.free = np.flatnonzero(free.ravel())
        # The empty array serves bodies without contact.
        self.contact = np.concatenate([np.empty(0, dtype=np.int64), *(mine for _, mine in space.on(Kind.CONTACT))])
        normal = (2 * n * self.contact[:, None] + 2 * np.arange(n)).ravel()
        # Positions of the normal moments on Γ3 among the unknown moments.
        self._normal = np.searchsorted(self.free, normal)
        places = np.arange(len(normal)), self._normal
        self.N = sps.csr_array((np.ones(len(normal)), places), shape=(len(normal), len(self.free)))

    def __call__(self, loads: Loads, strain: Tensors, normal: Array | None = None) -> EquilibratedStress:
        """Return the minimiser.

        Args:
            loads: P f_0 and P f_2.
            strain: ε* at the points, (3, ..., cells, Q).
            normal: the moments ∫_e v B_i ≤ 0 on the edges ``contact`` of a function v, (..., edges of Γ3, n); ∫_{Γ3}
                τ_ν v is then added to the functional.
        """
        values, tractions = self.space.lift(loads.force)
        known = self._released(values) + self.space.tested(strain)
        return self._corrected(loads, values, tractions, known, normal)

    def nearest(self, loads: Loads, target: Tensors, normal: Array) -> EquilibratedStress:
        """Return the minimiser for ε* = −C⁻¹ target, (3, ..., cells, Q); its ``values`` are τ − target."""
        values, tractions = self.space.lift(loads.force)
        values -= target
        return self._corrected(loads, values, tractions, self._released(values), normal)

    def balance(self, loads: Loads) -> EquilibratedStress:
        """Return the stress of least (C⁻¹τ, τ)_Q that balances loads without contact, τν = 0 on Γ3."""
        values, tractions = self.space.lift(loads.force)
        known, g = self._condensed(loads, tractions, self._released(values))
        v = self.solve.factor(g)
        return self._joined(values, tractions, known, v, v)

    def _corrected(
        self, loads: Loads, values: Tensors, tractions: Array, known: Array, normal: Array | None
    ) -> EquilibratedStress:
        """Return the stress that balances all loads, from a stress that is in equilibrium inside each cell only."""
        known, g = self._condensed(loads, tractions, known)
        shift = np.zeros_like(g)
        if normal is not None:
            given = normal.reshape(*g.shape[:-1], -1)
            shift[..., self._normal] = given
            g = g + given @ self._at_contact
        v, _ = self.solve(g)
        return self._joined(values, tractions, known, v, v - shift)

    def _released(self, values: Tensors) -> Array:
        """Return the functional (C⁻¹τ, ·)_Q on the stresses with Div σ = 0, (3, ..., cells, Q) → (..., cells, p)."""
        if self.compliance.ndim == 2:
            return self.space.tested(values, self.compliance)
        return self.space.tested(act(self.compliance, values))

    def _condensed(self, loads: Loads, tractions: Array, known: Array) -> tuple[Array, Array]:
        """Return, by static condensation, the parts of c and R c due to a functional (..., cells, p), and g."""
        joined = _times(known, self._of_strains)
        of_cells = tractions.reshape(*joined.shape[:-1], -1) - joined[..., self._tractions]
        numbers, several = self.numbers.ravel(), of_cells.shape[:-2]
        sums = [np.bincount(numbers, each, self.total) for each in of_cells.reshape(-1, numbers.size)]
        g = loads.surface.reshape(*several, -1) - np.reshape(sums, (*several, -1))
        return joined, g[..., self.free]

    def _joined(self, values: Tensors, tractions: Array, known: Array, v: Array, shifted: Array) -> EquilibratedStress:
        """Return the stress with the multipliers v; ``shifted`` is v minus the given moments."""
        found = _times(self._everywhere(shifted)[..., self.numbers], self._of_moments) - known
        return EquilibratedStress(
            values + self.space.combined(found[..., : self._tractions.start]),
            tractions + found[..., self._tractions].reshape(tractions.shape),
            self._everywhere(v).reshape(*v.shape[:-1], -1, self.space.degree + 1, 2),
        )

    def _everywhere(self, v: Array) -> Array:
        """Return the moments of all edges, zero on Γ1, from the unknown moments, (..., total)."""
        m = np.zeros((*v.shape[:-1], self.total))
        m[..., self.free] = v
        return m

    def pressure(self, stress: EquilibratedStress) -> Array:
        """Return the Bernstein coefficients of −τ_ν ≥ 0 on the edges ``contact``, (..., edges of Γ3, n)."""
        return -self.space.boundary_tractions(self.contact, stress.tractions)[..., 0]


def act(C: Array, strain: Tensors) -> Tensors:
    """Return C ε at points in Mandel form: C is (..., 3, 3), or (3, 3) for all points; (3, ...) → (3, ...)."""
    if C.ndim == 2:
        return mapped(C, strain)
    found: Tensors = np.einsum("...IJ,J...->I...", C, strain)
    return found


def _times(vectors: Array, matrices: Array) -> Array:
    """Multiply a row vector by a matrix for every cell: (..., cells, p), (cells, p, r) → (..., cells, r)."""
    rows = np.moveaxis(vectors.reshape(-1, *vectors.shape[-2:]), 0, 1)
    return np.moveaxis(rows @ matrices, 1, 0).reshape(*vectors.shape[:-1], -1)
