"""The defects of ``study controls``: each replaces one piece of what is measured by a wrong one, and nothing else."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sps
from skfem import Basis, ElementTriP1

from manufactured import isotropic
from manufactured.body import Kind, Part
from manufactured.exact import ExactSolution
from manufactured.law import Linear
from manufactured.tensors import Array, Points
from study.fem.gauge import DEGREE, Gauge, Sample
from study.fem.moments import Amplitudes
from study.fem.space import Space
from study.solve.evolution import Scheme, SemiDiscrete, State
from study.solve.signorini import ContactSolver, Signorini
from study.solve.tableau import BACKWARD_EULER
from study.statements.growing_errors import projection
from study.statements.prop_5_4.experiment import Experiment
from study.statements.thm_4_2 import stress_errors as own
from study.statements.thm_4_2.stands_alone import Derived, Sides

# The contact condition.


def start_at_projection(setup: Experiment) -> Experiment:
    """u_0^h = P_h u_0, the projection in (·,·)_V, for a homogeneous A."""
    return replace(setup, problem=replace(setup.problem, u0=projection(setup, 0.0)))


def contact_dropped(setup: Experiment) -> Experiment:
    """V^h in place of K^h."""
    return replace(setup, problem=replace(setup.problem, N=setup.problem.N[:0], solver=Unconstrained))


class Unconstrained(Signorini):
    """The solve without a constraint, whose compliance matrix is empty."""

    def __call__(self, b: Array) -> tuple[Array, Array]:
        return self.factor(b), np.zeros(0)


def contact_two_sided(setup: Experiment) -> Experiment:
    """{v : v_ν = 0} in place of K^h: the foundation holds the body."""
    return _solver(setup, Bilateral)


class Bilateral(Signorini):
    """Every vertex of Γ3 is active."""

    def complementarity(self, gap: Array) -> Array:
        return self.multipliers_on(np.ones_like(self.active), gap)


def constraint_relaxed(setup: Experiment) -> Experiment:
    """{v : v_ν ≤ √h} in place of K^h."""
    allowed = np.sqrt(setup.space.h)

    class Relaxed(Signorini):
        def complementarity(self, gap: Array) -> Array:
            return super().complementarity(gap - allowed)

    return _solver(setup, Relaxed)


def one_active_set_iteration(setup: Experiment) -> Experiment:
    """The active set is what the free solution violates, and is not iterated."""
    return _solver(setup, OneIteration)


class OneIteration(Signorini):
    """The first active set is the last."""

    def complementarity(self, gap: Array) -> Array:
        return self.multipliers_on(gap > 0, gap)


def contact_in_places(setup: Experiment) -> Experiment:
    """v_ν ≤ 0 at every other vertex of Γ3 only."""
    return _solver(setup, EveryOther)


class EveryOther(Signorini):
    """Half of the rows of N, with no force at the others."""

    def __init__(self, S: sps.csc_array, N: sps.csr_array, x: Points | None = None) -> None:
        super().__init__(S, N[::2])
        self.count = N.shape[0]

    def __call__(self, b: Array) -> tuple[Array, Array]:
        u, forces = super().__call__(b)
        multipliers = np.zeros(self.count)
        multipliers[::2] = forces
        return u, multipliers


A_FIFTH = 1.2
"""A contact force too large by a fifth, which changes no displacement where all of Γ3 is pressed down."""


def multipliers_a_fifth_too_large(setup: Experiment) -> Experiment:
    """1.2 λ in place of λ, beside the right u^h."""
    return _solver(setup, Exaggerating)


class Exaggerating(Signorini):
    """The right displacement with too large forces."""

    def __call__(self, b: Array) -> tuple[Array, Array]:
        u, multipliers = super().__call__(b)
        return u, A_FIFTH * multipliers


def _solver(setup: Experiment, solver: Callable[[sps.csc_array, sps.csr_array], ContactSolver]) -> Experiment:
    return replace(setup, problem=replace(setup.problem, solver=solver))


def normal_flipped(setup: Experiment) -> Experiment:
    """v_ν ≥ 0 in place of v_ν ≤ 0.

    Where all of Γ3 is in contact this is V^h in place of K^h, as the free solution penetrates everywhere; where a gap
    is open it closes it.
    """
    return replace(setup, problem=replace(setup.problem, N=-setup.problem.N))


def normal_along_an_axis(setup: Experiment) -> Experiment:
    """The nearest axis in place of ν, which no axis-parallel body would show."""
    N = setup.problem.N.copy()
    normals = N.data.reshape(-1, setup.space.dim)
    nearest = np.arange(setup.space.dim) == abs(normals).argmax(axis=1)[:, None]
    N.data = np.where(nearest, np.sign(normals), 0.0).ravel()
    return replace(setup, problem=replace(setup.problem, N=N))


# The data.


def contact_work_sign_flipped(setup: Experiment) -> Experiment:
    """(σ, ε(v))_Q + ∫_{Γ3} σ_ν v_ν in place of the load (3.7)."""
    return _load(setup, FlippedWork(setup.solution, setup.space).load)


class FlippedWork(Gauge):
    """Green's formula with the wrong sign on Γ3."""

    def _contact_work(self, strains: Amplitudes, rates: Amplitudes) -> Array:
        return -super()._contact_work(strains, rates)


def contact_load_a_fifth_too_large(setup: Experiment) -> Experiment:
    """1.2 ∫_{Γ3} σ_ν v_ν in the load (3.7)."""
    return _load(setup, LargerWork(setup.solution, setup.space).load)


class LargerWork(Gauge):
    """Green's formula with too large a term on Γ3."""

    def _contact_work(self, strains: Amplitudes, rates: Amplitudes) -> Array:
        return A_FIFTH * super()._contact_work(strains, rates)


def load_one_step_late(setup: Experiment) -> Experiment:
    """F(t − k) in place of F(t)."""
    load, k = setup.problem.load, setup.problem.T / setup.steps
    return _load(setup, lambda t: load(max(t - k, 0.0)))


def _load(setup: Experiment, load: Callable[[float], Array]) -> Experiment:
    return replace(setup, problem=replace(setup.problem, load=load))


def zero_start(setup: Experiment) -> Experiment:
    """0 in place of u_0^h = Π^h u_0."""
    return replace(setup, problem=replace(setup.problem, u0=np.zeros_like(setup.problem.u0)))


def clamp_one_cell_short(setup: Experiment) -> Experiment:
    """V^h whose functions need not vanish at one end of Γ1."""
    space = ShortClamp(setup.space.mesh, setup.space.body)
    gauge = Gauge(setup.solution, space)
    problem = SemiDiscrete.of(space, setup.solution.law, gauge.load, gauge.sample(0.0).interpolant)
    return replace(setup, space=space, gauge=gauge, problem=problem)


class ShortClamp(Space):
    """The vertex at the start of every piece of Γ1 is free."""

    @cached_property
    def free(self) -> Array:
        ends = [
            int(np.linalg.norm(self.mesh.p - part.start[:, None], axis=0).argmin())
            for part in self.body.of(Kind.CLAMPED)
        ]
        loose = self.dim * np.array(ends)[:, None] + np.arange(self.dim)
        return np.union1d(super().free, loose)


# The law and the time scheme.


def viscosity_dropped(setup: Experiment) -> Experiment:
    """G(u) + N_K(u) ∋ F in place of A u̇ + G(u) + N_K(u) ∋ F."""
    return _altered(setup, lambda problem: replace(problem, M=_zero(problem.M)))


def elasticity_dropped(setup: Experiment) -> Experiment:
    """A u̇ + N_K(u) ∋ F in place of A u̇ + G(u) + N_K(u) ∋ F."""
    return _altered(setup, lambda problem: replace(problem, reference=_zero(problem.reference)))


def viscosity_and_elasticity_swapped(setup: Experiment) -> Experiment:
    """G u̇ + A(u) + N_K(u) ∋ F in place of A u̇ + G(u) + N_K(u) ∋ F."""
    return _altered(setup, lambda problem: replace(problem, M=problem.reference, reference=problem.M))


def _zero(matrix: sps.csc_array) -> sps.csc_array:
    return sps.csc_array(matrix.shape)


@dataclass(frozen=True)
class Around:
    """What is another scheme in all but how it marches."""

    scheme: Scheme

    @property
    def name(self) -> str:
        return self.scheme.name

    @property
    def order(self) -> float:
        return self.scheme.order


@dataclass(frozen=True)
class Altered(Around):
    """A scheme that solves another problem than the one that is measured, so that norms stay what they are."""

    alter: Callable[[SemiDiscrete], SemiDiscrete]

    def march(self, problem: SemiDiscrete, steps: int) -> Iterator[State]:
        return self.scheme.march(self.alter(problem), steps)


def _altered(setup: Experiment, alter: Callable[[SemiDiscrete], SemiDiscrete]) -> Experiment:
    return replace(setup, scheme=Altered(setup.scheme, alter))


def backward_euler_with_k_like_h(setup: Experiment) -> Experiment:
    """A fully discrete solution, first order in k ~ h, in place of u^h."""
    return replace(setup, scheme=BACKWARD_EULER, steps=round(1 / setup.space.h))


# What the error is measured with.


def norm_of_h1(setup: Experiment) -> Experiment:
    """(‖v‖² + ‖ε(v)‖²)^½, the norm of H_1, in place of (A ε(v), ε(v))^½."""
    return _measured_with(setup, H1Norm)


def norm_of_l2(setup: Experiment) -> Experiment:
    """‖v‖_{L²} in place of (A ε(v), ε(v))^½."""
    return _measured_with(setup, L2Norm)


def norm_with_elasticity(setup: Experiment) -> Experiment:
    """(G ε(v), ε(v))^½ in place of (A ε(v), ε(v))^½."""
    return _measured_with(setup, ElasticNorm)


def _measured_with(setup: Experiment, gauge: Callable[[ExactSolution, Space], Gauge]) -> Experiment:
    return replace(setup, gauge=gauge(setup.solution, setup.space))


class TensorNorm(Gauge):
    """Measures strains with another tensor than A."""

    def __init__(self, solution: ExactSolution, space: Space, tensor: Linear) -> None:
        super().__init__(solution, space)
        self.A = tensor


class ElasticNorm(TensorNorm):
    """(G ε(v), ε(v))^½, the energy of the elastic part."""

    def __init__(self, solution: ExactSolution, space: Space) -> None:
        assert isinstance(solution.law.G, Linear)
        super().__init__(solution, space, solution.law.G)


class L2Norm(Gauge):
    """‖·‖_{L²}, in which P1 functions approximate with order 2."""

    def __init__(self, solution: ExactSolution, space: Space) -> None:
        super().__init__(solution, space)
        self.basis = Basis(space.mesh, ElementTriP1(), intorder=DEGREE)
        self.exact = solution.at(np.asarray(self.basis.global_coordinates()))

    def distance(self, sample: Sample, v: Array) -> float:
        computed = np.array([np.asarray(self.basis.interpolate(component)) for component in self.space.nodal(v)])
        return float(np.sqrt(np.sum((self.exact.displacement(sample.time) - computed) ** 2 * self.basis.dx)))


class H1Norm(TensorNorm):
    """(‖·‖_{L²}² + ‖ε(·)‖_Q²)^½."""

    def __init__(self, solution: ExactSolution, space: Space) -> None:
        super().__init__(solution, space, isotropic(0.5, 0, space.dim))
        self.values = L2Norm(solution, space)

    def distance(self, sample: Sample, v: Array) -> float:
        return float(np.hypot(super().distance(sample, v), self.values.distance(sample, v)))


def one_point_quadrature(setup: Experiment) -> Experiment:
    """ε(u) at the centres of the cells, where the interpolant's strain is nearly exact, in place of all of ε(u)."""
    return _measured_with(setup, OnePoint)


class OnePoint(Gauge):
    """One quadrature point a cell."""

    def sample(self, time: float) -> Sample:
        centres = self.space.mesh.p[:, self.space.mesh.t].mean(axis=1)
        return replace(super().sample(time), means=self.solution.at(centres).strain(time), oscillation=0.0)


def sum_of_square_roots(setup: Experiment) -> Experiment:
    """Σ_T ‖·‖_T in place of (Σ_T ‖·‖_T²)^½."""
    return _measured_with(setup, SumOfRoots)


class SumOfRoots(Gauge):
    """The oscillation is spread evenly over the cells."""

    def distance(self, sample: Sample, v: Array) -> float:
        difference = sample.means - self.space.strain(v)
        local = np.sum(self.A(difference) * difference, axis=0) * self.space.volumes
        return float(np.sqrt(local + sample.oscillation / len(local)).sum())


def final_time_only(setup: Experiment) -> Experiment:
    """The value at T in place of the maximum over [0, T], for u − u^h, u − Π^h u and Π^h u − u^h alike."""
    return replace(setup, scheme=FinalOnly(setup.scheme))


class FinalOnly(Around):
    """A scheme that shows its state at T alone."""

    def march(self, problem: SemiDiscrete, steps: int) -> Iterator[State]:
        *_, last = self.scheme.march(problem, steps)
        yield last


def baseline_judged(setup: Experiment) -> Experiment:
    """‖u − Π^h u‖_V in place of ‖u − u^h‖_V, whose order is the same whatever u^h is."""
    return _measured_with(setup, InterpolantGauge)


class InterpolantGauge(Gauge):
    """Measures Π^h u instead of what was computed."""

    def distance(self, sample: Sample, v: Array) -> float:
        return super().distance(sample, sample.interpolant)


# Theorem 4.2.


def stress_from_displacement(sides: Sides) -> Sides:
    """The stress of Problem 3.1 in place of that of Problem 3.2: agreement is perfect, and says nothing."""
    honest = sides.stresses(sides.displacements)
    return replace(sides, stresses=lambda problem: Derived.beside(honest, problem))


# Theorem 4.2 on a stress space of its own.


def foundation_pulls_nothing(setup: own.StressExperiment) -> own.StressExperiment:
    """σ_ν = 0 in place of σ_ν ≤ 0 on Γ3: what is left if the multipliers there are not held at u_ν ≤ 0."""
    return replace(setup, solver=Unconstrained)


def law_of_stresses_swapped(setup: own.StressExperiment) -> own.StressExperiment:
    """A and G in each other's place in Problem 3.2."""
    law = setup.data.law
    assert isinstance(law.G, Linear)
    return replace(setup, data=replace(setup.data, law=replace(law, A=law.G, G=law.A)))


def history_forgotten(setup: own.StressExperiment) -> own.StressExperiment:
    """ε̇ ≈ w ε_n/k, as if the body had come from rest in every step."""
    return replace(setup, scheme=replace(setup.scheme, past=(0.0, 0.0)))


def surface_load_left_out(setup: own.StressExperiment) -> own.StressExperiment:
    """σν = 0 in place of σν = f_2 on Γ2."""
    return replace(setup, data=replace(setup.data, surface_load=_nothing))


def _nothing(part: Part, x: Points) -> Callable[[Any], Array]:
    """No load at one time or at several."""
    return lambda time: np.zeros((*x.shape, *np.shape(time)))
