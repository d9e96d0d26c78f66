"""Contact problems with known solutions as plain data, for other people's codes (docs/reference/tasks.md).

A task is such a problem on one mesh. It has two modes:

* "frozen": a static Signorini problem at each time t_n. Any static code can solve it; there are no time steps and no
  error in time. The elastic operator is G, the initial stress is s_0 = A ε(u̇(t_n)) with the exact velocity u̇, and
  the exact solution is u(t_n). The problem is to find u ∈ K^h, the P1 displacements that satisfy the contact constraint
  at the vertices, with

      (G ε(u) + s_0, ε(v − u))_Q ≥ b·(v − u) for all v ∈ K^h,     b·v = (σ(t_n), ε(v))_Q + ∫_{Γ3} p v_ν.

* "march": time stepping by the midpoint rule. Each step is the same problem with A/k + G/2 instead of G. The other
  code computes the initial stress s_0 = (G/2 − A/k) ε(u_{n−1}) from its previous displacement.

All data except the displacements are multiplied by one factor S, which does not change u.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from manufactured.body import Kind
from manufactured.case import Case
from manufactured.law import Indefinite, Linear
from manufactured.tensors import Array, Tensors, traction
from study.fem.error_norm import CELL_DEGREE, FACET_POINTS, SOLID_FACET_POINTS, ErrorNorm
from study.fem.mesh import MeshFamily
from study.fem.space import Space
from study.ledger.files import UsageError
from study.solve.evolution import SemiDiscrete, State
from study.solve.signorini import ContactSolver
from study.solve.tableau import MIDPOINT
from study.statements.shared.base import Experiment
from study.statements.shared.norms import Energies, FacePoints, time_nodes

FROZEN_TIMES = 0.15, 0.55, 0.9
"""Default times at which static problems are taken from a solution in time, as fractions of the final time T.

At these times no quantity jumps in any case of the catalogue, and no contact front is at a vertex of a grid with n =
2^j.
"""


@dataclass(frozen=True, eq=False)
class Task:
    """Contact problems of one case on one mesh, as data for other codes: static problems and one problem in time.

    A static problem is "frozen" at one time: the viscous stress of the exact solution at this time is given as an
    initial stress, so that its solution is the exact displacement at this time.

    Attributes:
        case, family, level: the case, and the mesh family and the level of the mesh.
        solution: the exact solution of the case.
        space: the P1 displacement space V^h on the mesh.
        v_norm: computes the load and the errors in the norm of V.

    Raises:
        UsageError: the law is not linear, so that constants do not describe it; or it softens, so that a static problem
            may have no solution.
    """

    case: Case
    family: MeshFamily
    level: int

    def __post_init__(self) -> None:
        if not isinstance(self.solution.law.G, Linear):
            raise UsageError(
                f"{self.case.name}: a task states the law by constants, but G of {self.solution.law.name} is not "
                "linear; take another case"
            )
        if isinstance(self.solution.law.G, Indefinite):
            raise UsageError(
                f"{self.case.name}: G of {self.solution.law.name} is not positive, a static problem with it need not "
                "have a solution; take another case"
            )

    @property
    def solution(self) -> Any:
        return self.case.solution

    @cached_property
    def experiment(self) -> Experiment:
        """The semi-discrete problem of the case on the mesh, with the midpoint rule."""
        return Experiment.of(self.solution, self.family, self.level, MIDPOINT, self.level)

    @property
    def space(self) -> Space:
        return self.experiment.space

    @property
    def v_norm(self) -> ErrorNorm:
        return self.experiment.v_norm

    @property
    def gap(self) -> Array | float:
        """The initial gap between body and foundation at the contact vertices, (m,), or the number 0 without a gap."""
        return self.experiment.problem.gap

    @cached_property
    def _energies(self) -> Energies:
        return Energies(self.solution, self.space, raised=self.v_norm.degree - CELL_DEGREE)

    def initial_stress(self, time: float) -> Tensors:
        """Return the initial stress of the static problem at one time, (D, cells).

        It consists of the means over cells of the exact viscous stress A ε(u̇).
        """
        exact = self._energies.exact
        return self._energies.integrals(exact.law.A(exact.strain_rate(time))) / self.space.volumes

    @cached_property
    def _solve(self) -> ContactSolver:
        problem = self.experiment.problem
        return problem.contact(problem.reference)

    def static(self, time: float) -> Array:
        """Return the discrete solution of the static problem at one time, (dofs,).

        It is an elastic contact problem, in which the exact viscous stress at this time is the initial stress.
        """
        return self._solve(self.v_norm.load(time) - self.space.functional(self.initial_stress(time)))[0]

    def error(self, times: Sequence[float]) -> float:
        """Return the largest error ‖u(t) − u^h‖_V of the discrete solutions u^h of static problems at several times t.

        Args:
            times: the times as fractions of the final time.
        """
        frozen = [part * self.solution.body.T for part in times]
        return self.v_norm.largest(np.array(frozen), map(self.static, frozen))

    def march(self, steps: int) -> tuple[SemiDiscrete, Iterator[State]]:
        """Return the semi-discrete problem, and its solution by the midpoint rule as an iterator over the time nodes.

        The initial value is the nodal interpolant Π^h u_0, which is also the first state.
        """
        return self.experiment.problem, self.experiment.march(steps)

    def error_of_march(self, steps: int) -> float:
        """Return the largest error ‖u(t_n) − u_n‖_V of the solution u_n by the midpoint rule.

        It is taken over all time nodes t_n after t = 0.
        """
        problem, states = self.march(steps)
        next(states)
        return self.v_norm.largest(time_nodes(problem.T, steps)[1:], (state.u for state in states))

    def resultants(self, time: float) -> Array:
        """Return the exact total contact force on each contact face, (faces,).

        It is Σ_i ∫ p φ_i with the exact pressure p and the hat functions φ_i of the vertices that are not clamped.
        """
        totals = []
        points = FACET_POINTS if self.space.dim == 2 else SOLID_FACET_POINTS
        for face, (_, vertices) in zip(self.solution.faces, self.space.contact, strict=True):
            at = FacePoints(self.solution, self.space, face, points, face.rough)
            totals.append(at.moments(at.exact.pressure(time))[vertices].sum())
        return np.array(totals)

    def pressures(self, time: float) -> list[Array]:
        """Return for each contact face the exact pressure at its vertices that are not clamped, (vertices,)."""
        pressures = []
        for face, (part, vertices) in zip(self.solution.faces, self.space.contact, strict=True):
            s = part.coordinates(self.space.mesh.p[:, vertices])[0]
            pressures.append(self.solution.on(face, s).pressure(time))
        return pressures

    def tractions(self, kind: Kind, time: float) -> list[Array]:
        """Return exact tractions at the facet corners of all boundary parts of a kind.

        They are the viscous traction A ε(u̇) ν on contact faces, and the surface load f_2 = σν on loaded parts. The
        load vector of a task already contains the work of f_2.

        Returns:
            One array for each part: the components of the traction at the corners of each facet, (facets, corners,
            components).
        """
        found = []
        for part, facets in self.space.on(kind):
            fields = self.solution.at(self.space.mesh.p[:, self.space.mesh.facets[:, facets]])
            stress = fields.stress(time) if kind is Kind.LOADED else fields.law.A(fields.strain_rate(time))
            found.append(np.moveaxis(traction(stress, part.normal), [0, 1, 2], [2, 1, 0]))
        return found
