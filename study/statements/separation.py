"""(4.16)–(4.27): a step in the proof of Theorem 4.2, tested on V^h: a solution of Problem 3.2 cannot have u(t) ∉ K.

The proof supposes that {u, σ} solves Problem 3.2 with u(t) ∉ K, and finds two stresses of Σ(t) that refute (3.15).
Let P be the projection on K^h in ‖·‖_V, f(t) the load of a case,

    τ̃ = A ε(Pu − u),   σ̃ = A ε(f(t)),   α = −‖Pu − u‖_V²/2,

and σ any member of Σ^h(t). The steps are, for all v ∈ K^h:

* (4.16), (4.23): (τ̃, ε(v))_Q ≥ 0, that is, −(τ̃, ε(·))_Q lies in the cone {Nᵀλ : λ ≥ 0};
* (4.17)–(4.20): (τ̃, ε(u))_Q < α < 0. Since K^h is a cone, (Pu − u, Pu)_V = 0, so −(τ̃, ε(u))_Q = ‖Pu − u‖_V².
  Predicted is the quotient 1 of both sides. If it were at most 1/2, α would not lie above (τ̃, ε(u))_Q; if it were
  not 1, P would not be the projection;
* (4.24), and before it (4.25) and (4.27): τ̃ + σ̃ and 2σ − σ̃ lie in Σ^h(t);
* (4.25)–(4.27): for the two stresses τ = τ̃ + σ̃ and τ = 2σ − σ̃ the numbers (τ − σ, ε(u))_Q add up to (τ̃, ε(u))_Q.
  So one of them is at most half of it, which is negative, and (3.15) fails for every σ, as u ∉ K^h. For σ = σ̃ + τ̃/2
  both are half of it; for random σ one is much less. Predicted for the least of the numbers over half of (τ̃, ε(u))_Q
  is 1, attained for σ = σ̃ + τ̃/2.

Only P uses the contact solver; nonnegative least squares decides whether a functional lies in the cone. This tests the
argument on V^h. It does not test that there is no solution outside K, which Problem 3.2 itself decides (Thm 4.2).
"""

from __future__ import annotations

from itertools import chain, islice

import numpy as np

from manufactured.law import AtPoints
from manufactured.tensors import Array, Tensors
from study.fem.error_norm import ErrorNorm
from study.fem.naming import resolve
from study.fem.space import Space, on_cells
from study.ledger.criterion import every, largest
from study.ledger.window import around, positive_at_most
from study.solve.evolution import SemiDiscrete
from study.solve.factorisation import Cholesky
from study.solve.signorini import Signorini
from study.statements.admissibility import Rivals
from study.statements.constraint import nonmembers
from study.statements.shared.base import SEED, ListedNumbers, Setting, with_h
from study.statements.shared.eigen import unloaded
from study.statements.shared.meshes import BODIES, IRREGULAR, named, place, space_of
from study.statements.shared.norms import maximum, minimum
from study.statements.shared.scope import REGULAR
from study.statements.thm_4_2 import beyond

COUNT = 12
"""Number of random u for which all constraints are random, and number of random u that violate one constraint."""
INSTANT = 0.61
"""Fraction of T at which f and Σ^h are taken."""
CONE = positive_at_most(1e-10, "0 up to rounding")
HALFWAY = around(1, 1e-9, "equality up to rounding")


class Separation(ListedNumbers):
    """Tests the four steps of the proof for random u ∉ K^h and random σ ∈ Σ^h(t), on each body."""

    label = "(4.16)–(4.27)"
    claim = "τ̃ = A ε(P u − u) separates a u outside K from K, and then (3.15) fails for every σ ∈ Σ(t)"
    rules = (
        largest(
            "cone", "(4.16), (4.23): distance of −(τ̃, ε(·))_Q from the cone of contact forces / its size", CONE, "cone"
        ),
        every("gap", "(4.17)–(4.20): −(τ̃, ε(u))_Q / ‖P u − u‖_V²", HALFWAY, "least gap", "largest gap"),
        largest(
            "stresses",
            "(4.24): τ̃ + σ̃, 2σ − σ̃ ∈ Σ^h, distance of the rest of f from the cone of contact forces",
            CONE,
            "stresses",
        ),
        every("refuted", "(4.25)–(4.27): least (τ − σ, ε(u))_Q / half of (τ̃, ε(u))_Q", HALFWAY, "refuted"),
    )

    def places(self, full: bool) -> list[Setting]:
        bodies = named(*BODIES)
        if full:
            return place(bodies, IRREGULAR, (8, 16)) + place(bodies, REGULAR, (), (2, 4))
        return place(bodies[:1], IRREGULAR, (8,))

    def measure(self, setting: Setting) -> dict[str, float]:
        space, solution = space_of(setting), resolve(setting.case).solution
        problem, A = unloaded(space, solution.law), on_cells(space, solution.law).A
        load = ErrorNorm(solution, space).load(INSTANT * solution.body.T)
        return with_h(space.h, refutation(space, problem, A, load))


def refutation(space: Space, problem: SemiDiscrete, A: AtPoints, load: Array) -> dict[str, float]:
    """Return the extreme values in the four steps over all u and σ.

    Args:
        problem: gives the inner product of V and K^h.
        A: the viscosity on the cells.
        load: the functional (f(t), ·)_V.
    """

    def work(stress: Tensors, v: Array) -> float:
        """Return (τ, ε(v))_Q."""
        return float(np.sum(space.volumes * stress * space.strain(v)))

    def distance(stress: Tensors) -> float:
        """Return the distance of a stress from Σ^h(t), relative to its size."""
        functional = space.functional(stress)
        return beyond(load - functional, problem.N) / float(np.linalg.norm(functional))

    rng = np.random.default_rng(SEED)
    rivals = Rivals(space, problem, A, rng)
    balanced = separating(space, A, Cholesky(problem.M)(load))
    cones, gaps, distances, quotients = [], [], [], []
    random = (rng.standard_normal(space.dofs) for _ in range(COUNT))
    many_violated = (u if (space.N @ u).max() > 0 else -u for u in random)
    one_violated = islice(nonmembers(space, rng), COUNT)
    for u in chain(many_violated, one_violated):
        step = projected(problem, u) - u
        tau = separating(space, A, step)
        functional, drop = space.functional(tau), work(tau, u)
        cones.append(beyond(-functional, problem.N) / np.linalg.norm(functional))
        gaps.append(-drop / (step @ (problem.M @ step)))
        for sigma in (balanced + tau / 2, *rivals.stresses(load)):
            both = tau + balanced, reflected(sigma, balanced)
            distances += [distance(other) for other in both]
            quotients.append(minimum(work(other - sigma, u) for other in both) / (drop / 2))
    return {
        "cone": maximum(cones),
        "least gap": minimum(gaps),
        "largest gap": maximum(gaps),
        "stresses": maximum(distances),
        "refuted": minimum(quotients),
    }


def projected(problem: SemiDiscrete, u: Array) -> Array:
    """Return P u, the member of K^h nearest to u in ‖·‖_V."""
    return Signorini(problem.M, problem.N)(problem.M @ u)[0]


def separating(space: Space, A: AtPoints, v: Array) -> Tensors:
    """Return A ε(v) on the cells."""
    return A(space.strain(v))


def reflected(sigma: Tensors, balanced: Tensors) -> Tensors:
    """Return 2σ − σ̃."""
    return 2 * sigma - balanced
