"""Whether data are those of a problem, at random points and times."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from manufactured.body import Body, Kind
from manufactured.law import KelvinVoigt
from manufactured.tensors import Points, Vectors

if TYPE_CHECKING:
    from manufactured.data.problem_data import Data

POINTS, TIMES = 64, 5
"""Points in the body and on each part, and times, at which the data are checked."""
ROUNDING = 1e-12
"""Relative size below which u_0 vanishes on Γ1 and lies in K."""


class LoadError(ValueError):
    """Data that no solution can belong to."""


def check(data: Data) -> None:
    """LoadError unless the data are those of a problem; see ``Data.check``."""
    rng = np.random.default_rng(0)
    inside = _inside(data.body, rng)
    _check_factors(data.law, inside)
    _check_forces(data, inside, rng)
    _check_start(data, inside, rng)


def _check_factors(law: KelvinVoigt, x: Points) -> None:
    for name, tensor in (("A", law.A), ("G", law.G)):
        values, factor = tensor.factor(x), tensor.factor
        if values.min() < factor.low * (1 - ROUNDING) or values.max() > factor.high * (1 + ROUNDING):
            raise LoadError(
                f"the factor of {name} takes values from {values.min():.4g} to {values.max():.4g}, stated are "
                f"{factor.low:g} and {factor.high:g}; constants rest on these bounds, correct them"
            )


def _check_forces(data: Data, inside: Points, rng: np.random.Generator) -> None:
    body = data.body
    for time in np.linspace(0.0, body.T, TIMES):
        _finite("f_0", data.body_force(inside)(time), inside, body.dim, f" at t = {time:.4g}")
        for part in body.of(Kind.LOADED):
            x = part.sample(rng, POINTS)
            _finite("f_2", data.surface_load(part, x)(time), x, body.dim, f" at t = {time:.4g}")


def _check_start(data: Data, inside: Points, rng: np.random.Generator) -> None:
    dim = data.body.dim
    _finite("ε(u_0)", data.initial(inside), inside, dim * (dim + 1) // 2, "")
    size = max(abs(_finite("u_0", data.start(inside), inside, dim, "")).max(), np.finfo(float).tiny)
    for part in data.body.parts:
        x = part.sample(rng, POINTS)
        u = _finite("u_0", data.start(x), x, dim, "")
        if part.kind is Kind.CLAMPED and abs(u).max() > ROUNDING * size:
            raise LoadError(f"u_0 is {abs(u).max():.3g} on Γ1, where it has to vanish, (2.3); change u_0")
        if part.kind is Kind.CONTACT and (part.normal @ u).max() > ROUNDING * size:
            raise LoadError(f"u_0ν is {(part.normal @ u).max():.3g} > 0 on Γ3: u_0 has to lie in K, (3.5); change u_0")


def _inside(body: Body, rng: np.random.Generator) -> Points:
    """Random points of Ω, (d, POINTS) or fewer."""
    low, high = body.vertices.min(axis=1, keepdims=True), body.vertices.max(axis=1, keepdims=True)
    x = low + (high - low) * rng.random((body.dim, 8 * POINTS))
    return x[:, body.contains(x)][:, :POINTS]


def _finite(name: str, values: Vectors, x: Points, components: int, when: str) -> Vectors:
    """The values; LoadError if they have the wrong shape or are not finite."""
    if np.shape(values) != (components, *x.shape[1:]):
        raise LoadError(
            f"{name} has the shape {np.shape(values)} at points {x.shape}{when}, expected {(components, *x.shape[1:])}"
        )
    wrong = ~np.isfinite(values).all(axis=0)
    if wrong.any():
        raise LoadError(
            f"{name} is not finite at x = {np.round(x[:, wrong][:, 0], 4).tolist()}{when}: no stress can balance it; "
            "give loads of L²"
        )
    return values
