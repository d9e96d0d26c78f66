"""(4.4) and Theorem 2.2 where G is not monotone: how fast two solutions part, over decades of T and of L_G/m_A.

(4.4) says that B + ωI is monotone for ω = L_G/m_A, and Theorem 2.2 with it that for two solutions of Problem 5.1

    ‖u(t) − v(t)‖_V ≤ e^{ωt} (‖u_0 − v_0‖_V + ∫_0^t ‖f − g‖_V).

For monotone G nothing of this shows: ω = 0 serves as well. Here G is multiplied by a number such that L_G/m_A is ω, for
the law of the case, which softens, and for an *even* one, A τ = 2τ and G τ = −2ω τ. Predicted before measuring:

* *Even law.* B = −ωI, so that u − v = e^{ωt} (u_0 − v_0) if u_0 − v_0 moves no vertex of Γ3 along ν, whatever contact
  does meanwhile: both have the same contact forces. The bound is attained, and no smaller ω serves.
* *Law of the case.* With Γ3 pressed so hard that no vertex leaves it, the difference of two starts along an eigenvector
  of G'(S) against M in {v : Nv = 0} grows like e^{ct} as long as the material still softens, −c its least eigenvalue.
  The rate c is found without time steps. c ≤ max(−m, 0)/m_A ≤ ω, m the constant of monotonicity.
* *Any two solutions*, of other loads and other starts, under the moving contact of the case: never above the bound.

*In time.* A step of the midpoint rule multiplies an eigenvector by (1 + z/2)/(1 − z/2), z = ck, so that the rate that
is seen is c (1 + z²/12 + …), by 3.3e-4 too large for z ≤ 1/16. A step of backward Euler is the resolvent of an operator
that is monotone but for gI, g = max(−m, 0)/m_A ≤ ω: it multiplies differences by 1/(1 − gk) at most. So the bound with
these factors in place of e^{ωt}, the smaller one, holds for the steps without an error in time, and the even law
attains it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import islice

import numpy as np
from scipy.linalg import eigh, null_space

from manufactured.law import Combined, Elasticity, Indefinite, KelvinVoigt, Linear, Yield, isotropic, isotropic_matrix
from manufactured.tensors import Array, size
from study.fem.material import form
from study.fem.naming import resolve
from study.fem.space import Space
from study.ledger.measures import every, largest
from study.ledger.window import Window, above_nothing, around
from study.solve.evolution import SemiDiscrete
from study.solve.paths import path
from study.solve.tableau import BACKWARD_EULER, MIDPOINT
from study.statements.constitutive_law import derivative
from study.statements.shared.base import SEED, SOFTENING, ListedNumbers, Setting, grid, with_h
from study.statements.shared.experiment import Experiment
from study.statements.shared.norms import norm
from study.statements.wellposed import Perturbation, along_the_contact, perturbations, quotients, smooth

SWEEP = tuple((omega, T) for omega in (0.1, 1.0, 10.0) for T in (0.1, 1.0, 10.0) if omega * T <= 10)
"""(ω, T): ωT from 1/100 to 10, e^{ωT} up to 2e4."""
SHORT = 16
"""Steps in 1/ω, and at least in T."""
KINDS = 5
"""Of perturbations, each once."""
SMALL = 0.01
"""Largest strain of an eigenvector at T: far inside K, where the law is still linear."""
SEEN = around(1, 1e-3, "the midpoint rule adds 3.3e-4 at most")
NEVER = above_nothing(1 + 1e-7, "proved; room for fixed points")
ATTAINED = Window(1 - 1e-7, 1 + 1e-7, "B = −ωI: equality but for rounding")


def column(law: str, what: str, omega: float, T: float) -> str:
    """The column of one (ω, T)."""
    return f"{law} {what}, ω = {omega:g}, T = {T:g}"


def columns(law: str, what: str) -> list[str]:
    """The columns of a law for all (ω, T)."""
    return [column(law, what, omega, T) for omega, T in SWEEP]


class Parting(ListedNumbers):
    """Rates of growth against eigenvalues, and differences over their bound."""

    label = "Thm 2.2, (4.4)"
    effort = 150
    claim = "where G softens, solutions part like e^{ct}, c the softest mode, and never faster than e^{ωt}, ω = L_G/m_A"
    rules = (
        every("rate", "rate of growth / c, softest mode under contact, all ω and T", SEEN, *columns("own", "rate")),
        every("rate-even", "rate of growth / ω for G = −ωA, all ω and T", SEEN, *columns("even", "rate")),
        largest("bound", "‖u − v‖_V / its bound, other loads and starts", NEVER, *columns("own", "bound")),
        every("bound-even", "the same for G = −ωA, largest, all ω and T", ATTAINED, *columns("even", "bound")),
    )
    quick = grid(("softening",), ("shaken",), (4,))
    full = grid(SOFTENING, ("unstructured",), (6, 12))

    def measure(self, setting: Setting) -> dict[str, float]:
        setup, law = Experiment.at(setting, MIDPOINT, 1), resolve(setting.case).solution.law
        # Steps of all laws and T fall on the same few times of the load.
        load = lru_cache(maxsize=None)(setup.problem.load)
        setup = replace(setup, problem=replace(setup.problem, load=lambda t: load(round(t, 9))))
        found: dict[str, float] = {}
        for omega, T in SWEEP:
            for name, mine in (("own", scaled(law, omega)), ("even", even(law.dim, omega))):
                found[column(name, "rate", omega, T)] = rate(setup.space, mine, T)
                found[column(name, "bound", omega, T)] = over_bound(setup, mine, T)
        return with_h(setup.space.h, found)


def even(dim: int, omega: float) -> KelvinVoigt:
    """A τ = 2τ, G τ = −2ω τ."""
    return KelvinVoigt(isotropic(1, 0, dim), Indefinite(isotropic_matrix(-omega, 0, dim)), "even")


def scaled(law: KelvinVoigt, omega: float) -> KelvinVoigt:
    """The law with a multiple of G for which L_G/m_A = ω."""
    return KelvinVoigt(law.A, times(omega / law.kappa, law.G), law.name)


def times(number: float, G: Elasticity) -> Elasticity:
    """A multiple of an elasticity operator that softens.

    Raises:
        TypeError: of another one.
    """
    if isinstance(G, Combined):
        yielding = Yield(number * G.yielding.beta, G.yielding.convex)
        return Combined(number * G.prestress, Indefinite(number * G.linear.matrix), yielding)
    if isinstance(G, Linear):
        return Indefinite(number * G.matrix, G.factor)
    raise TypeError(f"no multiple of {type(G).__name__} is known; take one that is linear or combined")


@dataclass(frozen=True, eq=False)
class Mode:
    """The softest mode v in {Nv = 0}: its rate c, and the contact force that it needs to stay there, (m,)."""

    c: float
    v: Array
    force: Array


def softest(space: Space, law: KelvinVoigt) -> Mode:
    """The eigenvector of G'(0) against M in {Nv = 0} with the least eigenvalue −c."""
    slope = derivative(law.G.at(space.mesh.p[:, :1]), np.zeros((size(space.dim), 1)))[0]
    M, G, N = form(space, law.A).toarray(), space.form(slope).toarray(), space.N.toarray()
    Z = null_space(N)
    values, vectors = eigh(Z.T @ G @ Z, Z.T @ M @ Z, subset_by_index=[0, 0])
    c, v = -float(values[0]), Z @ vectors[:, 0]
    return Mode(c, v, -np.linalg.pinv(N.T) @ (c * (M @ v) + G @ v))


def steps_for(law: KelvinVoigt, T: float) -> int:
    """Short beside 1/ω and T."""
    return math.ceil(SHORT * max(law.kappa * T, 1.0))


def rate(space: Space, law: KelvinVoigt, T: float) -> float:
    """log(‖v(T)‖/‖v(0)‖)/(cT) for the solution v from the softest mode; the one from 0 is 0.

    Both are pressed onto the foundation with twice the force that the mode needs, and the stress at rest is balanced.
    """
    mode = softest(space, law)
    start = SMALL * math.exp(-mode.c * T) / abs(space.strain(mode.v)).max() * mode.v
    pressing = space.N.T @ np.full(len(mode.force), 2 * SMALL * abs(mode.force).max() / abs(space.strain(mode.v)).max())
    problem = SemiDiscrete.of(space, law, lambda t: np.zeros(space.dofs), start)
    rest = problem.elastic(np.zeros(space.dofs))
    problem = replace(problem, T=T, load=lambda t: rest + math.exp(mode.c * (t - T)) * pressing)
    states = path(problem, MIDPOINT, steps_for(law, T))
    return math.log(norm(problem, states[-1]) / norm(problem, states[0])) / (mode.c * T)


def over_bound(setup: Experiment, law: KelvinVoigt, T: float) -> float:
    """The largest ‖u_n − v_n‖_V (1 − gk)^n / (‖u_0 − v_0‖_V + k Σ ‖f_j − g_j‖_V), g = max(−m, 0)/m_A ≤ ω.

    u has the load of the setup, as fast as T wants it, v another one or another start.
    """
    space, steps, pace = setup.space, steps_for(law, T), setup.problem.T / T
    problem = replace(SemiDiscrete.of(space, law, lambda t: setup.problem.load(t * pace), setup.problem.u0), T=T)
    trajectory = list(BACKWARD_EULER.march(problem, steps))
    field = along_the_contact(problem, smooth(space, np.random.default_rng(SEED)))
    sideways = Perturbation(np.zeros(space.dofs), 0.0, problem.u0 + field)
    damping = (1 - law.growth * T / steps) ** np.arange(1, steps + 1)
    others = *islice(perturbations(problem, space), KINDS), sideways
    return float(max((damping * quotients(problem, trajectory, other)).max() for other in others))
