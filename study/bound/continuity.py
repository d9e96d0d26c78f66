"""Refusal of initial displacements u_0 that do not lie in K: they jump, are not 0 on Γ1 or penetrate the foundation.

Boxes that cover the body are halved again and again. A box is dropped if u_0 is known to be Lipschitz continuous on it,
also with kinks. In all other boxes the range of u_0 tends to a point if u_0 is continuous. If u_0 jumps, the range
remains as large as the jump, however narrow the band between two jumps is. In the same way, intervals that cover a side
of the body are halved, to find where u_0 violates a boundary condition.

The range is computed by interval arithmetic if u_0 is given by formulas whose ranges are known. Otherwise it is the
range of samples, which may miss narrow bands.
"""

from collections.abc import Callable, Sequence
from itertools import product

import numpy as np
import sympy as sp

from manufactured.body import Body, Kind, Part
from manufactured.data import Data, Expressions, LoadError
from manufactured.exact import ExactSolution
from manufactured.factor import x1, x2
from manufactured.tensors import Array, Points
from study.bound.problem import place
from study.bound.ranges import ARC, Boxes, RangeError, along_side, require_known
from study.fem.mesh import distance

HALVINGS = 44
"""Number of halvings in each direction. The last boxes are a few units in the last place of double precision wide."""
GRID = 5
"""Number of halvings in each direction before any box is dropped."""
MOST = 2000
"""If there are more boxes than this number, only the half with the largest range is kept of each box."""
MARGIN = 1e-9
"""A point is inside the body if its distance to the boundary is larger than this number times the size of the body."""
JUMP = 1e-6
"""A function jumps if its range in the last boxes exceeds this fraction of its size. There the root of the distance to
a line, which is not in V, has the range 2.4e-7."""

Spread = Callable[[Array], Array]
"""Function from boxes, given by their lower and then their upper corners, (2, d, n), to the width of the range of u_0
on each box; it is 0 on boxes on which u_0 is Lipschitz continuous. On sides of the body it is the violation of a
boundary condition."""


def require_continuous_start(data: Data) -> None:
    """Refuse an initial displacement that jumps, is unbounded, or violates a boundary condition.

    Exact solutions are not checked, because their proofs include their initial displacement.

    Raises:
        LoadError: the message names the place and the size of the jump.
    """
    if isinstance(data.formulas_of, ExactSolution):
        return
    body, formulas = data.body, data.formulas_of.start if isinstance(data.formulas_of, Expressions) else ()
    try:
        for formula in formulas:
            require_known(formula)
    except RangeError:
        formulas = ()
    spread = _spread_of_formulas(formulas) if formulas else _spread_of_samples(data)
    around = np.array([body.vertices.min(axis=1), body.vertices.max(axis=1)])[..., None]
    margin = MARGIN * body.extent

    def inside(boxes: Array) -> Array:
        return np.where(_meets(body, boxes, margin), spread(boxes), 0.0)

    with np.errstate(all="ignore"):
        tolerance = JUMP * abs(data.start(body.sample(np.random.default_rng(0), MOST))).max(initial=0.0)
        _require_small(*_largest(around, inside), tolerance, "jumps by about")
        for part in (*body.of(Kind.CLAMPED), *body.of(Kind.CONTACT)) if any(formulas) else ():
            size, at = _violation(part, np.array(formulas))
            _require_small(size, part.point(at), tolerance, f"violates the condition of a {part.kind.name} part by")


def _violation(part: Part, start: Array) -> tuple[float, Points]:
    """Return how far u_0 is from 0 on a clamped side, or above 0 in normal direction on a contact side, and where."""
    formulas = along_side(part, [*start, *-start] if part.kind is Kind.CLAMPED else [part.normal @ start])

    def largest(boxes: Array) -> Array:
        expand = Boxes({ARC: boxes[:, 0]}, (), 0)
        return np.max([expand(formula).values[1] for formula in formulas], axis=0)

    return _largest(np.array([[[0.0]], [[part.measure]]]), largest)


def _require_small(size: float, at: Points, tolerance: float, what: str) -> None:
    if size > tolerance:
        raise LoadError(
            f"u_0 {what} {size:.3g} at x = {place(at)}: give a continuous u_0 that is 0 on CLAMPED parts and does not "
            "penetrate the foundation; kinks such as Max(x1 - 1/2, 0) are permitted"
        )


def _largest(boxes: Array, spread: Spread) -> tuple[float, Points]:
    """Halve boxes with a positive spread again and again; return the largest spread at last, and its place."""
    dim = boxes.shape[1]
    for number in range(HALVINGS * dim):
        boxes = _halves(boxes, number % dim)
        if number < GRID * dim:
            continue
        widths = spread(boxes)
        kept = widths > 0
        if not kept.any():
            return 0.0, boxes[0, :, 0]
        if kept.sum() > MOST:
            halves = widths.reshape(-1, 2)
            kept &= (halves.argmax(axis=1)[:, None] == (0, 1)).ravel()
        boxes, widths = boxes[..., kept], widths[kept]
    worst = widths.argmax()
    return float(widths[worst]), boxes[..., worst].mean(axis=0)


def _halves(boxes: Array, axis: int) -> Array:
    """Return both halves of boxes that are cut in one direction, one after the other, (2, d, n) → (2, d, 2n)."""
    middle = boxes[:, axis].mean(axis=0)
    boxes = np.repeat(boxes, 2, axis=2)
    boxes[1, axis, ::2] = boxes[0, axis, 1::2] = middle
    return boxes


def _places(boxes: Array) -> Points:
    """Return the corners and the middle of boxes, (2, d, n) → (d, 2^d + 1, n)."""
    low, high = boxes
    shares = np.array([*product((0.0, 1.0), repeat=len(low)), [0.5] * len(low)]).T
    return low[:, None] + shares[..., None] * (high - low)[:, None]


def _meets(body: Body, boxes: Array, margin: float) -> Array:
    """Return whether boxes may meet the body, (n,); a box as small as the margin has to lie farther inside."""
    middle, radii = boxes.mean(axis=0), np.linalg.norm(boxes[1] - boxes[0], axis=0) / 2
    to_sides = np.min([distance(middle, part.corners) for part in body.parts], axis=0)
    return np.where(to_sides > np.maximum(radii, margin), body.contains(middle), radii > margin)


def _spread_of_formulas(formulas: Sequence[sp.Expr]) -> Spread:
    def spread(boxes: Array) -> Array:
        expand, widths = Boxes({x1: boxes[:, 0], x2: boxes[:, 1]}, (x1, x2), 1), []
        for series in map(expand, formulas):
            is_lipschitz = np.isfinite(series.largest).all(axis=0)
            widths.append(np.where(is_lipschitz, 0.0, np.ptp(series.values, axis=0)))
        return np.max(widths, axis=0)

    return spread


def _spread_of_samples(data: Data) -> Spread:
    def spread(boxes: Array) -> Array:
        places = _places(boxes)
        inside = data.body.contains(places)
        values = np.full(places.shape, np.nan)
        values[:, inside] = data.start(places[:, inside])
        lowest, highest = np.fmin.reduce(values, axis=1), np.fmax.reduce(values, axis=1)
        return np.nan_to_num(highest - lowest).max(axis=0)

    return spread
