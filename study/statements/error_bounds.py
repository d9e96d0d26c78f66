"""(5.20)–(5.21) and (5.42): the error of the semi-discrete problem (Problem 5.1), compared with its bounds.

The bounds are taken for v^h = Π^h u and u_0^h = Π^h u_0. With the error e = u − u^h and the interpolation error
η = u − Π^h u, their right sides without constants are

    (5.21):  ‖η_0‖_V + ‖η̇‖_{L²(0,T;V)} + ‖R(·; −η)‖_{L¹(0,T)}^{1/2} + ‖e_0‖_V,
    (5.42):  the same sum, but the third term is (‖σ_ν‖_{L^∞(0,T;L²(Γ3))} ‖η_ν‖_{L¹(0,T;L²(Γ3))})^{1/2}.

R(t; v) = ∫_{Γ3} σ_ν v_ν by (5.40), which ``residual`` compares with the definition of R. The paper includes ‖σ_ν‖ in
the constant c. Here ‖σ_ν‖ is part of the bound, so the second bound is larger than the first by (5.41). Two numbers
are measured for each bound: right side / error under refinement, and error / (c · right side) with a constant c that is
proved as follows.

**The constant.** Let χ = Π^h u − u^h = e − η, and B the operator of (4.2). Then (5.12) says

    ½ d/dt ‖χ‖_V² ≤ −(η̇, χ)_V − (Bu − BΠ^h u, χ)_V − (BΠ^h u − Bu^h, χ)_V + |R(·; −η)|.

By (4.3) the second product is at most L‖η‖_V ‖χ‖_V with L = L_G/m_A. The third is at most ω‖χ‖_V² with
ω = max(−m, 0)/m_A ≤ L, where m is the constant of monotonicity of G, which is 0 for monotone G. Gronwall's inequality
in the form of Brézis, φ²/2 ≤ a²/2 + ∫ gφ ⇒ φ ≤ a + ∫ g, gives

    ‖χ(t)‖_V ≤ e^{ωT} ((‖χ_0‖_V² + 2‖R‖_{L¹})^{1/2} + ∫_0^T (‖η̇‖_V + L‖η‖_V)),

From e = η + χ, ‖χ_0‖_V ≤ ‖e_0‖_V + ‖η_0‖_V and ‖η(s)‖_V ≤ ‖η_0‖_V + ∫_0^s ‖η̇‖_V, (5.17), it follows that

    ‖e‖_V ≤ e^{ωT} ((2 + LT) ‖η_0‖_V + ∫_0^T (2 + L(T − s)) ‖η̇(s)‖_V ds + ‖e_0‖_V + (2‖R‖_{L¹})^{1/2})
          ≤ c · (right side),   c = e^{ωT} max(2 + LT, ‖2 + L(T − ·)‖_{L²(0,T)}).

This proof avoids (5.15) and (5.16), whose term 2‖e‖_V ‖η‖_V would make c twice as large. The bound still overestimates,
because one constant serves several terms, and because L combines the largest slope of G with the smallest eigenvalue of
A.

**The ratio under refinement.** The error has the order min(1, s). The right side has the order of its term of lowest
order (``manufactured.regularity``): min(1, s') from η̇ in both bounds, and in (5.42) min(1, τ/2) from ‖η_ν‖^{1/2}. Only
the cell of the front contributes to ∫ σ_ν η_ν, which is of order λ and more. Let γ be the order of the error minus the
order of the term:

* γ = 0: the ratio does not change like a power of h.
* γ > 0: the bound is of lower order than the error, and the ratio is **not** bounded. The term over the error grows
  like h^{−γ} (1/8 for ``rough-trace`` in (5.42), 1/4 for ``moving-rough`` in both). This exponent is judged: it must
  be nearer to γ than to 0 or 2γ. Smoother parts, of a relative size h^{1/2}, change γ on coarse meshes, and the place
  of a fixed front within its cell changes the term by a tenth. So the meshes are fine and structured, and a fixed
  front, which is at 2/5 of the side, lies at 2/5 of a cell on all of them. A moving front passes all positions in
  cells.
* τ = 2, where ‖η_ν‖ ~ h² |log h|^{1/2} (``natural-front``): the term grows like |log h|^{1/4}, no power of h. A few
  meshes cannot distinguish it from a constant, so the change is reported and no bound is claimed.
"""

import math
from dataclasses import replace

import numpy as np
import pandas as pd

from manufactured.case import Case
from manufactured.law import KelvinVoigt
from study.fem.error_norm import FACET_POINTS
from study.fem.naming import resolve
from study.fem.quadrature import facet_rule
from study.ledger.check import ENOUGH, Groups, consequence, paper_claim
from study.ledger.datafiles import Row
from study.ledger.orders import fit
from study.ledger.quantities import Value, of_errors, values
from study.ledger.window import Window, around, positive_at_most
from study.solve.steps import rate_steps
from study.solve.tableau import MIDPOINT
from study.statements.shared.base import (
    EVOLVING,
    SOFTENING,
    Judged,
    ListedNumbers,
    Numbers,
    Records,
    Setting,
    grid,
    with_h,
)
from study.statements.shared.experiment import Experiment
from study.statements.shared.norms import Velocity, maximum, midpoints

INSTANTS = 64
"""Number of nodes of the midpoint rule that approximates norms in time."""
ROUND_OFF = 1e-11
"""Relative tolerance for round-off: smaller contact pressures, compared with the size of the stresses, count as 0."""
BOUNDS = "(5.21)", "(5.42)"
EXPONENTS = {bound: f"γ of {bound}" for bound in BOUNDS}
"""Names of the columns with the exponents γ: (right side of the bound) / error is predicted to grow like h^{−γ}."""
RATE, TRACE = "‖η̇‖_{L²(0,T;V)}", "(‖σ_ν‖ ‖η_ν‖)^{1/2}"
"""The terms of the bounds that may be of lower order than the error, as names of columns."""
LOGARITHM = "τ = 2"
"""Name of the column that tells whether the bound (5.42) has a logarithmic factor, which is so for τ = 2."""


class ErrorBounds(ListedNumbers):
    """Measures how far the bounds (5.21) and (5.42) exceed the error, with and without their constant c."""

    label = "(5.20)–(5.21), (5.42)"
    claim = "‖u − u^h‖_{L∞(0,T;V)} ≤ c (‖u_0 − v_0^h‖_V + ‖u̇ − v̇^h‖_{L²(0,T;V)} + ‖R‖^{1/2}) + c ‖u_0 − u_0^h‖_V"
    quick = grid(("full-contact", "advance-recede"), ("shaken",), (6, 12, 24))
    full = (
        *grid((*EVOLVING, "rough-1.75"), ("one-diagonal",), (8, 16, 32)),
        *grid((*EVOLVING, "rough-1.75", *SOFTENING, "heterogeneous", "corner"), ("unstructured",), (8, 16, 32)),
        *grid(("natural-front", "rough-trace"), ("one-diagonal",), (16, 36, 81)),
        *grid(("moving-rough",), ("one-diagonal",), (64, 128, 256)),
    )

    def setup(self, setting: Setting) -> Experiment:
        case = resolve(setting.case)
        return Experiment.at(setting, MIDPOINT, rate_steps(case.solution.body.T, setting.level, case.pace))

    def measure(self, setup: Experiment) -> Numbers:
        return with_h(setup.space.h, sides(setup))

    def records(self, setting: Setting, found: Row) -> Records:
        """Yield the rows of ``statements.csv``, with the predictions for the case as further numbers."""
        return super().records(setting, {**found, **predicted(resolve(setting.case))})

    def checks_of(self, case: str, groups: Groups) -> Judged:
        """Yield two criteria for each of the bounds, which depend on the predicted exponent γ of the case."""
        (table, *_) = groups.values()
        names = *EXPONENTS.values(), LOGARITHM
        known = {name: table[name].iloc[0] if name in table else math.nan for name in names}
        for bound, column in EXPONENTS.items():
            number = bound.strip("()")
            gamma = known[column]
            quantity = f"right-hand side of {bound} / error: change under refinement"
            growth = changing(bound, column)
            steady = consequence(
                f"steady-{number}",
                quantity,
                growth,
                Window(0.7, 1.4, "over two refinements: the orders differ by less than 1/4"),
                levels=ENOUGH,
            )
            if gamma > 0:
                term = RATE if gamma == known[EXPONENTS["(5.21)"]] else TRACE
                lower = f"{bound} is of lower order than the error: p in {term} / error ~ h^{{−p}}"
                window = around(gamma, gamma / 2, f"nearer to {gamma:g} than to 0 or {2 * gamma:g}")
                power = of_errors(term, lambda h, ratio: -fit(h, ratio))
                yield consequence(f"growth-{number}", lower, power, window, levels=ENOUGH), groups
            elif bound == "(5.42)" and known[LOGARITHM] > 0:
                lower = f"{quantity}, of lower order by |log h|^{{1/4}}"
                yield replace(steady, quantity=lower, if_missed="a few levels cannot show a logarithm"), groups
            else:
                yield steady, groups
            share = f"error / (c · right side of {bound})"
            yield (
                paper_claim(
                    f"constant-{number}",
                    share,
                    values(f"{bound}, c"),
                    positive_at_most(1.0, "with the constant c of the proof"),
                ),
                groups,
            )


def changing(bound: str, prediction: str) -> Value:
    """Return the function for the change of a bound under refinement; it needs the column with the prediction γ."""

    def value(table: pd.DataFrame) -> float:
        return float(table[bound].iloc[-1] / table[bound].iloc[0] + 0 * table[prediction].iloc[0])

    return value


def predicted(case: Case) -> Numbers:
    """Return the predictions for a case, by the names of columns.

    For each of the bounds (5.21) and (5.42), a column has the exponent γ for which bound / error is predicted to grow
    like h^{−γ}. One more column tells whether the bound (5.42) has a logarithmic factor.
    """
    found = case.regularity
    proved = {"(5.21)": found.rate_smoothness, "(5.42)": found.proved_order}
    growth = {column: max(case.order - proved[bound], 0.0) for bound, column in EXPONENTS.items()}
    return {**growth, LOGARITHM: float(found.trace == 2)}


def constant(law: KelvinVoigt, T: float) -> float:
    """Return the constant c of the error estimate that the module docstring proves, for a law and the final time T."""
    L = law.kappa
    omega = law.growth
    on_rate = math.sqrt(4 * T + 2 * L * T**2 + L**2 * T**3 / 3)
    return math.exp(omega * T) * max(2 + L * T, on_rate)


def sides(setup: Experiment) -> Numbers:
    """Return the quotients (right side) / error and error / (c · right side) for the bounds (5.21) and (5.42)."""
    v_norm = setup.v_norm
    problem = setup.problem
    T = setup.problem.T
    states = setup.scheme.march(problem, setup.steps)
    error = maximum(v_norm.distance(v_norm.sample(state.time), state.u) for state in states)
    start = v_norm.sample(0.0)
    velocity = Velocity(setup.solution, setup.space)
    times = midpoints(T, INSTANTS)
    k = T / INSTANTS
    # The work of contact ∫ σ_ν (Π^hu_ν − u_ν) and the squared norms ∫ |u_ν − Π^hu_ν|² and ∫ |σ_ν|² over Γ3.
    works, squares, pressures = np.zeros((3, INSTANTS))
    mesh = setup.space.mesh
    for face in setup.solution.faces:
        facets = setup.space.facets(face.part)
        rule = facet_rule(mesh, facets, face.part, face.rough, FACET_POINTS)
        exact = setup.solution.on(face, rule.s)
        nodes = setup.solution.at(mesh.p[:, mesh.facets[:, facets]])
        nodal = np.tensordot(face.part.normal, nodes.displacement(times), axes=1)
        eta = -exact.gap(times) - np.einsum("afn,afq->fqn", nodal, rule.shapes)
        pressure = exact.pressure(times)
        pressure = np.where(abs(pressure) > ROUND_OFF * exact.stress_scale(), pressure, 0.0)
        works += np.tensordot(rule.weights, pressure * eta, axes=2)
        squares += np.tensordot(rule.weights, eta**2, axes=2)
        pressures += np.tensordot(rule.weights, pressure**2, axes=2)
    rate = math.sqrt(k * np.sum(velocity.interpolation_error(times) ** 2))
    common = v_norm.distance(start, start.interpolant) + rate + v_norm.distance(start, problem.u0)
    work = math.sqrt(k * np.sum(abs(works)))
    trace = math.sqrt(k * np.sum(np.sqrt(squares)) * np.sqrt(pressures).max())
    right = {"(5.21)": common + work, "(5.42)": common + trace}
    c = constant(setup.solution.law, T)
    return {
        **{name: value / error for name, value in {**right, RATE: rate, TRACE: trace}.items()},
        **{f"{name}, c": error / (c * value) for name, value in right.items()},
    }
