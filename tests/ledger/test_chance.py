"""Rates of alarms: intervals by count, and tails of distributions that are known."""

import math

import numpy as np
import pytest
from scipy import stats

from study.ledger.chance import AGAINST, FEWEST, Tail, interval, promise_verdict, seeds_needed, tail
from study.ledger.verdict import FAILS, HOLDS, UNDECIDED


@pytest.mark.parametrize(("alarms", "judged"), [(0, 0), (0, 100), (1, 100), (7, 120), (20, 20)])
def test_the_interval_has_the_tails_that_clopper_and_pearson_ask_for(alarms: int, judged: int) -> None:
    low, high = interval(alarms, judged)
    assert low == 0 if alarms == 0 else stats.binom.sf(alarms - 1, judged, low) == pytest.approx(0.025)
    assert high == 1 if alarms == judged else stats.binom.cdf(alarms, judged, high) == pytest.approx(0.025)
    assert low * judged <= alarms <= high * judged


def samples(model: stats.rv_continuous, size: int) -> np.ndarray:
    return model.rvs(size=size, random_state=np.random.default_rng(1))


def test_the_tail_of_a_normal_row_is_that_of_the_normal_distribution_at_both_ends_where_a_window_has_two() -> None:
    for distance in (2.0, 3.0, 4.0):
        found = tail(samples(stats.norm(1 - 0.1 * distance, 0.1), 2000), False)
        assert found.model == "normal"
        assert found.rate == pytest.approx(stats.norm.sf(distance), rel=0.4)
    places = samples(stats.norm(-0.7, 0.1), 3000)
    assert tail(places, True).rate == pytest.approx(stats.norm.sf(3), rel=0.5)
    assert tail(places, False).rate < 1e-12


def test_a_normal_row_has_the_rate_of_the_prediction_bound_that_lies_on_the_edge() -> None:
    """The upper prediction bound of one more value is mean + t s √(1 + 1/n), with n − 1 degrees of freedom."""
    places = np.linspace(-1, 1, 8)
    bound = stats.t.ppf(0.95, 7) * places.std(ddof=1) * math.sqrt(9 / 8)
    found = tail(places + 1 - bound, False)
    assert (found.model, found.rate) == ("normal", pytest.approx(0.05))


def test_a_heavy_and_a_bounded_tail_are_not_taken_for_normal_ones() -> None:
    heavy = stats.lognorm(1.0, scale=0.05)
    found = tail(samples(heavy, 3000), False)
    assert found.model == "Pareto"
    assert found.fit >= AGAINST
    assert found.rate == pytest.approx(heavy.sf(1), rel=1.0)
    assert found.rate > 0.2 * heavy.sf(1)
    bounded = tail(samples(stats.beta(2, 1, scale=0.99), 1000), False)
    assert (bounded.model, bounded.rate < 1e-3) == ("Pareto", True)


@pytest.mark.parametrize("shape", [-0.2, 0.3])
def test_the_shape_and_the_scale_of_a_pareto_tail_are_found(shape: float) -> None:
    """60 places lie below 1/2, and 20 are quantiles of a known tail above it."""
    model = stats.genpareto(shape, scale=0.2)
    excess = model.ppf((np.arange(1, 21) - 0.35) / 20)
    found = tail(np.array([*np.linspace(-3, 0.5 - excess[0], 60), *(0.5 + excess)]), False)
    assert found.model == "Pareto"
    assert found.rate == pytest.approx(model.sf(0.5) / 4, rel=0.3)


@pytest.mark.parametrize(
    ("places", "found"),
    [
        (np.full(20, 0.999), Tail("constant", 0.0)),
        (np.full(20, 1.0), Tail("constant", 0.0)),
        (np.full(20, 1.5), Tail("constant", 1.0)),
        (np.repeat([0.0, 1.0], [12, 8]), Tail("Pareto", 0.0, 1.0)),
        (np.repeat([0.0, 1.5], [12, 8]), Tail("Pareto", 0.4, 1.0)),
        (np.repeat([0.0, 0.9], [12, 8]), Tail("Pareto", 0.0, 1.0)),
        (np.append(np.zeros(20), np.linspace(1.1, 1.9, 20)), Tail("Pareto", 0.5, 1.0)),
    ],
)
def test_places_that_do_not_vary_or_lie_on_the_edge_or_beyond_are_counted(places: np.ndarray, found: Tail) -> None:
    assert tail(places, two_sided=False) == found


def test_too_few_seeds_have_no_tail() -> None:
    few = tail(np.linspace(0, 0.5, FEWEST - 1), True)
    assert (few.model, math.isnan(few.rate)) == ("none", True)


@pytest.mark.parametrize(
    ("alarms", "seeds", "state"),
    [(0, 100, UNDECIDED), (0, seeds_needed() - 1, UNDECIDED), (0, seeds_needed(), HOLDS), (5, 100, FAILS)]
    + [(0, 0, UNDECIDED)],
)
def test_the_count_of_seeds_alone_decides_whether_the_promise_is_kept(alarms: int, seeds: int, state: str) -> None:
    assert promise_verdict(*interval(alarms, seeds)) == state
