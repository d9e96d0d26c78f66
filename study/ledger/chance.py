"""How often a row of the ledger that is true would not hold by chance: by count, and from the tail of its distribution.

A row lies at a *place* in its window: −1 and 1 are the ends of a window with two, (2v − low − high)/(high − low), and
1 is the end of one that has only one, v/high or low/v. An alarm is a place beyond.

By count, the interval at 95 % is that of Clopper and Pearson. No alarm on 100 seeds only says that the rate is at most
3.6 %, so that the tail is extrapolated as well:

* *normal*: for a sample with mean m and deviation s the place of one more seed lies beyond an end at the distance d
  from m with the probability P(t_{N−1} > d/(s √(1 + 1/N))), Student's, which counts that m and s are estimates. Taken
  where Shapiro and Wilk's test finds no reason against it at 1 %.
* *Pareto*: elsewhere the excesses over the upper quarter towards an end follow a generalised Pareto distribution, whose
  shape and scale come from probability-weighted moments (J. R. M. Hosking, J. R. Wallis, Parameter and quantile
  estimation for the generalized Pareto distribution, Technometrics 29 (1987) 339–349). Bounded tails, as those of rows
  that a theorem bounds, and heavy ones are both among them. Kolmogorov and Smirnov's test says how well it fits.

What does not vary from seed to seed cannot be red by chance. The rate of the whole ledger is at most the sum of those
of its rows, however they depend on each other.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
import scipy  # ``scipy.stats`` takes half a second to import: not before it is used
from numpy.typing import NDArray

from study.ledger.verdict import FAILS, HOLDS, UNDECIDED

Array = NDArray[np.float64]
CONFIDENCE = 0.95
PROMISE = 0.01
"""The rate of alarms of the whole ledger on a fresh seed that the gate must keep."""
AGAINST = 0.01
"""A fit whose test has a smaller p-value is none."""
UPPER = 0.25
"""The part of a sample that is its tail."""
FEWEST = 8
"""With fewer seeds nothing is said of a tail."""
SAME = 2e-3
"""A spread of places that is none: twice what the record resolves."""


@cache
def interval(alarms: int, judged: int) -> tuple[float, float]:
    """The interval of Clopper and Pearson for a rate, at 95 %; (0, 1) if nothing was judged."""
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
        fit: p-value of the test of the model; not a number without one.
    """

    model: str
    rate: float
    fit: float = float("nan")

    @property
    def serves(self) -> bool:
        """Whether there is a model that its test does not contradict."""
        return self.model == "constant" or self.fit >= AGAINST


def tail(places: Array, two_sided: bool) -> Tail:
    """The model of a row from its places on some seeds, (n,)."""
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
    """The probability that one more normal place is larger than 1."""
    n = len(places)
    distance = (1 - places.mean()) / (places.std(ddof=1) * np.sqrt(1 + 1 / n))
    return float(scipy.stats.t.sf(distance, n - 1))


def pareto(places: Array) -> tuple[float, float]:
    """The probability that one more place is larger than 1 by a Pareto tail, and the p-value of its test."""
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


def kept(least: float, by_tail: float) -> str:
    """Whether the promise is kept, from the lower end of the rate by count and the rate by the tails.

    It fails if the count contradicts it, and is undecided while there is a row without a model of its tail, or where
    the tails say more than is promised.
    """
    if least > PROMISE:
        return FAILS
    return HOLDS if by_tail <= PROMISE else UNDECIDED
