"""Static linear elasticity: lower and upper bounds of the error of u_h in the energy norm ‖v‖² = (Gε(v), ε(v))_Q.

Let ũ ∈ K be any displacement that does not penetrate the foundation. Let the stress σ̃ balance the projected loads f̃,
with σ̃_τ = 0 (no friction) and σ̃_ν ≤ 0 (no pulling) on Γ3. Testing as in ``study.bound.terms`` gives for the error
e = u − ũ

    ‖e‖² ≤ R ‖e‖ + c,    R = (Σ_T (‖σ̃ − Gε(ũ)‖_{G⁻¹,T} + η_T)²)^½ + remainder of the data,   c = ∫_{Γ3} σ̃_ν ũ_ν,

where η_T bounds the loads that the projection leaves out on a cell T. So ‖e‖ ≤ y = R/2 + (R²/4 + c)^½. This is the
bound of Prager and Synge with contact. Without a contact side c is 0, and the bound is y = R, as in textbooks.

**Rollers and prescribed displacements.** On rollers, for example lines of symmetry, e_ν = 0 and σ̃_τ = 0, so that the
rollers add nothing to the work of σ̃ on e. If a displacement is prescribed, u and ũ have the same values on Γ1 (and the
same normal components on rollers), so e vanishes there and the proof is unchanged. ũ has these values exactly, because
they are linear on each side. Rigid motions are excluded by ``Body``, and the constants of ``study.bound.problem`` are
computed with the same boundary conditions, τ_τ = 0 on rollers. The topology of the body is used nowhere, so holes
change nothing: σ̃ is found by its tractions and not by a stress function.

**The energy ‖u‖².** Without contact, and with nothing prescribed, (u, ũ) = f(ũ) in the energy inner product. So
‖u‖² = ‖ũ‖² + 2 (e, ũ) + ‖e‖² = 2 f(ũ) − ‖ũ‖² + ‖e‖². The work f̃(ũ) of the projected loads differs from f(ũ) by the
samples only, because ũ is of degree 2 and f − P f is orthogonal to such functions. If δ bounds the dual norm of the
loads minus their samples,

    2 f̃(ũ) − ‖ũ‖² − 2 δ ‖ũ‖ ≤ ‖u‖² ≤ 2 f̃(ũ) − ‖ũ‖² + y² + 2 δ ‖ũ‖.

If ũ is the Galerkin solution, f̃(ũ) = ‖ũ‖². With contact or prescribed displacements, ‖ũ‖ − y ≤ ‖u‖ ≤ ‖ũ‖ + y is used.

With ũ = u_h this is an upper bound of the error of u_h. With a displacement ũ of degree 2 on a refined mesh and
d = ‖ũ − u_h‖ it gives both ends, d − y ≤ ‖u − u_h‖ ≤ d + y.

Source: W. Prager, J. L. Synge, Approximations in elasticity based on the concept of function space, Quart. Appl. Math.
5 (1947) 241–269.
"""

import math
from functools import cached_property

import numpy as np

from manufactured.body import Kind
from manufactured.tensors import Array, Tensors
from study.bound.discretisation import Discretisation
from study.bound.enclosing import POOR, Enclosure
from study.bound.problem import SMALLEST, BoundError, require_visible
from study.bound.remainders import Evidence, proportional
from study.bound.terms import Shares
from study.bound.trajectory import Computed, on_refinement, prolongation
from study.fem.space import Space, form
from study.solve.multigrid import contact_solver
from study.solve.signorini import Signorini

ENERGY_ROUNDING = 1e-11
"""Relative rounding error of ‖ũ‖² for which the interval of the energy ‖u‖² is widened."""


class StaticDiscretisation(Discretisation):
    """The finite element spaces on one mesh for a static problem; stresses are measured in the norm of G⁻¹."""

    @cached_property
    def compliance(self) -> Array:
        return np.asarray(np.linalg.inv(self.data.law.A.matrix))

    def strain(self, v: Array) -> Tensors:
        """Return the strain at the quadrature points, with prescribed displacements, (dofs,) → (3, cells, Q)."""
        return self.displacements.strain_at(v, np.arange(self.stresses.cells), self.stresses.points)

    def products(self, *displacements: Array) -> Array:
        """Return the products (Gε(v_i), ε(v_j))_Q of displacements, which include the prescribed displacement."""
        stresses, strains = zip(*((self.elastic(v), self.strain(v)) for v in displacements), strict=True)
        return np.einsum("iIcq,jIcq,cq->ij", stresses, strains, self.stresses.weights)

    def residual(self, v: Array) -> Array:
        """Return the load vector minus the work (Gε(v), ε(φ_i))_Q of a displacement, (dofs,) → (dofs,)."""
        V = self.displacements
        strain = V.strain_at(v, np.arange(self.stresses.cells), V.points)
        return np.asarray(self.load(0.0) - V.functional(self.data.law.G.at(V.points)(strain)))

    def squares(self, stress: Array) -> Array:
        """Return the squared norm ‖τ‖²_{G⁻¹} of a stress on every cell, (3, cells, Q) → (cells,)."""
        strain = np.tensordot(self.compliance, stress, axes=1) * self.inverse_viscosity
        return np.asarray(np.einsum("Icq,Icq,cq->c", stress, strain, self.stresses.weights))


def compute_static(coarse: Discretisation) -> Computed:
    """Return the P1 solution u_h of the static problem, stored as a displacement that is constant in time."""
    fine = StaticDiscretisation(coarse.data, coarse.mesh)
    data, space = fine.data, Space(fine.mesh, fine.data.body)
    if not space.dofs:
        raise BoundError("no vertex of the mesh can move: take a finer level")
    lifting = on_refinement(space.mesh, 1, fine.mesh) @ space.prescribed
    load = prolongation(space, fine).T @ fine.residual(lifting[fine.displacements.free])
    u, _ = contact_solver(space)(form(space, data.law.A), space.N)(load)
    nodes = space.coefficients(u).ravel()
    return Computed(space.mesh, data.body, 1, np.array([0.0, data.body.T]), np.array([nodes, nodes]), 1)


def enclose_static(coarse: Discretisation, computed: Computed, refinements: int | None) -> tuple[Enclosure, Shares]:
    """Return lower and upper bounds of the error of a static displacement u_h, and the contributions of the cells.

    Args:
        coarse: the problem and the mesh of u_h.
        computed: the displacement u_h.
        refinements: how often the mesh is refined to compute the more accurate displacement ũ of degree 2. If None,
            ũ = u_h is used.

    Returns:
        The bounds, as an enclosure at one time, and how much each cell contributes to the bound of ‖u − ũ‖.
    """
    fine = StaticDiscretisation(coarse.data, coarse.mesh.refined(refinements or 0))
    u_h = computed.on(fine)(0.0)
    v = u_h
    if refinements is not None:
        V = fine.displacements
        v, _ = Signorini(fine.M, V.N, V.free_points)(fine.residual(np.zeros(V.dofs)))
    # The bound y of ‖u − ũ‖, from the stress σ̃, and the contributions of the cells to y.
    snapshot, sampling, T = fine.snapshot(0.0), fine.sampling, fine.data.body.T
    missed = sampling.missed(fine.oscillation, 0.0, T)
    stress = fine.nearest_stress(snapshot.loads, fine.elastic(v), v)
    work = np.maximum(-fine.equilibrium.pressure(stress) * fine.normal_moments(v), 0.0).sum(axis=1)
    squares = (np.sqrt(fine.squares(stress.values)) + fine.oscillation(snapshot.left_out) + missed.cells) ** 2
    R, c = math.sqrt(squares.sum()) + missed.everywhere, float(work.sum())
    y = R / 2 + math.sqrt(R**2 / 4 + c)
    cells = proportional(squares) + missed.in_cells
    np.add.at(cells, fine.cells_at_contact, (y - R) * work / max(c, np.finfo(float).tiny))
    shares = Shares(cells, 0.0).scaled_to(y)
    evidence = Evidence(sampling.reasons, sampling.worst(0.0, T) if missed.everywhere > POOR * y else "")
    # Both ends for ‖u − u_h‖.
    d, products = float(fine.norm(v - u_h)), fine.products(v, u_h)
    size = math.sqrt(products[0, 0])
    require_visible(d + y, bool(fine.load(0.0).any() or computed.nodes.any()))
    y = max(y, SMALLEST) if y > 0 else y
    norm = max(0.0, size - y), size + y
    if not (fine.data.body.of(Kind.CONTACT) or fine.data.body.is_moved):
        rest = (2 * missed.everywhere + ENERGY_ROUNDING * size) * size
        energy = 2 * float(fine.load(0.0) @ v) - size**2
        norm = math.sqrt(max(0.0, energy - rest)), math.sqrt(energy + y**2 + rest)
    distances = fine.squares(fine.elastic(v) - fine.elastic(u_h))
    # A refinement lists the parts of all cells in the order of the cells, again and again.
    on_cells = distances.reshape(-1, coarse.mesh.t.shape[1]).sum(axis=0)
    found = Enclosure(
        h=computed.h,
        times=np.zeros(1),
        distance=np.array([d]),
        bound=np.array([y]),
        error=np.array([math.nan]),
        intervals=(),
        start=d + y,
        initial=np.zeros(fine.stresses.cells),
        between=np.array([d + y]),
        evidence=evidence,
        norm=norm,
        products=products,
        on_cells=on_cells,
    )
    return found, shares
