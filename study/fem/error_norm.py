"""Error of a function of V^h in the energy norm, and the exact stress as a functional on V^h.

The strain of a P1 function is constant on every cell, so with the cell means ε̄ of the exact strain

    ‖u(t) − v‖_V² = ∫ Aε(u)·ε(u) − Σ_T |T| Aε̄·ε̄ + Σ_T |T| A(ε̄ − ε(v))·(ε̄ − ε(v)).

The difference of the first two terms, the oscillation, does not depend on v. It is evaluated once per time and is a
lower bound for every v ∈ V^h. Cancellation makes its relative accuracy ε_machine/h², which is 1e-10 at h = 1e-3.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from skfem import Mesh

from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.tensors import Array, Tensors, dyad, mapped
from study.fem.moments import Amplitudes, QuadraturePoints, StrainEnergy, StressSums, amplitudes_of
from study.fem.quadrature import CellRule, Line, cell_rules, facet_rule
from study.fem.space import Space

DEGREE, SOLID_DEGREE = 4, 2
"""Degrees of the standard cell rule in 2D and in 3D. In 2D the degree is two more than the square of a linear strain
error needs, because kinks may cross cells and points that share coordinates lower the degree. In 3D the evaluation of
exact fields dominates the cost. Every row of a rate table records the effect of raising the degree by two."""
FACET_POINTS, SOLID_FACET_POINTS = 8, 4
"""Gauss points on a contact facet: in 2D on each side of a point of low regularity, in 3D per direction."""
PARALLEL = 0.1
"""Sine of the angle below which two lines are too close to parallel for points to share coordinates along both."""


class NormError(ArithmeticError):
    """Raised if the norm of an error is not a finite number."""


@dataclass(frozen=True, eq=False)
class ExactAtTime:
    """Data of the exact solution at one time from which distances to functions of V^h are computed.

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


class ErrorNorm:
    """Computes the error of functions of V^h with respect to an exact solution.

    If A varies within a cell, ε̄ is the mean of the exact strain weighted by the factor of A.

    Args:
        raised: added to the degree of the cell rules and to the number of points of the facet rules.
        along: lines to which many quadrature points have the same distance (``study.fem.quadrature``), which makes
            formulas cheap but lowers the degree of rules; by default ``shared_lines``, () for the standard rules.
    """

    def __init__(
        self, solution: ExactSolution, space: Space, raised: int = 0, along: Sequence[Line] | None = None
    ) -> None:
        self.solution, self.space, self.A = solution, space, solution.law.A
        degree, count = (DEGREE, FACET_POINTS) if space.dim == 2 else (SOLID_DEGREE, SOLID_FACET_POINTS)
        self.degree = degree + raised
        lines = shared_lines(solution) if along is None else along
        cells = QuadraturePoints.on_cells(rules(solution, space.mesh, self.degree, lines))
        faces = []
        for face in solution.faces:
            rule = facet_rule(space.mesh, space.facets(face.part), face.part, face.rough, count + raised)
            faces.append(QuadraturePoints.on_facets(rule, face.part, space.mesh))
        # Points in cells and on facets are evaluated together, so that common parts of formulas are computed once.
        points = [cells, *(found for found, _ in faces)]
        modes = solution.at(np.concatenate([found.x for found in points], axis=1)).modes()
        self._amplitudes = amplitudes_of(modes)
        ends = np.cumsum([0, *(len(found.weights) for found in points)])
        split = [[part.among(first, stop) for part in modes] for first, stop in pairwise(ends)]
        self._cells, *on_faces = (StressSums(solution.law, *both) for both in zip(split, points, strict=True))
        on = [(face.part, vertices) for face, (_, vertices) in zip(solution.faces, faces, strict=True)]
        self._faces = [(part.normal, sums) for (part, _), sums in zip(on, on_faces, strict=True)]
        self._normal = space.normal_components(on)
        self._energy = StrainEnergy(split[0], cells.weights * self.A.factor(cells.x), self.A.matrix)
        self._nodes = solution.at(space.mesh.p)

    def means(self, time: float) -> Tensors:
        """Return the cell means of ε(u(t)), (D, cells)."""
        return self._cells.strains(self._amplitudes(time, False)) / self._cells.viscous

    def sample(self, time: float) -> ExactAtTime:
        """Return the cell means, oscillation and interpolant of u(t)."""
        means = self.means(time)
        # For a strain that is constant on every cell the oscillation is round-off, which may be negative.
        oscillation = max(self._energy(self._amplitudes(time, False)) - self._constant_energy(means), 0.0)
        interpolant = self.space.interpolate(self._nodes.displacement(time))
        return ExactAtTime(time, means, oscillation, interpolant)

    def _constant_energy(self, strain: Tensors) -> float:
        """Return the energy ∫ A ε·ε of a strain that is constant on every cell, (D, cells)."""
        return float(self._cells.viscous @ np.einsum("Ic,Ic->c", mapped(self.A.matrix, strain), strain))

    def distance(self, sample: ExactAtTime, v: Array) -> float:
        """Return the distance ‖u(t) − v‖_V for v ∈ V^h.

        Raises:
            NormError: the norm is not a finite number; a later maximum over time could hide this.
        """
        found = float(np.sqrt(sample.oscillation + self._constant_energy(sample.means - self.space.strain(v))))
        if not math.isfinite(found):
            raise NormError(
                f"‖u(t) − v‖_V is {found} at t = {sample.time:.6g}: a value of u or v is not finite, or its square "
                "overflows; use units in which displacements have moderate size"
            )
        return found

    def load(self, time: float) -> Array:
        """Return the load (f(t), v)_V = (σ(t), ε(v))_Q − ∫_{Γ3} σ_ν v_ν for v ∈ V^h, (n_dofs,).

        This is Green's formula (2.14) with (2.2), (2.4) and σ_τ = 0. It needs no derivative of σ, so it also holds for
        solutions whose f_0 is not in L².
        """
        strains, rates = self._amplitudes(time, False), self._amplitudes(time, True)
        return self.space.tested(self._cells(strains, rates)) + self._contact_work(strains, rates)

    def _contact_work(self, strains: Amplitudes, rates: Amplitudes) -> Array:
        """Return ∫_{Γ3} p v_ν with p = −σ_ν for v ∈ V^h, (n_dofs,)."""
        pressure = [-dyad(normal, normal) @ sums(strains, rates) for normal, sums in self._faces]
        return np.asarray(self._normal.T @ np.concatenate(pressure))


def rules(solution: ExactSolution, mesh: Mesh, degree: int, shared: Sequence[Line] = ()) -> list[CellRule]:
    """Return cell rules that are cut and graded where the strain of a solution is not smooth for all times."""
    return cell_rules(mesh, degree, [Line(*line) for line in solution.rough], solution.singular, shared)


def shared_lines(solution: ExactSolution) -> list[Line]:
    """Return the lines of at most two plane contact faces, along which quadrature points can share coordinates."""
    found: list[Line] = []
    contact = [face for face in solution.faces if isinstance(face, ContactFace)] if solution.body.dim == 2 else []
    for line in (Line(*face.part.line(0.0)) for face in contact):
        parallel = any(abs(np.linalg.det([line.direction, other.direction])) < PARALLEL for other in found)
        if not parallel and len(found) < 2:
            found.append(line)
    return found
