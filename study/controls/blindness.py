"""Checks that look at nothing: evidence is replaced by a thing beside itself, and some row has to notice.

A weakened check lets every mistake pass that it alone sees, and all other rows hold. It shows where evidence may not be
exactly nothing (``study.ledger.window.above_nothing``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any

from manufactured.tensors import Array
from study.controls.defects import Around
from study.fem.gauge import Gauge, Sample
from study.solve.evolution import SemiDiscrete, State
from study.solve.stress_problem import StressProblem
from study.solve.stress_programme import StressState
from study.statements.prop_5_4.experiment import Experiment
from study.statements.thm_4_2.stands_alone import Sides


def companion_is_the_run(setup: Experiment) -> Experiment:
    """The trajectory with k is every other state of that with k/2, whose distance should show the time share."""
    return replace(setup, scheme=Companion(setup.scheme, setup.steps))


@dataclass(frozen=True)
class Companion(Around):
    """A scheme that takes twice the steps where it is asked for some number of them."""

    halved: int

    def march(self, problem: SemiDiscrete, steps: int) -> Iterator[State]:
        if steps == self.halved:
            return islice(self.scheme.march(problem, 2 * steps), 0, None, 2)
        return self.scheme.march(problem, steps)


def solver_says_nothing(setup: Experiment) -> Experiment:
    """Contact solves whose residual nobody computes."""
    return replace(setup, scheme=Silent(setup.scheme))


class Silent(Around):
    """A scheme with residuals of 0."""

    def march(self, problem: SemiDiscrete, steps: int) -> Iterator[State]:
        return (replace(state, residual=lambda: 0.0) for state in self.scheme.march(problem, steps))


def halved_is_the_run(companion: Callable[[Any], Iterator[Any]]) -> Callable[[Any], Iterator[Any]]:
    """Problem 3.2 with half of the steps is every other state of that with all of them."""
    return lambda experiment: islice(experiment.march(), 1, None, 2)


# Theorem 4.2: what one step alone shows.


@dataclass(frozen=True, eq=False)
class FirstStepOff(StressProblem):
    """Problem 3.2 whose first step is reported with an error, and which goes on without it."""

    honest: StressProblem
    off: Callable[[StressState], StressState]

    def march(self, steps: int) -> Iterator[StressState]:
        for n, state in enumerate(self.honest.march(steps)):
            yield self.off(state) if n == 1 else state


def _first_step(sides: Sides, off: Callable[[StressState], StressState]) -> Sides:
    honest = sides.stresses(sides.displacements)
    data = honest.space, honest.law, honest.N, honest.load, honest.u0
    return replace(sides, stresses=lambda problem: FirstStepOff(*data, honest, off))


def displacement_off_at_first(sides: Sides) -> Sides:
    """u_1 of Problem 3.2 larger by a ten-thousandth, and right from the second step on."""
    return _first_step(sides, lambda state: replace(state, u=(1 + 1e-4) * state.u))


def stress_off_at_first(sides: Sides) -> Sides:
    """σ_1 of Problem 3.2 larger by a ten-thousandth, and right from the second step on."""
    return _first_step(sides, lambda state: replace(state, stress=(1 + 1e-4) * state.stress))


def forgotten(distance: Callable[[Gauge, Sample, Array], float]) -> Callable[[Gauge, Sample, Array], float]:
    """The square of a distance, its root forgotten."""
    return lambda gauge, sample, v: distance(gauge, sample, v) ** 2
