"""Deliberate defects: each replaces one piece of a correct ``Setup`` by a wrong one.

They live beside the tests, so that no option of the product reaches them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import scipy.sparse as sps

from manufactured import isotropic
from manufactured.law import Linear
from study.fem.gauge import Gauge, Sample
from study.fem.space import Space
from study.solve.evolution import BackwardEuler, Problem
from study.solve.signorini import Signorini
from study.sweep import Setup

Defect = Callable[[Setup], Setup]


def contact_dropped(setup: Setup) -> Setup:
    return replace(setup, problem=replace(setup.problem, N=setup.problem.N[:0], solver=Unconstrained))


class Unconstrained(Signorini):
    def __call__(self, b):
        return self.factor(b), np.zeros(0)


def contact_two_sided(setup: Setup) -> Setup:
    return replace(setup, problem=replace(setup.problem, solver=TwoSided))


class TwoSided(Signorini):
    def complementarity(self, gap):
        return self.on(np.ones_like(self.active), gap)


def one_active_set_iteration(setup: Setup) -> Setup:
    return replace(setup, problem=replace(setup.problem, solver=OneIteration))


class OneIteration(Signorini):
    def complementarity(self, gap):
        return self.on(gap > 0, gap)


def normal_flipped(setup: Setup) -> Setup:
    return replace(setup, problem=replace(setup.problem, N=-setup.problem.N))


def constraint_relaxed(setup: Setup) -> Setup:
    """K^h replaced by {v : v_ν ≤ √h}."""
    allowed = np.sqrt(setup.space.h)

    class Relaxed(Signorini):
        def complementarity(self, gap):
            return super().complementarity(gap - allowed)

    return replace(setup, problem=replace(setup.problem, solver=Relaxed))


def contact_work_sign_flipped(setup: Setup) -> Setup:
    gauge = setup.gauge
    return _load(setup, lambda t: gauge.load(t) - 2 * gauge._contact_work(t))


def load_one_step_late(setup: Setup) -> Setup:
    """The load of the step before."""
    delay = setup.problem.T / setup.steps
    load = setup.problem.load
    return _load(setup, lambda t: load(max(t - delay, 0.0)))


def _load(setup: Setup, load: Callable[[float], np.ndarray]) -> Setup:
    return replace(setup, problem=replace(setup.problem, load=load))


def zero_start(setup: Setup) -> Setup:
    return replace(setup, problem=replace(setup.problem, u0=np.zeros_like(setup.problem.u0)))


def elasticity_dropped(setup: Setup) -> Setup:
    return replace(setup, problem=replace(setup.problem, reference=sps.csc_array(setup.problem.reference.shape)))


def viscosity_and_elasticity_swapped(setup: Setup) -> Setup:
    problem = setup.problem
    return replace(setup, problem=replace(problem, M=problem.reference, reference=problem.M))


def backward_euler_with_k_like_h(setup: Setup) -> Setup:
    return replace(setup, scheme=BackwardEuler(), steps=round(1 / setup.space.h))


class WrongTensor(Gauge):
    """Measures with another tensor than A."""

    def __init__(self, gauge: Gauge, tensor: Linear) -> None:
        super().__init__(gauge.solution, gauge.space)
        self.A = tensor


def norm_of_h1(setup: Setup) -> Setup:
    return replace(setup, gauge=WrongTensor(setup.gauge, isotropic(0.5, 0)))


def norm_with_elasticity(setup: Setup) -> Setup:
    return replace(setup, gauge=WrongTensor(setup.gauge, setup.solution.law.G))


class OnePoint(Gauge):
    """One-point quadrature of the error: the interpolant's strain at the centre of a cell is nearly exact."""

    def sample(self, time: float) -> Sample:
        exact = super().sample(time)
        corners = self.space.mesh.p[:, self.space.mesh.t]
        return replace(exact, means=self.solution.at(corners.mean(axis=1)).strain(time), oscillation=0.0)


def one_point_quadrature(setup: Setup) -> Setup:
    return replace(setup, gauge=OnePoint(setup.solution, setup.space))


class SumOfRoots(Gauge):
    """Σ_T ‖·‖_T instead of (Σ_T ‖·‖_T²)^{1/2}."""

    def distance(self, sample: Sample, v: np.ndarray) -> float:
        difference = sample.means - self.space.strain(v)
        local = np.sum(self.A(difference) * difference, axis=0) * self.space.volumes
        return float(np.sqrt(local + sample.oscillation / len(local)).sum())


def sum_of_square_roots(setup: Setup) -> Setup:
    return replace(setup, gauge=SumOfRoots(setup.solution, setup.space))


class Baseline(Gauge):
    """Judges Π^h u instead of what was computed."""

    def distance(self, sample: Sample, v: np.ndarray) -> float:
        return super().distance(sample, sample.interpolant)


def slope_of_the_baseline(setup: Setup) -> Setup:
    """The interpolation error is judged, while the computed solution ignores contact."""
    return replace(contact_dropped(setup), gauge=Baseline(setup.solution, setup.space))


class OnlyLast(Gauge):
    """The error counts at the final time only."""

    def distance(self, sample: Sample, v: np.ndarray) -> float:
        value = super().distance(sample, v)
        return value if sample.time >= self.space.body.T * (1 - 1e-9) or v is sample.interpolant else 0.0


def final_time_only(setup: Setup) -> Setup:
    return replace(setup, gauge=OnlyLast(setup.solution, setup.space))


class ShortClamp(Space):
    """The clamped edge ends one cell before its end."""

    @property
    def free(self):
        clamped = super().free
        nodes = np.arange(self.mesh.p.shape[1])
        corner = nodes[np.linalg.norm(self.mesh.p - np.array([[1.0], [1.0]]), axis=0) < 1.5 / np.sqrt(len(nodes))]
        return np.union1d(clamped, (2 * corner[:, None] + np.arange(2)).ravel())


def clamp_one_cell_short(setup: Setup) -> Setup:
    space = ShortClamp(setup.space.mesh, setup.space.body)
    gauge = Gauge(setup.solution, space)
    problem = Problem.of(space, setup.solution.law, gauge.load, gauge.sample(0.0).interpolant)
    return replace(setup, space=space, gauge=gauge, problem=problem)
