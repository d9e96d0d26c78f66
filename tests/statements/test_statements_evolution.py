"""The statements about the evolution hold as measured, and each verdict can come out otherwise."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pandas as pd
import pytest

from manufactured import catalogue
from study.fem.mesh import Shaken, Unstructured
from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED
from study.solve.signorini import Signorini
from study.solve.tableau import BACKWARD_EULER, MIDPOINT, SCHEMES
from study.statements.admissibility import Admissibility, largest_violations
from study.statements.boundary import NaturalConditions, tractions
from study.statements.error_bounds import BOUNDS, RATE, TRACE, ErrorBounds, constant, predicted, sides
from study.statements.fully_discrete import COUNTS, FullyDiscrete, columns
from study.statements.shared.base import ListedNumbers, Setting, grid
from study.statements.shared.experiment import Experiment
from study.statements.uniqueness import OneTrajectory, apart, rivals
from study.statements.wellposed import BoundedVelocity, Dependence, fastest, perturbations, quotients

CASES = {case.name: case for case in catalogue()}
JUDGED = [Admissibility(), OneTrajectory(), BoundedVelocity(), Dependence(), NaturalConditions(), ErrorBounds()]
EVERY = [*JUDGED, FullyDiscrete()]
SEVERAL_LEVELS = {
    NaturalConditions: ("loaded", "contact", "tangential", "loaded-weakly", "tangential-weakly"),
    ErrorBounds: ("steady-5.21", "steady-5.42"),
}
"""Rows that one level cannot decide: orders, and changes under refinement."""
EULER, SHAKEN = BACKWARD_EULER, Shaken()


def named(statement: ListedNumbers) -> str:
    return type(statement).__name__


def setup(name: str, n: int, steps: int, scheme=EULER, family=SHAKEN) -> Experiment:
    return Experiment.of(CASES[name].solution, family, n, scheme, steps)


def table(found: list[tuple[int, dict[str, float]]]) -> pd.DataFrame:
    """The rows of one case on one family."""
    return pd.DataFrame(
        [
            {"case": "a", "family": "shaken", "level": level, "h": values["h"], "quantity": name, "value": value}
            for level, values in found
            for name, value in values.items()
            if name != "h"
        ]
    )


@cache
def measured(statement: ListedNumbers) -> pd.DataFrame:
    """The rows of the quick settings."""
    return measured_at(statement, statement.places(full=False))


def measured_at(statement: ListedNumbers, settings: Sequence[Setting]) -> pd.DataFrame:
    rows = [table([(s.level, statement.measure(s))]).assign(case=s.case, family=s.family) for s in settings]
    return pd.concat(rows)


def verdicts(statement: ListedNumbers, rows: pd.DataFrame) -> dict[str, str]:
    return {verdict.key: verdict.verdict for verdict in statement.judge(rows)}


class Free(Signorini):
    """Contact dropped."""

    def __call__(self, b):
        return self.factor(b), np.zeros(self.N.shape[0])


class TwoSided(Signorini):
    """A foundation that holds the body."""

    def complementarity(self, gap):
        return self.multipliers_on(np.ones_like(self.active), gap)


def defective(found: Experiment, solver) -> Experiment:
    return replace(found, problem=replace(found.problem, solver=solver))


@pytest.mark.parametrize("statement", JUDGED, ids=named)
def test_every_statement_holds_on_the_quick_settings(statement: ListedNumbers) -> None:
    found = statement.judge(measured(statement))
    assert {verdict.verdict for verdict in found} - {REPORTED} == {HOLDS}
    assert {verdict.case for verdict in found} == {setting.case for setting in statement.places(full=False)}


@pytest.mark.parametrize("statement", EVERY, ids=named)
def test_quick_settings_name_cases_and_families_and_differ(statement: ListedNumbers) -> None:
    for full in (False, True):
        settings = statement.places(full)
        assert len(set(settings)) == len(settings)
        assert {setting.case for setting in settings} <= set(CASES)


@pytest.mark.parametrize("statement", JUDGED, ids=named)
def test_every_judged_line_can_fail(statement: ListedNumbers) -> None:
    """Numbers that are large and grow under refinement satisfy no window."""
    rows = measured(statement)
    found = verdicts(statement, rows.assign(value=5.0 * rows["level"] ** 3))
    assert set(found.values()) - {REPORTED} == {FAILS}


@pytest.mark.parametrize("statement", JUDGED, ids=named)
def test_no_judged_line_accepts_what_is_not_a_number(statement: ListedNumbers) -> None:
    found = verdicts(statement, measured(statement).assign(value=math.nan))
    assert set(found.values()) - {REPORTED} == {FAILS}


@pytest.mark.parametrize("statement", JUDGED, ids=named)
def test_any_part_of_the_data_can_be_judged(statement: ListedNumbers) -> None:
    rows = measured(statement)
    coarsest = verdicts(statement, rows[rows["level"] == rows["level"].min()])
    assert set(coarsest.values()) <= {HOLDS, UNDECIDED, REPORTED}
    assert all(coarsest[key] in (UNDECIDED, REPORTED) for key in SEVERAL_LEVELS.get(type(statement), ()))
    one = rows[rows["quantity"] == rows["quantity"].iloc[0]]
    assert UNDECIDED in verdicts(statement, one).values()
    assert statement.judge(rows.iloc[:0]) == []


# (3.9)–(3.11), (4.14), (4.15).


@pytest.mark.parametrize("name", ["corner", "heterogeneous", "yield-on-a-part"])
def test_admissible_on_several_faces_and_for_other_laws(name: str) -> None:
    assert max(largest_violations(setup(name, 6, 6, family=Unstructured())).values()) <= 1e-10


def test_without_contact_the_displacement_leaves_K() -> None:
    found = largest_violations(defective(setup("advance-recede", 6, 6), Free))
    assert found["membership"] > 1e-3
    assert found["stresses"] > 1e-3


def test_a_foundation_that_holds_makes_stresses_inadmissible() -> None:
    found = largest_violations(defective(setup("advance-recede", 6, 6), TwoSided))
    assert found["distance"] > 1e-3
    assert found["displacements"] > 1e-4


# Theorems 2.2, 4.1, 5.2.


def test_rivals_are_different_ways_and_see_another_solution() -> None:
    found = setup("travelling-patch", 6, 6)
    assert set(rivals(found.problem)) == {"random starts", "least squares", "fixed point", "interior point"}
    assert apart(found, defective(found, Free).problem) > 1e-3


def test_a_start_outside_K_has_no_bounded_velocity() -> None:
    problem = setup("full-contact", 6, 1).problem
    outside = replace(problem, u0=problem.u0 + problem.N.T @ np.full(problem.N.shape[0], 1.0))
    assert fastest(problem, 96) < 1.2 * fastest(problem, 24)
    assert fastest(outside, 96) > 3 * fastest(outside, 24)


def test_growth_beyond_omega_exceeds_the_bound() -> None:
    found = setup("advance-recede", 6, 12)
    omega = found.solution.law.kappa
    problem = replace(found.problem, reference=-4 * omega * found.problem.M)
    trajectory = list(BACKWARD_EULER.march(problem, 12))
    damping = np.exp(-omega * np.array([state.time for state in trajectory[1:]]))
    quotient = [quotients(problem, trajectory, other) * damping for other in perturbations(problem, found.space)]
    assert np.max(quotient) > 1.1


def test_perturbed_starts_lie_in_K() -> None:
    found = setup("corner", 6, 1, family=Unstructured())
    for other in perturbations(found.problem, found.space):
        assert (found.problem.N @ other.start).max() <= 1e-12


# (4.13).


def test_a_wrong_load_is_not_the_weak_natural_condition() -> None:
    rows = []
    for n in (6, 12, 24):
        found = setup("full-contact", n, 24, MIDPOINT)
        load = found.problem.load
        wrong = replace(found, problem=replace(found.problem, load=lambda t, load=load: 1.05 * load(t)))
        rows.append((n, {"h": found.space.h, **tractions(wrong)}))
    found = verdicts(NaturalConditions(), table(rows))
    assert found["loaded-weakly"] == FAILS
    assert found["tangential-weakly"] == FAILS


# (5.20)–(5.21), (5.42).


def test_an_error_that_does_not_fall_leaves_its_bounds() -> None:
    rows = []
    for n in (6, 12, 24):
        found = defective(setup("full-contact", n, 24, MIDPOINT), Free)
        rows.append((n, {"h": found.space.h, **sides(found), **predicted(CASES["full-contact"])}))
    found = verdicts(ErrorBounds(), table(rows))
    for number in ("5.21", "5.42"):
        assert found[f"steady-{number}"] == FAILS
        assert found[f"constant-{number}"] == FAILS


@pytest.mark.parametrize(("case", "term"), [("rough-trace", TRACE), ("moving-rough", RATE)])
def test_a_bound_of_lower_order_must_be_lower_by_what_is_predicted(case: str, term: str) -> None:
    gamma = predicted(CASES[case])["γ of (5.42)"]
    assert gamma == {"rough-trace": 1 / 8, "moving-rough": 1 / 4}[case]
    for p, verdict in ((0.0, FAILS), (gamma, HOLDS), (2 * gamma, FAILS)):
        rows = [
            (n, {"h": 1 / n, term: n**p, **dict.fromkeys([*BOUNDS, *(f"{b}, c" for b in BOUNDS)], 0.5)})
            for n in (8, 16, 32)
        ]
        found = verdicts(ErrorBounds(), table([(n, {**values, **predicted(CASES[case])}) for n, values in rows]))
        assert found["growth-5.42"] == verdict
        assert "steady-5.42" not in found


def test_no_bound_is_claimed_where_the_ratio_carries_a_logarithm() -> None:
    rows = [(n, {"h": 1 / n, **dict.fromkeys([*BOUNDS, *(f"{b}, c" for b in BOUNDS)], 0.5)}) for n in (8, 16, 32)]
    found = ErrorBounds().judge(table([(n, {**v, **predicted(CASES["natural-front"])}) for n, v in rows]))
    assert [(v.key, v.verdict) for v in found if "log h" in v.quantity] == [("steady-5.42", REPORTED)]


def test_the_constant_of_the_proof() -> None:
    law = CASES["advance-recede"].solution.law  # L_G = 4, m_A = 2, monotone
    assert constant(law, 1.0) == pytest.approx(4.0)
    assert constant(law, 4.0) == pytest.approx(math.sqrt(16 + 64 + 4 * 64 / 3))


# Beyond the source.


def synthetic(p: float, orders: dict[str, float], power: float = 2.0) -> pd.DataFrame:
    """Tables of e = ((h^p)^r + (3 k^q)^r)^{1/r} and d = 3 k^q."""
    rows = []
    for n in (8, 16, 32):
        values = {"h": 1 / n}
        for scheme in SCHEMES:
            d = 3 * (1 / np.array(COUNTS)) ** orders[scheme.name]
            e = ((1 / n) ** (p * power) + d**power) ** (1 / power)
            values |= dict(zip(columns(scheme, "d", COUNTS), d, strict=True))
            values |= dict(zip(columns(scheme, "e", COUNTS), e, strict=True))
        rows.append((n, values))
    return table(rows)


def test_fits_recover_the_orders_and_compare_them_with_the_prediction() -> None:
    rows = synthetic(1.0, {"backward-euler": 1.0, "bdf2": 2.0, "midpoint": 1.0})
    found = {verdict.key: verdict for verdict in FullyDiscrete().judge(rows)}
    assert {verdict.verdict for verdict in found.values()} == {REPORTED}
    for name, q in {"backward-euler": 1, "bdf2": 2, "midpoint": 1}.items():
        assert found[f"{name}-error-in-h"].observed == pytest.approx(1, abs=1e-4)
        assert found[f"{name}-time-in-k"].observed == pytest.approx(q, abs=1e-6)
        seen = found[f"{name}-error-in-k"]
        assert seen.observed == pytest.approx(q, abs=1e-4)
        assert seen.expected.endswith("differs" if name == "midpoint" else "agrees")


def test_errors_in_time_that_cannot_be_seen_give_no_order() -> None:
    rows = synthetic(0.0, dict.fromkeys(("backward-euler", "bdf2", "midpoint"), 3.0))
    found = {verdict.key: verdict for verdict in FullyDiscrete().judge(rows)}
    assert found["bdf2-error-in-k"].expected.endswith("undecided")
    assert math.isnan(found["bdf2-error-in-k"].observed)


@pytest.mark.slow
def test_tables_on_coarse_meshes_agree_with_the_predictions_for_the_error_in_time() -> None:
    settings = grid(("advance-recede",), ("shaken",), (4, 8, 12))
    for verdict in FullyDiscrete().judge(measured_at(FullyDiscrete(), settings)):
        if verdict.key.endswith("time-in-k"):
            assert verdict.expected.endswith("agrees")
            assert verdict.low <= verdict.observed <= verdict.high
