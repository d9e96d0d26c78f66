"""A user's own case that is a poor test is undecided, with what to do; it fails where the data contradict."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from test_propositions import prop_5_3, prop_5_4, table

from study.ledger.verdict import BECAUSE, FAILS, HOLDS, REPORTED, UNDECIDED, Verdict
from study.run.judgement import with_reasons
from study.statements.own_cases import enough, finer, judge_own, least_levels


def following(orders: list[float], first: int = 8, **changes: object) -> pd.DataFrame:
    """Rows whose errors have these orders from level to level."""
    levels = tuple(first * 2**i for i in range(len(orders) + 1))
    error = 0.1 * 0.5 ** np.cumsum([0.0, *orders])
    sizes = {"error": error, "interpolation_error": error / 0.97, "predicted_interpolation": error / 0.97}
    return table(levels=levels, **(sizes | {"discrete_error": 0.24 * error} | changes)).assign(expected_order=1.0)


GOOD = following([1.0, 1.0])


def own(rows: pd.DataFrame) -> dict[str, Verdict]:
    return {verdict.key: verdict for verdict in judge_own(prop_5_4(rows), rows)}


def reason(verdict: Verdict) -> str:
    assert verdict.verdict == UNDECIDED
    return verdict.expected.partition(BECAUSE)[2]


@pytest.mark.parametrize("orders", [[0.6, 0.8], [0.3, 0.6, 0.79], [1.5, 1.3], [0.7, 0.99]])
def test_orders_that_approach_the_predicted_one_are_not_asymptotic_yet(orders: list[float]) -> None:
    levels = " ".join(str(16 * 2**i) for i in range(len(orders) + 1))
    assert reason(own(following(orders))["order"]) == f"not asymptotic yet: try --levels {levels}"


@pytest.mark.parametrize(
    "orders", [[0.5, 0.5], [0.5, 0.55], [0.8, 0.7], [1.5, 1.5], [0.4, 0.6, 0.62], [0.99, 0.7, 0.6]]
)
def test_orders_that_stay_away_contradict_the_statement_also_on_one_family_alone(orders: list[float]) -> None:
    rows = following(orders)
    assert own(rows)["order"].verdict == FAILS
    assert own(pd.concat([following([0.6, 0.8]), rows.assign(family="one-diagonal")]))["order"].verdict == FAILS


def test_a_single_order_that_is_out_of_line_decides_nothing() -> None:
    for orders in ([1.02, 0.82], [0.7, 1.3]):
        assert reason(own(following(orders))["order"]) == "values scatter: try --levels 16 32 64"
    one = table(levels=(8,), predicted_interpolation=0.2).assign(expected_order=1.0)
    assert reason(own(one)["leading-term"]) == "not asymptotic yet: try --levels 8 16 32"


@pytest.mark.parametrize(
    ("changes", "key", "told"),
    [
        ({"time_share": 0.03}, "time-share", "raise `pace`"),
        ({"discrete_time_share": 0.31}, "discrete-time-share", "raise `pace`"),
        ({"quadrature_change": 0.04}, "quadrature", "flatten them, or try --levels 16 32 64"),
        ({"discrete_error": 1.0}, "discrete-share", "more than a good test allows"),
        ({"discrete_error": 0.24 / 8}, "discrete-order-others", "not asymptotic"),
        ({"discrete_error": 0.24 / 8, "family": "one-diagonal"}, "discrete-order-superclose", "wrong by a little"),
    ],
)
def test_evidence_that_is_missing_is_named_with_what_to_do(changes: dict[str, object], key: str, told: str) -> None:
    assert told in reason(own(following([1.0, 1.0], **changes))[key])


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        *(({column: 0.5}, column) for column in ("residual", "clamped", "parallelogram")),
        ({"initial_error": GOOD["error"], "interpolation_error": 0.99 * GOOD["error"]}, "start-share"),
        ({"error": np.nan}, "order"),
    ],
)
def test_violated_identities_a_wrong_start_and_errors_that_are_no_numbers_fail_for_everybody(changes, key) -> None:
    assert own(GOOD.assign(**changes))[key].verdict == FAILS


@pytest.mark.parametrize(
    ("disturbed", "told"),
    [
        ({"time_share": 0.1}, "time steps disturb"),
        ({"quadrature_change": 0.1}, "quadrature disturbs the errors: mend that first"),
        ({"quadrature_change": 0.1, "time_share": 0.1}, "time steps and quadrature disturb the errors"),
    ],
)
def test_orders_say_nothing_while_time_steps_or_quadrature_disturb_the_errors(disturbed, told: str) -> None:
    assert told in reason(own(following([0.5, 0.5], **disturbed))["order"])


def rough(errors: np.ndarray | list[float]) -> dict[str, str]:
    e = np.array(errors)
    rows = table(levels=(8, 16, 32, 64), claim="Prop. 5.3", error=e, discrete_error=0.24 * e, expected_order=0.5)
    rows = rows.assign(interpolation_error=e / 0.97)
    return {v.key: v.verdict for v in judge_own(prop_5_3(rows, 0.5), rows)}


def test_no_rate_is_claimed_of_a_rough_case_and_a_limit_contradicts() -> None:
    predicted, slower = (2.0 ** (-order * np.arange(4)) for order in (0.5, 0.2))
    assert {key for key, verdict in rough(predicted).items() if verdict != HOLDS} == {"limit-steeper"}
    for errors, verdicts in (
        (slower, {"order": UNDECIDED, "falling": HOLDS}),
        (0.5 + predicted, {"limit": FAILS, "order": UNDECIDED}),
        ([1.0, 0.8, 0.7, 0.71], {"falling": FAILS}),
        ([1.0, 1.1, 0.7, 0.5], {"falling": UNDECIDED}),
    ):
        assert rough(errors).items() >= verdicts.items()


def test_a_case_of_the_catalogue_fails_as_before() -> None:
    rows = pd.concat([following([0.6, 0.8]).assign(case=case) for case in ("corner", "a")])
    verdicts = prop_5_4(rows)
    found = with_reasons(verdicts, rows)
    assert [v.identity for v in found] == [v.identity for v in verdicts]
    assert [(v.case, v.verdict) for v in found if v.key == "order"] == [("corner", FAILS), ("a", UNDECIDED)]


@pytest.mark.parametrize(
    ("dim", "levels", "expected"),
    [
        (2, [8, 16, 32], [16, 32, 64]),
        (2, [9, 12, 15], [12, 15, 18]),
        (3, [6, 9, 12], [9, 12, 15]),
        (3, [8, 16, 32], [16, 32, 48]),
    ],
)
def test_levels_to_try_are_finer_and_in_space_not_too_fine(dim: int, levels: list[int], expected: list[int]) -> None:
    assert finer(levels, dim) == expected


def test_levels_are_added_until_an_order_can_be_decided() -> None:
    cases = (([8], 3, 2, [8, 16, 32]), ([9, 12], 4, 2, [9, 12, 15, 18]), ([8], 3, 3, [8, 12, 16]))
    assert all(enough(levels, needed, dim) == expected for levels, needed, dim, expected in cases)
    assert "try --levels 16 32 48" in reason(own(following([0.6, 0.8]).assign(dim=3))["order"])
    assert (least_levels("Prop. 5.3"), least_levels("Prop. 5.4")) == (4, 3)


def force(key: str, verdict: str, observed: float) -> Verdict:
    return replace(own(GOOD)["order"], label="contact force", key=key, verdict=verdict, observed=observed)


def test_orders_of_the_contact_force_say_nothing_where_meshes_do_not_resolve_contact() -> None:
    order = force("order-pressure", HOLDS, 1.2)
    assert [one.verdict for one in judge_own([order, force("resultant", HOLDS, 0.01)], GOOD)] == [HOLDS, HOLDS]
    for one in judge_own([order, force("resultant", FAILS, 0.2)], GOOD):
        assert "the force on a face is wrong by 20% on the finest" in reason(one)


def test_a_missed_order_of_the_contact_force_is_undecided_and_penetration_fails() -> None:
    rows = [force("order-pressure", FAILS, 0.5), force("penetration", FAILS, 0.1), force("resultant", HOLDS, 0.01)]
    missed, inside, _ = judge_own(rows, GOOD)
    assert "not converged on these meshes" in reason(missed)
    assert inside.verdict == FAILS


@pytest.mark.parametrize(("order", "verdict"), [(1.2, REPORTED), (0.7, UNDECIDED)])
def test_a_force_that_gains_no_half_order_is_reported_and_one_below_the_order_of_the_error_undecided(
    order: float, verdict: str
) -> None:
    (row,) = judge_own([force("order-dual-superclose", FAILS, order)], GOOD)
    assert row.verdict == verdict


def test_a_time_share_of_the_contact_force_says_nothing_about_the_errors() -> None:
    rows = [force("time-share", FAILS, 0.6), *prop_5_4(following([0.5, 0.5]))]
    share, *others = judge_own(rows, following([0.5, 0.5]))
    assert "raise `pace`" in reason(share)
    assert {row.key: row.verdict for row in others}["order"] == FAILS
