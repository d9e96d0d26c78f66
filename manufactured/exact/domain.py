"""Checks that points lie in the body and times in [0, T].

This is necessary because the formulas of exact solutions can also be evaluated elsewhere, where they are no solution.

The interfaces ``Contribution`` and others describe the displacement fields whose sum is an exact solution.
"""

from typing import Protocol

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from manufactured.body import Body, Part
from manufactured.jet import Jet
from manufactured.modes import Modes
from manufactured.tensors import Array, Points, Tensors, Vectors


class ContributionAtPoints(Protocol):
    """The interface of a displacement field at fixed points, as a function of time.

    The methods return the displacement, its strain, or the gradient of the strain at a time; if ``rate`` is true, they
    return time derivatives. For n times, (n,), the results have n as an additional last axis. ``modes`` returns the
    strain at all times, as a sum of products.
    """

    def displacement(self, time: Array | complex, rate: bool = False) -> Vectors: ...
    def strain(self, time: Array | complex, rate: bool = False) -> Tensors: ...
    def strain_gradient(self, time: Array | complex, rate: bool = False) -> Array: ...
    def modes(self) -> Modes: ...


class Contribution(Protocol):
    """The interface of a displacement field on the body; ``at`` returns the field at fixed points, (d, ...)."""

    def at(self, x: Points) -> ContributionAtPoints: ...


class Face(Contribution, Protocol):
    """The interface of contact faces: displacement fields with contact on one part of Γ3, such as ``ContactFace``.

    Attributes:
        part: the part of Γ3.
        variables: the symbols of the coordinates s along the part.
        gap, initial_gap: the formulas of the gap w(s, t) and of the initial gap g(s), which is 0 in the paper.
        level: the formula of the level function ψ(s, t); the contact zone is {ψ ≥ 0}.
        gap_jet, level_jet: evaluate w and ψ with their derivatives.
        pressure_jet: evaluates the prescribed pressure with its derivatives; None if the pressure follows from the law.
        exponents_in: the formula from whose truncated powers the exponents of the strain at contact fronts are read
            off, for example the formula of the pressure.
        rough: the coordinates s at which the strain is singular or has a kink at all times.
    """

    @property
    def part(self) -> Part: ...
    @property
    def gap(self) -> sp.Expr: ...
    @property
    def initial_gap(self) -> sp.Expr: ...
    @property
    def level(self) -> sp.Expr: ...
    @property
    def rough(self) -> tuple[float, ...]: ...
    @property
    def variables(self) -> tuple[sp.Symbol, ...]: ...
    @property
    def gap_jet(self) -> Jet: ...
    @property
    def level_jet(self) -> Jet: ...
    @property
    def pressure_jet(self) -> Jet | None: ...
    @property
    def exponents_in(self) -> sp.Expr: ...


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
