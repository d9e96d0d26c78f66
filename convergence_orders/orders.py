"""Computes the observed orders of a sequence of errors, says what the errors do, and judges the orders."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
HOLDS = "holds"
FAILS = "fails"
UNDECIDED = "undecided"
HIGHER = "higher"
SKIPPED = "skipped"
"""Verdicts."""
TOLERANCE = 0.15
"""Default for the accepted difference between an observed and an expected order."""
STALLED = 0.2
"""Errors stagnate if the orders on the finest meshes are at most this number and not as expected, and grow if they are
less than its negative."""
CLEAR = 10.0
"""If errors stagnate at a floor, only errors above this multiple of the floor are judged. A floor of a tenth of an
error changes the order by at most 0.15."""
ROUND_OFF = 1e-10
"""If errors stagnate below this number, relative to the coarsest error or to 1, the cause is taken to be round-off."""
UNCERTAIN = 3.0
"""A fitted limit of errors is not 0 if it exceeds this multiple of its change from one mesh to the next."""
SAME_SIZE = 1e-6
"""Mesh sizes with a smaller relative difference count as equal, because an order between them would be meaningless."""
QUOTED = 4
"""Number of orders that a sentence quotes."""


class OrderError(ValueError):
    """Raised if a table or a sequence of errors cannot be used; the message says how to mend it."""


@dataclass(frozen=True)
class Expectation:
    """What is expected of errors.

    Attributes:
        expected: the order that theory predicts; the observed order may be neither lower nor higher.
        at_least: the smallest accepted order; higher orders are accepted.
        tolerance: accepted difference between the observed order and ``expected``.
        floor: the largest accepted limit of the errors; by default, errors must tend to 0.
        max_error: the largest accepted error on the finest mesh.

    Raises:
        OrderError: both ``expected`` and ``at_least`` are given, or a given number is not positive and finite; only
            ``floor`` may be 0.
    """

    expected: float | None = None
    at_least: float | None = None
    tolerance: float = TOLERANCE
    floor: float = 0.0
    max_error: float | None = None

    def __post_init__(self) -> None:
        if self.expected is not None and self.at_least is not None:
            raise OrderError("give an expected order or a lower limit of the order, not both")
        for name, value in vars(self).items():
            permitted = value is None or (name == "floor" and value == 0)
            if not (permitted or (isinstance(value, int | float | np.number) and 0 < value < math.inf)):
                raise OrderError(f"{name} must be one positive number, got {value!r}")

    @property
    def window(self) -> tuple[float, float] | None:
        """The smallest and the largest accepted order; None if no order is expected."""
        if self.at_least:
            return self.at_least - 1e-9, math.inf
        if self.expected:
            return self.expected - self.tolerance - 1e-9, self.expected + self.tolerance + 1e-9
        return None

    @property
    def judges(self) -> bool:
        """Whether anything is expected, so that there is a verdict."""
        return bool(self.window or self.max_error)

    def __str__(self) -> str:
        words = []
        if self.expected:
            words.append(f"{self.expected:g} ± {self.tolerance:g}")
        if self.at_least:
            words.append(f"at least {self.at_least:g}")
        if self.max_error:
            words.append(f"at most {self.max_error:g} on the finest mesh")
        return ", ".join(words)


class Diagnosis(NamedTuple):
    """The behaviour of a sequence of errors (they converge, stagnate or grow, for example), and the verdict.

    Attributes:
        kind: what the errors do, in a word or two.
        sentence: what the errors do, as a sentence.
        verdict: holds, fails, undecided, higher (than expected) or skipped.
        first, last: the errors that were judged have the indices first, …, last − 1, from the coarsest mesh on; if
            ``last`` is None, they end with the error on the finest mesh.
    """

    kind: str
    sentence: str
    verdict: str
    first: int = 0
    last: int | None = None


@dataclass(frozen=True)
class OrderResult:
    """Observed orders of one sequence of errors on meshes from coarse to fine, with a diagnosis and a verdict.

    Attributes:
        name: name of the errors.
        h, errors: mesh sizes and errors, (levels,).
        orders: observed orders between consecutive meshes, (levels − 1,); NaN if an error is zero or not finite.
        order: least-squares order over the judged meshes.
        extrapolated: order extrapolated to h → 0 from the three finest judged meshes; NaN if there are fewer.
        first, last: the judged meshes have the indices first, …, last − 1.
        kind, sentence: what the errors do, in a word or two, and as a sentence.
        verdict: holds, fails, undecided, higher (than expected), skipped (all errors are zero); None if nothing is
            expected.
        expectation: the expected order.
    """

    name: str
    h: tuple[float, ...]
    errors: tuple[float, ...]
    orders: tuple[float, ...]
    order: float
    extrapolated: float
    first: int
    last: int
    kind: str
    sentence: str
    verdict: str | None
    expectation: Expectation

    @property
    def conclusion(self) -> str:
        """The verdict, what the errors do, and the expected order, in one line."""
        if not self.verdict:
            return self.sentence
        wanted = f"; expected {self.expectation}" if self.expectation.judges else ""
        return f"{self.verdict}: {self.sentence}{wanted}"


@np.errstate(all="ignore")
def consecutive_orders(h: ArrayLike, errors: ArrayLike) -> Array:
    """Return the observed orders of errors e on consecutive meshes of size h, (levels − 1,).

    They are log(e_i/e_{i+1}) / log(h_i/h_{i+1}), and NaN if one of the two errors is zero or not finite.
    """
    # Quotients of very large and very small errors would overflow, differences of logarithms do not.
    x, y = np.diff(np.log(np.asarray([h, errors], dtype=float)))
    orders = y / x
    return np.where(np.isfinite(orders), orders, np.nan)


@np.errstate(all="ignore")
def fitted_order(h: ArrayLike, errors: ArrayLike) -> float:
    """Return the least-squares slope of log e over log h for errors e.

    It is NaN for fewer than two meshes, and if an error is zero or not finite.
    """
    x, y = np.log(np.asarray([h, errors], dtype=float))
    if len(x) < 2 or not np.isfinite(y).all():
        return math.nan
    slope, _ = np.polyfit(x, y, 1)
    return float(slope)


def extrapolated_order(h: ArrayLike, errors: ArrayLike) -> float:
    """Return the observed order for h → 0, extrapolated from the three finest meshes; NaN for fewer meshes.

    The extrapolation assumes that the order is a linear function of the mesh size.
    """
    sizes = np.asarray(h, dtype=float)
    orders = consecutive_orders(h, errors)
    if len(orders) < 2:
        return math.nan
    ratio = math.sqrt(sizes[-3]) / math.sqrt(sizes[-1])
    return float(orders[-1] + (orders[-1] - orders[-2]) / (ratio - 1))


@np.errstate(all="ignore")
def limit_and_order(h: ArrayLike, values: ArrayLike) -> tuple[float, float]:
    """Fit a + C h^p to the values on the three finest meshes, and return the limit a and the order p.

    Let v_1, v_2, v_3 be the values on the three meshes, from coarse to fine; R = h_1/h_2 and r = h_2/h_3; and s = 1 if
    the values are monotone, s = −1 if they oscillate. The method of Celik et al. solves
    (R^p − s)/(1 − s r^−p) = |v_2 − v_1|/|v_3 − v_2|. The left-hand side increases with p, so there is at most one
    solution, and bisection finds it.

    Parameters:
        h, values: mesh sizes and values on three or more meshes, from coarse to fine, (levels,).

    Returns:
        The limit, and the order. Without a fit, the limit is NaN. The order is NaN if v_2 equals v_1 or v_3, −∞ if
        |v_3 − v_2| is too large for any positive order, and ∞ if the order is above 100.
    """
    sizes, finest = np.asarray([h, values], dtype=float)[:, -3:]
    coarse, fine = -np.diff(np.log(sizes))
    changes = np.diff(finest)
    if not changes.all():
        return math.nan, math.nan
    sign = np.prod(np.sign(changes))
    quotient = abs(changes[0] / changes[1])

    def is_large(p: float) -> bool:
        left = (np.exp(p * coarse) - sign) / (1 - sign * np.exp(-p * fine))
        return bool(left >= quotient)

    low = 1e-9
    high = 100.0
    if is_large(low):
        return math.nan, -math.inf
    if not is_large(high):
        return math.nan, math.inf
    for _ in range(60):
        middle = (low + high) / 2
        if is_large(middle):
            high = middle
        else:
            low = middle
    return float(finest[-1] + changes[1] / np.expm1(low * fine)), low


def observed_orders(h: ArrayLike, errors: ArrayLike, expected: float | None = None, at_least: float | None = None,
                    tolerance: float = TOLERANCE, name: str = "", floor: float = 0.0,
                    max_error: float | None = None) -> OrderResult:  # fmt: skip
    """Compute the observed orders of errors, and judge whether they are as expected.

    The verdict is *holds* if the last three orders between consecutive meshes are as expected; two suffice if the order
    extrapolated to h → 0 is as expected, too. It is *fails* if the errors do not converge, or if the last two orders
    are too low and do not rise enough; *higher* if the orders settle above the expected one; and otherwise
    *undecided*, for example if there are fewer than three meshes.

    Parameters:
        h, errors: mesh sizes and errors, (levels,), in any order of the meshes. A masked number counts as NaN.
        expected: the order that theory predicts; observed orders may differ from it by at most ``tolerance``.
        at_least: the smallest accepted order; only one of ``expected`` and ``at_least`` can be given.
        tolerance: accepted difference from ``expected``.
        name: name of the errors, for messages.
        floor: the largest accepted limit of the errors; by default, errors must tend to 0.
        max_error: the largest accepted error on the finest mesh.

    Raises:
        OrderError: the numbers of mesh sizes and errors differ, mesh sizes are not positive or are repeated, an error
            is negative, entries are not real numbers, or the expected order is not a positive number.
    """
    expectation = Expectation(expected, at_least, tolerance, floor, max_error)
    sizes, e = _coarse_first(h, errors, name or "errors")
    if (e < 0).any():
        raise OrderError(f"{name or 'error'} = {np.nanmin(e):g}: errors must not be negative; give absolute values")
    kind, sentence, verdict, first, end = _diagnose(sizes, e, expectation)
    last = len(e) if end is None else end
    if kind == "grows" and sizes.min() > 1:
        sentence += "; or is h the number n of cells? Then give h = 1/n"
    if max_error and not e[-1] <= max_error:
        verdict = FAILS
        sentence = f"{sentence}; the error on the finest mesh is {e[-1]:.3g}"
    elif verdict == UNDECIDED and not expectation.window:
        verdict = HOLDS
    x = sizes[first:last]
    judged = e[first:last]
    return OrderResult(
        name=name,
        h=tuple(sizes.tolist()),
        errors=tuple(e.tolist()),
        orders=tuple(consecutive_orders(sizes, e).tolist()),
        order=fitted_order(x, judged),
        extrapolated=extrapolated_order(x, judged),
        first=first,
        last=last,
        kind=kind,
        sentence=sentence,
        verdict=verdict if expectation.judges or verdict == SKIPPED else None,
        expectation=expectation,
    )


def _coarse_first(h: ArrayLike, values: ArrayLike, name: str) -> tuple[Array, Array]:
    """Return mesh sizes and errors, or other values, as arrays, sorted from the coarsest mesh to the finest.

    Raises:
        OrderError: a value or a mesh size cannot be used, or a mesh size is repeated.
    """
    sizes = real_numbers(h, "h")
    e = real_numbers(values, name)
    if len(sizes) != len(e) or not len(e):
        raise OrderError(f"{len(sizes)} sizes and {len(e)} {name}: expected one number for each mesh")
    if not 0 < sizes.min() <= sizes.max() < math.inf:
        raise OrderError(f"mesh sizes must be positive and finite, got {sizes.tolist()[:10]}")
    sizes, e = np.array([sizes, e])[:, np.argsort(-sizes)]
    repeated = sizes[1:][-np.diff(sizes) < SAME_SIZE * sizes[1:]]
    if repeated.size:
        raise OrderError(f"the mesh size {repeated[0]:.12g} occurs twice: give one error for each mesh")
    return sizes, e


def real_numbers(values: ArrayLike, what: str) -> Array:
    """Return numbers as a flat array of floats. Masked numbers become NaN.

    Parameters:
        values: the numbers.
        what: what the numbers are, for the message of the error.

    Raises:
        OrderError: the numbers are not real, or not in a list or an array.
    """
    try:
        if not np.iscomplexobj(values):
            return np.ma.filled(np.ma.asarray(values, dtype=float), np.nan).ravel()
        problem = "complex numbers; give absolute values"
    except (TypeError, ValueError, OverflowError) as error:
        problem = f"{type(values).__name__}: {error}"
    raise OrderError(f"{what} must be real numbers in a list or an array, got {problem}")


def _text(orders: Array) -> str:
    return ", ".join(f"{order:.2f}" for order in orders[-QUOTED:])


def _behind_last(conditions: NDArray[np.bool_]) -> int:
    """Return the index behind the last true entry; 0 if there is none."""
    return int(max(np.flatnonzero(conditions), default=-1)) + 1


def _diagnose(h: Array, e: Array, expectation: Expectation) -> Diagnosis:
    """Return the diagnosis of a sequence of errors.

    Special cases come first: infinite errors, zero errors, few meshes, stagnation.
    """
    finite = np.isfinite(e)
    if not finite.all():
        where = h[~finite][0]
        words = f"the error is not finite for h = {where:.5g}: the computation broke down there"
        return Diagnosis("not finite", words, FAILS)
    if not e.any():
        return Diagnosis("exactly zero", "the error is exactly zero on all meshes: nothing to judge", SKIPPED)
    if not e.all():
        stop = int(np.argmin(e))
        words = f"is exactly zero for h = {h[stop]:.5g}"
        if e[stop:].any():
            words += ", but not on all finer meshes: is this value right?"
            return Diagnosis("exactly zero", words, UNDECIDED)
        return _above(h, e, stop, 0.0, "exactly zero", words, expectation)
    if len(e) < 3:
        orders = consecutive_orders(h, e)
        grows = "the error grows; " if (orders < -STALLED).any() else ""
        words = f"{grows}a verdict needs three meshes; order {_text(orders) or 'none'}"
        return Diagnosis("grows" if grows else "fewer than three meshes", words, UNDECIDED)
    return _stalled(h, e, expectation) or _tends_to_limit(h, e, expectation) or _trend(h, e, expectation)


def _stalled(h: Array, e: Array, expectation: Expectation) -> Diagnosis | None:
    """Return the diagnosis if errors grow, stagnate or reach round-off on the finest meshes, otherwise None."""
    orders = consecutive_orders(h, e)
    n = len(e)
    coarsest = e[0]
    finest = e[-1]
    stall = _behind_last(orders > STALLED)
    first, verdict = _judge(h, e, expectation)
    # Small orders may be as expected. But errors that do not fall at all stagnate, even if the tolerance includes 0.
    falls_as_expected = verdict == HOLDS and orders[first:].min() > 0
    if (stall == n - 1 or falls_as_expected) and finest < coarsest:
        return None
    floor = float(np.median(e[stall:]))
    start = f"from h = {h[stall]:.5g} on"
    if floor <= ROUND_OFF * max(1.0, coarsest) and stall > 0:
        return _above(h, e, stall, floor, "round-off", f"is round-off of about {floor:.2g} {start}", expectation)
    if finest > 2 * e[stall] or (finest >= 1.01 * coarsest and (stall == n - 1 or orders[-1] < -STALLED)):
        words = f"the error grows as h decreases: orders {_text(orders)}; it does not converge"
        return Diagnosis("grows", words, FAILS)
    question = "" if stall else "; or are these orders or values of a quantity (--values), not errors?"
    words = f"stagnates at about {floor:.2g} {start}: another error dominates (a floor){question}"
    return _above(h, e, stall, floor, "floor", words, expectation)


def _tends_to_limit(h: Array, e: Array, expectation: Expectation) -> Diagnosis | None:
    """Return the diagnosis if errors tend to a limit other than 0, otherwise None.

    Errors a + C h^p are fitted to the last three meshes, and to the three meshes before the last one. The limits a and
    the orders p of both fits must agree. A negative limit is that of errors C (h^p − H^p) against a reference solution
    that was computed on a mesh of size H.
    """
    if len(e) < 4 or np.diff(e[-4:]).max() >= 0:
        return None
    orders = consecutive_orders(h, e)
    changes = np.diff(orders[-3:])
    quoted = _text(orders)
    before, p_before = limit_and_order(h[:-1], e[:-1])
    limit, p = limit_and_order(h, e)
    agree = abs(p_before - p) < 0.02 + 0.1 * abs(changes.sum())
    # Terms of higher order in h also change the orders. But then the fitted limits tend to 0 from mesh to mesh.
    exceeds_0 = abs(limit) > max(0.02 * e[-1], UNCERTAIN * abs(limit - before))
    if not (exceeds_0 and agree):
        return None
    low, high = expectation.window or (p, p)
    if limit < 0 and changes.min() > 0 and low <= p <= high:
        reference = h[-1] * (-limit / (e[-1] - limit)) ** (1 / p)
        words = (
            f"orders rise from mesh to mesh ({quoted}) as those of C (h^p − H^p) with p = {p:.2f}, H = "
            f"{reference:.3g}: an error against a solution computed with h = {reference:.3g}? Take a finer reference"
        )
        return Diagnosis("computed reference", words, UNDECIDED)
    if before > 0 and limit > 0 and changes.max() < 0:
        words = f"orders fall from mesh to mesh ({quoted}): the error tends to {limit:.2g}, not to 0"
        return _above(h, e, len(e), limit, "orders falling", words, expectation)
    return None


def _above(h: Array, e: Array, stall: int, floor: float, kind: str, words: str, expectation: Expectation) -> Diagnosis:
    """Return the diagnosis of errors that stagnate at a floor. Only errors clearly above the floor are judged.

    A floor that the user does not permit fails. If fewer than three orders remain, the verdict is *fails*, and if the
    floor is round-off, *undecided*.

    Parameters:
        h, e, expectation: mesh sizes, errors and expected order.
        stall: index of the first mesh on which the error is at the floor.
        floor: size of the errors at the floor.
        kind, words: what the errors do at the floor, in a word or two, and as a sentence.
    """
    stop = int(min(np.flatnonzero(e[:stall] < CLEAR * floor), default=stall))
    harmless = kind in ("round-off", "exactly zero")
    if not harmless and (floor > expectation.floor or stop < 4):
        hint = f" (--floor {floor:.2g} would permit it)" if stop > 3 else ""
        return Diagnosis("stagnates" if kind == "floor" else kind, words + hint, FAILS)
    if stop < 4:
        words += "; fewer than three orders before: add coarser meshes"
        return Diagnosis(kind, words, UNDECIDED, last=stop)
    first, verdict = _judge(h[:stop], e[:stop], expectation)
    orders = consecutive_orders(h[:stop], e[:stop])[first:]
    return Diagnosis(kind, f"{words}; on coarser meshes the orders are {_text(orders)}", verdict, first, stop)


def _judge(h: Array, e: Array, expectation: Expectation) -> tuple[int, str]:
    """Return the index of the first mesh from which on all orders are as expected, and the verdict.

    If no order is expected, it is the first mesh of the orders that sentences quote, and the verdict is *undecided*.
    """
    orders = consecutive_orders(h, e)
    n = len(e)
    if not expectation.window:
        return max(n - 1 - QUOTED, 0), UNDECIDED
    low, high = expectation.window
    first = _behind_last((orders < low) | (orders > high))
    extrapolated = extrapolated_order(h, e)
    # Two orders suffice if the extrapolated order is as expected, too. If two errors are equal, it is meaningless.
    two_suffice = low <= extrapolated <= high and np.diff(e).all()
    accepted = len(orders) - first
    if accepted > 2 or (accepted == 2 and two_suffice):
        return first, HOLDS
    previous, last = orders[-2:]
    settled = abs(last - previous) <= expectation.tolerance
    verdict = UNDECIDED
    if max(last, previous) < low and (last < previous or (settled and extrapolated < low)):
        verdict = FAILS
    elif min(last, previous) > high and settled and extrapolated > high:
        verdict = HIGHER
    return max(n - 3, 0), verdict


def _trend(h: Array, e: Array, expectation: Expectation) -> Diagnosis:
    """Return the diagnosis of errors that decrease up to the finest mesh."""
    first, verdict = _judge(h, e, expectation)
    orders = consecutive_orders(h, e)
    step = 2 * expectation.tolerance
    listed = _text(orders)
    before, last = np.diff(orders, prepend=orders[0])[-2:]
    # Orders that fall, but settle, fall by less from mesh to mesh.
    drop = 0.8 * before if before < 0 else -step
    # The fitted order lies within the orders that are quoted.
    quoted = slice(max(first, len(e) - QUOTED - 1), None)
    kind = "converges"
    sentence = f"converges with order {fitted_order(h[quoted], e[quoted]):.2f} (orders {_text(orders[first:])})"
    if verdict == HIGHER:
        kind = "higher than expected"
        sentence = f"orders {listed} are higher than expected: superconvergence, or another error?"
    elif verdict != HOLDS and orders.min() < -STALLED:
        kind = "pre-asymptotic"
        sentence = f"errors rise and fall: orders {listed}; no convergence is visible yet"
    elif len(e) > 3 and last < drop and before + last < -0.04:
        kind = "orders falling"
        sentence = f"orders fall on the finest meshes: {listed}; another error may dominate there"
    elif abs(last) > step:
        kind = "pre-asymptotic"
        sentence = f"pre-asymptotic, orders not settled: {listed}; take finer meshes"
    return Diagnosis(kind, sentence, verdict, first)


# The grid convergence index, for quantities without an exact value (Celik et al. 2008; ASME V&V 20).

SAFETY = 1.25
"""The safety factor in the grid convergence index, as recommended for three or more meshes."""


@dataclass(frozen=True)
class GridConvergence:
    """The convergence of a quantity on the three finest meshes, when its exact value is unknown.

    Attributes:
        kind: monotone, oscillating, not monotone (the values pass an extremum), diverging, equal values, or undecided.
        order: the observed order.
        extrapolated: the value extrapolated to h → 0.
        index: grid convergence index of the finest mesh: its estimated relative error, times the safety factor
            ``SAFETY``.
    """

    kind: str
    order: float = math.nan
    extrapolated: float = math.nan
    index: float = math.nan

    def __str__(self) -> str:
        if not math.isfinite(self.order):
            return self.kind
        limit = f"extrapolated {self.extrapolated:.6g}, GCI {self.index:.2%} on the finest mesh"
        return f"{self.kind}, order {self.order:.2f}, {limit}"


def grid_convergence(h: ArrayLike, values: ArrayLike) -> GridConvergence:
    """Return the order, the extrapolated value and the grid convergence index of a quantity on three meshes.

    The method needs no exact value (Celik et al. 2008). It uses the three finest meshes.

    Parameters:
        h, values: mesh sizes and values of the quantity, (levels,).

    Raises:
        OrderError: there are fewer than three meshes, or mesh sizes are not positive and distinct.
    """
    sizes, phi = _coarse_first(h, values, "values")
    if len(sizes) < 3 or not np.isfinite(phi).all():
        raise OrderError(f"values must be finite, on three meshes or more; got {phi.tolist()[:10]}")
    limit, p = limit_and_order(sizes, phi)
    finest = float(phi[-1])
    changes = np.diff(phi[-3:])
    if not changes.all():
        return GridConvergence("equal values", extrapolated=finest, index=math.nan if changes[1] else 0.0)
    # Rounding of the values changes the quotient of their differences, and the order by this change over log r.
    rounding = 4 * np.finfo(float).eps * abs(phi).max() / abs(changes).min()
    if rounding > 0.01 * np.diff(-np.log(sizes[-3:])).min():
        return GridConvergence("undecided")
    if not math.isfinite(limit):
        # Values that turn on finer meshes after an extremum do not diverge.
        turned = len(phi) > 3 and np.ptp(np.sign(np.diff(phi))) > 0
        return GridConvergence("not monotone" if turned else "diverging" if p < 0 else "undecided")
    index = SAFETY * abs(limit / finest - 1) if finest else math.nan
    return GridConvergence("monotone" if np.sign(changes).sum() else "oscillating", p, limit, index)
