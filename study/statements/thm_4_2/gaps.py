"""How far Problems 3.1 and 3.2 are apart on the same V^h, and how far they may be.

Problem 3.1 is solved in displacements on K^h; Problem 3.2 in stresses on Σ^h(t), where u_n is a multiplier, not held in
K^h. The two share the matrix of strains, the load and the time steps of backward Euler, and nothing else.

How far they may be apart is known, without the solution. At step j the interior point stops with a duality gap g_j,
and ‖σ_j − σ*‖² in the norm of C⁻¹ and ‖ε_j − ε*‖² in that of C = A/k + G are at most g_j, σ* and ε* exact for the
same ε_{j−1} (``study.solve.interior_point``). With ω = max(−m, 0)/m_A, 0 for monotone G, C ≥ (1 − kω) A/k: a step is
Lipschitz in ε_{j−1} with q = 1/(1 − kω) for the norm of A, which is that of V, and A ≤ q k C. So with R_n = q R_{n−1} +
g_n^{1/2}, which is Σ_{j≤n} g_j^{1/2} for monotone G,

    ‖u_n(3.2) − u_n(3.1)‖_V ≤ (q k)^{1/2} R_n,      ‖σ_n(3.2) − σ_n(3.1)‖_Q ≤ (L_A/k + L_G)^{1/2} R_n

but for the tolerances of both solvers: A/k alone carries ε_{j−1} into σ_n, with ‖A ε/k‖_{C⁻¹} ≤ (q/k)^{1/2} ‖ε‖_A, and
|τ|² ≤ (L_A/k + L_G) C⁻¹τ·τ. The same holds of Cε + β(ε − P_K ε), with A/k + C and β(ε − P_K ε) apart.
``paper/proofs_rest.tex`` has the proof.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sps
from scipy.optimize import nnls

from manufactured.case import Case
from manufactured.exact import ExactSolution
from manufactured.tensors import Array
from study.fem.gauge import Gauge
from study.fem.material import on_cells
from study.fem.mesh import MeshFamily
from study.fem.naming import family_named, resolve
from study.fem.space import Space
from study.ledger.datafiles import CsvFile
from study.ledger.rounding import power_of_ten
from study.solve.evolution import SemiDiscrete
from study.solve.steps import step_size
from study.solve.stress_problem import StressProblem
from study.solve.tableau import BACKWARD_EULER
from study.statements.shared import estimates
from study.statements.shared.base import Setting, Statement
from study.statements.shared.scope import Scope


class Gaps(NamedTuple):
    """Largest gaps over the steps 1, 2, …, each relative to the largest size of its quantity.

    In ``equivalence.csv`` gaps and bounds are rounded (``magnitudes``).

    Attributes:
        displacement_gap: ‖u_n(3.2) − u_n(3.1)‖_V / max_n ‖u_n(3.1)‖_V.
        stress_gap: ‖σ_n(3.2) − σ_n(3.1)‖_Q / max_n ‖σ_n(3.1)‖_Q.
        admissibility: sup of (f(t_n), v)_V − (σ_n, ε(v))_Q over v ∈ K^h with |v| = 1 (nodal values)
            for σ_n of Problem 3.2, / max_n |F(t_n)|.
        energy_gap: |(σ_n, ε(u_n))_Q − (f(t_n), u_n)_V| of Problem 3.2, (4.14), / max_n |(f(t_n), u_n)_V|.
        membership: largest normal displacement v_ν > 0 at a vertex of Γ3 for v = u_n of Problem 3.2, / max_n |u_n|_∞.
        displacement_bound: what the duality gaps allow for displacement_gap, (q k)^{1/2} R.
        stress_bound: the same for stress_gap, (L_A/k + L_G)^{1/2} R.
    """

    displacement_gap: float
    stress_gap: float
    admissibility: float
    energy_gap: float
    membership: float
    displacement_bound: float
    stress_bound: float


COLUMNS = ("case", "form", "level", "h", "steps", *Gaps._fields, "family")
"""``form`` is the space of strains, whose duals the stresses are."""
LEAST = 1e-9
"""Smaller gaps are given as at most this: they are what the last iteration of a solver leaves by chance."""
EQUIVALENCE = CsvFile("equivalence.csv", ("case", "family", "level"), COLUMNS)


class OnOneMesh(Statement):
    """Problem 3.2 on the strains of V^h against Problem 3.1, by backward Euler with k ~ h/2."""

    file = EQUIVALENCE
    of_every_case = True

    def settings(self, scope: Scope) -> list[Setting]:
        """Every case on coarse levels, for the interior point method is for small problems."""
        return [
            Setting(reference, family.name, n)
            for reference, case in zip(scope.cases, scope.resolved(), strict=True)
            for family in scope.families_of(case)[: None if scope.every_family else 1]
            for n in (scope.equivalence if case.solution.body.dim == 2 else scope.solid_equivalence)
        ]

    def measure(self, setting: Setting) -> dict[str, Any]:
        return compare(resolve(setting.case), family_named(setting.family), setting.level, self.steps(setting))

    def cost(self, setting: Setting) -> float:
        return float(setting.level**setting.dim * self.steps(setting)) * (70 if setting.dim == 2 else 1000)

    def memory(self, setting: Setting) -> float:
        return estimates.equivalence(setting.dim, setting.level, setting.family)

    def steps(self, setting: Setting) -> int:
        """Two for every cell along a side."""
        return 2 * setting.level


def compare(case: Case, family: MeshFamily, level: int, steps: int) -> dict[str, Any]:
    """A row of ``equivalence.csv``."""
    displacements, stresses = problems(case.solution, family, level)
    found = gaps(displacements, stresses, steps)._asdict()
    where = {"case": case.name, "form": "strains of V^h", "level": level, "h": stresses.space.h, "steps": steps}
    return {**where, **magnitudes(found), "family": family.name}


def magnitudes(found: Mapping[str, float]) -> dict[str, float]:
    """Rounds what the tolerance of the interior-point method decides to powers of ten, up.

    Gaps and bounds follow from the duality gap at which the method happens to stop. With a tolerance of 0.1 to 2 times
    1e-15, bounds changed by factors up to 14 and gaps by factors up to 100, so that no digit of them means anything.
    Rounding up is monotone: a gap that is at most its bound is so afterwards. A gap above its bound stays as it is, and
    its bound too, so that the verdict on it stays.

    Args:
        found: the fields of ``Gaps`` by name.
    """
    rounded = dict(found)
    for what in ("displacement", "stress"):
        names = gap, bound = f"{what}_gap", f"{what}_bound"
        if found[gap] <= found[bound]:
            rounded |= {name: power_of_ten(found[name], LEAST) for name in names}
    return rounded


def problems(solution: ExactSolution, family: MeshFamily, level: int) -> tuple[SemiDiscrete, StressProblem]:
    """Problems 3.1 and 3.2 of an exact solution on one mesh."""
    space = Space(family(solution.body, level), solution.body)
    gauge = Gauge(solution, space)
    u0 = gauge.sample(0.0).interpolant
    return SemiDiscrete.of(space, solution.law, gauge.load, u0), StressProblem.of(space, solution.law, gauge.load, u0)


def gaps(displacements: SemiDiscrete, stresses: StressProblem, steps: int) -> Gaps:
    """March both problems in lockstep, holding no more than one step of either.

    Raises:
        StepsError: steps so long that they need not have one solution, for which there is no q.
    """
    space, law, M = stresses.space, stresses.law, displacements.M
    cells, k, root, radius = on_cells(space, law), step_size(displacements.T, steps), np.sqrt(space.volumes), 0.0
    BACKWARD_EULER.require_unique(k, law.growth)
    q = 1 / (1 - k * law.growth)
    worst, sizes = np.zeros(5), np.full(5, np.finfo(float).tiny)
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
        worst, sizes = np.maximum(worst, now), np.maximum(sizes, size)
    bounds = radius * np.sqrt([q * k, law.A.lipschitz / k + law.G.lipschitz]) / sizes[:2]
    return Gaps(*(float(value) for value in [*(worst / sizes), *bounds]))


def beyond(defect: Array, N: sps.csr_array) -> float:
    """sup {defect·v : Nv ≤ 0, |v| ≤ 1}, which is the distance of the defect from the cone {Nᵀλ : λ ≥ 0}."""
    touched = np.unique(N.indices)
    _, distance = nnls(N[:, touched].T.toarray(), defect[touched])
    return float(np.hypot(distance, np.linalg.norm(np.delete(defect, touched))))
