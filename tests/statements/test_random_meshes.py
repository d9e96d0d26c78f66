"""Verdicts on random meshes depend little on chance, and still notice defects."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from measured_rows import invented, verdicts

from study.ledger.criterion import growth, order, weighted
from study.ledger.datafiles import read_rates
from study.ledger.orders import weighted_order
from study.ledger.verdict import FAILS, HOLDS
from study.ledger.window import Window, around, at_most
from study.statements.interpolation import FIELDS, InterpolationInV
from study.statements.prop_5_4 import FirstOrder
from study.statements.shared.meshes import CELLS, LEADING, in_leading_term, is_random

RESULTS = Path(__file__).parents[2] / "results"
LEVELS = np.array([8, 16, 32])


def spread(statistic: Callable[[np.ndarray, np.ndarray], float], scatter: np.ndarray, rate: float = 1.0) -> float:
    """The deviation of a statistic of errors C h^rate (1 + δ), δ with given deviations on the levels."""
    rng, h = np.random.default_rng(5), 1.0 / LEVELS_OF[len(scatter)]
    return float(np.std([statistic(h, h**rate * np.exp(scatter * rng.normal(size=len(h)))) for _ in range(2000)]))


LEVELS_OF = {3: LEVELS, 5: np.array([8, 16, 32, 64, 128])}


def test_the_numbers_of_cells_are_the_best_weights_where_cells_are_independent() -> None:
    scatter = 0.4 / LEVELS
    found = {power: spread(lambda h, e, power=power: weighted_order(h, e, power), scatter) for power in (0, 1, 2, 3, 4)}
    assert min(found, key=found.__getitem__) == CELLS
    assert found[CELLS] < 0.8 * found[0]


def test_a_weighted_order_is_exact_for_powers_and_sees_what_is_wrong_on_the_finest_level() -> None:
    h = 1.0 / LEVELS
    assert weighted_order(h, 3 * h**1.5, CELLS) == pytest.approx(1.5)
    stagnating = np.array([1.0, 0.5, 0.4])
    assert weighted_order(h, stagnating, CELLS) < weighted_order(h, stagnating, 0)


def table(**columns: list[float]) -> pd.DataFrame:
    return pd.DataFrame({"h": 1.0 / LEVELS, **columns})


def test_growth_is_that_of_a_power_over_all_levels() -> None:
    rule = growth("growth", "growth", at_most(1.25), "ratio", CELLS, 2)
    found, _ = rule.measure(table(ratio=list(1.7 * LEVELS**0.25))) or (None, None)
    assert found == pytest.approx(4**0.25)


@pytest.mark.parametrize("criterion", [weighted, growth])
def test_errors_without_an_order_fail(criterion) -> None:
    given = (CELLS,) if criterion is weighted else (CELLS, 2)
    (value, _) = criterion("key", "quantity", Window(0, 2), "e", *given).measure(table(e=[1.0, 0.0, 0.5]))
    assert np.isnan(value)


@pytest.fixture(scope="module")
def rates() -> pd.DataFrame:
    found = read_rates(RESULTS).assign(expected_order=1.0)
    return found[(found["claim"] == "Prop. 5.4") & (found["family"] == "shaken")]


def rows(rates: pd.DataFrame, case: str = "travelling-patch") -> dict[str, str]:
    found = FirstOrder().judge(rates[rates["case"] == case])
    return {verdict.key: verdict.verdict for verdict in found}


def test_shaken_meshes_are_random_with_any_seed() -> None:
    assert [is_random(name) for name in ("shaken", "shaken-7", "unstructured", "one-diagonal")] == [
        True,
        True,
        False,
        False,
    ]


def test_orders_are_taken_in_the_leading_term_on_random_meshes_alone(rates: pd.DataFrame) -> None:
    group = rates[rates["case"] == "corner"]
    found = in_leading_term({"shaken-3": group, "one-diagonal": group})
    assert (found["shaken-3"]["h"] == group[LEADING]).all()
    assert (found["one-diagonal"]["h"] == group["h"]).all()


def test_a_mesh_that_happens_to_be_bad_is_no_alarm(rates: pd.DataFrame) -> None:
    """One on which interpolation, its leading term and the error are 12 % larger: in h the order would be 0.8."""
    worse = rates.copy()
    mine = (worse["case"] == "travelling-patch") & (worse["level"] == 16)
    for name in ("error", "interpolation_error", "discrete_error", "initial_error", LEADING):
        worse.loc[mine, name] *= 1.12
    assert set(rows(worse).values()) == {HOLDS}
    in_h = order("order", "in h", around(1, 0.15), "error").measure(
        worse[mine | ((worse["case"] == "travelling-patch") & (worse["level"] == 8))]
    )
    assert in_h is not None
    assert in_h[0] < 0.85


def test_an_error_that_stagnates_is_an_alarm(rates: pd.DataFrame) -> None:
    worse = rates.copy()
    worse.loc[(worse["case"] == "travelling-patch") & (worse["level"] == 64), "error"] *= 1.3
    assert rows(worse)["order"] == FAILS


def test_a_leading_term_that_is_not_of_order_h_may_not_take_its_place(rates: pd.DataFrame) -> None:
    """Both of order 1/2 would look like order 1."""
    worse = rates.copy()
    for name in ("error", LEADING):
        worse[name] = worse[name] ** 0.5
    found = rows(worse)
    assert found["order"] == HOLDS
    assert found["leading-order"] == FAILS


@pytest.mark.parametrize(("order", "verdict"), [(1.0, HOLDS), (0.8, FAILS), (1.2, FAILS)])
def test_interpolation_of_another_order_fails(order: float, verdict: str) -> None:
    """The scatter of the coarsest mesh hardly counts."""
    errors = np.array([1.05, 1, 1]) * LEVELS**-order
    rows = invented(dict.fromkeys(FIELDS.values(), errors), LEVELS.tolist(), family="shaken")
    assert verdicts(InterpolationInV(), rows) == dict.fromkeys([f"{key}-random" for key in FIELDS], verdict)
