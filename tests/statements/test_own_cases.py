"""A user's own case that is a poor test is undecided, with what to do; it fails where the data contradict."""

from __future__ import annotations

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


def own(rows: pd.DataFrame) -> dict[str, Verdict]:
    return {verdict.key: verdict for verdict in judge_own(prop_5_4(rows), rows)}


def reason(verdict: Verdict) -> str:
    assert verdict.verdict == UNDECIDED
    return verdict.expected.partition(BECAUSE)[2]


@pytest.mark.parametrize("orders", [[0.6, 0.8], [0.3, 0.6, 0.79], [1.5, 1.3], [0.7, 0.99]])
def test_orders_that_approach_the_predicted_one_are_not_asymptotic_yet(orders: list[float]) -> None:
    rows = following(orders)
    assert {v.key: v.verdict for v in prop_5_4(rows)}["order"] in (FAILS, UNDECIDED)
    levels = " ".join(str(16 * 2**i) for i in range(len(rows)))
    assert reason(own(rows)["order"]) == f"not asymptotic yet: try --levels {levels}"


@pytest.mark.parametrize(
    "orders",
    [[0.5, 0.5], [0.5, 0.55], [0.8, 0.7], [1.5, 1.5], [0.4, 0.6, 0.62], [0.99, 0.7, 0.6]],
)
def test_orders_that_stay_away_contradict_the_statement(orders: list[float]) -> None:
    assert own(following(orders))["order"].verdict == FAILS


def test_a_single_order_that_is_out_of_line_decides_nothing() -> None:
    assert reason(own(following([1.02, 0.82]))["order"]) == "values scatter: try --levels 16 32 64"
    assert reason(own(following([0.7, 1.3]))["order"]) == "values scatter: try --levels 16 32 64"
    one = table(levels=(8,), predicted_interpolation=0.2).assign(expected_order=1.0)
    assert reason(own(one)["leading-term"]) == "not asymptotic yet: try --levels 8 16 32"


def test_one_family_that_contradicts_is_enough() -> None:
    rows = pd.concat([following([0.6, 0.8]), following([0.5, 0.5]).assign(family="one-diagonal")])
    assert own(rows)["order"].verdict == FAILS


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
    rows = following([1.0, 1.0], **changes)
    assert {v.key: v.verdict for v in prop_5_4(rows)}[key] == FAILS
    assert told in reason(own(rows)[key])


@pytest.mark.parametrize("column", ["residual", "clamped", "parallelogram"])
def test_an_identity_of_the_program_that_is_violated_fails_for_everybody(column: str) -> None:
    assert own(following([1.0, 1.0], **{column: 0.5}))[column].verdict == FAILS


def test_a_wrong_start_and_errors_that_are_no_numbers_fail_for_everybody() -> None:
    rows = following([1.0, 1.0])
    rows = rows.assign(initial_error=rows["error"], interpolation_error=0.99 * rows["error"])
    assert own(rows)["start-share"].verdict == FAILS
    assert own(following([1.0, 1.0], error=np.nan))["order"].verdict == FAILS


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


def rough(errors: list[float]) -> dict[str, str]:
    levels = tuple(8 * 2**i for i in range(len(errors)))
    e = np.array(errors)
    rows = table(levels=levels, claim="Prop. 5.3", error=e, interpolation_error=e / 0.97, discrete_error=0.24 * e)
    rows = rows.assign(expected_order=0.5)
    return {v.key: v.verdict for v in judge_own(prop_5_3(rows, 0.5), rows)}


def test_no_rate_is_claimed_of_a_rough_case_and_a_limit_contradicts() -> None:
    assert {key for key, verdict in rough([2 ** (-0.5 * i) for i in range(4)]).items() if verdict != HOLDS} == {
        "limit-steeper"
    }
    slower = rough([2 ** (-0.2 * i) for i in range(4)])
    assert (slower["order"], slower["falling"]) == (UNDECIDED, HOLDS)
    with_limit = rough([0.5 + 2 ** (-0.5 * i) for i in range(4)])
    assert (with_limit["limit"], with_limit["order"]) == (FAILS, UNDECIDED)
    assert rough([1.0, 0.8, 0.7, 0.71])["falling"] == FAILS
    assert rough([1.0, 1.1, 0.7, 0.5])["falling"] == UNDECIDED


def test_a_case_of_the_catalogue_fails_as_before() -> None:
    known = following([0.6, 0.8]).assign(case="corner", claim="Prop. 5.4")
    verdicts = [v for case in ("corner", "a") for v in prop_5_4(known.assign(case=case))]
    of = ["corner"] * (len(verdicts) // 2) + ["a"] * (len(verdicts) // 2)
    named = [replace(v, case=case) for v, case in zip(verdicts, of, strict=True)]
    found = with_reasons(named, pd.concat([known, known.assign(case="a")]))
    assert [v.identity for v in found] == [v.identity for v in named]
    assert [v.verdict for v in found if v.key == "order"] == [FAILS, UNDECIDED]


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
    assert enough([8], 3, dim=2) == [8, 16, 32]
    assert enough([9, 12], 4, dim=2) == [9, 12, 15, 18]
    assert enough([8], 3, dim=3) == [8, 12, 16]
    assert "try --levels 16 32 48" in reason(own(following([0.6, 0.8]).assign(dim=3))["order"])
    assert (least_levels("Prop. 5.3"), least_levels("Prop. 5.4")) == (4, 3)


def force(key: str, verdict: str, observed: float) -> Verdict:
    return replace(
        own(following([1.0, 1.0]))["order"], label="contact force", key=key, verdict=verdict, observed=observed
    )


def test_orders_of_the_contact_force_say_nothing_where_meshes_do_not_resolve_contact() -> None:
    for off, resolved in ((0.01, True), (0.2, False)):
        rows = [force("order-pressure", HOLDS, 1.2), force("resultant", HOLDS if resolved else FAILS, off)]
        found = judge_own(rows, following([1.0, 1.0]))
        if resolved:
            assert [one.verdict for one in found] == [HOLDS, HOLDS]
        else:
            assert all("the force on a face is wrong by 20% on the finest" in reason(one) for one in found)


def test_a_missed_order_of_the_contact_force_is_undecided_and_penetration_fails() -> None:
    rows = [force("order-pressure", FAILS, 0.5), force("penetration", FAILS, 0.1), force("resultant", HOLDS, 0.01)]
    missed, inside, _ = judge_own(rows, following([1.0, 1.0]))
    assert "not converged on these meshes" in reason(missed)
    assert inside.verdict == FAILS


def test_a_contact_force_that_gains_no_half_order_is_reported_and_one_below_the_order_of_the_error_undecided() -> None:
    for order, verdict in ((1.2, REPORTED), (0.7, UNDECIDED)):
        (row,) = judge_own([force("order-dual-superclose", FAILS, order)], following([1.0, 1.0]))
        assert row.verdict == verdict


def test_a_time_share_of_the_contact_force_says_nothing_about_the_errors() -> None:
    rows = [force("time-share", FAILS, 0.6), *prop_5_4(following([0.5, 0.5]))]
    share, *others = judge_own(rows, following([0.5, 0.5]))
    assert "raise `pace`" in reason(share)
    assert {row.key: row.verdict for row in others}["order"] == FAILS
