"""Load vectors and the interpolation error by independent formulas, to check ``study.fem.error_norm.ErrorNorm``.

``ErrorNorm`` integrates the exact strain. The formulas of this module use neither these integrals nor the norm of
``ErrorNorm``.
"""

from itertools import combinations

import numpy as np

from manufactured.body import Kind
from manufactured.exact import ExactSolution
from manufactured.tensors import Array, full, mandel, mapped
from study.fem.error_norm import FACET_POINTS, rules
from study.fem.mesh import barycentric, barycentric_gradients
from study.fem.quadrature import blocks, rule_on
from study.fem.space import Space

LEADING_TERM_STEPS = 32
"""Number of steps of the time grid on which the maximum of the leading term of the interpolation error is searched.

The steepest known maximum is in the case travelling-patch, where the term falls by 15 % within T/16. If the term is a
parabola near its maximum, it falls by 1 % within half a step of the grid.
"""


def load_from_forces(solution: ExactSolution, space: Space, time: float, degree: int) -> Array:
    """Return the load vector of an exact solution, computed from its body force f_0 and traction f_2, (dofs,).

    By (3.7) its entries are (f(t), v)_V = (f_0, v)_H + (f_2, v)_{L²(Γ2)} for the basis functions v. By (2.14) it
    differs only by quadrature errors from ``ErrorNorm.load``, which is computed from the stress.

    Args:
        solution: the exact solution.
        space: the space V^h.
        time: the time t.
        degree: degree of the quadrature rule for f_0.
    """
    mesh = space.mesh
    nodal = np.zeros_like(mesh.p)
    for rule in rules(solution, mesh, degree):
        force = solution.at(rule.points).body_force(time) * rule.weights
        simplices = mesh.t[:, rule.cells]
        values = np.einsum("dnq,inq->din", force, barycentric(mesh.p, simplices, rule.points))
        nodal += space.scatter(simplices, values)
    return space.interpolate(nodal) + work_on(Kind.LOADED, solution, space, time)


def work_on(kind: Kind, solution: ExactSolution, space: Space, time: float) -> Array:
    """Return the load vector ∫ σν·v of the exact traction on all boundary parts of one kind, (dofs,).

    There is one entry for each basis function v. On the loaded boundary Γ2 it is (f_2, v)_{L²(Γ2)}. On the contact
    boundary Γ3 it is ∫ σ_ν v_ν, because σ_τ = 0.

    Args:
        kind: the kind of the boundary parts.
        solution: the exact solution, which gives σν.
        space: the space V^h.
        time: the time.
    """
    nodal = np.zeros_like(space.mesh.p)
    for part in space.body.of(kind):
        rule = rule_on(space, part, FACET_POINTS)
        load = solution.at(part.point(rule.s)).surface_load(part, time) * rule.weights
        values = np.einsum("dnq,anq->dan", load, rule.shapes)
        nodal += space.scatter(space.mesh.facets[:, rule.facets], values)
    return space.interpolate(nodal)


class LeadingTerm:
    """Computes the leading term of the interpolation error ‖u − Π^h u‖_V for h → 0.

    The leading term is the interpolation error of the piecewise quadratic function that has the second derivatives of u
    at the centres of the cells. On a cell T with barycentric coordinates λ_i, the interpolation error of a quadratic
    function with Hessian H is −½ Σ_{i<j} λ_i λ_j l_ijᵀ H l_ij, where l_ij is the edge from vertex i to vertex j. The
    gradient of this error is −Σ_i λ_i V_i with V_i = ½ Σ_{j≠i} (l_ijᵀ H l_ij) ⊗ ∇λ_j. Since ∫_T λ_i λ_j = |T| (1 +
    δ_ij)/((d + 1)(d + 2)), the energy of the error is |T|/((d + 1)(d + 2)) (Σ_i A V_i·V_i + A V·V) for V = Σ_i V_i. The
    material factor of the viscosity A is also evaluated at the centres.

    Args:
        solution: the exact solution u.
        space: the space V^h.

    Source: J. R. Shewchuk, What is a good linear finite element?, 2002, for the error function.
    """

    def __init__(self, solution: ExactSolution, space: Space) -> None:
        d = space.dim
        corners = space.mesh.p[:, space.mesh.t]
        centres = corners.mean(axis=1)
        self.fields = solution.at(centres)
        self.A = solution.law.A.matrix
        self.T = space.body.T
        self.weights = space.volumes * solution.law.A.factor(centres) / ((d + 1) * (d + 2))
        self.squares = {}
        for i, j in combinations(range(d + 1), 2):
            edge = corners[:, j] - corners[:, i]
            self.squares[i, j] = mandel(edge[:, None] * edge)
        slopes = np.moveaxis(barycentric_gradients(space.mesh), 0, -1)
        self.slopes = np.ascontiguousarray(slopes)[..., None]

    def largest(self) -> float:
        """Return the maximum over time of the leading term of ‖u − Π^h u‖_V.

        It is searched at ``LEADING_TERM_STEPS`` + 1 equidistant times in [0, T].
        """
        times = np.linspace(0.0, self.T, LEADING_TERM_STEPS + 1)
        return float(np.concatenate([*map(self, blocks(times, self.slopes.size))]).max())

    def __call__(self, times: Array) -> Array:
        """Return the leading term of the interpolation error at n times, (n,)."""
        strains = self.fields.strain_gradient(times)
        # Second derivatives follow from derivatives of strains: ∂_i ∂_j u_k = ∂_j ε_ki + ∂_i ε_kj − ∂_k ε_ij. Both
        # arrays have the shape (D, d, ...), where the pair (i, j) is stored as a Mandel vector of D components.
        hessian = 2 * mandel(full(strains).swapaxes(1, 2)) - strains
        V = np.zeros((*self.slopes.shape[:2], *hessian.shape[1:]))
        for (i, j), square in self.squares.items():
            bend = np.einsum("Ikcn,Ic->kcn", hessian, square) / 2
            V[i] += bend[:, None] * self.slopes[j]
            V[j] += bend[:, None] * self.slopes[i]
        density = np.zeros(hessian.shape[2:])
        for gradient in (*V, V.sum(axis=0)):
            strain = mandel(gradient)
            density += np.einsum("Icn,Icn->cn", mapped(self.A, strain), strain)
        return np.sqrt(self.weights @ density)
