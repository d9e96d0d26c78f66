"""The false-alarm rate of a row of the ledger: by counting seeds, and from the tail of its distribution.

A value v has a *place* in its window: (2v − low − high)/(high − low) in a window with two ends, which are −1 and 1;
v/high or low/v in a window with one end, which is 1. A place beyond an end is an alarm.

By count, the confidence interval at 95 % is that of Clopper and Pearson. No alarm on 100 seeds only shows that the rate
is at most 3.6 %, so that the tail is extrapolated as well:

* *normal*: for a sample with mean m and deviation s the place of one more seed lies beyond an end at the distance d
  from m with the probability P(t_{N−1} > d/(s √(1 + 1/N))), Student's, which counts that m and s are estimates. Taken
  where Shapiro and Wilk's test finds no reason against it at 1 %.
* *Pareto*: elsewhere the excesses over the upper quarter towards an end follow a generalised Pareto distribution, whose
  shape and scale come from probability-weighted moments (J. R. M. Hosking, J. R. Wallis, Parameter and quantile
  estimation for the generalized Pareto distribution, Technometrics 29 (1987) 339–349). Bounded tails, as those of rows
  that a theorem bounds, and heavy ones are both among them. Kolmogorov and Smirnov's test says how well it fits.

A row that does not vary from seed to seed has no false alarms. The rate of the whole ledger is at most the sum of the
rates of its rows, however they depend on each other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
import scipy  # ``scipy.stats`` takes half a second to import: not before it is used
from numpy.typing import NDArray

from study.ledger.verdict import FAILS, HOLDS, UNDECIDED

Array = NDArray[np.float64]
CONFIDENCE = 0.95
PROMISE = 0.01
"""The largest false-alarm rate of the whole ledger on a fresh seed."""
AGAINST = 0.01
"""The least p-value of a fit that is accepted."""
UPPER = 0.25
"""The fraction of a sample that is its tail."""
FEWEST = 8
"""The least number of seeds for a model of the tail."""
SAME = 2e-3
"""A spread of places up to which they count as constant: twice the resolution of the record."""


@cache
def interval(alarms: int, judged: int) -> tuple[float, float]:
    """Return the interval of Clopper and Pearson for a rate, at 95 %; (0, 1) if nothing was judged."""
    if judged == 0:
        return 0.0, 1.0
    found = scipy.stats.binomtest(alarms, judged).proportion_ci(CONFIDENCE, method="exact")
    return float(found.low), float(found.high)


@dataclass(frozen=True)
class Tail:
    """A model of the distribution of a row's place.

    Attributes:
        model: normal, Pareto, constant, or none where there are too few seeds.
        rate: the probability of an alarm on one more seed.
        fit: p-value of the test of the model; NaN without a model.
    """

    model: str
    rate: float
    fit: float = float("nan")

    @property
    def serves(self) -> bool:
        """Whether there is a model that its test accepts."""
        return self.model == "constant" or self.fit >= AGAINST


def tail(places: Array, two_sided: bool) -> Tail:
    """Return the model of a row from its places on n seeds, (n,)."""
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
    """Return the probability that one more normal place is larger than 1."""
    n = len(places)
    distance = (1 - places.mean()) / (places.std(ddof=1) * np.sqrt(1 + 1 / n))
    return float(scipy.stats.t.sf(distance, n - 1))


def pareto(places: Array) -> tuple[float, float]:
    """Return the probability, by a Pareto tail, that one more place is larger than 1, and the p-value of its test."""
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
    """Return the verdict on the promised rate from the confidence interval of the rate by count alone.

    The model of the tails judges nothing: it extrapolates beyond all seeds that were drawn.
    """
    if low > PROMISE:
        return FAILS
    return HOLDS if high <= PROMISE else UNDECIDED


def seeds_needed() -> int:
    """Return the least number of seeds, none of them with an alarm, that decides that the promise is met."""
    return math.ceil(math.log((1 - CONFIDENCE) / 2) / math.log(1 - PROMISE))
