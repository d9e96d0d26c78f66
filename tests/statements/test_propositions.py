"""A verdict is two-sided and can come out otherwise."""

import numpy as np
import pandas as pd
import pytest

from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED, Verdict
from study.ledger.window import STEEPER
from study.run.provenance import Complete
from study.statements.from_rates import RegularityNeeded, SizeOfInterpolation, Turned
from study.statements.prop_5_3 import Convergence
from study.statements.prop_5_4 import FirstOrder
from study.statements.thm_4_2 import SameMesh


def table(order=1.0, levels=(8, 16, 32), claim="Prop. 5.4", case="a", family="criss-cross", **changes) -> pd.DataFrame:
    h = 1 / np.array(levels, dtype=float)
    rows = {"claim": claim, "case": case, "family": family, "dim": 2, "level": levels, "h": h, "dofs": 2 / h**2}
    rows |= {"error": 0.97 * h**order, "interpolation_error": h**order, "predicted_interpolation": h**order}
    rows |= {"discrete_error": 0.24 * h**order, "initial_error": 0.0, "time_share": 0.01, "discrete_time_share": 0.1}
    rows |= {"residual": 1e-14, "clamped": 0.0, "parallelogram": 1e-12, "quadrature_change": 0.001}
    return pd.DataFrame(rows).assign(**changes)


def rough(order: float = 0.5, **changes) -> pd.DataFrame:
    return table(order, (8, 16, 32, 64), "Prop. 5.3", **changes)


def prop_5_4(rows: pd.DataFrame, order: float = 1.0) -> list[Verdict]:
    """The verdicts on a case, with the size of its interpolation error."""
    return [*FirstOrder().judge(rows.assign(expected_order=order)), *SizeOfInterpolation().judge(rows)]


def prop_5_3(rows: pd.DataFrame, order: float = 0.5) -> list[Verdict]:
    return Convergence().judge(rows.assign(expected_order=order))


def verdicts(found) -> dict[str, str]:
    return {verdict.key: verdict.verdict for verdict in found}


def claimed(found) -> set[str]:
    """All verdicts except on the limit for another order than the predicted one, about which nothing is claimed."""
    return {verdict.verdict for verdict in found if verdict.key != "limit-steeper"}


def test_the_predicted_behaviour_holds_in_every_row() -> None:
    assert set(verdicts(prop_5_4(table())).values()) == {HOLDS}


@pytest.mark.parametrize("order", [0.0, 0.5, 0.8, 1.2, 1.5, 2.0])
def test_an_order_too_low_or_too_good_fails(order: float) -> None:
    assert verdicts(prop_5_4(table(order)))["order"] == FAILS


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"time_share": 0.021}, "time-share"),
        ({"time_share": [0.5, 0.01, 0.01]}, "time-share"),
        ({"discrete_time_share": 0.31}, "discrete-time-share"),
        ({"residual": 1e-9}, "residual"),
        ({"clamped": 1e-3}, "clamped"),
        ({"parallelogram": 0.01}, "parallelogram"),
        ({"quadrature_change": 0.04}, "quadrature"),
        ({"predicted_interpolation": 1.0}, "leading-term"),
        ({"discrete_error": 1.0}, "discrete-share"),
        ({"error": 0.8 * table()["error"]}, "size"),
        ({"error": 1.2 * table()["error"]}, "size"),
        ({"family": "one-diagonal"}, "discrete-order-superclose"),
        *(
            ({column: np.where(np.arange(3) == level, np.nan, table()[column])}, key)
            for column, key in {
                **{"time_share": "time-share", "residual": "residual", "clamped": "clamped"},
                **{"parallelogram": "parallelogram", "quadrature_change": "quadrature", "initial_error": "start-share"},
            }.items()
            for level in range(3)
        ),
    ],
)
def test_each_piece_of_evidence_fails_alone_if_it_is_wrong_or_missing_on_one_level(changes, key: str) -> None:
    assert verdicts(prop_5_4(table(**changes)))[key] == FAILS


@pytest.mark.parametrize(
    ("start", "interpolation", "verdict"),
    [(0.5, 1.03, HOLDS), (1.0, 1.03, REPORTED), (1.0, 1.24, REPORTED), (1.0, 1.27, FAILS), (1.0, 0.999, FAILS)],
)
def test_an_error_that_is_largest_at_the_start_must_be_the_predicted_interpolation_error(
    start: float, interpolation: float, verdict: str
) -> None:
    """Start and interpolation error are multiples of the largest error."""
    error = table()["error"]
    rows = table(initial_error=start * error, interpolation_error=interpolation * error)
    assert verdicts(prop_5_4(rows))["start-share"] == verdict


def test_missing_rows_leave_the_data_undecided() -> None:
    planned = {("a", "criss-cross", "midpoint", "8"), ("a", "criss-cross", "midpoint", "16")}
    assert [Complete().judge(planned, found).verdict for found in (planned, set())] == [HOLDS, UNDECIDED]


def test_two_levels_leave_the_order_undecided_and_one_bad_family_is_enough_to_fail() -> None:
    found = verdicts(prop_5_4(table(levels=(8, 16))))
    assert found["order"] == found["order-extrapolated"] == UNDECIDED
    assert verdicts(prop_5_4(pd.concat([table(), table(0.7, family="one-diagonal")])))["order-extrapolated"] == FAILS


def test_in_3d_the_finest_pair_must_be_within_a_tenth_of_one() -> None:
    found = [verdicts(prop_5_4(table(order, dim=3)))["order-finest"] for order in (0.97, 0.88)]
    assert found == [HOLDS, FAILS]


def test_prop_5_3_accepts_any_rate_it_predicts_but_no_positive_limit_and_no_rising_error() -> None:
    rows = rough()
    assert claimed(prop_5_3(rows)) == {HOLDS}
    (steeper,) = [verdict for verdict in prop_5_3(rows) if verdict.key == "limit-steeper"]
    assert steeper.observed == pytest.approx((1 - 4**-STEEPER) / (1 - 4 ** -(0.5 + STEEPER)))
    assert verdicts(prop_5_3(rows.assign(error=rows["error"] + 0.5)))["limit"] == FAILS
    assert verdicts(prop_5_3(rows.assign(error=rows["error"].to_numpy()[::-1])))["falling"] == FAILS


def test_on_random_meshes_a_limit_is_reported_only_and_other_meshes_still_decide() -> None:
    random, plain = rough(family="shaken-7"), rough()
    alone = verdicts(prop_5_3(random))
    assert "limit" not in alone
    assert (alone["limit-random"], alone["falling"], alone["order"]) == (REPORTED, HOLDS, HOLDS)
    assert verdicts(prop_5_3(pd.concat([random, plain.assign(error=plain["error"] + 0.5)])))["limit"] == FAILS


def test_graded_meshes_must_regain_the_order_that_uniform_ones_lose() -> None:
    regained, lost = (prop_5_3(pd.concat([rough(), rough(order, family="graded")])) for order in (1.0, 0.5))
    assert claimed(regained) == {HOLDS}
    assert verdicts(lost)["order-graded"] == FAILS


def test_the_order_without_5_36_is_reported_with_the_order_of_the_proof() -> None:
    (row,) = RegularityNeeded().judge(rough(1.0, proved_order=0.75))
    assert (row.verdict, row.window_low) == (REPORTED, 0.75)
    assert row.observed == pytest.approx(1.0)


def test_a_turned_body_must_have_the_errors_of_its_twin_on_equal_meshes() -> None:
    twin = table(scheme="midpoint", twin="")

    def turned(change: float = 0.0, **changes) -> list[str]:
        """Errors differ by ``change``, discrete errors by 10³ times as much."""
        errors = {"error": twin["error"] * (1 + change), "discrete_error": twin["discrete_error"] * (1 + 1e3 * change)}
        rows = twin.assign(case="b", twin="a").assign(**errors, **changes)
        return [verdict.verdict for verdict in Turned().judge(pd.concat([twin, rows]))]

    assert turned(1e-12) == [HOLDS, HOLDS]
    assert turned(1e-9) == [FAILS, FAILS]
    assert turned(family="unstructured") == [UNDECIDED, UNDECIDED]
    assert turned(twin="b") == [], "a case compared with itself has no row"


def test_theorem_4_2_fails_above_the_bound_by_the_duality_gap_and_where_the_bound_is_vacuous() -> None:
    defects = dict.fromkeys(["admissibility", "energy_gap", "membership"], 1e-9)
    gaps = dict.fromkeys(["displacement_gap", "stress_gap"], 1e-8)
    bounds = dict.fromkeys(["displacement_bound", "stress_bound"], 1e-7)
    good = pd.DataFrame([{"case": "a", "family": "shaken", "h": 0.25, **defects, **gaps, **bounds}])
    assert set(verdicts(SameMesh().judge(good)).values()) == {HOLDS}
    for column in [*defects, *gaps, *bounds]:
        for value in (1e-4 if column in bounds else 1e-6, np.nan):
            fails = [verdict.verdict for verdict in SameMesh().judge(good.assign(**{column: value}))].count(FAILS)
            assert fails >= 1 if column in bounds else fails == 1
