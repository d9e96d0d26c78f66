"""Theorems 4.1, 4.3 and 5.2: there is only one solution, so different solvers must give the same result.

For Theorems 4.1 and 5.2 displacements are compared that solve Problem 3.1 on V^h. For Theorem 4.3 stresses are compared
that solve Problem 3.2 in a conforming stress space, without displacements.
"""

from collections.abc import Mapping
from dataclasses import replace

import clarabel
import numpy as np
import scipy.sparse as sps
from scipy.linalg import cho_solve, cholesky, solve_triangular
from scipy.optimize import nnls

from manufactured.tensors import Array, Points, Tensors
from study.fem.mesh import size as mesh_size
from study.ledger.check import Check, consequence
from study.ledger.window import at_most, positive_at_most
from study.solve.evolution import FIXED_POINT, SemiDiscrete
from study.solve.interior_point import Accuracy, settings
from study.solve.paths import furthest, path
from study.solve.signorini import Signorini
from study.solve.tableau import BACKWARD_EULER
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
from study.statements.shared.norms import maximum, norms
from study.statements.thm_4_2 import StressExperiment, norm_in_q

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
    """Return the criteria for the relative differences of solutions that other solvers give.

    Args:
        of: what is compared, "solutions" or "stresses".
        ways: the names of the other ways.
        on: text to add to the description of the interior point method.
    """
    texts = {name: f"difference of the {of} {WAYS[name][0]}{on if name == 'interior point' else ''}" for name in ways}
    return tuple(consequence(name.replace(" ", "-"), text, name, WAYS[name][1]) for name, text in texts.items())


class OneTrajectory(ListedNumbers):
    """Measures relative differences between solutions in time that different solvers compute.

    The difference is max_n ‖u_n − v_n‖_V / max_n ‖u_n‖_V. Every step of backward Euler minimises ½ vᵀSv − bᵀv over K^h
    with S = M/k + G. The active set method of the study starts from the last active set. Four other ways to solve the
    problem are compared with it: the same method from random active sets, two methods that share no code with it, and a
    fixed-point iteration with all of G on the right-hand side. If G softens, S is positive definite for short steps
    only, and longer steps are refused.
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
        size = norms(problem, states).max()
        numbers = {
            name: furthest(problem, states, path(rival, setup.scheme, setup.steps)) / size
            for name, rival in rivals(problem).items()
        }
        return with_h(setup.space.h, numbers)


def rivals(problem: SemiDiscrete) -> dict[str, SemiDiscrete]:
    """Return copies of a problem with other solvers, by the names of the solvers."""
    return {
        "random starts": replace(problem, solver=RandomStarts),
        "least squares": replace(problem, solver=LeastSquares),
        "fixed point": replace(problem, reference=0 * problem.reference, remainder=problem.elastic),
        "interior point": replace(problem, solver=InteriorPoint),
    }


class RandomStarts(Signorini):
    """Contact solver that starts every solve from a new random active set."""

    def __init__(self, S: sps.csc_array, N: sps.csr_array, x: Points | None = None) -> None:
        super().__init__(S, N, x)
        self.rng = np.random.default_rng(SEED)

    def __call__(self, b: Array) -> tuple[Array, Array]:
        self.active = self.rng.uniform(size=self.N.shape[0]) < self.rng.uniform()
        return super().__call__(b)


class LeastSquares:
    """Contact solver that computes the contact forces by nonnegative least squares, from the dual problem.

    The dual problem is min |L⁻¹(Nᵀλ − b)| over λ ≥ 0 with S = LLᵀ.

    Source: C. L. Lawson, R. J. Hanson, Solving Least Squares Problems, 1974, chapter 23.
    """

    def __init__(self, S: sps.csc_array, N: sps.csr_array, x: Points | None = None) -> None:
        self.N = N
        self.L = cholesky(S.toarray(), lower=True)
        self.columns = solve_triangular(self.L, N.T.toarray(), lower=True)

    def __call__(self, b: Array) -> tuple[Array, Array]:
        multipliers, _ = nnls(self.columns, solve_triangular(self.L, b, lower=True))
        return cho_solve((self.L, True), b - self.N.T @ multipliers), multipliers


class InteriorPoint:
    """Contact solver that solves a quadratic programme in all unknowns by an interior-point method (Clarabel)."""

    def __init__(self, S: sps.csc_array, N: sps.csr_array, x: Points | None = None) -> None:
        rows = N.shape[0]
        self.q = np.zeros(N.shape[1])
        self.unit = float(abs(S.diagonal()).max())
        P = sps.csc_matrix(sps.triu(S / self.unit))
        cones = [clarabel.NonnegativeConeT(rows)]
        how = settings(aim=Accuracy(gap=1e-15, feasibility=1e-14), enough=Accuracy(gap=1e-11, feasibility=1e-11))
        self.solver = clarabel.DefaultSolver(P, self.q, sps.csc_matrix(N), np.zeros(rows), cones, how)

    def __call__(self, b: Array) -> tuple[Array, Array]:
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

    The difference is max_n ‖σ_n − τ_n‖_Q / max_n ‖σ_n‖_Q. Every step minimises a strictly convex energy over the
    admissible stresses. So the earlier steps determine the stress and the multipliers of equilibrium, and neither the
    start of the search nor the method may change them.
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
    """Return the discrete stresses of all time steps at the quadrature points of the stress space."""
    return [state.stress.values for state in experiment.march()]
