"""Chapters 2 to 4: Korn's inequality, bounded velocities, continuous dependence on the data, and its rate.

The statements are (2.17), (4.1), Theorem 2.2, and Theorem 2.2 with (4.4) for materials that soften.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np
import pandas as pd
from scipy.linalg import eigh, null_space

from manufactured.law import (
    Combined,
    Elasticity,
    Indefinite,
    KelvinVoigt,
    Linear,
    Yield,
    isotropic,
    isotropic_matrix,
)
from manufactured.tensors import Array, size
from study.fem.naming import resolve
from study.fem.space import Space, form
from study.ledger.check import MIN_LEVELS, ROUNDING_ROOM, consequence, identity, paper_claim
from study.ledger.quantities import finest, ratios
from study.ledger.window import Window, around, at_most, positive_at_most
from study.solve.evolution import FIXED_POINT, SemiDiscrete, State
from study.solve.factorisation import Cholesky
from study.solve.paths import path
from study.solve.signorini import Signorini
from study.solve.tableau import BACKWARD_EULER, MIDPOINT
from study.statements.shared.base import (
    EVOLVING,
    SEED,
    SOFTENING,
    Experiment,
    ListedNumbers,
    Numbers,
    Setting,
    grid,
    with_h,
)
from study.statements.shared.meshes import body_of, first_with_each, place, space_of
from study.statements.shared.norms import (
    Energies,
    dual_norm,
    h1_product,
    maximum,
    norm,
    norms,
    smallest,
    strain_product,
)
from study.statements.shared.scope import REGULAR

VALUE = "smallest eigenvalue"
EIGENVALUE_LIMIT = Window(0.7, 1.0, "of the value on the finest level")
"""Window of (limit of the eigenvalue for h → 0) / (value on the finest level).

Eigenvalues that tend to zero leave the window. Values like h^p extrapolate to 0. The slowest decay is 1/(c + |log h|),
which occurs if Γ1 is a point; it extrapolates to less than 0.7 of the last value."""


def extrapolated(table: pd.DataFrame) -> float:
    """Return the extrapolated limit of the eigenvalue for h → 0, divided by its value on the finest level.

    The limit is computed by Aitken's extrapolation of the last three values. It is −∞ if their differences do not
    shrink.
    """
    first, second, last = table[VALUE].to_numpy()[-3:]
    before = first - second
    drop = second - last
    return float((last - drop**2 / (before - drop)) / last if before > drop else -math.inf)


class Korn(ListedNumbers):
    """Measures the square of Korn's constant on V^h, min ‖ε(v)‖_Q² / ‖v‖_{H_1}², for each body.

    Korn's inequality (2.17), and the equivalence (3.6) of the norms ‖·‖_V and ‖·‖_{H_1} that follows from it.

    Both are tested on the P1 space V^h ⊂ V. The minimum over V^h is an upper bound of the square of the constant C_K in
    (2.17):

        C_K² = inf_{v ∈ V} ‖ε(v)‖_Q² / ‖v‖_{H_1}² ≤ min_{v ∈ V^h} ‖ε(v)‖_Q² / ‖v‖_{H_1}².

    The minimum is the smallest eigenvalue of (ε(·), ε(·))_Q with respect to the inner product of H_1. It falls under
    refinement; for nested spaces it cannot rise. By (2.17) its limit for h → 0 is positive. With (3.1)

        m_A C_K² ‖v‖_{H_1}² ≤ ‖v‖_V² ≤ ‖A‖ ‖v‖_{H_1}²

    on V^h. Here C_K is the constant of V^h, which is bounded below uniformly in h.
    """

    label = "(2.17)"
    claim = "‖ε(v)‖_Q ≥ C_K ‖v‖_{H_1} on V, C_K > 0"
    checks = (
        identity(
            "falling",
            f"{VALUE} / value on the next coarser level",
            ratios(VALUE),
            at_most(1 + ROUNDING_ROOM, "on every level"),
            levels=2,
        ),
        paper_claim("limit", f"limit of the {VALUE} for h → 0", extrapolated, EIGENVALUE_LIMIT, levels=MIN_LEVELS),
    )

    def places(self, full: bool) -> list[Setting]:
        bodies = first_with_each(body_of)
        return place(bodies, REGULAR, (8, 16, 32, 64), (2, 4, 8)) if full else place(bodies, REGULAR, (4, 8, 16))

    def measure(self, setting: Setting) -> Numbers:
        space = space_of(setting)
        return with_h(space.h, {VALUE: smallest(strain_product(space), h1_product(space))})


FEW_CASES = ("advance-recede", "yield-on-a-part")
"""The cases of the quick study: one has a linear law, one the nonlinear law (3.3)."""

# (4.1): the velocity is bounded, u ∈ W^{1,∞}(0,T;V).

STEPS_BY_K = {"k": 24, "k/2": 48, "k/4": 96}
SUPREMUM_AT = 192
"""Number of time intervals at whose ends the exact velocity is evaluated for its supremum over time.

It is twice the largest number of time steps of u^h."""


class BoundedVelocity(ListedNumbers):
    """Measures the largest discrete velocity divided by the largest exact velocity, for several k and h.

    The quotient is max_n ‖δu_n‖_V / sup_t ‖u̇(t)‖_V with δu_n = (u_n − u_{n−1})/k. For an initial value outside K^h it
    would grow like 1/k. If velocities are bounded, so are stresses, σ ∈ L^∞(0,T;Q), by (3.1) and (3.2).
    """

    label = "(4.1)"
    claim = "u^h ∈ W^{1,∞}(0,T;V) uniformly in h and k, for solutions with a bounded u̇"
    checks = (
        paper_claim(
            "bounded",
            "max_n ‖δu_n‖_V / sup_t ‖u̇(t)‖_V, all k",
            [*STEPS_BY_K],
            Window(0.5, 1.5, "for all h and k"),
        ),
        consequence(
            "limit",
            "max_n ‖δu_n‖_V / sup_t ‖u̇(t)‖_V, finest h and k",
            finest(list(STEPS_BY_K)[-1]),
            around(1, 0.1, "u̇^h → u̇, and u̇ is continuous except at isolated times"),
        ),
    )
    quick = grid(FEW_CASES, ("shaken",), (8, 16))
    full = grid((*EVOLVING, "lift-and-land", *SOFTENING), ("unstructured",), (8, 16, 32))

    def setup(self, setting: Setting) -> Experiment:
        return Experiment.at(setting, BACKWARD_EULER, 1)

    def measure(self, setup: Experiment) -> Numbers:
        energies = Energies(setup.solution, setup.space, along=())
        exact = energies.velocity_norm(np.linspace(0, setup.problem.T, SUPREMUM_AT + 1)).max()
        return with_h(setup.space.h, {k: fastest(setup.problem, steps) / exact for k, steps in STEPS_BY_K.items()})


def fastest(problem: SemiDiscrete, steps: int) -> float:
    """Return the largest discrete velocity ‖(u_n − u_{n−1})/k‖_V of backward Euler over all steps."""
    increments = np.diff(path(problem, BACKWARD_EULER, steps), axis=0)
    return float(norms(problem, increments).max()) * steps / problem.T


# Theorem 2.2: continuous dependence on f and u_0.

PERTURBATION_SIZES = (0.1, 1.0, 10.0)
"""Sizes of the perturbations of load and initial displacement, relative to the data."""
NEVER = positive_at_most(1 + 1e-7, f"tolerance for fixed-point iterations that stop at {FIXED_POINT:g}")


@dataclass(frozen=True, eq=False)
class Perturbation:
    """Perturbed data of a contact problem: another load and another initial displacement.

    Attributes:
        force, frequency: the load F(t) is replaced by F(t) + cos(ωt) · force with the frequency ω.
        start: the initial displacement, which is in K^h.
    """

    force: Array
    frequency: float
    start: Array

    def change(self, time: Array | float) -> Array:
        """Return the change of the load, cos(ωt) · force, (dofs,), or (dofs, n) for n times."""
        return np.multiply.outer(self.force, np.cos(self.frequency * time))


class Dependence(ListedNumbers):
    """Tests how far apart two solutions can be whose loads f, g and initial displacements u_0, v_0 differ.

    Tested is the bound ‖u(t) − v(t)‖_V ≤ e^{ωt} (‖u_0 − v_0‖_V + ∫_0^t ‖f − g‖_V ds). In Theorem 2.2 the number ω makes
    A + ωI monotone; for A = ∂ψ_K + B the paper takes ω = L_G/m_A, (4.5). One step of backward Euler is the resolvent of
    A. So for monotone G the bound also holds for u_n and v_n, if the sum of k ‖f(t_j) − g(t_j)‖_V replaces the
    integral, and even with ω = 0. The norm ‖f − g‖_V is the dual norm (FᵀM⁻¹F)^{1/2} on V^h.
    """

    label = "Thm 2.2"
    claim = "u^h depends continuously on f and u_0, with the rate ω = L_G/m_A: what Thm 2.2 gives on V^h"
    checks = (
        paper_claim("bound", "‖u − v‖_V / e^{ωt}(‖u_0 − v_0‖_V + ∫‖f − g‖_V), ω = L_G/m_A", "bound", NEVER),
        paper_claim(
            "monotone",
            "‖u − v‖_V / (‖u_0 − v_0‖_V + ∫‖f − g‖_V), ω = 0, allowed by monotone G",
            "monotone",
            NEVER,
        ),
        consequence(
            "first-step",
            "‖u − v‖_V / its bound after one step, ω = L_G/m_A, f − g constant and not acting on the contact",
            "first step",
            Window(0.5, 1 + 1e-7, "without contact it is at least e^{−ωk}/(1 + ωk), ωk ≤ 1/4"),
        ),
    )
    quick = grid(FEW_CASES, ("unstructured",), (6,))
    full = (
        *grid((*EVOLVING, "heterogeneous", "corner"), ("unstructured",), (6, 12)),
        *grid(("cube-disc",), ("shaken",), (3,)),
    )

    def setup(self, setting: Setting) -> Experiment:
        solution = resolve(setting.case).solution
        return Experiment.at(setting, BACKWARD_EULER, max(12, math.ceil(4 * solution.law.kappa * solution.body.T)))

    def measure(self, setup: Experiment) -> Numbers:
        omega = setup.solution.law.kappa
        trajectory = list(setup.march(setup.steps))
        others = perturbations(setup.problem, setup.space)
        ratios = np.array([quotients(setup.problem, trajectory, other) for other in others])
        damped = ratios * np.exp(-omega * np.array([state.time for state in trajectory[1:]]))
        return with_h(setup.space.h, {"bound": damped.max(), "monotone": ratios.max(), "first step": damped[0, 0]})


def quotients(problem: SemiDiscrete, trajectory: list[State], other: Perturbation) -> Array:
    """Return the distance of two discrete solutions divided by the size of the perturbation, for each step, (steps,).

    The quotients are ‖u_n − v_n‖_V / (‖u_0 − v_0‖_V + k Σ_{j ≤ n} ‖f(t_j) − g(t_j)‖_V) for n = 1, 2, …

    Args:
        problem: the unperturbed problem.
        trajectory: its solution u_n by backward Euler.
        other: the perturbation.
    """
    steps = len(trajectory) - 1
    riesz = Cholesky(problem.M)
    changed = replace(problem, load=lambda t: problem.load(t) + other.change(t), u0=other.start)
    distances = norms(problem, np.array([state.u for state in trajectory]) - path(changed, BACKWARD_EULER, steps))
    loads = [dual_norm(other.change(state.time), riesz) for state in trajectory[1:]]
    return distances[1:] / (distances[0] + problem.T / steps * np.cumsum(loads))


def perturbations(problem: SemiDiscrete, space: Space) -> Iterator[Perturbation]:
    """Yield perturbations of loads and initial values.

    The first perturbation is a constant load that moves no vertex of Γ3 along ν.
    """
    rng = np.random.default_rng(SEED)
    riesz = Cholesky(problem.M)
    onto = Signorini(problem.M, problem.N)
    load = maximum(norm(problem, f) for f in riesz(problem.load(np.linspace(0, problem.T, 9)).T))
    pressing = riesz(problem.N.T @ np.ones(problem.N.shape[0]))
    for relative in PERTURBATION_SIZES:
        fields = along_the_contact(problem, smooth(space, rng)), smooth(space, rng), pressing, -pressing
        for field, frequency in zip(fields, (0.0, 7.0, 7.0, 0.0), strict=True):
            yield Perturbation(problem.M @ field * (relative * load / norm(problem, field)), frequency, problem.u0)
        field = smooth(space, rng)
        start, _ = onto(problem.M @ (problem.u0 + field * (relative * load / norm(problem, field))))
        yield Perturbation(np.zeros(space.dofs), 0.0, start)


def smooth(space: Space, rng: np.random.Generator) -> Array:
    """Return a random smooth displacement: the interpolant of a few waves, set to zero at the clamped vertices."""
    low = space.mesh.p.min(axis=1)
    high = space.mesh.p.max(axis=1)
    x = (space.mesh.p - low[:, None]) / (high - low)[:, None]
    waves = rng.uniform(-np.pi, np.pi, (4, space.dim)) @ x + rng.uniform(0, 2 * np.pi, (4, 1))
    return space.interpolate(rng.standard_normal((space.dim, 4)) @ np.cos(waves))


def along_the_contact(problem: SemiDiscrete, v: Array) -> Array:
    """Return a displacement v with its normal components at the vertices of Γ3 removed."""
    N = problem.N.toarray()
    return v - np.linalg.pinv(N) @ (N @ v)


SWEEP = tuple((omega, T) for omega in (0.1, 1.0, 10.0) for T in (0.1, 1.0, 10.0) if omega * T <= 10)
"""The pairs (ω, T) of rates and final times. ωT is between 1/100 and 10, so e^{ωT} is at most 2e4."""
SHORT = 16
"""Smallest number of time steps in an interval of length 1/ω and in [0, T]."""
PERTURBATION_KINDS = 5
"""Number of perturbations of the data, one of each kind."""
SMALL_STRAIN = 0.01
"""Largest strain at the final time of the solution along an eigenvector. It is so small that the law is linear."""
RATE_SEEN = around(1, 1e-3, "the midpoint rule changes the rate by at most 3.3e-4")
GROWTH_OVER_RATE = "measured growth rate of ‖u − v‖_V / predicted rate"
DISTANCE_OVER_BOUND = "largest ‖u − v‖_V / its bound, u and v with different loads or initial displacements"
EVERY_RATE = "for every ω and T"


def column(law: str, what: str, omega: float, T: float) -> str:
    """Return the name of the column with a measured number of a law for one pair (ω, T)."""
    return f"{law} {what}, ω = {omega:g}, T = {T:g}"


def columns(law: str, what: str) -> list[str]:
    """Return the names of the columns with a measured number of a law, one for each pair (ω, T)."""
    return [column(law, what, omega, T) for omega, T in SWEEP]


class SolutionDivergence(ListedNumbers):
    """Measures how fast two solutions diverge.

    Rates of growth are divided by predicted rates, and distances of solutions by their bound.

    (4.4) and Theorem 2.2 for softening materials: two solutions diverge like e^{ct}, and never faster than e^{ωt}.

    (4.4) says that B + ωI is monotone for ω = L_G/m_A. Then Theorem 2.2 says for two solutions of Problem 5.1

        ‖u(t) − v(t)‖_V ≤ e^{ωt} (‖u_0 − v_0‖_V + ∫_0^t ‖f − g‖_V).

    For a monotone G this holds even with ω = 0. Therefore the test uses two laws whose G is not monotone. One is the
    law of a case that softens, with G scaled such that L_G/m_A = ω. The other is an *even* law, A τ = 2τ and G τ = −2ω
    τ. T and ω vary over two decades. Predicted before measuring:

    * *Even law.* B = −ωI. Let u_0 − v_0 move no vertex of Γ3 along ν. Then both solutions have the same contact forces,
      and u − v = e^{ωt} (u_0 − v_0), wherever contact occurs. The bound is attained, so no smaller ω is possible.
    * *Law of the case.* A load presses Γ3 so hard that no vertex leaves the foundation. The difference of two starts
      along an eigenvector of G'(S) against M in {v : Nv = 0} grows like e^{ct} as long as the material softens, where
      −c is the least eigenvalue. The rate c is computed without time steps. It satisfies c ≤ max(−m, 0)/m_A ≤ ω, where
      m is the constant of monotonicity of G.
    * *Other pairs of solutions*, with different loads or initial displacements and with the moving contact of the case:
      their distance never exceeds the bound.

    *In time.* A step of the midpoint rule multiplies an eigenvector by (1 + z/2)/(1 − z/2), z = ck. So the measured
    rate is c (1 + z²/12 + …), too large by 3.3e-4 for z ≤ 1/16. A step of backward Euler is the resolvent of an
    operator that becomes monotone if gI is added, g = max(−m, 0)/m_A ≤ ω. It multiplies differences by at most 1/(1 −
    gk). So the bound with these factors for e^{ωt}, which is smaller, holds for the steps without an error in time, and
    the even law attains it.
    """

    label = "Thm 2.2, (4.4)"
    effort = 150
    claim = (
        "if G softens, the distance of two solutions may grow like e^{ct} with a computable rate c, and it never grows "
        "faster than e^{ωt} with ω = L_G/m_A"
    )
    checks = (
        consequence(
            "rate",
            f"{GROWTH_OVER_RATE} c, scaled law of the case, {EVERY_RATE}",
            columns("own", "rate"),
            RATE_SEEN,
        ),
        consequence(
            "rate-even", f"{GROWTH_OVER_RATE} ω, law G = −ωA, {EVERY_RATE}", columns("even", "rate"), RATE_SEEN
        ),
        paper_claim(
            "bound",
            f"{DISTANCE_OVER_BOUND}, scaled law of the case, {EVERY_RATE}",
            columns("own", "bound"),
            positive_at_most(1 + 1e-7, "proved; tolerance for fixed-point iterations"),
        ),
        identity(
            "bound-even",
            f"{DISTANCE_OVER_BOUND}, law G = −ωA, {EVERY_RATE}",
            columns("even", "bound"),
            Window(1 - 1e-7, 1 + 1e-7, "equality up to rounding, because B = −ωI"),
        ),
    )
    quick = grid(("softening",), ("shaken",), (4,))
    full = grid(SOFTENING, ("unstructured",), (6, 12))

    def measure(self, setting: Setting) -> Numbers:
        setup = Experiment.at(setting, MIDPOINT, 1)
        law = resolve(setting.case).solution.law
        numbers: Numbers = {}
        for omega, T in SWEEP:
            for name, softening in (("own", scaled(law, omega)), ("even", even_law(law.dim, omega))):
                numbers[column(name, "rate", omega, T)] = growth_rate(setup.space, softening, T)
                numbers[column(name, "bound", omega, T)] = over_bound(setup, softening, T)
        return with_h(setup.space.h, numbers)


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
    units = np.eye(size(space.dim))[..., None]
    at_point = law.G.at(space.mesh.p[:, :1])
    slope = np.hstack([at_point.derivative(0 * unit, unit) for unit in units])
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
    start = SMALL_STRAIN * math.exp(-c * T) / strain * v
    pressing = space.N.T @ np.full(len(force), 2 * SMALL_STRAIN * abs(force).max() / strain)
    problem = SemiDiscrete.of(space, law, lambda t: np.zeros((space.dofs, t.size)), start)
    rest = problem.elastic(np.zeros(space.dofs))
    problem = replace(problem, T=T, load=lambda t: rest[:, None] + np.multiply.outer(pressing, np.exp(c * (t - T))))
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
    others = *islice(perturbations(problem, space), PERTURBATION_KINDS), sideways
    return maximum((damping * quotients(problem, trajectory, other)).max() for other in others)
