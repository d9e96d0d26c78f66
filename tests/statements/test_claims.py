"""A verdict is two-sided and can come out otherwise."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED, Window
from study.statements.prop_5_4.claims import beyond_5_36, complete, judge, prop_5_3, prop_5_4, theorem_4_2, turned


def table(order=1.0, levels=(8, 16, 32), claim="Prop. 5.4", case="a", family="shaken", **changes) -> pd.DataFrame:
    h = 1 / np.array(levels, dtype=float)
    rows = pd.DataFrame(
        {
            "claim": claim,
            "case": case,
            "family": family,
            "dim": 2,
            "level": levels,
            "h": h,
            "dofs": 2 * np.array(levels) ** 2,
            "error": 0.97 * h**order,
            "interpolation_error": h**order,
            "predicted_interpolation": h**order,
            "discrete_error": 0.24 * h**order,
            "initial_error": 0.0,
            "time_share": 0.01,
            "discrete_time_share": 0.1,
            "residual": 1e-14,
            "clamped": 0.0,
            "parallelogram": 1e-12,
            "quadrature_change": 0.001,
        }
    )
    return rows.assign(**changes)


def verdicts(found) -> dict[str, str]:
    return {verdict.quantity: verdict.verdict for verdict in found}


def test_the_predicted_behaviour_holds_in_every_row() -> None:
    assert set(verdicts(prop_5_4("a", table(), 1.0)).values()) == {HOLDS}


@pytest.mark.parametrize("order", [0.0, 0.5, 0.8, 1.2, 1.5, 2.0])
def test_an_order_too_low_or_too_good_fails(order: float) -> None:
    assert verdicts(prop_5_4("a", table(order), 1.0))["order of the error, level by level"] == FAILS


@pytest.mark.parametrize(
    ("column", "value", "quantity"),
    [
        ("time_share", 0.021, "time share"),
        ("discrete_time_share", 0.31, "time share of ‖Π^h u − u^h‖_V"),
        ("residual", 1e-9, "residual of the contact solves / allowed"),
        ("clamped", 1e-3, "u^h = 0 on Γ1"),
        ("parallelogram", 0.01, "parallelogram law of u − u^h and u − Π^h u"),
        ("parallelogram", np.nan, "parallelogram law of u − u^h and u − Π^h u"),
        ("quadrature_change", 0.04, "change under finer quadrature"),
        ("predicted_interpolation", 1.0, "‖u − Π^h u‖_V / leading term"),
        ("discrete_error", 1.0, "‖Π^h u − u^h‖_V / ‖u − Π^h u‖_V"),
        ("time_share", np.nan, "time share"),
    ],
)
def test_each_piece_of_evidence_can_fail_alone(column: str, value: float, quantity: str) -> None:
    assert verdicts(prop_5_4("a", table(**{column: value}), 1.0))[quantity] == FAILS


@pytest.mark.parametrize(
    ("column", "quantity"),
    [
        ("time_share", "time share"),
        ("residual", "residual of the contact solves / allowed"),
        ("clamped", "u^h = 0 on Γ1"),
        ("parallelogram", "parallelogram law of u − u^h and u − Π^h u"),
        ("quadrature_change", "change under finer quadrature"),
        ("initial_error", "error at t = 0 / largest error"),
    ],
)
@pytest.mark.parametrize("level", [0, 1, 2])
def test_a_number_that_is_missing_on_one_level_fails(column: str, quantity: str, level: int) -> None:
    rows = table()
    rows.loc[rows.index[level], column] = np.nan
    assert verdicts(prop_5_4("a", rows, 1.0))[quantity] == FAILS


@pytest.mark.parametrize("factor", [0.8, 1.2])
def test_errors_of_the_right_order_but_the_wrong_size_fail(factor: float) -> None:
    rows = table()
    assert verdicts(prop_5_4("a", rows.assign(error=factor * rows["error"]), 1.0))["size of the error"] == FAILS


def test_a_poor_coarse_level_counts_in_the_evidence() -> None:
    rows = table(levels=(8, 16, 32, 64), time_share=[0.5, 0.01, 0.01, 0.01])
    assert verdicts(prop_5_4("a", rows, 1.0))["time share"] == FAILS


def test_an_error_that_is_largest_at_the_start_must_be_carried_by_the_discrete_error() -> None:
    rows = table()
    vacuous = rows.assign(initial_error=rows["error"])
    assert verdicts(prop_5_4("a", vacuous, 1.0))["error at t = 0 / largest error"] == HOLDS
    broken = vacuous.assign(discrete_error=0.2)
    assert verdicts(prop_5_4("a", broken, 1.0))["error at t = 0 / largest error"] == FAILS


def test_missing_rows_leave_the_data_undecided() -> None:
    planned = {("a", "shaken", "midpoint", "8"), ("a", "shaken", "midpoint", "16")}
    assert complete(planned, planned).verdict == HOLDS
    assert complete(planned, set()).verdict == UNDECIDED


def test_two_levels_leave_the_order_undecided() -> None:
    found = verdicts(prop_5_4("a", table(levels=(8, 16)), 1.0))
    assert found["order of the error, level by level"] == UNDECIDED
    assert found["order of the error, fitted"] == UNDECIDED


def test_one_bad_family_is_enough_to_fail() -> None:
    rows = pd.concat([table(), table(0.7, family="criss-cross")])
    assert verdicts(prop_5_4("a", rows, 1.0))["order of the error, fitted"] == FAILS


def test_a_superclose_family_must_be_superclose() -> None:
    found = verdicts(prop_5_4("a", table(family="one-diagonal"), 1.0))
    assert found["order of ‖Π^h u − u^h‖_V, superclose"] == FAILS


def test_prop_5_3_accepts_any_rate_it_predicts_but_no_positive_limit() -> None:
    rows = table(0.5, levels=(8, 16, 32, 64), claim="Prop. 5.3")
    assert set(verdicts(prop_5_3("a", rows, 0.5)).values()) == {HOLDS}
    stuck = rows.assign(error=rows["error"] + 0.5)
    found = verdicts(prop_5_3("a", stuck, 0.5))
    assert found["limit e∞ of e = e∞ + C h^s"] == FAILS
    rising = rows.assign(error=rows["error"].to_numpy()[::-1])
    assert verdicts(prop_5_3("a", rising, 0.5))["ratio of consecutive errors"] == FAILS


def test_in_3d_the_finest_pair_must_be_within_a_tenth_of_one() -> None:
    rows = table(0.97).assign(dim=3)
    assert verdicts(prop_5_4("a", rows, 1.0))["order of the error, finest pair"] == HOLDS
    assert verdicts(prop_5_4("a", table(0.88).assign(dim=3), 1.0))["order of the error, finest pair"] == FAILS


def test_graded_meshes_must_regain_the_order_that_uniform_ones_lose() -> None:
    levels = (8, 16, 32, 64)
    uniform = table(0.5, levels=levels, claim="Prop. 5.3")
    both = pd.concat([uniform, table(1.0, levels=levels, claim="Prop. 5.3", family="graded")])
    assert set(verdicts(prop_5_3("a", both, 0.5)).values()) == {HOLDS}
    lost = pd.concat([uniform, table(0.5, levels=levels, claim="Prop. 5.3", family="graded")])
    assert verdicts(prop_5_3("a", lost, 0.5))["order seen on graded meshes"] == FAILS


def test_the_order_beyond_5_36_is_reported_beside_that_of_the_proof() -> None:
    row = beyond_5_36("a", table(1.0, levels=(8, 16, 32, 64), claim="Prop. 5.3"), 0.75)
    assert (row.verdict, row.expected) == (REPORTED, "the proof gives 0.75")
    assert row.observed == pytest.approx(1.0)


def test_a_turned_body_must_have_the_errors_of_its_twin_on_equal_meshes() -> None:
    rows = table().assign(scheme="midpoint")
    assert [v.verdict for v in turned("a", rows, rows.assign(case="b"))] == [HOLDS, HOLDS]
    other = rows.assign(error=rows["error"] * (1 + 1e-9), discrete_error=rows["discrete_error"] * (1 + 1e-6))
    assert [v.verdict for v in turned("a", other, rows)] == [FAILS, FAILS]
    assert {v.verdict for v in turned("a", rows.assign(family="unstructured"), rows)} == {UNDECIDED}


def test_theorem_4_2_fails_above_what_the_duality_gap_allows_and_where_that_says_nothing() -> None:
    defects = dict.fromkeys(["admissibility", "energy_gap", "membership"], 1e-9)
    gaps = dict.fromkeys(["displacement_gap", "stress_gap"], 1e-8)
    bounds = dict.fromkeys(["displacement_bound", "stress_bound"], 1e-7)
    good = pd.DataFrame([{"case": "a", **defects, **gaps, **bounds}])
    assert set(verdicts(theorem_4_2("a", good)).values()) == {HOLDS}
    for column in [*defects, *gaps]:
        for value in (1e-6, np.nan):
            found = theorem_4_2("a", good.assign(**{column: value}))
            assert sum(verdict.verdict == FAILS for verdict in found) == 1
    for column in bounds:
        assert FAILS in verdicts(theorem_4_2("a", good.assign(**{column: 1e-4}))).values()
        assert FAILS in verdicts(theorem_4_2("a", good.assign(**{column: np.nan}))).values()


def test_four_cases_must_have_their_supremum_after_the_start() -> None:
    rows = pd.concat([table(case=name) for name in "abcd"])
    cases = pd.DataFrame({"case": list("abcd"), "expected_order": 1.0, "proved_order": 1.0, "twin": ""})
    last = [v for v in judge(rows, pd.DataFrame({"case": []}), cases) if v.case == "all cases"]
    assert [verdict.verdict for verdict in last] == [HOLDS]
    vacuous = rows.assign(initial_error=rows["error"])
    last = [v for v in judge(vacuous, pd.DataFrame({"case": []}), cases) if v.case == "all cases"]
    assert [verdict.verdict for verdict in last] != [HOLDS]


def test_a_window_distinguishes_wrong_from_unclear() -> None:
    window = Window(0.9, 1.1, "")
    assert window.judge([1.0], [(0.95, 1.05)])[3] == HOLDS
    assert window.judge([1.0], [(0.5, 1.5)])[3] == UNDECIDED
    assert window.judge([1.2], [(1.15, 1.25)])[3] == FAILS
    assert window.judge([float("nan")], [(1.0, 1.0)])[3] == FAILS
