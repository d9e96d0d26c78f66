"""Independent ways to the load and to the interpolation error: checks of what the gauge measures.

Nothing here passes through the quadrature of strains or the norm of the measured errors.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from skfem import Mesh

from manufactured.body import Kind
from manufactured.exact import ExactSolution
from manufactured.tensors import Array, Points, full, mandel
from study.fem.gauge import FACET_POINTS, rules
from study.fem.mesh import barycentric_gradients
from study.fem.quadrature import CellRule, facet_rule, simplex_rule
from study.fem.space import Space


def load_from_forces(solution: ExactSolution, space: Space, time: float, degree: int) -> Array:
    """(f(t), v)_V = (f_0, v)_H + (f_2, v)_{L²(Γ2)}, (3.7), where f_0 exists, (n_dofs,).

    Equal to ``Gauge.load`` up to quadrature by Green's formula (2.14).
    """
    return work_of_body_force(solution, space, time, degree) + work_on(Kind.LOADED, solution, space, time)


def work_of_body_force(solution: ExactSolution, space: Space, time: float, degree: int) -> Array:
    """(f_0, v)_H with f_0 = −Div σ, (n_dofs,)."""
    mesh, gradients = space.mesh, barycentric_gradients(space.mesh)
    nodal = np.zeros_like(mesh.p)
    for rule in rules(solution, mesh, degree):
        force = solution.at(rule.points).body_force(time) * rule.weights
        values = np.einsum("dnq,inq->din", force, shapes(mesh, gradients, rule))
        nodal += space.scatter(mesh.t[:, rule.cells], values)
    return space.interpolate(nodal)


def work_on(kind: Kind, solution: ExactSolution, space: Space, time: float) -> Array:
    """∫ σν·v over the parts of one kind, (n_dofs,): (f_2, v)_{L²(Γ2)} on Γ2, ∫ σ_ν v_ν on Γ3."""
    mesh = space.mesh
    nodal = np.zeros_like(mesh.p)
    for part in space.body.of(kind):
        edge = facet_rule(mesh, space.facets(part), part, (), FACET_POINTS)
        load = solution.at(part.point(edge.s)).surface_load(part, time) * edge.weights
        nodal += space.scatter(mesh.facets[:, edge.facets], np.einsum("dnq,anq->dan", load, edge.shapes))
    return space.interpolate(nodal)


def shapes(mesh: Mesh, gradients: Array, rule: CellRule) -> Array:
    """Values of the P1 functions of a cell's vertices, from their gradients, at the points of a rule, (d+1, n, q)."""
    corners = mesh.p[:, mesh.t[:, rule.cells]]
    offset = rule.points - corners[:, :1].swapaxes(1, 2)
    values: Array = np.einsum("nid,dnq->inq", gradients[rule.cells], offset)
    values[0] += 1
    return values


def predicted_interpolation(solution: ExactSolution, space: Space, time: float) -> float:
    """‖u − Π^h u‖_V to leading order, from second derivatives of u at the centres of the cells.

    On a cell the interpolation error of a quadratic with Hessian H is −½ Σ_{i<j} λ_i λ_j l_ijᵀ H l_ij,
    l_ij the edge from vertex i to j, so its gradient is linear and its energy exact by a rule of degree 2.

    Source: J. R. Shewchuk, What is a good linear finite element?, 2002, for the error function.
    """
    corners = space.mesh.p[:, space.mesh.t]
    hessian = _hessian(solution, corners.mean(axis=1), time)
    pairs = list(combinations(range(space.dim + 1), 2))
    edges = [corners[:, j] - corners[:, i] for i, j in pairs]
    bend = [np.einsum("ic,kijc,jc->kc", edge, hessian, edge) / 2 for edge in edges]
    slopes = barycentric_gradients(space.mesh)
    barycentric, weights = simplex_rule(space.dim, 2)
    total = 0.0
    for place, weight in zip(barycentric.T, weights, strict=True):
        error = -np.sum(
            [
                np.einsum("kc,cd->kdc", b, place[i] * slopes[:, j] + place[j] * slopes[:, i])
                for (i, j), b in zip(pairs, bend, strict=True)
            ],
            axis=0,
        )
        strain = mandel(error)
        stress = solution.law.A.at(np.tensordot(corners, place, axes=([1], [0])))(strain)
        total += weight * float(np.sum(stress * strain * space.volumes))
    return float(np.sqrt(total))


def _hessian(solution: ExactSolution, x: Points, time: float) -> Array:
    """∂_i ∂_j u_k = ∂_j ε_ki + ∂_i ε_kj − ∂_k ε_ij, indices (k, i, j), (d, d, d, ...)."""
    strains = solution.at(x).strain_gradient(time)
    gradient = np.stack([full(strains[:, k]) for k in range(len(x))], axis=2)
    return gradient + gradient.swapaxes(1, 2) - np.moveaxis(gradient, 2, 0)
