"""Chapters 2 to 4: Korn's inequality, dependence on the data, uniqueness, and regularity in time.

The statements are (2.17), (4.1), Theorem 2.2, and Theorem 2.2 with (4.4) for materials that soften.

Theorems 4.1, 4.3 and 5.2 say that there is only one solution, so different solvers must give the same result. For
Theorems 4.1 and 5.2 displacements are compared that solve Problem 3.1 on V^h. For Theorem 4.3 stresses are compared
that solve Problem 3.2 in a conforming stress space, without displacements.

The last statements are the regularity in time of the load and of the traction, (3.8), (5.9) and (4.12), and the
traction conditions (4.13).
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import islice, pairwise

import clarabel
import numpy as np
import pandas as pd
import scipy.sparse as sps
from scipy.linalg import cho_solve, cholesky, eigh, null_space, solve_triangular
from scipy.optimize import nnls

from manufactured.body import Body, Kind, Part
from manufactured.catalogue import catalogue
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
from manufactured.tensors import Array, Points, Tensors, Vectors, mandel, size, traction
from study.fem.error_norm import FACET_POINTS, ErrorNorm
from study.fem.mesh import size as mesh_size
from study.fem.naming import resolve
from study.fem.quadrature import rule_on
from study.fem.space import Space, form, on_cells
from study.ledger.check import MIN_LEVELS, ROUNDING_ROOM, Check, Groups, consequence, identity, paper_claim
from study.ledger.quantities import change, finest, ratios
from study.ledger.window import Window, around, at_most, between, positive_at_most
from study.solve.evolution import FIXED_POINT, SemiDiscrete, furthest, norm, path
from study.solve.factorisation import Cholesky
from study.solve.signorini import ContactSolution, Signorini
from study.solve.stress_problem import Accuracy, settings
from study.solve.tableau import BACKWARD_EULER, MIDPOINT
from study.statements.shared.base import (
    EVOLVING,
    SEED,
    SOFTENING,
    Experiment,
    Judged,
    ListedNumbers,
    Numbers,
    Setting,
    check_of_order,
    grid,
    with_h,
)
from study.statements.shared.meshes import CELL_POWER, body_of, first_with_each, named, place, posed, space_of
from study.statements.shared.norms import (
    Energies,
    Field,
    dual_norm,
    h1_product,
    maximum,
    smallest,
    strain_product,
    time_nodes,
    unloaded,
)
from study.statements.thm_4_2 import StressExperiment, norm_in_q

VALUE = "smallest eigenvalue"
EIGENVALUE_LIMIT = Window(0.7, 1.0, "of the value on the finest level")
"""Window of (limit of the eigenvalue for h → 0) / (value on the finest level).

Eigenvalues that tend to zero leave the window. Values like h^p extrapolate to 0. The slowest decay is 1/(c + |log h|),
which occurs if Γ1 is a point; it extrapolates to less than 0.7 of the last value."""


def extrapolated(table: pd.DataFrame) -> float:
    """Return the limit for h → 0 of the smallest eigenvalue in ``Korn``, divided by its value on the finest level.

    The limit is computed by Aitken's extrapolation of the last three values. The result is −∞ if the differences of the
    values do not shrink.

    Args:
        table: the eigenvalues of one body, with one row for each level from coarse to fine, in the column ``VALUE``.
    """
    first, second, last = table[VALUE].to_numpy()[-3:]
    before = first - second
    drop = second - last
    return float((last - drop**2 / (before - drop)) / last if before > drop else -math.inf)


class Korn(ListedNumbers):
    """Measures the square of Korn's constant on V^h, min ‖ε(v)‖_Q² / ‖v‖_{H_1}², for each body.

    Korn's inequality (2.17) is tested, and the equivalence (3.6) of the norms ‖·‖_V and ‖·‖_{H_1} that follows from it.

    **Measured** is the minimum over the P1 space V^h ⊂ V. It is the smallest eigenvalue of (ε(·), ε(·))_Q with respect
    to the inner product of H_1, and an upper bound of the square of the constant C_K in (2.17):

        C_K² = inf_{v ∈ V} ‖ε(v)‖_Q² / ‖v‖_{H_1}² ≤ min_{v ∈ V^h} ‖ε(v)‖_Q² / ‖v‖_{H_1}².

    **Predicted**: the minimum falls under refinement; for nested spaces it cannot rise. Its limit for h → 0 is positive
    by (2.17). Then (3.6) holds on V^h uniformly in h: with C_K of V^h, (3.1) gives

        m_A C_K² ‖v‖_{H_1}² ≤ ‖v‖_V² ≤ ‖A‖ ‖v‖_{H_1}².
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
        if full:
            return place(first_with_each(body_of), (8, 16, 32, 64), (2, 4, 8))
        return place(named("full-contact", "corner", "hexagon", "junction"), (4, 8, 16))

    def measure(self, setting: Setting) -> Numbers:
        space = space_of(setting)
        return with_h(space.h, {VALUE: smallest(strain_product(space), h1_product(space))})


QUICK_CASES = ("advance-recede", "yield-on-a-part")
"""The cases of the quick study: one has a linear law, one the nonlinear law (3.3)."""

# (4.1): the velocity is bounded, u ∈ W^{1,∞}(0,T;V).

STEPS_BY_K = {"k": 24, "k/2": 48, "k/4": 96}
SUPREMUM_AT = 192
"""Number of time intervals at whose ends the exact velocity is evaluated for its supremum over time.

It is twice the largest number of time steps of u^h."""


class BoundedVelocity(ListedNumbers):
    """Measures the largest discrete velocity of backward Euler divided by the largest exact velocity.

    **Measured** is max_n ‖δu_n‖_V / sup_t ‖u̇(t)‖_V with δu_n = (u_n − u_{n−1})/k, for several time steps k and mesh
    sizes.

    **Predicted**: the quotient is between 1/2 and 3/2 for all of them, and 1 ± 0.1 for the finest mesh and the shortest
    step, because u̇^h → u̇. For an initial value outside K^h it would grow like 1/k. If velocities are bounded, so are
    stresses, σ ∈ L^∞(0,T;Q), by (3.1) and (3.2).
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
    quick = grid(QUICK_CASES, ("shaken",), (8, 16))
    full = grid((*EVOLVING, "lift-and-land", *SOFTENING), ("unstructured",), (8, 16, 32))

    def setup(self, setting: Setting) -> Experiment:
        return Experiment.at(setting, BACKWARD_EULER, 1)

    def measure(self, setup: Experiment) -> Numbers:
        energies = Energies(setup.solution, setup.space, aligned=False)
        exact = energies.velocity_norm(np.linspace(0, setup.problem.T, SUPREMUM_AT + 1)).max()
        return with_h(setup.space.h, {k: fastest(setup.problem, steps) / exact for k, steps in STEPS_BY_K.items()})


def fastest(problem: SemiDiscrete, steps: int) -> float:
    """Return the largest discrete velocity ‖(u_n − u_{n−1})/k‖_V of backward Euler over all steps.

    Args:
        problem: the semi-discrete problem.
        steps: the number of time steps.
    """
    increments = np.diff(path(problem, BACKWARD_EULER, steps), axis=0)
    return float(norm(problem, increments).max()) * steps / problem.T


# Theorem 2.2: continuous dependence on f and u_0.

PERTURBATION_SIZES = (0.1, 1.0, 10.0)
"""Sizes of the perturbations of load and initial displacement, relative to the data."""
NEVER = positive_at_most(1 + 1e-7, f"tolerance for fixed-point iterations that stop at {FIXED_POINT:g}")


class Dependence(ListedNumbers):
    """Measures the distance of solutions with different loads or initial displacements, divided by its bound.

    Theorem 2.2 is about an evolution equation u̇ + 𝒜u ∋ f. If 𝒜 + ωI is monotone, two solutions u and v with loads f, g
    and initial displacements u_0, v_0 satisfy

        ‖u(t) − v(t)‖_V ≤ e^{ωt} (‖u_0 − v_0‖_V + ∫_0^t ‖f − g‖_V ds).

    For the contact problem 𝒜 = ∂ψ_K + B with the indicator function ψ_K of K, and the paper takes ω = L_G/m_A, (4.5).

    **Measured** are quotients of both sides for solutions u_n and v_n of backward Euler; the sum of k ‖f(t_j) −
    g(t_j)‖_V replaces the integral. The norm ‖f − g‖_V is the dual norm (FᵀM⁻¹F)^{1/2} on V^h.

    **Predicted**: the quotient is at most 1 at every step, even with ω = 0, because G is monotone in all cases and one
    step of backward Euler is the resolvent of 𝒜. With ω = L_G/m_A it is at least 1/2 after the first step for a
    perturbation that does not act on the contact: without contact it is at least e^{−ωk}/(1 + ωk).
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
    quick = grid(QUICK_CASES, ("unstructured",), (6,))
    full = (
        *grid((*EVOLVING, "heterogeneous", "corner"), ("unstructured",), (6, 12)),
        *grid(("cube-disc",), ("shaken",), (3,)),
    )

    def setup(self, setting: Setting) -> Experiment:
        solution = resolve(setting.case).solution
        return Experiment.at(setting, BACKWARD_EULER, max(12, math.ceil(4 * solution.law.kappa * solution.body.T)))

    def measure(self, setup: Experiment) -> Numbers:
        omega = setup.solution.law.kappa
        states = np.array([state.u for state in setup.march(setup.steps)])
        others = perturbations(setup.problem, setup.space)
        ratios = np.array([quotients(setup.problem, states, other) for other in others])
        damped = ratios * np.exp(-omega * time_nodes(setup.problem.T, setup.steps)[1:])
        return with_h(setup.space.h, {"bound": damped.max(), "monotone": ratios.max(), "first step": damped[0, 0]})


def quotients(problem: SemiDiscrete, states: Array, other: SemiDiscrete) -> Array:
    """Return the distance of two discrete solutions divided by the size of the perturbation, for each step, (steps,).

    The quotients are ‖u_n − v_n‖_V / (‖u_0 − v_0‖_V + k Σ_{j ≤ n} ‖f(t_j) − g(t_j)‖_V) for n = 1, 2, …, with the
    solutions u_n and v_n of two problems with loads f and g.

    Args:
        problem: the unperturbed problem.
        states: its solution u_n by backward Euler at all time nodes, with u_0 first, (steps + 1, dofs).
        other: the problem with another load or another initial displacement, which is solved here.
    """
    steps = len(states) - 1
    riesz = Cholesky(problem.M)
    times = time_nodes(problem.T, steps)[1:]
    distances = norm(problem, states - path(other, BACKWARD_EULER, steps))
    loads = dual_norm((other.load(times) - problem.load(times)).T, riesz)
    return distances[1:] / (distances[0] + problem.T / steps * np.cumsum(loads))


def with_force(problem: SemiDiscrete, force: Array, frequency: float) -> SemiDiscrete:
    """Return a problem whose load F(t) is replaced by F(t) + cos(ωt) · force.

    Args:
        problem: the semi-discrete problem.
        force: the load vector that is added, (dofs,).
        frequency: the angular frequency ω.
    """
    return replace(
        problem, load=lambda times: problem.load(times) + np.multiply.outer(force, np.cos(frequency * times))
    )


def perturbations(problem: SemiDiscrete, space: Space) -> Iterator[SemiDiscrete]:
    """Yield copies of a problem with perturbed loads, and copies with perturbed initial values in K^h.

    For each of the ``PERTURBATION_SIZES`` there are four perturbed loads and one perturbed initial value. K^h contains
    the admissible P1 displacements. The first perturbation is a constant load that moves no vertex of the contact
    boundary along its normal.

    Args:
        problem: the semi-discrete problem.
        space: the space V^h.
    """
    rng = np.random.default_rng(SEED)
    riesz = Cholesky(problem.M)
    onto = Signorini(problem.M, problem.N)
    load = norm(problem, riesz(problem.load(np.linspace(0, problem.T, 9)).T)).max()
    pressing = riesz(problem.N.T @ np.ones(problem.N.shape[0]))
    for relative in PERTURBATION_SIZES:
        fields = along_the_contact(problem, smooth(space, rng)), smooth(space, rng), pressing, -pressing
        for field, frequency in zip(fields, (0.0, 7.0, 7.0, 0.0), strict=True):
            yield with_force(problem, problem.M @ field * (relative * load / norm(problem, field)), frequency)
        field = smooth(space, rng)
        start, _ = onto(problem.M @ (problem.u0 + field * (relative * load / norm(problem, field))))
        yield replace(problem, u0=start)


def smooth(space: Space, rng: np.random.Generator) -> Array:
    """Return a random smooth displacement: the interpolant of a few waves, set to zero at clamped vertices, (dofs,)."""
    low = space.mesh.p.min(axis=1)
    high = space.mesh.p.max(axis=1)
    x = (space.mesh.p - low[:, None]) / (high - low)[:, None]
    waves = rng.uniform(-np.pi, np.pi, (4, space.dim)) @ x + rng.uniform(0, 2 * np.pi, (4, 1))
    return space.interpolate(rng.standard_normal((space.dim, 4)) @ np.cos(waves))


def along_the_contact(problem: SemiDiscrete, v: Array) -> Array:
    """Return the displacement nearest to v whose normal components at the vertices of Γ3 are 0, (dofs,).

    Nearest means that the vectors of degrees of freedom have the smallest Euclidean distance.

    Args:
        problem: the semi-discrete problem, which has the matrix from displacements to normal components.
        v: the displacement, (dofs,).
    """
    N = problem.N.toarray()
    return v - np.linalg.pinv(N) @ (N @ v)


SWEEP = {
    f"ω = {omega:g}, T = {T:g}": (omega, T) for omega in (0.1, 1.0, 10.0) for T in (0.1, 1.0, 10.0) if omega * T <= 10
}
"""The pairs (ω, T) of rates and final times, by their names in columns.

ωT is between 1/100 and 10, so e^{ωT} is at most 2e4."""
SHORT = 16
"""Least number of time steps in [0, T] and in an interval of the length 1/ω, the time in which solutions diverge."""
PERTURBATION_KINDS = 5
"""Number of perturbations of loads and initial values in ``SolutionDivergence``, one of each kind."""
SMALL_STRAIN = 0.01
"""Largest strain at the final time of the perturbation that ``growth_rate`` follows.

It is so small that the law is linear.
"""
RATE_SEEN = around(1, 1e-3, "the midpoint rule changes the rate by at most 3.3e-4")
GROWTH_OVER_RATE = "measured growth rate of ‖u − v‖_V / predicted rate"
DISTANCE_OVER_BOUND = "largest ‖u − v‖_V / its bound, u and v with different loads or initial displacements"
EVERY_RATE = "for every ω and T"


def columns(quantity: str) -> list[str]:
    """Return the names of the columns of a quantity, one for each pair (ω, T) of ``SWEEP``.

    The quantity "own rate" has the columns "own rate, ω = 0.1, T = 0.1" and so on.
    In a quantity "own" stands for the scaled law of the case, and "even" for the law with G = −ωA.
    """
    return [f"{quantity}, {pair}" for pair in SWEEP]


class SolutionDivergence(ListedNumbers):
    """Measures how fast two solutions of Problem 5.1 diverge, relative to the predicted rate and to a bound.

    (4.4) and Theorem 2.2 for softening materials: two solutions diverge like e^{ct}, and never faster than e^{ωt}.
    (4.4) says that B + ωI is monotone for ω = L_G/m_A. Then Theorem 2.2 says for two solutions of Problem 5.1

        ‖u(t) − v(t)‖_V ≤ e^{ωt} (‖u_0 − v_0‖_V + ∫_0^t ‖f − g‖_V).

    For a monotone G this holds even with ω = 0. Therefore the test uses two laws whose G is not monotone. One is the
    law of a case that softens, with G scaled such that L_G/m_A = ω. The other is an *even* law, A τ = 2τ and G τ = −2ω
    τ.

    **Measured** for each law, and for T and ω that vary over two decades, are

    * the rate at which the difference of two solutions grows, divided by the predicted rate c (``growth_rate``);
    * the largest distance of two solutions, divided by its bound (``over_bound``).

    **Predicted** before measuring:

    * *Even law.* B = −ωI. Let u_0 − v_0 move no vertex of Γ3 along ν. Then both solutions have the same contact forces,
      and u − v = e^{ωt} (u_0 − v_0), wherever contact occurs. So c = ω, the bound is attained, and no smaller ω is
      possible.
    * *Law of the case.* A load presses Γ3 so hard that no vertex leaves the foundation. The difference of two solutions
      that starts along an eigenvector of G'(0), the derivative of G at zero strain, against M in {v : Nv = 0} grows
      like e^{ct} as long as strains are small, where −c is the least eigenvalue. The rate c is computed without time
      steps. It satisfies c ≤ max(−m, 0)/m_A ≤ ω, where m is the constant of monotonicity of G.
    * *Other pairs of solutions*, with different loads or initial displacements and with the moving contact of the case:
      their distance never exceeds the bound.
    * *The error in time.* A step of the midpoint rule multiplies an eigenvector by (1 + z/2)/(1 − z/2), z = ck. So the
      measured rate is c (1 + z²/12 + …), too large by 3.3e-4 for z ≤ 1/16. A step of backward Euler is the resolvent of
      an operator that becomes monotone if gI is added, g = max(−m, 0)/m_A ≤ ω. It multiplies differences by at most
      1/(1 − gk). So the bound with these factors for e^{ωt}, which is smaller, holds for the steps without an error in
      time, and the even law attains it.
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
            columns("own rate"),
            RATE_SEEN,
        ),
        consequence("rate-even", f"{GROWTH_OVER_RATE} ω, law G = −ωA, {EVERY_RATE}", columns("even rate"), RATE_SEEN),
        paper_claim(
            "bound",
            f"{DISTANCE_OVER_BOUND}, scaled law of the case, {EVERY_RATE}",
            columns("own bound"),
            positive_at_most(1 + 1e-7, "proved; tolerance for fixed-point iterations"),
        ),
        identity(
            "bound-even",
            f"{DISTANCE_OVER_BOUND}, law G = −ωA, {EVERY_RATE}",
            columns("even bound"),
            Window(1 - 1e-7, 1 + 1e-7, "equality up to rounding, because B = −ωI"),
        ),
    )
    quick = grid(("softening",), ("shaken",), (4,))
    full = grid(SOFTENING, ("unstructured",), (6, 12))

    def measure(self, setting: Setting) -> Numbers:
        setup = Experiment.at(setting, MIDPOINT, 1)
        law = resolve(setting.case).solution.law
        numbers: Numbers = {}
        for pair, (omega, T) in SWEEP.items():
            for name, softening in (("own", scaled(law, omega)), ("even", even_law(law.dim, omega))):
                numbers[f"{name} rate, {pair}"] = growth_rate(setup.space, softening, T)
                numbers[f"{name} bound, {pair}"] = over_bound(setup, softening, T)
        return with_h(setup.space.h, numbers)


def even_law(dim: int, omega: float) -> KelvinVoigt:
    """Return the softening law with A τ = 2τ and G τ = −2ω τ, for which all differences grow at the rate ω.

    Args:
        dim: the dimension of the body.
        omega: the rate ω.
    """
    return KelvinVoigt(isotropic(1, 0, dim), Indefinite(isotropic_matrix(-omega, 0, dim)), "even")


def scaled(law: KelvinVoigt, omega: float) -> KelvinVoigt:
    """Return a law with its elasticity G multiplied by a number such that L_G/m_A = ω.

    Args:
        law: the law.
        omega: the number ω > 0.

    Raises:
        TypeError: the class of G is neither ``Linear`` nor ``Combined``.
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
    """Return the perturbation of a solution that grows fastest while all contact vertices stay in contact.

    It is a displacement v with Nv = 0, where N is the constraint matrix. The law is linearised at zero strain.

    Args:
        space: the space V^h.
        law: the material law, the same at all points.

    Returns:
        The rate of growth c; the displacement v, (dofs,); and the contact force that enforces Nv = 0, (m,). Among the
        displacements with Nv = 0, v is the eigenvector of the matrix of G'(0) with respect to the matrix M of (·,·)_V
        with the smallest eigenvalue, −c.
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
    """Return a number of time steps such that a step is at most 1/16 of the final time T and of the time 1/ω.

    ω = L_G/m_A is the rate at which differences of solutions may grow for the law. The number 16 is ``SHORT``.
    """
    return math.ceil(SHORT * max(law.kappa * T, 1.0))


def growth_rate(space: Space, law: KelvinVoigt, T: float) -> float:
    """Return the measured rate at which a perturbation of a solution grows, divided by the predicted rate c.

    The quotient is log(‖v(T)‖/‖v(0)‖)/(cT). The perturbation v is the difference of two solutions, one of which is 0 at
    all times; v(0) is a multiple of the displacement that ``softest_mode`` returns, which grows at the rate c. The load
    presses both solutions onto the foundation with twice the force that the mode needs, and balances the stress at zero
    strain.

    Args:
        space: the space V^h.
        law: the material law, which softens.
        T: the final time.
    """
    c, v, force = softest_mode(space, law)
    strain = abs(space.strain(v)).max()
    start = SMALL_STRAIN * math.exp(-c * T) / strain * v
    pressing = space.N.T @ np.full(len(force), 2 * SMALL_STRAIN * abs(force).max() / strain)
    still = unloaded(space, law)
    rest = still.elastic(still.u0)

    def load(times: Array) -> Array:
        return rest[:, None] + np.multiply.outer(pressing, np.exp(c * (times - T)))

    problem = replace(still, T=T, load=load, u0=start)
    states = path(problem, MIDPOINT, steps_for(law, T))
    return math.log(norm(problem, states[-1]) / norm(problem, states[0])) / (c * T)


def over_bound(setup: Experiment, law: KelvinVoigt, T: float) -> float:
    """Return the largest quotient (distance of two solutions) / bound, for backward Euler.

    For solutions u_n and v_n with the time step k, the bound of ‖u_n − v_n‖_V is (1 − gk)^{−n} (‖u_0 − v_0‖_V + k Σ
    ‖f_j − g_j‖_V). The number g is max(−m, 0)/m_A ≤ ω with the monotonicity constant m of G; f_j and g_j are the loads
    of u and v. The solution u has the load of the experiment, with time scaled to T; v has another load or another
    initial value.

    Args:
        setup: the experiment, which has the mesh, the load and the initial value of u.
        law: the material law of both solutions.
        T: the final time.
    """
    space = setup.space
    steps = steps_for(law, T)
    pace = setup.problem.T / T
    problem = replace(SemiDiscrete.of(space, law, lambda t: setup.problem.load(t * pace), setup.problem.u0), T=T)
    states = path(problem, BACKWARD_EULER, steps)
    field = along_the_contact(problem, smooth(space, np.random.default_rng(SEED)))
    sideways = replace(problem, u0=problem.u0 + field)
    damping = (1 - law.growth * T / steps) ** np.arange(1, steps + 1)
    others = *islice(perturbations(problem, space), PERTURBATION_KINDS), sideways
    return maximum((damping * quotients(problem, states, other)).max() for other in others)


STEPS = 12
_BY_WHAT = f"solvers are exact, or a fixed-point iteration stops at {FIXED_POINT:g} in every step"
EXACTLY, OTHERWISE = at_most(1e-9, _BY_WHAT), positive_at_most(1e-9, _BY_WHAT)
"""Windows of relative differences: for the same solver with another initial guess, and for another solver.

The same solver may give exactly the same digits. The result of another solver differs at least by round-off."""
WAYS = {
    "random starts": ("from random active sets", EXACTLY),
    "least squares": ("by Lawson and Hanson's method on the dual", OTHERWISE),
    "fixed point": ("by a fixed-point iteration with all of G on the right-hand side", OTHERWISE),
    "interior point": (
        "by an interior point method",
        positive_at_most(1e-7, "the method stops at a duality gap of 1e-15, whose root bounds the difference"),
    ),
}
"""Other ways to solve a problem, by their names in columns: each in words, with the window of the difference."""


def differences(of: str, *ways: str, on: str = "") -> tuple[Check, ...]:
    """Return the criteria for relative differences between a solution and the results of other solvers.

    Args:
        of: what is compared, "solutions" or "stresses".
        ways: the names of the other ways to solve the problem, keys of ``WAYS``.
        on: text to add to the description of the interior point method.
    """
    texts = {name: f"difference of the {of} {WAYS[name][0]}{on if name == 'interior point' else ''}" for name in ways}
    return tuple(consequence(name.replace(" ", "-"), text, name, WAYS[name][1]) for name, text in texts.items())


class OneTrajectory(ListedNumbers):
    """Measures relative differences between solutions in time that different solvers compute.

    **Measured** is max_n ‖u_n − v_n‖_V / max_n ‖u_n‖_V for solutions u_n and v_n by backward Euler. Every step
    minimises ½ vᵀSv − bᵀv over K^h with S = M/k + G. The active set method of the study, which starts from the last
    active set, gives u_n. Four other ways give v_n (``rivals``): the same method from random active sets, two methods
    that share no code with it, and a fixed-point iteration with all of G on the right-hand side.

    **Predicted**: the differences are as small as the tolerances of the solvers, because S is positive definite, so
    each step has one solution. If G softens, S is positive definite for short steps only, and longer steps are refused.
    """

    label = "Thm 4.1, 5.2"
    claim = "different initial guesses, solvers and splittings give one solution in V^h: a test of the solvers"
    checks = differences("solutions", *WAYS)
    quick = grid((*EVOLVING, *SOFTENING), ("shaken",), (6,))
    full = (
        *grid((*EVOLVING, *SOFTENING), ("one-diagonal",), (6, 12)),
        *grid((*EVOLVING, *SOFTENING, "heterogeneous", "corner"), ("unstructured",), (6, 12)),
        *grid(("cube-disc",), ("shaken",), (3,)),
    )

    def setup(self, setting: Setting) -> Experiment:
        return Experiment.at(setting, BACKWARD_EULER, STEPS)

    def measure(self, setup: Experiment) -> Numbers:
        problem = setup.problem
        states = np.array([state.u for state in setup.march(setup.steps)])
        size = norm(problem, states).max()
        numbers = {
            name: furthest(problem, states, path(rival, setup.scheme, setup.steps)) / size
            for name, rival in rivals(problem).items()
        }
        return with_h(setup.space.h, numbers)


def rivals(problem: SemiDiscrete) -> dict[str, SemiDiscrete]:
    """Return copies of a problem that are solved in four other ways, by the names of the ways, the keys of ``WAYS``.

    Args:
        problem: the semi-discrete problem, which the active set method of the study solves.
    """
    return {
        "random starts": replace(problem, solver=RandomStarts),
        "least squares": replace(problem, solver=LeastSquares),
        "fixed point": replace(problem, reference=0 * problem.reference, remainder=problem.elastic),
        "interior point": replace(problem, solver=InteriorPoint),
    }


class RandomStarts(Signorini):
    """Contact solver that starts every solve from a new random active set, with the same arguments as ``Signorini``."""

    def __init__(self, S: sps.csc_array, N: sps.csr_array, x: Points | None = None) -> None:
        super().__init__(S, N, x)
        self.rng = np.random.default_rng(SEED)

    def __call__(self, b: Array) -> ContactSolution:
        self.active = self.rng.uniform(size=self.N.shape[0]) < self.rng.uniform()
        return super().__call__(b)


class LeastSquares:
    """Contact solver that computes the contact forces by nonnegative least squares, from the dual problem.

    The contact problem is to minimise ½ vᵀSv − bᵀv subject to N v ≤ 0. Its dual problem is min |L⁻¹(Nᵀλ − b)| over the
    contact forces λ ≥ 0, with S = LLᵀ. Calling the solver with b returns v and λ.

    Args:
        S: the symmetric positive definite matrix, (dofs, dofs).
        N: the constraint matrix, (m, dofs).
        x: not used; ``Signorini`` has the same arguments.

    Source: C. L. Lawson, R. J. Hanson, Solving Least Squares Problems, 1974, chapter 23.
    """

    def __init__(self, S: sps.csc_array, N: sps.csr_array, x: Points | None = None) -> None:
        self.N = N
        self.L = cholesky(S.toarray(), lower=True)
        self.columns = solve_triangular(self.L, N.T.toarray(), lower=True)

    def __call__(self, b: Array) -> ContactSolution:
        multipliers, _ = nnls(self.columns, solve_triangular(self.L, b, lower=True))
        return cho_solve((self.L, True), b - self.N.T @ multipliers), multipliers


class InteriorPoint:
    """Contact solver that solves a quadratic programme in all unknowns by the interior-point method Clarabel.

    The programme is to minimise ½ vᵀSv − bᵀv subject to N v ≤ 0. Calling the solver with b returns v and the contact
    forces.

    Args:
        S: the symmetric positive definite matrix, (dofs, dofs).
        N: the constraint matrix, (m, dofs).
        x: not used; ``Signorini`` has the same arguments.
    """

    def __init__(self, S: sps.csc_array, N: sps.csr_array, x: Points | None = None) -> None:
        rows = N.shape[0]
        self.q = np.zeros(N.shape[1])
        self.unit = float(abs(S.diagonal()).max())
        P = sps.csc_matrix(sps.triu(S / self.unit))
        cones = [clarabel.NonnegativeConeT(rows)]
        how = settings(aim=Accuracy(gap=1e-15, feasibility=1e-14), enough=Accuracy(gap=1e-11, feasibility=1e-11))
        self.solver = clarabel.DefaultSolver(P, self.q, sps.csc_matrix(N), np.zeros(rows), cones, how)

    def __call__(self, b: Array) -> ContactSolution:
        size = float(np.linalg.norm(b)) or 1.0
        self.q[:] = -b / size
        self.solver.update(q=self.q)
        solution = self.solver.solve()
        return np.array(solution.x) * size / self.unit, np.array(solution.z) * size


RIVALS: Mapping[str, type[Signorini]] = {
    "random starts": RandomStarts,
    "least squares": LeastSquares,  # type: ignore[dict-item]
    "interior point": InteriorPoint,  # type: ignore[dict-item]
}


class OneStress(ListedNumbers):
    """Measures relative differences between stresses of Problem 3.2 that different solvers compute.

    **Measured** is max_n ‖σ_n − τ_n‖_Q / max_n ‖σ_n‖_Q for the stress σ_n of the active set method of the study and the
    stress τ_n of each other contact solver in ``RIVALS``.

    **Predicted**: the differences are as small as the tolerances of the solvers. Every step minimises a strictly convex
    energy over the admissible stresses. So the earlier steps determine the stress and the multipliers of equilibrium,
    and neither the start of the search nor the method may change them.
    """

    label = "Thm 4.3"
    claim = "different initial guesses and solvers give one stress in Σ^h: a test of the solvers"
    checks = differences("stresses", *RIVALS, on=" on all unknowns")
    quick = grid(("advance-recede",), ("shaken",), (4,))
    full = grid(("advance-recede", "corner", "anisotropic"), ("unstructured",), (4, 8))

    def setup(self, setting: Setting) -> StressExperiment:
        return StressExperiment.at(setting, STEPS)

    def measure(self, experiment: StressExperiment) -> Numbers:
        own = stresses(experiment)
        space = experiment.space
        size = maximum(norm_in_q(stress, space) for stress in own)
        numbers = {}
        for name, solver in RIVALS.items():
            pairs = zip(own, stresses(replace(experiment, solver=solver)), strict=True)
            numbers[name] = maximum(norm_in_q(a - b, space) for a, b in pairs) / size
        return with_h(mesh_size(space.mesh), numbers)


def stresses(experiment: StressExperiment) -> list[Tensors]:
    """Return the discrete stresses of all time steps at the Q quadrature points of every cell, (3, cells, Q) each.

    Args:
        experiment: the stress problem, which is solved here.
    """
    return [state.stress.values for state in experiment.march()]


# The load, f ∈ W^{1,1}(0,T;V).

LOAD_INTERVALS = 512
COARSER = 16
"""Quotient of the lengths of long and short time intervals, over which increments of the load are compared."""


UNBOUNDED_VARIATION = "ε(ü) ~ (s − c)^{α−4} with α = 13/4 is not square integrable and f has no bounded variation in V"


class LoadInTime(ListedNumbers):
    """Measures the variation in time, the largest increment and the norm of the discrete load f^h.

    The statement is f ∈ W^{1,1}(0,T;V) for the load f, (3.8) and (5.9). It is tested by computing the norm of f^h on
    finer and finer grids in time and space: a finite norm converges, an infinite norm grows.

    **Measured** for f^h(t) = M⁻¹F(t), which by (5.9) is the projection of f(t) onto V^h, are

    * the *variation* Σ_i ‖f^h(t_i) − f^h(t_{i−1})‖_V on a time grid, divided by its value for intervals of twice the
      length. By the triangle inequality the quotient is at least 1;
    * the largest increment ‖f^h(t_i) − f^h(t_{i−1})‖_V, divided by its value for intervals of 16 times the length;
    * the norm ‖f^h‖_{W^{1,1}}, from mesh to mesh.

    **Predicted**:

    * The variation grows by at most 1 % from a grid to the next finer one, if the load changes its direction finitely
      often. If the variation were not bounded, it would grow by a power of 2.
    * Four halvings of the intervals reduce the largest increment to 1/16 where ḟ is bounded. They reduce it to 1/2 for
      ``load-w11``, whose load behaves like (t − t_0)^{1/4}. If f jumped in time, the largest increment would not fall;
      bounded variation alone would permit such a jump. In ``lift-and-land`` u̇ and σ_ν jump, but the two jumps cancel
      in f.
    * On finer meshes ‖f^h‖_{W^{1,1}} tends to the norm of f. The energy that the projection loses is of order h². Where
      a contact patch is three cells wide (n = 8), this is some per cent, and a quarter of that on each finer mesh.
      Therefore n = 8 is not judged for moving fronts. From n = 16 on the norms agree within 5 %. If f were not in V,
      the norm would grow.

    **Found**: (3.8) does not hold for ``moving-rough``. There ε(u̇) ~ (s − c)^{1/4} near the front c, which moves. So
    u̇ has increments of the size k^{3/4} in V, whose sum is not bounded, and so has f, which contains u̇. The case was
    judged at first: its variation grew by 0.8, 1 and 1.3 % at n = 8, 16 and 32. Now it is only reported. Theorem 4.1
    does not apply to this load; u ∈ W^{1,∞}(0,T;V) is known because u was constructed.
    """

    label = "(3.8), (5.9)"
    claim = "f ∈ W^{1,1}(0,T;V), and f^h ∈ W^{1,1}(0,T;V^h) uniformly in h"
    checks = (
        paper_claim(
            "variation",
            f"variation of f^h on {LOAD_INTERVALS} intervals / on {LOAD_INTERVALS // 2} intervals",
            "variation",
            Window(1 - ROUNDING_ROOM, 1.01, "the variation cannot fall; without a bound it grows by a power of 2"),
        ),
        consequence(
            "increments",
            f"largest increment of f^h / largest increment over {COARSER} times as long intervals",
            "increments",
            Window(1 / 32, 0.6, f"1/{COARSER} where ḟ is bounded, 1/2 for (t − t_0)^{{1/4}}, 1 for a jump"),
        ),
        paper_claim(
            "uniform",
            "‖f^h‖_{W^{1,1}(0,T;V)}, finest mesh / coarsest mesh",
            change("norm"),
            around(1, 0.05, "f^h tends to f"),
            levels=2,
        ),
    )
    quick = grid(("load-w11",), ("unstructured",), (8, 16))
    full = grid(
        (*EVOLVING, "lift-and-land", "load-w11", "moving-rough", "hexagon", *SOFTENING), ("unstructured",), (16, 32)
    )

    def measure(self, setting: Setting) -> Numbers:
        space, solution = posed(setting)
        v_norm = ErrorNorm(solution, space)
        riesz = Cholesky(unloaded(space, solution.law).M)
        times = np.linspace(0, solution.body.T, LOAD_INTERVALS + 1)
        loads = v_norm.load(times).T
        # A finite norm shows in increments ‖f^h(t_i) − f^h(t_{i−1})‖_V that do not grow from grid to grid.
        fine, half, coarse = (dual_norm(np.diff(loads[::step], axis=0), riesz) for step in (1, 2, COARSER))
        size = dual_norm(loads, riesz).mean() * solution.body.T
        numbers = {"variation": fine.sum() / half.sum(), "increments": fine.max() / coarse.max()}
        return with_h(space.h, {**numbers, "norm": size + fine.sum()})

    def checks_of(self, case: str, groups: Groups) -> Judged:
        reason = UNBOUNDED_VARIATION if case == "moving-rough" else ""
        return [(replace(check, if_missed=reason), groups) for check in self.checks]


# The traction, σν ∈ L^∞(0,T;L²(Γ)).

UNBOUNDED = "junction"
"""The case whose traction σν is not square integrable on the boundary."""


def last_increments(levels: pd.DataFrame) -> float:
    """Return the quotient of the last and the previous increment of max_t ‖σν‖² from mesh to mesh.

    σν is the exact traction on the boundary, with the norm of L²(Γ).

    Args:
        levels: a table with one row for each level from coarse to fine, at least three, and max_t ‖σν‖ in the column
            "norm".
    """
    increments = np.diff(levels["norm"].to_numpy() ** 2)
    return float(increments[-1] / increments[-2])


class TractionInTime(ListedNumbers):
    """Measures the largest norm over time of the exact traction, max_t ‖σν‖_{L²(Γ)}, computed on several meshes.

    The statement is σν ∈ L^∞(0,T;L²(Γ)), (4.12), for the traction on the whole boundary. Nothing is solved: a mesh only
    gives the quadrature points on Γ, and its level n the 2n + 1 times. The quadrature rules are not adapted to
    singularities. If the norm is finite, the computed norm converges as n grows; otherwise it grows without a bound.

    **Predicted**:

    * The computed norm converges for every case of Proposition 5.4.
    * In ``junction`` the traction behaves like r^{−1/2} at the point where Γ1 meets Γ3. There the square of the norm
      grows like log 1/h, that is, by the same amount from mesh to mesh. (4.12) does not hold, and the paper does not
      claim it.
    """

    label = "(4.12)"
    claim = "σν ∈ L^∞(0,T;L²(Γ)^d) for the solutions of Prop. 5.4"

    def places(self, full: bool) -> list[Setting]:
        cases = [case for case in catalogue() if case.proposition == "Prop. 5.4"] if full else named("advance-recede")
        return place([*cases, *named(UNBOUNDED)], (8, 16, 32), (2, 4, 8))

    def measure(self, setting: Setting) -> Numbers:
        space, solution = posed(setting)
        times = np.linspace(0, solution.body.T, 2 * setting.level + 1)
        squares = np.zeros(len(times))
        for part in space.body.parts:
            rule = rule_on(space, part, FACET_POINTS if space.dim == 2 else 2)
            exact = solution.at(part.point(rule.s))
            squares += np.tensordot(rule.weights, np.sum(exact.surface_load(part, times) ** 2, axis=0), axes=2)
        return with_h(space.h, {"norm": math.sqrt(squares.max())})

    def checks_of(self, case: str, groups: Groups) -> Judged:
        if case == UNBOUNDED:
            check = consequence(
                "unbounded",
                "σν ∉ L²(Γ): last / previous increment of max_t ‖σν‖²_{L²(Γ)} under refinement",
                last_increments,
                around(1, 0.1, "logarithmic growth: the increments of the square do not fall"),
                levels=MIN_LEVELS,
            )
        else:
            check = paper_claim(
                "bounded",
                "max_t ‖σν‖_{L²(Γ)}, finest mesh / next coarser mesh",
                change("norm", since=-2),
                around(1, 0.02, "the maximum has converged in space and time, which are refined together"),
                levels=MIN_LEVELS,
            )
        return [(check, groups)]


STRESS_INSTANTS = 8
"""Number of nodes of the midpoint rule that approximates norms in time."""
TEST_FIELDS = 3
"""Number of smooth test fields for each of the two traction conditions."""
TRACTION_FAMILIES = "one-diagonal", "criss-cross", "shaken", "unstructured"
STRONG = around(1, 0.25, "if the stress error is spread evenly; ‖σ − σ^h‖_Q = O(h) alone gives 1/2")
WEAK = around(2, 0.3, "product of two errors O(h), σ − σ^h and v − Π^h v")


WEAKLY = "loaded, weakly", "tangential, weakly"
"""Columns with violations of the traction conditions, on Γ2 and on Γ3, that are tested with smooth fields."""


class NaturalConditions(ListedNumbers):
    """Measures how far the discrete stress violates the traction conditions on Γ2 and Γ3.

    The conditions (4.13) are σν = f_2 on Γ2 and σ_τ = 0 on Γ3. The discrete stress σ^h = A ε(u̇^h) + G ε(u^h) is
    constant on cells, so its tractions satisfy (4.13) only in the limit h → 0.

    **Measured** at STRESS_INSTANTS evenly spaced times, each of which is the midpoint of a time step, are violations in
    two senses:

    * in L²: σ^hν − f_2 on Γ2, and on Γ3 the tangential part σ^h_τ and the error σ^hν − σν;
    * weakly, tested with smooth v that have v = 0 on Γ1 and v_ν = 0 on Γ3. For these v, (4.13) reads (σ, ε(v))_Q = (f,
      v)_V.

    **Predicted** orders, for solutions with σ ∈ W^{1,∞}:

    * Order 1 in L²(Γ). ‖σ − σ^h‖_Q = O(h) alone gives order 1/2: by the scaled trace inequality the error on Γ is at
      most h^{−1/2} times the error in the cells along Γ, which might contain the whole error. But W^{1,∞} estimates for
      smooth solutions on quasi-uniform meshes say that the error is spread evenly. The cells along Γ then contain an
      error of h^{3/2}. The order of ‖σ^hν − σν‖ cannot exceed 1, because σ^h is constant on a cell. For σ^h_τ alone,
      which ‖σ^hν − σν‖ bounds, the first-order term depends on the arrangement of the triangles along Γ3.
    * Order 2 weakly. The scheme satisfies the equation for the interpolant Π^h v, so

          (σ^h, ε(v))_Q − (f, v)_V = (σ^h − σ, ε(v − Π^h v))_Q = O(h) · O(h).

      This also holds if σ^h − σ contains an error of the time steps.
    """

    label = "(4.13)"
    claim = "σν = f_2 on Γ2 and σ_τ = 0 on Γ3"
    checks = (
        check_of_order("loaded", "order of ‖σ^hν − f_2‖ in L²(0,T;L²(Γ2))", "loaded", STRONG),
        check_of_order("contact", "order of ‖σ^hν − σ_ν ν‖ ≥ ‖σ^h_τ‖ in L²(0,T;L²(Γ3))", "contact", STRONG),
        check_of_order(
            "tangential",
            "order of ‖σ^h_τ‖ in L²(0,T;L²(Γ3))",
            "tangential",
            between(1, 2, 0.25, 0, "order 2 where the triangles along Γ3 are symmetric"),
            if_missed=(
                "the check of σ^hν − σ_ν ν bounds ‖σ^h_τ‖, whose first-order part depends on the triangles along Γ3"
            ),
        ),
        check_of_order(
            "loaded-weakly", "order of σν − f_2 on Γ2, tested with smooth v", WEAKLY[0], WEAK, power=CELL_POWER
        ),
        check_of_order(
            "tangential-weakly", "order of σ_τ on Γ3, tested with smooth v", WEAKLY[1], WEAK, power=CELL_POWER
        ),
    )
    quick = grid(("advance-recede",), ("shaken",), (12, 24, 48))
    full = grid(("advance-recede", "travelling-patch", "yield-and-release"), TRACTION_FAMILIES, (12, 24, 48))

    def setup(self, setting: Setting) -> Experiment:
        # [0, T] is split into STRESS_INSTANTS equal parts. Each part has an odd number of time steps, so that its
        # midpoint is the midpoint of a time step.
        steps = STRESS_INSTANTS * (2 * (setting.level // 8) + 3)
        return Experiment.at(setting, MIDPOINT, steps)

    def measure(self, setup: Experiment) -> Numbers:
        return with_h(setup.space.h, tractions(setup))


def tractions(setup: Experiment) -> Numbers:
    """Return norms of the violations of the traction conditions, relative to the norm of σν on Γ2 ∪ Γ3.

    The violations are measured in L² on the boundary and, weakly, with smooth test fields v of norm ‖v‖_V = 1. All
    norms are root mean squares over several times. The work (f, v)_V is computed as (σ, ε(v))_Q with the exact stress
    σ. Both are equal by Green's formula (2.14) with (2.2), (2.4) and (2.5).

    Args:
        setup: the experiment, whose time steps ``discrete_stresses`` describes.

    Returns:
        The norms by the names of columns: "tangential" and "contact" for σ^h_τ and σ^hν − σν on Γ3, "loaded" for σ^hν −
        f_2 on Γ2, and ``WEAKLY``.
    """
    space = setup.space
    sides = []
    for part in (*space.body.of(Kind.LOADED), *space.body.of(Kind.CONTACT)):
        rule = rule_on(space, part, FACET_POINTS)
        sides.append((part, space.mesh.f2t[0, rule.facets], rule.weights, setup.solution.at(part.point(rule.s))))
    energies = Energies(setup.solution, space, aligned=False)
    tests = []
    for fields in smooth_fields(space.body):
        strains = [strain(v, energies.exact.x) for v in fields]
        tests.append([e / energies.norm(e) for e in strains])
    squares: Numbers = dict.fromkeys(("tangential", "contact", "loaded", *WEAKLY), 0.0)
    size = 0.0
    for time, stress in discrete_stresses(setup):
        for part, cells, weights, exact in sides:
            forces = traction(stress[:, cells], part.normal)
            load = exact.surface_load(part, time)
            if part.kind is Kind.CONTACT:
                tangential = forces - np.multiply.outer(part.normal, part.normal @ forces)
                squares["tangential"] += np.sum(tangential**2 * weights.sum(axis=1))
            squares[part.kind.name.lower()] += np.sum((forces[..., None] - load) ** 2 * weights)
            size += np.sum(load**2 * weights)
        stress_error = stress[:, energies.cells] - energies.exact.stress(time)
        for name, strains in zip(WEAKLY, tests, strict=True):
            squares[name] += sum(energies.work(stress_error, e) ** 2 for e in strains)
    return {name: math.sqrt(square / size) for name, square in squares.items()}


def discrete_stresses(setup: Experiment) -> Iterator[tuple[float, Tensors]]:
    """Yield pairs of a time t and the discrete stress σ^h(t) on the cells, (D, cells), for STRESS_INSTANTS times t.

    The times are the midpoints of STRESS_INSTANTS equal parts of [0, T], each with an odd number of time steps. So t is
    the midpoint of a step from t_{n−1} to t_n, and σ^h(t) = A ε((u_n − u_{n−1})/k) + G ε((u_n + u_{n−1})/2).

    Args:
        setup: the experiment. Its number of time steps is an odd multiple of STRESS_INSTANTS.
    """
    space = setup.space
    cells = on_cells(space, setup.solution.law)
    k = setup.problem.T / setup.steps
    each = setup.steps // STRESS_INSTANTS
    for n, (before, after) in enumerate(pairwise(setup.march(setup.steps))):
        if n % each == each // 2:
            old = space.strain(before.u)
            new = space.strain(after.u)
            yield (before.time + after.time) / 2, cells.stress((new - old) / k, (new + old) / 2)


def smooth_fields(body: Body) -> tuple[list[Field], list[Field]]:
    """Return random smooth test fields for the traction condition on the loaded boundary Γ2, and for the one on Γ3.

    Args:
        body: the body.

    Returns:
        First, TEST_FIELDS fields that vanish on the clamped boundary Γ1 and on the contact boundary Γ3. Second,
        TEST_FIELDS fields for each line (in 3D: plane) of Γ3, which vanish on Γ1, are tangential on this line and
        vanish on the other lines of Γ3.
    """
    clamped = planes(body, Kind.CLAMPED)
    contact = planes(body, Kind.CONTACT)
    rng = np.random.default_rng(SEED)
    on_loaded = [vanishing(waves(body, rng), clamped + contact) for _ in range(TEST_FIELDS)]

    def tangential(part: Part) -> Field:
        others = [other for other in contact if other is not part]
        tangents = part.frame[:, :-1]
        along = waves(body, rng)
        inside = waves(body, rng)

        def field(x: Points) -> Vectors:
            return np.tensordot(tangents @ tangents.T, along(x), axes=1) + part.coordinates(x)[1] * inside(x)

        return vanishing(field, clamped + others)

    rng = np.random.default_rng(SEED)
    return on_loaded, [tangential(part) for part in contact for _ in range(TEST_FIELDS)]


# Smooth fields are defined here and not in ``study.fem``, because only statements use them.


def planes(body: Body, kind: Kind) -> list[Part]:
    """Return one boundary part of the given kind for each line (in 3D: plane) that contains such parts."""
    distinct: list[Part] = []
    for part in body.of(kind):
        lines = [np.append(other.normal, other.normal @ other.start) for other in (*distinct, part)]
        if not any(np.allclose(line, lines[-1]) for line in lines[:-1]):
            distinct.append(part)
    return distinct


def vanishing(field: Field, parts: list[Part]) -> Field:
    """Return a field multiplied by the distances from the planes that contain given boundary parts.

    Args:
        field: the field. The result vanishes on the boundary parts.
        parts: the boundary parts.
    """
    return lambda x: field(x) * math.prod(part.coordinates(x)[1] for part in parts)


def waves(body: Body, rng: np.random.Generator) -> Field:
    """Return a random vector field cos(κ·x + c), with at most half a wave across the body in each direction.

    Wave vectors κ and phases c are random for each component.

    Args:
        body: the body, whose extent in each direction is the unit of length for κ.
        rng: the random generator.
    """
    extent = body.vertices.max(axis=1) - body.vertices.min(axis=1)
    directions = rng.uniform(-np.pi, np.pi, (body.dim, body.dim)) / extent
    phases = rng.uniform(0, 2 * np.pi, body.dim)

    return lambda x: np.cos((x.T @ directions.T + phases).T)


def strain(field: Field, x: Points) -> Tensors:
    """Return the strain ε(v) of a field v at given points, by complex-step differentiation.

    Args:
        field: the field v, analytic in x.
        x: the points, (d, ...).

    Returns:
        The D components of the strain at each point, (D, ...).
    """
    tiny = 1e-30
    derivatives = [field((x.T + 1j * tiny * unit).T).imag / tiny for unit in np.eye(len(x))]
    return mandel(np.stack(derivatives, axis=1))
