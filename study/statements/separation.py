"""(4.16)–(4.27), a step in the proof of Theorem 4.2: solutions of the stress problem (Problem 3.2) do not penetrate.

The proof supposes that {u, σ} solves Problem 3.2 with u(t) ∉ K, and finds two admissible stresses that contradict
(3.15). The argument is tested on the P1 space V^h. Let P be the projection onto K^h in ‖·‖_V, f(t) the load of a case,

    τ̃ = A ε(Pu − u),   σ̃ = A ε(f(t)),   α = −‖Pu − u‖_V²/2,

and σ any member of Σ^h(t), the set of admissible stresses. The steps are, for all v ∈ K^h:

* (4.16), (4.23): (τ̃, ε(v))_Q ≥ 0, that is, −(τ̃, ε(·))_Q lies in the cone {Nᵀλ : λ ≥ 0};
* (4.17)–(4.20): (τ̃, ε(u))_Q < α < 0. Since K^h is a cone, (Pu − u, Pu)_V = 0, so −(τ̃, ε(u))_Q = ‖Pu − u‖_V².
  So the quotient of both sides is predicted to be 1. If it were at most 1/2, α would not lie above (τ̃, ε(u))_Q. If it
  were not 1, P would not be the projection;
* (4.24), and before it (4.25) and (4.27): τ̃ + σ̃ and 2σ − σ̃ lie in Σ^h(t);
* (4.25)–(4.27): for the two stresses τ = τ̃ + σ̃ and τ = 2σ − σ̃ the numbers (τ − σ, ε(u))_Q add up to (τ̃, ε(u))_Q.
  The sum is negative, so the smaller number is negative, and (3.15) fails for every σ. Predicted is that the smaller
  number divided by half of the sum is at least 1. For σ = σ̃ + τ̃/2 both numbers are half of the sum, so the quotient is
  exactly 1; for random σ it is much larger. Therefore the smallest quotient over all u and σ is predicted to be 1.

Only P uses the contact solver; nonnegative least squares decides whether a functional lies in the cone. This file tests
the argument of the proof. The statements on Thm 4.2 test whether computed solutions of Problem 3.2 lie in K.
"""

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
from study.statements.shared.meshes import IRREGULAR, named, place, representing, space_of
from study.statements.shared.norms import maximum, minimum
from study.statements.shared.scope import REGULAR
from study.statements.thm_4_2 import beyond

COUNT = 12
"""Number of random displacements that violate many constraints, and of random displacements that violate just one."""
INSTANT = 0.61
"""Time at which the load and the admissible stresses are taken, as a fraction of the final time T."""
CONE = positive_at_most(1e-10, "0 up to rounding")
HALFWAY = around(1, 1e-9, "equality up to rounding")
BOTH_ADMISSIBLE = "(4.24): violation of τ̃ + σ̃ ∈ Σ^h(t) and of 2σ − σ̃ ∈ Σ^h(t), relative to the size of the stress"
SMALLER_WORK = (
    "(4.25)–(4.27): smaller one of (τ − σ, ε(u))_Q for τ = τ̃ + σ̃ and τ = 2σ − σ̃, divided by (τ̃, ε(u))_Q / 2; "
    "smallest quotient over all u and σ"
)


class Separation(ListedNumbers):
    """Measures for each step of the proof its extreme value over random u ∉ K^h and random σ ∈ Σ^h(t).

    The module docstring lists the steps and the quotients that are measured.
    """

    label = "(4.16)–(4.27)"
    claim = "if u is not in K, the stress τ̃ = A ε(P u − u) separates u from K, and (3.15) fails for every σ ∈ Σ(t)"
    rules = (
        largest("cone", "(4.16), (4.23): violation of (τ̃, ε(v))_Q ≥ 0 for all v ∈ K^h, relative to τ̃", CONE, "cone"),
        every("gap", "(4.17)–(4.20): −(τ̃, ε(u))_Q / ‖P u − u‖_V²", HALFWAY, "least gap", "largest gap"),
        largest("stresses", BOTH_ADMISSIBLE, CONE, "stresses"),
        every("refuted", SMALLER_WORK, HALFWAY, "refuted"),
    )

    def places(self, full: bool) -> list[Setting]:
        if full:
            bodies = representing("body")
            return place(bodies, IRREGULAR, (8, 16)) + place(bodies, REGULAR, (), (2, 4))
        return place(named("full-contact"), IRREGULAR, (8,))

    def measure(self, setting: Setting) -> dict[str, float]:
        space, solution = space_of(setting), resolve(setting.case).solution
        problem, A = unloaded(space, solution.law), on_cells(space, solution.law).A
        load, rng = ErrorNorm(solution, space).load(INSTANT * solution.body.T), np.random.default_rng(SEED)
        rivals = Rivals(space, problem, A, rng)
        balanced = separating(space, A, Cholesky(problem.M)(load))
        cones, gaps, distances, quotients = [], [], [], []
        random = (rng.standard_normal(space.dofs) for _ in range(COUNT))
        many_violated = (u if (space.N @ u).max() > 0 else -u for u in random)
        one_violated = islice(nonmembers(space, rng), COUNT)
        for u in chain(many_violated, one_violated):
            step, weighted = projected(problem, u) - u, space.volumes * space.strain(u)
            tau = separating(space, A, step)
            functional, work = space.functional(tau), float(np.sum(tau * weighted))
            cones.append(beyond(-functional, problem.N) / np.linalg.norm(functional))
            gaps.append(-work / (step @ (problem.M @ step)))
            for sigma in (balanced + tau / 2, *rivals.stresses(load)):
                both = tau + balanced, reflected(sigma, balanced)
                functionals = [space.functional(other) for other in both]
                distances += [beyond(load - F, problem.N) / np.linalg.norm(F) for F in functionals]
                quotients.append(minimum(np.sum((other - sigma) * weighted) for other in both) / (work / 2))
        found = {"cone": maximum(cones), "least gap": minimum(gaps), "largest gap": maximum(gaps)}
        return with_h(space.h, {**found, "stresses": maximum(distances), "refuted": minimum(quotients)})


def projected(problem: SemiDiscrete, u: Array) -> Array:
    """Return the projection of u onto K^h: the nearest P1 function in ‖·‖_V that does not penetrate."""
    return Signorini(problem.M, problem.N)(problem.M @ u)[0]


def separating(space: Space, A: AtPoints, v: Array) -> Tensors:
    """Return the stress A ε(v) of a displacement on the cells, the form of both stresses τ̃ and σ̃ of the proof."""
    return A(space.strain(v))


def reflected(sigma: Tensors, balanced: Tensors) -> Tensors:
    """Return 2σ − σ̃, the second of the two stresses that contradict (3.15)."""
    return 2 * sigma - balanced
