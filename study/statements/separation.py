"""(4.16)–(4.27): what the proof of Theorem 4.2 makes of a u ∉ K, on V^h with random u ∉ K^h.

The proof supposes that {u, σ} solves Problem 3.2 with u(t) ∉ K and finds two stresses of Σ(t) that refute (3.15). With
the projection P on K^h in ‖·‖_V and f(t) of a case

    τ̃ = A ε(Pu − u),   σ̃ = A ε(f(t)),   α = −‖Pu − u‖_V²/2,

and σ any member of Σ^h(t), the steps say, each of them for all v ∈ K^h:

* (4.16), (4.23): (τ̃, ε(v))_Q ≥ 0, that is, −(τ̃, ε(·))_Q lies in the cone {Nᵀλ : λ ≥ 0};
* (4.17)–(4.20): (τ̃, ε(u))_Q < α < 0. As K^h is a cone, (Pu − u, Pu)_V = 0, so that −(τ̃, ε(u))_Q = ‖Pu − u‖_V²:
  predicted is 1 for their quotient, too small a one leaves no α between, and a larger one is no projection;
* (4.24), and before (4.25) and (4.27): τ̃ + σ̃ and 2σ − σ̃ lie in Σ^h(t);
* (4.25)–(4.27): (τ − σ, ε(u))_Q for these two τ adds up to (τ̃, ε(u))_Q, so one is half of it or less: (3.15) fails for
  every σ, as u ∉ K^h. Half is what σ = σ̃ + τ̃/2 leaves for both; for random σ one of them is much less. Predicted is 1
  for the least quotient, attained there.

Only P comes from the contact solver; the cone is asked by nonnegative least squares. What is tested is the argument and
these pieces on V^h, not that there is no solution outside K, which Problem 3.2 itself decides (Thm 4.2).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from manufactured.law import AtPoints
from manufactured.tensors import Array, Tensors
from study.fem.gauge import Gauge
from study.fem.material import on_cells
from study.fem.naming import resolve
from study.fem.space import Space
from study.ledger.measures import every, largest
from study.ledger.window import above_nothing, around
from study.solve.evolution import SemiDiscrete
from study.solve.factorisation import Cholesky
from study.solve.signorini import Signorini
from study.statements.admissibility import Rivals
from study.statements.constraint import strangers
from study.statements.shared.base import SEED, ListedNumbers, Setting, with_h
from study.statements.shared.eigen import unloaded
from study.statements.shared.meshes import BODIES, IRREGULAR, named, place, space_of
from study.statements.shared.scope import REGULAR
from study.statements.thm_4_2 import beyond

COUNT = 12
"""Random u with all constraints at random, and as many of which one constraint is violated."""
INSTANT = 0.61
"""The fraction of T at which f and Σ^h are taken."""
CONE = above_nothing(1e-10, "0 but for rounding")
HALFWAY = around(1, 1e-9, "an equation but for rounding")


class Separation(ListedNumbers):
    """The four steps for random u ∉ K^h and random σ ∈ Σ^h(t), once for each body."""

    label = "(4.16)–(4.27)"
    claim = "a u outside K is told from K by τ̃ = A ε(P u − u), and then (3.15) fails for every σ ∈ Σ(t)"
    rules = (
        largest("cone", "(4.16), (4.23): distance of −(τ̃, ε(·))_Q from the forces of contact / its size", CONE, "cone"),
        every("gap", "(4.17)–(4.20): −(τ̃, ε(u))_Q / ‖P u − u‖_V²", HALFWAY, "least gap", "largest gap"),
        largest("stresses", "(4.24): τ̃ + σ̃, 2σ − σ̃ ∈ Σ^h, distance of f less them from the cone", CONE, "stresses"),
        every("refuted", "(4.25)–(4.27): least (τ − σ, ε(u))_Q / half of (τ̃, ε(u))_Q", HALFWAY, "refuted"),
    )

    def places(self, full: bool) -> list[Setting]:
        bodies = named(*BODIES)
        if full:
            return place(bodies, IRREGULAR, (8, 16)) + place(bodies, REGULAR, (), (2, 4))
        return place(bodies[:1], IRREGULAR, (8,))

    def measure(self, setting: Setting) -> dict[str, float]:
        space, solution = space_of(setting), resolve(setting.case).solution
        load = Gauge(solution, space).load(INSTANT * solution.body.T)
        found = Separated(space, unloaded(space, solution.law), on_cells(space, solution.law).A, load)
        return with_h(space.h, found.numbers())


def outside(space: Space, rng: np.random.Generator) -> Iterator[Array]:
    """Random u ∉ K^h: far from it, and with one vertex on the wrong side."""
    for _ in range(COUNT):
        u = rng.standard_normal(space.dofs)
        yield u if (space.N @ u).max() > 0 else -u
    for number, u in enumerate(strangers(space, rng)):
        if number == COUNT:
            return
        yield u


def projected(problem: SemiDiscrete, u: Array) -> Array:
    """P u, the nearest member of K^h in ‖·‖_V."""
    return Signorini(problem.M, problem.N)(problem.M @ u)[0]


@dataclass(frozen=True, eq=False)
class Separated:
    """What is measured.

    Attributes:
        space: V^h.
        problem: (·,·)_V and K^h.
        A: the viscosity on the cells.
        load: (f(t), ·)_V.
    """

    space: Space
    problem: SemiDiscrete
    A: AtPoints
    load: Array

    def numbers(self) -> dict[str, float]:
        """The extremes over all u and σ."""
        rng = np.random.default_rng(SEED)
        rivals = Rivals(self.space, self.problem, self.A, rng)
        balanced = self.separating(Cholesky(self.problem.M)(self.load))
        cones, gaps, distances, quotients = [], [], [], []
        for u in outside(self.space, rng):
            step = projected(self.problem, u) - u
            apart = self.separating(step)
            functional, work = self.space.functional(apart), self.work(apart, u)
            cones.append(beyond(-functional, self.problem.N) / np.linalg.norm(functional))
            gaps.append(-work / (step @ (self.problem.M @ step)))
            for sigma in (balanced + apart / 2, *rivals.stresses(self.load)):
                both = apart + balanced, reflected(sigma, balanced)
                distances += [self.distance(tau) for tau in both]
                quotients.append(min(self.work(tau - sigma, u) for tau in both) / (work / 2))
        return {
            "cone": max(cones),
            "least gap": min(gaps),
            "largest gap": max(gaps),
            "stresses": max(distances),
            "refuted": min(quotients),
        }

    def separating(self, v: Array) -> Tensors:
        """A ε(v) on the cells."""
        return self.A(self.space.strain(v))

    def work(self, stress: Tensors, v: Array) -> float:
        """(τ, ε(v))_Q."""
        return float(np.sum(self.space.volumes * stress * self.space.strain(v)))

    def distance(self, stress: Tensors) -> float:
        """How far a stress is from Σ^h(t), relative to its size."""
        functional = self.space.functional(stress)
        return beyond(self.load - functional, self.problem.N) / float(np.linalg.norm(functional))


def reflected(sigma: Tensors, balanced: Tensors) -> Tensors:
    """2σ − σ̃."""
    return 2 * sigma - balanced
