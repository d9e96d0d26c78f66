"""Propositions 5.3 and 5.4: the semi-discrete error ‖u − u^h‖_{L∞(0,T;V)} tends to 0, and is O(h) if u is smooth.

The other statements that are judged from ``rates.csv`` stand here as well: (5.23), the size of the interpolation error;
(5.36), the regularity that Proposition 5.4 assumes; and, beyond the paper, bodies with an initial gap.

**Measured.** Problem 5.1 is solved for every exact solution that satisfies (5.36), on finer and finer meshes of one or
two mesh families. Two cases are measured on every mesh family that can mesh their bodies. A row of ``rates.csv`` is one
mesh. It holds the maxima over time of the error ‖u − u^h‖_V, of the interpolation error ‖u − Π^h u‖_V and of the
discrete error ‖Π^h u − u^h‖_V. Diagnostics show that other errors are negligible: the error of time steps, the
quadrature error, the residual of the contact solver, and u^h on Γ1.

The proposition is about the semi-discrete solution u^h. Two discrete solutions are computed, with time steps k and k/2.
The finer one is used as u^h, and its error is measured at all its time nodes. The *time share*
max_n ‖u^h_k − u^h_{k/2}‖_V / error, over the common time nodes, is an upper bound of the contribution of the time
discretisation.

**Judged.** Orders must be 1 from both sides, because (5.37) is sharp for piecewise linear functions. The size of the
error is judged by three relations; the first one shares no code with the computation of the errors:

* ‖u − Π^h u‖_V agrees with its leading term, which is computed from second derivatives of u (``SizeOfInterpolation``,
  (5.23));
* (‖u − u^h‖² + ‖Π^h u − u^h‖²)^{1/2} / ‖u − Π^h u‖ = 1 within 10 %. If u^h were the best approximation of u in V^h,
  this would be Pythagoras' theorem; contact and memory change it little. This relates the error to the interpolation
  error;
* the parallelogram law of u − u^h and u − Π^h u holds at every time. This relates the error to u^h. If the
  interpolation error were reported as the error by mistake, the other relations would hold, because both errors are
  nearly equal.

**Why ‖Π^h u − u^h‖_V is reported as well.** For piecewise linear functions nearly the whole error is interpolation
error. Its maximum may be at t = 0, before anything is solved. The discrete error shows the work of the solver; its
order and its share of the interpolation error are judged separately.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from manufactured.body import Kind
from manufactured.case import INITIAL_GAP
from manufactured.tensors import Array
from study.fem.error_norm import ErrorNorm
from study.fem.independent import LeadingTerm
from study.fem.naming import choose
from study.ledger.check import MIN_LEVELS, ROUNDING_ROOM, Check, Groups, accuracy, consequence, identity, paper_claim
from study.ledger.datafiles import CsvFile, Row, with_orders
from study.ledger.quantities import (
    extrapolated,
    finest_quotient,
    fitted,
    level_by_level,
    limit,
    of_errors,
    over_refinements,
    quotients,
    ratios,
)
from study.ledger.window import STEEPER, Window, around, at_least, at_most, between, positive_at_most
from study.solve import multigrid
from study.solve.evolution import State, norm
from study.solve.tableau import MIDPOINT, SCHEMES
from study.statements.shared.base import (
    ByCase,
    Experiment,
    Judged,
    Numbers,
    Records,
    Setting,
    Statement,
    check_of_order,
)
from study.statements.shared.meshes import LEADING, in_leading_term, split, value_of_case
from study.statements.shared.norms import maximum, time_nodes
from study.statements.shared.scope import Scope

RATES = CsvFile("rates.csv", ("order",), with_orders)


@dataclass(frozen=True, order=True)
class RateSetting(Setting):
    """The setting of one row of ``rates.csv``: a case, a mesh, a time scheme and a number of time steps."""

    scheme: str
    steps: int


class FromRates(Statement):
    """Base class of the statements that are judged from the rows of one proposition in ``rates.csv``.

    Attributes:
        proposition: the label of the proposition.
    """

    file = RATES
    proposition: str

    def by_case(self, rows: pd.DataFrame) -> ByCase:
        return super().by_case(rows[rows["claim"] == self.proposition])


class Rates(FromRates):
    """Base class of the statements about Propositions 5.3 and 5.4, which measure the error ‖u − u^h‖_V."""

    of_every_case = True
    per_step = 7.0, 150.0  # A cell in 3D costs more, because of more components and a denser matrix factor.

    def settings(self, scope: Scope) -> list[RateSetting]:
        """Return the settings for all cases of the proposition, on all their mesh families and levels."""
        return [
            RateSetting(reference, family.name, n, scope.scheme, scope.steps(case, n))
            for reference, case, family in scope.on_families()
            if case.proposition == self.proposition
            for n in scope.levels_on(case, family)
        ]

    def setup(self, setting: RateSetting) -> Experiment:
        return Experiment.at(setting, choose("scheme", setting.scheme, SCHEMES), setting.steps)

    def measure(self, setup: Experiment) -> Numbers:
        return measure(setup).row()

    def records(self, setting: RateSetting, found: Row) -> Records:
        """Return the measured row of ``rates.csv``, with the label of the proposition as a further column.

        The label is not a part of the measurement, so that a case may move between propositions without being measured
        again.
        """
        return super().records(setting, {"claim": self.proposition, **found})


# Measurement, with few steps where a few suffice, because it takes most of the run time of a study.
NEGLIGIBLE_QUADRATURE = 0.01
"""Relative effect of quadrature errors on the error up to which a rough estimate with few time steps suffices."""


def measure(experiment: Experiment) -> Measurement:
    """Solve a problem with the time steps k and k/2, and return the errors of the solution with k/2 over time.

    The result also has the distance of the two discrete solutions.

    Args:
        experiment: the problem with its exact solution. Its number of steps belongs to the time step k.
    """
    v_norm = experiment.v_norm
    problem = experiment.problem
    coarse = experiment.march(experiment.steps)
    history: list[tuple[float, ...]] = []
    drifts: list[float] = []
    residuals: list[float] = []
    largest = 0.0
    steps = 2 * experiment.steps
    samples = v_norm.samples(time_nodes(problem.T, steps))
    for n, (state, sample) in enumerate(zip(experiment.march(steps), samples, strict=True)):
        interpolant = sample.interpolant
        error, interpolation, halfway = (
            v_norm.distance(sample, v) for v in (state.u, interpolant, (state.u + interpolant) / 2)
        )
        history.append((state.time, error, interpolation, norm(problem, interpolant - state.u), halfway))
        residuals.append(state.residual())
        if n == 0 or error > largest:
            largest = error
            worst = state
        if n % 2 == 0:
            drifts.append(norm(problem, next(coarse).u - state.u))
    return Measurement(experiment, np.array(history).T, maximum(drifts), maximum(residuals), worst)


@dataclass(frozen=True, eq=False)
class Measurement:
    """Errors of a discrete solution u^h over time.

    Attributes:
        experiment: the experiment.
        history: five rows with values at the time nodes, (5, nodes): the time t, the error ‖u − u^h‖_V, the
            interpolation error ‖u − Π^h u‖_V, the discrete error ‖Π^h u − u^h‖_V, and the error of the mean of both, ‖u
            − (u^h + Π^h u)/2‖_V.
        drift: the effect of the time step, max_n ‖u^h_k − u^h_{k/2}‖_V for the solutions with the steps k and k/2.
        residual: the largest relative residual that the contact solver left in a time step.
        worst: the discrete solution at the time of the largest error.
    """

    experiment: Experiment
    history: Array
    drift: float
    residual: float
    worst: State

    def errors(self) -> Numbers:
        """Return the largest errors over time and related numbers, by the names of columns of ``rates.csv``.

        * "error", "interpolation_error" and "discrete_error" are the largest values of ‖u − u^h‖_V, ‖u − Π^h u‖_V and
          ‖Π^h u − u^h‖_V. "at", "interpolation_at" and "discrete_at" are the times at which they occur.
        * "initial_error" is ‖u − u^h‖_V at t = 0.
        * "time_share" and "discrete_time_share" are the effect of the time step, ``drift``, divided by "error" and by
          "discrete_error".
        """
        error, interpolation, discrete = self.history[1:4].max(axis=1)
        at, interpolation_at, discrete_at = self.history[0, self.history[1:4].argmax(axis=1)]
        return {
            "error": error,
            "at": at,
            "interpolation_error": interpolation,
            "discrete_error": discrete,
            "time_share": self.drift / error,
            "interpolation_at": interpolation_at,
            "discrete_at": discrete_at,
            "initial_error": self.history[1, 0],
            "discrete_time_share": self.drift / discrete,
        }

    def row(self) -> Numbers:
        """Return the errors and diagnostics as a row of ``rates.csv``, without case, mesh family and level."""
        experiment = self.experiment
        space = experiment.space
        return {
            "scheme": experiment.scheme.name,
            "dim": space.dim,
            "h": space.h,
            "dofs": space.dofs,
            "steps": experiment.steps,
            "k": experiment.problem.T / experiment.steps,
            **self.errors(),
            "predicted_interpolation": LeadingTerm(experiment.solution, space).largest(),
            "residual": self.residual,
            "quadrature_change": self.quadrature_change(),
            "clamped": self.clamped(),
            "parallelogram": self.parallelogram(),
        }

    def clamped(self) -> float:
        """Return the largest |u^h| on the clamped boundary Γ1 divided by the largest |u^h|; the result must be 0.

        Γ1 is taken from the body, because V^h might have a wrong Γ1.
        """
        space = self.experiment.space
        size = np.linalg.norm(space.nodal(self.worst.u), axis=0)
        on = [part.contains(space.mesh.p, 1e-9 * space.h) for part in space.body.of(Kind.CLAMPED)]
        return float(size[np.any(on, axis=0)].max() / max(size.max(), np.finfo(float).tiny))

    def parallelogram(self) -> float:
        """Return how far the measured errors violate the parallelogram law; the result must be 0.

        The result is max_n |2e² + 2i² − (2m)² − d²| / max_n d² over the time nodes n. The errors are e = ‖u − u^h‖_V, i
        = ‖u − Π^h u‖_V, d = ‖Π^h u − u^h‖_V and m = ‖u − (u^h + Π^h u)/2‖_V. The discrete error d is computed with the
        matrix M, the others by ``ErrorNorm`` with another quadrature rule for A. If the interpolation error replaced e
        and m by mistake, the result would be 1, because e = m = i leaves d². If it replaced only e, the defect would be
        2 |i² − e²|, which is 2d² if u^h is the best approximation.
        """
        _, error, interpolation, discrete, halfway = self.history
        missed = 2 * error**2 + 2 * interpolation**2 - (2 * halfway) ** 2 - discrete**2
        return float(abs(missed).max() / (discrete**2).max())

    def quadrature_change(self) -> float:
        """Return the relative change of the largest error of the discrete solution u^h under finer quadrature.

        The degree of every rule on cells is raised by two, and points are not moved along lines of low regularity. Two
        changes are added. The first is the change of the error norm. The second is the change of u^h, which is
        estimated by the linear problem without contact whose load is the change of the load. This problem is solved
        with 4 time steps; if the change is then above NEGLIGIBLE_QUADRATURE, with 16, and at last with the steps of
        u^h. The quadrature error changes from step to step and averages out over many steps, so a small number of steps
        overestimates its effect.
        """
        experiment = self.experiment
        problem = experiment.problem
        error = self.history[1].max()
        finer = ErrorNorm(experiment.solution, experiment.space, raised=2, aligned=False)
        raised = finer.distance(finer.sample(self.worst.time), self.worst.u)
        change = replace(
            problem,
            load=lambda t: finer.load(t) - experiment.v_norm.load(t),
            u0=np.zeros_like(problem.u0),
            N=problem.N[:0],
            gap=0.0,
            remainder=None,
        )
        for steps in (4, 16, 2 * experiment.steps):
            drift = maximum(norm(problem, state.u) for state in MIDPOINT.march(change, steps))
            effect = (abs(raised - error) + drift) / error
            if effect <= NEGLIGIBLE_QUADRATURE:
                break
        return effect


# Criteria for both propositions: the error has the right size, it is the error of u^h, and the influence of time steps,
# quadrature and solver is small. Every diagnostic must be positive, except u^h on Γ1, which is zero by construction.
# Two numbers of steps, two quadratures or two ways to compute a norm differ at least by rounding, so a time share of
# exactly 0 means that a solution was compared with itself.
def residual_shares(levels: pd.DataFrame) -> Array:
    """Return for each level the residual of the contact solver, divided by its tolerance, (levels,).

    Args:
        levels: one row for each level, with the columns "residual", "dim" and "dofs" of ``rates.csv``. The tolerance,
            ``multigrid.residual``, depends on the dimension and on the number of unknowns.
    """
    return (levels["residual"] / [*map(multigrid.residual, levels["dim"], levels["dofs"])]).to_numpy()


def size(levels: pd.DataFrame) -> float:
    """Return (‖u − u^h‖² + ‖Π^h u − u^h‖²)^{1/2} / ‖u − Π^h u‖ on the finest level, which should be about 1.

    The numbers are the error, the discrete error and the interpolation error, by the columns of ``levels``.
    """
    finest = levels.iloc[-1]
    return float(np.hypot(finest["error"], finest["discrete_error"]) / finest["interpolation_error"])


SMALL_SHARE = positive_at_most(0.02, "of the error")
SIZE_CHECK = consequence(
    "size",
    "size of the error: (‖u − u^h‖² + ‖Π^h u − u^h‖²)^{1/2} / ‖u − Π^h u‖",
    size,
    around(1, 0.1, "u − u^h and Π^h u − u^h are nearly orthogonal (Pythagoras)"),
)
EVIDENCE = (
    identity(
        "parallelogram",
        "parallelogram law of u − u^h and u − Π^h u",
        "parallelogram",
        positive_at_most(1e-3, "an identity, up to rounding and the quadrature of the factor of A"),
    ),
    accuracy("time-share", "time share: error in time / error", "time_share", SMALL_SHARE),
    accuracy(
        "residual",
        "residual of the contact solves / largest accepted residual",
        residual_shares,
        positive_at_most(
            1.0, f"{multigrid.DIRECT_RESIDUAL:g} for a factorisation, {multigrid.SHARE:g} h² for multigrid"
        ),
    ),
    accuracy("clamped", "u^h = 0 on Γ1", "clamped", at_most(1e-10, "rounding")),
    accuracy("quadrature", "change of the error under finer quadrature", "quadrature_change", SMALL_SHARE),
)

# Further criteria, which hold only with the regularity that Proposition 5.4 assumes.
ON_IRREGULAR = "; on irregular meshes the leading term replaces h"
"""Text that is added to the descriptions of orders.

On irregular meshes orders are orders in the leading term of the interpolation error, which replaces the mesh size h."""
SOLID_WINDOW = around(1, 0.1, ON_IRREGULAR.removeprefix("; "))
SOLIDS = (
    paper_claim(
        "order-finest",
        "order of the error, finest pair",
        over_refinements("error", 1),
        SOLID_WINDOW,
        levels=MIN_LEVELS,
    ),
    consequence(
        "interpolation-order-finest",
        "order of ‖u − Π^h u‖_V, finest pair",
        over_refinements("interpolation_error", 1),
        SOLID_WINDOW,
        levels=MIN_LEVELS,
    ),
)
"""Additional criteria in 3D: there are few levels, so the order on the two finest levels must be closer to 1."""
LEADING_ORDER = accuracy(
    "leading-order",
    "order in h of the leading term of ‖u − Π^h u‖_V, fitted, irregular meshes",
    fitted(LEADING, last=MIN_LEVELS + 1),
    around(1, 0.15, "least squares; on irregular meshes this term replaces h"),
    levels=MIN_LEVELS,
)
"""A criterion for irregular meshes: the leading term of the interpolation error must be of order h.

This is necessary, because the leading term replaces h on these meshes."""
DISCRETE_ORDER = "order of ‖Π^h u − u^h‖_V"
DISCRETE_ORDERS = (
    check_of_order(
        "discrete-order-superclose",
        f"{DISCRETE_ORDER}, superclose",
        "discrete_error",
        between(1.5, 2, 0.2, 0.2, "u^h is superclose to Π^h u on one-diagonal meshes"),
        last=MIN_LEVELS,
    ),
    check_of_order(
        "discrete-order-others",
        f"{DISCRETE_ORDER}, other families",
        "discrete_error",
        between(1, 2, 0.15, 0.2, "other meshes"),
        last=MIN_LEVELS,
    ),
)
"""The checks of the order of the discrete error on one-diagonal meshes and on all others.

On one-diagonal meshes neighbouring triangles form parallelograms, and Π^h u − u^h is superclose, of order 3/2 (because
of the traction boundary) to 2. On other meshes its order is at least the order of the error and at most 2."""
DISCRETE_SIZES = (
    consequence(
        "discrete-share",
        "‖Π^h u − u^h‖_V / ‖u − Π^h u‖_V",
        finest_quotient("discrete_error", "interpolation_error"),
        positive_at_most(0.6, "then, by Pythagoras, u^h and Π^h u have the same error up to 20 %"),
    ),
    accuracy(
        "discrete-time-share",
        "time share of ‖Π^h u − u^h‖_V: error in time / discrete error",
        "discrete_time_share",
        positive_at_most(0.3, "of the discrete error"),
    ),
)
NOT_AT_START = 0.99
"""The largest error counts as attained after t = 0 if the error at t = 0 is at most this fraction of it."""
EXPECTED_AT_START = Window(0.8, 1 + ROUNDING_ROOM)
"""Window of (error / interpolation error) at t = 0 for a correct solver.

By Pythagoras' theorem the lower end 0.8 leaves a discrete error ‖Π^h u_0 − u^h(0)‖ of 0.6 of the interpolation error.
"""
AT_START = (
    "‖u − Π^h u‖_V is largest near t = 0, where nothing is solved; the checks of ‖Π^h u − u^h‖_V test the solution"
)
AFTER_START = accuracy(
    "start-share",
    "error at t = 0 / largest error",
    quotients("initial_error", "error"),
    at_most(NOT_AT_START, "the largest error must occur after t = 0, where nothing is solved"),
)


def start_share(groups: Groups) -> Check:
    """Return the check that the largest error occurs after t = 0.

    At t = 0 the error is the interpolation error of u_0, so a maximum there does not test the solver. But if the
    interpolation error itself is nearly largest at t = 0 (``EXPECTED_AT_START``), the solver may be correct. Then the
    value is only reported.

    Args:
        groups: the rows of one case in ``rates.csv`` by mesh family, from coarse to fine.
    """
    rows = pd.concat(groups.values())
    at_start = rows[~(rows["initial_error"] <= NOT_AT_START * rows["error"])]
    shares = at_start["initial_error"] / at_start["interpolation_error"]
    if len(shares) and EXPECTED_AT_START.contains(*shares):
        return replace(AFTER_START, window=Window(), if_missed=AT_START)
    return AFTER_START


class FirstOrder(Rates):
    """Judges Proposition 5.4, the order 1 of ‖u − u^h‖_V, on exact solutions that satisfy its assumption (5.36)."""

    label = proposition = "Prop. 5.4"
    claim = "‖u − u^h‖_{L∞(0,T;V)} = O(h)"

    def checks_of(self, case: str, groups: Groups) -> Judged:
        expected = value_of_case(groups, "expected_order")
        in_h = in_leading_term(groups)
        (irregular, _) = split(groups, "irregular")
        by_level = around(expected, 0.15, f"every consecutive order{ON_IRREGULAR}")
        limit = around(expected, 0.1, f"extrapolated from the three finest levels{ON_IRREGULAR}")
        yield (
            paper_claim(
                "order",
                "order of the error, level by level",
                level_by_level("error"),
                by_level,
                levels=MIN_LEVELS,
                finest=True,
            ),
            in_h,
        )
        yield (
            paper_claim(
                "order-extrapolated",
                "order of the error, extrapolated",
                extrapolated("error"),
                limit,
                levels=MIN_LEVELS,
            ),
            in_h,
        )
        yield SIZE_CHECK, in_h
        for check, tables in zip(DISCRETE_ORDERS, split(groups, "superclose"), strict=True):
            if tables:
                yield check, tables
        for rule in (*DISCRETE_SIZES, start_share(groups), *EVIDENCE):
            yield rule, groups
        for criterion in SOLIDS if value_of_case(groups, "dim") == 3 else ():
            yield criterion, in_h
        if irregular:
            yield LEADING_ORDER, irregular


ROUGH_LEVELS = MIN_LEVELS + 1
"""Smallest number of levels that gives two observed orders over two refinements each."""
ERROR_LIMIT = at_most(0.1, "of the two finest errors, if s is the predicted order", low=-math.inf)
"""Window of the limit e∞ of the error for h → 0 in the fit e = e∞ + C h^s, relative to the two finest errors.

Over two refinements an order s − δ instead of s has the same effect as a limit e∞/e = (1 − 4^{−δ})/(1 − 4^{−s}). For s
= 1/4 this window corresponds to δ = 0.02. Observed orders are not more accurate than this, because the position of a
front within its cell differs from level to level.
"""


OVER_TWO_REFINEMENTS = "over two refinements (no rate is claimed)"


class Convergence(Rates):
    """Judges Proposition 5.3 on exact solutions that violate the regularity assumption (5.36) of Proposition 5.4.

    Proposition 5.3: ‖u − u^h‖_{L∞(0,T;V)} → 0 for every solution, without an assumption on its regularity.

    **The measurement** is the same as for Proposition 5.4 (``prop_5_4.measure``). The exact solutions violate the
    regularity assumption (5.36) of that proposition. They have singular corners or fronts, interfaces off the mesh, or
    loads that are hardly continuous in time.

    **The judgement.** The paper claims no order. Errors must fall from level to level, and in a fit e = e∞ + C h^s the
    limit e∞ must be small. The observed order is compared with the order that the regularity predicts. It is computed
    over two refinements, because the position of a resting front within its cell alternates between levels. On random
    meshes the limit e∞ varies from seed to seed by up to a quarter of its window, so it is not judged there. On meshes
    graded towards a corner the order must be 1.
    """

    label = proposition = "Prop. 5.3"
    claim = "‖u − u^h‖_{L∞(0,T;V)} → 0"

    def checks_of(self, case: str, groups: Groups) -> Judged:
        expected = value_of_case(groups, "expected_order")
        (uniform, graded) = split(groups, "uniform")
        falling = at_most(0.999, "on every level")
        ratio = "ratio of consecutive errors"
        yield paper_claim("falling", ratio, ratios("error"), falling, levels=ROUGH_LEVELS), groups
        by_chance, others = split(uniform, "random")
        steeper = f"s is {STEEPER:g} above the predicted order, the largest s that the check of the order allows"
        if others:
            yield _limit("limit", ERROR_LIMIT, expected), others
            yield replace(_limit("limit-steeper", Window(), expected + STEEPER), if_missed=steeper), others
        if by_chance:
            unjudged = _limit("limit-random", Window(), expected)
            yield replace(unjudged, if_missed="the limit varies with the seed"), by_chance
        order = consequence(
            "order",
            "observed order",
            over_refinements("error", 2),
            around(expected, STEEPER, OVER_TWO_REFINEMENTS),
            levels=ROUGH_LEVELS,
        )
        yield order, uniform
        if graded:
            of_graded = replace(order, key="order-graded", quantity="observed order on graded meshes")
            yield replace(of_graded, window=around(1.0, STEEPER, OVER_TWO_REFINEMENTS)), graded
        yield from ((criterion, groups) for criterion in (SIZE_CHECK, *EVIDENCE))


def _limit(key: str, window: Window, expected: float) -> Check:
    """Return the check of the limit e∞ of the error for h → 0, which must be small.

    The limit is computed from the last four levels with the predicted order s. These levels cannot determine both the
    limit and the order, so another check judges the order.
    """
    quantity = "limit e∞ of the error e for h → 0, from e = e∞ + C h^s"
    value = of_errors("error", lambda h, error: limit(h, error, expected))
    return paper_claim(key, quantity, value, window, levels=ROUGH_LEVELS)


PROVED_ORDER_TOLERANCE = 0.1
"""An observed order may be below the proved order by at most this number.

Observed orders approach the proved order from below.
"""


class SizeOfInterpolation(FromRates):
    """Judges (5.23): the interpolation error ‖u − Π^h u‖_V divided by its leading term for h → 0.

    The cases are those of Proposition 5.4. The leading term is computed from second derivatives of u, by code that
    shares nothing with the computation of the errors. Nothing is measured: the check uses the errors in ``rates.csv``,
    which ``Convergence`` and ``FirstOrder`` measure.
    """

    label = "(5.23)"
    claim = "‖v − Π^h v‖_V ≤ c h |v|_{H²}"
    proposition = "Prop. 5.4"
    checks = (
        consequence(
            "leading-term",
            "‖u − Π^h u‖_V / leading term",
            finest_quotient("interpolation_error", LEADING),
            around(1, 0.05, "on the finest level"),
        ),
    )


SEEN_ORDER = consequence(
    "order",
    "observed order on uniform meshes",
    over_refinements("error", 2),
    Window(),
    levels=MIN_LEVELS,
    if_missed="the paper claims an order only under (5.36)",
)


class RegularityNeeded(FromRates):
    """Compares observed orders of the error with proved orders, for solutions without the regularity (5.36).

    The paper claims no order for these solutions. But its proof of Proposition 5.4 gives an order for less regularity,
    the proved order (``manufactured.regularity``). There are two checks on uniform meshes:

    * whether the observed order is at least the proved order. If not, the verdict is *missed* and not *fails*, because
      observed orders approach the proved one from below;
    * whether the observed order is at least the proved order minus 0.1. If not, the check fails.
    """

    label = "(5.36)"
    claim = "does Prop. 5.4 need the regularity (5.36) that it assumes?"
    proposition = "Prop. 5.3"

    def checks_of(self, case: str, groups: Groups) -> Judged:
        proved = at_least(value_of_case(groups, "proved_order"), "the order that the proof gives")
        uniform, _ = split(groups, "uniform")
        reported = replace(SEEN_ORDER, window=proved)
        enough = at_least(proved.low - PROVED_ORDER_TOLERANCE, "the proved order, with room for coarse meshes")
        judged = replace(SEEN_ORDER, key="order-proved", window=enough, if_missed="")
        return [(check, uniform) for check in ((reported, judged) if uniform else (reported,))]


class InitialGap(Rates):
    """Measures and judges the errors ‖u − u^h‖_V for the cases with an initial gap.

    Beyond the paper: an initial gap g(s) ≥ 0 between the undeformed body and the foundation.

    **The claim.** In the paper the undeformed body touches the foundation: K = {v : v_ν ≤ 0 on Γ3}. Here K = {v : v_ν ≤
    g on Γ3} with a smooth g that does not depend on time. Problem 5.1 is solved in K^h = {v ∈ V^h : v_ν ≤ g at the
    vertices of Γ3}. The paper claims nothing about this problem. This study claims ‖u − u^h‖_{L∞(0,T;V)} = O(h) for
    solutions with the regularity (5.36), and convergence for others.

    **The reason.** Let d ∈ V be smooth with d_ν = g on Γ3. Then w = u − d satisfies w_ν ≤ 0 on Γ3, the condition of the
    paper, and w^h = u^h − Π^h d satisfies it at the vertices. The function w solves the variational inequality of u
    with an additional load, which belongs to −d. Moreover Π^h d − d = O(h) by (5.23). So the proof of Proposition 5.4
    holds for w. The window of the order was set before anything was measured.

    **The measurement** is the same as for Proposition 5.4 (``prop_5_4.measure``), on all cases with an initial gap and
    all mesh families that can mesh their bodies. The contact solver gets the values of g at the vertices.

    **The judgement** uses the criteria of Proposition 5.4 and (5.23) if the solution satisfies (5.36), otherwise the
    criteria of Proposition 5.3. If g is forgotten or has the wrong sign, the error does not fall with h
    (``study.controls``).
    """

    label = proposition = INITIAL_GAP
    claim = "‖u − u^h‖_{L∞(0,T;V)} = O(h) for K = {v : v_ν ≤ g on Γ3}; the paper has g = 0"
    initial_gap = True

    def checks_of(self, case: str, groups: Groups) -> Judged:
        smooth = value_of_case(groups, "expected_order") >= 1
        for statement in (FirstOrder(), SizeOfInterpolation()) if smooth else (Convergence(),):
            yield from statement.checks_of(case, groups)
