"""One row of a rate table: the error of Problem 5.1 on one mesh, with everything that qualifies it.

The rate claims are about the semi-discrete solution u^h. Two trajectories with k and k/2 advance side by side; the
finer one stands for u^h and is measured at all its nodes, which are the nodes and the midpoints of the k-grid. The time
share max_n ‖u^h_k − u^h_{k/2}‖_V / error at common nodes then bounds what time discretisation contributes from above.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from manufactured.body import Kind
from manufactured.case import Case
from manufactured.tensors import Array
from study.fem.gauge import Gauge
from study.fem.independent import LeadingTerm
from study.fem.mesh import MeshFamily
from study.solve.evolution import State
from study.solve.solver_choice import contact_solver
from study.solve.tableau import MIDPOINT, Tableau
from study.statements.prop_5_4.experiment import Experiment

RESPONSE, MORE = 12, 4
"""Time steps in which the effect of a change of the load is followed at first, and how many times as many next. What
cells leave out changes from step to step and averages out over more of them, so that few give more rather than less."""
NEGLIGIBLE = 0.01
"""A relative change up to which more steps are not worth their while."""

WHERE = "case", "family", "scheme", "dim", "level", "h", "dofs", "steps", "k"
ERRORS = "error", "at", "interpolation_error", "discrete_error", "time_share", "interpolation_at"
OTHERS = "predicted_interpolation", "discrete_at", "initial_error", "discrete_time_share"
EVIDENCE = "residual", "quadrature_change", "clamped", "parallelogram"
COLUMNS = (*WHERE, *ERRORS, *OTHERS, *EVIDENCE)
"""``rates.csv`` but for the claim and the order; the README explains them."""


def measure(experiment: Experiment) -> Measurement:
    """Advance both trajectories and collect errors."""
    gauge, problem, M = experiment.gauge, experiment.problem, experiment.problem.M
    coarse = experiment.scheme.march(problem, experiment.steps)
    history: list[tuple[float, ...]] = []
    drift, residual, largest = 0.0, 0.0, 0.0
    for n, state in enumerate(experiment.scheme.march(problem, 2 * experiment.steps)):
        sample = gauge.sample(state.time)
        interpolant, discrete = sample.interpolant, sample.interpolant - state.u
        measured = [gauge.distance(sample, v) for v in (state.u, interpolant, (state.u + interpolant) / 2)]
        history.append((state.time, *measured[:2], math.sqrt(discrete @ (M @ discrete)), measured[2]))
        residual = max(residual, state.residual())
        if n == 0 or measured[0] > largest:
            largest, worst = measured[0], state
        if n % 2 == 0:
            difference = next(coarse).u - state.u
            drift = max(drift, math.sqrt(difference @ (M @ difference)))
    return Measurement(experiment, np.array(history).T, drift, residual, worst)


@dataclass(frozen=True, eq=False)
class Measurement:
    """What one experiment gave.

    Attributes:
        experiment: the experiment.
        history: (5, nodes): t, ‖u − u^h‖_V, ‖u − Π^h u‖_V, ‖Π^h u − u^h‖_V, ‖u − (u^h + Π^h u)/2‖_V.
        drift: max_n ‖u^h_k − u^h_{k/2}‖_V.
        residual: largest relative residual of a contact solve.
        worst: the state at which the error is largest.
    """

    experiment: Experiment
    history: Array
    drift: float
    residual: float
    worst: State

    def row(self, case: str, family: str, level: int) -> dict[str, Any]:
        """The line of the rate table."""
        experiment, space, drift = self.experiment, self.experiment.space, self.drift
        times, error, interpolation, discrete, _ = self.history
        first, second, third = (int(np.argmax(values)) for values in (error, interpolation, discrete))
        return {
            "case": case,
            "family": family,
            "scheme": experiment.scheme.name,
            "dim": space.dim,
            "level": level,
            "h": space.h,
            "dofs": space.dofs,
            "steps": experiment.steps,
            "k": experiment.problem.T / experiment.steps,
            "error": float(error[first]),
            "at": float(times[first]),
            "interpolation_error": float(interpolation[second]),
            "discrete_error": float(discrete[third]),
            "time_share": drift / float(error[first]),
            "interpolation_at": float(times[second]),
            "predicted_interpolation": LeadingTerm(experiment.solution, space).largest(),
            "discrete_at": float(times[third]),
            "initial_error": float(error[0]),
            "discrete_time_share": drift / float(discrete[third]),
            "residual": self.residual,
            "quadrature_change": self.quadrature_change(),
            "clamped": self.clamped(),
            "parallelogram": self.parallelogram(),
        }

    def clamped(self) -> float:
        """max |u^h| on Γ1 over max |u^h|, on the parts of the body: zero for u^h ∈ V."""
        space = self.experiment.space
        size = np.linalg.norm(space.nodal(self.worst.u), axis=0)
        on = [part.contains(space.mesh.p, 1e-9 * space.h) for part in space.body.of(Kind.CLAMPED)]
        return float(size[np.any(on, axis=0)].max() / max(size.max(), np.finfo(float).tiny))

    def parallelogram(self) -> float:
        """max_n |2e² + 2i² − (2m)² − d²| over max_n d², for e, i, d, m of ``history``: zero by the parallelogram law.

        d is measured by the matrix M, the others by the gauge, whose means of A's factor are those of another rule.
        Were u − Π^h u measured in place of the others, e = m = i would miss all of d²; i in place of e alone misses
        2 |i² − e²|, twice d² if u^h is the best approximation.
        """
        _, error, interpolation, discrete, halfway = self.history
        missed = 2 * error**2 + 2 * interpolation**2 - (2 * halfway) ** 2 - discrete**2
        return float(abs(missed).max() / (discrete**2).max())

    def quadrature_change(self) -> float:
        """Relative change of the worst error when every cell rule is raised by two degrees, and its points not moved.

        The error's own rule changes it directly; the load's changes u^h by the response of the linear problem without
        contact to the change of the load, in RESPONSE steps, and in more up to those of u^h while it is not NEGLIGIBLE.
        """
        experiment, problem, time = self.experiment, self.experiment.problem, self.worst.time
        finer = Gauge(experiment.solution, experiment.space, raised=2, along=())
        error, raised = (gauge.distance(gauge.sample(time), self.worst.u) for gauge in (experiment.gauge, finer))
        change = replace(
            problem,
            load=lambda t: finer.load(t) - experiment.gauge.load(t),
            u0=np.zeros_like(problem.u0),
            N=problem.N[:0],
            remainder=None,
            solver=contact_solver(experiment.space),
        )

        def relative(steps: int) -> float:
            drift = max(math.sqrt(state.u @ (problem.M @ state.u)) for state in MIDPOINT.march(change, steps))
            return (abs(raised - error) + drift) / error

        steps = RESPONSE
        while (found := relative(steps)) > NEGLIGIBLE and steps < 2 * experiment.steps:
            steps = min(MORE * steps, 2 * experiment.steps)
        return found


def measure_case(case: Case, family: MeshFamily, level: int, scheme: Tableau, steps: int) -> dict[str, Any]:
    """The row of one (case, family, scheme, level) with steps of size T/steps."""
    return measure(Experiment.of(case.solution, family, level, scheme, steps)).row(case.name, family.name, level)
