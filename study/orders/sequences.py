"""Observed orders of a sequence of errors: consecutive, fitted, extrapolated; what the sequence does; the verdict."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import stdtrit

from study.orders.errors import OrderError

Array = NDArray[np.float64]
HOLDS, FAILS, UNDECIDED, HIGHER, SKIPPED = "holds", "fails", "undecided", "higher", "skipped"
TOLERANCE = 0.15
"""Half the width of the window around an expected order, unless another one is given."""
STALLED = 0.2
"""An order of at most this on the finest meshes is stagnation."""
CLEAR = 10.0
"""Errors above this multiple of the floor are judged: a floor of a tenth changes an order by 0.15 at most."""
ROUND_OFF = 1e-10


@dataclass(frozen=True)
class Sequence:
    """Orders, diagnosis and verdict of one sequence of errors, coarse to fine.

    Attributes:
        h, errors: (levels,).
        orders: consecutive orders, (levels − 1,); NaN where an error is zero or not finite.
        order, low, high: least-squares order over the judged levels and its 95 % interval.
        extrapolated: order extrapolated from the three finest judged levels; NaN without three.
        limit: a of a + C h^p through the last three judged levels; NaN if there is no such fit.
        first, last: range of the judged levels, as for a slice.
        kind, sentence: the diagnosis in a word or two, and as a sentence.
        verdict: holds, fails, undecided, higher (than expected), skipped (exactly zero); None without an expectation.
        expected, at_least, tolerance: what was asked for.
    """

    name: str
    h: tuple[float, ...]
    errors: tuple[float, ...]
    orders: tuple[float, ...]
    order: float
    low: float
    high: float
    extrapolated: float
    limit: float
    first: int
    last: int
    kind: str
    sentence: str
    expected: float | None
    at_least: float | None
    tolerance: float
    verdict: str | None

    def _repr_html_(self) -> str:
        rows = zip(self.h, self.errors, ("", *(f"{order:.3f}" for order in self.orders)), strict=True)
        body = "".join(f"<tr><td>{h:.5g}</td><td>{e:.5g}</td><td>{order}</td></tr>" for h, e, order in rows)
        title = f"{self.name or 'error'}: {self.verdict + ', ' if self.verdict else ''}{self.sentence}"
        title = title.replace("&", "&amp;").replace("<", "&lt;")
        return f"<p>{title}</p><table><tr><th>h</th><th>error</th><th>order</th></tr>{body}</table>"


def consecutive_orders(h: ArrayLike, errors: ArrayLike) -> Array:
    """log(e_i/e_{i+1}) / log(h_i/h_{i+1}), (levels − 1,); NaN where an error is zero or not finite."""
    sizes, e = np.asarray(h, dtype=float), np.asarray(errors, dtype=float)
    with np.errstate(divide="ignore", invalid="ignore"):
        found = -np.diff(np.log(e)) / -np.diff(np.log(sizes))
    return np.where(np.isfinite(found), found, np.nan)


def fitted_order(h: ArrayLike, errors: ArrayLike) -> tuple[float, float, float]:
    """Least-squares order and its Student interval at 95 %; infinite with two levels."""
    x, y = np.log(np.asarray(h, dtype=float)), np.log(np.asarray(errors, dtype=float))
    if len(x) < 2:
        return math.nan, -math.inf, math.inf
    (xx, xy), (_, yy) = np.cov(x, y, bias=True)
    slope, free = float(xy / xx), len(x) - 2
    if not free:
        return slope, -math.inf, math.inf
    half = float(stdtrit(free, 0.975) * np.sqrt(max(xx * yy - xy**2, 0.0) / free) / xx)
    return slope, slope - half, slope + half


def extrapolated_order(h: ArrayLike, errors: ArrayLike) -> float:
    """The order for h → 0 from three levels, if the orders of pairs change in proportion to the mesh size."""
    sizes, orders = np.asarray(h, dtype=float)[-3:], consecutive_orders(h, errors)[-2:]
    if len(sizes) < 3:
        return math.nan
    ratio = math.exp((math.log(sizes[0]) - math.log(sizes[2])) / 2)
    return float(orders[1] + (orders[1] - orders[0]) / (ratio - 1))


def limit_and_order(h: ArrayLike, errors: ArrayLike) -> tuple[float, float]:
    """a and p of e = a + C h^p through three levels; NaN if no positive p fits."""
    h1, h2, h3 = map(float, np.asarray(h, dtype=float)[-3:])
    e1, e2, e3 = map(float, np.asarray(errors, dtype=float)[-3:])
    if not (e1 > e2 > e3 or e1 < e2 < e3) or max(e1, e3) > 1e200 or max(h1 / h2, h2 / h3) > 1e5:
        return math.nan, math.nan
    low, high = 1e-3, 50.0

    def gap(p: float) -> float:
        return math.log((e1 - e2) / (e2 - e3)) - math.log(((h1 / h2) ** p - 1) / (1 - (h3 / h2) ** p))

    if gap(low) * gap(high) > 0:
        return math.nan, math.nan
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (middle, high) if gap(low) * gap(middle) > 0 else (low, middle)
    return float(e3 - (e2 - e3) / ((h2 / h3) ** low - 1)), low


def observed_orders(
    h: ArrayLike,
    errors: ArrayLike,
    expected: float | None = None,
    at_least: float | None = None,
    tolerance: float = TOLERANCE,
    name: str = "",
) -> Sequence:
    """Orders, diagnosis and verdict of errors on meshes of size h, in any order.

    Raises:
        OrderError: different lengths, sizes that are not positive or repeated, a negative error, a bad expectation.
    """
    sizes, e = (np.asarray(values, dtype=float).ravel() for values in (h, errors))
    if sizes.shape != e.shape or not len(e):
        raise OrderError(f"{len(sizes)} sizes and {len(e)} errors: expected one error for each mesh")
    if not (np.isfinite(sizes).all() and (sizes > 0).all()):
        raise OrderError(f"mesh sizes must be positive and finite, got {sizes.tolist()[:10]}")
    if (e < 0).any():
        raise OrderError(f"{name or 'error'} = {e[e < 0][0]:g}: errors must not be negative; give absolute values")
    if expected is not None and at_least is not None:
        raise OrderError("give an expected order or a least one, not both")
    for value in (expected, at_least):
        if value is not None and not (math.isfinite(value) and value > 0):
            raise OrderError(f"an expected order must be positive, got {value:g}")
    if not (math.isfinite(tolerance) and tolerance > 0):
        raise OrderError(f"the tolerance must be positive, got {tolerance:g}")
    coarse_first = np.argsort(-sizes)
    sizes, e = sizes[coarse_first], e[coarse_first]
    repeated = np.flatnonzero(np.diff(sizes) == 0)
    if repeated.size:
        raise OrderError(f"the mesh size {sizes[repeated[0]]:.12g} stands there twice: keep one error for each mesh")
    window = _window(expected, at_least, tolerance)
    first, last, kind, sentence, verdict = _diagnose(sizes, e, window, tolerance)
    judged_h, judged = sizes[first:last], e[first:last]
    usable = len(judged) > 1 and bool((judged > 0).all() and np.isfinite(judged).all())
    order, low, high = fitted_order(judged_h, judged) if usable else (math.nan, -math.inf, math.inf)
    three = usable and len(judged) > 2
    return Sequence(
        name=name, h=tuple(sizes.tolist()), errors=tuple(e.tolist()),
        orders=tuple(consecutive_orders(sizes, e).tolist()), order=order, low=low, high=high,
        extrapolated=extrapolated_order(judged_h, judged) if three else math.nan,
        limit=limit_and_order(judged_h, judged)[0] if three else math.nan,
        first=first, last=last, kind=kind, sentence=sentence, expected=expected, at_least=at_least, tolerance=tolerance,
        verdict=verdict if window or verdict == SKIPPED else None,
    )  # fmt: skip


def _window(expected: float | None, at_least: float | None, tolerance: float) -> tuple[float, float] | None:
    if at_least is not None:
        return at_least, math.inf
    return None if expected is None else (expected - tolerance, expected + tolerance)


def _text(orders: Array) -> str:
    return ", ".join(f"{order:.2f}" for order in orders[-4:])


def _diagnose(h: Array, e: Array, window: tuple[float, float] | None, t: float) -> tuple[int, int, str, str, str]:
    """(first and last judged level, kind, sentence, verdict)."""
    n = len(e)
    if not np.isfinite(e).all():
        where = h[np.flatnonzero(~np.isfinite(e))[0]]
        return (
            0,
            n,
            "not finite",
            f"the error is not finite for h = {where:.5g}: the computation broke down there",
            FAILS,
        )
    if not e.any():
        return 0, n, "exactly zero", "the error is exactly zero on all meshes: nothing to judge", SKIPPED
    zero = np.flatnonzero(e == 0)
    if zero.size:
        stop = int(zero[0])
        return _above(h, e, stop, 0.0, "exactly zero", f"exactly zero from h = {h[stop]:.5g} on", window, t)
    orders = consecutive_orders(h, e)
    if n < 3:
        what = "grows" if n == 2 and orders[0] < 0 else "fewer than three meshes"
        words = f"the error grows (order {orders[0]:.2f}); " if what == "grows" else ""
        words += f"{n} mesh{'es' * (n > 1)}, a verdict needs three" + (f"; order {orders[0]:.2f}" if n == 2 else "")
        return 0, n, what, words, UNDECIDED
    stall = n - 1
    while stall > 0 and orders[stall - 1] <= STALLED:
        stall -= 1
    if stall < n - 1 or e[-1] >= e[0]:
        floor = float(np.median(e[stall:]))
        if floor <= ROUND_OFF * max(1.0, e[0]) and stall > 0:
            words = f"round-off reached at {floor:.2g} from h = {h[stall]:.5g} on"
            return _above(h, e, stall, floor, "round-off", words, window, t)
        if e[-1] >= e[0] * 1.01 or (stall < n - 1 and e[-1] > 2 * e[stall]):
            return 0, n, "grows", f"the error grows: orders {_text(orders)}; it does not converge", FAILS
        equal = ", errors are equal" if (np.diff(e[stall:]) == 0).any() else ""
        words = f"stagnates at {floor:.2g} from h = {h[stall]:.5g} on{equal}: a floor, another error dominates"
        return _above(h, e, stall, floor, "floor", words, window, t)
    if n > 3:
        fits = [limit_and_order(h[k : k + 3], e[k : k + 3]) for k in (n - 4, n - 3)]
        (a0, p0), (a, p) = fits
        bent = orders[-3] - orders[-1]
        if a > 0.02 * e[-1] and a0 > 0 and abs(p0 - p) < 0.02 + 0.1 * bent and orders[-1] < orders[-2] < orders[-3]:
            words = f"orders fall from mesh to mesh ({_text(orders)}): the error tends to {a:.2g}, not to 0"
            found = _above(h, e, n, a, "orders falling", words, window, t)
            return found if found[4] == HOLDS else (0, n, "orders falling", words, _judge(h, e, window, t)[1])
    first, verdict = _judge(h, e, window, t)
    kind, sentence = _trend(h[first:], e[first:], orders, t)
    if verdict == HIGHER:
        kind = "higher than expected"
        sentence = f"orders {_text(orders)} are higher than expected: superconvergence, or the wrong error? {sentence}"
    return first, n, kind, sentence, verdict


def _above(
    h: Array, e: Array, stall: int, floor: float, kind: str, words: str, window: tuple[float, float] | None, t: float
) -> tuple[int, int, str, str, str]:
    """The verdict from the levels clearly above a floor, if three orders are left there."""
    low = np.flatnonzero(e[:stall] < CLEAR * floor)
    stop = int(low[0]) if low.size else stall
    if stop < 4:
        if kind in ("round-off", "exactly zero"):
            return 0, stop, kind, f"{words}; fewer than three orders above it: take coarser meshes", UNDECIDED
        return 0, len(e), "stagnates" if kind == "floor" else kind, words, FAILS
    first, verdict = _judge(h[:stop], e[:stop], window, t)
    orders = consecutive_orders(h[:stop], e[:stop])[first:]
    return first, stop, kind, f"{words}; above it orders {_text(orders)}", verdict


def _judge(h: Array, e: Array, window: tuple[float, float] | None, t: float) -> tuple[int, str]:
    """(first level of the asymptotic range, verdict); an order in the window counts as settled."""
    orders, n = consecutive_orders(h, e), len(e)
    if window is None:
        first = n - 2
        while first > 0 and np.ptp(orders[first - 1 :]) <= 2 * t:
            first -= 1
        return first, UNDECIDED
    low, high = window[0] - 1e-9, window[1] + 1e-9
    inside = (orders >= low) & (orders <= high)
    first = n - 1
    while first > 0 and inside[first - 1]:
        first -= 1
    extrapolated = extrapolated_order(h, e)
    if n - 1 - first >= 3 or (n - 1 - first == 2 and low <= extrapolated <= high):
        return first, HOLDS
    last, previous = orders[-1], orders[-2]
    step = abs(last - previous)
    if max(last, previous) < low:
        settled = step <= t and extrapolated < low
        return max(n - 3, 0), FAILS if settled or last < previous else UNDECIDED
    if min(last, previous) > high:
        return max(n - 3, 0), HIGHER if step <= t and extrapolated > high else UNDECIDED
    return max(n - 3, 0), UNDECIDED


def _trend(h: Array, e: Array, orders: Array, t: float) -> tuple[str, str]:
    last, previous = orders[-1], orders[-2]
    falls = len(orders) > 2 and np.all(np.diff(orders[-3:]) < 0)
    shrinking = falls and abs(last - previous) < 0.7 * abs(previous - orders[-3])
    if falls and not shrinking and orders[-3] - last > 0.04:
        return "orders falling", f"orders fall from mesh to mesh: {_text(orders)}"
    if abs(last - previous) > 2 * t:
        rising = last > previous
        word = "orders rising" if rising else "orders not settled"
        return "pre-asymptotic", f"pre-asymptotic, {word}: {_text(orders)}; take finer meshes"
    used = consecutive_orders(h, e)
    mean = fitted_order(h, e)[0]
    return "converges", f"converges with order {mean:.2f} (orders {_text(used)})"
