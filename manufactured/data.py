"""The data of Problem 2.1: body, law, forces f_0 and f_2, initial displacement u_0, and no solution.

What is computed from ``Data`` alone can serve a problem whose solution nobody knows. An exact solution gives its data
by ``Data.of``; formulas of x1, x2 and t by ``Data.formulas``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import sympy as sp

from manufactured.body import Body, Kind, Part
from manufactured.exact import ExactSolution
from manufactured.factor import x1, x2, x3
from manufactured.law import KelvinVoigt
from manufactured.symbols import FormulaError, function, t
from manufactured.tensors import Hyperplane, Points, Tensors, Vectors, mandel

POINTS, TIMES = 64, 5
ROUNDING = 1e-12
KNOWN = {str(symbol): symbol for symbol in (x1, x2, x3, t)}


class LoadError(ValueError):
    """Data that no solution can belong to."""


ForceInTime = Callable[[float], Vectors]


@dataclass(frozen=True, eq=False)
class Data:
    """Problem 2.1 without its solution.

    ``check`` refuses what no solution can belong to.

    Attributes:
        body: Ω, Γ1, Γ2, Γ3, T.
        law: A and G.
        body_force: points (d, ...) ↦ (t ↦ f_0 at the points, (d, ...)).
        surface_load: a piece of Γ2 and points on it ↦ (t ↦ f_2 at the points, (d, ...)).
        initial: points ↦ ε(u_0), (D, ...).
        start: points ↦ u_0, (d, ...), with u_0 = 0 on Γ1 and u_0ν ≤ 0 on Γ3.
        lines: lines (direction, offset) across which f_0 or ε(u_0) are rough for all times, for quadrature.
        points: vertices of Ω at which they are singular.
        formulas_of: what the callables were made from, by which equal data are known as equal.
    """

    body: Body
    law: KelvinVoigt
    body_force: Callable[[Points], ForceInTime]
    surface_load: Callable[[Part, Points], ForceInTime]
    start: Callable[[Points], Vectors]
    initial: Callable[[Points], Tensors]
    lines: tuple[Hyperplane, ...] = ()
    points: tuple[tuple[float, ...], ...] = ()
    formulas_of: object = None

    @classmethod
    def of(cls, solution: ExactSolution) -> Data:
        """The data that belong to an exact solution."""

        def surface_load(part: Part, x: Points) -> ForceInTime:
            fields = solution.at(x)
            return lambda time: fields.surface_load(part, time)

        return cls(
            solution.body,
            solution.law,
            lambda x: solution.at(x).body_force,
            surface_load,
            lambda x: solution.at(x).displacement(0.0),
            lambda x: solution.at(x).strain(0.0),
            solution.rough,
            solution.singular,
            solution,
        )

    @classmethod
    def formulas(
        cls,
        body: Body,
        law: KelvinVoigt,
        f0: Sequence[sp.Expr | float],
        f2: Mapping[int, Sequence[sp.Expr | float]] | None = None,
        u0: Sequence[sp.Expr | float] | None = None,
        lines: tuple[Hyperplane, ...] = (),
    ) -> Data:
        """Data as formulas of x1, x2 (x3) and t.

        Args:
            body, law: as above.
            f0: the components of f_0.
            f2: number of a part of ``body.parts`` ↦ the components of f_2 on it; parts of Γ2 left out carry no load.
            u0: the components of u_0; 0 if left out.
            lines: where the formulas have kinks.

        Raises:
            FormulaError: a formula has the wrong number of components or other symbols, or f_2 is given on a part
                that is not of Γ2.
        """
        dim = body.dim
        zero = (sp.Integer(0),) * dim
        place = (x1, x2, x3)[:dim]
        force = _compiled(f0, dim, "f0", (*place, t))
        loads = {}
        for number, load in (f2 or {}).items():
            if not 0 <= number < len(body.parts) or body.parts[number].kind is not Kind.LOADED:
                loaded = [i for i, part in enumerate(body.parts) if part.kind is Kind.LOADED]
                raise FormulaError(f"f2 is given on part {number}, but the parts of Γ2 have the numbers {loaded}")
            loads[body.parts[number]] = _compiled(load, dim, f"f2 on part {number}", (*place, t))
        none = _compiled(zero, dim, "f2", (*place, t))
        displacement = tuple(map(_formula, u0 if u0 is not None else zero))
        start = _compiled(displacement, dim, "u0", place)
        gradient = _compiled([sp.diff(u, x) for u, x in product(displacement, place)], dim * dim, "∇u0", place)

        def surface_load(part: Part, x: Points) -> ForceInTime:
            load = loads.get(part, none)
            return lambda time: load(x, time)

        return cls(
            body,
            law,
            lambda x: lambda time: force(x, time),
            surface_load,
            lambda x: start(x),
            lambda x: mandel(gradient(x).reshape(dim, dim, *x.shape[1:])),
            (*lines, *law.steps),
            formulas_of=(tuple(map(_formula, f0)), _sorted(f2 or {}), displacement),
        )

    def check(self) -> None:
        """Look at random points and times whether the data are those of a problem.

        Any finite load can be balanced, because meas Γ1 > 0 for every ``Body``.

        Raises:
            LoadError: f_0, f_2, u_0 or ε(u_0) is not finite or has the wrong shape, u_0 does not vanish on Γ1, or
                u_0 is not in K.
        """
        with np.errstate(all="ignore"):  # what is not finite is refused below
            self._look()

    def _look(self) -> None:
        body, rng = self.body, np.random.default_rng(0)
        inside = _inside(body, rng)
        dim = body.dim
        for name, tensor in (("A", self.law.A), ("G", self.law.G)):
            values, factor = tensor.factor(inside), tensor.factor
            if values.min() < factor.low * (1 - ROUNDING) or values.max() > factor.high * (1 + ROUNDING):
                raise LoadError(
                    f"the factor of {name} takes values from {values.min():.4g} to {values.max():.4g}, stated are "
                    f"{factor.low:g} and {factor.high:g}; constants rest on these bounds, correct them"
                )
        for time in np.linspace(0.0, body.T, TIMES):
            _finite("f_0", self.body_force(inside)(time), inside, dim, f" at t = {time:.4g}")
            for part in body.of(Kind.LOADED):
                x = part.sample(rng, POINTS)
                _finite("f_2", self.surface_load(part, x)(time), x, dim, f" at t = {time:.4g}")
        _finite("ε(u_0)", self.initial(inside), inside, dim * (dim + 1) // 2, "")
        size = max(abs(_finite("u_0", self.start(inside), inside, dim, "")).max(), np.finfo(float).tiny)
        for part in body.parts:
            x = part.sample(rng, POINTS)
            u = _finite("u_0", self.start(x), x, dim, "")
            if part.kind is Kind.CLAMPED and abs(u).max() > ROUNDING * size:
                raise LoadError(f"u_0 is {abs(u).max():.3g} on Γ1, where it has to vanish, (2.3); change u_0")
            if part.kind is Kind.CONTACT and (part.normal @ u).max() > ROUNDING * size:
                raise LoadError(
                    f"u_0ν is {(part.normal @ u).max():.3g} > 0 on Γ3: u_0 has to lie in K, (3.5); change u_0"
                )


def _inside(body: Body, rng: np.random.Generator) -> Points:
    """Random points of Ω, (d, POINTS) or fewer."""
    low, high = body.vertices.min(axis=1, keepdims=True), body.vertices.max(axis=1, keepdims=True)
    x = low + (high - low) * rng.random((body.dim, 8 * POINTS))
    return x[:, body.contains(x)][:, :POINTS]


def _finite(name: str, values: Vectors, x: Points, components: int, when: str) -> Vectors:
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


def _sorted(f2: Mapping[int, Sequence[sp.Expr | float]]) -> tuple[object, ...]:
    return tuple((number, *map(_formula, load)) for number, load in sorted(f2.items()))


def _formula(formula: sp.Expr | float) -> sp.Expr:
    """With the symbols of this package: derivatives do not see others of the same name."""
    expression = sp.sympify(formula)
    return expression.subs({a: KNOWN[a.name] for a in expression.free_symbols if a.name in KNOWN})


def _compiled(
    formulas: Sequence[sp.Expr | float], count: int, name: str, symbols: tuple[sp.Symbol, ...]
) -> Callable[..., Vectors]:
    """(x, …) ↦ the values of some formulas, (count, ...)."""
    expressions = [_formula(formula) for formula in formulas]
    if len(expressions) != count:
        raise FormulaError(f"{name} has {len(expressions)} components, expected {count}")
    strange = sorted({str(a) for e in expressions for a in e.free_symbols - {*symbols}})
    if strange:
        raise FormulaError(f"{name} has the symbols {', '.join(strange)}; use {', '.join(map(str, symbols))}")
    call = function(symbols, expressions)

    def values(x: Points, *time: float) -> Vectors:
        return np.array([np.broadcast_to(value, x.shape[1:]) for value in call(*x, *time)])

    return values
