"""What one row of a rate table is measured with: Problem 5.1 of an exact solution on one mesh."""

from __future__ import annotations

from dataclasses import dataclass

from manufactured.exact import ExactSolution
from study.fem.gauge import Gauge
from study.fem.mesh import MeshFamily
from study.fem.naming import family_named, resolve
from study.fem.space import Space
from study.solve.evolution import Scheme, SemiDiscrete
from study.solve.tableau import Tableau
from study.statements.shared.base import Setting


@dataclass(frozen=True, eq=False)
class Experiment:
    """Everything one row is measured with. Controls replace single pieces by wrong ones.

    Attributes:
        solution: the exact solution that gives the data and the reference.
        space: V^h.
        gauge: what errors are measured with.
        problem: Problem 5.1 as it is solved.
        scheme, steps: time scheme and number of steps of size k.
    """

    solution: ExactSolution
    space: Space
    gauge: Gauge
    problem: SemiDiscrete
    scheme: Scheme
    steps: int

    @classmethod
    def of(cls, solution: ExactSolution, family: MeshFamily, level: int, scheme: Tableau, steps: int) -> Experiment:
        """The experiment as the source has it: u_0^h = Π^h u_0, K^h = V^h ∩ K, the load of (3.7)."""
        space = Space(family(solution.body, level), solution.body)
        gauge = Gauge(solution, space)
        u0 = gauge.sample(0.0).interpolant
        return cls(solution, space, gauge, SemiDiscrete.of(space, solution.law, gauge.load, u0), scheme, steps)

    @classmethod
    def at(cls, setting: Setting, scheme: Tableau, steps: int) -> Experiment:
        """The experiment on a case by its name."""
        return cls.of(resolve(setting.case).solution, family_named(setting.family), setting.level, scheme, steps)
