"""The error ‖u(t) − v‖_V of a displacement v ∈ V^h, and the load vectors of an exact solution u.

The strain of v is constant on every cell T. Let ε̄ be the mean of the exact strain ε(u) on T. Then

    ‖u(t) − v‖_V² = [∫ Aε(u)·ε(u) − Σ_T |T| Aε̄·ε̄] + Σ_T |T| A(ε̄ − ε(v))·(ε̄ − ε(v)).

The bracket is called the oscillation. It does not depend on v, so it is computed once for each time, and its square
root is a lower bound of the error for all v ∈ V^h. It is a difference of nearly equal numbers, which limits its
relative accuracy to about (machine precision)/h², that is 1e-10 at h = 1e-3.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sps
from skfem import Mesh

from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.tensors import Array, Tensors, dyad, mapped
from study.fem.quadrature import (
    CellRule,
    Line,
    QuadraturePoints,
    StrainEnergy,
    StressSums,
    amplitudes_of,
    blocks,
    cell_rules,
    rule_on,
)
from study.fem.space import Space

CELL_DEGREE, SOLID_CELL_DEGREE = 4, 2
"""Degrees of the quadrature rule on cells, in 2D and in 3D.

The square of a linear strain error needs degree 2. In 2D the degree is two higher, because kinks of the strain may
cross cells and because moving the quadrature points (``aligned`` of ``ErrorNorm``) lowers the degree. In 3D the exact
solution dominates the cost, so the degree is not raised. Every row of a rate table states by how much the error changes
if the degree is raised by two.
"""
FACET_POINTS, SOLID_FACET_POINTS = 8, 4
"""Number of Gauss points per direction on a contact facet, in 2D and in 3D.

In 2D a facet is first divided at the points where the strain is not smooth, and each part of the divided facet gets
this number of points.
"""
PARALLEL_FACES = 0.1
"""Two contact faces count as parallel if the sine of the angle between them is below this number.

Quadrature points are then aligned with one of the two faces only.
"""


class NormError(ArithmeticError):
    """Raised if the norm of an error is not a finite number."""


@dataclass(frozen=True, eq=False)
class ExactAtTime:
    """Data of the exact solution u at one time t, from which ``ErrorNorm.distance`` computes the error ‖u(t) − v‖_V.

    Attributes:
        time: the time t.
        means: the mean of the strain ε(u(t)) on every cell T, (D, cells), with the D Mandel components of a tensor.
        oscillation: the energy of the strain minus its cell means ε̄, Σ_T ∫_T A(ε(u) − ε̄)·(ε(u) − ε̄), with the
            viscosity A.
        interpolant: the coefficients of the nodal interpolant Π^h u(t), (dofs,).
    """

    time: float
    means: Tensors
    oscillation: float
    interpolant: Array


class ErrorNorm:
    """Computes the error ‖u(t) − v‖_V of displacements v ∈ V^h, and the load vectors of the exact solution u.

    If the viscosity A varies within a cell, the mean of the strain on the cell is weighted by the factor of A.

    Args:
        solution: the exact solution u.
        space: the space V^h.
        raised: a number added to the degree of the cell rules and to the number of points of the facet rules.
        aligned: whether the quadrature points are moved so that many of them have the same coordinate along a contact
            face (``shared_lines``). The formulas of u are then evaluated less often, but the degree of the rule is
            lower (``study.fem.quadrature.shared``).
    """

    def __init__(self, solution: ExactSolution, space: Space, raised: int = 0, aligned: bool = True) -> None:
        self.solution = solution
        self.space = space
        self.A = solution.law.A
        degree, count = (CELL_DEGREE, FACET_POINTS) if space.dim == 2 else (SOLID_CELL_DEGREE, SOLID_FACET_POINTS)
        self.degree = degree + raised
        cells = QuadraturePoints.on_cells(rules(solution, space.mesh, self.degree, aligned))
        points = [cells]
        on = []
        for face in solution.faces:
            rule = rule_on(space, face.part, count + raised, face.rough)
            of_face, vertices = QuadraturePoints.on_facets(rule, face.part, space.mesh)
            points.append(of_face)
            on.append((face.part, vertices))
        # Points in cells and on facets are evaluated together, so that common parts of formulas are computed once.
        modes = solution.at(np.hstack([group.x for group in points])).modes()
        self._amplitudes = amplitudes_of(modes)
        self._size = sum(len(part.tensors) * part.count for part in modes)
        sums = []
        first = 0
        for group in points:
            stop = first + len(group.weights)
            sums.append(StressSums(solution.law, [part.among(first, stop) for part in modes], group))
            first = stop
        self._cells, *self._faces = sums
        self._normals = [part.normal for part, _ in on]
        self._to_vertices = sps.csr_array(space.normal_components(on).T)
        of_cells = [part.among(0, len(cells.weights)) for part in modes]
        self._energy = StrainEnergy(of_cells, cells.weights * self.A.factor(cells.x), self.A.matrix)
        self._nodes = solution.at(space.mesh.p)

    def sample(self, time: float) -> ExactAtTime:
        """Evaluate the exact solution at a time; the result is an argument of ``distance``."""
        return next(self.samples(time))

    def samples(self, times: Array | float) -> Iterator[ExactAtTime]:
        """Evaluate the exact solution at n times, (n,), and yield for each time what ``distance`` compares with u^h."""
        for block in blocks(times, self._size):
            strains = self._amplitudes(block, False)
            means = self._cells.strains(strains) / self._cells.viscous[:, None]
            # If the strain is constant on every cell, this difference is round-off, which may be negative.
            oscillations = np.maximum(self._energy(strains) - self._constant_energy(means), 0.0)
            interpolants = self.space.interpolate(self._nodes.displacement(block))
            means_by_time = np.moveaxis(means, -1, 0)
            yield from map(ExactAtTime, block.tolist(), means_by_time, oscillations.tolist(), interpolants.T)

    def _constant_energy(self, strain: Tensors) -> Array:
        """Return the energy ∫ A ε·ε of a strain that is constant on every cell, (D, cells), or of n strains, (n,)."""
        return self._cells.viscous @ np.einsum("Ic...,Ic...->c...", mapped(self.A.matrix, strain), strain)

    def distance(self, sample: ExactAtTime, v: Array) -> float:
        """Return the error ‖u(t) − v‖_V of a displacement v at a time t.

        Args:
            sample: the data of the exact solution u at the time t, as ``sample`` returns them.
            v: the coefficients of a displacement in V^h, (dofs,).

        Raises:
            NormError: the norm is not a finite number. A maximum over time could hide a NaN.
        """
        of_means = self._constant_energy(sample.means - self.space.strain(v))
        error = float(np.sqrt(sample.oscillation + of_means))
        if not math.isfinite(error):
            raise NormError(
                f"‖u(t) − v‖_V is {error} at t = {sample.time:.6g}: a value of u or v is not finite, or its square "
                "overflows; use units in which displacements have moderate size"
            )
        return error

    def largest(self, times: Array, displacements: Iterable[Array]) -> float:
        """Return the largest error max_n ‖u(t_n) − v_n‖_V of displacements v_n, (dofs,), at times t_n, (n,)."""
        pairs = zip(self.samples(times), displacements, strict=True)
        return float(np.max([self.distance(sample, v) for sample, v in pairs]))

    def load(self, time: Array | float) -> Array:
        """Return the load vector F of an exact solution, with one entry (f(t), v)_V for each basis function v of V^h.

        The result has the shape (dofs,), or (dofs, n) for n times.

        F is computed from the exact stress σ. By Green's formula (2.14) with (2.2), (2.4) and σ_τ = 0 it is (f, v)_V =
        (σ, ε(v))_Q − ∫_{Γ3} σ_ν v_ν. No derivative of σ is needed, so F can also be computed for solutions whose body
        force is not in L².
        """
        loads = []
        for block in blocks(time, self._size):
            strains = self._amplitudes(block, False)
            rates = self._amplitudes(block, True)
            pressures = []
            for normal, sums in zip(self._normals, self._faces, strict=True):
                stresses = sums(strains, rates)
                pressures.append(mapped(-dyad(normal, normal), stresses))
            work_of_pressure = self._to_vertices @ np.concatenate(pressures)
            loads.append(self.space.tested(self._cells(strains, rates)) + work_of_pressure)
        return np.hstack(loads).reshape(-1, *np.shape(time))


def rules(solution: ExactSolution, mesh: Mesh, degree: int, aligned: bool = False) -> list[CellRule]:
    """Return quadrature rules for all cells, adapted to lines and points at which the exact strain is never smooth.

    Args:
        solution: the exact solution. Cells are cut along the lines ``solution.rough``, and quadrature points are graded
            towards the points ``solution.singular``.
        mesh: the mesh.
        degree: degree of the rule on cells that contain none of these lines and points.
        aligned: whether the quadrature points are aligned with contact faces, as for ``ErrorNorm``.
    """
    along = shared_lines(solution) if aligned else ()
    return cell_rules(mesh, degree, [Line(*line) for line in solution.rough], solution.singular, along)


def shared_lines(solution: ExactSolution) -> list[Line]:
    """Return the lines that are perpendicular to a contact face at its first corner, for at most two faces in 2D.

    The faces are the first ``ContactFace`` of the solution and the next one that is not parallel to it. The distance of
    a point from such a line is the coordinate s of the point along the face. ``ErrorNorm`` aligns quadrature points
    such that few different values of s occur. In 3D, and if no face of the solution is a ``ContactFace``, the list is
    empty.
    """
    lines: list[Line] = []
    for face in solution.faces if solution.body.dim == 2 else ():
        if isinstance(face, ContactFace) and len(lines) < 2:
            line = Line(*face.part.line(0.0))
            sines = [abs(np.linalg.det([line.direction, earlier.direction])) for earlier in lines]
            if min(sines, default=1.0) >= PARALLEL_FACES:
                lines.append(line)
    return lines


def gaps_at_vertices(solution: ExactSolution, space: Space) -> Array | float:
    """Return the initial gap at the contact vertices, in the order of the rows of the constraint matrix, (m,).

    If no contact face has an initial gap, as in the paper, the number 0.0 is returned.
    """
    if not solution.has_initial_gap:
        return 0.0
    gaps = []
    for face, (part, vertices) in zip(solution.faces, space.contact, strict=True):
        s = part.coordinates(space.mesh.p[:, vertices])[0]
        gaps.append(solution.on(face, s).initial_gap() * np.ones(s.shape[1]))
    return np.concatenate(gaps)
