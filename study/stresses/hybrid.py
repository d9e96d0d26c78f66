"""Stresses in equilibrium computed without displacements: one minimiser of the complementary energy, and Problem 3.2.

**One stress** (``Equilibrium``). Among all composite stresses τ with

    Div τ + P f_0 = 0 in Ω,     τν = P f_2 on Γ2,     τ_τ = 0 and τ_ν ≤ 0 on Γ3,     τ_τ = 0 on rollers

the minimiser of ½ (C⁻¹τ, τ)_Q + (ε*, τ)_Q is computed. The conditions are the strong form of (3.9), with the projection
P of ``study.stresses.loads``. On edges P f_2 and τ_ν are polynomials of degree k. τ_ν ≤ 0 is required of their
Bernstein coefficients (for k = 1: of the values at the ends).

The method is hybridisation. Stresses are discontinuous first, and Lagrange multipliers make the tractions continuous:
the moments m_{e,i} = ∫_e u B_i of a displacement u that is defined on the edges only and vanishes on Γ1. The stresses
are eliminated on every cell. This leaves

    minimise ½ mᵀ S m − gᵀ m   with m_ν ≤ 0 on Γ3,      S = Σ_T R (C⁻¹ on Div τ = 0)⁻¹ Rᵀ,

where R maps the stresses with Div τ = 0 to their tractions. On rollers m_ν = 0. S is symmetric, and positive definite
if meas Γ1 > 0 or rollers exclude rigid motions. This
is the form of one step of Problem 5.1, so the same contact solver is used; its multipliers are the Bernstein
coefficients of the pressure −τ_ν.

**In time** (``StressEvolution``). Backward Euler and BDF2 (``study.solve.tableau``) replace ε̇ by (w ε_n − η_n)/k with
η_n = Σ_{j≥1} w_j ε_{n−j}. The law (2.1) then reads σ_n = C ε_n − (A/k) η_n with C = (w/k) A + G. By (3.12) and (3.15),
σ_n minimises the energy above over Σ^h(t_n) for ε* = C⁻¹ (A/k) η_n. The new strain ε_n = C⁻¹ (σ_n + (A/k) η_n) is
stored at the quadrature points. It need not be the strain of a displacement; by Theorem 4.2 it becomes one in the
limit.

Source of hybridisation: D. N. Arnold, F. Brezzi, Mixed and nonconforming finite element methods: implementation,
postprocessing and error estimates, RAIRO Modél. Math. Anal. Numér. 19 (1985) 7–32.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sps
from skfem import Mesh

from manufactured.body import Kind
from manufactured.data import Data
from manufactured.factor import UNIFORM
from manufactured.law import Linear
from manufactured.tensors import Array, Tensors, mapped
from study.fem.mesh import MeshError, cell_volumes
from study.solve.signorini import Signorini
from study.solve.tableau import Tableau
from study.stresses.loads import Loads, ProjectedLoads
from study.stresses.stress_space import StressSpace


@dataclass(frozen=True, eq=False)
class EquilibratedStress:
    """A stress in equilibrium with the loads, which ``Equilibrium`` computes.

    Several stresses have one more axis, written ``...`` in the shapes. Q is the number of quadrature points in a cell,
    and n the number of Bernstein polynomials B_i on an edge.

    Attributes:
        values: the stress at the quadrature points of the space, (3, ..., cells, Q).
        tractions: the traction σν on the three edges of every cell, as Bernstein coefficients in the axes of the edge
            (``StressSpace.frames``), (..., cells, 3, n, 2).
        moments: the Lagrange multipliers of the continuity of tractions, which are moments m = ∫_e u B_i of a
            displacement u that is defined on the edges only, (..., edges, n, 2).
    """

    values: Tensors
    tractions: Array
    moments: Array


class Equilibrium:
    """Computes the stress τ that balances loads and has the least complementary energy ½ (C⁻¹τ, τ)_Q + (ε*, τ)_Q.

    C is a stiffness tensor and ε* a given strain. Several pairs of ε* and loads can be given at once. They then have
    one more axis, written ``...`` in the shapes.

    Args:
        space: the composite stresses, among which τ is sought.
        compliance: the inverse C⁻¹ in Mandel form, (3, 3), or at the Q quadrature points of every cell, (cells, Q, 3,
            3).
        solver: a function that makes the contact solver from the matrix S, the constraint matrix N and the points of
            the unknowns.

    Raises:
        MeshError: triangles are too thin for double precision.
    """

    def __init__(self, space: StressSpace, compliance: Array, solver: type[Signorini] = Signorini) -> None:
        self.space = space
        # Tensors at points are stored component by component, because ``act`` is then several times faster.
        by_component = np.moveaxis(compliance, (-2, -1), (0, 1)).copy()
        self.compliance = np.moveaxis(by_component, (0, 1), (-2, -1))
        self.contact = space.edges_on(Kind.CONTACT)
        edges = space.mesh.facets.shape[1]
        n = space.degree + 1
        self.total = 2 * n * edges
        # The moments are numbered edge by edge, on an edge by Bernstein polynomial, and for a polynomial by component.
        moments = np.arange(self.total).reshape(edges, n, 2)
        self.numbers = moments[space.edges].reshape(space.cells, -1)
        # On rollers the normal moments are 0 and the tangential ones are free, so that τ_τ = 0.
        rollers = space.edges_on(Kind.ROLLER)
        clamped = space.edges_on(Kind.CLAMPED)
        fixed = np.append(moments[clamped], moments[rollers, :, 0])
        self.free = np.delete(moments, fixed)
        # For the constraints on Γ3: the positions of the normal moments among all unknown moments.
        self._normal = np.searchsorted(self.free, moments[self.contact, :, 0].ravel())
        # With rollers, the edges have different numbers of unknowns.
        every = 1 if rollers.size else 2 * n
        midpoints = space.mesh.p[:, space.mesh.facets].mean(axis=1)
        points = midpoints[:, self.free[::every] // (2 * n)]
        N = sps.csr_array(sps.eye_array(len(self.free), format="csr")[self._normal])
        try:
            self._eliminate_stresses(compliance)
            self.S = self._matrix_of_moments()
            self.solve = solver(self.S, N, points)
        except np.linalg.LinAlgError as error:
            raise MeshError(_too_thin(space.mesh, compliance)) from error

    def _eliminate_stresses(self, compliance: Array) -> None:
        """Compute the matrices that eliminate the stresses with Div τ = 0 on every cell.

        Both matrices return the p coefficients c of a stress with Div τ = 0, followed by its tractions R c. The first
        matrix acts on a functional on these stresses, the second one on moments m, which give the functional Rᵀm.
        """
        stiffness = np.linalg.inv(self.space.gram(compliance))
        cells, p, _ = stiffness.shape
        # The tractions of each basis function, with one row for each component on each side: (cells, 3 sides · n · 2,
        # p).
        R = self.space.tractions.reshape(cells, -1, p)
        self._of_strains = np.concatenate([stiffness, stiffness @ R.swapaxes(1, 2)], axis=2)
        self._of_moments = R @ self._of_strains
        self._tractions = slice(p, None)

    def _matrix_of_moments(self) -> sps.csc_array:
        """Return the matrix S of the problem for the unknown moments."""
        of_cells = self._of_moments[..., self._tractions]
        rows = np.broadcast_to(self.numbers[:, :, None], of_cells.shape)
        places = rows.ravel(), rows.swapaxes(1, 2).ravel()
        full = sps.csc_array((of_cells.ravel(), places), shape=(self.total, self.total))
        S = sps.csc_array(full[self.free][:, self.free])
        return sps.csc_array((S + S.T) / 2)

    def __call__(self, loads: Loads, strain: Tensors) -> EquilibratedStress:
        """Return the stress τ of least complementary energy ½ (C⁻¹τ, τ)_Q + (ε*, τ)_Q that balances the loads.

        Args:
            loads: the projected loads P f_0 and P f_2.
            strain: the strain ε* at the quadrature points, (3, ..., cells, Q).
        """
        values, tractions = self.space.lift(loads.force)
        known, g = self._condensed(loads, tractions, act(self.compliance, values) + strain)
        v, _ = self.solve(g)
        return self._joined(values, tractions, known, v)

    def nearest(self, loads: Loads, target: Tensors, normal: Array) -> EquilibratedStress:
        """Return the stress τ that balances the loads and is nearest to a given stress in the norm of C⁻¹.

        C⁻¹ is the compliance. More precisely, τ minimises ½ ‖τ − target‖² + ∫_{Γ3} τ_ν v for a given function v on the
        contact boundary.

        Args:
            loads: the projected loads P f_0 and P f_2.
            target: the given stress at the quadrature points, (3, ..., cells, Q).
            normal: the moments ∫_e v B_i of v with the n Bernstein polynomials B_i on every edge e of the contact
                boundary Γ3, (..., edges of Γ3, n), all ≤ 0. The edges have the order of the attribute ``contact``.

        Returns:
            The stress τ, except that its ``values`` are the difference τ − target, and its ``moments`` the difference
            of the Lagrange multipliers and ``normal``.
        """
        values, tractions = self.space.lift(loads.force)
        values -= target
        known, g = self._condensed(loads, tractions, act(self.compliance, values))
        shift = np.zeros_like(g)
        several = g.shape[:-1]
        shift[..., self._normal] = normal.reshape(*several, -1)
        v, _ = self.solve(g + shift @ self.S)
        return self._joined(values, tractions, known, v - shift)

    def balance(self, loads: Loads) -> EquilibratedStress:
        """Return the stress with the least norm (C⁻¹τ, τ)_Q that balances loads and has no traction on Γ3, τν = 0.

        C⁻¹ is the compliance, and Γ3 the contact boundary.
        """
        values, tractions = self.space.lift(loads.force)
        known, g = self._condensed(loads, tractions, act(self.compliance, values))
        return self._joined(values, tractions, known, self.solve.factor(g))

    def _condensed(self, loads: Loads, tractions: Array, strain: Tensors) -> tuple[Array, Array]:
        """Eliminate the stresses on every cell (static condensation), which leaves a problem for the moments.

        Args:
            loads: the projected loads.
            tractions: the tractions of a stress τ that is in equilibrium only inside each cell.
            strain: the strain C⁻¹τ + ε* at the quadrature points, (3, ..., cells, Q).

        Returns:
            Two arrays. The first contains, for each cell, the p coefficients of the stress with Div σ = 0 that the
            functional (C⁻¹τ + ε*, ·)_Q represents, followed by the 6 n coefficients of its tractions, (..., cells, p +
            6 n). The second is the right-hand side of the problem for the moments, (..., unknown moments).
        """
        joined = _times(self.space.tested(strain), self._of_strains)
        *several, cells, _ = joined.shape
        of_cells = tractions.reshape(*several, cells, -1) - joined[..., self._tractions]
        numbers = self.numbers.ravel()
        sums = [np.bincount(numbers, each, self.total) for each in of_cells.reshape(-1, numbers.size)]
        of_edges = np.reshape(sums, loads.surface.shape)
        g = (loads.surface - of_edges).reshape(*several, -1)
        return joined, g[..., self.free]

    def _joined(self, values: Tensors, tractions: Array, known: Array, v: Array) -> EquilibratedStress:
        """Return the stress of least energy, from the solution of the problem for the moments.

        Args:
            values, tractions: a stress that is in equilibrium only inside each cell, as in ``EquilibratedStress``.
            known: the first result of ``_condensed``.
            v: the moments, minus the given moments ``normal`` if there are any.
        """
        # The moments of all edges are the unknown ones, and zeros on Γ1.
        several = v.shape[:-1]
        moments = np.zeros((*several, self.total))
        moments[..., self.free] = v
        corrections = _times(moments[..., self.numbers], self._of_moments) - known
        of_tractions = corrections[..., self._tractions].reshape(tractions.shape)
        return EquilibratedStress(
            values + self.space.combined(corrections[..., : self._tractions.start]),
            tractions + of_tractions,
            moments.reshape(*several, -1, self.space.degree + 1, 2),
        )

    def pressure(self, stress: EquilibratedStress) -> Array:
        """Return the contact pressure −τ_ν ≥ 0 of a stress τ on the contact boundary, by Bernstein coefficients.

        Args:
            stress: the stress τ, as this class computes it.

        Returns:
            The n Bernstein coefficients on each of the e edges of the contact boundary, (..., e, n).
        """
        return -self.space.boundary_tractions(self.contact, stress.tractions)[..., 0]


def _too_thin(mesh: Mesh, compliance: Array) -> str:
    """Return the message for a mesh on which stresses cannot be computed, because of thin triangles or a stiff law."""
    corners = mesh.p[:, mesh.t]
    sides = corners - np.roll(corners, 1, axis=1)
    longest = np.linalg.norm(sides, axis=0).max(axis=0)
    ratios = longest**2 / (2 * cell_volumes(mesh))
    centre = corners[:, :, ratios.argmax()].mean(axis=1)
    x = ", ".join(f"{c:.4g}" for c in centre)
    return (
        "the stresses on this mesh cannot be computed in double precision: the triangle near "
        f"x = ({x}) is {ratios.max():.3g} times as long as high, and the law is {np.linalg.cond(compliance).max():.3g} "
        "times as stiff against one strain as against another; triangles may be about 4000 times as long as high, or "
        "500 times for ratios of stiffness of 1000 and more: give a mesh without such thin triangles"
    )


def act(C: Array, strain: Tensors) -> Tensors:
    """Return the stress C ε at points, (3, ...).

    Args:
        C: the tensor in Mandel form at the points, (..., 3, 3), or one tensor for all points, (3, 3).
        strain: the strain ε at the points, (3, ...).
    """
    if C.ndim == 2:
        return mapped(C, strain)
    return np.asarray(np.einsum("...IJ,J...->I...", C, strain))


def _times(vectors: Array, matrices: Array) -> Array:
    """Multiply a row vector by a matrix on every cell: (..., cells, p), (cells, p, r) → (..., cells, r)."""
    *several, cells, p = vectors.shape
    rows = np.moveaxis(vectors.reshape(-1, cells, p), 0, 1)
    products = np.moveaxis(rows @ matrices, 1, 0)
    return products.reshape(*several, cells, -1)


class EquilibriumError(ValueError):
    """Raised if Problem 3.2 cannot be solved on composite stresses for a law or a time scheme."""


@dataclass(frozen=True, eq=False)
class DualState:
    """The solution of Problem 3.2 at one time node t_n.

    Attributes:
        time: the time t_n.
        stress: the computed stress σ_n, in equilibrium with the loads. At t_0 it is NaN, because the schemes define no
            strain rate there.
        strain: the strain ε_n that the law gives, at the Q quadrature points of every cell, (3, cells, Q).
        loads: the projected loads at t_n.
    """

    time: float
    stress: EquilibratedStress
    strain: Tensors
    loads: Loads


def tensor_at(C: Linear, x: Array) -> Array:
    """Return the Mandel matrix of a linear tensor at points, or one matrix for a homogeneous material.

    Args:
        C: the tensor.
        x: the points, (2, ...).

    Returns:
        The matrices, (..., 3, 3); for a homogeneous material one matrix, (3, 3).
    """
    if C.factor is UNIFORM:
        return C.matrix
    # Component by component in memory, for ``act``.
    by_component = np.multiply.outer(C.matrix, C.factor(x))
    return np.moveaxis(by_component, (0, 1), (-2, -1))


@dataclass(frozen=True, eq=False)
class StressEvolution:
    """Problem 3.2, whose unknown is the stress, on composite stresses; ``Tableau.march`` solves it in time.

    Attributes:
        data: the body, the law, the loads and the initial displacement.
        space: the composite stresses.
        solver: the class of the contact solver of one step.
        raised: a number added to the degree of the quadrature rule for the body force f_0.
    """

    data: Data
    space: StressSpace
    solver: type[Signorini] = Signorini
    raised: int = 0

    @property
    def T(self) -> float:
        return self.data.body.T

    @cached_property
    def loads(self) -> ProjectedLoads:
        return ProjectedLoads(self.data, self.space, self.raised)

    def initial(self) -> DualState:
        """Return the state at t_0 with the strain ε(u_0) of the initial displacement; its stress is NaN."""
        space = self.space
        strain = self.data.initial(space.points)
        edges = np.full((len(space.lengths), space.degree + 1, 2), np.nan)
        stress = EquilibratedStress(np.full_like(strain, np.nan), edges[space.edges], edges)
        return DualState(0.0, stress, strain, self.loads(0.0))

    def stepper(self, scheme: Tableau, k: float) -> Callable[[int, Sequence[DualState]], DualState]:
        """Return the function that computes the state at t_n from n and the previous states, the last one at t_{n−1}.

        BDF2 needs two previous states; its first step is made by backward Euler, with a stepper of its own.

        Args:
            scheme: the time scheme, backward Euler or BDF2.
            k: the length of the time steps.

        Raises:
            EquilibriumError: the scheme evaluates G at another time than t_n, or G is not linear.
            StepsError: G is not monotone, and a step of this length may have several solutions.
        """
        law = self.data.law
        points = self.space.points
        if scheme.theta != 1:
            raise EquilibriumError(
                f"{scheme.name} balances forces between time nodes, but Problem 3.2 needs the balance at t_n; take "
                "backward-euler or bdf2"
            )
        if not isinstance(law.G, Linear):
            raise EquilibriumError(
                f"Problem 3.2 on composite stresses needs a linear G, got the law {law.name}; take a linear law, or "
                "the stresses of V^h (study.solve.stress_problem)"
            )
        scheme.require_unique(k, law.growth)
        viscous = tensor_at(law.A, points) / k
        compliance = np.linalg.inv(scheme.newest * viscous + tensor_at(law.G, points))
        equilibrium = Equilibrium(self.space, compliance, self.solver)

        def step(n: int, past: Sequence[DualState]) -> DualState:
            known = scheme.known([state.strain for state in past])
            released = act(equilibrium.compliance, act(viscous, known))
            loads = self.loads(n * k)
            stress = equilibrium(loads, released)
            strain = released + act(equilibrium.compliance, stress.values)
            return DualState(n * k, stress, strain, loads)

        return step
