"""Static linear elasticity: lower and upper bounds of the error of u_h in the energy norm ‖v‖² = (Gε(v), ε(v))_Q.

Let ũ ∈ K be any displacement that does not penetrate the foundation. Let the stress σ̃ balance the projected loads f̃,
with σ̃_τ = 0 (no friction) and σ̃_ν ≤ 0 (no pulling) on Γ3. Testing as in ``study.bound.terms`` gives for the error
e = u − ũ

    ‖e‖² ≤ R ‖e‖ + c,    R = (Σ_T (‖σ̃ − Gε(ũ)‖_{G⁻¹,T} + η_T)²)^½ + remainder of the data,   c = ∫_{Γ3} σ̃_ν ũ_ν,

where η_T bounds the loads that the projection leaves out on a cell T. So ‖e‖ ≤ y = R/2 + (R²/4 + c)^½. This is the
bound of Prager and Synge with contact. Without a contact side c is 0, and the bound is y = R, as in textbooks.

With ũ = u_h this is an upper bound of the error of u_h. With a displacement ũ of degree 2 on a refined mesh and
d = ‖ũ − u_h‖ it gives both ends, d − y ≤ ‖u − u_h‖ ≤ d + y.

Source: W. Prager, J. L. Synge, Approximations in elasticity based on the concept of function space, Quart. Appl. Math.
5 (1947) 241–269.
"""

import math
from functools import cached_property

import numpy as np

from manufactured.tensors import Array
from study.bound.discretisation import Discretisation
from study.bound.enclosing import POOR, Enclosure
from study.bound.problem import SMALLEST, require_visible
from study.bound.remainders import Evidence, proportional
from study.bound.terms import Shares
from study.bound.trajectory import Computed, DiscreteSolution, prolongation
from study.fem.space import Space, form
from study.solve.signorini import Signorini
from study.solve.solver_choice import contact_solver


class StaticDiscretisation(Discretisation):
    """The finite element spaces on one mesh for a static problem; stresses are measured in the norm of G⁻¹."""

    @cached_property
    def compliance(self) -> Array:
        return np.asarray(np.linalg.inv(self.data.law.A.matrix))

    def squares(self, stress: Array) -> Array:
        """Return the squared norm ‖τ‖²_{G⁻¹} of a stress on every cell, (3, cells, Q) → (cells,)."""
        strain = np.tensordot(self.compliance, stress, axes=1) * self.inverse_viscosity
        return np.asarray(np.einsum("Icq,Icq,cq->c", stress, strain, self.stresses.weights))


def compute_static(discretisation: Discretisation) -> DiscreteSolution:
    """Return the P1 solution u_h of the static problem, stored as a displacement that is constant in time."""
    data, space = discretisation.data, Space(discretisation.mesh, discretisation.data.body)
    load = prolongation(space, discretisation).T @ discretisation.load(0.0)
    u, _ = contact_solver(space)(form(space, data.law.A), space.N)(load)
    return DiscreteSolution(space, np.array([u, u]), np.array([0.0, data.body.T]), 1)


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
        v, _ = Signorini(fine.M, fine.displacements.N, fine.displacements.free_points)(fine.load(0.0))
    # The bound y of ‖u − ũ‖, from the stress σ̃, and the contributions of the cells to y.
    snapshot, sampling, T = fine.snapshot(0.0), fine.sampling, fine.data.body.T
    missed = sampling.missed(fine.oscillation, 0.0, T)
    stress = fine.nearest_stress(snapshot.loads, fine.elastic(v), v)
    products = np.maximum(-fine.equilibrium.pressure(stress) * fine.normal_moments(v), 0.0).sum(axis=1)
    squares = (np.sqrt(fine.squares(stress.values)) + fine.oscillation(snapshot.left_out) + missed.cells) ** 2
    R, c = math.sqrt(squares.sum()) + missed.everywhere, float(products.sum())
    y = R / 2 + math.sqrt(R**2 / 4 + c)
    cells = proportional(squares) + missed.in_cells
    np.add.at(cells, fine.cells_at_contact, (y - R) * products / max(c, np.finfo(float).tiny))
    shares = Shares(cells, 0.0).scaled_to(y)
    evidence = Evidence(sampling.reasons, sampling.worst(0.0, T) if missed.everywhere > POOR * y else "")
    # Both ends for ‖u − u_h‖.
    d, size = float(fine.norm(v - u_h)), float(fine.norm(v))
    require_visible(fine.data, d + y, bool(fine.load(0.0).any()))
    y, above = max(y, SMALLEST) if y > 0 else y, np.array([d + y])
    cells, zero, unknown = np.zeros(fine.mesh.t.shape[1]), np.zeros(1), np.full(1, math.nan)
    norm = max(0.0, size - y), size + y
    bounds = zero, np.array([d]), np.array([y]), unknown
    found = Enclosure(computed.h, *bounds, (), d + y, cells, above, evidence, norm, fine.products(v, u_h))
    return found, shares
