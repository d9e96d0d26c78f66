"""Checks that points lie in the body and times in [0, T].

This is necessary because the formulas of exact solutions can also be evaluated elsewhere, where they are no solution.
"""

import numpy as np
from numpy.typing import ArrayLike

from manufactured.body import Body
from manufactured.tensors import Array, Points

ROUNDING = 1e-9
"""Distance that counts as round-off: of a point from the body, relative to its extent, and of a time from [0, T]."""


def coordinates(values: ArrayLike, count: int, what: str) -> Array:
    """Return the coordinates of points as an array whose first axis has the length ``count``.

    Raises:
        ValueError: the array has another shape.
    """
    wanted = f"{what} need the shape ({count}, n), one row for each coordinate"
    try:
        found = np.asarray(values)
    except ValueError as error:
        raise ValueError(f"{wanted}; got rows of different lengths") from error
    if found.dtype.kind not in "iufc":
        raise ValueError(f"{wanted}, of numbers; got entries of the type {found.dtype}")
    if found.ndim >= 2 and len(found) == count:
        return found
    if found.shape == (count,):
        hint = f"; write one point as [{', '.join(f'[{value:g}]' for value in np.real(found))}]"
    elif found.ndim == 2 and found.shape[1] == count:
        hint = "; transpose it"
    else:
        hint = ""
    raise ValueError(f"{wanted}; got the shape {found.shape}{hint}")


def require_inside(body: Body, x: Points) -> None:
    """Raise ValueError if a point of x, (d, ...), lies outside the body by more than round-off."""
    points = np.real(x).reshape(body.dim, -1)
    reach = ROUNDING * body.extent
    # Comparisons with NaN are false, so the condition is written such that NaN coordinates are refused.
    with np.errstate(invalid="ignore"):
        within = [part.normal @ points <= part.normal @ part.start + reach for part in body.parts]
        left = points[:, ~np.all(within, axis=0)]
        left = left[:, ~body.contains(left)]
        left = left[:, ~np.any([part.contains(left, reach) for part in body.parts], axis=0)]
    if left.size:
        low, high = body.vertices.min(axis=1), body.vertices.max(axis=1)
        box = " × ".join(f"[{a:g}, {b:g}]" for a, b in zip(low, high, strict=True))
        raise ValueError(
            f"the point ({', '.join(f'{value:g}' for value in left[:, 0])}) lies outside the body, where there is no "
            f"exact solution ({left.shape[1]} of {points.shape[1]} points); the body lies in {box}, and "
            "body.contains(x) says which points it has"
        )


def require_times(T: float, time: Array | complex) -> None:
    """Raise ValueError if a time lies outside [0, T] by more than round-off."""
    times = np.asarray(time).real.reshape(-1)
    # Comparisons with NaN are false, so the condition is written such that NaN is refused.
    outside = ~(abs(times - T / 2) <= (0.5 + ROUNDING) * T)
    if outside.any():
        first = times[outside][0]
        raise ValueError(f"the time {first:g} lies outside [0, {T:g}], where there is no exact solution; T is body.T")
