"""Verdicts on random meshes depend little on chance, and still notice defects."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from measured_rows import verdicts

from study.ledger.criterion import growth, order, weighted
from study.ledger.datafiles import read_rates
from study.ledger.orders import weighted_order
from study.ledger.verdict import FAILS, HOLDS
from study.ledger.window import Window, around, at_most
from study.statements.prop_5_4 import FirstOrder
from study.statements.shared.meshes import CELLS, LEADING, in_leading_term, is_random

RESULTS = Path(__file__).parents[2] / "results"
LEVELS = np.array([8, 16, 32])
H = 1.0 / LEVELS


def test_a_weighted_order_is_exact_for_powers_and_sees_what_is_wrong_on_the_finest_level() -> None:
    assert weighted_order(H, 3 * H**1.5, CELLS) == pytest.approx(1.5)
    stagnating = np.array([1.0, 0.5, 0.4])
    assert weighted_order(H, stagnating, CELLS) < weighted_order(H, stagnating, 0)


def test_growth_is_that_of_a_power_over_all_levels_and_errors_without_an_order_fail() -> None:
    ratio = growth("growth", "growth", at_most(1.25), "e", CELLS, 2)
    assert ratio.measure(pd.DataFrame({"h": H, "e": 1.7 * LEVELS**0.25}))[0] == pytest.approx(4**0.25)
    for rule in (ratio, weighted("key", "quantity", Window(0, 2), "e", CELLS)):
        assert np.isnan(rule.measure(pd.DataFrame({"h": H, "e": [1.0, 0.0, 0.5]}))[0])


@pytest.fixture
def rates() -> pd.DataFrame:
    """The committed rows of two cases on shaken meshes."""
    found = read_rates(RESULTS).assign(expected_order=1.0)
    return found[(found["claim"] == "Prop. 5.4") & (found["family"] == "shaken")].copy()


def rows(rates: pd.DataFrame) -> dict[str, str]:
    return verdicts(FirstOrder(), rates[rates["case"] == "travelling-patch"])


def test_orders_are_taken_in_the_leading_term_on_random_meshes_alone(rates: pd.DataFrame) -> None:
    names = "shaken", "shaken-7", "unstructured", "one-diagonal"
    assert [is_random(name) for name in names] == [True, True, False, False]
    found = in_leading_term({"shaken-3": rates, "one-diagonal": rates})
    assert (found["shaken-3"]["h"] == rates[LEADING]).all()
    assert (found["one-diagonal"]["h"] == rates["h"]).all()


def test_a_mesh_that_happens_to_be_bad_is_no_alarm(rates: pd.DataFrame) -> None:
    """One on which interpolation, its leading term and the error are 12 % larger: in h the order would be 0.8."""
    mine = rates["case"] == "travelling-patch"
    for name in ("error", "interpolation_error", "discrete_error", "initial_error", LEADING):
        rates.loc[mine & (rates["level"] == 16), name] *= 1.12
    assert set(rows(rates).values()) == {HOLDS}
    in_h = order("order", "in h", around(1, 0.15), "error").measure(rates[mine & (rates["level"] <= 16)])
    assert in_h is not None
    assert in_h[0] < 0.85


def test_an_error_that_stagnates_is_an_alarm(rates: pd.DataFrame) -> None:
    rates.loc[rates["level"] == 64, "error"] *= 1.3
    assert rows(rates)["order"] == FAILS


def test_a_leading_term_that_is_not_of_order_h_may_not_take_its_place(rates: pd.DataFrame) -> None:
    """Both of order 1/2 would look like order 1."""
    rates[["error", LEADING]] **= 0.5
    found = rows(rates)
    assert (found["order"], found["leading-order"]) == (HOLDS, FAILS)
