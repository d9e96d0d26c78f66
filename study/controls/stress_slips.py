"""Defects of Problem 3.2 and mistakes in what it is compared with."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from manufactured.body import Part
from manufactured.data import ForceInTime, no_fronts
from manufactured.tensors import Array, Points
from study.controls.blindness import halved_is_the_run
from study.controls.slips import Slip, always, instead
from study.solve.interior_point import Accuracy
from study.solve.stress_problem import StressProblem
from study.solve.stress_programme import StressState
from study.statements.thm_4_2.gaps import Gaps
from study.statements.thm_4_2.stands_alone import Derived, Sides
from study.statements.thm_4_2.stress_errors import StressExperiment

PROGRAMME, ERRORS = "study.solve.stress_programme", "study.statements.thm_4_2.stress_errors"
STOPPED_EARLY = Slip(PROGRAMME, "AIM", instead(Accuracy(gap=1e-8, feasibility=1e-11)))
NO_DISTANCE = Slip("study.statements.thm_4_2.stands_alone", "gaps", always(Gaps(*[0.0] * len(Gaps._fields))))
COMPANION = Slip(ERRORS, "StressExperiment.companion", halved_is_the_run)
ADMISSIBLE = Slip(ERRORS, "inadmissible", always(0.0))


def _of(sides: Sides, change: Callable[[StressProblem], StressProblem]) -> Sides:
    honest = sides.stresses(sides.displacements)
    return replace(sides, stresses=lambda problem: change(honest))


def load_late(sides: Sides) -> Sides:
    """F(t − k) in place of F(t) in Problem 3.2, k = T/8."""

    def late(problem: StressProblem) -> StressProblem:
        k = problem.space.body.T / 8
        return replace(problem, load=lambda t: problem.load(max(t - k, 0.0)))

    return _of(sides, late)


def gaps_in_contact(sides: Sides) -> Sides:
    """v_ν ≤ 0 at every other vertex, in Problem 3.2."""
    return _of(sides, lambda problem: replace(problem, N=problem.N[::2]))


@dataclass(frozen=True, eq=False)
class DisplacementLate(StressProblem):
    """Problem 3.2 that hands over the displacement of the step before with each stress."""

    honest: StressProblem

    def march(self, steps: int) -> Iterator[StressState]:
        before = self.u0
        for state in self.honest.march(steps):
            yield replace(state, u=before)
            before = state.u


def displacement_late(sides: Sides) -> Sides:
    """u_{n−1} beside σ_n."""
    return _of(sides, lambda p: DisplacementLate(p.space, p.law, p.N, p.load, p.u0, p))


def beside_itself(sides: Sides) -> Sides:
    """The stress that the law gives for Problem 3.1, always of the right one: as if both had been solved."""
    honest = sides.stresses(sides.displacements)
    derived = Derived.beside(honest, sides.displacements)
    return replace(sides, stresses=lambda problem: derived)


def _other_sign(pressure: Callable[[Any, float, Array], float]) -> Callable[[Any, float, Array], float]:
    return lambda exact, time, tractions: pressure(exact, time, -tractions)


def _negative(moments: Callable[..., Array]) -> Callable[..., Array]:
    return lambda exact, of: -moments(exact, of)


def _without_viscosity(make: Callable[..., None]) -> Callable[..., None]:
    def made(primal: Any, *arguments: Any) -> None:
        make(primal, *arguments)
        primal.viscous = 0 * primal.viscous

    return made


PRESSURE = Slip(ERRORS, "Exact.pressure", _other_sign)
MOMENTS = Slip(ERRORS, "Exact.moments", _negative)
BESIDE = Slip(ERRORS, "Exact.moments_of", _negative)
ELASTIC = Slip(ERRORS, "Primal.__init__", _without_viscosity)


def surface_load_late(setup: StressExperiment) -> StressExperiment:
    """f_2(t − k) in place of f_2(t)."""
    k, right = setup.data.body.T / setup.steps, setup.data.surface_load

    def late(part: Part, x: Points) -> ForceInTime:
        load = right(part, x)
        return lambda time: load(np.maximum(time - k, 0.0))

    return replace(setup, data=replace(setup.data, surface_load=late))


def fronts_missed(setup: StressExperiment) -> StressExperiment:
    """f_0 by a rule that does not know where it jumps at the time."""
    return replace(setup, data=replace(setup.data, fronts=no_fronts))
