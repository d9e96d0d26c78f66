"""Verdicts on Propositions 5.3 and 5.4, cases with an initial gap and users' cases: each can come out otherwise."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from places import RESULTS

from study.ledger import quantities
from study.ledger.datafiles import read_rates
from study.ledger.verdict import BECAUSE, FAILS, HOLDS, MISSED, REPORTED, UNDECIDED
from study.run.judgement import with_reasons
from study.run.provenance import Complete
from study.statements.own_cases import enough, finer, judge_own, why_missed
from study.statements.prop_5_4 import Convergence, FirstOrder, RegularityNeeded, SizeOfInterpolation
from study.statements.shared.meshes import LEADING
from study.statements.thm_4_2 import SameMesh


def table(order=1.0, levels=(8, 16, 32), claim="Prop. 5.4", case="a", family="criss-cross", **changes):
    h = 1 / np.array(levels, dtype=float)
    size = h**order
    rows = pd.DataFrame({"level": levels, "h": h, "dofs": 2 / h**2, "error": 0.97 * size, "interpolation_error": size})
    rows = rows.assign(claim=claim, case=case, family=family, dim=2, predicted_interpolation=size)
    rows = rows.assign(discrete_error=0.24 * size, initial_error=0.0, time_share=0.01, discrete_time_share=0.1)
    rows = rows.assign(residual=1e-14, clamped=0.0, parallelogram=1e-12, quadrature_change=0.001)
    return rows.assign(**changes)


def rough(order=0.5, **changes):
    return table(order, (8, 16, 32, 64), "Prop. 5.3", **changes)


def prop_5_4(rows, order=1.0):
    return [*FirstOrder().judge(rows.assign(expected_order=order)), *SizeOfInterpolation().judge(rows)]


def prop_5_3(rows, order=0.5):
    return Convergence().judge(rows.assign(expected_order=order))


def verdicts(judge, *rows):
    return {verdict.key: verdict.verdict for verdict in judge(*rows)}


def claimed(found):
    """All verdicts except on the limit for another order than the predicted one, about which nothing is claimed."""
    return {verdict.verdict for verdict in found if verdict.key != "limit-steeper"}


def test_the_predicted_behaviour_holds_in_every_row_and_an_order_too_low_or_too_good_fails():
    assert set(verdicts(prop_5_4, table()).values()) == {HOLDS}
    assert {verdicts(prop_5_4, table(order))["order"] for order in (0.0, 0.5, 0.8, 1.2, 1.5, 2.0)} == {FAILS}
    solid = [verdicts(prop_5_4, table(order, dim=3)) for order in (0.97, 0.88)]
    for key in ("order-finest", "interpolation-order-finest"):
        assert [found[key] for found in solid] == [HOLDS, FAILS], "in 3D the finest pair must be within a tenth of one"


@pytest.mark.parametrize(
    ("column", "wrong", "key"),
    [
        ("time_share", 0.021, "time-share"),
        ("discrete_time_share", 0.31, "discrete-time-share"),
        ("residual", 1e-9, "residual"),
        ("clamped", 1e-3, "clamped"),
        ("parallelogram", 0.01, "parallelogram"),
        ("quadrature_change", 0.04, "quadrature"),
        ("predicted_interpolation", 1.0, "leading-term"),
        ("discrete_error", 1.0, "discrete-share"),
        ("discrete_error", 1.0, "discrete-order-others"),
        ("error", 0.8 * table()["error"], "size"),
        ("error", 1.2 * table()["error"], "size"),
        ("family", "one-diagonal", "discrete-order-superclose"),
    ],
)
def test_each_piece_of_evidence_fails_alone_if_it_is_wrong(column, wrong, key):
    assert verdicts(prop_5_4, table(**{column: wrong}))[key] == FAILS


EVIDENCE = {
    "time_share": "time-share",
    "residual": "residual",
    "clamped": "clamped",
    "parallelogram": "parallelogram",
    "quadrature_change": "quadrature",
    "initial_error": "start-share",
}
"""Column ↦ key of the check that needs it on every level."""


@pytest.mark.parametrize("level", range(3))
@pytest.mark.parametrize("column", EVIDENCE)
def test_evidence_that_is_missing_on_one_level_fails(column, level):
    rows = table()
    rows.loc[level, column] = np.nan
    assert verdicts(prop_5_4, rows)[EVIDENCE[column]] == FAILS


@pytest.mark.parametrize(
    ("start", "interpolation", "verdict"),
    [(0.5, 1.03, HOLDS), (1.0, 1.03, REPORTED), (1.0, 1.24, REPORTED), (1.0, 1.27, FAILS), (1.0, 0.999, FAILS)],
)
def test_an_error_largest_at_the_start_is_the_predicted_interpolation_error(start, interpolation, verdict):
    """Start and interpolation error are multiples of the largest error."""
    error = table()["error"]
    rows = table(initial_error=start * error, interpolation_error=interpolation * error)
    assert verdicts(prop_5_4, rows)["start-share"] == verdict


def test_missing_rows_leave_the_data_undecided():
    planned = {("a", "criss-cross", "midpoint", "8"), ("a", "criss-cross", "midpoint", "16")}
    assert [Complete().judge(planned, found).verdict for found in (planned, set())] == [HOLDS, UNDECIDED]


def test_two_levels_leave_the_order_undecided():
    found = verdicts(prop_5_4, table(levels=(8, 16)))
    assert found["order"] == found["order-extrapolated"] == UNDECIDED


def test_prop_5_3_accepts_any_rate_it_predicts_but_no_positive_limit_and_no_rising_error():
    rows = rough()
    assert claimed(prop_5_3(rows)) == {HOLDS}
    assert verdicts(prop_5_3, rows.assign(error=rows["error"] + 0.5))["limit"] == FAILS
    assert verdicts(prop_5_3, rows.assign(error=rows["error"].to_numpy()[::-1]))["falling"] == FAILS


def test_on_random_meshes_a_limit_is_reported_only_and_other_meshes_still_decide():
    random = rough(family="shaken-7")
    plain = rough()
    alone = verdicts(prop_5_3, random)
    assert "limit" not in alone
    assert alone["limit-random"] == REPORTED
    assert alone["falling"] == HOLDS
    assert alone["order"] == HOLDS
    assert verdicts(prop_5_3, pd.concat([random, plain.assign(error=plain["error"] + 0.5)]))["limit"] == FAILS


def test_graded_meshes_must_regain_the_order_that_uniform_ones_lose():
    regained, lost = (pd.concat([rough(), rough(order, family="graded")]) for order in (1.0, 0.5))
    assert claimed(prop_5_3(regained)) == {HOLDS}
    assert verdicts(prop_5_3, lost)["order-graded"] == FAILS


@pytest.mark.parametrize(
    ("order", "proved", "expected"),
    [(1, 0.75, [REPORTED, HOLDS]), (0.92, 1, [MISSED, HOLDS]), (0.85, 1, [MISSED, FAILS])],
)
def test_the_order_without_5_36_is_reported_and_fails_far_below_the_proved_order(order, proved, expected):
    """A mesh that is too coarse may cost 0.1."""
    assert [row.verdict for row in RegularityNeeded().judge(rough(order, proved_order=proved))] == expected


def test_theorem_4_2_fails_above_the_bound_by_the_duality_gap_and_where_the_bound_is_vacuous():
    gaps = dict.fromkeys(("admissibility", "energy_gap", "membership", "displacement_gap", "stress_gap"), 1e-9)
    numbers = gaps | dict.fromkeys(("displacement_bound", "stress_bound"), 1e-7)
    good = pd.DataFrame([{"case": "a", "family": "shaken", "h": 0.25, **numbers}])
    assert set(verdicts(SameMesh().judge, good).values()) == {HOLDS}
    for column in numbers:
        bound = column.endswith("bound")
        for value in (1e-4 if bound else 1e-6, np.nan):
            fails = [verdict.verdict for verdict in SameMesh().judge(good.assign(**{column: value}))].count(FAILS)
            assert fails >= 1 if bound else fails == 1


# A user's own case that is a poor test is undecided, with what to do; it fails where the data contradict.


def following(orders, **changes):
    """Rows whose errors have these orders from level to level."""
    levels = tuple(8 * 2**i for i in range(len(orders) + 1))
    error = 0.1 * 0.5 ** np.cumsum([0.0, *orders])
    sizes = {"error": error, "interpolation_error": error / 0.97, "predicted_interpolation": error / 0.97}
    return table(levels=levels, **(sizes | {"discrete_error": 0.24 * error} | changes)).assign(expected_order=1.0)


GOOD = following([1.0, 1.0])


def own(rows):
    return {verdict.key: verdict for verdict in judge_own(prop_5_4(rows), rows)}


def reason(verdict):
    assert verdict.verdict == UNDECIDED
    return verdict.expected.partition(BECAUSE)[2]


@pytest.mark.parametrize("orders", [[0.5, 0.55], [1.5, 1.5], [0.99, 0.7, 0.6]])
def test_orders_that_stay_away_contradict_the_statement_also_on_one_family_alone(orders):
    rows = following(orders)
    assert own(rows)["order"].verdict == FAILS
    assert own(pd.concat([following([0.6, 0.8]), rows.assign(family="one-diagonal")]))["order"].verdict == FAILS


@pytest.mark.parametrize(
    ("orders", "changes", "key", "told"),
    [
        ([0.6, 0.8], {}, "order", "not asymptotic yet: try --levels 16 32 64"),
        ([1.02, 0.82], {}, "order", "values scatter: try --levels 16 32 64"),
        ([], {"predicted_interpolation": 0.2}, "leading-term", "not asymptotic yet: try --levels 8 16 32"),
        ([0.6, 0.8], {"dim": 3}, "order", "try --levels 16 32 48"),
        ([1, 1], {"time_share": 0.03}, "time-share", "raise `pace`"),
        ([1, 1], {"discrete_time_share": 0.31}, "discrete-time-share", "raise `pace`"),
        ([1, 1], {"quadrature_change": 0.04}, "quadrature", "flatten them, or try --levels 16 32 64"),
        ([1, 1], {"discrete_error": 1.0}, "discrete-share", "more than a good test allows"),
        ([1, 1], {"discrete_error": 0.03}, "discrete-order-others", "not asymptotic"),
        ([1, 1], {"discrete_error": 0.03, "family": "one-diagonal"}, "discrete-order-superclose", "wrong by a little"),
        ([0.5, 0.5], {"quadrature_change": 0.1}, "order", "quadrature disturbs the errors: mend that first"),
        ([0.5, 0.5], {"quadrature_change": 0.1, "time_share": 0.1}, "order", "time steps and quadrature disturb"),
    ],
)
def test_what_an_own_case_leaves_undecided_is_told_with_its_reason_and_what_to_do(orders, changes, key, told):
    assert told in reason(own(following(orders, **changes))[key])


@pytest.mark.parametrize(
    ("ends", "reason"),
    {
        (0.5, 0.6): "not asymptotic yet",
        (0.5, 0.59): "",
        (1.5, 1.41): "",
        (0.5, 1.5): "values scatter",
        (0.85, 0.9): "not asymptotic yet",
        (0.84, 0.86): "not asymptotic yet",
        (0.95, 0.8): "values scatter",
    }.items(),
)
def test_a_missed_order_is_explained_unless_two_values_stay_on_one_side_and_hardly_approach(ends, reason):
    """The order 1 with the tolerance 0.15; an approach takes off a fifth of the distance or more."""
    assert why_missed([np.array(ends)], 1.0, 0.15, "").removesuffix(": ") == reason


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        *(({column: 0.5}, column) for column in ("residual", "clamped", "parallelogram")),
        ({"initial_error": GOOD["error"], "interpolation_error": 0.99 * GOOD["error"]}, "start-share"),
        ({"error": np.nan}, "order"),
    ],
)
def test_violated_identities_a_wrong_start_and_errors_that_are_no_numbers_fail_for_everybody(changes, key):
    assert own(GOOD.assign(**changes))[key].verdict == FAILS


def own_rough(errors):
    e = np.array(errors)
    rows = rough(error=e, discrete_error=0.24 * e, interpolation_error=e / 0.97, expected_order=0.5)
    return verdicts(judge_own, prop_5_3(rows), rows)


def test_no_rate_is_claimed_of_a_rough_own_case_and_a_limit_contradicts():
    predicted, slower = (2.0 ** (-order * np.arange(4)) for order in (0.5, 0.2))
    assert {key for key, verdict in own_rough(predicted).items() if verdict != HOLDS} == {"limit-steeper"}
    for errors, expected in (
        (slower, {"order": UNDECIDED, "falling": HOLDS}),
        (0.5 + predicted, {"limit": FAILS, "order": UNDECIDED}),
        ([1.0, 0.8, 0.7, 0.71], {"falling": FAILS}),
        ([1.0, 1.1, 0.7, 0.5], {"falling": UNDECIDED}),
    ):
        assert own_rough(errors).items() >= expected.items()


def test_a_case_of_the_catalogue_fails_as_before():
    rows = pd.concat([following([0.6, 0.8]).assign(case=case) for case in ("corner", "a")])
    judged = prop_5_4(rows)
    found = with_reasons(judged, rows)
    assert [v.identity for v in found] == [v.identity for v in judged]
    assert [(v.case, v.verdict) for v in found if v.key == "order"] == [("corner", FAILS), ("a", UNDECIDED)]


def test_levels_to_try_are_finer_in_space_not_too_fine_and_as_many_as_an_order_needs():
    assert [finer([9, 12, 15], dim) for dim in (2, 3)] == [[12, 15, 18]] * 2
    assert [enough([8], 3, dim) for dim in (2, 3)] == [[8, 16, 32], [8, 12, 16]]


def force(key, verdict, observed):
    return replace(own(GOOD)["order"], label="contact force", key=key, verdict=verdict, observed=observed)


def test_orders_of_the_contact_force_say_nothing_where_meshes_do_not_resolve_contact():
    order = force("order-pressure", HOLDS, 1.2)
    assert [one.verdict for one in judge_own([order, force("resultant", HOLDS, 0.01)], GOOD)] == [HOLDS, HOLDS]
    for label, key in (("Prop. 5.4", "leading-order"), ("Thm 4.2", "allowed")):
        (own,) = judge_own([replace(order, label=label, key=key, verdict=FAILS, observed=1.2)], GOOD)
        assert own.verdict == UNDECIDED
    for one in judge_own([order, force("resultant", FAILS, 0.2)], GOOD):
        assert "the force on a face is wrong by 20% on the finest" in reason(one)


def test_a_missed_order_of_the_contact_force_is_undecided_or_reported_and_penetration_fails():
    rows = [force("order-pressure", FAILS, 0.5), force("penetration", FAILS, 0.1), force("resultant", HOLDS, 0.01)]
    missed, inside, _ = judge_own(rows, GOOD)
    assert "not converged on these meshes" in reason(missed)
    assert inside.verdict == FAILS
    # A force that gains no half order, and one below the order of the error.
    rows = [force("order-dual-superclose", FAILS, order) for order in (1.2, 0.7)]
    assert [row.verdict for row in judge_own(rows, GOOD)] == [REPORTED, UNDECIDED]


def test_a_time_share_of_the_contact_force_says_nothing_about_the_errors():
    rows = [force("time-share", FAILS, 0.6), *prop_5_4(following([0.5, 0.5]))]
    share, *others = judge_own(rows, following([0.5, 0.5]))
    assert "raise `pace`" in reason(share)
    assert {row.key: row.verdict for row in others}["order"] == FAILS


# Verdicts on random meshes depend little on chance, and still notice defects.


@pytest.fixture
def rates():
    """Committed rows of a case on shaken meshes."""
    found = read_rates(RESULTS).assign(expected_order=1.0)
    return found[(found["case"] == "advance-recede") & (found["family"] == "shaken")].copy()


def test_a_mesh_that_happens_to_be_bad_is_no_alarm(rates):
    """One on which interpolation, its leading term and the error are 12 % larger: in h the order would be 0.8."""
    errors = ["error", "interpolation_error", "discrete_error", "initial_error", LEADING]
    rates.loc[rates["level"] == 16, errors] *= 1.12
    assert set(verdicts(FirstOrder().judge, rates).values()) == {HOLDS}
    assert quantities.fitted("error")(rates[rates["level"] <= 16]) < 0.85


def test_an_error_that_stagnates_and_a_leading_term_that_is_not_of_order_h_are_alarms(rates):
    """If both were of order 1/2, the order of the error in the leading term would be 1."""
    stagnating = rates["error"].where(rates["level"] != 64, 1.3 * rates["error"])
    assert verdicts(FirstOrder().judge, rates.assign(error=stagnating))["order"] == FAILS
    rates[["error", LEADING]] **= 0.5
    found = verdicts(FirstOrder().judge, rates)
    assert found["order"] == HOLDS
    assert found["leading-order"] == FAILS
