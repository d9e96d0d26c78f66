"""Distances to the exact solution in the norm of V, and the exact stress as a functional on V^h.

The strain of a P1 function is constant on every cell, so with the cell means ε̄ of the exact strain

    ‖u(t) − v‖_V² = Σ_T ∫_T A(ε(u) − ε̄)·(ε(u) − ε̄) + Σ_T |T| A(ε̄ − ε(v))·(ε̄ − ε(v)).

The first sum does not see v: it is evaluated once per time, and is a lower bound for every v ∈ V^h.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from manufactured.body import Kind
from manufactured.exact import ExactSolution
from manufactured.tensors import Array, Tensors, full
from study.fem.quadrature import Line, cell_rules, facet_rule
from study.fem.space import Space


DEGREE = 4
"""Degree of the standard cell rule: exact for the square of a linear strain error, and two more for
kinks that cross a cell. Every row of a rate table records what a rule raised by two would change."""


@dataclass(frozen=True, eq=False)
class Sample:
    """The exact solution at one time, as far as V^h can tell.

    Attributes:
        time: t.
        means: cell means of ε(u(t)), (D, cells).
        oscillation: Σ_T ∫_T A(ε(u) − ε̄)·(ε(u) − ε̄).
        interpolant: Π^h u(t), (n_dofs,).
    """

    time: float
    means: Tensors
    oscillation: float
    interpolant: Array


class Gauge:
    """Measures functions of V^h against an exact solution.

    Args:
        solution: the exact solution.
        space: V^h.
        raised: added to the degree of the rule on uncut cells.
    """

    def __init__(self, solution: ExactSolution, space: Space, raised: int = 0) -> None:
        self.solution, self.space = solution, space
        self.A = solution.law.A
        self.degree = DEGREE + raised
        rules = cell_rules(space.mesh, self.degree, rough_lines(solution))
        self._blocks = [(rule.cells, rule.weights, solution.at(rule.points)) for rule in rules]
        self._nodes = solution.at(space.mesh.p)
        self._faces = []
        for face in solution.faces:
            facets = space.facets(face.part)
            rule = facet_rule(space.mesh, facets, face.part, face.rough)
            self._faces.append((face, solution.on(face, rule.s), rule))

    def sample(self, time: float) -> Sample:
        """Means, oscillation and interpolant of u(t)."""
        means = np.empty((self.A.matrix.shape[0], len(self.space.volumes)))
        oscillation = 0.0
        for cells, weights, fields in self._blocks:
            strain = fields.strain(time)
            mean = np.einsum("Inq,nq->In", strain, weights) / self.space.volumes[cells]
            means[:, cells] = mean
            deviation = strain - mean[..., None]
            oscillation += float(np.einsum("Inq,Inq,nq->", self.A(deviation), deviation, weights, optimize=["einsum_path", (0, 1), (0, 1)]))
        return Sample(time, means, oscillation, self.space.interpolate(self._nodes.displacement(time)))

    def distance(self, sample: Sample, v: Array) -> float:
        """‖u(t) − v‖_V for v ∈ V^h."""
        difference = sample.means - self.space.strain(v)
        between = float(np.einsum("Ic,Ic,c->", self.A(difference), difference, self.space.volumes))
        return float(np.sqrt(sample.oscillation + between))

    def load(self, time: float) -> Array:
        """(f(t), v)_V = (σ(t), ε(v))_Q − ∫_{Γ3} σ_ν v_ν for v ∈ V^h, (n_dofs,).

        Green's formula (2.14) with (2.2), (2.4) and σ_τ = 0: no derivative of σ is needed, so this
        serves solutions whose f_0 is not in L² as well.
        """
        stress = np.empty((self.solution.law.A.matrix.shape[0], len(self.space.volumes)))
        for cells, weights, fields in self._blocks:
            stress[:, cells] = np.einsum("Inq,nq->In", fields.stress(time), weights) / self.space.volumes[cells]
        return self.space.functional(stress) + self._contact_work(time)

    def _contact_work(self, time: float) -> Array:
        """∫_{Γ3} p v_ν, (n_dofs,)."""
        nodal = np.zeros_like(self.space.mesh.p)
        for face, fields, rule in self._faces:
            moments = np.einsum("anq,nq->an", rule.shapes, rule.weights * fields.pressure(time))
            for ends, moment in zip(self.space.mesh.facets[:, rule.facets], moments, strict=True):
                np.add.at(nodal, (slice(None), ends), face.part.normal[:, None] * moment)
        return self.space.interpolate(nodal)

    def load_from_forces(self, time: float) -> Array:
        """(f(t), v)_V = (f_0, v)_H + (f_2, v)_{L²(Γ2)}, (3.7), where f_0 exists: a check of ``load``."""
        mesh = self.space.mesh
        nodal = np.zeros_like(mesh.p)
        for rule in cell_rules(mesh, self.degree, rough_lines(self.solution)):
            force = self.solution.at(rule.points).body_force(time) * rule.weights
            corners = mesh.p[:, mesh.t[:, rule.cells]]
            inverse = np.linalg.inv(np.moveaxis(np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=1), 2, 0))
            local = np.einsum("nid,dnq->inq", inverse, rule.points - corners[:, 0][:, :, None])
            shapes = np.concatenate([1 - local.sum(axis=0, keepdims=True), local])
            for vertices, shape in zip(mesh.t[:, rule.cells], shapes, strict=True):
                np.add.at(nodal, (slice(None), vertices), np.einsum("dnq,nq->dn", force, shape))
        for part in self.space.body.of(Kind.LOADED):
            rule = facet_rule(mesh, self.space.facets(part), part, ())
            x = part.point(rule.s)
            load = self.solution.at(x).surface_load(part, time) * rule.weights
            for ends, shape in zip(mesh.facets[:, rule.facets], rule.shapes, strict=True):
                np.add.at(nodal, (slice(None), ends), np.einsum("dnq,nq->dn", load, shape))
        return self.space.interpolate(nodal)

    @cached_property
    def _centres(self) -> tuple[Array, object]:
        corners = self.space.mesh.p[:, self.space.mesh.t]
        return corners, self.solution.at(corners.mean(axis=1))

    def predicted_interpolation(self, time: float) -> float:
        """‖u − Π^h u‖_V to leading order, from second derivatives of u at the centres of the cells.

        On a cell the interpolation error of a quadratic with Hessian H is −½ Σ_{i<j} λ_i λ_j l_ijᵀ H
        l_ij, l_ij the edge from vertex i to j (as in J. R. Shewchuk, What is a good linear finite
        element?, 2002), so its gradient is linear and its energy exact by the edge-midpoint rule.
        Nothing here passes through the quadrature or the norm of the measured errors.
        """
        corners, fields = self._centres
        gradient = np.stack([full(g) for g in np.moveaxis(fields.strain_gradient(time), 1, 0)], axis=2)  # type: ignore[attr-defined]
        # u_k,ij = ε_ki,j + ε_kj,i − ε_ij,k, with gradient[i, j, k] = ε_ij,k.
        hessian = np.einsum("kijc->kijc", gradient) + np.einsum("kjic->kijc", gradient) - np.einsum("ijkc->kijc", gradient)
        edges = {(i, j): corners[:, j] - corners[:, i] for i, j in ((0, 1), (0, 2), (1, 2))}
        jump = {e: np.einsum("ic,kijc,jc->kc", l, hessian, l) / 2 for e, l in edges.items()}
        sides = np.moveaxis(np.stack([edges[0, 1], edges[0, 2]], axis=1), 2, 0)
        inverse = np.linalg.inv(sides)
        slopes = np.stack([-inverse.sum(axis=1), inverse[:, 0], inverse[:, 1]])
        total = 0.0
        for barycentric in ((0.5, 0.5, 0.0), (0.5, 0.0, 0.5), (0.0, 0.5, 0.5)):
            grad = -sum(
                np.einsum("kc,cd->kdc", d, barycentric[i] * slopes[j] + barycentric[j] * slopes[i])
                for (i, j), d in jump.items()
            )
            strain = (grad + np.swapaxes(grad, 0, 1)) / 2
            matrix = np.tensordot(_full_tensor(self.solution.law.A.matrix), strain, axes=2)
            total += float(np.einsum("ijc,ijc,c->", matrix, strain, self.space.volumes)) / 3
        return float(np.sqrt(total))


def rough_lines(solution: ExactSolution) -> tuple[Line, ...]:
    """Where the strains are rough for all times: {s = c} for every c ∈ ``rough`` of every face."""
    return tuple(
        Line(tuple(face.part.tangent), float(face.part.tangent @ face.part.start) + c)
        for face in solution.faces
        for c in face.rough
    )


def _full_tensor(matrix: Array) -> Array:
    """The fourth-order tensor C_ijkl behind a Mandel matrix, (d, d, d, d)."""
    return np.moveaxis(full(np.moveaxis(full(matrix), 2, 0)), (2, 3), (0, 1))
