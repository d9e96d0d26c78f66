"""Problem 5.1 of an exact solution on one mesh, with the time scheme and the norm that measures the error."""

from __future__ import annotations

from dataclasses import dataclass

from manufactured.exact import ExactSolution
from study.fem.error_norm import ErrorNorm, gaps_at_vertices
from study.fem.mesh import MeshFamily
from study.fem.naming import family_named, resolve
from study.fem.space import Space
from study.solve.evolution import Scheme, SemiDiscrete
from study.solve.tableau import Tableau
from study.statements.shared.base import Setting


@dataclass(frozen=True, eq=False)
class Experiment:
    """Problem 5.1 of an exact solution on one mesh. Negative controls replace one attribute by a wrong value.

    Attributes:
        solution: the exact solution, which gives the data and with which u^h is compared.
        space: V^h.
        v_norm: computes the load and the errors.
        problem: the semi-discrete problem that is solved.
        scheme, steps: time scheme and number of time steps.
    """

    solution: ExactSolution
    space: Space
    v_norm: ErrorNorm
    problem: SemiDiscrete
    scheme: Scheme
    steps: int

    @classmethod
    def of(cls, solution: ExactSolution, family: MeshFamily, level: int, scheme: Tableau, steps: int) -> Experiment:
        """Return the discretisation of the paper: u_0^h = Π^h u_0, K^h = V^h ∩ K and the load of (3.7).

        K^h includes the initial gap of the solution, which the paper does not have.
        """
        space = Space(family(solution.body, level), solution.body)
        v_norm = ErrorNorm(solution, space)
        u0 = v_norm.sample(0.0).interpolant
        problem = SemiDiscrete.of(space, solution.law, v_norm.load, u0, gaps_at_vertices(solution, space))
        return cls(solution, space, v_norm, problem, scheme, steps)

    @classmethod
    def at(cls, setting: Setting, scheme: Tableau, steps: int) -> Experiment:
        """Return the experiment for the case, the mesh family and the level of a setting."""
        return cls.of(resolve(setting.case).solution, family_named(setting.family), setting.level, scheme, steps)
