"""Distances to the exact solution in the norm of V, and the exact stress as a functional on V^h.

The strain of a P1 function is constant on every cell, so with the cell means ε̄ of the exact strain

    ‖u(t) − v‖_V² = ∫ Aε(u)·ε(u) − Σ_T |T| Aε̄·ε̄ + Σ_T |T| A(ε̄ − ε(v))·(ε̄ − ε(v)).

The oscillation, which is the difference of the first two terms, does not see v: it is evaluated once per time, and is a
lower bound for every v ∈ V^h. The difference loses digits like ε_machine/h², which is 1e-10 at h = 1e-3.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from skfem import Mesh

from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.law import Linear
from manufactured.tensors import Array, Tensors
from study.fem.line import Line
from study.fem.moments import Amplitudes, CellIntegrals, Energy, Points
from study.fem.quadrature import CellRule, cell_rules, facet_rule
from study.fem.space import Space

DEGREE = 4
"""Degree of the standard cell rule in 2D: exact for the square of a linear strain error, also when its points share
coordinates, and with more points than that needs for kinks that cross a cell. Every row of a rate table records what a
plain rule raised by two would change."""

SOLID_DEGREE = 2
"""The same in 3D, without the two more: evaluation of exact fields is what 3D levels cost."""

PARALLEL = 0.1
"""Sine of the angle below which two directions are too close for points to share coordinates along both."""

FACET_POINTS = 8
"""Gauss points on a contact facet, or on each side of a rough point of it."""


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

    Where A varies within a cell, ε̄ is the mean of the exact strain weighted by A's factor.

    Args:
        solution: the exact solution.
        space: V^h.
        raised: added to the degree of the cell rules and to the points of the facet rules.
        along: lines from which points of many cells have the same distances, which makes formulas cheap and rules exact
            to a lower degree (``study.fem.sharing``); by default those of ``shared_lines``, () for the plain rules.
    """

    def __init__(
        self, solution: ExactSolution, space: Space, raised: int = 0, along: Sequence[Line] | None = None
    ) -> None:
        self.solution, self.space = solution, space
        self.A, self.G = solution.law.A, solution.law.G
        self._response: Callable[[float], Tensors]
        self.degree = (DEGREE if space.dim == 2 else SOLID_DEGREE) + raised
        found = rules(solution, space.mesh, self.degree, shared_lines(solution) if along is None else along)
        points = Points.of(found)
        viscous, elastic = (points.weights * tensor.factor(points.x) for tensor in (self.A, self.G))
        self.viscous = points.totals(viscous)
        modes = solution.at(points.x).modes()
        self._parts = [part.amplitudes for part in modes]
        self._energy = Energy(modes, viscous, self.A.matrix)
        self._strains = CellIntegrals(modes, points, viscous)
        if isinstance(self.G, Linear):
            same = np.array_equal(viscous, elastic)
            integrals = self._strains if same else CellIntegrals(modes, points, elastic)
            self._response = self._linear(self.G, integrals)
        else:
            self._response = Pointwise(solution, found, len(self.viscous))
        self._nodes = solution.at(space.mesh.p)
        self._faces = []
        for face in solution.faces:
            facets = space.facets(face.part)
            rule = facet_rule(space.mesh, facets, face.part, face.rough, FACET_POINTS + raised)
            self._faces.append((face, solution.on(face, rule.s), rule))

    def _amplitudes(self, time: float, rate: bool = False) -> Amplitudes:
        return [amplitudes(time, rate) for amplitudes in self._parts]

    def _linear(self, G: Linear, integrals: CellIntegrals) -> Callable[[float], Tensors]:
        """t ↦ ∫_T G ε(u(t)), (D, cells), for a linear G: G of the integral of the strain."""
        return lambda time: G.matrix @ integrals(self._amplitudes(time))

    def sample(self, time: float) -> Sample:
        """Means, oscillation and interpolant of u(t)."""
        amplitudes = self._amplitudes(time)
        means = self._strains(amplitudes) / self.viscous
        # What rounding leaves of a strain that is constant on every cell may be negative.
        oscillation = max(self._energy(amplitudes) - self._constant_energy(means), 0.0)
        return Sample(time, means, oscillation, self.space.interpolate(self._nodes.displacement(time)))

    def _constant_energy(self, strain: Tensors) -> float:
        """∫ A ε·ε of a strain that is constant on every cell."""
        return float(np.einsum("Ic,Ic,c->", self.A.matrix @ strain, strain, self.viscous))

    def distance(self, sample: Sample, v: Array) -> float:
        """‖u(t) − v‖_V for v ∈ V^h."""
        return float(np.sqrt(sample.oscillation + self._constant_energy(sample.means - self.space.strain(v))))

    def load(self, time: float) -> Array:
        """(f(t), v)_V = (σ(t), ε(v))_Q − ∫_{Γ3} σ_ν v_ν for v ∈ V^h, (n_dofs,).

        Green's formula (2.14) with (2.2), (2.4) and σ_τ = 0: no derivative of σ is needed, so this
        serves solutions whose f_0 is not in L² as well.
        """
        stress = self.A.matrix @ self._strains(self._amplitudes(time, rate=True)) + self._response(time)
        return self.space.functional(stress / self.space.volumes) + self._contact_work(time)

    def _contact_work(self, time: float) -> Array:
        """∫_{Γ3} p v_ν, (n_dofs,)."""
        nodal = np.zeros_like(self.space.mesh.p)
        for face, fields, rule in self._faces:
            moments = np.einsum("anq,nq->an", rule.shapes, rule.weights * fields.pressure(time))
            vertices = self.space.mesh.facets[:, rule.facets]
            nodal += self.space.scatter(vertices, np.multiply.outer(face.part.normal, moments))
        return self.space.interpolate(nodal)


class Pointwise:
    """t ↦ ∫_T G ε(u(t)), (D, cells), for a G that is evaluated at every point."""

    def __init__(self, solution: ExactSolution, rules: Sequence[CellRule], cells: int) -> None:
        self.G, self.cells = solution.law.G, cells
        self._blocks = [
            (rule.cells, rule.weights * self.G.factor(rule.points), solution.at(rule.points)) for rule in rules
        ]

    def __call__(self, time: float) -> Tensors:
        integrals = np.empty((self.G.reference.shape[0], self.cells))
        for cells, weights, fields in self._blocks:
            integrals[:, cells] = np.einsum("Inq,nq->In", self.G(fields.strain(time)), weights)
        return integrals


def rules(solution: ExactSolution, mesh: Mesh, degree: int, shared: Sequence[Line] = ()) -> list[CellRule]:
    """Cell rules that respect where the strain of a solution is rough for all times."""
    return cell_rules(mesh, degree, [Line(*line) for line in solution.rough], solution.singular, shared)


def shared_lines(solution: ExactSolution) -> list[Line]:
    """{s = 0} of at most two contact faces in the plane, so that points of cells can share coordinates along them."""
    found: list[Line] = []
    contact = [face for face in solution.faces if isinstance(face, ContactFace)] if solution.body.dim == 2 else []
    for line in (Line(*face.part.line(0.0)) for face in contact):
        parallel = any(abs(np.linalg.det([line.direction, other.direction])) < PARALLEL for other in found)
        if not parallel and len(found) < 2:
            found.append(line)
    return found
