"""Contact problems with known solutions as plain data, for other people's codes (docs/reference/tasks.md).

A task has two modes:

* "frozen": a static Signorini problem at each time t_n, which any static code can solve, without time steps and without
  an error in time. The elastic operator is G, the initial stress is s_0 = A ε(u̇(t_n)) with the exact velocity, and
  the exact solution is u(t_n). Find u ∈ K^h with

      (G ε(u) + s_0, ε(v − u))_Q ≥ b·(v − u) for all v ∈ K^h,     b·v = (σ(t_n), ε(v))_Q + ∫_{Γ3} p v_ν.

* "march": the steps of the midpoint rule. Each step is the same problem with C = A/k + G/2 for G, and the caller
  computes s_0 = (G/2 − A/k) ε(u_{n−1}).

All data except u and its reference values are scaled by a factor S; the problem is positively homogeneous.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from manufactured.body import Kind
from manufactured.case import Case
from manufactured.law import Indefinite, Linear
from manufactured.tensors import Array, Tensors, traction
from study.fem.error_norm import FACET_POINTS, SOLID_FACET_POINTS, ErrorNorm, gaps_at_vertices, rules, shared_lines
from study.fem.mesh import MeshFamily
from study.fem.moments import Amplitudes, QuadraturePoints, StrainSums, amplitudes_of
from study.fem.quadrature import facet_rule
from study.fem.space import Space, form
from study.ledger.files import UsageError
from study.solve.evolution import SemiDiscrete, State
from study.solve.signorini import ContactSolver
from study.solve.solver_choice import contact_solver
from study.solve.tableau import MIDPOINT
from study.statements.shared.norms import maximum

FROZEN_TIMES = 0.15, 0.55, 0.9
"""Default times of frozen problems as fractions of T. In no case of the catalogue does a quantity jump at one of these
times, and no front is then at a vertex of a grid with n = 2^j."""


@dataclass(frozen=True, eq=False)
class Task:
    """The frozen problems and the trajectory of one case on one mesh.

    Raises:
        UsageError: the law is not linear, so that a matrix of constants does not describe it, or it softens, so that
            static problems with G may have no solution.
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
    def space(self) -> Space:
        return Space(self.family(self.solution.body, self.level), self.solution.body)

    @cached_property
    def v_norm(self) -> ErrorNorm:
        return ErrorNorm(self.solution, self.space)

    @cached_property
    def gap(self) -> Array | float:
        """The initial gap at the vertices of all pieces of Γ3, (m,), or the number 0 if there is none."""
        return gaps_at_vertices(self.solution, self.space)

    @cached_property
    def _rates(self) -> tuple[Callable[[float, bool], Amplitudes], StrainSums]:
        solution, mesh = self.solution, self.space.mesh
        points = QuadraturePoints.on_cells(rules(solution, mesh, self.v_norm.degree, shared_lines(solution)))
        modes = solution.at(points.x).modes()
        return amplitudes_of(modes), StrainSums(modes, points, points.weights * solution.law.A.factor(points.x))

    def initial_stress(self, time: float) -> Tensors:
        """Return the cell means of A ε(u̇), (D, cells)."""
        amplitudes, sums = self._rates
        rates = sums(amplitudes(time, True))
        return np.asarray(self.solution.law.A.matrix @ rates / self.space.volumes)

    @cached_property
    def _solve(self) -> ContactSolver:
        return contact_solver(self.space)(form(self.space, self.solution.law.G), self.space.N, gap=self.gap)

    def static(self, time: float) -> Array:
        """Return the solution in K^h of the frozen problem at t, (dofs,)."""
        return self._solve(self.v_norm.load(time) - self.space.functional(self.initial_stress(time)))[0]

    def error(self, times: Sequence[float]) -> float:
        """Return the largest ‖u(t) − u^h‖_V of the frozen problems at the given fractions of T."""
        frozen = [part * self.solution.body.T for part in times]
        return maximum(self.v_norm.distance(self.v_norm.sample(t), self.static(t)) for t in frozen)

    def march(self, steps: int) -> tuple[SemiDiscrete, Iterator[State]]:
        """Return Problem 5.1 with the initial value Π^h u_0, and the states of the midpoint rule from t = 0 on."""
        start = self.v_norm.sample(0.0).interpolant
        problem = SemiDiscrete.of(self.space, self.solution.law, self.v_norm.load, start, self.gap)
        return problem, MIDPOINT.march(problem, steps)

    def error_of_march(self, steps: int) -> float:
        """Return the largest error ‖u(t_n) − u_n‖_V of the midpoint rule for n ≥ 1."""
        _, states = self.march(steps)
        next(states)
        return maximum(self.v_norm.distance(self.v_norm.sample(state.time), state.u) for state in states)

    def resultants(self, time: float) -> Array:
        """Return the exact contact force on each piece of Γ3, Σ_i ∫ p φ_i over the vertices not on Γ1, (pieces,)."""
        found = []
        for face, (part, vertices) in zip(self.solution.faces, self.space.contact, strict=True):
            points = FACET_POINTS if self.space.dim == 2 else SOLID_FACET_POINTS
            rule = facet_rule(self.space.mesh, self.space.facets(part), part, face.rough, points)
            forces = (rule.shapes * rule.weights * self.solution.on(face, rule.s).pressure(time)).sum(axis=-1)
            found.append(forces[np.isin(self.space.mesh.facets[:, rule.facets], vertices)].sum())
        return np.array(found)

    def pressures(self, time: float) -> list[Array]:
        """Return the exact pressure at the vertices of each piece of Γ3 that are not on Γ1."""
        found = []
        for face, (part, vertices) in zip(self.solution.faces, self.space.contact, strict=True):
            s, _ = part.coordinates(self.space.mesh.p[:, vertices])
            found.append(self.solution.on(face, s).pressure(time))
        return found

    def initial_tractions(self, time: float) -> list[Array]:
        """Return the viscous traction A ε(u̇) ν at the vertices of the facets of each piece of Γ3, (facets, d, d)."""
        return [self._tractions(part, facets, time, total=False) for part, facets in self.space.on(Kind.CONTACT)]

    def loads_on(self, time: float) -> list[Array]:
        """Return f_2 = σν at the vertices of the facets of each part of Γ2, (facets, d, d).

        The load b of a task already contains the work of f_2.
        """
        return [self._tractions(part, facets, time, total=True) for part, facets in self.space.on(Kind.LOADED)]

    def _tractions(self, part: Any, facets: Array, time: float, total: bool) -> Array:
        fields = self.solution.at(self.space.mesh.p[:, self.space.mesh.facets[:, facets]])
        stress = fields.stress(time) if total else fields.law.A(fields.strain_rate(time))
        return np.moveaxis(traction(stress, part.normal), [0, 1, 2], [2, 1, 0])
