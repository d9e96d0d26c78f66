"""Whether the comparison of Problems 3.1 and 3.2 would see a mistake that is made on one side only.

Two solutions that agree prove nothing when one was made from the other, or when the comparison is blind. So Problem 3.1
alone is solved wrongly, with the normal flipped, ũ ∈ −K^h, while Problem 3.2 stays as it is, and the gap has to show
the whole of the mistake:

    ‖u(3.2) − ũ(3.1)‖_V / ‖u(3.1) − ũ(3.1)‖_V = 1.

A Problem 3.2 that is fed by the Problem 3.1 beside it goes along, and the ratio is 0; so it is if the gap compares a
solution with itself. A flipped normal matters wherever there is a gap or a pressure, so the ratio is never 0/0.

What this shows is that the comparison is sensitive. It does not show how the stresses are found: where both sides agree
without the mistake, the triangle inequality gives 1 up to their distance, also for a Problem 3.2 that solves a copy of
Problem 3.1 of its own. Against that speaks that stresses are found without a displacement solver in the process
(``tests/controls/test_controls.py``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from manufactured.exact import ExactSolution
from study.fem.material import on_cells
from study.fem.mesh import MeshFamily
from study.fem.naming import family_named, resolve
from study.ledger.measures import every
from study.ledger.window import around
from study.solve.evolution import SemiDiscrete
from study.solve.stress_problem import AIM, StressProblem, StressState
from study.solve.tableau import BACKWARD_EULER
from study.statements.shared.base import ListedNumbers, Setting, grid, with_h
from study.statements.thm_4_2.gaps import gaps, problems

CASES = ("full-contact", "no-contact", "advance-recede", "travelling-patch", "yield-and-release", "yield-on-a-part")
ALONE = around(1, 0.001, "all of it")
"""The ratio is off by at most the distance of both solutions over the mistake; a flip makes one of 0.1 of the solution,
so that distances of 1e-4 of it are seen as well."""


@dataclass(frozen=True, eq=False)
class Sides:
    """The two sides of one check of Theorem 4.2.

    Attributes:
        displacements: Problem 3.1.
        stresses: the Problem 3.2 that stands beside a Problem 3.1. The honest one is the same beside all; it takes one
            so that a control can follow it.
    """

    displacements: SemiDiscrete
    stresses: Callable[[SemiDiscrete], StressProblem]

    @classmethod
    def of(cls, solution: ExactSolution, family: MeshFamily, level: int) -> Sides:
        """Both problems of an exact solution on one mesh."""
        displacements, stresses = problems(solution, family, level)
        return cls(displacements, lambda _: stresses)


@dataclass(frozen=True, eq=False)
class Derived(StressProblem):
    """What Problem 3.2 must not be: stresses that the law gives for the ``displacements`` of a Problem 3.1."""

    displacements: SemiDiscrete

    @classmethod
    def beside(cls, stresses: StressProblem, displacements: SemiDiscrete) -> Derived:
        """In the place of ``stresses``."""
        return cls(stresses.space, stresses.law, stresses.N, stresses.load, stresses.u0, displacements)

    def march(self, steps: int) -> Iterator[StressState]:
        """Backward Euler in displacements, with gaps as an interior point leaves them."""
        k, law, old = self.displacements.T / steps, on_cells(self.space, self.law), self.space.strain(self.u0)
        yield StressState(0.0, np.full_like(old, np.nan), old, self.u0, np.full(self.N.shape[0], np.nan), 0.0)
        for _, state in pairwise(BACKWARD_EULER.march(self.displacements, steps)):
            strain = self.space.strain(state.u)
            stress = law.stress((strain - old) / k, strain)
            yield StressState(state.time, stress, strain, state.u, state.multipliers, AIM.gap)
            old = strain


class Independence(NamedTuple):
    """How much of a mistake in Problem 3.1 alone its gaps to Problem 3.2 show: 1 all of it, 0 nothing.

    Of displacements in ‖·‖_V, of stresses in ‖·‖_Q.
    """

    displacement_shown: float
    stress_shown: float


def independence(sides: Sides, steps: int) -> Independence:
    """The gaps that open when Problem 3.1 alone is solved with the normal flipped, relative to what the flip changes.

    Both are measured by ``gaps``, so that a comparison of a solution with itself there is seen as well.
    """
    wrong = replace(sides.displacements, N=-sides.displacements.N)
    beside = sides.stresses(wrong)
    opened = gaps(wrong, beside, steps)
    mistake = gaps(wrong, Derived.beside(beside, sides.displacements), steps)
    with np.errstate(invalid="ignore", divide="ignore"):
        return Independence(*(float(ratio) for ratio in np.divide(opened[:2], mistake[:2])))


class StandsAlone(ListedNumbers):
    """The gaps show all of a mistake in Problem 3.1 alone; without a mistake, 0/0, nothing is shown, and it fails."""

    label = "Thm 4.2"
    claim = "the comparison sees all of a mistake in Problem 3.1 alone"
    rules = tuple(
        every(f"alone-{side}", f"mistake in 3.1 alone that the {side} gap shows", ALONE, f"{side}_shown")
        for side in ("displacement", "stress")
    )
    quick = grid(CASES, ("one-diagonal",), (4,))
    full = grid(CASES, ("one-diagonal", "shaken"), (4, 8))

    def measure(self, setting: Setting) -> dict[str, float]:
        sides = Sides.of(resolve(setting.case).solution, family_named(setting.family), setting.level)
        shown = independence(sides, 2 * setting.level)
        return with_h(sides.stresses(sides.displacements).space.h, shown._asdict())
