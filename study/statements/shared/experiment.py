"""The semi-discrete problem of an exact solution on one mesh, with a time scheme and the norm of the error."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from manufactured.exact import ExactSolution
from study.fem.error_norm import ErrorNorm, gaps_at_vertices
from study.fem.mesh import MeshFamily
from study.fem.naming import family_named, resolve
from study.fem.space import Space
from study.solve.evolution import Scheme, SemiDiscrete, State
from study.solve.tableau import Tableau
from study.statements.shared.base import Setting


@dataclass(frozen=True, eq=False)
class Experiment:
    """The semi-discrete problem (Problem 5.1) whose exact solution is known, on one mesh, with a time scheme.

    Deliberate faults replace one attribute by a wrong value.

    Attributes:
        solution: the exact solution. The data follow from it, and computed displacements are compared with it.
        space: the P1 displacement space V^h.
        v_norm: computes the load and the errors in the norm of V.
        problem: the semi-discrete problem that is solved.
        scheme, steps: time scheme and number of time steps.
        solved: the problem that is solved; None stands for ``problem``. A deliberate fault sets it, so that errors are
            still measured in the norm of ``problem``.
    """

    solution: ExactSolution
    space: Space
    v_norm: ErrorNorm
    problem: SemiDiscrete
    scheme: Scheme
    steps: int
    solved: SemiDiscrete | None = None

    def march(self, steps: int) -> Iterator[State]:
        """Solve the problem with time steps of length T/steps, and yield the states at the time nodes."""
        return self.scheme.march(self.solved or self.problem, steps)

    @classmethod
    def of(cls, solution: ExactSolution, family: MeshFamily, level: int, scheme: Tableau, steps: int) -> Experiment:
        """Return the discretisation of the paper for an exact solution.

        It starts from the nodal interpolant u_0^h = Π^h u_0, imposes the contact constraint at the vertices of Γ3
        (K^h = V^h ∩ K), and has the load (3.7). If the solution has an initial gap, the constraint includes it; the
        paper has no initial gap.
        """
        space = Space(family(solution.body, level), solution.body)
        v_norm = ErrorNorm(solution, space)
        u0 = v_norm.sample(0.0).interpolant
        problem = SemiDiscrete.of(space, solution.law, v_norm.load, u0, gaps_at_vertices(solution, space))
        return cls(solution, space, v_norm, problem, scheme, steps)

    @classmethod
    def at(cls, setting: Setting, scheme: Tableau, steps: int) -> Experiment:
        """Return the discretisation of the paper for the case and the mesh of a setting."""
        return cls.of(resolve(setting.case).solution, family_named(setting.family), setting.level, scheme, steps)
