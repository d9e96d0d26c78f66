"""Estimates how often a check fails by chance although the program is correct (its false-alarm rate).

Checks are measured on meshes with random vertices, so their values depend on the seed of the mesh. For each seed, the
value v of a check has a *position* in its tolerance window [low, high], whose ends have the positions −1 and 1:
position = (2v − low − high)/(high − low). If only one end is finite, it has the position 1, and position = v/high or
low/v. A position beyond an end is a false alarm. The rate of false alarms is estimated in two ways.

First, by counting false alarms, with the 95 % confidence interval of Clopper and Pearson. No alarm on 100 seeds only
shows that the rate is at most 3.6 %.

Second, by extrapolating the tail of the distribution of positions with one of two models:

* *normal*, if the test of Shapiro and Wilk does not reject a normal distribution at 1 %. For N positions with mean m
  and standard deviation s, the next position lies beyond an end at the distance d from m with the probability
  P(t_{N−1} > d/(s √(1 + 1/N))) of Student's distribution, which accounts for m and s being estimates.
* *Pareto* otherwise: the excesses of the largest quarter of the positions over a threshold follow a generalised Pareto
  distribution, which includes bounded and heavy tails. Shape and scale come from probability-weighted moments
  (J. R. M. Hosking, J. R. Wallis, Parameter and quantile estimation for the generalized Pareto distribution,
  Technometrics 29 (1987) 339–349). The test of Kolmogorov and Smirnov tells how well the model fits.

A check whose position is the same for all seeds has no false alarms. The rate of the whole ledger is at most the sum of
the rates of its checks, whether or not they are independent.
"""

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
import scipy  # loads ``scipy.stats`` at its first use, because importing it takes half a second
from numpy.typing import NDArray

from study.ledger.verdict import FAILS, HOLDS, UNDECIDED

Array = NDArray[np.float64]
CONFIDENCE = 0.95
PROMISE = 0.01
"""The largest permitted false-alarm rate: on which share of seeds at least one check may fail by chance."""
AGAINST = 0.01
"""A model of a distribution is accepted if the p-value of its test is at least this number."""
UPPER = 0.25
"""This fraction of all values, the largest ones, is used for the Pareto model of the tail."""
FEWEST = 8
"""The least number of seeds for a model of the distribution of a checked value."""
SAME = 2e-3
"""Positions in the tolerance window that differ by at most this number count as equal. It is twice the resolution with
which positions are stored."""


@cache
def interval(alarms: int, judged: int) -> tuple[float, float]:
    """Return the 95 % confidence interval of a false-alarm rate by Clopper and Pearson.

    Parameters:
        alarms: number of seeds with a false alarm.
        judged: number of all seeds; for 0 seeds the interval is (0, 1).
    """
    if judged == 0:
        return 0.0, 1.0
    found = scipy.stats.binomtest(alarms, judged).proportion_ci(CONFIDENCE, method="exact")
    return float(found.low), float(found.high)


@dataclass(frozen=True)
class Tail:
    """A model of the distribution of a checked value on random meshes, from which its false-alarm rate follows.

    Attributes:
        model: normal, Pareto, constant, or none if there are too few seeds.
        rate: the probability of a false alarm on the next seed.
        fit: p-value of the test that compares the model with the values; NaN if the model has no test.
    """

    model: str
    rate: float
    fit: float = float("nan")


def tail(places: Array, two_sided: bool) -> Tail:
    """Return the model of the distribution of a checked value on random meshes.

    Parameters:
        places: positions of the value in its tolerance window for all seeds, (seeds,); the ends are −1 and 1.
        two_sided: whether values can come near both ends of the window.
    """
    if len(places) < FEWEST or not np.isfinite(places).all():
        return Tail("none", float("nan"))
    if np.ptp(places) <= SAME:
        return Tail("constant", float(max(abs(places)) > 1))
    ends = (1.0, -1.0) if two_sided else (1.0,)
    fit = float(scipy.stats.shapiro(places).pvalue)
    if fit >= AGAINST:
        return Tail("normal", sum(normal(end * places) for end in ends), fit)
    rates, fits = zip(*(pareto(end * places) for end in ends), strict=True)
    return Tail("Pareto", sum(rates), min(fits))


def normal(places: Array) -> float:
    """Return the probability that the next position is larger than 1 if positions are normally distributed.

    Parameters:
        places: positions of a value in its tolerance window, whose upper end is 1, (seeds,).
    """
    n = len(places)
    distance = (1 - places.mean()) / (places.std(ddof=1) * np.sqrt(1 + 1 / n))
    return float(scipy.stats.t.sf(distance, n - 1))


def pareto(places: Array) -> tuple[float, float]:
    """Return the probability that the next position is larger than 1 if large positions follow a Pareto distribution.

    Parameters:
        places: positions of a value in its tolerance window, whose upper end is 1, (seeds,).

    Returns:
        The probability, and the p-value of the test of Kolmogorov and Smirnov for the model.
    """
    ordered = np.sort(places)
    most = max(FEWEST // 2, round(UPPER * len(places)))
    threshold = (ordered[-most - 1] + ordered[-most]) / 2
    excess = ordered[-most:] - threshold
    above = most / len(places)
    if threshold >= 1 or np.ptp(excess) == 0:
        return float((places > 1).mean()), 1.0
    ranks = (np.arange(1, most + 1) - 0.35) / most
    mean, weighted = excess.mean(), float(np.mean((1 - ranks) * excess))
    shape, scale = 2 - mean / (mean - 2 * weighted), 2 * mean * weighted / (mean - 2 * weighted)
    model = scipy.stats.genpareto(shape, scale=scale)
    return above * float(model.sf(1 - threshold)), float(scipy.stats.kstest(excess, model.cdf).pvalue)


def promise_verdict(low: float, high: float) -> str:
    """Return whether the false-alarm rate of all checks together is at most ``PROMISE``: holds, fails or undecided.

    Only counted alarms decide. Models of distributions do not, because they extrapolate beyond all measured seeds.

    Parameters:
        low, high: confidence interval of the rate by counting alarms.
    """
    if low > PROMISE:
        return FAILS
    return HOLDS if high <= PROMISE else UNDECIDED


def seeds_needed() -> int:
    """Return the number of seeds without any alarm that shows that the false-alarm rate is at most ``PROMISE``."""
    return math.ceil(math.log((1 - CONFIDENCE) / 2) / math.log(1 - PROMISE))
