"""(5.21) and the theorem on backward Euler for long times and soft materials: errors grow like e^{ωT} and not faster.

Here T is the final time and ω = L_G/m_A. Both are varied over two decades, by scaling time and the elasticity G. Two
laws are used: the law of the case (columns "own"), and G = −ωA (columns "even"). ``solution_divergence`` measures the
distance of two solutions of Problem 5.1 for the same T and ω. Predicted before measuring:

* *No contact, G = −ωA, u = (1/10 + t/T) U with a fixed field U.* Let P_h be the projection onto V^h in (·,·)_V. Here
  B = −ωI in (4.2), and V^h replaces K^h. Then P_h u − u^h = e^{ωt} (P_h u_0 − Π^h u_0), which is orthogonal to
  u − P_h u. So at T

      ‖u − u^h‖_V² = ‖u − P_h u‖_V² + e^{2ωT} ‖P_h u_0 − Π^h u_0‖_V².

  The midpoint rule is exact for functions linear in t, and makes e^{ωT} larger by ωT z²/12, at most 3.3e-3 for
  z = ωk ≤ 1/16. So the factor e^{ωT} really occurs. For ωT = 10 it is 2e4, while the estimates in the proof
  overestimate the error by only 1e2 to 1e3. So errors would exceed c · (right side of (5.21)) if c did not contain
  e^{ωT}. (The first prediction was made for K^h. There the quotient is 0.92 for ωT = 10, because the error of u^h
  becomes larger than the gap, so that u^h comes into contact. The other checks use K^h.)
* *Moving contact, both laws:* errors are below c · (right side of (5.21)), for all ω and T. The constant c contains
  e^{ωT}, because the exponent max(−m, 0)/m_A in ``error_bounds`` is ω for both laws.
* *Monotone laws, G = ωA:* the bound of ``backward_euler`` has no exponential, and holds for all ω and T.
"""

import math
from dataclasses import replace

import numpy as np
from sympy import Integer, Rational

from manufactured.body import Kind, unit_square
from manufactured.cases.softening import softening
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.law import KelvinVoigt
from manufactured.symbols import s, t
from study.fem.naming import family_named, resolve
from study.ledger.criterion import every, largest
from study.ledger.window import around, at_least, positive_at_most
from study.solve.evolution import SemiDiscrete
from study.solve.factorisation import Cholesky
from study.solve.gradient_flow import GradientFlow
from study.solve.paths import furthest, interpolated, path
from study.solve.tableau import BACKWARD_EULER, MIDPOINT
from study.statements.error_bounds import sides
from study.statements.shared.base import ListedNumbers, Setting, grid, with_h
from study.statements.shared.experiment import Experiment, with_cached_loads
from study.statements.shared.norms import maximum, norm
from study.statements.solution_divergence import SWEEP, column, columns, even_law, scaled, steps_for

FEWEST = 64
"""Smallest number of steps of the midpoint rule; for large ωT more steps are used."""
COUNTS, FINEST = (8, 32), 256
"""Numbers of steps of backward Euler, and of the midpoint rule whose solution is used as the semi-discrete u^h."""
LONGEST = tuple((omega, T) for omega, T in SWEEP if omega * T == max(a * b for a, b in SWEEP))
"""The pairs (ω, T) with the largest e^{ωT}."""
KNOWN = around(1, 5e-3, "the midpoint rule changes the quotient by at most 3.3e-3")
PROVED = positive_at_most(1.0, "proved")
NEEDED = at_least(1.0, "so a bound without the factor e^{ωT} = 2e4 would be wrong")
AT_LONGEST = "error / (c e^{−ωT} · right side of (5.21)), no contact, ωT = 10"
OVER_BOUND = "error / (c · right side of (5.21)), moving contact, with the law of the case and with G = −ωA"


class GrowingErrors(ListedNumbers):
    """Measures errors divided by their bounds, and divided by their predicted values where these are known exactly."""

    label = "(5.21), T and L_G/m_A"
    effort = 500
    claim = "errors grow like e^{ωT}, ω = L_G/m_A, if G = −ωA, and never faster"
    rules = (
        every("known", "‖u − u^h‖ at T / predicted value, G = −ωA, no contact", KNOWN, *columns("even", "known")),
        every("needed", AT_LONGEST, NEEDED, *columns("even", "needed", LONGEST)),
        largest("bound", OVER_BOUND, PROVED, *columns("own", "bound"), *columns("even", "bound")),
        largest("time", "‖u^h − û^{hk}‖ / its bound from the data, G = ωA", PROVED, *columns("monotone", "time")),
    )
    quick = grid(("softening",), ("unstructured",), (4,))
    full = grid(("softening",), ("unstructured",), (6, 12))

    def measure(self, setting: Setting) -> dict[str, float]:
        own, found = resolve(setting.case).solution.law, {}
        for omega, T in SWEEP:
            law = even_law(own.dim, omega)
            free = experiment(opening(law, T), setting)
            found[column("even", "known", omega, T)] = error_over_predicted(free, omega)
            found[column("even", "needed", omega, T)] = share(free) * math.exp(omega * T)
            found[column("even", "bound", omega, T)] = share(experiment(softening(law, T), setting))
            moving = experiment(softening(scaled(own, omega), T), setting)
            found[column("own", "bound", omega, T)] = share(moving)
            found[column("monotone", "time", omega, T)] = in_time(moving, even_law(own.dim, -omega))
        return with_h(moving.space.h, found)


def experiment(solution: ExactSolution, setting: Setting) -> Experiment:
    """Return the discretisation of a solution on the mesh of a setting, with time steps much shorter than 1/ω and T."""
    steps = max(FEWEST, steps_for(solution.law, solution.body.T))
    setup = Experiment.of(solution, family_named(setting.family), setting.level, MIDPOINT, steps)
    return replace(setup, problem=with_cached_loads(setup.problem))


def opening(law: KelvinVoigt, T: float) -> ExactSolution:
    """Return an exact solution without contact that is linear in time.

    Its gap is (1/10 + t/T)(1 + 4x(1 − x)), and its normal strain is 0 on Γ3.
    """
    body, time = unit_square(T), t / Rational(T).limit_denominator(1000)
    (part,) = body.of(Kind.CONTACT)
    gap = (Rational(1, 10) + time) * (1 + 4 * s * (1 - s))
    face = ContactFace.linear(part, law, body.T, gap, Integer(0), Integer(-1), initial=Integer(0))
    return ExactSolution(body, law, (face,))


def share(setup: Experiment) -> float:
    """Return the error divided by its bound (5.21), with the constant c of the bound."""
    return sides(setup)["(5.21), c"]


def error_over_predicted(setup: Experiment, omega: float) -> float:
    """Return the error at the final time divided by its predicted value, for a solution without contact condition.

    The predicted value is (‖u − P_h u‖_V² + e^{2ωT} ‖P_h u_0 − Π^h u_0‖_V²)^{1/2}.
    """
    v_norm, problem, T = setup.v_norm, setup.problem, setup.problem.T
    end = path(replace(problem, N=problem.N[:0]), setup.scheme, setup.steps)[-1]
    sample, start = v_norm.sample(T), norm(problem, projection(setup, 0.0) - problem.u0)
    predicted = math.hypot(v_norm.distance(sample, projection(setup, T)), math.exp(omega * T) * start)
    return v_norm.distance(sample, end) / predicted


def projection(setup: Experiment, time: float) -> np.ndarray:
    """Return the projection P_h u(t) of the exact solution onto V^h in the inner product of V, (dofs,).

    The viscosity A must be homogeneous.
    """
    stress = setup.solution.law.A.matrix @ setup.v_norm.means(time)
    return np.asarray(Cholesky(setup.problem.M)(setup.space.functional(stress)))


def in_time(setup: Experiment, law: KelvinVoigt) -> float:
    """Return the largest quotient (error in time) / (bound from the data) of backward Euler, over several step numbers.

    Args:
        setup: the experiment with the load and the initial value.
        law: the law that replaces the law of the experiment.
    """
    problem = SemiDiscrete.of(setup.space, law, setup.problem.load, setup.problem.u0)
    exact = path(problem, MIDPOINT, FINEST)
    flow = GradientFlow(problem, np.array([problem.load(t) for t in problem.T * np.arange(FINEST + 1) / FINEST]))
    paths = [(steps, path(problem, BACKWARD_EULER, steps)) for steps in COUNTS]
    return maximum(furthest(problem, exact, interpolated(u, FINEST)) / flow.a_priori(steps) for steps, u in paths)
