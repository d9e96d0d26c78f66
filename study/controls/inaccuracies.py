"""Defects that leave a problem nearly as it is, or what is read off its solution."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from itertools import pairwise

import numpy as np
import scipy.sparse as sps

from manufactured.tensors import Array
from study.controls.defects import Around
from study.fem.gauge import Gauge, Sample
from study.fem.space import Space
from study.solve.evolution import SemiDiscrete, State
from study.solve.signorini import Signorini
from study.statements.prop_5_4.experiment import Experiment


def contact_by_springs(setup: Experiment) -> Experiment:
    """Springs of a stiffness that does not grow with n in place of v_ν ≤ 0."""
    return replace(setup, problem=replace(setup.problem, solver=Springs))


class Springs(Signorini):
    """(S + s NᵀN) u = b, in pressure and in tension, with the same stiffness on every mesh."""

    STIFFNESS = 100.0

    def __init__(self, S: sps.csc_array, N: sps.csr_array) -> None:
        super().__init__(sps.csc_array(S + self.STIFFNESS / N.shape[0] * (N.T @ N)), N)

    def __call__(self, b: Array) -> tuple[Array, Array]:
        return self.factor(b), np.zeros(self.N.shape[0])


def load_too_large(setup: Experiment) -> Experiment:
    """1.1 F in place of F."""
    load = setup.problem.load
    return replace(setup, problem=replace(setup.problem, load=lambda t: 1.1 * load(t)))


def load_slightly_too_large(setup: Experiment) -> Experiment:
    """1.05 F in place of F."""
    load = setup.problem.load
    return replace(setup, problem=replace(setup.problem, load=lambda t: 1.05 * load(t)))


def start_at_the_end(setup: Experiment) -> Experiment:
    """u_0^h = Π^h u(T) in place of Π^h u_0."""
    return replace(setup, problem=replace(setup.problem, u0=setup.gauge.sample(setup.problem.T).interpolant))


def start_outside(setup: Experiment) -> Experiment:
    """u_0^h ∉ K^h."""
    problem = setup.problem
    outside = problem.u0 + 10 * problem.N.T @ np.ones(problem.N.shape[0])
    return replace(setup, problem=replace(problem, u0=outside))


def few_steps(setup: Experiment) -> Experiment:
    """An eighth of the time steps."""
    return replace(setup, steps=max(setup.steps // 8, 1))


def one_time_behind(setup: Experiment) -> Experiment:
    """u^h(t_{n−1}) in place of u^h(t_n)."""
    return replace(setup, scheme=Behind(setup.scheme))


class Behind(Around):
    """A scheme whose states come one time too late."""

    def march(self, problem: SemiDiscrete, steps: int) -> Iterator[State]:
        states = self.scheme.march(problem, steps)
        first = next(states)
        yield first
        for before, state in pairwise((first, *states)):
            yield replace(state, u=before.u)


def vertices_inside_counted(setup: Experiment) -> Experiment:
    """1/(n − 1) for the mesh size 1/n: the vertices inside a side were counted, not the cells."""
    space = Miscounted(setup.space.mesh, setup.space.body)
    return replace(setup, space=space)


class Miscounted(Space):
    """V^h with another size."""

    @cached_property
    def h(self) -> float:
        size = Space.h.func(self)  # type: ignore[attr-defined]
        return float(size / (1 - size))


def energy_for_norm(setup: Experiment) -> Experiment:
    """½ ‖v‖_V² in place of ‖v‖_V."""
    return replace(setup, gauge=Halved(setup.solution, setup.space))


class Halved(Gauge):
    """The energy of a difference."""

    def distance(self, sample: Sample, v: Array) -> float:
        return super().distance(sample, v) ** 2 / 2


def unconstrained(setup: Experiment) -> Experiment:
    """V^h in place of K^h in the solver alone: K^h is still what a solution is held to."""
    return replace(setup, problem=replace(setup.problem, solver=Freed))


class Freed(Signorini):
    """The solve without a constraint."""

    def __call__(self, b: Array) -> tuple[Array, Array]:
        return self.factor(b), np.zeros(self.N.shape[0])
