"""Independent ways to the load and to the interpolation error: checks of what the gauge measures.

Nothing here passes through the quadrature of strains or the norm of the measured errors.
"""

from __future__ import annotations

import numpy as np

from manufactured.body import Kind
from manufactured.exact import ExactSolution
from manufactured.tensors import Array, full, mandel
from study.fem.gauge import FACET_POINTS, rough_lines
from study.fem.quadrature import cell_rules, facet_rule
from study.fem.space import Space

EDGES = ((0, 1), (0, 2), (1, 2))
MIDPOINTS = ((0.5, 0.5, 0.0), (0.5, 0.0, 0.5), (0.0, 0.5, 0.5))
"""Barycentric coordinates of the edge midpoints, whose mean is exact for quadratics."""


def barycentric_gradients(corners: Array) -> Array:
    """∇λ_i on triangles: (d, 3, cells) → (3, cells, d)."""
    sides = np.moveaxis(corners[:, 1:] - corners[:, :1], 2, 0)
    inverse = np.linalg.inv(sides)
    return np.stack([-inverse.sum(axis=1), inverse[:, 0], inverse[:, 1]])


def load_from_forces(solution: ExactSolution, space: Space, time: float, degree: int) -> Array:
    """(f(t), v)_V = (f_0, v)_H + (f_2, v)_{L²(Γ2)}, (3.7), where f_0 exists, (n_dofs,).

    Equal to ``Gauge.load`` up to quadrature by Green's formula (2.14).
    """
    mesh = space.mesh
    nodal = np.zeros_like(mesh.p)
    for rule in cell_rules(mesh, degree, rough_lines(solution)):
        force = solution.at(rule.points).body_force(time) * rule.weights
        corners = mesh.p[:, mesh.t[:, rule.cells]]
        offset = rule.points - corners[:, :1].swapaxes(1, 2)
        shapes = np.einsum("ind,dnq->inq", barycentric_gradients(corners), offset)
        shapes[0] += 1
        nodal += space.scatter(mesh.t[:, rule.cells], np.einsum("dnq,inq->din", force, shapes))
    for part in space.body.of(Kind.LOADED):
        edge = facet_rule(mesh, space.facets(part), part, (), FACET_POINTS)
        load = solution.at(part.point(edge.s)).surface_load(part, time) * edge.weights
        nodal += space.scatter(mesh.facets[:, edge.facets], np.einsum("dnq,anq->dan", load, edge.shapes))
    return space.interpolate(nodal)


def predicted_interpolation(solution: ExactSolution, space: Space, time: float) -> float:
    """‖u − Π^h u‖_V to leading order, from second derivatives of u at the centres of the cells.

    On a cell the interpolation error of a quadratic with Hessian H is −½ Σ_{i<j} λ_i λ_j l_ijᵀ H l_ij,
    l_ij the edge from vertex i to j, so its gradient is linear and its energy exact by the
    edge-midpoint rule.

    Source: J. R. Shewchuk, What is a good linear finite element?, 2002, for the error function.
    """
    corners = space.mesh.p[:, space.mesh.t]
    strains = solution.at(corners.mean(axis=1)).strain_gradient(time)
    gradient = np.stack([full(strains[:, k]) for k in range(space.dim)], axis=2)
    # u_k,ij = ε_ki,j + ε_kj,i − ε_ij,k, with gradient[i, j, k] = ε_ij,k.
    hessian = gradient + gradient.swapaxes(1, 2) - np.moveaxis(gradient, 2, 0)
    edges = [corners[:, j] - corners[:, i] for i, j in EDGES]
    bend = [np.einsum("ic,kijc,jc->kc", edge, hessian, edge) / 2 for edge in edges]
    slopes = barycentric_gradients(corners)
    total = 0.0
    for place in MIDPOINTS:
        error = -sum(
            np.einsum("kc,cd->kdc", b, place[i] * slopes[j] + place[j] * slopes[i])
            for (i, j), b in zip(EDGES, bend, strict=True)
        )
        strain = mandel(error)
        total += float(np.sum(solution.law.A(strain) * strain * space.volumes)) / len(MIDPOINTS)
    return float(np.sqrt(total))
