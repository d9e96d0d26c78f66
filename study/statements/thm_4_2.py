"""Theorem 4.2, on one mesh: the displacement problem (3.1) and the stress problem (3.2) have the same solution.

**The measurement.** Problem 3.1 is solved in displacements on K^h. Problem 3.2 is solved in stresses on Σ^h(t), dual to
the strains of V^h, by an interior-point method, in which u_n is a multiplier that is not forced into K^h. Both share
only the strain matrix, the load and the time steps of backward Euler. A row of ``equivalence.csv`` has the *gaps*, the
largest differences between both solutions over time.

**The tolerance.** The gaps have a bound that can be computed without the exact solution. At step j the interior-point
method stops with a duality gap g_j. Then ‖σ_j − σ*‖² in the norm of C⁻¹ and ‖ε_j − ε*‖² in the norm of C = A/k + G are
at most g_j, where σ* and ε* solve the step exactly for the same ε_{j−1} (``study.solve.interior_point``). Let
ω = max(−m, 0)/m_A, which is 0 for monotone G. Then C ≥ (1 − kω) A/k, so a step is Lipschitz in ε_{j−1} with q = 1/(1 −
kω) in the norm of A, which is the norm of V, and A ≤ q k C. With R_n = q R_{n−1} + g_n^{1/2}, which is Σ_{j≤n}
g_j^{1/2} for monotone G,

    ‖u_n(3.2) − u_n(3.1)‖_V ≤ (q k)^{1/2} R_n,      ‖σ_n(3.2) − σ_n(3.1)‖_Q ≤ (L_A/k + L_G)^{1/2} R_n

up to the tolerances of both solvers. The second bound holds because A/k alone carries ε_{j−1} into σ_n, with
‖A ε/k‖_{C⁻¹} ≤ (q/k)^{1/2} ‖ε‖_A, and |τ|² ≤ (L_A/k + L_G) C⁻¹τ·τ. The same bounds hold for
G ε = G_0 ε + β(ε − P_K ε) with a linear G_0, where A/k + G_0 and β(ε − P_K ε) are treated separately.
``paper/proofs_study.tex`` has the proof.

**The sensitivity.** ``study.controls.matrix`` solves Problem 3.1 with a deliberate fault and Problem 3.2 without it.
The checks must notice the fault, so the comparison is not one of a solution with itself. How stresses are computed is
tested in a process that has no displacement solver (``tests/controls/test_fault_matrix.py``).

``thm_4_2_own_space`` solves Problem 3.2 on a stress space without using displacements.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
import scipy.sparse as sps
from scipy.optimize import nnls

from manufactured.tensors import Array
from study.fem.space import on_cells
from study.ledger.check import accuracy, identity, paper_claim
from study.ledger.datafiles import CsvFile, Row
from study.ledger.quantities import quotients, values
from study.ledger.text import power_of_ten
from study.ledger.window import at_most, positive_at_most
from study.solve.evolution import SemiDiscrete
from study.solve.steps import step_size
from study.solve.stress_problem import StressError, StressProblem
from study.solve.tableau import BACKWARD_EULER
from study.statements.shared.base import Numbers, Setting, Statement
from study.statements.shared.experiment import Experiment
from study.statements.shared.scope import Scope


class Gaps(NamedTuple):
    """Largest differences of the solutions of the displacement problem (3.1) and the stress problem (3.2), with bounds.

    Differences are the largest over all time steps. Each difference and each bound is relative to the largest size of
    its quantity. In ``equivalence.csv`` differences and bounds are rounded (``magnitudes``).

    Attributes:
        displacement_gap: difference of the displacements, ‖u_n(3.2) − u_n(3.1)‖_V / max_n ‖u_n(3.1)‖_V.
        stress_gap: difference of the stresses, ‖σ_n(3.2) − σ_n(3.1)‖_Q / max_n ‖σ_n(3.1)‖_Q.
        admissibility: violation of σ_n ∈ Σ^h(t_n) by the stress of Problem 3.2. It is the supremum of
            (f(t_n), v)_V − (σ_n, ε(v))_Q over v ∈ K^h with nodal values |v| = 1, divided by max_n |F(t_n)|.
        energy_gap: violation of (4.14) by Problem 3.2, |(σ_n, ε(u_n))_Q − (f(t_n), u_n)_V| / max_n |(f(t_n), u_n)_V|.
        membership: largest penetration of u_n of Problem 3.2 at a vertex of Γ3, divided by max_n |u_n|_∞.
        displacement_bound: bound of displacement_gap, (q k)^{1/2} R. The number R is computed from the duality gaps of
            all steps, and q is the Lipschitz constant of a step; the module docstring defines both.
        stress_bound: bound of stress_gap with the same R, (L_A/k + L_G)^{1/2} R.
    """

    displacement_gap: float
    stress_gap: float
    admissibility: float
    energy_gap: float
    membership: float
    displacement_bound: float
    stress_bound: float


GAP_BOUNDS = ("displacement_bound", "stress_bound")
EQUIVALENCE = CsvFile("equivalence.csv")


def stress_problem(setup: Experiment) -> StressProblem:
    """Return the stress problem (3.2) of the exact solution of an experiment, on the same mesh.

    It takes nothing from the displacement problem that is solved, so a fault of the latter does not change it.

    Raises:
        StressError: the exact solution has an initial gap, which Problem 3.2 does not allow.
    """
    if setup.solution.has_initial_gap:
        raise StressError(
            "Problem 3.2 does not allow an initial gap: K is no cone then, and (σ, ε(u))_Q = (f, u)_V, "
            "(4.14), lacks the work of σ_ν on the gap; take a case whose initial_gap is 0"
        )
    u0 = setup.v_norm.sample(0.0).interpolant
    return StressProblem.of(setup.space, setup.solution.law, setup.problem.load, u0)


def gaps(displacements: SemiDiscrete, stresses: StressProblem, steps: int) -> Gaps:
    """Solve both problems by backward Euler, and return the largest differences of their solutions over all steps.

    Args:
        displacements: the displacement problem (3.1).
        stresses: the stress problem (3.2).
        steps: the number of time steps.

    Raises:
        StepsError: the steps are so long that the problem of a step may have no or several solutions.
    """
    space = stresses.space
    law = stresses.law
    M = displacements.M
    cells = on_cells(space, law)
    k = step_size(displacements.T, steps)
    root = np.sqrt(space.volumes)
    radius = 0.0
    BACKWARD_EULER.require_unique(k, law.growth)
    q = 1 / (1 - k * law.growth)  # Errors of earlier steps are multiplied at most by this factor in ‖·‖_V.
    worst = np.zeros(5)
    sizes = np.full(5, np.finfo(float).tiny)
    pairs = zip(BACKWARD_EULER.march(displacements, steps), stresses.march(steps), strict=True)
    for (before, _), (primal, dual) in pairwise(pairs):
        strain = space.strain(primal.u)
        stress = cells.stress((strain - space.strain(before.u)) / k, strain)
        load = displacements.load(primal.time)
        defect = load - space.functional(dual.stress)
        difference = dual.u - primal.u
        radius = q * radius + np.sqrt(dual.gap)
        now = [
            np.sqrt(difference @ (M @ difference)),
            np.linalg.norm(root * (dual.stress - stress)),
            beyond(defect, displacements.N),
            abs(defect @ dual.u),
            max((displacements.N @ dual.u).max(), 0.0),
        ]
        of_both = np.sqrt(primal.u @ (M @ primal.u)), np.linalg.norm(root * stress)
        size = [*of_both, np.linalg.norm(load), abs(load @ dual.u), abs(dual.u).max()]
        worst = np.maximum(worst, now)
        sizes = np.maximum(sizes, size)
    bounds = radius * np.sqrt([q * k, law.A.lipschitz / k + law.G.lipschitz]) / sizes[:2]
    return Gaps(*(float(value) for value in [*(worst / sizes), *bounds]))


def beyond(defect: Array, N: sps.csr_array) -> float:
    """Return the distance of a vector from the cone of contact forces {Nᵀλ : λ ≥ 0}.

    The distance equals sup {defect·v : Nv ≤ 0, |v| ≤ 1}.
    """
    touched = np.unique(N.indices)
    _, distance = nnls(N[:, touched].T.toarray(), defect[touched])
    return float(np.hypot(distance, np.linalg.norm(np.delete(defect, touched))))


LEAST_GAP = 1e-9
"""Smallest reported difference. Smaller ones depend on the iteration at which a solver stops."""


def magnitudes(differences: Row) -> Numbers:
    """Return differences of the solutions of both problems, and their bounds, rounded up to powers of ten.

    Only their size is meaningful, because they depend on the duality gap at which the interior-point method happens to
    stop. With tolerances of 0.1 to 2 times 1e-15, bounds changed by factors up to 14 and differences by factors up to
    100. Rounding up is monotone, so a difference that is at most its bound remains so. A difference above its bound is
    not rounded, and neither is its bound, so that rounding does not change the verdict.

    Args:
        differences: the fields of ``Gaps`` by name.
    """
    rounded = dict(differences)
    for what in ("displacement", "stress"):
        names = gap, bound = f"{what}_gap", f"{what}_bound"
        if differences[gap] <= differences[bound]:
            rounded |= {name: power_of_ten(differences[name], LEAST_GAP) for name in names}
    return rounded


GAP_OVER_BOUND = "difference between Problems 3.1 and 3.2 / its bound from the duality gap"
PROVED_GAP = positive_at_most(1.0, "proved")
AGREEMENT = positive_at_most(1e-7, "at every step")


class SameMesh(Statement):
    """Measures how far the solutions of the displacement problem (3.1) and of the stress problem (3.2) differ.

    Differences are divided by their bounds. Conditions that the solver of the stress problem does not impose, such as u
    ∈ K^h, are measured as well. The time scheme is backward Euler with k ~ h/2.
    """

    label = "Thm 4.2"
    claim = "Problem 3.2 on the strains of V^h and Problem 3.1 have one solution"
    file = EQUIVALENCE
    of_every_case = True
    per_step = 70.0, 1000.0
    checks = (
        paper_claim(
            "displacement",
            f"displacement {GAP_OVER_BOUND}",
            quotients("displacement_gap", "displacement_bound"),
            PROVED_GAP,
        ),
        paper_claim("stress", f"stress {GAP_OVER_BOUND}", quotients("stress_gap", "stress_bound"), PROVED_GAP),
        accuracy(
            "allowed",
            "bound of the difference from the duality gap / size of the solution",
            lambda of: of[[*GAP_BOUNDS]].to_numpy().max(axis=1),
            positive_at_most(
                1e-5, "32 steps, each with the root of a duality gap of 1e-15, and norms that differ by a factor 10"
            ),
        ),
        identity("admissibility", "violation of σ^h ∈ Σ^h(t)", values("admissibility"), AGREEMENT),
        identity("energy", "violation of (σ, ε(u))_Q = (f, u)_V, (4.14)", values("energy_gap"), AGREEMENT),
        paper_claim(
            "membership",
            "violation of u ∈ K^h, which Problem 3.2 does not impose",
            values("membership"),
            at_most(1e-7, "at every step"),
        ),
    )

    def settings(self, scope: Scope) -> list[Setting]:
        """Return the settings: every case on coarse levels only, because the interior-point method is slow."""
        return [
            Setting(reference, family.name, n)
            for reference, case in zip(scope.cases, scope.resolved(), strict=True)
            for family in scope.families_of(case)[: None if scope.every_family or scope.full else 1]
            for n in (scope.equivalence if case.solution.body.dim == 2 else scope.solid_equivalence)
        ]

    def setup(self, setting: Setting) -> Experiment:
        return Experiment.at(setting, BACKWARD_EULER, self.steps(setting))

    def measure(self, setup: Experiment) -> Numbers:
        """Solve Problem 3.1 as ``setup`` says, and Problem 3.2 for the exact solution, and compare both."""
        gaps_of_both = gaps(setup.solved or setup.problem, stress_problem(setup), setup.steps)
        place = {"h": setup.space.h, "steps": setup.steps, "form": "strains of V^h"}
        return {**place, **magnitudes(gaps_of_both._asdict())}

    def steps(self, setting: Setting) -> int:
        """Return the number of time steps, two for every cell along a side."""
        return 2 * setting.level
