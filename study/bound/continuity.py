"""Refusal of initial displacements u_0 that jump or are unbounded inside the body, because they do not lie in V.

Boxes that cover the body are halved again and again. A box is dropped if u_0 is known to be Lipschitz continuous on it,
also with kinks. In all other boxes the range of u_0 tends to a point if u_0 is continuous. If u_0 jumps, the range
remains as large as the jump, however narrow the band between two jumps is.

The range is computed by interval arithmetic if u_0 is given by formulas whose ranges are known. Otherwise it is the
range of samples, which may miss narrow bands.
"""

from collections.abc import Callable, Sequence
from itertools import product

import numpy as np
import sympy as sp

from manufactured.body import Body
from manufactured.data import Data, Expressions, LoadError
from manufactured.exact import ExactSolution
from manufactured.factor import x1, x2
from manufactured.tensors import Array, Points
from study.bound.ranges import Boxes, RangeError, require_known

HALVINGS = 44
"""Number of halvings in each direction. The last boxes are a few units in the last place of double precision wide."""
GRID = 5
"""Number of halvings in each direction before any box is dropped."""
MOST = 2000
"""If there are more boxes than this number, only the half with the largest range is kept of each box."""
MARGIN = 1e-9
"""A point is inside the body if its distance to the boundary is larger than this number times the size of the body."""
JUMP = 1e-5
"""A function jumps if its range in the last boxes exceeds this fraction of its size."""

Spread = Callable[[Points, Points], Array]
"""Function from the lower and the upper corners of boxes, (d, n) each, to the width of the range of u_0 on each box; it
is 0 on boxes on which u_0 is Lipschitz continuous."""


def require_continuous_start(data: Data) -> None:
    """Refuse an initial displacement that jumps or is unbounded inside the body.

    Exact solutions are not checked, because their proofs include their initial displacement.

    Raises:
        LoadError: the message names the place and the size of the jump.
    """
    if isinstance(data.formulas_of, ExactSolution):
        return
    formulas = data.formulas_of.start if isinstance(data.formulas_of, Expressions) else ()
    try:
        for formula in formulas:
            require_known(formula)
        spread = _spread_of_formulas(formulas) if formulas else _spread_of_samples(data)
    except RangeError:
        spread = _spread_of_samples(data)
    with np.errstate(all="ignore"):
        jump, place = largest_jump(data.body, spread)
        low, high = data.body.vertices.min(axis=1), data.body.vertices.max(axis=1)
        x = np.random.default_rng(0).uniform(low, high, (MOST, data.body.dim)).T
        size = abs(data.start(x[:, data.body.contains(x)])).max(initial=0.0)
    if jump > JUMP * size:
        what = f"jumps by about {jump:.3g}" if np.isfinite(jump) else "has no known bound"
        raise LoadError(
            f"u_0 {what} at x = ({', '.join(f'{c:.4g}' for c in place)}), and a displacement in V has to be continuous "
            "there: give a continuous u_0; kinks such as Max(x1 - 1/2, 0) are permitted"
        )


def largest_jump(body: Body, spread: Spread) -> tuple[float, Points]:
    """Return the largest range that a function has on the last boxes inside a body, and the middle of this box."""
    low, high = body.vertices.min(axis=1)[:, None], body.vertices.max(axis=1)[:, None]
    margin = MARGIN * float(np.ptp(body.vertices, axis=1).max())
    for number in range(HALVINGS * body.dim):
        low, high = _halves(low, high, number % body.dim)
        if number < GRID * body.dim:
            continue
        widths = np.where(_meets(body, low, high, margin), spread(low, high), 0.0)
        kept = widths > 0
        if not kept.any():
            return 0.0, low[:, 0]
        if kept.sum() > MOST:
            halves = widths.reshape(-1, 2)
            kept &= (halves.argmax(axis=1)[:, None] == (0, 1)).ravel()
        low, high, widths = low[:, kept], high[:, kept], widths[kept]
    middle, worst = (low + high) / 2, widths.argmax()
    return float(widths[worst]), middle[:, worst]


def _halves(low: Points, high: Points, axis: int) -> tuple[Points, Points]:
    """Return both halves of boxes that are cut in one direction, one after the other, (d, n) → (d, 2n)."""
    low, high = np.repeat(low, 2, axis=1), np.repeat(high, 2, axis=1)
    middle = (low[axis, ::2] + high[axis, ::2]) / 2
    high[axis, ::2], low[axis, 1::2] = middle, middle
    return low, high


def _places(low: Points, high: Points) -> Points:
    """Return the corners and the middle of boxes, (d, n) → (d, 2^d + 1, n)."""
    shares = np.array([*product((0.0, 1.0), repeat=len(low)), [0.5] * len(low)]).T
    return low[:, None] + shares[..., None] * (high - low)[:, None]


def _meets(body: Body, low: Points, high: Points, margin: float) -> Array:
    """Return whether a corner or the middle of each box is farther than the margin inside the body, (n,)."""
    places = _places(low, high)
    steps = margin * np.hstack([np.eye(body.dim), -np.eye(body.dim)])
    inside = [body.contains(places + step[:, None, None]) for step in steps.T]
    return np.asarray(np.all(inside, axis=0).any(axis=0))


def _spread_of_formulas(formulas: Sequence[sp.Expr]) -> Spread:
    def spread(low: Points, high: Points) -> Array:
        boxes, widths = Boxes(dict(zip((x1, x2), zip(low, high, strict=True), strict=True)), (x1, x2), 1), []
        for series in map(boxes, formulas):
            is_lipschitz = np.isfinite(series.largest).all(axis=0)
            widths.append(np.where(is_lipschitz, 0.0, series.high[0] - series.low[0]))
        return np.max(widths, axis=0)

    return spread


def _spread_of_samples(data: Data) -> Spread:
    def spread(low: Points, high: Points) -> Array:
        places = _places(low, high)
        inside = data.body.contains(places)
        values = np.full(places.shape, np.nan)
        values[:, inside] = data.start(places[:, inside])
        lowest, highest = np.fmin.reduce(values, axis=1), np.fmax.reduce(values, axis=1)
        return np.nan_to_num(highest - lowest).max(axis=0)

    return spread
