"""(4.4) and Theorem 2.2 for softening materials: two solutions diverge like e^{ct}, and never faster than e^{ωt}.

(4.4) says that B + ωI is monotone for ω = L_G/m_A. Then Theorem 2.2 says for two solutions of Problem 5.1

    ‖u(t) − v(t)‖_V ≤ e^{ωt} (‖u_0 − v_0‖_V + ∫_0^t ‖f − g‖_V).

For a monotone G this holds even with ω = 0. Therefore the test uses two laws with G that is not monotone: the law of a
case that softens, with G scaled such that L_G/m_A = ω, and an *even* law, A τ = 2τ and G τ = −2ω τ. T and ω vary over
two decades. Predicted before measuring:

* *Even law.* B = −ωI. If u_0 − v_0 moves no vertex of Γ3 along ν, both solutions have the same contact forces, so
  u − v = e^{ωt} (u_0 − v_0), wherever contact occurs. The bound is attained, so no smaller ω is possible.
* *Law of the case.* A load presses Γ3 so hard that no vertex leaves the foundation. The difference of two starts along
  an eigenvector of G'(S) against M in {v : Nv = 0} grows like e^{ct} as long as the material softens, where −c is the
  least eigenvalue. The rate c is computed without time steps. It satisfies c ≤ max(−m, 0)/m_A ≤ ω, where m is the
  constant of monotonicity of G.
* *Other pairs of solutions*, with different loads or initial displacements and with the moving contact of the case:
  their distance never exceeds the bound.

*In time.* A step of the midpoint rule multiplies an eigenvector by (1 + z/2)/(1 − z/2), z = ck. So the measured rate is
c (1 + z²/12 + …), too large by 3.3e-4 for z ≤ 1/16. A step of backward Euler is the resolvent of an operator that is
monotone except for gI, g = max(−m, 0)/m_A ≤ ω: it multiplies differences by at most 1/(1 − gk). So the bound with these
factors for e^{ωt}, which is smaller, holds for the steps without an error in time, and the even law attains it.
"""

import math
from dataclasses import replace
from itertools import islice

import numpy as np
from scipy.linalg import eigh, null_space

from manufactured.law import (
    AtPoints,
    Combined,
    Elasticity,
    Indefinite,
    KelvinVoigt,
    Linear,
    Yield,
    isotropic,
    isotropic_matrix,
)
from manufactured.tensors import Array, Tensors, size
from study.fem.naming import resolve
from study.fem.space import Space, form
from study.ledger.check import consequence, identity, paper_claim
from study.ledger.quantities import values
from study.ledger.window import Window, around, positive_at_most
from study.solve.evolution import SemiDiscrete
from study.solve.paths import path
from study.solve.tableau import BACKWARD_EULER, MIDPOINT
from study.statements.shared.base import SEED, SOFTENING, ListedNumbers, Numbers, Setting, grid, with_h
from study.statements.shared.experiment import Experiment, with_cached_loads
from study.statements.shared.norms import maximum, norm
from study.statements.wellposed import Perturbation, along_the_contact, perturbations, quotients, smooth

SWEEP = tuple((omega, T) for omega in (0.1, 1.0, 10.0) for T in (0.1, 1.0, 10.0) if omega * T <= 10)
"""The pairs (ω, T) of rates and final times. ωT is between 1/100 and 10, so e^{ωT} is at most 2e4."""
SHORT = 16
"""Smallest number of time steps in an interval of length 1/ω and in [0, T]."""
KINDS = 5
"""Number of perturbations of the data, one of each kind."""
SMALL = 0.01
"""Largest strain at the final time of the solution along an eigenvector. It is so small that the law is linear."""
SEEN = around(1, 1e-3, "the midpoint rule changes the rate by at most 3.3e-4")
GROWTH = "measured growth rate of ‖u − v‖_V / predicted rate"
DISTANCE = "largest ‖u − v‖_V / its bound, u and v with different loads or initial displacements"
ALL = "for every ω and T"


def derivative(operator: AtPoints, strain: Tensors) -> Array:
    """Return the derivative of an operator at n strain tensors, as one D × D matrix for each tensor, (n, D, D).

    Args:
        operator: the operator.
        strain: the strain tensors, with D components each, (D, n).
    """
    units = np.eye(len(strain))
    columns = [operator.derivative(strain, np.broadcast_to(unit[:, None], strain.shape)) for unit in units]
    return np.moveaxis(np.stack(columns, axis=1), 2, 0)


def column(law: str, what: str, omega: float, T: float) -> str:
    """Return the name of the column with a measured number of a law for one pair (ω, T)."""
    return f"{law} {what}, ω = {omega:g}, T = {T:g}"


def columns(law: str, what: str, pairs: tuple[tuple[float, float], ...] = SWEEP) -> list[str]:
    """Return the names of the columns with a measured number of a law, one for each pair (ω, T)."""
    return [column(law, what, omega, T) for omega, T in pairs]


class SolutionDivergence(ListedNumbers):
    """Measures how fast two solutions diverge.

    Rates of growth are divided by predicted rates, and distances of solutions by their bound.
    """

    label = "Thm 2.2, (4.4)"
    effort = 150
    claim = (
        "if G softens, the distance of two solutions may grow like e^{ct} with a computable rate c, and it never grows "
        "faster than e^{ωt} with ω = L_G/m_A"
    )
    checks = (
        consequence("rate", f"{GROWTH} c, scaled law of the case, {ALL}", values(*columns("own", "rate")), SEEN),
        consequence("rate-even", f"{GROWTH} ω, law G = −ωA, {ALL}", values(*columns("even", "rate")), SEEN),
        paper_claim(
            "bound",
            f"{DISTANCE}, scaled law of the case, {ALL}",
            values(*columns("own", "bound")),
            positive_at_most(1 + 1e-7, "proved; tolerance for fixed-point iterations"),
        ),
        identity(
            "bound-even",
            f"{DISTANCE}, law G = −ωA, {ALL}",
            values(*columns("even", "bound")),
            Window(1 - 1e-7, 1 + 1e-7, "equality up to rounding, because B = −ωI"),
        ),
    )
    quick = grid(("softening",), ("shaken",), (4,))
    full = grid(SOFTENING, ("unstructured",), (6, 12))

    def measure(self, setting: Setting) -> Numbers:
        setup = Experiment.at(setting, MIDPOINT, 1)
        law = resolve(setting.case).solution.law
        setup = replace(setup, problem=with_cached_loads(setup.problem, 9))
        found: Numbers = {}
        for omega, T in SWEEP:
            for name, mine in (("own", scaled(law, omega)), ("even", even_law(law.dim, omega))):
                found[column(name, "rate", omega, T)] = growth_rate(setup.space, mine, T)
                found[column(name, "bound", omega, T)] = over_bound(setup, mine, T)
        return with_h(setup.space.h, found)


def even_law(dim: int, omega: float) -> KelvinVoigt:
    """Return the softening law with A τ = 2τ and G τ = −2ω τ, for which all differences grow at the rate ω."""
    return KelvinVoigt(isotropic(1, 0, dim), Indefinite(isotropic_matrix(-omega, 0, dim)), "even")


def scaled(law: KelvinVoigt, omega: float) -> KelvinVoigt:
    """Return a law with its elasticity G multiplied by a number such that L_G/m_A = ω.

    Raises:
        TypeError: G is neither linear nor combined.
    """
    factor = omega / law.kappa
    G = law.G
    if isinstance(G, Combined):
        yielding = Yield(factor * G.yielding.beta, G.yielding.convex)
        multiple: Elasticity = Combined(factor * G.prestress, Indefinite(factor * G.linear.matrix), yielding)
    elif isinstance(G, Linear):
        multiple = Indefinite(factor * G.matrix, G.factor)
    else:
        raise TypeError(f"no multiple of {type(G).__name__} is known; take one that is linear or combined")
    return KelvinVoigt(law.A, multiple, law.name)


def softest_mode(space: Space, law: KelvinVoigt) -> tuple[float, Array, Array]:
    """Return the displacement that grows fastest while all contact vertices stay in contact (Nv = 0).

    The law is linearised at zero strain.

    Returns:
        The rate of growth c; the displacement v, (dofs,); and the contact force that enforces Nv = 0, (m,). Among the
        displacements with Nv = 0, v is the eigenvector of G'(0) with respect to M with the smallest eigenvalue, −c.
    """
    slope = derivative(law.G.at(space.mesh.p[:, :1]), np.zeros((size(space.dim), 1)))[0]
    M = form(space, law.A).toarray()
    G = space.form(slope).toarray()
    N = space.N.toarray()
    Z = null_space(N)
    values, vectors = eigh(Z.T @ G @ Z, Z.T @ M @ Z, subset_by_index=[0, 0])
    c = -float(values[0])
    v = Z @ vectors[:, 0]
    return c, v, -np.linalg.pinv(N.T) @ (c * (M @ v) + G @ v)


def steps_for(law: KelvinVoigt, T: float) -> int:
    """Return a number of time steps such that a step is at most the fraction 1/SHORT of 1/ω and of T."""
    return math.ceil(SHORT * max(law.kappa * T, 1.0))


def growth_rate(space: Space, law: KelvinVoigt, T: float) -> float:
    """Return the measured rate of growth of a perturbation divided by the predicted rate c.

    The quotient is log(‖v(T)‖/‖v(0)‖)/(cT). The perturbation v is the difference of two solutions, one of which is 0 at
    all times; v(0) is a multiple of the softest mode. The load presses both solutions onto the foundation with twice
    the force that the mode needs, and balances the stress at zero strain.
    """
    c, v, force = softest_mode(space, law)
    strain = abs(space.strain(v)).max()
    start = SMALL * math.exp(-c * T) / strain * v
    pressing = space.N.T @ np.full(len(force), 2 * SMALL * abs(force).max() / strain)
    problem = SemiDiscrete.of(space, law, lambda t: np.zeros(space.dofs), start)
    rest = problem.elastic(np.zeros(space.dofs))
    problem = replace(problem, T=T, load=lambda t: rest + math.exp(c * (t - T)) * pressing)
    states = path(problem, MIDPOINT, steps_for(law, T))
    return math.log(norm(problem, states[-1]) / norm(problem, states[0])) / (c * T)


def over_bound(setup: Experiment, law: KelvinVoigt, T: float) -> float:
    """Return the largest quotient (distance of two solutions) / bound, for backward Euler.

    The bound of ‖u_n − v_n‖_V is (1 − gk)^{−n} (‖u_0 − v_0‖_V + k Σ ‖f_j − g_j‖_V). The number g is
    max(−m, 0)/m_A ≤ ω with the monotonicity constant m of G; f_j and g_j are the loads of u and v. The solution u has
    the load of the experiment, with time scaled to T; v has another load or another initial value.
    """
    space = setup.space
    steps = steps_for(law, T)
    pace = setup.problem.T / T
    problem = replace(SemiDiscrete.of(space, law, lambda t: setup.problem.load(t * pace), setup.problem.u0), T=T)
    trajectory = list(BACKWARD_EULER.march(problem, steps))
    field = along_the_contact(problem, smooth(space, np.random.default_rng(SEED)))
    sideways = Perturbation(np.zeros(space.dofs), 0.0, problem.u0 + field)
    damping = (1 - law.growth * T / steps) ** np.arange(1, steps + 1)
    others = *islice(perturbations(problem, space), KINDS), sideways
    return maximum((damping * quotients(problem, trajectory, other)).max() for other in others)
